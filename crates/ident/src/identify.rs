//! Identification: from what a machine showed to the trained weights of an identifier.
//!
//! A [`recording`] holds what a machine showed. A simulated machine cuts an identification
//! excitation for it: laps of circles at random feedrates, two thirds of them with random offsets
//! of the command from the path. The offsets separate the effect of the feedrate from the effect of
//! the path. [`contour`] trains the paper's network on the recording. [`axis_parameters`] finds the
//! inertia and friction of an axis whose drive settings are known. None of them sees the machine.

pub(crate) mod recording;
mod excitation;
pub(crate) mod contour;
pub(crate) mod axis_parameters;
pub(crate) mod axis_statistics;
pub(crate) mod grey_box;
pub(crate) mod axes;

use feedwright_control::INVERTING_FEED_PERIOD_S;
use feedwright_sim::Machine;
use rand::SeedableRng;
use rand_xoshiro::Xoshiro256PlusPlus;
use serde::Serialize;

use recording::Recording;

/// The generator behind everything random here: the same seed gives the same bits on every
/// platform.
pub(crate) type Rng = Xoshiro256PlusPlus;

/// Laps that parameters of an axis are found from: six of each radius, a third of them without
/// offsets. On workshop the standard errors are then below 0.1 % of the inertia and 2 % of the
/// friction; all 60 would take more than twice the time.
const AXIS_PARAMETER_LAPS: u32 = 24;

/// Time between random offsets of the command for the parameters of an axis, s, and time in which
/// the command goes to one. A product, since the result of rounding to servo periods must not
/// change: 6 and 1 times 3 ms.
const RENEWAL_S: f64 = 6.0 * 0.003;
const RAMP_S: f64 = 0.003;

/// Motion that the machine cuts for the identification.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Excitation {
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
    /// Feed periods in which the command goes to it.
    pub ramp_periods: u32,
    /// Feed period, s: as in the controller that will use the identifier.
    pub feed_period_s: f64,
}

impl Excitation {
    /// The feed period that the machine can have, s.
    fn period_s(&self, machine: &Machine) -> f64 {
        f64::from(machine.period.servo_periods(self.feed_period_s)) * machine.period.servo_s
    }

    /// Records a machine that cuts this excitation. Also returns the state of the random number
    /// generator after the recording; a training that draws random numbers continues with it.
    pub fn record<const N: usize>(&self, machine: &Machine, seed: u64) -> (Recording<N>, Rng) {
        let mut rng = Rng::seed_from_u64(seed);
        (excitation::record(machine, self, &mut rng), rng)
    }

    /// Records all laps in one cut, with noise that continues from lap to lap. Otherwise like
    /// [`Self::record`].
    pub fn record_in_one<const N: usize>(&self, machine: &Machine, seed: u64) -> Recording<N> {
        excitation::record_in_one(machine, self, &mut Rng::seed_from_u64(seed))
    }

    /// The circle of eq. 11.
    pub fn paper() -> Self {
        Self {
            radii_mm: vec![10.0],
            turns: vec![-1],
            feed_mm_s: [30.0, 70.0],
            laps: 60,
            offset_mm: 0.06,
            renewal_periods: 3,
            ramp_periods: 1,
            feed_period_s: INVERTING_FEED_PERIOD_S,
        }
    }

    /// Circles from tight to wide, none of them a test contour: for programs of any shape. All in
    /// one sense, as the paper's: with both, the derivative that the inversion takes for its gain
    /// comes out four times smaller.
    pub fn general() -> Self {
        Self {
            radii_mm: vec![3.0, 6.0, 12.0, 24.0],
            ..Self::paper()
        }
    }

    /// Returns the excitation for the parameters of an axis, whose motion does not depend on the
    /// path: circles in both directions, over a wider range of feedrates. It has a knot in every
    /// servo period, since the model of an axis steps through all of them.
    pub fn axis_parameters(machine: &Machine) -> Self {
        let servo_periods = |time_s: f64| (time_s / machine.period.servo_s).round().max(1.0) as u32;
        Self {
            turns: vec![-1, 1, 1],
            feed_mm_s: [10.0, 70.0],
            feed_period_s: machine.period.servo_s,
            renewal_periods: servo_periods(RENEWAL_S),
            ramp_periods: servo_periods(RAMP_S),
            laps: AXIS_PARAMETER_LAPS,
            ..Self::general()
        }
    }

    /// Returns the excitation for the statistics of the axes of a machine: a minute at its servo
    /// period, without offsets, at all speeds. The slowest are those at which cogging moves the
    /// axis.
    pub fn statistics(machine: &Machine) -> Self {
        Self {
            radii_mm: vec![2.0, 5.0, 10.0],
            turns: vec![-1, 1, 1],
            feed_mm_s: [2.0, 60.0],
            laps: 24,
            offset_mm: 0.0,
            renewal_periods: 1,
            ramp_periods: 1,
            feed_period_s: machine.period.servo_s,
        }
    }
}
