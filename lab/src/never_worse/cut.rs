//! One program on one machine: uncorrected, and with the controller that was made for the machine.
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use feedwright::CutErrors;
use feedwright::{BASELINE, Choices, Entry, Make, Setup, Statistics};
use feedwright_control::Controller;
use feedwright_sim::{Cancelled, Machine, Outcome, PlanCache, Run, RunError, RunResult, Watch};
use serde::{Deserialize, Serialize};

use super::SweepOptions;
use super::program::SweepProgram;
use crate::peers::CONTROLLERS;

/// What a cut came to.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// RMS contour error, um.
    pub rms_um: f64,
    /// Largest contour error, um.
    pub max_um: f64,
    /// Uncut path: the largest distance of a point of the path from what the tool did around its time, um.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncut_um: Option<f64>,
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
    /// What the verdict looks at, of all that a run says about itself: the one place that knows where it stands.
    pub(crate) fn of(run: &RunResult, statistics: &Statistics, entry: &Entry) -> Self {
        // The uncorrected cut has nothing that could be taken out of the loop.
        let left = run.faded_out.filter(|_| entry.name != BASELINE && !run.engaged_at_end);
        let lost = match (run.outcome, left) {
            (Outcome::Diverged { at_s }, _) => Some(format!("the loop diverged at {at_s:.3} s")),
            (Outcome::Completed, Some(left)) => Some(format!("uncorrected from {:.3} s on: {}", left.at_s, left.cause)),
            (Outcome::Completed, None) => None,
        };
        let [rms_um, max_um] = [statistics.rms_um(), statistics.max_um()];
        let (uncut_um, engaged_share) = (Some(run.uncut_mm * 1e3), Some(run.engaged_share));
        Self { rms_um, max_um, uncut_um, engaged_share, lost, time_s: run.time_s }
    }

    /// The errors that decide whether one cut is worse than another.
    pub(super) const fn errors(&self) -> CutErrors {
        CutErrors { rms_um: self.rms_um, max_um: self.max_um, uncut_um: self.uncut_um }
    }

    /// A cut that did not end.
    pub(crate) fn failed(why: &str) -> Self {
        Self { lost: Some(why.to_owned()), ..Self::default() }
    }
}

/// A program on a machine, uncorrected and corrected.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepRow {
    /// Program.
    pub program: String,
    /// Machine.
    pub machine: String,
    /// Whether the machine is rigid, without encoder steps and without delay: no noise, nothing that comes late.
    pub rigid: bool,
    /// Uncorrected.
    pub uncorrected: Figures,
    /// With the controller.
    pub corrected: Figures,
}

/// Whether no axis has a compliant transmission, an encoder step, command delay or drive delay. Encoder noise
/// and measurement delay are not checked.
pub fn is_rigid(machine: &Machine) -> bool {
    machine.axes.iter().all(|axis| {
        axis.transmission.is_none() && axis.encoder_step_um == 0.0 && axis.drive_delay_s + axis.command_delay_s == 0.0
    })
}

/// The two controllers of a number of axes, made where they are needed.
type Pair<const N: usize> = Option<[Box<dyn Controller<N>>; 2]>;

/// Cuts with what was identified on one machine.
pub struct Cutter {
    model: Arc<Machine>,
    options: SweepOptions,
    plane: Pair<2>,
    space: Pair<3>,
}

impl Cutter {
    /// By a machine; nothing is identified yet.
    pub fn new(model: &Arc<Machine>, options: &SweepOptions) -> Self {
        Self { model: model.clone(), options: options.clone(), plane: None, space: None }
    }

    /// Whether it is by this machine.
    pub(super) fn is_for(&self, model: &Arc<Machine>) -> bool {
        Arc::ptr_eq(&self.model, model)
    }

    /// Cuts a program on a machine both ways.
    ///
    /// # Errors
    /// An end from outside.
    pub fn row(&mut self, program: &SweepProgram, machine: &Machine, watch: &dyn Watch) -> Result<SweepRow, Cancelled> {
        let (model, options) = (&self.model, &self.options);
        let [uncorrected, corrected] = match program.axes {
            2 => both(machine, model, options, &mut self.plane, program, watch)?,
            _ if machine.axis_count() < 3 => [Figures::failed("the machine has no Z"), Figures::default()],
            _ => both(machine, model, options, &mut self.space, program, watch)?,
        };
        let (program, machine_name) = (program.name.clone(), machine.name.clone());
        Ok(SweepRow { program, machine: machine_name, rigid: is_rigid(machine), uncorrected, corrected })
    }
}

/// Uncorrected first.
fn both<const N: usize>(
    machine: &Machine,
    model: &Machine,
    options: &SweepOptions,
    pair: &mut Pair<N>,
    program: &SweepProgram,
    watch: &dyn Watch,
) -> Result<[Figures; 2], Cancelled>
where
    Entry: Make<N>,
{
    let base = CONTROLLERS.find(BASELINE).expect("the baseline is in the table");
    let entries = [base, options.controller];
    let done = catch_unwind(AssertUnwindSafe(|| {
        let controllers = pair.get_or_insert_with(|| {
            let choices = Choices { seed: options.seed, set: options.set.clone() };
            entries.map(|entry| Make::make(entry, &mut Setup::new(model, &choices)))
        });
        let [first, second] = controllers;
        let plan = PlanCache::default();
        let one = |controller: &mut dyn Controller<N>, entry: &Entry| {
            let mut statistics = Statistics::new();
            let run = Run::on(machine).laps(entry.laps).sharing(&plan).watched(watch);
            match run.cut_steps(&program.steps, controller, &mut [&mut statistics]) {
                Ok(run) => Ok(Figures::of(&run, &statistics, entry)),
                Err(RunError::Cancelled(cancelled)) => Err(cancelled),
                Err(error) => Ok(Figures::failed(&error.to_string())),
            }
        };
        Ok([one(&mut **first, entries[0])?, one(&mut **second, entries[1])?])
    }));
    // What has panicked is in no state to cut the next program.
    done.unwrap_or_else(|_| {
        *pair = None;
        Ok([Figures::default(), Figures::failed("it panicked")])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::never_worse::program::Length;
    use feedwright::BEST;

    #[test]
    fn a_circle_is_cut_better_with_the_controller_than_without() {
        let machine = Arc::new(Machine::load("tnv40".as_ref()).expect("built in"));
        let length = Length { machine: &machine, limit_s: 10.0 };
        let program = SweepProgram::from_text("circle", "G21 F1200\nG2 X0 Y0 I5 J0\nM2\n", length).expect("a program");
        let options = SweepOptions {
            controller: CONTROLLERS.find(BEST).expect("in the table"),
            set: Vec::new(),
            seed: 1,
            threads: 1,
        };
        let row = Cutter::new(&machine, &options).row(&program, &machine, &()).expect("nobody ends it");
        assert!(row.rigid);
        assert!(row.corrected.rms_um < 0.1 * row.uncorrected.rms_um, "{row:?}");
        assert_eq!((row.corrected.lost, row.corrected.engaged_share), (None, Some(1.0)));
    }
}
