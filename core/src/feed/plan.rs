//! Pieces, phases and events on the clock, in the order in which they become known.

use super::joint::{Side, joint_cap};
use super::sections::sections;
use super::{FeedPlanner, Limits, LimitsError, MEMBERS, Member, Phase, Span, TimedEvent};
use crate::gcode::canon::{Corner, Event, EventKind};
use crate::path::pieces::ArcLength;
use crate::path::{MAX_REST_S, PathError, Piece, Step, Steps};
use crate::plc::Plc;
use std::collections::VecDeque;

/// M-codes that take effect with the next motion and so do not interrupt it: digital and analogue outputs synchronised with
/// motion.
const CODES_THAT_DO_NOT_STOP: [u16; 3] = [62, 63, 67];

/// What a plan hands out.
#[derive(Debug, Clone)]
pub enum Planned {
    /// The next piece of the path; its phases come later.
    Piece(Piece),
    /// The next phase.
    Phase(Phase),
    /// The next event; it happens between the phase before and the phase after.
    Event(TimedEvent),
}

/// The plan of a path, made as it is read; `None` when all has been handed out.
pub struct Plan<'p> {
    steps: Steps<'p>,
    limits: Limits,
    plc: Plc,
    planner: Box<dyn FeedPlanner>,
    /// Where the last piece ends, and how its corner is taken.
    last: Option<(Side, Corner, f64)>,
    /// Pieces and sections so far.
    pieces: u64,
    sections: u64,
    /// The next piece starts from rest.
    stop: bool,
    /// What happens between pieces, in order.
    between: VecDeque<Between>,
    clock: ArcLength,
    ready: VecDeque<Planned>,
    fault: Option<PathError>,
    finished: bool,
}

/// Something between two pieces.
#[derive(Debug, Clone)]
struct Between {
    /// Number of the section that it comes before.
    section: u64,
    /// Where the tool is then.
    piece: u64,
    from_mm: f64,
    event: Option<Event>,
    /// How long the tool rests, s, and for which line.
    rest: Option<(f64, u32)>,
}

impl<'p> Plan<'p> {
    /// Plans `steps` with the default planner.
    ///
    /// # Errors
    /// Where a limit is none.
    pub fn new(steps: Steps<'p>, limits: &Limits) -> Result<Self, LimitsError> {
        Self::with_planner(steps, limits, &MEMBERS[0])
    }

    /// Plans `steps` with a planner of choice.
    ///
    /// # Errors
    /// Where a limit is none.
    pub fn with_planner(steps: Steps<'p>, limits: &Limits, member: &Member) -> Result<Self, LimitsError> {
        limits.check()?;
        Ok(Self {
            steps,
            limits: *limits,
            plc: Plc::default(),
            planner: (member.make)(limits),
            last: None,
            pieces: 0,
            sections: 0,
            stop: true,
            between: VecDeque::new(),
            clock: ArcLength::default(),
            ready: VecDeque::new(),
            fault: None,
            finished: false,
        })
    }

    /// The plan of a machine whose PLC and spindle hold the motion up.
    #[must_use]
    pub fn with_plc(mut self, plc: Plc) -> Self {
        self.plc = plc;
        self
    }

    /// Why the path ends early, if it does; known once the plan has ended.
    pub const fn fault(&self) -> Option<&PathError> {
        self.fault.as_ref()
    }

    fn read_step(&mut self) {
        match self.steps.next() {
            Some(Ok(Step::Piece(piece))) => self.piece(piece),
            Some(Ok(Step::Event(event))) => self.event(event),
            Some(Ok(Step::Rest { line, seconds, turn_deg, further_mm })) => {
                self.stop = true;
                let least_s = self.plc.turn_s(turn_deg).max(further_mm / self.limits.rapid_mm_s);
                let seconds = seconds.max(least_s).min(MAX_REST_S);
                self.between(None, Some((seconds, line)));
            }
            Some(Err(error)) => {
                self.fault = Some(error);
                self.finish();
            }
            None => self.finish(),
        }
    }

    fn piece(&mut self, piece: Piece) {
        let end = piece.curve.at(piece.length_mm);
        let side =
            |tangent, s_mm| Side { tangent, curvature_1_mm: piece.curve.curvature(s_mm), length_mm: piece.length_mm };
        let cap = match &self.last {
            Some((before, corner, _)) if !self.stop => {
                let after = side(piece.curve.at(0.0).tangent, 0.0);
                joint_cap(before, &after, *corner, &self.limits)
            }
            _ => 0.0,
        };
        self.stop = false;
        // The slowest axis of a motion bounds the others; nothing that moves along is no bound (division by zero).
        let rotary_mm_s = self.plc.most_deg_s() / piece.turn_deg_mm;
        let most_mm_s = rotary_mm_s.min(self.limits.rapid_mm_s / piece.further_mm_mm);
        let (planner, count) = (&mut self.planner, &mut self.sections);
        sections(&piece, self.pieces, cap, most_mm_s, &self.limits, |section| {
            planner.push(section);
            *count += 1;
        });
        self.last = Some((side(end.tangent, piece.length_mm), piece.corner, piece.length_mm));
        self.pieces += 1;
        self.ready.push_back(Planned::Piece(piece));
        self.take_spans();
    }

    fn event(&mut self, event: Event) {
        self.stop |= match event.kind {
            EventKind::Dwell { .. } | EventKind::SpindleSync { .. } | EventKind::Probe | EventKind::ProgramEnd => true,
            EventKind::MCode { code, .. } => !CODES_THAT_DO_NOT_STOP.contains(&code),
            EventKind::SpindleSpeed { .. } | EventKind::ToolSelect { .. } | EventKind::Message { .. } => false,
        };
        let seconds = self.plc.takes_s(&event.kind);
        let rest = (seconds > 0.0).then_some((seconds, event.line));
        self.stop |= rest.is_some();
        self.between(Some(event), rest);
    }

    fn between(&mut self, event: Option<Event>, rest: Option<(f64, u32)>) {
        // Before the first piece the tool is at the start of it.
        let (piece, from_mm) = match &self.last {
            Some((_, _, length_mm)) => (self.pieces - 1, *length_mm),
            None => (0, 0.0),
        };
        self.between.push_back(Between { section: self.sections, piece, from_mm, event, rest });
    }

    fn finish(&mut self) {
        if !self.finished {
            self.finished = true;
            self.planner.finish();
            self.take_spans();
            self.happen_before(u64::MAX);
        }
    }

    fn take_spans(&mut self) {
        while let Some(span) = self.planner.pop() {
            self.happen_before(span.section);
            let Span { piece, from_mm, duration_s, speed_mm_s, accel_mm_s2, .. } = span;
            let tau_s = self.clock.advance(duration_s);
            let phase = Phase { tau_s, duration_s, piece, from_mm, speed_mm_s, accel_mm_s2, rest: None };
            self.ready.push_back(Planned::Phase(phase));
        }
    }

    /// Hands out what comes before a section.
    fn happen_before(&mut self, section: u64) {
        while self.between.front().is_some_and(|between| between.section <= section) {
            let Some(Between { piece, from_mm, event, rest, .. }) = self.between.pop_front() else {
                return;
            };
            if let Some(event) = event {
                self.ready.push_back(Planned::Event(TimedEvent {
                    tau_s: self.clock.total(),
                    duration_s: rest.map_or(0.0, |(seconds, _)| seconds),
                    event,
                }));
            }
            if let Some((duration_s, line)) = rest.filter(|(seconds, _)| *seconds > 0.0) {
                let tau_s = self.clock.advance(duration_s);
                let (speed_mm_s, accel_mm_s2, rest) = (0.0, 0.0, Some(line));
                let phase = Phase { tau_s, duration_s, piece, from_mm, speed_mm_s, accel_mm_s2, rest };
                self.ready.push_back(Planned::Phase(phase));
            }
        }
    }
}

impl Iterator for Plan<'_> {
    type Item = Planned;

    fn next(&mut self) -> Option<Planned> {
        loop {
            if let Some(planned) = self.ready.pop_front() {
                return Some(planned);
            }
            if self.finished {
                return None;
            }
            self.read_step();
        }
    }
}
