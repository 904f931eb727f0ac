//! Heidenhain TNCscope, saved as text (`.sco`).
//!
//! ```text
//! %[CURVE 1]                  one block a channel; a line of % alone ends it
//! %CHANNELTYPE=s actual       quantity: s nominal, s actual, s dif, v actual, i actual, ...
//! %AXISTYPE=X
//! %DIMENSION=mm
//! %COUNT=5000                 samples
//! %CYCLETIME=3000             time between them, us
//! %[DATA]
//! 0;1.25;1.24;                rows: the time, and the channels in their order
//! ```
//!
//! A channel that is sampled more slowly than others fills the first of the rows only. The time
//! between samples comes from the header, therefore.

use super::{HeaderFault, ScopeChannel, ScopeHeader, cut_off, positive};
use crate::log::LogFormat;

/// Seconds in the unit of `CYCLETIME`.
const CYCLE_UNIT_S: f64 = 1e-6;

/// The header; none of another text.
pub(super) fn header(lines: &[&str]) -> Result<Option<ScopeHeader>, HeaderFault> {
    if !lines.iter().any(|line| line.starts_with("%[CURVE")) {
        return Ok(None);
    }
    // The time in the rows belongs to the channel that is sampled fastest.
    let mut channels = vec![ScopeChannel {
        name: "row".to_owned(),
        ..ScopeChannel::default()
    }];
    for (number, line) in lines.iter().enumerate() {
        if line.starts_with("%[CURVE") {
            channels.push(ScopeChannel::default());
        } else if line.starts_with("%[DATA]") {
            let first_line = number as u64 + 2;
            channels[1..].iter_mut().for_each(name);
            if channels
                .iter()
                .skip(1)
                .all(|channel| channel.sample_time_s.is_none())
            {
                "time".clone_into(&mut channels[0].name);
                "us".clone_into(&mut channels[0].unit);
            }
            let format = LogFormat::TncScope;
            return Ok(Some(ScopeHeader {
                format,
                delimiter: b';',
                channels,
                first_line,
                sample_time_s: None,
            }));
        } else if let (Some((key, value)), true, Some(channel)) = (
            line.split_once('='),
            channels.len() > 1,
            channels.last_mut(),
        ) {
            let value = value.trim();
            match key.trim() {
                "%CHANNELTYPE" => value.clone_into(&mut channel.name),
                "%AXISTYPE" => channel.axis = Some(value.to_owned()),
                "%DIMENSION" => value.clone_into(&mut channel.unit),
                "%COUNT" => channel.samples = value.parse().ok(),
                "%CYCLETIME" => channel.sample_time_s = positive(value).map(|us| CYCLE_UNIT_S * us),
                _ => {}
            }
        }
    }
    Err(cut_off(lines, "no line %[DATA] follows the curves"))
}

/// A channel gets the name that TNCscope shows, such as `s actual X`.
fn name(channel: &mut ScopeChannel) {
    if let Some(axis) = channel.axis.take()
        && !channel.name.split_whitespace().any(|word| word == axis)
    {
        channel.name = format!("{} {axis}", channel.name);
    }
}
