//! A window of the path as an optimisation problem.
//!
//! Nodes `c_i` lie on the programmed path. Of each node are unknown its offset `o`, velocity `v`
//! and acceleration `a`, of each step between two nodes its duration `h` and its jerk `j`, which is
//! constant:
//!
//! `c' + o' = c + o + h v + h^2 a / 2 + h^3 j / 6`, `v' = v + h a + h^2 j / 2`, `a' = a + h j` for
//! each axis.
//!
//! Every unknown is measured in a unit of its own, so that it is about 1.

/// Units of the unknowns.
#[derive(Debug, Clone, Copy)]
pub(super) struct WindowUnits<const D: usize> {
    /// Unit of durations.
    pub(super) step_s: f64,
    /// Unit of offsets.
    pub(super) offset_mm: f64,
    /// Units of velocities, accelerations and jerks: the limits of the axes.
    pub(super) velocity_mm_s: [f64; D],
    pub(super) accel_mm_s2: [f64; D],
    pub(super) jerk_mm_s3: [f64; D],
}

/// A window from node 0 to node `way.len()`, in units. `N` is `3 D`: offset, velocity, acceleration
/// of the first axis, of the second...
#[derive(Debug, Clone)]
pub(super) struct WindowProblem<const D: usize, const N: usize> {
    pub(super) units: WindowUnits<D>,
    /// Vector from each node to the next.
    pub(super) way: Vec<[f64; D]>,
    /// Largest length of the offset of each node.
    pub(super) radius: Vec<f64>,
    /// Largest length of the control velocity of each step, mm/s.
    pub(super) feed_mm_s: Vec<f64>,
    /// Time that an offset at the edge of the tube costs at a node, as a part of the unit of
    /// durations.
    pub(super) offset_cost: f64,
    /// State of the first node.
    pub(super) first: [f64; N],
    /// True where the last node has no offset.
    pub(super) exact_end: bool,
}

/// Values of the unknowns, in units: states of nodes, and of each step the jerks and the duration.
#[derive(Debug, Clone)]
pub(super) struct WindowUnknowns<const N: usize, const M: usize> {
    pub(super) x: Vec<[f64; N]>,
    pub(super) u: Vec<[f64; M]>,
}

/// Coefficients of a step of one axis, in units.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepOfAxis {
    pub(super) c1: f64,
    pub(super) c2: f64,
    pub(super) c3: f64,
    pub(super) d1: f64,
    pub(super) d2: f64,
    pub(super) e1: f64,
}

impl StepOfAxis {
    fn of<const D: usize>(units: &WindowUnits<D>, k: usize) -> Self {
        let (h, p) = (units.step_s, units.offset_mm);
        let (v, a, j) = (
            units.velocity_mm_s[k],
            units.accel_mm_s2[k],
            units.jerk_mm_s3[k],
        );
        Self {
            c1: h * v / p,
            c2: h * h * a / p,
            c3: h * h * h * j / p,
            d1: h * a / v,
            d2: h * h * j / v,
            e1: h * j / a,
        }
    }

    fn end(&self, [o, v, a]: [f64; 3], j: f64, h: f64) -> [f64; 3] {
        [
            o + h * (self.c1 * v + h * (0.5 * self.c2 * a + h * self.c3 * j / 6.0)),
            v + h * (self.d1 * a + 0.5 * h * self.d2 * j),
            a + h * self.e1 * j,
        ]
    }
}

impl<const D: usize, const N: usize> WindowProblem<D, N> {
    /// Returns the step coefficients of all axes.
    pub(super) fn steps(&self) -> [StepOfAxis; D] {
        std::array::from_fn(|k| StepOfAxis::of(&self.units, k))
    }

    /// The state at the end of step `i`.
    pub(super) fn end<const M: usize>(
        &self,
        steps: &[StepOfAxis; D],
        i: usize,
        x: &[f64; N],
        u: &[f64; M],
    ) -> [f64; N] {
        let mut end = [0.0; N];
        for k in 0..D {
            let [o, v, a] = steps[k].end([x[3 * k], x[3 * k + 1], x[3 * k + 2]], u[k], u[D]);
            end[3 * k] = o - self.way[i][k];
            end[3 * k + 1] = v;
            end[3 * k + 2] = a;
        }
        end
    }

    /// Weights `w` of the squares of control velocities, `sum w c^2 <= 1` in a step.
    pub(super) fn feed_weights(&self, i: usize) -> [f64; D] {
        std::array::from_fn(|k| (self.units.velocity_mm_s[k] / self.feed_mm_s[i]).powi(2))
    }

    /// Cost of the square of the offset at a node, in units.
    pub(super) fn offset_weight(&self, i: usize) -> f64 {
        self.offset_cost / (self.radius[i] * self.radius[i])
    }

    /// Returns true if a component of the last state is given, because the axes rest there.
    pub(super) const fn is_given(&self, component: usize) -> bool {
        !component.is_multiple_of(3) || self.exact_end
    }

    /// The states that the jerks and durations lead to from the first state, without any defect;
    /// what that misses the last state by is made up by the jerks.
    pub(super) fn roll_out<const M: usize>(&self, unknowns: &mut WindowUnknowns<N, M>) {
        let n = self.way.len();
        let mut target = unknowns.x[n];
        (0..N)
            .filter(|&s| self.is_given(s))
            .for_each(|s| target[s] = 0.0);
        unknowns.x[0] = self.first;
        for k in 0..D {
            self.roll(k, [0, n], unknowns);
            self.steer(
                unknowns,
                k,
                [0, n],
                [target[3 * k], target[3 * k + 1], target[3 * k + 2]],
            );
        }
    }

    /// Changes the jerks of an axis between two nodes by as little as possible so that it comes to
    /// a state at the second one. With durations given, that is linear in the jerks.
    pub(super) fn steer<const M: usize>(
        &self,
        unknowns: &mut WindowUnknowns<N, M>,
        k: usize,
        [from, to]: [usize; 2],
        target: [f64; 3],
    ) {
        let step = StepOfAxis::of(&self.units, k);
        let missed: [f64; 3] = std::array::from_fn(|t| unknowns.x[to][3 * k + t] - target[t]);
        // How the end follows from the jerk of each step, from the last to the first.
        let mut to_end = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mut by_jerk = vec![[0.0; 3]; to - from];
        for i in (from..to).rev() {
            let h = unknowns.u[i][D];
            let b = [
                step.c3 * h * h * h / 6.0,
                0.5 * step.d2 * h * h,
                step.e1 * h,
            ];
            by_jerk[i - from] = to_end.map(|row| row[0] * b[0] + row[1] * b[1] + row[2] * b[2]);
            let (ov, oa, va) = (step.c1 * h, 0.5 * step.c2 * h * h, step.d1 * h);
            to_end = to_end.map(|[o, v, a]| [o, v + o * ov, a + o * oa + v * va]);
        }
        let mut gram = [[0.0; 3]; 3];
        for g in &by_jerk {
            (0..9).for_each(|t| gram[t / 3][t % 3] += g[t / 3] * g[t % 3]);
        }
        let Some(weights) = solved(gram, missed) else {
            return;
        };
        for (u, g) in unknowns.u[from..to].iter_mut().zip(&by_jerk) {
            u[k] -= weights[0] * g[0] + weights[1] * g[1] + weights[2] * g[2];
        }
        self.roll(k, [from, to], unknowns);
    }

    /// The states of an axis from one node to another that its jerks and the durations lead to.
    pub(super) fn roll<const M: usize>(
        &self,
        k: usize,
        [from, to]: [usize; 2],
        unknowns: &mut WindowUnknowns<N, M>,
    ) {
        let step = StepOfAxis::of(&self.units, k);
        for i in from..to {
            let (x, u) = (&unknowns.x[i], &unknowns.u[i]);
            let [o, v, a] = step.end([x[3 * k], x[3 * k + 1], x[3 * k + 2]], u[k], u[D]);
            let next = &mut unknowns.x[i + 1];
            (next[3 * k], next[3 * k + 1], next[3 * k + 2]) = (o - self.way[i][k], v, a);
        }
    }
}

/// Solves three equations by elimination with pivots; none where they are singular.
fn solved(mut m: [[f64; 3]; 3], mut y: [f64; 3]) -> Option<[f64; 3]> {
    for c in 0..3 {
        let pivot = (c..3).max_by(|&a, &b| m[a][c].abs().total_cmp(&m[b][c].abs()))?;
        m.swap(c, pivot);
        y.swap(c, pivot);
        if m[c][c] == 0.0 {
            return None;
        }
        for r in c + 1..3 {
            let f = m[r][c] / m[c][c];
            (c..3).for_each(|t| m[r][t] -= f * m[c][t]);
            y[r] -= f * y[c];
        }
    }
    let z = y[2] / m[2][2];
    let v = (y[1] - m[1][2] * z) / m[1][1];
    Some([(y[0] - m[0][1] * v - m[0][2] * z) / m[0][0], v, z])
}
