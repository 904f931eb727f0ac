//! Whether a correction is to be trusted that may be by a wrong model: the contour error with it against that of the machine of the model
//! without any.
//!
//! ```text
//! E  = mean of eps^2        of the actual position, over the last 0.1 s in which the correction was in the loop
//! E0 = mean of eps0^2       of the axes of the model, simulated along the same path without noise and without offset
//! ```
//!
//! A model that holds leaves a small part of E0. The safety layer compares the tool with what the model says of it now, loads that the filter has
//! found included: where the model is wrong enough to make the loop swing, those swing too, and the tool would seem to be as far off without. E0
//! knows nothing of the measured position. Both have to say so: under a load that nobody foresees, E is beyond E0 on a straight line. A correction that is worth nothing is faded out by its share: the offset of one that swings would lead the
//! tool away where it was held and taken back slowly. Found wrong twice, a model is not tried again until the amplifiers were off. Before all this,
//! and each time that it was found wrong, its law has to prove itself in motion without a correction (`law_proof.rs`).

use feedwright_control::vector::{dot, norm, sub};
use feedwright_control::{IdentifiedAxes, LqgPreview, locate};
use feedwright_control::{Measured, Window};

use crate::law_proof::LawProof;
use crate::plant::SimulatedMachine;

/// Time over which errors are compared, and time of motion after which that begins where a correction has come in, s: over the first way the law has to
/// prove itself, and the correction comes in from where the axes are by then. Twice the lag of a usual loop.
const MEMORY_S: f64 = 0.1;
const SETTLED_S: f64 = 0.05;
/// Part of the error without it from which on a correction is worth nothing, beside this, mm^2 (2.5 um), and for so many servo periods.
const WORTH_NOTHING: f64 = 0.5;
const LEAST_MM2: f64 = 6.25e-6;
const WORTHLESS_PERIODS: u32 = 8;
/// Of the mean square under the loads that the filter has found: what nobody can foresee is no fault of the correction.
const LOADED: f64 = 1.2;
/// Times that it may be worth nothing: one may be a shock. Time between them, s.
const TRIALS: u32 = 2;
const WAIT_S: f64 = 1.0;
/// The comparison and what it needs.
#[derive(Debug, Clone)]
pub struct Trust<const N: usize> {
    nominal: SimulatedMachine<N>,
    proof: LawProof,
    /// By how much the axes, as they are measured, are behind the path at constant speed, s.
    lag_s: f64,
    begun: bool,
    /// For how long it has been in the loop and the command has moved, s.
    in_loop_s: f64,
    square_mm2: f64,
    nominal_mm2: f64,
    loaded_mm2: f64,
    /// Servo periods in a row in which it was worth nothing, and how often it came to that.
    worthless: u32,
    found: u32,
    /// Time until it is tried again, s.
    waits_s: f64,
}

impl<const N: usize> Trust<N> {
    /// In a model, and the regulator by it.
    pub fn new(identified: &IdentifiedAxes<N>, regulator: &LqgPreview<N>) -> Self {
        let nominal = SimulatedMachine::without_noise(identified);
        Self {
            nominal,
            proof: LawProof::new(regulator.unforeseen_mm2()),
            lag_s: regulator.measured_lag_s(),
            begun: false,
            in_loop_s: 0.0,
            worthless: 0,
            found: 0,
            waits_s: 0.0,
            square_mm2: 0.0,
            nominal_mm2: 0.0,
            loaded_mm2: 0.0,
        }
    }

    /// At rest.
    pub fn restart(&mut self) {
        self.begun = false;
        self.forget();
    }

    fn forget(&mut self) {
        (self.in_loop_s, self.square_mm2) = (0.0, 0.0);
        (self.nominal_mm2, self.loaded_mm2) = (0.0, 0.0);
        self.worthless = 0;
    }

    /// One servo period, in which this share of the correction was in the loop, 0 to 1, or none was followed, and the error without it would have been `without_mm` under
    /// the loads that the controller has found.
    pub fn take_in(&mut self, window: &Window<'_, N>, measured: &Measured<N>, share: Option<f64>, without_mm: f64) {
        let path_mm = window.now().position_mm;
        if !self.begun {
            self.nominal.place(path_mm);
            self.begun = true;
        }
        let period_s = window.feed_period_s;
        let (index, reach) = (measured.contour.index, measured.contour.index.saturating_neg());
        let nominal = locate(window, self.nominal.position_mm(), index, reach);
        let moves = window.now().feed_mm_s > 0.0;
        if moves && norm(window.offset_mm) == 0.0 {
            let missed_mm = sub(measured.position_mm, self.nominal.measured_mm());
            let distance_mm = sub(measured.position_mm, window.at(-self.lag_s).position_mm);
            self.proof.take_in(square(missed_mm), square(distance_mm), period_s);
        }
        self.nominal.step(path_mm, true, 1.0);
        let Some(share) = share.filter(|_| window.knot(index).cutting) else {
            self.forget();
            return;
        };
        if moves {
            self.in_loop_s += period_s;
        }
        if self.in_loop_s > SETTLED_S {
            let part = (period_s / MEMORY_S).min(1.0);
            // What a share leaves is between all of it and what is worth nothing.
            let left = (1.0 - (1.0 - WORTH_NOTHING) * share) / WORTH_NOTHING;
            self.square_mm2 += part * (square(measured.contour.vector_mm) - self.square_mm2);
            self.nominal_mm2 += part * (left * left * square(nominal.vector_mm) - self.nominal_mm2);
            self.loaded_mm2 += part * (without_mm * without_mm - self.loaded_mm2);
        }
        let beyond_nominal = self.square_mm2 > LEAST_MM2 + part_mm2(self.nominal_mm2);
        let is_worthless = beyond_nominal && self.square_mm2 > LOADED * self.loaded_mm2;
        self.worthless = if is_worthless { self.worthless + 1 } else { 0 };
        if self.worthless == WORTHLESS_PERIODS {
            self.found = self.found.saturating_add(1);
            self.proof.forget();
            self.waits_s = WAIT_S;
        }
    }

    /// Whether the law has proven itself, so that anything may be corrected by it.
    pub fn is_proven(&self) -> bool {
        self.proof.is_proven()
    }

    /// Whether the machine does not move as the law says.
    pub fn is_refuted(&self) -> bool {
        self.proof.is_refuted()
    }

    /// Goes on by a servo period in which nothing of the correction is left; it is tried again after a while.
    pub fn wait(&mut self, servo_s: f64) {
        self.waits_s -= servo_s;
    }

    /// Whether the correction is to stay out of the loop: for a while, or because another trial would do harm again.
    pub fn is_lost(&self) -> bool {
        self.waits_s > 0.0 || self.found >= TRIALS
    }

    /// Another machine may be there.
    pub fn forgive(&mut self) {
        (self.found, self.waits_s) = (0, 0.0);
        self.proof.forget();
    }
}

fn square<const N: usize>(vector: [f64; N]) -> f64 {
    dot(vector, vector)
}

/// What a correction may leave of a mean square, mm^2.
fn part_mm2(nominal_mm2: f64) -> f64 {
    WORTH_NOTHING * WORTH_NOTHING * nominal_mm2
}
