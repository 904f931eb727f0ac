//! Noise seeds: those that are reported, and that of everything before. Settings are searched, machines are identified with the seed
//! of the machine file; no reported cut has it. A machine without noise is cut once.

use crate::machine::Machine;

/// Noise seeds of one seed of the comparison, at the most.
pub const MAX_SEEDS: u32 = 1000;

/// The noise seeds that a machine is cut with.
pub(super) fn reported(machine: &Machine, seed: u64, count: u32) -> Vec<u64> {
    let of_file = machine.noise.seed;
    if !machine.is_noisy() {
        return vec![of_file];
    }
    let first = seed.wrapping_mul(u64::from(MAX_SEEDS) + 1).wrapping_add(1);
    (0..).map(|k| first.wrapping_add(k)).filter(|&other| other != of_file).take(count.max(1) as usize).collect()
}

/// The median, lowest and highest; of an even number the mean of the middle two.
pub(super) fn median_and_spread(values: impl IntoIterator<Item = f64>) -> (f64, [f64; 2]) {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    let (Some(&low), Some(&high)) = (values.first(), values.last()) else { return (f64::NAN, [f64::NAN; 2]) };
    let middle = values.len() / 2;
    let median =
        if values.len().is_multiple_of(2) { 0.5 * (values[middle - 1] + values[middle]) } else { values[middle] };
    (median, [low, high])
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
        assert_eq!(reported(&noisy.with_noise_seed(1003), 1, 3), [1002, 1004, 1005]);
        assert!(reported(&noisy, 2, 6).iter().all(|seed| !all.contains(seed)));
    }

    #[test]
    fn the_median_of_an_even_number_is_the_mean_of_the_middle_two() {
        assert_eq!(median_and_spread([3.0, 1.0, 2.0]), (2.0, [1.0, 3.0]));
        assert_eq!(median_and_spread([4.0, 1.0, 2.0, 3.0]), (2.5, [1.0, 4.0]));
        assert_eq!(median_and_spread([7.0]), (7.0, [7.0, 7.0]));
    }
}
