//! Why there is no machine.

use feedwright_gcode::suggestion::nearest;
use miette::Diagnostic;
use thiserror::Error;

use super::BUILT_IN_MACHINES;
use crate::toml_file::{FileError, Kind};

/// A machine file, for messages.
pub(super) const KIND: Kind = Kind {
    name: "machine file",
    is: "a machine file is a page of TOML text, like crates/sim/machines/tnv40.toml",
    code: "machine::file",
    where_to_find: "'feedwright machines workshop --out my.toml' writes one to begin with; a name without .toml means a built-in \
                    machine",
};

/// Why there is no machine.
#[derive(Debug, Error, Diagnostic)]
pub enum MachineError {
    /// No built-in machine has this name.
    #[error("no machine is called '{name}'; there is {known}")]
    UnknownName {
        /// Name as it was given.
        name: String,
        /// Names of the built-in machines, for people.
        known: String,
        /// Remedy.
        #[help]
        hint: String,
    },
    /// The machine file cannot be read, is too large, is not text, or has faults.
    #[error(transparent)]
    #[diagnostic(transparent)]
    File(#[from] FileError),
}

impl MachineError {
    /// No such built-in machine; `is_file` when a file of that name stands in the current
    /// directory.
    pub(super) fn unknown_name(name: &str, is_file: bool) -> Self {
        let names: Vec<&str> = BUILT_IN_MACHINES.iter().map(|(name, _)| *name).collect();
        let hint = if is_file {
            format!("for the file of that name, write ./{name}")
        } else {
            match nearest(name, &names) {
                Some(near) => format!("did you mean '{near}'?"),
                None => {
                    "a machine of your own is a file: give its path, ending in .toml".to_owned()
                }
            }
        };
        Self::UnknownName {
            name: name.to_owned(),
            known: names.join(", "),
            hint,
        }
    }
}
