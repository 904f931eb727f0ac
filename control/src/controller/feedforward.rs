//! Velocity, acceleration and friction feedforward with the exact model of the machine.
//!
//! The loop takes position commands only, so the inverse dynamics go into the position command. In the servo period that
//! begins at m Ts the drive holds
//!
//! ```text
//! w_ref(m) = kp e(m) + kd (e(m) - e(m-1)) / Ts,   e = c - x
//! J dw/dt  = kv (w_ref - w) - B w - Fc tanh(w / w_s)
//! ```
//!
//! A tool that is on the reference r at m Ts and at (m+1) Ts has the mean speed w = (r(m+1) - r(m)) / Ts between them,
//! and the mean acceleration a, the change of the central differences (r(m+1) - r(m-1)) / 2 Ts over the period. The mean
//! of the equation of motion over the period, solved for w_ref, and the position loop, solved for e, give the command:
//!
//! ```text
//! w_ref(m) = g_v w + [ g_a J a + g_v B w + g_f Fc tanh(w / w_s) ] / kv
//! e(m)     = (w_ref(m) + kd e(m-1) / Ts) / (kp + kd / Ts)
//! c(m)     = r(m) + e(m)
//! ```
//!
//! with gains g of 1 for the exact model. The speed is taken half a period after the command because the command is
//! held: this is the zero-order hold's delay, compensated.
//!
//! Source: Masory (1986), "Improving contouring accuracy of NC/CNC systems with additional velocity feed forward loop";
//! friction as in Armstrong-Helouvry, Dupont and Canudas de Wit (1994), "A survey of models, analysis tools and
//! compensation methods for the control of machines with friction".
//!
//! Departures: the feedforward enters before the position loop instead of after it. The offset that it makes is mostly
//! along the path, 1 mm at 50 mm/s and 50 1/s.

use super::{Command, Controller, Measured, Schedule};
use crate::activation::tanh;
use crate::axis::Parameters;
use crate::window::Window;

/// Preview behind the command of the next servo period that the differences need, servo periods.
const DIFFERENCES: f64 = 3.0;
/// The safety layer knows the path as far as the preview goes, and the command leads by the lag of the loop: this many
/// lags leave room for a command that leads a slowing motion.
const PREVIEW_LAGS: f64 = 3.0;
/// Of the [`crate::window::PREVIEW_KNOTS`]; the others reach behind.
pub(super) const MAX_PREVIEW: f64 = 240.0;

/// Preview for a command that leads the path by the lag of a loop, servo periods.
pub fn preview(lag_s: f64, servo_s: f64) -> u32 {
    // A float that is too large, or not a number, saturates here.
    libm::ceil(PREVIEW_LAGS * lag_s / servo_s + DIFFERENCES).min(MAX_PREVIEW) as u32
}

/// How much of each part is fed forward; 1 is the exact model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gains {
    /// Of what grows with the speed.
    pub velocity: f64,
    /// Of what grows with the acceleration.
    pub acceleration: f64,
    /// Of the Coulomb friction.
    pub friction: f64,
}

impl Gains {
    /// The exact model.
    pub const EXACT: Self = Self { velocity: 1.0, acceleration: 1.0, friction: 1.0 };
}

/// Feedforward; keeps nothing between ticks.
#[derive(Debug, Clone)]
pub struct Feedforward<const N: usize> {
    axes: [Parameters; N],
    gains: Gains,
    preview: u32,
}

impl<const N: usize> Feedforward<N> {
    /// For a machine with these axes and a servo period of `servo_s`.
    pub fn new(axes: [Parameters; N], gains: Gains, servo_s: f64) -> Self {
        let lag_s = axes.iter().map(|axis| 1.0 / axis.kp_1_s + axis.inertia_kg_m2 / axis.kv_nm_s_per_rad);
        let preview = preview(lag_s.fold(0.0, f64::max), servo_s);
        Self { axes, gains, preview }
    }

    /// Reference speed of the speed loop, rad/s, that an axis needs to move at `speed_rad_s` and
    /// `acceleration_rad_s2`.
    fn reference_rad_s(&self, axis: &Parameters, speed_rad_s: f64, acceleration_rad_s2: f64) -> f64 {
        let Gains { velocity, acceleration, friction } = self.gains;
        let [sign] = tanh([speed_rad_s / axis.coulomb_smoothing_rad_s]);
        let torque_nm = acceleration * axis.inertia_kg_m2 * acceleration_rad_s2
            + velocity * axis.viscous_friction_nm_s * speed_rad_s
            + friction * axis.coulomb_friction_nm * sign;
        velocity * speed_rad_s + torque_nm / axis.kv_nm_s_per_rad
    }

    /// How far the command has to lead a reference over the servo period from its second point to its third, mm; the points are a
    /// period apart, and `last_mm` is by how much it led in the last period.
    pub(super) fn lead_mm(
        &self,
        [before, here, after, beyond]: [[f64; N]; 4],
        last_mm: [f64; N],
        servo_s: f64,
    ) -> [f64; N] {
        core::array::from_fn(|i| {
            let axis = &self.axes[i];
            let speed_mm_s = (after[i] - here[i]) / servo_s;
            let acceleration_mm_s2 = ((beyond[i] - here[i]) - (after[i] - before[i])) / (2.0 * servo_s * servo_s);
            let reference_rad_s =
                self.reference_rad_s(axis, axis.rad_per_mm * speed_mm_s, axis.rad_per_mm * acceleration_mm_s2);
            let derivative_1_s = axis.kd / servo_s;
            (reference_rad_s / axis.rad_per_mm + derivative_1_s * last_mm[i]) / (axis.kp_1_s + derivative_1_s)
        })
    }

    /// The part of the reference speed that makes up for Coulomb friction in the servo period that begins, mm/s.
    pub(super) fn friction_mm_s(&self, window: &Window<'_, N>) -> [f64; N] {
        let servo_s = window.servo_s();
        let [here, after] = [0.0, servo_s].map(|ahead_s| window.at(ahead_s).position_mm);
        core::array::from_fn(|i| {
            let axis = &self.axes[i];
            let speed_rad_s = axis.rad_per_mm * (after[i] - here[i]) / servo_s;
            let [sign] = tanh([speed_rad_s / axis.coulomb_smoothing_rad_s]);
            self.gains.friction * axis.coulomb_friction_nm * sign / (axis.kv_nm_s_per_rad * axis.rad_per_mm)
        })
    }
}

impl<const N: usize> Controller<N> for Feedforward<N> {
    fn schedule(&self) -> Schedule {
        Schedule { servo_periods: 1, preview: self.preview }
    }

    fn reset(&mut self) {}

    /// The offset of the next servo period; that of this one is already under way.
    fn command(&mut self, window: &Window<'_, N>, _: &Measured<N>) -> Command<N> {
        let servo_s = window.servo_s();
        let next_s = window.tau_s + window.feed_period_s;
        let reference =
            [-1.0, 0.0, 1.0, 2.0].map(|periods: f64| window.preview.at(next_s + periods * servo_s).position_mm);
        Command::straight(1.0, self.lead_mm(reference, window.offset_mm, servo_s))
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::contour_error::ContourError;
    use crate::vector::add_scaled;
    use crate::window::{Knot, KnotSource, Preview, Register};

    const SERVO_S: f64 = 0.001;

    /// 30 mm/s2 from rest along the first axis.
    struct Parabola;

    impl KnotSource<2> for Parabola {
        fn knot(&mut self, tau_s: f64) -> Knot<2> {
            let t_s = tau_s.max(0.0);
            Knot { position_mm: [15.0 * t_s * t_s, 0.0], tangent: [1.0, 0.0], feed_mm_s: 30.0 * t_s, cutting: true }
        }
    }

    /// The commands of a controller that decides in each servo period, does not measure, and is not held to any bound.
    pub(in super::super) fn commands(
        reference: &mut dyn KnotSource<2>,
        controller: &mut dyn Controller<2>,
        servo_s: f64,
        mut each: impl FnMut(usize, [f64; 2]),
    ) {
        let (mut register, mut preview) = (Register::default(), Preview::new(servo_s));
        let schedule = controller.schedule();
        assert_eq!(schedule.servo_periods, 1);
        let measured = Measured { position_mm: [0.0; 2], contour: ContourError::NONE };
        let mut offset_mm = [0.0; 2];
        for n in 0..1000 {
            let tau_s = n as f64 * servo_s;
            register.push(reference.knot(tau_s));
            preview.fill(reference, tau_s, f64::from(schedule.preview) * servo_s);
            let window = Window {
                register: &register,
                preview: &preview,
                tau_s,
                feed_period_s: servo_s,
                offset_mm,
                offset_mm_s: [0.0; 2],
            };
            each(n, add_scaled(window.now().position_mm, 1.0, offset_mm));
            offset_mm = controller.command(&window, &measured).offset_mm;
        }
    }

    /// An axis whose drive has no torque limit.
    pub(in super::super) fn axis(kd: f64, coulomb_friction_nm: f64) -> Parameters {
        Parameters {
            rad_per_mm: 0.6,
            kp_1_s: 50.0,
            kd,
            kv_nm_s_per_rad: 2.0,
            torque_limit_nm: f64::INFINITY,
            inertia_kg_m2: 0.01,
            viscous_friction_nm_s: 0.03,
            coulomb_friction_nm,
            coulomb_smoothing_rad_s: 0.05,
        }
    }

    /// Following error along the parabola at the end of a second, mm; the mechanics in steps of 1 us.
    fn error_mm(axis: &Parameters, gains: Gains) -> f64 {
        let mut controller = Feedforward::new([*axis; 2], gains, SERVO_S);
        let (mut angle_rad, mut speed_rad_s, mut last_rad) = (0.0, 0.0, 0.0);
        let step_s = 1e-3 * SERVO_S;
        commands(&mut Parabola, &mut controller, SERVO_S, |_, command_mm| {
            let error_rad = command_mm[0] * axis.rad_per_mm - angle_rad;
            let reference_rad_s = axis.kp_1_s * error_rad + axis.kd * (error_rad - last_rad) / SERVO_S;
            last_rad = error_rad;
            for _ in 0..1000 {
                let [sign] = tanh([speed_rad_s / axis.coulomb_smoothing_rad_s]);
                let load_nm = axis.viscous_friction_nm_s * speed_rad_s + axis.coulomb_friction_nm * sign;
                let torque_nm = axis.kv_nm_s_per_rad * (reference_rad_s - speed_rad_s);
                let change_rad_s = step_s * (torque_nm - load_nm) / axis.inertia_kg_m2;
                // Trapezoidal, so that the step adds no travel of its own.
                angle_rad += step_s * (speed_rad_s + 0.5 * change_rad_s);
                speed_rad_s += change_rad_s;
            }
        });
        Parabola.knot(1000.0 * SERVO_S).position_mm[0] - angle_rad / axis.rad_per_mm
    }

    #[test]
    fn a_linear_plant_follows_a_parabola_exactly() {
        for kd in [0.0, 0.02] {
            let missed_mm = error_mm(&axis(kd, 0.0), Gains::EXACT);
            assert!(missed_mm.abs() < 1e-6, "kd {kd}: {missed_mm} mm");
        }
    }

    #[test]
    fn coulomb_friction_at_speed_is_fed_forward_exactly() {
        let missed_mm = error_mm(&axis(0.0, 0.2), Gains::EXACT);
        assert!(missed_mm.abs() < 1e-6, "{missed_mm} mm");
        let without_mm = error_mm(&axis(0.0, 0.2), Gains { friction: 0.0, ..Gains::EXACT });
        let friction_mm = 0.2 / (2.0 * 50.0 * 0.6);
        assert!((without_mm - friction_mm).abs() < 1e-6, "{without_mm} mm");
    }

    #[test]
    fn without_any_gain_the_tool_lags_by_the_loop() {
        let off = Gains { velocity: 0.0, acceleration: 0.0, friction: 0.0 };
        // e = (w + (J a + B w) / kv) / kp, of the speed one lag of the loop, 2.5 % of the second, ago.
        let speed_mm_s = 30.0;
        let lag_mm = (speed_mm_s * 1.015 + 0.005 * 30.0) / 50.0;
        let missed_mm = error_mm(&axis(0.0, 0.0), off);
        assert!((missed_mm - lag_mm).abs() < 0.05 * lag_mm, "{missed_mm} mm, not {lag_mm} mm");
    }
}
