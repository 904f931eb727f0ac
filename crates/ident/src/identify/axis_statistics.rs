//! Statistics of an axis from a recording: noise of the encoder, disturbances on the motor that the
//! axis model does not have, and deviations that repeat with place.
//!
//! The model of the axis is given, by data sheets or identified. A filter that knows only this
//! model follows the recording. Its innovations contain everything else:
//!
//! | File | What |
//! |---|---|
//! | `axis_statistics/innovation.rs` | the filter, and what loads and encoder make of its innovations |
//! | `axis_statistics/spectrum.rs` | Fourier transform, and the spectrum of a sequence with gaps |
//! | `axis_statistics/noise.rs` | white noise, broadband torque and a line, most likely by that spectrum |
//! | `axis_statistics/place.rs` | interpolation error and cogging, found by a scan and admitted by the likelihood |
//! | `axis_statistics/search.rs` | the least value of a function |
//!
//! Steps of the encoder are the common divisor of what was measured. Noise is fitted, then what
//! repeats with place with that noise, then both once more without the other. What the recording
//! does not show is zero.
//!
//! Departures: one line and one order of cogging, the strongest; ripple of the motor and the ball
//! screw count as broadband torque.

mod search;
mod innovation;
mod noise;
mod place;
use std::f64::consts::TAU;

use feedwright_control::{Parameters, Periods};
use feedwright_sim::Known;

use super::recording::Recording;
use crate::spectrum::{self, Spectrum};
use innovation::{AxisFilter, Innovations};
use noise::{NoiseFit, Seen};
use place::{Through, Wave, Weighed};

/// Length of a segment of the spectrum, s: the spectrum separates 0.2 Hz, and a minute has some
/// twenty segments.
const SEGMENT_S: f64 = 4.0;
/// Smallest torque that is reported, as a part of the Coulomb friction. Friction models fit to some
/// per cent, so smaller torques look like their residual.
const LEAST_TORQUE: f64 = 0.05;
/// Differences of positions from which the step is found: enough for the least common one.
const STEP_SAMPLES: usize = 4000;
/// Rounding of numbers, as a part of the travel of a recording: ten thousand times the rounding of
/// a double.
const ROUNDING: f64 = 1e-12;
/// Smallest step, in units of [`ROUNDING`] of the travel. Numbers without a common divisor give a
/// larger divisor once in a hundred times, and the next number then corrects it.
const LEAST_STEP: f64 = 1e3;
/// Smallest interpolation error that is kept, as a part of the encoder's RMS noise: it is 2 % of
/// the mean square.
const LEAST_INTERPOLATION: f64 = 0.2;
/// The same in least noises of an encoder, for those without noise: 0.005 um on a lead of 10 mm.
const LEAST_NOISES: f64 = 5.0;
/// Periods in a turn by which both kinds differ: what one leaves of a wave is not the other.
const APART: f64 = 1.0;
/// Steps of the encoder alone have this variance or less, times the square of the step over 12:
/// rounding of a slow motion is not quite white.
const STEPS_ALONE: f64 = 1.3;

/// Estimates the statistics of all axes of a recording, beyond what is known of them. The recording
/// must have one knot per servo period.
pub fn axis_statistics<const N: usize>(recording: &Recording<N>, known: &Known) -> [Parameters; N] {
    std::array::from_fn(|i| {
        let axis = known.axis(i);
        let stretches = recording.of_axis(i, axis.nominal.command_periods(known.period.servo_s));
        let periods = known.period.periods();
        of_axis(&stretches, axis.nominal, periods, &KnownWaves::default())
    })
}

/// Waves whose place is known. Only their amplitudes and phases are then estimated.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct KnownWaves {
    /// Signal periods of the encoder in a radian of the motor, times 2 pi.
    pub(super) signal_per_rad: Option<f64>,
    /// Periods of the cogging in a turn of the motor.
    pub(super) cogging_per_rev: Option<f64>,
}

/// Estimates the statistics of one axis from commands and measured positions, mm, one pair per
/// servo period. `nominal` is the axis model.
pub(super) fn of_axis(
    stretches: &[Vec<[f64; 2]>],
    nominal: Parameters,
    periods: Periods,
    known: &KnownWaves,
) -> Parameters {
    let (rad_per_mm, servo_s) = (nominal.rad_per_mm, periods.servo_s);
    let step_rad = step_mm(stretches) * rad_per_mm;
    let noise_rad = rough_noise_mm(stretches) * rad_per_mm;
    let filter = AxisFilter::new(nominal, periods, noise_rad);
    let in_rad = stretches.iter().map(|stretch| {
        stretch
            .iter()
            .map(|row| row.map(|mm| mm * rad_per_mm))
            .collect()
    });
    let innovations = filter.innovations(in_rad);
    let segment = ((SEGMENT_S / servo_s) as usize).next_power_of_two();
    if innovations.counts.iter().filter(|&&counts| counts).count() < 2 * segment {
        return Parameters {
            encoder_step_rad: step_rad,
            ..Parameters::NOTHING
        };
    }
    let least_nm = LEAST_TORQUE * nominal.coulomb_friction_nm;
    let segment_responses = filter.responses(segment);
    let noise_of = |innovations: &Innovations| {
        let spectrum = Spectrum::new(&innovations.error_rad, &innovations.counts, segment);
        Seen::new(&spectrum, &segment_responses, servo_s).noise(least_nm)
    };
    let length = (innovations.error_rad.len() + segment).next_power_of_two();
    let responses = filter.responses(length);
    let first = noise_of(&innovations);
    let is_steps = step_rad > 0.0 && is_steps_alone(&first, step_rad);
    let weighed = Weighed::new(&innovations, &responses, &first, servo_s, is_steps);
    let search = WaveSearch {
        responses: &responses,
        noise: &first,
        servo_s,
        step_rad,
        is_steps,
        least_nm,
        known,
    };
    let waves = search.waves(&weighed);
    if waves.is_empty() {
        return statistics(&first, &[], step_rad);
    }
    let noise = noise_of(&weighed.without(&waves));
    let weighed = Weighed::new(&innovations, &responses, &noise, servo_s, is_steps);
    let shown = |(through, wave): &(Through, Wave)| match through {
        Through::Motor => wave.amplitude() > least_nm,
        Through::Encoder => wave.amplitude() > least_rad(&noise),
    };
    let again = weighed.amplitudes(&waves);
    let kept: Vec<(Through, Wave)> = again.iter().copied().filter(shown).collect();
    if kept.len() == again.len() {
        return statistics(&noise, &kept, step_rad);
    }
    // What was none has spoilt the noise.
    statistics(&noise_of(&weighed.without(&kept)), &kept, step_rad)
}

/// Search for the waves that repeat with place.
struct WaveSearch<'a> {
    responses: &'a [Vec<spectrum::Phasor>; 2],
    noise: &'a NoiseFit,
    servo_s: f64,
    step_rad: f64,
    /// True if its steps are the only noise of the encoder.
    is_steps: bool,
    /// Smallest cogging, N m.
    least_nm: f64,
    known: &'a KnownWaves,
}

impl WaveSearch<'_> {
    /// Finds the waves: the stronger kind first, the other in the residual.
    fn waves(&self, weighed: &Weighed<'_>) -> Vec<(Through, Wave)> {
        let Some((through, wave, _)) = [Through::Motor, Through::Encoder]
            .into_iter()
            .filter_map(|through| self.wave(weighed, through))
            .max_by(|a, b| a.2.total_cmp(&b.2))
        else {
            return Vec::new();
        };
        let left = weighed.without(&[(through, wave)]);
        let weighed = Weighed::new(
            &left,
            self.responses,
            self.noise,
            self.servo_s,
            self.is_steps,
        );
        let other = match through {
            Through::Motor => Through::Encoder,
            Through::Encoder => Through::Motor,
        };
        let other = self
            .wave(&weighed, other)
            .map(|(through, wave, _)| (through, wave))
            .filter(|(_, other)| (other.per_rad - wave.per_rad).abs() > APART);
        [Some((through, wave)), other]
            .into_iter()
            .flatten()
            .collect()
    }

    /// Returns the wave of a kind, if it shows, and the gain in 2 ln L.
    fn wave(&self, weighed: &Weighed<'_>, through: Through) -> Option<(Through, Wave, f64)> {
        let found = match through {
            Through::Motor => weighed.cogging(self.least_nm, self.known.cogging_per_rev),
            Through::Encoder => weighed.interpolation(
                self.step_rad,
                least_rad(self.noise),
                self.known.signal_per_rad,
            ),
        };
        found.map(|(wave, gain)| (through, wave, gain))
    }
}

/// Least interpolation error that is of use, rad.
fn least_rad(noise: &NoiseFit) -> f64 {
    (LEAST_INTERPOLATION * noise.encoder_rad2.sqrt())
        .max(LEAST_NOISES * innovation::LEAST_NOISE_RAD)
}

/// Returns true if the encoder has no noise but the rounding to its steps.
fn is_steps_alone(noise: &NoiseFit, step_rad: f64) -> bool {
    let of_steps_rad2 = step_rad * step_rad / 12.0;
    let least_rad2 = (STEPS_ALONE * of_steps_rad2).max(4.0 * innovation::LEAST_NOISE_RAD.powi(2));
    noise.encoder_rad2 < least_rad2
}

fn statistics(noise: &NoiseFit, waves: &[(Through, Wave)], step_rad: f64) -> Parameters {
    let of_steps_rad2 = step_rad * step_rad / 12.0;
    let alone = is_steps_alone(noise, step_rad);
    let wave = |kind: Through| {
        waves
            .iter()
            .find(|(through, _)| *through == kind)
            .map_or(Wave::default(), |(_, w)| *w)
    };
    let (cogging, interpolation) = (wave(Through::Motor), wave(Through::Encoder));
    Parameters {
        encoder_noise_rad: if alone {
            0.0
        } else {
            (noise.encoder_rad2 - of_steps_rad2).sqrt()
        },
        encoder_step_rad: step_rad,
        interpolation_rad: interpolation.amplitude(),
        interpolation_phase_rad: interpolation.phase_rad(),
        signal_per_rad: interpolation.per_rad,
        torque_noise_nm: noise.torque_nm,
        torque_noise_s: noise.torque_s,
        disturbance_nm: noise.line_nm,
        disturbance_rad_s: TAU * noise.line_hz,
        disturbance_wander: if noise.line_hz > 0.0 {
            noise.wander_hz / noise.line_hz
        } else {
            0.0
        },
        cogging_nm: cogging.amplitude(),
        cogging_phase_rad: cogging.phase_rad(),
        cogging_per_rev: cogging.per_rad,
        ..Parameters::NOTHING
    }
}

/// Returns the step of the encoder, mm: the common divisor of the measured positions. Zero if they
/// have no common divisor.
fn step_mm(stretches: &[Vec<[f64; 2]>]) -> f64 {
    let measured = || {
        stretches
            .iter()
            .flat_map(|stretch| stretch.iter().map(|row| row[1]))
    };
    let Some(first_mm) = measured().next() else {
        return 0.0;
    };
    let way_mm = measured().fold(0.0_f64, |most, mm| most.max((mm - first_mm).abs()));
    let moved = || {
        measured()
            .take(STEP_SAMPLES)
            .map(|mm| (mm - first_mm).abs())
    };
    // Euclid's algorithm, in numbers that are rounded.
    let least_mm = ROUNDING * way_mm;
    let mut divisor_mm = 0.0_f64;
    for mut mm in moved() {
        while mm > least_mm {
            (divisor_mm, mm) = (
                mm,
                if divisor_mm > 0.0 {
                    remainder(divisor_mm, mm)
                } else {
                    0.0
                },
            );
        }
    }
    if divisor_mm > LEAST_STEP * least_mm {
        divisor_mm
    } else {
        0.0
    }
}

/// Returns the distance of `of` from the nearest whole multiple of `by`.
fn remainder(of: f64, by: f64) -> f64 {
    (of - by * (of / by).round()).abs()
}

/// White noise of the encoder at the most, mm: by fourth differences, whose coefficients have the
/// sum of squares 70, of which a motion leaves next to nothing.
fn rough_noise_mm(stretches: &[Vec<[f64; 2]>]) -> f64 {
    let mut squares: Vec<f64> = stretches
        .iter()
        .flat_map(|stretch| stretch.windows(5))
        .map(|w| (w[0][1] - 4.0 * w[1][1] + 6.0 * w[2][1] - 4.0 * w[3][1] + w[4][1]).powi(2))
        .collect();
    let middle = squares.len() / 2;
    if squares.is_empty() {
        return 0.0;
    }
    // The median of the square of a normal variable is 0.455 times its variance.
    (*squares.select_nth_unstable_by(middle, f64::total_cmp).1 / (0.455 * 70.0)).sqrt()
}
