//! Training of the servo identifier: least squares for its linear part and for the outputs of its hidden nodes.
//!
//! ```text
//! minimise sum |e(k+1) - e(k) - L I(k) - Wo f(Wh I(k))|^2 + r n (|L|^2 + |Wo|^2)
//! ```
//!
//! over the n samples of all laps, by the normal equations and Cholesky's factorisation. L alone first; Wh then follows from
//! L: its nodes see the sign of the tool's speed, which is where a servo is not linear. With Wh laid, the rest is one linear
//! solution, in place of a descent that needs starting weights.
//!
//! Source: ridge regression, Hoerl and Kennard (1970); hidden layers that are laid instead of trained, Schmidt, Kraaijveld
//! and Duin (1992).

use feedwright_control::identifier::servo::{Delays, FOLLOWING_SCALE_MM, ServoIdentifier};
use feedwright_control::identifier::{FEED_SCALE_MM_S, HIDDEN, INPUTS, Inputs};
use feedwright_control::vector::{scale, sub};
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;

use super::excitation::{Lap, record};
use super::{Programme, Rng};
use crate::machine::Machine;

/// r: keeps the equations regular where two inputs always move together, and is far below the variance of any that
/// moves at all.
const RIDGE: f64 = 1e-9;

/// A trained servo identifier and how well it fits.
#[derive(Debug, Clone, PartialEq)]
pub struct Identified<const N: usize> {
    /// The network.
    pub net: ServoIdentifier<N>,
    /// RMS of the prediction error of one knot, um per axis.
    pub fit_um: f64,
    /// Samples it was trained on.
    pub samples: usize,
}

/// One sample: the inputs, and the growth of the following error that followed, mm.
struct Sample<const N: usize> {
    inputs: Inputs<N>,
    grown_mm: [f64; N],
}

/// Cuts the programme on the machine and fits the identifier to what it sees.
pub fn identify<const N: usize>(machine: &Machine, programme: &Programme, seed: u64) -> Identified<N> {
    let mut rng = Rng::seed_from_u64(seed);
    let period_s = programme.period_s(machine);
    let laps = record::<N>(machine, programme, &mut rng);
    let samples: Vec<Sample<N>> = laps.iter().flat_map(|lap| samples(lap, period_s)).collect();
    let net = fit(&samples, period_s);
    let squares = samples.iter().map(|sample| {
        let missed = sub(sample.grown_mm, net.predict(&sample.inputs));
        missed.iter().map(|m| m * m).sum::<f64>()
    });
    let fit_um = (squares.sum::<f64>() / (N * samples.len().max(1)) as f64).sqrt() * 1e3;
    Identified { net, fit_um, samples: samples.len() }
}

/// What the identifier would have seen from knot to knot of a lap, once its delays are filled.
fn samples<const N: usize>(lap: &Lap<N>, period_s: f64) -> Vec<Sample<N>> {
    let following = |i: usize| sub(lap[i].command_mm, lap[i].tool_mm);
    let mut delays = Delays::<N>::REST;
    let mut samples = Vec::new();
    for i in 0..lap.len().saturating_sub(1) {
        let feed = scale(1.0 / (period_s * FEED_SCALE_MM_S), sub(lap[i + 1].command_mm, lap[i].command_mm));
        let next = following(i + 1);
        samples.push(Sample { inputs: delays.inputs(feed), grown_mm: sub(next, following(i)) });
        delays.push(feed, scale(1.0 / FOLLOWING_SCALE_MM, next));
    }
    samples
}

/// The linear part alone first, since the hidden nodes are laid along it; then both parts together.
fn fit<const N: usize>(samples: &[Sample<N>], period_s: f64) -> ServoIdentifier<N> {
    let linear = fit_outputs(samples, ServoIdentifier::IDEAL);
    let hidden = hidden(&linear, period_s);
    fit_outputs(samples, ServoIdentifier { hidden, ..linear })
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

/// The least squares over the linear connection and the outputs of the hidden nodes, as they are.
fn fit_outputs<const N: usize>(samples: &[Sample<N>], net: ServoIdentifier<N>) -> ServoIdentifier<N> {
    let nodes = if net.hidden.as_flattened().as_flattened().iter().all(|w| *w == 0.0) { 0 } else { HIDDEN };
    let unknowns = N * INPUTS + nodes;
    let mut square = DMatrix::<f64>::identity(unknowns, unknowns) * (RIDGE * samples.len() as f64);
    let mut right = vec![DVector::<f64>::zeros(unknowns); N];
    let mut seen = DVector::<f64>::zeros(unknowns);
    for sample in samples {
        let hidden = net.hidden_nodes(&sample.inputs);
        let all = sample.inputs.as_flattened().iter().chain(&hidden[..nodes]);
        seen.iter_mut().zip(all).for_each(|(seen, value)| *seen = *value);
        square.ger(1.0, &seen, &seen, 1.0);
        for (right, grown_mm) in right.iter_mut().zip(sample.grown_mm) {
            right.axpy(grown_mm, &seen, 1.0);
        }
    }
    // With the ridge the matrix is positive definite unless a sample is not finite: then nothing was identified.
    let Some(factor) = square.cholesky() else { return ServoIdentifier::IDEAL };
    let solutions: Vec<_> = right.iter().map(|right| factor.solve(right)).collect();
    let linear = std::array::from_fn(|o| {
        std::array::from_fn(|axis| std::array::from_fn(|input| solutions[o][axis * INPUTS + input]))
    });
    let output = std::array::from_fn(|o| {
        std::array::from_fn(|node| if node < nodes { solutions[o][N * INPUTS + node] } else { 0.0 })
    });
    ServoIdentifier { linear, output, ..net }
}
