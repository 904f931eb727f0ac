//! A part cut by one controller, with its trace in a file.

use std::fs::File;
use std::path::Path;

use feedwright::{Entry, GeometryChoice, Job, RunSummary};
use feedwright_gcode::Program;
use feedwright_sim::{Machine, TraceWriter};

/// Cuts a part and leaves its trace.
pub(crate) fn cut(part: &Path, machine: &Path, entry: &'static Entry, trace: &Path) -> RunSummary {
    cut_with(GeometryChoice::default(), part, machine, entry, trace)
}

/// The same with another compensation of the machine's geometry.
pub(crate) fn cut_with(
    compensation: GeometryChoice,
    part: &Path,
    machine: &Path,
    entry: &'static Entry,
    trace: &Path,
) -> RunSummary {
    let mut job = Job::new(Program::in_file(part), Machine::read(machine).unwrap());
    job.compensation = compensation;
    (job.controller, job.against) = (entry, entry);
    let checked = job.check().unwrap();
    let mut rows = TraceWriter::new(File::create(trace).unwrap(), checked.axes()).unwrap();
    let mut outcome = checked.run(&mut [&mut rows], &()).unwrap();
    rows.finish().unwrap();
    outcome.report.runs.remove(0).summary
}
