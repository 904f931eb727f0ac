//! G76: a thread in several passes of about the same cross-section.
//!
//! Pass n is Q sqrt(n) deep (Q of the second block), but at least Q of the first deeper than the
//! one before, down to the thread's height P less the allowance R of the first block; then come the
//! finishing passes at full depth. P of the first block is six digits: finishing passes, run-out at
//! 45 degrees in tenths of the lead, angle of the thread. A pass d deep begins d tan(angle/2)
//! farther along, so that one edge cuts.

use crate::canon::EventKind;
use crate::motion::feed::Speed;
use crate::state::Interpreter;
use crate::state::fanuc::ThreadingWords;
use crate::state::frame::Position;
use crate::text::block::{Block, Word};
use crate::text::diagnostic::{LineFault, Read};

/// Passes of a thread: more is a mistake in Q.
const MAX_PASSES: u32 = 1000;

/// A thread, mm.
struct FanucThread {
    start: Position,
    end: Position,
    height: f64,
    taper: f64,
    run_out: f64,
    /// Tangent of half the thread angle.
    tangent: f64,
    /// Signs, 1 or -1: away from the part along X, and the cutting direction along Z (`ahead`).
    outward: f64,
    ahead: f64,
}

impl FanucThread {
    /// X of a pass at a depth, where it passes Z.
    fn x_at(&self, depth: f64, z: f64) -> f64 {
        let share = (z - self.end[2]) / (self.start[2] - self.end[2]);
        self.end[0] + self.outward * (self.height - depth) + self.taper * share
    }

    fn point(&self, x: f64, z: f64) -> Position {
        let mut point = self.start;
        (point[0], point[2]) = (x, z);
        point
    }
}

impl Interpreter {
    /// `G76 P021060 Q100 R0.05`.
    pub(super) fn first_threading(&mut self, block: &Block) -> Read<()> {
        let digits = if block.has(b'p') {
            self.integer(block, b'p', 0, 999_999)?
        } else {
            60
        };
        let least_mm = self.increments(block, b'q')?.unwrap_or(0.0);
        let allowance_mm = self.increments(block, b'r')?.unwrap_or(0.0);
        self.fanuc.repetitive.thread = Some(ThreadingWords {
            finishing: (digits / 10_000) as u32,
            run_out: (digits / 100 % 100) as f64 / 10.0,
            angle_deg: (digits % 100) as f64,
            least_mm,
            allowance_mm,
        });
        Ok(())
    }

    /// `G76 X27.4 Z-30. R0 P1300 Q400 F2.`, or with K and D in place of P and Q.
    pub(super) fn threading_cycle(&mut self, block: &Block, word: Word) -> Read<()> {
        self.check_thread(block, word.number)?;
        let is_one_block = block.has(b'k') || block.has(b'd');
        let first = self.first_of_thread(block, word, is_one_block)?;
        let need = |letter: u8, what: &str| {
            self.increments(block, letter)?.filter(|&mm| mm > 0.0).ok_or_else(|| {
                let name = char::from(letter).to_ascii_uppercase();
                let message = format!("{name} ({what}) above 0 mm is missing for G76");
                LineFault::new("gcode::thread", word.at(), message)
                    .hint("without a decimal point it counts 0.001 mm (0.0001 inch): P1300 Q400 is 1.3 mm and 0.4 mm")
            })
        };
        let letters = if is_one_block {
            [b'k', b'd']
        } else {
            [b'p', b'q']
        };
        let (height, cut) = (
            need(letters[0], "height of the thread")?,
            need(letters[1], "depth of the first pass")?,
        );
        let (start, end) = (self.at, self.target(block)?);
        if start[2] == end[2] || start[0] == end[0] {
            let message = "G76 needs X and Z that differ from where it begins";
            return Err(LineFault::new("gcode::thread", block.whole(), message)
                .hint("X is the bottom of the thread, Z its end"));
        }
        let taper = self
            .distance_word(block, if is_one_block { b'i' } else { b'r' })?
            .unwrap_or(0.0);
        let (outward, ahead) = ((start[0] - end[0]).signum(), (end[2] - start[2]).signum());
        let thread = FanucThread {
            start,
            end,
            height,
            taper,
            run_out: first.run_out * self.modal.feed,
            tangent: libm::tan((0.5 * first.angle_deg).to_radians()),
            outward,
            ahead,
        };
        let depths = depths(height, cut, &first).ok_or_else(|| {
            let message = format!(
                "the thread of {height} mm needs more than {MAX_PASSES} passes of {cut} mm at first"
            );
            LineFault::new("gcode::thread", word.at(), message).hint("make the first pass deeper")
        })?;
        for depth in depths {
            self.pass_of_thread(block, &thread, depth)?;
        }
        self.go(block, start, Speed::Rapid)
    }

    /// Returns the values of the first block, or those of a thread in one block.
    fn first_of_thread(
        &mut self,
        block: &Block,
        word: Word,
        is_one_block: bool,
    ) -> Read<ThreadingWords> {
        if !is_one_block {
            return self.fanuc.repetitive.thread.ok_or_else(|| {
                LineFault::new(
                    "gcode::thread",
                    word.at(),
                    "G76 has no first block: finishing passes, run-out and angle are parameters of the control",
                )
                .hint("write G76 P020060 Q100 R0.05 before it: 2 finishing passes, no run-out, 60 degrees")
            });
        }
        if block.get(b'p').is_some_and(|method| method != 1.0) {
            let message = "this way of infeed (P of G76) is not read";
            return Err(
                LineFault::new("gcode::unsupported", block.at(b'p'), message)
                    .hint("P1 or no P cuts with one edge and a constant cross-section"),
            );
        }
        if self.warn_once("gcode::run_out") {
            let message = "run-out, finishing passes and smallest depth of this thread are settings of the control: they are read as none";
            self.output
                .warnings
                .push(*LineFault::new("gcode::run_out", word.at(), message));
        }
        let angle_deg = block.get(b'a').unwrap_or(0.0);
        if !(0.0..=120.0).contains(&angle_deg) {
            return Err(LineFault::new(
                "gcode::thread",
                block.at(b'a'),
                "the angle of a thread A must be from 0 to 120 degrees",
            ));
        }
        Ok(ThreadingWords {
            finishing: 0,
            run_out: 0.0,
            angle_deg,
            least_mm: 0.0,
            allowance_mm: 0.0,
        })
    }

    fn pass_of_thread(&mut self, block: &Block, thread: &FanucThread, depth: f64) -> Read<()> {
        let begin = thread.start[2] + thread.ahead * depth * thread.tangent;
        if (thread.end[2] - begin) * thread.ahead <= thread.run_out {
            let message = "the thread is shorter than its infeed and run-out";
            return Err(LineFault::new("gcode::thread", block.whole(), message)
                .hint("begin it farther from its end"));
        }
        let out = |z: f64| thread.point(thread.start[0], z);
        self.go(block, out(begin), Speed::Rapid)?;
        self.go(
            block,
            thread.point(thread.x_at(depth, begin), begin),
            Speed::Rapid,
        )?;
        let run_out = thread.end[2] - thread.ahead * thread.run_out;
        self.event(EventKind::SpindleSync {
            pitch_mm: Some(self.modal.feed),
        });
        self.thread_line(block, thread.point(thread.x_at(depth, run_out), run_out))?;
        if thread.run_out > 0.0 {
            // At 45 degrees, but never past where the cycle began.
            let off = thread
                .run_out
                .min(thread.outward * (thread.start[0] - self.at[0]));
            self.thread_line(
                block,
                thread.point(
                    self.at[0] + thread.outward * off,
                    run_out + thread.ahead * off,
                ),
            )?;
        }
        self.event(EventKind::SpindleSync { pitch_mm: None });
        self.go(block, out(self.at[2]), Speed::Rapid)
    }

    fn thread_line(&mut self, block: &Block, target: Position) -> Read<()> {
        let way = [0, 2].map(|axis| (target[axis] - self.at[axis]).abs());
        let lead = self.modal.feed * libm::hypot(way[0], way[1])
            / way[0].max(way[1]).max(f64::MIN_POSITIVE);
        self.paced(block, target, lead)
    }
}

/// Depths of all passes; `None` where there are too many.
fn depths(height: f64, cut: f64, first: &ThreadingWords) -> Option<Vec<f64>> {
    let rough = (height - first.allowance_mm).max(0.0);
    let (mut depths, mut depth, mut pass) = (Vec::new(), 0.0_f64, 0_u32);
    while depth < rough - 1e-9 {
        pass += 1;
        if pass > MAX_PASSES {
            return None;
        }
        depth = (cut * f64::from(pass).sqrt())
            .max(depth + first.least_mm)
            .min(rough);
        depths.push(depth);
    }
    // Without a finishing pass the last one takes what was to be left.
    let finishing = if first.allowance_mm > 0.0 {
        first.finishing.max(1)
    } else {
        first.finishing
    };
    depths.extend((0..finishing).map(|_| height));
    Some(depths)
}
