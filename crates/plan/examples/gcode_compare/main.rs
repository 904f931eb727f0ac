//! Compares this reader with LinuxCNC on random programs: verdicts, end points, centers and arcs,
//! all to 1e-6 mm.
//!
//! Usage: `cargo run --release -p feedwright-plan --example gcode_compare -- [PROGRAMS] [FIRST]
//! [nested]`. With `nested`, a separate generator writes programs of control flow. Needs the
//! interpreter's Python module (Debian: `linuxcnc-uspace`). The same numbers give the same
//! programs. Every difference that is not listed is written to `gcode_compare_NUMBER.ngc`, and the
//! exit code is then 1. At the end, the codes that occurred in the programs are printed. A single
//! program is printed as well.

#![expect(clippy::unwrap_used, reason = "shared with tests, which may stop")]

mod cut;
#[path = "../../tests/common/linuxcnc.rs"]
mod linuxcnc;
mod listed;
mod nested;
mod programs;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::process::ExitCode;

use feedwright_gcode::{Reader, Settings};
use linuxcnc::{Theirs, Totals, theirs};
use listed::{Verdict, codes_of};

/// Number of programs per call of LinuxCNC.
const BATCH: u64 = 500;
/// Tenths of the largest G-code, and the largest M-code of the interpreter itself.
const MAX_CODES: [u32; 2] = [1000, 100];

/// Results of all programs.
#[derive(Default)]
struct Outcome {
    totals: Totals,
    counts: BTreeMap<String, u64>,
    /// Number of compared programs for each code in them.
    codes: BTreeMap<String, u64>,
    unlisted: u64,
}

fn main() -> ExitCode {
    let (words, numbers): (Vec<String>, Vec<String>) =
        std::env::args().skip(1).partition(|text| text == "nested");
    let program = if words.is_empty() {
        programs::program
    } else {
        nested::nested
    };
    let mut arguments = numbers.iter().map(|text| text.parse::<u64>());
    let (programs, first) = match (
        arguments.next().unwrap_or(Ok(20_000)),
        arguments.next().unwrap_or(Ok(1)),
    ) {
        (Ok(programs), Ok(first)) => (programs, first),
        _ => {
            eprintln!("usage: gcode_compare [PROGRAMS] [FIRST] [nested]: two numbers");
            return ExitCode::from(2);
        }
    };
    let mut outcome = Outcome::default();
    for begin in (first..first + programs).step_by(BATCH as usize) {
        if let Err(error) = outcome.batch(program, begin, (begin + BATCH).min(first + programs)) {
            eprintln!("the programs cannot be written: {error}");
            return ExitCode::from(2);
        }
    }
    outcome.print(programs)
}

impl Outcome {
    fn batch(&mut self, program: fn(u64) -> String, begin: u64, end: u64) -> std::io::Result<()> {
        let folder = tempfile::tempdir()?;
        let texts: Vec<String> = (begin..end).map(program).collect();
        if end - begin == 1 {
            println!("{}", texts[0]);
        }
        let mut paths: Vec<PathBuf> = Vec::new();
        for (number, text) in (begin..).zip(&texts) {
            // The name is not a number alone: LinuxCNC first looks for O9000 in a file of that
            // name.
            let path = folder.path().join(format!("program_{number}.ngc"));
            std::fs::write(&path, text)?;
            paths.push(path);
        }
        for (((number, text), path), theirs) in
            (begin..).zip(&texts).zip(&paths).zip(theirs(&paths))
        {
            match listed::judge(path, text, &theirs, &mut self.totals) {
                Verdict::Unknown => self.count("LinuxCNC crashed or hung"),
                Verdict::BothRefuse => self.count("both refuse"),
                Verdict::Same => self.agreed(text),
                Verdict::Differ(difference) => self.differ(number, text, &difference, &theirs)?,
            }
        }
        Ok(())
    }

    fn count(&mut self, what: &str) {
        *self.counts.entry(what.to_owned()).or_default() += 1;
    }

    fn agreed(&mut self, text: &str) {
        self.count("the same motions");
        let mut codes = codes_of(text);
        codes.sort();
        codes.dedup();
        for code in codes {
            *self.codes.entry(code).or_default() += 1;
        }
    }

    fn differ(
        &mut self,
        number: u64,
        text: &str,
        difference: &str,
        theirs: &Theirs,
    ) -> std::io::Result<()> {
        if let Some(row) = listed::find(text, theirs, difference) {
            self.count(&format!("listed: {row}"));
            return Ok(());
        }
        self.unlisted += 1;
        let file = format!("gcode_compare_{number}.ngc");
        eprintln!(
            "{file}: {difference} ({} motions of theirs)",
            theirs.moves.len()
        );
        std::fs::write(file, text)
    }

    fn print(&self, programs: u64) -> ExitCode {
        for (what, count) in &self.counts {
            println!("{count:7} {what}");
        }
        let unmet: Vec<&str> = listed::names()
            .filter(|name| !self.counts.contains_key(&format!("listed: {name}")))
            .collect();
        println!(
            "rows of the list that no program met: {}",
            if unmet.is_empty() {
                "none".to_owned()
            } else {
                unmet.join("; ")
            }
        );
        println!(
            "{:7} flat corners of cutter compensation, where LinuxCNC cuts into the contour",
            self.totals.flat_corners
        );
        println!(
            "largest differences of arcs, their lengths and points of splines: {:?} mm",
            self.totals.largest_mm
        );
        let known = known_codes();
        let missing: Vec<&str> = known
            .iter()
            .filter(|code| !self.codes.contains_key(*code))
            .map(String::as_str)
            .collect();
        println!(
            "codes compared: {} of {}",
            known.len() - missing.len(),
            known.len()
        );
        let shown: Vec<String> = self
            .codes
            .iter()
            .map(|(code, count)| format!("{code} {count}"))
            .collect();
        println!("  {}", shown.join(", "));
        println!("codes not compared: {}", missing.join(", "));
        println!(
            "{programs} programs, {} differences that are not listed",
            self.unlisted
        );
        if self.unlisted == 0 {
            ExitCode::SUCCESS
        } else {
            ExitCode::FAILURE
        }
    }
}

/// Returns every G- and M-code that the reader accepts.
fn known_codes() -> Vec<String> {
    let is_known = |line: &str| {
        let settings = Settings {
            dialect: Some(feedwright_gcode::Dialect::LinuxCnc),
            ..Settings::default()
        };
        let Ok(reader) = Reader::from_text("code", line, settings) else {
            return false;
        };
        let unknown = ["gcode::unknown_g", "gcode::unknown_m", "gcode::unsupported"];
        reader
            .filter_map(Result::err)
            .all(|fault| !unknown.contains(&fault.code))
    };
    let g = (0..MAX_CODES[0]).map(|tenths| format!("G{}", f64::from(tenths) / 10.0));
    let m = (0..MAX_CODES[1]).map(|number| format!("M{number}"));
    g.chain(m).filter(|code| is_known(code)).collect()
}
