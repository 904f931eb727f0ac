//! The default controller on the machines that have what real axes have: it is not held back by what they have beside an ideal axis.
//!
//! Bounds are twice what it leaves today or more; what the loops leave counts, not the geometry that no encoder sees.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

use std::path::Path;

use feedwright::controllers::{BASELINE, BEST, Choices, Entry};
use feedwright::job::{Job, Outputs};
use feedwright::machine::Machine;

/// RMS of the joints' contour error over open loop's.
fn ratio(machine: &str, part: &str) -> f64 {
    let job = Job {
        part: Path::new(env!("CARGO_MANIFEST_DIR")).join("../parts").join(part),
        machine: Machine::load(machine.as_ref()).unwrap(),
        controller: Entry::find(BEST).unwrap(),
        against: Entry::find(BASELINE).unwrap(),
        feed_mm_s: None,
        choices: Choices::default(),
        model: None,
        tolerance_um: None,
        reader: feedwright::gcode::Settings::default(),
        inputs: Vec::new(),
        outputs: Outputs::default(),
    };
    let runs = job.run(&()).unwrap().report.runs;
    let [open_um, corrected_um] = [&runs[0], &runs[1]].map(|run| run.summary.joint_rms_um.unwrap());
    corrected_um / open_um
}

#[test]
fn the_loops_of_workshop_and_stiff_leave_a_part_of_what_open_loop_leaves() {
    for (machine, part, bound) in
        [("workshop", "circle.ngc", 0.25), ("workshop", "star.ngc", 0.2), ("stiff", "star.ngc", 0.4)]
    {
        let ratio = ratio(machine, part);
        assert!(ratio < bound, "{part} on {machine}: {ratio}");
    }
}
