//! `feedwright-lab independent`: identification and controllers on machines of other equations.
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use feedwright::command::{Console, ConsoleTable, TableColumn, find, printed, tables, wrapped};
use feedwright::{BEST, Choices, OutputFiles};
use feedwright_sim::Machine;
use miette::{IntoDiagnostic, Result, WrapErr, miette};

use super::never_worse::{checked, found};
use crate::command::args::independent::IndependentArgs;
use crate::command::sweep::{code, write_json};
use crate::independent::{
    DEFAULT_CONTROLLERS, IndependentCut, IndependentOptions, IndependentResult, PROGRAMS,
    independent,
};
use crate::independent_plant::linearization::LinearPart;
use crate::independent_plant::machines::{INDEPENDENT_MACHINES, IndependentMachine};
use crate::never_worse::program::{Length, SweepProgram};
use crate::peers::CONTROLLERS;

pub(crate) fn run(args: &IndependentArgs, console: &Console) -> Result<ExitCode> {
    checked(args.limit_s)?;
    let (machines, options) = (machines(args)?, options(args)?);
    let files = match &args.programs[..] {
        [] => vec![],
        places => found(places)?,
    };
    let inputs: Vec<&Path> = files
        .iter()
        .chain(&args.excitation)
        .map(PathBuf::as_path)
        .collect();
    let mut outputs = OutputFiles::new(inputs);
    let json = args
        .json
        .as_ref()
        .map(|path| outputs.start(path))
        .transpose()?;
    let settings = args.reader.settings()?;
    let programs = |sheet: &Machine| -> Result<Vec<SweepProgram>> {
        let length = Length(sheet, args.limit_s);
        let of_text = |(name, text): &(&str, &str)| SweepProgram::from_text(name, text, length);
        let of_file = |file: &PathBuf| SweepProgram::read(file, &settings, length);
        let read: Result<_, _> = match &files[..] {
            [] => PROGRAMS.iter().map(of_text).collect(),
            files => files.iter().map(of_file).collect(),
        };
        Ok(read?)
    };
    let bar = console.bar(0);
    let results = independent(&machines, programs, &options, &bar);
    bar.clear();
    let results = results?;
    if let Some(file) = json {
        write_json(file, &results, console)?;
    }
    let out = &mut *tables([args.json.as_deref()]);
    let printing = results.iter().try_for_each(|result| print(result, out));
    let mut cuts = results.iter().flat_map(|result| &result.cuts);
    let is_worse = |cut: &IndependentCut| cut.row.controller == BEST && !cut.faults.is_empty();
    printed(printing, code(cuts.any(is_worse)))
}

/// Returns the requested machines.
fn machines(args: &IndependentArgs) -> Result<Vec<IndependentMachine>> {
    let names: Vec<&str> = if args.machine.is_empty() && args.random == 0 {
        INDEPENDENT_MACHINES.to_vec()
    } else {
        args.machine.iter().map(String::as_str).collect()
    };
    let named = |name: &&str| {
        let known = || {
            miette!(
                help = format!("choose one of {}", INDEPENDENT_MACHINES.join(", ")),
                "no machine {name}"
            )
        };
        IndependentMachine::named(name).ok_or_else(known)
    };
    let mut machines = names.iter().map(named).collect::<Result<Vec<_>>>()?;
    machines.extend(
        (0..args.random).map(|i| IndependentMachine::drawn(args.seed.wrapping_add(u64::from(i)))),
    );
    Ok(machines)
}

/// Reads the options of the identification and the cuts.
fn options(args: &IndependentArgs) -> Result<IndependentOptions> {
    let read = |path: &PathBuf| {
        let (name, text) = (path.display().to_string(), std::fs::read_to_string(path));
        Ok::<_, miette::Report>((name.clone(), text.into_diagnostic().wrap_err(name)?))
    };
    let excitation = args.excitation.as_ref().map(read).transpose()?;
    let named: Vec<&str> = match &args.controller[..] {
        [] => DEFAULT_CONTROLLERS.to_vec(),
        named => named.iter().map(String::as_str).collect(),
    };
    let controllers = named.into_iter().map(|name| find(name, CONTROLLERS));
    Ok(IndependentOptions {
        excitation,
        record_delay_s: (!args.open_delay).then_some(0.0),
        controllers: controllers.collect::<Result<_>>()?,
        choices: Choices {
            seed: args.seed,
            ..Choices::default()
        },
    })
}

/// Prints the identified values of a machine, and its cuts.
fn print(result: &IndependentResult, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "{}", result.machine.name)?;
    if let Some(refused) = &result.refused {
        return writeln!(
            out,
            "{}",
            wrapped(&format!("  not identified: {refused}"), 2)
        );
    }
    for axis in &result.axes {
        writeln!(
            out,
            "{}",
            wrapped(&format!("  {}: {}", axis.name, axis.verdict), 4)
        )?;
    }
    let columns = [
        "found / plant",
        "Kp Kv/J 1/s2",
        "(Kv+B)/J 1/s",
        "feedforward",
        "delay ms",
        "lag ms",
    ];
    let mut table = ConsoleTable::new(columns.map(TableColumn::new).into());
    for axis in &result.axes {
        let pair = |digits: usize, of: fn(&LinearPart) -> f64| {
            let [found, plant] = [&axis.found, &axis.plant].map(of);
            format!("{found:.digits$} / {plant:.digits$}")
        };
        table.row(vec![
            axis.name.clone(),
            pair(0, |axis| axis.gain_product_1_s2),
            pair(1, |axis| axis.speed_loop_1_s),
            pair(3, |axis| axis.velocity_feedforward),
            pair(2, |axis| 1e3 * (axis.command_delay_s + axis.loop_delay_s)),
            pair(2, |axis| 1e3 * axis.lag_s),
        ]);
    }
    table.print(out)?;
    print_cuts(result, out)
}

/// RMS / largest error of the cuts of a machine.
fn print_cuts(result: &IndependentResult, out: &mut dyn Write) -> io::Result<()> {
    let mut table = ConsoleTable::new(vec![
        TableColumn::new("RMS / max um"),
        TableColumn::new("encoders"),
        TableColumn::new("ratio"),
        TableColumn::new("tool"),
        TableColumn::new("ratio"),
        TableColumn::optional("engaged", 1),
        TableColumn::optional("worse in", 2),
    ]);
    let both = |[rms_um, max_um]: [f64; 2]| format!("{rms_um:.2} / {max_um:.1}");
    let mut program = "";
    for cut in &result.cuts {
        let [before, after] = [&cut.row.uncorrected, &cut.row.corrected];
        let [tool_before, tool_after] =
            [before, after].map(|figures| [figures.rms_um, figures.max_um]);
        let [seen_before, seen_after] = cut.encoders_um;
        if program != cut.row.program {
            program = &cut.row.program;
            let mut cells = vec![String::new(); 7];
            cells[0] = format!("{program}, uncorrected");
            (cells[1], cells[3]) = (both(seen_before), both(tool_before));
            table.row(cells);
        }
        let ratio = |before: f64, after: f64| format!("{:.3}", after / before.max(1e-3));
        let engaged = after
            .engaged_share
            .map_or(String::new(), |share| format!("{share:.2}"));
        let faults: Vec<&str> = cut.faults.iter().map(|fault| fault.name()).collect();
        table.row(vec![
            format!("  {}", cut.row.controller),
            both(seen_after),
            ratio(seen_before[0], seen_after[0]),
            both(tool_after),
            ratio(tool_before[0], tool_after[0]),
            engaged,
            faults.join(", "),
        ]);
        for why in cut.without_model.iter().chain(&after.lost) {
            table.remark(why.clone());
        }
    }
    table.print(out)?;
    writeln!(out)
}
