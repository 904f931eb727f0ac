//! Small programs whose end points LinuxCNC 2.9 was asked for, where this reader once went
//! elsewhere.
//!
//! The numbers are those of `oracle_scripts/linuxcnc_canon.py`, rounded to 1e-6 mm.
use feedwright_gcode::canon::{Canon, EventKind, Motion, MotionKind};
use feedwright_gcode::{Diagnostic, Reader, Settings};

/// The numbers below are rounded to this, mm.
const SAME_MM: f64 = 1e-6;

fn read(text: &str) -> (Vec<Canon>, Vec<Diagnostic>) {
    let (mut steps, mut faults) = (Vec::new(), Vec::new());
    for step in Reader::from_text("part.ngc", text, Settings::default()).unwrap() {
        match step {
            Ok(step) => steps.push(step),
            Err(fault) => faults.push(fault),
        }
    }
    (steps, faults)
}

fn motions(text: &str) -> Vec<Motion> {
    let (steps, faults) = read(text);
    assert!(faults.is_empty(), "{text}: {faults:?}");
    steps
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

#[track_caller]
fn assert_ends(text: &str, expected: &[(MotionKind, [f64; 3])]) {
    let motions = motions(text);
    let shown: Vec<_> = motions
        .iter()
        .map(|motion| (motion.kind, motion.end_mm))
        .collect();
    assert_eq!(shown.len(), expected.len(), "{text}{shown:?}");
    for ((kind, end), (wanted_kind, wanted)) in shown.iter().zip(expected) {
        assert!(
            (0..3).all(|axis| (end[axis] - wanted[axis]).abs() <= SAME_MM),
            "{text}{shown:?}"
        );
        assert_eq!(kind, wanted_kind, "{text}{shown:?}");
    }
}

const FEED: MotionKind = MotionKind::Feed;
const RAPID: MotionKind = MotionKind::Rapid;

#[test]
fn a_program_may_give_itself_up() {
    let (steps, faults) = read("G21\n#1=5\nG0 X1\n(abort, stop at #1)\nG0 X2\nM2\n");
    assert_eq!(faults.len(), 1);
    assert!(
        faults[0].line == 4 && faults[0].message.ends_with("stop at 5.000000"),
        "{faults:?}"
    );
    assert_eq!(
        steps
            .iter()
            .filter(|step| matches!(step, Canon::Motion(_)))
            .count(),
        1
    );
    assert_eq!(
        motions("G21\no1 if [0]\n(abort, no)\no1 endif\nG0 X2 ;abort, no\nM2\n").len(),
        1
    );
}

#[test]
fn g28_with_one_axis_in_a_rotated_system_moves_along_the_program_s_axis() {
    assert_ends(
        "G21\nG10 L2 P1 R-8\nG0 X30 Y20\nG28 Y10\nG0 X5 Y5\nM2\n",
        &[
            (RAPID, [32.491504, 15.630168, 0.0]),
            (RAPID, [31.099773, 5.727488, 0.0]),
            (RAPID, [29.708042, -4.175193, 0.0]),
            (RAPID, [5.647206, 4.255475, 0.0]),
        ],
    );
}

#[test]
fn m72_brings_back_whether_g92_is_in_effect() {
    assert_ends(
        "G21\nG0 X5\nM70\nG92 X1\nM72\nG0 X3\nG92.3\nG0 X4\nM70\nG92.2\nM72\nG0 X5\nM2\n",
        &[
            (RAPID, [5.0, 0.0, 0.0]),
            (RAPID, [3.0, 0.0, 0.0]),
            (RAPID, [8.0, 0.0, 0.0]),
            (RAPID, [9.0, 0.0, 0.0]),
        ],
    );
}

#[test]
fn cycles_that_feed_out_feed_to_the_height_of_g98() {
    let start = "G21 F100 S100 M3\nG0 Z10\n";
    let drilled = [
        (RAPID, [0.0, 0.0, 10.0]),
        (RAPID, [1.0, 1.0, 10.0]),
        (RAPID, [1.0, 1.0, 2.0]),
    ];
    let whole = [(FEED, [1.0, 1.0, -2.0]), (FEED, [1.0, 1.0, 10.0])];
    for cycle in ["G98 G84 P0", "M4 G98 G74 P0", "G98 G89 P0.5"] {
        assert_ends(
            &format!("{start}{cycle} X1 Y1 Z-2 R2\nM2\n"),
            &[&drilled[..], &whole].concat(),
        );
    }
    // G85 feeds to R.
    let stepped = [
        (FEED, [1.0, 1.0, -2.0]),
        (FEED, [1.0, 1.0, 2.0]),
        (RAPID, [1.0, 1.0, 10.0]),
    ];
    assert_ends(
        &format!("{start}G98 G85 X1 Y1 Z-2 R2\nM2\n"),
        &[&drilled[..], &stepped].concat(),
    );
}

#[test]
fn control_points_of_g5_2_in_g91_are_distances_from_the_start() {
    let text =
        "G21 F100\nG0 X5 Y5\nG91\nG5.2 X1 Y1 P1 L3\nX1 Y0 P1\nX1 Y-1 P1\nX1 Y0 P1\nG5.3\nG90\nM2\n";
    assert_ends(text, &[(RAPID, [5.0, 5.0, 0.0]), (FEED, [6.0, 5.0, 0.0])]);
}

#[test]
fn the_infeed_into_the_taper_of_a_thread_waits_for_the_spindle() {
    let text = "G21 G18 F100 S100 M3\nG0 X20 Z5\nG76 P1 Z-10 I-1 J0.3 K1 R1 E2 L1\nM2\n";
    let motions = motions(text);
    let kinds: Vec<_> = motions[1..5]
        .iter()
        .map(|motion| (motion.kind, motion.end_mm[0]))
        .collect();
    assert_eq!(
        kinds,
        [(RAPID, 20.7), (FEED, 19.7), (FEED, 18.7), (FEED, 18.7)]
    );
    let (steps, _) = read(text);
    let infeed = steps
        .iter()
        .position(|step| matches!(step, Canon::Motion(motion) if motion.kind == FEED))
        .unwrap();
    let Canon::Event(before) = &steps[infeed - 1] else {
        panic!("{:?}", steps[infeed - 1])
    };
    let EventKind::SpindleSync {
        pitch_mm: Some(pitch_mm),
    } = before.kind
    else {
        panic!("{before:?}")
    };
    assert!((pitch_mm - 1.118_034).abs() < SAME_MM, "{pitch_mm}");
}

/// `rs274` writes `START_SPEED_FEED_SYNC(1.500000,0)` around one straight motion: position and
/// spindle are coupled, K is the way of the tool a revolution, and the spindle turns as fast as the
/// surface speed asks for at each X.
#[test]
fn a_thread_at_a_surface_speed_has_its_lead_everywhere() {
    const LEAD_MM: f64 = 1.5;
    let text = "G21 G18 F100 G96 S100 D2000 M3\nG0 X20 Z10\nG33 X5 Z-20 K1.5\nG33 Z-30 K1.5\nM2\n";
    let (steps, faults) = read(text);
    assert!(faults.is_empty(), "{faults:?}");
    let synchronous: Vec<_> = steps
        .iter()
        .filter_map(|step| match step {
            Canon::Event(event) => match event.kind {
                EventKind::SpindleSync { pitch_mm } => Some(pitch_mm),
                _ => None,
            },
            Canon::Motion(_) => None,
        })
        .collect();
    assert_eq!(synchronous, [Some(LEAD_MM), None, Some(LEAD_MM), None]);
    let rpm = |x_mm: f64| (100_000.0 / (std::f64::consts::TAU * x_mm)).min(2000.0);
    let threads = motions(text).split_off(1);
    let [mut time_s, mut expected_s] = [0.0; 2];
    for motion in &threads {
        let [a, b] = [motion.start_mm[0], motion.end_mm[0]];
        // The lead at both ends of a piece is within what the spindle changes along it.
        for x_mm in [a, b] {
            let lead_mm = motion.feed_mm_s / (rpm(x_mm) / 60.0);
            assert!(
                (lead_mm / LEAD_MM - 1.0).abs() < 0.03,
                "{lead_mm} at X {x_mm}: {motion:?}"
            );
        }
        time_s += motion.length_mm() / motion.feed_mm_s;
        const PARTS: u32 = 100;
        for part in 0..PARTS {
            let x_mm = a + (b - a) * (f64::from(part) + 0.5) / f64::from(PARTS);
            expected_s += motion.length_mm() / f64::from(PARTS) / (LEAD_MM * rpm(x_mm) / 60.0);
        }
    }
    assert!(
        (time_s / expected_s - 1.0).abs() < 2e-4,
        "{time_s} s, {expected_s} s"
    );
    // No stop between the pieces of one thread.
    assert!(
        threads
            .windows(2)
            .all(|pair| pair[0].end_mm == pair[1].start_mm)
    );
    assert_eq!(threads.last().unwrap().end_mm, [5.0, 0.0, -30.0]);
}
