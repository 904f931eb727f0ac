//! Results of earlier searches, kept with the program: `feedwright-lab compare --tuning search
//! --record FILE` makes the file.
//!
//! A search on all machines takes an hour and more; its result is the same to the bit, which a test
//! checks for one controller. Values belong to one version of a machine file: if the file has
//! changed, they are not used.

use feedwright_sim::Machine;
use serde::{Deserialize, Serialize};

use super::tuned::Tuned;
use crate::peers::RECORDED;

/// Result of a search.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecordedSearch {
    /// [`Machine::fingerprint`].
    pub machine_file: String,
    /// Seed of the comparison.
    pub seed: u64,
    /// The values.
    pub tuned: Tuned,
}

/// Reads a file.
///
/// # Errors
/// A line that is no such search.
pub fn read(text: &str) -> serde_json::Result<Vec<RecordedSearch>> {
    text.lines()
        .filter(|line| !line.trim().is_empty())
        .map(serde_json::from_str)
        .collect()
}

/// The values of a seed for these machines that are kept with the program.
pub fn known(machines: &[Machine], seed: u64) -> Vec<Tuned> {
    let all = read(RECORDED).expect("the recorded values are read by a test");
    let is_known = |search: &RecordedSearch| {
        let suits = |machine: &Machine| {
            machine.name == search.tuned.machine && machine.fingerprint() == search.machine_file
        };
        search.seed == seed && machines.iter().any(suits)
    };
    all.into_iter()
        .filter(is_known)
        .map(|search| search.tuned)
        .collect()
}

/// A file with what was there and new searches, which replace those of the same machine, controller
/// and seed.
pub fn text(old: Vec<RecordedSearch>, new: &[Tuned], machines: &[Machine], seed: u64) -> String {
    let of_new = new.iter().filter_map(|tuned| {
        let machine = machines
            .iter()
            .find(|machine| machine.name == tuned.machine)?;
        Some(RecordedSearch {
            machine_file: machine.fingerprint(),
            seed,
            tuned: tuned.clone(),
        })
    });
    let key = |search: &RecordedSearch| {
        (
            search.tuned.machine.clone(),
            search.tuned.controller.clone(),
            search.seed,
        )
    };
    let mut all: std::collections::BTreeMap<_, _> = old
        .into_iter()
        .map(|search| (key(&search), search))
        .collect();
    all.extend(of_new.map(|search| (key(&search), search)));
    let line = |search: &RecordedSearch| {
        serde_json::to_string(search).expect("numbers and names can be written") + "\n"
    };
    all.values().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peers::CONTROLLERS;
    use feedwright::Entry;

    #[test]
    fn every_recorded_value_is_of_a_controller_that_there_is_and_within_its_range() {
        for search in read(RECORDED).unwrap() {
            let entry = CONTROLLERS.find(&search.tuned.controller).unwrap();
            let names: Vec<&str> = search
                .tuned
                .values
                .iter()
                .map(|value| value.name.as_str())
                .collect();
            let wanted: Vec<&str> = entry
                .searched()
                .map(|(parameter, _)| parameter.name)
                .collect();
            assert_eq!(
                names, wanted,
                "{search:?}; hint: record {} anew",
                entry.name
            );
            for ((parameter, _), value) in entry.searched().zip(&search.tuned.values) {
                let [least, most] = parameter.allowed;
                assert!((least..=most).contains(&value.value), "{search:?}");
            }
        }
    }

    #[test]
    fn the_product_has_the_recorded_values_of_its_controllers() {
        let product: Vec<&str> = feedwright::CONTROLLERS
            .iter()
            .map(|entry| entry.name)
            .collect();
        let own: Vec<&str> = RECORDED
            .lines()
            .filter(|line| {
                read(line)
                    .unwrap()
                    .iter()
                    .any(|search| product.contains(&search.tuned.controller.as_str()))
            })
            .collect();
        let theirs = include_str!("../../../crates/feedwright/src/controllers/recorded.jsonl");
        assert_eq!(
            theirs.lines().collect::<Vec<_>>(),
            own,
            "hint: copy the lines of these controllers"
        );
    }

    #[test]
    fn new_searches_replace_old_ones_and_leave_others() {
        let machine = Machine::load("tnv40".as_ref()).unwrap();
        let machines = [machine];
        let tuned = |entry: &Entry, cuts| Tuned {
            cuts,
            ..Tuned::defaults("tnv40", entry)
        };
        let searched: Vec<&Entry> = CONTROLLERS
            .iter()
            .filter(|entry| entry.searched().count() > 0)
            .collect();
        let first = text(
            Vec::new(),
            &[tuned(searched[1], 1), tuned(searched[0], 2)],
            &machines,
            1,
        );
        let second = text(
            read(&first).unwrap(),
            &[tuned(searched[1], 3)],
            &machines,
            1,
        );
        let cuts: Vec<u64> = read(&second)
            .unwrap()
            .iter()
            .map(|search| search.tuned.cuts)
            .collect();
        let mut expected = [(searched[0].name, 2), (searched[1].name, 3)];
        expected.sort_unstable();
        assert_eq!(cuts, expected.map(|(_, cuts)| cuts));
        assert_eq!(text(read(&second).unwrap(), &[], &machines, 1), second);
    }
}
