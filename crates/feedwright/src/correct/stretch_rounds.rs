//! A stretch under way: its commands so far, and their results.

use std::iter;

use feedwright_plan::{ArcFit, FitMotion, FitPoint};

use super::budget::{StretchBudget, StretchCost};
use super::slow_end::SlowEnd;
use super::stretch_cut::StretchCut;
use super::stretches::{StretchCommand, rest_s};
use super::unchanged::UnchangedReason;

/// Cuts without a gain after which a stretch is finished.
const NO_GAIN: u32 = 3;
/// Smallest reduction of a stretch's error figure that counts as a gain, as a fraction of it.
const LEAST_GAIN: f64 = 0.02;
/// A stretch whose largest error is less stays as programmed, mm: this is the distance by which
/// fitted blocks miss a command.
const GOOD_MM: f64 = 1e-3;
/// Distance of blocks from the command, mm: the finest at which the blocks are few enough. The
/// search starts at this part of the RMS error that the blocks are to correct, and no less than
/// [`FINEST_MM`] and a printed step. It gets coarser by the factor [`COARSER`].
const FIT_SHARE: f64 = 0.04;
const FINEST_MM: f64 = 5e-5;
const COARSER: f64 = 1.25;
/// Distances that follow if no finer distance fits, mm, each with a flag: true allows many blocks.
const TOLERANCES_MM: [(f64, bool); 4] = [(1e-3, false), (2e-3, false), (1e-3, true), (4e-3, true)];
/// Factors by which the Gaussian over a command gets wider if the stretch takes too long, least and
/// largest: a command that bends more than the path slows the control down. It is not widened once
/// it has reached [`WIDEST`] times its usual width.
const WIDER: [f64; 2] = [1.15, 1.6];
const WIDEST: f64 = 4.0;

/// A stretch under way.
pub(super) struct StretchRounds {
    pub(super) current: StretchCommand,
    pub(super) best: StretchCommand,
    /// Figure of the best command, mm, and its time, s; at first they belong to the programmed
    /// command.
    pub(super) best_mm: f64,
    pub(super) best_s: f64,
    pub(super) budget: StretchBudget,
    /// The cut of the programmed command.
    pub(super) programmed: StretchCut,
    /// Figure of the programmed command, mm, next to commands that spoil it if they do.
    pub(super) programmed_mm: f64,
    /// Distance of blocks from the command that is small compared with the error that they correct,
    /// mm.
    pub(super) tolerance_mm: f64,
    /// Sum of the squared errors of the best command, mm2.
    pub(super) square_sum_mm2: f64,
    /// Lowest figure of the commands that were tried, mm, and for how many rounds there was no
    /// lower one.
    pub(super) lowest_mm: f64,
    pub(super) since: u32,
    pub(super) slow_end: Option<SlowEnd>,
    pub(super) slow_rapid: Option<SlowEnd>,
    /// Width of the Gaussian over the command, relative to its usual width.
    pub(super) width: f64,
    /// Last reason that kept the stretch from a better command.
    pub(super) reason: UnchangedReason,
    pub(super) done: bool,
}

impl StretchRounds {
    /// Begins from the cut of the uncorrected program, with blocks no finer than the printed steps.
    pub(super) fn begun(cut: &StretchCut, budget: StretchBudget, steps_per_mm: f64) -> Self {
        let done = cut.max_mm < GOOD_MM || cut.rows.is_empty();
        let finest_mm = (1.0 / steps_per_mm).clamp(FINEST_MM, TOLERANCES_MM[0].0);
        Self {
            current: None,
            best: None,
            best_mm: cut.figure_mm(),
            best_s: budget.time_s,
            budget,
            programmed: cut.clone(),
            programmed_mm: cut.figure_mm(),
            tolerance_mm: (FIT_SHARE * cut.rms_mm()).clamp(finest_mm, TOLERANCES_MM[0].0),
            square_sum_mm2: cut.square_sum_mm2,
            lowest_mm: f64::INFINITY,
            since: 0,
            slow_end: None,
            slow_rapid: None,
            width: 1.0,
            reason: if done {
                UnchangedReason::Good
            } else {
                UnchangedReason::NoGain
            },
            done,
        }
    }

    /// Returns the cost and the gain of its best command.
    pub(super) fn cost(&self, dwell_s: f64) -> StretchCost {
        let Self { best, budget, .. } = self;
        let Some(best) = best else {
            return StretchCost {
                budget: *budget,
                blocks: 0.0,
                time_s: 0.0,
                gain_mm2: None,
            };
        };
        StretchCost {
            budget: *budget,
            blocks: best.motions.len() as f64 - budget.blocks as f64 + 1.0,
            time_s: self.best_s - budget.time_s + rest_s(best.settles, dwell_s),
            gain_mm2: Some(self.programmed.square_sum_mm2 - self.square_sum_mm2),
        }
    }

    /// Judges the current command by its cut.
    pub(super) fn judge(&mut self, cut: &StretchCut, servo_s: f64, dwell_s: f64) {
        if self.reason == UnchangedReason::Good && cut.max_mm > self.programmed.max_mm.max(GOOD_MM)
        {
            self.reopen(cut);
            return;
        }
        if self.done {
            return;
        }
        let (figure_mm, time_s) = (cut.figure_mm(), f64::from(cut.periods) * servo_s);
        let slow_s = self.slow_end.map_or(0.0, SlowEnd::time_s);
        let most_s = self.budget.most_s(dwell_s) + slow_s;
        if time_s >= most_s && self.width < WIDEST {
            let times = (time_s - self.budget.time_s) / (most_s - self.budget.time_s);
            self.width *= times.clamp(WIDER[0], WIDER[1]);
            let [percent, rests] = [time_s - self.budget.time_s, slow_s]
                .map(|more_s| 100.0 * more_s / self.budget.time_s);
            self.reason = UnchangedReason::TooSlow { percent, rests };
            return;
        }
        let better = figure_mm < self.best_mm && time_s < most_s;
        // A command that improves from round to round is followed, even if the programmed one is
        // still better.
        self.since = if figure_mm < (1.0 - LEAST_GAIN) * self.lowest_mm {
            0
        } else {
            self.since + 1
        };
        self.lowest_mm = self.lowest_mm.min(figure_mm);
        if better {
            (self.best, self.best_mm, self.best_s) = (self.current.clone(), figure_mm, time_s);
            self.square_sum_mm2 = cut.square_sum_mm2;
        }
        if self.since >= NO_GAIN {
            self.finish();
        }
    }

    /// Reopens a stretch that needed no other command until the stretches around it had others: the
    /// tool now rests at its end.
    fn reopen(&mut self, cut: &StretchCut) {
        (self.programmed_mm, self.best_mm) = (cut.figure_mm(), cut.figure_mm());
        (self.reason, self.done) = (UnchangedReason::NoGain, false);
    }

    /// Fits blocks to the points of a command, as fine as allowed; none if there would be too many.
    pub(super) fn fitted(&self, points: &[FitPoint], steps_per_mm: f64) -> Option<Vec<FitMotion>> {
        let fine = iter::successors(Some(self.tolerance_mm), |mm| Some(COARSER * mm));
        let fine = fine
            .take_while(|&mm| mm < TOLERANCES_MM[0].0)
            .map(|mm| (mm, self.budget.most_fine_blocks()));
        let [few, most] = self.budget.most_blocks();
        let coarse = TOLERANCES_MM.map(|(mm, many)| (mm, if many { most } else { few }));
        fine.chain(coarse).find_map(|(tolerance_mm, most)| {
            let motions = ArcFit::new(points, tolerance_mm, steps_per_mm).motions();
            (!motions.is_empty() && motions.len() as f64 <= most).then_some(motions)
        })
    }

    /// Judges the stretch anew, because rests and slow ends have become shorter.
    pub(super) fn again(&mut self) {
        (self.best, self.best_mm) = (None, self.programmed_mm);
        (self.lowest_mm, self.since) = (f64::INFINITY, 0);
        self.done = self.current.is_none();
    }

    /// Widens the Gaussian over a command whose blocks do not fit, if it may: a command that bends
    /// less takes fewer blocks.
    pub(super) fn widen(&mut self) {
        if self.width < WIDEST {
            self.width *= WIDER[1];
        } else {
            self.give_up(UnchangedReason::Blocks);
        }
    }

    /// Returns to the programmed command, for this reason.
    pub(super) fn take_back(&mut self, reason: UnchangedReason) {
        (self.best, self.reason) = (None, reason);
    }

    /// Keeps its best command; `reason` applies if that is the programmed one.
    pub(super) fn give_up(&mut self, reason: UnchangedReason) {
        self.reason = reason;
        self.finish();
    }

    fn finish(&mut self) {
        self.done = true;
        self.current.clone_from(&self.best);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correct::stretches::NewMotions;

    /// A stretch with this largest error as it is programmed, um.
    fn begun(max_um: f64) -> StretchRounds {
        let budget = StretchBudget {
            time_s: 1.0,
            blocks: 1,
            lines: 0,
            loop_s: 0.02,
        };
        StretchRounds::begun(&cut(max_um), budget, 1e5)
    }

    fn cut(max_um: f64) -> StretchCut {
        StretchCut {
            rows: 0..1000,
            periods: 1000,
            max_mm: 1e-3 * max_um,
            ..StretchCut::default()
        }
    }

    #[test]
    fn a_command_that_gets_better_is_followed_while_the_programmed_one_is_ahead() {
        let after = |tried_um: &[f64]| {
            let mut stretch = begun(10.0);
            stretch.current = Some(NewMotions {
                motions: Vec::new(),
                approach: None,
                settles: false,
            });
            tried_um
                .iter()
                .for_each(|&max_um| stretch.judge(&cut(max_um), 1e-3, 0.05));
            (stretch.best.is_some(), stretch.done)
        };
        assert_eq!(after(&[30.0, 25.0, 18.0, 12.0]), (false, false));
        assert_eq!(after(&[30.0, 25.0, 18.0, 12.0, 8.0]), (true, false));
        assert_eq!(after(&[12.0, 13.0, 12.0, 14.0, 8.0]), (false, true));
    }

    #[test]
    fn what_a_command_costs_and_gains_is_beside_what_is_programmed() {
        let mut stretch = begun(10.0);
        stretch.programmed.square_sum_mm2 = 5e-4;
        let cost = stretch.cost(0.05);
        assert!((cost.blocks, cost.time_s) == (0.0, 0.0) && cost.gain_mm2.is_none());
        stretch.current = Some(NewMotions {
            motions: Vec::new(),
            approach: None,
            settles: true,
        });
        stretch.judge(
            &StretchCut {
                periods: 1010,
                square_sum_mm2: 1e-4,
                ..cut(2.0)
            },
            1e-3,
            0.05,
        );
        let cost = stretch.cost(0.05);
        assert!(
            (cost.time_s - 0.01 - rest_s(true, 0.05)).abs() < 1e-12,
            "{}",
            cost.time_s
        );
        assert!(
            cost.blocks == 0.0
                && cost
                    .gain_mm2
                    .is_some_and(|gain_mm2| (gain_mm2 - 4e-4).abs() < 1e-12)
        );
    }

    #[test]
    fn a_stretch_that_was_good_is_taken_up_where_a_rest_spoils_it() {
        let mut stretch = begun(0.5);
        stretch.judge(&cut(0.9), 1e-3, 0.05);
        assert!(stretch.done && stretch.reason == UnchangedReason::Good);
        stretch.judge(&cut(4.0), 1e-3, 0.05);
        assert!(!stretch.done && stretch.reason == UnchangedReason::NoGain);
    }
}
