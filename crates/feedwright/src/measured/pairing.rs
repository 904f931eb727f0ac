//! Which axis of a log is which axis of the program.

use feedwright_ident::{Log, LogAxis, LogFinding};
use feedwright_plan::vector::Vector;
use feedwright_sim::AXIS_NAMES;

use super::MeasuredError;

/// An axis of the program that goes no further stands still, mm.
const STILL_MM: f64 = 1e-6;

/// Axes of a log in the order of those of the program; none where the log has no record of one that
/// stands still.
pub(super) struct PairedAxes<'a> {
    pub(super) axes: Vec<Option<&'a LogAxis>>,
    pub(super) findings: Vec<LogFinding>,
}

impl<'a> PairedAxes<'a> {
    /// Pairs the axes of a log with the `axes` axes of a program, which moves each over `range_mm`.
    /// Axes pair by name. They pair by order if the log has no axis names, the program leaves an
    /// axis still, and as many axes move in the log as in the program.
    ///
    /// Fails if the log lacks an axis that the program moves.
    pub(super) fn of(log: &'a Log, range_mm: Vector, axes: usize) -> Result<Self, MeasuredError> {
        let moving: Vec<usize> = (0..axes).filter(|&i| range_mm[i] > STILL_MM).collect();
        let has_no_names = log
            .findings
            .iter()
            .any(|f| matches!(f, LogFinding::AxisColumns { by_data: true, .. }));
        let in_order = has_no_names && log.axes.len() == moving.len() && moving.len() < axes;
        let mut paired = Self {
            axes: Vec::new(),
            findings: Vec::new(),
        };
        for (i, name) in AXIS_NAMES.into_iter().enumerate().take(axes) {
            let at = moving.iter().position(|&moved| moved == i);
            let found = match at.filter(|_| in_order) {
                Some(at) => log.axes.get(at),
                None if in_order => None,
                // Joints of LinuxCNC's pins are the axes in their order where its kinematics is
                // trivial.
                None => [name, &format!("joint{i}")].into_iter().find_map(|name| {
                    log.axes
                        .iter()
                        .chain(&log.still)
                        .find(|axis| axis.name.eq_ignore_ascii_case(name))
                }),
            };
            match found {
                Some(axis) if axis.name.eq_ignore_ascii_case(name) => {}
                Some(axis) => {
                    paired.findings.push(LogFinding::TakenFor {
                        axis: axis.name.clone(),
                        program: name.to_owned(),
                    });
                }
                None if at.is_none() => paired.findings.push(LogFinding::TakenAsStill {
                    axis: name.to_owned(),
                }),
                None => {
                    let there = log
                        .axes
                        .iter()
                        .map(|axis| axis.name.as_str())
                        .collect::<Vec<_>>()
                        .join(", ");
                    return Err(MeasuredError::MissingAxis { axis: name, there });
                }
            }
            paired.axes.push(found);
        }
        Ok(paired)
    }
}
