//! Canned cycles G73, G74 and G81-G89: one hole a line, along the normal of the plane.
//!
//! Every cycle first goes to R if the series began below it, then over the hole, then to R; what
//! happens between R and the bottom is the cycle's own. The way over the hole is at the height of
//! the tool where that is above R; else it ends where the retraction will, and LinuxCNC 2.9 rises
//! on the way where G98, G99 or R have changed within the series. Z, R, Q and P stay until another
//! code ends the cycle. NISTIR 6556, section 3.5.16, and LinuxCNC for G73, G74 and pecking.

use crate::canon::{Corner, EventKind};
use crate::motion::feed::Speed;
use crate::state::Interpreter;
use crate::state::carried_over::{Cycle, CycleLength, Pecks};
use crate::state::modal::INCH_MM;
use crate::text::block::Block;
use crate::text::codes::{AXIS_LETTERS, bit, spelled};
use crate::text::diagnostic::{LineFault, Read, Short};

/// Distance that a peck backs off or stays above the last depth, mm and inch.
const PECK_CLEARANCE: [f64; 2] = [0.254, 0.010];
/// Pecks of one line, over all its holes: they are held in memory until they are read, and more
/// would be a mistake in Q or L.
const MAX_PECKS: f64 = 1e5;
/// Holes of one line (L): up to eight motions each.
const MAX_REPEATS: i64 = 20_000;

/// An axis whose lengths are never diameters: Z.
const RADIAL: usize = 2;

/// One hole.
struct Hole {
    normal: usize,
    bottom: f64,
    clearance: f64,
    /// Height that the tool leaves it at (G98, G99).
    retract: f64,
}

impl Interpreter {
    /// One line of a canned cycle.
    pub(crate) fn cycle(&mut self, block: &Block, code: u16) -> Read<()> {
        self.check_cycle(block, code)?;
        let [first, second, normal] = self.modal.plane.axes();
        let letter = AXIS_LETTERS[normal];
        let mut kept = self.carried.cycle;
        let is_series = kept.code != 0;
        if kept.code != code {
            if !block.has(b'r') {
                return Err(LineFault::new(
                    "gcode::cycle",
                    block.whole(),
                    format!("R (height to begin at) is missing for {}", spelled(code)),
                )
                .hint("R stands above the work: G81 X10 Y10 Z-5 R2 F100 drills from 2 to -5"));
            }
            if !block.has(letter) {
                let name = char::from(letter).to_ascii_uppercase();
                return Err(LineFault::new(
                    "gcode::cycle",
                    block.whole(),
                    format!("{name} (bottom of the hole) is missing for {}", spelled(code)),
                )
                .hint("the first hole of a cycle has all its words; the next ones need only their X and Y"));
            }
            kept = Cycle {
                code,
                began_at: if is_series {
                    kept.began_at
                } else {
                    self.at[normal]
                },
                ..Cycle::default()
            };
        }
        self.cycle_words(block, &mut kept, normal)?;
        let incremental = self.modal.incremental;
        let clearance = if incremental {
            kept.began_at + kept.clearance.mm
        } else {
            kept.clearance.mm
        };
        let bottom = if incremental {
            clearance + kept.bottom.mm
        } else {
            kept.bottom.mm
        };
        if clearance < bottom {
            let message =
                format!("R = {clearance} mm lies below the bottom of the hole at {bottom} mm");
            return Err(LineFault::new(
                "gcode::cycle",
                block.at_any(bit(b'r') | bit(letter)),
                message,
            ));
        }
        // Fanuc and Haas: none only keeps the words for the holes that follow.
        let least = i64::from(!self.dialect.is_fanuc());
        let repeats = if block.has(b'l') {
            self.integer(block, b'l', least, MAX_REPEATS)?
        } else {
            1
        };
        if self.modal.feed <= 0.0 {
            self.feed_for(block, 0.0)?;
        }
        self.carried.cycle = kept;
        if repeats == 0 {
            return Ok(());
        }
        let corner = self.modal.corner;
        if matches!(corner, Corner::Continuous { .. }) {
            self.modal.corner = Corner::ExactPath;
        }
        let retract = if self.modal.retract_to_r {
            clearance
        } else {
            clearance.max(kept.began_at)
        };
        let hole = Hole {
            normal,
            bottom,
            clearance,
            retract,
        };
        let drilled = self.drill_all(block, &hole, [first, second], repeats);
        self.modal.corner = corner;
        drilled
    }

    fn check_cycle(&self, block: &Block, code: u16) -> Read<()> {
        let others =
            block.set & (bit(b'a') | bit(b'b') | bit(b'c') | bit(b'u') | bit(b'v') | bit(b'w'));
        if others != 0 {
            return Err(LineFault::new(
                "gcode::cycle",
                block.at_any(others),
                format!("{} moves X, Y and Z only", spelled(code)),
            ));
        }
        if !block.has_axes() {
            return Err(LineFault::new(
                "gcode::cycle",
                block.whole(),
                format!("{} has no axis word", spelled(code)),
            ));
        }
        Ok(())
    }

    /// Words that stay for the following holes.
    fn cycle_words(&self, block: &Block, kept: &mut Cycle, normal: usize) -> Read<()> {
        let letter = AXIS_LETTERS[normal];
        if let Some(value) = block.get(b'r') {
            // A distance along X, in G7, too: only X itself is a diameter.
            kept.clearance = self.cycle_length(self.length(block, b'r', RADIAL, value)?, value);
        }
        if let Some(value) = block.get(letter) {
            kept.bottom = self.cycle_length(self.length(block, letter, normal, value)?, value);
        }
        if let Some(value) = block.get(b'q') {
            if value <= 0.0 {
                return Err(LineFault::new(
                    "gcode::cycle",
                    block.at(b'q'),
                    format!("the depth of a peck Q{} must be above 0", Short(value)),
                ));
            }
            kept.peck = Some(self.cycle_length(value * self.modal.unit_mm, value));
        }
        if let Some(value) = block.get(b'p') {
            if value < 0.0 {
                return Err(LineFault::new(
                    "gcode::cycle",
                    block.at(b'p'),
                    format!(
                        "the dwell P{} is negative; the smallest is 0 s",
                        Short(value)
                    ),
                ));
            }
            kept.dwell_s = Some(self.seconds(block, value));
        }
        let missing = match kept.code {
            730 | 830 if kept.peck.is_none() => "Q (depth of a peck)",
            820 | 860 | 880 | 890 if kept.dwell_s.is_none() => "P (dwell in seconds)",
            870 if block.set & (bit(b'i') | bit(b'j') | bit(b'k'))
                != bit(b'i') | bit(b'j') | bit(b'k') =>
            {
                "I, J or K"
            }
            _ => return Ok(()),
        };
        Err(LineFault::new(
            "gcode::cycle",
            block.whole(),
            format!("{missing} is missing for {}", spelled(kept.code)),
        ))
    }

    fn cycle_length(&self, mm: f64, value: f64) -> CycleLength {
        let unit_mm = self.modal.unit_mm;
        // A diameter is written as twice the length.
        let written = if value * unit_mm == mm {
            value
        } else {
            mm / unit_mm
        };
        CycleLength {
            mm,
            written,
            unit_mm,
        }
    }

    fn drill_all(
        &mut self,
        block: &Block,
        hole: &Hole,
        plane: [usize; 2],
        repeats: i64,
    ) -> Read<()> {
        if self.carried.cycle.began_at < hole.clearance {
            self.along(block, hole.normal, hole.clearance, Speed::Rapid)?;
        }
        let peck_mm = self
            .carried
            .cycle
            .peck
            .map_or(f64::INFINITY, |peck| peck.mm);
        let pecks = (hole.clearance - hole.bottom) / peck_mm * repeats as f64;
        if matches!(self.carried.cycle.code, 730 | 830) && pecks > MAX_PECKS {
            let step = Short(peck_mm);
            let message =
                format!("{pecks:.0} pecks of {step} mm in one line; it may have {MAX_PECKS}");
            let hint = "is Q, the depth of a peck, or L, the number of holes, a slip?";
            return Err(LineFault::new(
                "gcode::cycle",
                block.at_any(bit(b'q') | bit(b'l')),
                message,
            )
            .hint(hint));
        }
        for _ in 0..repeats {
            let mut target = self.target(block)?;
            target[hole.normal] = self.at[hole.normal];
            if target[hole.normal] <= hole.clearance {
                target[hole.normal] = hole.retract;
            }
            self.go(block, target, Speed::Rapid)?;
            self.along(block, hole.normal, hole.clearance, Speed::Rapid)?;
            self.drill(block, hole, plane)?;
            self.along(block, hole.normal, hole.retract, Speed::Rapid)?;
        }
        Ok(())
    }

    /// Drills from R to the bottom. Cycles that feed out also return: G85 to R, the others all the
    /// way.
    fn drill(&mut self, block: &Block, hole: &Hole, plane: [usize; 2]) -> Read<()> {
        let &Hole {
            normal,
            bottom,
            clearance,
            retract,
        } = hole;
        let cycle = self.carried.cycle;
        match cycle.code {
            730 | 830 => return self.peck(block, hole),
            870 => return self.back_bore(block, hole, plane),
            _ => self.along(block, normal, bottom, Speed::Programmed)?,
        }
        let turning = self.modal.spindle_turns;
        match cycle.code {
            740 | 840 => {
                let wanted = if cycle.code == 840 { 1 } else { -1 };
                if turning != wanted {
                    let (code, how) = if wanted == 1 {
                        ("G84", "M3")
                    } else {
                        ("G74", "M4")
                    };
                    return Err(LineFault::new(
                        "gcode::cycle",
                        block.whole(),
                        format!("{code} taps with the spindle turning by {how}, which it does not"),
                    )
                    .hint(format!("start it before: S500 {how}")));
                }
                self.spindle(-wanted);
                self.pause(cycle.dwell_s.unwrap_or(0.0));
                self.along(block, normal, retract, Speed::Programmed)?;
                self.spindle(wanted);
            }
            820 => self.pause(cycle.dwell_s.unwrap_or(0.0)),
            850 => self.along(block, normal, clearance, Speed::Programmed)?,
            860 | 880 => {
                if turning == 0 {
                    return Err(LineFault::new(
                        "gcode::cycle",
                        block.whole(),
                        format!("{} needs a turning spindle (M3 or M4)", spelled(cycle.code)),
                    )
                    .hint("start it before: S500 M3"));
                }
                self.pause(cycle.dwell_s.unwrap_or(0.0));
                self.spindle(0);
                if cycle.code == 860 {
                    self.along(block, normal, retract, Speed::Rapid)?;
                } else {
                    self.event(EventKind::MCode {
                        code: 0,
                        p: None,
                        q: None,
                    }); // The operator retracts by hand.
                }
                self.spindle(turning);
            }
            890 => {
                self.pause(cycle.dwell_s.unwrap_or(0.0));
                self.along(block, normal, retract, Speed::Programmed)?;
            }
            _ => {}
        }
        Ok(())
    }

    /// G83 retracts to R after each peck, G73 only breaks the chip.
    fn peck(&mut self, block: &Block, hole: &Hole) -> Read<()> {
        let &Hole {
            normal,
            bottom,
            clearance,
            ..
        } = hole;
        let above = if self.modal.unit_mm == 1.0 {
            PECK_CLEARANCE[0]
        } else {
            PECK_CLEARANCE[1] * INCH_MM
        };
        if let Some(pecks) = self.fanuc.pecks {
            self.peck_smaller(block, normal, [clearance, bottom], above, pecks)?;
            self.pause(self.carried.cycle.dwell_s.unwrap_or(0.0));
            return Ok(());
        }
        // In the program's unit, as LinuxCNC counts: elsewhere rounding makes a last peck of
        // nothing, or leaves one out.
        let (unit, cycle) = (self.modal.unit_mm, self.carried.cycle);
        let [from, to] = [cycle.clearance, cycle.bottom].map(|length| length.in_unit(unit));
        let from = if self.modal.incremental {
            cycle.began_at / unit + from
        } else {
            from
        };
        let last = if self.modal.incremental {
            from + to
        } else {
            to
        };
        let step = cycle.peck.map_or(from - last, |peck| peck.in_unit(unit));
        let mut counted = from - step;
        while counted > last {
            let depth = counted * unit;
            self.along(block, normal, depth, Speed::Programmed)?;
            if self.carried.cycle.code == 830 {
                self.along(block, normal, clearance, Speed::Rapid)?;
            }
            self.along(block, normal, depth + above, Speed::Rapid)?;
            counted -= step;
        }
        self.along(block, normal, bottom, Speed::Programmed)?;
        self.pause(self.carried.cycle.dwell_s.unwrap_or(0.0));
        Ok(())
    }

    /// G87: beside the hole down with the spindle stopped, into its axis, up with the spindle
    /// turning to K, and out the same way.
    fn back_bore(&mut self, block: &Block, hole: &Hole, plane: [usize; 2]) -> Read<()> {
        let &Hole {
            normal,
            bottom,
            retract,
            ..
        } = hole;
        let turning = self.modal.spindle_turns;
        if turning == 0 {
            return Err(LineFault::new(
                "gcode::cycle",
                block.whole(),
                "G87 needs a turning spindle (M3 or M4)",
            )
            .hint("start it before: S500 M3"));
        }
        let scale = self.modal.unit_mm;
        let word = |axis: usize| block.get(b"ijk"[axis]).unwrap_or(0.0) * scale;
        let center = self.at;
        let mut beside = center;
        for axis in plane {
            beside[axis] += word(axis);
        }
        let up_to = if self.modal.incremental {
            bottom + word(normal)
        } else {
            word(normal)
        };
        self.go(block, beside, Speed::Rapid)?;
        self.spindle(0);
        self.along(block, normal, bottom, Speed::Rapid)?;
        let mut inside = center;
        inside[normal] = bottom;
        self.go(block, inside, Speed::Rapid)?;
        self.spindle(turning);
        self.along(block, normal, up_to, Speed::Programmed)?;
        self.along(block, normal, bottom, Speed::Programmed)?;
        self.spindle(0);
        beside[normal] = bottom;
        self.go(block, beside, Speed::Rapid)?;
        self.along(block, normal, retract, Speed::Rapid)?;
        let mut out = center;
        out[normal] = retract;
        self.go(block, out, Speed::Rapid)?;
        self.spindle(turning);
        Ok(())
    }

    fn pause(&mut self, seconds: f64) {
        if seconds > 0.0 {
            self.event(EventKind::Dwell { seconds });
        }
    }

    /// Any other motion ends the series.
    pub(crate) fn end_cycles(&mut self) {
        self.carried.cycle.code = 0;
    }

    /// A hole in pecks that grow smaller; `above_mm` is how far a rapid stays above the last depth.
    fn peck_smaller(
        &mut self,
        block: &Block,
        normal: usize,
        [clearance, bottom]: [f64; 2],
        above_mm: f64,
        pecks: Pecks,
    ) -> Read<()> {
        let (mut depth, mut peck, mut count) = (clearance - pecks.first_mm, pecks.first_mm, 0_u32);
        while depth > bottom + 1e-9 {
            self.along(block, normal, depth, Speed::Programmed)?;
            self.along(block, normal, clearance, Speed::Rapid)?;
            self.along(block, normal, depth + above_mm, Speed::Rapid)?;
            peck = (peck - pecks.less_mm).max(pecks.least_mm);
            depth -= peck;
            count += 1;
            if f64::from(count) > MAX_PECKS {
                let message = format!(
                    "more than {MAX_PECKS} pecks; the smallest, K, is {} mm",
                    Short(pecks.least_mm)
                );
                return Err(
                    LineFault::new("gcode::cycle", block.whole(), message).hint("make K larger")
                );
            }
        }
        self.along(block, normal, bottom, Speed::Programmed)
    }
}
