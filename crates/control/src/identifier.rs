//! The family of identifiers: what knows the machine from its data. A network has 5N inputs, 12
//! hidden nodes and N outputs.
//!
//! | Kind | What it predicts | Contract | Used by |
//! |---|---|---|---|
//! | contour | the contour error, as the paper does | [`ContourModel`] | [`crate::inversion`] |
//! | axes | the motion of each axis, by its law | [`crate::axis::knowledge::AxisKnowledge`] | [`crate::controller::lqg_preview`] |
//!
//! All see the same inputs of each axis, from a shift register ([`Delays`]): F(k), F(k-1), F(k-2)
//! and two delays of the error, where F(k) is the feedrate from knot k to knot k + 1. A controller
//! takes any identifier of its kind; [`contour`] holds the only member. Its null member,
//! [`Identifier::NULL`], predicts nothing.
//!
//! An identifier does not see the place on the machine: errors that repeat with the place are not
//! part of its prediction.

pub(crate) mod contour;

/// Hidden nodes.
pub const HIDDEN: usize = 12;
/// Inputs of each axis.
pub const INPUTS: usize = 5;
/// The feedrate that the network sees as 1: the paper's reference feedrate.
pub const FEED_SCALE_MM_S: f64 = 50.0;
/// The contour error that the network sees as 1. Much larger, and the error drowns in the rounding
/// of the weights; much smaller, and the output saturates.
pub const ERROR_SCALE_MM: f64 = 0.1;
/// Feed periods that a machine can have, s: of the fastest servo period, and twelve of the slowest.
pub const FEED_PERIODS_S: [f64; 2] = [1e-5, 1.2];

/// What the network sees, indexed by axis and F(k), F(k-1), F(k-2), eps(k-1), eps(k-2); scaled.
pub type Inputs<const N: usize> = [[f64; INPUTS]; N];

/// What an identifier predicts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IdentifierKind {
    /// The contour error.
    Contour,
    /// Where each axis goes, from its law and the statistics of its noise (`knowledge`).
    Axes,
}

/// What all identifiers have in common.
pub trait Identifier<const N: usize>: Clone {
    /// What it predicts.
    const KIND: IdentifierKind;
    /// The error that it sees as 1, mm.
    const ERROR_SCALE_MM: f64;
    /// Predicts no error, whatever the inputs.
    const NULL: Self;

    /// Hands over its weights, group by group in a fixed order, each with its name: what is stored
    /// of it.
    fn weights(&mut self, each: &mut impl FnMut(&'static str, &mut [f64]));
}

/// An identifier that predicts the contour error of each axis, scaled by
/// [`Identifier::ERROR_SCALE_MM`].
pub trait ContourModel<const N: usize>: Identifier<N> {
    /// What a prediction leaves for its derivative.
    type Forward: Copy;
    /// What [`Self::Forward`] is before the first prediction.
    const AT_REST: Self::Forward;

    /// Predicts.
    fn forward(&self, inputs: &Inputs<N>) -> Self::Forward;
    /// The contour error that was predicted, scaled.
    fn error(forward: &Self::Forward) -> [f64; N];
    /// Derivative of that error to one of the inputs of each axis, indexed by output and axis.
    fn slopes(&self, forward: &Self::Forward, input: usize) -> [[f64; N]; N];
    /// Learns that these inputs led to this error, scaled, in a step of this size; 0 is frozen.
    /// Returns half the square of what it missed before.
    fn learn(&mut self, inputs: &Inputs<N>, error: [f64; N], step: f64) -> f64;
}

/// A feedrate as the network sees it.
#[inline]
pub fn seen_feed<const N: usize>(feed_mm_s: [f64; N]) -> [f64; N] {
    feed_mm_s.map(|feed| feed / FEED_SCALE_MM_S)
}

/// The shift register of the feedrates and errors of the last knots, scaled: what turns a sequence
/// into [`Inputs`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Delays<const N: usize> {
    /// F(k-1), F(k-2).
    pub feed: [[f64; N]; 2],
    /// The last error, and the one before.
    pub error: [[f64; N]; 2],
}

impl<const N: usize> Default for Delays<N> {
    fn default() -> Self {
        Self::REST
    }
}

impl<const N: usize> Delays<N> {
    /// At rest.
    pub const REST: Self = Self {
        feed: [[0.0; N]; 2],
        error: [[0.0; N]; 2],
    };

    /// The inputs for F(k), scaled.
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

    /// Moves on by one knot: F(k) was commanded, and this error, scaled, came of it or is predicted
    /// to.
    #[inline]
    pub fn push(&mut self, feed: [f64; N], error: [f64; N]) {
        self.feed = [feed, self.feed[0]];
        self.error = [error, self.error[0]];
    }
}
