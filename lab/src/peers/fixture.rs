//! What the tests of several peers cut with.

use feedwright_control::vector::add_scaled;
use feedwright_control::{
    AxisInverse, AxisModel, ContourError, Controller, KnotSource, Measured, Parameters, Periods,
    Preview, Register, Window,
};

use super::zero_phase::SampledAxis;

const SERVO_S: f64 = 0.001;

/// The commands of a controller that decides in each servo period, does not measure, and is not
/// held to any bound.
pub(super) fn commands(
    reference: &mut dyn KnotSource<2>,
    controller: &mut dyn Controller<2>,
    servo_s: f64,
    mut each: impl FnMut(usize, [f64; 2]),
) {
    let (mut register, mut preview) = (Register::default(), Preview::new(servo_s));
    let schedule = controller.schedule();
    assert_eq!(schedule.servo_periods, 1);
    let measured = Measured {
        position_mm: [0.0; 2],
        contour: ContourError::NONE,
    };
    let mut offset_mm = [0.0; 2];
    for n in 0..1000 {
        let tau_s = n as f64 * servo_s;
        register.push(reference.knot(tau_s));
        preview.fill(reference, tau_s, f64::from(schedule.preview) * servo_s);
        let window = Window {
            register: &register,
            preview: &preview,
            tau_s,
            feed_period_s: servo_s,
            offset_mm,
            offset_mm_s: [0.0; 2],
        };
        each(n, add_scaled(window.now().position_mm, 1.0, offset_mm));
        offset_mm = controller.command(&window, &measured).offset_mm;
    }
}

/// An axis whose drive has no torque limit.
pub(super) fn axis(kd: f64, coulomb_friction_nm: f64) -> Parameters {
    Parameters {
        rad_per_mm: 0.6,
        kp_1_s: 50.0,
        kd,
        kv_nm_s_per_rad: 2.0,
        torque_limit_nm: f64::INFINITY,
        inertia_kg_m2: 0.01,
        viscous_friction_nm_s: 0.03,
        coulomb_friction_nm,
        coulomb_smoothing_rad_s: 0.05,
        ..Parameters::NOTHING
    }
}

/// A first-order speed loop of 200 rad/s, held exactly.
pub(super) fn sampled(kd: f64) -> SampledAxis {
    let alpha = libm::exp(-200.0 * SERVO_S);
    let gamma_s = (1.0 - alpha) / 200.0;
    SampledAxis {
        alpha,
        beta: 1.0 - alpha,
        gamma_s,
        delta_s: SERVO_S - gamma_s,
        kp_1_s: 50.0,
        kd,
    }
}

/// An axis that is nothing beside, whose mechanics period is a thousandth of the servo period.
pub(super) fn inverse(axis: Parameters) -> AxisInverse {
    let periods = Periods {
        servo_s: SERVO_S,
        mechanics_s: 1e-3 * SERVO_S,
        mechanics_per_servo: 1000,
    };
    AxisInverse::new(AxisModel::new(axis, periods))
}
