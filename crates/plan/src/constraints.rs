//! What the machine allows: along the path, the same in all directions, and axis by axis.

pub(crate) mod speed_caps;

use std::sync::Arc;

use speed_caps::SpeedCaps;

/// Bounds along and across the path, the same in all directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathLimits {
    /// Speed of rapids.
    pub rapid_mm_s: f64,
    /// Programmed feedrates above this are lowered to it.
    pub max_feed_mm_s: f64,
    /// Acceleration along the path.
    pub tangential_accel_mm_s2: f64,
    /// Acceleration across the path, v^2 times curvature.
    pub normal_accel_mm_s2: f64,
    /// Length of the jump of the velocity vector allowed at a corner in continuous mode (G64); 0
    /// stops at each corner.
    pub corner_jump_mm_s: f64,
}

/// Limits of one axis; infinity means no limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisLimits {
    /// Speed.
    pub velocity_mm_s: f64,
    /// Acceleration.
    pub accel_mm_s2: f64,
    /// Jerk.
    pub jerk_mm_s3: f64,
}

/// Everything that bounds a plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Constraints {
    /// Along and across the path.
    pub path: PathLimits,
    /// Axis by axis, in the order of a position; axes that are not listed have no bounds of their
    /// own.
    pub axes: Vec<AxisLimits>,
    /// Most that a rotary axis turns in a second, degrees; infinite where there is no bound.
    pub rotary_deg_s: f64,
    /// Largest distance of the planned path from the programmed one where the program says none,
    /// mm.
    pub path_tolerance_mm: Option<f64>,
    /// Bounds on the speed place by place, for planners that plan axis by axis.
    pub speed_caps: Option<Arc<SpeedCaps>>,
}

/// Error for a limit that is missing or outside its allowed range.
#[derive(Debug, Clone, PartialEq, thiserror::Error, miette::Diagnostic)]
#[error("limit {name} is {value}, it must be a finite number {bound}")]
pub struct LimitsError {
    /// Name of the limit, with its unit.
    pub(crate) name: &'static str,
    /// Its value.
    pub(crate) value: f64,
    /// Range that the value must lie in, as text.
    pub(crate) bound: &'static str,
}

impl AxisLimits {
    /// No bounds.
    pub const NONE: Self = Self {
        velocity_mm_s: f64::INFINITY,
        accel_mm_s2: f64::INFINITY,
        jerk_mm_s3: f64::INFINITY,
    };
}

/// Nothing but those of the path.
impl From<&PathLimits> for Constraints {
    fn from(path: &PathLimits) -> Self {
        Self {
            path: *path,
            axes: Vec::new(),
            rotary_deg_s: f64::INFINITY,
            path_tolerance_mm: None,
            speed_caps: None,
        }
    }
}

impl Constraints {
    /// Limits of the k-th axis; an axis without is like the last that has some. `None` where no
    /// axis has any.
    pub fn axis(&self, k: usize) -> Option<AxisLimits> {
        self.axes.get(k).or(self.axes.last()).copied()
    }

    /// Checks that every limit is of use.
    ///
    /// # Errors
    /// The first limit that is not.
    pub(crate) fn check(&self) -> Result<(), LimitsError> {
        let path = &self.path;
        // From 1e-6 to 1e9 nothing under- or overflows, and no machine lies outside.
        for (name, value) in [
            ("rapid_mm_s", path.rapid_mm_s),
            ("max_feed_mm_s", path.max_feed_mm_s),
            ("tangential_accel_mm_s2", path.tangential_accel_mm_s2),
            ("normal_accel_mm_s2", path.normal_accel_mm_s2),
        ] {
            if !(1e-6..=1e9).contains(&value) {
                return Err(LimitsError {
                    name,
                    value,
                    bound: "from 1e-6 to 1e9",
                });
            }
        }
        let value = path.corner_jump_mm_s;
        if !(0.0..=1e9).contains(&value) {
            return Err(LimitsError {
                name: "corner_jump_mm_s",
                value,
                bound: "from 0 to 1e9",
            });
        }
        for axis in &self.axes {
            for (name, value) in [
                ("max_velocity_mm_s", axis.velocity_mm_s),
                ("max_accel_mm_s2", axis.accel_mm_s2),
                ("max_jerk_mm_s3", axis.jerk_mm_s3),
            ] {
                if value.is_nan() || value < 1e-6 {
                    return Err(LimitsError {
                        name,
                        value,
                        bound: "from 1e-6",
                    });
                }
            }
        }
        Ok(())
    }

    /// Checks that each axis has velocity, acceleration and jerk, and the path a tolerance:
    /// planners that plan axis by axis need them.
    ///
    /// # Errors
    /// The first that is not there.
    pub(crate) fn check_axes(&self) -> Result<(), LimitsError> {
        let bound = "from 1e-6 to 1e12, for a planner that plans axis by axis";
        let none = [AxisLimits::NONE];
        for axis in if self.axes.is_empty() {
            &none[..]
        } else {
            &self.axes[..]
        } {
            for (name, value) in [
                ("max_velocity_mm_s", axis.velocity_mm_s),
                ("max_accel_mm_s2", axis.accel_mm_s2),
                ("max_jerk_mm_s3", axis.jerk_mm_s3),
            ] {
                if !(1e-6..=1e12).contains(&value) {
                    return Err(LimitsError { name, value, bound });
                }
            }
        }
        let value = self.path_tolerance_mm.unwrap_or(f64::NAN) * 1e3;
        if !(1e-3..=1e6).contains(&value) {
            let bound = "from 1e-3 to 1e6, for a planner that chooses the path";
            return Err(LimitsError {
                name: "path_tolerance_um",
                value,
                bound,
            });
        }
        Ok(())
    }

    /// Speed that the axes that move along with a piece allow: the slowest of them bounds the
    /// others. Nothing that moves along is no bound (division by zero).
    pub(crate) fn along_mm_s(&self, turn_deg_mm: f64, further_mm_mm: f64) -> f64 {
        let rotary_mm_s = self.rotary_deg_s / turn_deg_mm;
        rotary_mm_s.min(self.path.rapid_mm_s / further_mm_mm)
    }
}
