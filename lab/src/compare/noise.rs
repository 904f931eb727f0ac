//! Noise seeds of the reported cuts. Searches and identification use the noise seed of the machine
//! file, and no reported cut of a noisy machine uses it. A machine without noise is cut once.

use feedwright_sim::Machine;

/// Noise seeds of one seed of the comparison, at the most.
pub const MAX_SEEDS: u32 = 1000;

/// The noise seeds that a machine is cut with.
pub(super) fn reported(machine: &Machine, seed: u64, count: u32) -> Vec<u64> {
    let of_file = machine.noise.seed;
    if !machine.is_noisy() {
        return vec![of_file];
    }
    let first = seed.wrapping_mul(u64::from(MAX_SEEDS) + 1).wrapping_add(1);
    let others = (0..)
        .map(|k| first.wrapping_add(k))
        .filter(|&other| other != of_file);
    others.take(count.max(1) as usize).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_machine_without_noise_is_cut_once_and_no_other_with_the_seed_of_its_file() {
        let quiet = Machine::load("tnv40".as_ref()).unwrap();
        assert_eq!(reported(&quiet, 1, 6), [quiet.noise.seed]);
        let mut noisy = quiet;
        noisy.axes[1].encoder_noise_um = 0.1;
        let all = reported(&noisy, 1, 6);
        assert_eq!(all, [1002, 1003, 1004, 1005, 1006, 1007]);
        assert_eq!(
            reported(&noisy.with_noise_seed(1003), 1, 3),
            [1002, 1004, 1005]
        );
        assert!(
            reported(&noisy, 2, 6)
                .iter()
                .all(|seed| !all.contains(seed))
        );
    }
}
