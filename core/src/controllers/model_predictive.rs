//! Model-predictive contouring with the exact model of the machine, solved to convergence.
//!
//! The horizon of [`feedwright_control::horizon`] over a model that is the machine itself: its servo law, inertia, friction,
//! period by period. What is not in the machine file it does not know: the disturbance is predicted from what the model
//! missed, as everywhere. It is what an identified model could reach if it were perfect and the control had all the time of
//! the world; it allocates nothing, but takes too long for a servo thread.
//!
//! Source: Lam, Manzie and Good (2010), "Model predictive contouring control", for the contour error over a horizon; the
//! progress along the path stays as planned here, since a time bought with error is not compared.

use std::f64::consts::TAU;

use feedwright_control::activation::tanh;
use feedwright_control::controller::receding_horizon::lag_s;
use feedwright_control::horizon::{self, MOST_KNOTS, Model, Plan, Response, Stretch};
use feedwright_control::identifier::residual::{self, Residual};
use feedwright_control::vector::{add_scaled, norm, sub};
use feedwright_control::{Command, Controller, Measured, Schedule, Window};

use crate::machine::{Axis, Machine};

/// Steps of Gauss and Newton, at most.
const MOST_STEPS: usize = 20;
/// Converged: no offset rate changes by more, mm/s; a nanometre in a feed period.
const CONVERGED_MM_S: f64 = 2e-4;

/// Settings of the controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Servo periods in a feed period.
    pub servo_periods: u32,
    /// The inversion.
    pub horizon: horizon::Settings,
}

/// Model-predictive contouring.
#[derive(Debug, Clone)]
pub struct ModelPredictive<const N: usize> {
    settings: Settings,
    /// The model at rest at the origin.
    rest: Exact<N>,
    model: Exact<N>,
    plan: Plan<N>,
    /// Where the tool was expected, mm, without and with what the model was expected to miss.
    expected_mm: Option<[[f64; N]; 2]>,
    missed_mm: f64,
}

impl<const N: usize> ModelPredictive<N> {
    /// With the model of a machine.
    pub fn new(machine: &Machine, settings: Settings) -> Self {
        let rest = Exact::new(machine, settings.servo_periods);
        Self { settings, model: rest.clone(), rest, plan: Plan::default(), expected_mm: None, missed_mm: 0.0 }
    }

    /// The tool is where it is measured; its speed is the model's, which forgets its errors within the time constant of the
    /// speed loop.
    fn take_in(&mut self, window: &Window<'_, N>, position_mm: [f64; N]) {
        if !norm(position_mm).is_finite() {
            return;
        }
        match self.expected_mm {
            Some([modelled_mm, expected_mm]) => {
                let missed_mm = sub(position_mm, modelled_mm);
                self.missed_mm = norm(sub(position_mm, expected_mm));
                for axis in 0..N {
                    self.model.residual[axis].push(missed_mm[axis]);
                }
            }
            None => {
                // The position loop has seen this error before: its derivative begins at rest.
                let command_mm = add_scaled(window.now().position_mm, 1.0, window.offset_mm);
                let error_mm = sub(command_mm, position_mm);
                for (axis, error_mm) in self.model.axes.iter_mut().zip(error_mm) {
                    axis.last_error_rad = error_mm * axis.rad_per_mm;
                }
            }
        }
        for (axis, position_mm) in self.model.axes.iter_mut().zip(position_mm) {
            axis.angle_rad = position_mm * axis.rad_per_mm;
        }
    }
}

impl<const N: usize> Controller<N> for ModelPredictive<N> {
    fn schedule(&self) -> Schedule {
        Schedule { servo_periods: self.settings.servo_periods, preview: self.settings.horizon.knots as u32 }
    }

    fn reset(&mut self) {
        self.model.clone_from(&self.rest);
        self.plan.reset();
        self.expected_mm = None;
        self.missed_mm = 0.0;
    }

    fn observe(&mut self, _: &Measured<N>) {}

    fn missed_mm(&self) -> f64 {
        self.missed_mm
    }

    fn command(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N> {
        self.take_in(window, measured.position_mm);
        let settings = &self.settings.horizon;
        let lag_s = lag_s(window, measured);
        let mut step = self.plan.improve(&self.model, window, lag_s, settings);
        for _ in 1..MOST_STEPS {
            if step.change_mm_s <= CONVERGED_MM_S {
                break;
            }
            step = self.plan.improve_again(&self.model, window, lag_s, settings);
        }
        let now_mm = add_scaled(window.now().position_mm, 1.0, window.offset_mm);
        let next = window.ahead(1);
        let offset_mm = step.offset_mm;
        let next_mm = add_scaled(next.position_mm, 1.0, offset_mm);
        let stretch = Stretch { knot: 0, command_mm: [now_mm, next_mm], offset_mm: [window.offset_mm, offset_mm] };
        let residual = self.model.residual;
        let expected_mm = self.model.advance(window, &stretch);
        let modelled_mm = std::array::from_fn(|i| self.model.axes[i].angle_rad / self.model.axes[i].rad_per_mm);
        // What is expected to be missed is shifted in when it was missed.
        self.model.residual = residual;
        self.model.missed_mm = [0.0; N];
        self.expected_mm = Some([modelled_mm, expected_mm]);
        Command { rate: 1.0, offset_mm }
    }
}

/// The machine without its disturbance, and what the model is expected to miss.
#[derive(Debug, Clone)]
struct Exact<const N: usize> {
    axes: [ExactAxis; N],
    servo_periods: u32,
    substeps: u32,
    servo_s: f64,
    mechanics_s: f64,
    response: Response<N>,
    residual: [Residual; N],
    /// Sum of what it is expected to miss on the way, mm.
    missed_mm: [f64; N],
    lag_s: f64,
}

#[derive(Debug, Clone, Copy)]
struct ExactAxis {
    parameters: Axis,
    rad_per_mm: f64,
    angle_rad: f64,
    speed_rad_s: f64,
    last_error_rad: f64,
}

impl ExactAxis {
    /// One servo period at a command, friction scaled by `friction`.
    fn step(&mut self, command_mm: f64, servo_s: f64, mechanics_s: f64, substeps: u32, friction: f64) {
        let axis = &self.parameters;
        let error_rad = command_mm * self.rad_per_mm - self.angle_rad;
        let reference = axis.kp_1_s * error_rad + axis.kd * (error_rad - self.last_error_rad) / servo_s;
        self.last_error_rad = error_rad;
        for _ in 0..substeps {
            let w = self.speed_rad_s;
            let torque = (axis.kv_nm_s_per_rad * (reference - w)).clamp(-axis.torque_limit_nm, axis.torque_limit_nm);
            let [sign] = tanh([w / axis.coulomb_smoothing_rad_s]);
            let load = axis.viscous_friction_nm_s * w + friction * axis.coulomb_friction_nm * sign;
            self.speed_rad_s += mechanics_s / axis.inertia_kg_m2 * (torque - load);
            self.angle_rad += mechanics_s * self.speed_rad_s;
        }
    }
}

impl<const N: usize> Exact<N> {
    fn new(machine: &Machine, servo_periods: u32) -> Self {
        let axes = std::array::from_fn(|i| {
            let parameters = *machine.axis(i);
            let rad_per_mm = TAU / parameters.lead_mm_per_rev;
            ExactAxis { parameters, rad_per_mm, angle_rad: 0.0, speed_rad_s: 0.0, last_error_rad: 0.0 }
        });
        let lag_s = axes.iter().map(|axis: &ExactAxis| 1.0 / axis.parameters.kp_1_s).sum::<f64>() / N as f64;
        let period = machine.period;
        let mut exact = Self {
            axes,
            servo_periods,
            substeps: period.mechanics_per_servo,
            servo_s: period.servo_s,
            mechanics_s: period.mechanics_s,
            response: [[[0.0; N]; N]; MOST_KNOTS],
            residual: [Residual::new(residual::Settings::DEFAULT); N],
            missed_mm: [0.0; N],
            lag_s,
        };
        exact.response = exact.linear_response();
        exact
    }

    /// R(m) without Coulomb friction: an offset that moves at 1 mm/s for one feed period and stays.
    fn linear_response(&self) -> Response<N> {
        let mut response = [[[0.0; N]; N]; MOST_KNOTS];
        for (i, axis) in self.axes.iter().enumerate() {
            let mut axis = *axis;
            let mut command_mm: f64 = 0.0;
            for (m, at) in response.iter_mut().enumerate() {
                for _ in 0..self.servo_periods {
                    axis.step(command_mm, self.servo_s, self.mechanics_s, self.substeps, 0.0);
                    command_mm += if m == 0 { self.servo_s } else { 0.0 };
                }
                at[i][i] = axis.angle_rad / axis.rad_per_mm;
            }
        }
        response
    }
}

impl<const N: usize> Model<N> for Exact<N> {
    fn lag_s(&self) -> f64 {
        self.lag_s
    }

    fn advance(&mut self, window: &Window<'_, N>, stretch: &Stretch<N>) -> [f64; N] {
        let [from_mm, to_mm] = stretch.offset_mm;
        for phase in 0..self.servo_periods {
            let ahead = stretch.knot as u32 * self.servo_periods + phase;
            let path_mm = window.preview.at(window.tau_s + f64::from(ahead) * self.servo_s).position_mm;
            let part = f64::from(phase) / f64::from(self.servo_periods);
            for (i, axis) in self.axes.iter_mut().enumerate() {
                let command_mm = path_mm[i] + from_mm[i] + part * (to_mm[i] - from_mm[i]);
                axis.step(command_mm, self.servo_s, self.mechanics_s, self.substeps, 1.0);
            }
        }
        for i in 0..N {
            self.missed_mm[i] += self.residual[i].foresee();
        }
        std::array::from_fn(|i| self.axes[i].angle_rad / self.axes[i].rad_per_mm + self.missed_mm[i])
    }

    fn response(&self, _: f64, _: usize) -> Response<N> {
        self.response
    }
}
