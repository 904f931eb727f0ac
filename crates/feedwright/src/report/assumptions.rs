//! Assumptions about the machine that a run was simulated on.

use serde::Serialize;

/// Assumptions behind the figures of a run. Nothing was cut: a real machine differs.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Assumptions {
    /// Name of the machine.
    pub machine: String,
    /// Description of the machine.
    pub description: String,
    /// The machine file; none if the machine is built in.
    pub machine_file: Option<String>,
    /// Source of its values.
    pub machine_source: String,
    /// Position gains of the axes that were simulated, 1/s, as text.
    pub position_gains_1_s: Vec<String>,
    /// Disturbances of the machine; empty if it is ideal.
    pub disturbed_by: Vec<&'static str>,
    /// Effects that are simulated beside loops, inertia and friction.
    pub with: Vec<&'static str>,
    /// Effects that are not simulated.
    pub without: Vec<&'static str>,
    /// Seed of the random effects.
    pub noise_seed: u64,
    /// Name of the controller.
    pub controller: &'static str,
    /// Knowledge that the controller has of the axis model.
    pub axis_model: ModelKnowledge,
    /// Source of that knowledge, in words.
    pub model_from: String,
}

/// Knowledge that a controller has of the model of the axes that it corrects.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ModelKnowledge {
    /// The controller uses no model.
    #[default]
    None,
    /// Identified from recorded motion of the machine.
    Identified,
    /// The exact parameters of the simulated machine. For a real machine they are not available.
    Exact,
    /// Learned in earlier laps of the same part.
    Learned,
}

impl Assumptions {
    /// Returns a sentence on what was cut, with or without a measured run.
    pub(crate) const fn cut_sentence(measured: bool) -> &'static str {
        if measured {
            "Nothing was cut but what the log shows."
        } else {
            "Nothing was cut."
        }
    }

    /// Returns a sentence with the machine and the source of its values.
    pub(crate) fn machine_sentence(&self) -> String {
        let file = self
            .machine_file
            .as_ref()
            .map_or_else(|| "built in".to_owned(), |file| format!("file {file}"));
        format!(
            "the machine is {} ({file}; values: {})",
            self.machine, self.machine_source
        )
    }

    /// Returns a sentence with the disturbances of the machine.
    pub fn disturbance_sentence(&self) -> String {
        if self.disturbed_by.is_empty() {
            return "nothing disturbs it".to_owned();
        }
        format!(
            "it has {} (seed {})",
            self.disturbed_by.join(", "),
            self.noise_seed
        )
    }

    /// Returns a sentence with the effects that are simulated, and those that are not.
    pub(crate) fn simulation_sentence(&self) -> String {
        let listed = |names: &[&'static str]| {
            names
                .iter()
                .map(|name| format!("{name}, "))
                .collect::<String>()
        };
        let with: Vec<&str> = self
            .with
            .iter()
            .chain(&self.disturbed_by)
            .copied()
            .collect();
        let with = if with.is_empty() {
            String::new()
        } else {
            format!(", with {}", with.join(", "))
        };
        format!(
            "simulated are its servo loops (position gain {} 1/s), inertia and friction{with}; not simulated: {}cutting forces of a material, bending, heat",
            self.position_gains_1_s.join(", "),
            listed(&self.without)
        )
    }

    /// Returns a sentence with the axis model that the controller uses.
    pub(crate) fn model_sentence(&self) -> String {
        let Self {
            controller,
            axis_model,
            model_from,
            ..
        } = self;
        match axis_model {
            ModelKnowledge::None => {
                format!("{controller} uses no model of the axes ({model_from})")
            }
            ModelKnowledge::Identified => {
                format!(
                    "{controller} uses an identified model of the axes (from {model_from}); a real machine that differs from it comes out worse"
                )
            }
            ModelKnowledge::Exact => {
                format!("{controller} is given {model_from}, which nobody has of a real machine")
            }
            ModelKnowledge::Learned => format!("{controller} has learned from {model_from}"),
        }
    }
}
