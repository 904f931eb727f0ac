//! The tables of the documents: made here, written by `just tables`, held by the golden tests.

use std::fmt::Write;
use std::ops::Range;
use std::path::PathBuf;

use feedwright::controllers::{CONTROLLERS, Choices, Entry};
use feedwright::machine::Machine;
use feedwright::paper::{Numbers, experiment};
use feedwright::pipeline::{Job, Outputs, run};
use feedwright::report::RunSummary;

/// The machine of all tables.
const MACHINE: &str = "tnv40";
/// Seed of the results: the default of the command line.
const SEED: u64 = 1;
/// Seeds of the paper's experiment: the default of the command line.
const SEEDS: u64 = 10;
/// What stands before and after a table.
const MARKERS: [&str; 2] = ["<!-- table made by `just tables` -->\n", "<!-- end of table -->\n"];

/// Every error here ends the program that asked.
type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// A table and the document it stands in.
pub(crate) struct Place {
    /// Document, from the root of the repository.
    pub(crate) file: &'static str,
    /// The table in Markdown.
    pub(crate) table: String,
}

/// Root of the repository.
pub(crate) fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

impl Place {
    /// Every controller on every part.
    pub(crate) fn results() -> Result<Self> {
        Ok(Self { file: "README.md", table: results()? })
    }

    /// The experiment of the paper, seed by seed.
    pub(crate) fn paper() -> Result<Self> {
        Ok(Self { file: "examples/01_paper_circle/README.md", table: paper()? })
    }

    /// Where in the text of the document the table stands.
    pub(crate) fn find(&self, text: &str) -> Result<Range<usize>> {
        let [before, after] = MARKERS;
        let start = text.find(before).ok_or_else(|| format!("{} has no line {before}", self.file))? + before.len();
        let length = text[start..].find(after).ok_or_else(|| format!("{} has no line {after}", self.file))?;
        Ok(start..start + length)
    }
}

/// One line for each part, one column for each controller: RMS and largest error, and the time against open loop.
fn results() -> Result<String> {
    let mut parts: Vec<PathBuf> =
        std::fs::read_dir(root().join("parts"))?.map(|part| Ok(part?.path())).collect::<Result<_>>()?;
    parts.retain(|part| part.extension().is_some_and(|ending| ending == "ngc"));
    parts.sort();
    let machine = Machine::load(MACHINE.as_ref())?;
    let mut table = String::from("| part | open-loop time |");
    CONTROLLERS.iter().try_for_each(|entry| write!(table, " {} |", entry.name))?;
    writeln!(table, "\n|---|--:|{}", "--:|".repeat(CONTROLLERS.len()))?;
    for part in parts {
        let runs: Vec<RunSummary> =
            CONTROLLERS.iter().map(|entry| cut(&machine, &part, entry)).collect::<Result<_>>()?;
        let name = part.file_stem().unwrap_or_default().to_string_lossy();
        write!(table, "| {name} | {:.2} s |", runs[0].time_s)?;
        for run in &runs {
            write!(table, " {:.1} / {:.1}", run.rms_um, run.max_um)?;
            if run.time_s != runs[0].time_s {
                write!(table, " in {:.2}", run.time_s / runs[0].time_s)?;
            }
            write!(table, " |")?;
        }
        writeln!(table)?;
    }
    Ok(table)
}

/// What `feedwright run` measures of one part under one controller.
fn cut(machine: &Machine, part: &std::path::Path, entry: &'static Entry) -> Result<RunSummary> {
    let job = Job {
        part: part.to_owned(),
        machine: machine.clone(),
        controller: entry,
        against: entry,
        feed_mm_s: None,
        choices: Choices { seed: SEED, ..Choices::default() },
        tolerance_um: None,
        reader: feedwright::gcode::Settings::default(),
        inputs: Vec::new(),
        outputs: Outputs::default(),
    };
    let mut runs = run(&job, &mut ())?.report.runs;
    Ok(runs.pop().ok_or("a job makes at least one run")?.summary)
}

/// One line for each seed.
fn paper() -> Result<String> {
    let paper = experiment(&Machine::load(MACHINE.as_ref())?, &(1..=SEEDS).collect::<Vec<_>>(), &|| {});
    let mut table = String::from(
        "| seed | fit | open loop | magnitude only, same time | magnitude only, same rho | two-dimensional | RMS ratio | max ratio \
         | time ratio | exact gradient |\n|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    let cell = |n: &Numbers| format!("{:.3} s, {:.1} / {:.1}", n.time_s, n.rms_um, n.max_um);
    for s in &paper.seeds {
        let (open, magnitude, both) = (&s.open_loop, &s.magnitude_only, &s.two_dimensional);
        writeln!(
            table,
            "| {} | {:.1} | {} | {} | {} | {} | {:.3} | {:.3} | {:.3} | {} |",
            s.seed,
            s.fit_um,
            cell(open),
            cell(magnitude),
            cell(&s.magnitude_only_same_rho),
            cell(both),
            both.rms_um / magnitude.rms_um,
            both.max_um / magnitude.max_um,
            both.time_s / open.time_s,
            cell(&s.two_dimensional_exact_gradient),
        )?;
    }
    writeln!(
        table,
        "| worst | | | | | | {:.3} | {:.3} | {:.3} | |",
        paper.worst_rms_ratio, paper.worst_max_ratio, paper.worst_time_ratio
    )?;
    Ok(table)
}
