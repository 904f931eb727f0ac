//! One cut of the comparison.

use feedwright_control::Controller;

use super::table::ComparisonRow;
use super::tuned::Tuned;
use super::{Competitor, Workpiece};
use crate::controllers::{Choices, Make, Setup};
use crate::machine::Machine;
use crate::pipeline::{Run, RunError};
use crate::report::Statistics;
use crate::simulate::RunResult;
use crate::trace::{Outcome, Row, Sink};
use crate::watch::Watch;

/// Makes a competitor for a machine.
pub(super) struct CompetitorMaker<'a> {
    pub(super) competitor: &'a Competitor,
    pub(super) nominal: &'a Machine,
    pub(super) seed: u64,
    pub(super) tuned: &'a [Tuned],
}

impl CompetitorMaker<'_> {
    pub(super) fn make(&self, machine: &Machine) -> Box<dyn Controller<2>> {
        let entry = self.competitor.entry;
        let values = self.tuned.iter().find(|tuned| tuned.controller == entry.name);
        let set = values.map_or(Vec::new(), |tuned| tuned.settings(entry));
        let choices = Choices { seed: self.seed, set };
        // What a controller believes of the machine: the periods of the control are never a secret.
        let known = if self.competitor.identified_here { machine } else { self.nominal };
        let known = Machine { period: machine.period, ..known.clone() };
        Make::<2>::make(entry, &mut Setup::new(&known, &choices))
    }
}

/// What a run leaves for the table.
pub(super) struct Cut {
    pub(super) statistics: Statistics,
    pub(super) run: RunResult,
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
    controller: &mut dyn Controller<2>,
    run: Run<'_>,
    sinks: &mut [&mut dyn Sink],
) -> Result<Cut, RunError> {
    let mut statistics = Statistics::new();
    let mut all: Vec<&mut dyn Sink> = vec![&mut statistics];
    all.extend(sinks.iter_mut().map(|sink| &mut **sink as &mut dyn Sink));
    let run = run.cut_steps(&workpiece.steps, controller, &mut all)?;
    Ok(Cut { statistics, run })
}

/// One row, its ratios still open.
pub(super) fn row(
    workpiece: &Workpiece,
    machine: &Machine,
    competitor: &Competitor,
    controller: &mut dyn Controller<2>,
    watch: &dyn Watch,
) -> Result<ComparisonRow, RunError> {
    let mut errors = Errors::default();
    let run = Run::on(machine).laps(competitor.entry.laps).watched(watch);
    let Cut { statistics, run } = cut(workpiece, controller, run, &mut [&mut errors])?;
    Ok(ComparisonRow::new(workpiece, machine, competitor, &statistics, &run, errors.thinned()))
}

/// Points of an error plot.
const PLOT_POINTS: usize = 160;

/// The contour error of every row, thinned out to what a plot can show.
#[derive(Default)]
struct Errors(Vec<f32>);

impl Sink for Errors {
    fn row(&mut self, row: &Row) -> std::io::Result<()> {
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
