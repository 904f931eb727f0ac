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

/// How machines of a kind differ from the identified one: mean squares and products of what [`ServoModel::change`] takes, axis
/// by axis.
pub type Spread<const N: usize> = [[[f64; UNKNOWNS]; UNKNOWNS]; N];

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identifier::FEED_SCALE_MM_S;

    /// Two axes that see each other, with hidden nodes of any kind.
    fn net() -> ServoIdentifier<2> {
        let weight = |i: usize, j: usize, k: usize| libm::sin((7 * i + 3 * j + k) as f64);
        ServoIdentifier {
            linear: core::array::from_fn(|o| core::array::from_fn(|a| core::array::from_fn(|i| weight(o, a, i)))),
            hidden: core::array::from_fn(|a| core::array::from_fn(|i| core::array::from_fn(|j| weight(a, i, j)))),
            output: core::array::from_fn(|o| core::array::from_fn(|j| 0.3 * weight(o, j, 5))),
        }
    }

    const INPUTS_SEEN: Inputs<2> = [[0.3, -0.2, 0.5, 0.1, -0.4], [0.7, 0.2, -0.6, 0.05, 0.2]];

    #[test]
    fn the_slopes_are_the_difference_quotients_of_an_axis_to_its_own_inputs() {
        let net = net();
        let (grown_mm, slopes) = net.predict_with_slopes(&INPUTS_SEEN);
        assert_eq!(grown_mm.map(f64::to_bits), net.predict_with_slopes(&INPUTS_SEEN).0.map(f64::to_bits));
        for axis in 0..2 {
            assert!((grown_mm[axis] - net.predict(&INPUTS_SEEN)[axis]).abs() < 1e-14);
            for input in 0..INPUTS {
                let h = 1e-6;
                let at = |change: f64| {
                    let mut inputs = INPUTS_SEEN;
                    inputs[axis][input] += change;
                    net.predict(&inputs)[axis]
                };
                let quotient = (at(h) - at(-h)) / (2.0 * h);
                assert!((quotient - slopes[axis][input]).abs() < 1e-8, "axis {axis}, input {input}");
            }
        }
    }

    #[test]
    fn the_lag_is_the_following_error_at_constant_feedrate_in_seconds() {
        // e grows by T F - T e / lag: at rest where e = lag F.
        let (period_s, lag_s) = (0.003, 0.02);
        let mut net = ServoIdentifier::<2>::NULL;
        for axis in 0..2 {
            net.linear[axis][axis][0] = period_s * FEED_SCALE_MM_S;
            net.linear[axis][axis][3] = -period_s / lag_s * FOLLOWING_SCALE_MM;
        }
        assert!((net.lag_s() - lag_s).abs() < 1e-12, "{}", net.lag_s());
        assert_eq!(ServoIdentifier::<2>::NULL.lag_s(), 0.0);
    }

    #[test]
    fn a_change_is_added_to_the_linear_part_and_multiplies_the_hidden_one() {
        let (trained, mut now) = (net(), net());
        now.change(&trained, 1, &[0.1, 0.0, 0.0, 0.0, -0.2, 0.5]);
        assert_eq!(now.linear[0], trained.linear[0]);
        assert_eq!(now.linear[1][1][0], trained.linear[1][1][0] + 0.1);
        assert_eq!(now.linear[1][1][4], trained.linear[1][1][4] - 0.2);
        assert_eq!(now.output[0], trained.output[0]);
        assert_eq!(now.output[1], trained.output[1].map(|weight| 1.5 * weight));
    }
}
