//! `feedwright sweep`: the jobs of a list, on all cores.

use std::io::Write;
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use feedwright_sim::Watch;
use miette::{Report, Result, miette};

use crate::command::args::sweep::{JobShard, SweepJobsArgs};
use crate::command::console::Console;
use crate::command::message::{OUT_OF_TOLERANCE, printed, remark, show};
use crate::command::progress::Bar;
use crate::command::streams::{make_folder, tables};
use crate::command::sweep::job_list::JobList;
use crate::command::sweep::{JobDone, do_job};
use crate::output::OutputError;
use crate::store::Store;

/// Jobs with mistakes that are named; the table of `merge` has all.
const NAMED: usize = 5;

pub(crate) fn run(args: &SweepJobsArgs, console: &Console) -> Result<ExitCode> {
    let list = JobList::read(&args.jobs)?;
    make_folder(&args.out)?;
    let workers = args.workers.map_or_else(
        || std::thread::available_parallelism().map_or(1, usize::from),
        usize::from,
    );
    let bar = console.bar(0);
    bar.begin(&format!("{} jobs", list.len()), list.len() as u64);
    let work = SharedWork {
        list,
        store: Store::new(args.out.clone()),
        shard: args.shard,
        next: AtomicUsize::new(0),
        tally: Mutex::default(),
    };
    std::thread::scope(|scope| (0..workers).for_each(|_| drop(scope.spawn(|| work.on(&bar)))));
    bar.clear();
    let tally = work
        .tally
        .into_inner()
        .unwrap_or_else(PoisonError::into_inner);
    if bar.is_cancelled() {
        remark(&format!(
            "{} results were written; the same command goes on from there",
            tally.computed
        ));
    }
    bar.check()?;
    tally.finish()
}

/// State that the threads share.
struct SharedWork {
    list: JobList,
    store: Store,
    shard: Option<JobShard>,
    next: AtomicUsize,
    tally: Mutex<Tally>,
}

/// Counts of the jobs by outcome.
#[derive(Default)]
struct Tally {
    computed: usize,
    found: usize,
    elsewhere: usize,
    /// Jobs whose result is an error.
    mistaken: usize,
    /// Jobs without a result.
    missing: usize,
    /// Reason why the sweep ends early.
    stopped: Option<Report>,
}

impl SharedWork {
    /// Does jobs until there are no more.
    fn on(&self, bar: &Bar) {
        while !bar.is_cancelled() {
            match self.list.job(self.next.fetch_add(1, Ordering::Relaxed)) {
                Ok(None) => return,
                Ok(Some(job)) if self.shard.is_some_and(|shard| !job.is_in(shard)) => {
                    self.tally().elsewhere += 1;
                }
                Ok(Some(job)) => match do_job(&self.store, &job, bar) {
                    Ok(done) => self.tally().add(
                        &done,
                        bar,
                        &format!("{} on {}", job.program.display(), job.machine.display()),
                    ),
                    Err(_) if bar.is_cancelled() => return,
                    // Where one result cannot be written, none can.
                    Err(error) if error.downcast_ref::<OutputError>().is_some() => {
                        return self.stop(error);
                    }
                    Err(error) => self.tally().miss(error, bar),
                },
                Err(error) => self.tally().miss(error, bar),
            }
            bar.advance(1);
        }
    }

    fn tally(&self) -> std::sync::MutexGuard<'_, Tally> {
        self.tally.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Lets no thread begin another job.
    fn stop(&self, error: Report) {
        self.next.store(self.list.len(), Ordering::Relaxed);
        self.tally().stopped.get_or_insert(error);
    }
}

impl Tally {
    fn add(&mut self, done: &JobDone, bar: &Bar, name: &str) {
        if done.found {
            self.found += 1;
        } else {
            self.computed += 1;
        }
        if let Some(error) = &done.error {
            self.mistaken += 1;
            if self.mistaken <= NAMED {
                bar.aside(|| {
                    show(&miette!(
                        "{name}: {}",
                        error.lines().collect::<Vec<_>>().join("; ")
                    ));
                });
            }
        }
    }

    fn miss(&mut self, error: Report, bar: &Bar) {
        self.missing += 1;
        if self.missing <= NAMED {
            bar.aside(|| show(&error));
        }
    }

    fn finish(self) -> Result<ExitCode> {
        let Self {
            computed,
            found,
            elsewhere,
            mistaken,
            missing,
            stopped,
        } = self;
        if let Some(error) = stopped {
            let what = format!(
                "the sweep ended after {computed} results; the same command goes on from there"
            );
            return Err(error.wrap_err(what));
        }
        let mut reported = format!(
            "{} jobs: {computed} computed, {found} found",
            computed + found + missing
        );
        for (count, what) in [
            (elsewhere, "in other shards"),
            (mistaken, "with mistakes"),
            (missing, "without a result"),
        ] {
            if count > 0 {
                reported += &format!(", {count} {what}");
            }
        }
        if missing > 0 {
            return Err(miette!(
                help = "mend what the messages above name, and start the same command again",
                "{reported}"
            ));
        }
        let code = if mistaken > 0 {
            ExitCode::from(OUT_OF_TOLERANCE)
        } else {
            ExitCode::SUCCESS
        };
        printed(writeln!(tables([]), "{reported}"), code)
    }
}
