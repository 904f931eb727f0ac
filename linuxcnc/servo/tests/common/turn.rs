//! A turn of a circle, with the link and the simulated machine in a closed loop.

use std::f64::consts::TAU;

use feedwright_control::{IdentifiedAxes, TrainedModel};
use feedwright_servo::limits::LinkLimits;
use feedwright_servo::machine::Refused;
use feedwright_servo::plant::SimulatedMachine;
use feedwright_servo::servo::{LinkFault, LinkInputs, LinkOutputs, Servo};

use crate::axis::{PERIODS, axis};
use crate::common::{SERVO_S, cutting};

/// Servo periods until the link has settled, and servo periods of a turn.
pub(crate) const SETTLE: usize = 400;
pub(crate) const TURN: usize = 1257;

/// Returns two axes with the numbers of the machine of Lee, Cho and Jeon (2005); the second has
/// more inertia and Coulomb friction.
pub(crate) fn machine() -> IdentifiedAxes<2> {
    let (axis, mut slower) = (axis(), axis());
    slower.inertia_kg_m2 = 0.012;
    slower.coulomb_friction_nm = 0.3;
    IdentifiedAxes {
        periods: PERIODS,
        axes: [axis, slower],
    }
}

/// Returns the command: rest, a turn of a circle of 10 mm at 50 mm/s with soft ends, rest.
pub(crate) fn command_mm(n: usize) -> [f64; 2] {
    let part = (n.saturating_sub(SETTLE) as f64 / (1.25 * TURN as f64)).min(1.0);
    // A fifth of the time to accelerate, and a fifth to brake.
    let ramp = 0.2;
    let gone = |t: f64| {
        if t < ramp {
            t * t / (2.0 * ramp)
        } else {
            t - 0.5 * ramp
        }
    };
    let whole = gone(1.0) - 0.5 * ramp;
    let way = if part > 1.0 - ramp {
        whole - (1.0 - part).powi(2) / (2.0 * ramp)
    } else {
        gone(part)
    };
    let angle = TAU * way / whole;
    [10.0 - 10.0 * angle.cos(), 10.0 * angle.sin()]
}

/// Inputs, outputs and tool position of a servo period.
pub(crate) struct Period {
    pub(crate) inputs: LinkInputs<2>,
    pub(crate) outputs: LinkOutputs<2>,
    pub(crate) tool_mm: [f64; 2],
}

/// Runs a turn with inputs that `change` may modify.
pub(crate) fn turn(
    model: Result<IdentifiedAxes<2>, Refused>,
    limits: &LinkLimits,
    change: impl FnMut(usize, &mut LinkInputs<2>),
) -> Vec<Period> {
    turn_on(&machine(), model, |_| *limits, change)
}

/// Runs a turn on a machine that may differ from the model, with settings that may change from one
/// servo period to the next.
pub(crate) fn turn_on(
    real: &IdentifiedAxes<2>,
    model: Result<IdentifiedAxes<2>, Refused>,
    limits: impl Fn(usize) -> LinkLimits,
    mut change: impl FnMut(usize, &mut LinkInputs<2>),
) -> Vec<Period> {
    let (mut plant, mut servo) = (
        SimulatedMachine::new(real, 1),
        Servo::new(model.map(TrainedModel::of_axes)),
    );
    assert!(matches!(
        servo.runs_at(SERVO_S),
        LinkFault::None | LinkFault::Model(_)
    ));
    let mut periods = Vec::new();
    for n in 0..SETTLE + 2 * TURN {
        let mut inputs = cutting(command_mm(n), plant.measured_mm());
        change(n, &mut inputs);
        let outputs = servo.step(&inputs, &limits(n));
        plant.step(outputs.drive_mm, inputs.powered, 1.0);
        periods.push(Period {
            inputs,
            outputs,
            tool_mm: plant.position_mm(),
        });
    }
    periods
}
