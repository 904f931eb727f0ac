//! The experiments of section 4 of Lee, Cho and Jeon (2005), on the circle of eq. 11.
//!
//! For every seed the identifier is trained anew and cuts the circle uncorrected, with both
//! components of the feedrate, and with the magnitude only: once at the rho that gives it the same
//! machining time, once at the same rho.

mod curves;
pub(crate) mod departures;
pub(crate) mod figures;

use feedwright::{Statistics, identified};
use feedwright_control::{
    ContourIdentifier, Controller, Gradient, InvertingSettings, MagnitudeOnly, TwoDimensional,
    Uncorrected,
};
use feedwright_gcode::canon::{Canon, Corner, Plane, Shape};
use feedwright_ident::{Excitation, TrainedContour, Training};
use feedwright_sim::{Machine, Outcome, Run, RunError, Sink, Stages, Watch, path_steps};
use rayon::prelude::*;
use serde::Serialize;

use crate::contour::motion;

/// Radius of the circle, mm.
const RADIUS_MM: f64 = 10.0;
/// Reference feedrate, mm/s.
const FEED_MM_S: f64 = 50.0;
/// Two machining times are the same within this ratio.
const SAME_TIME: f64 = 0.002;
/// Halvings of the interval of rho: from 10^-6..10^-1 to a millionth of a decade.
const HALVINGS: u32 = 24;

/// Result of one cut.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Numbers {
    /// Machining time, s.
    pub time_s: f64,
    /// RMS contour error, um.
    pub rms_um: f64,
    /// Largest contour error, um.
    pub max_um: f64,
    /// Weight of the machining time that the controller ran with; none in the uncorrected cut.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rho: Option<f64>,
    /// True if the program was cut to its end.
    pub completed: bool,
}

/// All cuts of one seed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SeedResult {
    /// Seed of the training.
    pub seed: u64,
    /// RMS of the identifier's fit, um.
    pub fit_um: f64,
    /// The programmed path at the planned feed.
    pub uncorrected: Numbers,
    /// Magnitude only, in the machining time of `two_dimensional`.
    pub magnitude_only: Numbers,
    /// Magnitude only, at the rho of `two_dimensional`.
    pub magnitude_only_same_rho: Numbers,
    /// Both components.
    pub two_dimensional: Numbers,
    /// Both components, with the true gradient of eq. 7 instead of the printed one: does not
    /// converge.
    pub two_dimensional_exact_gradient: Numbers,
}

/// The result of all seeds.
#[derive(Debug, Clone, Serialize)]
pub struct Paper {
    /// Name of the machine.
    pub machine: String,
    /// Radius of the circle, mm.
    pub radius_mm: f64,
    /// Reference feedrate, mm/s.
    pub feed_mm_s: f64,
    /// One for each seed.
    pub seeds: Vec<SeedResult>,
    /// Worst over the seeds of two-dimensional against magnitude-only.
    pub worst_rms_ratio: f64,
    /// Worst over the seeds of two-dimensional against magnitude-only.
    pub worst_max_ratio: f64,
    /// Worst over the seeds of two-dimensional against uncorrected.
    pub worst_time_ratio: f64,
}

/// Runs the experiment for each seed, in parallel.
///
/// # Errors
/// A machine without sensible limits, or an end from outside.
pub fn experiment(machine: &Machine, seeds: &[u64], watch: &dyn Watch) -> Result<Paper, RunError> {
    watch.begin("training and cutting", seeds.len() as u64);
    let bench = Bench { machine, watch };
    let cut = |&seed: &u64| {
        let result = bench.cut_all(seed)?;
        watch.advance(1);
        Ok(result)
    };
    let seeds: Result<Vec<SeedResult>, RunError> = seeds.par_iter().map(cut).collect();
    let seeds = seeds?;
    let worst = |ratio: fn(&SeedResult) -> f64| seeds.iter().map(ratio).fold(0.0, f64::max);
    Ok(Paper {
        machine: machine.name.clone(),
        radius_mm: RADIUS_MM,
        feed_mm_s: FEED_MM_S,
        worst_rms_ratio: worst(|s| s.two_dimensional.rms_um / s.magnitude_only.rms_um),
        worst_max_ratio: worst(|s| s.two_dimensional.max_um / s.magnitude_only.max_um),
        worst_time_ratio: worst(|s| s.two_dimensional.time_s / s.uncorrected.time_s),
        seeds,
    })
}

/// The identifier of the paper.
type Net = ContourIdentifier<2>;

/// Machine and watch that all cuts share.
#[derive(Clone, Copy)]
struct Bench<'a> {
    machine: &'a Machine,
    watch: &'a dyn Watch,
}

impl Bench<'_> {
    fn cut_all(&self, seed: u64) -> Result<SeedResult, RunError> {
        let trained = self.train(seed);
        let net = &trained.net;
        let settings = InvertingSettings::DEFAULT;
        let two_dimensional = self.cut_two_dimensional(net, settings)?;
        let same_time = self.rho_for_time(net, two_dimensional.time_s)?;
        Ok(SeedResult {
            seed,
            fit_um: trained.fit_um,
            uncorrected: self.cut_uncorrected()?,
            magnitude_only: self.cut_magnitude_only(net, same_time)?,
            magnitude_only_same_rho: self.cut_magnitude_only(net, settings.inversion.rho)?,
            two_dimensional_exact_gradient: self
                .cut_two_dimensional(net, with_gradient(settings, Gradient::Exact))?,
            two_dimensional,
        })
    }

    /// The identifier as the paper trains it: on the circle.
    fn train(&self, seed: u64) -> TrainedContour<2> {
        self.train_on(&Excitation::paper(), &Training::default(), seed)
    }

    fn train_on(&self, of: &Excitation, training: &Training, seed: u64) -> TrainedContour<2> {
        identified(self.machine, of, training, seed, &mut |_| {})
    }

    fn cut_uncorrected(&self) -> Result<Numbers, RunError> {
        Ok(Numbers {
            rho: None,
            ..self.cut(&mut Uncorrected, &mut [], 0.0)?
        })
    }

    fn cut_two_dimensional(&self, net: &Net, of: InvertingSettings) -> Result<Numbers, RunError> {
        let mut controller = TwoDimensional::untried(net.clone(), of);
        self.cut(&mut controller, &mut [], of.inversion.rho)
    }

    fn cut_magnitude_only(&self, net: &Net, rho: f64) -> Result<Numbers, RunError> {
        self.cut(&mut magnitude_only(net, rho), &mut [], rho)
    }

    /// The rho at which magnitude-only takes `time_s`: bisection on its logarithm, since more rho
    /// is less time.
    fn rho_for_time(&self, net: &Net, time_s: f64) -> Result<f64, RunError> {
        let (mut low, mut high) = (-6.0_f64, -1.0_f64);
        let mut rho = 0.0;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            rho = libm::pow(10_f64, middle);
            let ratio = self.cut_magnitude_only(net, rho)?.time_s / time_s;
            if (ratio - 1.0).abs() <= SAME_TIME {
                break;
            }
            *(if ratio > 1.0 { &mut low } else { &mut high }) = middle;
        }
        Ok(rho)
    }

    /// Cuts the circle.
    fn cut(
        &self,
        controller: &mut dyn Controller<2>,
        sinks: &mut [&mut dyn Sink],
        rho: f64,
    ) -> Result<Numbers, RunError> {
        let mut statistics = Statistics::new();
        let mut all: Vec<&mut dyn Sink> = vec![&mut statistics];
        all.extend(sinks.iter_mut().map(|sink| &mut **sink as &mut dyn Sink));
        let run = Run::on(self.machine)
            .stages(Stages::default())
            .watched(self.watch)
            .cut(|| Ok(path_steps([circle()])), controller, &mut all)?;
        Ok(Numbers {
            time_s: run.time_s,
            rms_um: statistics.rms_um(),
            max_um: statistics.max_um(),
            rho: Some(rho),
            completed: run.outcome == Outcome::Completed,
        })
    }
}

/// Returns the baseline.
fn magnitude_only(net: &Net, rho: f64) -> MagnitudeOnly<2> {
    MagnitudeOnly::exact(net.clone(), with_rho(InvertingSettings::DEFAULT, rho))
}

fn with_rho(mut settings: InvertingSettings, rho: f64) -> InvertingSettings {
    settings.inversion.rho = rho;
    settings
}

fn with_gradient(mut settings: InvertingSettings, gradient: Gradient) -> InvertingSettings {
    settings.inversion.gradient = gradient;
    settings
}

/// The circle of eq. 11 as a program: clockwise about (R, 0) from the origin.
fn circle() -> Canon {
    let shape = Shape::Arc {
        plane: Plane::Xy,
        center_mm: [RADIUS_MM, 0.0, 0.0],
        turns: -1,
    };
    motion(1, [[0.0; 3]; 2], shape, FEED_MM_S, Corner::ExactStop)
}
