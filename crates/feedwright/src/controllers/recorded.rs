//! Values of the parameters that a search on a machine file found: a line of JSON for each
//! controller and machine.
//!
//! The laboratory searches them (`feedwright-lab compare --record`) and holds the lines of the
//! controllers of this crate to its own. Values are of a machine file as it was: where that has
//! changed, they are not used.

use feedwright_sim::Machine;
use serde::Deserialize;

use super::{Choices, Entry, Setting};

/// A search that gains less than this part of the uncorrected error counts as none: parts differ by
/// as much.
const LEAST_GAIN: f64 = 0.05;

/// A line.
#[derive(Debug, Deserialize)]
struct RecordedLine {
    machine_file: String,
    tuned: TunedLine,
}

#[derive(Debug, Deserialize)]
struct TunedLine {
    machine: String,
    controller: String,
    values: Vec<ValueLine>,
    rms_um: f64,
    open_um: f64,
    #[serde(default)]
    switched_off: bool,
}

#[derive(Debug, Deserialize)]
struct ValueLine {
    name: String,
    value: f64,
}

/// Recorded result of the search for a controller's values on a machine.
#[derive(Debug, Clone, PartialEq)]
pub enum RecordedValues {
    /// Values that are better than no correction.
    Set(Vec<Setting>),
    /// The search found nothing that is clearly better than no correction.
    Unsuited,
}

/// Finds the record of a controller on a machine, if there is one. Ignores lines that cannot be
/// read.
pub(super) fn find(
    lines: &str,
    machine: &Machine,
    entry: &'static Entry,
) -> Option<RecordedValues> {
    let named = lines
        .lines()
        .filter(|line| line.contains(entry.name) && line.contains(machine.name.as_str()));
    let read = named.filter_map(|line| serde_json::from_str::<RecordedLine>(line).ok());
    let fingerprint = machine.fingerprint();
    let line = { read }.find(|line| {
        let tuned = &line.tuned;
        tuned.controller == entry.name
            && tuned.machine == machine.name
            && line.machine_file == fingerprint
    })?;
    if line.tuned.switched_off || line.tuned.rms_um > (1.0 - LEAST_GAIN) * line.tuned.open_um {
        return Some(RecordedValues::Unsuited);
    }
    let setting = |value: &ValueLine| {
        let name = entry.parameter(&value.name)?.name;
        Some(Setting {
            controller: entry.name,
            name,
            value: value.value,
        })
    };
    Some(RecordedValues::Set(
        line.tuned.values.iter().filter_map(setting).collect(),
    ))
}

impl Choices {
    /// Takes what is recorded of controllers for a machine, where the user sets nothing of them. A
    /// controller that does not suit the machine cuts uncorrected.
    pub fn take_recorded(
        &mut self,
        recorded: impl Iterator<Item = (&'static Entry, RecordedValues)>,
    ) {
        let given: Vec<&str> = self.set.iter().map(|setting| setting.controller).collect();
        for (entry, values) in recorded.filter(|(entry, _)| !given.contains(&entry.name)) {
            match values {
                RecordedValues::Set(set) => self.set.extend(set),
                RecordedValues::Unsuited => self.unsuited.push(entry.name.to_owned()),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::CONTROLLERS;
    use super::*;

    #[test]
    fn values_are_taken_of_the_same_machine_file_and_never_over_those_of_the_user() {
        let machine = Machine::load("tnv40".as_ref()).unwrap();
        let entry = CONTROLLERS.find("two-dimensional").unwrap();
        let found = CONTROLLERS.recorded(&machine, entry).unwrap();
        let RecordedValues::Set(set) = &found else {
            panic!("{found:?}")
        };
        assert!(
            set.iter()
                .any(|setting| setting.name == "eta" && setting.value > 0.0),
            "{set:?}"
        );
        let mut other = machine.clone();
        other.axes[0].kp_1_s *= 2.0;
        assert_eq!(CONTROLLERS.recorded(&other, entry), None);
        let own = vec![Setting {
            controller: entry.name,
            name: "rho",
            value: 0.05,
        }];
        let mut choices = Choices {
            set: own.clone(),
            ..Choices::default()
        };
        choices.take_recorded([(entry, found.clone())].into_iter());
        assert_eq!(choices.set, own);
        let mut choices = Choices::default();
        choices.take_recorded([(entry, found), (entry, RecordedValues::Unsuited)].into_iter());
        assert!(
            choices.set.len() == 2 && choices.unsuited == [entry.name],
            "{choices:?}"
        );
    }

    #[test]
    fn the_paper_s_controller_is_recorded_as_unsuited_where_its_search_found_nothing() {
        let machine = Machine::load("workshop".as_ref()).unwrap();
        for name in ["magnitude-only", "two-dimensional"] {
            let entry = CONTROLLERS.find(name).unwrap();
            assert_eq!(
                CONTROLLERS.recorded(&machine, entry),
                Some(RecordedValues::Unsuited),
                "{name}"
            );
        }
    }
}
