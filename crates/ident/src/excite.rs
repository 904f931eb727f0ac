//! A program that shows how the axes of a machine behave: what to cut, in the air, while a log is
//! recorded.
//!
//! ```text
//! each axis alone     standstill; creeping there and back; reversals at several speeds; short strokes at the full acceleration
//! two axes together   circles from large to small at v = sqrt(a r), so that w = sqrt(a / r) grows past the position loop; a diagonal
//! ```
//!
//! A log that has some of this already needs the rest alone: [`next_excitation`] writes that.
//!
//! Creeping shows friction and its asymmetry, where inertia counts for nothing; strokes and small
//! circles show the loops and the inertia, where friction counts for little; standstills show noise
//! and offset. All moves are relative to where the machine stands, and stay within half of the
//! travel on each side of it.

pub(crate) mod recorded;

use std::fmt::Write;

use feedwright_sim::{AXIS_NAMES, Machine, to_four_digits};
use miette::Diagnostic;
use thiserror::Error;

/// Limits of the excitation program.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExciteOptions {
    /// Travel of each axis, mm: half of it on each side of where the machine stands.
    pub travel_mm: f64,
}

impl Default for ExciteOptions {
    fn default() -> Self {
        Self {
            travel_mm: TRAVEL_MM,
        }
    }
}

/// A kind of motion of one axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum MotionPart {
    /// Slow motion there and back.
    Creeping,
    /// Constant speeds there and back, from a tenth of the highest to that.
    Reversals,
    /// Short strokes that accelerate all the way.
    Strokes,
}

impl MotionPart {
    /// All, in the order of a program.
    pub const ALL: [Self; 3] = [Self::Creeping, Self::Reversals, Self::Strokes];

    /// Name in a sentence and in files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Creeping => "creeping",
            Self::Reversals => "reversals",
            Self::Strokes => "strokes",
        }
    }

    /// Names the motion and the parameters that it identifies.
    fn purpose(self) -> &'static str {
        match self {
            Self::Creeping => {
                "creeping there and back, for friction, its asymmetry, presliding and backlash"
            }
            Self::Reversals => {
                "reversals at constant speeds, for Coulomb and viscous friction, Kp and velocity feedforward"
            }
            Self::Strokes => {
                "short strokes and pulses, for inertia, delays, integral and acceleration feedforward"
            }
        }
    }
}

/// Motion of one axis in a program, and the bounds that it keeps.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisExcitation {
    /// Its place among x, y and z.
    pub axis: usize,
    /// Positions that it may go to, mm: it begins in their middle.
    pub range_mm: [f64; 2],
    /// Highest programmed speed, mm/s.
    pub fastest_mm_s: f64,
    /// Acceleration that the control is taken to move it with, mm/s2.
    pub accel_mm_s2: f64,
    /// Kinds of motion that it needs.
    pub parts: Vec<MotionPart>,
}

impl AxisExcitation {
    fn travel_mm(&self) -> f64 {
        self.range_mm[1] - self.range_mm[0]
    }
}

/// A program, and what it does.
#[derive(Debug, Clone, PartialEq)]
pub struct ExciteProgram {
    /// The text.
    pub text: String,
    /// Approximate run time, s.
    pub takes_s: f64,
    /// Highest programmed feed, mm/s.
    pub max_feed_mm_s: f64,
}

/// Why there is no program.
#[derive(Debug, Clone, PartialEq, Error, Diagnostic)]
pub enum ExciteError {
    /// The travel is out of range.
    #[error(
        "a travel of {travel_mm} mm is asked for; {MIN_TRAVEL_MM} to {MAX_TRAVEL_MM} mm are possible"
    )]
    #[diagnostic(help("free travel of 20 mm about where the machine stands is enough"))]
    Travel {
        /// Requested travel, mm.
        travel_mm: f64,
    },
}

/// Travel where nothing else is said, mm: machines of any size have it, and rapid axes come to a
/// tenth of their speed in it.
const TRAVEL_MM: f64 = 20.0;
/// Least travel, mm: circles are a quarter of it at the most.
const MIN_TRAVEL_MM: f64 = 2.0;
/// Most travel, mm.
const MAX_TRAVEL_MM: f64 = 1000.0;
/// Part of the highest feed that is used: a control slows down at its limit, and what it then does
/// is no longer what is programmed.
const FEED_PART: f64 = 0.8;
/// Speeds of creeping, mm/s, and how far each way, mm: below and above the speed at which friction
/// has its least.
const CREEPS: [(f64, f64); 3] = [(0.2, 0.08), (1.0, 0.5), (4.0, 2.0)];
/// Speeds of reversals, parts of the fastest.
const SPEEDS: [f64; 4] = [0.1, 0.3, 0.6, 1.0];
/// Short strokes: length each way, mm, and how often.
const STROKES: [(f64, u32); 4] = [(1.0, 1), (0.4, 2), (0.15, 3), (0.05, 4)];
/// Radii of circles, mm, and turns of each; larger ones first.
const CIRCLES: [(f64, u32); 7] = [
    (5.0, 1),
    (2.0, 1),
    (0.8, 2),
    (0.3, 3),
    (0.12, 4),
    (0.05, 5),
    (0.02, 6),
];
/// Part of the travel that a circle reaches over at the most.
const CIRCLE_PART: f64 = 0.5;
/// Standstill between the parts, s.
const STANDSTILL_S: f64 = 0.3;

/// The program for a machine: as many axes as it has.
///
/// # Errors
/// A travel out of range.
pub fn excitation_program(
    machine: &Machine,
    options: ExciteOptions,
) -> Result<ExciteProgram, ExciteError> {
    let travel_mm = options.travel_mm;
    if !(MIN_TRAVEL_MM..=MAX_TRAVEL_MM).contains(&travel_mm) {
        return Err(ExciteError::Travel { travel_mm });
    }
    let limits = &machine.limits;
    let motion = |axis| AxisExcitation {
        axis,
        range_mm: [-0.5 * travel_mm, 0.5 * travel_mm],
        fastest_mm_s: fastest_mm_s(machine, axis),
        accel_mm_s2: limits.tangential_accel_mm_s2,
        parts: MotionPart::ALL.to_vec(),
    };
    let axes: Vec<AxisExcitation> = (0..machine.axis_count()).map(motion).collect();
    Ok(program(
        &axes,
        limits.normal_accel_mm_s2,
        |takes_s, max_feed_mm_s| head(machine, travel_mm, takes_s, max_feed_mm_s),
    ))
}

/// The program that lets axes make the motion that a log lacks. Where each of them needs every kind
/// of motion it is the whole excitation. None where nothing is needed.
pub fn next_excitation(axes: &[AxisExcitation]) -> Option<ExciteProgram> {
    let axes: Vec<AxisExcitation> = axes
        .iter()
        .filter(|axis| !axis.parts.is_empty())
        .cloned()
        .collect();
    let accel_mm_s2 = axes
        .iter()
        .map(|axis| axis.accel_mm_s2)
        .fold(f64::INFINITY, f64::min);
    (!axes.is_empty()).then(|| {
        program(&axes, accel_mm_s2, |takes_s, max_mm_s| {
            next_head(&axes, takes_s, max_mm_s)
        })
    })
}

/// Each axis alone, and x and y together where both make all kinds of motion. The head is made of
/// the time that it takes and of the highest feed, s and mm/s.
fn program(
    axes: &[AxisExcitation],
    normal_accel_mm_s2: f64,
    head: impl Fn(f64, f64) -> String,
) -> ExciteProgram {
    let mut moves = MoveWriter {
        text: String::new(),
        takes_s: 0.0,
        max_feed_mm_s: 0.0,
        accel_mm_s2: axes
            .iter()
            .map(|axis| axis.accel_mm_s2)
            .fold(f64::INFINITY, f64::min),
        normal_accel_mm_s2,
    };
    axes.iter().for_each(|axis| moves.axis_alone(axis));
    let plane: Vec<&AxisExcitation> = axes
        .iter()
        .filter(|axis| axis.axis < 2 && axis.parts.len() == MotionPart::ALL.len())
        .collect();
    if let [x, y] = plane.as_slice() {
        moves.two_together(
            x.fastest_mm_s.min(y.fastest_mm_s),
            x.travel_mm().min(y.travel_mm()),
        );
    }
    let MoveWriter {
        text: body,
        takes_s,
        max_feed_mm_s,
        ..
    } = moves;
    let head = head(takes_s, max_feed_mm_s);
    let text = format!("{head}G21 G17 G40 G49 G80 G91 G91.1 G94 G61\n{body}G90\nM2\n");
    ExciteProgram {
        text,
        takes_s,
        max_feed_mm_s,
    }
}

/// The highest speed that is programmed for an axis, mm/s.
fn fastest_mm_s(machine: &Machine, axis: usize) -> f64 {
    let own_mm_s = machine
        .axes
        .get(axis)
        .and_then(|axis| axis.max_velocity_mm_s)
        .unwrap_or(f64::INFINITY);
    FEED_PART * machine.limits.max_feed_mm_s.min(own_mm_s)
}

/// Writes the instructions at the top of the program, as comments: what to do before, during and
/// after the run.
fn head(machine: &Machine, travel_mm: f64, takes_s: f64, max_feed_mm_s: f64) -> String {
    let names = &AXIS_NAMES[..machine.axis_count()];
    let half_mm = to_four_digits(0.5 * travel_mm);
    let (takes_s, feed) = (takes_s.round(), to_four_digits(max_feed_mm_s));
    let servo_s = machine.period.servo_s;
    let columns: Vec<String> = names
        .iter()
        .map(|name| format!("{name}.cmd {name}.act"))
        .collect();
    let mut lines = vec![
        format!("Moves that show how the axes of {} behave; written by feedwright excite.", machine.name),
        format!("About {takes_s} s, at most {feed} mm/s, within {half_mm} mm on each side of where the machine stands."),
        String::new(),
        "Check first".to_owned(),
        "- spindle off, no tool that can touch anything, no workpiece".to_owned(),
        format!("- {half_mm} mm of free travel in both directions of {}", names.join(", ")),
        "- feed override at 100 %, emergency stop in reach; a first run at 10 % shows where it goes".to_owned(),
        "- the machine is warm, and its brakes are released".to_owned(),
        String::new(),
        "Record with LinuxCNC. Where feedwright linuxcnc setup wired the machine, its record script does this. Elsewhere, in a second terminal; where a pin is on a signal already, that signal takes the place of its net".to_owned(),
        format!("  halcmd loadrt sampler depth=16000 cfg={}", "ff".repeat(names.len())),
        "  halcmd addf sampler.0 servo-thread".to_owned(),
    ];
    for (joint, name) in names.iter().enumerate() {
        for (kind, pin, offset) in [("cmd", "motor-pos-cmd", 0), ("act", "motor-pos-fb", 1)] {
            let number = 2 * joint + offset;
            lines.push(format!("  halcmd net feedwright-{name}-{kind} joint.{joint}.{pin} => sampler.0.pin.{number}"));
        }
    }
    lines.push(format!(
        "  (echo '# sample_time_s = {servo_s}'; echo '# n {}'; halsampler -t) > log.txt",
        columns.join(" ")
    ));
    lines.push("then run this program, end halsampler with Ctrl-C, and".to_owned());
    lines.push("  feedwright identify log.txt --out mine.toml --report ident.html".to_owned());
    lines.push(String::new());
    comments(&lines)
}

/// The same for the motion that a log lacks.
fn next_head(axes: &[AxisExcitation], takes_s: f64, max_feed_mm_s: f64) -> String {
    let each =
        |of: &dyn Fn(&AxisExcitation) -> String| axes.iter().map(of).collect::<Vec<_>>().join(", ");
    let name = |axis: &AxisExcitation| AXIS_NAMES[axis.axis];
    let middle_mm = |axis: &AxisExcitation| rounded(0.5 * (axis.range_mm[0] + axis.range_mm[1]));
    let start = each(&|axis| format!("{} = {} mm", name(axis), middle_mm(axis)));
    // Rounded down: it is not to exceed what is allowed.
    let within = each(&|axis| {
        format!(
            "{:.3} mm in {}",
            (500.0 * axis.travel_mm()).floor() * 1e-3,
            name(axis)
        )
    });
    comments(&[
        "Motion that a log lacks; written by feedwright identify --excite-next.".to_owned(),
        format!("About {} s, at most {} mm/s.", takes_s.round(), to_four_digits(max_feed_mm_s)),
        String::new(),
        "Check first".to_owned(),
        format!("- the axes stand at {start}: the middle of what the log covers, in its coordinates"),
        format!("- free travel on each side: {within}"),
        "- spindle off, no tool that can touch anything, no workpiece".to_owned(),
        "- feed override at 100 %, emergency stop in reach; a first run at 10 % shows where it goes".to_owned(),
        String::new(),
        "Record as the log before was recorded, and give both logs to feedwright identify.".to_owned(),
        String::new(),
    ])
}

fn comments(lines: &[String]) -> String {
    lines
        .iter()
        .map(|line| format!("; {line}").trim_end().to_owned() + "\n")
        .collect()
}

/// Writes moves, and adds up how long they take.
struct MoveWriter {
    text: String,
    takes_s: f64,
    max_feed_mm_s: f64,
    accel_mm_s2: f64,
    normal_accel_mm_s2: f64,
}

impl MoveWriter {
    /// Writing to a string cannot fail.
    fn line(&mut self, line: std::fmt::Arguments<'_>) {
        let _ = writeln!(self.text, "{line}");
    }

    fn rest(&mut self) {
        self.line(format_args!("G4 P{STANDSTILL_S}"));
        self.takes_s += STANDSTILL_S;
    }

    /// Appends a straight move of `length_mm` at `feed_mm_s` and adds its duration; `words` holds
    /// its axis words.
    fn straight(&mut self, words: std::fmt::Arguments<'_>, length_mm: f64, feed_mm_s: f64) {
        self.line(format_args!("G1 {words} F{}", minutes(feed_mm_s)));
        self.max_feed_mm_s = self.max_feed_mm_s.max(feed_mm_s);
        let accel = self.accel_mm_s2;
        let reaches = feed_mm_s * feed_mm_s / accel <= length_mm;
        self.takes_s += if reaches {
            length_mm / feed_mm_s + feed_mm_s / accel
        } else {
            2.0 * (length_mm / accel).sqrt()
        };
    }

    /// Moves the axis to one side, to the other side and back to the start.
    fn there_and_back(&mut self, axis: usize, length_mm: f64, feed_mm_s: f64) {
        let letter = AXIS_NAMES[axis].to_uppercase();
        let length_mm = rounded(length_mm);
        for part in [1.0, -2.0, 1.0] {
            let way_mm = part * length_mm;
            self.straight(format_args!("{letter}{way_mm}"), way_mm.abs(), feed_mm_s);
        }
    }

    fn axis_alone(&mut self, axis: &AxisExcitation) {
        self.accel_mm_s2 = axis.accel_mm_s2;
        self.line(format_args!("; {} alone", AXIS_NAMES[axis.axis]));
        self.rest();
        for part in axis.parts.iter().copied() {
            let (before, before_s) = (std::mem::take(&mut self.text), self.takes_s);
            match part {
                MotionPart::Creeping => self.creeping(axis),
                MotionPart::Reversals => self.reversals(axis),
                MotionPart::Strokes => self.strokes(axis),
            }
            self.rest();
            let seconds = to_four_digits((10.0 * (self.takes_s - before_s)).round() / 10.0);
            self.text = format!("{before}; {}: {seconds} s\n{}", part.purpose(), self.text);
        }
    }

    fn creeping(&mut self, motion: &AxisExcitation) {
        for (creep_mm_s, way_mm) in CREEPS {
            self.there_and_back(
                motion.axis,
                way_mm.min(0.5 * motion.travel_mm()),
                creep_mm_s.min(motion.fastest_mm_s),
            );
        }
    }

    fn reversals(&mut self, motion: &AxisExcitation) {
        let travel_mm = motion.travel_mm();
        // What can be reached within the travel: half of it to speed up, half to slow down.
        let reached_mm_s = motion
            .fastest_mm_s
            .min((self.accel_mm_s2 * travel_mm).sqrt());
        for part in SPEEDS {
            let feed_mm_s = part * reached_mm_s;
            // Ways of a quarter of a second at that speed, and what it takes to come to it.
            let way_mm = 0.5 * (0.25 * feed_mm_s + feed_mm_s * feed_mm_s / self.accel_mm_s2);
            self.there_and_back(motion.axis, way_mm.max(0.5).min(0.5 * travel_mm), feed_mm_s);
        }
    }

    fn strokes(&mut self, motion: &AxisExcitation) {
        for (way_mm, times) in STROKES {
            for _ in 0..times {
                let half_mm = 0.5 * way_mm.min(motion.travel_mm());
                self.there_and_back(motion.axis, half_mm, motion.fastest_mm_s);
            }
        }
    }

    fn two_together(&mut self, fastest_mm_s: f64, travel_mm: f64) {
        self.line(format_args!("; x and y together"));
        for (number, (radius_mm, turns)) in CIRCLES.into_iter().enumerate() {
            let radius_mm = radius_mm.min(0.5 * CIRCLE_PART * travel_mm);
            let feed_mm_s = fastest_mm_s.min((self.normal_accel_mm_s2 * radius_mm).sqrt());
            // Both senses, so that friction meets each quadrant from both sides.
            let code = if number % 2 == 0 { "G2" } else { "G3" };
            for _ in 0..turns {
                self.line(format_args!(
                    "{code} X0 Y0 I-{} J0 F{}",
                    rounded(radius_mm),
                    minutes(feed_mm_s)
                ));
                self.takes_s += std::f64::consts::TAU * radius_mm / feed_mm_s;
            }
            self.max_feed_mm_s = self.max_feed_mm_s.max(feed_mm_s);
            self.takes_s += feed_mm_s / self.accel_mm_s2;
        }
        self.rest();
        let way_mm = rounded(0.25 * travel_mm);
        let feed_mm_s = fastest_mm_s.min((self.accel_mm_s2 * way_mm).sqrt());
        for [x, y] in [
            [1.0, 1.0],
            [-2.0, -2.0],
            [1.0, 1.0],
            [1.0, -1.0],
            [-2.0, 2.0],
            [1.0, -1.0],
        ] {
            let length_mm = way_mm * libm::hypot(x, y);
            self.straight(
                format_args!("X{} Y{}", x * way_mm, y * way_mm),
                length_mm,
                feed_mm_s,
            );
        }
        self.rest();
    }
}

/// Rounds a length to 0.0001 mm, the resolution that controllers read.
fn rounded(length_mm: f64) -> f64 {
    (length_mm * 1e4).round() / 1e4
}

/// A feed in mm/min, rounded down: it is not to exceed what is allowed.
fn minutes(feed_mm_s: f64) -> f64 {
    (feed_mm_s * 600.0).floor().max(1.0) / 10.0
}
