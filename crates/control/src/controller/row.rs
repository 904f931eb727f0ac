//! The row of a controller: its name, what it has to know of a machine, its parameters, and how it
//! is made.

use super::{Controller, OffsetBounds};
use crate::axis::inverse::AxisInverse;
use crate::identifier::IdentifierKind;
use crate::model::TrainedModel;

/// A row of a table of controllers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControllerRow {
    /// Name on the command line.
    pub name: &'static str,
    /// Knowledge of the machine.
    pub knows: Knows,
    /// Kind of identifier, if the controller uses one.
    pub identifier: Option<IdentifierKind>,
    /// Parameters that can be set, beginning with those whose best values the comparison searches
    /// for.
    pub parameters: &'static [Parameter],
}

/// Knowledge that a controller has of the machine before it cuts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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

/// A parameter of a controller that can be set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Name, with its unit at the end.
    pub name: &'static str,
    /// Value where none is given.
    pub default: f64,
    /// Least and largest value that it can be set to.
    pub allowed: [f64; 2],
    /// Range in which the comparison searches for the best value; by ratios where the range begins
    /// above zero.
    pub searched: Option<[f64; 2]>,
    /// True if only whole numbers are allowed in this range.
    pub is_whole: bool,
    /// Description of the parameter, and of what goes wrong if it is too small or too large.
    pub reason: &'static str,
    /// Unit of a value that is no plain number.
    pub unit: Option<&'static str>,
}

impl Parameter {
    /// A parameter of any value.
    pub const fn number(
        name: &'static str,
        default: f64,
        allowed: [f64; 2],
        searched: Option<[f64; 2]>,
        reason: &'static str,
    ) -> Self {
        Self {
            name,
            default,
            allowed,
            searched,
            is_whole: false,
            reason,
            unit: None,
        }
    }

    /// A parameter that is a whole number.
    pub const fn whole(
        name: &'static str,
        default: usize,
        allowed: [f64; 2],
        reason: &'static str,
    ) -> Self {
        Self {
            is_whole: true,
            ..Self::number(name, default as f64, allowed, None, reason)
        }
    }

    /// The parameter with a unit of its values.
    pub const fn of_unit(self, unit: &'static str) -> Self {
        Self {
            unit: Some(unit),
            ..self
        }
    }
}

/// Value of each parameter of a controller.
pub type Values<'a> = &'a dyn Fn(&Parameter) -> f64;

/// Data of a machine and of its use from which a controller is made.
#[derive(Debug, Clone, Copy)]
pub struct ControllerData<'a, const N: usize> {
    /// Trained model of the kind that the controller uses.
    pub model: Option<&'a TrainedModel<N>>,
    /// Exact inverse of the axes, where it is known.
    pub inverse: Option<&'a [AxisInverse; N]>,
    /// Bounds of the offset.
    pub bounds: OffsetBounds,
    /// True if a correction must show that it helps before it is followed, where the controller can
    /// do without that.
    pub tries: bool,
    /// True if the controller was used on this machine before. Otherwise its model has to pass a
    /// test before anything is corrected.
    pub is_known: bool,
}

/// A controller that is made from the data of a machine.
pub trait Member<const N: usize>: Controller<N> + Sized {
    /// Row of the controller.
    const ROW: ControllerRow;

    /// Creates the controller; `None` where `data` lacks what it has to know.
    fn make(data: &ControllerData<'_, N>, values: Values<'_>) -> Option<Self>;
}
