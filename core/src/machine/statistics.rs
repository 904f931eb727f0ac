//! What is true of a simulated axis beside what may be known of it ([`super::Known`]): statistics of its noise, what depends on the
//! angle of the motor, with its phase, and the load.
//!
//! It is for the limit alone ([`crate::controllers::lqg_preview`]): what a controller would reach that knew all that can be known. The
//! random numbers themselves nobody knows.

use std::f64::consts::TAU;

use super::Machine;

/// What is true of an axis; at the motor shaft, zero is without.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AxisStatistics {
    /// RMS of the encoder's white noise, rad.
    pub encoder_noise_rad: f64,
    /// Its step, rad.
    pub encoder_step_rad: f64,
    /// Amplitude of its error within a signal period, rad.
    pub interpolation_rad: f64,
    /// Turns of the signal in a radian, times 2 pi.
    pub signal_per_rad: f64,
    /// RMS of the broadband torque, N m, and its correlation time, s.
    pub torque_noise_nm: f64,
    /// See above.
    pub torque_noise_s: f64,
    /// Amplitude of the disturbance, N m.
    pub disturbance_nm: f64,
    /// Its frequency, rad/s.
    pub disturbance_rad_s: f64,
    /// RMS by which that wanders, a part of it.
    pub disturbance_wander: f64,
    /// Amplitude of the cogging torque, N m.
    pub cogging_nm: f64,
    /// Its periods in a turn.
    pub cogging_per_rev: f64,
}

impl Machine {
    /// What is true of its axes.
    pub fn statistics<const N: usize>(&self) -> [AxisStatistics; N] {
        std::array::from_fn(|i| {
            let axis = self.axis(i);
            let rad = |um: f64| um * 1e-3 * axis.rad_per_mm();
            let signal_rad = rad(axis.signal_period_um);
            AxisStatistics {
                encoder_noise_rad: rad(axis.encoder_noise_um),
                encoder_step_rad: rad(axis.encoder_step_um),
                interpolation_rad: rad(axis.interpolation_error_um),
                signal_per_rad: if signal_rad > 0.0 { TAU / signal_rad } else { 0.0 },
                torque_noise_nm: axis.torque_noise_nm,
                torque_noise_s: axis.torque_noise_s,
                disturbance_nm: axis.disturbance_nm,
                disturbance_rad_s: TAU * axis.disturbance_hz,
                disturbance_wander: axis.disturbance_wander,
                cogging_nm: axis.cogging_nm,
                cogging_per_rev: axis.cogging_per_rev,
            }
        })
    }
}
