//! Channels that are delayed and not corrected get the same delay as the corrected axes, to the
//! bit, through every transition.

#[path = "common/axis.rs"]
mod axis;
#[path = "common/inputs.rs"]
mod common;
#[path = "common/turn.rs"]
mod turning;

use feedwright_servo::play_out::PlayOut;
use feedwright_servo::servo::{Link, LinkFault, LinkInputs};
use feedwright_servo::through::{CHANNELS, Carries, Through};

use common::LIMITS;
use turning::{Period, SETTLE, TURN, command_mm, machine, turn};

/// Channels of the tests: a rotary joint, a second motor of each axis, and a signal.
const ROTARY: usize = 0;
const SIGNAL: usize = 3;
const CARRIES: [Carries; CHANNELS] = [
    Carries::Joint,
    Carries::Tandem(0),
    Carries::Tandem(1),
    Carries::Signal,
    Carries::Signal,
    Carries::Signal,
];
/// Offset of the second motor of each axis from the first, mm.
const BESIDE_MM: [f64; 2] = [0.25, -1.0 / 3.0];

/// Returns the commands of a rotary axis that moves with the circle, of two second motors, and of a
/// signal that never rests.
fn through(n: usize) -> Through {
    let [x, y] = command_mm(n);
    let mut command = [0.0; CHANNELS];
    command[..=SIGNAL].copy_from_slice(&[
        7.3 * y - x,
        x + BESIDE_MM[0],
        y + BESIDE_MM[1],
        (n as f64).sqrt(),
    ]);
    // Each drive has a following error of its own.
    let actual = core::array::from_fn(|i| command[i] - 0.01 * (i + n % 7) as f64);
    Through {
        command,
        actual,
        carries: CARRIES,
    }
}

fn with_channels(change: impl Fn(usize, &mut LinkInputs<2>)) -> Vec<Period> {
    turn(Ok(machine()), &LIMITS, |n, inputs| {
        inputs.through = through(n);
        change(n, inputs);
    })
}

/// Checks every servo period against the commands one delay earlier. Returns the links in their
/// order, and the number of changes of the delay.
fn check(periods: &[Period]) -> (Vec<Link>, usize) {
    let (mut links, mut changes) = (Vec::new(), 0);
    for (
        n,
        Period {
            inputs, outputs, ..
        },
    ) in periods.iter().enumerate()
    {
        let delay = outputs.delay_periods as usize;
        let before = periods[n - delay].inputs;
        let given = &inputs.through;
        for i in 0..=SIGNAL {
            let (drive, feedback) = (outputs.through.drive[i], outputs.through.feedback[i]);
            if outputs.link == Link::Off {
                assert_eq!([drive, feedback], [given.actual[i]; 2], "{n} {i}");
                continue;
            }
            let due = before.through.command[i];
            let offset_mm = match CARRIES[i] {
                Carries::Tandem(axis) => outputs.correction_mm[axis],
                Carries::Signal | Carries::Joint => 0.0,
            };
            // To the bit: nothing is added to a channel that is not in tandem.
            assert_eq!(drive.to_bits(), (due + offset_mm).to_bits(), "{n} {i}");
            let seen = if delay == 0 {
                given.actual[i]
            } else {
                given.command[i] + (given.actual[i] - due)
            };
            assert_eq!(feedback.to_bits(), seen.to_bits(), "{n} {i}");
        }
        for axis in 0..2 {
            // Both motors of an axis get the same corrected command, each from its own home
            // position.
            let apart_mm =
                outputs.through.drive[1 + axis] - outputs.drive_mm[axis] - BESIDE_MM[axis];
            assert!(
                outputs.link == Link::Off || apart_mm.abs() < 1e-12,
                "{n} {axis}: {apart_mm}"
            );
        }
        links.push(outputs.link);
        if let Some(last) = n.checked_sub(1).map(|last| &periods[last])
            && last.outputs.delay_periods != outputs.delay_periods
            && ![last.outputs.link, outputs.link].contains(&Link::Off)
        {
            changes += 1;
            // The joint rests at the change. If it begins to move in this servo period, its drive
            // moves by the step of the command.
            let [leap, step] = [
                outputs.through.drive[ROTARY] - last.outputs.through.drive[ROTARY],
                given.command[ROTARY] - last.inputs.through.command[ROTARY],
            ];
            assert!(
                leap == 0.0 || leap == step,
                "{n}: the delay changed while the rotary joint moved"
            );
        }
    }
    links.dedup();
    (links, changes)
}

#[test]
fn channels_keep_the_delay_of_the_corrected_axes_to_the_bit() {
    let (links, changes) = check(&with_channels(|_, _| {}));
    assert_eq!((links, changes), (vec![Link::Direct, Link::Delayed], 1));
    // Without correction the axes get the delayed command, and the channels change nothing in it.
    let (with, without) = (
        with_channels(|_, inputs| inputs.enabled = false),
        turn(Ok(machine()), &LIMITS, |_, inputs| inputs.enabled = false),
    );
    let moved = |period: &Period| (period.outputs.drive_mm, period.tool_mm);
    assert!(with.iter().zip(&without).all(|(a, b)| moved(a) == moved(b)));
}

#[test]
fn the_delay_ends_and_begins_for_all_of_them_at_once() {
    let behind = SETTLE + TURN + TURN / 2;
    let direct = check(&with_channels(|n, inputs| {
        inputs.direct = (SETTLE + 700..behind).contains(&n);
    }));
    assert_eq!(
        direct,
        (
            vec![Link::Direct, Link::Delayed, Link::Direct, Link::Delayed],
            3
        )
    );
    let probing = check(&with_channels(|n, inputs| {
        inputs.probing = (SETTLE + 700..behind).contains(&n);
    }));
    assert_eq!(probing, direct);
    let (links, _) = check(&with_channels(|n, inputs| {
        inputs.powered = !(SETTLE + 700..SETTLE + 900).contains(&n);
    }));
    assert_eq!(
        links,
        [
            Link::Direct,
            Link::Delayed,
            Link::Off,
            Link::Direct,
            Link::Delayed
        ]
    );
    // Without a model there is never a delay.
    let none = turn(
        Err(feedwright_servo::machine::Refused::Block(
            feedwright_control::BlockError::NoModel,
        )),
        &LIMITS,
        |n, inputs| inputs.through = through(n),
    );
    assert_eq!(check(&none), (vec![Link::Direct], 0));
}

#[test]
fn a_rotary_joint_that_moves_alone_keeps_the_delay_and_a_signal_does_not() {
    let begin = SETTLE + 2 * TURN - 400;
    let turns = begin..begin + 200;
    let periods = with_channels(|n, inputs| {
        inputs.through.command[ROTARY] = 0.1 * n.clamp(turns.start, turns.end) as f64;
        inputs.direct = n > turns.start + 1;
    });
    check(&periods);
    assert!(
        turns
            .clone()
            .skip(1)
            .all(|n| periods[n].outputs.link == Link::Delayed)
    );
    assert_eq!(periods[turns.end + 20].outputs.link, Link::Direct);
    // A joint that moves from the start keeps the delay from being taken up.
    let moves = with_channels(|n, inputs| inputs.through.command[ROTARY] = n as f64);
    assert_eq!(check(&moves).0, [Link::Direct]);
}

#[test]
fn what_is_not_a_number_does_not_reach_a_drive() {
    let bad = SETTLE + 500;
    let periods = with_channels(|n, inputs| {
        if n == bad {
            inputs.through.command[ROTARY] = f64::NAN;
            inputs.through.actual[ROTARY] = f64::INFINITY;
        }
    });
    assert_eq!(periods[bad].outputs.fault, LinkFault::Command);
    assert_eq!(periods[bad + 1].outputs.fault, LinkFault::None);
    let delay = periods[bad].outputs.delay_periods as usize;
    assert_eq!(
        periods[bad + delay].outputs.through.drive[ROTARY],
        through(bad - 1).command[ROTARY]
    );
    let is_number = |period: &Period| {
        period
            .outputs
            .through
            .drive
            .iter()
            .chain(&period.outputs.through.feedback)
            .all(|x| x.is_finite())
    };
    assert!(periods.iter().all(is_number));
}

#[test]
fn a_link_that_fails_plays_the_channels_out_too() {
    let good = with_channels(|_, _| {});
    let fails = SETTLE + 500;
    let mut play_out = PlayOut::<2>::new();
    let mut delays = Vec::new();
    for (
        n,
        Period {
            inputs, outputs, ..
        },
    ) in good.iter().enumerate()
    {
        if n < fails {
            play_out.keep(inputs, outputs.drive_mm, outputs.delay_periods);
            continue;
        }
        let out = play_out.step(inputs);
        let before = good[n - out.delay_periods as usize].inputs.through.command;
        assert_eq!(
            [out.through.drive[ROTARY], out.through.drive[SIGNAL]],
            [before[ROTARY], before[SIGNAL]],
            "{n}"
        );
        assert_eq!(
            out.through.drive[1],
            before[1] + out.correction_mm[0],
            "{n}"
        );
        delays.push(out.delay_periods);
    }
    assert_eq!(
        (delays[0], delays[delays.len() - 1]),
        (good[fails - 1].outputs.delay_periods, 0)
    );
}
