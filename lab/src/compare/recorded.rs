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
    let lines = text.lines().filter(|line| !line.trim().is_empty());
    lines.map(serde_json::from_str).collect()
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
    let known = all.into_iter().filter(is_known);
    known.map(|search| search.tuned).collect()
}

/// A file with what was there and new searches, which replace those of the same machine, controller
/// and seed.
pub fn text(old: Vec<RecordedSearch>, new: &[Tuned], machines: &[Machine], seed: u64) -> String {
    let of_new = new.iter().filter_map(|tuned| {
        let mut machines = machines.iter();
        let machine = machines.find(|machine| machine.name == tuned.machine)?;
        Some(RecordedSearch {
            machine_file: machine.fingerprint(),
            seed,
            tuned: tuned.clone(),
        })
    });
    let mut all = std::collections::BTreeMap::new();
    for search in old.into_iter().chain(of_new) {
        let Tuned {
            machine,
            controller,
            ..
        } = search.tuned.clone();
        all.insert((machine, controller, search.seed), search);
    }
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
            let values = search.tuned.values.iter();
            let names: Vec<&str> = values.map(|value| value.name.as_str()).collect();
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
        let is_of_product = |line: &&str| {
            let searches = read(line).unwrap();
            let mut names = searches.iter().map(|search| &search.tuned.controller);
            names.any(|name| feedwright::CONTROLLERS.find(name).is_some())
        };
        let own: Vec<&str> = RECORDED.lines().filter(is_of_product).collect();
        let theirs = include_str!("../../../crates/feedwright/src/controllers/recorded.jsonl");
        let theirs: Vec<&str> = theirs.lines().collect();
        assert_eq!(theirs, own, "hint: copy the lines of these controllers");
    }

    #[test]
    fn new_searches_replace_old_ones_and_leave_others() {
        let machine = Machine::load("tnv40".as_ref()).unwrap();
        let machines = [machine];
        let tuned = |entry: &Entry, cuts| Tuned {
            cuts,
            ..Tuned::defaults("tnv40", entry)
        };
        let has_values = |entry: &&Entry| entry.searched().count() > 0;
        let searched: Vec<&Entry> = CONTROLLERS.iter().filter(has_values).collect();
        let both = [tuned(searched[1], 1), tuned(searched[0], 2)];
        let first = text(Vec::new(), &both, &machines, 1);
        let second = text(
            read(&first).unwrap(),
            &[tuned(searched[1], 3)],
            &machines,
            1,
        );
        let kept = read(&second).unwrap();
        let cuts: Vec<u64> = kept.iter().map(|search| search.tuned.cuts).collect();
        let mut expected = [(searched[0].name, 2), (searched[1].name, 3)];
        expected.sort_unstable();
        assert_eq!(cuts, expected.map(|(_, cuts)| cuts));
        assert_eq!(text(kept, &[], &machines, 1), second);
    }
}
