//! What the recorder of Sinumerik Edge writes: JSON, read as a stream.
//!
//! ```text
//! Header.CycleTimeMs              time between two counts of CYCLE
//! Header.SignalListHFData[i]      Name such as DES_POS|1, Axis such as X1: column i of the rows
//! Payload[..].HFData[..]          rows of numbers, where an element of the payload has any
//! ```

use std::cell::Cell;
use std::fmt;
use std::io::{self, BufReader, Read};

use feedwright_sim::{Cancelled, StageSteps, Watch};
use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};

use super::columns::Columns;
use super::table::{LineNumbers, LogColumn, LogTable};
use super::{LogError, LogFormat, roles};

/// Returns true if a file begins as JSON does.
pub(super) fn is_json(head: &[u8]) -> bool {
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    head.trim_ascii_start().starts_with(b"{")
}

/// Reads the rows of a recording.
pub(super) fn read(
    file: &mut dyn Read,
    total_bytes: u64,
    columns: &Columns,
    steps: &mut StageSteps<'_>,
    watch: &dyn Watch,
) -> Result<LogTable, LogError> {
    let (cancelled, failed) = (Cell::new(false), Cell::new(None));
    let reader = Watched {
        file,
        done_bytes: 0,
        total_bytes,
        steps,
        watch,
        cancelled: &cancelled,
        failed: &failed,
    };
    let mut reader = BufReader::with_capacity(1 << 18, reader);
    let result = skip_mark(&mut reader).map_err(LogError::unreadable).and_then(|()| {
        let mut json = serde_json::Deserializer::from_reader(reader);
        let table = RecordingSeed { columns }.deserialize(&mut json);
        table.map_err(|error| {
            let line = (error.line() > 0).then_some(error.line() as u64);
            let hint =
                "JSON is read as the recorder of Sinumerik Edge writes it: Header.SignalListHFData, rows in Payload";
            LogError::format(line, error.to_string(), hint)
        })
    });
    if cancelled.get() {
        return Err(Cancelled.into());
    }
    match failed.take() {
        Some(error) => Err(LogError::unreadable(error)),
        None => result,
    }
}

/// Passes over the mark with which some text begins.
fn skip_mark(reader: &mut impl io::BufRead) -> io::Result<()> {
    let has_mark = reader.fill_buf()?.starts_with(b"\xef\xbb\xbf");
    reader.consume(if has_mark { 3 } else { 0 });
    Ok(())
}

/// File that reports the part of it that has been read.
struct Watched<'a, 'b> {
    file: &'a mut dyn Read,
    done_bytes: u64,
    total_bytes: u64,
    steps: &'a mut StageSteps<'b>,
    watch: &'a dyn Watch,
    cancelled: &'a Cell<bool>,
    failed: &'a Cell<Option<io::Error>>,
}

impl Read for Watched<'_, '_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.watch.is_cancelled() {
            self.cancelled.set(true);
            return Err(io::Error::other(Cancelled));
        }
        let count = match self.file.read(buffer) {
            Err(error) if error.kind() != io::ErrorKind::Interrupted => {
                let kind = error.kind();
                self.failed.set(Some(error));
                return Err(kind.into());
            }
            other => other?,
        };
        self.done_bytes += count as u64;
        self.steps
            .reach(self.done_bytes as f64 / self.total_bytes as f64);
        Ok(count)
    }
}

/// Keys of the header that are needed.
#[derive(Deserialize)]
#[serde(rename_all = "PascalCase")]
struct Header {
    #[serde(rename = "SignalListHFData")]
    signals: Vec<Signal>,
    cycle_time_ms: Option<f64>,
}

/// A column of the rows.
#[derive(Deserialize)]
#[serde(rename_all = "PascalCase")]
struct Signal {
    name: String,
    #[serde(default)]
    axis: Option<String>,
}

/// Reads the whole: a table of the columns that are needed.
struct RecordingSeed<'a> {
    columns: &'a Columns,
}

impl<'de> DeserializeSeed<'de> for RecordingSeed<'_> {
    type Value = LogTable;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<LogTable, D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for RecordingSeed<'_> {
    type Value = LogTable;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("an object with Header and Payload")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<LogTable, A::Error> {
        let mut found: Option<(LogTable, Vec<bool>)> = None;
        let mut has_payload = false;
        while let Some(key) = map.next_key::<String>()? {
            match (key.as_str(), &mut found) {
                ("Header", _) => {
                    let table = table_of(map.next_value()?);
                    let kept = roles::needed(&table, self.columns);
                    found = Some((table, kept));
                }
                ("Payload", Some((table, kept))) => {
                    has_payload = true;
                    map.next_value_seed(RowsSeed {
                        table,
                        kept,
                        level: Level::Payload,
                    })?;
                }
                ("Payload", None) => {
                    return Err(A::Error::custom("the payload stands before the header"));
                }
                _ => {
                    map.next_value::<IgnoredAny>()?;
                }
            }
        }
        match found {
            Some((table, _)) if has_payload => Ok(table),
            Some(_) => Err(A::Error::custom("there is no Payload")),
            None => Err(A::Error::custom("there is no Header")),
        }
    }
}

/// The columns that a header announces.
fn table_of(header: Header) -> LogTable {
    let column = |signal: Signal| {
        // Torques are in N m, currents in A: the recorder writes no units.
        let unit = if signal.name.starts_with("TORQUE|") {
            "Nm"
        } else if signal.name.starts_with("CURRENT|") {
            "A"
        } else {
            ""
        };
        // The first axis of a letter is called by the letter.
        let axis = signal.axis.map(|axis| {
            let axis = axis.to_lowercase();
            match axis.strip_suffix('1') {
                Some(letter) if letter.len() == 1 => letter.to_owned(),
                _ => axis,
            }
        });
        LogColumn {
            name: signal.name,
            unit: unit.to_owned(),
            axis,
            ..LogColumn::default()
        }
    };
    LogTable {
        format: LogFormat::SinumerikEdge,
        columns: header.signals.into_iter().map(column).collect(),
        breaks: Vec::new(),
        lines: LineNumbers::default(),
        position_unit: None,
        sample_time_s: header
            .cycle_time_ms
            .filter(|ms| ms.is_finite() && *ms > 0.0)
            .map(|ms| 1e-3 * ms),
        cut_off_line: None,
        announced_rows: None,
    }
}

/// Depth of the rows that are being read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Level {
    /// A list of elements.
    Payload,
    /// An element, which has rows or anything else.
    Block,
    /// A list of rows.
    Rows,
    /// A row.
    Row,
}

/// Reads rows into a table.
struct RowsSeed<'a> {
    table: &'a mut LogTable,
    kept: &'a [bool],
    level: Level,
}

impl RowsSeed<'_> {
    fn below(&mut self, level: Level) -> RowsSeed<'_> {
        RowsSeed {
            table: self.table,
            kept: self.kept,
            level,
        }
    }
}

impl<'de> DeserializeSeed<'de> for RowsSeed<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        match self.level {
            Level::Block => deserializer.deserialize_map(self),
            _ => deserializer.deserialize_seq(self),
        }
    }
}

impl<'de> Visitor<'de> for RowsSeed<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.level {
            Level::Payload => "a list of blocks",
            Level::Block => "a block of rows or events",
            Level::Rows => "a list of rows",
            Level::Row => "a row of numbers",
        })
    }

    fn visit_map<A: MapAccess<'de>>(mut self, mut map: A) -> Result<(), A::Error> {
        while let Some(key) = map.next_key::<String>()? {
            if key == "HFData" {
                map.next_value_seed(self.below(Level::Rows))?;
            } else {
                map.next_value::<IgnoredAny>()?;
            }
        }
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(mut self, mut seq: A) -> Result<(), A::Error> {
        let below = match self.level {
            Level::Payload => Level::Block,
            Level::Block | Level::Rows => Level::Row,
            Level::Row => return self.row(seq),
        };
        while seq.next_element_seed(self.below(below))?.is_some() {}
        Ok(())
    }
}

impl RowsSeed<'_> {
    fn row<'de, A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        let row = self.table.rows();
        let mut count = 0;
        while let Some(SignalValue(value)) = seq.next_element()? {
            if let (Some(true), Some(column)) =
                (self.kept.get(count), self.table.columns.get_mut(count))
            {
                if value.is_nan() && column.not_a_number.is_none() {
                    column.not_a_number = Some((row, "no number".to_owned()));
                }
                column.values.push(value);
            }
            count += 1;
        }
        let expected = self.table.columns.len();
        if count == expected {
            return Ok(());
        }
        Err(A::Error::custom(format!(
            "row {row} has {count} values, where the header announces {expected}"
        )))
    }
}

/// One value of a signal. A boolean becomes 0 or 1, a text or null becomes NaN, and an array or
/// object is an error.
struct SignalValue(f64);

impl<'de> Deserialize<'de> for SignalValue {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NumberVisitor;
        impl Visitor<'_> for NumberVisitor {
            type Value = SignalValue;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number")
            }

            fn visit_f64<E>(self, value: f64) -> Result<SignalValue, E> {
                Ok(SignalValue(value))
            }

            fn visit_i64<E>(self, value: i64) -> Result<SignalValue, E> {
                Ok(SignalValue(value as f64))
            }

            fn visit_u64<E>(self, value: u64) -> Result<SignalValue, E> {
                Ok(SignalValue(value as f64))
            }

            fn visit_bool<E>(self, value: bool) -> Result<SignalValue, E> {
                Ok(SignalValue(f64::from(u8::from(value))))
            }

            fn visit_str<E>(self, _: &str) -> Result<SignalValue, E> {
                Ok(SignalValue(f64::NAN))
            }

            fn visit_unit<E>(self) -> Result<SignalValue, E> {
                Ok(SignalValue(f64::NAN))
            }
        }
        deserializer.deserialize_any(NumberVisitor)
    }
}
