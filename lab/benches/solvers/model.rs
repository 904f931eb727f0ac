//! A servo identifier as the model of a horizon, one feed period a knot, that keeps the slopes of every knot.
//!
//! The controller's own model keeps none: the dense solvers need only what the tool feels.

use std::cell::RefCell;

use feedwright_control::vector::{add_scaled, scale, sub};
use feedwright_control::{
    Delays, FEED_SCALE_MM_S, FOLLOWING_SCALE_MM, HIDDEN, INPUTS, Identifier, Inputs, ServoIdentifier, ServoModel,
    Window,
};
use feedwright_lab::{CommandedPeriod, MAX_KNOTS, Predictor, Sensitivity};

/// Derivative of the growth of the following error to the inputs, knot by knot, mm for an input of 1.
pub(crate) type Slopes<const N: usize> = [Inputs<N>; MAX_KNOTS];

/// Of tnv40: what least squares give for one axis.
const LINEAR: [f64; INPUTS] = [0.244, -0.101, -0.001_86, 0.2785, -0.4166];
/// Output of a hidden node at its largest, mm: the slopes differ by a tenth from knot to knot.
const HIDDEN_MM: f64 = 0.03;

/// A servo model like the one of tnv40, with hidden nodes that are far from saturated and differ
/// from axis to axis.
pub(crate) fn servo<const N: usize>() -> ServoIdentifier<N> {
    let mut net = ServoIdentifier::NULL;
    for axis in 0..N {
        net.linear[axis][axis] = LINEAR;
        for node in 0..HIDDEN {
            let phase = (7 * axis + 3 * node) as f64;
            net.output[axis][node] = HIDDEN_MM * phase.sin();
            for input in 0..INPUTS {
                net.hidden[axis][input][node] = 0.3 * (phase + 2.0 * input as f64).cos();
            }
        }
    }
    net
}

/// The model.
#[derive(Clone)]
pub(crate) struct Servo<'a, const N: usize> {
    net: &'a ServoIdentifier<N>,
    delays: Delays<N>,
    slopes: &'a RefCell<Slopes<N>>,
    /// Whether what the tool feels is wanted: it is the work of all knots before, at every knot.
    sensitivity: bool,
    /// Derivative of the following error to the acceleration of each knot, s^2: now and one knot ago.
    following_s2: [[[f64; N]; MAX_KNOTS]; 2],
}

impl<'a, const N: usize> Servo<'a, N> {
    /// At full feed along the first axis.
    pub(crate) fn new(net: &'a ServoIdentifier<N>, slopes: &'a RefCell<Slopes<N>>, sensitivity: bool) -> Self {
        let mut one = [0.0; N];
        one[0] = 1.0;
        let delays = Delays { feed: [one; 2], error: [one; 2] };
        Self { net, delays, slopes, sensitivity, following_s2: [[[0.0; N]; MAX_KNOTS]; 2] }
    }

    fn feel(&mut self, slopes: &Inputs<N>, stretch: &CommandedPeriod<N>, sensitivity: &mut Sensitivity<N>) {
        let [following_s2, before_s2] = &mut self.following_s2;
        for knot in 0..=stretch.knot() {
            let gained = [0, 1, 2].map(|back| stretch.gained_s(knot, back) / FEED_SCALE_MM_S);
            for axis in 0..N {
                let [f0, f1, f2, e0, e1] = slopes[axis];
                let of_feed = f0 * gained[0] + f1 * gained[1] + f2 * gained[2];
                let of_error = e0 * following_s2[knot][axis] + e1 * before_s2[knot][axis];
                before_s2[knot][axis] = following_s2[knot][axis];
                following_s2[knot][axis] += of_feed + of_error / FOLLOWING_SCALE_MM;
                sensitivity[knot][axis] = stretch.moved_s2(knot, 1.0) - following_s2[knot][axis];
            }
        }
    }
}

impl<const N: usize> Predictor<N> for Servo<'_, N> {
    fn lag_s(&self) -> f64 {
        self.net.lag_s()
    }

    fn advance(
        &mut self,
        window: &Window<'_, N>,
        stretch: &CommandedPeriod<N>,
        sensitivity: &mut Sensitivity<N>,
    ) -> [f64; N] {
        let [from_mm, to_mm] = stretch.command_mm;
        let feed = scale(1.0 / (window.feed_period_s * FEED_SCALE_MM_S), sub(to_mm, from_mm));
        let (grown_mm, slopes) = self.net.predict_with_slopes(&self.delays.inputs(feed));
        self.slopes.borrow_mut()[stretch.knot()] = slopes;
        if self.sensitivity {
            self.feel(&slopes, stretch, sensitivity);
        }
        let error = add_scaled(self.delays.error[0], 1.0 / FOLLOWING_SCALE_MM, grown_mm);
        self.delays.push(feed, error);
        add_scaled(to_mm, -FOLLOWING_SCALE_MM, error)
    }
}
