//! What a controller is given of an axis: the law, what drive and friction have beside, delays, and statistics of its noise.
//!
//! Where it comes from is another matter: a machine file, an identification, or the simulation itself.

use super::drive::DriveParameters;
use super::friction::FrictionParameters;
use super::inverse::LoopDelays;
use super::statistics::AxisStatistics;
use super::{AxisLaw, Parameters, Periods};

/// What is given of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisKnowledge {
    /// Loops, inertia, friction.
    pub parameters: Parameters,
    /// Periods of the loops.
    pub periods: Periods,
    /// What the drive has beside.
    pub drive: DriveParameters,
    /// What friction has beside.
    pub friction: FrictionParameters,
    /// How late the drive and the encoder are.
    pub delays: LoopDelays,
    /// Noise, and what depends on the angle of the motor.
    pub statistics: AxisStatistics,
}

impl AxisKnowledge {
    /// An axis of no use: all zero but its periods.
    pub const NOTHING: Self = Self {
        parameters: Parameters {
            rad_per_mm: 0.0,
            kp_1_s: 0.0,
            kd: 0.0,
            kv_nm_s_per_rad: 0.0,
            torque_limit_nm: 0.0,
            inertia_kg_m2: 0.0,
            viscous_friction_nm_s: 0.0,
            coulomb_friction_nm: 0.0,
            coulomb_smoothing_rad_s: 0.0,
        },
        periods: Periods { servo_s: 0.001, mechanics_s: 0.001, mechanics_per_servo: 1 },
        drive: DriveParameters {
            speed_integral_s: 0.0,
            velocity_feedforward: 0.0,
            acceleration_feedforward: 0.0,
            torque_filter_hz: 0.0,
            speed_limit_rad_s: 0.0,
        },
        friction: FrictionParameters {
            coulomb_asymmetry_nm: 0.0,
            stribeck_nm: 0.0,
            stribeck_rad_s: 0.0,
            presliding_rad: 0.0,
        },
        delays: LoopDelays { drive_s: 0.0, measurement_s: 0.0 },
        statistics: AxisStatistics::NOTHING,
    };

    /// The law, ready to be integrated.
    pub fn law(&self) -> AxisLaw {
        AxisLaw::new(self.parameters, self.periods)
    }

    /// Hands over its numbers in a fixed order, each with its name: what is stored of it beside the periods.
    pub fn numbers(&mut self, each: &mut impl FnMut(&'static str, &mut f64)) {
        let Self { parameters: p, drive: d, friction: f, delays, statistics: s, .. } = self;
        for (name, number) in [
            ("rad_per_mm", &mut p.rad_per_mm),
            ("kp_1_s", &mut p.kp_1_s),
            ("kd", &mut p.kd),
            ("kv_nm_s_per_rad", &mut p.kv_nm_s_per_rad),
            ("torque_limit_nm", &mut p.torque_limit_nm),
            ("speed_integral_s", &mut d.speed_integral_s),
            ("velocity_feedforward", &mut d.velocity_feedforward),
            ("acceleration_feedforward", &mut d.acceleration_feedforward),
            ("torque_filter_hz", &mut d.torque_filter_hz),
            ("speed_limit_rad_s", &mut d.speed_limit_rad_s),
            ("drive_delay_s", &mut delays.drive_s),
            ("measurement_delay_s", &mut delays.measurement_s),
            ("inertia_kg_m2", &mut p.inertia_kg_m2),
            ("viscous_friction_nm_s", &mut p.viscous_friction_nm_s),
            ("coulomb_friction_nm", &mut p.coulomb_friction_nm),
            ("coulomb_smoothing_rad_s", &mut p.coulomb_smoothing_rad_s),
            ("coulomb_asymmetry_nm", &mut f.coulomb_asymmetry_nm),
            ("stribeck_nm", &mut f.stribeck_nm),
            ("stribeck_rad_s", &mut f.stribeck_rad_s),
            ("presliding_rad", &mut f.presliding_rad),
            ("encoder_noise_rad", &mut s.encoder_noise_rad),
            ("encoder_step_rad", &mut s.encoder_step_rad),
            ("interpolation_rad", &mut s.interpolation_rad),
            ("interpolation_phase_rad", &mut s.interpolation_phase_rad),
            ("signal_per_rad", &mut s.signal_per_rad),
            ("torque_noise_nm", &mut s.torque_noise_nm),
            ("torque_noise_s", &mut s.torque_noise_s),
            ("disturbance_nm", &mut s.disturbance_nm),
            ("disturbance_rad_s", &mut s.disturbance_rad_s),
            ("disturbance_wander", &mut s.disturbance_wander),
            ("cogging_nm", &mut s.cogging_nm),
            ("cogging_phase_rad", &mut s.cogging_phase_rad),
            ("cogging_per_rev", &mut s.cogging_per_rev),
        ] {
            each(name, number);
        }
    }

    /// Numbers that it has.
    pub fn count(mut self) -> usize {
        let mut count = 0;
        self.numbers(&mut |_, _| count += 1);
        count
    }
}
