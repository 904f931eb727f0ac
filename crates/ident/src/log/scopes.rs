//! Text that the scopes of controls export: which program wrote it, what its channels are, and
//! where its rows begin.
//!
//! Each program has a header of its own before rows of numbers. What follows from the header is a
//! [`ScopeHeader`]; the rows are read like those of any table.

mod twincat;
mod tncscope;
mod servo_guide;

use super::{LogError, LogFormat};

/// Content of the header of an export.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ScopeHeader {
    pub(super) format: LogFormat,
    /// Character between columns.
    pub(super) delimiter: u8,
    /// The columns of the rows.
    pub(super) channels: Vec<ScopeChannel>,
    /// Line of the first row, from 1.
    pub(super) first_line: u64,
    /// Time between rows, s, if the header states one for all channels.
    pub(super) sample_time_s: Option<f64>,
}

/// A column of the rows.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct ScopeChannel {
    pub(super) name: String,
    pub(super) unit: String,
    /// The axis, if the header states it apart from the name.
    pub(super) axis: Option<String>,
    /// Time between its samples, s.
    pub(super) sample_time_s: Option<f64>,
    /// Samples that the header announces.
    pub(super) samples: Option<usize>,
}

/// The line that ends some exports.
pub(super) const END_MARK: &[u8] = b"EOF";

/// Lines of a header that are looked at.
const HEADER_LINES: usize = 400;

/// The header of the export that begins with `head`; none of any other text.
///
/// # Errors
/// A header of a scope that is not complete.
pub(super) fn header(head: &[u8]) -> Result<Option<ScopeHeader>, LogError> {
    let text = String::from_utf8_lossy(head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head));
    let lines: Vec<&str> = text
        .split('\n')
        .take(HEADER_LINES)
        .map(|line| line.trim_end_matches('\r'))
        .collect();
    for read in [tncscope::header, twincat::header, servo_guide::header] {
        if let Some(header) = read(&lines).transpose() {
            return header.map(Some).map_err(
                |HeaderFault {
                     line,
                     message,
                     hint,
                 }| LogError::format(Some(line), message, hint),
            );
        }
    }
    Ok(None)
}

/// Why the header of a scope cannot be used.
#[derive(Debug, Clone, PartialEq)]
struct HeaderFault {
    /// Line, from 1.
    line: u64,
    message: String,
    hint: &'static str,
}

/// A header that ends before its rows.
fn cut_off(lines: &[&str], what: &str) -> HeaderFault {
    let message = format!("the file ends within its header: {what}");
    HeaderFault {
        line: lines.len() as u64,
        message,
        hint: "export the record again; the file is cut off",
    }
}

/// The fields of a line, without quotes and blanks around them.
fn fields(line: &str, delimiter: u8) -> Vec<&str> {
    line.split(char::from(delimiter))
        .map(|field| field.trim().trim_matches('"').trim())
        .collect()
}

/// A number above zero with a decimal point or comma.
fn positive(text: &str) -> Option<f64> {
    let value = text.trim().replacen(',', ".", 1).parse::<f64>().ok()?;
    Some(value).filter(|value| value.is_finite() && *value > 0.0)
}

/// Returns true if a line is a row: two numbers or more, and nothing else.
fn is_row(line: &str, delimiter: u8) -> bool {
    let fields = fields(line, delimiter);
    let is_number = |field: &&&str| field.replacen(',', ".", 1).parse::<f64>().is_ok();
    let numbers = fields.iter().filter(is_number).count();
    numbers >= 2 && numbers + fields.iter().filter(|field| field.is_empty()).count() == fields.len()
}
