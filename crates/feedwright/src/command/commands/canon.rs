//! `feedwright canon`: canonical motions and events, one JSON object a line.

mod lines;

use std::io::{self, Write};
use std::process::ExitCode;

use feedwright_gcode::{Reader, input};
use miette::Result;
use rayon::prelude::*;

use crate::command::args::canon::CanonArgs;
use crate::command::console::Console;
use crate::command::message::{fail, printed};
use crate::command::streams::check_inputs;
use lines::Lines;

pub(crate) fn run(args: &CanonArgs, console: &Console) -> Result<ExitCode> {
    let tools = args.reader.tool_table.as_deref();
    check_inputs(
        console,
        [
            ("the program", Some(args.file.as_path())),
            ("--tool-table", tools),
        ],
    )?;
    let reader = Reader::open(&args.file, args.reader.settings()?)?;
    if !console.is_quiet() {
        let (dialect, reason) = reader.dialect();
        eprintln!("{}: read as {dialect}: {reason}", input::name(&args.file));
    }
    let mut code = ExitCode::SUCCESS;
    let result = print(reader, &mut code);
    printed(result, code)
}

/// Steps that are read before they are written down, on all cores: writing numbers takes twice the
/// time of reading them.
const BATCH: usize = 4096;
/// Steps that one core writes down at a time.
const SHARE: usize = 512;

fn print(mut reader: Reader, code: &mut ExitCode) -> io::Result<()> {
    let mut out = io::stdout().lock();
    let mut batch = Vec::with_capacity(BATCH);
    // Kept from batch to batch, each with the memory that it has come to.
    let mut shares: Vec<Lines> = (0..BATCH / SHARE).map(|_| Lines::default()).collect();
    // After a faulty line the position of the tool is unknown: faults are still reported, but no
    // more motions and events are written.
    let mut is_faulty = false;
    loop {
        let mut read = 0;
        for step in reader.by_ref().take(BATCH) {
            read += 1;
            match step {
                Ok(step) if !is_faulty => batch.push(step),
                Ok(_) => {}
                Err(fault) => {
                    is_faulty = true;
                    *code = fail(&fault.into());
                }
            }
        }
        if read == 0 {
            return out.flush();
        }
        batch
            .par_chunks(SHARE)
            .zip(&mut shares)
            .try_for_each(|(steps, lines)| lines.write(steps))?;
        for Lines { text, .. } in &mut shares {
            out.write_all(text)?;
            text.clear();
        }
        batch.clear();
    }
}
