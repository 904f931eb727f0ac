//! State of an axis at a sample of the record, from which free runs begin.
//!
//! ```text
//! r = y - x      x += g r,   v += g^2 r / (2 Ts),   load -= h Kp Kv / J r      at every sample
//! ```
//!
//! A filter of constant gains goes along the record up to that sample and no further. It estimates
//! position, speed and a load that the model does not have. The gains minimize the error of runs of
//! 50 ms over the fitted samples: high weight on the encoder where it is fine, on the model where
//! it is coarse.
//!
//! Source: the alpha-beta filter, Kalata (1984), The tracking index, IEEE Trans. Aerospace and
//! Electronic Systems 20(2), with a load as the third state.

use feedwright_sim::map_in_parallel;

use super::axis_record::AxisRecord;
use super::axis_run::{AxisRun, Commands, RunState};
use super::terms::{ModelTerm, TermValues};
use crate::average::rms;

/// Gains that are tried.
const POSITION: [f64; 6] = [0.03, 0.1, 0.2, 0.4, 0.7, 1.0];
const LOAD: [f64; 4] = [0.0, 0.01, 0.03, 0.1];
/// Runs that gains are compared by, and their time, s.
const RUNS: usize = 300;
const RUN_S: f64 = 0.05;

/// A filter along a record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StartFilter {
    position: f64,
    load: f64,
}

/// A free run's beginning.
pub(super) struct RunStart {
    pub(super) sample: usize,
    pub(super) state: RunState,
}

impl StartFilter {
    /// The best over samples that count.
    pub(super) fn best(record: &AxisRecord<'_>, values: &TermValues, counts: &[bool]) -> Self {
        let ahead = ((RUN_S / record.sample_s).round() as usize).max(1);
        let samples = starts(record, counts, ahead, RUNS);
        let all: Vec<Self> = POSITION
            .iter()
            .flat_map(|&position| LOAD.map(|load| Self { position, load }))
            .collect();
        let missed = map_in_parallel(&all, |filter| {
            let found = filter.along(record, values, &samples);
            let run = AxisRun::new(values, record.sample_s);
            rms(found
                .starts
                .into_iter()
                .map(|start| run_ahead(record, &run, start, &[ahead])[0]))
        });
        let best = (0..all.len()).min_by(|&a, &b| missed[a].total_cmp(&missed[b]));
        best.map_or(all[0], |best| all[best])
    }

    /// Goes along the record: states at samples in rising order, and its innovations, mm.
    pub(super) fn along(
        &self,
        record: &AxisRecord<'_>,
        values: &TermValues,
        samples: &[usize],
    ) -> Filtered {
        let run = AxisRun::new(values, record.sample_s);
        let Self {
            position: g,
            load: h,
        } = *self;
        let gains = [
            g,
            0.5 * g * g / record.sample_s,
            -h * values.get(ModelTerm::LoopGain),
        ];
        let mut starts = Vec::with_capacity(samples.len());
        let mut innovations_mm = vec![0.0; record.actual_mm.len()];
        let mut wanted = samples.iter().copied().peekable();
        for stretch in record.stretches {
            let commands = Commands::new(&record.command_mm[stretch.clone()]);
            let [mm, mm_s] = record.start(stretch, stretch.start);
            let mut state = run.state(&commands, 0, mm, mm_s);
            for k in stretch.clone() {
                let innovation = record.actual_mm[k] - state.position_mm();
                innovations_mm[k] = innovation;
                state.correct(gains.map(|gain| gain * innovation));
                if wanted.next_if_eq(&k).is_some() {
                    starts.push(RunStart {
                        sample: k,
                        state: state.clone(),
                    });
                }
                run.step(&commands, k - stretch.start, &mut state);
            }
        }
        Filtered {
            starts,
            innovations_mm,
        }
    }
}

/// Result of the filter.
pub(super) struct Filtered {
    pub(super) starts: Vec<RunStart>,
    pub(super) innovations_mm: Vec<f64>,
}

/// Returns at most `most` samples, evenly over the record, from which `ahead` samples count as
/// well.
pub(super) fn starts(
    record: &AxisRecord<'_>,
    counts: &[bool],
    ahead: usize,
    most: usize,
) -> Vec<usize> {
    let mut all = vec![];
    for stretch in record.stretches {
        let mut counting = 0;
        for k in stretch.clone() {
            counting = if counts[k] { counting + 1 } else { 0 };
            if counting > ahead {
                all.push(k - ahead);
            }
        }
    }
    let apart = all.len().div_ceil(most.max(1)).max(1);
    all.into_iter().step_by(apart).collect()
}

/// Returns the error of a run from a start after each number of samples in `ahead`, mm.
pub(super) fn run_ahead(
    record: &AxisRecord<'_>,
    run: &AxisRun,
    start: RunStart,
    ahead: &[usize],
) -> Vec<f64> {
    let RunStart { sample, mut state } = start;
    let Some(stretch) = record
        .stretches
        .iter()
        .find(|stretch| stretch.contains(&sample))
    else {
        return vec![];
    };
    let commands = Commands::new(&record.command_mm[stretch.clone()]);
    let mut missed = Vec::with_capacity(ahead.len());
    let last = ahead.iter().copied().max().unwrap_or(0);
    for k in sample..=sample + last {
        for _ in ahead.iter().filter(|&&ahead| sample + ahead == k) {
            missed.push(record.actual_mm[k] - state.position_mm());
        }
        run.step(&commands, k - stretch.start, &mut state);
    }
    missed
}
