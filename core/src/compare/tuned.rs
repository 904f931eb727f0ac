//! The values of a controller's parameters in a comparison.

use serde::{Deserialize, Serialize};

use crate::controllers::{Entry, Setting};
use crate::number::to_four_digits;

/// The values that a search came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Tuned {
    /// Controller.
    pub controller: String,
    /// Names and values, in the order of the controller's parameters.
    pub values: Vec<(String, f64)>,
    /// Cuts that it took; 0 where nothing was searched.
    pub cuts: u64,
    /// RMS contour error at these values, um; 0 where nothing was searched.
    pub rms_um: f64,
}

impl Tuned {
    /// The defaults.
    pub fn defaults(entry: &Entry) -> Self {
        let values = entry.searched().map(|(p, _)| (p.name.to_owned(), p.default)).collect();
        Self { controller: entry.name.to_owned(), values, cuts: 0, rms_um: 0.0 }
    }

    /// The defaults with what is set.
    pub fn set(entry: &Entry, set: &[Setting]) -> Self {
        let mut tuned = Self::defaults(entry);
        for set in set.iter().filter(|set| set.controller == entry.name) {
            match tuned.values.iter_mut().find(|(name, _)| name == set.name) {
                Some((_, value)) => *value = set.value,
                None => tuned.values.push((set.name.to_owned(), set.value)),
            }
        }
        tuned
    }

    /// The values as they are set.
    pub fn settings(&self, entry: &'static Entry) -> Vec<Setting> {
        let setting = |(name, value): &(String, f64)| {
            Some(Setting { controller: entry.name, name: entry.parameter(name)?.name, value: *value })
        };
        self.values.iter().filter_map(setting).collect()
    }

    /// Names and values in words, to four digits.
    pub fn words(&self) -> String {
        let values: Vec<String> =
            self.values.iter().map(|(name, value)| format!("{name} {}", to_four_digits(*value))).collect();
        values.join(", ")
    }
}
