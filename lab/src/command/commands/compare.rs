//! `feedwright-lab compare`: the table of all controllers on all contours and machines.

mod options;
mod print;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use feedwright::command::{Console, printed, remark};
use feedwright::{OutputFile, OutputFiles, cache_folder, key_of};
use feedwright_sim::{Machine, Watch};
use miette::{IntoDiagnostic, Result, WrapErr, miette};

use crate::command::args::compare::CompareArgs;
use crate::compare::{
    Comparison, ComparisonOptions, Finished, MissingUnits, RowsStamp, Shard, compare, journal_path, merged, page,
    recorded, rows_file, tune_alone, work_on,
};
use crate::journal::Journal;

pub(crate) fn run(args: &CompareArgs, console: &Console) -> Result<ExitCode> {
    let options = options::options(args)?;
    if let Some(threads) = args.threads {
        rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global().into_diagnostic()?;
    }
    if args.shard.is_some() && args.rows.is_none() && args.record.is_none() {
        let help = "--rows FILE keeps the rows of a shard, --record FILE its searches";
        return Err(miette!(help = help, "--shard: what it makes has no place"));
    }
    let stamp = stamp(&options);
    if !args.merge.is_empty() {
        return merge(args, &options, &stamp, console);
    }
    tell_searches(args, &options);
    let journal = match &args.rows {
        Some(path) => rows_file::open(path, &stamp)?,
        None => kept(&stamp),
    };
    if journal.damaged() > 0 {
        remark(&format!("lines of rows that are damaged, and cut anew: {}", journal.damaged()));
    }
    let known = journal.rows().filter(|finished| matches!(finished, Finished::Row(_))).count();
    if known > 0 {
        eprintln!("going on where an earlier run was interrupted; rows that are there: {known}");
    }
    if let Some(record) = &args.record {
        return record_searches(args, record, &options, journal, console);
    }
    if let (Some(shard), Some(rows)) = (args.shard, &args.rows) {
        let bar = console.bar(0);
        let results = work_on(&options, shard, &journal, &bar);
        bar.clear();
        let text = format!(
            "{} rows in {}; 'feedwright-lab compare --merge' with the files of all shards makes the table",
            results?.rows.len(),
            rows.display()
        );
        return printed(writeln!(std::io::stdout(), "{text}"), ExitCode::SUCCESS);
    }
    let mut files = ResultFiles::create(args)?;
    let bar = console.bar(0);
    let comparison = compare(&options, &journal, &bar);
    bar.clear();
    let comparison = comparison?;
    files.write(&comparison, &bar)?;
    if args.rows.is_none() {
        journal.remove();
    }
    printed(print::print(args, &comparison), ExitCode::SUCCESS)
}

/// What rows depend on: options and program.
fn stamp(options: &ComparisonOptions) -> RowsStamp {
    let program = std::env::current_exe().and_then(std::fs::read).unwrap_or_default();
    RowsStamp { options: options.fingerprint(), program: key_of(&[&program]) }
}

/// The journal of these options and this program; none where there is no place for it.
fn kept(stamp: &RowsStamp) -> Journal<Finished> {
    let key = key_of(&[stamp.options.as_bytes(), stamp.program.as_bytes()]);
    let path = cache_folder().map(|folder| journal_path(&folder, &key));
    path.and_then(|path| Journal::open(&path).ok()).unwrap_or_else(Journal::none)
}

/// A search takes a minute and more for each controller and machine.
fn tell_searches(args: &CompareArgs, options: &ComparisonOptions) {
    let searched = options.to_search();
    if args.tuning() == crate::command::args::compare::TuningSource::Recorded && !searched.is_empty() {
        const NAMED: usize = 4;
        let names: Vec<String> =
            searched.iter().take(NAMED).map(|(machine, name)| format!("{name} on {machine}")).collect();
        let more = if searched.len() > NAMED { format!(" and {} more", searched.len() - NAMED) } else { String::new() };
        eprintln!(
            "no values are recorded of {}{more}: they are searched; --tuning defaults does without",
            names.join(", ")
        );
    }
}

/// Searches, and keeps the values: no cuts, no table.
fn record_searches(
    args: &CompareArgs,
    record: &Path,
    options: &ComparisonOptions,
    journal: Journal<Finished>,
    console: &Console,
) -> Result<ExitCode> {
    let old = match std::fs::read_to_string(record) {
        Ok(text) => recorded::read(&text)
            .into_diagnostic()
            .wrap_err_with(|| format!("{} holds other things than recorded values", record.display()))?,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Vec::new(),
        Err(error) => return Err(error).into_diagnostic().wrap_err_with(|| record.display().to_string()),
    };
    let bar = console.bar(0);
    let tuned = tune_alone(options, args.shard.unwrap_or(Shard::ALL), &journal, &bar);
    bar.clear();
    let tuned = tuned?;
    let machines: Vec<Machine> = options.machines.iter().chain([&options.nominal]).cloned().collect();
    let mut file = OutputFiles::new(std::iter::empty::<&Path>()).start(record)?;
    file.write_all(recorded::text(old, &tuned, &machines, options.seed).as_bytes()).into_diagnostic()?;
    OutputFile::commit_all(vec![file], &bar)?;
    if args.rows.is_none() {
        journal.remove();
    }
    let text = print::tuned(&tuned);
    printed(
        writeln!(std::io::stdout(), "{text}recorded {} searches in {}", tuned.len(), record.display()),
        ExitCode::SUCCESS,
    )
}

/// Puts the rows of shards together.
fn merge(args: &CompareArgs, options: &ComparisonOptions, stamp: &RowsStamp, console: &Console) -> Result<ExitCode> {
    let journal = rows_file::read_all(&args.merge, stamp)?;
    let results = merged(options, &journal).map_err(|MissingUnits { units }| {
        const NAMED: usize = 12;
        let more = if units.len() > NAMED { format!("\nand {} more", units.len() - NAMED) } else { String::new() };
        let names: Vec<&str> = units.iter().take(NAMED).map(String::as_str).collect();
        let help = "cut the shards that are missing, or go on with those that were interrupted, and merge again";
        miette!(help = help, "the rows are not complete; missing are\n{}{more}", names.join("\n"))
    })?;
    let mut files = ResultFiles::create(args)?;
    let comparison = Comparison::new(options, results);
    files.write(&comparison, &console.bar(0))?;
    printed(print::print(args, &comparison), ExitCode::SUCCESS)
}

/// The files that are asked for, made before the work begins.
struct ResultFiles {
    json: Option<OutputFile>,
    html: Option<OutputFile>,
}

impl ResultFiles {
    fn create(args: &CompareArgs) -> Result<Self> {
        let machines: Vec<PathBuf> = args.machine.iter().map(PathBuf::from).collect();
        let inputs = args.part.iter().chain(&machines).chain(&args.reader.tool_table);
        let inputs: Vec<&Path> = inputs.chain(&args.merge).chain(&args.rows).map(PathBuf::as_path).collect();
        let mut files = OutputFiles::new(inputs);
        let mut start = |path: &Option<PathBuf>| path.as_ref().map(|path| files.start(path)).transpose();
        Ok(Self { json: start(&args.json)?, html: start(&args.html)? })
    }

    fn write(&mut self, comparison: &Comparison, watch: &dyn Watch) -> Result<()> {
        let mut complete = Vec::new();
        if let Some(mut file) = self.json.take() {
            serde_json::to_writer_pretty(&mut file, comparison).into_diagnostic().wrap_err("cannot write the rows")?;
            file.write_all(b"\n").into_diagnostic()?;
            complete.push(file);
        }
        if let Some(mut file) = self.html.take() {
            page::write(&mut file, comparison).into_diagnostic()?;
            complete.push(file);
        }
        OutputFile::commit_all(complete, watch)?;
        Ok(())
    }
}
