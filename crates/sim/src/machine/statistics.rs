//! True properties of a simulated axis beyond those that may be known ([`super::Known`]): the
//! statistics of its noise, what depends on the angle of the motor, with its phase, and the load.
//!
//! The limit (`lqg-preview` of the laboratory) uses them: it shows the result of a controller that
//! knows everything that can be known. The random numbers themselves cannot be known.
//! `feedwright_ident::exact_block` also writes these properties into a model block.

use std::f64::consts::TAU;

use feedwright_control::AxisStatistics;

use super::Machine;

impl Machine {
    /// Returns the true statistics of the axes.
    pub fn statistics<const N: usize>(&self) -> [AxisStatistics; N] {
        std::array::from_fn(|i| {
            let axis = self.axis(i);
            let rad = |um: f64| um * 1e-3 * axis.rad_per_mm();
            let signal_rad = rad(axis.signal_period_um);
            AxisStatistics {
                encoder_noise_rad: rad(axis.encoder_noise_um),
                encoder_step_rad: rad(axis.encoder_step_um),
                interpolation_rad: rad(axis.interpolation_error_um),
                interpolation_phase_rad: 0.0,
                signal_per_rad: if signal_rad > 0.0 {
                    TAU / signal_rad
                } else {
                    0.0
                },
                torque_noise_nm: axis.torque_noise_nm,
                torque_noise_s: axis.torque_noise_s,
                disturbance_nm: axis.disturbance_nm,
                disturbance_rad_s: TAU * axis.disturbance_hz,
                disturbance_wander: axis.disturbance_wander,
                cogging_nm: axis.cogging_nm,
                cogging_phase_rad: 0.0,
                cogging_per_rev: axis.cogging_per_rev,
            }
        })
    }
}
