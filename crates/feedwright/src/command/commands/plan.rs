//! `feedwright plan`: the cycle time of a program, and what binds it.

mod bound;

use std::collections::BTreeMap;
use std::io::{BufRead, Write};
use std::process::ExitCode;
use std::time::Instant;

use feedwright_gcode::suggestion::nearest;
use feedwright_gcode::{Program, visible};
use feedwright_plan::{Constraints, FEED_PLANNERS, MOST_OVERRIDE, feed_planner};
use feedwright_sim::cycle_time::along::BindingStretch;
use feedwright_sim::cycle_time::{
    CycleTime, CycleTimeOptions, LineTime, cycle_time_by, limit_names,
};
use feedwright_sim::{Machine, Stages, path_steps, shown};
use miette::{IntoDiagnostic, Result, miette};
use serde::Serialize;
use serde_json::json;

use crate::command::args::plan::PlanArgs;
use crate::command::console::Console;
use crate::command::date::today;
use crate::command::message::{printed, remark, report_assumed_limits, warn};
use crate::command::progress::Bar;
use crate::command::streams::{check_request, outputs_of, report_written, tables};
use crate::compensation::GeometryChoice;
use crate::controllers::CONTROLLERS;
use crate::job::JobError;
use crate::output::OutputFile;
use crate::override_time::{HoldStop, OperatorRequest, OverrideTime, override_time};
use crate::request::JobRequest;
use crate::request::named::find_control;
use crate::results_format::{stamped, write_json};
use bound::{Bound, MOST_BOUND_S, bound};

pub(crate) fn run(args: &PlanArgs, console: &Console) -> Result<ExitCode> {
    let request = args.request()?;
    check_request(console, &request)?;
    let machine = machine(&request)?;
    let stages = stages(args, &machine)?;
    let operator = operator_request(args, stages)?;
    let mut files = outputs_of(&request);
    let json = files.start_wanted(args.json.as_deref())?;
    let lines = files.start_wanted(args.lines.as_deref())?;
    let (program, settings) = (request.program(), request.reader()?);
    let summary = program.check(settings.clone()).map_err(JobError::from)?;
    for warning in summary.warnings {
        warn(warning.into());
    }
    let bar = console.bar(0);
    let (machine, path_um) = within_tolerance(&request, machine, &bar)?;
    let begun = Instant::now();
    // The program was checked from end to end before: a mistake here means that the file changed,
    // and ends it.
    let steps = || {
        Ok(path_steps(
            program
                .reader(settings.clone())?
                .map_while(std::result::Result::ok),
        ))
    };
    report_assumed_limits(&machine, stages);
    let constraints = Constraints::from(&machine);
    let options = CycleTimeOptions {
        bound: false,
        lines: args.lines.is_some() || args.target.is_some(),
        length_mm: summary.feed_mm + summary.rapid_mm,
    };
    let mut found = cycle_time_by(stages, &machine, &constraints, options, steps, &bar)?;
    let took_s = begun.elapsed().as_secs_f64();
    // The bound is no part of what planning takes.
    let searched = args.bound && stages.planner.needs_axes;
    let bound = searched
        .then(|| bound(&program, &settings, constraints.clone(), &bar))
        .transpose()?;
    found.bound_s = bound
        .as_ref()
        .filter(|bound| bound.is_whole)
        .map(|bound| bound.time_s);
    let operated = match operator {
        Some(request) => override_time(&machine, stages, steps()?, request, &bar)?,
        None => None,
    };
    bar.clear();
    let planned_um = stages
        .planner
        .needs_axes
        .then_some(constraints.path_tolerance_mm)
        .flatten()
        .map(|mm| 1e3 * mm);
    let outcome = PlanOutcome {
        found,
        bound,
        operated,
        path_um,
        planned_um,
        took_s,
    };
    let mut complete = Vec::new();
    if let Some(mut file) = json {
        outcome.write_results(&mut file, args, &machine)?;
        complete.push(file);
    }
    complete.extend(OutputFile::filled(lines, |file| {
        write_lines(file, &program, &outcome.found.lines)
    })?);
    OutputFile::commit_all(complete, &bar)?;
    printed(outcome.print(args), ExitCode::SUCCESS)
}

struct PlanOutcome {
    found: CycleTime,
    bound: Option<Bound>,
    operated: Option<OverrideTime>,
    /// Path tolerance, um, if `--tolerance` was divided between the path and the machine.
    path_um: Option<f64>,
    /// Tolerance that the path was planned with, um.
    planned_um: Option<f64>,
    took_s: f64,
}

/// An entry of the results. Of many millions of lines, each would take a kilobyte as a value.
#[derive(Serialize)]
#[serde(untagged)]
enum PlanEntry<'a> {
    Value(&'a serde_json::Value),
    Lines(&'a [LineTime]),
}

/// The time of each line with its text.
fn write_lines(out: &mut impl Write, program: &Program, lines: &[LineTime]) -> std::io::Result<()> {
    writeln!(out, "line,time_s,waiting_s,text")?;
    let (text, _) = program.text()?;
    let mut texts = text.split(b'\n').zip(1_u32..);
    for LineTime {
        line,
        time_s,
        waiting_s,
    } in lines
    {
        let text = texts
            .find(|(_, number)| number == line)
            .map_or(Ok(Vec::new()), |(text, _)| text)?;
        let text = String::from_utf8_lossy(&text).trim().replace('"', "\"\"");
        writeln!(
            out,
            "{line},{time_s:.6},{waiting_s:.6},\"{}\"",
            visible(&text)
        )?;
    }
    Ok(())
}

/// The lines that take longest.
fn print_lines(out: &mut impl Write, found: &CycleTime) -> std::io::Result<()> {
    let mut lines: Vec<&LineTime> = found.lines.iter().collect();
    lines.sort_by(|a, b| b.time_s.total_cmp(&a.time_s));
    writeln!(out, "lines that take longest, of {}", lines.len())?;
    for LineTime { line, time_s, .. } in lines.into_iter().take(SHOWN) {
        writeln!(out, "  {:<26} {time_s:>12.3} s", format!("line {line}"))?;
    }
    Ok(())
}

/// Stretches of the motion that are written, and that are shown.
const WRITTEN: usize = 500;
const SHOWN: usize = 10;

/// Returns the binding limits along the motion as JSON.
fn along(found: &CycleTime) -> serde_json::Value {
    let names = limit_names();
    let stretch = |stretch: &BindingStretch| {
        let bound = names
            .iter()
            .zip(stretch.bound_s)
            .filter(|(_, bound_s)| *bound_s > 0.0);
        let binding: serde_json::Map<_, _> = bound
            .map(|(name, bound_s)| (name.clone(), json!(bound_s / stretch.duration_s)))
            .collect();
        json!({
            "duration_s": stretch.duration_s, "to_mm": stretch.to_mm, "way_mm": stretch.way_mm, "lines": stretch.lines, "binding": binding,
        })
    };
    found.along.in_parts(WRITTEN).iter().map(stretch).collect()
}

/// The motion in a few stretches of equal time: lines, feedrate, and the limit that binds there for
/// most of the time.
fn print_along(out: &mut impl Write, found: &CycleTime) -> std::io::Result<()> {
    let names = limit_names();
    writeln!(
        out,
        "the motion in stretches of equal time, and what binds longest in each"
    )?;
    for stretch in found.along.in_parts(SHOWN) {
        let [first, last] = stretch.lines;
        let lines = if first == last {
            format!("line {first}")
        } else {
            format!("lines {first} to {last}")
        };
        let feed_mm_min = 60.0 * stretch.way_mm / stretch.duration_s;
        let mostly = stretch.longest();
        let binds = mostly.map_or("no limit binds".to_owned(), |limit| {
            format!(
                "{} {:.0} %",
                names[limit],
                100.0 * stretch.bound_s[limit] / stretch.duration_s
            )
        });
        writeln!(
            out,
            "  {lines:<26} {:>12.3} s, {feed_mm_min:.0} mm/min, {binds}",
            stretch.duration_s
        )?;
    }
    Ok(())
}

/// The machine; with a tolerance, as a planner takes it that plans axis by axis.
fn machine(request: &JobRequest) -> Result<Machine> {
    let machine = request.machine()?;
    let Some(tolerance_um) = request.tolerance_um else {
        return Ok(machine);
    };
    if !(LEAST_UM..=MOST_UM).contains(&tolerance_um) {
        return Err(miette!(
            help = "the unit is um: 0.01 mm is --tolerance 10",
            "--tolerance is {} um; it must be from {LEAST_UM} to {MOST_UM} um",
            shown(tolerance_um)
        ));
    }
    let path_um = machine
        .limits
        .path_tolerance_um
        .unwrap_or(MOST_UM)
        .min(tolerance_um);
    let planned = machine.planned_by_axes(path_um.min(MOST_UM));
    report_assumed_limits(&machine, Stages::of(&planned));
    Ok(planned)
}

/// Divides a tolerance of the tool: returns the machine whose path uses the share that the
/// machine's error leaves, and the tolerance of that path, um. The default controller is simulated
/// for it, with the model that `run` has of the machine.
fn within_tolerance(
    request: &JobRequest,
    machine: Machine,
    bar: &Bar,
) -> Result<(Machine, Option<f64>)> {
    let Some(tolerance_um) = request.tolerance_um else {
        if request.compensation()? != GeometryChoice::Machine {
            return Err(miette!(
                help = "the error of the tool is predicted with --tolerance alone",
                "--geometry and --no-geometry need --tolerance: a path is planned alike with and without geometry"
            ));
        }
        return Ok((machine, None));
    };
    let mut job = request.job(CONTROLLERS, &today()?, bar)?;
    job.machine.clone_from(&machine);
    let found = job.check()?.tolerance_plan(bar)?;
    bar.clear();
    if let Some(plan) = found {
        return Ok((plan.machine, Some(plan.path_um)));
    }
    let path_um = machine.limits.path_tolerance_um.unwrap_or(tolerance_um);
    remark(&format!(
        "{} is predicted to need more than {tolerance_um} um for its own error at these feedrates: the path is planned within {path_um} um. \
         To slow down where that helps: feedwright run --fastest",
        machine.name
    ));
    Ok((machine, Some(path_um)))
}

/// The stages that suit the machine, with the planner of the arguments.
fn stages(args: &PlanArgs, machine: &Machine) -> Result<Stages> {
    let stages = Stages::of(machine);
    let target = args.target.as_deref().map(find_control).transpose()?;
    let Some(name) = args
        .planner
        .as_deref()
        .or(target.map(|target| target.planner))
    else {
        return Ok(stages);
    };
    if args.tolerance.is_some() && name != stages.planner.name {
        return Err(miette!(
            help = "leave --tolerance out; LinuxCNC's tolerance stands in the program, as G64 P",
            "--tolerance is for the planner {}, and this one is {name}",
            stages.planner.name
        ));
    }
    let planner = feed_planner(name).ok_or_else(|| {
        let names: Vec<&str> = FEED_PLANNERS.iter().map(|member| member.name).collect();
        let near = nearest(name, &names)
            .map_or_else(String::new, |near| format!("did you mean '{near}'? "));
        miette!(
            help = format!("{near}leave --planner out for the one that suits the machine"),
            "no planner is called '{name}'; there are {}",
            names.join(", ")
        )
    })?;
    Ok(Stages { planner })
}

/// Returns the operator's actions that the arguments request.
fn operator_request(args: &PlanArgs, stages: Stages) -> Result<Option<OperatorRequest>> {
    if args.override_percent.is_none() && args.hold_at.is_none() {
        return Ok(None);
    }
    let percent = args.override_percent.unwrap_or(100.0);
    let most = 100.0 * MOST_OVERRIDE;
    if !(0.0..=most).contains(&percent) {
        return Err(miette!(
            help = "it is in percent of the programmed feedrate: 50 is half of it",
            "--override is {percent} %; it must be from 0 to {most} %"
        ));
    }
    if let Some(at_s) = args
        .hold_at
        .filter(|at_s| !(0.0..=MOST_HOLD_S).contains(at_s))
    {
        return Err(miette!(
            "--hold-at is {at_s} s; it must be from 0 to {MOST_HOLD_S} s"
        ));
    }
    if !stages.planner.limits_jerk {
        return Err(miette!(
            help = "--planner time-optimal plans with them",
            "--override and --hold-at need a plan with limits of the jerk of each axis; {} plans without",
            stages.planner.name
        ));
    }
    Ok(Some(OperatorRequest {
        override_of_feeds: 0.01 * percent,
        hold_at_s: args.hold_at,
    }))
}

/// A year.
const MOST_HOLD_S: f64 = 3.2e7;

impl PlanOutcome {
    /// Writes all results as JSON.
    fn write_results(
        &self,
        out: &mut impl Write,
        args: &PlanArgs,
        machine: &Machine,
    ) -> Result<()> {
        let Self {
            found,
            operated,
            planned_um,
            took_s,
            ..
        } = self;
        let mut value = serde_json::to_value(found).into_diagnostic()?;
        value["part"] = json!(args.part.display().to_string());
        value["machine"] = json!(machine.name);
        value["path_tolerance_um"] = json!(planned_um);
        value["blocks_per_s"] = json!(found.blocks as f64 / took_s);
        if let Some(operated) = operated {
            value["override"] = json!(operated);
        }
        value["along"] = along(found);
        let value = stamped(value);
        let values = value.as_object().into_iter().flatten();
        let mut entries: BTreeMap<&str, PlanEntry> = values
            .map(|(name, value)| (name.as_str(), PlanEntry::Value(value)))
            .collect();
        if !found.lines.is_empty() {
            entries.insert("lines", PlanEntry::Lines(&found.lines));
        }
        write_json(out, &entries).into_diagnostic()
    }

    /// Prints the ratio of the plan to its bound, its use of the limits, and its deviation.
    fn print_limits(&self, out: &mut dyn Write) -> std::io::Result<()> {
        let Self {
            found,
            bound,
            path_um,
            ..
        } = self;
        let CycleTime {
            cutting_s,
            rapid_s,
            blocks,
            ..
        } = found;
        if let Some(bound_s) = found.bound_s {
            writeln!(
                out,
                "{:<28} {bound_s:>12.3} s, motion {:.4} times that",
                "bound of motion",
                (cutting_s + rapid_s) / bound_s
            )?;
        }
        if let Some(Bound {
            time_s, motions, ..
        }) = bound.filter(|bound| !bound.is_whole)
        {
            let name = format!("bound after {MOST_BOUND_S} s");
            writeln!(
                out,
                "{name:<28} {time_s:>12.3} s for {motions} of {blocks} motions; no more was found"
            )?;
        }
        if let Some(violation) = found.largest_violation {
            let kept = if violation > LARGEST_KEPT {
                ", which this planner does not keep"
            } else {
                ""
            };
            writeln!(
                out,
                "{:<28} {violation:>12.6} of its limit{kept}",
                "largest use of a limit"
            )?;
            writeln!(
                out,
                "{:<28} {:>12.3} um",
                "largest deviation", found.largest_deviation_um
            )?;
        }
        if let Some(path_um) = path_um {
            writeln!(out, "{:<28} {path_um:>12.3} um", "tolerance of the path")?;
        }
        Ok(())
    }

    fn print(&self, args: &PlanArgs) -> std::io::Result<()> {
        let Self {
            found,
            operated,
            took_s,
            ..
        } = self;
        let files = || [args.json.as_deref(), args.lines.as_deref()];
        let mut out = tables(files());
        let CycleTime {
            time_s,
            cutting_s,
            rapid_s,
            waiting_s,
            blocks,
            ..
        } = found;
        writeln!(
            out,
            "{:<28} {time_s:>12.3} s, planned by {}",
            "cycle time", found.planner
        )?;
        for (name, part_s) in [
            ("cutting", cutting_s),
            ("rapids", rapid_s),
            ("waiting", waiting_s),
        ] {
            writeln!(out, "  {name:<26} {part_s:>12.3} s")?;
        }
        for tool in found.tools.iter().filter(|_| found.tools.len() > 1) {
            writeln!(
                out,
                "  {:<26} {:>12.3} s",
                format!("tool {}", tool.tool),
                tool.time_s
            )?;
        }
        self.print_limits(&mut *out)?;
        if !found.binding.is_empty() {
            writeln!(out, "what limits the speed")?;
        }
        for binding in &found.binding {
            writeln!(
                out,
                "  {:<26} {:>12.1} % of the motion",
                binding.limit,
                100.0 * binding.share
            )?;
        }
        writeln!(
            out,
            "{:<28} {:>12.1} % of the cutting time",
            "below 0.8 of F",
            100.0 * found.slow_share
        )?;
        print_along(&mut out, found)?;
        if !found.lines.is_empty() {
            print_lines(&mut out, found)?;
        }
        if *blocks >= LEAST_TIMED {
            writeln!(
                out,
                "{:<28} {:>12.0} blocks/s",
                "planned",
                *blocks as f64 / took_s
            )?;
        }
        if let Some(operated) = operated {
            print_operated(args, operated, &mut *out)?;
        }
        report_written(&mut *out, files())
    }
}

/// Blocks from which the rate of planning is printed. With fewer the start of the planner counts:
/// pieces of a circle took 151 blocks/s with 1 of them, 1267 with 200, 1595 with 1000 and 1872
/// with 5000.
const LEAST_TIMED: u64 = 1000;

/// Ratio to a limit from which on the planner has not kept it: LinuxCNC's has no limit of the jerk.
/// Time-optimal plans stay below, since only rounding puts them above it.
const LARGEST_KEPT: f64 = 1.01;

/// Smallest tolerance, um, as in a machine file.
const LEAST_UM: f64 = 0.01;
const MOST_UM: f64 = 1e4;

fn print_operated(
    args: &PlanArgs,
    operated: &OverrideTime,
    out: &mut dyn Write,
) -> std::io::Result<()> {
    let percent = args.override_percent.unwrap_or(100.0);
    let OverrideTime {
        time_s,
        plan_s,
        largest_violation,
        hold,
    } = operated;
    let name = format!("override of {percent} %");
    if let Some(HoldStop {
        at_s,
        stops_in_s,
        way_mm,
        least_mm,
        position_mm: [x, y, z],
    }) = hold
    {
        writeln!(out, "{name:<28} {time_s:>12.3} s, at rest by feed hold")?;
        writeln!(out, "  {:<26} {at_s:>12.3} s", "feed hold pressed after")?;
        writeln!(
            out,
            "  {:<26} {stops_in_s:>12.3} s, {way_mm:.3} mm",
            "stops within"
        )?;
        writeln!(
            out,
            "  {:<26} {least_mm:>12.3} mm, each axis for itself",
            "at least"
        )?;
        writeln!(out, "  {:<26} X{x:.3} Y{y:.3} Z{z:.3}", "rests at")?;
    } else if time_s.is_finite() {
        writeln!(
            out,
            "{name:<28} {time_s:>12.3} s, {:.3} times the plan",
            time_s / plan_s
        )?;
    } else {
        writeln!(out, "{name:<28} never ends: feeds stand still")?;
    }
    writeln!(
        out,
        "  {:<26} {largest_violation:>12.6} of its limit",
        "largest use of a limit"
    )
}
