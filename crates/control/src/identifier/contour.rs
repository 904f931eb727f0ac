//! The paper's identifier (NNI): predicts the contour error of each axis from the feedrates and the
//! errors before.
//!
//! ```text
//! eps_o = f(net_o)                                                                             (3)
//! net_o = sum_j W_oj f(net_j),  j = 1..12                                                      (4)
//! net_j = sum_i W_ji I(i),      i = 1..5N                                                      (5)
//! E_n   = 1/2 sum_o (eps_o - eps_hat_o)^2                                                      (6)
//! ```
//!
//! Inputs of each axis: F(k), F(k-1), F(k-2), eps(k-1), eps(k-2). F(k) is the feedrate from knot k
//! to k+1, eps(k) the contour error (desired minus actual) where that motion ends. f is
//! [`crate::activation::bipolar_sigmoid`].
//!
//! Source: Lee, Cho and Jeon (2005), section 3.2, Fig. 4, eqs 3 to 6. Departure: N axes instead of
//! two.
//!
//! | paper   | code         | unit                    |
//! |---------|--------------|-------------------------|
//! | F       | `feed`       | [`super::FEED_SCALE_MM_S`]    |
//! | eps     | `error`      | [`super::ERROR_SCALE_MM`]     |
//! | W_ji    | `hidden`     | 1                       |
//! | W_oj    | `output`     | 1                       |

use super::{ContourModel, ERROR_SCALE_MM, HIDDEN, INPUTS, Identifier, IdentifierKind, Inputs};
use crate::activation::{bipolar_sigmoid, slope};

/// The weights.
#[derive(Debug, Clone, PartialEq)]
pub struct ContourIdentifier<const N: usize> {
    /// W_ji, indexed by axis, input of that axis, and hidden node.
    pub hidden: [[[f64; HIDDEN]; INPUTS]; N],
    /// W_oj, indexed by output and hidden node.
    pub output: [[f64; HIDDEN]; N],
}

/// The state of the network for one input.
#[derive(Debug, Clone, Copy)]
pub struct Forward<const N: usize> {
    /// f(net_j).
    pub(crate) hidden: [f64; HIDDEN],
    /// eps_hat, scaled.
    pub error: [f64; N],
}

impl<const N: usize> Identifier<N> for ContourIdentifier<N> {
    const KIND: IdentifierKind = IdentifierKind::Contour;
    const ERROR_SCALE_MM: f64 = ERROR_SCALE_MM;
    const NULL: Self = Self {
        hidden: [[[0.0; HIDDEN]; INPUTS]; N],
        output: [[0.0; HIDDEN]; N],
    };

    fn weights(&mut self, each: &mut impl FnMut(&'static str, &mut [f64])) {
        each("hidden", self.hidden.as_flattened_mut().as_flattened_mut());
        each("output", self.output.as_flattened_mut());
    }
}

impl<const N: usize> ContourModel<N> for ContourIdentifier<N> {
    type Forward = Forward<N>;
    const AT_REST: Forward<N> = Forward {
        hidden: [0.0; HIDDEN],
        error: [0.0; N],
    };

    #[inline]
    fn forward(&self, inputs: &Inputs<N>) -> Forward<N> {
        self.predict(inputs)
    }

    #[inline]
    fn error(forward: &Forward<N>) -> [f64; N] {
        forward.error
    }

    #[inline]
    fn slopes(&self, forward: &Forward<N>, input: usize) -> [[f64; N]; N] {
        if input == 0 {
            return self.jacobian(forward);
        }
        let hidden_slope = forward.hidden.map(slope);
        core::array::from_fn(|o| {
            let output_slope = slope(forward.error[o]);
            core::array::from_fn(|axis| {
                let Some(weights) = self.hidden[axis].get(input) else {
                    return 0.0;
                };
                output_slope
                    * (0..HIDDEN)
                        .map(|j| self.output[o][j] * hidden_slope[j] * weights[j])
                        .sum::<f64>()
            })
        })
    }

    /// One step of back-propagation: down the gradient of eq. 6. Returns E_n before the step.
    ///
    /// A step that is not finite is left out, so that a lost measurement cannot destroy the
    /// weights.
    #[inline]
    fn learn(&mut self, inputs: &Inputs<N>, error: [f64; N], step: f64) -> f64 {
        let forward = self.predict(inputs);
        let mut cost = 0.0;
        let mut output_delta = [0.0; N];
        for o in 0..N {
            let miss = error[o] - forward.error[o];
            cost += 0.5 * miss * miss;
            output_delta[o] = miss * slope(forward.error[o]) * step;
        }
        if !cost.is_finite() {
            return cost;
        }
        let mut hidden_delta = [0.0; HIDDEN];
        for o in 0..N {
            for j in 0..HIDDEN {
                hidden_delta[j] += output_delta[o] * self.output[o][j];
                self.output[o][j] += output_delta[o] * forward.hidden[j];
            }
        }
        for j in 0..HIDDEN {
            hidden_delta[j] *= slope(forward.hidden[j]);
        }
        for axis in 0..N {
            for input in 0..INPUTS {
                let x = inputs[axis][input];
                for j in 0..HIDDEN {
                    self.hidden[axis][input][j] += hidden_delta[j] * x;
                }
            }
        }
        cost
    }
}

impl<const N: usize> ContourIdentifier<N> {
    /// Eqs 3 to 5.
    #[inline]
    pub fn predict(&self, inputs: &Inputs<N>) -> Forward<N> {
        let mut net = [0.0; HIDDEN];
        for axis in 0..N {
            for input in 0..INPUTS {
                let x = inputs[axis][input];
                let w = &self.hidden[axis][input];
                for j in 0..HIDDEN {
                    net[j] += w[j] * x;
                }
            }
        }
        self.outputs(net)
    }

    /// Eqs 3 and 4, given the inputs of the hidden nodes.
    #[inline]
    fn outputs(&self, net: [f64; HIDDEN]) -> Forward<N> {
        let hidden = bipolar_sigmoid(net);
        let mut net_o = [0.0; N];
        for o in 0..N {
            for j in 0..HIDDEN {
                net_o[o] += self.output[o][j] * hidden[j];
            }
        }
        Forward {
            hidden,
            error: bipolar_sigmoid(net_o),
        }
    }

    /// d eps_hat_o / d F_axis(k), indexed by o and axis: the chain rule through eqs 3 to 5.
    #[inline]
    pub fn jacobian(&self, forward: &Forward<N>) -> [[f64; N]; N] {
        let hidden_slope = forward.hidden.map(slope);
        let mut jacobian = [[0.0; N]; N];
        for o in 0..N {
            let output_slope = slope(forward.error[o]);
            for axis in 0..N {
                let mut sum = 0.0;
                for j in 0..HIDDEN {
                    sum += self.output[o][j] * hidden_slope[j] * self.hidden[axis][0][j];
                }
                jacobian[o][axis] = output_slope * sum;
            }
        }
        jacobian
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Numbers without symmetry, -0.5 to 0.5: a linear congruential sequence.
    pub(crate) fn sequence() -> impl FnMut() -> f64 {
        let mut state = 1_u32;
        move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state) / f64::from(u32::MAX) - 0.5
        }
    }

    /// Weights and inputs from it.
    pub(crate) fn sample_of(mut next: impl FnMut() -> f64) -> (ContourIdentifier<2>, Inputs<2>) {
        let hidden =
            core::array::from_fn(|_| core::array::from_fn(|_| core::array::from_fn(|_| next())));
        let output = core::array::from_fn(|_| core::array::from_fn(|_| next()));
        let inputs = core::array::from_fn(|_| core::array::from_fn(|_| 2.0 * next()));
        (ContourIdentifier { hidden, output }, inputs)
    }

    pub(crate) fn sample() -> (ContourIdentifier<2>, Inputs<2>) {
        sample_of(sequence())
    }

    #[test]
    fn the_jacobian_is_the_difference_quotient_of_the_prediction() {
        let (net, inputs) = sample();
        let jacobian = net.jacobian(&net.predict(&inputs));
        let h = 1e-6;
        for axis in 0..2 {
            let (mut up, mut down) = (inputs, inputs);
            up[axis][0] += h;
            down[axis][0] -= h;
            let (up, down) = (net.predict(&up).error, net.predict(&down).error);
            for o in 0..2 {
                let quotient = (up[o] - down[o]) / (2.0 * h);
                assert!((jacobian[o][axis] - quotient).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_training_step_goes_down_the_gradient_of_every_weight() {
        let (net, inputs) = sample();
        let target = [0.4, -0.3];
        let cost = |net: &ContourIdentifier<2>| {
            let e = net.predict(&inputs).error;
            0.5 * ((target[0] - e[0]).powi(2) + (target[1] - e[1]).powi(2))
        };
        let step = 1e-3;
        let mut stepped = net.clone();
        stepped.learn(&inputs, target, step);
        let h = 1e-6;
        for axis in 0..2 {
            for input in 0..INPUTS {
                for j in 0..HIDDEN {
                    let (mut up, mut down) = (net.clone(), net.clone());
                    up.hidden[axis][input][j] += h;
                    down.hidden[axis][input][j] -= h;
                    let gradient = (cost(&up) - cost(&down)) / (2.0 * h);
                    let moved = stepped.hidden[axis][input][j] - net.hidden[axis][input][j];
                    assert!((moved + step * gradient).abs() < 1e-11);
                }
            }
        }
        for o in 0..2 {
            for j in 0..HIDDEN {
                let (mut up, mut down) = (net.clone(), net.clone());
                up.output[o][j] += h;
                down.output[o][j] -= h;
                let gradient = (cost(&up) - cost(&down)) / (2.0 * h);
                assert!((stepped.output[o][j] - net.output[o][j] + step * gradient).abs() < 1e-11);
            }
        }
    }

    #[test]
    fn a_lost_measurement_leaves_the_weights_alone() {
        let (mut net, inputs) = sample();
        let before = net.clone();
        net.learn(&inputs, [f64::NAN, 0.0], 0.05);
        assert_eq!(net, before);
    }
}
