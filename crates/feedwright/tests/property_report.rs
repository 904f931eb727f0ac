//! Properties of the bounded record and of the statistics, whatever the rows.

use feedwright::{RunFacts, Series, Statistics};
use feedwright_sim::{Commanded, Row, Sink};
use proptest::prelude::*;

/// Rows enough for a record to halve twice.
const ROWS: usize = 2 * Series::MAX_POINTS + 777;

/// The row of a tool that is `error_mm` to the left of its foot.
fn beside(row: Row, error_mm: f64) -> Row {
    let ([x, y, z], [along_x, along_y, _]) = (row.foot_mm, row.tangent);
    Row {
        act_mm: [x - error_mm * along_y, y + error_mm * along_x, z],
        contour_error_mm: error_mm,
        ..row
    }
}

/// A run with spikes at given rows and rapids at given stretches.
fn rows(spikes: &[(usize, f64)], rapids: &[(usize, usize)]) -> Vec<Row> {
    let mut rows: Vec<Row> = (0..ROWS)
        .map(|k| {
            let t_s = k as f64 * 1e-3;
            let path_mm = [20.0 * (0.3 * t_s).cos(), 20.0 * (0.7 * t_s).sin(), 0.0];
            let along = [-6.0 * (0.3 * t_s).sin(), 14.0 * (0.7 * t_s).cos()];
            let speed = along[0].hypot(along[1]);
            let row = Row {
                t_s,
                s_mm: 10.0 * t_s,
                line: 1 + k as u32 / 500,
                feed_plan_mm_s: 10.0,
                programmed_mm_s: 0.0,
                cutting: !rapids
                    .iter()
                    .any(|&(start, length)| (start..start + length).contains(&k)),
                commanded: Commanded::Cut,
                path_mm,
                cmd_mm: path_mm,
                corrected_mm: path_mm,
                act_mm: path_mm,
                torque_nm: [0.1 * t_s.sin(), 0.0, 0.0],
                foot_mm: path_mm,
                tangent: [along[0] / speed, along[1] / speed, 0.0],
                contour_error_mm: 0.0,
            };
            beside(row, 1e-3 * (2.0 * t_s).sin())
        })
        .collect();
    for &(k, error_mm) in spikes {
        rows[k] = beside(rows[k], error_mm);
    }
    rows
}

fn record(rows: &[Row]) -> (Series, Statistics) {
    let (mut series, mut statistics) = (Series::new(), Statistics::new());
    for row in rows {
        series.row(row).unwrap();
        statistics.row(row).unwrap();
    }
    (series, statistics)
}

fn jobs() -> impl Strategy<Value = Vec<Row>> {
    let spikes = prop::collection::vec((0..ROWS, -0.1..0.1f64), 0..30);
    let rapids = prop::collection::vec((0..ROWS, 0..3000usize), 0..5);
    (spikes, rapids).prop_map(|(spikes, rapids)| rows(&spikes, &rapids))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn a_record_is_bounded_in_order_and_loses_no_peak(rows in jobs()) {
        let (series, _) = record(&rows);
        let points: Vec<_> = series.points().collect();
        prop_assert!(points.len() <= Series::MAX_POINTS);
        prop_assert!(points.windows(2).all(|p| p[0].t_s < p[1].t_s));
        let cut = || rows.iter().filter(|r| r.cutting).map(|r| r.contour_error_mm);
        let drawn = || points.iter().filter(|p| p.cutting);
        prop_assert_eq!(cut().fold(0.0, f64::max), drawn().map(|p| p.error_max_mm).fold(0.0, f64::max));
        prop_assert_eq!(cut().fold(0.0, f64::min), drawn().map(|p| p.error_min_mm).fold(0.0, f64::min));
        for p in &points {
            let (low, high) = (p.error_min_mm, p.error_max_mm);
            prop_assert!(p.error_mm == low || p.error_mm == high, "{:?}", p);
            let length = p.deviation_mm.iter().map(|x| x * x).sum::<f64>().sqrt();
            prop_assert!((length - p.error_mm.abs()).abs() < 1e-12, "{:?}", p);
        }
    }

    #[test]
    fn statistics_agree_with_all_rows_at_once(rows in jobs()) {
        let (_, statistics) = record(&rows);
        let summary = statistics.summary(RunFacts { axes: 2, ..RunFacts::default() }, |line| line.to_string());
        let errors_um: Vec<f64> = rows.iter().filter(|r| r.cutting).map(|r| r.contour_error_mm * 1e3).collect();
        let rms_um = (errors_um.iter().map(|e| e * e).sum::<f64>() / errors_um.len() as f64).sqrt();
        let max_um = errors_um.iter().fold(0.0, |m: f64, e| m.max(e.abs()));
        prop_assert!((summary.rms_um - rms_um).abs() < 1e-9 * rms_um);
        prop_assert!((summary.max_um - max_um).abs() < 1e-12 * max_um);
        prop_assert_eq!(summary.histogram.counts.iter().sum::<u64>(), errors_um.len() as u64);
    }

    #[test]
    fn the_worst_places_are_the_worst_and_apart(rows in jobs()) {
        let (_, statistics) = record(&rows);
        let summary = statistics.summary(RunFacts::default(), |line| line.to_string());
        prop_assert!(summary.worst.len() <= 10);
        prop_assert!((summary.worst[0].error_um.abs() - summary.max_um).abs() < 1e-9);
        for (i, a) in summary.worst.iter().enumerate() {
            prop_assert_eq!(&a.text, &a.line.to_string());
            for b in &summary.worst[i + 1..] {
                prop_assert!(a.error_um.abs() >= b.error_um.abs());
                prop_assert!((a.s_mm - b.s_mm).abs() >= 0.5 && (a.t_s - b.t_s).abs() >= 0.010, "{:?} {:?}", a, b);
            }
        }
    }
}
