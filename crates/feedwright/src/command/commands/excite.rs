//! `feedwright excite`: a program to record a log with.
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use feedwright_ident::{BallBarProgram, ExciteOptions, GridProgram, excitation_program};
use feedwright_sim::{Machine, is_machine_path};
use miette::Result;

use crate::command::args::excite::ExciteArgs;
use crate::command::console::Console;
use crate::command::message::printed;
use crate::command::streams::{report_written, tables};
use crate::command::terminal::wrapped;
use crate::output::{OutputError, OutputFile, OutputFiles};

pub(crate) fn run(args: &ExciteArgs, console: &Console) -> Result<ExitCode> {
    let machine = Machine::load(&args.machine)?;
    let input = Some(PathBuf::from(&args.machine)).filter(|path| is_machine_path(path));
    let (program, said) = program(args, &machine)?;
    let mut file = OutputFiles::new(input.as_deref()).start(&args.out)?;
    file.write_all(program.as_bytes())
        .map_err(|error| OutputError::from_io(error, &args.out))?;
    OutputFile::commit_all(vec![file], &console.bar(0))?;
    let place = Some(args.out.as_path());
    let mut out = tables([place]);
    let reported =
        writeln!(out, "{}", wrapped(&said, 2)).and_then(|()| report_written(&mut *out, [place]));
    printed(reported, ExitCode::SUCCESS)
}

/// The program, and what to say of it.
fn program(args: &ExciteArgs, machine: &Machine) -> Result<(String, String)> {
    let feed_mm_min = args.feed.min(60.0 * machine.limits.max_feed_mm_s);
    if let Some(radius_mm) = args.ballbar {
        let plane = match args.plane.as_str() {
            "xz" => [0, 2],
            "yz" => [1, 2],
            _ => [0, 1],
        };
        let program = BallBarProgram {
            radius_mm,
            feed_mm_min,
            plane,
        };
        let said = format!(
            "ball bar of {radius_mm} mm in {} at {feed_mm_min} mm/min, both directions, about the zero of the work coordinates; it stops where \
             the bar is mounted and where its record ends",
            args.plane
        );
        return Ok((program.text(), said));
    }
    if let Some(step_mm) = args.grid {
        let program = GridProgram {
            travel_mm: args.travel,
            step_mm,
            feed_mm_min,
        };
        let said = format!(
            "grid over {} mm from the zero of the work coordinates, points {step_mm} mm apart",
            args.travel
        );
        return Ok((program.text(), said));
    }
    let program = excitation_program(
        machine,
        ExciteOptions {
            travel_mm: args.travel,
        },
    )?;
    let (axes, takes_s, feed_mm_s) = (machine.axis_count(), program.takes_s, program.max_feed_mm_s);
    let said = format!(
        "{axes} axes, about {takes_s:.0} s, at most {feed_mm_s:.1} mm/s, within {} mm on each side of where the machine stands; the first \
         lines of the program say what to check before, and how to record",
        0.5 * args.travel
    );
    Ok((program.text, said))
}
