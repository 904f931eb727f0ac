//! A plan over its time.

use crate::feed::{AxisMotion, Phase};
use crate::vector::norm;

/// A span that ends so soon has ended, s: the rounding of an hour.
const AT_S: f64 = 1e-11;

/// A part of a plan with a constant jerk of each axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PublishedSpan {
    /// Plan time at which it begins, s.
    pub(crate) from_s: f64,
    /// Motion of the axes at its start.
    pub(crate) motion: AxisMotion,
    /// True where feed overrides apply: it is not a rapid.
    pub(crate) cutting: bool,
    /// True where the tool rests.
    pub(crate) is_rest: bool,
}

/// Part of a plan that is final.
#[derive(Debug, Default)]
pub struct PublishedPlan {
    spans: Vec<PublishedSpan>,
    end_s: f64,
}

impl PublishedPlan {
    /// Creates a plan without spans.
    pub const fn new() -> Self {
        Self {
            spans: Vec::new(),
            end_s: 0.0,
        }
    }

    /// Adds a phase; `false` where it does not say what the axes do.
    pub fn push(&mut self, phase: &Phase, cutting: bool) -> bool {
        let end_mm = self.at(self.end_s).position_mm;
        let motion = match (phase.motion, phase.rest) {
            (Some(motion), _) => motion,
            (None, Some(_)) => AxisMotion {
                position_mm: end_mm,
                ..AxisMotion::REST
            },
            (None, None) => return false,
        };
        self.spans.push(PublishedSpan {
            from_s: self.end_s,
            motion,
            cutting,
            is_rest: phase.rest.is_some(),
        });
        self.end_s += phase.duration_s;
        true
    }

    /// Plan time at its end, s.
    pub const fn end_s(&self) -> f64 {
        self.end_s
    }

    /// Number of the span at a time.
    fn index(&self, tau_s: f64) -> usize {
        self.spans
            .partition_point(|span| span.from_s <= tau_s)
            .saturating_sub(1)
    }

    /// Span at plan time `tau_s`. After the end of the plan it is the last span; a plan without
    /// spans gives a rest.
    pub(crate) fn span_at(&self, tau_s: f64) -> PublishedSpan {
        let none = PublishedSpan {
            from_s: 0.0,
            motion: AxisMotion::REST,
            cutting: false,
            is_rest: true,
        };
        self.spans.get(self.index(tau_s)).copied().unwrap_or(none)
    }

    /// Returns the motion of the axes at a time. Behind the end they rest.
    pub fn at(&self, tau_s: f64) -> AxisMotion {
        let Some(found) = self.spans.get(self.index(tau_s)) else {
            return AxisMotion::REST;
        };
        if tau_s >= self.end_s {
            let position_mm = found.motion.after(self.end_s - found.from_s).position_mm;
            return AxisMotion {
                position_mm,
                ..AxisMotion::REST
            };
        }
        found.motion.after((tau_s - found.from_s).max(0.0))
    }

    /// Number of the span that begins at a time or goes on behind it, up to rounding, and the time
    /// at which it ends.
    pub(super) fn ahead(&self, tau_s: f64) -> (usize, f64) {
        let span = self.index(tau_s + AT_S);
        let end_s = self
            .spans
            .get(span + 1)
            .map_or(self.end_s, |next| next.from_s);
        if end_s > tau_s + AT_S {
            (span, end_s)
        } else {
            (span, f64::INFINITY)
        }
    }

    /// Returns the motion of the axes in a span at a time. Behind the end of the plan they rest.
    pub(super) fn in_span(&self, span: usize, tau_s: f64) -> AxisMotion {
        match self.spans.get(span) {
            Some(found) if tau_s < self.end_s => found.motion.after(tau_s - found.from_s),
            _ => self.at(tau_s),
        }
    }

    /// Length of the path between two times, mm, by Simpson's rule in parts of half a millisecond.
    pub fn length_mm(&self, from_s: f64, to_s: f64) -> f64 {
        let parts = ((to_s - from_s) / 5e-4).ceil().max(1.0);
        let h = (to_s - from_s) / parts;
        let speed = |tau_s: f64| norm(self.at(tau_s).velocity_mm_s);
        (0..parts as u32)
            .map(|i| {
                let a = from_s + h * f64::from(i);
                h / 6.0 * (speed(a) + 4.0 * speed(a + 0.5 * h) + speed(a + h))
            })
            .sum()
    }
}
