//! The Python that the scripts of the oracles run with.

use std::process::Command;

use crate::missing::missing;

/// The command of a Python that reads TOML: 3.11 or newer. Without one, prints a note and returns
/// `None`; under CI the test fails.
pub(crate) fn python() -> Option<&'static str> {
    let python = ["python3", "python"].into_iter().find(|python| {
        Command::new(python)
            .args(["-c", "import tomllib"])
            .output()
            .is_ok_and(|output| output.status.success())
    });
    if python.is_none() {
        missing("there is no Python 3.11 or newer to run the script with");
    }
    python
}
