//! Position of the motor that holds the table on the reference with a compliant ball screw.
//!
//! ```text
//! x_m = r + <T / k + b/2 sgn T>         T = J_t r'' + B r' + Fc sgn r'       torque through the screw; its sign is the flank in contact
//! ```
//!
//! The motor cannot leap from flank to flank where T changes sign, nor twist the screw at once
//! where the plan's acceleration steps: <> is the mean over the time W to both sides, with weights
//! of a triangle, so that the motion across the backlash b has the acceleration b / W^2 in both
//! halves. W is the time in which a part of the drive's torque is enough for that, and at least the
//! time of a radian of the resonance. The damping of the screw is left out: it adds c/k times the
//! speed of the twist, next to nothing.
//!
//! Symbols: r reference, k stiffness, J_t inertia of the table, B viscous and Fc Coulomb friction,
//! both at the table.
//!
//! Source: the flexible joint is flat in its load's position, Spong (1987), "Modeling and control
//! of elastic joint robots", J. Dynamic Systems, Measurement, and Control 109; backlash as in
//! [`crate::axis::transmission`].

use crate::activation::tanh;
use crate::axis::AxisModel;
use crate::axis::transmission::TransmissionModel;
use crate::vector::bounded;

/// Part of the torque limit that the motion across the backlash may take.
const CROSSING_TORQUE: f64 = 0.25;
/// Shortest and longest W, s.
const CROSSING_S: [f64; 2] = [0.001, 0.01];
/// Number of points of the triangle to each side of its middle.
const POINTS: i32 = 3;
/// Part of the Coulomb friction below which the torque through the screw has no clear sign.
const UNCLEAR: f64 = 0.2;
/// The same limit in parts of the backlash, where there is no friction.
const UNCLEAR_GAP: f64 = 0.01;

/// The twist of a ball screw along a reference.
#[derive(Debug, Clone, Copy)]
pub(super) struct ScrewTwist {
    step_s: f64,
    /// J_t / k, s^2; B / k, s; Fc / k, mm.
    inertia_s2: f64,
    viscous_s: f64,
    coulomb_mm: f64,
    smoothing_s_mm: f64,
    half_gap_mm: f64,
    crossing_s: f64,
    /// J_t / Kv, s: factor of the acceleration of the motor beyond the table's, which takes no
    /// torque.
    table_s: f64,
}

impl ScrewTwist {
    /// Creates the twist of an axis with this screw.
    pub(super) fn new(axis_model: &AxisModel, screw: &TransmissionModel) -> Self {
        let axis = axis_model.parameters;
        let table_kg_m2 = 1.0 / screw.inverse_table_inertia;
        let half_gap_mm = screw.half_gap_rad / axis.rad_per_mm;
        let crossing_mm_s2 =
            CROSSING_TORQUE * axis.torque_limit_nm / (axis.inertia_kg_m2 * axis.rad_per_mm);
        let crossing_s =
            libm::sqrt(2.0 * half_gap_mm / crossing_mm_s2).max(1.0 / screw.resonance_rad_s);
        Self {
            step_s: axis_model.periods.servo_s,
            inertia_s2: table_kg_m2 / screw.stiffness_nm_rad,
            viscous_s: axis.viscous_friction_nm_s / screw.stiffness_nm_rad,
            coulomb_mm: axis.coulomb_friction_nm / (screw.stiffness_nm_rad * axis.rad_per_mm),
            smoothing_s_mm: axis.rad_per_mm / axis.coulomb_smoothing_rad_s,
            half_gap_mm,
            crossing_s: bounded(crossing_s, CROSSING_S[0], CROSSING_S[1]),
            table_s: table_kg_m2 / axis.kv_nm_s_per_rad,
        }
    }

    /// Returns the time that it looks ahead, s.
    pub(super) fn ahead_s(&self) -> f64 {
        self.crossing_s + self.step_s
    }

    /// Returns the lead of the motor over the table at a time from now, mm.
    pub(super) fn mm(&self, at_mm: &impl Fn(f64) -> f64, after_s: f64) -> f64 {
        // Without friction, a sign is clear beyond a part of the backlash.
        let unclear_mm =
            (UNCLEAR * self.coulomb_mm + UNCLEAR_GAP * self.half_gap_mm).max(f64::MIN_POSITIVE);
        let (mut sum_mm, mut weights) = (0.0, 0.0);
        for point in -POINTS..=POINTS {
            let weight = f64::from(POINTS + 1 - point.abs());
            let at_s = after_s + self.crossing_s * f64::from(point) / f64::from(POINTS + 1);
            let elastic_mm = self.elastic_mm(at_mm, at_s);
            sum_mm += weight
                * (elastic_mm + self.half_gap_mm * bounded(elastic_mm / unclear_mm, -1.0, 1.0));
            weights += weight;
        }
        sum_mm / weights
    }

    /// Returns T / k.
    fn elastic_mm(&self, at_mm: &impl Fn(f64) -> f64, after_s: f64) -> f64 {
        let [before, here, after] = [-1.0, 0.0, 1.0].map(|n: f64| at_mm(after_s + n * self.step_s));
        let speed_mm_s = (after - before) / (2.0 * self.step_s);
        let acceleration_mm_s2 = ((after - here) - (here - before)) / (self.step_s * self.step_s);
        let [sign] = tanh([speed_mm_s * self.smoothing_s_mm]);
        self.inertia_s2 * acceleration_mm_s2 + self.viscous_s * speed_mm_s + self.coulomb_mm * sign
    }

    /// Returns the twist over the servo periods around a time.
    pub(super) fn course(&self, at_mm: &impl Fn(f64) -> f64, moment_s: f64) -> TwistCourse {
        let from_s = moment_s - self.step_s;
        let at = |n: usize| self.mm(at_mm, from_s + n as f64 * self.step_s);
        TwistCourse {
            from_s,
            step_s: self.step_s,
            table_s: self.table_s,
            twists_mm: core::array::from_fn(at),
        }
    }
}

/// Number of known twists, one a servo period: the first is before the time of the course.
const COURSE: usize = 5;

/// The twist of a ball screw over some servo periods.
#[derive(Debug, Clone, Copy)]
pub(super) struct TwistCourse {
    from_s: f64,
    step_s: f64,
    table_s: f64,
    twists_mm: [f64; COURSE],
}

impl TwistCourse {
    /// Twist of a rigid screw.
    pub(super) const NONE: Self = Self {
        from_s: 0.0,
        step_s: 1.0,
        table_s: 0.0,
        twists_mm: [0.0; COURSE],
    };

    /// Returns the twist at a time from now, mm.
    pub(super) fn mm(&self, after_s: f64) -> f64 {
        let place = bounded(
            (after_s - self.from_s) / self.step_s,
            0.0,
            (COURSE - 1) as f64,
        );
        // The cast saturates to zero where the float is NaN.
        let before = (libm::floor(place + 1e-6) as usize).min(COURSE - 2);
        let [a, b] = [before, before + 1].map(|n| self.twists_mm.get(n).copied().unwrap_or(0.0));
        a + (place - before as f64) * (b - a)
    }

    /// Returns the excess of the inverse for a motor whose acceleration differs from its table's,
    /// mm/s of reference speed: the inverse assigns all of the inertia to the motor. It uses the
    /// differences of the inverse.
    pub(super) fn spared_mm_s(&self) -> f64 {
        let [before, here, after, beyond, _] = self.twists_mm;
        self.table_s * ((beyond - here) - (after - before)) / (2.0 * self.step_s * self.step_s)
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use crate::axis::mechanics::{MechanicsModel, MechanicsState};
    use crate::axis::{Parameters, Periods};
    use crate::controller::feedforward;

    fn axis_model(backlash_rad: f64) -> AxisModel {
        let parameters = Parameters {
            torque_limit_nm: 30.0,
            table_share: 0.5,
            resonance_rad_s: 380.0,
            damping_ratio: 0.02,
            backlash_rad,
            ..feedforward::tests::axis(0.0, 0.2)
        };
        AxisModel::new(
            parameters,
            Periods {
                servo_s: 0.001,
                mechanics_s: 1e-5,
                mechanics_per_servo: 100,
            },
        )
    }

    /// A sine of 5 mm and 8 rad/s.
    fn reference_mm(time_s: f64) -> f64 {
        5.0 * libm::sin(8.0 * time_s)
    }

    #[test]
    fn a_motor_that_is_held_where_it_is_said_to_be_has_its_table_on_the_reference() {
        for backlash_rad in [0.0, 0.003] {
            let axis_model = axis_model(backlash_rad);
            let mechanics = MechanicsModel::new(&axis_model);
            let twist = ScrewTwist::new(
                &axis_model,
                mechanics.transmission().expect("it is not rigid"),
            );
            let mut state = MechanicsState::default();
            let (mut with_um, mut without_um) = (0.0_f64, 0.0_f64);
            let rad_per_mm = axis_model.parameters.rad_per_mm;
            let motor_mm = |at_s: f64| {
                reference_mm(at_s) + twist.mm(&|after_s| reference_mm(at_s + after_s), 0.0)
            };
            state.table.speed_rad_s = 40.0 * rad_per_mm;
            for step in 0..200_000 {
                let at_s = f64::from(step) * 1e-5;
                state.motor.angle_rad = motor_mm(at_s) * rad_per_mm;
                state.motor.speed_rad_s =
                    (motor_mm(at_s + 1e-5) - motor_mm(at_s)) * 1e5 * rad_per_mm;
                mechanics.advance(&mut state, 0.0, 0.0);
                if at_s > 0.5 {
                    let next_mm = reference_mm(at_s + 1e-5);
                    with_um =
                        with_um.max(1e3 * (state.table.angle_rad / rad_per_mm - next_mm).abs());
                    without_um = without_um.max(1e3 * (motor_mm(at_s) - reference_mm(at_s)).abs());
                }
            }
            std::eprintln!("{backlash_rad}: {with_um} um, without {without_um} um");
            // The flank changes in 4 ms, while a table at rest does not move: what is left is what
            // the reference does in that time.
            assert!(
                with_um < 0.5 * without_um,
                "{backlash_rad}: {with_um} um, without {without_um} um"
            );
        }
    }
}
