//! `feedwright block`: what a component in a servo thread reads.
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use feedwright_ident::{Model, exact_block};
use feedwright_sim::{Machine, is_machine_path};
use miette::{Result, miette};

use crate::command::args::block::BlockArgs;
use crate::command::console::Console;
use crate::command::message::printed;
use crate::command::streams::{tables, tell_written};
use crate::output::{OutputError, OutputFile, OutputFiles};

pub(crate) fn run(args: &BlockArgs, console: &Console) -> Result<ExitCode> {
    let from = Path::new(&args.file);
    let is_model = from.to_string_lossy().ends_with(".model.toml");
    let (bytes, axes, what) = if is_model {
        let model = Model::read(from)?;
        if args.axes.is_some_and(|axes| axes != model.axes()) {
            let hint = "identify the machine again with --axes";
            return Err(miette!(help = hint, "the model {} has {} axes", from.display(), model.axes()));
        }
        (
            model.block(),
            model.axes(),
            format!("the model of kind '{}'", feedwright_ident::identifier_name(model.kind())),
        )
    } else {
        let machine = Machine::load(&args.file)?;
        let axes = args.axes.unwrap_or(machine.axis_count());
        if axes > machine.axis_count() {
            let hint = "leave --axes out";
            return Err(miette!(help = hint, "the machine '{}' has {} axes", machine.name, machine.axis_count()));
        }
        (exact_block(&machine, axes), axes, format!("the machine '{}' with its own numbers", machine.name))
    };
    let input = (is_model || is_machine_path(from)).then_some(from);
    let mut file = OutputFiles::new(input).start(&args.out)?;
    file.write_all(&bytes).map_err(|error| OutputError::from_io(error, &args.out))?;
    OutputFile::commit_all(vec![file], &console.bar(0))?;
    let place = Some(args.out.as_path());
    let mut out = tables([place]);
    let told = writeln!(out, "{what}, {axes} axes: {} bytes", bytes.len());
    printed(told.and_then(|()| tell_written(&mut *out, [place])), ExitCode::SUCCESS)
}
