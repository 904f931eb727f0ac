//! Uncorrected: the path as planned. The null member of the family.

use super::{Controller, Schedule};
use crate::command::{Command, Measured};
use crate::window::Window;

/// Commands the programmed path at the planned feed.
#[derive(Debug, Clone, Copy, Default)]
pub struct Uncorrected;

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
