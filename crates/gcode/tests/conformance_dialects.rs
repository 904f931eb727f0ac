//! Programs of other controls, firmware and post-processors: what is theirs is read, one program
//! for each.
use feedwright_gcode::canon::{Canon, Motion, Shape};
use feedwright_gcode::{Diagnostic, Dialect, Reader, Settings};

/// Ends of the motions, faults and warnings of a program.
fn read(text: &str, dialect: Option<Dialect>) -> (Vec<Motion>, Vec<Diagnostic>, Vec<Diagnostic>) {
    let settings = Settings {
        dialect,
        ..Settings::default()
    };
    let mut reader = Reader::from_text("part.nc", text, settings).unwrap();
    let (mut motions, mut faults) = (Vec::new(), Vec::new());
    for step in reader.by_ref() {
        match step {
            Ok(Canon::Motion(motion)) => motions.push(motion),
            Ok(Canon::Event(_)) => {}
            Err(fault) => faults.push(fault),
        }
    }
    let warnings = reader.warnings().to_vec();
    (motions, faults, warnings)
}

#[track_caller]
fn ends(text: &str, dialect: Option<Dialect>) -> Vec<[f64; 3]> {
    let (motions, faults, _) = read(text, dialect);
    assert!(faults.is_empty(), "{text}{faults:?}");
    motions.iter().map(|motion| motion.end_mm).collect()
}

#[test]
fn r_may_be_short_by_half_a_tenth_of_a_thousandth_of_an_inch() {
    assert_eq!(
        ends("G21 F100\nG2 X10 Y0 R4.99875\nM2\n", None),
        [[10.0, 0.0, 0.0]]
    );
    assert_eq!(read("G21 F100\nG2 X10 Y0 R4.9986\nM2\n", None).1.len(), 1);
    assert_eq!(
        ends("G20 F100\nG2 X10 Y0 R4.99996\nM2\n", None),
        [[254.0, 0.0, 0.0]]
    );
}

#[test]
fn the_first_spindle_may_be_named() {
    assert_eq!(
        ends("M3 S100 $0\nG33.1 Z-5 K1 $0\nM5 $-1\nM2\n", None),
        [[0.0, 0.0, -5.0], [0.0; 3]]
    );
    assert!(
        read("M3 S100 $1\nG0 X1\nM2\n", None).1[0]
            .message
            .starts_with("spindle $1 does not exist")
    );
    assert!(
        read("G0 X1 $0\nM2\n", None).1[0]
            .message
            .starts_with("$ has no meaning with G0")
    );
}

#[test]
fn arcs_outside_xy_run_in_a_rotated_system() {
    // A quarter of a circle of 10 mm in ZX, turned by 30 degrees about Z, and a helix.
    for (words, normal_mm) in [("X10 Z10 K10", 0.0), ("X10 Z10 K10 Y4", 4.0)] {
        let text = format!("G21 F100\nG10 L2 P1 R30\nG18 G2 {words}\nM2\n");
        let (motions, faults, _) = read(&text, None);
        assert!(faults.is_empty(), "{faults:?}");
        let Shape::Spline(spline) = &motions[0].shape else {
            panic!("{motions:?}")
        };
        let (sin, cos) = 30.0_f64.to_radians().sin_cos();
        let end = [
            10.0 * cos - normal_mm * sin,
            10.0 * sin + normal_mm * cos,
            10.0,
        ];
        assert!(
            (0..3).all(|axis| (motions[0].end_mm[axis] - end[axis]).abs() < 1e-9),
            "{motions:?}"
        );
        let length = (0.5 * std::f64::consts::PI * 10.0).hypot(normal_mm);
        assert!(
            (spline.length_mm() - length).abs() < 1e-3,
            "{}",
            spline.length_mm()
        );
        // The centre is at Z10; every third control point lies on the circle.
        for point in spline.control_mm.iter().step_by(3) {
            let [x, y] = [
                point[0] * cos + point[1] * sin,
                point[1] * cos - point[0] * sin,
            ];
            assert!(
                ((x).hypot(point[2] - 10.0) - 10.0).abs() < 1e-9,
                "{point:?}"
            );
            assert!((-1e-9..=normal_mm + 1e-9).contains(&y), "{point:?}");
        }
    }
}

#[test]
fn exists_takes_numbers_too() {
    assert_eq!(
        ends("G0 X[exists[#1]] Y[exists[#<none>] + 2]\nM2\n", None),
        [[1.0, 2.0, 0.0]]
    );
}

#[test]
fn post_processors_for_grbl_write_k0() {
    let arc = "G17 G21\nG2 X10 Y0 I5 J0 K0 F100\n";
    assert_eq!(
        ends(&format!("(Post Processor: grbl_post)\n{arc}"), None),
        [[10.0, 0.0, 0.0]]
    );
    assert_eq!(ends(arc, Some(Dialect::Grbl)), [[10.0, 0.0, 0.0]]);
    assert_eq!(read(arc, Some(Dialect::LinuxCnc)).1.len(), 1);
    assert_eq!(
        read("G2 X10 Y0 I5 J0 K1 F100\n", Some(Dialect::Grbl))
            .1
            .len(),
        1
    );
}

#[test]
fn what_grbl_takes_out_of_the_stream_moves_nothing() {
    assert_eq!(
        ends("$H\nG0 X1\n!\n~\n?\nG0 X2\n", None),
        [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]
    );
}

#[test]
fn fanuc_s_g10_sets_lengths_radii_and_their_wear() {
    let text = "%\nO1234\nG21 G90 G54\nG10 L10 P1 R50.\nG10 L11 P1 R-0.5\nG10 L12 P1 R4.\nG10 L13 P1 R0.\nT1 M6\nG43 H1\nG0 Z10.\n\
                G0 X-20. Y-20.\nG41 D1 G1 X0. Y0. F100.\nX20.\nG40 X40. Y20.\nM30\n%\n";
    let (motions, faults, _) = read(text, None);
    assert!(faults.is_empty(), "{faults:?}");
    assert_eq!(motions[0].end_mm[2], 59.5);
    let along = motions.iter().find(|motion| motion.line == 13).unwrap();
    assert!((along.end_mm[1] - 4.0).abs() < 1e-9, "{along:?}");
}

#[test]
fn printers_speak_to_their_firmware() {
    let text = "M115 U6.3.0+10073\nM486 S0 Acube.stl\nN1 M110 N0*125\n_START_PRINT BED=60\nT_ON\nN2 M117 a b*17\nN3 G1 X1 E1*97\nN4 G1 X2*11\n";
    let (motions, faults, warnings) = read(text, Some(Dialect::Printer));
    assert!(faults.is_empty(), "{faults:?}");
    assert_eq!(
        motions
            .iter()
            .map(|motion| motion.end_mm[0])
            .collect::<Vec<_>>(),
        [1.0, 2.0]
    );
    assert_eq!(
        warnings
            .iter()
            .map(|warning| warning.line)
            .collect::<Vec<_>>(),
        [4, 5]
    );
    let (motions, _, warnings) = read(
        "G1 X1 E1\nG10\nG11 ; back\nG1 X2 E2\n",
        Some(Dialect::Printer),
    );
    assert_eq!((motions.len(), warnings.len()), (2, 2), "{warnings:?}");
}

#[test]
fn a_program_for_a_printer_may_be_numbered_throughout() {
    let text = "N1 G28*18\nN2 G1 X5 F600 E1*75\nN3 M117 hi there*12\n";
    assert_eq!(ends(text, None).last(), Some(&[5.0, 0.0, 0.0]));
}

#[test]
fn g40_1_of_mach3_is_g40() {
    let (motions, faults, warnings) = read("G17 G40.1 G80\nG0 X1\nM2\n", None);
    assert!(faults.is_empty() && motions.len() == 1, "{faults:?}");
    assert!(
        warnings[0].message.contains("G40.1 is read as G40"),
        "{warnings:?}"
    );
}

/// The line of each warning and what it says; none is an error.
fn warned(text: &str) -> Vec<(u32, String)> {
    let (_, faults, warnings) = read(text, None);
    assert!(faults.is_empty(), "{text}: {faults:?}");
    warnings
        .into_iter()
        .map(|warning| (warning.line, warning.message))
        .collect()
}

/// LinuxCNC 2.9 remembers the break until the next do.
#[test]
fn a_do_behind_a_break_is_read_as_written_with_a_warning() {
    const BROKEN: &str = "o1 while [1]\no1 break\no1 endwhile\n";
    const DO: &str = "#2=0\no3 do\n#2=[#2+1]\nG0 Y#2\no3 while [#2 lt 3]\n";
    assert_eq!(ends(&format!("{BROKEN}{DO}M2\n"), None).len(), 3);
    let says = "LinuxCNC 2.9 ends this loop here: it still obeys `break` in line 2, which belongs to another loop or was stepped over";
    assert_eq!(warned(&format!("{BROKEN}{DO}M2\n")), [(8, says.to_owned())]);
    // A break that is passed over, because the while has ended or in a do behind `continue`.
    let counted =
        "#1=0\no1 while [#1 lt 2]\n#1=[#1+1]\no2 if [#1 gt 5]\no1 break\no2 endif\no1 endwhile\n";
    assert_eq!(warned(&format!("{counted}{DO}M2\n")).len(), 1);
    let continued =
        "#1=0\no1 do\n#1=[#1+1]\nG0 X#1\no1 continue\no1 break\no1 while [#1 lt 2]\nM2\n";
    assert_eq!(warned(continued)[0].0, 7);
    assert_eq!(ends(continued, None).len(), 2);
    // The end of a do that it left: LinuxCNC forgets the break.
    assert!(
        warned(&format!(
            "o1 do\no1 break\no1 break\no1 while [1]\n{DO}M2\n"
        ))
        .is_empty()
    );
    // A condition that ends the do anyway, or the next do: LinuxCNC has forgotten the break.
    assert!(warned(&format!("{BROKEN}o4 do\nG0 X1\no4 while [0]\n{DO}M2\n")).is_empty());
    assert!(warned(&format!("{DO}G0 X1\nM2\n")).is_empty());
    let repeat = warned("#1=0\no1 repeat [3]\nG0 X1\no1 continue\no1 endrepeat\nM2\n");
    assert!(
        repeat[0].0 == 4
            && repeat[0]
                .1
                .contains("LinuxCNC refuses `continue` in a repeat"),
        "{repeat:?}"
    );
}

#[test]
fn exists_says_which_numbers_are_parameters() {
    let text =
        "G0 X[exists[#99999]] Y[exists[#5602]] Z[exists[#5601]]\nG0 X[1+exists[#0]] Z2\nM2\n";
    assert_eq!(ends(text, None), [[0.0, 0.0, 1.0], [1.0, 0.0, 2.0]]);
    let (_, faults, _) = read("G0 X#5602\nM2\n", None);
    assert!(
        faults[0]
            .message
            .contains("#5602 does not exist: the numbers go from 1 to 5601"),
        "{faults:?}"
    );
}

#[test]
fn g50_alone_ends_a_scaling_that_is_not_there() {
    let text = "G90 G54 G64 G50 G17 G40 G80 G94 G91.1 G49\nG0 X1\nM2\n";
    assert_eq!(ends(text, None), [[1.0, 0.0, 0.0]]);
    let warnings = warned(text);
    assert!(
        warnings.len() == 1 && warnings[0].1.contains("G50 is left out"),
        "{warnings:?}"
    );
    for words in ["X0 Y0", "S2000"] {
        let (_, faults, _) = read(
            &format!("G0 X1\nG50 {words}\nM2\n"),
            Some(Dialect::LinuxCnc),
        );
        assert!(faults[0].message.contains("G50 with words"), "{faults:?}");
    }
}

#[test]
fn g70_and_g71_alone_are_units_of_other_controls() {
    for (line, says) in [
        ("N140G71G91.1", "G71 means millimeters: write G21"),
        ("G70", "G70 means inches: write G20"),
    ] {
        let (_, faults, _) = read(&format!("{line}\nG0 X1\nM2\n"), None);
        let hint = faults[0].hint.as_deref().unwrap_or_default();
        assert!(faults[0].line == 1 && hint.contains(says), "{faults:?}");
    }
}

#[test]
fn a_distance_in_polar_coordinates_has_no_direction_at_the_origin() {
    let (_, faults, _) = read("G91 G0 @12.37 ^-118\nM2\n", None);
    assert!(
        faults[0].message.contains("no direction at the origin"),
        "{faults:?}"
    );
    assert_eq!(
        ends("G0 X3\nG91 @2 ^0\nM2\n", None),
        [[3.0, 0.0, 0.0], [5.0, 0.0, 0.0]]
    );
}

#[test]
fn a_dwell_that_may_be_in_milliseconds_is_asked_about() {
    let warnings = warned("G0 X1\nG04 P500\nG0 X2\nM30\n");
    assert!(
        warnings.len() == 1 && warnings[0].1.contains("P500 is read as 500 s"),
        "{warnings:?}"
    );
    for (text, dialect) in [
        ("G0 X1\nG4 P2\nM30\n", None),
        ("G0 X1\nG4 P500.5\nM30\n", None),
        ("G0 X1\nG4 P500\nM30\n", Some(Dialect::LinuxCnc)),
        ("O1\nG43 H1\nG0 X1.\nG4 P500\nM30\n", None),
    ] {
        let (_, _, warnings) = read(text, dialect);
        assert!(
            !warnings
                .iter()
                .any(|warning| warning.code == "gcode::dwell"),
            "{text}: {warnings:?}"
        );
    }
}
