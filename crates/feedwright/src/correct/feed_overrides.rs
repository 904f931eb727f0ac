//! Feed overrides at which a corrected program is better than the uncorrected one, and those at
//! which it is worse.
//!
//! A program compensates the lag at its own speeds. An override changes the speed of feed motions,
//! and with it the lag. Rapids and dwells keep their times. Both programs are planned and cut again
//! with each feedrate times the override, once for each: noise and disturbance are the same in
//! both.

use feedwright_plan::Step;
use feedwright_sim::RunError;
use serde::Serialize;

use super::exported::{ExportedCut, ExportedFigures};
use super::workers::Workers;
use crate::report::harm::{Harm, harm};

/// Feed overrides at which both programs are cut, %: the values that operators use to run in a
/// program and to speed it up.
const OVERRIDES: [u32; 6] = [50, 75, 90, 100, 110, 120];

/// Comparison of a corrected program with the uncorrected one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum OverrideVerdict {
    /// Its errors are smaller.
    Better,
    /// It gains too little.
    NoBetter,
    /// An error is larger.
    Worse,
}

/// Both programs at a feed override.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OverrideFigures {
    /// The override, %.
    pub percent: u32,
    /// The comparison there.
    pub verdict: OverrideVerdict,
    /// The uncorrected program.
    pub uncorrected: ExportedFigures,
    /// The corrected program.
    pub as_exported: ExportedFigures,
}

impl OverrideFigures {
    fn new(percent: u32, [uncorrected, as_exported]: [ExportedFigures; 2]) -> Self {
        let verdict = if worst(&uncorrected, &as_exported).is_some() {
            OverrideVerdict::Worse
        } else if as_exported.is_no_better_than(&uncorrected) {
            OverrideVerdict::NoBetter
        } else {
            OverrideVerdict::Better
        };
        Self {
            percent,
            verdict,
            uncorrected,
            as_exported,
        }
    }
}

/// Returns the RMS error if it is worse, or else the first error that is worse.
fn worst(uncorrected: &ExportedFigures, as_exported: &ExportedFigures) -> Option<Harm> {
    harm(&uncorrected.errors(), &as_exported.errors())
        .first()
        .copied()
}

impl ExportedCut<'_> {
    /// Cuts both programs at the overrides that the machine allows; the figures at 100 % are given
    /// as `known`.
    pub(super) fn at_overrides(
        &self,
        programs: [&[Step]; 2],
        known: [ExportedFigures; 2],
        workers: &Workers,
    ) -> Result<Vec<OverrideFigures>, RunError> {
        let most = self.machine.limits.max_feed_mm_s / largest_feed_mm_s(programs[0]);
        let factor = |percent: u32| f64::from(percent) / 100.0;
        let overrides: Vec<u32> = OVERRIDES
            .into_iter()
            .filter(|&percent| percent <= 100 || factor(percent) <= most)
            .collect();
        let others: Vec<u32> = overrides
            .iter()
            .copied()
            .filter(|&percent| percent != 100)
            .collect();
        let stage = "cutting at other feed overrides";
        self.watch.begin(stage, 2 * others.len() as u64);
        let cuts = workers.each(stage, 2 * others.len(), usize::MAX, |k| {
            let program = with_override(programs[k % 2], factor(others[k / 2]));
            let figures = self.once(&program, 0.0, &mut [])?;
            self.watch.advance(1);
            Ok::<_, RunError>(figures)
        })?;
        let mut pairs = cuts.chunks_exact(2).map(|pair| [pair[0], pair[1]]);
        let figures = |&percent: &u32| {
            let pair = if percent == 100 {
                Some(known)
            } else {
                pairs.next()
            };
            pair.map(|pair| OverrideFigures::new(percent, pair))
        };
        Ok(overrides.iter().filter_map(figures).collect())
    }
}

fn largest_feed_mm_s(program: &[Step]) -> f64 {
    let feed_mm_s = |step: &Step| {
        if let Step::Piece(piece) = step
            && piece.cutting
        {
            piece.feed_mm_s
        } else {
            0.0
        }
    };
    program.iter().map(feed_mm_s).fold(0.0, f64::max)
}

/// A program with other feedrates of its feed motions.
fn with_override(program: &[Step], factor: f64) -> Vec<Step> {
    let scaled = |step: &Step| {
        let mut step = step.clone();
        if let Step::Piece(piece) = &mut step
            && piece.cutting
        {
            piece.feed_mm_s *= factor;
        }
        step
    };
    program.iter().map(scaled).collect()
}

/// Neighboring overrides with the same verdict, %: first and last of each run.
fn runs(cuts: &[OverrideFigures], verdict: OverrideVerdict) -> Vec<[u32; 2]> {
    let same = cuts
        .chunk_by(|a, b| a.verdict == b.verdict)
        .filter(|run| run[0].verdict == verdict);
    same.map(|run| [run[0].percent, run[run.len() - 1].percent])
        .collect()
}

const WORDS: [(OverrideVerdict, &str); 3] = [
    (OverrideVerdict::Better, "better"),
    (OverrideVerdict::NoBetter, "no better"),
    (OverrideVerdict::Worse, "worse"),
];

/// Returns the verdicts that occur, in words, each with its runs of overrides: one after the other,
/// with `between` between them.
fn verdicts(
    cuts: &[OverrideFigures],
    one: impl Fn([u32; 2]) -> String,
    between: &str,
) -> impl Iterator<Item = (&'static str, String)> {
    WORDS.iter().filter_map(move |&(verdict, word)| {
        let runs: Vec<String> = runs(cuts, verdict).into_iter().map(&one).collect();
        (!runs.is_empty()).then(|| (word, runs.join(between)))
    })
}

/// The comment in the head of a program, short enough for every control.
pub(super) fn override_note(cuts: &[OverrideFigures]) -> String {
    let one = |[first, last]: [u32; 2]| {
        if first == last {
            first.to_string()
        } else {
            format!("{first}-{last}")
        }
    };
    let all = verdicts(cuts, one, ", ").map(|(word, runs)| format!("{word} at {runs} %"));
    format!("feed override: {}", all.collect::<Vec<_>>().join("; "))
}

/// Describes the overrides in one sentence, with the errors where they are worst; none if there are
/// no cuts.
#[cfg(any(feature = "command", test))]
pub(crate) fn override_sentence(cuts: &[OverrideFigures]) -> Option<String> {
    let one = |[first, last]: [u32; 2]| {
        if first == last {
            format!("at {first} %")
        } else {
            format!("from {first} % to {last} %")
        }
    };
    let all = verdicts(cuts, one, " and ").map(|(word, runs)| format!("{word} {runs}"));
    let all = all.collect::<Vec<_>>().join(", ");
    let worse = || {
        cuts.iter()
            .filter_map(|cut| Some((cut.percent, worst(&cut.uncorrected, &cut.as_exported)?)))
    };
    let largest = worse()
        .max_by(|(_, a), (_, b)| (a.after_um - a.before_um).total_cmp(&(b.after_um - b.before_um)));
    let errors = largest.map_or_else(
        String::new,
        |(
            percent,
            Harm {
                what,
                before_um,
                after_um,
            },
        )| {
            let at = if worse().count() > 1 {
                format!(" at {percent} %")
            } else {
                String::new()
            };
            format!(" ({what} {after_um:.2} um{at}, uncorrected {before_um:.2} um)")
        },
    );
    (!all.is_empty()).then(|| format!("feed override: {all}{errors}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TARGETS;

    /// Cuts at all overrides with these largest errors of the corrected program, um; the
    /// uncorrected one has 10 um.
    fn cuts(max_um: [f64; 6]) -> Vec<OverrideFigures> {
        let figures = |max_um: f64| {
            let mut figures = ExportedFigures::default();
            (figures.rms_um, figures.max_um, figures.completed) = (1.0, max_um, true);
            figures
        };
        let all = OVERRIDES.into_iter().zip(max_um);
        all.map(|(percent, um)| OverrideFigures::new(percent, [figures(10.0), figures(um)]))
            .collect()
    }

    #[test]
    fn overrides_of_the_same_verdict_are_one_range_and_the_worst_has_its_errors() {
        let cuts = cuts([30.0, 12.0, 10.0, 2.0, 2.0, 5.0]);
        assert_eq!(
            override_note(&cuts),
            "feed override: better at 100-120 %; no better at 90 %; worse at 50-75 %"
        );
        assert_eq!(
            override_sentence(&cuts).as_deref(),
            Some(
                "feed override: better from 100 % to 120 %, no better at 90 %, worse from 50 % to 75 % (max 30.00 um at 50 %, uncorrected \
                 10.00 um)"
            )
        );
        assert_eq!(override_sentence(&[]), None);
    }

    #[test]
    fn the_note_fits_in_a_line_of_every_control() {
        let columns = TARGETS
            .iter()
            .map(|target| target.columns)
            .min()
            .unwrap_or_default();
        for case in 0..3_usize.pow(6) {
            let um = std::array::from_fn(|k| [2.0, 10.0, 30.0][case / 3_usize.pow(k as u32) % 3]);
            let note = format!("({})", override_note(&cuts(um)));
            assert!(note.len() <= columns, "{} characters: {note}", note.len());
        }
    }
}
