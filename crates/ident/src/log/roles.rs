//! Which column is what: as `--columns` says, else by the names, else by the data.

use feedwright_gcode::suggestion::nearest;
use feedwright_sim::to_four_digits;

use super::columns::{AxisChoice, ColumnChoice, Columns};
use super::error::LogError;
use super::finding::LogFinding;
use super::names::{Meaning, Quantity, is_spindle, understand};
use super::pairs;
use super::table::LogTable;
use super::units::is_unstated;
use super::{LogFormat, MAX_AXES, TorqueUnit};

/// Roles of the columns.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Roles {
    pub(super) time: Option<TimeColumn>,
    pub(super) axes: Vec<AxisRoles>,
    /// Unit of each column, as the file has it.
    pub(super) units: Vec<String>,
}

/// The column of the time.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TimeColumn {
    pub(super) column: usize,
    /// It counts samples.
    pub(super) counts: bool,
    /// Its unit, as the file has it.
    pub(super) unit: String,
}

/// The columns of an axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct AxisRoles {
    pub(super) name: String,
    /// The command; the actual position too, where `lag` is to be added to it.
    pub(super) command: usize,
    pub(super) actual: usize,
    /// Command minus actual position, where the file has no command.
    pub(super) lag: Option<usize>,
    pub(super) torque: Option<usize>,
    pub(super) torque_unit: TorqueUnit,
    /// Torque for a number of its column, in that unit.
    pub(super) torque_scale: f64,
    /// Measured speed, from which the time between samples can be computed.
    pub(super) velocity: Option<usize>,
}

impl AxisRoles {
    /// Returns the role of a column in the axis, if it has one.
    fn role_of(&self, column: usize) -> Option<&'static str> {
        let command = Some(self.command).filter(|_| self.lag.is_none());
        let roles = [
            ("command", command),
            ("actual position", Some(self.actual)),
            ("following error", self.lag),
            ("torque", self.torque),
        ];
        roles
            .into_iter()
            .find_map(|(role, of)| (of == Some(column)).then_some(role))
    }

    pub(super) fn columns(&self) -> impl Iterator<Item = usize> {
        [
            Some(self.command),
            Some(self.actual),
            self.lag,
            self.torque,
            self.velocity,
        ]
        .into_iter()
        .flatten()
    }
}

/// Sample times that differ by less, as a fraction, are the same: headers round them.
const SAME_RATE: f64 = 1e-3;
/// Names of axes that have none.
const NAMES: [&str; MAX_AXES] = ["x", "y", "z", "a", "b", "c", "u", "v", "w"];

/// Marks the columns that are needed to find the roles: all of them, where the data has to decide.
pub(super) fn needed(table: &LogTable, columns: &Columns) -> Vec<bool> {
    let meanings = meanings(table);
    let axes = match chosen(table, columns) {
        Ok(axes) if !axes.is_empty() => axes,
        _ => named(table, &meanings, &mut Vec::new()),
    };
    let time = time(table, columns, &meanings);
    let Ok(time) = time else {
        return vec![true; table.columns.len()];
    };
    if axes.is_empty() {
        return vec![true; table.columns.len()];
    }
    let wanted: Vec<usize> = axes
        .iter()
        .flat_map(AxisRoles::columns)
        .chain(time.map(|time| time.column))
        .collect();
    (0..table.columns.len())
        .map(|column| wanted.contains(&column))
        .collect()
}

/// The roles of the columns of a table that is read.
pub(super) fn find(
    table: &LogTable,
    columns: &Columns,
    findings: &mut Vec<LogFinding>,
) -> Result<Roles, LogError> {
    let fault = |message: String| LogError::columns(message, there_are(table));
    let meanings = meanings(table);
    let mut time = time(table, columns, &meanings).map_err(fault)?;
    let mut axes = chosen(table, columns).map_err(fault)?;
    not_the_time(table, time.as_ref(), &axes)?;
    let mut incomplete = Vec::new();
    let mut by_data = false;
    if axes.is_empty() {
        axes = named(table, &meanings, &mut incomplete);
    }
    if let (true, Some(hint)) = (axes.is_empty(), table.format.record()) {
        return Err(lacking(table, &incomplete, hint));
    }
    if axes.is_empty() {
        by_data = true;
        time = time.or_else(|| clock_like(table, &meanings));
        axes = by_likeness(table, time.as_ref());
    }
    if axes.is_empty() {
        return Err(fault(
            "no two columns are the command and the actual position of an axis".to_owned(),
        ));
    }
    axes.retain(|axis| {
        let by_name = !by_data && is_rotary_name(&axis.name);
        let is_rotary = columns.axes.is_empty() && (by_name || is_angle(&meanings, axis));
        if is_rotary {
            incomplete.push(LogFinding::Rotary {
                axis: axis.name.clone(),
            });
        }
        !is_rotary
    });
    if axes.is_empty() {
        return Err(fault(
            "all axes with command and actual position are rotary".to_owned(),
        ));
    }
    axes.truncate(MAX_AXES);
    at_one_rate(table, &axes)?;
    torques_are_known(table, &meanings, &axes)?;
    findings.extend(axes.iter().map(|axis| columns_of(table, axis, by_data)));
    findings.append(&mut incomplete);
    if by_data {
        let used: Vec<usize> = axes
            .iter()
            .flat_map(AxisRoles::columns)
            .chain(time.as_ref().map(|t| t.column))
            .collect();
        let unused: Vec<String> = (0..table.columns.len())
            .filter(|i| !used.contains(i))
            .map(|i| table.label(i))
            .collect();
        if !unused.is_empty() {
            findings.push(LogFinding::Unused { columns: unused });
        }
    }
    let units = meanings.into_iter().map(|meaning| meaning.unit).collect();
    Ok(Roles { time, axes, units })
}

/// Refuses a torque in a unit that is not known.
fn torques_are_known(
    table: &LogTable,
    meanings: &[Meaning],
    axes: &[AxisRoles],
) -> Result<(), LogError> {
    let mut torques = axes.iter().filter_map(|axis| axis.torque);
    let unknown = torques.find(|&at| {
        !is_unstated(&meanings[at].unit) && TorqueUnit::from_name(&meanings[at].unit).is_none()
    });
    let Some(at) = unknown else { return Ok(()) };
    let message = format!(
        "the torque in column {} is in '{}', a unit that is not known: {}",
        table.label(at),
        meanings[at].unit,
        TorqueUnit::KNOWN
    );
    let hint = "write one of these units above the column, or none and give --torque-gain; or leave the torque out with --columns x.cmd=COLUMN,x.act=COLUMN";
    Err(LogError::columns(message, hint))
}

/// Reports the columns of an axis.
fn columns_of(table: &LogTable, axis: &AxisRoles, by_data: bool) -> LogFinding {
    let command = table.label(axis.command);
    LogFinding::AxisColumns {
        axis: axis.name.clone(),
        command: match axis.lag {
            Some(lag) => format!("{command} + {}", table.label(lag)),
            None => command,
        },
        actual: table.label(axis.actual),
        torque: axis.torque.map(|column| table.label(column)),
        torque_unit: axis.torque_unit,
        by_data,
    }
}

/// A record of a scope in which no axis is complete.
fn lacking(table: &LogTable, incomplete: &[LogFinding], hint: &str) -> LogError {
    let lacks: Vec<String> = incomplete.iter().map(LogFinding::to_string).collect();
    let lacks = if lacks.is_empty() {
        "no channel is a position".to_owned()
    } else {
        lacks.join("; ")
    };
    let message = format!(
        "no axis of this {} record has command and actual position: {lacks}",
        table.format
    );
    LogError::columns(message, format!("{hint}; or {}", there_are(table)))
}

/// Refuses positions that are sampled at different rates.
fn at_one_rate(table: &LogTable, axes: &[AxisRoles]) -> Result<(), LogError> {
    let positions = axes
        .iter()
        .flat_map(|axis| [axis.command, axis.actual].into_iter().chain(axis.lag));
    let mut rates = positions.filter_map(|at| Some((at, table.columns.get(at)?.sample_time_s?)));
    let Some((first, first_s)) = rates.next() else {
        return Ok(());
    };
    match rates.find(|(_, sample_s)| (sample_s / first_s - 1.0).abs() > SAME_RATE) {
        None => Ok(()),
        Some((other, other_s)) => {
            let message = format!(
                "{} is sampled every {} ms, and {} every {} ms",
                table.label(first),
                to_four_digits(1e3 * first_s),
                table.label(other),
                to_four_digits(1e3 * other_s)
            );
            let hint = "record all positions with one sample time, or name the axes that have one with --columns";
            Err(LogError::columns(message, hint))
        }
    }
}

/// Refuses a column that is the time and belongs to an axis too.
fn not_the_time(
    table: &LogTable,
    time: Option<&TimeColumn>,
    axes: &[AxisRoles],
) -> Result<(), LogError> {
    let Some(column) = time.map(|time| time.column) else {
        return Ok(());
    };
    let taken = axes
        .iter()
        .find_map(|axis| Some((&axis.name, axis.role_of(column)?)));
    let Some((axis, role)) = taken else {
        return Ok(());
    };
    let message = format!(
        "column {} is both the time and the {role} of {axis}",
        table.label(column)
    );
    let hint = format!(
        "name another column for one of the two (the time is t=COLUMN); {}",
        there_are(table)
    );
    Err(LogError::columns(message, hint))
}

/// Returns true if the name of an axis says that it is rotary.
fn is_rotary_name(name: &str) -> bool {
    ["a", "b", "c"].contains(&name.trim_end_matches(|c: char| c.is_ascii_digit()))
}

/// Returns true if the unit of the positions of an axis is an angle.
fn is_angle(meanings: &[Meaning], axis: &AxisRoles) -> bool {
    let is_angle = |at: usize| {
        let unit = meanings[at].unit.to_lowercase();
        ["deg", "degree", "degrees", "\u{b0}", "rad"].contains(&unit.as_str())
    };
    is_angle(axis.command) || is_angle(axis.actual)
}

/// Lists the columns, and explains how to assign them.
fn there_are(table: &LogTable) -> String {
    const SHOWN: usize = 30;
    let mut labels: Vec<String> = (0..table.columns.len().min(SHOWN))
        .map(|i| table.label(i))
        .collect();
    if table.columns.len() > SHOWN {
        labels.push("...".to_owned());
    }
    format!(
        "the columns are {}; say which is which, such as --columns t=0,x.cmd=1,x.act=3",
        labels.join(", ")
    )
}

fn meanings(table: &LogTable) -> Vec<Meaning> {
    let of = |column: &super::table::LogColumn| {
        let mut meaning = understand(&column.name);
        if let Some(axis) = &column.axis {
            meaning.axis.clone_from(axis);
            if is_spindle(axis) {
                meaning.quantity = Quantity::Other;
            }
        }
        if !column.unit.is_empty() {
            meaning.unit = column
                .unit
                .trim_matches(['[', ']', '(', ')', ' '])
                .to_owned();
        }
        meaning
    };
    table.columns.iter().map(of).collect()
}

/// The column that somebody names.
fn resolve(table: &LogTable, choice: &ColumnChoice) -> Result<usize, String> {
    let ColumnChoice(text) = choice;
    if let Some(at) = table.columns.iter().position(|column| column.name == *text) {
        return Ok(at);
    }
    let count = table.columns.len();
    match text.parse::<usize>() {
        Ok(number) if number < count => Ok(number),
        Ok(number) => Err(format!(
            "there is no column {number}: the last of {count} is {}",
            count.saturating_sub(1)
        )),
        Err(_) => {
            let names: Vec<&str> = table
                .columns
                .iter()
                .map(|column| column.name.as_str())
                .collect();
            let near = nearest(text, &names)
                .map_or_else(String::new, |near| format!("; did you mean '{near}'?"));
            Err(format!("no column is called '{text}'{near}"))
        }
    }
}

/// The axes that `--columns` says.
fn chosen(table: &LogTable, columns: &Columns) -> Result<Vec<AxisRoles>, String> {
    let meanings = meanings(table);
    let axis = |choice: &AxisChoice| {
        let column = |of: &Option<ColumnChoice>| {
            of.as_ref().map(|choice| resolve(table, choice)).transpose()
        };
        let (command, lag) = (column(&choice.command)?, column(&choice.error)?);
        let lag = lag.filter(|_| command.is_none());
        let actual = column(&choice.actual)?;
        let (Some(command), Some(actual)) = (command.or(lag.and(actual)), actual) else {
            return Err(format!("axis {} needs act, and cmd or err", choice.name));
        };
        let torque = column(&choice.torque)?;
        let (torque_unit, torque_scale) = torque_unit(table, &meanings, torque);
        let name = choice.name.clone();
        Ok(AxisRoles {
            name,
            command,
            actual,
            lag,
            torque,
            torque_unit,
            torque_scale,
            velocity: None,
        })
    };
    columns.axes.iter().map(axis).collect()
}

/// Unit of a torque column, and the torque for a number of it.
fn torque_unit(table: &LogTable, meanings: &[Meaning], column: Option<usize>) -> (TorqueUnit, f64) {
    let Some(at) = column else {
        return (TorqueUnit::Unknown, 1.0);
    };
    let name = table
        .columns
        .get(at)
        .map_or("", |column| column.name.as_str())
        .to_lowercase();
    // The signal of a drive amplifier is a voltage.
    let otherwise = if name == "vir" {
        TorqueUnit::Volt
    } else {
        TorqueUnit::Unknown
    };
    TorqueUnit::from_name(meanings.get(at).map_or("", |meaning| meaning.unit.as_str()))
        .unwrap_or((otherwise, 1.0))
}

/// The column of the time: as said, or by its name.
fn time(
    table: &LogTable,
    columns: &Columns,
    meanings: &[Meaning],
) -> Result<Option<TimeColumn>, String> {
    if let Some(choice) = &columns.time {
        let column = resolve(table, choice)?;
        let Meaning { quantity, unit, .. } = &meanings[column];
        return Ok(Some(TimeColumn {
            column,
            counts: *quantity == Quantity::Counter,
            unit: unit.clone(),
        }));
    }
    let best = |wanted: Quantity| {
        let of_kind = meanings
            .iter()
            .enumerate()
            .filter(|(_, meaning)| meaning.quantity == wanted);
        // The first of the best.
        of_kind.rev().max_by_key(|(_, meaning)| meaning.fit)
    };
    let found = best(Quantity::Time)
        .map(|found| (found, false))
        .or_else(|| best(Quantity::Counter).map(|found| (found, true)));
    let found = found.map(|((column, meaning), counts)| TimeColumn {
        column,
        counts,
        unit: meaning.unit.clone(),
    });
    // An index without a name stands first, before columns that have one.
    let first_has_no_name = table.columns.len() > 2
        && table.columns[0].name.is_empty()
        && !table.columns[1].name.is_empty();
    let index = first_has_no_name.then(|| TimeColumn {
        column: 0,
        counts: true,
        unit: String::new(),
    });
    Ok(found.or(index))
}

/// Axes by the names of their columns.
fn named(table: &LogTable, meanings: &[Meaning], findings: &mut Vec<LogFinding>) -> Vec<AxisRoles> {
    let mut names: Vec<&str> = Vec::new();
    for meaning in meanings {
        let is_of_axis = matches!(
            meaning.quantity,
            Quantity::Command | Quantity::Actual | Quantity::Position
        );
        if is_of_axis && !names.contains(&meaning.axis.as_str()) {
            names.push(&meaning.axis);
        }
    }
    let mut axes = Vec::new();
    for name in &names {
        let best = |quantity: Quantity| {
            let of_kind = meanings
                .iter()
                .enumerate()
                .filter(|(_, m)| m.quantity == quantity && m.axis == *name);
            of_kind
                .rev()
                .max_by_key(|(_, meaning)| meaning.fit)
                .map(|(column, _)| column)
        };
        let (command, actual, position) = (
            best(Quantity::Command),
            best(Quantity::Actual),
            best(Quantity::Position),
        );
        let shown = if name.is_empty() { NAMES[0] } else { name };
        let lag = best(Quantity::Lag).filter(|_| command.is_none() && position.is_none());
        let both = match (command, actual, position) {
            (None, Some(actual), None) if lag.is_some() => Some((actual, actual)),
            (Some(command), Some(actual), _)
            | (Some(command), None, Some(actual))
            | (None, Some(actual), Some(command)) => Some((command, actual)),
            (command, actual, _) => {
                let lacks = if actual.is_none() && command.is_some() {
                    "actual position"
                } else {
                    "command"
                };
                findings.push(LogFinding::Incomplete {
                    axis: shown.to_owned(),
                    lacks,
                });
                None
            }
        };
        let Some((command, actual)) = both else {
            continue;
        };
        let torque = best(Quantity::Torque);
        let (torque_unit, torque_scale) = torque_unit(table, meanings, torque);
        axes.push(AxisRoles {
            name: shown.to_owned(),
            command,
            actual,
            lag,
            torque,
            torque_unit,
            torque_scale,
            velocity: best(Quantity::Velocity),
        });
    }
    axes
}

/// The first column that grows evenly.
fn clock_like(table: &LogTable, meanings: &[Meaning]) -> Option<TimeColumn> {
    let column = table.columns.iter().position(|column| {
        let rises = column
            .values
            .windows(2)
            .filter(|pair| pair[1] > pair[0])
            .count();
        let steps = column.values.len().saturating_sub(1);
        // All but a few: a clock that runs backward is still a clock, and refused with its reason.
        let rising = steps > 0 && rises as f64 > 0.99 * steps as f64;
        rising && is_even(&column.values)
    })?;
    let values = &table.columns[column].values;
    let counts = table.format == LogFormat::Halsampler
        && values
            .windows(2)
            .take(1000)
            .all(|pair| (pair[1] - pair[0]).fract() == 0.0);
    Some(TimeColumn {
        column,
        counts,
        unit: meanings[column].unit.clone(),
    })
}

/// Returns true if most steps of a column differ from their median by at most half of it.
fn is_even(values: &[f64]) -> bool {
    let mut steps: Vec<f64> = values
        .windows(2)
        .take(20_000)
        .map(|pair| pair[1] - pair[0])
        .collect();
    let middle = steps.len() / 2;
    steps.sort_by(f64::total_cmp);
    let Some(&median) = steps.get(middle) else {
        return false;
    };
    let alike = steps
        .iter()
        .filter(|&&step| (step - median).abs() <= 0.5 * median)
        .count();
    median > 0.0 && alike as f64 > 0.9 * steps.len() as f64
}

/// Axes by what the columns hold.
fn by_likeness(table: &LogTable, time: Option<&TimeColumn>) -> Vec<AxisRoles> {
    let is_time = |i: usize| time.is_some_and(|time| time.column == i);
    let none: &[f64] = &[];
    let columns: Vec<&[f64]> = table
        .columns
        .iter()
        .enumerate()
        .map(|(i, column)| if is_time(i) { none } else { &column.values[..] })
        .collect();
    let pairs = pairs::find(&columns);
    let name = |number: usize| {
        NAMES
            .get(number)
            .map_or_else(|| format!("axis{number}"), |name| (*name).to_owned())
    };
    pairs
        .iter()
        .enumerate()
        .map(|(number, pair)| AxisRoles {
            name: name(number),
            command: pair.command,
            actual: pair.actual,
            lag: None,
            torque: None,
            torque_unit: TorqueUnit::Unknown,
            torque_scale: 1.0,
            velocity: None,
        })
        .collect()
}
