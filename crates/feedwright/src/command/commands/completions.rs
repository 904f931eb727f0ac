//! `feedwright completions`: the completion script of a shell.
use std::io::Write;
use std::process::ExitCode;

use clap::CommandFactory;
use miette::Result;

use crate::command::args::Cli;
use crate::command::args::completions::CompletionsArgs;
use crate::command::console::Console;
use crate::command::message::printed;
use crate::command::streams::{report_written, tables};
use crate::output::{OutputError, OutputFile, OutputFiles};

pub(crate) fn run(args: &CompletionsArgs, console: &Console) -> Result<ExitCode> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "feedwright", &mut script);
    let mut file = OutputFiles::default().start(&args.out)?;
    file.write_all(&script)
        .map_err(|error| OutputError::from_io(error, &args.out))?;
    OutputFile::commit_all(vec![file], &console.bar(0))?;
    let out = Some(args.out.as_path());
    printed(report_written(&mut tables([out]), [out]), ExitCode::SUCCESS)
}
