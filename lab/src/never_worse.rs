//! Never worse: a controller compared with the uncorrected cut on every program and every machine, and the cuts that it made worse.
//!
//! A cut is worse where its RMS or its largest contour error, or the uncut path, is worse than the uncorrected cut's by the rule
//! of [`feedwright::harm`], or where the controller is not in the loop any more at the end. Each controller is made for the
//! machine that it cuts on, or for another one (`mismatch.rs`). Cuts depend on nothing but program, machines and seed: the rows are the
//! same for any number of threads, and those that a [`Journal`] holds are not cut again.
//!
//! | File | What |
//! |---|---|
//! | `never_worse/program.rs` | a program as it is cut, long ones shortened |
//! | `never_worse/machines.rs` | the machines of the sweep |
//! | `never_worse/cut.rs` | one program on one machine, uncorrected and corrected |
//! | `never_worse/generated.rs` | random programs on random machines, and the smallest case of a failure |
//! | `never_worse/verdict.rs` | in what a cut is worse |
//! | `never_worse/summary.rs` | totals, quantiles, failures by severity |

pub mod program;
pub mod cut;
pub mod verdict;
pub mod generated;
pub mod machines;
pub mod summary;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use feedwright::{Entry, Setting, key_of};
use feedwright_sim::{Cancelled, Machine, Watch};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::journal::Journal;
use cut::{Cutter, SweepRow};
use program::SweepProgram;

/// One program on one machine.
#[derive(Debug, Clone)]
pub struct SweepJob {
    /// What is cut.
    pub program: Arc<SweepProgram>,
    /// On what.
    pub machine: Arc<Machine>,
    /// The machine that the controller is made for.
    pub model: Arc<Machine>,
}

/// What the jobs have in common.
#[derive(Debug, Clone)]
pub struct SweepOptions {
    /// The controller that is compared with the uncorrected cut.
    pub controller: &'static Entry,
    /// Its parameters that are set.
    pub set: Vec<Setting>,
    /// Seed of its training.
    pub seed: u64,
    /// Threads.
    pub threads: usize,
}

/// Every program on every machine: by machine, so that each is identified once for a thread, and the longest program
/// first, so that no thread is left alone with it.
pub fn jobs(programs: Vec<SweepProgram>, machines: Vec<Machine>) -> Vec<SweepJob> {
    let mut programs: Vec<Arc<SweepProgram>> = programs.into_iter().map(Arc::new).collect();
    programs.sort_by(|a, b| b.machining_s.total_cmp(&a.machining_s).then_with(|| a.name.cmp(&b.name)));
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
pub fn sample(jobs: Vec<SweepJob>, count: usize, seed: u64) -> Vec<SweepJob> {
    let mut drawn: Vec<usize> = (0..jobs.len()).collect();
    drawn.shuffle(&mut Xoshiro256PlusPlus::seed_from_u64(seed));
    drawn.truncate(count);
    drawn.sort_unstable();
    drawn.into_iter().map(|i| jobs[i].clone()).collect()
}

/// What a cut depends on, apart from the program that makes it.
fn key(job: &SweepJob, options: &SweepOptions) -> String {
    let machine = serde_json::json!(*job.machine).to_string();
    let SweepOptions { controller, set, seed, .. } = options;
    let (seed, set_json) = (seed.to_le_bytes(), serde_json::json!(set).to_string());
    let model: String;
    let mut parts = vec![job.program.key.as_bytes(), machine.as_bytes(), controller.name.as_bytes(), &seed];
    if !Arc::ptr_eq(&job.model, &job.machine) {
        model = serde_json::json!(*job.model).to_string();
        parts.push(model.as_bytes());
    }
    if !set.is_empty() {
        parts.push(set_json.as_bytes());
    }
    key_of(&parts)
}

/// A row under the names that program and machine have now.
fn named(row: &SweepRow, job: &SweepJob) -> SweepRow {
    SweepRow { program: job.program.name.clone(), machine: job.machine.name.clone(), ..row.clone() }
}

/// The journal of a version in a folder.
pub fn journal_path(folder: &Path, version: &str) -> PathBuf {
    folder.join(format!("never-worse-{version}.jsonl"))
}

/// What a sweep came to.
#[derive(Debug, Clone, PartialEq)]
pub struct Swept {
    /// In the order of the jobs.
    pub rows: Vec<SweepRow>,
    /// How many of them the journal had.
    pub known: usize,
}

impl SweepJob {
    /// Steps of its progress: seconds of machining.
    pub fn steps(&self) -> u64 {
        (self.program.machining_s as u64).max(1)
    }
}

/// Cuts all jobs, uncorrected and corrected.
///
/// # Errors
/// An end from outside; what was cut is in the journal.
pub fn sweep(
    jobs: &[SweepJob],
    options: &SweepOptions,
    journal: &Journal<SweepRow>,
    watch: &dyn Watch,
) -> Result<Swept, Cancelled> {
    watch.begin(&format!("{} cuts", jobs.len()), jobs.iter().map(SweepJob::steps).sum());
    let (next, known) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let rows = Mutex::new(vec![None; jobs.len()]);
    let work = || {
        // Made where it is needed: what it has identified serves all programs of a machine that follow each other.
        let mut cutter: Option<Cutter> = None;
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            let Some(job) = jobs.get(i) else { break };
            let key = key(job, options);
            let row = match journal.get(&key).map(|row| named(row, job)) {
                Some(row) => {
                    known.fetch_add(1, Ordering::Relaxed);
                    row
                }
                None => {
                    let cutter = match &mut cutter {
                        Some(cutter) if cutter.is_for(&job.model) => cutter,
                        other => other.insert(Cutter::new(&job.model, options)),
                    };
                    let Ok(row) = cutter.row(&job.program, &job.machine, watch) else { break };
                    journal.add(&key, &row);
                    row
                }
            };
            rows.lock().unwrap_or_else(PoisonError::into_inner)[i] = Some(row);
            watch.advance(job.steps());
        }
    };
    std::thread::scope(|scope| (0..options.threads.max(1)).for_each(|_| drop(scope.spawn(work))));
    watch.check()?;
    let rows = rows.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().flatten().collect();
    Ok(Swept { rows, known: known.into_inner() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::never_worse::program::Length;
    use crate::peers::CONTROLLERS;
    use feedwright::BASELINE;

    #[test]
    fn what_was_cut_is_not_cut_again_and_half_a_line_does_no_harm() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = journal_path(folder.path(), "version");
        let machine = Machine::load("tnv40".as_ref()).expect("built in");
        let length = Length { machine: &machine, limit_s: 10.0 };
        let programs = ["G21 F1200\nG1 X5\nG1 Y5\nM2\n", "G21 F1200\nG1 X-5\nM2\n"]
            .map(|text| SweepProgram::from_text("lines", text, length).expect("a program"));
        let jobs = jobs(programs.to_vec(), vec![machine.clone()]);
        let options = SweepOptions {
            controller: CONTROLLERS.find(BASELINE).expect("in the table"),
            set: Vec::new(),
            seed: 1,
            threads: 2,
        };
        let swept = |jobs: &[SweepJob]| {
            sweep(jobs, &options, &Journal::open(&path).expect("a journal"), &()).expect("nobody ends it")
        };
        let first = swept(&jobs);
        let mut text = std::fs::read_to_string(&path).expect("it was written");
        let second_line = text.find('\n').expect("two lines") + 1;
        text.truncate(second_line + 40);
        std::fs::write(&path, text).expect("it can be written");
        let again = swept(&jobs);
        assert_eq!((first.known, again.known), (0, 1));
        assert_eq!(first.rows, again.rows);
        let renamed = SweepJob {
            program: Arc::new(SweepProgram { name: "other".to_owned(), ..(*jobs[0].program).clone() }),
            ..jobs[0].clone()
        };
        let named = swept(&[renamed]).rows;
        assert_eq!((named[0].program.as_str(), &named[0].uncorrected), ("other", &first.rows[0].uncorrected));
    }
}
