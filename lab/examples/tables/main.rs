//! Regenerates the tables of docs/results.md and of examples/*/README.md in their places: `just tables`, which makes
//! the comparisons first.

mod table;

use std::error::Error;

use feedwright_lab::Comparison;
use table::{COMPARISON, HELD_OUT, IMPERFECTIONS, Place, root};

fn main() -> Result<(), Box<dyn Error>> {
    keep_comparisons()?;
    for place in Place::results()?.into_iter().chain([Place::paper()?]) {
        let path = root().join(place.file);
        let text = std::fs::read_to_string(&path)?;
        let old = place.find(&text)?;
        std::fs::write(&path, [&text[..old.start], &place.table, &text[old.end..]].concat())?;
        println!("{}, {}\n{}", place.file, place.name, place.table);
    }
    Ok(())
}

/// Keeps the rows of the comparisons without their plots.
fn keep_comparisons() -> Result<(), Box<dyn Error>> {
    let made = ["target/compare.json", "target/held_out.json", "target/imperfections.json"];
    for (made, kept) in made.into_iter().zip([COMPARISON, HELD_OUT, IMPERFECTIONS]) {
        let mut comparison: Comparison = serde_json::from_slice(&std::fs::read(root().join(made))?)?;
        for row in &mut comparison.rows {
            row.error_um.clear();
        }
        std::fs::write(root().join(kept), serde_json::to_string_pretty(&comparison)? + "\n")?;
    }
    Ok(())
}
