//! What came of a correction, and why a program is not to be used.

use std::fmt;

use feedwright_gcode::Diagnostic;
use feedwright_plan::Step;
use serde::Serialize;

use super::expanded_text::UnwritableLine;
use super::exported::ExportedFigures;

/// An RMS or a largest error that is less by no more than this part is no better.
const LEAST_GAIN: f64 = 0.02;
/// The largest error may grow by this, um: it is that of one moment, of cuts that differ by what disturbs them.
const MAX_SLACK_UM: f64 = 0.5;
/// The uncut path may grow by this, um: what the end of a program is off while the tool settles.
const UNCUT_UM: f64 = 5.0;

/// What came of it; serialised, its figures.
#[derive(Debug, Clone, Serialize)]
pub struct CorrectOutcome {
    /// Name of the control.
    pub control: &'static str,
    /// Name of the planner that stands for it.
    pub planner: &'static str,
    /// Why there is no program.
    pub refusal: Option<String>,
    /// A remedy, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hint: Option<String>,
    /// The original as the control cuts it.
    pub original: ExportedFigures,
    /// The corrected program as the control cuts it, read from its own text.
    #[serde(rename = "as_exported")]
    pub corrected: ExportedFigures,
    /// Stretches without a corner.
    pub stretches: usize,
    /// Those that have another command.
    pub stretches_changed: usize,
    /// Whether loops and subroutines had to be written out.
    pub expanded: bool,
    /// Cuts that the correction was found in.
    pub rounds: u32,
    /// Longest rest that was put in, s.
    pub dwell_s: f64,
    /// What the reader warned of.
    #[serde(skip)]
    pub warnings: Vec<Diagnostic>,
    /// The text that was cut, whether it is to be used or not.
    #[serde(skip)]
    pub(crate) written: Option<WrittenProgram>,
    /// The path of the original.
    #[serde(skip)]
    pub(crate) original_steps: Vec<Step>,
    /// Axes that move.
    #[serde(skip)]
    pub(crate) axes: usize,
}

/// A text and the path that it says.
#[derive(Debug, Clone)]
pub(crate) struct WrittenProgram {
    pub(crate) text: String,
    pub(crate) steps: Vec<Step>,
    pub(super) expanded: bool,
}

/// Why there is no text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum UnwrittenProgram {
    /// A line of the original.
    Line(UnwritableLine),
    /// Longer lines than the control takes.
    Columns(usize),
    /// What was written does not mean the same when it is read again.
    ReadOtherwise,
}

impl UnwrittenProgram {
    /// A remedy, where there is one.
    pub(super) fn hint(&self) -> Option<String> {
        match self {
            Self::Line(UnwritableLine { hint, .. }) => Some((*hint).to_owned()),
            Self::Columns(_) | Self::ReadOtherwise => None,
        }
    }
}

impl fmt::Display for UnwrittenProgram {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(UnwritableLine { line, what, .. }) => {
                write!(f, "line {line} has {what}, which a program without loops and subroutines cannot say here")
            }
            Self::Columns(columns) => write!(f, "blocks of it are longer than {columns} characters"),
            Self::ReadOtherwise => write!(
                f,
                "what was written does not mean the same when it is read again: lathe modes, cutter compensation or feeds other than G94 between the \
                 corrected motions"
            ),
        }
    }
}

impl CorrectOutcome {
    /// The text of the corrected program, where it is better.
    pub fn program(&self) -> Option<&str> {
        self.written.as_ref().filter(|_| self.refusal.is_none()).map(|written| written.text.as_str())
    }
}

/// Why a corrected program is not to be used: by the figures of the original and of its text, or by what keeps it from being written.
pub(super) fn refusal(
    original: &ExportedFigures,
    corrected: Option<&ExportedFigures>,
    changed: usize,
    unwritten: Option<&UnwrittenProgram>,
) -> Option<String> {
    if changed == 0 {
        return Some("no stretch of the program gets better by another command".to_owned());
    }
    if let Some(fault) = unwritten {
        return Some(format!("the corrected program cannot be written: {fault}"));
    }
    let ExportedFigures { rms_um, max_um, uncut_um, completed, .. } = corrected?;
    if !completed {
        return Some("the servo loop is unstable".to_owned());
    }
    let worse = |what: &str, was: f64, is: f64| {
        Some(format!("{what} is {is:.2} um as exported, and {was:.2} um of the original"))
    };
    if *rms_um > (1.0 - LEAST_GAIN) * original.rms_um {
        return worse("the RMS error", original.rms_um, *rms_um);
    }
    if *max_um > (1.0 + LEAST_GAIN) * original.max_um + MAX_SLACK_UM {
        return worse("the largest error", original.max_um, *max_um);
    }
    if *uncut_um > original.uncut_um + UNCUT_UM {
        return worse("the uncut path", original.uncut_um, *uncut_um);
    }
    None
}
