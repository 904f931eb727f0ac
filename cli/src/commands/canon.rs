//! `feedwright canon`: canonical motions and events, one JSON object a line.

use std::io::{self, Write};
use std::process::ExitCode;

use feedwright::gcode::{Reader, canon::Canon};
use miette::Result;
use rayon::prelude::*;

use crate::args::CanonArgs;
use crate::message::{fail, printed};

pub(crate) fn run(args: &CanonArgs, quiet: bool) -> Result<ExitCode> {
    let reader = Reader::open(&args.file, args.reader.settings()?)?;
    if !quiet {
        let (dialect, reason) = reader.dialect();
        eprintln!("{}: read as {dialect}: {reason}", args.file.display());
    }
    let mut code = ExitCode::SUCCESS;
    let result = print(reader, &mut code);
    printed(result, code)
}

/// Steps that are read before they are written down, on all cores: writing numbers takes twice the time of reading them.
const BATCH: usize = 4096;
/// Steps that one core writes down at a time.
const SHARE: usize = 512;

fn print(mut reader: Reader, code: &mut ExitCode) -> io::Result<()> {
    let mut out = io::stdout().lock();
    let mut batch = Vec::with_capacity(BATCH);
    // Kept from batch to batch, each with the memory that it has come to.
    let mut texts = vec![Vec::new(); BATCH / SHARE];
    // Behind a faulty line nobody knows where the tool is: faults are told, motions are not written down any more.
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
        batch.par_chunks(SHARE).zip(&mut texts).try_for_each(|(steps, text)| write_lines(text, steps))?;
        for text in &mut texts {
            out.write_all(text)?;
            text.clear();
        }
        batch.clear();
    }
}

/// One JSON object a line.
fn write_lines(text: &mut Vec<u8>, steps: &[Canon]) -> io::Result<()> {
    for step in steps {
        serde_json::to_writer(&mut *text, step)?;
        text.push(b'\n');
    }
    Ok(())
}
