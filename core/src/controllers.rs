//! The table of controllers: a name, what it is, where it comes from, and how it is made.
//!
//! Help texts, the comparison, docs and conformance tests iterate over [`CONTROLLERS`].

use feedwright_control::controller::magnitude_only::MagnitudeOnly;
use feedwright_control::controller::open_loop::OpenLoop;
use feedwright_control::controller::receding_horizon::{self, RecedingHorizon};
use feedwright_control::controller::{inverting::Settings, two_dimensional::TwoDimensional};
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
    plane: fn(&mut Setup<'_>) -> Box<dyn Controller<2>>,
    space: fn(&mut Setup<'_>) -> Box<dyn Controller<3>>,
}

/// A row from a function that is generic over the number of axes.
macro_rules! entry {
    ($name:literal, $summary:literal, $source:literal, identifies: $identifies:literal, $make:ident) => {
        Entry {
            name: $name,
            summary: $summary,
            source: $source,
            identifies: $identifies,
            plane: $make::<2>,
            space: $make::<3>,
        }
    };
}

/// All controllers.
pub const CONTROLLERS: &[Entry] = &[
    entry!(
        "open-loop",
        "the programmed path at the planned feed",
        "what every open-source control does",
        identifies: false,
        open_loop
    ),
    entry!(
        "magnitude-only",
        "inversion of the identifier, speed along the path only",
        "Yoon and Jeon (2000)",
        identifies: true,
        magnitude_only
    ),
    entry!(
        "two-dimensional",
        "inversion of the identifier, speed and geometry",
        "Lee, Cho and Jeon (2005)",
        identifies: true,
        two_dimensional
    ),
    entry!(
        "receding-horizon",
        "geometry planned over 10 knots ahead through an identified servo, speed as planned",
        "Lee, Cho and Jeon (2005), eq. 7 over a horizon; Gauss-Newton",
        identifies: true,
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
        (self.plane)(setup)
    }
}

impl Make<3> for Entry {
    fn make(&self, setup: &mut Setup<'_>) -> Box<dyn Controller<3>> {
        (self.space)(setup)
    }
}

impl std::fmt::Debug for Entry {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

fn open_loop<const N: usize>(_: &mut Setup<'_>) -> Box<dyn Controller<N>> {
    Box::new(OpenLoop)
}

fn magnitude_only<const N: usize>(setup: &mut Setup<'_>) -> Box<dyn Controller<N>> {
    let inversion = inversion::Settings { gradient: inversion::Gradient::Exact, ..Settings::DEFAULT.inversion };
    let settings = chosen(Settings { inversion, ..Settings::DEFAULT }, setup);
    Box::new(MagnitudeOnly::new(trained(setup).net, settings))
}

fn two_dimensional<const N: usize>(setup: &mut Setup<'_>) -> Box<dyn Controller<N>> {
    let settings = chosen(Settings::DEFAULT, setup);
    Box::new(TwoDimensional::new(trained(setup).net, settings))
}

fn receding_horizon<const N: usize>(setup: &mut Setup<'_>) -> Box<dyn Controller<N>> {
    let identified = servo::identify(setup.machine, &Programme::servo(), setup.choices.seed);
    Box::new(RecedingHorizon::new(identified.net, receding_horizon::Settings::DEFAULT))
}

fn chosen(mut settings: Settings, setup: &Setup<'_>) -> Settings {
    if let Some(rho) = setup.choices.rho {
        settings.inversion.rho = rho;
    }
    settings
}

fn trained<const N: usize>(setup: &mut Setup<'_>) -> Identified<N> {
    identified(setup.machine, &Programme::general(), &Training::default(), setup.choices.seed, setup.progress)
}
