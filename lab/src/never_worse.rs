//! Never worse: controllers compared with the uncorrected cut on every program and every machine,
//! and the cuts that it made worse.
//!
//! A cut is worse if its RMS or its largest contour error, or the uncut path, is worse than the
//! uncorrected cut's by the rule of [`feedwright::harm`], or if the controller is no longer in the
//! loop at the end. Each controller is made for the machine that it cuts on, or for another one
//! (`mismatch.rs`). Cuts depend only on program, machines and seed: the rows are the same for any
//! number of threads, and rows that are [`Kept`] are not cut again.
//!
//! | File | What |
//! |---|---|
//! | `never_worse/program.rs` | a program as it is cut, long ones shortened |
//! | `never_worse/machines.rs` | the machines of the sweep |
//! | `never_worse/cut.rs` | one program on one machine, uncorrected and with each controller |
//! | `never_worse/generated.rs` | random programs on random machines |
//! | `never_worse/verdict.rs` | in what a cut is worse |
//! | `never_worse/summary.rs` | totals, quantiles, failures by severity |

pub(crate) mod program;
pub(crate) mod cut;
pub(crate) mod verdict;
pub(crate) mod generated;
pub(crate) mod machines;
pub(crate) mod summary;

use std::sync::Arc;

use feedwright::{Entry, Setting, key_of};
use feedwright_sim::{Cancelled, Machine, Watch};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::compare::recorded;
use crate::study::{Kept, each};
use cut::{Cutter, SweepRow};
use program::SweepProgram;

/// One program on one machine.
#[derive(Debug, Clone)]
pub struct SweepJob {
    /// Program to cut.
    pub program: Arc<SweepProgram>,
    /// Machine that cuts it.
    pub machine: Arc<Machine>,
    /// The machine that the controller is made for.
    pub model: Arc<Machine>,
}

/// Options that all jobs share.
#[derive(Debug, Clone)]
pub struct SweepOptions {
    /// The controllers that are compared with the uncorrected cut.
    pub controllers: Vec<&'static Entry>,
    /// Parameters that are set.
    pub set: Vec<Setting>,
    /// True if a controller without set parameters uses the recorded values that a search found for
    /// the machine that it is made for.
    pub recorded: bool,
    /// Seed of the training.
    pub seed: u64,
    /// Threads.
    pub threads: usize,
}

/// Seed of the searches whose values are recorded.
const RECORDED_SEED: u64 = 1;

impl SweepOptions {
    /// These controllers with their defaults, on one thread.
    pub const fn of(controllers: Vec<&'static Entry>) -> Self {
        Self {
            controllers,
            set: Vec::new(),
            recorded: false,
            seed: 1,
            threads: 1,
        }
    }

    /// Parameters of the controllers that are made for a machine.
    fn set_for(&self, model: &Machine) -> Vec<Setting> {
        let mut all = self.set.clone();
        if self.recorded {
            for tuned in recorded::known(std::slice::from_ref(model), RECORDED_SEED) {
                let is_it = |entry: &&&'static Entry| entry.name == tuned.controller;
                let is_set = self
                    .set
                    .iter()
                    .any(|set| set.controller == tuned.controller);
                if let Some(entry) = self.controllers.iter().find(is_it).filter(|_| !is_set) {
                    all.extend(tuned.settings(entry));
                }
            }
        }
        all
    }
}

/// Every program on every machine: by machine, so that each is identified once for a thread, and
/// the longest program first, so that no thread is left alone with it.
pub(crate) fn jobs(programs: Vec<SweepProgram>, machines: Vec<Machine>) -> Vec<SweepJob> {
    let mut programs: Vec<Arc<SweepProgram>> = programs.into_iter().map(Arc::new).collect();
    programs.sort_by(|a, b| {
        b.machining_s
            .total_cmp(&a.machining_s)
            .then_with(|| a.name.cmp(&b.name))
    });
    let on = |machine: Machine| {
        let machine = Arc::new(machine);
        programs.iter().map(move |program| SweepJob {
            program: program.clone(),
            machine: machine.clone(),
            model: machine.clone(),
        })
    };
    machines.into_iter().flat_map(on).collect()
}

/// `count` of the jobs, drawn by the seed, in their order.
pub(crate) fn sample(jobs: Vec<SweepJob>, count: usize, seed: u64) -> Vec<SweepJob> {
    let mut drawn: Vec<usize> = (0..jobs.len()).collect();
    drawn.shuffle(&mut Xoshiro256PlusPlus::seed_from_u64(seed));
    drawn.truncate(count);
    drawn.sort_unstable();
    drawn.into_iter().map(|i| jobs[i].clone()).collect()
}

/// Returns a key of everything that a cut with a controller depends on, apart from the program that
/// makes it.
fn key(job: &SweepJob, options: &SweepOptions, controller: &Entry) -> String {
    let is_it = |set: &Setting| set.controller == controller.name;
    let set: Vec<Setting> = options
        .set_for(&job.model)
        .into_iter()
        .filter(is_it)
        .collect();
    let machine = serde_json::json!(*job.machine).to_string();
    let model = serde_json::json!(*job.model).to_string();
    let set_json = serde_json::json!(set).to_string();
    let seed = options.seed.to_le_bytes();
    let program = job.program.key.as_bytes();
    let mut parts = vec![
        program,
        machine.as_bytes(),
        controller.name.as_bytes(),
        &seed,
    ];
    if !Arc::ptr_eq(&job.model, &job.machine) {
        parts.push(model.as_bytes());
    }
    if !set.is_empty() {
        parts.push(set_json.as_bytes());
    }
    key_of(&parts)
}

/// A row under the names that program and machines have now.
fn named(row: &SweepRow, job: &SweepJob) -> SweepRow {
    let model = (!Arc::ptr_eq(&job.model, &job.machine)).then(|| job.model.name.clone());
    SweepRow {
        program: job.program.name.clone(),
        machine: job.machine.name.clone(),
        model,
        ..row.clone()
    }
}

impl SweepJob {
    /// Steps of its progress: seconds of machining.
    pub fn steps(&self) -> u64 {
        (self.program.machining_s as u64).max(1)
    }
}

/// Cuts all jobs on all threads, uncorrected and with each controller: rows in the order of the
/// jobs, and within a job in the order of the controllers. The controllers of a thread serve all
/// jobs by the same model that follow each other.
///
/// # Errors
/// An end from outside; what was cut is in the store.
pub(crate) fn sweep(
    jobs: &[SweepJob],
    options: &SweepOptions,
    kept: &Kept,
    watch: &dyn Watch,
) -> Result<Vec<SweepRow>, Cancelled> {
    let steps = jobs.iter().map(SweepJob::steps).sum();
    watch.begin(&format!("{} cuts", jobs.len()), steps);
    let cut = |cutter: &mut Option<Cutter>, job: &SweepJob| {
        let key = |entry: &&'static Entry| key(job, options, entry);
        let keys: Vec<String> = options.controllers.iter().map(key).collect();
        let found: Option<Vec<SweepRow>> = keys.iter().map(|key| kept.get(key)).collect();
        let rows = match found {
            Some(rows) => rows,
            None => {
                let cutter = match cutter {
                    Some(cutter) if cutter.is_for(&job.model) => cutter,
                    other => other.insert(Cutter::new(&job.model, options)),
                };
                let rows = cutter.rows(&job.program, &job.machine, watch)?;
                keys.iter()
                    .zip(&rows)
                    .for_each(|(key, row)| kept.put(key, row));
                rows
            }
        };
        watch.advance(job.steps());
        Ok(rows.iter().map(|row| named(row, job)).collect::<Vec<_>>())
    };
    let rows = each(jobs, options.threads, || None, cut)?;
    watch.check()?;
    Ok(rows.concat())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::never_worse::program::Length;
    use crate::peers::{DISTURBANCE_OBSERVER, FEEDFORWARD_CROSS_COUPLED};
    use feedwright::UNCORRECTED;

    #[test]
    fn what_was_cut_is_not_cut_again_and_half_a_file_does_no_harm() {
        let folder = tempfile::tempdir().expect("a folder");
        let machine = Machine::load("tnv40".as_ref()).expect("built in");
        let length = Length(&machine, 10.0);
        let programs = ["G21 F1200\nG1 X5\nG1 Y5\nM2\n", "G21 F1200\nG1 X-5\nM2\n"]
            .map(|text| SweepProgram::from_text("lines", text, length).expect("a program"));
        let jobs = jobs(programs.to_vec(), vec![machine.clone()]);
        let options = SweepOptions {
            threads: 2,
            ..SweepOptions::of(vec![&UNCORRECTED])
        };
        let swept = |jobs: &[SweepJob]| {
            let kept = Kept::open(Some(folder.path()), "").expect("a folder");
            let rows = sweep(jobs, &options, &kept, &()).expect("nobody ends it");
            (rows, kept.found())
        };
        let first = swept(&jobs);
        let mut files =
            glob::glob(&format!("{}/*/*.json", folder.path().display())).expect("a pattern");
        std::fs::write(
            files.next().expect("two files").expect("it can be read"),
            "{",
        )
        .expect("it can be written");
        let again = swept(&jobs);
        assert_eq!((first.1, again.1), (0, 1));
        assert_eq!(first.0, again.0);
        let renamed = SweepJob {
            program: Arc::new(SweepProgram {
                name: "other".to_owned(),
                ..(*jobs[0].program).clone()
            }),
            ..jobs[0].clone()
        };
        let named = swept(&[renamed]).0;
        assert_eq!(
            (named[0].program.as_str(), &named[0].uncorrected),
            ("other", &first.0[0].uncorrected)
        );
    }

    #[test]
    fn recorded_values_are_those_of_the_machine_of_the_model_and_what_is_set_goes_before() {
        let set = Setting {
            controller: FEEDFORWARD_CROSS_COUPLED.name,
            name: "kp",
            value: 0.25,
        };
        let controllers = vec![&DISTURBANCE_OBSERVER, &FEEDFORWARD_CROSS_COUPLED];
        let options = SweepOptions {
            recorded: true,
            set: vec![set],
            ..SweepOptions::of(controllers)
        };
        let of = |name: &str| options.set_for(&Machine::load(name.as_ref()).expect("built in"));
        let (workshop, router) = (of("workshop"), of("router"));
        for all in [&workshop, &router] {
            assert_eq!(all.len(), 2, "{all:?}");
            assert_eq!(
                (all[0], all[1].controller),
                (set, DISTURBANCE_OBSERVER.name)
            );
        }
        assert_ne!(workshop[1].value, router[1].value);
        let mut other = Machine::load("workshop".as_ref()).expect("built in");
        other.axes[0].inertia_kg_m2 *= 1.1;
        assert_eq!(
            options.set_for(&other),
            [set],
            "nothing was searched for another machine"
        );
    }
}
