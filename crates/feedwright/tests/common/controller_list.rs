//! What `controllers` lists, whatever table the command has.

use super::command::Folder;

/// `controllers` lists every controller of a table, and each with every parameter and its reason.
pub(crate) fn lists(folder: &Folder, table: feedwright::Controllers) {
    let controllers = folder.run(&["controllers"]).succeeded().stdout;
    for entry in table {
        assert!(
            controllers.lines().any(|line| line.starts_with(entry.name)),
            "{controllers}"
        );
        let one = folder.run(&["controllers", entry.name]).succeeded().stdout;
        let in_words = one.split_whitespace().collect::<Vec<_>>().join(" ");
        for parameter in entry.parameters {
            let named = one
                .lines()
                .any(|line| line.starts_with(&format!("{} = ", parameter.name)));
            assert!(named && in_words.contains(parameter.reason), "{one}");
        }
    }
}
