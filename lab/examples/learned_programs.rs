//! Results of corrected programs that learn from logs of the parts that were cut:
//! `cargo run --release -p feedwright-lab --example learned_programs [OPTION...] [SEED [COUNT]]`.
//!
//! The machine that cuts is one of [`MACHINES`], with disturbance, noise and encoder steps. Its
//! geometry has no errors: all errors are those that encoders see. In the machine file, position
//! gain, speed-loop gain, inertia, friction, integral time and feedforward of each axis are up to
//! 20 % off, drawn by the seed. With `--unknown` the machine also has effects that its file does
//! not have: cogging, ripple and more friction at rest. With `--mistyped` one value of the file is
//! wrong, by a factor of two. `--without-logs` leaves the last two rows out, and `--exact` corrects
//! by files that count as exact. Each program is planned for `generic`.
//!
//! | Row | Program |
//! |---|---|
//! | right file | corrected by the values of the machine that cuts: the best case |
//! | no log | corrected by the machine file alone |
//! | one log | corrected by the file and the log of the original |
//! | two logs | by the file, the log of the original, and the log of `one log` |
//!
//! A log is a CSV file that is read as `correct --log` reads it. A program that `correct` does not
//! write is replaced by the one before. Ratios are those of `corrected_programs`: without the error
//! that no program can remove. The last columns compare one more cut with the prediction.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use feedwright::{
    CorrectJob, CorrectOutcome, ExportedCut, MeasuredLog, PredictedCut, TARGETS, deterministic,
};
use feedwright_control::Uncorrected;
use feedwright_gcode::canon::{Event, EventKind};
use feedwright_gcode::{Program, Reader, Settings};
use feedwright_ident::{Columns, Log};
use feedwright_plan::{Pieces, Step};
use feedwright_sim::{Axis, Machine, Measurement, Mechanism, Plant, Run, Squareness};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

/// Machines, in turn.
const MACHINES: [&str; 4] = ["tnv40", "stiff", "workshop", "heavy"];
/// Number of machines that are drawn, and the largest part by which a value is off.
const COUNT: usize = 16;
const OFF: f64 = 0.2;
/// Programs.
const PARTS: [&str; 4] = ["circle", "star", "eight", "square"];
/// Cuts of each program.
const CUTS: u64 = 8;

/// Rows of a log: command, and position by the encoders at the same time.
type Rows = Vec<[[f64; 3]; 2]>;

/// A machine that is logged.
struct Logged {
    plant: Plant<3>,
    seen_mm: [f64; 3],
    rows: Arc<Mutex<Rows>>,
}

impl Logged {
    fn log(&self, command_mm: [f64; 3]) {
        self.rows
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .push([command_mm, self.seen_mm]);
    }
}

impl Mechanism for Logged {
    fn step(&mut self, command_mm: [f64; 3]) -> Measurement<3> {
        self.log(command_mm);
        let measurement = self.plant.step(command_mm);
        self.seen_mm = measurement.measured_mm;
        measurement
    }

    fn skip(&mut self, periods: u64) {
        let last = self
            .rows
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .last()
            .copied();
        (0..periods).for_each(|_| self.log(last.unwrap_or_default()[0]));
        self.plant.skip(periods);
    }

    fn has_geometry(&self) -> bool {
        false
    }
}

/// The machine as a file has it, without geometry.
fn file(name: &str) -> Result<Machine, Box<dyn Error>> {
    let machine = Machine::load(name.as_ref())?;
    let axis = |axis: &Axis| Axis {
        scale_um_m: 0.0,
        pitch_error_um: 0.0,
        ..*axis
    };
    let axes = machine.axes.iter().map(axis).collect();
    Ok(Machine {
        axes,
        geometry: Squareness::default(),
        ..machine
    })
}

/// A machine that is not as its file.
fn drawn(file: &Machine, seed: u64) -> Machine {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut axis = |axis: &Axis| {
        let mut axis = *axis;
        let mut off = || random.random_range(1.0 - OFF..=1.0 + OFF);
        axis.kp_1_s *= off();
        axis.kv_nm_s_per_rad *= off();
        axis.inertia_kg_m2 *= off();
        axis.speed_integral_s *= off();
        axis.velocity_feedforward *= off();
        axis.acceleration_feedforward *= off();
        let friction = off();
        axis.coulomb_friction_nm *= friction;
        axis.viscous_friction_nm_s *= friction;
        axis.stribeck_nm *= friction;
        axis
    };
    Machine {
        axes: file.axes.iter().map(&mut axis).collect(),
        ..file.clone()
    }
}

/// A file with one wrong value in one axis: twice or half of it.
fn mistyped(file: &Machine, seed: u64) -> Machine {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut machine = file.clone();
    let axis = &mut machine.axes[random.random_range(0..2)];
    let factor = if random.random_bool(0.5) { 2.0 } else { 0.5 };
    let values = [
        &mut axis.kp_1_s,
        &mut axis.kv_nm_s_per_rad,
        &mut axis.inertia_kg_m2,
        &mut axis.coulomb_friction_nm,
        &mut axis.speed_integral_s,
        &mut axis.velocity_feedforward,
        &mut axis.acceleration_feedforward,
    ];
    let mut there: Vec<&mut f64> = values.into_iter().filter(|value| **value > 0.0).collect();
    let which = random.random_range(0..there.len());
    *there[which] *= factor;
    machine
}

/// A machine with what no machine file has.
fn with_unknown(machine: &Machine) -> Machine {
    let axis = |axis: &Axis| Axis {
        cogging_nm: 0.2 * axis.coulomb_friction_nm,
        cogging_per_rev: 6.0,
        ripple: 0.02,
        ripple_per_rev: 24.0,
        stribeck_nm: axis.stribeck_nm + 0.3 * axis.coulomb_friction_nm,
        stribeck_mm_s: 1.0,
        ..*axis
    };
    Machine {
        axes: machine.axes.iter().map(axis).collect(),
        ..machine.clone()
    }
}

/// Kind of difference between the machine and its file.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Off {
    File,
    Unknown,
    Mistyped,
}

fn steps(text: &str) -> Vec<Step> {
    let reader = Reader::from_text("part.ngc", text, Settings::default()).expect("a program");
    Pieces::new(reader.map_while(Result::ok))
        .map_while(Result::ok)
        .collect()
}

/// Rest before a cut, s, so that the disturbance has the phase of that number.
fn wait_s(machine: &Machine, number: u64) -> f64 {
    0.2 + number as f64 / CUTS as f64 / machine.axes[0].disturbance_hz.max(1.0)
}

/// The log of a cut, written and read again.
fn log(
    machine: &Machine,
    program: &[Step],
    number: u64,
    folder: &Path,
) -> Result<MeasuredLog, Box<dyn Error + Send + Sync>> {
    let machine = machine.with_noise_seed(7000 + number);
    let wait = Event {
        line: 0,
        kind: EventKind::Dwell {
            seconds: wait_s(&machine, number),
        },
    };
    let program: Vec<Step> = std::iter::once(Step::Event(wait))
        .chain(program.iter().cloned())
        .collect();
    let rows = Arc::new(Mutex::new(Vec::new()));
    let plant = |start_mm: [f64; 3], seed: u64| -> Box<dyn Mechanism> {
        Box::new(Logged {
            plant: Plant::with_seed(&machine, start_mm, seed),
            seen_mm: start_mm,
            rows: Arc::clone(&rows),
        })
    };
    let run = Run::on(&machine)
        .uncompensated()
        .stages(TARGETS[0].stages(&machine))
        .plant(&plant);
    run.cut_steps::<2>(&program, &mut Uncorrected, &mut [])?;
    let mut text = "t_s,x_cmd_mm,x_act_mm,y_cmd_mm,y_act_mm\n".to_owned();
    for (k, [command, seen]) in rows
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .iter()
        .enumerate()
    {
        let t_s = k as f64 * machine.period.servo_s;
        writeln!(
            text,
            "{t_s:.6},{:.6},{:.6},{:.6},{:.6}",
            command[0], seen[0], command[1], seen[1]
        )?;
    }
    let path = folder.join(format!("cut{number}.csv"));
    std::fs::write(&path, text)?;
    Ok(MeasuredLog {
        name: format!("cut{number}.csv"),
        log: Log::read(&path, &Columns::default())?,
    })
}

/// Errors of a program: mean RMS and largest, um; the part of them that no program removes; and the
/// time, s.
#[derive(Debug, Clone, Copy)]
struct Errors {
    rms_um: f64,
    max_um: f64,
    nobody_um: [f64; 2],
    time_s: f64,
    /// RMS of a cut of its own.
    next_um: f64,
}

fn errors(machine: &Machine, original: &[Step], program: &[Step]) -> Errors {
    let once = |machine: &Machine, number: u64| {
        let stages = TARGETS[0].stages(machine);
        let cut = ExportedCut {
            machine,
            error: None,
            stages,
            original,
            axes: 2,
            watch: &(),
        };
        cut.once(program, wait_s(machine, number), &mut [])
            .expect("a cut")
    };
    let noisy = |number: u64| once(&machine.with_noise_seed(100 + number), number);
    let (mut rms_um, mut max_um, mut time_s) = (0.0, 0.0, 0.0);
    for number in 0..CUTS {
        let now = noisy(number);
        rms_um += now.rms_um / CUTS as f64;
        max_um += now.max_um / CUTS as f64;
        time_s = now.time_s;
    }
    let quiet = once(&deterministic(machine), 0);
    let nobody_um = [
        (rms_um.powi(2) - quiet.rms_um.powi(2)).max(0.0).sqrt(),
        (max_um - quiet.max_um).max(0.0),
    ];
    Errors {
        rms_um,
        max_um,
        nobody_um,
        time_s,
        next_um: noisy(CUTS + 3).rms_um,
    }
}

/// Ratios of RMS and largest error, as in `corrected_programs`.
fn ratios(was: &Errors, is: &Errors) -> [f64; 2] {
    let [nobody_rms, nobody_max] = is.nobody_um;
    let rms = |rms_um: f64| (rms_um.powi(2) - nobody_rms.powi(2)).max(0.0).sqrt();
    let max = |max_um: f64| (max_um - nobody_max).max(0.0);
    [
        rms(is.rms_um) / rms(was.rms_um).max(1e-9),
        max(is.max_um) / max(was.max_um).max(1e-9),
    ]
}

/// A row of the table.
struct Case {
    name: String,
    was: Errors,
    /// Results with the right file, without a log, with one and with two, and the predictions.
    ways: Vec<(Errors, Option<PredictedCut>, Option<String>)>,
}

fn case(
    number: usize,
    part: &str,
    seed: u64,
    off: Off,
    [logs, exact]: [bool; 2],
) -> Result<Case, Box<dyn Error + Send + Sync>> {
    let name = MACHINES[number % MACHINES.len()];
    let built_in = file(name).map_err(|error| error.to_string())?;
    let seed = seed.wrapping_add(number as u64);
    let other = drawn(&built_in, seed);
    let (file, machine) = match off {
        Off::File => (other, built_in),
        Off::Mistyped => (mistyped(&built_in, seed), built_in),
        Off::Unknown => (other, with_unknown(&built_in)),
    };
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../parts"))
        .join(part)
        .with_extension("ngc");
    let original = steps(&std::fs::read_to_string(&path)?);
    let folder = tempfile::tempdir()?;
    let by = |file: &Machine, logs: Vec<MeasuredLog>| -> Result<CorrectOutcome, String> {
        let mut job = CorrectJob::new(Program::in_file(&path), file.clone(), &TARGETS[0]);
        job.logs = logs;
        if exact {
            job.file_error = 0.0;
        }
        job.run(&()).map_err(|error| error.to_string())
    };
    let mut program = original.clone();
    let was = errors(&machine, &original, &original);
    let corrected = |logs: Vec<MeasuredLog>| by(&file, logs);
    let way = |outcome: Result<CorrectOutcome, String>, program: &mut Vec<Step>| {
        let (predicted, refusal) = match outcome {
            Ok(outcome) => {
                if let Some(text) = outcome.program() {
                    *program = steps(text);
                }
                (
                    outcome.learned.and_then(|learned| learned.predicted),
                    outcome.refusal,
                )
            }
            Err(error) => (None, Some(error)),
        };
        (errors(&machine, &original, program), predicted, refusal)
    };
    let right = way(by(&machine, Vec::new()), &mut original.clone());
    let without = way(corrected(Vec::new()), &mut original.clone());
    if !logs {
        return Ok(Case {
            name: format!("{name}-{number} {part}"),
            was,
            ways: vec![right, without],
        });
    }
    let first = log(&machine, &original, 1, folder.path())?;
    let one = way(corrected(vec![first.clone()]), &mut program);
    let second = log(&machine, &program, 2, folder.path())?;
    let two = way(corrected(vec![first, second]), &mut program);
    Ok(Case {
        name: format!("{name}-{number} {part}"),
        was,
        ways: vec![right, without, one, two],
    })
}

const WAYS: [&str; 4] = ["right file", "no log", "one log", "two logs"];

fn print(case: &Case) {
    for (name, (is, predicted, refusal)) in WAYS.iter().zip(&case.ways) {
        let [rms, max] = ratios(&case.was, is);
        let band = predicted.map_or(String::new(), |predicted| {
            let [low, high] = predicted.band_um;
            format!(
                "{:>6.2} {:>6.2} ({low:.2} to {high:.2})",
                is.next_um, predicted.rms_um
            )
        });
        println!(
            "{:<20} {name:<10} {:>6.2} {:>6.2} {rms:>6.3}  {:>6.1} {:>6.1} {max:>6.3}  {:>6.3}  {band} {}",
            case.name,
            case.was.rms_um,
            is.rms_um,
            case.was.max_um,
            is.max_um,
            is.time_s / case.was.time_s,
            refusal.as_deref().unwrap_or_default()
        );
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 {
        values[middle]
    } else {
        0.5 * (values[middle - 1] + values[middle])
    }
}

fn summary(cases: &[&Case], name: &str) {
    if cases.is_empty() {
        return;
    }
    for (way, label) in WAYS.iter().enumerate().take(cases[0].ways.len()) {
        let all: Vec<[f64; 2]> = cases
            .iter()
            .map(|case| ratios(&case.was, &case.ways[way].0))
            .collect();
        let of = |which: usize| all.iter().map(|ratios| ratios[which]).collect::<Vec<_>>();
        let most = |values: Vec<f64>| values.into_iter().fold(0.0, f64::max);
        let times = cases
            .iter()
            .map(|case| case.ways[way].0.time_s / case.was.time_s)
            .collect::<Vec<_>>();
        let is_worse = |case: &&&Case| {
            let is = &case.ways[way].0;
            is.rms_um > case.was.rms_um + 0.05 || is.max_um > case.was.max_um + 1.0
        };
        let worse = cases.iter().filter(is_worse).count();
        let predicted = || {
            cases.iter().filter_map(|case| {
                let (is, predicted, refusal) = &case.ways[way];
                predicted
                    .filter(|_| refusal.is_none())
                    .map(|predicted| (is, predicted))
            })
        };
        let within = predicted()
            .filter(|(is, p)| (p.band_um[0]..=p.band_um[1]).contains(&is.next_um))
            .count();
        println!(
            "{name:<10} {label:<10} RMS {:.3} median, {:.3} most; largest {:.3} median, {:.3} most; time {:.3} most; {worse} worse; \
             {within} of {} predicted",
            median(of(0)),
            most(of(0)),
            median(of(1)),
            most(of(1)),
            most(times),
            predicted().count()
        );
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let (options, arguments): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|a| a.starts_with("--"));
    let given = |wanted: &str| options.iter().any(|option| option == wanted);
    let kinds = [("--unknown", Off::Unknown), ("--mistyped", Off::Mistyped)];
    let off = kinds
        .into_iter()
        .find(|(option, _)| given(option))
        .map_or(Off::File, |(_, off)| off);
    let logs = !given("--without-logs");
    let exact = given("--exact");
    let mut arguments = arguments.into_iter();
    let seed = arguments.next().map_or(Ok(1), |seed| seed.parse())?;
    let machines = arguments.next().map_or(Ok(COUNT), |count| count.parse())?;
    let work: Vec<(usize, &str)> = (0..machines)
        .flat_map(|number| PARTS.map(|part| (number, part)))
        .collect();
    println!(
        "RMS and largest error of original and program in um, ratios; ratio of time; RMS of one more cut, and its prediction"
    );
    let cases: Vec<Case> = work
        .par_iter()
        .filter_map(
            |&(number, part)| match case(number, part, seed, off, [logs, exact]) {
                Ok(case) => {
                    print(&case);
                    Some(case)
                }
                Err(error) => {
                    println!("{number} {part}: {error}");
                    None
                }
            },
        )
        .collect();
    for part in PARTS {
        summary(
            &cases
                .iter()
                .filter(|case| case.name.ends_with(part))
                .collect::<Vec<_>>(),
            part,
        );
    }
    for file in MACHINES {
        summary(
            &cases
                .iter()
                .filter(|case| case.name.starts_with(file))
                .collect::<Vec<_>>(),
            file,
        );
    }
    summary(&cases.iter().collect::<Vec<_>>(), "all");
    Ok(())
}
