//! At which feed a tolerance is held: by the program as it is, by the corrected program, and with a controller that sees the tool.
//!
//! The program is cut with all its feedrates at factors that go up and down by the root of two, until it is within the tolerance. Where the error
//! passes the tolerance the factor is interpolated, over logarithms, and a cut at that factor shows that it holds; it is lowered until one does. The same errors,
//! stretch by stretch, give each stretch a factor of its own, and a cut with all of them shows that they hold together.

mod feed_cuts;
pub mod page;

use std::path::PathBuf;

use serde::Serialize;

use super::source::SourceProgram;
use super::stretches::{ProgramPart, SmoothStretch, parts, stretches};
use super::target::TargetControl;
use crate::controllers::{Choices, Entry, Make, Setup};
use crate::gcode::canon::{Canon, Motion};
use crate::gcode::{self, Diagnostic, Settings};
use crate::job_error::{JobError, axes_that_move};
use crate::machine::Machine;
use crate::pipeline::RunError;
use crate::watch::{StageSteps, Watch};
use feed_cuts::{FeedBench, FeedErrors};

/// Steps between factors, and the least and the largest factor.
const STEP: f64 = std::f64::consts::SQRT_2;
const LEAST: f64 = 0.125;
const LARGEST: f64 = 4.0;
/// Cuts at the most in which a factor is lowered until it holds, and by how much at the least and at the most.
const TRIES: u32 = 8;
const LOWER: [f64; 2] = [0.7, 0.96];
/// A cut that takes longer by no more than this factor is as fast.
const AS_FAST: f64 = 1.001;
/// Cuts of a way that are expected, for the progress.
const EXPECTED: f64 = 20.0;

/// A program, a machine, and a tolerance that is to be held.
#[derive(Debug, Clone)]
pub struct AdviseJob {
    /// The G-code program.
    pub part: PathBuf,
    /// The machine that cuts it.
    pub machine: Machine,
    /// The control that cuts it without feedback, corrected or not.
    pub target: &'static TargetControl,
    /// The controller of the cut with feedback.
    pub controller: &'static Entry,
    /// Settings of the controller.
    pub choices: Choices,
    /// Largest contour error, um.
    pub tolerance_um: f64,
    /// Settings of the reader.
    pub reader: Settings,
}

/// How a program is cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CutWay {
    /// As it is, open loop.
    Uncorrected,
    /// Corrected for that feedrate, open loop.
    Corrected,
    /// With a controller.
    Controlled,
}

/// All of them, in the order in which they are told.
pub const WAYS: [CutWay; 3] = [CutWay::Uncorrected, CutWay::Corrected, CutWay::Controlled];

/// What a program comes to, at a factor on all of its feedrates or at one for each stretch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FeedCut {
    /// Factor on the programmed feedrates; none where each stretch has its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub factor: Option<f64>,
    /// Machining time, s.
    pub time_s: f64,
    /// Quadratic mean of the RMS errors over the cuts, um.
    pub rms_um: f64,
    /// Largest error of all cuts, um.
    pub max_um: f64,
}

/// What holds the tolerance, in one way.
#[derive(Debug, Clone, Serialize)]
pub struct WayAdvice {
    /// The way.
    pub way: CutWay,
    /// Cuts by rising factor.
    pub cuts: Vec<FeedCut>,
    /// The fastest factor on the whole program that holds; none where the least does not.
    pub whole: Option<FeedCut>,
    /// Each stretch at its own feed; none where one of them holds at none.
    pub by_stretch: Option<FeedCut>,
}

/// A stretch without a corner, and the feedrates at which it holds the tolerance.
#[derive(Debug, Clone, Serialize)]
pub struct StretchAdvice {
    /// First and last line.
    pub lines: [u32; 2],
    /// Largest programmed feedrate, mm/s.
    pub feed_mm_s: f64,
    /// Largest feedrate that holds, mm/s, in each of [`WAYS`]; none where the least that was cut does not.
    pub holds_mm_s: [Option<f64>; 3],
}

/// What holds the tolerance.
#[derive(Debug, Clone, Serialize)]
pub struct Advice {
    /// Name of the control that cuts without feedback.
    pub control: &'static str,
    /// Name of the planner that stands for it.
    pub planner: &'static str,
    /// Name of the controller.
    pub controller: &'static str,
    /// The tolerance, um.
    pub tolerance_um: f64,
    /// Least and largest programmed feedrate, mm/s.
    pub programmed_mm_s: [f64; 2],
    /// One for each of [`WAYS`].
    pub ways: Vec<WayAdvice>,
    /// The stretches in the order of the program.
    pub stretches: Vec<StretchAdvice>,
    /// What the reader warned of.
    #[serde(skip)]
    pub warnings: Vec<Diagnostic>,
}

impl Advice {
    /// Whether any way holds the tolerance.
    pub fn holds(&self) -> bool {
        self.ways.iter().any(|way| way.whole.is_some())
    }
}

impl AdviseJob {
    /// Finds the feedrates.
    ///
    /// # Errors
    /// A program with mistakes or without a feed motion, more axes than the machine has, or an end from outside.
    pub fn run(&self, watch: &dyn Watch) -> Result<Advice, JobError> {
        watch.begin("reading the program", 1);
        let summary = gcode::check(&self.part, self.reader.clone())?;
        let axes = axes_that_move(&self.part, &summary, &self.machine)?;
        self.target.suits(&self.machine)?;
        let source = SourceProgram::read(&self.part, &self.reader, None)?;
        let warnings = summary.warnings.iter().cloned().chain(summary.uncontrolled()).collect();
        let found = match axes {
            2 => self.of_axes::<2>(&source, watch),
            _ => self.of_axes::<3>(&source, watch),
        };
        Ok(Advice { warnings, ..found? })
    }

    fn of_axes<const N: usize>(&self, source: &SourceProgram, watch: &dyn Watch) -> Result<Advice, JobError>
    where
        Entry: Make<N>,
    {
        let parts = parts(&source.steps);
        let feeds: Vec<f64> = stretches(&parts).map(feed_mm_s).collect();
        let largest_mm_s = feeds.iter().copied().fold(0.0, f64::max);
        if largest_mm_s == 0.0 {
            return Err(JobError::NothingToCut { part: self.part.clone() });
        }
        let mut steps = StageSteps::begin(watch, &format!("identifying for {}", self.controller.name));
        let mut progress = |part: f64| steps.reach(part);
        let mut setup = Setup::new(&self.machine, &self.choices).telling(&mut progress);
        let controller = Make::<N>::make(self.controller, &mut setup);
        let mut bench = FeedBench::<N> {
            machine: &self.machine,
            target: self.target,
            laps: self.controller.laps,
            parts: &parts,
            controller,
            watch,
        };
        let most = (self.machine.limits.max_feed_mm_s / largest_mm_s).min(LARGEST);
        let (mut ways, mut holds) = (Vec::new(), Vec::new());
        for way in WAYS {
            let of_way = format!("cutting, {}", way.name(self.controller.name));
            let mut search =
                FeedSearch { bench: &mut bench, way, progress: StageSteps::begin(watch, &of_way), done: 0.0 };
            let (advice, factors) =
                search.advice(most, self.tolerance_um).map_err(|error| JobError::of_run(&self.part, error))?;
            ways.push(advice);
            holds.push(factors);
        }
        let of_stretch = |(k, stretch): (usize, &SmoothStretch)| StretchAdvice {
            lines: [0, stretch.motions.len() - 1].map(|n| stretch.motions[n].line),
            feed_mm_s: feeds[k],
            holds_mm_s: [0, 1, 2].map(|way: usize| holds[way][k].map(|factor| factor * feeds[k])),
        };
        let least_mm_s = stretches(&parts).flat_map(|stretch| &stretch.motions).map(|motion| motion.feed_mm_s);
        Ok(Advice {
            control: self.target.name,
            planner: self.target.stages(&self.machine).planner.name,
            controller: self.controller.name,
            tolerance_um: self.tolerance_um,
            programmed_mm_s: [least_mm_s.fold(f64::INFINITY, f64::min), largest_mm_s],
            ways,
            stretches: stretches(&parts).enumerate().map(of_stretch).collect(),
            warnings: Vec::new(),
        })
    }
}

impl CutWay {
    /// How it is called; a cut with a controller by the controller's name.
    pub const fn name(self, controller: &'static str) -> &'static str {
        match self {
            Self::Uncorrected => "uncorrected",
            Self::Corrected => "corrected",
            Self::Controlled => controller,
        }
    }
}

/// Largest feedrate of a stretch, mm/s.
fn feed_mm_s(stretch: &SmoothStretch) -> f64 {
    stretch.motions.iter().map(|motion| motion.feed_mm_s).fold(0.0, f64::max)
}

/// The search of one way.
struct FeedSearch<'b, 'a, const N: usize> {
    bench: &'b mut FeedBench<'a, N>,
    way: CutWay,
    progress: StageSteps<'b>,
    done: f64,
}

impl<const N: usize> FeedSearch<'_, '_, N> {
    fn cut(&mut self, factors: &[f64]) -> Result<FeedErrors, RunError> {
        let errors = self.bench.cut(self.way, factors)?;
        self.done += 1.0 / EXPECTED;
        self.progress.reach(self.done);
        Ok(errors)
    }

    /// What holds, and the factors of the stretches.
    fn advice(&mut self, most: f64, tolerance_um: f64) -> Result<(WayAdvice, Vec<Option<f64>>), RunError> {
        let count = stretches(self.bench.parts).count();
        let mut cuts: Vec<(f64, FeedErrors)> = Vec::new();
        let first = most.min(1.0);
        cuts.push((first, self.cut(&vec![first; count])?));
        while cuts[0].1.max_um > tolerance_um && cuts[0].0 > 1.01 * LEAST {
            let factor = (cuts[0].0 / STEP).max(LEAST);
            cuts.insert(0, (factor, self.cut(&vec![factor; count])?));
        }
        while cuts[cuts.len() - 1].0 < most
            && cuts[cuts.len() - 1].1.stretches.iter().any(|(um, _)| *um <= tolerance_um)
        {
            let factor = (cuts[cuts.len() - 1].0 * STEP).min(most);
            cuts.push((factor, self.cut(&vec![factor; count])?));
        }
        let curve = |of: &dyn Fn(&FeedErrors) -> (f64, f64)| -> Option<f64> {
            let point = |(factor, errors): &(f64, FeedErrors)| {
                let (error_um, time_s) = of(errors);
                FactorPoint { factor: *factor, error_um, time_s }
            };
            held(&cuts.iter().map(point).collect::<Vec<_>>(), tolerance_um)
        };
        let whole = curve(&|errors| (errors.max_um, errors.time_s));
        let by_stretch: Vec<Option<f64>> = (0..count).map(|k| curve(&|errors| errors.stretches[k])).collect();
        let whole = whole.map_or(Ok(None), |factor| self.verified(vec![factor; count], true, tolerance_um))?;
        let all: Option<Vec<f64>> = by_stretch.iter().copied().collect();
        let each = all.map_or(Ok(None), |factors| self.verified(factors, false, tolerance_um))?;
        let factors = each.as_ref().map_or(by_stretch, |(factors, _)| factors.iter().copied().map(Some).collect());
        let advice = WayAdvice {
            way: self.way,
            cuts: cuts.iter().map(|(factor, errors)| errors.cut(Some(*factor))).collect(),
            whole: whole.map(|(factors, errors)| errors.cut(factors.first().copied())),
            by_stretch: each.map(|(_, errors)| errors.cut(None)),
        };
        Ok((advice, factors))
    }

    /// Factors that hold, lowered from those that are to hold, all by as much or each by itself; none where they do not.
    fn verified(
        &mut self,
        mut factors: Vec<f64>,
        together: bool,
        tolerance_um: f64,
    ) -> Result<Option<(Vec<f64>, FeedErrors)>, RunError> {
        for _ in 0..TRIES {
            let errors = self.cut(&factors)?;
            if errors.max_um <= tolerance_um {
                return Ok(Some((factors, errors)));
            }
            let lower =
                |um: f64| if um > tolerance_um { (tolerance_um / um).sqrt().clamp(LOWER[0], LOWER[1]) } else { 1.0 };
            let of_stretch = |k: usize| if together { errors.max_um } else { errors.stretches[k].0 };
            factors = factors.iter().enumerate().map(|(k, factor)| factor * lower(of_stretch(k))).collect();
        }
        Ok(None)
    }
}

/// What a program or a stretch comes to at a factor on its feedrates.
#[derive(Debug, Clone, Copy)]
struct FactorPoint {
    factor: f64,
    error_um: f64,
    time_s: f64,
}

/// The factor up to which errors, by rising factor, are within a tolerance; between two of them by logarithms. Where all are, the least that is as fast
/// as the last.
fn held(points: &[FactorPoint], tolerance_um: f64) -> Option<f64> {
    let Some(beyond) = points.iter().position(|point| point.error_um > tolerance_um) else {
        let last = points.last()?;
        return points.iter().find(|point| point.time_s <= AS_FAST * last.time_s).map(|point| point.factor);
    };
    let (from, to) = (points.get(beyond.checked_sub(1)?)?, points.get(beyond)?);
    let part = (tolerance_um / from.error_um).ln() / (to.error_um / from.error_um).ln();
    // An error that is no number, or none, has no place between.
    Some(if part.is_finite() { from.factor * (to.factor / from.factor).powf(part) } else { from.factor })
}

/// The parts of a program with other feedrates in its stretches, up to what the machine can.
fn with_factors(program: &[ProgramPart], factors: &[f64], most_mm_s: f64) -> Vec<ProgramPart> {
    let mut factors = factors.iter();
    let part = |part: &ProgramPart| match part {
        ProgramPart::Kept(step) => ProgramPart::Kept(step.clone()),
        ProgramPart::Stretch(stretch) => {
            let factor = factors.next().copied().unwrap_or(1.0);
            let motion =
                |motion: &Motion| Motion { feed_mm_s: (factor * motion.feed_mm_s).min(most_mm_s), ..motion.clone() };
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
    super::stretches::assembled(parts, &vec![None; stretches(parts).count()], 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_two_factors_the_error_is_a_power_of_the_feed() {
        let point =
            |factor: f64| FactorPoint { factor, error_um: 4.0 * factor * factor, time_s: 1.0 / factor.min(1.0) };
        let points: Vec<FactorPoint> = [0.5, 1.0, 2.0].map(point).to_vec();
        assert!((held(&points, 6.0).unwrap() - 1.5_f64.sqrt()).abs() < 1e-12);
        // Beyond a factor of 1 nothing is faster.
        assert_eq!((held(&points, 0.5), held(&points, 20.0)), (None, Some(1.0)));
        let lost = FactorPoint { error_um: f64::INFINITY, ..points[2] };
        assert_eq!(held(&[points[1], lost], 5.0), Some(1.0));
    }
}
