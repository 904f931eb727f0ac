//! What `--columns` says: which column is what, and what the file does not say of its units.
//!
//! ```text
//! t=0,x.cmd=1,x.act=3,x.torque=5          by number, from 0
//! t=t,x.cmd=qg,x.act=qm,x.torque=vir      by name
//! x.act=POSF X,x.err=ERR X                command as the sum of actual position and following error
//! unit=mm,time=ms,period_s=0.001          units; time between samples where there is no column of it
//! ```

use std::str::FromStr;

use feedwright_gcode::suggestion::nearest;
use miette::Diagnostic;
use thiserror::Error;

use super::MAX_AXES;
use super::units::{PositionUnit, TimeUnit};

/// A column by number, from 0, or by name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ColumnChoice(pub(crate) String);

/// The columns of one axis, as far as they are said.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct AxisChoice {
    /// Name of the axis.
    pub(crate) name: String,
    /// Its command.
    pub(crate) command: Option<ColumnChoice>,
    /// Its actual position.
    pub(crate) actual: Option<ColumnChoice>,
    /// Its command minus its actual position, in place of the command.
    pub(crate) error: Option<ColumnChoice>,
    /// Its torque.
    pub(crate) torque: Option<ColumnChoice>,
}

/// Assignment of the columns of a log; the rest is guessed.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Columns {
    /// Column of the time.
    pub(crate) time: Option<ColumnChoice>,
    /// Axes; where there is one, the others of the file are left out.
    pub(crate) axes: Vec<AxisChoice>,
    /// Unit of the positions.
    pub(crate) position_unit: Option<PositionUnit>,
    /// Unit of the time.
    pub(crate) time_unit: Option<TimeUnit>,
    /// Time between samples, s.
    pub(crate) sample_time_s: Option<f64>,
}

/// Error in `--columns`.
#[derive(Debug, Clone, PartialEq, Eq, Error, Diagnostic)]
#[error("--columns: '{item}': {message}")]
pub struct ColumnsError {
    /// The part of it that is wrong.
    pub(crate) item: String,
    /// Description of the error.
    pub(crate) message: String,
    /// Remedy.
    #[help]
    pub hint: String,
}

/// Example for messages.
const EXAMPLE: &str =
    "such as t=0,x.cmd=1,x.act=3,x.torque=5; columns by number from 0, or by name";
/// Keys that may stand before `=`.
const KEYS: [&str; 4] = ["t", "unit", "time", "period_s"];
/// Names that may follow the name of an axis.
const PARTS: [&str; 4] = ["cmd", "act", "err", "torque"];

impl FromStr for Columns {
    type Err = ColumnsError;

    fn from_str(text: &str) -> Result<Self, ColumnsError> {
        let mut columns = Self::default();
        for item in text
            .split(',')
            .map(str::trim)
            .filter(|item| !item.is_empty())
        {
            columns.add(item)?;
        }
        for axis in &columns.axes {
            let command = axis.command.as_ref().or(axis.error.as_ref());
            for (part, column) in [("cmd", command), ("act", axis.actual.as_ref())] {
                if column.is_none() {
                    let item = axis.name.clone();
                    let message = format!("no {part} of this axis");
                    return Err(ColumnsError {
                        item,
                        message,
                        hint: format!("add {}.{part}=COLUMN", axis.name),
                    });
                }
            }
        }
        Ok(columns)
    }
}

impl Columns {
    fn add(&mut self, item: &str) -> Result<(), ColumnsError> {
        let fault = |message: String, hint: String| ColumnsError {
            item: item.to_owned(),
            message,
            hint,
        };
        let Some((key, value)) = item
            .split_once('=')
            .map(|(key, value)| (key.trim(), value.trim()))
        else {
            return Err(fault("no '='".to_owned(), EXAMPLE.to_owned()));
        };
        if value.is_empty() {
            return Err(fault("nothing behind '='".to_owned(), EXAMPLE.to_owned()));
        }
        let column = || ColumnChoice(value.to_owned());
        let twice = || fault(format!("{key} is said twice"), "say it once".to_owned());
        match key {
            "t" => set(&mut self.time, column()).ok_or_else(twice),
            "unit" => {
                let unit = PositionUnit::from_name(value).ok_or_else(|| {
                    fault(
                        format!("no unit of length is called '{value}'"),
                        PositionUnit::KNOWN.to_owned(),
                    )
                })?;
                set(&mut self.position_unit, unit).ok_or_else(twice)
            }
            "time" => {
                let unit = TimeUnit::from_name(value).ok_or_else(|| {
                    fault(
                        format!("no unit of time is called '{value}'"),
                        TimeUnit::KNOWN.to_owned(),
                    )
                })?;
                set(&mut self.time_unit, unit).ok_or_else(twice)
            }
            "period_s" => match value.parse::<f64>() {
                Ok(period_s) if period_s.is_finite() && period_s > 0.0 => {
                    set(&mut self.sample_time_s, period_s).ok_or_else(twice)
                }
                _ => Err(fault(
                    "a time above zero is needed, s".to_owned(),
                    "such as period_s=0.001".to_owned(),
                )),
            },
            _ => self
                .add_axis(key, column())
                .map_err(|(message, hint)| fault(message, hint)),
        }
    }

    fn add_axis(&mut self, key: &str, column: ColumnChoice) -> Result<(), (String, String)> {
        let Some((name, part)) = key.rsplit_once('.').filter(|(name, _)| !name.is_empty()) else {
            let hint = nearest(key, &KEYS).map(|near| format!("did you mean '{near}'?"));
            return Err((
                format!("'{key}' is unknown"),
                hint.unwrap_or_else(|| EXAMPLE.to_owned()),
            ));
        };
        let at = self
            .axes
            .iter()
            .position(|axis| axis.name == name)
            .unwrap_or_else(|| {
                self.axes.push(AxisChoice {
                    name: name.to_owned(),
                    ..AxisChoice::default()
                });
                self.axes.len() - 1
            });
        if at >= MAX_AXES {
            return Err((
                format!("more than {MAX_AXES} axes"),
                "read those that belong together".to_owned(),
            ));
        }
        let axis = &mut self.axes[at];
        let field = match part {
            "cmd" => &mut axis.command,
            "act" => &mut axis.actual,
            "err" => &mut axis.error,
            "torque" => &mut axis.torque,
            _ => {
                let hint =
                    nearest(part, &PARTS).map(|near| format!("did you mean '{name}.{near}'?"));
                let message = format!("an axis has no '{part}', but cmd, act, err and torque");
                return Err((message, hint.unwrap_or_else(|| EXAMPLE.to_owned())));
            }
        };
        set(field, column).ok_or_else(|| (format!("{key} is said twice"), "say it once".to_owned()))
    }
}

/// Sets what is not set yet.
fn set<T>(field: &mut Option<T>, value: T) -> Option<()> {
    if field.is_some() {
        return None;
    }
    *field = Some(value);
    Some(())
}
