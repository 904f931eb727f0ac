//! The servo thread with any model that is accepted, a plant that does as it likes, and pins with any number on them.

use feedwright_servo::limits::LinkLimits;
use feedwright_servo::machine::model_of;
use feedwright_servo::servo::{LinkInputs, LinkOutputs, Servo};
use feedwright_servo::through::Through;

use crate::blocks;
use crate::draw::Draw;

/// Servo periods of a run: three times the longest delay, and the time in which the supervisor judges.
const PERIODS: usize = 400;
/// Farthest that a correction may be from the path, mm: the largest deviation that can be set.
const DEVIATION_MM: f64 = 10.0;
/// Relative rounding of a sum of a position and a correction.
const ROUNDING: f64 = 1e-9;

/// Runs the link of a machine with `N` axes.
pub(crate) fn run<const N: usize>(data: &[u8]) {
    let mut draw = Draw::new(data);
    let bytes = match draw.below(8) {
        0 => blocks::with_checksum(&mut Draw::new(data)),
        1 | 2 => blocks::contour::<N>(&mut draw),
        _ => blocks::absurd::<N>(&mut draw),
    };
    let model = model_of::<N>(&bytes);
    let servo_s = model.as_ref().map_or(blocks::SERVO_S, |model| model.servo_s());
    let mut servo = Servo::new(model);
    let _ = servo.runs_at(servo_s);
    let mut world = World { limits: LinkLimits::DEFAULT, drive_mm: [0.0; N], command_mm: [0.0; N], largest_mm: 0.0 };
    for n in 0..PERIODS {
        let inputs = world.inputs(&mut draw, n, servo_s);
        let outputs = servo.step(&inputs, &world.limits);
        world.check(n, &outputs);
        world.drive_mm = outputs.drive_mm;
    }
}

/// What is around the link.
struct World<const N: usize> {
    limits: LinkLimits,
    drive_mm: [f64; N],
    command_mm: [f64; N],
    /// Largest coordinate of a command or an actual position that was heard, mm.
    largest_mm: f64,
}

impl<const N: usize> World<N> {
    fn inputs(&mut self, draw: &mut Draw, n: usize, servo_s: f64) -> LinkInputs<N> {
        let spoils = !draw.is_empty() && draw.below(4) == 0;
        let angle = n as f64 * servo_s * 5.0;
        for (k, mm) in self.command_mm.iter_mut().enumerate() {
            *mm = 10.0 * (angle + k as f64).sin();
        }
        let (mut command_mm, mut actual_mm) = (self.command_mm, self.drive_mm);
        let mut flags = 0b1_0011;
        if spoils {
            let axis = usize::from(draw.below(N as u8));
            match draw.below(8) {
                0 => command_mm[axis] = draw.double(),
                1 => actual_mm[axis] = draw.double(),
                2 => actual_mm = actual_mm.map(|mm| -3.0 * mm),
                3 => actual_mm[axis] += draw.number(1.0),
                4 => command_mm[axis] += draw.number(5.0),
                5 => flags = draw.byte(),
                _ => self.set(draw),
            }
        }
        for mm in [command_mm, actual_mm] {
            // A place whose distance overflows is not heard.
            if mm.iter().map(|mm| mm * mm).sum::<f64>().is_finite() {
                self.largest_mm = mm.iter().fold(self.largest_mm, |largest, mm| largest.max(mm.abs()));
            }
        }
        let is = |bit: u8| flags & (1 << bit) != 0;
        LinkInputs {
            command_mm,
            actual_mm,
            through: Through::NONE,
            powered: is(0),
            enabled: is(1),
            direct: is(2),
            probing: is(3),
            spindle: is(5),
            cutting: is(4),
        }
    }

    /// Sets a pin to anything.
    fn set(&mut self, draw: &mut Draw) {
        let value = if draw.below(2) == 0 { draw.double() } else { draw.number(400.0).abs() };
        match draw.below(7) {
            0 => self.limits.delay_s = value,
            1 => self.limits.deviation_mm = value,
            2 => self.limits.speed_mm_s = value,
            3 => self.limits.correction_mm_s2 = value,
            4 => self.limits.engaged_mm_s2 = value,
            5 => self.limits.adaptive_scale = value,
            _ => self.limits.speed_alone = !self.limits.speed_alone,
        }
    }

    fn check(&self, n: usize, outputs: &LinkOutputs<N>) {
        let LinkOutputs { drive_mm, feedback_mm, correction_mm, rate, adaptive_feed, .. } = outputs;
        let numbers = drive_mm.iter().chain(feedback_mm).chain(correction_mm);
        assert!(numbers.chain([rate, adaptive_feed]).all(|number| number.is_finite()), "{n}: {outputs:?}");
        let correction = correction_mm.iter().map(|mm| mm * mm).sum::<f64>().sqrt();
        let rounding_mm = ROUNDING * (1.0 + self.largest_mm);
        assert!(correction <= DEVIATION_MM + rounding_mm, "{n}: a correction of {correction} mm: {outputs:?}");
        let farthest = drive_mm.iter().fold(0.0_f64, |farthest, mm| farthest.max(mm.abs()));
        assert!(farthest <= self.largest_mm + DEVIATION_MM + rounding_mm, "{n}: {farthest} mm: {outputs:?}");
        assert!((0.0..=1.0).contains(adaptive_feed), "{n}: {adaptive_feed}");
    }
}
