//! Which columns belong together, where no name says it: a measured position is like its command,
//! and a little later.
//!
//! ```text
//! e(k)  = a(k) - b(k)                          v(k) = (a(k+1) + b(k+1) - a(k-1) - b(k-1)) / 4
//! delay = sum of e v / sum of v^2              of b behind a, in samples: e is delay v to the first order
//! ```

/// Samples of a column that are looked at, at the most.
const SAMPLES: usize = 50_000;
/// Least correlation of two columns that can be command and position; a lag of a sixth of a period
/// has 0.5.
const MIN_CORRELATION: f64 = 0.6;
/// Largest ratio of their standard deviations.
const MAX_RATIO: f64 = 1.6;

/// Two columns that belong together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ColumnPair {
    pub(super) command: usize,
    pub(super) actual: usize,
    /// RMS of their difference.
    pub(super) rms: f64,
}

/// Mean and standard deviation of every `stride`-th sample.
fn moments(values: &[f64], stride: usize) -> (f64, f64) {
    let count = values.len().div_ceil(stride).max(1) as f64;
    let mean = values.iter().step_by(stride).sum::<f64>() / count;
    let square = values
        .iter()
        .step_by(stride)
        .map(|value| (value - mean).powi(2))
        .sum::<f64>()
        / count;
    (mean, square.sqrt())
}

/// Computes the delay of `b` behind `a`, samples; zero where nothing moves.
pub(super) fn delay_samples(a: &[f64], b: &[f64]) -> f64 {
    let (mut above, mut below) = (0.0, 0.0);
    for k in 1..a.len().min(b.len()).saturating_sub(1) {
        let v = 0.25 * (a[k + 1] + b[k + 1] - a[k - 1] - b[k - 1]);
        above += (a[k] - b[k]) * v;
        below += v * v;
    }
    if below > 0.0 { above / below } else { 0.0 }
}

/// Pairs among columns, those first that stand first in the file. Columns of different lengths, and
/// those with values that are no numbers, belong to none.
pub(super) fn find(columns: &[&[f64]]) -> Vec<ColumnPair> {
    let rows = columns.iter().map(|values| values.len()).max().unwrap_or(0);
    let stride = rows.div_ceil(SAMPLES).max(1);
    let moments: Vec<(f64, f64)> = columns
        .iter()
        .map(|values| moments(values, stride))
        .collect();
    let moves =
        |i: usize| columns[i].len() == rows && moments[i].0.is_finite() && moments[i].1 > 0.0;
    // Of columns that are equal, such as a target and the demand made of it, the last is taken.
    let is_copied = |i: usize| (i + 1..columns.len()).any(|j| columns[i] == columns[j]);
    let usable: Vec<usize> = (0..columns.len()).filter(|&i| moves(i)).collect();
    let single: Vec<usize> = usable.iter().copied().filter(|&i| !is_copied(i)).collect();
    let mut pairs = matched(&single, columns, &moments, stride);
    if pairs.is_empty() {
        // An actual position that is a copy of the command is found, too: it is refused with a
        // reason.
        pairs = matched(&usable, columns, &moments, stride);
    }
    pairs.sort_by_key(|pair| pair.command.min(pair.actual));
    pairs
}

/// The nearest belong together, each column to one other.
fn matched(
    usable: &[usize],
    columns: &[&[f64]],
    moments: &[(f64, f64)],
    stride: usize,
) -> Vec<ColumnPair> {
    let mut near = Vec::new();
    for (n, &i) in usable.iter().enumerate() {
        for &j in &usable[n + 1..] {
            let ((mean_i, deviation_i), (mean_j, deviation_j)) = (moments[i], moments[j]);
            let ratio = deviation_i.max(deviation_j) / deviation_i.min(deviation_j);
            if ratio > MAX_RATIO || (mean_i - mean_j).abs() > 0.5 * deviation_i.max(deviation_j) {
                continue;
            }
            let (mut count, mut product, mut square) = (0.0, 0.0, 0.0);
            for (a, b) in columns[i].iter().zip(columns[j]).step_by(stride) {
                count += 1.0;
                product += (a - mean_i) * (b - mean_j);
                square += (a - b).powi(2);
            }
            if product / count > MIN_CORRELATION * deviation_i * deviation_j {
                near.push(((square / count).sqrt(), i, j));
            }
        }
    }
    near.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut taken = vec![false; columns.len()];
    let mut pairs = Vec::new();
    for (rms, i, j) in near {
        if taken[i] || taken[j] {
            continue;
        }
        (taken[i], taken[j]) = (true, true);
        let j_leads = delay_samples(columns[i], columns[j]) < 0.0;
        let (command, actual) = if j_leads { (j, i) } else { (i, j) };
        pairs.push(ColumnPair {
            command,
            actual,
            rms,
        });
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn command_and_position_are_found_among_other_columns() {
        let angle = |k: usize, late: f64| 0.01 * (k as f64 - late);
        let of = |f: &dyn Fn(usize) -> f64| (0..3000).map(f).collect::<Vec<f64>>();
        let columns = [
            of(&|k| k as f64),
            of(&|k| 10.0 * libm::cos(angle(k, 7.5))),
            of(&|k| 10.0 * libm::cos(angle(k, 0.0))),
            of(&|k| 10.0 * libm::sin(angle(k, 3.0))),
            of(&|k| 10.0 * libm::sin(angle(k, 3.0))),
            of(&|k| 10.0 * libm::sin(angle(k, 9.0))),
            of(&|k| 0.1 * libm::cos(angle(k, 9.0))),
            of(&|_| 5.0),
        ];
        let borrowed: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        let found: Vec<(usize, usize)> = find(&borrowed)
            .iter()
            .map(|pair| (pair.command, pair.actual))
            .collect();
        assert_eq!(found, [(2, 1), (4, 5)]);
        let delay = delay_samples(&columns[2], &columns[1]);
        assert!((delay - 7.5).abs() < 0.01, "{delay}");
    }
}
