//! The help of every command, as docs/command-line.md has it. `just help` writes the document anew.

use std::path::Path;

use crate::command::{Folder, Ran};

/// Heading before the help in the document.
const HEADING: &str = "\n## Commands\n\n";

fn help(folder: &Folder, arguments: &[&str], all: &str) -> String {
    let mut command = folder.command();
    let ran = Ran::from(
        command
            .env_remove("COLUMNS")
            .args(arguments)
            .arg(all)
            .output()
            .unwrap(),
    )
    .succeeded();
    ran.stdout.trim_end().to_owned()
}

/// The help as it is to stand in the document; `lab` hands everything to another program.
fn section() -> String {
    let folder = Folder::new();
    let root = help(&folder, &[], "-h");
    let commands = root
        .lines()
        .take_while(|line| *line != "Options:")
        .filter(|line| line.starts_with("  "));
    let names = commands
        .map(|line| line.split_whitespace().next().unwrap())
        .filter(|name| !["help", "lab"].contains(name));
    let mut text = String::new();
    for name in names {
        // A command of commands has one.
        let words: &[&str] = if name == "linuxcnc" {
            &["linuxcnc", "setup"]
        } else {
            &[name]
        };
        let name = words.join(" ");
        let lines: String = help(&folder, words, "--help-all")
            .lines()
            .map(|line| format!("    {line}\n").replace("    \n", "\n"))
            .collect();
        text += &format!("### {name}\n\n{lines}\n");
    }
    text.trim_end().to_owned() + "\n"
}

#[test]
fn the_help_in_the_document_comes_from_the_program() {
    let path = Path::new(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../docs/command-line.md"
    ));
    let document = std::fs::read_to_string(path).unwrap();
    let (before, found) = document.split_once(HEADING).unwrap();
    let wanted = section();
    if std::env::var_os("FEEDWRIGHT_UPDATE_DOCUMENTS").is_some() {
        std::fs::write(path, format!("{before}{HEADING}{wanted}")).unwrap();
        return;
    }
    let difference = found
        .lines()
        .zip(wanted.lines())
        .find(|(found, wanted)| found != wanted);
    assert!(
        found == wanted,
        "the document is out of date; hint: `just help`\nfirst difference: {difference:?}"
    );
}
