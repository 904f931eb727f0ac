//! The network inversion: at most five gradient steps on the feedrates of H knots, with fixed
//! weights. The paper has H = 1.
//!
//! ```text
//! E       = sum_i 1/2 |eps_hat(i)|^2 + rho / |F(i)|^2,  i = k..k+H-1                           (7), summed
//! F^(t+1) = F^(t) - eta dE/dF^(t)                                                              (8)
//! dE/dF_a = -1/4 eps_a (1 - eps_a^2) sum_j W_aj (1 - f(net_j)^2) W_ja  - 2 rho F_a / |F|^4     (9, 10)
//! ```
//!
//! Over several knots the identifier is rolled out: its delays receive the errors that it predicts
//! and the feedrates.
//!
//! Source: Kindermann and Linden (1990) for the inversion; Lee, Cho and Jeon (2005), section 3.3,
//! eqs 7 to 10; the gradient over a horizon is back-propagation through time (Werbos 1990).
//!
//! In print, the error term of (9) and (10) has only the diagonal of the Jacobian and the opposite
//! sign; the true gradient of (7) is `+ sum_o eps_o d eps_o / d F_a`. [`Gradient`] selects one of
//! the two. Departure: the term of rho has the sign and the factor of the true derivative, and its
//! denominator is (F_x^2 + F_y^2)^2 in both axes. In print, this term slows the machine down where
//! eq. 7 is meant to speed it up.
//!
//! All quantities are scaled as in [`crate::identifier`].

use crate::identifier::{ContourModel, Inputs};
use crate::vector::{add_scaled, dot, limit_norm, norm, scale};

/// Largest number of knots of an inversion.
pub(crate) const MAX_KNOTS: usize = 20;

/// Gradient of the error term that the inversion follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gradient {
    /// Gradient of eqs 9 and 10: the diagonal, with the printed sign. Nearly all of F is the motion
    /// along the path, which makes no error, and the path is not among the inputs. The network
    /// therefore cannot distinguish it from a command that leaves the path, and learns the wrong
    /// sign for F(k). The printed sign corrects that: the Jacobian serves as the gain of an
    /// integrating correction. Over several knots each one is corrected by itself: the effect of a
    /// feedrate on later errors has no printed form.
    Printed,
    /// The true gradient of eq. 7 through the network, and over several knots through its delays.
    Exact,
    /// Zero gradient: the first term of eq. 7 is zero, as in Fig. 7 of the paper.
    Absent,
}

/// Derivative of the term of rho in eq. 7 that the inversion follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeTerm {
    /// The true derivative, -2 rho F / |F|^4: a larger rho is faster.
    Derivative,
    /// Derivative with the sign and the factor of eqs 9 and 10, + rho F / |F|^4: a larger rho is
    /// slower.
    PrintedSign,
    /// Derivative as printed in eqs 9 and 10: in addition to `PrintedSign`, the denominator of
    /// every axis but the first is (2 F_a^2)^2.
    Printed,
}

/// Settings of an inversion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InversionSettings {
    /// Weight of the machining time in eq. 7, scaled units; 0 to 0.1.
    pub rho: f64,
    /// Step size of eq. 8, scaled units; 0 to 10.
    pub eta: f64,
    /// Gradient steps in a tick; 1 to 20, the paper allows 5.
    pub(crate) steps: usize,
    /// Longest step of each F, scaled units; 0.001 to 1. Keeps the term of rho, which grows as
    /// |F|^-3, in bounds near rest.
    pub step_limit: f64,
    /// Gradient of the error term.
    pub gradient: Gradient,
    /// Gradient of the term of rho.
    pub time_term: TimeTerm,
}

/// Feedrate below which the term of rho is omitted (scaled; 1 mm/s): near rest the feed plan
/// decides, not the inversion.
const MIN_FEED: f64 = 0.02;

/// Returns dE/dF of the term of rho in eq. 7.
#[inline]
fn time_gradient<const N: usize>(feed: [f64; N], rho: f64, term: TimeTerm) -> [f64; N] {
    let square = dot(feed, feed);
    if square < MIN_FEED * MIN_FEED {
        return [0.0; N];
    }
    match term {
        TimeTerm::Derivative => scale(-2.0 * rho / (square * square), feed),
        TimeTerm::PrintedSign => scale(rho / (square * square), feed),
        TimeTerm::Printed => core::array::from_fn(|axis| {
            let printed = if axis == 0 {
                square
            } else {
                2.0 * feed[axis] * feed[axis]
            };
            if printed < MIN_FEED * MIN_FEED {
                0.0
            } else {
                rho * feed[axis] / (printed * printed)
            }
        }),
    }
}

/// Inverts in all components: speed and geometry change. `inputs` belong to the first knot; their
/// F(k) is not read. `feeds` hold F(0) of each knot on entry and the result on return. Knots beyond
/// [`MAX_KNOTS`] stay as they are.
#[inline]
pub(crate) fn invert<const N: usize, D: ContourModel<N>>(
    net: &D,
    inputs: &Inputs<N>,
    feeds: &mut [[f64; N]],
    settings: &InversionSettings,
) {
    descend(net, inputs, feeds, settings, false);
}

/// Inverts in the magnitudes, with arguments as in [`invert`]: each F keeps the direction of its
/// F(0), so the geometry stays on the path.
///
/// Source: Yoon and Jeon (2000).
#[inline]
pub(crate) fn invert_magnitude<const N: usize, D: ContourModel<N>>(
    net: &D,
    inputs: &Inputs<N>,
    feeds: &mut [[f64; N]],
    settings: &InversionSettings,
) {
    descend(net, inputs, feeds, settings, true);
}

/// Selects the array size: an inversion of one knot, as in the paper, clears memory for one knot
/// only.
#[inline]
fn descend<const N: usize, D: ContourModel<N>>(
    net: &D,
    inputs: &Inputs<N>,
    feeds: &mut [[f64; N]],
    settings: &InversionSettings,
    magnitude: bool,
) {
    let knots = feeds.len().min(MAX_KNOTS);
    match &mut feeds[..knots] {
        [] => {}
        [feed] => descend_in::<N, 1, D>(
            net,
            inputs,
            core::slice::from_mut(feed),
            settings,
            magnitude,
        ),
        feeds => descend_in::<N, MAX_KNOTS, D>(net, inputs, feeds, settings, magnitude),
    }
}

/// Applies eq. 8 to at most `H` knots.
#[inline]
fn descend_in<const N: usize, const H: usize, D: ContourModel<N>>(
    net: &D,
    inputs: &Inputs<N>,
    feeds: &mut [[f64; N]],
    settings: &InversionSettings,
    magnitude: bool,
) {
    let mut directions = [[0.0; N]; H];
    for (direction, feed) in directions.iter_mut().zip(&*feeds) {
        let length = norm(*feed);
        if length >= MIN_FEED {
            *direction = scale(1.0 / length, *feed);
        }
    }
    for _ in 0..settings.steps {
        let gradients = gradients::<N, H, D>(net, inputs, feeds, settings);
        for ((feed, direction), gradient) in feeds.iter_mut().zip(directions).zip(gradients) {
            let gradient = if magnitude {
                scale(dot(gradient, direction), direction)
            } else {
                gradient
            };
            *feed = add_scaled(
                *feed,
                1.0,
                limit_norm(scale(-settings.eta, gradient), settings.step_limit),
            );
        }
    }
}

/// Returns dE/dF of each knot; zero beyond `feeds`.
#[inline]
fn gradients<const N: usize, const H: usize, D: ContourModel<N>>(
    net: &D,
    inputs: &Inputs<N>,
    feeds: &[[f64; N]],
    settings: &InversionSettings,
) -> [[f64; N]; H] {
    let mut gradients = [[0.0; N]; H];
    let forwards = roll_out::<N, H, D>(net, inputs, feeds);
    // Derivatives of later errors with respect to the error and the feedrate of this knot and of
    // the one before it.
    let (mut error_felt, mut feed_felt) = ([[0.0; N]; 2], [[0.0; N]; 2]);
    for (knot, ((feed, forward), gradient)) in feeds
        .iter()
        .zip(&forwards)
        .zip(&mut gradients)
        .enumerate()
        .rev()
    {
        let adjoint = |error: [f64; N], input: usize| through(&net.slopes(forward, input), error);
        let of_error = match settings.gradient {
            Gradient::Printed => {
                let (error, slopes) = (D::error(forward), net.slopes(forward, 0));
                core::array::from_fn(|axis| -error[axis] * slopes[axis][axis])
            }
            Gradient::Absent => [0.0; N],
            Gradient::Exact => {
                let error = add_scaled(D::error(forward), 1.0, error_felt[0]);
                let own = add_scaled(adjoint(error, 0), 1.0, feed_felt[0]);
                (error_felt, feed_felt) = ([error_felt[1], [0.0; N]], [feed_felt[1], [0.0; N]]);
                // The first knot has no predecessor, the second one has one.
                for (back, (feed_felt, error_felt)) in feed_felt
                    .iter_mut()
                    .zip(&mut error_felt)
                    .enumerate()
                    .take(knot)
                {
                    *feed_felt = add_scaled(*feed_felt, 1.0, adjoint(error, 1 + back));
                    *error_felt = add_scaled(*error_felt, 1.0, adjoint(error, 3 + back));
                }
                own
            }
        };
        *gradient = add_scaled(
            of_error,
            1.0,
            time_gradient(*feed, settings.rho, settings.time_term),
        );
    }
    gradients
}

/// Predicts the errors along the feedrates.
#[inline]
fn roll_out<const N: usize, const H: usize, D: ContourModel<N>>(
    net: &D,
    inputs: &Inputs<N>,
    feeds: &[[f64; N]],
) -> [D::Forward; H] {
    let mut forwards = [D::AT_REST; H];
    let mut inputs = *inputs;
    for (forward, feed) in forwards.iter_mut().zip(feeds) {
        for axis in 0..N {
            inputs[axis][0] = feed[axis];
        }
        *forward = net.forward(&inputs);
        let error = D::error(forward);
        for axis in 0..N {
            let [f0, f1, _, e1, _] = inputs[axis];
            inputs[axis] = [f0, f0, f1, error[axis], e1];
        }
    }
    forwards
}

/// Returns the adjoint of an error.
#[inline]
fn through<const N: usize>(slopes: &[[f64; N]; N], error: [f64; N]) -> [f64; N] {
    core::array::from_fn(|axis| (0..N).map(|o| error[o] * slopes[o][axis]).sum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identifier::contour::ContourIdentifier;
    use crate::identifier::contour::tests::{sample_of, sequence};
    use crate::identifier::{HIDDEN, INPUTS};

    /// Weights, inputs and feedrates without symmetry.
    fn sample<const H: usize>() -> (ContourIdentifier<2>, Inputs<2>, [[f64; 2]; H]) {
        let mut next = sequence();
        let (net, inputs) = sample_of(&mut next);
        (
            net,
            inputs,
            core::array::from_fn(|_| core::array::from_fn(|_| 2.0 * next())),
        )
    }

    fn settings(gradient: Gradient) -> InversionSettings {
        InversionSettings {
            rho: 0.01,
            eta: 0.3,
            steps: 1,
            step_limit: f64::INFINITY,
            gradient,
            time_term: TimeTerm::Derivative,
        }
    }

    /// Eq. 7 summed over the knots, without any of the above: the delays stand in one row.
    fn index<const H: usize>(
        net: &ContourIdentifier<2>,
        inputs: &Inputs<2>,
        feeds: &[[f64; 2]; H],
        rho: f64,
    ) -> f64 {
        let sigmoid = |x: f64| 2.0 / (1.0 + libm::exp(-x)) - 1.0;
        // F(k-2), F(k-1), F(k).. and eps(k-2), eps(k-1), eps(k)..
        let mut feed = [[0.0; 2]; 22];
        let mut error = [[0.0; 2]; 22];
        for axis in 0..2 {
            let [_, f1, f2, e1, e2] = inputs[axis];
            (feed[0][axis], feed[1][axis], error[0][axis], error[1][axis]) = (f2, f1, e2, e1);
        }
        let mut sum = 0.0;
        for (knot, f) in feeds.iter().enumerate() {
            let k = knot + 2;
            feed[k] = *f;
            let mut nodes = [0.0; HIDDEN];
            for (j, node) in nodes.iter_mut().enumerate() {
                let mut x = 0.0;
                for axis in 0..2 {
                    let seen = [
                        feed[k][axis],
                        feed[k - 1][axis],
                        feed[k - 2][axis],
                        error[k - 1][axis],
                        error[k - 2][axis],
                    ];
                    x += (0..INPUTS)
                        .map(|i| net.hidden[axis][i][j] * seen[i])
                        .sum::<f64>();
                }
                *node = sigmoid(x);
            }
            error[k] = [0, 1].map(|o| {
                sigmoid(
                    (0..HIDDEN)
                        .map(|j| net.output[o][j] * nodes[j])
                        .sum::<f64>(),
                )
            });
            sum += 0.5 * (error[k][0].powi(2) + error[k][1].powi(2))
                + rho / (f[0].powi(2) + f[1].powi(2));
        }
        sum
    }

    /// Eqs 8 to 10, in their terms, with the sign of the term of rho as in [`time_gradient`].
    fn printed_step(
        net: &ContourIdentifier<2>,
        inputs: &Inputs<2>,
        [fx, fy]: [f64; 2],
        rho: f64,
        eta: f64,
    ) -> [f64; 2] {
        let f = |x: f64| 2.0 / (1.0 + libm::exp(-x)) - 1.0;
        let mut hidden = [0.0; HIDDEN];
        for j in 0..HIDDEN {
            let mut sum = net.hidden[0][0][j] * fx + net.hidden[1][0][j] * fy;
            for axis in 0..2 {
                for i in 1..INPUTS {
                    sum += net.hidden[axis][i][j] * inputs[axis][i];
                }
            }
            hidden[j] = f(sum);
        }
        let of_axis = |a: usize, feed: f64| {
            let eps = f((0..HIDDEN).map(|j| net.output[a][j] * hidden[j]).sum());
            let mut sum = 0.0;
            for j in 0..HIDDEN {
                sum += net.output[a][j] * (1.0 - hidden[j] * hidden[j]) * net.hidden[a][0][j];
            }
            let square = fx * fx + fy * fy;
            -0.25 * eps * (1.0 - eps * eps) * sum - 2.0 * rho * feed / (square * square)
        };
        [fx - eta * of_axis(0, fx), fy - eta * of_axis(1, fy)]
    }

    #[test]
    fn one_knot_is_eqs_7_to_10_to_rounding() {
        let (net, inputs, [feed]) = sample::<1>();
        let mut expected = feed;
        for _ in 0..5 {
            expected = printed_step(&net, &inputs, expected, 0.01, 0.3);
        }
        let mut found = [feed];
        invert(
            &net,
            &inputs,
            &mut found,
            &InversionSettings {
                steps: 5,
                ..settings(Gradient::Printed)
            },
        );
        for axis in 0..2 {
            assert!(
                (found[0][axis] - expected[axis]).abs() < 1e-14,
                "{found:?} {expected:?}"
            );
            assert!((found[0][axis] - feed[axis]).abs() > 1e-3);
        }
    }

    #[test]
    fn the_time_term_has_the_derivative_or_what_is_printed() {
        let feed: [f64; 2] = [0.8, 0.3];
        let [x, y] = feed;
        let square: f64 = x * x + y * y;
        let slope = |axis: usize| {
            let moved = |by: f64| {
                let mut feed = feed;
                feed[axis] += by;
                0.01 / dot(feed, feed)
            };
            (moved(1e-6) - moved(-1e-6)) / 2e-6
        };
        let close = |found: [f64; 2], expected: [f64; 2]| {
            assert!(
                found
                    .iter()
                    .zip(expected)
                    .all(|(a, b)| (a - b).abs() < 1e-9),
                "{found:?} {expected:?}"
            );
        };
        let term = |term| time_gradient(feed, 0.01, term);
        close(term(TimeTerm::Derivative), [slope(0), slope(1)]);
        close(
            term(TimeTerm::PrintedSign),
            [-0.5 * slope(0), -0.5 * slope(1)],
        );
        close(
            term(TimeTerm::Printed),
            [
                0.01 * x / square.powi(2),
                0.01 * y / (y * y + y * y).powi(2),
            ],
        );
    }

    #[test]
    fn printed_each_knot_is_corrected_for_itself() {
        let (net, mut inputs, feeds) = sample::<3>();
        let mut found = feeds;
        invert(&net, &inputs, &mut found, &settings(Gradient::Printed));
        for (knot, feed) in feeds.into_iter().enumerate() {
            let expected = printed_step(&net, &inputs, feed, 0.01, 0.3);
            for axis in 0..2 {
                assert!((found[knot][axis] - expected[axis]).abs() < 1e-14);
                inputs[axis][0] = feed[axis];
            }
            let error = net.predict(&inputs).error;
            inputs = core::array::from_fn(|a| [0.0, feed[a], inputs[a][1], error[a], inputs[a][3]]);
        }
    }

    fn exact_gradient_agrees_with_the_index<const H: usize>() {
        let (net, inputs, feeds) = sample::<H>();
        let settings = settings(Gradient::Exact);
        let mut stepped = feeds;
        invert(&net, &inputs, &mut stepped, &settings);
        let h = 1e-5;
        for knot in 0..H {
            for axis in 0..2 {
                let (mut up, mut down) = (feeds, feeds);
                up[knot][axis] += h;
                down[knot][axis] -= h;
                let rise = index(&net, &inputs, &up, settings.rho)
                    - index(&net, &inputs, &down, settings.rho);
                let gradient = (feeds[knot][axis] - stepped[knot][axis]) / settings.eta;
                let slope = rise / (2.0 * h);
                assert!(
                    (gradient - slope).abs() < 1e-6 * slope.abs().max(1e-2),
                    "{H} {knot}: {gradient} {slope}"
                );
            }
        }
    }

    #[test]
    fn the_exact_gradient_is_the_difference_quotient_of_the_index_whatever_the_horizon() {
        exact_gradient_agrees_with_the_index::<1>();
        exact_gradient_agrees_with_the_index::<3>();
        exact_gradient_agrees_with_the_index::<8>();
        exact_gradient_agrees_with_the_index::<20>();
    }

    #[test]
    fn the_magnitude_keeps_its_direction_in_every_knot() {
        let (net, inputs, feeds) = sample::<8>();
        let mut found = feeds;
        let settings = InversionSettings {
            steps: 5,
            step_limit: 0.05,
            ..settings(Gradient::Exact)
        };
        invert_magnitude(&net, &inputs, &mut found, &settings);
        for (found, feed) in found.into_iter().zip(feeds) {
            assert!(
                (found[0] * feed[1] - found[1] * feed[0]).abs() < 1e-15,
                "{found:?} {feed:?}"
            );
            let moved = norm([found[0] - feed[0], found[1] - feed[1]]);
            assert!(
                moved > 1e-6 && moved <= 5.0 * settings.step_limit + 1e-15,
                "{moved}"
            );
        }
    }

    #[test]
    fn knots_beyond_the_most_are_left_alone_and_none_is_no_fault() {
        let (net, inputs, feeds) = sample::<25>();
        let mut found = feeds;
        invert(&net, &inputs, &mut found, &settings(Gradient::Exact));
        assert_eq!(found[MAX_KNOTS..], feeds[MAX_KNOTS..]);
        assert!((0..MAX_KNOTS).all(|knot| found[knot] != feeds[knot]));
        invert(&net, &inputs, &mut [], &settings(Gradient::Exact));
    }
}
