//! The paper's baseline: the same inversion on the magnitude of the feedrate; the geometry stays on the path.
//!
//! Source: Yoon and Jeon (2000), as described in Lee, Cho and Jeon (2005), sections 1 and 4.

use super::inverting::{Invert, Inverting};
use crate::identifier::{ContourModel, Inputs};
use crate::inversion;

/// Feedrate magnitude control (Yoon and Jeon 2000).
pub type MagnitudeOnly<const N: usize> = Inverting<N, Magnitude>;

/// F keeps its direction along the path: nothing of it is across, so the offset stays zero.
#[derive(Debug, Clone, Copy)]
pub struct Magnitude;

impl Invert for Magnitude {
    fn invert<const N: usize, D: ContourModel<N>>(
        net: &D,
        inputs: &Inputs<N>,
        feeds: &mut [[f64; N]],
        settings: &inversion::InversionSettings,
    ) {
        inversion::invert_magnitude(net, inputs, feeds, settings);
    }
}
