//! One cut of the comparison.

use feedwright_control::Controller;

use super::table::Row;
use super::tuning::Tuned;
use super::{Competitor, Workpiece};
use crate::controllers::{Choices, Make, Setup};
use crate::feed::LimitsError;
use crate::machine::Machine;
use crate::reference::Reference;
use crate::report::Statistics;
use crate::simulate::{Run, practise, simulate_lap};
use crate::trace::{Outcome, Row as TraceRow, Sink};

/// Makes a competitor for a machine.
pub(super) struct Maker<'a> {
    pub(super) competitor: &'a Competitor,
    pub(super) nominal: &'a Machine,
    pub(super) seed: u64,
    pub(super) tuned: &'a [Tuned],
}

impl Maker<'_> {
    pub(super) fn make(&self, machine: &Machine) -> Box<dyn Controller<2>> {
        let entry = self.competitor.entry;
        let values = self.tuned.iter().find(|tuned| tuned.controller == entry.name);
        let set = values.map_or(Vec::new(), |tuned| tuned.settings(entry));
        let choices = Choices { seed: self.seed, set };
        // What a controller believes of the machine: the periods of the control are never a secret.
        let known = if self.competitor.at_home { machine } else { self.nominal };
        let known = Machine { period: machine.period, ..known.clone() };
        Make::<2>::make(entry, &mut Setup::new(&known, &choices))
    }
}

/// What a run leaves for the table.
pub(super) struct Cut {
    pub(super) statistics: Statistics,
    pub(super) run: Run,
}

impl Cut {
    /// Whether the controller brought it to its end on its own.
    pub(super) fn is_sound(&self) -> bool {
        self.run.outcome == Outcome::Completed && self.run.faded_out.is_none()
    }
}

/// Cuts a workpiece, after as many laps of practice as the controller needs.
pub(super) fn cut(
    workpiece: &Workpiece,
    machine: &Machine,
    controller: &mut dyn Controller<2>,
    laps: u32,
    sinks: &mut [&mut dyn Sink],
) -> Result<Cut, LimitsError> {
    let reference = || Reference::from_steps(workpiece.steps.clone(), &(&machine.limits).into());
    practise(machine, reference, controller, laps)?;
    let mut statistics = Statistics::new();
    let mut all: Vec<&mut dyn Sink> = vec![&mut statistics];
    all.extend(sinks.iter_mut().map(|sink| &mut **sink as &mut dyn Sink));
    let run = simulate_lap(machine, &mut reference()?, controller, &mut all).expect("sinks in memory take every row");
    Ok(Cut { statistics, run })
}

/// One row, its ratios still open.
pub(super) fn row(
    workpiece: &Workpiece,
    machine: &Machine,
    competitor: &Competitor,
    controller: &mut dyn Controller<2>,
) -> Result<Row, LimitsError> {
    let mut errors = Errors::default();
    let Cut { statistics, run } = cut(workpiece, machine, controller, competitor.entry.laps, &mut [&mut errors])?;
    Ok(Row::new(workpiece, machine, competitor, &statistics, &run, errors.thinned()))
}

/// Points of an error plot.
const PLOT_POINTS: usize = 160;

/// The contour error of every row, thinned out to what a plot can show.
#[derive(Default)]
struct Errors(Vec<f32>);

impl Sink for Errors {
    fn row(&mut self, row: &TraceRow) -> std::io::Result<()> {
        self.0.push((row.contour_error_mm * 1e3) as f32);
        Ok(())
    }
}

impl Errors {
    /// The largest of each stretch, with its sign: peaks stay.
    fn thinned(&self) -> Vec<f32> {
        let stretch = self.0.len().div_ceil(PLOT_POINTS).max(1);
        let largest_of =
            |part: &[f32]| part.iter().copied().fold(0.0, |a: f32, b| if b.abs() > a.abs() { b } else { a });
        self.0.chunks(stretch).map(largest_of).collect()
    }
}
