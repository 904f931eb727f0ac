//! Planner inputs from a machine file: limits along the path and of each axis, and durations of PLC
//! and spindle.

use feedwright_plan::{AxisLimits, Constraints, PathLimits, Plc};

use super::{Limits, Machine};

impl From<&Limits> for PathLimits {
    fn from(limits: &Limits) -> Self {
        Self {
            rapid_mm_s: limits.rapid_mm_s,
            max_feed_mm_s: limits.max_feed_mm_s,
            tangential_accel_mm_s2: limits.tangential_accel_mm_s2,
            normal_accel_mm_s2: limits.normal_accel_mm_s2,
            corner_jump_mm_s: limits.corner_jump_mm_s,
        }
    }
}

/// Tolerance of a path that is planned axis by axis, um, where neither the program nor the machine
/// file says one: about what a machine holds. A plan within 10 um is 1 % faster on the star.
const DEFAULT_PATH_TOLERANCE_UM: f64 = 1.0;

/// Time in which the acceleration of an axis rises to its limit, s, where the machine file has no
/// limits of the axes: a machine frame of 25 Hz comes to rest with it.
const JERK_TIME_S: f64 = 0.04;

impl Machine {
    /// Limits of the i-th axis for a plan: those of the file. Where it has none, every axis has the
    /// speed of rapids, the smaller one of the accelerations along and across the path, and the
    /// jerk that reaches it in 40 ms.
    pub fn axis_limits(&self, i: usize) -> AxisLimits {
        let (axis, limits) = (self.axis(i), &self.limits);
        let accel_mm_s2 = axis
            .max_accel_mm_s2
            .unwrap_or(limits.tangential_accel_mm_s2.min(limits.normal_accel_mm_s2));
        AxisLimits {
            velocity_mm_s: axis
                .max_velocity_mm_s
                .unwrap_or(limits.rapid_mm_s.max(limits.max_feed_mm_s)),
            accel_mm_s2,
            jerk_mm_s3: axis.max_jerk_mm_s3.unwrap_or(accel_mm_s2 / JERK_TIME_S),
        }
    }

    /// This machine with a tolerance of the path, and with limits of every axis where the file has
    /// none: what a planner that plans axis by axis takes. Corrections may accelerate as much as
    /// before.
    #[must_use]
    pub fn planned_by_axes(&self, tolerance_um: f64) -> Self {
        let mut machine = self.clone();
        machine.limits.path_tolerance_um = Some(tolerance_um);
        for i in 0..machine.axes.len() {
            let AxisLimits {
                velocity_mm_s,
                accel_mm_s2,
                jerk_mm_s3,
            } = self.axis_limits(i);
            let axis = &mut machine.axes[i];
            if axis.max_accel_mm_s2.is_none() {
                axis.fade_accel_mm_s2 = Some(self.correction_accel_mm_s2(i));
            }
            axis.max_velocity_mm_s = Some(velocity_mm_s);
            axis.max_accel_mm_s2 = Some(accel_mm_s2);
            axis.max_jerk_mm_s3 = Some(jerk_mm_s3);
        }
        machine
    }

    /// Describes the axis limits that a planner assumes where the file states none; `None` if the
    /// file states the limits of all axes.
    pub fn assumed_axis_limits(&self) -> Option<String> {
        let AxisLimits {
            velocity_mm_s,
            accel_mm_s2,
            jerk_mm_s3,
        } = self.axis_limits(0);
        self.axes.iter().any(|axis| axis.max_velocity_mm_s.is_none()).then(|| {
            format!(
                "{} has no limits of its axes; assumed for each: {velocity_mm_s:.0} mm/s, {accel_mm_s2:.0} mm/s2 and {jerk_mm_s3:.0} mm/s3. \
                 Set {} in the machine file to change them.",
                self.name,
                super::layout::AXIS_LIMITS.join(", ")
            )
        })
    }
}

impl From<&Machine> for Constraints {
    fn from(machine: &Machine) -> Self {
        let axes = (0..machine.axes.len()).map(|i| machine.axis_limits(i));
        let rotary_deg_s = if machine.plc.rotary_deg_s > 0.0 {
            machine.plc.rotary_deg_s
        } else {
            f64::INFINITY
        };
        let tolerance_um = machine
            .limits
            .path_tolerance_um
            .unwrap_or(DEFAULT_PATH_TOLERANCE_UM);
        let path_tolerance_mm = Some(1e-3 * tolerance_um);
        Self {
            path: (&machine.limits).into(),
            axes: axes.collect(),
            rotary_deg_s,
            path_tolerance_mm,
            speed_caps: None,
        }
    }
}

/// Part of the acceleration of an axis that a plan takes beside a correction in the loop. The star
/// takes 0.3 % longer.
const PLANNED_SHARE: f64 = 0.85;

impl Machine {
    /// Returns the inputs of a plan that leaves a part of the acceleration of each axis to a
    /// correction in the loop.
    pub(crate) fn constraints_beside_correction(&self) -> Constraints {
        let mut constraints = Constraints::from(self);
        for (i, axis) in constraints.axes.iter_mut().enumerate() {
            axis.accel_mm_s2 = axis
                .accel_mm_s2
                .min(PLANNED_SHARE * self.accel_limit_mm_s2(i));
        }
        let path = &mut constraints.path;
        let least_mm_s2 = (0..self.axes.len())
            .map(|i| self.accel_limit_mm_s2(i))
            .fold(f64::INFINITY, f64::min);
        let curve_mm_s2 = libm::hypot(path.tangential_accel_mm_s2, path.normal_accel_mm_s2);
        let share = (PLANNED_SHARE * least_mm_s2 / curve_mm_s2).min(1.0);
        path.tangential_accel_mm_s2 *= share;
        path.normal_accel_mm_s2 *= share;
        constraints
    }
}

impl From<&Machine> for Plc {
    fn from(machine: &Machine) -> Self {
        Self::new(machine.plc).with_events(&machine.plc_events)
    }
}
