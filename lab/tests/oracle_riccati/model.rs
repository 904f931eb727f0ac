//! A servo as the model of a horizon that keeps the slopes of every knot.
//!
//! ```text
//! e(k+1) - e(k) = L I + c sin(w I)     I = F(k), F(k-1), F(k-2), e(k), e(k-1) of the axis
//! ```

use std::cell::RefCell;

use feedwright_control::vector::{add_scaled, scale, sub};
use feedwright_control::{Delays, FEED_SCALE_MM_S, INPUTS, Inputs, Window};
use feedwright_lab::{CommandedPeriod, MAX_KNOTS, Predictor, Sensitivity};

/// Derivative of the growth of the following error to the inputs, knot by knot, mm for an input
/// of 1.
pub(crate) type Slopes<const N: usize> = [Inputs<N>; MAX_KNOTS];

/// L of a position loop similar to tnv40, mm.
const LINEAR: [f64; INPUTS] = [0.244, -0.101, -0.001_86, 0.2785, -0.4166];
/// c, mm: the slopes differ by a tenth from knot to knot.
const BENT_MM: f64 = 0.03;
/// w, the same for all axes but for a factor.
const BENDS: [f64; INPUTS] = [0.9, -0.6, 0.4, 1.1, -0.8];

/// The model.
#[derive(Clone)]
pub(crate) struct Servo<'a, const N: usize> {
    delays: Delays<N>,
    slopes: &'a RefCell<Slopes<N>>,
    /// Derivative of the following error to the acceleration of each knot, s^2: now and one knot
    /// ago.
    following_s2: [[[f64; N]; MAX_KNOTS]; 2],
}

impl<'a, const N: usize> Servo<'a, N> {
    /// Starts at full feed along the first axis.
    pub(crate) fn new(slopes: &'a RefCell<Slopes<N>>) -> Self {
        let mut one = [0.0; N];
        one[0] = 1.0;
        let delays = Delays {
            feed: [one; 2],
            error: [one; 2],
        };
        Self {
            delays,
            slopes,
            following_s2: [[[0.0; N]; MAX_KNOTS]; 2],
        }
    }

    fn feel(
        &mut self,
        slopes: &Inputs<N>,
        stretch: &CommandedPeriod<N>,
        sensitivity: &mut Sensitivity<N>,
    ) {
        let [following_s2, before_s2] = &mut self.following_s2;
        for knot in 0..=stretch.period {
            let gained = [0, 1, 2].map(|back| gained_s(stretch, knot, back) / FEED_SCALE_MM_S);
            for axis in 0..N {
                let [f0, f1, f2, e0, e1] = slopes[axis];
                let of_feed = f0 * gained[0] + f1 * gained[1] + f2 * gained[2];
                let of_error = e0 * following_s2[knot][axis] + e1 * before_s2[knot][axis];
                before_s2[knot][axis] = following_s2[knot][axis];
                following_s2[knot][axis] += of_feed + of_error;
                sensitivity[knot][axis] = stretch.moved_s2(knot, 1.0) - following_s2[knot][axis];
            }
        }
    }
}

/// Returns the speed that an acceleration of 1 mm/s^2 in a knot gives the offset on the mean of the
/// feed period `back` before this one, s.
fn gained_s<const N: usize>(stretch: &CommandedPeriod<N>, knot: usize, back: usize) -> f64 {
    match stretch.period.cmp(&(knot + back)) {
        std::cmp::Ordering::Less => 0.0,
        std::cmp::Ordering::Equal => 0.5 * stretch.period_s,
        std::cmp::Ordering::Greater => stretch.period_s,
    }
}

/// Growth of the following error of each axis, mm, and its derivative to the inputs of that axis.
fn grown_with_slopes<const N: usize>(inputs: &Inputs<N>) -> ([f64; N], Inputs<N>) {
    let (mut grown_mm, mut slopes) = ([0.0; N], [[0.0; INPUTS]; N]);
    for axis in 0..N {
        let bends = BENDS.map(|bend| bend * (1.0 + 0.3 * axis as f64));
        let sum = |weights: &[f64; INPUTS]| {
            weights
                .iter()
                .zip(&inputs[axis])
                .map(|(w, i)| w * i)
                .sum::<f64>()
        };
        let (sin, cos) = sum(&bends).sin_cos();
        grown_mm[axis] = sum(&LINEAR) + BENT_MM * sin;
        slopes[axis] = std::array::from_fn(|input| LINEAR[input] + BENT_MM * cos * bends[input]);
    }
    (grown_mm, slopes)
}

impl<const N: usize> Predictor<N> for Servo<'_, N> {
    /// Returns the lag of the linear part.
    fn lag_s(&self) -> f64 {
        let [f0, f1, f2, e0, e1] = LINEAR;
        -(f0 + f1 + f2) / (e0 + e1) / FEED_SCALE_MM_S
    }

    fn advance(
        &mut self,
        window: &Window<'_, N>,
        stretch: &CommandedPeriod<N>,
        sensitivity: &mut Sensitivity<N>,
    ) -> [f64; N] {
        let [from_mm, to_mm] = stretch.command_mm;
        let feed = scale(
            1.0 / (window.feed_period_s * FEED_SCALE_MM_S),
            sub(to_mm, from_mm),
        );
        let (grown_mm, slopes) = grown_with_slopes(&self.delays.inputs(feed));
        self.slopes.borrow_mut()[stretch.period] = slopes;
        self.feel(&slopes, stretch, sensitivity);
        let error_mm = add_scaled(self.delays.error[0], 1.0, grown_mm);
        self.delays.push(feed, error_mm);
        sub(to_mm, error_mm)
    }
}
