//! Results of corrected programs that learn from logs of the parts that were cut:
//! `cargo run --release -p feedwright-lab --example corrected_programs -- --learned [OPTION...] [SEED [COUNT]]`.
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

use feedwright::{CorrectJob, CorrectOutcome, MeasuredLog, PredictedCut, TARGETS, deterministic};
use feedwright_control::Uncorrected;
use feedwright_gcode::Program;
use feedwright_gcode::canon::{Event, EventKind};
use feedwright_ident::{Columns, Log};
use feedwright_plan::Step;
use feedwright_sim::{Axis, Machine, Measurement, Mechanism, Plant, Run};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use rayon::prelude::*;

use crate::{CUTS, exported, seen_by_encoders, steps};

type Failure = Box<dyn Error + Send + Sync>;

/// Machines, in turn.
const MACHINES: [&str; 4] = ["tnv40", "stiff", "workshop", "heavy"];
/// Number of machines that are drawn, and the largest part by which a value is off.
const COUNT: usize = 16;
const OFF: f64 = 0.2;
/// Programs.
const PARTS: [&str; 4] = ["circle", "star", "eight", "square"];

/// Rows of a log: command, and position by the encoders at the same time.
type Rows = Arc<Mutex<Vec<[[f64; 3]; 2]>>>;

/// A machine that is logged.
struct Logged {
    plant: Plant<3>,
    last_mm: [[f64; 3]; 2],
    rows: Rows,
}

impl Logged {
    fn log(&mut self, command_mm: [f64; 3]) {
        self.last_mm[0] = command_mm;
        let mut rows = self.rows.lock().unwrap_or_else(PoisonError::into_inner);
        rows.push(self.last_mm);
    }
}

impl Mechanism for Logged {
    fn step(&mut self, command_mm: [f64; 3]) -> Measurement<3> {
        self.log(command_mm);
        let measurement = self.plant.step(command_mm);
        self.last_mm[1] = measurement.measured_mm;
        measurement
    }

    fn skip(&mut self, periods: u64) {
        (0..periods).for_each(|_| self.log(self.last_mm[0]));
        self.plant.skip(periods);
    }

    fn has_geometry(&self) -> bool {
        false
    }
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
) -> Result<MeasuredLog, Failure> {
    let machine = machine.with_noise_seed(7000 + number);
    let seconds = wait_s(&machine, number);
    let wait = Event {
        line: 0,
        kind: EventKind::Dwell { seconds },
    };
    let program = [&[Step::Event(wait)], program].concat();
    let rows = Rows::default();
    let plant = |start_mm: [f64; 3], seed: u64| -> Box<dyn Mechanism> {
        Box::new(Logged {
            plant: Plant::with_seed(&machine, start_mm, seed),
            last_mm: [[0.0; 3], start_mm],
            rows: Arc::clone(&rows),
        })
    };
    let stages = TARGETS[0].stages(&machine);
    let run = Run::on(&machine)
        .uncompensated()
        .stages(stages)
        .plant(&plant);
    run.cut_steps::<2>(&program, &mut Uncorrected, &mut [])?;
    let mut text = "t_s,x_cmd_mm,x_act_mm,y_cmd_mm,y_act_mm\n".to_owned();
    let rows = rows.lock().unwrap_or_else(PoisonError::into_inner);
    for (k, [[cx, cy, _], [x, y, _]]) in rows.iter().enumerate() {
        let t_s = k as f64 * machine.period.servo_s;
        writeln!(text, "{t_s:.6},{cx:.6},{x:.6},{cy:.6},{y:.6}")?;
    }
    let name = format!("cut{number}.csv");
    let path = folder.join(&name);
    std::fs::write(&path, text)?;
    let log = Log::read(&path, &Columns::default())?;
    Ok(MeasuredLog { name, log })
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
        let cut = exported(machine, original, 2);
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
        without(rms_um, quiet.rms_um),
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

/// The rest of an RMS where a part of it is taken out.
fn without(rms_um: f64, part_um: f64) -> f64 {
    (rms_um.powi(2) - part_um.powi(2)).max(0.0).sqrt()
}

/// Ratios of RMS and largest error, as in `corrected_programs`.
fn ratios(was: &Errors, is: &Errors) -> [f64; 2] {
    let [nobody_rms, nobody_max] = is.nobody_um;
    let max = |max_um: f64| (max_um - nobody_max).max(0.0);
    [
        without(is.rms_um, nobody_rms) / without(was.rms_um, nobody_rms).max(1e-9),
        max(is.max_um) / max(was.max_um).max(1e-9),
    ]
}

/// Errors of a corrected program, the prediction, and why it was not written.
type Way = (Errors, Option<PredictedCut>, Option<String>);

/// A row of the table.
struct Case {
    name: String,
    was: Errors,
    /// Results with the right file, without a log, with one and with two.
    ways: Vec<Way>,
}

fn case(
    number: usize,
    part: &str,
    seed: u64,
    off: Off,
    [logs, exact]: [bool; 2],
) -> Result<Case, Failure> {
    let name = MACHINES[number % MACHINES.len()];
    let built_in = seen_by_encoders(&Machine::load(name.as_ref())?);
    let seed = seed.wrapping_add(number as u64);
    let other = drawn(&built_in, seed);
    let (file, machine) = match off {
        Off::File => (other, built_in),
        Off::Mistyped => (mistyped(&built_in, seed), built_in),
        Off::Unknown => (other, with_unknown(&built_in)),
    };
    let parts = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../parts"));
    let path = parts.join(part).with_extension("ngc");
    let read = |text: &str| steps(text, None);
    let original = read(&std::fs::read_to_string(&path)?);
    let folder = tempfile::tempdir()?;
    // Replaces the program where another one is written.
    let way = |file: &Machine, logs: Vec<MeasuredLog>, program: &mut Vec<Step>| -> Way {
        let mut job = CorrectJob::new(Program::in_file(&path), file.clone(), &TARGETS[0]);
        job.logs = logs;
        if exact {
            job.file_error = 0.0;
        }
        let (predicted, refusal) = match job.run(&()) {
            Ok(outcome) => {
                if let Some(text) = outcome.program() {
                    *program = read(text);
                }
                let CorrectOutcome {
                    learned, refusal, ..
                } = outcome;
                (learned.and_then(|learned| learned.predicted), refusal)
            }
            Err(error) => (None, Some(error.to_string())),
        };
        (errors(&machine, &original, program), predicted, refusal)
    };
    let mut program = original.clone();
    let was = errors(&machine, &original, &original);
    let right = way(&machine, Vec::new(), &mut original.clone());
    let mut ways = vec![right, way(&file, Vec::new(), &mut original.clone())];
    if logs {
        let first = log(&machine, &original, 1, folder.path())?;
        ways.push(way(&file, vec![first.clone()], &mut program));
        let second = log(&machine, &program, 2, folder.path())?;
        ways.push(way(&file, vec![first, second], &mut program));
    }
    Ok(Case {
        name: format!("{name}-{number} {part}"),
        was,
        ways,
    })
}

const WAYS: [&str; 4] = ["right file", "no log", "one log", "two logs"];

fn print(case: &Case) {
    let was = &case.was;
    for (name, (is, predicted, refusal)) in WAYS.iter().zip(&case.ways) {
        let [rms, max] = ratios(was, is);
        let band = predicted.map_or(String::new(), |it| {
            let [low, high] = it.band_um;
            format!(
                "{:>6.2} {:>6.2} ({low:.2} to {high:.2})",
                is.next_um, it.rms_um
            )
        });
        println!(
            "{:<20} {name:<10} {:>6.2} {:>6.2} {rms:>6.3}  {:>6.1} {:>6.1} {max:>6.3}  {:>6.3}  {band} {}",
            case.name,
            was.rms_um,
            is.rms_um,
            was.max_um,
            is.max_um,
            is.time_s / was.time_s,
            refusal.as_deref().unwrap_or_default()
        );
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() % 2 {
        1 => values[middle],
        _ => 0.5 * (values[middle - 1] + values[middle]),
    }
}

fn summary(cases: &[Case], name: &str, is_of: impl Fn(&str) -> bool) {
    let cases: Vec<&Case> = cases.iter().filter(|case| is_of(&case.name)).collect();
    let Some(first) = cases.first() else { return };
    for (way, label) in WAYS.iter().enumerate().take(first.ways.len()) {
        let of = |number: &dyn Fn(&Errors, &Errors) -> f64| -> Vec<f64> {
            cases
                .iter()
                .map(|case| number(&case.was, &case.ways[way].0))
                .collect()
        };
        let [rms, max] = [0, 1].map(|which| of(&|was, is| ratios(was, is)[which]));
        let times = of(&|was, is| is.time_s / was.time_s);
        let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        let (mut worse, mut within, mut predicted) = (0, 0, 0);
        for (was, (is, prediction, refusal)) in cases.iter().map(|it| (&it.was, &it.ways[way])) {
            let is_worse = is.rms_um > was.rms_um + 0.05 || is.max_um > was.max_um + 1.0;
            worse += usize::from(is_worse);
            if let (Some(it), None) = (prediction, refusal) {
                predicted += 1;
                within += usize::from((it.band_um[0]..=it.band_um[1]).contains(&is.next_um));
            }
        }
        println!(
            "{name:<10} {label:<10} RMS {:.3} median, {:.3} most; largest {:.3} median, {:.3} most; time {:.3} most; {worse} worse; \
             {within} of {predicted} predicted",
            median(rms.clone()),
            most(&rms),
            median(max.clone()),
            most(&max),
            most(&times)
        );
    }
}

/// Corrects and cuts what the arguments ask for.
pub(crate) fn learned(arguments: Vec<String>) -> Result<(), Box<dyn Error>> {
    let (options, numbers): (Vec<String>, Vec<String>) = arguments
        .into_iter()
        .partition(|argument| argument.starts_with("--"));
    let given = |wanted: &str| options.iter().any(|option| option == wanted);
    let off = match (given("--unknown"), given("--mistyped")) {
        (true, _) => Off::Unknown,
        (_, true) => Off::Mistyped,
        _ => Off::File,
    };
    let with = [!given("--without-logs"), given("--exact")];
    let seed = numbers.first().map_or(Ok(1), |seed| seed.parse())?;
    let machines = numbers.get(1).map_or(Ok(COUNT), |count| count.parse())?;
    let of_machine = |number: usize| PARTS.map(|part| (number, part));
    let work: Vec<(usize, &str)> = (0..machines).flat_map(of_machine).collect();
    println!(
        "RMS and largest error of original and program in um, ratios; ratio of time; RMS of one more cut, and its prediction"
    );
    let one = |&(number, part): &(usize, &str)| {
        let case = case(number, part, seed, off, with);
        match &case {
            Ok(case) => print(case),
            Err(error) => println!("{number} {part}: {error}"),
        }
        case.ok()
    };
    let cases: Vec<Case> = work.par_iter().filter_map(one).collect();
    for part in PARTS {
        summary(&cases, part, |name| name.ends_with(part));
    }
    for file in MACHINES {
        summary(&cases, file, |name| name.starts_with(file));
    }
    summary(&cases, "all", |_| true);
    Ok(())
}
