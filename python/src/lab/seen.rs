//! Inputs of a controller in Python: the window and the measurement of the library, as copies that
//! outlive the feed period.

use feedwright::control::{Knot, Measured, Window};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

/// Returns a vector as three numbers; a vector of two axes gets a zero at its end.
pub(super) fn in_three<const N: usize>(vector: [f64; N]) -> [f64; 3] {
    std::array::from_fn(|i| vector.get(i).copied().unwrap_or(0.0))
}

/// Returns the first N of three numbers.
pub(super) fn of_three<const N: usize>(vector: [f64; 3]) -> [f64; N] {
    std::array::from_fn(|i| vector[i])
}

/// Returns a read-only array, so that nobody takes it for a way to change the run.
pub(super) fn vector<'py>(py: Python<'py>, values: &[f64]) -> Bound<'py, PyArray1<f64>> {
    let array = PyArray1::from_slice(py, values);
    // No other code has the array yet.
    let _ = array
        .try_readwrite()
        .map(numpy::PyReadwriteArray::make_nonwriteable);
    array
}

/// Measurement at the start of a feed period.
#[pyclass(frozen, name = "Measurement", module = "feedwright.lab")]
#[derive(Clone, Copy)]
pub(crate) struct MeasuredTool {
    axes: usize,
    position_mm: [f64; 3],
    error_mm: [f64; 3],
    tangent: [f64; 3],
    behind: u32,
}

impl MeasuredTool {
    pub(super) fn of<const N: usize>(measured: &Measured<N>) -> Self {
        Self {
            axes: N,
            position_mm: in_three(measured.position_mm),
            error_mm: in_three(measured.contour.vector_mm),
            tangent: in_three(measured.contour.tangent),
            behind: measured.contour.index.min(0).unsigned_abs(),
        }
    }
}

#[pymethods]
impl MeasuredTool {
    /// Position of the tool, mm.
    #[getter]
    fn position_mm<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, &self.position_mm[..self.axes])
    }

    /// Vector from the tool to the nearest point of the path, mm.
    #[getter]
    fn contour_error_mm<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, &self.error_mm[..self.axes])
    }

    /// Direction of travel at the nearest point.
    #[getter]
    fn tangent<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, &self.tangent[..self.axes])
    }

    /// Number of servo periods by which the nearest point is behind the current point.
    #[getter]
    fn behind(&self) -> u32 {
        self.behind
    }
}

/// Copy of a window; the rows are the current point and the points of the preview.
#[derive(Clone)]
pub(crate) struct SeenWindow {
    axes: usize,
    plan_s: f64,
    servo_s: f64,
    feed_period_s: f64,
    path_mm: Vec<f64>,
    tangent: Vec<f64>,
    feed_mm_s: Vec<f64>,
    cutting: Vec<bool>,
    offset_mm: [f64; 3],
    offset_mm_s: [f64; 3],
    measured: Option<MeasuredTool>,
}

impl SeenWindow {
    /// Copies a window with `preview` feed periods of preview.
    pub(super) fn of<const N: usize>(
        window: &Window<'_, N>,
        measured: Option<&Measured<N>>,
        preview: u32,
    ) -> Self {
        let knots: Vec<Knot<N>> = (0..=preview as usize)
            .map(|ahead| {
                if ahead == 0 {
                    window.now()
                } else {
                    window.ahead(ahead)
                }
            })
            .collect();
        Self {
            axes: N,
            plan_s: window.tau_s,
            servo_s: window.servo_s(),
            feed_period_s: window.feed_period_s,
            path_mm: knots.iter().flat_map(|knot| knot.position_mm).collect(),
            tangent: knots.iter().flat_map(|knot| knot.tangent).collect(),
            feed_mm_s: knots.iter().map(|knot| knot.feed_mm_s).collect(),
            cutting: knots.iter().map(|knot| knot.cutting).collect(),
            offset_mm: in_three(window.offset_mm),
            offset_mm_s: in_three(window.offset_mm_s),
            measured: measured.map(MeasuredTool::of),
        }
    }
}

/// Inputs of a controller at the start of a feed period.
#[pyclass(frozen, name = "Window", module = "feedwright.lab")]
pub(crate) struct PythonWindow {
    pub(super) seen: SeenWindow,
    pub(super) axes: Py<PyTuple>,
}

impl PythonWindow {
    fn rows<'py>(&self, py: Python<'py>, values: &[f64]) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let columns = self.seen.axes;
        vector(py, values).reshape([values.len() / columns, columns])
    }
}

#[pymethods]
impl PythonWindow {
    /// Time in the feed plan, s.
    #[getter]
    fn plan_s(&self) -> f64 {
        self.seen.plan_s
    }

    /// Servo period, s.
    #[getter]
    fn servo_s(&self) -> f64 {
        self.seen.servo_s
    }

    /// Feed period, s.
    #[getter]
    fn feed_period_s(&self) -> f64 {
        self.seen.feed_period_s
    }

    /// Programmed path now and in the next feed periods at the planned feedrate, mm.
    #[getter]
    fn path_mm<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.rows(py, &self.seen.path_mm)
    }

    /// Direction of travel of the path.
    #[getter]
    fn tangent<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.rows(py, &self.seen.tangent)
    }

    /// Planned feedrate of the path, mm/s.
    #[getter]
    fn feed_mm_s<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, &self.seen.feed_mm_s)
    }

    /// True where the path cuts.
    #[getter]
    fn cutting<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_slice(py, &self.seen.cutting)
    }

    /// Offset of the command from the path now, mm.
    #[getter]
    fn offset_mm<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, &self.seen.offset_mm[..self.seen.axes])
    }

    /// Speed of this offset, mm/s.
    #[getter]
    fn offset_mm_s<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        vector(py, &self.seen.offset_mm_s[..self.seen.axes])
    }

    /// Known values of each axis.
    #[getter]
    fn axes(&self, py: Python<'_>) -> Py<PyTuple> {
        self.axes.clone_ref(py)
    }

    /// Measurement; none if the position was lost.
    #[getter]
    fn measured(&self) -> Option<MeasuredTool> {
        self.seen.measured
    }
}
