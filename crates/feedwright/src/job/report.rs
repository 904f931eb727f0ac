//! What the page of a job shows.

use feedwright_gcode::Summary;
use feedwright_ident::Model;
use feedwright_sim::cycle_time::{self, CycleTime, CycleTimeOfCut, cycle_time};
use feedwright_sim::{Machine, Stages, Watch, path_steps};

use super::planned::JobPlan;
use super::{Job, JobError};
use crate::controllers::CutsUncorrected;
use crate::report::{DrawnLimits, FullCircle, LimitBand, Report, ReportedRun, WorstPlace};

/// Returns the limits of each axis that the page draws.
fn drawn_limits(machine: &Machine) -> Vec<DrawnLimits> {
    let planned = machine.has_axis_limits();
    let limits = |axis: &feedwright_sim::Axis| DrawnLimits {
        torque_nm: axis.torque_limit_nm,
        accel_mm_s2: axis.max_accel_mm_s2.filter(|_| planned),
    };
    machine.axes.iter().map(limits).collect()
}

impl Job {
    /// Returns the error that the program could not be read again.
    pub(super) fn reread(&self, cause: std::io::Error) -> JobError {
        JobError::Reread {
            part: self.program.name(),
            cause,
        }
    }

    /// Looks up the texts of the worst places' lines, in one pass over the program.
    pub(super) fn fill_in_texts(&self, worst: &mut [WorstPlace]) -> Result<(), JobError> {
        let last = worst.iter().map(|place| place.line).max().unwrap_or(0);
        let (mut file, _) = self.program.text().map_err(|cause| self.reread(cause))?;
        let mut text = Vec::new();
        for line in 1..=last {
            text.clear();
            file.read_until(b'\n', &mut text)
                .map_err(|cause| self.reread(cause))?;
            for place in worst.iter_mut().filter(|place| place.line == line) {
                place.text = String::from_utf8_lossy(&text).trim_end().to_owned();
            }
        }
        Ok(())
    }

    /// Everything that the page shows.
    pub(super) fn report(
        &self,
        axes: usize,
        summary: &Summary,
        circles: Vec<FullCircle>,
        runs: Vec<ReportedRun>,
        unidentified: &[CutsUncorrected],
    ) -> Result<Report, JobError> {
        let value = |name: &str, value: String| (name.to_owned(), value);
        let mut settings = vec![
            value("Compared against", self.against.name.to_owned()),
            value(
                "Controller",
                format!("{}: {}", self.controller.name, self.controller.summary),
            ),
            value("Source of the method", self.controller.source.to_owned()),
            value("Axes controlled", axes.to_string()),
            value(
                "Program read as",
                format!("{}: {}", summary.dialect.0, summary.dialect.1),
            ),
            value("Seed", self.choices.seed.to_string()),
        ];
        for set in &self.choices.set {
            settings.push(value(
                &format!("{}, {}", set.controller, set.name),
                set.value.to_string(),
            ));
        }
        if let Some(model) = self.model.as_ref().map(Model::about) {
            settings.push(value("Model", format!("{}, {}", model.source, model.date)));
        }
        if let Some(reference) = &self.reference {
            settings.push(value("Errors measured to", reference.name()));
        }
        if let Some(target) = self.target {
            settings.push(value(
                "Corrected program for",
                format!("{}: {}", target.name, target.about),
            ));
        }
        if let Some(feed_mm_s) = self.request.feed_mm_s {
            settings.push(value(
                "Feedrate, in place of the programmed",
                format!("{feed_mm_s} mm/s"),
            ));
        }
        Ok(Report {
            title: format!("{} on {}", self.program.file_name(), self.machine.name),
            part: self.program.file_name(),
            machine: describe(&self.machine),
            settings,
            assumed: self.assumptions(axes, unidentified),
            geometry: None,
            program: self.listing(&runs)?,
            circles,
            tolerance_um: self.request.tolerance_um,
            limits: None,
            axis_limits: drawn_limits(&self.machine),
            band: None,
            runs,
        })
    }

    /// Returns true if the binding limits along the path are to be found: on machines that are
    /// planned axis by axis.
    fn shows_limits(&self) -> bool {
        self.request.with_limits && Stages::of(&self.machine).planner.needs_axes
    }

    /// Looks at the plan of a cut for the page, where that is the plan of the program.
    pub(super) fn looks_at_cut<'a>(&self, plan: &'a JobPlan) -> Option<CycleTimeOfCut<'a>> {
        let cut = self.shows_limits() && plan.fastest.is_none() && plan.aligned.is_none();
        cut.then(|| CycleTimeOfCut::new(&plan.constraints, Stages::of(&self.machine).planner))
    }

    /// The limits that bind along the path; `None` if the page does not show them. `of_cut` has them
    /// from the plan of a cut. Without it, because the cut did not finish or took another path,
    /// this function makes a plan.
    pub(super) fn limit_band(
        &self,
        plan: &JobPlan,
        of_cut: Option<&CycleTime>,
        watch: &dyn Watch,
    ) -> Result<Option<LimitBand>, JobError> {
        if !self.shows_limits() {
            return Ok(None);
        }
        let known = plan.fastest.as_ref().map(|plan| &plan.cycle).or(of_cut);
        let along = match known {
            Some(cycle) => cycle.along.clone(),
            None => {
                watch.begin("looking at what binds", 1);
                let found = cycle_time(
                    &plan.machine,
                    false,
                    || Ok(path_steps(self.steps()?)),
                    watch,
                );
                found
                    .map_err(|error| JobError::of_run(&self.program, error))?
                    .along
            }
        };
        Ok(Some(LimitBand {
            names: cycle_time::limit_names(),
            along,
        }))
    }
}

/// The machine's values, named and with units.
fn describe(machine: &Machine) -> Vec<(String, String)> {
    let mut lines = vec![
        (
            "Machine".to_owned(),
            format!("{}: {}", machine.name, machine.description),
        ),
        ("Source".to_owned(), machine.source.clone()),
    ];
    // The keys of the file carry their units; the serialisation lists all of them without a second
    // list here.
    let sections = [
        ("period".to_owned(), serde_json::json!(machine.period)),
        ("limits".to_owned(), serde_json::json!(machine.limits)),
    ];
    let axes = ["x", "y", "z"]
        .iter()
        .zip(&machine.axes)
        .map(|(name, axis)| (format!("axis.{name}"), serde_json::json!(axis)));
    let geometry = [("geometry".to_owned(), serde_json::json!(machine.geometry))];
    let noise = [("noise".to_owned(), serde_json::json!(machine.noise))];
    for (section, values) in sections
        .into_iter()
        .chain(axes)
        .chain(geometry)
        .chain(noise)
    {
        for (key, value) in values.as_object().into_iter().flatten() {
            lines.push((format!("{section}.{key}"), value.to_string()));
        }
    }
    lines
}
