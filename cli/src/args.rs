//! The command line: a file of options for each command.

pub(crate) mod reader;
pub(crate) mod sweep;
pub(crate) mod run;
pub(crate) mod correct;
pub(crate) mod plan;
pub(crate) mod identify;
pub(crate) mod excite;
pub(crate) mod block;
pub(crate) mod paper;
pub(crate) mod compare;
pub(crate) mod never_worse;
pub(crate) mod held_out;
pub(crate) mod check;
pub(crate) mod canon;

use clap::{Parser, Subcommand};

use block::BlockArgs;
use canon::CanonArgs;
use check::CheckArgs;
use compare::CompareArgs;
use correct::CorrectArgs;
use excite::ExciteArgs;
use held_out::HeldOutArgs;
use identify::IdentifyArgs;
use never_worse::NeverWorseArgs;
use paper::PaperArgs;
use plan::PlanArgs;
use run::RunArgs;

/// Predict the contour error of a CNC program on a machine, and correct it.
#[derive(Debug, Parser)]
#[command(version, max_term_width = 110)]
pub(crate) struct Cli {
    /// Show no progress, and not as what a program is read.
    #[arg(short, long, global = true)]
    pub(crate) quiet: bool,
    #[command(subcommand)]
    pub(crate) command: CommandArgs,
}

#[derive(Debug, Subcommand)]
pub(crate) enum CommandArgs {
    /// Cut a part on a simulated machine, open loop and with a controller, and write the report.
    Run(Box<RunArgs>),
    /// Write a corrected program for a control that gets no feedback from us, and tell what it comes to as that control cuts it.
    Correct(CorrectArgs),
    /// Tell the cycle time of a program on a machine: by tool, by kind of motion, and what binds it.
    Plan(PlanArgs),
    /// Identify a machine from its LOG, and write its machine file; without a LOG, identify a simulated machine and write the
    /// model that a controller of `run` uses, for `run --model`.
    Identify(IdentifyArgs),
    /// Write a G-code program that shows how the axes of a machine behave: run it, record a log, identify the machine from it.
    Excite(ExciteArgs),
    /// Write what a component in a servo thread reads: a model, or a machine with exactly the numbers of its file, as a block of bytes.
    Block(BlockArgs),
    /// Run the experiments of Lee, Cho and Jeon (2005), section 4, and draw Figures 7 to 10.
    Paper(PaperArgs),
    /// Compare all controllers on contours and machines, in one table.
    Compare(CompareArgs),
    /// Cut programs on many machines, open loop and corrected, and list where the correction did harm.
    NeverWorse(NeverWorseArgs),
    /// The same with random programs on random machines, and the smallest case of what fails.
    HeldOut(HeldOutArgs),
    /// Report all mistakes of G-code programs, machine files and model files; of a folder, of all programs in it.
    Check(CheckArgs),
    /// Print the canonical motions of a program, one JSON object a line, in mm and s.
    Canon(CanonArgs),
    /// List the built-in machines.
    Machines,
    /// List the controllers; with a name, all of one and of its parameters.
    Controllers {
        /// Its name.
        name: Option<String>,
    },
}
