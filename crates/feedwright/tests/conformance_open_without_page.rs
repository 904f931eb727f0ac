//! `feedwright open` of a command that was built without the page: it says how to get one.

use crate::command::Folder;
use crate::missing::missing;

#[test]
fn a_command_without_the_page_says_where_there_is_one() {
    let folder = Folder::new();
    let said = [
        "this feedwright was built without the page",
        "run `web/page`",
        "cargo build",
    ];
    folder
        .run(&["open", "--no-browser", "circle.ngc"])
        .refused(&said);
    missing("the page is not built (web/page): what serves it is not tested");
}
