//! The ball screw between motor and table: a spring that hardens, with backlash, and damping.
//!
//! ```text
//! e    = r theta - x                                               how far the nut is ahead of the table
//! q(e) = e + (sqrt((e - b)^2 + s^2) - sqrt((e + b)^2 + s^2)) / 2   what of it bends the screw
//! E    = k q^2 / 2 + k3 q^4 / 4
//! F    = dE/de + c (dq/de)^2 de/dt                                 force on the table; r F is the torque on the motor
//! ```
//!
//! r travel for a turn, m/rad; b half of the backlash, m; s the length over which a flank comes to
//! bear, m; k stiffness, N/m; k3 hardening, N/m^3; c damping, N s/m. Without backlash q = e.
//!
//! Source: Altintas, Verl, Brecher, Uriarte and Pritschow (2011), Machine tool feed drives, for
//! stiffness, backlash and their sizes; a spring with a cubic part as Duffing's (1918). That the
//! energy is a function of q makes the spring conservative whatever the backlash.

use serde::Serialize;

/// A ball screw and what it drives the table by.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct BallScrew {
    /// Travel for a radian of the motor, m.
    pub travel_m_rad: f64,
    /// Stiffness, N/m.
    pub stiffness_n_m: f64,
    /// Hardening, N/m^3.
    pub hardening_n_m3: f64,
    /// Damping, N s/m.
    pub damping_n_s_m: f64,
    /// Backlash from flank to flank, m.
    pub backlash_m: f64,
    /// Length over which a flank comes to bear, m.
    pub edge_m: f64,
}

/// Force of the screw on the table, and its derivatives.
pub(super) struct ScrewForce {
    /// N.
    pub(super) force_n: f64,
    /// Derivatives of the force: by the lead of the nut, N/m, and by its rate, N s/m.
    pub(super) slopes: [f64; 2],
}

impl BallScrew {
    /// Bending of the screw, m, and its first and second derivatives by the lead of the nut.
    fn bending(&self, lead_m: f64) -> [f64; 3] {
        if self.backlash_m <= 0.0 {
            return [lead_m, 1.0, 0.0];
        }
        let (half_m, edge2) = (0.5 * self.backlash_m, self.edge_m * self.edge_m);
        let root = |at_m: f64| (at_m * at_m + edge2).sqrt();
        let ([low, high], [low_root, high_root]) = (
            [lead_m - half_m, lead_m + half_m],
            [root(lead_m - half_m), root(lead_m + half_m)],
        );
        [
            lead_m + 0.5 * (low_root - high_root),
            1.0 + 0.5 * (low / low_root - high / high_root),
            0.5 * edge2
                * (1.0 / (low_root * low_root * low_root)
                    - 1.0 / (high_root * high_root * high_root)),
        ]
    }

    /// Force on the table where the nut is ahead of it by `lead_m`, and runs away from it at
    /// `rate_m_s`.
    pub(super) fn force(&self, lead_m: f64, rate_m_s: f64) -> ScrewForce {
        let [bending, first, second] = self.bending(lead_m);
        let square = bending * bending;
        let spring_n = bending * (self.stiffness_n_m + self.hardening_n_m3 * square);
        let stiffness = self.stiffness_n_m + 3.0 * self.hardening_n_m3 * square;
        let damping = self.damping_n_s_m * first;
        ScrewForce {
            force_n: spring_n * first + damping * first * rate_m_s,
            slopes: [
                stiffness * first * first + spring_n * second + 2.0 * damping * second * rate_m_s,
                damping * first,
            ],
        }
    }

    /// Returns the lead of the nut over the table at which the screw carries a load at rest, m.
    pub(super) fn lead_under(&self, load_n: f64) -> f64 {
        let (mut low_m, mut high_m) = (0.0, self.backlash_m + load_n.abs() / self.stiffness_n_m);
        for _ in 0..80 {
            let middle_m = 0.5 * (low_m + high_m);
            if self.force(middle_m, 0.0).force_n < load_n.abs() {
                low_m = middle_m;
            } else {
                high_m = middle_m;
            }
        }
        if load_n == 0.0 {
            0.0
        } else {
            high_m.copysign(load_n)
        }
    }

    /// Energy in the spring, J.
    pub(super) fn energy_j(&self, lead_m: f64) -> f64 {
        let square = self.bending(lead_m)[0].powi(2);
        0.5 * self.stiffness_n_m * square + 0.25 * self.hardening_n_m3 * square * square
    }

    /// Returns the power that the damping dissipates, W.
    pub(super) fn loss_w(&self, lead_m: f64, rate_m_s: f64) -> f64 {
        let rate_m_s = self.bending(lead_m)[1] * rate_m_s;
        self.damping_n_s_m * rate_m_s * rate_m_s
    }
}
