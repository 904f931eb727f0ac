//! What a machine really cut: the contour error of a log against the program that it was cut by, in
//! the rows of a run.
//!
//! ```text
//! s(k)  arc length of the commanded position c(k) of sample k: from s(k - 1) on, no further than a few times the way of the command
//! f(k)  foot of the actual position a(k): between s(k - W) and s(k), no further behind f(k - 1) than a tool vibrates
//! e(k) = |a(k) - P(f(k))|
//! ```
//!
//! Where the path turns back, what lies ahead comes into reach only behind the turn: a point that
//! does not get on reaches as far as it has gone since it did.
//!
//! W is the time in which a loop of the machine has followed, and what a control may delay the
//! command by beside. The record begins where the command first comes to where the program begins
//! to cut; what it shows before, and the way there, are left out. Positions of the machine are
//! those of the program but for a shift along each axis, which is found where both fill boxes of
//! the same size; to less than a micrometre it is known where the command rests before the first
//! cut.
//!
//! Actual positions are those of the encoders: what no encoder sees is not in them.

mod pairing;

use feedwright_gcode::INCH_MM;
use feedwright_ident::{Log, LogAxis, LogFinding};
use feedwright_plan::vector::{Vector, add_scaled, distance, sub};
use feedwright_sim::{
    AXIS_NAMES, Commanded, Foot, Machine, Reference, Row, RunResult, Sink, Stopped, Uncut, Watch,
    settled_s, shown, to_four_digits,
};
use thiserror::Error;

use pairing::PairedAxes;

/// Longest delay of the command in a control before it goes to the drives, s.
const DELAY_S: f64 = 0.05;
/// Largest backward motion of a tool by vibration, mm.
const BACK_MM: f64 = 0.01;
/// Factor from the distance that a point moved to the largest arc length that it may have gained.
/// [`REACH_MM`] is added, mm: corners that are rounded are shorter.
const REACH: f64 = 3.0;
const REACH_MM: f64 = 0.02;
/// The command has come to the beginning where it is this near, mm.
const BEGUN_MM: f64 = 0.05;
/// Largest distance between a cutting command of the log and the program, mm. Beyond it, the log
/// does not match the program.
const LEFT_MM: f64 = 1.0;
/// Boxes that differ by less have the same size, mm, and lie in the same place: corners are
/// rounded.
const SAME_SIZE_MM: f64 = 0.05;
/// Factor between two units, then the unit of the log and the unit that it was read in: the units
/// that are mistaken for one another.
const UNITS: [(f64, &str, &str); 5] = [
    (INCH_MM, "inch", "mm"),
    (1.0 / INCH_MM, "mm", "inch"),
    (1e-3 * INCH_MM, "inch", "m"),
    (1e-3, "mm", "m"),
    (1e3, "m", "mm"),
];
/// Part of their size by which boxes of the same size may differ: a record may begin before the
/// program or end behind it.
const SAME_SIZE: f64 = 0.01;
/// A command that moves by less in a sample rests, mm.
const RESTS_MM: f64 = 1e-6;
/// The path is looked at in steps of so much plan time, s.
const STEP_S: f64 = 0.001;
/// Halvings of such a step: what is left is a billionth of it.
const HALVINGS: usize = 30;
/// Samples between two questions whether to go on.
const SAMPLES_BETWEEN_CHECKS: usize = 10_000;

/// A log of a cut.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredLog {
    /// Name in messages.
    pub name: String,
    /// The log.
    pub log: Log,
}

/// Reasons why a log cannot be compared with a program.
#[derive(Debug, Error, miette::Diagnostic)]
pub enum MeasuredError {
    /// An axis is not in the log.
    #[error("the log has no axis {axis}, which the program moves; it has {there}")]
    #[diagnostic(help("say which column is what: --columns {axis}.cmd=COLUMN,{axis}.act=COLUMN"))]
    MissingAxis {
        /// The axis.
        axis: &'static str,
        /// Axes of the log.
        there: String,
    },
    /// The program has no motion at a feedrate to compare with.
    #[error("the program cuts nothing: it has no motion at a feedrate")]
    NothingCut,
    /// Samples are missing.
    #[error("the log has a gap at {} s: samples are missing", shown(*at_s))]
    #[diagnostic(help("record anew, with a longer buffer of the recorder"))]
    Gap {
        /// Time of the last sample before it, s.
        at_s: f64,
    },
    /// The log is in another unit than it was read in.
    #[error(
        "the log goes over {} mm in {axis}, and the program over {} mm: {} times as much. The log is in {unit}, and was read in {read}",
        to_four_digits(*log_mm), to_four_digits(*program_mm), to_four_digits(program_mm / log_mm)
    )]
    #[diagnostic(help(
        "write the line '# unit = {unit}' in front of the log, or say --columns unit={unit}"
    ))]
    Unit {
        /// The axis that goes farthest.
        axis: &'static str,
        /// Travel of the axis in the log, as it was read, mm.
        log_mm: f64,
        /// Travel of the axis in the program, mm.
        program_mm: f64,
        /// The unit that fits.
        unit: &'static str,
        /// The unit that it was read in.
        read: &'static str,
    },
    /// The program was not begun.
    #[error(
        "the command of the log never comes to where the program begins to cut, {}: {} mm away at the nearest, at {} s",
        place(*start_mm), shown(*nearest_mm), shown(*at_s)
    )]
    #[diagnostic(help(
        "a log of another program, or with other offsets; positions of the log are taken for those of the program, \
        shifted where the whole program was recorded"
    ))]
    NotBegun {
        /// Point where the program begins to cut, mm.
        start_mm: Vector,
        /// Smallest distance of the command from that point, mm.
        nearest_mm: f64,
        /// Time of the smallest distance, s.
        at_s: f64,
    },
    /// A command of the log is too far from the program.
    #[error("at {} s the command of the log is {} mm away from the program, at line {line}; at most {LEFT_MM} mm are allowed",
        shown(*at_s), shown(*off_mm))]
    #[diagnostic(help("a log of another program, or one with more than its cut"))]
    Leaves {
        /// Time of the command, s.
        at_s: f64,
        /// Distance of the command from the program, mm.
        off_mm: f64,
        /// Line of the program.
        line: u32,
    },
    /// The log ends before the program.
    #[error("the log ends at line {line}, at {} % of the path", shown((100.0 * share).round()))]
    #[diagnostic(help("record until the program has ended"))]
    EndsEarly {
        /// Line of the program.
        line: u32,
        /// Part of the path that was cut.
        share: f64,
    },
    /// A sink failed, or the work was canceled.
    #[error("{}", match stopped { Stopped::Write(error) => error.to_string(), Stopped::Cancelled(cancelled) => cancelled.to_string() })]
    Stopped {
        /// Cause of the stop.
        stopped: Stopped,
    },
}

fn place(point_mm: Vector) -> String {
    let [x, y, z] = point_mm.map(shown);
    format!("X{x} Y{y} Z{z}")
}

/// A cut that a machine recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredRun {
    /// Result of the run.
    pub run: RunResult,
    /// Assumptions about its axes.
    pub findings: Vec<LogFinding>,
}

/// The rows of a log, as if it were a run: each goes to every sink. `axes` of the machine are
/// compared, 2 or 3. One that stands still in the program need not be in the log.
///
/// # Errors
/// Where the log is not one of this program: see [`MeasuredError`].
pub fn measured(
    log: &Log,
    machine: &Machine,
    axes: usize,
    reference: &mut Reference<'_>,
    sinks: &mut [&mut dyn Sink],
    watch: &dyn Watch,
) -> Result<MeasuredRun, MeasuredError> {
    let located = LocatedLog::of(log, axes, reference)?;
    let run = located.compared(machine, reference, watch, &mut |row| {
        sinks
            .iter_mut()
            .try_for_each(|sink| sink.row(row))
            .map_err(Into::into)
    })?;
    Ok(MeasuredRun {
        run,
        findings: located.findings,
    })
}

/// A log in the coordinates of its program.
#[derive(Debug, Clone)]
pub(crate) struct RecordedCut {
    /// Time between two samples, s.
    pub(crate) sample_s: f64,
    /// Commanded and actual positions of all samples, mm.
    pub(crate) command_mm: Vec<Vector>,
    pub(crate) actual_mm: Vec<Vector>,
    /// The sample that the first row is of.
    pub(crate) first: usize,
    /// The samples from where the program begins to cut, as rows of a run.
    pub(crate) rows: Vec<Row>,
}

/// All samples of a log beside its program, see [`measured`].
///
/// # Errors
/// As [`measured`].
pub(crate) fn recorded_cut(
    log: &Log,
    machine: &Machine,
    axes: usize,
    reference: &mut Reference<'_>,
    watch: &dyn Watch,
) -> Result<RecordedCut, MeasuredError> {
    let located = LocatedLog::of(log, axes, reference)?;
    let mut rows = Vec::new();
    located.compared(machine, reference, watch, &mut |row| {
        rows.push(*row);
        Ok(())
    })?;
    let LocatedLog { record, first, .. } = located;
    let samples: Vec<Sampled> = (0..record.len()).map(|k| record.at(k)).collect();
    Ok(RecordedCut {
        sample_s: log.sample_time_s,
        command_mm: samples.iter().map(|sample| sample.command_mm).collect(),
        actual_mm: samples.iter().map(|sample| sample.actual_mm).collect(),
        first,
        rows,
    })
}

/// A log whose place in the program is known.
struct LocatedLog<'a> {
    sample_s: f64,
    planned: PlannedPath,
    record: RecordedAxes<'a>,
    /// The sample in which the command begins to cut.
    first: usize,
    findings: Vec<LogFinding>,
}

impl<'a> LocatedLog<'a> {
    fn of(log: &'a Log, axes: usize, reference: &mut Reference<'_>) -> Result<Self, MeasuredError> {
        if let [first, _, ..] = &log.stretches[..] {
            return Err(MeasuredError::Gap {
                at_s: log.time_s[first.end - 1],
            });
        }
        let planned = PlannedPath::of(reference)?;
        let PairedAxes {
            axes: recorded,
            findings,
        } = PairedAxes::of(log, planned.range_mm(), axes)?;
        let mut record = RecordedAxes {
            axes: recorded,
            time_s: &log.time_s,
            shift_mm: [0.0; 3],
            still_mm: planned.start_mm,
        };
        planned.check_unit(&record, axes)?;
        record.shift_mm = planned.shift_mm(&record, axes);
        let first = record.begins(planned.start_mm)?;
        record.shift_to(first, planned.start_mm);
        Ok(Self {
            sample_s: log.sample_time_s,
            planned,
            record,
            first,
            findings,
        })
    }

    /// Hands every row to `take`.
    fn compared(
        &self,
        machine: &Machine,
        reference: &Reference<'_>,
        watch: &dyn Watch,
        take: &mut dyn FnMut(&Row) -> Result<(), Stopped>,
    ) -> Result<RunResult, MeasuredError> {
        let Self { record, first, .. } = self;
        let stopped = |stopped| MeasuredError::Stopped { stopped };
        let mut comparison = MeasuredCut::new(
            machine,
            self.sample_s,
            self.planned.start_s_mm,
            &record.at(*first),
        );
        for k in *first..record.len() {
            take(&comparison.row(record, *first, k, reference)?).map_err(stopped)?;
            if (k - first).is_multiple_of(SAMPLES_BETWEEN_CHECKS) {
                watch
                    .check()
                    .map_err(|cancelled| stopped(cancelled.into()))?;
            }
        }
        comparison.finish(&self.planned)
    }
}

/// Data of the path from the plan of the program.
struct PlannedPath {
    /// Point where the program begins to cut, and its arc length there, mm.
    start_mm: Vector,
    start_s_mm: f64,
    /// Arc length at the end of the last cut, mm.
    end_s_mm: f64,
    /// Least and largest coordinates of the whole path, and from where it begins to cut, mm.
    boxes_mm: [[Vector; 2]; 2],
}

impl PlannedPath {
    fn of(reference: &mut Reference<'_>) -> Result<Self, MeasuredError> {
        let end_s = reference.read_to_end_s();
        let mut boxes_mm = [NO_BOX; 2];
        let (mut start, mut end_s_mm) = (None, 0.0);
        let mut last_s = 0.0;
        let steps = (end_s / STEP_S).ceil() as u64;
        for n in 0..=steps {
            let sample = reference.at(n as f64 * STEP_S);
            if sample.cutting && !sample.resting {
                start.get_or_insert_with(|| first_cut(reference, last_s, n as f64 * STEP_S));
                end_s_mm = reference.at((n + 1) as f64 * STEP_S).s_mm;
            }
            grow(&mut boxes_mm[0], sample.programmed_mm);
            if start.is_some() {
                grow(&mut boxes_mm[1], sample.programmed_mm);
            }
            last_s = n as f64 * STEP_S;
        }
        let (start_mm, start_s_mm) = start.ok_or(MeasuredError::NothingCut)?;
        Ok(Self {
            start_mm,
            start_s_mm,
            end_s_mm,
            boxes_mm,
        })
    }

    /// Returns the travel of each axis, mm.
    fn range_mm(&self) -> Vector {
        let [low, high] = self.boxes_mm[0];
        sub(high, low)
    }

    /// Rejects a log if the travel of all axes equals the travel in the program when the log is
    /// read in another unit.
    fn check_unit(&self, record: &RecordedAxes<'_>, axes: usize) -> Result<(), MeasuredError> {
        let mut theirs = NO_BOX;
        (0..record.len()).for_each(|k| grow(&mut theirs, record.at(k).command_mm));
        let size = |[low, high]: [Vector; 2], i: usize| high[i] - low[i];
        for (factor, unit, read) in UNITS {
            let fits = |ours: [Vector; 2], i: usize| {
                (size(ours, i) - factor * size(theirs, i)).abs()
                    < SAME_SIZE_MM.max(SAME_SIZE * size(ours, i))
            };
            let is_scaled = |ours: &&[Vector; 2]| (0..axes).all(|i| fits(**ours, i));
            let Some(ours) = self.boxes_mm.iter().find(is_scaled) else {
                continue;
            };
            let farthest = (0..axes)
                .max_by(|&a, &b| size(*ours, a).total_cmp(&size(*ours, b)))
                .unwrap_or(0);
            // A program that goes nowhere fits every unit.
            if size(*ours, farthest) > LEFT_MM {
                let [log_mm, program_mm] = [size(theirs, farthest), size(*ours, farthest)];
                return Err(MeasuredError::Unit {
                    axis: AXIS_NAMES[farthest],
                    log_mm,
                    program_mm,
                    unit,
                    read,
                });
            }
        }
        Ok(())
    }

    /// Shift from the positions of the log to those of the program, mm. Zero if the log and the
    /// program cover ranges of different size, and on each axis whose shift is within
    /// [`SAME_SIZE_MM`].
    fn shift_mm(&self, record: &RecordedAxes<'_>, axes: usize) -> Vector {
        let mut theirs = NO_BOX;
        (0..record.len()).for_each(|k| grow(&mut theirs, record.at(k).command_mm));
        let size = |[low, high]: [Vector; 2], i: usize| high[i] - low[i];
        let same = |ours: &&[Vector; 2]| {
            (0..axes).all(|i| (size(**ours, i) - size(theirs, i)).abs() < SAME_SIZE_MM)
        };
        let Some(ours) = self.boxes_mm.iter().find(same) else {
            return [0.0; 3];
        };
        std::array::from_fn(|i| {
            let shift_mm = 0.5 * (ours[0][i] + ours[1][i] - theirs[0][i] - theirs[1][i]);
            if i < axes && shift_mm.abs() > SAME_SIZE_MM {
                shift_mm
            } else {
                0.0
            }
        })
    }
}

/// Finds the point where the program begins to cut, and its arc length there, between two plan
/// times.
fn first_cut(reference: &mut Reference<'_>, mut before_s: f64, mut after_s: f64) -> (Vector, f64) {
    for _ in 0..HALVINGS {
        let middle_s = 0.5 * (before_s + after_s);
        if reference.at(middle_s).cutting {
            after_s = middle_s;
        } else {
            before_s = middle_s;
        }
    }
    let begin = reference.at(after_s);
    (begin.programmed_mm, begin.s_mm)
}

const NO_BOX: [Vector; 2] = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];

fn grow(bounds: &mut [Vector; 2], point_mm: Vector) {
    for (i, x) in point_mm.into_iter().enumerate() {
        bounds[0][i] = bounds[0][i].min(x);
        bounds[1][i] = bounds[1][i].max(x);
    }
}

/// The axes of a log that the program moves.
struct RecordedAxes<'a> {
    axes: Vec<Option<&'a LogAxis>>,
    time_s: &'a [f64],
    shift_mm: Vector,
    /// Positions of axes that the log does not have, mm.
    still_mm: Vector,
}

/// A sample, in the coordinates of the program.
struct Sampled {
    time_s: f64,
    command_mm: Vector,
    actual_mm: Vector,
}

impl RecordedAxes<'_> {
    fn len(&self) -> usize {
        self.time_s.len()
    }

    fn at(&self, k: usize) -> Sampled {
        let (mut command_mm, mut actual_mm) = (self.shift_mm, self.shift_mm);
        for (i, axis) in self.axes.iter().enumerate() {
            match axis {
                Some(axis) => {
                    command_mm[i] += axis.command_mm[k];
                    actual_mm[i] += axis.actual_mm[k];
                }
                None => (command_mm[i], actual_mm[i]) = (self.still_mm[i], self.still_mm[i]),
            }
        }
        Sampled {
            time_s: self.time_s[k],
            command_mm,
            actual_mm,
        }
    }

    /// Shifts the record so that the command begins at `start_mm`, where it rests there in the
    /// first sample that is near, or behind.
    fn shift_to(&mut self, first: usize, start_mm: Vector) {
        let away_mm = |k: usize| distance(self.at(k).command_mm, start_mm);
        let near = (first..self.len()).take_while(|&k| away_mm(k) < BEGUN_MM);
        let rests = |k: &usize| {
            *k > 0 && distance(self.at(*k).command_mm, self.at(k - 1).command_mm) < RESTS_MM
        };
        let Some(at) = near.into_iter().find(rests) else {
            return;
        };
        let off_mm = sub(start_mm, self.at(at).command_mm);
        self.shift_mm = add_scaled(self.shift_mm, 1.0, off_mm);
    }

    /// The sample in which the command has come nearest to `start_mm`, the first time that it is
    /// there.
    fn begins(&self, start_mm: Vector) -> Result<usize, MeasuredError> {
        let away = |k: usize| distance(self.at(k).command_mm, start_mm);
        let mut nearest = (f64::INFINITY, 0);
        for k in 0..self.len() {
            let away_mm = away(k);
            if away_mm < BEGUN_MM {
                let arrived = |k: &usize| *k + 1 == self.len() || away(*k + 1) >= away(*k);
                return Ok((k..self.len()).find(arrived).unwrap_or(k));
            }
            if away_mm < nearest.0 {
                nearest = (away_mm, k);
            }
        }
        let at_s = self.time_s.get(nearest.1).copied().unwrap_or(0.0);
        Err(MeasuredError::NotBegun {
            start_mm,
            nearest_mm: nearest.0,
            at_s,
        })
    }
}

/// Progress of a point along the path.
struct Follower {
    s_mm: f64,
    last_mm: Option<Vector>,
    /// Its way since it got on, mm.
    since_mm: f64,
}

impl Follower {
    fn at(s_mm: f64) -> Self {
        Self {
            s_mm,
            last_mm: None,
            since_mm: 0.0,
        }
    }

    /// The way to where the point is now, mm.
    fn goes(&mut self, to_mm: Vector) -> f64 {
        let way_mm = self
            .last_mm
            .replace(to_mm)
            .map_or(0.0, |last_mm| distance(to_mm, last_mm));
        self.since_mm += way_mm;
        way_mm
    }

    /// The foot of a point that went there, no further back than `back_mm` and within these arc
    /// lengths, mm.
    fn foot(
        &mut self,
        reference: &Reference<'_>,
        to_mm: Vector,
        back_mm: f64,
        within_mm: [f64; 2],
    ) -> Foot {
        let lo_mm = (self.s_mm - back_mm).max(within_mm[0]);
        let hi_mm = (self.s_mm + REACH * self.since_mm + REACH_MM).min(within_mm[1]);
        let foot = reference.nearest_along(to_mm, lo_mm, hi_mm.max(lo_mm));
        if foot.s_mm > self.s_mm {
            (self.s_mm, self.since_mm) = (foot.s_mm, 0.0);
        }
        foot
    }
}

/// The comparison under way.
struct MeasuredCut {
    sample_s: f64,
    /// Samples in which a tool has followed.
    follows: usize,
    /// Arc lengths of the command, of all samples.
    commanded_mm: Vec<f64>,
    command: Follower,
    tool: Follower,
    line: u32,
    ended_s: f64,
    uncut: Uncut,
}

impl MeasuredCut {
    fn new(machine: &Machine, sample_s: f64, start_s_mm: f64, begin: &Sampled) -> Self {
        let follows = ((settled_s(machine) + DELAY_S) / sample_s).ceil() as usize;
        Self {
            sample_s,
            follows,
            commanded_mm: Vec::new(),
            command: Follower::at(start_s_mm),
            tool: Follower::at(start_s_mm),
            line: 0,
            ended_s: 0.0,
            uncut: Uncut::new(follows, begin.actual_mm),
        }
    }

    fn row(
        &mut self,
        record: &RecordedAxes<'_>,
        first: usize,
        k: usize,
        reference: &Reference<'_>,
    ) -> Result<Row, MeasuredError> {
        let Sampled {
            time_s,
            command_mm,
            actual_mm,
        } = record.at(k);
        let way_mm = self.command.goes(command_mm);
        let commanded = self
            .command
            .foot(reference, command_mm, 0.0, [0.0, f64::INFINITY]);
        if commanded.cutting && commanded.distance_mm > LEFT_MM {
            let Foot {
                distance_mm: off_mm,
                line,
                ..
            } = commanded;
            return Err(MeasuredError::Leaves {
                at_s: time_s,
                off_mm,
                line,
            });
        }
        self.commanded_mm.push(commanded.s_mm);
        let settled_mm = (k - first)
            .checked_sub(self.follows)
            .map_or(0.0, |then| self.commanded_mm[then]);
        self.tool.goes(actual_mm);
        let foot = self.tool.foot(
            reference,
            actual_mm,
            BACK_MM,
            [settled_mm, commanded.s_mm + REACH_MM],
        );
        let rests = way_mm < RESTS_MM;
        if !rests {
            (self.line, self.ended_s) = (commanded.line, time_s - record.time_s[first]);
        }
        let arrived = rests && distance(actual_mm, command_mm) < BACK_MM;
        let row = Row {
            t_s: time_s - record.time_s[first],
            s_mm: commanded.s_mm,
            line: commanded.line,
            feed_plan_mm_s: way_mm / self.sample_s,
            programmed_mm_s: 0.0,
            cutting: foot.cutting && !arrived,
            commanded: match (rests, commanded.cutting) {
                (true, _) => Commanded::Rest,
                (false, true) => Commanded::Cut,
                (false, false) => Commanded::Rapid,
            },
            path_mm: commanded.position_mm,
            cmd_mm: command_mm,
            corrected_mm: command_mm,
            act_mm: actual_mm,
            torque_nm: [0.0; 3],
            foot_mm: foot.position_mm,
            tangent: foot.tangent,
            contour_error_mm: if record.axes.len() == 2 {
                foot.signed_mm
            } else {
                foot.distance_mm
            },
        };
        self.uncut.row(&row);
        Ok(row)
    }

    fn finish(self, planned: &PlannedPath) -> Result<RunResult, MeasuredError> {
        let at_mm = self.commanded_mm.last().copied().unwrap_or(0.0);
        if at_mm < planned.end_s_mm - LEFT_MM {
            return Err(MeasuredError::EndsEarly {
                line: self.line,
                share: at_mm / planned.end_s_mm,
            });
        }
        Ok(RunResult {
            time_s: self.ended_s,
            arrival_s: self.ended_s,
            uncut_mm: self.uncut.finish(BACK_MM),
            ..RunResult::default()
        })
    }
}
