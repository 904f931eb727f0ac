//! Pages of tables and figures: head, table of contents, parts that fold, foot. Without scripts
//! everything is there, but nothing is sorted.

use std::io::{self, Write};

use super::page_frame::{PageFrame, in_one_scope};
use super::text::escaped;

const PAGE_CSS: &str = include_str!("../../assets/report/pages.css");
const PAGE_JS: &str = include_str!("../../assets/report/pages.js");

/// A part of a page, as its table of contents has it.
#[derive(Debug, Clone, Default)]
pub struct PagePart {
    /// What a link leads to: letters, digits and dashes.
    pub id: String,
    /// Heading.
    pub title: String,
    /// What stands beside the heading while it is folded; may be empty.
    pub note: String,
    /// Whether it is folded to begin with.
    pub folded: bool,
    /// What it stands under in the contents; may be empty.
    pub group: String,
    /// What it is called there, where not by its title.
    pub short: Option<String>,
}

impl PagePart {
    /// One that is open, under no group.
    pub fn new(id: &str, title: impl Into<String>) -> Self {
        Self {
            id: id.to_owned(),
            title: title.into(),
            ..Self::default()
        }
    }

    /// Its beginning.
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

    /// Its end.
    pub fn end(out: &mut impl Write) -> io::Result<()> {
        out.write_all(b"</details>\n")
    }
}

/// The beginning of a page, up to its first part. `class` is "tables" or "figures": the second is
/// narrow, to be read.
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

/// The end of such a page.
pub fn write_foot(out: &mut impl Write) -> io::Result<()> {
    out.write_all(b"</main>\n</div>\n")?;
    frame().write_end(out)
}

fn frame() -> PageFrame {
    PageFrame::new(&[PAGE_CSS], vec![in_one_scope(&[PAGE_JS])])
}

/// The beginning of a table, up to its first row.
pub fn write_table_head<'a>(
    out: &mut impl Write,
    heads: impl IntoIterator<Item = &'a str>,
) -> io::Result<()> {
    // With the keyboard a table that is wider than the screen is moved once it has the focus. A
    // heading says something.
    out.write_all(b"<div class=\"wide\" tabindex=\"0\"><table><thead><tr>")?;
    for head in heads {
        match head {
            "" => out.write_all(b"<td></td>")?,
            head => write!(out, "<th scope=\"col\">{}</th>", escaped(head))?,
        }
    }
    out.write_all(b"</tr></thead><tbody>\n")
}

/// Its end.
pub fn write_table_end(out: &mut impl Write) -> io::Result<()> {
    out.write_all(b"</tbody></table></div>\n")
}
