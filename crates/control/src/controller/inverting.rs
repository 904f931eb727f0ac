//! Common part of the controllers that invert the paper's identifier: they learn, invert, and turn
//! the result into a command.
//!
//! ```text
//! F(0)(k)   = (P*(tau + T) - P*(tau)) / T
//! F(k)      = F(0)(k) after at most five inversion steps, eqs 7 to 10
//! P'(k+1)   = P'(k) + F(k) T
//! ```
//!
//! Source: Lee, Cho and Jeon (2005), section 3 and Fig. 5. The anchoring of F(0) to the original
//! path keeps P' from drifting: the part of F - F(0) along F(0) changes the speed, and the part
//! across it changes the offset P' - P*; both affect nothing else.
//!
//! Departures: between two knots the command follows the path instead of its chord (at 50 mm/s, 10
//! ms and a radius of 10 mm the chord alone misses the path by 3 um); rates and offsets are
//! limited; offsets that lie along the path, or where the tool rests, leak away.

use core::marker::PhantomData;

use super::row::{Parameter, Values};
use super::{Controller, Schedule};
use crate::command::{Command, Measured, SelfReport};
use crate::identifier::contour::ContourIdentifier;
use crate::identifier::{ContourModel, Delays, FEED_SCALE_MM_S, Inputs, seen_feed};
use crate::inversion::{self, Gradient, MAX_KNOTS, TimeTerm};
use crate::model::TrainedModel;
use crate::supervisor::trial::CorrectionTrial;
use crate::vector::{add_scaled, bounded, dot, norm, scale, sub};
use crate::window::{PREVIEW_KNOTS, Window};

/// Settings of the controllers that invert the identifier.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InvertingSettings {
    /// Servo periods in a feed period; 1 to 100.
    pub servo_periods: u32,
    /// Knots that are inverted together; 1 to `MAX_KNOTS`, 1 is the paper's.
    pub knots: usize,
    /// The inversion.
    pub inversion: inversion::InversionSettings,
    /// Step of back-propagation while cutting, scaled units; 0 (frozen) to 0.5.
    pub learning_step: f64,
    /// Part of the offset along the path that is taken back in each feed period; 0 to 1. The paper
    /// has none.
    pub tangential_leak: f64,
    /// Slowest and fastest the controller may run, as a multiple of the planned feedrate.
    pub rate_range: [f64; 2],
}

impl InvertingSettings {
    /// Settings of the paper where it states them, of the prototype otherwise.
    pub const DEFAULT: Self = Self {
        servo_periods: 10,
        knots: 1,
        inversion: inversion::InversionSettings {
            rho: 0.001,
            eta: 0.3,
            steps: 5,
            step_limit: 0.1,
            gradient: Gradient::Printed,
            time_term: TimeTerm::Derivative,
        },
        tangential_leak: TANGENTIAL_LEAK,
        learning_step: 0.003,
        rate_range: [0.5, 1.2],
    };

    /// Parameters that can be set.
    pub(super) const PARAMETERS: &[Parameter] = &[
        RHO,
        ETA,
        INVERSION_STEPS,
        INVERSION_KNOTS,
        INVERSION_PERIOD_S,
        LEARNING_STEP,
    ];

    /// Creates the settings of these values, with the periods of a model.
    pub(super) fn of<const N: usize>(model: &TrainedModel<N>, values: Values<'_>) -> Self {
        let mut settings = Self {
            // A float that is not a number, or below zero, saturates to 0.
            servo_periods: (libm::round(model.feed_period_s / model.servo_s) as u32)
                .clamp(1, MOST_PERIODS),
            knots: values(&INVERSION_KNOTS) as usize,
            learning_step: values(&LEARNING_STEP),
            ..Self::DEFAULT
        };
        settings.inversion.rho = values(&RHO);
        settings.inversion.eta = values(&ETA);
        settings.inversion.steps = values(&INVERSION_STEPS) as usize;
        settings
    }
}

/// Servo periods between decisions that a link keeps commands for.
const MOST_PERIODS: u32 = 100;

const RHO: Parameter = Parameter::number(
    "rho",
    InvertingSettings::DEFAULT.inversion.rho,
    [0.0, 0.1],
    Some([1e-5, 0.1]),
    "weight of the machining time against the error: 0 looks at the error alone, more is faster and less accurate",
);
const ETA: Parameter = Parameter::number(
    "eta",
    InvertingSettings::DEFAULT.inversion.eta,
    [0.0, 10.0],
    Some([1e-3, 10.0]),
    "length of a gradient step: 0 inverts nothing; the paper takes 0.3",
);
const INVERSION_STEPS: Parameter = Parameter::whole(
    "steps",
    InvertingSettings::DEFAULT.inversion.steps,
    [1.0, 20.0],
    "gradient steps in a tick: the paper allows 5",
);
const INVERSION_KNOTS: Parameter = Parameter::whole(
    "knots",
    InvertingSettings::DEFAULT.knots,
    [1.0, 20.0],
    "knots that are inverted together: 1 is the paper's; with the printed gradient more change nothing",
);
/// Time between decisions, which the model of the controller was trained for.
pub const INVERSION_PERIOD_S: Parameter = Parameter::number(
    "feed_period_s",
    0.01,
    [1e-3, 0.012],
    None,
    "time between decisions: the paper's 10 ms",
)
.of_unit("s");
const LEARNING_STEP: Parameter = Parameter::number(
    "learning_step",
    InvertingSettings::DEFAULT.learning_step,
    [0.0, 0.5],
    None,
    "step of back-propagation while cutting: 0 keeps what was trained, large ones forget it",
);

/// Planned feedrate below which the machine follows the plan, mm/s: at rest there is no direction
/// for a correction.
const MIN_FEED_MM_S: f64 = 0.05;

/// Part of the offset along the path that is taken back in each feed period. Offsets arise across
/// the path. After a turn of the path, their part along it corrects nothing, and without this leak
/// the tool would end a circle of 10 mm radius a tenth of a millimeter short.
const TANGENTIAL_LEAK: f64 = 0.05;
/// Part of the offset that is taken back in each feed period at rest: a tool at rest has no error
/// to correct.
const REST_LEAK: f64 = 0.3;

/// Method of inversion, in which the members of the family differ.
pub trait Invert {
    /// Improves the F(0) of one or more knots, scaled, in place. `inputs` belong to the first knot.
    fn invert<const N: usize, D: ContourModel<N>>(
        net: &D,
        inputs: &Inputs<N>,
        feeds: &mut [[f64; N]],
        settings: &inversion::InversionSettings,
    );
}

/// A controller that inverts an identifier of the contour error, usually the paper's. Between ticks
/// it keeps the identifier, the delays, and its last inputs.
#[derive(Debug, Clone)]
pub struct Inverting<const N: usize, I, D = ContourIdentifier<N>> {
    trained: D,
    net: D,
    delays: Delays<N>,
    last: Option<Inputs<N>>,
    prediction_error_mm: f64,
    trial: Option<CorrectionTrial<N>>,
    /// Response time of the speed loops, s, if the correction has to pass a trial.
    tried_response_s: Option<f64>,
    settings: InvertingSettings,
    how: PhantomData<I>,
}

impl<const N: usize, I, D: ContourModel<N>> Inverting<N, I, D> {
    /// Creates a controller with an identifier that is trained on the machine. Each member of the
    /// family has its own public constructors.
    pub(super) fn new(
        trained: D,
        settings: InvertingSettings,
        tried_response_s: Option<f64>,
    ) -> Self {
        Self {
            net: trained.clone(),
            trained,
            delays: Delays::REST,
            last: None,
            prediction_error_mm: 0.0,
            trial: tried_response_s.map(CorrectionTrial::new),
            tried_response_s,
            settings,
            how: PhantomData,
        }
    }

    /// Returns the number of knots that are inverted together; all of them are within the preview.
    fn knots(&self) -> usize {
        let seen = PREVIEW_KNOTS / self.settings.servo_periods.max(1) as usize;
        self.settings.knots.min(seen).clamp(1, MAX_KNOTS)
    }
}

impl<const N: usize, I: Invert, D: ContourModel<N>> Controller<N> for Inverting<N, I, D> {
    fn schedule(&self) -> Schedule {
        Schedule {
            servo_periods: self.settings.servo_periods,
            preview: self.knots() as u32,
        }
    }

    fn reset(&mut self) {
        self.net.clone_from(&self.trained);
        self.delays = Delays::REST;
        self.last = None;
        self.prediction_error_mm = 0.0;
        self.trial = self.tried_response_s.map(CorrectionTrial::new);
    }

    /// Does one step of back-propagation on the last command and its result, then moves both into
    /// the delays. In a trial, the error is the one that the whole correction would have left, and
    /// the step is zero.
    fn observe(&mut self, window: &Window<'_, N>, measured: Option<&Measured<N>>) {
        let Some(measured) = measured else { return };
        let error_mm = self
            .trial
            .as_mut()
            .map_or(measured.contour.vector_mm, |trial| {
                trial.observe(window, measured)
            });
        if !norm(error_mm).is_finite() {
            return;
        }
        let is_followed = self.trial.as_ref().is_none_or(CorrectionTrial::is_whole);
        let step = if is_followed {
            self.settings.learning_step
        } else {
            0.0
        };
        if let Some(inputs) = self.last {
            let error = error_mm.map(|e| e / D::ERROR_SCALE_MM);
            let cost = self.net.learn(&inputs, error, step);
            self.prediction_error_mm = D::ERROR_SCALE_MM * libm::sqrt(2.0 * cost);
            // Like every feedrate, this one is converted to mm/s: the delays then hold the same
            // values as from a recording.
            let feed_mm_s = inputs.map(|axis| axis[0] * FEED_SCALE_MM_S);
            self.delays.push(seen_feed(feed_mm_s), error);
        }
    }

    fn report(&self) -> SelfReport<N> {
        SelfReport {
            missed_mm: self.prediction_error_mm,
            ..SelfReport::CORRECTS
        }
    }

    /// Inverts from the planned feedrate and turns the result into a rate and a new offset.
    fn command(&mut self, window: &Window<'_, N>, _: &Measured<N>) -> Command<N> {
        let offset_mm = self
            .trial
            .as_ref()
            .map_or(window.offset_mm, CorrectionTrial::wanted_mm);
        let wanted = self.wanted(window, offset_mm);
        self.trial
            .as_mut()
            .map_or(wanted, |trial| trial.follow(wanted))
    }
}

impl<const N: usize, I: Invert, D: ContourModel<N>> Inverting<N, I, D> {
    /// Returns the command that continues from an offset.
    fn wanted(&mut self, window: &Window<'_, N>, offset_mm: [f64; N]) -> Command<N> {
        let period_s = window.feed_period_s;
        let planned = scale(
            1.0 / period_s,
            sub(window.ahead(1).position_mm, window.now().position_mm),
        );
        let planned_feed = norm(planned);
        let inputs = self.delays.inputs(seen_feed(planned));
        if planned_feed < MIN_FEED_MM_S {
            self.last = Some(inputs);
            return Command::straight(1.0, scale(1.0 - REST_LEAK, offset_mm));
        }
        let mut feeds = [inputs.map(|axis| axis[0]); MAX_KNOTS];
        let feeds = &mut feeds[..self.knots()];
        for (knot, feed) in feeds.iter_mut().enumerate().skip(1) {
            let stretch_mm = sub(
                window.ahead(knot + 1).position_mm,
                window.ahead(knot).position_mm,
            );
            *feed = scale(1.0 / (period_s * FEED_SCALE_MM_S), stretch_mm);
        }
        I::invert(&self.net, &inputs, feeds, &self.settings.inversion);
        let direction = scale(1.0 / planned_feed, planned);
        let change = sub(feeds[0].map(|feed| feed * FEED_SCALE_MM_S), planned);
        let along = dot(change, direction);
        let across = add_scaled(change, -along, direction);
        let [slowest, fastest] = self.settings.rate_range;
        let rate = bounded(1.0 + along / planned_feed, slowest, fastest);
        let commanded = if window.preview.is_planned_elsewhere {
            1.0
        } else {
            rate
        };
        let feed = add_scaled(across, commanded, planned);
        self.last = Some(self.delays.inputs(seen_feed(feed)));
        let stale = self.settings.tangential_leak * dot(offset_mm, direction);
        Command::straight(
            rate,
            add_scaled(add_scaled(offset_mm, period_s, across), -stale, direction),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contour_error::ContourError;
    use crate::controller::two_dimensional::TwoDimensional;
    use crate::identifier::contour::tests::sample;
    use crate::window::{Knot, KnotSource, Preview, Register};

    /// The circle of eq. 11 at 50 mm/s.
    struct Circle;

    impl KnotSource<2> for Circle {
        fn knot(&mut self, tau_s: f64) -> Knot<2> {
            let (sin, cos) = (libm::sin(5.0 * tau_s), libm::cos(5.0 * tau_s));
            Knot {
                position_mm: [10.0 - 10.0 * cos, 10.0 * sin],
                tangent: [sin, cos],
                feed_mm_s: 50.0,
                cutting: true,
            }
        }
    }

    /// Twenty commands on a circle, each with an error after it.
    fn commands(knots: usize, gradient: Gradient) -> [Command<2>; 20] {
        let mut settings = InvertingSettings {
            knots,
            ..InvertingSettings::DEFAULT
        };
        settings.inversion.gradient = gradient;
        let mut controller = TwoDimensional::untried(sample().0, settings);
        let (mut register, mut preview) = (Register::default(), Preview::new(0.001));
        let mut offset_mm = [0.0; 2];
        core::array::from_fn(|k| {
            let tau_s = 0.01 * k as f64;
            register.push(Circle.knot(tau_s));
            preview.fill(
                &mut Circle,
                tau_s,
                0.01 * f64::from(controller.schedule().preview),
            );
            let window = Window {
                register: &register,
                preview: &preview,
                tau_s,
                feed_period_s: INVERSION_PERIOD_S.default,
                offset_mm,
                offset_mm_s: [0.0; 2],
            };
            let vector_mm = [0.02 * libm::sin(tau_s), 0.03];
            let measured = Measured {
                position_mm: sub(window.now().position_mm, vector_mm),
                contour: ContourError {
                    vector_mm,
                    ..ContourError::NONE
                },
            };
            controller.observe(&window, Some(&measured));
            let command = controller.command(&window, &measured);
            offset_mm = command.offset_mm;
            command
        })
    }

    #[test]
    fn with_the_printed_gradient_further_knots_change_nothing_and_with_the_exact_one_they_do() {
        assert_eq!(
            commands(1, Gradient::Printed),
            commands(5, Gradient::Printed)
        );
        let (one, five) = (commands(1, Gradient::Exact), commands(5, Gradient::Exact));
        assert!(
            one.iter()
                .zip(&five)
                .all(|(one, five)| one.offset_mm != five.offset_mm)
        );
    }

    #[test]
    fn asks_for_the_preview_of_its_knots_within_the_window() {
        let schedule = |servo_periods, knots| {
            TwoDimensional::untried(
                sample().0,
                InvertingSettings {
                    servo_periods,
                    knots,
                    ..InvertingSettings::DEFAULT
                },
            )
            .schedule()
            .preview
        };
        assert_eq!(
            [schedule(10, 1), schedule(10, 5), schedule(10, 99)],
            [1, 5, 20]
        );
        assert_eq!(
            [schedule(100, 20), schedule(10, 0), schedule(0, 3)],
            [2, 1, 3]
        );
    }
}
