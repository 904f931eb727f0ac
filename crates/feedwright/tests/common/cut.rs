//! A part cut by one controller, with its trace in a file.

use std::path::Path;

use feedwright::{Choices, Entry, Job, Outputs, RunSummary};
use feedwright_sim::Machine;

/// Cuts a part and leaves its trace.
pub(crate) fn cut(part: &Path, machine: &Path, entry: &'static Entry, trace: &Path) -> RunSummary {
    let job = Job {
        part: part.to_owned(),
        machine: Machine::read(machine).unwrap(),
        machine_file: Some(machine.to_owned()),
        controller: entry,
        against: entry,
        feed_mm_s: None,
        choices: Choices::default(),
        model: None,
        tolerance_um: None,
        target: &feedwright::TARGETS[0],
        reference: None,
        fastest: false,
        reader: feedwright_gcode::Settings::default(),
        inputs: Vec::new(),
        log: None,
        outputs: Outputs { trace: Some(trace.to_owned()), ..Outputs::default() },
    };
    job.run(&()).unwrap().report.runs.remove(0).summary
}
