//! The paper's baseline: the same inversion on the magnitude of the feedrate; the geometry stays on
//! the path.
//!
//! Source: Yoon and Jeon (2000), as described in Lee, Cho and Jeon (2005), sections 1 and 4.

use super::inverting::{Invert, Inverting, InvertingSettings};
use crate::identifier::{ContourModel, Inputs};
use crate::inversion::{self, Gradient};

/// Feedrate magnitude control (Yoon and Jeon 2000).
pub type MagnitudeOnly<const N: usize> = Inverting<N, Magnitude>;

impl<const N: usize, D: ContourModel<N>> Inverting<N, Magnitude, D> {
    /// Creates the controller with the exact gradient, whichever gradient `settings` state. The
    /// printed gradient has the opposite sign: it stands in for a Jacobian across the path, and no
    /// part of this command is across.
    pub fn exact(trained: D, settings: InvertingSettings) -> Self {
        let inversion = inversion::InversionSettings {
            gradient: Gradient::Exact,
            ..settings.inversion
        };
        Self::new(
            trained,
            InvertingSettings {
                inversion,
                ..settings
            },
            None,
        )
    }
}

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
