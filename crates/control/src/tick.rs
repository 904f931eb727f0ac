//! The tick: from the reference and a measurement to the position command of one servo period.
//!
//! The same code runs around a simulated plant and in a servo thread. Once a feed period the
//! controller observes and decides, under the supervisor. In every servo period the command
//! advances along the path and between the two offsets.

use crate::command::{Command, Measured};
use crate::contour_error::{ContourError, Estimator};
use crate::controller::{Controller, Schedule};
use crate::supervisor::feedback::Feedback;
use crate::supervisor::{Bounds, Fade, State, Supervisor};
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
    /// True if the controller decided in this servo period.
    pub decided: bool,
}

/// Plan time in servo periods: whole ones and a part of one. At the planned feedrate it is a whole
/// number, whatever its size. A sum of seconds would be off by rounding after minutes, and then
/// lead to the servo period before.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct PlanTime {
    periods: u64,
    part: f64,
}

impl PlanTime {
    /// Returns the plan time `periods` servo periods later.
    #[inline]
    fn after(self, periods: f64) -> Self {
        let sum = self.part + periods;
        let whole = libm::floor(sum);
        // The cast saturates to zero where the float is NaN.
        Self {
            periods: self.periods + whole as u64,
            part: sum - whole,
        }
    }

    #[inline]
    fn seconds(self, servo_s: f64) -> f64 {
        (self.periods as f64 + self.part) * servo_s
    }
}

/// State between servo periods.
#[derive(Debug, Clone)]
pub struct Tick<const N: usize> {
    servo_s: f64,
    feed_period_s: f64,
    supervisor: Supervisor<N>,
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
    /// Last requested rate.
    requested_rate: f64,
    /// Servo periods by which the offset is ahead of the decision: 1 if it acts at once.
    ahead: u32,
    /// True for each axis that follows a learned model.
    learned: [bool; N],
    /// Servo periods since the start of the feed period.
    phase: u32,
    /// The last command, mm.
    command_mm: Option<[f64; N]>,
}

impl<const N: usize> Tick<N> {
    /// Creates the state at the start of a program, for a controller with this schedule and a servo
    /// period of `servo_s` seconds.
    pub fn new(servo_s: f64, schedule: Schedule, bounds: Bounds<N>) -> Self {
        let schedule = Schedule {
            servo_periods: schedule.servo_periods.max(1),
            ..schedule
        };
        Self {
            servo_s,
            feed_period_s: f64::from(schedule.servo_periods) * servo_s,
            supervisor: Supervisor::new(bounds),
            schedule,
            register: Register::default(),
            feedback: Feedback::NONE,
            estimator: Estimator::default(),
            contour: ContourError::NONE,
            preview: Preview::new(servo_s),
            time: PlanTime::default(),
            offset_from_mm: [0.0; N],
            offset_from_mm_s: [0.0; N],
            command: Command::AS_PLANNED,
            requested_rate: 1.0,
            ahead: 0,
            learned: [false; N],
            phase: 0,
            command_mm: None,
        }
    }

    /// Leaves the feedrate to another planner, such as the control's: the path goes on as it comes,
    /// and a rate is a request, see [`Self::requested_rate`].
    #[must_use]
    pub fn planned_elsewhere(mut self) -> Self {
        self.preview.is_planned_elsewhere = true;
        self
    }

    /// Returns the rate that the controller requested last, of a feedrate that is planned elsewhere.
    pub fn requested_rate(&self) -> f64 {
        self.requested_rate
    }

    /// Takes back the requested rate until the next decision.
    pub fn take_back_rate(&mut self) {
        self.requested_rate = 1.0;
    }

    /// Computes one servo period; the tool is at `tool_mm` at its start. The work is always the
    /// same, except for the decision.
    #[inline]
    pub fn step<R, C>(
        &mut self,
        reference: &mut R,
        controller: &mut C,
        tool_mm: [f64; N],
    ) -> Setpoint<N>
    where
        R: KnotSource<N> + ?Sized,
        C: Controller<N> + ?Sized,
    {
        if self.phase == self.schedule.servo_periods {
            self.time = self.time.after(f64::from(self.phase) * self.command.rate);
            self.offset_from_mm_s = self
                .command
                .offset_mm_s(self.offset_from_mm, self.feed_period_s);
            self.offset_from_mm = self.command.offset_mm;
            self.phase = 0;
        }
        let decided = self.phase == 0;
        let tau_s = self
            .time
            .after(f64::from(self.phase) * self.command.rate)
            .seconds(self.servo_s);
        let path = reference.knot(tau_s).or_as(self.register.knot(0));
        self.register.push(path);
        self.preview.fill(
            reference,
            tau_s,
            f64::from(self.schedule.preview) * self.feed_period_s,
        );
        let most_mm_s = self.supervisor.bounds().speed_mm_s;
        let last_mm = self.command_mm.unwrap_or(path.position_mm);
        self.feedback
            .take_in(tool_mm, last_mm, self.servo_s, most_mm_s);
        if decided {
            self.decide(controller, tool_mm);
        }
        let part = f64::from(self.phase + self.ahead) / f64::from(self.schedule.servo_periods);
        let offset_mm = self.command.offset_after_mm(part, self.offset_from_mm);
        self.phase += 1;
        let command_mm = add_scaled(path.position_mm, 1.0, offset_mm);
        self.command_mm = Some(command_mm);
        Setpoint {
            tau_s,
            path,
            command_mm,
            decided,
        }
    }

    /// Advances plan time by `periods` servo periods at rest without computing them. Nothing else
    /// changes.
    pub fn skip(&mut self, periods: u64) {
        self.time = PlanTime {
            periods: self.time.periods.saturating_add(periods),
            ..self.time
        };
    }

    /// Changes the bounds of the commands from the next decision on. The command reaches a smaller
    /// deviation within one step: the caller must not change it faster than the offset may move.
    pub fn hold_to(&mut self, bounds: Bounds<N>) {
        self.supervisor.hold_to(bounds);
    }

    /// Switches the correction on or off from the next decision on. When switched off it fades;
    /// when switched on again it returns as after a fault.
    pub fn allow(&mut self, allowed: bool) {
        self.supervisor.allow(allowed);
    }

    /// Returns true if the last command of an engaged controller was held to a bound.
    pub fn held(&self) -> bool {
        self.supervisor.held()
    }

    /// Returns the contour error at the last decision without the correction, by the controller's
    /// model, mm.
    pub fn without_mm(&self) -> f64 {
        self.supervisor.without_mm()
    }

    /// Returns the contour error at the last decision.
    pub fn contour(&self) -> &ContourError<N> {
        &self.contour
    }

    /// Returns the state of the controller: engaged, fading or in shadow.
    pub fn state(&self) -> State {
        self.supervisor.state()
    }

    /// Returns for each axis whether the controller followed a learned model at the last decision.
    pub fn learned(&self) -> [bool; N] {
        self.learned
    }

    /// Returns time and cause of the last disengagement by the supervisor.
    pub fn fade(&self) -> Option<Fade> {
        self.supervisor.fade()
    }

    fn decide<C: Controller<N> + ?Sized>(&mut self, controller: &mut C, tool_mm: [f64; N]) {
        let window = Window {
            register: &self.register,
            preview: &self.preview,
            tau_s: self.time.seconds(self.servo_s),
            feed_period_s: self.feed_period_s,
            offset_mm: self.offset_from_mm,
            offset_mm_s: self.offset_from_mm_s,
        };
        self.contour = self.estimator.estimate(&window, tool_mm);
        let measured = Measured {
            position_mm: tool_mm,
            contour: self.contour,
        };
        let lost = self.feedback.take_lost();
        controller.observe(&window, (!lost).then_some(&measured));
        let mut wanted = (!lost).then(|| controller.command(&window, &measured));
        if let Some(Command { rate, .. }) = &mut wanted
            && self.preview.is_planned_elsewhere
        {
            // A rate that is not a number is left to the supervisor.
            let is_number = rate.is_finite();
            self.requested_rate = if is_number { *rate } else { 1.0 };
            *rate = if is_number { 1.0 } else { *rate };
        }
        let report = controller.report();
        self.ahead = u32::from(report.acts_at_once);
        self.learned = report.learned;
        self.command = self.supervisor.decide(&window, &measured, wanted, &report);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::tests::Line;

    #[test]
    fn plan_time_is_a_whole_number_of_servo_periods_whatever_its_size() {
        let mut time = PlanTime::default();
        for _ in 0..1_000_000 {
            time = time.after(3.0);
        }
        assert_eq!((time.periods, time.part), (3_000_000, 0.0));
        assert_eq!(
            time.seconds(0.001).to_bits(),
            (3_000_000.0 * 0.001_f64).to_bits()
        );
    }

    #[test]
    fn parts_of_a_period_add_up_and_what_is_no_number_stands_still() {
        let mut time = PlanTime::default();
        (0..8).for_each(|_| time = time.after(0.375));
        assert_eq!((time.periods, time.part), (3, 0.0));
        assert_eq!(time.after(f64::NAN).periods, 3);
    }

    /// Every fifth servo period, an offset that grows by a micrometer.
    struct Growing(f64);

    impl Controller<2> for Growing {
        fn schedule(&self) -> Schedule {
            Schedule {
                servo_periods: 5,
                preview: 0,
            }
        }

        fn reset(&mut self) {
            self.0 = 0.0;
        }

        fn command(&mut self, _: &Window<'_, 2>, _: &Measured<2>) -> Command<2> {
            self.0 += 1e-3;
            Command::straight(1.0, [0.0, self.0])
        }
    }

    #[test]
    fn an_offset_is_reached_at_the_end_of_the_feed_period_in_which_it_was_decided() {
        let mut tick = Tick::new(
            0.001,
            Growing(0.0).schedule(),
            Bounds::new(1.0, 400.0, 1000.0),
        );
        let (mut controller, mut tool_mm) = (Growing(0.0), [0.0; 2]);
        for n in 0..50_u32 {
            let setpoint = tick.step(&mut Line, &mut controller, tool_mm);
            assert_eq!(setpoint.decided, n.is_multiple_of(5), "{n}");
            assert!(
                (setpoint.command_mm[0] - 0.05 * f64::from(n)).abs() < 1e-12,
                "{n}"
            );
            assert!(
                (setpoint.command_mm[1] - 2e-4 * f64::from(n)).abs() < 1e-12,
                "{n}: {:?}",
                setpoint.command_mm
            );
            tool_mm = setpoint.command_mm;
        }
    }
}
