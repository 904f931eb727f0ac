//! `feedwright identify LOG`: the machine file of a real machine.

use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use feedwright::identify::grey_box::found_axis::AxisFacts;
use feedwright::log::Log;
use feedwright::log_job::{LogIdentified, LogJob, machine_text, write_json, write_page};
use feedwright::machine::Machine;
use feedwright::output::{OutputError, OutputFile, OutputFiles};
use miette::Result;

use crate::args::{IdentifyArgs, LogArgs};
use crate::console::Console;
use crate::message::printed;

pub(super) fn run(path: &Path, args: &IdentifyArgs, console: &Console) -> Result<ExitCode> {
    let of_log = &args.of_log;
    let columns = of_log.columns.clone().unwrap_or_default();
    let mut files = OutputFiles::new([path]);
    let start = |files: &mut OutputFiles, path: &Path| files.start(path);
    let mut machine = start(&mut files, &args.out)?;
    let mut json = of_log.json.as_deref().map(|path| start(&mut files, path)).transpose()?;
    let mut page = of_log.report.as_deref().map(|path| start(&mut files, path)).transpose()?;
    let bar = console.bar(0);
    let log = Log::read_watched(path, &columns, &bar)?;
    if !console.is_quiet() {
        bar.aside(|| log.findings.iter().for_each(|finding| eprintln!("{finding}")));
    }
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    let identified = job(name, of_log).run(log, &bar)?;
    let text = machine_text(&identified, &stem(&args.out));
    // Whatever was found, the file is one that reads back.
    Machine::parse(&args.out.display().to_string(), &text)?;
    let written = |error, file: &OutputFile| OutputError::from_io(error, file.path());
    machine.write_all(text.as_bytes()).map_err(|error| written(error, &machine))?;
    if let Some(file) = &mut json {
        write_json(file, &identified).map_err(|error| written(error, file))?;
    }
    if let Some(file) = &mut page {
        write_page(file, &identified).map_err(|error| written(error, file))?;
    }
    let all: Vec<OutputFile> = [Some(machine), json, page].into_iter().flatten().collect();
    let places: Vec<String> = all.iter().map(|file| file.path().display().to_string()).collect();
    bar.clear();
    OutputFile::commit_all(all, &bar)?;
    printed(print(&identified, &places), ExitCode::SUCCESS)
}

fn job(name: String, args: &LogArgs) -> LogJob {
    let times_s = args.fit.clone().zip(args.score.clone()).map(|(fit, score)| [fit.0, score.0]);
    let LogArgs { inertia, viscous, lead, torque_gain, .. } = *args;
    LogJob { name, times_s, facts: AxisFacts { inertia, viscous, lead_mm_per_rev: lead, torque_gain } }
}

/// What the machine is called: as its file.
fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "mine".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

fn print(identified: &LogIdentified, places: &[String]) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    write!(out, "{}", identified.table())?;
    for line in identified.advice() {
        writeln!(out, "{line}")?;
    }
    writeln!(out, "wrote {}", places.join(", "))
}
