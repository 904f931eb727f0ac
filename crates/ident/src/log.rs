//! Logs of real machines: commanded and actual positions, recorded at an even clock, from whatever
//! file there is.
//!
//! ```text
//! file -> format by content -> table of columns -> which column is what -> clock, units -> screening -> Log
//! ```
//!
//! Nothing is taken for granted: what was guessed is a [`LogFinding`], and a log of which a servo
//! model cannot be made is refused with its reason. Formats are recognised by content, never by the
//! name of the file.

pub(crate) mod error;
pub(crate) mod units;
pub(crate) mod finding;
pub(crate) mod columns;
pub(crate) mod table;
mod names;
mod pairs;
mod roles;
mod decimal;
mod scopes;
mod dialect;
mod text;
mod matlab;
mod sinumerik;
mod clock;
mod axes;
mod screen;
mod joined;

use std::fs::File;
use std::io::{Cursor, Read};
use std::ops::Range;
use std::path::Path;

use columns::Columns;
pub use error::LogError;
use feedwright_gcode::input;
use feedwright_sim::{StageSteps, Watch};
pub use finding::LogFinding;
use table::LogTable;

/// Commanded and actual positions of a machine's axes, recorded at an even clock.
#[derive(Debug, Clone, PartialEq)]
pub struct Log {
    /// Kind of the file.
    pub format: LogFormat,
    /// Time between two samples, s.
    pub sample_time_s: f64,
    /// Even stretches: where the record has a gap, a new one begins. Indices are into the vectors
    /// of the axes.
    pub stretches: Vec<Range<usize>>,
    /// Time of every sample, s, as recorded; zero at the first where the file counts samples only.
    pub time_s: Vec<f64>,
    /// Axes in the order of the file, at most [`MAX_AXES`]: those that have command and actual
    /// position, and move.
    pub axes: Vec<LogAxis>,
    /// Axes that have both and whose command stands still.
    pub still: Vec<LogAxis>,
    /// Guesses and observations, in the order in which they are reported.
    pub findings: Vec<LogFinding>,
}

/// An axis of a log.
#[derive(Debug, Clone, PartialEq)]
pub struct LogAxis {
    /// x, y, z, or the file's own name.
    pub name: String,
    /// Commanded position, mm.
    pub command_mm: Vec<f64>,
    /// Measured position, mm.
    pub actual_mm: Vec<f64>,
    /// Torque, force or current, in the unit of the file.
    pub torque: Option<Vec<f64>>,
    /// Unit of `torque`.
    pub torque_unit: TorqueUnit,
    /// Step of the measured position, mm; 0 where none shows.
    pub step_mm: f64,
    /// Fitness of the record for a servo model.
    pub verdict: Fitness,
}

/// Most axes of a log.
pub const MAX_AXES: usize = 9;

/// Kinds of files that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LogFormat {
    /// LinuxCNC's `halsampler`: columns of numbers, behind a sample number with `-t`.
    Halsampler,
    /// Files that LinuxCNC's `halscope` saves.
    Halscope,
    /// Variables of MATLAB or Octave, saved as version 5 to 7.
    Matlab,
    /// Recorder of Sinumerik Edge: JSON.
    SinumerikEdge,
    /// Heidenhain TNCscope, saved as text.
    TncScope,
    /// Fanuc Servo Guide, exported as CSV.
    ServoGuide,
    /// TwinCAT Scope, exported as CSV.
    TwinCatScope,
    /// Rows of numbers.
    TextTable,
}

impl std::fmt::Display for LogFormat {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Halsampler => "halsampler",
            Self::Halscope => "halscope",
            Self::Matlab => "MATLAB v5",
            Self::SinumerikEdge => "Sinumerik Edge",
            Self::TncScope => "TNCscope",
            Self::ServoGuide => "Servo Guide",
            Self::TwinCatScope => "TwinCAT Scope",
            Self::TextTable => "text table",
        })
    }
}

impl LogFormat {
    /// Returns the channels to record with the scope of the controller. `None` for a format whose
    /// columns may have any names.
    const fn record(self) -> Option<&'static str> {
        match self {
            Self::TncScope => {
                Some("record 's nominal' and 's actual', or 's actual' and 's dif', of each axis")
            }
            Self::ServoGuide => Some("record POSF and ERR of each axis: their sum is the command"),
            Self::TwinCatScope => Some("add SetPos and ActPos of each axis to the scope"),
            Self::Halsampler
            | Self::Halscope
            | Self::Matlab
            | Self::SinumerikEdge
            | Self::TextTable => None,
        }
    }
}

/// Unit of a torque column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TorqueUnit {
    /// N m.
    NewtonMetre,
    /// N.
    Newton,
    /// V.
    Volt,
    /// A.
    Ampere,
    /// Percent of what the drive is rated for.
    Percent,
    /// The file does not say.
    Unknown,
}

impl std::fmt::Display for TorqueUnit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::NewtonMetre => "N m",
            Self::Newton => "N",
            Self::Volt => "V",
            Self::Ampere => "A",
            Self::Percent => "%",
            Self::Unknown => "of no known unit",
        })
    }
}

/// Fitness of the record of an axis for a servo model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Fitness {
    /// A servo model of it can be used for control.
    ForControl,
    /// It shows how large errors are, but is too coarse for a model that corrects them.
    NotForControl {
        /// Why, with numbers.
        reason: String,
    },
}

impl Log {
    /// Reads the log in a file.
    ///
    /// # Errors
    /// Fails if the file cannot be read or is in no supported format, if columns are missing or
    /// hold no numbers, or if the record is unsuitable for a servo model.
    pub fn read(path: &Path, columns: &Columns) -> Result<Self, LogError> {
        Self::read_watched(path, columns, &())
    }

    /// Reads a log, reports the progress to `watch`, and lets it cancel the run.
    ///
    /// # Errors
    /// As [`Log::read`]; and if `watch` cancels the run.
    pub fn read_watched(
        path: &Path,
        columns: &Columns,
        watch: &dyn Watch,
    ) -> Result<Self, LogError> {
        let unreadable = |source| LogError::unreadable(source).in_file(path);
        if input::is_standard_input(path) {
            let bytes = input::standard_input().map_err(unreadable)?;
            return Self::from_reader(path, bytes, bytes.len() as u64, columns, watch);
        }
        let file = File::open(path).map_err(unreadable)?;
        let found = file.metadata().map_err(unreadable)?;
        if found.is_dir() {
            return Err(unreadable(std::io::Error::from(
                std::io::ErrorKind::IsADirectory,
            )));
        }
        Self::from_reader(path, file, found.len(), columns, watch)
    }

    /// Reads the log from `reader`. `size_bytes` is its size, which the progress refers to;
    /// messages call the log `name`.
    ///
    /// # Errors
    /// As [`Log::read_watched`].
    pub fn from_reader(
        name: &Path,
        reader: impl Read,
        size_bytes: u64,
        columns: &Columns,
        watch: &dyn Watch,
    ) -> Result<Self, LogError> {
        let mut steps = StageSteps::begin(watch, &format!("reading {}", name.display()));
        read_table(reader, size_bytes, columns, &mut steps, watch)
            .and_then(|table| of_table(table, columns))
            .map_err(|error| error.in_file(name))
    }
}

/// Bytes from which the format of a file is recognised.
const HEAD_BYTES: usize = 64 << 10;

/// The columns of a file, whatever its format.
fn read_table(
    mut reader: impl Read,
    size_bytes: u64,
    columns: &Columns,
    steps: &mut StageSteps<'_>,
    watch: &dyn Watch,
) -> Result<LogTable, LogError> {
    let mut head = Vec::with_capacity(HEAD_BYTES);
    let beginning = reader
        .by_ref()
        .take(HEAD_BYTES as u64)
        .read_to_end(&mut head);
    beginning.map_err(LogError::unreadable)?;
    let mut whole = Cursor::new(&head).chain(reader);
    if matlab::is_matlab(&head) {
        return matlab::read(&mut whole, steps, watch);
    }
    if sinumerik::is_json(&head) {
        return sinumerik::read(&mut whole, size_bytes, columns, steps, watch);
    }
    text::read(&mut whole, size_bytes, &head, columns, steps, watch)
}

/// The log in a table.
fn of_table(mut table: LogTable, columns: &Columns) -> Result<Log, LogError> {
    table.make_visible();
    let mut findings: Vec<LogFinding> = table
        .cut_off_line
        .map(|line| LogFinding::CutOff { line })
        .into_iter()
        .collect();
    if let Some(announced) = table
        .announced_rows
        .filter(|announced| *announced > table.rows())
    {
        findings.push(LogFinding::Short {
            announced,
            found: table.rows(),
        });
    }
    let roles = roles::find(&table, columns, &mut findings)?;
    let clock = clock::of_table(&mut table, &roles, columns, &mut findings)?;
    let axes = axes::of_table(&mut table, &roles, columns, &clock, &mut findings)?;
    let [axes, still] = screen::fit(axes, &clock, &mut findings)?;
    let clock::Clock {
        sample_time_s,
        stretches,
        time_s,
        ..
    } = clock;
    Ok(Log {
        format: table.format,
        sample_time_s,
        stretches,
        time_s,
        axes,
        still,
        findings,
    })
}
