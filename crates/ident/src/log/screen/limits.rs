//! Limits that show: torque that does not go further, speed that does not.

use super::super::LogAxis;
use super::super::clock::Clock;
use super::super::finding::LogFinding;
use super::LOOKED_AT;

/// Part of the samples at one value from which on it is a limit.
const LEAST_PART: f64 = 5e-4;
/// Samples one after the other that a torque stays at its limit.
const RUN: usize = 3;
/// Shortest time over which a speed is taken, s, and steps of the encoder within it: noise and
/// steps count less.
const SPEED_S: f64 = 4e-3;
const SPEED_STEPS: f64 = 20.0;
/// Most samples over which a speed is taken.
const MAX_SPEED_SAMPLES: usize = 50;
/// Least factor of the command's speed over the highest speed, where the speed has a limit.
const FASTER: f64 = 1.2;
/// Highest over lowest speed of what counts as one.
const BAND: f64 = 1.08;
/// Part of the samples in which the speed is at its limit, where there is one.
const AT_LIMIT: f64 = 0.02;
/// Actual samples over commanded samples in the band of a speed; a speed limit has more than this.
const OFTENER: f64 = 2.0;

/// Reports a torque that stays at its largest value.
pub(super) fn torque(axis: &LogAxis, clock: &Clock) -> Option<LogFinding> {
    let torque = axis.torque.as_ref()?;
    let limit = torque
        .iter()
        .filter(|value| value.is_finite())
        .fold(0.0_f64, |limit, value| limit.max(value.abs()));
    if limit == 0.0 {
        return None;
    }
    let (mut count, mut run, mut longest, mut first, mut last) =
        (0_usize, 0_usize, 0_usize, None, 0);
    for (k, value) in torque.iter().enumerate() {
        // The last digit may differ from sample to sample.
        if value.abs() >= limit * (1.0 - 1e-6) {
            count += 1;
            run += 1;
            longest = longest.max(run);
            first.get_or_insert(k);
            last = k;
        } else {
            run = 0;
        }
    }
    let part = count as f64 / torque.len() as f64;
    let [from_s, to_s] = [first?, last].map(|k| clock.time_s.get(k).copied().unwrap_or(0.0));
    (longest >= RUN && part >= LEAST_PART).then(|| LogFinding::TorqueLimit {
        axis: axis.name.clone(),
        limit,
        unit: axis.torque_unit,
        part,
        from_s,
        to_s,
    })
}

/// Finds a limit below the commanded speed at which the actual speed stays; `None` without such a
/// limit.
pub(super) fn speed(axis: &LogAxis, clock: &Clock) -> Option<LogFinding> {
    // As many samples as the steps ask for at the speed of the command.
    let reach_mm = axis
        .command_mm
        .windows(2)
        .fold(0.0_f64, |reach, pair| reach.max((pair[1] - pair[0]).abs()));
    let for_steps = SPEED_STEPS * axis.step_mm / reach_mm.max(f64::MIN_POSITIVE);
    let samples = (SPEED_S / clock.sample_time_s).max(for_steps).ceil();
    let samples = (samples as usize).clamp(1, MAX_SPEED_SAMPLES);
    let of = |values: &[f64]| -> Vec<f64> {
        let across_s = samples as f64 * clock.sample_time_s;
        let stride = values.len().div_ceil(LOOKED_AT).max(1);
        let stretches = clock
            .stretches
            .iter()
            .filter_map(|stretch| values.get(stretch.clone()));
        stretches
            .flat_map(|part| {
                part.windows(samples + 1)
                    .step_by(stride)
                    .map(|w| (w[samples] - w[0]).abs() / across_s)
            })
            .collect()
    };
    let (mut commanded, mut actual) = (of(&axis.command_mm), of(&axis.actual_mm));
    commanded.sort_by(f64::total_cmp);
    actual.sort_by(f64::total_cmp);
    let at = |values: &[f64], part: f64| values.get((part * values.len() as f64) as usize).copied();
    let (fast, commanded_mm_s) = (at(&actual, 0.95)?, at(&commanded, 0.995)?);
    // The band that holds most of the fast samples: overshoot is above it, ways to the limit are
    // below.
    let below = |values: &[f64], speed: f64| values.partition_point(|value| *value < speed);
    let first = below(&actual, 0.5 * fast);
    let within = |values: &[f64], from: f64| below(values, BAND * from) - below(values, from);
    let from = actual[first..]
        .iter()
        .copied()
        .max_by_key(|&from| within(&actual, from))
        .filter(|&from| from > 0.0)?;
    let (here, there) = (within(&actual, from), within(&commanded, from));
    let limit_mm_s = *actual.get(below(&actual, from) + here / 2)?;
    let is_limited = commanded_mm_s > FASTER * BAND * from
        && here as f64 > AT_LIMIT * actual.len() as f64
        && here as f64 > OFTENER * there as f64;
    is_limited.then(|| LogFinding::SpeedLimit {
        axis: axis.name.clone(),
        limit_mm_s,
        commanded_mm_s,
    })
}
