//! Training of the paper's identifier: plain back-propagation over the shuffled samples.
//!
//! Source: Lee, Cho and Jeon (2005), section 3.2, eq. 6. The paper does not say on what the network
//! was trained.

use feedwright_control::{
    ContourIdentifier, ContourModel, Delays, ERROR_SCALE_MM, HIDDEN, INPUTS, Inputs, seen_feed,
};
use feedwright_plan::vector::{scale, sub};
use rand::{RngExt, seq::SliceRandom};
use serde::Serialize;

use super::Rng;
use super::recording::{RecordedKnot, Recording};

/// Settings of the training of the network.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Training {
    /// Passes over the samples.
    pub(crate) epochs: u32,
    /// Step of back-propagation in the first epoch.
    pub step: f64,
    /// Factor on the step from epoch to epoch.
    pub(crate) decay: f64,
    /// The weights start uniformly within this distance of zero.
    pub initial_weight: f64,
}

impl Default for Training {
    /// 300 epochs bring the fit to the level of the disturbance (about 4 um RMS on tnv40); the
    /// decay makes the last steps a hundredth of the first.
    fn default() -> Self {
        Self {
            epochs: 300,
            step: 0.05,
            decay: 0.985,
            initial_weight: 0.5,
        }
    }
}

/// One sample: what the network sees, and the error that followed, both scaled.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ContourSample<const N: usize> {
    inputs: Inputs<N>,
    error: [f64; N],
}

/// A trained identifier and how well it fits.
#[derive(Debug, Clone, PartialEq)]
pub struct TrainedContour<const N: usize> {
    /// The network.
    pub net: ContourIdentifier<N>,
    /// RMS of the prediction error over the last epoch, um per axis.
    pub fit_um: f64,
    /// Samples it was trained on.
    pub samples: usize,
}

/// Training of networks for two and for three axes: each is compiled here.
pub trait TrainContour<const N: usize> {
    /// Trains a network on what a machine showed; `rng` shuffles and draws the weights to start
    /// from. `progress` gets the part done, 0 to 1.
    fn train(
        &self,
        recording: &Recording<N>,
        rng: Rng,
        progress: &mut dyn FnMut(f64),
    ) -> TrainedContour<N>;
}

impl TrainContour<2> for Training {
    fn train(
        &self,
        recording: &Recording<2>,
        rng: Rng,
        progress: &mut dyn FnMut(f64),
    ) -> TrainedContour<2> {
        train_contour(recording, self, rng, progress)
    }
}

impl TrainContour<3> for Training {
    fn train(
        &self,
        recording: &Recording<3>,
        rng: Rng,
        progress: &mut dyn FnMut(f64),
    ) -> TrainedContour<3> {
        train_contour(recording, self, rng, progress)
    }
}

fn train_contour<const N: usize>(
    recording: &Recording<N>,
    training: &Training,
    mut rng: Rng,
    progress: &mut dyn FnMut(f64),
) -> TrainedContour<N> {
    let period_s = recording.feed_period_s;
    let samples = recording
        .stretches
        .iter()
        .flat_map(|stretch| samples(stretch, period_s))
        .collect();
    descend(samples, training, &mut rng, progress)
}

/// Returns the inputs and errors that the network would have seen from knot to knot of a stretch.
fn samples<const N: usize>(stretch: &[RecordedKnot<N>], period_s: f64) -> Vec<ContourSample<N>> {
    let mut delays = Delays::REST;
    stretch
        .windows(2)
        .map(|pair| {
            let feed_mm_s = scale(1.0 / period_s, sub(pair[1].command_mm, pair[0].command_mm));
            let feed = seen_feed(feed_mm_s);
            let error = pair[1].contour_mm.map(|e| e / ERROR_SCALE_MM);
            let inputs = delays.inputs(feed);
            delays.push(feed, error);
            ContourSample { inputs, error }
        })
        .collect()
}

/// Plain back-propagation over the shuffled samples.
fn descend<const N: usize>(
    mut samples: Vec<ContourSample<N>>,
    training: &Training,
    rng: &mut Rng,
    progress: &mut dyn FnMut(f64),
) -> TrainedContour<N> {
    let mut net = initial(training.initial_weight, rng);
    let mut step = training.step;
    let mut cost = 0.0;
    for epoch in 0..training.epochs {
        samples.shuffle(rng);
        cost = samples
            .iter()
            .map(|s| net.learn(&s.inputs, s.error, step))
            .sum();
        step *= training.decay;
        progress(f64::from(epoch + 1) / f64::from(training.epochs));
    }
    let mean_square = 2.0 * cost / (samples.len() * N).max(1) as f64;
    let fit_um = mean_square.sqrt() * ERROR_SCALE_MM * 1e3;
    TrainedContour {
        net,
        fit_um,
        samples: samples.len(),
    }
}

fn initial<const N: usize>(width: f64, rng: &mut Rng) -> ContourIdentifier<N> {
    let mut row = || -> [f64; HIDDEN] { std::array::from_fn(|_| rng.random_range(-width..=width)) };
    let hidden =
        std::array::from_fn(|_| -> [[f64; HIDDEN]; INPUTS] { std::array::from_fn(|_| row()) });
    ContourIdentifier {
        hidden,
        output: std::array::from_fn(|_| row()),
    }
}
