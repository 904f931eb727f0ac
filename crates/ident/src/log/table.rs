//! The columns of a file, before anything is known of them.

use feedwright_gcode::visible;

use super::LogFormat;

/// Columns of numbers, whatever the file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LogTable {
    /// Kind of the file.
    pub(crate) format: LogFormat,
    /// The columns in the order of the file.
    pub(crate) columns: Vec<LogColumn>,
    /// Rows before which samples are known to be missing.
    pub(crate) breaks: Vec<usize>,
    /// Line numbers of the rows.
    pub(crate) lines: LineNumbers,
    /// Time between rows, s, where the file says so.
    pub(crate) sample_time_s: Option<f64>,
    /// Line that states the unit of the positions, from 1, and the unit.
    pub(crate) position_unit: Option<(u64, String)>,
    /// A last line that is cut off.
    pub(crate) cut_off_line: Option<u64>,
    /// Rows that the header of the file announces.
    pub(crate) announced_rows: Option<usize>,
}

/// A column.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct LogColumn {
    /// Its name in the file; none where it has none.
    pub(crate) name: String,
    /// Its unit, as the file has it.
    pub(crate) unit: String,
    /// The axis that it belongs to, where the file says so.
    pub(crate) axis: Option<String>,
    /// Time between its samples, s, where the file says so of each column.
    pub(crate) sample_time_s: Option<f64>,
    /// One value per row; empty if the reader does not need the column.
    pub(crate) values: Vec<f64>,
    /// The first row whose value is no number, and what stands there.
    pub(crate) not_a_number: Option<(usize, String)>,
}

impl LogTable {
    /// Makes the file's texts about its columns safe to show in messages.
    pub(super) fn make_visible(&mut self) {
        let of_columns = self.columns.iter_mut().flat_map(|column| {
            [&mut column.name, &mut column.unit]
                .into_iter()
                .chain(&mut column.axis)
        });
        of_columns
            .chain(self.position_unit.as_mut().map(|stated| &mut stated.1))
            .for_each(|text| *text = visible(text).into_owned());
    }

    /// Returns the name of a column for messages, or its number from 0.
    pub(crate) fn label(&self, column: usize) -> String {
        let name = self
            .columns
            .get(column)
            .map_or("", |column| column.name.as_str());
        if name.is_empty() {
            column.to_string()
        } else {
            format!("'{name}'")
        }
    }

    /// Rows.
    pub(crate) fn rows(&self) -> usize {
        self.columns
            .iter()
            .map(|column| column.values.len())
            .max()
            .unwrap_or(0)
    }

    /// Returns the place of a row for messages.
    pub(crate) fn place(&self, row: usize) -> String {
        match self.lines.of(row) {
            Some(line) => format!("line {line}"),
            None => format!("sample {row}"),
        }
    }
}

/// Line number of every row.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct LineNumbers {
    /// A row and a shift, in the order of rows: from this row on, the line number is the row plus
    /// the shift.
    shifts: Vec<(usize, u64)>,
}

impl LineNumbers {
    /// The next row stands in this line, from 1.
    pub(crate) fn note(&mut self, row: usize, line: u64) {
        let shift = line.saturating_sub(row as u64);
        if self.shifts.last().is_none_or(|&(_, last)| last != shift) {
            self.shifts.push((row, shift));
        }
    }

    /// The line of a row, from 1; none where the file has no lines.
    pub(crate) fn of(&self, row: usize) -> Option<u64> {
        let at = self.shifts.partition_point(|&(first, _)| first <= row);
        let (_, shift) = self.shifts.get(at.checked_sub(1)?)?;
        Some(row as u64 + shift)
    }
}
