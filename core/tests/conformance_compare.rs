//! The comparison: the same for any number of threads and after an interruption, ratios and verdicts as they are defined.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

use feedwright::compare::verdict::Verdict;
use feedwright::compare::{
    Comparison, ComparisonOptions, Finished, IDENTIFIED_HERE, Tuning, Workpiece, compare, journal_path, page,
};
use feedwright::controllers::{BASELINE, BEST, CONTROLLERS, Entry};
use feedwright::journal::Journal;
use feedwright::machine::Machine;

fn options() -> ComparisonOptions {
    let named = |name: &str| Entry::find(name).unwrap();
    ComparisonOptions {
        workpieces: Workpiece::contours()
            .into_iter()
            .filter(|w| ["circle", "square"].contains(&w.name.as_str()))
            .collect(),
        machines: ["tnv40", "rough"].map(|name| Machine::load(name.as_ref()).unwrap()).to_vec(),
        controllers: vec![named(BASELINE), named("contour-compensation"), named("iterative-learning-3"), named(BEST)],
        seed: 7,
        tuning: Tuning::Defaults,
        set: Vec::new(),
        at_tolerance: false,
    }
}

fn with_threads(threads: usize, options: &ComparisonOptions, journal: &Journal<Finished>) -> Comparison {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| compare(options, journal, &())).unwrap()
}

fn json(comparison: &Comparison) -> String {
    serde_json::to_string(comparison).unwrap()
}

#[test]
fn the_table_is_the_same_for_any_number_of_threads_and_after_an_interruption() {
    let options = options();
    let one = with_threads(1, &options, &Journal::none());
    assert_eq!(json(&one), json(&with_threads(3, &options, &Journal::none())));

    let folder = tempfile::tempdir().unwrap();
    let journal = Journal::open(&journal_path(folder.path(), "key")).unwrap();
    with_threads(2, &options, &journal);
    drop(journal);
    let file = std::fs::read_dir(folder.path()).unwrap().next().unwrap().unwrap().path();
    let text = std::fs::read_to_string(&file).unwrap();
    // Killed in the middle of a line.
    std::fs::write(&file, &text[..text.len() * 2 / 3]).unwrap();
    let journal = Journal::open(&journal_path(folder.path(), "key")).unwrap();
    let known = journal.rows().filter(|finished| matches!(finished, Finished::Row(_))).count();
    assert!(known > 0 && known < one.rows.len(), "{known} of {}", one.rows.len());
    assert_eq!(json(&one), json(&with_threads(2, &options, &journal)));
    journal.remove();
    assert!(!file.exists());
}

#[test]
fn rows_are_complete_and_ratios_are_against_open_loop() {
    let options = options();
    let comparison = with_threads(2, &options, &Journal::none());
    // On the machine that is known, the identified competitor is the unseen one.
    let rows = options.workpieces.len() * (options.machines.len() * options.controllers.len() + 1);
    assert_eq!(comparison.rows.len(), rows);
    for row in &comparison.rows {
        let base = comparison.rows.iter().find(|base| {
            (&base.contour, &base.machine, base.controller.as_str()) == (&row.contour, &row.machine, BASELINE)
        });
        let base = base.unwrap();
        assert_eq!(row.rms_ratio, row.rms_um / base.rms_um);
        assert_eq!(row.max_ratio, row.max_um / base.max_um);
        assert_eq!(row.time_ratio, row.time_s / base.time_s);
        assert!(row.completed && row.faded_out.is_none(), "{row:?}");
    }
    assert!(
        comparison
            .rows
            .iter()
            .any(|row| row.controller == format!("{BEST}{IDENTIFIED_HERE}") && row.machine == "rough")
    );
    let claims: Vec<(&str, &str, &str)> =
        comparison.verdicts.iter().map(|v| (v.contour.as_str(), v.machine.as_str(), v.claim.as_str())).collect();
    let expected = [
        ("circle", "tnv40", "RMS against open loop"),
        ("circle", "tnv40", "max against open loop"),
        ("circle", "tnv40", "RMS against the best peer without model"),
        ("circle", "rough", "RMS, unseen machine, against the best peer without model"),
        ("circle", "rough", "RMS, identified machine, against the best peer without model"),
        ("square", "tnv40", "RMS at corners against the best peer"),
        ("square", "tnv40", "max at corners against the best peer"),
        ("square", "rough", "RMS, unseen machine, against the best peer without model"),
        ("square", "rough", "RMS, identified machine, against the best peer without model"),
    ];
    assert_eq!(claims, expected);
    let circle = |v: &&Verdict| v.contour == "circle" && v.machine == "tnv40";
    assert!(comparison.verdicts.iter().filter(circle).all(|v| v.holds), "{:?}", comparison.verdicts);
    let mut html = Vec::new();
    page::write(&mut html, &comparison).unwrap();
    let html = String::from_utf8(html).unwrap();
    for entry in &options.controllers {
        assert!(html.contains(entry.name), "{}", entry.name);
    }
    assert!(!html.contains("NaN") && !html.contains("src=\"http") && html.ends_with("</html>\n"));
}

#[test]
fn every_default_lies_in_its_ranges_and_what_is_searched_in_what_is_allowed() {
    for entry in CONTROLLERS {
        for parameter in entry.parameters {
            for [low, high] in [Some(parameter.allowed), parameter.searched].into_iter().flatten() {
                assert!((low..=high).contains(&parameter.default), "{}: {parameter:?}", entry.name);
            }
            if let Some(searched) = parameter.searched {
                let [least, most] = parameter.allowed;
                assert!(searched.iter().all(|value| (least..=most).contains(value)), "{}: {parameter:?}", entry.name);
            }
        }
    }
}
