//! The table of controllers: a name, what it is, where it comes from, and how it is made.
//!
//! Help texts, the comparison, docs and conformance tests iterate over [`CONTROLLERS`].
//!
//! | File | What |
//! |---|---|
//! | `controllers/make.rs` | how each row is made for a machine |
//! | `controllers/model_predictive.rs`, `controllers/iterative_learning.rs` | those that are not fit for a servo thread |

pub mod iterative_learning;
mod make;
pub mod model_predictive;

use feedwright_control::Controller;
use feedwright_control::controller::feedforward::Gains;
use feedwright_control::controller::inverting::Settings as Inverting;
use feedwright_control::controller::{contour_compensation, cross_coupled, fuzzy_feedrate, receding_horizon};
pub use make::correction_limits;
use serde::Serialize;

use crate::gcode::suggestion::nearest;
use crate::machine::Machine;

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
    /// Laps of the same part that it cuts; all but the last are practice.
    pub laps: u32,
    /// What can be tuned.
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
    /// What went wrong in earlier laps of the same part.
    EarlierLaps,
}

/// Makes a controller from a setup and the values of its parameters.
type Maker<const N: usize> = fn(&mut Setup<'_>, &[f64]) -> Box<dyn Controller<N>>;

/// Something that can be tuned.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Parameter {
    /// Name, with its unit at the end.
    pub name: &'static str,
    /// Range in which values make sense; searched by ratios where it begins above zero.
    pub range: [f64; 2],
    /// Value where none is given.
    pub default: f64,
}

const fn parameter(name: &'static str, range: [f64; 2], default: f64) -> Parameter {
    Parameter { name, range, default }
}

/// A row from a function of `make` that is generic over the number of axes.
macro_rules! entry {
    ($name:literal, $summary:literal, $source:literal, $knows:ident, laps: $laps:literal, [$($parameter:expr),*], $make:ident) => {
        Entry {
            name: $name,
            summary: $summary,
            source: $source,
            knows: Knows::$knows,
            laps: $laps,
            parameters: &[$($parameter),*],
            plane: make::$make::<2>,
            space: make::$make::<3>,
        }
    };
}

// Of those that invert the paper's identifier.
const RHO: Parameter = parameter("rho", [1e-5, 0.1], Inverting::DEFAULT.inversion.rho);
const ETA: Parameter = parameter("eta", [1e-3, 10.0], Inverting::DEFAULT.inversion.eta);
// Of the horizon, solved to convergence.
const RATE_WEIGHT: Parameter =
    parameter("rate_weight_s2", [1e-11, 1e-4], receding_horizon::Settings::DEFAULT.horizon.rate_weight);
// Parts of what the exact model calls for, and scales of its parameters.
const VELOCITY_GAIN: Parameter = parameter("velocity_gain", [0.5, 1.5], Gains::EXACT.velocity);
const ACCELERATION_GAIN: Parameter = parameter("acceleration_gain", [0.0, 2.0], Gains::EXACT.acceleration);
const FRICTION_GAIN: Parameter = parameter("friction_gain", [0.0, 2.0], Gains::EXACT.friction);
const LAG_SCALE: Parameter = parameter("lag_scale", [0.5, 1.5], 1.0);
const INERTIA_SCALE: Parameter = parameter("inertia_scale", [0.5, 2.0], 1.0);

/// All controllers.
pub const CONTROLLERS: &[Entry] = &[
    entry!(
        "open-loop",
        "the programmed path at the planned feed",
        "what every open-source control does",
        Nothing,
        laps: 1,
        [],
        open_loop
    ),
    entry!(
        "cross-coupled",
        "PID control of the contour error, added to the command across the path",
        "Koren (1980); Srinivasan and Kulkarni (1990)",
        Nothing,
        laps: 1,
        // Beyond these gains the loop is still stable on smooth paths, but catches the tool in acute corners.
        [
            parameter("kp", [0.1, 8.0], cross_coupled::Settings::DEFAULT.kp),
            parameter("ki_1_s", [1.0, 400.0], cross_coupled::Settings::DEFAULT.ki_1_s),
            parameter("kd_s", [1e-4, 0.03], cross_coupled::Settings::DEFAULT.kd_s)
        ],
        cross_coupled
    ),
    entry!(
        "contour-compensation",
        "the reference moved by the estimated contour error",
        "Lee and Jeon (1999)",
        Nothing,
        laps: 1,
        [
            parameter("rate_1_s", [1.0, 300.0], contour_compensation::Settings::DEFAULT.rate_1_s),
            parameter("filter_s", [1e-4, 0.1], contour_compensation::Settings::DEFAULT.filter_s)
        ],
        contour_compensation
    ),
    entry!(
        "fuzzy-feedrate",
        "fuzzy rules on the contour error and its change, speed along the path only",
        "after Tsai and others (about 2003)",
        Nothing,
        laps: 1,
        [
            parameter("error_mm", [0.002, 0.2], fuzzy_feedrate::Settings::DEFAULT.error_mm),
            parameter("change_mm_s", [0.05, 20.0], fuzzy_feedrate::Settings::DEFAULT.change_mm_s),
            parameter("slowest", [0.2, 1.0], fuzzy_feedrate::Settings::DEFAULT.slowest)
        ],
        fuzzy_feedrate
    ),
    entry!(
        "feedforward",
        "velocity, acceleration and friction feedforward with the exact model of the machine",
        "Masory (1986); Armstrong-Helouvry, Dupont and Canudas de Wit (1994)",
        ExactModel,
        laps: 1,
        [VELOCITY_GAIN, ACCELERATION_GAIN, FRICTION_GAIN],
        feedforward
    ),
    entry!(
        "zero-phase",
        "zero phase error tracking control with the linear model of the machine",
        "Tomizuka (1987)",
        ExactModel,
        laps: 1,
        [LAG_SCALE, INERTIA_SCALE],
        zero_phase
    ),
    entry!(
        "model-predictive",
        "contouring over 20 knots ahead with the exact model of the machine, solved to convergence",
        "Lam, Manzie and Good (2010)",
        ExactModel,
        laps: 1,
        [RATE_WEIGHT],
        model_predictive
    ),
    entry!(
        "iterative-learning-1",
        "offsets learned from the contour error of the same part, 1 lap of practice",
        "Arimoto, Kawamura and Miyazaki (1984)",
        EarlierLaps,
        laps: 2,
        [iterative_learning::GAIN, iterative_learning::LEAD_S, iterative_learning::CUT_OFF_HZ],
        iterative_learning
    ),
    entry!(
        "iterative-learning-3",
        "offsets learned from the contour error of the same part, 3 laps of practice",
        "Arimoto, Kawamura and Miyazaki (1984)",
        EarlierLaps,
        laps: 4,
        [iterative_learning::GAIN, iterative_learning::LEAD_S, iterative_learning::CUT_OFF_HZ],
        iterative_learning
    ),
    entry!(
        "iterative-learning-10",
        "offsets learned from the contour error of the same part, 10 laps of practice",
        "Arimoto, Kawamura and Miyazaki (1984)",
        EarlierLaps,
        laps: 11,
        [iterative_learning::GAIN, iterative_learning::LEAD_S, iterative_learning::CUT_OFF_HZ],
        iterative_learning
    ),
    entry!(
        "magnitude-only",
        "inversion of the identifier, speed along the path only",
        "Yoon and Jeon (2000)",
        Identified,
        laps: 1,
        [RHO, ETA],
        magnitude_only
    ),
    entry!(
        "two-dimensional",
        "inversion of the identifier, speed and geometry",
        "Lee, Cho and Jeon (2005)",
        Identified,
        laps: 1,
        [RHO, ETA],
        two_dimensional
    ),
    entry!(
        "receding-horizon",
        "geometry planned over 20 knots ahead through an identified servo, speed as planned",
        "Lee, Cho and Jeon (2005), eq. 7 over a horizon; Gauss-Newton",
        Identified,
        laps: 1,
        [],
        receding_horizon
    ),
];

/// The best there is.
pub const BEST: &str = "receding-horizon";
/// What others are compared against.
pub const BASELINE: &str = "open-loop";

/// What a user can set; `None` is the controller's own default.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Choices {
    /// Weight of the machining time.
    pub rho: Option<f64>,
    /// Seed of the training.
    pub seed: u64,
    /// Whether rapid motions are corrected as cuts are, by a controller that tells them apart.
    pub on_rapids: bool,
    /// Values of the controller's parameters in the order of [`Entry::parameters`]; all defaults where it is empty.
    pub values: Vec<f64>,
}

/// What a controller is made from.
pub struct Setup<'a> {
    /// The machine it is for.
    pub machine: &'a Machine,
    /// The user's choices.
    pub choices: &'a Choices,
    /// Told of the progress of a training, 0 to 1.
    pub progress: &'a mut dyn FnMut(f64),
}

impl Entry {
    /// Finds a row by its name.
    pub fn find(name: &str) -> Option<&'static Self> {
        CONTROLLERS.iter().find(|entry| entry.name == name)
    }

    /// The values of the parameters that the choices come to.
    fn values(&self, choices: &Choices) -> Vec<f64> {
        let defaults = self.parameters.iter().map(|parameter| parameter.default);
        defaults.enumerate().map(|(i, default)| choices.values.get(i).copied().unwrap_or(default)).collect()
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
        (self.plane)(setup, &self.values(setup.choices))
    }
}

impl Make<3> for Entry {
    fn make(&self, setup: &mut Setup<'_>) -> Box<dyn Controller<3>> {
        (self.space)(setup, &self.values(setup.choices))
    }
}

impl std::fmt::Debug for Entry {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}
