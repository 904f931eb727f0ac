//! G71, G72 and G73 of Fanuc lathes over random profiles: no motion comes into the part that the
//! allowance leaves, the roughing leaves nothing thicker than a pass and the allowance, and extreme
//! words end in a fault or in few motions.
use feedwright_gcode::canon::{Canon, Motion, MotionKind, Shape};
use feedwright_gcode::{Diagnostic, Dialect, Reader, Settings};
use proptest::prelude::*;

/// Rounding of the program to six decimals, and chords of arcs.
const SLACK_MM: f64 = 2e-3;
/// Start of the cycle: radius, and distance before the part.
const TOP_MM: f64 = 40.0;
const BEFORE_MM: f64 = 2.0;
const CHORDS: u32 = 200;

#[derive(Debug, Clone)]
struct Stroke {
    along: f64,
    up: f64,
    /// A quarter of an ellipse's circle: 1 an inner corner, -1 an outer one, 0 a line.
    arc: i32,
}

fn strokes(falls: bool) -> impl Strategy<Value = Vec<Stroke>> {
    let up = if falls { -3.0..4.0_f64 } else { 0.0..4.0_f64 };
    let stroke = (
        prop_oneof![Just(0.0), 0.05..6.0],
        prop_oneof![1 => Just(0.0), 3 => up],
        -1..=1,
    )
        .prop_map(|(along, up, arc)| Stroke { along, up, arc });
    prop::collection::vec(stroke, 2..8)
}

struct Part {
    blocks: String,
    /// Along the passes and depth, radius.
    points: Vec<[f64; 2]>,
}

/// A profile for turning outside; `facing` exchanges X and Z.
fn part(strokes: &[Stroke], facing: bool, first: &str) -> Part {
    let word = |[a, d]: [f64; 2]| {
        if facing {
            format!("X{:.6} Z{d:.6}", 2.0 * (60.0 - a))
        } else {
            format!("X{:.6} Z{:.6}", 2.0 * d, -a)
        }
    };
    let mut at = [0.5, 10.0];
    let entry = word(at);
    let entry = entry.split(' ').nth(usize::from(facing)).unwrap();
    let mut part = Part {
        blocks: format!("N1 G0 {entry}{first}\n"),
        points: Vec::new(),
    };
    at[0] = -BEFORE_MM;
    part.points.push(at);
    for stroke in strokes {
        let mut end = [at[0] + stroke.along, (at[1] + stroke.up).max(5.0)];
        let rises = end[1] - at[1];
        if stroke.arc != 0 && stroke.along > 0.01 && rises > 0.01 {
            // A quarter of a circle: as far along as up.
            let radius = stroke.along.min(rises);
            end = [at[0] + radius, at[1] + radius];
            let inner = stroke.arc > 0;
            let center = if inner {
                [at[0], end[1]]
            } else {
                [end[0], at[1]]
            };
            let turns_left = inner != facing;
            // Along -Z with X up, a left turn of the profile is clockwise.
            let code = if turns_left { "G2" } else { "G3" };
            part.blocks += &format!("{code} {} R{radius:.6}\n", word(end));
            part.points.extend((1..=CHORDS).map(|n| {
                let angle = std::f64::consts::FRAC_PI_2 * f64::from(n) / f64::from(CHORDS);
                if inner {
                    [
                        center[0] + radius * angle.sin(),
                        center[1] - radius * angle.cos(),
                    ]
                } else {
                    [
                        center[0] - radius * angle.cos(),
                        center[1] + radius * angle.sin(),
                    ]
                }
            }));
        } else if end != at {
            part.blocks += &format!("G1 {}\n", word(end));
            part.points.push(end);
            if stroke.along == 0.0 && rises < 0.0 {
                // A pocket has a width.
                end[0] += 0.2;
                part.blocks += &format!("G1 {}\n", word(end));
                part.points.push(end);
            }
        }
        at = end;
    }
    let end = [at[0] + 1.0, at[1]];
    part.points.extend([end, [end[0], TOP_MM]]);
    part.blocks += &format!("G1 {}\nN2 {}\n", word(end), word([end[0], TOP_MM]));
    part
}

impl Part {
    /// Height of the part along the passes; 0 before it.
    fn height(&self, along: f64) -> f64 {
        let inside = |pair: &[[f64; 2]]| (pair[0][0] + 1e-9..pair[1][0] - 1e-9).contains(&along);
        self.points
            .windows(2)
            .find(|pair| inside(pair))
            .map_or(0.0, |pair| {
                pair[0][1]
                    + (pair[1][1] - pair[0][1]) * (along - pair[0][0]) / (pair[1][0] - pair[0][0])
            })
    }
}

impl Part {
    /// The lowest height within [`SLACK_MM`] along the passes.
    fn lowest_near(&self, along: f64) -> f64 {
        let beside = [-SLACK_MM, 0.0, SLACK_MM].map(|by| self.height(along + by));
        let corners = self
            .points
            .iter()
            .filter(|point| (point[0] - along).abs() <= SLACK_MM)
            .map(|point| point[1]);
        beside
            .into_iter()
            .chain(corners)
            .fold(f64::INFINITY, f64::min)
    }
}

fn read(text: &str) -> (Vec<Motion>, Vec<Diagnostic>) {
    let (mut motions, mut faults) = (Vec::new(), Vec::new());
    let settings = Settings {
        dialect: Some(Dialect::FanucLathe),
        ..Settings::default()
    };
    for step in Reader::from_text("lathe.nc", text, settings).unwrap() {
        match step {
            Ok(Canon::Motion(motion)) => motions.push(motion),
            Ok(Canon::Event(_)) => {}
            Err(fault) => faults.push(fault),
        }
    }
    (motions, faults)
}

fn points_of(motion: &Motion, facing: bool) -> Vec<[f64; 2]> {
    let plane = |[x, _, z]: [f64; 3]| if facing { [60.0 - x, z] } else { [-z, x] };
    let (start, end) = (plane(motion.start_mm), plane(motion.end_mm));
    let between = |share: f64| [0, 1].map(|n| start[n] + share * (end[n] - start[n]));
    (0..=24)
        .map(|n| {
            let chord = between(f64::from(n) / 24.0);
            let Shape::Arc { center_mm, .. } = &motion.shape else {
                return chord;
            };
            let center = plane(*center_mm);
            let radius = (start[0] - center[0]).hypot(start[1] - center[1]);
            let ray = [chord[0] - center[0], chord[1] - center[1]];
            [0, 1].map(|n| center[n] + ray[n] * radius / ray[0].hypot(ray[1]))
        })
        .collect()
}

fn program(code: &str, part: &Part, words: [f64; 4]) -> String {
    let [depth, escape, u, w] = words;
    let first = if code == "G71" { "U" } else { "W" };
    let start = if code == "G71" {
        "X80. Z2."
    } else {
        "X124. Z40."
    };
    format!(
        "O1\nG21 G97 G99 S900 M3\nG0 {start}\n{code} {first}{depth:.6} R{escape:.6}\n{code} P1 Q2 U{u:.6} W{w:.6} F0.2\n{}M30\n",
        part.blocks
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn roughing_leaves_the_allowance_and_no_more_than_a_pass(
        (falls, strokes) in prop::bool::ANY.prop_flat_map(|falls| (Just(falls), strokes(falls))),
        facing in prop::bool::ANY,
        depth in 0.3..8.0_f64,
        escape in prop_oneof![Just(0.0), 0.05..3.0_f64],
        u in prop_oneof![Just(0.0), 0.05..2.0_f64],
        w in prop_oneof![Just(0.0), 0.05..1.0_f64],
    ) {
        let (code, pockets) = if facing { ("G72", " U0") } else { ("G71", " W0") };
        let part = part(&strokes, facing, if falls { pockets } else { "" });
        let text = program(code, &part, [depth, escape, u, w]);
        let (motions, faults) = read(&text);
        prop_assert!(faults.is_empty(), "{faults:?}\n{text}");
        for pair in motions.windows(2) {
            prop_assert_eq!(pair[0].end_mm, pair[1].start_mm);
        }
        // The allowance moves the part: along the passes and up.
        let (along, up) = if facing { (0.5 * u, w) } else { (w, 0.5 * u) };
        let mut left: Vec<[f64; 2]> = Vec::new();
        for motion in &motions[1..motions.len() - 1] {
            let points = points_of(motion, facing);
            for &point in &points {
                let height = part.lowest_near(point[0] + along) + up;
                prop_assert!(point[1] >= height - SLACK_MM, "{point:?} lies below {height}\n{motion:?}\n{text}");
                prop_assert!(point[1] <= TOP_MM + up + escape + SLACK_MM, "{point:?} above the stock\n{text}");
            }
            if motion.kind == MotionKind::Feed && points[0][1] == points[24][1] {
                left.push([points[0][1], points[24][0]]);
            }
        }
        // Every level above the profile's entry was cut from the start to the profile.
        let top = TOP_MM + up;
        // Where the profile rises at once there is nothing to cut.
        let at_start = part.points.iter().filter(|point| point[0] < 1e-6 - BEFORE_MM).map(|point| point[1]);
        let lowest = at_start.fold(10.0, f64::max) + up + depth;
        let mut level = top - depth;
        while level > lowest {
            prop_assert!(left.iter().any(|cut| (cut[0] - level).abs() < 1e-4), "no pass at {level}\n{text}");
            level -= depth;
        }
        prop_assert_eq!(motions.last().unwrap().end_mm, motions[0].end_mm);
    }

    #[test]
    fn extreme_words_end_in_a_fault_or_in_few_motions(
        strokes in strokes(true),
        code in prop::sample::select(&["G71", "G72"][..]),
        depth in prop::sample::select(&[1e-6, 1e-3, 900_000.0][..]),
        escape in prop::sample::select(&[0.0, 1e-6, 900_000.0][..]),
        u in prop::sample::select(&[0.0, -5.0, 900_000.0, -900_000.0][..]),
    ) {
        let facing = code == "G72";
        let part = part(&strokes, facing, if facing { " U0" } else { " W0" });
        let (motions, faults) = read(&program(code, &part, [depth, escape, u, 0.0]));
        prop_assert!(motions.len() < 300_000, "{} motions", motions.len());
        for fault in faults {
            prop_assert!(fault.hint.is_some(), "{}", fault.message);
        }
    }
}
