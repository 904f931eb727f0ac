//! The paper's controller: both components of the feedrate, by inversion of the identifier; see
//! [`super::inverting`].
//!
//! Source: Lee, Cho and Jeon (2005), section 3.

use super::inverting::{Invert, Inverting, InvertingSettings};
use super::row::{ControllerData, ControllerRow, Knows, Member, Values};
use crate::identifier::{ContourModel, IdentifierKind, Inputs};
use crate::inversion;
use crate::model::Trained;

/// Two-dimensional feedrate control (Lee, Cho and Jeon 2005).
pub type TwoDimensional<const N: usize> = Inverting<N, BothComponents>;

impl<const N: usize, D: ContourModel<N>> Inverting<N, BothComponents, D> {
    /// Creates the controller of the paper, which corrects from the first decision on, whether that
    /// helps or not. It serves to repeat the paper's figures.
    pub fn untried(trained: D, settings: InvertingSettings) -> Self {
        Self::new(trained, settings, None)
    }
}

/// Response time of the speed loops where the model does not state it, s. The speed loops of the
/// machine files of this repository respond within 2 to 12 ms, `tnv40` within 6.
const UNSTATED_RESPONSE_S: f64 = 0.006;

impl<const N: usize> Member<N> for TwoDimensional<N> {
    const ROW: ControllerRow = ControllerRow {
        name: "two-dimensional",
        knows: Knows::Identified,
        identifier: Some(IdentifierKind::Contour),
        parameters: InvertingSettings::PARAMETERS,
    };

    /// Creates the controller for a machine. If it tries, the correction enters the loop once the
    /// measured errors show that it helps; see `controller/trial.rs`.
    fn make(data: &ControllerData<'_, N>, values: Values<'_>) -> Option<Self> {
        let model = data.model?;
        let Trained::Contour { net, response_s } = &model.trained else {
            return None;
        };
        let response_s = if *response_s > 0.0 {
            *response_s
        } else {
            UNSTATED_RESPONSE_S
        };
        let settings = InvertingSettings::of(model, values);
        let tried_response_s = data.tries.then_some(response_s);
        Some(Self::new(net.clone(), settings, tried_response_s))
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
