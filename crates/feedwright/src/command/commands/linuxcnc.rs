//! `feedwright linuxcnc setup`: the correction, wired into a configuration of LinuxCNC.
use std::io::{self, Write};
use std::process::ExitCode;

use miette::Result;

use crate::command::args::linuxcnc::{LinuxcncArgs, LinuxcncCommand, LinuxcncSetupArgs};
use crate::command::console::Console;
use crate::command::message::{MISTAKES, printed};
use crate::command::streams::report_written;
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
    let reported = write!(out, "{}", wiring.text(|line| wrapped(line, 4)));
    let reported = reported.and_then(|()| match wiring.is_wired() {
        true => report_written(
            &mut out,
            wiring.written.iter().map(|path| Some(path.as_path())),
        ),
        false => writeln!(out, "Nothing was written."),
    });
    printed(
        reported,
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
    let reported = removed
        .iter()
        .try_for_each(|path| writeln!(out, "removed {}", path.display()));
    let reported = reported.and_then(|()| {
        kept.iter().try_for_each(|path| {
            writeln!(out, "kept {}, which was changed by hand", path.display())
        })
    });
    printed(reported, ExitCode::SUCCESS)
}
