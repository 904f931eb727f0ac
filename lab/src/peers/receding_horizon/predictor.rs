//! The identified servo as the model that a horizon is rolled out through: the tool, and its derivative to the accelerations of the
//! offset.
//!
//! ```text
//! e(k+1) = e(k) + f(F(k), F(k-1), F(k-2), e(k), e(k-1)) + d(k)        F: commanded feedrate, e: following error, d: forecast residual
//! de/da  moves on along the slopes of f
//! ```

use feedwright_control::vector::{add_scaled, scale, sub};
use feedwright_control::{Delays, FEED_SCALE_MM_S, Inputs, ServoModel, Window};

use super::adaptation::Adaptation;
use super::horizon::{CommandedPeriod, MAX_KNOTS, Predictor, Sensitivity};
use super::residual::DisturbanceForecast;

/// The feedrate between two commands, scaled.
#[inline]
pub(super) fn feed<const N: usize>(from_mm: [f64; N], to_mm: [f64; N], period_s: f64) -> [f64; N] {
    scale(1.0 / (period_s * FEED_SCALE_MM_S), sub(to_mm, from_mm))
}

/// The identified servo as a model of the machine.
#[derive(Debug, Clone)]
pub(super) struct IdentifiedPredictor<'a, const N: usize, D> {
    net: &'a D,
    delays: Delays<N>,
    /// What the offset makes of the following error, and the offset, mm.
    response: Delays<N>,
    offset_mm: [f64; N],
    residual: [DisturbanceForecast; N],
    /// Derivative of the following error, scaled, to the acceleration of each knot, s^2: now and one feed period ago.
    slopes: [[[f64; N]; MAX_KNOTS]; 2],
}

impl<'a, const N: usize, D: ServoModel<N>> IdentifiedPredictor<'a, N, D> {
    pub(super) fn new(net: &'a Adaptation<N, D>, delays: Delays<N>, response: Delays<N>) -> Self {
        let slopes = [[[0.0; N]; MAX_KNOTS]; 2];
        Self { net: net.net(), delays, response, offset_mm: [0.0; N], residual: net.residual(), slopes }
    }

    /// The derivative moves on as the following error does, along the slopes of the identifier.
    #[inline]
    fn advance_slopes(&mut self, slopes: &Inputs<N>, stretch: &CommandedPeriod<N>, sensitivity: &mut Sensitivity<N>) {
        let [now, before] = &mut self.slopes;
        let knots = now.iter_mut().zip(before).zip(sensitivity).enumerate();
        for (knot, ((now, before), sensitivity)) in knots.take(stretch.knot() + 1) {
            let moved_s2 = stretch.moved_s2(knot, 1.0);
            // Of F(k), F(k-1) and F(k-2).
            let gained = [0, 1, 2].map(|back| stretch.gained_s(knot, back) / FEED_SCALE_MM_S);
            for axis in 0..N {
                let [f0, f1, f2, e0, e1] = slopes[axis];
                let grown_mm = f0 * gained[0] + f1 * gained[1] + f2 * gained[2] + e0 * now[axis] + e1 * before[axis];
                before[axis] = now[axis];
                now[axis] += grown_mm / D::ERROR_SCALE_MM;
                sensitivity[axis] = moved_s2 - D::ERROR_SCALE_MM * now[axis];
            }
        }
    }
}

impl<const N: usize, D: ServoModel<N>> IdentifiedPredictor<'_, N, D> {
    /// What the offset makes of the following error moves on as all of it does, but for what is not linear.
    #[inline]
    fn respond(&mut self, stretch: &CommandedPeriod<N>) {
        let [from_mm, to_mm] = stretch.offset_mm;
        let feed = feed(from_mm, to_mm, stretch.period_s);
        let inputs = self.response.inputs(feed);
        let error = core::array::from_fn(|axis| {
            let grown_mm: f64 = self.net.own_linear(axis).iter().zip(&inputs[axis]).map(|(l, i)| l * i).sum();
            self.response.error[0][axis] + grown_mm / D::ERROR_SCALE_MM
        });
        self.response.push(feed, error);
        self.offset_mm = to_mm;
    }
}

impl<const N: usize, D: ServoModel<N>> Predictor<N> for IdentifiedPredictor<'_, N, D> {
    fn lag_s(&self) -> f64 {
        self.net.lag_s()
    }

    #[inline]
    fn advance(
        &mut self,
        window: &Window<'_, N>,
        stretch: &CommandedPeriod<N>,
        sensitivity: &mut Sensitivity<N>,
    ) -> [f64; N] {
        let [from_mm, to_mm] = stretch.command_mm;
        let feed = feed(from_mm, to_mm, window.feed_period_s);
        let (mut grown_mm, slopes) = self.net.predict_with_slopes(&self.delays.inputs(feed));
        for axis in 0..N {
            grown_mm[axis] += self.residual[axis].next_mm();
        }
        self.advance_slopes(&slopes, stretch, sensitivity);
        let error = add_scaled(self.delays.error[0], 1.0 / D::ERROR_SCALE_MM, grown_mm);
        self.delays.push(feed, error);
        self.respond(stretch);
        add_scaled(to_mm, -D::ERROR_SCALE_MM, error)
    }

    fn moved_mm(&self) -> [f64; N] {
        add_scaled(self.offset_mm, -D::ERROR_SCALE_MM, self.response.error[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peers::receding_horizon::adaptation;
    use feedwright_control::{
        HIDDEN, INPUTS, Identifier, Knot, KnotSource, Preview, Register, ServoIdentifier, UNKNOWNS,
    };

    struct Line;

    impl KnotSource<2> for Line {
        fn knot(&mut self, tau_s: f64) -> Knot<2> {
            Knot { position_mm: [40.0 * tau_s, 30.0 * tau_s], tangent: [0.8, 0.6], feed_mm_s: 50.0, cutting: true }
        }
    }

    /// A servo like tnv40's, and hidden nodes that are far from saturated, half of them for each axis.
    fn net() -> ServoIdentifier<2> {
        let mut net = ServoIdentifier::NULL;
        for axis in 0..2 {
            net.linear[axis][axis] = [0.149, -0.082, 0.001, 0.49, -0.56];
            for node in (axis..HIDDEN).step_by(2) {
                net.output[axis][node] = 1e-3 * (node as f64 - 5.0);
                for input in 0..INPUTS {
                    net.hidden[axis][input][node] = 0.3 * libm::sin((7 * axis + 3 * input + node) as f64);
                }
            }
        }
        net
    }

    /// The tool at the end of each knot and its derivative.
    fn roll_out(window: &Window<'_, 2>, accelerations: &[f64; 4], periods: usize) -> [([f64; 2], Sensitivity<2>); 4] {
        let spread = [[[0.0; UNKNOWNS]; UNKNOWNS]; 2];
        let adaptation = Adaptation::new(net(), &spread, adaptation::AdaptationSettings::DEFAULT);
        let mut model = IdentifiedPredictor::new(
            &adaptation,
            Delays { feed: [[0.8, 0.6]; 2], error: [[0.8, 0.6]; 2] },
            Delays::REST,
        );
        let mut stretch = CommandedPeriod::now(window, periods);
        core::array::from_fn(|knot| {
            let (mut tool_mm, mut sensitivity) = ([0.0; 2], [[0.0; 2]; MAX_KNOTS]);
            for _ in 0..periods {
                stretch.go_on(window, [accelerations[knot]; 2]);
                tool_mm = model.advance(window, &stretch, &mut sensitivity);
            }
            (tool_mm, sensitivity)
        })
    }

    #[test]
    fn what_the_tool_feels_is_the_derivative_of_the_roll_out_whatever_the_length_of_a_knot() {
        let (mut register, mut preview) = (Register::default(), Preview::new(0.001));
        register.push(Line.knot(0.0));
        preview.fill(&mut Line, 0.0, 0.1);
        let window = Window {
            register: &register,
            preview: &preview,
            tau_s: 0.0,
            feed_period_s: 0.003,
            offset_mm: [0.0; 2],
            offset_mm_s: [2.0, -1.0],
        };
        let accelerations = [300.0, -200.0, 500.0, 100.0];
        for periods in 1..=3 {
            let found = roll_out(&window, &accelerations, periods);
            for j in 0..4 {
                let step = 0.1;
                let (mut more, mut less) = (accelerations, accelerations);
                (more[j], less[j]) = (accelerations[j] + step, accelerations[j] - step);
                let (more, less) = (roll_out(&window, &more, periods), roll_out(&window, &less, periods));
                for i in 0..4 {
                    for axis in 0..2 {
                        let sensitivity = if j <= i { found[i].1[j][axis] } else { 0.0 };
                        let slope = (more[i].0[axis] - less[i].0[axis]) / (2.0 * step);
                        assert!(
                            (sensitivity - slope).abs() < 1e-6 * window.feed_period_s * window.feed_period_s,
                            "{periods} {i} {j} {axis}: {sensitivity} {slope}"
                        );
                    }
                }
            }
        }
    }
}
