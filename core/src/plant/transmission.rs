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

/// The joint of one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Joint {
    pub(super) inverse_motor_inertia: f64,
    pub(super) inverse_table_inertia: f64,
    stiffness_nm_rad: f64,
    damping_nm_s: f64,
    half_gap_rad: f64,
}

impl Joint {
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
