//! Table and figures of the study of noise levels are those of its comparison, and that is what the
//! program makes today: `just noise-levels` regenerates all of it.
//!
//! Golden: that nothing has changed says nothing on whether it is right.

use std::collections::BTreeMap;

use crate::golden_tables::{is_made_anew, kept, of_kept, placed, shown, text};
use feedwright::{BASELINE, COLORS, Figure};
use feedwright_lab::{Knowledge, Workpiece};
use feedwright_sim::Machine;
use serde::Deserialize;
use serde_json::Value;

const COMPARISON: &str = "examples/05_noise/noise.json";

/// Results of the script for the kept comparison.
#[derive(Deserialize)]
struct Study {
    table: String,
    figures: BTreeMap<String, Value>,
    /// Machine files of the ends of every kind, by name.
    ends: BTreeMap<String, String>,
    controllers: Vec<String>,
}

impl Study {
    /// None without Python.
    fn made() -> Option<Self> {
        shown(&["noise_levels.py", "--show"])
    }
}

#[test]
fn table_and_figures_are_those_of_the_kept_comparison() {
    let Some(study) = Study::made() else { return };
    let document = text("examples/05_noise/README.md");
    let table = placed(&document, "noise levels", "noise-levels");
    assert_eq!(table, study.table, "hint: `just noise-levels`");
    assert_eq!(study.figures.len(), 6);
    for (name, drawing) in study.figures {
        let place = format!("]({name})");
        assert!(document.contains(&place), "{name} is not shown");
        let mut figure: Figure = serde_json::from_value(drawing).unwrap();
        for curve in figure.panels.iter_mut().flat_map(|panel| &mut panel.curves) {
            let number: usize = curve.color.strip_prefix("color ").unwrap().parse().unwrap();
            curve.color = COLORS[number].to_owned();
        }
        let was = text(&format!("examples/05_noise/{name}"));
        assert_eq!(was, figure.to_svg(), "{name}; hint: `just noise-levels`");
    }
}

#[test]
fn every_controller_was_cut_at_the_ends_of_every_kind() {
    let Some(study) = Study::made() else { return };
    let kept = kept(COMPARISON);
    assert_eq!(study.ends.len(), 2 * study.figures.len());
    for machine in study.ends.keys() {
        for controller in &study.controllers {
            for contour in kept.contours() {
                let row = kept.row(contour, machine, controller);
                assert!(
                    row.is_some_and(|row| row.rms_um > 0.0),
                    "{controller}, {contour} on {machine}: {row:?}"
                );
            }
        }
    }
}

#[test]
fn the_kept_comparison_is_what_the_program_makes() {
    let Some(study) = Study::made() else { return };
    let machines = ["white_0.03", "torque_0.01"]
        .map(|name| Machine::parse(&format!("{name}.toml"), &study.ends[name]).unwrap());
    let mut workpieces = Workpiece::contours();
    workpieces.retain(|workpiece| workpiece.name == "square");
    let controllers = [BASELINE, "feedforward-cross-coupled", "kalman-disturbance"];
    let kept = kept(COMPARISON);
    let options = of_kept(
        &kept,
        workpieces,
        &[Knowledge::Own],
        machines.into(),
        &controllers,
    );
    assert!(options.to_search().is_empty(), "{:?}", options.to_search());
    is_made_anew(&kept, &options);
}
