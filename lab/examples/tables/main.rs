//! Regenerates the tables of docs/results.md and of examples/*/README.md in their places: `just
//! tables`, which makes the comparisons first.

mod table;

use std::error::Error;

use table::{Place, root};

fn main() -> Result<(), Box<dyn Error>> {
    for place in Place::results()?.into_iter().chain([Place::paper()?]) {
        let path = root().join(place.file);
        let text = std::fs::read_to_string(&path)?;
        let old = place.find(&text)?;
        std::fs::write(
            &path,
            [&text[..old.start], &place.table, &text[old.end..]].concat(),
        )?;
        println!("{}, {}\n{}", place.file, place.name, place.table);
    }
    Ok(())
}
