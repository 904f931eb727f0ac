//! Rounds: cut, change the command where the tool was off, fit blocks to it, cut again.
//!
//! Each stretch is judged by itself: the tool rests at its ends, so that it does not see the others. The best command of each is kept, and a
//! stretch whose command gets no better is left alone. One that is cut within [`GOOD_MM`] from the start stays as it is programmed.

use super::arc_fit::{ArcFit, FitMotion};
use super::command_update::{SlowEnd, UpdateSettings, new_command};
use super::exported::{CutRow, CutRows, ExportedCut};
use super::loop_lag::{LoopLag, loop_lags};
use super::stretch_cut::{StretchCut, by_stretch, overshoot_mm};
use super::stretches::{ProgramPart, SmoothStretch, StretchCommand, assembled, stretches};
use super::target::TargetControl;
use crate::gcode::canon::{AuxiliaryAxes, Canon, Corner, Motion, MotionKind};
use crate::machine::Machine;
use crate::path::pieces::Pieces;
use crate::path::{PathError, Step};
use crate::pipeline::RunError;
use crate::watch::StageSteps;

/// Cuts at the most, and those without a gain after which a stretch is left alone.
const ROUNDS: u32 = 10;
const NO_GAIN: u32 = 3;
/// Cuts at the most in which commands are given up that are worse together.
const CHECKS: u32 = 4;
/// A gain of less than this part is none.
const LEAST_GAIN: f64 = 0.02;
/// A stretch whose largest error is less stays as it is, mm: what blocks that fit a command miss it by.
const GOOD_MM: f64 = 1e-3;
/// A stretch may take longer by this part, and by so many dwells.
const MORE_TIME: f64 = 0.05;
const MORE_DWELLS: f64 = 1.5;
/// Distance of blocks from the command, mm, and whether they may be many: the first at which they are few enough.
const TOLERANCES_MM: [(f64, bool); 4] = [(1e-3, false), (2e-3, false), (1e-3, true), (4e-3, true)];
/// A stretch may have more blocks than programmed by this factor, and by so many a second, within these bounds.
const FEW_BLOCKS: f64 = 1.15;
const FEW_MORE_1_S: f64 = 16.0;
const FEW_MORE: [f64; 2] = [4.0, 28.0];
/// Many blocks are so many times those that are programmed, or so many a second and a few, of a stretch that is no detail: one that takes so
/// long, s.
const MANY_BLOCKS: f64 = 10.0;
const MANY_1_S: f64 = 40.0;
const MANY_MORE: f64 = 20.0;
const DETAIL_S: f64 = 0.25;
/// A program may have more blocks by this factor, by so many, and by so many for each stretch that is no detail.
const PROGRAM_BLOCKS: f64 = 1.15;
const PROGRAM_MORE: f64 = 30.0;
const STRETCH_MORE: f64 = 15.0;
/// It may take longer by this part, and by so many dwells for each stretch that is no detail.
const PROGRAM_TIME: f64 = 0.035;
/// Standard deviations of the Gaussians over errors and over the command, s.
const SMOOTHING_S: f64 = 0.003;
const COMMAND_SMOOTHING_S: f64 = 0.009;
/// Time in which a change fades at the ends of a stretch, s.
const FADE_S: f64 = 0.01;
/// Least distance of points that blocks are fitted to, mm.
const LEAST_MM: f64 = 0.01;
/// A tool that runs over the end of a stretch by more goes there slowly, mm.
const OVERSHOOT_MM: f64 = 2e-3;
/// Time constants of the loop in which it brakes from there, and that the slow way takes.
const BRAKES_IN: f64 = 0.25;
const SETTLES_IN: f64 = 3.0;
/// A dwell is three lags of the loop and five of its time constants, within these bounds, s.
const DWELL_TIME_CONSTANTS: f64 = 5.0;
const DWELL_LAGS: f64 = 3.0;
const DWELL_S: [f64; 2] = [0.03, 0.06];

/// What the rounds have come to.
pub(super) struct RoundsResult {
    /// A command for each stretch.
    pub(super) commands: Vec<StretchCommand>,
    /// How long the tool rests where it has to come to rest, s.
    pub(super) dwell_s: f64,
    /// Cuts that were simulated.
    pub(super) rounds: u32,
}

/// A stretch under way.
struct StretchRounds {
    current: StretchCommand,
    best: StretchCommand,
    /// Figure and time, s, of the best; those of the programmed command first.
    best_mm: f64,
    best_s: f64,
    programmed_s: f64,
    programmed_max_mm: f64,
    /// Sum of the squares of its errors, of the programmed command and of the best, mm2.
    square_sums_mm2: [f64; 2],
    since: u32,
    slow_end: Option<SlowEnd>,
    done: bool,
}

/// The path of canonical steps.
pub(super) fn steps_of(program: &[Canon]) -> Result<Vec<Step>, PathError> {
    Pieces::new(program.iter().cloned()).collect()
}

/// Finds commands for the stretches of a program, on the machine of `cut`.
pub(super) fn rounds(
    cut: &ExportedCut<'_>,
    parts: &[ProgramPart],
    target: &TargetControl,
) -> Result<RoundsResult, RunError> {
    let lags: Vec<LoopLag> = match cut.axes {
        2 => loop_lags::<2>(cut.machine).to_vec(),
        _ => loop_lags::<3>(cut.machine).to_vec(),
    };
    let slowest_s = lags.iter().map(|lag| lag.first_s).fold(0.0, f64::max);
    let settles_s = DWELL_TIME_CONSTANTS / cut.machine.slowest_kp_1_s();
    let dwell_s = (DWELL_LAGS * slowest_s).max(settles_s).clamp(DWELL_S[0], DWELL_S[1]);
    let dwell_s = (1e3 * dwell_s).round() / 1e3;
    let settings = settings(cut.machine);
    let mut progress = StageSteps::begin(cut.watch, "correcting");
    let bench = RoundsBench { cut, parts, target, lags, settings, dwell_s, count: stretches(parts).count() };
    let (cuts, _) = bench.cut(&vec![None; bench.count])?;
    let begun = |(stretch, cut)| StretchRounds::new(stretch, cut, settings.servo_s);
    let mut under_way: Vec<StretchRounds> = stretches(parts).zip(&cuts).map(begun).collect();
    let mut round = 1;
    while round <= ROUNDS && under_way.iter().any(|stretch| !stretch.done) {
        let commands: Vec<StretchCommand> = under_way.iter().map(|stretch| stretch.current.clone()).collect();
        let (cuts, rows) = bench.cut(&commands)?;
        for (stretch, cut) in under_way.iter_mut().zip(&cuts) {
            stretch.judge(cut, settings.servo_s, dwell_s);
        }
        bench.update(&mut under_way, &cuts, &rows);
        round += 1;
        progress.reach(f64::from(round) / f64::from(ROUNDS + CHECKS));
    }
    give_up_details(&mut under_way, parts, dwell_s);
    let checks = bench.give_up_what_is_worse(&mut under_way)?;
    let commands = under_way.into_iter().map(|stretch| stretch.best).collect();
    Ok(RoundsResult { commands, dwell_s, rounds: round + checks })
}

/// What every round needs.
struct RoundsBench<'a> {
    cut: &'a ExportedCut<'a>,
    parts: &'a [ProgramPart],
    target: &'a TargetControl,
    lags: Vec<LoopLag>,
    settings: UpdateSettings,
    dwell_s: f64,
    count: usize,
}

impl RoundsBench<'_> {
    /// What every stretch comes to, and the rows.
    fn cut(&self, commands: &[StretchCommand]) -> Result<(Vec<StretchCut>, Vec<CutRow>), RunError> {
        let steps = steps_of(&assembled(self.parts, commands, self.dwell_s))?;
        let mut kept = CutRows::new(self.cut.original);
        self.cut.cut(&steps, &mut kept)?;
        Ok((by_stretch(&kept.rows, self.count), kept.rows))
    }

    /// New commands for those that are not done.
    fn update(&self, under_way: &mut [StretchRounds], cuts: &[StretchCut], rows: &[CutRow]) {
        let (settings, slow_end) = (&self.settings, slow_end(self.cut.machine));
        for ((state, stretch), cut) in under_way.iter_mut().zip(stretches(self.parts)).zip(cuts) {
            if state.done {
                continue;
            }
            if overshoot_mm(rows, cut, stretch, settings.servo_s) > OVERSHOOT_MM {
                state.slow_end = Some(slow_end);
            }
            let points = new_command(rows, cut.rows.clone(), &self.lags, stretch, settings, state.slow_end);
            let most = state.most_blocks(stretch);
            let fitted = points.and_then(|points| {
                TOLERANCES_MM.iter().find_map(|&(tolerance_mm, many)| {
                    let motions = ArcFit::new(&points, tolerance_mm, self.target.steps_per_mm()).motions();
                    let few_enough = !motions.is_empty() && motions.len() as f64 <= most[usize::from(many)];
                    few_enough.then_some(motions)
                })
            });
            match fitted {
                Some(motions) => {
                    state.current =
                        Some(motions.into_iter().map(|motion| as_motion(motion, stretch, self.target)).collect());
                }
                None => state.finish(),
            }
        }
    }

    /// Cuts the best of all together: where the tool does not come to rest between them, they are not what they were each by itself. How often
    /// it was cut.
    fn give_up_what_is_worse(&self, under_way: &mut [StretchRounds]) -> Result<u32, RunError> {
        for check in 1..=CHECKS {
            let commands: Vec<StretchCommand> = under_way.iter().map(|stretch| stretch.best.clone()).collect();
            let (cuts, _) = self.cut(&commands)?;
            let mut worse = Vec::new();
            for (k, (stretch, cut)) in under_way.iter().zip(&cuts).enumerate() {
                if cut.max_mm > stretch.programmed_max_mm + GOOD_MM {
                    worse.push(k);
                }
            }
            if worse.is_empty() {
                return Ok(check);
            }
            for k in worse {
                // What a stretch is off at its start may be that of the one before.
                let culprit = if under_way[k].best.is_some() || k == 0 { k } else { k - 1 };
                under_way[culprit].best = None;
            }
        }
        Ok(CHECKS)
    }
}

/// A way to the end that is so slow that it brakes in a part of the loop's time constant, and as long as that takes to settle.
fn slow_end(machine: &Machine) -> SlowEnd {
    let slowest_s = 1.0 / machine.slowest_kp_1_s();
    let speed_mm_s = machine.limits.tangential_accel_mm_s2 * BRAKES_IN * slowest_s;
    SlowEnd { speed_mm_s, length_mm: speed_mm_s * SETTLES_IN * slowest_s }
}

fn settings(machine: &Machine) -> UpdateSettings {
    UpdateSettings {
        smoothing_s: SMOOTHING_S,
        command_smoothing_s: COMMAND_SMOOTHING_S,
        fade_s: FADE_S,
        least_mm: LEAST_MM,
        most_mm: machine.limits.max_deviation_mm,
        servo_s: machine.period.servo_s,
    }
}

impl StretchRounds {
    /// From the cut of the program as it is.
    fn new(stretch: &SmoothStretch, cut: &StretchCut, servo_s: f64) -> Self {
        let done = cut.max_mm < GOOD_MM || cut.rows.is_empty();
        Self {
            current: (!done).then(|| stretch.motions.clone()),
            best: None,
            best_mm: cut.figure_mm(),
            best_s: f64::from(cut.periods) * servo_s,
            programmed_s: f64::from(cut.periods) * servo_s,
            programmed_max_mm: cut.max_mm,
            square_sums_mm2: [cut.square_sum_mm2; 2],
            since: 0,
            slow_end: None,
            done,
        }
    }

    /// Takes in how its command was cut.
    fn judge(&mut self, cut: &StretchCut, servo_s: f64, dwell_s: f64) {
        if self.done {
            return;
        }
        let (figure_mm, time_s) = (cut.figure_mm(), f64::from(cut.periods) * servo_s);
        let slow_s = self.slow_end.map_or(0.0, |slow| slow.length_mm / slow.speed_mm_s);
        let most_s = (1.0 + MORE_TIME) * self.programmed_s + MORE_DWELLS * dwell_s + slow_s;
        let better = figure_mm < self.best_mm && time_s < most_s;
        self.since = if better && figure_mm < (1.0 - LEAST_GAIN) * self.best_mm { 0 } else { self.since + 1 };
        if better {
            (self.best, self.best_mm, self.best_s) = (self.current.clone(), figure_mm, time_s);
            self.square_sums_mm2[1] = cut.square_sum_mm2;
        }
        if self.since >= NO_GAIN {
            self.finish();
        }
    }

    /// How many blocks count as few, and how many it may have at all.
    fn most_blocks(&self, stretch: &SmoothStretch) -> [f64; 2] {
        let programmed = stretch.motions.len() as f64;
        let few = FEW_BLOCKS * programmed + (FEW_MORE_1_S * self.programmed_s).clamp(FEW_MORE[0], FEW_MORE[1]);
        let many = (MANY_BLOCKS * programmed).max(MANY_1_S * self.programmed_s + MANY_MORE);
        [few, if self.is_detail() { few } else { few.max(many) }]
    }

    fn is_detail(&self) -> bool {
        self.programmed_s < DETAIL_S
    }

    fn finish(&mut self) {
        self.done = true;
        self.current.clone_from(&self.best);
    }
}

/// Takes details back to what they were, those with the least gain for a block first, until the program has few enough blocks and is fast enough.
fn give_up_details(under_way: &mut [StretchRounds], parts: &[ProgramPart], dwell_s: f64) {
    let programmed: Vec<f64> = stretches(parts).map(|stretch| stretch.motions.len() as f64).collect();
    let kept = parts.iter().filter(|part| matches!(part, ProgramPart::Kept(Canon::Motion(_)))).count() as f64;
    let larger = under_way.iter().filter(|stretch| !stretch.is_detail()).count() as f64;
    let all = kept + programmed.iter().sum::<f64>();
    let programmed_s: f64 = under_way.iter().map(|stretch| stretch.programmed_s).sum();
    let mut room = PROGRAM_BLOCKS * all + PROGRAM_MORE + STRETCH_MORE * larger - all;
    let mut room_s = PROGRAM_TIME * programmed_s + MORE_DWELLS * dwell_s * (1.0 + larger);
    // What each costs in blocks and time, a dwell included.
    let costs: Vec<[f64; 2]> = under_way
        .iter()
        .zip(&programmed)
        .map(|(stretch, programmed)| match &stretch.best {
            Some(best) => [best.len() as f64 - programmed + 1.0, stretch.best_s - stretch.programmed_s + dwell_s],
            None => [0.0; 2],
        })
        .collect();
    for [blocks, more_s] in &costs {
        (room, room_s) = (room - blocks, room_s - more_s);
    }
    let gain = |stretch: &StretchRounds| stretch.square_sums_mm2[0] - stretch.square_sums_mm2[1];
    let mut order: Vec<usize> =
        (0..under_way.len()).filter(|&k| under_way[k].best.is_some() && under_way[k].is_detail()).collect();
    order.sort_by(|&a, &b| {
        let worth = |k: usize| gain(&under_way[k]) / costs[k][0].max(1.0);
        worth(a).total_cmp(&worth(b))
    });
    for k in order {
        if room >= 0.0 && room_s >= 0.0 {
            break;
        }
        (room, room_s) = (room + costs[k][0], room_s + costs[k][1]);
        under_way[k].best = None;
    }
}

fn as_motion(fitted: FitMotion, stretch: &SmoothStretch, target: &TargetControl) -> Motion {
    let FitMotion { start_mm, end_mm, shape, feed_mm_s } = fitted;
    let first = &stretch.motions[0];
    let corner = match (target.corner, first.corner) {
        (Some(corner), _) => corner,
        (None, Corner::Continuous { .. }) => first.corner,
        (None, Corner::ExactStop | Corner::ExactPath) => Corner::Continuous { tolerance_mm: None, merge_mm: None },
    };
    let feed_mm_s = if feed_mm_s > 0.0 { feed_mm_s } else { first.feed_mm_s };
    let others = AuxiliaryAxes::default();
    Motion { line: first.line, kind: MotionKind::Feed, start_mm, end_mm, shape, feed_mm_s, corner, others }
}
