//! How far predictions miss on samples that were not fitted: grey box, ARX, and the error that
//! stays.
//!
//! From a sample on nothing of the record is known but the commands. An error of 20, 50, or 100 ms
//! is that at the end of such a run, over runs from many samples; the whole run is one from the
//! first scored sample of each stretch to its last, over the scored samples.

use feedwright_sim::map_in_parallel;

use super::axis_record::AxisRecord;
use super::axis_run::{AxisRun, Commands};
use super::linear_arx::{ArxData, LinearArx, ORDERS};
use super::start_filter::{StartFilter, run_ahead, starts};
use super::terms::TermValues;
use crate::average::rms;

/// Horizons, s, and what they are called.
pub const HORIZONS: [(f64, &str); 3] = [(0.02, "20ms"), (0.05, "50ms"), (0.1, "100ms")];
/// Runs of each horizon.
const RUNS: usize = 3000;

/// RMS of what free runs miss.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeRunErrors {
    /// Error at the end of 20, 50 and 100 ms, um.
    pub at_um: [f64; 3],
    /// Error over whole runs, um.
    pub whole_um: f64,
    /// One sample ahead, um: shown, and not judged.
    pub one_step_um: f64,
}

/// Scores of an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisScores {
    /// RMS of the following error over the scored samples, um.
    pub following_um: f64,
    /// Errors of the grey box.
    pub grey_box: FreeRunErrors,
    /// The same over that part of the scored samples in which speed or acceleration is beyond all
    /// that was fitted, um, and its share.
    pub beyond: Option<(f64, f64)>,
    /// Errors of each ARX.
    pub arx: Vec<(LinearArx, FreeRunErrors)>,
    /// Were the following error to stay what it is.
    pub stays: FreeRunErrors,
    /// Position that the whole run has at each scored sample, mm; none elsewhere.
    pub simulated_mm: Vec<Option<f64>>,
    /// The same of the ARX that is best over the whole run.
    pub arx_mm: Vec<Option<f64>>,
    /// Correlation of the filter's innovations with those one sample before, over the scored
    /// samples: zero were they white.
    pub innovation_correlation: f64,
    /// The same of what the whole run leaves.
    pub residual_correlation: f64,
}

impl AxisScores {
    /// The least that an ARX leaves at each horizon and over the whole run, um.
    pub fn best_arx(&self) -> FreeRunErrors {
        Self::least(self.arx.iter().map(|arx| arx.1))
    }

    /// The same without signs.
    pub(crate) fn best_linear(&self) -> FreeRunErrors {
        Self::least(self.arx.iter().filter(|arx| !arx.0.signs).map(|arx| arx.1))
    }

    fn least(errors: impl Iterator<Item = FreeRunErrors>) -> FreeRunErrors {
        let none = FreeRunErrors {
            at_um: [f64::INFINITY; 3],
            whole_um: f64::INFINITY,
            one_step_um: f64::INFINITY,
        };
        errors.fold(none, |least, errors| FreeRunErrors {
            at_um: std::array::from_fn(|i| least.at_um[i].min(errors.at_um[i])),
            whole_um: least.whole_um.min(errors.whole_um),
            one_step_um: least.one_step_um.min(errors.one_step_um),
        })
    }
}

/// Scores an axis whose model is fitted.
pub(super) fn score(
    record: &AxisRecord<'_>,
    values: &TermValues,
    fit: &[bool],
    scored: &[bool],
) -> AxisScores {
    let ahead =
        HORIZONS.map(|(horizon_s, _)| ((horizon_s / record.sample_s).round() as usize).max(1));
    let filter = StartFilter::best(record, values, fit);
    let run = AxisRun::new(values, record.sample_s);
    let samples = starts(record, scored, ahead[2], RUNS);
    let parts = parts(record, scored);
    // Filter and grey box.
    let mut wanted = samples.clone();
    wanted.extend(parts.iter().map(|part| part[0]));
    wanted.sort_unstable();
    wanted.dedup();
    let filtered = filter.along(record, values, &wanted);
    let mut simulated_mm = vec![None; scored.len()];
    let mut from_samples = vec![];
    for start in filtered.starts {
        if let Some([_, last]) = parts.iter().find(|part| part[0] == start.sample) {
            let Some(stretch) = record
                .stretches
                .iter()
                .find(|stretch| stretch.contains(last))
            else {
                continue;
            };
            let commands = Commands::new(&record.command_mm[stretch.clone()]);
            let mut state = start.state.clone();
            for k in start.sample..=*last {
                if scored[k] {
                    simulated_mm[k] = Some(state.position_mm());
                }
                run.step(&commands, k - stretch.start, &mut state);
            }
        }
        if samples.binary_search(&start.sample).is_ok() {
            from_samples.push(start);
        }
    }
    let missed = map_in_parallel(from_samples, |start| run_ahead(record, &run, start, &ahead));
    let at_um =
        [0, 1, 2].map(|i| 1e3 * rms(missed.iter().filter_map(|missed| missed.get(i).copied())));
    let whole_um = 1e3 * left_rms(record, &simulated_mm, |_| true);
    let one_step_um = 1e3
        * rms((0..scored.len())
            .filter(|&k| scored[k])
            .map(|k| filtered.innovations_mm[k]));
    let innovation_correlation = correlation(scored, |k| filtered.innovations_mm[k]);
    let residual_correlation = correlation(scored, |k| {
        simulated_mm[k].map_or(0.0, |simulated| record.actual_mm[k] - simulated)
    });
    let beyond = beyond(record, fit, scored, &simulated_mm);
    let (arx, arx_mm) = score_arx(record, fit, scored, &samples, &parts, ahead);
    AxisScores {
        following_um: 1e3 * record.following_mm(scored),
        grey_box: FreeRunErrors {
            at_um,
            whole_um,
            one_step_um,
        },
        beyond,
        arx,
        stays: stays(record, scored, &samples, &parts, ahead),
        simulated_mm,
        arx_mm,
        innovation_correlation,
        residual_correlation,
    }
}

/// Returns the correlation of values with those one sample before.
fn correlation(scored: &[bool], value: impl Fn(usize) -> f64) -> f64 {
    let (mut products, mut squares) = (0.0, 0.0);
    for k in (1..scored.len()).filter(|&k| scored[k] && scored[k - 1]) {
        products += value(k) * value(k - 1);
        squares += value(k) * value(k);
    }
    if squares > 0.0 {
        products / squares
    } else {
        0.0
    }
}

/// First and last scored sample of each stretch.
fn parts(record: &AxisRecord<'_>, scored: &[bool]) -> Vec<[usize; 2]> {
    let part = |stretch: &std::ops::Range<usize>| {
        let first = stretch.clone().find(|&k| scored[k])?;
        let last = stretch.clone().rev().find(|&k| scored[k])?;
        Some([first, last])
    };
    record.stretches.iter().filter_map(part).collect()
}

fn left_rms(
    record: &AxisRecord<'_>,
    simulated_mm: &[Option<f64>],
    counts: impl Fn(usize) -> bool,
) -> f64 {
    let left = |(k, simulated): (usize, &Option<f64>)| {
        simulated
            .filter(|_| counts(k))
            .map(|simulated| record.actual_mm[k] - simulated)
    };
    rms(simulated_mm.iter().enumerate().filter_map(left))
}

/// Speed or acceleration counts as beyond all that was fitted above this factor.
const BEYOND: f64 = 1.05;

fn beyond(
    record: &AxisRecord<'_>,
    fit: &[bool],
    scored: &[bool],
    simulated: &[Option<f64>],
) -> Option<(f64, f64)> {
    let motions = [
        record.command_speed_mm_s(),
        record.command_acceleration_mm_s2(),
    ];
    let most = motions.each_ref().map(|motion| {
        (0..fit.len())
            .filter(|&k| fit[k])
            .fold(0.0_f64, |most, k| most.max(motion[k].abs()))
    });
    let is_beyond = |k: usize| (0..2).any(|i| motions[i][k].abs() > BEYOND * most[i]);
    let n = scored.iter().filter(|scored| **scored).count().max(1) as f64;
    let share = (0..scored.len())
        .filter(|&k| scored[k] && is_beyond(k))
        .count() as f64
        / n;
    (share > 0.0).then(|| (1e3 * left_rms(record, simulated, is_beyond), share))
}

type ArxScores = (Vec<(LinearArx, FreeRunErrors)>, Vec<Option<f64>>);

fn score_arx(
    record: &AxisRecord<'_>,
    fit: &[bool],
    scored: &[bool],
    samples: &[usize],
    parts: &[[usize; 2]],
    ahead: [usize; 3],
) -> ArxScores {
    let data = ArxData::new(record);
    let error_mm = |k: usize| record.command_mm[k] - record.actual_mm[k];
    let fits = map_in_parallel(ORDERS, |order| LinearArx::fit(&data, fit, order));
    let mut best = (f64::INFINITY, vec![None; scored.len()]);
    let mut scores = vec![];
    for arx in fits.into_iter().flatten() {
        let missed = map_in_parallel(samples.iter().filter(|&&k| k >= arx.reach()), |&k| {
            // A run of n samples from k + 1 on ends at k + n.
            let run = arx.run_mm(&data, k + 1, ahead[2]);
            [ahead[0], ahead[1], ahead[2], 1].map(|ahead| run[ahead - 1] - error_mm(k + ahead))
        });
        let mut simulated = vec![None; scored.len()];
        for &[first, last] in parts.iter().filter(|part| part[0] >= arx.reach()) {
            let run = arx.run_mm(&data, first, last + 1 - first);
            for k in (first..=last).filter(|&k| scored[k]) {
                simulated[k] = Some(record.command_mm[k] - run[k - first]);
            }
        }
        let whole_um = finite(1e3 * left_rms(record, &simulated, |_| true));
        let at = |i: usize| finite(1e3 * rms(missed.iter().map(|missed| missed[i])));
        if whole_um < best.0 {
            best = (whole_um, simulated);
        }
        scores.push((
            arx,
            FreeRunErrors {
                at_um: [at(0), at(1), at(2)],
                whole_um,
                one_step_um: at(3),
            },
        ));
    }
    (scores, best.1)
}

/// A run that is lost is infinitely far off.
fn finite(value: f64) -> f64 {
    if value.is_finite() {
        value
    } else {
        f64::INFINITY
    }
}

fn stays(
    record: &AxisRecord<'_>,
    scored: &[bool],
    samples: &[usize],
    parts: &[[usize; 2]],
    ahead: [usize; 3],
) -> FreeRunErrors {
    let error_mm = |k: usize| record.command_mm[k] - record.actual_mm[k];
    let at = |ahead: usize| 1e3 * rms(samples.iter().map(|&k| error_mm(k + ahead) - error_mm(k)));
    let whole = parts.iter().flat_map(|&[first, last]| {
        (first..=last)
            .filter(|&k| scored[k])
            .map(move |k| error_mm(k) - error_mm(first))
    });
    FreeRunErrors {
        at_um: ahead.map(at),
        whole_um: 1e3 * rms(whole),
        one_step_um: at(1),
    }
}
