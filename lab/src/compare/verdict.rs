//! The claims about the default controller: value, limit, and whether the claim holds.
//!
//! - Nominal machine, contours without corners: compared with the uncorrected cut, the best peer
//!   without an exact model, and `model-predictive`, which has one. The square: RMS and largest
//!   error in um.
//! - Other machines without noise: identified there and unseen, both compared with the best peer
//!   without an exact model.
//! - Machines with noise: RMS without the geometry that no encoder sees. It is compared with the
//!   best peer, with feedforward with cross-coupled control whose parameters are 20 % off, and with
//!   the limit. Peers with exact parameters count; peers with laps of practice and the limit do
//!   not.
//! - Held-out work: RMS and largest error exceed neither the uncorrected cut nor [`DELIVERED`] by
//!   more than [`RMS_UM`] and [`MAX_UM`]. The uncut path exceeds the uncorrected one by no more
//!   than [`UNCUT_UM`]. The controller loses no cut.
//! - All: peak torque compared with [`DELIVERED`].

use feedwright::{BASELINE, BEST, MAX_UM, RMS_UM, UNCUT_UM};
use feedwright_control::Knows;
use feedwright_ident::quadratic_mean;
use serde::{Deserialize, Serialize};

use super::competitor::{Competitor, Knowledge};
use super::options::ComparisonOptions;
use super::table::{ComparisonRow, each_once};

/// One claim on one workpiece of one machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// Text of the claim.
    pub claim: String,
    /// Contour or part, or [`ALL_WORK`].
    pub contour: String,
    /// Machine.
    pub machine: String,
    /// Row that the claim compares with; empty where the limit is absolute.
    pub against: String,
    /// Ratio, or number of `unit`.
    pub value: f64,
    /// Largest value at which the claim holds.
    pub limit: f64,
    /// Unit of both; empty for a ratio.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// True if the claim holds.
    pub holds: bool,
}

/// Name in place of a workpiece, for the quadratic mean over all of them.
pub const ALL_WORK: &str = "all work";
/// Baseline of a control without corrections today: feedforward as machines are delivered.
pub const DELIVERED: &str = "feedforward-as-delivered";
/// The peer that knows all that can be known, including statistics of the noise: a bound on the
/// reachable error, not a competitor.
pub const LIMIT: &str = "lqg-preview";
/// The same where there is no noise: it has the exact model and unlimited computing time.
const NOISELESS_LIMIT: &str = "model-predictive";
/// The best of the peers that controls could have tomorrow.
const FEEDFORWARD_WITH_FEEDBACK: &str = "feedforward-cross-coupled";

/// A ratio of machining times that is 1 to rounding.
const SAME_TIME: f64 = 1.0 + 1e-9;

/// Text of a claim, the largest value at which it holds, and its unit.
struct Claim(&'static str, f64, &'static str);

// On the nominal machine, contours without corners.
const RMS_UNCORRECTED: Claim = Claim("RMS against uncorrected", 0.045, "");
const MAX_UNCORRECTED: Claim = Claim("max against uncorrected", 0.10, "");
const RMS_BEST_PEER: Claim = Claim("RMS against the best peer without model", 0.25, "");
const RMS_EXACT_MODEL: Claim = Claim("RMS against the exact model", 1.2, "");
// On the nominal machine, the square.
const SQUARE: &str = "square";
const RMS_SQUARE: Claim = Claim("RMS of the square", 0.03, "um");
const MAX_SQUARE: Claim = Claim("max of the square", 0.5, "um");
// On other machines without noise.
const UNSEEN: &str = "RMS, unseen machine, against the best peer without model";
const RMS_UNSEEN: Claim = Claim(UNSEEN, 0.5, "");
const IDENTIFIED: &str = "RMS, identified machine, against the best peer without model";
const RMS_IDENTIFIED: Claim = Claim(IDENTIFIED, 0.25, "");
// On machines with noise.
const NOISY_BEST_PEER: Claim = Claim("RMS under noise against the best peer", 0.5, "");
const NOISY_OFF: Claim = Claim("RMS under noise against parameters 20 % off", 0.4, "");
const NOISY_LIMIT: Claim = Claim("RMS under noise against the limit", 2.0, "");
// On held-out work.
const HELD_OUT_RMS: Claim = Claim("held-out: RMS above that of", RMS_UM, "um");
const HELD_OUT_MAX: Claim = Claim("held-out: max above that of", MAX_UM, "um");
const HELD_OUT_UNCUT: Claim = Claim("held-out: uncut path above uncorrected", UNCUT_UM, "um");
const HELD_OUT_LOST: Claim = Claim("held-out: lost", 0.0, "seeds");
// Everywhere.
const PEAK_TORQUE: Claim = Claim("peak torque against the baseline", 1.25, "");

impl Claim {
    /// Builds the verdict for a row: `value` is against the row of `against`.
    fn of(&self, row: &ComparisonRow, against: &str, value: f64) -> Verdict {
        let Self(claim, limit, unit) = *self;
        Verdict {
            claim: claim.to_owned(),
            contour: row.contour.clone(),
            machine: row.machine.clone(),
            against: against.to_owned(),
            value,
            limit,
            unit: unit.to_owned(),
            holds: value <= limit && row.completed && row.time_ratio <= SAME_TIME,
        }
    }

    /// The ratio of a number of two rows.
    fn ratio(&self, [row, against]: [&ComparisonRow; 2], number: RowNumber) -> Verdict {
        self.of(row, &against.controller, number(row) / number(against))
    }

    fn rms(&self, row: &ComparisonRow, against: &ComparisonRow) -> Verdict {
        self.ratio([row, against], ComparisonRow::controlled_rms_um)
    }

    /// The difference of a number of two rows.
    fn above(&self, [row, against]: [&ComparisonRow; 2], number: RowNumber) -> Verdict {
        self.of(row, &against.controller, number(row) - number(against))
    }
}

/// A number of a row.
type RowNumber = fn(&ComparisonRow) -> f64;

/// The rows of a workpiece on a machine.
struct RowsHere<'a>(&'a [ComparisonRow]);

/// All claims that the rows can bear out.
pub(super) fn verdicts(rows: &[ComparisonRow], options: &ComparisonOptions) -> Vec<Verdict> {
    let mut verdicts = Vec::new();
    let noisy = || options.machines.iter().filter(|machine| machine.is_noisy());
    for here in rows.chunk_by(|a, b| a.contour == b.contour && a.machine == b.machine) {
        let cell = RowsHere(here);
        let mut workpieces = options.workpieces.iter();
        let workpiece = workpieces.find(|workpiece| workpiece.name == here[0].contour);
        let (Some(ours), Some(workpiece)) = (cell.named(BEST), workpiece) else {
            continue;
        };
        let is_noisy = noisy().any(|machine| machine.name == ours.machine);
        match (ours.machine == options.nominal.name, is_noisy) {
            (_, true) => verdicts.extend(cell.under_noise(ours)),
            (true, false) if workpiece.smooth => verdicts.extend(cell.without_corners(ours)),
            (true, false) if ours.contour == SQUARE => verdicts.extend(square(ours)),
            (true, false) => {}
            (false, false) => verdicts.extend(cell.elsewhere(ours)),
        }
        if workpiece.held_out {
            verdicts.extend(cell.held_out(ours));
        }
        let torque = |base| PEAK_TORQUE.ratio([ours, base], |row| row.peak_torque_nm);
        verdicts.extend(cell.named(DELIVERED).map(torque));
    }
    for machine in noisy().filter(|_| options.workpieces.len() > 1) {
        let means = over_all_work(rows, &machine.name);
        let cell = RowsHere(&means);
        let ours = cell.named(BEST).into_iter();
        verdicts.extend(ours.flat_map(|ours| cell.under_noise(ours)));
    }
    verdicts
}

/// The square of the nominal machine.
fn square(ours: &ComparisonRow) -> [Verdict; 2] {
    let max = MAX_SQUARE.of(ours, "", ours.max_um);
    [RMS_SQUARE.of(ours, "", ours.rms_um), max]
}

/// Returns a row for each controller of a machine with the quadratic means over all work, and
/// whether all cuts were completed.
fn over_all_work(rows: &[ComparisonRow], machine: &str) -> Vec<ComparisonRow> {
    let on = || rows.iter().filter(|row| row.machine == machine);
    let mean_of = |controller: &str| {
        let its: Vec<&ComparisonRow> = on().filter(|row| row.controller == controller).collect();
        let rms_um = quadratic_mean(its.iter().map(|row| row.controlled_rms_um()));
        ComparisonRow {
            contour: ALL_WORK.to_owned(),
            rms_um,
            joint_rms_um: Some(rms_um),
            completed: its.iter().all(|row| row.completed),
            time_ratio: its.iter().map(|row| row.time_ratio).fold(0.0, f64::max),
            ..its[0].clone()
        }
    };
    let controllers = each_once(on().map(|row| &row.controller));
    controllers.into_iter().map(mean_of).collect()
}

impl<'a> RowsHere<'a> {
    fn named(&self, controller: &str) -> Option<&'a ComparisonRow> {
        self.0.iter().find(|row| row.controller == controller)
    }

    fn with(&self, controller: &str, knowledge: Knowledge) -> Option<&'a ComparisonRow> {
        self.named(&format!("{controller}{}", knowledge.suffix()))
    }

    fn without_corners(&self, ours: &ComparisonRow) -> Vec<Verdict> {
        let (peer, bound) = (self.best_without_model(), self.named(NOISELESS_LIMIT));
        let mut verdicts = vec![
            RMS_UNCORRECTED.of(ours, BASELINE, ours.rms_ratio),
            MAX_UNCORRECTED.of(ours, BASELINE, ours.max_ratio),
        ];
        verdicts.extend(peer.map(|peer| RMS_BEST_PEER.rms(ours, peer)));
        verdicts.extend(bound.map(|bound| RMS_EXACT_MODEL.rms(ours, bound)));
        verdicts
    }

    fn elsewhere(&self, ours: &ComparisonRow) -> Vec<Verdict> {
        let Some(peer) = self.best_without_model() else {
            return Vec::new();
        };
        let unseen = self.with(BEST, Knowledge::Unseen);
        let unseen = unseen.map(|unseen| RMS_UNSEEN.rms(unseen, peer));
        unseen
            .into_iter()
            .chain([RMS_IDENTIFIED.rms(ours, peer)])
            .collect()
    }

    fn under_noise(&self, ours: &ComparisonRow) -> Vec<Verdict> {
        let peer = self.best(&[Knows::Nothing, Knows::Identified, Knows::ExactModel]);
        let off = self.with(FEEDFORWARD_WITH_FEEDBACK, Knowledge::TwentyPercentOff);
        let claims = [
            (NOISY_BEST_PEER, peer),
            (NOISY_OFF, off),
            (NOISY_LIMIT, self.named(LIMIT)),
        ];
        let verdict = |(claim, other): (Claim, Option<_>)| Some(claim.rms(ours, other?));
        claims.into_iter().filter_map(verdict).collect()
    }

    fn held_out(&self, ours: &ComparisonRow) -> Vec<Verdict> {
        let open = self.named(BASELINE);
        let mut verdicts = vec![HELD_OUT_LOST.of(ours, "", f64::from(ours.lost))];
        for other in open.into_iter().chain(self.named(DELIVERED)) {
            let pair = [ours, other];
            verdicts.push(HELD_OUT_RMS.above(pair, ComparisonRow::controlled_rms_um));
            verdicts.push(HELD_OUT_MAX.above(pair, ComparisonRow::controlled_max_um));
        }
        verdicts.extend(open.map(|open| HELD_OUT_UNCUT.above([ours, open], |row| row.uncut_um)));
        verdicts
    }

    fn best_without_model(&self) -> Option<&'a ComparisonRow> {
        self.best(&[Knows::Nothing, Knows::Identified])
    }

    /// Returns the completed rows of peers whose kind of knowledge is in `known` and concerns their
    /// own machine. The limit and the default are no peers.
    fn peers(&self, known: &[Knows]) -> impl Iterator<Item = &'a ComparisonRow> {
        self.0.iter().filter(|row| {
            let is_other = row.controller != BEST && row.controller != LIMIT;
            let is_known = |peer: Competitor| {
                peer.knowledge == Knowledge::Own && known.contains(&peer.entry.knows)
            };
            let peer = Competitor::find(&row.controller);
            is_other && row.completed && peer.is_some_and(is_known)
        })
    }

    /// The best of these, uncorrected among them; none where the uncorrected cut is alone.
    fn best(&self, known: &[Knows]) -> Option<&'a ComparisonRow> {
        self.peers(known).find(|row| row.controller != BASELINE)?;
        let rms_um = ComparisonRow::controlled_rms_um;
        self.peers(known)
            .min_by(|a, b| rms_um(a).total_cmp(&rms_um(b)))
    }
}

#[cfg(test)]
mod tests;
