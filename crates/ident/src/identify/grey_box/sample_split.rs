//! Which samples of a record are fitted, and which are kept to judge by.
//!
//! By motion, not by time: the record is cut into blocks of so much time in which an axis moves,
//! and they take turns. Standstill belongs to the block that it ends, and makes none. The length of
//! a block is the first of some at which each direction of each axis has its share of both parts.
//! The beginning of each stretch, where a free run still depends on how it started, is neither.

use std::ops::Range;

use super::axis_record::AxisRecord;

/// Fitted samples and scored samples.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SampleSplit {
    /// Fitted.
    pub(crate) fit: Vec<bool>,
    /// Kept to judge by.
    pub score: Vec<bool>,
    /// Axes by place and direction, -1 or 1, that move that way in one part alone, or hardly in
    /// one.
    pub one_sided: Vec<(usize, i8)>,
}

/// Time that blocks begin with, s of motion; shorter ones are tried where directions are not shared
/// well.
const BLOCKS_S: [f64; 7] = [2.0, 1.4, 1.0, 0.7, 0.5, 0.35, 0.25];
/// Fewest blocks into which a record is split.
const LEAST_BLOCKS: f64 = 4.0;
/// Least and most share of a direction that a part has.
const SHARE: [f64; 2] = [0.25, 0.75];
/// An axis moves above this part of its highest commanded speed.
const MOVES: f64 = 0.01;
/// Beginning of a stretch that is neither, s, and no more than this part of the stretch.
const SETTLING_S: f64 = 0.2;
const SETTLING_PART: f64 = 0.1;

impl SampleSplit {
    /// Blocks that take turns.
    pub(crate) fn by_motion(records: &[AxisRecord<'_>]) -> Self {
        let motions: Vec<Vec<i8>> = records.iter().map(motion).collect();
        let settled = settled(records);
        let mut best: Option<(f64, Self)> = None;
        for block_s in BLOCKS_S {
            let blocks = blocks(records, &motions, &settled, block_s);
            let part = |odd: bool| -> Vec<bool> {
                blocks
                    .iter()
                    .zip(&settled)
                    .map(|(block, settled)| *settled && (block % 2 == 1) == odd)
                    .collect()
            };
            let (fit, score) = (part(false), part(true));
            let shares = shares(&motions, &fit, &score);
            let off = shares
                .iter()
                .map(|share| (share.2 - 0.5).abs())
                .fold(0.0, f64::max);
            let one_sided = shares
                .iter()
                .filter(|share| !(SHARE[0]..=SHARE[1]).contains(&share.2))
                .map(|share| (share.0, share.1))
                .collect::<Vec<_>>();
            let is_shared = one_sided.is_empty();
            let split = Self {
                fit,
                score,
                one_sided,
            };
            if is_shared {
                return split;
            }
            if best.as_ref().is_none_or(|best| off < best.0) {
                best = Some((off, split));
            }
        }
        // There is always a first.
        best.map_or_else(Self::nothing, |best| best.1)
    }

    /// Splits by times of the record, s.
    pub(crate) fn by_times(
        records: &[AxisRecord<'_>],
        time_s: &[f64],
        fit: Range<f64>,
        score: Range<f64>,
    ) -> Self {
        let motions: Vec<Vec<i8>> = records.iter().map(motion).collect();
        let settled = settled(records);
        let within = |times: &Range<f64>| -> Vec<bool> {
            time_s
                .iter()
                .zip(&settled)
                .map(|(time_s, settled)| *settled && times.contains(time_s))
                .collect()
        };
        let (fit, score) = (within(&fit), within(&score));
        let shares = shares(&motions, &fit, &score);
        let one_sided = shares
            .iter()
            .filter(|share| share.2 <= 0.0 || share.2 >= 1.0)
            .map(|share| (share.0, share.1))
            .collect();
        Self {
            fit,
            score,
            one_sided,
        }
    }

    fn nothing() -> Self {
        Self {
            fit: vec![],
            score: vec![],
            one_sided: vec![],
        }
    }

    /// The fitted samples once more in two parts, blocks of motion that take turns: what terms are
    /// fitted on, and what they are admitted by. And the time of motion in the first, s.
    pub(super) fn inner(&self, record: &AxisRecord<'_>) -> (Vec<bool>, Vec<bool>, f64) {
        let motion = motion(record);
        let moving = (0..motion.len())
            .filter(|&k| self.fit[k] && motion[k] != 0)
            .count() as f64
            * record.sample_s;
        let block_s = (moving / INNER_BLOCKS).clamp(SHORTEST_INNER_S, LONGEST_INNER_S);
        let blocks = blocks(&[*record], &[motion], &self.fit, block_s);
        let part = |third: bool| -> Vec<bool> {
            self.fit
                .iter()
                .zip(&blocks)
                .map(|(fit, block)| *fit && (block % 3 == 2) == third)
                .collect()
        };
        (part(false), part(true), moving)
    }
}

/// Blocks that the fitted motion is cut into for the admission of terms, where there is enough, and
/// bounds of one, s.
const INNER_BLOCKS: f64 = 12.0;
const SHORTEST_INNER_S: f64 = 0.02;
const LONGEST_INNER_S: f64 = 1.0;

/// Direction in which an axis is commanded at each sample; zero is at rest.
pub(super) fn motion(record: &AxisRecord<'_>) -> Vec<i8> {
    let speed_mm_s = record.command_speed_mm_s();
    let fastest = speed_mm_s
        .iter()
        .fold(0.0_f64, |most, speed| most.max(speed.abs()));
    let least = MOVES * fastest;
    let direction = |speed: f64| {
        if speed > least {
            1
        } else {
            -i8::from(speed < -least)
        }
    };
    speed_mm_s.into_iter().map(direction).collect()
}

/// Samples behind the beginning of their stretch.
fn settled(records: &[AxisRecord<'_>]) -> Vec<bool> {
    let Some(record) = records.first() else {
        return vec![];
    };
    let mut settled = vec![false; record.command_mm.len()];
    let all = vec![true; settled.len()];
    let late = records
        .iter()
        .map(|record| record.without_command(&all))
        .max()
        .unwrap_or(0);
    for stretch in record.stretches {
        let most = SETTLING_PART * stretch.len() as f64;
        let beginning = (SETTLING_S / record.sample_s).min(most).ceil() as usize + late;
        settled[(stretch.start + beginning).min(stretch.end)..stretch.end].fill(true);
    }
    settled
}

/// Number of the block of each sample.
fn blocks(
    records: &[AxisRecord<'_>],
    motions: &[Vec<i8>],
    counts: &[bool],
    block_s: f64,
) -> Vec<usize> {
    let sample_s = records.first().map_or(1.0, |record| record.sample_s);
    let moves = |k: usize| counts[k] && motions.iter().any(|motion| motion[k] != 0);
    let moving_s = (0..counts.len()).filter(|&k| moves(k)).count() as f64 * sample_s;
    let length = (block_s.min(moving_s / LEAST_BLOCKS) / sample_s).max(1.0);
    let (mut block, mut in_block) = (0, 0.0);
    let number = |k: usize| {
        if moves(k) {
            in_block += 1.0;
            if in_block > length {
                (block, in_block) = (block + 1, 1.0);
            }
        }
        block
    };
    (0..counts.len()).map(number).collect()
}

/// Returns the fitted part of the motion of each axis in each direction in which it moves.
fn shares(motions: &[Vec<i8>], fit: &[bool], score: &[bool]) -> Vec<(usize, i8, f64)> {
    let mut shares = vec![];
    for (axis, motion) in motions.iter().enumerate() {
        for direction in [-1, 1] {
            let count = |part: &[bool]| {
                motion
                    .iter()
                    .zip(part)
                    .filter(|(m, p)| **p && **m == direction)
                    .count() as f64
            };
            let (fitted, scored) = (count(fit), count(score));
            if fitted + scored > 0.0 {
                shares.push((axis, direction, fitted / (fitted + scored)));
            }
        }
    }
    shares
}
