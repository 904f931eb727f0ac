//! By how many servo periods the position loops have commands late.
//!
//! ```text
//! S(0) - S(n) > ln N + 6       S the squares of fits with commands n servo periods late, in units in which N = S(0)
//! ```
//!
//! One bus serves all axes: S is the sum over them, and n the same for all. n is the number with
//! the least S, as far as S falls with each servo period more. It counts as one number more
//! (Schwarz), and is taken where the evidence for it is strong (Kass and Raftery).
//!
//! To first order a command delay shows as what else lags at a constant speed: less feedforward, or
//! more damping. A fit with n begins where the one with n - 1 ended, with one of these and the
//! delay of the drive changed so that the lag stays:
//!
//! ```text
//! lag = (D - f Kv/J) J / (Kp Kv) + n Ts       f + Kp Ts, or D - Kp Kv/J Ts, for a servo period more;   D = (Kv + B) / J
//! ```
//!
//! Source: Schwarz (1978), Estimating the dimension of a model; Kass and Raftery (1995), Bayes
//! factors, Journal of the American Statistical Association 90.

use super::axis_facts::AxisFacts;
use super::axis_record::AxisRecord;
use super::axis_run::periods;
use super::found_axis::FoundAxis;
use super::output_error::{Fitted, NEARLY_DONE, OutputErrors, square};
use super::priors::Prior;
use super::search_bound::SearchBound;
use super::terms::{ModelTerm, TermValues};

/// Most servo periods that are looked for: a bus takes one to three.
const MOST_PERIODS: u32 = 4;
/// Difference of the criterion from which on the evidence is strong.
const STRONG: f64 = 6.0;
/// Starts that are followed, steps of them, and steps of the best one.
const FOLLOWED_STARTS: usize = 2;
const START_STEPS: usize = 8;
const STEPS: usize = 30;
/// Part of the damping that a start leaves at least.
const LEAST_DAMPING: f64 = 0.3;

/// Returns the facts of the axes with the delay that their records show; `None` if they show none.
/// Nothing is searched where the record may be late, or where a drive recorded itself.
pub(super) fn shown(
    records: &[AxisRecord<'_>],
    axes: &[FoundAxis],
    fit: &[bool],
) -> Option<Vec<AxisFacts>> {
    let is_open = |facts: &AxisFacts| {
        facts.record_delay_s.is_some()
            && facts.command_delay_s.is_none()
            && facts.speed_window_s.is_none()
    };
    let servo_s = periods(records.first()?.sample_s).0.servo_s;
    if !axes.iter().all(|axis| is_open(&axis.facts)) {
        return None;
    }
    let priors: Vec<Vec<Prior>> = axes.iter().map(|axis| Prior::all(&axis.facts)).collect();
    let errors: Vec<OutputErrors<'_>> = records
        .iter()
        .zip(&priors)
        .zip(axes)
        .map(|((record, priors), axis)| {
            OutputErrors {
                record,
                counts: fit,
                deviation_mm: 1.0,
                priors,
            }
            .weighed_by(&axis.values)
        })
        .collect();
    let squares = errors
        .iter()
        .zip(axes)
        .map(|(errors, axis)| square(&errors.residuals(&axis.values)));
    let without: f64 = squares.sum();
    let mut best: Vec<TermValues> = axes.iter().map(|axis| axis.values).collect();
    let mut least = without;
    for _ in 0..MOST_PERIODS {
        let later = errors.iter().zip(axes).zip(&best);
        let fits: Vec<Fitted> = later
            .map(|((errors, axis), best)| one_period_later(errors, best, &axis.terms, servo_s))
            .collect();
        let sum: f64 = fits.iter().map(|fit| fit.cost).sum();
        if sum.is_nan() || sum >= least {
            break;
        }
        (best, least) = (fits.into_iter().map(|fit| fit.values).collect(), sum);
    }
    let delayed = |(axis, values): (&FoundAxis, &TermValues)| AxisFacts {
        command_delay_s: Some(values.get(ModelTerm::CommandDelay)),
        ..axis.facts
    };
    (without - least > libm::log(without.max(1.0)) + STRONG)
        .then(|| axes.iter().zip(&best).map(delayed).collect())
}

/// The delay of an axis whose commands are as late as is looked for.
pub(super) fn at_bound(axis: &FoundAxis, sample_s: f64) -> Option<SearchBound> {
    let (term, bound) = (
        ModelTerm::CommandDelay,
        f64::from(MOST_PERIODS) * periods(sample_s).0.servo_s,
    );
    let value = axis.values.get(term);
    (value > 0.999 * bound).then_some(SearchBound { term, value, bound })
}

/// The fit with commands one servo period later.
fn one_period_later(
    errors: &OutputErrors<'_>,
    before: &TermValues,
    terms: &[ModelTerm],
    servo_s: f64,
) -> Fitted {
    let starts = starts(before, terms, servo_s);
    let mut starts: Vec<(f64, TermValues)> =
        errors.all_rms_mm(&starts).into_iter().zip(starts).collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let fits = starts
        .iter()
        .take(FOLLOWED_STARTS)
        .map(|(_, start)| errors.least(start, terms, START_STEPS, NEARLY_DONE));
    let nothing = Fitted {
        values: *before,
        cost: f64::INFINITY,
    };
    let best = fits.fold(
        nothing,
        |best, fit| if fit.cost < best.cost { fit } else { best },
    );
    errors.least(&best.values, terms, STEPS, NEARLY_DONE)
}

/// Returns the starts of a fit with commands one servo period later.
fn starts(before: &TermValues, terms: &[ModelTerm], servo_s: f64) -> Vec<TermValues> {
    let [late_s, loop_s, fed, damping, loop_gain] = [
        ModelTerm::CommandDelay,
        ModelTerm::LoopDelay,
        ModelTerm::VelocityFeedforward,
        ModelTerm::Damping,
        ModelTerm::LoopGain,
    ]
    .map(|term| before.get(term));
    let later = before.with(ModelTerm::CommandDelay, late_s + servo_s);
    let less_damped = (damping - loop_gain * servo_s).max(LEAST_DAMPING * damping);
    let mut starts = vec![];
    for at in [
        later,
        later.with(ModelTerm::LoopDelay, (loop_s - servo_s).max(0.0)),
    ] {
        starts.extend([at, at.with(ModelTerm::Damping, less_damped)]);
        if terms.contains(&ModelTerm::VelocityFeedforward) {
            starts.push(at.with(
                ModelTerm::VelocityFeedforward,
                fed + before.kp_1_s() * servo_s,
            ));
        }
    }
    starts
}
