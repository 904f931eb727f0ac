//! The text of a corrected program.
//!
//! Where every line of the original is carried out once and in its order, all lines stay but those of the stretches that have another
//! command: comments, cycles, rapids, tool changes and line numbers are the original's, and new blocks are written in the coordinates,
//! the unit and the modes of their place. Otherwise (loops, subroutines, jumps) the program is expanded: each motion and event is
//! written as it is carried out, in the coordinates of its place, with a comment that says so. What is written is read again by [`super::verified`].

use std::collections::BTreeMap;

use super::block_words::{BlockWords, dwell, event, feed_number};
use super::source::SourceProgram;
use super::source_line::{PartedLine, with_feed, with_word};
use super::stretches::{ProgramPart, StretchCommand, dwells, stretches};
use super::target::TargetControl;
use crate::gcode::ModesInForce;
use crate::gcode::canon::{Canon, Corner, EventKind, Motion, MotionKind, Plane, Shape};

/// What the text is made of.
pub(super) struct TextParts<'a> {
    pub(super) source: &'a SourceProgram,
    pub(super) parts: &'a [ProgramPart],
    pub(super) commands: &'a [StretchCommand],
    pub(super) dwell_s: f64,
    pub(super) target: &'a TargetControl,
    /// What the program says of itself.
    pub(super) notes: &'a [String],
}

/// What happens to lines of the original.
#[derive(Debug, Default)]
struct LineEdit {
    /// Last line that is replaced; before the first where lines are only put in front.
    to: usize,
    text: Vec<String>,
}

/// What an expanded program has put in force.
#[derive(Debug)]
struct PlaceWords {
    unit_mm: f64,
    corner: Option<Corner>,
}

/// Words that the next line that moves has to say itself, since a line that said them has been replaced.
#[derive(Debug, Default)]
struct NeededWords {
    code: bool,
    feed: bool,
}

fn line_of(step: &Canon) -> usize {
    match step {
        Canon::Motion(motion) => motion.line as usize,
        Canon::Event(event) => event.line as usize,
    }
}

impl TextParts<'_> {
    /// The original with new blocks in place of those that have another command; none where its lines are not carried out in their order, or
    /// a line that is to be replaced cannot be taken apart.
    pub(super) fn kept(&self) -> Option<String> {
        let steps = &self.source.steps;
        if !steps.is_sorted_by_key(line_of) {
            return None;
        }
        let mut edits: BTreeMap<usize, LineEdit> = BTreeMap::new();
        for (number, stretch) in stretches(self.parts).enumerate() {
            let [before, _] = dwells(self.parts, self.commands, number, self.dwell_s);
            let from = line_of(&steps[stretch.steps[0]]);
            if let Some(command) = &self.commands[number] {
                if let (Some(approach), Some((step, _))) = (&command.approach, &stretch.rapid) {
                    edits.insert(line_of(&steps[*step]), self.replaced([*step; 2], approach, [None; 2])?);
                }
                let rests = dwells(self.parts, self.commands, number, self.dwell_s);
                edits.insert(from, self.replaced(stretch.steps, &command.motions, rests)?);
            } else if let Some(seconds) = before {
                let text = vec![dwell(seconds, self.source.dialect)];
                edits.insert(from, LineEdit { to: from - 1, text });
            }
        }
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
            if edit.to >= from {
                needs = NeededWords { code: true, feed: true };
            }
        }
        self.copy(next..self.source.lines.len() + 1, &mut needs, &mut text)?;
        self.put_notes(&mut text);
        Some(joined(&text))
    }

    /// Lines as they are; the first that moves gets its code, and its feedrate, where the one that said it has gone.
    fn copy(&self, lines: std::ops::Range<usize>, needs: &mut NeededWords, text: &mut Vec<String>) -> Option<()> {
        for number in lines {
            let mut copied = self.source.lines.get(number - 1)?.clone();
            if let Some(feed_mm_s) = self.source.feed_mm_s {
                copied = with_feed(&copied, &self.feed(feed_mm_s, number));
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

    /// Feedrate of the feed motion that a line makes.
    fn feed_of(&self, line: usize) -> Option<f64> {
        let steps = &self.source.steps;
        let of_line = &steps[steps.partition_point(|step| line_of(step) < line)..];
        of_line.iter().take_while(|step| line_of(step) == line).find_map(|step| match step {
            Canon::Motion(motion) if motion.kind == MotionKind::Feed => Some(motion.feed_mm_s),
            _ => None,
        })
    }

    /// A feedrate as an F word of a line says it.
    fn feed(&self, feed_mm_s: f64, line: usize) -> String {
        let steps = &self.source.steps;
        let step = steps.partition_point(|step| line_of(step) < line).min(steps.len().saturating_sub(1));
        feed_number(feed_mm_s, self.source.modes(step).unit_mm)
    }

    /// A line that moves by the code of a line before, with that code.
    fn with_code(&self, number: usize, line: &str) -> Option<String> {
        let moves = |step: &&Canon| matches!(step, Canon::Motion(_)) && line_of(step) == number;
        let Some(Canon::Motion(motion)) = self.source.steps.iter().find(moves) else { return Some(line.to_owned()) };
        let code = match (&motion.shape, motion.kind) {
            (Shape::Line, MotionKind::Rapid) => "G0",
            (Shape::Line, MotionKind::Feed) => "G1",
            (Shape::Arc { turns, .. }, _) if *turns > 0 => "G3",
            (Shape::Arc { .. }, _) => "G2",
            (Shape::Spline(_), _) => return None,
        };
        let body = line.trim_start();
        let is_number = body.starts_with(['N', 'n']);
        let end =
            if is_number { body[1..].find(|c: char| !c.is_ascii_digit()).map_or(body.len(), |k| k + 1) } else { 0 };
        Some(format!("{}{}{code} {}", &body[..end], if end > 0 { " " } else { "" }, body[end..].trim_start()))
    }

    /// New blocks for the lines of some steps, with rests before and behind.
    fn replaced(&self, [first, last]: [usize; 2], command: &[Motion], rests: [Option<f64>; 2]) -> Option<LineEdit> {
        let steps = &self.source.steps;
        let (from, to) = (line_of(&steps[first]), line_of(&steps[last]));
        let (modes, at_end) = (self.source.modes(first), self.source.modes(last));
        if modes != at_end || modes.changes_coordinates || !modes.feed_per_minute {
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
            let early = steps[..first].iter().rev().take_while(|step| line_of(step) >= line).count();
            let late = steps[last + 1..].iter().take_while(|step| line_of(step) <= line).count();
            match (early, late) {
                (_, 0) => before.push(rest),
                (0, _) => behind.push(rest),
                _ => return None,
            }
        }
        let [rests_before, rests_behind] = rests;
        let rest = |seconds: f64| dwell(seconds, self.source.dialect);
        let mut text = before;
        text.extend(rests_before.map(rest));
        let [enter, leave] = around(modes, command);
        text.extend(enter);
        let mut words = BlockWords::new(self.target, Some(modes));
        for motion in command {
            text.push(words.motion(motion)?);
        }
        text.extend(leave);
        text.extend(rests_behind.map(rest));
        text.extend(behind);
        text.retain(|line| !line.is_empty());
        Some(LineEdit { to, text })
    }

    /// Every motion and event as it is carried out, in the unit and the coordinates of its place; none where one of them cannot be said.
    pub(super) fn expanded(&self) -> Option<String> {
        let mut text = vec!["(expanded: loops, subroutines and jumps are written out)".to_owned()];
        text.push("G17 G90 G94".to_owned());
        let mut places = PlaceWords { unit_mm: 0.0, corner: None };
        let mut next = 0;
        let mut number = 0;
        let mut ends = false;
        for part in self.parts {
            let step = next;
            match part {
                ProgramPart::Kept(Canon::Event(kind)) => {
                    next += 1;
                    text.extend(self.place(step, &mut places)?);
                    text.push(event(&kind.kind, self.source.dialect)?);
                    ends |= kind.kind == EventKind::ProgramEnd;
                }
                ProgramPart::Kept(Canon::Motion(motion)) => {
                    next += 1;
                    text.extend(self.place(step, &mut places)?);
                    self.put_motions(step, std::slice::from_ref(motion), &mut places, &mut text)?;
                }
                ProgramPart::Stretch(stretch) => {
                    next += stretch.motions.len();
                    let [before, behind] = dwells(self.parts, self.commands, number, self.dwell_s);
                    let command = self.commands[number].as_ref();
                    number += 1;
                    text.extend(self.place(step, &mut places)?);
                    if let Some(approach) = command.and_then(|command| command.approach.as_ref()) {
                        // What stands behind the rapid stays behind it.
                        let at = text.iter().rposition(|line| line.starts_with("G0 "))?;
                        let behind = text.split_off(at + 1);
                        text.pop();
                        self.put_motions(step, approach, &mut places, &mut text)?;
                        text.extend(behind);
                    }
                    text.extend(before.map(|seconds| dwell(seconds, self.source.dialect)));
                    let motions = command.map_or(&stretch.motions, |command| &command.motions);
                    self.put_motions(step, motions, &mut places, &mut text)?;
                    text.extend(behind.map(|seconds| dwell(seconds, self.source.dialect)));
                }
            }
        }
        text.extend((!ends).then(|| "M2".to_owned()));
        text.retain(|line| !line.is_empty());
        self.put_notes(&mut text);
        Some(joined(&text))
    }

    /// Blocks of motions in the modes of a step.
    fn put_motions(
        &self,
        step: usize,
        motions: &[Motion],
        places: &mut PlaceWords,
        text: &mut Vec<String>,
    ) -> Option<()> {
        let mut words = BlockWords::new(self.target, Some(self.source.modes(step)));
        for motion in motions {
            if motion.kind == MotionKind::Feed && places.corner != Some(motion.corner) {
                text.push(corner_words(motion.corner));
                places.corner = Some(motion.corner);
            }
            text.push(words.motion(motion)?);
        }
        Some(())
    }

    /// The unit of a step, and the words that put its coordinates in force, where they are not those of the step before; none where no line between says
    /// them in plain words.
    fn place(&self, step: usize, places: &mut PlaceWords) -> Option<Vec<String>> {
        let (modes, before) = (self.source.modes(step), self.source.modes_before(step));
        let mut text = Vec::new();
        if places.unit_mm != modes.unit_mm {
            places.unit_mm = modes.unit_mm;
            text.push(if modes.unit_mm > 1.0 { "G20" } else { "G21" }.to_owned());
        }
        if !modes.same_frame(before) {
            let to = line_of(&self.source.steps[step]);
            let from = step.checked_sub(1).map_or(0, |before| line_of(&self.source.steps[before]));
            let lines = if from < to { from + 1..to + 1 } else { to..to + 1 };
            let words = lines.filter_map(|line| PartedLine::parse(self.source.lines.get(line - 1)?)?.frame_words());
            let words: Vec<String> = words.collect();
            if words.is_empty() {
                return None;
            }
            text.extend(words);
        }
        Some(text)
    }

    /// Notes as comments behind `%` and the program's number.
    fn put_notes(&self, text: &mut Vec<String>) {
        let head = |line: &&String| {
            let line = line.trim_start();
            line.is_empty() || line.starts_with('%') || line.starts_with(['O', 'o']) && !line.contains(' ')
        };
        let at = text.iter().take_while(head).count();
        let notes = self.notes.iter().map(|note| format!("({})", note.replace(['(', ')'], " ")));
        text.splice(at..at, notes);
    }
}

fn joined(lines: &[String]) -> String {
    lines.iter().map(|line| format!("{line}\n")).collect()
}

fn corner_words(corner: Corner) -> String {
    match corner {
        Corner::ExactStop => "G61.1".to_owned(),
        Corner::ExactPath => "G61".to_owned(),
        Corner::Continuous { tolerance_mm: None, .. } => "G64".to_owned(),
        Corner::Continuous { tolerance_mm: Some(tolerance_mm), merge_mm: None } => format!("G64 P{tolerance_mm}"),
        Corner::Continuous { tolerance_mm: Some(tolerance_mm), merge_mm: Some(merge_mm) } => {
            format!("G64 P{tolerance_mm} Q{merge_mm}")
        }
    }
}

/// Codes that put modes in force which blocks need, and those that take them back.
fn around(modes: &ModesInForce, command: &[Motion]) -> [Option<String>; 2] {
    let (mut enter, mut leave) = (Vec::new(), Vec::new());
    let mut need = |needed: bool, on: String, off: String| {
        if needed {
            enter.push(on);
            leave.push(off);
        }
    };
    let plane = match modes.plane {
        Plane::Xy => "G17",
        Plane::Zx => "G18",
        Plane::Yz => "G19",
    };
    need(modes.incremental, "G90".to_owned(), "G91".to_owned());
    need(modes.arc_absolute, "G91.1".to_owned(), "G90.1".to_owned());
    need(modes.plane != Plane::Xy, "G17".to_owned(), plane.to_owned());
    let other = command.first().map(|motion| motion.corner).filter(|corner| *corner != modes.corner);
    need(other.is_some(), other.map_or_else(String::new, corner_words), corner_words(modes.corner));
    [enter, leave].map(|words| (!words.is_empty()).then(|| words.join(" ")))
}
