//! The link between command and drive.

use feedwright_control::{BlockError, Cause, State};
use feedwright_servo::compensation::{Compensation, MachinePlace};
use feedwright_servo::limits::{LinkLimits, Setting};
use feedwright_servo::machine::{Refused, model_of};
use feedwright_servo::play_out::PlayOut;
use feedwright_servo::servo::{Link, LinkFault, LinkInputs, LinkOutputs, Servo};
use feedwright_servo::through::{Carries, Through};

use crate::memory::{TwoOrThree, first, model, put, three};

/// Flag: the amplifiers are on.
pub const FEEDWRIGHT_POWERED: u32 = 1;
/// Flag: the correction is wanted.
pub const FEEDWRIGHT_ENABLED: u32 = 2;
/// Flag: no delay is wanted.
pub const FEEDWRIGHT_DIRECT: u32 = 4;
/// Flag: a motion is about to follow the spindle.
pub const FEEDWRIGHT_SPINDLE: u32 = 8;
/// Flag: this motion cuts.
pub const FEEDWRIGHT_CUTTING: u32 = 16;
/// Flag: a controller that changes the feedrate leaves the geometry on the path.
pub const FEEDWRIGHT_SPEED_ALONE: u32 = 32;
/// Flag: this motion probes.
pub const FEEDWRIGHT_PROBING: u32 = 64;
/// Flag: the geometry that the model states is to be compensated.
pub const FEEDWRIGHT_GEOMETRY: u32 = 128;
/// Flag: every corrected joint is homed, so that its motor offset states its position.
pub const FEEDWRIGHT_HOMED: u32 = 256;
/// Largest number of channels that pass through.
pub const FEEDWRIGHT_CHANNELS: usize = 6;
/// Kind of value that a channel carries, in four bits of `carries` for each, the first channel in
/// the lowest: this value for a joint, this value plus 1 + n for a second motor of the corrected
/// joint n, 0 for a signal.
pub const FEEDWRIGHT_JOINT: u32 = 1;
/// Result of [`feedwright_servo_new`] if it created no link.
pub const FEEDWRIGHT_NOT_MADE: u32 = 255;
/// Fault of a link that failed. Only the caller detects the failure.
pub const FEEDWRIGHT_FAILED: u32 = 14;

/// Inputs from the control and the drives in a servo period.
#[repr(C)]
pub struct CInputs {
    /// Position commands.
    command_mm: [f64; 3],
    /// Actual positions.
    actual_mm: [f64; 3],
    /// Motor offsets: motor position minus joint position.
    offset_mm: [f64; 3],
    /// Delay of the command, 0.008 to 0.015. A setting out of its range is rejected; the last good
    /// one stays in force.
    delay_s: f64,
    /// Largest distance of the drive's command from the path.
    deviation_mm: f64,
    /// Highest speed of the machine.
    speed_mm_s: f64,
    /// Acceleration with which an offset fades; 0 is without limit.
    correction_mm_s2: f64,
    /// Acceleration of an offset in the loop; 0 is without limit. If a correction needs more, only
    /// a smaller part of it is commanded.
    engaged_mm_s2: f64,
    /// Value of `adaptive_feed` that stands for the present feedrate, 0.1 to 1.
    adaptive_scale: f64,
    /// Commands of the channels that are delayed and not corrected.
    through: [f64; FEEDWRIGHT_CHANNELS],
    /// Actual positions of these channels; the command of a signal.
    through_actual: [f64; FEEDWRIGHT_CHANNELS],
    /// Sum of the flags FEEDWRIGHT_POWERED and so on.
    flags: u32,
    /// Kinds of values that the channels carry.
    carries: u32,
}

/// Outputs to the drives and the control.
#[repr(C)]
pub struct COutputs {
    /// Position commands of the drives.
    drive_mm: [f64; 3],
    /// Actual positions reported to the control.
    feedback_mm: [f64; 3],
    /// Offsets of the drives' commands from the path.
    correction_mm: [f64; 3],
    /// Offsets of the joint commands from the commands of the control, due to the geometry.
    geometry_mm: [f64; 3],
    /// Drive commands of the channels that pass through, and their actual positions reported to the
    /// control.
    through_drive: [f64; FEEDWRIGHT_CHANNELS],
    through_feedback: [f64; FEEDWRIGHT_CHANNELS],
    /// Distance of the actual position from the path.
    contour_error_mm: f64,
    /// Contour error that the model predicts without the correction.
    without_mm: f64,
    /// Feedrate requested of the control, 0 to 1: multiple of its own feedrate, times
    /// `adaptive_scale`.
    adaptive_feed: f64,
    /// Measured error when the supervisor last took the correction out of the loop, and the largest
    /// permitted error; 0 if nothing was compared.
    found_mm: f64,
    limit_mm: f64,
    /// State: 0 amplifiers off, 1 without delay, 2 delayed, 3 the correction fades, 4 it is in the
    /// loop.
    state: u32,
    /// Reason why there is no correction, or 0; faults.h states it in words.
    fault: u32,
    /// 1 if a limit holds the correction.
    saturated: u32,
    /// Servo periods of delay.
    delay_periods: u32,
    /// 1 if the control is to hold its feed.
    holds_feed: u32,
    /// 1 if a motion that follows a spindle would be without delay.
    is_settled: u32,
    /// Number of times that the supervisor has taken the correction out of the loop since the delay
    /// was taken up.
    times_out: u32,
    /// Joints that are corrected by a model learned in motion: sum of 1, 2 and 4.
    learned: u32,
    /// 1 if the geometry is compensated and no part of it fades.
    compensates: u32,
    /// 1 if the correction stays out until it is reset.
    latched: u32,
}

/// The link between command and drives.
pub struct CServo(TwoOrThree<Guarded<2>, Guarded<3>>);

/// A link, and its replacement if it fails.
struct Guarded<const N: usize> {
    compensation: Compensation<N>,
    servo: Servo<N>,
    play_out: PlayOut<N>,
}

/// Returns the size of a link, bytes.
#[unsafe(no_mangle)]
pub extern "C" fn feedwright_servo_bytes() -> usize {
    size_of::<CServo>()
}

/// Returns the size of the inputs, shifted left by 16 bits, plus the size of the outputs, for the
/// caller to compare with its own.
#[unsafe(no_mangle)]
pub extern "C" fn feedwright_servo_layout() -> usize {
    size_of::<CInputs>() << 16 | size_of::<COutputs>()
}

/// Creates a link of two or three joints, with or without a model. Returns the fault that it begins
/// with, or [`FEEDWRIGHT_NOT_MADE`] if the memory is too small, not aligned or null.
///
/// # Safety
/// `memory` is null or points to `memory_bytes` bytes that nothing else uses. `bytes` is null or
/// points to `length` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn feedwright_servo_new(
    memory: *mut CServo,
    memory_bytes: usize,
    joints: u32,
    bytes: *const u8,
    length: usize,
) -> u32 {
    // SAFETY: as the caller promises.
    let bytes = unsafe { model(bytes, length) };
    let mut fault = 0;
    let make = || {
        CServo(if joints == 2 {
            TwoOrThree::Two(made(bytes, &mut fault))
        } else {
            TwoOrThree::Three(made(bytes, &mut fault))
        })
    };
    // SAFETY: as the caller promises.
    if unsafe { put(memory, memory_bytes, make) } {
        fault
    } else {
        FEEDWRIGHT_NOT_MADE
    }
}

fn made<const N: usize>(bytes: &[u8], fault: &mut u32) -> Guarded<N> {
    // A rejected model compensates nothing.
    let (model, geometry) = match model_of(bytes) {
        Ok(block) => (Ok(block.model), block.geometry),
        Err(refused) => (Err(refused), None),
    };
    *fault = model
        .as_ref()
        .err()
        .map_or(0, |refused| number(LinkFault::Model(*refused)));
    Guarded {
        compensation: Compensation::new(geometry),
        servo: Servo::new(model),
        play_out: PlayOut::new(),
    }
}

/// Checks the model against the servo period of the thread, before the first step. Returns the
/// fault of a rejected model, or 0.
///
/// # Safety
/// `servo` was made by [`feedwright_servo_new`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn feedwright_servo_runs_at(servo: &mut CServo, servo_s: f64) -> u32 {
    number(match &mut servo.0 {
        TwoOrThree::Two(guarded) => guarded.runs_at(servo_s),
        TwoOrThree::Three(guarded) => guarded.runs_at(servo_s),
    })
}

/// Computes one servo period of the link.
///
/// # Safety
/// `servo` was made by [`feedwright_servo_new`]. The other arguments are valid as declared.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn feedwright_servo_step(
    servo: &mut CServo,
    inputs: &CInputs,
    outputs: &mut COutputs,
) {
    *outputs = match &mut servo.0 {
        TwoOrThree::Two(guarded) => guarded.step(inputs),
        TwoOrThree::Three(guarded) => guarded.step(inputs),
    };
}

/// Computes one servo period in place of [`feedwright_servo_step`], once that has panicked: plays
/// out the delay of the link, without a correction.
///
/// # Safety
/// `servo` was made by [`feedwright_servo_new`]. The other arguments are valid as declared.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn feedwright_servo_play_out(
    servo: &mut CServo,
    inputs: &CInputs,
    outputs: &mut COutputs,
) {
    *outputs = match &mut servo.0 {
        TwoOrThree::Two(guarded) => guarded.play_out(inputs),
        TwoOrThree::Three(guarded) => guarded.play_out(inputs),
    };
}

impl CInputs {
    fn is(&self, flag: u32) -> bool {
        self.flags & flag != 0
    }

    fn limits(&self) -> LinkLimits {
        let CInputs {
            delay_s,
            deviation_mm,
            speed_mm_s,
            correction_mm_s2,
            engaged_mm_s2,
            adaptive_scale,
            ..
        } = *self;
        let speed_alone = self.is(FEEDWRIGHT_SPEED_ALONE);
        LinkLimits {
            delay_s,
            deviation_mm,
            speed_mm_s,
            correction_mm_s2,
            engaged_mm_s2,
            adaptive_scale,
            speed_alone,
        }
    }

    fn place<const N: usize>(&self) -> MachinePlace<N> {
        MachinePlace {
            zero_mm: first(self.offset_mm),
            is_known: self.is(FEEDWRIGHT_HOMED),
            is_wanted: self.is(FEEDWRIGHT_GEOMETRY),
        }
    }

    fn link<const N: usize>(&self) -> LinkInputs<N> {
        let carries = |i| match self.carries >> (4 * i as u32) & 15 {
            0 => Carries::Signal,
            FEEDWRIGHT_JOINT => Carries::Joint,
            more => Carries::Tandem((more - FEEDWRIGHT_JOINT - 1) as usize),
        };
        let (command, actual) = (self.through, self.through_actual);
        LinkInputs {
            command_mm: first(self.command_mm),
            actual_mm: first(self.actual_mm),
            through: Through {
                command,
                actual,
                carries: core::array::from_fn(carries),
            },
            powered: self.is(FEEDWRIGHT_POWERED),
            enabled: self.is(FEEDWRIGHT_ENABLED),
            direct: self.is(FEEDWRIGHT_DIRECT),
            probing: self.is(FEEDWRIGHT_PROBING),
            spindle: self.is(FEEDWRIGHT_SPINDLE),
            cutting: self.is(FEEDWRIGHT_CUTTING),
        }
    }
}

impl<const N: usize> Guarded<N> {
    fn runs_at(&mut self, servo_s: f64) -> LinkFault {
        self.compensation.runs_at(servo_s);
        self.play_out.runs_at(servo_s);
        let fault = self.servo.runs_at(servo_s);
        if fault != LinkFault::None {
            self.compensation.refuse();
        }
        fault
    }

    fn step(&mut self, inputs: &CInputs) -> COutputs {
        let limits = inputs.limits();
        let of = self
            .compensation
            .joints(&inputs.link(), &inputs.place(), &limits);
        let outputs = self.servo.step(&of, &limits);
        let (feedback_mm, through) =
            self.compensation
                .tool(outputs.feedback_mm, outputs.through, &of.through.carries);
        let found = outputs.left.and_then(|left| left.evidence);
        self.play_out
            .keep(&of, outputs.drive_mm, outputs.delay_periods);
        COutputs {
            drive_mm: three(outputs.drive_mm),
            feedback_mm: three(feedback_mm),
            correction_mm: three(outputs.correction_mm),
            geometry_mm: three(self.compensation.offset_mm()),
            through_drive: through.drive,
            through_feedback: through.feedback,
            contour_error_mm: outputs.contour_error_mm,
            without_mm: outputs.without_mm,
            adaptive_feed: outputs.adaptive_feed,
            found_mm: found.map_or(0.0, |evidence| evidence.found_mm),
            limit_mm: found.map_or(0.0, |evidence| evidence.limit_mm),
            state: state(&outputs),
            fault: number(outputs.fault),
            saturated: u32::from(outputs.saturated),
            delay_periods: outputs.delay_periods,
            holds_feed: u32::from(outputs.holds_feed),
            is_settled: u32::from(outputs.is_settled),
            times_out: outputs.left.map_or(0, |left| left.count),
            latched: u32::from(outputs.latched),
            learned: outputs
                .learned
                .iter()
                .rev()
                .fold(0, |bits, learned| 2 * bits + u32::from(*learned)),
            compensates: u32::from(self.compensation.compensates()),
        }
    }

    fn play_out(&mut self, inputs: &CInputs) -> COutputs {
        let powered = inputs.is(FEEDWRIGHT_POWERED);
        let of = self
            .compensation
            .joints(&inputs.link(), &inputs.place(), &inputs.limits());
        let out = self.play_out.step(&of);
        let (feedback_mm, through) =
            self.compensation
                .tool(out.feedback_mm, out.through, &of.through.carries);
        let is_settled = out.delay_periods == 0;
        COutputs {
            drive_mm: three(out.drive_mm),
            feedback_mm: three(feedback_mm),
            correction_mm: three(out.correction_mm),
            geometry_mm: three(self.compensation.offset_mm()),
            through_drive: through.drive,
            through_feedback: through.feedback,
            contour_error_mm: 0.0,
            without_mm: 0.0,
            adaptive_feed: 1.0,
            found_mm: 0.0,
            limit_mm: 0.0,
            state: if !powered {
                0
            } else if is_settled {
                1
            } else {
                2
            },
            fault: FEEDWRIGHT_FAILED,
            saturated: 0,
            delay_periods: out.delay_periods,
            holds_feed: u32::from(inputs.is(FEEDWRIGHT_PROBING) && !is_settled),
            is_settled: u32::from(is_settled),
            times_out: 0,
            learned: 0,
            compensates: u32::from(self.compensation.compensates()),
            latched: 0,
        }
    }
}

/// Returns the state as [`COutputs`] numbers it.
fn state<const N: usize>(outputs: &LinkOutputs<N>) -> u32 {
    match (outputs.link, outputs.state) {
        (Link::Off, _) => 0,
        (Link::Direct, _) => 1,
        (Link::Delayed, State::Shadow) => 2,
        (Link::Delayed, State::Fading) => 3,
        (Link::Delayed, State::Engaged) => 4,
    }
}

/// Returns the fault as `faults.h` numbers it.
fn number(fault: LinkFault) -> u32 {
    match fault {
        LinkFault::None => 0,
        LinkFault::Model(Refused::Block(error)) => match error {
            BlockError::NoModel => 1,
            BlockError::Format(_) => 2,
            BlockError::Kind(_) => 3,
            BlockError::Axes(_) => 4,
            BlockError::Length => 5,
            BlockError::Checksum => 6,
            BlockError::Number(_) => 7,
            BlockError::Geometry => 22,
        },
        LinkFault::Model(Refused::Kind) => 3,
        LinkFault::Model(Refused::Period) => 8,
        LinkFault::Faded(Cause::NotANumber) => 9,
        LinkFault::Faded(Cause::LostFeedback) => 10,
        LinkFault::Faded(Cause::WrongPredictions) => 11,
        LinkFault::Faded(Cause::Harmful) => 12,
        LinkFault::Command => 13,
        LinkFault::Setting(Setting::Delay) => 16,
        LinkFault::Setting(Setting::Deviation) => 17,
        LinkFault::Setting(Setting::Speed) => 18,
        LinkFault::Setting(Setting::CorrectionAcceleration) => 19,
        LinkFault::Setting(Setting::AdaptiveScale) => 20,
        LinkFault::Setting(Setting::Acceleration) => 15,
        LinkFault::NotHeld => 21,
    }
}
