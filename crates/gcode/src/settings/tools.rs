//! Tool table: lengths, diameters and lathe angles by tool number, in LinuxCNC's text format.
//!
//! One tool a line, words in any order, `;` begins a remark: `T1 P1 Z+25.4 D6.0 ; end mill`.

use std::collections::BTreeMap;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::text::codes::AXIS_LETTERS;
use crate::text::diagnostic::{Diagnostic, LineFault, Read, Severity};
use crate::text::input;

/// One tool.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Tool {
    /// Offsets of X Y Z A B C U V W, mm and degrees.
    pub(crate) offset: [f64; 9],
    /// Diameter, mm.
    pub(crate) diameter_mm: f64,
    /// Wear of length and radius, mm, set by `G10 L11` and `L13` on Fanuc and Haas. `offset` and
    /// `diameter_mm` already include it.
    pub(crate) wear_mm: [f64; 2],
    /// Front angle of a lathe tool, degrees.
    pub(crate) front_angle_deg: f64,
    /// Back angle of a lathe tool, degrees.
    pub(crate) back_angle_deg: f64,
    /// Orientation of a lathe tool, 0 to 9.
    pub(crate) orientation: u8,
    /// Pocket of the changer.
    pub(crate) pocket: u32,
}

/// All tools by number.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ToolTable {
    /// Tools by number.
    pub(crate) tools: BTreeMap<u32, Tool>,
}

impl ToolTable {
    /// The tool with a number.
    pub(crate) fn get(&self, number: u32) -> Option<&Tool> {
        self.tools.get(&number)
    }

    /// Reads the table in a file; `unit_mm` is the length of its unit in mm.
    ///
    /// # Errors
    /// A file that cannot be read, or the faults of all its lines.
    pub fn read(path: &Path, unit_mm: f64) -> Result<Self, ToolTableError> {
        let bytes = input::read(path).map_err(|cause| ToolTableError::Io {
            path: path.to_owned(),
            cause,
        })?;
        let file: Arc<str> = input::name(path).into();
        let (mut table, mut faults) = (Self::default(), Vec::new());
        for (line, bytes) in (1..).zip(bytes.split(|&byte| byte == b'\n')) {
            if let Err(fault) = table.add_line(bytes, unit_mm) {
                faults.push(Diagnostic::of_line(
                    Severity::Error,
                    *fault,
                    file.clone(),
                    line,
                    bytes,
                ));
            }
        }
        if faults.is_empty() {
            Ok(table)
        } else {
            Err(ToolTableError::Faults {
                path: path.to_owned(),
                faults,
            })
        }
    }

    /// Reads a table; `unit_mm` is the length of its unit in mm.
    ///
    /// # Errors
    /// Line number and reason where a line is not understood.
    pub fn parse(text: &str, unit_mm: f64) -> Result<Self, (u32, String)> {
        let mut table = Self::default();
        for (line, text) in (1..).zip(text.lines()) {
            table
                .add_line(text.as_bytes(), unit_mm)
                .map_err(|fault| (line, fault.message))?;
        }
        Ok(table)
    }

    fn add_line(&mut self, line: &[u8], unit_mm: f64) -> Read<()> {
        let words = line.split(|&byte| byte == b';').next().unwrap_or_default();
        if words.trim_ascii().is_empty() {
            return Ok(());
        }
        let (number, tool) = parse_tool(words, unit_mm)?;
        if self.tools.insert(number, tool).is_some() {
            let message = format!("tool {number} stands on an earlier line, too");
            return Err(
                LineFault::new(CODE, 0..words.trim_ascii_end().len(), message)
                    .hint("a tool has one line"),
            );
        }
        Ok(())
    }
}

/// Kind of all faults here.
const CODE: &str = "gcode::tool_table";
/// Larger lengths are typing errors, as in programs: 1 km.
const MAX_MM: f64 = 1e6;

/// The words of a line with their places.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = (Range<usize>, &[u8])> {
    line.split(u8::is_ascii_whitespace)
        .filter(|word| !word.is_empty())
        .map(move |word| {
            let start = word.as_ptr().addr() - line.as_ptr().addr();
            (start..start + word.len(), word)
        })
}

fn parse_tool(line: &[u8], unit_mm: f64) -> Read<(u32, Tool)> {
    let mut tool = Tool::default();
    let mut number = None;
    for (at, bytes) in words(line) {
        let word = String::from_utf8_lossy(bytes);
        let fault = |what: &str| LineFault::new(CODE, at.clone(), format!("`{word}`: {what}"));
        let letter = bytes[0].to_ascii_lowercase();
        let value = word
            .get(1..)
            .and_then(|rest| rest.parse().ok())
            .filter(|value: &f64| value.is_finite());
        let Some(value) = value else {
            let fault = fault("a number is missing");
            return Err(if bytes.contains(&b',') {
                fault.hint("a decimal point is a point: 1.5, not 1,5")
            } else {
                fault
            });
        };
        let whole = || -> Read<u32> {
            if value >= 0.0 && value.fract() == 0.0 && value <= f64::from(u32::MAX) {
                Ok(value as u32)
            } else {
                Err(fault("not a whole number"))
            }
        };
        let length = || -> Read<f64> {
            let length = value * unit_mm;
            if length.abs() <= MAX_MM {
                Ok(length)
            } else {
                Err(fault(&format!("beyond the limit of {MAX_MM} mm")))
            }
        };
        match letter {
            b't' => number = Some(whole()?),
            b'p' => tool.pocket = whole()?,
            b'd' => tool.diameter_mm = length()?,
            b'i' => tool.front_angle_deg = value,
            b'j' => tool.back_angle_deg = value,
            b'q' => {
                tool.orientation = u8::try_from(whole()?)
                    .ok()
                    .filter(|&q| q <= 9)
                    .ok_or_else(|| fault("out of range: 0 to 9"))?;
            }
            _ => {
                let axis = AXIS_LETTERS.iter().position(|&axis| axis == letter).ok_or_else(|| {
                    fault("unknown word").hint("T number, P pocket, D diameter, X to W offsets, I J angles, Q orientation; `;` begins a remark")
                })?;
                tool.offset[axis] = if (3..6).contains(&axis) {
                    value
                } else {
                    length()?
                };
            }
        }
    }
    let missing = || {
        LineFault::new(
            CODE,
            0..line.trim_ascii_end().len(),
            "the tool number T is missing",
        )
    };
    number
        .map(|number| (number, tool))
        .ok_or_else(|| missing().hint("begin the line with T and the number: T1 P1 D6"))
}

/// Why a tool table cannot be used.
#[derive(Debug, Error, miette::Diagnostic)]
pub enum ToolTableError {
    /// No such file, no permission, or the disk fails.
    #[error("{}: the tool table cannot be read: {cause}", path.display())]
    Io {
        /// Path as the user gave it.
        path: PathBuf,
        /// Error of the operating system.
        #[source]
        cause: io::Error,
    },
    /// Lines that are not understood.
    #[error("{}: {} fault{} in the tool table", path.display(), faults.len(), if faults.len() == 1 { "" } else { "s" })]
    Faults {
        /// Path as the user gave it.
        path: PathBuf,
        /// All of them, in the order of the lines.
        #[related]
        faults: Vec<Diagnostic>,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_in_inches_is_read() {
        let table = ToolTable::parse(
            "T1 P3 Z+0.511 D0.125 ; mill\n; nothing\nT20 I30 J150 Q2 A5",
            25.4,
        )
        .unwrap();
        let first = table.get(1).unwrap();
        assert_eq!(
            (first.offset[2], first.diameter_mm, first.pocket),
            (0.511 * 25.4, 0.125 * 25.4, 3)
        );
        let second = table.get(20).unwrap();
        assert_eq!(
            (
                second.front_angle_deg,
                second.back_angle_deg,
                second.orientation,
                second.offset[3]
            ),
            (30.0, 150.0, 2, 5.0)
        );
    }

    #[test]
    fn faults_name_line_and_word() {
        assert_eq!(
            ToolTable::parse("T1\nT2 Z1,5", 1.0).unwrap_err(),
            (2, "`Z1,5`: a number is missing".to_owned())
        );
        assert!(
            ToolTable::parse("P1", 1.0)
                .unwrap_err()
                .1
                .contains("tool number")
        );
        assert!(ToolTable::parse("é", 1.0).is_err());
        assert!(
            ToolTable::parse("T1 D1e300", 25.4)
                .unwrap_err()
                .1
                .contains("limit of 1000000 mm")
        );
        assert!(
            ToolTable::parse("T1 Dnan", 25.4)
                .unwrap_err()
                .1
                .contains("number is missing")
        );
        assert!(
            ToolTable::parse("T1\nT1", 1.0)
                .unwrap_err()
                .1
                .contains("earlier line")
        );
    }
}
