//! `feedwright excite`: a program to record a log with.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use feedwright::excite::{ExciteOptions, program};
use feedwright::machine::{self, Machine};
use feedwright::output::{OutputError, OutputFile, OutputFiles};
use miette::Result;

use crate::args::excite::ExciteArgs;
use crate::console::Console;
use crate::message::printed;
use crate::streams::{tables, tell_written};
use crate::terminal::wrapped;

pub(crate) fn run(args: &ExciteArgs, console: &Console) -> Result<ExitCode> {
    let machine = Machine::load(&args.machine)?;
    let input = Some(PathBuf::from(&args.machine)).filter(|path| machine::is_path(path));
    let program = program(&machine, ExciteOptions { travel_mm: args.travel })?;
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
