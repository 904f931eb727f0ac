//! The table of controllers: a name, what it is, where it comes from, and how it is made.
//!
//! Help texts, the comparison, docs and conformance tests iterate over [`CONTROLLERS`].
//!
//! | File | What |
//! |---|---|
//! | `controllers/parameters.rs` | what of them can be set, by name |
//! | `controllers/setup.rs` | what they are made from: what is known of a machine, and a model |
//! | `controllers/make.rs` | how each row is made from that |
//! | `controllers/model_predictive.rs`, `controllers/iterative_learning.rs` | those that are not fit for a servo thread |

pub mod parameters;
pub mod iterative_learning;
pub mod model_predictive;
mod make;
mod setup;

use feedwright_control::Controller;
use feedwright_control::controller::disturbance_observer::{self, DisturbanceObserver};
use feedwright_control::controller::feedforward::Gains;
use feedwright_control::controller::inverting::{self, Settings as Inverting};
use feedwright_control::controller::open_loop::OpenLoop;
use feedwright_control::controller::receding_horizon::Settings as Horizon;
use feedwright_control::controller::{contour_compensation, cross_coupled, fuzzy_feedrate, receding_horizon};
use feedwright_control::horizon::MAX_KNOTS;
use feedwright_control::identifier::IdentifierKind;
pub use make::correction_limits;
pub use parameters::{Parameter, Setting, SettingError};
use parameters::{Values, number, switch, whole};
use serde::{Deserialize, Serialize};
pub use setup::{ModelMisfit, Setup};

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
    /// What went wrong in earlier laps of the same part.
    EarlierLaps,
}

/// Makes a controller from a setup and the values of its parameters.
type Maker<const N: usize> = fn(&mut Setup<'_>, &Values) -> Box<dyn Controller<N>>;

/// A row. Its last part makes the controller for N axes, of what is known of the machine and the values of its parameters.
macro_rules! entry {
    ($name:literal, $summary:literal, $source:literal, $knows:ident $(($kind:ident))?, laps: $laps:literal, [$($parameter:expr),*], |$setup:ident, $values:ident| $make:expr) => {{
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
            parameters: &[$($parameter),*],
            plane: make::<2>,
            space: make::<3>,
        }
    }};
}

// Of those that invert the paper's identifier.
const RHO: Parameter = number(
    "rho",
    Inverting::DEFAULT.inversion.rho,
    [0.0, 0.1],
    Some([1e-5, 0.1]),
    "weight of the machining time against the error: 0 looks at the error alone, more is faster and less accurate",
);
const ETA: Parameter = number(
    "eta",
    Inverting::DEFAULT.inversion.eta,
    [0.0, 10.0],
    Some([1e-3, 10.0]),
    "length of a gradient step: 0 inverts nothing; the paper takes 0.3",
);
const INVERSION_STEPS: Parameter =
    whole("steps", Inverting::DEFAULT.inversion.steps, [1.0, 20.0], "gradient steps in a tick: the paper allows 5");
const INVERSION_KNOTS: Parameter = whole(
    "knots",
    Inverting::DEFAULT.knots,
    [1.0, 20.0],
    "knots that are inverted together: 1 is the paper's; with the printed gradient more change nothing",
);
const INVERSION_PERIOD_S: Parameter =
    number("feed_period_s", inverting::FEED_PERIOD_S, [1e-3, 0.012], None, "time between decisions: the paper's 10 ms");
const LEARNING_STEP: Parameter = number(
    "learning_step",
    Inverting::DEFAULT.learning_step,
    [0.0, 0.5],
    None,
    "step of back-propagation while cutting: 0 keeps what was trained, large ones forget it",
);
// Of those that plan over a horizon.
const RATE_WEIGHT: Parameter = number(
    "rate_weight_s2",
    Horizon::<2>::DEFAULT.horizon.rate_weight,
    [0.0, 0.01],
    None,
    "weight of the speed of the offset: below 1e-10 the plan rings from knot to knot, above 1e-4 nothing is corrected",
);
const KNOTS: Parameter = whole(
    "knots",
    Horizon::<2>::DEFAULT.horizon.knots,
    [1.0, MAX_KNOTS as f64],
    "knots of the horizon: fewer take less time in a tick, and see less of a corner ahead",
);
const PLAN_PERIOD_S: Parameter = number(
    "feed_period_s",
    receding_horizon::FEED_PERIOD_S,
    [1e-3, 0.012],
    None,
    "time between decisions: 2 ms is worse on a soft ball screw, 5 ms at every reversal",
);
const CHANGE_WEIGHT: Parameter = number(
    "change_weight_s2",
    Horizon::<2>::DEFAULT.horizon.change_weight,
    [0.0, 0.01],
    None,
    "weight of the change of that speed from knot to knot: more is smoother, and blunter at corners",
);
const TANGENTIAL_WEIGHT: Parameter = number(
    "tangential_weight",
    Horizon::<2>::DEFAULT.horizon.tangential_weight,
    [0.0, 1.0],
    None,
    "weight of an error along the path: small leaves room at a corner, large keeps the tool from staying behind",
);
const LAST_WEIGHT: Parameter = number(
    "last_weight",
    Horizon::<2>::DEFAULT.horizon.last_weight,
    [0.0, 1.0],
    None,
    "the same at the end of the horizon, at the least: where it is small, the tool swings about turns that are not seen yet",
);
const INNOVATION_SCALE_MM: Parameter = number(
    "innovation_scale_mm",
    Horizon::<2>::DEFAULT.innovation_scale_mm,
    [1e-6, 1.0],
    None,
    "innovations of this size make the plan half as sharp: small is gentle, large builds on predictions that miss",
);
const FORESEEN_MM: Parameter = number(
    "foreseen_mm",
    Horizon::<2>::DEFAULT.foreseen_mm,
    [1e-4, 10.0],
    None,
    "a miss by this some knots ahead makes the offset count as much as an error: large trusts a model that is wrong",
);
const SOLVER_STEPS: Parameter = whole(
    "steps",
    Horizon::<2>::DEFAULT.steps,
    [1.0, 20.0],
    "steps of the solver in a tick: further ones hardly change anything",
);
const ON_RAPIDS: Parameter =
    switch("on_rapids", Horizon::<2>::DEFAULT.horizon.on_rapids, "whether rapids are corrected as cuts are");
// Parts of what the exact model calls for, and scales of its parameters.
const VELOCITY_GAIN: Parameter =
    number("velocity_gain", Gains::EXACT.velocity, [0.0, 10.0], Some([0.5, 1.5]), EXACT_REASON);
const ACCELERATION_GAIN: Parameter =
    number("acceleration_gain", Gains::EXACT.acceleration, [0.0, 10.0], Some([0.0, 2.0]), EXACT_REASON);
const FRICTION_GAIN: Parameter =
    number("friction_gain", Gains::EXACT.friction, [0.0, 10.0], Some([0.0, 2.0]), EXACT_REASON);
const LAG_SCALE: Parameter = number("lag_scale", 1.0, [0.1, 10.0], Some([0.5, 1.5]), EXACT_REASON);
const INERTIA_SCALE: Parameter = number("inertia_scale", 1.0, [0.01, 10.0], Some([0.5, 2.0]), EXACT_REASON);
const EXACT_REASON: &str = "1 is what the exact model calls for; another makes up for a model that is not exact";

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
        // Beyond these gains the loop is still stable on smooth paths, but catches the tool in acute corners.
        [
            number(
                "kp",
                cross_coupled::Settings::DEFAULT.kp,
                [0.0, 100.0],
                Some([0.1, 8.0]),
                "gain of the contour error: more corrects more; beyond 8 the tool is caught in acute corners"
            ),
            number(
                "ki_1_s",
                cross_coupled::Settings::DEFAULT.ki_1_s,
                [0.0, 1e5],
                Some([1.0, 400.0]),
                "gain of its integral: 0 leaves a part of a steady error; beyond 400 the tool is caught in acute corners"
            ),
            number(
                "kd_s",
                cross_coupled::Settings::DEFAULT.kd_s,
                [0.0, 1.0],
                Some([1e-4, 0.03]),
                "gain of its derivative, which damps: beyond 0.03 the tool is caught in acute corners"
            )
        ],
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
                Some([1.0, 300.0]),
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
        "feedforward",
        "velocity, acceleration and friction feedforward with the exact model of the machine",
        "Masory (1986); Armstrong-Helouvry, Dupont and Canudas de Wit (1994)",
        ExactModel,
        laps: 1,
        [VELOCITY_GAIN, ACCELERATION_GAIN, FRICTION_GAIN],
        |setup, values| make::feedforward(setup, values)
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
        "disturbance-observer",
        "velocity and acceleration feedforward, and an observer of friction and cutting force",
        "Ohnishi (1987)",
        ExactModel,
        laps: 1,
        [number(
            "bandwidth_hz",
            disturbance_observer::BANDWIDTH_HZ,
            [0.0, 200.0],
            Some([1.0, 150.0]),
            "of the observer: low is late at every reversal, high swings with the delay of the loop"
        )],
        |setup, values| {
            let (axes, limits_mm_s) = (make::sampled_axes(&setup.known, [1.0; 2]), make::drive_limits_mm_s(&setup.known));
            let feedforward = make::feedforward_with(setup, Gains { friction: 0.0, ..Gains::EXACT });
            let (bandwidth_hz, servo_s) = (values.number("bandwidth_hz"), setup.known.period.servo_s);
            Box::new(DisturbanceObserver::<N>::new(feedforward, axes, limits_mm_s, bandwidth_hz, servo_s))
        }
    ),
    entry!(
        "model-predictive",
        "contouring over 20 knots ahead with the exact model of the machine, solved to convergence",
        "Lam, Manzie and Good (2010)",
        ExactModel,
        laps: 1,
        [Parameter { searched: Some([1e-11, 1e-4]), ..RATE_WEIGHT }, KNOTS, PLAN_PERIOD_S],
        |setup, values| make::model_predictive(setup, values)
    ),
    entry!(
        "iterative-learning-1",
        "offsets learned from the contour error of the same part, 1 lap of practice",
        "Arimoto, Kawamura and Miyazaki (1984)",
        EarlierLaps,
        laps: 2,
        [iterative_learning::GAIN, iterative_learning::LEAD_S, iterative_learning::CUT_OFF_HZ],
        |setup, values| make::iterative_learning(setup, values)
    ),
    entry!(
        "iterative-learning-3",
        "offsets learned from the contour error of the same part, 3 laps of practice",
        "Arimoto, Kawamura and Miyazaki (1984)",
        EarlierLaps,
        laps: 4,
        [iterative_learning::GAIN, iterative_learning::LEAD_S, iterative_learning::CUT_OFF_HZ],
        |setup, values| make::iterative_learning(setup, values)
    ),
    entry!(
        "iterative-learning-10",
        "offsets learned from the contour error of the same part, 10 laps of practice",
        "Arimoto, Kawamura and Miyazaki (1984)",
        EarlierLaps,
        laps: 11,
        [iterative_learning::GAIN, iterative_learning::LEAD_S, iterative_learning::CUT_OFF_HZ],
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
];

/// The best there is.
pub const BEST: &str = "receding-horizon";
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

    /// The controller of this row, with a model in place of a training.
    ///
    /// # Errors
    /// A model that does not suit it.
    fn make_with<'a>(&self, setup: Setup<'a>, model: &'a Model) -> Result<Box<dyn Controller<N>>, ModelMisfit>;
}

impl Make<2> for Entry {
    fn make_with<'a>(&self, mut setup: Setup<'a>, model: &'a Model) -> Result<Box<dyn Controller<2>>, ModelMisfit> {
        setup.take(model, self, 2)?;
        Ok(self.make(&mut setup))
    }

    fn make(&self, setup: &mut Setup<'_>) -> Box<dyn Controller<2>> {
        (self.plane)(setup, &Values::of(self, &setup.choices.set))
    }
}

impl Make<3> for Entry {
    fn make_with<'a>(&self, mut setup: Setup<'a>, model: &'a Model) -> Result<Box<dyn Controller<3>>, ModelMisfit> {
        setup.take(model, self, 3)?;
        Ok(self.make(&mut setup))
    }

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
