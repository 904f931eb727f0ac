//! `draw FILE.svg` draws the figure that standard input has as JSON. A curve has a color of its own,
//! or `color N` of the colors of all figures.

use feedwright::{COLORS, Figure};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).ok_or("usage: draw FILE.svg")?;
    let text = std::io::read_to_string(std::io::stdin())?;
    std::fs::write(file, drawn(&text)?)?;
    Ok(())
}

fn drawn(text: &str) -> serde_json::Result<String> {
    let named = COLORS
        .iter()
        .enumerate()
        .fold(text.to_owned(), |text, (number, color)| {
            text.replace(&format!("\"color {number}\""), &format!("\"{color}\""))
        });
    Ok(serde_json::from_str::<Figure>(&named)?.to_svg())
}
