//! Receding-horizon inversion of the servo identifier: the geometry of the command is planned over many knots ahead.
//!
//! Each feed period: take in what the identifier missed ([`crate::identifier::adaptation`]), improve the plan by one step of
//! [`crate::horizon`], command its first step. The weights of the plan follow the quality of the predictions,
//!
//! ```text
//! w = w0 (1 + (sigma / s)^2)     d = d0 (sigma / s)^2     sigma: RMS innovation, s: Settings::sure_mm
//! ```
//!
//! so that a resonance which the identifier cannot represent is corrected gently. The speed along the path stays as planned.

use super::{Command, Controller, Measured, Schedule};
use crate::horizon::{self, MOST_KNOTS, Model, Plan, Response, Stretch};
use crate::identifier::adaptation::{self, Adaptation};
use crate::identifier::residual::Residual;
use crate::identifier::servo::{Delays, FOLLOWING_SCALE_MM, ServoIdentifier};
use crate::identifier::{FEED_SCALE_MM_S, Inputs};
use crate::vector::{add_scaled, norm, scale, sub};
use crate::window::Window;

/// Its feed period, s. Shorter foresees friction better, longer resonances: 2 ms is worse on a soft ball screw, 5 ms at every
/// reversal.
pub const FEED_PERIOD_S: f64 = 0.003;

/// Settings of the controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Servo periods in a feed period; 1 to 20.
    pub servo_periods: u32,
    /// The inversion.
    pub horizon: horizon::Settings,
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
            rate_weight: 1e-9,
            change_weight: 1e-8,
            tangential_price: 0.003,
            rate_limit_mm_s: 20.0,
        },
        adaptation: adaptation::Settings::DEFAULT,
        sure_mm: 1e-4,
    };
}

/// Receding-horizon inversion.
#[derive(Debug, Clone)]
pub struct RecedingHorizon<const N: usize> {
    net: Adaptation<N>,
    settings: Settings,
    plan: Plan<N>,
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

impl<const N: usize> RecedingHorizon<N> {
    /// With an identifier that is trained on a machine.
    pub fn new(net: ServoIdentifier<N>, settings: Settings) -> Self {
        Self {
            net: Adaptation::new(net, settings.adaptation),
            settings,
            plan: Plan::default(),
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
}

impl<const N: usize> Controller<N> for RecedingHorizon<N> {
    fn schedule(&self) -> Schedule {
        Schedule { servo_periods: self.settings.servo_periods, preview: self.settings.horizon.knots as u32 }
    }

    fn reset(&mut self) {
        self.plan.reset();
        self.net.reset();
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
        let model = Identified { net: self.net.net(), delays: self.delays, residual: self.net.residual() };
        let share = self.net.innovation_mm() / self.settings.sure_mm;
        let mut horizon = self.settings.horizon;
        horizon.rate_weight *= 1.0 + share * share;
        horizon.change_weight *= share * share;
        let step = self.plan.improve(&model, window, lag_s(window, measured), &horizon);
        let next = window.ahead(1);
        let offset_mm = step.offset_mm;
        let next_mm = add_scaled(next.position_mm, 1.0, offset_mm);
        let inputs = self.delays.inputs(feed(command_mm, next_mm, window.feed_period_s));
        let offset_mm_both = [window.offset_mm, offset_mm];
        let stretch = Stretch { knot: 0, command_mm: [command_mm, next_mm], offset_mm: offset_mm_both };
        let predicted_mm = sub(next_mm, model.clone().advance(window, &stretch));
        self.last = Some(Last { command_mm, inputs, predicted_mm });
        Command { rate: 1.0, offset_mm }
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
    residual: [Residual; N],
}

impl<const N: usize> Model<N> for Identified<'_, N> {
    fn lag_s(&self) -> f64 {
        self.net.lag_s()
    }

    #[inline]
    fn advance(&mut self, window: &Window<'_, N>, stretch: &Stretch<N>) -> [f64; N] {
        let [from_mm, to_mm] = stretch.command_mm;
        let feed = feed(from_mm, to_mm, window.feed_period_s);
        let missed = core::array::from_fn(|axis| self.residual[axis].foresee());
        let grown = add_scaled(self.net.predict(&self.delays.inputs(feed)), 1.0, missed);
        let error = add_scaled(self.delays.error[0], 1.0 / FOLLOWING_SCALE_MM, grown);
        self.delays.push(feed, error);
        add_scaled(to_mm, -FOLLOWING_SCALE_MM, error)
    }

    /// Of the linear part of the identifier.
    fn response(&self, period_s: f64, knots: usize) -> Response<N> {
        let mut response = [[[0.0; N]; N]; MOST_KNOTS];
        for axis in 0..N {
            let mut delays = Delays::<N>::REST;
            let mut feed = [0.0; N];
            feed[axis] = 1.0 / FEED_SCALE_MM_S;
            for at in response.iter_mut().take(knots) {
                let grown = self.net.predict_linear(&delays.inputs(feed));
                delays.push(feed, add_scaled(delays.error[0], 1.0 / FOLLOWING_SCALE_MM, grown));
                feed = [0.0; N];
                for tool in 0..N {
                    at[tool][axis] = -FOLLOWING_SCALE_MM * delays.error[0][tool];
                }
                at[axis][axis] += period_s;
            }
        }
        response
    }
}
