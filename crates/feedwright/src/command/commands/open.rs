//! `feedwright open`: the page in a browser.

use std::fs::File;
use std::io::{self, ErrorKind, Write};
use std::path::Path;
use std::process::{Command, ExitCode, Stdio};

use feedwright_gcode::input::{self, is_standard_input};
use miette::{IntoDiagnostic, Report, Result, miette};

use crate::command::args::open::OpenArgs;
use crate::command::console::Console;
use crate::command::hal_watch::HalWatch;
use crate::command::message::{printed, remark};
use crate::command::page_server::{HAS_PAGE, PageServer};
use crate::command::streams::check_inputs;

pub(crate) fn run(args: OpenArgs, console: &Console) -> Result<ExitCode> {
    if !HAS_PAGE {
        let help = "run `web/page` in a clone (Node 20.19 or newer), then `cargo build --release`; the \
            packages have the page";
        return Err(miette!(
            help = help,
            "this feedwright was built without the page"
        ));
    }
    check_inputs(
        console,
        args.files
            .iter()
            .map(|file| ("the program", Some(file.as_path()))),
    )?;
    for file in args.files.iter().filter(|file| !is_standard_input(file)) {
        let opened = File::open(file).and_then(|file| file.metadata());
        let kind = opened.map_err(|error| miette!("cannot read {}: {error}", input::name(file)))?;
        if kind.is_dir() {
            return Err(miette!(
                help = "give the programs in it",
                "{} is a folder",
                input::name(file)
            ));
        }
    }
    let hal = args
        .hal
        .map(|units| HalWatch::start(units.mm()).map_err(no_halcmd))
        .transpose()?;
    let server = PageServer::bind(args.files, hal).into_diagnostic()?;
    let address = server.address();
    let mut out = io::stdout();
    let reported = writeln!(out, "{address}").and_then(|()| out.flush());
    if !args.no_browser && !show(&address) {
        remark("no browser was found: open the address above in one");
    }
    if !console.is_quiet() {
        remark("the page is for this computer only; Ctrl-C ends it");
    }
    server.serve();
    printed(reported, ExitCode::SUCCESS)
}

fn no_halcmd(error: io::Error) -> Report {
    if error.kind() == ErrorKind::NotFound {
        let help = "run this on the computer of the machine, where LinuxCNC is installed";
        return miette!(
            help = help,
            "there is no halcmd, which reads the pins of LinuxCNC"
        );
    }
    miette!("halcmd does not start: {error}")
}

/// Asks the desktop to show an address; false if it cannot.
fn show(address: &str) -> bool {
    let (program, first): (&str, &[&str]) = if cfg!(target_os = "windows") {
        ("rundll32", &["url.dll,FileProtocolHandler"])
    } else if cfg!(target_os = "macos") {
        ("open", &[])
    } else {
        ("xdg-open", &[])
    };
    let mut command = Command::new(Path::new(program));
    command
        .args(first)
        .arg(address)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    command.spawn().is_ok()
}
