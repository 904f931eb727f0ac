//! `feedwright identify --geometry FILE`: the geometry file of a machine.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use feedwright_gcode::input;
use feedwright_ident::{
    FoundGeometry, GeometryInput, comp_file, fit_geometry, geometry_of_tables, sampled_table,
};
use feedwright_sim::{AXIS_NAMES, GeometryFile, Machine, is_machine_path, to_four_digits};
use miette::{IntoDiagnostic, Result, miette};

use crate::command::args::identify::{AxisFile, IdentifyArgs};
use crate::command::console::Console;
use crate::command::message::printed;
use crate::command::streams::{check_inputs, report_written, tables};
use crate::command::terminal::wrapped;
use crate::output::{OutputError, OutputFile, OutputFiles};
use crate::results_format::{stamped, write_json};

pub(super) fn run(args: &IdentifyArgs, console: &Console) -> Result<ExitCode> {
    let measured = &args.of_geometry.geometry;
    // Clap asks for it.
    let out = args.out.as_deref().unwrap_or(Path::new("geometry.toml"));
    check_inputs(
        console,
        measured
            .iter()
            .map(|of| ("--geometry", Some(of.path.as_path()))),
    )?;
    let machine = Machine::load(&args.machine)?;
    let machine_path = Some(PathBuf::from(&args.machine)).filter(|path| is_machine_path(path));
    let inputs: Vec<PathBuf> = measured
        .iter()
        .map(|of| of.path.clone())
        .chain(machine_path)
        .collect();
    let found = found(measured, &machine)?;
    // Whatever was found, the file is one that reads back.
    let text = found.file.text();
    GeometryFile::parse(&out.display().to_string(), &text)?;
    let mut texts = vec![(out, text.into_bytes())];
    if let Some(path) = &args.of_log.json {
        let mut text = Vec::new();
        write_json(&mut text, &stamped(found.json())).into_diagnostic()?;
        texts.push((path, text));
    }
    for AxisFile { axis, path } in &args.of_geometry.comp_file {
        let axis = axis.ok_or_else(|| {
            miette!(
                help = "write --comp-file x=FILE",
                "which axis {} is for is not said",
                path.display()
            )
        })?;
        let table = sampled_table(&found.file, axis).ok_or_else(|| {
            miette!(
                help = "measure that axis, too",
                "nothing was measured of {}: {} is not written",
                AXIS_NAMES[axis],
                path.display()
            )
        })?;
        texts.push((
            path,
            comp_file(&table, args.of_geometry.comp_type).into_bytes(),
        ));
    }
    let mut files = OutputFiles::new(inputs.iter().map(PathBuf::as_path));
    let written = |(path, text): &(&Path, Vec<u8>)| -> Result<OutputFile, OutputError> {
        let mut file = files.start(path)?;
        file.write_all(text)
            .map_err(|error| OutputError::from_io(error, path))?;
        Ok(file)
    };
    let all: Vec<OutputFile> = texts.iter().map(written).collect::<Result<_, _>>()?;
    OutputFile::commit_all(all, &console.bar(0))?;
    let places: Vec<&Path> = texts.iter().map(|(path, _)| *path).collect();
    printed(print(&found, &places), ExitCode::SUCCESS)
}

/// The geometry of all files.
fn found(measured: &[AxisFile], machine: &Machine) -> Result<FoundGeometry> {
    let (mut sets, mut tables, mut names) = (Vec::new(), Vec::new(), Vec::new());
    for AxisFile { axis, path } in measured {
        let name = input::name(path);
        let text = input::read(path).map_err(|error| {
            miette!(
                help = "a measurement is a text file: see docs/measure-geometry.md",
                "cannot read {name}: {error}"
            )
        })?;
        match GeometryInput::parse(&name, &String::from_utf8_lossy(&text), *axis)? {
            GeometryInput::Sets(of_file) => sets.extend(of_file),
            GeometryInput::Table(axis, rows, _) => tables.push((axis, rows)),
        }
        names.push(
            path.file_name()
                .map_or(name.clone(), |name| name.to_string_lossy().into_owned()),
        );
    }
    if !sets.is_empty() && !tables.is_empty() {
        return Err(miette!(
            help = "give either the compensation files, or measurements that were made with the compensation switched off",
            "a compensation file says what a control adds already, and cannot be fitted together with a measurement"
        ));
    }
    for (number, set) in sets.iter_mut().enumerate() {
        set.name = format!("{} {} {}", set.kind, set.axes, number + 1);
    }
    let source = format!("{}, on {}", names.join(", "), machine.name);
    if tables.is_empty() {
        Ok(fit_geometry(sets, &machine.axes, &source)?)
    } else {
        Ok(geometry_of_tables(tables, &source)?)
    }
}

fn print(found: &FoundGeometry, places: &[&Path]) -> std::io::Result<()> {
    let places = || places.iter().map(|path| Some(*path));
    let mut out = tables(places());
    for line in found.lines() {
        writeln!(out, "{}", wrapped(&line, 2))?;
    }
    let check = found.check;
    let [before_um, after_um] = [check.before_um, check.after_um].map(to_four_digits);
    writeln!(
        out,
        "the geometry leaves {after_um} um RMS of {before_um} um in {} values",
        check.rows
    )?;
    report_written(&mut *out, places())
}
