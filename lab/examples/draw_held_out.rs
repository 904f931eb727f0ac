//! Draws the seeds of the held-out work of `feedwright-lab compare --work held-out` anew and
//! records them: `cargo run --release -p feedwright-lab --example draw_held_out`, when all settings
//! are final.

use std::error::Error;
use std::hash::{BuildHasher, RandomState};
use std::path::Path;

use feedwright::command::today;
use feedwright_lab::HeldOutSeeds;

/// The first seed is below this. With at most nine digits it is easy to read.
const SEEDS: u64 = 1_000_000_000;

fn main() -> Result<(), Box<dyn Error>> {
    let date = today()?;
    // The keys of this hash are from the system's random numbers.
    let first = RandomState::new().hash_one(&date) % SEEDS;
    let seeds = HeldOutSeeds::draw(first, date)?;
    let text = serde_json::to_string_pretty(&seeds)? + "\n";
    std::fs::write(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("src/compare/held_out_seeds.json"),
        &text,
    )?;
    print!("{text}");
    Ok(())
}
