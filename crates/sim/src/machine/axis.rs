//! An axis of a machine file, and its parts.

use std::f64::consts::TAU;

use feedwright_control::{
    DriveParameters, FrictionParameters, LoopDelays, Parameters, TransmissionParameters,
};
use serde::Serialize;

/// A servo axis: mechanics at the motor shaft and the two control loops.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Axis {
    /// Travel for one motor turn, mm.
    pub lead_mm_per_rev: f64,
    /// Inertia at the motor shaft, kg m2.
    pub inertia_kg_m2: f64,
    /// Viscous friction, N m s/rad.
    pub viscous_friction_nm_s: f64,
    /// Coulomb friction torque, N m.
    pub coulomb_friction_nm: f64,
    /// Speed over which the Coulomb torque turns its sign, rad/s.
    pub coulomb_smoothing_rad_s: f64,
    /// Amplitude of the disturbance torque, N m.
    pub disturbance_nm: f64,
    /// Frequency of the disturbance torque, Hz.
    pub disturbance_hz: f64,
    /// Proportional gain of the position loop, 1/s.
    pub kp_1_s: f64,
    /// Derivative gain of the position loop, dimensionless: rad/s of command for a rad/s of error
    /// rate.
    pub kd: f64,
    /// Gain of the speed loop, N m s/rad.
    pub kv_nm_s_per_rad: f64,
    /// Torque at which the drive saturates, N m.
    pub torque_limit_nm: f64,
    /// Acceleration that a correction of the command may add to the plan's, mm/s2; none is no limit
    /// in the loop, and the machine's [`super::Limits::normal_accel_mm_s2`] for a correction that
    /// fades.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correction_accel_mm_s2: Option<f64>,
    /// Acceleration of a correction that fades, mm/s2, kept where a plan by axes adds limits that
    /// the file does not state.
    #[serde(skip)]
    pub fade_accel_mm_s2: Option<f64>,
    /// Delay between the control and the position loop, s; rounded to whole servo periods.
    #[serde(skip_serializing_if = "is_zero")]
    pub command_delay_s: f64,
    /// Delay between the position loop and the drive, s.
    #[serde(skip_serializing_if = "is_zero")]
    pub drive_delay_s: f64,
    /// Bits of the torque command over the range from minus to plus [`Self::torque_limit_nm`]; none
    /// is without steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque_bits: Option<u32>,
    /// Step of the position encoder, um of travel; 0 is without steps.
    #[serde(skip_serializing_if = "is_zero")]
    pub encoder_step_um: f64,
    /// Integral time of the speed loop, s; here and below zero is without.
    #[serde(skip_serializing_if = "is_zero")]
    pub speed_integral_s: f64,
    /// Part of the command's speed that is fed forward.
    #[serde(skip_serializing_if = "is_zero")]
    pub velocity_feedforward: f64,
    /// Part of the torque for the command's acceleration that is fed forward.
    #[serde(skip_serializing_if = "is_zero")]
    pub acceleration_feedforward: f64,
    /// Corner of the torque filter, Hz.
    #[serde(skip_serializing_if = "is_zero")]
    pub torque_filter_hz: f64,
    /// Highest reference speed of the drive, mm/s of travel.
    #[serde(skip_serializing_if = "is_zero")]
    pub speed_limit_mm_s: f64,
    /// RMS of white noise of the encoder, um of travel.
    #[serde(skip_serializing_if = "is_zero")]
    pub encoder_noise_um: f64,
    /// Amplitude of its error within a signal period, um of travel.
    #[serde(skip_serializing_if = "is_zero")]
    pub interpolation_error_um: f64,
    /// Signal period of the encoder, um of travel.
    #[serde(skip_serializing_if = "is_zero")]
    pub signal_period_um: f64,
    /// Latency of the measured position, s.
    #[serde(skip_serializing_if = "is_zero")]
    pub measurement_delay_s: f64,
    /// Largest extra delay of a reference on its way to the drive, s.
    #[serde(skip_serializing_if = "is_zero")]
    pub jitter_s: f64,
    /// Asymmetry of the Coulomb friction, N m: the friction is higher by this in the positive
    /// direction, and lower by it in the negative.
    #[serde(skip_serializing_if = "is_zero")]
    pub coulomb_asymmetry_nm: f64,
    /// Friction at rest above the Coulomb friction, N m.
    #[serde(skip_serializing_if = "is_zero")]
    pub stribeck_nm: f64,
    /// Speed over which this extra friction decays, mm/s of travel.
    #[serde(skip_serializing_if = "is_zero")]
    pub stribeck_mm_s: f64,
    /// Deflection before friction slides, um of travel.
    #[serde(skip_serializing_if = "is_zero")]
    pub presliding_um: f64,
    /// Amplitude of the cogging torque, N m.
    #[serde(skip_serializing_if = "is_zero")]
    pub cogging_nm: f64,
    /// Its periods in a motor turn.
    #[serde(skip_serializing_if = "is_zero")]
    pub cogging_per_rev: f64,
    /// Amplitude of the torque ripple, part of the torque.
    #[serde(skip_serializing_if = "is_zero")]
    pub ripple: f64,
    /// Its periods in a motor turn.
    #[serde(skip_serializing_if = "is_zero")]
    pub ripple_per_rev: f64,
    /// RMS of the broadband torque, N m.
    #[serde(skip_serializing_if = "is_zero")]
    pub torque_noise_nm: f64,
    /// Its correlation time, s.
    #[serde(skip_serializing_if = "is_zero")]
    pub torque_noise_s: f64,
    /// RMS of the disturbance's frequency, part of it.
    #[serde(skip_serializing_if = "is_zero")]
    pub disturbance_wander: f64,
    /// Scale error: extra travel of the tool beyond the encoder reading, um per meter.
    #[serde(skip_serializing_if = "is_zero")]
    pub scale_um_m: f64,
    /// Amplitude of the error within a turn of the screw, um.
    #[serde(skip_serializing_if = "is_zero")]
    pub pitch_error_um: f64,
    /// Time over which the drive takes the speed from positions, s; no more than a mechanics period
    /// is the speed itself.
    #[serde(skip_serializing_if = "is_zero")]
    pub speed_window_s: f64,
    /// True if the drive samples the speed at the start of each servo period and holds it.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub speed_held: bool,
    /// True if the speed loop computes the speed from differences of the encoder.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub speed_from_encoder: bool,
    /// Most that the axis can, for planners that plan axis by axis; none is what [`super::Limits`]
    /// and the drive allow. Speed, mm/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_velocity_mm_s: Option<f64>,
    /// Acceleration, mm/s2.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_accel_mm_s2: Option<f64>,
    /// Jerk, mm/s3.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_jerk_mm_s3: Option<f64>,
    /// Ball screw; none is rigid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transmission: Option<Transmission>,
}

impl Axis {
    /// Returns true if any property of the axis is random.
    pub(super) fn is_noisy(&self) -> bool {
        [
            self.encoder_noise_um,
            self.jitter_s,
            self.torque_noise_nm,
            self.disturbance_wander,
        ]
        .iter()
        .any(|&size| size > 0.0)
    }

    /// Returns the parameters in the form that the axis model takes.
    pub fn parameters(&self) -> Parameters {
        Parameters {
            rad_per_mm: self.rad_per_mm(),
            kp_1_s: self.kp_1_s,
            kd: self.kd,
            kv_nm_s_per_rad: self.kv_nm_s_per_rad,
            torque_limit_nm: self.torque_limit_nm,
            inertia_kg_m2: self.inertia_kg_m2,
            viscous_friction_nm_s: self.viscous_friction_nm_s,
            coulomb_friction_nm: self.coulomb_friction_nm,
            coulomb_smoothing_rad_s: self.coulomb_smoothing_rad_s,
        }
    }

    /// Returns the drive parameters other than the gains of its loops.
    pub fn drive(&self) -> DriveParameters {
        DriveParameters {
            speed_integral_s: self.speed_integral_s,
            velocity_feedforward: self.velocity_feedforward,
            acceleration_feedforward: self.acceleration_feedforward,
            torque_filter_hz: self.torque_filter_hz,
            speed_limit_rad_s: self.speed_limit_mm_s * self.rad_per_mm(),
            speed_window_s: self.speed_window_s,
        }
    }

    /// Returns the delays of commands, references and positions.
    pub fn loop_delays(&self) -> LoopDelays {
        LoopDelays {
            command_s: self.command_delay_s,
            drive_s: self.drive_delay_s,
            measurement_s: self.measurement_delay_s,
        }
    }

    /// Returns the friction parameters other than the Coulomb and viscous part.
    pub fn friction(&self) -> FrictionParameters {
        FrictionParameters {
            coulomb_asymmetry_nm: self.coulomb_asymmetry_nm,
            stribeck_nm: self.stribeck_nm,
            stribeck_rad_s: self.stribeck_mm_s * self.rad_per_mm(),
            presliding_rad: self.presliding_um * 1e-3 * self.rad_per_mm(),
        }
    }

    /// Its ball screw.
    pub fn transmission(&self) -> TransmissionParameters {
        self.transmission
            .map_or(TransmissionParameters::RIGID, |screw| {
                TransmissionParameters {
                    table_share: screw.table_share,
                    resonance_rad_s: TAU * screw.resonance_hz,
                    damping_ratio: screw.damping_ratio,
                    backlash_rad: screw.backlash_um * 1e-3 * TAU / self.lead_mm_per_rev,
                }
            })
    }

    /// Backlash that the encoder does not see, mm: a scale on the table sees the gap.
    pub fn hidden_backlash_mm(&self) -> f64 {
        self.hidden_screw()
            .map_or(0.0, |screw| 1e-3 * screw.backlash_um)
    }

    /// Returns the windup of the screw by the friction of both directions before the table moves,
    /// mm: the part that the encoder does not see.
    pub fn hidden_windup_mm(&self) -> f64 {
        let windup_rad = self
            .transmission()
            .windup_rad(self.inertia_kg_m2, self.coulomb_friction_nm);
        self.hidden_screw()
            .map_or(0.0, |_| windup_rad / self.rad_per_mm())
    }

    /// The screw, where the encoder is at the motor.
    pub(crate) fn hidden_screw(&self) -> Option<Transmission> {
        self.transmission.filter(|screw| !screw.scale_on_table)
    }

    /// Turn of the motor for a travel, rad/mm.
    pub fn rad_per_mm(&self) -> f64 {
        TAU / self.lead_mm_per_rev
    }
}

/// The ball screw between motor and table: `[axis.x.transmission]`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Transmission {
    /// Part of the axis's inertia that is on the table's side.
    pub table_share: f64,
    /// Resonance of the table on the screw while the motor is held, Hz.
    pub resonance_hz: f64,
    /// Its damping ratio.
    pub damping_ratio: f64,
    /// Backlash, um of travel.
    pub backlash_um: f64,
    /// True if the position is measured at the table (a linear scale) instead of the motor.
    pub scale_on_table: bool,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde gives a reference")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}
