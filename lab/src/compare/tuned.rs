//! The values of a controller's parameters on a machine.

use feedwright::{Entry, Setting};
use feedwright_sim::to_four_digits;
use serde::{Deserialize, Serialize};

/// The values that a controller runs with on a machine, and the results of the search.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Tuned {
    /// Machine.
    pub machine: String,
    /// Controller.
    pub controller: String,
    /// Values in the order of the controller's parameters.
    pub values: Vec<TunedValue>,
    /// Evaluations that the search took; 0 where nothing was searched.
    pub cuts: u64,
    /// RMS contour error at these values over what it was searched on, um; 0 where nothing was
    /// searched.
    pub rms_um: f64,
    /// RMS contour error of the uncorrected cut over the same work, um; 0 where nothing was
    /// searched.
    pub open_um: f64,
    /// True if the search found nothing better than no correction.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub switched_off: bool,
}

/// A value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TunedValue {
    /// Name of the parameter.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// End of the searched range that the value is at, if it is at one: a better one may lie
    /// beyond.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_end: Option<RangeEnd>,
}

/// An end of a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RangeEnd {
    /// The least.
    Low,
    /// The most.
    High,
}

impl TunedValue {
    fn of(name: &str, value: f64) -> Self {
        Self {
            name: name.to_owned(),
            value,
            at_end: None,
        }
    }
}

impl Tuned {
    /// The defaults.
    pub fn defaults(machine: &str, entry: &Entry) -> Self {
        let searched = entry.searched();
        Self {
            machine: machine.to_owned(),
            controller: entry.name.to_owned(),
            values: searched
                .map(|(p, _)| TunedValue::of(p.name, p.default))
                .collect(),
            cuts: 0,
            rms_um: 0.0,
            open_um: 0.0,
            switched_off: false,
        }
    }

    /// The defaults with what is set.
    pub fn set(machine: &str, entry: &Entry, set: &[Setting]) -> Self {
        let mut tuned = Self::defaults(machine, entry);
        for set in set.iter().filter(|set| set.controller == entry.name) {
            match tuned.values.iter_mut().find(|value| value.name == set.name) {
                Some(value) => value.value = set.value,
                None => tuned.values.push(TunedValue::of(set.name, set.value)),
            }
        }
        tuned
    }

    /// The values as they are set.
    pub fn settings(&self, entry: &'static Entry) -> Vec<Setting> {
        let setting = |value: &TunedValue| {
            let name = entry.parameter(&value.name)?.name;
            Some(Setting {
                controller: entry.name,
                name,
                value: value.value,
            })
        };
        self.values.iter().filter_map(setting).collect()
    }

    /// Names and values in words, to four digits; `(low end)` behind one that is at an end of its
    /// range.
    pub fn words(&self) -> String {
        let value = |value: &TunedValue| {
            let end = match value.at_end {
                Some(RangeEnd::Low) => " (low end)",
                Some(RangeEnd::High) => " (high end)",
                None => "",
            };
            format!("{} {}{end}", value.name, to_four_digits(value.value))
        };
        let mut words: Vec<String> = self.values.iter().map(value).collect();
        if self.switched_off {
            words.push("switched off: no better than uncorrected".to_owned());
        }
        words.join(", ")
    }
}
