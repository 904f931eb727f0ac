//! The table of controllers: a name, what it is, where it comes from, and how it is made.
//!
//! Help texts, the comparison, docs and conformance tests iterate over [`CONTROLLERS`].
//!
//! | File | What |
//! |---|---|
//! | `controllers/parameters.rs` | what of them can be set, by name |
//! | `controllers/rows.rs` | the parameters of the rows |
//! | `controllers/setup.rs` | what they are made from: what is known of a machine, and a model |
//! | `controllers/closed_loop.rs` | the closed loop of an axis, for the filter that inverts it |
//! | `controllers/make.rs` | how each row is made from that |
//! | `controllers/model_predictive.rs`, `controllers/iterative_learning.rs` | those that are not fit for a servo thread |

pub mod parameters;
pub mod iterative_learning;
pub mod model_predictive;
mod closed_loop;
mod make;
mod rows;
mod setup;

use feedwright_control::Controller;
use feedwright_control::controller::disturbance_observer;
use feedwright_control::controller::open_loop::OpenLoop;
use feedwright_control::controller::{contour_compensation, fuzzy_feedrate};
use feedwright_control::identifier::IdentifierKind;
pub use make::correction_limits;
pub use parameters::{Parameter, Setting, SettingError};
use parameters::{Values, number};
use rows::{
    ACCELERATION_GAIN, ALLOWED, ALLOWED_FILTER, ALLOWED_SLOWEST, BEHIND_KD, BEHIND_KI, BEHIND_KP, CHANGE_WEIGHT,
    CROSS_COUPLED_KD, CROSS_COUPLED_KI, CROSS_COUPLED_KP, DRIFT, ETA, FORESEEN_MM, FRICTION_GAIN, IDENTIFIED_PRICE,
    INERTIA_SCALE, INNOVATION_SCALE_MM, INVERSION_KNOTS, INVERSION_PERIOD_S, INVERSION_STEPS, KNOTS, LAG_SCALE,
    LAST_WEIGHT, LEARNING_STEP, ON_RAPIDS, PLAN_PERIOD_S, PRICE, RATE_WEIGHT, RHO, SHAPED_DAMPING, SHAPED_FREQUENCY,
    SHAPER_IMPULSES, SOLVER_STEPS, TANGENTIAL_WEIGHT, TORQUE_NOISE, VELOCITY_GAIN,
};
use serde::{Deserialize, Serialize};
pub use setup::{ModelMisfit, NothingIdentified, Setup};

use crate::gcode::suggestion::nearest;
use crate::model::Model;

/// One row of the table.
pub struct Entry {
    /// Name on the command line.
    pub name: &'static str,
    /// What it does, in half a line.
    pub summary: &'static str,
    /// Author, year.
    pub source: &'static str,
    /// What it knows of the machine.
    pub knows: Knows,
    /// Which kind of identifier it uses, where it does.
    pub identifier: Option<IdentifierKind>,
    /// Laps of the same part that it cuts; all but the last are practice.
    pub laps: u32,
    /// What can be set; first what the comparison searches for the best of.
    pub parameters: &'static [Parameter],
    plane: Maker<2>,
    space: Maker<3>,
}

/// What a controller knows of the machine before it cuts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Knows {
    /// Nothing.
    Nothing,
    /// What was identified from a recording.
    Identified,
    /// The parameters of its model.
    ExactModel,
    /// Everything that can be: the parameters, and the statistics of all noise.
    Everything,
    /// What went wrong in earlier laps of the same part.
    EarlierLaps,
}

/// Makes a controller from a setup and the values of its parameters.
type Maker<const N: usize> = fn(&mut Setup<'_>, &Values) -> Box<dyn Controller<N>>;

/// A row. Its last part makes the controller for N axes, of what is known of the machine and the values of its parameters.
macro_rules! entry {
    ($name:literal, $summary:literal, $source:literal, $knows:ident $(($kind:ident))?, laps: $laps:literal, $parameters:expr, |$setup:ident, $values:ident| $make:expr) => {{
        fn make<const N: usize>($setup: &mut Setup<'_>, $values: &Values) -> Box<dyn Controller<N>> {
            $make
        }
        Entry {
            name: $name,
            summary: $summary,
            source: $source,
            knows: Knows::$knows,
            identifier: [$(IdentifierKind::$kind)?].first().copied(),
            laps: $laps,
            parameters: &$parameters,
            plane: make::<2>,
            space: make::<3>,
        }
    }};
}

/// All controllers.
pub const CONTROLLERS: &[Entry] = &[
    entry!(
        "open-loop",
        "the programmed path at the planned feed",
        "what every open-source control does",
        Nothing,
        laps: 1,
        [],
        |_setup, _values| Box::new(OpenLoop)
    ),
    entry!(
        "cross-coupled",
        "PID control of the contour error, added to the command across the path",
        "Koren (1980); Srinivasan and Kulkarni (1990)",
        Nothing,
        laps: 1,
        [CROSS_COUPLED_KP, CROSS_COUPLED_KI, CROSS_COUPLED_KD],
        |setup, values| make::cross_coupled(setup, values)
    ),
    entry!(
        "contour-compensation",
        "the reference moved by the estimated contour error",
        "Lee and Jeon (1999)",
        Nothing,
        laps: 1,
        [
            number(
                "rate_1_s",
                contour_compensation::Settings::DEFAULT.rate_1_s,
                [0.0, 1e4],
                Some([1.0, 3000.0]),
                "how fast the reference follows the error: small is late, large swings"
            ),
            number(
                "filter_s",
                contour_compensation::Settings::DEFAULT.filter_s,
                [1e-5, 10.0],
                Some([1e-4, 0.1]),
                "time constant of the filter on the error: long takes out noise, and is late"
            )
        ],
        |setup, values| make::contour_compensation(setup, values)
    ),
    entry!(
        "fuzzy-feedrate",
        "fuzzy rules on the contour error and its change, speed along the path only",
        "after Tsai and others (about 2003)",
        Nothing,
        laps: 1,
        [
            number(
                "error_mm",
                fuzzy_feedrate::Settings::DEFAULT.error_mm,
                [1e-4, 10.0],
                Some([0.002, 0.2]),
                "contour error that counts as large: small slows down for every error, large for none"
            ),
            number(
                "change_mm_s",
                fuzzy_feedrate::Settings::DEFAULT.change_mm_s,
                [1e-3, 1e3],
                Some([0.05, 20.0]),
                "change of the error that counts as large"
            ),
            number(
                "slowest",
                fuzzy_feedrate::Settings::DEFAULT.slowest,
                [0.05, 1.0],
                Some([0.2, 1.0]),
                "slowest it may run, as a part of the planned feedrate"
            )
        ],
        |setup, values| make::fuzzy_feedrate(setup, values)
    ),
    entry!(
        "cross-coupled-feedrate",
        "PID control of the contour error, and a feedrate that keeps it within what is allowed",
        "after Chuang and Liu (1991)",
        Nothing,
        laps: 1,
        [ALLOWED, ALLOWED_FILTER, ALLOWED_SLOWEST, CROSS_COUPLED_KP, CROSS_COUPLED_KI, CROSS_COUPLED_KD],
        |setup, values| make::cross_coupled_feedrate(setup, values)
    ),
    entry!(
        "feedforward",
        "velocity, acceleration and friction feedforward with the exact model of the machine",
        "Masory (1986); Armstrong-Helouvry, Dupont and Canudas de Wit (1994)",
        ExactModel,
        laps: 1,
        [VELOCITY_GAIN, ACCELERATION_GAIN, FRICTION_GAIN],
        |setup, values| make::feedforward(setup, values)
    ),
    entry!(
        "feedforward-as-delivered",
        "velocity and acceleration feedforward as controls are delivered, set to each axis; nothing of friction",
        "Masory (1986); FF1 and FF2 of LinuxCNC",
        ExactModel,
        laps: 1,
        [VELOCITY_GAIN, ACCELERATION_GAIN],
        |setup, values| make::feedforward_as_delivered(setup, values)
    ),
    entry!(
        "feedforward-cross-coupled",
        "velocity, acceleration and friction feedforward, and PID control of the contour error behind it",
        "Masory (1986); Koren (1980); Koren and Lo (1992)",
        ExactModel,
        laps: 1,
        [VELOCITY_GAIN, ACCELERATION_GAIN, FRICTION_GAIN, BEHIND_KP, BEHIND_KI, BEHIND_KD],
        |setup, values| make::feedforward_cross_coupled(setup, values)
    ),
    entry!(
        "input-shaping",
        "the path shaped so that a resonance is not excited, and feedforward of it with the exact model",
        "Singer and Seering (1990)",
        ExactModel,
        laps: 1,
        [SHAPED_FREQUENCY, SHAPED_DAMPING, SHAPER_IMPULSES],
        |setup, values| make::input_shaping(setup, values)
    ),
    entry!(
        "zero-phase",
        "zero phase error tracking control with the linear model of the machine",
        "Tomizuka (1987)",
        ExactModel,
        laps: 1,
        [LAG_SCALE, INERTIA_SCALE],
        |setup, values| make::zero_phase(setup, values)
    ),
    entry!(
        "zero-phase-friction",
        "zero phase error tracking control, and feedforward of the Coulomb friction",
        "Tomizuka (1987); Armstrong-Helouvry, Dupont and Canudas de Wit (1994)",
        ExactModel,
        laps: 1,
        [LAG_SCALE, INERTIA_SCALE, FRICTION_GAIN],
        |setup, values| make::zero_phase_friction(setup, values)
    ),
    entry!(
        "disturbance-observer",
        "velocity and acceleration feedforward, and an observer of friction and cutting force",
        "Ohnishi (1987)",
        ExactModel,
        laps: 1,
        [number(
            "bandwidth_hz",
            disturbance_observer::BANDWIDTH_HZ,
            [0.0, 1000.0],
            Some([1.0, 1000.0]),
            "of the observer: low is late at every reversal, high hands on the noise of the encoder; from 500 on the observer \
             believes what it measures, and hardly changes"
        )],
        |setup, values| make::disturbance_observer(setup, values)
    ),
    entry!(
        "kalman-disturbance",
        "velocity, acceleration and friction feedforward, and a Kalman filter whose disturbance is taken out",
        "Erkorkmaz and Altintas (2001)",
        ExactModel,
        laps: 1,
        [DRIFT, TORQUE_NOISE, FRICTION_GAIN],
        |setup, values| make::kalman_disturbance(setup, values)
    ),
    entry!(
        "model-predictive",
        "contouring over 20 knots ahead with the exact model of the machine, solved to convergence",
        "Lam, Manzie and Good (2010)",
        ExactModel,
        laps: 1,
        [Parameter { searched: Some([1e-11, 1e-2]), ..RATE_WEIGHT }, KNOTS, PLAN_PERIOD_S],
        |setup, values| make::model_predictive(setup, values)
    ),
    entry!(
        "lqg-preview",
        "the limit: Kalman filter and linear-quadratic regulator with preview, by everything that can be known of the machine",
        "Anderson and Moore (1990)",
        Everything,
        laps: 1,
        [PRICE],
        |setup, values| make::lqg_preview(setup, values)
    ),
    entry!(
        "iterative-learning-1",
        "offsets learned from the contour error of the same part, 1 lap of practice",
        "Arimoto, Kawamura and Miyazaki (1984)",
        EarlierLaps,
        laps: 2,
        iterative_learning::PARAMETERS,
        |setup, values| make::iterative_learning(setup, values)
    ),
    entry!(
        "iterative-learning-3",
        "offsets learned from the contour error of the same part, 3 laps of practice",
        "Arimoto, Kawamura and Miyazaki (1984)",
        EarlierLaps,
        laps: 4,
        iterative_learning::PARAMETERS,
        |setup, values| make::iterative_learning(setup, values)
    ),
    entry!(
        "iterative-learning-10",
        "offsets learned from the contour error of the same part, 10 laps of practice",
        "Arimoto, Kawamura and Miyazaki (1984)",
        EarlierLaps,
        laps: 11,
        iterative_learning::PARAMETERS,
        |setup, values| make::iterative_learning(setup, values)
    ),
    entry!(
        "magnitude-only",
        "inversion of the identifier, speed along the path only",
        "Yoon and Jeon (2000)",
        Identified(Contour),
        laps: 1,
        [RHO, ETA, INVERSION_STEPS, INVERSION_KNOTS, INVERSION_PERIOD_S, LEARNING_STEP],
        |setup, values| make::magnitude_only(setup, values)
    ),
    entry!(
        "two-dimensional",
        "inversion of the identifier, speed and geometry",
        "Lee, Cho and Jeon (2005)",
        Identified(Contour),
        laps: 1,
        [RHO, ETA, INVERSION_STEPS, INVERSION_KNOTS, INVERSION_PERIOD_S, LEARNING_STEP],
        |setup, values| make::two_dimensional(setup, values)
    ),
    entry!(
        "receding-horizon",
        "geometry planned over 20 knots ahead through an identified servo, speed as planned",
        "Lee, Cho and Jeon (2005), eq. 7 over a horizon; Gauss-Newton",
        Identified(Servo),
        laps: 1,
        [
            KNOTS,
            PLAN_PERIOD_S,
            RATE_WEIGHT,
            CHANGE_WEIGHT,
            TANGENTIAL_WEIGHT,
            LAST_WEIGHT,
            INNOVATION_SCALE_MM,
            FORESEEN_MM,
            SOLVER_STEPS,
            ON_RAPIDS
        ],
        |setup, values| make::receding_horizon(setup, values)
    ),
    entry!(
        "lqg-identified",
        "Kalman filter and linear-quadratic regulator with preview, by an identified law of each axis",
        "Anderson and Moore (1990); Gautier, Janot and Vandanjon (2013)",
        Identified(Axes),
        laps: 1,
        [IDENTIFIED_PRICE],
        |setup, values| make::lqg_identified(setup, values)
    ),
];

/// The best there is.
pub const BEST: &str = "lqg-identified";
/// The best of those that need nothing but a recording, and adapt while cutting.
pub const HORIZON: &str = "receding-horizon";
/// What others are compared against.
pub const BASELINE: &str = "open-loop";

/// What a user can choose.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Choices {
    /// Seed of the training.
    pub seed: u64,
    /// Parameters that were set, of any controller; the last of the same counts.
    pub set: Vec<Setting>,
}

impl Entry {
    /// Finds a row by its name.
    pub fn find(name: &str) -> Option<&'static Self> {
        CONTROLLERS.iter().find(|entry| entry.name == name)
    }

    /// A parameter by its name.
    pub fn parameter(&self, name: &str) -> Option<&'static Parameter> {
        self.parameters.iter().find(|parameter| parameter.name == name)
    }

    /// The parameters that the comparison searches for the best of, with the ranges.
    pub fn searched(&self) -> impl Iterator<Item = (&'static Parameter, [f64; 2])> + use<> {
        self.parameters.iter().filter_map(|parameter| Some((parameter, parameter.searched?)))
    }

    /// The controller of this row, with a model in place of a training.
    ///
    /// # Errors
    /// A model that does not suit it.
    pub fn make_with<'a, const N: usize>(
        &self,
        mut setup: Setup<'a>,
        model: &'a Model,
    ) -> Result<Box<dyn Controller<N>>, ModelMisfit>
    where
        Self: Make<N>,
    {
        setup.take(model, self, N)?;
        Ok(self.make(&mut setup))
    }

    /// The name that was probably meant by one that is none.
    pub fn meant_by(name: &str) -> Option<&'static str> {
        let names: Vec<&'static str> = CONTROLLERS.iter().map(|entry| entry.name).collect();
        nearest(name, &names)
    }
}

/// A number of axes that controllers exist for: 2 or 3.
pub trait Make<const N: usize> {
    /// The controller of this row.
    fn make(&self, setup: &mut Setup<'_>) -> Box<dyn Controller<N>>;
}

impl Make<2> for Entry {
    fn make(&self, setup: &mut Setup<'_>) -> Box<dyn Controller<2>> {
        (self.plane)(setup, &Values::of(self, &setup.choices.set))
    }
}

impl Make<3> for Entry {
    fn make(&self, setup: &mut Setup<'_>) -> Box<dyn Controller<3>> {
        (self.space)(setup, &Values::of(self, &setup.choices.set))
    }
}

/// By their names: there is one row of each.
impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl std::fmt::Debug for Entry {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}
