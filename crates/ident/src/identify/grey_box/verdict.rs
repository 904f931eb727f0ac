//! What to say of an identified axis, in words.

use super::found_axis::FoundAxis;
use super::free_run_scores::FreeRunErrors;
use super::search_bound::SearchBound;
use super::unseen_motion::UnseenMotion;

/// Verdict on an identification.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ModelVerdict {
    /// The model predicts clearly better than a linear model.
    ModelHolds,
    /// A linear model without signs predicts as well.
    LinearSuffices,
    /// A linear model predicts better.
    LinearIsBetter,
    /// Too much is left to predict with it.
    TooMuchLeft,
    /// The record leaves open what other motion would show.
    Open,
    /// A value ends where its search ends: the others make up for it.
    AtBound,
}

/// A linear model is as good up to this many times the residual of the axis model.
const AS_GOOD: f64 = 1.15;
/// A linear model is also as good up to this part of the following error, if its residual is less
/// than [`NEAR`] times the residual of the axis model, and if the signs of the speed would not
/// improve it. Friction is then negligible.
const SMALL: f64 = 0.01;
const NEAR: f64 = 2.0;
const SIGNS_HELP: f64 = 0.9;
/// The axis model is worse above this many times the residual of ARX after 100 ms.
const WORSE: f64 = 1.5;
/// An axis model with a residual above this part of the following error is not used for a
/// correction.
const TOO_MUCH: f64 = 0.3;

impl ModelVerdict {
    /// Judges an axis.
    pub fn of(axis: &FoundAxis) -> Self {
        let scores = &axis.scores;
        let (grey_box, linear) = (scores.grey_box, scores.best_linear());
        let ratio = |of: fn(&FreeRunErrors) -> f64| of(&linear) / of(&grey_box);
        let apart = ratio(|errors| errors.at_um[2]).max(ratio(|errors| errors.whole_um));
        let best = scores.best_arx();
        let signs_help = best.whole_um < SIGNS_HELP * linear.whole_um
            || best.at_um[2] < SIGNS_HELP * linear.at_um[2];
        if !axis.at_bounds.is_empty() {
            Self::AtBound
        } else if grey_box.whole_um > TOO_MUCH * scores.following_um {
            Self::TooMuchLeft
        } else if axis.unseen.is_open() {
            Self::Open
        } else if grey_box.at_um[2] > WORSE * scores.best_arx().at_um[2] {
            Self::LinearIsBetter
        } else if apart < AS_GOOD
            || (apart < NEAR && linear.whole_um < SMALL * scores.following_um && !signs_help)
        {
            Self::LinearSuffices
        } else {
            Self::ModelHolds
        }
    }

    /// Explains the verdict in a sentence or two.
    pub fn words(self, axis: &FoundAxis) -> String {
        let scores = &axis.scores;
        let (grey_box, linear) = (scores.grey_box, scores.best_linear());
        let missed = format!(
            "a free run over all that was not fitted misses {} um RMS of a following error of {} um",
            um(grey_box.whole_um),
            um(scores.following_um)
        );
        let against = format!(
            "the best linear model misses {} um, and {} um after 100 ms where the model misses {} um",
            um(linear.whole_um),
            um(linear.at_um[2]),
            um(grey_box.at_um[2])
        );
        match self {
            Self::ModelHolds => format!("the model holds: {missed}; {against}"),
            Self::LinearSuffices => format!("linear suffices: {missed}; {against}"),
            Self::LinearIsBetter => format!(
                "a linear model is better: {missed}; {against}. Something moves this axis that the model does not have"
            ),
            Self::TooMuchLeft => format!("not good enough for control: {missed}; {against}"),
            Self::AtBound => format!(
                "not known: {}; {missed}; {against}",
                at_bounds(&axis.at_bounds)
            ),
            Self::Open => format!("open: {}; {missed}; {against}", open(&axis.unseen)),
        }
    }
}

/// Names the values that end where their search ends, and what to do.
fn at_bounds(bounds: &[SearchBound]) -> String {
    let facts: Vec<String> = bounds.iter().map(SearchBound::words).collect();
    let remedy = bounds.first().map_or("", SearchBound::remedy);
    format!(
        "{}. All values of the axis may be wrong. {remedy}",
        facts.join("; ")
    )
}

/// Names the parameters that the record leaves open, and the uncertainty that follows.
fn open(unseen: &UnseenMotion) -> String {
    let names: Vec<&str> = unseen.terms.iter().map(|term| term.row().name).collect();
    let undetermined = match names.as_slice() {
        [] => "the log does not determine the parameters".to_owned(),
        [one] => format!("the log does not determine {one}"),
        [first @ .., last] => format!("the log does not separate {} and {last}", first.join(", ")),
    };
    let why = match unseen.never {
        Some(way) if way < 0 => ", since the axis never moves in the negative direction",
        Some(_) => ", since the axis never moves in the positive direction",
        None => "",
    };
    format!(
        "{undetermined}{why}. On other motion up to its speed and acceleration the position is uncertain by {} um RMS, where the model leaves {} um",
        um(unseen.uncertain_um),
        um(unseen.left_um)
    )
}

/// Writes a number with three digits.
fn um(value: f64) -> String {
    if !value.is_finite() {
        return "more than any number of".to_owned();
    }
    if value < 10.0 {
        format!("{value:.2}")
    } else if value < 100.0 {
        format!("{value:.1}")
    } else {
        format!("{value:.0}")
    }
}
