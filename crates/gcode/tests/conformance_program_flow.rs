//! Parameters, O-words, subroutines, cycles, splines and cutter compensation: what programs that
//! compute come to.
use std::fs;

use feedwright_gcode::canon::{Canon, EventKind, Motion, MotionKind, Shape};
use feedwright_gcode::{Dialect, Reader, Settings};

fn read(text: &str, settings: Settings) -> (Vec<Canon>, Vec<String>) {
    let (mut steps, mut faults) = (Vec::new(), Vec::new());
    for step in Reader::from_text("test", text, settings).unwrap() {
        match step {
            Ok(step) => steps.push(step),
            Err(fault) => faults.push(format!("{}: {}", fault.line, fault.message)),
        }
    }
    (steps, faults)
}

fn motions(text: &str) -> Vec<Motion> {
    let (steps, faults) = read(text, Settings::default());
    assert!(faults.is_empty(), "{text}: {faults:?}");
    steps
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

fn xs(text: &str) -> Vec<f64> {
    motions(text)
        .iter()
        .map(|motion| motion.end_mm[0])
        .collect()
}

fn fault(text: &str) -> String {
    read(text, Settings::default())
        .1
        .into_iter()
        .next()
        .unwrap_or_else(|| panic!("no fault in {text}"))
}

#[test]
fn assignments_take_effect_after_their_line() {
    assert_eq!(
        xs("#1=5 G0 X[#1+1]\nG0 X#1\n#<len>=[#1*2] #2=7\nX#<len>\nX#2\nM2"),
        [1.0, 5.0, 10.0, 7.0]
    );
}

#[test]
fn subroutines_have_locals_and_results() {
    let text = "o1 sub\n#30=9\nG0 X[#1+#2]\no1 endsub [#1*#2]\n#1=100 #30=1\no1 call [3] [4]\nX#<_value>\nX#1\nX#30\nM2";
    assert_eq!(xs(text), [7.0, 12.0, 100.0, 1.0]);
    assert_eq!(
        xs(
            "o<f> call [4]\nX#<_value>\nM2\no<f> sub\no10 if [#1 le 1]\no<f> return [1]\no10 endif\no<f> call [#1-1]\nG0\no<f> endsub [#1*#<_value>]\n"
        ),
        [24.0].map(|_| 24.0)
    );
}

#[test]
fn branches_and_loops() {
    assert_eq!(
        xs(
            "#1=2\no1 if [#1 eq 1]\nG0 X1\no1 elseif [#1 eq 2]\nG0 X2\no1 else\nG0 X3\no1 endif\nX4\nM2"
        ),
        [2.0, 4.0]
    );
    assert_eq!(
        xs("#1=0\no1 while [#1 lt 3]\n#1=[#1+1]\nG0 X#1\no1 endwhile\nM2"),
        [1.0, 2.0, 3.0]
    );
    assert_eq!(
        xs("#1=0\no1 do\n#1=[#1+1]\nG0 X#1\no1 while [#1 lt 3]\nM2"),
        [1.0, 2.0, 3.0]
    );
    assert_eq!(
        xs("G91\no1 repeat [3]\nG0 X1\no1 endrepeat\nM2"),
        [1.0, 2.0, 3.0]
    );
    assert_eq!(
        xs(
            "#1=0\no1 while [1]\n#1=[#1+1]\no2 if [#1 eq 2]\no1 continue\no2 endif\no3 if [#1 gt 3]\no1 break\no3 endif\nG0 X#1\no1 endwhile\nM2"
        ),
        [1.0, 3.0]
    );
    assert_eq!(
        xs("G0 X1\no1 repeat [0]\nX9\no1 endrepeat\no2 while [0]\nX9\no2 endwhile\nX2\nM2"),
        [1.0, 2.0]
    );
}

#[test]
fn numbered_subroutines_share_parameters() {
    assert_eq!(
        xs("#1=1\nM98 P7 L3\nG0 X50\nM30\nO7\nG0 X#1\n#1=[#1*2]\nM99"),
        [1.0, 2.0, 4.0, 50.0]
    );
}

#[test]
fn subroutine_files_are_found() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("deep.ngc"),
        "o<deep> sub\nG0 X#1\no<deep> endsub\nM2\n",
    )
    .unwrap();
    let program = folder.path().join("main.ngc");
    fs::write(&program, "o<DEEP> call [3]\no<deep> call [4]\nM2\n").unwrap();
    let ends: Vec<f64> = Reader::open(&program, Settings::default())
        .unwrap()
        .filter_map(|step| {
            if let Canon::Motion(motion) = step.unwrap() {
                Some(motion.end_mm[0])
            } else {
                None
            }
        })
        .collect();
    assert_eq!(ends, [3.0, 4.0]);
}

#[test]
fn flow_that_cannot_be_followed_is_explained() {
    assert!(fault("o1 call\nM2").contains("defined nowhere"));
    assert!(fault("o1 if [0]\nG0 X1\nM2").contains("has no endif"));
    assert!(fault("o1 endwhile\nM2").contains("no loop O1"));
    assert!(fault("o1 sub\no1 call\no1 endsub\no1 call\nM2").contains("inside each other"));
    assert!(fault("o1 return\nM2").contains("not inside a subroutine"));
    assert!(fault("o1 foo\nM2").contains("no keyword"));
    assert!(fault("M98\nM2").contains("P with its number is missing"));
    assert!(fault("#<_x>=1\nM2").contains("only be read"));
    let settings = Settings {
        max_idle_lines: 1000,
        ..Settings::default()
    };
    assert!(read("o1 while [1]\no1 endwhile\nM2", settings).1[0].contains("endless loop"));
    let settings = Settings {
        max_motions: 1000,
        ..Settings::default()
    };
    assert!(
        read("G91\no1 while [1]\nG0 X1\no1 endwhile\nM2", settings).1[0]
            .contains("more than 1000 motions")
    );
}

#[test]
fn a_drilling_cycle_goes_over_down_and_up() {
    let all = motions("F60 G0 Z5\nG98 G81 X1 Y1 Z-1 R2\nX2\nG80\nM2");
    let path: Vec<([f64; 3], MotionKind)> = all
        .iter()
        .map(|motion| (motion.end_mm, motion.kind))
        .collect();
    use MotionKind::{Feed, Rapid};
    let hole = |x: f64| {
        [
            ([x, 1.0, 5.0], Rapid),
            ([x, 1.0, 2.0], Rapid),
            ([x, 1.0, -1.0], Feed),
            ([x, 1.0, 5.0], Rapid),
        ]
    };
    assert_eq!(path[0], ([0.0, 0.0, 5.0], Rapid));
    assert_eq!(path[1..5], hole(1.0));
    assert_eq!(path[5..9], hole(2.0));
}

#[test]
fn splines_keep_their_control_points() {
    let all = motions(
        "F60 G5 X3 Y0 I1 J1 P-1 Q1\nG5.1 X6 Y0 I1 J2\nG5.2 X7 Y1 P2\nX9 Y2 P1\nX9 Y0 P1\nG5.3\nM2",
    );
    let Shape::Spline(cubic) = &all[0].shape else {
        panic!("{all:?}")
    };
    assert_eq!(
        (cubic.degree, &cubic.control_mm[..]),
        (
            3,
            &[[0.0; 3], [1.0, 1.0, 0.0], [2.0, 1.0, 0.0], [3.0, 0.0, 0.0]][..]
        )
    );
    let Shape::Spline(quadratic) = &all[1].shape else {
        panic!("{all:?}")
    };
    assert_eq!(
        (quadratic.degree, quadratic.control_mm[1]),
        (2, [4.0, 2.0, 0.0])
    );
    let Shape::Spline(nurbs) = &all[2].shape else {
        panic!("{all:?}")
    };
    assert_eq!(
        (nurbs.degree, &nurbs.weights[..], &nurbs.knots[..]),
        (
            2,
            &[1.0, 2.0, 1.0, 1.0][..],
            &[0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0][..]
        )
    );
    assert!(fault("F60 G5.2 X7 Y1 P2\nG1 X1\nM2").contains("not complete"));
}

#[test]
fn an_exact_circle_as_nurbs_has_the_length_of_the_circle() {
    let weight = std::f64::consts::FRAC_1_SQRT_2;
    let text = format!(
        "F60 G6.2 P3 K0 X0 Y0 R1\nK0 X0 Y1 R{weight}\nK0 X1 Y1 R1\nG6.2 K1\nG6.2 K1\nG6.2 K1\nM2"
    );
    let length = motions(&text)[0].length_mm();
    assert!(
        (length - std::f64::consts::FRAC_PI_2).abs() < 1e-4,
        "{length}"
    );
}

#[test]
fn compensation_keeps_the_tool_beside_the_contour() {
    // A square of 10 mm, 2 mm tool: inside 8 mm apart, outside rounded corners.
    let inside = motions("F60 G41.1 D2\nG1 X5\nX10\nY10\nX0\nY0\nG40\nX-2\nM2");
    let ends: Vec<[f64; 2]> = inside
        .iter()
        .map(|motion| [motion.end_mm[0], motion.end_mm[1]])
        .collect();
    assert_eq!(
        ends,
        [
            [5.0, 1.0],
            [9.0, 1.0],
            [9.0, 9.0],
            [1.0, 9.0],
            [1.0, 0.0],
            [-2.0, 0.0]
        ]
    );
    let outside = motions("F60 G42.1 D2\nG1 X5\nX10\nY10\nX0\nY0\nG40\nX-2\nM2");
    assert_eq!(
        outside
            .iter()
            .filter(|motion| matches!(motion.shape, Shape::Arc { turns: 1, .. }))
            .count(),
        3
    );
    for pair in inside.windows(2).chain(outside.windows(2)) {
        assert_eq!(pair[0].end_mm, pair[1].start_mm);
    }
    assert!(fault("F60 G41.1 D2\nG1 X5\nX6\nX6 Y0.5\nX0\nM2").contains("does not fit"));
    assert!(fault("F60 G41.1 D2\nG1 X0.5\nM2").contains("entry"));
    assert!(fault("F60 G41.1 D2\nG1 X5\nX10\nG3 X10.5 Y0.5 R0.5\nM2").contains("must exceed"));
    assert!(fault("F60 G41 D3\nG1 X5\nM2").contains("not in the tool table"));
}

#[test]
fn printers_push_filament_and_know_macros() {
    let text = "START_PRINT BED=60\nM82\nG28 ; home\nG1 X10 E1 F600\nG92 E0\nG1 X20 E0.5\nM83\nG1 E-2\nM117 Done: 50%\nM104 S0";
    let reader = Reader::from_text("part.gcode", text, Settings::default()).unwrap();
    assert_eq!(reader.dialect().0, Dialect::Printer);
    let steps: Vec<Canon> = reader.map(Result::unwrap).collect();
    let pushed: Vec<f64> = steps
        .iter()
        .filter_map(|step| {
            if let Canon::Motion(motion) = step {
                Some(motion.others.extruder_mm)
            } else {
                None
            }
        })
        .collect();
    assert_eq!(pushed, [1.0, 0.5, -2.0]);
    assert!(steps.iter().any(
        |step| matches!(step, Canon::Event(event) if event.kind == EventKind::Message { text: "M117 Done: 50%".into() })
    ));
}

#[test]
fn rotary_and_further_axes_are_kept() {
    let all = motions("F60 G1 X1 A90\nG1 A180 F360\nG0 U5\nM2");
    let axes = |n: usize| **all[n].others.axes.as_ref().unwrap();
    assert_eq!(axes(0)[1][0], 90.0);
    // Degrees a second where nothing else moves.
    assert_eq!(
        (axes(1)[0][0], axes(1)[1][0], all[1].feed_mm_s),
        (90.0, 180.0, 6.0)
    );
    assert_eq!(axes(2)[1][3], 5.0);
}

#[test]
fn canonical_steps_are_json() {
    let steps = motions("F60 G2 X2 I1\nM2");
    let json = serde_json::to_string(&Canon::Motion(steps[0].clone())).unwrap();
    assert_eq!(
        json,
        r#"{"motion":{"line":1,"kind":"feed","start_mm":[0.0,0.0,0.0],"end_mm":[2.0,0.0,0.0],"shape":{"arc":{"plane":"xy","center_mm":[1.0,0.0,0.0],"turns":-1}},"feed_mm_s":1.0,"corner":{"continuous":{"tolerance_mm":null}}}}"#
    );
}

#[test]
fn a_blank_ends_the_number_of_a_parameter_in_a_message() {
    let (steps, _) = read(
        "#1=2 #12=3\nF1 G1 X1\n(print,a #1 2 #12,#<_metric>x)\nM2",
        Settings::default(),
    );
    let text = "a 2.000000 2 3.000000,1.000000x".to_owned();
    assert!(
        steps
            .iter()
            .any(|step| matches!(step, Canon::Event(event) if event.kind == EventKind::Message { text: text.clone() }))
    );
}
