//! Lathe cycles over random profiles: whatever the profile, no motion comes closer to the part than
//! the words of the cycle allow, none leaves the stock and the way back, and words that ask for too
//! much end in a fault.
//!
//! The part is here a polyline of its own: distances are those of points from chords, and what lies
//! below is found by height.
use feedwright_gcode::canon::{Canon, Motion, Shape};
use feedwright_gcode::{Diagnostic, Reader, Settings};
use proptest::prelude::*;

/// Chords of an arc: of half a circle of 10 mm, they are 4e-4 mm off.
const CHORDS: u32 = 256;
/// Deviation of the chords, and rounding of the program to six decimals.
const SLACK_MM: f64 = 1e-3;
/// Start of the cycle: above the whole profile in depth, and before it along the passes.
const TOP_MM: f64 = 40.0;
const BEFORE_MM: f64 = 2.0;

#[derive(Debug, Clone)]
struct Stroke {
    along: f64,
    up: f64,
    /// 0 is a line; an arc with its centre to the left (above 0) or right (below), its radius this
    /// many chords.
    bend: f64,
}

fn strokes() -> impl Strategy<Value = Vec<Stroke>> {
    let length = prop_oneof![Just(0.0), Just(1.0), 0.01..4.0];
    let height = prop_oneof![Just(0.0), Just(-1.0), Just(1.0), -3.0..3.0];
    let bend = prop_oneof![3 => Just(0.0), 1 => 0.55..4.0, 1 => -4.0..-0.55];
    prop::collection::vec(
        (length, height, bend).prop_map(|(along, up, bend)| Stroke { along, up, bend }),
        2..9,
    )
}

/// A profile in coordinates along the passes and of their depth: the program, and the part as a
/// polyline.
struct Part {
    block: String,
    points: Vec<[f64; 2]>,
}

/// `facing` turns the plane, which keeps the sense of arcs; turning reverses it.
fn part(strokes: &[Stroke], facing: bool) -> Part {
    let word = |[a, d]: [f64; 2]| {
        if facing {
            format!("X{:.6} Z{d:.6}", 30.0 - a)
        } else {
            format!("X{d:.6} Z{:.6}", -a)
        }
    };
    let mut at = [0.0, 20.0];
    let mut part = Part {
        block: format!("G0 {}\n", word(at)),
        points: vec![at],
    };
    for stroke in strokes {
        // It must not end lower than it begins.
        let end = [at[0] + stroke.along, (at[1] + stroke.up).max(2.0)];
        let chord = (end[0] - at[0]).hypot(end[1] - at[1]);
        if chord < 1e-3 {
            continue;
        }
        if stroke.bend == 0.0 || end[0] == at[0] {
            part.block += &format!("G1 {}\n", word(end));
            part.points.push(end);
        } else {
            let radius = chord * stroke.bend.abs();
            let half = (radius * radius - 0.25 * chord * chord).sqrt() * stroke.bend.signum();
            let left = [-(end[1] - at[1]) / chord, (end[0] - at[0]) / chord];
            let center = [0, 1].map(|n| 0.5 * (at[n] + end[n]) + half * left[n]);
            let is_left = stroke.bend > 0.0;
            let code = if is_left == facing { "G3" } else { "G2" };
            let to = [center[0] - at[0], center[1] - at[1]];
            let [i, k] = if facing {
                [-to[0], to[1]]
            } else {
                [to[1], -to[0]]
            };
            part.block += &format!("{code} {} I{i:.6} K{k:.6}\n", word(end));
            let [from, until] =
                [at, end].map(|point| (point[1] - center[1]).atan2(point[0] - center[0]));
            let turn = (until - from).sin().atan2((until - from).cos());
            part.points.extend((1..=CHORDS).map(|n| {
                let angle = from + turn * f64::from(n) / f64::from(CHORDS);
                [
                    center[0] + radius * angle.cos(),
                    center[1] + radius * angle.sin(),
                ]
            }));
        }
        at = end;
    }
    let end = [at[0], TOP_MM];
    part.block += &format!("G1 {}\n", word(end));
    part.points.push(end);
    part
}

impl Part {
    fn away(&self, point: [f64; 2]) -> f64 {
        let to = |pair: &[[f64; 2]]| {
            let along = [pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]];
            let ray = [point[0] - pair[0][0], point[1] - pair[0][1]];
            let square = along[0] * along[0] + along[1] * along[1];
            let share = if square > 0.0 {
                ((ray[0] * along[0] + ray[1] * along[1]) / square).clamp(0.0, 1.0)
            } else {
                0.0
            };
            (ray[0] - share * along[0]).hypot(ray[1] - share * along[1])
        };
        self.points.windows(2).map(to).fold(f64::INFINITY, f64::min)
    }

    /// Returns true if a point lies below the profile.
    fn is_inside(&self, point: [f64; 2]) -> bool {
        self.points.windows(2).any(|pair| {
            let [from, to] = [pair[0][0], pair[1][0]];
            if !(from + SLACK_MM..=to - SLACK_MM).contains(&point[0]) {
                return false;
            }
            let height = pair[0][1] + (pair[1][1] - pair[0][1]) * (point[0] - from) / (to - from);
            point[1] < height - SLACK_MM
        })
    }
}

fn read(text: &str) -> (Vec<Motion>, Vec<Diagnostic>) {
    let (mut motions, mut faults) = (Vec::new(), Vec::new());
    for step in Reader::from_text("lathe.ngc", text, Settings::default()).unwrap() {
        match step {
            Ok(Canon::Motion(motion)) => motions.push(motion),
            Ok(Canon::Event(_)) => {}
            Err(fault) => faults.push(fault),
        }
    }
    (motions, faults)
}

/// Points along a motion, in the coordinates of the part.
fn points_of(motion: &Motion, facing: bool) -> Vec<[f64; 2]> {
    let plane = |[x, _, z]: [f64; 3]| if facing { [30.0 - x, z] } else { [-z, x] };
    let (start, end) = (plane(motion.start_mm), plane(motion.end_mm));
    let center = match &motion.shape {
        Shape::Arc { center_mm, .. } => Some(plane(*center_mm)),
        _ => None,
    };
    let between = |share: f64| [0, 1].map(|n| start[n] + share * (end[n] - start[n]));
    let at = |share: f64| {
        let Some(center) = center else {
            return between(share);
        };
        // No arc of a cycle goes round more than half a circle, so the point of the chord shows the
        // angle, but in the middle of a half.
        let radius = (start[0] - center[0]).hypot(start[1] - center[1]);
        let chord = between(share);
        let ray = [chord[0] - center[0], chord[1] - center[1]];
        let length = ray[0].hypot(ray[1]);
        if length < 1e-3 * radius {
            start
        } else {
            [0, 1].map(|n| center[n] + ray[n] * radius / length)
        }
    };
    (0..=16).map(|n| at(f64::from(n) / 16.0)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn no_motion_comes_closer_than_the_distance_left(
        strokes in strokes(),
        code in prop::sample::select(&["G70", "G71", "G71.1", "G71.2", "G72", "G72.1", "G72.2"][..]),
        left in prop_oneof![Just(0.0), 0.01..2.0f64],
        depth in 0.3..6.0f64,
        back in prop_oneof![Just(0.0), 0.01..5.0f64],
    ) {
        let facing = code.starts_with("G72");
        let part = part(&strokes, facing);
        let (start, words) = if facing { ([32.0, TOP_MM], "X32 Z40") } else { ([TOP_MM, BEFORE_MM], "X40 Z2") };
        let words = if code == "G70" {
            format!("{words} D{left:.6} E{left:.6}")
        } else {
            format!("{words} D{left:.6} I{depth:.6} R{back:.6}")
        };
        let text = format!(
            "G21 G18 G8 G90 F100\nG0 X60 Z60\no1 sub\n{}o1 endsub\n{code} Q1 {words}\nM2\n",
            part.block
        );
        let (motions, faults) = read(&text);
        if let Some(fault) = faults.first() {
            let known = ["turns back", "too large for its details"];
            prop_assert!(known.iter().any(|known| fault.message.contains(known)), "{}: {text}", fault.message);
            return Ok(());
        }
        let back_mm = part.points.windows(2).map(|pair| pair[0][0] - pair[1][0]).fold(0.0, f64::max);
        if back_mm > 1e-9 {
            // An arc that turns back by next to nothing counts as straight up; G70 follows a
            // profile that only X runs along.
            prop_assert!(back_mm < SLACK_MM || code == "G70", "{text}");
            return Ok(());
        }
        for pair in motions.windows(2) {
            prop_assert_eq!(pair[0].end_mm, pair[1].start_mm);
        }
        // The way to the start is the program's own.
        let reach = motions.iter().position(|motion| motion.end_mm == [start[0], 0.0, start[1]]).unwrap();
        let end = part.points.last().unwrap()[0];
        for motion in &motions[reach + 1..] {
            for point in points_of(motion, facing) {
                let away = part.away(point);
                // The way to the profile is straight, as LinuxCNC's, and may cut the distance to
                // its first point short.
                prop_assert!(away >= left - SLACK_MM || point[0] < left, "{away} mm from the part at {point:?}\n{text}\n{motion:?}");
                prop_assert!(!part.is_inside(point), "inside at {point:?}\n{text}\n{motion:?}");
                prop_assert!(point[1] <= TOP_MM + back + SLACK_MM, "above the stock at {point:?}\n{text}");
                prop_assert!((-BEFORE_MM - 2.0 - SLACK_MM..=end + SLACK_MM).contains(&point[0]), "beside the stock at {point:?}\n{text}");
            }
        }
        // Each level has a pass of five motions for each falling stretch and one for the entry.
        let levels = ((TOP_MM - 2.0) / depth).ceil() + 1.0;
        prop_assert!(motions.len() as f64 <= 6.0 * levels * (strokes.len() + 1) as f64 + 60.0, "{} motions", motions.len());
    }

    #[test]
    fn extreme_words_end_in_a_fault_or_in_few_motions(
        strokes in strokes(),
        code in prop::sample::select(&["G71", "G71.2", "G72.1", "G72.2"][..]),
        depth in prop::sample::select(&["1e-300", "0.000000001", "0.001", "900000"][..]),
        left in prop::sample::select(&["0.000000001", "0.0001", "50", "900000"][..]),
    ) {
        let facing = code.starts_with("G72");
        let depth = depth.replace("1e-300", &format!("0.{}1", "0".repeat(299)));
        let text = format!(
            "G21 G18 G8 G90 F100\no1 sub\n{}o1 endsub\n{code} Q1 X40 Z40 I{depth} D{left}\nM2\n",
            part(&strokes, facing).block
        );
        let (motions, faults) = read(&text);
        prop_assert!(motions.len() < 60_000, "{} motions", motions.len());
        for fault in faults {
            prop_assert!(fault.hint.is_some(), "{}", fault.message);
        }
    }
}

/// A distance much larger than the details makes the search long; it is given up.
#[test]
fn a_large_distance_to_many_details_is_given_up() {
    let text = "G21 G18 G8 F100\nG0 X300 Z5\no1 sub\nG0 X10\n#1=0\no2 while [#1 LT 20000]\n\
                G1 W-0.002 U[0.001*[#1 MOD 7 - 3]]\n#1=[#1+1]\no2 endwhile\nG1 X300\no1 endsub\nG70 Q1 D90 E90\nM2\n";
    let (motions, faults) = read(text);
    assert!(
        motions.len() < 100_000 && (faults.is_empty() || faults[0].hint.is_some()),
        "{} {faults:?}",
        motions.len()
    );
}
