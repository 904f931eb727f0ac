//! Information from a torque column that positions do not give: friction alone, and from it the
//! scale of everything else.
//!
//! ```text
//! u(k) = s (a + B/J v + Fc/J sign v + offset/J)        by least squares; s = J / g, g torque for a unit of the column
//! ```
//!
//! a, v and the sign come from the free run, which has no noise of the encoder in it (instruments,
//! as in Young 1970). With friction over inertia known, the delay of the speed in the drive can be
//! distinguished from a smaller inertia. To first order the two have the same effect on a position,
//! and all products that positions determine come out larger by 1 / (1 - Kv / J T).
//!
//! Source: Gautier (1997), Dynamic identification of robots with power model; Janot, Gautier and
//! Brunot (2019) for a bench on which this is public.

use nalgebra::{DMatrix, DVector};

use super::axis_record::AxisRecord;
use super::axis_run::{AxisRun, Commands, periods};
use super::terms::{ModelTerm, TermValues};

/// Result from the torque column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TorqueColumn {
    /// J / g: unit of the column for an acceleration of 1 mm/s2.
    pub(crate) units_per_mm_s2: f64,
    /// Its standard error.
    pub(crate) units_error: f64,
    /// B / J, 1/s.
    pub(crate) viscous_1_s: f64,
    /// Its standard error, 1/s.
    pub(crate) viscous_error_1_s: f64,
    /// Fc / J, mm/s2.
    pub(crate) coulomb_mm_s2: f64,
    /// Its standard error, mm/s2.
    pub(crate) coulomb_error_mm_s2: f64,
    /// Offset over J, mm/s2.
    pub(crate) offset_mm_s2: f64,
    /// Part of the variance of the column that is explained.
    pub(crate) explained: f64,
    /// Samples by which the column is later than the motion.
    pub(crate) late_samples: i32,
}

/// Delays of a column that are tried, samples; negative is early.
const LATENESSES: [i32; 5] = [-1, 0, 1, 2, 3];
/// Samples of a block that standard errors are from: residuals are correlated within.
const BLOCK_S: f64 = 0.25;
/// Least part of the variance that the motion must explain, and least part that the equation of a
/// drive must explain.
const EXPLAINED: f64 = 0.9;
const MODEL_EXPLAINED: f64 = 0.99;

impl TorqueColumn {
    /// Fits the column over the samples that count. `None` if the motion does not explain it.
    pub(super) fn find(
        record: &AxisRecord<'_>,
        torque: &[f64],
        values: &TermValues,
        counts: &[bool],
    ) -> Option<Self> {
        let motion = Regressors::of(record, values, counts);
        LATENESSES
            .iter()
            .filter_map(|&late| motion.explain(torque, counts, late, record.sample_s))
            .max_by(|a, b| a.explained.total_cmp(&b.explained))
            .filter(|found| found.explained > EXPLAINED && found.units_per_mm_s2 != 0.0)
    }
}

/// Parameters of a drive with a P speed loop, from a column that is the torque command of the
/// drive:
///
/// ```text
/// u(k) = p e(k) - q (y(k) - y(k - n)) / (n Ts) + o
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DriveColumn {
    /// Kp Kv / J, 1/s2.
    pub(crate) loop_gain_1_s2: f64,
    /// Kv / J, 1/s.
    pub(crate) speed_gain_1_s: f64,
    /// Samples over which the drive takes the speed.
    pub(crate) window_samples: usize,
    /// Part of the variance of the column that is explained.
    pub(crate) explained: f64,
}

/// Windows of the speed that are tried, samples.
const WINDOWS: [usize; 6] = [1, 2, 3, 4, 6, 8];

impl DriveColumn {
    /// Fits the column over the samples that count. `None` if the column is something else.
    pub(super) fn find(
        record: &AxisRecord<'_>,
        torque: &[f64],
        plant: &TorqueColumn,
        counts: &[bool],
    ) -> Option<Self> {
        let with_window = |window: &usize| {
            let window = *window;
            let rows: Vec<usize> = record
                .stretches
                .iter()
                .flat_map(|stretch| stretch.start + window..stretch.end)
                .filter(|&k| counts[k] && torque[k].is_finite())
                .collect();
            if rows.len() < 50 {
                return None;
            }
            let row = |i: usize, j: usize| {
                let k = rows[i];
                match j {
                    0 => record.command_mm[k] - record.actual_mm[k],
                    1 => {
                        (record.actual_mm[k] - record.actual_mm[k - window])
                            / (window as f64 * record.sample_s)
                    }
                    _ => 1.0,
                }
            };
            let matrix = DMatrix::from_fn(rows.len(), 3, row);
            let target = DVector::from_fn(rows.len(), |i, _| torque[rows[i]]);
            let found = matrix
                .tr_mul(&matrix)
                .cholesky()?
                .solve(&matrix.tr_mul(&target));
            let mean = target.mean();
            let total: f64 = target.iter().map(|value| (value - mean).powi(2)).sum();
            let explained =
                1.0 - (&target - &matrix * &found).norm_squared() / total.max(f64::MIN_POSITIVE);
            Some(Self {
                loop_gain_1_s2: found[0] / plant.units_per_mm_s2,
                speed_gain_1_s: -found[1] / plant.units_per_mm_s2,
                window_samples: window,
                explained,
            })
        };
        let found = WINDOWS
            .iter()
            .filter_map(with_window)
            .max_by(|a, b| a.explained.total_cmp(&b.explained))?;
        let is_model = found.explained > MODEL_EXPLAINED
            && found.loop_gain_1_s2 > 0.0
            && found.speed_gain_1_s > 0.0;
        is_model.then_some(found)
    }
}

/// Acceleration of the whole mass, speed and direction of the part that slides: of a free run, mean
/// over each sample.
struct Regressors {
    rows: Vec<[f64; 4]>,
}

impl Regressors {
    fn of(record: &AxisRecord<'_>, values: &TermValues, counts: &[bool]) -> Self {
        let run = AxisRun::new(values, record.sample_s);
        let (periods, _) = periods(record.sample_s);
        let smoothing_mm_s = values.smoothing_mm_s(periods.mechanics_s);
        let (coulomb, presliding) = (
            values.get(ModelTerm::Coulomb),
            values.get(ModelTerm::Presliding),
        );
        let mut rows = vec![[0.0; 4]; counts.len()];
        for stretch in record.stretches {
            let Some(last) = stretch.clone().rev().find(|&k| counts[k]) else {
                continue;
            };
            let commands = Commands::new(&record.command_mm[stretch.clone()]);
            let [mm, mm_s] = record.start(stretch, stretch.start);
            let mut state = run.state(&commands, 0, mm, mm_s);
            for k in stretch.start..=last {
                let [before, sliding_before] = state.of_whole_and_sliding_mm_s(run.table_share());
                run.step(&commands, k - stretch.start, &mut state);
                let [after, sliding_after] = state.of_whole_and_sliding_mm_s(run.table_share());
                let mean = 0.5 * (sliding_before + sliding_after);
                let sign = if presliding > 0.0 && coulomb > 0.0 {
                    ((state.presliding_mm_s2() - values.get(ModelTerm::Offset)) / coulomb)
                        .clamp(-1.0, 1.0)
                } else {
                    libm::tanh(mean / smoothing_mm_s)
                };
                rows[k] = [(after - before) / record.sample_s, mean, sign, 1.0];
            }
        }
        Self { rows }
    }

    fn explain(
        &self,
        torque: &[f64],
        counts: &[bool],
        late: i32,
        sample_s: f64,
    ) -> Option<TorqueColumn> {
        let pairs: Vec<([f64; 4], f64)> = (0..counts.len())
            .filter(|&k| counts[k])
            .filter_map(|k| {
                let at = usize::try_from(i64::try_from(k).ok()? + i64::from(late)).ok()?;
                let value = *torque.get(at)?;
                value.is_finite().then_some((self.rows[k], value))
            })
            .collect();
        let n = pairs.len();
        if n < 50 {
            return None;
        }
        let matrix = DMatrix::from_fn(n, 4, |i, j| pairs[i].0[j]);
        let target = DVector::from_fn(n, |i, _| pairs[i].1);
        let squares = matrix.tr_mul(&matrix);
        let inverse = squares.cholesky()?.inverse();
        let found = &inverse * matrix.tr_mul(&target);
        let left = &target - &matrix * &found;
        let mean = target.mean();
        let total: f64 = target.iter().map(|value| (value - mean).powi(2)).sum();
        // Blocks as single observations.
        let block = ((BLOCK_S / sample_s).ceil() as usize).max(1);
        let mut scatter = DMatrix::<f64>::zeros(4, 4);
        let mut blocks = 0.0;
        for from in (0..n).step_by(block) {
            let length = block.min(n - from);
            let g = matrix.rows(from, length).tr_mul(&left.rows(from, length));
            scatter += &g * g.transpose();
            blocks += 1.0;
        }
        let covariance = &inverse * scatter * &inverse * (blocks / (blocks - 1.0_f64).max(1.0));
        let scale = found[0];
        // Error of a ratio, to first order.
        let ratio_error = |i: usize| {
            let ratio = found[i] / scale;
            let variance = covariance[(i, i)] - 2.0 * ratio * covariance[(i, 0)]
                + ratio * ratio * covariance[(0, 0)];
            variance.max(0.0).sqrt() / scale.abs()
        };
        Some(TorqueColumn {
            units_per_mm_s2: scale,
            units_error: covariance[(0, 0)].max(0.0).sqrt(),
            viscous_1_s: found[1] / scale,
            viscous_error_1_s: ratio_error(1),
            coulomb_mm_s2: found[2] / scale,
            coulomb_error_mm_s2: ratio_error(2),
            offset_mm_s2: found[3] / scale,
            explained: 1.0 - left.norm_squared() / total.max(f64::MIN_POSITIVE),
            late_samples: late,
        })
    }
}
