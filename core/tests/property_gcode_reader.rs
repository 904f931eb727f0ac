//! The reader on printed numbers, on garbage, and on every program of the corpus: it answers, and its answers lie inside the file.
#![expect(clippy::unwrap_used, reason = "a test helper may fail its test")]

use std::path::{Path, PathBuf};

use feedwright::gcode::canon::Canon;
use feedwright::gcode::{Diagnostic, Reader, Settings};
use proptest::prelude::*;

/// Reads all of `text`; returns the steps and the faults.
fn read(text: &[u8]) -> (Vec<Canon>, Vec<Diagnostic>) {
    let settings = Settings { max_idle_lines: 10_000, max_motions: 100_000, ..Settings::default() };
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
        assert!(shown.contains(&fault.message[..fault.message.len().min(5)]), "{shown}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

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
    fn garbage_in_the_alphabet_never_panics(text in "[gmoxyzijkrfpl#<>=\\[\\]()+*/0-9. \n-]{0,400}") {
        let (_, faults) = read(text.as_bytes());
        assert_inside(text.as_bytes(), &faults);
    }
}

fn files_below(folder: &Path, files: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
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
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/corpus");
    if !corpus.is_dir() {
        eprintln!("SKIPPED: no corpus of foreign programs at {}", corpus.display());
        return;
    }
    let mut files = Vec::new();
    files_below(&corpus, &mut files);
    assert!(!files.is_empty());
    for file in files {
        let settings = Settings { max_idle_lines: 100_000, max_motions: 1_000_000, ..Settings::default() };
        let Ok(reader) = Reader::open(&file, settings) else {
            continue;
        };
        let faults: Vec<Diagnostic> = reader.filter_map(Result::err).collect();
        assert_inside(&std::fs::read(&file).unwrap(), &faults[..faults.len().min(5)]);
    }
}
