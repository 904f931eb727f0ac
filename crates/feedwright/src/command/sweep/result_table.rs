//! Results of a sweep as a table: one row for each job, its keys, its figures, and those that it is
//! compared with.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use feedwright_sim::Watch;
use miette::{IntoDiagnostic, Result, WrapErr, miette};
use serde_json::{Map, Value};

use super::job_result::error_of;
use crate::report::Role;
use crate::results_format::spelled_out;
use crate::store::Store;

/// Source of the values of a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ColumnSource {
    /// The result.
    Result,
    /// The keys of the job.
    Job,
    /// The message of the error.
    Error,
    /// The run of a role.
    Run(Role),
}

/// A column of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ResultColumn {
    /// Name.
    pub name: &'static str,
    /// True if the column has numbers.
    pub is_number: bool,
    source: ColumnSource,
    pointer: &'static str,
}

const fn column(
    name: &'static str,
    is_number: bool,
    source: ColumnSource,
    pointer: &'static str,
) -> ResultColumn {
    ResultColumn {
        name,
        is_number,
        source,
        pointer,
    }
}

/// The columns, in the order in which rows are sorted and written.
pub const RESULT_COLUMNS: [ResultColumn; 27] = {
    use ColumnSource::{Error, Job, Result};
    const RUN: ColumnSource = ColumnSource::Run(Role::Corrected);
    const AGAINST: ColumnSource = ColumnSource::Run(Role::Reference);
    [
        column("program", false, Job, "/program"),
        column("machine", false, Job, "/machine"),
        column("controller", false, Job, "/controller"),
        column("against", false, Job, "/against"),
        column("tolerance_um", true, Job, "/tolerance_um"),
        column("feed_mm_s", true, Job, "/feed_mm_s"),
        column("settings", false, Job, "/settings"),
        column("model", false, Job, "/model"),
        column("seed", true, Job, "/seed"),
        column("error", false, Error, ""),
        column("within_tolerance", false, Result, "/within_tolerance"),
        column("outcome", false, RUN, "/outcome/kind"),
        column("time_s", true, RUN, "/time_s"),
        column("rms_um", true, RUN, "/rms_um"),
        column("max_um", true, RUN, "/max_um"),
        column("uncut_um", true, RUN, "/uncut_um"),
        column("max_deviation_um", true, RUN, "/max_deviation_um"),
        column(
            "max_command_accel_mm_s2",
            true,
            RUN,
            "/max_command_accel_mm_s2",
        ),
        column("engaged_share", true, RUN, "/engaged_share"),
        column("cutting_length_mm", true, RUN, "/cutting_length_mm"),
        column("against_time_s", true, AGAINST, "/time_s"),
        column("against_rms_um", true, AGAINST, "/rms_um"),
        column("against_max_um", true, AGAINST, "/max_um"),
        column("against_uncut_um", true, AGAINST, "/uncut_um"),
        column("band_max_um_p90", true, Result, "/band/max_um/p90"),
        column("version", false, Result, "/version"),
        column("address", false, Result, "/address"),
    ]
};

impl ResultColumn {
    fn of(&self, result: &Value) -> Value {
        let within = match self.source {
            ColumnSource::Result => Some(result),
            ColumnSource::Job => result.get("job"),
            ColumnSource::Error => return error_of(result).map_or(Value::Null, Value::from),
            ColumnSource::Run(role) => role.of_results(result),
        };
        match within.and_then(|value| value.pointer(self.pointer)) {
            // A list or an object is its text: a cell holds one value.
            Some(value @ (Value::Array(_) | Value::Object(_))) => {
                spelled_out(&value.to_string()).into()
            }
            Some(value) => value.clone(),
            None => Value::Null,
        }
    }
}

/// The rows of results, sorted by program, machine, controller and the other keys.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ResultTable {
    /// A cell for each of [`RESULT_COLUMNS`].
    pub rows: Vec<Vec<Value>>,
}

impl ResultTable {
    /// The results in all folders; one that several have is one row.
    ///
    /// # Errors
    /// A folder or a file that cannot be read, or a cancellation.
    pub fn of(folders: &[PathBuf], watch: &dyn Watch) -> Result<Self> {
        let mut files: BTreeMap<_, PathBuf> = BTreeMap::new();
        let named = |path: PathBuf| Some((path.file_name()?.to_owned(), path));
        for folder in folders {
            files.extend(files_in(folder)?.filter_map(named));
        }
        watch.begin("reading the results", files.len() as u64);
        let mut rows = Vec::with_capacity(files.len());
        for path in files.values() {
            watch.check()?;
            let result = read(path).map_err(|error| {
                miette!(
                    help = "remove the file and sweep again: the job is done anew",
                    "a result is damaged: {error:#}"
                )
            })?;
            rows.push(
                RESULT_COLUMNS
                    .iter()
                    .map(|column| column.of(&result))
                    .collect(),
            );
            watch.advance(1);
        }
        rows.sort_by(|a: &Vec<Value>, b| by_cells(a, b));
        Ok(Self { rows })
    }

    /// Writes a line of names, and a line for each row, separated by commas. A missing value is
    /// empty.
    ///
    /// # Errors
    /// What the writer says.
    pub fn write_csv(&self, out: &mut impl Write) -> io::Result<()> {
        writeln!(
            out,
            "{}",
            RESULT_COLUMNS.map(|column| column.name).join(",")
        )?;
        for row in &self.rows {
            writeln!(
                out,
                "{}",
                row.iter().map(csv_cell).collect::<Vec<_>>().join(",")
            )?;
        }
        Ok(())
    }

    /// Writes an object for each row, one a line. A missing value is null.
    ///
    /// # Errors
    /// What the writer says.
    pub fn write_json_lines(&self, out: &mut impl Write) -> io::Result<()> {
        for row in &self.rows {
            let cells = RESULT_COLUMNS
                .iter()
                .map(|column| column.name.to_owned())
                .zip(row.iter().cloned());
            writeln!(
                out,
                "{}",
                spelled_out(&Value::from(cells.collect::<Map<_, _>>()).to_string())
            )?;
        }
        Ok(())
    }
}

/// The files of the results in a folder.
fn files_in(folder: &Path) -> Result<impl Iterator<Item = PathBuf> + use<>> {
    if !folder.is_dir() {
        return Err(miette!(
            help = "name the folder that `feedwright sweep --out` wrote",
            "{}: there is no such folder",
            folder.display()
        ));
    }
    let files = Store::new(folder.to_owned())
        .files()
        .map_err(|error| miette!("{}: the folder cannot be read: {error}", folder.display()))?;
    Ok(files.into_iter().map(|file| file.path))
}

/// The result in a file.
fn read(path: &Path) -> Result<Value> {
    let shown = || path.display().to_string();
    let bytes = std::fs::read(path).into_diagnostic().wrap_err_with(shown)?;
    serde_json::from_slice(&bytes)
        .into_diagnostic()
        .wrap_err_with(shown)
}

/// A cell of RFC 4180; line ends in a text are spaces, so that each line is a row.
fn csv_cell(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => {
            let text = text.replace(['\r', '\n'], " ");
            if text.contains([',', '"']) {
                format!("\"{}\"", text.replace('"', "\"\""))
            } else {
                text
            }
        }
        value => value.to_string(),
    }
}

/// Rows by their cells from the first on: numbers by value, texts by their letters.
fn by_cells(a: &[Value], b: &[Value]) -> Ordering {
    let by_cell = |(a, b): (&Value, &Value)| match (a, b) {
        (Value::Number(a), Value::Number(b)) => a
            .as_f64()
            .unwrap_or_default()
            .total_cmp(&b.as_f64().unwrap_or_default()),
        (a, b) => a.as_str().cmp(&b.as_str()),
    };
    a.iter()
        .zip(b)
        .map(by_cell)
        .find(|order| order.is_ne())
        .unwrap_or(Ordering::Equal)
}
