//! Predicts the next cut from the logs, and compares it with the cuts that were logged.

use feedwright_plan::Step;
use feedwright_sim::{Axis, Machine, RunError, Squareness};

use super::exported::{ExportedCut, ExportedFigures};
use super::learned::{CutProgram, LearnedLog, LearnedMachine, LearnedOutcome, PredictedCut};
use super::nominal::deterministic;

/// Number of standard deviations of the model's values in the band.
const DEVIATIONS: f64 = 2.0;
/// Fraction by which the error that does not repeat varies from cut to cut in the band, and the
/// fraction for the error that fits and planners leave.
const REST: f64 = 0.3;
const FIT: f64 = 0.25;
/// A corrected program that was already cut is replaced only if the next is predicted to have an
/// RMS error that is smaller by this fraction.
const LEAST_GAIN: f64 = 0.1;

/// A machine without the errors that its encoders do not see.
fn as_encoders_see(machine: &Machine) -> Machine {
    let axis = |axis: &Axis| Axis {
        scale_um_m: 0.0,
        pitch_error_um: 0.0,
        ..*axis
    };
    Machine {
        axes: machine.axes.iter().map(axis).collect(),
        geometry: Squareness::default(),
        compensated: None,
        tool: None,
        ..machine.clone()
    }
}

/// Returns the result of learning, with the predicted next cut if there is a program.
pub(super) fn learned_outcome(
    learned: &LearnedMachine,
    cut: &ExportedCut<'_>,
    program: Option<&[Step]>,
) -> Result<LearnedOutcome, RunError> {
    let predicted = program
        .map(|program| predicted_cut(learned, cut, program))
        .transpose()?;
    Ok(LearnedOutcome {
        predicted,
        ..learned.outcome.clone()
    })
}

/// Predicts the errors of the next cut at the encoders:
///
/// ```text
/// RMS^2 = q^2 + r^2,    q^2 (1 - 0.25)^2 + r^2 (1 - 0.3)^2  to  q^2 (1 + 0.25)^2 + 2^2 v + r^2 (1 + 0.3)^2
/// ```
///
/// where `q` is the RMS error of the simulated cut, `r` the RMS error that does not repeat in the
/// logs, and `v` the mean growth of `q^2` over values of the model that are as likely.
fn predicted_cut(
    learned: &LearnedMachine,
    cut: &ExportedCut<'_>,
    program: &[Step],
) -> Result<PredictedCut, RunError> {
    let seen = as_encoders_see(&learned.machine);
    let ExportedFigures { max_um, .. } = ExportedCut {
        machine: &seen,
        ..*cut
    }
    .figures(program)?;
    let square_um2 = |machine: &Machine| -> Result<f64, RunError> {
        let machine = deterministic(&as_encoders_see(machine));
        Ok(ExportedCut {
            machine: &machine,
            ..*cut
        }
        .once(program, 0.0, &mut [])?
        .rms_um
        .powi(2))
    };
    let best = square_um2(&learned.machine)?;
    let mut more = 0.0;
    for machine in &learned.likely {
        more += (square_um2(machine)? - best) / learned.likely.len() as f64;
    }
    let rest = learned.outcome.rest_um.powi(2);
    let end = |sign: f64| best * (1.0 + sign * FIT).powi(2) + rest * (1.0 + sign * REST).powi(2);
    let wide = DEVIATIONS * DEVIATIONS * more.max(0.0);
    let band_um = [end(-1.0).sqrt(), (end(1.0) + wide).sqrt()];
    let repeats_um = (best * (1.0 + FIT).powi(2) + wide).sqrt();
    Ok(PredictedCut {
        rms_um: (best + rest).sqrt(),
        band_um,
        repeats_um,
        max_um,
    })
}

/// Returns the reason why the next cut is not predicted to be better than the logged cuts.
pub(super) fn no_gain(learned: &LearnedOutcome, uncorrected: &ExportedFigures) -> Option<String> {
    let PredictedCut {
        rms_um, repeats_um, ..
    } = learned.predicted?;
    let of = |program: CutProgram| {
        learned
            .logs
            .iter()
            .filter(move |log| log.program == program)
    };
    let least = |a: &&LearnedLog, b: &&LearnedLog| a.rms_um.total_cmp(&b.rms_um);
    if let Some(best) = of(CutProgram::Corrected).min_by(least)
        && rms_um > (1.0 - LEAST_GAIN) * best.rms_um
    {
        return Some(format!(
            "the corrected program that was cut is as good: RMS {:.2} um in {}, and {rms_um:.2} um are predicted for the next",
            best.rms_um, best.log
        ));
    }
    let original_um = of(CutProgram::Original)
        .min_by(least)
        .map_or(uncorrected.rms_um, |log| log.rms_um);
    // Both errors include the part that does not repeat.
    let original_um = (original_um.powi(2) - learned.rest_um.powi(2))
        .max(0.0)
        .sqrt();
    (repeats_um >= original_um).then(|| {
        format!(
            "the logs do not show whether it is better: of the error that repeats, up to RMS {repeats_um:.2} um may be left, and the original \
             program has {original_um:.2} um"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn learned(logs: &[(CutProgram, f64)], rms_um: f64, repeats_um: f64) -> LearnedOutcome {
        let log = |&(program, rms_um): &(CutProgram, f64)| LearnedLog {
            log: "cut.csv".to_owned(),
            program,
            off_um: 0.0,
            sample_time_s: 1e-3,
            time_s: 1.0,
            planned_s: 1.0,
            rms_um,
            max_um: 3.0 * rms_um,
            model_missed_um: 1.0,
            missed_um: 0.1,
        };
        let predicted = Some(PredictedCut {
            rms_um,
            band_um: [0.0; 2],
            repeats_um,
            max_um: 3.0 * rms_um,
        });
        let logs = logs.iter().map(log).collect();
        LearnedOutcome {
            logs,
            values: Vec::new(),
            repeats_um: 0.0,
            rest_um: 6.0,
            predicted,
        }
    }

    #[test]
    fn a_program_is_written_only_where_what_may_be_left_is_less_and_it_gains() {
        let mut uncorrected = ExportedFigures::default();
        (uncorrected.rms_um, uncorrected.completed) = (9.0, true);
        let why = |logs: &[(CutProgram, f64)], rms_um, repeats_um| {
            no_gain(&learned(logs, rms_um, repeats_um), &uncorrected)
        };
        let (original, corrected) = ((CutProgram::Original, 10.0), (CutProgram::Corrected, 7.0));
        // Of 10 um, 6 um do not repeat, and 8 um do.
        assert_eq!(why(&[original], 6.1, 7.9), None);
        assert!(
            why(&[original], 6.1, 8.1)
                .is_some_and(|why| why.contains("do not show") && why.contains("8.00 um"))
        );
        // Without a log of the original, what is predicted of it counts.
        assert!(why(&[corrected], 6.1, 6.8).is_some_and(|why| why.contains("6.71 um")));
        assert_eq!(why(&[original, corrected], 6.2, 3.0), None);
        assert!(
            why(&[original, corrected], 6.7, 3.0)
                .is_some_and(|why| why.contains("as good: RMS 7.00 um in cut.csv"))
        );
    }
}
