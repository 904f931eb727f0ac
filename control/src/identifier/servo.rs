//! The servo identifier: predicts how the following error grows, whatever the path.
//!
//! ```text
//! e(k+1) - e(k) = L I + c W_o f(W_h I)
//! ```
//!
//! e = P' - P is the following error (command minus tool) of each axis; I are the inputs F(k), F(k-1), F(k-2), e(k), e(k-1)
//! of all axes. L is a linear skip connection: a servo is mostly linear, and the network adds what is not (friction).
//! The dynamics of e do not depend on the path, so the network learns the machine and not the contours it was shown;
//! the contour error then is exact geometry.
//!
//! Source: the input structure of Lee, Cho and Jeon (2005), section 3.2, on another output; skip connections from
//! inputs to outputs are classical (Rumelhart, Hinton and Williams 1986).

use super::{HIDDEN, INPUTS, Identifier, IdentifierKind, Inputs, ServoModel, UNKNOWNS};
use crate::activation::{bipolar_sigmoid, slope};
use crate::vector::add_scaled;

/// The following error that the network sees as 1: the lag of a 50 1/s position loop at 50 mm/s.
pub const FOLLOWING_SCALE_MM: f64 = 1.0;

/// The weights. Feedrates are scaled by [`super::FEED_SCALE_MM_S`], following errors by [`FOLLOWING_SCALE_MM`]; the
/// output is in mm.
#[derive(Debug, Clone, PartialEq)]
pub struct ServoIdentifier<const N: usize> {
    /// L, indexed by output, axis, and input of that axis.
    pub linear: [[[f64; INPUTS]; N]; N],
    /// W_h, indexed by axis, input of that axis, and hidden node.
    pub hidden: [[[f64; HIDDEN]; INPUTS]; N],
    /// c W_o, indexed by output and hidden node, mm.
    pub output: [[f64; HIDDEN]; N],
}

impl<const N: usize> ServoIdentifier<N> {
    /// f(W_h I).
    #[inline]
    pub fn hidden_nodes(&self, inputs: &Inputs<N>) -> [f64; HIDDEN] {
        let mut net = [0.0; HIDDEN];
        for axis in 0..N {
            for input in 0..INPUTS {
                for j in 0..HIDDEN {
                    net[j] += self.hidden[axis][input][j] * inputs[axis][input];
                }
            }
        }
        bipolar_sigmoid(net)
    }
}

impl<const N: usize> Identifier<N> for ServoIdentifier<N> {
    const KIND: IdentifierKind = IdentifierKind::Servo;
    const ERROR_SCALE_MM: f64 = FOLLOWING_SCALE_MM;
    /// The following error of an ideal servo grows with nothing.
    const NULL: Self =
        Self { linear: [[[0.0; INPUTS]; N]; N], hidden: [[[0.0; HIDDEN]; INPUTS]; N], output: [[0.0; HIDDEN]; N] };

    fn weights(&mut self, each: &mut impl FnMut(&'static str, &mut [f64])) {
        each("linear", self.linear.as_flattened_mut().as_flattened_mut());
        each("hidden", self.hidden.as_flattened_mut().as_flattened_mut());
        each("output", self.output.as_flattened_mut());
    }
}

impl<const N: usize> ServoModel<N> for ServoIdentifier<N> {
    /// The mean over the axes of e / F where L I = 0.
    fn lag_s(&self) -> f64 {
        let mut sum = 0.0;
        for axis in 0..N {
            let [f0, f1, f2, e0, e1] = self.linear[axis][axis];
            let lag = -(f0 + f1 + f2) / (e0 + e1) * FOLLOWING_SCALE_MM / super::FEED_SCALE_MM_S;
            sum += if lag.is_finite() { lag } else { 0.0 };
        }
        sum / N as f64
    }

    #[inline]
    fn predict(&self, inputs: &Inputs<N>) -> [f64; N] {
        add_scaled(self.predict_linear(inputs), 1.0, self.predict_rest(inputs))
    }

    #[inline]
    fn predict_with_slopes(&self, inputs: &Inputs<N>) -> ([f64; N], Inputs<N>) {
        let hidden = self.hidden_nodes(inputs);
        let mut grown_mm = self.predict_linear(inputs);
        let mut slopes = [[0.0; INPUTS]; N];
        for o in 0..N {
            let mut weights = [0.0; HIDDEN];
            for j in 0..HIDDEN {
                grown_mm[o] += self.output[o][j] * hidden[j];
                weights[j] = self.output[o][j] * slope(hidden[j]);
            }
            for input in 0..INPUTS {
                slopes[o][input] = self.linear[o][o][input];
                for j in 0..HIDDEN {
                    slopes[o][input] += weights[j] * self.hidden[o][input][j];
                }
            }
        }
        (grown_mm, slopes)
    }

    /// c W_o f(W_h I).
    #[inline]
    fn predict_rest(&self, inputs: &Inputs<N>) -> [f64; N] {
        let hidden = self.hidden_nodes(inputs);
        core::array::from_fn(|o| {
            let mut sum = 0.0;
            for j in 0..HIDDEN {
                sum += self.output[o][j] * hidden[j];
            }
            sum
        })
    }

    /// L I.
    #[inline]
    fn predict_linear(&self, inputs: &Inputs<N>) -> [f64; N] {
        let mut increment = [0.0; N];
        for o in 0..N {
            for axis in 0..N {
                for input in 0..INPUTS {
                    increment[o] += self.linear[o][axis][input] * inputs[axis][input];
                }
            }
        }
        increment
    }

    #[inline]
    fn own_linear(&self, axis: usize) -> &[f64; INPUTS] {
        &self.linear[axis][axis]
    }

    #[inline]
    fn change(&mut self, trained: &Self, axis: usize, change: &[f64; UNKNOWNS]) {
        for input in 0..INPUTS {
            self.linear[axis][axis][input] = trained.linear[axis][axis][input] + change[input];
        }
        self.output[axis] = trained.output[axis].map(|weight| weight * (1.0 + change[INPUTS]));
    }
}
