//! `feedwright canon`: canonical motions and events, one JSON object a line.

use std::io::{BufWriter, Write};
use std::process::ExitCode;

use feedwright::gcode::{Reader, Settings};
use miette::{IntoDiagnostic, Result};

use crate::args::CanonArgs;
use crate::message::fail;

pub(crate) fn run(args: &CanonArgs) -> Result<ExitCode> {
    let mut code = ExitCode::SUCCESS;
    let mut out = BufWriter::new(std::io::stdout().lock());
    for step in Reader::open(&args.file, Settings::default())? {
        match step {
            Ok(step) => {
                serde_json::to_writer(&mut out, &step).into_diagnostic()?;
                out.write_all(b"\n").into_diagnostic()?;
            }
            Err(fault) => code = fail(&fault.into()),
        }
    }
    out.flush().into_diagnostic()?;
    Ok(code)
}
