//! `feedwright compare`: the table of all controllers on all contours and machines.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use feedwright::compare::table::ComparisonRow;
use feedwright::compare::tolerance::{AtTolerance, TOLERANCE_UM};
use feedwright::compare::verdict::Verdict;
use feedwright::compare::{Comparison, ComparisonOptions, Finished, Tuning, Workpiece, compare, journal_path, page};
use feedwright::controllers::{BASELINE, CONTROLLERS, Entry};
use feedwright::gcode::suggestion::nearest;
use feedwright::identify::cache;
use feedwright::journal::Journal;
use feedwright::machine::{BUILT_IN, Machine};
use feedwright::output::{OutputFile, OutputFiles};
use feedwright::watch::Watch;
use miette::{IntoDiagnostic, Result, WrapErr, miette};

use crate::args::CompareArgs;
use crate::console::Console;
use crate::controllers;
use crate::message::printed;

pub(crate) fn run(args: &CompareArgs, console: &Console) -> Result<ExitCode> {
    let options = options(args)?;
    if let Some(threads) = args.threads {
        rayon::ThreadPoolBuilder::new().num_threads(threads.into()).build_global().into_diagnostic()?;
    }
    let mut files = ResultFiles::create(args)?;
    let journal = journal(&options);
    let known = journal.rows().filter(|finished| matches!(finished, Finished::Row(_))).count();
    if known > 0 {
        eprintln!("going on where an earlier run was interrupted; rows that are there: {known}");
    }
    let bar = console.bar(0);
    let comparison = compare(&options, &journal, &bar);
    bar.clear();
    let comparison = comparison?;
    files.write(&comparison, &bar)?;
    journal.remove();
    printed(print(args, &comparison), ExitCode::SUCCESS)
}

fn options(args: &CompareArgs) -> Result<ComparisonOptions> {
    let mut workpieces = Workpiece::contours();
    let mut machines: Vec<Machine> =
        BUILT_IN.iter().map(|(name, _)| Machine::load(name.as_ref())).collect::<Result<_, _>>()?;
    let mut controllers: Vec<&'static Entry> = CONTROLLERS.iter().collect();
    let known: Vec<String> = (workpieces.iter().map(|w| w.name.clone()))
        .chain(machines.iter().map(|m| m.name.clone()))
        .chain(controllers.iter().map(|c| c.name.to_owned()))
        .collect();
    for name in &args.only {
        if !known.contains(name) {
            let names: Vec<&str> = known.iter().map(String::as_str).collect();
            let help = match nearest(name, &names) {
                Some(meant) => format!("did you mean '{meant}'?"),
                None => format!("there are {}; what --part and --machine add is always cut", known.join(", ")),
            };
            return Err(miette!(help = help, "--only: no contour, machine or controller is called '{name}'"));
        }
    }
    let named = |name: &str| args.only.iter().any(|only| only == name);
    if workpieces.iter().any(|w| named(&w.name)) || !args.part.is_empty() && !args.only.is_empty() {
        workpieces.retain(|w| named(&w.name));
    }
    if machines.iter().any(|m| named(&m.name)) {
        // The first is what the controllers know.
        let nominal = machines[0].name.clone();
        machines.retain(|m| named(&m.name) || m.name == nominal);
    }
    if controllers.iter().any(|c| named(c.name)) {
        controllers.retain(|c| named(c.name) || c.name == BASELINE);
    }
    let settings = args.reader.settings()?;
    for part in &args.part {
        let part = Workpiece::program(part, settings.clone())?;
        if workpieces.iter().any(|w| w.name == part.name) {
            return Err(ambiguous("--part", &part.name));
        }
        workpieces.push(part);
    }
    for machine in &args.machine {
        let machine = Machine::load(machine)?;
        match machines.iter().find(|m| m.name == machine.name) {
            // All that are built in are there already.
            Some(there) if *there == machine => {}
            Some(_) => return Err(ambiguous("--machine", &machine.name)),
            None => machines.push(machine),
        }
    }
    let set = controllers::settings(&args.set, None, &controllers)?;
    Ok(ComparisonOptions {
        workpieces,
        machines,
        controllers,
        seed: args.seed,
        tuning: if args.no_tuning { Tuning::Defaults } else { Tuning::Search },
        set,
        at_tolerance: args.at_tolerance,
    })
}

/// The rows of two that have the same name could not be told apart.
fn ambiguous(option: &str, name: &str) -> miette::Report {
    let help = match option {
        "--part" => "the name is that of the file: give this one another",
        _ => "give it another `name` in its file, or choose from those that are built in with --only",
    };
    miette!(help = help, "{option}: there is another '{name}' in the table")
}

/// The journal of these options and this program; none where there is no place for it.
fn journal(options: &ComparisonOptions) -> Journal<Finished> {
    let program = std::env::current_exe().and_then(std::fs::read).unwrap_or_default();
    let key = cache::key_of(&[options.fingerprint().as_bytes(), &program]);
    let path = cache::folder().map(|folder| journal_path(&folder, &key));
    path.and_then(|path| Journal::open(&path).ok()).unwrap_or_else(Journal::none)
}

/// The files that are asked for, made before the work begins.
struct ResultFiles {
    json: Option<OutputFile>,
    html: Option<OutputFile>,
}

impl ResultFiles {
    fn create(args: &CompareArgs) -> Result<Self> {
        let machines: Vec<PathBuf> = args.machine.iter().map(PathBuf::from).collect();
        let inputs: Vec<&Path> =
            args.part.iter().chain(&machines).chain(&args.reader.tool_table).map(PathBuf::as_path).collect();
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

fn print(args: &CompareArgs, comparison: &Comparison) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    for tuned in comparison.tuned.iter().filter(|tuned| tuned.cuts > 0) {
        let values: Vec<String> = tuned.values.iter().map(|(name, value)| format!("{name} {value:.3e}")).collect();
        writeln!(
            out,
            "tuned {}: {} ({} cuts, {:.2} um)",
            tuned.controller,
            values.join(", "),
            tuned.cuts,
            tuned.rms_um
        )?;
    }
    print_rows(&mut out, &comparison.rows)?;
    print_at_tolerance(&mut out, &comparison.at_tolerance)?;
    print_verdicts(&mut out, &comparison.verdicts)?;
    for path in [&args.json, &args.html].into_iter().flatten() {
        writeln!(out, "wrote {}", path.display())?;
    }
    Ok(())
}

fn print_rows(out: &mut impl Write, rows: &[ComparisonRow]) -> std::io::Result<()> {
    let mut heading = String::new();
    for row in rows {
        let here = format!("{} on {}", row.contour, row.machine);
        if here != heading {
            writeln!(
                out,
                "\n{here:<34} {:>8} {:>9} {:>9} {:>9} {:>6} {:>6} {:>6} {:>8} {:>7}",
                "time s", "RMS um", "max um", "uncut um", "time", "RMS", "max", "off um", "N m"
            )?;
            heading = here;
        }
        let note = match (&row.faded_out, row.completed) {
            (_, false) => "  diverged".to_owned(),
            (Some(cause), true) => format!("  left the loop: {cause}"),
            (None, true) => String::new(),
        };
        writeln!(
            out,
            "{:<34} {:>8.3} {:>9.2} {:>9.2} {:>9.2} {:>6.3} {:>6.3} {:>6.3} {:>8.0} {:>7.2}{note}",
            row.controller,
            row.time_s,
            row.rms_um,
            row.max_um,
            row.uncut_um,
            row.time_ratio,
            row.rms_ratio,
            row.max_ratio,
            row.max_deviation_um,
            row.peak_torque_nm,
        )?;
    }
    Ok(())
}

fn print_at_tolerance(out: &mut impl Write, rows: &[AtTolerance]) -> std::io::Result<()> {
    if rows.is_empty() {
        return Ok(());
    }
    let limit = format!("max {TOLERANCE_UM} um");
    writeln!(out, "\n{limit:<20} {:<28} {:>9} {:>9} {:>6}", "", "feed mm/s", "time s", "time")?;
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.3}"));
    for row in rows {
        let feed = row.feed_mm_s.map_or("-".to_owned(), |feed| format!("{feed:.1}"));
        let (time, ratio) = (number(row.time_s), number(row.time_ratio));
        writeln!(out, "{:<20} {:<28} {feed:>9} {time:>9} {ratio:>6}", row.contour, row.controller)?;
    }
    Ok(())
}

fn print_verdicts(out: &mut impl Write, verdicts: &[Verdict]) -> std::io::Result<()> {
    if verdicts.is_empty() {
        return Ok(());
    }
    writeln!(out, "\n{:<66} {:<18} {:<10} {:>6} {:>6}", "", "", "", "ratio", "limit")?;
    for verdict in verdicts {
        writeln!(
            out,
            "{:<66} {:<18} {:<10} {:>6.3} {:>6.3}  {} ({})",
            verdict.claim,
            verdict.contour,
            verdict.machine,
            verdict.value,
            verdict.limit,
            if verdict.holds { "holds" } else { "FALLS SHORT" },
            verdict.against
        )?;
    }
    let held = verdicts.iter().filter(|verdict| verdict.holds).count();
    writeln!(out, "{held} of {} claims hold", verdicts.len())
}
