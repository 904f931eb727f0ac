//! Every fault of a program names its place, its value and its limit; the reader goes on behind it.
use std::io::Write;

use feedwright_gcode::{CheckError, Diagnostic, Program, ReadError, Reader, Settings, summarize};

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
    (
        "G0 X1\nG68 X0 Y0 R30",
        2,
        1,
        3,
        "G68 (a rotation of the coordinates, on other controls) is not read",
    ),
    ("F100\nG1 X1 ,R2.", 2, 7, 1, "`,R` rounds the corner"),
    (
        "F100\no1 else\nG1 X1\no1 endif",
        2,
        1,
        7,
        "no `O1 if` stands before it",
    ),
    (
        "F100\no1 if [1]\nG1 X1\no1 endif\no1 do\no1 while [0]",
        5,
        1,
        5,
        "line 2 has the label O1 already",
    ),
    (
        "F100 G91\no1 repeat [2]\nG1 X1\no1 endwhile",
        4,
        1,
        11,
        "endwhile ends no `O1 repeat`",
    ),
    (
        "F100 G41.1 D1\nG1 X5\nX9\nG40\nM5\nG2 X12 R3",
        6,
        1,
        9,
        "behind G40 must be straight",
    ),
    (
        "F100 G2 X10 Y0 I5.6 J0",
        1,
        1,
        22,
        "5.600000 mm at the start and 4.400000 mm at the end",
    ),
    (
        "F100 G2 X10 Y0 R4.9",
        1,
        16,
        4,
        "at least half the distance, 5.000000 mm",
    ),
    ("G1 X10", 1, 1, 6, "no feed F"),
    ("G1 F0 X10", 1, 4, 2, "F0 moves nothing"),
    ("G0 X1e300", 1, 6, 4, "E has no meaning with G0"),
    ("G0 X1000001", 1, 4, 8, "limit of 1000000 mm"),
    (
        "G18 F1 G71 X1 Z1\nX5",
        1,
        8,
        3,
        "Q (number of the profile's subroutine) is missing",
    ),
    ("G18 F1 G71 Q9 I0\nX5", 1, 15, 2, "I of G71 must be above 0"),
    ("G20 G0 X-99999", 1, 8, 7, "limit of 1000000 mm"),
    ("G0 G1 X1 F1", 1, 4, 2, "G0 and G1 exclude each other"),
    ("G17 G18 G0 X1", 1, 5, 3, "G17 and G18 exclude each other"),
    (
        "G18 F60 G5 X1 Y1 I1 J1 P1 Q1",
        1,
        1,
        28,
        "G5 needs the XY plane G17",
    ),
    (
        "G19 F60 G5.2 X1 Y1 P1",
        1,
        1,
        21,
        "G5.2 needs the XY plane G17",
    ),
    (
        "F60 G3 X0.003 I0.00175",
        1,
        1,
        22,
        "radius is 0.001250 mm; the limit is 0.00127 mm",
    ),
    ("M3 M4 G0 X1", 1, 4, 2, "M3 and M4 exclude each other"),
    ("M19 R90 M3 G0 X1", 1, 9, 2, "M19 and M3 exclude each other"),
    (
        "G0 X1\no1 if [0]\nG0 X2\no1 [#1 gt 0]\nG0 X3\no1 endif",
        4,
        1,
        4,
        "O1 is followed by no keyword",
    ),
    (
        "o9 sub\nG0 X1\no9 endsub\nM98 P9 G0 X3",
        4,
        8,
        2,
        "LinuxCNC reads no other words beside M98",
    ),
    (
        "G0 X3 M98 P9",
        1,
        1,
        2,
        "LinuxCNC reads no other words beside M98",
    ),
    (
        "G0 X1\nM99 M3",
        2,
        5,
        2,
        "LinuxCNC reads no other words beside M99",
    ),
    ("G0 X1 X2", 1, 7, 2, "already has a word X"),
    ("X1", 1, 1, 2, "no code such as G0 or G1"),
    ("G80 X1", 1, 5, 2, "G80"),
    ("F1 G2 X1 I1 R1", 1, 10, 2, "not both"),
    (
        "F1 G2 X1 I.5 K1",
        1,
        14,
        2,
        "K lies outside the arc's plane G17",
    ),
    ("F1 G2 X1", 1, 1, 8, "neither a radius R nor a centre"),
    ("F1 G2 X0 R1", 1, 10, 2, "elsewhere than it starts"),
    (
        "G0 X.3 Y1\nF1 G2 X[.1+.2] Y1 R5",
        2,
        19,
        2,
        "elsewhere than it starts",
    ),
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
        assert_eq!(
            (first.line, first.column, first.span),
            (line, column, span),
            "{text:?}: {first:?}"
        );
        assert!(first.message.contains(part), "{text:?}: {}", first.message);
    }
}

#[test]
fn behind_a_refused_lathe_cycle_axis_words_are_no_further_cycles() {
    assert_eq!(faults("G18 F1 G71 X1 Z1\nX5\nX6").len(), 1);
}

/// Programs, the lines of their faults, and a part of the hint of the first.
const HINTS: &[(&str, &[u32], &str)] = &[
    ("G0 X\u{2212}5", &[1], "the hyphen `-` of the keyboard"),
    ("G0\u{a0}X5", &[1], "the blank of the keyboard"),
    (
        "o1 if [#1 == 5]\nG0 X1\no1 else\nG0 X2\no1 endif",
        &[1],
        "EQ, NE, GT, GE, LT, LE",
    ),
    (
        "o1 while [#1 < 5]\nG0 X1\no1 endwhile\nG0 X1",
        &[1],
        "EQ, NE, GT, GE, LT, LE",
    ),
    ("F100 G81 X1 Y1 Z-1 R1 K4", &[1], "LinuxCNC's word is L"),
    ("G103 P1\nG0 X1", &[1], "it moves nothing"),
    ("G47 P1\nG0 X1", &[1], "the motions of the letters"),
    ("#1=5+3\nG0 X1", &[1], "#1=[5+3]"),
    ("G0 X[sin(30)]", &[1], "sin[30]"),
    ("Gl X5\nG0 X1", &[1], "write 1"),
    // Faults that follow from a refused motion are not reported again.
    ("F100\nG1 X5 Y5 Z$\nX6\nG2 X9 Y0 I1", &[2], ""),
    ("F100\nG2 X5 Y5 I9\nG3 X0 Y0 I-1", &[2], ""),
    (
        "F100\nG1 X2000000 Y1\nG2 X5 Y5 I9\nG1 X0 Y0\nG2 X5 Y5 I9",
        &[2, 5],
        "",
    ),
    // A branch or a loop without its end has the place of its beginning.
    (
        "G0 X1\no1 if [0]\nG0 X2",
        &[2],
        "behind the last line that belongs to it",
    ),
    (
        "G0 X1\no7 sub\nG0 X2",
        &[2],
        "behind the last line that belongs to it",
    ),
];

#[test]
fn hints_help_and_nothing_is_reported_that_follows_from_another_fault() {
    for &(text, lines, hint) in HINTS {
        let found = faults(text);
        assert_eq!(
            found.iter().map(|fault| fault.line).collect::<Vec<_>>(),
            lines,
            "{text:?}: {found:?}"
        );
        assert!(
            found[0].hint.as_deref().unwrap_or_default().contains(hint),
            "{text:?}: {found:?}"
        );
        assert!(
            found[0].column > 0 && !found[0].text.is_empty(),
            "{text:?}: {found:?}"
        );
    }
}

#[test]
fn a_fault_in_a_loop_is_reported_once_with_a_count() {
    let found = faults("F100\no1 repeat [50]\nG1 X5 Q7\no1 endrepeat\nG1 X1 Q7");
    assert_eq!(
        found.iter().map(|fault| fault.line).collect::<Vec<_>>(),
        [3, 5]
    );
    assert_eq!(found[0].message, "Q has no meaning with G1 (50 times)");
    assert_eq!(found[1].message, "Q has no meaning with G1");
}

#[test]
fn an_endless_loop_has_a_place() {
    let text = "F100\nG1 X1\no1 while [1]\n#2=[#2+1]\no1 endwhile\n";
    let settings = Settings {
        max_idle_lines: 100,
        ..Settings::default()
    };
    let reader = Reader::from_text("part.ngc", text, settings).unwrap();
    let found: Vec<_> = reader.filter_map(Result::err).collect();
    assert!(
        found.len() == 1 && (3..=5).contains(&found[0].line) && found[0].column == 1,
        "{found:?}"
    );
}

#[test]
fn utf_16_is_named() {
    let text: Vec<u8> = "G0 X1\nM2\n"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    for text in [text.clone(), [b"\xff\xfe".to_vec(), text].concat()] {
        let refused = Reader::from_text("part.ngc", text, Settings::default()).unwrap_err();
        assert!(matches!(refused, ReadError::Utf16 { .. }), "{refused:?}");
    }
}

#[test]
fn long_lines_are_cut_about_their_fault() {
    let text = format!(
        "G0 {}X1 $ {}",
        "(comment) ".repeat(300),
        "(comment) ".repeat(300)
    );
    let found = faults(&text);
    assert!(
        found[0].text.chars().count() <= 110 && found[0].text.contains("X1 $"),
        "{:?}",
        found[0].text
    );
    assert!(
        found[0].text.starts_with('…') && found[0].text.ends_with('…'),
        "{:?}",
        found[0].text
    );
}

#[test]
fn nothing_behind_the_end_is_read() {
    let reader = Reader::from_text(
        "part.ngc",
        "G0 X1\nM2\n\0 not read \u{fffd}",
        Settings::default(),
    );
    assert!(matches!(reader, Err(ReadError::Binary { .. })));
    let reader = Reader::from_text(
        "part.ngc",
        "G0 X1\nM2\n not read \u{fffd}",
        Settings::default(),
    )
    .unwrap();
    assert_eq!(summarize(reader).unwrap().motions, 1);
}

#[test]
fn all_faults_come_in_one_go_and_are_limited() {
    let text = "G0 X1 $\nG0 X1\nG0 X$\nG0 Y1 $\n";
    assert_eq!(
        faults(text)
            .iter()
            .map(|fault| fault.line)
            .collect::<Vec<_>>(),
        [1, 3, 4]
    );
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
    let missing = Program::in_file("does/not/exist.ngc").check(Settings::default());
    let Err(CheckError::Read(error @ ReadError::Io { .. })) = missing else {
        panic!("{missing:?}")
    };
    assert!(error.to_string().contains("does/not/exist.ngc"));
    let folder = tempfile::tempdir().unwrap();
    assert!(matches!(
        Program::in_file(folder.path()).check(Settings::default()),
        Err(CheckError::Read(ReadError::Directory { .. }))
    ));
    let mut file = tempfile::NamedTempFile::new().unwrap();
    assert!(matches!(
        Program::in_file(file.path()).check(Settings::default()),
        Err(CheckError::Read(ReadError::Empty { .. }))
    ));
    file.write_all(b"\x01\x02\0\0").unwrap();
    assert!(matches!(
        Program::in_file(file.path()).check(Settings::default()),
        Err(CheckError::Read(ReadError::Binary { .. }))
    ));
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
    let reader = Reader::from_text(
        "part.ngc",
        b"G0 X1 (caf\xe9)\nM2".as_slice(),
        Settings::default(),
    )
    .unwrap();
    assert_eq!(summarize(reader).unwrap().motions, 1);
    let reader =
        Reader::from_text("part.ngc", b"G0 X1\xe9\nM2".as_slice(), Settings::default()).unwrap();
    let Err(CheckError::Faults(faults)) = summarize(reader) else {
        panic!("accepted")
    };
    assert!(faults[0].message.contains("not UTF-8"));
}

#[test]
fn hostile_programs_end_with_a_place() {
    let settings = || Settings {
        max_idle_lines: 1_000_000,
        ..Settings::default()
    };
    let first = |text: &[u8]| {
        let reader = Reader::from_text("part.ngc", text, settings()).unwrap();
        match summarize(reader) {
            Err(CheckError::Faults(faults)) => faults[0].clone(),
            other => panic!("{other:?}"),
        }
    };
    let long = first(
        &[
            b"G0 X1\n".to_vec(),
            vec![b'1'; 10 << 20],
            b"\nM2\n".to_vec(),
        ]
        .concat(),
    );
    assert_eq!((long.line, long.text.len() < 1000), (2, true));
    assert!(long.message.contains("longer than 65536 bytes"));
    let deep = first(format!("G0 X{}\nM2", "[".repeat(60_000)).as_bytes());
    assert!(deep.message.contains("inside each other") && deep.line == 1);
    let calls = first(b"G0 X1\no1 sub\no1 call\no1 endsub\no1 call\nM2");
    assert_eq!(
        (
            calls.line,
            calls.message.contains("calls inside each other")
        ),
        (3, true)
    );
    let names: String = (0..200_000).map(|n| format!("#<n{n}>=1\n")).collect();
    let names = first(names.as_bytes());
    assert_eq!(
        (
            names.line,
            names.message.contains("too many named parameters")
        ),
        (100_001, true)
    );
    let nul = first(&[b"G0 X1\n".repeat(20_000), b"G0 \0 X2\nM2\n".to_vec()].concat());
    assert_eq!(
        (nul.line, nul.column, nul.message.contains("0x00")),
        (20_001, 4, true)
    );
    let number = first(format!("G0 X{}\nM2", "9".repeat(400)).as_bytes());
    assert!(number.message.contains("beyond what any control can hold"));
    let endless = first(b"G0 X1\nM98 P1\nM2\nO1\no2 while [1]\no2 endwhile\nM99\n");
    assert!(endless.message.contains("endless loop"));
}
