//! The family of identifiers: small networks, 5N inputs, 12 hidden nodes, N outputs, that know the machine from its data.
//!
//! [`contour`] predicts the contour error, as the paper does; [`servo`] predicts the following error and leaves the
//! contour error to geometry. Both see the same inputs of each axis: F(k), F(k-1), F(k-2) and two delays of the error,
//! where F(k) is the feedrate from knot k to knot k + 1.

pub mod contour;
pub mod servo;
pub mod residual;
pub mod adaptation;

/// Hidden nodes.
pub const HIDDEN: usize = 12;
/// Inputs of each axis.
pub const INPUTS: usize = 5;
/// The feedrate that the network sees as 1: the paper's reference feedrate.
pub const FEED_SCALE_MM_S: f64 = 50.0;
/// The error that the network sees as 1. Much larger, and the error drowns in the rounding of the weights; much
/// smaller, and the output saturates.
pub const ERROR_SCALE_MM: f64 = 0.1;

/// What the network sees, indexed by axis and F(k), F(k-1), F(k-2), eps(k-1), eps(k-2); scaled.
pub type Inputs<const N: usize> = [[f64; INPUTS]; N];

/// The delayed feedrates and errors of the last knots: what turns a sequence into [`Inputs`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct History<const N: usize> {
    feed: [[f64; N]; 2],
    error: [[f64; N]; 2],
}

impl<const N: usize> Default for History<N> {
    fn default() -> Self {
        Self { feed: [[0.0; N]; 2], error: [[0.0; N]; 2] }
    }
}

impl<const N: usize> History<N> {
    /// The inputs for a feedrate F(k) in mm/s.
    #[inline]
    pub fn inputs(&self, feed_mm_s: [f64; N]) -> Inputs<N> {
        core::array::from_fn(|a| {
            [feed_mm_s[a] / FEED_SCALE_MM_S, self.feed[0][a], self.feed[1][a], self.error[0][a], self.error[1][a]]
        })
    }

    /// Shifts in the feedrate that was commanded, mm/s, and the error that it led to, mm.
    #[inline]
    pub fn push(&mut self, feed_mm_s: [f64; N], error_mm: [f64; N]) {
        self.feed = [feed_mm_s.map(|f| f / FEED_SCALE_MM_S), self.feed[0]];
        self.error = [error_mm.map(|e| e / ERROR_SCALE_MM), self.error[0]];
    }
}
