//! `feedwright linuxcnc setup`: the correction, wired into a configuration of LinuxCNC.
use std::io::{self, Write};
use std::process::ExitCode;

use miette::Result;

use crate::command::args::linuxcnc::{LinuxcncArgs, LinuxcncCommand, LinuxcncSetupArgs};
use crate::command::console::Console;
use crate::command::message::{MISTAKES, printed};
use crate::command::streams::tell_written;
use crate::command::terminal::wrapped;
use crate::linuxcnc_setup::LinuxcncSetup;

pub(crate) fn run(args: &LinuxcncArgs, console: &Console) -> Result<ExitCode> {
    let LinuxcncCommand::Setup(args) = &args.command;
    let LinuxcncSetupArgs {
        ini,
        hallib,
        simulate,
        raise_ferror,
        replace,
        ..
    } = args;
    let setup = LinuxcncSetup {
        ini: ini.clone(),
        hallib: hallib.clone(),
        simulate: simulate.clone(),
        raise_ferror: *raise_ferror,
        replace: *replace,
    };
    if args.undo {
        return undo(&setup);
    }
    let wiring = if args.dry_run {
        setup.survey()?
    } else {
        setup.wire(&console.bar(0))?
    };
    let mut out = io::stdout().lock();
    let told = write!(out, "{}", wiring.text(|line| wrapped(line, 4)));
    let told = told.and_then(|()| match wiring.is_wired() {
        true => tell_written(
            &mut out,
            wiring.written.iter().map(|path| Some(path.as_path())),
        ),
        false => writeln!(out, "Nothing was written."),
    });
    printed(
        told,
        if wiring.is_wired() {
            ExitCode::SUCCESS
        } else {
            ExitCode::from(MISTAKES)
        },
    )
}

fn undo(setup: &LinuxcncSetup) -> Result<ExitCode> {
    let [removed, kept] = setup.undo()?;
    let mut out = io::stdout().lock();
    let told = removed
        .iter()
        .try_for_each(|path| writeln!(out, "removed {}", path.display()));
    let told = told.and_then(|()| {
        kept.iter().try_for_each(|path| {
            writeln!(out, "kept {}, which was changed by hand", path.display())
        })
    });
    printed(told, ExitCode::SUCCESS)
}
