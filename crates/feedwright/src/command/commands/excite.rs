//! `feedwright excite`: a program to record a log with.
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use feedwright_ident::{ExciteOptions, excitation_program};
use feedwright_sim::{Machine, is_machine_path};
use miette::Result;

use crate::command::args::excite::ExciteArgs;
use crate::command::console::Console;
use crate::command::message::printed;
use crate::command::streams::{tables, tell_written};
use crate::command::terminal::wrapped;
use crate::output::{OutputError, OutputFile, OutputFiles};

pub(crate) fn run(args: &ExciteArgs, console: &Console) -> Result<ExitCode> {
    let machine = Machine::load(&args.machine)?;
    let input = Some(PathBuf::from(&args.machine)).filter(|path| is_machine_path(path));
    let program = excitation_program(&machine, ExciteOptions { travel_mm: args.travel })?;
    let mut file = OutputFiles::new(input.as_deref()).start(&args.out)?;
    file.write_all(program.text.as_bytes()).map_err(|error| OutputError::from_io(error, &args.out))?;
    OutputFile::commit_all(vec![file], &console.bar(0))?;
    let (axes, takes_s, feed_mm_s) = (machine.axis_count(), program.takes_s, program.max_feed_mm_s);
    let place = Some(args.out.as_path());
    let text = format!(
        "{axes} axes, about {takes_s:.0} s, at most {feed_mm_s:.1} mm/s, within {} mm on each side of where the machine stands; the first \
         lines of the program say what to check before, and how to record",
        0.5 * args.travel
    );
    let mut out = tables([place]);
    let told = writeln!(out, "{}", wrapped(&text, 2)).and_then(|()| tell_written(&mut *out, [place]));
    printed(told, ExitCode::SUCCESS)
}
