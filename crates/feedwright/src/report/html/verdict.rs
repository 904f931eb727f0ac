//! The headline as HTML.

use crate::report::Report;
use crate::report::headline::{HeadlinePart, headline};
use crate::report::text::escaped;

/// The headline, escaped, with names and values set apart.
pub(super) fn verdict(report: &Report) -> String {
    headline(report).parts.iter().map(html).collect()
}

fn html(part: &HeadlinePart) -> String {
    match part {
        HeadlinePart::Text(text) => escaped(text),
        HeadlinePart::Name(name) => format!("<b>{}</b>", escaped(name)),
        HeadlinePart::Value { before, after, change } => {
            let before = before.as_ref().map_or(String::new(), |before| format!("{} → ", escaped(before)));
            let change = change
                .as_ref()
                .map_or(String::new(), |change| format!(" <span class=\"change\">({})</span>", escaped(change)));
            format!("<span class=\"step\">{before}<b>{}</b>{change}</span>", escaped(after))
        }
    }
}
