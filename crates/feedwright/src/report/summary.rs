//! The numbers of one run, for the page's tables and `--json`.

use feedwright_sim::{FadedOut, Machine, Outcome, RunResult, Transition};
use serde::{Serialize, Serializer};
#[cfg(feature = "command")]
use serde_json::Value;

use super::headline::AXES;
use super::histogram::Histogram;
use super::worst::WorstPlace;

/// Name in place of a controller for the run of a corrected program, which the target control cuts
/// without feedback.
pub(crate) const AS_EXPORTED: &str = "as exported";

/// Part that a run has in a report. JSON has `RunSummary::role` as `measured`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Role {
    /// Cut that the others are compared with.
    Reference,
    /// Cut of a real machine, from its log.
    Measured,
    /// Cut with the requested controller.
    #[default]
    Corrected,
    /// Cut of the corrected program, by the control that it is for.
    Exported,
}

impl Role {
    /// Returns true if the run was measured on a machine, not simulated.
    pub fn is_measured(self) -> bool {
        self == Self::Measured
    }

    /// Finds the run of this role in results of `run --json`, which have no key for it: the last
    /// simulated cut of the program itself is the requested controller's.
    #[cfg(feature = "command")]
    pub(crate) fn of_results(self, results: &Value) -> Option<&Value> {
        let runs = || results["runs"].as_array().into_iter().flatten();
        let is_measured = |run: &&Value| run["measured"] == true;
        let is_exported = |run: &&Value| run["controller"] == AS_EXPORTED;
        let mut controllers = runs().filter(|run| !is_measured(run) && !is_exported(run));
        match self {
            Self::Measured => runs().find(is_measured),
            Self::Exported => runs().find(is_exported),
            Self::Corrected => controllers.next_back(),
            Self::Reference => controllers.next().filter(|_| controllers.next().is_some()),
        }
    }
}

/// Facts about a run that [`Statistics`](super::Statistics) cannot compute from its rows.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RunFacts {
    /// Name of the controller.
    pub controller: String,
    /// Name of the machine.
    pub machine: String,
    /// Name of the part.
    pub part: String,
    /// Axes of the machine, 2 or 3.
    pub axes: usize,
    /// Part that the run has in the report.
    pub role: Role,
    /// Limits of the drives, if known.
    pub drives: Option<DriveLimits>,
    /// Result of the control loop.
    pub run: RunResult,
}

/// Limits of the drive of each axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveLimits {
    /// Acceleration that a command may have, mm/s2.
    pub(crate) accel_mm_s2: [f64; 3],
    /// Torque, N m.
    pub(crate) torque_nm: [f64; 3],
}

impl DriveLimits {
    /// Returns the limits of a machine.
    pub(crate) fn of(machine: &Machine) -> Self {
        Self {
            accel_mm_s2: std::array::from_fn(|i| machine.axis_command_accel_mm_s2(i)),
            torque_nm: std::array::from_fn(|i| machine.axis(i).torque_limit_nm),
        }
    }

    /// Returns the largest used shares of the limits, each with its axis.
    pub(super) fn shares(
        &self,
        axes: usize,
        accel_mm_s2: [f64; 3],
        torque_nm: [f64; 3],
    ) -> CommandShares {
        let share = |used: [f64; 3], limits: [f64; 3]| {
            let shares = used
                .into_iter()
                .zip(limits)
                .map(|(used, limit)| used / limit)
                .take(axes.clamp(1, 3));
            let (axis, share) = shares
                .enumerate()
                .max_by(|a, b| a.1.total_cmp(&b.1))
                .unwrap_or((0, 0.0));
            CommandShare {
                axis: AXES[axis],
                share,
            }
        };
        CommandShares {
            acceleration: share(accel_mm_s2, self.accel_mm_s2),
            torque: share(torque_nm, self.torque_nm),
        }
    }
}

/// Largest shares of the drive limits that a cut uses, each at the moment and on the axis of its
/// maximum.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct CommandShares {
    /// Acceleration of the command.
    pub(crate) acceleration: CommandShare,
    /// Torque.
    pub(crate) torque: CommandShare,
}

/// A share of the limit of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct CommandShare {
    /// X, Y or Z.
    pub(crate) axis: &'static str,
    /// 1 is the limit.
    pub(crate) share: f64,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde gives a reference")]
fn is_measured<S: Serializer>(role: &Role, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_bool(role.is_measured())
}

/// Largest allowed share of an acceleration limit, in percent as the user reads it. The plan may
/// ask for all of the limit, and the correction for as much again. A command above this share must
/// not go to a drive.
const MOST_PERCENT: f64 = 200.0;

/// Deviation of the tool speed from the programmed feedrate F, over the cutting time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct FeedShares {
    /// Share of the time below 0.8 of F.
    pub(crate) slow_share: f64,
    /// Share of the time above 1.2 of F.
    pub(crate) fast_share: f64,
    /// Largest speed, as a fraction of F.
    pub(crate) largest: f64,
}

impl RunSummary {
    /// Returns true if most of the part, or its end, was cut without the correction.
    pub(crate) fn is_mostly_uncorrected(&self) -> bool {
        self.faded_out.is_some() && (self.engaged_share < LEAST_SHARE || !self.engaged_at_end)
    }

    /// Returns the share of the acceleration limit that its command asks for, if it is more than
    /// any drive may get.
    pub(crate) fn beyond_drives(&self) -> Option<CommandShare> {
        self.command_share
            .map(|shares| shares.acceleration)
            .filter(|asked| (100.0 * asked.share).round() > MOST_PERCENT)
    }
}

/// Smallest part of the cutting time in which a correction must be in the loop, so that the part
/// counts as corrected.
const LEAST_SHARE: f64 = 0.5;

/// The numbers of one run. [`Statistics`](super::Statistics) has their exact definitions. Errors
/// and times of a run that diverged are NaN, null in JSON.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunSummary {
    /// Name of the controller.
    pub controller: String,
    /// Name of the machine.
    pub(crate) machine: String,
    /// Name of the part.
    pub(crate) part: String,
    /// Axes of the machine, 2 or 3.
    pub axes: usize,
    /// Part that the run has in the report.
    #[serde(rename = "measured", serialize_with = "is_measured")]
    pub(crate) role: Role,
    /// Outcome of the run.
    pub outcome: Outcome,
    /// Time and reason of the last disengagement by the supervisor.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) faded_out: Option<FadedOut>,
    /// All changes in what corrects the command, in order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub transitions: Vec<Transition>,
    /// Part of the cutting time in which the controller was in the loop.
    pub(crate) engaged_share: f64,
    /// True where the controller was in the loop at the end.
    pub(crate) engaged_at_end: bool,
    /// Machining time: end of the command, s.
    pub time_s: f64,
    /// Root mean square of the contour error over the rows that cut, µm.
    pub rms_um: f64,
    /// Largest contour error of the rows that cut, µm.
    pub max_um: f64,
    /// RMS contour error at the encoders, with the compensated geometry, µm; none if the machine
    /// has no geometry errors that the encoders do not measure.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint_rms_um: Option<f64>,
    /// Largest contour error at the encoders, with the compensated geometry, µm; none in the same
    /// case.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint_max_um: Option<f64>,
    /// Uncut path: largest distance from a programmed point to the path of the tool in the time
    /// that the tool has for that point, µm.
    pub uncut_um: f64,
    /// Largest distance of the corrected reference from the programmed path's point of the same
    /// row, µm.
    pub(crate) max_deviation_um: f64,
    /// Largest acceleration of the command from one servo period to the next, mm/s2.
    pub(crate) max_command_accel_mm_s2: f64,
    /// Shares of the drive limits that the command uses; none for a log.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) command_share: Option<CommandShares>,
    /// Largest torque of each axis, N m; none for a log: torques of logs are not read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) peak_torque_nm: Option<[f64; 3]>,
    /// Deviation of the tool speed from the programmed feedrate; none if that is not known, as for
    /// a log.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) feed: Option<FeedShares>,
    /// Arc length that was cut, mm.
    pub(crate) cutting_length_mm: f64,
    /// Time during which the tool cut, s.
    pub(crate) cutting_time_s: f64,
    /// Servo periods simulated.
    pub(crate) rows: u64,
    /// Time at which the tool has arrived at the end, s.
    pub(crate) arrival_s: f64,
    /// Median computing time of the ticks in which the controller decides, us. Not shown on the
    /// page, which must not depend on the computer.
    pub tick_median_us: f64,
    /// Computing time that 99.9 % of these ticks stay below, us.
    pub tick_p999_us: f64,
    /// Largest number of register entries that one estimate of the contour error looked at.
    pub(crate) most_register_entries: usize,
    /// Largest contour errors, largest first, each place once.
    pub worst: Vec<WorstPlace>,
    /// Distribution of the contour error.
    pub histogram: Histogram,
}
