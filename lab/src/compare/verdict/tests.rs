//! Verdicts of rows whose numbers are made up.

use feedwright_sim::Machine;

use super::*;
use crate::compare::work::Workpiece;
use crate::compare::{Tuning, table::ComparisonRow};

const TNV40: &str = "tnv40";

/// Ratios are those to every uncorrected cut below.
fn row(
    contour: &str,
    machine: &str,
    controller: &str,
    [rms_um, max_um]: [f64; 2],
) -> ComparisonRow {
    ComparisonRow {
        contour: contour.to_owned(),
        machine: machine.to_owned(),
        controller: controller.to_owned(),
        time_s: 1.0,
        rms_um,
        max_um,
        peak_torque_nm: 1.0,
        time_ratio: 1.0,
        rms_ratio: rms_um / 10.0,
        max_ratio: max_um / 20.0,
        seeds: 1,
        completed: true,
        ..ComparisonRow::default()
    }
}

/// The nominal machine, a quiet one, and one with noise.
fn options() -> ComparisonOptions {
    let nominal = Machine::load(TNV40.as_ref()).unwrap();
    let quiet = Machine {
        name: "rough".to_owned(),
        ..nominal.clone()
    };
    let mut noisy = Machine {
        name: "noisy".to_owned(),
        ..nominal.clone()
    };
    noisy.axes[0].encoder_noise_um = 0.1;
    ComparisonOptions {
        workpieces: Workpiece::contours(),
        machines: vec![nominal.clone(), quiet, noisy],
        nominal,
        controllers: Vec::new(),
        knowledge: Knowledge::ALL.to_vec(),
        seed: 1,
        noise_seeds: 1,
        tuning: Tuning::Defaults,
        set: Vec::new(),
        at_tolerance: false,
    }
}

/// Returns, for each verdict, its peer, the value in thousandths, and whether the claim holds.
fn reported(rows: &[ComparisonRow]) -> Vec<(String, f64, bool)> {
    let verdicts = verdicts(rows, &options()).into_iter();
    verdicts
        .map(|v| (v.against, (v.value * 1e3).round(), v.holds))
        .collect()
}

fn of(against: &str, thousandths: f64, holds: bool) -> (String, f64, bool) {
    (against.to_owned(), thousandths, holds)
}

#[test]
fn without_corners_four_claims_each_with_its_limit() {
    let rows = |ours: [f64; 2]| {
        [
            row("circle", TNV40, BASELINE, [10.0, 20.0]),
            row("circle", TNV40, "cross-coupled", [1.0, 3.0]),
            // It has the exact model: no peer without one.
            row("circle", TNV40, "feedforward", [0.01, 0.01]),
            row("circle", TNV40, NOISELESS_LIMIT, [0.1, 0.2]),
            row("circle", TNV40, BEST, ours),
        ]
    };
    let good = [
        of(BASELINE, 11.0, true),
        of(BASELINE, 75.0, true),
        of("cross-coupled", 110.0, true),
        of(NOISELESS_LIMIT, 1100.0, true),
    ];
    assert_eq!(reported(&rows([0.11, 1.5])), good);
    let bad = [
        of(BASELINE, 50.0, false),
        of(BASELINE, 150.0, false),
        of("cross-coupled", 500.0, false),
        of(NOISELESS_LIMIT, 5000.0, false),
    ];
    assert_eq!(reported(&rows([0.5, 3.0])), bad);
}

#[test]
fn the_square_is_held_against_micrometres() {
    let rows = |ours: [f64; 2]| {
        let open = row("square", TNV40, BASELINE, [10.0, 20.0]);
        reported(&[open, row("square", TNV40, BEST, ours)])
    };
    assert_eq!(
        rows([0.02, 0.6]),
        [of("", 20.0, true), of("", 600.0, false)]
    );
    assert_eq!(
        rows([0.04, 0.4]),
        [of("", 40.0, false), of("", 400.0, true)]
    );
}

#[test]
fn elsewhere_the_unseen_and_the_identified_row_are_held_against_the_same_peer() {
    let peer = "contour-compensation";
    let rows = [
        row("circle", "rough", BASELINE, [10.0, 20.0]),
        row("circle", "rough", peer, [4.0, 9.0]),
        // Another machine's identification is no peer's.
        row("circle", "rough", "two-dimensional+unseen", [0.1, 9.0]),
        row("circle", "rough", BEST, [0.8, 2.0]),
        row("circle", "rough", "lqg-identified+unseen", [2.4, 5.0]),
    ];
    assert_eq!(
        reported(&rows),
        [of(peer, 600.0, false), of(peer, 200.0, true)]
    );
}

#[test]
fn under_noise_the_best_peer_has_the_exact_model_and_geometry_does_not_count() {
    let joint = |controller: &str, um: f64| ComparisonRow {
        joint_rms_um: Some(um),
        ..row("circle", "noisy", controller, [30.0, 40.0])
    };
    let mut rows = vec![
        joint(BASELINE, 10.0),
        joint("feedforward-cross-coupled", 0.5),
        joint("feedforward-cross-coupled+20%off", 1.0),
        joint("iterative-learning-10", 0.01),
        joint(LIMIT, 0.1),
        joint(BEST, 0.3),
    ];
    let circle = [
        of("feedforward-cross-coupled", 600.0, false),
        of("feedforward-cross-coupled+20%off", 300.0, true),
        of(LIMIT, 3000.0, false),
    ];
    let twice: Vec<_> = circle.iter().chain(&circle).cloned().collect();
    assert_eq!(
        reported(&rows),
        twice,
        "the circle, and all work that there is"
    );
    rows.retain(|row| row.controller != LIMIT);
    assert_eq!(reported(&rows).len(), 4, "no verdict without the limit");
}

#[test]
fn held_out_work_may_nowhere_be_worse_than_uncorrected_or_the_baseline() {
    let mut options = options();
    options.workpieces[0].held_out = true;
    let mut rows = vec![
        row("circle", "rough", BASELINE, [10.0, 20.0]),
        row("circle", "rough", DELIVERED, [1.0, 2.0]),
        ComparisonRow {
            uncut_um: 1.5,
            peak_torque_nm: 1.3,
            ..row("circle", "rough", BEST, [1.04, 3.5])
        },
    ];
    let short = |rows: &[ComparisonRow]| {
        let all = verdicts(rows, &options).into_iter();
        let short = all.filter(|v| !v.holds && v.claim.starts_with("held-out"));
        short.map(|v| (v.claim, v.against)).collect::<Vec<_>>()
    };
    let named = |claim: &Claim, against: &str| (claim.0.to_owned(), against.to_owned());
    let bad = [
        named(&HELD_OUT_MAX, DELIVERED),
        named(&HELD_OUT_UNCUT, BASELINE),
    ];
    assert_eq!(short(&rows), bad);
    let mut all = verdicts(&rows, &options).into_iter();
    let torque = all.find(|v| v.claim == PEAK_TORQUE.0).unwrap();
    assert!(!torque.holds && torque.value == 1.3, "{torque:?}");
    rows[2] = ComparisonRow {
        lost: 1,
        ..row("circle", "rough", BEST, [1.06, 2.0])
    };
    let bad = [named(&HELD_OUT_LOST, ""), named(&HELD_OUT_RMS, DELIVERED)];
    assert_eq!(short(&rows), bad);
}

#[test]
fn nothing_holds_that_took_longer_or_did_not_end() {
    let mut rows = [
        row("circle", TNV40, BASELINE, [10.0, 20.0]),
        row("circle", TNV40, BEST, [0.1, 1.0]),
    ];
    let both = |holds: bool| [of(BASELINE, 10.0, holds), of(BASELINE, 50.0, holds)];
    assert_eq!(reported(&rows), both(true));
    rows[1].time_ratio = 1.001;
    assert_eq!(reported(&rows), both(false));
    rows[1].time_ratio = 1.0;
    rows[1].completed = false;
    assert_eq!(reported(&rows), both(false));
}
