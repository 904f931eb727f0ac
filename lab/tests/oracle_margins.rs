//! Margins that the controller predicts for its loop, against those that are measured on it as it
//! runs.

use feedwright_control::{AxisModel, IDENTIFIED_WEIGHT, LqgIdentified, LqgSettings, OffsetBounds};
use feedwright_lab::margins::margins;
use feedwright_sim::Machine;

/// Ratio up to which both agree: the controller knows the integral and the torque filter of a drive
/// to first order.
const AGREE: f64 = 1.05;

/// Settings of `run` for a machine with this limit of the acceleration.
fn settings(machine: &Machine) -> LqgSettings {
    let bounds = OffsetBounds {
        largest_mm: 1.0,
        fastest_mm_s: 100.0,
        acceleration_mm_s2: machine.command_accel_mm_s2(),
    };
    LqgSettings::identified(IDENTIFIED_WEIGHT.default, machine.period.servo_s, bounds)
}

#[test]
fn the_predicted_margins_are_those_of_the_controller_as_it_runs() {
    for name in ["workshop", "stiff", "tnv40", "heavy"] {
        let machine = Machine::load(name.as_ref()).unwrap();
        let [model, _]: [AxisModel; 2] = machine.axis_model();
        // Without learning the loop keeps its gains.
        let settings = LqgSettings {
            learns: false,
            ..settings(&machine)
        };
        let [predicted] = LqgIdentified::<1>::new([model], settings).gains();
        let measured = margins(&machine, 0, model, settings);
        let ratios = [
            predicted.gain_margin / measured.gain,
            predicted.phase_margin_rad / measured.phase_rad,
        ];
        for ratio in ratios {
            assert!(
                ratio.max(1.0 / ratio) < AGREE,
                "{name}: {predicted:?}, {measured:?}"
            );
        }
    }
}

/// The filter assumes more noise than there is, with an exact model too.
#[test]
fn a_controller_that_learns_keeps_margins_on_machines_with_noise() {
    for (name, least) in [("workshop", [1.85, 37.0]), ("stiff", [3.0, 50.0])] {
        let machine = Machine::load(name.as_ref()).unwrap();
        let models: [AxisModel; 2] = machine.axis_model();
        for model in models {
            let [gains] = LqgIdentified::<1>::new([model], settings(&machine)).gains();
            let degrees = gains.phase_margin_rad.to_degrees();
            assert!(
                gains.gain_margin >= least[0] && degrees >= least[1],
                "{name}: {gains:?}"
            );
        }
    }
}
