//! The search that tunes every controller alike, on one contour of one machine.
//!
//! Parameters whose range begins above zero are searched by ratios, others by differences. First the default and the points
//! of a Halton sequence, then a pattern search (Hooke and Jeeves 1961) from the best, whose step halves where no neighbour is
//! better. What is minimised is the RMS contour error, at no more time than open loop takes: each percent above costs as
//! much as ten percent of error.

use rayon::prelude::*;

use super::cut::{Cut, cut};
use super::tuned::Tuned;
use super::{TUNING_CONTOUR, Workpiece};
use crate::controllers::{BASELINE, Choices, Entry, Make, Parameter, Setting, Setup};
use crate::machine::Machine;
use crate::pipeline::{Run, RunError};
use crate::watch::Watch;

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
const TIME_PRICE: f64 = 10.0;

/// Tunes a controller on the machine.
///
/// # Errors
/// Where the machine has no sensible limits.
pub fn search(entry: &'static Entry, machine: &Machine, seed: u64, watch: &dyn Watch) -> Result<Tuned, RunError> {
    let workpiece = Workpiece::contours().into_iter().find(|w| w.name == TUNING_CONTOUR);
    let workpiece = workpiece.expect("the tuning contour is one of the contours");
    let base = Entry::find(BASELINE).expect("the baseline is in the table");
    let open_loop = Trial { entry: base, machine, workpiece: &workpiece, seed, watch, open_time_s: f64::INFINITY };
    let open_time_s = open_loop.cut(&[])?.run.time_s;
    let trial = Trial { entry, machine, workpiece: &workpiece, seed, watch, open_time_s };
    trial.search()
}

struct Trial<'a> {
    entry: &'static Entry,
    machine: &'a Machine,
    workpiece: &'a Workpiece,
    seed: u64,
    watch: &'a dyn Watch,
    open_time_s: f64,
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
        let default: Vec<f64> = parameters.iter().map(|(parameter, range)| place(*range, parameter.default)).collect();
        let scattered = (1..=SCATTERED * parameters.len()).map(|i| halton(i, parameters.len()));
        let mut points = self.costs(std::iter::once(default).chain(scattered).collect())?;
        let mut cuts = points.len() as u64;
        points.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let mut best = points.swap_remove(0);
        let mut step = FIRST_STEP;
        for _ in 0..=HALVINGS {
            for _ in 0..MOVES {
                let mut around = self.costs(neighbours(&best.place, step))?;
                cuts += around.len() as u64;
                around.sort_by(|a, b| a.cost.total_cmp(&b.cost));
                if around.first().is_none_or(|nearest| nearest.cost >= best.cost) {
                    break;
                }
                best = around.swap_remove(0);
            }
            step *= 0.5;
        }
        let settings = self.settings(&best.place);
        let rms_um = self.cut(&settings)?.statistics.rms_um();
        let values = settings.iter().map(|setting| (setting.name.to_owned(), setting.value)).collect();
        Ok(Tuned { controller: self.entry.name.to_owned(), values, cuts, rms_um })
    }

    fn costs(&self, places: Vec<Vec<f64>>) -> Result<Vec<Candidate>, RunError> {
        places.into_par_iter().map(|place| Ok(Candidate { cost: self.cost(&place)?, place })).collect()
    }

    fn cost(&self, place: &[f64]) -> Result<f64, RunError> {
        let cut = self.cut(&self.settings(place))?;
        let longer = (cut.run.time_s / self.open_time_s - 1.0).max(0.0);
        Ok(if cut.is_sound() { cut.statistics.rms_um() * (1.0 + TIME_PRICE * longer) } else { f64::INFINITY })
    }

    fn cut(&self, settings: &[Setting]) -> Result<Cut, RunError> {
        let choices = Choices { seed: self.seed, set: settings.to_vec() };
        let mut setup = Setup::new(self.machine, &choices);
        let mut controller = Make::<2>::make(self.entry, &mut setup);
        let run = Run::on(self.machine).laps(self.entry.laps).watched(self.watch);
        cut(self.workpiece, &mut *controller, run, &mut [])
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
    if low > 0.0 { low * (high / low).powf(at) } else { low + at * (high - low) }
}

/// The place of a value.
fn place([low, high]: [f64; 2], value: f64) -> f64 {
    if low > 0.0 { (value / low).ln() / (high / low).ln() } else { (value - low) / (high - low) }
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
    BASES.into_iter().cycle().take(dimensions).map(digit_reversed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let first: Vec<Vec<f64>> = (1..=4).map(|i| halton(i, 2)).collect();
        let expected = [[0.5, 1.0 / 3.0], [0.25, 2.0 / 3.0], [0.75, 1.0 / 9.0], [0.125, 4.0 / 9.0]];
        for (point, expected) in first.iter().zip(expected) {
            assert!(point.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{point:?}");
        }
    }

    #[test]
    fn a_search_finds_values_that_cost_less_than_the_defaults() {
        let machine = Machine::load("tnv40".as_ref()).unwrap();
        let workpiece = Workpiece::contours().into_iter().find(|w| w.name == TUNING_CONTOUR).unwrap();
        // Its defaults take a third longer than open loop, which the search may not.
        let entry = Entry::find("fuzzy-feedrate").unwrap();
        let cut = |entry: &'static Entry, settings: &[Setting]| {
            let trial = Trial {
                entry,
                machine: &machine,
                workpiece: &workpiece,
                seed: 1,
                watch: &(),
                open_time_s: f64::INFINITY,
            };
            let cut = trial.cut(settings).unwrap();
            (cut.statistics.rms_um(), cut.run.time_s)
        };
        let (open_um, open_s) = cut(Entry::find(BASELINE).unwrap(), &[]);
        let cost = |(rms_um, time_s): (f64, f64)| rms_um * (1.0 + 10.0 * (time_s / open_s - 1.0).max(0.0));
        let defaults = cost(cut(entry, &Tuned::defaults(entry).settings(entry)));
        let tuned = search(entry, &machine, 1, &()).unwrap();
        let found = cut(entry, &tuned.settings(entry));
        assert!(cost(found) < defaults, "{} of {defaults}: {tuned:?}", cost(found));
        assert!(cost(found) <= open_um * (1.0 + 1e-9), "{} of {open_um}: {tuned:?}", cost(found));
        assert_eq!(tuned.rms_um, found.0, "{tuned:?}");
        for ((parameter, [low, high]), (name, value)) in entry.searched().zip(&tuned.values) {
            assert!(parameter.name == name && (low..=high).contains(value), "{tuned:?}");
        }
        assert_eq!(tuned, search(entry, &machine, 1, &()).unwrap());
    }
}
