//! The tables of the documents are what the program makes today: `just tables` regenerates them.
//!
//! A golden test only shows that the tables have not changed, not that they are right;
//! `conformance_paper` holds bounds from elsewhere.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::python::python;
use feedwright::BASELINE;
use feedwright_control::Knows;
use feedwright_lab::{
    CONTROLLERS, Comparison, ComparisonOptions, HeldOutSeeds, Kept, Knowledge, Tuning, Workpiece,
    compare, experiment,
};
use feedwright_sim::Machine;
use serde::Deserialize;
use serde::de::DeserializeOwned;

/// The comparison on machines without noise, and on machines with noise.
const COMPARISON: &str = "examples/02_contours/compare.json";
const HELD_OUT: &str = "examples/03_realism/held_out.json";
/// Seeds of the paper's experiment: the default of the command line.
const SEEDS: u64 = 10;

fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// A file of the repository.
pub(crate) fn text(file: &str) -> String {
    std::fs::read_to_string(root().join(file)).unwrap()
}

pub(crate) fn kept(file: &str) -> Comparison {
    Comparison::read(&text(file)).unwrap()
}

/// Output of a script of the laboratory; none without Python.
pub(crate) fn shown<T: DeserializeOwned>(command: &[&str]) -> Option<T> {
    let script = root().join("lab").join(command[0]);
    let output = Command::new(python()?)
        .arg(script)
        .args(&command[1..])
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    Some(serde_json::from_slice(&output.stdout).unwrap())
}

/// The table of this name in a document.
pub(crate) fn placed<'a>(document: &'a str, name: &str, recipe: &str) -> &'a str {
    let begin = format!("<!-- table of {name}, made by `just {recipe}` -->\n");
    let (_, rest) = document.split_once(&begin).unwrap();
    rest.split_once("<!-- end of table -->\n").unwrap().0
}

/// Tables of the documents: file, name and text.
#[derive(Deserialize)]
struct Tables {
    tables: Vec<(String, String, String)>,
    without_model: Vec<String>,
}

impl Tables {
    /// Makes them with the results of the paper's experiment in a file.
    fn made(paper: &Path) -> Option<Self> {
        shown(&["tables.py", "--show", paper.to_str().unwrap()])
    }

    fn hold(&self, is_checked: impl Fn(&str) -> bool) {
        for (file, name, table) in self.tables.iter().filter(|(file, ..)| is_checked(file)) {
            let text = text(file);
            let document = placed(&text, name, "tables");
            assert!(
                same(document, table),
                "{file} is out of date; hint: `just tables`\nit says\n{document}\nand it is\n{table}"
            );
        }
    }
}

const PAPER: &str = "examples/01_paper_circle/";

/// Another platform's sine may differ in its last bit and turn a number over at a rounding.
const LAST_PLACES: f64 = 1.0;

/// The numbers of a table with the value of their last place, and everything between them.
fn take_apart(table: &str) -> (Vec<(f64, f64)>, String) {
    let is_number = |c: char| c.is_ascii_digit() || c == '.';
    let (mut numbers, mut rest) = (Vec::new(), String::new());
    for word in table.split_inclusive(|c| !is_number(c)) {
        let digits = word.trim_end_matches(|c| !is_number(c));
        if let Ok(number) = digits.parse() {
            let decimals = digits
                .split_once('.')
                .map_or(0, |(_, decimals)| decimals.len());
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
        && was
            .iter()
            .zip(&is)
            .all(|((was, place), (is, _))| (was - is).abs() < (LAST_PLACES + 0.5) * place)
}

#[test]
fn the_tables_of_results_are_those_of_the_kept_comparison() {
    let Some(made) = Tables::made(&root().join(PAPER).join("paper.json")) else {
        return;
    };
    assert_eq!(made.tables.len(), 12);
    made.hold(|file| !file.starts_with(PAPER));
    let mut of_table: Vec<&str> = CONTROLLERS
        .iter()
        .filter(|entry| matches!(entry.knows, Knows::Nothing | Knows::Identified))
        .map(|entry| entry.name)
        .filter(|name| *name != BASELINE)
        .collect();
    let mut without_model: Vec<&str> = made.without_model.iter().map(String::as_str).collect();
    of_table.sort_unstable();
    without_model.sort_unstable();
    assert_eq!(without_model, of_table);
}

/// These machines and controllers of a kept comparison, with its values.
pub(crate) fn of_kept(
    kept: &Comparison,
    workpieces: Vec<Workpiece>,
    knowledge: &[Knowledge],
    machines: Vec<Machine>,
    controllers: &[&str],
) -> ComparisonOptions {
    ComparisonOptions {
        workpieces,
        nominal: Machine::load(kept.nominal.as_ref()).unwrap(),
        machines,
        controllers: controllers
            .iter()
            .map(|name| CONTROLLERS.find(name).unwrap())
            .collect(),
        knowledge: knowledge.to_vec(),
        seed: kept.seed,
        noise_seeds: kept.noise_seeds,
        tuning: Tuning::Known(kept.tuned.clone()),
        set: Vec::new(),
        at_tolerance: false,
    }
}

/// Checks that the program makes the rows of a kept comparison again.
pub(crate) fn is_made_anew(kept: &Comparison, options: &ComparisonOptions) {
    let made = compare(options, &Kept::none(), &()).unwrap();
    assert!(
        made.rows.len()
            >= options.workpieces.len() * options.machines.len() * options.controllers.len()
    );
    for row in &made.rows {
        let was = kept
            .row(&row.contour, &row.machine, &row.controller)
            .unwrap();
        for (was, is) in [
            (was.rms_um, row.rms_um),
            (was.max_um, row.max_um),
            (was.time_s, row.time_s),
        ] {
            assert_eq!(
                was, is,
                "hint: `just tables`, or `just noise-levels`\n{row:?}"
            );
        }
    }
}

fn cut_anew(
    file: &str,
    workpieces: Vec<Workpiece>,
    knowledge: &[Knowledge],
    machines: &[&str],
    controllers: &[&str],
) {
    let kept = kept(file);
    let machines = machines
        .iter()
        .map(|name| Machine::load(name.as_ref()).unwrap())
        .collect();
    is_made_anew(
        &kept,
        &of_kept(&kept, workpieces, knowledge, machines, controllers),
    );
}

/// The whole takes minutes.
#[test]
fn the_kept_comparison_is_what_the_program_makes() {
    let mut contours = Workpiece::contours();
    contours.retain(|workpiece| ["ellipse", "square"].contains(&workpiece.name.as_str()));
    let controllers = [
        "uncorrected",
        "cross-coupled",
        "feedforward",
        "model-predictive",
        "two-dimensional",
    ];
    let knowledge = [Knowledge::Own, Knowledge::Unseen];
    cut_anew(
        COMPARISON,
        contours,
        &knowledge,
        &["tnv40", "rough", "soft"],
        &controllers,
    );
}

/// A contour and a program, as they were drawn.
#[test]
fn the_kept_held_out_work_is_what_the_program_makes() {
    let mut held_out = HeldOutSeeds::recorded().workpieces();
    let drawn: Vec<Workpiece> = [held_out.remove(0), held_out.pop().unwrap()].into();
    let knowledge = [Knowledge::Own, Knowledge::TwentyPercentOff];
    let controllers = [
        "uncorrected",
        "feedforward-cross-coupled",
        "kalman-disturbance",
    ];
    cut_anew(HELD_OUT, drawn, &knowledge, &["workshop"], &controllers);
}

#[test]
fn the_seeds_in_the_study_are_those_of_the_program() {
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    let paper = experiment(&machine, &(1..=SEEDS).collect::<Vec<_>>(), &()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("paper.json");
    std::fs::write(&file, serde_json::to_string(&paper).unwrap()).unwrap();
    if let Some(made) = Tables::made(&file) {
        made.hold(|file| file.starts_with(PAPER));
    }
}

#[test]
fn only_the_last_place_of_a_number_may_differ() {
    assert!(same("| a | 1.2 s, 3.4 |", "| a | 1.3 s, 3.4 |"));
    assert!(!same("| a | 1.2 s, 3.4 |", "| a | 1.4 s, 3.4 |"));
    assert!(!same("| a | 1.2 s, 3.4 |", "| b | 1.2 s, 3.4 |"));
    assert!(!same("| a | 1.2 |", "| a | 1.2 | 3 |"));
}
