//! Writes the test parts: `cargo run -p feedwright-lab --example make_parts -- parts`.
//!
//! Curves become biarcs within [`biarc::TOLERANCE_MM`] (`biarc.rs`), the pocket is laid out in `pocket.rs`. What the files
//! must hold is checked against the closed forms by `tests/oracle_parts.rs`, which shares no code with this program.

mod biarc;
mod pocket;
mod shapes;

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let Some(folder) = std::env::args_os().nth(1) else {
        eprintln!("usage: make_parts DIRECTORY");
        return ExitCode::from(2);
    };
    for (name, text) in shapes::all().into_iter().chain([("pocket.ngc", pocket::program())]) {
        let path = Path::new(&folder).join(name);
        if let Err(error) = std::fs::write(&path, &text) {
            eprintln!("cannot write {}: {error}", path.display());
            return ExitCode::from(2);
        }
        println!("{}: {} lines", path.display(), text.lines().count());
    }
    ExitCode::SUCCESS
}

/// A coordinate as G-code writes it: at most six decimals (1 nm), no trailing zeros, no negative zero.
fn word(letter: char, value_mm: f64) -> String {
    let rounded = format!("{value_mm:.6}");
    let trimmed = rounded.trim_end_matches('0').trim_end_matches('.');
    format!("{letter}{}", if trimmed == "-0" { "0" } else { trimmed })
}
