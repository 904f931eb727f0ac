//! What a page asks for.

use feedwright::gcode::Program;
use feedwright::sim::{Machine, MachineError};
use feedwright::{CONTROLLERS, Entry};
use serde::Deserialize;

/// The outputs of a request, each as bytes.
pub(crate) type Outputs = Vec<Vec<u8>>;

/// What is to be done.
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

/// What is asked for.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Request {
    #[serde(default)]
    pub(crate) task: Task,
    /// What messages call the program.
    #[serde(default)]
    pub(crate) name: String,
    /// Its bytes, or those of a log: what was written into the room of `program`.
    #[serde(skip)]
    pub(crate) program: Vec<u8>,
    /// Name of a built-in machine, or the text of a machine file.
    #[serde(default)]
    pub(crate) machine: String,
    /// What messages call the machine file.
    #[serde(default = "machine_name")]
    pub(crate) machine_name: String,
    /// Name of the controller; none is the default.
    pub(crate) controller: Option<String>,
    /// Name of the control that a corrected program is for; none is the default.
    pub(crate) target: Option<String>,
    /// Largest contour error that is allowed, um.
    pub(crate) tolerance_um: Option<f64>,
    /// Seed of the recording that a controller identifies the machine from; 1 as in the command.
    #[serde(default = "first_seed")]
    pub(crate) seed: u64,
    /// The day, year-month-day, for the model that a log of the machine tells, as the command has
    /// it by default; none goes by the exact settings of the drives.
    pub(crate) recorded_on: Option<String>,
    /// Whether the rows are wanted.
    #[serde(default)]
    pub(crate) rows: bool,
    /// Whether the page of the report is wanted.
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
    /// Takes the program: it may be half of the memory.
    pub(crate) fn take_program(&mut self) -> Program {
        Program::from_text(self.name.clone(), std::mem::take(&mut self.program))
    }

    /// Whether the machine is a text, not a name.
    pub(crate) fn is_machine_text(&self) -> bool {
        self.machine.contains('\n')
    }

    /// The machine.
    ///
    /// # Errors
    /// A machine file with mistakes, and a name that no built-in machine has.
    pub(crate) fn machine(&self) -> Result<Machine, MachineError> {
        if self.is_machine_text() {
            return Machine::parse(&self.machine_name, &self.machine);
        }
        Machine::load(self.machine.as_ref())
    }

    /// The controller that is asked for; none is the default.
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

/// A number of a table, as the command prints it.
pub(crate) fn figure(value: f64, decimals: usize) -> String {
    if value.is_finite() {
        format!("{value:.decimals$}")
    } else {
        "-".to_owned()
    }
}

/// As JSON.
pub(crate) fn json(value: &serde_json::Value) -> Vec<u8> {
    value.to_string().into_bytes()
}
