//! Cuts on machines that fit the recording of the model, all with the controller of that model.
//!
//! The plan of the cut and the limits of the machine stay. So does what the recording does not
//! show: the geometry. Each machine has noise of its own.

use feedwright_sim::{Axis, Machine, Outcome, Row, RunError, Sink, Watch, map_in_parallel};

use super::cuts::PlannedCut;
use super::{Job, JobError};
use crate::report::{Band, BandErrors, RunSummary, Statistics};

/// Machining time that a band covers at the most, s: of a longer cut only the beginning.
const MOST_S: f64 = 30.0;

/// Result of a cut on one machine: RMS and largest error at the tool and by the encoders, um;
/// `None` where it diverged.
type CutOfOne = Option<([f64; 2], Option<[f64; 2]>)>;

impl Job {
    /// The band of a cut; `None` where no machines are given for it, or the cut did not come to its
    /// end.
    pub(super) fn band(
        &self,
        axes: usize,
        plan: PlannedCut<'_>,
        completed: Option<&RunSummary>,
        watch: &dyn Watch,
    ) -> Result<Option<Band>, JobError> {
        let Some(cut) = completed.filter(|_| !self.fitting.is_empty()) else {
            return Ok(None);
        };
        watch.begin(
            "cutting on machines that fit the recording",
            self.fitting.len() as u64,
        );
        let first_s = (cut.time_s > MOST_S).then_some(MOST_S);
        let cut = |(i, fitting): (usize, &Machine)| {
            let machine = on_job(plan.machine, fitting, i as u64 + 1);
            let cut = self.cut_on(axes, (&machine, plan), first_s, watch);
            watch.advance(1);
            cut
        };
        let cuts: Vec<CutOfOne> = map_in_parallel(self.fitting.iter().enumerate(), cut)
            .into_iter()
            .collect::<Result<_, _>>()?;
        let tool: Vec<[f64; 2]> = cuts.iter().flatten().map(|(tool, _)| *tool).collect();
        let joints: Option<Vec<[f64; 2]>> =
            cuts.iter().flatten().map(|(_, joints)| *joints).collect();
        let of = |errors: &[[f64; 2]], i: usize| {
            BandErrors::of(errors.iter().map(|both| both[i]).collect())
        };
        let (Some(rms_um), Some(max_um)) = (of(&tool, 0), of(&tool, 1)) else {
            return Ok(None);
        };
        Ok(Some(Band {
            machines: tool.len(),
            diverged: cuts.len() - tool.len(),
            first_s,
            rms_um,
            max_um,
            joint_rms_um: joints.as_ref().and_then(|joints| of(joints, 0)),
            joint_max_um: joints.as_ref().and_then(|joints| of(joints, 1)),
        }))
    }

    /// Cuts on one machine, to the end or only the beginning.
    fn cut_on(
        &self,
        axes: usize,
        (machine, plan): (&Machine, PlannedCut<'_>),
        first_s: Option<f64>,
        watch: &dyn Watch,
    ) -> Result<CutOfOne, JobError> {
        // The design of a controller does not end early.
        watch.check()?;
        let mut controller = self.own_controller(axes)?;
        let cancels = CancelsOnly(watch);
        let mut beginning = Beginning {
            statistics: Statistics::new(),
            until_s: first_s.unwrap_or(f64::INFINITY),
        };
        let plan = PlannedCut {
            machine,
            looked_at: None,
            ..plan
        };
        let joints = match self.cut_planned(
            plan,
            self.controller,
            &mut controller,
            &mut [&mut beginning],
            &cancels,
        ) {
            Ok(result) if result.outcome != Outcome::Completed => return Ok(None),
            Ok(result) => result
                .joint_error
                .map(|error| [1e3 * error.rms_mm, 1e3 * error.max_mm]),
            // The sink takes no more behind the beginning.
            Err(RunError::Write(_)) if first_s.is_some() => None,
            Err(error) => return Err(JobError::of_run(&self.program, error)),
        };
        let statistics = beginning.statistics;
        Ok(Some(([statistics.rms_um(), statistics.max_um()], joints)))
    }
}

/// Takes rows up to a moment.
struct Beginning {
    statistics: Statistics,
    until_s: f64,
}

impl Sink for Beginning {
    fn row(&mut self, row: &Row) -> std::io::Result<()> {
        if row.t_s > self.until_s {
            return Err(std::io::Error::other("the beginning is over"));
        }
        self.statistics.row(row)
    }
}

/// Lets a watch cancel a cut without receiving its progress.
struct CancelsOnly<'a>(&'a dyn Watch);

impl Watch for CancelsOnly<'_> {
    fn is_cancelled(&self) -> bool {
        self.0.is_cancelled()
    }
}

/// The machine of the job with the axes of a recorded one, and noise of another seed.
fn on_job(machine: &Machine, recorded: &Machine, seed: u64) -> Machine {
    let mut on = machine.with_noise_seed(machine.noise.seed.wrapping_add(seed));
    for (axis, recorded) in on.axes.iter_mut().zip(&recorded.axes) {
        *axis = on_axis(axis, recorded);
    }
    if recorded.period.servo_s.to_bits() == machine.period.servo_s.to_bits() {
        on.period = recorded.period;
    }
    on
}

/// A recorded axis on the screw of an axis of the job, with its limits and its geometry. The motion
/// in mm stays the same.
fn on_axis(axis: &Axis, recorded: &Axis) -> Axis {
    let turns = recorded.lead_mm_per_rev / axis.lead_mm_per_rev;
    Axis {
        lead_mm_per_rev: axis.lead_mm_per_rev,
        coulomb_friction_nm: turns * recorded.coulomb_friction_nm,
        coulomb_asymmetry_nm: turns * recorded.coulomb_asymmetry_nm,
        coulomb_smoothing_rad_s: turns * recorded.coulomb_smoothing_rad_s,
        stribeck_nm: turns * recorded.stribeck_nm,
        torque_limit_nm: turns * recorded.torque_limit_nm,
        torque_noise_nm: turns * recorded.torque_noise_nm,
        correction_accel_mm_s2: axis.correction_accel_mm_s2,
        fade_accel_mm_s2: axis.fade_accel_mm_s2,
        max_velocity_mm_s: axis.max_velocity_mm_s,
        max_accel_mm_s2: axis.max_accel_mm_s2,
        max_jerk_mm_s3: axis.max_jerk_mm_s3,
        scale_um_m: axis.scale_um_m,
        pitch_error_um: axis.pitch_error_um,
        ..*recorded
    }
}
