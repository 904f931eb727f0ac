//! How fast a motion goes, and handing it out.

use std::f64::consts::TAU;

use crate::canon::{AuxiliaryAxes, Canon, Motion, MotionKind, Shape};
use crate::settings::Dialect;
use crate::state::Interpreter;
use crate::state::frame::Position;
use crate::state::modal::FeedMode;
use crate::text::block::Block;
use crate::text::diagnostic::{LineFault, Read};

/// Seconds of a minute.
pub(crate) const MINUTE_S: f64 = 60.0;

/// Feed of a printer before the first F, mm/s: what Marlin starts with (1500 mm/min).
pub(crate) const PRINTER_FEED_MM_S: f64 = 25.0;

/// Nothing is turned closer to the axis than this, mm: the speed there is what it is here.
pub(super) const MIN_RADIUS_MM: f64 = 0.01;

/// Speed of a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Speed {
    Rapid,
    /// Programmed feedrate F.
    Programmed,
}

impl Speed {
    pub(crate) const fn kind(self) -> MotionKind {
        match self {
            Self::Rapid => MotionKind::Rapid,
            Self::Programmed => MotionKind::Feed,
        }
    }
}

impl Interpreter {
    /// Returns true if the feedrate depends on X.
    #[inline]
    pub(super) fn follows_surface(&self) -> bool {
        self.modal.constant_surface.is_some() && self.modal.feed_mode == FeedMode::PerRevolution
    }

    /// Spindle speed at X of a position, rev/min.
    pub(crate) fn spindle_rpm(&self, machine: &Position) -> f64 {
        match self.modal.constant_surface {
            Some(highest) => self.rpm_at(self.frame.to_program(machine)[0], highest),
            None => self.modal.spindle_speed,
        }
    }

    pub(super) fn rpm_at(&self, x_mm: f64, highest: f64) -> f64 {
        // Metres or feet per minute.
        let surface_mm = self.modal.spindle_speed
            * if self.modal.unit_mm == 1.0 {
                1000.0
            } else {
                304.8
            };
        (surface_mm / (TAU * x_mm.abs().max(MIN_RADIUS_MM))).min(highest)
    }

    /// The feedrate of a motion of `length_mm`, mm/s.
    #[inline]
    pub(super) fn feed_for(&mut self, block: &Block, length_mm: f64) -> Read<f64> {
        let feed = self.modal.feed;
        match self.modal.feed_mode {
            FeedMode::PerMinute if feed > 0.0 => Ok(feed / MINUTE_S),
            FeedMode::Inverse if !block.has(b'f') => Err(LineFault::new(
                "gcode::feed",
                block.whole(),
                "F is missing: with G93 (inverse time) every feed motion needs its own",
            )
            .hint("F2 does the motion in half a minute; G94 goes back to feed per minute")),
            // The machine's limits hold for whatever is faster; only it must be a number.
            FeedMode::Inverse if feed > 0.0 => Ok((length_mm * feed / MINUTE_S).min(f64::MAX)),
            FeedMode::PerRevolution if feed > 0.0 && self.spindle_rpm(&self.here) == 0.0 => {
                Err(LineFault::new(
                    "gcode::feed",
                    block.whole(),
                    "with G95 (feed per revolution) the spindle needs a speed S above 0 rev/min",
                )
                .hint("write S and M3 before it, or G94 for feed per minute"))
            }
            FeedMode::PerRevolution if feed > 0.0 => {
                Ok((feed * self.spindle_rpm(&self.here) / MINUTE_S).min(f64::MAX))
            }
            // Printers start with a feed of their own.
            _ if self.dialect == Dialect::Printer => Ok(PRINTER_FEED_MM_S),
            _ => self.missing_feed(block),
        }
    }

    /// A feed motion without feed: an error once, for the rest follows from it.
    #[cold]
    fn missing_feed(&mut self, block: &Block) -> Read<f64> {
        if self.missing_feed_reported {
            return Ok(0.0);
        }
        self.missing_feed_reported = true;
        let at = if block.has(b'f') {
            block.at(b'f')
        } else {
            block.whole()
        };
        let message = if block.has(b'f') {
            "the feed F0 moves nothing: a feed motion needs F above 0"
        } else {
            "a feed motion, but no feed F was given so far"
        };
        Err(LineFault::new("gcode::feed", at, message)
            .hint("add F with the feed per minute to this line or one before it"))
    }

    /// Hands out the motion from `start` to the current position.
    #[inline]
    pub(super) fn push_motion(
        &mut self,
        speed: Speed,
        start: &Position,
        shape: Shape,
        feed_mm_s: f64,
        others: AuxiliaryAxes,
    ) {
        let kind = speed.kind();
        self.output.motions += 1;
        self.carried.left_compensation = false;
        self.push(Canon::Motion(Motion {
            line: self.line,
            kind,
            start_mm: [start[0], start[1], start[2]],
            end_mm: [self.here[0], self.here[1], self.here[2]],
            shape,
            feed_mm_s,
            corner: self.modal.corner,
            others,
        }));
    }
}

/// Returns the motion of the axes other than X, Y and Z.
#[inline]
pub(super) fn others(start: &Position, end: &Position, extruder_mm: f64) -> AuxiliaryAxes {
    let axes = (start[3..] != end[3..]).then(|| {
        let six = |position: &Position| std::array::from_fn(|axis| position[axis + 3]);
        Box::new([six(start), six(end)])
    });
    AuxiliaryAxes { extruder_mm, axes }
}

/// Length that F refers to: of X Y Z if they move, else of U V W, else degrees of A B C.
pub(super) fn distance(start: &Position, end: &Position) -> f64 {
    let along = |axes: std::ops::Range<usize>| {
        axes.map(|axis| (end[axis] - start[axis]).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    [along(0..3), along(6..9), along(3..6)]
        .into_iter()
        .find(|&length| length > 0.0)
        .unwrap_or(0.0)
}

/// Returns true if only rotary axes move, so that F is in degrees.
pub(super) fn turns_only(start: &Position, end: &Position) -> bool {
    start[..3] == end[..3] && start[6..] == end[6..] && start[3..6] != end[3..6]
}
