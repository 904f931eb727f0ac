//! Program coordinates and machine coordinates.

/// X Y Z A B C U V W: mm and degrees.
pub(crate) type Position = [f64; 9];

/// A rotation of program coordinates about a point of the XY plane (G68 of Fanuc).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Turn {
    pub(crate) center: [f64; 2],
    pub(crate) angle_deg: f64,
}

impl Turn {
    pub(super) fn of(&self, [x, y]: [f64; 2], sense: f64) -> [f64; 2] {
        let (sin, cos) = libm::sincos((sense * self.angle_deg).to_radians());
        let (x, y) = (x - self.center[0], y - self.center[1]);
        [
            self.center[0] + cos * x - sin * y,
            self.center[1] + sin * x + cos * y,
        ]
    }
}

/// Transformation from program coordinates to machine coordinates:
/// machine = rotate_xy(turn(program) + g92) + system + tool.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Frame {
    /// Active coordinate system, 1 (G54) to 9 (G59.3).
    pub(super) system: usize,
    pub(super) system_offset: Position,
    /// Rotation of the system about Z, degrees.
    pub(crate) rotation_deg: f64,
    pub(crate) g92: Position,
    pub(super) tool: Position,
    pub(crate) turn: Option<Turn>,
}

impl Frame {
    pub(super) const fn new() -> Self {
        Self {
            system: 1,
            system_offset: [0.0; 9],
            rotation_deg: 0.0,
            g92: [0.0; 9],
            tool: [0.0; 9],
            turn: None,
        }
    }

    /// Returns true if both have the same system and rotations, and offsets that differ by less
    /// than `within_mm`.
    pub(super) fn is_near(&self, other: &Self, within_mm: f64) -> bool {
        let near =
            |a: &Position, b: &Position| a.iter().zip(b).all(|(a, b)| (a - b).abs() < within_mm);
        (self.system, self.rotation_deg, &self.turn)
            == (other.system, other.rotation_deg, &other.turn)
            && near(&self.system_offset, &other.system_offset)
            && near(&self.g92, &other.g92)
            && near(&self.tool, &other.tool)
    }

    #[inline]
    pub(crate) fn to_machine(&self, program: &Position) -> Position {
        let mut program = *program;
        if let Some(turn) = &self.turn {
            [program[0], program[1]] = turn.of([program[0], program[1]], 1.0);
        }
        let mut point: Position = std::array::from_fn(|axis| program[axis] + self.g92[axis]);
        [point[0], point[1]] = self.rotate([point[0], point[1]], 1.0);
        std::array::from_fn(|axis| point[axis] + self.system_offset[axis] + self.tool[axis])
    }

    pub(crate) fn to_program(&self, machine: &Position) -> Position {
        let mut point: Position =
            std::array::from_fn(|axis| machine[axis] - self.system_offset[axis] - self.tool[axis]);
        [point[0], point[1]] = self.rotate([point[0], point[1]], -1.0);
        let mut program: Position = std::array::from_fn(|axis| point[axis] - self.g92[axis]);
        if let Some(turn) = &self.turn {
            [program[0], program[1]] = turn.of([program[0], program[1]], -1.0);
        }
        program
    }

    /// A vector of the XY plane turned by the rotation of the system (`sense` 1) or back (-1).
    fn rotate(&self, [x, y]: [f64; 2], sense: f64) -> [f64; 2] {
        if self.rotation_deg == 0.0 {
            return [x, y];
        }
        let (sin, cos) = libm::sincos((sense * self.rotation_deg).to_radians());
        [cos * x - sin * y, sin * x + cos * y]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn program_and_machine_coordinates_are_inverse() {
        let mut frame = Frame::new();
        frame.rotation_deg = 33.0;
        frame.system_offset = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];
        frame.g92 = [0.5; 9];
        frame.tool = [0.0, 0.0, 10.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        let program = [3.0, -4.0, 5.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0];
        let back = frame.to_program(&frame.to_machine(&program));
        for axis in 0..9 {
            assert!((back[axis] - program[axis]).abs() < 1e-14);
        }
    }
}
