//! `feedwright-lab compare`: the table of all controllers on all contours and machines.

mod options;
mod print;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use feedwright::command::{Console, printed};
use feedwright::{OutputFile, OutputFiles};
use miette::{IntoDiagnostic, Result, WrapErr};

use crate::command::args::compare::{CompareArgs, TuningSource};
use crate::compare::{ComparisonOptions, compare, recorded, tune_alone};
use crate::study::Kept;

pub(crate) fn run(args: &CompareArgs, console: &Console) -> Result<ExitCode> {
    let options = options::options(args)?;
    if let Some(threads) = args.threads {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads.into())
            .build_global()
            .into_diagnostic()?;
    }
    report_searches(args, &options);
    let kept = Kept::open(args.results.as_deref(), &options.fingerprint())?;
    if let Some(record) = &args.record {
        return record_searches(record, &options, kept, console);
    }
    let json = start_json(args)?;
    let bar = console.bar(0);
    let comparison = compare(&options, &kept, &bar);
    bar.clear();
    let comparison = comparison?;
    if let Some(mut file) = json {
        file.write_all(comparison.text().as_bytes())
            .into_diagnostic()
            .wrap_err("cannot write the rows")?;
        OutputFile::commit_all(vec![file], &bar)?;
    }
    if kept.found() > 0 {
        let found = kept.found();
        eprintln!("parts of the work that an earlier run had finished: {found}");
    }
    kept.complete();
    printed(print::print(args, &comparison), ExitCode::SUCCESS)
}

/// A search takes a minute and more for each controller and machine.
fn report_searches(args: &CompareArgs, options: &ComparisonOptions) {
    const NAMED: usize = 4;
    let searched = options.to_search();
    if args.tuning() != TuningSource::Recorded || searched.is_empty() {
        return;
    }
    let name = |(machine, name): &(String, &str)| format!("{name} on {machine}");
    let names: Vec<String> = searched.iter().take(NAMED).map(name).collect();
    let more = match searched.len().saturating_sub(NAMED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    eprintln!(
        "no values are recorded of {}{more}: they are searched; --tuning defaults does without",
        names.join(", ")
    );
}

/// Searches, and keeps the values: no cuts, no table.
fn record_searches(
    record: &Path,
    options: &ComparisonOptions,
    kept: Kept,
    console: &Console,
) -> Result<ExitCode> {
    let shown = record.display();
    let old = match std::fs::read_to_string(record) {
        Ok(text) => recorded::read(&text)
            .into_diagnostic()
            .wrap_err_with(|| format!("{shown} holds other things than recorded values"))?,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Vec::new(),
        Err(error) => return Err(error).into_diagnostic().wrap_err(shown.to_string()),
    };
    let bar = console.bar(0);
    let tuned = tune_alone(options, &kept, &bar);
    bar.clear();
    let tuned = tuned?;
    let machines = [
        &options.machines[..],
        std::slice::from_ref(&options.nominal),
    ]
    .concat();
    let mut file = OutputFiles::default().start(record)?;
    file.write_all(recorded::text(old, &tuned, &machines, options.seed).as_bytes())
        .into_diagnostic()?;
    OutputFile::commit_all(vec![file], &bar)?;
    kept.complete();
    let (text, count) = (print::tuned(&tuned), tuned.len());
    let mut out = std::io::stdout();
    let printing = writeln!(out, "{text}recorded {count} searches in {shown}");
    printed(printing, ExitCode::SUCCESS)
}

/// Starts the file that is asked for before the work begins.
fn start_json(args: &CompareArgs) -> Result<Option<OutputFile>> {
    let machines: Vec<PathBuf> = args.machine.iter().map(PathBuf::from).collect();
    let inputs = args
        .part
        .iter()
        .chain(&machines)
        .chain(&args.reader.tool_table);
    let mut files = OutputFiles::new(inputs.map(PathBuf::as_path));
    Ok(args
        .json
        .as_ref()
        .map(|path| files.start(path))
        .transpose()?)
}
