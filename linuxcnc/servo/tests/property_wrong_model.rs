//! With the model of another machine, the link is never worse than without a correction; with the
//! right model it is far better. The paths begin where the machine stands, so the supervisor cannot
//! test a model in earlier motion.

#[path = "common/axis.rs"]
mod axis;
#[path = "common/inputs.rs"]
mod common;
#[path = "common/paths.rs"]
#[expect(dead_code, reason = "other tests need the rest")]
mod paths;

use feedwright_control::{IdentifiedAxes, Parameters, TrainedModel};
use feedwright_servo::plant::SimulatedMachine;
use feedwright_servo::servo::{LinkFault, LinkInputs, Servo};

use axis::{PERIODS, axis};
use common::{LIMITS, SERVO_S, cutting};
use paths::{REST, circle, commands, eight, error_mm, star};

/// Permitted increase of the error with a wrong model, um: RMS and largest; and the part of the RMS
/// and of the largest error that may remain with the right model.
const NO_WORSE_UM: [f64; 2] = [0.05, 1.0];
const LEFT: [f64; 2] = [0.05, 0.2];
/// Torque of a drive of 30 N m above which it has no reserve, N m; and the factor by which its
/// largest error may grow then.
const SPENT_NM: f64 = 27.0;
const SPENT: f64 = 1.2;

type Machine = IdentifiedAxes<2>;
type Change = fn(&mut Parameters);

/// Returns two equal axes with the numbers of the machine of Lee, Cho and Jeon (2005).
fn machine() -> Machine {
    let axis = axis();
    IdentifiedAxes {
        periods: PERIODS,
        axes: [axis; 2],
    }
}

fn changed(change: Change) -> Machine {
    let mut machine = machine();
    machine.axes.iter_mut().for_each(change);
    machine
}

/// RMS and largest contour error, um, and the reported faults.
struct Cut {
    error_um: [f64; 2],
    /// Largest torque of a motor, N m.
    largest_nm: f64,
    reported: Vec<LinkFault>,
}

fn cut(real: &Machine, inertia: f64, points: &[[f64; 2]], enabled: bool) -> Cut {
    let (mut plant, mut servo) = (
        SimulatedMachine::new(real, 1),
        Servo::new(Ok(TrainedModel::of_axes(machine()))),
    );
    servo.runs_at(SERVO_S);
    let (mut near, mut squares, mut largest, mut largest_nm, mut reported) =
        (0, Vec::new(), 0.0_f64, 0.0_f64, Vec::new());
    let commands = commands(points);
    for (n, command_mm) in commands.iter().enumerate() {
        let inputs = LinkInputs {
            enabled,
            ..cutting(*command_mm, plant.measured_mm())
        };
        let outputs = servo.step(&inputs, &LIMITS);
        plant.step(outputs.drive_mm, true, inertia);
        largest_nm = plant
            .torque_nm()
            .iter()
            .fold(largest_nm, |most, nm| most.max(nm.abs()));
        if !reported.contains(&outputs.fault) {
            reported.push(outputs.fault);
        }
        if n > REST && n + 150 < commands.len() {
            let error_um = 1e3 * error_mm(points, &mut near, plant.position_mm());
            squares.push(error_um * error_um);
            largest = largest.max(error_um);
        }
    }
    let rms_um = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    Cut {
        error_um: [rms_um, largest],
        largest_nm,
        reported,
    }
}

/// Returns programs with curvature that comes late, that comes early and that is always there.
fn programs() -> [(&'static str, Vec<[f64; 2]>); 3] {
    [("circle", circle()), ("eight", eight()), ("star", star())]
}

#[test]
fn by_the_right_model_a_cut_that_begins_where_the_machine_stands_is_corrected() {
    for (name, points) in programs() {
        let [off, on] = [false, true].map(|enabled| cut(&machine(), 1.0, &points, enabled));
        for i in 0..2 {
            assert!(
                on.error_um[i] < LEFT[i] * off.error_um[i],
                "{name}: {:?} of {:?}",
                on.error_um,
                off.error_um
            );
        }
        assert_eq!(on.reported, [LinkFault::None], "{name}");
    }
}

#[test]
fn by_the_model_of_another_machine_nothing_is_worse() {
    let wrong: [(&str, Change, f64); 12] = [
        ("1 ms late", |axis| axis.drive_delay_s += 0.001, 1.0),
        ("2 ms late", |axis| axis.drive_delay_s += 0.002, 1.0),
        ("3 ms late", |axis| axis.drive_delay_s += 0.003, 1.0),
        ("3 times as heavy", |_| {}, 3.0),
        ("2 times as heavy", |_| {}, 2.0),
        ("1.3 times as heavy", |_| {}, 1.3),
        ("half as heavy", |_| {}, 0.5),
        ("10 % more gain of position", |axis| axis.kp_1_s *= 1.1, 1.0),
        ("10 % less gain of position", |axis| axis.kp_1_s *= 0.9, 1.0),
        ("20 % more gain of position", |axis| axis.kp_1_s *= 1.2, 1.0),
        (
            "40 % less gain of speed",
            |axis| axis.kv_nm_s_per_rad *= 0.6,
            1.0,
        ),
        (
            "twice the friction",
            |axis| axis.coulomb_friction_nm *= 2.0,
            1.0,
        ),
    ];
    let mut worse = 0;
    for (how, change, inertia) in wrong {
        for (name, points) in programs() {
            let [off, on] =
                [false, true].map(|enabled| cut(&changed(change), inertia, &points, enabled));
            println!(
                "{how:30} {name:8} {:7.2?} of {:7.2?} {:?}",
                on.error_um, off.error_um, on.reported
            );
            // A machine whose drives have no torque reserve overshoots more at its corners.
            let most = [
                1.0,
                if off.largest_nm > SPENT_NM {
                    SPENT
                } else {
                    1.0
                },
            ];
            let no_worse = |i: usize| on.error_um[i] <= most[i] * off.error_um[i] + NO_WORSE_UM[i];
            worse += usize::from(!(no_worse(0) && no_worse(1)));
        }
    }
    assert_eq!(worse, 0, "cuts are worse");
}
