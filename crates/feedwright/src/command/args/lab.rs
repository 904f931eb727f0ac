//! Arguments of `feedwright lab`.

use std::ffi::OsString;

use clap::Args;

/// Everything goes to the laboratory as it is.
#[derive(Debug, Args)]
pub(crate) struct LabArgs {
    /// Command of the laboratory and its arguments; `feedwright lab --help` lists them.
    #[arg(
        value_name = "ARGUMENTS",
        trailing_var_arg = true,
        allow_hyphen_values = true
    )]
    pub(crate) arguments: Vec<OsString>,
}
