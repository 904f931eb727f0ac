//! Work of the comparison: contours and programs in the XY plane.

use std::path::{Path, PathBuf};

use feedwright::{JobError, gcode};
use feedwright_plan::{PathError, Pieces, Step};
use thiserror::Error;

use crate::contour::{CONTOURS, CORNER, Contour};

/// Feedrate of the contours, mm/s.
pub const FEED_MM_S: f64 = 50.0;
/// The parts in the XY plane that come with the program.
const PARTS: [(&str, &str); 6] = [
    ("circle.ngc", include_str!("../../../parts/circle.ngc")),
    ("eight.ngc", include_str!("../../../parts/eight.ngc")),
    ("ellipse.ngc", include_str!("../../../parts/ellipse.ngc")),
    ("slot.ngc", include_str!("../../../parts/slot.ngc")),
    ("square.ngc", include_str!("../../../parts/square.ngc")),
    ("star.ngc", include_str!("../../../parts/star.ngc")),
];

/// Contours that controllers are tuned on.
const TUNING_CONTOURS: [&str; 2] = ["eight", "square"];
/// Further tuning work: tips of 11 and 24 degrees and a short edge.
const TIPS: &str = "G1 X8 Y0 F3000\nX0 Y1.5\nX4 Y4\nX1 Y0.8\nX0 Y0\nM2\n";

/// Something to cut.
#[derive(Debug, Clone)]
pub struct Workpiece {
    /// Name.
    pub name: String,
    /// True if it has no corners.
    pub smooth: bool,
    /// True if nothing was tuned on it.
    pub held_out: bool,
    /// Its path.
    pub steps: Vec<Step>,
}

impl Workpiece {
    /// A workpiece with corners, on which something may have been tuned.
    pub(super) fn of(name: impl Into<String>, steps: Vec<Step>) -> Self {
        Self {
            name: name.into(),
            smooth: false,
            held_out: false,
            steps,
        }
    }

    /// The closed-form contours at [`FEED_MM_S`].
    pub fn contours() -> Vec<Self> {
        let workpiece = |contour: &Contour| {
            let steps = contour.steps(FEED_MM_S, CORNER);
            Self {
                smooth: contour.is_smooth(),
                ..Self::of(
                    contour.name,
                    steps.expect("the built-in contours have a path"),
                )
            }
        };
        CONTOURS.iter().map(workpiece).collect()
    }

    /// Returns the work that the peers are tuned on: a smooth contour, one with corners, and acute
    /// tips.
    pub fn tuning() -> Vec<Self> {
        let mut all = Self::contours();
        all.retain(|workpiece| TUNING_CONTOURS.contains(&workpiece.name.as_str()));
        let tips = steps("tips", TIPS).expect("the tips have a path, which a test holds");
        all.push(Self::of("tips", tips));
        all
    }

    /// Returns the work that everything may be tuned on: the contours, and the parts in the plane
    /// that come with the program.
    pub fn development() -> Vec<Self> {
        let mut all = Self::contours();
        all.extend(PARTS.map(|(name, text)| {
            let steps = steps(name, text);
            Self::of(
                name,
                steps.expect("the parts have a path, which a test holds"),
            )
        }));
        all
    }

    /// A program, read by `settings` as it is elsewhere.
    ///
    /// # Errors
    /// A program with mistakes, one that leaves the XY plane, or one without a path.
    pub fn program(file: &Path, settings: gcode::Settings) -> Result<Self, PartError> {
        let program = gcode::Program::in_file(file);
        let summary = program.check(settings.clone()).map_err(JobError::from)?;
        if summary.moves[2] {
            return Err(PartError::LeavesPlane {
                part: file.to_owned(),
            });
        }
        let steps = program.reader(settings).map_err(JobError::from)?;
        let steps: Result<Vec<Step>, PathError> =
            Pieces::new(steps.map_while(Result::ok)).collect();
        let part = program.name();
        let steps = steps.map_err(|fault| JobError::Path { part, fault })?;
        Ok(Self::of(program.file_name(), steps))
    }
}

/// The path of a program's text; none of one with mistakes.
pub(super) fn steps(name: &str, text: &str) -> Option<Vec<Step>> {
    let canon = gcode::Reader::from_text(name, text, gcode::Settings::default()).ok()?;
    let canon: Result<Vec<_>, _> = canon.collect();
    Pieces::new(canon.ok()?.into_iter())
        .collect::<Result<_, _>>()
        .ok()
}

/// Why a program cannot be compared on.
#[derive(Debug, Error, miette::Diagnostic)]
pub enum PartError {
    /// It cannot be read, or has mistakes.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Program(#[from] JobError),
    /// The comparison is of two axes.
    #[error("{} moves Z; the comparison is of motions in the XY plane", part.display())]
    #[diagnostic(help("feedwright run compares two controllers on programs in space"))]
    LeavesPlane {
        /// The program.
        part: PathBuf,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn controllers_are_tuned_on_a_smooth_contour_on_corners_and_on_tips() {
        let tuning = Workpiece::tuning();
        assert!(
            tuning
                .iter()
                .map(|it| &it.name[..])
                .eq(["eight", "square", "tips"])
        );
    }

    #[test]
    fn the_parts_of_the_development_set_are_in_the_plane_and_no_two_have_the_same_name() {
        let all = Workpiece::development();
        assert_eq!(all.len(), CONTOURS.len() + PARTS.len());
        for (i, workpiece) in all.iter().enumerate() {
            let name = &workpiece.name;
            assert!(all[..i].iter().all(|other| other.name != *name), "{name}");
            for step in &workpiece.steps {
                if let Step::Piece(piece) = step {
                    let [_, _, z] = piece.curve.at(piece.length_mm).position_mm;
                    assert_eq!(z, 0.0, "{name}");
                }
            }
        }
    }
}
