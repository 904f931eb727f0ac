//! Blocks of motions, in the words of a program.

use std::fmt::Write;

use feedwright_gcode::canon::{Corner, EventKind, Motion, MotionKind, Plane, Shape};
use feedwright_gcode::{Dialect, ModesInForce};
use feedwright_sim::trimmed;

use super::target::TargetControl;

/// Decimals of a feedrate in units a minute: of one from 10 on, and of the smallest. A feedrate
/// below 10 has as many digits as one above, so that it is printed to within 0.05 %.
const FEED_DECIMALS: [usize; 2] = [2, 6];

/// Printed steps of a tolerance in its unit: in inches, they are some nanometers.
const TOLERANCE_STEPS: f64 = 1e7;

/// Writes blocks at one place of a program.
pub(super) struct BlockWords<'a> {
    target: &'a TargetControl,
    /// Modes that the blocks are written under; none is mm in machine coordinates.
    modes: Option<&'a ModesInForce>,
    feed: String,
    /// Plane of the last arc; G17 is in force before the first block.
    plane: Plane,
}

/// A number without zeros at its end, but with a point: controls count in steps without it.
fn number(value: f64, decimals: usize) -> String {
    let text = trimmed(value, decimals);
    if text.contains('.') {
        text
    } else {
        text + ".0"
    }
}

impl<'a> BlockWords<'a> {
    pub(super) const fn new(target: &'a TargetControl, modes: Option<&'a ModesInForce>) -> Self {
        Self {
            target,
            modes,
            feed: String::new(),
            plane: Plane::Xy,
        }
    }

    fn unit_mm(&self) -> f64 {
        self.modes.map_or(1.0, |modes| modes.unit_mm)
    }

    fn to_program(&self, machine_mm: [f64; 3]) -> [f64; 3] {
        let program_mm = self
            .modes
            .map_or(machine_mm, |modes| modes.to_program(machine_mm));
        program_mm.map(|value| value / self.unit_mm())
    }

    /// The block of a motion; none of one that no block of straight lines and arcs can say, empty
    /// where nothing moves.
    pub(super) fn motion(&mut self, motion: &Motion) -> Option<String> {
        if !motion.others.is_none() {
            return None;
        }
        let decimals = self.target.decimals_of(self.unit_mm());
        let (start, end) = (
            self.to_program(motion.start_mm),
            self.to_program(motion.end_mm),
        );
        let print = |value: f64| number(value, decimals);
        let mut in_plane: &[usize] = &[];
        let mut text = match (&motion.shape, motion.kind) {
            (Shape::Line, MotionKind::Rapid) => "G0".to_owned(),
            (Shape::Line, MotionKind::Feed) => "G1".to_owned(),
            (Shape::Arc { plane, turns, .. }, _) if turns.abs() == 1 => {
                in_plane = match plane {
                    Plane::Xy => &[0, 1],
                    Plane::Zx => &[0, 2],
                    Plane::Yz => &[1, 2],
                };
                let code = if *turns > 0 { "G3" } else { "G2" };
                let changes = self.plane != *plane;
                self.plane = *plane;
                if changes {
                    format!("{} {code}", plane_word(*plane))
                } else {
                    code.to_owned()
                }
            }
            _ => return None,
        };
        for (axis, letter) in ['X', 'Y', 'Z'].into_iter().enumerate() {
            if in_plane.contains(&axis) || print(start[axis]) != print(end[axis]) {
                let _ = write!(text, " {letter}{}", print(end[axis]));
            }
        }
        if let Shape::Arc { center_mm, .. } = &motion.shape {
            let center = self.to_program(*center_mm);
            for &axis in in_plane {
                let _ = write!(
                    text,
                    " {}{}",
                    ['I', 'J', 'K'][axis],
                    print(center[axis] - start[axis])
                );
            }
        } else if !text.contains(' ') {
            return Some(String::new());
        }
        if motion.kind == MotionKind::Feed {
            let feed = feed_number(motion.feed_mm_s, self.unit_mm());
            if feed != self.feed {
                let _ = write!(text, " F{feed}");
                self.feed = feed;
            }
        }
        Some(text)
    }

    /// The block behind the last motion that puts G17 in force again, where an arc had another
    /// plane.
    pub(super) fn plane_back(&self) -> Option<String> {
        (self.plane != Plane::Xy).then(|| plane_word(Plane::Xy).to_owned())
    }
}

/// The word of a plane.
pub(super) const fn plane_word(plane: Plane) -> &'static str {
    match plane {
        Plane::Xy => "G17",
        Plane::Zx => "G18",
        Plane::Yz => "G19",
    }
}

/// Words that take corners in this way, in a unit of length and in the words of a dialect. Only
/// LinuxCNC takes tolerances, and grbl has no words for it.
pub(super) fn corner_words(corner: Corner, unit_mm: f64, dialect: Dialect) -> String {
    let length = |mm: f64| (mm / unit_mm * TOLERANCE_STEPS).round() / TOLERANCE_STEPS;
    match (corner, dialect) {
        (Corner::ExactStop, _) => "G61.1".to_owned(),
        (Corner::ExactPath, _) => "G61".to_owned(),
        (_, Dialect::Grbl) => String::new(),
        (
            Corner::Continuous {
                tolerance_mm: Some(tolerance_mm),
                merge_mm,
            },
            Dialect::LinuxCnc,
        ) => {
            let merge =
                merge_mm.map_or_else(String::new, |merge_mm| format!(" Q{}", length(merge_mm)));
            format!("G64 P{}{merge}", length(tolerance_mm))
        }
        (Corner::Continuous { .. }, _) => "G64".to_owned(),
    }
}

/// A feedrate in units a minute.
pub(super) fn feed_number(feed_mm_s: f64, unit_mm: f64) -> String {
    let feed = feed_mm_s * 60.0 / unit_mm;
    let [fewest, most] = FEED_DECIMALS;
    let digits = |decimals: &usize| feed * 10_f64.powi((*decimals - fewest) as i32) >= 10.0;
    number(feed, (fewest..most).find(digits).unwrap_or(most))
}

/// A rest of so long.
pub(super) fn dwell(seconds: f64, dialect: Dialect) -> String {
    let milliseconds = dialect.is_fanuc() || dialect == Dialect::Printer;
    if milliseconds {
        format!("G4 P{}", (seconds * 1e3).round())
    } else {
        format!("G4 P{}", number(seconds, 4))
    }
}

/// The block of an event; none of one that a block cannot say, empty where it needs none.
pub(super) fn event(kind: &EventKind, dialect: Dialect) -> Option<String> {
    Some(match kind {
        EventKind::Dwell { seconds } => dwell(*seconds, dialect),
        EventKind::SpindleSpeed { rpm } => format!("S{rpm}"),
        EventKind::MCode { code: 2 | 30, .. } => String::new(),
        EventKind::MCode { code, p, q } => {
            let word = |letter, value: &Option<f64>| {
                value.map_or_else(String::new, |value| format!(" {letter}{value}"))
            };
            format!("M{code}{}{}", word('P', p), word('Q', q))
        }
        EventKind::ToolSelect { tool } => format!("T{tool}"),
        EventKind::Message { text } => format!(
            "(MSG, {})",
            text.trim().replace(['(', ')', '\n', '\r'], " ")
        ),
        EventKind::ProgramEnd => "M2".to_owned(),
        EventKind::SpindleSync { .. } | EventKind::Probe => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_point_and_lose_their_zeros() {
        assert_eq!(number(10.0, 5), "10.0");
        assert_eq!(number(-0.000_001, 5), "0.0");
        assert_eq!(number(1.25, 5), "1.25");
    }

    #[test]
    fn a_slow_feedrate_in_inches_keeps_its_digits() {
        assert_eq!(feed_number(25.0, 1.0), "1500.0");
        assert_eq!(feed_number(0.125, 25.4), "0.2953");
        assert_eq!(feed_number(0.5, 25.4), "1.181");
    }

    #[test]
    fn a_dwell_is_in_the_unit_of_its_control() {
        assert_eq!(dwell(0.057, Dialect::LinuxCnc), "G4 P0.057");
        assert_eq!(dwell(0.057, Dialect::FanucMill), "G4 P57");
    }
}
