//! The paper's controller: both components of the feedrate, by inversion of the identifier; see
//! [`super::inverting`].
//!
//! Source: Lee, Cho and Jeon (2005), section 3.

use super::inverting::{Invert, Inverting, InvertingSettings};
use crate::identifier::{ContourModel, Inputs};
use crate::inversion;

/// Two-dimensional feedrate control (Lee, Cho and Jeon 2005).
pub type TwoDimensional<const N: usize> = Inverting<N, BothComponents>;

impl<const N: usize, D: ContourModel<N>> Inverting<N, BothComponents, D> {
    /// Creates the controller for a machine: the correction enters the loop once the measured
    /// errors show that it helps; see `controller/trial.rs`. `response_s` is the response time of
    /// the slowest speed loop, s.
    pub fn on_trial(trained: D, settings: InvertingSettings, response_s: f64) -> Self {
        Self::new(trained, settings, Some(response_s))
    }

    /// Creates the controller of the paper, which corrects from the first decision on, whether that
    /// helps or not. It serves to repeat the paper's figures.
    pub fn untried(trained: D, settings: InvertingSettings) -> Self {
        Self::new(trained, settings, None)
    }
}

/// F moves freely: along the path it changes the speed, across it the geometry.
#[derive(Debug, Clone, Copy)]
pub struct BothComponents;

impl Invert for BothComponents {
    fn invert<const N: usize, D: ContourModel<N>>(
        net: &D,
        inputs: &Inputs<N>,
        feeds: &mut [[f64; N]],
        settings: &inversion::InversionSettings,
    ) {
        inversion::invert(net, inputs, feeds, settings);
    }
}
