//! LuGre friction: bristles that bend before the surfaces slide.
//!
//! ```text
//! dz/dt = v - a(v) z,   a(v) = s0 |v| / g(v)
//! g(v)  = (Fc + (Fs - Fc) exp(-(v / vs)^2)) (1 + d sign v)
//! F     = s0 z + s1 exp(-(v / vs)^2) dz/dt + s2 v
//! ```
//!
//! z is the bending of the bristles, m or rad; s0 their stiffness, N/m or N m/rad; s1 their
//! damping, N s/m or N m s/rad; s2 the viscous friction; Fc and Fs the Coulomb and the break-away
//! level, N or N m; vs the Stribeck speed, m/s or rad/s; d the part by which friction is higher in
//! the positive direction and lower in the negative.
//!
//! Source: Canudas de Wit, Olsson, Astrom and Lischinsky (1995), A new model for control of systems
//! with friction, eqs. 1 to 4, with a damping s1 that goes with the speed as they propose so that
//! friction stays passive.

use serde::Serialize;

/// Friction of one part, in translation (m, N) or rotation (rad, N m).
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct LuGre {
    /// Stiffness of the bristles, N/m or N m/rad.
    pub stiffness: f64,
    /// Damping of the bristles, N s/m or N m s/rad.
    pub damping: f64,
    /// Viscous friction, N s/m or N m s/rad.
    pub viscous: f64,
    /// Coulomb level, N or N m; zero is viscous friction alone.
    pub coulomb: f64,
    /// Break-away level, N or N m.
    pub break_away: f64,
    /// Stribeck speed, m/s or rad/s.
    pub stribeck: f64,
    /// Part by which the levels are higher in the positive direction, and lower in the negative.
    pub asymmetry: f64,
}

/// Friction at a speed and a bending, and its derivatives.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Bristles {
    /// Friction, N or N m.
    pub(super) force: f64,
    /// dz/dt.
    pub(super) rate: f64,
    /// a(v), 1/s.
    decay: f64,
    /// Partial derivatives: of dz/dt by the speed, of the friction by the speed and by the bending.
    rate_by_speed: f64,
    force_by_speed: f64,
    force_by_bending: f64,
}

impl LuGre {
    /// Friction whose bristles bend by `bending` at the Coulomb level, with bristles damped by
    /// twice the root of stiffness times `mass`.
    pub fn new(coulomb: f64, stiction: f64, stribeck: f64, bending: f64, mass: f64) -> Self {
        let stiffness = coulomb / bending;
        let damping = 2.0 * (stiffness * mass).sqrt();
        Self {
            stiffness,
            damping,
            coulomb,
            break_away: stiction * coulomb,
            stribeck,
            ..Self::default()
        }
    }

    /// The level at which it breaks away in the direction of a sign, N or N m.
    pub fn breaks_away_at(&self, sign: f64) -> f64 {
        self.break_away * (1.0 + self.asymmetry * sign)
    }

    /// Bending at the end of a step by the trapezoidal rule, from the bending and its rate at the
    /// beginning.
    pub(super) fn bent(&self, bending: f64, rate: f64, speed: f64, half_s: f64) -> f64 {
        (bending + half_s * (rate + speed)) / (1.0 + half_s * self.decay(speed)[0])
    }

    /// a(v), its derivative, and the exponential in it.
    fn decay(&self, speed: f64) -> [f64; 3] {
        if self.coulomb <= 0.0 {
            return [0.0, 0.0, 1.0];
        }
        let ratio = speed / self.stribeck;
        let near = libm::exp(-ratio * ratio);
        let (sign, stribeck) = (speed.signum(), (self.break_away - self.coulomb) * near);
        let side = 1.0 + self.asymmetry * sign;
        let level = (self.coulomb + stribeck) * side;
        let slope = -2.0 * ratio / self.stribeck * stribeck * side;
        let decay = self.stiffness * speed.abs() / level;
        [
            decay,
            self.stiffness * sign / level - decay * slope / level,
            near,
        ]
    }

    /// Friction at a speed and a bending.
    pub(super) fn at(&self, speed: f64, bending: f64) -> Bristles {
        let [decay, slope, near] = self.decay(speed);
        if self.coulomb <= 0.0 {
            return Bristles {
                force: self.viscous * speed,
                force_by_speed: self.viscous,
                ..Bristles::default()
            };
        }
        let rate = speed - decay * bending;
        let damping = self.damping * near;
        let damping_slope = -2.0 * speed / (self.stribeck * self.stribeck) * damping;
        let rate_by_speed = 1.0 - slope * bending;
        Bristles {
            force: self.stiffness * bending + damping * rate + self.viscous * speed,
            rate,
            decay,
            rate_by_speed,
            force_by_speed: damping * rate_by_speed + damping_slope * rate + self.viscous,
            force_by_bending: self.stiffness - damping * decay,
        }
    }

    /// Energy in the bristles, J.
    pub(super) fn energy_j(&self, bending: f64) -> f64 {
        0.5 * self.stiffness * bending * bending
    }

    /// Returns the power that the friction dissipates, W.
    pub(super) fn loss_w(&self, speed: f64, bending: f64) -> f64 {
        let Bristles { force, rate, .. } = self.at(speed, bending);
        force * speed - self.stiffness * bending * rate
    }
}

impl Bristles {
    /// Returns the derivative of the friction at the end of a step by the speed there. The bending
    /// follows by the trapezoidal rule.
    pub(super) fn slope(&self, half_s: f64) -> f64 {
        self.force_by_speed
            + self.force_by_bending * half_s * self.rate_by_speed / (1.0 + half_s * self.decay)
    }
}
