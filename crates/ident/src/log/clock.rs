//! The clock of a log: time between samples, and stretches without gaps.

use std::ops::Range;

use feedwright_sim::{rounded, to_four_digits};

use super::columns::Columns;
use super::error::{LogError, Refusal, RefusalReason};
use super::finding::LogFinding;
use super::roles::{AxisRoles, Roles, TimeColumn};
use super::table::LogTable;
use super::units::{PositionUnit, TimeUnit, is_unstated, speed_unit};
use crate::average::middle_of;

/// Sample times of a log.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Clock {
    pub(super) sample_time_s: f64,
    pub(super) stretches: Vec<Range<usize>>,
    pub(super) time_s: Vec<f64>,
    /// Shortest and longest time between samples, s, where the clock is uneven.
    pub(super) uneven_s: Option<[f64; 2]>,
}

/// Servo period, s, assumed when neither the file, the options nor a recorded speed gives it:
/// LinuxCNC's default.
const USUAL_SERVO_S: f64 = 1e-3;
/// Samples are missing where a step exceeds this many times the usual step.
const GAP_STEPS: f64 = 1.5;
/// The same where the clock is uneven anyway.
const UNEVEN_GAP_STEPS: f64 = 3.0;
/// Part of the usual step by which steps differ on an even clock.
const EVEN: f64 = 0.1;
/// Number of gaps that are reported one by one.
const GAPS_REPORTED: usize = 5;

/// The clock of a table.
pub(super) fn of_table(
    table: &mut LogTable,
    roles: &Roles,
    columns: &Columns,
    findings: &mut Vec<LogFinding>,
) -> Result<Clock, LogError> {
    let Some(time) = &roles.time else {
        return without_column(table, roles, columns, findings);
    };
    let column = &mut table.columns[time.column];
    if let Some((row, text)) = column.not_a_number.clone() {
        return Err(no_number(format!(
            "the time is no number at {}: '{text}'",
            table.place(row)
        )));
    }
    let mut values = std::mem::take(&mut column.values);
    if let Some(row) = (1..values.len()).find(|&row| values[row] <= values[row - 1]) {
        return Err(backward(table, row, [values[row - 1], values[row]]));
    }
    if let (Some(first), Some(last)) = (values.first(), values.last())
        && !(last - first).is_finite()
    {
        let row = values
            .iter()
            .position(|value| !value.is_finite())
            .unwrap_or(values.len() - 1);
        let place = table.place(row);
        return Err(no_number(format!(
            "the time is beyond every clock at {place}: {:e}",
            values[row]
        )));
    }
    let step = median_step(&values);
    let unit = unit(time, columns, table, step, findings)?;
    let sample_s = match unit {
        TimeUnit::Sample => counted(table, roles, columns, step, findings),
        _ => 1.0,
    };
    let scale = unit.in_s(sample_s);
    let first = if unit == TimeUnit::Sample {
        values.first().copied().unwrap_or(0.0)
    } else {
        0.0
    };
    values
        .iter_mut()
        .for_each(|value| *value = (*value - first) * scale);
    Ok(stretches(values, step * scale, &table.breaks, findings))
}

fn no_number(message: String) -> LogError {
    let hint = "take the line out, or name another column of the time with --columns t=COLUMN";
    LogError::refused([Refusal::new(RefusalReason::NotANumber, message, hint)])
}

fn backward(table: &LogTable, row: usize, values: [f64; 2]) -> LogError {
    let [before, now] = values;
    let how = if now < before {
        "runs backward"
    } else {
        "stands still"
    };
    let message = format!(
        "the time {how} at {}: {now} behind {before}",
        table.place(row)
    );
    let hint = if now < before {
        "a log is one recording in one go; where several stand in a file, make a file of each"
    } else {
        "the time is recorded too coarsely: record a sample counter (halsampler -t), or leave the column out and say \
         --columns period_s=..."
    };
    LogError::refused([Refusal::new(RefusalReason::Backward, message, hint)])
}

/// The median of the steps; of long columns of a part of them.
fn median_step(values: &[f64]) -> f64 {
    const STEPS: usize = 100_000;
    let stride = values.len().div_ceil(STEPS).max(1);
    let mut steps: Vec<f64> = values
        .windows(2)
        .step_by(stride)
        .map(|pair| pair[1] - pair[0])
        .collect();
    middle_of(&mut steps)
}

/// The unit of the time column. Fails where the file has one that is not known.
fn unit(
    time: &TimeColumn,
    columns: &Columns,
    table: &LogTable,
    step: f64,
    findings: &mut Vec<LogFinding>,
) -> Result<TimeUnit, LogError> {
    let mut decided = |unit: TimeUnit, because: String| {
        findings.push(LogFinding::TimeUnit { unit, because });
        Ok(unit)
    };
    if let Some(unit) = columns.time_unit {
        return Ok(unit);
    }
    let stated =
        TimeUnit::from_name(&time.unit).filter(|unit| !(time.counts && *unit == TimeUnit::Sample));
    if (time.counts && stated.is_none()) || columns.sample_time_s.is_some() {
        return decided(
            TimeUnit::Sample,
            format!("column {} counts them", table.label(time.column)),
        );
    }
    if let Some(unit) = stated {
        return decided(unit, "the column says so".to_owned());
    }
    if !is_unstated(&time.unit) {
        let (label, known) = (table.label(time.column), TimeUnit::KNOWN);
        let message = format!(
            "the time in column {label} is in '{}', a unit of time that is not known: {known}",
            time.unit
        );
        let hint = "convert the time to one of these; or, if it is in one of them, say which: --columns time=ms";
        return Err(LogError::columns(message, hint));
    }
    let unit = match step {
        // 2 Hz and more, in seconds; 17 Hz and more, in the others.
        _ if step < 0.5 => TimeUnit::Second,
        _ if step < 60.0 => TimeUnit::Millisecond,
        _ if step < 6e4 => TimeUnit::Microsecond,
        _ => TimeUnit::Nanosecond,
    };
    let step_shown = to_four_digits(step);
    decided(
        unit,
        format!(
            "guessed, as steps are {step_shown}; hint: --columns time=s or ms, us, ns, samples says it"
        ),
    )
}

/// Time for which one count of a sample counter stands, s.
fn counted(
    table: &LogTable,
    roles: &Roles,
    columns: &Columns,
    step: f64,
    findings: &mut Vec<LogFinding>,
) -> f64 {
    if let Some(sample_time_s) = columns.sample_time_s.or(table.sample_time_s) {
        return sample_time_s;
    }
    if let Some((axis, sample_s)) = roles
        .axes
        .iter()
        .find_map(|axis| Some((axis, from_speed(table, roles, axis)?)))
    {
        let because = format!(
            "the speed of {} fits the change of its position so",
            axis.name
        );
        findings.push(LogFinding::SampleTime {
            sample_time_s: sample_s,
            because,
        });
        return sample_s / step;
    }
    let because =
        "guessed, as usual for a servo; hint: --columns period_s=0.001 says it".to_owned();
    findings.push(LogFinding::SampleTime {
        sample_time_s: USUAL_SERVO_S,
        because,
    });
    USUAL_SERVO_S
}

/// The time between samples that makes a recorded speed the change of the position: `sum of dp v /
/// sum of v^2`, v the mean speed between two samples. None where the two do not belong together,
/// and where the unit of the speed is not known.
fn from_speed(table: &LogTable, roles: &Roles, axis: &AxisRoles) -> Option<f64> {
    let velocity = axis.velocity?;
    let [position, speed] = [axis.actual, velocity].map(|column| &table.columns[column].values);
    let scale = speed_scale(
        [axis.actual, velocity].map(|column| roles.units.get(column).map_or("", String::as_str)),
    )?;
    let (mut products, mut speeds, mut changes) = (0.0, 0.0, 0.0);
    for k in 1..position.len().min(speed.len()) {
        let change = position[k] - position[k - 1];
        let mean = 0.5 * (speed[k] + speed[k - 1]);
        if change.is_finite() && mean.is_finite() {
            products += change * mean;
            speeds += mean * mean;
            changes += change * change;
        }
    }
    let correlation = products / (speeds * changes).sqrt();
    // To two digits: the positions are in steps, the speeds filtered.
    (correlation > 0.9).then(|| rounded(products / speeds * scale, 2))
}

/// Time in which a number of a speed column moves the axis by a number of its position column, s,
/// by their units. A speed without one is in positions a second.
fn speed_scale([position, speed]: [&str; 2]) -> Option<f64> {
    if is_unstated(speed) {
        return Some(1.0);
    }
    let (length, per_s) = speed_unit(speed)?;
    let position = PositionUnit::from_name(position).unwrap_or(length);
    Some(position.in_mm() / (length.in_mm() * per_s))
}

/// Evenly, where there is no column of the time.
fn without_column(
    table: &LogTable,
    roles: &Roles,
    columns: &Columns,
    findings: &mut Vec<LogFinding>,
) -> Result<Clock, LogError> {
    let known = columns.sample_time_s.or(table.sample_time_s);
    let from_speed = || {
        roles.axes.iter().find_map(|axis| {
            let sample_time_s = from_speed(table, roles, axis)?;
            let because = format!(
                "the speed of {} fits the change of its position so",
                axis.name
            );
            Some(LogFinding::SampleTime {
                sample_time_s,
                because,
            })
        })
    };
    let sample_time_s = match (known, from_speed()) {
        (Some(known), _) => known,
        (None, Some(finding)) => {
            let LogFinding::SampleTime { sample_time_s, .. } = finding else {
                return Err(no_time());
            };
            findings.push(finding);
            sample_time_s
        }
        (None, None) => return Err(no_time()),
    };
    let mut time_s: Vec<f64> = (0..table.rows())
        .map(|row| row as f64 * sample_time_s)
        .collect();
    // How much is missing is not known: one sample.
    let mut late = 0;
    let mut breaks = table.breaks.iter().filter(|&&at| at > 0).peekable();
    for (row, time_s) in time_s.iter_mut().enumerate() {
        while breaks.next_if(|&&at| at <= row).is_some() {
            late += 1;
        }
        *time_s += late as f64 * sample_time_s;
    }
    Ok(stretches(time_s, sample_time_s, &table.breaks, findings))
}

fn no_time() -> LogError {
    let message = "no column is the time, and nothing states the time between samples";
    LogError::columns(
        message,
        "say which column is the time with --columns t=0, or what is between samples: --columns period_s=0.001",
    )
}

/// The stretches between gaps, and what is usual within them.
fn stretches(
    time_s: Vec<f64>,
    step_s: f64,
    breaks: &[usize],
    findings: &mut Vec<LogFinding>,
) -> Clock {
    let steps = || time_s.windows(2).map(|pair| pair[1] - pair[0]);
    let uneven = steps()
        .filter(|step| (step - step_s).abs() > EVEN * step_s && *step < UNEVEN_GAP_STEPS * step_s)
        .count();
    let is_uneven = uneven as f64 > 0.01 * time_s.len() as f64;
    let gap_s = step_s
        * if is_uneven {
            UNEVEN_GAP_STEPS
        } else {
            GAP_STEPS
        };
    let mut stretches = Vec::new();
    let mut start = 0;
    for row in 1..time_s.len() {
        if time_s[row] - time_s[row - 1] >= gap_s || breaks.binary_search(&row).is_ok() {
            stretches.push(start..row);
            start = row;
        }
    }
    stretches.push(start..time_s.len());
    let (mut within_s, mut within, mut range_s) = (0.0, 0_usize, [f64::INFINITY, 0.0_f64]);
    for stretch in &stretches {
        within_s += time_s
            .get(stretch.end.wrapping_sub(1))
            .map_or(0.0, |end_s| end_s - time_s[stretch.start]);
        within += stretch.len().saturating_sub(1);
        for pair in time_s[stretch.clone()].windows(2) {
            let step = pair[1] - pair[0];
            range_s = [range_s[0].min(step), range_s[1].max(step)];
        }
    }
    // Rounded to nine digits, within which no clock is known.
    let mean_s = if within > 0 {
        within_s / within as f64
    } else {
        step_s
    };
    let sample_time_s = format!("{mean_s:.8e}").parse().unwrap_or(mean_s);
    if is_uneven {
        findings.push(LogFinding::UnevenClock {
            range_s,
            taken_s: sample_time_s,
        });
    }
    for pair in stretches.windows(2).take(GAPS_REPORTED) {
        findings.push(LogFinding::Gap {
            from_s: time_s[pair[0].end - 1],
            to_s: time_s[pair[1].start],
        });
    }
    if stretches.len() > GAPS_REPORTED + 1 {
        findings.push(LogFinding::MoreGaps {
            count: stretches.len() - 1 - GAPS_REPORTED,
        });
    }
    Clock {
        sample_time_s,
        stretches,
        time_s,
        uneven_s: is_uneven.then_some(range_s),
    }
}
