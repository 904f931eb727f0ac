//! What corrected programs deliver on a control without a correction of its own:
//! `cargo run --release -p feedwright-lab --example corrected_programs [MACHINE,...] [PROGRAM...]`.
//!
//! Each program is corrected for `generic` on each machine. The machine then cuts the uncorrected
//! and the corrected program with its disturbance, over [`CUTS`] phases of it and seeds of the
//! noise. The example prints the mean errors and the ratio of corrected to uncorrected error.
//!
//! The ratio leaves out the error that no program can remove. It is the error of the corrected
//! program on the machine, less its error on the machine without disturbance, noise and geometry
//! (as squares for the RMS).
//!
//! With `--wrong` the correction uses a model whose inertia, friction and speed-loop gain are 20 %
//! off, each up or down. With `--one-wrong` only one of them is off.

use std::path::{Path, PathBuf};

use feedwright::{CorrectJob, ExportedCut, ExportedFigures, TARGETS, deterministic};
use feedwright_gcode::{Program, Reader, Settings};
use feedwright_plan::{Pieces, Step};
use feedwright_sim::{Axis, Machine};

/// Cuts of each program.
const CUTS: u64 = 20;

/// Programs of the table that are no files: name, text, and true corners.
const LETTERS: &str = "G21 G90 G64 F3000\nG0 X0 Y0\nG1 X4 Y14\nX8 Y0\nX6.5 Y5\nX1.5\nG0 X12 Y0\nG1 Y14\nX16\nG2 X16 Y7 J-3.5\nG1 X12\nX16.5\n\
                       G2 X16.5 Y0 J-3.5\nG1 X12\nG0 X32 Y11\nG3 X22 Y11 R5\nG1 Y3\nG3 X32 Y3 R5\nM2\n";
const RHOMBUS: &str = "G21 G90 G64 F3000\nG0 X0 Y0\nG1 X10 Y6\nX20 Y0\nX10 Y-6\nX0 Y0\nM2\n";
const OWN: [(&str, &str); 2] = [("letters", LETTERS), ("rhombus", RHOMBUS)];

fn steps(part: &Path) -> Vec<Step> {
    let reader = Reader::open(part, Settings::default()).expect("a program");
    Pieces::new(reader.map_while(Result::ok)).map_while(Result::ok).collect()
}

/// Means over phases of the disturbance and seeds.
fn mean(machine: &Machine, original: &[Step], program: &[Step], axes: usize) -> ExportedFigures {
    let mut sum = ExportedFigures::default();
    for seed in 0..CUTS {
        let machine = machine.with_noise_seed(100 + seed);
        let stages = TARGETS[0].stages(&machine);
        let cut = ExportedCut { machine: &machine, tool: None, stages, original, axes, watch: &() };
        let now =
            cut.once(program, seed as f64 / CUTS as f64 / machine.axes[0].disturbance_hz.max(1.0)).expect("a cut");
        sum.rms_um += now.rms_um / CUTS as f64;
        sum.max_um += now.max_um / CUTS as f64;
        (sum.time_s, sum.blocks) = (now.time_s, now.blocks);
    }
    sum
}

/// The machine with inertia, friction and gain of the speed loop times these factors; gains of the position loop, feedforward and delays stay.
fn wrong(machine: &Machine, factors: [f64; 3]) -> Machine {
    let factor = |which: usize| factors[which];
    let axis = |axis: &Axis| Axis {
        inertia_kg_m2: axis.inertia_kg_m2 * factor(0),
        coulomb_friction_nm: axis.coulomb_friction_nm * factor(1),
        viscous_friction_nm_s: axis.viscous_friction_nm_s * factor(1),
        stribeck_nm: axis.stribeck_nm * factor(1),
        kv_nm_s_per_rad: axis.kv_nm_s_per_rad * factor(2),
        ..*axis
    };
    Machine { axes: machine.axes.iter().map(axis).collect(), ..machine.clone() }
}

/// Every one of the three 20 % off, up or down.
fn all_wrong() -> Vec<[f64; 3]> {
    (0..8).map(|way| [0, 1, 2].map(|bit: usize| if way >> bit & 1 == 1 { 1.2 } else { 0.8 })).collect()
}

/// One of the three 20 % off, up or down.
fn one_wrong() -> Vec<[f64; 3]> {
    let one = |which: usize, factor: f64| std::array::from_fn(|k| if k == which { factor } else { 1.0 });
    (0..3).flat_map(|which| [one(which, 0.8), one(which, 1.2)]).collect()
}

/// Ratio of the corrected to the uncorrected error, both without the error that no program can
/// remove. `power` is 2 for the RMS, whose squares are subtracted, and 1 for the largest error.
fn ratio(original: f64, corrected: f64, nobody: f64, power: i32) -> f64 {
    let above = |error: f64| (error.powi(power) - nobody.powi(power)).max(0.0).powf(1.0 / f64::from(power));
    above(corrected) / above(original).max(1e-9)
}

fn line(name: &str, machine: &Machine, part: &Path, believed: Option<Machine>) {
    let summary = Program::in_file(part).check(Settings::default()).expect("a program");
    let axes = if summary.moves[2] { 3 } else { 2 };
    let mut job = CorrectJob::new(Program::in_file(part), machine.clone(), &TARGETS[0]);
    job.believed = believed;
    let outcome = match job.run(&()) {
        Ok(outcome) => outcome,
        Err(error) => return println!("{:<9} {name:<24} {error}", machine.name),
    };
    let Some(text) = outcome.program() else {
        return println!("{:<9} {name:<24} not written: {}", machine.name, outcome.refusal.clone().unwrap_or_default());
    };
    let original = steps(part);
    let program: Vec<Step> = {
        let reader = Reader::from_text("corrected.ngc", text, Settings::default()).expect("a program");
        Pieces::new(reader.map_while(Result::ok)).map_while(Result::ok).collect()
    };
    let (was, is) = (mean(machine, &original, &original, axes), mean(machine, &original, &program, axes));
    let quiet = mean(&deterministic(machine), &original, &program, axes);
    let nobody_rms = (is.rms_um.powi(2) - quiet.rms_um.powi(2)).max(0.0).sqrt();
    let nobody_max = (is.max_um - quiet.max_um).max(0.0);
    println!(
        "{:<9} {name:<24} {:>6.2} {:>6.2} {:>6.3}  {:>6.1} {:>6.1} {:>6.3}  {:>8.2} {:>6.3} {:>6} {:>6}  {:>3}",
        machine.name,
        was.rms_um,
        is.rms_um,
        ratio(was.rms_um, is.rms_um, nobody_rms, 2),
        was.max_um,
        is.max_um,
        ratio(was.max_um, is.max_um, nobody_max, 1),
        was.time_s,
        is.time_s / was.time_s,
        was.blocks,
        is.blocks,
        outcome.stretches,
    );
}

fn main() {
    let (options, arguments): (Vec<String>, Vec<String>) = std::env::args().skip(1).partition(|a| a.starts_with("--"));
    let machines = arguments.first().cloned().unwrap_or_else(|| "tnv40,stiff,workshop".to_owned());
    let folder = tempfile::tempdir().expect("a folder");
    let mut programs: Vec<(String, PathBuf)> = arguments[1.min(arguments.len())..]
        .iter()
        .map(|path| (Path::new(path).file_stem().unwrap_or_default().to_string_lossy().into_owned(), path.into()))
        .collect();
    if programs.is_empty() {
        let parts = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../parts"));
        programs = ["circle", "ellipse", "eight", "star", "square"]
            .map(|name| (name.to_owned(), parts.join(name).with_extension("ngc")))
            .to_vec();
        for (name, text) in OWN {
            let path = folder.path().join(name).with_extension("ngc");
            std::fs::write(&path, text).expect("a file");
            programs.push((name.to_owned(), path));
        }
    }
    println!(
        "RMS and largest error of original and corrected in um, their ratio; time of the original in s, and ratio; blocks; stretches"
    );
    for machine in machines.split(',') {
        let machine = Machine::load(machine.as_ref()).expect("a machine");
        for (name, path) in &programs {
            let given = |wanted: &str| options.iter().any(|option| option == wanted);
            let beliefs = match (given("--wrong"), given("--one-wrong")) {
                (true, _) => all_wrong(),
                (_, true) => one_wrong(),
                _ => Vec::new(),
            };
            for factors in &beliefs {
                let [inertia, friction, gain] = factors.map(|factor| (100.0 * (factor - 1.0)).round());
                let name = format!("{name} {inertia:+} {friction:+} {gain:+} %");
                line(&name, &machine, path, Some(wrong(&machine, *factors)));
            }
            if beliefs.is_empty() {
                line(name, &machine, path, None);
            }
        }
    }
}
