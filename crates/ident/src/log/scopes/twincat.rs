//! TwinCAT Scope, exported as CSV.
//!
//! ```text
//! Name;PROJECT                          lines about the record
//! Starttime of export;132959733843760000;...
//!
//! Name;SetPos;ActPos;Name;ActTorque     a line for each property; its key stands where the time of a group of channels does in the rows
//! SymbolName;...
//! SampleTime[ms];1;1;SampleTime[ms];0,2
//! Unit;mm (Length);mm (Length);Unit;(None)
//!
//! 0;1,25;1,24;0;0                       rows: time in ms since the beginning, or as 100 ns since 1601; a line EOF may end them
//! ```
//!
//! The delimiter can be chosen at the export: it is what stands behind the first `Name`.

use super::{HeaderFault, ScopeChannel, ScopeHeader, cut_off, fields, is_row, positive};
use crate::log::LogFormat;
use crate::log::names::{Quantity, understand};

/// First word of the lines about channels.
const NAME: &str = "Name";
/// Lines that no other table has.
const MARKS: [&str; 3] = ["Starttime of export", "SampleTime[ms]", "SymbolName"];
/// Times from which they count 100 ns since 1601, not ms since the beginning: 1 ms there is 1e4,
/// and a record of 30 years would be needed here.
const FILE_TIME: f64 = 1e12;

/// The header; none of another text.
pub(super) fn header(lines: &[&str]) -> Result<Option<ScopeHeader>, HeaderFault> {
    let Some(first) = lines.iter().find_map(|line| line.strip_prefix(NAME)) else {
        return Ok(None);
    };
    let Some(delimiter) = first.bytes().next().filter(|byte| b"\t;,:|".contains(byte)) else {
        return Ok(None);
    };
    if !lines
        .iter()
        .any(|line| MARKS.iter().any(|mark| line.starts_with(mark)))
    {
        return Ok(None);
    }
    let key = |line: &str| {
        fields(line, delimiter)
            .first()
            .map_or(String::new(), |key| (*key).to_owned())
    };
    // The first line `Name` belongs to the project, the last to the channels.
    let about_project = lines
        .iter()
        .position(|line| line.starts_with("Starttime of export"));
    let from = about_project.map_or(0, |at| at + 1);
    let Some(names_at) = (from..lines.len()).find(|&at| key(lines[at]) == NAME) else {
        return Err(cut_off(lines, "no line 'Name' names the channels"));
    };
    let Some(first_row) = (names_at..lines.len()).find(|&at| is_row(lines[at], delimiter)) else {
        return Err(cut_off(
            lines,
            "no rows follow the lines about the channels",
        ));
    };
    let property = |name: &str| {
        let line = lines[names_at..first_row]
            .iter()
            .find(|line| key(line) == name)?;
        Some(fields(line, delimiter))
    };
    let names = fields(lines[names_at], delimiter);
    let [symbols, units, times] =
        ["SymbolName", "Unit", "SampleTime[ms]"].map(|name| property(name).unwrap_or_default());
    let row = fields(lines[first_row], delimiter);
    let counts_from_1601 = row
        .first()
        .and_then(|time| positive(time))
        .is_some_and(|time| time > FILE_TIME);
    let mut channels: Vec<ScopeChannel> = names
        .iter()
        .enumerate()
        .map(|(at, name)| {
            let of = |property: &[&str]| {
                property
                    .get(at)
                    .map_or(String::new(), |value| (*value).to_owned())
            };
            let (name, axis) = named(name, &of(&symbols));
            // `mm (Length)`, or `(None)`.
            let unit = of(&units)
                .split('(')
                .next()
                .unwrap_or_default()
                .trim()
                .to_owned();
            let sample_time_s = positive(&of(&times)).map(|ms| 1e-3 * ms);
            ScopeChannel {
                name,
                unit,
                axis,
                sample_time_s,
                samples: None,
            }
        })
        .collect();
    name_times(&names, &mut channels, counts_from_1601);
    let sample_time_s = positions(&channels).find_map(|at| channels[at].sample_time_s);
    let first_line = first_row as u64 + 1;
    Ok(Some(ScopeHeader {
        format: LogFormat::TwinCatScope,
        delimiter,
        channels,
        first_line,
        sample_time_s,
    }))
}

/// Returns the name and the axis of a channel. Its symbol completes what its name lacks.
fn named(name: &str, symbol: &str) -> (String, Option<String>) {
    let (by_name, by_symbol) = (understand(name), understand(symbol));
    let is_known = by_name.quantity != Quantity::Other || by_symbol.quantity == Quantity::Other;
    let shown = if is_known { name } else { symbol };
    // A number behind the name, as in `ActPos (1)`, distinguishes channels of one name, not axes.
    let is_axis = |axis: &str| {
        axis.len() == 1 && axis.chars().all(char::is_alphabetic) || axis.starts_with("axis")
    };
    let axis = [by_name.axis, by_symbol.axis]
        .into_iter()
        .find(|axis| is_axis(axis));
    (shown.to_owned(), axis)
}

/// Channels of positions.
fn positions(channels: &[ScopeChannel]) -> impl Iterator<Item = usize> + '_ {
    let is_position = |channel: &ScopeChannel| {
        matches!(
            understand(&channel.name).quantity,
            Quantity::Command | Quantity::Actual | Quantity::Lag
        )
    };
    (0..channels.len()).filter(move |&at| is_position(&channels[at]))
}

/// Each group of channels has its time. The one of the positions counts; others get names that say
/// no time.
fn name_times(names: &[&str], channels: &mut [ScopeChannel], counts_from_1601: bool) {
    let times: Vec<usize> = (0..names.len()).filter(|&at| names[at] == NAME).collect();
    let of_positions = positions(channels)
        .next()
        .and_then(|at| times.iter().rev().find(|&&time| time < at).copied());
    for at in times {
        let is_time = Some(at) == of_positions && !counts_from_1601;
        let [name, unit] = if is_time { ["time", "ms"] } else { ["row", ""] };
        channels[at] = ScopeChannel {
            name: name.to_owned(),
            unit: unit.to_owned(),
            ..ScopeChannel::default()
        };
    }
}
