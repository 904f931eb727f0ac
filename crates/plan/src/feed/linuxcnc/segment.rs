//! A segment of the queue: its curve, how far it is, and what bounds its speed.

use feedwright_gcode::canon::Corner;

use super::blocks::PlannerBlock;
use super::limits::{MAX_OVERRIDE, NORMAL_RATIO, PERIOD_S, TANGENTIAL_RATIO};
use super::shape::SegmentShape;

/// Type of the end of a segment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SegmentEnd {
    /// Full stop (G61.1).
    Stop,
    /// End on the path: at rest, or tangent to the next segment (G61).
    Exact,
    /// Blend: the next segment begins while this one slows down, and both motions are added.
    Parabolic,
    /// Transition at speed, straight into the next segment.
    Tangent,
}

/// See the module's page.
#[derive(Debug, Clone)]
pub(super) struct MotionSegment {
    /// Its curve.
    pub(crate) shape: SegmentShape,
    /// Places along it before its beginning was cut, and the arc lengths of the program that they
    /// stand for, mm.
    pub(crate) places_mm: Vec<[f64; 2]>,
    /// Length cut from its beginning.
    pub(crate) cut_mm: f64,
    /// Length.
    pub(crate) length_mm: f64,
    /// Length before anything was cut.
    pub(crate) nominal_mm: f64,
    /// Distance covered so far.
    pub(crate) progress_mm: f64,
    /// Speed asked for.
    pub(crate) feed_mm_s: f64,
    /// Highest speed.
    pub(crate) highest_mm_s: f64,
    /// Speed now.
    pub(crate) speed_mm_s: f64,
    /// Speed at its end, as the look-ahead allows it.
    pub(crate) final_mm_s: f64,
    /// Speed at which it will end within this servo period.
    pub(crate) ending_mm_s: f64,
    /// Acceleration.
    pub(crate) accel_mm_s2: f64,
    /// Part of the acceleration that is for the tangent.
    pub(crate) tangential_ratio: f64,
    /// Speed at which the corner at the end takes no more than its part of the acceleration; none
    /// where there is no such corner.
    pub(crate) kink_mm_s: Option<f64>,
    /// Parts of the acceleration that the corners at its beginning and at its end take.
    pub(crate) kink_parts: [f64; 2],
    /// Type of its end.
    pub(crate) end: SegmentEnd,
    /// True where the segment before blends into it.
    pub(crate) is_blended_into: bool,
    /// Tolerance of a blend, mm; 0 means no tolerance.
    pub(crate) tolerance_mm: f64,
    /// True for a rapid.
    pub(crate) is_rapid: bool,
    /// True where an axis other than X, Y and Z moves along.
    pub(crate) is_rotary: bool,
    /// True once its length is final.
    pub(crate) is_final: bool,
    /// True once a bound limits its final speed, instead of the distance in which the next segments
    /// slow down.
    pub(crate) is_peak: bool,
    /// State that the servo periods update while it moves.
    pub(crate) run: SegmentRun,
}

/// State of a segment while it moves.
#[derive(Debug, Clone, Copy)]
pub(super) struct SegmentRun {
    /// Time that it has in this servo period.
    pub(crate) period_s: f64,
    /// It has begun.
    pub(crate) is_active: bool,
    /// It runs at one acceleration.
    pub(crate) is_ramp: bool,
    /// It ends within this servo period.
    pub(crate) ends_within: bool,
    /// It is over.
    pub(crate) is_over: bool,
    /// It slows down to its final speed.
    pub(crate) slows_down: bool,
    /// The next one has begun.
    pub(crate) blends: bool,
}

impl MotionSegment {
    /// The segment of a block.
    pub(super) fn new(block: PlannerBlock) -> Self {
        let PlannerBlock {
            shape,
            places_mm,
            is_rapid,
            is_rotary,
            feed_mm_s,
            highest_mm_s,
            accel_mm_s2,
            corner,
        } = block;
        let (end, tolerance_mm) = match corner {
            Corner::ExactStop => (SegmentEnd::Stop, 0.0),
            Corner::ExactPath => (SegmentEnd::Exact, 0.0),
            Corner::Continuous { tolerance_mm, .. } => {
                (SegmentEnd::Parabolic, tolerance_mm.unwrap_or(0.0))
            }
        };
        let length_mm = shape.length_mm();
        let run = SegmentRun {
            period_s: PERIOD_S,
            is_active: false,
            is_ramp: false,
            ends_within: false,
            is_over: false,
            slows_down: false,
            blends: false,
        };
        let mut segment = Self {
            shape,
            places_mm,
            cut_mm: 0.0,
            length_mm,
            nominal_mm: length_mm,
            progress_mm: 0.0,
            feed_mm_s,
            highest_mm_s,
            speed_mm_s: 0.0,
            final_mm_s: 0.0,
            ending_mm_s: 0.0,
            accel_mm_s2,
            tangential_ratio: TANGENTIAL_RATIO,
            kink_mm_s: None,
            kink_parts: [0.0; 2],
            end,
            is_blended_into: false,
            tolerance_mm,
            is_rapid,
            is_rotary,
            is_final: false,
            is_peak: false,
            run,
        };
        segment.bound_by_period();
        segment
    }

    /// Bounds the highest speed so that the segment takes at least one servo period.
    pub(super) fn bound_by_period(&mut self) {
        self.highest_mm_s = self.highest_mm_s.min(self.length_mm / PERIOD_S);
    }

    /// Its length will not change any more.
    pub(super) fn fix_length(&mut self) {
        if self.is_final {
            return;
        }
        self.bound_by_period();
        if let SegmentShape::Circle(circle) = self.shape {
            let radius_mm = circle.curvature_radius_mm();
            let accel = self.whole_accel_mm_s2();
            let normal = self.highest_mm_s * self.highest_mm_s / radius_mm;
            if normal > NORMAL_RATIO * accel {
                self.highest_mm_s = (NORMAL_RATIO * accel * radius_mm).sqrt();
            } else {
                self.tangential_ratio = (1.0 - (normal / accel).powi(2)).sqrt();
            }
        }
        self.is_final = true;
    }

    /// Acceleration that its corners leave, mm/s2. A segment of a parabolic blend has half of it,
    /// because the blend adds the accelerations of both segments.
    pub(super) fn whole_accel_mm_s2(&self) -> f64 {
        let left = 1.0 - self.kink_parts[0].max(self.kink_parts[1]);
        let is_added = self.is_blended_into || self.end == SegmentEnd::Parabolic;
        self.accel_mm_s2 * left * if is_added { 0.5 } else { 1.0 }
    }

    /// Acceleration along the path.
    pub(super) fn along_mm_s2(&self) -> f64 {
        self.whole_accel_mm_s2()
            * if self.shape.is_round() {
                self.tangential_ratio
            } else {
                1.0
            }
    }

    /// Highest speed at the largest override.
    pub(super) fn overridden_mm_s(&self) -> f64 {
        (MAX_OVERRIDE * self.feed_mm_s).min(self.highest_mm_s)
    }

    /// Speed to go for.
    pub(super) fn wanted_mm_s(&self) -> f64 {
        self.feed_mm_s.min(self.highest_mm_s)
    }

    /// Returns the remaining length.
    pub(super) fn left_mm(&self) -> f64 {
        self.length_mm - self.progress_mm
    }

    /// Arc length of the program that a place of it stands for.
    pub(super) fn station_mm(&self, along_mm: f64) -> f64 {
        let along_mm = along_mm + self.cut_mm;
        let after = self.places_mm.partition_point(|place| place[0] < along_mm);
        match (
            after
                .checked_sub(1)
                .and_then(|before| self.places_mm.get(before)),
            self.places_mm.get(after),
        ) {
            (Some(&[x0, s0]), Some(&[x1, s1])) => s0 + (along_mm - x0) / (x1 - x0) * (s1 - s0),
            (None, Some(place)) | (Some(place), None) => place[1],
            (None, None) => 0.0,
        }
    }
}
