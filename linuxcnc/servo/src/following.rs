//! Predicted following error as the control sees it, for a joint that speeds up to its highest
//! speed and brakes to rest, by its model, without a correction.
//!
//! ```text
//! e(n) = c(n - D) - a(n)           what the control compares with max(MIN_FERROR, FERROR |v(n)| / speed), v(n) of c(n)
//! ```
//!
//! The limit follows the speed of the command now; the error belongs to the command D servo periods
//! ago. The error is therefore largest against its limit while the command brakes. An axis with the
//! time constant T lags by `A T^2` where a braking of A ends, and by up to `A T (T + D)` where the
//! braking of its control has ended.

use feedwright_control::IdentifiedAxes;
use feedwright_control::vector::bounded;

use crate::plant::SimulatedMachine;

/// Time at the highest speed, and at rest behind the braking, s: ten time constants of a usual
/// position loop.
const STEADY_S: f64 = 0.2;
/// Longest time of speeding up that is simulated, s.
const MOST_RAMP_S: f64 = 5.0;

/// Limits that the control sets for a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointLimits {
    /// Highest speed, mm/s.
    pub speed_mm_s: f64,
    /// Acceleration, mm/s2.
    pub acceleration_mm_s2: f64,
    /// Following error allowed at the highest speed, mm.
    pub ferror_mm: f64,
}

/// Returns the least MIN_FERROR of each joint with which it is not stopped, mm, with a command
/// `delay_s` late; 0 for a joint without limits.
pub fn least_min_ferror_mm<const N: usize>(
    machine: &IdentifiedAxes<N>,
    joints: [JointLimits; N],
    delay_s: f64,
) -> [f64; N] {
    let servo_s = machine.periods.servo_s;
    let ramps_s = joints.map(|joint| ramp_s(&joint));
    let most_s = 2.0 * (ramps_s.into_iter().fold(0.0, f64::max) + STEADY_S);
    let delay = libm::round(delay_s / servo_s);
    let mut plant = SimulatedMachine::without_noise(machine);
    let mut least_mm = [0.0_f64; N];
    for n in 0..(most_s / servo_s) as u32 {
        let t_s = f64::from(n) * servo_s;
        let late_mm = motion(&joints, &ramps_s, t_s - delay * servo_s).map(|[at_mm, _]| at_mm);
        let measured_mm = plant.measured_mm();
        let now = motion(&joints, &ramps_s, t_s);
        for (i, least_mm) in least_mm.iter_mut().enumerate() {
            let error_mm = (late_mm[i] - measured_mm[i]).abs();
            let [_, speed_mm_s] = now[i];
            if joints[i].is_set()
                && error_mm > joints[i].ferror_mm * speed_mm_s / joints[i].speed_mm_s
            {
                *least_mm = least_mm.max(error_mm);
            }
        }
        plant.step(late_mm, true, 1.0);
    }
    least_mm
}

impl JointLimits {
    /// A joint without limits.
    pub const NONE: Self = Self {
        speed_mm_s: 0.0,
        acceleration_mm_s2: 0.0,
        ferror_mm: 0.0,
    };

    fn is_set(&self) -> bool {
        [self.speed_mm_s, self.acceleration_mm_s2, self.ferror_mm]
            .into_iter()
            .all(|x| x > 0.0 && x.is_finite())
    }
}

/// Time of speeding up, s.
fn ramp_s(joint: &JointLimits) -> f64 {
    if joint.is_set() {
        (joint.speed_mm_s / joint.acceleration_mm_s2).min(MOST_RAMP_S)
    } else {
        0.0
    }
}

/// Position and speed of each command at a time, mm and mm/s.
fn motion<const N: usize>(
    joints: &[JointLimits; N],
    ramps_s: &[f64; N],
    t_s: f64,
) -> [[f64; 2]; N] {
    core::array::from_fn(|i| {
        let (ramp_s, t_s) = (ramps_s[i], t_s.max(0.0));
        let most_mm_s = ramp_s
            * if joints[i].is_set() {
                joints[i].acceleration_mm_s2
            } else {
                0.0
            };
        let up_s = t_s.min(ramp_s);
        let down_s = bounded(t_s - ramp_s - STEADY_S, 0.0, ramp_s);
        let steady_s = bounded(t_s - ramp_s, 0.0, STEADY_S);
        // An axis without a ramp does not move.
        let per_s = if ramp_s > 0.0 {
            most_mm_s / ramp_s
        } else {
            0.0
        };
        let ramps_mm = 0.5 * per_s * (up_s * up_s - down_s * down_s) + most_mm_s * down_s;
        [ramps_mm + most_mm_s * steady_s, per_s * (up_s - down_s)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const JOINT: JointLimits = JointLimits {
        speed_mm_s: 200.0,
        acceleration_mm_s2: 2000.0,
        ferror_mm: 10.0,
    };

    #[test]
    fn the_motion_goes_up_to_its_speed_and_comes_to_rest() {
        let ramps_s = [ramp_s(&JOINT)];
        let at = |t_s: f64| motion(&[JOINT], &ramps_s, t_s)[0];
        assert_eq!((at(-1.0), at(0.0)), ([0.0; 2], [0.0; 2]));
        assert_eq!((at(0.1)[1], at(0.25)[1], at(0.5)[1]), (200.0, 200.0, 0.0));
        // v^2 / a and what is between.
        assert!((at(1.0)[0] - (20.0 + 40.0)).abs() < 1e-9, "{:?}", at(1.0));
        assert!((at(0.35)[0] - at(0.349)[0] - 0.2e-3 * at(0.3495)[1] / 0.2).abs() < 1e-6);
        assert_eq!(motion(&[JointLimits::NONE], &[0.0], 1.0), [[0.0; 2]]);
    }
}
