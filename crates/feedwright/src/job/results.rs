//! The figures of a job as JSON.

use std::collections::BTreeMap;
use std::io::{self, Write};

use feedwright_gcode::Program;
use feedwright_sim::Machine;
use serde::Serialize;

use super::{Job, JobOutcome};
use crate::correct::CorrectOutcome;
use crate::report::harm::Harm;
use crate::report::{Assumptions, Band, CompensatedGeometry, RunSummary};
use crate::results_format::{RESULTS_FORMAT, write_json};

/// All results: `runs` and what they were made with.
#[derive(Serialize)]
struct Results<'a> {
    format: u32,
    version: &'static str,
    part: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    reference: Option<String>,
    tolerance_um: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    path_tolerance_um: Option<f64>,
    within_tolerance: bool,
    simulated: bool,
    assumed: &'a Assumptions,
    #[serde(skip_serializing_if = "Option::is_none")]
    geometry: Option<&'a CompensatedGeometry>,
    worse_than_uncorrected: &'a [Harm],
    settings: BTreeMap<&'a str, &'a str>,
    machine: &'a Machine,
    runs: Vec<&'a RunSummary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    band: Option<&'a Band>,
    #[serde(skip_serializing_if = "Option::is_none")]
    exported: Option<&'a CorrectOutcome>,
}

impl JobOutcome {
    /// Writes the figures of all runs, and what they were made with, as JSON.
    ///
    /// # Errors
    /// What the writer says.
    pub fn write_json(&self, job: &Job, out: &mut impl Write) -> io::Result<()> {
        let report = &self.report;
        let results = Results {
            format: RESULTS_FORMAT,
            version: env!("CARGO_PKG_VERSION"),
            part: &report.part,
            reference: job.reference.as_ref().map(Program::name),
            tolerance_um: job.request.tolerance_um,
            path_tolerance_um: self.path_um,
            within_tolerance: self.within_tolerance,
            simulated: true,
            assumed: &report.assumed,
            geometry: report.geometry.as_ref(),
            worse_than_uncorrected: &self.harm,
            settings: report
                .settings
                .iter()
                .map(|(name, value)| (name.as_str(), value.as_str()))
                .collect(),
            machine: &job.machine,
            runs: report.runs.iter().map(|run| &run.summary).collect(),
            band: report.band.as_ref(),
            exported: self.exported.as_ref(),
        };
        write_json(out, &results)
    }
}
