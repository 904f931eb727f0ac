//! Tool table: lengths, diameters and lathe angles by tool number, in LinuxCNC's text format.
//!
//! One tool a line, words in any order, `;` begins a remark: `T1 P1 Z+25.4 D6.0 ; end mill`.

use std::collections::BTreeMap;

use super::codes::AXIS_LETTERS;

/// One tool.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tool {
    /// Offsets of X Y Z A B C U V W, mm and degrees.
    pub offset: [f64; 9],
    /// Diameter, mm.
    pub diameter_mm: f64,
    /// Front angle of a lathe tool, degrees.
    pub front_angle_deg: f64,
    /// Back angle of a lathe tool, degrees.
    pub back_angle_deg: f64,
    /// Orientation of a lathe tool, 0 to 9.
    pub orientation: u8,
    /// Pocket of the changer.
    pub pocket: u32,
}

/// All tools by number.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ToolTable {
    /// Tools by number.
    pub tools: BTreeMap<u32, Tool>,
}

impl ToolTable {
    /// The tool with a number.
    pub fn get(&self, number: u32) -> Option<&Tool> {
        self.tools.get(&number)
    }

    /// Reads a table; `unit_mm` is the length of its unit in mm.
    ///
    /// # Errors
    /// Line number and reason where a line is not understood.
    pub fn parse(text: &str, unit_mm: f64) -> Result<Self, (u32, String)> {
        let mut table = Self::default();
        for (line, text) in (1..).zip(text.lines()) {
            let words = text.split(';').next().unwrap_or("").trim();
            if words.is_empty() {
                continue;
            }
            let (number, tool) = parse_tool(words, unit_mm).map_err(|message| (line, message))?;
            table.tools.insert(number, tool);
        }
        Ok(table)
    }
}

fn parse_tool(words: &str, unit_mm: f64) -> Result<(u32, Tool), String> {
    let mut tool = Tool::default();
    let mut number = None;
    for word in words.split_whitespace() {
        let letter = word.bytes().next().unwrap_or(b' ').to_ascii_lowercase();
        let rest = word.get(1..).unwrap_or("");
        let value: f64 = rest.parse().map_err(|_| format!("`{word}`: a number is missing"))?;
        let whole = || -> Result<u32, String> {
            if value >= 0.0 && value.fract() == 0.0 && value <= f64::from(u32::MAX) {
                Ok(value as u32)
            } else {
                Err(format!("`{word}`: not a whole number"))
            }
        };
        match letter {
            b't' => number = Some(whole()?),
            b'p' => tool.pocket = whole()?,
            b'd' => tool.diameter_mm = value * unit_mm,
            b'i' => tool.front_angle_deg = value,
            b'j' => tool.back_angle_deg = value,
            b'q' => {
                tool.orientation =
                    u8::try_from(whole()?).ok().filter(|&q| q <= 9).ok_or_else(|| format!("`{word}`: 0 to 9"))?;
            }
            _ => {
                let axis = AXIS_LETTERS
                    .iter()
                    .position(|&axis| axis == letter)
                    .ok_or_else(|| format!("`{word}`: unknown word"))?;
                tool.offset[axis] = if (3..6).contains(&axis) { value } else { value * unit_mm };
            }
        }
    }
    number.map(|number| (number, tool)).ok_or_else(|| "the tool number T is missing".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_in_inches_is_read() {
        let table = ToolTable::parse("T1 P3 Z+0.511 D0.125 ; mill\n; nothing\nT20 I30 J150 Q2 A5", 25.4).unwrap();
        let first = table.get(1).unwrap();
        assert_eq!((first.offset[2], first.diameter_mm, first.pocket), (0.511 * 25.4, 0.125 * 25.4, 3));
        let second = table.get(20).unwrap();
        assert_eq!(
            (second.front_angle_deg, second.back_angle_deg, second.orientation, second.offset[3]),
            (30.0, 150.0, 2, 5.0)
        );
    }

    #[test]
    fn faults_name_line_and_word() {
        assert_eq!(ToolTable::parse("T1\nT2 Z1,5", 1.0).unwrap_err(), (2, "`Z1,5`: a number is missing".to_owned()));
        assert!(ToolTable::parse("P1", 1.0).unwrap_err().1.contains("tool number"));
        assert!(ToolTable::parse("é", 1.0).is_err());
    }
}
