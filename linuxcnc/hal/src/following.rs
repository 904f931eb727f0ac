//! Following errors that a control has to allow.

use feedwright_servo::following::{JointLimits, least_min_ferror_mm};
use feedwright_servo::limits::DELAYS_S;
use feedwright_servo::machine::axes_of;

use crate::memory::{model, three};

/// What the control allows a joint.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CJoint {
    /// MAX_VELOCITY.
    speed_mm_s: f64,
    /// MAX_ACCELERATION, mm/s2.
    acceleration_mm_s2: f64,
    /// FERROR.
    ferror_mm: f64,
}

/// The least MIN_FERROR of each joint with the longest delay, by a model; 0 where it has no axes,
/// or a joint no limits. Before the thread runs.
///
/// # Safety
/// There are so many bytes at `bytes`; the others are what they are declared to be.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn feedwright_min_ferror(
    bytes: *const u8,
    length: usize,
    joints: u32,
    limits: &[CJoint; 3],
    min_ferror_mm: &mut [f64; 3],
) {
    // SAFETY: as the caller promises.
    let bytes = unsafe { model(bytes, length) };
    *min_ferror_mm = if joints == 2 {
        least::<2>(bytes, limits)
    } else {
        least::<3>(bytes, limits)
    };
}

fn least<const N: usize>(bytes: &[u8], limits: &[CJoint; 3]) -> [f64; 3] {
    let [_, delay_s] = DELAYS_S;
    let of = |&CJoint {
                  speed_mm_s,
                  acceleration_mm_s2,
                  ferror_mm,
              }: &CJoint| JointLimits {
        speed_mm_s,
        acceleration_mm_s2,
        ferror_mm,
    };
    let joints = core::array::from_fn(|i| limits.get(i).map_or(JointLimits::NONE, of));
    axes_of::<N>(bytes).map_or([0.0; 3], |axes| {
        three(least_min_ferror_mm(&axes, joints, delay_s))
    })
}
