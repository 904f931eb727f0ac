//! Data sheet of a machine, what is known of it before it is identified: the settings of its
//! control, and the maker's data of its axes.
//!
//! Controllers are made from this and from a trained model, never from a [`Machine`]. Properties of
//! a simulated machine alone are not here: encoder, jitter, steps of the drive, ball screw, cogging
//! and ripple, geometry, noise, phase and frequency of the disturbance.

use std::f64::consts::TAU;

use feedwright_control::{AxisInverse, AxisModel, Parameters, Part};

use super::{Limits, Machine, Period};

/// Known properties of a machine.
#[derive(Debug, Clone, PartialEq)]
pub struct Known {
    /// Periods of the control, including the period of the speed loop, which the drive's manual
    /// states.
    pub period: Period,
    /// Limits that a plan and a correction keep on this machine.
    pub limits: Limits,
    axes: Vec<KnownAxis>,
}

/// Known properties of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownAxis {
    /// Travel for one motor turn, mm.
    pub lead_mm_per_rev: f64,
    /// Its numbers: loops, drive and delays as the control and the manual state them, inertia and
    /// friction of the data sheets, a rigid screw until it is identified, and no noise.
    pub nominal: Parameters,
    /// True if the position is measured at the table.
    pub scale_on_table: bool,
    /// Acceleration that a correction may add to the plan's, mm/s2.
    pub correction_accel_mm_s2: f64,
    /// Torque left for acceleration, N m: the limit less friction and less the largest load. The
    /// amplitude of a load is known, since drives are chosen by it; its course is not.
    pub spare_torque_nm: f64,
}

impl Known {
    /// The i-th axis; one that the machine does not have is like its last.
    pub fn axis(&self, i: usize) -> &KnownAxis {
        &self.axes[i.min(self.axes.len() - 1)]
    }

    /// The first N axes.
    pub fn axes<const N: usize>(&self) -> [KnownAxis; N] {
        std::array::from_fn(|i| *self.axis(i))
    }

    /// Returns the same machine with wrong axis values: inertia and all friction multiplied by
    /// these factors. Settings of the control (gains, feedforward, delays) are read from it and
    /// stay right. The torque left for acceleration follows from the wrong values.
    #[must_use]
    pub fn misjudged(&self, inertia: f64, friction: f64) -> Self {
        let axis = |axis: &KnownAxis| {
            let mut assumed = *axis;
            assumed.nominal.inertia_kg_m2 *= inertia;
            assumed.nominal.viscous_friction_nm_s *= friction;
            assumed.nominal.coulomb_friction_nm *= friction;
            assumed.nominal.coulomb_asymmetry_nm *= friction;
            assumed.nominal.stribeck_nm *= friction;
            let more_nm = assumed.nominal.coulomb_friction_nm - axis.nominal.coulomb_friction_nm;
            assumed.spare_torque_nm = (axis.spare_torque_nm - more_nm).max(0.0);
            assumed
        };
        self.with_axes(|_, known| axis(known))
    }

    /// The same with other axes, made of those that it has, by their numbers.
    #[must_use]
    pub fn with_axes(&self, axis: impl Fn(usize, &KnownAxis) -> KnownAxis) -> Self {
        let axes = self
            .axes
            .iter()
            .enumerate()
            .map(|(i, known)| axis(i, known))
            .collect();
        Self {
            axes,
            ..self.clone()
        }
    }

    /// Returns the models of the first N axes, with all that is known of them.
    pub fn axis_model<const N: usize>(&self) -> [AxisModel; N] {
        std::array::from_fn(|i| AxisModel::new(self.axis(i).nominal, self.period.periods()))
    }

    /// The inverse of the first N axes, with all that is known of them.
    pub fn inverse<const N: usize>(&self) -> [AxisInverse; N] {
        self.axis_model().map(AxisInverse::new)
    }
}

impl KnownAxis {
    /// Acceleration of the tool with the torque that is left for it, mm/s2.
    pub fn drive_mm_s2(&self) -> f64 {
        self.spare_torque_nm / self.nominal.inertia_kg_m2 * self.lead_mm_per_rev / TAU
    }
}

impl Machine {
    /// Returns the known properties of this machine.
    pub fn known(&self) -> Known {
        let axis = |(i, axis): (usize, &super::Axis)| KnownAxis {
            lead_mm_per_rev: axis.lead_mm_per_rev,
            nominal: Parameters {
                speed_window_s: self.seen_over_s(axis),
                ..axis.parameters().without(&[Part::Screw, Part::Noise])
            },
            scale_on_table: axis.transmission.is_some_and(|screw| screw.scale_on_table),
            correction_accel_mm_s2: self.correction_accel_mm_s2(i),
            spare_torque_nm: (axis.torque_limit_nm
                - axis.coulomb_friction_nm
                - axis.disturbance_nm)
                .max(0.0),
        };
        Known {
            period: self.period,
            limits: self.limits,
            axes: self.axes.iter().enumerate().map(axis).collect(),
        }
    }

    /// Window in which a drive sees the speed as late as this axis's does, s. A speed that is held
    /// for a servo period is later by half of what it is held beyond the first mechanics period.
    fn seen_over_s(&self, axis: &super::Axis) -> f64 {
        let Period {
            servo_s,
            mechanics_s,
            ..
        } = self.period;
        if axis.speed_held {
            axis.speed_window_s.max(mechanics_s) + (servo_s - mechanics_s)
        } else {
            axis.speed_window_s
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_misjudged_is_inertia_and_friction_and_no_setting() {
        let known = Machine::load("tnv40".as_ref()).unwrap().known();
        let assumed = known.misjudged(0.8, 1.2);
        for i in 0..2 {
            let (was, is) = (known.axis(i), assumed.axis(i));
            assert_eq!(is.nominal.inertia_kg_m2, 0.8 * was.nominal.inertia_kg_m2);
            assert_eq!(
                is.nominal.viscous_friction_nm_s,
                1.2 * was.nominal.viscous_friction_nm_s
            );
            assert_eq!(
                is.nominal.coulomb_friction_nm,
                1.2 * was.nominal.coulomb_friction_nm
            );
            let more_nm = 0.2 * was.nominal.coulomb_friction_nm;
            assert!((was.spare_torque_nm - is.spare_torque_nm - more_nm).abs() < 1e-12);
            assert_eq!(
                (is.nominal.kp_1_s, is.nominal.kv_nm_s_per_rad),
                (was.nominal.kp_1_s, was.nominal.kv_nm_s_per_rad)
            );
            let settings = |axis: &KnownAxis| {
                Parameters::NOTHING.taking(&[Part::Drive, Part::Delays], &axis.nominal)
            };
            assert_eq!(settings(is), settings(was));
        }
        assert_eq!(known.misjudged(1.0, 1.0), known);
    }
}
