//! Every planner of the table: gapless spans in order, caps kept, the same however the calls are spread, no section lost.

#[expect(dead_code, reason = "each test uses its own part")]
#[path = "common/programs.rs"]
mod common;

use common::{BLEND, LIMITS, Random};
use feedwright::feed::plan::{Plan, Planned};
use feedwright::feed::{FeedPlanner, MEMBERS, Section, Span};
use feedwright::path::contour::CONTOURS;
use feedwright::reference::Reference;

fn sections(seed: u64, count: usize) -> Vec<Section> {
    let mut random = Random(seed);
    (0..count)
        .map(|i| Section {
            piece: i as u64,
            from_mm: 0.0,
            length_mm: 10f64.powf(random.between(-3.0, 1.0)),
            joint_cap: if random.next() < 0.1 { 0.0 } else { f64::INFINITY },
            start_cap: 10f64.powf(random.between(1.0, 4.0)),
            end_cap: 10f64.powf(random.between(1.0, 4.0)),
        })
        .collect()
}

/// Spans of all sections, popped after every `every` pushes.
fn spans(planner: &mut dyn FeedPlanner, sections: &[Section], every: usize) -> Vec<Span> {
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
    for member in MEMBERS {
        let sections = sections(3, 3000);
        let spans = spans(&mut *(member.make)(&LIMITS), &sections, 1);
        let mut place = (0, 0.0);
        for span in &spans {
            if span.section != place.0 {
                let before = &sections[place.0 as usize];
                assert!((place.1 - before.length_mm).abs() < 1e-9, "{}: {place:?} {before:?}", member.name);
                assert_eq!(span.section, place.0 + 1, "{}", member.name);
                place = (span.section, 0.0);
            }
            let section = &sections[span.section as usize];
            assert_eq!(span.piece, section.piece);
            assert!((span.from_mm - place.1).abs() < 1e-9, "{}: {place:?} {span:?}", member.name);
            let slope = (section.end_cap - section.start_cap) / section.length_mm;
            for i in 0..=8 {
                let t = span.duration_s * f64::from(i) / 8.0;
                let at = span.from_mm + t * (span.speed_mm_s + 0.5 * span.accel_mm_s2 * t);
                let square = (span.speed_mm_s + span.accel_mm_s2 * t).powi(2);
                let cap = section.start_cap + slope * at;
                assert!(square <= cap + 1e-8 + 1e-12 * slope.abs(), "{}: {square} {cap}", member.name);
                place.1 = at;
            }
        }
        assert_eq!(place.0 as usize, sections.len() - 1);
    }
}

#[test]
fn how_calls_are_spread_changes_nothing() {
    for member in MEMBERS {
        let sections = sections(5, 1000);
        let one = spans(&mut *(member.make)(&LIMITS), &sections, 1);
        for every in [7, 400, 100_000] {
            assert_eq!(one, spans(&mut *(member.make)(&LIMITS), &sections, every), "{}", member.name);
        }
    }
}

#[test]
fn nothing_is_faster_than_unlimited() {
    for contour in CONTOURS {
        let mut times = MEMBERS.iter().map(|member| {
            let steps = contour.steps(50.0, BLEND).unwrap();
            let plan = Plan::with_planner(Box::new(steps.into_iter().map(Ok)), &LIMITS, member).unwrap();
            (member.name, Reference::from_plan(plan).read_to_end_s())
        });
        let (_, least) = times.clone().find(|(name, _)| *name == "unlimited").unwrap();
        assert!(times.all(|(_, time)| time >= least), "{}", contour.name);
    }
}

#[test]
fn phases_follow_each_other_on_the_clock() {
    for member in MEMBERS {
        let steps = CONTOURS[3].steps(50.0, BLEND).unwrap();
        let plan = Plan::with_planner(Box::new(steps.into_iter().map(Ok)), &LIMITS, member).unwrap();
        let mut clock = 0.0;
        for planned in plan {
            if let Planned::Phase(phase) = planned {
                assert!((phase.tau_s - clock).abs() < 1e-12, "{}: {} {clock}", member.name, phase.tau_s);
                assert!(phase.duration_s > 0.0);
                clock = phase.tau_s + phase.duration_s;
            }
        }
    }
}
