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
//! | Link | Drive gets |
//! |---|---|
//! | [`Link::Off`] | the actual position |
//! | [`Link::Direct`] | the command, plus the remainder of an offset while it fades |
//! | [`Link::Delayed`] | the delayed command, plus the offset that the safety layer passes |

use feedwright_control::vector::{add_scaled, norm, scale, sub};
use feedwright_control::{Bounds, Cause, State};
use feedwright_control::{Schedule, Tick};

use crate::correction::Correction;
use crate::history::{Delayed, History, NEWER};
use crate::machine::{self, LinkModel, Refused};

/// Delays that can be set, s: below, the inverse of a drive that is late has nothing to look at; above, it sees no more that it needs.
pub const DELAYS_S: [f64; 2] = [0.008, 0.015];
/// Time constant with which a remaining offset decays when there is no correction, s. A fade of the
/// safety layer has the same one.
const RESIDUAL_S: f64 = 0.03;
/// A spindle is followed until the command has rested for so long since its index was awaited, s: it begins to move with the index.
const FOLLOWED_S: f64 = 0.5;
/// What stands for no limit of the correction's acceleration, mm/s2: a leap within a servo period of 1 ms at the speed of a rapid.
const UNLIMITED_MM_S2: f64 = 1e6;
/// Servo period where there is no model, s; nothing but the time of rest depends on it.
const WITHOUT_MODEL_S: f64 = 0.001;
/// An offset nearer to what was asked for is that, mm.
const SAME_MM: f64 = 1e-9;

/// A command has leapt if it moves more in a servo period than this many times the travel at the
/// highest speed of the machine.
const LEAP: f64 = 2.0;
/// Servo periods of the longest delay.
const MOST_PERIODS: u64 = 128;

/// A tick that is not used yet.
const AT_REST: Schedule = Schedule { servo_periods: 1, preview: 0 };

/// What comes from the control and the drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkInputs<const N: usize> {
    /// Command, mm.
    pub command_mm: [f64; N],
    /// Actual position, mm.
    pub actual_mm: [f64; N],
    /// Whether the amplifiers are on.
    pub powered: bool,
    /// Whether the correction is wanted.
    pub enabled: bool,
    /// Whether no delay is wanted: jog, homing, probing, or asked for from outside.
    pub direct: bool,
    /// Whether the spindle is about to be followed.
    pub spindle: bool,
    /// Whether this motion cuts; a rapid does not.
    pub cutting: bool,
}

/// What can be set. All but [`Self::delay_s`] is taken over where the delay is taken up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkLimits {
    /// Delay of the command, s.
    pub delay_s: f64,
    /// Distance of the command from the path, mm.
    pub deviation_mm: f64,
    /// Highest speed of the machine and of the offset, mm/s.
    pub speed_mm_s: f64,
    /// Acceleration with which an offset fades, mm/s2; 0 is without limit.
    pub correction_mm_s2: f64,
    /// Whether a controller that changes the feedrate leaves the geometry on the path.
    pub speed_alone: bool,
}

/// How the drive is connected to the command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Link {
    /// Not at all.
    Off,
    /// Without delay and correction.
    Direct,
    /// With both.
    Delayed,
}

/// Why there is no correction, or was none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LinkFault {
    /// No fault.
    None,
    /// The model.
    Model(Refused),
    /// The safety layer took it out of the loop.
    Faded(Cause),
    /// The machine does not move as the model says: the law has not proven itself.
    Unproven,
    /// The command was not a number; the last that was one is held.
    Command,
}

/// What goes to the drive and to the control, and what is told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkOutputs<const N: usize> {
    /// Command of the drive, mm.
    pub drive_mm: [f64; N],
    /// What the control takes for the actual position, mm.
    pub feedback_mm: [f64; N],
    /// Offset of the command from the path, mm.
    pub correction_mm: [f64; N],
    /// Contour error of the actual position, mm.
    pub contour_error_mm: f64,
    /// What it would be without the correction, by the model, mm.
    pub without_mm: f64,
    /// Feedrate that the control is asked for, as a multiple of its own.
    pub rate: f64,
    /// How the drive is connected.
    pub link: Link,
    /// Whether the correction is in the loop, as the safety layer sees it.
    pub state: State,
    /// Whether a limit holds the offset.
    pub saturated: bool,
    /// Why there is no correction now.
    pub fault: LinkFault,
    /// Servo periods of delay.
    pub delay_periods: u32,
}

/// The link and its state.
#[derive(Debug, Clone)]
pub struct Servo<const N: usize> {
    servo_s: f64,
    history: History<N>,
    correction: Result<Correction<N>, Refused>,
    tick: Tick<N>,
    link: Link,
    /// Servo periods of delay, and the number of the command at which the tick began.
    delay: u32,
    first: u64,
    /// Remaining offset that decays without a correction, mm.
    residual_mm: [f64; N],
    actual_mm: [f64; N],
    command_mm: [f64; N],
    drive_mm: [f64; N],
    /// Whether the motion follows a spindle, and servo periods since it was about to.
    follows: bool,
    unasked: u64,
    /// Whether the control was heard at all.
    heard: bool,
    /// Servo periods since the command leapt.
    since_leap: u64,
}

impl<const N: usize> Servo<N> {
    /// By this model, or without one.
    pub fn new(model: Result<LinkModel<N>, Refused>) -> Self {
        let servo_s = model.as_ref().map_or(WITHOUT_MODEL_S, LinkModel::servo_s);
        let correction = model.map(|model| Correction::new(&model, servo_s));
        Self {
            servo_s,
            history: History::EMPTY,
            correction,
            tick: Tick::new(servo_s, AT_REST, Bounds::new(0.0, 0.0, 0.0)),
            link: Link::Off,
            delay: 0,
            first: 0,
            residual_mm: [0.0; N],
            actual_mm: [0.0; N],
            command_mm: [0.0; N],
            drive_mm: [0.0; N],
            follows: false,
            unasked: 0,
            heard: false,
            since_leap: u64::MAX,
        }
    }

    /// Checks the model against the servo period of the thread, `servo_s`, before the first step.
    /// Rejects a model for another servo period. Returns the fault of a rejected model, or no
    /// fault.
    pub fn runs_at(&mut self, servo_s: f64) -> LinkFault {
        if self.correction.is_ok() && !machine::fits(self.servo_s, servo_s) {
            self.correction = Err(Refused::Period);
        }
        self.refused()
    }

    /// One servo period.
    pub fn step(&mut self, inputs: &LinkInputs<N>, limits: &LinkLimits) -> LinkOutputs<N> {
        let told = norm(inputs.command_mm).is_finite();
        if norm(inputs.actual_mm).is_finite() {
            self.actual_mm = inputs.actual_mm;
        }
        self.since_leap = self.since_leap.saturating_add(1);
        if told {
            let step_mm = norm(sub(inputs.command_mm, self.command_mm));
            if self.heard && step_mm > LEAP * limits.speed_mm_s * self.servo_s {
                self.since_leap = 0;
            }
            (self.command_mm, self.heard) = (inputs.command_mm, true);
        }
        let outputs = if inputs.powered && self.heard { self.on(inputs, limits, told) } else { self.off(told) };
        self.drive_mm = outputs.drive_mm;
        outputs
    }

    fn on(&mut self, inputs: &LinkInputs<N>, limits: &LinkLimits, told: bool) -> LinkOutputs<N> {
        self.choose(inputs, limits);
        self.history.push(self.command_mm, inputs.cutting);
        let decay = (self.servo_s / RESIDUAL_S).min(1.0);
        self.residual_mm = scale(1.0 - decay, self.residual_mm);
        let mut outputs = match self.link {
            Link::Delayed => self.delayed(inputs),
            Link::Off | Link::Direct => self.direct(),
        };
        if !told {
            outputs.fault = LinkFault::Command;
        }
        outputs
    }

    /// The amplifier is off: the drive is told to be where it is, and so is the control.
    fn off(&mut self, told: bool) -> LinkOutputs<N> {
        self.link = Link::Off;
        self.history.clear();
        self.residual_mm = [0.0; N];
        self.follows = false;
        if let Ok(correction) = &mut self.correction {
            correction.restart();
            correction.forgive();
        }
        let fault = if told || !self.heard { self.refused() } else { LinkFault::Command };
        LinkOutputs { drive_mm: self.actual_mm, feedback_mm: self.actual_mm, fault, ..self.nothing() }
    }

    /// Takes the delay up or gives it up, where that can be.
    fn choose(&mut self, inputs: &LinkInputs<N>, limits: &LinkLimits) {
        let rested = self.history.at_rest();
        self.unasked = if inputs.spindle { 0 } else { self.unasked.saturating_add(1) };
        self.follows =
            inputs.spindle || (self.follows && (rested.min(self.unasked) as f64) * self.servo_s < FOLLOWED_S);
        let wanted =
            if inputs.direct || self.follows || self.correction.is_err() { Link::Direct } else { Link::Delayed };
        match (self.link, wanted) {
            // What was commanded before is not the past of this motion.
            (Link::Off, _) => {
                self.link = Link::Direct;
                self.history.clear();
            }
            (Link::Direct, Link::Delayed) if rested > self.periods(limits.delay_s) + NEWER => self.take_up(limits),
            (Link::Delayed, Link::Direct) if rested > u64::from(self.delay) + NEWER => {
                self.residual_mm = sub(self.drive_mm, self.history.position_mm(self.history.newest()));
                self.link = Link::Direct;
            }
            _ => {}
        }
    }

    /// Servo periods in a delay within [`DELAYS_S`], and no fewer than the controller looks ahead.
    fn periods(&self, delay_s: f64) -> u64 {
        let [least_s, most_s] = DELAYS_S;
        // Not a number is the least.
        let delay_s = delay_s.max(least_s).min(most_s);
        let looks_ahead = self.correction.as_ref().map_or(0, Correction::looks_ahead);
        (libm::round(delay_s / self.servo_s) as u64).max(looks_ahead + NEWER + 1).min(MOST_PERIODS)
    }

    fn take_up(&mut self, limits: &LinkLimits) {
        let delay = self.periods(limits.delay_s);
        let bounds = Bounds {
            fade_mm_s2: if limits.correction_mm_s2 > 0.0 { limits.correction_mm_s2 } else { UNLIMITED_MM_S2 },
            ..Bounds::new(limits.deviation_mm, limits.speed_mm_s, 0.0)
        };
        // The command that is pushed next is the newest; the preview looks a knot further than it is asked to.
        let ahead = (delay - NEWER - 1) as u32;
        let schedule = match &mut self.correction {
            Ok(correction) => {
                correction.hold_to(&bounds, limits.speed_alone);
                correction.schedule_within(ahead)
            }
            Err(_) => AT_REST,
        };
        self.tick = Tick::new(self.servo_s, schedule, bounds);
        self.delay = delay as u32;
        self.first = (self.history.newest() + 1).saturating_sub(delay);
        self.link = Link::Delayed;
    }

    /// That the model was refused, if it was.
    fn refused(&self) -> LinkFault {
        self.correction.as_ref().err().map_or(LinkFault::None, |refused| LinkFault::Model(*refused))
    }

    /// No correction.
    fn nothing(&self) -> LinkOutputs<N> {
        LinkOutputs {
            drive_mm: self.command_mm,
            feedback_mm: self.actual_mm,
            correction_mm: [0.0; N],
            contour_error_mm: 0.0,
            without_mm: 0.0,
            rate: 1.0,
            link: self.link,
            state: State::Shadow,
            saturated: false,
            fault: LinkFault::None,
            delay_periods: 0,
        }
    }

    fn direct(&mut self) -> LinkOutputs<N> {
        let fault = self.refused();
        if let Ok(correction) = &mut self.correction {
            correction.restart();
        }
        let drive_mm = add_scaled(self.command_mm, 1.0, self.residual_mm);
        LinkOutputs {
            drive_mm,
            feedback_mm: self.actual_mm,
            correction_mm: self.residual_mm,
            link: Link::Direct,
            fault,
            ..self.nothing()
        }
    }

    fn delayed(&mut self, inputs: &LinkInputs<N>) -> LinkOutputs<N> {
        let Ok(correction) = &mut self.correction else { return self.direct() };
        // Until no part of it is ahead any more: what no machine can follow says nothing of the law.
        if self.since_leap <= u64::from(self.delay) {
            correction.restart();
        }
        correction.fade(inputs.enabled, self.tick.state() == State::Engaged, self.servo_s);
        let mut path = Delayed { history: &self.history, first: self.first, servo_s: self.servo_s };
        let setpoint = self.tick.step(&mut path, correction, inputs.actual_mm);
        let path_mm = setpoint.path.position_mm;
        let offset_mm = sub(setpoint.command_mm, path_mm);
        let state = self.tick.state();
        let held = norm(sub(correction.wanted_mm(), offset_mm)) > SAME_MM;
        let state = match state {
            State::Engaged if correction.is_out() && norm(offset_mm) > 0.0 => State::Fading,
            State::Engaged if correction.is_out() => State::Shadow,
            state => state,
        };
        let faded = self.tick.fade().filter(|_| self.tick.state() != State::Engaged).map(|fade| fade.cause);
        let faded = faded.or(correction.is_lost().then_some(Cause::Harmful));
        let fault = match faded {
            None | Some(Cause::WrongPredictions | Cause::Harmful) if correction.is_refuted() => LinkFault::Unproven,
            faded => faded.map_or(LinkFault::None, LinkFault::Faded),
        };
        LinkOutputs {
            drive_mm: add_scaled(setpoint.command_mm, 1.0, self.residual_mm),
            feedback_mm: add_scaled(self.command_mm, 1.0, sub(self.actual_mm, path_mm)),
            correction_mm: add_scaled(offset_mm, 1.0, self.residual_mm),
            contour_error_mm: known(norm(self.tick.contour().vector_mm)),
            without_mm: known(correction.without_mm()),
            rate: correction.rate(),
            link: Link::Delayed,
            state,
            saturated: held && state == State::Engaged,
            fault,
            delay_periods: self.delay,
        }
    }
}

/// A length, or none where the actual position was lost.
fn known(mm: f64) -> f64 {
    if mm.is_finite() { mm } else { 0.0 }
}
