//! Parts of a servo drive in addition to the P speed loop: an integral part, feedforward, a speed
//! limit, a torque filter, a window of the speed.
//!
//! ```text
//! w_ref = Kp e + Kd (e - e_prev) / Ts + fv v                    position loop, once a servo period Ts
//! u_ff  = fa J (v - v_prev) / Ts,   v = (c - c_prev) / Ts       beside it, from the command's differences
//! s     = w_ref within -W, W;   d = s - w'
//! w'   += dt / (dt + L) (w - w'),   L = (T - dt) / 2            the speed as the drive sees it
//! I    += Kv d dt / Ti                                          once a mechanics period dt
//! u     = Kv d + I + u_ff within -Tmax, Tmax                    PI speed loop
//! y    += (1 - exp(-2 pi f dt)) (u - y)                         torque filter: y reaches the motor
//! ```
//!
//! Anti-windup by clamping: where u is at its limit and d pushes it further, I stays as it is. Both
//! w_ref and u_ff go from the control to the drive, as velocity offset and torque offset do. A part
//! whose parameter is zero is absent.
//!
//! Symbols: c command at the motor, rad; fv, fa shares of the nominal feedforward, 1 is the full
//! feedforward; W speed limit, rad/s; Ti integral time, s; f corner of the filter, Hz; T window of
//! the speed, s; the others as in [`super`].
//!
//! A drive that computes the speed from positions, (x(t) - x(t - T)) / T, sees its mean over the
//! window, late by L. A first-order lag with the same delay replaces the mean, which would need one
//! position for every mechanics period of the window. A speed with constant acceleration appears
//! the same in both.
//!
//! Source: PI loop and clamping as in Åström and Hägglund (2006), Advanced PID Control, sections
//! 3.2 and 3.5; feedforward as in Altintas (2012), Manufacturing Automation, section 5; offsets as
//! in IEC 61800-7-201 (CiA 402), objects 60B1h and 60B2h; the filter is the exact step of a
//! first-order lag under a held input, Franklin, Powell and Workman (1998), section 4.3.

use core::f64::consts::TAU;

use super::numbers::Part;
use super::{AxisModel, AxisState, Parameters, within};

impl Parameters {
    /// Returns the delay with which the speed loop sees the speed, s.
    pub fn speed_late_s(&self, mechanics_s: f64) -> f64 {
        (0.5 * (self.speed_window_s - mechanics_s)).max(0.0)
    }

    /// Returns the delay that the torque filter adds to a slow change of the torque, s; 0 without a
    /// filter. It follows from y' - y = k (u - y), which gives u = y + (1/k - 1) (y' - y).
    pub fn filter_lag_s(&self, mechanics_s: f64) -> f64 {
        let part = filter_part(self.torque_filter_hz, mechanics_s);
        mechanics_s * (1.0 / part - 1.0)
    }
}

/// Returns the gain of the torque filter, k: the share of the step to a new torque that it makes in
/// one mechanics period. It is 1, which is no filter, unless the corner frequency is above 0.
fn filter_part(corner_hz: f64, mechanics_s: f64) -> f64 {
    if corner_hz > 0.0 {
        1.0 - libm::exp(-TAU * corner_hz * mechanics_s)
    } else {
        1.0
    }
}

/// Reference from the position loop to the drive.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DriveReference {
    /// Reference speed, rad/s.
    pub speed_rad_s: f64,
    /// Torque offset that the drive adds to the output of its speed loop, N m.
    pub torque_nm: f64,
}

/// State of a drive, including the values that the control keeps for it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DriveState {
    /// The last command, rad; none before the first.
    commanded_rad: Option<f64>,
    /// Speed of the last command, rad/s. Before the first command it is the speed at which the axis
    /// starts, and the first command leaves it unchanged.
    commanded_rad_s: f64,
    /// Integral part of the speed loop, N m.
    integral_nm: f64,
    /// Torque after the filter, N m.
    filtered_nm: f64,
    /// Speed as the drive sees it, rad/s, where it is late; `None` before the first value.
    seen_rad_s: Option<f64>,
}

impl DriveState {
    /// State before the first command.
    pub const AT_REST: Self = Self {
        commanded_rad: None,
        commanded_rad_s: 0.0,
        integral_nm: 0.0,
        filtered_nm: 0.0,
        seen_rad_s: None,
    };

    /// Returns the integral part of the speed loop, N m.
    pub fn integral_nm(&self) -> f64 {
        self.integral_nm
    }

    /// Returns the torque after the filter, N m.
    pub fn filtered_nm(&self) -> f64 {
        self.filtered_nm
    }

    /// Adds the corrections of an observer to integral and filter, N m.
    pub fn correct(&mut self, integral_nm: f64, filtered_nm: f64) {
        self.integral_nm += integral_nm;
        self.filtered_nm += filtered_nm;
    }
}

/// A drive, ready to be integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveModel {
    velocity_feedforward: f64,
    speed_limit_rad_s: f64,
    /// True for a P speed loop without any further part.
    plain: bool,
    /// Torque of the acceleration feedforward for a difference of speeds, N m s/rad.
    torque_for_change: f64,
    /// Integral for an error of the speed over one mechanics period, N m s/rad.
    integral_gain: f64,
    /// Share of the step to a new torque that the filter makes in one mechanics period.
    filter: f64,
    /// The same share for the speed as the drive sees it; `None` where it sees the speed itself.
    seeing: Option<f64>,
}

impl DriveModel {
    /// Creates the drive of an axis. The filter is the exact step over a mechanics period.
    pub fn new(axis_model: &AxisModel) -> Self {
        let dt_s = axis_model.periods.mechanics_s;
        let Parameters {
            kv_nm_s_per_rad: gain,
            inertia_kg_m2,
            speed_integral_s: time_s,
            velocity_feedforward,
            acceleration_feedforward,
            torque_filter_hz,
            speed_limit_rad_s,
            ..
        } = axis_model.parameters;
        let late_s = axis_model.parameters.speed_late_s(dt_s);
        Self {
            velocity_feedforward,
            speed_limit_rad_s,
            plain: !axis_model.parameters.has(Part::Drive),
            torque_for_change: acceleration_feedforward * inertia_kg_m2
                / axis_model.periods.servo_s,
            integral_gain: if time_s > 0.0 {
                gain * dt_s / time_s
            } else {
                0.0
            },
            filter: filter_part(torque_filter_hz, dt_s),
            seeing: (late_s > 0.0).then(|| dt_s / (dt_s + late_s)),
        }
    }

    /// Returns state and reference of the drive after a long motion at a constant speed that needs
    /// this torque.
    pub fn moving(
        &self,
        axis_model: &AxisModel,
        speed_rad_s: f64,
        torque_nm: f64,
    ) -> (DriveState, DriveReference) {
        let integrates = self.integral_gain > 0.0;
        let integral_nm = if integrates { torque_nm } else { 0.0 };
        let missing_rad_s = (torque_nm - integral_nm) / axis_model.parameters.kv_nm_s_per_rad;
        let state = DriveState {
            commanded_rad_s: speed_rad_s,
            integral_nm,
            filtered_nm: torque_nm,
            ..DriveState::AT_REST
        };
        (
            state,
            DriveReference {
                speed_rad_s: speed_rad_s + missing_rad_s,
                torque_nm: 0.0,
            },
        )
    }

    /// Passes a command and the position, rad, to the position loop with its feedforward. Returns
    /// the reference for the drive.
    #[inline]
    pub fn position_loop(
        &self,
        axis_model: &AxisModel,
        command_rad: f64,
        position_rad: f64,
        axis: &mut AxisState,
        state: &mut DriveState,
    ) -> DriveReference {
        let speed_rad_s = axis_model.position_loop(command_rad - position_rad, axis);
        if self.plain {
            return DriveReference {
                speed_rad_s,
                torque_nm: 0.0,
            };
        }
        let since = |before_rad: f64| (command_rad - before_rad) / axis_model.periods.servo_s;
        let commanded_rad_s = state.commanded_rad.map_or(state.commanded_rad_s, since);
        let change_rad_s = commanded_rad_s - state.commanded_rad_s;
        (state.commanded_rad, state.commanded_rad_s) = (Some(command_rad), commanded_rad_s);
        DriveReference {
            speed_rad_s: speed_rad_s + self.velocity_feedforward * commanded_rad_s,
            torque_nm: self.torque_for_change * change_rad_s,
        }
    }

    /// Computes one mechanics period of the speed loop at a speed of the motor. Returns the torque
    /// that reaches the motor, N m. NaN stays NaN.
    #[inline]
    pub fn torque_nm(
        &self,
        axis_model: &AxisModel,
        reference: DriveReference,
        speed_rad_s: f64,
        state: &mut DriveState,
    ) -> f64 {
        if self.plain {
            axis_model.torque_nm(reference.speed_rad_s, speed_rad_s)
        } else {
            self.regulated_nm(axis_model, reference, speed_rad_s, state)
        }
    }

    /// Computes [`Self::torque_nm`] for a drive that is more than a P speed loop.
    fn regulated_nm(
        &self,
        axis_model: &AxisModel,
        reference: DriveReference,
        speed_rad_s: f64,
        state: &mut DriveState,
    ) -> f64 {
        let most_rad_s = self.speed_limit_rad_s;
        let wanted_rad_s = if most_rad_s > 0.0 {
            within(reference.speed_rad_s, most_rad_s)
        } else {
            reference.speed_rad_s
        };
        let error_rad_s = wanted_rad_s - self.seen_rad_s(speed_rad_s, state);
        let proportional_nm =
            axis_model.parameters.kv_nm_s_per_rad * error_rad_s + reference.torque_nm;
        let limit_nm = axis_model.parameters.torque_limit_nm;
        let integral_nm = state.integral_nm + self.integral_gain * error_rad_s;
        let sum_nm = proportional_nm + integral_nm;
        if !(sum_nm.abs() > limit_nm && sum_nm * error_rad_s > 0.0) {
            state.integral_nm = integral_nm;
        }
        let limited_nm = within(proportional_nm + state.integral_nm, limit_nm);
        state.filtered_nm += self.filter * (limited_nm - state.filtered_nm);
        state.filtered_nm
    }

    /// Returns the speed as the drive sees it.
    #[inline]
    fn seen_rad_s(&self, speed_rad_s: f64, state: &mut DriveState) -> f64 {
        let Some(part) = self.seeing else {
            return speed_rad_s;
        };
        let seen_rad_s = state.seen_rad_s.map_or(speed_rad_s, |seen_rad_s| {
            seen_rad_s + part * (speed_rad_s - seen_rad_s)
        });
        state.seen_rad_s = Some(seen_rad_s);
        seen_rad_s
    }
}

#[cfg(test)]
mod tests {
    use super::super::Periods;
    use super::*;

    fn axis_model(change: impl FnOnce(&mut Parameters)) -> AxisModel {
        let mut parameters = Parameters {
            rad_per_mm: 0.6,
            kp_1_s: 50.0,
            kd: 0.0,
            kv_nm_s_per_rad: 2.0,
            torque_limit_nm: 30.0,
            inertia_kg_m2: 0.01,
            viscous_friction_nm_s: 0.0,
            coulomb_friction_nm: 0.0,
            coulomb_smoothing_rad_s: 0.5,
            ..Parameters::NOTHING
        };
        change(&mut parameters);
        AxisModel::new(
            parameters,
            Periods {
                servo_s: 0.001,
                mechanics_s: 1e-6,
                mechanics_per_servo: 1000,
            },
        )
    }

    /// Speed after a step of the reference by 1 rad/s, under a constant load.
    fn speed_rad_s(change: fn(&mut Parameters), load_nm: f64, time_s: f64) -> f64 {
        let axis_model = axis_model(change);
        let drive = DriveModel::new(&axis_model);
        let (mut axis, mut state) = (AxisState::default(), DriveState::default());
        for _ in 0..libm::round(time_s / axis_model.periods.mechanics_s) as u64 {
            let reference = DriveReference {
                speed_rad_s: 1.0,
                torque_nm: 0.0,
            };
            let torque_nm = drive.torque_nm(&axis_model, reference, axis.speed_rad_s, &mut state);
            axis_model.accelerate(torque_nm - load_nm, &mut axis);
        }
        axis.speed_rad_s
    }

    #[test]
    fn a_pi_loop_answers_a_step_as_its_differential_equation_does() {
        // J w'' + Kv w' + Kv / Ti w = Kv / Ti + Kv step': with J 0.01, Kv 2, Ti 20 ms: poles (s +
        // 100)^2, numerator 200 s + 1e4, so w = 1 - e^(-100 t) (1 - 100 t); a constant load L adds
        // -L / J t e^(-100 t).
        let pi = |axis: &mut Parameters| axis.speed_integral_s = 0.02;
        for time_s in [0.003, 0.01, 0.02, 0.05] {
            let decay = libm::exp(-100.0 * time_s);
            let free = 1.0 - decay * (1.0 - 100.0 * time_s);
            assert!(
                (speed_rad_s(pi, 0.0, time_s) - free).abs() < 1e-4,
                "{time_s}"
            );
            let loaded = free - 0.5 / 0.01 * time_s * decay;
            assert!(
                (speed_rad_s(pi, 0.5, time_s) - loaded).abs() < 2e-4,
                "{time_s}"
            );
        }
        // Without the integral the load is left: L / Kv.
        assert!((speed_rad_s(|_| {}, 0.5, 0.2) - 0.75).abs() < 1e-6);
    }

    #[test]
    fn the_integral_does_not_wind_up_at_the_torque_limit() {
        let axis_model = axis_model(|axis| axis.speed_integral_s = 0.02);
        let drive = DriveModel::new(&axis_model);
        let mut state = DriveState::default();
        let asked = |speed_rad_s| DriveReference {
            speed_rad_s,
            torque_nm: 0.0,
        };
        // 1 s against a stop: unlimited, the integral would come to 2 * 100 / 0.02 = 10,000 N m.
        (0..1_000_000).for_each(|_| {
            assert_eq!(
                drive.torque_nm(&axis_model, asked(100.0), 0.0, &mut state),
                30.0
            );
        });
        assert!(state.integral_nm.abs() <= 30.0, "{}", state.integral_nm);
        assert!(
            drive.torque_nm(&axis_model, asked(-20.0), 0.0, &mut state) < 0.0,
            "the torque turns with the error"
        );
        assert!(
            drive
                .torque_nm(&axis_model, asked(f64::NAN), 0.0, &mut state)
                .is_nan()
        );
    }

    #[test]
    fn the_filter_is_a_lag_of_first_order() {
        let axis_model = axis_model(|axis| axis.torque_filter_hz = 200.0);
        let drive = DriveModel::new(&axis_model);
        let mut state = DriveState::default();
        let reference = DriveReference {
            speed_rad_s: 1.0,
            torque_nm: 0.0,
        };
        for step in 1..=5000_u32 {
            let torque_nm = drive.torque_nm(&axis_model, reference, 0.0, &mut state);
            let wanted_nm = 2.0 * (1.0 - libm::exp(-TAU * 200.0 * f64::from(step) * 1e-6));
            assert!((torque_nm - wanted_nm).abs() < 1e-9, "{step}");
        }
    }

    #[test]
    fn feedforward_is_the_commands_speed_and_the_torque_for_its_acceleration() {
        let axis_model = axis_model(|axis| {
            (axis.velocity_feedforward, axis.acceleration_feedforward) = (0.9, 0.5);
        });
        let drive = DriveModel::new(&axis_model);
        let (mut axis, mut state) = (AxisState::default(), DriveState::default());
        // c = a t^2 / 2 with a = 40 rad/s^2: at t = n Ts the backward difference is a (n - 1/2) Ts.
        for n in 0..100_u32 {
            let t_s = f64::from(n) * 1e-3;
            let command_rad = 20.0 * t_s * t_s;
            let reference =
                drive.position_loop(&axis_model, command_rad, command_rad, &mut axis, &mut state);
            if n > 1 {
                assert!(
                    (reference.speed_rad_s - 0.9 * 40.0 * (t_s - 0.5e-3)).abs() < 1e-9,
                    "{n}"
                );
                assert!(
                    (reference.torque_nm - 0.5 * 0.01 * 40.0).abs() < 1e-9,
                    "{n}"
                );
            }
        }
    }

    #[test]
    fn a_speed_that_grows_evenly_is_seen_late_by_half_the_window() {
        let axis_model = axis_model(|axis| axis.speed_window_s = 0.003);
        let drive = DriveModel::new(&axis_model);
        let mut state = DriveState::default();
        let (at_rest, dt_s) = (DriveReference::default(), axis_model.periods.mechanics_s);
        let mut torque_nm = 0.0;
        for n in 0..30_000_u32 {
            torque_nm = drive.torque_nm(
                &axis_model,
                at_rest,
                -(3.0 + 100.0 * dt_s * f64::from(n)),
                &mut state,
            );
        }
        let late_s = (3.0 + 100.0 * dt_s * 29_999.0 - 0.5 * torque_nm) / 100.0;
        assert!((late_s - 0.5 * (0.003 - dt_s)).abs() < 1e-9, "{late_s}");
        let (moving, _) = drive.moving(&axis_model, 3.0, 0.0);
        assert_eq!(
            drive.torque_nm(&axis_model, at_rest, 3.0, &mut { moving }),
            -6.0,
            "it has gone at that speed for long"
        );
    }

    #[test]
    fn the_reference_keeps_to_the_speed_limit() {
        let limited = |axis: &mut Parameters| axis.speed_limit_rad_s = 0.6;
        assert!((speed_rad_s(limited, 0.0, 0.2) - 0.6).abs() < 1e-9);
    }

    #[test]
    fn what_is_all_zero_is_the_plain_loop_to_the_bit() {
        let axis_model = axis_model(|_| {});
        let drive = DriveModel::new(&axis_model);
        let mut state = DriveState::default();
        for speed_rad_s in [0.1, -3.0, 100.0] {
            let reference = DriveReference {
                speed_rad_s,
                torque_nm: 0.0,
            };
            let torque_nm = drive.torque_nm(&axis_model, reference, 0.3, &mut state);
            assert_eq!(
                torque_nm.to_bits(),
                axis_model.torque_nm(speed_rad_s, 0.3).to_bits()
            );
        }
    }

    #[test]
    fn a_drive_that_has_moved_for_long_goes_on_as_it_is() {
        let plain = axis_model(|_| {});
        let with_parts = plain.with(|axis| {
            (axis.speed_integral_s, axis.torque_filter_hz) = (0.01, 400.0);
            axis.velocity_feedforward = 0.9;
        });
        for axis_model in [plain, with_parts] {
            let drive = DriveModel::new(&axis_model);
            let (mut state, sent) = drive.moving(&axis_model, 30.0, 0.4);
            for _ in 0..10_000 {
                assert!((drive.torque_nm(&axis_model, sent, 30.0, &mut state) - 0.4).abs() < 1e-9);
            }
            // Its first command is one of that speed.
            let (mut axis, mut first) = (AxisState::default(), state);
            let reference = drive.position_loop(&axis_model, 0.6, 0.6, &mut axis, &mut first);
            assert_eq!(
                reference.speed_rad_s,
                30.0 * axis_model.parameters.velocity_feedforward
            );
        }
    }
}
