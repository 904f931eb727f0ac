//! Cuts a program as the target control would: planned by that control, without feedback, measured
//! against the original.
//!
//! The disturbance has another phase, and the noise other random numbers, each time a part is cut.
//! So the program is cut several times. Each cut rests before the start for another part of a
//! period of the disturbance, and has another seed.
use std::ops::Range;

use feedwright_gcode::canon::{Event, EventKind};
use feedwright_plan::vector::{Vector, add_scaled, sub};
use feedwright_plan::{AlignedPaths, Step};
use feedwright_sim::{
    BoxedController, Commanded, Machine, Measurement, Mechanism, Outcome, PlanCache, Plant,
    PlantMaker, Row, Run, RunError, RunResult, Sink, Stages, Watch,
};
use serde::{Deserialize, Serialize};

use super::learned::{PathTrack, PlaceError};
use super::workers::Workers;
use crate::report::Statistics;
use crate::report::harm::{CutErrors, MAX_UM};

/// Number of cuts for a machine with a disturbance or noise.
const CUTS: u32 = 4;

/// A corrected program is no better than the uncorrected program if its RMS error is not smaller by
/// this share, nor its largest error by [`MAX_UM`], the variation by noise. A smaller gain does not
/// justify a longer program.
pub(super) const LEAST_GAIN: f64 = 0.02;

/// Errors, time and size of a program that is cut without feedback. The errors and the time of a
/// cut that diverged are NaN, null in JSON.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ExportedFigures {
    /// Contour error against the original: quadratic mean of the RMS over the cuts, um.
    pub rms_um: f64,
    /// Largest contour error of all cuts, um.
    pub max_um: f64,
    /// Uncut path of the original, the largest of all cuts, um.
    pub uncut_um: f64,
    /// Machining time, s.
    pub time_s: f64,
    /// Motions of the program.
    pub blocks: u64,
    /// True where the loop stayed stable in all cuts.
    pub(crate) completed: bool,
    /// Number of the cut with the largest error.
    #[serde(skip)]
    worst_phase: usize,
}

impl ExportedFigures {
    /// Sets errors and time to NaN if a cut diverged: they would describe only the beginning of the
    /// cut.
    const fn of_whole(mut self) -> Self {
        if !self.completed {
            (self.rms_um, self.max_um, self.uncut_um, self.time_s) =
                (f64::NAN, f64::NAN, f64::NAN, f64::NAN);
        }
        self
    }

    /// Returns true if this program gains too little to replace the uncorrected one, even if it is
    /// not worse.
    pub(super) fn is_no_better_than(&self, uncorrected: &Self) -> bool {
        self.rms_um > (1.0 - LEAST_GAIN) * uncorrected.rms_um
            && self.max_um > uncorrected.max_um - MAX_UM
    }

    /// The errors that decide whether one program is worse than another.
    pub(super) const fn errors(&self) -> CutErrors {
        CutErrors {
            rms_um: self.rms_um,
            max_um: self.max_um,
            uncut_um: Some(self.uncut_um),
        }
    }
}

/// Command and error of a cut in one servo period.
#[derive(Debug, Clone, Copy)]
pub(super) struct CutRow {
    pub(super) t_s: f64,
    /// Line of the motion under way; 0 in a rest.
    pub(super) line: u32,
    /// Kind of motion of the command.
    pub(super) commanded: Commanded,
    /// True where the tool is in a cutting part of the program.
    pub(super) cutting: bool,
    /// True where the row belongs to the piece that is corrected, not to a lead.
    pub(super) own: bool,
    pub(super) cmd_mm: Vector,
    /// Vector from the tool to its foot, mm; zero where the program does not cut.
    pub(super) error_mm: Vector,
    /// The point of the original path that the command stands for.
    pub(super) path_mm: Vector,
    /// Feedrate of the original at that point, mm/s.
    pub(super) feed_mm_s: f64,
}

/// Largest number of rows that are kept of a cut: some 2 GB.
const MOST_ROWS: usize = 10_000_000;

/// Rejects a cut that takes longer than its rows can be kept.
pub(super) fn check_rows(time_s: f64, servo_s: f64) -> Result<(), RunError> {
    let most_s = MOST_ROWS as f64 * servo_s;
    if time_s > most_s {
        Err(RunError::TooLong {
            most_periods: MOST_ROWS,
            most_s,
        })
    } else {
        Ok(())
    }
}

/// Keeps the rows of a cut.
pub(super) struct CutRows<'a> {
    pub(super) rows: Vec<CutRow>,
    pub(super) original: &'a [Step],
    /// Arc lengths of the piece that is corrected, mm.
    pub(super) own_mm: Range<f64>,
}

impl<'a> CutRows<'a> {
    pub(super) const fn new(original: &'a [Step]) -> Self {
        Self {
            rows: Vec::new(),
            original,
            own_mm: f64::NEG_INFINITY..f64::INFINITY,
        }
    }

    /// Returns `TooLong` if the rows of the cut could not all be kept, or else `error`.
    pub(super) fn fault(&self, error: RunError, servo_s: f64) -> RunError {
        if self.rows.len() < MOST_ROWS {
            return error;
        }
        RunError::TooLong {
            most_periods: MOST_ROWS,
            most_s: MOST_ROWS as f64 * servo_s,
        }
    }

    /// Feedrate of the original at an arc length, where it cuts.
    fn feed_mm_s(&self, s_mm: f64) -> Option<f64> {
        let before = |step: &Step| {
            if let Step::Piece(piece) = step {
                piece.s_mm <= s_mm
            } else {
                true
            }
        };
        // Events stand between pieces and do not disturb the order.
        let mut index = self.original.partition_point(before);
        while index > 0 {
            index -= 1;
            if let Step::Piece(piece) = &self.original[index] {
                return piece.cutting.then_some(piece.feed_mm_s);
            }
        }
        None
    }
}

impl Sink for CutRows<'_> {
    fn row(&mut self, row: &Row) -> std::io::Result<()> {
        if self.rows.len() >= MOST_ROWS {
            return Err(std::io::ErrorKind::OutOfMemory.into());
        }
        let feed_mm_s = self
            .feed_mm_s(row.s_mm)
            .or_else(|| self.rows.last().map(|last| last.feed_mm_s));
        self.rows.push(CutRow {
            t_s: row.t_s,
            line: if row.commanded == Commanded::Rest {
                0
            } else {
                row.line
            },
            commanded: row.commanded,
            cutting: row.cutting,
            own: self.own_mm.contains(&row.s_mm),
            cmd_mm: row.cmd_mm,
            error_mm: if row.cutting {
                sub(row.foot_mm, row.act_mm)
            } else {
                [0.0; 3]
            },
            path_mm: row.path_mm,
            feed_mm_s: feed_mm_s.unwrap_or(0.0),
        });
        Ok(())
    }
}

/// A program of more steps is cut on one thread: each cut has the paths in memory.
const SHARED_STEPS: usize = 300_000;
/// Progress of a cut, steps.
const CUT_STEPS: u64 = 100;

/// Reports the progress of a cut along the original path.
struct ExportedProgress<'a> {
    watch: &'a dyn Watch,
    length_mm: f64,
    done: u64,
}

impl Sink for ExportedProgress<'_> {
    fn row(&mut self, row: &Row) -> std::io::Result<()> {
        // A float that is not a number saturates to zero here.
        let done =
            ((CUT_STEPS as f64 * row.s_mm / self.length_mm) as u64).clamp(self.done, CUT_STEPS);
        if done > self.done {
            self.watch.advance(done - self.done);
            self.done = done;
        }
        Ok(())
    }
}

pub(super) fn length_mm(path: &[Step]) -> f64 {
    path.iter()
        .map(|step| {
            if let Step::Piece(piece) = step {
                piece.length_mm
            } else {
                0.0
            }
        })
        .sum()
}

/// Machine of one cut, and the rest before it.
pub(super) struct CutPhase {
    pub(super) machine: Machine,
    pub(super) wait_s: f64,
}

/// Returns a program that begins with a rest.
pub(super) fn waited(program: &[Step], wait_s: f64) -> Vec<Step> {
    let wait = Step::Event(Event {
        line: 0,
        kind: EventKind::Dwell { seconds: wait_s },
    });
    std::iter::once(wait)
        .chain(program.iter().cloned())
        .collect()
}

/// Motions of a path; an arc of more than half a turn counts as it is planned.
fn path_steps(program: &[Step]) -> u64 {
    program
        .iter()
        .filter(|step| matches!(step, Step::Piece(_)))
        .count() as u64
}

/// Settings for cuts of a program, which are measured against the original.
pub struct ExportedCut<'a> {
    /// The machine that cuts it.
    pub machine: &'a Machine,
    /// Errors of the joints beside the model, as logs of the part show them.
    pub error: Option<&'a PlaceError>,
    /// Feed planner of the control.
    pub stages: Stages,
    /// The path that errors are measured to.
    pub original: &'a [Step],
    /// Axes that move, 2 or 3.
    pub axes: usize,
    /// Receives the progress, and reports whether the run is cancelled.
    pub watch: &'a dyn Watch,
}

impl ExportedCut<'_> {
    /// Cuts a program several times and returns its errors and time.
    ///
    /// # Errors
    /// A machine without sensible limits, or a run that was cancelled.
    pub fn figures(&self, program: &[Step]) -> Result<ExportedFigures, RunError> {
        self.figures_by(program, "cutting", &Workers::new(1))
    }

    /// Computes the same figures with one work part for each cut, as a stage named `stage`.
    pub(super) fn figures_by(
        &self,
        program: &[Step],
        stage: &str,
        workers: &Workers,
    ) -> Result<ExportedFigures, RunError> {
        let mut figures = ExportedFigures {
            completed: true,
            blocks: path_steps(program),
            ..ExportedFigures::default()
        };
        let phases = self.phases();
        let mut square_sum_um2 = 0.0;
        self.watch.begin(stage, CUT_STEPS * phases.len() as u64);
        let threads = if program.len() > SHARED_STEPS {
            1
        } else {
            usize::MAX
        };
        let all = workers.each(stage, phases.len(), threads, |phase| {
            let CutPhase { machine, wait_s } = &phases[phase];
            let mut progress = ExportedProgress {
                watch: self.watch,
                length_mm: length_mm(self.original),
                done: 0,
            };
            ExportedCut { machine, ..*self }.once(program, *wait_s, &mut [&mut progress])
        })?;
        for (phase, now) in all.into_iter().enumerate() {
            square_sum_um2 += now.rms_um * now.rms_um;
            if now.max_um > figures.max_um || !now.completed {
                (figures.max_um, figures.worst_phase) = (now.max_um, phase);
            }
            figures.uncut_um = figures.uncut_um.max(now.uncut_um);
            figures.completed &= now.completed;
            figures.time_s = now.time_s;
        }
        figures.rms_um = (square_sum_um2 / phases.len() as f64).sqrt();
        Ok(figures.of_whole())
    }

    /// Returns the machine and the rest of each cut; these differ from cut to cut.
    pub(super) fn phases(&self) -> Vec<CutPhase> {
        let disturbs = self
            .machine
            .axes
            .iter()
            .any(|axis| axis.disturbance_nm > 0.0);
        let cuts = if disturbs || self.machine.is_noisy() {
            CUTS
        } else {
            1
        };
        let slowest_hz = self
            .machine
            .axes
            .iter()
            .map(|axis| axis.disturbance_hz)
            .fold(f64::INFINITY, f64::min);
        let phase = |cut: u32| {
            let part = f64::from(cut) / f64::from(cuts);
            let wait_s = if disturbs && slowest_hz > 0.0 {
                part / slowest_hz
            } else {
                0.0
            };
            CutPhase {
                machine: self
                    .machine
                    .with_noise_seed(self.machine.noise.seed.wrapping_add(cut.into())),
                wait_s,
            }
        };
        (0..cuts).map(phase).collect()
    }

    /// Repeats the cut with the largest error of all cuts behind `figures`.
    pub(crate) fn worst(
        &self,
        program: &[Step],
        figures: &ExportedFigures,
        sinks: &mut [&mut dyn Sink],
    ) -> Result<RunResult, RunError> {
        match self.phases().get(figures.worst_phase) {
            Some(CutPhase { machine, wait_s }) => {
                ExportedCut { machine, ..*self }.cut(&waited(program, *wait_s), sinks)
            }
            None => self.cut(program, sinks),
        }
    }

    /// Cuts a program once after a rest and returns its figures; the time excludes the rest. The
    /// rows go to `sinks`, including the rows of the rest.
    ///
    /// # Errors
    /// The same as [`ExportedCut::figures`].
    pub fn once(
        &self,
        program: &[Step],
        wait_s: f64,
        sinks: &mut [&mut dyn Sink],
    ) -> Result<ExportedFigures, RunError> {
        let mut statistics = Statistics::new();
        let mut all: Vec<&mut dyn Sink> = vec![&mut statistics];
        all.extend(sinks.iter_mut().map(|sink| &mut **sink as &mut dyn Sink));
        let aligned = AlignedPaths::new(self.original, &waited(program, wait_s));
        let run = self.cut_along(&aligned, &mut all)?;
        let figures = ExportedFigures {
            rms_um: statistics.rms_um(),
            max_um: statistics.max_um(),
            uncut_um: run.uncut_mm * 1e3,
            time_s: run.time_s - wait_s,
            blocks: path_steps(program),
            completed: run.outcome == Outcome::Completed,
            worst_phase: 0,
        };
        Ok(figures.of_whole())
    }

    /// Time of the original at its programmed feedrates, and `stop_s` for each of its steps, s.
    pub(super) fn programmed_s(&self, stop_s: f64) -> f64 {
        let limits = &self.machine.limits;
        let time_s = |step: &Step| match step {
            Step::Piece(piece) if piece.cutting => {
                stop_s + piece.length_mm / piece.feed_mm_s.min(limits.max_feed_mm_s)
            }
            Step::Piece(piece) => stop_s + piece.length_mm / limits.rapid_mm_s,
            Step::Event(_) | Step::Rest(_) => stop_s,
        };
        self.original.iter().map(time_s).sum()
    }

    /// Cuts a program once; the rows go to `sinks`.
    pub(super) fn cut(
        &self,
        program: &[Step],
        sinks: &mut [&mut dyn Sink],
    ) -> Result<RunResult, RunError> {
        self.cut_along(&AlignedPaths::new(self.original, program), sinks)
    }

    /// Cuts a program that is aligned with the original.
    fn cut_along(
        &self,
        aligned: &AlignedPaths,
        sinks: &mut [&mut dyn Sink],
    ) -> Result<RunResult, RunError> {
        let plan = PlanCache::default();
        let error_mm = match self.error {
            Some(error) => error.along(&self.track(aligned, &plan)?),
            None => Vec::new(),
        };
        let beside = |start_mm: [f64; 3], seed: u64| -> Box<dyn Mechanism> {
            let plant = Plant::<3>::with_seed(self.machine, start_mm, seed);
            Box::new(BesideModel {
                plant,
                error_mm: error_mm.clone(),
                period: 0,
            })
        };
        let plant: Option<PlantMaker<'_>> = if self.error.is_some() {
            Some(&beside)
        } else {
            None
        };
        self.run(aligned, &plan, plant, sinks)
    }

    /// One run along the path.
    fn run(
        &self,
        aligned: &AlignedPaths,
        plan: &PlanCache,
        plant: Option<PlantMaker<'_>>,
        sinks: &mut [&mut dyn Sink],
    ) -> Result<RunResult, RunError> {
        let run = Run::on(self.machine)
            .uncompensated()
            .stages(self.stages)
            .watched(self.watch);
        let run = if self.error.is_some() {
            run.sharing(plan)
        } else {
            run
        };
        let run = plant.map_or(run, |plant| run.plant(plant));
        run.cut_boxed_aligned(aligned, &mut BoxedController::uncorrected(self.axes), sinks)
    }

    /// The command of a program, servo period by servo period.
    fn track(&self, aligned: &AlignedPaths, plan: &PlanCache) -> Result<PathTrack, RunError> {
        let servo_s = self.machine.period.servo_s;
        let mut track = PathTrack {
            sample_s: servo_s,
            ..PathTrack::default()
        };
        self.walk(aligned, plan, &mut KeptTrack { track: &mut track })?;
        Ok(track)
    }

    /// The rows of a machine whose tool is where the command is.
    fn walk(
        &self,
        aligned: &AlignedPaths,
        plan: &PlanCache,
        sink: &mut dyn Sink,
    ) -> Result<(), RunError> {
        let ideal = |_: [f64; 3], _: u64| -> Box<dyn Mechanism> { Box::new(IdealMachine) };
        self.run(aligned, plan, Some(&ideal), &mut [sink])
            .map(|_| ())
    }

    /// Returns the number of servo periods that are simulated until the end of each line, up to
    /// `lines`, as the control plans the program.
    pub(super) fn periods(&self, program: &[Step], lines: usize) -> Result<Vec<u64>, RunError> {
        let mut kept = LinePeriods {
            until: vec![0; lines],
            periods: 0,
        };
        self.walk(
            &AlignedPaths::new(program, program),
            &PlanCache::default(),
            &mut kept,
        )?;
        let mut before = 0;
        for until in &mut kept.until {
            before = before.max(*until);
            *until = before;
        }
        Ok(kept.until)
    }
}

/// A machine whose tool is where the command is.
struct IdealMachine;

impl Mechanism for IdealMachine {
    fn step(&mut self, command_mm: [f64; 3]) -> Measurement<3> {
        Measurement {
            position_mm: command_mm,
            joint_mm: command_mm,
            measured_mm: command_mm,
            torque_nm: [0.0; 3],
        }
    }

    fn skip(&mut self, _: u64) {}

    fn has_geometry(&self) -> bool {
        false
    }
}

/// Keeps the command of a run, and fills in the rows that a rest skips.
struct KeptTrack<'a> {
    track: &'a mut PathTrack,
}

impl Sink for KeptTrack<'_> {
    fn row(&mut self, row: &Row) -> std::io::Result<()> {
        let period = (row.t_s / self.track.sample_s).round() as usize;
        if period >= MOST_ROWS {
            return Err(std::io::ErrorKind::OutOfMemory.into());
        }
        if let (Some(&s_mm), Some(&command_mm)) =
            (self.track.s_mm.last(), self.track.command_mm.last())
        {
            self.track
                .s_mm
                .resize(period.max(self.track.s_mm.len()), s_mm);
            self.track
                .command_mm
                .resize(period.max(self.track.command_mm.len()), command_mm);
        }
        self.track.s_mm.push(row.s_mm);
        self.track.command_mm.push(row.cmd_mm);
        Ok(())
    }
}

/// Counts the servo periods until the end of each line.
struct LinePeriods {
    until: Vec<u64>,
    periods: u64,
}

impl Sink for LinePeriods {
    fn row(&mut self, row: &Row) -> std::io::Result<()> {
        self.periods += 1;
        if let Some(until) = self
            .until
            .get_mut(row.line as usize)
            .filter(|_| row.commanded != Commanded::Rest)
        {
            *until = self.periods;
        }
        Ok(())
    }
}

/// A machine whose joints have an error beside the model.
struct BesideModel {
    plant: Plant<3>,
    /// Error of the joints in each servo period, mm.
    error_mm: Vec<Vector>,
    period: usize,
}

impl Mechanism for BesideModel {
    fn step(&mut self, command_mm: [f64; 3]) -> Measurement<3> {
        let Measurement {
            position_mm,
            joint_mm,
            measured_mm,
            torque_nm,
        } = self.plant.step(command_mm);
        self.period += 1;
        // A position is the one at the end of the period.
        let error_mm = self
            .error_mm
            .get(self.period)
            .or(self.error_mm.last())
            .copied()
            .unwrap_or_default();
        let with = |at_mm| add_scaled(at_mm, 1.0, error_mm);
        Measurement {
            position_mm: with(position_mm),
            joint_mm: with(joint_mm),
            measured_mm: with(measured_mm),
            torque_nm,
        }
    }

    fn skip(&mut self, periods: u64) {
        self.plant.skip(periods);
        self.period += periods as usize;
    }

    fn has_geometry(&self) -> bool {
        self.plant.has_geometry()
    }
}
