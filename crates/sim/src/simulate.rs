//! The closed loop of reference, controller and plant, one servo period after the other.
//!
//! Row n: at t = n Ts, the tick computes the position command from the reference and the measured
//! position. The plant holds the command for one servo period. The contour error of the row
//! compares the tool position at the end of this period with the exact path.
//!
//! | File | What |
//! |---|---|
//! | `simulate/foot.rs` | how far along the path the tool has come, and so the contour error |
//! | `simulate/joints.rs` | the contour error without the geometric errors that no encoder sees |
//! | `simulate/lost_motion.rs` | the command ahead of a table that lags by lost motion |
//! | `simulate/rests.rs` | which part of a long rest is simulated |
//! | `simulate/uncut.rs` | how far the tool stays away from what it should have cut |
//! | `simulate/tick_times.rs` | how long the ticks took |

pub(crate) mod foot;
mod joints;
mod lost_motion;
mod rests;
mod tick_times;
pub(crate) mod uncut;

use feedwright_control::{
    Bounds, Controller, Fade, Knot, KnownGeometry, Part, Setpoint, State, Tick,
};
use feedwright_plan::vector::{Vector, distance, sub};

use crate::kinematics::{joints_of, tool_of};
use crate::machine::Machine;
use crate::plant::{Measurement, Mechanism};
use crate::reference::{Foot, Reference, Sample};
use crate::row::{Commanded, CorrectionChange, FadedOut, Outcome, Row, Sink, Transition};
use crate::watch::{Cancelled, Watch};
use foot::{FootTracker, settled_periods, settled_s};
pub(crate) use joints::JointError;
use joints::JointErrorMeter;
use lost_motion::LostMotion;
pub(crate) use tick_times::TickTimes;
use uncut::Uncut;

/// Multiple of the lag of a rapid beyond which the tool counts as lost. A stable loop of gain Kp
/// lags by v / Kp. If the distance from the command exceeds this multiple, and [`LOST_MM`], the
/// tool no longer follows.
const LOST_LAGS: f64 = 4.0;
/// Least distance at which a tool counts as lost, mm, for loops so stiff that they hardly lag; see
/// [`LOST_LAGS`].
const LOST_MM: f64 = 2.0;
/// The tool has arrived when it is this near a path at rest, mm: a usual in-position width.
const ARRIVED_MM: f64 = 0.01;
/// Longest wait for the tool to arrive, s: friction may hold it off for good.
const ARRIVAL_S: f64 = 0.25;
/// The path is kept for this many times as long as a following tool needs to come to a point of it.
const KEPT_SETTLED_TIMES: f64 = 3.0;

/// Rows between two checks whether to go on: some milliseconds.
const ROWS_BETWEEN_CHECKS: u64 = 1000;

/// Results of a run beyond its rows.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RunResult {
    /// Outcome of the run.
    pub outcome: Outcome,
    /// Last time that the supervisor took the controller out of the loop, with the cause.
    pub faded_out: Option<FadedOut>,
    /// Every change of the correction, in order.
    pub transitions: Vec<Transition>,
    /// Part of the cutting time in which the controller was in the loop, and whether it was at the
    /// end.
    pub engaged_share: f64,
    /// See above.
    pub engaged_at_end: bool,
    /// Machining time: when the command has ended, s.
    pub time_s: f64,
    /// Time at which the tool has arrived at the end, s.
    pub arrival_s: f64,
    /// The contour error without the geometry that no encoder sees; none where the machine has no
    /// such geometry.
    pub joint_error: Option<JointError>,
    /// The uncut path: the largest distance from a programmed point to what the tool did in the
    /// time that it has for it, mm.
    pub uncut_mm: f64,
    /// The most register entries that one contour error estimate looked at.
    pub most_entries: usize,
    /// Time of the ticks in which the controller decided, by [`Watch::clock`].
    pub ticks: TickTimes,
}

/// Why a lap did not go on to its end.
#[derive(Debug)]
pub enum Stopped {
    /// A sink takes no more rows.
    Write(std::io::Error),
    /// Ended from outside.
    Cancelled(Cancelled),
}

impl From<std::io::Error> for Stopped {
    fn from(error: std::io::Error) -> Self {
        Self::Write(error)
    }
}

impl From<Cancelled> for Stopped {
    fn from(cancelled: Cancelled) -> Self {
        Self::Cancelled(cancelled)
    }
}

/// Makes the machine of a lap, at rest with its joints at the given place, mm, and with random
/// numbers by the given seed.
pub type PlantMaker<'a> = &'a dyn Fn([f64; 3], u64) -> Box<dyn Mechanism>;

/// Part of the acceleration of an axis that makes up for lost motion where it turns at this
/// acceleration. Where the plan takes 0.85 of it the rest is 0.15, and 0.2 times 0.85 squared.
const LEAD_SHARE: f64 = 0.2;

/// Machine and options that a lap is cut with.
#[derive(Clone, Copy)]
pub(crate) struct LapSetup<'a, const N: usize> {
    /// The machine.
    pub(crate) machine: &'a Machine,
    /// Maker of a plant that replaces the machine's own.
    pub(crate) plant: Option<PlantMaker<'a>>,
    /// The geometry that the control compensates.
    pub(crate) known: Option<&'a KnownGeometry<N>>,
    /// True if the offset keeps the acceleration limits of the axes where the owner states none.
    pub(crate) within_drives: bool,
}

/// Cuts the whole reference, one lap; every row goes to every sink. The controller is as the caller
/// has it: at its beginning, or with what it learnt in the laps before.
///
/// # Errors
/// What a sink says when it takes no more, or an end from outside.
pub(crate) fn simulate<const N: usize>(
    setup: LapSetup<'_, N>,
    reference: &mut Reference<'_>,
    controller: &mut dyn Controller<N>,
    sinks: &mut [&mut dyn Sink],
    watch: &dyn Watch,
) -> Result<RunResult, Stopped> {
    let mut lap = ClosedLoop::new(setup, reference, controller);
    let (mut n, mut rows) = (0_u64, 0_u64);
    while let Some(periods) = lap.servo_period(n, reference, controller, sinks, watch)? {
        n += periods;
        rows += 1;
        if rows.is_multiple_of(ROWS_BETWEEN_CHECKS) {
            watch.check()?;
        }
    }
    Ok(lap.finish())
}

/// A lap under way.
struct ClosedLoop<'a, const N: usize> {
    machine: &'a Machine,
    joints: Joints<'a, N>,
    lost_motion: LostMotion<N>,
    servo_s: f64,
    kept_s: f64,
    lost_mm: f64,
    feed_periods: u32,
    tick: Tick<N>,
    plant: Box<dyn Mechanism>,
    foot: FootTracker,
    joint_error: Option<JointErrorMeter>,
    uncut: Uncut,
    /// The measured position.
    seen_mm: [f64; N],
    run: RunResult,
    /// Time at which the command has ended.
    ended_s: Option<f64>,
    last_tau_s: f64,
    /// State of the correction: the last fade, whether the controller is in the loop, and which
    /// axes use a learned model.
    fade: Option<Fade>,
    engaged: bool,
    learned: [bool; N],
    /// Servo periods that cut: without the controller in the loop, and with it.
    cut: [u64; 2],
}

impl<'a, const N: usize> ClosedLoop<'a, N> {
    /// Starts at rest at the start of the path.
    fn new(
        setup: LapSetup<'a, N>,
        reference: &mut Reference<'_>,
        controller: &dyn Controller<N>,
    ) -> Self {
        let LapSetup {
            machine,
            plant,
            known,
            within_drives,
        } = setup;
        let joints = Joints { known };
        let servo_s = machine.period.servo_s;
        let slowest_s = 1.0 / machine.slowest_kp_1_s();
        let at_mm = reference.at(0.0).position_mm;
        let start_mm = joints.at(at_mm);
        let fade_mm_s2 = (0..N)
            .map(|i| machine.correction_accel_mm_s2(i))
            .fold(f64::INFINITY, f64::min);
        let uncrossed_mm = uncrossed_mm(known, controller);
        let turning_mm_s2: [f64; N] = std::array::from_fn(|i| machine.turning_accel_mm_s2(i));
        let lead_mm_s2 = std::array::from_fn(|i| {
            // What the owner allows beyond the limit is not shared.
            let allowed_mm_s2 = machine.axis(i).correction_accel_mm_s2;
            allowed_mm_s2.map_or(LEAD_SHARE * turning_mm_s2[i], |mm_s2| {
                mm_s2.min(turning_mm_s2[i])
            })
        });
        let limits = &machine.limits;
        let bounds = Bounds::new(limits.max_deviation_mm, limits.rapid_mm_s, fade_mm_s2);
        let bounds = Bounds {
            engaged_mm_s2: machine.owners_accel_mm_s2(),
            command_mm_s2: std::array::from_fn(|i| {
                if within_drives {
                    machine.axis_command_accel_mm_s2(i)
                } else {
                    f64::INFINITY
                }
            }),
            ..bounds.feed_rise(limits.max_feed_rise_percent)
        };
        let plant: Box<dyn Mechanism> = match plant {
            Some(make) => make(tool_of(start_mm), machine.noise.seed),
            None => <dyn Mechanism>::of(machine, N, tool_of(start_mm)),
        };
        Self {
            machine,
            joints,
            lost_motion: LostMotion::new(uncrossed_mm, turning_mm_s2, lead_mm_s2),
            servo_s,
            kept_s: KEPT_SETTLED_TIMES * settled_s(machine),
            lost_mm: LOST_MM.max(LOST_LAGS * machine.limits.rapid_mm_s * slowest_s),
            feed_periods: controller.schedule().servo_periods.max(1),
            tick: Tick::new(servo_s, controller.schedule(), bounds),
            foot: FootTracker::new(machine, at_mm),
            joint_error: (known.is_some() || plant.has_geometry())
                .then(|| JointErrorMeter::new(machine, at_mm)),
            plant,
            uncut: Uncut::new(settled_periods(machine), at_mm),
            seen_mm: start_mm,
            run: RunResult::default(),
            ended_s: None,
            last_tau_s: 0.0,
            fade: None,
            engaged: true,
            learned: [false; N],
            cut: [0; 2],
        }
    }

    /// Cuts servo period `n`, and says how many on the next to simulate is: more than one in a long
    /// rest. None where the lap is over.
    fn servo_period(
        &mut self,
        n: u64,
        reference: &mut Reference<'_>,
        controller: &mut dyn Controller<N>,
        sinks: &mut [&mut dyn Sink],
        watch: &dyn Watch,
    ) -> std::io::Result<Option<u64>> {
        let t_s = n as f64 * self.servo_s;
        let setpoint = self.command(t_s, reference, controller, watch);
        let measurement: Measurement<N> = self.plant.step(tool_of(setpoint.command_mm)).of_axes();
        self.seen_mm = measurement.measured_mm;
        if self.is_lost(t_s, distance(measurement.joint_mm, setpoint.command_mm)) {
            return Ok(None);
        }
        let sample = reference.at(setpoint.tau_s);
        let tau_s = reference
            .end_s()
            .map_or(setpoint.tau_s, |end_s| setpoint.tau_s.min(end_s));
        // A command that a correction holds beside the end of the path is not where the tool is to
        // rest. And where the encoders say so: what they do not see is not waited for.
        let to_go_mm = distance(measurement.joint_mm, self.joints.at(sample.position_mm));
        let foot = self.foot.foot(
            reference,
            tau_s,
            sample.s_mm,
            tool_of(measurement.position_mm),
        );
        let lead_mm = Axes {
            reference,
            joints: self.joints,
            lost_motion: self.lost_motion,
        }
        .lead_mm(setpoint.tau_s);
        let row = Row {
            corrected_mm: self.joints.tool(sub(setpoint.command_mm, lead_mm)),
            ..row(
                t_s,
                &setpoint,
                &measurement,
                &sample,
                &foot,
                to_go_mm <= ARRIVED_MM,
            )
        };
        if row.cutting {
            self.cut[usize::from(self.tick.state() == State::Engaged)] += 1;
        }
        while let Some(timed) = reference.next_event(setpoint.tau_s) {
            for sink in sinks.iter_mut() {
                sink.event(t_s, &timed)?;
            }
        }
        for sink in sinks.iter_mut() {
            sink.row(&row)?;
        }
        self.uncut.row(&row);
        if let Some(meter) = &mut self.joint_error {
            meter.row(
                reference,
                tau_s,
                self.joints.tool(measurement.joint_mm),
                &row,
            );
        }
        reference.forget_before(tau_s - self.kept_s);
        if let Some(ended_s) = self.ended_s
            && (to_go_mm <= ARRIVED_MM || t_s >= ended_s + ARRIVAL_S)
        {
            self.run.arrival_s = t_s + self.servo_s;
            return Ok(None);
        }
        let left_out = if sample.resting {
            self.left_out(reference, setpoint.tau_s)
        } else {
            0
        };
        self.tick.skip(left_out);
        self.plant.skip(left_out);
        Ok(Some(1 + left_out))
    }

    /// The tick of a servo period, and what it says about the run.
    fn command(
        &mut self,
        t_s: f64,
        reference: &mut Reference<'_>,
        controller: &mut dyn Controller<N>,
        watch: &dyn Watch,
    ) -> Setpoint<N> {
        let began = watch.clock();
        let setpoint = {
            let Self {
                tick,
                joints,
                lost_motion,
                seen_mm,
                ..
            } = self;
            tick.step(
                &mut Axes {
                    reference,
                    joints: *joints,
                    lost_motion: *lost_motion,
                },
                controller,
                *seen_mm,
            )
        };
        if setpoint.decided {
            self.run
                .ticks
                .add(watch.clock().saturating_sub(began).as_nanos());
            self.run.most_entries = self.run.most_entries.max(self.tick.contour().entries);
            self.note_changes(t_s, setpoint.tau_s, reference);
        }
        if self.ended_s.is_none()
            && let Some(end_s) = reference.end_s()
            && setpoint.tau_s >= end_s
        {
            self.ended_s = Some(t_s);
            self.run.time_s = crossing(t_s, self.servo_s, self.last_tau_s, setpoint.tau_s, end_s);
        }
        self.last_tau_s = setpoint.tau_s;
        setpoint
    }

    /// Records every change of the correction.
    fn note_changes(&mut self, t_s: f64, tau_s: f64, reference: &mut Reference<'_>) {
        let (fade, engaged, learned) = (
            self.tick.fade(),
            self.tick.state() == State::Engaged,
            self.tick.learned(),
        );
        if (fade, engaged, learned) == (self.fade, self.engaged, self.learned) {
            return;
        }
        let line = reference.at(tau_s).line;
        let of = |change| Transition {
            at_s: t_s,
            line,
            change,
            axis: None,
            cause: None,
            found_um: None,
            limit_um: None,
        };
        if let Some(left) = fade.filter(|_| fade != self.fade) {
            let cause = left.cause.words();
            self.run.faded_out = Some(FadedOut { at_s: t_s, cause });
            let [found_um, limit_um] = [
                left.evidence.map(|e| e.found_mm),
                left.evidence.map(|e| e.limit_mm),
            ]
            .map(|mm| mm.map(|mm| 1e3 * mm).filter(|um| um.is_finite()));
            self.run.transitions.push(Transition {
                cause: Some(cause),
                found_um,
                limit_um,
                ..of(CorrectionChange::Left)
            });
        }
        if engaged && !self.engaged {
            self.run.transitions.push(of(CorrectionChange::Returned));
        }
        for (axis, (now, before)) in ['x', 'y', 'z']
            .into_iter()
            .zip(learned.into_iter().zip(self.learned))
        {
            if now != before {
                let change = if now {
                    CorrectionChange::Learned
                } else {
                    CorrectionChange::Given
                };
                self.run.transitions.push(Transition {
                    axis: Some(axis),
                    ..of(change)
                });
            }
        }
        (self.fade, self.engaged, self.learned) = (fade, engaged, learned);
    }

    /// Returns true if the tool no longer follows; the run then ends here.
    fn is_lost(&mut self, t_s: f64, following_mm: f64) -> bool {
        let lost = following_mm.is_nan() || following_mm > self.lost_mm;
        if lost {
            self.run.outcome = Outcome::Diverged { at_s: t_s };
            self.run.arrival_s = t_s;
            if self.ended_s.is_none() {
                self.run.time_s = t_s;
            }
        }
        lost
    }

    fn left_out(&self, reference: &mut Reference<'_>, tau_s: f64) -> u64 {
        rests::left_out(
            reference,
            tau_s,
            self.servo_s,
            self.feed_periods,
            settled_s(self.machine),
        )
    }

    fn finish(self) -> RunResult {
        let [out, within] = self.cut;
        RunResult {
            engaged_share: if out + within == 0 {
                1.0
            } else {
                within as f64 / (out + within) as f64
            },
            engaged_at_end: self.run.outcome == Outcome::Completed
                && self.tick.state() == State::Engaged,
            joint_error: self.joint_error.as_ref().map(JointErrorMeter::finish),
            uncut_mm: self.uncut.finish(ARRIVED_MM),
            ..self.run
        }
    }
}

/// The row of a servo period; `arrived` says whether the tool is where the path is.
fn row<const N: usize>(
    t_s: f64,
    setpoint: &Setpoint<N>,
    measurement: &Measurement<N>,
    sample: &Sample,
    foot: &Foot,
    arrived: bool,
) -> Row {
    Row {
        t_s,
        s_mm: sample.s_mm,
        line: sample.line,
        feed_plan_mm_s: sample.feed_mm_s,
        programmed_mm_s: foot.programmed_mm_s,
        cutting: foot.cutting && !(sample.resting && arrived),
        commanded: match (sample.resting, sample.cutting) {
            (true, _) => Commanded::Rest,
            (false, true) => Commanded::Cut,
            (false, false) => Commanded::Rapid,
        },
        path_mm: sample.programmed_mm,
        cmd_mm: tool_of(setpoint.command_mm),
        corrected_mm: tool_of(setpoint.command_mm),
        act_mm: tool_of(measurement.position_mm),
        torque_nm: tool_of(measurement.torque_nm),
        foot_mm: foot.position_mm,
        tangent: foot.tangent,
        contour_error_mm: if N == 2 {
            foot.signed_mm
        } else {
            foot.distance_mm
        },
    }
}

/// Returns the time at which plan time passed `end_s` between the last servo period and this one.
fn crossing(t_s: f64, servo_s: f64, last_tau_s: f64, tau_s: f64, end_s: f64) -> f64 {
    if tau_s > last_tau_s {
        t_s - servo_s * (tau_s - end_s) / (tau_s - last_tau_s)
    } else {
        t_s
    }
}

/// Conversion between tool and joints, by the geometry that the control knows.
#[derive(Clone, Copy)]
struct Joints<'a, const N: usize> {
    known: Option<&'a KnownGeometry<N>>,
}

impl<const N: usize> Joints<'_, N> {
    /// Returns the joint positions for a tool position, mm.
    fn at(&self, tool_mm: Vector) -> [f64; N] {
        let tool_mm = joints_of(tool_mm);
        self.known.map_or(tool_mm, |known| known.joints_mm(tool_mm))
    }

    /// Returns the tool position for joint positions, mm.
    fn tool(&self, joints_mm: [f64; N]) -> Vector {
        tool_of(
            self.known
                .map_or(joints_mm, |known| known.tool_mm(joints_mm)),
        )
    }
}

/// The planned path as the tick sees it: the joints, ahead by the lost motion that the controller
/// does not cross itself.
struct Axes<'a, 'p, 'k, const N: usize> {
    reference: &'a mut Reference<'p>,
    joints: Joints<'k, N>,
    lost_motion: LostMotion<N>,
}

impl<const N: usize> Axes<'_, '_, '_, N> {
    /// Returns the lead of each joint over the planned path, mm.
    fn lead_mm(&mut self, tau_s: f64) -> [f64; N] {
        let Self {
            reference,
            lost_motion,
            ..
        } = self;
        lost_motion.lead_mm(tau_s, |at_s| joints_of(reference.at(at_s).position_mm))
    }
}

impl<const N: usize> feedwright_control::KnotSource<N> for Axes<'_, '_, '_, N> {
    fn knot(&mut self, tau_s: f64) -> Knot<N> {
        let Sample {
            position_mm,
            tangent,
            feed_mm_s,
            rapid,
            ..
        } = self.reference.at(tau_s);
        let tool = Knot {
            position_mm: joints_of(position_mm),
            tangent: joints_of(tangent),
            feed_mm_s,
            cutting: !rapid,
        };
        let Some(known) = self.joints.known else {
            return tool;
        };
        let joints = known.joint_knot(&tool);
        let lead_mm = self.lead_mm(tau_s);
        Knot {
            position_mm: std::array::from_fn(|i| joints.position_mm[i] + lead_mm[i]),
            ..joints
        }
    }
}

/// Lost motion that is known, mm; none where the controller leads the motor by its own model of the
/// screw.
fn uncrossed_mm<const N: usize>(
    known: Option<&KnownGeometry<N>>,
    controller: &dyn Controller<N>,
) -> [f64; N] {
    let Some(known) = known else { return [0.0; N] };
    let axes = controller.known();
    let crosses = |i: usize| {
        axes.as_ref()
            .is_some_and(|axes| axes[i].parameters.has(Part::Screw))
    };
    let lost_mm = known.backlash_mm();
    std::array::from_fn(|i| if crosses(i) { 0.0 } else { lost_mm[i] })
}
