//! A corrected program, read again: it has the motions that were checked, ends where the original
//! ends, and stays as near to it as the machine allows.

use feedwright::{CorrectJob, TARGETS, deterministic};
use feedwright_gcode::Program;
use feedwright_gcode::canon::{Canon, Shape};
use feedwright_sim::{Machine, Period};

use crate::draw::Draw;
use crate::paths::{Chords, distance};
use crate::programs;

/// Largest number of motions of a program: each cut simulates all of them several times.
const MOTIONS: u8 = 5;
/// Half the size of a part, mm: some hundred servo periods.
const REACH_MM: f64 = 2.0;
/// Smallest radius of an arc, mm: any two points of the part are on such an arc.
const RADIUS_MM: f64 = 3.0;
/// Servo and mechanics periods, s: a fifth of the work of a usual machine.
const PERIODS_S: [f64; 2] = [0.005, 0.001];

/// Returns a machine whose loops follow within a few servo periods, and whose cuts are all the
/// same.
fn machine() -> Option<Machine> {
    let mut machine = deterministic(&Machine::load("tnv40".as_ref()).ok()?);
    let [servo_s, mechanics_s] = PERIODS_S;
    machine.period = Period {
        servo_s,
        mechanics_s,
        mechanics_per_servo: 5,
    };
    Some(machine)
}

/// Returns a small part: lines and arcs of some millimeters, at feedrates that are difficult for a
/// machine.
fn part(draw: &mut Draw) -> String {
    let (start, mm) = draw.pick(&[
        ("G21 G90 G64 F2000\n", 1.0),
        ("G21 G91 G64 F3000\n", 1.0),
        ("G20 G90 F100\n", 25.4),
        ("G21 G90 G61 F1500\n", 1.0),
    ]);
    let mut text = String::from(start);
    text.push_str(draw.pick(&["", "", "#1=0.3\n", "G54\n", "G92 X1 Y2\n", "G10 L2 P1 X3\n"]));
    let opened = draw.below(4) == 0;
    if opened {
        text.push_str("o100 repeat [2]\n");
    }
    for _ in 0..=draw.below(MOTIONS) {
        let [x, y, r] = std::array::from_fn(|_| (draw.part() * 2.0 - 1.0) * REACH_MM / mm);
        let radius = r.abs() + RADIUS_MM / mm;
        text += &match draw.below(6) {
            0 => format!("G2 X{x:.3} Y{y:.3} R{radius:.3}\n"),
            1 => format!("G3 I{r:.3} J{x:.3}\n"),
            2 => format!("G0 X{x:.3} Y{y:.3}\n"),
            3 => format!("G1 X[{x:.3}+#1] (a comment)\n"),
            4 => format!("G1 Y{y:.3} F{:.1}\n", (500.0 + 1000.0 * draw.part()) / mm),
            _ => format!("N{} G1 X{x:.3} Y{y:.3}\n", draw.byte()),
        };
    }
    if opened {
        text.push_str("o100 endrepeat\n");
    }
    text + "M2\n"
}

/// Returns the points of all motions, mm; `None` if a motion is a spline.
fn chords(steps: &[Canon]) -> Option<Chords> {
    let mut chords = Chords::default();
    for step in steps {
        if let Canon::Motion(motion) = step {
            if matches!(motion.shape, Shape::Spline(_)) {
                return None;
            }
            chords.add(motion);
        }
    }
    Some(chords)
}

/// Corrects a part for a control, and checks the corrected program.
pub(crate) fn run(data: &[u8]) {
    let mut draw = Draw::new(data);
    let target = &TARGETS[usize::from(draw.byte()) % TARGETS.len()];
    let text = part(&mut draw);
    let original = programs::read(text.as_bytes(), None);
    let Some(machine) = machine() else { return };
    let (Some(wanted), false) = (chords(&original), original.is_empty()) else {
        return;
    };
    let largest_mm = machine.limits.max_deviation_mm;
    let job = CorrectJob::new(
        Program::from_text("part.ngc", text.clone()),
        machine,
        target,
    );
    let Ok(outcome) = job.run(&()) else { return };
    let Some(corrected) = outcome.program() else {
        return;
    };
    let again = programs::read(corrected.as_bytes(), None);
    assert!(
        !again.is_empty(),
        "the corrected program has mistakes:\n{text}\n{corrected}"
    );
    let Some(written) = chords(&again) else {
        return;
    };
    let step_mm = 10.0_f64.powi(1 - target.decimals as i32);
    if let (Some(end), Some(wanted_end)) = (written.points.last(), wanted.points.last()) {
        assert!(
            distance(*end, *wanted_end) <= 2.0 * step_mm,
            "ends at {end:?} in place of {wanted_end:?}:\n{text}\n{corrected}"
        );
    }
    for point in &written.points {
        let off_mm = wanted.distance(*point);
        assert!(
            off_mm <= largest_mm + step_mm,
            "{off_mm} mm off at {point:?}:\n{text}\n{corrected}"
        );
    }
}
