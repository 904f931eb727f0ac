//! The paper's baseline: the same inversion on the magnitude of the feedrate; the geometry stays on
//! the path.
//!
//! Source: Yoon and Jeon (2000), as described in Lee, Cho and Jeon (2005), sections 1 and 4.

use super::inverting::{Invert, Inverting, InvertingSettings};
use super::row::{ControllerData, ControllerRow, Knows, Member, Values};
use crate::identifier::{ContourModel, IdentifierKind, Inputs};
use crate::inversion::{self, Gradient};
use crate::model::Trained;

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

impl<const N: usize> Member<N> for MagnitudeOnly<N> {
    const ROW: ControllerRow = ControllerRow {
        name: "magnitude-only",
        knows: Knows::Identified,
        identifier: Some(IdentifierKind::Contour),
        parameters: InvertingSettings::PARAMETERS,
    };

    fn make(data: &ControllerData<'_, N>, values: Values<'_>) -> Option<Self> {
        let model = data.model?;
        let Trained::Contour { net, .. } = &model.trained else {
            return None;
        };
        let settings = InvertingSettings::of(model, values);
        Some(Self::exact(net.clone(), settings))
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
