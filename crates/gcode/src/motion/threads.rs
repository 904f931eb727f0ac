//! Motions tied to the spindle or to a probe: G33, G33.1, G38.2-G38.5, G76.
//!
//! The canonical output has the motions at the speed that the spindle asks for, between events that
//! say that spindle and feed are coupled.

use crate::canon::{EventKind, Plane};
use crate::motion::feed::{Speed, distance};
use crate::state::Interpreter;
use crate::state::frame::Position;
use crate::state::modal::FeedMode;
use crate::state::parameters as numbers;
use crate::text::block::Block;
use crate::text::codes::{Group, bit, spelled};
use crate::text::diagnostic::{LineFault, Read};

/// Shortest way of a probe, mm (LinuxCNC: 0.254 mm or 0.01 inch).
const PROBE_LEAST_MM: f64 = 0.254;
/// Passes of a thread: more is a mistake in J or R.
const MAX_PASSES: u32 = 20_000;

impl Interpreter {
    /// G33 and G33.1: along with the spindle, `K` mm a revolution.
    pub(crate) fn synchronized(&mut self, block: &Block, code: u16) -> Read<()> {
        let Some(pitch) = block.get(b'k') else {
            return Err(LineFault::new(
                "gcode::thread",
                block.whole(),
                format!("K (way per revolution) is missing for {}", spelled(code)),
            ));
        };
        self.check_spindle(block, code)?;
        self.check_way(block, code)?;
        let target = self.target(block)?;
        let start = self.at;
        let pitch_mm = pitch * self.modal.unit_mm;
        self.event(EventKind::SpindleSync {
            pitch_mm: Some(pitch_mm),
        });
        self.paced(block, target, pitch_mm)?;
        if code == 331 {
            // Rigid tapping comes back the same way.
            let turning = self.modal.spindle_turns;
            self.spindle(-turning);
            self.paced(block, start, pitch_mm)?;
            self.spindle(turning);
        }
        self.event(EventKind::SpindleSync { pitch_mm: None });
        Ok(())
    }

    fn check_way(&self, block: &Block, code: u16) -> Read<()> {
        if block.has_axes() {
            return Ok(());
        }
        Err(LineFault::new(
            "gcode::thread",
            block.whole(),
            format!("{} has no axis word: it leads nowhere", spelled(code)),
        ))
    }

    pub(crate) fn check_spindle(&self, block: &Block, code: u16) -> Read<()> {
        if self.modal.spindle_turns == 0 || self.modal.spindle_speed == 0.0 {
            return Err(LineFault::new(
                "gcode::thread",
                block.whole(),
                format!(
                    "{} needs a turning spindle: M3 or M4, and S above 0 rev/min",
                    spelled(code)
                ),
            )
            .hint("start it before: S500 M3"));
        }
        Ok(())
    }

    /// A straight motion of `pitch_mm` a revolution.
    pub(crate) fn paced(&mut self, block: &Block, target: Position, pitch_mm: f64) -> Read<()> {
        let (mode, feed) = (self.modal.feed_mode, self.modal.feed);
        (self.modal.feed_mode, self.modal.feed) = (FeedMode::PerRevolution, pitch_mm.abs());
        let result = self.go(block, target, Speed::Programmed);
        (self.modal.feed_mode, self.modal.feed) = (mode, feed);
        result
    }

    /// G38.2 to G38.5. Moves all the way to the target, as in a dry run: the program does not show
    /// where the probe will trip.
    pub(crate) fn probe(&mut self, block: &Block) -> Read<()> {
        let at = block
            .code(Group::Motion)
            .map_or(block.whole(), |word| word.at());
        if !block.has_axes() {
            return Err(LineFault::new(
                "gcode::probe",
                at,
                "a probing motion has no axis word",
            ));
        }
        if self.modal.feed_mode == FeedMode::PerRevolution {
            return Err(LineFault::new(
                "gcode::probe",
                at,
                "a probing motion cannot have a feed per revolution (G95)",
            )
            .hint("write G94 with a feed F per minute before it"));
        }
        let rotary = bit(b'a') | bit(b'b') | bit(b'c');
        let target = self.target(block)?;
        if block.set & rotary != 0 && (3..6).any(|axis| target[axis] != self.at[axis]) {
            return Err(LineFault::new(
                "gcode::probe",
                block.at_any(rotary),
                "a probing motion cannot turn a rotary axis",
            ));
        }
        let way = distance(&self.at, &target);
        if way < PROBE_LEAST_MM {
            return Err(LineFault::new(
                "gcode::probe",
                at,
                format!(
                    "the probing way of {way:.3} mm is too short: at least {PROBE_LEAST_MM} mm"
                ),
            ));
        }
        self.event(EventKind::Probe);
        self.go(block, target, Speed::Programmed)?;
        self.parameters.set_nine(numbers::PROBE_FIRST, self.at);
        self.parameters.set(numbers::PROBE_FIRST + 9, 1.0);
        Ok(())
    }

    /// G76: a thread along Z in several passes.
    pub(crate) fn thread(&mut self, block: &Block) -> Read<()> {
        self.check_spindle(block, 760)?;
        self.check_way(block, 760)?;
        let unit = self.modal.unit_mm;
        let need = |letter: u8| {
            let name = char::from(letter).to_ascii_uppercase();
            block.get(letter).ok_or_else(|| {
                LineFault::new(
                    "gcode::thread",
                    block.whole(),
                    format!("{name} is missing for G76"),
                )
            })
        };
        let (pitch, offset, first, full) = (
            need(b'p')? * unit,
            need(b'i')? * unit,
            need(b'j')? * unit,
            need(b'k')? * unit,
        );
        let degression = block.get(b'r').unwrap_or(1.0);
        let springs = if block.has(b'h') {
            self.integer(block, b'h', 0, 1000)?
        } else {
            0
        };
        let (taper, taper_at) = (
            block.get(b'e').unwrap_or(0.0) * unit,
            if block.has(b'l') {
                self.integer(block, b'l', 0, 3)?
            } else {
                0
            },
        );
        let angle = block.get(b'q').unwrap_or(0.0);
        let target = self.target(block)?;
        let bad = |letter: u8, message: &str| {
            Err(LineFault::new("gcode::thread", block.at(letter), message))
        };
        if self.modal.plane != Plane::Zx {
            return Err(LineFault::new(
                "gcode::thread",
                block.whole(),
                "G76 needs the plane G18",
            ));
        }
        if pitch <= 0.0 {
            return bad(b'p', "the pitch P must be above 0");
        }
        if first <= 0.0 {
            return bad(b'j', "the first depth J must be above 0");
        }
        if full <= first {
            return bad(b'k', "the full depth K must exceed the first depth J");
        }
        if degression < 1.0 {
            return bad(b'r', "the degression R must be at least 1");
        }
        let thread = Thread {
            pitch,
            offset,
            full,
            taper,
            taper_at,
            tangent: libm::tan(angle.to_radians()),
            start: self.at,
            end_z: target[2],
        };
        let (mut depth, mut pass) = (first, 1);
        while depth < full {
            self.thread_pass(block, &thread, depth)?;
            pass += 1;
            if pass > MAX_PASSES {
                return bad(b'j', "the thread needs too many passes");
            }
            depth = first * libm::pow(f64::from(pass), 1.0 / degression);
        }
        for _ in 0..=springs {
            self.thread_pass(block, &thread, full)?;
        }
        // X and Y of the line are where it ends.
        self.go(block, target, Speed::Rapid)
    }

    /// One pass at `depth` below the peaks: in, along the thread with its tapers, out.
    fn thread_pass(&mut self, block: &Block, thread: &Thread, depth: f64) -> Read<()> {
        let inward = if thread.offset > 0.0 { 1.0 } else { -1.0 };
        let direction = if thread.end_z < thread.start[2] {
            -1.0
        } else {
            1.0
        };
        // The compound slide: a deeper pass begins and ends further along.
        let begin_z = thread.start[2] + direction * depth * thread.tangent;
        let end_z = thread.end_z - direction * (thread.full - depth) * thread.tangent;
        let safe_x = thread.start[0] - inward * (thread.full - depth);
        let bottom = thread.start[0] + thread.offset + inward * depth;
        let top = bottom - inward * thread.full;
        let taper_pitch = thread.pitch * libm::hypot(thread.taper, thread.full)
            / thread.taper.max(f64::MIN_POSITIVE);
        let (first_taper, last_taper) = (
            thread.taper > 0.0 && thread.taper_at & 1 != 0,
            thread.taper > 0.0 && thread.taper_at & 2 != 0,
        );

        self.go(block, thread.at(safe_x, begin_z), Speed::Rapid)?;
        if first_taper {
            // The infeed waits for the spindle, too.
            self.coupled(block, thread.at(top, begin_z), taper_pitch)?;
            self.paced(
                block,
                thread.at(bottom, begin_z + direction * thread.taper),
                taper_pitch,
            )?;
        } else {
            self.go(block, thread.at(bottom, begin_z), Speed::Rapid)?;
        }
        let straight_end = if last_taper {
            end_z - direction * thread.taper
        } else {
            end_z
        };
        self.coupled(block, thread.at(bottom, straight_end), thread.pitch)?;
        if last_taper {
            self.coupled(block, thread.at(top, end_z), taper_pitch)?;
        }
        self.event(EventKind::SpindleSync { pitch_mm: None });
        self.go(block, thread.at(safe_x, end_z), Speed::Rapid)
    }

    fn coupled(&mut self, block: &Block, target: Position, pitch_mm: f64) -> Read<()> {
        self.event(EventKind::SpindleSync {
            pitch_mm: Some(pitch_mm),
        });
        self.paced(block, target, pitch_mm)
    }
}

/// A thread, mm.
struct Thread {
    pitch: f64,
    /// Distance from the drive line to the peaks, along X.
    offset: f64,
    /// Depth of the finished thread.
    full: f64,
    /// Length of a taper, and at which ends: 1 first, 2 last, 3 both.
    taper: f64,
    taper_at: i64,
    tangent: f64,
    start: Position,
    end_z: f64,
}

impl Thread {
    fn at(&self, x: f64, z: f64) -> Position {
        let mut point = self.start;
        (point[0], point[2]) = (x, z);
        point
    }
}
