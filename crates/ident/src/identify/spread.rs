//! How the servos of machines of a kind differ from the identified one: what adaptation expects of a machine that it meets.
//!
//! A position loop around a speed loop, of bandwidths k and a, 1/s, follows a command with the feedrate F as
//!
//! ```text
//! e' = F - v      v' = a (k e - v)
//! ```
//!
//! Over a feed period T this is [e v]+ = Phi [e v] + Gamma F. With v eliminated, e(k+1) is linear in F(k), F(k-1), e(k) and
//! e(k-1): the linear connection of a servo identifier. Its two poles, the roots of z^2 - tr(Phi) z + det(Phi), give a and k
//! back. Inertia and the gain of the speed loop act on a, the gain of the position loop on k, friction on the hidden nodes;
//! the kind is all machines within a factor of three in each.
//!
//! Source: cascaded servo loops and their sampling as in Åström and Wittenmark (1997), chapter 2; no machine file is asked.

use feedwright_control::{FEED_SCALE_MM_S, FOLLOWING_SCALE_MM, INPUTS, ServoIdentifier, Spread, UNKNOWNS};

/// Factors of bandwidths and friction within a kind, evenly spaced in their logarithm.
const FACTORS: [f64; 5] = [0.35, 0.6, 1.0, 1.7, 2.85];

/// The mean squares and products of the changes from an identified servo to the others of its kind. Zero for an axis that is
/// no such servo: it is not known how others differ from it.
pub(super) fn spread<const N: usize>(net: &ServoIdentifier<N>, period_s: f64) -> Spread<N> {
    std::array::from_fn(|axis| match Bandwidths::of(&net.linear[axis][axis], period_s) {
        Some(bandwidths) => mean_products(bandwidths, period_s),
        None => [[0.0; UNKNOWNS]; UNKNOWNS],
    })
}

fn mean_products(identified: Bandwidths, period_s: f64) -> [[f64; UNKNOWNS]; UNKNOWNS] {
    let here = identified.connection(period_s);
    let part = 1.0 / FACTORS.len().pow(3) as f64;
    let mut products = [[0.0; UNKNOWNS]; UNKNOWNS];
    for speed in FACTORS {
        for position in FACTORS {
            let other = Bandwidths {
                speed_1_s: speed * identified.speed_1_s,
                position_1_s: position * identified.position_1_s,
            };
            let there = other.connection(period_s);
            for friction in FACTORS {
                let mut change = [friction - 1.0; UNKNOWNS];
                (0..INPUTS).for_each(|input| change[input] = there[input] - here[input]);
                for (row, of_row) in products.iter_mut().zip(change) {
                    row.iter_mut().zip(change).for_each(|(product, of_column)| *product += part * of_row * of_column);
                }
            }
        }
    }
    products
}

/// a and k.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Bandwidths {
    speed_1_s: f64,
    position_1_s: f64,
}

impl Bandwidths {
    /// From the poles of a linear connection; none where it does not belong to such a servo.
    fn of(linear: &[f64; INPUTS], period_s: f64) -> Option<Self> {
        let trace = 1.0 + linear[3] / FOLLOWING_SCALE_MM;
        let determinant = -linear[4] / FOLLOWING_SCALE_MM;
        let speed_1_s = -libm::log(determinant) / period_s;
        // The poles are exp(-a T/2) times exp(+-q T), where q is real (cosh) or imaginary (cos).
        let turn = 0.5 * trace / determinant.sqrt();
        let square =
            if turn >= 1.0 { libm::acosh(turn).powi(2) } else { -libm::acos(turn).powi(2) } / (period_s * period_s);
        let position_1_s = (0.25 * speed_1_s * speed_1_s - square) / speed_1_s;
        // Not a number is not above zero either.
        (speed_1_s > 0.0 && position_1_s > 0.0 && speed_1_s.is_finite() && position_1_s.is_finite())
            .then_some(Self { speed_1_s, position_1_s })
    }

    /// The linear connection of such a servo.
    fn connection(self, period_s: f64) -> [f64; INPUTS] {
        let Self { speed_1_s: a, position_1_s: k } = self;
        // Φ = exp(A T) = exp(-a T/2) (even I + odd T (A + a/2 I)) with A = [0 -1; a k -a] and poles -a/2 ± q.
        let square = 0.25 * a * a - a * k;
        let x = square.abs().sqrt() * period_s;
        let (even, odd) = if square > 0.0 { (libm::cosh(x), libm::sinh(x)) } else { (libm::cos(x), libm::sin(x)) };
        let odd = if x == 0.0 { 1.0 } else { odd / x };
        let keep = libm::exp(-0.5 * a * period_s);
        let half = 0.5 * a * period_s * odd;
        let phi =
            [[keep * (even + half), -keep * odd * period_s], [keep * odd * a * k * period_s, keep * (even - half)]];
        // The input integral is A⁻¹ (Φ - I) [1 0]ᵀ.
        let gamma = [(phi[1][0] + a * (1.0 - phi[0][0])) / (a * k), 1.0 - phi[0][0]];
        [
            FEED_SCALE_MM_S * gamma[0],
            FEED_SCALE_MM_S * (phi[0][1] * gamma[1] - phi[1][1] * gamma[0]),
            0.0,
            FOLLOWING_SCALE_MM * (2.0 * keep * even - 1.0),
            -FOLLOWING_SCALE_MM * keep * keep,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_S: f64 = 0.003;

    #[test]
    fn the_poles_give_the_bandwidths_back_whether_the_servo_swings_or_not() {
        for (speed_1_s, position_1_s) in [(190.0, 50.0), (190.0, 20.0), (60.0, 150.0), (600.0, 17.0)] {
            let servo = Bandwidths { speed_1_s, position_1_s };
            let found = Bandwidths::of(&servo.connection(PERIOD_S), PERIOD_S).expect("a servo");
            assert!((found.speed_1_s / speed_1_s - 1.0).abs() < 1e-9, "{found:?}");
            assert!((found.position_1_s / position_1_s - 1.0).abs() < 1e-9, "{found:?}");
        }
    }

    /// Against the differential equations, integrated in steps of a microsecond.
    #[test]
    fn the_connection_is_that_of_the_servo() {
        let (a, k) = (190.0, 50.0);
        let linear = Bandwidths { speed_1_s: a, position_1_s: k }.connection(PERIOD_S);
        let feed = [40.0, -20.0, 70.0, 10.0];
        let (mut e, mut v) = (0.3, -5.0);
        let mut at_knots = vec![e];
        for feed_mm_s in feed {
            for _ in 0..3000 {
                let (de, dv) = (feed_mm_s - v, a * (k * e - v));
                // Heun's rule: the error of a step is of third order.
                let (e1, v1) = (e + 1e-6 * de, v + 1e-6 * dv);
                e += 0.5e-6 * (de + feed_mm_s - v1);
                v += 0.5e-6 * (dv + a * (k * e1 - v1));
            }
            at_knots.push(e);
        }
        for knot in 1..feed.len() {
            let inputs = [
                feed[knot] / FEED_SCALE_MM_S,
                feed[knot - 1] / FEED_SCALE_MM_S,
                0.0,
                at_knots[knot],
                at_knots[knot - 1],
            ];
            let grown_mm: f64 = linear.iter().zip(inputs).map(|(weight, input)| weight * input).sum();
            assert!((grown_mm - (at_knots[knot + 1] - at_knots[knot])).abs() < 1e-8, "knot {knot}");
        }
    }

    #[test]
    fn what_is_no_servo_has_no_kind() {
        for linear in [[0.0; INPUTS], [f64::NAN; INPUTS], [0.1, 0.0, 0.0, 2.0, 1.0]] {
            assert_eq!(Bandwidths::of(&linear, PERIOD_S), None, "{linear:?}");
        }
    }
}
