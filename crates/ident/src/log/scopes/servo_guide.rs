//! Fanuc Servo Guide, exported as CSV.
//!
//! ```text
//! Sampling cycle,1,ms
//! Axis,X,X,Y,Y
//! Kind,POSF,ERR,POSF,ERR           the signals: POSF is the position feedback, ERR the position deviation
//! Unit,mm,um,mm,um
//! 0,1.25,7.5,0,0                   rows: the time or a number, and the channels
//! ```
//!
//! No public description of these files was found. Lines before the rows are therefore read by
//! their words: one has the signals, and others may have axes, units and the sampling cycle. The
//! columns count from the right: the rows may have a time on their left, and the lines above it a
//! title.

use super::{HeaderFault, ScopeChannel, ScopeHeader, cut_off, fields, is_row, positive};
use crate::log::LogFormat;
use crate::log::names::SERVO_GUIDE_SIGNALS;
use crate::log::units::TimeUnit;

/// The signal without which a text is no log of Servo Guide.
const POSITION: &str = "POSF";

/// The header; none of another text.
pub(super) fn header(lines: &[&str]) -> Result<Option<ScopeHeader>, HeaderFault> {
    let words = |text: &str| -> Vec<String> {
        text.split(|c: char| !c.is_ascii_alphanumeric())
            .filter(|word| !word.is_empty())
            .map(str::to_owned)
            .collect()
    };
    let Some(kinds_at) = lines
        .iter()
        .position(|line| words(line).iter().any(|word| word == POSITION))
    else {
        return Ok(None);
    };
    let kinds_line = lines[kinds_at];
    let Some(delimiter) = [b',', b'\t', b';']
        .into_iter()
        .find(|&byte| fields(kinds_line, byte).len() >= 2)
    else {
        return Ok(None);
    };
    let Some(first_row) = (kinds_at + 1..lines.len()).find(|&at| is_row(lines[at], delimiter))
    else {
        return Err(cut_off(lines, "no rows follow the line of the signals"));
    };
    let before = &lines[..first_row];
    let titled = |title: &str| {
        let line = before.iter().find(|line| {
            line.to_lowercase()
                .trim_start_matches('"')
                .starts_with(title)
        });
        line.map_or_else(Vec::new, |line| fields(line, delimiter))
    };
    let (kinds, axes, units) = (
        fields(kinds_line, delimiter),
        titled("axis"),
        titled("unit"),
    );
    let columns = fields(lines[first_row], delimiter).len();
    let channel = |column: usize| {
        let of = |line: &[&str]| {
            let at = (column + line.len()).checked_sub(columns);
            at.and_then(|at| line.get(at))
                .map_or(String::new(), |field| (*field).to_owned())
        };
        let kind = of(&kinds);
        let found = words(&kind);
        let Some(signal) = found
            .iter()
            .find(|word| SERVO_GUIDE_SIGNALS.iter().any(|(name, _)| name == word))
        else {
            let is_time = kind.to_lowercase().contains("time");
            let name = if is_time { kind } else { "row".to_owned() };
            return ScopeChannel {
                name,
                unit: of(&units),
                ..ScopeChannel::default()
            };
        };
        let (bare, in_brackets) = kind.split_once('[').unwrap_or((&kind, ""));
        let axis = Some(of(&axes)).filter(|axis| !axis.is_empty());
        let axis = axis
            .or_else(|| words(bare).into_iter().find(|word| word != signal))
            .unwrap_or_default();
        let unit = Some(of(&units)).filter(|unit| !unit.is_empty());
        let unit = unit.unwrap_or_else(|| in_brackets.trim_end_matches(']').to_owned());
        ScopeChannel {
            name: format!("{signal} {axis}").trim().to_owned(),
            unit,
            ..ScopeChannel::default()
        }
    };
    let channels = (0..columns).map(channel).collect();
    let sample_time_s = before.iter().find_map(|line| sampling_s(line));
    let first_line = first_row as u64 + 1;
    Ok(Some(ScopeHeader {
        format: LogFormat::ServoGuide,
        delimiter,
        channels,
        first_line,
        sample_time_s,
    }))
}

/// The sampling cycle in a line such as `Sampling cycle,1,ms` or `Sampling cycle: 250us`, s.
fn sampling_s(line: &str) -> Option<f64> {
    let text = line.to_lowercase();
    let text = text.split_once("sampling")?.1;
    let number = text.find(|c: char| c.is_ascii_digit())?;
    let (number, behind) =
        text[number..].split_at(text[number..].find(|c: char| !c.is_ascii_digit() && c != '.')?);
    let unit: String = behind
        .chars()
        .skip_while(|c| !c.is_alphanumeric())
        .take_while(|c| c.is_alphabetic())
        .collect();
    Some(
        positive(number)?
            * TimeUnit::from_name(&unit)
                .filter(|unit| *unit != TimeUnit::Sample)?
                .in_s(1.0),
    )
}
