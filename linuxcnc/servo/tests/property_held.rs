//! Motion that must not be delayed, behind motion that is: probing, following a spindle, and the
//! delay of a link that failed.

#[path = "common/axis.rs"]
mod axis;
#[path = "common/inputs.rs"]
mod common;
#[path = "common/turn.rs"]
mod turning;

use feedwright_control::TrainedModel;
use feedwright_servo::plant::SimulatedMachine;
use feedwright_servo::play_out::PlayOut;
use feedwright_servo::servo::{Link, LinkFault, LinkInputs, LinkOutputs, Servo};

use common::{LIMITS, SERVO_S, cutting};
use turning::{Period, SETTLE, TURN, command_mm, machine, turn, turn_on};

/// Acceleration of the control, mm/s2.
const ACCELERATION_MM_S2: f64 = 2000.0;
/// Servo periods within which a hold must end: braking, the delay, and a margin.
const HELD: usize = 25;
/// The same after a probing motion, which takes 0.1 s of rest.
const HELD_AFTER: usize = 110;
/// Distance that the command may move while it is held, mm: two servo periods of acceleration, and
/// braking from there.
const CREPT_MM: f64 = 0.012;

/// Largest step of the drive's command in a servo period, mm: the correction as it takes up 50
/// mm/s. To give up a delay at that speed would be a step of 0.5 mm.
const STEP_MM: f64 = 0.15;

/// A control that moves one axis block by block, with rests of two servo periods. With `heeds`, it
/// holds its feed on request.
struct Control {
    heeds: bool,
    position_mm: f64,
    speed_mm_s: f64,
}

impl Control {
    /// Moves for one servo period toward `end_mm`, and rests there. Returns the position, mm.
    fn step(&mut self, end_mm: f64, feed_mm_s: f64, holds: bool) -> f64 {
        let left_mm = end_mm - self.position_mm;
        let brakes_mm_s =
            (2.0 * ACCELERATION_MM_S2 * left_mm.abs()).sqrt() - ACCELERATION_MM_S2 * SERVO_S;
        let wanted_mm_s = if holds && self.heeds {
            0.0
        } else {
            feed_mm_s.min(brakes_mm_s.max(0.1))
        };
        let change_mm_s = ACCELERATION_MM_S2 * SERVO_S;
        self.speed_mm_s += (wanted_mm_s - self.speed_mm_s).clamp(-change_mm_s, change_mm_s);
        self.position_mm += left_mm.signum() * (self.speed_mm_s * SERVO_S).min(left_mm.abs());
        if self.position_mm == end_mm {
            self.speed_mm_s = 0.0;
        }
        self.position_mm
    }
}

/// Runs a cut of 5 mm, two servo periods of rest, a probing motion of 2 mm, two servo periods of
/// rest, and another cut. Returns every servo period with the number of its block.
fn probing(heeds: bool, changed: impl Fn(usize, &mut LinkInputs<2>)) -> Vec<(usize, Period)> {
    let (mut plant, mut servo) = (
        SimulatedMachine::new(&machine(), 1),
        Servo::new(Ok(TrainedModel::of_axes(machine()))),
    );
    servo.runs_at(SERVO_S);
    let mut control = Control {
        heeds,
        position_mm: 0.0,
        speed_mm_s: 0.0,
    };
    let (mut periods, mut holds) = (Vec::new(), false);
    for (block, end_mm, feed_mm_s, rests) in [
        (0, 0.0, 0.0, SETTLE),
        (1, 5.0, 50.0, 2),
        (2, 7.0, 25.0, 2),
        (3, 12.0, 50.0, 200),
    ] {
        let mut rested = 0;
        while rested < rests {
            let x = control.step(end_mm, feed_mm_s, holds);
            rested += usize::from(x == end_mm);
            let mut inputs = LinkInputs {
                probing: block == 2,
                ..cutting([x, 0.0], plant.measured_mm())
            };
            changed(block, &mut inputs);
            let outputs = servo.step(&inputs, &LIMITS);
            holds = outputs.holds_feed;
            plant.step(outputs.drive_mm, true, 1.0);
            periods.push((
                block,
                Period {
                    inputs,
                    outputs,
                    tool_mm: plant.position_mm(),
                },
            ));
        }
    }
    periods
}

fn of(periods: &[(usize, Period)], wanted: usize) -> Vec<&Period> {
    periods
        .iter()
        .filter(|(block, _)| *block == wanted)
        .map(|(_, period)| period)
        .collect()
}

#[test]
fn a_probing_motion_is_held_until_it_is_without_delay_and_the_cut_behind_it_until_it_has_one() {
    let periods = probing(true, |_, _| {});
    let probe = of(&periods, 2);
    let begins = probe
        .iter()
        .position(|period| period.outputs.link == Link::Direct)
        .expect("it is held");
    assert!(begins <= HELD, "{begins}");
    assert!(
        probe[begins].inputs.command_mm[0] - 5.0 <= CREPT_MM,
        "{:?}",
        probe[begins].inputs.command_mm
    );
    let settled = probe
        .iter()
        .filter(|period| period.inputs.command_mm[0] > 5.0 + CREPT_MM);
    assert!(settled.clone().count() > 50);
    for period in settled {
        assert_eq!(
            (period.outputs.link, period.outputs.holds_feed),
            (Link::Direct, false)
        );
    }
    let cut = of(&periods, 3);
    let last = cut
        .iter()
        .rposition(|period| period.outputs.link == Link::Direct)
        .expect("it begins without delay");
    assert!(
        last <= HELD_AFTER && cut[last].inputs.command_mm[0] - 7.0 <= CREPT_MM,
        "{last}"
    );
    assert!(
        periods
            .iter()
            .all(|(_, period)| period.outputs.fault == LinkFault::None)
    );
    let step_mm = |pair: &[(usize, Period)]| {
        (pair[1].1.outputs.drive_mm[0] - pair[0].1.outputs.drive_mm[0]).abs()
    };
    let drive_mm = periods.windows(2).map(step_mm).fold(0.0, f64::max);
    assert!(
        drive_mm < STEP_MM,
        "the drive's command leapt by {drive_mm}"
    );
    assert!(
        periods
            .iter()
            .all(|(_, period)| (period.tool_mm[0] - period.inputs.command_mm[0]).abs() < 2.0)
    );
}

#[test]
fn a_control_that_does_not_hold_is_reported() {
    let periods = probing(false, |_, _| {});
    let reported = |block: usize| {
        of(&periods, block)
            .iter()
            .any(|period| period.outputs.fault == LinkFault::NotHeld)
    };
    assert!(reported(2) && !reported(1) && !reported(3));
    assert!(
        of(&periods, 3)
            .iter()
            .all(|period| !period.outputs.holds_feed),
        "it is held for nothing"
    );
}

#[test]
fn motion_that_follows_a_spindle_waits_until_it_would_be_without_delay() {
    let waits = |block: usize, inputs: &mut LinkInputs<2>| {
        inputs.spindle = block == 2;
        inputs.probing = false;
    };
    let periods = probing(true, waits);
    // The mock control does not wait, and the fault reports it. Before, the link is not settled.
    let (first, cut) = (of(&periods, 2), of(&periods, 1));
    assert!(cut.iter().skip(5).all(|period| !period.outputs.is_settled));
    assert!(
        first
            .iter()
            .any(|period| period.outputs.fault == LinkFault::NotHeld)
    );
    let rest = periods
        .iter()
        .rev()
        .take(100)
        .map(|(_, period)| &period.outputs);
    assert!(rest.clone().all(|outputs| outputs.is_settled));
    // A motion that waits is without delay from its first servo period on.
    let (mut servo, mut settled) = (Servo::new(Ok(TrainedModel::of_axes(machine()))), 0);
    servo.runs_at(SERVO_S);
    let mut step = |mm: f64, spindle: bool| {
        servo.step(
            &LinkInputs {
                spindle,
                ..cutting([mm, 0.0], [mm, 0.0])
            },
            &LIMITS,
        )
    };
    (0..100).for_each(|_| _ = step(0.0, false));
    (0..100).for_each(|n| _ = step(0.01 * f64::from(n), false));
    while !step(1.0, false).is_settled {
        settled += 1;
        assert!(settled < HELD);
    }
    assert_eq!(step(1.0, true).link, Link::Direct);
    assert_eq!(step(1.01, false).link, Link::Direct);
}

/// Returns the drive's commands of a turn in which the link fails at `period`, and the servo
/// periods of delay at the end.
fn failed_at(period: usize, powered: impl Fn(usize) -> bool) -> (Vec<[f64; 2]>, u32) {
    let good = turn(Ok(machine()), &LIMITS, |_, _| {});
    let mut play_out = PlayOut::<2>::new();
    let (mut drives_mm, mut delay) = (Vec::new(), 0);
    for (
        n,
        Period {
            inputs, outputs, ..
        },
    ) in good.iter().enumerate()
    {
        if n < period {
            play_out.keep(inputs, outputs.drive_mm, outputs.delay_periods);
            drives_mm.push(outputs.drive_mm);
        } else {
            let out = play_out.step(&LinkInputs {
                powered: powered(n),
                ..*inputs
            });
            drives_mm.push(out.drive_mm);
            delay = out.delay_periods;
        }
    }
    (drives_mm, delay)
}

#[test]
fn the_delay_of_a_link_that_failed_is_played_out() {
    let good = turn_on(&machine(), Ok(machine()), |_| LIMITS, |_, _| {});
    let speed_changes = |drives_mm: &[[f64; 2]]| {
        let second = |of: &[[f64; 2]], i: usize| (of[2][i] - 2.0 * of[1][i] + of[0][i]) / SERVO_S;
        drives_mm
            .windows(3)
            .map(|of| second(of, 0).hypot(second(of, 1)))
            .fold(0.0, f64::max)
    };
    let drives_mm: Vec<_> = good
        .iter()
        .map(
            |Period {
                 outputs: LinkOutputs { drive_mm, .. },
                 ..
             }| *drive_mm,
        )
        .collect();
    let without = speed_changes(&drives_mm);
    for period in [
        SETTLE + 100,
        SETTLE + 500,
        SETTLE + TURN,
        SETTLE + TURN + TURN / 4,
    ] {
        let (drives_mm, delay) = failed_at(period, |_| true);
        // The offset of about 1 mm leads the drive. Once the offset no longer follows the path, the
        // drive moves at the speed of the path alone.
        let with = speed_changes(&drives_mm);
        println!("{period}: speed changes by {with} of {without} mm/s");
        assert!(with <= 2.0 * without, "{period}: {with} {without}");
        assert_eq!(delay, 0);
        assert_eq!(
            drives_mm[drives_mm.len() - 1],
            command_mm(drives_mm.len() - 1),
            "{period}"
        );
    }
    let (_, delay) = failed_at(SETTLE + 500, |n| n < SETTLE + 600);
    assert_eq!(delay, 0);
}
