//! The tick: from the reference and a measurement to the position command of one servo period.
//!
//! The same code runs around a simulated plant and in a servo thread. Once a feed period the controller observes and
//! decides, under the safety layer; in every servo period the command moves on along the path and between the two offsets.

use crate::contour_error::{ContourError, Estimator};
use crate::controller::{Command, Controller, Measured, Schedule};
use crate::safety::feedback::Feedback;
use crate::safety::{Bounds, Fade, Guard, State};
use crate::vector::add_scaled;
use crate::window::{Knot, KnotSource, Preview, Register, Window};

/// The command of one servo period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setpoint<const N: usize> {
    /// Plan time of the reference, s.
    pub tau_s: f64,
    /// Point of the programmed path.
    pub path: Knot<N>,
    /// Position command, mm.
    pub command_mm: [f64; N],
    /// Whether the controller decided in this servo period.
    pub decided: bool,
}

/// Plan time in servo periods: whole ones and a part of one. At the planned feed it is a whole number, whatever its size; a sum
/// of seconds would be off by rounding after minutes, and then lead to the servo period before.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct PlanTime {
    periods: u64,
    part: f64,
}

impl PlanTime {
    /// So many servo periods later.
    #[inline]
    fn after(self, periods: f64) -> Self {
        let sum = self.part + periods;
        let whole = libm::floor(sum);
        // A float that is not a number saturates to zero here.
        Self { periods: self.periods + whole as u64, part: sum - whole }
    }

    #[inline]
    fn seconds(self, servo_s: f64) -> f64 {
        (self.periods as f64 + self.part) * servo_s
    }
}

/// The state between servo periods.
#[derive(Debug, Clone)]
pub struct Tick<const N: usize> {
    servo_s: f64,
    guard: Guard<N>,
    schedule: Schedule,
    register: Register<N>,
    feedback: Feedback<N>,
    estimator: Estimator,
    contour: ContourError<N>,
    preview: Preview<N>,
    /// Plan time and offset at the start of the feed period; rate and offset at its end.
    time: PlanTime,
    offset_from_mm: [f64; N],
    offset_from_mm_s: [f64; N],
    command: Command<N>,
    /// Servo periods since the start of the feed period.
    phase: u32,
}

impl<const N: usize> Tick<N> {
    /// At the start of a program, for a controller with this schedule and a servo period of `servo_s` seconds.
    pub fn new(servo_s: f64, schedule: Schedule, bounds: Bounds) -> Self {
        Self {
            servo_s,
            guard: Guard::new(bounds),
            schedule: Schedule { servo_periods: schedule.servo_periods.max(1), ..schedule },
            register: Register::default(),
            feedback: Feedback::NONE,
            estimator: Estimator::default(),
            contour: ContourError::NONE,
            preview: Preview::new(servo_s),
            time: PlanTime::default(),
            offset_from_mm: [0.0; N],
            offset_from_mm_s: [0.0; N],
            command: Command::AS_PLANNED,
            phase: 0,
        }
    }

    /// One servo period: the tool is at `tool_mm` at its start. Always the same work, but for the decision.
    #[inline]
    pub fn step<R, C>(&mut self, reference: &mut R, controller: &mut C, tool_mm: [f64; N]) -> Setpoint<N>
    where
        R: KnotSource<N> + ?Sized,
        C: Controller<N> + ?Sized,
    {
        if self.phase == self.schedule.servo_periods {
            self.time = self.time.after(f64::from(self.phase) * self.command.rate);
            self.offset_from_mm_s = self.command.offset_mm_s(self.offset_from_mm, self.feed_period_s());
            self.offset_from_mm = self.command.offset_mm;
            self.phase = 0;
        }
        let decided = self.phase == 0;
        let tau_s = self.time.after(f64::from(self.phase) * self.command.rate).seconds(self.servo_s);
        let path = reference.knot(tau_s).or_as(self.register.knot(0));
        self.register.push(path);
        self.preview.fill(reference, tau_s, f64::from(self.schedule.preview) * self.feed_period_s());
        let most_mm_s = self.guard.bounds().speed_mm_s;
        self.feedback.take_in(tool_mm, path.position_mm, self.servo_s, most_mm_s);
        if decided {
            self.decide(controller, tool_mm);
        }
        let part = f64::from(self.phase) / f64::from(self.schedule.servo_periods);
        let offset_mm = self.command.offset_after_mm(part, self.offset_from_mm);
        self.phase += 1;
        Setpoint { tau_s, path, command_mm: add_scaled(path.position_mm, 1.0, offset_mm), decided }
    }

    /// Plan time goes on by servo periods at rest that nobody computes; everything else stays.
    pub fn skip(&mut self, periods: u64) {
        self.time = PlanTime { periods: self.time.periods.saturating_add(periods), ..self.time };
    }

    /// The contour error at the last decision.
    pub fn contour(&self) -> &ContourError<N> {
        &self.contour
    }

    /// Whether the controller is in the loop.
    pub fn state(&self) -> State {
        self.guard.state()
    }

    /// When and why the safety layer took the controller out of the loop last.
    pub fn fade(&self) -> Option<Fade> {
        self.guard.fade()
    }

    fn decide<C: Controller<N> + ?Sized>(&mut self, controller: &mut C, tool_mm: [f64; N]) {
        let window = Window {
            register: &self.register,
            preview: &self.preview,
            tau_s: self.time.seconds(self.servo_s),
            feed_period_s: self.feed_period_s(),
            offset_mm: self.offset_from_mm,
            offset_mm_s: self.offset_from_mm_s,
        };
        self.contour = self.estimator.estimate(&window, tool_mm);
        let measured = Measured { position_mm: tool_mm, contour: self.contour };
        self.command = self.guard.decide(controller, &window, &measured, self.feedback.take_lost());
    }

    fn feed_period_s(&self) -> f64 {
        f64::from(self.schedule.servo_periods) * self.servo_s
    }
}
