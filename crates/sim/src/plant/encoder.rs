//! Measured position: interpolation error, noise and steps of the encoder, and the time until the
//! control gets the value.
//!
//! ```text
//! y = q round((x + A sin(2 pi x / P + a) + s n(c)) / q)   at mechanics period c
//! ```
//!
//! x angle at the encoder, rad at the motor shaft; A, P and a amplitude, signal period and phase of
//! the interpolation error; s RMS of the noise, n(c) as in `noise.rs`; q step; what is zero is not
//! there. The control has of y what it was a latency ago, in whole mechanics periods, and before
//! the start where the axis stood. The speed that a drive takes from positions is
//!
//! ```text
//! (y(c) - y(c - n)) / (n dt)      n = T / dt, and 1 where the window T is shorter; y is linear between two mechanics periods
//! ```
//!
//! with no latency: the encoder's cable ends in the drive. From an ideal encoder y is x, and the
//! speed over one mechanics period the speed itself. A drive may take the speed at the start of
//! each servo period only, and hold it.
//!
//! Source: Heydemann (1981), Determination and correction of quadrature fringe measurement errors
//! in interferometers, for the error of offset signals, once a signal period; quantisation and
//! difference of positions as in Franklin, Powell and Workman (1998), chapters 10 and 14.

use std::f64::consts::TAU;

use feedwright_control::AxisState;

use super::drive::in_steps;
use super::noise::{RandomStream, RandomUse};
use crate::machine::{Axis, Period};

/// A mechanics period: its number within the servo period, and since the start of the machine.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moment {
    pub(super) substep: u32,
    pub(super) counter: u64,
}

/// An encoder.
#[derive(Debug, Clone, Copy)]
pub(super) struct Encoder {
    step_rad: f64,
    noise_rad: f64,
    error_rad: f64,
    /// Turns of the signal in a radian of the shaft, times 2 pi.
    signal_per_rad: f64,
    /// Phase of the error at angle zero, rad.
    error_phase_rad: f64,
    stream: RandomStream,
}

impl Encoder {
    pub(super) fn new(axis: &Axis, stream: RandomStream) -> Self {
        let rad = |um: f64| um * 1e-3 * TAU / axis.lead_mm_per_rev;
        Self {
            step_rad: rad(axis.encoder_step_um),
            noise_rad: rad(axis.encoder_noise_um),
            error_rad: rad(axis.interpolation_error_um),
            signal_per_rad: if axis.signal_period_um > 0.0 {
                TAU / rad(axis.signal_period_um)
            } else {
                0.0
            },
            error_phase_rad: axis.interpolation_phase_rad,
            stream,
        }
    }

    /// Returns the reading at an angle, in a mechanics period.
    #[inline]
    pub(super) fn read(&self, angle_rad: f64, counter: u64) -> f64 {
        let mut shown_rad = angle_rad;
        if self.error_rad > 0.0 {
            let phase_rad = self.signal_per_rad * angle_rad + self.error_phase_rad;
            shown_rad += self.error_rad * libm::sin(phase_rad);
        }
        if self.noise_rad > 0.0 {
            shown_rad += self.noise_rad * self.stream.normal(counter);
        }
        in_steps(shown_rad, self.step_rad)
    }
}

/// The motor's speed, as the drive takes it from positions.
#[derive(Debug, Clone)]
pub(super) struct DriveSpeed {
    /// None is an ideal one.
    encoder: Option<Encoder>,
    /// Window, mechanics periods: whole ones, and the part beyond.
    window: (usize, f64),
    /// Positions of the last mechanics periods, a ring, rad; nothing before the first.
    course_rad: Vec<f64>,
    newest: usize,
    is_held: bool,
    taken_rad_s: f64,
}

impl DriveSpeed {
    /// None where the drive has the speed itself all the time. Where the position is measured at
    /// the table, the motor has an encoder of the same kind of its own.
    pub(super) fn new(
        axis: &Axis,
        encoder: Encoder,
        mechanics_s: f64,
        seed: u64,
        index: usize,
    ) -> Option<Self> {
        let of_its_own = axis
            .transmission
            .is_some_and(|transmission| transmission.scale_on_table);
        let stream = RandomStream::new(seed, index, RandomUse::MotorEncoder);
        let encoder = if of_its_own {
            Encoder { stream, ..encoder }
        } else {
            encoder
        };
        let periods = (axis.speed_window_s / mechanics_s).max(1.0);
        let is_needed = axis.speed_from_encoder || axis.speed_held || periods > 1.0;
        is_needed.then(|| Self {
            encoder: axis.speed_from_encoder.then_some(encoder),
            window: (periods as usize, periods.fract()),
            course_rad: Vec::new(),
            newest: 0,
            is_held: axis.speed_held,
            taken_rad_s: 0.0,
        })
    }

    /// Returns the speed over the window that ends with this mechanics period.
    #[inline]
    pub(super) fn speed_rad_s(&mut self, motor: &AxisState, moment: Moment, dt_s: f64) -> f64 {
        let shown_rad = self.encoder.map_or(motor.angle_rad, |encoder| {
            encoder.read(motor.angle_rad, moment.counter)
        });
        let (whole, part) = self.window;
        if self.course_rad.is_empty() {
            // Before it was switched on, the axis went on as it does.
            let moved_rad = if self.encoder.is_none() {
                dt_s * motor.speed_rad_s
            } else {
                0.0
            };
            self.course_rad = (0..whole + 2)
                .rev()
                .map(|age| shown_rad - age as f64 * moved_rad)
                .collect();
            self.newest = whole;
        }
        self.newest = (self.newest + 1) % self.course_rad.len();
        self.course_rad[self.newest] = shown_rad;
        if !self.is_held || moment.substep == 0 {
            let [newer_rad, older_rad] = [whole, whole + 1].map(|age| self.before_rad(age));
            let moved_rad = shown_rad - newer_rad + part * (newer_rad - older_rad);
            self.taken_rad_s = moved_rad / ((whole as f64 + part) * dt_s);
        }
        self.taken_rad_s
    }

    /// Returns the position `age` mechanics periods before the newest.
    #[inline]
    fn before_rad(&self, age: usize) -> f64 {
        let length = self.course_rad.len();
        self.course_rad[(self.newest + length - age) % length]
    }
}

/// Longest latency, in servo periods.
const MAX_PERIODS: usize = 64;

/// Positions on their way to the control: one a servo period, taken at the moment from which it
/// arrives at the start of one.
#[derive(Debug, Clone)]
pub(super) struct Latency {
    taken_rad: [f64; MAX_PERIODS],
    newest: usize,
    /// Number of positions taken after the one that has arrived.
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
        let total = (axis.measurement_delay_s / period.mechanics_s)
            .round()
            .clamp(0.0, most) as u64;
        let (periods, rest) = ((total / per_servo) as usize, total % per_servo);
        (total > 0).then(|| Self {
            taken_rad: [start_rad; MAX_PERIODS],
            newest: 0,
            age: if rest == 0 { periods - 1 } else { periods },
            substep: ((per_servo - rest) % per_servo) as u32,
        })
    }

    /// Returns true if the position is taken in this mechanics period of a servo period.
    #[inline]
    pub(super) fn takes(&self, substep: u32) -> bool {
        substep == self.substep
    }

    #[inline]
    pub(super) fn take(&mut self, measured_rad: f64) {
        self.newest = (self.newest + 1) % MAX_PERIODS;
        self.taken_rad[self.newest] = measured_rad;
    }

    /// Returns the position that the control has at the start of a servo period.
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
        let axis = Axis {
            interpolation_error_um: 0.5,
            signal_period_um: 20.0,
            ..axis()
        };
        let um_per_rad = 1e3 * axis.lead_mm_per_rev / TAU;
        // A phase of a quarter turn is a way of a quarter period.
        for (interpolation_phase_rad, ahead_um) in [(0.0, 0.0), (0.25 * TAU, 5.0)] {
            let axis = Axis {
                interpolation_phase_rad,
                ..axis
            };
            let encoder = Encoder::new(&axis, RandomStream::new(0, 0, RandomUse::Encoder));
            for (place_um, error_um) in [
                (0.0, 0.0),
                (5.0, 0.5),
                (10.0, 0.0),
                (15.0, -0.5),
                (1005.0, 0.5),
                (-5.0, -0.5),
            ] {
                let at_um = place_um - ahead_um;
                let shown_um = encoder.read(at_um / um_per_rad, 0) * um_per_rad;
                assert!(
                    (shown_um - at_um - error_um).abs() < 1e-9,
                    "{at_um}: {shown_um}"
                );
            }
        }
    }

    #[test]
    fn the_noise_has_its_deviation_and_another_value_each_time() {
        let axis = Axis {
            encoder_noise_um: 0.3,
            ..axis()
        };
        let encoder = Encoder::new(&axis, RandomStream::new(0, 0, RandomUse::Encoder));
        let um_per_rad = 1e3 * axis.lead_mm_per_rev / TAU;
        let square: f64 = (0..100_000)
            .map(|c| (encoder.read(0.0, c) * um_per_rad).powi(2))
            .sum::<f64>()
            / 1e5;
        assert!(
            (square.sqrt() - 0.3).abs() < 0.3 * 0.01,
            "{}: four standard errors are 0.9 %",
            square.sqrt()
        );
        assert_eq!(encoder.read(0.1, 7), encoder.read(0.1, 7));
    }

    #[test]
    fn the_speed_is_the_difference_of_whole_steps() {
        let axis = Axis {
            encoder_step_um: 1.0,
            speed_from_encoder: true,
            ..axis()
        };
        let encoder = Encoder::new(&axis, RandomStream::new(0, 0, RandomUse::Encoder));
        let mut speed = DriveSpeed::new(&axis, encoder, 1e-4, 0, 0).unwrap();
        let step_rad = 1e-3 * TAU / axis.lead_mm_per_rev;
        // 0.3 steps a period: 0, 0, 1, 1, 1, 2 (rounded), differences of whole steps whose mean is
        // the speed.
        let at = |counter: u64| AxisState {
            angle_rad: 0.3 * step_rad * counter as f64,
            ..AxisState::default()
        };
        let speeds: Vec<f64> = (0..1001)
            .map(|counter| {
                speed.speed_rad_s(
                    &at(counter),
                    Moment {
                        substep: 0,
                        counter,
                    },
                    1e-4,
                )
            })
            .collect();
        assert!(
            speeds
                .iter()
                .all(|s| (s * 1e-4 / step_rad - (s * 1e-4 / step_rad).round()).abs() < 1e-9)
        );
        let mean = speeds.iter().sum::<f64>() / 1000.0;
        assert!((mean * 1e-4 / step_rad - 0.3).abs() < 1e-3, "{mean}");
    }

    /// Speeds that a drive takes of a motor that has gone at 2 rad/s and accelerates by 30 rad/s2.
    fn taken_rad_s(axis: &Axis) -> Vec<f64> {
        let encoder = Encoder::new(axis, RandomStream::new(0, 0, RandomUse::Encoder));
        let mut speed = DriveSpeed::new(axis, encoder, 1e-4, 0, 0).unwrap();
        let mut motor = AxisState {
            speed_rad_s: 2.0,
            ..AxisState::default()
        };
        let mut take = |counter: u64| {
            let taken = speed.speed_rad_s(
                &motor,
                Moment {
                    substep: (counter % 10) as u32,
                    counter,
                },
                1e-4,
            );
            motor.speed_rad_s += 1e-4 * 30.0;
            motor.angle_rad += 1e-4 * motor.speed_rad_s;
            taken
        };
        (0..1000).map(&mut take).collect()
    }

    #[test]
    fn a_speed_over_a_window_is_late_by_half_of_it_and_one_that_is_held_by_half_a_servo_period_more()
     {
        // Expected delay: half of the window beyond one mechanics period, plus half of the hold
        // time beyond one.
        for (speed_window_s, speed_held, late_s) in [
            (0.002_868, false, 0.001_384),
            (0.0003, false, 0.0001),
            (0.002, true, 0.001_4),
            (0.0, true, 0.000_45),
        ] {
            let taken = taken_rad_s(&Axis {
                speed_window_s,
                speed_held,
                ..axis()
            });
            assert!(
                (taken[0] - 2.0).abs() < 1e-9,
                "{}: it begins with what it moves at",
                taken[0]
            );
            let late: f64 = (500..1000)
                .map(|c| 2.0 + 30.0 * 1e-4 * f64::from(c) - taken[c as usize])
                .sum::<f64>()
                / 500.0;
            // Between two mechanics periods a parabola is taken for a line.
            assert!(
                (late / 30.0 - late_s).abs() < 1e-6,
                "{speed_window_s} {speed_held}: {} s",
                late / 30.0
            );
            let changes = taken[500..]
                .windows(2)
                .filter(|pair| pair[0] != pair[1])
                .count();
            assert_eq!(
                changes,
                if speed_held { 49 } else { 499 },
                "{speed_window_s}"
            );
        }
        let encoder = Encoder::new(&axis(), RandomStream::new(0, 0, RandomUse::Encoder));
        let within_one = Axis {
            speed_window_s: 1e-4,
            ..axis()
        };
        assert!(
            DriveSpeed::new(&within_one, encoder, 1e-4, 0, 0).is_none(),
            "that is the speed itself"
        );
    }

    #[test]
    fn a_position_arrives_after_the_latency_to_the_mechanics_period() {
        let period = Machine::load("tnv40".as_ref()).unwrap().period;
        for (delay_s, substeps) in [
            (0.0001, 1),
            (0.0004, 4),
            (0.001, 10),
            (0.0013, 13),
            (0.003, 30),
            (0.02, 200),
        ] {
            let axis = Axis {
                measurement_delay_s: delay_s,
                ..axis()
            };
            let mut latency = Latency::new(&axis, &period, -1.0).unwrap();
            for n in 0..100_i64 {
                // The position is the number of the mechanics period.
                let wanted = n * 10 - substeps;
                assert_eq!(
                    latency.arrived_rad(),
                    if wanted < 0 { -1.0 } else { wanted as f64 },
                    "{delay_s} {n}"
                );
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
