//! Uncorrected: the path as planned. The null member of the family.

use super::row::{ControllerData, ControllerRow, Knows, Member, Values};
use super::{Controller, Schedule};
use crate::command::{Command, Measured};
use crate::window::Window;

/// Commands the programmed path at the planned feed.
#[derive(Debug, Clone, Copy, Default)]
pub struct Uncorrected;

impl<const N: usize> Member<N> for Uncorrected {
    const ROW: ControllerRow = ControllerRow {
        name: "uncorrected",
        knows: Knows::Nothing,
        identifier: None,
        parameters: &[],
    };

    fn make(_: &ControllerData<'_, N>, _: Values<'_>) -> Option<Self> {
        Some(Self)
    }
}

impl<const N: usize> Controller<N> for Uncorrected {
    fn schedule(&self) -> Schedule {
        Schedule {
            servo_periods: 1,
            preview: 0,
        }
    }

    fn reset(&mut self) {}

    fn command(&mut self, _: &Window<'_, N>, _: &Measured<N>) -> Command<N> {
        Command::AS_PLANNED
    }
}
