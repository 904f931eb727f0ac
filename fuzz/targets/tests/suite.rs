//! Every target on its seeds, on what the fuzzer found, and on bytes of a generator.

use std::path::Path;

use feedwright_fuzz_targets::TARGETS;

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
    (0..BYTES / 8).map(word).flat_map(u64::to_le_bytes).collect()
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

/// With `FEEDWRIGHT_FUZZ="TARGET FIRST COUNT"`, other seeds of one target.
#[test]
fn every_target_holds_on_drawn_bytes() {
    let asked = std::env::var("FEEDWRIGHT_FUZZ").unwrap_or_default();
    let asked: Vec<&str> = asked.split_whitespace().collect();
    for ((name, run), (drawn, count)) in TARGETS.into_iter().zip(DRAWN) {
        assert_eq!(name, drawn);
        let seeds = match asked[..] {
            [target, first, count] if target == name => {
                let [first, count]: [u64; 2] = [first, count].map(|number| number.parse().expect("a whole number"));
                first..first + count
            }
            [] => 0..count,
            _ => continue,
        };
        for seed in seeds {
            println!("{name} {seed}");
            run(&bytes(seed));
        }
    }
}
