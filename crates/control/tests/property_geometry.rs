//! From the tool to the joints and back, of whatever geometry is accepted.

use feedwright_control::vector::{norm, sub};
use feedwright_control::{AxisErrors, ErrorTable, Knot, KnownGeometry};
use proptest::prelude::*;

/// Travel on both sides of the origin, mm.
const TRAVEL_MM: f64 = 1000.0;

fn axis() -> impl Strategy<Value = AxisErrors> {
    (-2e-3..2e-3, -0.02..0.02, 4.0..20.0, -4.0..4.0).prop_map(
        |(scale, pitch_mm, lead_mm, pitch_phase_rad)| AxisErrors {
            scale,
            pitch_mm,
            pitch_rad_per_mm: std::f64::consts::TAU / lead_mm,
            pitch_phase_rad,
            ..AxisErrors::default()
        },
    )
}

/// A table with points 20 to 400 mm apart, each up to 0.02 mm from the one before.
fn table() -> impl Strategy<Value = ErrorTable> {
    prop::collection::vec((20.0..400.0, -0.02..0.02), 2..9).prop_map(|steps| {
        let (mut at_mm, mut error_mm) = (-TRAVEL_MM, 0.0);
        ErrorTable::new(steps.into_iter().map(|(step_mm, rise_mm)| {
            at_mm += step_mm;
            error_mm += rise_mm;
            [at_mm, error_mm]
        }))
        .unwrap()
    })
}

fn geometry() -> impl Strategy<Value = KnownGeometry<3>> {
    let tables = prop::option::of((0..3_usize, 0..3_usize, table()));
    let squareness = prop::array::uniform3(-1e-3..1e-3);
    (prop::array::uniform3(axis()), squareness, tables).prop_map(|(axes, squareness_rad, table)| {
        let geometry = KnownGeometry::new(axes, squareness_rad);
        match table {
            Some((of, over, table)) => geometry.with_table(of, over, table),
            None => geometry,
        }
    })
}

fn place() -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(-TRAVEL_MM..TRAVEL_MM)
}

fn largest(difference: [f64; 3]) -> f64 {
    difference
        .into_iter()
        .fold(0.0, |most, part| most.max(part.abs()))
}

proptest! {
    #[test]
    fn the_joints_of_a_tool_bring_it_back(geometry in geometry(), tool_mm in place()) {
        prop_assert_eq!(geometry.check(), Ok(()));
        let back_mm = geometry.tool_mm(geometry.joints_mm(tool_mm));
        prop_assert!(largest(sub(back_mm, tool_mm)) < 1e-9, "{tool_mm:?} {back_mm:?}");
    }

    #[test]
    fn the_derivative_agrees_with_differences(geometry in geometry(), joints_mm in place(), moved in place()) {
        let moved = moved.map(|part| part / TRAVEL_MM);
        let step = |k: f64| geometry.tool_mm([0, 1, 2].map(|i| joints_mm[i] + k * moved[i]));
        let h = 1e-3;
        let by_differences = sub(step(h), step(-h)).map(|part| part / (2.0 * h));
        let found = geometry.tool_moved(joints_mm, moved);
        // A table has a step in its second derivative at its points: at most 3 chords of 0.02 mm
        // over 20 mm, over h.
        prop_assert!(largest(sub(found, by_differences)) < 2e-6, "{found:?} {by_differences:?}");
        let back = geometry.joints_moved(joints_mm, found);
        prop_assert!(largest(sub(back, moved)) < 1e-11, "{moved:?} {back:?}");
    }

    #[test]
    fn a_knot_of_the_joints_moves_the_tool_as_its_own(geometry in geometry(), position_mm in place(), way in place()) {
        prop_assume!(norm(way) > 1.0);
        let tool = Knot { position_mm, tangent: way.map(|part| part / norm(way)), feed_mm_s: 50.0, cutting: true };
        let joints = geometry.joint_knot(&tool);
        prop_assert!(joints.is_valid() && joints.cutting);
        prop_assert!((norm(joints.tangent) - 1.0).abs() < 1e-12);
        let tool_mm_s = geometry.tool_moved(joints.position_mm, joints.tangent.map(|part| joints.feed_mm_s * part));
        let wanted_mm_s = tool.tangent.map(|part| 50.0 * part);
        prop_assert!(largest(sub(tool_mm_s, wanted_mm_s)) < 1e-9, "{tool_mm_s:?} {wanted_mm_s:?}");
    }
}
