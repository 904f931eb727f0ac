//! The link in a closed loop with the simulated machine: its effect on the contour error, and
//! effects that it must never have.

#[path = "common/axis.rs"]
mod axis;
#[path = "common/inputs.rs"]
mod common;
#[path = "common/turn.rs"]
mod turning;

use feedwright_control::{BlockError, Cause, TrainedModel};
use feedwright_servo::following::{JointLimits, least_min_ferror_mm};
use feedwright_servo::limits::LinkLimits;
use feedwright_servo::machine::Refused;
use feedwright_servo::plant::SimulatedMachine;
use feedwright_servo::servo::{Link, LinkFault, LinkInputs, LinkOutputs, Servo};

use common::{LIMITS, SERVO_S, cutting};
use turning::{Period, SETTLE, TURN, command_mm, machine, turn, turn_on};

/// Part of the uncorrected contour error that may remain, the same as in a sweep in a real control.
const LEFT: f64 = 0.05;

/// Returns the RMS distance of the tool from the circle during the turn, mm.
fn rms_mm(periods: &[Period]) -> f64 {
    let cut = &periods[SETTLE + 100..SETTLE + TURN];
    let off =
        |period: &Period| ((period.tool_mm[0] - 10.0).hypot(period.tool_mm[1]) - 10.0).powi(2);
    (cut.iter().map(off).sum::<f64>() / cut.len() as f64).sqrt()
}

/// Permitted increase of the contour error, mm RMS: a drive that is 3 ms late costs 0.4 um until
/// the correction is out of the loop.
const NO_WORSE_MM: f64 = 5e-4;

#[test]
fn the_correction_takes_the_contour_error_away() {
    let without = rms_mm(&turn(Ok(machine()), &LIMITS, |_, inputs| {
        inputs.enabled = false;
    }));
    assert!(without > 0.01, "{without}");
    for delay_s in [0.008, 0.010, 0.015] {
        let periods = turn(Ok(machine()), &LinkLimits { delay_s, ..LIMITS }, |_, _| {});
        assert!(
            rms_mm(&periods) < LEFT * without,
            "{delay_s}: {} {without}",
            rms_mm(&periods)
        );
        assert!(
            periods
                .iter()
                .all(|period| period.outputs.fault == LinkFault::None),
            "{delay_s}"
        );
    }
}

#[test]
fn by_a_model_that_is_wrong_nothing_is_worse_and_it_is_reported() {
    for late_s in [0.001, 0.002, 0.003, 0.005] {
        let mut real = machine();
        real.axes
            .iter_mut()
            .for_each(|axis| axis.drive_delay_s += late_s);
        let without = rms_mm(&turn_on(
            &real,
            Ok(machine()),
            |_| LIMITS,
            |_, inputs| inputs.enabled = false,
        ));
        let periods = turn_on(&real, Ok(machine()), |_| LIMITS, |_, _| {});
        println!("{late_s}: {} {without}", rms_mm(&periods));
        let reported =
            |outputs: &LinkOutputs<2>| outputs.learned != [false; 2] || outputs.left.is_some();
        assert!(
            periods.iter().any(|period| reported(&period.outputs)),
            "{late_s}: nothing was reported"
        );
        assert!(
            rms_mm(&periods) <= without + NO_WORSE_MM,
            "{late_s}: {} {without}",
            rms_mm(&periods)
        );
    }
}

#[test]
fn the_following_error_of_the_control_is_the_error_of_the_drive() {
    for period in turn(Ok(machine()), &LIMITS, |_, inputs| inputs.enabled = false) {
        let (inputs, outputs) = (&period.inputs, &period.outputs);
        for i in 0..2 {
            let theirs_mm = inputs.command_mm[i] - outputs.feedback_mm[i];
            let drives_mm = outputs.drive_mm[i] - inputs.actual_mm[i];
            assert!(
                (theirs_mm - drives_mm).abs() < 1e-9,
                "{theirs_mm} {drives_mm}"
            );
        }
    }
}

#[test]
fn without_power_the_drive_and_the_control_have_the_actual_position() {
    let periods = turn(Ok(machine()), &LIMITS, |n, inputs| {
        inputs.powered = !(1000..1200).contains(&n);
    });
    for period in &periods[1000..1200] {
        assert_eq!(period.outputs.link, Link::Off);
        assert_eq!(period.outputs.drive_mm, period.inputs.actual_mm);
        assert_eq!(period.outputs.feedback_mm, period.inputs.actual_mm);
    }
}

#[test]
fn the_delay_comes_and_goes_at_rest_alone_and_nothing_leaps() {
    // `direct` changes every 70 ms, through rest and motion.
    let periods = turn(Ok(machine()), &LIMITS, |n, inputs| {
        inputs.direct = n / 70 % 2 == 0;
    });
    let step = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    for pair in periods.windows(2) {
        assert!(step(pair[0].outputs.drive_mm, pair[1].outputs.drive_mm) < 0.2);
        if pair[0].outputs.link != pair[1].outputs.link {
            assert!(step(pair[0].inputs.command_mm, pair[1].inputs.command_mm) < 0.06);
        }
    }
    assert!(
        periods
            .iter()
            .any(|period| period.outputs.link == Link::Delayed)
    );
}

/// Servo periods from the start of a turn to the start of the next, with some rest after it.
const AGAIN: usize = 1_600;

#[test]
fn what_is_not_a_number_goes_no_further() {
    // After the last loss, there is time to engage twice: a correction that has just engaged may do
    // harm once.
    for from in [0, 500, 700] {
        let spoilt = [f64::NAN, f64::INFINITY];
        for which in 0..4 {
            let periods = turn(Ok(machine()), &LIMITS, |n, inputs| {
                // The correction engages again only in motion, so the turn begins again.
                if n >= SETTLE + AGAIN {
                    inputs.command_mm = command_mm(n - AGAIN);
                }
                if (from..from + 30).contains(&n) {
                    let into = if which < 2 {
                        &mut inputs.command_mm
                    } else {
                        &mut inputs.actual_mm
                    };
                    into[n % 2] = spoilt[which % 2];
                }
            });
            for period in &periods {
                let LinkOutputs {
                    drive_mm,
                    feedback_mm,
                    correction_mm,
                    contour_error_mm,
                    without_mm,
                    ..
                } = period.outputs;
                let all = drive_mm.iter().chain(&feedback_mm).chain(&correction_mm);
                assert!(
                    all.chain([&contour_error_mm, &without_mm])
                        .all(|mm| mm.is_finite()),
                    "{from} {which}"
                );
            }
            assert!(
                from == 0
                    || periods
                        .iter()
                        .any(|period| period.outputs.fault != LinkFault::None),
                "{from} {which}"
            );
            assert_eq!(
                periods[periods.len() - 1].outputs.fault,
                LinkFault::None,
                "{from} {which}: it has come back"
            );
        }
    }
}

#[test]
fn without_a_model_commands_are_passed_on_to_the_bit() {
    let refused = Refused::Block(BlockError::Checksum);
    for period in turn(Err(refused), &LIMITS, |_, _| {}) {
        assert_eq!(period.outputs.drive_mm, period.inputs.command_mm);
        assert_eq!(period.outputs.feedback_mm, period.inputs.actual_mm);
        assert_eq!(period.outputs.fault, LinkFault::Model(refused));
    }
    assert_eq!(
        Servo::new(Ok(TrainedModel::of_axes(machine()))).runs_at(0.002),
        LinkFault::Model(Refused::Period)
    );
}

#[test]
fn enabling_and_disabling_in_motion_fades() {
    let periods = turn(Ok(machine()), &LIMITS, |n, inputs| {
        inputs.enabled = (SETTLE + 200..SETTLE + 800).contains(&n);
    });
    let correction = |n: usize| periods[n].outputs.correction_mm;
    assert_eq!(correction(SETTLE + 190), [0.0; 2]);
    assert_eq!(correction(SETTLE + 1150), [0.0; 2]);
    assert!(correction(SETTLE + 700)[0].hypot(correction(SETTLE + 700)[1]) > 0.01);
    for n in SETTLE..SETTLE + TURN {
        let step_mm = (0..2)
            .map(|i| (correction(n)[i] - correction(n - 1)[i]).abs())
            .fold(0.0, f64::max);
        assert!(step_mm < 0.02, "{n}: {step_mm}");
    }
}

#[test]
fn the_simulated_axis_lags_as_its_loops_say() {
    // At constant speed the position error is v (1 + B / Kv) / kp, plus the part due to Coulomb
    // friction, Fc / (Kv kp) at the motor.
    let mut plant = SimulatedMachine::new(&machine(), 1);
    let v = 50.0;
    for n in 0..1000_u32 {
        plant.step([v * SERVO_S * f64::from(n), 0.0], true, 1.0);
    }
    let axis = machine().axes[0];
    let friction_mm_s = axis.coulomb_friction_nm / axis.kv_nm_s_per_rad / axis.rad_per_mm;
    let error_mm = (v * (1.0 + axis.viscous_friction_nm_s / axis.kv_nm_s_per_rad) + friction_mm_s)
        / axis.kp_1_s;
    // The delays are inside the loop, so the loop measures the same error.
    let measured_mm = v * SERVO_S * 1000.0 - plant.measured_mm()[0];
    assert!(
        (measured_mm - error_mm).abs() < 1e-9,
        "{measured_mm} {error_mm}"
    );
}

#[test]
fn behind_a_short_loss_of_the_position_drives_with_an_integral_part_are_known_again() {
    let mut machine = machine();
    machine
        .axes
        .iter_mut()
        .for_each(|axis| axis.speed_integral_s = 0.02);
    for from in [700, 900, 1100] {
        let lost = from..from + 4;
        let periods = turn_on(
            &machine,
            Ok(machine),
            |_| LIMITS,
            |n, inputs| {
                if lost.contains(&n) {
                    inputs.actual_mm[1] = f64::NAN;
                }
            },
        );
        let reported = |n: usize| periods[n].outputs.fault;
        assert_eq!(
            reported(from + 100),
            LinkFault::Faded(Cause::LostFeedback),
            "{from}"
        );
        assert_eq!(reported(from + 500), LinkFault::None, "{from}");
    }
}

#[test]
fn the_least_min_ferror_is_what_the_control_sees_of_the_link() {
    // From rest to 200 mm/s, 0.2 s at that speed, and back to rest, at 2,000 mm/s2.
    let joint = JointLimits {
        speed_mm_s: 200.0,
        acceleration_mm_s2: 2000.0,
        ferror_mm: 10.0,
    };
    let speed_mm_s = |n: usize| {
        let n = n.saturating_sub(SETTLE) as f64;
        (2.0 * n).min(2.0 * (400.0 - n)).clamp(0.0, 200.0)
    };
    for delay_s in [0.008, 0.015] {
        let limits = LinkLimits { delay_s, ..LIMITS };
        let (mut at_mm, mut seen_mm) = (0.0, 0.0_f64);
        let (mut plant, mut servo) = (
            SimulatedMachine::new(&machine(), 1),
            Servo::new(Ok(TrainedModel::of_axes(machine()))),
        );
        servo.runs_at(SERVO_S);
        for n in 0..SETTLE + 600 {
            at_mm += 0.5 * SERVO_S * (speed_mm_s(n) + speed_mm_s(n + 1));
            let inputs = LinkInputs {
                enabled: false,
                ..cutting([at_mm, 0.0], plant.measured_mm())
            };
            let outputs = servo.step(&inputs, &limits);
            plant.step(outputs.drive_mm, true, 1.0);
            let error_mm = (at_mm - outputs.feedback_mm[0]).abs();
            if error_mm > joint.ferror_mm * speed_mm_s(n + 1) / joint.speed_mm_s {
                seen_mm = seen_mm.max(error_mm);
            }
        }
        let [least_mm, other_mm] =
            least_min_ferror_mm(&machine(), [joint, JointLimits::NONE], delay_s);
        println!("{delay_s}: {least_mm} {seen_mm}");
        assert!(
            (least_mm - seen_mm).abs() < 0.02 * seen_mm,
            "{delay_s}: {least_mm} {seen_mm}"
        );
        assert_eq!(other_mm, 0.0);
    }
}
