//! Knowledge of an axis that a controller receives: the model, further parts of drive and friction,
//! delays, and statistics of its noise.
//!
//! It comes from a machine file, an identification, or the simulation itself.

use super::delays::LoopDelays;
use super::drive::DriveParameters;
use super::friction::FrictionParameters;
use super::statistics::AxisStatistics;
use super::transmission::TransmissionParameters;
use super::{AxisModel, Parameters, Periods};

/// Knowledge of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisKnowledge {
    /// Loops, inertia, friction.
    pub parameters: Parameters,
    /// Periods of the loops.
    pub periods: Periods,
    /// Parts of the drive in addition to the loops.
    pub drive: DriveParameters,
    /// Parts of the friction in addition to Coulomb and viscous friction.
    pub friction: FrictionParameters,
    /// Ball screw.
    pub transmission: TransmissionParameters,
    /// Delays of commands, drive and encoder.
    pub delays: LoopDelays,
    /// Noise, and parts that depend on the angle of the motor.
    pub statistics: AxisStatistics,
}

impl AxisKnowledge {
    /// Placeholder axis: every parameter is zero except the periods.
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
        periods: Periods {
            servo_s: 0.001,
            mechanics_s: 0.001,
            mechanics_per_servo: 1,
        },
        drive: DriveParameters {
            speed_integral_s: 0.0,
            velocity_feedforward: 0.0,
            acceleration_feedforward: 0.0,
            torque_filter_hz: 0.0,
            speed_limit_rad_s: 0.0,
            speed_window_s: 0.0,
        },
        friction: FrictionParameters {
            coulomb_asymmetry_nm: 0.0,
            stribeck_nm: 0.0,
            stribeck_rad_s: 0.0,
            presliding_rad: 0.0,
        },
        transmission: TransmissionParameters::RIGID,
        delays: LoopDelays {
            command_s: 0.0,
            drive_s: 0.0,
            measurement_s: 0.0,
        },
        statistics: AxisStatistics::NOTHING,
    };

    /// Returns the model, ready to be integrated.
    pub fn axis_model(&self) -> AxisModel {
        AxisModel::new(self.parameters, self.periods)
    }

    /// Stored numbers of an axis, in this order: all except the periods. The ranges are the ranges
    /// of a machine file, and exclude values that computation cannot use.
    pub const NUMBERS: &[Number] = &[
        Number::within("rad_per_mm", "rad/mm", 1e-3, 1e3, |axis| {
            &mut axis.parameters.rad_per_mm
        }),
        Number::within("kp_1_s", "1/s", 1e-3, 1e5, |axis| {
            &mut axis.parameters.kp_1_s
        }),
        Number::within("kd", "", 0.0, 1e3, |axis| &mut axis.parameters.kd),
        Number::within("kv_nm_s_per_rad", "N m s/rad", 1e-9, 1e6, |axis| {
            &mut axis.parameters.kv_nm_s_per_rad
        }),
        Number::within("torque_limit_nm", "N m", 1e-6, 1e6, |axis| {
            &mut axis.parameters.torque_limit_nm
        }),
        Number::or_none("speed_integral_s", "s", 1e-6, 10.0, |axis| {
            &mut axis.drive.speed_integral_s
        }),
        Number::within("velocity_feedforward", "", 0.0, 2.0, |axis| {
            &mut axis.drive.velocity_feedforward
        }),
        Number::within("acceleration_feedforward", "", 0.0, 1e3, |axis| {
            &mut axis.drive.acceleration_feedforward
        }),
        Number::or_none("torque_filter_hz", "Hz", 1e-3, 1e5, |axis| {
            &mut axis.drive.torque_filter_hz
        }),
        Number::or_none("speed_limit_rad_s", "rad/s", 1e-5, 1e7, |axis| {
            &mut axis.drive.speed_limit_rad_s
        }),
        Number::newer("speed_window_s", "s", 0.2, |axis| {
            &mut axis.drive.speed_window_s
        }),
        Number::within("drive_delay_s", "s", 0.0, 0.02, |axis| {
            &mut axis.delays.drive_s
        }),
        Number::within("measurement_delay_s", "s", 0.0, 0.02, |axis| {
            &mut axis.delays.measurement_s
        }),
        Number::within("inertia_kg_m2", "kg m2", 1e-9, 1e3, |axis| {
            &mut axis.parameters.inertia_kg_m2
        }),
        Number::within("viscous_friction_nm_s", "N m s/rad", 0.0, 1e4, |axis| {
            &mut axis.parameters.viscous_friction_nm_s
        }),
        Number::within("coulomb_friction_nm", "N m", 0.0, 1e5, |axis| {
            &mut axis.parameters.coulomb_friction_nm
        }),
        Number::within("coulomb_smoothing_rad_s", "rad/s", 1e-6, 1e3, |axis| {
            &mut axis.parameters.coulomb_smoothing_rad_s
        }),
        Number::within("coulomb_asymmetry_nm", "N m", -1e5, 1e5, |axis| {
            &mut axis.friction.coulomb_asymmetry_nm
        }),
        Number::within("stribeck_nm", "N m", 0.0, 1e5, |axis| {
            &mut axis.friction.stribeck_nm
        }),
        Number::or_none("stribeck_rad_s", "rad/s", 1e-6, 1e7, |axis| {
            &mut axis.friction.stribeck_rad_s
        }),
        Number::or_none("presliding_rad", "rad", 1e-12, 1e4, |axis| {
            &mut axis.friction.presliding_rad
        }),
        Number::or_none("table_share", "", 0.01, 0.99, |axis| {
            &mut axis.transmission.table_share
        }),
        Number::or_none("resonance_rad_s", "rad/s", 1e-1, 1e6, |axis| {
            &mut axis.transmission.resonance_rad_s
        }),
        Number::within("damping_ratio", "", 0.0, 1.0, |axis| {
            &mut axis.transmission.damping_ratio
        }),
        Number::within("backlash_rad", "rad", 0.0, 1e3, |axis| {
            &mut axis.transmission.backlash_rad
        }),
        Number::within("encoder_noise_rad", "rad", 0.0, 1e3, |axis| {
            &mut axis.statistics.encoder_noise_rad
        }),
        Number::within("encoder_step_rad", "rad", 0.0, 1e3, |axis| {
            &mut axis.statistics.encoder_step_rad
        }),
        Number::within("interpolation_rad", "rad", 0.0, 1e3, |axis| {
            &mut axis.statistics.interpolation_rad
        }),
        Number::within("interpolation_phase_rad", "rad", -10.0, 10.0, |axis| {
            &mut axis.statistics.interpolation_phase_rad
        }),
        Number::within("signal_per_rad", "1/rad", 0.0, 1e9, |axis| {
            &mut axis.statistics.signal_per_rad
        }),
        Number::within("torque_noise_nm", "N m", 0.0, 1e5, |axis| {
            &mut axis.statistics.torque_noise_nm
        }),
        Number::or_none("torque_noise_s", "s", 1e-9, 10.0, |axis| {
            &mut axis.statistics.torque_noise_s
        }),
        Number::within("disturbance_nm", "N m", 0.0, 1e5, |axis| {
            &mut axis.statistics.disturbance_nm
        }),
        Number::within("disturbance_rad_s", "rad/s", 0.0, 1e6, |axis| {
            &mut axis.statistics.disturbance_rad_s
        }),
        Number::within("disturbance_wander", "", 0.0, 0.5, |axis| {
            &mut axis.statistics.disturbance_wander
        }),
        Number::within("cogging_nm", "N m", 0.0, 1e5, |axis| {
            &mut axis.statistics.cogging_nm
        }),
        Number::within("cogging_phase_rad", "rad", -10.0, 10.0, |axis| {
            &mut axis.statistics.cogging_phase_rad
        }),
        Number::within("cogging_per_rev", "1/rev", 0.0, 1e4, |axis| {
            &mut axis.statistics.cogging_per_rev
        }),
        Number {
            format: 3,
            ..Number::newer("command_delay_s", "s", 0.02, |axis| {
                &mut axis.delays.command_s
            })
        },
    ];

    /// Returns true if a command can follow the drive. With a damping below 0.3 the acceleration
    /// feedforward makes the offset ring and take all the torque: random machines with 0.7 of it
    /// and no velocity feedforward reached 2 mm, where 6 um remained uncorrected.
    pub fn is_followed(&self) -> bool {
        self.command_damping() >= LEAST_DAMPING
    }

    /// Returns the damping ratio of the command that asks the drive for a given speed:
    ///
    /// ```text
    /// w = kp (c - x) + F c' + (J A / Kv) c''      zeta = F / (2 (kp J A / Kv)^(1/2))
    /// ```
    ///
    /// with the position gain kp, the velocity feedforward F and the acceleration feedforward A.
    /// Infinite without A. Where it is low, the command rings.
    fn command_damping(&self) -> f64 {
        let Self {
            parameters, drive, ..
        } = self;
        let added_s =
            parameters.inertia_kg_m2 * drive.acceleration_feedforward / parameters.kv_nm_s_per_rad;
        if added_s > 0.0 {
            drive.velocity_feedforward / (2.0 * libm::sqrt(parameters.kp_1_s * added_s))
        } else {
            f64::INFINITY
        }
    }

    /// Returns true if each of its numbers is within its range.
    pub fn is_possible(mut self) -> bool {
        Self::NUMBERS
            .iter()
            .all(|number| number.holds(*(number.of)(&mut self)))
    }
}

/// Smallest damping of a command that follows a drive.
const LEAST_DAMPING: f64 = 0.3;

/// Smallest gain of a position loop, 1/s. An axis with it takes 9 s to come within 1 % of a new
/// position, and lags by 33 mm at 1 m/min; the slowest machine tools have ten times this gain. A
/// gain in 1/ms, or a gain of a controller whose output is in volts, is usually smaller.
const LEAST_POSITION_GAIN_1_S: f64 = 0.5;

/// Product of position gain Kp and servo period T above which the loop diverges. With a drive that
/// follows at once, an error e becomes (1 - Kp T) e within a period, which diverges above 2. A
/// first-order drive keeps the loop stable up to 4.1, where its time constant is T / 3.7.
const DIVERGING_GAIN: f64 = 5.0;

/// Returns the range of the position gain in a loop with this servo period, 1/s. A gain outside it
/// has another unit or belongs to another loop.
pub fn position_gains_1_s(servo_s: f64) -> [f64; 2] {
    [LEAST_POSITION_GAIN_1_S, DIVERGING_GAIN / servo_s]
}

/// A number of an axis.
#[derive(Debug, Clone, Copy)]
pub struct Number {
    /// Name, which ends in the unit.
    pub name: &'static str,
    /// Unit for messages; empty for a dimensionless number.
    pub unit: &'static str,
    /// Smallest and largest value.
    pub range: [f64; 2],
    /// True if zero is valid although it is below the range. Zero then means that the axis lacks
    /// this part. Other values below the range are rejected, so that nothing is divided by a tiny
    /// number.
    pub or_none: bool,
    /// True if a model file may omit it: files from before this number existed lack it. It is then
    /// zero.
    pub optional: bool,
    /// First format of a model block that has this number. An earlier block leaves it zero.
    pub format: u32,
    /// Field of the axis.
    pub of: fn(&mut AxisKnowledge) -> &mut f64,
}

type Field = fn(&mut AxisKnowledge) -> &mut f64;

impl Number {
    const fn within(
        name: &'static str,
        unit: &'static str,
        least: f64,
        most: f64,
        of: Field,
    ) -> Self {
        Self {
            name,
            unit,
            range: [least, most],
            or_none: false,
            optional: false,
            format: 2,
            of,
        }
    }

    const fn or_none(
        name: &'static str,
        unit: &'static str,
        least: f64,
        most: f64,
        of: Field,
    ) -> Self {
        Self {
            or_none: true,
            ..Self::within(name, unit, least, most, of)
        }
    }

    const fn newer(name: &'static str, unit: &'static str, most: f64, of: Field) -> Self {
        Self {
            optional: true,
            ..Self::within(name, unit, 0.0, most, of)
        }
    }

    /// Returns true if the number may have this value. NaN is never valid.
    pub fn holds(&self, value: f64) -> bool {
        let [least, most] = self.range;
        (value >= least && value <= most) || (self.or_none && value == 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_is_damped_by_velocity_feedforward() {
        let mut axis = AxisKnowledge::NOTHING;
        (axis.parameters.kp_1_s, axis.parameters.kv_nm_s_per_rad) = (50.0, 2.0);
        axis.parameters.inertia_kg_m2 = 0.02;
        assert_eq!(axis.command_damping(), f64::INFINITY);
        assert!(axis.is_followed());
        axis.drive.acceleration_feedforward = 0.5;
        assert_eq!(axis.command_damping(), 0.0);
        for (velocity_feedforward, followed) in [(0.29, false), (0.31, true), (1.0, true)] {
            axis.drive.velocity_feedforward = velocity_feedforward;
            assert_eq!(axis.is_followed(), followed, "{velocity_feedforward}");
        }
        assert_eq!(axis.command_damping(), 1.0);
    }

    #[test]
    fn the_largest_position_gain_depends_on_the_servo_period() {
        assert_eq!(position_gains_1_s(1e-3), [0.5, 5000.0]);
        assert_eq!(position_gains_1_s(4e-3), [0.5, 1250.0]);
    }
}
