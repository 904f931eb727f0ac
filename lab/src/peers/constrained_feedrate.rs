//! The feedrate of least time whose predicted contour error stays within what is allowed, by
//! nonlinear programming.
//!
//! The path is divided into lines of equal plan time T. Line i is cut at r_i times its planned
//! feedrate:
//!
//! ```text
//! minimize  sum_i T / r_i     subject to  eps_i(r) <= allowed,   slowest <= r_i <= 1
//! ```
//!
//! eps_i is the distance of the tool from the lines at the end of line i, predicted by a linear
//! model of each axis. On a line the reference speed v is constant, so the following error e and
//! the speed w have a closed form:
//!
//! ```text
//! e' = v - w,   w' = b (c (kp e + f v) - w),   b = (kv + B) / J,   c = kv / (kv + B)
//! ```
//!
//! with f the part of the speed that the drive feeds forward. With `y = ln r`, both `ln eps` and
//! the time are nearly linear in y over one step, so the problem is solved by sequential quadratic
//! programming (Wilson 1963): the constraints are linearized by differences, and the quadratic
//! problem is solved in its dual, one multiplier after another (Hildreth 1957). The acceleration
//! that the machine allows along the path then bounds the change of the feedrate from line to line.
//!
//! Source: Imamura and Kaufman (1989), "Feedrate optimization for machine tool control subject to
//! contour error constraints".
//!
//! The paper was not at hand. Lee, Cho and Jeon (2005) say of it: nonlinear programming, and an
//! ellipse divided into several lines. Reconstructed here: the lines for any path, the model, and
//! the solver. The plan needs the whole path in advance, which one lap of practice records; nothing
//! is measured in it.
use feedwright_control::vector::{add_scaled, bounded, dot, norm, scale, sub};
use feedwright_control::{Command, Controller, Measured, Parameter, Schedule, Window};

use super::cross_coupled_feedrate;

use super::deciding;

/// Plan time of a line, s: at 50 mm/s on a circle of 10 mm the path is 0.8 um beside the middle of
/// such a line, in 10 ms 3 um.
pub(super) const LINE_S: f64 = 0.005;
/// Longest program that is divided, s; the rest is cut as planned.
const LONGEST_S: f64 = 120.0;
/// Lines after which a line no longer acts on the tool: 0.16 s, eight time constants of a position
/// loop of 50 1/s.
const MEMORY: usize = 32;
/// Steps of the outer method, passes over the multipliers, and the longest step in `ln r`.
const STEPS: usize = 20;
const PASSES: usize = 60;
const LONGEST_STEP: f64 = 0.3;
/// Difference in `ln r` for the derivatives.
const DIFFERENCE: f64 = 1e-4;
/// A line that is shorter than this is rest, mm.
const SHORTEST_MM: f64 = 1e-6;
/// Least error that is compared with what is allowed, mm.
const LEAST_MM: f64 = 1e-9;

/// A linear axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LaggingAxis {
    /// Gain of the position loop, 1/s.
    pub kp_1_s: f64,
    /// b: bandwidth of the speed loop, 1/s.
    pub bandwidth_1_s: f64,
    /// c: part of a reference speed that is reached against viscous friction.
    pub reached: f64,
    /// f: part of the speed that is fed forward.
    pub fed_forward: f64,
}

impl LaggingAxis {
    /// Following error and speed after `for_s` on a line at `v` mm/s.
    fn after(&self, [error_mm, speed_mm_s]: [f64; 2], v: f64, for_s: f64) -> [f64; 2] {
        let b = self.bandwidth_1_s;
        let stiffness = b * self.reached * self.kp_1_s;
        let steady_mm = (v / self.reached - self.fed_forward * v) / self.kp_1_s;
        let [e, w] = [error_mm - steady_mm, speed_mm_s - v];
        // The exponential of [[0, -1], [stiffness, -b]]: half its trace is -b / 2, and the rest
        // squared is `square`.
        let (half, square) = (0.5 * b, 0.25 * b * b - stiffness);
        let root = libm::sqrt(square.abs());
        let decay = libm::exp(-half * for_s);
        let (cosine, sine_s) = match square {
            _ if root * for_s < 1e-4 => (1.0, for_s),
            _ if square > 0.0 => (libm::cosh(root * for_s), libm::sinh(root * for_s) / root),
            _ => (libm::cos(root * for_s), libm::sin(root * for_s) / root),
        };
        let moved_e = decay * (cosine * e + sine_s * (half * e - w));
        let moved_w = decay * (cosine * w + sine_s * (stiffness * e - half * w));
        [steady_mm + moved_e, v + moved_w]
    }
}

/// Settings of the plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Settings {
    /// Servo periods of a line; at least 1.
    pub servo_periods: u32,
    /// Contour error that is allowed, mm; above 0.
    pub allowed_mm: f64,
    /// Slowest rate, as a part of the planned feedrate; 0.1 to 1.
    pub slowest: f64,
    /// Acceleration along the path that the change of the rate may take, mm/s2.
    pub acceleration_mm_s2: f64,
}

impl Settings {
    /// Half of the error that the linear part of tnv40 makes on a circle of 10 mm at 50 mm/s.
    pub(super) const DEFAULT: Self = Self {
        servo_periods: 5,
        allowed_mm: 0.006,
        slowest: 0.4,
        acceleration_mm_s2: 100.0,
    };
}

pub(super) const ALLOWED: Parameter = Parameter {
    default: Settings::DEFAULT.allowed_mm,
    reason: "contour error that the plan allows by its linear model: a small one is slow everywhere, a large one changes nothing",
    ..cross_coupled_feedrate::ALLOWED
};

/// The lines, and the rates at which they are cut.
#[derive(Debug, Clone)]
pub(super) struct ConstrainedFeedrate<const N: usize> {
    settings: Settings,
    axes: [LaggingAxis; N],
    period_s: f64,
    /// Ends of the lines; the first is the start, mm.
    ends_mm: Vec<[f64; N]>,
    rates: Vec<f64>,
}

impl<const N: usize> ConstrainedFeedrate<N> {
    /// Starts before the lap that records the path. All memory of a tick is allocated here.
    pub(super) fn new(settings: Settings, axes: [LaggingAxis; N], servo_s: f64) -> Self {
        let period_s = f64::from(settings.servo_periods.max(1)) * servo_s;
        let lines = (LONGEST_S / period_s) as usize;
        Self {
            settings,
            axes,
            period_s,
            ends_mm: Vec::with_capacity(lines),
            rates: Vec::new(),
        }
    }

    fn line(&self, tau_s: f64) -> usize {
        libm::round(tau_s / self.period_s) as usize
    }
}

impl<const N: usize> Controller<N> for ConstrainedFeedrate<N> {
    fn schedule(&self) -> Schedule {
        deciding(self.settings.servo_periods.max(1), 0)
    }

    /// Forgets the path.
    fn reset(&mut self) {
        self.ends_mm.clear();
        self.rates.clear();
    }

    /// Plans the path that was recorded.
    fn next_lap(&mut self) {
        if self.rates.is_empty() {
            let path = DividedPath {
                ends_mm: &self.ends_mm,
                axes: &self.axes,
                period_s: self.period_s,
            };
            self.rates = path.plan(&self.settings);
        }
    }

    fn command(&mut self, window: &Window<'_, N>, _: &Measured<N>) -> Command<N> {
        let line = self.line(window.tau_s);
        if self.rates.is_empty() && line == self.ends_mm.len() && line < self.ends_mm.capacity() {
            self.ends_mm.push(window.now().position_mm);
        }
        Command::straight(self.rates.get(line).copied().unwrap_or(1.0), [0.0; N])
    }
}

/// State of every axis: following error and speed.
type ServoStates<const N: usize> = [[f64; 2]; N];

/// The path that is planned.
struct DividedPath<'a, const N: usize> {
    ends_mm: &'a [[f64; N]],
    axes: &'a [LaggingAxis; N],
    period_s: f64,
}

impl<const N: usize> DividedPath<'_, N> {
    fn count(&self) -> usize {
        self.ends_mm.len().saturating_sub(1)
    }

    fn chord_mm(&self, line: usize) -> [f64; N] {
        sub(self.ends_mm[line + 1], self.ends_mm[line])
    }

    fn is_moving(&self, line: usize) -> bool {
        norm(self.chord_mm(line)) > SHORTEST_MM
    }

    /// The state at the end of a line, and `ln` of the contour error there.
    fn cut(&self, line: usize, state: &ServoStates<N>, log_rate: f64) -> (ServoStates<N>, f64) {
        let for_s = self.period_s * libm::exp(-log_rate);
        let v = scale(1.0 / for_s, self.chord_mm(line));
        let after = |i: usize| self.axes[i].after(state[i], v[i], for_s);
        let state: ServoStates<N> = std::array::from_fn(after);
        let tool_mm = sub(self.ends_mm[line + 1], state.map(|[error_mm, _]| error_mm));
        let near = line.saturating_sub(MEMORY)..(line + 2).min(self.count());
        let near_mm = near.map(|near| self.distance_mm(near, tool_mm));
        let nearest_mm = near_mm.fold(f64::INFINITY, f64::min);
        (state, libm::log(nearest_mm.max(LEAST_MM)))
    }

    fn distance_mm(&self, line: usize, tool_mm: [f64; N]) -> f64 {
        let (chord_mm, from_mm) = (self.chord_mm(line), sub(tool_mm, self.ends_mm[line]));
        let square_mm2 = dot(chord_mm, chord_mm).max(f64::MIN_POSITIVE);
        let part = bounded(dot(from_mm, chord_mm) / square_mm2, 0.0, 1.0);
        norm(add_scaled(from_mm, -part, chord_mm))
    }

    /// States before each line, and `ln` of the error at its end.
    fn cut_all(&self, log_rates: &[f64]) -> (Vec<ServoStates<N>>, Vec<f64>) {
        let (mut states, mut errors) = (vec![[[0.0; 2]; N]], Vec::with_capacity(log_rates.len()));
        for (line, log_rate) in log_rates.iter().enumerate() {
            let (state, error) = self.cut(line, &states[line], *log_rate);
            states.push(state);
            errors.push(error);
        }
        (states, errors)
    }

    /// The rate of each line.
    fn plan(&self, settings: &Settings) -> Vec<f64> {
        let least = libm::log(settings.slowest);
        let mut log_rates = vec![0.0; self.count()];
        for _ in 0..STEPS {
            let (states, errors) = self.cut_all(&log_rates);
            let allowed = libm::log(settings.allowed_mm);
            let over: Vec<f64> = errors.iter().map(|error| error - allowed).collect();
            let slopes = self.slopes(&log_rates, &states, &errors);
            let step = self.quadratic_step(&log_rates, &slopes, &over, least);
            let largest = step
                .iter()
                .fold(0.0_f64, |largest, step| largest.max(step.abs()));
            for (log_rate, step) in log_rates.iter_mut().zip(&step) {
                *log_rate += step;
            }
            if largest < DIFFERENCE {
                break;
            }
        }
        let mut rates: Vec<f64> = log_rates.into_iter().map(libm::exp).collect();
        self.hold_acceleration(&mut rates, settings.acceleration_mm_s2);
        rates
    }

    /// Derivative of the error at the end of each line to the rates of itself and of those before
    /// it, the nearest first.
    fn slopes(
        &self,
        log_rates: &[f64],
        states: &[ServoStates<N>],
        errors: &[f64],
    ) -> Vec<[f64; MEMORY]> {
        let mut slopes = vec![[0.0; MEMORY]; errors.len()];
        for changed in (0..errors.len()).filter(|&line| self.is_moving(line)) {
            let mut state = states[changed];
            for line in changed..(changed + MEMORY).min(errors.len()) {
                let more = if line == changed { DIFFERENCE } else { 0.0 };
                let (next, error) = self.cut(line, &state, log_rates[line] + more);
                slopes[line][line - changed] = (error - errors[line]) / DIFFERENCE;
                state = next;
            }
        }
        slopes
    }

    /// The step that makes the time least where the constraints are linear: with `t = 1 / r` the
    /// time of a line in planned ones, its derivative is `-t` and its second derivative `t`. Lines
    /// of rest stay as they are.
    fn quadratic_step(
        &self,
        log_rates: &[f64],
        slopes: &[[f64; MEMORY]],
        over: &[f64],
        least: f64,
    ) -> Vec<f64> {
        let bounds = |line: usize| {
            let log_rate: f64 = log_rates[line];
            let low = (least - log_rate).max(-LONGEST_STEP);
            [low, (-log_rate).min(LONGEST_STEP)]
        };
        let count = log_rates.len();
        let moving: Vec<bool> = (0..count).map(|line| self.is_moving(line)).collect();
        let weight: Vec<f64> = log_rates.iter().map(|rate| libm::exp(-rate)).collect();
        // What all multipliers take from the step of each line, before its bounds.
        let (mut pressed, mut multipliers) = (vec![0.0; count], vec![0.0_f64; over.len()]);
        let step = |line: usize, pressed: f64| {
            let [low, high] = bounds(line);
            let step = bounded(1.0 - pressed / weight[line], low, high);
            if moving[line] { step } else { 0.0 }
        };
        for _ in 0..PASSES {
            for (line, slopes) in slopes.iter().enumerate() {
                let reach = (line + 1).min(MEMORY);
                let lines = || (0..reach).map(|back| (line - back, slopes[back]));
                let stepped = lines().map(|(at, slope)| slope * step(at, pressed[at]));
                let left = over[line] + stepped.sum::<f64>();
                let curvature: f64 = lines().map(|(at, slope)| slope * slope / weight[at]).sum();
                let change = (left / curvature.max(f64::MIN_POSITIVE)).max(-multipliers[line]);
                if change != 0.0 && change.is_finite() {
                    multipliers[line] += change;
                    lines().for_each(|(at, slope)| pressed[at] += change * slope);
                }
            }
        }
        (0..count).map(|line| step(line, pressed[line])).collect()
    }

    /// Slows lines down until the feedrate changes no faster than the machine may.
    fn hold_acceleration(&self, rates: &mut [f64], acceleration_mm_s2: f64) {
        let planned = |line| norm(self.chord_mm(line)) / self.period_s;
        let planned: Vec<f64> = (0..self.count()).map(planned).collect();
        let hold = |rates: &mut [f64], line: usize, neighbor: usize| {
            if planned[line] > 0.0 {
                let beside = rates[neighbor] * planned[neighbor];
                let own_mm = planned[line] * self.period_s;
                let most = libm::sqrt(beside * beside + 2.0 * acceleration_mm_s2 * own_mm);
                // What the plan does itself is within its own limits.
                let most = most.max(rates[neighbor] * planned[line]);
                rates[line] = rates[line].min(most / planned[line]);
            }
        };
        for line in (0..self.count().saturating_sub(1)).rev() {
            hold(rates, line, line + 1);
        }
        for line in 1..self.count() {
            hold(rates, line, line - 1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AXIS: LaggingAxis = LaggingAxis {
        kp_1_s: 50.0,
        bandwidth_1_s: 197.0,
        reached: 0.98,
        fed_forward: 0.0,
    };
    const SERVO_S: f64 = 0.001;
    /// Half axes 20 and 10 mm at 50 mm/s, by arc length to 1 % of a line.
    fn ellipse() -> Vec<[f64; 2]> {
        let (mut angle, mut ends_mm) = (0.0_f64, Vec::new());
        while angle < std::f64::consts::TAU {
            ends_mm.push([20.0 * libm::cos(angle), 10.0 * libm::sin(angle)]);
            for _ in 0..10 {
                angle += 0.025 / libm::hypot(20.0 * libm::sin(angle), 10.0 * libm::cos(angle));
            }
        }
        ends_mm
    }

    #[test]
    fn the_closed_form_is_what_small_steps_come_to() {
        for (bandwidth_1_s, fed_forward) in [
            (150.0, 0.0),
            (197.0, 0.0),
            (200.0 / 0.98 * 0.98, 0.95),
            (900.0, 0.5),
        ] {
            let axis = LaggingAxis {
                bandwidth_1_s,
                fed_forward,
                ..AXIS
            };
            let found = axis.after([0.3, -20.0], 40.0, 0.02);
            let (mut e, mut w) = (0.3, -20.0);
            let steps = 200_000;
            for _ in 0..steps {
                let asked = axis.reached * (axis.kp_1_s * e + fed_forward * 40.0);
                let of_w = bandwidth_1_s * (asked - w);
                e += 0.02 / f64::from(steps) * (40.0 - w);
                w += 0.02 / f64::from(steps) * of_w;
            }
            // Euler's steps of 0.1 us are off by some 1e-5 of what decays.
            let is_there = (found[0] - e).abs() < 1e-4 && (found[1] - w).abs() < 1e-2;
            assert!(is_there, "{axis:?}: {found:?} {e} {w}");
        }
    }

    #[test]
    fn the_feedrate_is_the_highest_that_holds_what_is_allowed() {
        let ends_mm = ellipse();
        let lines = DividedPath {
            ends_mm: &ends_mm,
            axes: &[AXIS; 2],
            period_s: 5.0 * SERVO_S,
        };
        let settings = Settings {
            acceleration_mm_s2: 1e9,
            slowest: 0.1,
            ..Settings::DEFAULT
        };
        let rates: Vec<f64> = lines.plan(&settings);
        let worst = |rates: &[f64]| {
            let log_rates: Vec<f64> = rates.iter().map(|rate| libm::log(*rate)).collect();
            let (_, errors) = lines.cut_all(&log_rates);
            errors.into_iter().fold(f64::NEG_INFINITY, f64::max)
        };
        let limit = libm::log(settings.allowed_mm);
        let held = worst(&rates);
        assert!(held < limit + 0.01, "{}", libm::exp(held));
        let open = worst(&vec![1.0; rates.len()]);
        assert!(
            open > limit + 0.5,
            "there is nothing to hold: {}",
            libm::exp(open)
        );
        // Faster anywhere is too fast somewhere, away from the end, which nothing after it bounds.
        for line in 0..rates.len() - MEMORY {
            if rates[line] < 0.99 {
                let mut faster = rates.clone();
                faster[line] = (1.2 * rates[line]).min(1.0);
                assert!(worst(&faster) > limit, "line {line} at {}", rates[line]);
            }
        }
    }

    #[test]
    fn the_feedrate_changes_no_faster_than_the_machine_may() {
        let ends_mm = ellipse();
        let lines = DividedPath {
            ends_mm: &ends_mm,
            axes: &[AXIS; 2],
            period_s: 5.0 * SERVO_S,
        };
        let rates = lines.plan(&Settings {
            allowed_mm: 0.002,
            ..Settings::DEFAULT
        });
        for pair in rates.windows(2) {
            let [before, after] = [pair[0] * 50.0, pair[1] * 50.0];
            // 100 mm/s2 over a line of 0.25 mm; lines differ by 1 %.
            let change = (after * after - before * before).abs();
            assert!(change < 2.0 * 100.0 * 0.25 * 1.05, "{before} {after}");
        }
    }
}
