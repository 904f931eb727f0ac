//! The reader on printed numbers, on garbage, and on every program of the corpus: it answers, and
//! its answers lie inside the file.
use std::path::{Path, PathBuf};

use feedwright_gcode::canon::Canon;
use feedwright_gcode::{Diagnostic, Dialect, Reader, Settings};
use proptest::prelude::*;

/// Reads all of `text`; returns the steps and the faults.
fn read(text: &[u8]) -> (Vec<Canon>, Vec<Diagnostic>) {
    let settings = Settings {
        max_idle_lines: 10_000,
        max_motions: 100_000,
        ..Settings::default()
    };
    let Ok(reader) = Reader::from_text("test", text, settings) else {
        return (Vec::new(), Vec::new());
    };
    let (mut steps, mut faults) = (Vec::new(), Vec::new());
    for step in reader {
        match step {
            Ok(canon) => steps.push(canon),
            Err(fault) => faults.push(fault),
        }
    }
    (steps, faults)
}

/// Every fault lies inside the text, and showing it works.
fn assert_inside(text: &[u8], faults: &[Diagnostic]) {
    let lines: Vec<&[u8]> = text.split(|&byte| byte == b'\n').collect();
    for fault in faults {
        assert!(fault.line as usize <= lines.len(), "{fault:?}");
        if fault.line > 0 && fault.column > 0 {
            let line = String::from_utf8_lossy(lines[fault.line as usize - 1]);
            let length = line.chars().count();
            assert!(fault.column as usize <= length + 2, "{fault:?} in {line:?}");
        }
        let mut shown = String::new();
        miette::GraphicalReportHandler::new_themed(miette::GraphicalTheme::unicode_nocolor())
            .render_report(&mut shown, fault)
            .unwrap();
        assert!(
            shown.contains(&fault.message[..fault.message.len().min(5)]),
            "{shown}"
        );
    }
}

/// Lines as prints and finishing passes have them, modes that change what they mean, and faults.
fn a_line() -> impl Strategy<Value = String> {
    let number = prop_oneof![
        (-500i32..500).prop_map(|n| n.to_string()),
        (-90_000i32..90_000).prop_map(|n| format!("{:.2}", f64::from(n) * 1e-3)),
        (-9.0..9.0f64).prop_map(|x| x.to_string()),
        prop::sample::select(vec![
            "-.5",
            "+7.",
            "1 2",
            "0",
            "-0.0",
            "00012.5",
            "1000000.5"
        ])
        .prop_map(str::to_owned),
    ];
    let code = prop::sample::select(vec!["", "G1 ", "G0", "g01", "G1", "N7 G1", "n8", " "]);
    let letters = prop::sample::select(vec![
        "X", "XY", "xyz", "E", "XYE", "ZF", "XF", "YX", "XX", "XA", "UW", "F", "",
    ]);
    let plain =
        (code, letters, prop::collection::vec(number, 3)).prop_map(|(code, letters, numbers)| {
            let words: Vec<String> = letters
                .chars()
                .zip(&numbers)
                .map(|(letter, number)| format!("{letter}{number}"))
                .collect();
            format!("{code}{}", words.join(" "))
        });
    let others = vec![
        "G90",
        "G91",
        "G20",
        "G21",
        "G92 X1 Y2",
        "G92 E0",
        "G92.1",
        "G7",
        "G8",
        "M82",
        "M83",
        "G93",
        "G94",
        "G95 S100 M3",
        "G10 L2 P1 X3 Y4.1 R30",
        "G10 L2 P1 X0 Y0 R0",
        "G55",
        "G41.1 D1",
        "G40",
        "G2 X1 Y1 R20",
        "G81 X1 Y1 Z-1 R2",
        "G80",
        "G43.1 Z0.1 A5",
        "G28",
        "G61",
        "G64 P0.1",
        "X1 R5",
        "G1 X#1",
        "F-3 X1",
        "F0",
        "G38.2 Z-9",
        "G5.1 X9 Y1 I3 J3",
    ];
    prop_oneof![6 => plain, 2 => prop::sample::select(others).prop_map(str::to_owned)]
}

/// Bytes that mean something to the reader.
const ALPHABET: &[u8] = b"gmoxyzijkrfpl#<>=[]()+*/0123456789. \n-";

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    /// G0 and G1 have a short way through the reader, which a comment closes to them.
    #[test]
    fn the_short_way_leads_where_the_long_one_does(
        lines in prop::collection::vec(a_line(), 1..40),
        dialect in prop::sample::select(vec![Dialect::LinuxCnc, Dialect::Printer, Dialect::Grbl]),
        max_motions in prop::sample::select(vec![5, 1000]),
    ) {
        let read = |end: &str| {
            let text: String = std::iter::once("G21").chain(lines.iter().map(String::as_str)).map(|line| format!("{line}{end}")).collect();
            let settings = Settings { dialect: Some(dialect), max_motions, ..Settings::default() };
            let steps = Reader::from_text("test", text, settings).unwrap();
            let shown = |step: Result<Canon, Diagnostic>| match step {
                Ok(step) => format!("{step:?}"),
                Err(fault) => format!("{} {}: {}", fault.line, fault.code, fault.message),
            };
            steps.map(shown).collect::<Vec<_>>()
        };
        prop_assert_eq!(read("\n"), read("()\n"));
    }

    #[test]
    fn printed_numbers_come_back(x in -9e5..9e5f64, decimals in 0usize..18) {
        let printed = format!("{x:.decimals$}");
        let (steps, faults) = read(format!("G0 Z1\nG0 X{printed}\nM2").as_bytes());
        prop_assert!(faults.is_empty(), "{faults:?}");
        let expected: f64 = printed.parse().unwrap();
        match &steps[1] {
            Canon::Motion(motion) => prop_assert_eq!(motion.end_mm[0].to_bits(), (expected + 0.0).to_bits()),
            other => prop_assert!(expected == 0.0, "{other:?}"),
        }
    }

    #[test]
    fn garbage_never_panics(text in prop::collection::vec(any::<u8>(), 0..400)) {
        let (_, faults) = read(&text);
        assert_inside(&text, &faults);
    }

    #[test]
    fn garbage_in_the_alphabet_never_panics(text in prop::collection::vec(prop::sample::select(ALPHABET), 0..400)) {
        let (_, faults) = read(&text);
        assert_inside(&text, &faults);
    }
}

fn files_below(folder: &Path, files: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            files_below(&path, files);
        } else {
            files.push(path);
        }
    }
}

#[test]
fn every_file_of_the_corpus_is_answered() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/corpus");
    if !corpus.is_dir() {
        eprintln!(
            "SKIPPED: no corpus of foreign programs at {}",
            corpus.display()
        );
        return;
    }
    let mut files = Vec::new();
    files_below(&corpus, &mut files);
    assert!(!files.is_empty());
    for file in files {
        let settings = Settings {
            max_idle_lines: 100_000,
            max_motions: 1_000_000,
            ..Settings::default()
        };
        let Ok(reader) = Reader::open(&file, settings) else {
            continue;
        };
        let faults: Vec<Diagnostic> = reader.filter_map(Result::err).collect();
        assert_inside(
            &std::fs::read(&file).unwrap(),
            &faults[..faults.len().min(5)],
        );
    }
}
