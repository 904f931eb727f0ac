//! The text of a corrected program with loops, subroutines or jumps: the control does not run its
//! lines once and in order.
//!
//! Each motion and event is written in the order of execution, in the unit and the coordinates of
//! its place. A comment marks the program as expanded. Offsets are written with the words of the
//! lines that set them, in the order of execution: the control computes their effect.

use feedwright_gcode::canon::{Canon, Corner, EventKind, Motion, MotionKind, Shape};

use super::block_words::{BlockWords, corner_words, dwell, event};
use super::program_text::{TextParts, is_head, joined, line_of};
use super::source_line::PartedLine;
use super::stretches::{ProgramPart, dwells};

/// A line that cannot be written out.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct UnwritableLine {
    /// Its number in the program.
    pub(super) line: usize,
    /// The element of the line that cannot be written out.
    pub(super) what: &'static str,
    /// A remedy.
    pub(super) hint: &'static str,
}

const SYNCHRONIZED: (&str, &str) = (
    "threads and motions tied to the spindle",
    "correct the program without them, and put them back by hand",
);
const PROBING: (&str, &str) = (
    "probing",
    "correct the program without it, and put it back by hand",
);
const OTHER_AXES: (&str, &str) = (
    "an axis beside X, Y and Z",
    "write the line outside of loops and subroutines",
);
const SPLINES: (&str, &str) = (
    "a spline",
    "write the line outside of loops and subroutines",
);
const OTHER_ARCS: (&str, &str) = (
    "an arc of more than a turn",
    "write the line outside of loops and subroutines",
);
const OFFSETS: (&str, &str) = (
    "offsets that are no plain numbers",
    "write G10, G43, G52, G68 and G92 with numbers in place of parameters, and G54 in place of M72",
);

const OFFSETS_WITHIN: (&str, &str) = (
    "a cut in which offsets change",
    "put G10, G43, G54 and G92 before a rapid",
);

/// Modes that the expanded program has set so far, and its lines.
#[derive(Debug)]
struct ExpandedText {
    unit_mm: f64,
    corner: Option<Corner>,
    lines: Vec<String>,
}

impl TextParts<'_> {
    /// Returns the text: every motion and event in the order of execution, in the unit and the
    /// coordinates of its place.
    ///
    /// # Errors
    /// The first line with a motion or an event that cannot be written.
    pub(super) fn expanded(&self) -> Result<String, UnwritableLine> {
        let mut lines = self.tape_head();
        let is_tape = lines.first().is_some_and(|line| line.starts_with('%'));
        lines.extend(
            [
                "(expanded: loops, subroutines and jumps are written out)",
                "G17 G90 G94",
            ]
            .map(str::to_owned),
        );
        let mut text = ExpandedText {
            unit_mm: 0.0,
            corner: None,
            lines,
        };
        let (mut step, mut number, mut ends) = (0, 0, false);
        for part in self.parts {
            self.put_place(step, &mut text)?;
            match part {
                ProgramPart::Kept(Canon::Event(kind)) => {
                    let fault = if kind.kind == EventKind::Probe {
                        PROBING
                    } else {
                        SYNCHRONIZED
                    };
                    let words = event(&kind.kind, self.dialect());
                    text.lines
                        .push(words.ok_or_else(|| self.unwritable(step, fault))?);
                    ends |= kind.kind == EventKind::ProgramEnd;
                    step += 1;
                }
                ProgramPart::Kept(Canon::Motion(motion)) => {
                    self.put_motions(step, std::slice::from_ref(motion), &mut text)?;
                    step += 1;
                }
                ProgramPart::Stretch(stretch) => {
                    if self.source.sets_offsets_within(stretch.steps) {
                        return Err(self.unwritable(step, OFFSETS_WITHIN));
                    }
                    let motions = self.commands[number]
                        .as_ref()
                        .map_or(&stretch.motions, |command| &command.motions);
                    let [before, behind] = dwells(stretch, self.commands, number, self.rests_s);
                    let rest = |seconds: f64| dwell(seconds, self.dialect());
                    self.put_approach(step, number, &mut text)?;
                    text.lines.extend(before.map(rest));
                    self.put_motions(step, motions, &mut text)?;
                    text.lines.extend(behind.map(rest));
                    number += 1;
                    step += stretch.motions.len();
                }
            }
        }
        let mut lines = text.lines;
        lines.extend((!ends).then(|| "M2".to_owned()));
        lines.extend(is_tape.then(|| "%".to_owned()));
        lines.retain(|line| !line.is_empty());
        self.put_notes(&mut lines);
        Ok(joined(&lines))
    }

    /// Returns `%` and the program number for Fanuc, which identify the text as a Fanuc program.
    fn tape_head(&self) -> Vec<String> {
        let head = self
            .source
            .lines
            .iter()
            .take_while(|line| self.dialect().is_fanuc() && is_head(line));
        head.filter(|line| !line.trim().is_empty())
            .cloned()
            .collect()
    }

    /// The slow end of the rapid that leads to a stretch, in place of the rapid.
    fn put_approach(
        &self,
        step: usize,
        number: usize,
        text: &mut ExpandedText,
    ) -> Result<(), UnwritableLine> {
        let Some(approach) = self.commands[number]
            .as_ref()
            .and_then(|command| command.approach.as_ref())
        else {
            return Ok(());
        };
        if let Some(at) = text.lines.iter().rposition(|line| line.starts_with("G0 ")) {
            // What stands behind the rapid stays behind it.
            let behind = text.lines.split_off(at + 1);
            text.lines.pop();
            self.put_motions(step, approach, text)?;
            text.lines.extend(behind);
        }
        Ok(())
    }

    /// Blocks of motions in the modes of a step.
    fn put_motions(
        &self,
        step: usize,
        motions: &[Motion],
        text: &mut ExpandedText,
    ) -> Result<(), UnwritableLine> {
        let mut words = BlockWords::new(self.target, Some(self.source.modes(step)));
        for motion in motions {
            if motion.kind == MotionKind::Feed && text.corner != Some(motion.corner) {
                text.lines
                    .push(corner_words(motion.corner, text.unit_mm, self.dialect()));
                text.corner = Some(motion.corner);
            }
            let fault = match &motion.shape {
                _ if !motion.others.is_none() => OTHER_AXES,
                Shape::Spline(_) => SPLINES,
                _ => OTHER_ARCS,
            };
            text.lines.push(
                words
                    .motion(motion)
                    .ok_or_else(|| self.unwritable(step, fault))?,
            );
        }
        text.lines.extend(words.plane_back());
        Ok(())
    }

    /// Writes the unit of a step, and the words of the lines before it that set offsets. A change
    /// of coordinates without such words cannot be written.
    fn put_place(&self, step: usize, text: &mut ExpandedText) -> Result<(), UnwritableLine> {
        if step >= self.source.steps.len() {
            return Ok(());
        }
        let (modes, before) = (self.source.modes(step), self.source.modes_before(step));
        if text.unit_mm != modes.unit_mm {
            text.unit_mm = modes.unit_mm;
            text.lines
                .push(if modes.unit_mm > 1.0 { "G20" } else { "G21" }.to_owned());
        }
        let offsets = self.source.offset_lines(step);
        let said = text.lines.len();
        text.lines.extend(
            offsets
                .iter()
                .filter_map(|line| PartedLine::parse(line)?.frame_words()),
        );
        if text.lines.len() - said < offsets.len()
            || said == text.lines.len() && !modes.same_frame(before)
        {
            return Err(self.unwritable(step, OFFSETS));
        }
        Ok(())
    }

    fn unwritable(
        &self,
        step: usize,
        (what, hint): (&'static str, &'static str),
    ) -> UnwritableLine {
        UnwritableLine {
            line: self.source.steps.get(step).map_or(0, line_of),
            what,
            hint,
        }
    }
}
