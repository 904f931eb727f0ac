//! The `feedwright-lab` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    feedwright_lab::command::main()
}
