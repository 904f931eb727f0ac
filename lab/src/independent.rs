//! Identification and controllers on the independent plant: the steps of a user with a machine,
//! applied to a machine that obeys other equations.
//!
//! ```text
//! data sheet -> excitation program -> cut by the plant -> log -> machine file -> model
//! parts -> cut by the plant: uncorrected, with the model, with peers by the same machine file
//! ```
//!
//! The log has commands and encoder positions of the same moments. The machine file is made from it
//! alone; its limits are those that the control of the machine has. Every cut is planned within
//! these limits and cut by the independent plant.

use std::cell::RefCell;
use std::fmt::Write as _;
use std::path::Path;
use std::rc::Rc;

use feedwright::{
    BEST, Choices, Entry, LogIdentified, LogJob, LogJobError, Make, ModelMisfit, Setup, Statistics,
    UNCORRECTED, machine_text,
};
use feedwright_control::{Controller, Uncorrected};
use feedwright_ident::{
    AxisFacts, Columns, ExciteError, ExciteOptions, FoundAxis, Log, LogError, Model, ModelTerm,
    excitation_program,
};
use feedwright_sim::{
    AXIS_NAMES, Cancelled, Machine, MachineError, Measurement, Mechanism, Outcome, PlanCache, Run,
    RunError, Watch,
};
use miette::Diagnostic;
use rayon::prelude::*;
use serde::Serialize;
use thiserror::Error;

use crate::independent_plant::IndependentPlant;
use crate::independent_plant::linearization::LinearPart;
use crate::independent_plant::machines::IndependentMachine;
use crate::never_worse::cut::{Figures, SweepRow};
use crate::never_worse::program::{Length, SweepProgram};
use crate::never_worse::verdict::Failure;

/// Programs that are cut where none is named.
pub(crate) const PROGRAMS: [(&str, &str); 4] = [
    ("star", include_str!("../../parts/star.ngc")),
    ("circle", include_str!("../../parts/circle.ngc")),
    ("square", include_str!("../../parts/square.ngc")),
    ("slot", include_str!("../../parts/slot.ngc")),
];
/// Controllers that cut where none is named.
pub(crate) const DEFAULT_CONTROLLERS: [&str; 4] =
    [BEST, "feedforward", "cross-coupled", "disturbance-observer"];
/// Longest excitation that is recorded, s.
const EXCITATION_S: f64 = 600.0;

/// Options of the identification and of the cuts.
#[derive(Debug, Clone)]
pub(crate) struct IndependentOptions {
    /// Program that is recorded: name and text; none is the one that `feedwright excite` writes.
    pub excitation: Option<(String, String)>,
    /// Delay of the record that the identification is given, s; `None` leaves it open.
    pub record_delay_s: Option<f64>,
    /// Controllers that cut, beside the uncorrected cut.
    pub controllers: Vec<&'static Entry>,
    /// Their parameters, and the seed of the training.
    pub choices: Choices,
}

/// Identified values of an axis, beside the true ones.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct IdentifiedAxis {
    /// Its name.
    pub name: String,
    /// The verdict, in words.
    pub verdict: String,
    /// Linear part of what was found. Its delays are one, within the loop.
    pub found: LinearPart,
    /// Linear part of the plant.
    pub plant: LinearPart,
    /// RMS that a free run leaves of what was not fitted, and of the following error there, um.
    pub left_um: [f64; 2],
}

/// A machine, identified.
struct Identified {
    machine: IndependentMachine,
    axes: Vec<IdentifiedAxis>,
    /// The machine file from its log, with the limits of its control.
    file: Machine,
    /// Models of two and of three axes, where a cut takes them.
    models: [Option<Result<Model, ModelMisfit>>; 2],
}

/// A cut of a program by the independent plant.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct IndependentCut {
    /// Controller, and errors at the tool, uncorrected and with it.
    #[serde(flatten)]
    pub row: SweepRow,
    /// RMS and largest error where the encoders are, um: uncorrected, and with the controller.
    pub encoders_um: [[f64; 2]; 2],
    /// Why nothing was identified that the controller goes by; it then cuts uncorrected.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub without_model: Option<String>,
    /// Ways in which the cut is worse than uncorrected.
    pub faults: Vec<Failure>,
}

/// All about a machine.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct IndependentResult {
    /// The plant.
    pub machine: IndependentMachine,
    /// Identified axes; empty if the identification was rejected.
    pub axes: Vec<IdentifiedAxis>,
    /// Why it was refused.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
    /// Its cuts.
    pub cuts: Vec<IndependentCut>,
}

/// Why a machine was not identified.
#[derive(Debug, Error, Diagnostic)]
pub(crate) enum IndependentError {
    /// Its data sheet or its machine file cannot be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Machine(#[from] MachineError),
    /// The excitation program cannot be made.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Excite(#[from] ExciteError),
    /// A program cannot be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Program(#[from] feedwright::JobError),
    /// The excitation was not cut.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Run(#[from] RunError),
    /// Its loops are unstable.
    #[error("{machine} does not follow its excitation: diverged at {at_s:.3} s")]
    Diverged {
        /// The machine.
        machine: String,
        /// Time of the divergence, s.
        at_s: f64,
    },
    /// The log is refused.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Log(#[from] LogError),
    /// The model cannot be identified from the log.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Identification(#[from] LogJobError),
    /// Ended from outside.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Cancelled(#[from] Cancelled),
}

impl IndependentError {
    /// Returns true if the machine could not be identified and nothing else is wrong.
    fn is_refusal(&self) -> bool {
        matches!(
            self,
            Self::Diverged { .. } | Self::Log(_) | Self::Identification(LogJobError::NotFound(_))
        )
    }
}

/// Commands and encoder positions of the same moments, mm.
type Samples = Rc<RefCell<Vec<[[f64; 3]; 2]>>>;

/// A plant whose recorder runs.
struct Recorded {
    plant: IndependentPlant,
    last: [[f64; 3]; 2],
    samples: Samples,
}

impl Mechanism for Recorded {
    fn step(&mut self, command_mm: [f64; 3]) -> Measurement<3> {
        self.samples.borrow_mut().push([command_mm, self.last[1]]);
        let measurement = self.plant.step(command_mm);
        self.last = [command_mm, measurement.measured_mm];
        measurement
    }

    fn skip(&mut self, periods: u64) {
        for _ in 0..periods {
            self.step(self.last[0]);
        }
    }

    fn has_geometry(&self) -> bool {
        self.plant.has_geometry()
    }
}

/// Returns the log that a recorder writes while the machine cuts its excitation program
/// uncorrected.
///
/// # Errors
/// Fails if the plant does not follow, or if the work is ended from outside.
fn recorded(
    machine: &IndependentMachine,
    options: &IndependentOptions,
    watch: &dyn Watch,
) -> Result<String, IndependentError> {
    let sheet = machine.sheet()?;
    let (name, text) = match &options.excitation {
        Some(given) => given.clone(),
        None => (
            "excite.ngc".to_owned(),
            excitation_program(&sheet, ExciteOptions::default())?.text,
        ),
    };
    let program = SweepProgram::from_text(
        &name,
        &text,
        Length {
            machine: &sheet,
            limit_s: EXCITATION_S,
        },
    )?;
    let samples = Samples::default();
    let plant = |start_mm: [f64; 3], _: u64| -> Box<dyn Mechanism> {
        let plant = IndependentPlant::new(&machine.axes, start_mm);
        Box::new(Recorded {
            plant,
            last: [start_mm; 2],
            samples: samples.clone(),
        })
    };
    let run = Run::on(&sheet).plant(&plant).watched(watch);
    let done = run.cut_steps::<3>(&program.steps, &mut Uncorrected, &mut [])?;
    if let Outcome::Diverged { at_s } = done.outcome {
        return Err(IndependentError::Diverged {
            machine: machine.name.clone(),
            at_s,
        });
    }
    let mut text = format!("# sample_time_s = {}\n# n", sheet.period.servo_s);
    AXIS_NAMES
        .iter()
        .for_each(|name| text += &format!(" {name}.cmd {name}.act"));
    for (n, [command_mm, seen_mm]) in samples.borrow().iter().enumerate() {
        let _ = write!(text, "\n{n}");
        for (command, seen) in command_mm.iter().zip(seen_mm) {
            // Writing to a string does not fail.
            let _ = write!(text, " {command:.6} {seen:.6}");
        }
    }
    Ok(text + "\n")
}

impl Identified {
    /// Identifies a machine from its log alone.
    ///
    /// # Errors
    /// Fails if the log does not identify the axis models, or if the work is ended from outside.
    fn of(
        machine: &IndependentMachine,
        log: &str,
        record_delay_s: Option<f64>,
        watch: &dyn Watch,
    ) -> Result<Self, IndependentError> {
        let name = format!("{}.log", machine.name);
        let log = Log::from_reader(
            Path::new(&name),
            log.as_bytes(),
            log.len() as u64,
            &Columns::default(),
            watch,
        )?;
        let facts = AxisFacts {
            record_delay_s,
            ..AxisFacts::default()
        };
        let identified = LogJob {
            name,
            facts,
            ..LogJob::default()
        }
        .run(log, watch)?;
        let mut file = Machine::parse("mine.toml", &machine_text(&identified, &machine.name))?;
        let sheet = machine.sheet()?;
        file.limits = sheet.limits;
        for (axis, of_sheet) in file.axes.iter_mut().zip(&sheet.axes) {
            axis.max_velocity_mm_s = of_sheet.max_velocity_mm_s;
            axis.max_accel_mm_s2 = of_sheet.max_accel_mm_s2;
            axis.max_jerk_mm_s3 = of_sheet.max_jerk_mm_s3;
        }
        let axes = (0..identified.machine.axes.len())
            .map(|i| IdentifiedAxis::of(&identified, i, machine))
            .collect();
        Ok(Self {
            machine: machine.clone(),
            axes,
            file,
            models: [None, None],
        })
    }

    /// Trains the models that the cuts of programs take, as `feedwright identify --machine` does.
    fn train(&mut self, programs: &[SweepProgram], options: &IndependentOptions) {
        let Some(best) = options.controllers.iter().find(|entry| entry.name == BEST) else {
            return;
        };
        for (axes, model) in (2..).zip(&mut self.models) {
            if programs.iter().any(|program| program.axes == axes) {
                *model =
                    Some(Setup::new(&self.file, &options.choices).train(best, axes, String::new()));
            }
        }
    }
}

impl IdentifiedAxis {
    fn of(identified: &LogIdentified, axis: usize, machine: &IndependentMachine) -> Self {
        let found = &identified.machine.axes[axis];
        let scores = &found.scores;
        let place = AXIS_NAMES.iter().position(|name| *name == found.name);
        Self {
            name: found.name.clone(),
            verdict: identified.verdict(axis),
            found: linear(found),
            plant: place
                .map(|place| LinearPart::of(&machine.axes[place]))
                .unwrap_or_default(),
            left_um: [scores.grey_box.whole_um, scores.following_um],
        }
    }
}

/// Returns the linear part of an identified axis model.
fn linear(found: &FoundAxis) -> LinearPart {
    let values = found
        .resolved
        .as_ref()
        .map_or(&found.values, |resolved| &resolved.values);
    let get = |term: ModelTerm| values.get(term);
    let (product, speed_loop) = (get(ModelTerm::LoopGain), get(ModelTerm::Damping));
    let feedforward = get(ModelTerm::VelocityFeedforward);
    // Without an integral the loop carries its viscous friction by an error.
    let carried = if get(ModelTerm::Integral) > 0.0 {
        values.speed_gain_1_s()
    } else {
        speed_loop
    };
    LinearPart {
        gain_product_1_s2: product,
        speed_loop_1_s: speed_loop,
        velocity_feedforward: feedforward,
        command_delay_s: values.commands_late_s(),
        loop_delay_s: get(ModelTerm::LoopDelay),
        lag_s: (carried - feedforward * values.speed_gain_1_s()) / product
            + values.commands_late_s(),
    }
}

/// A cut: figures at the tool, and RMS and largest error of the encoders, um.
struct CutOnce {
    tool: Figures,
    encoders_um: [f64; 2],
    without_model: Option<String>,
}

/// One program on one machine with all controllers.
fn cut_program(
    identified: &Identified,
    program: &SweepProgram,
    options: &IndependentOptions,
    watch: &dyn Watch,
) -> Result<Vec<IndependentCut>, Cancelled> {
    match program.axes {
        2 => cut_axes::<2>(identified, program, options, watch),
        _ => cut_axes::<3>(identified, program, options, watch),
    }
}

fn cut_axes<const N: usize>(
    identified: &Identified,
    program: &SweepProgram,
    IndependentOptions {
        controllers,
        choices,
        ..
    }: &IndependentOptions,
    watch: &dyn Watch,
) -> Result<Vec<IndependentCut>, Cancelled>
where
    Entry: Make<N>,
{
    let plan = PlanCache::default();
    let cut = |entry: &'static Entry| {
        let made = controller::<N>(entry, identified, choices);
        cut_once(identified, program, entry, made, (&plan, watch))
    };
    let base = cut(&UNCORRECTED)?;
    let with = |entry: &&'static Entry| {
        let CutOnce {
            tool,
            encoders_um,
            without_model,
        } = cut(entry)?;
        let row = SweepRow {
            program: program.name.clone(),
            machine: identified.machine.name.clone(),
            model: None,
            controller: entry.name.to_owned(),
            rigid: false,
            uncorrected: base.tool.clone(),
            corrected: tool,
        };
        let (faults, encoders_um) = (row.faults(), [base.encoders_um, encoders_um]);
        Ok(IndependentCut {
            row,
            encoders_um,
            without_model,
            faults,
        })
    };
    controllers.iter().map(with).collect()
}

/// A controller by the machine file, and why there is no model for it.
fn controller<const N: usize>(
    entry: &Entry,
    Identified { file, models, .. }: &Identified,
    choices: &Choices,
) -> (Box<dyn Controller<N>>, Option<String>)
where
    Entry: Make<N>,
{
    let setup = || Setup::new(file, choices);
    let made = match models
        .get(N - 2)
        .and_then(Option::as_ref)
        .filter(|_| entry.name == BEST)
    {
        Some(Ok(model)) => entry.make_with::<N>(setup(), model),
        Some(Err(cause)) => return (Box::new(Uncorrected), Some(cause.to_string())),
        None => Ok(entry.make(&mut setup())),
    };
    match made {
        Ok(controller) => (controller, None),
        Err(cause) => (Box::new(Uncorrected), Some(cause.to_string())),
    }
}

fn cut_once<const N: usize>(
    identified: &Identified,
    program: &SweepProgram,
    entry: &Entry,
    (mut controller, without_model): (Box<dyn Controller<N>>, Option<String>),
    (plan, watch): (&PlanCache, &dyn Watch),
) -> Result<CutOnce, Cancelled> {
    let axes = &identified.machine.axes;
    let plant = |start_mm: [f64; 3], _: u64| -> Box<dyn Mechanism> {
        Box::new(IndependentPlant::new(axes, start_mm))
    };
    let mut statistics = Statistics::new();
    let run = Run::on(&identified.file)
        .plant(&plant)
        .laps(entry.laps)
        .sharing(plan)
        .watched(watch);
    let done = match run.cut_steps(&program.steps, &mut *controller, &mut [&mut statistics]) {
        Ok(done) => done,
        Err(RunError::Cancelled(cancelled)) => return Err(cancelled),
        Err(error) => {
            let tool = Figures::failed(&error.to_string());
            return Ok(CutOnce {
                tool,
                encoders_um: [0.0; 2],
                without_model,
            });
        }
    };
    let encoders_um = done.joint_error.map_or([0.0; 2], |error| {
        [error.rms_mm, error.max_mm].map(|mm| 1e3 * mm)
    });
    Ok(CutOnce {
        tool: Figures::of(&done, &statistics, entry),
        encoders_um,
        without_model,
    })
}

/// Identifies machines one after the other and cuts all programs on each, programs side by side.
/// The result does not depend on the number of threads.
///
/// # Errors
/// An end from outside.
pub(crate) fn independent(
    machines: &[IndependentMachine],
    programs: impl Fn(&Machine) -> Result<Vec<SweepProgram>, IndependentError>,
    options: &IndependentOptions,
    watch: &dyn Watch,
) -> Result<Vec<IndependentResult>, IndependentError> {
    let mut results = Vec::new();
    for machine in machines {
        watch.begin(&format!("recording {}", machine.name), 1);
        let log = recorded(machine, options, watch);
        let identified =
            log.and_then(|log| Identified::of(machine, &log, options.record_delay_s, watch));
        let mut identified = match identified {
            Ok(identified) => identified,
            Err(error) if !error.is_refusal() => return Err(error),
            Err(error) => {
                let refused = Some(error.to_string());
                results.push(IndependentResult {
                    machine: machine.clone(),
                    axes: vec![],
                    refused,
                    cuts: vec![],
                });
                continue;
            }
        };
        let programs = programs(&machine.sheet()?)?;
        watch.begin(&format!("identifying {} for {BEST}", machine.name), 1);
        identified.train(&programs, options);
        watch.begin(
            &format!("cutting on {}", machine.name),
            programs.len() as u64,
        );
        let cut = |program: &SweepProgram| {
            let cuts = cut_program(&identified, program, options, watch);
            watch.advance(1);
            cuts
        };
        let cuts = programs
            .par_iter()
            .map(cut)
            .collect::<Result<Vec<_>, _>>()?
            .concat();
        let Identified { machine, axes, .. } = identified;
        results.push(IndependentResult {
            machine,
            axes,
            refused: None,
            cuts,
        });
    }
    Ok(results)
}
