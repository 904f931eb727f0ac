//! What programs for Fanuc and Haas mean by words that LinuxCNC reads otherwise: repeats,
//! milliseconds, jumps, smoothing.

use feedwright_gcode::canon::{Canon, EventKind, Motion, MotionKind};
use feedwright_gcode::{CheckError, Dialect, Increment, Reader, Settings, summarize};

fn reader(text: &str, dialect: Dialect) -> Reader {
    let settings = Settings {
        dialect: Some(dialect),
        ..Settings::default()
    };
    Reader::from_text("part.nc", text, settings).expect("it is a program")
}

fn steps(text: &str, dialect: Dialect) -> Vec<Canon> {
    reader(text, dialect)
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
    steps(text, Dialect::FanucMill)
        .into_iter()
        .filter_map(motion)
        .collect()
}

fn dwells(text: &str, dialect: Dialect) -> Vec<f64> {
    let dwell = |step| match step {
        Canon::Event(event) => match event.kind {
            EventKind::Dwell { seconds } => Some(seconds),
            _ => None,
        },
        Canon::Motion(_) => None,
    };
    steps(text, dialect).into_iter().filter_map(dwell).collect()
}

fn faults(text: &str) -> Vec<String> {
    match summarize(reader(text, Dialect::FanucMill)) {
        Err(CheckError::Faults(faults)) => faults
            .into_iter()
            .map(|fault| {
                format!(
                    "{}: {} {}",
                    fault.line,
                    fault.message,
                    fault.hint.unwrap_or_default()
                )
            })
            .collect(),
        other => panic!("{text:?} gave {other:?}"),
    }
}

#[test]
fn the_repeats_of_m98_stand_before_its_number() {
    let subroutines = "M30\nO0100\nG91 G1 X5.\nM99\nO30200\nG91 G1 Y1\nM99\n";
    let ends = |call: &str| {
        let last = motions(&format!("O0001\nG21 G90 F100\n{call}\n{subroutines}"))
            .pop()
            .unwrap();
        [last.end_mm[0], last.end_mm[1]]
    };
    assert_eq!(ends("M98 P100"), [5.0, 0.0]);
    assert_eq!(ends("M98 P0100 L2"), [10.0, 0.0]);
    assert_eq!(ends("M98 P30100"), [15.0, 0.0]);
    assert_eq!(ends("M98 P00040100"), [20.0, 0.0]);
    // Haas has numbers of five digits.
    assert_eq!(ends("M98 P30200"), [0.0, 1.0]);
    let missing = faults("O0001\nG21 G90 F100\nG1 X1\nM98 P30300\nM30\n");
    assert!(
        missing[0].starts_with("4: the subroutine O30300 is defined nowhere"),
        "{missing:?}"
    );
}

#[test]
fn a_dwell_without_a_decimal_point_is_milliseconds() {
    let text = "O0001\nF100 G4 P500\nG4 P1.5\nG82 X1 Z-1 R1 P250\nG82 X2 Z-1 R1 P.25\nG80\nM30\n";
    assert_eq!(dwells(text, Dialect::FanucMill), [0.5, 1.5, 0.25, 0.25]);
    assert_eq!(dwells("F100 G4 P2\nG1 X1\nM2\n", Dialect::LinuxCnc), [2.0]);
    let text = "O7\nF100 G1 X1\nG4 X2.\nG04 U.5\nG04 P500\nM30\n";
    assert_eq!(dwells(text, Dialect::FanucMill), [2.0, 0.5, 0.5]);
    let none = faults("O0001\nF100 G1 X1\nG4\nM30\n");
    assert!(none[0].contains("P with milliseconds"), "{none:?}");
}

#[test]
fn a_jump_that_leads_elsewhere_is_refused_and_not_passed_over() {
    let text = "O0001\nG21 G90 F100\nG1 X1.\nM96 P10\nM198 P50\nM98 P0100 H20\nM98 P100\nM97 P77\nM97\nM30\nO0100\nM99 P7\n";
    let found = faults(text);
    for (line, says) in [
        (4, "M96 jumps"),
        (5, "M198 calls a program on another device"),
        (6, "H has no meaning"),
        (8, "M97 P77: there is no block N77"),
        (9, "M97 calls a block, but P"),
        (12, "M99 P7: there is no block N7"),
    ] {
        assert!(
            found
                .iter()
                .any(|fault| fault.starts_with(&format!("{line}: {says}"))),
            "{line} {says}: {found:?}"
        );
    }
}

#[test]
fn blocks_of_the_program_are_called_by_m97_and_returned_to_by_m99_p() {
    let xs = |text: &str| -> Vec<f64> {
        motions(text)
            .iter()
            .map(|motion| motion.end_mm[0])
            .collect()
    };
    let local = "O0001\nG21 G90 F100\nM97 P100 L2\nG90 G1 X20.\nM30\nN100 G91 G1 X5.\nM99\n";
    assert_eq!(xs(local), [5.0, 10.0, 20.0]);
    let elsewhere =
        "O0001\nG21 G90 F100\nM98 P100\nG1 X5.\nN7 G1 X7.\nM30\nO0100\nG1 X1.\nM99 P7\n";
    assert_eq!(xs(elsewhere), [1.0, 7.0]);
}

#[test]
fn short_program_numbers_and_colons_are_those_of_fanuc() {
    // Seconds on LinuxCNC, milliseconds here: eight minutes against half a second.
    for number in ["O1", "O999 (PART)", ":1000", "O0500;x"] {
        let text = format!("{number}\nG90 F100 G1 X1.\nG04 P500\nM30\n");
        let reader = Reader::from_text("part.nc", text, Settings::default()).unwrap();
        assert_eq!(reader.dialect().0, Dialect::FanucMill, "{number}");
        let dwell = reader.filter_map(Result::ok).find_map(|step| match step {
            Canon::Event(event) => {
                if let EventKind::Dwell { seconds } = event.kind {
                    Some(seconds)
                } else {
                    None
                }
            }
            Canon::Motion(_) => None,
        });
        assert_eq!(dwell, Some(0.5), "{number}");
    }
    let called = motions(":1\nG21 G90 F100\nM98 P2\nM30\n:2\nG1 X5.\nM99\n");
    assert_eq!(called[0].end_mm[0], 5.0);
    let linuxcnc = Reader::from_text(
        "part.ngc",
        "o100 sub\nG1 X1\no100 endsub\nM2\n",
        Settings::default(),
    )
    .unwrap();
    assert_eq!(linuxcnc.dialect().0, Dialect::LinuxCnc);
}

#[test]
fn lengths_without_a_point_are_increments_where_the_control_counts_so() {
    let text = "O1\nG21 G90 G17 F100\nG1 X10000 Y5.\nG2 X20000 I5000 J0\nG20 G1 X10000 Y-1.\nG4 X2000\nM30\n";
    let read = |increment: Option<&str>| {
        let increment = increment.map(|name| Increment::named(name).unwrap());
        let settings = Settings {
            dialect: Some(Dialect::FanucMill),
            increment,
            ..Settings::default()
        };
        Reader::from_text("part.nc", text, settings).unwrap()
    };
    let ends = |increment: &str| -> Vec<[f64; 2]> {
        let motion = |step| {
            if let Canon::Motion(motion) = step {
                Some(motion)
            } else {
                None
            }
        };
        read(Some(increment))
            .filter_map(|step| motion(step.unwrap()))
            .map(|m| [m.end_mm[0], m.end_mm[1]])
            .collect()
    };
    assert_eq!(ends("0.001mm"), [[10.0, 5.0], [20.0, 5.0], [25.4, -25.4]]);
    assert_eq!(ends("0.0001inch"), ends("0.001mm"));
    assert_eq!(ends("0.0001 MM")[0], [1.0, 5.0]);
    assert!(
        Increment::named("1mm")
            .unwrap_err()
            .to_string()
            .contains("'1mm' is no least input increment")
    );
    // Computed values have their unit.
    let settings = Settings {
        dialect: Some(Dialect::FanucMill),
        increment: Some(Increment::named("0.001mm").unwrap()),
        ..Settings::default()
    };
    let computed = Reader::from_text(
        "part.nc",
        "O1\nG21 G90 G17 F100\n#1=7\nG1 X#1 Y[2*3]\nM30\n",
        settings,
    )
    .unwrap();
    let Some(Ok(Canon::Motion(motion))) = computed.last_motion() else {
        panic!("no motion")
    };
    assert_eq!(motion.end_mm, [7.0, 6.0, 0.0]);
}

/// The last motion of a program.
trait LastMotion {
    fn last_motion(self) -> Option<Result<Canon, feedwright_gcode::Diagnostic>>;
}

impl LastMotion for Reader {
    fn last_motion(self) -> Option<Result<Canon, feedwright_gcode::Diagnostic>> {
        self.filter(|step| matches!(step, Ok(Canon::Motion(_)) | Err(_)))
            .last()
    }
}

#[test]
fn a_program_without_a_decimal_point_is_warned_of() {
    let warnings = |lines: &str| -> Vec<String> {
        let summary = summarize(reader(
            &format!("O1\nG21 G90 G17 F100\n{lines}\nM30\n"),
            Dialect::FanucMill,
        ))
        .unwrap();
        let shown = |warning: &feedwright_gcode::Diagnostic| {
            format!(
                "{}: {} {}",
                warning.line,
                warning.message,
                warning.hint.clone().unwrap_or_default()
            )
        };
        summary
            .warnings
            .iter()
            .filter(|warning| warning.code == "gcode::increment")
            .map(shown)
            .collect()
    };
    let none = warnings("G1 X10000 Y0");
    assert!(
        none[0].starts_with(
            "3: no length of the program has a decimal point: X10000 is read as 10000 and not as 10"
        ),
        "{none:?}"
    );
    assert!(none[0].contains("--increment 0.001mm"));
    let some = warnings("G1 X10. Y0\nY50\nX7");
    assert!(
        some[0].starts_with("4: 2 lengths have no decimal point; the first, Y50, is read as 50"),
        "{some:?}"
    );
    assert!(warnings("G1 X10. Y0").is_empty());
    assert!(warnings("G81 X10. Y0. Z-5. R2. K3\nG80\nG10 L2 P1 X0 Y0").is_empty());
}

#[test]
fn cycles_repeat_by_k_peck_less_and_less_and_start_the_tap() {
    let feeds = |lines: &str| -> Vec<[f64; 3]> {
        let text = format!("O1\nG21 G90 G17 F100 S500\n{lines}\nG80\nM30\n");
        motions(&text)
            .iter()
            .filter(|motion| motion.kind == MotionKind::Feed)
            .map(|motion| motion.end_mm)
            .collect()
    };
    let holes = feeds("G0 Z10.\nG91 G81 X5. Z-7. R-8. K3");
    assert_eq!(
        holes.iter().map(|end| end[0]).collect::<Vec<_>>(),
        [5.0, 10.0, 15.0]
    );
    assert_eq!(feeds("G0 Z10.\nG81 X5. Z-7. R2. K0\nX9.").len(), 1);
    assert_eq!(feeds("G0 Z10.\nG81 X5. Z-7. R2. L0\nX9. L2").len(), 2);
    let depths: Vec<f64> = feeds("G0 Z10.\nG83 X5. Z-20. R0. I8. J3. K2.")
        .iter()
        .map(|end| end[2])
        .collect();
    assert_eq!(depths, [-8.0, -13.0, -15.0, -17.0, -19.0, -20.0]);
    assert_eq!(feeds("G0 Z10.\nM29 S500\nG84 X5. Z-20. R2. F500").len(), 2);
    assert_eq!(feeds("G0 Z10.\nG82 X5. Z-20. R2.\nX6.").len(), 2);
    let bad = faults("O1\nG21 G90 F100\nG83 X1. Z-5. R1. I1. K0\nM30\n");
    assert!(
        bad[0].contains("must be above 0: I is 1 mm, K 0 mm"),
        "{bad:?}"
    );
    let many = faults("O1\nG21 G90 F100\nG83 X1. Z-500. R1. I.002 J.001 K0.00001\nM30\n");
    assert!(many[0].contains("it may have 100000"), "{many:?}");
}

#[test]
fn drilling_returns_to_the_level_where_it_began_unless_g99_is_there() {
    let heights = |line: &str| -> Vec<f64> {
        let text = format!("O1\nG21 G90 G17 F100\nG0 Z20.\n{line} X5. Z-3. R2.\nX9.\nG80\nM30\n");
        motions(&text)
            .iter()
            .map(|motion| motion.end_mm[2])
            .collect()
    };
    let [returns, stays] = [
        [20.0, 20.0, 2.0, -3.0, 20.0, 20.0, 2.0, -3.0, 20.0].as_slice(),
        &[20.0, 20.0, 2.0, -3.0, 2.0, 2.0, -3.0, 2.0],
    ];
    assert_eq!(heights("G81"), returns);
    assert_eq!(heights("G98 G81"), returns);
    assert_eq!(heights("G99 G81"), stays);
}

#[test]
fn the_spindle_is_bounded_by_g50_s_and_g92_s() {
    for line in ["G50 S2500", "G92 S2500"] {
        let text = format!("O1\nG21 G90 G17 G54\nS300 M3\n{line}\nG95 G1 X30. F1.\nM30\n");
        assert_eq!(motions(&text)[0].feed_mm_s, 5.0, "{line}");
    }
    // Alone it ends scaling.
    assert_eq!(
        motions("O1\nG21 G90 G40 G49 G50 G80 F100\nG1 X3.\nM30\n").len(),
        1
    );
}

#[test]
fn g53_is_a_rapid_by_itself() {
    let read = motions("O1\nG21 G90 G17 F100\nG1 X5.\nG53 Z-7.\nX6.\nM30\n");
    assert_eq!(
        read.iter().map(|m| m.kind).collect::<Vec<_>>(),
        [MotionKind::Feed, MotionKind::Rapid, MotionKind::Feed]
    );
}

#[test]
fn further_systems_have_offsets_of_their_own() {
    let text = "O1\nG21 G90 G17 F100\nG10 L20 P3 X10. Y1.\nG54.1 P3 G1 X1. Y0.\nG154 P3 X2.\nG154 P4 X2.\nG54 X2.\nM30\n";
    let xs: Vec<f64> = motions(text)
        .iter()
        .map(|motion| motion.end_mm[0])
        .collect();
    assert_eq!(xs, [11.0, 12.0, 2.0]);
    let summary = summarize(reader(text, Dialect::FanucMill)).unwrap();
    assert!(
        summary.warnings[0]
            .message
            .contains("G154 P4 are in the control"),
        "{:?}",
        summary.warnings
    );
    assert!(
        faults("O1\nG90 G154\nM30\n")[0].contains("P (number of the coordinate system) is missing")
    );
    assert!(faults("O1\nG90 G10 L2 P0 X1.\nM30\n")[0].contains("the offset of all systems"));
}

#[test]
fn g68_turns_and_g16_is_polar() {
    let ends = |lines: &str| -> Vec<[f64; 2]> {
        motions(&format!("O1\nG21 G90 G17 F100\n{lines}\nM30\n"))
            .iter()
            .map(|m| [m.end_mm[0], m.end_mm[1]])
            .collect()
    };
    let near = |read: Vec<[f64; 2]>, wanted: &[[f64; 2]]| {
        assert_eq!(read.len(), wanted.len(), "{read:?}");
        for (read, wanted) in read.iter().zip(wanted) {
            assert!(
                (read[0] - wanted[0]).hypot(read[1] - wanted[1]) < 1e-12,
                "{read:?} {wanted:?}"
            );
        }
    };
    near(
        ends("G68 X10. Y0 R90.\nG1 X20. Y0.\nG91 X5.\nG90 G69\nX1. Y1."),
        &[[10.0, 10.0], [10.0, 15.0], [1.0, 1.0]],
    );
    near(
        ends("G0 X5. Y5.\nG68 R180.\nG1 X7. Y5."),
        &[[5.0, 5.0], [3.0, 5.0]],
    );
    near(
        ends("G16\nG1 X10. Y30.\nY90.\nG91 Y90.\nG90 G15 X1. Y2."),
        &[
            [10.0 * 0.75_f64.sqrt(), 5.0],
            [0.0, 10.0],
            [-10.0, 0.0],
            [1.0, 2.0],
        ],
    );
    // An arc turns with its centre.
    let arc =
        motions("O1\nG21 G90 G17 F100\nG68 X0 Y0 R90.\nG0 X10. Y0.\nG3 X0. Y10. I-10. J0.\nM30\n")
            .pop()
            .unwrap();
    assert!(
        (arc.end_mm[0] + 10.0).abs() < 1e-12
            && (arc.length_mm() - 5.0 * std::f64::consts::PI).abs() < 1e-9
    );
    for (lines, says) in [
        ("G68 X0 Y0", "R (angle in degrees) is missing"),
        ("G18 G68 X0 Y0 R5.", "G68 outside G17"),
        ("G68 X0 Y0 Z0 R5.", "G68 in space"),
        ("G16 G18", "G16 outside G17"),
        ("G16 G91 G1 X5.", "a radius in G91"),
        ("G16 G1 X5.", "Y (the angle) is missing"),
    ] {
        let found = faults(&format!("O1\nG21 G90 F100\n{lines}\nM30\n"));
        assert!(found[0].contains(says), "{lines}: {found:?}");
    }
}

#[test]
fn corners_are_rounded_and_cut_off() {
    let ends = |lines: &str| -> Vec<[f64; 2]> {
        motions(&format!("O1\nG21 G90 G17 F100\n{lines}\nM30\n"))
            .iter()
            .map(|m| [m.end_mm[0], m.end_mm[1]])
            .collect()
    };
    assert_eq!(
        ends("G1 X20.,R5.\nY20.,C3.\nX0"),
        [
            [15.0, 0.0],
            [20.0, 5.0],
            [20.0, 17.0],
            [17.0, 20.0],
            [0.0, 20.0]
        ]
    );
    // Distances count from the corner as it is programmed.
    assert_eq!(
        ends("G1 X20. ,R5. (round)\n(a comment)\nG91 Y20.")[2],
        [20.0, 20.0]
    );
    let rounded = motions("O1\nG21 G90 G17 F100\nG1 X20. ,R5. F200.\nY20. F50.\nM30\n");
    assert_eq!(
        rounded
            .iter()
            .map(|m| (m.line, m.feed_mm_s * 60.0))
            .collect::<Vec<_>>(),
        [(3, 200.0), (3, 200.0), (4, 50.0)]
    );
    assert!((rounded[1].length_mm() - 2.5 * std::f64::consts::PI).abs() < 1e-9);
    // Between a line and an arc.
    let line_to_arc = ends("G1 X20.,R2.\nG3 X30. Y10. I0 J10.");
    assert_eq!(
        line_to_arc.len(),
        2,
        "tangent: nothing to round {line_to_arc:?}"
    );
    for (lines, says) in [
        (
            "G1 X20.,R5.\nM30",
            "the corner `,R` of line 3 has no second side",
        ),
        ("G1 X20.,R5.\nG0 Y5.", "has no second side"),
        ("G1 X20.,R25.\nY50.", "`,R25` does not fit"),
        ("G1 X20.,C25.\nY50.", "`,C25` does not fit"),
        ("G0 X20.,C2.\nY50.", "stands on a rapid"),
        ("G1 X20.,C2.,R2.\nY50.", "already has a corner"),
        ("G1 X20.,R2.\nY50. Z5.", "leave the plane"),
        ("G1 X20.,A30.", "`,A` gives the angle"),
    ] {
        let found = faults(&format!("O1\nG21 G90 F100\n{lines}\nM30\n"));
        assert!(found[0].contains(says), "{lines}: {found:?}");
    }
}

#[test]
fn smoothing_is_left_out_with_a_warning() {
    let text =
        "O0001\nG21 G90 F100\nG05.1 Q1\nG08 P1\nN7 G187 P3 E0.01 (fine)\nG1 X1.\nG05 P0\nM30\n";
    let summary = summarize(reader(text, Dialect::FanucMill)).unwrap();
    let lines: Vec<u32> = summary
        .warnings
        .iter()
        .map(|warning| warning.line)
        .collect();
    assert_eq!(lines, [3, 4, 5, 7]);
    assert!(
        summary.warnings[2]
            .message
            .contains("`N7 G187 P3 E0.01 (fine)` sets how the control smooths")
    );
    assert_eq!(summary.motions, 1);
    // It may not hide a motion.
    let hidden = faults("O0001\nG21 G90 F100 G1 X1\nG187 P1 G1 X2\nM30\n");
    assert!(
        hidden[0].contains("G187 (the smoothness of Haas"),
        "{hidden:?}"
    );
}

#[test]
fn a_code_that_only_linuxcnc_has_is_named_as_such() {
    let found = faults("O1\nG21 G90 G17 F100\nG42.1 D4 G1 X5. Y0\nM30\n");
    assert!(
        found[0].starts_with("3: G42.1 is a G-code of LinuxCNC")
            && found[0].contains("--dialect linuxcnc"),
        "{found:?}"
    );
}

#[test]
fn codes_of_other_controls_are_refused_by_what_they_do() {
    for (code, what) in [
        ("G12 I5.", "pocket"),
        ("G51 X0 Y0 P2", "scaling"),
        ("G51.1 X0", "mirror"),
        ("G65 P9810 X1", "O9810 is defined nowhere"),
        ("G66 P9810 X1", "macro"),
        ("G68.2 X0", "tilted"),
        ("G43.4 H1", "tilts"),
        ("G110", "coordinate system"),
        ("G71 U2. R0.5", "G71 of Fanuc and Haas"),
        ("G71 P10 Q20 U0.4 W0.1 F0.2", "G71 of Fanuc and Haas"),
        ("G72 P10 Q20 D2.", "G72 of Fanuc and Haas"),
        ("G70 P10 Q20", "G70 of Fanuc and Haas"),
    ] {
        let found = faults(&format!("O0001\nG21 G90 F100\nG1 X1\n{code}\nM30\n"));
        assert!(
            found[0].starts_with("4: ") && found[0].contains(what),
            "{code}: {found:?}"
        );
    }
}

#[test]
fn cycles_of_fanuc_are_distinguished_from_those_of_linuxcnc_by_their_words() {
    for cycle in ["G71 U2 R0.5", "G71 P10 Q20", "G72 Q20 W0.1"] {
        let text = format!("G18 G21 G90 F100\n{cycle}\nM2\n");
        let fault = reader(&text, Dialect::LinuxCnc)
            .find_map(Result::err)
            .unwrap();
        assert!(
            fault.message.contains("of Fanuc and Haas") && fault.hint.is_some(),
            "{cycle}: {}",
            fault.message
        );
    }
}

#[test]
fn levels_of_block_delete_and_distances_of_g10() {
    let ends: Vec<f64> = motions("O0001\nG21 G90 F100\n/2 G1 X5\n/G1 X7\nM30\n")
        .iter()
        .map(|m| m.end_mm[0])
        .collect();
    assert_eq!(ends, [5.0, 7.0]);
    // G91 adds to an offset; on LinuxCNC it does not.
    let text = "O0001\nG21 G90 F100\nG10 L2 P2 X5\nG91 G10 L2 P2 X1\nG90 G55 G1 X0\nM30\n";
    assert_eq!(motions(text)[0].end_mm[0], 6.0);
    let Canon::Motion(motion) = &steps(&text[6..], Dialect::LinuxCnc)[0] else {
        panic!("no motion")
    };
    assert_eq!(motion.end_mm[0], 1.0);
}
