//! G-code as LinuxCNC, Fanuc, Haas, grbl, Marlin and Klipper read it: text to motions and events, in millimetres and seconds.
//!
//! A line passes through the files in this order: [`Reader`] takes it from its source, `lexer` and `expression` turn its bytes into values,
//! `block` collects them as words, `execute` applies them to the modes in RS-274's order, `travel`, `arc` and their neighbours move, and the
//! result is [`canon`]. Plain G0 and G1, nearly all lines of a long program, take the short way of `reader/plain`.

pub mod canon;
pub mod suggestion;

mod arc;
mod block;
mod characters;
mod codes;
mod compensation;
mod cycles;
mod diagnostic;
mod dialect;
mod execute;
mod expression;
mod fanuc;
mod faults;
mod firmware;
mod flow;
mod foreign;
mod lathe;
mod length;
mod lexer;
mod machine_codes;
mod offsets;
mod owords;
mod parameters;
mod plane;
mod reader;
mod settings;
mod source;
mod special;
mod spiral;
mod splines;
mod state;
mod subroutines;
mod summary;
mod surface_speed;
mod threads;
mod tools;
mod travel;
mod variables;

#[doc(hidden)]
pub use block::count_words;
pub use diagnostic::{Diagnostic, Severity};
pub use reader::{ReadError, Reader};
pub use settings::{AUTO, DIALECTS, Dialect, Increment, Settings, UnknownDialect, UnknownIncrement};
pub use state::INCH_MM;
pub use summary::{CheckError, Summary, check, summarize};
pub use tools::{Tool, ToolTable, ToolTableError};
