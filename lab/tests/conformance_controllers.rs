//! Every row of the table of controllers keeps the contract, in the plane and in space.

use std::sync::OnceLock;

use feedwright::{Choices, Entry, Setting, Setup};
use feedwright_control::{
    Bounds, Command, Controller, Knot, KnotSource, Measured, Schedule, Tick, Window,
};
use feedwright_lab::{CONTROLLERS, Workpiece};
use feedwright_sim::{Machine, Row, Run, Sink};

/// Deviation that the tick admits here, mm.
const MAX_DEVIATION_MM: f64 = 0.2;
/// Sagitta of the circle between two reference knots, mm: the accuracy with which the supervisor
/// knows the path.
const SAGITTA_MM: f64 = 0.05 * 0.05 / (8.0 * 10.0);

/// Largest deflection, A T^2 / 8, of an accelerating offset from a straight line between decisions,
/// mm. A is 400 mm/s^2; T is the longest feed period, 12 ms.
const BEND_MM: f64 = 400.0 * 0.012 * 0.012 / 8.0;

/// Parameters that change nothing of one lap of a circle in one cut: there are no rapids and no
/// corners, nothing is known from a lap before, the printed gradient corrects each knot for itself,
/// and of a tool that moves as no servo does the predictions miss as much as is of account.
const SILENT_HERE: &[(&str, &str)] = &[
    ("two-dimensional", "knots"),
    ("corner-contour", "reach_s"),
    ("corner-contour", "velocity_gain"),
    ("corner-contour", "acceleration_gain"),
    ("constrained-feedrate", "allowed_mm"),
    ("constrained-feedrate", "slowest"),
    ("iterative-learning-1", "gain"),
    ("iterative-learning-1", "lead_s"),
    ("iterative-learning-1", "cut-off_hz"),
    ("iterative-learning-3", "gain"),
    ("iterative-learning-3", "lead_s"),
    ("iterative-learning-3", "cut-off_hz"),
    ("iterative-learning-10", "gain"),
    ("iterative-learning-10", "lead_s"),
    ("iterative-learning-10", "cut-off_hz"),
];

/// The circle of eq. 11 at 50 mm/s, in the first two axes.
struct Circle;

impl<const N: usize> KnotSource<N> for Circle {
    fn knot(&mut self, tau_s: f64) -> Knot<N> {
        let (sin, cos) = (5.0 * tau_s).sin_cos();
        let mut knot = Knot {
            feed_mm_s: 50.0,
            cutting: true,
            ..Knot::REST
        };
        (knot.position_mm[0], knot.position_mm[1]) = (10.0 * (1.0 - cos), 10.0 * sin);
        (knot.tangent[0], knot.tangent[1]) = (sin, cos);
        knot
    }
}

/// A path that stands still.
struct Rest;

impl<const N: usize> KnotSource<N> for Rest {
    fn knot(&mut self, _: f64) -> Knot<N> {
        let mut knot = Knot {
            position_mm: [3.0; N],
            ..Knot::REST
        };
        knot.tangent[0] = 1.0;
        knot
    }
}

fn machine() -> &'static Machine {
    static MACHINE: OnceLock<Machine> = OnceLock::new();
    MACHINE.get_or_init(|| Machine::load("tnv40".as_ref()).unwrap())
}

/// Calls a check with every controller of the table, in two and in three axes.
macro_rules! for_every_controller {
    ($check:ident) => {
        for entry in CONTROLLERS {
            let choices = Choices::default();
            let mut setup = Setup::new(machine(), &choices);
            $check::<2>(entry.name, &mut *entry.in_plane(&mut setup));
            $check::<3>(entry.name, &mut *entry.in_space(&mut setup));
        }
    };
}

/// Commands of a run along a path; the tool lags by 20 ms and is 20 um off, or wherever `tool` puts
/// it.
fn commands<const N: usize>(
    reference: &mut dyn KnotSource<N>,
    controller: &mut dyn Controller<N>,
    tool: impl Fn(u32, [f64; N]) -> [f64; N],
) -> Vec<[f64; N]> {
    let mut tick = Tick::new(
        0.001,
        controller.schedule(),
        Bounds::new(MAX_DEVIATION_MM, 400.0, 400.0),
    );
    (0..600)
        .map(|n| {
            let lagging = reference.knot(f64::from(n) * 0.001 - 0.02).position_mm;
            tick.step(reference, controller, tool(n, lagging))
                .command_mm
        })
        .collect()
}

fn off<const N: usize>(_: u32, mut lagging: [f64; N]) -> [f64; N] {
    lagging[0] += 0.02;
    lagging
}

#[test]
fn rest_stays_at_rest() {
    fn check<const N: usize>(name: &str, controller: &mut dyn Controller<N>) {
        for command in commands(&mut Rest, controller, |_, lagging| lagging) {
            assert_eq!(command, [3.0; N], "{name}");
        }
    }
    for_every_controller!(check);
}

#[test]
fn the_same_input_gives_the_same_bits_after_a_reset() {
    fn check<const N: usize>(name: &str, controller: &mut dyn Controller<N>) {
        let first = commands(&mut Circle, controller, off);
        controller.reset();
        let second = commands(&mut Circle, controller, off);
        assert_eq!(first, second, "{name}");
    }
    for_every_controller!(check);
}

#[test]
fn every_parameter_acts_and_at_both_ends_the_command_stays_within_the_limits() {
    let made = |entry: &'static Entry, set: Vec<Setting>| {
        let choices = Choices {
            set,
            ..Choices::default()
        };
        let mut setup = Setup::new(machine(), &choices);
        let swaying = |n: u32, lagging: [f64; 2]| {
            [lagging[0] + 0.02 * (0.02 * f64::from(n)).sin(), lagging[1]]
        };
        commands::<2>(&mut Circle, &mut *entry.in_plane(&mut setup), swaying)
    };
    let mut wrong = Vec::new();
    for entry in CONTROLLERS {
        let default = made(entry, Vec::new());
        for parameter in entry.parameters {
            let at = |value| {
                made(
                    entry,
                    vec![Setting {
                        controller: entry.name,
                        name: parameter.name,
                        value,
                    }],
                )
            };
            let ends = parameter.allowed.map(at);
            for command in ends.iter().flatten() {
                let beside = (command[0] - 10.0).hypot(command[1]) - 10.0;
                assert!(
                    beside.abs() <= MAX_DEVIATION_MM + SAGITTA_MM + BEND_MM,
                    "{} {parameter:?}: {beside}",
                    entry.name
                );
            }
            let acts = ends.iter().any(|commands| *commands != default);
            let silent = SILENT_HERE.contains(&(entry.name, parameter.name));
            if acts == silent {
                wrong.push((entry.name, parameter.name, acts));
            }
        }
    }
    assert_eq!(
        wrong,
        [],
        "name, parameter, and whether it changes anything"
    );
}

#[test]
fn a_lost_or_absurd_measurement_gives_a_command_within_the_limits() {
    fn check<const N: usize>(name: &str, controller: &mut dyn Controller<N>) {
        let absurd = |n: u32, mut tool: [f64; N]| {
            tool[0] = match n % 150 {
                50 => f64::NAN,
                70..90 => f64::INFINITY,
                100 => 1e300,
                120 => tool[0] - 1e3,
                _ => tool[0],
            };
            tool
        };
        let mut path = Circle;
        for (n, command) in commands(&mut path, controller, absurd)
            .into_iter()
            .enumerate()
        {
            // The rate may differ from the plan's, so the path is the circle, not the point of this
            // instant.
            let radius = (command[0] - 10.0).hypot(command[1]);
            let beside = command[2..].iter().fold(radius - 10.0, |d, z| d.hypot(*z));
            assert!(
                beside.abs() <= MAX_DEVIATION_MM + SAGITTA_MM,
                "{name}, {n}: {command:?}"
            );
        }
    }
    for_every_controller!(check);
}

/// A controller, and the positions that it is shown.
struct Shown<'a, const N: usize> {
    controller: &'a mut dyn Controller<N>,
    positions_mm: Vec<[f64; N]>,
}

impl<const N: usize> Controller<N> for Shown<'_, N> {
    fn schedule(&self) -> Schedule {
        self.controller.schedule()
    }

    fn reset(&mut self) {
        self.controller.reset();
    }

    fn next_lap(&mut self) {
        self.controller.next_lap();
    }

    fn observe(&mut self, window: &Window<'_, N>, measured: Option<&Measured<N>>) {
        self.positions_mm
            .extend(measured.map(|measured| measured.position_mm));
        self.controller.observe(window, measured);
    }

    fn command(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N> {
        self.positions_mm.push(measured.position_mm);
        self.controller.command(window, measured)
    }
}

/// The true positions of a run.
struct TruePositions(Vec<[f64; 3]>);

impl Sink for TruePositions {
    fn row(&mut self, row: &Row) -> std::io::Result<()> {
        self.0.push(row.act_mm);
        Ok(())
    }
}

/// Part of the coordinates that are no whole number of encoder steps.
fn between_steps<const N: usize>(positions_mm: &[[f64; N]], step_mm: f64) -> f64 {
    // Between rad at the motor shaft and mm a position is rounded, by a billionth of a step at 100
    // mm.
    let between = |mm: &f64| ((mm / step_mm).round() - mm / step_mm).abs() > 1e-6;
    let coordinates: Vec<f64> = positions_mm
        .iter()
        .flat_map(|position| [position[0], position[1]])
        .collect();
    coordinates.iter().filter(|mm| between(mm)).count() as f64 / coordinates.len() as f64
}

#[test]
fn a_controller_is_shown_what_the_encoder_measures_and_not_where_the_tool_is() {
    let coarse = Machine::load("coarse".as_ref()).unwrap();
    let step_mm = 1e-3 * coarse.axes[0].encoder_step_um;
    let circle = Workpiece::contours()
        .into_iter()
        .find(|workpiece| workpiece.name == "circle")
        .unwrap();
    for entry in CONTROLLERS {
        let choices = Choices::default();
        let mut setup = Setup::new(machine(), &choices);
        let mut controller = entry.in_plane(&mut setup);
        let mut shown = Shown {
            controller: &mut *controller,
            positions_mm: Vec::new(),
        };
        let mut truth = TruePositions(Vec::new());
        Run::on(&coarse)
            .cut_steps(&circle.steps, &mut shown, &mut [&mut truth])
            .unwrap();
        assert!(shown.positions_mm.len() > 100, "{}", entry.name);
        assert_eq!(
            between_steps(&shown.positions_mm, step_mm),
            0.0,
            "{}",
            entry.name
        );
        // The true position would have been found out.
        assert!(
            between_steps(&truth.0, step_mm) > 0.5,
            "{}: {}",
            entry.name,
            between_steps(&truth.0, step_mm)
        );
    }
}

#[test]
fn a_tick_allocates_nothing() {
    fn check<const N: usize>(name: &str, controller: &mut dyn Controller<N>) {
        let mut tick = Tick::new(
            0.001,
            controller.schedule(),
            Bounds::new(MAX_DEVIATION_MM, 400.0, 400.0),
        );
        let counted = allocation_counter::measure(|| {
            for n in 0..600 {
                let lagging: Knot<N> = Circle.knot(f64::from(n) * 0.001 - 0.02);
                std::hint::black_box(tick.step(
                    &mut Circle,
                    controller,
                    off(n, lagging.position_mm),
                ));
            }
        });
        assert_eq!(counted.count_total, 0, "{name}");
    }
    for_every_controller!(check);
}
