//! What the reader has to know besides the program: dialect, limits, tools, and where subroutines are.

use std::fmt;
use std::path::PathBuf;

use super::tools::ToolTable;

/// Whose G-code it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dialect {
    /// RS-274/NGC as LinuxCNC 2.9 reads it.
    LinuxCnc,
    /// Fanuc, Haas and their relatives: O-numbers, machine M-codes.
    Fanuc,
    /// grbl and the senders around it: no program end needed, `$` lines.
    Grbl,
    /// Marlin, Klipper and other firmware of 3D printers: an E axis, M-codes without limit, G28 is homing.
    Printer,
}

impl fmt::Display for Dialect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::LinuxCnc => "LinuxCNC",
            Self::Fanuc => "Fanuc/Haas",
            Self::Grbl => "grbl",
            Self::Printer => "Marlin/Klipper",
        })
    }
}

/// Settings of a [`super::Reader`].
#[derive(Debug, Clone)]
pub struct Settings {
    /// Dialect; `None` chooses by the beginning of the file.
    pub dialect: Option<Dialect>,
    /// Whether lines that begin with `/` are left out. Off, as on a control whose switch nobody touched.
    pub block_delete: bool,
    /// Faults that are kept before the rest is only counted.
    pub max_errors: usize,
    /// Largest coordinate, mm. 1 km: no machine is larger, and beyond it f64 begins to lose the nanometre.
    pub coordinate_limit_mm: f64,
    /// Lines that may be carried out without a motion before the program counts as an endless loop.
    pub max_idle_lines: u64,
    /// Motions and events that a program may have.
    pub max_motions: u64,
    /// Calls and loops inside each other.
    pub max_depth: usize,
    /// Where files of subroutines are looked for, besides the folder of the program.
    pub subroutine_paths: Vec<PathBuf>,
    /// Tools: lengths and diameters.
    pub tools: ToolTable,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            dialect: None,
            block_delete: false,
            max_errors: 100,
            coordinate_limit_mm: 1e6,
            // A file of ten million comment lines still passes; an empty loop ends after about a second.
            max_idle_lines: 20_000_000,
            max_motions: 1_000_000_000,
            max_depth: 100,
            subroutine_paths: Vec::new(),
            tools: ToolTable::default(),
        }
    }
}
