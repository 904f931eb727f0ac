use feedwright_gcode::canon::{AuxiliaryAxes, Canon, Corner, Motion, MotionKind, Plane, Shape};

use super::*;

const SERVO_S: f64 = 1e-3;

fn machine() -> Machine {
    Machine::load("tnv40".as_ref()).unwrap()
}

fn motion(start_mm: Vector, end_mm: Vector, shape: Shape) -> Canon {
    let (kind, corner) = (
        MotionKind::Feed,
        Corner::Continuous {
            tolerance_mm: None,
            merge_mm: None,
        },
    );
    Canon::Motion(Motion {
        line: 1,
        kind,
        start_mm,
        end_mm,
        shape,
        feed_mm_s: 50.0,
        corner,
        others: AuxiliaryAxes::default(),
    })
}

fn lines(corners_mm: &[Vector]) -> Vec<Canon> {
    corners_mm
        .windows(2)
        .map(|ends| motion(ends[0], ends[1], Shape::Line))
        .collect()
}

/// The feet of a tool that is where `tool` says, given the reference and the time at the end of a
/// servo period.
fn feet(program: Vec<Canon>, mut tool: impl FnMut(&mut Reference<'_>, f64) -> Vector) -> Vec<Foot> {
    let machine = machine();
    let mut reference = Reference::of_program(program, &machine).unwrap();
    let start_mm = reference.at(0.0).position_mm;
    let end_s = reference.read_to_end_s();
    let mut progress = FootTracker::new(&machine, start_mm);
    let periods = ((end_s + 0.2) / SERVO_S) as u32;
    let at = |n: u32| {
        let tau_s = f64::from(n) * SERVO_S;
        let s_mm = reference.at(tau_s).s_mm;
        let tool_mm = tool(&mut reference, tau_s + SERVO_S);
        progress.foot(&mut reference, tau_s, s_mm, tool_mm)
    };
    (0..periods).map(at).collect()
}

fn largest(feet: &[Foot]) -> f64 {
    feet.iter()
        .fold(0.0, |largest, foot| foot.distance_mm.max(largest))
}

fn goes_on(feet: &[Foot]) {
    let mut furthest_mm: f64 = 0.0;
    for foot in feet {
        assert!(
            foot.s_mm >= furthest_mm - BACK_MM - 1e-12,
            "{} behind {furthest_mm}",
            foot.s_mm
        );
        furthest_mm = furthest_mm.max(foot.s_mm);
    }
}

fn battlement() -> Vec<Vector> {
    let teeth = (0..6).map(f64::from);
    let tooth = |x: f64| {
        [
            [x, 0.0, 0.0],
            [x, 0.5, 0.0],
            [x + 0.5, 0.5, 0.0],
            [x + 0.5, 0.0, 0.0],
        ]
    };
    teeth.flat_map(tooth).collect()
}

/// The position of a loop of first order behind the reference.
fn following() -> impl FnMut(&mut Reference<'_>, f64) -> Vector {
    let mut tool_mm = [0.0; 3];
    move |reference, t_s| {
        let to_mm = sub(reference.at(t_s).position_mm, tool_mm);
        for k in 0..3 {
            tool_mm[k] += (1.0 - libm::exp(-50.0 * SERVO_S)) * to_mm[k];
        }
        tool_mm
    }
}

#[test]
fn a_tool_on_the_path_has_no_error_whatever_its_lag() {
    let spike = vec![
        [0.0, 0.0, 0.0],
        [5.0, 0.1, 0.0],
        [0.0, 0.2, 0.0],
        [0.0, 0.2, 5.0],
        [0.0, 0.2, 0.0],
    ];
    for corners in [battlement(), spike] {
        for lag_s in [-2e-3, 0.0, 5e-3, 0.02, 0.06] {
            let feet = feet(lines(&corners), |reference, t_s| {
                reference.at(t_s - lag_s).position_mm
            });
            goes_on(&feet);
            // Of a servo period in which the tool turns at a tip, only both ends are known.
            assert!(largest(&feet) < 1e-4, "lag {lag_s}: {}", largest(&feet));
        }
    }
}

#[test]
fn a_tool_that_stays_on_a_leg_that_it_has_passed_is_seen() {
    // On the third leg, downwards, at half its height; the leg before it is no nearer than 0.25 mm.
    let stays = |reference: &mut Reference<'_>, t_s: f64| {
        let tau_s = if (0.5..0.9).contains(&t_s) {
            0.5
        } else {
            t_s - 0.02
        };
        reference.at(tau_s).position_mm
    };
    let feet = feet(lines(&battlement()), stays);
    goes_on(&feet);
    assert!(largest(&feet) > 0.2, "{}", largest(&feet));
}

#[test]
fn a_tool_that_slides_back_is_seen_within_hundredths_of_a_millimetre() {
    let corners = [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, 10.0, 0.0]];
    let back = |reference: &mut Reference<'_>, t_s: f64| {
        let mut at_mm = reference.at(t_s.min(0.4)).position_mm;
        at_mm[0] -= 0.1 * (t_s - 0.4).clamp(0.0, 1.0);
        at_mm
    };
    let feet = feet(lines(&corners), back);
    let at = |t_s: f64| feet[(t_s / SERVO_S) as usize].distance_mm;
    assert!(at(0.41) < 1e-9 && at(0.49) < 1e-9);
    assert!(at(0.6) > 1.0, "{}", at(0.6));
}

#[test]
fn a_line_there_and_back_may_be_cut_short_at_its_tip_but_not_further() {
    let corners = [[0.0, 0.0, 0.0], [5.0, 0.0, 0.0], [0.0, 0.0, 0.0]];
    let feet = feet(lines(&corners), following());
    goes_on(&feet);
    assert!(largest(&feet) < BACK_MM, "{}", largest(&feet));
    assert!(feet[feet.len() - 1].s_mm > 9.99);
}

#[test]
fn right_angles_and_spikes_are_passed_where_the_legs_are_equally_near() {
    for degrees in [20.0_f64, 60.0, 90.0, 150.0] {
        let (sin, cos) = libm::sincos((0.5 * degrees).to_radians());
        let (before, behind) = ([-5.0 * cos, -5.0 * sin, 0.0], [-5.0 * cos, 5.0 * sin, 0.0]);
        let corners = [before, [0.0; 3], behind];
        let mut tool = following();
        let from = |reference: &mut Reference<'_>, t_s: f64| {
            // The loop starts where the path does.
            let at = tool(reference, t_s);
            let settled = libm::exp(-50.0 * t_s);
            [0, 1, 2].map(|k| at[k] + settled * before[k])
        };
        let mut at = Vec::new();
        let mut from = from;
        let feet = feet(lines(&corners), |reference, t_s| {
            at.push(from(reference, t_s));
            at[at.len() - 1]
        });
        goes_on(&feet);
        for (foot, tool_mm) in feet.iter().zip(&at) {
            let leg = |way: Vector| {
                let along = (dot(*tool_mm, way) / 5.0).clamp(0.0, 5.0) / 5.0;
                distance(*tool_mm, way.map(|x| along * x))
            };
            let nearest = leg(before).min(leg(behind));
            assert!(
                (foot.distance_mm - nearest).abs() < BACK_MM,
                "{degrees}: {} {nearest}",
                foot.distance_mm
            );
        }
    }
}

/// A tool that turns before the tip of a spike, where the spike after the next comes nearer than
/// the way back.
#[test]
fn of_spikes_side_by_side_the_next_but_one_is_not_reached() {
    let corners = [
        [0.0, 0.0, 0.0],
        [0.031, -0.0236, 0.0],
        [-0.0146, 0.0048, 0.0],
        [0.0365, -0.028, 0.0],
        [0.0, 0.0003, 0.0],
    ];
    let tip_mm = distance(corners[0], corners[1]);
    let short_mm = 0.0022;
    let feet = feet(lines(&corners), |reference, t_s| {
        let s_mm = reference.at(t_s - 0.02).s_mm;
        let before_tip = (tip_mm - short_mm..tip_mm + short_mm).contains(&s_mm);
        let [from_mm, to_mm] = [-short_mm, short_mm]
            .map(|way_mm| reference.at_length([0.0; 3], tip_mm + way_mm).position_mm);
        let part = (s_mm - tip_mm + short_mm) / (2.0 * short_mm);
        let straight = std::array::from_fn(|k| from_mm[k] + part * (to_mm[k] - from_mm[k]));
        if before_tip {
            straight
        } else {
            reference.at(t_s - 0.02).position_mm
        }
    });
    goes_on(&feet);
    assert!(largest(&feet) < 0.001, "{}", largest(&feet));
}

#[test]
fn vibration_along_the_path_does_not_carry_the_progress_on() {
    let mut at = Vec::new();
    let feet = feet(
        lines(&[[0.0, 0.0, 0.0], [20.0, 0.0, 0.0]]),
        |reference, t_s| {
            let x = reference.at(t_s - 0.03).position_mm[0];
            let tool_mm = [x + 4e-3 * libm::sin(900.0 * t_s), 1e-3, 0.0];
            at.push(tool_mm[0]);
            tool_mm
        },
    );
    for (foot, x) in feet.iter().zip(at) {
        assert!(
            (foot.s_mm - x.clamp(0.0, 20.0)).abs() < 1e-9 && foot.distance_mm < 5e-3,
            "{} {x}",
            foot.s_mm
        );
    }
}

#[test]
fn laps_over_each_other_are_distinguished() {
    for radius_mm in [0.1, 1.0, 3.0] {
        let start = [radius_mm, 0.0, 0.0];
        let lap = || {
            motion(
                start,
                start,
                Shape::Arc {
                    plane: Plane::Xy,
                    center_mm: [0.0; 3],
                    turns: 1,
                },
            )
        };
        let feet = feet(vec![lap(), lap(), lap()], |reference, t_s| {
            reference.at(t_s - 0.02).position_mm.map(|x| 0.98 * x)
        });
        goes_on(&feet);
        for (n, foot) in feet.iter().enumerate().skip(1) {
            let jump_mm = foot.s_mm - feet[n - 1].s_mm;
            assert!(jump_mm < 0.06, "{radius_mm}: a jump of {jump_mm} mm");
        }
        assert!((feet[feet.len() - 1].s_mm - 3.0 * std::f64::consts::TAU * radius_mm).abs() < 1e-6);
    }
}

#[test]
fn a_tool_that_leaves_a_line_out_of_a_raster_is_seen() {
    let row = |k: u32| {
        let (y, to) = (0.05 * f64::from(k), f64::from((k + 1) % 2));
        [[1.0 - to, y, 0.0], [to, y, 0.0]]
    };
    let corners: Vec<Vector> = (0..8).flat_map(row).collect();
    // In place of the third line, the tool stands a line and a half too far.
    let feet = feet(lines(&corners), |reference, t_s| {
        let mut at_mm = reference.at(t_s - 0.02).position_mm;
        if (at_mm[1] - 0.1).abs() < 1e-9 {
            at_mm[1] += 0.1;
        }
        at_mm
    });
    goes_on(&feet);
    assert!(largest(&feet) > 0.049, "{}", largest(&feet));
}
