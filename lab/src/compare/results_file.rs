//! The file of a comparison: what tables and figures of the documents are made of. One line for
//! each controller on a machine, with a number for each contour; ratios follow from the lines of
//! the uncorrected cut.
//!
//! The other columns of the table (uncut path, torque and more) are printed, and claimed in
//! [`super::verdict`], and not kept.

use feedwright::BASELINE;
use serde::{Deserialize, Serialize};
use serde_json::json;

use super::Comparison;
use super::overview::Claimed;
use super::table::{ComparisonRow, against, each_once};
use super::tolerance::AtTolerance;
use super::tuned::Tuned;

/// The rows of a controller on a machine.
#[derive(Serialize, Deserialize)]
struct RowsLine {
    machine: String,
    controller: String,
    time_s: Vec<f64>,
    rms_um: Vec<f64>,
    max_um: Vec<f64>,
    /// Empty if the machine has no geometry that the encoders cannot see.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    joint_rms_um: Vec<f64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    joint_max_um: Vec<f64>,
    /// Empty if no cut was lost.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    lost: Vec<u32>,
    /// Empty if every cut came to its end.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    diverged: Vec<bool>,
}

#[derive(Deserialize)]
struct ResultsFile {
    nominal: String,
    seed: u64,
    noise_seeds: u32,
    contours: Vec<String>,
    tuned: Vec<Tuned>,
    rows: Vec<RowsLine>,
    claims: Vec<Claimed>,
    at_tolerance: Vec<AtTolerance>,
}

impl RowsLine {
    fn of(rows: &[&ComparisonRow]) -> Self {
        fn unless<T>(none: impl Fn(&T) -> bool, values: Vec<T>) -> Vec<T> {
            if values.iter().all(none) {
                vec![]
            } else {
                values
            }
        }
        let each = |number: fn(&ComparisonRow) -> f64| rows.iter().map(|row| number(row)).collect();
        let joint = |number: fn(&ComparisonRow) -> Option<f64>| {
            rows.iter().filter_map(|row| number(row)).collect()
        };
        Self {
            machine: rows[0].machine.clone(),
            controller: rows[0].controller.clone(),
            time_s: each(|row| row.time_s),
            rms_um: each(|row| row.rms_um),
            max_um: each(|row| row.max_um),
            joint_rms_um: joint(|row| row.joint_rms_um),
            joint_max_um: joint(|row| row.joint_max_um),
            lost: unless(|lost| *lost == 0, rows.iter().map(|row| row.lost).collect()),
            diverged: unless(
                |diverged| !diverged,
                rows.iter().map(|row| !row.completed).collect(),
            ),
        }
    }

    /// The row of the contour with this number.
    fn row(&self, i: usize, contour: &str) -> ComparisonRow {
        ComparisonRow {
            contour: contour.to_owned(),
            machine: self.machine.clone(),
            controller: self.controller.clone(),
            time_s: self.time_s[i],
            rms_um: self.rms_um[i],
            max_um: self.max_um[i],
            joint_rms_um: self.joint_rms_um.get(i).copied(),
            joint_max_um: self.joint_max_um.get(i).copied(),
            lost: self.lost.get(i).copied().unwrap_or_default(),
            completed: !self.diverged.get(i).copied().unwrap_or_default(),
            ..ComparisonRow::default()
        }
    }
}

/// A list with an item a line.
fn lines<T: Serialize>(items: impl IntoIterator<Item = T>) -> String {
    let items: Vec<String> = items
        .into_iter()
        .map(|item| json!(item).to_string())
        .collect();
    format!("[\n{}\n]", items.join(",\n"))
}

impl Comparison {
    /// The text of the file.
    pub fn text(&self) -> String {
        let mut rows = Vec::new();
        for machine in self.machines() {
            let here = || self.rows.iter().filter(|row| row.machine == machine);
            for controller in each_once(here().map(|row| &row.controller)) {
                let its: Vec<_> = here().filter(|row| row.controller == controller).collect();
                rows.push(RowsLine::of(&its));
            }
        }
        format!(
            "{{\"nominal\":{},\"seed\":{},\"noise_seeds\":{},\"contours\":{},\n\"tuned\":{},\n\"rows\":{},\n\"claims\":{},\n\"at_tolerance\":{}}}\n",
            json!(self.nominal),
            self.seed,
            self.noise_seeds,
            json!(self.contours()),
            lines(&self.tuned),
            lines(rows),
            lines(&self.claims),
            lines(&self.at_tolerance)
        )
    }

    /// Reads such a file. What it does not have is 0 or empty: the verdicts, and columns of the
    /// rows.
    ///
    /// # Errors
    /// A text that is no such file.
    pub fn read(text: &str) -> serde_json::Result<Self> {
        let ResultsFile {
            nominal,
            seed,
            noise_seeds,
            contours,
            tuned,
            rows: found,
            claims,
            at_tolerance,
        } = serde_json::from_str(text)?;
        let mut rows = Vec::new();
        for (i, contour) in contours.iter().enumerate() {
            for line in &found {
                let of_base =
                    |base: &&RowsLine| base.machine == line.machine && base.controller == BASELINE;
                let base = found.iter().find(of_base).map(|base| base.row(i, contour));
                rows.push(against(line.row(i, contour), base.as_ref()));
            }
        }
        Ok(Self {
            nominal,
            seed,
            noise_seeds,
            tuned,
            rows,
            verdicts: vec![],
            claims,
            at_tolerance,
        })
    }
}
