//! What was found of a geometry, as text and as JSON.

use feedwright_sim::to_four_digits;
use serde_json::{Value, json};

use super::fit::FoundGeometry;

impl FoundGeometry {
    /// Lines for people.
    pub fn lines(&self) -> Vec<String> {
        let mut lines: Vec<String> = self
            .values
            .iter()
            .map(|found| {
                format!(
                    "{:<16} {:>10} +- {} {}",
                    found.name, found.value, found.std, found.unit
                )
            })
            .collect();
        for axis in self
            .file
            .axes
            .iter()
            .zip(feedwright_sim::AXIS_NAMES)
            .filter(|(axis, _)| !axis.table.is_empty())
        {
            let (axis, name) = axis;
            lines.push(format!(
                "{:<16} {:>10} positions +- {} um",
                format!("table {name}"),
                axis.table.len(),
                axis.table_std_um
            ));
        }
        for set in &self.sets {
            let repeats = set.repeatability_um.map_or_else(
                || "each place was measured once".to_owned(),
                |um| format!("repeatability {} um", to_four_digits(um)),
            );
            lines.push(format!(
                "{}: {} um RMS before, {} um left, {} values, {repeats}",
                set.name,
                to_four_digits(set.before_um),
                to_four_digits(set.left_um),
                set.rows
            ));
            let nuisances = set
                .nuisances
                .iter()
                .map(|(name, value, unit)| format!("{name} {} {unit}", to_four_digits(*value)));
            lines.push(format!("  {}", nuisances.collect::<Vec<_>>().join(", ")));
            lines.extend(
                set.circularity
                    .map(|circularity| format!("  {}", circularity.line())),
            );
        }
        lines.extend(self.notes.iter().cloned());
        lines
    }

    /// The keys of docs/json.md below `identify --geometry`.
    pub fn json(&self) -> Value {
        let values = self
            .values
            .iter()
            .map(|of| json!({"name": of.name, "unit": of.unit, "value": of.value, "std": of.std}));
        let sets = self.sets.iter().map(|set| {
            let nuisances = set
                .nuisances
                .iter()
                .map(|(name, value, unit)| json!({"name": name, "value": value, "unit": unit}));
            json!({
                "name": set.name,
                "rows": set.rows,
                "before_um": set.before_um,
                "left_um": set.left_um,
                "repeatability_um": set.repeatability_um,
                "correlation": set.correlation,
                "circularity": set.circularity.map(|of| json!({
                    "g_ccw_um": of.deviation_um[0],
                    "g_cw_um": of.deviation_um[1],
                    "h_um": of.hysteresis_um,
                    "f_um": of.radial_um,
                })),
                "nuisances": nuisances.collect::<Vec<_>>(),
            })
        });
        json!({
            "values": values.collect::<Vec<_>>(),
            "sets": sets.collect::<Vec<_>>(),
            "notes": self.notes,
            "before_um": self.check.before_um,
            "after_um": self.check.after_um,
            "rows": self.check.rows,
        })
    }
}
