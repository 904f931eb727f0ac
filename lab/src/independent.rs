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
use feedwright_control::Uncorrected;
use feedwright_ident::{
    AxisFacts, Columns, ExciteOptions, FoundAxis, Log, Model, ModelTerm, excitation_program,
};
use feedwright_sim::{
    AXIS_NAMES, BoxedController, Cancelled, Machine, Measurement, Mechanism, Outcome, PlanCache,
    Run, RunError, Watch,
};
use miette::Result;
use rayon::prelude::*;
use serde::Serialize;

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

/// A result, or why the machine cannot be identified where nothing else is wrong.
type OrRefused<T> = std::result::Result<T, String>;

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
/// uncorrected. A machine that does not follow is refused.
fn recorded(
    machine: &IndependentMachine,
    options: &IndependentOptions,
    watch: &dyn Watch,
) -> Result<OrRefused<String>> {
    let sheet = machine.sheet()?;
    let (name, text) = match &options.excitation {
        Some(given) => given.clone(),
        None => {
            let text = excitation_program(&sheet, ExciteOptions::default())?.text;
            ("excite.ngc".to_owned(), text)
        }
    };
    let program = SweepProgram::from_text(&name, &text, Length(&sheet, EXCITATION_S))?;
    let samples = Samples::default();
    let plant = |start_mm: [f64; 3], _: u64| -> Box<dyn Mechanism> {
        Box::new(Recorded {
            plant: IndependentPlant::new(&machine.axes, start_mm),
            last: [start_mm; 2],
            samples: samples.clone(),
        })
    };
    let run = Run::on(&sheet).plant(&plant).watched(watch);
    let done = run.cut_steps::<3>(&program.steps, &mut Uncorrected, &mut [])?;
    if let Outcome::Diverged { at_s } = done.outcome {
        let name = &machine.name;
        let why = format!("{name} does not follow its excitation: diverged at {at_s:.3} s");
        return Ok(Err(why));
    }
    let mut text = format!("# sample_time_s = {}\n# n", sheet.period.servo_s);
    for name in AXIS_NAMES {
        text += &format!(" {name}.cmd {name}.act");
    }
    for (n, [command_mm, seen_mm]) in samples.borrow().iter().enumerate() {
        let _ = write!(text, "\n{n}");
        for (command, seen) in command_mm.iter().zip(seen_mm) {
            // Writing to a string does not fail.
            let _ = write!(text, " {command:.6} {seen:.6}");
        }
    }
    Ok(Ok(text + "\n"))
}

impl Identified {
    /// Identifies a machine from its log alone.
    fn of(
        machine: &IndependentMachine,
        log: &str,
        record_delay_s: Option<f64>,
        watch: &dyn Watch,
    ) -> Result<OrRefused<Self>> {
        let name = format!("{}.log", machine.name);
        let (bytes, columns) = (log.as_bytes(), Columns::default());
        let log = Log::from_reader(Path::new(&name), bytes, log.len() as u64, &columns, watch);
        let log = match log {
            Ok(log) => log,
            Err(error) => return Ok(Err(error.to_string())),
        };
        let facts = AxisFacts {
            record_delay_s,
            ..AxisFacts::default()
        };
        let job = LogJob {
            name,
            facts,
            ..LogJob::default()
        };
        let identified = match job.run(log, watch) {
            Ok(identified) => identified,
            Err(LogJobError::NotFound(cause)) => return Ok(Err(cause.to_string())),
            Err(error) => return Err(error.into()),
        };
        let mut file = Machine::parse("mine.toml", &machine_text(&identified, &machine.name))?;
        let sheet = machine.sheet()?;
        file.limits = sheet.limits;
        for (axis, of_sheet) in file.axes.iter_mut().zip(&sheet.axes) {
            axis.max_velocity_mm_s = of_sheet.max_velocity_mm_s;
            axis.max_accel_mm_s2 = of_sheet.max_accel_mm_s2;
            axis.max_jerk_mm_s3 = of_sheet.max_jerk_mm_s3;
        }
        let axes = 0..identified.machine.axes.len();
        Ok(Ok(Self {
            axes: axes
                .map(|i| IdentifiedAxis::of(&identified, i, machine))
                .collect(),
            machine: machine.clone(),
            file,
            models: [None, None],
        }))
    }

    /// Trains the models that the cuts of programs take, as `feedwright identify --machine` does.
    fn train(&mut self, programs: &[SweepProgram], options: &IndependentOptions) {
        let Some(best) = options.controllers.iter().find(|entry| entry.name == BEST) else {
            return;
        };
        for (axes, model) in (2..).zip(&mut self.models) {
            if programs.iter().any(|program| program.axes == axes) {
                let mut setup = Setup::new(&self.file, &options.choices);
                *model = Some(setup.train(best, axes, String::new()));
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
    let resolved = found.resolved.as_ref();
    let values = resolved.map_or(&found.values, |resolved| &resolved.values);
    let get = |term: ModelTerm| values.get(term);
    let mut part = LinearPart {
        gain_product_1_s2: get(ModelTerm::LoopGain),
        speed_loop_1_s: get(ModelTerm::Damping),
        velocity_feedforward: get(ModelTerm::VelocityFeedforward),
        command_delay_s: values.commands_late_s(),
        loop_delay_s: get(ModelTerm::LoopDelay),
        lag_s: 0.0,
    };
    // Without an integral the loop carries its viscous friction by an error.
    let carried = match get(ModelTerm::Integral) > 0.0 {
        true => values.speed_gain_1_s(),
        false => part.speed_loop_1_s,
    };
    let left_1_s = carried - part.velocity_feedforward * values.speed_gain_1_s();
    part.lag_s = left_1_s / part.gain_product_1_s2 + part.command_delay_s;
    part
}

/// Figures of a cut at the tool, RMS and largest error of the encoders, um, and why there is no
/// model.
type CutOnce = (Figures, [f64; 2], Option<String>);

/// One program on one machine with all controllers.
fn cut_program(
    identified: &Identified,
    program: &SweepProgram,
    options: &IndependentOptions,
    watch: &dyn Watch,
) -> Result<Vec<IndependentCut>, Cancelled> {
    let plan = PlanCache::default();
    let cut = |entry: &'static Entry| {
        let made = controller(entry, program.axes, identified, &options.choices);
        cut_once(identified, program, entry, made, (&plan, watch))
    };
    let base = cut(&UNCORRECTED)?;
    let with = |entry: &&'static Entry| {
        let (corrected, encoders_um, without_model) = cut(entry)?;
        let row = SweepRow {
            program: program.name.clone(),
            machine: identified.machine.name.clone(),
            model: None,
            controller: entry.name.to_owned(),
            rigid: false,
            uncorrected: base.0.clone(),
            corrected,
        };
        Ok(IndependentCut {
            faults: row.faults(),
            row,
            encoders_um: [base.1, encoders_um],
            without_model,
        })
    };
    options.controllers.iter().map(with).collect()
}

/// A controller by the machine file, and why there is no model for it.
fn controller(
    entry: &Entry,
    axes: usize,
    Identified { file, models, .. }: &Identified,
    choices: &Choices,
) -> (BoxedController, Option<String>) {
    let setup = || Setup::new(file, choices);
    let made = match models[axes - 2].as_ref().filter(|_| entry.name == BEST) {
        Some(Ok(model)) => entry.make_with(setup(), axes, model),
        Some(Err(cause)) => return (BoxedController::uncorrected(axes), Some(cause.to_string())),
        None => Ok(entry.make(&mut setup(), axes)),
    };
    match made {
        Ok(controller) => (controller, None),
        Err(cause) => (BoxedController::uncorrected(axes), Some(cause.to_string())),
    }
}

fn cut_once(
    Identified { machine, file, .. }: &Identified,
    program: &SweepProgram,
    entry: &Entry,
    (mut controller, without_model): (BoxedController, Option<String>),
    (plan, watch): (&PlanCache, &dyn Watch),
) -> Result<CutOnce, Cancelled> {
    let plant = |start_mm: [f64; 3], _: u64| -> Box<dyn Mechanism> {
        Box::new(IndependentPlant::new(&machine.axes, start_mm))
    };
    let mut statistics = Statistics::new();
    let run = Run::on(file)
        .plant(&plant)
        .laps(entry.laps)
        .sharing(plan)
        .watched(watch);
    match run.cut_boxed_steps(&program.steps, &mut controller, &mut [&mut statistics]) {
        Ok(done) => {
            let encoders_um = done.joint_error.map_or([0.0; 2], |error| {
                [error.rms_mm, error.max_mm].map(|mm| 1e3 * mm)
            });
            Ok((
                Figures::of(&done, &statistics, entry),
                encoders_um,
                without_model,
            ))
        }
        Err(RunError::Cancelled(cancelled)) => Err(cancelled),
        Err(error) => Ok((Figures::failed(&error.to_string()), [0.0; 2], without_model)),
    }
}

/// Identifies machines one after the other and cuts all programs on each, programs side by side.
/// The result does not depend on the number of threads.
///
/// # Errors
/// A program or a machine that cannot be read, or an end from outside.
pub(crate) fn independent(
    machines: &[IndependentMachine],
    programs: impl Fn(&Machine) -> Result<Vec<SweepProgram>>,
    options: &IndependentOptions,
    watch: &dyn Watch,
) -> Result<Vec<IndependentResult>> {
    let mut results = Vec::new();
    for machine in machines {
        watch.begin(&format!("recording {}", machine.name), 1);
        let identified = match recorded(machine, options, watch)? {
            Ok(log) => Identified::of(machine, &log, options.record_delay_s, watch)?,
            Err(why) => Err(why),
        };
        let mut result = IndependentResult {
            machine: machine.clone(),
            axes: vec![],
            refused: None,
            cuts: vec![],
        };
        match identified {
            Err(why) => result.refused = Some(why),
            Ok(mut identified) => {
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
                let cuts: Result<Vec<_>, _> = programs.par_iter().map(cut).collect();
                result.cuts = cuts?.concat();
                result.axes = identified.axes;
            }
        }
        results.push(result);
    }
    Ok(results)
}
