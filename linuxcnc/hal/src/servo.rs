//! The link between command and drive.

use feedwright_control::{BlockError, Cause, State};
use feedwright_servo::compensation::{Compensation, MachinePlace};
use feedwright_servo::limits::{LinkLimits, Setting};
use feedwright_servo::machine::{Refused, geometry_of, model_of};
use feedwright_servo::play_out::PlayOut;
use feedwright_servo::servo::{Link, LinkFault, LinkInputs, LinkOutputs, Servo};
use feedwright_servo::through::{Carries, Through};

use crate::memory::{TwoOrThree, first, model, put, three};

/// The amplifiers are on.
pub const FEEDWRIGHT_POWERED: u32 = 1;
/// The correction is wanted.
pub const FEEDWRIGHT_ENABLED: u32 = 2;
/// No delay is wanted.
pub const FEEDWRIGHT_DIRECT: u32 = 4;
/// A spindle is about to be followed.
pub const FEEDWRIGHT_SPINDLE: u32 = 8;
/// This motion cuts.
pub const FEEDWRIGHT_CUTTING: u32 = 16;
/// A controller that changes the feedrate leaves the geometry on the path.
pub const FEEDWRIGHT_SPEED_ALONE: u32 = 32;
/// This motion probes.
pub const FEEDWRIGHT_PROBING: u32 = 64;
/// The geometry of the model is to be compensated.
pub const FEEDWRIGHT_GEOMETRY: u32 = 128;
/// Every corrected joint is homed, so that its motor offset says where it is.
pub const FEEDWRIGHT_HOMED: u32 = 256;
/// Values that pass through at the most.
pub const FEEDWRIGHT_CHANNELS: usize = 6;
/// What a channel carries, in four bits of `carries` for each, the first in the lowest: this for a
/// joint, this and 1 + n for a second motor of the corrected joint n, 0 for a signal.
pub const FEEDWRIGHT_JOINT: u32 = 1;
/// What [`feedwright_servo_new`] returns where it made nothing.
pub const FEEDWRIGHT_NOT_MADE: u32 = 255;
/// The fault of a link that failed: known to the caller alone.
pub const FEEDWRIGHT_FAILED: u32 = 14;

/// What comes from the control and the drives in a servo period.
#[repr(C)]
pub struct CInputs {
    /// Position commands.
    command_mm: [f64; 3],
    /// Actual positions.
    actual_mm: [f64; 3],
    /// Motor offsets: motor position less position of the joint.
    offset_mm: [f64; 3],
    /// Delay of the command, 0.008 to 0.015. A setting out of its range is refused; the last good
    /// one stays in force.
    delay_s: f64,
    /// Largest distance of the drive's command from the path.
    deviation_mm: f64,
    /// Highest speed of the machine.
    speed_mm_s: f64,
    /// Acceleration of an offset that fades; 0 is without limit.
    correction_mm_s2: f64,
    /// Acceleration of an offset in the loop; 0 is without limit. A correction that needs more
    /// leaves the loop.
    engaged_mm_s2: f64,
    /// What 1 of the requested feedrate stands for, 0.1 to 1.
    adaptive_scale: f64,
    /// Commands that are delayed and not corrected.
    through: [f64; FEEDWRIGHT_CHANNELS],
    /// Their actual positions; of a signal its command.
    through_actual: [f64; FEEDWRIGHT_CHANNELS],
    /// The sum of FEEDWRIGHT_POWERED and so on.
    flags: u32,
    /// What the channels carry.
    carries: u32,
}

/// What goes to the drives and the control.
#[repr(C)]
pub struct COutputs {
    /// Position commands of the drives.
    drive_mm: [f64; 3],
    /// What the control takes for the actual positions.
    feedback_mm: [f64; 3],
    /// Offsets of the drives' commands from the path.
    correction_mm: [f64; 3],
    /// Offsets of the joints' commands from those of the control, by the geometry.
    geometry_mm: [f64; 3],
    /// Commands of the drives of what passes through, and what the control takes for the actual
    /// positions.
    through_drive: [f64; FEEDWRIGHT_CHANNELS],
    through_feedback: [f64; FEEDWRIGHT_CHANNELS],
    /// Distance of the actual position from the path.
    contour_error_mm: f64,
    /// The same without the correction, by the model.
    without_mm: f64,
    /// Feedrate that the control is asked for, as a multiple of its own in the scale that is set, 0
    /// to 1.
    adaptive_feed: f64,
    /// What the supervisor found when it took the correction out of the loop last, and what it may
    /// be; 0 where nothing was compared.
    found_mm: f64,
    limit_mm: f64,
    /// 0 amplifiers off, 1 without delay, 2 delayed, 3 the correction fades, 4 it is in the loop.
    state: u32,
    /// Why there is no correction, 0 for nothing; faults.h has words for it.
    fault: u32,
    /// Whether a limit holds the correction.
    saturated: u32,
    /// Servo periods of delay.
    delay_periods: u32,
    /// Whether the control is to hold its feed.
    holds_feed: u32,
    /// Whether a motion that follows a spindle would be without delay.
    is_settled: u32,
    /// How often the supervisor has taken the correction out of the loop since the delay was taken
    /// up.
    times_out: u32,
    /// Joints that are corrected by what was learned while they moved: 1, 2 and 4.
    learned: u32,
    /// Whether the geometry is compensated, and nothing of it fades.
    compensates: u32,
    /// Whether the correction stays out until it is reset.
    latched: u32,
}

/// The link between command and drives.
pub struct CServo(TwoOrThree<Guarded<2>, Guarded<3>>);

/// A link, and what stands in for it where it fails.
struct Guarded<const N: usize> {
    compensation: Compensation<N>,
    servo: Servo<N>,
    play_out: PlayOut<N>,
}

/// Bytes that a link needs.
#[unsafe(no_mangle)]
pub extern "C" fn feedwright_servo_bytes() -> usize {
    size_of::<CServo>()
}

/// Sizes of inputs and outputs, for the caller to compare with its own.
#[unsafe(no_mangle)]
pub extern "C" fn feedwright_servo_layout() -> usize {
    size_of::<CInputs>() << 16 | size_of::<COutputs>()
}

/// A new link of two or three joints, with or without a model; the fault that it begins with, or
/// [`FEEDWRIGHT_NOT_MADE`] where the memory is none for it.
///
/// # Safety
/// There are so many bytes at `memory`, which nobody else uses, and so many at `bytes`.
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
    let model = model_of(bytes);
    *fault = model
        .as_ref()
        .err()
        .map_or(0, |refused| number(LinkFault::Model(*refused)));
    // A model that is refused compensates nothing.
    let geometry = if model.is_ok() {
        geometry_of(bytes)
    } else {
        None
    };
    Guarded {
        compensation: Compensation::new(geometry),
        servo: Servo::new(model),
        play_out: PlayOut::new(),
    }
}

/// Tells the servo period of the thread, before the first step; the fault that there is then.
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

/// One servo period.
///
/// # Safety
/// `servo` was made by [`feedwright_servo_new`]; the others are what they are declared to be.
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

/// One servo period in place of [`feedwright_servo_step`], once that has panicked: plays out its
/// delay, without a correction.
///
/// # Safety
/// `servo` was made by [`feedwright_servo_new`]; the others are what they are declared to be.
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

/// As [`COutputs`] counts them.
fn state<const N: usize>(outputs: &LinkOutputs<N>) -> u32 {
    match (outputs.link, outputs.state) {
        (Link::Off, _) => 0,
        (Link::Direct, _) => 1,
        (Link::Delayed, State::Shadow) => 2,
        (Link::Delayed, State::Fading) => 3,
        (Link::Delayed, State::Engaged) => 4,
    }
}

/// As `faults.h` counts them.
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
