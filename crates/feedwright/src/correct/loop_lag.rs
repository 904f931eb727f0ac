//! Lag of an axis behind its command: two terms of the series of its closed loop, measured in a
//! simulation.
//!
//! ```text
//! X(s) = (1 - T1 s + (T1^2 - T2) s^2 - ...) C(s),    so    C = (1 + T1 s + T2 s^2 + ...) X
//! ```
//!
//! A position loop without feedforward has T1 = 1 / Kp and T2 = J / (Kp Kv). Feedforward reduces
//! both, a delay increases them. The axis follows the command `a t^2 / 2` without friction, and
//! then is at `a t^2 / 2 - T1 a t + (T1^2 - T2) a`.

use feedwright_sim::{Axis, Machine, Plant};

/// Acceleration of the test, mm/s2, and its duration, in time constants of the position loop.
const TEST_MM_S2: f64 = 100.0;
const TEST_TIME_CONSTANTS: f64 = 30.0;
/// Two moments at which the position is read, as fractions of the test.
const MOMENTS: [f64; 2] = [0.8, 1.0];

/// T1 and T2 of the axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LoopLag {
    /// T1, s.
    pub(super) first_s: f64,
    /// T2, s2.
    pub(super) second_s2: f64,
}

/// The lags of the first N axes of a machine.
pub(super) fn loop_lags<const N: usize>(machine: &Machine) -> [LoopLag; N] {
    let axis = |axis: &Axis| Axis {
        coulomb_friction_nm: 0.0,
        coulomb_asymmetry_nm: 0.0,
        stribeck_nm: 0.0,
        viscous_friction_nm_s: 0.0,
        torque_limit_nm: f64::MAX.sqrt(),
        speed_limit_mm_s: 0.0,
        transmission: None,
        ..*axis
    };
    let free = Machine {
        axes: machine.axes.iter().map(axis).collect(),
        ..super::nominal::deterministic(machine)
    };
    let slowest_1_s = free.slowest_kp_1_s();
    let servo_s = free.period.servo_s;
    let periods = (TEST_TIME_CONSTANTS / slowest_1_s / servo_s).ceil();
    let looks = MOMENTS.map(|part| (part * periods) as u64);
    let mut plant = Plant::<N>::new(&free, [0.0; N]);
    let mut seen = [[0.0; N]; 2];
    for n in 0..=looks[1] {
        let t_s = n as f64 * servo_s;
        // A row has the command at its start and the tool at its end.
        let joint_mm = plant.step([0.5 * TEST_MM_S2 * t_s * t_s; N]).joint_mm;
        for (look, at) in looks.iter().zip(&mut seen) {
            if *look == n {
                *at = joint_mm;
            }
        }
    }
    let [t0, t1] = looks.map(|n| n as f64 * servo_s);
    std::array::from_fn(|i| {
        let behind = |at: f64, t: f64| 0.5 * t * t - at / TEST_MM_S2;
        let (early, late) = (behind(seen[0][i], t0), behind(seen[1][i], t1));
        let first_s = (late - early) / (t1 - t0);
        // The distance behind the command is T1 t - (T1^2 - T2).
        let second_s2 = first_s * first_s - (first_s * t1 - late);
        LoopLag { first_s, second_s2 }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loop_without_feedforward_has_the_textbooks_lags() {
        let machine = Machine::load("tnv40".as_ref()).expect("built in");
        let [x, y] = loop_lags::<2>(&machine);
        let servo_s = machine.period.servo_s;
        for (lag, axis) in [x, y].iter().zip(&machine.axes) {
            // Held for a servo period, the command is late by half of it; the tool is looked at a
            // period later.
            let first_s = 1.0 / axis.kp_1_s + 0.5 * servo_s - servo_s;
            assert!(
                (lag.first_s / first_s - 1.0).abs() < 0.03,
                "{lag:?} {first_s}"
            );
            let second_s2 = axis.inertia_kg_m2 / (axis.kp_1_s * axis.kv_nm_s_per_rad);
            assert!(
                (lag.second_s2 / second_s2 - 1.0).abs() < 0.3,
                "{lag:?} {second_s2}"
            );
        }
    }

    #[test]
    fn feedforward_takes_most_of_the_lag_away() {
        let machine = Machine::load("stiff".as_ref()).expect("built in");
        let [x, _] = loop_lags::<2>(&machine);
        assert!(x.first_s.abs() < 0.2 / machine.axes[0].kp_1_s, "{x:?}");
    }
}
