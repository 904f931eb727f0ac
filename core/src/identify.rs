//! Identification: from the machine to the trained weights of the [`ContourIdentifier`].
//!
//! The machine (simulated here) cuts an identification programme: laps of circles at random feeds, two thirds of them
//! with random offsets of the command from the path, so that the data tell the effect of the feedrate from that of the
//! path. The network then learns the contour error by plain back-propagation over the shuffled samples.
//!
//! Source: Lee, Cho and Jeon (2005), section 3.2, eq. 6. The paper does not say on what the network was trained.

pub mod cache;
mod excitation;

use feedwright_control::identifier::contour::ContourIdentifier;
use feedwright_control::identifier::{ERROR_SCALE_MM, HIDDEN, INPUTS, Inputs};
use rand::{RngExt, SeedableRng, seq::SliceRandom};
use rand_xoshiro::Xoshiro256PlusPlus;
use serde::Serialize;

use crate::machine::Machine;
use excitation::record;

/// The generator behind everything random here: the same seed gives the same bits on every platform.
pub(crate) type Rng = Xoshiro256PlusPlus;

/// What the machine cuts to be identified.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Programme {
    /// Radii of the circles, in turn, mm.
    pub radii_mm: Vec<f64>,
    /// Sense of the circles, in turn: -1 is clockwise.
    pub turns: Vec<i32>,
    /// Range of the feedrates, mm/s.
    pub feed_mm_s: [f64; 2],
    /// Number of laps.
    pub laps: u32,
    /// Largest random offset of the command in each axis, mm.
    pub offset_mm: f64,
    /// Feed periods after which the offset is drawn anew.
    pub renewal_periods: u32,
    /// Servo periods in a feed period: as in the controller that will use the identifier.
    pub servo_periods: u32,
}

impl Programme {
    /// The circle of eq. 11.
    pub fn paper() -> Self {
        Self {
            radii_mm: vec![10.0],
            turns: vec![-1],
            feed_mm_s: [30.0, 70.0],
            laps: 60,
            offset_mm: 0.06,
            renewal_periods: 3,
            servo_periods: 10,
        }
    }

    /// Circles from tight to wide, none of them a test contour: for programs of any shape.
    pub fn general() -> Self {
        Self { radii_mm: vec![3.0, 6.0, 12.0, 24.0], ..Self::paper() }
    }
}

/// How the network is trained.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Training {
    /// Passes over the samples.
    pub epochs: u32,
    /// Step of back-propagation in the first epoch.
    pub step: f64,
    /// Factor on the step from epoch to epoch.
    pub decay: f64,
    /// The weights start uniformly within this distance of zero.
    pub initial_weight: f64,
}

impl Default for Training {
    /// 300 epochs bring the fit to the level of the disturbance (about 4 um RMS on tnv40); the decay makes the last
    /// steps a hundredth of the first.
    fn default() -> Self {
        Self { epochs: 300, step: 0.05, decay: 0.985, initial_weight: 0.5 }
    }
}

/// One sample: what the network sees, and the error that followed, both scaled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<const N: usize> {
    /// Inputs.
    pub inputs: Inputs<N>,
    /// Contour error of each axis.
    pub error: [f64; N],
}

/// A trained identifier and how well it fits.
#[derive(Debug, Clone, PartialEq)]
pub struct Identified<const N: usize> {
    /// The network.
    pub net: ContourIdentifier<N>,
    /// RMS of the prediction error over the last epoch, um per axis.
    pub fit_um: f64,
    /// Samples it was trained on.
    pub samples: usize,
}

/// Cuts the programme on the machine and trains a network on what it sees. `progress` gets the part done, 0 to 1.
pub fn identify<const N: usize>(
    machine: &Machine,
    programme: &Programme,
    training: &Training,
    seed: u64,
    progress: &mut dyn FnMut(f64),
) -> Identified<N> {
    let mut rng = Rng::seed_from_u64(seed);
    let samples = record::<N>(machine, programme, &mut rng);
    train(samples, training, &mut rng, progress)
}

/// Plain back-propagation over the shuffled samples.
fn train<const N: usize>(
    mut samples: Vec<Sample<N>>,
    training: &Training,
    rng: &mut Rng,
    progress: &mut dyn FnMut(f64),
) -> Identified<N> {
    let mut net = initial(training.initial_weight, rng);
    let mut step = training.step;
    let mut cost = 0.0;
    for epoch in 0..training.epochs {
        samples.shuffle(rng);
        cost = samples.iter().map(|s| net.learn(&s.inputs, s.error, step)).sum();
        step *= training.decay;
        progress(f64::from(epoch + 1) / f64::from(training.epochs));
    }
    let mean_square = 2.0 * cost / (samples.len() * N).max(1) as f64;
    let fit_um = mean_square.sqrt() * ERROR_SCALE_MM * 1e3;
    Identified { net, fit_um, samples: samples.len() }
}

fn initial<const N: usize>(width: f64, rng: &mut Rng) -> ContourIdentifier<N> {
    let mut row = || -> [f64; HIDDEN] { std::array::from_fn(|_| rng.random_range(-width..=width)) };
    let hidden = std::array::from_fn(|_| -> [[f64; HIDDEN]; INPUTS] { std::array::from_fn(|_| row()) });
    ContourIdentifier { hidden, output: std::array::from_fn(|_| row()) }
}
