//! `feedwright identify`: a model of a machine, trained and written; its machine file from a log;
//! its geometry from measurements.

mod from_log;
mod from_measurement;
use std::f64::consts::TAU;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use feedwright_control::{Parameters, Part};
use feedwright_ident::{AxisEstimate, Model, identifier_name};
use feedwright_sim::{Machine, is_machine_path, significant};
use miette::Result;

use crate::command::args::identify::IdentifyArgs;
use crate::command::console::Console;
use crate::command::date::today;
use crate::command::message::printed;
use crate::command::streams::{report_written, tables};
use crate::command::table::{ConsoleTable, TableColumn};
use crate::controllers::{CONTROLLERS, Choices, Setup, identifying};
use crate::output::{OutputError, OutputFile, OutputFiles};
use crate::request::named::{find, settings};

pub(crate) fn run(args: &IdentifyArgs, console: &Console) -> Result<ExitCode> {
    if !args.of_geometry.geometry.is_empty() {
        return from_measurement::run(args, console);
    }
    // Without --out there is --update, which belongs to a log.
    let Some(out) = args.out.as_deref().filter(|_| args.log.is_empty()) else {
        return from_log::run(&args.log, args, console);
    };
    let controller = find(&args.controller, CONTROLLERS)?;
    let set = settings(&args.set, CONTROLLERS, Some(controller), &[controller])?;
    let choices = Choices {
        seed: args.seed,
        set,
        ..Choices::default()
    };
    let machine = Machine::load(&args.machine)?;
    let input = PathBuf::from(&args.machine);
    let input = Some(input.as_path()).filter(|path| is_machine_path(path));
    let mut file = OutputFiles::new(input).start(out)?;
    let date = today()?;
    let bar = console.bar(0);
    let mut steps = identifying(&machine, &bar);
    let mut progress = |part: f64| steps.reach(part);
    let mut setup = Setup::new(&machine, &choices).reporting(&mut progress);
    let trained = setup.train(controller, usize::from(args.axes), date);
    let found = setup
        .found()
        .and_then(|found| found.as_ref().ok())
        .cloned()
        .unwrap_or_default();
    bar.clear();
    let model = trained?;
    file.write_all(model.text().as_bytes())
        .map_err(|error| OutputError::from_io(error, out))?;
    OutputFile::commit_all(vec![file], &bar)?;
    printed(print(&model, &found, &machine, out), ExitCode::SUCCESS)
}

fn print(
    model: &Model,
    found: &[AxisEstimate],
    machine: &Machine,
    place: &Path,
) -> std::io::Result<()> {
    let mut out = tables([Some(place)]);
    let (kind, axes, fit) = (identifier_name(model.kind()), model.axes(), model.fit());
    writeln!(
        out,
        "{kind} identifier of {axes} axes, from {} samples: fits to {:.3} um RMS",
        fit.samples, fit.fit_um
    )?;
    if !found.is_empty() {
        print_axes(&mut *out, found, machine)?;
    }
    report_written(&mut *out, [Some(place)])
}

/// Prints the estimated parameters of each axis, with standard errors.
fn print_axes(
    out: &mut dyn Write,
    found: &[AxisEstimate],
    machine: &Machine,
) -> std::io::Result<()> {
    let names = ["x", "y", "z"]
        .into_iter()
        .take(found.len())
        .map(TableColumn::new);
    let mut table = ConsoleTable::new(std::iter::once(TableColumn::new("")).chain(names).collect());
    let um_per_rad = |i: usize| machine.axes[i].lead_mm_per_rev * 1e3 / TAU;
    type Value = fn(&Parameters, f64) -> f64;
    let rows: [(&str, Value); 9] = [
        ("inertia, kg m2", |p, _| p.inertia_kg_m2),
        ("viscous, N m s/rad", |p, _| p.viscous_friction_nm_s),
        ("Coulomb, N m", |p, _| p.coulomb_friction_nm),
        ("asymmetry, N m", |p, _| p.coulomb_asymmetry_nm),
        ("presliding, um", |p, um_per_rad| {
            p.presliding_rad * um_per_rad
        }),
        ("resonance, Hz", |p, _| p.resonance_rad_s / TAU),
        ("its damping ratio", |p, _| p.damping_ratio),
        ("share of the table", |p, _| p.table_share),
        ("backlash, um", |p, um_per_rad| p.backlash_rad * um_per_rad),
    ];
    let of_screw = |label: &str| rows[5..].iter().any(|(of_screw, _)| *of_screw == label);
    let gives = found.iter().any(|axis| axis.parameters.has(Part::Screw));
    for (label, value) in rows
        .into_iter()
        .filter(|(label, _)| gives || !of_screw(label))
    {
        let cell = |(i, axis): (usize, &AxisEstimate)| {
            let [found, error] =
                [&axis.parameters, &axis.standard_errors].map(|of| value(of, um_per_rad(i)));
            format!(
                "{} +- {}",
                significant(found, 3, 2),
                significant(error, 3, 2)
            )
        };
        table.row(
            std::iter::once(label.to_owned())
                .chain(found.iter().enumerate().map(cell))
                .collect(),
        );
    }
    let left = found.iter().map(|axis| significant(axis.left_um, 3, 2));
    table.row(
        std::iter::once("left, um RMS".to_owned())
            .chain(left)
            .collect(),
    );
    table.print(out)?;
    writeln!(
        out,
        "left: what the identified model leaves of the measured position"
    )
}
