//! Programs of six kinds, each drawn from a seed.
//!
//! | Kind | What |
//! |---|---|
//! | smooth | a circle; an ellipse or an eight of arcs within 0.1 um; a rose as lines of 0.05 mm |
//! | rounded | a square of 20 to 200 mm with corner radii of 2 to 15 mm |
//! | letters | four letters of lines and arcs, 8 to 30 mm high, with rapids between them |
//! | spline | a closed curve of four harmonics as lines of 0.5 mm |
//! | pocket | three to five rounded rectangles, one in the other, at two depths |
//! | steps | a staircase of 6 to 12 legs of 3 to 25 mm |
//!
//! Feedrates are 20 to 150 mm/s, evenly over their logarithm.

use std::f64::consts::TAU;
use std::fmt::Write;

use feedwright_gcode::canon::Shape;
use feedwright_plan::{ArcFit, FitPoint};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Names of the kinds.
pub(crate) const KINDS: [&str; 6] = ["smooth", "rounded", "letters", "spline", "pocket", "steps"];

/// Values drawn from a seed.
struct Draw(Xoshiro256PlusPlus);

impl Draw {
    fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.0.random::<f64>()
    }

    fn one_of(&mut self, count: usize) -> usize {
        ((self.0.random::<f64>() * count as f64) as usize).min(count - 1)
    }

    /// Feedrate, mm/min.
    fn feed(&mut self) -> f64 {
        (60.0 * 20.0 * libm::exp(self.between(0.0, libm::log(7.5)))).round()
    }
}

/// The text of a drawn program, and its description.
pub(crate) fn drawn(kind: &str, seed: u64) -> (String, String) {
    let number = KINDS.iter().position(|&name| name == kind).unwrap_or(0) as u64;
    let mut draw = Draw(Xoshiro256PlusPlus::seed_from_u64(1000 * seed + number));
    let feed = draw.feed();
    let (body, what) = match kind {
        "smooth" => smooth(&mut draw),
        "rounded" => rounded(&mut draw),
        "letters" => letters(&mut draw),
        "spline" => spline(&mut draw),
        "pocket" => pocket(&mut draw),
        _ => steps(&mut draw),
    };
    (
        format!("G21 G17 G90 G94 G64 F{feed}\n{body}M2\n"),
        format!("{what} F{feed:.0}"),
    )
}

/// A closed curve as chords of a length, from its points over 0 to 1.
fn chords(at: impl Fn(f64) -> [f64; 2], chord_mm: f64) -> String {
    let mut text = String::new();
    let [mut x, mut y] = at(0.0);
    let _ = writeln!(text, "G0 X{x:.4} Y{y:.4}\nG1");
    for k in 1..=200_000 {
        let [nx, ny] = at(f64::from(k) / 200_000.0);
        if libm::hypot(nx - x, ny - y) >= chord_mm || k == 200_000 {
            (x, y) = (nx, ny);
            let _ = writeln!(text, "X{x:.4} Y{y:.4}");
        }
    }
    text
}

/// A closed curve as arcs within 0.1 um.
fn arcs(at: impl Fn(f64) -> [f64; 2]) -> String {
    let point = |k: u32| {
        let t = f64::from(k) / 4000.0;
        let ([x, y], [ax, ay], [bx, by]) = (at(t), at(t - 1e-6), at(t + 1e-6));
        let length = libm::hypot(bx - ax, by - ay);
        FitPoint {
            at_mm: [x, y, 0.0],
            tangent: [(bx - ax) / length, (by - ay) / length],
            feed_mm_s: 1.0,
        }
    };
    let points: Vec<FitPoint> = (0..=4000).map(point).collect();
    let [x, y, _] = points[0].at_mm;
    let mut text = format!("G0 X{x:.5} Y{y:.5}\n");
    for motion in ArcFit::new(&points, 1e-4, 1e5).motions() {
        let ([x0, y0, _], [x, y, _]) = (motion.start_mm, motion.end_mm);
        let _ = match motion.shape {
            Shape::Arc {
                center_mm, turns, ..
            } => {
                let code = if turns > 0 { "G3" } else { "G2" };
                let [i, j] = [center_mm[0] - x0, center_mm[1] - y0];
                writeln!(text, "{code} X{x:.5} Y{y:.5} I{i:.5} J{j:.5}")
            }
            _ => writeln!(text, "G1 X{x:.5} Y{y:.5}"),
        };
    }
    text
}

fn smooth(draw: &mut Draw) -> (String, String) {
    let (radius, other) = (draw.between(5.0, 25.0), draw.between(0.4, 0.9));
    let around = |t: f64| (libm::cos(TAU * t), libm::sin(TAU * t));
    match draw.one_of(4) {
        0 => {
            let text = format!(
                "G0 X{radius:.3} Y0\nG3 X{radius:.3} Y0 I{:.3} J0\n",
                -radius
            );
            (text, format!("circle {radius:.0} mm"))
        }
        1 => {
            let at = |t: f64| [radius * around(t).0, other * radius * around(t).1];
            (
                arcs(at),
                format!("ellipse {radius:.0} x {:.0} mm", other * radius),
            )
        }
        2 => {
            let twice = |t: f64| libm::sin(2.0 * TAU * t);
            let at = |t: f64| [radius * around(t).1, other * radius * twice(t)];
            (arcs(at), format!("eight {radius:.0} mm"))
        }
        _ => {
            let depth = 0.3 * other;
            let petals = 3 + draw.one_of(4);
            let at = |t: f64| {
                let r = radius * (1.0 + depth * libm::cos(petals as f64 * TAU * t));
                [r * around(t).0, r * around(t).1]
            };
            (chords(at, 0.05), format!("rose {petals} of {radius:.0} mm"))
        }
    }
}

/// Corners of a rounded rectangle around the origin, counter-clockwise, from the middle of its
/// lower side.
fn rounded_rectangle([a, b]: [f64; 2], radius: f64) -> String {
    let r = radius.min(0.9 * a.min(b));
    let (p, q) = (a - r, b - r);
    let (na, nb, np, nq, nr) = (-a, -b, -p, -q, -r);
    format!(
        "G1 X{p:.3} Y{nb:.3}\nG3 X{a:.3} Y{nq:.3} I0 J{r:.3}\nG1 Y{q:.3}\nG3 X{p:.3} Y{b:.3} I{nr:.3} J0\n\
         G1 X{np:.3}\nG3 X{na:.3} Y{q:.3} I0 J{nr:.3}\nG1 Y{nq:.3}\nG3 X{np:.3} Y{nb:.3} I{r:.3} J0\nG1 X0\n"
    )
}

fn rounded(draw: &mut Draw) -> (String, String) {
    let (side, radius) = (draw.between(20.0, 200.0), draw.between(2.0, 15.0));
    let radius = radius.min(0.4 * side);
    let rectangle = rounded_rectangle([0.5 * side; 2], radius);
    let text = format!("G0 X0 Y{:.3}\n{rectangle}", -0.5 * side);
    (text, format!("square {side:.0} mm R{radius:.0}"))
}

/// Strokes of letters in a box of 10 by 14: a start, then ends of lines, and of arcs with the
/// center relative to their start, and a direction (1 is counter-clockwise).
const LETTERS: [(char, &str); 7] = [
    ('A', "0,0 5,14 10,0;2,5.6 8,5.6"),
    ('B', "0,0 0,14 5,14 5,7,0,-3.5,-1 0,7 5,7 5,0,0,-3.5,-1 0,0"),
    ('D', "0,0 0,14 2,14 2,0,0,-7,-1 0,0"),
    ('E', "9,14 0,14 0,0 9,0;0,7 7,7"),
    ('N', "0,0 0,14 9,0 9,14"),
    ('O', "10,9 0,9,-5,0,1 0,5 10,5,5,0,1 10,9"),
    ('U', "0,14 0,5 10,5,5,0,1 10,14"),
];

fn letters(draw: &mut Draw) -> (String, String) {
    let scale = draw.between(8.0, 30.0) / 14.0;
    let (mut text, mut word) = (String::new(), String::new());
    for place in 0..4 {
        let (letter, strokes) = LETTERS[draw.one_of(LETTERS.len())];
        word.push(letter);
        for stroke in strokes.split(';') {
            let x0 = 13.0 * f64::from(place);
            for (n, point) in stroke.split(' ').enumerate() {
                let numbers: Vec<f64> = point.split(',').filter_map(|n| n.parse().ok()).collect();
                let (x, y) = (scale * (x0 + numbers[0]), scale * numbers[1]);
                let _ = match numbers[2..] {
                    [i, j, turns] => {
                        let code = if turns > 0.0 { "G3" } else { "G2" };
                        let (i, j) = (scale * i, scale * j);
                        writeln!(text, "{code} X{x:.3} Y{y:.3} I{i:.3} J{j:.3}")
                    }
                    _ => writeln!(text, "G{} X{x:.3} Y{y:.3}", u8::from(n > 0)),
                };
            }
        }
    }
    (text, format!("{word} of {:.0} mm", 14.0 * scale))
}

fn spline(draw: &mut Draw) -> (String, String) {
    let radius = draw.between(8.0, 30.0);
    let terms: Vec<[f64; 3]> = (2..6)
        .map(|k| {
            let k = f64::from(k);
            let most = 0.5 / (k * k);
            [k, draw.between(-most, most), draw.between(0.0, TAU)]
        })
        .collect();
    let at = |t: f64| {
        let bend = |[k, size, phase]: &[f64; 3]| size * libm::cos(k * TAU * t + phase);
        let bends: f64 = terms.iter().map(bend).sum();
        let r = radius * (1.0 + bends);
        [r * libm::cos(TAU * t), r * libm::sin(TAU * t)]
    };
    (chords(at, 0.5), format!("spline of {radius:.0} mm"))
}

fn pocket(draw: &mut Draw) -> (String, String) {
    let half = [draw.between(10.0, 35.0), draw.between(8.0, 25.0)];
    let step = draw.between(1.5, 4.0);
    let radius = draw.between(1.5, 6.0);
    let rings = 3 + draw.one_of(3);
    let mut text = String::new();
    for depth in 1..=2 {
        let inner = |ring: usize| half.map(|mm| (mm - step * ring as f64).max(2.0));
        let (y, above) = (-inner(rings - 1)[1], 2 - depth);
        let _ = writeln!(text, "G0 Z5\nG0 X0 Y{y:.3}\nG0 Z{above}\nG1 Z-{depth}");
        for ring in (0..rings).rev() {
            let [a, b] = inner(ring);
            let r = (radius + step * (rings - 1 - ring) as f64).min(0.9 * a.min(b));
            let rectangle = rounded_rectangle([a, b], r.min(12.0));
            let _ = write!(text, "G1 Y{:.3}\n{rectangle}", -b);
        }
        text.push_str("G0 Z5\n");
    }
    let [x, y] = half.map(|mm| 2.0 * mm);
    (text, format!("pocket {x:.0} x {y:.0} mm, {rings} rings"))
}

fn steps(draw: &mut Draw) -> (String, String) {
    let count = 6 + draw.one_of(7);
    let (mut x, mut y) = (0.0, 0.0);
    let mut text = "G0 X0 Y0\nG1\n".to_owned();
    for leg in 0..count {
        let length = draw.between(3.0, 25.0);
        if leg % 2 == 0 {
            x += length;
        } else {
            y += length;
        }
        let _ = writeln!(text, "X{x:.3} Y{y:.3}");
    }
    (text, format!("{count} steps"))
}
