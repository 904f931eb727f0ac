//! Models read from a model file, and the controllers that are made from them.

use feedwright_control::{
    AnyController, BlockError, ControllerData, IdentifiedAxes, IdentifierKind, KnownGeometry,
    MemberName, ModelBlock, OffsetBounds, Trained, TrainedModel, Uncorrected,
};

/// Why a model cannot be used here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refused {
    /// The bytes are not a valid model for this number of axes.
    Block(BlockError),
    /// It is of another kind than is needed.
    Kind,
    /// It was identified with another servo period.
    Period,
}

/// Largest relative difference between the period of a thread and the servo period of the model. It
/// is needed because the periods of LinuxCNC threads are whole nanoseconds.
const PERIOD_TOLERANCE: f64 = 1e-3;

/// The model and the geometry in these bytes.
///
/// # Errors
/// What is wrong with them.
pub fn model_of<const N: usize>(bytes: &[u8]) -> Result<ModelBlock<N>, Refused> {
    ModelBlock::from_bytes(bytes).map_err(Refused::Block)
}

/// The axes and the geometry in these bytes.
///
/// # Errors
/// What is wrong with them.
pub fn axes_of<const N: usize>(
    bytes: &[u8],
) -> Result<(IdentifiedAxes<N>, Option<KnownGeometry<N>>), Refused> {
    let ModelBlock { model, geometry } = model_of(bytes)?;
    match model.trained {
        Trained::Axes(axes) => Ok((axes, geometry)),
        Trained::Contour { .. } => Err(Refused::Kind),
    }
}

/// Returns the controller that stands in the link with a model of this kind. With `speed_alone`, the
/// geometry stays on the path, if there is such a controller.
pub fn member_of(kind: IdentifierKind, speed_alone: bool) -> MemberName {
    match kind {
        IdentifierKind::Axes => MemberName::LqgIdentified,
        IdentifierKind::Contour if speed_alone => MemberName::MagnitudeOnly,
        IdentifierKind::Contour => MemberName::TwoDimensional,
    }
}

/// Creates this controller for the link, uncorrected if the model is of another kind. Unless
/// `is_known`, it corrects nothing before motion has shown that the model is of this machine.
pub fn live_controller<const N: usize>(
    member: MemberName,
    model: &TrainedModel<N>,
    is_known: bool,
    bounds: OffsetBounds,
) -> AnyController<N> {
    let data = ControllerData {
        model: Some(model),
        inverse: None,
        bounds,
        tries: true,
        is_known,
    };
    AnyController::make(member, &data, &|parameter| parameter.default)
        .unwrap_or(AnyController::Uncorrected(Uncorrected))
}

/// Returns true if a model with a servo period of `theirs_s` suits a thread with a period of
/// `servo_s`.
pub fn fits(theirs_s: f64, servo_s: f64) -> bool {
    (servo_s / theirs_s - 1.0).abs() <= PERIOD_TOLERANCE
}
