//! The command line: a file of options for each command.

pub(crate) mod headings;
pub(crate) mod quantity;
pub(crate) mod reader;
pub(crate) mod geometry;
pub(crate) mod correct;
pub(crate) mod advise;
pub(crate) mod run;
pub(crate) mod plan;
pub(crate) mod sweep;
pub(crate) mod identify;
pub(crate) mod lab;
pub(crate) mod excite;
pub(crate) mod block;
pub(crate) mod check;
pub(crate) mod diff;
pub(crate) mod canon;
pub(crate) mod linuxcnc;
pub(crate) mod completions;
pub(crate) mod man;
pub(crate) mod help;
pub(crate) mod open;

use std::ffi::OsString;
use std::io::{self, IsTerminal};
use std::path::PathBuf;

use clap::{ArgAction, Args, ColorChoice, Command, CommandFactory, Parser, Subcommand, ValueEnum};
use feedwright_gcode::visible;

use advise::AdviseArgs;
use block::BlockArgs;
use canon::CanonArgs;
use check::CheckArgs;
use completions::CompletionsArgs;
use correct::CorrectArgs;
use diff::DiffArgs;
use excite::ExciteArgs;
use identify::IdentifyArgs;
use lab::LabArgs;
use linuxcnc::LinuxcncArgs;
use man::ManArgs;
use open::OpenArgs;
use plan::PlanArgs;
use run::RunArgs;
use sweep::{MergeArgs, SweepJobsArgs};

use crate::command::terminal::{ColorWhen, LengthUnits, columns, is_dumb, set_color, set_units};
use help::{grouped, shown_options};

/// Predict the contour error of a CNC program on a machine, and correct it
///
/// feedwright reads a G-code program and a machine file, simulates the cut servo period by servo
/// period, and shows how far the tool leaves the programmed path, and where. Then it corrects the
/// command.
#[derive(Debug, Parser)]
#[command(name = "feedwright", version, propagate_version = true, disable_version_flag = true, max_term_width = COLUMNS, after_long_help = AFTER)]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) common: CommonArgs,
    /// Print version
    #[arg(short = 'V', long, global = true, action = ArgAction::Version, help_heading = EVERYWHERE, hide_short_help = true)]
    version: Option<bool>,
    #[command(subcommand)]
    pub(crate) command: CommandArgs,
}

/// Options of every command.
#[derive(Debug, Args)]
pub struct CommonArgs {
    /// Print results and errors only: no progress, no remarks.
    #[arg(short, long, global = true, help_heading = EVERYWHERE)]
    pub quiet: bool,
    /// Color messages always, never, or automatically.
    ///
    /// auto colors messages on a terminal, unless NO_COLOR is set or TERM is dumb.
    #[arg(long, global = true, value_name = "WHEN", value_enum, default_value_t = ColorWhen::Auto, help_heading = EVERYWHERE, hide_short_help = true)]
    pub(crate) color: ColorWhen,
    /// Units of what is printed: metric (mm, um) or inch (in, thousandths of an inch). The pages of
    /// `run` and `advise` follow; JSON and figures stay metric.
    ///
    /// Contour errors are in thousandths with three decimals: drawings state tolerances in
    /// thousandths, and the last decimal is a millionth, about 0.025 um.
    #[arg(long, global = true, value_name = "UNITS", value_enum, default_value_t = LengthUnits::Metric, help_heading = EVERYWHERE)]
    pub(crate) units: LengthUnits,
    /// Print help with all options
    #[arg(long, global = true, action = ArgAction::HelpLong, help_heading = EVERYWHERE)]
    help_all: Option<bool>,
}

const EVERYWHERE: &str = "Options of every command";

/// Longer lines are hard to read.
pub const COLUMNS: usize = 100;

const AFTER: &str = "\
Files: wherever a file is read, - is the standard input, and wherever one is written, - is the standard output; tables and remarks go to \
the standard error then. ./- is a file of that name. A file is written when everything has gone well, and as a whole.

Exit codes: 0 done, and within tolerance; 1 out of tolerance, worse than without a correction, or mistakes in a file that was checked; \
2 an error, nothing was written; 130 interrupted.

Environment: FEEDWRIGHT_CACHE is the folder of what is kept between runs, empty for none; NO_COLOR and TERM=dumb turn colours off, \
TERM=dumb progress too; COLUMNS is the width of tables and messages where it differs from the width of the terminal.

First steps:
  feedwright run part.ngc
cuts your program on a simulated machine, and part.report.html shows how it went. `feedwright COMMAND --help` has examples of each command.";

#[derive(Debug, Subcommand)]
pub(crate) enum CommandArgs {
    Run(Box<RunArgs>),
    Correct(CorrectArgs),
    Advise(AdviseArgs),
    Plan(PlanArgs),
    Diff(DiffArgs),
    Sweep(SweepJobsArgs),
    Merge(MergeArgs),
    Check(CheckArgs),
    Open(OpenArgs),
    Identify(Box<IdentifyArgs>),
    Excite(ExciteArgs),
    Machines(MachinesArgs),
    /// List the controllers, or the parameters of one
    Controllers {
        /// Name of the controller.
        name: Option<String>,
    },
    Canon(CanonArgs),
    /// Start the laboratory, where it is installed
    ///
    /// The laboratory is a command of its own, `feedwright-lab`, which is installed beside this one
    /// or on the PATH.
    #[command(disable_help_flag = true)]
    Lab(LabArgs),
    Block(BlockArgs),
    Linuxcnc(LinuxcncArgs),
    Cache(CacheArgs),
    Completions(CompletionsArgs),
    Man(ManArgs),
}

/// List the built-in machines, or write one as a file
#[derive(Debug, Args)]
#[command(after_long_help = "\
Example:
  feedwright machines workshop --out mine.toml
  feedwright check mine.toml")]
pub(crate) struct MachinesArgs {
    /// Built-in machine: its file has every key, with a comment where each value comes from.
    pub(crate) name: Option<String>,
    /// Place of the machine file [default: the standard output].
    #[arg(long, value_name = "FILE.toml", requires = "name")]
    pub(crate) out: Option<PathBuf>,
}

/// Show what is kept between runs, or remove it
///
/// Identified models are kept, so that the next run with the same machine begins at once. What was
/// used longest ago is removed when the store is full. Several runs may use it at once.
#[derive(Debug, Args)]
#[command(after_long_help = "Example:\n  feedwright cache --clear")]
pub(crate) struct CacheArgs {
    /// Remove everything that is kept.
    #[arg(long)]
    pub(crate) clear: bool,
}

impl CommandArgs {
    /// Returns true if the command writes files. An interrupt must not leave them half-written.
    pub(crate) const fn writes_files(&self) -> bool {
        !matches!(
            self,
            Self::Check(_)
                | Self::Open(_)
                | Self::Canon(_)
                | Self::Machines(MachinesArgs { out: None, .. })
                | Self::Controllers { .. }
        )
    }
}

/// Reads the command line of this process; help, version and mistakes of it end the process.
pub fn parse<T: Parser>() -> T {
    parse_from(&std::env::args_os().collect::<Vec<_>>())
}

/// Reads a command line, whose first argument is the name of the command; help, version and
/// mistakes of it end the process.
pub(crate) fn parse_from<T: Parser>(arguments: &[OsString]) -> T {
    let color = color_said(arguments);
    set_color(color);
    let command = command::<T>(color, arguments);
    let matches = command
        .try_get_matches_from(arguments)
        .unwrap_or_else(|error| leave::<T>(color, arguments, error));
    if let Ok(Some(units)) = matches.try_get_one::<LengthUnits>("units") {
        set_units(*units);
    }
    T::from_arg_matches(&matches).unwrap_or_else(|error| leave::<T>(color, arguments, error))
}

/// Ends the process with help, or with the error of the command line. Clap quotes words of the
/// command line, so the line is parsed again without its hidden characters and that error is shown.
fn leave<T: CommandFactory>(color: ColorWhen, arguments: &[OsString], error: clap::Error) -> ! {
    let shown = arguments
        .iter()
        .map(|argument| visible(&argument.to_string_lossy()).into_owned());
    command::<T>(color, arguments)
        .try_get_matches_from(shown)
        .err()
        .unwrap_or(error)
        .exit()
}

/// The command with its help as the terminal shows it.
fn command<T: CommandFactory>(color: ColorWhen, arguments: &[OsString]) -> Command {
    let color = match color {
        ColorWhen::Always => ColorChoice::Always,
        ColorWhen::Never => ColorChoice::Never,
        ColorWhen::Auto if is_dumb() => ColorChoice::Never,
        ColorWhen::Auto => ColorChoice::Auto,
    };
    let wants_all = arguments
        .iter()
        .skip(1)
        .take_while(|argument| *argument != "--")
        .any(|argument| argument == "--help-all");
    let command = shown_options(grouped(T::command()), wants_all).color(color);
    if io::stdout().is_terminal() {
        command
    } else {
        command.term_width(columns().min(COLUMNS))
    }
}

/// Reads the value of `--color` before the command line is parsed, because errors of the command
/// line are colored, too.
fn color_said(arguments: &[OsString]) -> ColorWhen {
    let arguments: Vec<String> = arguments
        .iter()
        .map(|argument| argument.to_string_lossy().into_owned())
        .collect();
    let of_option = |(at, argument): (usize, &String)| match argument.as_str() {
        "--color" => arguments.get(at + 1).cloned(),
        argument => argument.strip_prefix("--color=").map(str::to_owned),
    };
    let said = arguments
        .iter()
        .take_while(|argument| *argument != "--")
        .enumerate()
        .find_map(of_option);
    said.and_then(|said| ColorWhen::from_str(&said, false).ok())
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_holds_together() {
        Cli::command().debug_assert();
    }

    #[test]
    fn color_is_known_before_the_rest_is_read() {
        let said =
            |words: &str| color_said(&words.split(' ').map(OsString::from).collect::<Vec<_>>());
        assert_eq!(said("feedwright run --color always x"), ColorWhen::Always);
        assert_eq!(said("feedwright --color=never"), ColorWhen::Never);
        assert_eq!(
            [
                said("feedwright -- --color=never"),
                said("feedwright --color pink")
            ],
            [ColorWhen::Auto; 2]
        );
    }
}
