//! One row of the comparison: a cut for each noise seed.

use feedwright_control::Controller;

use super::competitor::Competitor;
use super::noise;
use super::options::ComparisonOptions;
use super::table::{ComparisonRow, CutNumbers};
use super::work::Workpiece;
use crate::machine::Machine;
use crate::pipeline::{Run, RunError};
use crate::report::Statistics;
use crate::simulate::RunResult;
use crate::trace::{Outcome, Row, Sink};
use crate::watch::Watch;

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
    fn of(Cut { statistics, run }: &Cut, acceleration: &Acceleration) -> Self {
        Self {
            time_s: run.time_s,
            rms_um: statistics.rms_um(),
            max_um: statistics.max_um(),
            joint_um: run.joint_error.map(|joints| [joints.rms_mm, joints.max_mm].map(|mm| mm * 1e3)),
            uncut_um: run.uncut_mm * 1e3,
            max_deviation_um: statistics.max_deviation_um(),
            accel_mm_s2: acceleration.largest_mm_s2,
            peak_torque_nm: statistics.peak_torque_nm().into_iter().fold(0.0, f64::max),
            completed: run.outcome == Outcome::Completed,
            faded_out: run.faded_out.map(|faded| faded.cause),
        }
    }
}

/// One row, its ratios still open: a cut for each of the `seeds` of the noise that the machine has. The plot is that of the first.
pub(super) fn row(
    workpiece: &Workpiece,
    machine: &Machine,
    competitor: &Competitor,
    controller: &mut dyn Controller<2>,
    seeds: &[u64],
    watch: &dyn Watch,
) -> Result<ComparisonRow, RunError> {
    let mut errors = Errors::default();
    let mut measured = Vec::with_capacity(seeds.len());
    for (k, &seed) in seeds.iter().enumerate() {
        let machine = machine.with_noise_seed(seed);
        let run = Run::on(&machine).laps(competitor.entry.laps).watched(watch);
        let mut acceleration = Acceleration::new(machine.period.servo_s);
        let mut sinks: Vec<&mut dyn Sink> = vec![&mut acceleration];
        if k == 0 {
            sinks.push(&mut errors);
        }
        let cut = cut(workpiece, controller, run, &mut sinks)?;
        measured.push(CutNumbers::of(&cut, &acceleration));
    }
    Ok(ComparisonRow::new(workpiece, machine, competitor, &measured, errors.thinned()))
}

/// The noise seeds of a machine.
pub(super) fn seeds(machine: &Machine, options: &ComparisonOptions) -> Vec<u64> {
    noise::reported(machine, options.seed, options.noise_seeds)
}

/// The largest acceleration of the command of an axis: the second difference over three servo periods that follow on each other.
struct Acceleration {
    servo_s: f64,
    /// Time and command of the last two rows.
    before: [Option<(f64, [f64; 3])>; 2],
    largest_mm_s2: f64,
}

/// Rows that are further apart than this many servo periods do not follow on each other: a rest was left out.
const NEXT_PERIODS: f64 = 1.5;

impl Acceleration {
    const fn new(servo_s: f64) -> Self {
        Self { servo_s, before: [None; 2], largest_mm_s2: 0.0 }
    }
}

impl Sink for Acceleration {
    fn row(&mut self, row: &Row) -> std::io::Result<()> {
        if let [Some((t0_s, first)), Some((_, second))] = self.before
            && row.t_s - t0_s < (1.0 + NEXT_PERIODS) * self.servo_s
        {
            for k in 0..3 {
                let accel_mm_s2 = (row.cmd_mm[k] - 2.0 * second[k] + first[k]) / (self.servo_s * self.servo_s);
                self.largest_mm_s2 = self.largest_mm_s2.max(accel_mm_s2.abs());
            }
        }
        self.before = [self.before[1], Some((row.t_s, row.cmd_mm))];
        Ok(())
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::tests::row;

    #[test]
    fn the_acceleration_of_a_parabola_is_its_own_and_none_is_seen_across_a_rest() {
        let mut seen = Acceleration::new(1e-3);
        let at = |t_s: f64| Row { cmd_mm: [0.0, -400.0 * t_s * t_s, 0.0], ..row(t_s) };
        (0..10).for_each(|n| seen.row(&at(f64::from(n) * 1e-3)).unwrap());
        assert!((seen.largest_mm_s2 - 800.0).abs() < 1e-6, "{}", seen.largest_mm_s2);
        // A second later it is somewhere else.
        (1000..1002).for_each(|n| seen.row(&at(f64::from(n) * 1e-3)).unwrap());
        assert!((seen.largest_mm_s2 - 800.0).abs() < 1e-6, "{}", seen.largest_mm_s2);
    }
}
