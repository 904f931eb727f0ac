//! The headline as HTML.

use crate::report::headline::{HeadlinePart, headline};
use crate::report::text::escaped;
use crate::report::{PageUnits, Report};

/// Returns the headline, escaped, with names and values highlighted.
pub(super) fn verdict(report: &Report, units: PageUnits) -> String {
    headline(report)
        .parts
        .iter()
        .map(|part| html(part, units))
        .collect()
}

fn html(part: &HeadlinePart, units: PageUnits) -> String {
    match part {
        HeadlinePart::Text(text) => escaped(&units.text(text)),
        HeadlinePart::Name(name) => format!("<b>{}</b>", escaped(name)),
        HeadlinePart::Value {
            before,
            after,
            change,
        } => {
            let before = before.as_ref().map_or(String::new(), |before| {
                format!("{} → ", escaped(&units.text(before)))
            });
            let change = change.as_ref().map_or(String::new(), |change| {
                format!(" <span class=\"change\">({})</span>", escaped(change))
            });
            format!(
                "<span class=\"step\">{before}<b>{}</b>{change}</span>",
                escaped(&units.text(after))
            )
        }
    }
}
