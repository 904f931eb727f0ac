//! Velocity, acceleration and friction feedforward with the exact model of the machine.
//!
//! The drive takes position commands only, so the inverse dynamics go into the position command:
//! each axis leads the reference as [`crate::axis::inverse`] computes it, from the feedforward of
//! its drive, the integral of its speed loop, its delays, its torque filter and its friction. The
//! feedforward of the drive is not applied twice. Cogging and ripple of the motor are not known
//! here.
//!
//! For an axis with only a position loop, a P speed loop and smoothed Coulomb friction:
//!
//! ```text
//! w_ref(m) = g_v w + [ g_a J a + g_v B w + g_f Fc tanh(w / w_s) ] / kv
//! e(m)     = (w_ref(m) + kd e(m-1) / Ts) / (kp + kd / Ts)
//! c(m)     = r(m) + e(m)
//! ```
//!
//! with gains g of 1 for the exact model, w the mean speed of the reference over the servo period
//! that begins at m Ts, and a its mean acceleration. The speed is taken half a period after the
//! command because the command is held: this is the zero-order hold's delay, compensated.
//!
//! Source: Masory (1986), "Improving contouring accuracy of NC/CNC systems with additional velocity
//! feed forward loop"; friction as in Armstrong-Helouvry, Dupont and Canudas de Wit (1994), "A
//! survey of models, analysis tools and compensation methods for the control of machines with
//! friction".
//!
//! Departures: the feedforward enters before the position loop instead of after it. The resulting
//! offset is mostly along the path, 1 mm at 50 mm/s and 50 1/s.

use super::row::{ControllerData, ControllerRow, Knows, Member, Parameter, Values};
use super::{Controller, Schedule};
use crate::axis::inverse::{AxisInverse, Gains};
use crate::command::{Command, Measured};
use crate::window::Window;

/// Preview beyond the command of the next servo period that the differences need, servo periods.
const DIFFERENCES: f64 = 3.0;
/// Preview in lags of the loop. The supervisor knows the path only within the preview, and the
/// command leads by the lag of the loop: three lags leave room for a command that leads a slowing
/// motion.
const PREVIEW_LAGS: f64 = 3.0;
/// Largest preview, out of the `PREVIEW_KNOTS`; the others reach behind.
pub const MAX_PREVIEW: f64 = 240.0;
/// Number of periods for which friction is kept for an observer: the longest delays of a machine
/// file, 20 ms each way, at a servo period of 1 ms.
const KEPT_PERIODS: usize = 48;

/// Share of the velocity feedforward.
pub const VELOCITY_GAIN: Parameter = Parameter::number(
    "velocity_gain",
    Gains::EXACT.velocity,
    [0.0, 10.0],
    Some([0.1, 1.5]),
    EXACT_REASON,
)
.of_unit(SHARES);
/// Share of the acceleration feedforward.
pub const ACCELERATION_GAIN: Parameter = Parameter::number(
    "acceleration_gain",
    Gains::EXACT.acceleration,
    [0.0, 10.0],
    Some([0.0, 2.0]),
    EXACT_REASON,
)
.of_unit(SHARES);
/// Share of the friction feedforward.
pub const FRICTION_GAIN: Parameter = Parameter::number(
    "friction_gain",
    Gains::EXACT.friction,
    [0.0, 10.0],
    Some([0.0, 4.0]),
    EXACT_REASON,
)
.of_unit(SHARES);
const SHARES: &str = "times the feedforward of the exact model";
const EXACT_REASON: &str =
    "1 is what the exact model calls for; another makes up for a model that is not exact";

impl<const N: usize> Member<N> for Feedforward<N> {
    const ROW: ControllerRow = ControllerRow {
        name: "feedforward",
        knows: Knows::ExactModel,
        identifier: None,
        parameters: &[VELOCITY_GAIN, ACCELERATION_GAIN, FRICTION_GAIN],
    };

    fn make(data: &ControllerData<'_, N>, values: Values<'_>) -> Option<Self> {
        let gains = Gains {
            velocity: values(&VELOCITY_GAIN),
            acceleration: values(&ACCELERATION_GAIN),
            friction: values(&FRICTION_GAIN),
        };
        Some(Self::new(*data.inverse?, [gains; N]))
    }
}

/// Returns the preview for a command that leads the path by the lag of a loop, servo periods.
pub fn preview(lag_s: f64, servo_s: f64) -> u32 {
    // The cast saturates where the float is too large or NaN.
    libm::ceil(PREVIEW_LAGS * lag_s / servo_s + DIFFERENCES).min(MAX_PREVIEW) as u32
}

/// Feedforward.
#[derive(Debug, Clone)]
pub struct Feedforward<const N: usize> {
    axes: [AxisInverse; N],
    gains: [Gains; N],
    preview: u32,
    /// Friction that was compensated in the last periods, the newest first, mm/s of reference
    /// speed.
    friction_mm_s: [[f64; N]; KEPT_PERIODS],
}

impl<const N: usize> Feedforward<N> {
    /// Creates the feedforward of these axes with these shares of each part.
    pub fn new(axes: [AxisInverse; N], gains: [Gains; N]) -> Self {
        let most = |of: fn(&AxisInverse) -> f64| axes.iter().map(of).fold(0.0, f64::max);
        let servo_s = axes
            .iter()
            .map(|axis| axis.axis_model().periods.servo_s)
            .fold(f64::INFINITY, f64::min);
        let late = libm::ceil(most(|axis| axis.command_delay_s() + axis.ahead_s()) / servo_s)
            .min(MAX_PREVIEW);
        // The cast saturates to zero where the float is NaN.
        let preview =
            (preview(most(AxisInverse::lag_s), servo_s) + late as u32).min(MAX_PREVIEW as u32);
        Self {
            axes,
            gains,
            preview,
            friction_mm_s: [[0.0; N]; KEPT_PERIODS],
        }
    }

    /// Returns the required lead of a servo period's command over a reference, mm. Call it once per
    /// servo period. `at_mm` gives the reference at a time after the start of the period, s.
    /// `last_mm` is the lead in the last period. `load_mm_s` is a load, as a reference speed, mm/s.
    pub fn lead_mm(
        &mut self,
        at_mm: impl Fn(f64) -> [f64; N],
        last_mm: [f64; N],
        load_mm_s: [f64; N],
    ) -> [f64; N] {
        let gains = self.gains;
        let mut lead_mm = [0.0; N];
        let axes = self
            .axes
            .iter_mut()
            .zip(gains)
            .zip(last_mm)
            .zip(load_mm_s)
            .zip(&mut lead_mm)
            .enumerate();
        for (i, ((((axis, gains), last_mm), load_mm_s), lead_mm)) in axes {
            // Every axis has its reference. `get` avoids a panic that the linker could not remove.
            let at_mm = |after_s| at_mm(after_s).get(i).copied().unwrap_or_default();
            *lead_mm = axis.lead_mm(gains, at_mm, last_mm, load_mm_s);
        }
        let newest_mm_s = self.axes.each_ref().map(AxisInverse::friction_mm_s);
        self.friction_mm_s.copy_within(..KEPT_PERIODS - 1, 1);
        let [newest, ..] = &mut self.friction_mm_s;
        *newest = newest_mm_s;
        lead_mm
    }

    /// Returns the lead of the next servo period on the path, against a load, mm/s of reference
    /// speed.
    pub fn command_against(&mut self, window: &Window<'_, N>, load_mm_s: [f64; N]) -> Command<N> {
        let next_s = window.tau_s + window.feed_period_s;
        let at_mm = |after_s: f64| window.preview.at(next_s + after_s).position_mm;
        Command::straight(1.0, self.lead_mm(at_mm, window.offset_mm, load_mm_s))
    }

    /// Returns the part of the reference speed that compensates Coulomb friction in the servo
    /// period that began at the position measured now, mm/s.
    pub fn friction_mm_s(&self) -> [f64; N] {
        core::array::from_fn(|i| {
            let axis = &self.axes[i];
            // The cast saturates to zero where the float is NaN.
            let age = libm::round(axis.late_s() / axis.axis_model().periods.servo_s) as usize;
            let of_axes = self
                .friction_mm_s
                .get(age.min(KEPT_PERIODS - 1))
                .unwrap_or(&[0.0; N]);
            of_axes[i]
        })
    }
}

impl<const N: usize> Controller<N> for Feedforward<N> {
    fn schedule(&self) -> Schedule {
        Schedule {
            servo_periods: 1,
            preview: self.preview,
        }
    }

    fn reset(&mut self) {
        self.axes.iter_mut().for_each(AxisInverse::reset);
        self.friction_mm_s = [[0.0; N]; KEPT_PERIODS];
    }

    /// Returns the offset of the next servo period. The offset of the current period is already
    /// being executed.
    fn command(&mut self, window: &Window<'_, N>, _: &Measured<N>) -> Command<N> {
        self.command_against(window, [0.0; N])
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::activation::tanh;
    use crate::axis::{AxisModel, Parameters, Periods};
    use crate::contour_error::ContourError;
    use crate::vector::add_scaled;
    use crate::window::{Knot, KnotSource, Preview, Register};

    const SERVO_S: f64 = 0.001;

    /// 30 mm/s2 from rest along the first axis.
    struct Parabola;

    impl KnotSource<2> for Parabola {
        fn knot(&mut self, tau_s: f64) -> Knot<2> {
            let t_s = tau_s.max(0.0);
            Knot {
                position_mm: [15.0 * t_s * t_s, 0.0],
                tangent: [1.0, 0.0],
                feed_mm_s: 30.0 * t_s,
                cutting: true,
            }
        }
    }

    /// The commands of a controller that decides in each servo period, does not measure, and is not
    /// held to any bound.
    fn commands(
        reference: &mut dyn KnotSource<2>,
        controller: &mut dyn Controller<2>,
        servo_s: f64,
        mut each: impl FnMut(usize, [f64; 2]),
    ) {
        let (mut register, mut preview) = (Register::default(), Preview::new(servo_s));
        let schedule = controller.schedule();
        assert_eq!(schedule.servo_periods, 1);
        let measured = Measured {
            position_mm: [0.0; 2],
            contour: ContourError::NONE,
        };
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
            ..Parameters::NOTHING
        }
    }

    /// An axis that is nothing beside, whose mechanics period is a thousandth of the servo period.
    fn inverse(axis: Parameters) -> AxisInverse {
        let periods = Periods {
            servo_s: SERVO_S,
            mechanics_s: 1e-3 * SERVO_S,
            mechanics_per_servo: 1000,
        };
        AxisInverse::new(AxisModel::new(axis, periods))
    }

    /// Following error along the parabola at the end of a second, mm; the mechanics in steps of 1
    /// us.
    fn error_mm(axis: &Parameters, gains: Gains) -> f64 {
        let mut controller = Feedforward::new([inverse(*axis); 2], [gains; 2]);
        let (mut angle_rad, mut speed_rad_s, mut last_rad) = (0.0, 0.0, 0.0);
        let step_s = 1e-3 * SERVO_S;
        commands(&mut Parabola, &mut controller, SERVO_S, |_, command_mm| {
            let error_rad = command_mm[0] * axis.rad_per_mm - angle_rad;
            let reference_rad_s =
                axis.kp_1_s * error_rad + axis.kd * (error_rad - last_rad) / SERVO_S;
            last_rad = error_rad;
            for _ in 0..1000 {
                let [sign] = tanh([speed_rad_s / axis.coulomb_smoothing_rad_s]);
                let load_nm =
                    axis.viscous_friction_nm_s * speed_rad_s + axis.coulomb_friction_nm * sign;
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
        let without_mm = error_mm(
            &axis(0.0, 0.2),
            Gains {
                friction: 0.0,
                ..Gains::EXACT
            },
        );
        let friction_mm = 0.2 / (2.0 * 50.0 * 0.6);
        assert!((without_mm - friction_mm).abs() < 1e-6, "{without_mm} mm");
    }

    #[test]
    fn without_any_gain_the_tool_lags_by_the_loop() {
        let off = Gains {
            velocity: 0.0,
            acceleration: 0.0,
            friction: 0.0,
        };
        // e = (w + (J a + B w) / kv) / kp, of the speed one lag of the loop, 2.5 % of the second,
        // ago.
        let speed_mm_s = 30.0;
        let lag_mm = (speed_mm_s * 1.015 + 0.005 * 30.0) / 50.0;
        let missed_mm = error_mm(&axis(0.0, 0.0), off);
        assert!(
            (missed_mm - lag_mm).abs() < 0.05 * lag_mm,
            "{missed_mm} mm, not {lag_mm} mm"
        );
    }
}
