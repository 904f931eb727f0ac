//! Least time within a tolerance of the tool: speed is reduced only where the simulated tool would
//! leave the tolerance.
//!
//! The tolerance of the tool is shared between the planned path and the error of the servo and its
//! controller. The program is planned and cut. From this cut, the error at each place is modeled
//! over the speeds around it, and speeds of least time are found within the tolerance. They bound
//! the next plan, which is cut in turn. Where errors still exceed the tolerance, the aim is
//! lowered. The result is the fastest plan whose cut stayed within the tolerance.
//!
//! | File | What |
//! |---|---|
//! | `fastest/path_grid.rs` | the path at evenly spaced places |
//! | `fastest/cut_places.rs` | results of a cut at these places |
//! | `fastest/steepness.rs` | steepness of errors over speeds |
//! | `fastest/error_model.rs` | errors at other speeds |
//! | `fastest/speed_profile.rs` | speeds of least time by that model |
//! | `fastest/tightening.rs` | bounds for the next cut |
//! | `fastest/remaining_error.rs` | test whether lower speeds help |
//! | `fastest/path_share.rs` | the tolerance of the path alone, at the programmed speeds |

mod path_grid;
mod cut_places;
mod steepness;
mod error_model;
mod speed_profile;
mod tightening;
mod remaining_error;
mod path_share;

use std::sync::Arc;

use feedwright_gcode::ReadError;
use feedwright_gcode::canon::Corner;
use feedwright_plan::{Constraints, SpeedCaps, Step, Steps};
use feedwright_sim::cycle_time::{CycleTime, cycle_time_within};
use feedwright_sim::{BoxedController, Machine, Outcome, Run, RunError, Watch};
use thiserror::Error;

use cut_places::CutPlaces;
use path_grid::PathGrid;
pub(crate) use path_share::{TolerancePlan, plan_within};
use remaining_error::RemainingError;
use tightening::{LOWEST_MM_S, Tightening};

/// Distance of bounds along the path, mm.
const SPACING_MM: f64 = 0.1;

/// Largest number of cuts with one share of the path, and number of cuts within the tolerance
/// without a gain after which the search ends.
const ROUNDS: u32 = 24;
const NO_GAIN: u32 = 3;

/// Smallest reduction of the time that counts as a gain, as a fraction of the time.
const LEAST_GAIN: f64 = 1e-3;

/// First cut after which the aim is lowered where errors exceed the tolerance. In earlier cuts,
/// errors exceed it because speeds still change.
const AIM_LOWER: u32 = 8;

/// Initial part of the tolerance for the path.
const FIRST_SHARE: f64 = 0.9;

/// Shares of the tolerance for the path if the controller's error is large; that error is smaller
/// at lower speed. A large share costs speed everywhere; a small one costs speed at corners and
/// chords. [`TRIED`] cuts with the first share show which matters more. If something other than the
/// error bounds the speed for less than [`HELD_PART`] of the time, the path gets [`LITTLE_SHARE`];
/// otherwise it gets more, as long as that gains time.
const MUCH_SHARES: [f64; 5] = [0.03, 0.1, 0.3, 0.6, FIRST_SHARE];
const LITTLE_SHARE: f64 = 0.01;
const TRIED: u32 = 5;
const HELD_PART: f64 = 0.3;

/// Largest error of the first cut, in tolerances, below which the controller's error counts as
/// small. Below it, that error gives the share of the path. From it on, the search begins with the
/// smallest of [`MUCH_SHARES`].
const LITTLE: f64 = 1.6;

/// An error above this many tolerances is far beyond the tolerance.
const BEYOND: f64 = 1.1;
/// The search with one share ends after this many cuts in a row that are far beyond the tolerance
/// and come no nearer to it. Cuts before [`AIM_LOWER`] do not count.
const NO_NEARER: u32 = 4;
/// A cut comes nearer if its error is below the smallest one so far by more than this fraction.
const NEARER: f64 = 0.03;

/// A plan within the tolerance.
#[derive(Debug, Clone)]
pub struct FastestPlan {
    /// The machine with the tolerance of the path.
    pub machine: Machine,
    /// Bounds on the speed.
    pub(crate) caps: Arc<SpeedCaps>,
    /// Largest distance of the tool from the path, um.
    pub largest_um: f64,
    /// Cycle time of the plan and the limits that bind. `bound_s` is the time of a plan that gives
    /// the path the whole tolerance and has no speed caps.
    pub cycle: CycleTime,
    /// Number of times that the program was planned and cut.
    pub rounds: u32,
}

/// Reason why [`fastest`] finds no plan.
#[derive(Debug, Error, miette::Diagnostic)]
pub enum FastestError {
    /// The tool is too far away at any speed.
    #[error(
        "line {line}: the tool is {error_um:.2} um away, and {tolerance_um} um are allowed; {reason}"
    )]
    Impossible {
        /// Line with the largest distance.
        line: u32,
        /// Largest distance, um.
        error_um: f64,
        /// Allowed distance, um.
        tolerance_um: f64,
        /// Reason.
        reason: &'static str,
    },
    /// A run did not come to its end.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Run(#[from] RunError),
}

/// Finds the fastest plan of a program that a controller cuts within a tolerance on a machine;
/// `laps` as in [`Run::laps`].
///
/// # Errors
/// See [`FastestError`].
pub fn fastest<'p>(
    machine: &Machine,
    tolerance_um: f64,
    mut steps: impl FnMut() -> Result<Steps<'p>, ReadError>,
    controller: &mut BoxedController,
    laps: u32,
    watch: &dyn Watch,
) -> Result<FastestPlan, FastestError> {
    let grid = PathGrid::of(steps().map_err(RunError::from)?, SPACING_MM);
    let mut search = Search::new(machine, tolerance_um, grid, "looking for the least time");
    let mut cut = |search: &mut Search<'_>, share: f64| {
        search.cut(share, &mut steps, controller, laps, watch)
    };
    let first = cut(&mut search, FIRST_SHARE)?;
    let error = first.worst().0 / tolerance_um;
    if error > 1.0 && !search.diverged {
        search.over_shares(error, &mut cut)?;
    }
    let Some(found) = search.best.take() else {
        return Err(search.impossible());
    };
    search.plan_of(found, &mut steps, watch)
}

/// A cut within the tolerance.
#[derive(Debug)]
struct FastestCut {
    time_s: f64,
    error_um: f64,
    share: f64,
    caps: Arc<SpeedCaps>,
}

/// State of the search, and the best cut so far.
struct Search<'a> {
    machine: &'a Machine,
    tolerance_um: f64,
    grid: PathGrid,
    /// Name of the stage in the progress.
    stage: &'static str,
    tightening: Tightening,
    caps: Arc<SpeedCaps>,
    /// Part of the time in which something other than the error bounds the speed.
    held_part: f64,
    best: Option<FastestCut>,
    rounds: u32,
    diverged: bool,
    /// True where the error stays at any speed.
    hopeless: bool,
    /// Time of the last cut, s, its largest error, um, and the line of that error.
    time_s: f64,
    worst: (f64, u32),
}

impl<'a> Search<'a> {
    fn new(machine: &'a Machine, tolerance_um: f64, grid: PathGrid, stage: &'static str) -> Self {
        Self {
            stage,
            machine,
            tolerance_um,
            tightening: Tightening::new(1e-3 * tolerance_um, grid.len()),
            caps: Arc::new(SpeedCaps::none(grid.spacing_mm)),
            grid,
            held_part: 1.0,
            best: None,
            rounds: 0,
            diverged: false,
            hopeless: false,
            time_s: 0.0,
            worst: (0.0, 0),
        }
    }

    /// Returns the machine, with a share of the tolerance for the path.
    fn planned(&self, share: f64) -> Machine {
        self.machine.planned_by_axes(share * self.tolerance_um)
    }

    fn best_s(&self) -> f64 {
        self.best.as_ref().map_or(f64::INFINITY, |best| best.time_s)
    }

    /// Plans within the current bounds, and cuts.
    fn cut<'p>(
        &mut self,
        share: f64,
        steps: &mut impl FnMut() -> Result<Steps<'p>, ReadError>,
        controller: &mut BoxedController,
        laps: u32,
        watch: &dyn Watch,
    ) -> Result<CutPlaces, FastestError> {
        watch.check().map_err(RunError::from)?;
        self.rounds += 1;
        watch.begin(&format!("{}, cut {}", self.stage, self.rounds), 1);
        let planned = self.planned(share);
        let mut places = CutPlaces::new(self.grid.spacing_mm, self.grid.len());
        let path_mm = 1e-3 * share * self.tolerance_um;
        let run = Run::on(&planned)
            .within_drives()
            .capped(Some(&self.caps))
            .laps(laps)
            .watched(watch)
            .cut_boxed(
                &mut || Ok(with_tolerance(steps()?, path_mm)),
                controller,
                &mut [&mut places],
            )?;
        self.diverged = run.outcome != Outcome::Completed;
        self.worst = places.worst();
        let (time_s, error_um) = (run.time_s, self.worst.0);
        self.time_s = time_s;
        if !self.diverged && error_um <= self.tolerance_um && time_s < self.best_s() {
            self.best = Some(FastestCut {
                time_s,
                error_um,
                share,
                caps: self.caps.clone(),
            });
        }
        Ok(places)
    }

    /// Searches for the least time over several shares of the tolerance for the path. `error` is
    /// the largest error of the first cut, made with [`FIRST_SHARE`], in tolerances.
    fn over_shares(
        &mut self,
        error: f64,
        cut: &mut impl FnMut(&mut Self, f64) -> Result<CutPlaces, FastestError>,
    ) -> Result<(), FastestError> {
        if error < LITTLE {
            // The path gets the part that the servo did not need, or else it keeps its share.
            let needed = (1.0 - (error - FIRST_SHARE)).max(LITTLE_SHARE);
            return self.over([needed, FIRST_SHARE], cut);
        }
        self.descend(MUCH_SHARES[0], TRIED, cut)?;
        match self.held_part {
            _ if self.hopeless => Ok(()),
            held_part if held_part < HELD_PART => self.over([LITTLE_SHARE], cut),
            _ => self.over_much_shares(cut),
        }
    }

    /// Increases the share of the path, as long as that gains time.
    fn over_much_shares(
        &mut self,
        cut: &mut impl FnMut(&mut Self, f64) -> Result<CutPlaces, FastestError>,
    ) -> Result<(), FastestError> {
        let mut next = Some(MUCH_SHARES[0]);
        while let Some(share) = next {
            let before_s = if share > MUCH_SHARES[0] {
                self.best_s()
            } else {
                f64::INFINITY
            };
            if !self.gains(share, before_s, cut)? {
                break;
            }
            next = self.larger_share(share);
        }
        Ok(())
    }

    /// Returns the next share of the path: this share plus the unused part of the tolerance, if
    /// that sum is less than the next fixed share.
    fn larger_share(&self, share: f64) -> Option<f64> {
        let next = MUCH_SHARES.into_iter().find(|&next| next > share)?;
        let left = self
            .best
            .as_ref()
            .map_or(0.0, |best| 1.0 - best.error_um / self.tolerance_um);
        Some(if left > LITTLE_SHARE {
            next.min(share + left)
        } else {
            next
        })
    }

    const fn ends(&self) -> bool {
        self.diverged || self.hopeless
    }

    /// Searches with one share after the other, as long as that gains time.
    fn over<const K: usize>(
        &mut self,
        shares: [f64; K],
        cut: &mut impl FnMut(&mut Self, f64) -> Result<CutPlaces, FastestError>,
    ) -> Result<(), FastestError> {
        for share in shares {
            if !self.gains(share, self.best_s(), cut)? {
                break;
            }
        }
        Ok(())
    }

    /// Searches with a share. Returns true if that has gained time over `before_s`, and another
    /// share may gain more.
    fn gains(
        &mut self,
        share: f64,
        before_s: f64,
        cut: &mut impl FnMut(&mut Self, f64) -> Result<CutPlaces, FastestError>,
    ) -> Result<bool, FastestError> {
        self.descend(share, ROUNDS, cut)?;
        let gained = !before_s.is_finite() || self.best_s() <= (1.0 - LEAST_GAIN) * before_s;
        Ok(gained && !self.ends())
    }

    /// Cuts with one share of the path, at most `rounds` times, and sets new speed bounds after
    /// each cut. Stops early when cuts gain no more time or come no nearer to the tolerance.
    fn descend(
        &mut self,
        share: f64,
        rounds: u32,
        cut: &mut impl FnMut(&mut Self, f64) -> Result<CutPlaces, FastestError>,
    ) -> Result<(), FastestError> {
        let known_s = self.best_s();
        let (mut since, mut nearest_um, mut no_nearer) = (0, f64::INFINITY, 0);
        let mut remaining = RemainingError::default();
        for _ in 0..rounds {
            let before_s = self.best_s();
            let places = cut(self, share)?;
            let (lowers, error_um) = (self.rounds >= AIM_LOWER, self.worst.0);
            if error_um <= self.tolerance_um {
                since = if self.best_s() < (1.0 - LEAST_GAIN) * before_s {
                    0
                } else {
                    since + 1
                };
            }
            let near =
                error_um < BEYOND * self.tolerance_um || error_um < (1.0 - NEARER) * nearest_um;
            no_nearer = if near || !lowers { 0 } else { no_nearer + 1 };
            nearest_um = nearest_um.min(error_um);
            self.hopeless =
                self.best.is_none() && remaining.take_in(&places, 1e-3 * self.tolerance_um);
            let slower = lowers && self.time_s > known_s;
            if self.ends() || slower || since >= NO_GAIN || no_nearer >= NO_NEARER {
                break;
            }
            if lowers {
                self.tightening.aim_lower(&places, self.grid.spacing_mm);
            }
            let next = self
                .tightening
                .caps(&self.grid, &places, &self.caps, self.rounds);
            self.held_part = next.held_part;
            if error_um <= self.tolerance_um && next.caps == *self.caps {
                break;
            }
            self.caps = Arc::new(next.caps);
        }
        Ok(())
    }

    /// Returns the error with the reason why there is no plan.
    fn impossible(&self) -> FastestError {
        let (error_um, line) = self.worst;
        let reason = if self.diverged {
            "the servo loop is unstable"
        } else if self.hopeless || self.caps.caps_mm_s.iter().any(|&cap| cap <= LOWEST_MM_S) {
            "that is no matter of speed: noise, friction or geometry takes it there"
        } else {
            "lower speeds brought it no nearer"
        };
        FastestError::Impossible {
            line,
            error_um,
            tolerance_um: self.tolerance_um,
            reason,
        }
    }

    /// Builds the plan of a cut, with its cycle time.
    fn plan_of<'p>(
        &self,
        found: FastestCut,
        steps: &mut impl FnMut() -> Result<Steps<'p>, ReadError>,
        watch: &dyn Watch,
    ) -> Result<FastestPlan, FastestError> {
        let FastestCut {
            error_um,
            share,
            caps,
            ..
        } = found;
        let mut cycle_of =
            |machine: &Machine, constraints: &Constraints, share: f64, bound: bool| {
                let path_mm = 1e-3 * share * self.tolerance_um;
                cycle_time_within(
                    machine,
                    constraints,
                    bound,
                    || Ok(with_tolerance(steps()?, path_mm)),
                    watch,
                )
            };
        let (planned, whole) = (self.planned(share), self.planned(1.0));
        let constraints = Constraints {
            speed_caps: Some(caps.clone()),
            ..Constraints::from(&planned)
        };
        let mut cycle = cycle_of(&planned, &constraints, share, false)?;
        cycle.bound_s = cycle_of(&whole, &Constraints::from(&whole), 1.0, true)?.bound_s;
        Ok(FastestPlan {
            machine: planned,
            caps,
            largest_um: error_um,
            cycle,
            rounds: self.rounds,
        })
    }
}

/// Returns the same path with another tolerance, except where the path must be followed exactly.
pub(crate) fn with_tolerance<'p>(steps: Steps<'p>, tolerance_mm: f64) -> Steps<'p> {
    Box::new(steps.map(move |step| {
        step.map(|step| match step {
            Step::Piece(mut piece) => {
                if matches!(piece.corner, Corner::Continuous { .. }) {
                    piece.corner = Corner::Continuous {
                        tolerance_mm: Some(tolerance_mm),
                        merge_mm: None,
                    };
                }
                Step::Piece(piece)
            }
            other => other,
        })
    }))
}
