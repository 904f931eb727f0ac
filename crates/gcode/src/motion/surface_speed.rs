//! G96: the spindle turns as fast as the surface speed asks for, so that a feed per revolution
//! changes along X.
//!
//! n = S / (2 pi |x|), at most what G96 D, G50 S or G92 S allow; S in m/min, with G20 in feet/min;
//! x from the axis. A straight motion is handed out in pieces along each of which n changes by at
//! most 5 %; an arc has the speed of its end.

use crate::canon::{Corner, Shape};
use crate::motion::feed::{MIN_RADIUS_MM, Speed, others};
use crate::state::Interpreter;
use crate::state::frame::Position;
use crate::text::block::Block;
use crate::text::diagnostic::Read;

/// Change of the spindle speed along one piece.
const CHANGE: f64 = 1.05;

impl Interpreter {
    /// A straight feed motion from `start` to here.
    pub(super) fn line_at_surface_speed(&mut self, block: &Block, start: &Position) -> Read<()> {
        let end = self.here;
        let highest = self.modal.constant_surface.unwrap_or(f64::INFINITY);
        let [from, to] = [start, &end].map(|at| self.frame.to_program(at)[0]);
        let corner = self.modal.corner;
        let shares = self.shares(from, to, highest);
        let mut last = *start;
        for (number, &share) in shares.iter().enumerate() {
            let is_last = number + 1 == shares.len();
            self.here = if is_last {
                end
            } else {
                std::array::from_fn(|axis| start[axis] + share * (end[axis] - start[axis]))
            };
            let middle: Position = std::array::from_fn(|axis| 0.5 * (last[axis] + self.here[axis]));
            let begin = std::mem::replace(&mut last, self.here);
            let feed = self.feed_at(block, &middle)?;
            self.modal.corner = if is_last { corner } else { joint(corner) };
            self.push_motion(
                Speed::Programmed,
                &begin,
                Shape::Line,
                feed,
                others(&begin, &last, 0.0),
            );
            self.modal.corner = corner;
        }
        Ok(())
    }

    /// Feedrate at a position, mm/s.
    fn feed_at(&mut self, block: &Block, machine: &Position) -> Read<f64> {
        let end = std::mem::replace(&mut self.here, *machine);
        let feed = self.feed_for(block, 0.0);
        self.here = end;
        feed
    }

    /// Returns the ends of the pieces into which a motion from one X to another is divided, as
    /// shares of it.
    fn shares(&self, from: f64, to: f64, highest: f64) -> Vec<f64> {
        let mut shares = Vec::new();
        let crosses = from * to < 0.0;
        let ends = if crosses {
            vec![[from, 0.0], [0.0, to]]
        } else {
            vec![[from, to]]
        };
        let least = {
            let surface = self.rpm_at(1.0, f64::INFINITY);
            (surface / highest).max(MIN_RADIUS_MM)
        };
        let share_of = |x: f64| (x - from) / (to - from);
        for [from, to] in ends {
            let sign = if from + to < 0.0 { -1.0 } else { 1.0 };
            let [a, b] = [from.abs().max(least), to.abs().max(least)];
            let pieces = (libm::log(a / b).abs() / libm::log(CHANGE)).ceil();
            let mut piece = 1.0;
            // The stretch where the bound holds is a piece of its own.
            if from.abs() < least && to.abs() > least {
                shares.push(share_of(sign * least));
            }
            while piece < pieces {
                shares.push(share_of(sign * a * libm::pow(b / a, piece / pieces)));
                piece += 1.0;
            }
            if to.abs() < least && from.abs() > least {
                shares.push(share_of(sign * least));
            }
            if crosses {
                shares.push(share_of(to));
            }
        }
        shares.retain(|share| *share > 1e-9 && *share < 1.0 - 1e-9);
        shares.push(1.0);
        shares
    }
}

/// Exact stops are for the ends of what is programmed.
const fn joint(corner: Corner) -> Corner {
    match corner {
        Corner::ExactStop => Corner::ExactPath,
        other => other,
    }
}
