//! Newton steps of a window in time proportional to its nodes: the Riccati recursion of a linear
//! system with a quadratic cost.
//!
//! minimise `sum x'Q x / 2 + u'S x + u'R u / 2 + gx'x + gu'u` with `x+ = A x + B u + d`, `x_0 = 0`.
//! `A` and `B` have the blocks of one axis each, with the duration common to all. Source: Rao,
//! Wright, Rawlings (1998), "Application of interior-point methods to model predictive control",
//! section 3.

/// One node and the step behind it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stage<const N: usize, const M: usize> {
    pub(super) q: [[f64; N]; N],
    pub(super) s: [[f64; N]; M],
    pub(super) r: [[f64; M]; M],
    pub(super) gx: [f64; N],
    pub(super) gu: [f64; M],
    /// Derivatives of each axis over a step: offset by velocity, offset by acceleration, velocity
    /// by acceleration.
    pub(super) a: [[f64; 3]; M],
    /// State of each axis by its jerk.
    pub(super) bj: [[f64; 3]; M],
    /// State of each axis by the duration.
    pub(super) bh: [[f64; 3]; M],
    pub(super) d: [f64; N],
}

impl<const N: usize, const M: usize> Stage<N, M> {
    pub(super) const ZERO: Self = Self {
        q: [[0.0; N]; N],
        s: [[0.0; N]; M],
        r: [[0.0; M]; M],
        gx: [0.0; N],
        gu: [0.0; M],
        a: [[0.0; 3]; M],
        bj: [[0.0; 3]; M],
        bh: [[0.0; 3]; M],
        d: [0.0; N],
    };

    /// A' y.
    #[inline]
    fn at(&self, y: &[f64; N]) -> [f64; N] {
        let mut out = [0.0; N];
        for k in 0..N / 3 {
            let a = &self.a[k];
            let (o, v, c) = (y[3 * k], y[3 * k + 1], y[3 * k + 2]);
            out[3 * k] = o;
            out[3 * k + 1] = a[0] * o + v;
            out[3 * k + 2] = a[1] * o + a[2] * v + c;
        }
        out
    }

    /// B' y.
    #[inline]
    fn bt(&self, y: &[f64; N]) -> [f64; M] {
        let mut out = [0.0; M];
        for k in 0..N / 3 {
            for t in 0..3 {
                out[k] += self.bj[k][t] * y[3 * k + t];
                out[M - 1] += self.bh[k][t] * y[3 * k + t];
            }
        }
        out
    }

    /// `Q + A'PA`, `S + B'PA`, `R + B'PB`: of the symmetric ones the lower triangles.
    #[inline]
    fn condensed(
        &self,
        p: &[[f64; N]; N],
        q: &mut [[f64; N]; N],
        s: &mut [[f64; N]; M],
        r: &mut [[f64; M]; M],
    ) {
        let mut pa = [[0.0; N]; N];
        let mut pb = [[0.0; M]; N];
        for row in 0..N {
            pa[row] = self.at(&p[row]);
            pb[row] = self.bt(&p[row]);
        }
        (*q, *s, *r) = (self.q, self.s, self.r);
        for k in 0..N / 3 {
            let a = &self.a[k];
            let (o, v, c) = (3 * k, 3 * k + 1, 3 * k + 2);
            for column in 0..3 * (k + 1) {
                let (po, pv, pc) = (pa[o][column], pa[v][column], pa[c][column]);
                q[o][column] += po;
                q[v][column] += a[0] * po + pv;
                q[c][column] += a[1] * po + a[2] * pv + pc;
            }
            let (bj, bh) = (&self.bj[k], &self.bh[k]);
            for column in 0..N {
                let (po, pv, pc) = (pa[o][column], pa[v][column], pa[c][column]);
                s[k][column] += bj[0] * po + bj[1] * pv + bj[2] * pc;
                s[M - 1][column] += bh[0] * po + bh[1] * pv + bh[2] * pc;
            }
            for column in 0..=k {
                r[k][column] +=
                    bj[0] * pb[o][column] + bj[1] * pb[v][column] + bj[2] * pb[c][column];
            }
            for column in 0..M {
                r[M - 1][column] +=
                    bh[0] * pb[o][column] + bh[1] * pb[v][column] + bh[2] * pb[c][column];
            }
        }
    }
}

/// A Newton step, and the multipliers that it leads to.
#[derive(Debug)]
pub(super) struct NewtonStep<const N: usize, const M: usize> {
    pub(super) dx: Vec<[f64; N]>,
    pub(super) du: Vec<[f64; M]>,
    pub(super) multipliers: Vec<[f64; N]>,
    p: Vec<[[f64; N]; N]>,
    pv: Vec<[f64; N]>,
    gain: Vec<[[f64; N]; M]>,
    k: Vec<[f64; M]>,
}

impl<const N: usize, const M: usize> NewtonStep<N, M> {
    /// Allocates the Newton step of a window with `n` steps.
    pub(super) fn new(n: usize) -> Self {
        Self {
            dx: vec![[0.0; N]; n + 1],
            du: vec![[0.0; M]; n],
            multipliers: vec![[0.0; N]; n + 1],
            p: vec![[[0.0; N]; N]; n + 1],
            pv: vec![[0.0; N]; n + 1],
            gain: vec![[[0.0; N]; M]; n],
            k: vec![[0.0; M]; n],
        }
    }

    /// Sweeps from the last node to the first. Returns `false` if the cost is not convex in the
    /// free variables.
    pub(super) fn backward(&mut self, stages: &[Stage<N, M>]) -> bool {
        let n = stages.len() - 1;
        self.p[n] = stages[n].q;
        self.pv[n] = stages[n].gx;
        for i in (0..n).rev() {
            let stage = &stages[i];
            let p = &self.p[i + 1];
            let mut pd = self.pv[i + 1];
            for row in 0..N {
                pd[row] += (0..N)
                    .map(|column| p[row][column] * stage.d[column])
                    .sum::<f64>();
            }
            let (mut q, mut y, mut r) = ([[0.0; N]; N], [[0.0; N]; M], [[0.0; M]; M]);
            stage.condensed(p, &mut q, &mut y, &mut r);
            let (mut gx, mut yk) = (stage.at(&pd), stage.bt(&pd));
            (0..N).for_each(|t| gx[t] += stage.gx[t]);
            (0..M).for_each(|t| yk[t] += stage.gu[t]);
            let Some(l) = cholesky(&r) else {
                return false;
            };
            divide_by_lower(&l, &mut y, &mut yk);
            for row in 0..N {
                for t in 0..M {
                    let f = y[t][row];
                    (0..=row).for_each(|column| q[row][column] -= f * y[t][column]);
                    gx[row] -= f * yk[t];
                }
            }
            divide_by_upper(&l, &mut y, &mut yk);
            for row in 0..N {
                (0..row).for_each(|column| q[column][row] = q[row][column]);
            }
            (self.p[i], self.pv[i], self.gain[i], self.k[i]) = (q, gx, y, yk);
        }
        true
    }

    /// Sweeps from the first node to the last, after [`Self::backward`].
    pub(super) fn forward(&mut self, stages: &[Stage<N, M>]) {
        self.dx[0] = [0.0; N];
        for (i, stage) in stages.iter().enumerate() {
            let dx = self.dx[i];
            let mut multipliers = self.pv[i];
            for row in 0..N {
                multipliers[row] += (0..N)
                    .map(|column| self.p[i][row][column] * dx[column])
                    .sum::<f64>();
            }
            self.multipliers[i] = multipliers;
            if i + 1 == stages.len() {
                break;
            }
            let mut du = [0.0; M];
            for row in 0..M {
                let along: f64 = (0..N)
                    .map(|column| self.gain[i][row][column] * dx[column])
                    .sum();
                du[row] = -self.k[i][row] - along;
            }
            let mut next = stage.d;
            for k in 0..N / 3 {
                let a = &stage.a[k];
                let (o, v, c) = (dx[3 * k], dx[3 * k + 1], dx[3 * k + 2]);
                let (bj, bh) = (&stage.bj[k], &stage.bh[k]);
                next[3 * k] += o + a[0] * v + a[1] * c + bj[0] * du[k] + bh[0] * du[M - 1];
                next[3 * k + 1] += v + a[2] * c + bj[1] * du[k] + bh[1] * du[M - 1];
                next[3 * k + 2] += c + bj[2] * du[k] + bh[2] * du[M - 1];
            }
            self.du[i] = du;
            self.dx[i + 1] = next;
        }
    }
}

/// A pivot must be more than this part of its diagonal: below it is rounding.
const LEAST_PIVOT: f64 = 1e-14;

/// Lower triangle `L` with `L L' = r`; none where `r` is not positive definite.
#[inline]
fn cholesky<const M: usize>(r: &[[f64; M]; M]) -> Option<[[f64; M]; M]> {
    let mut l = [[0.0; M]; M];
    for row in 0..M {
        for column in 0..=row {
            let rest = (0..column).fold(r[row][column], |rest, t| rest - l[row][t] * l[column][t]);
            if row == column {
                let positive = rest > LEAST_PIVOT * (1.0 + r[row][row].abs());
                if !positive {
                    return None;
                }
                l[row][row] = rest.sqrt();
            } else {
                l[row][column] = rest / l[column][column];
            }
        }
    }
    Some(l)
}

/// `L^-1` times the rows of `y`, and times `k`.
#[inline]
fn divide_by_lower<const N: usize, const M: usize>(
    l: &[[f64; M]; M],
    y: &mut [[f64; N]; M],
    k: &mut [f64; M],
) {
    for row in 0..M {
        for t in 0..row {
            let f = l[row][t];
            (0..N).for_each(|column| y[row][column] -= f * y[t][column]);
            k[row] -= f * k[t];
        }
        let f = 1.0 / l[row][row];
        (0..N).for_each(|column| y[row][column] *= f);
        k[row] *= f;
    }
}

/// `L'^-1` times the same.
#[inline]
fn divide_by_upper<const N: usize, const M: usize>(
    l: &[[f64; M]; M],
    y: &mut [[f64; N]; M],
    k: &mut [f64; M],
) {
    for row in (0..M).rev() {
        for t in row + 1..M {
            let f = l[t][row];
            (0..N).for_each(|column| y[row][column] -= f * y[t][column]);
            k[row] -= f * k[t];
        }
        let f = 1.0 / l[row][row];
        (0..N).for_each(|column| y[row][column] *= f);
        k[row] *= f;
    }
}
