//! Numbers that go to zero within an acceleration, each along the way of [`fade_acceleration`].

use feedwright_control::fade_acceleration;

/// A number this near to zero, and this slow, is zero, mm and mm/s.
const NONE_MM: f64 = 1e-6;
const NONE_MM_S: f64 = 1e-3;

/// N numbers and their speeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fading<const N: usize> {
    value_mm: [f64; N],
    speed_mm_s: [f64; N],
}

impl<const N: usize> Fading<N> {
    /// Nothing left to fade.
    pub const NONE: Self = Self {
        value_mm: [0.0; N],
        speed_mm_s: [0.0; N],
    };

    /// Starts at these numbers, mm, with these speeds, mm/s.
    pub fn from(value_mm: [f64; N], speed_mm_s: [f64; N]) -> Self {
        Self {
            value_mm,
            speed_mm_s,
        }
    }

    /// Starts at these numbers, mm, at rest.
    pub fn from_rest(value_mm: [f64; N]) -> Self {
        Self::from(value_mm, [0.0; N])
    }

    /// Returns the numbers that remain, mm.
    pub fn value_mm(&self) -> [f64; N] {
        self.value_mm
    }

    /// Shifts the numbers, mm; their speeds stay.
    pub fn shift(&mut self, by_mm: [f64; N]) {
        self.value_mm
            .iter_mut()
            .zip(by_mm)
            .for_each(|(value_mm, by_mm)| *value_mm += by_mm);
    }

    /// Advances by a servo period, with an acceleration of at most `most_mm_s2`.
    pub fn step(&mut self, servo_s: f64, most_mm_s2: f64) {
        for (value_mm, speed_mm_s) in self.value_mm.iter_mut().zip(&mut self.speed_mm_s) {
            let acceleration_mm_s2 = fade_acceleration(*value_mm, *speed_mm_s, servo_s, most_mm_s2);
            *value_mm += servo_s * (*speed_mm_s + 0.5 * servo_s * acceleration_mm_s2);
            *speed_mm_s += servo_s * acceleration_mm_s2;
            if value_mm.abs() < NONE_MM && speed_mm_s.abs() < NONE_MM_S {
                (*value_mm, *speed_mm_s) = (0.0, 0.0);
            }
        }
    }
}
