//! The axis of the tests' machines.

use std::f64::consts::TAU;

use feedwright_control::{Parameters, Periods};

/// Periods of the tests' machines.
pub(crate) const PERIODS: Periods = Periods {
    servo_s: 0.001,
    mechanics_s: 0.0001,
    mechanics_per_servo: 10,
};

/// Returns an axis with the numbers of the machine of Lee, Cho and Jeon (2005).
pub(crate) fn axis() -> Parameters {
    Parameters {
        rad_per_mm: TAU / 10.0,
        kp_1_s: 50.0,
        kd: 0.0,
        kv_nm_s_per_rad: 2.0,
        torque_limit_nm: 30.0,
        inertia_kg_m2: 0.0103,
        viscous_friction_nm_s: 0.0336,
        coulomb_friction_nm: 0.2,
        coulomb_smoothing_rad_s: 0.05,
        drive_delay_s: 0.001,
        measurement_delay_s: 0.0005,
        ..Parameters::NOTHING
    }
}
