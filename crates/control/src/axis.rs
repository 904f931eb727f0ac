//! Model of a servo axis: position loop, speed loop with saturation, inertia and friction.
//!
//! ```text
//! w_ref = Kp e + Kd (e - e_prev) / Ts            PD position loop, once a servo period Ts
//! u     = Kv (w_ref - w) within -Tmax, Tmax      P speed loop with saturation, every mechanics period dt
//! J dw/dt = u - B w - Fc tanh(w / w_s) - load
//! ```
//!
//! All quantities are at the motor shaft. Semi-implicit Euler integrates them: w first, then the
//! angle with the new w. The simulated machine, the prediction and the inverse all use this code.
//!
//! | File | Optional parts of a machine |
//! |---|---|
//! | `axis/drive.rs` | integral of the speed loop, feedforward, speed limit, torque filter |
//! | `axis/friction.rs` | asymmetry, Stribeck curve, presliding |
//! | `axis/transmission.rs` | motor and table as two masses: stiffness, damping, backlash of the ball screw |
//! | `axis/delays.rs` | delays of commands, references and positions |
//!
//! `axis/mechanics.rs` steps motor, table and friction under given torques. `axis/inverse.rs`
//! solves the complete model for the command.
//!
//! Symbols: e position error at the motor, rad; w speed of the motor, rad/s; u torque, N m; Kp, Kd
//! gains of the position loop, 1/s and dimensionless; Kv gain of the speed loop, N m s/rad; J
//! inertia, kg m^2; B viscous friction, N m s/rad; Fc Coulomb friction, N m, which changes sign
//! over w_s, rad/s.
//!
//! Source: Lee, Cho and Jeon (2005), section 4, Table 1 and Fig. 6, which name the parts. The
//! equations have the usual form for such a loop.

pub(crate) mod numbers;
pub(crate) mod drive;
pub(crate) mod friction;
pub(crate) mod transmission;
pub(crate) mod mechanics;
pub(crate) mod delays;
pub(crate) mod inverse;

use crate::activation::tanh;
pub(crate) use numbers::Parameters;

/// Periods of the loops.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Periods {
    /// Period of the position loop, s.
    pub servo_s: f64,
    /// Period of the speed loop and of the integration of the mechanics, s.
    pub mechanics_s: f64,
    /// Mechanics periods in a servo period.
    pub mechanics_per_servo: u32,
}

/// Angle and speed of the motor of an axis, and the last error that its position loop received.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AxisState {
    /// Angle of the motor, rad.
    pub angle_rad: f64,
    /// Speed of the motor, rad/s.
    pub speed_rad_s: f64,
    /// Position error at the last servo period, rad.
    pub error_rad: f64,
}

/// An axis, ready to be integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisModel {
    /// Parameters of the axis.
    pub parameters: Parameters,
    /// Periods of the loops.
    pub periods: Periods,
    inverse_inertia: f64,
    inverse_smoothing_s: f64,
}

impl AxisModel {
    /// Creates an axis with these parameters and periods.
    pub fn new(parameters: Parameters, periods: Periods) -> Self {
        Self {
            parameters,
            periods,
            inverse_inertia: 1.0 / parameters.inertia_kg_m2,
            inverse_smoothing_s: 1.0 / parameters.coulomb_smoothing_rad_s,
        }
    }

    /// Returns the same axis with other numbers.
    #[must_use]
    pub fn with(&self, change: impl FnOnce(&mut Parameters)) -> Self {
        let mut parameters = self.parameters;
        change(&mut parameters);
        Self::new(parameters, self.periods)
    }

    /// Passes a position error, rad, to the PD position loop. Returns the reference speed, rad/s.
    /// The loop is linear: from the derivative of the error it makes the derivative of that speed.
    #[inline]
    pub fn position_loop(&self, error_rad: f64, state: &mut AxisState) -> f64 {
        let rate_rad_s = (error_rad - state.error_rad) / self.periods.servo_s;
        state.error_rad = error_rad;
        self.parameters.kp_1_s * error_rad + self.parameters.kd * rate_rad_s
    }

    /// Returns the torque of the speed loop, N m. NaN stays NaN.
    #[inline]
    pub fn torque_nm(&self, reference_rad_s: f64, speed_rad_s: f64) -> f64 {
        let wanted = self.parameters.kv_nm_s_per_rad * (reference_rad_s - speed_rad_s);
        within(wanted, self.parameters.torque_limit_nm)
    }

    /// Returns the friction torque at a speed, N m. `sign` is the factor of the Coulomb friction,
    /// -1 to 1, from `friction_signs`.
    #[inline]
    pub fn friction_nm(&self, speed_rad_s: f64, sign: f64) -> f64 {
        self.parameters.viscous_friction_nm_s * speed_rad_s
            + self.parameters.coulomb_friction_nm * sign
    }

    /// Integrates one mechanics period under a torque, N m.
    #[inline]
    pub fn accelerate(&self, torque_nm: f64, state: &mut AxisState) {
        state.speed_rad_s += self.periods.mechanics_s * self.inverse_inertia * torque_nm;
        state.angle_rad += self.periods.mechanics_s * state.speed_rad_s;
    }

    /// Returns the derivatives of the torque left for the inertia, N m s/rad: with respect to the
    /// reference speed, and, with the sign reversed, with respect to the speed. `torque_nm` is the
    /// torque of the speed loop; at the torque limit its gain counts as 0. `sign` is the factor of
    /// the Coulomb friction from `friction_signs`.
    #[inline]
    pub fn slopes_nm_s(&self, torque_nm: f64, sign: f64) -> [f64; 2] {
        let Parameters {
            kv_nm_s_per_rad,
            torque_limit_nm,
            viscous_friction_nm_s,
            coulomb_friction_nm,
            ..
        } = self.parameters;
        let gain = if torque_nm.abs() < torque_limit_nm {
            kv_nm_s_per_rad
        } else {
            0.0
        };
        let coulomb = coulomb_friction_nm * (1.0 - sign * sign) * self.inverse_smoothing_s;
        [gain, gain + (viscous_friction_nm_s + coulomb)]
    }
}

/// Limits a value to -most..most. NaN stays NaN.
#[inline]
fn within(value: f64, most: f64) -> f64 {
    if value > most {
        most
    } else if value < -most {
        -most
    } else {
        value
    }
}

/// Returns tanh(w / w_s) of each axis. One call for all axes is faster.
#[inline]
pub fn friction_signs<const N: usize>(axes: &[AxisModel; N], speeds_rad_s: [f64; N]) -> [f64; N] {
    tanh(core::array::from_fn::<_, N, _>(|i| {
        speeds_rad_s[i] * axes[i].inverse_smoothing_s
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis() -> AxisModel {
        let parameters = Parameters {
            rad_per_mm: 0.6,
            kp_1_s: 50.0,
            kd: 0.1,
            kv_nm_s_per_rad: 2.0,
            torque_limit_nm: 30.0,
            inertia_kg_m2: 0.01,
            viscous_friction_nm_s: 0.03,
            coulomb_friction_nm: 0.2,
            coulomb_smoothing_rad_s: 0.5,
            ..Parameters::NOTHING
        };
        AxisModel::new(
            parameters,
            Periods {
                servo_s: 0.001,
                mechanics_s: 0.0001,
                mechanics_per_servo: 10,
            },
        )
    }

    /// Torque left for the inertia.
    fn left_nm(axis: &AxisModel, reference_rad_s: f64, speed_rad_s: f64) -> f64 {
        let [sign] = friction_signs(&[*axis], [speed_rad_s]);
        axis.torque_nm(reference_rad_s, speed_rad_s) - axis.friction_nm(speed_rad_s, sign)
    }

    #[test]
    fn the_slopes_are_the_difference_quotients_of_the_torque() {
        let (axis, h) = (axis(), 1e-5);
        for (reference, speed) in [(1.0, 0.9), (0.1, -0.2), (3.0, 0.0), (100.0, 1.0)] {
            let [sign] = friction_signs(&[axis], [speed]);
            let [gain, damping] = axis.slopes_nm_s(axis.torque_nm(reference, speed), sign);
            let to_reference = (left_nm(&axis, reference + h, speed)
                - left_nm(&axis, reference - h, speed))
                / (2.0 * h);
            let to_speed = (left_nm(&axis, reference, speed + h)
                - left_nm(&axis, reference, speed - h))
                / (2.0 * h);
            assert!(
                (gain - to_reference).abs() < 1e-6 && (damping + to_speed).abs() < 1e-6,
                "{reference} {speed}"
            );
        }
    }

    #[test]
    fn the_torque_is_within_its_limit_and_what_is_no_number_stays_none() {
        let axis = axis();
        assert_eq!(
            [1e9, -1e9, f64::INFINITY].map(|w| axis.torque_nm(w, 0.0)),
            [30.0, -30.0, 30.0]
        );
        assert!(axis.torque_nm(f64::NAN, 0.0).is_nan());
    }

    #[test]
    fn a_step_of_the_speed_is_taken_within_the_time_constant_of_the_loop() {
        // J dw/dt = Kv (1 - w) without friction: w = 1 - exp(-t Kv / J), 5 ms.
        let parameters = Parameters {
            viscous_friction_nm_s: 0.0,
            coulomb_friction_nm: 0.0,
            ..axis().parameters
        };
        let axis = AxisModel::new(
            parameters,
            Periods {
                mechanics_s: 1e-6,
                ..axis().periods
            },
        );
        let mut state = AxisState::default();
        (0..5000).for_each(|_| axis.accelerate(axis.torque_nm(1.0, state.speed_rad_s), &mut state));
        assert!(
            (state.speed_rad_s - (1.0 - libm::exp(-1.0))).abs() < 1e-4,
            "{}",
            state.speed_rad_s
        );
        assert!(
            (state.angle_rad - 0.005 * libm::exp(-1.0)).abs() < 1e-6,
            "{}",
            state.angle_rad
        );
    }
}
