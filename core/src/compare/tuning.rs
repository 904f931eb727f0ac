//! The search that tunes every controller alike, on one contour of one machine.
//!
//! Parameters whose range begins above zero are searched by ratios, others by differences. First the default and the points
//! of a Halton sequence, then a pattern search (Hooke and Jeeves 1961) from the best, whose step halves where no neighbour is
//! better. What is minimised is the RMS contour error, at no more time than open loop takes: each percent above costs as
//! much as ten percent of error.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::cut::{Cut, cut};
use super::{TUNING_CONTOUR, Workpiece};
use crate::controllers::{BASELINE, Choices, Entry, Make, Parameter, Setting, Setup};
use crate::feed::LimitsError;
use crate::machine::Machine;

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
        let named = |name: &str| entry.parameters.iter().find(|parameter| parameter.name == name);
        let setting = |(name, value): &(String, f64)| {
            Some(Setting { controller: entry.name, name: named(name)?.name, value: *value })
        };
        self.values.iter().filter_map(setting).collect()
    }

    /// Names and values in words, to four digits.
    pub fn words(&self) -> String {
        let values: Vec<String> =
            self.values.iter().map(|(name, value)| format!("{name} {}", four_digits(*value))).collect();
        values.join(", ")
    }
}

/// Without an exponent where it can do without, and without zeros that say nothing.
fn four_digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-3..1e6).contains(&rounded.abs()) { format!("{rounded}") } else { format!("{rounded:e}") }
}

/// Tunes a controller on the machine.
///
/// # Errors
/// Where the machine has no sensible limits.
pub fn search(entry: &'static Entry, machine: &Machine, seed: u64) -> Result<Tuned, LimitsError> {
    let workpiece = Workpiece::contours().into_iter().find(|w| w.name == TUNING_CONTOUR);
    let workpiece = workpiece.expect("the tuning contour is one of the contours");
    let base = Entry::find(BASELINE).expect("the baseline is in the table");
    let open_loop = Trial { entry: base, machine, workpiece: &workpiece, seed, open_time_s: f64::INFINITY };
    let open_time_s = open_loop.cut(&[])?.run.time_s;
    let trial = Trial { entry, machine, workpiece: &workpiece, seed, open_time_s };
    trial.search()
}

struct Trial<'a> {
    entry: &'static Entry,
    machine: &'a Machine,
    workpiece: &'a Workpiece,
    seed: u64,
    open_time_s: f64,
}

/// A point of the unit cube and its cost.
#[derive(Debug, Clone)]
struct Point {
    place: Vec<f64>,
    cost: f64,
}

impl Trial<'_> {
    fn search(&self) -> Result<Tuned, LimitsError> {
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
        let values = self.values(&best.place);
        let rms_um = self.cut(&values)?.statistics.rms_um();
        let values = parameters.iter().zip(values).map(|((p, _), value)| (p.name.to_owned(), value)).collect();
        Ok(Tuned { controller: self.entry.name.to_owned(), values, cuts, rms_um })
    }

    fn costs(&self, places: Vec<Vec<f64>>) -> Result<Vec<Point>, LimitsError> {
        places.into_par_iter().map(|place| Ok(Point { cost: self.cost(&place)?, place })).collect()
    }

    fn cost(&self, place: &[f64]) -> Result<f64, LimitsError> {
        let cut = self.cut(&self.values(place))?;
        let longer = (cut.run.time_s / self.open_time_s - 1.0).max(0.0);
        Ok(if cut.is_sound() { cut.statistics.rms_um() * (1.0 + TIME_PRICE * longer) } else { f64::INFINITY })
    }

    fn cut(&self, values: &[f64]) -> Result<Cut, LimitsError> {
        let setting = |((p, _), value): ((&'static Parameter, _), &f64)| Setting {
            controller: self.entry.name,
            name: p.name,
            value: *value,
        };
        let choices = Choices { seed: self.seed, set: self.entry.searched().zip(values).map(setting).collect() };
        let mut setup = Setup::new(self.machine, &choices);
        let mut controller = Make::<2>::make(self.entry, &mut setup);
        cut(self.workpiece, self.machine, &mut *controller, self.entry.laps, &mut [])
    }

    fn values(&self, place: &[f64]) -> Vec<f64> {
        self.entry.searched().zip(place).map(|((_, range), &at)| value_at(range, at)).collect()
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
    fn values_have_four_digits_and_no_more_zeros_than_they_need() {
        let shown = [8.0, 117.735, 0.0301, 9.786e-1, 1.0754e-5, 1e-11, 0.0, -2e7].map(four_digits);
        assert_eq!(shown, ["8", "117.7", "0.0301", "0.9786", "1.075e-5", "1e-11", "0", "-2e7"]);
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
        let cut = |entry: &'static Entry, values: &[f64]| {
            let trial = Trial { entry, machine: &machine, workpiece: &workpiece, seed: 1, open_time_s: f64::INFINITY };
            let cut = trial.cut(values).unwrap();
            (cut.statistics.rms_um(), cut.run.time_s)
        };
        let (open_um, open_s) = cut(Entry::find(BASELINE).unwrap(), &[]);
        let cost = |(rms_um, time_s): (f64, f64)| rms_um * (1.0 + 10.0 * (time_s / open_s - 1.0).max(0.0));
        let values = |tuned: &Tuned| tuned.values.iter().map(|(_, value)| *value).collect::<Vec<f64>>();
        let defaults = cost(cut(entry, &values(&Tuned::defaults(entry))));
        let tuned = search(entry, &machine, 1).unwrap();
        let found = cut(entry, &values(&tuned));
        assert!(cost(found) < defaults, "{} of {defaults}: {tuned:?}", cost(found));
        assert!(cost(found) <= open_um * (1.0 + 1e-9), "{} of {open_um}: {tuned:?}", cost(found));
        assert_eq!(tuned.rms_um, found.0, "{tuned:?}");
        for ((parameter, [low, high]), (name, value)) in entry.searched().zip(&tuned.values) {
            assert!(parameter.name == name && (low..=high).contains(value), "{tuned:?}");
        }
        assert_eq!(tuned, search(entry, &machine, 1).unwrap());
    }
}
