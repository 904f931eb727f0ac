//! Question: do the controller's predictions come true?
//!
//! ```text
//! e      distance between the last prediction and the measurement
//! limit  a fifth of the largest deviation of a command, 20 um at least
//!
//! e > limit       in four decisions in a row: the model is wrong
//! e < limit / 2   the model is sound
//! ```
//!
//! Evidence: e and the limit. A controller whose own test found its model wrong counts as wrong at
//! once, with the evidence of that test.

use crate::command::{FaultEvidence, SelfReport, Verdict};

/// Wrong predictions in a row that disengage the controller. A single one is a shock, which no
/// model predicts.
const WRONG_DECISIONS: u32 = 4;
/// Share of the largest deviation beyond which a prediction is wrong.
const WRONG_SHARE: f64 = 0.2;
/// Error up to which a prediction is never wrong, mm, however small the largest deviation is.
const MIN_WRONG_MM: f64 = 0.02;
/// Share of the error of a wrong prediction below which a prediction is good.
const GOOD_SHARE: f64 = 0.5;

/// Recent predictions.
#[derive(Debug, Clone)]
pub(super) struct Predictions {
    wrong_decisions: u32,
}

impl Predictions {
    /// State before any prediction.
    pub(super) const NONE: Self = Self { wrong_decisions: 0 };

    /// Takes in a decision, under this largest deviation of a command. Returns the verdict on the
    /// model. NaN is suspect.
    pub(super) fn judge<const N: usize>(
        &mut self,
        report: &SelfReport<N>,
        deviation_mm: f64,
    ) -> Verdict {
        let limit_mm = (WRONG_SHARE * deviation_mm).max(MIN_WRONG_MM);
        let evidence = FaultEvidence {
            found_mm: report.missed_mm,
            limit_mm,
        };
        if matches!(report.model, Verdict::Wrong { .. }) {
            self.wrong_decisions = WRONG_DECISIONS;
            return report.model;
        }
        self.wrong_decisions = if report.missed_mm > limit_mm {
            self.wrong_decisions + 1
        } else {
            0
        };
        if self.wrong_decisions >= WRONG_DECISIONS {
            Verdict::Wrong {
                evidence: Some(evidence),
            }
        } else if report.missed_mm < GOOD_SHARE * limit_mm {
            Verdict::Sound
        } else {
            Verdict::Suspect { evidence }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(predictions: &mut Predictions, missed_mm: f64) -> Verdict {
        let report = SelfReport::<2> {
            missed_mm,
            ..SelfReport::CORRECTS
        };
        predictions.judge(&report, 1.0)
    }

    #[test]
    fn the_fourth_wrong_prediction_in_a_row_is_sufficient_evidence() {
        let mut predictions = Predictions::NONE;
        assert_eq!(verdict(&mut predictions, 0.099), Verdict::Sound);
        for missed_mm in [0.101, f64::NAN, 0.3, 0.3, 0.3] {
            assert!(matches!(
                verdict(&mut predictions, missed_mm),
                Verdict::Suspect { .. }
            ));
        }
        let evidence = Some(FaultEvidence {
            found_mm: 0.3,
            limit_mm: 0.2,
        });
        assert_eq!(verdict(&mut predictions, 0.3), Verdict::Wrong { evidence });
    }
}
