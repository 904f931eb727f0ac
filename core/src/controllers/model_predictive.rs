//! Model-predictive contouring with the exact model of the machine, solved to convergence.
//!
//! The horizon of [`feedwright_control::horizon`] over a model that is the machine itself: its servo law, inertia, friction,
//! period by period. What is not in the machine file it does not know: the disturbance is predicted from what the model
//! missed, as everywhere. It is what an identified model could reach if it were perfect and the control had all the time of
//! the world; it allocates nothing, but takes too long for a servo thread.
//!
//! Source: Lam, Manzie and Good (2010), "Model predictive contouring control", for the contour error over a horizon; the
//! progress along the path stays as planned here, since a time bought with error is not compared.

use feedwright_control::axis::{self, AxisState};
use feedwright_control::horizon::{self, CommandedPeriod, MAX_KNOTS, OffsetPlan, Predictor, Sensitivity};
use feedwright_control::identifier::residual::{self, DisturbanceForecast, Residual};
use feedwright_control::vector::{add_scaled, norm, sub};
use feedwright_control::{Command, Controller, Measured, Schedule, Window};

use crate::machine::Known;

/// Steps of Gauss and Newton, at most.
const MAX_STEPS: usize = 20;
/// Converged: no acceleration of the offset changes by more, mm/s^2; a tenth of a micrometre per second in a feed period.
const CONVERGED_MM_S2: f64 = 0.05;

/// Settings of the controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings<const N: usize> {
    /// Servo periods in a feed period.
    pub servo_periods: u32,
    /// The inversion.
    pub horizon: horizon::Settings<N>,
}

/// Model-predictive contouring.
#[derive(Debug, Clone)]
pub struct ModelPredictive<const N: usize> {
    settings: Settings<N>,
    /// The model at rest at the origin.
    rest: Exact<N>,
    model: Exact<N>,
    residuals: [Residual; N],
    plan: OffsetPlan<N>,
    /// Where the tool was expected, mm, without and with what the model was expected to miss.
    expected_mm: Option<[[f64; N]; 2]>,
    prediction_error_mm: f64,
}

impl<const N: usize> ModelPredictive<N> {
    /// With the nominal law of a machine.
    pub fn new(known: &Known, settings: Settings<N>) -> Self {
        let rest = Exact::new(known, settings.servo_periods);
        Self {
            settings,
            model: rest.clone(),
            rest,
            residuals: [Residual::new(residual::Settings::DEFAULT); N],
            plan: OffsetPlan::default(),
            expected_mm: None,
            prediction_error_mm: 0.0,
        }
    }

    /// The tool is where it is measured; its speed is the model's, which forgets its errors within the time constant of the
    /// speed loop.
    fn take_in(&mut self, window: &Window<'_, N>, position_mm: [f64; N]) {
        if !norm(position_mm).is_finite() {
            return;
        }
        match self.expected_mm {
            Some([modelled_mm, expected_mm]) => {
                let prediction_error_mm = sub(position_mm, modelled_mm);
                self.prediction_error_mm = norm(sub(position_mm, expected_mm));
                for axis in 0..N {
                    self.residuals[axis].push(prediction_error_mm[axis]);
                }
            }
            None => {
                // The position loop has seen this error before: its derivative begins at rest.
                let command_mm = add_scaled(window.now().position_mm, 1.0, window.offset_mm);
                let error_mm = sub(command_mm, position_mm);
                for (axis, error_mm) in self.model.axes.iter_mut().zip(error_mm) {
                    axis.state.error_rad = error_mm * axis.law.parameters.rad_per_mm;
                }
            }
        }
        for (axis, position_mm) in self.model.axes.iter_mut().zip(position_mm) {
            axis.state.angle_rad = position_mm * axis.law.parameters.rad_per_mm;
        }
    }
}

impl<const N: usize> Controller<N> for ModelPredictive<N> {
    fn schedule(&self) -> Schedule {
        Schedule { servo_periods: self.settings.servo_periods, preview: self.settings.horizon.knots as u32 }
    }

    fn reset(&mut self) {
        self.model.clone_from(&self.rest);
        self.residuals = [Residual::new(residual::Settings::DEFAULT); N];
        self.plan.reset();
        self.expected_mm = None;
        self.prediction_error_mm = 0.0;
    }

    fn observe(&mut self, window: &Window<'_, N>, measured: Option<&Measured<N>>) {
        if let Some(measured) = measured {
            self.take_in(window, measured.position_mm);
        }
    }

    fn prediction_error_mm(&self) -> f64 {
        self.prediction_error_mm
    }

    fn command(&mut self, window: &Window<'_, N>, _: &Measured<N>) -> Command<N> {
        let settings = &self.settings.horizon;
        let mut model = self.model.clone();
        model.residual = self.residuals.each_ref().map(Residual::forecast);
        self.plan.shift(1, settings);
        let mut step = self.plan.improve(&model, window, settings);
        for _ in 1..MAX_STEPS {
            if step.change_mm_s2 <= CONVERGED_MM_S2 {
                break;
            }
            step = self.plan.improve(&model, window, settings);
        }
        let mut stretch = CommandedPeriod::now(window, 1);
        stretch.go_on(window, step.acceleration_mm_s2);
        let expected_mm = model.advance(window, &stretch, &mut [[0.0; N]; MAX_KNOTS]);
        for (own, foreseen) in self.model.axes.iter_mut().zip(&model.axes) {
            own.state = foreseen.state;
        }
        self.expected_mm = Some([self.model.tool_mm(), expected_mm]);
        Command::accelerated(window, step.acceleration_mm_s2)
    }
}

/// The machine without its disturbance, and what the model is expected to miss.
#[derive(Debug, Clone)]
struct Exact<const N: usize> {
    axes: [ExactAxis; N],
    servo_periods: u32,
    servo_s: f64,
    residual: [DisturbanceForecast; N],
    /// Sum of what it is expected to miss on the way, mm.
    prediction_error_mm: [f64; N],
    lag_s: f64,
}

impl<const N: usize> Exact<N> {
    fn new(known: &Known, servo_periods: u32) -> Self {
        let laws: [axis::AxisLaw; N] = known.law();
        let axes = std::array::from_fn(|i| {
            let law = laws[i];
            ExactAxis { law, state: AxisState::default(), slopes: [AxisState::default(); MAX_KNOTS] }
        });
        let lag_s = axes.iter().map(|axis| 1.0 / axis.law.parameters.kp_1_s).sum::<f64>() / N as f64;
        Self {
            axes,
            servo_periods,
            servo_s: known.period.servo_s,
            residual: [Residual::new(residual::Settings::DEFAULT).forecast(); N],
            prediction_error_mm: [0.0; N],
            lag_s,
        }
    }

    fn tool_mm(&self) -> [f64; N] {
        std::array::from_fn(|i| {
            self.axes[i].state.angle_rad / self.axes[i].law.parameters.rad_per_mm + self.prediction_error_mm[i]
        })
    }
}

impl<const N: usize> Predictor<N> for Exact<N> {
    fn lag_s(&self) -> f64 {
        self.lag_s
    }

    fn advance(
        &mut self,
        window: &Window<'_, N>,
        stretch: &CommandedPeriod<N>,
        sensitivity: &mut Sensitivity<N>,
    ) -> [f64; N] {
        let offset = Command { bend_mm: stretch.bend_mm(), ..Command::straight(1.0, stretch.offset_mm[1]) };
        for phase in 0..self.servo_periods {
            let ahead = stretch.period as u32 * self.servo_periods + phase;
            let path_mm = window.at(f64::from(ahead) * self.servo_s).position_mm;
            let part = f64::from(phase) / f64::from(self.servo_periods);
            let offset_mm = offset.offset_after_mm(part, stretch.offset_mm[0]);
            let moved_s2 = std::array::from_fn(|knot| stretch.moved_s2(knot, part));
            for (i, axis) in self.axes.iter_mut().enumerate() {
                axis.advance(path_mm[i] + offset_mm[i], &moved_s2, stretch.knot());
            }
        }
        for i in 0..N {
            self.prediction_error_mm[i] += self.residual[i].next_mm();
            for knot in 0..=stretch.knot() {
                sensitivity[knot][i] = self.axes[i].slopes[knot].angle_rad / self.axes[i].law.parameters.rad_per_mm;
            }
        }
        self.tool_mm()
    }
}

/// An axis: its state, and the derivative of that to the acceleration of each knot, per mm/s^2.
#[derive(Debug, Clone, Copy)]
struct ExactAxis {
    law: axis::AxisLaw,
    state: AxisState,
    slopes: [AxisState; MAX_KNOTS],
}

impl ExactAxis {
    /// One servo period at a command that moves by `moved_s2` mm for an acceleration of 1 mm/s^2 in each of the knots up to `knot`.
    fn advance(&mut self, command_mm: f64, moved_s2: &[f64; MAX_KNOTS], knot: usize) {
        let law = self.law;
        let asked = |moved_mm: f64, state: &mut AxisState| {
            law.position_loop(moved_mm * law.parameters.rad_per_mm - state.angle_rad, state)
        };
        let asked_rad_s = asked(command_mm, &mut self.state);
        let mut slopes_asked = [0.0; MAX_KNOTS];
        for (slope_asked, (slope, moved_s2)) in
            slopes_asked.iter_mut().zip(self.slopes.iter_mut().zip(moved_s2)).take(knot + 1)
        {
            *slope_asked = asked(*moved_s2, slope);
        }
        for _ in 0..law.periods.mechanics_per_servo {
            let w = self.state.speed_rad_s;
            let torque_nm = law.torque_nm(asked_rad_s, w);
            let [sign] = axis::signs(&[law], [w]);
            law.accelerate(torque_nm - law.friction_nm(w, sign), &mut self.state);
            let [gain, damping] = law.slopes_nm_s(torque_nm, sign);
            for (slope, asked) in self.slopes.iter_mut().zip(&slopes_asked).take(knot + 1) {
                law.accelerate(gain * asked - damping * slope.speed_rad_s, slope);
            }
        }
    }
}
