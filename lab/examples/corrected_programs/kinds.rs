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

use feedwright::{ArcFit, FitPoint};
use feedwright_gcode::canon::Shape;
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
    let mut text = format!("G0 X{:.5} Y{:.5}\n", points[0].at_mm[0], points[0].at_mm[1]);
    for motion in ArcFit::new(&points, 1e-4, 1e5).motions() {
        let ([x0, y0, _], [x, y, _]) = (motion.start_mm, motion.end_mm);
        let _ = match motion.shape {
            Shape::Arc {
                center_mm: [cx, cy, _],
                turns,
                ..
            } => {
                let code = if turns > 0 { "G3" } else { "G2" };
                writeln!(
                    text,
                    "{code} X{x:.5} Y{y:.5} I{:.5} J{:.5}",
                    cx - x0,
                    cy - y0
                )
            }
            _ => writeln!(text, "G1 X{x:.5} Y{y:.5}"),
        };
    }
    text
}

fn smooth(draw: &mut Draw) -> (String, String) {
    let (radius, other) = (draw.between(5.0, 25.0), draw.between(0.4, 0.9));
    match draw.one_of(4) {
        0 => (
            format!(
                "G0 X{radius:.3} Y0\nG3 X{radius:.3} Y0 I{:.3} J0\n",
                -radius
            ),
            format!("circle {radius:.0} mm"),
        ),
        1 => {
            let at = |t: f64| {
                [
                    radius * libm::cos(TAU * t),
                    other * radius * libm::sin(TAU * t),
                ]
            };
            (
                arcs(at),
                format!("ellipse {radius:.0} x {:.0} mm", other * radius),
            )
        }
        2 => {
            let at = |t: f64| {
                [
                    radius * libm::sin(TAU * t),
                    other * radius * libm::sin(2.0 * TAU * t),
                ]
            };
            (arcs(at), format!("eight {radius:.0} mm"))
        }
        _ => {
            let depth = 0.3 * other;
            let petals = 3 + draw.one_of(4);
            let at = |t: f64| {
                let r = radius * (1.0 + depth * libm::cos(petals as f64 * TAU * t));
                [r * libm::cos(TAU * t), r * libm::sin(TAU * t)]
            };
            (chords(at, 0.05), format!("rose {petals} of {radius:.0} mm"))
        }
    }
}

/// Corners of a rounded rectangle around the origin, counter-clockwise, from the middle of its
/// lower side.
fn rounded_rectangle(half: [f64; 2], radius: f64) -> String {
    let [a, b] = half;
    let r = radius.min(0.9 * a.min(b));
    format!(
        "G1 X{:.3} Y{:.3}\nG3 X{:.3} Y{:.3} I0 J{r:.3}\nG1 Y{:.3}\nG3 X{:.3} Y{:.3} I{:.3} J0\nG1 X{:.3}\nG3 X{:.3} Y{:.3} I0 J{:.3}\n\
         G1 Y{:.3}\nG3 X{:.3} Y{:.3} I{r:.3} J0\nG1 X0\n",
        a - r,
        -b,
        a,
        r - b,
        b - r,
        a - r,
        b,
        -r,
        r - a,
        -a,
        b - r,
        -r,
        r - b,
        r - a,
        -b
    )
}

fn rounded(draw: &mut Draw) -> (String, String) {
    let (side, radius) = (draw.between(20.0, 200.0), draw.between(2.0, 15.0));
    let text = format!(
        "G0 X0 Y{:.3}\n{}",
        -0.5 * side,
        rounded_rectangle([0.5 * side; 2], radius.min(0.4 * side))
    );
    (
        text,
        format!("square {side:.0} mm R{:.0}", radius.min(0.4 * side)),
    )
}

/// Strokes of letters in a box of 10 by 14: a start, then ends of lines, and of arcs with the
/// center relative to their start (direction 1 is counter-clockwise).
type Stroke = &'static [(f64, f64, f64, f64, i8)];
const LETTERS: [(char, &[Stroke]); 8] = [
    (
        'A',
        &[
            &[
                (0.0, 0.0, 0.0, 0.0, 0),
                (5.0, 14.0, 0.0, 0.0, 0),
                (10.0, 0.0, 0.0, 0.0, 0),
            ],
            &[(2.0, 5.6, 0.0, 0.0, 0), (8.0, 5.6, 0.0, 0.0, 0)],
        ],
    ),
    (
        'B',
        &[&[
            (0.0, 0.0, 0.0, 0.0, 0),
            (0.0, 14.0, 0.0, 0.0, 0),
            (5.0, 14.0, 0.0, 0.0, 0),
            (5.0, 7.0, 0.0, -3.5, -1),
            (0.0, 7.0, 0.0, 0.0, 0),
            (5.0, 7.0, 0.0, 0.0, 0),
            (5.0, 0.0, 0.0, -3.5, -1),
            (0.0, 0.0, 0.0, 0.0, 0),
        ]],
    ),
    (
        'D',
        &[&[
            (0.0, 0.0, 0.0, 0.0, 0),
            (0.0, 14.0, 0.0, 0.0, 0),
            (2.0, 14.0, 0.0, 0.0, 0),
            (2.0, 0.0, 0.0, -7.0, -1),
            (0.0, 0.0, 0.0, 0.0, 0),
        ]],
    ),
    (
        'E',
        &[
            &[
                (9.0, 14.0, 0.0, 0.0, 0),
                (0.0, 14.0, 0.0, 0.0, 0),
                (0.0, 0.0, 0.0, 0.0, 0),
                (9.0, 0.0, 0.0, 0.0, 0),
            ],
            &[(0.0, 7.0, 0.0, 0.0, 0), (7.0, 7.0, 0.0, 0.0, 0)],
        ],
    ),
    (
        'N',
        &[&[
            (0.0, 0.0, 0.0, 0.0, 0),
            (0.0, 14.0, 0.0, 0.0, 0),
            (9.0, 0.0, 0.0, 0.0, 0),
            (9.0, 14.0, 0.0, 0.0, 0),
        ]],
    ),
    (
        'O',
        &[&[
            (10.0, 9.0, 0.0, 0.0, 0),
            (0.0, 9.0, -5.0, 0.0, 1),
            (0.0, 5.0, 0.0, 0.0, 0),
            (10.0, 5.0, 5.0, 0.0, 1),
            (10.0, 9.0, 0.0, 0.0, 0),
        ]],
    ),
    (
        'U',
        &[&[
            (0.0, 14.0, 0.0, 0.0, 0),
            (0.0, 5.0, 0.0, 0.0, 0),
            (10.0, 5.0, 5.0, 0.0, 1),
            (10.0, 14.0, 0.0, 0.0, 0),
        ]],
    ),
    (
        'C',
        &[&[
            (10.0, 11.0, 0.0, 0.0, 0),
            (0.0, 9.0, -5.0, -2.0, 1),
            (0.0, 5.0, 0.0, 0.0, 0),
            (10.0, 3.0, 5.0, 0.0, 1),
        ]],
    ),
];

fn letters(draw: &mut Draw) -> (String, String) {
    let scale = draw.between(8.0, 30.0) / 14.0;
    let (mut text, mut word) = (String::new(), String::new());
    for place in 0..4 {
        let (letter, strokes) = LETTERS[draw.one_of(7)];
        word.push(letter);
        for stroke in strokes {
            let x0 = 13.0 * f64::from(place);
            for (n, (x, y, i, j, turns)) in stroke.iter().enumerate() {
                let code = if n == 0 {
                    "G0"
                } else {
                    ["G2", "G1", "G3"][(turns + 1) as usize]
                };
                let _ = write!(text, "{code} X{:.3} Y{:.3}", scale * (x0 + x), scale * y);
                if *turns != 0 {
                    let _ = write!(text, " I{:.3} J{:.3}", scale * i, scale * j);
                }
                text.push('\n');
            }
        }
    }
    (text, format!("{word} of {:.0} mm", 14.0 * scale))
}

fn spline(draw: &mut Draw) -> (String, String) {
    let radius = draw.between(8.0, 30.0);
    let terms: Vec<[f64; 3]> = (2..6)
        .map(|k| {
            let most = 0.5 / (f64::from(k) * f64::from(k));
            [
                f64::from(k),
                draw.between(-most, most),
                draw.between(0.0, TAU),
            ]
        })
        .collect();
    let at = |t: f64| {
        let bends: f64 = terms
            .iter()
            .map(|[k, size, phase]| size * libm::cos(k * TAU * t + phase))
            .sum();
        let r = radius * (1.0 + bends);
        [r * libm::cos(TAU * t), r * libm::sin(TAU * t)]
    };
    (chords(at, 0.5), format!("spline of {radius:.0} mm"))
}

fn pocket(draw: &mut Draw) -> (String, String) {
    let (half, step) = (
        [draw.between(10.0, 35.0), draw.between(8.0, 25.0)],
        draw.between(1.5, 4.0),
    );
    let radius = draw.between(1.5, 6.0);
    let rings = 3 + draw.one_of(3);
    let mut text = String::new();
    for depth in 1..=2 {
        let inner = |ring: usize| half.map(|mm| (mm - step * ring as f64).max(2.0));
        let start = inner(rings - 1);
        let _ = writeln!(
            text,
            "G0 Z5\nG0 X0 Y{:.3}\nG0 Z{}\nG1 Z-{}",
            -start[1],
            2 - depth,
            depth
        );
        for ring in (0..rings).rev() {
            let [a, b] = inner(ring);
            let r = (radius + step * (rings - 1 - ring) as f64).min(0.9 * a.min(b));
            let _ = write!(
                text,
                "G1 Y{:.3}\n{}",
                -b,
                rounded_rectangle([a, b], r.min(12.0))
            );
        }
        text.push_str("G0 Z5\n");
    }
    (
        text,
        format!(
            "pocket {:.0} x {:.0} mm, {rings} rings",
            2.0 * half[0],
            2.0 * half[1]
        ),
    )
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
