//! Which geometry of a machine its control compensates.

use feedwright_sim::{CompensationError, Machine};
use serde::{Deserialize, Serialize};

/// What is known of the errors that no encoder sees: scale, pitch and squareness.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Compensation {
    /// Nothing is compensated.
    Off,
    /// What the machine file states.
    #[default]
    Machine,
}

impl Compensation {
    /// The machine with a control that compensates it.
    ///
    /// # Errors
    /// A geometry that is out of its range.
    pub fn on(self, machine: &Machine) -> Result<Machine, CompensationError> {
        match self {
            Self::Off => Ok(Machine { compensated: None, ..machine.clone() }),
            Self::Machine => machine.compensating_own(),
        }
    }
}
