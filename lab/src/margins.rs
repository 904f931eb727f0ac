//! Margins of the loop of `lqg-identified`, measured on the controller as it runs: broken at the
//! command of an axis that moves at constant speed.
//!
//! ```text
//! S(w) = 1 + sum of c_n exp(-i w n Ts)        L = 1/S - 1
//! ```
//!
//! c_n is the difference of the commands of two runs that are equal, but for one command that was
//! sent with a unit more. Noise, cogging and friction are the same in both.
//!
//! Source: Skogestad and Postlethwaite (2005), Multivariable Feedback Control, section 2.4.

use std::f64::consts::{PI, TAU};

use feedwright_control::{
    AxisModel, Bounds, Controller, Knot, KnotSource, LqgIdentified, LqgSettings, Tick,
};
use feedwright_sim::{Machine, Plant, Squareness};
use nalgebra::Complex;

/// Speed of the axis, mm/s, and the time in which it is reached, s.
const FEED_MM_S: f64 = 20.0;
const RISE_S: f64 = 0.2;
/// Time of the changed command, and the time that is observed from it on, s.
const CHANGED_S: f64 = 1.5;
const OBSERVED_S: f64 = 6.0;
/// Part of that time whose mean is taken to stay after its end.
const TAIL: f64 = 0.1;
/// Change of the command, mm: small for the loop, and rounding is a millionth of it.
const CHANGE_MM: f64 = 1e-5;
/// Number of frequencies up to half the servo rate, and the lowest one, Hz: slow loads are below it.
const FREQUENCIES: u32 = 4000;
const LOWEST_HZ: f64 = 3.0;

/// Margins of a loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Margins {
    /// Smallest factor on the gain, above 1, at which the loop becomes unstable.
    pub gain: f64,
    /// Smallest lag at which it becomes unstable, rad.
    pub phase_rad: f64,
}

/// The path: an axis that speeds up and then keeps its speed.
struct Line;

impl KnotSource<1> for Line {
    fn knot(&mut self, tau_s: f64) -> Knot<1> {
        let tau_s = tau_s.max(0.0);
        let (part, rise_s) = ((tau_s / RISE_S).min(1.0), tau_s.min(RISE_S));
        // The speed rises by 3 p^2 - 2 p^3.
        let risen_s = rise_s * part * part * (1.0 - 0.5 * part);
        Knot {
            position_mm: [FEED_MM_S * (risen_s + (tau_s - rise_s))],
            tangent: [1.0],
            feed_mm_s: FEED_MM_S * part * part * (3.0 - 2.0 * part),
            cutting: true,
        }
    }
}

/// Measures the margins of an axis of a machine with a controller by this model of the axis.
pub fn margins(machine: &Machine, axis: usize, model: AxisModel, settings: LqgSettings) -> Margins {
    let of_axis = of_axis(machine, axis);
    let [changed_mm, plain_mm] =
        [CHANGE_MM, 0.0].map(|change_mm| commands_mm(&of_axis, model, settings, change_mm));
    let changed: Vec<f64> = changed_mm
        .iter()
        .zip(&plain_mm)
        .map(|(changed, plain)| (changed - plain) / CHANGE_MM)
        .collect();
    let tail = (TAIL * changed.len() as f64) as usize;
    let rest = changed.iter().rev().take(tail).sum::<f64>() / tail as f64;
    let lowest_rad = TAU * LOWEST_HZ * machine.period.servo_s;
    let open: Vec<Complex<f64>> = (1..=FREQUENCIES)
        .map(|n| PI * f64::from(n) / f64::from(FREQUENCIES))
        .filter(|rad| *rad > lowest_rad)
        .map(|rad| {
            let turn = Complex::new(libm::cos(rad), -libm::sin(rad));
            let after = (Complex::new(1.0, 0.0) - turn).inv() * rest;
            // Horner's rule, from the end on.
            let commands = changed.iter().rev();
            let sensitivity = commands.fold(after, |sum, command| sum * turn + command);
            sensitivity.inv() - 1.0
        })
        .collect();
    let size = |z: &Complex<f64>| libm::hypot(z.re, z.im);
    let mut margins = Margins {
        gain: f64::INFINITY,
        phase_rad: PI,
    };
    let end = open.last().map(|z| [z.conj(), *z]);
    let pairs = open.windows(2).map(|pair| [pair[0], pair[1]]);
    for [from, to] in pairs.chain(end) {
        if from.im * to.im < 0.0 && from.re < 0.0 {
            let part = from.im / (from.im - to.im);
            let gain = -1.0 / (from.re + part * (to.re - from.re));
            if gain > 1.0 {
                margins.gain = margins.gain.min(gain);
            }
        }
        if (size(&from) - 1.0) * (size(&to) - 1.0) < 0.0 {
            margins.phase_rad = margins.phase_rad.min(libm::atan2(from.im, -from.re).abs());
        }
    }
    margins
}

/// Returns the commands from the changed one on, mm.
fn commands_mm(
    machine: &Machine,
    model: AxisModel,
    settings: LqgSettings,
    change_mm: f64,
) -> Vec<f64> {
    let servo_s = machine.period.servo_s;
    let mut plant = Plant::<1>::new(machine, [0.0]);
    let mut controller = LqgIdentified::<1>::new([model], settings);
    let mut tick = Tick::new(servo_s, controller.schedule(), Bounds::new(1e3, 1e6, 1e9));
    let mut tool_mm = [0.0];
    let [changed_at, observed] = [CHANGED_S, OBSERVED_S].map(|s| (s / servo_s).round() as usize);
    let mut sent_mm = Vec::with_capacity(observed);
    for n in 0..changed_at + observed {
        let [decided_mm] = tick.step(&mut Line, &mut controller, tool_mm).command_mm;
        let command_mm = decided_mm + if n == changed_at { change_mm } else { 0.0 };
        if n >= changed_at {
            sent_mm.push(command_mm);
        }
        tool_mm = plant.step([command_mm]).measured_mm;
    }
    sent_mm
}

/// Returns a machine with this axis alone, without what answers a small change by a step.
fn of_axis(machine: &Machine, axis: usize) -> Machine {
    let mut of_axis = *machine.axis(axis);
    (of_axis.encoder_step_um, of_axis.jitter_s) = (0.0, 0.0);
    if let Some(screw) = &mut of_axis.transmission {
        screw.backlash_um = 0.0;
    }
    Machine {
        axes: vec![of_axis; 2],
        geometry: Squareness::default(),
        ..machine.clone()
    }
}
