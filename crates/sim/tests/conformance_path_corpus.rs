//! Programs from other projects: every motion has a path, the plan ends where the program ends, and
//! memory stays bounded.

use crate::programs::{LIMITS, distance};
use feedwright_gcode::canon::Canon;
use feedwright_gcode::{Reader, Settings};
use feedwright_sim::Reference;
use std::path::{Path, PathBuf};

/// Every program of the corpus, as far as the reader gets without an error; `None` when there is no
/// corpus.
fn programs() -> Option<Vec<(PathBuf, Vec<Canon>)>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/corpus/gcode");
    let Ok(folders) = std::fs::read_dir(&root) else {
        eprintln!("SKIPPED: {} is missing", root.display());
        return None;
    };
    let files = folders
        .flatten()
        .filter_map(|folder| std::fs::read_dir(folder.path()).ok())
        .flatten()
        .flatten();
    let mut files: Vec<PathBuf> = files.map(|file| file.path()).collect();
    files.sort();
    let read = |file: PathBuf| {
        let reader = Reader::open(&file, Settings::default()).ok()?;
        Some((file, reader.map_while(Result::ok).collect()))
    };
    Some(files.into_iter().filter_map(read).collect())
}

#[test]
fn every_program_has_a_path_and_a_plan() {
    let Some(programs) = programs() else { return };
    assert!(
        programs.len() > 50,
        "{} programs can be read",
        programs.len()
    );
    for (file, canon) in programs {
        let end_mm = canon.iter().rev().find_map(|step| match step {
            Canon::Motion(motion) => Some(motion.end_mm),
            Canon::Event(_) => None,
        });
        let motions = canon.len();
        let mut reference = Reference::of_program(canon, &LIMITS).unwrap();
        let mut tau_s = 0.0;
        let mut most = 0;
        while reference.end_s().is_none_or(|end_s| tau_s < end_s) {
            let at = reference.at(tau_s);
            assert!(
                at.position_mm.into_iter().all(f64::is_finite),
                "{}: {at:?}",
                file.display()
            );
            assert!(at.feed_mm_s <= 200.0, "{}: {at:?}", file.display());
            reference.forget_before(tau_s - 0.1);
            most = most.max(reference.kept().0);
            tau_s += 0.05;
        }
        assert_eq!(reference.fault(), None, "{}", file.display());
        if let Some(end_mm) = end_mm {
            let gap = distance(reference.at(tau_s).position_mm, end_mm);
            assert!(gap < 1e-8, "{}: ends {gap} mm away", file.display());
        }
        // The finest blocks are 20 um, and 12.5 mm are enough to stop from 50 mm/s.
        assert!(
            most < 20_000,
            "{}: {most} of {motions} pieces in memory",
            file.display()
        );
    }
}
