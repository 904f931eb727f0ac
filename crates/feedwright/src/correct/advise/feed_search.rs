//! The search of the feedrates at which one way of cutting holds a tolerance.
//!
//! All feedrates go up and down by a factor until the program is within the tolerance, and no
//! stretch is any longer. Between two factors the error is a power of the feed; a cut shows whether
//! what is found so holds. Where a tool that comes to rest runs over, it does so at every feed from
//! which it brakes for longer than the loop settles: what no feed takes back is told apart, as the
//! error at the ends of the stretches.

use feedwright_sim::{RunError, StageSteps};

use super::feed_cuts::{ErrorPlace, FeedBench, FeedErrors, StretchErrors};
use super::{CutWay, FeedCut, NearestCut, NearestFeed, WayAdvice};
use crate::correct::stretches::stretches;
use crate::correct::unchanged::lines_of;

/// Steps between factors, and the least and the largest factor.
const STEP: f64 = std::f64::consts::SQRT_2;
const LEAST: f64 = 0.125;
pub(super) const LARGEST: f64 = 4.0;
/// Most cuts in which a factor is lowered until the tolerance holds.
const TRIES: u32 = 8;
/// Least and largest ratio of a lowered factor to the one before.
const LOWER: [f64; 2] = [0.7, 0.96];
/// A cut that takes longer by no more than this factor is as fast.
const AS_FAST: f64 = 1.001;
/// Cuts of a way that are expected, for the progress.
const EXPECTED: f64 = 20.0;

/// What was found of a stretch, as factors on its feedrate.
#[derive(Debug, Clone, Copy)]
pub(super) struct StretchFactors {
    pub(super) holds: Option<f64>,
    beside_ends: Option<f64>,
    /// The errors of the cut in which its largest is least.
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

/// Which errors are to be within a tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ErrorFigure {
    /// All.
    All,
    /// Those beside the ends of the stretches.
    BesideEnds,
}

impl ErrorFigure {
    /// The largest of a stretch, um.
    const fn of(self, errors: &StretchErrors) -> f64 {
        match self {
            Self::All => errors.max_um,
            Self::BesideEnds => errors.way_um,
        }
    }

    /// The largest of a program, um.
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
pub(super) struct FeedSearch<'b, 'a, const N: usize> {
    pub(super) bench: &'b mut FeedBench<'a, N>,
    pub(super) way: CutWay,
    pub(super) progress: StageSteps<'b>,
    pub(super) done: f64,
}

impl<const N: usize> FeedSearch<'_, '_, N> {
    fn cut(&mut self, factors: &[f64]) -> Result<FeedErrors, RunError> {
        let errors = self.bench.cut(self.way, factors)?;
        self.done += 1.0 / EXPECTED;
        self.progress.reach(self.done);
        Ok(errors)
    }

    /// What holds, and the factors of the stretches.
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

    /// Cuts by rising factor: down until all is within the tolerance, and up while a stretch is,
    /// but for its ends.
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

    /// What comes nearest where no factor holds, and the factor that holds beside the ends of the
    /// stretches.
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

    /// The cut of the largest factor on the whole program by which `figure` is within the
    /// tolerance.
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

    /// Factors by which `figure` is within the tolerance, lowered from those that are to hold, all
    /// by as much or each by itself; none where it is not.
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

/// The factor up to which a figure of cuts, um, is within a tolerance.
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

/// What cuts tell of a stretch.
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

/// What a program or a stretch comes to at a factor on its feedrates.
#[derive(Debug, Clone, Copy)]
struct FactorPoint {
    factor: f64,
    error_um: f64,
    time_s: f64,
}

/// The largest factor at which an error, by rising factor, is within a tolerance; between it and
/// the next by logarithms. Where the largest that was cut is, the least that is as fast as it,
/// without one beyond between them.
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
    // An error that is no number, or none, has no place between.
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
