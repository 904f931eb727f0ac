//! What is claimed of the receding horizon, row by row: value, limit, and whether it holds.

use serde::{Deserialize, Serialize};

use super::table::{Row, knows};
use super::{AT_HOME, Workpiece};
use crate::controllers::{BASELINE, BEST, Knows};

/// One claim on one contour of one machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// What is claimed.
    pub claim: String,
    /// Contour or part.
    pub contour: String,
    /// Machine.
    pub machine: String,
    /// What it is compared with.
    pub against: String,
    /// Ratio.
    pub value: f64,
    /// What it may be.
    pub limit: f64,
    /// Whether it holds.
    pub holds: bool,
}

/// A ratio of machining times that is 1 to rounding.
const SAME_TIME: f64 = 1.0 + 1e-9;

const RMS_OPEN_LOOP: f64 = 0.045;
const MAX_OPEN_LOOP: f64 = 0.10;
const RMS_BEST_PEER: f64 = 0.25;
const RMS_EXACT_MODEL: f64 = 1.2;
const RMS_UNSEEN: f64 = 0.5;
const RMS_IDENTIFIED: f64 = 0.25;
const CORNERS: f64 = 1.0;
/// The peer that has the exact model and all the time of the world.
pub const UPPER_BOUND: &str = "model-predictive";

/// All claims that the rows can bear out.
pub(super) fn verdicts(rows: &[Row], nominal: &str, workpieces: &[Workpiece]) -> Vec<Verdict> {
    let mut verdicts = Vec::new();
    for ours in rows.iter().filter(|row| row.controller == BEST) {
        let here: Vec<&Row> =
            rows.iter().filter(|row| row.contour == ours.contour && row.machine == ours.machine).collect();
        let smooth = workpieces.iter().any(|workpiece| workpiece.name == ours.contour && workpiece.smooth);
        let mut judge = |claim: &str, row: &Row, against: &str, value: f64, limit| {
            verdicts.push(Verdict {
                claim: claim.to_owned(),
                contour: row.contour.clone(),
                machine: row.machine.clone(),
                against: against.to_owned(),
                value,
                limit,
                holds: value <= limit && row.completed && row.time_ratio <= SAME_TIME,
            });
        };
        let without_model = best(&here, |row| is_peer(row) && matters(row, &[Knows::Nothing, Knows::Identified]));
        if ours.machine == nominal {
            if smooth {
                judge("RMS against open loop", ours, BASELINE, ours.rms_ratio, RMS_OPEN_LOOP);
                judge("max against open loop", ours, BASELINE, ours.max_ratio, MAX_OPEN_LOOP);
                if let Some(peer) = without_model {
                    judge(
                        "RMS against the best peer without model",
                        ours,
                        &peer.controller,
                        ours.rms_um / peer.rms_um,
                        RMS_BEST_PEER,
                    );
                }
                if let Some(bound) = here.iter().find(|row| row.controller == UPPER_BOUND) {
                    judge(
                        "RMS against the exact model",
                        ours,
                        UPPER_BOUND,
                        ours.rms_um / bound.rms_um,
                        RMS_EXACT_MODEL,
                    );
                }
            } else {
                let all = [Knows::Nothing, Knows::Identified, Knows::ExactModel];
                if let Some(peer) = best(&here, |row| is_peer(row) && matters(row, &all)) {
                    judge(
                        "RMS at corners against the best peer",
                        ours,
                        &peer.controller,
                        ours.rms_um / peer.rms_um,
                        CORNERS,
                    );
                }
                let peers = here.iter().filter(|row| is_peer(row) && matters(row, &all));
                if let Some(peer) = peers.min_by(|a, b| a.max_um.total_cmp(&b.max_um)) {
                    judge(
                        "max at corners against the best peer",
                        ours,
                        &peer.controller,
                        ours.max_um / peer.max_um,
                        CORNERS,
                    );
                }
            }
        } else if let Some(peer) = without_model {
            judge(
                "RMS, unseen machine, against the best peer without model",
                ours,
                &peer.controller,
                ours.rms_um / peer.rms_um,
                RMS_UNSEEN,
            );
            if let Some(home) = here.iter().find(|row| row.controller == format!("{BEST}{AT_HOME}")) {
                judge(
                    "RMS, identified machine, against the best peer without model",
                    home,
                    &peer.controller,
                    home.rms_um / peer.rms_um,
                    RMS_IDENTIFIED,
                );
            }
        }
    }
    verdicts
}

/// Neither ours nor identified anew.
fn is_peer(row: &Row) -> bool {
    row.controller != BEST && !row.controller.ends_with(AT_HOME) && row.completed
}

fn matters(row: &Row, known: &[Knows]) -> bool {
    knows(row).is_some_and(|knows| known.contains(&knows)) && row.controller != UPPER_BOUND
}

fn best<'a>(rows: &[&'a Row], counts: impl Fn(&Row) -> bool) -> Option<&'a Row> {
    rows.iter().copied().filter(|row| counts(row)).min_by(|a, b| a.rms_um.total_cmp(&b.rms_um))
}
