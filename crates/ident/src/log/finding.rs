//! Findings about a log: guesses, and deviations from what is expected.

use std::fmt;

use feedwright_sim::to_four_digits;

use super::TorqueUnit;
use super::units::{PositionUnit, TimeUnit};

/// A guess that was made, or something that was noticed.
#[derive(Debug, Clone, PartialEq)]
pub enum LogFinding {
    /// Columns of an axis.
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
        /// True where the data identified the columns, and not their names.
        by_data: bool,
    },
    /// Another log of the same machine goes on here.
    Joined {
        /// Its file.
        path: String,
        /// Time from which it is in the log as a whole, s.
        from_s: f64,
    },
    /// Unit of the positions.
    PositionUnit {
        /// The unit.
        unit: PositionUnit,
        /// Source of the unit.
        because: String,
    },
    /// Unit of the time.
    TimeUnit {
        /// The unit.
        unit: TimeUnit,
        /// Source of the unit.
        because: String,
    },
    /// Time between samples, where the file does not have it.
    SampleTime {
        /// The time, s.
        sample_time_s: f64,
        /// Source of the time.
        because: String,
    },
    /// The clock is not even.
    UnevenClock {
        /// Shortest and longest usual time between samples, s.
        range_s: [f64; 2],
        /// Time between samples that is used, s.
        taken_s: f64,
    },
    /// Samples are missing.
    Gap {
        /// End of the record before the gap, s.
        from_s: f64,
        /// Start of the record after the gap, s.
        to_s: f64,
    },
    /// More gaps than are reported one by one.
    MoreGaps {
        /// Number of further gaps.
        count: usize,
    },
    /// The last line is not whole.
    CutOff {
        /// The line, from 1.
        line: u64,
    },
    /// The file has fewer samples than its header announces.
    Short {
        /// Samples that are announced.
        announced: usize,
        /// Samples that are there.
        found: usize,
    },
    /// A rotary axis, which is left out.
    Rotary {
        /// The axis.
        axis: String,
    },
    /// An axis whose command stands still: nothing can be identified of it.
    StandsStill {
        /// The axis.
        axis: String,
    },
    /// An axis without a name that is taken for one of the program.
    TakenFor {
        /// Name of the axis in the log.
        axis: String,
        /// The axis of the program.
        program: String,
    },
    /// An axis that stands still in the program and that the log does not have.
    TakenAsStill {
        /// The axis.
        axis: String,
    },
    /// An axis that goes further than a linear axis can, which is left out.
    Endless {
        /// The axis.
        axis: String,
        /// Travel of the axis, mm.
        range_mm: f64,
    },
    /// An axis that lacks a column.
    Incomplete {
        /// The axis.
        axis: String,
        /// Missing column.
        lacks: &'static str,
    },
    /// Command and actual position have different zeros, which was taken out.
    Offset {
        /// The axis.
        axis: String,
        /// Command minus actual position, mm.
        offset_mm: f64,
    },
    /// Lag of the actual position behind the command.
    Following {
        /// The axis.
        axis: String,
        /// RMS of command minus actual position, um.
        following_um: f64,
        /// Delay of the actual position behind the command, s.
        delay_s: f64,
    },
    /// The actual position comes in steps.
    Steps {
        /// The axis.
        axis: String,
        /// The step, um.
        step_um: f64,
    },
    /// The torque stays at its largest value.
    TorqueLimit {
        /// The axis.
        axis: String,
        /// Largest value, at which the torque stays.
        limit: f64,
        /// Its unit.
        unit: TorqueUnit,
        /// Part of the samples.
        part: f64,
        /// First of them, s.
        from_s: f64,
        /// Last of them, s.
        to_s: f64,
    },
    /// The actual speed stays at a limit below the commanded speed.
    SpeedLimit {
        /// The axis.
        axis: String,
        /// Speed that it does not exceed, mm/s.
        limit_mm_s: f64,
        /// Speed of the command, mm/s.
        commanded_mm_s: f64,
    },
    /// A line in the spectrum of the torque.
    TorqueLine {
        /// The axis.
        axis: String,
        /// Its frequency, Hz.
        frequency_hz: f64,
        /// Its amplitude.
        amplitude: f64,
        /// Unit of the amplitude.
        unit: TorqueUnit,
    },
    /// A line in the spectrum of the following error.
    FollowingLine {
        /// The axis.
        axis: String,
        /// Its frequency, Hz.
        frequency_hz: f64,
        /// Its amplitude, um.
        amplitude_um: f64,
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
            Self::AxisColumns {
                axis,
                command,
                actual,
                torque,
                torque_unit,
                by_data,
            } => {
                write!(
                    f,
                    "axis {axis}: command in column {command}, actual position in column {actual}"
                )?;
                if let Some(torque) = torque {
                    write!(f, ", torque in column {torque} ({torque_unit})")?;
                }
                if *by_data {
                    f.write_str(
                        "; guessed from the data, as the columns have no names that say so",
                    )?;
                }
                Ok(())
            }
            Self::PositionUnit { unit, because } => write!(f, "positions are in {unit}: {because}"),
            Self::TimeUnit { unit, because } => write!(f, "time is in {unit}: {because}"),
            Self::SampleTime {
                sample_time_s,
                because,
            } => {
                write!(f, "{} between samples: {because}", ms(*sample_time_s))
            }
            Self::UnevenClock {
                range_s: [shortest, longest],
                taken_s,
            } => write!(
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
            Self::Joined { path, from_s } => write!(
                f,
                "{path} is joined at {} s of the time",
                to_four_digits(*from_s)
            ),
            Self::CutOff { line } => write!(f, "line {line}, the last, is cut off and left out"),
            Self::Short { announced, found } => write!(
                f,
                "the header announces {announced} samples, and {found} are there: the rest is cut off; hint: save the record again if it is needed"
            ),
            Self::Rotary { axis } => write!(f, "axis {axis} is rotary, in degrees, and left out"),
            Self::StandsStill { axis } => write!(
                f,
                "axis {axis} stands still: nothing can be identified of it"
            ),
            Self::Endless { axis, range_mm } => {
                let range_mm = to_four_digits(*range_mm);
                write!(
                    f,
                    "axis {axis} goes over {range_mm} mm, which no linear axis does: it is taken for a spindle and left out"
                )
            }
            Self::Incomplete { axis, lacks } => {
                write!(f, "axis {axis} has no {lacks} and is left out")
            }
            Self::Unused { columns } => write!(
                f,
                "not used: column {}; hint: a torque or current is named with --columns, such as x.torque={}",
                columns.join(", "),
                columns.last().map_or("5", String::as_str)
            ),
            _ => self.of_axis(f),
        }
    }
}

impl LogFinding {
    /// Describes a finding about an accepted axis.
    fn of_axis(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Offset { axis, offset_mm } => {
                let offset_mm = to_four_digits(*offset_mm);
                write!(
                    f,
                    "command and actual position of {axis} differ by {offset_mm} mm all the time, which is taken out"
                )
            }
            Self::Following {
                axis,
                following_um,
                delay_s,
            } => {
                let (following_um, by) = (to_four_digits(*following_um), ms(delay_s.abs()));
                let how = if *delay_s < 0.0 { "ahead" } else { "behind" };
                write!(
                    f,
                    "the following error of {axis} is {following_um} um RMS, its actual position is {by} {how}"
                )
            }
            Self::Steps { axis, step_um } => {
                write!(
                    f,
                    "the actual position of {axis} comes in steps of {} um",
                    to_four_digits(*step_um)
                )
            }
            Self::TorqueLimit {
                axis,
                limit,
                unit,
                part,
                from_s,
                to_s,
            } => {
                let (limit, percent) = (to_four_digits(*limit), to_four_digits(100.0 * part));
                write!(
                    f,
                    "the torque of {axis} is at its limit of {limit} {unit} in {percent} % of the samples, "
                )?;
                write!(f, "from {from_s:.3} s to {to_s:.3} s")
            }
            Self::SpeedLimit {
                axis,
                limit_mm_s,
                commanded_mm_s,
            } => {
                let [limit, commanded] =
                    [limit_mm_s, commanded_mm_s].map(|speed| to_four_digits(*speed));
                write!(
                    f,
                    "the speed of {axis} stays below {limit} mm/s, where the command reaches {commanded} mm/s"
                )
            }
            Self::TorqueLine {
                axis,
                frequency_hz,
                amplitude,
                unit,
            } => {
                let [at, size] = [frequency_hz, amplitude].map(|value| to_four_digits(*value));
                write!(
                    f,
                    "the torque of {axis} swings at {at} Hz with an amplitude of {size} {unit}"
                )
            }
            Self::FollowingLine {
                axis,
                frequency_hz,
                amplitude_um,
            } => {
                let [at, size] = [frequency_hz, amplitude_um].map(|value| to_four_digits(*value));
                write!(
                    f,
                    "the following error of {axis} swings at {at} Hz with an amplitude of {size} um"
                )
            }
            Self::TakenFor { axis, program } => write!(
                f,
                "{axis} of the log is taken for {program} of the program: columns name no axes, and joints come in the order of axes"
            ),
            Self::TakenAsStill { axis } => write!(
                f,
                "axis {axis} stands still in the program, and the log has no record of it: it is taken to be where it was; hint: --columns \
                 {axis}.cmd=COLUMN,{axis}.act=COLUMN says which columns are its"
            ),
            // All other findings are described above.
            _ => Ok(()),
        }
    }
}
