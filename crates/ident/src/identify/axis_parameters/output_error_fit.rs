//! Least squares of what a free run leaves of the measured positions, by steps of Gauss and Newton
//! with Levenberg's and Marquardt's damping.

use feedwright_control::{AxisModel, Parameters};
use feedwright_sim::map_in_parallel;
use nalgebra::{DMatrix, DVector};

use super::free_run::FreeRun;
use super::{AxisEstimate, IDENTIFIED, NotIdentified, RIGID, identified};

const PARAMETERS: usize = IDENTIFIED.len();

/// Knots that the speed at the start is taken over: the mean of five differences has a fifth of the
/// noise of one.
pub(super) const START_KNOTS: usize = 5;
/// Speed loop beside the position loop, before anything is known: Kv / J four times Kp, as loops
/// are usually set.
const LOOPS_APART: f64 = 4.0;
/// Coulomb friction before anything is known, a part of the torque limit; the first steps find it
/// from anywhere.
const FRICTION_SHARE: f64 = 0.01;
/// Presliding before anything is known, and the least that is distinguished from zero, mm of
/// travel: a fiftieth of the usual 10 um.
const PRESLIDING_MM: [f64; 2] = [0.005, 0.0002];
/// Scales of a screw: share of the table, damping ratio, and backlash, mm of travel; the resonance
/// is its own.
const SCREW_SCALES: [f64; 3] = [0.5, 0.05, 0.005];
/// Differences to both sides that a derivative is taken over, parts of the scales. A free run that
/// sticks and slips is not smooth: over differences of a thousandth the derivatives on workshop are
/// mostly that, and 30 steps do not suffice where these need four to six.
const DIFFERENCES: [f64; PARAMETERS] = [0.05, 0.5, 0.1, 0.1, 0.1, 0.05, 0.02, 0.2, 0.1];
/// Smallest inertia after a step, as a part of the inertia before it: the model does not exist
/// below zero.
const LEAST_INERTIA_STEP: f64 = 0.3;
/// Bounds of the table's share, of the damping ratio, and of the resonance: 1/s, and turns in a
/// servo period beyond which it is not sampled.
const SHARES: [f64; 2] = [0.05, 0.95];
const DAMPING_RATIOS: [f64; 2] = [0.0, 0.7];
const LEAST_RESONANCE_RAD_S: f64 = 30.0;
const MOST_RESONANCE_RAD: f64 = 2.0;
/// Part of the squares below which a step gains nothing: on workshop V itself is irregular by that
/// much, and parameters move by less than their standard errors.
const DONE: f64 = 2e-3;
/// Steps at the most; three to ten are usual.
const MAX_STEPS: u32 = 30;
/// Damping of Levenberg and Marquardt: at the start, after a step that helped and after one that
/// did not; given up at the last.
const DAMPING: f64 = 1e-3;
const DAMPING_AFTER: [f64; 2] = [0.1, 10.0];
const DAMPING_MOST: f64 = 1e6;

/// Commands and measured positions of an axis, mm.
#[derive(Clone)]
pub(super) struct Stretch {
    pub(super) commands_mm: Vec<f64>,
    pub(super) measured_mm: Vec<f64>,
}

/// Data and settings of a fit.
pub(super) struct OutputErrorFit {
    /// The axis as it is known.
    pub(super) known: AxisModel,
    pub(super) stretches: Vec<Stretch>,
    /// Knots at the beginning of a stretch that are left out.
    pub(super) settled: usize,
}

/// The sum of squares, and a step's equations, in parameters over their scales.
struct Linearised {
    gradient: DVector<f64>,
    curvature: DMatrix<f64>,
    /// Sum of the squares of the gradient's parts by stretch.
    scatter: DMatrix<f64>,
}

/// State of a search.
pub(super) struct FitState {
    pub(super) at: Parameters,
    scales: [f64; PARAMETERS],
    /// Number of parameters that are searched, from the first on.
    free: usize,
    left: Vec<Vec<f64>>,
    here: Linearised,
    damping: f64,
    steps: u32,
    done: bool,
}

impl FitState {
    /// Sum of the squares of what is left, mm^2.
    pub(super) fn squares_mm2(&self) -> f64 {
        squares(&self.left)
    }

    /// The same, stretch by stretch.
    pub(super) fn by_stretch_mm2(&self) -> impl Iterator<Item = f64> + '_ {
        self.left
            .iter()
            .map(|stretch| stretch.iter().map(|left| left * left).sum())
    }
}

impl OutputErrorFit {
    /// Identifies an axis with a rigid screw.
    pub(super) fn rigid(&self) -> Result<AxisEstimate, NotIdentified> {
        let [inertia, _, coulomb, _, presliding, ..] = self.scales(&Parameters::NOTHING);
        let start = Parameters {
            inertia_kg_m2: inertia,
            coulomb_friction_nm: coulomb,
            presliding_rad: presliding,
            ..Parameters::NOTHING
        };
        let mut state = self.start(start, RIGID);
        self.steps(&mut state, MAX_STEPS)?;
        self.estimate(&state)
    }

    /// The same over each so-manieth stretch.
    pub(super) fn every(&self, nth: usize) -> Self {
        let stretches = self.stretches.iter().step_by(nth).cloned().collect();
        Self {
            known: self.known,
            stretches,
            settled: self.settled,
        }
    }

    /// Begins a search of the first `free` parameters.
    pub(super) fn start(&self, at: Parameters, free: usize) -> FitState {
        let scales = self.scales(&at);
        let left = self.left_mm(&at);
        let here = self.linearised(&at, &scales, free, &left);
        FitState {
            at,
            scales,
            free,
            left,
            here,
            damping: DAMPING,
            steps: 0,
            done: false,
        }
    }

    /// Continues a search by at most `most` steps.
    pub(super) fn steps(&self, state: &mut FitState, most: u32) -> Result<(), NotIdentified> {
        for _ in 0..most {
            if state.done || state.damping >= DAMPING_MOST {
                break;
            }
            state.steps += 1;
            let mut damped = state.here.curvature.clone();
            let most = damped.diagonal().max();
            for i in 0..state.free {
                // Without friction for a moment, presliding changes nothing, and stays what it is.
                damped[(i, i)] = if damped[(i, i)] == 0.0 {
                    most
                } else {
                    damped[(i, i)] * (1.0 + state.damping)
                };
            }
            let step = damped
                .cholesky()
                .ok_or(NotIdentified::NotExcited)?
                .solve(&state.here.gradient);
            let next = self.stepped(state, &step);
            let next_left = self.left_mm(&next);
            let gained = 1.0 - squares(&next_left) / squares(&state.left);
            // What is not a number is no gain.
            if gained >= 0.0 {
                (state.at, state.left, state.damping) =
                    (next, next_left, state.damping * DAMPING_AFTER[0]);
                state.here = self.linearised(&state.at, &state.scales, state.free, &state.left);
            } else {
                state.damping *= DAMPING_AFTER[1];
            }
            state.done = gained.abs() < DONE;
        }
        Ok(())
    }

    /// Sizes of the parameters before anything is known; those of all but the inertia and the
    /// presliding begin at zero.
    fn scales(&self, at: &Parameters) -> [f64; PARAMETERS] {
        let Parameters {
            rad_per_mm,
            kp_1_s,
            kv_nm_s_per_rad,
            torque_limit_nm,
            ..
        } = self.known.parameters;
        let friction_nm = FRICTION_SHARE * torque_limit_nm;
        let inertia = kv_nm_s_per_rad / (LOOPS_APART * kp_1_s);
        let [share, damping_ratio, backlash_mm] = SCREW_SCALES;
        [
            inertia,
            0.01 * kv_nm_s_per_rad,
            friction_nm,
            friction_nm,
            PRESLIDING_MM[0] * rad_per_mm,
            share,
            at.resonance_rad_s,
            damping_ratio,
            backlash_mm * rad_per_mm,
        ]
    }

    /// Returns the residual of each measured position against the free run of these parameters, mm,
    /// by stretch.
    fn left_mm(&self, at: &Parameters) -> Vec<Vec<f64>> {
        self.left_of_each_mm([*at])
            .into_iter()
            .map(|[left]| left)
            .collect()
    }

    /// The same of several sets of parameters.
    fn left_of_each_mm<const M: usize>(&self, at: [Parameters; M]) -> Vec<[Vec<f64>; M]> {
        let runs = at.map(|at| FreeRun::new(&self.known, &at));
        let left = |stretch: &Stretch| {
            let Stretch {
                commands_mm,
                measured_mm,
            } = stretch;
            let moved_mm = measured_mm[START_KNOTS] - measured_mm[0];
            let start_mm_s = moved_mm / (START_KNOTS as f64 * self.known.periods.servo_s);
            FreeRun::measured_mm(&runs, commands_mm, measured_mm[0], start_mm_s).map(
                |simulated_mm| {
                    let pairs = measured_mm.iter().zip(&simulated_mm).skip(self.settled);
                    pairs
                        .map(|(measured, simulated)| measured - simulated)
                        .collect()
                },
            )
        };
        map_in_parallel(&self.stretches, left)
    }

    fn linearised(
        &self,
        at: &Parameters,
        scales: &[f64; PARAMETERS],
        free: usize,
        left: &[Vec<f64>],
    ) -> Linearised {
        let moved_by = |i: usize, by: f64| {
            let mut values = identified::row(*at);
            values[i] += by * DIFFERENCES[i] * scales[i];
            identified::of_row(values)
        };
        let both = |i: usize| [-1.0, 1.0].map(|by| moved_by(i, by));
        let mut moved: Vec<Vec<[Vec<f64>; 2]>> = Vec::with_capacity(free);
        // Two parameters at once take less than twice the time of one.
        for i in (0..free).step_by(2) {
            let [below, above] = both(i);
            if i + 1 == free {
                moved.push(self.left_of_each_mm([below, above]));
                break;
            }
            let [next_below, next_above] = both(i + 1);
            let (mut first, mut second) = (Vec::new(), Vec::new());
            for [a, b, c, d] in self.left_of_each_mm([below, above, next_below, next_above]) {
                first.push([a, b]);
                second.push([c, d]);
            }
            moved.extend([first, second]);
        }
        let mut curvature = DMatrix::zeros(free, free);
        let (mut scatter, mut gradient) = (DMatrix::zeros(free, free), DVector::zeros(free));
        let mut slopes = DVector::zeros(free);
        for (stretch, left) in left.iter().enumerate() {
            let mut of_stretch = DVector::zeros(free);
            for (k, left) in left.iter().enumerate() {
                for (i, moved) in moved.iter().enumerate() {
                    let [below, above] = &moved[stretch];
                    slopes[i] = (below[k] - above[k]) / (2.0 * DIFFERENCES[i]);
                }
                of_stretch.axpy(*left, &slopes, 1.0);
                curvature.ger(1.0, &slopes, &slopes, 1.0);
            }
            scatter.ger(1.0, &of_stretch, &of_stretch, 1.0);
            gradient += of_stretch;
        }
        Linearised {
            gradient,
            curvature,
            scatter,
        }
    }

    /// Returns the parameters after a step, held within the range in which the model exists.
    fn stepped(&self, state: &FitState, step: &DVector<f64>) -> Parameters {
        let mut values = identified::row(state.at);
        for (i, step) in step.iter().enumerate() {
            values[i] += step * state.scales[i];
        }
        let mut next = identified::of_row(values);
        next.inertia_kg_m2 = next
            .inertia_kg_m2
            .max(LEAST_INERTIA_STEP * state.at.inertia_kg_m2);
        next.viscous_friction_nm_s = next.viscous_friction_nm_s.max(0.0);
        next.coulomb_friction_nm = next.coulomb_friction_nm.max(0.0);
        next.presliding_rad = next
            .presliding_rad
            .max(PRESLIDING_MM[1] * self.known.parameters.rad_per_mm);
        if state.free > RIGID {
            let most_rad_s = MOST_RESONANCE_RAD / self.known.periods.servo_s;
            next.table_share = next.table_share.clamp(SHARES[0], SHARES[1]);
            next.resonance_rad_s = next
                .resonance_rad_s
                .max(LEAST_RESONANCE_RAD_S)
                .min(most_rad_s);
            next.damping_ratio = next
                .damping_ratio
                .clamp(DAMPING_RATIOS[0], DAMPING_RATIOS[1]);
            next.backlash_rad = next.backlash_rad.max(0.0);
        }
        next
    }

    /// Returns the result of a search.
    pub(super) fn estimate(&self, state: &FitState) -> Result<AxisEstimate, NotIdentified> {
        let inverse = state
            .here
            .curvature
            .clone()
            .cholesky()
            .ok_or(NotIdentified::NotExcited)?
            .inverse();
        let n = self.stretches.len() as f64;
        let covariance = &inverse * &state.here.scatter * &inverse * (n / (n - 1.0));
        let standard = |i: usize| covariance[(i, i)].max(0.0).sqrt() * state.scales[i];
        let standard = std::array::from_fn(|i| if i < state.free { standard(i) } else { 0.0 });
        let knots: usize = state.left.iter().map(Vec::len).sum();
        let left_um = (state.squares_mm2() / knots as f64).sqrt() * 1e3;
        let mut at = state.at;
        if at.presliding_rad <= PRESLIDING_MM[1] * self.known.parameters.rad_per_mm {
            at.presliding_rad = 0.0;
        }
        let standard_errors = identified::of_row(standard);
        Ok(AxisEstimate {
            parameters: at,
            standard_errors,
            left_um,
            steps: state.steps,
        })
    }
}

fn squares(left: &[Vec<f64>]) -> f64 {
    left.iter().flatten().map(|left| left * left).sum()
}
