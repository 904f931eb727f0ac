//! The identification of a real machine from its log: a log in; a machine file, numbers and a page
//! out.
//!
//! ```text
//! log -> records of its axes -> grey box of each -> machine file, JSON, page
//! ```
//!
//! What is computed is in [`feedwright_ident::identify::grey_box`].

mod axis_keys;
mod next_motion;
mod machine_text;
mod update;
mod json;
mod page;

use std::fmt::Write as _;
use std::ops::Range;

use feedwright_gcode::visible;
use feedwright_ident::{
    AxisFacts, Fitness, FoundMachine, GreyBoxOptions, Log, ModelTerm, ModelVerdict, NotFound,
    NumberSource, identify_machine,
};
use feedwright_sim::{Cancelled, Machine, StageSteps, Watch, significant};
use miette::Diagnostic;
use thiserror::Error;

pub use json::write as write_json;
pub(crate) use machine_text::identified_machine;
pub use machine_text::machine_text;
pub use page::{following as following_figure, write as write_page};
pub use update::updated_text;

/// Options of an identification from a log.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LogJob {
    /// Name of the log in texts.
    pub name: String,
    /// Times that are fitted and scored, s of the log.
    pub times_s: Option<[Range<f64>; 2]>,
    /// Known values of every axis.
    pub facts: AxisFacts,
    /// The machine as it was known before: values that the log does not determine stay.
    pub before: Option<Machine>,
}

/// Result of an identification from a log.
#[derive(Debug, Clone)]
pub struct LogIdentified {
    /// The job.
    pub(crate) job: LogJob,
    /// The log, or the windows of it that were used.
    pub log: Log,
    /// The identified machine.
    pub machine: FoundMachine,
    /// Number of samples in the whole log, if only windows of it were used.
    pub(crate) of_samples: Option<usize>,
}

/// Reasons why an identification fails.
#[derive(Debug, Error, Diagnostic)]
pub enum LogJobError {
    /// The model cannot be identified from the record.
    #[error(transparent)]
    NotFound(#[from] NotFound),
    /// The work was canceled.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Most samples that are used, and windows of a longer log.
const MOST_SAMPLES: usize = 200_000;
const WINDOW_SAMPLES: usize = 10_000;

impl LogJob {
    /// Identifies the axes of a log.
    ///
    /// Fails if the model of an axis cannot be identified from the log, or if the work is canceled.
    pub fn run(self, log: Log, watch: &dyn Watch) -> Result<LogIdentified, LogJobError> {
        let (log, of_samples) = informative(log);
        let options = GreyBoxOptions {
            times_s: self.times_s.clone(),
            facts: self.facts_of(&log),
        };
        let mut steps = StageSteps::begin(watch, "identifying the axes");
        let machine = identify_machine(&log, &options, |part| {
            steps.reach(part);
            !watch.is_cancelled()
        })?;
        watch.check()?;
        Ok(LogIdentified {
            job: self,
            log,
            machine,
            of_samples,
        })
    }
}

impl LogJob {
    /// Returns the known values of each axis of a log.
    fn facts_of(&self, log: &Log) -> Vec<AxisFacts> {
        let names: Vec<&str> = log.axes.iter().map(|axis| axis.name.as_str()).collect();
        let places = places(&names);
        let of_axis = |i: usize| {
            let place = places.iter().position(|place| *place == Some(i))?;
            let before = self.before.as_ref()?;
            Some(
                self.facts
                    .or_of(before.axes.get(place)?, before.period.servo_s),
            )
        };
        (0..names.len())
            .map(|i| of_axis(i).unwrap_or(self.facts))
            .collect()
    }
}

/// Limits a log to the samples that are used: from a longer log, takes windows spread evenly over
/// the samples in which it moves. Also returns the number of samples of a log that was shortened.
pub fn informative(log: Log) -> (Log, Option<usize>) {
    let samples = log.time_s.len();
    if samples <= MOST_SAMPLES {
        return (log, None);
    }
    let mut windows: Vec<Range<usize>> = vec![];
    for stretch in &log.stretches {
        let mut from = stretch.start;
        while from < stretch.end {
            let to = (from + WINDOW_SAMPLES).min(stretch.end);
            let moves =
                |command: &[f64]| command[from..to].windows(2).any(|pair| pair[0] != pair[1]);
            if log.axes.iter().any(|axis| moves(&axis.command_mm)) {
                windows.push(from..to);
            }
            from = to;
        }
    }
    let moving: usize = windows.iter().map(ExactSizeIterator::len).sum();
    let apart = moving.div_ceil(MOST_SAMPLES).max(1);
    let mut used = 0;
    let within = |window: &Range<usize>| {
        used += window.len();
        used <= MOST_SAMPLES
    };
    let windows: Vec<Range<usize>> = windows
        .into_iter()
        .step_by(apart)
        .take_while(within)
        .collect();
    let of = |values: &[f64]| -> Vec<f64> {
        windows
            .iter()
            .flat_map(|w| values[w.clone()].iter().copied())
            .collect()
    };
    let mut short = log;
    short.time_s = of(&short.time_s);
    for axis in &mut short.axes {
        (axis.command_mm, axis.actual_mm) = (of(&axis.command_mm), of(&axis.actual_mm));
        axis.torque = axis.torque.as_deref().map(of);
    }
    let mut begin = 0;
    short.stretches = windows
        .iter()
        .map(|window| {
            begin += window.len();
            begin - window.len()..begin
        })
        .collect();
    (short, Some(samples))
}

impl LogIdentified {
    /// Returns the axes of the log that are x, y and z of the machine file.
    fn places(&self) -> [Option<usize>; 3] {
        let names: Vec<&str> = self
            .machine
            .axes
            .iter()
            .map(|axis| axis.name.as_str())
            .collect();
        places(&names)
    }

    /// The verdict of an axis, in words.
    pub fn verdict(&self, axis: usize) -> String {
        let found = &self.machine.axes[axis];
        let words = ModelVerdict::of(found).words(found);
        match self.log.axes.get(axis).map(|axis| &axis.verdict) {
            Some(Fitness::NotForControl { reason }) => {
                format!("not for control: {reason}; {words}")
            }
            _ => words,
        }
    }

    /// Returns advice on what to record, so that assumed values can be identified.
    pub fn advice(&self) -> Vec<String> {
        let mut advice = vec![];
        for axis in &self.machine.axes {
            let name = &axis.name;
            if let Some(bound) = axis.at_bounds.first() {
                advice.push(format!(
                    "axis {name}: {}. All values of the axis may be wrong. {}",
                    bound.words(),
                    bound.remedy()
                ));
            }
            if axis.unseen.is_open() {
                advice.push(format!("axis {name}: the log leaves open what other motion would show. Record the program that --excite-next writes, or the one of feedwright excite: both directions, creeping, reversals, short strokes"));
            }
            if axis.inertia().2 == NumberSource::Assumed {
                advice.push(format!("axis {name}: positions do not determine the inertia. Give --inertia, or record the torque and give --torque-gain; until then torques in the machine file have a scale that is assumed"));
            }
            if axis.gains_source() == NumberSource::Assumed {
                advice.push(format!("axis {name}: positions do not determine Kp, Kv and B separately; B is taken as zero. Give --inertia and --viscous, or record the torque"));
            }
            if axis.axis_model().get(ModelTerm::SpeedWindow) == 0.0 {
                advice.push(format!("axis {name}: the drive is taken to know the speed exactly. One that takes it from positions over some samples looks like a smaller inertia: the products may be too large by 10 % and more. State it with --speed-window, or record a torque column"));
            }
            if axis.scores.beyond.is_some() {
                advice.push(format!("axis {name}: part of what was scored is faster than all that was fitted. Record all speeds in both parts"));
            }
        }
        for (axis, direction) in &self.machine.split.one_sided {
            if let Some(axis) = self.machine.axes.get(*axis) {
                let way = if *direction > 0 {
                    "positive"
                } else {
                    "negative"
                };
                advice.push(format!("axis {}: nearly all motion in the {way} direction lies in one of the two parts, fitted or scored. Record both directions several times", axis.name));
            }
        }
        advice
    }

    /// Describes the effect of other settings of the drives, as far as the log supports it. Only
    /// axes whose model holds are listed.
    pub fn improvements(&self) -> Vec<String> {
        let mut improvements = vec![];
        for (found, axis) in self.machine.axes.iter().zip(&self.log.axes) {
            let is_sound = matches!(
                ModelVerdict::of(found),
                ModelVerdict::ModelHolds | ModelVerdict::LinearSuffices
            );
            if !is_sound || axis.verdict != Fitness::ForControl {
                continue;
            }
            improvements.extend(found.gain_changes.iter().map(|change| {
                format!(
                    "axis {}: {} would leave {} um RMS of following error on the motions of the log, simulated ({} um by the gains alone), where there \
                     are {} um now",
                    found.name,
                    change.words(),
                    digits(change.simulated_um),
                    digits(change.predicted_um),
                    digits(change.now_um)
                )
            }));
        }
        improvements
    }

    /// The numbers of an axis: name, value, unit, interval of 90 % (empty where it has none), and
    /// where it comes from.
    pub fn rows(&self, axis: usize) -> Vec<[String; 5]> {
        let numbers = self.machine.axes[axis].numbers().into_iter();
        let row = numbers.map(|number| {
            let interval = number
                .interval
                .map(|[low, high]| format!("{} to {}", digits(low), digits(high)));
            let [name, unit, source] =
                [number.name, number.unit, number.source.word()].map(str::to_owned);
            [
                name,
                digits(number.value),
                unit,
                interval.unwrap_or_default(),
                source,
            ]
        });
        row.collect()
    }

    /// A table of the numbers, as a terminal shows it.
    pub(crate) fn table(&self) -> String {
        let mut text = String::new();
        for (i, axis) in self.machine.axes.iter().enumerate() {
            let _ = writeln!(
                text,
                "axis {}: {}",
                visible(&axis.name),
                visible(&self.verdict(i))
            );
            for [name, value, unit, interval, source] in self.rows(i) {
                let _ = writeln!(
                    text,
                    "  {name:<27} {value:>12} {unit:<10} {interval:<24} {source}"
                );
            }
        }
        text
    }
}

/// Formats a value with four significant digits.
pub(crate) fn digits(value: f64) -> String {
    significant(value, 4, 5)
}

/// Name of the axis of a machine file that each axis of the log becomes: those that are called so,
/// the others in their order.
fn places(axes: &[&str]) -> [Option<usize>; 3] {
    let named = |name: &str| {
        axes.iter()
            .position(|axis| axis.to_lowercase().starts_with(name))
    };
    let mut places = ["x", "y", "z"].map(named);
    let mut left = (0..axes.len())
        .filter(|i| !places.contains(&Some(*i)))
        .collect::<Vec<_>>()
        .into_iter();
    for place in &mut places {
        if place.is_none() {
            *place = left.next();
        }
    }
    places
}
