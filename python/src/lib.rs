//! feedwright as a module of Python: `feedwright._feedwright`, which the package `feedwright`
//! wraps.
//!
//! | File | Content |
//! |---|---|
//! | `fault.rs` | errors as exceptions, with line and column |
//! | `watched.rs` | a job on a thread of its own, with progress and Ctrl-C |
//! | `files.rs` | programs and machines |
//! | `columns.rs` | rows of a cut as arrays |
//! | `jobs.rs` | run, correct, advise, plan, identify |
//! | `lab.rs` | controllers and terms of the plant in Python |
//! | `sweeps.rs` | jobs of sweeps, tables of their results |
//!
//! Figures are returned as JSON, as the command writes them. Rows are returned as arrays of numpy
//! that own their memory, so that nothing is copied.

mod fault;
mod watched;
mod files;
mod columns;
mod jobs;
mod lab;
mod sweeps;

use std::ffi::OsString;
use std::process::ExitCode;

use pyo3::prelude::*;

/// The module.
#[pymodule]
mod _feedwright {
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::fault::FeedwrightError;
    #[pymodule_export]
    use super::files::{
        MotionOfProgram, MotionsOfProgram, PythonMachine, PythonProgram, check, lists,
    };
    #[pymodule_export]
    use super::jobs::{advise, correct, identify, plan, run};
    #[cfg(feature = "peers")]
    #[pymodule_export]
    use super::lab::held_out::searched_settings;
    #[pymodule_export]
    use super::lab::held_out::{held_out_machine, held_out_program, tables_page};
    #[pymodule_export]
    use super::lab::{MeasuredTool, PythonWindow, episode::Episode, run_with};
    #[pymodule_export]
    use super::main;
    #[pymodule_export]
    use super::sweeps::{PythonJobList, do_python_job, job_address, merge};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}

/// Runs the command `feedwright` and returns its exit code.
#[pyfunction]
fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    let code = py.detach(|| feedwright::command::main_of(&arguments));
    (0..=u8::MAX)
        .find(|&number| ExitCode::from(number) == code)
        .unwrap_or(u8::MAX)
}
