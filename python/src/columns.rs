//! The rows of a cut as arrays of numpy.

use std::io;

use feedwright::sim::{Row, Sink};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Names of the axes.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Name of a column, and its value in a row.
type ColumnOf<T> = (&'static str, fn(&Row) -> T);

/// Vectors of a row, with a column for each axis.
const VECTORS: [ColumnOf<[f64; 3]>; 5] = [
    ("path_{}_mm", |row| row.path_mm),
    ("cmd_{}_mm", |row| row.cmd_mm),
    ("act_{}_mm", |row| row.act_mm),
    ("foot_{}_mm", |row| row.foot_mm),
    ("torque_{}_nm", |row| row.torque_nm),
];

/// Numbers of a row.
const NUMBERS: [ColumnOf<f64>; 4] = [
    ("t_s", |row| row.t_s),
    ("s_mm", |row| row.s_mm),
    ("feed_plan_mm_s", |row| row.feed_plan_mm_s),
    ("contour_error_um", |row| 1e3 * row.contour_error_mm),
];

/// Columns of rows.
pub(crate) struct RowColumns {
    axes: usize,
    line: Vec<u32>,
    cutting: Vec<bool>,
    numbers: [Vec<f64>; NUMBERS.len()],
    /// Columns of each vector, axis by axis.
    vectors: [[Vec<f64>; 3]; VECTORS.len()],
}

impl RowColumns {
    /// Creates empty columns for a cut in which `axes` axes move.
    pub(crate) fn new(axes: usize) -> Self {
        Self {
            axes,
            line: vec![],
            cutting: vec![],
            numbers: Default::default(),
            vectors: Default::default(),
        }
    }

    /// Returns the columns as arrays, which take over the memory.
    pub(crate) fn into_arrays<'py>(self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let arrays = PyDict::new(py);
        let [t_s, rest @ ..] = self.numbers;
        arrays.set_item(NUMBERS[0].0, PyArray1::from_vec(py, t_s))?;
        arrays.set_item("line", PyArray1::from_vec(py, self.line))?;
        for ((name, _), column) in NUMBERS[1..].iter().zip(rest) {
            arrays.set_item(name, PyArray1::from_vec(py, column))?;
        }
        arrays.set_item("cutting", PyArray1::from_vec(py, self.cutting))?;
        for ((name, _), columns) in VECTORS.iter().zip(self.vectors) {
            for (axis, column) in AXES.iter().zip(columns).take(self.axes) {
                arrays.set_item(name.replace("{}", axis), PyArray1::from_vec(py, column))?;
            }
        }
        Ok(arrays)
    }
}

impl Sink for RowColumns {
    fn row(&mut self, row: &Row) -> io::Result<()> {
        self.line.push(row.line);
        self.cutting.push(row.cutting);
        for (column, (_, value)) in self.numbers.iter_mut().zip(NUMBERS) {
            column.push(value(row));
        }
        for (columns, (_, vector)) in self.vectors.iter_mut().zip(VECTORS) {
            for (column, value) in columns.iter_mut().zip(vector(row)).take(self.axes) {
                column.push(value);
            }
        }
        Ok(())
    }
}
