//! One program on one machine: uncorrected, and with controllers that were made for the machine or
//! for another one.
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use feedwright::CutErrors;
use feedwright::{BASELINE, Choices, Entry, Make, Setup, Statistics, UNCORRECTED};
use feedwright_sim::{
    BoxedController, Cancelled, Commanded, Machine, Outcome, PlanCache, Row, Run, RunError,
    RunResult, Sink, Watch,
};
use serde::{Deserialize, Serialize};

use super::SweepOptions;
use super::program::SweepProgram;

/// Motion after which rows count for [`Figures::later_rms_um`], s: a controller that learns while
/// it cuts has learned by then.
const LATER_S: f64 = 2.0;
/// Cutting time that they need to have, s: less is a corner or two.
const LEAST_LATER_S: f64 = 1.0;
/// Reason that is reported for a cut that panicked.
const PANICKED: &str = "it panicked";

/// Figures of a cut.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// RMS contour error, um.
    pub rms_um: f64,
    /// Largest contour error, um.
    pub max_um: f64,
    /// Uncut path: the largest distance of a point of the path from what the tool did around its
    /// time, um.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncut_um: Option<f64>,
    /// RMS contour error from the third second of motion on, um; none where less than a second of
    /// cutting is left then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub later_rms_um: Option<f64>,
    /// Part of the cutting time during which the controller was in the loop.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub engaged_share: Option<f64>,
    /// Why it was not cut to its end, or not with the controller in the loop.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lost: Option<String>,
    /// Machining time, s.
    pub time_s: f64,
}

impl Figures {
    /// Extracts the figures that the verdict uses from a run. No other code reads a run for this
    /// purpose.
    pub(crate) fn of(run: &RunResult, statistics: &Statistics, entry: &Entry) -> Self {
        // The uncorrected cut has nothing that could be taken out of the loop.
        let can_leave = entry.name != BASELINE && !run.engaged_at_end;
        let left = run.faded_out.filter(|_| can_leave);
        let lost = match run.outcome {
            Outcome::Diverged { at_s } => Some(format!("the loop diverged at {at_s:.3} s")),
            Outcome::Completed => {
                left.map(|left| format!("uncorrected from {:.3} s on: {}", left.at_s, left.cause))
            }
        };
        Self {
            rms_um: statistics.rms_um(),
            max_um: statistics.max_um(),
            uncut_um: Some(run.uncut_mm * 1e3),
            later_rms_um: None,
            engaged_share: Some(run.engaged_share),
            lost,
            time_s: run.time_s,
        }
    }

    /// The errors that decide whether one cut is worse than another.
    pub(super) const fn errors(&self) -> CutErrors {
        CutErrors {
            rms_um: self.rms_um,
            max_um: self.max_um,
            uncut_um: self.uncut_um,
        }
    }

    /// A cut that did not end.
    pub(crate) fn failed(why: &str) -> Self {
        Self {
            lost: Some(why.to_owned()),
            ..Self::default()
        }
    }
}

/// A program on a machine, uncorrected and corrected.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepRow {
    /// Program.
    pub program: String,
    /// Machine.
    pub machine: String,
    /// Machine that the controller is made for, where that is another one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<String>,
    /// Controller.
    #[serde(default)]
    pub controller: String,
    /// True if the machine is rigid, without encoder steps and without delay.
    pub rigid: bool,
    /// Figures of the uncorrected cut.
    pub uncorrected: Figures,
    /// Figures with the controller.
    pub corrected: Figures,
}

/// Returns true if no axis has a compliant transmission, an encoder step, command delay or drive
/// delay. Encoder noise and measurement delay are not checked.
pub(crate) fn is_rigid(machine: &Machine) -> bool {
    machine.axes.iter().all(|axis| {
        axis.transmission.is_none()
            && axis.encoder_step_um == 0.0
            && axis.drive_delay_s + axis.command_delay_s == 0.0
    })
}

/// RMS contour error from the third second of motion on.
#[derive(Debug, Default)]
struct LaterError {
    servo_s: f64,
    moving: u64,
    cutting: u64,
    square_sum_mm2: f64,
}

impl LaterError {
    /// Returns the RMS error, um; `None` if less than a second of cutting was left.
    fn rms_um(&self) -> Option<f64> {
        let is_enough = self.cutting as f64 * self.servo_s >= LEAST_LATER_S;
        is_enough.then(|| 1e3 * (self.square_sum_mm2 / self.cutting as f64).sqrt())
    }
}

impl Sink for LaterError {
    fn row(&mut self, row: &Row) -> io::Result<()> {
        self.moving += u64::from(row.commanded != Commanded::Rest);
        if row.cutting && self.moving as f64 * self.servo_s > LATER_S {
            self.cutting += 1;
            self.square_sum_mm2 += row.contour_error_mm * row.contour_error_mm;
        }
        Ok(())
    }
}

/// Cuts with controllers that were made for one machine, and uncorrected.
pub struct Cutter {
    model: Arc<Machine>,
    choices: Choices,
    /// Uncorrected first.
    entries: Vec<&'static Entry>,
    /// Controllers of two and of three axes, each made where it is needed.
    made: [Vec<Option<BoxedController>>; 2],
}

impl Cutter {
    /// Starts with a machine to make controllers for; nothing is identified yet.
    pub fn new(model: &Arc<Machine>, options: &SweepOptions) -> Self {
        let entries = [&[&UNCORRECTED][..], &options.controllers].concat();
        let choices = Choices {
            seed: options.seed,
            set: options.set_for(model),
            ..Choices::default()
        };
        Self {
            model: model.clone(),
            choices,
            made: [2, 3].map(|_: usize| entries.iter().map(|_| None).collect()),
            entries,
        }
    }

    /// Returns true if the controllers are made for this machine.
    pub(super) fn is_for(&self, model: &Arc<Machine>) -> bool {
        Arc::ptr_eq(&self.model, model)
    }

    /// Cuts a program once, uncorrected (way 0) or with one of the controllers.
    fn cut(
        &mut self,
        way: usize,
        program: &SweepProgram,
        run: (Run<'_>, f64),
    ) -> Result<Figures, Cancelled> {
        let mut setup = Setup::new(&self.model, &self.choices);
        let entry = self.entries[way];
        if program.axes > self.model.axis_count() {
            return Ok(Figures::failed("the machine has no Z"));
        }
        let made = &mut self.made[program.axes - 2][way];
        once(made, entry, &mut setup, program, run)
    }

    /// Cuts a program on a machine uncorrected and with every controller: a row for each.
    ///
    /// # Errors
    /// An end from outside.
    pub fn rows(
        &mut self,
        program: &SweepProgram,
        machine: &Machine,
        watch: &dyn Watch,
    ) -> Result<Vec<SweepRow>, Cancelled> {
        let plan = PlanCache::default();
        let run = Run::on(machine).sharing(&plan).watched(watch);
        let run = (run, machine.period.servo_s);
        let mut uncorrected = self.cut(0, program, run)?;
        if uncorrected.lost.as_deref() == Some(PANICKED) {
            // It is judged: so are the others, which panic too.
            uncorrected = Figures::default();
        }
        let ways = 1..self.entries.len();
        let row = |way: usize| {
            Ok(SweepRow {
                program: program.name.clone(),
                machine: machine.name.clone(),
                model: None,
                controller: self.entries[way].name.to_owned(),
                rigid: is_rigid(machine),
                uncorrected: uncorrected.clone(),
                corrected: self.cut(way, program, run)?,
            })
        };
        ways.map(row).collect()
    }
}

/// Cuts a program once with a controller. Makes the controller first where needed.
fn once(
    made: &mut Option<BoxedController>,
    entry: &Entry,
    setup: &mut Setup<'_>,
    program: &SweepProgram,
    (run, servo_s): (Run<'_>, f64),
) -> Result<Figures, Cancelled> {
    let done = catch_unwind(AssertUnwindSafe(|| {
        let controller = made.get_or_insert_with(|| entry.make(setup, program.axes));
        let mut statistics = Statistics::new();
        let mut later = LaterError {
            servo_s,
            ..Default::default()
        };
        let sinks: &mut [&mut dyn Sink] = &mut [&mut statistics, &mut later];
        let run = run.laps(entry.laps);
        match run.cut_boxed_steps(&program.steps, controller, sinks) {
            Ok(run) => Ok(Figures {
                later_rms_um: later.rms_um(),
                ..Figures::of(&run, &statistics, entry)
            }),
            Err(RunError::Cancelled(cancelled)) => Err(cancelled),
            Err(error) => Ok(Figures::failed(&error.to_string())),
        }
    }));
    // What has panicked is in no state to cut the next program.
    done.unwrap_or_else(|_| {
        *made = None;
        Ok(Figures::failed(PANICKED))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::never_worse::program::Length;
    use crate::peers::{CONTROLLERS, DISTURBANCE_OBSERVER};
    use feedwright::BEST;

    #[test]
    fn a_circle_is_cut_better_with_the_controllers_than_without() {
        let machine = Arc::new(Machine::load("tnv40".as_ref()).expect("built in"));
        let length = Length(&machine, 10.0);
        let program = SweepProgram::from_text("circle", "G21 F1200\nG2 X0 Y0 I5 J0\nM2\n", length)
            .expect("a program");
        let best = CONTROLLERS.find(BEST).expect("in the table");
        let options = SweepOptions::of(vec![best, &DISTURBANCE_OBSERVER]);
        let rows = Cutter::new(&machine, &options)
            .rows(&program, &machine, &())
            .expect("nobody ends it");
        let names: Vec<&str> = rows.iter().map(|row| row.controller.as_str()).collect();
        assert_eq!(names, [BEST, DISTURBANCE_OBSERVER.name]);
        assert!(
            rows[0].rigid && rows[0].corrected.rms_um < 0.1 * rows[0].uncorrected.rms_um,
            "{rows:?}"
        );
        assert_eq!(
            (&rows[0].corrected.lost, rows[0].corrected.engaged_share),
            (&None, Some(1.0))
        );
        assert_eq!(rows[0].uncorrected, rows[1].uncorrected);
        assert!(
            rows[0].corrected != rows[1].corrected
                && rows[1].corrected.rms_um < rows[1].uncorrected.rms_um
        );
    }

    #[test]
    fn the_later_error_comes_from_cutting_rows_from_the_third_second_of_motion_on() {
        let later = |seconds: f64| {
            let mut later = LaterError {
                servo_s: 0.001,
                ..Default::default()
            };
            let mut rows = |commanded, cutting, error_mm, count: u32| {
                let row = Row {
                    commanded,
                    cutting,
                    contour_error_mm: error_mm,
                    ..Row::AT_REST
                };
                (0..count).for_each(|_| later.row(&row).expect("nothing is written"));
            };
            // A second of rest, two of motion, then a rapid, and cutting with 3 and 4 um.
            rows(Commanded::Rest, true, 1.0, 1000);
            rows(Commanded::Cut, true, 1.0, 2000);
            rows(Commanded::Rapid, false, 1.0, 500);
            rows(Commanded::Cut, true, 3e-3, (500.0 * seconds) as u32);
            rows(Commanded::Cut, true, -4e-3, (500.0 * seconds) as u32);
            later.rms_um()
        };
        assert!((later(2.0).expect("long enough") - 12.5_f64.sqrt()).abs() < 1e-9);
        assert_eq!(later(0.9), None);
    }
}
