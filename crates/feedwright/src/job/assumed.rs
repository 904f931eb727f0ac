//! What a job assumes of its machine.

use feedwright_control::{Knows, Part};
use feedwright_sim::Axis;

use super::Job;
use crate::controllers::CutsUncorrected;
use crate::report::{Assumptions, ModelKnowledge};

/// Tests an axis for one property.
type Has = fn(&Axis) -> bool;

/// Sources of disturbance of an axis, each with its test.
const DISTURBANCES: [(&str, Has); 8] = [
    ("encoder noise", |axis| axis.encoder_noise_um > 0.0),
    ("encoder steps", |axis| axis.encoder_step_um > 0.0),
    ("interpolation error", |axis| {
        axis.interpolation_error_um > 0.0
    }),
    ("torque noise", |axis| axis.torque_noise_nm > 0.0),
    ("cogging", |axis| axis.cogging_nm > 0.0),
    ("torque ripple", |axis| axis.ripple > 0.0),
    ("disturbance torque", |axis| axis.disturbance_nm > 0.0),
    ("late references", |axis| axis.jitter_s > 0.0),
];

/// Properties that an axis may have besides loops, inertia, viscous and Coulomb friction, each with
/// its test.
const IMPERFECTIONS: [(&str, Has); 4] = [
    ("friction that sticks", |axis| {
        axis.stribeck_nm > 0.0 || axis.presliding_um > 0.0
    }),
    ("late drives", |axis| axis.parameters().has(Part::Delays)),
    ("a ball screw that gives", |axis| {
        axis.transmission.is_some()
    }),
    ("errors of scale and pitch", |axis| {
        axis.scale_um_m != 0.0 || axis.pitch_error_um > 0.0
    }),
];

impl Job {
    /// Returns the assumptions behind the figures of its runs. `axes` of the machine were
    /// simulated. `unidentified` are the controllers for which nothing was identified.
    pub(super) fn assumptions(&self, axes: usize, unidentified: &[CutsUncorrected]) -> Assumptions {
        let (axis_model, model_from) = self.axis_model(unidentified);
        let simulated = &self.machine.axes[..axes.min(self.machine.axes.len())];
        let named = |table: &[(&'static str, Has)], there: bool| -> Vec<&'static str> {
            table
                .iter()
                .filter(|(_, has)| simulated.iter().any(has) == there)
                .map(|(name, _)| *name)
                .collect()
        };
        let gain = |(name, axis): (&str, &Axis)| format!("{name} {}", axis.kp_1_s);
        Assumptions {
            machine: self.machine.name.clone(),
            description: self.machine.description.clone(),
            machine_file: self.request.machine_file(),
            machine_source: self.machine.source.clone(),
            position_gains_1_s: ["X", "Y", "Z"]
                .into_iter()
                .zip(simulated)
                .map(gain)
                .collect(),
            disturbed_by: named(&DISTURBANCES, true),
            with: named(&IMPERFECTIONS, true),
            without: named(&IMPERFECTIONS, false)
                .into_iter()
                .chain(named(&DISTURBANCES, false))
                .collect(),
            noise_seed: self.machine.noise.seed,
            controller: self.controller.name,
            axis_model,
            model_from,
        }
    }

    /// Returns how the requested controller knows the model of the axes, and its source.
    fn axis_model(&self, unidentified: &[CutsUncorrected]) -> (ModelKnowledge, String) {
        match unidentified
            .iter()
            .find(|remark| remark.controller() == self.controller.name)
        {
            Some(CutsUncorrected::NothingIdentified { .. }) => {
                return (
                    ModelKnowledge::None,
                    "nothing could be identified".to_owned(),
                );
            }
            Some(CutsUncorrected::Unsuited { .. }) => {
                return (
                    ModelKnowledge::None,
                    "it does not suit this machine and cuts uncorrected".to_owned(),
                );
            }
            None => {}
        }
        if let Some(model) = &self.model {
            let about = model.about();
            let assumed = model.assumed().map(|assumed| format!("; {assumed}"));
            let assumed = assumed.unwrap_or_default();
            return (
                ModelKnowledge::Identified,
                format!("the model: {}, {}{assumed}", about.source, about.date),
            );
        }
        match self.controller.knows {
            Knows::Nothing => (ModelKnowledge::None, "it needs none".to_owned()),
            Knows::Identified => {
                let seed = self.choices.seed;
                (
                    ModelKnowledge::Identified,
                    format!("a simulated recording of this machine, seed {seed}"),
                )
            }
            Knows::ExactModel => (
                ModelKnowledge::Exact,
                "the parameters of the simulated machine".to_owned(),
            ),
            Knows::Everything => (
                ModelKnowledge::Exact,
                "the parameters of the simulated machine and of all that disturbs it".to_owned(),
            ),
            Knows::EarlierLaps => (
                ModelKnowledge::Learned,
                "earlier laps of the same part".to_owned(),
            ),
        }
    }
}
