//! One servo period between the command of a control and the drive.
//!
//! ```text
//! drive    = c(n - D) + o             command D servo periods late, plus the correction offset
//! feedback = c(n) + (a - c(n - D))    actual position a as the control gets it: the control sees
//!                                     the following error of the drive
//! ```
//!
//! The delay gives the correction its look-ahead. It starts and ends only after the command has
//! rested for longer than the delay. The path ahead and behind is then one point, and nothing
//! leaps. There is no delay while the control jogs, homes, probes or follows a spindle, without a
//! model, or while the amplifier is off. With the amplifier off, drive and control get the actual
//! position.
//!
//! Within a program, a probing motion begins sooner behind a cut than the delay. The link then asks
//! the control to hold its feed ([`LinkOutputs::holds_feed`]) until the delay is given up, and
//! again behind it until the delay is taken up. A motion that follows a spindle takes no hold: it
//! has to wait for [`LinkOutputs::is_settled`].
//!
//! Once the same cause has taken the correction out of the loop twice, it stays out until it is
//! switched off and on again, or the amplifiers were off: `latch.rs`.
//!
//! | Link | Drive gets |
//! |---|---|
//! | [`Link::Off`] | the actual position |
//! | [`Link::Direct`] | the command, plus the remainder of an offset while it fades |
//! | [`Link::Delayed`] | the delayed command, plus the offset that the supervisor passes |

use feedwright_control::vector::{add_scaled, bounded, norm, sub};
use feedwright_control::{
    AnyController, Bounds, Cause, Fade, OffsetBounds, Schedule, State, Tick, TrainedModel,
    Uncorrected,
};

use crate::fading::Fading;
use crate::history::{Delayed, History, NEWER};
use crate::latch::Latch;
use crate::limits::{LinkLimits, Setting};
use crate::machine::{Refused, fits, live_controller, member_of};
use crate::through::{PassedThrough, Through};

/// A spindle is followed until the command has rested for so long since its index was awaited, s:
/// it begins to move with the index.
const FOLLOWED_S: f64 = 0.5;
/// The delay is taken up behind a probing motion once the command has rested for longer than this,
/// s: five time constants of a usual position loop. After 0.013 s, an axis of `tnv40` that stopped
/// from 25 mm/s has 84 um to go, which the model takes for a wrong prediction.
const SETTLES_S: f64 = 0.1;
/// A command that still moves so long after its feed was to be held will not be held, s: braking
/// from 100 mm/s within 2,000 mm/s2.
const HELD_S: f64 = 0.05;
/// Servo period where there is no model, s; nothing but the time of rest depends on it.
const WITHOUT_MODEL_S: f64 = 0.001;

/// A command has leapt if it moves more in a servo period than this many times the travel at the
/// highest speed of the machine.
const LEAP: f64 = 2.0;
/// Servo periods of the longest delay.
const MOST_PERIODS: u64 = 128;

/// A tick that is not used yet.
const AT_REST: Schedule = Schedule {
    servo_periods: 1,
    preview: 0,
};

/// Inputs from the control and the drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkInputs<const N: usize> {
    /// Command, mm.
    pub command_mm: [f64; N],
    /// Actual position, mm.
    pub actual_mm: [f64; N],
    /// Channels that pass through uncorrected.
    pub through: Through,
    /// True if the amplifiers are on.
    pub powered: bool,
    /// True if the correction is wanted.
    pub enabled: bool,
    /// True if no delay is wanted: jog, homing, or a request from outside.
    pub direct: bool,
    /// True if this motion probes.
    pub probing: bool,
    /// True if a motion is about to follow the spindle.
    pub spindle: bool,
    /// True if this motion cuts; a rapid does not.
    pub cutting: bool,
}

/// Connection of the drive to the command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Link {
    /// Drive not connected.
    Off,
    /// Connected without delay and correction.
    Direct,
    /// Connected with delay and correction.
    Delayed,
}

/// Why there is no correction, or was none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinkFault {
    /// No fault.
    None,
    /// The model.
    Model(Refused),
    /// The supervisor took it out of the loop.
    Faded(Cause),
    /// The command was not a number; the last that was one is held.
    Command,
    /// This number is out of its range; the last one that was not stays in force, and so does the
    /// correction.
    Setting(Setting),
    /// A motion that probes or follows a spindle is delayed: the control did not hold its feed, or
    /// did not wait.
    NotHeld,
}

/// Outputs to the drive and to the control, and the reported state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkOutputs<const N: usize> {
    /// Command of the drive, mm.
    pub drive_mm: [f64; N],
    /// Actual position reported to the control, mm.
    pub feedback_mm: [f64; N],
    /// Offset of the command from the path, mm.
    pub correction_mm: [f64; N],
    /// Channels that pass through uncorrected.
    pub through: PassedThrough,
    /// Contour error of the actual position, mm.
    pub contour_error_mm: f64,
    /// Contour error that the model predicts without the correction, mm.
    pub without_mm: f64,
    /// Feedrate that the control is asked for, as a multiple of its own.
    pub rate: f64,
    /// The same in the scale that is set, 0 to 1.
    pub adaptive_feed: f64,
    /// Connection of the drive to the command.
    pub link: Link,
    /// State of the correction, as the supervisor sees it.
    pub state: State,
    /// True if a limit holds the offset.
    pub saturated: bool,
    /// Why there is no correction now.
    pub fault: LinkFault,
    /// Last time that the supervisor took the correction out of the loop since the delay was taken
    /// up: time, cause and count.
    pub left: Option<Fade>,
    /// True if the correction stays out until it is reset, because the same cause took it out
    /// twice.
    pub latched: bool,
    /// True for each axis that is corrected by a model learned in motion.
    pub learned: [bool; N],
    /// Servo periods of delay.
    pub delay_periods: u32,
    /// True if the control is to hold its feed until the delay has been given up, or taken up.
    pub holds_feed: bool,
    /// True if a motion that follows a spindle would be without delay.
    pub is_settled: bool,
}

/// The link and its state.
#[derive(Debug, Clone)]
pub struct Servo<const N: usize> {
    servo_s: f64,
    history: History<N>,
    model: Result<TrainedModel<N>, Refused>,
    controller: AnyController<N>,
    tick: Tick<N>,
    link: Link,
    /// Servo periods of delay, and the number of the command at which the tick began.
    delay: u32,
    first: u64,
    /// Settings in force.
    limits: LinkLimits,
    /// Bound of the offset minus the deviation that is set: a change fades.
    excess: Fading<1>,
    /// Remaining offset that fades without a correction.
    residual: Fading<N>,
    /// True if the delay was given up for a motion that probes; then the servo periods in which the
    /// command has moved despite the requested hold.
    yielded: bool,
    not_held: u64,
    actual_mm: [f64; N],
    command_mm: [f64; N],
    drive_mm: [f64; N],
    through: Through,
    /// Size of the correction offset in the last servo period, mm.
    offset_mm: f64,
    /// True if the motion follows a spindle; then the servo periods since this was last requested.
    follows: bool,
    unasked: u64,
    /// True once the control has sent a valid command.
    heard: bool,
    /// Servo periods since the command leapt.
    since_leap: u64,
    latch: Latch<N>,
}

impl<const N: usize> Servo<N> {
    /// Creates the link with this model, or without a model.
    pub fn new(model: Result<TrainedModel<N>, Refused>) -> Self {
        let servo_s = model
            .as_ref()
            .map_or(WITHOUT_MODEL_S, |model| model.servo_s);
        let controller = match &model {
            Ok(model) => {
                let member = member_of(model.trained.kind(), LinkLimits::DEFAULT.speed_alone);
                live_controller(member, model, false, OffsetBounds::NONE)
            }
            Err(_) => AnyController::Uncorrected(Uncorrected),
        };
        Self {
            servo_s,
            history: History::EMPTY,
            model,
            controller,
            tick: Tick::new(servo_s, AT_REST, Bounds::new(0.0, 0.0, 0.0)),
            link: Link::Off,
            delay: 0,
            first: 0,
            limits: LinkLimits::DEFAULT,
            excess: Fading::NONE,
            residual: Fading::NONE,
            yielded: false,
            not_held: 0,
            actual_mm: [0.0; N],
            command_mm: [0.0; N],
            drive_mm: [0.0; N],
            through: Through::NONE,
            offset_mm: 0.0,
            follows: false,
            unasked: 0,
            heard: false,
            since_leap: u64::MAX,
            latch: Latch::OPEN,
        }
    }

    /// Checks the model against the servo period of the thread, `servo_s`, before the first step.
    /// Rejects a model for another servo period. Returns the fault of a rejected model, or no
    /// fault.
    pub fn runs_at(&mut self, servo_s: f64) -> LinkFault {
        if self.model.is_ok() && !fits(self.servo_s, servo_s) {
            self.model = Err(Refused::Period);
        }
        self.refused()
    }

    /// One servo period.
    pub fn step(&mut self, inputs: &LinkInputs<N>, limits: &LinkLimits) -> LinkOutputs<N> {
        let refused = self.take_over(limits);
        let is_heard = norm(inputs.command_mm).is_finite();
        let reported = self.through.receive(&inputs.through) && is_heard;
        if norm(inputs.actual_mm).is_finite() {
            self.actual_mm = inputs.actual_mm;
        }
        self.since_leap = self.since_leap.saturating_add(1);
        if is_heard {
            let step_mm = norm(sub(inputs.command_mm, self.command_mm));
            if self.heard && step_mm > LEAP * self.limits.speed_mm_s * self.servo_s {
                self.since_leap = 0;
            }
            (self.command_mm, self.heard) = (inputs.command_mm, true);
        }
        let mut outputs = if inputs.powered && self.heard {
            self.on(inputs, reported)
        } else {
            self.off(reported)
        };
        outputs.adaptive_feed = bounded(self.limits.adaptive_scale * outputs.rate, 0.0, 1.0);
        if !inputs.enabled {
            self.latch.reset();
        }
        let latched = self.latch.latched();
        outputs.latched = latched.is_some();
        if let (LinkFault::None, Some(cause)) = (outputs.fault, latched) {
            outputs.fault = LinkFault::Faded(cause);
        }
        // A fault of the correction has precedence over a refused setting.
        if let (LinkFault::None, Some(setting)) = (outputs.fault, refused) {
            outputs.fault = LinkFault::Setting(setting);
        }
        self.drive_mm = outputs.drive_mm;
        outputs
    }

    /// Takes over what is set. A deviation that changes is reached within the acceleration of a
    /// fade; a lower one from where the offset is.
    fn take_over(&mut self, limits: &LinkLimits) -> Option<Setting> {
        let (last_mm, before_mm) = (self.limits.deviation_mm, self.deviation_mm());
        let refused = self.limits.take_over(limits);
        let set_mm = self.limits.deviation_mm;
        let from_mm = if set_mm < last_mm {
            before_mm.min(self.offset_mm.max(set_mm))
        } else {
            before_mm
        };
        if self.link == Link::Delayed {
            self.excess
                .shift([(from_mm - set_mm) - (before_mm - last_mm)]);
        } else {
            self.excess = Fading::NONE;
        }
        self.excess.step(self.servo_s, self.limits.correction_mm_s2);
        refused
    }

    /// Returns the present bound of the offset, mm.
    fn deviation_mm(&self) -> f64 {
        let [excess_mm] = self.excess.value_mm();
        (self.limits.deviation_mm + excess_mm).max(0.0)
    }

    fn bounds(&self) -> Bounds<N> {
        let LinkLimits {
            speed_mm_s,
            correction_mm_s2: fade_mm_s2,
            engaged_mm_s2,
            ..
        } = self.limits;
        let engaged_mm_s2 = if engaged_mm_s2 == 0.0 {
            f64::INFINITY
        } else {
            engaged_mm_s2
        };
        Bounds {
            fade_mm_s2,
            engaged_mm_s2,
            ..Bounds::new(self.deviation_mm(), speed_mm_s, 0.0)
        }
    }

    fn on(&mut self, inputs: &LinkInputs<N>, reported: bool) -> LinkOutputs<N> {
        self.choose(inputs);
        self.history
            .push(self.command_mm, &self.through, inputs.cutting);
        self.residual
            .step(self.servo_s, self.limits.correction_mm_s2);
        let mut outputs = match self.link {
            Link::Delayed => self.delayed(inputs),
            Link::Off | Link::Direct => self.direct(),
        };
        self.hold(inputs, &mut outputs);
        if !reported {
            outputs.fault = LinkFault::Command;
        }
        outputs
    }

    /// Requests that the control hold its feed, and checks that it does.
    fn hold(&mut self, inputs: &LinkInputs<N>, outputs: &mut LinkOutputs<N>) {
        let is_delayed = self.link == Link::Delayed;
        let rested = self.history.at_rest();
        outputs.is_settled = !is_delayed || rested > u64::from(self.delay) + NEWER;
        let gives_up = is_delayed && inputs.probing && !inputs.direct;
        let takes_up = self.link == Link::Direct
            && self.yielded
            && !(inputs.probing || inputs.direct || self.follows);
        outputs.holds_feed = gives_up || takes_up;
        self.not_held = if !outputs.holds_feed {
            0
        } else {
            self.not_held + u64::from(rested == 0)
        };
        let late = self.not_held as f64 * self.servo_s > HELD_S;
        // Without a hold there is no rest to take it up in.
        self.yielded &= !(takes_up && late);
        if (gives_up && late) || (is_delayed && self.follows && rested == 0) {
            outputs.fault = LinkFault::NotHeld;
        }
    }

    /// Handles amplifiers that are off: drive and control get the actual position.
    fn off(&mut self, reported: bool) -> LinkOutputs<N> {
        self.link = Link::Off;
        self.history.clear();
        self.residual = Fading::NONE;
        (self.follows, self.yielded, self.not_held) = (false, false, 0);
        self.latch.take_in(None, [false; N], 0.0);
        self.latch.reset();
        self.controller.forget_machine();
        let fault = if reported || !self.heard {
            self.refused()
        } else {
            LinkFault::Command
        };
        let through = self.through.off();
        LinkOutputs {
            drive_mm: self.actual_mm,
            feedback_mm: self.actual_mm,
            through,
            fault,
            ..self.nothing()
        }
    }

    /// Takes the delay up or gives it up, where that can be.
    fn choose(&mut self, inputs: &LinkInputs<N>) {
        let rested = self.history.at_rest();
        self.unasked = if inputs.spindle {
            0
        } else {
            self.unasked.saturating_add(1)
        };
        self.follows = inputs.spindle
            || (self.follows && (rested.min(self.unasked) as f64) * self.servo_s < FOLLOWED_S);
        let is_direct = inputs.direct || inputs.probing || self.follows || self.model.is_err();
        match (
            self.link,
            if is_direct {
                Link::Direct
            } else {
                Link::Delayed
            },
        ) {
            // What was commanded before is not the past of this motion.
            (Link::Off, _) => {
                self.link = Link::Direct;
                self.history.clear();
            }
            (Link::Direct, Link::Delayed) if rested > self.rest_to_take_up() => self.take_up(),
            (Link::Delayed, Link::Direct) if rested > u64::from(self.delay) + NEWER => {
                let path_mm = self.history.position_mm(self.history.newest());
                self.residual = Fading::from_rest(sub(self.drive_mm, path_mm));
                self.link = Link::Direct;
                self.yielded = inputs.probing;
            }
            _ => {}
        }
    }

    /// Servo periods of rest before the delay is taken up.
    fn rest_to_take_up(&self) -> u64 {
        let settles = if self.yielded {
            libm::round(SETTLES_S / self.servo_s) as u64
        } else {
            0
        };
        (self.periods() + NEWER).max(settles)
    }

    /// Servo periods in the delay that is set, and no fewer than the controller looks ahead. A
    /// controller that acts at once needs one period, and uses more if they are known.
    fn periods(&self) -> u64 {
        let Schedule {
            servo_periods,
            preview,
        } = self.controller.schedule();
        let looks_ahead = if self.controller.report().acts_at_once {
            1
        } else {
            u64::from(servo_periods) * u64::from(preview)
        };
        (libm::round(self.limits.delay_s / self.servo_s) as u64)
            .max(looks_ahead + NEWER + 1)
            .min(MOST_PERIODS)
    }

    fn take_up(&mut self) {
        let (delay, bounds) = (self.periods(), self.bounds());
        // The command that is pushed next is the newest; the preview looks a knot further than it
        // is asked to.
        let ahead = (delay - NEWER - 1) as u32;
        if let Ok(model) = &self.model {
            let member = member_of(model.trained.kind(), self.limits.speed_alone);
            if member != self.controller.member() {
                self.controller = live_controller(member, model, false, OffsetBounds::NONE);
            }
        }
        let mut schedule = self.controller.schedule();
        if self.controller.report().acts_at_once {
            schedule.preview = ahead;
        }
        self.tick = Tick::new(self.servo_s, schedule, bounds).planned_elsewhere();
        self.delay = delay as u32;
        self.first = (self.history.newest() + 1).saturating_sub(delay);
        (self.link, self.yielded, self.offset_mm) = (Link::Delayed, false, 0.0);
    }

    /// Returns the reason why the model was rejected, or no fault.
    fn refused(&self) -> LinkFault {
        self.model
            .as_ref()
            .err()
            .map_or(LinkFault::None, |refused| LinkFault::Model(*refused))
    }

    /// No correction.
    fn nothing(&self) -> LinkOutputs<N> {
        LinkOutputs {
            drive_mm: self.command_mm,
            feedback_mm: self.actual_mm,
            correction_mm: [0.0; N],
            through: self.through.passed(None, [0.0; N]),
            contour_error_mm: 0.0,
            without_mm: 0.0,
            rate: 1.0,
            adaptive_feed: 1.0,
            link: self.link,
            state: State::Shadow,
            saturated: false,
            fault: LinkFault::None,
            left: None,
            latched: false,
            learned: [false; N],
            delay_periods: 0,
            holds_feed: false,
            is_settled: true,
        }
    }

    fn direct(&mut self) -> LinkOutputs<N> {
        let fault = self.refused();
        self.latch.take_in(None, [false; N], 0.0);
        self.controller.reset();
        let correction_mm = self.residual.value_mm();
        LinkOutputs {
            drive_mm: add_scaled(self.command_mm, 1.0, correction_mm),
            feedback_mm: self.actual_mm,
            correction_mm,
            through: self.through.passed(None, correction_mm),
            link: Link::Direct,
            fault,
            ..self.nothing()
        }
    }

    fn delayed(&mut self, inputs: &LinkInputs<N>) -> LinkOutputs<N> {
        let bounds = self.bounds();
        self.controller.hold_to(OffsetBounds {
            largest_mm: bounds.deviation_mm,
            fastest_mm_s: bounds.speed_mm_s,
            ..OffsetBounds::NONE
        });
        self.tick.hold_to(bounds);
        self.tick
            .allow(inputs.enabled && self.latch.latched().is_none());
        // Reset until no part of the leap is ahead any more. The response to a leap that no machine
        // can follow says nothing about the model.
        if self.since_leap <= u64::from(self.delay) {
            self.controller.reset();
            self.tick.take_back_rate();
        }
        let mut path = Delayed {
            history: &self.history,
            first: self.first,
            servo_s: self.servo_s,
        };
        let setpoint = self
            .tick
            .step(&mut path, &mut *self.controller, inputs.actual_mm);
        let path_mm = setpoint.path.position_mm;
        let offset_mm = sub(setpoint.command_mm, path_mm);
        self.offset_mm = norm(offset_mm);
        let (state, left) = (self.tick.state(), self.tick.fade());
        let holds = state == State::Engaged && setpoint.path.feed_mm_s > 0.0;
        self.latch.take_in(
            left,
            self.tick.learned(),
            if holds { self.servo_s } else { 0.0 },
        );
        let correction_mm = add_scaled(offset_mm, 1.0, self.residual.value_mm());
        let before = self
            .history
            .through(self.history.newest().saturating_sub(u64::from(self.delay)));
        let is_out = inputs.enabled && state != State::Engaged;
        let cause = left.filter(|_| is_out).map(|left| left.cause);
        LinkOutputs {
            drive_mm: add_scaled(setpoint.command_mm, 1.0, self.residual.value_mm()),
            feedback_mm: add_scaled(self.command_mm, 1.0, sub(self.actual_mm, path_mm)),
            correction_mm,
            through: self.through.passed(Some(before), correction_mm),
            contour_error_mm: known(norm(self.tick.contour().vector_mm)),
            without_mm: known(self.tick.without_mm()),
            rate: if state == State::Engaged {
                self.tick.requested_rate()
            } else {
                1.0
            },
            adaptive_feed: 1.0,
            link: Link::Delayed,
            state,
            saturated: self.tick.held(),
            fault: cause.map_or(LinkFault::None, LinkFault::Faded),
            left,
            latched: false,
            learned: self.tick.learned(),
            delay_periods: self.delay,
            holds_feed: false,
            is_settled: false,
        }
    }
}

/// A length, or none where the actual position was lost.
fn known(mm: f64) -> f64 {
    if mm.is_finite() { mm } else { 0.0 }
}
