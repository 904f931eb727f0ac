//! `feedwright identify`: a model of a machine, trained and written.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use feedwright::controllers::{Choices, Setup};
use feedwright::machine::{self, Machine};
use feedwright::model::{Model, date, name};
use feedwright::output::{OutputError, OutputFile, OutputFiles};
use feedwright::watch::StageSteps;
use miette::Result;

use crate::args::IdentifyArgs;
use crate::console::Console;
use crate::controllers::{find, settings};
use crate::message::printed;

pub(crate) fn run(args: &IdentifyArgs, console: &Console) -> Result<ExitCode> {
    let controller = find(&args.controller)?;
    let set = settings(&args.set, Some(controller), &[controller])?;
    let choices = Choices { seed: args.seed, set };
    let machine = Machine::load(&args.machine)?;
    let input = PathBuf::from(&args.machine);
    let input = Some(input.as_path()).filter(|path| machine::is_path(path));
    let mut file = OutputFiles::new(input).start(&args.out)?;
    let date = date::today()?;
    let bar = console.bar(0);
    let mut steps = StageSteps::begin(&bar, &format!("identifying for {}", controller.name));
    let mut progress = |part: f64| steps.reach(part);
    let trained = Setup::new(&machine, &choices).telling(&mut progress).train(controller, usize::from(args.axes), date);
    bar.clear();
    let model = trained?;
    file.write_all(model.text().as_bytes()).map_err(|error| OutputError::from_io(error, &args.out))?;
    OutputFile::commit_all(vec![file], &bar)?;
    printed(print(&model, &args.out), ExitCode::SUCCESS)
}

fn print(model: &Model, place: &Path) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    let (kind, axes, fit) = (name(model.kind()), model.axes(), model.fit());
    writeln!(out, "{kind} identifier of {axes} axes, from {} samples: fits to {:.3} um RMS", fit.samples, fit.fit_um)?;
    writeln!(out, "wrote {}", place.display())
}
