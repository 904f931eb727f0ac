//! The committed parts against the closed forms they stand for, and against LinuxCNC's interpreter.
//!
//! The parts are read here by a few lines that know no more than these files need, and share
//! nothing with the library.

use std::f64::consts::PI;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Tolerance stated in the header of every curve, mm.
const PROMISE_MM: f64 = 0.5e-3;
/// Coordinates are printed to 1 nm: centre and start of an arc are each off by at most half of that
/// on either axis.
const PRINTED_MM: f64 = 2e-6;

const CURVES: [&str; 4] = ["circle.ngc", "ellipse.ngc", "eight.ngc", "star.ngc"];

struct Arc {
    start: [f64; 2],
    end: [f64; 2],
    center: [f64; 2],
    /// Counter-clockwise angle from start to end.
    sweep: f64,
}

impl Arc {
    fn point(&self, share: f64) -> [f64; 2] {
        let (sin, cos) = (self.sweep * share).sin_cos();
        let r = sub(self.start, self.center);
        [
            self.center[0] + r[0] * cos - r[1] * sin,
            self.center[1] + r[0] * sin + r[1] * cos,
        ]
    }

    fn heading(&self, share: f64) -> f64 {
        let r = sub(self.point(share), self.center);
        r[1].atan2(r[0]) + self.sweep.signum() * PI / 2.0
    }
}

fn sub(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn part(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../parts")
        .join(name)
}

/// The arcs of a part that consists of G2 and G3 with I and J only.
fn arcs(name: &str) -> Vec<Arc> {
    let text = std::fs::read_to_string(part(name)).expect("the part is in the repository");
    let mut at = [0.0, 0.0];
    let mut arcs = Vec::new();
    for line in text.lines().filter(|line| !line.starts_with('(')) {
        let words: Vec<(char, f64)> = line
            .split_whitespace()
            .map(|word| {
                (
                    word.chars().next().unwrap_or(' '),
                    word[1..].parse().expect("a number behind the letter"),
                )
            })
            .collect();
        let value = |letter| {
            words
                .iter()
                .find(|word| word.0 == letter)
                .map(|word| word.1)
        };
        assert!(words[0] != ('G', 1.0), "{name} has a line: {line}");
        let end = [value('X').unwrap_or(at[0]), value('Y').unwrap_or(at[1])];
        if let (Some(i), Some(j)) = (value('I'), value('J')) {
            let center = [at[0] + i, at[1] + j];
            let angle = |p: [f64; 2]| (p[1] - center[1]).atan2(p[0] - center[0]);
            let turn = (angle(end) - angle(at)).rem_euclid(2.0 * PI);
            let clockwise = words.contains(&('G', 2.0));
            let sweep = match (end == at, clockwise) {
                (true, true) => -2.0 * PI,
                (true, false) => 2.0 * PI,
                (false, true) => turn - 2.0 * PI,
                (false, false) => turn,
            };
            arcs.push(Arc {
                start: at,
                end,
                center,
                sweep,
            });
        }
        at = end;
    }
    arcs
}

/// The point of the curve nearest to `p`, searched a little behind and ahead of the parameter
/// `from`: distance, parameter.
fn nearest(curve: fn(f64) -> [f64; 2], p: [f64; 2], from: f64) -> (f64, f64) {
    let at = |a: f64| distance(curve(a), p);
    let tries = (-20..=60).map(|i| from + f64::from(i) * 1e-3);
    let best = tries
        .min_by(|a, b| at(*a).total_cmp(&at(*b)))
        .expect("there are candidates");
    let (mut low, mut high) = (best - 2e-3, best + 2e-3);
    for _ in 0..60 {
        let (a, b) = (high - 0.618 * (high - low), low + 0.618 * (high - low));
        if at(a) < at(b) {
            high = b;
        } else {
            low = a;
        }
    }
    (at(0.5 * (low + high)), 0.5 * (low + high))
}

fn closed_form(name: &str) -> fn(f64) -> [f64; 2] {
    match name {
        "circle.ngc" => |a| [10.0 * (1.0 - a.cos()), 10.0 * a.sin()],
        "ellipse.ngc" => |a| [20.0 * a.cos(), 10.0 * a.sin()],
        "eight.ngc" => |a| [15.0 * a.sin(), 10.0 * (2.0 * a).sin()],
        "star.ngc" => |a| {
            let r = 12.0 + 4.0 * (5.0 * a).cos();
            [r * a.cos(), r * a.sin()]
        },
        other => panic!("no closed form of {other}"),
    }
}

#[test]
fn every_arc_lies_within_half_a_micrometre_of_its_closed_form() {
    for name in CURVES {
        let curve = closed_form(name);
        let (mut a, mut worst) = (0.0, 0.0_f64);
        for arc in arcs(name) {
            // Steps within the search window of `nearest`.
            let length = arc.sweep.abs() * distance(arc.start, arc.center);
            let steps = (length / 0.1).ceil().max(8.0);
            for step in 0..=steps as u32 {
                let (error, found) = nearest(curve, arc.point(f64::from(step) / steps), a);
                worst = worst.max(error);
                a = found;
            }
        }
        assert!(worst <= PROMISE_MM, "{name}: {worst} mm");
        // The walk along the arcs went once round the closed form, in its direction.
        assert!(
            (a - 2.0 * PI).abs() < 1e-3,
            "{name}: ended at parameter {a}"
        );
    }
}

#[test]
fn arcs_meet_end_to_end_and_tangent_and_close() {
    for name in CURVES {
        let arcs = arcs(name);
        for (i, arc) in arcs.iter().enumerate() {
            let next = &arcs[(i + 1) % arcs.len()];
            assert!(
                distance(arc.point(1.0), arc.end) <= PRINTED_MM,
                "{name} arc {i}"
            );
            assert_eq!(arc.end, next.start, "{name} arc {i}");
            let kink = (next.heading(0.0) - arc.heading(1.0) + PI).rem_euclid(2.0 * PI) - PI;
            // Two centres and three points are off by a printed step each, seen over the radius.
            let radius = distance(arc.start, arc.center).min(distance(next.start, next.center));
            assert!(
                kink.abs() <= 4.0 * PRINTED_MM / radius,
                "{name} arc {i}: kink of {kink} rad"
            );
        }
    }
}

#[test]
fn a_header_says_how_many_arcs_there_are() {
    for name in &CURVES[1..] {
        let text = std::fs::read_to_string(part(name)).unwrap();
        assert!(
            text.contains(&format!("({} arcs, ", arcs(name).len())),
            "{name}"
        );
    }
}

#[test]
fn linuxcnc_accepts_every_part() {
    if !crate::rs274::is_installed() {
        return;
    }
    let mut seen = 0;
    for entry in std::fs::read_dir(part("")).unwrap() {
        let path = entry.unwrap().path();
        let output = Command::new("rs274")
            .arg("-g")
            .arg(&path)
            .stdin(Stdio::null())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stdout).into_owned()
            + &String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{}: {said}", path.display());
        assert!(
            said.contains("PROGRAM_END()"),
            "{} stops early: {said}",
            path.display()
        );
        seen += 1;
    }
    assert!(seen >= 7, "only {seen} parts");
}
