//! The search that tunes every controller in the same way, on each machine, under its noise.
//!
//! Parameters whose range begins above zero are searched by ratios, others by differences. The
//! search evaluates the default and the points of a Halton sequence. A pattern search (Hooke and
//! Jeeves 1961) then starts from the best of them; its step halves when no neighbor is better.
//!
//! The cost is the quadratic mean of the RMS contour errors on a smooth contour, on one with
//! corners, and on acute tips. Feedback that is tuned without the tips may get caught in one.
//! Geometry errors that no encoder sees are left out. Each percent of machining time beyond the
//! uncorrected cut costs as much as ten percent of error.
//!
//! The search uses the noise seed of the machine file. No reported cut of a noisy machine uses it.
use feedwright::{Choices, Entry, Setting, Setup, UNCORRECTED};
use feedwright_control::Parameter;
use feedwright_ident::quadratic_mean;
use feedwright_sim::{Machine, PlanCache, Run, RunError, Watch};
use rayon::prelude::*;

use super::cut::cut;
use super::tuned::{RangeEnd, Tuned, TunedValue};
use super::work::Workpiece;

/// Points of the Halton sequence for each parameter.
const SCATTERED: usize = 12;
/// First step of the pattern search, as a part of the range.
const FIRST_STEP: f64 = 0.125;
/// Halvings of the step.
const HALVINGS: u32 = 4;
/// Most moves at one step size.
const MOVES: u32 = 6;
/// Bases of the Halton sequence: as many as there are parameters at most.
const BASES: [u32; 6] = [2, 3, 5, 7, 11, 13];
/// Cost of a percent of time, in percent of error.
const TIME_COST: f64 = 10.0;

/// A value that is nearer to an end of its range, as a part of it, is at the end.
const AT_END: f64 = 0.01;
/// A search that gains less than this part of the uncorrected cost has switched the correction off.
const LEAST_GAIN: f64 = 0.01;

/// Tunes a controller on the machine.
///
/// # Errors
/// Where the machine has no sensible limits.
pub fn search(
    entry: &'static Entry,
    machine: &Machine,
    seed: u64,
    watch: &dyn Watch,
) -> Result<Tuned, RunError> {
    let workpieces = Workpiece::tuning();
    let plans: Vec<_> = workpieces.iter().map(|_| PlanCache::default()).collect();
    let mut trial = Trial {
        entry: &UNCORRECTED,
        machine,
        workpieces: &workpieces,
        plans: &plans,
        seed,
        watch,
        open: Evaluation::NONE,
    };
    trial.open = trial.evaluate(&[])?;
    Trial { entry, ..trial }.search()
}

#[derive(Clone, Copy)]
struct Trial<'a> {
    entry: &'static Entry,
    machine: &'a Machine,
    workpieces: &'a [Workpiece],
    /// The plan of each.
    plans: &'a [PlanCache],
    seed: u64,
    watch: &'a dyn Watch,
    open: Evaluation,
}

/// Result of an evaluation over all workpieces.
#[derive(Debug, Clone, Copy)]
struct Evaluation {
    /// Quadratic mean.
    rms_um: f64,
    /// Sum.
    time_s: f64,
    sound: bool,
}

impl Evaluation {
    const NONE: Self = Self {
        rms_um: f64::INFINITY,
        time_s: f64::INFINITY,
        sound: true,
    };
}

/// A point of the unit cube and its cost.
#[derive(Debug, Clone)]
struct Candidate {
    place: Vec<f64>,
    cost: f64,
}

impl Trial<'_> {
    fn search(&self) -> Result<Tuned, RunError> {
        let parameters: Vec<_> = self.entry.searched().collect();
        let default = |(parameter, range): &(&Parameter, _)| place(*range, parameter.default);
        let default: Vec<f64> = parameters.iter().map(default).collect();
        let scattered = (1..=SCATTERED * parameters.len()).map(|i| halton(i, parameters.len()));
        let mut points = self.costs(std::iter::once(default).chain(scattered).collect())?;
        let mut cuts = points.len() as u64;
        let mut best = points.swap_remove(0);
        let mut step = FIRST_STEP;
        for _ in 0..=HALVINGS {
            for _ in 0..MOVES {
                let mut around = self.costs(neighbours(&best.place, step))?;
                cuts += around.len() as u64;
                if around
                    .first()
                    .is_none_or(|nearest| nearest.cost >= best.cost)
                {
                    break;
                }
                best = around.swap_remove(0);
            }
            step *= 0.5;
        }
        let settings = self.settings(&best.place);
        let found = self.evaluate(&settings)?;
        let value = |(setting, &place): (&Setting, &f64)| TunedValue {
            name: setting.name.to_owned(),
            value: setting.value,
            at_end: end_of(place),
        };
        Ok(Tuned {
            machine: self.machine.name.clone(),
            controller: self.entry.name.to_owned(),
            values: settings.iter().zip(&best.place).map(value).collect(),
            cuts,
            rms_um: found.rms_um,
            open_um: self.open.rms_um,
            switched_off: best.cost >= (1.0 - LEAST_GAIN) * self.open.rms_um,
        })
    }

    /// The places with their costs, the cheapest first; equals stay in order.
    fn costs(&self, places: Vec<Vec<f64>>) -> Result<Vec<Candidate>, RunError> {
        let candidate = |place: Vec<f64>| {
            let cost = self.cost(&place)?;
            Ok(Candidate { place, cost })
        };
        let all: Result<Vec<Candidate>, RunError> = places.into_par_iter().map(candidate).collect();
        let mut all = all?;
        all.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        Ok(all)
    }

    fn cost(&self, place: &[f64]) -> Result<f64, RunError> {
        let found = self.evaluate(&self.settings(place))?;
        let longer = (found.time_s / self.open.time_s - 1.0).max(0.0);
        let cost = found.rms_um * (1.0 + TIME_COST * longer);
        Ok(if found.sound { cost } else { f64::INFINITY })
    }

    fn evaluate(&self, settings: &[Setting]) -> Result<Evaluation, RunError> {
        let choices = Choices {
            seed: self.seed,
            set: settings.to_vec(),
            ..Choices::default()
        };
        let mut controller = self.entry.in_plane(&mut Setup::new(self.machine, &choices));
        let run = Run::on(self.machine)
            .laps(self.entry.laps)
            .watched(self.watch);
        let (mut each_um, mut time_s, mut sound) = (Vec::new(), 0.0, true);
        for (workpiece, plan) in self.workpieces.iter().zip(self.plans) {
            let cut = cut(workpiece, &mut *controller, run.sharing(plan))?;
            each_um.push(cut.joint_rms_um());
            time_s += cut.run.time_s;
            sound &= cut.is_sound();
        }
        Ok(Evaluation {
            rms_um: quadratic_mean(each_um),
            time_s,
            sound,
        })
    }

    /// The values of the parameters that are searched, at a point of the unit cube.
    fn settings(&self, place: &[f64]) -> Vec<Setting> {
        let controller = self.entry.name;
        let setting = |((parameter, range), &at): ((&'static Parameter, _), &f64)| Setting {
            controller,
            name: parameter.name,
            value: value_at(range, at),
        };
        self.entry.searched().zip(place).map(setting).collect()
    }
}

/// The value at a place from 0 to 1 of a range.
fn value_at([low, high]: [f64; 2], at: f64) -> f64 {
    if low > 0.0 {
        low * libm::pow(high / low, at)
    } else {
        low + at * (high - low)
    }
}

/// The place of a value.
fn place([low, high]: [f64; 2], value: f64) -> f64 {
    if low > 0.0 {
        libm::log(value / low) / libm::log(high / low)
    } else {
        (value - low) / (high - low)
    }
}

/// The end of its range at which a place is.
fn end_of(place: f64) -> Option<RangeEnd> {
    match place {
        _ if place <= AT_END => Some(RangeEnd::Low),
        _ if place >= 1.0 - AT_END => Some(RangeEnd::High),
        _ => None,
    }
}

/// One step up and down along each parameter, inside the range.
fn neighbours(place: &[f64], step: f64) -> Vec<Vec<f64>> {
    let mut all = Vec::with_capacity(2 * place.len());
    for axis in 0..place.len() {
        for change in [-step, step] {
            let mut moved = place.to_vec();
            moved[axis] = (moved[axis] + change).clamp(0.0, 1.0);
            if moved != place {
                all.push(moved);
            }
        }
    }
    all
}

/// The i-th point of the Halton sequence (Halton 1960).
fn halton(i: usize, dimensions: usize) -> Vec<f64> {
    let digit_reversed = |base: u32| {
        let (mut i, mut fraction, mut sum) = (i as u32, 1.0, 0.0);
        while i > 0 {
            fraction /= f64::from(base);
            sum += f64::from(i % base) * fraction;
            i /= base;
        }
        sum
    };
    let bases = BASES.into_iter().cycle().take(dimensions);
    bases.map(digit_reversed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peers::CONTROLLERS;

    #[test]
    fn places_and_values_are_each_others_inverse() {
        for (range, wanted) in [([1e-3, 10.0], 0.2), ([0.0, 4.0], 1.0)] {
            let value = value_at(range, place(range, wanted));
            assert!((value - wanted).abs() < 1e-12, "{value}");
            assert_eq!([value_at(range, 0.0), value_at(range, 1.0)], range);
        }
    }

    #[test]
    fn the_halton_sequence_is_the_published_one() {
        let expected = [
            [0.5, 1.0 / 3.0],
            [0.25, 2.0 / 3.0],
            [0.75, 1.0 / 9.0],
            [0.125, 4.0 / 9.0],
        ];
        for (i, expected) in (1..).zip(expected) {
            let point = halton(i, 2);
            let is_it = point
                .iter()
                .zip(expected)
                .all(|(a, b)| (a - b).abs() < 1e-15);
            assert!(is_it && point.len() == 2, "{point:?}");
        }
    }

    #[test]
    fn a_search_finds_values_that_cost_less_than_the_defaults() {
        let machine = Machine::load("tnv40".as_ref()).unwrap();
        let workpieces = Workpiece::tuning();
        // Its defaults take a third longer than uncorrected, which the search may not.
        let entry = CONTROLLERS.find("fuzzy-feedrate").unwrap();
        let plans: Vec<_> = workpieces.iter().map(|_| PlanCache::default()).collect();
        let evaluate = |entry: &'static Entry, settings: &[Setting]| {
            let trial = Trial {
                entry,
                machine: &machine,
                workpieces: &workpieces,
                plans: &plans,
                seed: 1,
                watch: &(),
                open: Evaluation::NONE,
            };
            trial.evaluate(settings).unwrap()
        };
        let open = evaluate(&UNCORRECTED, &[]);
        let cost = |found: Evaluation| {
            found.rms_um * (1.0 + 10.0 * (found.time_s / open.time_s - 1.0).max(0.0))
        };
        let defaults = Tuned::defaults("tnv40", entry).settings(entry);
        let defaults = cost(evaluate(entry, &defaults));
        let tuned = search(entry, &machine, 1, &()).unwrap();
        let found = evaluate(entry, &tuned.settings(entry));
        let reached = cost(found);
        assert!(reached < defaults, "{reached} of {defaults}: {tuned:?}");
        let rounded_um = open.rms_um * (1.0 + 1e-9);
        assert!(reached <= rounded_um, "{reached} of {open:?}: {tuned:?}");
        assert_eq!((tuned.rms_um, tuned.open_um), (found.rms_um, open.rms_um));
        // Where speed along the path alone is to do it, there is nothing to gain in the same time.
        assert!(tuned.switched_off, "{tuned:?}");
        for ((parameter, [low, high]), value) in entry.searched().zip(&tuned.values) {
            let is_in_range = (low..=high).contains(&value.value);
            assert!(parameter.name == value.name && is_in_range, "{tuned:?}");
        }
        assert_eq!(tuned, search(entry, &machine, 1, &()).unwrap());
    }

    #[test]
    fn a_place_at_an_end_of_its_range_is_reported() {
        let [low, high] = [RangeEnd::Low, RangeEnd::High].map(Some);
        assert_eq!([0.0, 0.005, 0.5, 1.0].map(end_of), [low, low, None, high]);
    }
}
