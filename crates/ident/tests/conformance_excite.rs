//! The program that excites a machine: it keeps the limits and the travel of every built-in
//! machine, ends where it began, and has every kind of motion that an identification needs.

use feedwright_gcode::canon::{Canon, Motion, Shape};
use feedwright_gcode::{Reader, Settings};
use feedwright_ident::{
    AxisExcitation, ExciteError, ExciteOptions, MotionPart, excitation_program, next_excitation,
};
use feedwright_sim::{BUILT_IN_MACHINES, Machine};

/// Rounding of the positions in a program, mm.
const ROUNDING_MM: f64 = 1e-9;

fn machines() -> Vec<Machine> {
    BUILT_IN_MACHINES
        .iter()
        .map(|(name, _)| Machine::load(name.as_ref()).unwrap())
        .collect()
}

fn motions(machine: &Machine, travel_mm: f64) -> Vec<Motion> {
    motions_of(
        excitation_program(machine, ExciteOptions { travel_mm })
            .unwrap()
            .text,
    )
}

fn motions_of(text: String) -> Vec<Motion> {
    let reader = Reader::from_text("excite.ngc", text, Settings::default()).unwrap();
    let canon: Vec<Canon> = reader
        .map(|step| step.unwrap_or_else(|error| panic!("{error:?}")))
        .collect();
    canon
        .into_iter()
        .filter_map(|step| {
            if let Canon::Motion(motion) = step {
                Some(motion)
            } else {
                None
            }
        })
        .collect()
}

/// Largest distance of each axis from the origin, mm; circles with all of their extent.
fn reach_mm(motion: &Motion) -> [f64; 3] {
    let mut reach =
        [0, 1, 2].map(|axis: usize| motion.start_mm[axis].abs().max(motion.end_mm[axis].abs()));
    if let Shape::Arc { center_mm, .. } = motion.shape {
        let radius = f64::hypot(
            motion.start_mm[0] - center_mm[0],
            motion.start_mm[1] - center_mm[1],
        );
        for axis in 0..2 {
            reach[axis] = reach[axis].max(center_mm[axis].abs() + radius);
        }
    }
    reach
}

#[test]
fn it_keeps_the_travel_and_the_feeds_of_every_machine() {
    for machine in machines() {
        for travel_mm in [2.0, 20.0, 300.0] {
            let motions = motions(&machine, travel_mm);
            for motion in &motions {
                let reach = reach_mm(motion);
                assert!(
                    reach.iter().all(|mm| *mm <= 0.5 * travel_mm + ROUNDING_MM),
                    "{}: {reach:?}",
                    machine.name
                );
                assert!(
                    motion.feed_mm_s > 0.0 && motion.feed_mm_s <= machine.limits.max_feed_mm_s,
                    "{}",
                    machine.name
                );
            }
            let (first, last) = (motions.first().unwrap(), motions.last().unwrap());
            for axis in 0..3 {
                assert!(
                    (first.start_mm[axis] - last.end_mm[axis]).abs() < ROUNDING_MM,
                    "{}",
                    machine.name
                );
            }
        }
    }
}

#[test]
fn it_has_every_kind_of_motion() {
    for machine in machines() {
        let motions = motions(&machine, 20.0);
        let way = |motion: &Motion| {
            [0, 1, 2].map(|axis: usize| motion.end_mm[axis] - motion.start_mm[axis])
        };
        for axis in 0..machine.axis_count() {
            let alone = motions.iter().filter(|motion| {
                let way = way(motion);
                way[axis] != 0.0 && (0..3).all(|other| other == axis || way[other] == 0.0)
            });
            let mut feeds: Vec<f64> = alone.clone().map(|motion| motion.feed_mm_s).collect();
            feeds.sort_by(f64::total_cmp);
            feeds.dedup();
            assert!(
                feeds[0] <= 0.5 && feeds.len() >= 6,
                "{}, axis {axis}: {feeds:?}",
                machine.name
            );
            assert!(feeds[feeds.len() - 1] >= 20.0 * feeds[0]);
            let both = [-1.0, 1.0].map(|sign| {
                alone
                    .clone()
                    .filter(|motion| sign * way(motion)[axis] > 0.0)
                    .count()
            });
            assert!(both.iter().all(|count| *count > 10), "{both:?}");
        }
        let circles = motions
            .iter()
            .filter(|motion| matches!(motion.shape, Shape::Arc { .. }));
        assert!(circles.count() >= 10, "{}", machine.name);
        assert!(
            motions
                .iter()
                .any(|motion| way(motion)[0] != 0.0 && way(motion)[1] != 0.0),
            "{}",
            machine.name
        );
    }
}

#[test]
fn it_takes_a_minute_at_the_most_and_says_what_to_do() {
    for machine in machines() {
        let made = excitation_program(&machine, ExciteOptions::default()).unwrap();
        assert!(
            (15.0..=60.0).contains(&made.takes_s),
            "{}: {} s",
            machine.name,
            made.takes_s
        );
        for part in [
            "Check first",
            "halcmd loadrt sampler",
            "joint.1.motor-pos-fb => sampler.0.pin.3",
            "halsampler -t",
            "# sample_time_s =",
        ] {
            assert!(
                made.text.contains(part),
                "{}: {part} is missing in\n{}",
                machine.name,
                made.text
            );
        }
    }
}

#[test]
fn a_travel_out_of_range_is_refused() {
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    for travel_mm in [0.0, -5.0, 1.9, 1001.0, f64::NAN, f64::INFINITY] {
        let error = excitation_program(&machine, ExciteOptions { travel_mm }).unwrap_err();
        assert!(matches!(error, ExciteError::Travel { .. }), "{error}");
        assert!(
            error.to_string().contains("2 to 1000 mm are possible"),
            "{error}"
        );
    }
}

/// Lines of a program that are no comments.
fn lines(text: &str) -> Vec<&str> {
    text.lines().filter(|line| !line.starts_with(';')).collect()
}

#[test]
fn what_is_missing_everywhere_is_the_whole_excitation_and_what_is_not_is_left_out() {
    let mut machine = Machine::load("tnv40".as_ref()).unwrap();
    // A log does not separate the two.
    machine.limits.normal_accel_mm_s2 = machine.limits.tangential_accel_mm_s2;
    let limits = &machine.limits;
    let whole = |axis| AxisExcitation {
        axis,
        range_mm: [90.0, 110.0],
        fastest_mm_s: 0.8 * limits.max_feed_mm_s,
        accel_mm_s2: limits.tangential_accel_mm_s2,
        parts: MotionPart::ALL.to_vec(),
    };
    let all = [whole(0), whole(1), whole(2)];
    let program = next_excitation(&all).unwrap();
    let excitation = excitation_program(&machine, ExciteOptions { travel_mm: 20.0 }).unwrap();
    assert_eq!(lines(&program.text), lines(&excitation.text));
    assert!(
        program
            .text
            .contains("the axes stand at x = 100 mm, y = 100 mm, z = 100 mm"),
        "{}",
        program.text
    );
    let none = AxisExcitation {
        parts: vec![],
        ..whole(0)
    };
    assert_eq!(next_excitation(&[none.clone(), none.clone()]), None);
    let reversals = AxisExcitation {
        parts: vec![MotionPart::Reversals],
        ..whole(1)
    };
    let moves = motions_of(next_excitation(&[none, reversals]).unwrap().text);
    assert!(
        !moves.is_empty()
            && moves
                .iter()
                .all(|motion| motion.end_mm[0] == 0.0 && motion.end_mm[2] == 0.0)
    );
    assert!(
        moves.iter().any(|motion| motion.end_mm[1] > 0.0)
            && moves.iter().any(|motion| motion.end_mm[1] < 0.0)
    );
}

#[test]
fn what_is_missing_keeps_to_what_the_log_had() {
    for (range_mm, fastest_mm_s) in [
        ([0.0, 0.3], 5.0),
        ([-7.0, 61.2345], 44.4),
        ([3.0, 900.0], 400.0),
    ] {
        for part in MotionPart::ALL {
            let axis = AxisExcitation {
                axis: 0,
                range_mm,
                fastest_mm_s,
                accel_mm_s2: 800.0,
                parts: vec![part],
            };
            let program = next_excitation(&[axis]).unwrap();
            assert!(program.takes_s > 0.0 && program.max_feed_mm_s <= fastest_mm_s);
            for motion in motions_of(program.text) {
                assert!(
                    reach_mm(&motion)[0] <= 0.5 * (range_mm[1] - range_mm[0]) + 1e-4,
                    "{part:?} {range_mm:?}"
                );
                assert!(
                    motion.feed_mm_s <= fastest_mm_s + ROUNDING_MM,
                    "{part:?}: {} mm/s",
                    motion.feed_mm_s
                );
            }
        }
    }
}
