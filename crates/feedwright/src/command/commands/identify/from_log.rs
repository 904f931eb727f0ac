//! `feedwright identify LOG`: the machine file of a real machine.
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use feedwright_gcode::input;
use feedwright_ident::{AxisExcitation, AxisFacts, KnownValue, Log, LogError, next_excitation};
use feedwright_sim::{AXIS_NAMES, Machine, Watch};
use miette::{IntoDiagnostic, Result};

use crate::command::args::identify::{IdentifyArgs, LogArgs};
use crate::command::console::Console;
use crate::command::message::{printed, remark};
use crate::command::streams::{check_inputs, report_written, tables};
use crate::command::terminal::wrapped;
use crate::log_job::{LogIdentified, LogJob, machine_text, updated_text, write_json, write_page};
use crate::output::{OutputError, OutputFile, OutputFiles};

pub(super) fn run(paths: &[PathBuf], args: &IdentifyArgs, console: &Console) -> Result<ExitCode> {
    let of_log = &args.of_log;
    let logs = paths.iter().map(|path| ("the log", Some(path.as_path())));
    check_inputs(
        console,
        logs.chain([("--update", of_log.update.as_deref())]),
    )?;
    let before = of_log.update.as_deref().map(before).transpose()?;
    // Clap asks for one of both.
    let out = args
        .out
        .as_deref()
        .or(of_log.update.as_deref())
        .unwrap_or(Path::new("mine.toml"));
    let mut files = OutputFiles::new(paths.iter().map(PathBuf::as_path));
    let machine = files.start(out)?;
    let json = files.start_wanted(of_log.json.as_deref())?;
    let next = files.start_wanted(of_log.excite_next.as_deref())?;
    let page = files.start_wanted(of_log.report.as_deref())?;
    let bar = console.bar(0);
    let log = read(paths, of_log, &bar)?;
    if !console.is_quiet() {
        bar.aside(|| {
            log.findings
                .iter()
                .for_each(|finding| remark(&finding.to_string()));
        });
    }
    let name = paths
        .iter()
        .map(|path| file_name(path))
        .collect::<Vec<_>>()
        .join(", ");
    let (text_before, machine_before) = before.unzip();
    let identified = LogJob {
        before: machine_before,
        ..job(name, of_log)
    }
    .run(log, &bar)?;
    let text = match &text_before {
        Some(before) => updated_text(&identified, before)?,
        None => machine_text(&identified, &stem(out)),
    };
    // Whatever was found, the file is one that reads back.
    Machine::parse(&out.display().to_string(), &text)?;
    let machine = OutputFile::filled(Some(machine), |file| file.write_all(text.as_bytes()))?;
    let json = OutputFile::filled(json, |file| write_json(file, &identified))?;
    let page = OutputFile::filled(page, |file| write_page(file, &identified))?;
    let motions = identified.next_motion();
    let next = next.map(|file| Next::write(file, &motions)).transpose()?;
    let (next, said) = next.map_or((None, None), |next| (next.file, Some(next.said)));
    let all: Vec<OutputFile> = [machine, json, page, next].into_iter().flatten().collect();
    let places: Vec<PathBuf> = all.iter().map(|file| file.path().to_owned()).collect();
    bar.clear();
    OutputFile::commit_all(all, &bar)?;
    printed(print(&identified, said, &places), ExitCode::SUCCESS)
}

/// The program of the motion that is missing, and what to say of it. Without a program, its file is
/// not written.
struct Next {
    file: Option<OutputFile>,
    said: String,
}

impl Next {
    fn write(mut file: OutputFile, motions: &[AxisExcitation]) -> Result<Self, OutputError> {
        let Some(program) = next_excitation(motions) else {
            let said = format!(
                "nothing is open that other motion would settle: {} is not written",
                file.path().display()
            );
            return Ok(Self { file: None, said });
        };
        file.write_all(program.text.as_bytes())
            .map_err(|error| OutputError::from_io(error, file.path()))?;
        let words = |motion: &AxisExcitation| {
            let parts: Vec<&str> = motion.parts.iter().map(|part| part.word()).collect();
            format!("{} of {}", parts.join(", "), AXIS_NAMES[motion.axis])
        };
        let needed: Vec<String> = motions
            .iter()
            .filter(|motion| !motion.parts.is_empty())
            .map(words)
            .collect();
        let said = format!(
            "what is open would be settled by {}: about {:.0} s, at most {:.1} mm/s; {} has it",
            needed.join("; "),
            program.takes_s,
            program.max_feed_mm_s,
            file.path().display()
        );
        Ok(Self {
            file: Some(file),
            said,
        })
    }
}

/// The logs, one behind the other.
fn read(paths: &[PathBuf], of_log: &LogArgs, watch: &dyn Watch) -> Result<Log, LogError> {
    let columns = of_log.columns.clone().unwrap_or_default();
    let read = |path: &PathBuf| Ok((path.clone(), Log::read_watched(path, &columns, watch)?));
    Log::joined(paths.iter().map(read).collect::<Result<_, LogError>>()?)
}

/// A machine file that is updated.
fn before(path: &Path) -> Result<(String, Machine)> {
    let machine = Machine::load(path.as_os_str())?;
    let text = String::from_utf8_lossy(&input::read(path).into_diagnostic()?).into_owned();
    Ok((text, machine))
}

fn file_name(path: &Path) -> String {
    path.file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned()
}

fn job(name: String, args: &LogArgs) -> LogJob {
    let times_s = args
        .fit
        .clone()
        .zip(args.score.clone())
        .map(|(fit, score)| [fit.0, score.0]);
    let LogArgs {
        inertia,
        viscous,
        lead,
        torque_gain,
        speed_window,
        record_delay,
        command_delay,
        ..
    } = *args;
    let facts = AxisFacts {
        inertia,
        viscous,
        lead_mm_per_rev: lead,
        torque_gain,
        speed_window_s: speed_window,
        record_delay_s: record_delay.filter(|late_s| late_s.is_finite()),
        command_delay_s: command_delay,
        kp_1_s: args.kp,
        inverse_integral_1_s: args.integral_time.map(KnownValue::inverse),
        velocity_feedforward: args.velocity_feedforward,
        acceleration_feedforward: args.acceleration_feedforward,
        drive_delay_s: args.drive_delay,
        ..AxisFacts::default()
    };
    LogJob {
        name,
        times_s,
        facts,
        before: None,
    }
}

/// Returns the name of the machine: the name of its file.
fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(
        || "mine".to_owned(),
        |stem| stem.to_string_lossy().into_owned(),
    )
}

fn print(
    identified: &LogIdentified,
    next: Option<String>,
    places: &[PathBuf],
) -> std::io::Result<()> {
    let places = || places.iter().map(|path| Some(path.as_path()));
    let mut out = tables(places());
    write!(out, "{}", identified.table())?;
    for line in identified
        .improvements()
        .into_iter()
        .chain(identified.advice())
        .chain(next)
    {
        writeln!(out, "{}", wrapped(&line, 2))?;
    }
    report_written(&mut *out, places())
}
