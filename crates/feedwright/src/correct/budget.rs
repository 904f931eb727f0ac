//! Limits on the blocks and the time that a corrected program adds to the original.

/// A stretch may take longer by this fraction of its programmed time and by [`STRETCH_DWELLS`].
const MORE_TIME: f64 = 0.065;
/// Extra time that a stretch may take, in dwells: the rests at both of its ends, and the same time
/// again if the other stretches do not use it.
const STRETCH_DWELLS: f64 = 3.0;
/// Extra time that a program may take for itself and for each stretch that is not a detail, in
/// dwells.
const MORE_DWELLS: f64 = 1.5;
/// A program may take longer by this fraction of its time, rests and rapids included: with one
/// stretch, and with several. Where it takes longer, its rests get shorter.
const PROGRAM_MORE_TIME: [f64; 2] = [0.045, 0.09];
/// The limit for few blocks is the programmed number times this factor, plus [`FEW_MORE_1`] blocks
/// for each time constant of the position loop. [`FEW_MORE`] bounds the second part.
const FEW_BLOCKS: f64 = 1.15;
const FEW_MORE_1: f64 = 0.32;
const FEW_MORE: [f64; 2] = [4.0, 150.0];
/// A stretch with more straight blocks than this counts as a curve made of chords if they are more
/// than half of its blocks. Its fine fit may have no more blocks than the stretch has as
/// programmed.
const CHORDS: usize = 40;
/// The limit for many blocks is the larger of two numbers: the programmed blocks times this factor,
/// or [`MANY_1_S`] blocks per second plus [`MANY_MORE`]. Details have only the limit for few
/// blocks. A serial line of 19,200 baud carries 60 blocks of 32 characters in a second.
const MANY_BLOCKS: f64 = 10.0;
const MANY_1_S: f64 = 60.0;
const MANY_MORE: f64 = 20.0;
/// A stretch that takes fewer time constants of the position loop than this is a detail.
const DETAIL: f64 = 12.5;
/// A program may have the original number of blocks times this factor, plus [`PROGRAM_MORE`]
/// blocks, plus [`STRETCH_MORE`] blocks for each stretch that is not a detail; or [`MANY_1_S`]
/// blocks per second where that is more.
const PROGRAM_BLOCKS: f64 = 1.15;
const PROGRAM_MORE: f64 = 30.0;
const STRETCH_MORE: f64 = 15.0;
/// A program may take longer by this fraction of the programmed time of its stretches, and by
/// [`MORE_DWELLS`] for itself and for each stretch that is not a detail.
const PROGRAM_TIME: f64 = 0.065;

/// Size of a stretch as programmed.
#[derive(Debug, Clone, Copy)]
pub(super) struct StretchBudget {
    pub(super) time_s: f64,
    pub(super) blocks: usize,
    /// Straight blocks among `blocks`.
    pub(super) lines: usize,
    /// Time constant of the position loop, s.
    pub(super) loop_s: f64,
}

/// Returns the time by which a program may take longer than `time_s`, s; the fraction depends on
/// whether it has several stretches or one.
pub(super) fn program_more_s(time_s: f64, several: bool) -> f64 {
    PROGRAM_MORE_TIME[usize::from(several)] * time_s
}

impl StretchBudget {
    /// Returns the limit for few blocks and the limit for many blocks.
    pub(super) fn most_blocks(&self) -> [f64; 2] {
        let blocks = self.blocks as f64;
        let few = FEW_BLOCKS * blocks
            + (FEW_MORE_1 * self.time_s / self.loop_s).clamp(FEW_MORE[0], FEW_MORE[1]);
        let many = (MANY_BLOCKS * blocks).max(MANY_1_S * self.time_s + MANY_MORE);
        [few, if self.is_detail() { few } else { few.max(many) }]
    }

    /// Returns the largest number of blocks for a fine fit, used where a coarser fit would need
    /// fewer.
    pub(super) fn most_fine_blocks(&self) -> f64 {
        let chords = self.lines > CHORDS && 2 * self.lines > self.blocks;
        if chords {
            self.blocks as f64
        } else {
            self.most_blocks()[0]
        }
    }

    /// Returns the longest time that the stretch may take, s.
    pub(super) fn most_s(&self, dwell_s: f64) -> f64 {
        (1.0 + MORE_TIME) * self.time_s + STRETCH_DWELLS * dwell_s
    }

    /// Returns true if the stretch is a detail: so short that it shares the limits of the program
    /// with the other stretches.
    pub(super) fn is_detail(&self) -> bool {
        self.time_s < DETAIL * self.loop_s
    }
}

/// Cost and gain of a new command for a stretch.
#[derive(Debug, Clone, Copy)]
pub(super) struct StretchCost {
    pub(super) budget: StretchBudget,
    /// Blocks added to the program, rests included.
    pub(super) blocks: f64,
    /// Time added to the program, rests included, s.
    pub(super) time_s: f64,
    /// Sum of squared errors that the command removes, mm2; none where the stretch stays as it is.
    pub(super) gain_mm2: Option<f64>,
}

/// Indices of the details to give up so that the program keeps its limits on blocks and time. The
/// details with the least gain per block come first. `other_motions` is the number of motions
/// outside of the stretches.
pub(super) fn details_to_give_up(
    costs: &[StretchCost],
    other_motions: usize,
    dwell_s: f64,
) -> Vec<usize> {
    let larger = costs.iter().filter(|cost| !cost.budget.is_detail()).count() as f64;
    let all = other_motions as f64
        + costs
            .iter()
            .map(|cost| cost.budget.blocks as f64)
            .sum::<f64>();
    let programmed_s: f64 = costs.iter().map(|cost| cost.budget.time_s).sum();
    let blocks = PROGRAM_BLOCKS * all + PROGRAM_MORE + STRETCH_MORE * larger;
    let mut room = blocks.max(MANY_1_S * programmed_s) - all;
    let mut room_s = PROGRAM_TIME * programmed_s + MORE_DWELLS * dwell_s * (1.0 + larger);
    for cost in costs {
        (room, room_s) = (room - cost.blocks, room_s - cost.time_s);
    }
    let worth = |k: usize| costs[k].gain_mm2.unwrap_or(0.0) / costs[k].blocks.max(1.0);
    let mut order: Vec<usize> = (0..costs.len())
        .filter(|&k| costs[k].gain_mm2.is_some() && costs[k].budget.is_detail())
        .collect();
    order.sort_by(|&a, &b| worth(a).total_cmp(&worth(b)));
    let mut given_up = Vec::new();
    for k in order {
        if room >= 0.0 && room_s >= 0.0 {
            break;
        }
        (room, room_s) = (room + costs[k].blocks, room_s + costs[k].time_s);
        given_up.push(k);
    }
    given_up
}

/// Indices of the stretches to give up so that a program takes `more_s` less: those that `may` be
/// given up, with the least gain for their time first.
pub(super) fn slow_to_give_up(
    costs: &[StretchCost],
    more_s: f64,
    may: impl Fn(usize) -> bool,
) -> Vec<usize> {
    let worth = |k: usize| costs[k].gain_mm2.unwrap_or(0.0) / costs[k].time_s;
    let mut order: Vec<usize> = (0..costs.len())
        .filter(|&k| costs[k].gain_mm2.is_some() && costs[k].time_s > 0.0 && may(k))
        .collect();
    order.sort_by(|&a, &b| worth(a).total_cmp(&worth(b)));
    let mut saved_s = 0.0;
    order.retain(|&k| {
        let needed = saved_s < more_s;
        saved_s += costs[k].time_s;
        needed
    });
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn details_of_the_least_gain_for_a_block_are_given_up_until_there_is_room() {
        let detail = StretchBudget {
            time_s: 0.01,
            blocks: 1,
            lines: 1,
            loop_s: 0.02,
        };
        let cost = |gain_mm2: f64| StretchCost {
            budget: detail,
            blocks: 20.0,
            time_s: 0.01,
            gain_mm2: Some(gain_mm2),
        };
        // Three details and room for 30 blocks and a little: one of 20 may stay.
        assert_eq!(
            details_to_give_up(&[cost(2.0), cost(1.0), cost(3.0)], 0, 0.05),
            [1, 0]
        );
        let larger = StretchBudget {
            time_s: 1.0,
            ..detail
        };
        let costs = [
            StretchCost {
                budget: larger,
                ..cost(1.0)
            },
            cost(1.0),
        ];
        assert_eq!(details_to_give_up(&costs, 0, 0.05), [0; 0]);
    }

    #[test]
    fn slow_stretches_are_given_up_until_the_time_is_saved() {
        let budget = StretchBudget {
            time_s: 10.0,
            blocks: 1,
            lines: 1,
            loop_s: 0.02,
        };
        let cost = |time_s: f64, gain_mm2: f64| StretchCost {
            budget,
            blocks: 0.0,
            time_s,
            gain_mm2: Some(gain_mm2),
        };
        let costs = [
            cost(1.0, 4.0),
            cost(2.0, 2.0),
            cost(1.0, 3.0),
            cost(-1.0, 1.0),
            cost(1.0, 0.1),
        ];
        assert_eq!(slow_to_give_up(&costs, 2.5, |k| k != 4), [1, 2]);
        assert_eq!(slow_to_give_up(&costs, 0.0, |_| true), [0; 0]);
    }

    #[test]
    fn a_program_may_take_its_share_longer_and_twice_that_with_several_stretches() {
        assert_eq!(
            [false, true].map(|several| program_more_s(200.0, several)),
            [9.0, 18.0]
        );
    }

    #[test]
    fn a_stretch_may_take_its_share_and_three_dwells_longer() {
        let stretch = StretchBudget {
            time_s: 2.0,
            blocks: 1,
            lines: 1,
            loop_s: 0.02,
        };
        // 2.13 s and 0.12 s.
        assert!(
            (stretch.most_s(0.04) - 2.25).abs() < 1e-12,
            "{}",
            stretch.most_s(0.04)
        );
    }

    #[test]
    fn details_are_given_up_until_the_program_takes_no_more_than_its_share_of_time_longer() {
        // The program takes 10.4 s. It may take 6.5 % longer, and 1.5 dwells of 0.04 s for itself
        // and for its larger stretch: 0.796 s in all. The larger stretch takes 0.14 s of that, so
        // three details of 0.2 s each may stay.
        let stretch = |time_s: f64| StretchBudget {
            time_s,
            blocks: 1,
            lines: 1,
            loop_s: 0.02,
        };
        let cost = |time_s: f64, more_s: f64, gain_mm2: f64| StretchCost {
            budget: stretch(time_s),
            blocks: 0.0,
            time_s: more_s,
            gain_mm2: Some(gain_mm2),
        };
        let larger = cost(10.0, 0.14, 9.0);
        let details = [3.0, 1.0, 4.0, 2.0].map(|gain_mm2| cost(0.1, 0.2, gain_mm2));
        let costs: Vec<StretchCost> = std::iter::once(larger).chain(details).collect();
        assert_eq!(details_to_give_up(&costs, 0, 0.04), [2]);
        assert_eq!(details_to_give_up(&costs[..4], 0, 0.04), [0; 0]);
    }
}
