//! A position encoder or scale, and its reading at a position.
//!
//! ```text
//! shown(x) = step round((x + A sin(2 pi x / P + p)) / step)
//! ```
//!
//! A amplitude of the error within a signal period P (interpolation, or sub-divisional, error), p
//! its phase, which depends on where the axis was homed. The drive gets it some of its periods
//! late.
//!
//! Source: DIN 32876 and ISO 230-2 for the terms; Alejandre and Artes (2004), Machine tool errors
//! caused by optical linear encoders.

use std::f64::consts::TAU;

use serde::Serialize;

/// An encoder or a scale; places are in mm of travel.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct PositionSensor {
    /// Step, mm; 0 is without steps.
    pub step_mm: f64,
    /// Signal period, mm.
    pub period_mm: f64,
    /// Amplitude of the error within it, mm.
    pub error_mm: f64,
    /// Phase of that, rad.
    pub phase_rad: f64,
    /// Delay, in periods of the drive.
    pub late_periods: u32,
}

impl PositionSensor {
    /// Returns the reading at a position, mm.
    pub fn shown_mm(&self, at_mm: f64) -> f64 {
        let error_mm = if self.error_mm == 0.0 {
            0.0
        } else {
            self.error_mm * libm::sin(TAU * at_mm / self.period_mm + self.phase_rad)
        };
        let seen_mm = at_mm + error_mm;
        if self.step_mm > 0.0 {
            self.step_mm * (seen_mm / self.step_mm).round()
        } else {
            seen_mm
        }
    }
}

/// Values that come some periods late.
#[derive(Debug, Clone)]
pub(super) struct Late<T> {
    values: Vec<T>,
    next: usize,
}

impl<T: Copy> Late<T> {
    /// Delays by `periods` periods; until then the output is this value.
    pub(super) fn new(periods: u32, value: T) -> Self {
        Self {
            values: vec![value; periods as usize],
            next: 0,
        }
    }

    /// Puts in a value, and takes out the one of as many periods ago.
    pub(super) fn pass(&mut self, value: T) -> T {
        let Some(kept) = self.values.get_mut(self.next) else {
            return value;
        };
        let before = std::mem::replace(kept, value);
        self.next = (self.next + 1) % self.values.len();
        before
    }
}
