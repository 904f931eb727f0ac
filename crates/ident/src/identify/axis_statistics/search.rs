//! Least value of a function of a few variables, without derivatives.
//!
//! Source: Nelder and Mead (1965), A simplex method for function minimization; Lagarias et al.
//! (1998) for the order of the steps.

/// Steps for each variable: enough to contract the simplex by 1e-4.
const EVALUATIONS: usize = 80;

/// The variables at which `cost` is least, and that cost, from `start` with first steps of `steps`.
pub(super) fn least<const S: usize>(
    start: [f64; S],
    steps: [f64; S],
    mut cost: impl FnMut(&[f64; S]) -> f64,
) -> ([f64; S], f64) {
    let mut corners: Vec<([f64; S], f64)> = vec![(start, cost(&start))];
    for i in 0..S {
        let mut corner = start;
        corner[i] += steps[i];
        corners.push((corner, cost(&corner)));
    }
    for _ in 0..EVALUATIONS * S {
        corners.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (best, (worst, of_worst), of_second) = (corners[0].1, corners[S], corners[S - 1].1);
        let center: [f64; S] = std::array::from_fn(|i| {
            corners[..S]
                .iter()
                .map(|(corner, _)| corner[i])
                .sum::<f64>()
                / S as f64
        });
        let along = |by: f64| -> [f64; S] {
            std::array::from_fn(|i| center[i] + by * (worst[i] - center[i]))
        };
        let mut tried = |by: f64| (along(by), cost(&along(by)));
        let reflected = tried(-1.0);
        corners[S] = if reflected.1 < best {
            let expanded = tried(-2.0);
            if expanded.1 < reflected.1 {
                expanded
            } else {
                reflected
            }
        } else if reflected.1 < of_second {
            reflected
        } else {
            let contracted = if reflected.1 < of_worst {
                tried(-0.5)
            } else {
                tried(0.5)
            };
            if contracted.1 < of_worst.min(reflected.1) {
                contracted
            } else {
                let kept = corners[0].0;
                for (corner, value) in &mut corners[1..] {
                    corner
                        .iter_mut()
                        .zip(&kept)
                        .for_each(|(x, best)| *x = best + 0.5 * (*x - best));
                    *value = cost(corner);
                }
                continue;
            }
        };
    }
    corners
        .into_iter()
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap_or((start, f64::INFINITY))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bottom_of_rosenbrocks_valley_is_found() {
        let ([x, y], value) = least([-1.2, 1.0], [0.5, 0.5], |[x, y]| {
            (1.0 - x).powi(2) + 100.0 * (y - x * x).powi(2)
        });
        assert!(
            (x - 1.0).abs() < 1e-4 && (y - 1.0).abs() < 1e-4 && value < 1e-8,
            "{x} {y} {value}"
        );
    }
}
