//! Pieces, phases and events on the clock, in the order in which they become known.

use feedwright_gcode::canon::{Event, EventKind};

use super::{FeedMember, FeedPlanner, Phase, Span, TimedEvent};
use crate::constraints::{Constraints, LimitsError};
use crate::paired::unchanged::UnchangedSteps;
use crate::paired::{PairedStep, PairedSteps, PlannedPiece};
use crate::path::pieces::ArcLength;
use crate::path::{MAX_REST_S, PathError, Piece, Rest, Steps};
use crate::plc::Plc;
use std::collections::VecDeque;
use std::sync::Arc;

/// M-codes that take effect with the next motion and so do not interrupt it: digital and analogue
/// outputs synchronised with motion.
const CODES_THAT_DO_NOT_STOP: [u16; 3] = [62, 63, 67];

/// Item that a plan hands out.
#[derive(Debug, Clone)]
pub enum Planned {
    /// The next piece of the programmed path.
    Programmed(Piece),
    /// The next piece of the planned path; its phases come later.
    Piece(PlannedPiece),
    /// The next phase.
    Phase(Phase),
    /// The next event; it happens between the phase before and the phase after.
    Event(TimedEvent),
}

/// Receives everything that a plan hands out, in order.
pub trait PlanSink: Sync {
    /// Receives the next item.
    fn planned(&self, planned: &Planned);
}

/// Most of what a plan hands out that is kept, 30 MB.
const MOST_KEPT: usize = 100_000;

/// A plan that was made, for more cuts of the same path within the same limits: all that it handed
/// out.
#[derive(Debug, Clone)]
pub struct KeptPlan(Arc<[Planned]>);

/// The plan of a path, made as it is read; `None` when all has been handed out.
pub struct Plan<'p> {
    source: PlanSource<'p>,
    /// All that was handed out, where it is kept.
    keeps: Option<Vec<Planned>>,
    sink: Option<&'p dyn PlanSink>,
}

/// Source of a plan.
enum PlanSource<'p> {
    Made(Box<PlanInMaking<'p>>),
    /// Kept plan, and the index of its next item.
    Kept(KeptPlan, usize),
}

/// A plan that is being made.
struct PlanInMaking<'p> {
    steps: PairedSteps<'p>,
    rapid_mm_s: f64,
    plc: Plc,
    planner: Box<dyn FeedPlanner>,
    /// Planned pieces so far, and the length of the last.
    pieces: u64,
    last_mm: f64,
    /// The next piece starts from rest.
    stop: bool,
    /// Events and rests between pieces, in order.
    between: VecDeque<Between>,
    clock: ArcLength,
    ready: VecDeque<Planned>,
    fault: Option<PathError>,
    finished: bool,
}

/// Something between two pieces.
#[derive(Debug, Clone)]
struct Between {
    /// Number of the planned piece that it comes before.
    before: u64,
    /// Place of the tool then: its piece, and the arc length in it, mm.
    piece: u64,
    from_mm: f64,
    event: Option<Event>,
    /// Time that the tool rests, s, and the line that causes it.
    rest: Option<(f64, u32)>,
}

impl<'p> Plan<'p> {
    /// Plans the steps of a program with `planner`; `plc` adds the waits for PLC and spindle.
    ///
    /// # Errors
    /// If a limit is outside its allowed range. With a planner that needs axis limits, also if one
    /// of them or the path tolerance is missing.
    pub fn new(
        steps: Steps<'p>,
        constraints: &Constraints,
        planner: &FeedMember,
        plc: Plc,
    ) -> Result<Self, LimitsError> {
        Self::of_paired(
            Box::new(UnchangedSteps::new(steps)),
            constraints,
            planner,
            plc,
        )
    }

    /// Plans as [`Plan::new`] does, along a planned path beside the programmed one.
    ///
    /// # Errors
    /// Fails as [`Plan::new`] does.
    pub fn of_paired(
        steps: PairedSteps<'p>,
        constraints: &Constraints,
        planner: &FeedMember,
        plc: Plc,
    ) -> Result<Self, LimitsError> {
        constraints.check()?;
        if planner.needs_axes {
            constraints.check_axes()?;
        }
        let made = PlanInMaking {
            steps,
            rapid_mm_s: constraints.path.rapid_mm_s,
            plc,
            planner: (planner.make)(constraints),
            pieces: 0,
            last_mm: 0.0,
            stop: true,
            between: VecDeque::new(),
            clock: ArcLength::default(),
            ready: VecDeque::new(),
            fault: None,
            finished: false,
        };
        Ok(Self {
            source: PlanSource::Made(Box::new(made)),
            keeps: None,
            sink: None,
        })
    }

    /// The same plan once more, without planning.
    pub fn again(kept: &KeptPlan) -> Self {
        Self {
            source: PlanSource::Kept(kept.clone(), 0),
            keeps: None,
            sink: None,
        }
    }

    /// Keeps what it hands out, for [`Plan::into_kept`].
    #[must_use]
    pub fn keeping(self) -> Self {
        Self {
            keeps: Some(Vec::new()),
            ..self
        }
    }

    /// All that it handed out, where it came to its end without a fault and was not too long to be
    /// kept.
    pub fn into_kept(self) -> Option<KeptPlan> {
        let PlanSource::Made(made) = self.source else {
            return None;
        };
        let ended = made.finished
            && made.ready.is_empty()
            && made.between.is_empty()
            && made.fault.is_none();
        self.keeps.filter(|_| ended).map(|all| KeptPlan(all.into()))
    }

    /// Reports everything that the plan hands out to `sink`.
    #[must_use]
    pub fn reporting_to(self, sink: Option<&'p dyn PlanSink>) -> Self {
        Self { sink, ..self }
    }

    /// Why the path ends early, if it does; known once the plan has ended.
    pub const fn fault(&self) -> Option<&PathError> {
        match &self.source {
            PlanSource::Made(made) => made.fault.as_ref(),
            PlanSource::Kept(..) => None,
        }
    }
}

impl PlanInMaking<'_> {
    fn read_step(&mut self) {
        match self.steps.next() {
            Some(Ok(PairedStep::Programmed(piece))) => {
                self.ready.push_back(Planned::Programmed(piece));
            }
            Some(Ok(PairedStep::Planned(piece))) => self.piece(piece),
            Some(Ok(PairedStep::Event(event))) => self.event(event),
            Some(Ok(PairedStep::Rest(rest))) => self.rest(rest),
            Some(Err(error)) => {
                self.fault = Some(error);
                self.finish();
            }
            None => self.finish(),
        }
    }

    fn piece(&mut self, planned: PlannedPiece) {
        self.planner.push(&planned.piece, self.stop);
        self.stop = false;
        self.pieces += 1;
        self.last_mm = planned.piece.length_mm;
        self.ready.push_back(Planned::Piece(planned));
    }

    fn rest(&mut self, rest: Rest) {
        let Rest {
            line,
            seconds,
            turn_deg,
            further_mm,
        } = rest;
        self.stop = true;
        let least_s = self.plc.turn_s(turn_deg).max(further_mm / self.rapid_mm_s);
        let seconds = seconds.max(least_s).min(MAX_REST_S);
        self.between(None, Some((seconds, line)));
    }

    fn event(&mut self, event: Event) {
        self.stop |= match event.kind {
            EventKind::Dwell { .. }
            | EventKind::SpindleSync { .. }
            | EventKind::Probe
            | EventKind::ProgramEnd => true,
            EventKind::MCode { code, .. } => !CODES_THAT_DO_NOT_STOP.contains(&code),
            EventKind::SpindleSpeed { .. }
            | EventKind::ToolSelect { .. }
            | EventKind::Message { .. } => false,
        };
        let seconds = self.plc.takes_s(&event.kind);
        let rest = (seconds > 0.0).then_some((seconds, event.line));
        self.stop |= rest.is_some();
        self.between(Some(event), rest);
    }

    fn between(&mut self, event: Option<Event>, rest: Option<(f64, u32)>) {
        // Before the first piece the tool is at the start of it.
        let piece = self.pieces.saturating_sub(1);
        self.between.push_back(Between {
            before: self.pieces,
            piece,
            from_mm: self.last_mm,
            event,
            rest,
        });
    }

    fn finish(&mut self) {
        self.finished = true;
        self.planner.finish();
    }

    fn span(&mut self, span: Span) {
        self.happen_before(span.piece);
        let Span {
            piece,
            from_mm,
            duration_s,
            speed_mm_s,
            accel_mm_s2,
            jerk_mm_s3,
            motion,
        } = span;
        let tau_s = self.clock.advance(duration_s);
        let phase = Phase {
            tau_s,
            duration_s,
            piece,
            from_mm,
            speed_mm_s,
            accel_mm_s2,
            jerk_mm_s3,
            motion,
            rest: None,
        };
        self.ready.push_back(Planned::Phase(phase));
    }

    /// Hands out what comes before a planned piece.
    fn happen_before(&mut self, piece: u64) {
        while self
            .between
            .front()
            .is_some_and(|between| between.before <= piece)
        {
            let Some(Between {
                piece,
                from_mm,
                event,
                rest,
                ..
            }) = self.between.pop_front()
            else {
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
                let (speed_mm_s, accel_mm_s2, jerk_mm_s3) = (0.0, 0.0, 0.0);
                let rest = Some(line);
                let phase = Phase {
                    tau_s,
                    duration_s,
                    piece,
                    from_mm,
                    speed_mm_s,
                    accel_mm_s2,
                    jerk_mm_s3,
                    motion: None,
                    rest,
                };
                self.ready.push_back(Planned::Phase(phase));
            }
        }
    }
}

impl Iterator for Plan<'_> {
    type Item = Planned;

    fn next(&mut self) -> Option<Planned> {
        let planned = match &mut self.source {
            PlanSource::Made(made) => made.next(),
            PlanSource::Kept(kept, next) => {
                *next += 1;
                kept.0.get(*next - 1).cloned()
            }
        }?;
        if let Some(all) = &mut self.keeps {
            all.push(planned.clone());
            if all.len() > MOST_KEPT {
                self.keeps = None;
            }
        }
        if let Some(sink) = self.sink {
            sink.planned(&planned);
        }
        Some(planned)
    }
}

impl PlanInMaking<'_> {
    fn next(&mut self) -> Option<Planned> {
        loop {
            if let Some(planned) = self.ready.pop_front() {
                return Some(planned);
            }
            // One span at a time: a long block is planned while it is handed out.
            if let Some(span) = self.planner.pop() {
                self.span(span);
            } else if !self.finished {
                self.read_step();
            } else if self.between.is_empty() {
                return None;
            } else {
                self.happen_before(u64::MAX);
            }
        }
    }
}
