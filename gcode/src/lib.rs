//! G-code as LinuxCNC, Fanuc, Haas, grbl, Marlin and Klipper read it: text to motions and events, in millimetres and seconds.

mod text;

pub mod canon;

mod geometry;

mod settings;

mod state;

mod motion;

mod dialects;

mod flow;

pub use flow::reader::Reader;
pub use flow::summary::{CheckError, Summary, check, summarize};
pub use settings::tools::{Tool, ToolTable, ToolTableError};
pub use settings::{AUTO, DIALECTS, Dialect, Increment, Settings, UnknownDialect, UnknownIncrement};
pub use state::modal::INCH_MM;
#[doc(hidden)]
pub use text::block::count_words;
pub use text::diagnostic::{Diagnostic, Severity};
pub use text::read_error::ReadError;
pub use text::suggestion;
