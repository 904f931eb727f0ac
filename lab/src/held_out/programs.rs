//! Programs drawn at random, a few seconds of machining each, in families: typical parts, and
//! programs that were once cut badly.

use std::f64::consts::{PI, TAU};

use super::program_writer::ProgramWriter;
use super::random::Random;

/// A kind of program: name, and how a part of one is written.
type Family = (&'static str, fn(&mut ProgramWriter));

/// All of them.
const FAMILIES: [Family; 11] = [
    ("polyline", polyline),
    ("arcs", arcs),
    ("cam", cam),
    ("spikes", spikes),
    ("battlement", battlement),
    ("slots", slots),
    ("letters", letters),
    ("circles", circles),
    ("helix", helix),
    ("pocket", pocket),
    ("retraced", retraced),
];

/// Time of one part of a program, s.
const PART_S: [f64; 2] = [1.0, 4.0];
/// Most parts of a program.
const PARTS: u32 = 3;
/// Largest distance of the start of a part from the last part, mm.
const APART_MM: f64 = 20.0;

/// A program of a family.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RandomProgram {
    /// Family and seed.
    pub name: String,
    /// The program.
    pub text: String,
}

/// The program of a seed; the same on every platform.
pub fn program(seed: u64) -> RandomProgram {
    let mut random = Random::new(seed);
    let (family, write) = FAMILIES[random.whole(0, FAMILIES.len() as u32 - 1) as usize];
    let name = format!("{family}-{seed}");
    let mut writer = ProgramWriter::new(random, &name);
    for part in 0..writer.random.whole(1, PARTS) {
        if part > 0 {
            interruption(&mut writer);
        }
        let time_s = writer.random.between(PART_S);
        writer.begin_part(time_s);
        write(&mut writer);
    }
    let text = writer.finish();
    RandomProgram { name, text }
}

/// Writes the transition between two parts: a rapid, and perhaps a dwell, a tool change, another
/// feedrate, or a motion without a corner.
fn interruption(writer: &mut ProgramWriter) {
    match writer.random.whole(0, 7) {
        0 => writer.say("T1 M6"),
        1 | 2 => {
            let seconds = writer.random.by_ratio([0.01, 0.5]);
            writer.say(&format!("G4 P{seconds}"));
        }
        3 => return,
        _ => writer.feed(),
    }
    let [x, y, z] = writer.at_mm();
    let [dx, dy] = [0, 1].map(|_| writer.random.between([-APART_MM, APART_MM]));
    writer.rapid([x + dx, y + dy, z]);
}

/// Legs of 0.1 to 5 mm in any direction.
fn polyline(writer: &mut ProgramWriter) {
    let scale = writer.random.by_ratio([0.2, 1.0]);
    while writer.goes_on() {
        let leg_mm = writer.random.by_ratio([0.1, 5.0 * scale]);
        let heading = writer.random.between([-PI, PI]);
        writer.leg(leg_mm, heading);
    }
}

/// Arcs of 0.5 to 50 mm, most of them going on where the last one ended, some at a corner.
fn arcs(writer: &mut ProgramWriter) {
    let mut heading = writer.random.between([-PI, PI]);
    while writer.goes_on() {
        if writer.random.one_in(4) {
            heading += writer.random.between([-PI, PI]);
        }
        let radius_mm = writer.random.by_ratio([0.5, 50.0]);
        let side = writer.random.sign();
        // At least a tenth of a millimetre, or four decimals are no circle.
        let sweep = writer.random.by_ratio([0.2, 3.0]) * (3.0 / radius_mm).min(1.0);
        let to_center = heading + side * 0.5 * PI;
        let (x, y) = (libm::cos(to_center), libm::sin(to_center));
        writer.arc([radius_mm * x, radius_mm * y], side * sweep, 0.0);
        heading += side * sweep;
    }
}

/// A smooth curve as CAM writes it: short chords, with the noise of its tolerance.
fn cam(writer: &mut ProgramWriter) {
    let chord_mm = writer.random.by_ratio([0.02, 0.5]);
    let noise_mm = writer.random.by_ratio([0.0005, 0.02]);
    let waves = [0, 1, 2].map(|_| {
        let length_mm = writer.random.by_ratio([2.0, 40.0]);
        (length_mm, writer.random.between([-1.2, 1.2]))
    });
    let [mut x, mut y, z] = writer.at_mm();
    let mut s_mm = 0.0;
    while writer.goes_on() {
        s_mm += chord_mm * writer.random.between([0.7, 1.3]);
        let turn = |(length_mm, turn): &(f64, f64)| turn * libm::sin(TAU * s_mm / length_mm);
        let heading: f64 = waves.iter().map(turn).sum();
        x += chord_mm * libm::cos(heading);
        y += chord_mm * libm::sin(heading);
        let [dx, dy] = [0, 1].map(|_| writer.random.between([-noise_mm, noise_mm]));
        writer.line([x + dx, y + dy, z]);
    }
}

/// Writes spikes: lines there and almost back again.
fn spikes(writer: &mut ProgramWriter) {
    let mut heading = writer.random.between([-PI, PI]);
    let most_mm = writer.random.by_ratio([0.5, 8.0]);
    while writer.goes_on() {
        let leg_mm = writer.random.between([0.2 * most_mm, most_mm]);
        heading += PI - writer.random.sign() * writer.random.by_ratio([0.01, 0.5]);
        writer.leg(leg_mm, heading);
    }
}

/// Up, along, down, along: legs that are shorter than the lag.
fn battlement(writer: &mut ProgramWriter) {
    let [high_mm, long_mm] = [0, 1].map(|_| writer.random.by_ratio([0.1, 2.0]));
    let run_in_mm = writer.random.by_ratio([0.5, 10.0]);
    writer.by(run_in_mm, 0.0);
    while writer.goes_on() {
        writer.by(0.0, high_mm);
        writer.by(long_mm, 0.0);
        writer.by(0.0, -high_mm);
        writer.by(long_mm, 0.0);
    }
    writer.by(run_in_mm, 0.0);
}

/// Narrow slots with round ends, side by side.
fn slots(writer: &mut ProgramWriter) {
    let long_mm = writer.random.by_ratio([0.5, 10.0]);
    let wide_mm = writer.random.by_ratio([0.1, 2.0]);
    while writer.goes_on() {
        writer.by(long_mm, 0.0);
        writer.arc([0.0, 0.5 * wide_mm], PI, 0.0);
        writer.by(-long_mm, 0.0);
        writer.arc([0.0, 0.5 * wide_mm], -PI, 0.0);
    }
}

/// A stroke of a letter: where it begins, then straight to a place, or half round to it (left or
/// right).
type Stroke = ([f64; 2], &'static [([f64; 2], f64)]);

/// Letters in a box of 1 by 2: L, S, D, A, B, N.
#[rustfmt::skip]
const LETTERS: [&[Stroke]; 6] = [
    &[([0.0, 2.0], &[([0.0, 0.0], 0.0), ([1.0, 0.0], 0.0)])],
    &[([1.0, 2.0], &[([0.5, 2.0], 0.0), ([0.5, 1.0], 1.0), ([0.5, 0.0], -1.0), ([0.0, 0.0], 0.0)])],
    &[([0.0, 0.0], &[([0.0, 2.0], 0.0), ([0.0, 0.0], -1.0)])],
    &[([0.0, 0.0], &[([0.5, 2.0], 0.0), ([1.0, 0.0], 0.0)]), ([0.25, 1.0], &[([0.75, 1.0], 0.0)])],
    &[([0.0, 0.0], &[([0.0, 2.0], 0.0), ([0.0, 1.0], -1.0), ([0.0, 0.0], -1.0)])],
    &[([0.0, 0.0], &[([0.0, 2.0], 0.0), ([1.0, 0.0], 0.0), ([1.0, 2.0], 0.0)])],
];

/// A word, with rapids from stroke to stroke.
fn letters(writer: &mut ProgramWriter) {
    let size_mm = writer.random.by_ratio([0.3, 5.0]);
    let [mut left_mm, bottom_mm, z] = writer.at_mm();
    while writer.goes_on() {
        let letter = LETTERS[writer.random.whole(0, LETTERS.len() as u32 - 1) as usize];
        for (from, strokes) in letter {
            let place = |[x, y]: [f64; 2]| [left_mm + size_mm * x, bottom_mm + size_mm * y, z];
            writer.rapid(place(*from));
            for &(to, side) in *strokes {
                if side == 0.0 {
                    writer.line(place(to));
                } else {
                    let ([x, y, _], end) = (writer.at_mm(), place(to));
                    writer.arc([0.5 * (end[0] - x), 0.5 * (end[1] - y)], side * PI, 0.0);
                }
            }
        }
        left_mm += 1.6 * size_mm;
    }
}

/// A small circle, several times round.
fn circles(writer: &mut ProgramWriter) {
    let radius_mm = writer.random.by_ratio([0.3, 6.0]);
    let sweep = writer.random.sign() * TAU;
    for _ in 0..writer.random.whole(1, 5) {
        writer.arc([-radius_mm, 0.0], sweep, 0.0);
        if !writer.goes_on() {
            return;
        }
    }
}

/// Down in turns.
fn helix(writer: &mut ProgramWriter) {
    let radius_mm = writer.random.by_ratio([0.5, 10.0]);
    let pitch_mm = writer.random.by_ratio([0.05, 2.0]);
    let sweep = writer.random.sign() * TAU;
    while writer.goes_on() {
        writer.arc([-radius_mm, 0.0], sweep, -pitch_mm);
    }
    let [x, y, _] = writer.at_mm();
    writer.rapid([x, y, 1.0]);
}

/// Rectangles from within outwards, layer by layer.
fn pocket(writer: &mut ProgramWriter) {
    let over_mm = writer.random.by_ratio([0.1, 2.0]);
    let deep_mm = writer.random.by_ratio([0.05, 1.0]);
    let rings = writer.random.whole(2, 6);
    let [x, y, _] = writer.at_mm();
    while writer.goes_on() {
        let [_, _, z] = writer.at_mm();
        writer.line([x, y, z - deep_mm]);
        for ring in 1..=rings {
            let side_mm = 2.0 * over_mm * f64::from(ring);
            writer.by(-over_mm, -over_mm);
            writer.by(side_mm, 0.0);
            writer.by(0.0, side_mm);
            writer.by(-side_mm, 0.0);
            writer.by(0.0, -side_mm);
        }
        let [from_x, from_y, z] = writer.at_mm();
        writer.rapid([from_x, from_y, z + 1.0]);
        writer.rapid([x, y, z + 1.0]);
        writer.rapid([x, y, z]);
    }
}

/// The same way there and back.
fn retraced(writer: &mut ProgramWriter) {
    while writer.goes_on() {
        let mut passed = vec![writer.at_mm()];
        for _ in 0..writer.random.whole(1, 6) {
            let leg_mm = writer.random.by_ratio([0.1, 5.0]);
            let heading = writer.random.between([-PI, PI]);
            writer.leg(leg_mm, heading);
            passed.push(writer.at_mm());
        }
        for &place in passed.iter().rev().skip(1) {
            writer.line(place);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use feedwright_gcode::{Reader, Settings, Summary, summarize};

    /// Seeds that are looked at.
    const SEEDS: u64 = 400;

    fn read(drawn: &RandomProgram) -> Summary {
        let text = drawn.text.as_str();
        let reader = Reader::from_text(&drawn.name, text, Settings::default());
        summarize(reader.expect("a program"))
            .unwrap_or_else(|error| panic!("{}\n{error:?}", drawn.text))
    }

    #[test]
    fn programs_of_all_families_are_read_without_a_mistake() {
        let mut seen = [0; FAMILIES.len()];
        for seed in 0..SEEDS {
            let drawn = program(seed);
            let summary = read(&drawn);
            let is_of = |family: &Family| drawn.name.starts_with(family.0);
            let family = FAMILIES.iter().position(is_of).expect("a family");
            seen[family] += 1;
            let text = &drawn.text;
            assert!(summary.motions >= 1 && summary.feed_mm > 0.0, "{text}");
            let is_deep = ["helix", "pocket"].contains(&FAMILIES[family].0);
            assert_eq!(summary.moves[2], is_deep, "{text}");
        }
        assert!(seen.iter().all(|&count| count > 5), "{seen:?}");
    }

    #[test]
    fn the_same_seed_draws_the_same_program_and_another_another() {
        assert_eq!(program(7), program(7));
        assert_ne!(program(7).text, program(8).text);
    }

    /// Checks that programs are short, so that thousands of them can be cut.
    #[test]
    fn programs_are_short() {
        let lines = |seed| program(seed).text.lines().count();
        let lines: usize = (0..SEEDS).map(lines).sum();
        assert!(lines < 300 * SEEDS as usize, "{lines} lines");
    }
}
