//! A program that is corrected in pieces is corrected as it is in one: wherever it is cut, with any
//! number of threads, and when the run was ended in between.

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use feedwright::{CorrectJob, CorrectOutcome, TARGETS, TargetControl};
use feedwright_gcode::Program;
use feedwright_sim::{Machine, Watch};

/// Servo periods of a piece: 2 s.
const PIECE: u64 = 2000;

/// Arcs with a rapid between them: the machine stands.
fn with_rests() -> String {
    let arc = |k: u32| format!("G0 X0 Y{y}\nG2 X12 Y{y} R{r} F2400\nG3 X24 Y{y} R{r}\n", y = k % 3, r = 7 + k % 5);
    format!("G21 G90 G64\n{}M2\n", (0..10).map(arc).collect::<String>())
}

/// A wave of lines and arcs that never stops.
fn without_rest() -> String {
    let wave = |k: u32| {
        let x = 20 * k;
        format!("G3 X{} Y0 R6\nG1 X{}\nG2 X{} Y0 R6\nG1 X{}\n", x + 5, x + 10, x + 15, x + 20)
    };
    format!("G21 G90 G64\nG0 X0 Y0\nF1500\n{}M2\n", (0..12).map(wave).collect::<String>())
}

fn job(text: &str, target: &'static TargetControl) -> CorrectJob {
    let mut job =
        CorrectJob::new(Program::from_text("part.ngc", text), Machine::load("tnv40".as_ref()).unwrap(), target);
    (job.piece_periods, job.threads) = (PIECE, 1);
    job
}

fn in_pieces(text: &str) -> CorrectOutcome {
    job(text, &TARGETS[0]).run(&()).unwrap()
}

fn in_one(text: &str) -> CorrectOutcome {
    let mut job = job(text, &TARGETS[0]);
    job.piece_periods = u64::MAX / 8;
    job.run(&()).unwrap()
}

#[test]
fn a_program_with_rests_is_corrected_in_pieces_as_in_one() {
    let (pieces, whole) = (in_pieces(&with_rests()), in_one(&with_rests()));
    println!("{pieces:?}\n{whole:?}");
    println!("{}\n-----\n{}", pieces.program().unwrap(), whole.program().unwrap());
    assert!(pieces.pieces > 3 && whole.pieces == 1, "{}", pieces.pieces);
    assert_eq!(pieces.program(), whole.program());
}

#[test]
fn a_program_without_rest_is_corrected_in_pieces_as_in_one() {
    let (pieces, whole) = (in_pieces(&without_rest()), in_one(&without_rest()));
    println!("{pieces:?}\n{whole:?}");
    println!("{}\n-----\n{}", pieces.program().unwrap(), whole.program().unwrap());
    assert!(pieces.pieces > 3 && whole.pieces == 1, "{}", pieces.pieces);
    assert!((pieces.corrected.rms_um - whole.corrected.rms_um).abs() < 0.02 * whole.uncorrected.rms_um);
    assert!((pieces.corrected.max_um - whole.corrected.max_um).abs() < 0.1 * whole.uncorrected.max_um);
}

/// Ends the work after some progress.
struct Ending {
    steps: AtomicU64,
    most: u64,
}

impl Watch for Ending {
    fn advance(&self, steps: u64) {
        self.steps.fetch_add(steps, Ordering::Relaxed);
    }

    fn is_cancelled(&self) -> bool {
        self.steps.load(Ordering::Relaxed) >= self.most
    }
}

/// A run that keeps its pieces, up to an end from outside; its outcome, and the progress in which
/// work was done.
fn kept(path: &Path, threads: usize, most: u64) -> (Option<CorrectOutcome>, usize) {
    let mut job = job(&with_rests(), &TARGETS[0]);
    (job.keep, job.threads) = (Some(path.to_owned()), threads);
    let outcome = job.run(&Ending { steps: AtomicU64::new(0), most }).ok();
    let lines = std::fs::read_to_string(path).map_or(0, |text| text.lines().count());
    if outcome.is_some() {
        job.forget_pieces().unwrap();
        assert!(!path.exists());
    }
    (outcome, lines)
}

#[test]
fn a_run_that_was_ended_goes_on_with_the_same_result_on_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("corrected.ngc.pieces");
    let (whole, lines) = kept(&path, 1, u64::MAX);
    let whole = whole.unwrap();
    // A head, the pieces, and the four cuts of the original and of the corrected program.
    assert_eq!(lines, 1 + whole.pieces + 8);
    for (threads, most) in [(1, 1500), (2, 2500), (2, 1000 * whole.pieces as u64 + 450)] {
        let (ended, before) = kept(&path, threads, most);
        assert!(ended.is_none() && before > 1 && before < lines, "{before} lines");
        let (again, after) = kept(&path, 3 - threads, u64::MAX);
        let again = again.unwrap();
        assert_eq!(after, lines);
        assert_eq!(again.program(), whole.program());
        assert_eq!((again.uncorrected, again.corrected), (whole.uncorrected, whole.corrected));
    }
}
