//! Guarantees of a job to its caller: its request can be written down and read back, it reports its
//! progress, ends when it is canceled, needs no file, and shares nothing with another job beside it.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use feedwright::{
    BEST, CONTROLLERS, Choices, GeometryChoice, Guests, Job, JobError, JobRequest, Setting, Setup,
    TARGETS,
};
use feedwright_gcode::{Dialect, Increment, Program, Settings};
use feedwright_sim::{BUILT_IN_MACHINES, Machine, Mechanism, Plant, Row, Run, Watch, path_steps};

fn part() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../parts/circle.ngc")
}

fn job(machine: &str, controller: &str) -> Job {
    let mut job = Job::new(
        Program::in_file(part()),
        Machine::load(machine.as_ref()).unwrap(),
    );
    job.controller = CONTROLLERS.find(controller).unwrap();
    job
}

fn request(machine: &str, controller: &str) -> JobRequest {
    JobRequest {
        program: part(),
        machine: machine.into(),
        controller: controller.to_owned(),
        ..JobRequest::default()
    }
}

fn again(request: &JobRequest) -> JobRequest {
    serde_json::from_str(&serde_json::to_string(request).unwrap()).unwrap()
}

fn made(request: &JobRequest) -> miette::Result<Job> {
    request.job(CONTROLLERS, "2026-01-02", &())
}

#[test]
fn a_request_is_read_back_and_makes_the_job_on_every_machine_with_every_controller() {
    for (machine, _) in BUILT_IN_MACHINES {
        for controller in CONTROLLERS {
            let asked = request(machine, controller.name);
            assert_eq!(again(&asked), asked);
            let found = made(&asked).unwrap();
            assert_eq!(found.machine, Machine::load(machine.as_ref()).unwrap());
            assert_eq!(found.controller.name, controller.name);
            let of_text = JobRequest {
                machine_text: Some(found.machine.text()),
                ..again(&asked)
            };
            assert_eq!(made(&of_text).unwrap().machine, found.machine);
        }
    }
}

#[test]
fn everything_that_can_be_asked_for_is_read_back_and_is_in_the_job() {
    let mut full = request("soft", BEST);
    full.program_text = Some("G1 X1 F100\nM2\n".to_owned());
    full.against = "two-dimensional".to_owned();
    full.settings = vec![
        ("two-dimensional.rho".to_owned(), 0.05.into()),
        ("two-dimensional.eta".to_owned(), "3.3e-10".into()),
    ];
    full.feed_mm_s = Some(33.3);
    full.seed = u64::MAX;
    full.tolerance_um = Some(1.0 / 3.0);
    full.target = Some(TARGETS[2].name.to_owned());
    full.band = 8;
    full.no_geometry = true;
    full.file_error = Some(7.0);
    full.dialect = "fanuc-lathe".to_owned();
    full.increment = Some(Increment::named("0.0001inch").unwrap());
    full.max_motions = Some(7);
    let mut sorted = full.clone();
    sorted.settings.reverse();
    assert_eq!(again(&full), sorted);
    let job = made(&full).unwrap();
    assert_eq!(
        job.program,
        Program::from_text(part().display().to_string(), "G1 X1 F100\nM2\n")
    );
    let set = ["two-dimensional.rho=0.05", "two-dimensional.eta=3.3e-10"];
    let set = set.map(|text| Setting::parse(text, None, CONTROLLERS).unwrap());
    assert_eq!(
        (&job.choices.set[..2], job.choices.seed),
        (&set[..], u64::MAX)
    );
    assert_eq!(
        (job.request.feed_mm_s, job.request.tolerance_um),
        (Some(33.3), Some(1.0 / 3.0))
    );
    assert_eq!(job.target.map(|target| target.name), Some(TARGETS[2].name));
    assert_eq!(job.compensation, GeometryChoice::Off);
    assert_eq!(full.correct_job(&()).unwrap().file_error, 0.07);
    assert_eq!(job.reader.dialect, Some(Dialect::FanucLathe));
    assert_eq!(
        (job.reader.increment, job.reader.max_motions),
        (full.increment, 7)
    );
    let kept = JobRequest {
        program_text: None,
        ..full
    };
    assert_eq!(job.request, kept);
}

#[test]
fn what_is_no_request_is_refused_with_the_reason() {
    let unread = |text: &str| {
        serde_json::from_str::<JobRequest>(text)
            .unwrap_err()
            .to_string()
    };
    assert!(unread(r#"{ "controler": "none" }"#).contains("unknown field `controler`"));
    assert!(unread(r#"{ "settings": 3 }"#).contains("a map"));
    let refused = |change: &dyn Fn(&mut JobRequest)| {
        let mut asked = request("tnv40", BEST);
        change(&mut asked);
        made(&asked).unwrap_err().to_string()
    };
    let said = refused(&|asked| asked.controller = "two".to_owned());
    assert!(said.contains("no controller is called 'two'"), "{said}");
    let said = refused(&|asked| {
        asked.against = "two-dimensional".to_owned();
        asked.settings = vec![("two-dimensional.knots".to_owned(), 21.into())];
    });
    assert!(said.contains("knots is 1 to 20, whole"), "{said}");
    let said = refused(&|asked| asked.machine_text = Some("name = 'none'".to_owned()));
    assert!(said.contains("machine"), "{said}");
    let said = refused(&|asked| asked.target = Some("none".to_owned()));
    assert!(said.contains("no control is called 'none'"), "{said}");
    let said = refused(&|asked| asked.logs = vec!["a.csv".into(), "b.csv".into()]);
    assert!(said.contains("a.csv"), "{said}");
}

#[test]
fn rows_are_read_back_to_the_bit() {
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    let text = std::fs::read_to_string(part()).unwrap();
    let program = || {
        let reader =
            feedwright_gcode::Reader::from_text("circle", text.clone(), Settings::default())?;
        Ok(path_steps(reader.map_while(Result::ok)))
    };
    let choices = Choices::default();
    let mut controller = CONTROLLERS
        .find(BEST)
        .unwrap()
        .in_plane(&mut Setup::new(&machine, &choices));
    let mut rows = Vec::<Row>::new();
    Run::on(&machine)
        .cut(program, &mut *controller, &mut [&mut rows])
        .unwrap();
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
        Self {
            after,
            steps: AtomicU64::new(0),
            stages: Mutex::default(),
        }
    }
}

impl Watch for Ending {
    fn begin(&self, stage: &str, steps: u64) {
        self.stages
            .lock()
            .unwrap()
            .push((stage.to_owned(), steps, 0));
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
fn a_job_reports_its_stages_and_never_more_than_their_steps() {
    let watch = Ending::after(u64::MAX);
    job("tnv40", "two-dimensional").run(&watch).unwrap();
    let stages = watch.stages.into_inner().unwrap();
    let names: Vec<&str> = stages.iter().map(|(name, ..)| name.as_str()).collect();
    let expected = [
        "reading the program",
        "cutting, uncorrected",
        "identifying tnv40",
        "cutting, two-dimensional",
    ];
    assert_eq!(names, expected);
    assert!(
        stages.iter().all(|(_, steps, done)| done <= steps),
        "{stages:?}"
    );
    let cuts = stages
        .iter()
        .filter(|(name, ..)| name.starts_with("cutting"));
    assert!(
        cuts.clone().all(|(_, steps, done)| 10 * done > 9 * steps),
        "{stages:?}"
    );
}

#[test]
fn a_job_ends_when_it_is_canceled() {
    // In the cut of the first, of the second, and before anything.
    for after in [300, 1300, 0] {
        let ended = job("tnv40", "feedforward")
            .run(&Ending::after(after))
            .unwrap_err();
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
fn guests_take_the_place_of_the_controller_that_is_asked_for_and_of_the_plant_of_every_cut() {
    let rows = |job: &Job, guests: Guests<'_>| {
        let mut rows = Vec::<Row>::new();
        let outcome = job
            .check()
            .unwrap()
            .run_with(guests, &mut [&mut rows], &())
            .unwrap();
        let runs: Vec<_> = outcome
            .report
            .runs
            .iter()
            .map(|run| (run.summary.controller.clone(), run.summary.rms_um))
            .collect();
        (rows, runs)
    };
    let (asked, feedforward) = (job("tnv40", BEST), job("tnv40", "feedforward"));
    let (theirs, of_theirs) = rows(&feedforward, Guests::default());
    let guests = Guests {
        controller: Some(feedforward.controller),
        ..Guests::default()
    };
    let (ours, of_ours) = rows(&asked, guests);
    assert!(ours == theirs && of_ours[0] == of_theirs[0]);
    assert_eq!((&*of_ours[1].0, of_ours[1].1), (BEST, of_theirs[1].1));
    let cut_on = |machine: &Machine| {
        let plant = |start_mm: [f64; 3], seed: u64| -> Box<dyn Mechanism> {
            Box::new(Plant::<2>::with_seed(
                machine,
                [start_mm[0], start_mm[1]],
                seed,
            ))
        };
        rows(
            &feedforward,
            Guests {
                plant: Some(&plant),
                ..Guests::default()
            },
        )
    };
    assert_eq!(cut_on(&feedforward.machine), (theirs, of_theirs.clone()));
    let (_, of_heavy) = cut_on(&Machine::load("heavy".as_ref()).unwrap());
    assert!(
        (0..2).all(|run| of_heavy[run].1 != of_theirs[run].1),
        "{of_heavy:?}"
    );
    let (slow, of_slow) = rows(
        &feedforward,
        Guests {
            feeds_mm_s: Some(&[10.0]),
            ..Guests::default()
        },
    );
    assert!(
        slow.iter()
            .filter(|row| row.cutting)
            .all(|row| row.feed_plan_mm_s <= 10.0 * (1.0 + 1e-9))
    );
    assert_eq!(
        of_slow[0], of_theirs[0],
        "the cut beside it is as programmed"
    );
}

#[test]
fn jobs_beside_each_other_share_nothing() {
    let jobs: Vec<Job> = ["feedforward", BEST, "uncorrected"]
        .map(|name| job("tnv40", name))
        .into();
    let summary = |job: &Job| {
        let mut summary = job.run(&()).unwrap().report.runs.pop().unwrap().summary;
        // Times of ticks are the clock's.
        (summary.tick_median_us, summary.tick_p999_us) = (0.0, 0.0);
        serde_json::to_string(&summary).unwrap()
    };
    let alone: Vec<String> = jobs.iter().map(summary).collect();
    let together: Vec<String> = std::thread::scope(|scope| {
        let threads: Vec<_> = jobs
            .iter()
            .map(|job| scope.spawn(move || summary(job)))
            .collect();
        threads
            .into_iter()
            .map(|thread| thread.join().unwrap())
            .collect()
    });
    assert_eq!(alone, together);
}

#[test]
fn the_band_of_the_machine_itself_is_its_cut_and_a_machine_that_differs_widens_it() {
    let mut job = job("tnv40", "feedforward");
    let mut heavy = job.machine.clone();
    heavy
        .axes
        .iter_mut()
        .for_each(|axis| axis.inertia_kg_m2 *= 1.5);
    // Nothing is random on tnv40, and a recording knows no lead.
    let mut other_lead = job.machine.clone();
    for axis in &mut other_lead.axes {
        axis.lead_mm_per_rev /= 2.0;
        axis.coulomb_smoothing_rad_s *= 2.0;
        for nm in [&mut axis.coulomb_friction_nm, &mut axis.torque_limit_nm] {
            *nm *= 2.0;
        }
        axis.disturbance_nm = 0.0;
    }
    job.machine
        .axes
        .iter_mut()
        .for_each(|axis| axis.disturbance_nm = 0.0);
    let without = job.run(&()).unwrap();
    assert_eq!(without.report.band, None);
    let errors = |run: &feedwright::ReportedRun| [run.summary.rms_um, run.summary.max_um];
    let own = errors(without.report.runs.last().unwrap());
    job.fitting = vec![job.machine.clone(); 2];
    let watch = Ending::after(u64::MAX);
    let outcome = job.run(&watch).unwrap();
    let band = outcome.report.band.unwrap();
    assert_eq!(
        [band.rms_um.median, band.max_um.median].map(f64::to_bits),
        own.map(f64::to_bits)
    );
    assert_eq!(
        (
            band.machines,
            band.diverged,
            band.first_s,
            band.joint_rms_um
        ),
        (2, 0, None, None)
    );
    let stages = watch.stages.into_inner().unwrap();
    assert_eq!(
        stages.last().unwrap(),
        &(
            "cutting on machines that fit the recording".to_owned(),
            2,
            2
        )
    );
    job.fitting = vec![other_lead];
    let band = job.run(&()).unwrap().report.band.unwrap();
    assert!(
        (band.rms_um.median / own[0] - 1.0).abs() < 1e-9,
        "{band:?} {own:?}"
    );
    job.fitting = vec![job.machine.clone(), heavy];
    let band = job.run(&()).unwrap().report.band.unwrap();
    assert!(
        band.rms_um.p90 > 2.0 * own[0] && band.rms_um.median < band.rms_um.p90,
        "{band:?} {own:?}"
    );
}

#[test]
fn of_a_long_cut_the_band_has_the_beginning() {
    let mut job = job("tnv40", "feedforward");
    // The circle after the line is fast: its errors are not in the band.
    job.program = Program::from_text("long.ngc", "G1 X31 F60\nG2 X31 Y0 I2 J0 F3000\nM2\n");
    job.fitting = vec![job.machine.clone()];
    let report = job.run(&()).unwrap().report;
    let (band, whole) = (report.band.unwrap(), &report.runs.last().unwrap().summary);
    assert!(
        whole.time_s > 31.0 && band.first_s == Some(30.0),
        "{} {band:?}",
        whole.time_s
    );
    assert!(
        band.machines == 1 && band.max_um.median < 0.5 * whole.max_um,
        "{band:?} {}",
        whole.max_um
    );
}

#[test]
fn a_machine_whose_loop_is_unstable_is_counted_and_left_out_of_the_band() {
    let mut job = job("tnv40", "feedforward");
    let mut unstable = job.machine.clone();
    unstable
        .axes
        .iter_mut()
        .for_each(|axis| (axis.kp_1_s, axis.torque_limit_nm) = (1e5, 1e6));
    job.fitting = vec![unstable, job.machine.clone()];
    let band = job.run(&()).unwrap().report.band.unwrap();
    assert_eq!((band.machines, band.diverged), (1, 1));
    assert!(
        band.sentence()
            .contains("1 more fit the recording, and their servo loops are unstable")
    );
}
