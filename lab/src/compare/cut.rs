//! One row of the comparison: a cut for each noise seed.

use feedwright::Statistics;
use feedwright_control::Controller;
use feedwright_sim::{Machine, Outcome, PlanCache, Row, Run, RunError, RunResult, Sink, Watch};

use super::competitor::Competitor;
use super::noise;
use super::options::ComparisonOptions;
use super::table::{ComparisonRow, CutNumbers};
use super::work::Workpiece;

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

    /// RMS contour error without the geometry that no encoder sees, um: what a controller can do something about.
    pub(super) fn joint_rms_um(&self) -> f64 {
        self.run.joint_error.map_or_else(|| self.statistics.rms_um(), |joints| joints.rms_mm * 1e3)
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

impl CutNumbers {
    fn of(Cut { statistics, run }: &Cut) -> Self {
        Self {
            time_s: run.time_s,
            rms_um: statistics.rms_um(),
            max_um: statistics.max_um(),
            joint_um: run.joint_error.map(|joints| [joints.rms_mm, joints.max_mm].map(|mm| mm * 1e3)),
            uncut_um: run.uncut_mm * 1e3,
            max_deviation_um: statistics.max_deviation_um(),
            accel_mm_s2: statistics.max_command_accel_mm_s2(),
            peak_torque_nm: statistics.peak_torque_nm().into_iter().fold(0.0, f64::max),
            completed: run.outcome == Outcome::Completed,
            faded_out: run.faded_out.map(|faded| faded.cause),
        }
    }
}

/// Cuts a workpiece once for each noise seed in `seeds` and returns the row. Its ratios are not yet
/// computed. The error plot shows the cut with the first seed.
pub(super) fn row(
    workpiece: &Workpiece,
    machine: &Machine,
    competitor: &Competitor,
    controller: &mut dyn Controller<2>,
    seeds: &[u64],
    plan: &PlanCache,
    watch: &dyn Watch,
) -> Result<ComparisonRow, RunError> {
    let mut errors = Errors::default();
    let mut measured = Vec::with_capacity(seeds.len());
    for (k, &seed) in seeds.iter().enumerate() {
        let machine = machine.with_noise_seed(seed);
        let run = Run::on(&machine).laps(competitor.entry.laps).sharing(plan).watched(watch);
        let plotted: &mut [&mut dyn Sink] = if k == 0 { &mut [&mut errors] } else { &mut [] };
        let cut = cut(workpiece, controller, run, plotted)?;
        measured.push(CutNumbers::of(&cut));
    }
    Ok(ComparisonRow::new(workpiece, machine, competitor, &measured, errors.thinned()))
}

/// The noise seeds of a machine.
pub(super) fn seeds(machine: &Machine, options: &ComparisonOptions) -> Vec<u64> {
    noise::reported(machine, options.seed, options.noise_seeds)
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
