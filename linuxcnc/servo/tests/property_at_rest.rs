//! Evidence for the correction counts only while the commanded path moves, and a cause that comes
//! back latches. The tests run on `tnv40`, with the model of `workshop`, whose drives have
//! feedforward, friction and an integral part that `tnv40` does not have.

#[path = "common/axis.rs"]
mod axis;
#[path = "common/inputs.rs"]
mod common;
#[path = "common/paths.rs"]
#[expect(dead_code, reason = "other tests need the rest")]
mod paths;

use std::f64::consts::TAU;

use feedwright_control::{IdentifiedAxes, Parameters, Part, State, TrainedModel};
use feedwright_servo::plant::SimulatedMachine;
use feedwright_servo::servo::{Link, LinkFault, LinkInputs, LinkOutputs, Servo};

use axis::axis;
use common::{LIMITS, SERVO_S, cutting};
use paths::{ACCELERATION_MM_S2, FEED_MM_S, way_mm};

/// Servo periods of a rest, and servo periods of rest until the tool has settled: the delay, and
/// nine time constants of the position loop.
const REST: usize = 2000;
const SETTLED: usize = 200;
/// Largest distance of a tool at rest from the command, um. Without correction it is 0.7 um.
const AT_REST_UM: f64 = 2.0;
/// Servo periods of a test; the one in which the machine changes; and the one, at rest, in which
/// the machine is restored and the operator resets the correction.
const PERIODS: usize = 14_000;
const CHANGES: usize = 3_000;
const RESET: usize = 8_000;
const RAD_PER_MM: f64 = TAU / 10.0;

/// X and Y of `tnv40`.
fn tnv40() -> IdentifiedAxes<2> {
    let inertia_and_friction = [[0.0103, 0.0336, 0.2], [0.012, 0.0308, 0.3]];
    let axes = inertia_and_friction.map(
        |[inertia_kg_m2, viscous_friction_nm_s, coulomb_friction_nm]| {
            let mut axis = axis().without(&[Part::Delays]);
            axis.inertia_kg_m2 = inertia_kg_m2;
            axis.viscous_friction_nm_s = viscous_friction_nm_s;
            axis.coulomb_friction_nm = coulomb_friction_nm;
            axis.disturbance_nm = 0.1;
            axis.disturbance_rad_s = 25.0 * TAU;
            axis
        },
    );
    IdentifiedAxes {
        periods: axis::PERIODS,
        axes,
    }
}

/// X and Y of `workshop`.
fn workshop() -> IdentifiedAxes<2> {
    let mut machine = tnv40();
    let of_axis = [(0.02, 0.02, 0.06), (0.024, -0.03, 0.09)];
    for (axis, (speed_integral_s, coulomb_asymmetry_nm, stribeck_nm)) in
        machine.axes.iter_mut().zip(of_axis)
    {
        *axis = Parameters {
            speed_integral_s,
            velocity_feedforward: 0.95,
            torque_filter_hz: 1000.0,
            drive_delay_s: 0.001,
            coulomb_asymmetry_nm,
            stribeck_nm,
            stribeck_rad_s: 2.0 * RAD_PER_MM,
            presliding_rad: 0.01 * RAD_PER_MM,
            encoder_noise_rad: 5e-5 * RAD_PER_MM,
            encoder_step_rad: 1e-4 * RAD_PER_MM,
            interpolation_rad: 2e-4 * RAD_PER_MM,
            signal_per_rad: 512.0,
            torque_noise_nm: 0.1,
            torque_noise_s: 0.005,
            disturbance_wander: 0.02,
            cogging_nm: 0.05,
            cogging_per_rev: 24.0,
            ..*axis
        };
    }
    machine
}

/// Returns commands: rests, and between them turns of a circle of 10 mm or the sides of a square of
/// 20 mm.
fn commands(square: bool) -> impl Fn(usize) -> [f64; 2] {
    let length_mm = if square { 20.0 } else { TAU * 10.0 };
    let periods = ((length_mm / FEED_MM_S + FEED_MM_S / ACCELERATION_MM_S2) / SERVO_S) as usize + 1;
    move |n| {
        let way_mm = way_mm(
            (n % (REST + periods)).saturating_sub(REST) as f64 * SERVO_S,
            length_mm,
        );
        if square {
            match n / (REST + periods) % 4 {
                0 => [way_mm, 0.0],
                1 => [length_mm, way_mm],
                2 => [length_mm - way_mm, length_mm],
                _ => [0.0, length_mm - way_mm],
            }
        } else {
            let angle = way_mm / 10.0;
            [10.0 - 10.0 * angle.cos(), 10.0 * angle.sin()]
        }
    }
}

/// Outputs and position of a servo period.
struct Period {
    outputs: LinkOutputs<2>,
    /// Servo periods for which the command has rested, and distance of the tool from the command,
    /// um.
    rested: usize,
    off_um: f64,
}

/// Runs programs on `tnv40`, with a model and inputs that may change.
fn cut(
    model: IdentifiedAxes<2>,
    inertia: impl Fn(usize) -> f64,
    command_mm: impl Fn(usize) -> [f64; 2],
    change: impl Fn(usize, &mut LinkInputs<2>),
) -> Vec<Period> {
    let (mut plant, mut servo) = (
        SimulatedMachine::new(&tnv40(), 1),
        Servo::new(Ok(TrainedModel::of_axes(model))),
    );
    servo.runs_at(SERVO_S);
    let (mut rested, mut last_mm) = (0, command_mm(0));
    (0..PERIODS)
        .map(|n| {
            let command_mm = command_mm(n);
            rested = if command_mm == last_mm { rested + 1 } else { 0 };
            last_mm = command_mm;
            let mut inputs = cutting(command_mm, plant.measured_mm());
            change(n, &mut inputs);
            let outputs = servo.step(&inputs, &LIMITS);
            plant.step(outputs.drive_mm, inputs.powered, inertia(n));
            let tool_mm = plant.position_mm();
            Period {
                outputs,
                rested,
                off_um: 1e3 * (tool_mm[0] - command_mm[0]).hypot(tool_mm[1] - command_mm[1]),
            }
        })
        .collect()
}

/// Counts how often the correction engaged.
fn times_in(periods: &[Period]) -> usize {
    let engaged = |period: &Period| {
        period.outputs.link == Link::Delayed && period.outputs.state == State::Engaged
    };
    periods
        .windows(2)
        .filter(|pair| !engaged(&pair[0]) && engaged(&pair[1]))
        .count()
}

fn largest_at_rest_um(periods: &[Period]) -> f64 {
    periods
        .iter()
        .filter(|period| period.rested > SETTLED)
        .map(|period| period.off_um)
        .fold(0.0, f64::max)
}

#[test]
fn by_the_model_of_another_machine_the_axes_stand_where_the_command_does() {
    for square in [false, true] {
        let periods = cut(workshop(), |_| 1.0, commands(square), |_, _| {});
        let (most_um, times) = (largest_at_rest_um(&periods), times_in(&periods));
        println!(
            "square: {square}; at rest {most_um:.2} um off the command; {times} times in the loop"
        );
        assert!(
            most_um < AT_REST_UM,
            "square: {square}; {most_um:.2} um, {times} times in the loop"
        );
    }
}

/// Cuts the sides of a square with the right model, on a machine that is three times as heavy from
/// [`CHANGES`] until [`RESET`].
fn heavy_for_a_while(change: impl Fn(usize, &mut LinkInputs<2>)) -> Vec<Period> {
    cut(
        tnv40(),
        |n| {
            if (CHANGES..RESET).contains(&n) {
                3.0
            } else {
                1.0
            }
        },
        commands(true),
        change,
    )
}

#[test]
fn a_cause_that_comes_back_keeps_the_correction_out() {
    let periods = heavy_for_a_while(|_, _| {});
    let first = periods
        .iter()
        .position(|period| period.outputs.latched)
        .expect("a cause that comes back latches");
    let left = periods[first]
        .outputs
        .left
        .expect("the supervisor took it out");
    println!("latched in servo period {first} by {left:?}");
    assert!(first < RESET && left.count > 1, "{first} {left:?}");
    for (n, period) in periods.iter().enumerate().skip(first) {
        let LinkOutputs {
            state,
            fault,
            latched,
            ..
        } = period.outputs;
        let is_out = latched && state != State::Engaged && fault == LinkFault::Faded(left.cause);
        assert!(is_out, "{n}: {latched} {state:?} {fault:?}");
    }
}

#[test]
fn a_correction_that_is_switched_off_and_on_or_was_without_power_comes_back() {
    let resets: [fn(&mut LinkInputs<2>); 2] = [
        |inputs| inputs.enabled = false,
        |inputs| inputs.powered = false,
    ];
    for reset in resets {
        let periods = heavy_for_a_while(|n, inputs| {
            if n == RESET {
                reset(inputs);
            }
        });
        assert!(
            periods[RESET - 1].outputs.latched
                && periods[RESET..]
                    .iter()
                    .all(|period| !period.outputs.latched)
        );
        assert!(times_in(&periods[RESET..]) > 0);
        let LinkOutputs { state, fault, .. } = periods[PERIODS - 1].outputs;
        assert_eq!((state, fault), (State::Engaged, LinkFault::None));
    }
}

#[test]
fn a_delay_that_is_given_up_and_taken_up_again_resets_nothing() {
    let periods = heavy_for_a_while(|n, inputs| inputs.direct = (RESET..RESET + 500).contains(&n));
    let behind = &periods[RESET..];
    assert!(
        behind
            .iter()
            .any(|period| period.outputs.link == Link::Direct)
    );
    assert!(
        behind
            .iter()
            .all(|period| period.outputs.latched && period.outputs.fault != LinkFault::None)
    );
    assert_eq!(times_in(behind), 0);
}

#[test]
fn a_position_that_is_lost_again_and_again_latches_nothing() {
    let periods = cut(
        tnv40(),
        |_| 1.0,
        commands(false),
        |n, inputs| {
            if n > REST + 100 && n % 700 < 5 {
                inputs.actual_mm = [f64::NAN; 2];
            }
        },
    );
    let times = periods[PERIODS - 1]
        .outputs
        .left
        .map_or(0, |left| left.count);
    assert!(
        times > 3 && periods.iter().all(|period| !period.outputs.latched),
        "{times} times out"
    );
}
