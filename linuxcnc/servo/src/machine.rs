//! Models and geometries read from a model file.

use feedwright_control::{
    BlockError, ContourIdentifier, IdentifiedAxes, KnownGeometry, ModelBlock, Trained,
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

/// Model behind a correction.
#[derive(Debug, Clone)]
pub enum LinkModel<const N: usize> {
    /// Model of each axis.
    Axes(IdentifiedAxes<N>),
    /// Model of the contour error.
    Contour(TrainedContour<N>),
}

/// An identifier of the contour error, and its periods.
#[derive(Debug, Clone)]
pub struct TrainedContour<const N: usize> {
    /// The identifier.
    pub identifier: ContourIdentifier<N>,
    /// Servo period, s.
    pub servo_s: f64,
    /// Time between decisions, s.
    pub feed_period_s: f64,
}

impl<const N: usize> LinkModel<N> {
    /// Servo period, s.
    pub fn servo_s(&self) -> f64 {
        match self {
            Self::Axes(axes) => axes.periods.servo_s,
            Self::Contour(contour) => contour.servo_s,
        }
    }
}

/// Largest relative difference between the period of a thread and the servo period of the model. It
/// is needed because the periods of LinuxCNC threads are whole nanoseconds.
const PERIOD_TOLERANCE: f64 = 1e-3;

/// The model in these bytes.
///
/// # Errors
/// What is wrong with them.
pub fn model_of<const N: usize>(bytes: &[u8]) -> Result<LinkModel<N>, Refused> {
    let block = ModelBlock::from_bytes(bytes).map_err(Refused::Block)?;
    let ModelBlock {
        servo_s,
        feed_period_s,
        trained,
        ..
    } = block;
    match trained {
        Trained::Axes(axes) => Ok(LinkModel::Axes(axes)),
        Trained::Contour(identifier) => Ok(LinkModel::Contour(TrainedContour {
            identifier,
            servo_s,
            feed_period_s,
        })),
    }
}

/// Reads the geometry from these bytes; `None` if they have no geometry, or are no model.
pub fn geometry_of<const N: usize>(bytes: &[u8]) -> Option<KnownGeometry<N>> {
    ModelBlock::from_bytes(bytes)
        .ok()
        .and_then(|block| block.geometry)
}

/// The axes in these bytes.
///
/// # Errors
/// What is wrong with them.
pub fn axes_of<const N: usize>(bytes: &[u8]) -> Result<IdentifiedAxes<N>, Refused> {
    match model_of(bytes)? {
        LinkModel::Axes(axes) => Ok(axes),
        LinkModel::Contour(_) => Err(Refused::Kind),
    }
}

/// Returns true if a model with a servo period of `theirs_s` suits a thread with a period of
/// `servo_s`.
pub fn fits(theirs_s: f64, servo_s: f64) -> bool {
    (servo_s / theirs_s - 1.0).abs() <= PERIOD_TOLERANCE
}
