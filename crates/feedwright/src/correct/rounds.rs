//! Corrects a program in rounds: cut, change the command where the tool was off, fit blocks to it,
//! cut again.
//!
//! Each stretch is judged by itself: the tool rests at its ends, so that other stretches do not
//! affect it. The best command of each stretch is kept, and a stretch whose command no longer
//! improves is finished. A stretch that is cut within [`GOOD_MM`] from the start stays as
//! programmed.

use std::ops::Range;

use feedwright_gcode::canon::{AuxiliaryAxes, Canon, Corner, Motion, MotionKind, Shape};
use feedwright_plan::{FitMotion, PathError, Pieces, Step};
use feedwright_sim::{Machine, RunError, StageSteps};
use serde::{Deserialize, Serialize};

use super::budget::{StretchBudget, StretchCost, details_to_give_up, program_more_s};
use super::command_update::{UpdateSettings, new_command};
use super::exported::{CutRow, CutRows, ExportedCut, check_rows};
use super::file_prior::FileModel;
use super::given_up::{give_up_culprits, give_up_losses, give_up_slow};
use super::loop_lag::{LoopLag, loop_lags};
use super::nominal::deterministic;
use super::slow_end::{SlowEnd, slow_approach, slow_end, slow_last};
use super::stretch_cut::{StretchCut, StretchGain, by_stretch, overshoot_mm, rapid_overshoot_mm};
use super::stretch_rounds::StretchRounds;
use super::stretches::{
    NewMotions, ProgramPart, SmoothStretch, StretchCommand, assembled, dwells, stretches,
};
use super::target::PrintedTarget;
use super::unchanged::UnchangedReason;

/// Largest number of cuts.
const ROUNDS: u32 = 12;
/// Largest number of cuts in which commands are given up that are worse together.
const CHECKS: u32 = 4;
/// Standard deviations of the Gaussians over errors and over the command, time constants of the
/// position loop.
const SMOOTHING: f64 = 0.15;
const COMMAND_SMOOTHING: f64 = 0.4;
/// Time in which a change fades at the ends of a stretch, s.
const FADE_S: f64 = 0.01;
/// Least distance between the points that blocks are fitted to, mm.
const LEAST_MM: f64 = 0.005;
/// A tool that overshoots the end of a stretch, or of the rapid to it, by more than this gets a
/// slow end, mm.
const OVERSHOOT_MM: f64 = 2e-3;
/// A slow end that is shorter than this part of a usual one gets no slower: the tool would run
/// ahead over all of it.
const SLOWEST: f64 = 0.4;
/// A dwell is three lags of the loop and five of its time constants, within these bounds, s.
const DWELL_TIME_CONSTANTS: f64 = 5.0;
const DWELL_LAGS: f64 = 3.0;
const DWELL_S: [f64; 2] = [0.03, 0.06];
/// Number of first rounds in which a program that takes too long gets shorter dwells and slow ends,
/// and the smallest part of each that remains. On a shorter slow end, the tool does not return from
/// running ahead. No dwell is shorter than [`LEAST_DWELL_S`], s.
const HASTY_ROUNDS: u32 = 5;
const MOST_HASTE: [f64; 2] = [0.05, 0.7];
const LEAST_DWELL_S: f64 = 0.002;
/// Share for rests of the extra time that a program may take, as long as no command is corrected.
const FOR_RESTS: f64 = 0.6;

/// Result of the rounds.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct RoundsResult {
    /// A command for each stretch.
    pub(super) commands: Vec<StretchCommand>,
    /// Reason why a stretch stays as programmed; none for a stretch that has another command.
    pub(super) reasons: Vec<Option<UnchangedReason>>,
    /// Length of a rest of each stretch, where the tool has to come to rest, s.
    pub(super) rests_s: Vec<f64>,
    /// Longest rest, s.
    pub(super) dwell_s: f64,
    /// Cuts that were simulated.
    pub(super) rounds: u32,
}

impl RoundsResult {
    /// Returns true if stretches other than `numbers`, which is sorted, have another command.
    pub(super) fn has_other_commands(&self, numbers: &[usize]) -> bool {
        (0..self.commands.len())
            .any(|k| self.commands[k].is_some() && numbers.binary_search(&k).is_err())
    }

    /// Gives up the commands of stretches whose lines cannot be written.
    pub(super) fn give_up(&mut self, numbers: &[usize]) {
        for &k in numbers {
            (self.commands[k], self.reasons[k]) = (None, Some(UnchangedReason::Unwritable));
        }
    }
}

/// Part of a program that is judged. The steps before and after it lead to it, and are corrected
/// only for that.
#[derive(Debug, Clone)]
pub(super) struct JudgedPart {
    /// Numbers of its stretches.
    pub(super) stretches: Range<usize>,
    /// Its arc lengths along the program, mm.
    pub(super) path_mm: Range<f64>,
    /// True where the whole program has several stretches.
    pub(super) of_several: bool,
}

impl JudgedPart {
    /// All of a program.
    pub(super) fn whole(parts: &[ProgramPart]) -> Self {
        let count = stretches(parts).count();
        Self {
            stretches: 0..count,
            path_mm: f64::NEG_INFINITY..f64::INFINITY,
            of_several: count > 1,
        }
    }
}

/// The path of canonical steps.
pub(super) fn steps_of(program: &[Canon]) -> Result<Vec<Step>, PathError> {
    Pieces::new(program.iter().cloned()).collect()
}

/// Finds commands for the stretches of a program, on the machine of `cut`. The budgets belong to
/// `judged`.
pub(super) fn rounds(
    cut: &ExportedCut<'_>,
    parts: &[ProgramPart],
    target: PrintedTarget<'_>,
    file: Option<&FileModel>,
    judged: &JudgedPart,
) -> Result<RoundsResult, RunError> {
    let lags: Vec<LoopLag> = match cut.axes {
        2 => loop_lags::<2>(cut.machine).to_vec(),
        _ => loop_lags::<3>(cut.machine).to_vec(),
    };
    let slowest_s = lags.iter().map(|lag| lag.first_s).fold(0.0, f64::max);
    let settles_s = DWELL_TIME_CONSTANTS / cut.machine.slowest_kp_1_s();
    let dwell_s = (DWELL_LAGS * slowest_s)
        .max(settles_s)
        .clamp(DWELL_S[0], DWELL_S[1]);
    let dwell_s = (1e3 * dwell_s).round() / 1e3;
    let settings = settings(cut.machine);
    let mut progress = StageSteps::begin(cut.watch, "correcting");
    let count = stretches(parts).count();
    let haste = Haste([1.0; 2]);
    let mut bench = RoundsBench {
        cut,
        parts,
        target,
        lags,
        settings,
        settles_s: dwell_s,
        dwell_s,
        haste,
        count,
        judged,
    };
    bench.check_length()?;
    let (cuts, rows) = bench.cut(&vec![None; bench.count])?;
    let time_s = bench.time_s(&rows);
    let most_s = time_s + program_more_s(time_s, judged.of_several);
    let mut under_way: Vec<StretchRounds> = stretches(parts)
        .zip(&cuts)
        .map(|(stretch, cut)| bench.begun(stretch, cut, &rows))
        .collect();
    let mut round = 1;
    while round <= ROUNDS
        && under_way[judged.stretches.clone()]
            .iter()
            .any(|stretch| !stretch.done)
    {
        let commands: Vec<StretchCommand> = under_way
            .iter()
            .map(|stretch| stretch.current.clone())
            .collect();
        let (cuts, rows) = bench.cut(&commands)?;
        for (stretch, cut) in under_way.iter_mut().zip(&cuts) {
            stretch.judge(cut, settings.servo_s, dwell_s);
        }
        let more_s = bench.time_s(&rows) - most_s;
        let more_s = if round == 1 {
            more_s + (1.0 - FOR_RESTS) * (most_s - time_s)
        } else {
            more_s
        };
        if round <= HASTY_ROUNDS {
            bench.hurry(&mut under_way, more_s);
        }
        bench.update(&mut under_way, &cuts, &rows)?;
        round += 1;
        progress.reach(f64::from(round) / f64::from(ROUNDS + CHECKS));
    }
    bench.give_up_details(&mut under_way);
    if let Some(file) = file {
        bench.give_up_what_is_uncertain(&mut under_way, file)?;
    }
    let checks = bench.give_up_what_is_worse(&mut under_way, most_s)?;
    let reasons = under_way
        .iter()
        .map(|stretch| stretch.best.is_none().then_some(stretch.reason))
        .collect();
    let commands = under_way.into_iter().map(|stretch| stretch.best).collect();
    Ok(RoundsResult {
        commands,
        reasons,
        rests_s: bench.rests_s(),
        dwell_s: bench.dwell_s,
        rounds: round + checks,
    })
}

/// Factors on the usual time of dwells and of slow ends.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Haste([f64; 2]);

impl Haste {
    /// Shortens the dwells or the slow ends, which take `takes_s` now, by up to `more_s`. Returns
    /// the time saved, s.
    fn shorten(&mut self, which: usize, takes_s: f64, more_s: f64) -> f64 {
        if takes_s <= 0.0 || more_s <= 0.0 {
            return 0.0;
        }
        let part = (1.0 - more_s / takes_s)
            .max(MOST_HASTE[which] / self.0[which])
            .min(1.0);
        self.0[which] *= part;
        (1.0 - part) * takes_s
    }
}

/// Settings and program that all rounds share.
#[derive(Clone)]
struct RoundsBench<'a> {
    cut: &'a ExportedCut<'a>,
    parts: &'a [ProgramPart],
    target: PrintedTarget<'a>,
    lags: Vec<LoopLag>,
    settings: UpdateSettings,
    /// Time in which the tool settles, s.
    settles_s: f64,
    /// Time of a dwell, s.
    dwell_s: f64,
    haste: Haste,
    count: usize,
    judged: &'a JudgedPart,
}

impl RoundsBench<'_> {
    /// Rejects a program whose cut cannot be kept, before it is cut, by its time at the programmed
    /// feedrates.
    fn check_length(&self) -> Result<(), RunError> {
        check_rows(self.cut.programmed_s(0.0), self.settings.servo_s)
    }

    /// Computes the time of the judged part in a cut, s.
    fn time_s(&self, rows: &[CutRow]) -> f64 {
        rows.iter().filter(|row| row.own).count() as f64 * self.settings.servo_s
    }

    /// A dwell for each stretch, s.
    fn rests_s(&self) -> Vec<f64> {
        vec![self.dwell_s; self.count]
    }

    /// Cuts the program and returns the errors of every stretch, and the rows.
    fn cut(&self, commands: &[StretchCommand]) -> Result<(Vec<StretchCut>, Vec<CutRow>), RunError> {
        let steps = steps_of(&assembled(self.parts, commands, &self.rests_s()))?;
        let mut kept = CutRows {
            own_mm: self.judged.path_mm.clone(),
            ..CutRows::new(self.cut.original)
        };
        let cut = self.cut.cut(&steps, &mut [&mut kept]).map(|_| ());
        cut.map_err(|error| kept.fault(error, self.settings.servo_s))?;
        Ok((
            by_stretch(&kept.rows, self.count, &self.judged.stretches),
            kept.rows,
        ))
    }

    /// Begins the rounds of a stretch from the cut of the uncorrected program.
    fn begun(&self, stretch: &SmoothStretch, cut: &StretchCut, rows: &[CutRow]) -> StretchRounds {
        let servo_s = self.settings.servo_s;
        let budget = StretchBudget {
            time_s: f64::from(cut.periods) * servo_s,
            blocks: stretch.motions.len(),
            lines: stretch
                .motions
                .iter()
                .filter(|motion| motion.shape == Shape::Line)
                .count(),
            loop_s: 1.0 / self.cut.machine.slowest_kp_1_s(),
        };
        let mut begun = StretchRounds::begun(cut, budget, self.target.steps_per_mm);
        let overruns = rapid_overshoot_mm(rows, cut, stretch, servo_s) > OVERSHOOT_MM;
        begun.slow_rapid = overruns.then(|| slow_end(self.cut.machine));
        if !begun.done {
            let approach = begun
                .slow_rapid
                .and_then(|slow| slow_approach(stretch, slow, self.target));
            begun.current = Some(NewMotions {
                motions: stretch.motions.clone(),
                approach,
                settles: false,
            });
        }
        begun
    }

    /// Shortens a program that takes `more_s` longer than it may: first its dwells, then its slow
    /// ends. The stretches are judged again.
    fn hurry(&mut self, under_way: &mut [StretchRounds], more_s: f64) {
        if more_s <= 0.0 {
            return;
        }
        let commands: Vec<StretchCommand> = under_way
            .iter()
            .map(|stretch| stretch.current.clone())
            .collect();
        let rests_s = self.rests_s();
        let own = self.judged.stretches.clone();
        let rests = stretches(self.parts)
            .enumerate()
            .filter(|(k, _)| own.contains(k));
        let rests = rests
            .flat_map(|(k, stretch)| dwells(stretch, &commands, k, &rests_s))
            .flatten();
        let slow = under_way[own.clone()]
            .iter()
            .filter(|stretch| stretch.current.is_some());
        let slow = slow
            .flat_map(|stretch| [stretch.slow_end, stretch.slow_rapid])
            .flatten()
            .map(SlowEnd::time_s);
        let (rests_s, slow_s): (f64, f64) = (rests.sum(), slow.sum());
        let before = self.haste;
        let saved_s = self.haste.shorten(0, rests_s, more_s);
        self.haste.shorten(1, slow_s, more_s - saved_s);
        if self.haste == before {
            return;
        }
        let part = self.haste.0[1] / before.0[1];
        self.dwell_s = (1e3 * self.haste.0[0] * self.settles_s)
            .round()
            .max(1e3 * LEAST_DWELL_S)
            / 1e3;
        for stretch in under_way
            .iter_mut()
            .filter(|stretch| stretch.reason != UnchangedReason::Good)
        {
            stretch.slow_end = stretch.slow_end.map(|slow| slow.shorter(part));
            stretch.slow_rapid = stretch.slow_rapid.map(|slow| slow.shorter(part));
            stretch.again();
        }
    }

    /// Computes new commands for the stretches that are not done. A cancelled run is an error.
    fn update(
        &self,
        under_way: &mut [StretchRounds],
        cuts: &[StretchCut],
        rows: &[CutRow],
    ) -> Result<(), RunError> {
        let slow_end = slow_end(self.cut.machine).shorter(self.haste.0[1]);
        let slower = |slow: SlowEnd| {
            if slow.length_mm < SLOWEST * slow_end.length_mm {
                slow
            } else {
                slow.slower()
            }
        };
        for ((state, stretch), cut) in under_way.iter_mut().zip(stretches(self.parts)).zip(cuts) {
            if state.done {
                continue;
            }
            self.cut.watch.check()?;
            let mut settings = self.settings;
            settings.command_smoothing_s *= state.width;
            if overshoot_mm(rows, cut, stretch, settings.servo_s) > OVERSHOOT_MM {
                state.slow_end = Some(state.slow_end.map_or(slow_end, slower));
            }
            if rapid_overshoot_mm(rows, cut, stretch, settings.servo_s) > OVERSHOOT_MM {
                state.slow_rapid = Some(state.slow_rapid.map_or(slow_end, slower));
            }
            let points = new_command(
                rows,
                cut.rows.clone(),
                &self.lags,
                stretch,
                &settings,
                state.slow_end,
            );
            let (leaves_path, plane) = (points.is_none(), stretch.plane());
            let fitted = points.and_then(|points| state.fitted(&points, self.target.steps_per_mm));
            let fitted: Option<Vec<Motion>> = fitted
                .map(|motions| {
                    motions
                        .into_iter()
                        .map(|motion| as_motion(motion.in_plane(plane), stretch, self.target))
                        .collect()
                })
                .or_else(|| slow_last(&stretch.motions, state.slow_end?, self.target));
            match fitted {
                Some(motions) => {
                    let approach = state
                        .slow_rapid
                        .and_then(|slow| slow_approach(stretch, slow, self.target));
                    state.current = Some(NewMotions {
                        motions,
                        approach,
                        settles: state.slow_end.is_some(),
                    });
                }
                None if leaves_path => state.give_up(UnchangedReason::LeavesPath),
                None => state.widen(),
            }
        }
        Ok(())
    }

    /// Restores details to their programmed form until the program has few enough blocks and is
    /// fast enough.
    fn give_up_details(&self, under_way: &mut [StretchRounds]) {
        let dwell_s = self.settles_s;
        let own = self.judged.stretches.clone();
        let costs: Vec<StretchCost> = under_way[own.clone()]
            .iter()
            .map(|stretch| stretch.cost(dwell_s))
            .collect();
        let mut number = 0;
        let others = self.parts.iter().filter(|part| {
            number += usize::from(matches!(part, ProgramPart::Stretch(_)));
            matches!(part, ProgramPart::Kept(Canon::Motion(_)))
                && (own.start..=own.end).contains(&number)
        });
        for k in details_to_give_up(&costs, others.count(), dwell_s) {
            let k = own.start + k;
            under_way[k].take_back(UnchangedReason::Detail);
        }
    }

    /// Gives up the commands that are likely to be worse on a machine that the file may describe as
    /// well.
    fn give_up_what_is_uncertain(
        &self,
        under_way: &mut [StretchRounds],
        file: &FileModel,
    ) -> Result<(), RunError> {
        let commands: Vec<StretchCommand> = under_way
            .iter()
            .map(|stretch| stretch.best.clone())
            .collect();
        let programmed = vec![None; self.count];
        let gains = |machine: &Machine| {
            let machine = deterministic(machine);
            let bench = RoundsBench {
                cut: &ExportedCut {
                    machine: &machine,
                    ..*self.cut
                },
                ..self.clone()
            };
            let [was, is] = [bench.cut(&programmed)?.0, bench.cut(&commands)?.0];
            Ok::<_, RunError>(
                was.iter()
                    .zip(&is)
                    .map(|(was, is)| StretchGain::new(was, is))
                    .collect::<Vec<_>>(),
            )
        };
        let plausible = file
            .plausible
            .iter()
            .map(gains)
            .collect::<Result<Vec<_>, _>>()?;
        let mistaken = file
            .mistaken
            .iter()
            .map(gains)
            .collect::<Result<Vec<_>, _>>()?;
        for (k, stretch) in under_way
            .iter_mut()
            .enumerate()
            .filter(|(_, stretch)| stretch.best.is_some())
        {
            let gains: Vec<StretchGain> = plausible.iter().map(|gains| gains[k]).collect();
            if !StretchGain::is_certain(&gains) || mistaken.iter().any(|gains| gains[k].is_loss()) {
                stretch.take_back(UnchangedReason::Uncertain);
            }
        }
        Ok(())
    }

    /// Cuts all best commands together. Where the tool does not come to rest between stretches, the
    /// results differ from the separate cuts, and the program may take longer than `most_s`.
    /// Returns the number of cuts.
    fn give_up_what_is_worse(
        &self,
        under_way: &mut [StretchRounds],
        most_s: f64,
    ) -> Result<u32, RunError> {
        for check in 1..=CHECKS {
            let commands: Vec<StretchCommand> = under_way
                .iter()
                .map(|stretch| stretch.best.clone())
                .collect();
            let (cuts, rows) = self.cut(&commands)?;
            let worse = give_up_culprits(under_way, &cuts);
            let own = self.judged.stretches.clone();
            let worse = worse || give_up_losses(&mut under_way[own.clone()], &cuts[own.clone()]);
            let slow = give_up_slow(
                &mut under_way[own],
                self.time_s(&rows) - most_s,
                self.dwell_s,
            );
            if !(worse || slow) {
                return Ok(check);
            }
        }
        Ok(CHECKS)
    }
}

fn settings(machine: &Machine) -> UpdateSettings {
    let slowest_s = 1.0 / machine.slowest_kp_1_s();
    UpdateSettings {
        smoothing_s: SMOOTHING * slowest_s,
        command_smoothing_s: COMMAND_SMOOTHING * slowest_s,
        fade_s: FADE_S,
        least_mm: LEAST_MM,
        most_mm: machine.limits.max_deviation_mm,
        servo_s: machine.period.servo_s,
    }
}

fn as_motion(fitted: FitMotion, stretch: &SmoothStretch, target: PrintedTarget<'_>) -> Motion {
    let FitMotion {
        start_mm,
        end_mm,
        shape,
        feed_mm_s,
    } = fitted;
    let first = &stretch.motions[0];
    let corner = match (target.control.corner, first.corner) {
        (Some(corner), _) => corner,
        (None, Corner::Continuous { .. }) => first.corner,
        (None, Corner::ExactStop | Corner::ExactPath) => Corner::Continuous {
            tolerance_mm: None,
            merge_mm: None,
        },
    };
    let feed_mm_s = if feed_mm_s > 0.0 {
        feed_mm_s
    } else {
        first.feed_mm_s
    };
    let others = AuxiliaryAxes::default();
    Motion {
        line: first.line,
        kind: MotionKind::Feed,
        start_mm,
        end_mm,
        shape,
        feed_mm_s,
        corner,
        others,
    }
}
