//! The link between command and drive.

use feedwright_control::model::BlockError;
use feedwright_control::safety::State;
use feedwright_control::safety::engagement::Cause;
use feedwright_servo::machine::{Refused, axes_of};
use feedwright_servo::servo::{Link, LinkFault, LinkInputs, LinkLimits, LinkOutputs, Servo};

use crate::memory::{TwoOrThree, first, model, put, three};

/// `feedwright_inputs`.
#[repr(C)]
pub(crate) struct CInputs {
    command_mm: [f64; 3],
    actual_mm: [f64; 3],
    delay_s: f64,
    deviation_mm: f64,
    speed_mm_s: f64,
    correction_mm_s2: f64,
    flags: u32,
    reserved: u32,
}

const POWERED: u32 = 1;
const ENABLED: u32 = 2;
const DIRECT: u32 = 4;
const SPINDLE: u32 = 8;
const CUTTING: u32 = 16;

/// `feedwright_outputs`.
#[repr(C)]
pub(crate) struct COutputs {
    drive_mm: [f64; 3],
    feedback_mm: [f64; 3],
    correction_mm: [f64; 3],
    contour_error_mm: f64,
    without_mm: f64,
    state: u32,
    fault: u32,
    saturated: u32,
    delay_periods: u32,
}

/// `feedwright_servo`.
pub(crate) struct CServo(TwoOrThree<Servo<2>, Servo<3>>);

/// Bytes that a link needs.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn feedwright_servo_bytes() -> usize {
    size_of::<CServo>()
}

/// Sizes of inputs and outputs, for the caller to compare with its own.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn feedwright_servo_layout() -> usize {
    size_of::<CInputs>() << 16 | size_of::<COutputs>()
}

/// A new link of two or three joints, with or without a model; the fault that it begins with, or the largest number where the memory is
/// none for it.
///
/// # Safety
/// There are so many bytes at `memory`, which nobody else uses, and so many at `bytes`.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn feedwright_servo_new(
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
            let axes = axes_of(bytes);
            fault = axes.as_ref().err().map_or(0, |refused| number(LinkFault::Model(*refused)));
            TwoOrThree::Two(Servo::new(axes))
        } else {
            let axes = axes_of(bytes);
            fault = axes.as_ref().err().map_or(0, |refused| number(LinkFault::Model(*refused)));
            TwoOrThree::Three(Servo::new(axes))
        })
    };
    // SAFETY: as the caller promises.
    if unsafe { put(memory, memory_bytes, make) } { fault } else { u32::MAX }
}

/// Tells the servo period of the thread, before the first step; the fault that there is then.
///
/// # Safety
/// `servo` was made by [`feedwright_servo_new`].
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn feedwright_servo_runs_at(servo: &mut CServo, servo_s: f64) -> u32 {
    number(match &mut servo.0 {
        TwoOrThree::Two(servo) => servo.runs_at(servo_s),
        TwoOrThree::Three(servo) => servo.runs_at(servo_s),
    })
}

/// One servo period.
///
/// # Safety
/// `servo` was made by [`feedwright_servo_new`]; the others are what they are declared to be.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "C" fn feedwright_servo_step(servo: &mut CServo, inputs: &CInputs, outputs: &mut COutputs) {
    *outputs = match &mut servo.0 {
        TwoOrThree::Two(servo) => step(servo, inputs),
        TwoOrThree::Three(servo) => step(servo, inputs),
    };
}

fn step<const N: usize>(servo: &mut Servo<N>, inputs: &CInputs) -> COutputs {
    let is = |flag: u32| inputs.flags & flag != 0;
    let of = LinkInputs {
        command_mm: first(inputs.command_mm),
        actual_mm: first(inputs.actual_mm),
        powered: is(POWERED),
        enabled: is(ENABLED),
        direct: is(DIRECT),
        spindle: is(SPINDLE),
        cutting: is(CUTTING),
    };
    let CInputs { delay_s, deviation_mm, speed_mm_s, correction_mm_s2, .. } = *inputs;
    let outputs = servo.step(&of, &LinkLimits { delay_s, deviation_mm, speed_mm_s, correction_mm_s2 });
    COutputs {
        drive_mm: three(outputs.drive_mm),
        feedback_mm: three(outputs.feedback_mm),
        correction_mm: three(outputs.correction_mm),
        contour_error_mm: outputs.contour_error_mm,
        without_mm: outputs.without_mm,
        state: state(&outputs),
        fault: number(outputs.fault),
        saturated: u32::from(outputs.saturated),
        delay_periods: outputs.delay_periods,
    }
}

/// As `feedwright.h` counts them.
fn state<const N: usize>(outputs: &LinkOutputs<N>) -> u32 {
    match (outputs.link, outputs.state) {
        (Link::Off, _) => 0,
        (Link::Direct, _) => 1,
        (Link::Delayed, State::Shadow) => 2,
        (Link::Delayed, State::Fading) => 3,
        (Link::Delayed, State::Engaged) => 4,
    }
}

/// As `feedwright.h` counts them.
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
        },
        LinkFault::Model(Refused::Kind) => 3,
        LinkFault::Model(Refused::Period) => 8,
        LinkFault::Faded(Cause::NotANumber) => 9,
        LinkFault::Faded(Cause::LostFeedback) => 10,
        LinkFault::Faded(Cause::WrongPredictions) => 11,
        LinkFault::Faded(Cause::Harmful) => 12,
        LinkFault::Command => 13,
    }
}
