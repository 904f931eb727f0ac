//! Inverse model of an axis: computes the lead of the position command that keeps the axis on a
//! motion.
//!
//! The command of the servo period that begins at m Ts is c(m) = r(m) + o(m). It sets the reference
//! speed and the torque that act for one period from m Ts + d on; d is the delay of the drive. A
//! motor that is on the reference r at both ends of that time has the mean speed
//! w = (r(m+1) - r(m)) / Ts. Its mean acceleration a follows from the change of the central
//! differences (r(m+1) - r(m-1)) / 2 Ts. Both are evaluated d later. At the end of each mechanics
//! period the speed loop acts on the speed at the start of the period, so it sees w - a (dt + l),
//! where l is the delay with which the drive sees the speed. With o = 0 the loops do not supply
//! these parts:
//!
//! ```text
//! M_w = g_v (w - kp (r - y) - kd (r - y)' - fv r') - g_a a (dt + l)   reference speed
//! M_t = [ g_a (J a - B a dt - fa J r'') + g_v B w + g_f F + L ] / Kv
//!                                                                   torque, as a reference speed
//! ```
//!
//! y is the reference r one measurement delay ago, a prime is a backward difference over Ts, F is
//! the mean friction along the motion, and L is a known load. i is the integral of the speed loop.
//! The mean of the speed loop over the period gives the lead:
//!
//! ```text
//! s      = kp o + (kd + fv) (o - o1) / Ts - M_w            reference speed beyond the required one
//! M_t    = s + i + s (Ts + dt) / 2 Ti + fa J (o - 2 o1 + o2) / (Kv Ts^2)
//! i'     = i + s Ts / Ti
//! ```
//!
//! The equations are linear in o; o1 and o2 are the leads one and two periods before. The recursion
//! is stable. Its poles are the poles of the derivative and the feedforward of the position loop,
//! and 1 - Ts / Ti. For a P speed loop without any further part it is
//! `o = (M_w + M_t + kd o1 / Ts) / (kp + kd / Ts)`. The torque filter delays the torque by its time
//! constant, so accelerations and friction are evaluated ahead by this time.
//!
//! The linear parts superpose: the leads for velocity alone and for friction alone, each with its
//! own integral, sum to the lead for both.
//!
//! Where commands reach the position loop n servo periods late ([`super::delays`]), c(m) = r(m +
//! n) + o(m + n): the same lead, over the reference n servo periods ahead.
//!
//! Symbols: r reference, o lead, mm; J inertia; B viscous friction; Kv, Ti speed loop; fv, fa
//! feedforward of the drive; g gains of the parts, where 1 is full compensation; the others as in
//! [`super`] and [`super::drive`].
//!
//! Source: Masory (1986), "Improving contouring accuracy of NC/CNC systems with additional velocity
//! feed forward loop", for the inverse of the loop; friction stepped along the reference as in
//! Armstrong-Hélouvry, Dupont and Canudas de Wit (1994), "A survey of models, analysis tools and
//! compensation methods for the control of machines with friction".
//!
//! Departures: the torque limit bounds only the integral, and the speed limit bounds nothing here.
//! The inverse assumes that no motion needs more.

use super::friction::FrictionModel;
use super::{AxisModel, Parameters};
use crate::activation::tanh;
use crate::vector::bounded;

/// Steps in a servo period along which friction with a memory is computed: at 0.1 ms the breakaway
/// over 10 um at 50 mm/s is two steps.
const FRICTION_STEPS: u32 = 10;

/// Shares of the parts that are fed forward; 1 is the exact model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gains {
    /// Share of the part that grows with the speed.
    pub velocity: f64,
    /// Share of the part that grows with the acceleration.
    pub acceleration: f64,
    /// Share of the Coulomb friction.
    pub friction: f64,
}

impl Gains {
    /// Full compensation by the model.
    pub const EXACT: Self = Self {
        velocity: 1.0,
        acceleration: 1.0,
        friction: 1.0,
    };
    /// No compensation: the axis keeps its lag.
    pub const NONE: Self = Self {
        velocity: 0.0,
        acceleration: 0.0,
        friction: 0.0,
    };
}

/// Reference speed and torque that the axis needs and its loops do not supply, mm/s of reference
/// speed.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Missing {
    speed_mm_s: f64,
    torque_mm_s: f64,
}

/// Mean speed and mean acceleration of the reference over a servo period.
#[derive(Debug, Clone, Copy)]
struct ReferenceMotion {
    speed_mm_s: f64,
    acceleration_mm_s2: f64,
}

/// Inverse of an axis, with its state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisInverse {
    axis_model: AxisModel,
    /// Friction in addition to smoothed Coulomb friction.
    friction: Option<FrictionModel>,
    /// Delay of the torque filter, s.
    filter_lag_s: f64,
    /// Delay with which the drive sees the speed, s.
    speed_late_s: f64,
    /// Friction of the presliding spring, N m.
    presliding_nm: f64,
    /// Friction that the last lead compensates, mm/s of reference speed.
    friction_mm_s: f64,
    /// Integral of the speed loop, mm/s of reference speed, before the last computed period, and
    /// the part that the loops did not supply in that period.
    integral_mm_s: f64,
    missing: Missing,
    /// Lead of the period before the last one.
    lead_before_mm: f64,
}

impl AxisInverse {
    /// Creates the inverse of an axis.
    pub fn new(axis_model: AxisModel) -> Self {
        let AxisModel {
            parameters,
            periods,
            ..
        } = &axis_model;
        Self {
            friction: FrictionModel::if_present(&axis_model),
            filter_lag_s: parameters.filter_lag_s(periods.mechanics_s),
            speed_late_s: parameters.speed_late_s(periods.mechanics_s),
            axis_model,
            presliding_nm: 0.0,
            friction_mm_s: 0.0,
            integral_mm_s: 0.0,
            missing: Missing::default(),
            lead_before_mm: 0.0,
        }
    }

    /// Inverts another model from now on. Its state stays.
    pub fn follow(&mut self, axis_model: AxisModel) {
        let Self {
            friction,
            filter_lag_s,
            speed_late_s,
            ..
        } = Self::new(axis_model);
        self.axis_model = axis_model;
        (self.friction, self.filter_lag_s, self.speed_late_s) =
            (friction, filter_lag_s, speed_late_s);
    }

    /// Returns the model that it inverts.
    pub fn axis_model(&self) -> &AxisModel {
        &self.axis_model
    }

    /// Resets the state to rest.
    pub fn reset(&mut self) {
        (self.presliding_nm, self.friction_mm_s, self.integral_mm_s) = (0.0, 0.0, 0.0);
        (self.missing, self.lead_before_mm) = (Missing::default(), 0.0);
    }

    /// Returns the sum of the time constants of the position loop and the speed loop, s. The
    /// command leads the reference by about this time.
    pub fn lag_s(&self) -> f64 {
        let parameters = &self.axis_model.parameters;
        1.0 / parameters.kp_1_s + parameters.inertia_kg_m2 / parameters.kv_nm_s_per_rad
    }

    /// Returns the time from the arrival of a command at the position loop to the motion that the
    /// inverse evaluates, s, without the differences.
    pub fn ahead_s(&self) -> f64 {
        self.axis_model.parameters.drive_delay_s + self.filter_lag_s
    }

    /// Returns the delay until the position loop has a command, s.
    pub fn command_delay_s(&self) -> f64 {
        let servo_s = self.axis_model.periods.servo_s;
        self.axis_model.parameters.command_periods(servo_s) as f64 * servo_s
    }

    /// Returns the time from a measured position to the action of the friction that was compensated
    /// for it, s.
    pub fn late_s(&self) -> f64 {
        self.command_delay_s() + self.ahead_s() + self.axis_model.parameters.measurement_delay_s
    }

    /// Returns the friction that the last lead compensates, mm/s of reference speed.
    pub fn friction_mm_s(&self) -> f64 {
        self.friction_mm_s
    }

    /// Returns the required lead of a servo period's command over the reference, mm. Call it once
    /// per servo period. `at_mm` gives the reference at a time after the start of the period, s.
    /// `last_mm` is the actual lead of the command in the period before. `load_mm_s` is a load that
    /// the drive carries in addition, as a reference speed, mm/s.
    #[inline]
    pub fn lead_mm(
        &mut self,
        gains: Gains,
        at_mm: impl Fn(f64) -> f64,
        last_mm: f64,
        load_mm_s: f64,
    ) -> f64 {
        let (late_s, servo_s) = (self.command_delay_s(), self.axis_model.periods.servo_s);
        if late_s == 0.0 {
            return self.prompt_lead_mm(gains, at_mm, last_mm, load_mm_s);
        }
        // Travel of the reference until the position loop has the command: it grows with the speed.
        let moves_mm = |from_s: f64| gains.velocity * (at_mm(from_s + late_s) - at_mm(from_s));
        let last_mm = last_mm - moves_mm(-servo_s);
        let lead_mm =
            self.prompt_lead_mm(gains, |after_s| at_mm(after_s + late_s), last_mm, load_mm_s);
        lead_mm + moves_mm(0.0)
    }

    /// Computes [`Self::lead_mm`] over the reference at the time at which the position loop has the
    /// command.
    #[inline]
    fn prompt_lead_mm(
        &mut self,
        gains: Gains,
        at_mm: impl Fn(f64) -> f64,
        last_mm: f64,
        load_mm_s: f64,
    ) -> f64 {
        let servo_s = self.axis_model.periods.servo_s;
        self.take_in(last_mm);
        let own = self.without_lead(&at_mm);
        let missing = self.missing(gains, &at_mm, own, load_mm_s);
        self.missing = missing;
        let parameters = &self.axis_model.parameters;
        let change_1_s =
            (parameters.kd + self.axis_model.parameters.velocity_feedforward) / servo_s;
        let torque_1_s = self.torque_for_lead_1_s();
        let [within, _] = integral_gains(&self.axis_model);
        let needed_mm_s = missing.torque_mm_s - self.integral_mm_s
            + (1.0 + within) * (missing.speed_mm_s + change_1_s * last_mm)
            + torque_1_s * (2.0 * last_mm - self.lead_before_mm);
        self.lead_before_mm = last_mm;
        needed_mm_s / ((1.0 + within) * (parameters.kp_1_s + change_1_s) + torque_1_s)
    }

    /// Returns the reference speed, mm/s, with which the speed loop follows the motion in the
    /// period in which that reference acts. The period begins at 0 of `at_mm`. Integral and
    /// presliding friction at its start are known, N m.
    pub fn reference_mm_s(
        &mut self,
        at_mm: impl Fn(f64) -> f64,
        [integral_nm, presliding_nm]: [f64; 2],
        load_mm_s: f64,
    ) -> f64 {
        self.presliding_nm = presliding_nm;
        let Missing {
            speed_mm_s,
            torque_mm_s,
        } = self.missing(Gains::EXACT, &at_mm, [0.0; 2], load_mm_s);
        let [within, _] = integral_gains(&self.axis_model);
        let parameters = &self.axis_model.parameters;
        let integral_mm_s = integral_nm / (parameters.kv_nm_s_per_rad * parameters.rad_per_mm);
        speed_mm_s + (torque_mm_s - integral_mm_s) / (1.0 + within)
    }

    /// Updates the integral for the last computed period, with the lead that the command really
    /// had.
    #[inline]
    fn take_in(&mut self, last_mm: f64) {
        let [_, over] = integral_gains(&self.axis_model);
        if over > 0.0 {
            let parameters = &self.axis_model.parameters;
            let change_1_s =
                (parameters.kd + parameters.velocity_feedforward) / self.axis_model.periods.servo_s;
            let asked_mm_s =
                parameters.kp_1_s * last_mm + change_1_s * (last_mm - self.lead_before_mm);
            let limit =
                parameters.torque_limit_nm / (parameters.kv_nm_s_per_rad * parameters.rad_per_mm);
            let integral_mm_s = self.integral_mm_s + over * (asked_mm_s - self.missing.speed_mm_s);
            self.integral_mm_s = bounded(integral_mm_s, -limit, limit);
        }
    }

    /// Returns the torque of the drive's acceleration feedforward for a second difference of the
    /// lead, as a reference speed, 1/s.
    #[inline]
    fn torque_for_lead_1_s(&self) -> f64 {
        let (parameters, servo_s) = (&self.axis_model.parameters, self.axis_model.periods.servo_s);
        let nm_s2 = self.axis_model.parameters.acceleration_feedforward * parameters.inertia_kg_m2;
        nm_s2 / (parameters.kv_nm_s_per_rad * servo_s * servo_s)
    }

    #[inline]
    fn missing(
        &mut self,
        gains: Gains,
        at_mm: &impl Fn(f64) -> f64,
        [asked_mm_s, fed_nm_s]: [f64; 2],
        load_mm_s: f64,
    ) -> Missing {
        let (parameters, mechanics_s) = (
            self.axis_model.parameters,
            self.axis_model.periods.mechanics_s,
        );
        let turning = self.motion(at_mm, self.axis_model.parameters.drive_delay_s);
        let torque = if self.filter_lag_s > 0.0 {
            self.motion(at_mm, self.ahead_s())
        } else {
            turning
        };
        let late_s = mechanics_s + self.speed_late_s;
        let early_mm_s = gains.acceleration * late_s * turning.acceleration_mm_s2;
        let inertia_kg_m2 =
            parameters.inertia_kg_m2 - parameters.viscous_friction_nm_s * mechanics_s;
        self.friction_mm_s = gains.friction * self.friction_nm(torque)
            / (parameters.kv_nm_s_per_rad * parameters.rad_per_mm);
        let linear = gains.acceleration * (inertia_kg_m2 * torque.acceleration_mm_s2 - fed_nm_s)
            + gains.velocity * parameters.viscous_friction_nm_s * torque.speed_mm_s;
        Missing {
            speed_mm_s: gains.velocity * (turning.speed_mm_s - asked_mm_s) - early_mm_s,
            torque_mm_s: linear / parameters.kv_nm_s_per_rad + self.friction_mm_s + load_mm_s,
        }
    }

    #[inline]
    fn motion(&self, at_mm: &impl Fn(f64) -> f64, after_s: f64) -> ReferenceMotion {
        let servo_s = self.axis_model.periods.servo_s;
        let [before, here, after, beyond] =
            [-1.0, 0.0, 1.0, 2.0].map(|n: f64| at_mm(after_s + n * servo_s));
        ReferenceMotion {
            speed_mm_s: (after - here) / servo_s,
            acceleration_mm_s2: ((beyond - here) - (after - before)) / (2.0 * servo_s * servo_s),
        }
    }

    /// Returns the requests of the loops where the command equals the reference: reference speed,
    /// mm/s, and torque for a rad/mm, N m s.
    #[inline]
    fn without_lead(&self, at_mm: &impl Fn(f64) -> f64) -> [f64; 2] {
        let servo_s = self.axis_model.periods.servo_s;
        let Parameters {
            velocity_feedforward,
            acceleration_feedforward,
            ..
        } = self.axis_model.parameters;
        let late_s = self.axis_model.parameters.measurement_delay_s;
        let (mut asked_mm_s, mut fed_nm_s) = (0.0, 0.0);
        if late_s > 0.0 {
            let [here_mm, before_mm] =
                [0.0, -servo_s].map(|after_s| at_mm(after_s) - at_mm(after_s - late_s));
            asked_mm_s += self.axis_model.parameters.kp_1_s * here_mm
                + self.axis_model.parameters.kd * (here_mm - before_mm) / servo_s;
        }
        if velocity_feedforward > 0.0 || acceleration_feedforward > 0.0 {
            let [here, before, earlier] = [0.0, -1.0, -2.0].map(|n: f64| at_mm(n * servo_s));
            let (now_mm, last_mm) = (here - before, before - earlier);
            asked_mm_s += velocity_feedforward * now_mm / servo_s;
            let inertia_kg_m2 = acceleration_feedforward * self.axis_model.parameters.inertia_kg_m2;
            fed_nm_s = inertia_kg_m2 * (now_mm - last_mm) / (servo_s * servo_s);
        }
        [asked_mm_s, fed_nm_s]
    }

    /// Returns the mean of the friction without its viscous part over a servo period of the motion,
    /// N m.
    #[inline]
    fn friction_nm(&mut self, motion: ReferenceMotion) -> f64 {
        let (parameters, servo_s) = (&self.axis_model.parameters, self.axis_model.periods.servo_s);
        let speed_rad_s = parameters.rad_per_mm * motion.speed_mm_s;
        let Some(friction) = &self.friction else {
            let [sign] = tanh([speed_rad_s / parameters.coulomb_smoothing_rad_s]);
            return parameters.coulomb_friction_nm * sign;
        };
        let acceleration_rad_s2 = parameters.rad_per_mm * motion.acceleration_mm_s2;
        let step_s = servo_s / f64::from(FRICTION_STEPS);
        let mut sum_nm = 0.0;
        for step in 0..FRICTION_STEPS {
            let from_middle_s = (f64::from(step) + 0.5) * step_s - 0.5 * servo_s;
            let at_rad_s = speed_rad_s + acceleration_rad_s2 * from_middle_s;
            sum_nm += friction.along_nm(at_rad_s, step_s, &mut self.presliding_nm);
        }
        sum_nm / f64::from(FRICTION_STEPS)
    }
}

/// Returns the gains of the integral of a speed loop for a speed error that lasts for a servo period:
/// its mean within the period and its value at the end.
#[inline]
pub(crate) fn integral_gains(axis_model: &AxisModel) -> [f64; 2] {
    let (time_s, periods) = (axis_model.parameters.speed_integral_s, &axis_model.periods);
    if time_s > 0.0 {
        [
            0.5 * (periods.servo_s + periods.mechanics_s) / time_s,
            periods.servo_s / time_s,
        ]
    } else {
        [0.0; 2]
    }
}
