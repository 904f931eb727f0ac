//! Results of corrected programs on a control without a correction of its own:
//! `cargo run --release -p feedwright-lab --example corrected_programs [MACHINE,...] [PROGRAM...]`.
//!
//! Each program is corrected for `generic` on each machine. The machine then cuts the uncorrected
//! and the corrected program without feedback, over [`CUTS`] phases of its disturbance and seeds of
//! its noise. Errors are those by encoders, to the original path: scale, pitch and squareness,
//! which no encoder sees, are zero.
//!
//! The repeating error is the mean of the error vectors of all cuts in a servo period. Its square
//! is reduced by a [`CUTS`]-th of the variance over the cuts, which is the part of the other errors
//! that remains in the mean. Ratios compare repeating errors. The rest is the standard deviation
//! over the cuts of the corrected program: no program can remove it. Some effects repeat, but no
//! model knows their phase: cogging, ripple and errors within a period of the encoder. The ratios
//! in brackets leave them out: they compare one cut of each program by the machine without these
//! effects.
//!
//! With `--drawn SEED` the programs are drawn from that seed (`kinds.rs`), `--count N` of each kind
//! that there is. With `--corpus FOLDER` N programs are drawn from the files of that folder, among
//! those that cut in X, Y or Z alone and cut for no more than [`LONGEST_S`] at their feedrates.
//! With `--wrong` the correction uses a model whose inertia, friction and speed-loop gain are 20 %
//! off, each up or down. With `--one-wrong` only one of them is off. With `--learned` the correction
//! learns from logs (`learned.rs`).

mod kinds;
mod learned;

use std::path::Path;

use feedwright::command::FilesToCheck;
use feedwright::{CorrectJob, ExportedCut, TARGETS, deterministic};
use feedwright_gcode::{Dialect, Program, Reader, Settings};
use feedwright_plan::vector::{Vector, norm, sub};
use feedwright_plan::{Pieces, Step};
use feedwright_sim::{Machine, Row, Sink, Squareness};

use kinds::{KINDS, drawn};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_xoshiro::Xoshiro256PlusPlus;

/// Cuts of each program.
const CUTS: u64 = 8;
/// Seed of the noise of the first cut.
const FIRST_SEED: u64 = 100;
/// Longest time that a program of a corpus cuts at its feedrates, s.
const LONGEST_S: f64 = 120.0;

/// Programs of the table that are no files: name, text, and true corners.
const LETTERS: &str = "G21 G90 G64 F3000\nG0 X0 Y0\nG1 X4 Y14\nX8 Y0\nX6.5 Y5\nX1.5\nG0 X12 Y0\nG1 Y14\nX16\nG2 X16 Y7 J-3.5\nG1 X12\nX16.5\n\
                       G2 X16.5 Y0 J-3.5\nG1 X12\nG0 X32 Y11\nG3 X22 Y11 R5\nG1 Y3\nG3 X32 Y3 R5\nM2\n";
const RHOMBUS: &str = "G21 G90 G64 F3000\nG0 X0 Y0\nG1 X10 Y6\nX20 Y0\nX10 Y-6\nX0 Y0\nM2\n";
const OWN: [(&str, &str); 2] = [("letters", LETTERS), ("rhombus", RHOMBUS)];

/// Error vectors of the servo periods that cut; none in the others.
#[derive(Default)]
struct Errors {
    skipped: usize,
    rows: Vec<Option<Vector>>,
}

impl Sink for Errors {
    fn row(&mut self, row: &Row) -> std::io::Result<()> {
        if self.skipped > 0 {
            self.skipped -= 1;
        } else {
            self.rows
                .push(row.cutting.then(|| sub(row.foot_mm, row.act_mm)));
        }
        Ok(())
    }
}

/// Errors of a program over all cuts.
#[derive(Clone, Copy, Default)]
struct Measured {
    /// RMS and largest repeating error, um.
    rms_um: f64,
    max_um: f64,
    /// RMS of the rest, um.
    rest_um: f64,
    time_s: f64,
    uncut_um: f64,
    blocks: u64,
}

/// The path of a program.
fn steps(text: &str, dialect: Option<Dialect>) -> Vec<Step> {
    let settings = Settings {
        dialect,
        ..Settings::default()
    };
    let reader = Reader::from_text("part.ngc", text, settings).expect("a program");
    let pieces = Pieces::new(reader.map_while(Result::ok));
    pieces.map_while(Result::ok).collect()
}

/// Cuts of programs without feedback, whose errors are those to the original path.
fn exported<'a>(machine: &'a Machine, original: &'a [Step], axes: usize) -> ExportedCut<'a> {
    ExportedCut {
        machine,
        error: None,
        stages: TARGETS[0].stages(machine),
        original,
        axes,
        watch: &(),
    }
}

/// Cuts a program over phases of the disturbance and seeds of the noise.
fn measured(machine: &Machine, original: &[Step], program: &[Step], axes: usize) -> Measured {
    let mut cuts = Vec::new();
    let mut measured = Measured::default();
    for cut in 0..CUTS {
        let machine = machine.with_noise_seed(FIRST_SEED + cut);
        let servo_s = machine.period.servo_s;
        let phase_s = cut as f64 / CUTS as f64 / machine.axes[0].disturbance_hz.max(1.0);
        let periods = (phase_s / servo_s).round();
        let mut errors = Errors {
            skipped: periods as usize,
            rows: Vec::new(),
        };
        let exported = exported(&machine, original, axes);
        let now = exported
            .once(program, periods * servo_s, &mut [&mut errors])
            .expect("a cut");
        (measured.time_s, measured.blocks) = (now.time_s, now.blocks);
        measured.uncut_um = now.uncut_um.max(measured.uncut_um);
        cuts.push(errors.rows);
    }
    let periods = cuts.iter().map(Vec::len).min().unwrap_or(0);
    let (mut squares, mut variances, mut count) = (0.0, 0.0, 0.0);
    for n in 0..periods {
        let errors: Vec<Vector> = cuts.iter().filter_map(|rows| rows[n]).collect();
        if errors.len() < cuts.len() {
            continue;
        }
        let sum = |i: usize| errors.iter().map(|error| error[i]).sum::<f64>();
        let mean: Vector = std::array::from_fn(|i| sum(i) / CUTS as f64);
        let off = errors.iter().map(|error| norm(sub(*error, mean)).powi(2));
        variances += off.sum::<f64>() / (CUTS - 1) as f64;
        measured.max_um = measured.max_um.max(1e3 * norm(mean));
        squares += norm(mean).powi(2);
        count += 1.0;
    }
    measured.rest_um = 1e3 * (variances / count).sqrt();
    measured.rms_um = 1e3 * ((squares - variances / CUTS as f64).max(0.0) / count).sqrt();
    measured
}

/// A machine whose encoders see all of it.
fn seen_by_encoders(machine: &Machine) -> Machine {
    let mut machine = machine.clone();
    for axis in &mut machine.axes {
        (axis.scale_um_m, axis.pitch_error_um) = (0.0, 0.0);
    }
    machine.geometry = Squareness::default();
    machine
}

/// The machine with inertia, friction and gain of the speed loop times these factors; gains of the
/// position loop, feedforward and delays stay.
fn wrong(machine: &Machine, [inertia, friction, gain]: [f64; 3]) -> Machine {
    let mut machine = machine.clone();
    for axis in &mut machine.axes {
        axis.inertia_kg_m2 *= inertia;
        axis.coulomb_friction_nm *= friction;
        axis.viscous_friction_nm_s *= friction;
        axis.stribeck_nm *= friction;
        axis.kv_nm_s_per_rad *= gain;
    }
    machine
}

/// Every one of the three 20 % off, up or down.
fn all_wrong() -> Vec<[f64; 3]> {
    let factor = |way: usize, bit: usize| if way >> bit & 1 == 1 { 1.2 } else { 0.8 };
    (0..8)
        .map(|way| [0, 1, 2].map(|bit| factor(way, bit)))
        .collect()
}

/// One of the three 20 % off, up or down.
fn one_wrong() -> Vec<[f64; 3]> {
    let one = |which: usize, by: f64| [0, 1, 2].map(|k| if k == which { by } else { 1.0 });
    (0..3)
        .flat_map(|which| [one(which, 0.8), one(which, 1.2)])
        .collect()
}

/// Ratios of corrected to original: RMS, largest error, time, and the first two of what a model
/// knows.
type Ratios = [f64; 5];

/// Corrects a program, cuts both and prints a line. None where no program was written.
fn line(name: &str, machine: &Machine, text: &str, assumed: Option<Machine>) -> Option<Ratios> {
    let program = Program::from_text("part.ngc", text);
    let refused = |why: &str| {
        println!("{:<9} {name:<32} {why}", machine.name);
        None
    };
    let Ok(summary) = program.check(Settings::default()) else {
        return refused("is refused");
    };
    let axes = if summary.moves[2] { 3 } else { 2 };
    let mut job = CorrectJob::new(program, machine.clone(), &TARGETS[0]);
    job.assumed = assumed;
    let outcome = match job.run(&()) {
        Ok(outcome) => outcome,
        Err(error) => return refused(&error.to_string()),
    };
    let Some(corrected) = outcome.program() else {
        let why = outcome.refusal.clone().unwrap_or_default();
        return refused(&format!("not written: {why}"));
    };
    // What is written out of a Fanuc program need not look like one.
    let [original, corrected] = [text, corrected].map(|text| steps(text, Some(summary.dialect.0)));
    let was = measured(machine, &original, &original, axes);
    let is = measured(machine, &original, &corrected, axes);
    let quiet = deterministic(machine);
    let known = |program: &[Step]| {
        let cut = exported(&quiet, &original, axes);
        cut.once(program, 0.0, &mut []).expect("a cut")
    };
    let (known_was, known_is) = (known(&original), known(&corrected));
    let ratios = [
        is.rms_um / was.rms_um,
        is.max_um / was.max_um,
        is.time_s / was.time_s,
        known_is.rms_um / known_was.rms_um,
        known_is.max_um / known_was.max_um,
    ];
    let [rms, max, time, known_rms, known_max] = ratios;
    println!(
        "{:<9} {name:<32} {:>6.2} {:>6.2} {rms:>6.3} ({known_rms:.3})  {:>6.1} {:>6.1} {max:>6.3} ({known_max:.3})  {:>5.2} {:>5.1}  {:>8.2} \
         {time:>6.3} {:>6} {:>6}  {:>3}/{}",
        machine.name,
        was.rms_um,
        is.rms_um,
        was.max_um,
        is.max_um,
        is.rest_um,
        is.uncut_um,
        was.time_s,
        was.blocks,
        is.blocks,
        outcome.stretches_changed,
        outcome.stretches,
    );
    for stretch in &outcome.unchanged {
        let [from, to] = stretch.lines;
        println!("          lines {from} to {to}: {}", stretch.reason);
    }
    Some(ratios)
}

/// Prints the median, the 90 % and the largest of ratios; programs that were not written count
/// as 1.
fn print_spread(name: &str, ratios: &[Option<Ratios>]) {
    print!("{name:<42}");
    for (which, what) in (0..).zip(["RMS", "largest", "time", "(RMS)", "(largest)"]) {
        let ratio = |ratios: &Option<Ratios>| ratios.map_or(1.0, |ratios: Ratios| ratios[which]);
        let mut of: Vec<f64> = ratios.iter().map(ratio).collect();
        of.sort_by(f64::total_cmp);
        let at = |part: f64| of[((of.len() - 1) as f64 * part).round() as usize];
        print!("  {what} {:.3} {:.3} {:.3}", at(0.5), at(0.9), at(1.0));
    }
    println!(
        "  ({} of {} written)",
        ratios.iter().flatten().count(),
        ratios.len()
    );
}

/// The value behind an option of the command line.
fn value<'a>(arguments: &'a [String], option: &str) -> Option<&'a str> {
    let at = arguments.iter().position(|argument| argument == option)?;
    arguments.get(at + 1).map(String::as_str)
}

/// Returns true if a program can be cut: X, Y or Z alone, in a time that is not too long.
fn is_cut(text: &str) -> bool {
    let Ok(summary) = Program::from_text("part.ngc", text).check(Settings::default()) else {
        return false;
    };
    let time_s = |step: &Step| match step {
        Step::Piece(piece) if piece.cutting => piece.length_mm / piece.feed_mm_s,
        _ => 0.0,
    };
    let steps = || steps(text, Some(summary.dialect.0));
    summary.feed_mm > 0.0
        && !summary.moves_others
        && steps().iter().map(time_s).sum::<f64>() <= LONGEST_S
}

/// Group, name and text of a program.
type Named = (String, String, String);

/// A file as a program.
fn program_of(path: &Path) -> Named {
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let text = std::fs::read(path).expect("a file");
    let text = String::from_utf8_lossy(&text).into_owned();
    ("files".to_owned(), name.into_owned(), text)
}

/// Returns `count` programs drawn from the files of a folder.
fn drawn_files(folder: &Path, seed: u64, count: usize) -> Vec<Named> {
    let found = FilesToCheck::find(&[folder.to_owned()]);
    let programs = found.files.iter().map(|path| program_of(path));
    let mut fitting: Vec<_> = programs.filter(|(_, _, text)| is_cut(text)).collect();
    println!(
        "{} programs that can be cut are in {}",
        fitting.len(),
        folder.display()
    );
    fitting.shuffle(&mut Xoshiro256PlusPlus::seed_from_u64(seed));
    fitting.truncate(count);
    fitting
}

/// The programs that are asked for.
fn programs(arguments: &[String], files: &[String]) -> Vec<Named> {
    if let Some(seed) = value(arguments, "--drawn") {
        let seed: u64 = seed.parse().expect("a seed");
        let count = value(arguments, "--count").map_or(3, |count| count.parse().expect("a count"));
        if let Some(folder) = value(arguments, "--corpus") {
            return drawn_files(folder.as_ref(), seed, count as usize);
        }
        let one = |kind: &'static str, number: u64| {
            let (text, what) = drawn(kind, 100 * seed + number);
            (kind.to_owned(), what, text)
        };
        let of_kind = |kind| (0..count).map(move |number| one(kind, number));
        return KINDS.into_iter().flat_map(of_kind).collect();
    }
    if !files.is_empty() {
        return files.iter().map(|path| program_of(path.as_ref())).collect();
    }
    let parts = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../parts"));
    let part = |name: &str| program_of(&parts.join(name).with_extension("ngc"));
    let mut all = ["circle", "ellipse", "eight", "star", "square"]
        .map(part)
        .to_vec();
    all.extend(OWN.map(|(name, text)| ("files".to_owned(), name.to_owned(), text.to_owned())));
    all
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments: Vec<String> = std::env::args().skip(1).collect();
    if let Some(at) = arguments
        .iter()
        .position(|argument| argument == "--learned")
    {
        arguments.remove(at);
        return learned::learned(arguments);
    }
    let is_value =
        |k: usize| k > 0 && ["--drawn", "--count", "--corpus"].contains(&arguments[k - 1].as_str());
    let plain = (0..arguments.len()).filter(|&k| !arguments[k].starts_with("--") && !is_value(k));
    let plain: Vec<String> = plain.map(|k| arguments[k].clone()).collect();
    let machines = plain.first().map_or("tnv40,stiff,workshop", String::as_str);
    let given = |wanted: &str| arguments.iter().any(|argument| argument == wanted);
    let beliefs = match (given("--wrong"), given("--one-wrong")) {
        (true, _) => all_wrong(),
        (_, true) => one_wrong(),
        _ => vec![[1.0; 3]],
    };
    let programs = programs(&arguments, &plain[1.min(plain.len())..]);
    println!(
        "what repeats of RMS and largest error, original and corrected in um, and their ratio; RMS of the rest and uncut path, corrected; time of \
         the original in s, and ratio; blocks; stretches changed"
    );
    for machine in machines.split(',') {
        let machine = seen_by_encoders(&Machine::load(machine.as_ref())?);
        let mut groups: Vec<(&str, Vec<Option<Ratios>>)> = Vec::new();
        for (group, name, text) in &programs {
            for factors in &beliefs {
                let [i, f, g] = factors.map(|factor| (100.0 * (factor - 1.0)).round());
                let name = match [i, f, g] == [0.0; 3] {
                    true => name.clone(),
                    false => format!("{name} {i:+} {f:+} {g:+} %"),
                };
                let ratios = line(&name, &machine, text, Some(wrong(&machine, *factors)));
                match groups.iter_mut().find(|(name, _)| name == group) {
                    Some((_, all)) => all.push(ratios),
                    None => groups.push((group, vec![ratios])),
                }
            }
        }
        for (group, ratios) in &groups {
            print_spread(
                &format!("{} {group}: 50 %, 90 %, all:", machine.name),
                ratios,
            );
        }
    }
    Ok(())
}
