//! The table of controllers: a name, what it is, where it comes from, and how it is made.
//!
//! Help texts, docs and conformance tests iterate over [`CONTROLLERS`]; another table can hold the
//! same rows and more, with the macro [`controller!`](crate::controller).
//!
//! | File | What |
//! |---|---|
//! | `controllers/parameters.rs` | parameters that a user can set, by name |
//! | `controllers/rows.rs` | the parameters of the rows |
//! | `controllers/recorded.rs` | values of parameters that a search on a machine came to |
//! | `controllers/setup.rs` | what a controller is made from: what is known of a machine, and a model |
//! | `controllers/make.rs` | how each row is made from that |

mod parameters;
mod make;
mod rows;
mod setup;
mod recorded;

use feedwright_control::{Controller, IdentifierKind, Uncorrected};
use feedwright_gcode::suggestion::nearest;
use feedwright_ident::Model;
use feedwright_sim::{Machine, StageSteps, Watch};
use serde::{Deserialize, Serialize};

pub use make::offset_bounds;
pub use parameters::{Parameter, Setting, Values};
pub(crate) use recorded::RecordedValues;
pub use rows::{ACCELERATION_GAIN, FRICTION_GAIN, VELOCITY_GAIN};
use rows::{
    ETA, IDENTIFIED_WEIGHT, INVERSION_KNOTS, INVERSION_PERIOD_S, INVERSION_STEPS, LEARNING_STEP,
    RHO,
};
pub(crate) use setup::CutsUncorrected;
pub use setup::{ModelMisfit, Setup};

/// The stage of all that a first cut on a machine waits for.
pub(crate) fn identifying<'a>(machine: &Machine, watch: &'a dyn Watch) -> StageSteps<'a> {
    StageSteps::begin(watch, &format!("identifying {}", machine.name))
}

/// One row of the table.
pub struct Entry {
    /// Name on the command line.
    pub name: &'static str,
    /// Summary in half a line.
    pub summary: &'static str,
    /// Author, year.
    pub source: &'static str,
    /// Knowledge of the machine.
    pub knows: Knows,
    /// Kind of identifier, if the controller uses one.
    pub identifier: Option<IdentifierKind>,
    /// Laps of the same part that it cuts; all but the last are practice.
    pub laps: u32,
    /// Parameters that can be set, beginning with those whose best values the comparison searches
    /// for.
    pub parameters: &'static [Parameter],
    /// Makes it for two axes.
    #[doc(hidden)]
    pub plane: Maker<2>,
    /// Makes it for three axes.
    #[doc(hidden)]
    pub space: Maker<3>,
}

/// Knowledge that a controller has of the machine before it cuts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Knows {
    /// Nothing.
    Nothing,
    /// Values that were identified from a recording.
    Identified,
    /// The parameters of its model.
    ExactModel,
    /// Everything that can be: the parameters, and the statistics of all noise.
    Everything,
    /// Errors of earlier laps of the same part.
    EarlierLaps,
}

/// Makes a controller from a setup and the values of its parameters.
pub(crate) type Maker<const N: usize> = fn(&mut Setup<'_>, &Values) -> Box<dyn Controller<N>>;

/// A row of a table of controllers: name, summary, source, what it knows, laps, parameters, and how
/// it is made for N axes from a [`Setup`] and the values of its parameters.
#[macro_export]
macro_rules! controller {
    ($name:literal, $summary:literal, $source:literal, $knows:ident $(($kind:ident))?, laps: $laps:literal, $parameters:expr, |$setup:ident, $values:ident| $make:expr) => {{
        fn make<const N: usize>(
            $setup: &mut $crate::Setup<'_>,
            $values: &$crate::Values,
        ) -> Box<dyn $crate::control::Controller<N>> {
            $make
        }
        $crate::Entry {
            name: $name,
            summary: $summary,
            source: $source,
            knows: $crate::Knows::$knows,
            identifier: [$($crate::control::IdentifierKind::$kind)?].first().copied(),
            laps: $laps,
            parameters: &$parameters,
            plane: make::<2>,
            space: make::<3>,
        }
    }};
}

/// The programmed path at the planned feed.
pub static UNCORRECTED: Entry = controller!(
    "uncorrected",
    "the programmed path at the planned feed",
    "what every open-source control does",
    Nothing,
    laps: 1,
    [],
    |_setup, _values| Box::new(Uncorrected)
);

/// Velocity, acceleration and friction feedforward with the exact model of the machine.
pub static FEEDFORWARD: Entry = controller!(
    "feedforward",
    "velocity, acceleration and friction feedforward with the exact model of the machine; makes slow corners of router worse",
    "Masory (1986); Armstrong-Helouvry, Dupont and Canudas de Wit (1994)",
    ExactModel,
    laps: 1,
    [VELOCITY_GAIN, ACCELERATION_GAIN, FRICTION_GAIN],
    |setup, values| make::feedforward(setup, values)
);

/// Inversion of the identifier, speed along the path only.
pub static MAGNITUDE_ONLY: Entry = controller!(
    "magnitude-only",
    "inversion of the identifier, speed along the path only",
    "Yoon and Jeon (2000)",
    Identified(Contour),
    laps: 1,
    [RHO, ETA, INVERSION_STEPS, INVERSION_KNOTS, INVERSION_PERIOD_S, LEARNING_STEP],
    |setup, values| make::magnitude_only(setup, values)
);

/// Inversion of the identifier, speed and geometry.
pub static TWO_DIMENSIONAL: Entry = controller!(
    "two-dimensional",
    "inversion of the identifier, speed and geometry",
    "Lee, Cho and Jeon (2005)",
    Identified(Contour),
    laps: 1,
    [RHO, ETA, INVERSION_STEPS, INVERSION_KNOTS, INVERSION_PERIOD_S, LEARNING_STEP],
    |setup, values| make::two_dimensional(setup, values)
);

/// Kalman filter and linear-quadratic regulator with preview, with an identified model of each
/// axis.
pub static LQG_IDENTIFIED: Entry = controller!(
    "lqg-identified",
    "Kalman filter and linear-quadratic regulator with preview, by an identified model of each axis",
    "Anderson and Moore (1990); Gautier, Janot and Vandanjon (2013)",
    Identified(Axes),
    laps: 1,
    [IDENTIFIED_WEIGHT],
    |setup, values| make::lqg_identified(setup, values)
);

/// The controllers that a machine runs.
pub const CONTROLLERS: Controllers =
    Controllers::new(&ROWS, include_str!("controllers/recorded.jsonl"));

static ROWS: [&Entry; 5] = [
    &UNCORRECTED,
    &FEEDFORWARD,
    &MAGNITUDE_ONLY,
    &TWO_DIMENSIONAL,
    &LQG_IDENTIFIED,
];

/// The default.
pub const BEST: &str = "lqg-identified";
/// Controller that others are compared with.
pub const BASELINE: &str = "uncorrected";

/// A table of controllers, in the order in which they are listed.
#[derive(Debug, Clone, Copy)]
pub struct Controllers {
    rows: &'static [&'static Entry],
    recorded: &'static str,
}

impl Controllers {
    /// Creates a table of these rows and of recorded search results on machines: one line of JSON
    /// each.
    pub const fn new(rows: &'static [&'static Entry], recorded: &'static str) -> Self {
        Self { rows, recorded }
    }

    /// Returns the record of a controller on a machine, if there is one.
    pub fn recorded(self, machine: &Machine, entry: &'static Entry) -> Option<RecordedValues> {
        recorded::find(self.recorded, machine, entry)
    }

    /// All rows.
    pub fn iter(self) -> impl Iterator<Item = &'static Entry> {
        self.into_iter()
    }

    /// Finds a row by its name.
    pub fn find(self, name: &str) -> Option<&'static Entry> {
        self.iter().find(|entry| entry.name == name)
    }

    /// The name nearest to one that is not in the table.
    pub fn meant_by(self, name: &str) -> Option<&'static str> {
        let names: Vec<&'static str> = self.iter().map(|entry| entry.name).collect();
        nearest(name, &names)
    }
}

impl IntoIterator for Controllers {
    type Item = &'static Entry;
    type IntoIter = std::iter::Copied<std::slice::Iter<'static, &'static Entry>>;

    fn into_iter(self) -> Self::IntoIter {
        self.rows.iter().copied()
    }
}

/// Choices of the user.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Choices {
    /// Seed of the training.
    pub seed: u64,
    /// Parameters that were set, of any controller; the last of the same counts.
    pub set: Vec<Setting>,
    /// Controllers that cut uncorrected, because none of their values is better than no correction
    /// on the machine.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unsuited: Vec<String>,
    /// True if the paper's controller must show that it helps before it is followed. The comparison
    /// cuts it as it was published.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub tries: bool,
}

impl Entry {
    /// A parameter by its name.
    pub fn parameter(&self, name: &str) -> Option<&'static Parameter> {
        self.parameters
            .iter()
            .find(|parameter| parameter.name == name)
    }

    /// The parameters that the comparison searches for the best of, with the ranges.
    pub fn searched(&self) -> impl Iterator<Item = (&'static Parameter, [f64; 2])> + use<> {
        self.parameters
            .iter()
            .filter_map(|parameter| Some((parameter, parameter.searched?)))
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
}

/// A number of axes that controllers exist for: 2 or 3.
pub trait Make<const N: usize> {
    /// The controller of this row.
    fn make(&self, setup: &mut Setup<'_>) -> Box<dyn Controller<N>>;
}

impl Make<2> for Entry {
    fn make(&self, setup: &mut Setup<'_>) -> Box<dyn Controller<2>> {
        if setup.is_unsuited(self) {
            return Box::new(Uncorrected);
        }
        (self.plane)(setup, &Values::of(self, &setup.choices.set))
    }
}

impl Make<3> for Entry {
    fn make(&self, setup: &mut Setup<'_>) -> Box<dyn Controller<3>> {
        if setup.is_unsuited(self) {
            return Box::new(Uncorrected);
        }
        (self.space)(setup, &Values::of(self, &setup.choices.set))
    }
}

/// Compares rows by name: each name has one row.
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
