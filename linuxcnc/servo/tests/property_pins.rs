//! Settings that change while the machine cuts: an invalid number has no effect, and a lower
//! deviation takes effect during the cut.

#[path = "common/axis.rs"]
mod axis;
#[path = "common/inputs.rs"]
mod common;
#[path = "common/turn.rs"]
mod turning;

use feedwright_servo::limits::{LinkLimits, Setting};
use feedwright_servo::servo::LinkFault;

use common::{LIMITS, SERVO_S};
use turning::{Period, SETTLE, TURN, machine, turn, turn_on};

/// Servo period in which a setting changes: 300 servo periods into the cut of a turn.
const CHANGED: usize = SETTLE + 300;
/// Time in which a lower deviation is reached, s.
const REACHED_S: f64 = 0.2;
/// Permitted distance beyond the set deviation, mm: the drive's path of points is a polygon.
const ROUND_MM: f64 = 1e-4;

/// Name, rejected setting, and function that sets a bad number.
type Spoilt = (&'static str, Setting, fn(&mut LinkLimits, f64));

const SPOILT: [Spoilt; 6] = [
    ("delay", Setting::Delay, |limits, x| limits.delay_s = x),
    ("deviation", Setting::Deviation, |limits, x| {
        limits.deviation_mm = x;
    }),
    ("speed", Setting::Speed, |limits, x| limits.speed_mm_s = x),
    (
        "acceleration",
        Setting::CorrectionAcceleration,
        |limits, x| limits.correction_mm_s2 = x,
    ),
    (
        "acceleration in the loop",
        Setting::Acceleration,
        |limits, x| limits.engaged_mm_s2 = x,
    ),
    ("scale", Setting::AdaptiveScale, |limits, x| {
        limits.adaptive_scale = x;
    }),
];

#[test]
fn what_is_not_a_number_changes_nothing_and_is_reported() {
    let good = turn(Ok(machine()), &LIMITS, |_, _| {});
    for (name, setting, spoil) in SPOILT {
        for value in [
            -1.0,
            -400.0,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            1e300,
        ] {
            for from in [0, CHANGED] {
                let spoilt = from..CHANGED + 200;
                let limits = |n: usize| {
                    let mut limits = LIMITS;
                    if spoilt.contains(&n) {
                        spoil(&mut limits, value);
                    }
                    limits
                };
                let periods = turn_on(&machine(), Ok(machine()), limits, |_, _| {});
                for (n, (period, good)) in periods.iter().zip(&good).enumerate() {
                    let outputs = &period.outputs;
                    let [came_to, good] =
                        [period, good].map(|of| (of.inputs, of.outputs.drive_mm, of.tool_mm));
                    assert_eq!(came_to, good, "{name} {value}, from {from}: {n}");
                    assert_eq!(
                        outputs.adaptive_feed, 1.0,
                        "{name} {value}, from {from}: {n}"
                    );
                    let reported = if spoilt.contains(&n) {
                        LinkFault::Setting(setting)
                    } else {
                        LinkFault::None
                    };
                    assert_eq!(outputs.fault, reported, "{name} {value}, from {from}: {n}");
                }
            }
        }
    }
}

/// Largest step of the drive's command in a servo period, mm, with a correction within the widest
/// limits of this test.
const STEP_MM: f64 = 0.2;

#[test]
fn whatever_is_set_in_the_cut_the_drive_gets_numbers_that_do_not_leap() {
    const DELAYS_S: [f64; 4] = [0.008, 0.015, f64::NAN, 0.0];
    const DEVIATIONS_MM: [f64; 6] = [0.0, 0.001, 0.5, 10.0, -1.0, f64::INFINITY];
    const SPEEDS_MM_S: [f64; 6] = [1.0, 60.0, 400.0, 1e4, -400.0, f64::NAN];
    const ACCELERATIONS_MM_S2: [f64; 6] = [0.0, 1.0, 400.0, 1e6, -1.0, f64::NAN];
    for seed in 0..24_usize {
        // Another combination every 37 servo periods.
        let limits = |n: usize| {
            let k = n / 37 * 7 + seed * 31;
            LinkLimits {
                delay_s: DELAYS_S[k % 4],
                deviation_mm: DEVIATIONS_MM[k / 4 % 6],
                speed_mm_s: SPEEDS_MM_S[k / 3 % 6],
                correction_mm_s2: ACCELERATIONS_MM_S2[k / 5 % 6],
                engaged_mm_s2: ACCELERATIONS_MM_S2[k / 2 % 6],
                ..LIMITS
            }
        };
        let periods = turn_on(&machine(), Ok(machine()), limits, |_, _| {});
        let finite = |period: &Period| period.outputs.drive_mm.iter().all(|mm| mm.is_finite());
        assert!(periods.iter().all(finite), "{seed}");
        for (n, pair) in periods.windows(2).enumerate() {
            let [a, b] = [pair[0].outputs.drive_mm, pair[1].outputs.drive_mm];
            let step_mm = (b[0] - a[0]).hypot(b[1] - a[1]);
            assert!(step_mm < STEP_MM, "{seed}, {n}: {step_mm} {:?}", limits(n));
        }
    }
}

/// Returns the distance of the drive's command from the circle, mm.
fn off_mm(period: &Period) -> f64 {
    let [x, y] = period.outputs.drive_mm;
    ((x - 10.0).hypot(y) - 10.0).abs()
}

/// Returns the largest change of the speed of the drive's command from one servo period to the
/// next, mm/s.
fn jolt_mm_s(periods: &[Period]) -> f64 {
    let second = |three: &[Period], i: usize| {
        let at = |k: usize| three[k].outputs.drive_mm[i];
        (at(2) - 2.0 * at(1) + at(0)) / SERVO_S
    };
    periods
        .windows(3)
        .map(|three| second(three, 0).hypot(second(three, 1)))
        .fold(0.0, f64::max)
}

#[test]
fn a_lower_deviation_takes_effect_in_the_cut_and_nothing_leaps() {
    let free = turn(Ok(machine()), &LIMITS, |_, _| {});
    let cut = CHANGED..SETTLE + TURN;
    let wanted_mm = free[cut.clone()].iter().map(off_mm).fold(0.0, f64::max);
    for deviation_mm in [0.008, 0.004, 0.0] {
        assert!(
            wanted_mm > 2.0 * deviation_mm,
            "the limit does not bind: {wanted_mm}"
        );
        let limits = |n: usize| {
            if n < CHANGED {
                LIMITS
            } else {
                LinkLimits {
                    deviation_mm,
                    ..LIMITS
                }
            }
        };
        let periods = turn_on(&machine(), Ok(machine()), limits, |_, _| {});
        let reached = CHANGED + (REACHED_S / SERVO_S) as usize;
        let off_mm = periods[reached..cut.end]
            .iter()
            .map(off_mm)
            .fold(0.0, f64::max);
        assert!(
            off_mm <= deviation_mm + ROUND_MM,
            "{deviation_mm}: {off_mm}"
        );
        let [with, without] =
            [&periods, &free].map(|periods| jolt_mm_s(&periods[CHANGED - 10..reached]));
        assert!(
            periods
                .iter()
                .all(|period| period.outputs.fault == LinkFault::None),
            "{deviation_mm}"
        );
        println!(
            "{deviation_mm}: {off_mm} of {wanted_mm}, speed changes by {with} of {without} mm/s"
        );
        assert!(
            with <= without + 2.0 * LIMITS.correction_mm_s2 * SERVO_S,
            "{deviation_mm}: {with} {without}"
        );
    }
}
