//! The part of the tool's tolerance that the planned path may use: the remainder that the machine
//! does not need.

use feedwright_gcode::ReadError;
use feedwright_plan::Steps;
use feedwright_sim::{BoxedController, Machine, Watch};

use super::path_grid::PathGrid;
use super::{FIRST_SHARE, FastestError, SPACING_MM, Search};

/// Largest number of cuts in a search.
const CUTS: u32 = 6;

/// Largest and smallest tolerance of the path, um: beyond a tenth of a millimeter a path gains
/// hardly any time and loses its shape.
const MOST_UM: f64 = 100.0;
const LEAST_UM: f64 = 0.01;

/// Margin of the next path to the tolerance, as a fraction of the tolerance.
const SPARE: f64 = 0.01;

/// A plan at the programmed feedrates whose cut stays within a tolerance of the tool.
#[derive(Debug, Clone)]
pub struct TolerancePlan {
    /// The machine with the tolerance of the path.
    pub(crate) machine: Machine,
    /// Tolerance of the path, um.
    pub(crate) path_um: f64,
}

/// Shares a tolerance of the tool between the planned path and the predicted error of the machine:
/// the path gets as much as lets a cut stay within it. Arguments as in
/// [`fastest()`](super::fastest). `None` where the machine needs all of the tolerance at these
/// feedrates.
///
/// # Errors
/// A run that does not come to its end.
pub(crate) fn plan_within<'p>(
    machine: &Machine,
    tolerance_um: f64,
    mut steps: impl FnMut() -> Result<Steps<'p>, ReadError>,
    controller: &mut BoxedController,
    laps: u32,
    watch: &dyn Watch,
) -> Result<Option<TolerancePlan>, FastestError> {
    let grid = PathGrid::of(steps().map_err(feedwright_sim::RunError::from)?, SPACING_MM);
    let mut search = Search::new(
        machine,
        tolerance_um,
        grid,
        "looking for the tolerance of the path",
    );
    let mut share = FIRST_SHARE.min(MOST_UM / tolerance_um);
    for _ in 0..CUTS {
        if share * tolerance_um < LEAST_UM {
            break;
        }
        search.cut(share, &mut steps, controller, laps, watch)?;
        if search.best.is_some() || search.diverged {
            break;
        }
        share -= search.worst.0 / tolerance_um - 1.0 + SPARE;
    }
    Ok(search.best.as_ref().map(|cut| TolerancePlan {
        machine: search.planned(cut.share),
        path_um: cut.share * tolerance_um,
    }))
}
