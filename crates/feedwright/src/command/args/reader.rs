//! How programs are read: the same options for all commands that read one.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use feedwright_gcode::{AUTO, Increment, Settings};
use miette::{Result, miette};

use crate::request::JobRequest;

/// Options for reading a program, the same for all commands that read one.
#[derive(Debug, Args)]
#[command(next_help_heading = "Reading the program")]
pub struct ReaderArgs {
    /// Whose G-code it is: auto, linuxcnc, fanuc, haas, grbl, marlin or klipper; fanuc-mill,
    /// fanuc-lathe, haas-mill and haas-lathe where the program does not show the machine. auto
    /// looks at the beginning.
    #[arg(long, value_name = "NAME", default_value = AUTO, hide_short_help = true)]
    pub(crate) dialect: String,
    /// Length of one unit of a number without a decimal point on a Fanuc or Haas: 0.01mm, 0.001mm
    /// or 0.0001mm [default: whole units].
    #[arg(long, value_name = "LENGTH", value_parser = Increment::named, hide_short_help = true)]
    pub(crate) increment: Option<Increment>,
    /// Motions after which a program counts as endless.
    #[arg(long, value_name = "N", default_value_t = Settings::default().max_motions, value_parser = clap::value_parser!(u64).range(1..), allow_negative_numbers = true, hide_short_help = true)]
    pub(crate) max_motions: u64,
    /// Lines without a motion in a row after which a loop counts as endless.
    #[arg(long, value_name = "N", default_value_t = Settings::default().max_idle_lines, value_parser = clap::value_parser!(u64).range(1..), allow_negative_numbers = true, hide_short_help = true)]
    pub(crate) max_idle_lines: u64,
    /// Tools, as LinuxCNC keeps them: one `T1 P1 Z25.4 D6` a line.
    #[arg(long, value_name = "FILE.tbl")]
    pub tool_table: Option<PathBuf>,
    /// Unit of the lengths in the tool table.
    #[arg(long, value_name = "UNIT", value_enum, default_value_t = Unit::Mm, requires = "tool_table", hide_short_help = true)]
    pub(crate) tool_unit: Unit,
    /// Folder of subroutines, each in a file of its name (.ngc); may be given several times. The
    /// program's own folder comes first.
    #[arg(long, value_name = "FOLDER", hide_short_help = true)]
    pub(crate) subroutines: Vec<PathBuf>,
}

/// Unit of lengths.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Unit {
    Mm,
    Inch,
}

impl ReaderArgs {
    /// Returns the settings of the reader.
    pub fn settings(&self) -> Result<Settings> {
        self.request()?.reader()
    }

    /// Returns a request with these options.
    pub(crate) fn request(&self) -> Result<JobRequest> {
        if let Some(folder) = self.subroutines.iter().find(|folder| !folder.is_dir()) {
            return Err(miette!(
                help = "name the folder that holds the files of the subroutines",
                "--subroutines {}: this is no folder",
                folder.display()
            ));
        }
        Ok(JobRequest {
            dialect: self.dialect.clone(),
            increment: self.increment,
            max_motions: Some(self.max_motions),
            max_idle_lines: Some(self.max_idle_lines),
            tool_table: self.tool_table.clone(),
            inch_tools: matches!(self.tool_unit, Unit::Inch),
            subroutines: self.subroutines.clone(),
            ..JobRequest::default()
        })
    }
}
