//! What a machine file says to the planner: limits along the path and of each axis, and how long PLC and spindle take.

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

impl From<&Machine> for Constraints {
    fn from(machine: &Machine) -> Self {
        let axes = machine.axes.iter().map(|axis| AxisLimits {
            velocity_mm_s: axis.max_velocity_mm_s.unwrap_or(f64::INFINITY),
            accel_mm_s2: axis.max_accel_mm_s2.unwrap_or(f64::INFINITY),
            jerk_mm_s3: axis.max_jerk_mm_s3.unwrap_or(f64::INFINITY),
        });
        let rotary_deg_s = if machine.plc.rotary_deg_s > 0.0 { machine.plc.rotary_deg_s } else { f64::INFINITY };
        let path_tolerance_mm = machine.limits.path_tolerance_um.map(|um| 1e-3 * um);
        Self { path: (&machine.limits).into(), axes: axes.collect(), rotary_deg_s, path_tolerance_mm, speed_caps: None }
    }
}

impl From<&Machine> for Plc {
    fn from(machine: &Machine) -> Self {
        Self::new(machine.plc).with_events(&machine.plc_events)
    }
}
