//! Feedforward, and an observer of each axis that finds what the nominal servo does not explain and takes it out of the command:
//! what controllers with a constant-gain observer have in common. They differ in how its gains are found.
//!
//! A sampled axis under the reference speed u, the friction f that the feedforward makes up for, and an unknown d that acts as a
//! reference speed, with what is measured as y:
//!
//! ```text
//! x(k+1) = x + gamma w + delta (u - f + d)     w(k+1) = alpha w + beta (u - f + d)     d(k+1) = d
//! u(k)   = kp e(k) + kd (e(k) - e(k-1)) / Ts,   e = c - y
//! ```
//!
//! is observed by `xi(k+1) = A xi + B (u - f) + L (y - x)`, and the command is the feedforward's less `d / (kp + kd / Ts)`. The
//! estimate is held to what the drive can: beyond, it is the torque limit that the nominal servo does not explain.
//!
//! Symbols: x position, mm; w speed, u reference speed, f friction and d disturbance as reference speeds, mm/s; c command, mm;
//! Ts servo period, s.
//!
//! Source: Johnson (1971), "Accommodation of external disturbances in linear regulator and servomechanism problems".
//!
//! Departures: the drive takes positions, so that the estimate acts through the position loop and not as a torque.

use super::feedforward::Feedforward;
use super::zero_phase::SampledAxis;
use super::{Command, Controller, Measured, Schedule};
use crate::vector::{add_scaled, bounded, norm};
use crate::window::Window;

/// What the observer of one axis is made from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ObservedAxis {
    /// Its law between two servo periods.
    pub axis: SampledAxis,
    /// Largest disturbance that is believed, mm/s: what its drive can make up for.
    pub limit_mm_s: f64,
    /// L: by how much a unit of the missed position moves position, speed and disturbance; 1, 1/s, 1/s.
    pub gains: [f64; 3],
}

/// The observer of one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
struct AxisObserver {
    of: ObservedAxis,
    servo_s: f64,
    position_mm: f64,
    speed_mm_s: f64,
    disturbance_mm_s: f64,
    /// Error of the position loop at the last servo period, mm.
    error_mm: f64,
}

impl AxisObserver {
    fn new(of: ObservedAxis, servo_s: f64) -> Self {
        Self { of, servo_s, position_mm: 0.0, speed_mm_s: 0.0, disturbance_mm_s: 0.0, error_mm: 0.0 }
    }

    /// At rest where the tool is.
    fn start(&mut self, measured_mm: f64) {
        (self.position_mm, self.speed_mm_s, self.disturbance_mm_s, self.error_mm) = (measured_mm, 0.0, 0.0, 0.0);
    }

    /// Goes on by a servo period that begins with this command and this position, against this friction.
    fn go_on(&mut self, command_mm: f64, friction_mm_s: f64, measured_mm: f64) {
        let SampledAxis { alpha, beta, gamma_s, delta_s, kp_1_s, kd } = self.of.axis;
        let error_mm = command_mm - measured_mm;
        let reference_mm_s = kp_1_s * error_mm + kd * (error_mm - self.error_mm) / self.servo_s;
        self.error_mm = error_mm;
        let innovation_mm = measured_mm - self.position_mm;
        let [l1, l2, l3] = self.of.gains;
        let (w, driven_mm_s) = (self.speed_mm_s, reference_mm_s - friction_mm_s + self.disturbance_mm_s);
        self.position_mm += gamma_s * w + delta_s * driven_mm_s + l1 * innovation_mm;
        self.speed_mm_s = alpha * w + beta * driven_mm_s + l2 * innovation_mm;
        let disturbance_mm_s = self.disturbance_mm_s + l3 * innovation_mm;
        self.disturbance_mm_s = bounded(disturbance_mm_s, -self.of.limit_mm_s, self.of.limit_mm_s);
    }

    /// What the command is to be moved by, mm.
    fn offset_mm(&self) -> f64 {
        -self.disturbance_mm_s / (self.of.axis.kp_1_s + self.of.axis.kd / self.servo_s)
    }
}

/// Feedforward, less what an observer finds.
#[derive(Debug, Clone)]
pub struct DisturbanceRejection<const N: usize> {
    feedforward: Feedforward<N>,
    observers: [AxisObserver; N],
    started: bool,
}

impl<const N: usize> DisturbanceRejection<N> {
    /// Behind a feedforward, for these axes.
    pub fn new(feedforward: Feedforward<N>, axes: [ObservedAxis; N], servo_s: f64) -> Self {
        Self { feedforward, observers: axes.map(|axis| AxisObserver::new(axis, servo_s)), started: false }
    }
}

impl<const N: usize> Controller<N> for DisturbanceRejection<N> {
    fn schedule(&self) -> Schedule {
        self.feedforward.schedule()
    }

    fn reset(&mut self) {
        self.started = false;
        self.observers.iter_mut().for_each(|observer| observer.start(0.0));
    }

    /// Without a position it begins anew: what the tool does meanwhile nobody knows.
    fn observe(&mut self, window: &Window<'_, N>, measured: Option<&Measured<N>>) {
        let position_mm = measured.map(|measured| measured.position_mm).filter(|mm| norm(*mm).is_finite());
        let Some(position_mm) = position_mm else {
            self.reset();
            return;
        };
        let friction_mm_s = self.feedforward.friction_mm_s(window);
        let command_mm = add_scaled(window.now().position_mm, 1.0, window.offset_mm);
        for (i, observer) in self.observers.iter_mut().enumerate() {
            if !self.started {
                observer.start(position_mm[i]);
            }
            observer.go_on(command_mm[i], friction_mm_s[i], position_mm[i]);
        }
        self.started = true;
    }

    fn command(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N> {
        let command = self.feedforward.command(window, measured);
        let offset_mm = core::array::from_fn(|i| command.offset_mm[i] + self.observers[i].offset_mm());
        Command { offset_mm, ..command }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    const SERVO_S: f64 = 0.001;

    /// A speed loop of 200 rad/s, held exactly.
    pub(in super::super) fn axis(kd: f64) -> SampledAxis {
        let alpha = libm::exp(-200.0 * SERVO_S);
        let gamma_s = (1.0 - alpha) / 200.0;
        SampledAxis { alpha, beta: 1.0 - alpha, gamma_s, delta_s: SERVO_S - gamma_s, kp_1_s: 50.0, kd }
    }

    /// Position and estimate after a second at rest at 0 under a disturbance of 3 mm/s and a friction of 1 mm/s that is known, with
    /// and without taking the estimate out.
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
            offset_mm = if take_out { observer.offset_mm() + carried + fed_forward } else { 0.0 };
        }
        (x, observer.disturbance_mm_s)
    }

    /// What gains have to do for a constant disturbance.
    pub(in super::super) fn a_constant_disturbance_is_found_and_taken_out(gains: impl Fn(&SampledAxis) -> [f64; 3]) {
        for kd in [0.0, 0.02] {
            let axis = axis(kd);
            let of = ObservedAxis { axis, limit_mm_s: 100.0, gains: gains(&axis) };
            let (error_mm, found_mm_s) = after_a_second(of, true);
            assert!(error_mm.abs() < 1e-9 && (found_mm_s - 3.0).abs() < 1e-7, "kd {kd}: {error_mm} {found_mm_s}");
            let (error_mm, found_mm_s) = after_a_second(of, false);
            assert!((error_mm - 2.0 / 50.0).abs() < 1e-9 && (found_mm_s - 3.0).abs() < 1e-7, "kd {kd}: {error_mm}");
        }
    }

    #[test]
    fn no_more_is_believed_than_the_drive_can() {
        let of = ObservedAxis { axis: axis(0.0), limit_mm_s: 5.0, gains: [0.5, 50.0, 10.0] };
        let mut observer = AxisObserver::new(of, SERVO_S);
        (0..100).for_each(|_| observer.go_on(0.0, 0.0, 100.0));
        assert!(observer.disturbance_mm_s.abs() == 5.0, "{}", observer.disturbance_mm_s);
    }
}
