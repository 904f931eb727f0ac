//! Question: is the tool as near to the path as it would be without the correction?
//!
//! ```text
//! eps: error of the tool p     eps_open: error of p - g     g: displacement of the tool by the offset
//! ```
//!
//! g comes from the controller's model. For a controller without a model it is the offset after a
//! first-order lag, with the time by which the tool lags. Both errors are compared as mean squares
//! and as largest values over the last [`MEMORY_S`]. The model may be wrong by some percent, and g
//! with it: harm counts only beyond that margin.
//!
//! Evidence: the error with the correction, and the limit from the error without it.

use crate::command::FaultEvidence;
use crate::contour_error::{ContourError, locate};
use crate::vector::{add_scaled, dot, norm, scale, sub};
use crate::window::Window;

/// Time over which errors are compared, s: longer than a corner, shorter than a scrapped part.
const MEMORY_S: f64 = 0.25;
/// Harm in the mean square: the error is beyond this many times the error without the correction,
/// plus this much, mm^2 (5 um).
const CERTAIN: f64 = 1.5;
const MIN_MM2: f64 = 2.5e-5;
/// Harm in a single error: it is beyond as many times the largest error without the correction, plus
/// this much, mm.
const MIN_PEAK_MM: f64 = 0.03;
/// Relative error of g that is tolerated.
const MODEL_ERROR: f64 = 0.1;
/// Limits of the mean square where g is only a guess: the factor, and the constant part, mm^2.
const GUESSED: f64 = 2.0;
const GUESSED_MM2: f64 = 1e-4;

/// Recent errors, measured and without the correction.
#[derive(Debug, Clone)]
pub(super) struct Benefit<const N: usize> {
    filtered_mm: [f64; N],
    last_mm: [f64; N],
    square_mm2: f64,
    open_square_mm2: f64,
    open_peak_mm: f64,
    /// Error without the correction at the last decision, mm.
    open_mm: f64,
}

impl<const N: usize> Benefit<N> {
    pub(super) const NONE: Self = Self {
        filtered_mm: [0.0; N],
        last_mm: [0.0; N],
        square_mm2: 0.0,
        open_square_mm2: 0.0,
        open_peak_mm: 0.0,
        open_mm: 0.0,
    };

    /// Returns the contour error without the correction, mm.
    pub(super) fn open_mm(&self) -> f64 {
        self.open_mm
    }

    /// Takes in the error at a decision; `moved_mm` is g, where the controller knows it. Returns
    /// the harm, if there is any: the root mean square, or a single error.
    pub(super) fn harm(
        &mut self,
        window: &Window<'_, N>,
        tool_mm: [f64; N],
        contour: &ContourError<N>,
        moved_mm: Option<[f64; N]>,
    ) -> Option<FaultEvidence> {
        let g_mm = moved_mm.unwrap_or_else(|| self.guessed_mm(window, contour));
        let open_mm = sub(tool_mm, g_mm);
        let reach = contour.index.saturating_neg();
        let open = locate(window, open_mm, contour.index, reach);
        let part = (window.feed_period_s / MEMORY_S).min(1.0);
        // A rapid cuts nothing, so no error on it is harm.
        let vector_mm = if window.knot(contour.index).cutting {
            contour.vector_mm
        } else {
            [0.0; N]
        };
        let square = dot(vector_mm, vector_mm);
        self.open_mm = norm(open.vector_mm);
        let open_peak_mm = self.open_mm + MODEL_ERROR * norm(g_mm);
        let open_square = open_peak_mm * open_peak_mm;
        self.square_mm2 += part * (square - self.square_mm2);
        self.open_square_mm2 += part * (open_square - self.open_square_mm2);
        self.open_peak_mm = (self.open_peak_mm * (1.0 - 0.5 * part)).max(open_peak_mm);
        let [least_mm2, times] = if moved_mm.is_none() {
            [GUESSED_MM2, GUESSED]
        } else {
            [MIN_MM2, CERTAIN]
        };
        let allowed_mm2 = least_mm2 + times * self.open_square_mm2;
        let (error_mm, peak_mm) = (norm(vector_mm), MIN_PEAK_MM + CERTAIN * self.open_peak_mm);
        if self.square_mm2 > allowed_mm2 {
            Some(FaultEvidence {
                found_mm: libm::sqrt(self.square_mm2),
                limit_mm: libm::sqrt(allowed_mm2),
            })
        } else if moved_mm.is_some() && error_mm > peak_mm {
            Some(FaultEvidence {
                found_mm: error_mm,
                limit_mm: peak_mm,
            })
        } else {
            None
        }
    }

    fn guessed_mm(&mut self, window: &Window<'_, N>, contour: &ContourError<N>) -> [f64; N] {
        let period_s = window.feed_period_s;
        let lag_s = f64::from((-contour.index).max(0)) * window.servo_s();
        // The tool has followed the mean offset of the feed period that ends, not the offset at its
        // end.
        let felt = scale(0.5, add_scaled(window.offset_mm, 1.0, self.last_mm));
        self.last_mm = window.offset_mm;
        let change = sub(felt, self.filtered_mm);
        self.filtered_mm = add_scaled(self.filtered_mm, period_s / (period_s + lag_s), change);
        self.filtered_mm
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::tests::Line;
    use crate::window::{KnotSource, Preview, Register};

    const SERVO_S: f64 = 0.001;
    const PERIOD_S: f64 = 0.003;

    /// Returns true if there is harm after a second in which the tool is `error_mm` beside the path
    /// and the offset has moved it by `moved_mm`.
    fn after_a_second(error_mm: f64, moved_mm: f64) -> bool {
        after(1000, |_| [error_mm, moved_mm])
    }

    /// Returns true if there is harm after `periods` servo periods. In each the tool is
    /// `place_mm[0]` beside the path, and the offset has moved it by `place_mm[1]`, mm.
    fn after(periods: u32, place_mm: impl Fn(u32) -> [f64; 2]) -> bool {
        let (mut register, mut preview) = (Register::default(), Preview::new(SERVO_S));
        let mut benefit = Benefit::NONE;
        let mut harm = false;
        for n in 0..periods {
            let [error_mm, moved_mm] = place_mm(n);
            let tau_s = f64::from(n) * SERVO_S;
            register.push(Line.knot(tau_s));
            preview.fill(&mut Line, tau_s, 0.01);
            if n.is_multiple_of(3) && n > 30 {
                let (offset_mm, offset_mm_s) = ([0.0; 2], [0.0; 2]);
                let (register, preview) = (&register, &preview);
                let window = Window {
                    register,
                    preview,
                    tau_s,
                    feed_period_s: PERIOD_S,
                    offset_mm,
                    offset_mm_s,
                };
                let tool_mm = [50.0 * tau_s, error_mm];
                let contour = ContourError {
                    vector_mm: [0.0, -error_mm],
                    index: 0,
                    ..ContourError::NONE
                };
                harm = benefit
                    .harm(&window, tool_mm, &contour, Some([0.0, moved_mm]))
                    .is_some();
            }
        }
        harm
    }

    #[test]
    fn harm_is_an_error_that_is_clearly_larger_than_without_the_correction() {
        // 0.05 mm with the correction, 0 without; then the reverse; then hardly different.
        assert!(after_a_second(0.05, 0.05));
        assert!(!after_a_second(0.0, -0.05));
        assert!(!after_a_second(0.01, 0.001));
    }

    #[test]
    fn a_large_error_without_the_correction_excuses_no_later_one() {
        // 0.2 mm for 0.3 s without, 2 s nothing, and then 0.045 mm with it.
        let place_mm = |gap: u32| {
            move |n| match n {
                0..300 => [0.2, 0.0],
                _ if n >= 300 + gap => [0.045, 0.045],
                _ => [0.0; 2],
            }
        };
        assert!(!after(403, place_mm(100)) && after(2303, place_mm(2000)));
    }
}
