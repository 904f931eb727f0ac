//! A competitor: a controller, and its knowledge of the machine that it cuts on.
use feedwright::{Choices, Entry, Setup, recorded_machine};
use feedwright_control::{Controller, IdentifierKind, Knows, Uncorrected};
use feedwright_sim::Machine;
use serde::{Deserialize, Serialize};

use super::tuned::Tuned;
use crate::peers::CONTROLLERS;

/// Knowledge that a controller gets of the machine that it cuts on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Knowledge {
    /// All that its kind may have: the machine's parameters, an identification on the machine, or
    /// nothing.
    Own,
    /// Inertia and friction as they are found from a recording of the machine; values that are
    /// tuned with the exact ones.
    Identified,
    /// Inertia that is 20 % too low and friction that is 20 % too high; values that are tuned with
    /// the exact ones.
    TwentyPercentOff,
    /// An identification on the nominal machine, and the values that are tuned there.
    Unseen,
    /// Values identified from a log of the machine, including the settings of its drives; parameter
    /// values tuned with the exact ones.
    Log,
}

/// Assumed inertia where parameters are 20 % off, as a part of the true one. The error is opposite
/// to the error in friction, so that the two errors of the torque do not cancel each other where an
/// axis speeds up.
const INERTIA_ASSUMED: f64 = 0.8;
/// Assumed friction, as a part of the true one.
const FRICTION_ASSUMED: f64 = 1.2;

impl Knowledge {
    /// All kinds, in the order of the table.
    pub const ALL: [Self; 5] = [
        Self::Own,
        Self::Identified,
        Self::TwentyPercentOff,
        Self::Unseen,
        Self::Log,
    ];

    /// Returns the suffix of the controller's name.
    pub const fn suffix(self) -> &'static str {
        match self {
            Self::Own => "",
            Self::Identified => "+identified",
            Self::TwentyPercentOff => "+20%off",
            Self::Unseen => "+unseen",
            Self::Log => "+log",
        }
    }

    /// Returns true if this knowledge makes a row of its own for a controller.
    fn is_for(self, entry: &Entry) -> bool {
        match self {
            Self::Own => true,
            Self::Identified | Self::TwentyPercentOff => entry.knows == Knows::ExactModel,
            Self::Unseen => entry.knows == Knows::Identified,
            Self::Log => {
                entry.knows == Knows::ExactModel || entry.identifier == Some(IdentifierKind::Axes)
            }
        }
    }
}

/// A controller in the comparison.
#[derive(Debug, Clone, Copy)]
pub struct Competitor {
    /// Its row in the table of controllers.
    pub entry: &'static Entry,
    /// Knowledge that it gets.
    pub knowledge: Knowledge,
}

impl Competitor {
    /// The controller of a row of the table, with all that its kind may know.
    pub const fn own(entry: &'static Entry) -> Self {
        Self {
            entry,
            knowledge: Knowledge::Own,
        }
    }

    /// Returns all competitors on a machine, in the order of the table. The nominal machine has no
    /// competitors with [`Knowledge::Unseen`].
    pub(super) fn all(
        controllers: &[&'static Entry],
        known: &[Knowledge],
        is_nominal: bool,
    ) -> Vec<Self> {
        let mut all = Vec::new();
        for &knowledge in known {
            if knowledge != Knowledge::Unseen || !is_nominal {
                let suited = controllers.iter().filter(|entry| knowledge.is_for(entry));
                all.extend(suited.map(|&entry| Self { entry, knowledge }));
            }
        }
        all
    }

    /// Its name in the table.
    pub fn name(&self) -> String {
        format!("{}{}", self.entry.name, self.knowledge.suffix())
    }

    /// The competitor of that name.
    pub fn find(name: &str) -> Option<Self> {
        let with = |knowledge: Knowledge| {
            let entry = CONTROLLERS.find(name.strip_suffix(knowledge.suffix())?)?;
            Some(Self { entry, knowledge })
        };
        Knowledge::ALL.into_iter().find_map(with)
    }

    /// Makes it for a machine. Recordings for an identification are made with the noise seed that
    /// the machine has here. One whose parameters cannot be identified there stays uncorrected.
    pub(super) fn make(
        &self,
        machine: &Machine,
        nominal: &Machine,
        seed: u64,
        tuned: Option<&Tuned>,
    ) -> Box<dyn Controller<2>> {
        let set = tuned.map_or(Vec::new(), |tuned| tuned.settings(self.entry));
        let choices = Choices {
            seed,
            set,
            ..Choices::default()
        };
        // The periods of the control are never a secret.
        let unseen = Machine {
            period: machine.period,
            ..nominal.clone()
        };
        let stated = match self.knowledge {
            Knowledge::Log => recorded_machine(machine, 2, seed, &()).map(|(stated, _)| stated),
            Knowledge::Unseen => Ok(unseen),
            _ => Ok(machine.clone()),
        };
        let Ok(known) = &stated else {
            return Box::new(Uncorrected);
        };
        let mut setup = Setup::new(known, &choices);
        match self.knowledge {
            Knowledge::TwentyPercentOff => {
                setup.known = setup.known.misjudged(INERTIA_ASSUMED, FRICTION_ASSUMED);
            }
            Knowledge::Identified if setup.identify_parameters::<2>().is_err() => {
                return Box::new(Uncorrected);
            }
            // What a drive is set to is read off it, wherever its axis was identified.
            Knowledge::Unseen if self.entry.identifier == Some(IdentifierKind::Axes) => {
                setup.known = machine.known();
            }
            Knowledge::Own | Knowledge::Identified | Knowledge::Unseen | Knowledge::Log => {}
        }
        self.entry.in_plane(&mut setup)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peers::CONTROLLERS;

    #[test]
    fn every_competitor_is_found_by_its_name_and_no_two_have_the_same() {
        let controllers: Vec<&'static Entry> = CONTROLLERS.iter().collect();
        let all = Competitor::all(&controllers, &Knowledge::ALL, false);
        assert!(all.len() > controllers.len());
        for (i, competitor) in all.iter().enumerate() {
            let name = competitor.name();
            let found = Competitor::find(&name).unwrap();
            assert_eq!(found.entry, competitor.entry);
            assert_eq!(found.knowledge, competitor.knowledge);
            assert!(all[..i].iter().all(|other| other.name() != name), "{name}");
        }
        let nominal = Competitor::all(&controllers, &Knowledge::ALL, true);
        assert!(nominal.iter().all(|it| it.knowledge != Knowledge::Unseen));
        assert!(Competitor::find("uncorrected+30%off").is_none());
    }
}
