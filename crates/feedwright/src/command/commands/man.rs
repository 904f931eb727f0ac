//! `feedwright man`: the manual pages, one for each command.
use std::process::ExitCode;

use clap::{Command, CommandFactory};
use clap_mangen::Man;
use miette::Result;

use crate::command::args::Cli;
use crate::command::args::help::with_all_options;
use crate::command::args::man::ManArgs;
use crate::command::console::Console;
use crate::command::message::printed;
use crate::command::streams::make_folder;
use crate::output::{OutputError, OutputFile, OutputFiles};

pub(crate) fn run(args: &ManArgs, console: &Console) -> Result<ExitCode> {
    make_folder(&args.out)?;
    let mut root = with_all_options(Cli::command()).disable_help_subcommand(true);
    root.build();
    let commands = root.get_subcommands().map(|command| {
        let name = format!("{}-{}", root.get_name(), command.get_name());
        // The page is called as its command is, with a dash.
        command.clone().name(name.clone()).display_name(name)
    });
    let pages: Vec<Command> = std::iter::once(root.clone()).chain(commands).collect();
    let (mut files, mut complete) = (OutputFiles::default(), Vec::new());
    for page in pages {
        let path = args.out.join(format!("{}.1", page.get_name()));
        let mut file = files.start(&path)?;
        Man::new(page)
            .render(&mut file)
            .map_err(|error| OutputError::from_io(error, &path))?;
        complete.push(file);
    }
    let count = complete.len();
    OutputFile::commit_all(complete, &console.bar(0))?;
    let mut out = std::io::stdout().lock();
    let reported = std::io::Write::write_fmt(
        &mut out,
        format_args!("wrote {count} pages in {}\n", args.out.display()),
    );
    printed(reported, ExitCode::SUCCESS)
}
