//! The controls that a corrected program can be written for.
//!
//! A row names the [feed planner](feedwright_plan::feed) of the control and sets the limits of its
//! programs. To add a control, add a row.

use feedwright_gcode::Dialect;
use feedwright_gcode::canon::Corner;
use feedwright_plan::feed_planner;
use feedwright_sim::{Machine, Stages};

/// A row of [`TARGETS`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TargetControl {
    /// Name, as in `--for`.
    pub name: &'static str,
    /// Description of the control, for lists.
    pub about: &'static str,
    /// Name of its feed planner.
    pub planner: &'static str,
    /// Way in which blocks of a corrected stretch meet; none means as in the program, but without
    /// exact stops.
    pub(crate) corner: Option<Corner>,
    /// Largest number of characters in a line.
    pub columns: usize,
    /// Decimals of a coordinate in mm.
    pub decimals: u32,
    /// Dialect that the control reads; none means the dialect of the program: it is the control
    /// that the program was written for.
    pub dialect: Option<Dialect>,
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
        dialect: None,
    },
    TargetControl {
        name: "linuxcnc",
        about: "LinuxCNC 2.9: its own planner, with the limits that the machine file has of each axis",
        planner: "linuxcnc",
        corner: Some(Corner::Continuous {
            tolerance_mm: Some(0.001),
            merge_mm: Some(0.0),
        }),
        columns: 120,
        decimals: 5,
        dialect: Some(Dialect::LinuxCnc),
    },
    TargetControl {
        name: "grbl",
        about: "grbl: constant acceleration along the path, lines of 80 characters",
        planner: "trapezoid",
        corner: None,
        columns: 80,
        decimals: 4,
        dialect: Some(Dialect::Grbl),
    },
    TargetControl {
        name: "fanuc",
        about: "Fanuc and its relatives: constant acceleration along the path, steps of 1 um",
        planner: "trapezoid",
        corner: None,
        columns: 120,
        decimals: 3,
        dialect: Some(Dialect::FanucMill),
    },
];

impl TargetControl {
    /// Finds the target with this name.
    pub fn find(name: &str) -> Option<&'static Self> {
        TARGETS.iter().find(|target| target.name == name)
    }

    /// Returns the feed planner of the control on a machine.
    pub fn stages(&self, machine: &Machine) -> Stages {
        let own = Stages::of(machine);
        Stages {
            planner: feed_planner(self.planner).unwrap_or(own.planner),
        }
    }

    /// Returns the dialect in which the control reads a program that was written in another
    /// dialect. A Fanuc control reads the dialects of its relatives.
    pub(super) fn reads_as(&self, dialect: Dialect) -> Dialect {
        match self.dialect {
            Some(Dialect::FanucMill) if dialect.is_fanuc() => dialect,
            Some(own) => own,
            None => dialect,
        }
    }

    /// Returns true if the control runs loops, subroutines and parameters as in a program of this
    /// dialect.
    pub(super) fn runs_macros_of(&self, dialect: Dialect) -> bool {
        match self.reads_as(dialect) {
            Dialect::Grbl => self.dialect.is_none(),
            own => own.is_fanuc() == dialect.is_fanuc(),
        }
    }

    /// Returns the decimals of a length. Inches have one more: an inch is 25 mm, and then the step
    /// is small enough.
    pub(super) fn decimals_of(&self, unit_mm: f64) -> usize {
        self.decimals as usize + usize::from(unit_mm > 1.0)
    }

    /// Returns the printed step of a length in a unit, mm.
    pub(super) fn step_mm(&self, unit_mm: f64) -> f64 {
        unit_mm / 10_f64.powi(self.decimals_of(unit_mm) as i32)
    }

    /// Returns the control with the steps in which a program prints lengths; `unit_mm` is its
    /// largest unit.
    pub(super) fn printed(&self, unit_mm: f64) -> PrintedTarget<'_> {
        PrintedTarget {
            control: self,
            steps_per_mm: 10_f64.powi(self.decimals_of(unit_mm) as i32) / unit_mm,
        }
    }
}

/// A control, and the steps in which its program is printed.
#[derive(Debug, Clone, Copy)]
pub(super) struct PrintedTarget<'a> {
    pub(super) control: &'a TargetControl,
    /// Printed steps in a millimetre.
    pub(super) steps_per_mm: f64,
}
