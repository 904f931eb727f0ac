//! Interior-point method for a window: the least sum of durations.
//!
//! Primal-dual with a barrier that falls to [`SolverSettings::last_mu`], Newton steps by
//! [`super::riccati`], made convex by a multiple of the unit matrix where they are not, and a line
//! search with a filter of defects and cost. Source: Waechter and Biegler (2006), "On the
//! implementation of an interior-point filter line-search algorithm for large-scale nonlinear
//! programming", sections 2 and 3, without its restoration and its second-order correction: a
//! search that fails ends in a short step, and too many of them in `None`.

use super::barrier::{
    LEAST_STEP, WindowIterate, control, feed_slack, larger, offset_square, tube_slack,
};
use super::riccati::{NewtonStep, Stage};
use super::window::{StepOfAxis, WindowProblem, WindowUnknowns};

/// The equations of the last node, at rest, hold with this much of their multiplier; the defect
/// that is left of them vanishes with the iterations.
const GIVEN: f64 = 1e-7;

/// The barrier falls when no defect is more than `mu`, and the error no more than this many times.
const KAPPA: f64 = 10.0;

/// Largest defect of a solution, in units: rolling out takes it away, and moves no node by more
/// than a nanometre.
const LARGEST_DEFECT: f64 = 1e-7;

/// The barrier also falls after more than `PATIENCE` iterations that miss the condition of `KAPPA`,
/// if every defect is below `PATIENT_DEFECT`. The iterations then only choose among several motions
/// that take the same time.
const PATIENCE: u32 = 8;
const PATIENT_DEFECT: f64 = 1e-3;

/// Smallest decrease of the cost, as a part of it, for which a Newton step is taken with the last
/// barrier.
const STATIONARY: f64 = 1e-5;

/// Largest barrier at which a solution is accepted when no iterations are left.
const LAST_RESORT_MU: f64 = 1e-3;

/// Factor by which the barrier falls once more if the feedrate binds, for at most `POLISHING`
/// further iterations. The speed comes closer to the feedrate by the same factor.
const POLISH: f64 = 0.05;
const POLISHING: u32 = 8;

/// Line searches that may fail.
const MOST_FAILURES: u32 = 12;

/// Multiples of the unit matrix: the first, the largest, how they grow and fall.
const FIRST_SHIFT: f64 = 1e-3;
const LARGEST_SHIFT: f64 = 1e8;
const LEAST_SHIFT: f64 = 1e-7;
const SHIFT_GROWS: f64 = 8.0;
const SHIFT_FALLS: f64 = 1.0 / 3.0;
const SHORT: f64 = 0.1;
const SHIFT_AFTER_SHORT: f64 = 9.0;

/// Settings of the solver for one window.
#[derive(Debug, Clone, Copy)]
pub(super) struct SolverSettings {
    /// Barrier at the beginning.
    pub(super) first_mu: f64,
    /// Barrier at the end: the cost is too large by about 25 times this in each step.
    pub(super) last_mu: f64,
    /// Iterations.
    pub(super) most_iterations: u32,
}

/// Sum and largest of the defects, and the cost with its barrier.
#[derive(Debug, Clone, Copy)]
struct Merit {
    theta: f64,
    largest: f64,
    phi: f64,
}

/// The method at work.
#[derive(Debug)]
struct InteriorPoint<'a, const D: usize, const N: usize, const M: usize> {
    iterate: WindowIterate<'a, D, N, M>,
    steps: [StepOfAxis; D],
    stages: Vec<Stage<N, M>>,
    newton: NewtonStep<N, M>,
    trial: WindowUnknowns<N, M>,
    filter: Vec<(f64, f64)>,
    /// Shift added to the Hessian last, and the last one that was not zero.
    shift: f64,
    last_shift: f64,
}

/// The solution of a window from a first guess, and how many iterations it took; none where the
/// method does not come to one.
pub(super) fn solve<const D: usize, const N: usize, const M: usize>(
    problem: &WindowProblem<D, N>,
    guess: WindowUnknowns<N, M>,
    settings: SolverSettings,
) -> Option<(WindowUnknowns<N, M>, u32)> {
    let n = problem.way.len();
    let method = InteriorPoint {
        steps: problem.steps(),
        stages: vec![Stage::ZERO; n + 1],
        newton: NewtonStep::new(n),
        trial: guess.clone(),
        filter: Vec::new(),
        shift: 0.0,
        last_shift: 0.0,
        iterate: WindowIterate::first(problem, guess, settings.first_mu),
    };
    method.run(settings)
}

impl<const D: usize, const N: usize, const M: usize> InteriorPoint<'_, D, N, M> {
    fn run(mut self, settings: SolverSettings) -> Option<(WindowUnknowns<N, M>, u32)> {
        let mut merit = self.merit(&self.iterate.at);
        let first_theta = merit.theta.max(1.0);
        let (mut failures, mut waited) = (0, 0);
        // What is solved, and the iteration in which it was, while it is being polished.
        let mut solved: Option<(WindowUnknowns<N, M>, u32)> = None;
        for iteration in 0..settings.most_iterations {
            if solved
                .as_ref()
                .is_some_and(|(_, since)| iteration - since > POLISHING)
            {
                return solved;
            }
            self.let_shift_fall();
            let mut error = self.assemble().max(merit.largest);
            waited += 1;
            let kappa = if solved.is_some() { 1.0 } else { KAPPA };
            while (error <= kappa * self.iterate.mu && merit.largest <= self.iterate.mu)
                || (solved.is_none() && waited > PATIENCE && merit.largest < PATIENT_DEFECT)
            {
                if self.iterate.mu <= settings.last_mu {
                    if merit.largest >= LARGEST_DEFECT {
                        break;
                    }
                    if self.iterate.mu < settings.last_mu || !self.iterate.is_at_feed() {
                        return Some((self.iterate.at, iteration));
                    }
                    solved = Some((self.iterate.at.clone(), iteration));
                    self.iterate.mu = POLISH * settings.last_mu;
                    self.filter.clear();
                    self.assemble();
                    merit = self.merit(&self.iterate.at);
                    break;
                }
                self.lower_barrier(settings.last_mu);
                waited = 0;
                error = self.assemble().max(merit.largest);
                merit = self.merit(&self.iterate.at);
            }
            let Some(slope) = self.newton_step() else {
                return solved;
            };
            if solved.is_none() && self.is_stationary(merit, slope, settings.last_mu) {
                return Some((self.iterate.at, iteration));
            }
            let tau = (1.0 - self.iterate.mu).max(0.99);
            let (longest, dual) = self.iterate.longest(&self.newton, tau);
            let found = self.search(merit, slope, longest, first_theta);
            failures += u32::from(found.is_none());
            let step;
            (step, merit) = found.unwrap_or_else(|| self.careful(longest));
            if failures > MOST_FAILURES || !merit.phi.is_finite() {
                return solved;
            }
            // So short a step comes of a Hessian that is barely convex, or nearly singular: the
            // next one is to be more so.
            if step < SHORT {
                self.shift = (self.shift * SHIFT_AFTER_SHORT).max(FIRST_SHIFT);
            }
            self.iterate.go(&mut self.trial, &self.newton, step, dual);
        }
        let serves = self.iterate.mu <= LAST_RESORT_MU && merit.largest < LARGEST_DEFECT;
        solved.or_else(|| serves.then_some((self.iterate.at, settings.most_iterations)))
    }

    /// Reduces the shift of the Hessian from one iteration to the next.
    fn let_shift_fall(&mut self) {
        self.shift *= SHIFT_FALLS;
        if self.shift < LEAST_SHIFT {
            self.shift = 0.0;
        }
    }

    /// The next lower barrier.
    fn lower_barrier(&mut self, last_mu: f64) {
        let mu = self.iterate.mu;
        self.iterate.mu = (0.2 * mu).min(libm::pow(mu, 1.5)).max(last_mu);
        self.filter.clear();
    }

    /// A short step whatever it gives, and a more careful one next.
    fn careful(&mut self, longest: f64) -> (f64, Merit) {
        self.filter.clear();
        self.shift = (self.shift * 10.0).max(1e-2);
        let step = 0.05 * longest;
        self.try_step(step);
        (step, self.merit(&self.trial))
    }

    /// Returns true if another Newton step would gain nothing.
    fn is_stationary(&self, merit: Merit, slope: f64, last_mu: f64) -> bool {
        self.iterate.mu <= last_mu
            && merit.largest < LARGEST_DEFECT
            && slope.abs() <= STATIONARY * merit.phi
            && !self.iterate.is_at_feed()
    }

    /// The Newton step; answers the slope of the cost along it.
    fn newton_step(&mut self) -> Option<f64> {
        while !self.newton.backward(&self.stages) {
            self.shift = if self.shift > 0.0 {
                self.shift * SHIFT_GROWS
            } else if self.last_shift > 0.0 {
                (self.last_shift * SHIFT_FALLS).max(1e-6)
            } else {
                FIRST_SHIFT
            };
            if self.shift > LARGEST_SHIFT {
                return None;
            }
            self.assemble();
        }
        if self.shift > 0.0 {
            self.last_shift = self.shift;
        }
        self.newton.forward(&self.stages);
        let n = self.newton.du.len();
        let mut slope = 0.0;
        for (i, stage) in self.stages[..n].iter().enumerate() {
            slope += stage
                .gu
                .iter()
                .zip(&self.newton.du[i])
                .map(|(g, d)| g * d)
                .sum::<f64>();
            slope += stage
                .gx
                .iter()
                .zip(&self.newton.dx[i])
                .map(|(g, d)| g * d)
                .sum::<f64>();
        }
        slope.is_finite().then_some(slope)
    }

    /// A part of the Newton step that the filter takes; the trial is there then, with its merit.
    fn search(
        &mut self,
        merit: Merit,
        slope: f64,
        longest: f64,
        first_theta: f64,
    ) -> Option<(f64, Merit)> {
        let rounding = 1e-13 * merit.phi.abs();
        let mut step = longest;
        for _ in 0..12 {
            self.try_step(step);
            let trial = self.merit(&self.trial);
            let descends = slope < 0.0
                && merit.theta <= 1e-4 * first_theta
                && step * libm::pow(-slope, 2.3) > libm::pow(merit.theta, 1.1);
            let good = if descends {
                trial.phi <= merit.phi + 1e-4 * step * slope + rounding
            } else {
                trial.theta <= (1.0 - 1e-5) * merit.theta
                    || trial.phi <= merit.phi - 1e-5 * merit.theta + rounding
            };
            let open = self
                .filter
                .iter()
                .all(|&(theta, phi)| trial.theta < theta || trial.phi < phi);
            if good && open && trial.phi.is_finite() && trial.theta < 1e4 * first_theta {
                if !descends {
                    self.filter
                        .push(((1.0 - 1e-5) * merit.theta, merit.phi - 1e-5 * merit.theta));
                }
                return Some((step, trial));
            }
            step *= 0.5;
        }
        None
    }

    fn try_step(&mut self, step: f64) {
        let WindowUnknowns { x, u } = &self.iterate.at;
        for (i, trial) in self.trial.x.iter_mut().enumerate() {
            (0..N).for_each(|s| trial[s] = x[i][s] + step * self.newton.dx[i][s]);
        }
        for (i, trial) in self.trial.u.iter_mut().enumerate() {
            (0..M).for_each(|s| trial[s] = u[i][s] + step * self.newton.du[i][s]);
        }
    }

    fn merit(&self, at: &WindowUnknowns<N, M>) -> Merit {
        let problem = self.iterate.problem;
        let (mut theta, mut largest, mut cost) = (0.0, 0.0_f64, 0.0);
        let mut add = |defect: f64| {
            theta += defect.abs();
            largest = larger(largest, defect.abs());
        };
        for (i, u) in at.u.iter().enumerate() {
            let end = problem.end(&self.steps, i, &at.x[i], u);
            (0..N).for_each(|s| add(end[s] - at.x[i + 1][s]));
            cost += u[D] + problem.offset_weight(i + 1) * offset_square(&at.x[i + 1]);
        }
        let last = &at.x[at.u.len()];
        (0..N)
            .filter(|&s| problem.is_given(s))
            .for_each(|s| add(last[s]));
        Merit {
            theta,
            largest,
            phi: cost - self.iterate.mu * self.iterate.logarithms(at),
        }
    }

    /// Fills the stages; answers the largest residual of the gradients and of complementarity.
    fn assemble(&mut self) -> f64 {
        let n = self.newton.du.len();
        let mut error = 0.0_f64;
        for i in 0..=n {
            let mut stage = Stage::ZERO;
            let mut residual = [0.0; N];
            if i > 0 {
                error = larger(error, self.node(i, &mut stage, &mut residual));
            }
            if i < n {
                error = larger(error, self.step(i, &mut stage, &mut residual));
            } else {
                for s in 0..N {
                    if self.iterate.problem.is_given(s) {
                        stage.q[s][s] += 1.0 / GIVEN;
                        stage.gx[s] =
                            self.iterate.multipliers[n][s] + self.iterate.at.x[n][s] / GIVEN;
                        residual[s] = 0.0;
                    }
                }
            }
            if i > 0 {
                error = residual
                    .iter()
                    .fold(error, |error, r| larger(error, r.abs()));
            }
            self.stages[i] = stage;
        }
        error
    }

    /// Adds the bounds of a node to its stage. Returns the largest residual of complementarity.
    fn node(&self, i: usize, stage: &mut Stage<N, M>, residual: &mut [f64; N]) -> f64 {
        let WindowIterate {
            problem, at, mu, ..
        } = &self.iterate;
        let (mu, x, z) = (*mu, &at.x[i], &self.iterate.nodes[i]);
        let [moves, offset] = self.iterate.is_bounded(i);
        let mut error = 0.0_f64;
        if moves {
            for k in 0..D {
                for (row, z) in [(3 * k + 1, z.v[k]), (3 * k + 2, z.a[k])] {
                    let (below, above) = (1.0 + x[row], 1.0 - x[row]);
                    stage.q[row][row] += z[0] / below + z[1] / above;
                    stage.gx[row] += mu / above - mu / below;
                    residual[row] += z[1] - z[0];
                    error = larger(
                        larger(error, (z[0] * below - mu).abs()),
                        (z[1] * above - mu).abs(),
                    );
                }
            }
        }
        if offset {
            let slack = tube_slack(problem.radius[i], x);
            let weight = problem.offset_weight(i);
            error = larger(error, (z.tube * slack - mu).abs());
            for k in 0..D {
                let row = 3 * k;
                stage.q[row][row] += 2.0 * (z.tube + weight);
                stage.gx[row] += 2.0 * (mu / slack + weight) * x[row];
                residual[row] += 2.0 * (z.tube + weight) * x[row];
                let curved = 4.0 * z.tube / slack * x[row];
                (0..D).for_each(|l| stage.q[row][3 * l] += curved * x[3 * l]);
            }
        }
        for s in 0..N {
            residual[s] -= self.iterate.multipliers[i][s];
            stage.q[s][s] += self.shift;
        }
        error
    }

    /// Adds the bound of a control velocity to its stage. Returns its part of the gradient with
    /// respect to the duration.
    fn feed(&self, i: usize, stage: &mut Stage<N, M>, residual: &mut [f64; N]) -> f64 {
        let WindowIterate {
            problem, at, mu, ..
        } = &self.iterate;
        let (x, u, z) = (&at.x[i], &at.u[i], self.iterate.steps[i].feed);
        let w = problem.feed_weights(i);
        let c = control(&self.steps, x, u);
        let slack = feed_slack(&w, &c);
        // Gradient of `sum w c^2` by velocities and accelerations, and by the duration.
        let (mut by_x, mut by_h) = ([0.0; N], 0.0);
        for k in 0..D {
            let half = 0.5 * self.steps[k].d1;
            let (v, a) = (3 * k + 1, 3 * k + 2);
            let (of_a, of_h) = (half * u[D], half * x[a]);
            by_x[v] = 2.0 * w[k] * c[k];
            by_x[a] = by_x[v] * of_a;
            by_h += by_x[v] * of_h;
            let curved = 2.0 * z * w[k];
            stage.q[v][v] += curved;
            stage.q[v][a] += curved * of_a;
            stage.q[a][v] += curved * of_a;
            stage.q[a][a] += curved * of_a * of_a;
            stage.s[D][v] += curved * of_h;
            stage.s[D][a] += curved * (of_a * of_h + c[k] * half);
            stage.r[D][D] += curved * of_h * of_h;
        }
        for row in (0..N).filter(|row| row % 3 != 0) {
            let f = z / slack * by_x[row];
            (0..N).for_each(|column| stage.q[row][column] += f * by_x[column]);
            stage.s[D][row] += f * by_h;
            stage.gx[row] += mu / slack * by_x[row];
            residual[row] += z * by_x[row];
        }
        stage.r[D][D] += z / slack * by_h * by_h;
        stage.gu[D] += mu / slack * by_h;
        z * by_h
    }

    /// Adds a step to its stage: its derivatives, its second derivatives times their multipliers,
    /// and its bounds. Returns the largest residual.
    fn step(&self, i: usize, stage: &mut Stage<N, M>, residual: &mut [f64; N]) -> f64 {
        let WindowIterate {
            problem, at, mu, ..
        } = &self.iterate;
        let (mu, x, u, z) = (*mu, &at.x[i], &at.u[i], &self.iterate.steps[i]);
        let multipliers = &self.iterate.multipliers[i + 1];
        let h = u[D];
        let slack = h - LEAST_STEP;
        let mut error = (z.h * slack - mu).abs();
        let mut of_h = 1.0 - z.h;
        stage.r[D][D] += z.h / slack + self.shift;
        stage.gu[D] += 1.0 - mu / slack;
        for k in 0..D {
            let c = &self.steps[k];
            let (v, a, j) = (x[3 * k + 1], x[3 * k + 2], u[k]);
            let [lo, lv, la] = [
                multipliers[3 * k],
                multipliers[3 * k + 1],
                multipliers[3 * k + 2],
            ];
            stage.a[k] = [c.c1 * h, 0.5 * c.c2 * h * h, c.d1 * h];
            stage.bj[k] = [c.c3 * h * h * h / 6.0, 0.5 * c.d2 * h * h, c.e1 * h];
            stage.bh[k] = [
                c.c1 * v + c.c2 * a * h + 0.5 * c.c3 * j * h * h,
                c.d1 * a + c.d2 * j * h,
                c.e1 * j,
            ];
            stage.s[D][3 * k + 1] += lo * c.c1;
            stage.s[D][3 * k + 2] += lo * c.c2 * h + lv * c.d1;
            let of_jh = lo * 0.5 * c.c3 * h * h + lv * c.d2 * h + la * c.e1;
            stage.r[k][D] += of_jh;
            stage.r[D][k] += of_jh;
            stage.r[D][D] += lo * (c.c2 * a + c.c3 * j * h) + lv * c.d2 * j;
            let (below, above) = (1.0 + j, 1.0 - j);
            stage.r[k][k] += z.j[k][0] / below + z.j[k][1] / above + self.shift;
            stage.gu[k] += mu / above - mu / below;
            error = larger(
                larger(error, (z.j[k][0] * below - mu).abs()),
                (z.j[k][1] * above - mu).abs(),
            );
            let (bj, bh, along) = (stage.bj[k], stage.bh[k], stage.a[k]);
            let of_j = z.j[k][1] - z.j[k][0] + lo * bj[0] + lv * bj[1] + la * bj[2];
            error = larger(error, of_j.abs());
            of_h += lo * bh[0] + lv * bh[1] + la * bh[2];
            residual[3 * k] += lo;
            residual[3 * k + 1] += lo * along[0] + lv;
            residual[3 * k + 2] += lo * along[1] + lv * along[2] + la;
        }
        of_h += self.feed(i, stage, residual);
        let feed_slack = feed_slack(&problem.feed_weights(i), &control(&self.steps, x, u));
        error = error.max((z.feed * feed_slack - mu).abs());
        let end = problem.end(&self.steps, i, x, u);
        (0..N).for_each(|s| stage.d[s] = end[s] - at.x[i + 1][s]);
        error.max(of_h.abs())
    }
}
