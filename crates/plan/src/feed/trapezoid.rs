//! Time-optimal speed with one bound on the tangential acceleration.
//!
//! Let `E = v^2`. At acceleration `a`, E changes by at most `2 a` per mm, so the fastest speed is
//! the largest function below all caps whose slope stays within `+-2 a`: the smaller of a forward
//! pass `F` and a backward pass `B` over the joints,
//!
//! `F_i = min(cap_i, F_(i-1) + 2 a L_(i-1))`, `B_i = min(cap_i, B_(i+1) + 2 a L_i)`, `E_i =
//! min(F_i, B_i)`,
//!
//! and within a section the smallest of three straight lines over arc length: up from `E_i`, the
//! section's own bound, down to `E_(i+1)`. Each is a span of constant acceleration.
//!
//! Look-ahead. F is final as it is made. B is not: it starts from rest behind the last section
//! known so far, and can only grow when more sections come. Where `F_i <= B_i`, `E_i = F_i` is
//! final, and so is all before it: if `F_i` is a cap, B is exact from there on back; if it is not,
//! F rose to it at full acceleration from a cap, and B is not below F on the way. So all sections
//! before the last such joint are committed, to the last bit what unlimited look-ahead gives. The
//! pass runs each time the number of waiting sections has doubled, which makes the work linear; it
//! stays bounded because the waiting length cannot exceed the braking distance for long. Should
//! half of [`MAX_WAITING`] sections be shorter than that, half of those that wait are committed so
//! that the motion could stop at the end of the last: slower, and safe.

use super::Span;
use super::sections::{Section, SectionPlanner};
use std::collections::VecDeque;

/// Sections that may wait: twice two and a half times the braking distance from 50 mm/s at 100
/// mm/s2 (12.5 mm) in blocks of 1 um, finer than any program of use, and 5 MB. Fewer would slow
/// such programs down, more would only cost memory.
pub(crate) const MAX_WAITING: usize = 65_536;

/// Sections to collect before the first backward pass; fewer would run it too often for nothing.
const BATCH: usize = 32;

#[derive(Debug, Clone, Copy)]
struct WaitingSection {
    section: Section,
    /// Cap at the joint before the section.
    cap: f64,
    /// F at that joint.
    forward: f64,
    /// B at that joint.
    backward: f64,
}

/// See the module's page.
#[derive(Debug)]
pub struct Trapezoid {
    accel_mm_s2: f64,
    waiting: VecDeque<WaitingSection>,
    max_waiting: usize,
    /// Number of waiting sections at which the next backward pass runs.
    next_pass: usize,
    ready: VecDeque<Span>,
}

impl Trapezoid {
    /// A planner with this tangential acceleration.
    pub fn new(accel_mm_s2: f64) -> Self {
        Self::with_max_waiting(accel_mm_s2, MAX_WAITING)
    }

    /// A planner whose look-ahead is bounded by that many sections, at least 2.
    pub fn with_max_waiting(accel_mm_s2: f64, max_waiting: usize) -> Self {
        Self {
            accel_mm_s2,
            waiting: VecDeque::new(),
            max_waiting: max_waiting.max(2),
            next_pass: BATCH.min(max_waiting.max(2)),
            ready: VecDeque::new(),
        }
    }

    /// Largest E after a section, coming from `before`.
    fn gain(&self, before: f64, length_mm: f64) -> f64 {
        before + 2.0 * self.accel_mm_s2 * length_mm
    }

    fn backward_pass(&mut self) {
        // At rest behind the last section.
        let mut after = 0.0;
        for i in (0..self.waiting.len()).rev() {
            let waiting = self.waiting[i];
            after = waiting.cap.min(self.gain(after, waiting.section.length_mm));
            self.waiting[i].backward = after;
        }
    }

    /// Last joint whose speed is final.
    fn last_final(&self) -> usize {
        self.waiting
            .iter()
            .rposition(|waiting| waiting.forward <= waiting.backward)
            .unwrap_or(0)
    }

    /// Makes spans of the first `count` sections.
    fn commit(&mut self, count: usize) {
        for i in 0..count {
            let waiting = self.waiting[i];
            let before = waiting.forward.min(waiting.backward);
            let after = self
                .waiting
                .get(i + 1)
                .map_or(0.0, |next| next.forward.min(next.backward));
            self.spans(&waiting.section, before, after);
        }
        self.waiting.drain(..count);
    }

    /// The look-ahead is full: commits half as if the motion ended behind the last section, and
    /// goes on from the speed that this gives.
    fn commit_half(&mut self) {
        let count = self.waiting.len() / 2;
        self.commit(count);
        let mut before: Option<(f64, f64)> = None;
        for i in 0..self.waiting.len() {
            let waiting = self.waiting[i];
            let forward = match before {
                None => waiting.forward.min(waiting.backward),
                Some((forward, length_mm)) => waiting.cap.min(self.gain(forward, length_mm)),
            };
            self.waiting[i].forward = forward;
            before = Some((forward, waiting.section.length_mm));
        }
    }

    /// Spans of one section between the given E at its ends.
    fn spans(&mut self, section: &Section, before: f64, after: f64) {
        let length = section.length_mm;
        let two_a = 2.0 * self.accel_mm_s2;
        let slope = (section.end_cap - section.start_cap) / length;
        // Where the line up meets the bound, and how far from the end the line down does.
        let up = if two_a > slope {
            (section.start_cap - before) / (two_a - slope)
        } else {
            f64::INFINITY
        };
        let down = if two_a > -slope {
            (section.end_cap - after) / (two_a + slope)
        } else {
            f64::INFINITY
        };
        let (up, top) = if up + down <= length {
            (up.max(0.0), length - down.max(0.0))
        } else {
            // They meet below the bound.
            let up = (0.5 * (length + (after - before) / two_a)).clamp(0.0, length);
            (up, up)
        };
        let parts = [(0.0, up, two_a), (up, top, slope), (top, length, -two_a)];
        let mut speed = before.sqrt();
        for (from, to, slope) in parts {
            let along = to - from;
            if along <= 0.0 {
                continue;
            }
            let end = if to < length {
                (speed * speed + slope * along).max(0.0).sqrt()
            } else {
                after.sqrt()
            };
            let duration_s = 2.0 * along / (speed + end);
            if duration_s > 0.0 && duration_s.is_finite() {
                self.ready.push_back(Span {
                    piece: section.piece,
                    from_mm: section.from_mm + from,
                    duration_s,
                    speed_mm_s: speed,
                    accel_mm_s2: 0.5 * slope,
                    jerk_mm_s3: 0.0,
                    motion: None,
                });
            }
            speed = end;
        }
    }
}

impl SectionPlanner for Trapezoid {
    fn push(&mut self, section: Section) {
        let (cap, forward) = match self.waiting.back() {
            Some(last) => {
                let cap = section
                    .joint_cap
                    .min(last.section.end_cap)
                    .min(section.start_cap);
                (
                    cap,
                    cap.min(self.gain(last.forward, last.section.length_mm)),
                )
            }
            // Only the very first section finds no other one: a commit always keeps the last.
            None => (0.0, 0.0),
        };
        self.waiting.push_back(WaitingSection {
            section,
            cap,
            forward,
            backward: 0.0,
        });
        if self.waiting.len() >= self.next_pass {
            let full = self.waiting.len() >= self.max_waiting;
            self.backward_pass();
            self.commit(self.last_final());
            // Short of half the room, the next pass would come too soon, and the work would no
            // longer be linear.
            if full && self.waiting.len() > self.max_waiting / 2 {
                self.commit_half();
            }
            self.next_pass = (2 * self.waiting.len() + BATCH).min(self.max_waiting);
        }
    }

    fn finish(&mut self) {
        self.backward_pass();
        self.commit(self.waiting.len());
    }

    fn pop(&mut self) -> Option<Span> {
        self.ready.pop_front()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const ACCEL_MM_S2: f64 = 10.0;
    /// Points of a section in the plan by brute force, and the part by which its time may differ.
    const POINTS: usize = 2000;
    const SAME_TIME: f64 = 2e-3;

    /// Least time by brute force, s: the square of the speed between points of the bounds, forward
    /// and backward.
    fn least_s(sections: &[Section]) -> f64 {
        let mut caps = vec![0.0];
        for (k, section) in sections.iter().enumerate() {
            let cap = |i: usize| {
                section.start_cap + (section.end_cap - section.start_cap) * i as f64 / POINTS as f64
            };
            let next = sections
                .get(k + 1)
                .map_or(0.0, |next| next.joint_cap.min(next.start_cap));
            caps.extend((1..POINTS).map(cap).chain([section.end_cap.min(next)]));
        }
        let lengths: Vec<f64> = sections
            .iter()
            .flat_map(|section| [section.length_mm / POINTS as f64; POINTS])
            .collect();
        for i in 0..lengths.len() {
            caps[i + 1] = caps[i + 1].min(caps[i] + 2.0 * ACCEL_MM_S2 * lengths[i]);
        }
        for i in (0..lengths.len()).rev() {
            caps[i] = caps[i].min(caps[i + 1] + 2.0 * ACCEL_MM_S2 * lengths[i]);
        }
        caps.windows(2)
            .zip(&lengths)
            .map(|(ends, length_mm)| 2.0 * length_mm / (ends[0].sqrt() + ends[1].sqrt()))
            .sum()
    }

    fn section() -> impl Strategy<Value = Section> {
        (0.1..3.0_f64, 1.0..60.0_f64, 1.0..60.0_f64, 1.0..90.0_f64).prop_map(
            |(length_mm, start_cap, end_cap, joint_cap)| Section {
                piece: 0,
                from_mm: 0.0,
                length_mm,
                joint_cap,
                start_cap,
                end_cap,
            },
        )
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn sloping_bounds_are_kept_in_the_least_time(mut sections in prop::collection::vec(section(), 1..6)) {
            (0..).zip(&mut sections).for_each(|(piece, section)| section.piece = piece);
            let mut planner = Trapezoid::new(ACCEL_MM_S2);
            sections.iter().for_each(|section| planner.push(*section));
            planner.finish();
            let mut time_s = 0.0;
            while let Some(span) = planner.pop() {
                let section = &sections[span.piece as usize];
                for part in [0.0, 0.5, 1.0] {
                    let t = part * span.duration_s;
                    let (speed, s_mm) = (
                        span.speed_mm_s + t * span.accel_mm_s2,
                        span.from_mm + t * (span.speed_mm_s + 0.5 * t * span.accel_mm_s2),
                    );
                    let slope = (section.end_cap - section.start_cap) / section.length_mm;
                    let bound = section.start_cap + slope * s_mm;
                    prop_assert!(speed * speed <= bound + 1e-9, "{} beyond {bound} at {s_mm} of {section:?}", speed * speed);
                }
                time_s += span.duration_s;
            }
            let least_s = least_s(&sections);
            prop_assert!((time_s / least_s - 1.0).abs() < SAME_TIME, "{time_s} s in place of {least_s} s");
        }
    }
}
