//! Branches and loops: what is carried out, what is passed over.

use crate::flow::owords::{Arguments, Head, Keyword};
use crate::flow::program::{Flow, Loop, Purpose, Skip, SubroutineKind, cannot_read};
use crate::text::diagnostic::{LineFault, Read};
use crate::text::source::Mark;

/// Labels of branches and loops that are remembered, far more than anybody writes by hand; what
/// comes then is not checked.
const MAX_LABELS: usize = 100_000;

impl Flow {
    /// Branches and loops.
    pub(super) fn carry_out(
        &mut self,
        head: &Head,
        arguments: Option<Arguments>,
        line: u32,
    ) -> Read<()> {
        let value = arguments.map_or(0.0, |arguments| arguments.values[0]);
        let is_true = value != 0.0;
        match head.keyword {
            Keyword::Sub | Keyword::If | Keyword::Do | Keyword::Repeat => {
                self.take_label(head, line)?;
            }
            Keyword::While if !self.ends_do(head) => self.take_label(head, line)?,
            Keyword::ElseIf | Keyword::Else | Keyword::EndIf => self.find_label(head)?,
            _ => {}
        }
        match head.keyword {
            Keyword::Number
            | Keyword::EndIf
            | Keyword::Call
            | Keyword::Return
            | Keyword::EndSub => {}
            Keyword::Sub => {
                if self.frames.last().is_some_and(|frame| {
                    frame.kind == SubroutineKind::Fanuc && frame.label == head.label
                }) {
                    return Err(LineFault::new(
                        "gcode::o_word",
                        head.at.clone(),
                        "a subroutine with `sub` is called by `call`, not by M98",
                    ));
                }
                if !self.frames.is_empty() {
                    return Err(LineFault::new(
                        "gcode::o_word",
                        head.at.clone(),
                        "a subroutine is defined inside a subroutine",
                    ));
                }
                self.pass(head, Purpose::Definition, line);
            }
            Keyword::If if !is_true => self.pass(head, Purpose::Branch, line),
            Keyword::If => {}
            Keyword::ElseIf | Keyword::Else => self.pass(head, Purpose::EndOfBranches, line),
            Keyword::While => return self.meet_while(head, is_true, line),
            Keyword::Do => self.begin_loop(head, 0)?,
            Keyword::Repeat if value.round_ties_even() < 1.0 => {
                self.pass(head, Purpose::EndOfLoop, line);
            }
            Keyword::Repeat => self.begin_loop(head, value.round_ties_even() as u64)?,
            Keyword::EndWhile | Keyword::EndRepeat => return self.end_round(head),
            Keyword::Break => {
                let kind = self.find_loop(head)?.kind;
                self.leaves(head, kind);
                self.broke = (kind != Keyword::Repeat).then_some(line);
                self.loops.pop();
                self.pass(head, Purpose::EndOfLoop, line);
            }
            Keyword::Continue => {
                let kind = self.find_loop(head)?.kind;
                self.leaves(head, kind);
                if kind == Keyword::While {
                    return self.end_round(head);
                }
                self.pass(head, Purpose::NextRound, line);
            }
        }
        Ok(())
    }

    /// Warns of a `break` or `continue` of a `repeat`.
    fn leaves(&mut self, head: &Head, kind: Keyword) {
        if kind == Keyword::Repeat {
            let message = format!(
                "LinuxCNC refuses `{}` in a repeat: it has no such label",
                head.keyword.spelled()
            );
            let fault = LineFault::new("gcode::o_word", head.at.clone(), message);
            self.warning = Some(fault.hint("write the loop with while"));
        }
    }

    /// A branch or loop with a faulty condition begins all the same: its end is no fault. The
    /// branch is read, the loop passed over.
    #[cold]
    pub(super) fn begin_anyway(&mut self, head: &Head, line: u32) {
        // This line already has a fault. Another one is not reported.
        let _ = match head.keyword {
            Keyword::If => self.take_label(head, line),
            Keyword::Repeat => self
                .take_label(head, line)
                .map(|()| self.pass(head, Purpose::EndOfLoop, line)),
            Keyword::While if self.ends_do(head) => self
                .find_loop(head)
                .map(|_| ())
                .map(|()| drop(self.loops.pop())),
            Keyword::While => self
                .take_label(head, line)
                .map(|()| self.pass(head, Purpose::EndOfLoop, line)),
            _ => Ok(()),
        };
    }

    pub(super) fn pass(&mut self, head: &Head, purpose: Purpose, line: u32) {
        self.skip = Some(Skip {
            label: head.label.clone(),
            purpose,
            line,
        });
    }

    /// Passes a loop over whose condition does not hold.
    pub(super) fn pass_loop(&mut self, head: &Head, line: u32) {
        self.pass(head, Purpose::EndOfLoop, line);
    }

    pub(super) fn begin_loop(&mut self, head: &Head, repeats: u64) -> Read<()> {
        let base = self.frames.last().map_or(0, |frame| frame.loops);
        // A loop that was left by a jump ends when it begins anew.
        if let Some(old) = self.loops[base..]
            .iter()
            .position(|turn| turn.label == head.label)
        {
            self.loops.truncate(base + old);
        }
        if self.loops.len() >= base + self.max_depth {
            return Err(LineFault::new(
                "gcode::depth",
                head.at.clone(),
                format!("more than {} loops inside each other", self.max_depth),
            ));
        }
        let source = self.source_ref();
        let (begin, body) = (source.line_start, source.here());
        self.loops.push(Loop {
            label: head.label.clone(),
            kind: head.keyword,
            begin,
            body,
            repeats,
        });
        Ok(())
    }

    /// The innermost loop, which must have the label; inner ones that were left behind end.
    fn find_loop(&mut self, head: &Head) -> Read<&mut Loop> {
        let base = self.frames.last().map_or(0, |frame| frame.loops);
        let Some(found) = self.loops[base..]
            .iter()
            .rposition(|turn| turn.label == head.label)
        else {
            let message = format!(
                "{}: no loop {} is under way here",
                head.keyword.spelled(),
                head.shown()
            );
            return Err(LineFault::new("gcode::o_word", head.at.clone(), message));
        };
        self.loops.truncate(base + found + 1);
        Ok(&mut self.loops[base + found])
    }

    /// Returns true if a `while` ends a loop that began with `do`.
    fn ends_do(&self, head: &Head) -> bool {
        let base = self.frames.last().map_or(0, |frame| frame.loops);
        self.loops[base..]
            .iter()
            .any(|turn| turn.label == head.label && turn.kind == Keyword::Do)
    }

    /// Registers the label of a definition, a branch or a loop. Fails if another line of the same
    /// subroutine already uses this label.
    fn take_label(&mut self, head: &Head, line: u32) -> Read<()> {
        self.label_key(head);
        match self.labels.get(&self.key) {
            Some(&other) if other != line => {
                let message = format!("line {other} has the label {} already", head.shown());
                Err(LineFault::new("gcode::o_word", head.at.clone(), message)
                    .hint("give every subroutine, branch and loop a number of its own"))
            }
            Some(_) => Ok(()),
            None => {
                if self.labels.len() < MAX_LABELS {
                    self.labels.insert(self.key.clone(), line);
                }
                Ok(())
            }
        }
    }

    /// A branch goes on or ends: it must have begun.
    fn find_label(&mut self, head: &Head) -> Read<()> {
        self.label_key(head);
        if self.labels.contains_key(&self.key) || self.labels.len() == MAX_LABELS {
            return Ok(());
        }
        let message = format!(
            "{}: no `{} if` stands before it",
            head.keyword.spelled(),
            head.shown()
        );
        Err(LineFault::new("gcode::o_word", head.at.clone(), message))
    }

    fn label_key(&mut self, head: &Head) {
        self.key.clear();
        self.key.extend_from_slice(&self.current.to_le_bytes());
        if let Some(frame) = self.frames.last() {
            self.key.extend_from_slice(&frame.label);
        }
        // A subroutine may share its number with a branch or a loop.
        self.key.push(if head.keyword == Keyword::Sub {
            b'<'
        } else {
            b'>'
        });
        self.key.extend_from_slice(&head.label);
    }

    /// `while` begins a loop, or ends one that began with `do`.
    fn meet_while(&mut self, head: &Head, is_true: bool, line: u32) -> Read<()> {
        if self.ends_do(head) {
            let body = self.find_loop(head)?.body;
            let broke = self.broke.take();
            if is_true {
                self.warning = broke
                    .map(|line| ends_early(head, line))
                    .or_else(|| self.warning.take());
                return self.jump(body, head);
            }
            self.loops.pop();
            return Ok(());
        }
        if is_true {
            return self.begin_loop(head, 0);
        }
        self.pass(head, Purpose::EndOfLoop, line);
        Ok(())
    }

    /// `endwhile`, `endrepeat`.
    pub(super) fn end_round(&mut self, head: &Head) -> Read<()> {
        let turn = self.find_loop(head)?;
        let ends = match head.keyword {
            Keyword::EndWhile => Keyword::While,
            Keyword::EndRepeat => Keyword::Repeat,
            _ => turn.kind, // `continue` ends any round.
        };
        if turn.kind != ends {
            let (end, kind) = (head.keyword.spelled(), turn.kind.spelled());
            let message = format!("{end} ends no `{} {kind}`", head.shown());
            return Err(LineFault::new("gcode::o_word", head.at.clone(), message));
        }
        match turn.kind {
            Keyword::Repeat => {
                turn.repeats -= 1;
                let (repeats, body) = (turn.repeats, turn.body);
                if repeats > 0 {
                    return self.jump(body, head);
                }
                self.loops.pop();
                Ok(())
            }
            _ => {
                let begin = turn.begin;
                self.loops.pop();
                self.jump(begin, head)
            }
        }
    }

    fn jump(&mut self, mark: Mark, head: &Head) -> Read<()> {
        self.source()
            .jump(mark)
            .map_err(|error| cannot_read(head.at.clone(), &error))
    }
}

/// LinuxCNC carries out another number of rounds.
#[cold]
fn ends_early(head: &Head, line: u32) -> Box<LineFault> {
    let message = format!(
        "LinuxCNC 2.9 ends this loop here: it still obeys `break` in line {line}, which belongs to another loop or was stepped over"
    );
    LineFault::new("gcode::o_word", head.at.clone(), message)
        .hint("write this loop with while and endwhile, or the other one without break")
}
