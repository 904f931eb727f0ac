//! Iterative learning control on the contour error: the same part is cut lap after lap, and each
//! lap begins with the offsets that the errors of the last one call for.
//!
//! ```text
//! o_{j+1}(k) = Q [ o_j(k) + L eps_j(k + lead) ]
//! ```
//!
//! k counts decisions, eps is the vector from the tool to the path, L the learning gain, and the
//! lead makes up for the lag of the loop. Q is a low-pass without phase (the Butterworth filter of
//! second order, once forward and once backward): it leaves alone what the loop cannot follow,
//! where the learning would diverge.
//!
//! Source: Arimoto, Kawamura and Miyazaki (1984), "Bettering operation of robots by learning"; on
//! the contour error: Barton and Alleyne (2008), "A cross-coupled iterative learning control design
//! for precision motion control".
//!
//! Departures: only the contour error is learned, not also the following error of each axis;
//! learning is proportional with a lead, instead of derivative.
//!
//! The method needs the same part several times: laps of practice, each behind a
//! [`Controller::next_lap`], before the lap that counts. It learns everything that repeats from lap
//! to lap. That includes a simulated disturbance that begins at the same phase in every lap, which
//! flatters the method.

use feedwright_control::vector::{add_scaled, norm};
use feedwright_control::{Command, Controller, Measured, Parameter, Schedule, Window};

use super::deciding;

/// Part of the error that a lap takes up.
pub(super) const GAIN: Parameter = Parameter::number(
    "gain",
    Settings::DEFAULT.gain,
    [0.0, 2.0],
    Some([0.1, 1.9]),
    "part of the error that a lap takes up: 0 learns nothing, 2 swings from lap to lap",
);
/// Time by which an offset comes before the error that it is for.
pub(super) const LEAD_S: Parameter = Parameter::number(
    "lead_s",
    Settings::DEFAULT.lead_s,
    [0.0, 0.5],
    Some([2e-4, 0.05]),
    "time by which an offset comes before the error that it is for: the lag of the loop",
);
/// Cut-off of Q.
pub(super) const CUT_OFF_HZ: Parameter = Parameter::number(
    "cut-off_hz",
    Settings::DEFAULT.cut_off_hz,
    [0.1, 1e4],
    Some([2.0, 400.0]),
    "frequency above which nothing is learned: beyond the bandwidth of the loop, learning grows noise",
);
/// Parameters of every row, whatever its laps.
pub(super) const PARAMETERS: [Parameter; 3] = [GAIN, LEAD_S, CUT_OFF_HZ];

/// The end of a program is followed until the tool has arrived; its errors are learned for as long,
/// s.
const ARRIVAL_S: f64 = 0.25;

/// Longest program of which all is learned, s; behind it the last offset stays.
const LONGEST_S: f64 = 120.0;

/// A cut-off is below this part of the sampling frequency, just short of its half; beyond, there is
/// nothing to take away.
const HIGHEST_CUT_OFF: f64 = 0.49;

/// Settings of the learning.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Settings {
    /// Servo periods in a feed period, at least 1.
    pub servo_periods: u32,
    /// L: part of the error that a lap takes up; 0 (none) to 2.
    pub gain: f64,
    /// Time by which an offset comes before the error that it is for, s.
    pub lead_s: f64,
    /// Frequency at which Q leaves half of an offset, Hz.
    pub cut_off_hz: f64,
}

impl Settings {
    /// Settings for a loop of 50 1/s: the lead is its time constant, and Q ends below the bandwidth
    /// of a speed loop of 200 1/s. Of the settings tried on circle, star, square and figure-eight,
    /// these have the smallest RMS errors on most.
    pub(super) const DEFAULT: Self = Self {
        servo_periods: 1,
        gain: 1.0,
        lead_s: 0.02,
        cut_off_hz: 30.0,
    };
}

/// The learning controller: table of offsets, and the errors of the lap under way.
#[derive(Debug, Clone)]
pub(super) struct IterativeLearning<const N: usize> {
    settings: Settings,
    servo_s: f64,
    /// Offset at each decision, mm.
    offsets_mm: Vec<[f64; N]>,
    /// Contour error at each decision of this lap, mm.
    errors_mm: Vec<[f64; N]>,
}

impl<const N: usize> IterativeLearning<N> {
    /// Starts before the first lap, at a servo period of `servo_s`. All memory is allocated here.
    pub(super) fn new(settings: Settings, servo_s: f64) -> Self {
        let settings = Settings {
            servo_periods: settings.servo_periods.max(1),
            ..settings
        };
        let period_s = f64::from(settings.servo_periods) * servo_s;
        let decisions = ((LONGEST_S + ARRIVAL_S) / period_s).ceil() as usize;
        Self {
            settings,
            servo_s,
            offsets_mm: vec![[0.0; N]; decisions],
            errors_mm: vec![[0.0; N]; decisions],
        }
    }

    fn period_s(&self) -> f64 {
        f64::from(self.settings.servo_periods) * self.servo_s
    }

    /// The decision at plan time `tau_s`.
    fn decision(&self, tau_s: f64) -> usize {
        (tau_s / self.period_s()).round() as usize
    }
}

impl<const N: usize> Controller<N> for IterativeLearning<N> {
    fn schedule(&self) -> Schedule {
        deciding(self.settings.servo_periods, 1)
    }

    /// Forgets all that was learned.
    fn reset(&mut self) {
        self.offsets_mm.fill([0.0; N]);
        self.errors_mm.fill([0.0; N]);
    }

    /// Learns from the lap that was cut and goes to the start of the next.
    fn next_lap(&mut self) {
        let period_s = self.period_s();
        let lead = (self.settings.lead_s / period_s).round() as usize;
        for k in 0..self.offsets_mm.len() {
            if let Some(error_mm) = self.errors_mm.get(k + lead) {
                self.offsets_mm[k] = add_scaled(self.offsets_mm[k], self.settings.gain, *error_mm);
            }
        }
        smooth(&mut self.offsets_mm, self.settings.cut_off_hz * period_s);
        self.errors_mm.fill([0.0; N]);
    }

    fn observe(&mut self, window: &Window<'_, N>, measured: Option<&Measured<N>>) {
        let now = self.decision(window.tau_s);
        if let (Some(slot), Some(measured)) = (self.errors_mm.get_mut(now), measured)
            && norm(measured.contour.vector_mm).is_finite()
        {
            *slot = measured.contour.vector_mm;
        }
    }

    fn command(&mut self, window: &Window<'_, N>, _: &Measured<N>) -> Command<N> {
        let now = self.decision(window.tau_s);
        let offset_mm = self.offsets_mm.get(now + 1).or(self.offsets_mm.last());
        Command::straight(1.0, offset_mm.copied().unwrap_or([0.0; N]))
    }
}

/// Low-pass without phase, in place: half is left at `cut_off`, a part of the sampling frequency.
///
/// Butterworth of second order by the bilinear transform, as in Oppenheim and Schafer,
/// "Discrete-time signal processing", section 7.2; before the first and behind the last value the
/// sequence goes on as it was there.
fn smooth<const N: usize>(values: &mut [[f64; N]], cut_off: f64) {
    if cut_off >= HIGHEST_CUT_OFF {
        return;
    }
    let k = libm::tan(std::f64::consts::PI * cut_off);
    let root = std::f64::consts::SQRT_2 * k;
    let scale = 1.0 / (1.0 + root + k * k);
    let (b, a1) = (k * k * scale, 2.0 * (k * k - 1.0) * scale);
    let a2 = (1.0 - root + k * k) * scale;
    let pass = |values: &mut dyn Iterator<Item = &mut [f64; N]>| {
        let mut past: Option<[[f64; N]; 4]> = None;
        for value in values {
            let x = *value;
            let [x1, x2, y1, y2] = past.unwrap_or([x; 4]);
            *value =
                std::array::from_fn(|i| b * (x[i] + 2.0 * x1[i] + x2[i]) - a1 * y1[i] - a2 * y2[i]);
            past = Some([x, x1, *value, y1]);
        }
    };
    pass(&mut values.iter_mut());
    pass(&mut values.iter_mut().rev());
}

#[cfg(test)]
mod tests {
    use feedwright_control::{Bounds, Knot, Tick};

    use super::*;

    const SERVO_S: f64 = 0.001;
    const PROGRAM_S: f64 = 2.0;

    /// The circle of 10 mm at 5 rad/s, begun slowly, in two seconds and rest.
    struct Circle;

    impl feedwright_control::KnotSource<2> for Circle {
        fn knot(&mut self, tau_s: f64) -> Knot<2> {
            let s = (tau_s / PROGRAM_S).clamp(0.0, 1.0);
            let angle = 10.0 * s * s * (3.0 - 2.0 * s);
            let (sin, cos) = libm::sincos(angle);
            let feed_mm_s = 10.0 * 10.0 * 6.0 * s * (1.0 - s) / PROGRAM_S;
            Knot {
                position_mm: [10.0 * (1.0 - cos), 10.0 * sin],
                tangent: [sin, cos],
                feed_mm_s,
                cutting: true,
            }
        }
    }

    /// One lap with two first-order loops of 50 1/s and 45 1/s: RMS of the distance from the
    /// circle, mm.
    fn lap(controller: &mut IterativeLearning<2>) -> f64 {
        let bounds = Bounds::new(0.5, 400.0, 400.0);
        let mut tick = Tick::new(SERVO_S, controller.schedule(), bounds);
        let (mut tool_mm, mut squares) = ([0.0; 2], 0.0);
        let periods = (PROGRAM_S / SERVO_S) as u32;
        for _ in 0..periods {
            let command_mm = tick.step(&mut Circle, controller, tool_mm).command_mm;
            for (i, loop_1_s) in [50.0_f64, 45.0].into_iter().enumerate() {
                tool_mm[i] += (1.0 - libm::exp(-loop_1_s * SERVO_S)) * (command_mm[i] - tool_mm[i]);
            }
            squares += (libm::hypot(tool_mm[0] - 10.0, tool_mm[1]) - 10.0).powi(2);
        }
        (squares / f64::from(periods)).sqrt()
    }

    #[test]
    fn the_error_falls_from_lap_to_lap() {
        let mut controller = IterativeLearning::new(Settings::DEFAULT, SERVO_S);
        let first_mm = lap(&mut controller);
        let again_mm = lap(&mut controller);
        let why = "nothing is learned before the next lap";
        assert_eq!(first_mm.to_bits(), again_mm.to_bits(), "{why}");
        let mut laps_mm = vec![first_mm];
        for _ in 1..10 {
            controller.next_lap();
            laps_mm.push(lap(&mut controller));
        }
        let learns = laps_mm[1] < 0.5 * laps_mm[0] && laps_mm[9] < 0.05 * laps_mm[0];
        assert!(learns, "{laps_mm:?}");
        controller.reset();
        assert_eq!(lap(&mut controller).to_bits(), first_mm.to_bits());
    }

    #[test]
    fn the_low_pass_leaves_half_at_its_cut_off_and_turns_no_phase() {
        for (hz, part) in [(0.0, 1.0), (20.0, 0.5), (200.0, 0.0)] {
            let wave =
                |k: usize| libm::cos(std::f64::consts::TAU * hz * (k as f64 - 1000.0) * SERVO_S);
            let mut values: Vec<[f64; 1]> = (0..2001).map(|k| [wave(k)]).collect();
            smooth(&mut values, 20.0 * SERVO_S);
            for k in 500..1500 {
                let [value] = values[k];
                assert!(
                    (value - part * wave(k)).abs() < 1e-4,
                    "{hz} Hz at {k}: {value}"
                );
            }
        }
    }

    #[test]
    fn absurd_settings_and_measurements_learn_nothing_absurd() {
        let settings = Settings {
            lead_s: 1e9,
            ..Settings::DEFAULT
        };
        let mut long = IterativeLearning::<2>::new(settings, SERVO_S);
        lap(&mut long);
        long.next_lap();
        assert!(lap(&mut long).is_finite());
    }
}
