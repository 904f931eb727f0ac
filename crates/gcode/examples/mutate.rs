//! Searches for programs that make the reader panic, hang or misplace a fault: mutates real
//! programs for SECONDS.
//!
//! Usage: `cargo run --release -p feedwright-gcode --example mutate -- SECONDS [SEED]
//! FILE_OR_FOLDER...`
//!
//! Every finding is written to `gcode_mutate_SEED_ROUND.ngc` and ends the run with exit code 1. The
//! same seed gives the same programs.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use feedwright_gcode::canon::Canon;
use feedwright_gcode::{Reader, Settings};

/// Longest text of one round, bytes: rounds must stay short, since the number of rounds finds
/// faults.
const MAX_BYTES: usize = 4096;
/// A round that takes longer counts as hanging.
const SLOW: Duration = Duration::from_secs(2);

/// Pieces of the language that mutations insert.
const PIECES: &[&str] = &[
    "G0",
    "G1",
    "G2",
    "G3",
    "G5",
    "G5.1",
    "G5.2",
    "G5.3",
    "G6.2",
    "G10",
    "G28",
    "G33",
    "G33.1",
    "G38.2",
    "G40",
    "G41.1",
    "G42.1",
    "G43",
    "G53",
    "G54",
    "G59.3",
    "G64",
    "G73",
    "G76",
    "G81",
    "G83",
    "G87",
    "G90",
    "G91",
    "G92",
    "G93",
    "G95",
    "G98",
    "M2",
    "M3",
    "M6",
    "M66",
    "M70",
    "M72",
    "M98",
    "M99",
    "X",
    "Y",
    "Z",
    "A",
    "U",
    "I",
    "J",
    "K",
    "R",
    "P",
    "Q",
    "L",
    "F",
    "S",
    "T",
    "D",
    "E",
    "H",
    "-",
    "1",
    "0",
    "0.5",
    "1e9",
    "999999999999",
    "#1",
    "#<a>",
    "#5220",
    "=",
    "[",
    "]",
    "**",
    "/",
    "MOD",
    "sin[",
    "atan[1]/[",
    "exists[#<a>]",
    "o1 sub",
    "o1 endsub",
    "o1 call",
    "o1 if [1]",
    "o1 else",
    "o1 endif",
    "o2 while [#1 lt 3]",
    "o2 endwhile",
    "o3 do",
    "o3 while [0]",
    "o4 repeat [3]",
    "o4 endrepeat",
    "o2 break",
    "o4 continue",
    "o1 return",
    "O5",
    "%",
    "(",
    ")",
    ";",
    "\n",
    "\r\n",
    "\0",
    "\u{e9}",
    "@",
    "^",
    "$",
    "*7",
    "N10",
];

/// Generator of pseudo-random numbers (splitmix64, S. Vigna): the runs are the same everywhere.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit.max(1) as u64) as usize
    }
}

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let seconds: u64 = arguments
        .next()
        .and_then(|text| text.parse().ok())
        .unwrap_or(10);
    let seed: u64 = arguments
        .next()
        .and_then(|text| text.parse().ok())
        .unwrap_or(1);
    let mut seeds: Vec<Vec<u8>> =
        vec![b"G21\nF100\no1 sub\nG1 X#1\no1 endsub\no1 call [1]\nG2 X2 I1\nM2\n".to_vec()];
    for path in arguments {
        collect(Path::new(&path), &mut seeds);
    }
    let mut random = Random(seed);
    let begin = Instant::now();
    let mut round = 0u64;
    while begin.elapsed() < Duration::from_secs(seconds) {
        round += 1;
        let text = mutated(&seeds, &mut random);
        if let Err(reason) = try_program(&text, true) {
            let file = format!("gcode_mutate_{seed}_{round}.ngc");
            eprintln!("{file}: {reason}");
            if let Err(error) = std::fs::write(&file, &text) {
                eprintln!("{file}: {error}");
            }
            return ExitCode::FAILURE;
        }
    }
    println!("{round} programs, no finding");
    ExitCode::SUCCESS
}

/// Adds the beginnings of all files below `path`.
fn collect(path: &Path, seeds: &mut Vec<Vec<u8>>) {
    let mut entries: Vec<PathBuf> = match std::fs::read_dir(path) {
        Ok(entries) => entries
            .filter_map(|entry| Some(entry.ok()?.path()))
            .collect(),
        Err(_) => {
            if let Ok(mut bytes) = std::fs::read(path) {
                bytes.truncate(MAX_BYTES);
                seeds.push(bytes);
            }
            return;
        }
    };
    entries.sort();
    for entry in entries {
        collect(&entry, seeds);
    }
}

fn mutated(seeds: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let mut text = seeds[random.below(seeds.len())].clone();
    for _ in 0..=random.below(12) {
        let at = random.below(text.len() + 1);
        let end = (at + random.below(40)).min(text.len());
        match random.below(6) {
            0 => text.truncate(at),
            1 => drop(text.drain(at..end)),
            2 => {
                let copy = text[at..end].to_vec();
                let to = random.below(text.len() + 1);
                text.splice(to..to, copy);
            }
            3 if at < text.len() => text[at] = random.next() as u8,
            4 => {
                let other = &seeds[random.below(seeds.len())];
                let from = random.below(other.len());
                let piece = other[from..(from + random.below(200)).min(other.len())].to_vec();
                text.splice(at..at, piece);
            }
            _ => {
                let piece = PIECES[random.below(PIECES.len())].bytes();
                text.splice(at..at, piece);
            }
        }
    }
    text.truncate(MAX_BYTES);
    text
}

/// Reads a program. Returns an error that states what is wrong with the answer of the reader. With
/// `again`, reads a program that takes too long a second time.
fn try_program(text: &[u8], again: bool) -> Result<(), String> {
    let begin = Instant::now();
    let result = std::panic::catch_unwind(|| {
        let settings = Settings {
            max_idle_lines: 20_000,
            max_motions: 20_000,
            ..Settings::default()
        };
        let Ok(reader) = Reader::from_text("mutated", text, settings) else {
            return Ok(());
        };
        let lines = text.split(|&byte| byte == b'\n').count();
        let mut before: Option<[f64; 3]> = None;
        let mut faults = false;
        for step in reader {
            match step {
                Err(fault) if fault.line as usize > lines => {
                    return Err(format!("a fault behind the end: {fault:?}"));
                }
                Err(_) => faults = true,
                Ok(Canon::Motion(motion)) => {
                    let numbers = motion
                        .start_mm
                        .iter()
                        .chain(&motion.end_mm)
                        .chain([&motion.feed_mm_s]);
                    if numbers.clone().any(|value| !value.is_finite()) {
                        return Err(format!("a number is not finite: {motion:?}"));
                    }
                    // After a fault the position is only assumed.
                    if !faults && before.is_some_and(|before| before != motion.start_mm) {
                        return Err(format!("a gap before {motion:?}"));
                    }
                    before = Some(motion.end_mm);
                }
                Ok(Canon::Event(_)) => {}
            }
        }
        Ok(())
    });
    match result {
        Err(_) => Err("it panics".to_owned()),
        Ok(Err(reason)) => Err(reason),
        // A second time: another program may have had the processor.
        Ok(Ok(())) if begin.elapsed() > SLOW && again => try_program(text, false),
        Ok(Ok(())) if begin.elapsed() > SLOW => Err(format!("it takes {:?}", begin.elapsed())),
        Ok(Ok(())) => Ok(()),
    }
}
