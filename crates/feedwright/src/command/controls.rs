//! Shared helpers of several commands: read the control, the machine's error and the model from the
//! arguments, and print what is known of a corrected program.

use std::ffi::OsStr;
use std::io::{self, Write};

use feedwright_gcode::input;
use feedwright_gcode::suggestion::nearest;
use feedwright_sim::{GeometryFile, Machine, is_machine_path};
use miette::{Result, miette};

use crate::command::args::geometry::GeometryArgs;
use crate::command::date::today;
use crate::command::progress::Bar;
use crate::command::terminal::wrapped;
use crate::compensation::{GeometryChoice, NamedGeometry};
use crate::correct::feed_overrides::override_sentence;
use crate::correct::{
    CorrectJob, CorrectOutcome, FileAssumption, TARGETS, TargetControl, UnchangedStretch,
};
use crate::job::Job;
use crate::recorded_model::{fitting_machines, take_recorded_model};

/// Largest tolerance that is no slip of the unit, um.
const MAX_TOLERANCE_UM: f64 = 1e6;

/// Largest error of a machine file that `--file-error` takes, %: beyond it, a file says too little
/// of a machine.
const MAX_FILE_ERROR: f64 = 50.0;

/// Unchanged stretches that are listed for each reason.
const LISTED: usize = 6;

/// The control of that name.
pub(crate) fn control(name: &str) -> Result<&'static TargetControl> {
    TargetControl::find(name).ok_or_else(|| {
        let names: Vec<&str> = TARGETS.iter().map(|target| target.name).collect();
        let near = nearest(name, &names)
            .map_or_else(String::new, |near| format!("did you mean '{near}'? "));
        miette!(
            help = format!("{near}'{}' suits a control that is not listed", names[0]),
            "--for: no control is called '{name}'; there are {}",
            names.join(", ")
        )
    })
}

/// Returns the geometry that `--geometry` and `--no-geometry` select for compensation.
pub(crate) fn compensation(args: &GeometryArgs) -> Result<GeometryChoice> {
    Ok(match &args.geometry {
        _ if args.no_geometry => GeometryChoice::Off,
        None => GeometryChoice::Machine,
        Some(path) => {
            let geometry = GeometryFile::read(path)?;
            GeometryChoice::File(Box::new(NamedGeometry {
                name: input::name(path),
                geometry,
            }))
        }
    })
}

/// Fails if a tolerance is not above 0 or exceeds [`MAX_TOLERANCE_UM`].
pub(crate) fn check_tolerance(tolerance_um: Option<f64>) -> Result<()> {
    match tolerance_um {
        Some(value) if !(value > 0.0 && value <= MAX_TOLERANCE_UM) => Err(miette!(
            help = "the unit is um: 0.01 mm is --tolerance 10",
            "--tolerance is {value} um; it must lie above 0 and up to {MAX_TOLERANCE_UM} um"
        )),
        _ => Ok(()),
    }
}

/// The error of a machine by `--file-error`, as a fraction.
///
/// # Errors
/// A percentage below 0 or above [`MAX_FILE_ERROR`].
pub(crate) fn file_error(percent: Option<f64>, machine: &OsStr) -> Result<f64> {
    let percent = percent
        .unwrap_or_else(|| 100.0 * CorrectJob::usual_file_error(is_machine_path(machine.as_ref())));
    if (0.0..=MAX_FILE_ERROR).contains(&percent) {
        return Ok(percent / 100.0);
    }
    Err(miette!(
        help = "the unit is percent: 0 if the values are exact, 10 if they are typed by hand",
        "--file-error is {percent} %; it must lie between 0 and {MAX_FILE_ERROR} %"
    ))
}

/// Prints what was changed, and the reason if no program is written.
pub(crate) fn print_correction(out: &mut dyn Write, outcome: &CorrectOutcome) -> io::Result<()> {
    let CorrectOutcome {
        stretches,
        stretches_changed,
        rounds,
        ..
    } = outcome;
    let changed = format!(
        "{stretches_changed} of {stretches} stretches between corners were changed, found in {rounds} simulated cuts"
    );
    writeln!(out, "{}", wrapped(&changed, 2))?;
    if let Some(assumed) = outcome.assumed.as_ref().map(FileAssumption::sentence) {
        writeln!(out, "{}", wrapped(&assumed, 2))?;
    }
    for sentence in UnchangedStretch::sentences(&outcome.unchanged, LISTED) {
        writeln!(out, "{}", wrapped(&sentence, 2))?;
    }
    if let Some(sentence) = override_sentence(&outcome.feed_overrides) {
        writeln!(out, "{}", wrapped(&sentence, 2))?;
    }
    if outcome.expanded {
        writeln!(out, "loops and subroutines are written out")?;
    }
    match &outcome.refusal {
        Some(refusal) => writeln!(
            out,
            "{}",
            wrapped(&format!("no corrected program: {refusal}"), 2)
        )?,
        None => return Ok(()),
    }
    match &outcome.hint {
        Some(hint) => writeln!(out, "{}", wrapped(&format!("  hint: {hint}"), 8)),
        None => Ok(()),
    }
}

/// Gives the controller of a job its [recorded model](crate::take_recorded_model), and the job
/// `band` machines that fit the log as well; returns what is to be said of the model. The machine
/// is as its file has it, whatever limits the job plans with.
pub(crate) fn take_model(
    job: &mut Job,
    machine: &Machine,
    axes: usize,
    band: usize,
    bar: &Bar,
) -> Result<Vec<String>> {
    let Some(doubts) = take_recorded_model(job, machine, axes, today()?, bar)? else {
        return Ok(vec![]);
    };
    if band > 0 {
        job.fitting = fitting_machines(machine, axes, job.choices.seed, band, bar)?;
    }
    Ok(doubts)
}
