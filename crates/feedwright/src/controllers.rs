//! The table of controllers: the rows of `feedwright-control` with what the command line shows, and
//! how each is made from what is known of a machine.
//!
//! Help texts, docs and conformance tests iterate over [`CONTROLLERS`]; another table can hold the
//! same rows and more, with the macro [`controller!`](crate::controller).
//!
//! | File | What |
//! |---|---|
//! | `controllers/settings.rs` | values of parameters that a user sets, by name |
//! | `controllers/recorded.rs` | values of parameters that a search on a machine came to |
//! | `controllers/setup.rs` | what a controller is made from: what is known of a machine, and a model |

mod settings;
mod setup;
mod recorded;

use std::ops::Deref;

use feedwright_control::{
    AnyController, Controller, ControllerRow, MemberName, Parameter, Uncorrected, Values,
};
use feedwright_gcode::suggestion::nearest;
use feedwright_ident::Model;
use feedwright_sim::{BoxedController, Machine, StageSteps, Watch};
use serde::Serialize;

pub(crate) use recorded::RecordedValues;
pub use settings::Setting;
#[cfg(feature = "command")]
pub(crate) use settings::range;
pub(crate) use setup::CutsUncorrected;
pub use setup::{ModelMisfit, Setup};

/// The stage of all that a first cut on a machine waits for.
pub(crate) fn identifying<'a>(machine: &Machine, watch: &'a dyn Watch) -> StageSteps<'a> {
    StageSteps::begin(watch, &format!("identifying {}", machine.name))
}

/// One row of the table.
pub struct Entry {
    /// Name, knowledge and parameters.
    pub row: ControllerRow,
    /// Summary in half a line.
    pub summary: &'static str,
    /// Author, year.
    pub source: &'static str,
    /// Laps of the same part that it cuts; all but the last are practice.
    pub laps: u32,
    /// Makes it for two axes.
    #[doc(hidden)]
    pub plane: Maker<2>,
    /// Makes it for three axes.
    #[doc(hidden)]
    pub space: Maker<3>,
}

impl Deref for Entry {
    type Target = ControllerRow;

    fn deref(&self) -> &ControllerRow {
        &self.row
    }
}

/// Makes a controller from a setup and the values of its parameters.
pub(crate) type Maker<const N: usize> = fn(&mut Setup<'_>, Values<'_>) -> Box<dyn Controller<N>>;

/// A row of a table of controllers: its row of the family (or the name, knowledge and parameters of
/// another one), summary, source, laps, and how it is made for N axes from a [`Setup`] and the values
/// of its parameters.
#[macro_export]
macro_rules! controller {
    ($row:expr, $summary:literal, $source:literal, laps: $laps:literal, |$setup:ident, $values:ident| $make:expr) => {{
        fn make<const N: usize>(
            $setup: &mut $crate::Setup<'_>,
            $values: $crate::control::Values<'_>,
        ) -> Box<dyn $crate::control::Controller<N>> {
            $make
        }
        $crate::Entry {
            row: $row,
            summary: $summary,
            source: $source,
            laps: $laps,
            plane: make::<2>,
            space: make::<3>,
        }
    }};
    ($name:literal, $summary:literal, $source:literal, $knows:ident, laps: $laps:literal, $parameters:expr, |$setup:ident, $values:ident| $make:expr) => {
        $crate::controller!(
            $crate::control::ControllerRow {
                name: $name,
                knows: $crate::control::Knows::$knows,
                identifier: None,
                parameters: &$parameters,
            },
            $summary,
            $source,
            laps: $laps,
            |$setup, $values| $make
        )
    };
}

/// A row of the family of `feedwright-control`.
macro_rules! member {
    ($Name:ident, $summary:literal, $source:literal) => {{
        const ROW: ControllerRow = AnyController::<2>::ROWS[MemberName::$Name as usize].1;
        Entry {
            row: ROW,
            summary: $summary,
            source: $source,
            laps: 1,
            plane: |setup, values| {
                setup.member(&ROW, values, |data| {
                    BoxedController::in_plane(MemberName::$Name, data, values)
                })
            },
            space: |setup, values| {
                setup.member(&ROW, values, |data| {
                    BoxedController::in_space(MemberName::$Name, data, values)
                })
            },
        }
    }};
}

/// The programmed path at the planned feed.
pub static UNCORRECTED: Entry = member!(
    Uncorrected,
    "the programmed path at the planned feed",
    "what every open-source control does"
);

/// Velocity, acceleration and friction feedforward with the exact model of the machine.
pub static FEEDFORWARD: Entry = member!(
    Feedforward,
    "velocity, acceleration and friction feedforward with the exact model of the machine; makes slow corners of router worse",
    "Masory (1986); Armstrong-Helouvry, Dupont and Canudas de Wit (1994)"
);

/// Inversion of the identifier, speed along the path only.
pub static MAGNITUDE_ONLY: Entry = member!(
    MagnitudeOnly,
    "inversion of the identifier, speed along the path only",
    "Yoon and Jeon (2000)"
);

/// Inversion of the identifier, speed and geometry.
pub static TWO_DIMENSIONAL: Entry = member!(
    TwoDimensional,
    "inversion of the identifier, speed and geometry",
    "Lee, Cho and Jeon (2005)"
);

/// Kalman filter and linear-quadratic regulator with preview, with an identified model of each
/// axis.
pub static LQG_IDENTIFIED: Entry = member!(
    LqgIdentified,
    "Kalman filter and linear-quadratic regulator with preview, by an identified model of each axis",
    "Anderson and Moore (1990); Gautier, Janot and Vandanjon (2013)"
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
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Choices {
    /// Seed of the training.
    pub seed: u64,
    /// Parameters that were set, of any controller; the last of the same counts.
    pub set: Vec<Setting>,
    /// Controllers that cut uncorrected, because none of their values is better than no correction
    /// on the machine.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unsuited: Vec<String>,
    /// True if the paper's controller must show that it helps before it is followed. The comparison
    /// cuts it as it was published.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
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

    /// The controller of this row for 2 or 3 axes, with a model in place of a training.
    ///
    /// # Errors
    /// A model that does not suit it.
    pub fn make_with<'a>(
        &self,
        mut setup: Setup<'a>,
        axes: usize,
        model: &'a Model,
    ) -> Result<BoxedController, ModelMisfit> {
        setup.take(model, self, axes)?;
        Ok(self.make(&mut setup, axes))
    }

    /// The controller of this row for two axes.
    pub fn in_plane(&self, setup: &mut Setup<'_>) -> Box<dyn Controller<2>> {
        self.made(setup, self.plane)
    }

    /// The controller of this row for three axes.
    pub fn in_space(&self, setup: &mut Setup<'_>) -> Box<dyn Controller<3>> {
        self.made(setup, self.space)
    }

    fn made<const N: usize>(
        &self,
        setup: &mut Setup<'_>,
        maker: Maker<N>,
    ) -> Box<dyn Controller<N>> {
        if setup.is_unsuited(self) {
            return Box::new(Uncorrected);
        }
        let choices = setup.choices;
        maker(setup, &|parameter| choices.value(self, parameter))
    }
}

/// Makes controllers of two and of three axes.
pub trait Make {
    /// A controller for 2 or 3 axes.
    fn make(&self, setup: &mut Setup<'_>, axes: usize) -> BoxedController;
}

impl Make for Entry {
    fn make(&self, setup: &mut Setup<'_>, axes: usize) -> BoxedController {
        match axes {
            2 => BoxedController::Plane(self.in_plane(setup)),
            _ => BoxedController::Space(self.in_space(setup)),
        }
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
