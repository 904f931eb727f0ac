//! What programs for Fanuc and Haas mean by words that LinuxCNC reads otherwise: repeats, milliseconds, jumps, smoothing.

use feedwright::gcode::canon::{Canon, EventKind, Motion};
use feedwright::gcode::{CheckError, Dialect, Reader, Settings, summarize};

fn reader(text: &str, dialect: Dialect) -> Reader {
    let settings = Settings { dialect: Some(dialect), ..Settings::default() };
    Reader::from_text("part.nc", text, settings).expect("it is a program")
}

fn steps(text: &str, dialect: Dialect) -> Vec<Canon> {
    reader(text, dialect).map(|step| step.unwrap_or_else(|fault| panic!("{text}: {fault:?}"))).collect()
}

fn motions(text: &str) -> Vec<Motion> {
    let motion = |step| if let Canon::Motion(motion) = step { Some(motion) } else { None };
    steps(text, Dialect::Fanuc).into_iter().filter_map(motion).collect()
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
    match summarize(reader(text, Dialect::Fanuc)) {
        Err(CheckError::Faults(faults)) => faults
            .into_iter()
            .map(|fault| format!("{}: {} {}", fault.line, fault.message, fault.hint.unwrap_or_default()))
            .collect(),
        other => panic!("{text:?} gave {other:?}"),
    }
}

#[test]
fn the_repeats_of_m98_stand_before_its_number() {
    let subroutines = "M30\nO0100\nG91 G1 X5\nM99\nO30200\nG91 G1 Y1\nM99\n";
    let ends = |call: &str| {
        let last = motions(&format!("O0001\nG21 G90 F100\n{call}\n{subroutines}")).pop().unwrap();
        [last.end_mm[0], last.end_mm[1]]
    };
    assert_eq!(ends("M98 P100"), [5.0, 0.0]);
    assert_eq!(ends("M98 P0100 L2"), [10.0, 0.0]);
    assert_eq!(ends("M98 P30100"), [15.0, 0.0]);
    assert_eq!(ends("M98 P00040100"), [20.0, 0.0]);
    // Haas has numbers of five digits.
    assert_eq!(ends("M98 P30200"), [0.0, 1.0]);
    let missing = faults("O0001\nG21 G90 F100\nG1 X1\nM98 P30300\nM30\n");
    assert!(missing[0].starts_with("4: the subroutine O30300 is defined nowhere"), "{missing:?}");
}

#[test]
fn a_dwell_without_a_decimal_point_is_milliseconds() {
    let text = "O0001\nF100 G4 P500\nG4 P1.5\nG82 X1 Z-1 R1 P250\nG82 X2 Z-1 R1 P.25\nG80\nM30\n";
    assert_eq!(dwells(text, Dialect::Fanuc), [0.5, 1.5, 0.25, 0.25]);
    assert_eq!(dwells("F100 G4 P2\nG1 X1\nM2\n", Dialect::LinuxCnc), [2.0]);
    let seconds = faults("O0001\nF100 G1 X1\nG4 X2.\nM30\n");
    assert!(seconds[0].contains("milliseconds in place of X or U"), "{seconds:?}");
}

#[test]
fn a_jump_is_refused_and_not_passed_over() {
    let text =
        "O0001\nG21 G90 F100\nG1 X1\nM97 P100 L2\nM96 P10\nM198 P50\nM98 P0100 H20\nM98 P100\nM30\nO0100\nM99 P7\n";
    let found = faults(text);
    for (line, says) in [
        (4, "M97 calls lines of the same program by their N, which is not read"),
        (5, "M96 jumps"),
        (6, "M198 calls a program on another device"),
        (7, "H has no meaning"),
        (11, "M99 P goes on at another line"),
    ] {
        assert!(found.iter().any(|fault| fault.starts_with(&format!("{line}: {says}"))), "{line} {says}: {found:?}");
    }
}

#[test]
fn smoothing_is_left_out_with_a_warning() {
    let text = "O0001\nG21 G90 F100\nG05.1 Q1\nG08 P1\nN7 G187 P3 E0.01 (fine)\nG1 X1\nG05 P0\nM30\n";
    let summary = summarize(reader(text, Dialect::Fanuc)).unwrap();
    let lines: Vec<u32> = summary.warnings.iter().map(|warning| warning.line).collect();
    assert_eq!(lines, [3, 4, 5, 7]);
    assert!(summary.warnings[2].message.contains("`N7 G187 P3 E0.01 (fine)` sets how the control smooths"));
    assert_eq!(summary.motions, 1);
    // It may not hide a motion.
    let hidden = faults("O0001\nG21 G90 F100 G1 X1\nG187 P1 G1 X2\nM30\n");
    assert!(hidden[0].contains("G187 (the smoothness of Haas"), "{hidden:?}");
}

#[test]
fn codes_of_other_controls_are_refused_by_what_they_do() {
    for (code, what) in [
        ("G12 I5.", "pocket"),
        ("G16", "polar"),
        ("G51 X0 Y0 P2", "scaling"),
        ("G51.1 X0", "mirror"),
        ("G65 P9810 X1", "macro"),
        ("G68 X0 Y0 R30", "G10 L2 P0 R30"),
        ("G68.2 X0", "tilted"),
        ("G43.4 H1", "tilts"),
        ("G154 P3", "coordinate system"),
        ("G110", "coordinate system"),
        ("G54.1 P3", "coordinate systems"),
        ("G1 X5 ,C1.", "chamfer"),
        ("G71 U2. R0.5", "G71 of Fanuc and Haas"),
        ("G71 P10 Q20 U0.4 W0.1 F0.2", "G71 of Fanuc and Haas"),
        ("G72 P10 Q20 D2.", "G72 of Fanuc and Haas"),
        ("G70 P10 Q20", "G70 of Fanuc and Haas"),
    ] {
        let found = faults(&format!("O0001\nG21 G90 F100\nG1 X1\n{code}\nM30\n"));
        assert!(found[0].starts_with("4: ") && found[0].contains(what), "{code}: {found:?}");
    }
}

#[test]
fn cycles_of_fanuc_are_told_from_those_of_linuxcnc_by_their_words() {
    for cycle in ["G71 U2 R0.5", "G71 P10 Q20", "G72 Q20 W0.1"] {
        let text = format!("G18 G21 G90 F100\n{cycle}\nM2\n");
        let fault = reader(&text, Dialect::LinuxCnc).find_map(Result::err).unwrap();
        assert!(fault.message.contains("of Fanuc and Haas") && fault.hint.is_some(), "{cycle}: {}", fault.message);
    }
}

#[test]
fn levels_of_block_delete_and_distances_of_g10() {
    let ends: Vec<f64> = motions("O0001\nG21 G90 F100\n/2 G1 X5\n/G1 X7\nM30\n").iter().map(|m| m.end_mm[0]).collect();
    assert_eq!(ends, [5.0, 7.0]);
    // G91 adds to an offset; on LinuxCNC it does not.
    let text = "O0001\nG21 G90 F100\nG10 L2 P2 X5\nG91 G10 L2 P2 X1\nG90 G55 G1 X0\nM30\n";
    assert_eq!(motions(text)[0].end_mm[0], 6.0);
    let Canon::Motion(motion) = &steps(&text[6..], Dialect::LinuxCnc)[0] else { panic!("no motion") };
    assert_eq!(motion.end_mm[0], 1.0);
}
