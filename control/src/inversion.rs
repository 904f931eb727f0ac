//! The network inversion: at most five gradient steps on the feedrate, weights fixed.
//!
//! ```text
//! E(k)    = 1/2 |eps_hat(k)|^2 + rho / |F(k)|^2                                                (7)
//! F^(t+1) = F^(t) - eta dE/dF^(t)                                                              (8)
//! dE/dF_a = -1/4 eps_a (1 - eps_a^2) sum_j W_aj (1 - f(net_j)^2) W_ja  - 2 rho F_a / |F|^4     (9, 10)
//! ```
//!
//! Source: Kindermann and Linden (1990) for the inversion; Lee, Cho and Jeon (2005), section 3.3, eqs 7 to 10.
//!
//! The error term of (9) and (10) is printed with the diagonal of the Jacobian only and with the sign turned; the true
//! gradient of (7) is `+ sum_o eps_o d eps_o / d F_a`. Both are here, see [`Gradient`]. Departure: the term of rho has
//! the sign and the factor of the true derivative, and its denominator is (F_x^2 + F_y^2)^2 in both axes; in print it
//! slows the machine down where eq. 7 is meant to speed it up.
//!
//! All quantities are scaled as in [`crate::identifier`].

use crate::identifier::Inputs;
use crate::identifier::contour::{ContourIdentifier, Forward};
use crate::vector::{add_scaled, dot, limit_norm, norm, scale};

/// Which gradient of the error term the inversion follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gradient {
    /// As in eqs 9 and 10: the diagonal, with the printed sign. Nearly all of F is the path going on, which makes no
    /// error, and the path is not among the inputs; so the network cannot tell it from a command that leaves the path,
    /// and learns the wrong sign for F(k). The printed sign puts that right: the Jacobian serves as the gain of an
    /// integrating correction.
    Printed,
    /// The true gradient of eq. 7 through the network.
    Exact,
    /// None: the first term of eq. 7 is zero, as in Fig. 7 of the paper.
    Absent,
}

/// Settings of an inversion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Weight of the machining time in eq. 7, scaled units; 0 to 0.1.
    pub rho: f64,
    /// Step size of eq. 8, scaled units; 0 to 10.
    pub eta: f64,
    /// Gradient steps a tick; 1 to 20, the paper allows 5.
    pub steps: usize,
    /// Longest step of F, scaled units; 0.001 to 1. Keeps the term of rho, which grows as |F|^-3, in bounds near rest.
    pub step_limit: f64,
    /// Gradient of the error term.
    pub gradient: Gradient,
}

/// Below this feedrate (scaled; 1 mm/s) the term of rho is left out: near rest the feed plan decides, not the inversion.
const LEAST_FEED: f64 = 0.02;

/// dE/dF of the error term in eq. 7.
#[inline]
pub fn error_gradient<const N: usize>(net: &ContourIdentifier<N>, forward: &Forward<N>, which: Gradient) -> [f64; N] {
    let jacobian = net.jacobian(forward);
    core::array::from_fn(|axis| match which {
        Gradient::Printed => -forward.error[axis] * jacobian[axis][axis],
        Gradient::Exact => (0..N).map(|o| forward.error[o] * jacobian[o][axis]).sum(),
        Gradient::Absent => 0.0,
    })
}

/// dE/dF of the term of rho in eq. 7: -2 rho F / |F|^4.
#[inline]
pub fn time_gradient<const N: usize>(feed: [f64; N], rho: f64) -> [f64; N] {
    let square = dot(feed, feed);
    if square < LEAST_FEED * LEAST_FEED { [0.0; N] } else { scale(-2.0 * rho / (square * square), feed) }
}

/// Inverts in all components: both the speed and the geometry change. `inputs` hold F(0) on entry and the result
/// on return.
#[inline]
pub fn invert<const N: usize>(net: &ContourIdentifier<N>, inputs: &mut Inputs<N>, settings: &Settings) {
    descend(net, inputs, settings, |gradient| gradient);
}

/// Inverts in the magnitude: F keeps the direction of F(0), the geometry stays on the path.
///
/// Source: Yoon and Jeon (2000).
#[inline]
pub fn invert_magnitude<const N: usize>(net: &ContourIdentifier<N>, inputs: &mut Inputs<N>, settings: &Settings) {
    let feed = inputs.map(|axis| axis[0]);
    let length = norm(feed);
    if length < LEAST_FEED {
        return;
    }
    let direction = scale(1.0 / length, feed);
    descend(net, inputs, settings, |gradient| scale(dot(gradient, direction), direction));
}

fn descend<const N: usize>(
    net: &ContourIdentifier<N>,
    inputs: &mut Inputs<N>,
    settings: &Settings,
    project: impl Fn([f64; N]) -> [f64; N],
) {
    for _ in 0..settings.steps {
        let feed = inputs.map(|axis| axis[0]);
        let forward = net.predict(inputs);
        let gradient =
            add_scaled(error_gradient(net, &forward, settings.gradient), 1.0, time_gradient(feed, settings.rho));
        let step = limit_norm(scale(-settings.eta, project(gradient)), settings.step_limit);
        for axis in 0..N {
            inputs[axis][0] += step[axis];
        }
    }
}
