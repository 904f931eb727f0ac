//! What the reader has to know besides the program: dialect, limits, tools, and where subroutines
//! are.

pub(crate) mod tools;

use std::fmt;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::settings::tools::ToolTable;
use crate::text::suggestion::nearest;

/// Name under which the dialect is chosen by the beginning of the file.
pub const AUTO: &str = "auto";
/// Every other name of a dialect.
pub const DIALECTS: [(&str, Dialect); 10] = [
    ("linuxcnc", Dialect::LinuxCnc),
    ("fanuc", Dialect::Fanuc),
    ("haas", Dialect::Haas),
    ("fanuc-mill", Dialect::FanucMill),
    ("haas-mill", Dialect::FanucMill),
    ("fanuc-lathe", Dialect::FanucLathe),
    ("haas-lathe", Dialect::HaasLathe),
    ("grbl", Dialect::Grbl),
    ("marlin", Dialect::Printer),
    ("klipper", Dialect::Printer),
];

/// Whose G-code it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Dialect {
    /// RS-274/NGC as LinuxCNC 2.9 reads it.
    LinuxCnc,
    /// Fanuc and its relatives; the program shows whether for a mill or for a lathe.
    Fanuc,
    /// Haas; the program shows whether for a mill or for a lathe.
    Haas,
    /// Mills of Fanuc, Haas and their relatives: O-numbers, machine M-codes.
    FanucMill,
    /// Lathes of Fanuc and its relatives, G-code system A: X is a diameter, U and W are distances,
    /// G90 is a turning cycle.
    FanucLathe,
    /// Lathes of Haas: the same, but R of a drilling cycle is a coordinate.
    HaasLathe,
    /// grbl and the senders around it: no program end needed, `$` lines.
    Grbl,
    /// Marlin, Klipper and other firmware of 3D printers: an E axis, M-codes without limit, G28 is
    /// homing.
    Printer,
}

impl Dialect {
    /// Returns true if words mean what they do on Fanuc and Haas controls.
    pub const fn is_fanuc(self) -> bool {
        matches!(self, Self::Fanuc | Self::Haas | Self::FanucMill) || self.is_lathe()
    }

    /// Returns true if the program is for a Fanuc or Haas lathe.
    pub(crate) const fn is_lathe(self) -> bool {
        matches!(self, Self::FanucLathe | Self::HaasLathe)
    }

    /// Returns the dialect with this name in [`DIALECTS`], ignoring case; `None` for [`AUTO`].
    ///
    /// # Errors
    /// If `name` is neither in [`DIALECTS`] nor [`AUTO`].
    pub fn named(name: &str) -> Result<Option<Self>, UnknownDialect> {
        if name.eq_ignore_ascii_case(AUTO) {
            return Ok(None);
        }
        match DIALECTS
            .iter()
            .find(|(known, _)| known.eq_ignore_ascii_case(name))
        {
            Some((_, dialect)) => Ok(Some(*dialect)),
            None => Err(UnknownDialect::new(name)),
        }
    }
}

/// A name that no dialect has.
#[derive(Debug, Clone, PartialEq, Eq, Error, miette::Diagnostic)]
#[error("no dialect is called '{name}'; there are {}", names().join(", "))]
pub struct UnknownDialect {
    /// Name that the user gave.
    pub(crate) name: String,
    /// Closest known dialect, if one is close, and how to let the program decide.
    #[help]
    pub(crate) hint: String,
}

impl UnknownDialect {
    fn new(name: &str) -> Self {
        let meant = nearest(name, &names())
            .map_or(String::new(), |meant| format!("did you mean '{meant}'? "));
        Self {
            name: name.to_owned(),
            hint: format!("{meant}'{AUTO}' chooses by the beginning of the program"),
        }
    }
}

fn names() -> Vec<&'static str> {
    std::iter::once(AUTO)
        .chain(DIALECTS.iter().map(|(name, _)| *name))
        .collect()
}

impl fmt::Display for Dialect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::LinuxCnc => "LinuxCNC",
            Self::Fanuc | Self::Haas => "Fanuc/Haas",
            Self::FanucMill => "Fanuc/Haas mill",
            Self::FanucLathe => "Fanuc lathe",
            Self::HaasLathe => "Haas lathe",
            Self::Grbl => "grbl",
            Self::Printer => "Marlin/Klipper",
        })
    }
}

/// Least input increment of a control: IS-A, IS-B or IS-C. Serialised by its metric name.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Increment {
    /// Millimetres, or degrees.
    mm: f64,
}

/// Every increment by its names, in mm and in inches.
const INCREMENTS: [(&str, &str, f64); 3] = [
    ("0.01mm", "0.001inch", 0.01),
    ("0.001mm", "0.0001inch", 0.001),
    ("0.0001mm", "0.00001inch", 0.0001),
];

impl Increment {
    /// Returns the increment with a name such as `0.001mm` or `0.0001inch`, ignoring case and
    /// blanks.
    ///
    /// # Errors
    /// If no increment has this name.
    pub fn named(name: &str) -> Result<Self, UnknownIncrement> {
        let plain = name.to_ascii_lowercase().replace(' ', "");
        let row = INCREMENTS
            .iter()
            .find(|row| row.0 == plain || row.1 == plain);
        row.map(|row| Self { mm: row.2 })
            .ok_or_else(|| UnknownIncrement {
                name: name.to_owned(),
            })
    }

    /// Returns the length of one increment, in the unit of the program.
    pub(crate) const fn units(self, inch: bool) -> f64 {
        if inch { 0.1 * self.mm } else { self.mm }
    }
}

impl TryFrom<String> for Increment {
    type Error = UnknownIncrement;

    fn try_from(name: String) -> Result<Self, UnknownIncrement> {
        Self::named(&name)
    }
}

impl From<Increment> for String {
    fn from(increment: Increment) -> Self {
        format!("{}mm", increment.mm)
    }
}

/// A name that no increment has.
#[derive(Debug, Clone, PartialEq, Eq, Error, miette::Diagnostic)]
#[error(
    "'{name}' is no least input increment; there are 0.01mm, 0.001mm, 0.0001mm, 0.001inch, 0.0001inch and 0.00001inch"
)]
#[diagnostic(help("most controls have 0.001mm, which is 0.0001inch in programs in inches"))]
pub struct UnknownIncrement {
    /// Increment that the user gave.
    pub(crate) name: String,
}

/// Settings of a [`Reader`](crate::Reader).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Dialect; `None` chooses by the beginning of the file.
    pub dialect: Option<Dialect>,
    /// Length that one count of a number without a decimal point stands for on a Fanuc or Haas.
    /// `None` reads such numbers as whole millimeters or inches.
    pub increment: Option<Increment>,
    /// True where the reader skips lines that begin with `/`. Off by default, like the block delete
    /// switch of a control.
    pub block_delete: bool,
    /// Faults that are kept before the rest is only counted.
    pub max_errors: usize,
    /// Largest coordinate, mm. 1 km: no machine is larger, and beyond it f64 begins to lose the
    /// nanometre.
    pub coordinate_limit_mm: f64,
    /// Lines that may be carried out without a motion before the program counts as an endless loop.
    pub max_idle_lines: u64,
    /// Motions that a program may have.
    pub max_motions: u64,
    /// Calls and loops inside each other.
    pub max_depth: usize,
    /// Folders searched for subroutine files, besides the folder of the program.
    pub subroutine_paths: Vec<PathBuf>,
    /// Tools: lengths and diameters.
    pub tools: ToolTable,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            dialect: None,
            increment: None,
            block_delete: false,
            max_errors: 100,
            coordinate_limit_mm: 1e6,
            // A file of ten million comment lines still passes; an empty loop ends after about a
            // second.
            max_idle_lines: 20_000_000,
            max_motions: 1_000_000_000,
            max_depth: 100,
            subroutine_paths: Vec::new(),
            tools: ToolTable::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dialects_have_names() {
        assert_eq!(Dialect::named("AUTO"), Ok(None));
        for (name, dialect) in DIALECTS {
            assert_eq!(Dialect::named(&name.to_uppercase()), Ok(Some(dialect)));
        }
        let unknown = Dialect::named("linuxcn").unwrap_err();
        assert!(unknown.to_string().ends_with(
            "haas, fanuc-mill, haas-mill, fanuc-lathe, haas-lathe, grbl, marlin, klipper"
        ));
        assert!(unknown.hint.starts_with("did you mean 'linuxcnc'?"));
    }
}
