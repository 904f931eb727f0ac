//! What tables over many rows are made of: names in their order, a row by its names, an error over all contours.

use super::Comparison;
use super::table::Row;

impl Comparison {
    /// Contours and parts, in the order of the rows.
    pub fn contours(&self) -> Vec<&str> {
        each_once(self.rows.iter().map(|row| &row.contour))
    }

    /// Machines, in the order of the rows.
    pub fn machines(&self) -> Vec<&str> {
        each_once(self.rows.iter().map(|row| &row.machine))
    }

    /// Controllers, in the order of the rows.
    pub fn controllers(&self) -> Vec<&str> {
        each_once(self.rows.iter().map(|row| &row.controller))
    }

    /// The row of a cut; none where it was not asked for.
    pub fn row(&self, contour: &str, machine: &str, controller: &str) -> Option<&Row> {
        self.rows.iter().find(|row| row.contour == contour && row.machine == machine && row.controller == controller)
    }

    /// RMS contour error over all contours (quadratic mean), um; none where a cut is missing or was not completed.
    pub fn rms_over_contours_um(&self, machine: &str, controller: &str) -> Option<f64> {
        let contours = self.contours();
        let mut sum_um2 = 0.0;
        for contour in &contours {
            let row = self.row(contour, machine, controller).filter(|row| row.completed)?;
            sum_um2 += row.rms_um.powi(2);
        }
        Some((sum_um2 / contours.len() as f64).sqrt())
    }
}

/// Names of a column, each once, in the order of the rows.
pub fn each_once<'a>(names: impl Iterator<Item = &'a String>) -> Vec<&'a str> {
    let mut once: Vec<&str> = Vec::new();
    for name in names {
        if !once.contains(&name.as_str()) {
            once.push(name);
        }
    }
    once
}
