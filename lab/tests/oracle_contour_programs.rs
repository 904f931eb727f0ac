//! The built-in contours as G-code, read again: every point of a program is on the closed form of
//! its contour, and the other way round.

use std::f64::consts::TAU;

use feedwright_gcode::{Reader, Settings};
use feedwright_lab::{CONTOURS, contour, contour_program};
use feedwright_plan::{Piece, Step};
use feedwright_sim::path_steps;

const TOLERANCE_MM: f64 = 1e-4;
/// Digits of the program, and chords between the points that are looked at.
const DIGITS_MM: f64 = 3e-6;

fn cuts(text: &str) -> Vec<Piece> {
    let reader = Reader::from_text("contour.ngc", text, Settings::default()).unwrap();
    let steps = path_steps(reader.map(Result::unwrap));
    let piece = |step: Step| match step {
        Step::Piece(piece) if piece.cutting => Some(piece),
        _ => None,
    };
    steps.map(Result::unwrap).filter_map(piece).collect()
}

/// Points of the pieces, so close that chords between them deviate by nothing.
fn points(pieces: &[Piece]) -> Vec<[f64; 2]> {
    let of = |piece: &Piece| {
        let count = (piece.length_mm / 0.005).ceil().max(1.0);
        let at = |k: u32| {
            piece
                .curve
                .at(piece.length_mm * f64::from(k) / count)
                .position_mm
        };
        (0..=count as u32)
            .map(|k| {
                let [x, y, _] = at(k);
                [x, y]
            })
            .collect::<Vec<_>>()
    };
    pieces.iter().flat_map(of).collect()
}

/// Closed forms, as an independent definition of the curves, by the angle; distance by Newton steps
/// from the nearest sample.
fn closed_form(name: &str) -> Option<fn(f64) -> [f64; 2]> {
    match name {
        "circle" => Some(|a| [10.0 * (1.0 - a.cos()), 10.0 * a.sin()]),
        "ellipse" => Some(|a| [20.0 * a.cos(), 10.0 * a.sin()]),
        "eight" => Some(|a| [15.0 * a.sin(), 10.0 * (2.0 * a).sin()]),
        "star" => Some(|a| {
            let r = 12.0 + 4.0 * (5.0 * a).cos();
            [r * a.cos(), r * a.sin()]
        }),
        _ => None,
    }
}

/// Distance of a point to a polyline of samples that are closer than what chords lose.
fn distance_mm(samples: &[[f64; 2]], [x, y]: [f64; 2]) -> f64 {
    let to_segment = |ends: &[[f64; 2]]| {
        let [[ax, ay], [bx, by]] = [ends[0], ends[1]];
        let (dx, dy) = (bx - ax, by - ay);
        let square = dx * dx + dy * dy;
        let t = if square > 0.0 {
            (((x - ax) * dx + (y - ay) * dy) / square).clamp(0.0, 1.0)
        } else {
            0.0
        };
        (x - ax - t * dx).hypot(y - ay - t * dy)
    };
    samples
        .windows(2)
        .map(to_segment)
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn closed_forms_are_kept_both_ways() {
    for name in ["circle", "ellipse", "eight", "star"] {
        let form = closed_form(name).unwrap();
        let program = contour_program(contour(name).unwrap(), 50.0, TOLERANCE_MM).unwrap();
        let cut = points(&cuts(&program.text));
        let exact: Vec<[f64; 2]> = (0..=20_000)
            .map(|k| form(TAU * f64::from(k) / 20_000.0))
            .collect();
        let far = |from: &[[f64; 2]], to: &[[f64; 2]]| {
            from.iter()
                .step_by(29)
                .map(|point| distance_mm(to, *point))
                .fold(0.0, f64::max)
        };
        let (there, back) = (far(&cut, &exact), far(&exact, &cut));
        assert!(
            there.max(back) < TOLERANCE_MM + DIGITS_MM,
            "{name}: {there} {back} mm"
        );
    }
}

#[test]
fn every_contour_has_its_length_and_few_blocks() {
    for contour in CONTOURS {
        let program = contour_program(contour, 50.0, TOLERANCE_MM).unwrap();
        let cut = cuts(&program.text);
        let length_mm: f64 = cut.iter().map(|piece| piece.length_mm).sum();
        let corner = feedwright_gcode::canon::Corner::Continuous {
            tolerance_mm: None,
            merge_mm: None,
        };
        let whole_mm: f64 = contour
            .steps(50.0, corner)
            .unwrap()
            .iter()
            .map(|step| match step {
                Step::Piece(piece) => piece.length_mm,
                Step::Rest(_) | Step::Event(_) => 0.0,
            })
            .sum();
        assert!(
            (length_mm / whole_mm - 1.0).abs() < 1e-5,
            "{}: {length_mm} for {whole_mm} mm",
            contour.name
        );
        let most = match contour.name {
            "circle" => 1,
            "line-line-circle" => 3,
            "square" => 4,
            "butterfly" => 1500,
            _ => 500,
        };
        assert!(
            (1..=most).contains(&program.blocks),
            "{}: {} blocks",
            contour.name,
            program.blocks
        );
        assert!(
            program.text.lines().all(|line| line.len() <= 80),
            "{}",
            contour.name
        );
        assert!(
            cut.iter()
                .all(|piece| (piece.feed_mm_s - 50.0).abs() < 1e-9),
            "{}",
            contour.name
        );
    }
}
