//! The machine for which a correction is computed: it has only the effects that repeat from cut to
//! cut and are known.
//!
//! Loops, masses, friction and the ball screw stay. Random effects are left out, and so are effects
//! with an unknown phase or position: the disturbance, noise and steps of the encoder, jitter,
//! cogging and ripple. A program that compensates one phase of them adds an error to the next cut.
//! Geometry errors of the machine file are left out too: the tool is where the geometry that is
//! compensated puts it.

use feedwright_sim::{Axis, Machine, Noise, Squareness};

/// Returns the machine without the effects that do not repeat or are not known.
pub fn deterministic(machine: &Machine) -> Machine {
    let axis = |axis: &Axis| Axis {
        disturbance_nm: 0.0,
        disturbance_wander: 0.0,
        torque_noise_nm: 0.0,
        torque_bits: None,
        encoder_step_um: 0.0,
        encoder_noise_um: 0.0,
        interpolation_error_um: 0.0,
        jitter_s: 0.0,
        cogging_nm: 0.0,
        ripple: 0.0,
        scale_um_m: 0.0,
        pitch_error_um: 0.0,
        ..*axis
    };
    Machine {
        axes: machine.axes.iter().map(axis).collect(),
        geometry: Squareness::default(),
        tool: machine.compensated.clone(),
        noise: Noise::default(),
        ..machine.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use feedwright_control::Part;

    #[test]
    fn nothing_random_and_no_geometry_is_left_and_friction_is() {
        let machine = Machine::load("workshop".as_ref()).expect("built in");
        let nominal = deterministic(&machine);
        assert!(machine.is_noisy() && !nominal.is_noisy());
        assert_eq!(nominal.geometry, Squareness::default());
        for (was, is) in machine.axes.iter().zip(&nominal.axes) {
            assert_eq!(
                is.parameters().without(&[Part::Noise]),
                was.parameters().without(&[Part::Noise])
            );
            assert_eq!(
                (is.disturbance_nm, is.scale_um_m, is.cogging_nm),
                (0.0, 0.0, 0.0)
            );
        }
    }
}
