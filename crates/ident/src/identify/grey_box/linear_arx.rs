//! What a grey box is compared with: linear ARX models of the following error, and the guess that
//! the error stays.
//!
//! ```text
//! e(k) = sum_i a_i e(k - i) + sum_j b_j (c(k - j) - c(k - j - 1)) + o [+ s_0 sign v(k) + s_1 sign v(k - 1)]
//! ```
//!
//! i from 1 to na, j from 0 to nb - 1, by least squares over the fitted samples; v is the commanded
//! speed. A free run puts its own errors in place of the measured ones. This is the usual ARX of
//! the position on command and position, held to what is true of every axis: that it does the same
//! elsewhere.
//!
//! Source: Ljung (1999), System Identification, section 4.2.

use nalgebra::{DMatrix, DVector};

use super::axis_record::AxisRecord;
use super::sample_split::motion;

/// Orders that are tried, na and nb, without and with the signs.
pub(super) const ORDERS: [(usize, usize, bool); 4] =
    [(2, 3, false), (6, 6, false), (2, 3, true), (6, 6, true)];
/// A ridge, part of the mean of the squares: columns may be the same.
const RIDGE: f64 = 1e-12;

/// A linear model of the following error.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearArx {
    /// Lags of the error, and of the command's differences.
    pub lags: [usize; 2],
    /// True where the model includes the signs of the speed.
    pub signs: bool,
    weights: Vec<f64>,
}

/// A record as an ARX model takes it.
pub(super) struct ArxData {
    error_mm: Vec<f64>,
    change_mm: Vec<f64>,
    sign: Vec<f64>,
}

impl ArxData {
    pub(super) fn new(record: &AxisRecord<'_>) -> Self {
        let error_mm = record
            .command_mm
            .iter()
            .zip(record.actual_mm)
            .map(|(c, y)| c - y)
            .collect();
        let mut change_mm = vec![0.0; record.command_mm.len()];
        for stretch in record.stretches {
            for k in stretch.start + 1..stretch.end {
                change_mm[k] = record.command_mm[k] - record.command_mm[k - 1];
            }
        }
        let sign = motion(record).into_iter().map(f64::from).collect();
        Self {
            error_mm,
            change_mm,
            sign,
        }
    }
}

impl LinearArx {
    /// Samples before the first that it can say something of.
    pub(super) fn reach(&self) -> usize {
        self.lags[0].max(self.lags[1]) + 1
    }

    /// Least squares over samples that count, none of them near the beginning of a stretch.
    pub(super) fn fit(
        data: &ArxData,
        counts: &[bool],
        (na, nb, signs): (usize, usize, bool),
    ) -> Option<Self> {
        let n = na + nb + 1 + if signs { 2 } else { 0 };
        let mut arx = Self {
            lags: [na, nb],
            signs,
            weights: vec![0.0; n],
        };
        let (mut squares, mut products) = (DMatrix::<f64>::zeros(n, n), DVector::<f64>::zeros(n));
        let mut row = DVector::<f64>::zeros(n);
        for k in (arx.reach()..counts.len()).filter(|&k| counts[k]) {
            arx.fill(data, k, |i| data.error_mm[k - i], &mut row);
            squares.ger(1.0, &row, &row, 1.0);
            products.axpy(data.error_mm[k], &row, 1.0);
        }
        // Columns in their own sizes.
        let sizes = DVector::from_fn(n, |i, _| squares[(i, i)].sqrt().max(f64::MIN_POSITIVE));
        let scaled = DMatrix::from_fn(n, n, |i, j| {
            squares[(i, j)] / (sizes[i] * sizes[j]) + if i == j { RIDGE } else { 0.0 }
        });
        let found = scaled
            .cholesky()?
            .solve(&products.component_div(&sizes))
            .component_div(&sizes);
        arx.weights = found.iter().copied().collect();
        found.iter().all(|weight| weight.is_finite()).then_some(arx)
    }

    #[inline]
    fn fill(
        &self,
        data: &ArxData,
        k: usize,
        error_before: impl Fn(usize) -> f64,
        row: &mut DVector<f64>,
    ) {
        let [na, nb] = self.lags;
        (1..=na).for_each(|i| row[i - 1] = error_before(i));
        (0..nb).for_each(|j| row[na + j] = data.change_mm[k - j]);
        row[na + nb] = 1.0;
        if self.signs {
            row[na + nb + 1] = data.sign[k];
            row[na + nb + 2] = data.sign[k - 1];
        }
    }

    /// Following errors of a free run from a sample on, that one included, mm; before it they are
    /// as measured.
    pub(super) fn run_mm(&self, data: &ArxData, from: usize, samples: usize) -> Vec<f64> {
        let mut run: Vec<f64> = Vec::with_capacity(samples);
        let mut row = DVector::<f64>::zeros(self.weights.len());
        for k in from..from + samples {
            let before = |i: usize| {
                let at = k - i;
                if at >= from {
                    run[at - from]
                } else {
                    data.error_mm[at]
                }
            };
            self.fill(data, k, before, &mut row);
            let error: f64 = row
                .iter()
                .zip(&self.weights)
                .map(|(value, weight)| value * weight)
                .sum();
            run.push(error);
        }
        run
    }

    /// `2/3 lags`, `6/6 lags with signs`.
    pub fn words(&self) -> String {
        let [na, nb] = self.lags;
        format!(
            "{na}/{nb} lags{}",
            if self.signs { " with signs" } else { "" }
        )
    }
}
