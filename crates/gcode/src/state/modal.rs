//! Modes that stay until another code changes them.

use crate::canon::{Corner, Plane};

/// Millimetres of an inch.
pub const INCH_MM: f64 = 25.4;

/// Meaning of F.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FeedMode {
    /// G94.
    PerMinute,
    /// G93: each motion takes 1/F minutes.
    Inverse,
    /// G95.
    PerRevolution,
}

/// Modes of RS-274. Lengths in mm, whatever the program's unit.
#[derive(Debug, Clone)]
pub(crate) struct Modal {
    /// Ten times the motion code; 800 (G80) means no motion mode.
    pub(crate) motion: u16,
    pub(crate) plane: Plane,
    /// 1 or 25.4.
    pub(crate) unit_mm: f64,
    pub(crate) incremental: bool,
    pub(crate) arc_absolute: bool,
    pub(crate) feed_mode: FeedMode,
    /// F: mm/min, 1/min or mm/rev by `feed_mode`.
    pub(crate) feed: f64,
    /// Factor that converted F to millimeters. Rotary axes that move alone take F in degrees in
    /// either unit.
    pub(crate) feed_unit_mm: f64,
    pub(crate) corner: Corner,
    /// G99: canned cycles retract to R; G98: to where they began.
    pub(crate) retract_to_r: bool,
    /// G7: X is a diameter.
    pub(crate) diameter: bool,
    /// S, rev/min or length/min by `constant_surface`.
    pub(crate) spindle_speed: f64,
    /// 1 is M3, -1 is M4, 0 is M5.
    pub(crate) spindle_turns: i8,
    /// G96 with its highest speed, rev/min.
    pub(crate) constant_surface: Option<f64>,
    pub(crate) flood: bool,
    pub(crate) mist: bool,
    pub(crate) feed_override: bool,
    pub(crate) speed_override: bool,
    pub(crate) adaptive_feed: bool,
    pub(crate) feed_hold: bool,
}

impl Modal {
    pub(super) const fn new() -> Self {
        Self {
            motion: 800,
            plane: Plane::Xy,
            unit_mm: 1.0,
            incremental: false,
            arc_absolute: false,
            feed_mode: FeedMode::PerMinute,
            feed: 0.0,
            feed_unit_mm: 1.0,
            corner: Corner::Continuous {
                tolerance_mm: None,
                merge_mm: None,
            },
            // As LinuxCNC begins, though its manual says otherwise.
            retract_to_r: true,
            diameter: false,
            spindle_speed: 0.0,
            spindle_turns: 0,
            constant_surface: None,
            flood: false,
            mist: false,
            feed_override: true,
            speed_override: true,
            adaptive_feed: false,
            feed_hold: true,
        }
    }
}

/// Modes that a program begins with: drilling returns to the initial level (G98) on both machines.
pub(super) const fn fanuc_modes(is_lathe: bool) -> Modal {
    let mut modal = Modal::new();
    modal.retract_to_r = false;
    if is_lathe {
        modal.plane = Plane::Zx;
        modal.diameter = true;
        modal.feed_mode = FeedMode::PerRevolution;
    }
    modal
}
