//! What is told of a log: guesses, and what is not as it should be.

use std::fmt;

use super::TorqueUnit;
use super::units::{PositionUnit, TimeUnit};
use crate::number::to_four_digits;

/// A guess that was made, or something that was noticed.
#[derive(Debug, Clone, PartialEq)]
pub enum LogFinding {
    /// Which columns are an axis.
    AxisColumns {
        /// The axis.
        axis: String,
        /// Column of its command.
        command: String,
        /// Column of its actual position.
        actual: String,
        /// Column of its torque.
        torque: Option<String>,
        /// Unit of the torque.
        torque_unit: TorqueUnit,
        /// Whether the data said so, and not the names.
        by_data: bool,
    },
    /// Unit of the positions.
    PositionUnit {
        /// The unit.
        unit: PositionUnit,
        /// Where it comes from.
        because: String,
    },
    /// Unit of the time.
    TimeUnit {
        /// The unit.
        unit: TimeUnit,
        /// Where it comes from.
        because: String,
    },
    /// Time between samples, where the file does not have it.
    SampleTime {
        /// The time, s.
        sample_time_s: f64,
        /// Where it comes from.
        because: String,
    },
    /// The clock is not even.
    UnevenClock {
        /// Shortest and longest usual time between samples, s.
        range_s: [f64; 2],
        /// What is taken, s.
        taken_s: f64,
    },
    /// Samples are missing.
    Gap {
        /// Where the record stops, s.
        from_s: f64,
        /// Where it goes on, s.
        to_s: f64,
    },
    /// More gaps than are told one by one.
    MoreGaps {
        /// How many more.
        count: usize,
    },
    /// The last line is not whole.
    CutOff {
        /// The line, from 1.
        line: u64,
    },
    /// A rotary axis, which is left out.
    Rotary {
        /// The axis.
        axis: String,
    },
    /// An axis that stands still, which is left out.
    StandsStill {
        /// The axis.
        axis: String,
    },
    /// An axis that lacks a column.
    Incomplete {
        /// The axis.
        axis: String,
        /// What it lacks.
        lacks: &'static str,
    },
    /// Columns of numbers that nothing is known of.
    Unused {
        /// Their names.
        columns: Vec<String>,
    },
}

/// Micrometres and milliseconds, where those are short.
fn ms(seconds: f64) -> String {
    format!("{} ms", to_four_digits(1e3 * seconds))
}

impl fmt::Display for LogFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::AxisColumns { axis, command, actual, torque, torque_unit, by_data } => {
                write!(f, "axis {axis}: command in column {command}, actual position in column {actual}")?;
                if let Some(torque) = torque {
                    write!(f, ", torque in column {torque} ({torque_unit})")?;
                }
                if *by_data {
                    f.write_str("; guessed from the data, as the columns have no names that say so")?;
                }
                Ok(())
            }
            Self::PositionUnit { unit, because } => write!(f, "positions are in {unit}: {because}"),
            Self::TimeUnit { unit, because } => write!(f, "time is in {unit}: {because}"),
            Self::SampleTime { sample_time_s, because } => {
                write!(f, "{} between samples: {because}", ms(*sample_time_s))
            }
            Self::UnevenClock { range_s: [shortest, longest], taken_s } => write!(
                f,
                "the clock is uneven: {} to {} between samples, taken as {}",
                ms(*shortest),
                ms(*longest),
                ms(*taken_s)
            ),
            Self::Gap { from_s, to_s } => {
                let missing_s = to_s - from_s;
                write!(
                    f,
                    "a gap of {} from {from_s:.4} s to {to_s:.4} s: a new stretch begins behind it",
                    ms(missing_s)
                )
            }
            Self::MoreGaps { count } => write!(f, "{count} more gaps"),
            Self::CutOff { line } => write!(f, "line {line}, the last, is cut off and left out"),
            Self::Rotary { axis } => write!(f, "axis {axis} is rotary, in degrees, and left out"),
            Self::StandsStill { axis } => write!(f, "axis {axis} stands still and is left out"),
            Self::Incomplete { axis, lacks } => write!(f, "axis {axis} has no {lacks} and is left out"),
            Self::Unused { columns } => write!(
                f,
                "not used: column {}; hint: a torque or current is named with --columns, such as x.torque={}",
                columns.join(", "),
                columns.last().map_or("5", String::as_str)
            ),
        }
    }
}
