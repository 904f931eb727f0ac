//! What is measured of a position: interpolation error, noise and steps of the encoder, and the time until the control has it.
//!
//! ```text
//! y = q round((x + A sin(2 pi x / P) + s n(c)) / q)       at mechanics period c
//! ```
//!
//! x angle at the encoder, rad at the motor shaft; A and P amplitude and signal period of the interpolation error; s RMS of the noise,
//! n(c) as in `noise.rs`; q step; what is zero is not there. The control has of y what it was a latency ago, in whole mechanics
//! periods, and before the start where the axis stood. The speed that a drive takes from the encoder is (y(c) - y(c - 1)) / dt, with
//! no latency: the encoder's cable ends in the drive.
//!
//! Source: Heydemann (1981), Determination and correction of quadrature fringe measurement errors in interferometers, for the error
//! of offset signals, once a signal period; quantisation and difference of positions as in Franklin, Powell and Workman (1998), chapters
//! 10 and 14.

use std::f64::consts::TAU;

use super::drive::in_steps;
use super::noise::{RandomStream, RandomUse};
use crate::machine::{Axis, Period};

/// An encoder.
#[derive(Debug, Clone, Copy)]
pub(super) struct Encoder {
    step_rad: f64,
    noise_rad: f64,
    error_rad: f64,
    /// Turns of the signal in a radian of the shaft, times 2 pi.
    signal_per_rad: f64,
    stream: RandomStream,
}

impl Encoder {
    pub(super) fn new(axis: &Axis, stream: RandomStream) -> Self {
        let rad = |um: f64| um * 1e-3 * TAU / axis.lead_mm_per_rev;
        Self {
            step_rad: rad(axis.encoder_step_um),
            noise_rad: rad(axis.encoder_noise_um),
            error_rad: rad(axis.interpolation_error_um),
            signal_per_rad: if axis.signal_period_um > 0.0 { TAU / rad(axis.signal_period_um) } else { 0.0 },
            stream,
        }
    }

    /// What it shows at an angle, in a mechanics period.
    #[inline]
    pub(super) fn read(&self, angle_rad: f64, counter: u64) -> f64 {
        let mut shown_rad = angle_rad;
        if self.error_rad > 0.0 {
            shown_rad += self.error_rad * libm::sin(self.signal_per_rad * angle_rad);
        }
        if self.noise_rad > 0.0 {
            shown_rad += self.noise_rad * self.stream.normal(counter);
        }
        in_steps(shown_rad, self.step_rad)
    }
}

/// The motor's speed by its encoder.
#[derive(Debug, Clone, Copy)]
pub(super) struct SpeedByDifference {
    encoder: Encoder,
    last_rad: Option<f64>,
}

impl SpeedByDifference {
    /// Where the drive takes the speed from the encoder. Where the position is measured at the table, the motor has an encoder of
    /// the same kind of its own.
    pub(super) fn new(axis: &Axis, encoder: Encoder, seed: u64, index: usize) -> Option<Self> {
        let of_its_own = axis.transmission.is_some_and(|transmission| transmission.scale_on_table);
        let stream = RandomStream::new(seed, index, RandomUse::MotorEncoder);
        let encoder = if of_its_own { Encoder { stream, ..encoder } } else { encoder };
        axis.speed_from_encoder.then_some(Self { encoder, last_rad: None })
    }

    /// Over the last mechanics period.
    #[inline]
    pub(super) fn speed_rad_s(&mut self, angle_rad: f64, counter: u64, dt_s: f64) -> f64 {
        let shown_rad = self.encoder.read(angle_rad, counter);
        let moved_rad = self.last_rad.map_or(0.0, |last_rad| shown_rad - last_rad);
        self.last_rad = Some(shown_rad);
        moved_rad / dt_s
    }
}

/// Longest latency, in servo periods.
const MAX_PERIODS: usize = 64;

/// Positions on their way to the control: one a servo period, taken at the moment from which it arrives at the start of one.
#[derive(Debug, Clone)]
pub(super) struct Latency {
    taken_rad: [f64; MAX_PERIODS],
    newest: usize,
    /// How many taken after the one that is there.
    age: usize,
    /// Mechanics period of a servo period in which it is taken.
    substep: u32,
}

impl Latency {
    /// None where it takes no time.
    pub(super) fn new(axis: &Axis, period: &Period, start_rad: f64) -> Option<Self> {
        let per_servo = u64::from(period.mechanics_per_servo);
        let most = ((MAX_PERIODS - 1) as u64 * per_servo) as f64;
        // The reader of machine files keeps it below the ring; what is made by hand is held to it.
        let total = (axis.measurement_delay_s / period.mechanics_s).round().clamp(0.0, most) as u64;
        let (periods, rest) = ((total / per_servo) as usize, total % per_servo);
        (total > 0).then(|| Self {
            taken_rad: [start_rad; MAX_PERIODS],
            newest: 0,
            age: if rest == 0 { periods - 1 } else { periods },
            substep: ((per_servo - rest) % per_servo) as u32,
        })
    }

    /// Whether it is taken in this mechanics period of a servo period.
    #[inline]
    pub(super) fn takes(&self, substep: u32) -> bool {
        substep == self.substep
    }

    #[inline]
    pub(super) fn take(&mut self, measured_rad: f64) {
        self.newest = (self.newest + 1) % MAX_PERIODS;
        self.taken_rad[self.newest] = measured_rad;
    }

    /// What the control has at the start of a servo period.
    #[inline]
    pub(super) fn arrived_rad(&self) -> f64 {
        self.taken_rad[(self.newest + MAX_PERIODS - self.age) % MAX_PERIODS]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::Machine;

    fn axis() -> Axis {
        Machine::load("tnv40".as_ref()).unwrap().axes[0]
    }

    #[test]
    fn the_interpolation_error_is_a_sine_of_its_period() {
        let axis = Axis { interpolation_error_um: 0.5, signal_period_um: 20.0, ..axis() };
        let encoder = Encoder::new(&axis, RandomStream::new(0, 0, RandomUse::Encoder));
        let um_per_rad = 1e3 * axis.lead_mm_per_rev / TAU;
        for (at_um, error_um) in [(0.0, 0.0), (5.0, 0.5), (10.0, 0.0), (15.0, -0.5), (1005.0, 0.5), (-5.0, -0.5)] {
            let shown_um = encoder.read(at_um / um_per_rad, 0) * um_per_rad;
            assert!((shown_um - at_um - error_um).abs() < 1e-9, "{at_um}: {shown_um}");
        }
    }

    #[test]
    fn the_noise_has_its_deviation_and_another_value_each_time() {
        let axis = Axis { encoder_noise_um: 0.3, ..axis() };
        let encoder = Encoder::new(&axis, RandomStream::new(0, 0, RandomUse::Encoder));
        let um_per_rad = 1e3 * axis.lead_mm_per_rev / TAU;
        let square: f64 = (0..100_000).map(|c| (encoder.read(0.0, c) * um_per_rad).powi(2)).sum::<f64>() / 1e5;
        assert!((square.sqrt() - 0.3).abs() < 0.3 * 0.01, "{}: four standard errors are 0.9 %", square.sqrt());
        assert_eq!(encoder.read(0.1, 7), encoder.read(0.1, 7));
    }

    #[test]
    fn the_speed_is_the_difference_of_whole_steps() {
        let axis = Axis { encoder_step_um: 1.0, speed_from_encoder: true, ..axis() };
        let encoder = Encoder::new(&axis, RandomStream::new(0, 0, RandomUse::Encoder));
        let mut speed = SpeedByDifference::new(&axis, encoder, 0, 0).unwrap();
        let step_rad = 1e-3 * TAU / axis.lead_mm_per_rev;
        // 0.3 steps a period: 0, 0, 1, 1, 1, 2 (rounded), differences of whole steps whose mean is the speed.
        let speeds: Vec<f64> = (0..1001_u64).map(|c| speed.speed_rad_s(0.3 * step_rad * c as f64, c, 1e-4)).collect();
        assert!(speeds.iter().all(|s| (s * 1e-4 / step_rad - (s * 1e-4 / step_rad).round()).abs() < 1e-9));
        let mean = speeds.iter().sum::<f64>() / 1000.0;
        assert!((mean * 1e-4 / step_rad - 0.3).abs() < 1e-3, "{mean}");
    }

    #[test]
    fn a_position_arrives_after_the_latency_to_the_mechanics_period() {
        let period = Machine::load("tnv40".as_ref()).unwrap().period;
        for (delay_s, substeps) in [(0.0001, 1), (0.0004, 4), (0.001, 10), (0.0013, 13), (0.003, 30), (0.02, 200)] {
            let axis = Axis { measurement_delay_s: delay_s, ..axis() };
            let mut latency = Latency::new(&axis, &period, -1.0).unwrap();
            for n in 0..100_i64 {
                // The position is the number of the mechanics period.
                let wanted = n * 10 - substeps;
                assert_eq!(latency.arrived_rad(), if wanted < 0 { -1.0 } else { wanted as f64 }, "{delay_s} {n}");
                for substep in 0..period.mechanics_per_servo {
                    if latency.takes(substep) {
                        latency.take((n * 10 + i64::from(substep)) as f64);
                    }
                }
            }
        }
        assert!(Latency::new(&axis(), &period, 0.0).is_none());
    }
}
