//! What is claimed of the receding horizon, row by row: value, limit, and whether it holds.

use serde::{Deserialize, Serialize};

use super::table::{ComparisonRow, knows};
use super::{IDENTIFIED_HERE, Workpiece};
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

/// The peer that has the exact model and unlimited computing time: a bound on what can be reached, not a competitor.
const UPPER_BOUND: &str = "model-predictive";

/// What is claimed, and the largest ratio at which it holds.
struct Claim(&'static str, f64);

// On the nominal machine, contours without corners.
const RMS_OPEN_LOOP: Claim = Claim("RMS against open loop", 0.045);
const MAX_OPEN_LOOP: Claim = Claim("max against open loop", 0.10);
const RMS_BEST_PEER: Claim = Claim("RMS against the best peer without model", 0.25);
const RMS_EXACT_MODEL: Claim = Claim("RMS against the exact model", 1.2);
// On the nominal machine, contours with corners.
const RMS_CORNERS: Claim = Claim("RMS at corners against the best peer", 1.0);
const MAX_CORNERS: Claim = Claim("max at corners against the best peer", 1.0);
// On all other machines.
const RMS_UNSEEN: Claim = Claim("RMS, unseen machine, against the best peer without model", 0.5);
const RMS_IDENTIFIED: Claim = Claim("RMS, identified machine, against the best peer without model", 0.25);

impl Claim {
    /// What a row makes of it: `value` is its ratio to the row of `against`.
    fn of(&self, row: &ComparisonRow, against: &str, value: f64) -> Verdict {
        let Self(claim, limit) = *self;
        Verdict {
            claim: claim.to_owned(),
            contour: row.contour.clone(),
            machine: row.machine.clone(),
            against: against.to_owned(),
            value,
            limit,
            holds: value <= limit && row.completed && row.time_ratio <= SAME_TIME,
        }
    }

    fn of_rms(&self, row: &ComparisonRow, against: &ComparisonRow) -> Verdict {
        self.of(row, &against.controller, row.rms_um / against.rms_um)
    }

    fn of_max(&self, row: &ComparisonRow, against: &ComparisonRow) -> Verdict {
        self.of(row, &against.controller, row.max_um / against.max_um)
    }
}

/// All claims that the rows can bear out.
pub(super) fn verdicts(rows: &[ComparisonRow], nominal: &str, workpieces: &[Workpiece]) -> Vec<Verdict> {
    let is_smooth = |contour: &str| workpieces.iter().any(|workpiece| workpiece.name == contour && workpiece.smooth);
    let of_contour_and_machine = |ours: &ComparisonRow| {
        let here: Vec<&ComparisonRow> =
            rows.iter().filter(|row| row.contour == ours.contour && row.machine == ours.machine).collect();
        match (ours.machine == nominal, is_smooth(&ours.contour)) {
            (true, true) => without_corners(ours, &here),
            (true, false) => with_corners(ours, &here),
            (false, _) => elsewhere(ours, &here),
        }
    };
    rows.iter().filter(|row| row.controller == BEST).flat_map(of_contour_and_machine).collect()
}

fn without_corners(ours: &ComparisonRow, here: &[&ComparisonRow]) -> Vec<Verdict> {
    let bound = here.iter().find(|row| row.controller == UPPER_BOUND);
    let mut verdicts =
        vec![RMS_OPEN_LOOP.of(ours, BASELINE, ours.rms_ratio), MAX_OPEN_LOOP.of(ours, BASELINE, ours.max_ratio)];
    verdicts.extend(best_without_model(here).map(|peer| RMS_BEST_PEER.of_rms(ours, peer)));
    verdicts.extend(bound.map(|bound| RMS_EXACT_MODEL.of_rms(ours, bound)));
    verdicts
}

fn with_corners(ours: &ComparisonRow, here: &[&ComparisonRow]) -> Vec<Verdict> {
    let known = [Knows::Nothing, Knows::Identified, Knows::ExactModel];
    let on_rms = best(here, &known, |row| row.rms_um);
    let on_max = best(here, &known, |row| row.max_um);
    let rms = on_rms.map(|peer| RMS_CORNERS.of_rms(ours, peer));
    let max = on_max.map(|peer| MAX_CORNERS.of_max(ours, peer));
    rms.into_iter().chain(max).collect()
}

fn elsewhere(ours: &ComparisonRow, here: &[&ComparisonRow]) -> Vec<Verdict> {
    let Some(peer) = best_without_model(here) else { return Vec::new() };
    let home = here.iter().find(|row| row.controller == format!("{BEST}{IDENTIFIED_HERE}"));
    let mut verdicts = vec![RMS_UNSEEN.of_rms(ours, peer)];
    verdicts.extend(home.map(|home| RMS_IDENTIFIED.of_rms(home, peer)));
    verdicts
}

fn best_without_model<'a>(here: &[&'a ComparisonRow]) -> Option<&'a ComparisonRow> {
    best(here, &[Knows::Nothing, Knows::Identified], |row| row.rms_um)
}

/// Rows that came to their end of others that know no more than this; none that is identified anew.
fn peers<'a>(here: &[&'a ComparisonRow], known: &[Knows]) -> impl Iterator<Item = &'a ComparisonRow> {
    here.iter().copied().filter(|row| {
        let is_other =
            row.controller != BEST && row.controller != UPPER_BOUND && !row.controller.ends_with(IDENTIFIED_HERE);
        is_other && row.completed && knows(row).is_some_and(|knows| known.contains(&knows))
    })
}

/// The best of these, open loop among them; none where open loop is alone.
fn best<'a>(
    here: &[&'a ComparisonRow],
    known: &[Knows],
    number: fn(&ComparisonRow) -> f64,
) -> Option<&'a ComparisonRow> {
    peers(here, known).find(|row| row.controller != BASELINE)?;
    peers(here, known).min_by(|a, b| number(a).total_cmp(&number(b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TNV40: &str = "tnv40";

    fn row(contour: &str, machine: &str, controller: &str, [rms_um, max_um]: [f64; 2]) -> ComparisonRow {
        ComparisonRow {
            contour: contour.to_owned(),
            machine: machine.to_owned(),
            controller: controller.to_owned(),
            time_s: 1.0,
            rms_um,
            max_um,
            uncut_um: 0.0,
            max_deviation_um: 0.0,
            peak_torque_nm: 0.0,
            time_ratio: 1.0,
            // Of every open loop below.
            rms_ratio: rms_um / 10.0,
            max_ratio: max_um / 20.0,
            completed: true,
            faded_out: None,
            error_um: Vec::new(),
        }
    }

    /// What is compared with, the ratio in thousandths, and whether the claim holds.
    fn told(rows: &[ComparisonRow]) -> Vec<(String, f64, bool)> {
        let contours: Vec<Workpiece> = Workpiece::contours();
        let verdicts = verdicts(rows, TNV40, &contours);
        verdicts.into_iter().map(|v| (v.against, (v.value * 1e3).round(), v.holds)).collect()
    }

    fn of(against: &str, thousandths: f64, holds: bool) -> (String, f64, bool) {
        (against.to_owned(), thousandths, holds)
    }

    #[test]
    fn without_corners_four_claims_each_with_its_limit() {
        let rows = |ours: [f64; 2]| {
            [
                row("circle", TNV40, BASELINE, [10.0, 20.0]),
                row("circle", TNV40, "cross-coupled", [1.0, 3.0]),
                // It has the exact model: no peer without one.
                row("circle", TNV40, "feedforward", [0.01, 0.01]),
                row("circle", TNV40, UPPER_BOUND, [0.1, 0.2]),
                row("circle", TNV40, BEST, ours),
            ]
        };
        let good = [
            of(BASELINE, 11.0, true),
            of(BASELINE, 75.0, true),
            of("cross-coupled", 110.0, true),
            of(UPPER_BOUND, 1100.0, true),
        ];
        assert_eq!(told(&rows([0.11, 1.5])), good);
        let bad = [
            of(BASELINE, 50.0, false),
            of(BASELINE, 150.0, false),
            of("cross-coupled", 500.0, false),
            of(UPPER_BOUND, 5000.0, false),
        ];
        assert_eq!(told(&rows([0.5, 3.0])), bad);
    }

    #[test]
    fn at_corners_the_best_of_each_number_counts_open_loop_too() {
        let mut rows = vec![
            row("square", TNV40, BASELINE, [10.0, 20.0]),
            row("square", TNV40, "feedforward", [8.0, 25.0]),
            row("square", TNV40, "zero-phase", [1.0, 1.0]),
            row("square", TNV40, BEST, [8.4, 19.0]),
        ];
        // It did not come to its end.
        rows[2].completed = false;
        assert_eq!(told(&rows), [of("feedforward", 1050.0, false), of(BASELINE, 950.0, true)]);
    }

    #[test]
    fn elsewhere_the_unseen_and_the_identified_row_are_held_against_the_same_peer() {
        let rows = [
            row("circle", "rough", BASELINE, [10.0, 20.0]),
            row("circle", "rough", "contour-compensation", [4.0, 9.0]),
            row("circle", "rough", BEST, [2.4, 5.0]),
            row("circle", "rough", &format!("{BEST}{IDENTIFIED_HERE}"), [0.8, 2.0]),
        ];
        assert_eq!(told(&rows), [of("contour-compensation", 600.0, false), of("contour-compensation", 200.0, true)]);
    }

    #[test]
    fn nothing_holds_that_took_longer_or_did_not_end() {
        let mut rows = [row("circle", TNV40, BASELINE, [10.0, 20.0]), row("circle", TNV40, BEST, [0.1, 1.0])];
        assert_eq!(told(&rows), [of(BASELINE, 10.0, true), of(BASELINE, 50.0, true)]);
        rows[1].time_ratio = 1.001;
        assert_eq!(told(&rows), [of(BASELINE, 10.0, false), of(BASELINE, 50.0, false)]);
        rows[1].time_ratio = 1.0;
        rows[1].completed = false;
        assert_eq!(told(&rows), [of(BASELINE, 10.0, false), of(BASELINE, 50.0, false)]);
    }
}
