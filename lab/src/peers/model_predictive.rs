//! Model-predictive contouring with the exact model of the machine, solved to convergence.
//!
//! A [`horizon`] over a model that is the machine itself: servo loops, inertia and friction, period
//! by period, with its drive, its delays and its friction. The model is as late as the encoder: its
//! position is the measured one, and a reference acts on it both delays after it was sent. The
//! model has no knowledge that is unknown of a machine: the disturbance is predicted from the
//! earlier errors of the model, as everywhere. The result is the limit of an identified model if it
//! were perfect and the control had unlimited time. The controller allocates nothing, but takes too
//! long for a servo thread.
//!
//! Source: Lam, Manzie and Good (2010), "Model predictive contouring control", for the contour
//! error over a horizon; the progress along the path stays as planned here, since a time bought
//! with error is not compared.

mod least_squares;
mod residual;
pub(crate) mod horizon;

use feedwright_control::vector::{add_scaled, norm, sub};
use feedwright_control::{
    AxisModel, AxisState, Command, CommandQueue, Controller, DriveModel, DriveReference,
    DriveState, FrictionModel, Measured, Parameter, Schedule, SelfReport, Window, friction_signs,
};
use feedwright_sim::Known;

use horizon::{CommandedPeriod, HorizonSettings, MAX_KNOTS, OffsetPlan, Predictor, Sensitivity};
use residual::{DisturbanceForecast, Residual, ResidualSettings};

use super::deciding;

/// Steps of Gauss and Newton, at most.
const MAX_STEPS: usize = 20;
/// Converged: no acceleration of the offset changes by more, mm/s^2; a tenth of a micrometre per
/// second in a feed period.
const CONVERGED_MM_S2: f64 = 0.05;

/// Settings of the controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Settings<const N: usize> {
    /// Servo periods in a feed period.
    pub servo_periods: u32,
    /// The inversion.
    pub horizon: HorizonSettings<N>,
}

pub(super) const RATE_WEIGHT: Parameter = Parameter::number(
    "rate_weight_s2",
    HorizonSettings::<2>::DEFAULT.rate_weight,
    [0.0, 0.01],
    Some([1e-11, 1e-2]),
    "weight of the speed of the offset: below 1e-10 the plan rings from knot to knot, above 1e-4 nothing is corrected",
);
pub(super) const KNOTS: Parameter = Parameter::whole(
    "knots",
    HorizonSettings::<2>::DEFAULT.knots,
    [1.0, MAX_KNOTS as f64],
    "knots of the horizon: fewer take less time in a tick, and see less of a corner ahead",
);
pub(super) const PLAN_PERIOD_S: Parameter = Parameter::number(
    "feed_period_s",
    0.003,
    [1e-3, 0.012],
    None,
    "time between decisions: 2 ms is worse on a soft ball screw, 5 ms at every reversal",
);

/// Model-predictive contouring.
#[derive(Debug, Clone)]
pub(crate) struct ModelPredictive<const N: usize> {
    settings: Settings<N>,
    /// The model at rest at the origin.
    rest: Exact<N>,
    model: Exact<N>,
    residuals: [Residual; N],
    plan: OffsetPlan<N>,
    /// Expected tool position, mm, without and with the expected error of the model.
    expected_mm: Option<[[f64; N]; 2]>,
    prediction_error_mm: f64,
}

impl<const N: usize> ModelPredictive<N> {
    /// Creates the controller with the nominal model of a machine.
    pub(crate) fn new(known: &Known, settings: Settings<N>) -> Self {
        let rest = Exact::new(known, settings.servo_periods);
        Self {
            settings,
            model: rest.clone(),
            rest,
            residuals: [Residual::new(ResidualSettings::DEFAULT); N],
            plan: OffsetPlan::default(),
            expected_mm: None,
            prediction_error_mm: 0.0,
        }
    }

    /// The tool is where it is measured; its speed is the model's, which forgets its errors within
    /// the time constant of the speed loop.
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
                for (i, (axis, error_mm)) in self.model.axes.iter_mut().zip(error_mm).enumerate() {
                    axis.state.commands =
                        CommandQueue::resting(axis.state.commands.periods(), command_mm[i]);
                    axis.state.motor.angle_rad =
                        position_mm[i] * axis.axis_model.parameters.rad_per_mm;
                    axis.state.motor.error_rad = error_mm * axis.axis_model.parameters.rad_per_mm;
                }
            }
        }
        for (axis, position_mm) in self.model.axes.iter_mut().zip(position_mm) {
            axis.take_in(position_mm);
        }
    }
}

impl<const N: usize> Controller<N> for ModelPredictive<N> {
    fn schedule(&self) -> Schedule {
        deciding(
            self.settings.servo_periods,
            self.settings.horizon.knots as u32,
        )
    }

    fn reset(&mut self) {
        self.model.clone_from(&self.rest);
        self.residuals = [Residual::new(ResidualSettings::DEFAULT); N];
        self.plan.reset();
        self.expected_mm = None;
        self.prediction_error_mm = 0.0;
    }

    fn observe(&mut self, window: &Window<'_, N>, measured: Option<&Measured<N>>) {
        if let Some(measured) = measured {
            self.take_in(window, measured.position_mm);
        }
    }

    fn report(&self) -> SelfReport<N> {
        SelfReport {
            missed_mm: self.prediction_error_mm,
            ..SelfReport::CORRECTS
        }
    }

    fn command(&mut self, window: &Window<'_, N>, _: &Measured<N>) -> Command<N> {
        let settings = &self.settings.horizon;
        let mut model = self.model.clone();
        model.residual = self.residuals.each_ref().map(Residual::forecast);
        self.plan.shift(settings);
        let mut step = self.plan.improve(&model, window, settings);
        for _ in 1..MAX_STEPS {
            if step.change_mm_s2 <= CONVERGED_MM_S2 {
                break;
            }
            step = self.plan.improve(&model, window, settings);
        }
        let mut stretch = CommandedPeriod::now(window);
        stretch.go_on(window, step.acceleration_mm_s2);
        let expected_mm = model.advance(window, &stretch, &mut [[0.0; N]; MAX_KNOTS]);
        for (own, foreseen) in self.model.axes.iter_mut().zip(&model.axes) {
            own.state = foreseen.state;
        }
        self.expected_mm = Some([self.model.tool_mm(), expected_mm]);
        Command::accelerated(window, window.offset_mm_s, step.acceleration_mm_s2)
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
    response_s: f64,
}

impl<const N: usize> Exact<N> {
    fn new(known: &Known, servo_periods: u32) -> Self {
        let axis_models: [AxisModel; N] = known.axis_model();
        let axes: [ExactAxis; N] = std::array::from_fn(|i| ExactAxis::new(axis_models[i]));
        let response_s: [f64; N] = axis_models.map(|axis_model| 1.0 / axis_model.parameters.kp_1_s);
        // What the drive feeds forward of the speed does not wait for an error.
        let lag_s =
            |i: usize| (1.0 - known.axis(i).nominal.velocity_feedforward).max(0.0) * response_s[i];
        let lag_s = (0..N).map(lag_s).sum::<f64>() / N as f64;
        Self {
            axes,
            servo_periods,
            servo_s: known.period.servo_s,
            residual: [Residual::new(ResidualSettings::DEFAULT).forecast(); N],
            prediction_error_mm: [0.0; N],
            lag_s,
            response_s: response_s.iter().sum::<f64>() / N as f64,
        }
    }

    fn tool_mm(&self) -> [f64; N] {
        std::array::from_fn(|i| {
            self.axes[i].state.motor.angle_rad / self.axes[i].axis_model.parameters.rad_per_mm
                + self.prediction_error_mm[i]
        })
    }
}

impl<const N: usize> Predictor<N> for Exact<N> {
    fn lag_s(&self) -> f64 {
        self.lag_s
    }

    fn response_s(&self) -> f64 {
        self.response_s
    }

    fn advance(
        &mut self,
        window: &Window<'_, N>,
        stretch: &CommandedPeriod<N>,
        sensitivity: &mut Sensitivity<N>,
    ) -> [f64; N] {
        let offset = Command {
            bend_mm: stretch.bend_mm(),
            ..Command::straight(1.0, stretch.offset_mm[1])
        };
        for phase in 0..self.servo_periods {
            let ahead = stretch.period as u32 * self.servo_periods + phase;
            let path_mm = window.at(f64::from(ahead) * self.servo_s).position_mm;
            let part = f64::from(phase) / f64::from(self.servo_periods);
            let offset_mm = offset.offset_after_mm(part, stretch.offset_mm[0]);
            let moved_s2 = std::array::from_fn(|knot| stretch.moved_s2(knot, part));
            for (i, axis) in self.axes.iter_mut().enumerate() {
                axis.advance(path_mm[i] + offset_mm[i], &moved_s2, stretch.period);
            }
        }
        for i in 0..N {
            self.prediction_error_mm[i] += self.residual[i].next_mm();
            for knot in 0..=stretch.period {
                sensitivity[knot][i] = self.axes[i].slopes[knot].motor.angle_rad
                    / self.axes[i].axis_model.parameters.rad_per_mm;
            }
        }
        self.tool_mm()
    }
}

/// Servo periods of references under way that are kept: 20 ms each way at 1 ms, the most of a
/// machine file, and some.
const KEPT_PERIODS: usize = 48;

/// State of an axis that advances: its motor, its drive, and references on their way, the newest
/// first.
#[derive(Debug, Clone, Copy)]
struct Moving {
    /// Commands on their way to the position loop, mm.
    commands: CommandQueue,
    motor: AxisState,
    drive: DriveState,
    sent: [DriveReference; KEPT_PERIODS],
    presliding_nm: f64,
}

impl Moving {
    /// Starts at rest at zero, with commands that are late by `command_periods` servo periods.
    fn at_rest(command_periods: usize) -> Self {
        Self {
            commands: CommandQueue::resting(command_periods, 0.0),
            motor: AxisState::default(),
            drive: DriveState::AT_REST,
            sent: [DriveReference::default(); KEPT_PERIODS],
            presliding_nm: 0.0,
        }
    }
}

/// An axis: its state, and the derivative of that to the acceleration of each knot, per mm/s^2.
#[derive(Debug, Clone)]
struct ExactAxis {
    axis_model: AxisModel,
    drive: DriveModel,
    friction: Option<FrictionModel>,
    /// The same without limits, for the derivative.
    linear: (AxisModel, DriveModel),
    /// Integral of the speed loop for a position that was missed, N m/rad.
    integral_nm_rad: f64,
    /// Mechanics periods until a reference acts on what is measured.
    late: u32,
    state: Moving,
    slopes: [Moving; MAX_KNOTS],
}

impl ExactAxis {
    fn new(axis_model: AxisModel) -> Self {
        let parameters = axis_model.parameters;
        let linear = axis_model.with(|axis| {
            (axis.torque_limit_nm, axis.speed_limit_rad_s) = (f64::INFINITY, 0.0);
        });
        let time_s = parameters.speed_integral_s;
        let longest = (KEPT_PERIODS as u32 - 2) * axis_model.periods.mechanics_per_servo;
        let late = (parameters.drive_delay_s + parameters.measurement_delay_s)
            / axis_model.periods.mechanics_s;
        let at_rest = Moving::at_rest(parameters.command_periods(axis_model.periods.servo_s));
        Self {
            drive: DriveModel::new(&axis_model),
            friction: FrictionModel::if_present(&axis_model),
            linear: (linear, DriveModel::new(&linear)),
            integral_nm_rad: if time_s > 0.0 {
                axis_model.parameters.kv_nm_s_per_rad / time_s
            } else {
                0.0
            },
            // A float that is not a number saturates to zero here.
            late: (late.round() as u32).min(longest),
            axis_model,
            state: at_rest,
            slopes: [at_rest; MAX_KNOTS],
        }
    }

    /// The motor is where it is measured; the integral of its speed loop has summed up what was
    /// missed.
    fn take_in(&mut self, position_mm: f64) {
        let angle_rad = position_mm * self.axis_model.parameters.rad_per_mm;
        let missed_rad = angle_rad - self.state.motor.angle_rad;
        self.state.motor.angle_rad = angle_rad;
        self.state
            .drive
            .correct(-self.integral_nm_rad * missed_rad, 0.0);
    }

    /// One servo period at a command that moves by `moved_s2` mm for an acceleration of 1 mm/s^2 in
    /// each of the knots up to `knot`.
    fn advance(&mut self, command_mm: f64, moved_s2: &[f64; MAX_KNOTS], knot: usize) {
        let rad_per_mm = self.axis_model.parameters.rad_per_mm;
        let send =
            |axis_model: &AxisModel, drive: &DriveModel, moved_mm: f64, state: &mut Moving| {
                let moved_mm = state.commands.pass(moved_mm);
                let position_rad = state.motor.angle_rad;
                let reference = drive.position_loop(
                    axis_model,
                    moved_mm * rad_per_mm,
                    position_rad,
                    &mut state.motor,
                    &mut state.drive,
                );
                state.sent.rotate_right(1);
                state.sent[0] = reference;
            };
        send(&self.axis_model, &self.drive, command_mm, &mut self.state);
        let (linear, linear_drive) = &self.linear;
        for (slope, moved_s2) in self.slopes.iter_mut().zip(moved_s2).take(knot + 1) {
            send(linear, linear_drive, *moved_s2, slope);
        }
        for substep in 0..self.axis_model.periods.mechanics_per_servo {
            self.substep(self.age(substep), knot);
        }
    }

    /// Returns the age, in servo periods, of the reference that acts in a mechanics period of this
    /// servo period.
    fn age(&self, substep: u32) -> usize {
        let per_servo = self.axis_model.periods.mechanics_per_servo;
        (self.late.saturating_sub(substep)).div_ceil(per_servo) as usize
    }

    fn substep(&mut self, age: usize, knot: usize) {
        let (axis_model, state) = (&self.axis_model, &mut self.state);
        let w = state.motor.speed_rad_s;
        let torque_nm = self
            .drive
            .torque_nm(axis_model, state.sent[age], w, &mut state.drive);
        let coulomb = match &self.friction {
            Some(friction) => {
                let inverse_inertia = 1.0 / axis_model.parameters.inertia_kg_m2;
                state.motor.speed_rad_s = friction.speed_after_rad_s(
                    torque_nm,
                    inverse_inertia,
                    w,
                    &mut state.presliding_nm,
                );
                state.motor.angle_rad += axis_model.periods.mechanics_s * state.motor.speed_rad_s;
                0.0
            }
            None => {
                let [sign] = friction_signs(&[*axis_model], [w]);
                axis_model.accelerate(
                    torque_nm - axis_model.friction_nm(w, sign),
                    &mut state.motor,
                );
                sign
            }
        };
        // The Coulomb slope of a friction model with presliding is taken as in sliding: zero.
        let sign = if self.friction.is_some() {
            1.0
        } else {
            coulomb
        };
        let [gain, damping] = axis_model.slopes_nm_s(torque_nm, sign);
        let (linear, linear_drive) = &self.linear;
        for slope in self.slopes.iter_mut().take(knot + 1) {
            let w = slope.motor.speed_rad_s;
            let held_nm_s = damping - gain;
            let torque_nm = if gain > 0.0 {
                linear_drive.torque_nm(linear, slope.sent[age], w, &mut slope.drive)
            } else {
                0.0
            };
            linear.accelerate(torque_nm - held_nm_s * w, &mut slope.motor);
        }
    }
}
