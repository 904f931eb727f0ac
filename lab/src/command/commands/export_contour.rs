//! `feedwright-lab export-contour`: a built-in contour as a program.
use std::process::ExitCode;

use feedwright::OutputFiles;
use feedwright::command::{Console, remark};
use miette::{Result, miette};

use crate::command::args::export_contour::ExportContourArgs;
use crate::command::sweep::{say_place, write_text};
use crate::contour::contour;
use crate::contour_program::contour_program;

/// Below, digits are cut off; above, it is no more the contour, um.
const LEAST_UM: f64 = 0.01;
const MOST_UM: f64 = 100.0;
/// No machine is faster, mm/s.
const MOST_MM_S: f64 = 1e4;

pub(crate) fn run(args: &ExportContourArgs, console: &Console) -> Result<ExitCode> {
    let (feed, tolerance) = (args.feed, args.tolerance);
    if !(feed > 0.0 && feed <= MOST_MM_S) {
        return Err(miette!(
            "--feed is {feed} mm/s; it must lie above 0 and up to {MOST_MM_S} mm/s"
        ));
    }
    if !(LEAST_UM..=MOST_UM).contains(&tolerance) {
        let help = "the unit is um: 0.001 mm is --tolerance 1";
        return Err(miette!(
            help = help,
            "--tolerance is {tolerance} um; it must be from {LEAST_UM} to {MOST_UM} um"
        ));
    }
    let contour =
        contour(&args.contour).ok_or_else(|| miette!("no contour is called '{}'", args.contour))?;
    let program = contour_program(contour, feed, 1e-3 * tolerance)?;
    write_text(OutputFiles::default(), &args.out, &program.text, console)?;
    if !console.is_quiet() {
        let how = match program.is_exact {
            true => String::new(),
            false => format!(" within {tolerance} um of the curve"),
        };
        let (blocks, s) = (program.blocks, if program.blocks == 1 { "" } else { "s" });
        remark(&format!(
            "{}: {}; {blocks} block{s}{how}",
            contour.name, contour.about
        ));
    }
    say_place(&args.out)
}
