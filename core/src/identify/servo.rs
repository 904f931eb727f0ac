//! Training of the servo identifier: least squares for its linear part.
//!
//! ```text
//! minimise sum |e(k+1) - e(k) - L I(k)|^2 + r n |L|^2
//! ```
//!
//! over the n samples of all laps, by the normal equations and Cholesky's factorisation. Ridge regression: Hoerl and
//! Kennard (1970).

use feedwright_control::identifier::servo::{Delays, FOLLOWING_SCALE_MM, ServoIdentifier};
use feedwright_control::identifier::{FEED_SCALE_MM_S, INPUTS, Inputs};
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
    let net = fit(&samples);
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

/// The least squares, all outputs against the same inputs.
fn fit<const N: usize>(samples: &[Sample<N>]) -> ServoIdentifier<N> {
    let unknowns = N * INPUTS;
    let mut square = DMatrix::<f64>::identity(unknowns, unknowns) * (RIDGE * samples.len() as f64);
    let mut right = vec![DVector::<f64>::zeros(unknowns); N];
    for sample in samples {
        let inputs = DVector::from_column_slice(sample.inputs.as_flattened());
        square.ger(1.0, &inputs, &inputs, 1.0);
        for (right, grown_mm) in right.iter_mut().zip(sample.grown_mm) {
            right.axpy(grown_mm, &inputs, 1.0);
        }
    }
    // With the ridge the matrix is positive definite unless a sample is not finite: then nothing was identified.
    let Some(factor) = square.cholesky() else { return ServoIdentifier::IDEAL };
    let solutions: Vec<_> = right.iter().map(|right| factor.solve(right)).collect();
    let linear = std::array::from_fn(|o| {
        std::array::from_fn(|axis| std::array::from_fn(|input| solutions[o][axis * INPUTS + input]))
    });
    ServoIdentifier { linear, ..ServoIdentifier::IDEAL }
}
