//! `--out FILE.ngc`: the corrected path as a G-code program that another control can run.
//!
//! The setpoints of a run become straight blocks, as few as a tolerance of [`TOLERANCE_MM`] allows (`polyline`: that close as
//! a Fréchet distance, printed decimals included). Cutting motion is G1 along the corrected path; a block's feed is the
//! largest commanded in it, since acceleration belongs to the other control. Rapids are G0 along the programmed path: their
//! correction belongs to this machine's rapid rate. A cut starts with a G0 to its first setpoint, some micrometres beside the
//! programmed point. Rests move nothing. Events stand where they happened.
//!
//! The start of the run is where the machine already stands, so it is not commanded: an axis is first named when it moves,
//! X and Y together, and all are named before the first cut. A program that begins with a retract still does.

use std::io::{self, Write};

use super::polyline::{Segment, Simplifier};
use crate::feed::TimedEvent;
use crate::gcode::canon::EventKind;
use crate::trace::{Commanded, Row, Sink};

/// Largest distance between the setpoints and the printed path, in either direction, mm.
pub const TOLERANCE_MM: f64 = 1e-3;

/// Decimals of a printed coordinate: steps of 10 nm take one percent of the tolerance.
const DECIMALS: usize = 5;
const STEPS_PER_MM: f64 = 1e5;

/// Coordinates beyond this have no 10 nm left in an f64 and are no machine's.
const MAX_MM: f64 = 1e6;

/// Writes a program from the rows and events of a run, in order.
pub struct GcodeWriter<W> {
    out: W,
    axes: usize,
    simplifier: Simplifier,
    /// What moved last; a rest does not.
    commanded: Commanded,
    /// The last setpoint and its time.
    last: Option<(f64, [f64; 3])>,
    /// Commanded speed up to each point that no block covers yet, mm/s.
    speeds: Vec<f64>,
    print: Printer,
}

/// What the program has said so far.
struct Printer {
    at_mm: [f64; 3],
    named: [bool; 3],
    feed: String,
}

impl<W: Write> GcodeWriter<W> {
    /// Writes the head of the program; `notes` become comments, `axes` is 2 or 3.
    ///
    /// # Errors
    /// Where `out` takes no more.
    pub fn new(mut out: W, axes: usize, notes: &[impl AsRef<str>]) -> io::Result<Self> {
        for note in notes {
            writeln!(out, "({})", comment(note.as_ref()))?;
        }
        writeln!(out, "(straight blocks within {} um of the setpoints; mm, mm/min)", TOLERANCE_MM * 1e3)?;
        // G64 P: a control that stopped at every joint of these short blocks would be slow and mark the part.
        writeln!(out, "G21 G17 G90 G94 G64 P{TOLERANCE_MM}")?;
        Ok(Self {
            out,
            axes,
            simplifier: Simplifier::new(TOLERANCE_MM, STEPS_PER_MM),
            commanded: Commanded::Rest,
            last: None,
            speeds: Vec::new(),
            print: Printer { at_mm: [0.0; 3], named: [false; 3], feed: String::new() },
        })
    }

    /// Writes the remaining blocks and M2, and gives back what was written to.
    ///
    /// # Errors
    /// Where the output takes no more.
    pub fn finish(mut self) -> io::Result<W> {
        self.flush_blocks()?;
        writeln!(self.out, "M2")?;
        self.out.flush()?;
        Ok(self.out)
    }

    fn push(&mut self, t_s: f64, point: [f64; 3]) -> io::Result<()> {
        match self.last.replace((t_s, point)) {
            Some((before_s, before)) => {
                let travel = [0, 1, 2].map(|i| point[i] - before[i]);
                self.speeds.push(travel[0].hypot(travel[1]).hypot(travel[2]) / (t_s - before_s));
            }
            None => self.print.at_mm = self.simplifier.printed(point),
        }
        let mut segments = Vec::new();
        self.simplifier.push(point, &mut |segment| segments.push(segment));
        self.write_blocks(&segments)
    }

    /// Steps aside by a rapid: from the programmed start of a cut to as far beside it as the first setpoint `point` is beside
    /// the path. Names the axes that no block has named yet, so that the cut starts from known coordinates.
    fn start_cut(&mut self, row: &Row, point: [f64; 3]) -> io::Result<()> {
        let aside = match self.last {
            Some((_, programmed)) => {
                [0, 1, 2].map(|i| if i < self.axes { programmed[i] + point[i] - row.path_mm[i] } else { 0.0 })
            }
            None => point,
        };
        self.last = Some((self.last.map_or(row.t_s, |(t_s, _)| t_s), aside));
        let (axes, at_mm) = (self.axes, self.simplifier.restart(aside));
        if self.print.named == [false; 3] {
            self.print.at_mm = at_mm;
        }
        self.print.block(&mut self.out, axes, at_mm, None)?;
        self.print.name_all(&mut self.out, axes)
    }

    fn flush_blocks(&mut self) -> io::Result<()> {
        let mut segments = Vec::new();
        self.simplifier.finish(&mut |segment| segments.push(segment));
        self.write_blocks(&segments)
    }

    fn write_blocks(&mut self, segments: &[Segment]) -> io::Result<()> {
        for segment in segments {
            let fastest_mm_s = self.speeds.drain(..segment.points).fold(0.0, f64::max);
            self.print.block(
                &mut self.out,
                self.axes,
                segment.end_mm,
                (self.commanded == Commanded::Cut).then_some(fastest_mm_s),
            )?;
        }
        Ok(())
    }
}

impl<W: Write> Sink for GcodeWriter<W> {
    fn row(&mut self, row: &Row) -> io::Result<()> {
        if row.commanded != self.commanded && row.commanded != Commanded::Rest {
            self.flush_blocks()?;
        }
        let mut point = match row.commanded {
            Commanded::Rest => return Ok(()),
            Commanded::Rapid => row.path_mm,
            Commanded::Cut => row.cmd_mm,
        };
        let starts = row.commanded == Commanded::Cut && self.commanded != Commanded::Cut;
        self.commanded = row.commanded;
        point[self.axes..].fill(0.0);
        if let Some(wrong) = point.iter().find(|c| c.is_nan() || c.abs() > MAX_MM) {
            let text = format!("position of {wrong} mm at {} s: no program can hold it", row.t_s);
            return Err(io::Error::new(io::ErrorKind::InvalidData, text));
        }
        if starts {
            self.start_cut(row, point)?;
        }
        self.push(row.t_s, point)
    }

    /// Writes the event behind the motion so far.
    fn event(&mut self, _t_s: f64, timed: &TimedEvent) -> io::Result<()> {
        self.flush_blocks()?;
        let event = &timed.event;
        match &event.kind {
            EventKind::Dwell { seconds } => writeln!(self.out, "G4 P{seconds}"),
            EventKind::SpindleSpeed { rpm } => writeln!(self.out, "S{rpm}"),
            // The end is written by `finish`, whether the program had one or not.
            EventKind::ProgramEnd | EventKind::MCode { code: 2 | 30, .. } => Ok(()),
            EventKind::MCode { code, p, q } => {
                let word =
                    |letter, value: Option<f64>| value.map_or_else(String::new, |value| format!(" {letter}{value}"));
                writeln!(self.out, "M{code}{}{}", word('P', *p), word('Q', *q))
            }
            EventKind::ToolSelect { tool } => writeln!(self.out, "T{tool}"),
            EventKind::Message { text } => writeln!(self.out, "(MSG, {})", text.replace(['(', ')', '\n', '\r'], " ")),
            EventKind::SpindleSync { .. } => Err(inexpressible(event.line, "a motion coupled to the spindle")),
            EventKind::Probe => Err(inexpressible(event.line, "a probing motion")),
        }
    }
}

/// What the program asks for at `line` is more than positions and feeds.
fn inexpressible(line: u32, what: &str) -> io::Error {
    let message =
        format!("line {line} is {what}, which corrected G1 blocks cannot express; write setpoints (.csv) instead");
    io::Error::new(io::ErrorKind::Unsupported, message)
}

impl Printer {
    /// One block to `end_mm`: G1 at a feed, or G0 without.
    fn block(&mut self, out: &mut impl Write, axes: usize, end_mm: [f64; 3], feed_mm_s: Option<f64>) -> io::Result<()> {
        let moves = [0, 1, 2].map(|axis| end_mm[axis] != self.at_mm[axis]);
        if !moves.contains(&true) {
            return Ok(());
        }
        let level = moves[0] || moves[1];
        let wanted = [0, 1, 2].map(|axis| moves[axis] || (!self.named[axis] && axis < 2 && level));
        self.words(out, if feed_mm_s.is_some() { "G1" } else { "G0" }, axes, wanted, end_mm)?;
        self.at_mm = end_mm;
        if let Some(feed_mm_s) = feed_mm_s {
            // Rounded up to 0.1 mm/min, so that the other control may go as fast as this one did; what is above a tenth by
            // less than a thousandth of it is the rounding of times and positions.
            let feed = format!("{}", (feed_mm_s * 600.0 - 1e-3).ceil() / 10.0);
            if feed != self.feed {
                write!(out, " F{feed}")?;
                self.feed = feed;
            }
        }
        writeln!(out)
    }

    /// Names the axes that no block has named yet: a cut starts from known coordinates.
    fn name_all(&mut self, out: &mut impl Write, axes: usize) -> io::Result<()> {
        if self.named[..axes].contains(&false) {
            let unnamed = self.named.map(|named| !named);
            self.words(out, "G0", axes, unnamed, self.at_mm)?;
            writeln!(out)?;
        }
        Ok(())
    }

    fn words(
        &mut self,
        out: &mut impl Write,
        code: &str,
        axes: usize,
        wanted: [bool; 3],
        at_mm: [f64; 3],
    ) -> io::Result<()> {
        write!(out, "{code}")?;
        for axis in (0..axes).filter(|&axis| wanted[axis]) {
            let digits = format!("{:.DECIMALS$}", at_mm[axis]);
            let digits = digits.trim_end_matches('0').trim_end_matches('.');
            write!(out, " {}{}", ['X', 'Y', 'Z'][axis], if digits == "-0" { "0" } else { digits })?;
            self.named[axis] = true;
        }
        Ok(())
    }
}

/// Text that can stand within the parentheses of a comment on any control.
fn comment(note: &str) -> String {
    let plain = |c: char| {
        if c.is_ascii_graphic() && !matches!(c, '(' | ')' | '%') || c == ' ' { c } else { '?' }
    };
    note.chars().map(plain).collect()
}

#[cfg(test)]
mod tests;
