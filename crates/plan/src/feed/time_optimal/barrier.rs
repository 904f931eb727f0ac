//! The bounds of a window: slacks, their multipliers, and how far a step may go.
//!
//! Every bound is on the unknowns of one node or step, so an iterate is strictly inside of all of
//! them from the beginning, and stays there: `|v|, |a|, |j| <= 1` of each axis, `h > 0`, the offset
//! within its tube and the control velocity of each step within its feedrate.

use super::riccati::NewtonStep;
use super::window::{StepOfAxis, WindowProblem, WindowUnknowns};

/// Least duration of a step, in units.
pub(super) const LEAST_STEP: f64 = 1e-4;

/// The feedrate binds where so little of its square is left.
const AT_FEED: f64 = 1e-4;

/// Number of halvings to find the longest step, where a step is too long for a feedrate.
const CURVED_HALVINGS: u32 = 12;

/// First iterates keep this part of each bound away from it.
const FIRST_SLACK: f64 = 0.05;

/// A multiplier stays within this factor of `mu / slack`. Source: Waechter and Biegler (2006),
/// eq. 16.
const MULTIPLIER_FACTOR: f64 = 1e10;

/// Multipliers of the bounds of a node: lower and upper of each axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct NodeMultipliers<const D: usize> {
    pub(super) v: [[f64; 2]; D],
    pub(super) a: [[f64; 2]; D],
    pub(super) tube: f64,
}

/// Multipliers of the bounds of a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepMultipliers<const D: usize> {
    pub(super) j: [[f64; 2]; D],
    pub(super) h: f64,
    pub(super) feed: f64,
}

/// The larger one; without the care of `f64::max` for what is not a number, which takes four times
/// as long.
#[inline]
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// `1 - sum w c^2`.
#[inline]
pub(super) fn feed_slack<const D: usize>(w: &[f64; D], c: &[f64; D]) -> f64 {
    1.0 - (0..D).map(|k| w[k] * c[k] * c[k]).sum::<f64>()
}

/// The control velocity of a step, `v + h a / 2`: with those of its neighbours the polygon of which
/// the velocity is the quadratic B-spline. Where it is within a ball, so is the velocity.
#[inline]
pub(super) fn control<const D: usize, const N: usize, const M: usize>(
    steps: &[StepOfAxis; D],
    x: &[f64; N],
    u: &[f64; M],
) -> [f64; D] {
    std::array::from_fn(|k| x[3 * k + 1] + 0.5 * steps[k].d1 * u[D] * x[3 * k + 2])
}

/// First-order change of the feedrate slack for the change `dx`, `du` of the unknowns.
#[inline]
fn feed_slope<const D: usize, const N: usize, const M: usize>(
    steps: &[StepOfAxis; D],
    w: &[f64; D],
    [x, dx]: [&[f64; N]; 2],
    [u, du]: [&[f64; M]; 2],
) -> f64 {
    let c = control(steps, x, u);
    let along = |k: usize| {
        let change = 0.5 * steps[k].d1 * (du[D] * x[3 * k + 2] + u[D] * dx[3 * k + 2]);
        w[k] * c[k] * (dx[3 * k + 1] + change)
    };
    -2.0 * (0..D).map(along).sum::<f64>()
}

/// `sum o^2`.
#[inline]
pub(super) fn offset_square<const N: usize>(x: &[f64; N]) -> f64 {
    (0..N / 3).map(|k| x[3 * k] * x[3 * k]).sum::<f64>()
}

/// `r^2 - sum o^2`.
#[inline]
pub(super) fn tube_slack<const N: usize>(r: f64, x: &[f64; N]) -> f64 {
    r * r - offset_square(x)
}

/// WindowUnknowns of a window with the multipliers of their bounds and of the steps.
#[derive(Debug)]
pub(super) struct WindowIterate<'a, const D: usize, const N: usize, const M: usize> {
    pub(super) problem: &'a WindowProblem<D, N>,
    pub(super) at: WindowUnknowns<N, M>,
    /// Multipliers of the equations that lead to each node.
    pub(super) multipliers: Vec<[f64; N]>,
    pub(super) nodes: Vec<NodeMultipliers<D>>,
    pub(super) steps: Vec<StepMultipliers<D>>,
    pub(super) mu: f64,
}

impl<'a, const D: usize, const N: usize, const M: usize> WindowIterate<'a, D, N, M> {
    /// The first one: inside of all bounds, each multiplier `mu / slack`.
    pub(super) fn first(
        problem: &'a WindowProblem<D, N>,
        at: WindowUnknowns<N, M>,
        mu: f64,
    ) -> Self {
        let n = problem.way.len();
        let node = NodeMultipliers {
            v: [[0.0; 2]; D],
            a: [[0.0; 2]; D],
            tube: 0.0,
        };
        let step = StepMultipliers {
            j: [[0.0; 2]; D],
            h: 0.0,
            feed: 0.0,
        };
        let (nodes, steps, multipliers) = (vec![node; n + 1], vec![step; n], vec![[0.0; N]; n + 1]);
        let mut first = Self {
            problem,
            at,
            multipliers,
            nodes,
            steps,
            mu,
        };
        first.put_inside();
        first.first_multipliers();
        first
    }

    /// Returns whether a node has bounds of velocity and acceleration, and whether it has a bound
    /// of its offset.
    #[inline]
    pub(super) fn is_bounded(&self, i: usize) -> [bool; 2] {
        let n = self.problem.way.len();
        [i > 0 && i < n, i > 0 && (i < n || !self.problem.exact_end)]
    }

    /// Returns true if the feedrate binds anywhere.
    pub(super) fn is_at_feed(&self) -> bool {
        let steps = self.problem.steps();
        let mut all = self.at.x.iter().zip(&self.at.u).enumerate();
        all.any(|(i, (x, u))| {
            feed_slack(&self.problem.feed_weights(i), &control(&steps, x, u)) < AT_FEED
        })
    }

    fn put_inside(&mut self) {
        let most = 1.0 - FIRST_SLACK;
        let n = self.problem.way.len();
        self.at.x[0] = self.problem.first;
        for i in 1..=n {
            let x = &mut self.at.x[i];
            for s in 0..N {
                if i == n && self.problem.is_given(s) {
                    x[s] = 0.0;
                } else if s % 3 != 0 {
                    x[s] = x[s].clamp(-most, most);
                }
            }
            let offset = (1.0 - tube_slack(1.0, x)).max(0.0).sqrt();
            let radius = most * self.problem.radius[i];
            let nearer = if offset > radius {
                radius / offset
            } else {
                1.0
            };
            (0..D).for_each(|k| x[3 * k] *= nearer);
        }
        for u in &mut self.at.u {
            (0..D).for_each(|k| u[k] = u[k].clamp(-most, most));
            u[D] = u[D].max(10.0 * LEAST_STEP);
        }
        self.put_inside_feed(most);
    }

    /// Slower where the control velocity is not well within the feedrate; behind the given state
    /// for a shorter time.
    fn put_inside_feed(&mut self, most: f64) {
        let steps = self.problem.steps();
        for (i, (x, u)) in self.at.x.iter_mut().zip(&mut self.at.u).enumerate() {
            let w = self.problem.feed_weights(i);
            if i == 0 {
                let at_once = feed_slack(&w, &std::array::from_fn(|k| x[3 * k + 1]));
                while feed_slack(&w, &control(&steps, x, u)) < 0.5 * at_once
                    && u[D] > 10.0 * LEAST_STEP
                {
                    u[D] = (0.5 * u[D]).max(10.0 * LEAST_STEP);
                }
                continue;
            }
            let speed = (1.0 - feed_slack(&w, &control(&steps, x, u)))
                .max(0.0)
                .sqrt();
            if speed > most {
                for k in 0..D {
                    x[3 * k + 1] *= most / speed;
                    x[3 * k + 2] *= most / speed;
                }
            }
        }
    }

    fn first_multipliers(&mut self) {
        let mu = self.mu;
        let pair = |value: f64| [mu / (1.0 + value), mu / (1.0 - value)];
        for (i, (x, z)) in self.at.x.iter().zip(&mut self.nodes).enumerate().skip(1) {
            for k in 0..D {
                z.v[k] = pair(x[3 * k + 1]);
                z.a[k] = pair(x[3 * k + 2]);
            }
            z.tube = mu / tube_slack(self.problem.radius[i], x);
        }
        let steps = self.problem.steps();
        for (i, (u, z)) in self.at.u.iter().zip(&mut self.steps).enumerate() {
            (0..D).for_each(|k| z.j[k] = pair(u[k]));
            z.h = mu / (u[D] - LEAST_STEP);
            z.feed = mu
                / feed_slack(
                    &self.problem.feed_weights(i),
                    &control(&steps, &self.at.x[i], u),
                );
        }
    }

    /// The sum of the logarithms of all slacks.
    pub(super) fn logarithms(&self, at: &WindowUnknowns<N, M>) -> f64 {
        let mut sum = 0.0;
        // A product of slacks has one logarithm.
        let steps = self.problem.steps();
        for (i, u) in at.u.iter().enumerate() {
            let feed = feed_slack(&self.problem.feed_weights(i), &control(&steps, &at.x[i], u));
            // Two negative slacks would make a positive product.
            if feed <= 0.0 {
                return f64::NAN;
            }
            sum += libm::log((0..D).fold(feed * (u[D] - LEAST_STEP), |product, k| {
                product * (1.0 - u[k] * u[k])
            }));
        }
        for (i, x) in at.x.iter().enumerate() {
            let [moves, offset] = self.is_bounded(i);
            let mut product = 1.0;
            if moves {
                for k in 0..D {
                    product *=
                        (1.0 - x[3 * k + 1] * x[3 * k + 1]) * (1.0 - x[3 * k + 2] * x[3 * k + 2]);
                }
            }
            if offset {
                product *= tube_slack(self.problem.radius[i], x);
            }
            sum += libm::log(product);
        }
        sum
    }

    /// The longest steps, of the unknowns and of the multipliers of bounds, that leave `1 - tau` of
    /// each.
    pub(super) fn longest(&self, newton: &NewtonStep<N, M>, tau: f64) -> (f64, f64) {
        let mut longest = Longest {
            unknowns: 1.0,
            multipliers: 1.0,
            mu: self.mu,
            tau,
        };
        for (i, (u, du)) in self.at.u.iter().zip(&newton.du).enumerate() {
            let z = &self.steps[i];
            (0..D).for_each(|k| longest.interval(u[k], du[k], z.j[k]));
            longest.bound(u[D] - LEAST_STEP, du[D], z.h);
        }
        let steps = self.problem.steps();
        for i in 0..self.at.u.len() {
            let w = self.problem.feed_weights(i);
            let (x, u, dx, du) = (&self.at.x[i], &self.at.u[i], &newton.dx[i], &newton.du[i]);
            let at = |t: f64| -> [f64; D] {
                std::array::from_fn(|k| {
                    let (v, a) = (
                        x[3 * k + 1] + t * dx[3 * k + 1],
                        x[3 * k + 2] + t * dx[3 * k + 2],
                    );
                    v + 0.5 * steps[k].d1 * (u[D] + t * du[D]) * a
                })
            };
            let slope = feed_slope(&steps, &w, [x, dx], [u, du]);
            longest.curved(|t| feed_slack(&w, &at(t)), slope, self.steps[i].feed);
        }
        for (i, (x, dx)) in self.at.x.iter().zip(&newton.dx).enumerate() {
            let z = &self.nodes[i];
            let [moves, offset] = self.is_bounded(i);
            if moves {
                for k in 0..D {
                    longest.interval(x[3 * k + 1], dx[3 * k + 1], z.v[k]);
                    longest.interval(x[3 * k + 2], dx[3 * k + 2], z.a[k]);
                }
            }
            if offset {
                let [mut along, mut square] = [0.0; 2];
                for k in 0..D {
                    along += x[3 * k] * dx[3 * k];
                    square += dx[3 * k] * dx[3 * k];
                }
                longest.ball(tube_slack(self.problem.radius[i], x), along, square, z.tube);
            }
        }
        (longest.unknowns, longest.multipliers)
    }

    /// Goes to `next`, which is `step` of the Newton step away; multipliers of bounds go `dual` of
    /// it.
    pub(super) fn go(
        &mut self,
        next: &mut WindowUnknowns<N, M>,
        newton: &NewtonStep<N, M>,
        step: f64,
        dual: f64,
    ) {
        let mu = self.mu;
        let update = |z: &mut f64, slack: f64, change: f64, next_slack: f64| {
            *z += dual * ((mu - *z * change) / slack - *z);
            let least = larger(*z, mu / (MULTIPLIER_FACTOR * next_slack));
            *z = -larger(-least, -MULTIPLIER_FACTOR * mu / next_slack);
        };
        let both = |z: &mut [f64; 2], value: f64, change: f64, next: f64| {
            update(&mut z[0], 1.0 + value, change, 1.0 + next);
            update(&mut z[1], 1.0 - value, -change, 1.0 - next);
        };
        let steps = self.problem.steps();
        for (i, z) in self.steps.iter_mut().enumerate() {
            let (x, dx, u, du) = (&self.at.x[i], &newton.dx[i], &self.at.u[i], &newton.du[i]);
            let w = self.problem.feed_weights(i);
            let slacks = [(x, u), (&next.x[i], &next.u[i])]
                .map(|(x, u)| feed_slack(&w, &control(&steps, x, u)));
            let slope = feed_slope(&steps, &w, [x, dx], [u, du]);
            update(&mut z.feed, slacks[0], slope, slacks[1]);
            let next = &next.u[i];
            (0..D).for_each(|k| both(&mut z.j[k], u[k], du[k], next[k]));
            update(&mut z.h, u[D] - LEAST_STEP, du[D], next[D] - LEAST_STEP);
        }
        let n = self.problem.way.len();
        for (i, z) in self.nodes.iter_mut().enumerate().skip(1) {
            let (x, dx, next) = (&self.at.x[i], &newton.dx[i], &next.x[i]);
            if i < n {
                for k in 0..D {
                    both(&mut z.v[k], x[3 * k + 1], dx[3 * k + 1], next[3 * k + 1]);
                    both(&mut z.a[k], x[3 * k + 2], dx[3 * k + 2], next[3 * k + 2]);
                }
            }
            if i < n || !self.problem.exact_end {
                let r = self.problem.radius[i];
                let along: f64 = (0..D).map(|k| x[3 * k] * dx[3 * k]).sum();
                update(
                    &mut z.tube,
                    tube_slack(r, x),
                    -2.0 * along,
                    tube_slack(r, next),
                );
            }
        }
        for (to, from) in self.multipliers.iter_mut().zip(&newton.multipliers) {
            (0..N).for_each(|s| to[s] += step * (from[s] - to[s]));
        }
        std::mem::swap(&mut self.at, next);
    }
}

struct Longest {
    unknowns: f64,
    multipliers: f64,
    mu: f64,
    tau: f64,
}

impl Longest {
    #[inline]
    fn bound(&mut self, slack: f64, change: f64, z: f64) {
        // Divided only where it is the shortest so far.
        if self.unknowns * change < -self.tau * slack {
            self.unknowns = -self.tau * slack / change;
        }
        self.multiplier(self.mu - z * (change + slack), z * slack);
    }

    /// The multiplier and its change, both times the slack.
    #[inline]
    fn multiplier(&mut self, change: f64, z: f64) {
        if self.multipliers * change < -self.tau * z {
            self.multipliers = -self.tau * z / change;
        }
    }

    /// Both bounds of a value from -1 to 1.
    #[inline]
    fn interval(&mut self, value: f64, change: f64, z: [f64; 2]) {
        self.bound(1.0 + value, change, z[0]);
        self.bound(1.0 - value, -change, z[1]);
    }

    /// A slack that is no quadratic, with its slope: the longest step by halving where it is too
    /// long.
    fn curved(&mut self, slack: impl Fn(f64) -> f64, slope: f64, z: f64) {
        let now = slack(0.0);
        let least = (1.0 - self.tau) * now;
        if slack(self.unknowns) < least {
            let (mut lo, mut hi) = (0.0, self.unknowns);
            for _ in 0..CURVED_HALVINGS {
                let middle = 0.5 * (lo + hi);
                if slack(middle) < least {
                    hi = middle;
                } else {
                    lo = middle;
                }
            }
            self.unknowns = lo;
        }
        self.multiplier(self.mu - z * (slope + now), z * now);
    }

    /// A slack that falls by `2 along t + square t^2`.
    #[inline]
    fn ball(&mut self, slack: f64, along: f64, square: f64, z: f64) {
        let most = self.tau * slack;
        if 2.0 * along + square > most {
            let root = (along * along + square * most).sqrt();
            let t = if along > 0.0 {
                most / (along + root)
            } else {
                (root - along) / square
            };
            self.unknowns = self.unknowns.min(t);
        }
        self.multiplier(self.mu + z * (2.0 * along - slack), z * slack);
    }
}
