//! Every fault of a program names its place, its value and its limit; the reader goes on behind it.
#![expect(clippy::unwrap_used, reason = "a test helper may fail its test")]

use std::io::Write;

use feedwright::gcode::{CheckError, Diagnostic, ReadError, Reader, Settings, check, summarize};

fn faults(text: &str) -> Vec<Diagnostic> {
    let reader = Reader::from_text("part.ngc", text, Settings::default()).unwrap();
    match summarize(reader) {
        Err(CheckError::Faults(faults)) => faults,
        other => panic!("{text:?} gave {other:?}"),
    }
}

/// Program, line, column, length of the mark, and a part of the message.
const TABLE: &[(&str, u32, u32, u32, &str)] = &[
    ("G0 X1\nG1.7 X2", 2, 1, 4, "G1.7 is not a G-code"),
    ("G0 X1\n  G315 X2", 2, 3, 4, "G315 is not a G-code"),
    ("G0 X1\nG68 X0 Y0 R30", 2, 1, 3, "G68 (a rotation of the coordinates, on other controls) is not read"),
    ("F100\nG1 X1 ,R2.", 2, 7, 1, "`,R` rounds the corner"),
    ("F100\no1 else\nG1 X1\no1 endif", 2, 1, 7, "no `O1 if` stands before it"),
    ("F100\no1 if [1]\nG1 X1\no1 endif\no1 do\no1 while [0]", 5, 1, 5, "the label O1 is that of line 2"),
    ("F100 G91\no1 repeat [2]\nG1 X1\no1 endwhile", 4, 1, 11, "endwhile ends no `O1 repeat`"),
    ("F100 G41.1 D1\nG1 X5\nX9\nG40\nM5\nG2 X12 R3", 6, 1, 9, "behind G40 must be straight"),
    ("F100 G2 X10 Y0 I5.6 J0", 1, 1, 22, "5.600000 mm at the start and 4.400000 mm at the end"),
    ("F100 G2 X10 Y0 R4.9", 1, 16, 4, "at least half the distance, 5.000000 mm"),
    ("G1 X10", 1, 1, 6, "no feed F"),
    ("G1 F0 X10", 1, 4, 2, "F0 moves nothing"),
    ("G0 X1e300", 1, 6, 4, "E has no meaning with G0"),
    ("G0 X1000001", 1, 4, 8, "limit of 1000000 mm"),
    ("G18 F1 G71 X1 Z1\nX5", 1, 8, 3, "Q (number of the profile's subroutine) is missing"),
    ("G18 F1 G71 Q9 I0\nX5", 1, 15, 2, "I of G71 must be above 0"),
    ("G20 G0 X-99999", 1, 8, 7, "limit of 1000000 mm"),
    ("G0 G1 X1 F1", 1, 4, 2, "G0 and G1 exclude each other"),
    ("G17 G18 G0 X1", 1, 5, 3, "G17 and G18 exclude each other"),
    ("G18 F60 G5 X1 Y1 I1 J1 P1 Q1", 1, 1, 28, "G5 needs the XY plane G17"),
    ("G19 F60 G5.2 X1 Y1 P1", 1, 1, 21, "G5.2 needs the XY plane G17"),
    ("F60 G3 X0.003 I0.00175", 1, 1, 22, "radius is 0.001250 mm; the limit is 0.00127 mm"),
    ("M3 M4 G0 X1", 1, 4, 2, "M3 and M4 exclude each other"),
    ("G0 X1 X2", 1, 7, 2, "already has a word X"),
    ("X1", 1, 1, 2, "no code such as G0 or G1"),
    ("G80 X1", 1, 5, 2, "G80"),
    ("F1 G2 X1 I1 R1", 1, 10, 2, "not both"),
    ("F1 G2 X1 I.5 K1", 1, 14, 2, "K lies outside the arc's plane G17"),
    ("F1 G2 X1", 1, 1, 8, "neither a radius R nor a centre"),
    ("F1 G2 X0 R1", 1, 10, 2, "elsewhere than it starts"),
    ("F1 G90.1 G2 X1 I.5", 1, 1, 18, "J is missing"),
    ("F1 G2 X1 I.5 P0", 1, 14, 2, "P0 is out of range"),
    ("F1 G2 X1 I.5 P1.5", 1, 14, 4, "not an integer"),
    ("G4", 1, 1, 2, "no time"),
    ("G4 P-1", 1, 4, 3, "negative"),
    ("G0 X1 (open", 1, 7, 5, "not closed"),
    ("G0 X1 $", 1, 7, 1, "`$` has no meaning"),
    ("G0 X", 1, 5, 0, "the end of the line"),
    ("G0 X[1", 1, 7, 0, "`]` or an operator is missing"),
    ("G0 X#<a>", 1, 5, 4, "#<a> has no value"),
    ("F-1", 1, 1, 3, "negative"),
    ("G53 X1", 1, 5, 2, "no code such as G0"),
    ("G93 G1 X1", 1, 1, 9, "every feed motion needs its own"),
    ("G95 F1 G1 X1", 1, 1, 12, "spindle needs a speed"),
    ("M300 G0 X1", 1, 1, 4, "M300 is not an M-code"),
];

#[test]
fn every_fault_has_its_place() {
    for &(text, line, column, span, part) in TABLE {
        let found = faults(text);
        let first = &found[0];
        assert_eq!((first.line, first.column, first.span), (line, column, span), "{text:?}: {first:?}");
        assert!(first.message.contains(part), "{text:?}: {}", first.message);
    }
}

#[test]
fn behind_a_refused_lathe_cycle_axis_words_are_no_further_cycles() {
    assert_eq!(faults("G18 F1 G71 X1 Z1\nX5\nX6").len(), 1);
}

#[test]
fn nothing_behind_the_end_is_read() {
    let reader = Reader::from_text("part.ngc", "G0 X1\nM2\n\0 not read \u{fffd}", Settings::default());
    assert!(matches!(reader, Err(ReadError::Binary { .. })));
    let reader = Reader::from_text("part.ngc", "G0 X1\nM2\n not read \u{fffd}", Settings::default()).unwrap();
    assert_eq!(summarize(reader).unwrap().motions, 1);
}

#[test]
fn all_faults_come_in_one_go_and_are_limited() {
    let text = "G0 X1 $\nG0 X1\nG0 X$\nG0 Y1 $\n";
    assert_eq!(faults(text).iter().map(|fault| fault.line).collect::<Vec<_>>(), [1, 3, 4]);
    let many = faults(&"&\n".repeat(250));
    assert_eq!(many.len(), 101);
    assert_eq!(many[100].message, "and 150 more errors");
}

#[test]
fn a_program_without_motion_is_an_error() {
    assert_eq!(faults("G21\nM2")[0].message, "the program has no motion");
}

#[test]
fn files_that_are_no_program_are_named() {
    let missing = check("does/not/exist.ngc".as_ref(), Settings::default());
    let Err(CheckError::Read(error @ ReadError::Io { .. })) = missing else { panic!("{missing:?}") };
    assert!(error.to_string().contains("does/not/exist.ngc"));
    let folder = tempfile::tempdir().unwrap();
    assert!(matches!(check(folder.path(), Settings::default()), Err(CheckError::Read(ReadError::Directory { .. }))));
    let mut file = tempfile::NamedTempFile::new().unwrap();
    assert!(matches!(check(file.path(), Settings::default()), Err(CheckError::Read(ReadError::Empty { .. }))));
    file.write_all(b"\x7fELF\0\0").unwrap();
    assert!(matches!(check(file.path(), Settings::default()), Err(CheckError::Read(ReadError::Binary { .. }))));
}

#[test]
fn miette_shows_line_and_caret() {
    let fault = &faults("G21\nG0 X1\nG0 X2 Y$3 ; not a number")[0];
    let mut shown = String::new();
    miette::GraphicalReportHandler::new_themed(miette::GraphicalTheme::unicode_nocolor())
        .render_report(&mut shown, fault)
        .unwrap();
    assert!(shown.contains("part.ngc:3:8"), "{shown}");
    assert!(shown.contains("3 │ G0 X2 Y$3 ; not a number"), "{shown}");
}

#[test]
fn text_outside_comments_must_be_readable() {
    let reader = Reader::from_text("part.ngc", b"G0 X1 (caf\xe9)\nM2".as_slice(), Settings::default()).unwrap();
    assert_eq!(summarize(reader).unwrap().motions, 1);
    let reader = Reader::from_text("part.ngc", b"G0 X1\xe9\nM2".as_slice(), Settings::default()).unwrap();
    let Err(CheckError::Faults(faults)) = summarize(reader) else { panic!("accepted") };
    assert!(faults[0].message.contains("not UTF-8"));
}

#[test]
fn hostile_programs_end_with_a_place() {
    let settings = || Settings { max_idle_lines: 1_000_000, ..Settings::default() };
    let first = |text: &[u8]| {
        let reader = Reader::from_text("part.ngc", text, settings()).unwrap();
        match summarize(reader) {
            Err(CheckError::Faults(faults)) => faults[0].clone(),
            other => panic!("{other:?}"),
        }
    };
    let long = first(&[b"G0 X1\n".to_vec(), vec![b'1'; 10 << 20], b"\nM2\n".to_vec()].concat());
    assert_eq!((long.line, long.text.len() < 1000), (2, true));
    assert!(long.message.contains("longer than 65536 bytes"));
    let deep = first(format!("G0 X{}\nM2", "[".repeat(60_000)).as_bytes());
    assert!(deep.message.contains("inside each other") && deep.line == 1);
    let calls = first(b"G0 X1\no1 sub\no1 call\no1 endsub\no1 call\nM2");
    assert_eq!((calls.line, calls.message.contains("calls inside each other")), (3, true));
    let names: String = (0..200_000).map(|n| format!("#<n{n}>=1\n")).collect();
    let names = first(names.as_bytes());
    assert_eq!((names.line, names.message.contains("too many named parameters")), (100_001, true));
    let nul = first(&[b"G0 X1\n".repeat(20_000), b"G0 \0 X2\nM2\n".to_vec()].concat());
    assert_eq!((nul.line, nul.column, nul.message.contains("0x00")), (20_001, 4, true));
    let number = first(format!("G0 X{}\nM2", "9".repeat(400)).as_bytes());
    assert!(number.message.contains("beyond what any control can hold"));
    let endless = first(b"G0 X1\nM98 P1\nM2\nO1\no2 while [1]\no2 endwhile\nM99\n");
    assert!(endless.message.contains("endless loop"));
}
