//! Held-out work: contours turned and scaled, and programs in the plane, by seeds that were drawn
//! after everything was tuned.
//!
//! The seeds are kept with the date of the draw and a fingerprint of all settings that can be
//! tuned: defaults, searched ranges, and the recorded values. If a setting has changed since, the
//! work is no longer held out, and a test demands new seeds.
use feedwright::{Choices, Setup, UNCORRECTED};
use feedwright_sim::{Machine, Outcome, Run, RunError};
use serde::{Deserialize, Serialize};

use super::work::{FEED_MM_S, Workpiece, steps};
use crate::contour::{CONTOURS, CORNER, Contour};
use crate::held_out::contours::placement;
use crate::held_out::programs;
use crate::peers::{CONTROLLERS, RECORDED};

/// Programs of the set.
const PROGRAMS: usize = 11;
/// Most programs of one family: all families in the plane have a place.
const OF_A_FAMILY: usize = 2;
/// Machining time of a program on [`MACHINE`], s: long enough for the tool to meet something, short
/// enough for all machines and seeds.
const TIME_S: [f64; 2] = [4.0, 8.0];
/// Machine on which the time is measured.
const MACHINE: &str = "tnv40";

/// Seeds, and when they were drawn.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct HeldOutSeeds {
    /// Date.
    pub drawn: String,
    /// [`settings_fingerprint`] at that time.
    pub settings: String,
    /// One for each contour.
    pub contours: Vec<u64>,
    /// One for each program.
    pub programs: Vec<u64>,
}

impl HeldOutSeeds {
    /// Returns the seeds that are kept with the program.
    pub fn recorded() -> Self {
        serde_json::from_str(include_str!("held_out_seeds.json"))
            .expect("the recorded seeds are read by a test")
    }

    /// Draws seeds, counting from `first`.
    ///
    /// # Errors
    /// None, as long as the built-in machine has sensible limits.
    pub fn draw(first: u64, date: String) -> Result<Self, RunError> {
        let contours: Vec<u64> = (first..).take(CONTOURS.len()).collect();
        let mut families: Vec<String> = Vec::new();
        let mut seeds = Vec::new();
        for seed in first + CONTOURS.len() as u64.. {
            let drawn = programs::program(seed);
            let family = drawn.name.rsplit_once('-').map_or("", |(family, _)| family);
            let there = families.iter().filter(|other| *other == family).count();
            if there < OF_A_FAMILY && suits(&drawn)? {
                families.push(family.to_owned());
                seeds.push(seed);
            }
            if seeds.len() == PROGRAMS {
                break;
            }
        }
        Ok(Self {
            drawn: date,
            settings: settings_fingerprint(),
            contours,
            programs: seeds,
        })
    }

    /// Returns the workpieces of the seeds.
    pub fn workpieces(&self) -> Vec<Workpiece> {
        let contour = |(contour, &seed): (&Contour, &u64)| {
            let steps = contour.placed_steps(placement(seed), FEED_MM_S, CORNER);
            Workpiece {
                smooth: contour.is_smooth(),
                held_out: true,
                ..Workpiece::of(
                    format!("{}-{seed}", contour.name),
                    steps.expect("a contour has a path wherever it is"),
                )
            }
        };
        let program = |&seed: &u64| {
            let drawn = programs::program(seed);
            let steps = steps(&drawn.name, &drawn.text);
            let steps = steps.expect("only programs with a path are recorded, which a test holds");
            Workpiece {
                held_out: true,
                ..Workpiece::of(drawn.name, steps)
            }
        };
        let contours = CONTOURS.iter().zip(&self.contours).map(contour);
        contours.chain(self.programs.iter().map(program)).collect()
    }
}

/// Returns true if a program stays in the plane and has a suitable machining time.
fn suits(drawn: &programs::RandomProgram) -> Result<bool, RunError> {
    let mut lines = drawn.text.lines();
    let in_plane = lines.all(|line| line.starts_with('(') || !line.contains('Z'));
    let Some(steps) = steps(&drawn.name, &drawn.text).filter(|_| in_plane) else {
        return Ok(false);
    };
    let machine = Machine::load(MACHINE.as_ref()).expect("it is built in");
    let choices = Choices::default();
    let mut controller = UNCORRECTED.in_plane(&mut Setup::new(&machine, &choices));
    let run = Run::on(&machine).cut_steps(&steps, &mut *controller, &mut [])?;
    Ok(run.outcome == Outcome::Completed && (TIME_S[0]..=TIME_S[1]).contains(&run.time_s))
}

/// Returns a fingerprint of all settings that can be tuned: defaults and searched ranges of all
/// controllers, and the recorded values.
pub fn settings_fingerprint() -> String {
    let settings = |entry: &feedwright::Entry| {
        let parameters = entry.parameters.iter();
        let values: Vec<_> = parameters
            .map(|p| (p.name, p.default, p.searched))
            .collect();
        (entry.name, values)
    };
    let controllers: Vec<_> = CONTROLLERS.iter().map(settings).collect();
    let content = serde_json::json!([controllers, RECORDED]);
    let hash = blake3::hash(content.to_string().as_bytes());
    hash.to_hex().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_recorded_seeds_are_what_a_draw_from_the_first_gives() {
        let recorded = HeldOutSeeds::recorded();
        let drawn = HeldOutSeeds::draw(recorded.contours[0], recorded.drawn.clone()).unwrap();
        assert_eq!(
            (&drawn.contours, &drawn.programs),
            (&recorded.contours, &recorded.programs)
        );
        let workpieces = recorded.workpieces();
        assert_eq!(workpieces.len(), CONTOURS.len() + PROGRAMS);
        for (i, workpiece) in workpieces.iter().enumerate() {
            let mut before = workpieces[..i].iter();
            assert!(workpiece.held_out && before.all(|other| other.name != workpiece.name));
        }
    }

    #[test]
    fn no_setting_has_changed_since_the_seeds_were_drawn() {
        assert_eq!(
            HeldOutSeeds::recorded().settings,
            settings_fingerprint(),
            "a default, a range or a recorded value is another than when the held-out work was drawn; hint: when all settings are \
             final, `cargo run --release -p feedwright-lab --example draw_held_out` draws new seeds"
        );
    }
}
