//! `feedwright merge`: the results of sweeps as one table.

use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use miette::{Result, miette};

use crate::command::args::sweep::MergeArgs;
use crate::command::console::Console;
use crate::command::message::printed;
use crate::command::streams::{report_written, tables};
use crate::command::sweep::result_table::ResultTable;
use crate::output::{OutputError, OutputFile, OutputFiles, is_standard_output};

pub(crate) fn run(args: &MergeArgs, console: &Console) -> Result<ExitCode> {
    let write = writer(&args.out)?;
    let mut file = OutputFiles::default().start(&args.out)?;
    let bar = console.bar(0);
    let table = ResultTable::of(&args.folders, &bar);
    bar.clear();
    let table = table?;
    write(&table, &mut file).map_err(|error| OutputError::from_io(error, &args.out))?;
    OutputFile::commit_all(vec![file], &bar)?;
    let place = Some(args.out.as_path());
    let mut out = tables([place]);
    let reported = writeln!(out, "{} results", table.rows.len())
        .and_then(|()| report_written(&mut *out, [place]));
    printed(reported, ExitCode::SUCCESS)
}

/// Returns the function that writes a table with the ending of `path`. The standard output gets
/// CSV.
fn writer(path: &Path) -> Result<fn(&ResultTable, &mut OutputFile) -> io::Result<()>> {
    match path.extension().and_then(|ending| ending.to_str()) {
        Some("csv") => Ok(ResultTable::write_csv),
        Some("jsonl") => Ok(ResultTable::write_json_lines),
        _ if is_standard_output(path) => Ok(ResultTable::write_csv),
        _ => Err(miette!(
            help = "the ending decides: .csv or .jsonl; Parquet is written in Python: feedwright.merge(FOLDER).to_parquet(FILE)",
            "{} does not say what to write",
            path.display()
        )),
    }
}
