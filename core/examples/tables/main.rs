//! Regenerates the tables of README.md and of examples/01_paper_circle/README.md in their places: `just tables`.

mod table;

use std::error::Error;

use table::{Place, root};

fn main() -> Result<(), Box<dyn Error>> {
    for place in [Place::results()?, Place::paper()?] {
        let path = root().join(place.file);
        let text = std::fs::read_to_string(&path)?;
        let old = place.find(&text)?;
        std::fs::write(&path, [&text[..old.start], &place.table, &text[old.end..]].concat())?;
        println!("{}\n{}", place.file, place.table);
    }
    Ok(())
}
