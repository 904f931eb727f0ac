//! Reads G-code as LinuxCNC, Fanuc, Haas, grbl, Marlin and Klipper do: text to motions and events,
//! one by one.
//!
//! A [`Reader`] is an iterator. Modes, units, offsets, parameters, subroutines, loops, canned
//! cycles and cutter compensation are resolved; what comes out ([`canon`]) is where the tool goes,
//! along which curve and how fast. A line that is wrong comes out as a [`Diagnostic`], and the
//! reader goes on behind it, so that one run shows all mistakes.
//!
//! ```
//! use feedwright_gcode::canon::{Canon, MotionKind, Shape};
//! use feedwright_gcode::{Reader, Settings};
//!
//! let program = "G21 G90 F600\nG0 X10\n#1=5\nG1 Y[#1*2]\nG2 X20 Y0 I0 J-10\nM2\n";
//! let mut cut_mm = 0.0;
//! for step in Reader::from_text("part.ngc", program, Settings::default())? {
//!     match step {
//!         Ok(Canon::Motion(motion)) => {
//!             let curve = match &motion.shape {
//!                 Shape::Line => "straight",
//!                 Shape::Arc { .. } => "an arc",
//!                 Shape::Spline(_) => "a spline",
//!             };
//!             println!("line {}: {curve} to {:?} at {} mm/s", motion.line, motion.end_mm, motion.feed_mm_s);
//!             if motion.kind == MotionKind::Feed {
//!                 cut_mm += motion.length_mm();
//!             }
//!         }
//!         Ok(Canon::Event(event)) => println!("line {}: {:?}", event.line, event.kind),
//!         Err(mistake) => println!("line {}, column {}: {mistake}", mistake.line, mistake.column),
//!     }
//! }
//! assert!((cut_mm - (10.0 + 5.0 * std::f64::consts::PI)).abs() < 1e-9);
//! # Ok::<(), feedwright_gcode::ReadError>(())
//! ```
//!
//! # Dialects
//!
//! [`Settings::dialect`] names one; without it the beginning of the program decides
//! ([`Reader::dialect`] says which, and why).
//!
//! - LinuxCNC 2.9 (RS-274/NGC): parameters, expressions, O-words, cycles of mills and lathes,
//!   compensation, G5 to G6.2.
//! - Fanuc and Haas, mills and lathes of G-code system A: macros (IF, WHILE, GOTO, G65), G68, G16,
//!   `,R` and `,C`, G70 to G76.
//! - grbl: its commands beside RS-274, programs without an end.
//! - Marlin and Klipper: the extruder E, M-codes without limit, homing by G28, checksums.
//!
//! Languages that are no RS-274 (Heidenhain, Siemens, Okuma) are refused by name.
//!
//! # Units
//!
//! Lengths are millimetres, feeds millimetres a second, times seconds, angles of rotary axes
//! degrees, whatever the program's unit; [`INCH_MM`] is the inch. Coordinates are the machine's:
//! offsets, G92, rotations and tool lengths are added. Rapids have no feedrate; it is the machine's
//! own.
//!
//! # Mistakes
//!
//! [`ReadError`] says why a file is no program at all. A [`Diagnostic`] has a stable code, line,
//! column, and a message with value and limit; most have a hint. Each place is reported once. It is
//! a [`miette::Diagnostic`], so that miette shows it with its line and a caret.
//! [`Reader::warnings`] lists what deserves a look but does not stop the program.
//! [`Program::check`] runs through a whole program before any work begins and returns every
//! mistake, or a [`Summary`] with lengths, extent and axes.
//!
//! # What is bounded
//!
//! Memory does not grow with the program: lines are read in chunks, and motions are handed out as
//! they come. Held back is only what one block or one profile asks for, within limits. Loops
//! without a motion, motions, calls inside each other and mistakes that are kept have limits in
//! [`Settings`]; a program that exceeds one ends with a diagnostic. There is no unsafe code, and no
//! input is meant to panic.
//!
//! # Features
//!
//! The crate has none, and needs no more than files to read: it builds for
//! `wasm32-unknown-unknown`, where [`Reader::from_text`] takes the text. Motions and events
//! implement [`serde::Serialize`].
//!
//! # Layers
//!
//! The modules stand in the order in which data flows, and each uses only those above it: `text`
//! makes words of a line, `canon` is what comes out, `geometry` measures it, `settings` is what the
//! caller says, `state` what a program has brought about so far, `motion` what moves, `dialects`
//! what other controls mean by the same words, and `flow` decides which line comes next and carries
//! it out. `program` is where a program comes from. Plain G0 and G1, nearly all lines of a long
//! program, take the short way of `flow/reader/plain`.

#![warn(clippy::disallowed_methods)]

mod text;

pub mod canon;

mod geometry;
mod settings;
mod state;
mod motion;
mod dialects;
mod flow;
mod program;

pub use flow::reader::Reader;
pub use flow::summary::{CheckError, Summary, summarize};
pub use program::Program;
pub use settings::tools::{ToolTable, ToolTableError};
pub use settings::{AUTO, DIALECTS, Dialect, Increment, Settings};
pub use state::in_force::ModesInForce;
pub use state::modal::INCH_MM;
#[doc(hidden)]
pub use text::block::count_words;
pub use text::diagnostic::{Diagnostic, Severity};
pub use text::input;
pub use text::read_error::ReadError;
pub use text::suggestion;
pub use text::visible::{is_hidden, visible};
