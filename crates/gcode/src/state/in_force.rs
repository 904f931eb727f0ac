//! Modes in force at a place of a program, for those who write blocks there.

use super::Interpreter;
use super::frame::{Frame, Position};
use super::modal::FeedMode;
use crate::canon::{Corner, Plane};

/// Modes that decide the meaning of a block inserted after a step of a program.
#[derive(Debug, Clone, PartialEq)]
pub struct ModesInForce {
    /// Millimetres of a unit of length: 1, or 25.4 of an inch.
    pub unit_mm: f64,
    /// True where coordinates count from the current position (G91).
    pub incremental: bool,
    /// True where centers of arcs are absolute coordinates (G90.1).
    pub arc_absolute: bool,
    /// Plane of arcs.
    pub plane: Plane,
    /// True where F is a distance per minute (G94).
    pub feed_per_minute: bool,
    /// True where cutter compensation or diameter programming of a lathe makes the path differ from
    /// the programmed coordinates.
    pub changes_coordinates: bool,
    /// Corner mode.
    pub corner: Corner,
    frame: Frame,
}

impl ModesInForce {
    pub(crate) fn of(interpreter: &Interpreter) -> Self {
        let modal = &interpreter.modal;
        Self {
            unit_mm: modal.unit_mm,
            incremental: modal.incremental,
            arc_absolute: modal.arc_absolute,
            plane: modal.plane,
            feed_per_minute: matches!(modal.feed_mode, FeedMode::PerMinute),
            changes_coordinates: interpreter.compensates() || modal.diameter,
            corner: modal.corner,
            frame: interpreter.frame.clone(),
        }
    }

    /// Returns true if program coordinates mean the same places: coordinate system, offsets,
    /// rotation and tool length are the same.
    pub fn same_frame(&self, other: &Self) -> bool {
        self.frame == other.frame
    }

    /// The same up to offsets that differ by less than `within_mm`: an offset that a program sets
    /// from where the tool is has the digits of that place.
    pub fn near_frame(&self, other: &Self, within_mm: f64) -> bool {
        self.frame.is_near(&other.frame, within_mm)
    }

    /// Coordinates of the program, in mm, of a place of the machine.
    pub fn to_program(&self, machine_mm: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = machine_mm;
        let position: Position = [x, y, z, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let [x, y, z, ..] = self.frame.to_program(&position);
        [x, y, z]
    }
}

#[cfg(test)]
mod tests {
    use crate::{Reader, Settings};

    #[test]
    fn units_offsets_and_distances_are_those_behind_the_motion() {
        let text = "G20 G90 F10\nG1 X1\nG92 X0\nG91 G1 X1\nM2\n";
        let mut reader = Reader::from_text("part.ngc", text, Settings::default()).unwrap();
        reader.next().unwrap().unwrap();
        let first = reader.modes();
        assert!(!first.incremental && first.unit_mm == 25.4 && first.feed_per_minute);
        assert_eq!(first.to_program([25.4, 0.0, 0.0]), [25.4, 0.0, 0.0]);
        reader.next().unwrap().unwrap();
        let second = reader.modes();
        assert!(second.incremental);
        assert!((second.to_program([50.8, 0.0, 0.0])[0] - 25.4).abs() < 1e-12);
        assert!(first.same_frame(&first) && !first.same_frame(&second));
    }
}
