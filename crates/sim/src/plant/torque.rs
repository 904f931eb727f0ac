//! Torques in addition to the drive's: ripple and cogging of the motor, broadband torque, and a
//! disturbance whose frequency wanders.
//!
//! ```text
//! motor:    u (1 + r sin(n_r th)) + C sin(n_c th + c)           th angle of the motor, rad; n periods in a turn, c phase
//! load:     D sin(phi) + x,     x noise with a correlation time   as in `noise.rs`, one step a mechanics period
//! phi = 2 pi f t + psi,  d psi/dt = 2 pi f y                     y noise with a correlation time of 1 s, one step a servo period
//! ```
//!
//! Broadband torque is the part of cutting and guideway torque that is not a sine. It acts at all
//! times, on the table if the axis has one.
//!
//! Source: Holtz and Springob (1996), Identification and compensation of torque ripple in
//! high-precision permanent magnet motor drives, for ripple and cogging as harmonics of the angle;
//! Altintas (2012), Manufacturing Automation, chapter 2, for the cutting force at the tooth passing
//! frequency, which follows the spindle's speed.

use std::f64::consts::TAU;

use super::noise::{CorrelatedNoise, RandomStream, RandomUse};
use crate::machine::Axis;

/// Correlation time of the disturbance's frequency, s: a spindle's speed control lets it wander
/// over about a second.
const WANDER_S: f64 = 1.0;

/// Ripple and cogging of a motor.
#[derive(Debug, Clone, Copy)]
pub(super) struct MotorTorque {
    ripple: f64,
    ripple_per_rev: f64,
    cogging_nm: f64,
    cogging_per_rev: f64,
    cogging_phase_rad: f64,
}

impl MotorTorque {
    /// None where it has neither.
    pub(super) fn new(axis: &Axis) -> Option<Self> {
        let Axis {
            ripple,
            ripple_per_rev,
            cogging_nm,
            cogging_per_rev,
            cogging_phase_rad,
            ..
        } = *axis;
        (ripple > 0.0 || cogging_nm > 0.0).then_some(Self {
            ripple,
            ripple_per_rev,
            cogging_nm,
            cogging_per_rev,
            cogging_phase_rad,
        })
    }

    /// Returns the motor torque for a drive torque at an angle, N m.
    pub(super) fn at_nm(&self, drive_nm: f64, angle_rad: f64) -> f64 {
        let mut torque_nm = drive_nm;
        if self.ripple > 0.0 {
            torque_nm *= 1.0 + self.ripple * libm::sin(self.ripple_per_rev * angle_rad);
        }
        if self.cogging_nm > 0.0 {
            let phase_rad = self.cogging_per_rev * angle_rad + self.cogging_phase_rad;
            torque_nm += self.cogging_nm * libm::sin(phase_rad);
        }
        torque_nm
    }
}

/// Returns the broadband torque of an axis; `None` if it has none.
pub(super) fn broadband(
    axis: &Axis,
    dt_s: f64,
    seed: u64,
    index: usize,
) -> Option<CorrelatedNoise> {
    let stream = RandomStream::new(seed, index, RandomUse::Torque);
    (axis.torque_noise_nm > 0.0)
        .then(|| CorrelatedNoise::new(stream, axis.torque_noise_nm, axis.torque_noise_s, dt_s))
}

/// The disturbance's frequency, which is not constant.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wander {
    noise: CorrelatedNoise,
    nominal_rad_s: f64,
    servo_s: f64,
    mechanics_s: f64,
    /// Lead of the phase over the phase at the nominal frequency, rad.
    ahead_rad: f64,
}

impl Wander {
    /// None where it is constant.
    pub(super) fn new(
        axis: &Axis,
        servo_s: f64,
        mechanics_s: f64,
        seed: u64,
        index: usize,
    ) -> Option<Self> {
        let stream = RandomStream::new(seed, index, RandomUse::Wander);
        (axis.disturbance_wander > 0.0).then(|| Self {
            noise: CorrelatedNoise::new(stream, axis.disturbance_wander, WANDER_S, servo_s),
            nominal_rad_s: TAU * axis.disturbance_hz,
            servo_s,
            mechanics_s,
            ahead_rad: 0.0,
        })
    }

    /// A servo period begins at t: cos and sin of the phase there, and of the angle by which it
    /// turns in a mechanics period.
    pub(super) fn servo_period(&mut self, period: u64, t_s: f64) -> [[f64; 2]; 2] {
        let faster_rad_s = self.nominal_rad_s * self.noise.next(period);
        let (sin, cos) = libm::sincos(self.nominal_rad_s * t_s + self.ahead_rad);
        let (turn_sin, turn_cos) =
            libm::sincos((self.nominal_rad_s + faster_rad_s) * self.mechanics_s);
        self.ahead_rad += faster_rad_s * self.servo_s;
        [[cos, sin], [turn_cos, turn_sin]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::Machine;

    fn axis() -> Axis {
        Machine::load("tnv40".as_ref()).unwrap().axes[0]
    }

    #[test]
    fn ripple_follows_the_torque_and_cogging_the_angle_alone() {
        let motor = MotorTorque::new(&Axis {
            ripple: 0.05,
            ripple_per_rev: 6.0,
            cogging_nm: 0.04,
            cogging_per_rev: 24.0,
            ..axis()
        })
        .unwrap();
        for (turn, ripple, cogging) in [
            (0.0, 0.0, 0.0),
            (1.0 / 24.0, 0.05, 0.0),
            (1.0 / 96.0, 0.05 * 0.382_683_432, 0.04),
        ] {
            for drive_nm in [0.0, 2.0, -3.0] {
                let wanted = drive_nm * (1.0 + ripple) + cogging;
                assert!(
                    (motor.at_nm(drive_nm, TAU * turn) - wanted).abs() < 1e-9,
                    "{turn} {drive_nm}"
                );
                assert!(
                    (motor.at_nm(drive_nm, TAU * (turn + 1.0)) - wanted).abs() < 1e-9,
                    "a turn on"
                );
            }
        }
        assert!(MotorTorque::new(&axis()).is_none());
    }

    #[test]
    fn a_phase_shifts_the_cogging() {
        let motor = MotorTorque::new(&Axis {
            cogging_nm: 0.04,
            cogging_per_rev: 24.0,
            cogging_phase_rad: 0.25 * TAU,
            ..axis()
        })
        .unwrap();
        for (turn, wanted) in [(0.0, 0.04), (1.0 / 96.0, 0.0), (1.0 / 48.0, -0.04)] {
            let cogging = motor.at_nm(0.0, TAU * turn);
            assert!((cogging - wanted).abs() < 1e-9, "{turn}: {cogging}");
        }
    }

    #[test]
    fn the_phase_is_the_integral_of_the_wandering_frequency() {
        let axis = Axis {
            disturbance_wander: 0.02,
            disturbance_hz: 25.0,
            ..axis()
        };
        let (servo_s, mechanics_s) = (1e-3, 1e-4);
        let mut wander = Wander::new(&axis, servo_s, mechanics_s, 5, 0).unwrap();
        let (mut last, mut square, periods) = (None, 0.0, 400_000_u64);
        for n in 0..periods {
            let [[cos, sin], [turn_cos, turn_sin]] = wander.servo_period(n, n as f64 * servo_s);
            let part = libm::atan2(turn_sin, turn_cos) / mechanics_s / (TAU * 25.0) - 1.0;
            square += part * part / periods as f64;
            if let Some(expected) = last {
                let off: f64 = libm::atan2(sin, cos) - expected;
                assert!(
                    libm::sin(off).abs() < 1e-6 && libm::cos(off) > 0.0,
                    "{n}: the phase has no steps"
                );
            }
            last = Some(libm::atan2(sin, cos) + 10.0 * libm::atan2(turn_sin, turn_cos));
        }
        // 400 s are 200 independent values: 5 % for the deviation, four times that is allowed.
        assert!(
            (square.sqrt() - 0.02).abs() < 0.2 * 0.02,
            "{}",
            square.sqrt()
        );
    }
}
