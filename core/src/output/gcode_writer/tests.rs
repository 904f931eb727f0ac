//! The program read back: as close to the setpoints as it promises, in both directions, as fast, with its events in place.

use proptest::prelude::*;

use super::*;
use crate::gcode::canon::Event;
use crate::trace::tests::row as at_rest;

/// Half the printed step on three axes is inside the tolerance already; this is for rounding of the test's own sums.
const ROUNDING_MM: f64 = 1e-9;
const DT_S: f64 = 1e-3;

fn row(k: usize, cmd_mm: [f64; 3], cutting: bool) -> Row {
    let commanded = if cutting { Commanded::Cut } else { Commanded::Rapid };
    Row { cutting, commanded, path_mm: cmd_mm, cmd_mm, act_mm: cmd_mm, foot_mm: cmd_mm, ..at_rest(k as f64 * DT_S) }
}

fn program(axes: usize, points: &[([f64; 3], bool)]) -> String {
    let mut writer = GcodeWriter::new(Vec::new(), axes, &["test"]).unwrap();
    for (k, (point, cutting)) in points.iter().enumerate() {
        writer.row(&row(k, *point, *cutting)).unwrap();
    }
    String::from_utf8(writer.finish().unwrap()).unwrap()
}

/// A block read back: whether it cuts, where it ends, its feed.
struct Block {
    cutting: bool,
    end: [f64; 3],
    feed_mm_min: f64,
}

/// The blocks of a program that starts at `at`.
fn read(text: &str, mut at: [f64; 3]) -> Vec<Block> {
    let mut feed_mm_min = 0.0;
    let mut blocks = Vec::new();
    for line in text.lines().filter(|line| line.starts_with("G0") || line.starts_with("G1")) {
        for word in line.split_whitespace().skip(1) {
            let value: f64 = word[1..].parse().unwrap();
            match &word[..1] {
                "F" => feed_mm_min = value,
                axis => at["XYZ".find(axis).unwrap()] = value,
            }
        }
        blocks.push(Block { cutting: line.starts_with("G1"), end: at, feed_mm_min });
    }
    blocks
}

/// Discrete Fréchet distance test on two polylines, by the free-space diagram: an oracle that knows nothing of cones.
fn within_frechet(p: &[[f64; 3]], q: &[[f64; 3]], limit: f64) -> bool {
    // Reachable interval on the left edge of each cell (a point of p against a segment of q), column by column.
    let free = |point: [f64; 3], a: [f64; 3], b: [f64; 3]| -> Option<(f64, f64)> {
        let d = [0, 1, 2].map(|i| b[i] - a[i]);
        let o = [0, 1, 2].map(|i| a[i] - point[i]);
        let dot = |x: [f64; 3], y: [f64; 3]| x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
        let (aa, bb, cc) = (dot(d, d), dot(d, o), dot(o, o) - limit * limit);
        if aa == 0.0 {
            return (cc <= 0.0).then_some((0.0, 1.0));
        }
        let root = bb * bb - aa * cc;
        if root < 0.0 {
            return None;
        }
        let (low, high) = ((-bb - root.sqrt()) / aa, (-bb + root.sqrt()) / aa);
        (low <= 1.0 && high >= 0.0).then_some((low.max(0.0), high.min(1.0)))
    };
    let (n, m) = (p.len() - 1, q.len() - 1);
    let close = |a: [f64; 3], b: [f64; 3]| (a[0] - b[0]).hypot(a[1] - b[1]).hypot(a[2] - b[2]) <= limit;
    if !close(p[0], q[0]) || !close(p[n], q[m]) {
        return false;
    }
    // left[j]: reachable part of {p[i]} x q[j..j+1]; bottom[i][j]: of p[i..i+1] x {q[j]}.
    let mut left: Vec<Option<(f64, f64)>> = Vec::new();
    for j in 0..m {
        let whole = j == 0 || left[j - 1].is_some_and(|(_, high)| high >= 1.0);
        left.push(free(p[0], q[j], q[j + 1]).filter(|(low, _)| whole && *low <= 0.0));
    }
    let mut corner_reached = true;
    for i in 0..n {
        let mut next = Vec::with_capacity(m);
        let mut bottom = free(q[0], p[i], p[i + 1]).filter(|(low, _)| corner_reached && *low <= 0.0);
        corner_reached = bottom.is_some_and(|(_, high)| high >= 1.0);
        for j in 0..m {
            let right_free = free(p[i + 1], q[j], q[j + 1]);
            let top_free = free(q[j + 1], p[i], p[i + 1]);
            let right = match (bottom, left[j], right_free) {
                (Some(_), _, free) => free,
                (None, Some((from, _)), Some((low, high))) if from <= high => Some((low.max(from), high)),
                _ => None,
            };
            bottom = match (left[j], bottom, top_free) {
                (Some(_), _, free) => free,
                (None, Some((from, _)), Some((low, high))) if from <= high => Some((low.max(from), high)),
                _ => None,
            };
            next.push(right);
        }
        left = next;
    }
    left[m - 1].is_some_and(|(_, high)| high >= 1.0 - 1e-9)
}

fn assert_close_both_ways(points: &[([f64; 3], bool)], text: &str) {
    let setpoints: Vec<[f64; 3]> = points.iter().map(|point| point.0).collect();
    let mut path = vec![setpoints[0]];
    path.extend(read(text, setpoints[0]).iter().map(|block| block.end));
    if path.len() == 1 {
        path.push(path[0]);
    }
    assert!(within_frechet(&setpoints, &path, TOLERANCE_MM + ROUNDING_MM), "the path leaves the setpoints:\n{text}");
}

#[test]
fn the_oracle_itself_tells_near_from_far() {
    let straight = [[0.0; 3], [1.0, 0.0, 0.0]];
    let bent = [[0.0; 3], [0.5, 0.5, 0.0], [1.0, 0.0, 0.0]];
    assert!(within_frechet(&bent, &straight, 0.5001));
    assert!(!within_frechet(&bent, &straight, 0.4999));
    let back = [[0.0; 3], [0.7, 0.0, 0.0], [0.3, 0.0, 0.0], [1.0, 0.0, 0.0]];
    assert!(within_frechet(&back, &straight, 0.2001) && !within_frechet(&back, &straight, 0.1999));
}

#[test]
fn a_drilling_cycle_keeps_its_rapids_events_and_order() {
    let mut writer = GcodeWriter::new(Vec::new(), 3, &["part (copy) 100%"]).unwrap();
    let event = |writer: &mut GcodeWriter<Vec<u8>>, kind| {
        let event = Event { line: 1, kind };
        writer.event(0.0, &TimedEvent { tau_s: 0.0, duration_s: 0.0, event }).unwrap();
    };
    let mut k = 0;
    let mut go = |writer: &mut GcodeWriter<Vec<u8>>, from: [f64; 3], to: [f64; 3], cutting: bool| {
        for step in 1..=100 {
            let share = f64::from(step) / 100.0;
            writer.row(&row(k, [0, 1, 2].map(|i| from[i] + share * (to[i] - from[i])), cutting)).unwrap();
            k += 1;
        }
    };
    event(&mut writer, EventKind::SpindleSpeed { rpm: 8000.0 });
    event(&mut writer, EventKind::MCode { code: 3, p: None, q: None });
    go(&mut writer, [0.0; 3], [0.0, 0.0, 5.0], false);
    go(&mut writer, [0.0, 0.0, 5.0], [20.0, 0.0, 5.0], false);
    go(&mut writer, [20.0, 0.0, 5.0], [20.0, 0.0, -2.0], true);
    event(&mut writer, EventKind::Dwell { seconds: 0.5 });
    go(&mut writer, [20.0, 0.0, -2.0], [20.0, 0.0, 5.0], false);
    event(&mut writer, EventKind::ProgramEnd);
    let text = String::from_utf8(writer.finish().unwrap()).unwrap();
    assert_eq!(
        text,
        "(part ?copy? 100?)\n(straight blocks within 1 um of the setpoints; mm, mm/min)\nG21 G17 G90 G94 G64 P0.001\n\
         S8000\nM3\nG0 Z5\nG0 X20 Y0\nG1 Z-2 F4200\nG4 P0.5\nG0 Z5\nM2\n"
    );
}

#[test]
fn cuts_follow_the_correction_rapids_the_program_and_rests_nothing() {
    let mut writer = GcodeWriter::new(Vec::new(), 2, &["test"]).unwrap();
    let offset = |k: usize| 0.004 * (0.3 * k as f64).sin();
    for k in 0..400 {
        let x = 0.05 * k.min(300) as f64;
        let commanded = match k {
            0..100 => Commanded::Rapid,
            300.. => Commanded::Rest,
            _ => Commanded::Cut,
        };
        let row = Row { commanded, path_mm: [x, 0.0, 0.0], cmd_mm: [x, offset(k), 0.0], ..row(k, [0.0; 3], false) };
        writer.row(&row).unwrap();
    }
    let text = String::from_utf8(writer.finish().unwrap()).unwrap();
    let blocks = read(&text, [0.0; 3]);
    assert_eq!(blocks[0].end, [4.95, 0.0, 0.0]);
    // Aside before the cut, as far as its first setpoint lies beside the path.
    assert_eq!((blocks[1].end, blocks[1].cutting), ([4.95, (offset(100) * 1e5).round() / 1e5, 0.0], false));
    let cut: Vec<[f64; 3]> = blocks[1..].iter().map(|block| block.end).collect();
    let setpoints = (100..300).map(|k| [0.05 * k as f64, offset(k), 0.0]);
    let corrected: Vec<[f64; 3]> = std::iter::once(cut[0]).chain(setpoints).collect();
    assert!(blocks[2..].iter().all(|block| block.cutting));
    assert!(within_frechet(&corrected, &cut, TOLERANCE_MM + ROUNDING_MM));
}

#[test]
fn a_program_that_starts_cutting_names_its_start_first() {
    let points: Vec<([f64; 3], bool)> = (0..50).map(|k| ([1.0 + 0.05 * f64::from(k), 2.0, 0.0], true)).collect();
    let text = program(2, &points);
    assert!(text.contains("\nG0 X1 Y2\nG1 X3.45 F3000\nM2\n"), "{text}");
}

#[test]
fn a_position_that_is_no_number_is_an_error_and_not_a_block() {
    let mut writer = GcodeWriter::new(Vec::new(), 2, &[""; 0]).unwrap();
    for wrong in [f64::NAN, f64::INFINITY, 1e300] {
        let error = writer.row(&row(0, [0.0, wrong, 0.0], true)).unwrap_err();
        assert!(error.to_string().contains("no program can hold it"));
    }
}

#[test]
fn a_circle_at_50_mm_s_takes_few_blocks() {
    let points: Vec<([f64; 3], bool)> = (0..=1256)
        .map(|k| (0.005 * f64::from(k)).sin_cos())
        .map(|(s, c)| ([10.0 * (1.0 - c), 10.0 * s, 0.0], true))
        .collect();
    let text = program(2, &points);
    assert_close_both_ways(&points, &text);
    let blocks = read(&text, points[0].0);
    // The longest chord between circles 1 um inside and outside is 0.4 mm; the room for rounding keeps the eighth setpoint of
    // 0.05 mm out of it. So seven go into a block, and a rapid names the start.
    assert_eq!(blocks.len(), 1 + 1256_usize.div_ceil(7));
    assert!(blocks.iter().skip(1).all(|block| (block.feed_mm_min - 3000.0).abs() <= 0.1));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn the_written_path_and_the_setpoints_are_within_a_micrometre_of_each_other(
        turns in prop::collection::vec((-0.3..0.3_f64, -0.1..0.1_f64, 0.0..0.06_f64, prop::bool::weighted(0.9)), 2..250),
        noise_mm in prop::sample::select(vec![0.0, 3e-4, 3e-3]),
        axes in 2..=3_usize,
    ) {
        let (mut heading, mut at, mut points) = (0.0_f64, [0.0; 3], Vec::new());
        for (k, (turn, climb, step, cutting)) in turns.into_iter().enumerate() {
            heading += turn;
            at = [at[0] + step * heading.cos(), at[1] + step * heading.sin(), if axes == 3 { at[2] + step * climb } else { 0.0 }];
            let shake = noise_mm * (k as f64 * 12.9898).sin();
            points.push(([at[0] + shake, at[1] - shake, at[2]], cutting));
        }
        let text = program(axes, &points);
        assert_close_both_ways(&points, &text);
        // No block is slower than the setpoints it stands for, none faster than the fastest of all.
        let speed = |pair: &[([f64; 3], bool)]| {
            let d = [0, 1, 2].map(|i| pair[1].0[i] - pair[0].0[i]);
            d[0].hypot(d[1]).hypot(d[2]) / DT_S * 60.0
        };
        let fastest = points.windows(2).map(speed).fold(0.0, f64::max);
        for block in read(&text, points[0].0).iter().filter(|block| block.cutting) {
            prop_assert!(block.feed_mm_min > 0.0 && block.feed_mm_min <= fastest + 0.1);
        }
    }
}
