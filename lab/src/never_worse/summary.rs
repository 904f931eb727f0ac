//! Totals, quantiles, and failures by their severity.

use serde::Serialize;

use super::cut::SweepRow;
use super::verdict::Failure;

/// Ratios to the uncorrected cut mean something above this uncorrected RMS error, um.
pub(crate) const UNCORRECTED_UM: f64 = 1.0;

/// Quantiles of a number over many cuts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Quantiles {
    /// Number of cuts.
    pub cuts: usize,
    /// Half of them are below.
    pub median: f64,
    /// 90 % are below.
    pub p90: f64,
    /// 99 % are below.
    pub p99: f64,
    /// The largest.
    pub largest: f64,
}

impl Quantiles {
    /// None of nothing.
    pub fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        let quantile =
            |part: f64| values[((part * values.len() as f64) as usize).min(values.len() - 1)];
        let of = || Self {
            cuts: values.len(),
            median: quantile(0.5),
            p90: quantile(0.9),
            p99: quantile(0.99),
            largest: quantile(1.0),
        };
        (!values.is_empty()).then(of)
    }
}

/// A row and what is wrong with it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Judged {
    /// The row.
    #[serde(flatten)]
    pub row: SweepRow,
    /// Ways in which the cut is worse.
    pub faults: Vec<Failure>,
    /// Largest excess over uncorrected, in what is allowed.
    pub severity: f64,
}

/// Summary of a sweep.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweepSummary {
    /// Cuts that were judged.
    pub judged: usize,
    /// Cuts whose uncorrected cut is lost itself.
    pub not_judged: usize,
    /// Cuts that are worse in any way.
    pub worse: usize,
    /// Cuts that are worse in each way.
    pub by_fault: Vec<(Failure, usize)>,
    /// RMS contour error over the uncorrected one, all judged cuts.
    pub rms_ratio: Option<Quantiles>,
    /// The same on rigid machines without encoder steps and delay, where the uncorrected cut is
    /// above [`UNCORRECTED_UM`].
    pub rms_ratio_rigid: Option<Quantiles>,
    /// Median of the part of the time during which the controller was in the loop.
    pub engaged_share: Option<f64>,
    /// Machining time of all cuts, one way, s.
    pub machining_s: f64,
    /// Cuts that are worse, worst first, then all others in the order in which they were asked for.
    pub rows: Vec<Judged>,
}

impl SweepSummary {
    /// Summarizes these rows.
    pub fn of(rows: Vec<SweepRow>) -> Self {
        let judge = |row: SweepRow| Judged {
            faults: row.faults(),
            severity: row.severity(),
            row,
        };
        let mut rows: Vec<Judged> = rows.into_iter().map(judge).collect();
        let machining_s = rows
            .iter()
            .map(|judged| judged.row.uncorrected.time_s)
            .sum();
        // Stable: equals stay in order.
        rows.sort_by(|a, b| match (a.faults.is_empty(), b.faults.is_empty()) {
            (false, false) => b.severity.total_cmp(&a.severity),
            (is_good, other) => is_good.cmp(&other),
        });
        let judged: Vec<&Judged> = rows
            .iter()
            .filter(|judged| judged.row.is_judged())
            .collect();
        let having = |fault: Failure| {
            let having = judged
                .iter()
                .filter(|judged| judged.faults.contains(&fault));
            (fault, having.count())
        };
        let ratios = |wanted: fn(&SweepRow) -> bool| {
            let wanted = judged.iter().filter(|judged| wanted(&judged.row));
            Quantiles::of(wanted.map(|judged| judged.row.rms_ratio()).collect())
        };
        let shares = judged
            .iter()
            .filter_map(|judged| judged.row.corrected.engaged_share);
        let shares = Quantiles::of(shares.collect());
        Self {
            judged: judged.len(),
            not_judged: rows.len() - judged.len(),
            worse: judged
                .iter()
                .filter(|judged| !judged.faults.is_empty())
                .count(),
            by_fault: Failure::ALL.map(having).to_vec(),
            rms_ratio: ratios(|_| true),
            rms_ratio_rigid: ratios(|row| row.rigid && row.uncorrected.rms_um > UNCORRECTED_UM),
            engaged_share: shares.map(|quantiles| quantiles.median),
            machining_s,
            rows,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::never_worse::verdict::tests::row;

    #[test]
    fn failures_come_first_and_the_worst_of_them_foremost() {
        let rows = vec![
            row([10.0, 20.0], [0.1, 0.2]),
            row([10.0, 20.0], [11.0, 20.0]),
            row([10.0, 20.0], [10.0, 400.0]),
        ];
        let summary = SweepSummary::of(rows);
        assert_eq!((summary.judged, summary.worse), (3, 2));
        let maxima = summary
            .rows
            .iter()
            .map(|judged| judged.row.corrected.max_um);
        assert!(maxima.eq([400.0, 20.0, 0.2]));
        let counts = summary.by_fault.iter().map(|(_, count)| *count);
        assert!(counts.eq([1, 1, 0, 0]) && Failure::ALL[1] == Failure::Max);
        assert!(
            summary
                .by_fault
                .iter()
                .map(|(fault, _)| *fault)
                .eq(Failure::ALL)
        );
    }

    #[test]
    fn quantiles_are_those_of_the_sorted_values() {
        let values = (1..=100).rev().map(f64::from).collect();
        let it = Quantiles::of(values).expect("there are values");
        let all = [it.median, it.p90, it.p99, it.largest];
        assert_eq!(all, [51.0, 91.0, 100.0, 100.0]);
        assert_eq!(Quantiles::of(Vec::new()), None);
    }
}
