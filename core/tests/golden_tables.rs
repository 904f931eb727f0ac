//! The tables of the documents are what the program makes today: `just tables` regenerates them.
//!
//! Golden: that they have not changed says nothing on whether they are right; `conformance_paper` holds bounds from elsewhere.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

#[path = "../examples/tables/table.rs"]
mod table;

use feedwright::compare::table::ComparisonRow;
use feedwright::compare::{ComparisonOptions, Knowledge, Tuning, Workpiece, compare};
use feedwright::controllers::Entry;
use feedwright::journal::Journal;
use feedwright::machine::Machine;
use table::{Place, root};

/// Another platform's sine may differ in its last bit and turn a number over at a rounding.
const LAST_PLACES: f64 = 1.0;

/// The numbers of a table with the value of their last place, and everything between them.
fn take_apart(table: &str) -> (Vec<(f64, f64)>, String) {
    let is_number = |c: char| c.is_ascii_digit() || c == '.';
    let (mut numbers, mut rest) = (Vec::new(), String::new());
    for word in table.split_inclusive(|c| !is_number(c)) {
        let digits = word.trim_end_matches(|c| !is_number(c));
        if let Ok(number) = digits.parse() {
            let decimals = digits.split_once('.').map_or(0, |(_, decimals)| decimals.len());
            numbers.push((number, 0.1_f64.powi(decimals as i32)));
        }
        rest.push_str(&word[digits.len()..]);
    }
    (numbers, rest)
}

fn same(document: &str, made: &str) -> bool {
    let ((was, was_between), (is, is_between)) = (take_apart(document), take_apart(made));
    was_between == is_between
        && was.len() == is.len()
        && was.iter().zip(&is).all(|((was, place), (is, _))| (was - is).abs() < (LAST_PLACES + 0.5) * place)
}

fn holds(place: Place) {
    let text = std::fs::read_to_string(root().join(place.file)).unwrap();
    let document = &text[place.find(&text).unwrap()];
    assert!(
        same(document, &place.table),
        "{} is out of date; hint: `just tables`\nit says\n{document}\nand it is\n{}",
        place.file,
        place.table
    );
}

#[test]
fn the_tables_of_results_are_those_of_the_kept_comparison() {
    for place in Place::results().unwrap() {
        holds(place);
    }
}

/// Contours, machines and controllers of the kept comparison that are cut again here; the whole takes a minute.
const AGAIN: [&[&str]; 3] = [
    &["ellipse", "square"],
    &["tnv40", "rough", "soft"],
    &["open-loop", "cross-coupled", "feedforward", "two-dimensional", "receding-horizon"],
];
/// Rounding of another platform's sine, after thousands of servo periods with feedback.
const SAME_RATIO: f64 = 1e-3;

#[test]
fn the_kept_comparison_is_what_the_program_makes() {
    let kept = table::comparison(table::COMPARISON).unwrap();
    let [contours, machines, controllers] = AGAIN;
    let options = ComparisonOptions {
        workpieces: Workpiece::contours().into_iter().filter(|w| contours.contains(&w.name.as_str())).collect(),
        nominal: Machine::load(kept.nominal.as_ref()).unwrap(),
        machines: machines.iter().map(|name| Machine::load(name.as_ref()).unwrap()).collect(),
        controllers: controllers.iter().map(|name| Entry::find(name).unwrap()).collect(),
        knowledge: Knowledge::ALL.to_vec(),
        seed: kept.seed,
        noise_seeds: kept.noise_seeds,
        tuning: Tuning::Known(kept.tuned.clone()),
        set: Vec::new(),
        at_tolerance: false,
    };
    let made = compare(&options, &Journal::none(), &()).unwrap();
    for row in &made.rows {
        let place = |other: &&ComparisonRow| {
            (&other.contour, &other.machine, &other.controller) == (&row.contour, &row.machine, &row.controller)
        };
        let was = kept.rows.iter().find(place).unwrap();
        for (was, is) in [(was.rms_um, row.rms_um), (was.max_um, row.max_um), (was.time_s, row.time_s)] {
            assert!((was - is).abs() <= SAME_RATIO * was, "{was} is {is}; hint: `just tables`\n{row:?}");
        }
    }
}

#[test]
fn the_seeds_in_the_study_are_those_of_the_program() {
    holds(Place::paper().unwrap());
}

#[test]
fn only_the_last_place_of_a_number_may_differ() {
    assert!(same("| a | 1.2 s, 3.4 |", "| a | 1.3 s, 3.4 |"));
    assert!(!same("| a | 1.2 s, 3.4 |", "| a | 1.4 s, 3.4 |"));
    assert!(!same("| a | 1.2 s, 3.4 |", "| b | 1.2 s, 3.4 |"));
    assert!(!same("| a | 1.2 |", "| a | 1.2 | 3 |"));
}
