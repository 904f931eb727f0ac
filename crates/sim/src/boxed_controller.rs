//! A controller of two or of three axes.
//!
//! Controllers, tick and closed loop depend on the number of axes. This crate compiles them, with
//! optimization, for two and for three. A crate that cuts with a [`BoxedController`] compiles none
//! of them again.

use feedwright_control::{
    AnyController, Controller, ControllerData, MemberName, Uncorrected, Values,
};

/// A controller of two or of three axes.
pub enum BoxedController {
    /// Controls X and Y.
    Plane(Box<dyn Controller<2>>),
    /// Controls X, Y and Z.
    Space(Box<dyn Controller<3>>),
}

impl BoxedController {
    /// The programmed path at the planned feed, for 2 or 3 axes.
    pub fn uncorrected(axes: usize) -> Self {
        match axes {
            2 => Self::Plane(Box::new(Uncorrected)),
            _ => Self::Space(Box::new(Uncorrected)),
        }
    }

    /// Makes a controller of the family for two axes; `None` where `data` lacks what it has to
    /// know.
    pub fn in_plane(
        member: MemberName,
        data: &ControllerData<'_, 2>,
        values: Values<'_>,
    ) -> Option<Box<dyn Controller<2>>> {
        AnyController::make(member, data, values).map(boxed)
    }

    /// Makes a controller of the family for three axes; `None` where `data` lacks what it has to
    /// know.
    pub fn in_space(
        member: MemberName,
        data: &ControllerData<'_, 3>,
        values: Values<'_>,
    ) -> Option<Box<dyn Controller<3>>> {
        AnyController::make(member, data, values).map(boxed)
    }

    /// Number of axes.
    pub const fn axes(&self) -> usize {
        match self {
            Self::Plane(_) => 2,
            Self::Space(_) => 3,
        }
    }
}

fn boxed<const N: usize>(controller: AnyController<N>) -> Box<dyn Controller<N>> {
    match controller {
        AnyController::Uncorrected(controller) => Box::new(controller),
        AnyController::Feedforward(controller) => Box::new(controller),
        AnyController::MagnitudeOnly(controller) => Box::new(controller),
        AnyController::TwoDimensional(controller) => Box::new(controller),
        AnyController::LqgIdentified(controller) => Box::new(controller),
    }
}
