//! The family of identifiers, which model the machine from its data. A network has 5N inputs, 12
//! hidden nodes and N outputs.
//!
//! | Kind | Prediction | Interface | Used by |
//! |---|---|---|---|
//! | contour | the contour error, as the paper does | [`ContourModel`] | [`crate::inversion`] |
//! | axes | the motion of each axis, by its model | [`crate::axis::Parameters`] | [`crate::controller::lqg_identified`] |
//!
//! All use the same inputs of each axis, from a shift register ([`Delays`]): F(k), F(k-1), F(k-2)
//! and two delays of the error, where F(k) is the feedrate from knot k to knot k + 1. A controller
//! takes any identifier of its kind; [`contour`] holds the only member. Its null member,
//! [`Identifier::NULL`], predicts zero error.
//!
//! An identifier does not know the place on the machine: it cannot predict errors that repeat with
//! the place.

pub(crate) mod contour;

/// Number of hidden nodes.
pub const HIDDEN: usize = 12;
/// Number of inputs of each axis.
pub const INPUTS: usize = 5;
/// Feedrate that the network sees as 1: the paper's reference feedrate.
pub const FEED_SCALE_MM_S: f64 = 50.0;
/// Contour error that the network sees as 1. With a much larger value the error drowns in the
/// rounding of the weights; with a much smaller one the output saturates.
pub const ERROR_SCALE_MM: f64 = 0.1;
/// Range of the feed period of a machine, s: from the fastest servo period to twelve of the
/// slowest.
pub const FEED_PERIODS_S: [f64; 2] = [1e-5, 1.2];

/// Inputs of the network, indexed by axis and F(k), F(k-1), F(k-2), eps(k-1), eps(k-2); scaled.
pub type Inputs<const N: usize> = [[f64; INPUTS]; N];

/// Quantity that an identifier predicts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IdentifierKind {
    /// The contour error.
    Contour,
    /// The motion of each axis, from its model and the statistics of its noise (`knowledge`).
    Axes,
}

/// Common part of all identifiers.
pub trait Identifier<const N: usize>: Clone {
    /// Quantity that the identifier predicts.
    const KIND: IdentifierKind;
    /// Contour error that the identifier sees as 1, mm.
    const ERROR_SCALE_MM: f64;
    /// Identifier that predicts no error, whatever the inputs.
    const NULL: Self;

    /// Passes its stored weights to `each`, group by group in a fixed order, each with its name.
    fn weights(&mut self, each: &mut impl FnMut(&'static str, &mut [f64]));
}

/// An identifier that predicts the contour error of each axis, scaled by
/// [`Identifier::ERROR_SCALE_MM`].
pub trait ContourModel<const N: usize>: Identifier<N> {
    /// Result of a prediction that its derivative needs.
    type Forward: Copy;
    /// Value of [`Self::Forward`] before the first prediction.
    const AT_REST: Self::Forward;

    /// Predicts.
    fn forward(&self, inputs: &Inputs<N>) -> Self::Forward;
    /// Returns the predicted contour error, scaled.
    fn error(forward: &Self::Forward) -> [f64; N];
    /// Returns the derivative of that error with respect to one of the inputs of each axis, indexed
    /// by output and axis.
    fn slopes(&self, forward: &Self::Forward, input: usize) -> [[f64; N]; N];
    /// Learns that these inputs led to this error, scaled, in a step of this size; 0 changes
    /// nothing. Returns half the square of the error of the prediction before the step.
    fn learn(&mut self, inputs: &Inputs<N>, error: [f64; N], step: f64) -> f64;
}

/// Scales a feedrate for the network.
#[inline]
pub fn seen_feed<const N: usize>(feed_mm_s: [f64; N]) -> [f64; N] {
    feed_mm_s.map(|feed| feed / FEED_SCALE_MM_S)
}

/// Shift register of the feedrates and errors of the last knots, scaled. It makes [`Inputs`] from a
/// sequence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Delays<const N: usize> {
    /// F(k-1), F(k-2).
    pub feed: [[f64; N]; 2],
    /// The last error and the one before it.
    pub error: [[f64; N]; 2],
}

impl<const N: usize> Default for Delays<N> {
    fn default() -> Self {
        Self::REST
    }
}

impl<const N: usize> Delays<N> {
    /// State at rest.
    pub const REST: Self = Self {
        feed: [[0.0; N]; 2],
        error: [[0.0; N]; 2],
    };

    /// Returns the inputs for F(k), scaled.
    #[inline]
    pub fn inputs(&self, feed: [f64; N]) -> Inputs<N> {
        core::array::from_fn(|a| {
            [
                feed[a],
                self.feed[0][a],
                self.feed[1][a],
                self.error[0][a],
                self.error[1][a],
            ]
        })
    }

    /// Advances by one knot: F(k) was commanded, and this scaled error was measured or predicted.
    #[inline]
    pub fn push(&mut self, feed: [f64; N], error: [f64; N]) {
        self.feed = [feed, self.feed[0]];
        self.error = [error, self.error[0]];
    }
}
