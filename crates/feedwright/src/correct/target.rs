//! The controls that a corrected program is for.
//!
//! A row says how the control plans the speed, by the name of a [feed
//! planner](feedwright_plan::feed), and what its programs may hold. To add a control is one row.

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
    /// Dialect that it reads; none is the dialect of the program: it is the control that the
    /// program was written for.
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
    /// The target of that name.
    pub fn find(name: &str) -> Option<&'static Self> {
        TARGETS.iter().find(|target| target.name == name)
    }

    /// How it plans on a machine.
    pub fn stages(&self, machine: &Machine) -> Stages {
        let own = Stages::of(machine);
        Stages {
            planner: feed_planner(self.planner).unwrap_or(own.planner),
        }
    }

    /// The dialect in which it reads a program that was written in another. A control of Fanuc
    /// reads those of its relatives.
    pub(super) fn reads_as(&self, dialect: Dialect) -> Dialect {
        match self.dialect {
            Some(Dialect::FanucMill) if dialect.is_fanuc() => dialect,
            Some(own) => own,
            None => dialect,
        }
    }

    /// Whether it runs loops, subroutines and parameters as a program of a dialect has them.
    pub(super) fn runs_macros_of(&self, dialect: Dialect) -> bool {
        match self.reads_as(dialect) {
            Dialect::Grbl => self.dialect.is_none(),
            own => own.is_fanuc() == dialect.is_fanuc(),
        }
    }

    /// Decimals of a length. Inches have one more: an inch is 25 mm, and then the step is small
    /// enough.
    pub(super) fn decimals_of(&self, unit_mm: f64) -> usize {
        self.decimals as usize + usize::from(unit_mm > 1.0)
    }

    /// Printed step of a length in a unit, mm.
    pub(super) fn step_mm(&self, unit_mm: f64) -> f64 {
        unit_mm / 10_f64.powi(self.decimals_of(unit_mm) as i32)
    }

    /// The control with the steps in which a program prints lengths whose largest unit is this, mm.
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
