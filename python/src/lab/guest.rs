//! A controller and a term of the plant that are objects of Python.

use std::sync::Arc;

use feedwright::control::{Command, Controller, Measured, PREVIEW_KNOTS, Schedule, Window};
use feedwright::sim::{BoxedController, Machine, Measurement, Mechanism, Plant};
use feedwright::{Make, Setup};
use miette::miette;
use numpy::{PyReadonlyArray1, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::raised::Raised;
use super::seen::{PythonWindow, SeenWindow, of_three, vector};
use crate::fault::exception;

/// Returns a number for each axis, and zeros after them.
pub(super) fn numbers(value: &Bound<'_, PyAny>, axes: usize, what: &str) -> PyResult<[f64; 3]> {
    let given: Option<Vec<f64>> = match value.extract::<PyReadonlyArray1<'_, f64>>() {
        Ok(array) if array.ndim() == 1 => Some(array.as_array().iter().copied().collect()),
        _ => value.extract().ok(),
    };
    match given {
        Some(given) if given.len() == axes => Ok(std::array::from_fn(|i| {
            given.get(i).copied().unwrap_or(0.0)
        })),
        _ => Err(exception(&miette!(
            "{what} must be {axes} numbers, one for each axis, and is {}",
            value.repr()?
        ))),
    }
}

/// Returns the schedule of a controller: its feed period and its preview.
pub(super) fn schedule(servo_periods: u32, preview: u32) -> PyResult<Schedule> {
    let reach = u64::from(servo_periods) * u64::from(preview);
    if servo_periods == 0 || reach > PREVIEW_KNOTS as u64 {
        return Err(exception(&miette!(
            help = "a feed period has at least 1 servo period, and the preview reaches {PREVIEW_KNOTS} servo periods at the most",
            "servo_periods is {servo_periods} and preview is {preview}: that is {reach} servo periods ahead"
        )));
    }
    Ok(Schedule {
        servo_periods,
        preview,
    })
}

/// Controller that is an object of Python.
#[derive(Clone)]
pub(super) struct PythonController {
    schedule: Schedule,
    reset: Arc<Py<PyAny>>,
    command: Arc<Py<PyAny>>,
    observe: Option<Arc<Py<PyAny>>>,
    axes: Arc<Py<PyTuple>>,
    raised: Raised,
}

impl PythonController {
    /// Creates the controller of an object. Passes the known values of the axes to the object
    /// before the object states its preview.
    pub(super) fn new(
        object: &Bound<'_, PyAny>,
        axes: &Bound<'_, PyTuple>,
        servo_s: f64,
        raised: Raised,
    ) -> PyResult<Self> {
        if let Some(prepare) = object.getattr_opt("prepare")? {
            prepare.call1((axes, servo_s))?;
        }
        let number = |name: &str| object.getattr(name)?.extract::<u32>();
        let method = |name: &str| object.getattr(name).map(|method| method.unbind().into());
        Ok(Self {
            schedule: schedule(number("servo_periods")?, number("preview")?)?,
            reset: method("reset")?,
            command: method("command")?,
            observe: object
                .getattr_opt("observe")?
                .map(|method| method.unbind().into()),
            axes: axes.clone().unbind().into(),
            raised,
        })
    }

    fn window<'py, const N: usize>(
        &self,
        py: Python<'py>,
        window: &Window<'_, N>,
        measured: Option<&Measured<N>>,
    ) -> PyResult<Bound<'py, PythonWindow>> {
        let seen = SeenWindow::of(window, measured, self.schedule.preview);
        Bound::new(
            py,
            PythonWindow {
                seen,
                axes: self.axes.clone_ref(py),
            },
        )
    }
}

impl<const N: usize> Controller<N> for PythonController {
    fn schedule(&self) -> Schedule {
        self.schedule
    }

    fn reset(&mut self) {
        self.raised.call(|py| self.reset.call0(py));
    }

    fn observe(&mut self, window: &Window<'_, N>, measured: Option<&Measured<N>>) {
        let Some(observe) = &self.observe else { return };
        self.raised.call(|py| {
            let shown = self.window(py, window, measured)?;
            let measured = shown.getattr("measured")?;
            observe.call1(py, (shown, measured))
        });
    }

    fn command(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N> {
        let wanted = self.raised.call(|py| {
            let answer = self.command.bind(py).call1((self.window(py, window, Some(measured))?,))?;
            let Ok((rate, offset)) = answer.extract::<(f64, Bound<'_, PyAny>)>() else {
                return Err(exception(&miette!(
                    help = "feed is a multiple of the planned feedrate, offset has mm for each axis: return 1.0, [0.0, 0.0]",
                    "command must return (feed, offset), and returned {}",
                    answer.repr()?
                )));
            };
            Ok(Command::straight(rate, of_three(numbers(&offset, N, "the offset that command returns")?)))
        });
        wanted.unwrap_or(Command::AS_PLANNED)
    }
}

impl Make for PythonController {
    fn make(&self, _: &mut Setup<'_>, axes: usize) -> BoxedController {
        match axes {
            2 => BoxedController::Plane(Box::new(self.clone())),
            _ => BoxedController::Space(Box::new(self.clone())),
        }
    }
}

/// Torque that a function of Python adds to the torque of the machine.
#[derive(Clone)]
pub(super) struct PlantTerm {
    pub(super) function: Arc<Py<PyAny>>,
    pub(super) raised: Raised,
}

impl PlantTerm {
    /// Returns the plant of a machine with this term.
    pub(super) fn plant(
        &self,
        machine: &Machine,
        axes: usize,
        start_mm: [f64; 3],
        seed: u64,
    ) -> Box<dyn Mechanism> {
        match axes {
            2 => Box::new(PlantWithTerm::<2>::new(
                self.clone(),
                machine,
                start_mm,
                seed,
            )),
            _ => Box::new(PlantWithTerm::<3>::new(
                self.clone(),
                machine,
                start_mm,
                seed,
            )),
        }
    }

    /// Returns the torque of the next servo period, N m.
    fn torque_nm<const N: usize>(
        &self,
        position_mm: [f64; N],
        speed_mm_s: [f64; N],
        t_s: f64,
    ) -> [f64; N] {
        let torque_nm = self.raised.call(|py| {
            let arguments = (vector(py, &position_mm), vector(py, &speed_mm_s), t_s);
            let answer = self.function.bind(py).call1(arguments)?;
            let torque_nm = numbers(&answer, N, "the torque that plant_term returns")?;
            if torque_nm.iter().all(|torque| torque.is_finite()) {
                return Ok(torque_nm);
            }
            Err(exception(&miette!(
                "plant_term returned {} N m at {t_s} s, which no axis can have",
                answer.repr()?
            )))
        });
        of_three(torque_nm.unwrap_or([0.0; 3]))
    }
}

/// Axes of a machine with a term.
struct PlantWithTerm<const N: usize> {
    plant: Plant<N>,
    term: PlantTerm,
    servo_s: f64,
    periods: u64,
    joint_mm: [f64; N],
}

impl<const N: usize> PlantWithTerm<N> {
    fn new(term: PlantTerm, machine: &Machine, start_mm: [f64; 3], seed: u64) -> Self {
        let joint_mm = of_three(start_mm);
        let plant = Plant::with_seed(machine, joint_mm, seed);
        Self {
            plant,
            term,
            servo_s: machine.period.servo_s,
            periods: 0,
            joint_mm,
        }
    }
}

impl<const N: usize> Mechanism for PlantWithTerm<N> {
    fn step(&mut self, command_mm: [f64; 3]) -> Measurement<3> {
        let t_s = self.periods as f64 * self.servo_s;
        self.plant.add_torque(
            self.term
                .torque_nm(self.joint_mm, self.plant.joint_mm_s(), t_s),
        );
        self.periods += 1;
        let moved = Mechanism::step(&mut self.plant, command_mm);
        self.joint_mm = of_three(moved.joint_mm);
        moved
    }

    fn skip(&mut self, periods: u64) {
        self.periods += periods;
        self.plant.skip(periods);
    }

    fn has_geometry(&self) -> bool {
        self.plant.has_geometry()
    }
}
