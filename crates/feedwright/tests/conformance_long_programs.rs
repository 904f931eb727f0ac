//! A program that is corrected in pieces is as good and as fast as in one piece, wherever it is
//! cut. The result is the same with any number of threads, and when the run was ended in between.

use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

use feedwright::{CorrectJob, CorrectOutcome, TARGETS};
use feedwright_gcode::Program;
use feedwright_sim::{Machine, Watch};

/// Servo periods of a piece: 4 s of a program that takes 4.4 s between its rests, and 2 s of one
/// without rests.
const PIECE: u64 = 4000;
const SHORT_PIECE: u64 = 2000;

/// Curves with a rapid between them: the machine stands.
fn with_rests(curves: u32) -> String {
    let curve = |k: u32| {
        let (y, r) = (k % 3, 7 + k % 5);
        format!(
            "G0 X0 Y{y}\nG2 X12 Y{y} R{r} F1000\nG3 X24 Y{y} R{r}\nG2 X36 Y{y} R{r}\nG3 X48 Y{y} R{r}\n"
        )
    };
    format!(
        "G21 G90 G64\n{}M2\n",
        (0..curves).map(curve).collect::<String>()
    )
}

/// A wave of lines and arcs that never stops.
fn without_rest(waves: u32) -> String {
    let wave = |k: u32| {
        let x = 20 * k;
        format!(
            "G3 X{} Y0 R6\nG1 X{}\nG2 X{} Y0 R6\nG1 X{}\n",
            x + 5,
            x + 10,
            x + 15,
            x + 20
        )
    };
    format!(
        "G21 G90 G64\nG0 X0 Y0\nF1500\n{}M2\n",
        (0..waves).map(wave).collect::<String>()
    )
}

fn job(text: &str, piece: u64) -> CorrectJob {
    let mut job = CorrectJob::new(
        Program::from_text("part.ngc", text),
        Machine::load("tnv40".as_ref()).unwrap(),
        &TARGETS[0],
    );
    (job.piece_periods, job.threads) = (piece, 1);
    // The machine is exact: whether a gain is certain is another question.
    job.file_error = 0.0;
    job
}

/// Corrects a program in pieces and in one, and compares both: RMS within 1 % and largest error
/// within 2 % of what was to be corrected, time within 1 %.
fn compare(text: &str, piece: u64) {
    let pieces = job(text, piece).run(&()).unwrap();
    let whole = job(text, u64::MAX / 8).run(&()).unwrap();
    assert!(pieces.pieces >= 3 && whole.pieces == 1, "{}", pieces.pieces);
    let (one, other, was) = (&whole.corrected, &pieces.corrected, &whole.uncorrected);
    assert_eq!(&pieces.uncorrected, was);
    assert!(one.rms_um < 0.6 * was.rms_um, "{one:?} {was:?}");
    assert!(
        (one.rms_um - other.rms_um).abs() < 0.01 * was.rms_um,
        "{one:?} {other:?}"
    );
    assert!(
        (one.max_um - other.max_um).abs() < 0.02 * was.max_um,
        "{one:?} {other:?}"
    );
    assert!(
        (one.time_s - other.time_s).abs() < 0.01 * was.time_s,
        "{one:?} {other:?}"
    );
}

#[test]
fn a_program_with_rests_is_corrected_in_pieces_as_in_one() {
    compare(&with_rests(3), PIECE);
}

#[test]
fn a_program_without_rest_is_corrected_in_pieces_as_in_one() {
    compare(&without_rest(6), SHORT_PIECE);
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
    let mut job = job(&with_rests(3), PIECE);
    (job.keep, job.threads) = (Some(path.to_owned()), threads);
    let outcome = job
        .run(&Ending {
            steps: AtomicU64::new(0),
            most,
        })
        .ok();
    let entries = |folder: &Path| std::fs::read_dir(folder).into_iter().flatten().flatten();
    let files = entries(path)
        .flat_map(|folder| entries(&folder.path()))
        .count();
    if outcome.is_some() {
        job.forget_pieces().unwrap();
        assert!(!path.exists());
    }
    (outcome, files)
}

/// Needs 12 s of processor time: corrects a program four times, and three times a part of it.
#[test]
fn a_run_that_was_ended_goes_on_with_the_same_result_on_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("corrected.ngc.pieces");
    let (whole, files) = kept(&path, 1, u64::MAX);
    let whole = whole.unwrap();
    // The pieces, and the cuts of the original and of the corrected program: four for the
    // verdict, five feed overrides.
    assert_eq!(files, whole.pieces + 2 * (4 + 5));
    for (threads, most) in [(1, 1500), (2, 2500), (2, 1000 * whole.pieces as u64 + 450)] {
        let (ended, before) = kept(&path, threads, most);
        assert!(
            ended.is_none() && before > 0 && before < files,
            "{before} files"
        );
        let (again, after) = kept(&path, 3 - threads, u64::MAX);
        let again = again.unwrap();
        assert_eq!(after, files);
        assert_eq!(again.program(), whole.program());
        assert_eq!(
            (again.uncorrected, again.corrected),
            (whole.uncorrected, whole.corrected)
        );
    }
}
