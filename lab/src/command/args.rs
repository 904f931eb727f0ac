//! The command line: a file of options for each command.

pub(crate) mod sweep;
pub(crate) mod compare;
pub(crate) mod mismatch;
pub(crate) mod independent;
pub(crate) mod never_worse;
pub(crate) mod held_out;
pub(crate) mod paper;
pub(crate) mod export_contour;
pub(crate) mod ball_bar;

use clap::{Parser, Subcommand};
use feedwright::command::{COLUMNS, CommonArgs, RunArgs};

use ball_bar::BallBarArgs;
use compare::CompareArgs;
use export_contour::ExportContourArgs;
use held_out::HeldOutArgs;
use independent::IndependentArgs;
use mismatch::MismatchArgs;
use never_worse::NeverWorseArgs;
use paper::PaperArgs;

/// The laboratory of feedwright: compare methods, and repeat the experiments of the paper
///
/// It has the published controllers beside those of feedwright, work that no setting was tuned on,
/// and the experiments of Lee, Cho and Jeon (2005).
#[derive(Debug, Parser)]
#[command(name = "feedwright-lab", version, propagate_version = true, max_term_width = COLUMNS, after_long_help = AFTER)]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) common: CommonArgs,
    #[command(subcommand)]
    pub(crate) command: CommandArgs,
}

const AFTER: &str = "\
Files, exit codes and environment variables are those of feedwright; `feedwright --help` has them. `feedwright lab COMMAND` starts \
COMMAND of this program.";

#[derive(Debug, Subcommand)]
pub(crate) enum CommandArgs {
    Compare(CompareArgs),
    NeverWorse(NeverWorseArgs),
    HeldOut(HeldOutArgs),
    Mismatch(MismatchArgs),
    Independent(IndependentArgs),
    Paper(PaperArgs),
    Run(Box<RunArgs>),
    /// List all controllers, or the parameters of one
    Controllers {
        /// Its name.
        name: Option<String>,
    },
    ExportContour(ExportContourArgs),
    BallBar(BallBarArgs),
}
