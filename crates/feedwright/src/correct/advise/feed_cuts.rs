//! Cuts a program at other feedrates, in one of the ways, stretch by stretch.

use feedwright_plan::Step;
use feedwright_plan::vector::norm;
use feedwright_sim::{BoxedController, Machine, Outcome, Run, RunError, RunResult, Watch};
use serde::Serialize;

use super::{CutWay, FeedCut, canon_of, with_factors};
use crate::correct::exported::{CutPhase, CutRow, CutRows, ExportedCut, waited};
use crate::correct::file_prior::FileModel;
use crate::correct::nominal::deterministic;
use crate::correct::rounds::{JudgedPart, rounds, steps_of};
use crate::correct::stretch_cut::{StretchCut, by_stretch};
use crate::correct::stretches::{ProgramPart, assembled, stretches};
use crate::correct::target::TargetControl;

/// Machine, program and controller of the cuts.
pub(super) struct FeedBench<'a> {
    pub(super) machine: &'a Machine,
    /// Machines that an uncertain file may describe: the corrected program must be good on all of
    /// them.
    pub(super) file: Option<&'a FileModel>,
    pub(super) target: &'a TargetControl,
    /// Largest unit of length of the program, mm.
    pub(super) unit_mm: f64,
    pub(super) laps: u32,
    pub(super) parts: &'a [ProgramPart],
    pub(super) controller: BoxedController,
    pub(super) watch: &'a dyn Watch,
}

/// Errors and time of a program, over its cuts.
#[derive(Debug, Clone)]
pub(super) struct FeedErrors {
    pub(super) time_s: f64,
    rms_um: f64,
    pub(super) max_um: f64,
    /// Errors of each stretch.
    pub(super) stretches: Vec<StretchErrors>,
}

/// Errors and time of a stretch, over its cuts.
#[derive(Debug, Clone, Copy)]
pub(super) struct StretchErrors {
    pub(super) time_s: f64,
    /// Largest error, um, and its place.
    pub(super) max_um: f64,
    pub(super) place: ErrorPlace,
    /// Largest error away from the ends of the stretch, um.
    pub(super) way_um: f64,
}

/// Part of a stretch with an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ErrorPlace {
    /// The start: the tool still has to come to rest there.
    Start,
    /// The middle, where the command neither comes from rest nor stops.
    Way,
    /// The end.
    End,
}

/// Time constants of the position loop in which a tool settles at an end.
const SETTLES_IN: f64 = 3.0;

impl FeedErrors {
    pub(super) const fn cut(&self, factor: Option<f64>) -> FeedCut {
        FeedCut {
            factor,
            time_s: self.time_s,
            rms_um: self.rms_um,
            max_um: self.max_um,
        }
    }
}

/// Hides the progress of its own work, and passes on cancellation.
struct Silent<'a>(&'a dyn Watch);

impl Watch for Silent<'_> {
    fn is_cancelled(&self) -> bool {
        self.0.is_cancelled()
    }
}

impl FeedBench<'_> {
    /// Cuts the program with a factor on the feedrates of each stretch.
    pub(super) fn cut(&mut self, way: CutWay, factors: &[f64]) -> Result<FeedErrors, RunError> {
        let parts = with_factors(self.parts, factors, self.machine.limits.max_feed_mm_s);
        let original = steps_of(&canon_of(&parts))?;
        let silent = Silent(self.watch);
        let stages = self.target.stages(self.machine);
        let nominal = deterministic(self.machine);
        let axes = self.controller.axes();
        let on = |machine| ExportedCut {
            machine,
            error: None,
            stages,
            original: &original,
            axes,
            watch: &silent,
        };
        let program = match way {
            CutWay::Corrected => {
                let found = rounds(
                    &on(&nominal),
                    &parts,
                    self.target.printed(self.unit_mm),
                    self.file,
                    &JudgedPart::whole(&parts),
                )?;
                steps_of(&assembled(&parts, &found.commands, &found.rests_s))?
            }
            CutWay::Uncorrected | CutWay::Controlled => original.clone(),
        };
        let count = stretches(&parts).count();
        let nothing = StretchErrors {
            time_s: 0.0,
            max_um: 0.0,
            place: ErrorPlace::Way,
            way_um: 0.0,
        };
        let mut all = FeedErrors {
            time_s: 0.0,
            rms_um: 0.0,
            max_um: 0.0,
            stretches: vec![nothing; count],
        };
        let phases = on(self.machine).phases();
        for CutPhase { machine, wait_s } in &phases {
            let (program, mut kept) = (waited(&program, *wait_s), CutRows::new(&original));
            let run = match way {
                CutWay::Controlled => self.controlled(machine, &program, &mut kept, &silent),
                CutWay::Uncorrected | CutWay::Corrected => {
                    on(machine).cut(&program, &mut [&mut kept])
                }
            };
            let run = run.map_err(|error| kept.fault(error, machine.period.servo_s))?;
            all.take(&run, &kept.rows, machine, *wait_s);
            all.rms_um += mean_square_um2(&kept.rows) / phases.len() as f64;
        }
        all.rms_um = all.rms_um.sqrt();
        Ok(all)
    }

    fn controlled(
        &mut self,
        machine: &Machine,
        program: &[Step],
        kept: &mut CutRows<'_>,
        watch: &dyn Watch,
    ) -> Result<RunResult, RunError> {
        Run::on(machine)
            .within_drives()
            .laps(self.laps)
            .watched(watch)
            .cut_boxed_steps(program, &mut self.controller, &mut [kept])
    }
}

/// Mean square of the errors where the program cuts, um2.
fn mean_square_um2(rows: &[CutRow]) -> f64 {
    let cutting = || {
        rows.iter()
            .filter(|row| row.cutting)
            .map(|row| 1e3 * norm(row.error_mm))
    };
    cutting().map(|um| um * um).sum::<f64>() / (cutting().count().max(1) as f64)
}

impl FeedErrors {
    /// Adds one of several cuts to all figures but the RMS.
    fn take(&mut self, run: &RunResult, rows: &[CutRow], machine: &Machine, wait_s: f64) {
        self.time_s = run.time_s - wait_s;
        let cutting = rows
            .iter()
            .filter(|row| row.cutting)
            .map(|row| 1e3 * norm(row.error_mm));
        self.max_um = cutting.fold(self.max_um, f64::max);
        let servo_s = machine.period.servo_s;
        let settles = (SETTLES_IN / machine.slowest_kp_1_s() / servo_s).ceil() as usize;
        let by_stretch = by_stretch(rows, self.stretches.len(), &(0..self.stretches.len()));
        for (stretch, cut) in self.stretches.iter_mut().zip(by_stretch) {
            stretch.take(&cut, rows, settles);
            stretch.time_s = f64::from(cut.periods) * servo_s;
        }
        if run.outcome != Outcome::Completed {
            self.max_um = f64::INFINITY;
        }
    }
}

impl StretchErrors {
    /// Adds one of several cuts. The tool settles in the first and last `settles` rows, which do
    /// not count for `way_um`.
    fn take(&mut self, cut: &StretchCut, rows: &[CutRow], settles: usize) {
        let (from, to) = (
            cut.rows.start + settles,
            cut.rows.end.saturating_sub(settles),
        );
        let way = rows.get(from..to.max(from)).unwrap_or_default();
        let way = way
            .iter()
            .filter(|row| row.cutting)
            .map(|row| 1e3 * norm(row.error_mm));
        self.way_um = way.fold(self.way_um, f64::max);
        if 1e3 * cut.max_mm > self.max_um {
            self.max_um = 1e3 * cut.max_mm;
            let early = cut.max_row < cut.rows.start + (cut.rows.len() / 2).min(settles);
            let place = if cut.max_row >= to {
                ErrorPlace::End
            } else {
                ErrorPlace::Way
            };
            self.place = if early { ErrorPlace::Start } else { place };
        }
    }
}
