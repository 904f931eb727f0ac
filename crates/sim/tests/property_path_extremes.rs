//! Whatever numbers a motion is made of: no panic, nothing that is not a number, limits kept.

use crate::programs::{LIMITS, Random};
use feedwright_gcode::canon::{
    AuxiliaryAxes, Canon, Corner, Event, EventKind, Motion, MotionKind, Plane, Shape, Spline,
};
use feedwright_sim::Reference;
use proptest::prelude::*;
use std::sync::Arc;

/// Numbers as programs have them, and as they should not.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        60 => -50.0..50.0f64,
        20 => prop::sample::select(vec![0.0, -0.0, 1.0, 10.0, -10.0, 5.0, 1e-3]),
        6 => prop::sample::select(vec![1e-12, 1e-300, 1e9, -1e9, 1e6, f64::MIN_POSITIVE]),
        1 => prop::sample::select(vec![f64::NAN, f64::INFINITY, f64::MAX, -1e300, 1.1e9]),
    ]
}

fn point() -> impl Strategy<Value = [f64; 3]> {
    [number(), number(), number()]
}

fn shape() -> impl Strategy<Value = Shape> {
    let plane = prop::sample::select(vec![Plane::Xy, Plane::Zx, Plane::Yz]);
    let turns = prop::sample::select(vec![0, 1, -1, 2, -7, i32::MAX, i32::MIN]);
    let spline = (
        1usize..5,
        prop::collection::vec(point(), 1..8),
        prop::collection::vec(number(), 1..16),
        0u32..3,
    );
    prop_oneof![
        2 => Just(Shape::Line),
        3 => (plane, point(), turns).prop_map(|(plane, center_mm, turns)| Shape::Arc { plane, center_mm, turns }),
        1 => spline.prop_map(|(degree, control_mm, mut knots, tidy)| {
            // Mostly as it should be, now and then not.
            if tidy > 0 {
                knots.resize(control_mm.len() + degree + 1, 3.0);
                knots.sort_by(f64::total_cmp);
            }
            let weights = control_mm.iter().map(|p| if tidy > 1 { 1.0 } else { p[0].abs() }).collect();
            Shape::Spline(Arc::new(Spline { degree, knots, control_mm, weights }))
        }),
    ]
}

fn corner() -> impl Strategy<Value = Corner> {
    prop::sample::select(vec![
        Corner::ExactStop,
        Corner::ExactPath,
        Corner::Continuous {
            tolerance_mm: None,
            merge_mm: None,
        },
        Corner::Continuous {
            tolerance_mm: Some(0.01),
            merge_mm: None,
        },
    ])
}

/// Motions that join, each with its own oddities.
fn program() -> impl Strategy<Value = Vec<Canon>> {
    let motion = (
        point(),
        shape(),
        number(),
        corner(),
        any::<bool>(),
        number(),
    );
    (point(), prop::collection::vec(motion, 1..12)).prop_map(|(mut here, motions)| {
        let mut canon = Vec::new();
        for (end_mm, shape, feed, corner, rapid, seconds) in motions {
            let kind = if rapid {
                MotionKind::Rapid
            } else {
                MotionKind::Feed
            };
            let (start_mm, end_mm) = match &shape {
                Shape::Spline(spline) => (here, spline.control_mm[spline.control_mm.len() - 1]),
                _ => (here, end_mm),
            };
            let feed_mm_s = feed.abs();
            canon.push(Canon::Motion(Motion {
                line: 1,
                kind,
                start_mm,
                end_mm,
                shape,
                feed_mm_s,
                corner,
                others: AuxiliaryAxes::default(),
            }));
            if seconds > 40.0 {
                canon.push(Canon::Event(Event {
                    line: 2,
                    kind: EventKind::Dwell { seconds },
                }));
            }
            here = end_mm;
        }
        canon
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn nothing_panics_and_all_is_finite(program in program(), seed in 1u64..u64::MAX) {
        let mut random = Random(seed);
        let mut reference = Reference::of_program(program, &LIMITS).unwrap();
        let end_s = reference.read_to_end_s();
        prop_assert!(end_s.is_finite() && end_s >= 0.0, "{}", end_s);
        for tau in [-1.0, 0.0, 0.3 * end_s, random.next() * end_s, end_s, 2.0 * end_s + 1.0, f64::NAN, f64::INFINITY] {
            let at = reference.at(tau);
            let values = [at.s_mm, at.feed_mm_s].into_iter().chain(at.position_mm).chain(at.tangent);
            prop_assert!(values.into_iter().all(f64::is_finite), "{:?}", at);
            let length: f64 = at.tangent.iter().map(|x| x * x).sum();
            prop_assert!((length - 1.0).abs() < 1e-9, "{:?}", at);
            prop_assert!(at.feed_mm_s <= LIMITS.max_feed_mm_s);
            let point = at.position_mm.map(|x| x + random.between(-1.0, 1.0));
            let foot = reference.nearest(point, tau - random.next(), tau + random.next());
            prop_assert!(foot.distance_mm.is_finite() && foot.s_mm.is_finite(), "{:?}", foot);
        }
    }
}
