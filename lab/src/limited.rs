//! Machines whose axes have limits, for studies of planners.

use feedwright_sim::Machine;

/// Feedrate of programs and rapids, mm/s.
pub const LIMITED_FEED_MM_S: f64 = 200.0;
/// Limits of each axis: mm/s, mm/s2, mm/s3.
pub const AXIS_LIMITS: [f64; 3] = [200.0, 2000.0, 50_000.0];

/// `tnv40` with [`AXIS_LIMITS`], planned within a tolerance of the path.
pub fn limited_machine(tolerance_um: f64) -> Machine {
    let mut machine = Machine::load("tnv40".as_ref()).expect("it is built in");
    [machine.limits.rapid_mm_s, machine.limits.max_feed_mm_s] = [LIMITED_FEED_MM_S; 2];
    machine.limits.path_tolerance_um = Some(tolerance_um);
    for axis in &mut machine.axes {
        [
            axis.max_velocity_mm_s,
            axis.max_accel_mm_s2,
            axis.max_jerk_mm_s3,
        ] = AXIS_LIMITS.map(Some);
    }
    machine
}

/// The same with a linear servo, `x' = v`, `v' = a (k (r - x) - v)`, at 10 kHz: nothing but the two
/// loops.
pub fn linear_machine(tolerance_um: f64) -> Machine {
    let mut machine = limited_machine(tolerance_um);
    (
        machine.period.servo_s,
        machine.period.mechanics_s,
        machine.period.mechanics_per_servo,
    ) = (1e-4, 1e-4, 1);
    for axis in &mut machine.axes {
        (
            axis.viscous_friction_nm_s,
            axis.coulomb_friction_nm,
            axis.disturbance_nm,
        ) = (0.0, 0.0, 0.0);
        axis.torque_limit_nm = 1e3;
    }
    machine
}
