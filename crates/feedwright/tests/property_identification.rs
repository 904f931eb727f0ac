//! What an identification finds does not depend on what the machine does not depend on: when it was
//! recorded, in which order its axes stand, how far away its zero is, and, but for friction, in
//! which unit it was written.

use crate::identification_log::{drawn, log_of};
use feedwright::LogJob;
use feedwright_ident::{FoundAxis, Log};
use feedwright_sim::Machine;

const PRODUCTS: [&str; 3] = [
    "kp_kv_over_j_1_s2",
    "kv_plus_b_over_j_1_s",
    "fc_over_j_mm_s2",
];

fn log(seed: u64) -> Log {
    log_of(&Machine::load("tnv40".as_ref()).unwrap(), 2.0, 0.5, seed)
}

fn axes(log: Log) -> Vec<FoundAxis> {
    LogJob::default().run(log, &()).unwrap().machine.axes
}

fn products(axis: &FoundAxis) -> [f64; 3] {
    PRODUCTS.map(|key| {
        axis.numbers()
            .into_iter()
            .find(|number| number.key == key)
            .unwrap()
            .value
    })
}

#[test]
fn another_time_and_another_order_of_the_axes_change_nothing() {
    let first = log(11);
    let mut later = first.clone();
    later.time_s.iter_mut().for_each(|time_s| *time_s += 1024.0);
    later.axes.reverse();
    let (first, mut later) = (axes(first), axes(later));
    later.reverse();
    for (a, b) in first.iter().zip(&later) {
        assert_eq!(
            (a.values, &a.terms, &a.half_intervals),
            (b.values, &b.terms, &b.half_intervals),
            "{}",
            a.name
        );
        assert_eq!(a.scores.grey_box, b.scores.grey_box);
    }
}

#[test]
fn another_zero_and_another_unit_change_the_products_by_nothing_but_the_unit() {
    let mut state = 7;
    {
        let mut first = log(1);
        first.axes.truncate(1);
        let (unit, zero_mm) = (
            0.5 + 2.0 * drawn(&mut state),
            200.0 * drawn(&mut state) - 100.0,
        );
        let mut other = first.clone();
        let axis = &mut other.axes[0];
        axis.command_mm
            .iter_mut()
            .chain(&mut axis.actual_mm)
            .for_each(|mm| *mm = unit * *mm + zero_mm);
        axis.step_mm *= unit;
        let [first, other] = [first, other].map(|log| products(&axes(log)[0]));
        for (i, wanted) in [first[0], first[1], unit * first[2]]
            .into_iter()
            .enumerate()
        {
            assert!(
                (other[i] / wanted - 1.0).abs() < 0.03,
                "{}: {} for {wanted}, {unit}",
                PRODUCTS[i],
                other[i]
            );
        }
    }
}

#[test]
fn a_log_of_any_length_is_fitted_by_no_more_than_its_share_of_samples() {
    let mut long = log(5);
    long.axes.truncate(1);
    // The same motion again and again, 240,000 samples, between standstill without information.
    let times = 120;
    let once = long.time_s.len();
    let again = |values: &[f64]| {
        values
            .iter()
            .copied()
            .cycle()
            .take(times * once)
            .collect::<Vec<f64>>()
    };
    let axis = &mut long.axes[0];
    (axis.command_mm, axis.actual_mm) = (again(&axis.command_mm), again(&axis.actual_mm));
    long.time_s = (0..times * once)
        .map(|k| k as f64 * long.sample_time_s)
        .collect();
    long.stretches = (0..times).map(|i| i * once..(i + 1) * once).collect();
    let found = feedwright::informative(long);
    assert_eq!(found.1, Some(times * once));
    assert!(
        found.0.time_s.len() <= 200_000 && found.0.time_s.len() > 100_000,
        "{}",
        found.0.time_s.len()
    );
    assert_eq!(
        found
            .0
            .stretches
            .iter()
            .map(ExactSizeIterator::len)
            .sum::<usize>(),
        found.0.time_s.len()
    );
    assert!(
        found
            .0
            .axes
            .iter()
            .all(|axis| axis.command_mm.len() == found.0.time_s.len())
    );
}
