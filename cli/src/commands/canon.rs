//! `feedwright canon`: canonical motions and events, one JSON object a line.

use std::io::{self, BufWriter, Write};
use std::process::ExitCode;

use feedwright::gcode::Reader;
use miette::Result;

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

fn print(reader: Reader, code: &mut ExitCode) -> io::Result<()> {
    let mut out = BufWriter::new(io::stdout().lock());
    for step in reader {
        match step {
            Ok(step) => {
                serde_json::to_writer(&mut out, &step)?;
                out.write_all(b"\n")?;
            }
            Err(fault) => *code = fail(&fault.into()),
        }
    }
    out.flush()
}
