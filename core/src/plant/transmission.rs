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
//! with J_m + J_t = J, the inertia of the machine file, so that the rigid axis is the limit of a stiff screw. Friction and
//! disturbance act on the table: guideways and cutter are there. The resonance that the file names is that of the table
//! while the servo holds the motor, k = J_t (2 pi f)^2, which is what a knock on the table shows; free, the two
//! swing against each other at f sqrt(J / J_m).
//!
//! Source: two-mass drive as in Altintas (2012), Manufacturing Automation, section 5; backlash as a dead zone with damping
//! in contact, Nordin and Gutman (2002), eq. 4.

use std::f64::consts::TAU;

use crate::machine::{Axis, Transmission};

/// The coupling of motor and table of one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Coupling {
    pub(super) inverse_motor_inertia: f64,
    pub(super) inverse_table_inertia: f64,
    stiffness_nm_rad: f64,
    damping_nm_s: f64,
    half_gap_rad: f64,
}

impl Coupling {
    pub(super) fn new(axis: &Axis, transmission: &Transmission) -> Self {
        let table = axis.inertia_kg_m2 * transmission.table_share;
        let resonance_rad_s = TAU * transmission.resonance_hz;
        Self {
            inverse_motor_inertia: 1.0 / (axis.inertia_kg_m2 - table),
            inverse_table_inertia: 1.0 / table,
            stiffness_nm_rad: table * resonance_rad_s * resonance_rad_s,
            damping_nm_s: 2.0 * transmission.damping_ratio * table * resonance_rad_s,
            half_gap_rad: 0.5 * transmission.backlash_um * 1e-3 * TAU / axis.lead_mm_per_rev,
        }
    }

    /// The torque from motor to table, N m.
    #[inline]
    pub(super) fn torque_nm(&self, twist_rad: f64, twist_rad_s: f64) -> f64 {
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
    use super::*;
    use crate::machine::Machine;

    const DT_S: f64 = 1e-5;

    fn soft(backlash_um: f64) -> (Coupling, Transmission, f64) {
        let machine = Machine::load("soft".as_ref()).unwrap();
        let axis = machine.axes[0];
        let transmission = Transmission { backlash_um, ..axis.transmission.unwrap() };
        (Coupling::new(&axis, &transmission), transmission, axis.lead_mm_per_rev)
    }

    /// The table swings against the held motor: angle over time from a twist of a milliradian.
    fn ring_down(coupling: &Coupling, seconds: f64) -> Vec<f64> {
        let (mut angle, mut speed) = (1e-3, 0.0);
        let steps = (seconds / DT_S) as usize;
        (0..steps)
            .map(|_| {
                speed += DT_S * coupling.inverse_table_inertia * coupling.torque_nm(-angle, -speed);
                angle += DT_S * speed;
                angle
            })
            .collect()
    }

    #[test]
    fn the_table_rings_at_the_frequency_and_with_the_damping_of_the_file() {
        let (coupling, transmission, _) = soft(0.0);
        let angle = ring_down(&coupling, 0.5);
        let upward: Vec<usize> = (1..angle.len()).filter(|&i| angle[i - 1] < 0.0 && angle[i] >= 0.0).collect();
        let periods = upward.len() - 1;
        let period_s = (upward[periods] - upward[0]) as f64 * DT_S / periods as f64;
        let damped_hz = transmission.resonance_hz * (1.0 - transmission.damping_ratio.powi(2)).sqrt();
        assert!((1.0 / period_s - damped_hz).abs() < 0.01 * damped_hz, "{} Hz", 1.0 / period_s);
        // Logarithmic decrement, from peak to peak: 2 pi zeta / sqrt(1 - zeta^2). At zero twist the flanks part: while
        // they pull they are let go, which costs the least bit of damping.
        let peak = |from: usize, to: usize| angle[from..to].iter().fold(0.0_f64, |a, b| a.max(*b));
        let decrement = (peak(upward[0], upward[1]) / peak(upward[5], upward[6])).ln() / 5.0;
        let expected = TAU * transmission.damping_ratio / (1.0 - transmission.damping_ratio.powi(2)).sqrt();
        assert!((decrement - expected).abs() < 0.1 * expected, "{decrement} {expected}");
    }

    #[test]
    fn a_torque_twists_the_screw_by_its_stiffness_behind_the_gap() {
        let (coupling, transmission, lead_mm) = soft(5.0);
        let half_gap_rad = 0.5 * 5e-3 * TAU / lead_mm;
        for twist in [-1e-4, 0.0, 1e-3, half_gap_rad * 0.999] {
            let held = coupling.torque_nm(twist, 0.0);
            assert_eq!(held != 0.0, twist.abs() > half_gap_rad, "{twist}");
        }
        let stiffness = (TAU * transmission.resonance_hz).powi(2) / coupling.inverse_table_inertia;
        let torque = coupling.torque_nm(half_gap_rad + 1e-3, 0.0);
        assert!((torque - stiffness * 1e-3).abs() < 1e-9, "{torque}");
    }

    #[test]
    fn flanks_push_and_do_not_pull() {
        let (coupling, ..) = soft(5.0);
        for speed in [-1e3, -1.0, 0.0, 1.0, 1e3] {
            assert!(coupling.torque_nm(0.01, speed) >= 0.0 && coupling.torque_nm(-0.01, speed) <= 0.0);
        }
    }
}
