//! Tables that fit the terminal: where there is no room, the least important columns are left out,
//! and the table says so.

use std::borrow::Cow;
use std::io::{self, Write};

use feedwright_gcode::visible;

use crate::command::terminal::{columns, is_inch};
use crate::inches::{cell_in_inches, heading_in_inches};

/// A column: its heading, in one line or two, and how important it is; 0 is never left out.
#[derive(Debug, Clone)]
pub struct TableColumn {
    heading: Cow<'static, str>,
    importance: u8,
}

impl TableColumn {
    /// Creates a column that is always shown.
    pub const fn new(heading: &'static str) -> Self {
        Self {
            heading: Cow::Borrowed(heading),
            importance: 0,
        }
    }

    /// Creates a column that may be left out. Columns with the highest number are left out first.
    pub const fn optional(heading: &'static str, importance: u8) -> Self {
        Self {
            heading: Cow::Borrowed(heading),
            importance,
        }
    }
}

/// Rows of cells: the first is a name at the left, the others stand at the right of their columns.
#[derive(Debug)]
pub struct ConsoleTable {
    columns: Vec<TableColumn>,
    rows: Vec<TableRow>,
}

#[derive(Debug)]
enum TableRow {
    Cells(Vec<String>),
    /// Remark about the row above.
    Remark(String),
    /// The heading is repeated, with this in its first column.
    Section(String),
}

/// Longest name, columns. The beginning of a longer name is cut off.
const MOST_NAME: usize = 44;

impl ConsoleTable {
    /// Creates a table without rows.
    pub fn new(columns: Vec<TableColumn>) -> Self {
        Self {
            columns,
            rows: Vec::new(),
        }
    }

    /// Adds a row, a cell for each column.
    pub fn row(&mut self, cells: Vec<String>) {
        self.rows.push(TableRow::Cells(
            cells
                .iter()
                .map(|cell| visible(cell).into_owned())
                .collect(),
        ));
    }

    /// Adds a remark to the last row.
    pub fn remark(&mut self, text: String) {
        self.rows.push(TableRow::Remark(text));
    }

    /// Begins a part of the table.
    pub fn section(&mut self, name: String) {
        self.rows
            .push(TableRow::Section(visible(&name).into_owned()));
    }

    /// Prints it for the terminal.
    pub fn print(&self, out: &mut dyn Write) -> io::Result<()> {
        self.print_within(out, columns())
    }

    fn print_within(&self, out: &mut dyn Write, room: usize) -> io::Result<()> {
        if is_inch() {
            self.in_inches().print_metric(out, room)
        } else {
            self.print_metric(out, room)
        }
    }

    /// The table with lengths in inches.
    fn in_inches(&self) -> Self {
        let headings: Vec<(String, Option<f64>)> = self
            .columns
            .iter()
            .map(|column| heading_in_inches(&column.heading))
            .collect();
        let cells = |cells: &Vec<String>| {
            let pairs = cells.iter().zip(&headings);
            pairs
                .map(|(cell, (_, factor))| {
                    factor.map_or_else(|| cell.clone(), |factor| cell_in_inches(cell, factor))
                })
                .collect()
        };
        let row = |row: &TableRow| match row {
            TableRow::Cells(of_row) => TableRow::Cells(cells(of_row)),
            TableRow::Remark(text) => TableRow::Remark(text.clone()),
            TableRow::Section(name) => TableRow::Section(name.clone()),
        };
        let column = |(column, (heading, _)): (&TableColumn, &(String, Option<f64>))| TableColumn {
            heading: Cow::Owned(heading.clone()),
            importance: column.importance,
        };
        Self {
            columns: self.columns.iter().zip(&headings).map(column).collect(),
            rows: self.rows.iter().map(row).collect(),
        }
    }

    fn print_metric(&self, out: &mut dyn Write, room: usize) -> io::Result<()> {
        let widths = self.widths();
        let shown = self.shown(&widths, room);
        // Two blanks between the columns where there is room.
        let wanted = shown.iter().map(|&i| widths[i] + 2).sum::<usize>() - 2;
        let widths: Vec<usize> = if wanted <= room {
            widths
                .iter()
                .enumerate()
                .map(|(i, width)| if i == 0 { *width } else { width + 1 })
                .collect()
        } else {
            widths
        };
        let others: usize = shown
            .iter()
            .filter(|&&i| i > 0)
            .map(|&i| widths[i] + 1)
            .sum();
        let name = widths[0].min(room.saturating_sub(others).max(8));
        if !matches!(self.rows.first(), Some(TableRow::Section(_))) {
            self.heading(out, &self.columns[0].heading, name, &shown, &widths)?;
        }
        for row in &self.rows {
            match row {
                TableRow::Cells(cells) => {
                    let numbers: String = shown
                        .iter()
                        .filter(|&&i| i > 0)
                        .map(|&i| format!(" {:>1$}", cells[i], widths[i]))
                        .collect();
                    writeln!(
                        out,
                        "{}",
                        format!("{:<name$}{numbers}", end_of(&cells[0], name)).trim_end()
                    )?;
                }
                TableRow::Remark(text) => {
                    writeln!(
                        out,
                        "{}",
                        crate::command::terminal::wrapped(&format!("  {text}"), 2)
                    )?;
                }
                TableRow::Section(title) => {
                    writeln!(out)?;
                    self.heading(out, title, name, &shown, &widths)?;
                }
            }
        }
        let left_out: Vec<&str> = (0..self.columns.len())
            .filter(|i| !shown.contains(i))
            .map(|i| &*self.columns[i].heading)
            .collect();
        if !left_out.is_empty() {
            let text = format!(
                "no room for the columns {}: a wider terminal, or COLUMNS=160, shows them",
                left_out.join(", ")
            );
            writeln!(out, "{}", crate::command::terminal::wrapped(&text, 2))?;
        }
        Ok(())
    }

    fn heading(
        &self,
        out: &mut dyn Write,
        name: &str,
        width: usize,
        shown: &[usize],
        widths: &[usize],
    ) -> io::Result<()> {
        let others: String = shown
            .iter()
            .filter(|&&i| i > 0)
            .map(|&i| format!(" {:>1$}", self.columns[i].heading, widths[i]))
            .collect();
        writeln!(
            out,
            "{}",
            format!("{:<width$}{others}", end_of(name, width)).trim_end()
        )
    }

    /// Widths that the columns want.
    fn widths(&self) -> Vec<usize> {
        let mut widths: Vec<usize> = self
            .columns
            .iter()
            .map(|column| column.heading.chars().count())
            .collect();
        for row in &self.rows {
            match row {
                TableRow::Cells(cells) => {
                    for (width, cell) in widths.iter_mut().zip(cells) {
                        *width = (*width).max(cell.chars().count());
                    }
                }
                TableRow::Section(name) => widths[0] = widths[0].max(name.chars().count()),
                TableRow::Remark(_) => {}
            }
        }
        widths[0] = widths[0].min(MOST_NAME);
        widths
    }

    /// Columns that there is room for.
    fn shown(&self, widths: &[usize], room: usize) -> Vec<usize> {
        let mut shown: Vec<usize> = (0..self.columns.len()).collect();
        let wanted = |shown: &[usize]| shown.iter().map(|&i| widths[i] + 1).sum::<usize>() - 1;
        while wanted(&shown) > room {
            let least = shown
                .iter()
                .copied()
                .filter(|&i| self.columns[i].importance > 0);
            let Some(least) = least.max_by_key(|&i| self.columns[i].importance) else {
                break;
            };
            shown.retain(|&i| i != least);
        }
        shown
    }
}

/// The end of a text that is too long.
fn end_of(text: &str, width: usize) -> String {
    let letters = text.chars().count();
    if letters <= width {
        return text.to_owned();
    }
    format!(
        "..{}",
        text.chars().skip(letters + 2 - width).collect::<String>()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn printed(room: usize) -> String {
        let mut table = ConsoleTable::new(vec![
            TableColumn::new(""),
            TableColumn::new("RMS um"),
            TableColumn::optional("time s", 1),
            TableColumn::optional("torque", 2),
        ]);
        table.row(
            ["a-name-of-some-length", "1.25", "100.000", "3"]
                .map(str::to_owned)
                .to_vec(),
        );
        table.row(["b", "10000.25", "1.000", "3"].map(str::to_owned).to_vec());
        let mut out = Vec::new();
        table
            .print_within(&mut out, room)
            .expect("memory takes all");
        String::from_utf8(out).expect("text")
    }

    #[test]
    fn the_least_important_columns_go_first_and_names_last() {
        let wide = printed(80);
        assert_eq!(
            wide.lines().next(),
            Some("                         RMS um   time s  torque")
        );
        assert!(!wide.contains("no room"), "{wide}");
        let narrow = printed(40);
        assert!(
            !narrow.contains("100.000      3") && narrow.contains("no room for the columns torque"),
            "{narrow}"
        );
        let tiny = printed(20);
        assert!(
            tiny.contains("..me-length     1.25") && tiny.contains("columns time s, torque"),
            "{tiny}"
        );
        assert!(
            tiny.lines().take(3).all(|line| line.chars().count() <= 20),
            "{tiny}"
        );
    }
}
