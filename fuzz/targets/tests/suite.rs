//! Every target on its seeds, on what the fuzzer found, and on bytes of a generator.

use std::ops::Range;
use std::path::Path;

use feedwright_fuzz_targets::{TARGETS, damaged_blocks, tick};

/// Inputs of a generator for each target, and their bytes: some seconds together.
const DRAWN: [(&str, u64); 8] = [
    ("reader", 300),
    ("expressions", 300),
    ("files", 60),
    ("block", 300),
    ("logs", 60),
    ("corrected", 12),
    ("planner", 1),
    ("tick", 20),
];
const BYTES: u64 = 600;

/// SplitMix64 (Steele, Lea, Flood 2014).
fn bytes(seed: u64) -> Vec<u8> {
    let mut state = seed;
    let word = |_| {
        state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (state ^ (state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    };
    (0..BYTES / 8)
        .map(word)
        .flat_map(u64::to_le_bytes)
        .collect()
}

#[test]
fn every_target_holds_on_its_seeds_and_on_what_the_fuzzer_found() {
    for (name, run) in TARGETS {
        let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../seeds")).join(name);
        let mut seen = 0;
        for entry in std::fs::read_dir(&folder).expect("a target has a folder of seeds") {
            let path = entry.expect("an entry of the folder can be read").path();
            println!("{}", path.display());
            run(&std::fs::read(&path).expect("a seed can be read"));
            seen += 1;
        }
        assert!(seen > 0, "no seeds in {}", folder.display());
    }
}

/// The target and the inputs that `FEEDWRIGHT_FUZZ="TARGET FIRST COUNT"` asks for.
fn asked() -> Option<(String, Range<u64>)> {
    let asked = std::env::var("FEEDWRIGHT_FUZZ").ok()?;
    let parts: Vec<&str> = asked.split_whitespace().collect();
    let [target, first, count] = parts[..] else {
        panic!("FEEDWRIGHT_FUZZ is \"{asked}\", not TARGET FIRST COUNT")
    };
    let [first, count]: [u64; 2] =
        [first, count].map(|number| number.parse().expect("a whole number"));
    Some((target.to_owned(), first..first + count))
}

/// With `FEEDWRIGHT_FUZZ="TARGET FIRST COUNT"`, other seeds of one target.
#[test]
fn every_target_holds_on_drawn_bytes() {
    let asked = asked();
    for ((name, run), (drawn, count)) in TARGETS.into_iter().zip(DRAWN) {
        assert_eq!(name, drawn);
        let seeds = match &asked {
            Some((target, seeds)) if target == name => seeds.clone(),
            Some(_) => continue,
            None => 0..count,
        };
        for seed in seeds {
            println!("{name} {seed}");
            run(&bytes(seed));
        }
    }
}

/// The suite tries one of so many damaged blocks. The number is prime, so that all bytes and
/// changes come up.
const DAMAGED_STRIDE: u64 = 2003;

/// Every end, and a part of the changes; with `FEEDWRIGHT_FUZZ="damaged FIRST COUNT"`, all of a
/// stretch of them.
#[test]
fn a_model_with_a_changed_byte_is_refused_or_keeps_commands_finite_and_near_the_path() {
    let stretch = match asked() {
        Some((target, stretch)) if target == "damaged" => Some(stretch),
        Some(_) => return,
        None => None,
    };
    let mut ran = 0;
    for (n, damaged) in (0..).zip(damaged_blocks()) {
        let is_end = damaged[5] == 0;
        if stretch
            .as_ref()
            .map_or(is_end || n % DAMAGED_STRIDE == 0, |stretch| {
                stretch.contains(&n)
            })
        {
            println!("damaged {n}");
            tick(&[&damaged[..], &bytes(n)].concat());
            ran += 1;
        }
    }
    println!("{ran} damaged blocks");
}
