//! Velocity and acceleration feedforward with a disturbance observer: friction and cutting force are estimated from what the
//! nominal servo does not explain, and taken out of the command.
//!
//! A sampled axis under the reference speed u and an unknown d that acts as one, with what is measured as y:
//!
//! ```text
//! x(k+1) = x + gamma w + delta (u + d)     w(k+1) = alpha w + beta (u + d)     d(k+1) = d
//! u(k)   = kp e(k) + kd (e(k) - e(k-1)) / Ts,   e = c - y
//! ```
//!
//! An observer of all three, `xi(k+1) = A xi + B u + L (y - x)`, has the characteristic polynomial `(z - p)^3`,
//! `p = exp(-2 pi f Ts)`, with `s = z - 1`, `r = 1 - p`, `a = 1 - alpha`:
//!
//! ```text
//! l1 = 3 r - a     l3 = r^3 / (gamma beta + delta a)     l2 = (3 r^2 - a l1 - delta l3) / gamma
//! ```
//!
//! and the command is the feedforward's less `d / (kp + kd / Ts)`. The estimate is held to what the drive can: beyond, it is the
//! torque limit that the nominal servo does not explain.
//!
//! Symbols: x position, mm; w speed, u reference speed, d disturbance as a reference speed, mm/s; c command, mm; f bandwidth of
//! the observer, Hz; Ts servo period, s.
//!
//! Source: Ohnishi (1987), "A new servo method in mechatronics"; as an observer with a constant disturbance, Johnson (1971),
//! "Accommodation of external disturbances in linear regulator and servomechanism problems".
//!
//! Departures: the drive takes positions, so that the estimate acts through the position loop and not as a torque.

use super::feedforward::Feedforward;
use super::zero_phase::SampledAxis;
use super::{Command, Controller, Measured, Schedule};
use crate::vector::{add_scaled, bounded, norm};
use crate::window::Window;

/// Bandwidth, Hz: above, encoder noise gets into the command, and the delay of a servo period makes the loop swing; below,
/// friction lasts longer at every reversal (circle of 10 mm at 50 mm/s on tnv40, um RMS: 10 Hz 1.8, 25 Hz 1.1, 40 Hz 0.8).
pub const BANDWIDTH_HZ: f64 = 40.0;

/// The observer of one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Observer {
    axis: SampledAxis,
    servo_s: f64,
    gains: [f64; 3],
    /// Largest disturbance that is believed, mm/s.
    limit_mm_s: f64,
    position_mm: f64,
    speed_mm_s: f64,
    disturbance_mm_s: f64,
    /// Error of the position loop at the last servo period, mm.
    error_mm: f64,
}

impl Observer {
    fn new(axis: SampledAxis, limit_mm_s: f64, bandwidth_hz: f64, servo_s: f64) -> Self {
        let SampledAxis { alpha, beta, gamma_s, delta_s, .. } = axis;
        let r = 1.0 - libm::exp(-core::f64::consts::TAU * bandwidth_hz * servo_s);
        let a = 1.0 - alpha;
        let l1 = 3.0 * r - a;
        let l3 = r * r * r / (gamma_s * beta + delta_s * a);
        let l2 = (3.0 * r * r - a * l1 - delta_s * l3) / gamma_s;
        Self {
            axis,
            servo_s,
            gains: [l1, l2, l3],
            limit_mm_s,
            position_mm: 0.0,
            speed_mm_s: 0.0,
            disturbance_mm_s: 0.0,
            error_mm: 0.0,
        }
    }

    /// At rest where the tool is.
    fn start(&mut self, measured_mm: f64) {
        (self.position_mm, self.speed_mm_s, self.disturbance_mm_s, self.error_mm) = (measured_mm, 0.0, 0.0, 0.0);
    }

    /// Goes on by a servo period that begins with this command and this position.
    fn go_on(&mut self, command_mm: f64, measured_mm: f64) {
        let SampledAxis { alpha, beta, gamma_s, delta_s, kp_1_s, kd } = self.axis;
        let error_mm = command_mm - measured_mm;
        let reference_mm_s = kp_1_s * error_mm + kd * (error_mm - self.error_mm) / self.servo_s;
        self.error_mm = error_mm;
        let innovation_mm = measured_mm - self.position_mm;
        let [l1, l2, l3] = self.gains;
        let (w, driven_mm_s) = (self.speed_mm_s, reference_mm_s + self.disturbance_mm_s);
        self.position_mm += gamma_s * w + delta_s * driven_mm_s + l1 * innovation_mm;
        self.speed_mm_s = alpha * w + beta * driven_mm_s + l2 * innovation_mm;
        let disturbance_mm_s = self.disturbance_mm_s + l3 * innovation_mm;
        self.disturbance_mm_s = bounded(disturbance_mm_s, -self.limit_mm_s, self.limit_mm_s);
    }

    /// What the command is to be moved by, mm.
    fn offset_mm(&self) -> f64 {
        -self.disturbance_mm_s / (self.axis.kp_1_s + self.axis.kd / self.servo_s)
    }
}

/// Feedforward with a disturbance observer.
#[derive(Debug, Clone)]
pub struct DisturbanceObserver<const N: usize> {
    feedforward: Feedforward<N>,
    observers: [Observer; N],
    started: bool,
}

impl<const N: usize> DisturbanceObserver<N> {
    /// Behind a feedforward, for these axes, whose drives can make up for a disturbance of so much, mm/s.
    pub fn new(
        feedforward: Feedforward<N>,
        axes: [SampledAxis; N],
        limits_mm_s: [f64; N],
        bandwidth_hz: f64,
        servo_s: f64,
    ) -> Self {
        let observers = core::array::from_fn(|i| Observer::new(axes[i], limits_mm_s[i], bandwidth_hz, servo_s));
        Self { feedforward, observers, started: false }
    }
}

impl<const N: usize> Controller<N> for DisturbanceObserver<N> {
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
        let command_mm = add_scaled(window.now().position_mm, 1.0, window.offset_mm);
        for (i, observer) in self.observers.iter_mut().enumerate() {
            if !self.started {
                observer.start(position_mm[i]);
            }
            observer.go_on(command_mm[i], position_mm[i]);
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
mod tests {
    use super::*;

    const SERVO_S: f64 = 0.001;

    /// A speed loop of 200 rad/s, held exactly.
    fn axis(kd: f64) -> SampledAxis {
        let alpha = libm::exp(-200.0 * SERVO_S);
        let gamma_s = (1.0 - alpha) / 200.0;
        SampledAxis { alpha, beta: 1.0 - alpha, gamma_s, delta_s: SERVO_S - gamma_s, kp_1_s: 50.0, kd }
    }

    /// Position and estimate after a second at rest at 0 under a disturbance of 3 mm/s, with and without taking it out.
    fn after_a_second(kd: f64, take_out: bool) -> (f64, f64) {
        let model = axis(kd);
        let mut observer = Observer::new(model, 100.0, BANDWIDTH_HZ, SERVO_S);
        let (mut x, mut w, mut last, mut offset_mm) = (0.0, 0.0, 0.0, 0.0);
        for _ in 0..1000 {
            observer.go_on(offset_mm, x);
            let error = offset_mm - x;
            let driven = model.kp_1_s * error + model.kd * (error - last) / SERVO_S + 3.0;
            last = error;
            x += model.gamma_s * w + model.delta_s * driven;
            w = model.alpha * w + model.beta * driven;
            let derivative = model.kd / SERVO_S;
            let carried = derivative / (model.kp_1_s + derivative) * offset_mm;
            offset_mm = if take_out { observer.offset_mm() + carried } else { 0.0 };
        }
        (x, observer.disturbance_mm_s)
    }

    #[test]
    fn a_constant_disturbance_is_found_and_taken_out() {
        for kd in [0.0, 0.02] {
            let (error_mm, found_mm_s) = after_a_second(kd, true);
            assert!(error_mm.abs() < 1e-9 && (found_mm_s - 3.0).abs() < 1e-7, "kd {kd}: {error_mm} {found_mm_s}");
            let (error_mm, found_mm_s) = after_a_second(kd, false);
            assert!((error_mm - 3.0 / 50.0).abs() < 1e-9 && (found_mm_s - 3.0).abs() < 1e-7, "kd {kd}: {error_mm}");
        }
    }

    #[test]
    fn the_errors_of_the_observer_decay_with_its_poles() {
        // (z - p)^3 in s = z - 1, from the matrix A - L C.
        let model = axis(0.0);
        let [l1, l2, l3] = Observer::new(model, 1.0, 30.0, SERVO_S).gains;
        let p = libm::exp(-core::f64::consts::TAU * 30.0 * SERVO_S);
        for z in [p, 0.0, 1.0, 1.7] {
            let SampledAxis { alpha, beta, gamma_s, delta_s, .. } = model;
            let [m0, m1, m2] = [[z - 1.0 + l1, -gamma_s, -delta_s], [l2, z - alpha, -beta], [l3, 0.0, z - 1.0]];
            let minor = |i: usize, j: usize| m1[i] * m2[j] - m1[j] * m2[i];
            let determinant = m0[0] * minor(1, 2) - m0[1] * minor(0, 2) + m0[2] * minor(0, 1);
            assert!((determinant - (z - p) * (z - p) * (z - p)).abs() < 1e-12, "{z}: {determinant}");
        }
    }

    #[test]
    fn no_more_is_believed_than_the_drive_can() {
        let mut observer = Observer::new(axis(0.0), 5.0, BANDWIDTH_HZ, SERVO_S);
        (0..100).for_each(|_| observer.go_on(0.0, 100.0));
        assert!(observer.disturbance_mm_s.abs() <= 5.0, "{}", observer.disturbance_mm_s);
    }
}
