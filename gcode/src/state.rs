//! State of the interpreter: modes, offsets, position, parameters, and the canonical steps that wait to be fetched.

use std::collections::VecDeque;

use super::block::Block;
use super::canon::{Canon, Corner, Event, EventKind, Plane};
use super::codes::Group;
use super::compensation::Compensation;
use super::cycles::Cycle;
use super::diagnostic::Fault;
use super::expression::Values;
use super::fanuc::{self, Fanuc};
use super::lathe::{Lathe, Wanted};
use super::parameters::{self as numbers, Parameters};
use super::settings::{Dialect, Settings};
use super::splines::Collected;
use super::variables::Saved;

/// Millimetres of an inch.
pub const INCH_MM: f64 = 25.4;

/// X Y Z A B C U V W: mm and degrees.
pub(super) type Position = [f64; 9];

/// What F means.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FeedMode {
    /// G94.
    PerMinute,
    /// G93: each motion takes 1/F minutes.
    Inverse,
    /// G95.
    PerRevolution,
}

/// Modes of RS-274. Lengths in mm, whatever the program's unit.
#[derive(Debug, Clone)]
pub(super) struct Modal {
    /// Ten times the motion code; 800 is none.
    pub(super) motion: u16,
    pub(super) plane: Plane,
    /// 1 or 25.4.
    pub(super) unit_mm: f64,
    pub(super) incremental: bool,
    pub(super) arc_absolute: bool,
    pub(super) feed_mode: FeedMode,
    /// F: mm/min, 1/min or mm/rev by `feed_mode`.
    pub(super) feed: f64,
    /// What F was multiplied by to become millimetres. Rotary axes that move alone take F in degrees, whatever the unit.
    pub(super) feed_unit_mm: f64,
    pub(super) corner: Corner,
    /// G99: canned cycles retract to R; G98: to where they began.
    pub(super) retract_to_r: bool,
    /// G7: X is a diameter.
    pub(super) diameter: bool,
    /// S, rev/min or length/min by `constant_surface`.
    pub(super) spindle_speed: f64,
    /// 1 is M3, -1 is M4, 0 is M5.
    pub(super) spindle_turns: i8,
    /// G96 with its highest speed, rev/min.
    pub(super) constant_surface: Option<f64>,
    pub(super) flood: bool,
    pub(super) mist: bool,
    pub(super) feed_override: bool,
    pub(super) speed_override: bool,
    pub(super) adaptive_feed: bool,
    pub(super) feed_hold: bool,
}

impl Modal {
    pub(super) const fn new() -> Self {
        Self {
            motion: 800,
            plane: Plane::Xy,
            unit_mm: 1.0,
            incremental: false,
            arc_absolute: false,
            feed_mode: FeedMode::PerMinute,
            feed: 0.0,
            feed_unit_mm: 1.0,
            corner: Corner::Continuous { tolerance_mm: None },
            // As LinuxCNC begins, though its manual says otherwise.
            retract_to_r: true,
            diameter: false,
            spindle_speed: 0.0,
            spindle_turns: 0,
            constant_surface: None,
            flood: false,
            mist: false,
            feed_override: true,
            speed_override: true,
            adaptive_feed: false,
            feed_hold: true,
        }
    }
}

/// A rotation of program coordinates about a point of the XY plane (G68 of Fanuc).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Turn {
    pub(super) center: [f64; 2],
    pub(super) angle_deg: f64,
}

impl Turn {
    fn of(&self, [x, y]: [f64; 2], sense: f64) -> [f64; 2] {
        let (sin, cos) = (sense * self.angle_deg).to_radians().sin_cos();
        let (x, y) = (x - self.center[0], y - self.center[1]);
        [self.center[0] + cos * x - sin * y, self.center[1] + sin * x + cos * y]
    }
}

/// From program coordinates to machine coordinates:
/// machine = rotate_xy(turn(program) + g92) + system + tool.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Frame {
    /// Active coordinate system, 1 (G54) to 9 (G59.3).
    pub(super) system: usize,
    pub(super) system_offset: Position,
    /// Rotation of the system about Z, degrees.
    pub(super) rotation_deg: f64,
    pub(super) g92: Position,
    pub(super) tool: Position,
    pub(super) turn: Option<Turn>,
}

impl Frame {
    const fn new() -> Self {
        Self { system: 1, system_offset: [0.0; 9], rotation_deg: 0.0, g92: [0.0; 9], tool: [0.0; 9], turn: None }
    }

    #[inline]
    pub(super) fn to_machine(&self, program: &Position) -> Position {
        let mut program = *program;
        if let Some(turn) = &self.turn {
            [program[0], program[1]] = turn.of([program[0], program[1]], 1.0);
        }
        let mut point: Position = std::array::from_fn(|axis| program[axis] + self.g92[axis]);
        [point[0], point[1]] = self.rotate([point[0], point[1]], 1.0);
        std::array::from_fn(|axis| point[axis] + self.system_offset[axis] + self.tool[axis])
    }

    pub(super) fn to_program(&self, machine: &Position) -> Position {
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
    pub(super) fn rotate(&self, [x, y]: [f64; 2], sense: f64) -> [f64; 2] {
        if self.rotation_deg == 0.0 {
            return [x, y];
        }
        let (sin, cos) = (sense * self.rotation_deg).to_radians().sin_cos();
        [cos * x - sin * y, sin * x + cos * y]
    }
}

/// Carries out blocks.
#[derive(Debug)]
pub(super) struct Interpreter {
    pub(super) settings: Settings,
    pub(super) dialect: Dialect,
    pub(super) parameters: Parameters,
    pub(super) modal: Modal,
    pub(super) frame: Frame,
    /// Programmed position in program coordinates.
    pub(super) at: Position,
    /// Position of the controlled point in machine coordinates.
    pub(super) here: Position,
    /// Position of the extruder, mm.
    pub(super) extruder_mm: f64,
    /// M83: E words are distances.
    pub(super) extruder_relative: bool,
    /// Cutter compensation, if it is on.
    pub(super) compensation: Option<Compensation>,
    /// Cutter compensation has ended and nothing has moved since.
    pub(super) left_compensation: bool,
    /// Steps that wait until compensation knows where the first of them ends.
    pub(super) held: Vec<Canon>,
    /// What canned cycles keep from line to line.
    pub(super) cycle: Cycle,
    /// The NURBS that is being collected.
    pub(super) collected: Option<Collected>,
    /// The lathe cycle whose profile is being read, and the call that it waits for.
    pub(super) lathe: Option<Box<Lathe>>,
    pub(super) wanted: Option<Wanted>,
    /// What Fanuc and Haas have besides.
    pub(super) fanuc: Fanuc,
    /// P and Q of the last G5, if the line before was one.
    pub(super) last_bezier_end: Option<[f64; 2]>,
    /// Tool in the spindle.
    pub(super) tool: u32,
    /// T word.
    pub(super) next_tool: u32,
    /// Steps not yet fetched.
    pub(super) out: VecDeque<Canon>,
    /// Motions so far.
    pub(super) motions: u64,
    /// Line under way.
    pub(super) line: u32,
    /// Warnings of the line under way.
    pub(super) warnings: Vec<Fault>,
    /// A feed motion without F was reported: one report is enough.
    pub(super) missing_feed_reported: bool,
    /// A line was refused, and position or modes are not what they were meant to be since.
    pub(super) behind_fault: bool,
    /// M2, M30 or the closing %.
    pub(super) ended: bool,
    /// Result of the last subroutine.
    pub(super) returned: Option<f64>,
    /// Depth of subroutine calls.
    pub(super) call_level: usize,
    /// What M70 and M73 have put away.
    pub(super) saved: Vec<Saved>,
}

impl Interpreter {
    pub(super) fn new(settings: Settings, dialect: Dialect) -> Self {
        let mut parameters = Parameters::new();
        if dialect.is_fanuc() {
            parameters.empty_variables();
        }
        Self {
            settings,
            dialect,
            parameters,
            modal: if dialect.is_fanuc() { fanuc::modes(dialect.is_lathe()) } else { Modal::new() },
            frame: Frame::new(),
            at: [0.0; 9],
            here: [0.0; 9],
            extruder_mm: 0.0,
            extruder_relative: false,
            compensation: None,
            left_compensation: false,
            held: Vec::new(),
            cycle: Cycle::default(),
            collected: None,
            lathe: None,
            wanted: None,
            fanuc: Fanuc::default(),
            last_bezier_end: None,
            tool: 0,
            next_tool: 0,
            out: VecDeque::new(),
            motions: 0,
            line: 0,
            warnings: Vec::new(),
            missing_feed_reported: false,
            behind_fault: false,
            ended: false,
            returned: None,
            call_level: 0,
            saved: Vec::new(),
        }
    }

    /// Hands out an event of the line under way.
    pub(super) fn event(&mut self, kind: EventKind) {
        self.push(Canon::Event(Event { line: self.line, kind }));
    }

    /// Hands out a step, behind those that are held back.
    #[inline]
    pub(super) fn push(&mut self, step: Canon) {
        if self.lathe.is_some() {
            self.keep(step);
        } else if self.fanuc.capture.as_ref().is_some_and(|capture| capture.keeps()) {
            self.keep_own(step);
        } else if self.held.is_empty() {
            self.out.push_back(step);
        } else {
            self.held.push(step);
        }
    }

    /// A line was refused: takes the mode and the position that it was meant to leave, so that what follows is judged by itself.
    #[cold]
    pub(super) fn assume(&mut self, block: &Block) {
        self.behind_fault |= block.has_axes() || !block.g.is_empty();
        if let Some(word) = block.code(Group::Motion).filter(|word| word.number <= 30) {
            self.modal.motion = word.number;
        }
        let moves = matches!(self.modal.motion, 0..=30) && block.has_axes() && !self.compensates();
        if let Some(target) = self.target(block).ok().filter(|_| moves && self.lathe.is_none()) {
            self.at = target;
            self.here = self.frame.to_machine(&target);
        }
    }

    /// Finds the programmed position again after offsets have changed: the machine has not moved.
    pub(super) fn offsets_changed(&mut self) {
        self.at = self.frame.to_program(&self.here);
    }

    /// Programmed position in the unit of the program.
    pub(super) fn shown_position(&self, axis: usize) -> f64 {
        let value = self.at[axis];
        match axis {
            3..=5 => value,
            0 if self.modal.diameter => 2.0 * value / self.modal.unit_mm,
            _ => value / self.modal.unit_mm,
        }
    }

    /// The parameters that the interpreter itself keeps.
    fn predefined(&self, name: &[u8]) -> Option<f64> {
        let modal = &self.modal;
        let truth = |value: bool| f64::from(u8::from(value));
        let axis = |letter: u8| super::codes::AXIS_LETTERS.iter().position(|&axis| axis == letter);
        Some(match name {
            [b'_', letter] if axis(*letter).is_some() => self.shown_position(axis(*letter)?),
            [b'_', b'a', b'b', b's', b'_', letter] if axis(*letter).is_some() => {
                let index = axis(*letter)?;
                if (3..6).contains(&index) { self.here[index] } else { self.here[index] / modal.unit_mm }
            }
            b"_vmajor" => 2.9,
            b"_vminor" => 0.0,
            b"_line" => f64::from(self.line),
            b"_motion_mode" => f64::from(modal.motion),
            b"_plane" => match modal.plane {
                Plane::Xy => 170.0,
                Plane::Zx => 180.0,
                Plane::Yz => 190.0,
            },
            b"_ccomp" => {
                if self.compensates() {
                    410.0
                } else {
                    400.0
                }
            }
            b"_metric" => truth(modal.unit_mm == 1.0),
            b"_imperial" => truth(modal.unit_mm != 1.0),
            b"_absolute" => truth(!modal.incremental),
            b"_incremental" => truth(modal.incremental),
            b"_ijk_absolute_mode" => truth(modal.arc_absolute),
            b"_inverse_time" => truth(modal.feed_mode == FeedMode::Inverse),
            b"_units_per_minute" => truth(modal.feed_mode == FeedMode::PerMinute),
            b"_units_per_rev" => truth(modal.feed_mode == FeedMode::PerRevolution),
            b"_lathe_diameter_mode" => truth(modal.diameter),
            b"_lathe_radius_mode" => truth(!modal.diameter),
            b"_coord_system" => match self.frame.system {
                system @ 1..=6 => (530 + 10 * system) as f64,
                system => (584 + system) as f64,
            },
            b"_tool_offset" => truth(self.frame.tool != [0.0; 9]),
            b"_retract_r_plane" => truth(modal.retract_to_r),
            b"_retract_old_z" => truth(!modal.retract_to_r),
            b"_spindle_rpm_mode" => truth(modal.constant_surface.is_none()),
            b"_spindle_css_mode" => truth(modal.constant_surface.is_some()),
            b"_spindle_on" => truth(modal.spindle_turns != 0),
            b"_spindle_cw" => truth(modal.spindle_turns > 0),
            b"_mist" => truth(modal.mist),
            b"_flood" => truth(modal.flood),
            b"_speed_override" => truth(modal.speed_override),
            b"_feed_override" => truth(modal.feed_override),
            b"_adaptive_feed" => truth(modal.adaptive_feed),
            b"_feed_hold" => truth(modal.feed_hold),
            b"_feed" => match modal.feed_mode {
                FeedMode::Inverse => modal.feed,
                _ => modal.feed / modal.unit_mm,
            },
            b"_rpm" => modal.spindle_speed,
            b"_current_tool" => f64::from(self.tool),
            b"_selected_tool" => f64::from(self.next_tool),
            b"_current_pocket" => self.settings.tools.get(self.tool).map_or(0.0, |tool| f64::from(tool.pocket)),
            b"_selected_pocket" => self.settings.tools.get(self.next_tool).map_or(-1.0, |tool| f64::from(tool.pocket)),
            b"_value" => self.returned.unwrap_or(0.0),
            b"_value_returned" => truth(self.returned.is_some()),
            b"_task" => 0.0,
            b"_call_level" => self.call_level as f64,
            b"_remap_level" => 0.0,
            _ => return None,
        })
    }
}

impl Values for Interpreter {
    fn is_fanuc(&self) -> bool {
        self.dialect.is_fanuc()
    }

    fn refused(&self, index: usize) -> Option<String> {
        if self.dialect.is_fanuc() { self.refuses_variable(index) } else { None }
    }

    fn numbered(&self, index: usize) -> f64 {
        if self.dialect.is_fanuc()
            && let Some(value) = self.own_variable(index)
        {
            return value;
        }
        match index {
            numbers::POSITION_FIRST..=5428 => self.shown_position(index - numbers::POSITION_FIRST),
            _ => self.parameters.get(index),
        }
    }

    fn named(&self, name: &[u8]) -> Option<f64> {
        match self.parameters.named(name) {
            None if name.first() == Some(&b'_') => self.predefined(name),
            value => value,
        }
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
