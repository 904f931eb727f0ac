//! Screening: findings about the record of each axis, and refusal of records from which no servo
//! model can be made.

mod steps;
mod limits;
mod lines;

use feedwright_sim::to_four_digits;

use super::clock::Clock;
use super::error::{LogError, Refusal, RefusalReason};
use super::finding::LogFinding;
use super::pairs::delay_samples;
use super::{Fitness, LogAxis};
use crate::average::rms;

/// Longest time between samples, s: position loops of machines have gains from 10 1/s on, and two
/// samples within the 100 ms of the slowest are the least that shows it.
const MAX_SAMPLE_TIME_S: f64 = 0.05;
/// Shortest record, s: some reversals fit in.
const MIN_RECORD_S: f64 = 1.0;
/// Fewest samples: ten for each number that describes an axis.
const MIN_SAMPLES: usize = 200;
/// Largest range of a position that stands still, mm.
const STILL_MM: f64 = 1e-6;
/// Largest range of the actual position of an axis that is held where its command stands still, mm:
/// more is no noise and no load, but another axis.
const HELD_MM: f64 = 0.1;
/// Longest way of a linear axis, mm.
const LONGEST_MM: f64 = 30e3;
/// Samples by which a copy of the command can be late in a control that feeds it back to itself.
const COPY_SAMPLES: usize = 4;
/// Part of the moving samples in which a copy equals the command.
const COPY_PART: f64 = 0.99;
/// Most samples by which an actual position may lead its command: one where it is recorded at the
/// end of the servo period and the command at its start, and the lead that feedforward adds.
const LEAD_SAMPLES: f64 = 2.0;
/// Part of the following error that a lead explains, where columns are swapped.
const EXPLAINED: f64 = 0.5;
/// Distance of the actual position to the command of another axis, relative to its own, below which
/// columns are mixed.
const NEARER: f64 = 0.5;
/// Least correlation of a position with its command.
const MIN_CORRELATION: f64 = 0.3;
/// Difference of command and actual position that can be no following error, mm: two zeros that
/// differ.
const OFFSET_MM: f64 = 1.0;
/// Steps up to which a servo model can be of use for control, mm: what such a model predicts is to
/// be good to micrometres.
const FINE_STEP_MM: f64 = 0.005;
/// Samples of which a median or a distribution is taken, at the most: long logs are not held twice.
const LOOKED_AT: usize = 200_000;
/// Part of the following error that a coarse step may have.
const COARSE_PART: f64 = 0.1;
/// Part of the time between samples by which an uneven clock may vary.
const UNEVEN_PART: f64 = 0.25;

/// The axes that move, screened, and those whose command stands still; findings are added.
pub(super) fn fit(
    axes: Vec<LogAxis>,
    clock: &Clock,
    findings: &mut Vec<LogFinding>,
) -> Result<[Vec<LogAxis>; 2], LogError> {
    let mut refusals = Vec::new();
    refusals.extend(too_short(clock));
    refusals.extend(too_slow(clock));
    let (mut moving, mut still) = (Vec::new(), Vec::new());
    for axis in axes {
        let [command, actual] = [&axis.command_mm, &axis.actual_mm].map(|values| range(values));
        if command <= STILL_MM && actual <= HELD_MM {
            findings.push(LogFinding::StandsStill {
                axis: axis.name.clone(),
            });
            still.push(axis);
        } else if command > LONGEST_MM {
            findings.push(LogFinding::Endless {
                axis: axis.name,
                range_mm: command,
            });
        } else {
            moving.push(axis);
        }
    }
    if moving.is_empty() {
        let hint = "record while the machine runs a program: feedwright excite writes one";
        refusals.push(Refusal::new(
            RefusalReason::Constant,
            "no axis moves in it",
            hint,
        ));
    }
    for axis in &mut moving {
        axis.step_mm = steps::step(&axis.actual_mm);
        refusals.extend(steps::too_coarse(axis));
        align(axis, findings);
    }
    for number in 0..moving.len() {
        let wrong = not_connected(&moving[number])
            .or_else(|| swapped(&moving[number], clock))
            .or_else(|| mixed(&moving, number));
        refusals.extend(wrong);
    }
    if !refusals.is_empty() {
        return Err(LogError::refused(refusals));
    }
    for axis in &mut moving {
        report(axis, clock, findings);
        axis.verdict = verdict(axis, clock);
    }
    Ok([moving, still])
}

fn range(values: &[f64]) -> f64 {
    let [low, high] = values
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &v| {
            [low.min(v), high.max(v)]
        });
    if high > low { high - low } else { 0.0 }
}

/// RMS of command minus actual position, mm.
fn following_mm(axis: &LogAxis) -> f64 {
    rms(axis
        .command_mm
        .iter()
        .zip(&axis.actual_mm)
        .map(|(command, actual)| command - actual))
}

fn too_short(clock: &Clock) -> Option<Refusal> {
    let samples = clock.time_s.len();
    let record_s = samples as f64 * clock.sample_time_s;
    (record_s < MIN_RECORD_S || samples < MIN_SAMPLES).then(|| {
        let record_s = to_four_digits(record_s);
        let message = format!(
            "it is too short: {samples} samples, {record_s} s; at least {MIN_SAMPLES} samples and {MIN_RECORD_S} s are needed"
        );
        Refusal::new(RefusalReason::TooShort, message, "record 20 s or more: feedwright excite writes a program for it")
    })
}

fn too_slow(clock: &Clock) -> Option<Refusal> {
    (clock.sample_time_s > MAX_SAMPLE_TIME_S).then(|| {
        let message = format!(
            "it is recorded too slowly: every {} ms ({} Hz); a servo model needs a sample every {} ms or less",
            to_four_digits(1e3 * clock.sample_time_s),
            to_four_digits(1.0 / clock.sample_time_s),
            1e3 * MAX_SAMPLE_TIME_S
        );
        let hint = "record at the servo period, within the control: halsampler or halscope of LinuxCNC, the trace of the drive";
        Refusal::new(RefusalReason::TooSlow, message, hint)
    })
}

/// Two zeros that differ are no following error: the difference is taken out.
fn align(axis: &mut LogAxis, findings: &mut Vec<LogFinding>) {
    let stride = axis.command_mm.len().div_ceil(LOOKED_AT).max(1);
    let pairs = axis.command_mm.iter().zip(&axis.actual_mm).step_by(stride);
    let mut errors: Vec<f64> = pairs.map(|(command, actual)| command - actual).collect();
    let spread = range(&errors);
    let middle = errors.len() / 2;
    if errors.is_empty() {
        return;
    }
    let offset_mm = *errors.select_nth_unstable_by(middle, f64::total_cmp).1;
    if offset_mm.abs() > OFFSET_MM && offset_mm.abs() > 2.0 * spread {
        axis.actual_mm
            .iter_mut()
            .for_each(|actual| *actual += offset_mm);
        findings.push(LogFinding::Offset {
            axis: axis.name.clone(),
            offset_mm,
        });
    }
}

/// The actual position is constant, or the command itself.
fn not_connected(axis: &LogAxis) -> Option<Refusal> {
    let refusal = |what: String| {
        let message = format!(
            "the feedback of {} is not connected: its actual position {what}",
            axis.name
        );
        let hint = "record the measured position, such as the encoder's count times its scale, joint.N.motor-pos-fb of LinuxCNC";
        Some(Refusal::new(
            RefusalReason::FeedbackNotConnected,
            message,
            hint,
        ))
    };
    let (command, actual) = (&axis.command_mm, &axis.actual_mm);
    if range(actual) <= STILL_MM {
        return refusal(format!(
            "stays at {} mm while the command moves",
            actual.first().copied().unwrap_or(0.0)
        ));
    }
    (0..=COPY_SAMPLES).find_map(|late| {
        let pairs = || {
            (late.max(1)..command.len())
                .filter(|&k| command[k - late] != command[k - late.max(1)] || late > 0)
        };
        let moving = pairs().filter(|&k| command[k] != command[k - 1]);
        let (mut all, mut equal) = (0_usize, 0_usize);
        for k in moving {
            all += 1;
            equal += usize::from(actual[k] == command[k - late]);
        }
        let is_copy = all > 0 && equal as f64 > COPY_PART * all as f64;
        let late_by = if late == 0 {
            String::new()
        } else {
            format!(", {late} samples late")
        };
        if is_copy {
            refusal(format!("is the command itself{late_by}"))
        } else {
            None
        }
    })
}

/// The actual position leads the command.
fn swapped(axis: &LogAxis, clock: &Clock) -> Option<Refusal> {
    let lead = -delay_samples(&axis.command_mm, &axis.actual_mm);
    if lead < LEAD_SAMPLES {
        return None;
    }
    let (command, actual) = (&axis.command_mm, &axis.actual_mm);
    let left = |k: usize| {
        command[k] - actual[k]
            + lead * 0.25 * (command[k + 1] + actual[k + 1] - command[k - 1] - actual[k - 1])
    };
    let inner = 1..command.len().saturating_sub(1);
    let (all, rest) = (
        rms(inner.clone().map(|k| command[k] - actual[k])),
        rms(inner.map(left)),
    );
    (rest * rest < (1.0 - EXPLAINED) * all * all).then(|| {
        let lead_ms = to_four_digits(1e3 * lead * clock.sample_time_s);
        let message = format!(
            "the actual position of {} leads its command by {lead_ms} ms: the columns are swapped",
            axis.name
        );
        let hint = format!("exchange {0}.cmd and {0}.act in --columns", axis.name);
        Refusal::new(RefusalReason::Swapped, message, hint)
    })
}

/// Refuses an axis whose actual position follows the command of another axis, or does not follow
/// its own command.
fn mixed(axes: &[LogAxis], number: usize) -> Option<Refusal> {
    let axis = &axes[number];
    let stride = axis.actual_mm.len().div_ceil(50_000).max(1);
    let distance = |command: &[f64]| {
        let errors = || {
            command
                .iter()
                .zip(&axis.actual_mm)
                .step_by(stride)
                .map(|(c, a)| c - a)
        };
        let mean = errors().sum::<f64>() / errors().count().max(1) as f64;
        rms(errors().map(|error| error - mean))
    };
    let own_mm = distance(&axis.command_mm);
    let hint = "check the columns, or say which is which with --columns";
    for other in axes
        .iter()
        .enumerate()
        .filter(|(i, _)| *i != number)
        .map(|(_, axis)| axis)
    {
        let other_mm = distance(&other.command_mm);
        if other_mm < NEARER * own_mm {
            let message = format!(
                "the actual position of {} follows the command of {}: {} um RMS beside it, {} um beside its own",
                axis.name,
                other.name,
                to_four_digits(1e3 * other_mm),
                to_four_digits(1e3 * own_mm)
            );
            return Some(Refusal::new(RefusalReason::Mixed, message, hint));
        }
    }
    let correlation = correlation(&axis.command_mm, &axis.actual_mm);
    (correlation < MIN_CORRELATION).then(|| {
        let message = format!(
            "the actual position of {} does not follow its command: their correlation is {correlation:.2}, at least {MIN_CORRELATION} is needed",
            axis.name
        );
        Refusal::new(RefusalReason::Mixed, message, hint)
    })
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let count = a.len().max(1) as f64;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / count;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let (mut product, mut square_a, mut square_b) = (0.0, 0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        product += (a - mean_a) * (b - mean_b);
        square_a += (a - mean_a).powi(2);
        square_b += (b - mean_b).powi(2);
    }
    let scale = f64::sqrt(square_a * square_b);
    if scale > 0.0 { product / scale } else { 0.0 }
}

/// Reports the findings about an accepted axis.
fn report(axis: &LogAxis, clock: &Clock, findings: &mut Vec<LogFinding>) {
    let name = || axis.name.clone();
    let following_um = 1e3 * following_mm(axis);
    let delay_s = delay_samples(&axis.command_mm, &axis.actual_mm) * clock.sample_time_s;
    findings.push(LogFinding::Following {
        axis: name(),
        following_um,
        delay_s,
    });
    if axis.step_mm > 0.0 {
        findings.push(LogFinding::Steps {
            axis: name(),
            step_um: 1e3 * axis.step_mm,
        });
    }
    findings.extend(limits::torque(axis, clock));
    findings.extend(limits::speed(axis, clock));
    findings.extend(lines::of_axis(axis, clock));
}

/// Decides if a model of the axis can be used for control.
fn verdict(axis: &LogAxis, clock: &Clock) -> Fitness {
    let mut reasons = Vec::new();
    let following_mm = following_mm(axis);
    if axis.step_mm > FINE_STEP_MM && axis.step_mm > COARSE_PART * following_mm {
        reasons.push(format!(
            "its position comes in steps of {} um, where the following error is {} um RMS",
            to_four_digits(1e3 * axis.step_mm),
            to_four_digits(1e3 * following_mm)
        ));
    }
    if let Some([shortest_s, longest_s]) = clock.uneven_s
        && longest_s - shortest_s > UNEVEN_PART * clock.sample_time_s
    {
        let [shortest, longest] = [shortest_s, longest_s].map(|s| to_four_digits(1e3 * s));
        reasons.push(format!(
            "the time between samples varies from {shortest} to {longest} ms"
        ));
    }
    if reasons.is_empty() {
        Fitness::ForControl
    } else {
        Fitness::NotForControl {
            reason: reasons.join(", and "),
        }
    }
}
