//! Receding-horizon inversion of the servo identifier: plans the geometry of the command many knots
//! ahead.
//!
//! Each feed period the controller adapts the identifier to its last prediction error
//! (`adaptation`), improves the plan by one step of `horizon`, and
//! commands the first step of the plan. The weights of the plan follow the quality of the
//! predictions:
//!
//! ```text
//! w = w0 b     d = d0 b     h = h0 b^(1/2)     b = 1 + (sigma / s)^4
//!     sigma: RMS innovation
//!     s: RecedingHorizonSettings::innovation_scale_mm
//! q = (mu / m)^4 + (0.7 sigma / c)^4 + (z / 0.6)^4
//!     mu: largest prediction error several knots ahead
//!     m: RecedingHorizonSettings::foreseen_mm
//!     c: largest contour error over the horizon without any offset
//!     z: over-correction factor measured lately
//! ```
//!
//! The controller thus corrects gently where the identifier cannot represent a resonance. On a
//! machine that the identifier does not know it corrects less, down to nothing
//! (`horizon::missed`, [`Controller::judged`]). Because of the fourth power, the small
//! innovations of friction hardly change the weights. A machine that lags far behind has longer
//! knots, so that the plan reaches beyond the lag. The feedrate along the path stays as planned.

mod least_squares;
mod residual;
mod adaptation;
mod horizon;
mod predictor;

use feedwright_control::vector::{add_scaled, fourth_power, norm, scale, sub};
use feedwright_control::{
    Command, Controller, Delays, FaultEvidence, Measured, PREVIEW_KNOTS, Schedule, ServoIdentifier, ServoModel, Spread,
    Window,
};

use adaptation::Adaptation;
use horizon::missed::Missed;
use horizon::{LAGS_AHEAD, MAX_PERIODS};
use predictor::{IdentifiedPredictor, feed};

pub use horizon::gauss_newton::GaussNewton;
pub use horizon::problem::{END_WEIGHT, HorizonProblem};
pub use horizon::{
    Accelerations, CommandedPeriod, CorrectionLimits, HorizonSettings, MAX_KNOTS, OffsetPlan, Predictor, Sensitivity,
    Solver,
};
pub use residual::{DisturbanceForecast, Residual, ResidualSettings};

/// Knots change their length where the wanted length is further than this from the present, in feed periods: no change of
/// Decisions in a row in which harm is foreseen.
const FORESEEN_DECISIONS: u32 = 8;
/// Harm is foreseen where the mean square of the contour error over the horizon is beyond this many times that without the
/// correction, and this much, mm^2 (10 um).
const FORESEEN: f64 = 4.0;
const FORESEEN_MM2: f64 = 1e-4;
/// mind over noise.
const CLEARLY_OTHER: f64 = 0.7;

/// A measurement is an outlier if it misses its prediction by more than [`OUTLIER_MM`], mm, plus
/// [`OUTLIER`] times the RMS innovation. After [`MAX_OUTLIERS`] outliers in a row the controller
/// assumes that the machine has changed, and uses the measurement.
const OUTLIER_MM: f64 = 0.03;
const OUTLIER: f64 = 10.0;
const MAX_OUTLIERS: u32 = 3;
/// If the command has moved by more than this since the last decision, mm, and the position is the
/// same to the bit, the controller ignores the position. By then a tool that follows has moved by
/// more than one step of an encoder with a resolution of some micrometers.
const STILL_MM: f64 = 0.02;
/// A following error is strange where it is further than this, mm, and this part of it, from what the commands alone lead to: a
/// machine that is not yet known differs by less, a position that has leapt by more.
const STRANGE_MM: f64 = 0.2;
const STRANGE_SHARE: f64 = 0.3;
/// h at the most, however poor the predictions are.
const MAX_TANGENTIAL_WEIGHT: f64 = 0.1;
/// A correction is worth its offset where the contour error without it is beyond this part of the innovations.
const WORTHWHILE: f64 = 0.7;
/// A correction that was overdone by this much lately counts as much as a contour error.
const OVERDONE: f64 = 0.6;
/// A prediction that misses by this, mm, is a leap: no machine does so within a feed period.
const LEAP_MM: f64 = 0.3;

/// Settings of the controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecedingHorizonSettings<const N: usize> {
    /// Servo periods in a feed period; 1 to 20.
    pub servo_periods: u32,
    /// The inversion.
    pub horizon: HorizonSettings<N>,
    /// Steps of the solver in a tick; 1 is all that Gauss-Newton needs.
    pub steps: usize,
    /// Adaptation of the identifier.
    pub adaptation: adaptation::AdaptationSettings,
    /// Innovations of this size make the inversion half as sharp, mm; larger ones blunter still.
    pub innovation_scale_mm: f64,
    /// Predictions some knots ahead that miss by this make the offset count as much as a contour error, mm.
    pub foreseen_mm: f64,
}

impl<const N: usize> RecedingHorizonSettings<N> {
    /// Values that serve every shape and machine tried.
    pub const DEFAULT: Self = Self {
        servo_periods: 5,
        horizon: HorizonSettings {
            knots: 20,
            rate_weight: 3e-10,
            change_weight: 1e-10,
            offset_weight: 0.0,
            tangential_weight: 0.006,
            last_weight: 0.05,
            late_weight: 0.0,
            on_rapids: false,
            limits: CorrectionLimits::NONE,
        },
        steps: 1,
        adaptation: adaptation::AdaptationSettings::DEFAULT,
        innovation_scale_mm: 2e-4,
        foreseen_mm: 0.03,
    };
}

/// Receding-horizon inversion.
#[derive(Debug, Clone)]
pub struct RecedingHorizon<const N: usize, S = GaussNewton, D = ServoIdentifier<N>> {
    net: Adaptation<N, D>,
    settings: RecedingHorizonSettings<N>,
    plan: OffsetPlan<N, S>,
    periods: usize,
    /// The following error as it is measured; as it would be without measurement, from the commands alone; and the part of it
    /// that the offset makes.
    delays: Delays<N>,
    free: Delays<N>,
    response: Delays<N>,
    prediction_error_mm: f64,
    missed: Missed<N>,
    outliers: u32,
    /// Whether the position has leapt, and stayed there.
    leapt: bool,
    /// Mean squares of the contour error that the last plan foresees with its correction and without, mm^2, and decisions in a row in which that is
    /// harm.
    foreseen_mm2: [f64; 2],
    foreseen_harm: u32,
    /// Largest contour error over the horizon without any offset, mm.
    open_error_mm: f64,
    /// Over-correction factor measured lately: see [`Controller::judged`].
    overdone: f64,
    /// What was commanded and seen at the last decision, mm.
    last: Option<LastDecision<N>>,
}

#[derive(Debug, Clone, Copy)]
struct LastDecision<const N: usize> {
    command_mm: [f64; N],
    offset_mm: [f64; N],
    /// The last position that was news, mm.
    seen_mm: [f64; N],
}

impl<const N: usize, S: Solver<N>, D: ServoModel<N>> RecedingHorizon<N, S, D> {
    /// With an identifier that is trained on a machine, and how others of its kind differ.
    pub fn new(net: D, spread: &Spread<N>, settings: RecedingHorizonSettings<N>) -> Self {
        Self {
            net: Adaptation::new(net, spread, settings.adaptation),
            settings,
            plan: OffsetPlan::default(),
            periods: 1,
            delays: Delays::REST,
            free: Delays::REST,
            response: Delays::REST,
            prediction_error_mm: 0.0,
            missed: Missed::NONE,
            outliers: 0,
            leapt: false,
            foreseen_mm2: [0.0; 2],
            foreseen_harm: 0,
            open_error_mm: f64::INFINITY,
            overdone: 0.0,
            last: None,
        }
    }

    /// Takes in where the tool is now, and what was commanded on the way here: not what was asked for.
    fn take_in(&mut self, window: &Window<'_, N>, position_mm: Option<[f64; N]>) {
        let command_mm = add_scaled(window.now().position_mm, 1.0, window.offset_mm);
        let position_mm = position_mm.filter(|position_mm| !self.is_frozen(command_mm, *position_mm));
        let following_mm = position_mm.map(|position_mm| sub(command_mm, position_mm));
        let following_mm = following_mm.filter(|following_mm| norm(*following_mm).is_finite());
        let seen_mm = position_mm.or(self.last.map(|last| last.seen_mm)).unwrap_or(command_mm);
        let now = LastDecision { command_mm, offset_mm: window.offset_mm, seen_mm };
        let Some(last) = self.last else {
            if let Some(following_mm) = following_mm {
                self.delays.error = [scale(1.0 / D::ERROR_SCALE_MM, following_mm); 2];
                self.free = self.delays;
                self.last = Some(now);
            }
            return;
        };
        self.last = Some(now);
        let period_s = window.feed_period_s;
        let feed_now = feed(last.command_mm, command_mm, period_s);
        let inputs = self.delays.inputs(feed_now);
        let before_mm = scale(D::ERROR_SCALE_MM, self.delays.error[0]);
        let mut foreseen_mm = add_scaled(before_mm, 1.0, self.net.net().predict(&inputs));
        for (foreseen_mm, mut residual) in foreseen_mm.iter_mut().zip(self.net.residual()) {
            *foreseen_mm += residual.next_mm();
        }
        self.roll_free(feed_now, feed(last.offset_mm, window.offset_mm, period_s));
        let now_mm = match following_mm {
            Some(following_mm) if !self.is_outlier(following_mm, foreseen_mm) => {
                self.net.learn(&inputs, sub(following_mm, before_mm));
                following_mm
            }
            _ => foreseen_mm,
        };
        self.delays.push(feed_now, scale(1.0 / D::ERROR_SCALE_MM, now_mm));
    }

    /// Whether a position stands still while the command goes on. It is nothing to learn from before the supervisor, which has
    /// to wait for certainty, calls it lost.
    fn is_frozen(&self, command_mm: [f64; N], position_mm: [f64; N]) -> bool {
        let moved_mm = |last: LastDecision<N>| norm(sub(command_mm, last.command_mm));
        self.last.is_some_and(|last| position_mm == last.seen_mm && moved_mm(last) > STILL_MM)
    }

    /// The following error from the commands alone, and what the offset makes of it.
    fn roll_free(&mut self, feed: [f64; N], offset_feed: [f64; N]) {
        let grown = |delays: &Delays<N>, grown_mm| add_scaled(delays.error[0], 1.0 / D::ERROR_SCALE_MM, grown_mm);
        let error = grown(&self.free, self.net.net().predict(&self.free.inputs(feed)));
        self.free.push(feed, error);
        let error = grown(&self.response, self.net.net().predict_linear(&self.response.inputs(offset_feed)));
        self.response.push(offset_feed, error);
    }

    /// Whether a following error cannot be true: it misses the prediction by far more than any lately, for a few decisions. One
    /// that is far from what the commands alone lead to counts as missed, however steady it is.
    fn is_outlier(&mut self, following_mm: [f64; N], foreseen_mm: [f64; N]) -> bool {
        let surprise_mm = norm(sub(following_mm, foreseen_mm));
        let free_mm = scale(D::ERROR_SCALE_MM, self.free.error[0]);
        let strange_mm = norm(sub(following_mm, free_mm)) - STRANGE_SHARE * norm(free_mm) - STRANGE_MM;
        // Strange for good is also a machine that is not known yet: only what came with a leap is held against the position.
        self.leapt = (self.leapt || surprise_mm > LEAP_MM) && strange_mm > 0.0;
        self.prediction_error_mm = if self.leapt { surprise_mm.max(strange_mm) } else { surprise_mm };
        let outlier = self.prediction_error_mm > OUTLIER_MM + OUTLIER * self.net.innovation_mm();
        self.outliers = if outlier { self.outliers + 1 } else { 0 };
        outlier && self.outliers <= MAX_OUTLIERS
    }

    /// Compares where the tool is with where it was foreseen some knots ago.
    fn look_back(&mut self, window: &Window<'_, N>) {
        let command_mm = add_scaled(window.now().position_mm, 1.0, window.offset_mm);
        let tool_mm = add_scaled(command_mm, -D::ERROR_SCALE_MM, self.delays.error[0]);
        let open_mm = add_scaled(tool_mm, -1.0, self.response_mm());
        self.missed.look_back(open_mm, window.at(-self.net.net().lag_s()).tangent);
    }

    /// Displacement of the tool by the offset, mm, from the linear part of the identifier.
    fn response_mm(&self) -> [f64; N] {
        let offset_mm = self.last.map_or([0.0; N], |last| last.offset_mm);
        add_scaled(offset_mm, -D::ERROR_SCALE_MM, self.response.error[0])
    }

    /// The weights at the quality that the predictions have now.
    fn weighted(&self) -> HorizonSettings<N> {
        let blunter = 1.0 + fourth_power(self.net.innovation_mm() / self.settings.innovation_scale_mm);
        let mut horizon = self.settings.horizon;
        horizon.rate_weight *= blunter;
        horizon.change_weight *= blunter;
        // A tool that is not foreseen well is held to its time: what is free along the path is as wrong as the prediction.
        let held = horizon.tangential_weight * libm::sqrt(blunter);
        horizon.tangential_weight = held.min(MAX_TANGENTIAL_WEIGHT);
        horizon.offset_weight += fourth_power(self.missed.largest_mm() / self.settings.foreseen_mm);
        // Where there is hardly more to gain than the predictions miss by, nothing is.
        let lost = WORTHWHILE * self.net.innovation_mm() / self.open_error_mm.max(f64::MIN_POSITIVE);
        horizon.offset_weight += fourth_power(lost) + fourth_power(self.overdone.max(0.0) / OVERDONE);
        horizon
    }

    /// Feed periods of a knot, so that the plan reaches beyond the lag and stays within the preview.
    fn periods(&self, period_s: f64) -> usize {
        let knots = self.settings.horizon.knots();
        let most = (PREVIEW_KNOTS / (knots * self.settings.servo_periods.max(1) as usize)).clamp(1, MAX_PERIODS);
        let wanted = LAGS_AHEAD * self.net.net().lag_s() / (knots as f64 * period_s);
        if (wanted - self.periods as f64).abs() < CLEARLY_OTHER {
            return self.periods.min(most);
        }
        // A float that is too large, or not a number, saturates here.
        (libm::round(wanted) as usize).min(most).max(1)
    }
}

impl<const N: usize, S: Solver<N>, D: ServoModel<N>> Controller<N> for RecedingHorizon<N, S, D> {
    fn schedule(&self) -> Schedule {
        let servo_periods = self.settings.servo_periods.max(1);
        let preview = (self.settings.horizon.knots * MAX_PERIODS).min(PREVIEW_KNOTS / servo_periods as usize);
        Schedule { servo_periods, preview: preview as u32 }
    }

    fn reset(&mut self) {
        self.plan.reset();
        self.net.reset();
        self.periods = 1;
        self.delays = Delays::REST;
        self.free = Delays::REST;
        self.response = Delays::REST;
        self.prediction_error_mm = 0.0;
        self.missed = Missed::NONE;
        self.outliers = 0;
        self.leapt = false;
        (self.foreseen_mm2, self.foreseen_harm) = ([0.0; 2], 0);
        self.open_error_mm = f64::INFINITY;
        self.overdone = 0.0;
        self.last = None;
    }

    fn observe(&mut self, window: &Window<'_, N>, measured: Option<&Measured<N>>) {
        self.take_in(window, measured.map(|measured| measured.position_mm));
        self.look_back(window);
        if measured.is_none() {
            self.plan.reset();
        }
    }

    fn moved_mm(&self) -> Option<[f64; N]> {
        Some(self.response_mm())
    }

    fn judged(&mut self, overdone: f64) {
        self.overdone = overdone;
    }

    /// Infinite where harm is foreseen.
    fn prediction_error_mm(&self) -> f64 {
        if self.foreseen_harm < FORESEEN_DECISIONS { self.prediction_error_mm } else { f64::INFINITY }
    }

    fn doubt(&self) -> Option<FaultEvidence> {
        let [with_mm2, without_mm2] = self.foreseen_mm2;
        let limit_mm = allowed_mm2(without_mm2).sqrt();
        (self.foreseen_harm >= FORESEEN_DECISIONS).then(|| FaultEvidence { found_mm: with_mm2.sqrt(), limit_mm })
    }

    fn command(&mut self, window: &Window<'_, N>, _: &Measured<N>) -> Command<N> {
        self.periods = self.periods(window.feed_period_s);
        let horizon = self.weighted();
        let model = IdentifiedPredictor::new(&self.net, self.delays, self.response);
        self.plan.shift(self.periods, &horizon);
        let mut step = self.plan.improve(&model, window, &horizon);
        for _ in 1..self.settings.steps {
            step = self.plan.improve(&model, window, &horizon);
        }
        self.foreseen_mm2 = step.contour_mm2;
        let [with_mm2, without_mm2] = step.contour_mm2;
        self.foreseen_harm = if with_mm2 > allowed_mm2(without_mm2) { self.foreseen_harm + 1 } else { 0 };
        self.open_error_mm = step.open_error_mm;
        self.missed.foresee(self.periods, step.open_mm);
        Command::accelerated(window, window.offset_mm_s, step.acceleration_mm_s2)
    }
}

/// The mean square that is no harm yet, where so much is foreseen without the correction, mm^2.
fn allowed_mm2(without_mm2: f64) -> f64 {
    FORESEEN_MM2 + FORESEEN * without_mm2
}
