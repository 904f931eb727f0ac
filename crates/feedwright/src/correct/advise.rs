//! Finds the feedrates at which a tolerance is held: by the program as it is, by the corrected
//! program, and with a controller that measures the tool position.
//!
//! The program is cut with all its feedrates at factors that go up and down by the root of two,
//! until it is within the tolerance. Where the error passes the tolerance the factor is
//! interpolated, over logarithms, and a cut at that factor shows that it holds; it is lowered until
//! one does. The same errors, stretch by stretch, give each stretch a factor of its own, and a cut
//! with all of them shows that they hold together.

mod feed_cuts;
mod feed_search;
pub(crate) mod page;

use feedwright_gcode::canon::{Canon, Motion};
use feedwright_gcode::{Diagnostic, Program, Settings};
use feedwright_sim::{Machine, StageSteps, Watch};
use serde::Serialize;

use super::file_prior::{FILE_ERROR, FileAssumption, FileModel};
use super::source::SourceProgram;
use super::stretches::{ProgramPart, SmoothStretch, parts, stretches};
use super::target::TargetControl;
use super::unchanged::lines_of;
use crate::compensation::GeometryChoice;
use crate::controllers::{Choices, Entry, LQG_IDENTIFIED, Make, Setup, identifying};
use crate::job_error::{JobError, axes_that_move};
use crate::report::PageUnits;
pub use feed_cuts::ErrorPlace;
use feed_cuts::FeedBench;
use feed_search::{FeedSearch, LARGEST};

/// A program, a machine, and a tolerance that is to be held.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct AdviseJob {
    /// The G-code program.
    pub program: Program,
    /// The machine that cuts it.
    pub machine: Machine,
    /// The control that cuts it without feedback, corrected or not.
    pub target: &'static TargetControl,
    /// The controller of the cut with feedback.
    pub controller: &'static Entry,
    /// Settings of the controller.
    pub(crate) choices: Choices,
    /// The geometry that is compensated, in the corrected program and in the cut with feedback.
    pub(crate) compensation: GeometryChoice,
    /// Largest contour error, um.
    pub(crate) tolerance_um: f64,
    /// Settings of the reader.
    pub(crate) reader: Settings,
    /// Standard deviation of each value of the machine, as a fraction of it; 0 where it is exact.
    /// As [`CorrectJob::file_error`](super::CorrectJob).
    pub file_error: f64,
}

/// Way in which a program is cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CutWay {
    /// The program as it is, without feedback.
    Uncorrected,
    /// Corrected for that feedrate, without feedback.
    Corrected,
    /// The program as it is, with a controller in the loop.
    Controlled,
}

/// All ways, in the order of the report.
pub(crate) const WAYS: [CutWay; 3] = [CutWay::Uncorrected, CutWay::Corrected, CutWay::Controlled];

/// Time and errors of a program, with one factor on all of its feedrates or one factor for each
/// stretch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FeedCut {
    /// Factor on the programmed feedrates; none where each stretch has its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub factor: Option<f64>,
    /// Machining time, s.
    pub time_s: f64,
    /// Quadratic mean of the RMS errors over the cuts, um.
    pub(crate) rms_um: f64,
    /// Largest error of all cuts, um.
    pub max_um: f64,
}

/// Feedrates that hold the tolerance when the program is cut in one way.
#[derive(Debug, Clone, Serialize)]
pub struct WayAdvice {
    /// The way.
    pub way: CutWay,
    /// Cuts by rising factor.
    pub cuts: Vec<FeedCut>,
    /// The fastest factor on the whole program that holds the tolerance; none if the smallest
    /// factor does not hold it.
    pub whole: Option<FeedCut>,
    /// Result with a separate feedrate for each stretch; none if a stretch holds the tolerance at
    /// no feedrate.
    pub by_stretch: Option<FeedCut>,
    /// The cut that comes nearest to the tolerance, if no factor on the whole program holds it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nearest: Option<NearestCut>,
}

/// The cut that comes nearest to a tolerance that is not held.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct NearestCut {
    /// Factor, time and errors of the cut.
    pub(crate) cut: FeedCut,
    /// First and last line of the stretch with the largest error.
    pub lines: [u32; 2],
    /// Part of that stretch with the largest error.
    pub place: ErrorPlace,
    /// The fastest factor that holds the tolerance away from the ends of the stretches, where the
    /// tool comes from rest or stops.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) beside_ends: Option<FeedCut>,
}

/// A stretch without a corner, and the feedrates at which it holds the tolerance.
#[derive(Debug, Clone, Serialize)]
pub struct StretchAdvice {
    /// First and last line.
    pub lines: [u32; 2],
    /// Largest programmed feedrate, mm/s.
    pub(crate) feed_mm_s: f64,
    /// Largest feedrate that holds the tolerance, mm/s, in each of [`WAYS`]; none if the smallest
    /// feedrate that was cut does not hold it.
    pub holds_mm_s: [Option<f64>; 3],
    /// The feedrate that comes nearest to the tolerance, for each way in which no feedrate holds
    /// it.
    pub(crate) nearest: [Option<NearestFeed>; 3],
}

/// The feedrate of a stretch that comes nearest to the tolerance, if no feedrate holds it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct NearestFeed {
    /// Smallest of the largest errors of all its cuts, um.
    pub(crate) max_um: f64,
    /// Part of the stretch with that error.
    pub(crate) place: ErrorPlace,
    /// Largest feedrate that holds the tolerance away from the ends of the stretch, mm/s.
    pub(crate) beside_ends_mm_s: Option<f64>,
}

/// Feedrates that hold the tolerance, in every way and for every stretch.
#[derive(Debug, Clone, Serialize)]
pub struct Advice {
    /// Name of the control that cuts without feedback.
    pub(crate) control: &'static str,
    /// Name of the planner that stands for it.
    pub(crate) planner: &'static str,
    /// Name of the controller.
    pub(crate) controller: &'static str,
    /// The tolerance, um.
    pub(crate) tolerance_um: f64,
    /// Least and largest programmed feedrate, mm/s.
    pub programmed_mm_s: [f64; 2],
    /// One for each of `WAYS`.
    pub ways: Vec<WayAdvice>,
    /// The stretches in the order of the program.
    pub stretches: Vec<StretchAdvice>,
    /// Assumptions beside the machine file; none if the file is exact.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub assumed: Option<FileAssumption>,
    /// Warnings of the reader.
    #[serde(skip)]
    pub warnings: Vec<Diagnostic>,
}

impl Advice {
    /// Returns true if any way holds the tolerance.
    pub fn holds(&self) -> bool {
        self.ways.iter().any(|way| way.whole.is_some())
    }
}

impl AdviseJob {
    /// Asks for the feedrates of a program that hold a tolerance: on a control, and with the
    /// default controller.
    pub fn new(
        program: Program,
        machine: Machine,
        target: &'static TargetControl,
        tolerance_um: f64,
    ) -> Self {
        Self {
            program,
            machine,
            target,
            controller: &LQG_IDENTIFIED,
            choices: Choices::default(),
            compensation: GeometryChoice::default(),
            tolerance_um,
            reader: Settings::default(),
            file_error: FILE_ERROR,
        }
    }

    /// Finds the feedrates.
    ///
    /// # Errors
    /// A program with mistakes or without a feed motion, more axes than the machine has, a geometry
    /// that cannot be compensated, or an end from outside.
    pub fn run(&self, watch: &dyn Watch) -> Result<Advice, JobError> {
        watch.begin("reading the program", 1);
        let summary = self.program.check(self.reader.clone())?;
        let axes = axes_that_move(&self.program, &summary, &self.machine)?;
        let source = SourceProgram::read(&self.program, &self.reader, None)?;
        let warnings = summary
            .warnings
            .iter()
            .cloned()
            .chain(summary.uncontrolled())
            .collect();
        let compensated = self.compensation.on(&self.machine, summary.box_mm)?;
        let file = FileModel::uncertain(&compensated, axes, self.file_error);
        let machine = file
            .as_ref()
            .map_or(compensated, |file| file.machine.clone());
        let job = Self {
            machine,
            ..self.clone()
        };
        let found = job.of_axes(axes, &source, file.as_ref(), watch);
        Ok(Advice {
            warnings,
            assumed: file.map(|file| file.assumption),
            ..found?
        })
    }

    fn of_axes(
        &self,
        axes: usize,
        source: &SourceProgram,
        file: Option<&FileModel>,
        watch: &dyn Watch,
    ) -> Result<Advice, JobError> {
        let parts = parts(&source.steps, &[]);
        let feeds: Vec<f64> = stretches(&parts).map(feed_mm_s).collect();
        let largest_mm_s = feeds.iter().copied().fold(0.0, f64::max);
        if largest_mm_s == 0.0 {
            return Err(JobError::NothingToCut {
                part: self.program.name(),
            });
        }
        let mut steps =
            (self.controller.identifier.is_some()).then(|| identifying(&self.machine, watch));
        let mut progress = |part: f64| steps.iter_mut().for_each(|steps| steps.reach(part));
        let mut setup = Setup::new(&self.machine, &self.choices).reporting(&mut progress);
        let controller = self.controller.make(&mut setup, axes);
        let mut bench = FeedBench {
            machine: &self.machine,
            file,
            target: self.target,
            unit_mm: source.largest_unit_mm(),
            laps: self.controller.laps,
            parts: &parts,
            controller,
            watch,
        };
        let most = (self.machine.limits.max_feed_mm_s / largest_mm_s).min(LARGEST);
        let (mut ways, mut found) = (Vec::new(), Vec::new());
        for way in WAYS {
            let of_way = format!("cutting, {}", way.name(self.controller.name));
            let mut search = FeedSearch {
                bench: &mut bench,
                way,
                progress: StageSteps::begin(watch, &of_way),
                done: 0.0,
            };
            let (advice, of_stretches) = search
                .advice(most, self.tolerance_um)
                .map_err(|error| JobError::of_run(&self.program, error))?;
            ways.push(advice);
            found.push(of_stretches);
        }
        let of_stretch = |(k, stretch): (usize, &SmoothStretch)| StretchAdvice {
            lines: lines_of(stretch),
            feed_mm_s: feeds[k],
            holds_mm_s: [0, 1, 2]
                .map(|way: usize| found[way][k].holds.map(|factor| factor * feeds[k])),
            nearest: [0, 1, 2].map(|way: usize| found[way][k].nearest(feeds[k])),
        };
        let least_mm_s = stretches(&parts)
            .flat_map(|stretch| &stretch.motions)
            .map(|motion| motion.feed_mm_s);
        Ok(Advice {
            control: self.target.name,
            planner: self.target.stages(&self.machine).planner.name,
            controller: self.controller.name,
            tolerance_um: self.tolerance_um,
            programmed_mm_s: [least_mm_s.fold(f64::INFINITY, f64::min), largest_mm_s],
            ways,
            stretches: stretches(&parts).enumerate().map(of_stretch).collect(),
            assumed: None,
            warnings: Vec::new(),
        })
    }
}

impl CutWay {
    /// Returns the name of the way; for a cut with a controller, the name of the controller.
    pub(crate) const fn name(self, controller: &'static str) -> &'static str {
        match self {
            Self::Uncorrected => "uncorrected",
            Self::Corrected => "corrected",
            Self::Controlled => controller,
        }
    }
}

/// Largest feedrate of a stretch, mm/s.
fn feed_mm_s(stretch: &SmoothStretch) -> f64 {
    stretch
        .motions
        .iter()
        .map(|motion| motion.feed_mm_s)
        .fold(0.0, f64::max)
}

impl NearestCut {
    /// Describes the cut in one sentence. `um` is the sign for micrometers, `largest_mm_s` the
    /// largest programmed feedrate.
    pub fn sentence(&self, um: &str, largest_mm_s: f64) -> String {
        let [first, last] = self.lines;
        let place = match self.place {
            ErrorPlace::Start => format!("where line {first} begins"),
            ErrorPlace::End => format!("where line {last} ends"),
            ErrorPlace::Way if first == last => format!("on line {first}"),
            ErrorPlace::Way => format!("on lines {first} to {last}"),
        };
        let percent = |cut: &FeedCut| 100.0 * cut.factor.unwrap_or(1.0);
        let nearest = format!(
            "at no feed: {:.1} {um} at {:.0} %, {place}",
            self.cut.max_um,
            percent(&self.cut)
        );
        match &self.beside_ends {
            Some(cut) => {
                let mm_min = 0.6 * percent(cut) * largest_mm_s;
                format!(
                    "{nearest}; beside the ends of stretches at {:.0} %, {mm_min:.0} mm/min, in {:.3} s",
                    percent(cut),
                    cut.time_s
                )
            }
            None => nearest,
        }
    }

    /// Explains in one sentence why no feedrate holds the tolerance, and what would help.
    pub fn why(&self) -> String {
        let [first, last] = self.lines;
        match self.place {
            ErrorPlace::Start => format!(
                "No feed helps, because the tool is still settling from the motion before when line {first} begins, and rapids keep their speed: a dwell \
                 (G4) before line {first} would, or a slow feed motion in place of the end of the rapid."
            ),
            ErrorPlace::End => format!(
                "No feed helps, because the tool runs over the end of line {last} when the control brakes, from any feed: a lower acceleration of the \
                 control would, or a slow last piece."
            ),
            ErrorPlace::Way => format!(
                "No feed helps, because at {:.0} % the error on lines {first} to {last} no longer comes from the speed but from friction, the \
                 disturbance and noise: a stiffer loop would, or a controller that sees the tool, or a larger tolerance.",
                100.0 * self.cut.factor.unwrap_or(1.0)
            ),
        }
    }
}

impl StretchAdvice {
    /// Returns the feedrate that holds the tolerance in one of [`WAYS`], mm/min or in/min. It
    /// stands in brackets if it holds only away from the ends of the stretch.
    pub fn cell(&self, way: usize, units: PageUnits) -> String {
        let per_minute = |mm_s: f64| units.fixed(60.0 * mm_s, 0);
        let beside_ends = self.nearest[way].and_then(|nearest| nearest.beside_ends_mm_s);
        match (self.holds_mm_s[way], beside_ends) {
            (Some(mm_s), _) => per_minute(mm_s),
            (None, Some(mm_s)) => format!("({})", per_minute(mm_s)),
            (None, None) => "-".to_owned(),
        }
    }

    /// Returns the error that no feedrate removes and its place, with `um` as the sign for
    /// micrometers; none if each way holds the tolerance at some feedrate.
    pub fn remark(&self, um: &str) -> Option<String> {
        let largest = self
            .nearest
            .iter()
            .flatten()
            .max_by(|a, b| a.max_um.total_cmp(&b.max_um))?;
        let place = match largest.place {
            ErrorPlace::Start => "start",
            ErrorPlace::End => "end",
            ErrorPlace::Way => "way",
        };
        Some(format!("{:.1} {um}, {place}", largest.max_um))
    }
}

/// Legend of the table of stretches: explains the brackets, the dashes and the last column.
pub(crate) const STRETCH_LEGEND: &str = "in brackets: holds beside the ends of the stretch, where the tool comes from rest or goes there and is off by more at every feed that was cut (a \
                                  corrected program goes there slowly); -: holds at no feed that was cut; left: the error that no feed takes back, at its start, \
                                  its end, or on its way";

/// The parts of a program with other feedrates in its stretches, up to what the machine can.
fn with_factors(program: &[ProgramPart], factors: &[f64], most_mm_s: f64) -> Vec<ProgramPart> {
    let mut factors = factors.iter();
    let part = |part: &ProgramPart| match part {
        ProgramPart::Kept(step) => ProgramPart::Kept(step.clone()),
        ProgramPart::Stretch(stretch) => {
            let factor = factors.next().copied().unwrap_or(1.0);
            let motion = |motion: &Motion| Motion {
                feed_mm_s: (factor * motion.feed_mm_s).min(most_mm_s),
                ..motion.clone()
            };
            ProgramPart::Stretch(SmoothStretch {
                motions: stretch.motions.iter().map(motion).collect(),
                ..stretch.clone()
            })
        }
    };
    program.iter().map(part).collect()
}

/// The steps of parts as they are, each motion by the number of its stretch.
fn canon_of(parts: &[ProgramPart]) -> Vec<Canon> {
    let count = stretches(parts).count();
    super::stretches::assembled(parts, &vec![None; count], &vec![0.0; count])
}
