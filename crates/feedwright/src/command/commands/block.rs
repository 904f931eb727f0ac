//! `feedwright block`: what a component in a servo thread reads.
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use feedwright_control::{KnownGeometry, ModelBlock, Trained};
use feedwright_ident::{Model, exact_block, identifier_name};
use feedwright_sim::{AXIS_NAMES, Machine, is_machine_path};
use miette::{Result, miette};

use crate::command::args::block::BlockArgs;
use crate::command::console::Console;
use crate::command::message::printed;
use crate::command::streams::{report_written, tables};
use crate::command::terminal::wrapped;
use crate::compensation::GeometryChoice;
use crate::output::{OutputError, OutputFile, OutputFiles};

pub(crate) fn run(args: &BlockArgs, console: &Console) -> Result<ExitCode> {
    let from = Path::new(&args.file);
    let is_model = from.to_string_lossy().ends_with(".model.toml");
    let choice = args.geometry.choice()?;
    let (bytes, axes, what, geometry) = if is_model {
        let model = Model::read(from)?;
        if args.axes.is_some_and(|axes| axes != model.axes()) {
            let hint = "identify the machine again with --axes";
            return Err(miette!(
                help = hint,
                "the model {} has {} axes",
                from.display(),
                model.axes()
            ));
        }
        let machine = args.machine.as_deref().map(Machine::load).transpose()?;
        let geometry = BlockGeometry::of(&choice, machine.as_ref())?;
        let assumed = model.assumed().map(|assumed| format!(" ({assumed})"));
        let kind = identifier_name(model.kind());
        let what = format!("the model of kind '{kind}'{}", assumed.unwrap_or_default());
        (
            model.block(geometry.known.as_ref()),
            model.axes(),
            what,
            geometry,
        )
    } else {
        if args.machine.is_some() {
            let hint = "leave --machine out: the geometry comes from the machine itself, or from --geometry";
            return Err(miette!(
                help = hint,
                "--machine goes with a model file (.model.toml), not with a machine"
            ));
        }
        let machine = Machine::load(&args.file)?;
        let axes = args.axes.unwrap_or(machine.axis_count());
        if axes > machine.axis_count() {
            let hint = "leave --axes out";
            return Err(miette!(
                help = hint,
                "the machine '{}' has {} axes",
                machine.name,
                machine.axis_count()
            ));
        }
        let geometry = BlockGeometry::of(&choice, Some(&machine))?;
        let what = format!("the machine '{}' with its own numbers", machine.name);
        (
            exact_block(&machine, axes, geometry.known.as_ref()),
            axes,
            what,
            geometry,
        )
    };
    let input = (is_model || is_machine_path(from)).then_some(from);
    let mut file = OutputFiles::new(input).start(&args.out)?;
    file.write_all(&bytes)
        .map_err(|error| OutputError::from_io(error, &args.out))?;
    OutputFile::commit_all(vec![file], &console.bar(0))?;
    let place = Some(args.out.as_path());
    let mut out = tables([place]);
    let reported = writeln!(out, "{what}, {axes} axes: {} bytes", bytes.len());
    let reported = reported.and_then(|()| writeln!(out, "{}", wrapped(&geometry.reported, 2)));
    let ringing = if axes == 2 {
        ringing::<2>(&bytes)
    } else {
        ringing::<3>(&bytes)
    };
    let reported = reported.and_then(|()| {
        ringing
            .iter()
            .try_for_each(|axis| writeln!(out, "{}", wrapped(&rings(axis), 2)))
    });
    printed(
        reported.and_then(|()| report_written(&mut *out, [place])),
        ExitCode::SUCCESS,
    )
}

/// Axes whose drives no command can follow.
fn ringing<const N: usize>(block: &[u8]) -> Vec<&'static str> {
    let Ok(Trained::Axes(known)) =
        ModelBlock::<N>::from_bytes(block).map(|block| block.model.trained)
    else {
        return vec![];
    };
    let axes = known.axes.into_iter().zip(AXIS_NAMES);
    axes.filter(|(axis, _)| !axis.is_followed())
        .map(|(_, name)| name)
        .collect()
}

/// Returns the warning about such an axis.
fn rings(axis: &str) -> String {
    format!(
        "axis {axis}: its drive has acceleration feedforward and hardly any velocity feedforward, by this model. A command that follows it rings: the component will \
         correct no axis, with cause 11. Tune the velocity feedforward of the drive and identify again; if the drive has no acceleration feedforward, say \
         so: --acceleration-feedforward 0"
    )
}

/// The geometry of a block, and the text that describes it.
struct BlockGeometry {
    known: Option<KnownGeometry<3>>,
    reported: String,
}

impl BlockGeometry {
    /// Selects the geometry from `choice` and the machine, if there is one.
    fn of(choice: &GeometryChoice, machine: Option<&Machine>) -> Result<Self> {
        let known = match (choice, machine) {
            (_, Some(machine)) => choice.on_any_part(machine)?.compensated.as_deref().cloned(),
            (GeometryChoice::File(file) | GeometryChoice::InProgram(file), None) => {
                file.geometry.check()?;
                Some(file.geometry.known()?)
            }
            (GeometryChoice::Off | GeometryChoice::Machine, None) => None,
        };
        // Lost motion alone is no matter of the component.
        let terms = choice.terms(machine).join(", ");
        let known = known.filter(|_| !terms.is_empty());
        let reported = match (choice, machine) {
            _ if known.as_ref().is_some_and(|known| known.backlash_mm() != [0.0; 3]) => {
                format!("geometry: {terms}. Backlash is left out: the component does not compensate it")
            }
            _ if known.is_some() => format!("geometry: {terms}"),
            (GeometryChoice::Off, _) => "geometry: none, as --no-geometry says".to_owned(),
            (_, None) => "geometry: none. A model file states none: name the machine with --machine, or a geometry file with --geometry".to_owned(),
            (_, Some(machine)) if machine.has_hidden_backlash() => {
                "geometry: none. An axis has backlash that its encoder does not see; --geometry FILE compensates all the same".to_owned()
            }
            _ => "geometry: none. The machine file states no errors".to_owned(),
        };
        Ok(Self { known, reported })
    }
}
