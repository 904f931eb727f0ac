//! Receding-horizon inversion of the servo identifier: the geometry of the command is planned over many knots ahead.
//!
//! Each feed period: take in what the identifier missed ([`crate::identifier::adaptation`]), improve the plan by one step of
//! [`crate::horizon`], command its first step. The weights of the plan follow the quality of the predictions,
//!
//! ```text
//! w = w0 b     d = d0 b     h = h0 b^(1/4)     b = 1 + (sigma / s)^4     sigma: RMS innovation, s: Settings::sure_mm
//! ```
//!
//! so that a resonance which the identifier cannot represent is corrected gently; the fourth power leaves the small
//! innovations of friction alone. A machine that lags far behind has longer knots, so that the plan reaches beyond the lag.
//! The speed along the path stays as planned.

use super::{Command, Controller, Measured, Schedule};
use crate::horizon::gauss_newton::GaussNewton;
use crate::horizon::{self, Felt, MOST_KNOTS, MOST_PERIODS, Model, Plan, Solver, Stretch};
use crate::identifier::adaptation::{self, Adaptation, Spread};
use crate::identifier::residual::Foresight;
use crate::identifier::servo::{Delays, FOLLOWING_SCALE_MM, ServoIdentifier};
use crate::identifier::{FEED_SCALE_MM_S, Inputs};
use crate::vector::{add_scaled, norm, scale, sub};
use crate::window::{PREVIEW_KNOTS, Window};

/// Its feed period, s. Shorter foresees friction better, longer resonances: 2 ms is worse on a soft ball screw, 5 ms at every
/// reversal.
pub const FEED_PERIOD_S: f64 = 0.003;

/// How many times the lag of the machine the horizon reaches ahead: what is commanded later hardly moves the tool that is
/// foreseen now.
const REACH: f64 = 2.0;
/// Knots change their length where the wanted length is further than this from the present, in feed periods: no change of
/// mind over noise.
const CLEARLY_OTHER: f64 = 0.7;

/// Settings of the controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Servo periods in a feed period; 1 to 20.
    pub servo_periods: u32,
    /// The inversion.
    pub horizon: horizon::Settings,
    /// Steps of the solver in a tick; 1 is all that Gauss-Newton needs.
    pub steps: usize,
    /// Adaptation of the identifier.
    pub adaptation: adaptation::Settings,
    /// Innovations of this size make the inversion half as sharp, mm; larger ones blunter still.
    pub sure_mm: f64,
}

impl Settings {
    /// Values that serve every shape and machine tried.
    pub const DEFAULT: Self = Self {
        servo_periods: 5,
        horizon: horizon::Settings {
            knots: 16,
            rate_weight: 3e-10,
            change_weight: 1e-10,
            tangential_price: 0.002,
            rate_limit_mm_s: 1000.0,
        },
        steps: 1,
        adaptation: adaptation::Settings::DEFAULT,
        sure_mm: 2e-4,
    };
}

/// Receding-horizon inversion.
#[derive(Debug, Clone)]
pub struct RecedingHorizon<const N: usize, S = GaussNewton> {
    net: Adaptation<N>,
    settings: Settings,
    plan: Plan<N, S>,
    periods: usize,
    delays: Delays<N>,
    missed_mm: f64,
    /// The command of the last knot, mm, and the following error that was foreseen for this one.
    last: Option<Last<N>>,
}

#[derive(Debug, Clone, Copy)]
struct Last<const N: usize> {
    command_mm: [f64; N],
    inputs: Inputs<N>,
    predicted_mm: [f64; N],
}

impl<const N: usize, S: Solver<N>> RecedingHorizon<N, S> {
    /// With an identifier that is trained on a machine, and how others of its kind differ.
    pub fn new(net: ServoIdentifier<N>, spread: &Spread<N>, settings: Settings) -> Self {
        Self {
            net: Adaptation::new(net, spread, settings.adaptation),
            settings,
            plan: Plan::default(),
            periods: 1,
            delays: Delays::REST,
            missed_mm: 0.0,
            last: None,
        }
    }

    /// Takes in where the tool is now.
    fn take_in(&mut self, command_mm: [f64; N], measured: &Measured<N>, period_s: f64) {
        let following_mm = sub(command_mm, measured.position_mm);
        if !norm(following_mm).is_finite() {
            return;
        }
        let error = scale(1.0 / FOLLOWING_SCALE_MM, following_mm);
        match self.last {
            Some(last) => {
                let before_mm = scale(FOLLOWING_SCALE_MM, self.delays.error[0]);
                self.net.learn(&last.inputs, sub(following_mm, before_mm));
                self.missed_mm = norm(sub(following_mm, last.predicted_mm));
                self.delays.push(feed(last.command_mm, command_mm, period_s), error);
            }
            None => self.delays.error = [error; 2],
        }
    }

    /// The weights at the quality that the predictions have now.
    fn weighted(&self) -> horizon::Settings {
        let share = self.net.innovation_mm() / self.settings.sure_mm;
        let blunter = 1.0 + share * share * share * share;
        let mut horizon = self.settings.horizon;
        horizon.rate_weight *= blunter;
        horizon.change_weight *= blunter;
        horizon.tangential_price = (horizon.tangential_price * libm::sqrt(libm::sqrt(blunter))).min(1.0);
        horizon
    }

    /// Feed periods of a knot, so that the plan reaches beyond the lag and stays within the preview.
    fn periods(&self, period_s: f64) -> usize {
        let knots = self.settings.horizon.knots.max(1);
        let most = PREVIEW_KNOTS / (knots * self.settings.servo_periods.max(1) as usize);
        let wanted = REACH * self.net.net().lag_s() / (knots as f64 * period_s);
        if (wanted - self.periods as f64).abs() < CLEARLY_OTHER {
            return self.periods.min(most.max(1));
        }
        // A float that is too large, or not a number, saturates here.
        (libm::round(wanted) as usize).clamp(1, MOST_PERIODS.min(most.max(1)))
    }
}

impl<const N: usize, S: Solver<N>> Controller<N> for RecedingHorizon<N, S> {
    fn schedule(&self) -> Schedule {
        let servo_periods = self.settings.servo_periods.max(1);
        let preview = (self.settings.horizon.knots * MOST_PERIODS).min(PREVIEW_KNOTS / servo_periods as usize);
        Schedule { servo_periods, preview: preview as u32 }
    }

    fn reset(&mut self) {
        self.plan.reset();
        self.net.reset();
        self.periods = 1;
        self.delays = Delays::REST;
        self.missed_mm = 0.0;
        self.last = None;
    }

    fn observe(&mut self, _: &Measured<N>) {}

    fn missed_mm(&self) -> f64 {
        self.missed_mm
    }

    fn command(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N> {
        let command_mm = add_scaled(window.now().position_mm, 1.0, window.offset_mm);
        self.take_in(command_mm, measured, window.feed_period_s);
        self.periods = self.periods(window.feed_period_s);
        let horizon = self.weighted();
        let lag_s = lag_s(window, measured);
        let mut model = Identified::new(&self.net, self.delays);
        self.plan.shift(self.periods, &horizon);
        let mut step = self.plan.improve(&model, window, lag_s, &horizon);
        for _ in 1..self.settings.steps {
            step = self.plan.improve(&model, window, lag_s, &horizon);
        }
        let next = Stretch::next(window, step.offset_mm);
        let next_mm = next.command_mm[1];
        let inputs = self.delays.inputs(feed(command_mm, next_mm, window.feed_period_s));
        let predicted_mm = sub(next_mm, model.advance(window, &next, &mut [[0.0; N]; MOST_KNOTS]));
        self.last = Some(Last { command_mm, inputs, predicted_mm });
        Command { rate: 1.0, offset_mm: step.offset_mm }
    }
}

/// How far the tool is behind the command now, s.
pub fn lag_s<const N: usize>(window: &Window<'_, N>, measured: &Measured<N>) -> f64 {
    f64::from(-measured.contour.index) * window.servo_s()
}

/// The feedrate between two commands, scaled.
#[inline]
fn feed<const N: usize>(from_mm: [f64; N], to_mm: [f64; N], period_s: f64) -> [f64; N] {
    scale(1.0 / (period_s * FEED_SCALE_MM_S), sub(to_mm, from_mm))
}

/// The identified servo as a model of the machine.
#[derive(Debug, Clone)]
struct Identified<'a, const N: usize> {
    net: &'a ServoIdentifier<N>,
    delays: Delays<N>,
    residual: [Foresight; N],
    /// Derivative of the following error, scaled, to the rate of each knot, s: now and one feed period ago.
    slopes: [[[f64; N]; MOST_KNOTS]; 2],
}

impl<'a, const N: usize> Identified<'a, N> {
    fn new(net: &'a Adaptation<N>, delays: Delays<N>) -> Self {
        Self { net: net.net(), delays, residual: net.residual(), slopes: [[[0.0; N]; MOST_KNOTS]; 2] }
    }

    /// The derivative moves on as the following error does, along the slopes of the identifier.
    #[inline]
    fn advance_slopes(&mut self, slopes: &Inputs<N>, period_s: f64, stretch: &Stretch<N>, felt: &mut Felt<N>) {
        let [now, before] = &mut self.slopes;
        for knot in 0..=stretch.knot() {
            let moved_s = (stretch.elapsed(knot) + 1).min(stretch.periods_per_knot) as f64 * period_s;
            // F(k), F(k-1) and F(k-2) are of this knot, or not.
            let of_it = [0, 1, 2].map(|back| if stretch.was_in(knot, back) { 1.0 / FEED_SCALE_MM_S } else { 0.0 });
            for axis in 0..N {
                let [f0, f1, f2, e0, e1] = slopes[axis];
                let grown_mm =
                    f0 * of_it[0] + f1 * of_it[1] + f2 * of_it[2] + e0 * now[knot][axis] + e1 * before[knot][axis];
                before[knot][axis] = now[knot][axis];
                now[knot][axis] += grown_mm / FOLLOWING_SCALE_MM;
                felt[knot][axis] = moved_s - FOLLOWING_SCALE_MM * now[knot][axis];
            }
        }
    }
}

impl<const N: usize> Model<N> for Identified<'_, N> {
    fn lag_s(&self) -> f64 {
        self.net.lag_s()
    }

    #[inline]
    fn advance(&mut self, window: &Window<'_, N>, stretch: &Stretch<N>, felt: &mut Felt<N>) -> [f64; N] {
        let [from_mm, to_mm] = stretch.command_mm;
        let feed = feed(from_mm, to_mm, window.feed_period_s);
        let (mut grown_mm, slopes) = self.net.predict_with_slopes(&self.delays.inputs(feed));
        for axis in 0..N {
            grown_mm[axis] += self.residual[axis].next_mm();
        }
        self.advance_slopes(&slopes, window.feed_period_s, stretch, felt);
        let error = add_scaled(self.delays.error[0], 1.0 / FOLLOWING_SCALE_MM, grown_mm);
        self.delays.push(feed, error);
        add_scaled(to_mm, -FOLLOWING_SCALE_MM, error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identifier::adaptation::UNKNOWNS;
    use crate::window::{Knot, Preview, Reference, Register};

    struct Line;

    impl Reference<2> for Line {
        fn knot(&mut self, tau_s: f64) -> Knot<2> {
            Knot { position_mm: [40.0 * tau_s, 30.0 * tau_s], tangent: [0.8, 0.6], feed_mm_s: 50.0 }
        }
    }

    /// A servo like tnv40's, and hidden nodes that are far from saturated, half of them for each axis.
    fn net() -> ServoIdentifier<2> {
        let mut net = ServoIdentifier::IDEAL;
        for axis in 0..2 {
            net.linear[axis][axis] = [0.149, -0.082, 0.001, 0.49, -0.56];
            for node in (axis..crate::identifier::HIDDEN).step_by(2) {
                net.output[axis][node] = 1e-3 * (node as f64 - 5.0);
                for input in 0..crate::identifier::INPUTS {
                    net.hidden[axis][input][node] = 0.3 * libm::sin((7 * axis + 3 * input + node) as f64);
                }
            }
        }
        net
    }

    /// The tool at the end of each knot and its derivative.
    fn roll_out(window: &Window<'_, 2>, rates: &[f64; 4], periods: usize) -> [([f64; 2], Felt<2>); 4] {
        let spread = [[[0.0; UNKNOWNS]; UNKNOWNS]; 2];
        let adaptation = Adaptation::new(net(), &spread, adaptation::Settings::DEFAULT);
        let mut model = Identified::new(&adaptation, Delays { feed: [[0.8, 0.6]; 2], error: [[0.8, 0.6]; 2] });
        let mut stretch = Stretch { period: 0, periods_per_knot: periods, ..Stretch::next(window, [0.0; 2]) };
        stretch.command_mm[1] = stretch.command_mm[0];
        core::array::from_fn(|knot| {
            let (mut tool_mm, mut felt) = ([0.0; 2], [[0.0; 2]; MOST_KNOTS]);
            for _ in 0..periods {
                let offset_mm = add_scaled(stretch.offset_mm[1], window.feed_period_s, [rates[knot]; 2]);
                let path_mm = window.ahead(stretch.period + 1).position_mm;
                stretch.offset_mm = [stretch.offset_mm[1], offset_mm];
                stretch.command_mm = [stretch.command_mm[1], add_scaled(path_mm, 1.0, offset_mm)];
                tool_mm = model.advance(window, &stretch, &mut felt);
                stretch.period += 1;
            }
            (tool_mm, felt)
        })
    }

    #[test]
    fn what_the_tool_feels_is_the_derivative_of_the_roll_out_whatever_the_length_of_a_knot() {
        let (mut register, mut preview) = (Register::default(), Preview::new(0.001));
        register.push(Line.knot(0.0));
        preview.fill(&mut Line, 0.0, 0.1);
        let window =
            Window { register: &register, preview: &preview, tau_s: 0.0, feed_period_s: 0.003, offset_mm: [0.0; 2] };
        let rates = [3.0, -2.0, 5.0, 1.0];
        for periods in 1..=3 {
            let found = roll_out(&window, &rates, periods);
            for j in 0..4 {
                let step = 1e-3;
                let (mut more, mut less) = (rates, rates);
                (more[j], less[j]) = (rates[j] + step, rates[j] - step);
                let (more, less) = (roll_out(&window, &more, periods), roll_out(&window, &less, periods));
                for i in 0..4 {
                    for axis in 0..2 {
                        let felt = if j <= i { found[i].1[j][axis] } else { 0.0 };
                        let slope = (more[i].0[axis] - less[i].0[axis]) / (2.0 * step);
                        assert!(
                            (felt - slope).abs() < 1e-6 * window.feed_period_s,
                            "{periods} {i} {j} {axis}: {felt} {slope}"
                        );
                    }
                }
            }
        }
    }
}
