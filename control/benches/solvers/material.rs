//! The problem of one tick: the circle of the rig, a tool that is off it, and a plan that is half way.

use std::cell::RefCell;

use feedwright_control::controller::receding_horizon;
use feedwright_control::horizon::problem::Problem;
use feedwright_control::horizon::{MOST_KNOTS, Rates, Settings, Solver};
use feedwright_control::identifier::servo::ServoIdentifier;
use feedwright_control::vector::{add_scaled, dot, sub};
use feedwright_control::window::{Knot, Preview, Reference, Register, Window};

use super::model::{Servo, Slopes, servo};

/// Feed period, s, and servo period, s.
const FEED_PERIOD_S: f64 = receding_horizon::FEED_PERIOD_S;
const SERVO_S: f64 = 0.001;
/// Lag of the tool, s.
const LAG_S: f64 = 0.02;

/// A helix of radius 10 mm at 50 mm/s in the first two axes; the third, where there is one, falls.
struct Helix;

impl<const N: usize> Reference<N> for Helix {
    fn knot(&mut self, tau_s: f64) -> Knot<N> {
        let (sin, cos) = (5.0 * tau_s).sin_cos();
        // 50 mm/s in all: 48 around and 14 down.
        let (around, down) = if N == 2 { (1.0, 0.0) } else { (0.96, -0.28) };
        let place = [10.0 * around * sin, 10.0 * around * (1.0 - cos), 50.0 * down * tau_s];
        let tangent = [around * cos, around * sin, down];
        Knot {
            position_mm: std::array::from_fn(|axis| place[axis]),
            tangent: std::array::from_fn(|axis| tangent[axis]),
            feed_mm_s: 50.0,
            cutting: true,
        }
    }
}

/// What a tick starts from.
pub(crate) struct Material<const N: usize> {
    net: ServoIdentifier<N>,
    slopes: RefCell<Slopes<N>>,
    register: Register<N>,
    preview: Preview<N>,
    settings: Settings,
    /// The plan of the tick before.
    pub(crate) rates: Rates<N>,
}

impl<const N: usize> Material<N> {
    /// With so many knots.
    pub(crate) fn new(knots: usize) -> Self {
        let mut register = Register::default();
        for i in 0..300 {
            register.push(Helix.knot(f64::from(i) * SERVO_S));
        }
        let mut preview = Preview::new(SERVO_S);
        preview.fill(&mut Helix, 0.299, 0.15);
        let settings = Settings { knots, ..receding_horizon::Settings::DEFAULT.horizon };
        let rates = std::array::from_fn(|knot| {
            std::array::from_fn(|axis| if knot < knots { ((3 * knot + 5 * axis) as f64).sin() } else { 0.0 })
        });
        Self { net: servo(), slopes: RefCell::new([[[0.0; 5]; N]; MOST_KNOTS]), register, preview, settings, rates }
    }

    /// Rolls the plan out: the problem, and the slopes of each knot. `felt`: whether the derivative to all rates is wanted.
    pub(crate) fn roll_out(&self, felt: bool) -> (Problem<N>, Slopes<N>) {
        let window = Window {
            register: &self.register,
            preview: &self.preview,
            tau_s: 0.299,
            feed_period_s: FEED_PERIOD_S,
            offset_mm: [0.01; N],
            offset_mm_s: [0.0; N],
        };
        let model = Servo::new(&self.net, &self.slopes, felt);
        let problem = Problem::new(&model, &window, LAG_S, &self.rates, 1, &self.settings);
        (problem, *self.slopes.borrow())
    }

    /// The plan changed.
    pub(crate) fn after(&self, change: &Rates<N>) -> Rates<N> {
        std::array::from_fn(|knot| add_scaled(self.rates[knot], 1.0, change[knot]))
    }

    /// The plan after one call of a solver.
    pub(crate) fn improved(&self, solver: &mut impl Solver<N>, problem: &Problem<N>) -> Rates<N> {
        let mut rates = self.rates;
        solver.improve(problem, &mut rates);
        rates
    }

    /// J of the problem linearised about the plan, term by term as it is written.
    pub(crate) fn cost(&self, problem: &Problem<N>, rates: &Rates<N>) -> f64 {
        let Settings { rate_weight, change_weight, tangential_price, .. } = problem.settings;
        let changed: Rates<N> = std::array::from_fn(|knot| sub(rates[knot], self.rates[knot]));
        let square = |v: [f64; N]| dot(v, v);
        let mut cost = 0.0;
        let mut offset_mm = [0.0; N];
        for knot in 0..problem.knots {
            offset_mm = add_scaled(offset_mm, problem.knot_s, changed[knot]);
            let mut tool_mm = [0.0; N];
            for (felt, changed) in problem.felt[knot].iter().zip(&changed).take(knot + 1) {
                tool_mm = std::array::from_fn(|axis| tool_mm[axis] + felt[axis] * changed[axis]);
            }
            let (directions, off_mm) = (&problem.directions[knot], &problem.off_mm[knot]);
            for d in 0..N - 1 {
                cost += 0.5 * (off_mm[d] + dot(directions[d], tool_mm)).powi(2);
            }
            cost += 0.5 * (tangential_price * (off_mm[N - 1] + dot(directions[N - 1], offset_mm))).powi(2);
            cost += 0.5 * rate_weight * square(rates[knot]);
            if knot > 0 {
                cost += 0.5 * change_weight * square(sub(rates[knot], rates[knot - 1]));
            }
        }
        cost
    }
}

/// The largest difference of two plans, as a share of the largest rate.
pub(crate) fn difference<const N: usize>(a: &Rates<N>, b: &Rates<N>) -> f64 {
    let largest = a.as_flattened().iter().fold(0.0_f64, |most, rate| most.max(rate.abs()));
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs())) / largest
}
