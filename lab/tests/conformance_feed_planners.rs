//! Every planner of the table: gapless spans in order, bounds kept, the same however the calls are
//! spread, no piece lost.

use crate::programs::{BLEND, LIMITS, Random};
use feedwright_lab::CONTOURS;
use feedwright_plan::{
    AxisLimits, Constraints, FEED_PLANNERS, FeedMember, FeedPlanner, Piece, Plan, Planned, Plc,
    Section, SectionPlanner, Span, Step, Trapezoid, Unlimited,
};
use feedwright_sim::Reference;

/// Part by which a bound on the speed may be exceeded between the points at which it is taken: a
/// thousandth of its square.
const OVER: f64 = 1e-3;

fn contour_pieces() -> Vec<Piece> {
    let steps = CONTOURS
        .iter()
        .flat_map(|contour| contour.steps(50.0, BLEND).unwrap());
    steps
        .map(|step| {
            if let Step::Piece(piece) = step {
                piece
            } else {
                panic!("a contour has pieces only")
            }
        })
        .collect()
}

/// Spans of all pieces, popped after every `every` pushes; each contour begins and ends at rest.
fn spans(planner: &mut dyn FeedPlanner, pieces: &[Piece], every: usize) -> Vec<Span> {
    let mut spans = Vec::new();
    for (i, piece) in pieces.iter().enumerate() {
        planner.push(piece, piece.s_mm == 0.0);
        if i % every == 0 {
            spans.extend(std::iter::from_fn(|| planner.pop()));
        }
    }
    planner.finish();
    spans.extend(std::iter::from_fn(|| planner.pop()));
    spans
}

/// Distance and speed after `t` of a span.
fn state(span: &Span, t: f64) -> (f64, f64) {
    let Span {
        from_mm,
        speed_mm_s: v,
        accel_mm_s2: a,
        jerk_mm_s3: j,
        ..
    } = *span;
    (
        from_mm + t * (v + t * (a / 2.0 + t * j / 6.0)),
        v + t * (a + t * j / 2.0),
    )
}

/// Limits along and across the path, with those of the axes for planners that need them.
fn constraints(member: &FeedMember) -> Constraints {
    let axis = AxisLimits {
        velocity_mm_s: 200.0,
        accel_mm_s2: 2000.0,
        jerk_mm_s3: 50_000.0,
    };
    let axes = if member.needs_axes {
        vec![axis; 3]
    } else {
        Vec::new()
    };
    Constraints {
        axes,
        path_tolerance_mm: member.needs_axes.then_some(0.01),
        ..Constraints::from(&LIMITS)
    }
}

#[test]
fn spans_cover_every_piece_below_feedrate_and_normal_acceleration() {
    let pieces = contour_pieces();
    // Planners of axes have no normal acceleration: property_time_optimal.rs.
    for member in FEED_PLANNERS.iter().filter(|member| !member.needs_axes) {
        let (mut piece, mut at_mm) = (0, 0.0);
        for span in &spans(&mut *(member.make)(&constraints(member)), &pieces, 1) {
            if span.piece != piece {
                let length_mm = pieces[piece as usize].length_mm;
                assert!(
                    (at_mm - length_mm).abs() < 1e-9,
                    "{}: piece {piece} ends at {at_mm}",
                    member.name
                );
                assert_eq!(span.piece, piece + 1, "{}", member.name);
                (piece, at_mm) = (span.piece, 0.0);
            }
            assert!(
                (span.from_mm - at_mm).abs() < 1e-9,
                "{}: {at_mm} {span:?}",
                member.name
            );
            let Piece {
                curve, feed_mm_s, ..
            } = &pieces[piece as usize];
            for i in 0..=8 {
                let (mm, speed_mm_s) = state(span, span.duration_s * f64::from(i) / 8.0);
                let cap = feed_mm_s
                    .powi(2)
                    .min(LIMITS.normal_accel_mm_s2 / curve.curvature(mm));
                assert!(
                    speed_mm_s.powi(2) <= cap * (1.0 + OVER) + 1e-8,
                    "{}: {speed_mm_s} {cap}",
                    member.name
                );
                at_mm = mm;
            }
        }
        assert_eq!(piece as usize, pieces.len() - 1, "{}", member.name);
    }
}

#[test]
fn how_calls_are_spread_changes_nothing() {
    let pieces = contour_pieces();
    for member in FEED_PLANNERS {
        let one = spans(&mut *(member.make)(&constraints(member)), &pieces, 1);
        for every in [3, 100_000] {
            let other = spans(&mut *(member.make)(&constraints(member)), &pieces, every);
            assert_eq!(one, other, "{}", member.name);
        }
    }
}

fn sections(seed: u64, count: usize) -> Vec<Section> {
    let mut random = Random(seed);
    (0..count)
        .map(|i| Section {
            piece: i as u64,
            from_mm: 0.0,
            length_mm: 10f64.powf(random.between(-3.0, 1.0)),
            joint_cap: if random.next() < 0.1 {
                0.0
            } else {
                f64::INFINITY
            },
            start_cap: 10f64.powf(random.between(1.0, 4.0)),
            end_cap: 10f64.powf(random.between(1.0, 4.0)),
        })
        .collect()
}

fn section_planners() -> [(&'static str, Box<dyn SectionPlanner>); 2] {
    let trapezoid = Trapezoid::new(LIMITS.tangential_accel_mm_s2);
    [
        ("trapezoid", Box::new(trapezoid)),
        ("unlimited", Box::new(Unlimited::default())),
    ]
}

/// Spans of all sections, popped after every `every` pushes.
fn section_spans(
    planner: &mut dyn SectionPlanner,
    sections: &[Section],
    every: usize,
) -> Vec<Span> {
    let mut spans = Vec::new();
    for (i, section) in sections.iter().enumerate() {
        planner.push(*section);
        if i % every == 0 {
            spans.extend(std::iter::from_fn(|| planner.pop()));
        }
    }
    planner.finish();
    spans.extend(std::iter::from_fn(|| planner.pop()));
    spans
}

#[test]
fn spans_cover_every_section_below_its_bound() {
    for (name, mut planner) in section_planners() {
        let sections = sections(3, 3000);
        let mut place = (0, 0.0);
        for span in &section_spans(&mut *planner, &sections, 1) {
            if span.piece != place.0 {
                let before = &sections[place.0 as usize];
                assert!(
                    (place.1 - before.length_mm).abs() < 1e-9,
                    "{name}: {place:?} {before:?}"
                );
                assert_eq!(span.piece, place.0 + 1, "{name}");
                place = (span.piece, 0.0);
            }
            let section = &sections[span.piece as usize];
            assert!(
                (span.from_mm - place.1).abs() < 1e-9,
                "{name}: {place:?} {span:?}"
            );
            let slope = (section.end_cap - section.start_cap) / section.length_mm;
            for i in 0..=8 {
                let (at, speed) = state(span, span.duration_s * f64::from(i) / 8.0);
                let cap = section.start_cap + slope * at;
                assert!(
                    speed.powi(2) <= cap + 1e-8 + 1e-12 * slope.abs(),
                    "{name}: {speed} {cap}"
                );
                place.1 = at;
            }
        }
        assert_eq!(place.0 as usize, sections.len() - 1);
    }
}

#[test]
fn how_calls_are_spread_over_sections_changes_nothing() {
    let sections = sections(5, 1000);
    for every in [7, 400, 100_000] {
        for ((name, mut one), (_, mut other)) in
            section_planners().into_iter().zip(section_planners())
        {
            let one = section_spans(&mut *one, &sections, 1);
            assert_eq!(one, section_spans(&mut *other, &sections, every), "{name}");
        }
    }
}

fn plan(contour: usize, member: &FeedMember) -> Plan<'static> {
    let steps = CONTOURS[contour].steps(50.0, BLEND).unwrap();
    let constraints = constraints(member);
    Plan::new(
        Box::new(steps.into_iter().map(Ok)),
        &constraints,
        member,
        Plc::default(),
    )
    .unwrap()
}

#[test]
fn nothing_is_faster_than_unlimited() {
    for (number, contour) in CONTOURS.iter().enumerate() {
        let mut times = FEED_PLANNERS
            .iter()
            .filter(|member| !member.needs_axes)
            .map(|member| {
                (
                    member.name,
                    Reference::new(plan(number, member)).read_to_end_s(),
                )
            });
        let (_, least) = times
            .clone()
            .find(|(name, _)| *name == "unlimited")
            .unwrap();
        assert!(times.all(|(_, time)| time >= least), "{}", contour.name);
    }
}

#[test]
fn phases_follow_each_other_on_the_clock() {
    for member in FEED_PLANNERS {
        let mut clock = 0.0;
        for planned in plan(3, member) {
            if let Planned::Phase(phase) = planned {
                assert!(
                    (phase.tau_s - clock).abs() < 1e-12,
                    "{}: {} {clock}",
                    member.name,
                    phase.tau_s
                );
                assert!(phase.duration_s > 0.0);
                clock = phase.tau_s + phase.duration_s;
            }
        }
    }
}
