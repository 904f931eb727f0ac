//! Rows of a run: one [`Row`] per servo period, passed to every [`Sink`]. The columns that `--trace`
//! writes of a row are in `trace.rs`.

use feedwright_plan::TimedEvent;
use serde::{Deserialize, Serialize};

/// Kind of motion that the command makes in a servo period. The tool follows some ten milliseconds
/// later.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Commanded {
    /// It moves at a programmed feedrate.
    Cut,
    /// It moves at the machine's rapid rate.
    Rapid,
    /// It rests: in a dwell, or behind the end.
    Rest,
}

/// One servo period of a run. Two-axis runs leave the third component at zero.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Start of the servo period, s.
    pub t_s: f64,
    /// Arc length along the programmed path at `t_s`, mm.
    pub s_mm: f64,
    /// Line of the program whose motion is under way.
    pub line: u32,
    /// Planned feedrate at `s_mm`, mm/s.
    pub feed_plan_mm_s: f64,
    /// Programmed feedrate at the foot, mm/s; 0 on a rapid, and where it is not known. No column of
    /// `--trace`.
    pub programmed_mm_s: f64,
    /// True if the program cuts at the tool: not on a rapid, and not at rest where the tool has
    /// arrived.
    pub cutting: bool,
    /// Kind of motion that the command makes.
    pub commanded: Commanded,
    /// Point of the programmed path at `s_mm`.
    pub path_mm: [f64; 3],
    /// Position command of this servo period, as the servo drive gets it.
    pub cmd_mm: [f64; 3],
    /// Tool position that the compensated geometry gives for joints at `cmd_mm`; without
    /// compensation, `cmd_mm`.
    pub corrected_mm: [f64; 3],
    /// True position of the tool at the end of this servo period.
    pub act_mm: [f64; 3],
    /// Motor torque at the end of this servo period, N m.
    pub torque_nm: [f64; 3],
    /// Foot of `act_mm`: the point of the programmed path that the contour error is measured to.
    pub foot_mm: [f64; 3],
    /// Unit tangent of the path at the foot, in the direction of travel.
    pub tangent: [f64; 3],
    /// Contour error of `act_mm`, mm: from the foot, in the plane
    /// [signed](feedwright_plan::signed_distance_mm), magnitude in space.
    pub contour_error_mm: f64,
}

impl Row {
    /// A row at rest in the origin, on line 1 of a cut along x.
    pub const AT_REST: Self = Self {
        t_s: 0.0,
        s_mm: 0.0,
        line: 1,
        feed_plan_mm_s: 0.0,
        programmed_mm_s: 0.0,
        cutting: true,
        commanded: Commanded::Cut,
        path_mm: [0.0; 3],
        cmd_mm: [0.0; 3],
        corrected_mm: [0.0; 3],
        act_mm: [0.0; 3],
        torque_nm: [0.0; 3],
        foot_mm: [0.0; 3],
        tangent: [1.0, 0.0, 0.0],
        contour_error_mm: 0.0,
    };
}

/// Outcome of a run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum Outcome {
    /// The program was cut to its end.
    #[default]
    Completed,
    /// The servo loop is unstable: the distance of the tool from the command exceeds several times
    /// the lag of a stable loop, or is not a number.
    Diverged {
        /// Time, s.
        at_s: f64,
    },
}

/// The supervisor took the controller out of the loop; the rest was cut uncorrected.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FadedOut {
    /// Time, s.
    pub at_s: f64,
    /// Cause, in words.
    pub cause: &'static str,
}

/// A change of the correction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Transition {
    /// Time, s.
    pub at_s: f64,
    /// Line of the program that was commanded then.
    pub line: u32,
    /// Kind of change.
    pub change: CorrectionChange,
    /// Axis whose model changed, x, y or z; `None` for a change that is not of a model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) axis: Option<char>,
    /// Cause, in words; `None` if the change needs no cause.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) cause: Option<&'static str>,
    /// Measured value that was compared with the limit, um; `None` where nothing was compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) found_um: Option<f64>,
    /// Limit above which the value is a fault, um.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) limit_um: Option<f64>,
}

/// Kind of change of the correction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum CorrectionChange {
    /// The controller left the loop.
    Left,
    /// It is in the loop again.
    Returned,
    /// It goes by the model that it learned of an axis.
    Learned,
    /// It goes by the model that it was given of the axis again.
    Given,
}

impl Transition {
    /// Returns the change in words, without the time.
    pub fn words(&self) -> String {
        let because = |cause: &str| match (self.found_um, self.limit_um) {
            (Some(found_um), Some(limit_um)) => {
                format!(", because {cause}: {found_um:.1} um where {limit_um:.1} are allowed")
            }
            _ => format!(", because {cause}"),
        };
        let because = self.cause.map(because).unwrap_or_default();
        match self.change {
            CorrectionChange::Left => format!("out of the loop{because}"),
            CorrectionChange::Returned => "in the loop again".to_owned(),
            CorrectionChange::Learned => format!(
                "goes by what it learned of {}",
                self.axis.unwrap_or_default()
            ),
            CorrectionChange::Given => format!(
                "goes by the given model of {} again",
                self.axis.unwrap_or_default()
            ),
        }
    }
}

/// Takes the rows of a run in order.
pub trait Sink {
    /// Takes one row.
    ///
    /// # Errors
    /// Where the sink writes to a file that takes no more.
    fn row(&mut self, row: &Row) -> std::io::Result<()>;

    /// Takes an event of the program, at the time at which the command came to it, before the rows
    /// from then on.
    ///
    /// # Errors
    /// As [`Sink::row`].
    fn event(&mut self, t_s: f64, event: &TimedEvent) -> std::io::Result<()> {
        let _ = (t_s, event);
        Ok(())
    }
}

/// Keeps every row.
impl Sink for Vec<Row> {
    fn row(&mut self, row: &Row) -> std::io::Result<()> {
        self.push(*row);
        Ok(())
    }
}
