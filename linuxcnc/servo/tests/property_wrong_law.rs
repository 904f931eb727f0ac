//! By the law of another machine the link is never worse than without a correction, and by the right one far better: on paths that begin where the machine
//! stands, without any motion before in which a law could prove itself.

#[path = "common/axis.rs"]
mod axis;
#[path = "common/inputs.rs"]
mod common;

use std::f64::consts::TAU;

use feedwright_control::{AxisKnowledge, IdentifiedAxes};
use feedwright_servo::machine::LinkModel;
use feedwright_servo::plant::SimulatedMachine;
use feedwright_servo::servo::{LinkFault, LinkInputs, Servo};

use axis::axis;
use common::{LIMITS, SERVO_S, cutting};

/// Feedrate and acceleration of the programs.
const FEED_MM_S: f64 = 50.0;
const ACCELERATION_MM_S2: f64 = 2000.0;
/// Servo periods of rest before and behind.
const REST: usize = 300;
/// Points of a path.
const POINTS: usize = 4000;
/// What is no worse, um: RMS and largest; and what is left by the right law, of both.
const NO_WORSE_UM: [f64; 2] = [0.05, 1.0];
const LEFT: [f64; 2] = [0.05, 0.15];
/// A drive that is asked for so much of its 30 N m is spent, N m; and how many times as large its largest error may be then.
const SPENT_NM: f64 = 27.0;
const SPENT: f64 = 1.2;

type Machine = IdentifiedAxes<2>;
type Change = fn(&mut AxisKnowledge);

/// Two axes alike, with the numbers of the machine of Lee, Cho and Jeon (2005).
fn machine() -> Machine {
    let axis = axis();
    IdentifiedAxes { mechanics_s: axis.periods.mechanics_s, axes: [axis; 2] }
}

fn changed(change: Change) -> Machine {
    let mut machine = machine();
    machine.axes.iter_mut().for_each(change);
    machine
}

/// A curve of a parameter from 0 to 1, as points.
fn curve(at: impl Fn(f64) -> [f64; 2]) -> Vec<[f64; 2]> {
    (0..=POINTS).map(|k| at(k as f64 / POINTS as f64)).collect()
}

fn circle() -> Vec<[f64; 2]> {
    curve(|t| [10.0 - 10.0 * (TAU * t).cos(), 10.0 * (TAU * t).sin()])
}

fn eight() -> Vec<[f64; 2]> {
    curve(|t| [20.0 * (TAU * t).sin(), 10.0 * (2.0 * TAU * t).sin()])
}

fn star() -> Vec<[f64; 2]> {
    curve(|t| {
        let radius = 12.0 + 4.0 * (5.0 * TAU * t).cos();
        [radius * (TAU * t).cos() - 16.0, radius * (TAU * t).sin()]
    })
}

/// Lengths along points, mm.
fn lengths(points: &[[f64; 2]]) -> Vec<f64> {
    let mut length_mm = 0.0;
    let step = |pair: &[[f64; 2]]| {
        length_mm += distance(pair[0], pair[1]);
        length_mm
    };
    std::iter::once(0.0).chain(points.windows(2).map(step)).collect()
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The way of a motion from rest to rest at the feedrate, mm.
fn way_mm(t_s: f64, length_mm: f64) -> f64 {
    let (ramp_s, whole_s) = (FEED_MM_S / ACCELERATION_MM_S2, length_mm / FEED_MM_S + FEED_MM_S / ACCELERATION_MM_S2);
    let t_s = t_s.clamp(0.0, whole_s);
    if t_s < ramp_s {
        0.5 * ACCELERATION_MM_S2 * t_s * t_s
    } else if t_s > whole_s - ramp_s {
        length_mm - 0.5 * ACCELERATION_MM_S2 * (whole_s - t_s).powi(2)
    } else {
        FEED_MM_S * (t_s - 0.5 * ramp_s)
    }
}

/// Commands of a program along points, with rest before and behind.
fn commands(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let lengths = lengths(points);
    let whole_mm = lengths[lengths.len() - 1];
    let periods = ((whole_mm / FEED_MM_S + FEED_MM_S / ACCELERATION_MM_S2) / SERVO_S).ceil() as usize;
    let at = |n: usize| {
        let way_mm = way_mm((n as f64 - REST as f64) * SERVO_S, whole_mm);
        let k = lengths.partition_point(|length| *length <= way_mm).clamp(1, points.len() - 1);
        let part = (way_mm - lengths[k - 1]) / (lengths[k] - lengths[k - 1]);
        std::array::from_fn(|i| points[k - 1][i] + part * (points[k][i] - points[k - 1][i]))
    };
    (0..periods + 2 * REST).map(at).collect()
}

/// RMS and largest contour error, um, and what was told.
struct Cut {
    error_um: [f64; 2],
    /// Largest torque of a motor, N m.
    largest_nm: f64,
    told: Vec<LinkFault>,
}

fn cut(real: &Machine, inertia: f64, points: &[[f64; 2]], enabled: bool) -> Cut {
    let (mut plant, mut servo) = (SimulatedMachine::new(real, 1), Servo::new(Ok(LinkModel::Axes(machine()))));
    servo.runs_at(SERVO_S);
    let (mut near, mut squares, mut largest, mut largest_nm, mut told) = (0, Vec::new(), 0.0_f64, 0.0_f64, Vec::new());
    let commands = commands(points);
    for (n, command_mm) in commands.iter().enumerate() {
        let inputs = LinkInputs { enabled, ..cutting(*command_mm, plant.measured_mm()) };
        let outputs = servo.step(&inputs, &LIMITS);
        plant.step(outputs.drive_mm, true, inertia);
        largest_nm = plant.torque_nm().iter().fold(largest_nm, |most, nm| most.max(nm.abs()));
        if !told.contains(&outputs.fault) {
            told.push(outputs.fault);
        }
        if n > REST && n + 150 < commands.len() {
            let error_um = 1e3 * error_mm(points, &mut near, plant.position_mm());
            squares.push(error_um * error_um);
            largest = largest.max(error_um);
        }
    }
    let rms_um = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    Cut { error_um: [rms_um, largest], largest_nm, told }
}

/// Distance of a tool from the path about the point that was nearest before.
fn error_mm(points: &[[f64; 2]], near: &mut usize, tool_mm: [f64; 2]) -> f64 {
    let about = near.saturating_sub(20)..(*near + 40).min(points.len());
    *near = about.min_by(|a, b| distance(points[*a], tool_mm).total_cmp(&distance(points[*b], tool_mm))).unwrap_or(0);
    let pieces = near.saturating_sub(1)..(*near + 1).min(points.len() - 1);
    pieces.map(|k| to_piece_mm(points[k], points[k + 1], tool_mm)).fold(f64::INFINITY, f64::min)
}

fn to_piece_mm(a: [f64; 2], b: [f64; 2], p: [f64; 2]) -> f64 {
    let (d, square) = ([b[0] - a[0], b[1] - a[1]], distance(a, b).powi(2));
    let t = (((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / square).clamp(0.0, 1.0);
    distance([a[0] + t * d[0], a[1] + t * d[1]], p)
}

/// Programs that bend late, early and all the time.
fn programs() -> [(&'static str, Vec<[f64; 2]>); 3] {
    [("circle", circle()), ("eight", eight()), ("star", star())]
}

#[test]
fn by_the_right_law_a_cut_that_begins_where_the_machine_stands_is_corrected() {
    for (name, points) in programs() {
        let [off, on] = [false, true].map(|enabled| cut(&machine(), 1.0, &points, enabled));
        for i in 0..2 {
            assert!(on.error_um[i] < LEFT[i] * off.error_um[i], "{name}: {:?} of {:?}", on.error_um, off.error_um);
        }
        assert_eq!(on.told, [LinkFault::None], "{name}");
    }
}

#[test]
fn by_the_law_of_another_machine_nothing_is_worse() {
    let wrong: [(&str, Change, f64); 12] = [
        ("1 ms late", |axis| axis.delays.drive_s += 0.001, 1.0),
        ("2 ms late", |axis| axis.delays.drive_s += 0.002, 1.0),
        ("3 ms late", |axis| axis.delays.drive_s += 0.003, 1.0),
        ("3 times as heavy", |_| {}, 3.0),
        ("2 times as heavy", |_| {}, 2.0),
        ("1.3 times as heavy", |_| {}, 1.3),
        ("half as heavy", |_| {}, 0.5),
        ("10 % more gain of position", |axis| axis.parameters.kp_1_s *= 1.1, 1.0),
        ("10 % less gain of position", |axis| axis.parameters.kp_1_s *= 0.9, 1.0),
        ("20 % more gain of position", |axis| axis.parameters.kp_1_s *= 1.2, 1.0),
        ("40 % less gain of speed", |axis| axis.parameters.kv_nm_s_per_rad *= 0.6, 1.0),
        ("twice the friction", |axis| axis.parameters.coulomb_friction_nm *= 2.0, 1.0),
    ];
    let mut worse = 0;
    for (how, change, inertia) in wrong {
        for (name, points) in programs() {
            let [off, on] = [false, true].map(|enabled| cut(&changed(change), inertia, &points, enabled));
            println!("{how:30} {name:8} {:7.2?} of {:7.2?} {:?}", on.error_um, off.error_um, on.told);
            // A machine whose drives have no torque left as it is swings further at its corners.
            let most = [1.0, if off.largest_nm > SPENT_NM { SPENT } else { 1.0 }];
            let no_worse = |i: usize| on.error_um[i] <= most[i] * off.error_um[i] + NO_WORSE_UM[i];
            worse += usize::from(!(no_worse(0) && no_worse(1)));
        }
    }
    assert_eq!(worse, 0, "cuts are worse");
}
