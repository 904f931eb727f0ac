//! What the contract of planners carries beyond the members of today: jerk, and derivatives by arc
//! length. A planner of constant jerk is made here and run through the chain. And a planned path
//! beside the programmed one: a rounded corner.

use crate::programs::{BLEND, polyline};
use feedwright_control::{Controller, Uncorrected};
use feedwright_gcode::canon::{Canon, Motion, Plane, Shape};
use feedwright_plan::{
    AlignedPaths, Constraints, FeedMember, FeedPlanner, Piece, Span, Step, Steps,
};
use feedwright_sim::{Machine, Row, Run, Stages, path_steps};
use std::collections::VecDeque;
use std::f64::consts::{PI, SQRT_2};

/// Radius that corners are rounded with, mm.
const RADIUS_MM: f64 = 1.0;
/// Side of the square, mm.
const SIDE_MM: f64 = 10.0;

/// Every piece from rest to rest, at plus and minus the smallest jerk of the axes: speed up and
/// slow down, in four parts of `T = (L / 2 j)^(1/3)`.
#[derive(Default)]
struct RestToRest {
    jerk_mm_s3: f64,
    pieces: u64,
    ready: VecDeque<Span>,
}

impl FeedPlanner for RestToRest {
    fn push(&mut self, piece: &Piece, _: bool) {
        let j = self.jerk_mm_s3;
        let duration_s = (piece.length_mm / (2.0 * j)).cbrt();
        let (mut from_mm, mut speed_mm_s, mut accel_mm_s2) = (0.0, 0.0, 0.0);
        for jerk_mm_s3 in [j, -j, -j, j] {
            let t = duration_s;
            let piece = self.pieces;
            self.ready.push_back(Span {
                piece,
                from_mm,
                duration_s,
                speed_mm_s,
                accel_mm_s2,
                jerk_mm_s3,
                motion: None,
            });
            from_mm += t * (speed_mm_s + t * (accel_mm_s2 / 2.0 + t * jerk_mm_s3 / 6.0));
            speed_mm_s += t * (accel_mm_s2 + t * jerk_mm_s3 / 2.0);
            accel_mm_s2 += t * jerk_mm_s3;
        }
        self.pieces += 1;
    }

    fn finish(&mut self) {}

    fn pop(&mut self) -> Option<Span> {
        self.ready.pop_front()
    }
}

const REST_TO_REST: FeedMember = FeedMember {
    name: "rest-to-rest",
    about: "constant jerk, a stop at each joint",
    needs_axes: false,
    limits_jerk: true,
    make: |constraints: &Constraints| {
        let jerk_mm_s3 = constraints
            .axes
            .iter()
            .map(|axis| axis.jerk_mm_s3)
            .fold(f64::INFINITY, f64::min);
        Box::new(RestToRest {
            jerk_mm_s3,
            ..RestToRest::default()
        })
    },
};

fn machine() -> Machine {
    let mut machine = Machine::load("tnv40".as_ref()).unwrap();
    machine
        .axes
        .iter_mut()
        .for_each(|axis| axis.max_jerk_mm_s3 = Some(2000.0));
    machine
}

/// Two sides of a square, counter-clockwise.
fn corner() -> Vec<Step> {
    let canon = polyline(
        &[[0.0; 3], [SIDE_MM, 0.0, 0.0], [SIDE_MM, SIDE_MM, 0.0]],
        20.0,
        BLEND,
    );
    path_steps(canon).map(|step| step.unwrap()).collect()
}

/// The same with the corner rounded by an arc of [`RADIUS_MM`].
fn rounded() -> Vec<Step> {
    let before = polyline(&[[0.0; 3], [SIDE_MM - RADIUS_MM, 0.0, 0.0]], 20.0, BLEND);
    let after = polyline(
        &[[SIDE_MM, RADIUS_MM, 0.0], [SIDE_MM, SIDE_MM, 0.0]],
        20.0,
        BLEND,
    );
    let Canon::Motion(line) = &before[0] else {
        panic!("a line")
    };
    let center_mm = [SIDE_MM - RADIUS_MM, RADIUS_MM, 0.0];
    let shape = Shape::Arc {
        plane: Plane::Xy,
        center_mm,
        turns: 1,
    };
    let arc = Motion {
        start_mm: line.end_mm,
        end_mm: [SIDE_MM, RADIUS_MM, 0.0],
        shape,
        ..line.clone()
    };
    path_steps([before.clone(), vec![Canon::Motion(arc)], after].concat())
        .map(|step| step.unwrap())
        .collect()
}

fn boxed(steps: &[Step]) -> Steps<'_> {
    Box::new(steps.iter().cloned().map(Ok))
}

/// Distance from the two sides.
fn from_path_mm([x, y, _]: [f64; 3]) -> f64 {
    let first = (x - x.clamp(0.0, SIDE_MM)).hypot(y);
    first.min((x - SIDE_MM).hypot(y - y.clamp(0.0, SIDE_MM)))
}

#[test]
fn a_plan_of_constant_jerk_comes_out_as_its_closed_form() {
    let steps = corner();
    let stages = Stages {
        planner: &REST_TO_REST,
    };
    let mut reference = stages.reference(boxed(&steps), &machine()).unwrap();
    let part_s = (SIDE_MM / 4000.0_f64).cbrt();
    assert!((reference.read_to_end_s() - 8.0 * part_s).abs() < 1e-12);
    for i in 0..=40 {
        let t = part_s * f64::from(i) / 20.0;
        // Up to the middle: j t^3 / 6, then from the inflection on symmetric to it.
        let (mm, mm_s) = if t <= part_s {
            (2000.0 * t.powi(3) / 6.0, 1000.0 * t * t)
        } else {
            let left = 2.0 * part_s - t;
            let top = 2000.0 * part_s * part_s;
            let after = t - part_s;
            let start = 2000.0 * part_s.powi(3) / 6.0;
            let mm = start + 1000.0 * part_s * part_s * after + 1000.0 * part_s * after * after
                - 2000.0 * after.powi(3) / 6.0;
            (mm, top - 1000.0 * left * left)
        };
        let sample = reference.at(t);
        assert!((sample.s_mm - mm).abs() < 1e-9, "{t}: {} {mm}", sample.s_mm);
        assert!(
            (sample.feed_mm_s - mm_s).abs() < 1e-9,
            "{t}: {} {mm_s}",
            sample.feed_mm_s
        );
    }
    let middle = reference.at(2.0 * part_s);
    assert!((middle.s_mm - SIDE_MM / 2.0).abs() < 1e-9, "{middle:?}");
}

#[test]
fn the_tool_follows_the_planned_path_and_is_measured_to_the_programmed_one() {
    let steps = corner();
    let mut rows = Vec::<Row>::new();
    let machine = machine();
    let controller: &mut dyn Controller<2> = &mut Uncorrected;
    let aligned = AlignedPaths::new(&steps, &rounded());
    Run::on(&machine)
        .stages(Stages::default())
        .cut_aligned(&aligned, controller, &mut [&mut rows])
        .unwrap();
    let mut largest_mm: f64 = 0.0;
    for row in &rows {
        assert!(from_path_mm(row.path_mm) < 1e-9, "{row:?}");
        let exact_mm = from_path_mm(row.act_mm);
        assert!(
            row.contour_error_mm.abs() >= exact_mm - 1e-9,
            "{exact_mm} {row:?}"
        );
        largest_mm = largest_mm.max(exact_mm);
    }
    // What the arc leaves out, less the lag of the machine on it: the tool turns further in.
    let left_out_mm = RADIUS_MM * (1.0 - 0.5 * SQRT_2);
    assert!(
        largest_mm > left_out_mm && largest_mm < 2.0 * left_out_mm,
        "{largest_mm} {left_out_mm}"
    );
    let corner = rows
        .iter()
        .max_by(|a, b| {
            a.contour_error_mm
                .abs()
                .total_cmp(&b.contour_error_mm.abs())
        })
        .unwrap();
    assert!((corner.s_mm - SIDE_MM).abs() < 2.0, "{corner:?}");
    let length_mm = 2.0 * (SIDE_MM - RADIUS_MM) + 0.5 * PI * RADIUS_MM;
    let cmd_mm: f64 = rows
        .windows(2)
        .map(|pair| crate::programs::distance(pair[0].cmd_mm, pair[1].cmd_mm))
        .sum();
    assert!((cmd_mm - length_mm).abs() < 1e-3, "{cmd_mm} {length_mm}");
}
