//! Requests of the page.

use feedwright::gcode::Program;
use feedwright::sim::{Machine, MachineError};
use feedwright::{CONTROLLERS, Entry};
use serde::Deserialize;

/// Outputs of a request, each as bytes.
pub(crate) type Outputs = Vec<Vec<u8>>;

/// Task of a request.
#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Task {
    /// Cut a program without a correction and with a controller.
    #[default]
    Run,
    /// Find the mistakes of a program, and its path.
    Check,
    /// Correct a program for a control without feedback.
    Correct,
    /// Identify the machine from its log, which stands in the place of a program.
    Identify,
    /// List machines, controllers and controls.
    Lists,
}

/// A request of the page.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Request {
    #[serde(default)]
    pub(crate) task: Task,
    /// Name of the program in messages.
    #[serde(default)]
    pub(crate) name: String,
    /// Bytes of the program or of the log: the content of the room of `program`.
    #[serde(skip)]
    pub(crate) program: Vec<u8>,
    /// Name of a built-in machine, or the text of a machine file.
    #[serde(default)]
    pub(crate) machine: String,
    /// Name of the machine file in messages.
    #[serde(default = "machine_name")]
    pub(crate) machine_name: String,
    /// Name of the controller; `None` selects the default.
    pub(crate) controller: Option<String>,
    /// Name of the control that a corrected program is for; `None` selects the default.
    pub(crate) target: Option<String>,
    /// Largest permitted contour error, um.
    pub(crate) tolerance_um: Option<f64>,
    /// Seed of the recording from which a controller identifies the machine; 1 as in the command.
    #[serde(default = "first_seed")]
    pub(crate) seed: u64,
    /// Date, year-month-day, of the model from a log of the machine, which the command makes by
    /// default. `None` uses the exact settings of the drives.
    pub(crate) recorded_on: Option<String>,
    /// True if the rows are requested.
    #[serde(default)]
    pub(crate) rows: bool,
    /// True if the page of the report is requested.
    #[serde(default)]
    pub(crate) page: bool,
}

const fn first_seed() -> u64 {
    1
}

fn machine_name() -> String {
    "machine".to_owned()
}

impl Request {
    /// Moves the program out of the request: it may take half of the memory.
    pub(crate) fn take_program(&mut self) -> Program {
        Program::from_text(self.name.clone(), std::mem::take(&mut self.program))
    }

    /// Returns true if the machine is a text, not a name.
    pub(crate) fn is_machine_text(&self) -> bool {
        self.machine.contains('\n')
    }

    /// Returns the machine.
    ///
    /// # Errors
    /// A machine file with mistakes, and a name that no built-in machine has.
    pub(crate) fn machine(&self) -> Result<Machine, MachineError> {
        if self.is_machine_text() {
            return Machine::parse(&self.machine_name, &self.machine);
        }
        Machine::load(self.machine.as_ref())
    }

    /// Returns the requested controller; `None` selects the default.
    ///
    /// # Errors
    /// A name that no controller has.
    pub(crate) fn controller(&self) -> miette::Result<Option<&'static Entry>> {
        let find = |name: &String| {
            CONTROLLERS
                .find(name)
                .ok_or_else(|| miette::miette!("no controller is called '{name}'"))
        };
        self.controller.as_ref().map(find).transpose()
    }
}

/// Returns a value as JSON, in bytes.
pub(crate) fn json(value: &serde_json::Value) -> Vec<u8> {
    value.to_string().into_bytes()
}
