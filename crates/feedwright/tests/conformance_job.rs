//! What a job promises to whoever runs it: it can be written down and read back, it tells its progress, it ends when it is told
//! to, it needs no file, and it shares nothing with another one beside it.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use feedwright::{BEST, CONTROLLERS, Choices, Job, JobError, Make, Setting, Setup, TARGETS};
use feedwright_gcode::{Dialect, Increment, Program, Settings};
use feedwright_sim::{BUILT_IN_MACHINES, Machine, Row, Run, Watch, path_steps};

fn part() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../parts/circle.ngc")
}

fn job(machine: &str, controller: &str) -> Job {
    let mut job = Job::new(Program::in_file(part()), Machine::load(machine.as_ref()).unwrap());
    job.controller = CONTROLLERS.find(controller).unwrap();
    job
}

fn again(job: &Job) -> Job {
    serde_json::from_str(&serde_json::to_string(job).unwrap()).unwrap()
}

#[test]
fn a_job_is_read_back_as_it_was_written_on_every_machine_with_every_controller() {
    for (machine, _) in BUILT_IN_MACHINES {
        for controller in CONTROLLERS {
            let job = job(machine, controller.name);
            assert_eq!(again(&job), job);
        }
    }
}

#[test]
fn everything_that_can_be_asked_for_is_read_back() {
    let setting = Setting::parse("two-dimensional.eta=3.3e-10", None, CONTROLLERS).unwrap();
    let mut full = job("soft", BEST);
    full.feed_mm_s = Some(33.3);
    full.choices = Choices { seed: u64::MAX, set: vec![setting] };
    full.tolerance_um = Some(1.0 / 3.0);
    full.target = Some(&TARGETS[2]);
    full.reference = Some(Program::from_text("original", "G1 X1 F100\nM2\n"));
    full.reader.dialect = Some(Dialect::FanucLathe);
    full.reader.increment = Some(Increment::named("0.0001inch").unwrap());
    assert_eq!(again(&full), full);
}

#[test]
fn what_is_no_job_is_refused_with_the_reason() {
    let mut text = serde_json::to_value(job("tnv40", BEST)).unwrap();
    let refused = |text: &serde_json::Value| serde_json::from_value::<Job>(text.clone()).unwrap_err().to_string();
    text["controller"] = "two".into();
    assert!(refused(&text).contains("no controller is called 'two'"), "{}", refused(&text));
    text["controller"] = BEST.into();
    text["choices"]["set"] = serde_json::json!([{ "controller": "two-dimensional", "name": "knots", "value": 21.0 }]);
    assert!(refused(&text).contains("knots is 1 to 20, whole"), "{}", refused(&text));
    text["choices"]["set"] = serde_json::json!([]);
    text["machine"] = "name = 'none'".into();
    assert!(refused(&text).contains("machine"), "{}", refused(&text));
}

#[test]
fn rows_are_read_back_to_the_bit() {
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    let text = std::fs::read_to_string(part()).unwrap();
    let program = || {
        let reader = feedwright_gcode::Reader::from_text("circle", text.clone(), Settings::default())?;
        Ok(path_steps(reader.map_while(Result::ok)))
    };
    let choices = Choices::default();
    let mut controller = Make::<2>::make(CONTROLLERS.find(BEST).unwrap(), &mut Setup::new(&machine, &choices));
    let mut rows = Vec::<Row>::new();
    Run::on(&machine).cut(program, &mut *controller, &mut [&mut rows]).unwrap();
    assert!(rows.len() > 1000);
    let read: Vec<Row> = serde_json::from_str(&serde_json::to_string(&rows).unwrap()).unwrap();
    assert_eq!(read, rows);
}

/// Cancels the work after a number of progress steps, and records the stages and their steps.
struct Ending {
    after: u64,
    steps: AtomicU64,
    stages: Mutex<Vec<(String, u64, u64)>>,
}

impl Ending {
    fn after(after: u64) -> Self {
        Self { after, steps: AtomicU64::new(0), stages: Mutex::default() }
    }
}

impl Watch for Ending {
    fn begin(&self, stage: &str, steps: u64) {
        self.stages.lock().unwrap().push((stage.to_owned(), steps, 0));
    }

    fn advance(&self, steps: u64) {
        self.steps.fetch_add(steps, Ordering::Relaxed);
        self.stages.lock().unwrap().last_mut().unwrap().2 += steps;
    }

    fn is_cancelled(&self) -> bool {
        self.steps.load(Ordering::Relaxed) >= self.after
    }
}

#[test]
fn a_job_tells_its_stages_and_never_more_than_their_steps() {
    let watch = Ending::after(u64::MAX);
    job("tnv40", "two-dimensional").run(&watch).unwrap();
    let stages = watch.stages.into_inner().unwrap();
    let names: Vec<&str> = stages.iter().map(|(name, ..)| name.as_str()).collect();
    let expected = [
        "reading the program",
        "identifying for uncorrected",
        "cutting, uncorrected",
        "identifying for two-dimensional",
        "cutting, two-dimensional",
    ];
    assert_eq!(names, expected);
    assert!(stages.iter().all(|(_, steps, done)| done <= steps), "{stages:?}");
    let cuts = stages.iter().filter(|(name, ..)| name.starts_with("cutting"));
    assert!(cuts.clone().all(|(_, steps, done)| 10 * done > 9 * steps), "{stages:?}");
}

#[test]
fn a_job_ends_when_it_is_told_to() {
    // In the cut of the first, of the second, and before anything.
    for after in [300, 1300, 0] {
        let ended = job("tnv40", "feedforward").run(&Ending::after(after)).unwrap_err();
        assert!(matches!(ended, JobError::Cancelled(_)), "{after}: {ended}");
    }
}

#[test]
fn a_text_is_cut_as_the_file_is() {
    let of_file = job("tnv40", "feedforward");
    let text = std::fs::read_to_string(part()).unwrap();
    let mut of_text = of_file.clone();
    of_text.program = Program::from_text("circle.ngc", text);
    let json = |job: &Job| {
        let mut json = Vec::new();
        let mut rows = Vec::<Row>::new();
        let outcome = job.check().unwrap().run(&mut [&mut rows], &()).unwrap();
        outcome.write_json(job, &mut json).unwrap();
        assert!(rows.len() > 1000);
        (String::from_utf8(json).unwrap(), rows)
    };
    assert_eq!(json(&of_file), json(&of_text));
}

#[test]
fn jobs_beside_each_other_share_nothing() {
    let jobs: Vec<Job> = ["feedforward", BEST, "uncorrected"].map(|name| job("tnv40", name)).into();
    let summary = |job: &Job| {
        let mut summary = job.run(&()).unwrap().report.runs.pop().unwrap().summary;
        // Times of ticks are the clock's.
        (summary.tick_median_us, summary.tick_p999_us) = (0.0, 0.0);
        serde_json::to_string(&summary).unwrap()
    };
    let alone: Vec<String> = jobs.iter().map(summary).collect();
    let together: Vec<String> = std::thread::scope(|scope| {
        let threads: Vec<_> = jobs.iter().map(|job| scope.spawn(move || summary(job))).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    assert_eq!(alone, together);
}
