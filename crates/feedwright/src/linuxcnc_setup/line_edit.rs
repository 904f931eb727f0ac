//! A line of a HAL file with other words.

use std::collections::BTreeMap;

use super::hal::HalLine;
use super::netlist::ARROWS;

/// Changes of one line.
#[derive(Debug, Default)]
pub(crate) struct HalLineEdit {
    /// Words by their number that are replaced, or taken out where there is nothing in their place.
    pub(crate) words: BTreeMap<usize, Option<String>>,
    /// Lines behind it.
    pub(crate) after: Vec<String>,
}

/// A line with other words. A `net` that has no pin left becomes a comment.
pub(crate) fn edited(line: &HalLine, words: &BTreeMap<usize, Option<String>>) -> String {
    let is_arrow = |number: usize| ARROWS.contains(&line.word(number));
    let is_taken = |number: &usize| words.get(number) == Some(&None);
    let has_pins = (2..line.words.len()).any(|number| !is_arrow(number) && !is_taken(&number));
    let takes_out = words.values().any(Option::is_none);
    if takes_out && (line.word(0) != "net" || !has_pins) {
        return format!("# {}", line.text.replace('\n', "\n# "));
    }
    let mut changes = words.clone();
    // An arrow in front of a word that is taken out goes with it.
    changes.extend(
        (1..line.words.len())
            .filter(is_taken)
            .map(|number| number - 1)
            .filter(|&n| is_arrow(n))
            .map(|n| (n, None)),
    );
    let mut text = line.text.clone();
    let mut end = line.words.len();
    // Words of one value of the INI file stand in one place.
    for place in line.words.chunk_by(|a, b| a.span == b.span).rev() {
        let numbers = end - place.len()..end;
        end = numbers.start;
        if changes.range(numbers.clone()).next().is_some() {
            let left = numbers
                .filter_map(|n| changes.get(&n).map_or(Some(line.word(n)), Option::as_deref));
            text.replace_range(place[0].span.clone(), &left.collect::<Vec<_>>().join(" "));
        }
    }
    text.truncate(text.trim_end().len());
    text
}
