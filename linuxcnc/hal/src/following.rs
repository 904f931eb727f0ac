//! Following errors that the control has to allow.

use feedwright_servo::following::{JointLimits, least_min_ferror_mm};
use feedwright_servo::limits::DELAYS_S;
use feedwright_servo::machine::axes_of;

use crate::memory::{model, three};

/// Limits of a joint in the configuration of the control.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CJoint {
    /// MAX_VELOCITY, mm/s.
    speed_mm_s: f64,
    /// MAX_ACCELERATION, mm/s2.
    acceleration_mm_s2: f64,
    /// FERROR, mm.
    ferror_mm: f64,
}

/// Computes the least MIN_FERROR of each joint, mm, with the longest delay, from the model in
/// `bytes`. It is 0 for a joint without limits, and for all joints if the model states no axes.
/// Call it before the thread runs.
///
/// # Safety
/// `bytes` is null or points to `length` bytes. The other arguments are valid as declared.
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
    axes_of::<N>(bytes).map_or([0.0; 3], |(axes, _)| {
        three(least_min_ferror_mm(&axes, joints, delay_s))
    })
}
