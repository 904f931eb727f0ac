//! The model of one axis, from its record to its scores.

use super::NotFound;
use super::admission::{OPTIONAL, admit, admit_more, is_screw_or_none};
use super::axis_facts::AxisFacts;
use super::axis_record::AxisRecord;
use super::axis_run::periods;
use super::found_axis::{FoundAxis, ResolvedModel};
use super::free_run_scores::{AxisScores, score};
use super::gain_changes::GainChange;
use super::output_error::{DONE, NEARLY_DONE, OutputErrors, square};
use super::place_waves::PlaceWaves;
use super::priors::Prior;
use super::residual_noise::ResidualNoise;
use super::sample_split::SampleSplit;
use super::search_bound::SearchBound;
use super::standard_errors::{HALF_INTERVAL, StandardErrors};
use super::terms::{ModelTerm, TermValues};
use super::torque_column::{DriveColumn, TorqueColumn};
use super::unseen_motion::UnseenMotion;
use crate::average::middle_of;

/// Samples that terms are admitted with: windows of the record where it has more.
const ADMISSION_SAMPLES: usize = 12_000;
const WINDOW_SAMPLES: usize = 1000;
/// Beginning of a window that does not count, s.
const SETTLING_S: f64 = 0.2;
/// Steps of the last fit.
const STEPS: usize = 40;
/// Largest residual of a model, as a part of the following error. With more, no model was found.
const NO_MODEL: f64 = 0.9;
/// Friction from a torque column holds where the fit is worse by no more than this.
const HOLDS: f64 = 1.15;
/// Parts of the work: admission, and the last fit.
const PARTS: [f64; 2] = [0.6, 0.85];

/// Finds the model of an axis, and scores it.
pub(super) fn find(
    record: &AxisRecord<'_>,
    torque: Option<&[f64]>,
    split: &SampleSplit,
    facts: AxisFacts,
    progress: &mut dyn FnMut(f64) -> bool,
) -> Result<FoundAxis, NotFound> {
    let (train, valid, moving_s) = split.inner(record);
    if moving_s == 0.0 {
        return Err(NotFound::AtRest {
            axis: record.name.to_owned(),
        });
    }
    let windows = windows(record, &split.fit);
    let thinned = AxisRecord {
        stretches: &windows,
        ..*record
    };
    let [train, valid] = [train, valid]
        .map(|counts| behind_starts(&thinned, &counts, windows.len() != record.stretches.len()));
    let priors = Prior::all(&facts);
    let admitted = admit(&thinned, [&train, &valid], &facts, &priors, |part| {
        progress(PARTS[0] * part)
    })
    .ok_or(NotFound::Ended)?;
    let deviation_mm = record.following_mm(&split.fit);
    let errors = OutputErrors {
        record,
        counts: &split.fit,
        deviation_mm,
        priors: &priors,
    };
    let admitted = admit_more(&errors, &facts, admitted);
    let errors = errors.scaled_by(&admitted.values);
    let Doubtless {
        terms,
        values,
        early,
    } = without_doubtful(&errors, &facts, &admitted.values, admitted.terms);
    let errors = errors.weighed_by(&values);
    let values = errors.least(&values, &terms, STEPS, DONE).values;
    let certain = StandardErrors::of(&errors, &values, &terms);
    let rms_mm = errors.rms_mm(&values);
    go_on(progress(PARTS[1]))?;
    is_model(record, &split.fit, rms_mm)?;
    let half_intervals = certain
        .errors
        .iter()
        .map(|error| certain.factor * error)
        .collect();
    let resolved = match facts.speed_window_s {
        Some(window_s) => with_window(&errors, window_s, &values, &terms, rms_mm),
        None => torque.and_then(|torque| resolve(&errors, torque, &values, &terms, &facts, rms_mm)),
    };
    go_on(progress(0.5 * (PARTS[1] + 1.0)))?;
    let at_bounds = early
        .into_iter()
        .chain(at_bounds(
            &errors,
            &values,
            &terms,
            &facts,
            resolved.as_ref(),
        ))
        .collect();
    let scores = score(record, &values, &split.fit, &split.score);
    let (noise_um, most) = (noise_um(record), record.most());
    let found = FoundAxis {
        name: record.name.to_owned(),
        at_bounds,
        half_intervals,
        uncertain: certain.root(),
        resolved,
        facts,
        fit_um: 1e3 * rms_mm,
        unseen: UnseenMotion::of(&errors, &values, &terms, rms_mm, most),
        waves: PlaceWaves::default(),
        residual: residual(record, &values, &scores, noise_um),
        gain_changes: GainChange::find(record, &values, &split.score),
        scores,
        noise_um,
        step_um: 1e3 * record.step_mm,
        most,
        values,
        terms,
    };
    go_on(progress(1.0))?;
    Ok(found)
}

/// Returns the values that end where their search ends, of the model from positions and of the one
/// with the window of the speed. Where the record is said to be on time, the delay of the loop may
/// be below zero in its place.
fn at_bounds(
    errors: &OutputErrors<'_>,
    values: &TermValues,
    terms: &[ModelTerm],
    facts: &AxisFacts,
    resolved: Option<&ResolvedModel>,
) -> Vec<SearchBound> {
    let late = (facts.record_delay_s.is_some() && !terms.contains(&ModelTerm::LoopDelay))
        .then_some(ModelTerm::LoopDelay);
    let tested: Vec<ModelTerm> = terms.iter().copied().chain(late).collect();
    let mut bounds = SearchBound::of_fitted(values, terms.iter().copied());
    bounds.extend(SearchBound::below_zero(errors, values, &tested));
    if let Some(axis_model) = resolved {
        bounds.extend(SearchBound::of_fitted(
            &axis_model.values,
            axis_model.half_intervals.iter().map(|(term, _)| *term),
        ));
    }
    bounds
}

/// Terms that stay, and a fit of them.
struct Doubtless {
    terms: Vec<ModelTerm>,
    values: TermValues,
    /// Delay of the record, where it was dropped although the record wants it below zero.
    early: Option<SearchBound>,
}

/// Terms that stay, and a fit of them. Dropped one after the other are terms that do not differ
/// from zero by their standard error, and terms of the drive, where their gain in likelihood is
/// below their cost (Schwarz 1978).
fn without_doubtful(
    errors: &OutputErrors<'_>,
    facts: &AxisFacts,
    start: &TermValues,
    mut terms: Vec<ModelTerm>,
) -> Doubtless {
    let mut at = *start;
    let mut early = None;
    loop {
        at = errors.least(&at, &terms, STEPS, NEARLY_DONE).values;
        let certain = StandardErrors::of(errors, &at, &terms);
        let size = |i: usize| at.get(terms[i]) / certain.errors[i].max(f64::MIN_POSITIVE);
        let stands_for_another = |&i: &usize| match terms[i] {
            // No actual position comes before its command.
            ModelTerm::RecordDelay => at.get(ModelTerm::RecordDelay) < 0.0,
            ModelTerm::Resonance => !is_screw_or_none(&at, errors.record.sample_s),
            _ => false,
        };
        // The acceleration feedforward is dropped before the velocity feedforward.
        let is_last = |i: usize| {
            terms[i] != ModelTerm::VelocityFeedforward
                || !terms.contains(&ModelTerm::AccelerationFeedforward)
        };
        let is_open = |i: usize| facts.known(terms[i]).is_none() && is_last(i);
        let is_shape =
            |i: usize| matches!(terms[i], ModelTerm::StribeckSpeed | ModelTerm::TableShare);
        let mut doubtful: Vec<usize> = (0..terms.len())
            .filter(|&i| {
                terms[i] > ModelTerm::RecordDelay
                    && is_open(i)
                    && !is_shape(i)
                    && size(i) < DOUBTFUL
            })
            .collect();
        doubtful.sort_by(|&a, &b| size(a).total_cmp(&size(b)));
        let independent = errors.weighed_by(&at);
        let is_needless = |&i: &usize| is_needless(&independent, &at, &terms, i);
        let cost = || libm::log(errors.residuals(&at).len() as f64);
        let is_sure = |i: usize| size(i).powi(2) > SURE * cost();
        let of_drive = |&i: &usize| OPTIONAL.contains(&terms[i]) && is_open(i) && !is_sure(i);
        let dropped = (0..terms.len())
            .find(stands_for_another)
            .or_else(|| doubtful.into_iter().find(is_needless))
            .or_else(|| {
                (0..terms.len())
                    .filter(of_drive)
                    .find(|&i| self::is_needless(errors, &at, &terms, i))
            });
        let Some(i) = dropped else {
            return Doubtless {
                terms,
                values: at,
                early,
            };
        };
        let term = terms[i];
        if term == ModelTerm::RecordDelay
            && at.get(term) + DOUBTFUL * certain.errors[i] < -EARLY * errors.record.sample_s
        {
            let is_determined = !self::is_needless(&independent, &at, &terms, i);
            early = is_determined.then_some(SearchBound {
                term,
                value: at.get(term),
                bound: 0.0,
            });
        }
        at = at.with(term, 0.0);
        terms.retain(|other| {
            *other != term
                && (term != ModelTerm::Stribeck || *other != ModelTerm::StribeckSpeed)
                && (term != ModelTerm::Resonance
                    || !matches!(other, ModelTerm::TableShare | ModelTerm::Backlash))
        });
    }
}

/// Returns true if a fit without a term loses less likelihood than the term costs.
fn is_needless(errors: &OutputErrors<'_>, at: &TermValues, terms: &[ModelTerm], i: usize) -> bool {
    let of_all = square(&errors.residuals(at));
    let others: Vec<ModelTerm> = terms
        .iter()
        .copied()
        .filter(|term| *term != terms[i])
        .collect();
    let without = errors
        .least(&at.with(terms[i], 0.0), &others, WITHOUT_STEPS, NEARLY_DONE)
        .values;
    // In units of what is left the square is the number of samples that are independent.
    square(&errors.residuals(&without)) - of_all < libm::log(of_all.max(1.0))
}

/// Steps of a fit without a term.
const WITHOUT_STEPS: usize = 8;
/// Times its cost that a term gains by its standard error which is not tried without.
const SURE: f64 = 10.0;
/// Samples by which actual positions come before their commands in a record whose columns are a
/// sample apart, or more.
const EARLY: f64 = 0.5;
/// Standard errors below which a term is as well zero: the two-sided test at one in twenty.
const DOUBTFUL: f64 = 1.96;

/// Fails if the residual of a fit is too large for a model.
fn is_model(record: &AxisRecord<'_>, fit: &[bool], left_mm: f64) -> Result<(), NotFound> {
    let following_mm = record.following_mm(fit);
    if left_mm <= NO_MODEL * following_mm {
        return Ok(());
    }
    Err(NotFound::NoModel {
        axis: record.name.to_owned(),
        left_um: 1e3 * left_mm,
        following_um: 1e3 * following_mm,
    })
}

/// Returns the residual of whole runs beyond the noise of the encoder, as a load.
fn residual(
    record: &AxisRecord<'_>,
    values: &TermValues,
    scores: &AxisScores,
    noise_um: f64,
) -> Option<ResidualNoise> {
    let encoder_mm2 = (1e-3 * noise_um).powi(2) + record.step_mm.powi(2) / 12.0;
    ResidualNoise::of(record, values, &scores.simulated_mm, encoder_mm2)
}

fn go_on(wanted: bool) -> Result<(), NotFound> {
    if wanted { Ok(()) } else { Err(NotFound::Ended) }
}

/// Fits the model of a drive that closes its loops once a servo period, with a given window of the
/// speed. Such a drive records itself: its record has no delay.
fn with_window(
    errors: &OutputErrors<'_>,
    window_s: f64,
    values: &TermValues,
    terms: &[ModelTerm],
    rms_mm: f64,
) -> Option<ResolvedModel> {
    let servo_s = periods(errors.record.sample_s).0.servo_s;
    let stated = [
        ModelTerm::RecordDelay,
        ModelTerm::LoopDelay,
        ModelTerm::FilterTime,
        ModelTerm::SpeedWindow,
    ];
    let free: Vec<ModelTerm> = terms
        .iter()
        .copied()
        .filter(|term| !stated.contains(term))
        .collect();
    // To first order: what it is late by, it is too light by.
    let late_s = 0.5 * (window_s + servo_s);
    let lighter = 1.0 / (1.0 + values.speed_gain_1_s() * late_s);
    let start = [
        ModelTerm::LoopGain,
        ModelTerm::Damping,
        ModelTerm::Coulomb,
        ModelTerm::Offset,
    ]
    .into_iter()
    .fold(*values, |start, term| {
        start.with(term, lighter * start.get(term))
    });
    let start = stated
        .into_iter()
        .fold(start, |start, term| start.with(term, 0.0));
    let start = start
        .with(ModelTerm::SpeedWindow, window_s)
        .with(ModelTerm::SpeedHold, servo_s);
    let fitted = errors.least(&start, &free, STEPS, DONE);
    let left_mm = errors.rms_mm(&fitted.values);
    if left_mm.is_nan() || left_mm > HOLDS * rms_mm {
        return None;
    }
    let certain = StandardErrors::of(errors, &fitted.values, &free);
    let half_intervals = free
        .into_iter()
        .zip(certain.errors.iter().map(|error| certain.factor * error))
        .collect();
    Some(ResolvedModel {
        values: fitted.values,
        half_intervals,
        torque: None,
        drive: None,
        fit_um: 1e3 * left_mm,
    })
}

/// Finds friction from the torque column, and fits the model with it.
fn resolve(
    errors: &OutputErrors<'_>,
    torque: &[f64],
    values: &TermValues,
    terms: &[ModelTerm],
    facts: &AxisFacts,
    rms_mm: f64,
) -> Option<ResolvedModel> {
    let record = errors.record;
    let mut found = TorqueColumn::find(record, torque, values, errors.counts)?;
    if let (Some(viscous), Some(gain)) = (facts.viscous, facts.torque_gain) {
        // A friction that is given goes before one that is found: B / J with J of the column.
        let per = if facts.lead_mm_per_rev.is_some() {
            record_per_rad(facts)
        } else {
            1e-3
        };
        (found.viscous_1_s, found.viscous_error_1_s) =
            (viscous / (found.units_per_mm_s2 * gain / per).abs(), 0.0);
    }
    if found.coulomb_mm_s2 < 0.0 || found.viscous_1_s < -2.0 * found.viscous_error_1_s {
        return None;
    }
    let has_integral = terms.contains(&ModelTerm::Integral);
    let drive = if has_integral {
        None
    } else {
        DriveColumn::find(record, torque, &found, errors.counts)
    };
    let mut start = values
        .with(ModelTerm::Viscous, found.viscous_1_s.max(0.0))
        .with(ModelTerm::Coulomb, found.coulomb_mm_s2)
        .with(ModelTerm::Offset, found.offset_mm_s2);
    let mut fixed = vec![
        ModelTerm::Viscous,
        ModelTerm::Coulomb,
        ModelTerm::Offset,
        ModelTerm::LoopDelay,
    ];
    if let Some(drive) = &drive {
        start = start.with(ModelTerm::LoopGain, drive.loop_gain_1_s2).with(
            ModelTerm::Damping,
            drive.speed_gain_1_s + found.viscous_1_s.max(0.0),
        );
        fixed.extend([ModelTerm::LoopGain, ModelTerm::Damping]);
    }
    let mut free: Vec<ModelTerm> = terms
        .iter()
        .copied()
        .filter(|term| !fixed.contains(term))
        .collect();
    free.push(ModelTerm::SpeedWindow);
    let start = start
        .with(ModelTerm::LoopDelay, 0.0)
        .with(ModelTerm::SpeedWindow, 2.0 * record.sample_s);
    let fitted = errors.least(&start, &free, STEPS, DONE);
    let left_mm = errors.rms_mm(&fitted.values);
    if left_mm.is_nan() || left_mm > HOLDS * rms_mm {
        return None;
    }
    let certain = StandardErrors::of(errors, &fitted.values, &free);
    let mut half_intervals: Vec<(ModelTerm, f64)> = free
        .iter()
        .copied()
        .zip(certain.errors.iter().map(|error| certain.factor * error))
        .collect();
    let half = |error: f64| HALF_INTERVAL * error;
    let scale = half(found.units_error / found.units_per_mm_s2.abs());
    half_intervals.extend([
        (ModelTerm::Viscous, half(found.viscous_error_1_s)),
        (ModelTerm::Coulomb, half(found.coulomb_error_mm_s2)),
    ]);
    if let Some(drive) = &drive {
        let damping = libm::hypot(scale * drive.speed_gain_1_s, half(found.viscous_error_1_s));
        half_intervals.extend([
            (ModelTerm::LoopGain, scale * drive.loop_gain_1_s2),
            (ModelTerm::Damping, damping),
        ]);
    }
    Some(ResolvedModel {
        values: fitted.values,
        half_intervals,
        torque: Some(found),
        drive,
        fit_um: 1e3 * left_mm,
    })
}

/// Turn of the motor for a travel, rad/mm; of a linear axis one.
fn record_per_rad(facts: &AxisFacts) -> f64 {
    facts
        .lead_mm_per_rev
        .map_or(1.0, |lead| std::f64::consts::TAU / lead)
}

/// Windows of a record, where it is longer than the admission of terms needs: of those that are
/// fitted for the most part, the ones in which the command accelerates most, and some evenly over
/// the rest, for friction at constant speed.
fn windows(record: &AxisRecord<'_>, fit: &[bool]) -> Vec<std::ops::Range<usize>> {
    if fit.iter().filter(|fit| **fit).count() <= ADMISSION_SAMPLES {
        return record.stretches.to_vec();
    }
    let accelerations = record.command_acceleration_mm_s2();
    let mut all = vec![];
    for stretch in record.stretches {
        let mut from = stretch.start;
        while from < stretch.end {
            let to = (from + WINDOW_SAMPLES).min(stretch.end);
            if 2 * (from..to).filter(|&k| fit[k]).count() > WINDOW_SAMPLES {
                let square: f64 = (from..to)
                    .filter(|&k| fit[k])
                    .map(|k| accelerations[k] * accelerations[k])
                    .sum();
                all.push((square, from..to));
            }
            from = to;
        }
    }
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    let most = ADMISSION_SAMPLES / WINDOW_SAMPLES;
    let lively = most - most / 3;
    let rest = all.split_off(lively.min(all.len()));
    let apart = rest.len().div_ceil((most / 3).max(1)).max(1);
    let mut windows: Vec<_> = all
        .into_iter()
        .chain(rest.into_iter().step_by(apart))
        .map(|(_, window)| window)
        .collect();
    windows.sort_by_key(|window| window.start);
    windows
}

/// Excludes the beginnings of windows, and samples outside of all windows. A record that is late
/// does not have the commands of a beginning.
fn behind_starts(record: &AxisRecord<'_>, counts: &[bool], is_thinned: bool) -> Vec<bool> {
    if !is_thinned {
        return counts.to_vec();
    }
    let beginning = (SETTLING_S / record.sample_s).ceil() as usize + record.without_command(counts);
    let mut behind = vec![false; counts.len()];
    for window in record.stretches {
        let from = (window.start + beginning).min(window.end);
        behind[from..window.end].copy_from_slice(&counts[from..window.end]);
    }
    behind
}

/// RMS of the encoder's noise beside its steps, um: by third differences, in which a motion hardly
/// shows, and their median.
fn noise_um(record: &AxisRecord<'_>) -> f64 {
    let mut differences: Vec<f64> = record
        .stretches
        .iter()
        .flat_map(|stretch| record.actual_mm[stretch.clone()].windows(4))
        .map(|y| (y[3] - 3.0 * y[2] + 3.0 * y[1] - y[0]).abs())
        .collect();
    let median = middle_of(&mut differences);
    // A normal distribution has its median at 0.6745 deviations; the weights 1, 3, 3, 1 have a sum
    // of squares of 20.
    let of_all = median / 0.6745 / 20.0_f64.sqrt();
    1e3 * (of_all * of_all - record.step_mm * record.step_mm / 12.0)
        .max(0.0)
        .sqrt()
}
