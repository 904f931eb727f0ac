//! Brings axes to rest that the path no longer moves.
//!
//! Within the tolerance such an axis may do anything that costs no time, so a solution leaves it
//! drifting. Once it rests on the path, the following windows leave it out of their unknowns.

use super::window::{WindowProblem, WindowUnknowns};

/// Number of steps in which an axis comes to rest, counted from where the path stops moving it.
const SETTLING: usize = 40;

/// Part of the bounds that this motion may use.
const MOST: f64 = 0.999;

/// Brings every axis to rest that the path leaves where it is up to the end of the window. The
/// durations stay, so that its end is linear in its jerks, which change by as little as possible.
/// An axis that would exceed a bound or leave the tube by that goes on as it was.
pub(super) fn settle<const D: usize, const N: usize, const M: usize>(
    problem: &WindowProblem<D, N>,
    unknowns: &mut WindowUnknowns<N, M>,
) {
    let n = problem.way.len();
    for k in 0..D {
        let from = problem
            .way
            .iter()
            .rposition(|way| way[k] != 0.0)
            .map_or(0, |last| last + 1);
        let to = from + SETTLING;
        if to > n {
            continue;
        }
        let kept: Vec<f64> = unknowns.u.iter().map(|u| u[k]).collect();
        problem.steer(unknowns, k, [from, to], [0.0; 3]);
        if !is_possible(problem, unknowns, k, [from, to]) {
            for (u, jerk) in unknowns.u.iter_mut().zip(kept) {
                u[k] = jerk;
            }
            problem.roll(k, [from, n], unknowns);
            continue;
        }
        for i in to..n {
            unknowns.u[i][k] = 0.0;
        }
        for x in &mut unknowns.x[to..] {
            x[3 * k..3 * k + 3].fill(0.0);
        }
    }
}

fn is_possible<const D: usize, const N: usize, const M: usize>(
    problem: &WindowProblem<D, N>,
    unknowns: &WindowUnknowns<N, M>,
    k: usize,
    [from, to]: [usize; 2],
) -> bool {
    let jerks = unknowns.u[from..to].iter().all(|u| u[k].abs() <= MOST);
    let mut nodes = unknowns
        .x
        .iter()
        .zip(&problem.radius)
        .take(to)
        .skip(from + 1);
    jerks
        && nodes.all(|(x, radius)| {
            let square: f64 = (0..D).map(|l| x[3 * l] * x[3 * l]).sum();
            x[3 * k + 1].abs() <= MOST && x[3 * k + 2].abs() <= MOST && square <= radius * radius
        })
}
