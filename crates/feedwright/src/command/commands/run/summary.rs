//! Result of a run as text: the headline, the table, the assumptions, and the next steps.

use crate::command::terminal::ascii;
use crate::report::headline::{AXES, headline};
use std::io::{self, Write};

use feedwright_sim::fixed;

use crate::controllers::CutsUncorrected;
use crate::correct::exported::ExportedFigures;
use crate::correct::{CorrectOutcome, TargetControl};
use crate::fastest::FastestPlan;
use crate::job::{Job, JobOutcome};
use crate::report::{
    AS_EXPORTED, Assumptions, CorrectionChange, Outcome as Ending, Report, Role, RunSummary,
};

use super::files::Outputs;
use crate::command::controls::print_correction;
use crate::command::streams::report_written;
use crate::command::table::{ConsoleTable, TableColumn};
use crate::command::terminal::{is_inch, wrapped};

pub(super) fn print(
    out: &mut dyn Write,
    job: &Job,
    outputs: &Outputs,
    outcome: &JobOutcome,
) -> io::Result<()> {
    let measured = outcome.report.run(Role::Measured).is_some();
    let say = |out: &mut dyn Write, text: &str| writeln!(out, "{}", wrapped(text, 2));
    say(out, &ascii(&headline(&outcome.report).to_string()))?;
    writeln!(out)?;
    table(&outcome.report, &outcome.without_identification).print(out)?;
    let axis = AXES[outcome.report.costly_axis()];
    let legend = format!(
        "N m: peak torque of {axis}; off: how far the command leaves the path at most; {}: largest acceleration of the command",
        if is_inch() { "in/s2" } else { "mm/s2" }
    );
    say(out, &legend)?;
    if measured {
        say(
            out,
            "measured: from the first cut on, so its time is without the way there; a log has no torque, and digits that make accelerations of it too large",
        )?;
    }
    if let Some(text) = chip_load(&outcome.report) {
        say(out, &text)?;
    }
    if let Some(band) = &outcome.report.band {
        say(out, &ascii(&band.sentence()))?;
    }
    writeln!(out)?;
    say(out, &assumed(&outcome.report.assumed, measured))?;
    if let Some(geometry) = &outcome.report.geometry {
        say(out, &ascii(&geometry.sentence()))?;
    }
    if outcome.report.is_mostly_uncorrected() && outcome.exported.is_none() {
        say(out, MOSTLY_UNCORRECTED)?;
    }
    if let Some(reference) = &job.reference {
        say(
            out,
            &format!("errors and uncut path are those to {}", reference.name()),
        )?;
        if let Some(control) = job.planned_as {
            say(out, &planned_as(control))?;
        }
    }
    if let Some(exported) = &outcome.exported {
        print_exported(out, exported)?;
    }
    if let Some(plan) = &outcome.fastest {
        print_fastest(out, plan)?;
    }
    if let Some(path_um) = outcome.path_um {
        say(out, &path_share(path_um))?;
    }
    print_written(out, outputs, outcome)
}

/// Remark on how a program is planned that names the control it was corrected for.
fn planned_as(control: &TargetControl) -> String {
    format!(
        "the program says that it was corrected for the control {}: it is planned as this control plans, and its geometry is not \
         compensated a second time",
        control.name
    )
}

/// Printed where the correction was disengaged for most of the cutting time, or at its end.
const MOSTLY_UNCORRECTED: &str = "most of the part, or its end, is as good as uncorrected: the model does not fit this machine. Record it anew with \
     `feedwright excite`, and identify it with `feedwright identify`";

/// Describes how the feedrate of the judged run differs from the programmed one.
fn chip_load(report: &Report) -> Option<String> {
    let RunSummary {
        controller, feed, ..
    } = report.judged()?;
    let feed = feed.as_ref()?;
    let [slow, fast] = [feed.slow_share, feed.fast_share].map(|share| 100.0 * share);
    Some(format!(
        "feedrate of {controller}: {slow:.1} % of the cutting time below 0.8 of the programmed one, {fast:.1} % above 1.2, \
         at most {:.3} of it",
        feed.largest
    ))
}

fn table(report: &Report, uncorrected: &[CutsUncorrected]) -> ConsoleTable {
    // The axis of the headline: the largest torques of all axes may belong to different drives, and
    // their ratio means nothing.
    let axis = report.costly_axis();
    let mut table = ConsoleTable::new(vec![
        TableColumn::new("simulated"),
        TableColumn::new("time s"),
        TableColumn::new("RMS um"),
        TableColumn::new("max um"),
        TableColumn::new("uncut um"),
        TableColumn::optional("N m", 1),
        TableColumn::optional("off um", 2),
        TableColumn::optional("mm/s2", 3),
    ]);
    for run in &report.runs {
        let now = &run.summary;
        let is_measured = now.role.is_measured();
        table.row(vec![
            if is_measured {
                format!("{}, not simulated", now.controller)
            } else {
                now.controller.clone()
            },
            fixed(now.time_s, 3),
            fixed(now.rms_um, 2),
            fixed(now.max_um, 2),
            fixed(now.uncut_um, 2),
            fixed(
                now.peak_torque_nm
                    .map_or(f64::NAN, |peaks_nm| peaks_nm[axis]),
                2,
            ),
            format!("{:.1}", now.max_deviation_um),
            if is_measured {
                "-".to_owned()
            } else {
                format!("{:.0}", now.max_command_accel_mm_s2)
            },
        ]);
        if let Some(why) = uncorrected
            .iter()
            .find(|why| why.controller() == now.controller)
        {
            table.remark(why.to_string());
        }
        if let (Some(rms_um), Some(max_um)) = (now.joint_rms_um, now.joint_max_um) {
            let both = |rms_um: f64, max_um: f64| format!("RMS {rms_um:.2}, max {max_um:.2} um");
            let encoders = both(rms_um, max_um);
            if encoders != both(now.rms_um, now.max_um) {
                table.remark(format!("by the encoders: {encoders}"));
            }
        }
        if let Ending::Diverged { at_s } = now.outcome {
            table.remark(format!(
                "diverged at {at_s:.3} s: the servo loop of this machine is unstable"
            ));
        }
        let left = now
            .transitions
            .iter()
            .filter(|transition| transition.change == CorrectionChange::Left);
        if let Some(last) = left.clone().next_back() {
            let (share, times) = (100.0 * now.engaged_share, left.count());
            let times = if times == 1 {
                "once".to_owned()
            } else {
                format!("{times} times")
            };
            let back = if now.engaged_at_end { "" } else { ", for good" };
            let words = last.words();
            table.remark(format!(
                "in the loop for {share:.1} % of the cut; left it {times}{back}. At {:.3} s, line {}: {words}",
                last.at_s, last.line
            ));
        }
    }
    table
}

/// Lists the assumptions behind the figures.
fn assumed(assumed: &Assumptions, measured: bool) -> String {
    let sentences = [
        assumed.machine_sentence(),
        assumed.disturbance_sentence(),
        assumed.model_sentence(),
    ];
    format!(
        "assumed: {}. {}",
        sentences.join("; "),
        Assumptions::cut_sentence(measured)
    )
}

/// Prints the corrected program's results beside those of the uncorrected program as its control
/// cuts it.
fn print_exported(out: &mut dyn Write, outcome: &CorrectOutcome) -> io::Result<()> {
    let ExportedFigures {
        rms_um,
        max_um,
        time_s,
        completed,
        ..
    } = outcome.uncorrected;
    let CorrectOutcome {
        control, planner, ..
    } = outcome;
    let text = format!(
        "{AS_EXPORTED}: the corrected program, cut without feedback as its control plans it ({control}, planner {planner})"
    );
    writeln!(out, "{}", wrapped(&text, 2))?;
    let figures = if completed {
        format!("{time_s:.3} s, RMS {rms_um:.2}, max {max_um:.2} um")
    } else {
        "diverged".to_owned()
    };
    let text = format!("uncorrected, cut in the same way: {figures}");
    writeln!(out, "{}", wrapped(&text, 2))?;
    print_correction(out, outcome)
}

/// States the share of the tool's tolerance that the planned path may use.
pub(in crate::command) fn path_share(path_um: f64) -> String {
    format!("of the tolerance, {path_um:.2} um are the path's")
}

fn print_fastest(out: &mut dyn Write, plan: &FastestPlan) -> io::Result<()> {
    let FastestPlan {
        cycle,
        largest_um,
        rounds,
        machine,
        ..
    } = plan;
    let moving_s = cycle.cutting_s + cycle.rapid_s;
    let cuts = if *rounds == 1 {
        "1 cut".to_owned()
    } else {
        format!("{rounds} cuts")
    };
    writeln!(
        out,
        "least time: {moving_s:.3} s of motion, largest error {largest_um:.2} um, found in {cuts}"
    )?;
    if let Some(bound_s) = cycle.bound_s {
        writeln!(
            out,
            "  {bound_s:.3} s for a tool without error, motion {:.4} times that",
            moving_s / bound_s
        )?;
    }
    if let Some(path_um) = machine.limits.path_tolerance_um {
        writeln!(out, "  {}", path_share(path_um))?;
    }
    for binding in &cycle.binding {
        writeln!(
            out,
            "  {:<16} binds {:>5.1} % of the motion",
            binding.limit,
            100.0 * binding.share
        )?;
    }
    Ok(())
}

/// Prints which files were written, and why a program was not.
fn print_written(out: &mut dyn Write, outputs: &Outputs, outcome: &JobOutcome) -> io::Result<()> {
    let is_good = outcome
        .exported
        .as_ref()
        .map_or(outcome.is_of_use, |program| program.refusal.is_none());
    let written = outputs.out.as_deref().filter(|_| is_good);
    let Outputs {
        report,
        json,
        trace,
        learned,
        ..
    } = outputs;
    report_written(
        out,
        [
            report.as_deref(),
            json.as_deref(),
            trace.as_deref(),
            learned.as_deref(),
            written,
        ],
    )?;
    match (outputs.out.as_deref(), &outcome.exported) {
        // The full reason why there is no program is printed above.
        (Some(path), None) if !is_good => {
            let is_beyond = outcome
                .report
                .judged()
                .is_some_and(|run| run.beyond_drives().is_some());
            let why = if !outcome.harm.is_empty() {
                "the uncorrected cut is better"
            } else if is_beyond {
                "no drive may get this command"
            } else {
                "the cut did not come to its end"
            };
            writeln!(
                out,
                "{}",
                wrapped(&format!("{} was not written: {why}", path.display()), 2)
            )
        }
        _ => Ok(()),
    }
}
