//! The paper's baseline: the same inversion on the magnitude of the feedrate; the geometry stays on the path.
//!
//! Source: Yoon and Jeon (2000), as described in Lee, Cho and Jeon (2005), sections 1 and 4.

use super::two_dimensional::{Loop, Settings};
use super::{Command, Controller, Measured, Schedule};
use crate::identifier::contour::ContourIdentifier;
use crate::inversion;
use crate::window::Window;

/// Feedrate magnitude control (Yoon and Jeon 2000).
#[derive(Debug, Clone)]
pub struct MagnitudeOnly<const N: usize>(Loop<N>);

impl<const N: usize> MagnitudeOnly<N> {
    /// With an identifier that is trained on the machine.
    pub fn new(trained: ContourIdentifier<N>, settings: Settings) -> Self {
        Self(Loop::new(trained, settings))
    }
}

impl<const N: usize> Controller<N> for MagnitudeOnly<N> {
    fn schedule(&self) -> Schedule {
        self.0.schedule()
    }

    fn reset(&mut self) {
        self.0.reset();
    }

    fn observe(&mut self, measured: &Measured<N>) {
        self.0.observe(measured);
    }

    fn command(&mut self, window: &Window<'_, N>, _: &Measured<N>) -> Command<N> {
        let command = self.0.command(window, inversion::invert_magnitude);
        Command { offset_mm: [0.0; N], ..command }
    }
}
