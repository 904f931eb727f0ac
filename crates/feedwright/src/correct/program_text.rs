//! The text of a corrected program.
//!
//! If the control runs every line of the original once and in order, all lines stay except the
//! lines of the stretches that have another command. Comments, cycles, rapids, tool changes and
//! line numbers stay as they are in the original. New blocks are written in the coordinates, the
//! unit and the modes of their place. Otherwise (loops, subroutines, jumps) the program is
//! [expanded](super::expanded_text). [`super::verified`] reads the written text again.

use std::collections::BTreeMap;

use feedwright_gcode::canon::{Canon, Event, EventKind, Motion, MotionKind, Plane, Shape};
use feedwright_gcode::{Dialect, ModesInForce, visible};

use super::block_words::{BlockWords, corner_words, dwell, feed_number, plane_word};
use super::source::SourceProgram;
use super::source_line::{PartedLine, has_macros, with_dwell, with_feed, with_word};
use super::stretches::{ProgramPart, SmoothStretch, StretchCommand, dwells, stretches};
use super::target::TargetControl;

/// Inputs of the text.
pub(super) struct TextParts<'a> {
    pub(super) source: &'a SourceProgram,
    pub(super) parts: &'a [ProgramPart],
    pub(super) commands: &'a [StretchCommand],
    /// A dwell for each stretch, s.
    pub(super) rests_s: &'a [f64],
    pub(super) target: &'a TargetControl,
    /// Comments that the program carries about itself.
    pub(super) notes: &'a [String],
}

/// Change to lines of the original.
#[derive(Debug, Default)]
struct LineEdit {
    /// Last line of the edit; it is before the first line if the edit only inserts text.
    to: usize,
    text: Vec<String>,
    /// True where the lines stay, between `text` and `behind`.
    stay: bool,
    behind: Vec<String>,
}

/// Words that the next moving line must contain, because the line that held them has been replaced.
#[derive(Debug, Default)]
struct NeededWords {
    code: bool,
    feed: bool,
}

pub(super) fn line_of(step: &Canon) -> usize {
    match step {
        Canon::Motion(motion) => motion.line as usize,
        Canon::Event(event) => event.line as usize,
    }
}

/// Reason why the lines of the original cannot stay.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum UnkeptLines {
    /// The lines are not executed in order, the control does not run their macros, or lines between
    /// corrected ones cannot stay alone.
    Program,
    /// Lines of these stretches, which have another command, cannot be taken apart.
    Stretches(Vec<usize>),
}

impl TextParts<'_> {
    /// Returns the dialect in which the control reads the text.
    pub(super) fn dialect(&self) -> Dialect {
        self.target.reads_as(self.source.dialect)
    }

    /// Returns the original with new blocks for the stretches that have another command.
    ///
    /// # Errors
    /// The reason why the lines of the original cannot stay.
    pub(super) fn kept(&self) -> Result<String, UnkeptLines> {
        let runs = self.target.runs_macros_of(self.source.dialect)
            || !self.source.lines.iter().any(|line| has_macros(line));
        if !runs || !self.source.steps.is_sorted_by_key(line_of) {
            return Err(UnkeptLines::Program);
        }
        let mut edits: BTreeMap<usize, LineEdit> = BTreeMap::new();
        let all: Vec<&SmoothStretch> = stretches(self.parts).collect();
        // A stretch that stays as programmed has an edit if the command before it needs a rest.
        let of_command = |number: usize| {
            if self.commands[number].is_some() {
                number
            } else {
                number.saturating_sub(1)
            }
        };
        let mut unkept: Vec<usize> = (0..all.len())
            .filter(|&number| self.edit(all[number], number, &mut edits).is_none())
            .map(of_command)
            .collect();
        unkept.dedup();
        if !unkept.is_empty() {
            return Err(UnkeptLines::Stretches(unkept));
        }
        self.edited(edits).ok_or(UnkeptLines::Program)
    }

    /// Adds the edits of the lines of a stretch; none if the lines cannot be taken apart.
    fn edit(
        &self,
        stretch: &SmoothStretch,
        number: usize,
        edits: &mut BTreeMap<usize, LineEdit>,
    ) -> Option<()> {
        let rests = dwells(stretch, self.commands, number, self.rests_s);
        if let Some(command) = &self.commands[number] {
            if let (Some(approach), Some((step, _))) = (&command.approach, &stretch.rapid) {
                edits.insert(
                    self.begins(*step)?,
                    self.replaced([*step; 2], approach, [None; 2])?,
                );
            }
            let edit = if command.motions == stretch.motions {
                let [text, behind] = rests.map(|rest| self.rest(rest));
                LineEdit {
                    to: line_of(&self.source.steps[stretch.steps[1]]),
                    text,
                    stay: true,
                    behind,
                }
            } else {
                self.replaced(stretch.steps, &command.motions, rests)?
            };
            edits.insert(self.begins(stretch.steps[0])?, edit);
        } else if rests[0].is_some() {
            let from = self.begins(stretch.steps[0])?;
            edits.insert(
                from,
                LineEdit {
                    to: from - 1,
                    text: self.rest(rests[0]),
                    ..LineEdit::default()
                },
            );
        }
        Some(())
    }

    /// Returns the line of a rest, if there is one.
    fn rest(&self, seconds: Option<f64>) -> Vec<String> {
        seconds
            .map(|seconds| dwell(seconds, self.dialect()))
            .into_iter()
            .collect()
    }

    /// Returns the line on which a step begins: the line of its motion, or the first line of its
    /// curve. None if a line of the curve cannot be taken apart.
    fn begins(&self, step: usize) -> Option<usize> {
        let steps = &self.source.steps;
        let ends = line_of(&steps[step]);
        if !matches!(
            &steps[step],
            Canon::Motion(Motion {
                shape: Shape::Spline(_),
                ..
            })
        ) {
            return Some(ends);
        }
        let before = step
            .checked_sub(1)
            .map_or(0, |before| line_of(&steps[before]));
        for line in before + 1..=ends {
            if PartedLine::parse(self.source.lines.get(line - 1)?)?.collects_curve() {
                return Some(line);
            }
        }
        Some(ends)
    }

    /// Returns the lines of the original with their edits.
    fn edited(&self, edits: BTreeMap<usize, LineEdit>) -> Option<String> {
        let mut text = Vec::new();
        let mut next = 1;
        let mut needs = NeededWords::default();
        for (from, edit) in edits {
            if from < next {
                return None;
            }
            self.copy(next..from, &mut needs, &mut text)?;
            text.extend(edit.text);
            next = edit.to + 1;
            if edit.stay {
                self.copy(from..next, &mut needs, &mut text)?;
            } else if edit.to >= from {
                needs = NeededWords {
                    code: true,
                    feed: true,
                };
            }
            text.extend(edit.behind);
        }
        self.copy(next..self.source.lines.len() + 1, &mut needs, &mut text)?;
        self.put_notes(&mut text);
        Some(joined(&text))
    }

    /// Copies lines unchanged. The first line that moves gets its code and its feedrate if the line
    /// that held them was replaced.
    fn copy(
        &self,
        lines: std::ops::Range<usize>,
        needs: &mut NeededWords,
        text: &mut Vec<String>,
    ) -> Option<()> {
        for number in lines {
            let mut copied = self.source.lines.get(number - 1)?.clone();
            if let Some(feed_mm_s) = self.source.feed_mm_s {
                copied = with_feed(&copied, &self.feed(feed_mm_s, number));
            }
            if let Some(seconds) = self.dwell_of(number) {
                copied = with_dwell(&copied, &dwell(seconds, self.dialect()));
            }
            if needs.code
                && let Some(parsed) = PartedLine::parse(&copied)
            {
                if parsed.has_code() {
                    needs.code = false;
                } else if parsed.has("XYZIJK") {
                    copied = self.with_code(number, &copied)?;
                    needs.code = false;
                }
            }
            if needs.feed
                && let Some(parsed) = PartedLine::parse(&copied)
            {
                if parsed.has("F") {
                    needs.feed = false;
                } else if let Some(feed_mm_s) = self.feed_of(number) {
                    copied = with_word(&copied, &format!("F{}", self.feed(feed_mm_s, number)));
                    needs.feed = false;
                }
            }
            text.push(copied);
        }
        Some(())
    }

    /// Returns the steps of a line, in the order of the program.
    fn steps_of(&self, line: usize) -> impl Iterator<Item = &Canon> {
        let steps = &self.source.steps;
        let of_line = &steps[steps.partition_point(|step| line_of(step) < line)..];
        of_line.iter().take_while(move |step| line_of(step) == line)
    }

    /// Returns the feedrate of the feed motion on a line, mm/s.
    fn feed_of(&self, line: usize) -> Option<f64> {
        self.steps_of(line).find_map(|step| match step {
            Canon::Motion(motion) if motion.kind == MotionKind::Feed => Some(motion.feed_mm_s),
            _ => None,
        })
    }

    /// Returns the time of the dwell on a line if the control would read it in another unit, s.
    fn dwell_of(&self, line: usize) -> Option<f64> {
        if self.dialect() == self.source.dialect {
            return None;
        }
        self.steps_of(line).find_map(|step| match step {
            Canon::Event(Event {
                kind: EventKind::Dwell { seconds },
                ..
            }) => Some(*seconds),
            _ => None,
        })
    }

    /// Formats a feedrate for an F word on a line.
    fn feed(&self, feed_mm_s: f64, line: usize) -> String {
        let steps = &self.source.steps;
        let step = steps
            .partition_point(|step| line_of(step) < line)
            .min(steps.len().saturating_sub(1));
        feed_number(feed_mm_s, self.source.modes(step).unit_mm)
    }

    /// Adds the motion code to a line that moves by the code of an earlier line.
    fn with_code(&self, number: usize, line: &str) -> Option<String> {
        let moves = |step: &&Canon| matches!(step, Canon::Motion(_)) && line_of(step) == number;
        let Some(Canon::Motion(motion)) = self.source.steps.iter().find(moves) else {
            return Some(line.to_owned());
        };
        let code = match (&motion.shape, motion.kind) {
            (Shape::Line, MotionKind::Rapid) => "G0",
            (Shape::Line, MotionKind::Feed) => "G1",
            (Shape::Arc { turns, .. }, _) if *turns > 0 => "G3",
            (Shape::Arc { .. }, _) => "G2",
            (Shape::Spline(_), _) => return None,
        };
        let body = line.trim_start();
        let is_number = body.starts_with(['N', 'n']);
        let end = if is_number {
            body[1..]
                .find(|c: char| !c.is_ascii_digit())
                .map_or(body.len(), |k| k + 1)
        } else {
            0
        };
        Some(format!(
            "{}{}{code} {}",
            &body[..end],
            if end > 0 { " " } else { "" },
            body[end..].trim_start()
        ))
    }

    /// Writes new blocks for the lines of some steps, with rests before and after.
    fn replaced(
        &self,
        [first, last]: [usize; 2],
        command: &[Motion],
        rests: [Option<f64>; 2],
    ) -> Option<LineEdit> {
        let steps = &self.source.steps;
        let (from, to) = (self.begins(first)?, line_of(&steps[last]));
        let (modes, at_end) = (self.source.modes(first), self.source.modes(last));
        let plain = |modes: &ModesInForce| !modes.changes_coordinates && modes.feed_per_minute;
        let same_places = modes.unit_mm == at_end.unit_mm
            && modes.same_frame(at_end)
            && !self.source.sets_offsets_within([first, last]);
        if !(same_places && plain(modes) && plain(at_end)) {
            return None;
        }
        let (mut before, mut behind) = (Vec::new(), Vec::new());
        for line in from..=to {
            let parsed = PartedLine::parse(self.source.lines.get(line - 1)?)?;
            before.extend(parsed.comments.iter().cloned());
            let rest = parsed.without_motion();
            if rest.is_empty() || line > from && !parsed.has("MST") {
                continue;
            }
            let early = steps[..first]
                .iter()
                .rev()
                .take_while(|step| line_of(step) >= line)
                .count();
            let late = steps[last + 1..]
                .iter()
                .take_while(|step| line_of(step) <= line)
                .count();
            match (early, late) {
                (_, 0) => before.push(rest),
                (0, _) => behind.push(rest),
                _ => return None,
            }
        }
        let [rest_before, rest_behind] = rests.map(|rest| self.rest(rest));
        let mut text = before;
        text.extend(rest_before);
        let [enter, leave] = self.around([modes, at_end], command);
        text.extend(enter);
        let mut words = BlockWords::new(self.target, Some(modes));
        for motion in command {
            text.push(words.motion(motion)?);
        }
        text.extend(words.plane_back());
        text.extend(leave);
        text.extend(rest_behind);
        text.extend(behind);
        text.retain(|line| !line.is_empty());
        Some(LineEdit {
            to,
            text,
            ..LineEdit::default()
        })
    }

    /// Inserts the notes as comments after `%` and the program number.
    pub(super) fn put_notes(&self, text: &mut Vec<String>) {
        let at = text.iter().take_while(|line| is_head(line)).count();
        let notes = self
            .notes
            .iter()
            .map(|note| format!("({})", visible(note).replace(['(', ')'], " ")));
        text.splice(at..at, notes);
    }
}

/// Returns true if a line before the first block is empty, `%` or the program number.
pub(super) fn is_head(line: &str) -> bool {
    let line = line.trim_start();
    line.is_empty() || line.starts_with('%') || line.starts_with(['O', 'o']) && !line.contains(' ')
}

pub(super) fn joined(lines: &[String]) -> String {
    lines.iter().map(|line| format!("{line}\n")).collect()
}

impl TextParts<'_> {
    /// Returns the codes that set the modes that the new blocks need, and the codes that restore
    /// the modes of the program after them.
    fn around(
        &self,
        [before, behind]: [&ModesInForce; 2],
        command: &[Motion],
    ) -> [Option<String>; 2] {
        let corner = command
            .first()
            .map_or(before.corner, |motion| motion.corner);
        let words = |now: &ModesInForce, wanted: &ModesInForce| {
            let distance = if wanted.incremental { "G91" } else { "G90" };
            let center = if wanted.arc_absolute {
                "G90.1"
            } else {
                "G91.1"
            };
            let words = [
                (now.incremental != wanted.incremental).then(|| distance.to_owned()),
                (now.arc_absolute != wanted.arc_absolute).then(|| center.to_owned()),
                (now.plane != wanted.plane).then(|| plane_word(wanted.plane).to_owned()),
                (now.corner != wanted.corner)
                    .then(|| corner_words(wanted.corner, wanted.unit_mm, self.dialect())),
            ];
            let words: Vec<String> = words
                .into_iter()
                .flatten()
                .filter(|word| !word.is_empty())
                .collect();
            (!words.is_empty()).then(|| words.join(" "))
        };
        let mut blocks = before.clone();
        (
            blocks.incremental,
            blocks.arc_absolute,
            blocks.plane,
            blocks.corner,
        ) = (false, false, Plane::Xy, corner);
        [words(before, &blocks), words(&blocks, behind)]
    }
}
