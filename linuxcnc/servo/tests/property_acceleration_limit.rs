//! Cuts with an acceleration limit of the correction are no worse than without a correction, and
//! the offset keeps the limit in every servo period.

#[path = "common/axis.rs"]
mod axis;
#[path = "common/inputs.rs"]
mod common;
#[path = "common/paths.rs"]
#[expect(dead_code, reason = "other tests need the rest")]
mod paths;

use feedwright_control::{IdentifiedAxes, TrainedModel};
use feedwright_servo::limits::LinkLimits;
use feedwright_servo::plant::SimulatedMachine;
use feedwright_servo::servo::{Link, LinkInputs, Servo};

use axis::{PERIODS, axis};
use common::{LIMITS, SERVO_S, cutting};
use paths::{REST, circle, commands, error_mm, square, star, stopping};

const ACCELERATIONS_MM_S2: [f64; 4] = [2000.0, 8000.0, 20_000.0, 80_000.0];
/// Permitted increase of the contour error, um: RMS and largest.
const NO_WORSE_UM: [f64; 2] = [0.05, 1.0];
/// Rounding error of an acceleration, mm/s2.
const ROUNDING_MM_S2: f64 = 1e-3;

type Machine = IdentifiedAxes<2>;

/// Returns two equal axes whose gain is `gain` times the gain of the model.
fn machine(gain: f64) -> Machine {
    let mut axis = axis();
    axis.kp_1_s *= gain;
    IdentifiedAxes {
        periods: PERIODS,
        axes: [axis; 2],
    }
}

/// RMS and largest contour error, um, and the largest acceleration of the offset in an axis, mm/s2.
struct Cut {
    error_um: [f64; 2],
    offset_mm_s2: f64,
}

fn cut(
    real: &Machine,
    points: &[[f64; 2]],
    commands: &[[f64; 2]],
    limits: &LinkLimits,
    enabled: bool,
) -> Cut {
    let (mut plant, mut servo) = (
        SimulatedMachine::new(real, 1),
        Servo::new(Ok(TrainedModel::of_axes(machine(1.0)))),
    );
    servo.runs_at(SERVO_S);
    let (mut near, mut squares, mut largest_um, mut offset_mm_s2) =
        (0, Vec::new(), 0.0_f64, 0.0_f64);
    let (mut path_mm, mut offsets) = (vec![commands[0]; 10], [[0.0; 2]; 3]);
    for (n, command_mm) in commands.iter().enumerate() {
        let inputs = LinkInputs {
            enabled,
            ..cutting(*command_mm, plant.measured_mm())
        };
        let outputs = servo.step(&inputs, limits);
        plant.step(outputs.drive_mm, true, 1.0);
        path_mm.push(*command_mm);
        if outputs.link == Link::Delayed && n > REST / 2 {
            // The drive gets the command of one delay earlier (10 servo periods), plus the offset.
            let before_mm = path_mm[path_mm.len() - 1 - 10];
            offsets = [
                [
                    outputs.drive_mm[0] - before_mm[0],
                    outputs.drive_mm[1] - before_mm[1],
                ],
                offsets[0],
                offsets[1],
            ];
            for axis in 0..2 {
                let bend_mm = offsets[0][axis] - 2.0 * offsets[1][axis] + offsets[2][axis];
                offset_mm_s2 = offset_mm_s2.max(bend_mm.abs() / (SERVO_S * SERVO_S));
            }
        }
        if n > REST && n + 150 < commands.len() {
            let error_um = 1e3 * error_mm(points, &mut near, plant.position_mm());
            squares.push(error_um * error_um);
            largest_um = largest_um.max(error_um);
        }
    }
    let rms_um = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    Cut {
        error_um: [rms_um, largest_um],
        offset_mm_s2,
    }
}

#[test]
fn within_any_limit_no_cut_is_worse_and_the_offset_keeps_it() {
    let mut worse = 0;
    for (name, points, stops) in [
        ("circle", circle(), 1),
        ("star", star(), 1),
        ("square", square(), 4),
    ] {
        let commands = if stops > 1 {
            stopping(&points, stops)
        } else {
            commands(&points)
        };
        for gain in [1.0, 1.05] {
            let real = machine(gain);
            let off = cut(&real, &points, &commands, &LIMITS, false);
            for engaged_mm_s2 in ACCELERATIONS_MM_S2 {
                let limits = LinkLimits {
                    engaged_mm_s2,
                    ..LIMITS
                };
                let on = cut(&real, &points, &commands, &limits, true);
                println!(
                    "{name:8} gain {gain}, {engaged_mm_s2:6.0} mm/s2: {:7.2?} of {:7.2?} um, {:.0} mm/s2",
                    on.error_um, off.error_um, on.offset_mm_s2
                );
                assert!(
                    on.offset_mm_s2 <= engaged_mm_s2 + ROUNDING_MM_S2,
                    "{name} {gain}: {}",
                    on.offset_mm_s2
                );
                let is_worse = |i: usize| on.error_um[i] > off.error_um[i] + NO_WORSE_UM[i];
                assert!(
                    !is_worse(0),
                    "{name} {gain} {engaged_mm_s2}: {:?} of {:?}",
                    on.error_um,
                    off.error_um
                );
                worse += usize::from(is_worse(1));
            }
        }
    }
    // One exception: the circle with a gain that is 5 % off, at 8,000 mm/s2 where this machine
    // needs 40,000. Its largest error is 18.6 um, and 16.2 um without correction.
    assert!(worse <= 1, "the largest error of {worse} cuts is worse");
}
