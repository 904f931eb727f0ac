//! Training of the servo identifier: least squares for its linear part and for the outputs of its hidden nodes.
//!
//! ```text
//! minimise sum |e(k+1) - e(k) - L I(k) - Wo f(Wh I(k))|^2 + r sum_i s_i^2 w_i^2
//! ```
//!
//! over the samples of all stretches, where s_i^2 is the sum of squares of what the weight w_i sees: inputs count in the scale that
//! they have in the data. It is solved by the normal equations and Cholesky's factorisation. L alone first; Wh then follows from
//! L: its nodes see the sign of the tool's speed, which is where a servo is not linear. With Wh laid, the rest is one linear
//! solution, in place of a descent that needs starting weights. Last, the same once more, with everything filtered by the
//! autoregression of what was missed: a disturbance of 25 Hz then takes no part in the weights.
//!
//! Source: ridge regression, Hoerl and Kennard (1970); hidden layers that are laid instead of trained, Schmidt, Kraaijveld
//! and Duin (1992); generalised least squares, Clarke (1967).

use feedwright_control::{
    Delays, FEED_SCALE_MM_S, FOLLOWING_SCALE_MM, HIDDEN, INPUTS, Identifier, Inputs, ServoIdentifier, ServoModel,
    Spread,
};
use feedwright_plan::vector::{scale, sub};
use nalgebra::{DMatrix, DVector};

use super::recording::{RecordedKnot, Recording};
use super::spread::spread;

/// r: keeps the equations regular where two inputs always move together, and is far below what tells any others apart.
const RIDGE: f64 = 1e-9;

/// Lags of the autoregression: three predict a constant and a sine of any frequency, more average noise out.
const LAGS: usize = 6;

/// A trained servo identifier and how well it fits.
#[derive(Debug, Clone, PartialEq)]
pub struct TrainedServo<const N: usize> {
    /// The network.
    pub net: ServoIdentifier<N>,
    /// RMS of the prediction error of one knot, um per axis.
    pub fit_um: f64,
    /// Samples it was trained on.
    pub samples: usize,
    /// How other machines of its kind differ.
    pub spread: Spread<N>,
}

/// One sample: the inputs, and the growth of the following error that followed, mm.
struct ServoSample<const N: usize> {
    inputs: Inputs<N>,
    grown_mm: [f64; N],
}

/// Fits the identifier to what a machine showed.
pub fn train_servo<const N: usize>(recording: &Recording<N>) -> TrainedServo<N> {
    let period_s = recording.feed_period_s;
    let laps: Vec<Vec<ServoSample<N>>> = recording.stretches.iter().map(|stretch| samples(stretch, period_s)).collect();
    let net = fit(&laps, period_s);
    let missed = laps.iter().flatten().map(|sample| sub(sample.grown_mm, net.predict(&sample.inputs)));
    let squares: f64 = missed.map(|missed| missed.iter().map(|m| m * m).sum::<f64>()).sum();
    let samples: usize = laps.iter().map(Vec::len).sum();
    let fit_um = (squares / (N * samples.max(1)) as f64).sqrt() * 1e3;
    TrainedServo { spread: spread(&net, period_s), net, fit_um, samples }
}

/// What the identifier would have seen from knot to knot of a stretch, once its delays are filled.
fn samples<const N: usize>(lap: &[RecordedKnot<N>], period_s: f64) -> Vec<ServoSample<N>> {
    let following = |i: usize| sub(lap[i].command_mm, lap[i].tool_mm);
    let mut delays = Delays::<N>::REST;
    let mut samples = Vec::new();
    for i in 0..lap.len().saturating_sub(1) {
        let feed = scale(1.0 / (period_s * FEED_SCALE_MM_S), sub(lap[i + 1].command_mm, lap[i].command_mm));
        let next = following(i + 1);
        samples.push(ServoSample { inputs: delays.inputs(feed), grown_mm: sub(next, following(i)) });
        delays.push(feed, scale(1.0 / FOLLOWING_SCALE_MM, next));
    }
    samples
}

/// The linear part alone first, since the hidden nodes are laid along it; then both parts together; then both again,
/// filtered by what they miss.
fn fit<const N: usize>(laps: &[Vec<ServoSample<N>>], period_s: f64) -> ServoIdentifier<N> {
    let plain = [[0.0; LAGS]; N];
    let linear = fit_outputs(laps, ServoIdentifier::NULL, &plain);
    let hidden = hidden(&linear, period_s);
    let net = fit_outputs(laps, ServoIdentifier { hidden, ..linear }, &plain);
    let filter = autoregression(laps, &net);
    fit_outputs(laps, net, &filter)
}

/// The autoregression of what the network misses, axis by axis: what filters a vibration out of the samples, which would pass
/// for a part of the machine otherwise.
fn autoregression<const N: usize>(laps: &[Vec<ServoSample<N>>], net: &ServoIdentifier<N>) -> [[f64; LAGS]; N] {
    let mut equations = vec![NormalEquations::new(LAGS); N];
    for lap in laps {
        let missed_mm: Vec<[f64; N]> =
            lap.iter().map(|sample| sub(sample.grown_mm, net.predict(&sample.inputs))).collect();
        for past in missed_mm.windows(LAGS + 1) {
            for (axis, equations) in equations.iter_mut().enumerate() {
                equations.add(&DVector::from_fn(LAGS, |lag, _| past[LAGS - 1 - lag][axis]), past[LAGS][axis]);
            }
        }
    }
    std::array::from_fn(|axis| {
        // A machine that misses nothing has no pattern to filter.
        equations[axis].solve().map_or([0.0; LAGS], |found| std::array::from_fn(|lag| found[lag]))
    })
}

/// Speeds over which a hidden node turns its sign, mm/s: those at which Coulomb friction does, and the change of speed
/// within a knot at reversal, which smears it.
const TURNS_OVER_MM_S: [f64; 3] = [0.25, 1.0, 4.0];

/// Hidden nodes that see the sign of the tool's speed in an axis, at the start and at the end of the knot, and so how long
/// within it friction pushes which way: what is not linear in a servo.
fn hidden<const N: usize>(linear: &ServoIdentifier<N>, period_s: f64) -> [[[f64; HIDDEN]; INPUTS]; N] {
    let mut hidden = [[[0.0; HIDDEN]; INPUTS]; N];
    // The growth of e in a knot, mm, as a feedrate that the network sees as 1.
    let speed = 1.0 / (period_s * FEED_SCALE_MM_S);
    for node in 0..HIDDEN {
        let axis = node % N;
        let turns_over = TURNS_OVER_MM_S[(node / N / 2) % TURNS_OVER_MM_S.len()];
        // The bipolar sigmoid is tanh(x / 2).
        let steepness = 2.0 * FEED_SCALE_MM_S / turns_over;
        if (node / N).is_multiple_of(2) {
            // At the start: F(k-1) less the growth of e in the last knot.
            hidden[axis][1][node] = steepness;
            hidden[axis][3][node] = -steepness * speed * FOLLOWING_SCALE_MM;
            hidden[axis][4][node] = steepness * speed * FOLLOWING_SCALE_MM;
        } else {
            // At the end: F(k) less the growth of e that the linear part foresees.
            hidden[axis][0][node] = steepness;
            for other in 0..N {
                for input in 0..INPUTS {
                    hidden[other][input][node] -= steepness * speed * linear.linear[axis][other][input];
                }
            }
        }
    }
    hidden
}

/// The least squares over the linear connection and the outputs of the hidden nodes, which stay as they are, of the samples
/// behind a filter.
fn fit_outputs<const N: usize>(
    laps: &[Vec<ServoSample<N>>],
    net: ServoIdentifier<N>,
    filter: &[[f64; LAGS]; N],
) -> ServoIdentifier<N> {
    let nodes = if net.hidden.as_flattened().as_flattened().iter().all(|w| *w == 0.0) { 0 } else { HIDDEN };
    let unknowns = N * INPUTS + nodes;
    let mut equations = vec![NormalEquations::new(unknowns); N];
    for lap in laps {
        let seen: Vec<DVector<f64>> = lap.iter().map(|sample| seen(&net, sample, nodes)).collect();
        for k in LAGS..lap.len() {
            for (axis, equations) in equations.iter_mut().enumerate() {
                let (mut inputs, mut grown_mm) = (seen[k].clone(), lap[k].grown_mm[axis]);
                for (lag, coefficient) in filter[axis].iter().enumerate() {
                    inputs.axpy(-coefficient, &seen[k - 1 - lag], 1.0);
                    grown_mm -= coefficient * lap[k - 1 - lag].grown_mm[axis];
                }
                equations.add(&inputs, grown_mm);
            }
        }
    }
    let mut solutions = Vec::new();
    for equations in &equations {
        // With the ridge the matrix is positive definite unless a sample is not finite: then nothing was identified.
        let Some(solution) = equations.solve() else { return ServoIdentifier::NULL };
        solutions.push(solution);
    }
    let linear = std::array::from_fn(|o| {
        std::array::from_fn(|axis| std::array::from_fn(|input| solutions[o][axis * INPUTS + input]))
    });
    let output = std::array::from_fn(|o| {
        std::array::from_fn(|node| if node < nodes { solutions[o][N * INPUTS + node] } else { 0.0 })
    });
    ServoIdentifier { linear, output, ..net }
}

/// The inputs of a sample, and the first hidden nodes at them.
fn seen<const N: usize>(net: &ServoIdentifier<N>, sample: &ServoSample<N>, nodes: usize) -> DVector<f64> {
    let hidden = net.hidden_nodes(&sample.inputs);
    let all = sample.inputs.as_flattened().iter().chain(&hidden[..nodes]);
    DVector::from_iterator(N * INPUTS + nodes, all.copied())
}

/// The sums of a least-squares fit.
#[derive(Debug, Clone)]
struct NormalEquations {
    square: DMatrix<f64>,
    right: DVector<f64>,
}

impl NormalEquations {
    fn new(unknowns: usize) -> Self {
        Self { square: DMatrix::zeros(unknowns, unknowns), right: DVector::zeros(unknowns) }
    }

    fn add(&mut self, inputs: &DVector<f64>, output: f64) {
        self.square.ger(1.0, inputs, inputs, 1.0);
        self.right.axpy(output, inputs, 1.0);
    }

    /// The solution with a ridge on the diagonal, for each input in the scale that it has in the data; none where the sums are not
    /// finite.
    fn solve(&self) -> Option<DVector<f64>> {
        let mut square = self.square.clone();
        (0..square.nrows()).for_each(|i| square[(i, i)] += RIDGE * square[(i, i)] + f64::MIN_POSITIVE);
        Some(square.cholesky()?.solve(&self.right))
    }
}
