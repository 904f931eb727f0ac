//! The controls that a corrected program is for.
//!
//! A row says how the control plans the speed, by the name of a [feed planner](feedwright_plan::feed), and what its programs may hold. To add
//! a control is one row.

use feedwright_gcode::Dialect;
use feedwright_gcode::canon::Corner;
use feedwright_plan::feed_planner;
use feedwright_sim::{Machine, Stages};

/// A row of [`TARGETS`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TargetControl {
    /// Name, as in `--for`.
    pub name: &'static str,
    /// What it stands for, for lists.
    pub about: &'static str,
    /// Name of its feed planner.
    pub planner: &'static str,
    /// How blocks of a corrected stretch meet; none is as in the program, and without exact stops.
    pub corner: Option<Corner>,
    /// Most characters of a line.
    pub columns: usize,
    /// Decimals of a coordinate in mm.
    pub decimals: u32,
    /// Loops, subroutines and parameters that it runs.
    pub macros: MacroLanguage,
}

/// In which words a control takes loops, subroutines and parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MacroLanguage {
    /// In those of the program: it is the control that the program was written for.
    OfProgram,
    /// O-words, as LinuxCNC.
    OWords,
    /// Custom macro B, M98 and M99.
    Fanuc,
    /// In none.
    None,
}

/// All target controls; the first is the default.
pub const TARGETS: &[TargetControl] = &[
    TargetControl {
        name: "generic",
        about: "any control with look-ahead and arcs: constant acceleration along the path",
        planner: "trapezoid",
        corner: None,
        columns: 120,
        decimals: 5,
        macros: MacroLanguage::OfProgram,
    },
    TargetControl {
        name: "linuxcnc",
        about: "LinuxCNC 2.9: its own planner, with the limits that the machine file has of each axis",
        planner: "linuxcnc",
        corner: Some(Corner::Continuous { tolerance_mm: Some(0.001), merge_mm: Some(0.0) }),
        columns: 120,
        decimals: 5,
        macros: MacroLanguage::OWords,
    },
    TargetControl {
        name: "grbl",
        about: "grbl: constant acceleration along the path, lines of 80 characters",
        planner: "trapezoid",
        corner: None,
        columns: 80,
        decimals: 4,
        macros: MacroLanguage::None,
    },
    TargetControl {
        name: "fanuc",
        about: "Fanuc and its relatives: constant acceleration along the path, steps of 1 um",
        planner: "trapezoid",
        corner: None,
        columns: 120,
        decimals: 3,
        macros: MacroLanguage::Fanuc,
    },
];

impl TargetControl {
    /// The target of that name.
    pub fn find(name: &str) -> Option<&'static Self> {
        TARGETS.iter().find(|target| target.name == name)
    }

    /// How it plans on a machine.
    pub fn stages(&self, machine: &Machine) -> Stages {
        let own = Stages::of(machine);
        Stages { planner: feed_planner(self.planner).unwrap_or(own.planner), ..own }
    }

    /// Whether it runs loops, subroutines and parameters as a program of a dialect has them.
    pub(super) const fn runs_macros_of(&self, dialect: Dialect) -> bool {
        match self.macros {
            MacroLanguage::OfProgram => true,
            MacroLanguage::OWords => !dialect.is_fanuc(),
            MacroLanguage::Fanuc => dialect.is_fanuc(),
            MacroLanguage::None => false,
        }
    }

    /// Decimals of a length. Inches have one more: an inch is 25 mm, and then the step is small enough.
    pub(super) fn decimals_of(&self, unit_mm: f64) -> usize {
        self.decimals as usize + usize::from(unit_mm > 1.0)
    }

    /// Printed step of a length in a unit, mm.
    pub(super) fn step_mm(&self, unit_mm: f64) -> f64 {
        unit_mm / 10_f64.powi(self.decimals_of(unit_mm) as i32)
    }

    /// Printed steps in a millimetre.
    pub(super) fn steps_per_mm(&self) -> f64 {
        10_f64.powi(self.decimals as i32)
    }
}
