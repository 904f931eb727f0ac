//! The default controller on the machines that have what real axes have: it is not held back by
//! what they have beside an ideal axis.
//!
//! Bounds are twice what it leaves today or more; what the loops leave counts, not the geometry
//! that no encoder sees.

use std::path::Path;

use crate::cut::cut;
use crate::sweep::part_or_whole;
use feedwright::{BASELINE, BEST, CONTROLLERS};

/// RMS of the joints' contour error over the uncorrected one.
fn ratio(machine: &str, part: &str) -> f64 {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let (part, machine) = (
        root.join("parts").join(part),
        root.join("crates/sim/machines")
            .join(format!("{machine}.toml")),
    );
    let folder = tempfile::tempdir().unwrap();
    let [open_um, corrected_um] = [BASELINE, BEST].map(|name| {
        let summary = cut(
            &part,
            &machine,
            CONTROLLERS.find(name).unwrap(),
            &folder.path().join("trace.csv"),
        );
        summary.joint_rms_um.unwrap()
    });
    corrected_um / open_um
}

/// Needs 21 s of processor time: identifies two machines.
#[test]
fn the_loops_of_workshop_and_stiff_leave_a_part_of_what_uncorrected_leaves() {
    let cases = [
        ("workshop", "star.ngc", 0.2),
        ("workshop", "circle.ngc", 0.25),
        ("stiff", "star.ngc", 0.4),
    ];
    for &(machine, part, bound) in &cases[part_or_whole(1, 0)..] {
        let ratio = ratio(machine, part);
        assert!(ratio < bound, "{part} on {machine}: {ratio}");
    }
}
