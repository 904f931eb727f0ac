//! Programs for lathes of Fanuc and Haas: recognised, and read as these controls do in G-code
//! system A. The cycles' geometry is held by `oracle_lathe_cycles.rs` and
//! `property_gcode_fanuc_lathe.rs`.

use feedwright_gcode::canon::{Canon, EventKind, Motion, MotionKind};
use feedwright_gcode::{CheckError, Dialect, Reader, Settings, Summary, summarize};

const HEAD: &str = "O0001\nG21 G97 G99 S1000 M3\nT0101\n";

fn reader(text: &str, dialect: Option<Dialect>) -> Reader {
    Reader::from_text(
        "part.nc",
        text,
        Settings {
            dialect,
            ..Settings::default()
        },
    )
    .expect("it is a program")
}

fn steps(text: &str) -> Vec<Canon> {
    reader(text, Some(Dialect::FanucLathe))
        .map(|step| step.unwrap_or_else(|fault| panic!("{text}: {fault:?}")))
        .collect()
}

fn motions(text: &str) -> Vec<Motion> {
    let motion = |step| {
        if let Canon::Motion(motion) = step {
            Some(motion)
        } else {
            None
        }
    };
    steps(text).into_iter().filter_map(motion).collect()
}

/// Ends of the motions behind [`HEAD`]: X is a radius.
fn ends(lines: &str) -> Vec<[f64; 2]> {
    motions(&format!("{HEAD}{lines}\nM30\n"))
        .iter()
        .map(|motion| [motion.end_mm[0], motion.end_mm[2]])
        .collect()
}

fn faults(lines: &str) -> Vec<String> {
    match summarize(reader(
        &format!("{HEAD}{lines}\nM30\n"),
        Some(Dialect::FanucLathe),
    )) {
        Err(CheckError::Faults(faults)) => faults
            .into_iter()
            .map(|fault| {
                format!(
                    "{}: {} hint: {}",
                    fault.line,
                    fault.message,
                    fault.hint.unwrap_or_default()
                )
            })
            .collect(),
        other => panic!("{lines:?} gave {other:?}"),
    }
}

fn summary(text: &str, dialect: Option<Dialect>) -> Summary {
    summarize(reader(text, dialect)).unwrap_or_else(|error| panic!("{text}: {error:?}"))
}

#[test]
fn a_lathe_program_is_recognised_and_its_thread_is_no_offset() {
    // What was cut wrongly: the thread became an offset, the turning cycle a rapid through the
    // part.
    let text = "O0012 (BOLT)\nG50 S2500\nT0101\nG96 S180 M3\nG0 X32. Z2.\nG99 G90 X28. Z-30. F0.25\nG97 S500\nG92 X29.4 Z-30. F1.5\nM30\n";
    for dialect in [None, Some(Dialect::Fanuc), Some(Dialect::FanucLathe)] {
        let summary = summary(text, dialect);
        assert_eq!(summary.dialect.0, Dialect::FanucLathe, "{dialect:?}");
        assert_eq!(summary.box_mm, [[0.0, 0.0, -30.0], [16.0, 0.0, 2.0]]);
    }
    assert_eq!(
        summary(text, Some(Dialect::Haas)).dialect.0,
        Dialect::HaasLathe
    );
    // Without its O-number, too.
    assert_eq!(summary(&text[6..], None).dialect.0, Dialect::FanucLathe);
}

#[test]
fn a_program_that_may_be_for_either_machine_is_asked_about() {
    let error = Reader::from_text(
        "part.nc",
        "O1\nG50 S2500\nG43 H1 Z50.\n",
        Settings::default(),
    )
    .unwrap_err();
    let text = error.to_string();
    assert!(
        text.contains("line 2 (G50 S") && text.contains("line 3 (G43"),
        "{text}"
    );
    assert!(
        miette::Diagnostic::help(&error)
            .unwrap()
            .to_string()
            .contains("--dialect fanuc-lathe")
    );
    let unsure = summary("O1\nG1 X5. Z-2. F100.\nM30\n", None);
    assert_eq!(unsure.dialect.0, Dialect::FanucMill);
    assert!(
        unsure.warnings[0].message.contains("mill or for a lathe"),
        "{:?}",
        unsure.warnings
    );
    assert_eq!(unsure.warnings[0].line, 2);
    let few = summary(
        "O1\nT0101 M6\nG90 G54 G0 X5. Y2.\nG1 W-1. F100.\nM30\n",
        None,
    );
    assert_eq!(few.dialect.0, Dialect::FanucMill);
    assert!(
        few.warnings[0].message.contains("a lathe (line 4: U or W") && few.warnings[0].line == 4,
        "{:?}",
        few.warnings
    );
    // Other G-code systems have G90 as a mode.
    let found = faults("G90\nG0 X5.");
    assert!(
        found[0].contains("4: G90 without X and Z: in G-code system A it is a cycle"),
        "{found:?}"
    );
    assert!(
        faults("G90 G94")[0].contains("are cycles in G-code system A"),
        "{:?}",
        faults("G90 G94")
    );
    assert!(
        faults("G92 S2500")[0].contains("G92 without X and Z"),
        "{:?}",
        faults("G92 S2500")
    );
    assert!(
        faults("G90 G0 X50. Z2.")[0].contains("G90 and G0 exclude each other"),
        "{:?}",
        faults("G90 G0 X50. Z2.")
    );
}

#[test]
fn x_is_a_diameter_and_u_and_w_are_distances() {
    assert_eq!(
        ends("G0 X50. Z2.\nG1 U-2. W-5. F0.2\nU4.\nX40. W-1.\nG28 U0 W0"),
        [
            [25.0, 2.0],
            [24.0, -3.0],
            [26.0, -3.0],
            [20.0, -4.0],
            [0.0, 0.0]
        ]
    );
    let found = faults("G0 X50. U2.");
    assert!(found[0].contains("U and X on one line"), "{found:?}");
    // An arc: R and I are radii; G3 is an outer corner.
    let arc = motions(&format!("{HEAD}G0 X20. Z0\nG3 X30. Z-5. R5. F0.1\nM30\n"))
        .pop()
        .unwrap();
    let feedwright_gcode::canon::Shape::Arc {
        center_mm, turns, ..
    } = arc.shape
    else {
        panic!("{arc:?}")
    };
    assert_eq!((center_mm, turns), ([10.0, 0.0, -5.0], 1));
    assert_eq!(ends("G0 X20. Z0\nG3 X30. Z-5. I0 K-5. F0.1").len(), 2);
}

#[test]
fn feeds_are_per_revolution_and_g98_makes_them_per_minute() {
    let feeds = |lines: &str| -> Vec<f64> {
        let feed = |motion: &Motion| motion.kind == MotionKind::Feed;
        motions(&format!("{HEAD}{lines}\nM30\n"))
            .iter()
            .filter(|m| feed(m))
            .map(|motion| motion.feed_mm_s)
            .collect()
    };
    assert_eq!(feeds("G99 G1 Z-5. F0.24\nG98 Z-6. F120."), [4.0, 2.0]);
    let text = "O1\nT0101\nG50 S3000\nG97 S1000 M3\nG1 Z-5. F200.\nM30\n";
    let warned = summary(text, None).warnings;
    assert!(
        warned[0].message.contains("200 mm per revolution") && warned[0].line == 5,
        "{warned:?}"
    );
}

#[test]
fn a_surface_speed_turns_the_spindle_faster_towards_the_axis_up_to_g50_s() {
    let text = "O1\nG21 G99\nG50 S2000\nT0101\nG96 S200 M3\nG0 X100. Z0\nG1 X-1. F0.2\nM30\n";
    let feeds: Vec<Motion> = motions(text)
        .into_iter()
        .filter(|motion| motion.kind == MotionKind::Feed)
        .collect();
    let rpm = |motion: &Motion| motion.feed_mm_s * 60.0 / 0.2;
    for motion in &feeds {
        let middle = 0.5 * (motion.start_mm[0] + motion.end_mm[0]).abs();
        let exact = (200_000.0 / (std::f64::consts::TAU * middle)).min(2000.0);
        assert!(
            (rpm(motion) / exact - 1.0).abs() < 0.03,
            "{motion:?}: {} against {exact}",
            rpm(motion)
        );
    }
    assert!(feeds.windows(2).all(|pair| pair[0].end_mm == pair[1].start_mm && rpm(&pair[1]) / rpm(&pair[0]) < 1.051));
    assert_eq!(
        (feeds[0].start_mm[0], feeds.last().unwrap().end_mm[0]),
        (50.0, -0.5)
    );
    assert!((rpm(feeds.last().unwrap()) - 2000.0).abs() < 1e-9);
    // G97 alone goes on as fast as the spindle turns, and G96 alone as before.
    let after =
        "O1\nG99\nG50 S2000\nG96 S200 M3\nG0 X100. Z0\nG97\nG1 Z-1. F0.3\nG96\nG1 Z-2.\nM30\n";
    let rpm = 200_000.0 / (std::f64::consts::TAU * 50.0);
    for motion in motions(after)
        .iter()
        .filter(|motion| motion.kind == MotionKind::Feed)
    {
        assert!(
            (motion.feed_mm_s - 0.3 * rpm / 60.0).abs() < 1e-9,
            "{motion:?}"
        );
    }
    // S of G50 limits the spindle speed and S of G96 is a surface speed: neither is a speed event.
    let speeds = |step: &Canon| matches!(step, Canon::Event(event) if matches!(event.kind, EventKind::SpindleSpeed { .. }));
    assert!(!steps(text).iter().any(speeds));
}

#[test]
fn a_turret_takes_its_tool_and_offset_together() {
    let tools: Vec<u32> = steps("O1\nT0101\nT0100\nT0303\nT1212\nT303\nM30\n")
        .into_iter()
        .filter_map(|step| match step {
            Canon::Event(event) => match event.kind {
                EventKind::ToolSelect { tool } => Some(tool),
                _ => None,
            },
            Canon::Motion(_) => None,
        })
        .collect();
    assert_eq!(tools, [1, 3, 12, 3]);
}

#[test]
fn a_position_may_be_named_or_shifted() {
    assert_eq!(
        ends("G0 X50. Z2.\nG50 X60. Z12.\nG0 X62. Z12."),
        [[25.0, 2.0], [26.0, 2.0]]
    );
    assert_eq!(
        ends("G0 X50. Z2.\nG50 U2. W3.\nG0 X52. Z6."),
        [[25.0, 2.0], [25.0, 3.0]]
    );
}

#[test]
fn drilling_goes_along_z_from_a_level_that_differs_between_controls() {
    let drill = |dialect| {
        let text = "O1\nG99 G97 S500 M3\nG0 X0 Z5.\nG83 Z-20. R-3. Q8000 F0.1\nG80\nM30\n"
            .replace("8000", "8.");
        let steps: Vec<Canon> = reader(&text, Some(dialect)).map(Result::unwrap).collect();
        steps
            .into_iter()
            .filter_map(|step| {
                if let Canon::Motion(motion) = step {
                    Some(motion)
                } else {
                    None
                }
            })
            .filter(|motion| motion.kind == MotionKind::Feed)
            .map(|motion| motion.end_mm[2])
            .collect::<Vec<f64>>()
    };
    assert_eq!(drill(Dialect::FanucLathe), [-6.0, -14.0, -20.0]);
    assert_eq!(drill(Dialect::HaasLathe), [-11.0, -19.0, -20.0]);
    let guessed = summary(
        "O1\nT0101\nG99 G97 S500 M3\nG0 X0 Z5.\nG83 Z-20. R-3. F0.1\nM30\n",
        None,
    );
    assert!(
        guessed
            .warnings
            .iter()
            .any(|warning| warning.code == "gcode::drilling_level"),
        "{:?}",
        guessed.warnings
    );
}

#[test]
fn nose_compensation_reads_the_contour_and_says_so() {
    let text = format!("{HEAD}G0 G42 X20. Z2.\nG1 Z-10. F0.1\nG40 G0 X30.\nM30\n");
    let summary = summary(&text, Some(Dialect::FanucLathe));
    assert_eq!(summary.box_mm[1], [15.0, 0.0, 2.0]);
    assert!(
        summary.warnings[0]
            .message
            .contains("the programmed contour"),
        "{:?}",
        summary.warnings
    );
}

#[test]
fn a_pocket_is_cut_level_by_level_where_the_first_block_has_x_and_z() {
    let profile = "G1 Z-10.\nX30. Z-15.\nZ-20.\nX40. Z-25.\nN2 X62.";
    let lines = |first: &str| {
        format!("G0 X62. Z2.\nG71 U4. R0.5\nG71 P1 Q2 U0.4 W0.1 F0.2\nN1 G0 {first}\n{profile}")
    };
    let cut = ends(&lines("X40. Z2."));
    // Nothing is cut below the profile, which lies 0.2 mm higher and 0.1 mm further.
    assert!(cut.iter().all(|[x, _]| *x >= 15.2 - 1e-9));
    assert!(cut.iter().any(|[x, _]| (*x - 15.2).abs() < 1e-9));
    let found = faults(&lines("X40."));
    assert!(
        found[0].contains("line 9: X turns back") && found[0].contains("W0"),
        "{found:?}"
    );
}

#[test]
fn what_is_missing_or_wrong_is_reported_by_name() {
    for (lines, says) in [
        (
            "G71 P1 Q2 U0.4 F0.2\nN1 G0 X5.\nN2 G1 Z-5.",
            "depth of a pass of G71 is nowhere",
        ),
        (
            "G71 U2. R.5\nG71 P1 Q3 F0.2\nN1 G0 X5.\nN2 G1 Z-5.",
            "Q3: there is no block N3",
        ),
        (
            "G71 U2. R.5\nG71 P1 Q2 F0.2\nG4 X1.\nN1 G0 X5.\nN2 G1 Z-5.",
            "blocks between G71 and its profile",
        ),
        (
            "G71 U2. R.5\nG71 P2 Q1 F0.2\nN1 G0 X5.\nN2 G1 Z-5.",
            "Q1 (line 6) stands before P2",
        ),
        (
            "G71 U2. R.5\nG71 P1 Q2 F0.2\nN1 G0 X5.\nM98 P1\nN2 G1 Z-5.",
            "M98 stands inside the profile",
        ),
        ("G71 U-2. R.5", "must be above 0"),
        (
            "G0 X50. Z2.\nG71 U0.0001 R.5\nG71 P1 Q2 F0.2\nN1 G0 X5.\nN2 G1 Z-5.",
            "passes; the limit is 10000",
        ),
        (
            "G0 X50. Z2.\nG71 U2. R.5\nG71 P1 Q2 F0.2\nN1 G0 X5.\nN2 G1 Z-5.\nG70 P1 Q2\nN1 G0 X5.\nN2 G1 Z-5.",
            "P1 is on line 7 and on line 10",
        ),
        ("G71", "neither P and Q"),
        (
            "G73 P1 Q2 F0.2\nN1 G0 X5.\nN2 G1 Z-5.",
            "G73 has no first block",
        ),
        ("G73 U2. W2.", "R (number of passes) is missing"),
        (
            "G0 X50. Z2.\nG75 X40. Z-10. P1000 F0.1",
            "Q (step from groove to groove) is missing",
        ),
        (
            "G0 X50. Z2.\nG75 X40. Z-10. P1 Q1 F0.1",
            "pecks in one block",
        ),
        ("G76 X27. Z-30. P1300 Q400 F2.", "G76 has no first block"),
        (
            "G0 X32. Z2.\nG76 P020060 Q100 R0.05\nG76 X27. Z-30. Q400 F2.",
            "P (height of the thread) above 0 mm is missing",
        ),
        (
            "G0 X32. Z2.\nM5\nG92 X27. Z-30. F2.",
            "needs a turning spindle",
        ),
        ("G0 X32. Z2.\nG90 X28. F0.2", "Z or W is missing for G90"),
        ("G0 X32. Z2.\nG90 X28. Z2. F0.2", "G90 cuts nothing"),
        ("G68", "G68 (a rotation"),
        ("G53 U5.", "U, V and W are not read with G53"),
        ("G50 S0", "a bound of 0 rev/min"),
        ("G70 P1 Q2", "P1: there is no block N1"),
    ] {
        let found = faults(lines);
        assert!(found[0].contains(says), "{lines}: {found:?}");
        assert!(
            !found[0].ends_with("hint: ") || found[0].contains("stands before"),
            "{found:?}"
        );
    }
}
