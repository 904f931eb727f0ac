//! The table of controllers: a name, what it is, where it comes from, and how it is made.
//!
//! Help texts, the comparison, docs and conformance tests iterate over [`CONTROLLERS`].

use feedwright_control::controller::contour_compensation::{self, ContourCompensation};
use feedwright_control::controller::cross_coupled::{self, CrossCoupled};
use feedwright_control::controller::fuzzy_feedrate::{self, FuzzyFeedrate};
use feedwright_control::controller::inverting::{self, Settings};
use feedwright_control::controller::magnitude_only::MagnitudeOnly;
use feedwright_control::controller::open_loop::OpenLoop;
use feedwright_control::controller::receding_horizon::{self, RecedingHorizon};
use feedwright_control::controller::two_dimensional::TwoDimensional;
use feedwright_control::{Controller, inversion};
use serde::Serialize;

use crate::identify::cache::identified;
use crate::identify::contour::{Identified, Training};
use crate::identify::{Programme, servo};
use crate::machine::{Machine, nearest};

/// One row of the table.
pub struct Entry {
    /// Name on the command line.
    pub name: &'static str,
    /// What it does, in half a line.
    pub summary: &'static str,
    /// Author, year.
    pub source: &'static str,
    /// Whether it needs an identifier trained on the machine.
    pub identifies: bool,
    /// What can be tuned.
    pub parameters: &'static [Parameter],
    plane: Maker<2>,
    space: Maker<3>,
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

/// A row from a function that is generic over the number of axes.
macro_rules! entry {
    ($name:literal, $summary:literal, $source:literal, identifies: $identifies:literal, [$($parameter:expr),*], $make:ident) => {
        Entry {
            name: $name,
            summary: $summary,
            source: $source,
            identifies: $identifies,
            parameters: &[$($parameter),*],
            plane: $make::<2>,
            space: $make::<3>,
        }
    };
}

const RHO: Parameter = parameter("rho", [1e-5, 0.1], Settings::DEFAULT.inversion.rho);
const ETA: Parameter = parameter("eta", [1e-3, 10.0], Settings::DEFAULT.inversion.eta);
const RATE_WEIGHT: Parameter =
    parameter("rate_weight_s2", [1e-9, 1e-4], receding_horizon::Settings::DEFAULT.horizon.rate_weight);
const INNOVATION_GAIN: Parameter =
    parameter("innovation_gain", [0.0, 1.0], receding_horizon::Settings::DEFAULT.innovation_gain);

/// All controllers.
pub const CONTROLLERS: &[Entry] = &[
    entry!(
        "open-loop",
        "the programmed path at the planned feed",
        "what every open-source control does",
        identifies: false,
        [],
        open_loop
    ),
    entry!(
        "cross-coupled",
        "PID control of the contour error, added to the command across the path",
        "Koren (1980); Srinivasan and Kulkarni (1990)",
        identifies: false,
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
        identifies: false,
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
        identifies: false,
        [
            parameter("error_mm", [0.002, 0.2], fuzzy_feedrate::Settings::DEFAULT.error_mm),
            parameter("change_mm_s", [0.05, 20.0], fuzzy_feedrate::Settings::DEFAULT.change_mm_s),
            parameter("slowest", [0.2, 1.0], fuzzy_feedrate::Settings::DEFAULT.slowest)
        ],
        fuzzy_feedrate
    ),
    entry!(
        "magnitude-only",
        "inversion of the identifier, speed along the path only",
        "Yoon and Jeon (2000)",
        identifies: true,
        [RHO, ETA],
        magnitude_only
    ),
    entry!(
        "two-dimensional",
        "inversion of the identifier, speed and geometry",
        "Lee, Cho and Jeon (2005)",
        identifies: true,
        [RHO, ETA],
        two_dimensional
    ),
    entry!(
        "receding-horizon",
        "geometry planned over 10 knots ahead through an identified servo, speed as planned",
        "Lee, Cho and Jeon (2005), eq. 7 over a horizon; Gauss-Newton",
        identifies: true,
        [RATE_WEIGHT, INNOVATION_GAIN],
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

fn open_loop<const N: usize>(_: &mut Setup<'_>, _: &[f64]) -> Box<dyn Controller<N>> {
    Box::new(OpenLoop)
}

fn cross_coupled<const N: usize>(_: &mut Setup<'_>, values: &[f64]) -> Box<dyn Controller<N>> {
    Box::new(CrossCoupled::new(cross_coupled::Settings { kp: values[0], ki_1_s: values[1], kd_s: values[2] }))
}

fn contour_compensation<const N: usize>(_: &mut Setup<'_>, values: &[f64]) -> Box<dyn Controller<N>> {
    let settings = contour_compensation::Settings { rate_1_s: values[0], filter_s: values[1] };
    Box::new(ContourCompensation::new(settings))
}

fn fuzzy_feedrate<const N: usize>(setup: &mut Setup<'_>, values: &[f64]) -> Box<dyn Controller<N>> {
    Box::new(FuzzyFeedrate::new(fuzzy_feedrate::Settings {
        servo_periods: setup.machine.period.servo_periods(fuzzy_feedrate::FEED_PERIOD_S),
        error_mm: values[0],
        change_mm_s: values[1],
        slowest: values[2],
        acceleration_mm_s2: setup.machine.limits.tangential_accel_mm_s2,
    }))
}

fn magnitude_only<const N: usize>(setup: &mut Setup<'_>, values: &[f64]) -> Box<dyn Controller<N>> {
    let mut settings = inverting(setup, values);
    settings.inversion.gradient = inversion::Gradient::Exact;
    Box::new(MagnitudeOnly::new(trained(setup).net, settings))
}

fn two_dimensional<const N: usize>(setup: &mut Setup<'_>, values: &[f64]) -> Box<dyn Controller<N>> {
    let settings = inverting(setup, values);
    Box::new(TwoDimensional::new(trained(setup).net, settings))
}

fn receding_horizon<const N: usize>(setup: &mut Setup<'_>, values: &[f64]) -> Box<dyn Controller<N>> {
    let identified = servo::identify(setup.machine, &Programme::servo(), setup.choices.seed);
    let mut settings = receding_horizon::Settings::DEFAULT;
    settings.servo_periods = setup.machine.period.servo_periods(receding_horizon::FEED_PERIOD_S);
    (settings.horizon.rate_weight, settings.innovation_gain) = (values[0], values[1]);
    Box::new(RecedingHorizon::new(identified.net, settings))
}

/// Settings of the controllers that invert the paper's identifier.
fn inverting(setup: &Setup<'_>, values: &[f64]) -> Settings {
    let mut settings = Settings::DEFAULT;
    settings.servo_periods = setup.machine.period.servo_periods(inverting::FEED_PERIOD_S);
    (settings.inversion.rho, settings.inversion.eta) = (setup.choices.rho.unwrap_or(values[0]), values[1]);
    settings
}

fn trained<const N: usize>(setup: &mut Setup<'_>) -> Identified<N> {
    identified(setup.machine, &Programme::general(), &Training::default(), setup.choices.seed, setup.progress)
}
