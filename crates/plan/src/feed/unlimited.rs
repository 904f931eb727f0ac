//! The null member: no bound on the tangential acceleration.
//!
//! Every section is passed at its own bound, `v^2` straight over arc length from one end to the
//! other, and joints cost nothing: a stop takes no time. No plan is faster; what a real planner
//! needs beyond this is the cost of acceleration.

use super::Span;
use super::sections::{Section, SectionPlanner};
use std::collections::VecDeque;

/// See the module's page.
#[derive(Debug, Default)]
pub struct Unlimited {
    ready: VecDeque<Span>,
}

impl SectionPlanner for Unlimited {
    fn push(&mut self, section: Section) {
        let Section {
            piece,
            from_mm,
            length_mm,
            start_cap,
            end_cap,
            ..
        } = section;
        let (start, end) = (start_cap.sqrt(), end_cap.sqrt());
        self.ready.push_back(Span {
            piece,
            from_mm,
            duration_s: 2.0 * length_mm / (start + end),
            speed_mm_s: start,
            accel_mm_s2: 0.5 * (end_cap - start_cap) / length_mm,
            jerk_mm_s3: 0.0,
            motion: None,
        });
    }

    fn finish(&mut self) {}

    fn pop(&mut self) -> Option<Span> {
        self.ready.pop_front()
    }
}
