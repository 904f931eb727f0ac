//! The servo thread with any accepted model, a plant that behaves in any way, and pins with any
//! number.

use feedwright_servo::compensation::{Compensation, MachinePlace};
use feedwright_servo::limits::LinkLimits;
use feedwright_servo::machine::model_of;
use feedwright_servo::plant::SimulatedMachine;
use feedwright_servo::servo::{Link, LinkFault, LinkInputs, LinkOutputs, Servo};
use feedwright_servo::through::Through;

use crate::blocks;
use crate::draw::Draw;

/// Servo periods of rest at the start: a geometry takes effect, and then the link takes up its
/// delay.
const REST: usize = 400;
/// Servo periods after the rest: three times the longest delay, and the time within which the
/// supervisor judges.
const PERIODS: usize = 400;
/// Choice that selects a damaged block.
const DAMAGED: u8 = 3;
/// Servo periods with a rejected model: commands are passed on.
const REFUSED_PERIODS: usize = 40;
/// Largest permitted distance of the drive's command from the path of the commands, mm: the largest
/// deviation that can be set.
const DEVIATION_MM: f64 = 10.0;
/// Largest distance between the curve of the link and the chord of this check between two commands,
/// mm.
const ROUND_MM: f64 = 1e-3;
/// Relative rounding error of the sum of a position and a correction.
const ROUNDING: f64 = 1e-9;

/// Runs the link of a machine with `N` axes. Returns the number of servo periods with a correction.
pub(crate) fn run<const N: usize>(data: &[u8]) -> usize {
    let mut draw = Draw::new(data);
    let bytes = match draw.below(8) {
        0 => blocks::with_checksum(&mut Draw::new(data)),
        1 | 2 => blocks::contour::<N>(&mut draw),
        DAMAGED => blocks::damaged::<N>(&mut draw),
        _ => blocks::absurd::<N>(&mut draw),
    };
    blocks::read::<N>(&bytes);
    let (model, geometry) = match model_of::<N>(&bytes) {
        Ok(block) => (Ok(block.model), block.geometry),
        Err(refused) => (Err(refused), None),
    };
    let servo_s = model
        .as_ref()
        .map_or(blocks::SERVO_S, |model| model.servo_s);
    let mut compensation = Compensation::new(geometry);
    compensation.runs_at(servo_s);
    let first = if model.is_ok() {
        0
    } else {
        REST + PERIODS - REFUSED_PERIODS
    };
    let mut servo = Servo::new(model);
    if servo.runs_at(servo_s) != LinkFault::None {
        compensation.refuse();
    }
    let mut world = World {
        limits: LinkLimits::DEFAULT,
        place: MachinePlace {
            zero_mm: [0.0; N],
            is_known: true,
            is_wanted: true,
        },
        plant: SimulatedMachine::new(&blocks::known_axes(), 1),
        command_mm: [0.0; N],
        largest_mm: 0.0,
        path_mm: vec![],
        spoils_from: draw.pick(&[REST, 0, REST + PERIODS / 2, REST + PERIODS]),
    };
    let mut corrected = 0;
    for n in first..REST + PERIODS {
        let inputs = compensation.joints(
            &world.inputs(&mut draw, n, servo_s),
            &world.place,
            &world.limits,
        );
        world.receive(&inputs);
        let outputs = servo.step(&inputs, &world.limits);
        world.check(n, &outputs);
        let (tool_mm, _) = compensation.tool(
            outputs.feedback_mm,
            outputs.through,
            &inputs.through.carries,
        );
        assert!(
            tool_mm.iter().all(|mm| mm.is_finite()),
            "{n}: feedback {tool_mm:?}"
        );
        world.plant.step(outputs.drive_mm, inputs.powered, 1.0);
        corrected += usize::from(outputs.correction_mm != [0.0; N]);
    }
    corrected
}

/// Returns inputs of [`crate::tick`] that run the blocks of [`blocks::damaged`]: each byte of each
/// kind changed in each way, and each end.
pub(crate) fn damaged_blocks<const N: usize>() -> impl Iterator<Item = [u8; 6]> {
    [0, 1].into_iter().flat_map(|kind| {
        let valid = blocks::valid::<N>(kind == 1);
        assert!(
            model_of::<N>(&valid).is_ok(),
            "the block that is damaged is valid"
        );
        let places = 0..(valid.len() - blocks::CHECKSUM_BYTES) as u16;
        places.flat_map(move |at| {
            let [low, high] = at.to_le_bytes();
            (0..=u8::MAX).map(move |change| [N as u8, DAMAGED, kind, low, high, change])
        })
    })
}

/// Machine, pins and commands around the link.
struct World<const N: usize> {
    limits: LinkLimits,
    place: MachinePlace<N>,
    /// Machine of the blocks of [`blocks::valid`].
    plant: SimulatedMachine<N>,
    command_mm: [f64; N],
    /// Servo period from which the bytes spoil the inputs of the link.
    spoils_from: usize,
    /// Largest coordinate of a valid command or actual position, mm.
    largest_mm: f64,
    /// Valid commands, mm: the path.
    path_mm: Vec<[f64; N]>,
}

impl<const N: usize> World<N> {
    fn inputs(&mut self, draw: &mut Draw, n: usize, servo_s: f64) -> LinkInputs<N> {
        let spoils = n >= self.spoils_from && !draw.is_empty() && draw.below(4) == 0;
        // The command accelerates from rest to 50 mm/s on a circle.
        let moving = n.saturating_sub(REST) as f64;
        let angle = 5.0 * servo_s * moving * moving / (moving + 50.0);
        for (k, mm) in self.command_mm.iter_mut().enumerate() {
            *mm = 10.0 * ((angle + k as f64).sin() - (k as f64).sin());
        }
        let (mut command_mm, mut actual_mm) = (self.command_mm, self.plant.measured_mm());
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

    /// Records the inputs of the link.
    fn receive(&mut self, inputs: &LinkInputs<N>) {
        // A position whose distance overflows does not count.
        let is_heard = |mm: &[f64; N]| mm.iter().map(|mm| mm * mm).sum::<f64>().is_finite();
        self.path_mm
            .extend(Some(inputs.command_mm).filter(is_heard));
        for mm in [inputs.command_mm, inputs.actual_mm]
            .iter()
            .filter(|mm| is_heard(mm))
        {
            self.largest_mm = mm
                .iter()
                .fold(self.largest_mm, |largest, mm| largest.max(mm.abs()));
        }
    }

    /// Sets a pin to any value.
    fn set(&mut self, draw: &mut Draw) {
        let value = if draw.below(2) == 0 {
            draw.double()
        } else {
            draw.number(400.0).abs()
        };
        match draw.below(9) {
            0 => self.limits.delay_s = value,
            1 => self.limits.deviation_mm = value,
            2 => self.limits.speed_mm_s = value,
            3 => self.limits.correction_mm_s2 = value,
            4 => self.limits.engaged_mm_s2 = value,
            5 => self.limits.adaptive_scale = value,
            6 => self.place.zero_mm[0] = value,
            7 => self.place.is_wanted = !self.place.is_wanted,
            _ => self.limits.speed_alone = !self.limits.speed_alone,
        }
    }

    /// Returns the distance of a position from the path, mm.
    fn off_the_path_mm(&self, place_mm: [f64; N]) -> f64 {
        let difference =
            |a: [f64; N], b: [f64; N]| -> [f64; N] { std::array::from_fn(|k| a[k] - b[k]) };
        let product = |a: [f64; N], b: [f64; N]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let to_chord = |from: [f64; N], to: [f64; N]| {
            let (chord, way) = (difference(to, from), difference(place_mm, from));
            let along = (product(chord, way) / product(chord, chord).max(f64::MIN_POSITIVE))
                .clamp(0.0, 1.0);
            let off: [f64; N] = std::array::from_fn(|k| way[k] - along * chord[k]);
            product(off, off).sqrt()
        };
        let ends = self
            .path_mm
            .iter()
            .zip(self.path_mm.iter().skip(1).chain(self.path_mm.last()));
        ends.map(|(from, to)| to_chord(*from, *to))
            .fold(f64::INFINITY, f64::min)
    }

    fn check(&self, n: usize, outputs: &LinkOutputs<N>) {
        let LinkOutputs {
            drive_mm,
            feedback_mm,
            correction_mm,
            rate,
            adaptive_feed,
            link,
            ..
        } = outputs;
        let numbers = drive_mm.iter().chain(feedback_mm).chain(correction_mm);
        assert!(
            numbers
                .chain([rate, adaptive_feed])
                .all(|number| number.is_finite()),
            "{n}: {outputs:?}"
        );
        let rounding_mm = ROUNDING * (1.0 + self.largest_mm);
        // A correction along the path may be longer. A drive without power gets its actual
        // position.
        let off_mm = if *link == Link::Off {
            0.0
        } else {
            self.off_the_path_mm(*drive_mm)
        };
        assert!(
            off_mm <= DEVIATION_MM + ROUND_MM + rounding_mm,
            "{n}: {off_mm} mm from the path: {outputs:?}"
        );
        let farthest = drive_mm
            .iter()
            .fold(0.0_f64, |farthest, mm| farthest.max(mm.abs()));
        assert!(
            farthest <= self.largest_mm + DEVIATION_MM + rounding_mm,
            "{n}: {farthest} mm: {outputs:?}"
        );
        assert!((0.0..=1.0).contains(adaptive_feed), "{n}: {adaptive_feed}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_kinds_of_models_correct_while_nothing_is_spoilt() {
        // The paper's controller has to pass its trial first.
        for (kind, least) in [(0, PERIODS / 2), (1, PERIODS / 4)] {
            // The damage is the last bit of the first weight, or of the mechanics period. Where the
            // bytes end, nothing more is spoilt.
            let [two, three] = [
                run::<2>(&[DAMAGED, kind, 40, 0, 1]),
                run::<3>(&[DAMAGED, kind, 40, 0, 1]),
            ];
            assert!(
                two > least && three > least,
                "{kind}: corrected in {two} and {three} periods"
            );
        }
    }
}
