//! Modes that M70 and M73 put away, and the level of calls.

use crate::settings::Dialect;
use crate::state::Interpreter;
use crate::state::frame::Frame;
use crate::state::modal::Modal;
use crate::state::parameters as numbers;
use crate::text::block::Block;
use crate::text::diagnostic::{LineFault, Read};

/// Modes that M70 or M73 has put away.
#[derive(Debug, Clone)]
struct Saved {
    modal: Modal,
    frame: Frame,
    /// True where G92 was active.
    shifted: bool,
    /// M73: they come back when the subroutine returns.
    automatic: bool,
    level: usize,
}

/// Calls of subroutines under way.
#[derive(Debug, Default)]
pub(crate) struct Calls {
    /// Depth of nested calls.
    pub(crate) level: usize,
    /// Result of the last subroutine.
    pub(crate) returned: Option<f64>,
    /// States saved by M70 and M73.
    saved: Vec<Saved>,
}

impl Interpreter {
    /// A subroutine has been entered.
    pub(crate) fn entered(&mut self, level: usize) {
        self.calls.level = level;
        self.calls.returned = None;
    }

    /// A subroutine has returned to `level`.
    pub(crate) fn left(&mut self, level: usize) {
        self.calls.level = level;
        while let Some(saved) = self.calls.saved.pop_if(|saved| saved.level > level) {
            if saved.automatic {
                self.restore(&saved);
            }
        }
        self.calls.returned = None;
    }

    /// M70, M73: puts the modes away; one set for each call level.
    pub(crate) fn save_modes(&mut self, automatic: bool) {
        let saved = Saved {
            modal: self.modal.clone(),
            frame: self.frame.clone(),
            shifted: self.is_shifted(),
            automatic,
            level: self.calls.level,
        };
        self.forget_modes();
        self.calls.saved.push(saved);
    }

    /// M71.
    pub(crate) fn forget_modes(&mut self) {
        let level = self.calls.level;
        self.calls.saved.pop_if(|saved| saved.level == level);
    }

    /// M72.
    pub(crate) fn restore_modes(&mut self, block: &Block) -> Read<()> {
        let level = self.calls.level;
        if let Some(saved) = self
            .calls
            .saved
            .last()
            .filter(|saved| saved.level == level)
            .cloned()
        {
            self.restore(&saved);
        } else if self.dialect == Dialect::LinuxCnc {
            return Err(LineFault::new(
                "gcode::m_code",
                block.whole(),
                "M72 brings modes back that no M70 or M73 has put away",
            )
            .hint("write M70 before it, in the same subroutine"));
        }
        Ok(())
    }

    fn is_shifted(&self) -> bool {
        self.parameters.get(numbers::G92_ACTIVE) != 0.0
    }

    /// Modes come back; a motion mode does not, and offsets that G10 and G92 have changed stay.
    /// Whether G92 is in effect comes back, as if G92.2 or G92.3 stood there.
    fn restore(&mut self, saved: &Saved) {
        let motion = self.modal.motion;
        self.modal = saved.modal.clone();
        self.modal.motion = motion;
        self.frame.system = saved.frame.system;
        self.frame.tool = saved.frame.tool;
        self.load_system();
        if self.is_shifted() != saved.shifted {
            self.shift_mode(if saved.shifted { 923 } else { 922 });
        }
    }
}
