//! Files of TOML text, read value by value with every fault at its place: what machine files and
//! model files have in common.
//!
//! | File | What |
//! |---|---|
//! | `toml_file/fault.rs` | what can be wrong with such a file |
//! | `toml_file/reader.rs` | reads a table and collects every fault |
//! | `toml_file/key.rs` | keys declared in tables: name, unit, range, field |

mod fault;
pub mod key;
pub mod reader;

use std::path::Path;

use feedwright_gcode::input;
use toml::de::DeTable;

pub use fault::Fault;
pub use fault::{FileError, Kind, Problem};
pub use key::Key;
pub use reader::Table;
use reader::out_of_range;

/// Such a file is a page or a few of text; a larger one is some other file.
pub const MAX_FILE_BYTES: u64 = 1 << 20;

/// Most syntax faults that are listed; a hint counts the others. A file that is not TOML at all has
/// a fault in every line.
const MAX_SYNTAX_FAULTS: usize = 5;

/// A text, taken apart; its values know their places in the text.
pub type Document<'t> = toml::Spanned<DeTable<'t>>;

/// Takes a text apart; the faults of its syntax where it has any.
pub fn document(text: &str) -> Result<Document<'_>, Vec<Fault>> {
    let (document, syntax_errors) = DeTable::parse_recoverable(text);
    if syntax_errors.is_empty() {
        Ok(document)
    } else {
        let more = syntax_errors.len().saturating_sub(MAX_SYNTAX_FAULTS);
        let mut faults: Vec<Fault> = syntax_errors
            .iter()
            .take(MAX_SYNTAX_FAULTS)
            .map(|error| syntax_fault(error, text))
            .collect();
        if let Some(last) = faults.last_mut().filter(|_| more > 0) {
            last.hint = Some(format!(
                "{more} more places are not TOML: was another file meant?"
            ));
        }
        Err(faults)
    }
}

fn syntax_fault(error: &toml::de::Error, text: &str) -> Fault {
    let at = error.span().unwrap_or(0..0);
    let at = at.start.min(text.len())..at.end.min(text.len());
    Fault {
        at,
        label: "here",
        message: format!("not TOML: {}", error.message()),
        hint: None,
    }
}

/// Reads a file of text.
pub fn read_text(kind: &'static Kind, path: &Path) -> Result<String, FileError> {
    use std::io::Read;

    let unreadable = |source| FileError::unreadable(kind, path, source);
    let mut bytes = Vec::new();
    if input::is_standard_input(path) {
        bytes.extend_from_slice(input::standard_input().map_err(unreadable)?);
    } else {
        let file = std::fs::File::open(path).map_err(unreadable)?;
        file.take(MAX_FILE_BYTES + 1)
            .read_to_end(&mut bytes)
            .map_err(unreadable)?;
    }
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(FileError::TooLarge {
            kind,
            path: path.to_owned(),
            limit_bytes: MAX_FILE_BYTES,
            hint: kind.is,
        });
    }
    String::from_utf8(bytes).map_err(|error| {
        let offset = error.utf8_error().valid_up_to();
        let hint = format!(
            "a {} is TOML text in UTF-8; was another file meant?",
            kind.name
        );
        FileError::NotText {
            path: path.to_owned(),
            offset,
            byte: error.as_bytes()[offset],
            hint,
        }
    })
}

/// A text as TOML quotes it.
pub fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}
