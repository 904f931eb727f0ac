//! What each JSON result says of itself: the format, and the version that wrote it.

use std::io::{self, BufWriter, Write};

use feedwright_gcode::is_hidden;
use serde::Serialize;
use serde_json::Value;

/// The format of the JSON results, as docs/json.md has it. It is raised whenever a key goes or
/// changes its meaning; new keys may come without.
pub const RESULTS_FORMAT: u32 = 1;

/// A result, an object, with its format and version.
pub(crate) fn stamped(mut result: Value) -> Value {
    result["format"] = RESULTS_FORMAT.into();
    result["version"] = env!("CARGO_PKG_VERSION").into();
    result
}

/// Writes a value as JSON, in which what [`is_hidden`] is spelled out: a terminal shows it, and a
/// program reads it unchanged.
pub(crate) fn write_json(out: &mut impl Write, value: &impl Serialize) -> io::Result<()> {
    let mut spelled = SpelledOut(BufWriter::new(out));
    serde_json::to_writer_pretty(&mut spelled, value)?;
    writeln!(spelled)?;
    spelled.flush()
}

/// Writes JSON text with [`spelled_out`]. The serializer writes whole strings, so no character is
/// divided.
struct SpelledOut<W>(W);

impl<W: Write> Write for SpelledOut<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let text = std::str::from_utf8(bytes).map_err(io::Error::other)?;
        self.0.write_all(spelled_out(text).as_bytes())?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

/// JSON text with its hidden characters as escapes; line ends stand between values and stay.
pub(crate) fn spelled_out(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        if c == '\n' || !is_hidden(c) {
            out.push(c);
        } else {
            let mut units = [0; 2];
            c.encode_utf16(&mut units)
                .iter()
                .for_each(|unit| out.push_str(&format!("\\u{unit:04x}")));
        }
    }
    out
}
