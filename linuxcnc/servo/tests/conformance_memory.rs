//! Tests the C interface of `hal/` as C calls it. The interface rejects memory that is too small,
//! not aligned or null, and bytes that are no model. What it creates runs in exactly the bytes that
//! it requires. `just miri` runs this file in Miri, which stops at every access beyond them.

#![expect(
    unreachable_pub,
    reason = "the sources of a library, of which these tests call a part"
)]

#[path = "../../hal/src/following.rs"]
mod following;
#[path = "../../hal/src/memory.rs"]
mod memory;
#[path = "../../hal/src/plant.rs"]
mod plant;
#[path = "../../hal/src/servo.rs"]
mod servo;

#[path = "common/axis.rs"]
mod axis;

use std::mem::MaybeUninit;
use std::ptr::null_mut;

use feedwright_control::{
    ContourIdentifier, IdentifiedAxes, Identifier, ModelBlock, Trained, TrainedModel,
};

use following::{CJoint, feedwright_min_ferror};
use plant::{CPlant, feedwright_plant_bytes, feedwright_plant_new, feedwright_plant_step};
use servo::{CInputs, COutputs, CServo};
use servo::{
    FEEDWRIGHT_CUTTING, FEEDWRIGHT_ENABLED, FEEDWRIGHT_JOINT, FEEDWRIGHT_NOT_MADE,
    FEEDWRIGHT_POWERED,
};
use servo::{
    feedwright_servo_bytes, feedwright_servo_layout, feedwright_servo_new,
    feedwright_servo_play_out, feedwright_servo_runs_at, feedwright_servo_step,
};

/// Servo periods: rest until the delay is taken up, and as many in motion.
const PERIODS: u32 = if cfg!(miri) { 40 } else { 400 };
const SERVO_S: f64 = 0.001;
/// Commands, actual positions and offsets of three joints, six settings, and 2 times six channels.
const NUMBERS: usize = 3 * 3 + 6 + 2 * 6;
/// Four times three joints, two times six channels, and five more.
const RESULTS: usize = 4 * 3 + 2 * 6 + 5;

/// `CInputs` as a caller lays it out.
#[repr(C)]
struct Inputs {
    numbers: [f64; NUMBERS],
    flags: u32,
    carries: u32,
}

/// `COutputs` as a caller lays it out.
#[repr(C)]
struct Outputs {
    numbers: [f64; RESULTS],
    whole: [u32; 10],
}

/// A model of axes.
fn block<const N: usize>() -> Vec<u8> {
    let axes = IdentifiedAxes {
        periods: axis::PERIODS,
        axes: [axis::axis(); N],
    };
    written(Trained::<N>::Axes(axes))
}

/// A model of the contour error: in Miri the regulator of axes takes minutes to be made.
fn contour<const N: usize>() -> Vec<u8> {
    let mut identifier = ContourIdentifier::NULL;
    identifier.weights(&mut |_, group| group.fill(0.01));
    written(Trained::<N>::Contour {
        net: identifier,
        response_s: 0.004,
    })
}

fn written<const N: usize>(trained: Trained<N>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let model = TrainedModel {
        servo_s: SERVO_S,
        feed_period_s: 0.005,
        trained,
    };
    let geometry = None;
    ModelBlock { model, geometry }.to_bytes(|more| bytes.extend_from_slice(more));
    bytes
}

/// Creates a link in the bytes that it requires. Returns it with the fault that it begins with.
fn link(joints: u32, bytes: &[u8]) -> (Box<MaybeUninit<CServo>>, u32) {
    let mut memory = Box::new_uninit();
    // SAFETY: the memory and the bytes are valid.
    let fault = unsafe {
        feedwright_servo_new(
            memory.as_mut_ptr(),
            feedwright_servo_bytes(),
            joints,
            bytes.as_ptr(),
            bytes.len(),
        )
    };
    assert_ne!(fault, FEEDWRIGHT_NOT_MADE);
    (memory, fault)
}

/// Steps a link; with `fails`, plays out its delay, as the caller does once a step has panicked.
fn steps(memory: &mut MaybeUninit<CServo>, fails: bool) -> Outputs {
    // SAFETY: `link` initialized it.
    let servo = unsafe { memory.assume_init_mut() };
    let mut outputs = Outputs {
        numbers: [f64::NAN; RESULTS],
        whole: [u32::MAX; 10],
    };
    let mut drive_mm = [0.0; 3];
    for n in 0..PERIODS {
        let mut numbers = [0.0; NUMBERS];
        let moved = f64::from(n.saturating_sub(PERIODS / 2));
        numbers[0] = 0.05 * moved;
        numbers[3..6].copy_from_slice(&drive_mm);
        numbers[9..15].copy_from_slice(&[0.01, 0.5, 100.0, 500.0, 0.0, 1.0]);
        // A lost position, and a channel that passes through.
        numbers[4] = if n % 7 == 3 { f64::NAN } else { numbers[4] };
        numbers[15] = moved;
        let flags = FEEDWRIGHT_POWERED | FEEDWRIGHT_ENABLED | FEEDWRIGHT_CUTTING;
        let inputs = Inputs {
            numbers,
            flags,
            carries: FEEDWRIGHT_JOINT | 0xF0,
        };
        // SAFETY: the layouts are the same: the library reports the same sizes.
        unsafe {
            let (inputs, outputs) = (
                &*(&raw const inputs).cast::<CInputs>(),
                &mut *(&raw mut outputs).cast::<COutputs>(),
            );
            if fails {
                feedwright_servo_play_out(servo, inputs, outputs);
            } else {
                feedwright_servo_step(servo, inputs, outputs);
            }
        }
        assert!(
            outputs.numbers.iter().all(|number| number.is_finite()),
            "{n}: {:?}",
            outputs.numbers
        );
        drive_mm.copy_from_slice(&outputs.numbers[..3]);
    }
    outputs
}

#[test]
fn a_caller_lays_out_what_the_library_does() {
    assert_eq!(
        feedwright_servo_layout(),
        size_of::<Inputs>() << 16 | size_of::<Outputs>()
    );
}

#[test]
fn unsuitable_memory_is_refused() {
    let block = contour::<2>();
    let (bytes, length) = (block.as_ptr(), block.len());
    let mut memory = vec![0_u8; feedwright_servo_bytes() + 16];
    let begin = memory.as_mut_ptr();
    let aligned = begin.align_offset(align_of::<CServo>());
    let [good, odd] = [aligned, aligned + 1].map(|at| begin.wrapping_add(at).cast::<CServo>());
    let (needs, plant_needs) = (feedwright_servo_bytes(), feedwright_plant_bytes());
    // SAFETY: invalid memory is not written to; the memory of the last call is valid.
    unsafe {
        assert_eq!(
            feedwright_servo_new(null_mut(), needs, 2, bytes, length),
            FEEDWRIGHT_NOT_MADE
        );
        assert_eq!(
            feedwright_servo_new(odd, needs, 2, bytes, length),
            FEEDWRIGHT_NOT_MADE
        );
        assert_eq!(
            feedwright_servo_new(good, needs - 1, 2, bytes, length),
            FEEDWRIGHT_NOT_MADE
        );
        assert!(!feedwright_plant_new(
            null_mut(),
            plant_needs,
            2,
            bytes,
            length,
            1
        ));
        assert!(!feedwright_plant_new(
            good.cast(),
            plant_needs - 1,
            2,
            bytes,
            length,
            1
        ));
        assert_eq!(feedwright_servo_new(good, needs, 2, bytes, length), 0);
    }
}

#[test]
fn an_invalid_model_leaves_a_link_that_passes_commands_on() {
    let whole = block::<2>();
    let mut limits = [0.0; 3];
    // SAFETY: a null pointer may stand for a missing model, and the memory is valid.
    unsafe {
        let mut memory = Box::new_uninit();
        let fault = feedwright_servo_new(
            memory.as_mut_ptr(),
            feedwright_servo_bytes(),
            2,
            null_mut(),
            4096,
        );
        assert_eq!(fault, 1);
        assert_eq!(steps(&mut memory, false).numbers[6..9], [0.0; 3]);
        feedwright_min_ferror(
            null_mut(),
            4096,
            3,
            &*[0.0; 9].as_ptr().cast::<[CJoint; 3]>(),
            &mut limits,
        );
    }
    assert_eq!(limits, [0.0; 3]);
    for length in (0..whole.len()).step_by(if cfg!(miri) { 97 } else { 1 }) {
        // Memory of its own: Miri stops at every read beyond it.
        let cut: Box<[u8]> = whole[..length].into();
        let (_, fault) = link(2, &cut);
        assert!(fault == 1 || fault == 5, "{length}: {fault}");
    }
    assert_eq!(link(3, &whole).1, 4);
}

#[test]
fn two_and_three_joints_run_in_the_bytes_that_they_ask_for() {
    for (joints, bytes, of_errors) in [
        (2, block::<2>(), contour::<2>()),
        (3, block::<3>(), contour::<3>()),
    ] {
        let (mut memory, fault) = link(joints, if cfg!(miri) { &of_errors } else { &bytes });
        // SAFETY: `link` initialized it.
        let at_another_period =
            unsafe { feedwright_servo_runs_at(memory.assume_init_mut(), SERVO_S) };
        assert_eq!((fault, at_another_period), (0, 0));
        let outputs = steps(&mut memory, false);
        assert!(
            cfg!(miri) || outputs.whole[0] >= 2,
            "it is delayed: {:?}",
            outputs.whole
        );
        assert_eq!(steps(&mut memory, true).whole[1], 14);
        let mut plant = Box::<CPlant>::new_uninit();
        let [mut tool_mm, mut measured_mm, mut torque_nm] = [[f64::NAN; 3]; 3];
        // SAFETY: the memory and the bytes are valid, and the machine is created before it is
        // stepped.
        unsafe {
            assert!(feedwright_plant_new(
                plant.as_mut_ptr(),
                feedwright_plant_bytes(),
                joints,
                bytes.as_ptr(),
                bytes.len(),
                1
            ));
            for n in 0..PERIODS {
                let command_mm = [0.01 * f64::from(n); 3];
                feedwright_plant_step(
                    plant.assume_init_mut(),
                    &command_mm,
                    true,
                    1.0,
                    &mut tool_mm,
                    &mut measured_mm,
                    &mut torque_nm,
                );
            }
        }
        assert!(
            [tool_mm, measured_mm, torque_nm]
                .as_flattened()
                .iter()
                .all(|number| number.is_finite())
        );
        assert!(tool_mm[0] > 0.0, "{tool_mm:?}");
    }
}
