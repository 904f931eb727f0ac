//! What a program has brought about so far: modes, offsets, position, parameters, and the steps
//! that wait to be fetched.

pub(crate) mod modal;
pub(crate) mod frame;
pub(crate) mod parameters;
pub(crate) mod carried_over;
pub(crate) mod lathe;
pub(crate) mod capture;
pub(crate) mod fanuc;
mod words;
mod offsets;
mod tool_data;
mod saved;
mod values;
pub(crate) mod in_force;

use std::collections::VecDeque;

use crate::canon::{Canon, Event, EventKind};
use crate::settings::{Dialect, Settings};
use crate::state::carried_over::CarriedOver;
use crate::state::fanuc::Fanuc;
use crate::state::frame::{Frame, Position};
use crate::state::lathe::{LatheCycle, ProfileCall};
use crate::state::modal::{Modal, fanuc_modes};
use crate::state::parameters::ParameterTable;
use crate::state::saved::Calls;
use crate::text::diagnostic::LineFault;

/// The extruder of a printer.
#[derive(Debug, Default)]
pub(crate) struct Extruder {
    /// Its position, mm.
    pub(crate) at_mm: f64,
    /// M83: E words are distances.
    pub(crate) is_relative: bool,
}

/// The tool in the spindle, and the one that T has chosen.
#[derive(Debug, Default)]
pub(crate) struct LoadedTool {
    pub(crate) number: u32,
    pub(crate) next: u32,
}

/// Steps and warnings that a program has produced.
#[derive(Debug, Default)]
pub(crate) struct Output {
    /// Steps not yet fetched.
    pub(crate) steps: VecDeque<Canon>,
    /// Motions so far.
    pub(crate) motions: u64,
    /// Warnings of the line under way.
    pub(crate) warnings: Vec<LineFault>,
    /// True where the current line writes offsets or activates others.
    pub(crate) line_sets_offsets: bool,
    /// Text of the lines that did, since the last step was fetched.
    pub(crate) offset_lines: Vec<String>,
}

/// State after the lines so far. `motion`, `dialects` and `flow` apply blocks to it.
#[derive(Debug)]
pub(crate) struct Interpreter {
    pub(crate) settings: Settings,
    pub(crate) dialect: Dialect,
    pub(crate) parameters: ParameterTable,
    pub(crate) modal: Modal,
    pub(crate) frame: Frame,
    /// Programmed position in program coordinates.
    pub(crate) at: Position,
    /// Position of the controlled point in machine coordinates.
    pub(crate) here: Position,
    pub(crate) extruder: Extruder,
    pub(crate) tool: LoadedTool,
    pub(crate) carried: CarriedOver,
    /// The lathe cycle whose profile is being read, and the call that it waits for.
    pub(crate) lathe: Option<Box<LatheCycle>>,
    pub(crate) wanted: Option<ProfileCall>,
    /// Additional state of the Fanuc and Haas dialects.
    pub(crate) fanuc: Fanuc,
    pub(crate) output: Output,
    /// Line under way.
    pub(crate) line: u32,
    /// A feed motion without F was reported: one report is enough.
    pub(crate) missing_feed_reported: bool,
    /// A line was refused, and position or modes are not what they were meant to be since.
    pub(crate) behind_fault: bool,
    /// M2, M30 or the closing %.
    pub(crate) ended: bool,
    pub(crate) calls: Calls,
}

impl Interpreter {
    pub(crate) fn new(settings: Settings, dialect: Dialect) -> Self {
        let mut parameters = ParameterTable::new();
        if dialect.is_fanuc() {
            parameters.empty_variables();
        }
        Self {
            settings,
            dialect,
            parameters,
            modal: if dialect.is_fanuc() {
                fanuc_modes(dialect.is_lathe())
            } else {
                Modal::new()
            },
            frame: Frame::new(),
            at: [0.0; 9],
            here: [0.0; 9],
            extruder: Extruder::default(),
            tool: LoadedTool::default(),
            carried: CarriedOver::default(),
            lathe: None,
            wanted: None,
            fanuc: Fanuc::default(),
            output: Output::default(),
            line: 0,
            missing_feed_reported: false,
            behind_fault: false,
            ended: false,
            calls: Calls::default(),
        }
    }

    /// Hands out an event of the line under way.
    pub(crate) fn event(&mut self, kind: EventKind) {
        self.push(Canon::Event(Event {
            line: self.line,
            kind,
        }));
    }

    /// Hands out a step, behind those that are held back.
    #[inline]
    pub(crate) fn push(&mut self, step: Canon) {
        if self.lathe.is_some() {
            self.keep(step);
        } else if self
            .fanuc
            .capture
            .as_ref()
            .is_some_and(|capture| capture.keeps())
        {
            self.keep_own(step);
        } else if self.carried.held.is_empty() {
            self.output.steps.push_back(step);
        } else {
            self.carried.held.push(step);
        }
    }

    /// Finds the programmed position again after offsets have changed: the machine has not moved.
    pub(crate) fn offsets_changed(&mut self) {
        self.at = self.frame.to_program(&self.here);
        self.output.line_sets_offsets = true;
    }

    /// Programmed position in the unit of the program.
    pub(crate) fn shown_position(&self, axis: usize) -> f64 {
        let value = self.at[axis];
        match axis {
            3..=5 => value,
            0 if self.modal.diameter => 2.0 * value / self.modal.unit_mm,
            _ => value / self.modal.unit_mm,
        }
    }

    /// Returns true if cutter compensation is on.
    pub(crate) const fn compensates(&self) -> bool {
        self.carried.compensation.is_some()
    }

    /// Hands out the motions that were held back.
    pub(crate) fn release(&mut self) {
        self.output.steps.extend(self.carried.held.drain(..));
    }

    /// Hands out the end of the program.
    pub(crate) fn end_program(&mut self) {
        if !self.ended {
            self.ended = true;
            self.lathe = None;
            self.carried.compensation = None;
            self.release();
            self.event(EventKind::ProgramEnd);
        }
    }

    /// Returns true the first time that it is called with a warning code.
    pub(crate) fn warn_once(&mut self, code: &'static str) -> bool {
        let is_new = !self.fanuc.warned.contains(&code);
        if is_new {
            self.fanuc.warned.push(code);
        }
        is_new
    }

    /// Turns the spindle the other way or stops it.
    pub(crate) fn spindle(&mut self, turns: i8) {
        self.modal.spindle_turns = turns;
        let code = match turns {
            1 => 3,
            -1 => 4,
            _ => 5,
        };
        self.event(EventKind::MCode {
            code,
            p: None,
            q: None,
        });
    }
}
