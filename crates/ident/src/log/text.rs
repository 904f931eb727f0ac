//! Text tables: rows of numbers, read in chunks; only the columns that are needed are kept.

use std::io::Read;

use feedwright_gcode::visible;
use feedwright_sim::{StageSteps, Watch};
use memchr::memchr_iter;

use super::columns::Columns;
use super::dialect::{LineKind, TableDialect, fields};
use super::scopes::{self, END_MARK};
use super::table::{LineNumbers, LogColumn, LogTable};
use super::{LogError, LogFormat, decimal};

/// Bytes that are read at once.
const CHUNK_BYTES: usize = 1 << 20;
/// Longest line; a table of a log has hundreds of bytes a line.
const MAX_LINE_BYTES: usize = 1 << 20;

/// Reads a text table whose beginning is known.
pub(super) fn read(
    file: &mut impl Read,
    total_bytes: u64,
    head: &[u8],
    columns: &Columns,
    steps: &mut StageSteps<'_>,
    watch: &dyn Watch,
) -> Result<LogTable, LogError> {
    let dialect = dialect_of(head)?;
    let mut rows = TextRows::new(dialect, columns);
    rows.reserve(head, total_bytes);
    let (mut chunk, mut carried, mut done_bytes) = (vec![0; CHUNK_BYTES], Vec::new(), 0_u64);
    loop {
        let count = match file.read(&mut chunk) {
            Ok(count) => count,
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(LogError::unreadable(error)),
        };
        if count == 0 {
            break;
        }
        watch.check()?;
        let mut start = 0;
        for end in memchr_iter(b'\n', &chunk[..count]) {
            if carried.is_empty() {
                rows.line(&chunk[start..end])?;
            } else {
                carried.extend_from_slice(&chunk[start..end]);
                rows.line(&carried)?;
                carried.clear();
            }
            start = end + 1;
        }
        carried.extend_from_slice(&chunk[start..count]);
        if carried.len() > MAX_LINE_BYTES {
            let hint = "a log is rows of numbers, one a line";
            return Err(LogError::format(
                Some(rows.line + 1),
                "the line is longer than 1 MiB",
                hint,
            ));
        }
        done_bytes += count as u64;
        steps.reach(done_bytes as f64 / total_bytes as f64);
    }
    if !carried.is_empty() {
        rows.is_last = true;
        rows.line(&carried)?;
    }
    rows.finish()
}

/// Dialect of the table that begins with `head`. Fails if `head` is empty, binary or UTF-16, or has
/// no rows of at least two numbers.
fn dialect_of(head: &[u8]) -> Result<TableDialect, LogError> {
    const HINT: &str = "logs are text tables, files of halsampler, halscope, TNCscope, Servo Guide and TwinCAT Scope, MATLAB files (version 5 to 7) and JSON of Sinumerik Edge";
    if head.is_empty() {
        return Err(LogError::format(None, "the file is empty", HINT));
    }
    if head.starts_with(b"\xff\xfe") || head.starts_with(b"\xfe\xff") {
        let hint = "save it as UTF-8 or plain text";
        return Err(LogError::format(
            None,
            "the file is text in UTF-16, which is not read",
            hint,
        ));
    }
    if let Some(at) = head.iter().position(|&byte| byte == 0) {
        let message =
            format!("the file is neither text nor a binary format that is read: byte {at} is zero");
        return Err(LogError::format(None, message, HINT));
    }
    if let Some(header) = scopes::header(head)? {
        return Ok(TableDialect::of_scope(header, head));
    }
    TableDialect::of(head).ok_or_else(|| {
        let message = "no rows of at least two numbers within the first 64 KiB";
        LogError::format(None, message, HINT)
    })
}

/// The rows so far.
struct TextRows {
    dialect: TableDialect,
    table: LogTable,
    /// True for each column that is kept.
    kept: Vec<bool>,
    row: usize,
    /// Lines so far.
    line: u64,
    is_last: bool,
    /// True once the record is complete; the following lines are no part of it.
    is_over: bool,
}

impl TextRows {
    fn new(dialect: TableDialect, columns: &Columns) -> Self {
        let name = |names: &[String], i: usize| names.get(i).cloned().unwrap_or_default();
        let channels = dialect
            .scope
            .as_ref()
            .map_or(&[][..], |(_, channels)| channels);
        let found = (0..dialect.columns)
            .map(|i| LogColumn {
                name: name(&dialect.names, i),
                unit: name(&dialect.units, i),
                sample_time_s: channels.get(i).and_then(|channel| channel.sample_time_s),
                axis: channels.get(i).and_then(|channel| channel.axis.clone()),
                ..LogColumn::default()
            })
            .collect();
        let mut table = LogTable {
            format: dialect
                .scope
                .as_ref()
                .map_or(LogFormat::TextTable, |(format, _)| *format),
            columns: found,
            breaks: Vec::new(),
            lines: LineNumbers::default(),
            sample_time_s: dialect.sample_time_s,
            position_unit: dialect.position_unit.clone(),
            cut_off_line: None,
            announced_rows: None,
        };
        // Fields that are names are no columns to `--columns`: what it needs is not known before
        // they are gone.
        let kept = if dialect.names_in_rows {
            table
                .columns
                .iter()
                .map(|column| !column.name.is_empty())
                .collect()
        } else {
            super::roles::needed(&table, columns)
        };
        let samples = channels
            .iter()
            .zip(&kept)
            .filter(|(_, kept)| **kept)
            .filter_map(|(channel, _)| channel.samples);
        table.announced_rows = samples.min();
        table.sample_time_s = table.sample_time_s.or_else(|| {
            let mut kept = table.columns.iter().zip(&kept).filter(|(_, kept)| **kept);
            kept.find_map(|(column, _)| column.sample_time_s)
        });
        Self {
            dialect,
            table,
            kept,
            row: 0,
            line: 0,
            is_last: false,
            is_over: false,
        }
    }

    /// Room for about as many rows as there are, so that columns need not grow: that would take
    /// twice their memory.
    fn reserve(&mut self, head: &[u8], total_bytes: u64) {
        let lines = memchr_iter(b'\n', head).count().max(1);
        let rows = (total_bytes as f64 / head.len() as f64 * lines as f64 * 1.02) as usize + 1;
        for (column, _) in self
            .table
            .columns
            .iter_mut()
            .zip(&self.kept)
            .filter(|(_, kept)| **kept)
        {
            // What cannot be had now is asked for row by row.
            let _ = column.values.try_reserve_exact(rows);
        }
    }

    /// One line, without its end.
    fn line(&mut self, line: &[u8]) -> Result<(), LogError> {
        self.line += 1;
        if self.line < self.dialect.first_line || self.is_over {
            return Ok(());
        }
        let line = if self.line == 1 {
            line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line)
        } else {
            line
        };
        let line = line.strip_suffix(b"\r").unwrap_or(line);
        match LineKind::of(line, self.dialect.delimiter) {
            LineKind::Blank | LineKind::Comment => return Ok(()),
            LineKind::Overrun => {
                self.table.breaks.push(self.row);
                return Ok(());
            }
            LineKind::Other => {}
        }
        let line = if self.dialect.scope.is_some() {
            self.of_scope(line)
        } else {
            line
        };
        if self.is_over {
            return Ok(());
        }
        let mut count = 0;
        for field in fields(line, self.dialect.delimiter) {
            if let (Some(true), Some(column)) =
                (self.kept.get(count), self.table.columns.get_mut(count))
            {
                let value = decimal::parse(field, self.dialect.point).unwrap_or(f64::NAN);
                if value.is_nan() && column.not_a_number.is_none() {
                    let text: String = String::from_utf8_lossy(decimal::trimmed(field))
                        .chars()
                        .take(40)
                        .collect();
                    column.not_a_number = Some((self.row, visible(&text).into_owned()));
                }
                column.values.push(value);
            }
            count += 1;
        }
        if count != self.dialect.columns {
            return self.of_other_length(count);
        }
        self.table.lines.note(self.row, self.line);
        self.row += 1;
        Ok(())
    }

    /// A row of a scope without the delimiter that may end it. The record is over behind its last
    /// sample, at an end mark, and where all channels that are kept are empty: others were sampled
    /// for longer.
    fn of_scope<'l>(&mut self, line: &'l [u8]) -> &'l [u8] {
        let delimiter = self.dialect.delimiter;
        let is_complete = self
            .table
            .announced_rows
            .is_some_and(|rows| self.row >= rows);
        let mut kept = fields(line, delimiter)
            .zip(&self.kept)
            .filter(|(_, kept)| **kept)
            .peekable();
        let is_empty =
            kept.peek().is_some() && kept.all(|(field, _)| decimal::trimmed(field).is_empty());
        self.is_over = is_complete || is_empty || line.trim_ascii() == END_MARK;
        let ends = memchr_iter(delimiter, line).count() == self.dialect.columns;
        if ends {
            line.strip_suffix(&[delimiter]).unwrap_or(line)
        } else {
            line
        }
    }

    /// A line with more or fewer fields than the rows: fine at the end of a record that was cut
    /// off.
    fn of_other_length(&mut self, count: usize) -> Result<(), LogError> {
        if !self.is_last {
            let message = format!(
                "{count} columns, where the lines before have {}",
                self.dialect.columns
            );
            let hint = "take the line out, or put # in front of it";
            return Err(LogError::format(Some(self.line), message, hint));
        }
        for column in &mut self.table.columns {
            column.values.truncate(self.row);
            column.not_a_number.take_if(|(row, _)| *row >= self.row);
        }
        self.table.cut_off_line = Some(self.line);
        Ok(())
    }

    fn finish(mut self) -> Result<LogTable, LogError> {
        if self.dialect.names_in_rows {
            self.table.columns.retain(|column| !column.name.is_empty());
        }
        self.table.format = self.format();
        for column in &mut self.table.columns {
            column.values.shrink_to_fit();
        }
        Ok(self.table)
    }
}

impl TextRows {
    /// Whose text it is: LinuxCNC's recorders have marks of their own.
    fn format(&self) -> LogFormat {
        if self.dialect.scope.is_some() {
            return self.table.format;
        }
        let first = self.table.columns.first();
        let counts = first.is_some_and(|column| {
            let is_named = ["", "n"].contains(&column.name.as_str()) && column.values.len() > 1;
            is_named
                && column
                    .values
                    .windows(2)
                    .take(1000)
                    .all(|pair| pair[1] - pair[0] == 1.0)
        });
        let named_n = counts && first.is_some_and(|column| column.name == "n");
        let is_blank = self.dialect.delimiter == b' ';
        match self.dialect.sample_time_s {
            Some(_) if self.dialect.names_in_rows || !counts => LogFormat::Halscope,
            _ if !self.table.breaks.is_empty() || named_n || (counts && is_blank) => {
                LogFormat::Halsampler
            }
            _ => LogFormat::TextTable,
        }
    }
}
