//! The machine in sentences: what is simulated of it, what is not, and what the controller was given of it.

use super::Job;
use crate::controllers::Knows;
use crate::machine::{Axis, Machine};
use crate::model::Model;

/// Whether an axis has something.
type Has = fn(&Axis) -> bool;

/// What an axis may have besides loops, inertia, viscous and Coulomb friction, and whether it has it.
const IMPERFECTIONS: [(&str, Has); 9] = [
    ("a disturbance torque", |axis| axis.disturbance_nm > 0.0),
    ("broadband torque noise", |axis| axis.torque_noise_nm > 0.0),
    ("cogging and ripple", |axis| axis.cogging_nm > 0.0 || axis.ripple > 0.0),
    ("friction that sticks", |axis| axis.stribeck_nm > 0.0 || axis.presliding_um > 0.0),
    ("encoder noise and steps", |axis| {
        axis.encoder_noise_um > 0.0 || axis.encoder_step_um > 0.0 || axis.interpolation_error_um > 0.0
    }),
    ("late drives", |axis| axis.drive_delay_s > 0.0 || axis.measurement_delay_s > 0.0),
    ("jitter", |axis| axis.jitter_s > 0.0),
    ("a ball screw that gives", |axis| axis.transmission.is_some()),
    ("errors of scale and pitch", |axis| axis.scale_um_m != 0.0 || axis.pitch_error_um > 0.0),
];

impl Job {
    /// The sentences. `axes` of the machine were simulated.
    pub(super) fn simulated(&self, axes: usize) -> Vec<String> {
        vec![machine(&self.machine, axes), self.given()]
    }

    /// What the controller that is judged was given of the machine.
    fn given(&self) -> String {
        let name = self.controller.name;
        match (self.model.as_ref().map(Model::about), self.controller.knows) {
            (Some(about), _) => format!("{name} goes by a model of {}, made on {}", about.source, about.date),
            (None, Knows::Nothing) => format!("{name} knows nothing of the machine"),
            (None, Knows::Identified) => format!(
                "{name} knows what a recording of this simulated machine shows and what its drives are set to; \
                 a real machine that differs from it comes out worse"
            ),
            (None, Knows::ExactModel) => {
                format!("{name} is given the exact parameters of the simulated machine, which nobody has of a real one")
            }
            (None, Knows::Everything) => {
                format!(
                    "{name} is given all that can be known of the simulated machine, the statistics of its noise, too"
                )
            }
            (None, Knows::EarlierLaps) => format!("{name} has cut the part before and knows what went wrong then"),
        }
    }
}

fn machine(machine: &Machine, axes: usize) -> String {
    let has = |(_, has): &&(&str, Has)| machine.axes.iter().take(axes).any(has);
    let named = |there: bool| {
        let names = IMPERFECTIONS.iter().filter(|entry| has(entry) == there).map(|(name, _)| *name);
        names.collect::<Vec<_>>().join(", ")
    };
    let loops: Vec<String> = ["X", "Y", "Z"]
        .iter()
        .zip(&machine.axes)
        .take(axes)
        .map(|(name, axis)| format!("{name} {}", axis.kp_1_s))
        .collect();
    let beside = if named(true).is_empty() { String::new() } else { format!(", with {}", named(true)) };
    let without = if named(false).is_empty() { String::new() } else { format!("{}, ", named(false)) };
    format!(
        "{}: {}. Simulated are its servo loops (position gain {} 1/s), inertia and friction{beside}; \
         not simulated: {without}cutting forces of a material, bending, heat",
        machine.name,
        machine.description,
        loops.join(", ")
    )
}
