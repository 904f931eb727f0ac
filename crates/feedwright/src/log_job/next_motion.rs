//! The motion that would settle what a log leaves open, axis by axis.
//!
//! Axes keep to positions, speeds and accelerations that the log has, or to the limits of the
//! updated machine file where those are higher. Parameters that no motion determines (inertia, the
//! scale of torques) need no motion.

use feedwright_ident::{AxisExcitation, FoundAxis, ModelTerm, MotionPart};
use feedwright_sim::Machine;

use super::LogIdentified;

/// Part of the highest feed of a machine file that is used, as in an excitation.
const FEED_PART: f64 = 0.8;
/// Time in which an axis reaches its speed whose log shows no acceleration, s.
const REACHED_S: f64 = 0.05;

impl LogIdentified {
    /// Returns the motion that each axis is to make, in the order of the log. Axes that no machine
    /// file has are left out.
    pub fn next_motion(&self) -> Vec<AxisExcitation> {
        (0..self.machine.axes.len())
            .filter_map(|i| self.next_motion_of(i))
            .collect()
    }

    /// Returns the motion that an axis of the log is to make; `None` if no machine file has the
    /// axis.
    pub(super) fn next_motion_of(&self, i: usize) -> Option<AxisExcitation> {
        let axis = self.places().iter().position(|place| *place == Some(i))?;
        let found = self.machine.axes.get(i)?;
        let command_mm = &self.log.axes.get(i)?.command_mm;
        let range_mm =
            [f64::min, f64::max].map(|end| command_mm.iter().copied().fold(f64::NAN, end));
        let limits = self
            .job
            .before
            .as_ref()
            .map(|machine| machine_limits(machine, axis));
        let [speed_mm_s, accel_mm_s2] = limits.unwrap_or([0.0; 2]);
        let fastest_mm_s = found.most[0].max(speed_mm_s);
        let accel_mm_s2 = found.most[1].max(accel_mm_s2);
        let accel_mm_s2 = if accel_mm_s2 > 0.0 {
            accel_mm_s2
        } else {
            fastest_mm_s / REACHED_S
        };
        let is_one_sided = self.machine.split.one_sided.iter().any(|(of, _)| *of == i);
        Some(AxisExcitation {
            axis,
            range_mm,
            fastest_mm_s,
            accel_mm_s2,
            parts: parts(found, is_one_sided),
        })
    }
}

/// Highest speed and acceleration of an axis by its machine file, mm/s and mm/s2.
fn machine_limits(machine: &Machine, axis: usize) -> [f64; 2] {
    let limits = &machine.limits;
    let own_mm_s = machine
        .axes
        .get(axis)
        .and_then(|axis| axis.max_velocity_mm_s)
        .unwrap_or(f64::INFINITY);
    [
        FEED_PART * limits.max_feed_mm_s.min(own_mm_s),
        limits.tangential_accel_mm_s2,
    ]
}

/// Kinds of motion that settle what is open of an axis.
fn parts(found: &FoundAxis, is_one_sided: bool) -> Vec<MotionPart> {
    let unseen = &found.unseen;
    let is_needed = |part: &MotionPart| {
        let shows = |term: &ModelTerm| term.shown_by().contains(part);
        // Without a name, anything may be open.
        let is_open =
            unseen.is_open() && (unseen.terms.is_empty() || unseen.terms.iter().any(shows));
        let is_missing = unseen.never.is_some() || is_one_sided || found.scores.beyond.is_some();
        is_open || (*part == MotionPart::Reversals && is_missing)
    };
    MotionPart::ALL.into_iter().filter(is_needed).collect()
}
