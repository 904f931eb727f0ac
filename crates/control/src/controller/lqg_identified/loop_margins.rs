//! Margins of the loop of filter and regulator, broken at the command of its axis.
//!
//! ```text
//! S(w) = 1 + sum of c_n exp(-i w n Ts)        L = 1/S - 1
//! ```
//!
//! c_n is the command of the linear loop n servo periods after one command that was sent with a unit
//! more; the filter does not know of it. The linear loop has the drive with its delay, integral and
//! torque filter, and the axis without friction. What the loop remembers for longer than
//! [`OBSERVED`] periods, the slow loads, does not count.
//!
//! Source: Doyle (1978), "Guaranteed margins for LQG regulators", IEEE Trans. Automatic Control
//! 23(4), for the need; Skogestad and Postlethwaite (2005), Multivariable Feedback Control, section
//! 2.4, for the margins.

use super::command_weight::{CommandModel, REGULATED, with_commands};
use super::estimate::{FilterModel, KEPT_PERIODS};
use super::linear::STATES;
use super::riccati::inner;

/// Servo periods in which the loop is observed, and those at the end whose mean is taken to stay.
const OBSERVED: usize = 1500;
const TAIL: usize = 100;
/// Frequencies, by a constant ratio up to half the servo rate, and the lowest one, rad per servo
/// period.
const FREQUENCIES: u32 = 160;
const LOWEST_RAD: f64 = 0.02;

/// Margins of a loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LoopMargins {
    /// Smallest factor on the gain, above 1, at which the loop becomes unstable.
    pub(super) gain: f64,
    /// Smallest lag at which it becomes unstable, rad.
    pub(super) phase_rad: f64,
}

impl LoopMargins {
    /// Margins of a loop that is never near to being unstable.
    const UNBOUNDED: Self = Self {
        gain: f64::INFINITY,
        phase_rad: core::f64::consts::PI,
    };

    /// Returns the margins of a filter and a regulator with these gains on the axis of the filter.
    pub(super) fn of(
        filter: &FilterModel,
        command_model: &CommandModel,
        regulator: &[f64; REGULATED],
    ) -> Self {
        let changed = changed(filter, command_model, regulator);
        let rest = changed.iter().rev().take(TAIL).sum::<f64>() / TAIL as f64;
        let ratio =
            libm::exp(libm::log(core::f64::consts::PI / LOWEST_RAD) / f64::from(FREQUENCIES - 1));
        let (mut margins, mut last) = (Self::UNBOUNDED, None);
        let mut rad = LOWEST_RAD;
        for _ in 0..FREQUENCIES {
            let open = open_loop(&changed, rest, rad);
            if let Some(last) = last {
                margins.take_in(last, open);
            }
            (last, rad) = (Some(open), rad * ratio);
        }
        // At half the servo rate the loop is real.
        if let Some([re, _]) = last
            && re < 0.0
        {
            margins.take_in([re, -1e-9], [re, 1e-9]);
        }
        margins
    }

    /// Takes in the loop at two neighboring frequencies, as real and imaginary parts.
    fn take_in(&mut self, from: [f64; 2], to: [f64; 2]) {
        if from[1] * to[1] < 0.0 && from[0] < 0.0 {
            let part = from[1] / (from[1] - to[1]);
            let gain = -1.0 / (from[0] + part * (to[0] - from[0]));
            if gain > 1.0 {
                self.gain = self.gain.min(gain);
            }
        }
        let [before, after] = [from, to].map(|[re, im]| libm::hypot(re, im) - 1.0);
        if before * after < 0.0 {
            let part = before / (before - after);
            let [re, im] = [0, 1].map(|i| from[i] + part * (to[i] - from[i]));
            self.phase_rad = self.phase_rad.min(libm::atan2(im, -re).abs());
        }
    }
}

/// Returns L at a frequency, rad per servo period. `rest` is the command after the end.
fn open_loop(changed: &[f64; OBSERVED], rest: f64, rad: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(-rad);
    let times = |[re, im]: [f64; 2], [by_re, by_im]: [f64; 2]| {
        [re * by_re - im * by_im, re * by_im + im * by_re]
    };
    let inverse = |[re, im]: [f64; 2]| {
        let size = re * re + im * im;
        [re / size, -im / size]
    };
    // Horner's rule, from the end on.
    let [re, im] = inverse([1.0 - cos, -sin]);
    let mut sum = [rest * re, rest * im];
    for command in changed.iter().rev() {
        let [re, im] = times(sum, [cos, sin]);
        sum = [re + command, im];
    }
    let [re, im] = inverse(sum);
    [re - 1.0, im]
}

/// Returns S as a response over time: the commands after one with a unit more.
fn changed(
    filter: &FilterModel,
    command_model: &CommandModel,
    regulator: &[f64; REGULATED],
) -> [f64; OBSERVED] {
    let course = filter.linear_course();
    let gains = filter.gains_as_given();
    let (mut axis, mut estimate) = ([0.0; STATES], [0.0; STATES]);
    // Reference speeds that were decided, and those that the drive gets; the newest first.
    let (mut decided, mut sent) = ([0.0; KEPT_PERIODS], [0.0; KEPT_PERIODS]);
    let (mut commands, mut ideal, mut more) = ([0.0; 2], [0.0; 2], [0.0; 2]);
    let mut before = 0.0;
    core::array::from_fn(|n| {
        let measured = axis[0];
        let innovation = measured - estimate[0];
        for (state, gain) in estimate.iter_mut().zip(gains) {
            *state += gain * innovation;
        }
        let mut ahead = course.ahead(&estimate, &decided);
        let reference = course.reference(&ahead);
        let ideal_now = command_model.solved(reference, ideal);
        (ahead[2], ahead[3]) = (0.0, 0.0);
        let off = with_commands(&ahead, [commands[0] - ideal[0], commands[1] - ideal[1]]);
        let speed = reference - inner(regulator, &off);
        let command =
            command_model.solved(speed + command_model.by_angle(measured, before), commands);
        let unit = if n == 0 { 1.0 } else { 0.0 };
        decided.copy_within(..KEPT_PERIODS - 1, 1);
        sent.copy_within(..KEPT_PERIODS - 1, 1);
        decided[0] = speed;
        sent[0] = speed + command_model.by_commands(unit, more);
        axis = course.period_later(&axis, &sent);
        estimate = course.period_later(&estimate, &decided);
        (commands, ideal, more) = (
            [command, commands[0]],
            [ideal_now, ideal[0]],
            [unit, more[0]],
        );
        before = measured;
        command + unit
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn margins_are_where_a_loop_crosses_the_real_axis_and_the_unit_circle() {
        let mut margins = LoopMargins::UNBOUNDED;
        margins.take_in([-0.4, -0.1], [-0.4, 0.1]);
        assert_eq!(margins.gain, 2.5);
        // Beyond -1 and right of zero a crossing is no limit of a rising gain.
        margins.take_in([-1.4, -0.1], [-1.4, 0.1]);
        margins.take_in([0.4, -0.1], [0.4, 0.1]);
        assert_eq!(margins.gain, 2.5);
        // At 30 degrees from -1, from outside to inside.
        let (sin, cos) = libm::sincos(core::f64::consts::PI / 6.0);
        margins.take_in([-1.01 * cos, -1.01 * sin], [-0.99 * cos, -0.99 * sin]);
        assert!((margins.phase_rad - core::f64::consts::PI / 6.0).abs() < 1e-9);
    }

    #[test]
    fn an_integrator_has_the_loop_of_its_sum() {
        // Commands that repeat -0.5 of all before: S = (1 - z) / (1 - 0.5 z), L = 0.5 z / (1 - z),
        // z one period of delay.
        let mut left = 1.0;
        let changed = core::array::from_fn(|n| {
            let command = if n == 0 { 1.0 } else { -0.5 * left };
            left = if n == 0 { 1.0 } else { 0.5 * left };
            command
        });
        for rad in [0.1_f64, 1.0, 3.0] {
            let (sin, cos) = libm::sincos(-rad);
            let [re, im] = open_loop(&changed, 0.0, rad);
            // L (1 - z) = 0.5 z.
            let product = [re * (1.0 - cos) + im * sin, im * (1.0 - cos) - re * sin];
            assert!(
                (product[0] - 0.5 * cos).abs() < 1e-9 && (product[1] - 0.5 * sin).abs() < 1e-9,
                "{rad}: {product:?}"
            );
        }
    }
}
