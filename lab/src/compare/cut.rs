//! One row of the comparison: a cut for each noise seed.

use feedwright::Statistics;
use feedwright_control::Controller;
use feedwright_sim::{Machine, Outcome, PlanCache, Run, RunError, RunResult, Watch};

use super::competitor::Competitor;
use super::noise;
use super::options::ComparisonOptions;
use super::table::{ComparisonRow, CutNumbers};
use super::work::Workpiece;

/// Results of a run for the table.
pub(super) struct Cut {
    pub(super) statistics: Statistics,
    pub(super) run: RunResult,
}

impl Cut {
    /// Returns true if the controller brought the cut to its end without the supervisor.
    pub(super) fn is_sound(&self) -> bool {
        self.run.outcome == Outcome::Completed && self.run.faded_out.is_none()
    }

    /// RMS contour error without the geometry that no encoder sees, um: the part that a controller
    /// can influence.
    pub(super) fn joint_rms_um(&self) -> f64 {
        self.run
            .joint_error
            .map_or_else(|| self.statistics.rms_um(), |joints| joints.rms_mm * 1e3)
    }
}

/// Cuts a workpiece, after as many laps of practice as the controller needs.
pub(super) fn cut(
    workpiece: &Workpiece,
    controller: &mut dyn Controller<2>,
    run: Run<'_>,
) -> Result<Cut, RunError> {
    let mut statistics = Statistics::new();
    let run = run.cut_steps(&workpiece.steps, controller, &mut [&mut statistics])?;
    Ok(Cut { statistics, run })
}

impl CutNumbers {
    fn of(Cut { statistics, run }: &Cut) -> Self {
        Self {
            time_s: run.time_s,
            rms_um: statistics.rms_um(),
            max_um: statistics.max_um(),
            joint_um: run
                .joint_error
                .map(|it| [it.rms_mm, it.max_mm].map(|mm| mm * 1e3)),
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
/// computed.
pub(super) fn row(
    workpiece: &Workpiece,
    machine: &Machine,
    competitor: &Competitor,
    controller: &mut dyn Controller<2>,
    seeds: &[u64],
    plan: &PlanCache,
    watch: &dyn Watch,
) -> Result<ComparisonRow, RunError> {
    let mut measured = Vec::with_capacity(seeds.len());
    for &seed in seeds {
        let machine = machine.with_noise_seed(seed);
        let run = Run::on(&machine).laps(competitor.entry.laps);
        let run = run.sharing(plan).watched(watch);
        measured.push(CutNumbers::of(&cut(workpiece, controller, run)?));
    }
    Ok(ComparisonRow::new(
        workpiece, machine, competitor, &measured,
    ))
}

/// The noise seeds of a machine.
pub(super) fn seeds(machine: &Machine, options: &ComparisonOptions) -> Vec<u64> {
    noise::reported(machine, options.seed, options.noise_seeds)
}
