//! Motor and table as two masses, joined by the ball screw: stiffness, damping and backlash.
//!
//! ```text
//! phi  = angle_m - angle_t                            twist, rad at the motor shaft
//! T    = max(0, k (phi - b/2) + c (w_m - w_t))        phi >  b/2
//! T    = min(0, k (phi + b/2) + c (w_m - w_t))        phi < -b/2
//! T    = 0                                            in the gap: flanks push and do not pull
//! J_m dw_m/dt = u - T         J_t dw_t/dt = T - friction(w_t) - disturbance
//! ```
//!
//! J_m + J_t = J, so the rigid axis is the limit of a stiff screw. Friction and disturbance act on
//! the table, where the guideways and the cutter are. w_r is the resonance of the table while the
//! servo holds the motor, as a knock on the table shows it. It gives k = J_t w_r^2 and, with the
//! damping ratio D, c = 2 D J_t w_r. With a free motor the two masses swing against each other at
//! w_r sqrt(J / J_m).
//!
//! Source: two-mass drive as in Altintas (2012), Manufacturing Automation, section 5; backlash as a
//! dead zone with damping in contact, Nordin and Gutman (2002), eq. 4.

use super::{AxisModel, Parameters};

impl Parameters {
    /// Returns the windup of the screw by the friction of both directions, rad: 2 Fc / k. It is 0
    /// for a rigid screw.
    pub fn windup_rad(&self) -> f64 {
        let stiffness_nm_rad =
            self.inertia_kg_m2 * self.table_share * self.resonance_rad_s * self.resonance_rad_s;
        if stiffness_nm_rad > 0.0 {
            2.0 * self.coulomb_friction_nm / stiffness_nm_rad
        } else {
            0.0
        }
    }
}

/// Angle and speed of the table at the motor shaft.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TableState {
    /// Angle of the table, rad.
    pub angle_rad: f64,
    /// Speed of the table, rad/s.
    pub speed_rad_s: f64,
}

/// A ball screw, ready to be integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TransmissionModel {
    /// Inverse inertia of the motor's side, 1/(kg m2).
    pub inverse_motor_inertia: f64,
    /// Inverse inertia of the table's side, 1/(kg m2).
    pub inverse_table_inertia: f64,
    /// Stiffness, N m/rad.
    pub(crate) stiffness_nm_rad: f64,
    /// Damping in contact, N m s/rad.
    pub(crate) damping_nm_s: f64,
    /// Half of the backlash, rad.
    pub(crate) half_gap_rad: f64,
    /// Resonance of the table on the screw while the motor is held, rad/s.
    pub(crate) resonance_rad_s: f64,
}

/// Largest phase of the oscillation of the two masses in a mechanics period, rad: above 2 the
/// integration is unstable.
const MOST_PHASE_RAD: f64 = 1.0;

impl TransmissionModel {
    /// Creates the screw of an axis. Returns `None` where the screw is rigid, or too stiff for the
    /// mechanics period.
    pub fn new(axis_model: &AxisModel) -> Option<Self> {
        let mechanics_s = axis_model.periods.mechanics_s;
        let Parameters {
            inertia_kg_m2,
            table_share,
            resonance_rad_s,
            damping_ratio,
            backlash_rad,
            ..
        } = axis_model.parameters;
        let table_kg_m2 = inertia_kg_m2 * table_share;
        let free_rad_s = resonance_rad_s / libm::sqrt(1.0 - table_share);
        let gives = table_share > 0.0
            && resonance_rad_s > 0.0
            && free_rad_s * mechanics_s <= MOST_PHASE_RAD;
        gives.then(|| Self {
            inverse_motor_inertia: 1.0 / (inertia_kg_m2 - table_kg_m2),
            inverse_table_inertia: 1.0 / table_kg_m2,
            stiffness_nm_rad: table_kg_m2 * resonance_rad_s * resonance_rad_s,
            damping_nm_s: 2.0 * damping_ratio * table_kg_m2 * resonance_rad_s,
            half_gap_rad: 0.5 * backlash_rad,
            resonance_rad_s,
        })
    }

    /// Returns the static twist of the screw under a constant torque, rad: the angle of the motor
    /// minus the angle of the table. It includes half the backlash.
    pub fn twist_rad(&self, torque_nm: f64) -> f64 {
        torque_nm / self.stiffness_nm_rad + libm::copysign(self.half_gap_rad, torque_nm)
    }

    /// Returns the torque from motor to table, N m.
    #[inline]
    pub fn torque_nm(&self, twist_rad: f64, twist_rad_s: f64) -> f64 {
        let damped = self.damping_nm_s * twist_rad_s;
        if twist_rad > self.half_gap_rad {
            (self.stiffness_nm_rad * (twist_rad - self.half_gap_rad) + damped).max(0.0)
        } else if twist_rad < -self.half_gap_rad {
            (self.stiffness_nm_rad * (twist_rad + self.half_gap_rad) + damped).min(0.0)
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::super::Periods;
    use super::super::numbers::Part;
    use super::*;
    use core::f64::consts::TAU;

    const DT_S: f64 = 1e-5;
    const INERTIA_KG_M2: f64 = 0.01;
    const BACKLASH_RAD: f64 = 0.003;

    fn model(screw: Parameters) -> Option<TransmissionModel> {
        let periods = Periods {
            servo_s: DT_S,
            mechanics_s: DT_S,
            mechanics_per_servo: 1,
        };
        TransmissionModel::new(&AxisModel::new(screw, periods))
    }

    fn soft(backlash_rad: f64) -> (TransmissionModel, Parameters) {
        let resonance_rad_s = TAU * 60.0;
        let screw = Parameters {
            inertia_kg_m2: INERTIA_KG_M2,
            table_share: 0.5,
            resonance_rad_s,
            damping_ratio: 0.02,
            backlash_rad,
            ..Parameters::NOTHING
        };
        (model(screw).expect("it is not rigid"), screw)
    }

    #[test]
    fn a_screw_without_a_table_or_a_resonance_that_can_be_followed_is_rigid() {
        let (_, screw) = soft(0.0);
        for rigid in [
            screw.without(&[Part::Screw]),
            Parameters {
                table_share: 0.0,
                ..screw
            },
            Parameters {
                resonance_rad_s: 0.0,
                ..screw
            },
            Parameters {
                resonance_rad_s: 1e6,
                ..screw
            },
        ] {
            assert_eq!(model(rigid), None);
        }
    }

    #[test]
    fn the_table_rings_at_the_frequency_and_with_the_damping_that_are_named() {
        let (axis_model, screw) = soft(0.0);
        // The table swings against the held motor, from a twist of a milliradian.
        let mut table = TableState {
            angle_rad: 1e-3,
            speed_rad_s: 0.0,
        };
        let (mut upward, mut peaks, mut before) = (Vec::new(), Vec::new(), table.angle_rad);
        for step in 0..50_000 {
            table.speed_rad_s += DT_S
                * axis_model.inverse_table_inertia
                * axis_model.torque_nm(-table.angle_rad, -table.speed_rad_s);
            table.angle_rad += DT_S * table.speed_rad_s;
            if before < 0.0 && table.angle_rad >= 0.0 {
                upward.push(step);
                peaks.push(0.0_f64);
            }
            if let Some(peak) = peaks.last_mut() {
                *peak = peak.max(table.angle_rad);
            }
            before = table.angle_rad;
        }
        let periods = upward.len() - 1;
        let period_s = f64::from(upward[periods] - upward[0]) * DT_S / periods as f64;
        let undamped = libm::sqrt(1.0 - screw.damping_ratio * screw.damping_ratio);
        let damped_hz = screw.resonance_rad_s / TAU * undamped;
        assert!(
            (1.0 / period_s - damped_hz).abs() < 0.01 * damped_hz,
            "{} Hz",
            1.0 / period_s
        );
        // Logarithmic decrement, from peak to peak: 2 pi zeta / sqrt(1 - zeta^2). At zero twist the
        // flanks part: while they pull they are let go, which costs the least bit of damping.
        let decrement = libm::log(peaks[0] / peaks[5]) / 5.0;
        let expected = TAU * screw.damping_ratio / undamped;
        assert!(
            (decrement - expected).abs() < 0.1 * expected,
            "{decrement} {expected}"
        );
    }

    #[test]
    fn a_torque_twists_the_screw_by_its_stiffness_behind_the_gap() {
        let (axis_model, screw) = soft(BACKLASH_RAD);
        let half_gap_rad = 0.5 * BACKLASH_RAD;
        for twist in [-1e-4, 0.0, 0.1, half_gap_rad * 0.999] {
            assert_eq!(
                axis_model.torque_nm(twist, 0.0) != 0.0,
                twist.abs() > half_gap_rad,
                "{twist}"
            );
        }
        let stiffness =
            screw.table_share * INERTIA_KG_M2 * screw.resonance_rad_s * screw.resonance_rad_s;
        let torque = axis_model.torque_nm(half_gap_rad + 1e-3, 0.0);
        assert!((torque - stiffness * 1e-3).abs() < 1e-9, "{torque}");
    }

    #[test]
    fn flanks_push_and_do_not_pull() {
        let (axis_model, _) = soft(BACKLASH_RAD);
        for speed in [-1e3, -1.0, 0.0, 1.0, 1e3] {
            assert!(
                axis_model.torque_nm(0.01, speed) >= 0.0
                    && axis_model.torque_nm(-0.01, speed) <= 0.0
            );
        }
    }
}
