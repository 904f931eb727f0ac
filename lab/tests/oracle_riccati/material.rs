//! The problem of one tick: the circle of the rig, a tool that is off it, and a plan that is half
//! way.

use std::cell::RefCell;

use feedwright_control::vector::add_scaled;
use feedwright_control::{Knot, KnotSource, Preview, Register, Window};
use feedwright_lab::{
    Accelerations, CorrectionLimits, GaussNewton, HorizonProblem, HorizonSettings, MAX_KNOTS,
};

use super::model::{Servo, Slopes};

/// Feed period, s, and servo period, s.
const FEED_PERIOD_S: f64 = 0.003;
const SERVO_S: f64 = 0.001;
/// Largest acceleration of the plan of the tick before, mm/s^2.
const PLANNED_MM_S2: f64 = 100.0;

/// A helix of radius 10 mm at 50 mm/s in the first two axes; the third, where there is one, falls.
struct Helix;

impl<const N: usize> KnotSource<N> for Helix {
    fn knot(&mut self, tau_s: f64) -> Knot<N> {
        let (sin, cos) = (5.0 * tau_s).sin_cos();
        // 50 mm/s in all: 48 around and 14 down.
        let (around, down) = if N == 2 { (1.0, 0.0) } else { (0.96, -0.28) };
        let place = [
            10.0 * around * sin,
            10.0 * around * (1.0 - cos),
            50.0 * down * tau_s,
        ];
        let tangent = [around * cos, around * sin, down];
        Knot {
            position_mm: std::array::from_fn(|axis| place[axis]),
            tangent: std::array::from_fn(|axis| tangent[axis]),
            feed_mm_s: 50.0,
            cutting: true,
        }
    }
}

/// State that a tick starts from.
pub(crate) struct Material<const N: usize> {
    slopes: RefCell<Slopes<N>>,
    register: Register<N>,
    preview: Preview<N>,
    settings: HorizonSettings<N>,
    /// The plan of the tick before, mm/s^2.
    pub(crate) plan: Accelerations<N>,
}

impl<const N: usize> Material<N> {
    /// A tick with a horizon of `knots` knots and without limits.
    pub(crate) fn new(knots: usize) -> Self {
        Self::within(knots, f64::INFINITY)
    }

    /// A tick with a horizon of `knots` knots. In each axis the acceleration of the offset is at
    /// most `most_mm_s2`, mm/s^2.
    pub(crate) fn within(knots: usize, most_mm_s2: f64) -> Self {
        let mut register = Register::default();
        for i in 0..300 {
            register.push(Helix.knot(f64::from(i) * SERVO_S));
        }
        let mut preview = Preview::new(SERVO_S);
        preview.fill(&mut Helix, 0.299, 0.15);
        let limits = CorrectionLimits {
            acceleration_mm_s2: [most_mm_s2; N],
            ..CorrectionLimits::NONE
        };
        let settings = HorizonSettings {
            knots,
            limits,
            ..HorizonSettings::DEFAULT
        };
        let planned_mm_s2 = PLANNED_MM_S2.min(most_mm_s2);
        let plan = std::array::from_fn(|knot| {
            let planned = |axis| {
                if knot < knots {
                    planned_mm_s2 * ((3 * knot + 5 * axis) as f64).sin()
                } else {
                    0.0
                }
            };
            std::array::from_fn(planned)
        });
        Self {
            slopes: RefCell::new([[[0.0; 5]; N]; MAX_KNOTS]),
            register,
            preview,
            settings,
            plan,
        }
    }

    /// Rolls the plan out and returns the problem and the slopes of each knot.
    pub(crate) fn roll_out(&self) -> (HorizonProblem<N>, Slopes<N>) {
        let window = Window {
            register: &self.register,
            preview: &self.preview,
            tau_s: 0.299,
            feed_period_s: FEED_PERIOD_S,
            offset_mm: [0.01; N],
            offset_mm_s: [0.0; N],
        };
        let model = Servo::new(&self.slopes);
        let problem = HorizonProblem::new(&model, &window, &self.plan, &self.settings);
        (problem, *self.slopes.borrow())
    }

    /// The plan changed.
    pub(crate) fn after(&self, change: &Accelerations<N>) -> Accelerations<N> {
        std::array::from_fn(|knot| add_scaled(self.plan[knot], 1.0, change[knot]))
    }

    /// The plan after one step of the solver.
    pub(crate) fn improved(&self, problem: &HorizonProblem<N>) -> Accelerations<N> {
        let mut plan = self.plan;
        GaussNewton::default().improve(problem, &mut plan);
        plan
    }
}

/// The largest difference of two plans, as a share of the largest acceleration.
pub(crate) fn difference<const N: usize>(a: &Accelerations<N>, b: &Accelerations<N>) -> f64 {
    let largest = a
        .as_flattened()
        .iter()
        .fold(0.0_f64, |most, a| most.max(a.abs()));
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs())) / largest
}
