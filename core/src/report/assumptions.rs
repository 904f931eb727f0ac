//! What was assumed of the machine that a run was simulated on.

use serde::Serialize;

/// What the figures of a run rest on. Nothing was cut: a real machine differs.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Assumptions {
    /// The machine file; none where the machine is built in.
    pub machine_file: Option<String>,
    /// Where its values come from.
    pub machine_source: String,
    /// What disturbs it; nothing where it is ideal.
    pub disturbed_by: Vec<&'static str>,
    /// Seed of what is random of that.
    pub noise_seed: u64,
    /// How the controller knows the law of the axes.
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
    /// The very parameters of the simulated machine, which nobody has of a real one.
    Exact,
    /// From earlier laps of the same part.
    Learned,
}
