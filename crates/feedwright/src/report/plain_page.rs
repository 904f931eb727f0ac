//! Pages of tables and figures: head, table of contents, parts that fold, foot. Without scripts
//! everything is there, but tables cannot be sorted.

use std::io::{self, Write};

use super::page_frame::{PageFrame, in_one_scope};
use super::text::escaped;

const PAGE_CSS: &str = include_str!("../../assets/report/pages.css");
const PAGE_JS: &str = include_str!("../../assets/report/pages.js");

/// A part of a page, as its table of contents has it.
#[derive(Debug, Clone, Default)]
pub struct PagePart {
    /// Target of links to the part: letters, digits and dashes.
    pub id: String,
    /// Heading.
    pub title: String,
    /// Text beside the heading while the part is folded; may be empty.
    pub note: String,
    /// True where the part is folded at first.
    pub folded: bool,
    /// Group of the part in the contents; may be empty.
    pub group: String,
    /// Name of the part in the contents, if it is not its title.
    pub short: Option<String>,
}

impl PagePart {
    /// Creates a part that is open and has no group.
    pub fn new(id: &str, title: impl Into<String>) -> Self {
        Self {
            id: id.to_owned(),
            title: title.into(),
            ..Self::default()
        }
    }

    /// Writes the beginning of the part.
    pub fn begin(&self, out: &mut impl Write) -> io::Result<()> {
        let note = if self.note.is_empty() {
            String::new()
        } else {
            format!("<small>{}</small>", escaped(&self.note))
        };
        writeln!(
            out,
            "<details class=\"part\" id=\"{}\"{}><summary><h2>{}</h2>{note}</summary>",
            self.id,
            if self.folded { "" } else { " open" },
            escaped(&self.title)
        )
    }

    /// Writes the end of a part.
    pub fn end(out: &mut impl Write) -> io::Result<()> {
        out.write_all(b"</details>\n")
    }
}

/// Writes the beginning of a page, up to its first part. `class` is "tables" or "figures": the
/// second is narrow, for reading.
pub fn write_head(
    out: &mut impl Write,
    class: &str,
    title: &str,
    introduction: &str,
    parts: &[PagePart],
) -> io::Result<()> {
    frame().write_head(out, title)?;
    write!(out, "<body class=\"{class}\">\n<div class=\"page\">\n")?;
    write_contents(out, parts)?;
    writeln!(
        out,
        "<main>\n<h1>{}</h1>\n<p>{}</p>",
        escaped(title),
        escaped(introduction)
    )
}

fn write_contents(out: &mut impl Write, parts: &[PagePart]) -> io::Result<()> {
    out.write_all(
        b"<nav class=\"contents\" aria-label=\"Contents\"><details open><summary>Contents</summary>\n\
          <div class=\"buttons needs-script\"><button type=\"button\" id=\"unfold\">Unfold all</button>\
          <button type=\"button\" id=\"fold\">Fold all</button><button type=\"button\" id=\"theme\">Theme: auto</button></div>\n<ol>\n",
    )?;
    for group in parts.chunk_by(|a, b| a.group == b.group) {
        let grouped = !group[0].group.is_empty();
        if grouped {
            write!(out, "<li>{}<ol>", escaped(&group[0].group))?;
        }
        for part in group {
            let title = escaped(part.short.as_ref().unwrap_or(&part.title));
            write!(out, "<li><a href=\"#{}\">{title}</a></li>", part.id)?;
        }
        out.write_all(if grouped { b"</ol></li>\n" } else { b"\n" })?;
    }
    out.write_all(b"</ol></details></nav>\n")
}

/// Writes the end of such a page.
pub fn write_foot(out: &mut impl Write) -> io::Result<()> {
    out.write_all(b"</main>\n</div>\n")?;
    frame().write_end(out)
}

fn frame() -> PageFrame {
    PageFrame::new(&[PAGE_CSS], vec![in_one_scope(&[PAGE_JS])])
}

/// Writes the beginning of a table, up to its first row.
pub fn write_table_head<'a>(
    out: &mut impl Write,
    heads: impl IntoIterator<Item = &'a str>,
) -> io::Result<()> {
    // With the keyboard, a table that is wider than the screen scrolls once it has the focus. A
    // heading must not be empty.
    out.write_all(b"<div class=\"wide\" tabindex=\"0\"><table><thead><tr>")?;
    for head in heads {
        match head {
            "" => out.write_all(b"<td></td>")?,
            head => write!(out, "<th scope=\"col\">{}</th>", escaped(head))?,
        }
    }
    out.write_all(b"</tr></thead><tbody>\n")
}

/// Writes the end of a table.
pub fn write_table_end(out: &mut impl Write) -> io::Result<()> {
    out.write_all(b"</tbody></table></div>\n")
}
