//! Whether LinuxCNC's stand-alone interpreter is there.

use std::process::{Command, Stdio};

/// Whether `rs274` can be run; it is said where it cannot.
pub(crate) fn is_installed() -> bool {
    let runs = Command::new("rs274").arg("-h").stdin(Stdio::null()).output().is_ok();
    if !runs {
        eprintln!(
            "SKIPPED: LinuxCNC is not installed; on Debian: apt-get install --no-install-recommends linuxcnc-uspace"
        );
    }
    runs
}
