//! The built-in contours as G-code: straight lines and circles as they are, other curves as arcs
//! that meet without a corner.

use std::fmt::Write;

use feedwright_gcode::canon::{Canon, Shape};
use feedwright_plan::vector::Vector;
use feedwright_plan::{ArcFit, FitPoint};
use feedwright_plan::{Curve, PathError, Step};
use feedwright_sim::trimmed;

use crate::contour::{CORNER, Contour, Placement};

/// Points of a curve are apart by this part of its radius, and by no more and no less than this,
/// mm.
const RADIUS_SHARE: f64 = 0.05;
const MOST_STEP_MM: f64 = 0.02;
const LEAST_STEP_MM: f64 = 0.0005;
/// Arcs are fitted within this part of the tolerance: the rest is for the digits of their ends and
/// centres.
const FIT_SHARE: f64 = 0.9;
/// Decimals of a coordinate: a nanometre.
const DECIMALS: usize = 6;
const STEPS_PER_MM: f64 = 1e6;

/// A contour as a program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ContourProgram {
    /// Its text.
    pub text: String,
    /// Blocks that cut.
    pub blocks: usize,
    /// True if the blocks are the contour itself, not an approximation.
    pub is_exact: bool,
}

/// A block that cuts.
struct ContourBlock {
    start_mm: Vector,
    end_mm: Vector,
    shape: Shape,
}

/// Returns a contour as a G-code program at `feed_mm_s`. Arcs and lines that replace a curve stay
/// within `tolerance_mm` of it.
///
/// # Errors
/// Fails if `feed_mm_s` is below [`feedwright_plan::MIN_FEED_MM_S`] or not finite.
pub fn contour_program(
    contour: &Contour,
    feed_mm_s: f64,
    tolerance_mm: f64,
) -> Result<ContourProgram, PathError> {
    let steps = contour.steps(feed_mm_s, CORNER)?;
    let (blocks, is_exact) = match contour.lines_and_arcs(Placement::NONE, feed_mm_s, CORNER) {
        Some(canon) => (
            canon.into_iter().filter_map(exact).collect::<Vec<_>>(),
            true,
        ),
        None => (
            steps
                .iter()
                .flat_map(|step| fitted(step, tolerance_mm))
                .collect(),
            false,
        ),
    };
    let mut text = format!("({}: {}, mm)\n", contour.name, contour.about);
    if !is_exact {
        // Writing to a text does not fail.
        let _ = writeln!(
            text,
            "({} arcs and lines within {} um of the curve)",
            blocks.len(),
            1e3 * tolerance_mm
        );
    }
    text += "G21 G17 G90 G94 G64\n";
    let start_mm = blocks.first().map_or([0.0; 3], |block| block.start_mm);
    let _ = writeln!(
        text,
        "G0 {} {}",
        word('X', start_mm[0]),
        word('Y', start_mm[1])
    );
    let _ = writeln!(text, "F{}", trimmed(60.0 * feed_mm_s, 3));
    blocks.iter().for_each(|block| text += &block.line());
    text += "M2\n";
    Ok(ContourProgram {
        text,
        blocks: blocks.len(),
        is_exact,
    })
}

fn exact(canon: Canon) -> Option<ContourBlock> {
    match canon {
        Canon::Motion(motion) => Some(ContourBlock {
            start_mm: motion.start_mm,
            end_mm: motion.end_mm,
            shape: motion.shape,
        }),
        Canon::Event(_) => None,
    }
}

/// Arcs in place of a curve.
fn fitted(step: &Step, tolerance_mm: f64) -> Vec<ContourBlock> {
    let Step::Piece(piece) = step else {
        return Vec::new();
    };
    let points = points(&piece.curve, piece.feed_mm_s);
    let motions = ArcFit::new(&points, FIT_SHARE * tolerance_mm, STEPS_PER_MM).motions();
    motions
        .into_iter()
        .map(|motion| ContourBlock {
            start_mm: motion.start_mm,
            end_mm: motion.end_mm,
            shape: motion.shape,
        })
        .collect()
}

/// Points along a curve, closer where it bends more.
fn points(curve: &Curve, feed_mm_s: f64) -> Vec<FitPoint> {
    let length_mm = curve.length_mm();
    let (mut points, mut s_mm) = (Vec::new(), 0.0);
    loop {
        let point = curve.at(s_mm);
        let tangent = [point.tangent[0], point.tangent[1]];
        points.push(FitPoint {
            at_mm: point.position_mm,
            tangent,
            feed_mm_s,
        });
        if s_mm >= length_mm {
            return points;
        }
        let radius_mm = 1.0 / curve.curvature(s_mm).max(f64::MIN_POSITIVE);
        s_mm =
            (s_mm + (RADIUS_SHARE * radius_mm).clamp(LEAST_STEP_MM, MOST_STEP_MM)).min(length_mm);
    }
}

impl ContourBlock {
    fn line(&self) -> String {
        let [x, y] = [word('X', self.end_mm[0]), word('Y', self.end_mm[1])];
        match &self.shape {
            Shape::Arc {
                center_mm, turns, ..
            } => {
                let code = if *turns > 0 { "G3" } else { "G2" };
                let [i, j] = [
                    word('I', center_mm[0] - self.start_mm[0]),
                    word('J', center_mm[1] - self.start_mm[1]),
                ];
                format!("{code} {x} {y} {i} {j}\n")
            }
            _ => format!("G1 {x} {y}\n"),
        }
    }
}

fn word(letter: char, value_mm: f64) -> String {
    format!("{letter}{}", trimmed(value_mm, DECIMALS))
}
