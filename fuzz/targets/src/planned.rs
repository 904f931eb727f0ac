//! Plans of any program: phases that join, within velocity, acceleration and jerk of every axis,
//! and within the tolerance of the path.

use std::fmt::Write;

use feedwright_gcode::canon::{Canon, Corner, Shape};
use feedwright_plan::{AxisMotion, Constraints, Phase, Plan, Planned, Plc};
use feedwright_sim::{Machine, Stages, path_steps};

use crate::draw::Draw;
use crate::paths::{CHORD_MM, Chords};
use crate::programs;

/// Rounding errors of positions (mm), velocities (mm/s) and accelerations (mm/s2) where phases
/// join: each is an integral of jerks over times near 1e-7 s.
const JOIN: [f64; 3] = [1e-6, 1e-4, 1e-1];
/// Relative rounding error of a limit.
const ROUNDING: f64 = 1e-6;
/// Number of phases that are checked, and of intervals between the checked places of a phase.
const PHASES: usize = 600;
const PLACES: u32 = 2;
/// Path tolerances, um.
const TOLERANCES_UM: &[f64] = &[10.0, 1.0, 100.0, 5.0];

/// Returns lines and arcs with lengths from a nanometer to a meter.
fn part(draw: &mut Draw) -> String {
    let mut text = String::from(draw.pick(&[
        "G21 G90 G64 F3000\n",
        "G21 G91 G64 F6000\n",
        "G21 G90 G61 F1000\n",
        "G21 G91 G64 P0.02 F9000\n",
    ]));
    for _ in 0..=draw.below(24) {
        let reach = draw.pick(&[10.0, 1.0, 0.1, 0.01, 1e-3, 1e-5, 100.0, 400.0]);
        let [x, y, z] = std::array::from_fn(|_| (2.0 * draw.part() - 1.0) * reach);
        let _ = match draw.below(10) {
            0 => writeln!(text, "G2 X{x:.6} Y{y:.6} R{:.6}", reach * 3.0),
            1 => writeln!(text, "G3 X{x:.6} Y{y:.6} Z{z:.6} R{:.6}", reach * 1.8),
            2 => writeln!(text, "G0 X{x:.6} Y{y:.6} Z{z:.6}"),
            3 => writeln!(text, "G91 G2 I{x:.6} J{y:.6} P2"),
            4 => writeln!(text, "G91 G1 X{x:.6}\nX{:.6}", -x),
            5 => writeln!(text, "G91 G1 X{x:.6}\nY{:.6}", reach * 0.1),
            6 => writeln!(text, "G1 X{x:.6} F{:.4}", 60_000.0 * draw.part() + 0.01),
            7 => writeln!(text, "M3 S100\nG4 P0.1"),
            _ => writeln!(text, "G1 X{x:.6} Y{y:.6} Z{z:.6}"),
        };
    }
    text + "M2\n"
}

/// Plans a part, and checks its phases.
pub(crate) fn run(data: &[u8]) {
    let mut draw = Draw::new(data);
    let Ok(machine) = Machine::load(draw.pick(&["workshop", "router"]).as_ref()) else {
        return;
    };
    let tolerance_um = draw.pick(TOLERANCES_UM);
    let machine = machine.planned_by_axes(tolerance_um);
    let text = part(&mut draw);
    let steps = programs::read(text.as_bytes(), None);
    let (mut path, mut tolerance_mm) = (Chords::default(), 1e-3 * tolerance_um);
    for step in &steps {
        let Canon::Motion(motion) = step else {
            continue;
        };
        if matches!(motion.shape, Shape::Spline(_)) || motion.others.axes.is_some() {
            return;
        }
        if let Corner::Continuous {
            tolerance_mm: Some(stated_mm),
            ..
        } = motion.corner
        {
            tolerance_mm = tolerance_mm.max(stated_mm);
        }
        path.add(motion);
    }
    let constraints = Constraints::from(&machine);
    let stages = Stages::of(&machine);
    let Ok(plan) = Plan::new(
        path_steps(steps),
        &constraints,
        stages.planner,
        Plc::default(),
    ) else {
        return;
    };
    let mut last: Option<AxisMotion> = None;
    for planned in plan.take(PHASES) {
        let Planned::Phase(phase) = planned else {
            continue;
        };
        assert!(
            phase.duration_s >= 0.0 && phase.duration_s.is_finite(),
            "{phase:?}\n{text}"
        );
        let Some(motion) = phase.motion else {
            last = None;
            continue;
        };
        if let Some(before) = last {
            joins(&before, &motion, &text);
        }
        check(&phase, &motion, &constraints, &text);
        for place in 0..=PLACES {
            let at = motion.after(phase.duration_s * f64::from(place) / f64::from(PLACES));
            let off_mm = path.distance(at.position_mm);
            assert!(
                off_mm <= tolerance_mm * (1.0 + 1e-3) + CHORD_MM,
                "{off_mm} mm off at {at:?}\n{text}"
            );
        }
        last = Some(motion.after(phase.duration_s));
    }
}

fn joins(before: &AxisMotion, after: &AxisMotion, text: &str) {
    let pairs = [
        (before.position_mm, after.position_mm),
        (before.velocity_mm_s, after.velocity_mm_s),
        (before.accel_mm_s2, after.accel_mm_s2),
    ];
    for ((a, b), most) in pairs.into_iter().zip(JOIN) {
        let gap = (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f64::max);
        assert!(
            gap <= most,
            "a gap of {gap} between {before:?} and {after:?}\n{text}"
        );
    }
}

/// Checks the ends and the middle of a phase against the limits of the axes.
fn check(phase: &Phase, motion: &AxisMotion, constraints: &Constraints, text: &str) {
    for place in 0..=PLACES {
        let at = motion.after(phase.duration_s * f64::from(place) / f64::from(PLACES));
        for (k, axis) in constraints.axes.iter().enumerate() {
            let used = [
                at.velocity_mm_s[k].abs() / axis.velocity_mm_s,
                at.accel_mm_s2[k].abs() / axis.accel_mm_s2,
                at.jerk_mm_s3[k].abs() / axis.jerk_mm_s3,
            ];
            assert!(
                used.iter().all(|share| *share <= 1.0 + ROUNDING),
                "axis {k} uses {used:?} in {phase:?}\n{text}"
            );
        }
    }
}
