//! The tables of the documents: made here, written by `just tables`, held by the golden tests.

#[path = "realism.rs"]
mod realism;

use std::fmt::Write;
use std::ops::Range;
use std::path::PathBuf;

use feedwright::BASELINE;
use feedwright_control::Knows;
use feedwright_lab::{
    CONTROLLERS, Claimed, Comparison, ComparisonRow, Numbers, each_once, experiment,
};
use feedwright_sim::Machine;

/// The machine of the paper.
const MACHINE: &str = "tnv40";
/// Seeds of the paper's experiment: the default of the command line.
const SEEDS: u64 = 10;
/// The comparison on machines without noise.
pub(crate) const COMPARISON: &str = "examples/02_contours/compare.json";
/// The comparison on machines with noise, on held-out work.
pub(crate) const HELD_OUT: &str = "examples/03_realism/held_out.json";
/// The comparison on machines with one imperfection each.
pub(crate) const IMPERFECTIONS: &str = "examples/03_realism/imperfections.json";
/// Text after a table.
const END: &str = "<!-- end of table -->\n";

/// Every error here ends the program that asked.
type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

/// A table and the document it stands in.
pub(crate) struct Place {
    /// Document, from the root of the repository.
    pub(crate) file: &'static str,
    /// Name of the table in the document.
    pub(crate) name: &'static str,
    /// The table in Markdown.
    pub(crate) table: String,
}

/// Root of the repository.
pub(crate) fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// A comparison as it is kept.
pub(crate) fn comparison(file: &str) -> Result<Comparison> {
    Ok(Comparison::read(&std::fs::read_to_string(
        root().join(file),
    )?)?)
}

impl Place {
    /// The tables that show the comparisons.
    pub(crate) fn results() -> Result<Vec<Self>> {
        let [comparison, held_out, imperfections] = [
            comparison(COMPARISON)?,
            comparison(HELD_OUT)?,
            comparison(IMPERFECTIONS)?,
        ];
        let results = |name, table| Self {
            file: "docs/results.md",
            name,
            table,
        };
        let realism = |name, table| Self {
            file: "examples/03_realism/README.md",
            name,
            table,
        };
        let study = |name, table| Self {
            file: "examples/02_contours/README.md",
            name,
            table,
        };
        Ok(vec![
            results("contours", contours(&comparison, SHOWN)?),
            results("held-out work", realism::held_out(&held_out)?),
            study(
                "contours",
                contours(&comparison, &controllers(&comparison))?,
            ),
            study("machines", machines(&comparison)?),
            study("tuned", tuned(&comparison)?),
            study("claims", claims(&comparison)?),
            study("tolerance", tolerance(&comparison)?),
            realism("held-out work", realism::held_out(&held_out)?),
            realism("imperfections", realism::imperfections(&imperfections)?),
            realism("claims", claims(&held_out)?),
            realism("tuned", tuned(&held_out)?),
        ])
    }

    /// The experiment of the paper, seed by seed.
    pub(crate) fn paper() -> Result<Self> {
        Ok(Self {
            file: "examples/01_paper_circle/README.md",
            name: "seeds",
            table: paper()?,
        })
    }

    /// Returns the place of the table in the text of the document.
    pub(crate) fn find(&self, text: &str) -> Result<Range<usize>> {
        let before = format!("<!-- table of {}, made by `just tables` -->\n", self.name);
        let start = text
            .find(&before)
            .ok_or_else(|| format!("{} has no line {before}", self.file))?
            + before.len();
        let length = text[start..]
            .find(END)
            .ok_or_else(|| format!("{} has no line {END}", self.file))?;
        Ok(start..start + length)
    }
}

/// Controllers that docs/results.md shows.
const SHOWN: &[&str] = &[
    "uncorrected",
    "two-dimensional",
    "contour-compensation",
    "cross-coupled",
    "cross-coupled-feedrate",
    "corner-contour",
    "constrained-feedrate",
    "fuzzy-h-infinity",
    "feedforward-as-delivered",
    "feedforward",
    "feedforward-cross-coupled",
    "model-predictive",
    "lqg-identified",
];

fn controllers(comparison: &Comparison) -> Vec<&str> {
    let nominal = comparison
        .rows
        .iter()
        .filter(|row| row.machine == comparison.nominal);
    each_once(nominal.map(|row| &row.controller))
}

fn find<'a>(
    comparison: &'a Comparison,
    contour: &str,
    machine: &str,
    controller: &str,
) -> Result<&'a ComparisonRow> {
    let row = comparison.row(contour, machine, controller);
    Ok(row.ok_or_else(|| format!("{COMPARISON} has no {controller} on {contour} and {machine}"))?)
}

/// Writes the first two lines of a table in Markdown.
fn heading(table: &mut String, first: &str, columns: &[&str]) -> Result<()> {
    write!(table, "| {first} |")?;
    columns
        .iter()
        .try_for_each(|column| write!(table, " {column} |"))?;
    writeln!(table, "\n|---|{}", "--:|".repeat(columns.len()))?;
    Ok(())
}

/// One line for each controller, one column for each contour, on the nominal machine: RMS and
/// largest error.
fn contours(comparison: &Comparison, controllers: &[&str]) -> Result<String> {
    let contours = comparison.contours();
    let mut table = String::new();
    heading(&mut table, "RMS / max, \u{b5}m", &contours)?;
    for controller in controllers {
        write!(table, "| {controller} |")?;
        for contour in &contours {
            let row = find(comparison, contour, &comparison.nominal, controller)?;
            write!(table, " {:.2} / {:.1}", row.rms_um, row.max_um)?;
            if (row.time_ratio - 1.0).abs() > 0.005 {
                write!(table, " in {:.2}", row.time_ratio)?;
            }
            write!(table, " |")?;
        }
        writeln!(table)?;
    }
    Ok(table)
}

/// One line for each machine: RMS over all contours.
fn machines(comparison: &Comparison) -> Result<String> {
    let over_all = |machine: &str, controller: &str| {
        let rms_um = comparison.rms_over_contours_um(machine, controller);
        rms_um.ok_or_else(|| {
            format!("{COMPARISON} has not every contour of {controller} on {machine}")
        })
    };
    let mut table = String::new();
    let columns = ["uncorrected", "best of those without model"];
    heading(&mut table, "RMS over all contours, \u{b5}m", &columns)?;
    for machine in comparison.machines() {
        let mut peers = Vec::new();
        for entry in CONTROLLERS {
            if matches!(entry.knows, Knows::Nothing | Knows::Identified) && entry.name != BASELINE {
                peers.push((over_all(machine, entry.name)?, entry.name));
            }
        }
        let (rms_um, name) = peers
            .into_iter()
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .ok_or("there are no peers")?;
        let open = over_all(machine, BASELINE)?;
        writeln!(table, "| {machine} | {open:.2} | {rms_um:.2} ({name}) |")?;
    }
    Ok(table)
}

/// Returns the table of the search results.
fn tuned(comparison: &Comparison) -> Result<String> {
    let mut table = String::from(
        "| controller | machine | evaluations | RMS, \u{b5}m | uncorrected, \u{b5}m | values |\n|---|---|--:|--:|--:|---|\n",
    );
    for tuned in &comparison.tuned {
        let (controller, machine, words) = (&tuned.controller, &tuned.machine, tuned.words());
        let errors = format!("{:.3} | {:.2}", tuned.rms_um, tuned.open_um);
        writeln!(
            table,
            "| {controller} | {machine} | {} | {errors} | {words} |",
            tuned.cuts
        )?;
    }
    Ok(table)
}

/// Places where a claim falls short that are named.
const NAMED: usize = 6;

/// One line for each claim: on how many contours and machines it holds, and where it does not.
fn claims(comparison: &Comparison) -> Result<String> {
    let mut table =
        String::from("| claim | limit | holds | worst | falls short on |\n|---|--:|--:|--:|---|\n");
    for Claimed {
        claim,
        limit,
        unit,
        held,
        of,
        worst,
        short,
    } in &comparison.claims
    {
        let unit = unit.replace("um", "\u{b5}m");
        let place = |(contour, machine, value): &(String, String, f64)| {
            format!("{contour} on {machine} ({value:.2})")
        };
        let mut places: Vec<String> = short.iter().take(NAMED).map(place).collect();
        if let more @ 1.. = short.len().saturating_sub(NAMED) {
            places.push(format!("and {more} more"));
        }
        writeln!(
            table,
            "| {claim} | {limit} {unit} | {held} of {of} | {worst:.3} | {} |",
            places.join(", ")
        )?;
    }
    Ok(table)
}

/// Machining time at equal tolerance, against uncorrected.
fn tolerance(comparison: &Comparison) -> Result<String> {
    let rows = &comparison.at_tolerance;
    let contours = each_once(rows.iter().map(|row| &row.contour));
    let mut table = String::new();
    heading(
        &mut table,
        "feedrate in mm/s, time against uncorrected",
        &contours,
    )?;
    for controller in each_once(rows.iter().map(|row| &row.controller)) {
        write!(table, "| {controller} |")?;
        for contour in &contours {
            match comparison.just_holding(contour, controller) {
                Some((feed_mm_s, ratio)) => write!(table, " {feed_mm_s:.0}, {ratio:.2} |")?,
                None => write!(table, " never |")?,
            }
        }
        writeln!(table)?;
    }
    Ok(table)
}

/// One line for each seed.
fn paper() -> Result<String> {
    let paper = experiment(
        &Machine::load(MACHINE.as_ref())?,
        &(1..=SEEDS).collect::<Vec<_>>(),
        &(),
    )?;
    let mut table = String::from(
        "| seed | fit | uncorrected | magnitude only, same time | magnitude only, same rho | two-dimensional | RMS ratio | max ratio \
         | time ratio | exact gradient |\n|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
    );
    let cell = |n: &Numbers| format!("{:.3} s, {:.1} / {:.1}", n.time_s, n.rms_um, n.max_um);
    for s in &paper.seeds {
        let (open, magnitude, both) = (&s.uncorrected, &s.magnitude_only, &s.two_dimensional);
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
