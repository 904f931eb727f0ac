//! The law of one axis, from its record to its scores.

use super::NotFound;
use super::admission::admit;
use super::axis_record::AxisRecord;
use super::found_axis::{AxisFacts, FoundAxis, ResolvedLaw};
use super::free_run_scores::score;
use super::output_error::OutputErrors;
use super::sample_split::SampleSplit;
use super::standard_errors::StandardErrors;
use super::terms::{LawTerm, TermValues};
use super::torque_column::{DriveColumn, TorqueColumn};

/// Samples that terms are admitted with: windows of the record where it has more.
const ADMISSION_SAMPLES: usize = 12_000;
const WINDOW_SAMPLES: usize = 3000;
/// Beginning of a window that does not count, s.
const SETTLING_S: f64 = 0.2;
/// Steps of the last fit.
const STEPS: usize = 25;
/// A law that leaves more than this part of the following error is none.
const NO_LAW: f64 = 0.9;
/// Friction from a torque column holds where the fit is worse by no more than this.
const HOLDS: f64 = 1.15;
/// Parts of the work: admission, and the last fit.
const PARTS: [f64; 2] = [0.6, 0.85];

/// Finds the law of an axis, and scores it.
pub(super) fn find(
    record: &AxisRecord<'_>,
    torque: Option<&[f64]>,
    split: &SampleSplit,
    facts: AxisFacts,
    tell: &mut dyn FnMut(f64) -> bool,
) -> Result<FoundAxis, NotFound> {
    let (train, valid, moving_s) = split.inner(record);
    if moving_s == 0.0 {
        return Err(NotFound::AtRest { axis: record.name.to_owned() });
    }
    let windows = windows(record, &split.fit);
    let thinned = AxisRecord { stretches: &windows, ..*record };
    let [train, valid] =
        [train, valid].map(|counts| behind_starts(&thinned, &counts, windows.len() != record.stretches.len()));
    let admitted = admit(&thinned, [&train, &valid], moving_s, |part| tell(PARTS[0] * part)).ok_or(NotFound::Ended)?;
    let errors = OutputErrors { record, counts: &split.fit };
    let fitted = errors.least(&admitted.values, &admitted.terms, STEPS);
    go_on(tell(PARTS[1]))?;
    let following_mm = record.following_mm(&split.fit);
    if fitted.rms_mm.is_nan() || fitted.rms_mm > NO_LAW * following_mm {
        return Err(NotFound::NoLaw {
            axis: record.name.to_owned(),
            left_um: 1e3 * fitted.rms_mm,
            following_um: 1e3 * following_mm,
        });
    }
    // What came to nothing is not there.
    let mut terms = admitted.terms;
    terms.retain(|term| *term <= LawTerm::RecordDelay || fitted.values.get(*term) > 0.0);
    let mut values = fitted.values;
    if let (Some(viscous), Some(inertia)) = (facts.viscous, facts.inertia)
        && !terms.contains(&LawTerm::Viscous)
    {
        values = values.with(LawTerm::Viscous, viscous / inertia);
    }
    let certain = StandardErrors::of(&errors, &values, &terms);
    let half_intervals = certain.errors.iter().map(|error| certain.factor * error).collect();
    let resolved = torque.and_then(|torque| resolve(&errors, torque, &values, &terms, &facts, fitted.rms_mm));
    go_on(tell(0.5 * (PARTS[1] + 1.0)))?;
    let scores = score(record, &values, &split.fit, &split.score);
    go_on(tell(1.0))?;
    Ok(FoundAxis {
        name: record.name.to_owned(),
        values,
        terms,
        half_intervals,
        resolved,
        facts,
        fit_um: 1e3 * fitted.rms_mm,
        scores,
        noise_um: noise_um(record),
        step_um: 1e3 * record.step_mm,
        most: FoundAxis::most(record),
    })
}

fn go_on(wanted: bool) -> Result<(), NotFound> {
    if wanted { Ok(()) } else { Err(NotFound::Ended) }
}

/// Friction by the torque column, and the law with it.
fn resolve(
    errors: &OutputErrors<'_>,
    torque: &[f64],
    values: &TermValues,
    terms: &[LawTerm],
    facts: &AxisFacts,
    rms_mm: f64,
) -> Option<ResolvedLaw> {
    let record = errors.record;
    let mut found = TorqueColumn::find(record, torque, values, errors.counts)?;
    if let (Some(viscous), Some(gain)) = (facts.viscous, facts.torque_gain) {
        // A friction that is given goes before one that is found: B / J with J of the column.
        let per = if facts.lead_mm_per_rev.is_some() { record_per_rad(facts) } else { 1e-3 };
        (found.viscous_1_s, found.viscous_error_1_s) = (viscous / (found.units_per_mm_s2 * gain / per).abs(), 0.0);
    }
    if found.coulomb_mm_s2 < 0.0 || found.viscous_1_s < -2.0 * found.viscous_error_1_s {
        return None;
    }
    let has_integral = terms.contains(&LawTerm::Integral);
    let drive = if has_integral { None } else { DriveColumn::find(record, torque, &found, errors.counts) };
    let mut start = values
        .with(LawTerm::Viscous, found.viscous_1_s.max(0.0))
        .with(LawTerm::Coulomb, found.coulomb_mm_s2)
        .with(LawTerm::Offset, found.offset_mm_s2);
    let mut fixed = vec![LawTerm::Viscous, LawTerm::Coulomb, LawTerm::Offset, LawTerm::LoopDelay];
    if let Some(drive) = &drive {
        start = start
            .with(LawTerm::LoopGain, drive.loop_gain_1_s2)
            .with(LawTerm::Damping, drive.speed_gain_1_s + found.viscous_1_s.max(0.0));
        fixed.extend([LawTerm::LoopGain, LawTerm::Damping]);
    }
    let mut free: Vec<LawTerm> = terms.iter().copied().filter(|term| !fixed.contains(term)).collect();
    free.push(LawTerm::SpeedWindow);
    let start = start.with(LawTerm::LoopDelay, 0.0).with(LawTerm::SpeedWindow, 2.0 * record.sample_s);
    let fitted = errors.least(&start, &free, STEPS);
    if fitted.rms_mm.is_nan() || fitted.rms_mm > HOLDS * rms_mm {
        return None;
    }
    let certain = StandardErrors::of(errors, &fitted.values, &free);
    let mut half_intervals: Vec<(LawTerm, f64)> =
        free.iter().copied().zip(certain.errors.iter().map(|error| certain.factor * error)).collect();
    let half = |error: f64| 1.645 * error;
    let scale = half(found.units_error / found.units_per_mm_s2.abs());
    half_intervals.extend([
        (LawTerm::Viscous, half(found.viscous_error_1_s)),
        (LawTerm::Coulomb, half(found.coulomb_error_mm_s2)),
    ]);
    if let Some(drive) = &drive {
        let damping = (scale * drive.speed_gain_1_s).hypot(half(found.viscous_error_1_s));
        half_intervals.extend([(LawTerm::LoopGain, scale * drive.loop_gain_1_s2), (LawTerm::Damping, damping)]);
    }
    Some(ResolvedLaw { values: fitted.values, half_intervals, torque: found, drive, fit_um: 1e3 * fitted.rms_mm })
}

/// Turn of the motor for a travel, rad/mm; of a linear axis one.
fn record_per_rad(facts: &AxisFacts) -> f64 {
    facts.lead_mm_per_rev.map_or(1.0, |lead| std::f64::consts::TAU / lead)
}

/// Windows of a record, evenly over what is fitted of it, where it is longer than the admission of terms needs.
fn windows(record: &AxisRecord<'_>, fit: &[bool]) -> Vec<std::ops::Range<usize>> {
    if fit.iter().filter(|fit| **fit).count() <= ADMISSION_SAMPLES {
        return record.stretches.to_vec();
    }
    let mut all = vec![];
    for stretch in record.stretches {
        let mut from = stretch.start;
        while from < stretch.end {
            let to = (from + WINDOW_SAMPLES).min(stretch.end);
            // Half of it has to be fitted.
            if 2 * (from..to).filter(|&k| fit[k]).count() > WINDOW_SAMPLES {
                all.push(from..to);
            }
            from = to;
        }
    }
    let apart = all.len().div_ceil(ADMISSION_SAMPLES / WINDOW_SAMPLES).max(1);
    all.into_iter().step_by(apart).collect()
}

/// Without the beginnings of windows, and without what is in none.
fn behind_starts(record: &AxisRecord<'_>, counts: &[bool], is_thinned: bool) -> Vec<bool> {
    if !is_thinned {
        return counts.to_vec();
    }
    let beginning = (SETTLING_S / record.sample_s).ceil() as usize;
    let mut behind = vec![false; counts.len()];
    for window in record.stretches {
        let from = (window.start + beginning).min(window.end);
        behind[from..window.end].copy_from_slice(&counts[from..window.end]);
    }
    behind
}

/// RMS of the encoder's noise beside its steps, um: by third differences, in which a motion hardly shows, and their median.
fn noise_um(record: &AxisRecord<'_>) -> f64 {
    let mut differences: Vec<f64> = record
        .stretches
        .iter()
        .flat_map(|stretch| record.actual_mm[stretch.clone()].windows(4))
        .map(|y| (y[3] - 3.0 * y[2] + 3.0 * y[1] - y[0]).abs())
        .collect();
    if differences.is_empty() {
        return 0.0;
    }
    let middle = differences.len() / 2;
    let median = *differences.select_nth_unstable_by(middle, f64::total_cmp).1;
    // A normal distribution has its median at 0.6745 deviations; the weights 1, 3, 3, 1 have a sum of squares of 20.
    let of_all = median / 0.6745 / 20.0_f64.sqrt();
    1e3 * (of_all * of_all - record.step_mm * record.step_mm / 12.0).max(0.0).sqrt()
}
