//! What a job assumes of its machine.

use super::Job;
use crate::controllers::{Knows, NothingIdentified};
use crate::gcode::input;
use crate::machine::{Axis, Machine};
use crate::report::{Assumptions, LawKnowledge};

/// Whether something disturbs an axis.
type Disturbs = fn(&Axis) -> bool;

/// What can disturb an axis, and whether it does.
const DISTURBANCES: [(&str, Disturbs); 8] = [
    ("encoder noise", |axis| axis.encoder_noise_um > 0.0),
    ("encoder steps", |axis| axis.encoder_step_um > 0.0),
    ("interpolation error", |axis| axis.interpolation_error_um > 0.0),
    ("torque noise", |axis| axis.torque_noise_nm > 0.0),
    ("cogging", |axis| axis.cogging_nm > 0.0),
    ("torque ripple", |axis| axis.ripple > 0.0),
    ("disturbance torque", |axis| axis.disturbance_nm > 0.0),
    ("late references", |axis| axis.jitter_s > 0.0),
];

impl Job {
    /// What the figures of its runs rest on; `unidentified` are the controllers that nothing was identified for.
    pub(super) fn assumptions(&self, unidentified: &[NothingIdentified]) -> Assumptions {
        let (law, law_from) = self.law(unidentified);
        Assumptions {
            machine_file: self.machine_file.as_deref().map(input::name),
            machine_source: self.machine.source.clone(),
            disturbed_by: disturbances(&self.machine),
            noise_seed: self.machine.noise.seed,
            law,
            law_from,
        }
    }

    /// How the controller that is asked for knows the law of the axes, and from what.
    fn law(&self, unidentified: &[NothingIdentified]) -> (LawKnowledge, String) {
        if unidentified.iter().any(|remark| remark.controller == self.controller.name) {
            return (LawKnowledge::None, "nothing could be identified".to_owned());
        }
        if let Some(about) = self.model.as_ref().map(|model| model.about()) {
            return (LawKnowledge::Identified, format!("the model file: {}, {}", about.source, about.date));
        }
        match self.controller.knows {
            Knows::Nothing => (LawKnowledge::None, "it needs none".to_owned()),
            Knows::Identified => {
                let seed = self.choices.seed;
                (LawKnowledge::Identified, format!("a simulated recording of this machine, seed {seed}"))
            }
            Knows::ExactModel => (LawKnowledge::Exact, "the parameters of the simulated machine".to_owned()),
            Knows::Everything => {
                (LawKnowledge::Exact, "the parameters of the simulated machine and of all that disturbs it".to_owned())
            }
            Knows::EarlierLaps => (LawKnowledge::Learned, "earlier laps of the same part".to_owned()),
        }
    }
}

fn disturbances(machine: &Machine) -> Vec<&'static str> {
    let acts = |(_, is_there): &&(&str, Disturbs)| machine.axes.iter().any(is_there);
    DISTURBANCES.iter().filter(acts).map(|(name, _)| *name).collect()
}
