//! Verifies that a text has the intended content: reads it again and compares it, step by step.

use std::f64::consts::PI;
use std::fmt;
use std::sync::Arc;

use feedwright_gcode::canon::{Canon, Corner, EventKind, Motion, MotionKind, Shape};
use feedwright_gcode::{Dialect, ModesInForce, Reader, Settings};
use feedwright_plan::vector::distance;

use super::stretches::length_mm;

/// Feedrates may differ by this fraction: the resolution of their printed digits.
const FEED_PART: f64 = 1e-3;
/// Dwells may differ by this, s.
const DWELL_S: f64 = 1e-3;
/// The center of an arc may be off by this many printed steps plus [`CENTER_PART`] of the radius.
/// The reader moves it so that the arc meets both of its ends.
const CENTER_STEPS: f64 = 100.0;
const CENTER_PART: f64 = 1e-3;

/// Tolerances of `G64` may differ by this, mm: the resolution of their printed digits in inches.
const TOLERANCE_MM: f64 = 1e-6;

/// Steps of a text, and the modes after each. Steps with the same modes share them.
type ReadSteps = (Vec<Canon>, Vec<Arc<ModesInForce>>);

/// Difference between a text and its intended content.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum TextFault {
    /// The control rejects a line.
    Unreadable {
        /// The line.
        text: String,
        /// Its fault.
        fault: String,
    },
    /// The control reads something else.
    Otherwise {
        /// Line of the original; 0 after the last motion.
        line: u32,
        /// The difference.
        what: &'static str,
    },
}

impl fmt::Display for TextFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable { text, fault } => {
                write!(f, "the control does not take '{}': {fault}", text.trim())
            }
            Self::Otherwise { line: 0, what } => write!(f, "at its end the control reads {what}"),
            Self::Otherwise { line, what } => {
                write!(f, "in place of line {line} the control reads {what}")
            }
        }
    }
}

/// Reads a text as a control of this dialect does.
///
/// # Errors
/// The first mistake in the text.
pub(super) fn read(
    text: &str,
    settings: &Settings,
    dialect: Dialect,
) -> Result<ReadSteps, TextFault> {
    let settings = Settings {
        dialect: Some(dialect),
        ..settings.clone()
    };
    let unreadable = |text: String, fault: String| TextFault::Unreadable { text, fault };
    let mut reader = Reader::from_text("corrected.ngc", text, settings)
        .map_err(|fault| unreadable("corrected.ngc".to_owned(), fault.to_string()))?;
    let (mut steps, mut modes) = (Vec::new(), Vec::<Arc<ModesInForce>>::new());
    while let Some(step) = reader.next() {
        steps.push(step.map_err(|fault| unreadable(fault.text.clone(), fault.to_string()))?);
        let now = reader.modes();
        let last = modes.last().filter(|last| ***last == now);
        modes.push(last.map_or_else(|| Arc::new(now), Arc::clone));
    }
    Ok((steps, modes))
}

/// Compares the content of two programs.
#[derive(Debug, Clone, Copy)]
pub(super) struct TextComparison {
    /// Printed step, mm.
    pub(super) step_mm: f64,
    /// True where the control knows corner tolerances and messages. Other controls choose their own
    /// tolerances and read messages as comments.
    pub(super) of_linuxcnc: bool,
}

impl TextComparison {
    /// Returns the first difference between the frames of the motions of two programs, in order, up
    /// to their printed steps. Positions in the machine are not enough: the control may have other
    /// offsets for a coordinate system than assumed here.
    pub(super) fn frames<'a>(
        self,
        found: impl Iterator<Item = (&'a Canon, &'a ModesInForce)>,
        wanted: impl Iterator<Item = (&'a Canon, &'a ModesInForce)>,
    ) -> Result<(), TextFault> {
        let (found, wanted) = (frames(found, self.step_mm), frames(wanted, self.step_mm));
        let is_near = |k: usize| {
            found
                .get(k)
                .is_some_and(|found| found.1.near_frame(wanted[k].1, self.step_mm))
        };
        match (0..wanted.len()).find(|&k| !is_near(k)) {
            Some(k) => Err(TextFault::Otherwise {
                line: wanted[k].0,
                what: "another coordinate system",
            }),
            None if found.len() == wanted.len() => Ok(()),
            None => Err(TextFault::Otherwise {
                line: 0,
                what: "another coordinate system",
            }),
        }
    }

    /// Returns the first difference between the steps of two programs, up to their printed steps;
    /// events between two motions may have another order.
    pub(super) fn steps(self, found: &[Canon], wanted: &[Canon]) -> Result<(), TextFault> {
        let (found, wanted) = (self.legs(found), self.legs(wanted));
        for (k, leg) in wanted.iter().enumerate() {
            let line = leg.1.map_or(0, |motion| motion.line);
            let otherwise = |what| Err(TextFault::Otherwise { line, what });
            match found.get(k) {
                None => return otherwise("no more motions"),
                Some(found) => self.leg(found, leg).or_else(otherwise)?,
            }
        }
        if found.len() > wanted.len() {
            return Err(TextFault::Otherwise {
                line: 0,
                what: "more motions",
            });
        }
        Ok(())
    }

    fn legs(self, program: &[Canon]) -> Vec<Leg<'_>> {
        let mut legs: Vec<Leg<'_>> = vec![(Vec::new(), None)];
        for step in program {
            match step {
                Canon::Motion(motion) if is_nothing(motion, self.step_mm) => {}
                Canon::Motion(motion) => {
                    if let Some(leg) = legs.last_mut() {
                        leg.1 = Some(motion);
                    }
                    legs.push((Vec::new(), None));
                }
                Canon::Event(event) => match &event.kind {
                    EventKind::ProgramEnd | EventKind::MCode { code: 2 | 30, .. } => {}
                    EventKind::Message { .. } if !self.of_linuxcnc => {}
                    kind => legs.last_mut().into_iter().for_each(|leg| leg.0.push(kind)),
                },
            }
        }
        for leg in &mut legs {
            leg.0.sort_by_key(|kind| format!("{kind:?}"));
        }
        legs
    }

    fn leg(self, found: &Leg<'_>, wanted: &Leg<'_>) -> Result<(), &'static str> {
        if found.0.len() != wanted.0.len()
            || found
                .0
                .iter()
                .zip(&wanted.0)
                .any(|(found, wanted)| !same_event(found, wanted))
        {
            return Err("another M-code, speed, tool, dwell or message");
        }
        match (found.1, wanted.1) {
            (None, None) => Ok(()),
            (Some(found), Some(wanted)) => self.motion(found, wanted),
            (None, Some(_)) => Err("no more motions"),
            (Some(_), None) => Err("more motions"),
        }
    }

    fn motion(self, found: &Motion, wanted: &Motion) -> Result<(), &'static str> {
        let feed_mm_s = FEED_PART * wanted.feed_mm_s + 1e-6;
        let same = [
            (
                found.kind == wanted.kind,
                "a rapid for a feed motion, or a feed motion for a rapid",
            ),
            (
                distance(found.end_mm, wanted.end_mm) < 2.0 * self.step_mm,
                "another end",
            ),
            (
                found.others == wanted.others,
                "other positions of axes beside X, Y and Z",
            ),
            (
                (found.feed_mm_s - wanted.feed_mm_s).abs() <= feed_mm_s,
                "another feedrate",
            ),
            (
                found.kind == MotionKind::Rapid || self.corner(found.corner, wanted.corner),
                "another way of taking corners",
            ),
            (same_shape(found, wanted, self.step_mm), "another curve"),
        ];
        same.iter()
            .find(|(same, _)| !same)
            .map_or(Ok(()), |(_, what)| Err(what))
    }

    fn corner(self, found: Corner, wanted: Corner) -> bool {
        let near = |found: Option<f64>, wanted: Option<f64>| match (found, wanted) {
            (Some(found), Some(wanted)) => (found - wanted).abs() <= TOLERANCE_MM,
            (found, wanted) => found == wanted,
        };
        match (found, wanted) {
            (
                Corner::Continuous {
                    tolerance_mm,
                    merge_mm,
                },
                Corner::Continuous {
                    tolerance_mm: wanted_mm,
                    merge_mm: wanted_merge_mm,
                },
            ) => {
                !self.of_linuxcnc
                    || near(tolerance_mm, wanted_mm) && near(merge_mm, wanted_merge_mm)
            }
            (found, wanted) => found == wanted,
        }
    }
}

/// Returns the frames of a program's motions, each with the line of the first motion in it.
fn frames<'a>(
    steps: impl Iterator<Item = (&'a Canon, &'a ModesInForce)>,
    step_mm: f64,
) -> Vec<(u32, &'a ModesInForce)> {
    let mut frames: Vec<(u32, &ModesInForce)> = Vec::new();
    for (step, modes) in steps {
        if let Canon::Motion(motion) = step
            && frames
                .last()
                .is_none_or(|last| !last.1.near_frame(modes, step_mm))
        {
            frames.push((motion.line, modes));
        }
    }
    frames
}

/// A motion, none after the last, and the events before it in a sorted order.
type Leg<'a> = (Vec<&'a EventKind>, Option<&'a Motion>);

/// Returns true if a line is shorter than half a printed step: printed, it has no length or at
/// least one step.
fn is_nothing(motion: &Motion, step_mm: f64) -> bool {
    let is_short = distance(motion.start_mm, motion.end_mm) < 0.5 * step_mm;
    is_short && matches!(motion.shape, Shape::Line) && motion.others.is_none()
}

fn same_event(found: &EventKind, wanted: &EventKind) -> bool {
    match (found, wanted) {
        (EventKind::Dwell { seconds: a }, EventKind::Dwell { seconds: b }) => {
            (a - b).abs() < DWELL_S
        }
        (EventKind::Message { text: a }, EventKind::Message { text: b }) => a.trim() == b.trim(),
        (a, b) => a == b,
    }
}

fn same_shape(found: &Motion, wanted: &Motion, step_mm: f64) -> bool {
    match (&found.shape, &wanted.shape) {
        (Shape::Line, Shape::Line) => true,
        (
            Shape::Arc {
                plane,
                center_mm,
                turns,
            },
            Shape::Arc {
                plane: wanted_plane,
                center_mm: wanted_mm,
                turns: wanted_turns,
            },
        ) => {
            let radius_mm = distance(*wanted_mm, wanted.start_mm);
            plane == wanted_plane
                && turns == wanted_turns
                && distance(*center_mm, *wanted_mm) < CENTER_STEPS * step_mm + CENTER_PART * radius_mm
                // The ends of a short arc can change places by rounding: then it is a full turn.
                && (length_mm(found) - length_mm(wanted)).abs() < PI * radius_mm
        }
        (Shape::Spline(found), Shape::Spline(wanted)) => found == wanted,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COMPARISON: TextComparison = TextComparison {
        step_mm: 0.001,
        of_linuxcnc: true,
    };
    const PROGRAM: &str = "G21 G90 G17 G64 F600\nM3 S500\nG0 X5 Y5\nG1 X10\nG4 P0.5\nG2 X20 Y5 I5 J0\n(MSG, look)\n\
                           G5 X30 Y5 I2 J3 P-2 Q3\nM8\nM64 P1\nG1 Z-1\nG1 A10\nM2\n";

    fn read_again(text: &str) -> (Vec<Canon>, Vec<Arc<ModesInForce>>) {
        read(text, &Settings::default(), Dialect::LinuxCnc)
            .unwrap_or_else(|fault| panic!("{fault}\n{text}"))
    }

    /// Returns true if the program reads the same with `other` in place of `part`.
    fn is_same(part: &str, other: &str) -> bool {
        assert!(PROGRAM.contains(part), "{part}");
        let [wanted, found] =
            [PROGRAM.to_owned(), PROGRAM.replacen(part, other, 1)].map(|text| read_again(&text).0);
        let is_same = COMPARISON.steps(&found, &wanted).is_ok();
        assert_eq!(
            is_same,
            COMPARISON.steps(&wanted, &found).is_ok(),
            "{part:?} and {other:?}"
        );
        is_same
    }

    #[test]
    fn what_digits_and_the_order_of_events_change_is_the_same() {
        for (part, other) in [
            ("X10\n", "X10.0015\n"),
            ("F600", "F600.3"),
            ("P0.5\n", "P0.5004\n"),
            ("M3 S500\n", "S500\nM3\n"),
            ("M8\nM64 P1\n", "M64 P1\nM8\n"),
            ("X10\n", "X10\nX10.0004\n"),
            ("(MSG, look)", "(MSG,look )"),
            ("M2\n", "M30\n"),
            (
                "G64 F600\nM3 S500\nG0 X5 Y5\n",
                "G61 F600\nM3 S500\nG0 X5 Y5\nG64\n",
            ),
            ("I5 J0", "R5.001"),
        ] {
            assert!(is_same(part, other), "{part:?} and {other:?}");
        }
    }

    #[test]
    fn another_motion_or_event_is_not_the_same() {
        for (part, other) in [
            ("X10\n", "X10.0025\n"),
            ("F600", "F601"),
            ("P0.5\n", "P0.502\n"),
            ("P0.5\n", "P0.498\n"),
            ("M3 S500\n", "M4 S500\n"),
            ("M8\n", ""),
            ("M8\nM64 P1\nG1 Z-1\n", "G1 Z-1\nM8\nM64 P1\n"),
            ("M64 P1", "M64 P2"),
            ("look", "look out"),
            ("G0 X5", "G1 X5"),
            ("G64", "G61"),
            ("G1 A10\n", ""),
            ("G1 A10\n", "G1 A10\nA20\n"),
            ("A10", "A11"),
            ("Z-1", "Z-2"),
            ("G2 X20 Y5 I5 J0", "G3 X20 Y5 I5 J0"),
            ("G2 X20 Y5 I5 J0", "G2 X20 Y5 I5 J0 P2"),
            ("G2 X20 Y5 I5 J0", "G1 X20 Y5"),
            ("G2 X20 Y5 I5 J0", "G18 G2 X20 Z0 I5 K0\nG17"),
            ("I5 J0", "R5.1"),
            ("P-2 Q3", "P-2 Q4"),
        ] {
            assert!(!is_same(part, other), "{part:?} and {other:?}");
        }
        assert!(is_same(PROGRAM, PROGRAM));
    }

    #[test]
    fn frames_are_the_same_in_their_order_up_to_printed_steps() {
        let are_same = |found: &str, wanted: &str| {
            let [found, wanted] =
                [found, wanted].map(|text| read_again(&format!("G21 G90 F600\n{text}M2\n")));
            let steps = |(steps, modes): &'static (Vec<Canon>, Vec<Arc<ModesInForce>>)| {
                steps.iter().zip(modes.iter().map(|modes| &**modes))
            };
            let [found, wanted] = [found, wanted].map(|read| steps(Box::leak(Box::new(read))));
            COMPARISON.frames(found, wanted).is_ok()
        };
        let two = "G54 G1 X1\nG10 L2 P2 X5 Y2\nG55 X1\n";
        assert!(are_same(two, two));
        assert!(are_same(
            "G54 G1 X1\nX2\nG10 L2 P2 X5.0004 Y2\nG55 X1\nX3\n",
            two
        ));
        assert!(!are_same("G54 G1 X1\nG10 L2 P2 X5.01 Y2\nG55 X1\n", two));
        assert!(!are_same("G54 G1 X1\n", two) && !are_same(two, "G54 G1 X1\n"));
        assert!(!are_same("G10 L2 P2 X5 Y2\nG55 G1 X1\nG54 X1\n", two));
    }
}
