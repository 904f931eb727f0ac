//! The headline: results and cost of the runs of a report. The terminal and the page show the same
//! text.
//!
//! The run that is judged, the last, is compared with the first run that was simulated.

use std::fmt;

use super::harm::{CutErrors, Harm, harm, listed};
use super::text::{change, duration, fixed, number};
use super::{CommandShare, CommandShares, Outcome, Report, ReportedRun, Role, RunSummary};
use crate::controllers::BASELINE;

pub(crate) const AXES: [&str; 3] = ["X", "Y", "Z"];

/// Part of the headline. Only the page distinguishes the kinds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum HeadlinePart {
    /// Text between the others.
    Text(String),
    /// Name of a run.
    Name(String),
    /// A value with its unit.
    Value {
        /// The value it is compared with.
        before: Option<String>,
        /// The value.
        after: String,
        /// Relative change, as in "−87 %".
        change: Option<String>,
    },
}

/// The headline. Its text is what [`fmt::Display`] writes.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Headline {
    /// Its parts, in order.
    pub(crate) parts: Vec<HeadlinePart>,
}

impl fmt::Display for Headline {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for part in &self.parts {
            match part {
                HeadlinePart::Text(text) | HeadlinePart::Name(text) => f.write_str(text)?,
                HeadlinePart::Value {
                    before,
                    after,
                    change,
                } => {
                    if let Some(before) = before {
                        write!(f, "{before} → ")?;
                    }
                    f.write_str(after)?;
                    if let Some(change) = change {
                        write!(f, " ({change})")?;
                    }
                }
            }
        }
        Ok(())
    }
}

impl Report {
    /// Returns the results and the cost of the runs, in words.
    pub fn verdict(&self) -> String {
        headline(self).to_string()
    }

    /// Returns the run of a role, if there is one.
    pub fn run(&self, role: Role) -> Option<&ReportedRun> {
        self.runs.iter().find(|run| run.summary.role == role)
    }

    fn summary(&self, role: Role) -> Option<&RunSummary> {
        self.run(role).map(|run| &run.summary)
    }

    /// Returns the run that the tables and drawings begin with: the cut for comparison, or the
    /// requested controller's if it is compared with nothing.
    pub(super) fn basis(&self) -> Option<&ReportedRun> {
        self.run(Role::Reference)
            .or_else(|| self.run(Role::Corrected))
    }

    /// Returns the run that is judged: the cut of the corrected program, if there is one, else the
    /// requested controller's.
    pub fn judged(&self) -> Option<&RunSummary> {
        self.summary(Role::Exported)
            .or_else(|| self.summary(Role::Corrected))
    }

    /// Returns the run that it is compared with: the first other that was simulated to its end.
    fn compared(&self) -> Option<&RunSummary> {
        let judged = self.judged()?.role;
        [Role::Reference, Role::Corrected]
            .into_iter()
            .filter(|role| *role != judged)
            .filter_map(|role| self.summary(role))
            .find(|run| run.outcome == Outcome::Completed)
    }

    /// Returns true if the run that is judged reached its end within the tolerance. Without a
    /// tolerance, reaching the end is enough.
    pub(crate) fn is_within_tolerance(&self) -> bool {
        self.judged().is_some_and(|run| {
            run.outcome == Outcome::Completed
                && self
                    .tolerance_um
                    .is_none_or(|tolerance_um| run.max_um <= tolerance_um)
        })
    }

    /// Returns true if the command of the requested controller may be used: it was cut to its end,
    /// is not worse than uncorrected, and a drive may receive it.
    pub fn is_of_use(&self) -> bool {
        let may_be_used =
            |run: &RunSummary| run.outcome == Outcome::Completed && run.beyond_drives().is_none();
        self.summary(Role::Corrected).is_some_and(may_be_used) && self.harm().is_empty()
    }

    /// Returns true if the requested controller left most of the part, or its end, uncorrected.
    pub(crate) fn is_mostly_uncorrected(&self) -> bool {
        self.summary(Role::Corrected)
            .is_some_and(RunSummary::is_mostly_uncorrected)
    }

    /// Returns the index of the axis whose peak torque the headline names; the table of the
    /// terminal shows that axis, too.
    #[cfg(feature = "command")]
    pub(crate) fn costly_axis(&self) -> usize {
        self.judged()
            .map_or(0, |judged| costly_axis(self.compared(), judged).0)
    }

    /// Returns the errors of the requested controller that are worse than the uncorrected errors.
    /// Empty if one of the two runs is missing or diverged.
    pub fn harm(&self) -> Vec<Harm> {
        let is_whole = |run: &&RunSummary| run.outcome == Outcome::Completed;
        let baseline = self
            .runs
            .iter()
            .map(|run| &run.summary)
            .find(|run| run.controller == BASELINE);
        match (
            baseline.filter(is_whole),
            self.summary(Role::Corrected).filter(is_whole),
        ) {
            (Some(before), Some(after)) => harm(&CutErrors::of(before), &CutErrors::of(after)),
            _ => Vec::new(),
        }
    }
}

/// The headline of a report.
pub(crate) fn headline(report: &Report) -> Headline {
    let mut headline = Headline::default();
    match report.judged() {
        None => headline.text("No run was made."),
        Some(judged) if judged.outcome == Outcome::Completed => headline.completed(report, judged),
        Some(_) => {}
    }
    for run in report.runs.iter().map(|run| &run.summary) {
        headline.diverged(run);
    }
    headline
}

impl Headline {
    fn text(&mut self, text: &str) {
        self.parts.push(HeadlinePart::Text(text.to_owned()));
    }

    fn name(&mut self, controller: &str) {
        self.parts.push(HeadlinePart::Name(controller.to_owned()));
    }

    /// Writes a value of a run after `what`, and the same value of `before`.
    fn value(
        &mut self,
        what: &str,
        [before, after]: [Option<&RunSummary>; 2],
        value: impl Fn(&RunSummary) -> f64,
        text: impl Fn(f64) -> String,
    ) {
        self.text(what);
        let [before, after] = [before.map(&value), after.map(&value)];
        let after = after.unwrap_or(f64::NAN);
        self.parts.push(HeadlinePart::Value {
            before: before.map(&text),
            after: text(after),
            change: before.and_then(|before| change(before, after)),
        });
    }

    /// Describes a run that reached its end.
    fn completed(&mut self, report: &Report, judged: &RunSummary) {
        let compared = report.compared();
        let runs = [compared, Some(judged)];
        self.beyond_drives(judged);
        self.text("Simulated, ");
        self.name(&judged.controller);
        if let Some(compared) = compared {
            self.text(" against ");
            self.name(&compared.controller);
        }
        self.value(": RMS contour error ", runs, |run| run.rms_um, um);
        self.value(", largest ", runs, |run| run.max_um, um);
        self.value(", uncut path ", runs, |run| run.uncut_um, um);
        self.value(", machining time ", runs, |run| run.time_s, duration);
        if let Some(tolerance_um) = report.tolerance_um {
            let side = if report.is_within_tolerance() {
                "within"
            } else {
                "out of"
            };
            self.text(&format!(
                "; {side} tolerance: max {} µm, allowed {tolerance_um} µm",
                fixed(judged.max_um, 2)
            ));
        }
        self.text(".");
        self.harm(report);
        self.cost(runs, judged);
        self.faded(judged);
        self.measured(report);
    }

    /// Warns if the command exceeds what any drive may get.
    fn beyond_drives(&mut self, judged: &RunSummary) {
        if let Some(CommandShare { axis, share }) = judged.beyond_drives() {
            self.text(&format!(
                "Do not use this command: it asks {axis} for {} times the acceleration limit of the machine file. ",
                number(share)
            ));
        }
    }

    /// States that a run diverged and has no figures.
    fn diverged(&mut self, run: &RunSummary) {
        let Outcome::Diverged { at_s } = run.outcome else {
            return;
        };
        if !self.parts.is_empty() {
            self.text(" ");
        }
        self.name(&run.controller);
        self.text(&format!(
            " diverged at {}: the tool ran away from the path.",
            duration(at_s)
        ));
    }

    /// States that the correction is worse than no correction.
    fn harm(&mut self, report: &Report) {
        let harm = report.harm();
        if let Some(run) = report.summary(Role::Corrected).filter(|_| !harm.is_empty()) {
            self.text(" ");
            self.name(&run.controller);
            let figures = listed(&harm).replace(" um", " µm");
            self.text(&format!(
                " is worse than {BASELINE} for this part on this machine ({figures}): do not use its command."
            ));
        }
    }

    /// States the cost of the result: torque, command deviation and acceleration.
    fn cost(&mut self, runs: [Option<&RunSummary>; 2], judged: &RunSummary) {
        let (axis, why) = costly_axis(runs[0], judged);
        let torque_nm = |run: &RunSummary| run.peak_torque_nm.map_or(f64::NAN, |peaks| peaks[axis]);
        let accel_m_s2 = |run: &RunSummary| {
            if run.role.is_measured() {
                f64::NAN
            } else {
                run.max_command_accel_mm_s2 * 1e-3
            }
        };
        let what = format!(" Cost: peak torque of {}, {why}, ", AXES[axis]);
        self.value(&what, runs, torque_nm, |nm| format!("{} N m", number(nm)));
        self.value(
            ", command beside the program by up to ",
            [None, runs[1]],
            |run| run.max_deviation_um,
            um,
        );
        self.value(", its largest acceleration ", runs, accel_m_s2, |accel| {
            format!("{} m/s²", number(accel))
        });
        if let Some(CommandShares {
            acceleration,
            torque,
        }) = judged.command_share
        {
            let of_limit = |of: CommandShare| {
                format!("{} % of the limit of {}", number(100.0 * of.share), of.axis)
            };
            self.text(&format!(
                ", {}; largest torque {}",
                of_limit(acceleration),
                of_limit(torque)
            ));
        }
        self.text(".");
    }

    /// States that the supervisor took the controller out of the loop.
    fn faded(&mut self, judged: &RunSummary) {
        let Some(faded) = judged.faded_out else {
            return;
        };
        let (from, share, cause) = (
            duration(faded.at_s),
            number(100.0 * judged.engaged_share),
            faded.cause,
        );
        self.text(" ");
        self.name(&judged.controller);
        self.text(&format!(
            " was in the loop for {share} % of the cut; the supervisor took it out last at {from}, because {cause}."
        ));
        if judged.is_mostly_uncorrected() {
            self.text(" Most of the part, or its end, is as good as uncorrected.");
        }
    }

    /// States the errors in a log, if there is one.
    fn measured(&mut self, report: &Report) {
        let Some(run) = report.summary(Role::Measured) else {
            return;
        };
        self.value(
            " Measured on the machine: RMS contour error ",
            [None, Some(run)],
            |run| run.rms_um,
            um,
        );
        self.value(", largest ", [None, Some(run)], |run| run.max_um, um);
        self.text(".");
    }
}

fn um(value: f64) -> String {
    format!("{} µm", number(value))
}

/// Returns the axis whose peak torque the headline states, and the reason for this choice.
///
/// Each axis has a drive of its own, so its peak is compared with its own peak in the other run.
/// The largest peaks of all axes may belong to different drives, and their ratio hides a drive
/// whose load has grown more. Without another run it is the axis with the largest torque.
fn costly_axis(before: Option<&RunSummary>, after: &RunSummary) -> (usize, &'static str) {
    let Some(peaks_nm) = after.peak_torque_nm else {
        return (0, "of which there is no record");
    };
    let before_nm = before.and_then(|before| before.peak_torque_nm);
    let load = |k: usize| match before_nm {
        Some(before_nm) if before_nm[k] > 0.0 => peaks_nm[k] / before_nm[k],
        Some(_) => 0.0,
        None => peaks_nm[k],
    };
    let axis = (0..after.axes.clamp(1, 3))
        .max_by(|&a, &b| load(a).total_cmp(&load(b)))
        .unwrap_or(0);
    let why = match before_nm {
        None => "the largest",
        Some(_) if load(axis) < 1.0 => "which falls least",
        Some(_) => "which rises most",
    };
    (axis, why)
}

#[cfg(test)]
mod tests {
    use super::super::{Assumptions, RunFacts, Series, Statistics};
    use super::*;

    /// A run of two axes with these errors, um, and peak torques, N m.
    fn run(
        role: Role,
        controller: &str,
        [rms_um, max_um, uncut_um]: [f64; 3],
        peaks_nm: [f64; 2],
    ) -> ReportedRun {
        let facts = RunFacts {
            controller: controller.to_owned(),
            role,
            axes: 2,
            ..RunFacts::default()
        };
        let summary = RunSummary {
            rms_um,
            max_um,
            uncut_um,
            time_s: 2.0,
            max_deviation_um: 12.0,
            max_command_accel_mm_s2: 1500.0,
            peak_torque_nm: Some([peaks_nm[0], peaks_nm[1], 0.0]),
            ..Statistics::new().summary(facts, |_| String::new())
        };
        ReportedRun {
            summary,
            series: Series::new(),
            spectrum: Vec::new(),
            roundness: Vec::new(),
            events: Vec::new(),
        }
    }

    fn uncorrected() -> ReportedRun {
        run(Role::Reference, BASELINE, [10.0, 40.0, 5.0], [1.0, 0.5])
    }

    fn controlled() -> ReportedRun {
        run(
            Role::Corrected,
            "two-dimensional",
            [1.0, 4.0, 5.0],
            [1.2, 0.75],
        )
    }

    fn report(runs: Vec<ReportedRun>, tolerance_um: Option<f64>) -> Report {
        Report {
            title: String::new(),
            part: String::new(),
            machine: Vec::new(),
            settings: Vec::new(),
            assumed: Assumptions::default(),
            geometry: None,
            program: Vec::new(),
            circles: Vec::new(),
            tolerance_um,
            limits: None,
            axis_limits: Vec::new(),
            band: None,
            runs,
        }
    }

    fn text(runs: Vec<ReportedRun>, tolerance_um: Option<f64>) -> String {
        headline(&report(runs, tolerance_um)).to_string()
    }

    #[test]
    fn it_compares_the_corrected_run_with_the_reference() {
        assert_eq!(
            text(vec![uncorrected(), controlled()], None),
            "Simulated, two-dimensional against uncorrected: RMS contour error 10.0 µm → 1.00 µm (−90 %), \
             largest 40.0 µm → 4.00 µm (−90 %), uncut path 5.00 µm → 5.00 µm (±0 %), machining time 2.00 s → 2.00 s (±0 %). \
             Cost: peak torque of Y, which rises most, 0.50 N m → 0.75 N m (+50 %), \
             command beside the program by up to 12.0 µm, its largest acceleration 1.50 m/s² → 1.50 m/s² (±0 %)."
        );
    }

    #[test]
    fn a_run_alone_is_compared_with_nothing_and_a_log_is_no_run_to_compare_with() {
        let requested = || run(Role::Corrected, BASELINE, [10.0, 40.0, 5.0], [1.0, 0.5]);
        let alone = text(vec![requested()], None);
        assert!(
            alone
                .starts_with("Simulated, uncorrected: RMS contour error 10.0 µm, largest 40.0 µm,"),
            "{alone}"
        );
        assert!(
            alone.contains("peak torque of X, the largest, 1.00 N m,"),
            "{alone}"
        );
        let mut log = run(Role::Measured, "measured", [12.0, 50.0, 5.0], [0.0; 2]);
        log.summary.peak_torque_nm = None;
        let beside_a_log = text(vec![log, requested()], None);
        let measured = " Measured on the machine: RMS contour error 12.0 µm, largest 50.0 µm.";
        assert_eq!(beside_a_log, alone + measured);
    }

    #[test]
    fn the_tolerance_is_judged_by_the_largest_error_of_the_last_run() {
        for (tolerance_um, said) in [
            (4.0, "; within tolerance: max 4.00 µm, allowed 4 µm."),
            (3.5, "; out of tolerance: max 4.00 µm, allowed 3.5 µm."),
        ] {
            let text = text(vec![uncorrected(), controlled()], Some(tolerance_um));
            assert!(text.contains(said), "{text}");
        }
        assert!(!text(vec![uncorrected(), controlled()], None).contains("tolerance"));
        let mut lost = controlled();
        lost.summary.outcome = Outcome::Diverged { at_s: 0.5 };
        let lost = report(vec![uncorrected(), lost], Some(100.0));
        assert!(!lost.is_within_tolerance());
        assert_eq!(
            headline(&lost).to_string(),
            "two-dimensional diverged at 0.50 s: the tool ran away from the path."
        );
        let mut without = uncorrected();
        without.summary.outcome = Outcome::Diverged { at_s: 0.5 };
        let text = text(vec![without, controlled()], None);
        assert!(
            text.starts_with(
                "Simulated, two-dimensional: RMS contour error 1.00 µm, largest 4.00 µm,"
            ),
            "{text}"
        );
        assert!(
            text.ends_with(" uncorrected diverged at 0.50 s: the tool ran away from the path."),
            "{text}"
        );
    }

    #[test]
    fn the_torque_belongs_to_the_axis_on_which_it_rises_most() {
        let torque = |peaks_nm: [f64; 2]| {
            let text = text(
                vec![
                    uncorrected(),
                    run(Role::Corrected, "two-dimensional", [1.0; 3], peaks_nm),
                ],
                None,
            );
            let (_, rest) = text.split_once("peak torque of ").unwrap_or_default();
            rest.split_once(", command")
                .unwrap_or_default()
                .0
                .to_owned()
        };
        // The largest of all axes, X, goes from 1 to 2.72 N m; Y from 0.5 to 1.48.
        let largest_is_another = report(
            vec![
                uncorrected(),
                run(Role::Corrected, "two-dimensional", [1.0; 3], [2.72, 1.48]),
            ],
            None,
        );
        assert_eq!(largest_is_another.costly_axis(), 1);
        assert_eq!(
            torque([2.72, 1.48]),
            "Y, which rises most, 0.50 N m → 1.48 N m (+196 %)"
        );
        assert_eq!(
            torque([3.0, 1.48]),
            "X, which rises most, 1.00 N m → 3.00 N m (+200 %)"
        );
        assert_eq!(
            torque([0.8, 0.3]),
            "X, which falls least, 1.00 N m → 0.80 N m (−20 %)"
        );
    }

    #[test]
    fn a_correction_that_is_worse_is_named_and_a_corrected_program_does_not_hide_it() {
        let worse = || {
            run(
                Role::Corrected,
                "two-dimensional",
                [10.1, 30.0, 9.0],
                [1.0; 2],
            )
        };
        let said = "two-dimensional is worse than uncorrected for this part on this machine \
                    (RMS 10.10 µm for 10.00, uncut 9.00 µm for 5.00): do not use its command.";
        let exported = || run(Role::Exported, "as exported", [1.0; 3], [1.0; 2]);
        for runs in [
            vec![uncorrected(), worse()],
            vec![uncorrected(), worse(), exported()],
        ] {
            let text = text(runs, None);
            assert!(text.contains(said), "{text}");
        }
        assert!(!text(vec![uncorrected(), controlled()], None).contains("worse"));
        assert!(
            !text(
                vec![
                    run(Role::Reference, "cross-coupled", [0.1; 3], [1.0; 2]),
                    worse()
                ],
                None
            )
            .contains("worse")
        );
    }
}
