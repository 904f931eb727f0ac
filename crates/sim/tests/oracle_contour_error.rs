//! Checks the contour error in real time, which uses only the stored knots, against the exact
//! distance to the path, on every program of `parts/`: they agree within 1 um, with bounded work.
//!
//! `Reference::nearest` gives the exact distance; dense sampling checks it here.

use std::path::{Path, PathBuf};

use feedwright_control::{
    Bounds, Command, Controller, Knot, MAX_ENTRIES, Measured, REGISTER_KNOTS, Schedule, Tick,
    Window,
};
use feedwright_gcode::{Reader, Settings};
use feedwright_plan::PathLimits;
use feedwright_sim::{Foot, Machine, Plant, Reference};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Largest difference that is allowed, mm.
const PROMISED_MM: f64 = 1e-3;
/// Distance of a tool from the lagging reference, mm.
const OFFSET_MM: f64 = 0.1;
/// Servo periods in which a tool gets from one random place to the next: it is fast, but no tool is
/// somewhere else in no time.
const DRAWN_EVERY: u32 = 50;
/// Lag of the tool behind the reference, s: kp = 50 1/s, and friction.
const LAG_S: f64 = 0.022;
/// Time over which the path behind is searched, s: all that the register holds, and two to four
/// times the lag. Where a path returns beside itself, an older stretch may be nearer than the
/// stretch that is cut; the distance to either is accepted.
const LOOKS_BACK_S: [f64; 4] = [f64::INFINITY, 4.0 * LAG_S, 3.0 * LAG_S, 2.0 * LAG_S];
/// Step of the dense sampling, s: 5 um at 50 mm/s, before the refinement.
const DENSE_S: f64 = 1e-4;

fn parts() -> Vec<PathBuf> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../parts");
    let mut parts: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    parts.retain(|path| path.extension().is_some_and(|ending| ending == "ngc"));
    parts.sort();
    assert!(parts.len() >= 7, "{parts:?}");
    parts
}

/// The path in all three axes.
struct Axes<'a, 'p>(&'a mut Reference<'p>);

impl feedwright_control::KnotSource<3> for Axes<'_, '_> {
    fn knot(&mut self, tau_s: f64) -> Knot<3> {
        let sample = self.0.at(tau_s);
        Knot {
            position_mm: sample.position_mm,
            tangent: sample.tangent,
            feed_mm_s: sample.feed_mm_s,
            cutting: true,
        }
    }
}

/// Keeps the planned motion and records the measurement that it gets.
struct Recorder {
    schedule: Schedule,
    measured: Option<Measured<3>>,
}

impl Controller<3> for Recorder {
    fn schedule(&self) -> Schedule {
        self.schedule
    }

    fn reset(&mut self) {}

    fn observe(&mut self, _: &Window<'_, 3>, measured: Option<&Measured<3>>) {
        self.measured = measured.copied();
    }

    fn command(&mut self, _: &Window<'_, 3>, _: &Measured<3>) -> Command<3> {
        Command::AS_PLANNED
    }
}

/// Source of the tool position.
enum Tool {
    /// Position in an uncorrected cut.
    Machine(Box<Plant<3>>),
    /// Wandering at random beside the lagging reference.
    Random(Xoshiro256PlusPlus),
}

/// Follows a program and checks every estimate.
fn check(part: &Path, machine: &Machine, schedule: Schedule, mut tool: Tool) {
    let name = part.file_name().unwrap().to_string_lossy();
    let limits = PathLimits::from(&machine.limits);
    let program = || {
        Reader::open(part, Settings::default())
            .unwrap()
            .map(Result::unwrap)
    };
    let mut reference = Reference::of_program(program(), &limits).unwrap();
    let servo_s = machine.period.servo_s;
    let reach_s = (REGISTER_KNOTS - 1) as f64 * servo_s;
    let mut recorder = Recorder {
        schedule,
        measured: None,
    };
    let mut tick = Tick::<3>::new(
        servo_s,
        schedule,
        Bounds::new(
            machine.limits.max_deviation_mm,
            machine.limits.rapid_mm_s,
            400.0,
        ),
    );
    let mut tool_mm = reference.at(0.0).position_mm;
    let (mut checked, mut worst_mm) = (0, 0.0_f64);
    let (mut from_mm, mut to_mm) = ([0.0; 3], [0.0; 3]);
    for n in 0_u32.. {
        let tau_s = f64::from(n) * servo_s;
        if reference.end_s().is_some_and(|end_s| tau_s > end_s + LAG_S) {
            break;
        }
        let setpoint = tick.step(&mut Axes(&mut reference), &mut recorder, tool_mm);
        if let Some(measured) = recorder.measured.take() {
            let ahead_s = f64::from(schedule.preview * schedule.servo_periods) * servo_s;
            let exact = reference.nearest(tool_mm, tau_s - reach_s, tau_s + ahead_s);
            let estimate_mm = feedwright_control::vector::norm(measured.contour.vector_mm);
            // The window ends with the knot behind the current one, or at it where tau is rounded
            // down; the tool lags, so what the preview adds may be looked at and need not.
            let mut distances = Vec::new();
            for back_s in LOOKS_BACK_S {
                for hi_s in [tau_s, tau_s + servo_s, tau_s + ahead_s + servo_s] {
                    distances.push(
                        reference
                            .nearest(tool_mm, tau_s - back_s.min(reach_s), hi_s)
                            .distance_mm,
                    );
                }
            }
            let off_mm = distances
                .iter()
                .map(|exact_mm| (estimate_mm - exact_mm).abs())
                .fold(f64::INFINITY, f64::min);
            worst_mm = worst_mm.max(off_mm);
            assert!(
                off_mm <= PROMISED_MM,
                "{name} at {tau_s:.3} s, line {}: {estimate_mm} mm estimated, {} mm exact; tool {tool_mm:?}, {measured:?}",
                exact.line,
                exact.distance_mm
            );
            assert!(
                measured.contour.entries <= MAX_ENTRIES,
                "{name}: {} entries",
                measured.contour.entries
            );
            if checked % 97 == 0 {
                against_sampling(
                    &mut reference,
                    tool_mm,
                    [tau_s - reach_s, tau_s + ahead_s],
                    &exact,
                    &name,
                );
            }
            checked += 1;
        }
        tool_mm = match &mut tool {
            Tool::Machine(plant) => plant.step(setpoint.command_mm).position_mm,
            Tool::Random(rng) => {
                if n % DRAWN_EVERY == 0 {
                    from_mm = to_mm;
                    to_mm = [0.0; 3]
                        .map(|_: f64| rng.random_range(-OFFSET_MM..=OFFSET_MM) / 3.0_f64.sqrt());
                }
                let part = f64::from(n % DRAWN_EVERY) / f64::from(DRAWN_EVERY);
                let lagging_mm = reference.at(tau_s + servo_s - LAG_S).position_mm;
                std::array::from_fn(|i| lagging_mm[i] + from_mm[i] + part * (to_mm[i] - from_mm[i]))
            }
        };
    }
    assert!(checked > 50, "{name}: {checked} estimates");
    eprintln!(
        "{name}, every {} periods: {checked} estimates, worst {:.3} um",
        schedule.servo_periods,
        worst_mm * 1e3
    );
}

/// The exact distance against the nearest of many points, refined between the neighbours of the
/// best.
fn against_sampling(
    reference: &mut Reference<'_>,
    tool_mm: [f64; 3],
    [lo_s, hi_s]: [f64; 2],
    exact: &Foot,
    name: &str,
) {
    let mut distance = |tau_s: f64| {
        let p = reference.at(tau_s).position_mm;
        (p[0] - tool_mm[0])
            .hypot(p[1] - tool_mm[1])
            .hypot(p[2] - tool_mm[2])
    };
    let steps = ((hi_s - lo_s) / DENSE_S) as u32;
    let (mut best_s, mut best_mm) = (hi_s, distance(hi_s));
    for step in 0..=steps {
        let tau_s = lo_s + f64::from(step) * DENSE_S;
        let d = distance(tau_s);
        if d < best_mm {
            (best_s, best_mm) = (tau_s, d);
        }
    }
    let fine =
        (-100..=100).map(|i| distance((best_s + f64::from(i) * DENSE_S / 100.0).clamp(lo_s, hi_s)));
    let best_mm = fine.fold(best_mm, f64::min);
    // Sampled, the distance can only be too large: by half a step of 0.05 um at the most.
    assert!(
        exact.distance_mm <= best_mm + 1e-9,
        "{name}: sampling found a nearer point: {best_mm} {exact:?}"
    );
    assert!(
        best_mm - exact.distance_mm <= 1e-4,
        "{name}: {best_mm} mm sampled, {exact:?}"
    );
}

/// Feed periods of 10 ms without preview, as the paper has them; and of 5 ms with preview.
const SCHEDULES: [Schedule; 2] = [
    Schedule {
        servo_periods: 10,
        preview: 0,
    },
    Schedule {
        servo_periods: 5,
        preview: 20,
    },
];

#[test]
fn a_tool_in_uncorrected_is_where_the_estimate_says() {
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    for part in &parts() {
        let program = Reader::open(part, Settings::default())
            .unwrap()
            .map(Result::unwrap);
        let start_mm = Reference::of_program(program, &machine)
            .unwrap()
            .at(0.0)
            .position_mm;
        for schedule in SCHEDULES {
            check(
                part,
                &machine,
                schedule,
                Tool::Machine(Box::new(Plant::new(&machine, start_mm))),
            );
        }
    }
}

#[test]
fn a_tool_thrown_about_is_where_the_estimate_says() {
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    for (seed, part) in (1..).zip(&parts()) {
        for schedule in SCHEDULES {
            check(
                part,
                &machine,
                schedule,
                Tool::Random(Xoshiro256PlusPlus::seed_from_u64(seed)),
            );
        }
    }
}
