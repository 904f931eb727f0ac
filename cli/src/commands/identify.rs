//! `feedwright identify`: a model of a machine, trained and written.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use feedwright::controllers::{Choices, Setup};
use feedwright::machine::{self, Machine};
use feedwright::model::{Model, date, name};
use feedwright::output::{OutputError, OutputFile};
use feedwright::pipeline::{Progress, Stage};
use miette::Result;

use crate::args::IdentifyArgs;
use crate::controllers::{find, settings};
use crate::message::printed;
use crate::progress::Bar;

pub(crate) fn run(args: &IdentifyArgs, quiet: bool) -> Result<ExitCode> {
    let controller = find(&args.controller)?;
    let set = settings(&args.set, Some(controller), &[controller])?;
    let choices = Choices { seed: args.seed, set };
    let machine = Machine::load(&args.machine)?;
    let input = PathBuf::from(&args.machine);
    let inputs: Vec<&Path> = [input.as_path()].into_iter().filter(|path| machine::is_path(path)).collect();
    let mut file = OutputFile::create(&args.out, &inputs)?;
    let date = date::today()?;
    let mut bar = Bar::of_job(quiet);
    bar.stage(Stage::Preparing { controller: controller.name });
    let mut told = |part: f64| bar.part(part);
    let trained = Setup::new(&machine, &choices).telling(&mut told).train(controller, usize::from(args.axes), date);
    bar.clear();
    let model = trained?;
    file.write_all(model.text().as_bytes()).map_err(|error| OutputError::from_io(error, &args.out))?;
    file.commit()?;
    printed(print(&model, &args.out), ExitCode::SUCCESS)
}

fn print(model: &Model, place: &Path) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    let (kind, axes, fit) = (name(model.kind()), model.axes(), model.fit());
    writeln!(out, "{kind} identifier of {axes} axes, from {} samples: fits to {:.3} um RMS", fit.samples, fit.fit_um)?;
    writeln!(out, "wrote {}", place.display())
}
