//! The numbers that can be set while the thread runs, and their ranges. Nothing else of the link
//! reads them before they are checked here.
//!
//! | Setting | Range |
//! |---|---|
//! | delay | 0.008 to 0.015 s |
//! | deviation from the path | 0 to 10 mm; 0 corrects along the path alone |
//! | speed | 1 to 10,000 mm/s |
//! | acceleration of a correction that fades, and of one in the loop | 1 to 1,000,000 mm/s2; 0 is without limit |
//! | scale of the feedrate that is asked for | 0.1 to 1 |
//!
//! A number out of its range is refused, and so is what is not a number: the last good one stays in
//! force.

/// Delays that can be set, s: below, the inverse of a drive that is late has nothing to look at;
/// above, it sees no more than it needs.
pub const DELAYS_S: [f64; 2] = [0.008, 0.015];
/// Ranges of the others. Wider ones serve no machine, and their squares stay far from overflow.
const DEVIATIONS_MM: [f64; 2] = [0.0, 10.0];
const SPEEDS_MM_S: [f64; 2] = [1.0, 1e4];
const ACCELERATIONS_MM_S2: [f64; 2] = [1.0, UNLIMITED_MM_S2];
const ADAPTIVE_SCALES: [f64; 2] = [0.1, 1.0];
/// Acceleration of the correction that stands for no limit, mm/s2: a leap within a servo period of
/// 1 ms at the speed of a rapid.
pub const UNLIMITED_MM_S2: f64 = 1e6;

/// Settings that can change while the thread runs. The delay and [`Self::speed_alone`] take effect
/// when the delay is next taken up, all others at once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkLimits {
    /// Delay of the command, s.
    pub delay_s: f64,
    /// Distance of the command from the path, mm.
    pub deviation_mm: f64,
    /// Highest speed of the machine and of the offset, mm/s.
    pub speed_mm_s: f64,
    /// Acceleration with which an offset fades, mm/s2; 0 is without limit.
    pub correction_mm_s2: f64,
    /// Acceleration of an offset in the loop, of each axis, mm/s2; 0 is without limit. Of a
    /// correction that needs more, less is commanded.
    pub engaged_mm_s2: f64,
    /// Multiple of the feedrate of now that a request of 1 stands for.
    pub adaptive_scale: f64,
    /// True if a controller that changes the feedrate leaves the geometry on the path.
    pub speed_alone: bool,
}

/// A number that can be set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Setting {
    /// [`LinkLimits::delay_s`].
    Delay,
    /// [`LinkLimits::deviation_mm`].
    Deviation,
    /// [`LinkLimits::speed_mm_s`].
    Speed,
    /// [`LinkLimits::correction_mm_s2`].
    CorrectionAcceleration,
    /// [`LinkLimits::engaged_mm_s2`].
    Acceleration,
    /// [`LinkLimits::adaptive_scale`].
    AdaptiveScale,
}

impl LinkLimits {
    /// Limits in force until others are set: the defaults of the pins.
    pub const DEFAULT: Self = Self {
        delay_s: 0.010,
        deviation_mm: 0.5,
        speed_mm_s: 400.0,
        correction_mm_s2: 400.0,
        engaged_mm_s2: 0.0,
        adaptive_scale: 1.0,
        speed_alone: false,
    };

    /// Takes over each number that is within its range. Returns the first one that is not.
    pub fn take_over(&mut self, asked: &Self) -> Option<Setting> {
        let mut refused = None;
        let unlimited = asked.correction_mm_s2 == 0.0;
        let mut check = |setting, asked: f64, [least, most]: [f64; 2], in_force: &mut f64| {
            // False for what is not a number.
            if asked >= least && asked <= most {
                *in_force = asked;
            } else {
                refused = refused.or(Some(setting));
            }
        };
        check(Setting::Delay, asked.delay_s, DELAYS_S, &mut self.delay_s);
        check(
            Setting::Deviation,
            asked.deviation_mm,
            DEVIATIONS_MM,
            &mut self.deviation_mm,
        );
        check(
            Setting::Speed,
            asked.speed_mm_s,
            SPEEDS_MM_S,
            &mut self.speed_mm_s,
        );
        let asked_mm_s2 = if unlimited {
            UNLIMITED_MM_S2
        } else {
            asked.correction_mm_s2
        };
        check(
            Setting::CorrectionAcceleration,
            asked_mm_s2,
            ACCELERATIONS_MM_S2,
            &mut self.correction_mm_s2,
        );
        if asked.engaged_mm_s2 == 0.0 {
            self.engaged_mm_s2 = 0.0;
        } else {
            check(
                Setting::Acceleration,
                asked.engaged_mm_s2,
                ACCELERATIONS_MM_S2,
                &mut self.engaged_mm_s2,
            );
        }
        check(
            Setting::AdaptiveScale,
            asked.adaptive_scale,
            ADAPTIVE_SCALES,
            &mut self.adaptive_scale,
        );
        self.speed_alone = asked.speed_alone;
        refused
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The setting, and a value for it.
    fn with(setting: Setting, value: f64) -> LinkLimits {
        let mut limits = LinkLimits::DEFAULT;
        let number = match setting {
            Setting::Delay => &mut limits.delay_s,
            Setting::Deviation => &mut limits.deviation_mm,
            Setting::Speed => &mut limits.speed_mm_s,
            Setting::CorrectionAcceleration => &mut limits.correction_mm_s2,
            Setting::Acceleration => &mut limits.engaged_mm_s2,
            Setting::AdaptiveScale => &mut limits.adaptive_scale,
        };
        *number = value;
        limits
    }

    #[test]
    fn a_number_out_of_its_range_is_refused_and_the_last_good_one_stays() {
        use Setting::{
            Acceleration, AdaptiveScale, CorrectionAcceleration, Delay, Deviation, Speed,
        };
        for (setting, good, bad) in [
            (Delay, 0.012, [0.0, 0.0079, 0.0151]),
            (Deviation, 0.0, [-1.0, -1e-9, 11.0]),
            (Speed, 200.0, [0.0, -400.0, 1e5]),
            (CorrectionAcceleration, 2000.0, [-400.0, 0.5, 1e7]),
            (Acceleration, 2000.0, [-400.0, 0.5, 1e7]),
            (AdaptiveScale, 0.5, [0.0, -1.0, 1.1]),
        ] {
            let mut in_force = LinkLimits::DEFAULT;
            assert_eq!(in_force.take_over(&with(setting, good)), None);
            assert_eq!(in_force, with(setting, good));
            for value in bad
                .into_iter()
                .chain([f64::NAN, f64::INFINITY, f64::NEG_INFINITY])
            {
                assert_eq!(
                    in_force.take_over(&with(setting, value)),
                    Some(setting),
                    "{value}"
                );
                assert_eq!(in_force, with(setting, good), "{value}");
            }
        }
    }

    #[test]
    fn an_acceleration_of_zero_is_without_limit() {
        let mut in_force = LinkLimits::DEFAULT;
        assert_eq!(
            in_force.take_over(&with(Setting::CorrectionAcceleration, 0.0)),
            None
        );
        assert_eq!(in_force.correction_mm_s2, UNLIMITED_MM_S2);
    }
}
