//! Detects a wrong model: compares the contour error with the correction to the error that the
//! model predicts without it.
//!
//! ```text
//! E  = mean of eps^2    of the actual position, over the last 0.1 s with a correction in the loop
//! E0 = mean of eps0^2   of the model axes, simulated along the same path without noise and offset
//! ```
//!
//! With a valid model, E is a small part of E0. The safety layer compares the tool with the present
//! model estimate, which includes the loads that the filter has found. If the model is wrong enough
//! to make the loop oscillate, these loads oscillate too. The error without the correction then
//! seems as large as the error with it. E0 does not depend on the measured position.
//!
//! Both comparisons have to find the correction useless: under an unpredictable load, E exceeds E0
//! on a straight line even with a valid model. A useless correction is faded out by its share. If
//! an oscillating offset were held and taken back slowly instead, it would lead the tool away.
//!
//! After two failures the model is not used again until the amplifiers have been off. Before the
//! first use, and after each failure, the model has to pass the check in motion without a
//! correction (`law_proof.rs`).

use feedwright_control::vector::{dot, norm, sub};
use feedwright_control::{IdentifiedAxes, LqgPreview, locate};
use feedwright_control::{Measured, Window};

use crate::law_proof::LawProof;
use crate::plant::SimulatedMachine;

/// Time over which errors are compared, and time of motion after which that begins where a correction has come in, s: over the first way the law has to
/// prove itself, and the correction comes in from where the axes are by then. Twice the lag of a usual loop.
const MEMORY_S: f64 = 0.1;
const SETTLED_S: f64 = 0.05;
/// A correction is useless where E exceeds `LEAST_MM2` plus `WORTH_NOTHING`^2 E0, and also the
/// limit of [`LOADED`], for `WORTHLESS_PERIODS` servo periods in a row. `LEAST_MM2` is (2.5 um)^2.
const WORTH_NOTHING: f64 = 0.5;
const LEAST_MM2: f64 = 6.25e-6;
const WORTHLESS_PERIODS: u32 = 8;
/// E must also exceed this multiple of the mean square error without the correction, under the
/// loads that the filter has found. An unpredictable load is no fault of the correction.
const LOADED: f64 = 1.2;
/// Times that it may be worth nothing: one may be a shock. Time between them, s.
const TRIALS: u32 = 2;
const WAIT_S: f64 = 1.0;
/// The comparison and what it needs.
#[derive(Debug, Clone)]
pub struct Trust<const N: usize> {
    nominal: SimulatedMachine<N>,
    proof: LawProof,
    /// Largest lag of the measured axis positions behind the path at constant speed, s.
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
