//! How long a controller takes to be back at its error when the machine has changed in mid-cut.
//!
//! At each moment after the change
//!
//! ```text
//! E <= 1.5 E0 max(1, U / U0) + 0.5 um
//! ```
//!
//! is asked for, with E the RMS contour error of the controller over the last 0.2 s of cutting, U that of the uncorrected cut, and 0
//! for the cut without the change. So a corner is compared with the same corner, and a controller may lose as much as the uncorrected cut
//! does. A controller is back after the last moment at which it is above that.

use std::io;

use feedwright_sim::{Row, Sink};

/// What the error may be, in what it is without the change, and um more.
const ALLOWED: (f64, f64) = (1.5, 0.5);
/// The error is the RMS over this time of cutting, s.
const WINDOW_S: f64 = 0.2;
/// Time within which a controller has to be back, s.
pub(super) const BACK_S: f64 = 1.0;
/// Cutting time after that which a verdict needs, s: one window.
const LEAST_S: f64 = WINDOW_S;
/// An uncorrected error below this counts as this, um.
const MIN_UM: f64 = 1e-3;

/// Contour errors of a cut by servo period, um; none where it does not cut.
#[derive(Debug, Default)]
pub(super) struct ErrorCourse {
    pub(super) servo_s: f64,
    pub(super) errors_um: Vec<Option<f64>>,
}

impl Sink for ErrorCourse {
    fn row(&mut self, row: &Row) -> io::Result<()> {
        // A long rest has no rows.
        let period = (row.t_s / self.servo_s).round() as usize;
        self.errors_um.resize(period, None);
        self.errors_um.push(row.cutting.then_some(1e3 * row.contour_error_mm.abs()));
        Ok(())
    }
}

impl ErrorCourse {
    /// The period in the middle of all that cut.
    pub(super) fn middle(&self) -> Option<usize> {
        let cutting: Vec<usize> = (0..self.errors_um.len()).filter(|&n| self.errors_um[n].is_some()).collect();
        cutting.get(cutting.len() / 2).copied()
    }

    /// RMS over the last [`WINDOW_S`] of cutting, um, in every period that cuts.
    fn sliding_um(&self) -> Vec<Option<f64>> {
        let window = (WINDOW_S / self.servo_s).round().max(1.0) as usize;
        let mut squares: Vec<f64> = vec![0.0];
        let sliding = |error_um: &Option<f64>| {
            squares.push(squares.last()? + (*error_um)? * (*error_um)?);
            let last = squares.len() - 1;
            let first = last.saturating_sub(window);
            // What is left of large numbers may be below zero.
            Some(((squares[last] - squares[first]).max(0.0) / (last - first) as f64).sqrt())
        };
        self.errors_um.iter().map(sliding).collect()
    }

    /// Largest error from a period on, um.
    pub(super) fn max_um(&self, from: usize) -> f64 {
        self.errors_um.iter().skip(from).flatten().copied().fold(0.0, f64::max)
    }

    /// RMS error from a period on, um; none without a period that cuts.
    fn rms_um(&self, from: usize) -> Option<f64> {
        let squares: Vec<f64> =
            self.errors_um.iter().skip(from).flatten().map(|error_um| error_um * error_um).collect();
        (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
    }
}

/// A cut without the change and one with it, uncorrected and with a controller.
pub(super) struct Pairs<'a> {
    pub(super) open: [&'a ErrorCourse; 2],
    pub(super) own: [&'a ErrorCourse; 2],
    /// First period after the change.
    pub(super) at: usize,
}

impl Pairs<'_> {
    /// Time after the change at which the error was above what is allowed for the last time, s; none where the cut is too short.
    pub(super) fn back_s(&self) -> Option<f64> {
        let servo_s = self.open[0].servo_s;
        let late = self.at + (BACK_S / servo_s) as usize;
        let [open, own] = [self.open, self.own].map(|pair| pair.map(ErrorCourse::sliding_um));
        let length = [&open, &own].into_iter().flatten().map(Vec::len).min()?;
        let (mut last_above, mut looked_at) = (None, 0);
        for n in self.at..length {
            let (Some(u0), Some(u), Some(e0), Some(e)) = (open[0][n], open[1][n], own[0][n], own[1][n]) else {
                continue;
            };
            looked_at += usize::from(n >= late);
            if e > ALLOWED.0 * e0 * (u / u0.max(MIN_UM)).max(1.0) + ALLOWED.1 {
                last_above = Some(n);
            }
        }
        let is_enough = looked_at as f64 * servo_s >= LEAST_S;
        is_enough.then(|| last_above.map_or(0.0, |n| (n + 1 - self.at) as f64 * servo_s))
    }

    /// RMS error later than [`BACK_S`] after the change, over the same without it.
    pub(super) fn level(&self) -> Option<f64> {
        let late = self.at + (BACK_S / self.open[0].servo_s) as usize;
        let [before, after] = self.own.map(|course| course.rms_um(late));
        Some(after? / before?.max(MIN_UM))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors by the millisecond, um.
    fn course(error_um: impl Fn(usize) -> f64) -> ErrorCourse {
        ErrorCourse { servo_s: 0.001, errors_um: (0..5000).map(|n| Some(error_um(n))).collect() }
    }

    /// The change comes after 2 s; the uncorrected error stays at 10 um, or becomes this one.
    fn back_s(open_um: f64, own_um: impl Fn(usize) -> f64) -> Option<f64> {
        let [before, after] = [course(|_| 10.0), course(|n| if n < 2000 { 10.0 } else { open_um })];
        let [calm, own] = [course(|_| 2.0), course(own_um)];
        Pairs { open: [&before, &after], own: [&calm, &own], at: 2000 }.back_s()
    }

    #[test]
    fn a_controller_is_back_when_the_error_of_the_last_fifth_of_a_second_is_allowed() {
        let until = |end: usize, um: f64| move |n: usize| if (2000..end).contains(&n) { um } else { 2.0 };
        assert_eq!(back_s(10.0, until(2000, 0.0)), Some(0.0));
        // 1.5 times 2 um and 0.5 um are 3.5 um, and an error of 3.4 um stays below.
        assert_eq!(back_s(10.0, until(5000, 3.4)), Some(0.0));
        // 6 um until 2.3 s: m of 200 periods with 6 um have sqrt(4 + 32 m / 200) um, which is 3.5 um at m = 51.6.
        assert!((back_s(10.0, until(2300, 6.0)).unwrap_or_default() - 0.448).abs() < 1e-9);
        assert_eq!(back_s(10.0, until(5000, 6.0)), Some(3.0));
        // Where the uncorrected error doubles, twice as much and 0.5 um is allowed, once the window is full.
        assert_eq!(back_s(20.0, until(5000, 6.0)), Some(0.0));
        assert_eq!(back_s(20.0, until(5000, 6.6)), Some(3.0));
        assert_eq!(back_s(5.0, until(5000, 3.4)), Some(0.0), "less error uncorrected allows no less");
        let [open, own] = [course(|_| 10.0), course(|_| 2.0)];
        let late = Pairs { open: [&open, &open], own: [&own, &own], at: 3801 };
        assert_eq!((late.back_s(), late.level()), (None, Some(1.0)));
        assert_eq!(course(|n| n as f64).middle(), Some(2500));
    }
}
