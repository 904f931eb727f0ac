//! Which terms the law of an axis has: admitted one by one, by samples that were not fitted.
//!
//! Every axis begins with the four products, the lateness of the record, and a speed loop with or without an integral part. Each
//! further term is first tried with one step of all numbers; those that promise most are fitted, and the one that leaves least of the inner
//! validation samples is admitted, where it leaves enough less and is told from the others, or is many times its standard error. What was admitted is left out again where it turns out to do nothing.
//!
//! Source: forward selection as in Draper and Smith (1998), Applied Regression Analysis, chapter 15, with held-out samples in place of
//! the F test, since residuals are coloured.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use super::axis_facts::AxisFacts;
use super::axis_record::AxisRecord;
use super::output_error::{Fitted, NEARLY_DONE, OutputErrors};
use super::standard_errors::StandardErrors;
use super::terms::{LawTerm, TERMS, TermValues};

/// The terms of an axis, and a fit of them.
#[derive(Debug, Clone)]
pub(super) struct Admitted {
    pub(super) terms: Vec<LawTerm>,
    pub(super) values: TermValues,
}

/// Numbers that every axis has: where it is known how late the record is, what else is late is the drive.
fn base(facts: &AxisFacts) -> [LawTerm; 5] {
    let late = if facts.record_delay_s.is_some() { LawTerm::LoopDelay } else { LawTerm::RecordDelay };
    [LawTerm::LoopGain, LawTerm::Damping, LawTerm::Coulomb, LawTerm::Offset, late]
}

/// Part of the RMS of the inner validation by which a term has to lower it, and what this is more in a second of motion: little motion
/// tells little.
const GAINED: f64 = 0.02;
const GAINED_S: f64 = 0.02;
/// Starts and terms that are followed up after a first look.
const FOLLOWED_STARTS: usize = 3;
const FOLLOWED_TERMS: usize = 4;
/// Steps of fits: of starts, and of terms.
const START_STEPS: usize = 10;
const TERM_STEPS: usize = 8;
const MOST_TERMS: usize = 8;
/// Gains of loops that a fit begins with: of the speed loop over the inertia, of the position loop, and 1 / Ti, 1/s.
const SPEED_GAINS_1_S: [f64; 4] = [30.0, 100.0, 300.0, 900.0];
const POSITION_GAINS_1_S: [f64; 3] = [20.0, 60.0, 150.0];
const INTEGRALS_1_S: [f64; 2] = [0.0, 40.0];
/// Most that a position loop is of its speed loop.
const LOOPS_APART: f64 = 0.6;

/// A term that may be admitted, with what belongs to it, and the values that it begins with.
struct TermCandidate {
    terms: Vec<LawTerm>,
    start: TermValues,
}

/// Finds the terms of an axis.
pub(super) fn admit(
    record: &AxisRecord<'_>,
    [train, valid]: [&[bool]; 2],
    moving_s: f64,
    facts: &AxisFacts,
    mut tell: impl FnMut(f64) -> bool,
) -> Option<Admitted> {
    let on = |counts| OutputErrors { record, counts };
    let (train, valid) = (on(train), on(valid));
    let gained = 1.0 - GAINED - GAINED_S / moving_s.max(GAINED_S);
    let first = begin(record, &train, gained, facts);
    let mut terms = first.0;
    let mut at = first.1;
    let mut left_mm = valid.rms_mm(&at);
    for round in 0..MOST_TERMS {
        if !tell((round + 1) as f64 / (MOST_TERMS + 1) as f64) {
            return None;
        }
        let Some(best) = best_term(record, [&train, &valid], &terms, &at, gained * left_mm) else { break };
        terms.extend(best.terms);
        (at, left_mm) = (best.values, best.valid_mm);
    }
    Some(Admitted { terms, values: at })
}

/// The base, with an integral part where that leaves less. What an earlier record told stands from the beginning on.
fn begin(
    record: &AxisRecord<'_>,
    train: &OutputErrors<'_>,
    gained: f64,
    facts: &AxisFacts,
) -> (Vec<LawTerm>, TermValues) {
    let base = base(facts);
    if let Some(before) = facts.before {
        let all = base.iter().chain((before.get(LawTerm::Integral) > 0.0).then_some(&LawTerm::Integral));
        let terms: Vec<LawTerm> = all.copied().collect();
        let before = before.with(LawTerm::RecordDelay, facts.record_delay_s.unwrap_or(0.0));
        return (terms.clone(), train.least(&before, &terms, START_STEPS, NEARLY_DONE).values);
    }
    let of_kind = |integral: f64| {
        let mut terms = base.to_vec();
        if integral > 0.0 {
            terms.push(LawTerm::Integral);
        }
        let late_s = facts.record_delay_s.unwrap_or(0.0);
        let starts = starts(record, train.counts, integral);
        let mut ranked: Vec<(f64, TermValues)> = starts
            .par_iter()
            .map(|at| at.with(LawTerm::RecordDelay, late_s))
            .map(|at| (train.rms_mm(&at), at))
            .collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        let fits: Vec<Fitted> = ranked
            .par_iter()
            .take(FOLLOWED_STARTS)
            .map(|(_, at)| train.least(at, &terms, START_STEPS, NEARLY_DONE))
            .collect();
        let best = fits.into_iter().min_by(|a, b| a.rms_mm.total_cmp(&b.rms_mm));
        best.map(|best| (terms, best))
    };
    let [plain, integral] = INTEGRALS_1_S.map(of_kind);
    match (plain, integral) {
        (Some(plain), Some(integral)) if integral.1.rms_mm > gained * plain.1.rms_mm => (plain.0, plain.1.values),
        (_, Some(integral)) => (integral.0, integral.1.values),
        (Some(plain), None) => (plain.0, plain.1.values),
        // There is a start whatever the record.
        (None, None) => (base.to_vec(), TermValues([0.0; TERMS])),
    }
}

/// Values before anything is known: gains on a grid, and with the lag that the following error has by the speed.
fn starts(record: &AxisRecord<'_>, counts: &[bool], integral: f64) -> Vec<TermValues> {
    let speed_mm_s = record.command_speed_mm_s();
    let (mut squares, mut products) = (Matrix3::zeros(), Vector3::zeros());
    for k in (0..speed_mm_s.len()).filter(|&k| counts[k]) {
        let v = speed_mm_s[k];
        let row = Vector3::new(v, if v == 0.0 { 0.0 } else { v.signum() }, 1.0);
        squares += row * row.transpose();
        products += row * (record.command_mm[k] - record.actual_mm[k]);
    }
    let lag_s = squares.cholesky().map_or(0.0, |squares| squares.solve(&products)[0]);
    let mut starts = vec![];
    for damping in SPEED_GAINS_1_S {
        let of_lag = (lag_s > 1e-3).then(|| 1.0 / lag_s);
        for kp_1_s in POSITION_GAINS_1_S.into_iter().chain(of_lag).filter(|kp_1_s| *kp_1_s < LOOPS_APART * damping) {
            let start = TermValues([0.0; TERMS])
                .with(LawTerm::LoopGain, kp_1_s * damping)
                .with(LawTerm::Damping, damping)
                .with(LawTerm::Coulomb, 10.0)
                .with(LawTerm::StribeckSpeed, 2.0)
                .with(LawTerm::Integral, integral);
            starts.push(start);
        }
    }
    starts
}

/// A term that may be admitted, fitted.
struct FollowedTerm {
    terms: Vec<LawTerm>,
    values: TermValues,
    /// RMS that it leaves of the inner validation, mm.
    valid_mm: f64,
}

/// The term that leaves least of the inner validation, less than a bound, mm, of those that are told from the others or many times their
/// standard error.
fn best_term(
    record: &AxisRecord<'_>,
    [train, valid]: [&OutputErrors<'_>; 2],
    terms: &[LawTerm],
    at: &TermValues,
    clearly_mm: f64,
) -> Option<FollowedTerm> {
    let slopes = train.slopes(at, terms);
    let now_mm = train.rms_mm(at);
    let mut looked: Vec<(f64, TermCandidate, TermValues)> = candidates(record, terms, at)
        .into_par_iter()
        .filter_map(|candidate| {
            // A start that loses the run is no start.
            let lost = train.rms_mm(&candidate.start) > LOST * now_mm;
            let all: Vec<LawTerm> = terms.iter().chain(&candidate.terms).copied().collect();
            let step = (!lost).then(|| train.one_step(&candidate.start, &all, &slopes))?;
            Some((step.rms_mm, candidate, step.values))
        })
        .collect();
    looked.sort_by(|a, b| a.0.total_cmp(&b.0));
    looked.truncate(FOLLOWED_TERMS);
    let followed = looked.into_par_iter().filter_map(|(_, candidate, start)| {
        let all: Vec<LawTerm> = terms.iter().chain(&candidate.terms).copied().collect();
        let values = train.least(&start, &all, TERM_STEPS, NEARLY_DONE).values;
        let valid_mm = valid.rms_mm(&values);
        if valid_mm >= clearly_mm {
            return None;
        }
        let is_told = train.told_apart(&values, &all) > LEAST_TOLD || {
            let errors = StandardErrors::of(train, &values, &all).errors;
            errors.get(terms.len()).is_some_and(|error| values.get(candidate.terms[0]) > CERTAIN * error)
        };
        is_told.then_some(FollowedTerm { terms: candidate.terms, values, valid_mm })
    });
    // One number before two: a screw of two can stand for much that one number is.
    followed.min_by(|a, b| a.terms.len().cmp(&b.terms.len()).then(a.valid_mm.total_cmp(&b.valid_mm)))
}

/// A resonance of 20 Hz and more shows in samples of less than this, s: five and more in a period.
const SLOWEST_FOR_RESONANCE_S: f64 = 0.005;
/// Least part of what a number does to the position that no other number does as well.
const LEAST_TOLD: f64 = 1e-3;
/// Standard errors that a number is, of whatever size its effect.
const CERTAIN: f64 = 6.0;

/// A start that leaves so many times more than the fit is lost.
const LOST: f64 = 30.0;

/// Terms that the law does not have yet.
fn candidates(record: &AxisRecord<'_>, terms: &[LawTerm], at: &TermValues) -> Vec<TermCandidate> {
    let sample_s = record.sample_s;
    let most = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let speed_mm_s = record.slopes(record.actual_mm, 3);
    let acceleration_mm_s2 = most(&record.slopes(&speed_mm_s, 3));
    let of_damping = 0.1 * at.get(LawTerm::Damping);
    let starts: [(LawTerm, &[f64]); 13] = [
        (LawTerm::Integral, &[10.0, 60.0]),
        (LawTerm::VelocityFeedforward, &[0.3, 0.95]),
        (LawTerm::AccelerationFeedforward, &[0.5]),
        (LawTerm::LoopDelay, &[0.5 * sample_s, 2.0 * sample_s]),
        (LawTerm::FilterTime, &[0.2 * sample_s, sample_s]),
        (LawTerm::SpeedWindow, &[sample_s, 2.5 * sample_s]),
        (LawTerm::Presliding, &[0.003, 0.03]),
        (LawTerm::Stribeck, &[0.3]),
        (LawTerm::SpeedLimit, &[0.97 * most(&speed_mm_s)]),
        (LawTerm::AccelerationLimit, &[0.9 * acceleration_mm_s2]),
        (LawTerm::Viscous, &[of_damping]),
        (LawTerm::Resonance, &[1.0 / (TAU * 40.0), 1.0 / (TAU * 90.0)]),
        (LawTerm::Backlash, &[0.003, 0.02]),
    ];
    let mut candidates = vec![];
    for (term, values) in starts {
        // Without an integral the two parts of the damping are the same to the position.
        let is_told = match term {
            LawTerm::Viscous => terms.contains(&LawTerm::Integral),
            // Within a rigid screw there is none that the motor's encoder sees.
            // What swings faster than a fifth of the rate does not show, and what swings below 20 Hz is no screw of a machine tool.
            LawTerm::Resonance => sample_s < SLOWEST_FOR_RESONANCE_S,
            LawTerm::Backlash => terms.contains(&LawTerm::Resonance),
            _ => true,
        };
        if terms.contains(&term) || !is_told {
            continue;
        }
        for value in values {
            let start = at.with(term, *value);
            let (terms, start) = match term {
                LawTerm::Stribeck => (vec![term, LawTerm::StribeckSpeed], start),
                LawTerm::Resonance => (vec![term, LawTerm::TableShare], start.with(LawTerm::TableShare, 0.5)),
                _ => (vec![term], start),
            };
            candidates.push(TermCandidate { terms, start });
        }
    }
    candidates
}
