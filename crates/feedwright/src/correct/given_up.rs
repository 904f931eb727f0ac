//! Gives up commands after a cut with all commands together.

use std::ops::RangeInclusive;

use super::budget::{StretchCost, slow_to_give_up};
use super::stretch_cut::StretchCut;
use super::stretch_rounds::StretchRounds;
use super::unchanged::UnchangedReason;
use crate::report::harm::{MAX_UM, RMS_UM};

/// Gives up the commands that make a stretch worse in a cut of all stretches together. Returns true
/// if any was given up.
///
/// A stretch that stays as programmed can be worse at its start because of the command of the
/// stretch before it. That command is judged by the largest error of both stretches.
pub(super) fn give_up_culprits(under_way: &mut [StretchRounds], cuts: &[StretchCut]) -> bool {
    let is_worse = |range: RangeInclusive<usize>| {
        let programmed = StretchCut::together(
            under_way[range.clone()]
                .iter()
                .map(|stretch| &stretch.programmed),
        );
        StretchCut::together(&cuts[range]).max_mm > programmed.max_mm + 1e-3 * MAX_UM
    };
    let has_command = |k: usize| under_way[k].best.is_some();
    let culprit = |k: usize| {
        let culprit = if has_command(k) { k } else { k.checked_sub(1)? };
        (has_command(culprit) && is_worse(k..=k) && is_worse(culprit..=k)).then_some(culprit)
    };
    let culprits: Vec<usize> = (0..under_way.len()).filter_map(culprit).collect();
    for &k in &culprits {
        under_way[k].take_back(UnchangedReason::Worse);
    }
    !culprits.is_empty()
}

/// Gives up commands until the RMS error of the common cut is no worse than the RMS error of the
/// uncorrected program. The commands that add the most error go first. Returns true if any was
/// given up.
pub(super) fn give_up_losses(under_way: &mut [StretchRounds], cuts: &[StretchCut]) -> bool {
    let programmed = StretchCut::together(under_way.iter().map(|stretch| &stretch.programmed));
    let mut left = StretchCut::together(cuts);
    let loss_mm2 = |k: usize| cuts[k].square_sum_mm2 - under_way[k].programmed.square_sum_mm2;
    let mut order: Vec<usize> = (0..cuts.len())
        .filter(|&k| under_way[k].best.is_some() && loss_mm2(k) > 0.0)
        .collect();
    order.sort_by(|&a, &b| loss_mm2(b).total_cmp(&loss_mm2(a)));
    let losses: Vec<(usize, f64)> = order.into_iter().map(|k| (k, loss_mm2(k))).collect();
    let mut any = false;
    for (k, loss_mm2) in losses {
        if left.rms_mm() <= programmed.rms_mm() + 1e-3 * RMS_UM {
            break;
        }
        left.square_sum_mm2 -= loss_mm2;
        left.cutting = left.cutting + under_way[k].programmed.cutting - cuts[k].cutting;
        under_way[k].take_back(UnchangedReason::Worse);
        any = true;
    }
    any
}

/// Gives up the commands that gain the least for their time, until `more_s` is saved. Only
/// stretches qualify whose largest error is no more than the largest error of the stretches that
/// stay unchanged. Returns true if any was given up.
pub(super) fn give_up_slow(own: &mut [StretchRounds], more_s: f64, dwell_s: f64) -> bool {
    let unchanged = own.iter().filter(|stretch| stretch.best.is_none());
    let left_mm = unchanged
        .map(|stretch| stretch.programmed.max_mm)
        .fold(0.0, f64::max);
    let costs: Vec<StretchCost> = own.iter().map(|stretch| stretch.cost(dwell_s)).collect();
    let given_up = slow_to_give_up(&costs, more_s, |k| own[k].programmed.max_mm <= left_mm);
    for &k in &given_up {
        own[k].take_back(UnchangedReason::Detail);
    }
    !given_up.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correct::budget::StretchBudget;
    use crate::correct::stretches::NewMotions;

    /// A cut with this largest error, mm, and no other.
    fn cut_with(max_mm: f64) -> StretchCut {
        StretchCut {
            max_mm,
            ..StretchCut::default()
        }
    }

    /// Stretches of 10 um of programmed error; those that are listed have another command.
    fn stretches_with_commands(count: usize, changed: &[usize]) -> Vec<StretchRounds> {
        let command = NewMotions {
            motions: Vec::new(),
            approach: None,
            settles: false,
        };
        let budget = StretchBudget {
            time_s: 1.0,
            blocks: 1,
            lines: 0,
            loop_s: 0.02,
        };
        let stretch = |k: usize| {
            let mut stretch = StretchRounds::begun(&cut_with(0.01), budget, 1e5);
            stretch.best = changed.contains(&k).then(|| command.clone());
            stretch
        };
        (0..count).map(stretch).collect()
    }

    /// Stretches that keep their command behind a cut with these largest errors, mm, and whether
    /// one was worse.
    fn kept(changed: &[usize], max_mm: &[f64]) -> (Vec<usize>, bool) {
        let mut under_way = stretches_with_commands(max_mm.len(), changed);
        let cuts: Vec<StretchCut> = max_mm.iter().copied().map(cut_with).collect();
        let any = give_up_culprits(&mut under_way, &cuts);
        (
            (0..max_mm.len())
                .filter(|&k| under_way[k].best.is_some())
                .collect(),
            any,
        )
    }

    #[test]
    fn a_command_that_makes_its_stretch_worse_is_given_up() {
        assert_eq!(kept(&[0, 1, 2], &[0.001, 0.012, 0.001]), (vec![0, 2], true));
        // By no more than 1 um it is not worse.
        assert_eq!(
            kept(&[0, 1, 2], &[0.001, 0.0109, 0.001]),
            (vec![0, 1, 2], false)
        );
    }

    #[test]
    fn a_stretch_as_programmed_that_is_worse_is_blamed_on_the_command_before_it() {
        assert_eq!(kept(&[0, 1], &[0.001, 0.001, 0.012]), (vec![0], true));
        // The one before it has none, and nobody is to blame.
        assert_eq!(kept(&[0], &[0.001, 0.001, 0.012]), (vec![0], false));
        // No command is before the first.
        assert_eq!(kept(&[1], &[0.012, 0.001]), (vec![1], false));
    }

    #[test]
    fn a_command_stays_that_costs_the_next_stretch_less_than_it_gains() {
        let after = |max_mm: f64| {
            let mut under_way = stretches_with_commands(2, &[0]);
            (under_way[0].programmed, under_way[1].programmed) = (cut_with(0.03), cut_with(0.0001));
            let cuts = [0.002, max_mm].map(cut_with);
            (
                give_up_culprits(&mut under_way, &cuts),
                under_way[0].best.is_some(),
            )
        };
        assert_eq!(after(0.0022), (false, true));
        assert_eq!(after(0.0312), (true, false));
    }

    #[test]
    fn commands_of_the_largest_loss_are_given_up_until_the_rms_error_is_no_worse() {
        // Of 100 rows each, with errors of 1 um as they are programmed.
        let cut = |rms_um: f64| StretchCut {
            square_sum_mm2: 1e-4 * rms_um * rms_um,
            cutting: 100,
            ..StretchCut::default()
        };
        let left = |rms_um: [f64; 3]| {
            let mut under_way = stretches_with_commands(3, &[0, 1, 2]);
            under_way
                .iter_mut()
                .for_each(|stretch| stretch.programmed = cut(1.0));
            let any = give_up_losses(&mut under_way, &rms_um.map(cut));
            (
                (0..3)
                    .filter(|&k| under_way[k].best.is_some())
                    .collect::<Vec<_>>(),
                any,
            )
        };
        // A gain in one outweighs a loss in another.
        assert_eq!(left([1.3, 0.2, 0.9]), (vec![0, 1, 2], false));
        assert_eq!(left([1.2, 1.5, 0.9]), (vec![0, 2], true));
        assert_eq!(left([2.0, 3.0, 0.9]), (vec![2], true));
        assert_eq!(left([1.5, 3.0, 0.9]), (vec![2], true));
    }
}
