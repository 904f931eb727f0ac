//! What was assumed of the machine that a run was simulated on.

use serde::Serialize;

/// What the figures of a run rest on. Nothing was cut: a real machine differs.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Assumptions {
    /// Name of the machine.
    pub machine: String,
    /// What it is.
    pub description: String,
    /// The machine file; none where the machine is built in.
    pub machine_file: Option<String>,
    /// Where its values come from.
    pub machine_source: String,
    /// Position gains of the axes that were simulated, 1/s, as text.
    pub position_gains_1_s: Vec<String>,
    /// What disturbs it; nothing where it is ideal.
    pub disturbed_by: Vec<&'static str>,
    /// What else is simulated, beside loops, inertia and friction.
    pub with: Vec<&'static str>,
    /// What is not.
    pub without: Vec<&'static str>,
    /// Seed of what is random of that.
    pub noise_seed: u64,
    /// Name of the controller.
    pub controller: &'static str,
    /// How it knows the law of the axes.
    pub law: LawKnowledge,
    /// From what it knows it, in words.
    pub law_from: String,
}

/// How a controller knows the law of the axes that it corrects.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LawKnowledge {
    /// It goes by none.
    #[default]
    None,
    /// Identified from what the machine did.
    Identified,
    /// The exact parameters of the simulated machine. For a real machine they are not available.
    Exact,
    /// From earlier laps of the same part.
    Learned,
}

impl Assumptions {
    /// What was cut, with or without a run that was measured.
    pub const fn cut_sentence(measured: bool) -> &'static str {
        if measured {
            "Nothing was cut but what the log shows."
        } else {
            "Nothing was cut."
        }
    }

    /// Which machine it is, and where its values come from.
    pub fn machine_sentence(&self) -> String {
        let file = self
            .machine_file
            .as_ref()
            .map_or_else(|| "built in".to_owned(), |file| format!("file {file}"));
        format!(
            "the machine is {} ({file}; values: {})",
            self.machine, self.machine_source
        )
    }

    /// What disturbs it.
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

    /// What is simulated of it, and what is not.
    pub fn simulation_sentence(&self) -> String {
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

    /// What the controller goes by.
    pub fn law_sentence(&self) -> String {
        let Self {
            controller,
            law,
            law_from,
            ..
        } = self;
        match law {
            LawKnowledge::None => format!("{controller} goes by no law of the axes ({law_from})"),
            LawKnowledge::Identified => {
                format!(
                    "{controller} goes by an identified law of the axes (from {law_from}); a real machine that differs from it comes out worse"
                )
            }
            LawKnowledge::Exact => {
                format!("{controller} is given {law_from}, which nobody has of a real machine")
            }
            LawKnowledge::Learned => format!("{controller} has learned from {law_from}"),
        }
    }
}
