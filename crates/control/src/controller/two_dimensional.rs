//! The paper's controller: both components of the feedrate, by inversion of the identifier; see [`super::inverting`].
//!
//! Source: Lee, Cho and Jeon (2005), section 3.

use super::inverting::{Invert, Inverting};
use crate::identifier::{ContourModel, Inputs};
use crate::inversion;

/// Two-dimensional feedrate control (Lee, Cho and Jeon 2005).
pub type TwoDimensional<const N: usize> = Inverting<N, BothComponents>;

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
