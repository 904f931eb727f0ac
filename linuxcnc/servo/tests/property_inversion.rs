//! The paper's controllers in the link: bounds of the feedrate and the geometry that they request,
//! whatever the identifier has learned.

#[path = "common/inputs.rs"]
mod common;

use feedwright_control::{ContourIdentifier, Identifier, Trained, TrainedModel};
use feedwright_servo::limits::LinkLimits;
use feedwright_servo::servo::{Link, LinkInputs, LinkOutputs, Servo};

use common::{LIMITS, SERVO_S, cutting};

const FEED_PERIOD_S: f64 = 0.01;
/// Servo periods of rest before and after a turn, and of the turn.
const REST: usize = 100;
const TURN: usize = 1257;
/// Rounding error across the path of a feedrate change, mm.
const ROUNDING_MM: f64 = 1e-12;
/// Permitted increase over the error of an uncorrected cut, um: RMS and largest.
const NO_WORSE_UM: [f64; 2] = [0.05, 1.0];
/// Slowest and fastest feedrate that a controller may request, as multiples of the present one.
const RATES: [f64; 2] = [0.5, 1.2];

/// Returns a generator of numbers within -size and size, from a seed.
fn sequence(seed: u64, size: f64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        size * ((state >> 33) as f64 / f64::from(1_u32 << 30) - 1.0)
    }
}

/// Returns a model whose identifier has random weights.
fn drawn(seed: u64, size: f64) -> TrainedModel<2> {
    let mut next = sequence(seed, size);
    let mut identifier = ContourIdentifier::<2>::NULL;
    identifier
        .hidden
        .as_flattened_mut()
        .as_flattened_mut()
        .iter_mut()
        .for_each(|weight| *weight = next());
    identifier
        .output
        .as_flattened_mut()
        .iter_mut()
        .for_each(|weight| *weight = next());
    model(identifier)
}

/// Returns the model of an identifier.
fn model(net: ContourIdentifier<2>) -> TrainedModel<2> {
    TrainedModel {
        servo_s: SERVO_S,
        feed_period_s: FEED_PERIOD_S,
        trained: Trained::Contour {
            net,
            response_s: 0.0,
        },
    }
}

/// Returns the command in a servo period: rest, a turn of a circle of 10 mm, rest.
fn command_mm(n: usize) -> [f64; 2] {
    let part = (n.saturating_sub(REST) as f64 / TURN as f64).min(1.0);
    let angle = std::f64::consts::TAU * part * part * (3.0 - 2.0 * part);
    [10.0 - 10.0 * angle.cos(), 10.0 * angle.sin()]
}

/// Runs a turn with the link; the axes follow with a time constant of 20 ms.
fn turn(
    model: TrainedModel<2>,
    limits: &LinkLimits,
    change: impl Fn(usize, &mut LinkInputs<2>),
) -> Vec<LinkOutputs<2>> {
    let (mut servo, mut actual_mm) = (Servo::new(Ok(model)), [0.0; 2]);
    servo.runs_at(SERVO_S);
    (0..TURN + 3 * REST)
        .map(|n| {
            let mut inputs = cutting(command_mm(n), actual_mm);
            change(n, &mut inputs);
            let outputs = servo.step(&inputs, limits);
            for (actual, drive) in actual_mm.iter_mut().zip(outputs.drive_mm) {
                *actual += SERVO_S / 0.02 * (drive - *actual);
            }
            outputs
        })
        .collect()
}

#[test]
fn whatever_was_learnt_feedrate_and_geometry_keep_their_bounds() {
    for seed in 0..20 {
        for size in [0.1, 1.0, 100.0] {
            let periods = turn(drawn(seed, size), &LIMITS, |_, _| {});
            for pair in periods.windows(2) {
                let outputs = &pair[1];
                assert!(
                    outputs.rate >= RATES[0] && outputs.rate <= RATES[1],
                    "{seed} {size}: rate {}",
                    outputs.rate
                );
                let [x, y] = outputs.correction_mm;
                assert!(
                    x.hypot(y) < 2.0 * LIMITS.deviation_mm,
                    "{seed} {size}: offset {x} {y}"
                );
                let step = (0..2)
                    .map(|i| (outputs.drive_mm[i] - pair[0].drive_mm[i]).abs())
                    .fold(0.0, f64::max);
                assert!(
                    step < 2.0 * LIMITS.speed_mm_s * SERVO_S,
                    "{seed} {size}: the drive's command leapt by {step}"
                );
            }
            assert_eq!(
                periods[periods.len() - 1].rate,
                1.0,
                "{seed} {size}: at rest"
            );
        }
    }
}

/// Returns RMS and largest contour error of the actual position, um.
fn error_um(periods: &[LinkOutputs<2>]) -> [f64; 2] {
    let errors_um = periods.iter().map(|period| 1e3 * period.contour_error_mm);
    let [squares, largest] = errors_um.fold([0.0_f64; 2], |[sum, most], um| {
        [sum + um * um, most.max(um)]
    });
    [(squares / periods.len() as f64).sqrt(), largest]
}

#[test]
fn whatever_was_learnt_the_cut_is_no_worse_than_without_correction() {
    let off_um = error_um(&turn(drawn(0, 0.0), &LIMITS, |_, inputs| {
        inputs.enabled = false;
    }));
    for seed in 0..20 {
        for size in [0.1, 1.0, 100.0] {
            let on_um = error_um(&turn(drawn(seed, size), &LIMITS, |_, _| {}));
            println!("{seed:2} {size:5} {on_um:6.2?} of {off_um:6.2?} um");
            for i in 0..2 {
                assert!(
                    on_um[i] <= off_um[i] + NO_WORSE_UM[i],
                    "{seed} {size}: {on_um:?} um, {off_um:?} without"
                );
            }
        }
    }
}

#[test]
fn the_feedrate_falls_where_the_identifier_predicts_an_error_that_grows_with_it() {
    let mut identifier = ContourIdentifier::<2>::NULL;
    for axis in 0..2 {
        // One hidden node per axis; the present feedrate is the first of its inputs.
        identifier.hidden[axis][0][axis] = 1.0;
        identifier.output[axis][axis] = 1.0;
    }
    // The identifier predicts more than the axes do: a wide limit keeps it in the loop.
    let periods = turn(
        model(identifier),
        &LinkLimits {
            speed_alone: true,
            deviation_mm: 5.0,
            ..LIMITS
        },
        |_, _| {},
    );
    let cut = &periods[REST + TURN / 4..REST + 3 * TURN / 4];
    let fastest = cut.iter().map(|period| period.rate).fold(0.0, f64::max);
    assert!(fastest < 1.0, "{fastest} of the feedrate was requested");
}

#[test]
fn the_delay_is_what_a_decision_looks_ahead() {
    let periods = turn(drawn(1, 0.0), &LIMITS, |_, _| {});
    let delayed: Vec<_> = periods
        .iter()
        .enumerate()
        .filter(|(_, period)| period.link == Link::Delayed)
        .collect();
    assert!(delayed.len() > TURN);
    for (n, period) in delayed {
        assert_eq!(period.delay_periods, 13);
        // All weights are zero, so nothing is moved.
        let off = (0..2)
            .map(|i| (period.drive_mm[i] - command_mm(n - 13)[i]).abs())
            .fold(0.0, f64::max);
        assert!(off < ROUNDING_MM, "{n}: {off}");
    }
}

#[test]
fn with_the_speed_alone_the_geometry_stays_on_the_path() {
    let limits = LinkLimits {
        speed_alone: true,
        ..LIMITS
    };
    let periods = turn(drawn(3, 1.0), &limits, |_, _| {});
    assert!(
        periods
            .iter()
            .all(|period| period.correction_mm.iter().all(|mm| mm.abs() < ROUNDING_MM))
    );
    assert!(
        periods
            .iter()
            .any(|period| (period.rate - 1.0).abs() > 1e-4),
        "no feedrate was asked for"
    );
}

#[test]
fn disabled_or_without_delay_the_feedrate_is_the_controls_own() {
    let disabled = turn(drawn(3, 1.0), &LIMITS, |_, inputs| inputs.enabled = false);
    let direct = turn(drawn(3, 1.0), &LIMITS, |_, inputs| inputs.direct = true);
    let off = turn(drawn(3, 1.0), &LIMITS, |_, inputs| inputs.powered = false);
    for period in disabled.iter().chain(&direct).chain(&off) {
        assert_eq!((period.rate, period.correction_mm), (1.0, [0.0; 2]));
    }
}

#[test]
fn what_is_not_a_number_goes_no_further() {
    for spoilt in [f64::NAN, f64::INFINITY] {
        for which in 0..2 {
            let periods = turn(drawn(5, 1.0), &LIMITS, |n, inputs| {
                if (500..520).contains(&n) {
                    let into = if which == 0 {
                        &mut inputs.command_mm
                    } else {
                        &mut inputs.actual_mm
                    };
                    into[n % 2] = spoilt;
                }
            });
            for LinkOutputs {
                drive_mm,
                feedback_mm,
                correction_mm,
                contour_error_mm,
                without_mm,
                rate,
                ..
            } in periods
            {
                let all = drive_mm.into_iter().chain(feedback_mm).chain(correction_mm);
                assert!(
                    all.chain([contour_error_mm, without_mm, rate])
                        .all(f64::is_finite),
                    "{spoilt} {which}"
                );
            }
        }
    }
}
