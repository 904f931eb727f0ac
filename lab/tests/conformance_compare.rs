//! The comparison: the same for any number of threads and after an interruption, ratios and
//! verdicts as they are defined.

use std::sync::LazyLock;

use feedwright::{BASELINE, BEST};
use feedwright_lab::compare::{recorded, tuning};
use feedwright_lab::{
    CONTROLLERS, Comparison, ComparisonOptions, ComparisonRow, Kept, Knowledge, Tuning, Verdict,
    Workpiece, compare,
};
use feedwright_sim::Machine;

/// Returns options with encoder noise on the second machine.
fn options() -> ComparisonOptions {
    let named = |name: &str| CONTROLLERS.find(name).unwrap();
    let [nominal, mut noisy] = ["tnv40", "rough"].map(|name| Machine::load(name.as_ref()).unwrap());
    for axis in &mut noisy.axes {
        axis.encoder_noise_um = 0.2;
    }
    let controllers = [
        BASELINE,
        "contour-compensation",
        "feedforward",
        "iterative-learning-3",
        BEST,
    ]
    .map(named)
    .to_vec();
    ComparisonOptions {
        workpieces: Workpiece::contours()
            .into_iter()
            .filter(|w| ["circle", "square"].contains(&w.name.as_str()))
            .collect(),
        machines: vec![nominal.clone(), noisy],
        nominal,
        controllers,
        knowledge: Knowledge::ALL.to_vec(),
        seed: 7,
        noise_seeds: 2,
        tuning: Tuning::Defaults,
        set: Vec::new(),
        at_tolerance: false,
    }
}

fn with_threads(threads: usize, options: &ComparisonOptions, kept: &Kept) -> Comparison {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    pool.install(|| compare(options, kept, &())).unwrap()
}

/// The comparison of these options by two threads, once for all tests.
fn compared() -> &'static Comparison {
    static COMPARED: LazyLock<Comparison> =
        LazyLock::new(|| with_threads(2, &options(), &Kept::none()));
    &COMPARED
}

/// Returns the options of one machine, without a log of it, which takes the longest.
fn few_options() -> ComparisonOptions {
    let mut options = options();
    options.machines.truncate(1);
    options
        .knowledge
        .retain(|&knowledge| knowledge != Knowledge::Log);
    options
}

#[test]
fn the_table_is_the_same_for_any_number_of_threads_and_after_an_interruption() {
    let options = few_options();
    let two = with_threads(2, &options, &Kept::none());
    assert_eq!(two, with_threads(1, &options, &Kept::none()));

    let folder = tempfile::tempdir().unwrap();
    let kept = || Kept::open(Some(folder.path()), &options.fingerprint()).unwrap();
    with_threads(2, &options, &kept());
    let files: Vec<_> = glob::glob(&format!("{}/*/*.json", folder.path().display()))
        .unwrap()
        .collect();
    assert_eq!(files.len(), two.rows.len());
    // Killed when two thirds were there, the last of them not as a whole.
    let left = files.len() * 2 / 3;
    for (i, file) in files.into_iter().enumerate().skip(left - 1) {
        let file = file.unwrap();
        if i < left {
            std::fs::write(file, "{").unwrap();
        } else {
            std::fs::remove_file(file).unwrap();
        }
    }
    let again = kept();
    assert_eq!(two, with_threads(2, &options, &again));
    assert_eq!(again.found(), left - 1);
}

#[test]
#[ignore = "a sweep, minutes: just sweep"]
fn the_whole_table_is_the_same_for_any_number_of_threads() {
    for threads in [1, 3] {
        assert_eq!(
            *compared(),
            with_threads(threads, &options(), &Kept::none())
        );
    }
}

#[test]
fn the_file_of_a_comparison_has_its_rows() {
    let comparison = compared();
    let read = Comparison::read(&comparison.text()).unwrap();
    assert_eq!(read.text(), comparison.text());
    assert_eq!(
        (&read.tuned, &read.claims, read.rows.len()),
        (&comparison.tuned, &comparison.claims, comparison.rows.len())
    );
    for (was, is) in comparison.rows.iter().zip(&read.rows) {
        assert_eq!(
            (&was.contour, &was.machine, &was.controller),
            (&is.contour, &is.machine, &is.controller)
        );
        for number in [
            |row: &ComparisonRow| [row.time_s, row.rms_um, row.max_um],
            |row: &ComparisonRow| [row.time_ratio, row.rms_ratio, row.max_ratio],
            |row: &ComparisonRow| {
                [
                    row.controlled_rms_um(),
                    row.controlled_max_um(),
                    f64::from(row.lost),
                ]
            },
        ] {
            assert_eq!(number(was), number(is), "{was:?}");
        }
        assert_eq!(was.completed, is.completed);
    }
}

#[test]
fn rows_are_complete_and_ratios_are_against_uncorrected() {
    let (options, comparison) = (options(), compared());
    // Parameters identified and 20 % off once on each machine, and two controllers by a log of it;
    // unseen on the one that is not nominal.
    let rows =
        options.workpieces.len() * (options.machines.len() * (options.controllers.len() + 4) + 1);
    assert_eq!(comparison.rows.len(), rows);
    for row in &comparison.rows {
        let base = comparison.rows.iter().find(|base| {
            (&base.contour, &base.machine, base.controller.as_str())
                == (&row.contour, &row.machine, BASELINE)
        });
        let base = base.unwrap();
        assert_eq!(row.rms_ratio, row.rms_um / base.rms_um);
        assert_eq!(row.max_ratio, row.max_um / base.max_um);
        assert_eq!(row.time_ratio, row.time_s / base.time_s);
        assert!(
            row.completed && row.lost == 0 && row.faded_out.is_none(),
            "{row:?}"
        );
        let noisy = row.machine == "rough";
        let [low, high] = row.rms_spread_um;
        assert_eq!(row.seeds, if noisy { 2 } else { 1 });
        assert!(
            (low <= row.rms_um && row.rms_um <= high) && (noisy == (low < high)),
            "{row:?}"
        );
        assert!(row.accel_mm_s2 > 0.0, "{row:?}");
    }
    let rms_um = |controller: &str| {
        comparison
            .row("circle", "rough", controller)
            .unwrap()
            .rms_um
    };
    let [exact, identified, off] =
        ["", "+identified", "+20%off"].map(|given| rms_um(&format!("feedforward{given}")));
    assert!(
        exact < off && identified < off && identified != exact,
        "{exact} {identified} {off}"
    );
    assert!(
        rms_um(BEST) != rms_um(&format!("{BEST}+unseen"))
            && rms_um(BEST) != rms_um(&format!("{BEST}+log"))
    );
}

/// Allowed relative difference of the RMS contour error between identified and exact parameters.
/// Torque noise hides smaller differences.
const AS_EXACT: f64 = 0.03;

#[test]
fn identified_parameters_are_worth_as_much_as_exact_ones_on_workshop_and_more_than_those_that_are_20_percent_off()
 {
    let workshop = Machine::load("workshop".as_ref()).unwrap();
    let options = ComparisonOptions {
        workpieces: Workpiece::contours()
            .into_iter()
            .filter(|workpiece| workpiece.name == "circle")
            .collect(),
        machines: vec![workshop],
        controllers: [BASELINE, "feedforward"]
            .map(|name| CONTROLLERS.find(name).unwrap())
            .to_vec(),
        ..few_options()
    };
    let comparison = with_threads(2, &options, &Kept::none());
    let [exact, identified, off] = ["", "+identified", "+20%off"].map(|given| {
        let row = comparison
            .row("circle", "workshop", &format!("feedforward{given}"))
            .unwrap();
        row.joint_rms_um.unwrap()
    });
    assert!(
        (identified / exact - 1.0).abs() < AS_EXACT && exact != identified,
        "{exact} {identified} {off}"
    );
    assert!(
        identified < (1.0 - AS_EXACT) * off,
        "{exact} {identified} {off}"
    );
    let row = comparison.row("circle", "workshop", "feedforward").unwrap();
    assert_eq!(row.controlled_rms_um(), exact);
    assert!(
        row.rms_um > 1.2 * exact,
        "the tool has errors that no encoder sees"
    );
}

#[test]
fn verdicts_are_those_of_the_machines_and_hold_on_the_nominal_circle() {
    let comparison = compared();
    let claims: Vec<(&str, &str, &str)> = comparison
        .verdicts
        .iter()
        .map(|v| (v.contour.as_str(), v.machine.as_str(), v.claim.as_str()))
        .collect();
    let expected = [
        ("circle", "tnv40", "RMS against uncorrected"),
        ("circle", "tnv40", "max against uncorrected"),
        ("circle", "tnv40", "RMS against the best peer without model"),
        ("circle", "rough", "RMS under noise against the best peer"),
        ("square", "tnv40", "RMS of the square"),
        ("square", "tnv40", "max of the square"),
        ("square", "rough", "RMS under noise against the best peer"),
        ("all work", "rough", "RMS under noise against the best peer"),
    ];
    assert_eq!(claims, expected);
    let circle = |v: &&Verdict| v.contour == "circle" && v.machine == "tnv40";
    assert!(
        comparison.verdicts.iter().filter(circle).all(|v| v.holds),
        "{:?}",
        comparison.verdicts
    );
}

/// A search that takes seconds.
const SEARCHED_ANEW: [&str; 2] = ["contour-compensation", "tnv40"];

#[test]
fn a_search_finds_the_recorded_values_to_the_bit() {
    let [controller, machine] = SEARCHED_ANEW;
    let machine = Machine::load(machine.as_ref()).unwrap();
    let known = recorded::known(std::slice::from_ref(&machine), 1);
    let recorded = known
        .iter()
        .find(|tuned| tuned.controller == controller)
        .expect("hint: record it");
    assert_eq!(
        tuning::search(CONTROLLERS.find(controller).unwrap(), &machine, 1, &()).unwrap(),
        *recorded
    );
}

#[test]
fn every_default_lies_in_its_ranges_and_what_is_searched_in_what_is_allowed() {
    for entry in CONTROLLERS {
        for parameter in entry.parameters {
            for [low, high] in [Some(parameter.allowed), parameter.searched]
                .into_iter()
                .flatten()
            {
                assert!(
                    (low..=high).contains(&parameter.default),
                    "{}: {parameter:?}",
                    entry.name
                );
            }
            if let Some(searched) = parameter.searched {
                let [least, most] = parameter.allowed;
                assert!(
                    searched.iter().all(|value| (least..=most).contains(value)),
                    "{}: {parameter:?}",
                    entry.name
                );
            }
        }
    }
}
