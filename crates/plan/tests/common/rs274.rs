//! Whether LinuxCNC's stand-alone interpreter is there.

use std::process::{Command, Stdio};

use crate::missing::missing;

/// Returns true if `rs274` can be run. If it cannot, reports that; under CI the test fails.
pub(crate) fn is_installed() -> bool {
    let runs = Command::new("rs274")
        .arg("-h")
        .stdin(Stdio::null())
        .output()
        .is_ok();
    if !runs {
        missing(
            "LinuxCNC is not installed (on Debian: apt-get install --no-install-recommends linuxcnc-uspace)",
        );
    }
    runs
}
