//! The axes of a log in millimetres.

use std::path::Path;

use feedwright_sim::to_four_digits;

use super::clock::Clock;
use super::columns::Columns;
use super::error::{LogError, Refusal, RefusalReason};
use super::finding::LogFinding;
use super::roles::{AxisRoles, Roles};
use super::table::LogTable;
use super::units::PositionUnit;
use super::{Fitness, LogAxis};

/// The axes of a table.
pub(super) fn of_table(
    path: &Path,
    table: &mut LogTable,
    roles: &Roles,
    columns: &Columns,
    clock: &Clock,
    findings: &mut Vec<LogFinding>,
) -> Result<Vec<LogAxis>, LogError> {
    for axis in &roles.axes {
        let lag = axis.lag.as_ref().map(|(column, _)| ("following error", *column));
        for (what, column) in [("command", axis.command), ("actual position", axis.actual)].into_iter().chain(lag) {
            if let Some((row, text)) = &table.columns[column].not_a_number {
                let shown = if text.is_empty() { "nothing" } else { text };
                let message = format!("the {what} of {} is no number at {}: {shown}", axis.name, table.place(*row));
                let hint = "take these lines out, or record without them";
                return Err(LogError::refused(path, Refusal::new(RefusalReason::NotANumber, message, hint)));
            }
        }
    }
    let unit = unit(path, table, roles, columns, clock, findings)?;
    let scale = unit.in_mm();
    let uses = |column: usize| roles.axes.iter().flat_map(AxisRoles::columns).filter(|&used| used == column).count();
    let shared: Vec<bool> = (0..table.columns.len()).map(|column| uses(column) > 1).collect();
    let mut take = |column: usize, scale: f64| {
        let values = &mut table.columns[column].values;
        let mut values = if shared[column] { values.clone() } else { std::mem::take(values) };
        if scale != 1.0 {
            values.iter_mut().for_each(|value| *value *= scale);
        }
        values
    };
    let mut command = |axis: &AxisRoles| {
        let mut command_mm = take(axis.command, scale);
        if let Some((lag, unit)) = &axis.lag {
            let scale =
                columns.position_unit.or_else(|| PositionUnit::from_name(unit)).map_or(scale, PositionUnit::in_mm);
            command_mm.iter_mut().zip(take(*lag, scale)).for_each(|(command, lag)| *command += lag);
        }
        command_mm
    };
    let commands: Vec<Vec<f64>> = roles.axes.iter().map(&mut command).collect();
    let axes = roles.axes.iter().zip(commands).map(|(axis, command_mm)| LogAxis {
        name: axis.name.clone(),
        command_mm,
        actual_mm: take(axis.actual, scale),
        torque: axis.torque.map(|column| take(column, 1.0)),
        torque_unit: axis.torque_unit,
        step_mm: 0.0,
        verdict: Fitness::ForControl,
    });
    Ok(axes.collect())
}

/// Range and highest speed of a command, in its unit and s.
fn way(values: &[f64], clock: &Clock) -> (f64, f64) {
    let [low, high] = values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &v| [a.min(v), b.max(v)]);
    let mut step = 0.0_f64;
    for stretch in &clock.stretches {
        step = values[stretch.clone()].windows(2).fold(step, |step, pair| step.max((pair[1] - pair[0]).abs()));
    }
    (high - low, step / clock.sample_time_s)
}

/// The unit of the positions: as said, as the file says, or by their size. Fails where two of them differ.
fn unit(
    path: &Path,
    table: &LogTable,
    roles: &Roles,
    columns: &Columns,
    clock: &Clock,
    findings: &mut Vec<LogFinding>,
) -> Result<PositionUnit, LogError> {
    let stated = table.position_unit.as_deref().and_then(PositionUnit::from_name);
    match (columns.position_unit, stated) {
        (Some(said), Some(stated)) if said != stated => {
            let message =
                format!("--columns says that positions are in {said}, and the file that they are in {stated}");
            return Err(LogError::columns(
                path,
                message,
                "leave unit= out, or correct the line '# unit = ...' of the file",
            ));
        }
        (Some(said), _) => return Ok(said),
        (None, Some(unit)) => {
            findings.push(LogFinding::PositionUnit { unit, because: "a line of the file says so".to_owned() });
            return Ok(unit);
        }
        (None, None) => {}
    }
    if let Some(unit) = roles.axes.iter().find_map(|axis| PositionUnit::from_name(&axis.unit)) {
        findings.push(LogFinding::PositionUnit { unit, because: "the column says so".to_owned() });
        return Ok(unit);
    }
    // Range and highest speed of each command; the axis in the middle counts, as one may be a spindle that turns and turns.
    let mut ways: Vec<(f64, f64)> = roles
        .axes
        .iter()
        .map(|axis| way(&table.columns[axis.command].values, clock))
        .filter(|way| way.0 > 0.0)
        .collect();
    ways.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (range, speed) = ways.get(ways.len().saturating_sub(1) / 2).copied().unwrap_or_default();
    // Machines move by some millimetres at least and some metres at most, at some millimetres to a metre a second.
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
    Ok(unit)
}
