//! Texts of measurements: lines `key: value`, a line of columns, and rows.
//!
//! A key may stand behind `#`. A line without any number names the columns. A key or columns after
//! rows begin the next block, which keeps the keys from before. Cells are separated by semicolons,
//! tabs, commas or blanks; with the first two, a comma may be the decimal point.

use std::collections::BTreeMap;

use miette::Diagnostic;
use thiserror::Error;

/// Why a file is no measurement.
#[derive(Debug, Clone, PartialEq, Eq, Error, Diagnostic)]
#[error("{file}:{line}: {message}")]
#[diagnostic(code(geometry::measurement))]
pub struct MeasurementError {
    /// The file.
    pub(crate) file: String,
    /// Its line, from 1.
    pub(crate) line: usize,
    /// Description of the error.
    pub(crate) message: String,
    /// Remedy.
    #[help]
    pub hint: String,
}

/// A block of a text.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct TextBlock {
    /// Name of the file.
    pub(super) file: String,
    /// Keys in lower case.
    pub(super) keys: BTreeMap<String, String>,
    /// Columns in lower case; empty where no line names them.
    pub(super) columns: Vec<String>,
    /// Line number and cells of each row.
    pub(super) rows: Vec<(usize, Vec<String>)>,
}

impl TextBlock {
    pub(super) fn error(&self, line: usize, message: String, hint: &str) -> MeasurementError {
        MeasurementError {
            file: self.file.clone(),
            line,
            message,
            hint: hint.to_owned(),
        }
    }

    /// Line of the first row.
    pub(super) fn line(&self) -> usize {
        self.rows.first().map_or(1, |(line, _)| *line)
    }

    /// The number in a cell of a row.
    pub(super) fn number(
        &self,
        row: &(usize, Vec<String>),
        column: usize,
    ) -> Result<f64, MeasurementError> {
        let cell = row.1.get(column).map_or("", String::as_str);
        cell.parse::<f64>()
            .ok()
            .filter(|number| number.is_finite())
            .ok_or_else(|| {
                let name = self
                    .columns
                    .get(column)
                    .map_or_else(|| format!("column {}", column + 1), Clone::clone);
                self.error(
                    row.0,
                    format!("{name} is '{cell}', not a number"),
                    "each row has a number in each column",
                )
            })
    }

    /// The column whose name begins so, and the factor that makes it `unit` (`um` or `mm`).
    pub(super) fn column(&self, begins: &str, unit: &str) -> Option<(usize, f64)> {
        let at = self
            .columns
            .iter()
            .position(|column| column.starts_with(begins))?;
        let factor = match (self.columns[at].rsplit('_').next()?, unit) {
            ("mm", "um") => 1e3,
            ("um", "mm") => 1e-3,
            _ => 1.0,
        };
        Some((at, factor))
    }

    /// Three numbers of a key; zeros where it is missing.
    pub(super) fn place_mm(&self, key: &str) -> Result<[f64; 3], MeasurementError> {
        let Some(value) = self.keys.get(key) else {
            return Ok([0.0; 3]);
        };
        let numbers: Option<Vec<f64>> = value
            .split([',', ' ', ';'])
            .filter(|cell| !cell.is_empty())
            .map(|cell| cell.parse().ok())
            .collect();
        match numbers.as_deref() {
            Some(&[x, y]) => Ok([x, y, 0.0]),
            Some(&[x, y, z]) => Ok([x, y, z]),
            _ => Err(self.error(
                self.line(),
                format!("{key} is '{value}'"),
                "write two or three numbers in mm, such as 100 50 0",
            )),
        }
    }

    /// Returns true if a key is `yes`, `true` or `1`.
    pub(super) fn flag(&self, key: &str) -> bool {
        self.keys
            .get(key)
            .is_some_and(|value| ["yes", "true", "1"].contains(&value.to_lowercase().as_str()))
    }
}

/// The blocks of a text.
pub(super) fn blocks(file: &str, text: &str) -> Vec<TextBlock> {
    let mut blocks = vec![TextBlock {
        file: file.to_owned(),
        ..TextBlock::default()
    }];
    for (number, line) in text.lines().enumerate() {
        let bare = line.trim_start_matches('\u{feff}').trim();
        let comment = bare.trim_start_matches(['#', '%', '/', ';']).trim();
        let begins = |blocks: &mut Vec<TextBlock>| {
            if let Some(last) = blocks.last().filter(|last| !last.rows.is_empty()) {
                let next = TextBlock {
                    rows: Vec::new(),
                    ..last.clone()
                };
                blocks.push(next);
            }
        };
        if let Some((key, value)) = pair(comment) {
            begins(&mut blocks);
            blocks.iter_mut().next_back().into_iter().for_each(|block| {
                block.keys.insert(key.clone(), value.clone());
            });
            continue;
        }
        if bare.is_empty() || comment.len() < bare.len() {
            continue;
        }
        let cells = cells(bare);
        let has_number = cells.iter().any(|cell| cell.parse::<f64>().is_ok());
        if !has_number {
            begins(&mut blocks);
        }
        if let Some(block) = blocks.last_mut() {
            if has_number {
                block.rows.push((number + 1, cells));
            } else {
                block.columns = cells.iter().map(|cell| cell.to_lowercase()).collect();
            }
        }
    }
    blocks
}

/// `key: value` or `key = value` with a key of one word.
fn pair(line: &str) -> Option<(String, String)> {
    let (key, value) = line.split_once([':', '='])?;
    let key = key.trim().to_lowercase();
    let word = !key.is_empty() && key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    (word && key.parse::<f64>().is_err()).then(|| (key, value.trim().to_owned()))
}

fn cells(line: &str) -> Vec<String> {
    let clean = |cell: &str| cell.trim().trim_matches('"').to_owned();
    for separator in [';', '\t'] {
        if line.contains(separator) {
            return line
                .split(separator)
                .map(|cell| clean(cell).replace(',', "."))
                .collect();
        }
    }
    if line.contains(',') {
        return line.split(',').map(clean).collect();
    }
    line.split_whitespace().map(clean).collect()
}
