//! Options of `feedwright linuxcnc`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

/// Wire the live correction into a LinuxCNC configuration
///
/// The original files are only read. Copies of what has to change are written beside them.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Example:
  feedwright linuxcnc setup my.ini")]
pub(crate) struct LinuxcncArgs {
    #[command(subcommand)]
    pub(crate) command: LinuxcncCommand,
}

#[derive(Debug, Subcommand)]
pub(crate) enum LinuxcncCommand {
    Setup(LinuxcncSetupArgs),
}

/// Say what can be corrected in a configuration, and wire the component into a copy of it
///
/// Reads the INI file and its HAL files, and says of every joint what drives and measures it. If
/// all joints can be corrected, it writes NAME-feedwright.ini with its HAL files, a machine file
/// and a script that records, and prints what to do next.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  feedwright linuxcnc setup my.ini
  feedwright linuxcnc setup axis.ini --simulate tnv40 --raise-ferror 0.2
  feedwright linuxcnc setup my.ini --undo

Exit codes: 0 wired; 1 the configuration cannot be wired, and nothing was written; 2 a file that cannot be read or written.")]
pub(crate) struct LinuxcncSetupArgs {
    /// INI file of the configuration.
    #[arg(value_name = "FILE.ini")]
    pub(crate) ini: PathBuf,
    /// Say what would be done, and write nothing.
    #[arg(long, conflicts_with = "undo")]
    pub(crate) dry_run: bool,
    /// Following error that the copy allows, in the unit of the configuration. FERROR and
    /// MIN_FERROR that are below it are raised to it. A drive that fails moves so far before
    /// LinuxCNC stops it.
    #[arg(long, value_name = "VALUE", value_parser = following_error, conflicts_with = "undo")]
    pub(crate) raise_ferror: Option<f64>,
    /// Machine that stands in for the drives: one that is built in, or a machine file (.toml). In
    /// the copy nothing commands or enables hardware that setup does not know.
    #[arg(long, value_name = "NAME|FILE.toml", conflicts_with = "undo")]
    pub(crate) simulate: Option<String>,
    /// Replace files of an earlier setup that were changed by hand.
    #[arg(long, conflicts_with = "undo")]
    pub(crate) replace: bool,
    /// Remove what setup wrote. Files that were changed by hand stay.
    #[arg(long)]
    pub(crate) undo: bool,
    /// Folder of the HAL files that configurations share.
    #[arg(long, value_name = "FOLDER", default_value = crate::linuxcnc_setup::HALLIB)]
    pub(crate) hallib: PathBuf,
}

/// A length above zero.
fn following_error(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err(
            "a following error is a number above 0, in the unit of the configuration".to_owned(),
        ),
    }
}
