//! Options of `feedwright open`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// Show the page in a browser: see the cut, correct the program
///
/// The page is a part of this command and needs no network. It is served to this computer only, at
/// an address that holds a secret, until Ctrl-C. Everything is computed in the browser.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  feedwright open
  feedwright open part.ngc mine.toml
  feedwright open --no-browser part.ngc
  feedwright open --hal")]
pub(crate) struct OpenArgs {
    /// G-code program to begin with, and a machine file (.toml).
    #[arg(value_name = "FILES")]
    pub(crate) files: Vec<PathBuf>,
    /// Show the machine of LinuxCNC on this computer, by the component's pins.
    ///
    /// Path, tool and contour error with and without the correction, while LinuxCNC runs with the
    /// component feedwright. The pins are read by halcmd and never written. With LINEAR_UNITS =
    /// inch: --hal=inch.
    #[arg(long, value_name = "UNITS", value_enum, num_args = 0..=1, require_equals = true, default_missing_value = "mm")]
    pub(crate) hal: Option<JointUnits>,
    /// Print the address only.
    #[arg(long)]
    pub(crate) no_browser: bool,
}

/// Units of the joints, as LINEAR_UNITS of LinuxCNC has them.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum JointUnits {
    /// Millimeters.
    Mm,
    /// Inches.
    Inch,
}

impl JointUnits {
    /// Millimeters in one of them.
    pub(crate) const fn mm(self) -> f64 {
        match self {
            Self::Mm => 1.0,
            Self::Inch => 25.4,
        }
    }
}
