//! A machine as a list of changes to a built-in one, and the machine file that they make.
//!
//! The list is what can be drawn at random.

use std::fmt::Write;

use feedwright_sim::{Machine, MachineError};

/// A key of the machine file whose value differs from the base's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// Table of the file, such as `axis.x`.
    pub table: &'static str,
    /// Key in it, with its unit at the end.
    pub key: &'static str,
    /// Value.
    pub value: f64,
}

/// A built-in machine with changes.
#[derive(Debug, Clone, PartialEq)]
pub struct Variant {
    /// Name of the built-in machine.
    pub base: &'static str,
    /// Its own name.
    pub name: String,
    /// Changes; each key once.
    pub changes: Vec<Change>,
}

/// Tables of the axes of a machine with three.
pub const AXES: [&str; 3] = ["axis.x", "axis.y", "axis.z"];

impl Variant {
    /// The base itself under another name.
    pub fn of(base: &'static str, name: impl Into<String>) -> Self {
        Self {
            base,
            name: name.into(),
            changes: Vec::new(),
        }
    }

    /// Adds a change. It replaces an earlier change of the same key.
    #[must_use]
    pub fn with(mut self, table: &'static str, key: &'static str, value: f64) -> Self {
        self.changes
            .retain(|change| (change.table, change.key) != (table, key));
        self.changes.push(Change { table, key, value });
        self
    }

    /// Adds the same change to every axis.
    #[must_use]
    pub fn with_axes(self, key: &'static str, value: f64) -> Self {
        AXES.iter()
            .fold(self, |variant, table| variant.with(table, key, value))
    }

    /// The machine file.
    pub fn text(&self) -> String {
        let changed = match self.changes.is_empty() {
            true => "as it is",
            false => "with the changes below",
        };
        let (base, name) = (self.base, &self.name);
        let mut text = format!(
            "base = \"{base}\"\nname = \"{name}\"\ndescription = \"{base} {changed}\"\nsource = \"generated\"\n"
        );
        let mut tables: Vec<&str> = Vec::new();
        for change in &self.changes {
            if !tables.contains(&change.table) {
                tables.push(change.table);
            }
        }
        for table in tables {
            // Writing to a string does not fail.
            let _ = writeln!(text, "\n[{table}]");
            for change in self.changes.iter().filter(|change| change.table == table) {
                let _ = writeln!(text, "{} = {:?}", change.key, change.value);
            }
        }
        text
    }

    /// Returns the machine.
    ///
    /// # Errors
    /// Fails if a key does not exist or a value is out of its range.
    pub fn machine(&self) -> Result<Machine, MachineError> {
        Machine::parse(&format!("{}.toml", self.name), &self.text())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_those_of_the_machine_and_nothing_else_is() {
        let base = Machine::load("tnv40".as_ref()).expect("built in");
        let variant = Variant::of("tnv40", "odd")
            .with_axes("kp_1_s", 40.0)
            .with("axis.y", "kp_1_s", 60.0)
            .with("limits", "normal_accel_mm_s2", 1000.0);
        let machine = variant.machine().expect("valid");
        let gains = [0, 1, 2].map(|i| machine.axis(i).kp_1_s);
        assert_eq!(gains, [40.0, 60.0, 40.0]);
        assert_eq!(machine.limits.normal_accel_mm_s2, 1000.0);
        assert_eq!(machine.axis(0).inertia_kg_m2, base.axis(0).inertia_kg_m2);
        let same = Variant::of("tnv40", "same").machine().expect("valid");
        assert_eq!(same.fingerprint(), base.fingerprint());
    }

    #[test]
    fn an_unknown_key_is_refused() {
        let odd = Variant::of("tnv40", "odd").with("limits", "no_such_key", 1.0);
        assert!(odd.machine().is_err());
    }
}
