//! Whether a text says what it is meant to say: it is read again and compared, step by step.

use std::f64::consts::PI;
use std::sync::Arc;

use feedwright_gcode::canon::{Canon, EventKind, Motion, MotionKind, Shape};
use feedwright_gcode::{Dialect, ModesInForce, Reader, Settings};
use feedwright_plan::vector::distance;

use super::stretches::length_mm;

/// Feedrates may differ by this part: their printed digits.
const FEED_PART: f64 = 1e-3;
/// Dwells may differ by this, s.
const DWELL_S: f64 = 1e-3;
/// The center of an arc may be off by this many printed steps plus [`CENTER_PART`] of the radius.
/// The reader moves it so that the arc meets both of its ends.
const CENTER_STEPS: f64 = 100.0;
const CENTER_PART: f64 = 1e-3;

/// The steps of a text, and the modes behind each; none where it has a mistake. Steps with the same modes share them.
pub(super) fn read(text: &str, settings: &Settings, dialect: Dialect) -> Option<(Vec<Canon>, Vec<Arc<ModesInForce>>)> {
    let settings = Settings { dialect: Some(dialect), ..settings.clone() };
    let mut reader = Reader::from_text("corrected.ngc", text, settings).ok()?;
    let (mut steps, mut modes) = (Vec::new(), Vec::<Arc<ModesInForce>>::new());
    while let Some(step) = reader.next() {
        steps.push(step.ok()?);
        let now = reader.modes();
        let last = modes.last().filter(|last| ***last == now);
        modes.push(last.map_or_else(|| Arc::new(now), Arc::clone));
    }
    Some((steps, modes))
}

/// Whether the motions of two programs have the same frames, one behind the other, up to their printed steps, mm: a coordinate system with other
/// offsets on the control than here is no place in the machine.
pub(super) fn same_frames<'a>(
    found: impl Iterator<Item = (&'a Canon, &'a ModesInForce)>,
    wanted: impl Iterator<Item = (&'a Canon, &'a ModesInForce)>,
    step_mm: f64,
) -> bool {
    let (found, wanted) = (frames(found, step_mm), frames(wanted, step_mm));
    found.len() == wanted.len() && found.iter().zip(&wanted).all(|(found, wanted)| found.near_frame(wanted, step_mm))
}

fn frames<'a>(steps: impl Iterator<Item = (&'a Canon, &'a ModesInForce)>, step_mm: f64) -> Vec<&'a ModesInForce> {
    let mut frames: Vec<&ModesInForce> = Vec::new();
    for (_, modes) in steps.filter(|(step, _)| matches!(step, Canon::Motion(_))) {
        if frames.last().is_none_or(|last| !last.near_frame(modes, step_mm)) {
            frames.push(modes);
        }
    }
    frames
}

/// Whether two programs ask for the same, up to their printed steps, mm; events between two motions may have another order.
pub(super) fn same(found: &[Canon], wanted: &[Canon], step_mm: f64) -> bool {
    let (found, wanted) = (legs(found, step_mm), legs(wanted, step_mm));
    found.len() == wanted.len() && found.iter().zip(&wanted).all(|(found, wanted)| same_leg(found, wanted, step_mm))
}

/// A motion, none behind the last, and the events before it in an order of their own.
type Leg<'a> = (Vec<&'a EventKind>, Option<&'a Motion>);

fn legs(program: &[Canon], step_mm: f64) -> Vec<Leg<'_>> {
    let mut legs: Vec<Leg<'_>> = vec![(Vec::new(), None)];
    for step in program {
        match step {
            Canon::Motion(motion) if is_nothing(motion, step_mm) => {}
            Canon::Motion(motion) => {
                if let Some(leg) = legs.last_mut() {
                    leg.1 = Some(motion);
                }
                legs.push((Vec::new(), None));
            }
            Canon::Event(event) => match &event.kind {
                EventKind::ProgramEnd | EventKind::MCode { code: 2 | 30, .. } => {}
                kind => legs.last_mut().into_iter().for_each(|leg| leg.0.push(kind)),
            },
        }
    }
    for leg in &mut legs {
        leg.0.sort_by_key(|kind| format!("{kind:?}"));
    }
    legs
}

fn same_leg(found: &Leg<'_>, wanted: &Leg<'_>, step_mm: f64) -> bool {
    let events = found.0.len() == wanted.0.len()
        && found.0.iter().zip(&wanted.0).all(|(found, wanted)| same_event(found, wanted));
    events
        && match (found.1, wanted.1) {
            (None, None) => true,
            (Some(found), Some(wanted)) => same_motion(found, wanted, step_mm),
            _ => false,
        }
}

fn is_nothing(motion: &Motion, step_mm: f64) -> bool {
    matches!(motion.shape, Shape::Line) && motion.others.is_none() && distance(motion.start_mm, motion.end_mm) < step_mm
}

fn same_event(found: &EventKind, wanted: &EventKind) -> bool {
    match (found, wanted) {
        (EventKind::Dwell { seconds: a }, EventKind::Dwell { seconds: b }) => (a - b).abs() < DWELL_S,
        (EventKind::Message { text: a }, EventKind::Message { text: b }) => a.trim() == b.trim(),
        (a, b) => a == b,
    }
}

fn same_motion(found: &Motion, wanted: &Motion, step_mm: f64) -> bool {
    found.kind == wanted.kind
        && (found.corner == wanted.corner || found.kind == MotionKind::Rapid)
        && found.others == wanted.others
        && distance(found.end_mm, wanted.end_mm) < 2.0 * step_mm
        && (found.feed_mm_s - wanted.feed_mm_s).abs() <= FEED_PART * wanted.feed_mm_s + 1e-6
        && same_shape(found, wanted, step_mm)
}

fn same_shape(found: &Motion, wanted: &Motion, step_mm: f64) -> bool {
    match (&found.shape, &wanted.shape) {
        (Shape::Line, Shape::Line) => true,
        (
            Shape::Arc { plane, center_mm, turns },
            Shape::Arc { plane: wanted_plane, center_mm: wanted_mm, turns: wanted_turns },
        ) => {
            let radius_mm = distance(*wanted_mm, wanted.start_mm);
            plane == wanted_plane
                && turns == wanted_turns
                && distance(*center_mm, *wanted_mm) < CENTER_STEPS * step_mm + CENTER_PART * radius_mm
                // The ends of a short arc can change places by rounding: then it is a full turn.
                && (length_mm(found) - length_mm(wanted)).abs() < PI * radius_mm
        }
        (Shape::Spline(found), Shape::Spline(wanted)) => found == wanted,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_MM: f64 = 0.001;
    const PROGRAM: &str = "G21 G90 G17 G64 F600\nM3 S500\nG0 X5 Y5\nG1 X10\nG4 P0.5\nG2 X20 Y5 I5 J0\n(MSG, look)\n\
                           G5 X30 Y5 I2 J3 P-2 Q3\nM8\nM64 P1\nG1 Z-1\nG1 A10\nM2\n";

    fn read_again(text: &str) -> (Vec<Canon>, Vec<Arc<ModesInForce>>) {
        read(text, &Settings::default(), Dialect::LinuxCnc).unwrap_or_else(|| panic!("{text}"))
    }

    /// Whether the program says the same with something in place of a part of it.
    fn is_same(part: &str, other: &str) -> bool {
        assert!(PROGRAM.contains(part), "{part}");
        let [wanted, found] = [PROGRAM.to_owned(), PROGRAM.replacen(part, other, 1)].map(|text| read_again(&text).0);
        let is_same = same(&found, &wanted, STEP_MM);
        assert_eq!(is_same, same(&wanted, &found, STEP_MM), "{part:?} and {other:?}");
        is_same
    }

    #[test]
    fn what_digits_and_the_order_of_events_change_is_the_same() {
        for (part, other) in [
            ("X10\n", "X10.0015\n"),
            ("F600", "F600.3"),
            ("P0.5\n", "P0.5004\n"),
            ("M3 S500\n", "S500\nM3\n"),
            ("M8\nM64 P1\n", "M64 P1\nM8\n"),
            ("X10\n", "X10\nX10.0005\n"),
            ("(MSG, look)", "(MSG,look )"),
            ("M2\n", "M30\n"),
            ("G64 F600\nM3 S500\nG0 X5 Y5\n", "G61 F600\nM3 S500\nG0 X5 Y5\nG64\n"),
            ("I5 J0", "R5.001"),
        ] {
            assert!(is_same(part, other), "{part:?} and {other:?}");
        }
    }

    #[test]
    fn another_motion_or_event_is_not_the_same() {
        for (part, other) in [
            ("X10\n", "X10.0025\n"),
            ("F600", "F601"),
            ("P0.5\n", "P0.502\n"),
            ("P0.5\n", "P0.498\n"),
            ("M3 S500\n", "M4 S500\n"),
            ("M8\n", ""),
            ("M8\nM64 P1\nG1 Z-1\n", "G1 Z-1\nM8\nM64 P1\n"),
            ("M64 P1", "M64 P2"),
            ("look", "look out"),
            ("G0 X5", "G1 X5"),
            ("G64", "G61"),
            ("G1 A10\n", ""),
            ("G1 A10\n", "G1 A10\nA20\n"),
            ("A10", "A11"),
            ("Z-1", "Z-2"),
            ("G2 X20 Y5 I5 J0", "G3 X20 Y5 I5 J0"),
            ("G2 X20 Y5 I5 J0", "G2 X20 Y5 I5 J0 P2"),
            ("G2 X20 Y5 I5 J0", "G1 X20 Y5"),
            ("G2 X20 Y5 I5 J0", "G18 G2 X20 Z0 I5 K0\nG17"),
            ("I5 J0", "R5.1"),
            ("P-2 Q3", "P-2 Q4"),
        ] {
            assert!(!is_same(part, other), "{part:?} and {other:?}");
        }
        assert!(is_same(PROGRAM, PROGRAM));
    }

    #[test]
    fn frames_are_the_same_in_their_order_up_to_printed_steps() {
        let are_same = |found: &str, wanted: &str| {
            let [found, wanted] = [found, wanted].map(|text| read_again(&format!("G21 G90 F600\n{text}M2\n")));
            let steps = |(steps, modes): &'static (Vec<Canon>, Vec<Arc<ModesInForce>>)| {
                steps.iter().zip(modes.iter().map(|modes| &**modes))
            };
            let [found, wanted] = [found, wanted].map(|read| steps(Box::leak(Box::new(read))));
            same_frames(found, wanted, STEP_MM)
        };
        let two = "G54 G1 X1\nG10 L2 P2 X5 Y2\nG55 X1\n";
        assert!(are_same(two, two));
        assert!(are_same("G54 G1 X1\nX2\nG10 L2 P2 X5.0004 Y2\nG55 X1\nX3\n", two));
        assert!(!are_same("G54 G1 X1\nG10 L2 P2 X5.01 Y2\nG55 X1\n", two));
        assert!(!are_same("G54 G1 X1\n", two) && !are_same(two, "G54 G1 X1\n"));
        assert!(!are_same("G10 L2 P2 X5 Y2\nG55 G1 X1\nG54 X1\n", two));
    }
}
