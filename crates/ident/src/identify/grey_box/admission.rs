//! Selects the terms of the model of an axis, and the start of the last fit.
//!
//! Every axis begins with the four products, the delay of the record, and one of six drives. Each
//! drive is fitted from several starts, and from the fits of drives that have fewer terms. The
//! delay stays at its start until the gains are near, since the two are exchangeable far from the
//! minimum. It starts at zero, or at the lag beyond the slowest position loop. Each drive is then
//! fitted with friction that slides at once, with friction that slides after a deflection, and with
//! a limit of the speed where the command is faster than the axis. The selected drive makes
//! held-out samples likeliest, less the cost of its terms (Schwarz). As many samples as the
//! residual is correlated over count as one.
//!
//! Each further term is tried with one step of all numbers. The most promising ones are fitted. A
//! term is admitted if it exceeds zero by its standard error, and if it makes held-out samples
//! likelier by more than it costs (Schwarz).
//!
//! Source: Schwarz (1978), Estimating the dimension of a model; forward selection as in Draper and
//! Smith (1998), Applied Regression Analysis, chapter 15.

use std::f64::consts::TAU;

use feedwright_sim::map_in_parallel;
use nalgebra::{Matrix3, Vector3};

use super::axis_facts::AxisFacts;
use super::axis_record::AxisRecord;
use super::output_error::{NEARLY_DONE, OutputErrors, square};
use super::priors::Prior;
use super::standard_errors::StandardErrors;
use super::terms::{AT_LIMIT, ModelTerm, TERMS, TermValues, Tried};

/// The terms of an axis, and a fit of them.
#[derive(Debug, Clone)]
pub(super) struct Admitted {
    pub(super) terms: Vec<ModelTerm>,
    pub(super) values: TermValues,
}

/// Terms that every axis has: where it is known how late the record is, what else is late is the
/// drive.
fn base(facts: &AxisFacts) -> Vec<ModelTerm> {
    let late = if facts.record_delay_s.is_some() {
        ModelTerm::LoopDelay
    } else {
        ModelTerm::RecordDelay
    };
    let mut base = vec![
        ModelTerm::LoopGain,
        ModelTerm::Damping,
        ModelTerm::Coulomb,
        ModelTerm::Offset,
        late,
    ];
    if facts.known(ModelTerm::LoopDelay).is_some() && late != ModelTerm::LoopDelay {
        base.push(ModelTerm::LoopDelay);
    }
    base
}

/// Optional terms of a drive, simple ones first.
const DRIVES: [&[ModelTerm]; 6] = [
    &[],
    &[ModelTerm::Integral],
    &[ModelTerm::VelocityFeedforward],
    &[ModelTerm::Integral, ModelTerm::VelocityFeedforward],
    &[
        ModelTerm::VelocityFeedforward,
        ModelTerm::AccelerationFeedforward,
    ],
    &[
        ModelTerm::Integral,
        ModelTerm::VelocityFeedforward,
        ModelTerm::AccelerationFeedforward,
    ],
];

/// Standard errors that a further term is above zero: one in a thousand that are zero is.
const QUANTILE: f64 = 3.09;
/// Standard errors by which the gain in likelihood of held-out samples must exceed zero: one in
/// twenty absent terms is admitted.
const LIKELIER: f64 = 1.645;
/// Length of a block over which likelihoods are summed up, s: what is left is not correlated over
/// more.
const SUMMED_S: f64 = 0.25;
/// Starts and terms that are followed up after a first look.
const FOLLOWED_STARTS: usize = 2;
const FOLLOWED_TERMS: usize = 4;
/// Steps of fits: of starts, and of terms.
const START_STEPS: usize = 10;
const TERM_STEPS: usize = 8;
/// Steps of a fit of a drive, and the part of its squares that a step gains at least: a delay and
/// the damping trade places slowly.
const DRIVE_STEPS: usize = 30;
const DRIVE_DONE: f64 = 1e-5;
const MOST_TERMS: usize = 8;
/// Gains of loops that a fit begins with: of the speed loop over the inertia, of the position loop,
/// 1/s, and 1 / Ti as a part of the first; the least friction; and feedforward of speed and
/// acceleration.
const SPEED_GAINS_1_S: [f64; 4] = [30.0, 100.0, 300.0, 900.0];
const POSITION_GAINS_1_S: [f64; 3] = [20.0, 60.0, 150.0];
const INTEGRALS: [f64; 2] = [0.0, 0.25];
const LEAST_COULOMB_MM_S2: f64 = 10.0;
const FEEDFORWARDS: [[f64; 2]; 3] = [[0.0, 0.0], [0.95, 0.0], [0.99, 0.7]];
/// Most that a position loop is of its speed loop.
const LOOPS_APART: f64 = 0.6;

/// A term that may be admitted, with what belongs to it, and the values that it begins with.
struct TermCandidate {
    terms: Vec<ModelTerm>,
    start: TermValues,
}

/// Finds the terms of an axis.
pub(super) fn admit(
    record: &AxisRecord<'_>,
    [train, valid]: [&[bool]; 2],
    facts: &AxisFacts,
    priors: &[Prior],
    mut progress: impl FnMut(f64) -> bool,
) -> Option<Admitted> {
    let deviation_mm = record.following_mm(train);
    let [train, valid] = [train, valid].map(|counts| OutputErrors {
        record,
        counts,
        deviation_mm,
        priors,
    });
    let (mut terms, mut at) = begin(record, [&train, &valid], facts);
    for round in 0..MOST_TERMS {
        if !progress((round + 1) as f64 / (MOST_TERMS + 1) as f64) {
            return None;
        }
        let train = train.scaled_by(&at);
        let valid = OutputErrors {
            deviation_mm: train.deviation_mm,
            ..valid
        };
        let Some(best) = best_term(
            candidates(record, facts, &terms, &at),
            [&train, &valid],
            &terms,
            &at,
        ) else {
            break;
        };
        terms.extend(best.terms);
        at = best.values;
    }
    Some(Admitted { terms, values: at })
}

/// Admits the terms of the drive that only all fitted samples determine, and not windows of them.
pub(super) fn admit_more(
    errors: &OutputErrors<'_>,
    facts: &AxisFacts,
    admitted: Admitted,
) -> Admitted {
    let Admitted {
        mut terms,
        values: mut at,
    } = admitted;
    for _ in 0..MOST_TERMS {
        at = errors
            .scaled_by(&at)
            .least(&at, &terms, START_STEPS, NEARLY_DONE)
            .values;
        let errors = errors.scaled_by(&at);
        let of_drive = candidates(errors.record, facts, &terms, &at)
            .into_iter()
            .filter(|candidate| {
                OPTIONAL.contains(&candidate.terms[0]) || candidate.terms[0] == ModelTerm::Backlash
            })
            .collect();
        let Some(best) = best_term(of_drive, [&errors, &errors], &terms, &at) else {
            break;
        };
        terms.extend(best.terms);
        at = best.values;
    }
    Admitted { terms, values: at }
}

/// The base and the drive that makes held-out samples likeliest for what it has.
fn begin(
    record: &AxisRecord<'_>,
    [train, valid]: [&OutputErrors<'_>; 2],
    facts: &AxisFacts,
) -> (Vec<ModelTerm>, TermValues) {
    let nothing = (base(facts), TermValues([0.0; TERMS]));
    let drives = drives(record, train, facts);
    let Some(least) = drives.iter().min_by(|a, b| a.left_mm.total_cmp(&b.left_mm)) else {
        return nothing;
    };
    let train = train.weighed_by(&least.values);
    let valid = OutputErrors {
        deviation_mm: train.deviation_mm,
        ..*valid
    };
    let near = drives
        .iter()
        .filter(|drive| drive.left_mm < FAR * least.left_mm);
    let near: Vec<(Vec<ModelTerm>, TermValues)> =
        near.flat_map(|drive| variants(record, drive)).collect();
    let fits: Vec<(Vec<ModelTerm>, TermValues, f64)> = map_in_parallel(near, |(terms, values)| {
        let values = train.least(&values, &terms, DRIVE_STEPS, DRIVE_DONE).values;
        (terms, values, square(&valid.residuals(&values)))
    });
    // In these units the least square is the number of samples that are independent.
    let independent = fits.iter().map(|fit| fit.2).fold(f64::INFINITY, f64::min);
    let cost = |fit: &(Vec<ModelTerm>, TermValues, f64)| {
        fit.2 + fit.0.len() as f64 * libm::log(independent.max(1.0))
    };
    let likeliest = fits.into_iter().min_by(|a, b| cost(a).total_cmp(&cost(b)));
    likeliest.map_or(nothing, |(terms, values, _)| (terms, values))
}

/// A drive, fitted.
struct FittedDrive {
    /// Terms of the drive beyond the base.
    has: &'static [ModelTerm],
    terms: Vec<ModelTerm>,
    values: TermValues,
    left_mm: f64,
}

/// Fits each possible drive from its best starts and from the drives that have fewer terms. The
/// values of an earlier record stay, except the loops, which may have changed.
fn drives(
    record: &AxisRecord<'_>,
    train: &OutputErrors<'_>,
    facts: &AxisFacts,
) -> Vec<FittedDrive> {
    let late = facts
        .record_delay_s
        .map_or_else(|| record.late_samples(train.counts), |_| 0);
    let mut starts = starts(record, train.counts, late);
    if let Some(before) = facts.before {
        let loops = |at: TermValues| {
            [ModelTerm::LoopGain, ModelTerm::Damping]
                .into_iter()
                .fold(before, |kept, term| kept.with(term, at.get(term)))
        };
        starts = std::iter::once(before)
            .chain(starts.into_iter().map(loops))
            .collect();
    }
    let ranked = |starts: Vec<TermValues>| {
        let mut ranked: Vec<(f64, TermValues)> =
            train.all_rms_mm(&starts).into_iter().zip(starts).collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        ranked
    };
    let begin = |at: TermValues| {
        let at = facts.start(at);
        facts.record_delay_s.map_or(
            at.with(ModelTerm::RecordDelay, late as f64 * record.sample_s),
            |_| at,
        )
    };
    let starts = ranked(starts.into_iter().map(begin).collect());
    // A part that is known to be there is there, and one that is known to be zero is not.
    let may_be = |drive: &&[ModelTerm]| {
        let is = |term| {
            facts
                .known(term)
                .is_none_or(|known| drive.contains(&term) == (known.value != 0.0))
        };
        OPTIONAL.into_iter().all(is)
    };
    let fit = |has: &'static [ModelTerm]| {
        let is_of = |at: &TermValues| {
            OPTIONAL
                .into_iter()
                .all(|term| has.contains(&term) || at.get(term) == 0.0)
        };
        let of_drive = starts
            .iter()
            .filter(|(_, at)| facts.before.is_some() || is_of(at));
        fit_drive(train, facts, has, &of_each_speed_gain(of_drive))
    };
    let fitted = map_in_parallel(DRIVES.into_iter().filter(may_be), fit);
    let mut fitted: Vec<FittedDrive> = fitted.into_iter().flatten().collect();
    for i in 0..fitted.len() {
        let has = fitted[i].has;
        let less = fitted.iter().filter(|less| {
            less.has.len() < has.len() && less.has.iter().all(|term| has.contains(term))
        });
        let starts = ranked(less.map(|less| with_more(less, has)).collect());
        if let Some(other) =
            fit_drive(train, facts, has, &starts).filter(|other| other.left_mm < fitted[i].left_mm)
        {
            fitted[i] = other;
        }
    }
    fitted
}

/// The best start with each gain of the speed loop: two that differ in it end in different minima.
fn of_each_speed_gain<'a>(
    ranked: impl Iterator<Item = &'a (f64, TermValues)>,
) -> Vec<(f64, TermValues)> {
    let mut best: Vec<(f64, TermValues)> = vec![];
    for (left_mm, at) in ranked {
        if best
            .iter()
            .all(|(_, other)| other.get(ModelTerm::Damping) != at.get(ModelTerm::Damping))
        {
            best.push((*left_mm, *at));
        }
    }
    best
}

/// A drive from the best of its starts, the delay as it is there.
fn fit_drive(
    train: &OutputErrors<'_>,
    facts: &AxisFacts,
    has: &'static [ModelTerm],
    ranked: &[(f64, TermValues)],
) -> Option<FittedDrive> {
    let terms: Vec<ModelTerm> = base(facts).into_iter().chain(has.iter().copied()).collect();
    let is_delay = |term: &ModelTerm| matches!(term, ModelTerm::RecordDelay | ModelTerm::LoopDelay);
    let on_time: Vec<ModelTerm> = terms
        .iter()
        .copied()
        .filter(|term| !is_delay(term))
        .collect();
    let train = OutputErrors {
        deviation_mm: ranked.first()?.0.max(f64::MIN_POSITIVE),
        ..*train
    };
    let fitted = map_in_parallel(ranked.iter().take(FOLLOWED_STARTS), |(_, at)| {
        let values = train.least(at, &on_time, START_STEPS, NEARLY_DONE).values;
        (train.rms_mm(&values), values)
    });
    let (left_mm, values) = fitted.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(FittedDrive {
        has,
        terms,
        values,
        left_mm,
    })
}

/// A drive that was fitted with what another has beside: with the same lag at constant speed.
fn with_more(less: &FittedDrive, has: &[ModelTerm]) -> TermValues {
    has.iter()
        .filter(|term| !less.has.contains(term))
        .fold(less.values, |at, &term| match term {
            ModelTerm::Integral => at.with(term, INTEGRALS[1] * at.get(ModelTerm::Damping)),
            ModelTerm::VelocityFeedforward => [ModelTerm::LoopGain, ModelTerm::Coulomb]
                .into_iter()
                .fold(at.with(term, FED), |at, term| {
                    at.with(term, (1.0 - FED) * at.get(term))
                }),
            _ => at.with(term, FED_ACCELERATION),
        })
}

/// Feedforward that a drive begins with where one without it was fitted before.
const FED: f64 = 0.9;
const FED_ACCELERATION: f64 = 0.5;

/// A drive as it is, with friction that slides after a deflection, and with a limit of the speed
/// where the command is faster than the axis.
fn variants(
    record: &AxisRecord<'_>,
    FittedDrive { terms, values, .. }: &FittedDrive,
) -> Vec<(Vec<ModelTerm>, TermValues)> {
    let fastest_mm_s = largest(&record.actual_speed_mm_s());
    let with = |term: ModelTerm, value: f64| {
        (
            terms.iter().copied().chain([term]).collect::<Vec<_>>(),
            values.with(term, value),
        )
    };
    let mut variants = vec![
        (terms.clone(), *values),
        with(ModelTerm::Presliding, PRESLIDING_MM),
    ];
    if largest(&record.command_speed_mm_s()) > FASTER * fastest_mm_s {
        variants.push(with(ModelTerm::SpeedLimit, AT_LIMIT * fastest_mm_s));
    }
    variants
}

/// The largest size of values.
fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

/// A command that is faster than the axis by this factor may run into a limit.
const FASTER: f64 = 1.02;
/// Drives whose residual exceeds the best residual by this factor are not considered.
const FAR: f64 = 2.0;
/// Start of the fit of the deflection before friction slides, mm.
const PRESLIDING_MM: f64 = 0.005;
/// Terms that a drive may have.
pub(super) const OPTIONAL: [ModelTerm; 3] = [
    ModelTerm::Integral,
    ModelTerm::VelocityFeedforward,
    ModelTerm::AccelerationFeedforward,
];

/// Returns the starts before anything is known: gains on a grid, and with the lag that the
/// following error shows against the speed; friction from its dependence on the direction. The
/// record is `late` samples late.
fn starts(record: &AxisRecord<'_>, counts: &[bool], late: usize) -> Vec<TermValues> {
    let speed_mm_s = record.command_speed_mm_s();
    let (mut squares, mut products) = (Matrix3::zeros(), Vector3::zeros());
    for k in (late..speed_mm_s.len()).filter(|&k| counts[k]) {
        let v = speed_mm_s[k - late];
        let row = Vector3::new(v, if v == 0.0 { 0.0 } else { v.signum() }, 1.0);
        squares += row * row.transpose();
        products += row * (record.command_mm[k - late] - record.actual_mm[k]);
    }
    let [lag_s, sign_mm] = squares.cholesky().map_or([0.0; 2], |squares| {
        let found = squares.solve(&products);
        [found[0], found[1]]
    });
    let mut starts = vec![];
    for damping in SPEED_GAINS_1_S {
        let of_lag = (lag_s > 1e-3).then(|| 1.0 / lag_s);
        for kp_1_s in POSITION_GAINS_1_S
            .into_iter()
            .chain(of_lag)
            .filter(|kp_1_s| *kp_1_s < LOOPS_APART * damping)
        {
            for (integral, [speed, acceleration]) in INTEGRALS
                .into_iter()
                .flat_map(|i| FEEDFORWARDS.map(|f| (i, f)))
            {
                let start = TermValues([0.0; TERMS])
                    .with(ModelTerm::LoopGain, kp_1_s * damping)
                    .with(ModelTerm::Damping, damping)
                    .with(
                        ModelTerm::Coulomb,
                        (sign_mm * kp_1_s * damping).max(LEAST_COULOMB_MM_S2),
                    )
                    .with(ModelTerm::StribeckSpeed, 2.0)
                    .with(ModelTerm::VelocityFeedforward, speed)
                    .with(ModelTerm::AccelerationFeedforward, acceleration)
                    .with(ModelTerm::Integral, integral * damping);
                starts.push(start);
            }
        }
    }
    starts
}

/// A term that may be admitted, fitted.
struct FollowedTerm {
    terms: Vec<ModelTerm>,
    values: TermValues,
    /// Gain in twice the log-likelihood of the held-out samples, less the cost of its parameters.
    gain: f64,
}

/// Returns the term that makes held-out samples likeliest, among those that exceed zero with
/// certainty; `None` if no term makes them likelier.
fn best_term(
    candidates: Vec<TermCandidate>,
    [train, valid]: [&OutputErrors<'_>; 2],
    terms: &[ModelTerm],
    at: &TermValues,
) -> Option<FollowedTerm> {
    let slopes = train.slopes(at, terms);
    let now_mm = train.rms_mm(at);
    let looked = map_in_parallel(candidates, |candidate| {
        // A start that loses the run is no start.
        let lost = train.rms_mm(&candidate.start) > LOST * now_mm;
        let all: Vec<ModelTerm> = terms.iter().chain(&candidate.terms).copied().collect();
        let step = (!lost).then(|| train.one_step(&candidate.start, &all, &slopes))?;
        Some((step.cost, candidate, step.values))
    });
    let mut looked: Vec<(f64, TermCandidate, TermValues)> = looked.into_iter().flatten().collect();
    looked.sort_by(|a, b| a.0.total_cmp(&b.0));
    looked.truncate(FOLLOWED_TERMS);
    let before = valid.residuals(at);
    let followed = map_in_parallel(looked, |(_, candidate, start)| {
        let all: Vec<ModelTerm> = terms.iter().chain(&candidate.terms).copied().collect();
        let values = train.least(&start, &all, TERM_STEPS, NEARLY_DONE).values;
        let [gain, error] = sum_and_error(&gains(valid, &before, &valid.residuals(&values)));
        let first = all.len() - candidate.terms.len();
        let certainty = || {
            values.get(candidate.terms[0]) / StandardErrors::of(train, &values, &all).errors[first]
        };
        let gain = gain - candidate.terms.len() as f64 * libm::log(before.len() as f64);
        (gain > LIKELIER * error
            && is_screw_or_none(&values, train.record.sample_s)
            && certainty() > QUANTILE)
            .then_some(FollowedTerm {
                terms: candidate.terms,
                values,
                gain,
            })
    });
    followed
        .into_iter()
        .flatten()
        .max_by(|a, b| a.gain.total_cmp(&b.gain))
}

/// Gain in twice the log-likelihood from one set of residuals to another, for each block.
fn gains(valid: &OutputErrors<'_>, before: &[f64], after: &[f64]) -> Vec<f64> {
    let samples = before.len() - valid.priors.len();
    let block = ((SUMMED_S / valid.record.sample_s).ceil() as usize)
        .clamp(1, samples.div_ceil(LEAST_BLOCKS).max(1));
    let gain = |from: usize| {
        let to = (from + block).min(samples);
        before[from..to]
            .iter()
            .zip(&after[from..to])
            .map(|(before, after)| before * before - after * after)
            .sum()
    };
    (0..samples).step_by(block).map(gain).collect()
}

/// The sum of gains, and its standard error.
fn sum_and_error(gains: &[f64]) -> [f64; 2] {
    let (n, sum) = (gains.len() as f64, gains.iter().sum::<f64>());
    [
        sum,
        gains
            .iter()
            .map(|gain| (gain - sum / n) * (gain - sum / n))
            .sum::<f64>()
            .sqrt(),
    ]
}

/// Fewest blocks.
const LEAST_BLOCKS: usize = 10;
/// A resonance of 20 Hz and more shows in samples of less than this, s: five and more in a period.
const SLOWEST_FOR_RESONANCE_S: f64 = 0.005;
/// Samples of a period that a swing shows in.
const LEAST_OF_PERIOD: f64 = 5.0;
/// Returns true if the screw is rigid, or compliant with a possible share of the table and an
/// oscillation that shows in the samples.
pub(super) fn is_screw_or_none(values: &TermValues, sample_s: f64) -> bool {
    let period_s = TAU * values.get(ModelTerm::Resonance);
    period_s == 0.0
        || period_s >= LEAST_OF_PERIOD * sample_s
            && (SHARES[0]..SHARES[1]).contains(&values.get(ModelTerm::TableShare))
}

/// Parts of the inertia that a table behind a screw has: at an end of them a screw stands for
/// something else.
const SHARES: [f64; 2] = [0.08, 0.92];
/// Residual of a start, relative to the present fit, above which the start is rejected.
const LOST: f64 = 30.0;

/// Returns the terms that the model does not have yet.
fn candidates(
    record: &AxisRecord<'_>,
    facts: &AxisFacts,
    terms: &[ModelTerm],
    at: &TermValues,
) -> Vec<TermCandidate> {
    let sample_s = record.sample_s;
    let speed_mm_s = record.actual_speed_mm_s();
    let acceleration_mm_s2 = largest(&record.slopes(&speed_mm_s, 3));
    let log = Tried {
        sample_s,
        damping_1_s: at.get(ModelTerm::Damping),
        fastest_mm_s: largest(&speed_mm_s),
        acceleration_mm_s2,
    };
    let mut candidates = vec![];
    for term in ModelTerm::ALL {
        // Without an integral the two parts of the damping are the same to the position.
        let is_determined = match term {
            ModelTerm::Viscous => terms.contains(&ModelTerm::Integral) && at.get(term) == 0.0,
            // Without velocity feedforward a command that follows the drive rings: no drive is
            // tuned so.
            ModelTerm::AccelerationFeedforward => at.get(ModelTerm::VelocityFeedforward) > 0.0,
            // What swings faster than a fifth of the rate does not show, and what swings below 20
            // Hz is no screw of a machine tool.
            ModelTerm::Resonance => sample_s < SLOWEST_FOR_RESONANCE_S,
            // Backlash shows at the motor's encoder only where the screw is compliant.
            ModelTerm::Backlash => terms.contains(&ModelTerm::Resonance),
            _ => true,
        };
        if terms.contains(&term) || !is_determined || facts.known(term).is_some() {
            continue;
        }
        for value in (term.row().tried)(&log) {
            let start = at.with(term, value);
            let (terms, start) = match term {
                ModelTerm::Stribeck => (vec![term, ModelTerm::StribeckSpeed], start),
                ModelTerm::Resonance => (
                    vec![term, ModelTerm::TableShare],
                    start.with(ModelTerm::TableShare, 0.5),
                ),
                _ => (vec![term], start),
            };
            if term == ModelTerm::Resonance {
                let terms = terms.iter().copied().chain([ModelTerm::Backlash]).collect();
                candidates.push(TermCandidate {
                    terms,
                    start: start.with(ModelTerm::Backlash, 0.005),
                });
            }
            candidates.push(TermCandidate { terms, start });
        }
    }
    candidates
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn acceleration_feedforward_needs_velocity_feedforward() {
        let command_mm: Vec<f64> = (0..200).map(|k| libm::sin(0.05 * f64::from(k))).collect();
        let stretches = std::slice::from_ref(&(0..200));
        let (actual_mm, sample_s) = (&command_mm[..], 0.001);
        let record = AxisRecord {
            name: "x",
            stretches,
            command_mm: &command_mm,
            actual_mm,
            sample_s,
            step_mm: 1e-6,
        };
        let is_offered = |speed: f64| {
            let at = TermValues([0.0; TERMS]).with(ModelTerm::VelocityFeedforward, speed);
            let offered = candidates(&record, &AxisFacts::default(), &[], &at);
            offered
                .iter()
                .any(|candidate| candidate.terms[0] == ModelTerm::AccelerationFeedforward)
        };
        assert_eq!([0.0, 0.9].map(is_offered), [false, true]);
    }
}
