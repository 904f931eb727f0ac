//! Table and figures of the study of noise levels are those of its comparison, and that is what the
//! program makes today: `just noise-levels` regenerates all of it.
//!
//! Golden: that nothing has changed says nothing on whether it is right.

use std::path::PathBuf;

use crate::golden_tables::{is_made_anew, of_kept};
use crate::levels::{KINDS, LEVELS};
use feedwright::BASELINE;
use feedwright_lab::{Comparison, Knowledge, Workpiece};

fn text(file: &str) -> String {
    let study = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/05_noise"));
    std::fs::read_to_string(study.join(file)).unwrap()
}

fn kept() -> Comparison {
    Comparison::read(&text(crate::show::COMPARISON)).unwrap()
}

#[test]
fn table_and_figures_are_those_of_the_kept_comparison() {
    let (kept, document) = (kept(), text(crate::show::DOCUMENT));
    let table = crate::show::table(&kept).unwrap();
    assert_eq!(
        document[crate::show::place(&document).unwrap()],
        table,
        "hint: `just noise-levels`"
    );
    let figures = crate::show::figures(&kept);
    assert_eq!(figures.len(), KINDS.len());
    for (name, drawing) in figures {
        assert!(
            document.contains(&format!("]({name})")),
            "{name} is not shown"
        );
        assert_eq!(text(&name), drawing, "{name}; hint: `just noise-levels`");
    }
}

#[test]
fn every_controller_was_cut_at_the_ends_of_every_kind() {
    let kept = kept();
    for kind in &KINDS {
        for level in [kind.levels[0], kind.levels[LEVELS - 1]] {
            let machine = kind.machine_name(level);
            for controller in crate::show::CONTROLLERS {
                for contour in kept.contours() {
                    let row = kept.row(contour, &machine, controller);
                    assert!(
                        row.is_some_and(|row| row.rms_um > 0.0),
                        "{controller}, {contour} on {machine}: {row:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_kept_comparison_is_what_the_program_makes() {
    let machines = vec![
        KINDS[0].machine(KINDS[0].levels[0]).unwrap(),
        KINDS[3].machine(KINDS[3].levels[0]).unwrap(),
    ];
    let mut workpieces = Workpiece::contours();
    workpieces.retain(|workpiece| workpiece.name == "square");
    let controllers = [BASELINE, "feedforward-cross-coupled", "kalman-disturbance"];
    let options = of_kept(
        &kept(),
        workpieces,
        &[Knowledge::Own],
        machines,
        &controllers,
    );
    assert!(options.to_search().is_empty(), "{:?}", options.to_search());
    is_made_anew(&kept(), &options);
}
