//! The numbers of one run, as the page's tables and `--json` give them.

use feedwright_sim::{FadedOut, Machine, Outcome, RunResult, Transition};
use serde::Serialize;

use super::headline::AXES;
use super::histogram::Histogram;
use super::worst::WorstPlace;

/// What [`Statistics`](super::Statistics) cannot see in the rows of a run.
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
    /// Whether the rows are those of a log, not of a simulation.
    pub measured: bool,
    /// What the drives can, where that is known.
    pub drives: Option<DriveLimits>,
    /// What the loop says about the run.
    pub run: RunResult,
}

/// What the drive of each axis can.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveLimits {
    /// Acceleration that a command may have, mm/s2.
    pub accel_mm_s2: [f64; 3],
    /// Torque, N m.
    pub torque_nm: [f64; 3],
}

impl DriveLimits {
    /// Of a machine.
    pub fn of(machine: &Machine) -> Self {
        Self {
            accel_mm_s2: std::array::from_fn(|i| machine.accel_limit_mm_s2(i)),
            torque_nm: std::array::from_fn(|i| machine.axis(i).torque_limit_nm),
        }
    }

    /// What of them is used by the axis that uses most.
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

/// What of the limits of its drives a cut takes, at the moment and on the axis that take most.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CommandShares {
    /// Acceleration of the command.
    pub acceleration: CommandShare,
    /// Torque.
    pub torque: CommandShare,
}

/// A share of the limit of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CommandShare {
    /// X, Y or Z.
    pub axis: &'static str,
    /// 1 is the limit.
    pub share: f64,
}

/// A command that asks for more than this of an acceleration limit must not go to a drive, in
/// percent as the user reads them: the plan may ask for all of it, and the correction for as much.
const MOST_PERCENT: f64 = 200.0;

/// How the speed of the tool leaves the programmed feedrate F, over the time that it cuts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FeedShares {
    /// Share of the time below 0.8 of F.
    pub slow_share: f64,
    /// Share of the time above 1.2 of F.
    pub fast_share: f64,
    /// Largest speed, as a part of F.
    pub largest: f64,
}

impl RunSummary {
    /// Whether most of the part was cut without the correction, or its end.
    pub fn is_mostly_uncorrected(&self) -> bool {
        self.faded_out.is_some() && (self.engaged_share < LEAST_SHARE || !self.engaged_at_end)
    }

    /// The share of the acceleration limit that its command asks for, where that is more than any
    /// drive may get.
    pub fn beyond_drives(&self) -> Option<CommandShare> {
        self.command_share
            .map(|shares| shares.acceleration)
            .filter(|asked| (100.0 * asked.share).round() > MOST_PERCENT)
    }
}

/// Part of the cutting time in which a correction is to be in the loop at least.
const LEAST_SHARE: f64 = 0.5;

/// The numbers of one run. [`Statistics`](super::Statistics) has their exact definitions. Errors
/// and times of a run that diverged are not a number, null in JSON.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunSummary {
    /// Name of the controller.
    pub controller: String,
    /// Name of the machine.
    pub machine: String,
    /// Name of the part.
    pub part: String,
    /// Axes of the machine, 2 or 3.
    pub axes: usize,
    /// Whether it was measured on a machine; simulated where not.
    pub measured: bool,
    /// How the run ended.
    pub outcome: Outcome,
    /// When and why the supervisor took the controller out of the loop last.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub faded_out: Option<FadedOut>,
    /// All that changed of what corrects the command, in order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub transitions: Vec<Transition>,
    /// Part of the cutting time in which the controller was in the loop.
    pub engaged_share: f64,
    /// Whether it was at the end.
    pub engaged_at_end: bool,
    /// Machining time: when the command has ended, s.
    pub time_s: f64,
    /// Root mean square of the contour error over the rows that cut, µm.
    pub rms_um: f64,
    /// Largest contour error of the rows that cut, µm.
    pub max_um: f64,
    /// The same two by the encoders and the compensated geometry, µm; none where the machine has no
    /// geometry that no encoder sees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint_rms_um: Option<f64>,
    /// See above.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joint_max_um: Option<f64>,
    /// Uncut path: largest distance from a programmed point to what the tool did in the time that
    /// it has for it, µm.
    pub uncut_um: f64,
    /// Largest distance of the corrected reference from the programmed path's point of the same
    /// row, µm.
    pub max_deviation_um: f64,
    /// Largest acceleration of the command from one servo period to the next, mm/s2.
    pub max_command_accel_mm_s2: f64,
    /// What it takes of the limits of the drives; none of a log.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub command_share: Option<CommandShares>,
    /// Largest torque of each axis, N m; none of a log: torques of logs are not read.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peak_torque_nm: Option<[f64; 3]>,
    /// The speed of the tool beside the programmed feedrate; none where that is not known, as of a
    /// log.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub feed: Option<FeedShares>,
    /// Arc length that was cut, mm.
    pub cutting_length_mm: f64,
    /// Time during which the tool cut, s.
    pub cutting_time_s: f64,
    /// Servo periods simulated.
    pub rows: u64,
    /// When the tool has arrived at the end, s.
    pub arrival_s: f64,
    /// Computing time of the ticks in which the controller decides, us: half of them take less. Not
    /// shown on the page, which must not depend on the computer.
    pub tick_median_us: f64,
    /// 99.9 % of them take less, us.
    pub tick_p999_us: f64,
    /// The most register entries that one estimate of the contour error looked at.
    pub most_register_entries: usize,
    /// Largest contour errors, largest first, each place once.
    pub worst: Vec<WorstPlace>,
    /// Distribution of the contour error.
    pub histogram: Histogram,
}
