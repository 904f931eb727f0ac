//! Feedforward, and an observer of each axis that estimates the disturbance that the nominal servo
//! does not explain and removes it from the command. Controllers with a constant-gain observer
//! share this part. They differ in how the gains are found.
//!
//! A sampled axis under the reference speed u, the friction f that the feedforward compensates, an
//! unknown d that acts as a reference speed, and the measured position y:
//!
//! ```text
//! x(k+1) = x + gamma w + delta (u - f + d)     w(k+1) = alpha w + beta (u - f + d)     d(k+1) = d
//! u(k)   = kp e(k) + kd (e(k) - e(k-1)) / Ts,   e = c - y
//! ```
//!
//! is observed by `xi(k+1) = A xi + B (u - f) + L (y - x)`, and the feedforward also carries d: the
//! command of the axis is less by `d / (kp + kd / Ts)`. The estimate is limited to the authority of
//! the drive: beyond it, the unexplained part is the torque limit, not a disturbance.
//!
//! u includes the other functions of a drive: its own feedforward, the time until u acts and y
//! arrives, and the integral of its speed loop. This integral needs no estimate, since the integral
//! of the speed is the position:
//!
//! ```text
//! u_act(k) = u(k - n) + i(k) + Ts (u(k - n) - w) / 2 Ti     i(k) = i(k-1) + (Ts u(k-1-n) - (y(k) - y(k-1))) / Ti
//! ```
//!
//! with n the delays of drive and encoder in servo periods; between whole ones, the mean of both,
//! weighted. So position, speed and disturbance are as late as the encoder. The torque filter is
//! left out.
//!
//! Symbols: x position, mm; w speed, u reference speed, f friction and d disturbance as reference
//! speeds, mm/s; c command, mm; Ts servo period, s.
//!
//! Source: Johnson (1971), "Accommodation of external disturbances in linear regulator and
//! servomechanism problems".
//!
//! Departures: the drive takes positions, so that the estimate acts through the position loop and
//! not as a torque.
use feedwright_control::Window;
use feedwright_control::vector::{add_scaled, bounded, norm};
use feedwright_control::{Command, CommandQueue, Controller, Feedforward, Measured, Schedule};

use super::zero_phase::SampledAxis;

/// Longest delay that is kept, servo periods: 20 ms each way, the most of a machine file, at 1 ms.
const KEPT_PERIODS: usize = 48;

/// Functions of a drive beside a P speed loop; all zero means none.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct ObservedDrive {
    /// Part of the command's speed that it feeds forward.
    pub velocity_feedforward: f64,
    /// Reference speed that is worth the torque which it feeds forward for a second difference of
    /// the command, 1/s.
    pub torque_1_s: f64,
    /// Integral time of the speed loop, s.
    pub speed_integral_s: f64,
    /// Delays of drive and encoder together, s.
    pub delay_s: f64,
    /// Servo periods from a command until the position loop has it.
    pub command_periods: usize,
}

/// Parameters of the observer of one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ObservedAxis {
    /// Axis model between two servo periods.
    pub axis: SampledAxis,
    /// Functions of the drive beside a P speed loop.
    pub drive: ObservedDrive,
    /// Largest disturbance estimate that is accepted, mm/s: the largest that the drive can
    /// compensate.
    pub limit_mm_s: f64,
    /// Observer gains L: correction of position, speed and disturbance per unit of position
    /// innovation; 1, 1/s, 1/s.
    pub gains: [f64; 3],
}

/// Reference that leaves for a drive, mm/s: reference speed, and torque as an additional reference
/// speed.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct SentReference {
    speed_mm_s: f64,
    torque_mm_s: f64,
}

/// The observer of one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
struct AxisObserver {
    of: ObservedAxis,
    servo_s: f64,
    position_mm: f64,
    speed_mm_s: f64,
    disturbance_mm_s: f64,
    /// Commands on their way to the position loop, mm.
    commands: CommandQueue,
    /// Error of the position loop at the last servo period, mm.
    error_mm: f64,
    /// Command and measured position of the last servo period, mm, and how far the command had
    /// moved.
    last_mm: Option<[f64; 2]>,
    moved_mm: f64,
    /// The newest first.
    sent: [SentReference; KEPT_PERIODS],
    /// Reference speed that acted in the last servo period, and the integral at its start.
    acted_mm_s: f64,
    integral_mm_s: f64,
}

impl AxisObserver {
    fn new(of: ObservedAxis, servo_s: f64) -> Self {
        Self {
            of,
            servo_s,
            position_mm: 0.0,
            speed_mm_s: 0.0,
            disturbance_mm_s: 0.0,
            commands: CommandQueue::resting(of.drive.command_periods, 0.0),
            error_mm: 0.0,
            last_mm: None,
            moved_mm: 0.0,
            sent: [SentReference::default(); KEPT_PERIODS],
            acted_mm_s: 0.0,
            integral_mm_s: 0.0,
        }
    }

    /// Starts at rest at the tool position.
    fn start(&mut self, measured_mm: f64) {
        *self = Self {
            position_mm: measured_mm,
            ..Self::new(self.of, self.servo_s)
        };
    }

    /// Goes on by a servo period that begins with sending this command and with this position,
    /// against this friction.
    fn go_on(&mut self, command_mm: f64, friction_mm_s: f64, measured_mm: f64) {
        let [alpha, beta, gamma_s, delta_s] = self.of.axis.coefficients();
        if self.last_mm.is_none() {
            self.commands = CommandQueue::resting(self.of.drive.command_periods, command_mm);
        }
        let command_mm = self.commands.pass(command_mm);
        self.send(command_mm, measured_mm);
        let arrived = self.arrived();
        let asked_mm_s = arrived.speed_mm_s;
        let beside_mm_s = arrived.torque_mm_s + self.integrated(asked_mm_s, measured_mm);
        self.last_mm = Some([command_mm, measured_mm]);
        let innovation_mm = measured_mm - self.position_mm;
        let [l1, l2, l3] = self.of.gains;
        let w = self.speed_mm_s;
        let driven_mm_s = asked_mm_s + beside_mm_s - friction_mm_s + self.disturbance_mm_s;
        self.position_mm += gamma_s * w + delta_s * driven_mm_s + l1 * innovation_mm;
        self.speed_mm_s = alpha * w + beta * driven_mm_s + l2 * innovation_mm;
        let disturbance_mm_s = self.disturbance_mm_s + l3 * innovation_mm;
        self.disturbance_mm_s = bounded(disturbance_mm_s, -self.of.limit_mm_s, self.of.limit_mm_s);
    }

    /// Computes the reference of the position loop for a command and sends it to the drive.
    fn send(&mut self, command_mm: f64, measured_mm: f64) {
        let (SampledAxis { kp_1_s, kd, .. }, drive) = (self.of.axis, self.of.drive);
        let error_mm = command_mm - measured_mm;
        let fed_back_mm_s = kp_1_s * error_mm + kd * (error_mm - self.error_mm) / self.servo_s;
        self.error_mm = error_mm;
        let moved_mm = self
            .last_mm
            .map_or(0.0, |[before_mm, _]| command_mm - before_mm);
        let change_mm = moved_mm - self.moved_mm;
        self.moved_mm = moved_mm;
        self.sent.copy_within(..KEPT_PERIODS - 1, 1);
        let [newest, ..] = &mut self.sent;
        *newest = SentReference {
            speed_mm_s: fed_back_mm_s + drive.velocity_feedforward * moved_mm / self.servo_s,
            torque_mm_s: drive.torque_1_s * change_mm,
        };
    }

    /// Returns the reference that acts in the servo period at whose start the measured position was
    /// taken.
    fn arrived(&self) -> SentReference {
        let periods = self.of.drive.delay_s / self.servo_s;
        let whole = libm::floor(periods);
        // A float that is not a number saturates to zero here.
        let at = |age: usize| {
            let sent = self.sent.get(age.min(KEPT_PERIODS - 1));
            sent.copied().unwrap_or_default()
        };
        let (newer, part) = (at(whole as usize), periods - whole);
        if part > 0.0 {
            let older = at(whole as usize + 1);
            let mean = |newer: f64, older: f64| newer + part * (older - newer);
            SentReference {
                speed_mm_s: mean(newer.speed_mm_s, older.speed_mm_s),
                torque_mm_s: mean(newer.torque_mm_s, older.torque_mm_s),
            }
        } else {
            newer
        }
    }

    /// Returns the contribution of the speed loop's integral, mm/s.
    fn integrated(&mut self, asked_mm_s: f64, measured_mm: f64) -> f64 {
        let time_s = self.of.drive.speed_integral_s;
        if time_s <= 0.0 {
            return 0.0;
        }
        let moved_mm = self
            .last_mm
            .map_or(0.0, |[_, before_mm]| measured_mm - before_mm);
        self.integral_mm_s += (self.acted_mm_s * self.servo_s - moved_mm) / time_s;
        self.acted_mm_s = asked_mm_s;
        self.integral_mm_s + 0.5 * self.servo_s * (asked_mm_s - self.speed_mm_s) / time_s
    }
}

/// Feedforward, less what an observer finds.
#[derive(Debug, Clone)]
pub(super) struct DisturbanceRejection<const N: usize> {
    feedforward: Feedforward<N>,
    observers: [AxisObserver; N],
    started: bool,
}

impl<const N: usize> DisturbanceRejection<N> {
    /// Creates the controller behind a feedforward, for these axes.
    pub(super) fn new(feedforward: Feedforward<N>, axes: [ObservedAxis; N], servo_s: f64) -> Self {
        Self {
            feedforward,
            observers: axes.map(|axis| AxisObserver::new(axis, servo_s)),
            started: false,
        }
    }

    /// The command of the next servo period on a path that runs at `rate` times the planned feed.
    pub(super) fn command_at(&mut self, window: &Window<'_, N>, rate: f64) -> Command<N> {
        let at_mm = |after_s: f64| {
            window
                .at(rate * (window.feed_period_s + after_s))
                .position_mm
        };
        let lead_mm = self
            .feedforward
            .lead_mm(at_mm, window.offset_mm, self.load_mm_s());
        Command::straight(rate, lead_mm)
    }

    /// Loads that take out the estimated disturbances, mm/s.
    fn load_mm_s(&self) -> [f64; N] {
        self.observers
            .each_ref()
            .map(|observer| -observer.disturbance_mm_s)
    }
}

impl<const N: usize> Controller<N> for DisturbanceRejection<N> {
    fn schedule(&self) -> Schedule {
        self.feedforward.schedule()
    }

    fn reset(&mut self) {
        self.started = false;
        self.feedforward.reset();
        self.observers
            .iter_mut()
            .for_each(|observer| observer.start(0.0));
    }

    /// Advances each observer by one servo period. Without a measured position it resets them and
    /// the feedforward, because the motion of the tool in between is unknown.
    fn observe(&mut self, window: &Window<'_, N>, measured: Option<&Measured<N>>) {
        let position_mm = measured.map(|measured| measured.position_mm);
        let Some(position_mm) = position_mm.filter(|mm| norm(*mm).is_finite()) else {
            self.reset();
            return;
        };
        let friction_mm_s = self.feedforward.friction_mm_s();
        let command_mm = add_scaled(window.now().position_mm, 1.0, window.offset_mm);
        for (i, observer) in self.observers.iter_mut().enumerate() {
            if !self.started {
                observer.start(position_mm[i]);
            }
            observer.go_on(command_mm[i], friction_mm_s[i], position_mm[i]);
        }
        self.started = true;
    }

    fn command(&mut self, window: &Window<'_, N>, _: &Measured<N>) -> Command<N> {
        self.feedforward.command_against(window, self.load_mm_s())
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    const SERVO_S: f64 = 0.001;

    pub(in super::super) use crate::peers::fixture::sampled as axis;

    /// Position and estimate after a second at rest at 0 under a disturbance of 3 mm/s and a
    /// friction of 1 mm/s that is known, with and without taking the estimate out.
    fn after_a_second(of: ObservedAxis, take_out: bool) -> (f64, f64) {
        let model = of.axis;
        let mut observer = AxisObserver::new(of, SERVO_S);
        let (mut x, mut w, mut last, mut offset_mm) = (0.0, 0.0, 0.0, 0.0);
        for _ in 0..1000 {
            observer.go_on(offset_mm, 1.0, x);
            let error = offset_mm - x;
            let driven = model.kp_1_s * error + model.kd * (error - last) / SERVO_S + 3.0 - 1.0;
            last = error;
            x += model.gamma_s * w + model.delta_s * driven;
            w = model.alpha * w + model.beta * driven;
            let derivative = model.kd / SERVO_S;
            let carried = derivative / (model.kp_1_s + derivative) * offset_mm;
            let fed_forward = 1.0 / (model.kp_1_s + derivative);
            let taken_out = -observer.disturbance_mm_s / (model.kp_1_s + derivative);
            let out_mm = taken_out + carried + fed_forward;
            offset_mm = if take_out { out_mm } else { 0.0 };
        }
        (x, observer.disturbance_mm_s)
    }

    /// Checks that gains find a constant disturbance and take it out.
    pub(in super::super) fn a_constant_disturbance_is_found_and_taken_out(
        gains: impl Fn(&SampledAxis) -> [f64; 3],
    ) {
        for kd in [0.0, 0.02] {
            let axis = axis(kd);
            let of = ObservedAxis {
                axis,
                drive: ObservedDrive::default(),
                limit_mm_s: 100.0,
                gains: gains(&axis),
            };
            for (take_out, left_mm) in [(true, 0.0), (false, 2.0 / 50.0)] {
                let (error_mm, found_mm_s) = after_a_second(of, take_out);
                let is_found = (found_mm_s - 3.0).abs() < 1e-7;
                let is_left = (error_mm - left_mm).abs() < 1e-9;
                assert!(is_found && is_left, "kd {kd}: {error_mm} {found_mm_s}");
            }
        }
    }

    #[test]
    fn no_more_is_assumed_than_the_drive_can() {
        let of = ObservedAxis {
            axis: axis(0.0),
            drive: ObservedDrive::default(),
            limit_mm_s: 5.0,
            gains: [0.5, 50.0, 10.0],
        };
        let mut observer = AxisObserver::new(of, SERVO_S);
        (0..100).for_each(|_| observer.go_on(0.0, 0.0, 100.0));
        assert_eq!(observer.disturbance_mm_s.abs(), 5.0);
    }
}
