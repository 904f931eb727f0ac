//! Receding-horizon inversion of the servo identifier: the geometry of the command is planned over many knots ahead.
//!
//! Each feed period: take the innovation (measured minus predicted following error) into the bias, improve the plan by
//! one step of [`crate::horizon`], command its first step. The speed along the path stays as planned.

use super::{Command, Controller, Measured, Schedule};
use crate::horizon::{self, Plan, State};
use crate::identifier::FEED_SCALE_MM_S;
use crate::identifier::servo::{Delays, FOLLOWING_SCALE_MM, ServoIdentifier};
use crate::vector::{add_scaled, dot, norm, scale, sub};
use crate::window::Window;

/// Its feed period, s: a quarter of the time constant of a position loop of 50 1/s.
pub const FEED_PERIOD_S: f64 = 0.005;

/// Settings of the controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Servo periods in a feed period; 1 to 20.
    pub servo_periods: u32,
    /// The inversion.
    pub horizon: horizon::Settings,
    /// Part of an innovation that goes into the bias; 0 (none) to 1.
    pub innovation_gain: f64,
    /// Part of the offset along the path that is taken back in each feed period; 0 to 1. Offsets are made across the
    /// path; where the path has turned since, what is left of them along it only shifts the tool in time.
    pub tangential_leak: f64,
}

impl Settings {
    /// Values that serve every shape and machine tried.
    pub const DEFAULT: Self = Self {
        servo_periods: 5,
        horizon: horizon::Settings { knots: 10, rate_weight: 1e-7, change_weight: 0.0, rate_limit_mm_s: 20.0 },
        innovation_gain: 0.3,
        tangential_leak: 0.05,
    };
}

/// Receding-horizon inversion.
#[derive(Debug, Clone)]
pub struct RecedingHorizon<const N: usize> {
    net: ServoIdentifier<N>,
    settings: Settings,
    plan: Plan<N>,
    delays: Delays<N>,
    bias_mm: [f64; N],
    missed_mm: f64,
    /// The command of the last knot, mm, and the following error predicted for this one.
    last: Option<Last<N>>,
}

#[derive(Debug, Clone, Copy)]
struct Last<const N: usize> {
    command_mm: [f64; N],
    predicted_mm: [f64; N],
}

impl<const N: usize> RecedingHorizon<N> {
    /// With an identifier that is trained on a machine.
    pub fn new(net: ServoIdentifier<N>, settings: Settings) -> Self {
        Self {
            net,
            settings,
            plan: Plan::default(),
            delays: Delays::REST,
            bias_mm: [0.0; N],
            missed_mm: 0.0,
            last: None,
        }
    }

    /// The feedrate between two commands, scaled.
    fn feed(from_mm: [f64; N], to_mm: [f64; N], period_s: f64) -> [f64; N] {
        scale(1.0 / (period_s * FEED_SCALE_MM_S), sub(to_mm, from_mm))
    }

    /// Takes in where the tool is now: delays and bias.
    fn take_in(&mut self, command_mm: [f64; N], measured: &Measured<N>, period_s: f64) {
        let following_mm = sub(command_mm, measured.position_mm);
        if !norm(following_mm).is_finite() {
            return;
        }
        let error = scale(1.0 / FOLLOWING_SCALE_MM, following_mm);
        match self.last {
            Some(last) => {
                let innovation = sub(following_mm, last.predicted_mm);
                self.missed_mm = norm(innovation);
                self.bias_mm = add_scaled(self.bias_mm, self.settings.innovation_gain, innovation);
                self.delays.push(Self::feed(last.command_mm, command_mm, period_s), error);
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
        self.delays = Delays::REST;
        self.bias_mm = [0.0; N];
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
        let state = State { delays: self.delays, bias_mm: self.bias_mm, lag_s: self.net.lag_s() };
        let step = self.plan.improve(&self.net, window, &state, &self.settings.horizon);
        let next = window.ahead(1);
        let along = dot(step.offset_mm, next.tangent);
        let offset_mm = add_scaled(step.offset_mm, -self.settings.tangential_leak * along, next.tangent);
        let next_mm = add_scaled(next.position_mm, 1.0, offset_mm);
        let inputs = self.delays.inputs(Self::feed(command_mm, next_mm, window.feed_period_s));
        let grown_mm = add_scaled(self.net.predict(&inputs), 1.0, self.bias_mm);
        let predicted_mm = add_scaled(grown_mm, FOLLOWING_SCALE_MM, self.delays.error[0]);
        self.last = Some(Last { command_mm, predicted_mm });
        Command { rate: 1.0, offset_mm }
    }
}
