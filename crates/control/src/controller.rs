//! The family of controllers. Once a feed period, each decides the feedrate along the path and the
//! offset from it.
//!
//! To add a controller: one file here with its row, and its name in the table below. A simulation
//! and a servo thread make it in the same way, by its name or by its type.

pub(crate) mod row;
pub(crate) mod uncorrected;
pub(crate) mod feedforward;
pub(crate) mod lqg_identified;
pub(crate) mod inverting;
pub(crate) mod magnitude_only;
pub(crate) mod two_dimensional;

use core::ops::{Deref, DerefMut};

use crate::axis::AxisModel;
use crate::command::{Command, Measured, SelfReport};
use crate::window::Window;
use feedforward::Feedforward;
use lqg_identified::LqgIdentified;
use magnitude_only::MagnitudeOnly;
use row::{ControllerData, ControllerRow, Member, Values};
use two_dimensional::TwoDimensional;
use uncorrected::Uncorrected;

/// Feed period and preview that a controller requests.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Schedule {
    /// Servo periods in a feed period, at least 1.
    pub servo_periods: u32,
    /// Feed periods of preview; together at most `PREVIEW_KNOTS` servo periods.
    pub preview: u32,
}

/// Bounds of an offset, whatever the request.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OffsetBounds {
    /// Largest offset, mm.
    pub largest_mm: f64,
    /// Largest rate of change of the offset, mm/s.
    pub fastest_mm_s: f64,
    /// Largest acceleration of a command, the path included, mm/s2; the smallest of all axes.
    pub acceleration_mm_s2: f64,
}

impl OffsetBounds {
    /// No bounds.
    pub const NONE: Self = Self {
        largest_mm: f64::INFINITY,
        fastest_mm_s: f64::INFINITY,
        acceleration_mm_s2: f64::INFINITY,
    };

    /// Returns true if the acceleration of a command is limited.
    pub(crate) fn limits_acceleration(&self) -> bool {
        self.acceleration_mm_s2 < f64::INFINITY
    }
}

/// Interface of a controller. The conformance tests of the library admit a controller: rest stays
/// rest, the same input gives the same bits, a reset is complete, a NaN measurement gives a finite
/// command.
pub trait Controller<const N: usize> {
    /// Returns the feed period and the preview.
    fn schedule(&self) -> Schedule;
    /// Resets the state to the one after construction.
    fn reset(&mut self);
    /// Forgets the machine: another one may be present.
    fn forget_machine(&mut self) {
        self.reset();
    }
    /// Changes the bounds of the offset that the controller itself keeps. The supervisor keeps them
    /// for every controller.
    fn hold_to(&mut self, bounds: OffsetBounds) {
        let _ = bounds;
    }
    /// Starts the same part once more and keeps what was learned from it.
    fn next_lap(&mut self) {
        self.reset();
    }
    /// Learns from the result of the last feed period. The window has the actual commands up to
    /// now, which can differ from the requested ones. `measured` is their result, `None` where the
    /// position was lost. Called once a feed period, before [`Self::command`], which is not called
    /// where nothing was measured.
    fn observe(&mut self, window: &Window<'_, N>, measured: Option<&Measured<N>>) {
        let _ = (window, measured);
    }
    /// Returns what the controller reports on itself; called after each decision.
    fn report(&self) -> SelfReport<N> {
        SelfReport::CORRECTS
    }
    /// Returns the axes as the controller knows them now, if it uses such knowledge. A controller
    /// that learns returns other axes than the ones of its construction.
    fn known(&self) -> Option<[AxisModel; N]> {
        None
    }
    /// Decides the command of the next feed period.
    fn command(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N>;
}

/// Declares the table of the controllers that a machine runs.
macro_rules! members {
    ($($Name:ident($Type:ty)),* $(,)?) => {
        /// A controller of the table.
        #[expect(
            clippy::large_enum_variant,
            reason = "there is one controller, and a servo thread must not allocate"
        )]
        #[derive(Debug, Clone)]
        pub enum AnyController<const N: usize> {
            $(#[doc = concat!("[`", stringify!($Name), "`].")] $Name($Type)),*
        }

        /// Place of a controller in the table.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum MemberName {
            $(#[doc = concat!("[`", stringify!($Name), "`].")] $Name),*
        }

        impl<const N: usize> AnyController<N> {
            /// Rows of all controllers that a machine runs.
            pub const ROWS: &[(MemberName, ControllerRow)] =
                &[$((MemberName::$Name, <$Type as Member<N>>::ROW)),*];

            /// Creates a controller; `None` where `data` lacks what it has to know.
            pub fn make(
                member: MemberName,
                data: &ControllerData<'_, N>,
                values: Values<'_>,
            ) -> Option<Self> {
                match member {
                    $(MemberName::$Name => <$Type>::make(data, values).map(Self::$Name)),*
                }
            }

            /// Returns the place of the controller in the table.
            pub fn member(&self) -> MemberName {
                match self {
                    $(Self::$Name(_) => MemberName::$Name),*
                }
            }

            /// Returns the name of the controller on the command line.
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$Name(_) => <$Type as Member<N>>::ROW.name),*
                }
            }
        }

        impl<const N: usize> Deref for AnyController<N> {
            type Target = dyn Controller<N>;

            fn deref(&self) -> &Self::Target {
                match self {
                    $(Self::$Name(controller) => controller),*
                }
            }
        }

        impl<const N: usize> DerefMut for AnyController<N> {
            fn deref_mut(&mut self) -> &mut Self::Target {
                match self {
                    $(Self::$Name(controller) => controller),*
                }
            }
        }
    };
}

members! {
    Uncorrected(Uncorrected),
    Feedforward(Feedforward<N>),
    MagnitudeOnly(MagnitudeOnly<N>),
    TwoDimensional(TwoDimensional<N>),
    LqgIdentified(LqgIdentified<N>),
}
