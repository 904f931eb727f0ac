//! Limits that show: torque that does not go further, speed that does not.

use super::super::LogAxis;
use super::super::clock::Clock;
use super::super::finding::LogFinding;

/// Part of the samples at one value from which on it is a limit.
const LEAST_PART: f64 = 5e-4;
/// Samples one after the other that a torque stays at its limit.
const RUN: usize = 3;
/// Samples over which a speed is taken: steps of the encoder count less.
const SPEED_SAMPLES: usize = 5;
/// How much faster the command is than the highest speed, where the speed has a limit.
const FASTER: f64 = 1.2;
/// Part of the samples in which the speed is near its highest, where that is a limit.
const AT_LIMIT: f64 = 0.02;

/// Whether a torque stays at its largest value.
pub(super) fn torque(axis: &LogAxis, clock: &Clock) -> Option<LogFinding> {
    let torque = axis.torque.as_ref()?;
    let limit = torque.iter().filter(|value| value.is_finite()).fold(0.0_f64, |limit, value| limit.max(value.abs()));
    if limit == 0.0 {
        return None;
    }
    let (mut count, mut run, mut longest, mut first, mut last) = (0_usize, 0_usize, 0_usize, None, 0);
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

/// Whether the speed stays below that of the command.
pub(super) fn speed(axis: &LogAxis, clock: &Clock) -> Option<LogFinding> {
    let of = |values: &[f64]| -> Vec<f64> {
        let across_s = SPEED_SAMPLES as f64 * clock.sample_time_s;
        let stretches = clock.stretches.iter().filter_map(|stretch| values.get(stretch.clone()));
        stretches
            .flat_map(|part| part.windows(SPEED_SAMPLES + 1).map(|w| (w[SPEED_SAMPLES] - w[0]).abs() / across_s))
            .collect()
    };
    let (mut commanded, mut actual) = (of(&axis.command_mm), of(&axis.actual_mm));
    commanded.sort_by(f64::total_cmp);
    actual.sort_by(f64::total_cmp);
    let at = |values: &[f64], part: f64| values.get((part * values.len() as f64) as usize).copied();
    let highest = at(&actual, 0.995)?;
    let commanded_mm_s = at(&commanded, 0.995)?;
    let near = &actual[actual.partition_point(|speed| *speed < 0.93 * highest)..];
    let is_limited = commanded_mm_s > FASTER * highest && near.len() as f64 > AT_LIMIT * actual.len() as f64;
    // The middle of those near it: noise and overshoot are above, ways to the limit below.
    let limit_mm_s = at(near, 0.5)?;
    is_limited.then(|| LogFinding::SpeedLimit { axis: axis.name.clone(), limit_mm_s, commanded_mm_s })
}
