//! Reasons why a stretch stays as programmed, and remedies.

use std::fmt;

use feedwright_gcode::canon::{Canon, MotionKind};
use serde::{Deserialize, Serialize};

use super::stretches::{ProgramPart, SmoothStretch};

/// Reason why a stretch has no other command.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) enum UnchangedReason {
    /// Its largest error is below what blocks can correct.
    Good,
    /// No other command lowers its error by enough.
    NoGain,
    /// Every better command takes too long: by this share of its time, %. `rests` is the share of a
    /// slow way to its end, %.
    TooSlow { percent: f64, rests: f64 },
    /// A better command takes more blocks than the stretch may have.
    Blocks,
    /// A better command leaves the path by more than the machine file allows.
    LeavesPath,
    /// Other stretches gain more from the blocks and the time that the program may have.
    Detail,
    /// Its command makes an error larger next to the other stretches.
    Worse,
    /// A machine that the file may describe as well would cut it worse.
    Uncertain,
    /// Its lines hold content that new lines cannot replace.
    Unwritable,
    /// It moves axes beside X, Y and Z.
    OtherAxes,
}

impl fmt::Display for UnchangedReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Good => write!(f, "the error is below 1 um already"),
            Self::NoGain => {
                write!(
                    f,
                    "no command lowers the error: what is left is friction and rounding of the blocks; a lower feedrate may help"
                )
            }
            Self::TooSlow { percent, rests } if 2.0 * rests > *percent => write!(
                f,
                "the control would take {percent:.0} % longer for a better command, most of that to come to rest at its end; \
                 a rounded corner in place of a stop leaves it room"
            ),
            Self::TooSlow { percent, .. } => write!(
                f,
                "the control would take {percent:.0} % longer for a better command, since it bends more sharply where lines meet arcs; a lower \
                 feedrate on these lines leaves it room"
            ),
            Self::Blocks => write!(
                f,
                "a better command takes more blocks than the control may get; a lower feedrate, or longer blocks from the CAM system, would help"
            ),
            Self::LeavesPath => write!(
                f,
                "a better command is further from the path than max_deviation_mm of the machine file; a lower feedrate would help"
            ),
            Self::Detail => write!(
                f,
                "other stretches gain more from the blocks and the time that the program may have; a lower feedrate here would help"
            ),
            Self::Worse => write!(
                f,
                "its command makes an error larger beside the stretches around it; a lower feedrate, or G61 at its ends, separates them"
            ),
            Self::Uncertain => write!(
                f,
                "the machine file is not exact enough to be sure of a gain; a log of a cut (--log) would help, or values that are exact"
            ),
            Self::Unwritable => write!(
                f,
                "its lines have expressions, feeds other than G94, or codes that change coordinates within the cut; plain words, or such codes before \
                 a rapid, let it be corrected"
            ),
            Self::OtherAxes => write!(
                f,
                "it moves axes beside X, Y and Z, which are not corrected"
            ),
        }
    }
}

/// A stretch that stays as it is programmed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnchangedStretch {
    /// First and last line.
    pub lines: [u32; 2],
    /// Reason why it stays, and a remedy.
    pub reason: String,
}

/// Returns the stretches that stay as programmed, in the order of the program; `reasons` has one
/// entry for each stretch.
pub(super) fn unchanged_stretches(
    parts: &[ProgramPart],
    reasons: &[Option<UnchangedReason>],
) -> Vec<UnchangedStretch> {
    let mut reasons = reasons.iter();
    let of_part = |part: &ProgramPart| match part {
        ProgramPart::Stretch(stretch) => {
            let reason = reasons.next().copied().flatten()?;
            Some(UnchangedStretch {
                lines: lines_of(stretch),
                reason: reason.to_string(),
            })
        }
        ProgramPart::Kept(Canon::Motion(motion))
            if motion.kind == MotionKind::Feed && !motion.others.is_none() =>
        {
            Some(UnchangedStretch {
                lines: [motion.line; 2],
                reason: UnchangedReason::OtherAxes.to_string(),
            })
        }
        ProgramPart::Kept(_) => None,
    };
    parts.iter().filter_map(of_part).collect()
}

/// Returns the first and the last line of a stretch.
pub(super) fn lines_of(stretch: &SmoothStretch) -> [u32; 2] {
    [0, stretch.motions.len() - 1].map(|n| stretch.motions[n].line)
}

impl UnchangedStretch {
    /// Returns one line for each reason, with the program lines that it holds for: at most the
    /// first `most` of them.
    #[cfg(feature = "command")]
    pub(crate) fn sentences(all: &[Self], most: usize) -> Vec<String> {
        let mut reasons: Vec<&str> = Vec::new();
        for stretch in all {
            if !reasons.contains(&stretch.reason.as_str()) {
                reasons.push(&stretch.reason);
            }
        }
        let sentence = |reason: &&str| {
            let of: Vec<String> = all
                .iter()
                .filter(|stretch| stretch.reason == **reason)
                .map(
                    |Self {
                         lines: [first, last],
                         ..
                     }| {
                        if first == last {
                            first.to_string()
                        } else {
                            format!("{first} to {last}")
                        }
                    },
                )
                .collect();
            let more = if of.len() > most {
                format!(" and {} more", of.len() - most)
            } else {
                String::new()
            };
            format!(
                "unchanged, lines {}{more}: {reason}",
                of[..of.len().min(most)].join(", ")
            )
        };
        reasons.iter().map(sentence).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(feature = "command")]
    #[test]
    fn each_reason_has_a_sentence_with_its_first_lines() {
        let stretch = |lines: [u32; 2], reason: &str| UnchangedStretch {
            lines,
            reason: reason.to_owned(),
        };
        let all = [
            stretch([3, 3], "a"),
            stretch([5, 9], "b"),
            stretch([12, 13], "a"),
        ];
        assert_eq!(
            UnchangedStretch::sentences(&all, 2),
            [
                "unchanged, lines 3, 12 to 13: a",
                "unchanged, lines 5 to 9: b"
            ]
        );
        assert_eq!(
            UnchangedStretch::sentences(&all[..], 1)[0],
            "unchanged, lines 3 and 1 more: a"
        );
    }

    #[test]
    fn what_takes_the_time_of_a_better_command_is_named() {
        let said = |rests: f64| {
            UnchangedReason::TooSlow {
                percent: 20.0,
                rests,
            }
            .to_string()
        };
        assert!(said(15.0).starts_with(
            "the control would take 20 % longer for a better command, most of that to come to rest at its end"
        ));
        assert!(said(5.0).contains("since it bends more sharply where lines meet arcs"));
    }
}
