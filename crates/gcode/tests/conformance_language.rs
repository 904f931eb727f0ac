//! What programs mean: end points, shapes and events, against values worked out by hand.
use feedwright_gcode::canon::{Canon, Corner, EventKind, Motion, MotionKind, Plane, Shape};
use feedwright_gcode::{Reader, Settings, summarize};

fn run(text: &str) -> Vec<Canon> {
    Reader::from_text("test", text, Settings::default())
        .unwrap()
        .map(|step| step.unwrap_or_else(|fault| panic!("{text}: {fault:?}")))
        .collect()
}

fn motions(text: &str) -> Vec<Motion> {
    run(text)
        .into_iter()
        .filter_map(|step| {
            if let Canon::Motion(motion) = step {
                Some(motion)
            } else {
                None
            }
        })
        .collect()
}

fn ends(text: &str) -> Vec<[f64; 3]> {
    motions(text).iter().map(|motion| motion.end_mm).collect()
}

fn events(text: &str) -> Vec<EventKind> {
    run(text)
        .into_iter()
        .filter_map(|step| {
            if let Canon::Event(event) = step {
                Some(event.kind)
            } else {
                None
            }
        })
        .collect()
}

#[test]
fn units_distances_and_feeds() {
    assert_eq!(
        ends("G20 G0 X1\nG91 X1 Y-1\nG21 X10\nM2"),
        [[25.4, 0.0, 0.0], [50.8, -25.4, 0.0], [60.8, -25.4, 0.0]]
    );
    let feeds: Vec<f64> = motions("G1 F600 X1\nX2 F1200\nG93 F2 X12\nG95 S60 F0.5 X13\nM2")
        .iter()
        .map(|m| m.feed_mm_s)
        .collect();
    assert_eq!(feeds, [10.0, 20.0, 10.0 / 30.0, 0.5]);
}

#[test]
fn motions_chain_from_zero() {
    let all = motions("G0 X1\nG1 F60 Y1\nG3 X0 Y2 I-1\nM2");
    assert_eq!(all[0].start_mm, [0.0; 3]);
    for pair in all.windows(2) {
        assert_eq!(pair[0].end_mm, pair[1].start_mm);
    }
    assert_eq!(
        (all[0].kind, all[1].kind, all[2].line),
        (MotionKind::Rapid, MotionKind::Feed, 3)
    );
}

#[test]
fn arcs_by_centre_and_radius_agree_in_every_plane() {
    for (plane, words) in [
        (Plane::Xy, ["G17", "X", "Y", "I"]),
        (Plane::Zx, ["G18", "Z", "X", "K"]),
        (Plane::Yz, ["G19", "Y", "Z", "J"]),
    ] {
        let [code, first, second, offset] = words;
        let by_center =
            motions(&format!("{code} G3 F60 {first}1 {second}1 {offset}1\nM2").replace("G3", "G2"));
        let by_radius = motions(&format!("{code} G2 F60 {first}1 {second}1 R1\nM2"));
        let (
            Shape::Arc {
                center_mm: a,
                turns: -1,
                plane: p,
            },
            Shape::Arc {
                center_mm: b,
                turns: -1,
                ..
            },
        ) = (&by_center[0].shape, &by_radius[0].shape)
        else {
            panic!("{by_center:?} {by_radius:?}")
        };
        assert_eq!(*p, plane);
        for axis in 0..3 {
            assert!((a[axis] - b[axis]).abs() < 1e-12, "{plane:?} {a:?} {b:?}");
        }
    }
}

#[test]
fn a_negative_radius_is_the_long_way() {
    let long = &motions("G3 F60 X1 Y1 R-1\nM2")[0];
    let short = &motions("G3 F60 X1 Y1 R1\nM2")[0];
    let quarter = std::f64::consts::FRAC_PI_2;
    assert!((long.length_mm() - 3.0 * quarter).abs() < 1e-12);
    assert!((short.length_mm() - quarter).abs() < 1e-12);
}

#[test]
fn full_circles_helices_and_turns() {
    let tau = std::f64::consts::TAU;
    assert!((motions("G2 F60 I1\nM2")[0].length_mm() - tau).abs() < 1e-12);
    let helix = &motions("G3 F60 X0 Y0 Z4 I2 P3\nM2")[0];
    assert!(matches!(helix.shape, Shape::Arc { turns: 3, .. }));
    assert!((helix.length_mm() - (6.0 * tau).hypot(4.0)).abs() < 1e-12);
    let absolute = &motions("G0 X5 Y5\nG90.1 G2 X5 Y5 I6 J5 F60\nM2")[1];
    assert!(matches!(
        absolute.shape,
        Shape::Arc {
            center_mm: [6.0, 5.0, 0.0],
            turns: -1,
            ..
        }
    ));
}

#[test]
fn corners_follow_g61_and_g64() {
    let corners: Vec<Corner> = motions(
        "G0 X1\nG61 X2\nG61.1 X3\nG64 P0.01 X4\nG64 X5\nG64 P0.01 Q0 X6\nG20 G64 P1 Q2 X7\nM2",
    )
    .iter()
    .map(|m| m.corner)
    .collect();
    let free = Corner::Continuous {
        tolerance_mm: None,
        merge_mm: None,
    };
    assert_eq!(
        corners,
        [
            free,
            Corner::ExactPath,
            Corner::ExactStop,
            Corner::Continuous {
                tolerance_mm: Some(0.01),
                merge_mm: None
            },
            free,
            Corner::Continuous {
                tolerance_mm: Some(0.01),
                merge_mm: Some(0.0)
            },
            Corner::Continuous {
                tolerance_mm: Some(25.4),
                merge_mm: Some(50.8)
            },
        ]
    );
}

#[test]
fn events_keep_their_order() {
    let all = events("T2 M6\nS1000 M3\nG4 P0.5\nM8\nM30\nM5");
    let code = |code| EventKind::MCode {
        code,
        p: None,
        q: None,
    };
    assert_eq!(
        all,
        [
            EventKind::ToolSelect { tool: 2 },
            code(6),
            EventKind::SpindleSpeed { rpm: 1000.0 },
            code(3),
            EventKind::Dwell { seconds: 0.5 },
            code(8),
            code(30),
            EventKind::ProgramEnd
        ]
    );
}

#[test]
fn comments_blanks_case_and_line_numbers_mean_nothing() {
    let text = "%\nn10 g0 x 1 0 . 5 (note) y-.5 ; more\r\n/N20 G0 X1\n( only a note )\n%\nnot read";
    assert_eq!(ends(text), [[10.5, -0.5, 0.0], [1.0, -0.5, 0.0]]);
    let settings = Settings {
        block_delete: true,
        ..Settings::default()
    };
    assert_eq!(
        summarize(Reader::from_text("test", text, settings).unwrap())
            .unwrap()
            .motions,
        1
    );
}

#[test]
fn coordinate_systems_do_not_move_the_machine() {
    let text =
        "G10 L2 P2 X10 Y20\nG0 X1\nG55 X1\nG53 G0 X0\nG92 X5\nG0 X6\nG92.1\nX1\nG52 X100\nX1\nM2";
    assert_eq!(
        ends(text),
        [
            [1.0, 0.0, 0.0],
            [11.0, 0.0, 0.0],
            [0.0; 3],
            [1.0, 0.0, 0.0],
            [11.0, 0.0, 0.0],
            [111.0, 0.0, 0.0]
        ]
    );
}

#[test]
fn a_summary_measures_the_program() {
    let summary = summarize(
        Reader::from_text(
            "test",
            "G0 X3 Y4\nG1 F60 X0\nG2 X0 Y4 I1\nM2",
            Settings::default(),
        )
        .unwrap(),
    )
    .unwrap();
    assert_eq!(
        (
            summary.motions,
            summary.moves,
            summary.rapid_mm,
            summary.lines
        ),
        (3, [true, true, false], 5.0, 4)
    );
    assert!((summary.feed_mm - 3.0 - std::f64::consts::TAU).abs() < 1e-12);
    assert_eq!(summary.box_mm, [[0.0, 0.0, 0.0], [3.0, 5.0, 0.0]]);
}

#[test]
fn a_missing_end_is_only_a_warning() {
    let summary =
        summarize(Reader::from_text("test", "%\nG0 X3 Y4\n", Settings::default()).unwrap())
            .unwrap();
    assert!(summary.warnings[0].message.contains("without M2"));
}
