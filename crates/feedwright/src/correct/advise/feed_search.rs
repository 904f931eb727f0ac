//! Searches for the feedrates at which one way of cutting holds a tolerance.
//!
//! All feedrates go up and down by a factor until the program is within the tolerance, and up to a
//! factor at which no stretch is within it. Between two factors the error is taken as a power of
//! the feedrate; a cut verifies the factor that results. A tool that overshoots when it comes to
//! rest does so at every feedrate from which it brakes for longer than the loop settles. The error
//! that no feedrate removes is therefore reported separately, as the error at the ends of the
//! stretches.

use feedwright_sim::{RunError, StageSteps};

use super::feed_cuts::{ErrorPlace, FeedBench, FeedErrors, StretchErrors};
use super::{CutWay, FeedCut, NearestCut, NearestFeed, WayAdvice};
use crate::correct::stretches::stretches;
use crate::correct::unchanged::lines_of;

/// Steps between factors, and the least and the largest factor.
const STEP: f64 = std::f64::consts::SQRT_2;
const LEAST: f64 = 0.125;
pub(super) const LARGEST: f64 = 4.0;
/// Largest number of cuts in which a factor is lowered until the tolerance holds.
const TRIES: u32 = 8;
/// Least and largest ratio of a lowered factor to the one before.
const LOWER: [f64; 2] = [0.7, 0.96];
/// A cut that takes no more than this factor longer counts as equally fast.
const AS_FAST: f64 = 1.001;
/// Expected number of cuts in a way, for the progress.
const EXPECTED: f64 = 20.0;

/// Result for one stretch, as factors on its feedrate.
#[derive(Debug, Clone, Copy)]
pub(super) struct StretchFactors {
    pub(super) holds: Option<f64>,
    beside_ends: Option<f64>,
    /// Errors of the cut with the smallest largest error.
    least: StretchErrors,
}

impl StretchFactors {
    pub(super) fn nearest(&self, feed_mm_s: f64) -> Option<NearestFeed> {
        let StretchErrors { max_um, place, .. } = self.least;
        let beside_ends_mm_s = self.beside_ends.map(|factor| factor * feed_mm_s);
        self.holds.is_none().then_some(NearestFeed {
            max_um,
            place,
            beside_ends_mm_s,
        })
    }
}

/// Errors that must be within a tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ErrorFigure {
    /// All errors.
    All,
    /// Errors away from the ends of the stretches.
    BesideEnds,
}

impl ErrorFigure {
    /// Returns the largest error of a stretch, um.
    const fn of(self, errors: &StretchErrors) -> f64 {
        match self {
            Self::All => errors.max_um,
            Self::BesideEnds => errors.way_um,
        }
    }

    /// Returns the largest error of a program, um.
    fn of_program(self, errors: &FeedErrors) -> f64 {
        match self {
            Self::All => errors.max_um,
            Self::BesideEnds if errors.max_um.is_finite() => errors
                .stretches
                .iter()
                .map(|stretch| stretch.way_um)
                .fold(0.0, f64::max),
            Self::BesideEnds => f64::INFINITY,
        }
    }
}

/// The search of one way.
pub(super) struct FeedSearch<'b, 'a> {
    pub(super) bench: &'b mut FeedBench<'a>,
    pub(super) way: CutWay,
    pub(super) progress: StageSteps<'b>,
    pub(super) done: f64,
}

impl FeedSearch<'_, '_> {
    fn cut(&mut self, factors: &[f64]) -> Result<FeedErrors, RunError> {
        let errors = self.bench.cut(self.way, factors)?;
        self.done += 1.0 / EXPECTED;
        self.progress.reach(self.done);
        Ok(errors)
    }

    /// Finds the feedrates that hold the tolerance, and the factors of the stretches.
    pub(super) fn advice(
        &mut self,
        most: f64,
        tolerance_um: f64,
    ) -> Result<(WayAdvice, Vec<StretchFactors>), RunError> {
        let count = stretches(self.bench.parts).count();
        let cuts = self.cuts(most, tolerance_um)?;
        let mut found: Vec<StretchFactors> = (0..count)
            .map(|k| of_stretch(&cuts, k, tolerance_um))
            .collect();
        let whole = self.whole(&cuts, tolerance_um, ErrorFigure::All)?;
        let all: Option<Vec<f64>> = found.iter().map(|stretch| stretch.holds).collect();
        let each = match all {
            Some(factors) => self.verified(factors, false, tolerance_um, ErrorFigure::All)?,
            None => None,
        };
        if let Some((factors, _)) = &each {
            found
                .iter_mut()
                .zip(factors)
                .for_each(|(stretch, factor)| stretch.holds = Some(*factor));
        }
        let advice = WayAdvice {
            way: self.way,
            cuts: cuts
                .iter()
                .map(|(factor, errors)| errors.cut(Some(*factor)))
                .collect(),
            nearest: if whole.is_none() {
                self.nearest(&cuts, tolerance_um)?
            } else {
                None
            },
            whole,
            by_stretch: each.map(|(_, errors)| errors.cut(None)),
        };
        Ok((advice, found))
    }

    /// Cuts by rising factor: down until the whole program is within the tolerance, and up while a
    /// stretch is within it, except for its ends.
    fn cuts(&mut self, most: f64, tolerance_um: f64) -> Result<Vec<(f64, FeedErrors)>, RunError> {
        let count = stretches(self.bench.parts).count();
        let first = most.min(1.0);
        let mut cuts = vec![(first, self.cut(&vec![first; count])?)];
        while cuts[0].1.max_um > tolerance_um && cuts[0].0 > 1.01 * LEAST {
            let factor = (cuts[0].0 / STEP).max(LEAST);
            cuts.insert(0, (factor, self.cut(&vec![factor; count])?));
        }
        let holds = |errors: &FeedErrors| {
            errors
                .stretches
                .iter()
                .any(|stretch| stretch.way_um <= tolerance_um)
        };
        while cuts[cuts.len() - 1].0 < most && holds(&cuts[cuts.len() - 1].1) {
            let factor = (cuts[cuts.len() - 1].0 * STEP).min(most);
            cuts.push((factor, self.cut(&vec![factor; count])?));
        }
        Ok(cuts)
    }

    /// Returns the cut with the smallest largest error, and the factor that holds away from the
    /// ends of the stretches.
    fn nearest(
        &mut self,
        cuts: &[(f64, FeedErrors)],
        tolerance_um: f64,
    ) -> Result<Option<NearestCut>, RunError> {
        let Some((factor, errors)) = cuts.iter().min_by(|a, b| a.1.max_um.total_cmp(&b.1.max_um))
        else {
            return Ok(None);
        };
        let all = stretches(self.bench.parts).zip(&errors.stretches);
        let Some((stretch, worst)) = all.max_by(|a, b| a.1.max_um.total_cmp(&b.1.max_um)) else {
            return Ok(None);
        };
        let (lines, place) = (lines_of(stretch), worst.place);
        let beside_ends = self.whole(cuts, tolerance_um, ErrorFigure::BesideEnds)?;
        Ok(Some(NearestCut {
            cut: errors.cut(Some(*factor)),
            lines,
            place,
            beside_ends,
        }))
    }

    /// Cuts the whole program at the largest factor by which `figure` is within the tolerance.
    fn whole(
        &mut self,
        cuts: &[(f64, FeedErrors)],
        tolerance_um: f64,
        figure: ErrorFigure,
    ) -> Result<Option<FeedCut>, RunError> {
        let Some(factor) = held_by(cuts, tolerance_um, &|errors| {
            (figure.of_program(errors), errors.time_s)
        }) else {
            return Ok(None);
        };
        let count = stretches(self.bench.parts).count();
        let verified = self.verified(vec![factor; count], true, tolerance_um, figure)?;
        Ok(verified.map(|(factors, errors)| errors.cut(factors.first().copied())))
    }

    /// Verifies factors by cuts, and lowers them until `figure` is within the tolerance: all by the
    /// same ratio or each by its own. None if it does not get within the tolerance.
    fn verified(
        &mut self,
        mut factors: Vec<f64>,
        together: bool,
        tolerance_um: f64,
        figure: ErrorFigure,
    ) -> Result<Option<(Vec<f64>, FeedErrors)>, RunError> {
        for _ in 0..TRIES {
            let errors = self.cut(&factors)?;
            let largest_um = figure.of_program(&errors);
            if largest_um <= tolerance_um {
                return Ok(Some((factors, errors)));
            }
            let lower = |um: f64| {
                if um > tolerance_um {
                    (tolerance_um / um).sqrt().clamp(LOWER[0], LOWER[1])
                } else {
                    1.0
                }
            };
            let of_stretch = |k: usize| {
                if together {
                    largest_um
                } else {
                    figure.of(&errors.stretches[k])
                }
            };
            factors = factors
                .iter()
                .enumerate()
                .map(|(k, factor)| factor * lower(of_stretch(k)))
                .collect();
        }
        Ok(None)
    }
}

/// Returns the largest factor at which a figure of the cuts, um, is within a tolerance.
fn held_by(
    cuts: &[(f64, FeedErrors)],
    tolerance_um: f64,
    of: &dyn Fn(&FeedErrors) -> (f64, f64),
) -> Option<f64> {
    let point = |(factor, errors): &(f64, FeedErrors)| {
        let (error_um, time_s) = of(errors);
        FactorPoint {
            factor: *factor,
            error_um,
            time_s,
        }
    };
    held(&cuts.iter().map(point).collect::<Vec<_>>(), tolerance_um)
}

/// Evaluates the cuts for one stretch.
fn of_stretch(cuts: &[(f64, FeedErrors)], k: usize, tolerance_um: f64) -> StretchFactors {
    let by = |figure: ErrorFigure| {
        held_by(cuts, tolerance_um, &|errors| {
            (figure.of(&errors.stretches[k]), errors.stretches[k].time_s)
        })
    };
    let of_cut = |(_, errors): &(f64, FeedErrors)| errors.stretches[k];
    let least = cuts
        .iter()
        .map(of_cut)
        .reduce(|a, b| if b.max_um < a.max_um { b } else { a });
    StretchFactors {
        holds: by(ErrorFigure::All),
        beside_ends: by(ErrorFigure::BesideEnds),
        least: least.unwrap_or(StretchErrors {
            time_s: 0.0,
            max_um: 0.0,
            place: ErrorPlace::Way,
            way_um: 0.0,
        }),
    }
}

/// Error and time of a program or a stretch at a factor on its feedrates.
#[derive(Debug, Clone, Copy)]
struct FactorPoint {
    factor: f64,
    error_um: f64,
    time_s: f64,
}

/// Returns the largest factor at which an error, by rising factor, is within a tolerance. It
/// interpolates by logarithms to the next factor. If the largest factor that was cut is within the
/// tolerance, it returns the smallest factor that is equally fast, with no factor beyond the
/// tolerance between them.
fn held(points: &[FactorPoint], tolerance_um: f64) -> Option<f64> {
    let within = |point: &FactorPoint| point.error_um <= tolerance_um;
    let at = points.iter().rposition(within)?;
    let Some(to) = points.get(at + 1) else {
        let beyond = points
            .iter()
            .rposition(|point| !within(point))
            .map_or(0, |beyond| beyond + 1);
        let as_fast = |point: &&FactorPoint| point.time_s <= AS_FAST * points[at].time_s;
        return points[beyond..]
            .iter()
            .find(as_fast)
            .map(|point| point.factor);
    };
    let from = &points[at];
    let part = libm::log(tolerance_um / from.error_um) / libm::log(to.error_um / from.error_um);
    // An error that is not a number, or zero, allows no interpolation.
    Some(if part.is_finite() {
        from.factor * libm::pow(to.factor / from.factor, part)
    } else {
        from.factor
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_two_factors_the_error_is_a_power_of_the_feed() {
        let point = |factor: f64| FactorPoint {
            factor,
            error_um: 4.0 * factor * factor,
            time_s: 1.0 / factor.min(1.0),
        };
        let points: Vec<FactorPoint> = [0.5, 1.0, 2.0].map(point).to_vec();
        assert!((held(&points, 6.0).unwrap() - 1.5_f64.sqrt()).abs() < 1e-12);
        // Beyond a factor of 1 nothing is faster.
        assert_eq!((held(&points, 0.5), held(&points, 20.0)), (None, Some(1.0)));
        let lost = FactorPoint {
            error_um: f64::INFINITY,
            ..points[2]
        };
        assert_eq!(held(&[points[1], lost], 5.0), Some(1.0));
        // What disturbs makes an error larger at a lower feed now and then.
        assert_eq!(
            held(
                &[
                    FactorPoint {
                        error_um: 5.5,
                        ..points[0]
                    },
                    points[1],
                    lost
                ],
                5.0
            ),
            Some(1.0)
        );
    }
}
