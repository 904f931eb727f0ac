//! The axes of a log in millimetres.

use feedwright_sim::to_four_digits;

use super::clock::Clock;
use super::columns::Columns;
use super::error::{LogError, Refusal, RefusalReason};
use super::finding::LogFinding;
use super::roles::{AxisRoles, Roles};
use super::table::LogTable;
use super::units::{PositionUnit, is_unstated};
use super::{Fitness, LogAxis};

/// The axes of a table.
pub(super) fn of_table(
    table: &mut LogTable,
    roles: &Roles,
    columns: &Columns,
    clock: &Clock,
    findings: &mut Vec<LogFinding>,
) -> Result<Vec<LogAxis>, LogError> {
    for axis in &roles.axes {
        let lag = axis.lag.map(|column| ("following error", column));
        for (what, column) in [("command", axis.command), ("actual position", axis.actual)]
            .into_iter()
            .chain(lag)
        {
            if let Some((row, text)) = &table.columns[column].not_a_number {
                let shown = if text.is_empty() { "nothing" } else { text };
                let message = format!(
                    "the {what} of {} is no number at {}: {shown}",
                    axis.name,
                    table.place(*row)
                );
                let hint = "take these lines out, or record without them";
                return Err(LogError::refused([Refusal::new(
                    RefusalReason::NotANumber,
                    message,
                    hint,
                )]));
            }
        }
    }
    let units = units(table, roles, columns, clock, findings)?;
    let uses = |column: usize| {
        roles
            .axes
            .iter()
            .flat_map(AxisRoles::columns)
            .filter(|&used| used == column)
            .count()
    };
    let shared: Vec<bool> = (0..table.columns.len())
        .map(|column| uses(column) > 1)
        .collect();
    let mut take = |column: usize, scale: f64| {
        let values = &mut table.columns[column].values;
        let mut values = if shared[column] {
            values.clone()
        } else {
            std::mem::take(values)
        };
        if scale != 1.0 {
            values.iter_mut().for_each(|value| *value *= scale);
        }
        values
    };
    let mut command = |(axis, units): (&AxisRoles, &AxisUnits)| {
        let mut command_mm = take(axis.command, units.command.in_mm());
        if let Some(lag) = axis.lag {
            command_mm
                .iter_mut()
                .zip(take(lag, units.lag.in_mm()))
                .for_each(|(command, lag)| *command += lag);
        }
        command_mm
    };
    let commands: Vec<Vec<f64>> = roles.axes.iter().zip(&units).map(&mut command).collect();
    let axes = roles
        .axes
        .iter()
        .zip(&units)
        .zip(commands)
        .map(|((axis, units), command_mm)| LogAxis {
            name: axis.name.clone(),
            command_mm,
            actual_mm: take(axis.actual, units.actual.in_mm()),
            torque: axis.torque.map(|column| take(column, axis.torque_scale)),
            torque_unit: axis.torque_unit,
            step_mm: 0.0,
            verdict: Fitness::ForControl,
        });
    Ok(axes.collect())
}

/// Units of the positions of an axis.
#[derive(Debug, Clone, Copy)]
struct AxisUnits {
    command: PositionUnit,
    actual: PositionUnit,
    lag: PositionUnit,
}

/// Range and highest speed of a command, in its unit and s.
fn way(values: &[f64], clock: &Clock) -> (f64, f64) {
    let [low, high] = values
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &v| {
            [a.min(v), b.max(v)]
        });
    let mut step = 0.0_f64;
    for stretch in &clock.stretches {
        step = values[stretch.clone()]
            .windows(2)
            .fold(step, |step, pair| step.max((pair[1] - pair[0]).abs()));
    }
    (high - low, step / clock.sample_time_s)
}

/// Units of the positions of each axis: as said, as the file says, or by their size. Fails where
/// two statements differ, and where a unit is not known.
fn units(
    table: &LogTable,
    roles: &Roles,
    columns: &Columns,
    clock: &Clock,
    findings: &mut Vec<LogFinding>,
) -> Result<Vec<AxisUnits>, LogError> {
    let everywhere = of_file(table, columns)?;
    if let Some(unit) = columns.position_unit {
        return Ok(vec![
            AxisUnits {
                command: unit,
                actual: unit,
                lag: unit
            };
            roles.axes.len()
        ]);
    }
    let mut written = vec![];
    for axis in &roles.axes {
        let [command, actual] = [
            of_column(table, roles, axis.command)?,
            of_column(table, roles, axis.actual)?,
        ];
        let lag = axis
            .lag
            .map_or(Ok(None), |lag| of_column(table, roles, lag))?;
        // Where one column of an axis has no unit, it has the unit of the other.
        written.push([command.or(actual), actual.or(command), lag]);
    }
    let positions = || {
        written
            .iter()
            .flat_map(|[command, actual, _]| [command, actual].into_iter().copied().flatten())
    };
    if let (Some(stated), Some(other)) = (
        everywhere,
        positions().find(|unit| Some(*unit) != everywhere),
    ) {
        let message = format!(
            "a line of the file says that positions are in {stated}, and a column that it is in {other}"
        );
        let hint = "correct one of the two, or say which is right with --columns unit=...";
        return Err(LogError::columns(message, hint));
    }
    let mut found: Vec<PositionUnit> = vec![];
    positions().for_each(|unit| {
        if !found.contains(&unit) {
            found.push(unit);
        }
    });
    let mut decided = |unit: PositionUnit, because: &str| {
        findings.push(LogFinding::PositionUnit {
            unit,
            because: because.to_owned(),
        });
    };
    let otherwise = match (everywhere, &found[..]) {
        (Some(unit), _) => {
            decided(unit, "a line of the file says so");
            unit
        }
        (None, [unit]) => {
            decided(*unit, "the column says so");
            *unit
        }
        (None, [first, ..]) => {
            found
                .iter()
                .for_each(|unit| decided(*unit, "some columns say so"));
            *first
        }
        (None, []) => by_size(table, roles, clock, findings),
    };
    let of_axis = |[command, actual, lag]: [Option<PositionUnit>; 3]| {
        let [command, actual] = [command, actual].map(|unit| unit.unwrap_or(otherwise));
        AxisUnits {
            command,
            actual,
            lag: lag.unwrap_or(actual),
        }
    };
    Ok(written.into_iter().map(of_axis).collect())
}

/// The unit that a line of the file states for all positions.
fn of_file(table: &LogTable, columns: &Columns) -> Result<Option<PositionUnit>, LogError> {
    let Some((line, text)) = &table.position_unit else {
        return Ok(None);
    };
    match (columns.position_unit, PositionUnit::from_name(text)) {
        (Some(said), Some(stated)) if said != stated => {
            let message = format!(
                "--columns says that positions are in {said}, and the file that they are in {stated}"
            );
            let hint = "leave unit= out, or correct the line '# unit = ...' of the file";
            Err(LogError::columns(message, hint))
        }
        (None, None) => {
            let message = format!(
                "positions are in '{text}', a unit of length that is not known: {}",
                PositionUnit::KNOWN
            );
            Err(LogError::format(Some(*line), message, UNKNOWN_UNIT))
        }
        (_, stated) => Ok(stated),
    }
}

/// Advice about a unit of length that is not known.
const UNKNOWN_UNIT: &str = "convert the positions to one of these; or, if they are in one of them, say which: --columns unit=mm";

/// The unit that is written above a column; none where nothing is.
fn of_column(
    table: &LogTable,
    roles: &Roles,
    column: usize,
) -> Result<Option<PositionUnit>, LogError> {
    let text = roles.units.get(column).map_or("", String::as_str);
    let unit = PositionUnit::from_name(text);
    if unit.is_none() && !is_unstated(text) {
        let message = format!(
            "the positions in column {} are in '{text}', a unit of length that is not known: {}",
            table.label(column),
            PositionUnit::KNOWN
        );
        return Err(LogError::columns(message, UNKNOWN_UNIT));
    }
    Ok(unit)
}

/// The unit of positions by their size.
fn by_size(
    table: &LogTable,
    roles: &Roles,
    clock: &Clock,
    findings: &mut Vec<LogFinding>,
) -> PositionUnit {
    // Range and highest speed of each command; the axis in the middle counts, as one may be a
    // spindle that turns and turns.
    let mut ways: Vec<(f64, f64)> = roles
        .axes
        .iter()
        .map(|axis| way(&table.columns[axis.command].values, clock))
        .filter(|way| way.0 > 0.0)
        .collect();
    ways.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (range, speed) = ways
        .get(ways.len().saturating_sub(1) / 2)
        .copied()
        .unwrap_or_default();
    // Machines move by some millimetres at least and some metres at most, at some millimetres to a
    // metre a second.
    let unit = match (range, speed) {
        _ if range < 2.0 && speed < 2.0 => PositionUnit::Metre,
        _ if range > 5e3 && speed > 5e3 => PositionUnit::Micrometre,
        _ => PositionUnit::Millimetre,
    };
    let (range, speed) = (to_four_digits(range), to_four_digits(speed));
    let because = format!(
        "guessed, as the command goes over {range} at up to {speed} a second; hint: --columns unit=mm or m, um, inch says it"
    );
    findings.push(LogFinding::PositionUnit { unit, because });
    unit
}
