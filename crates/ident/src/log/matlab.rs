//! Variables of MATLAB and Octave: MAT-files of version 5, with and without compression, of either
//! byte order.
//!
//! ```text
//! file      128 bytes of header, elements
//! element   type u32, bytes u32, data, zeros up to 8 bytes;   small: type u16, bytes u16, data in 4 bytes
//! type      14 matrix; 15 the same, deflated as zlib does; 1 to 13 numbers
//! matrix    flags (class), dimensions, name, numbers by columns
//! ```
//!
//! Source: The MathWorks, MAT-File Format. Vectors of real numbers are columns of the log, and so
//! are the columns of matrices that are longer than wide; text, cells, structs and what is complex
//! or sparse is left out.

use std::io::Read;

use feedwright_sim::{StageSteps, Watch};
use miniz_oxide::inflate::{TINFLStatus, decompress_to_vec_zlib_with_limit};

use super::table::{LineNumbers, LogColumn, LogTable};
use super::{LogError, LogFormat};

const HEADER_BYTES: usize = 128;
/// Limit of the memory for the numbers of a file, bytes: this constant, and [`BYTES_PER_BYTE`] for
/// each byte of the file. Measured positions deflate to a quarter and more of their size; zeros to
/// a thousandth, so that a small file could fill the memory.
const FREE_BYTES: usize = 16 << 20;
const BYTES_PER_BYTE: usize = 16;
/// Bytes of a number in memory.
const NUMBER_BYTES: usize = 8;
/// Most columns that a matrix is taken apart into.
const MAX_COLUMNS: usize = 64;
/// Names of scalars that are the time between samples, s.
const SAMPLE_TIMES: [&str; 6] = ["ts", "dt", "t_s", "sample_time", "sampletime", "tsample"];

const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;

/// Returns true if a file begins as a MATLAB file, or as its successor, which is refused with a
/// hint.
pub(super) fn is_matlab(head: &[u8]) -> bool {
    head.starts_with(b"MATLAB 5.0 MAT-file") || is_hdf5(head)
}

fn is_hdf5(head: &[u8]) -> bool {
    head.starts_with(b"MATLAB 7.3 MAT-file") || head.starts_with(b"\x89HDF\r\n")
}

/// Reads all vectors of a file.
pub(super) fn read(
    file: &mut impl Read,
    steps: &mut StageSteps<'_>,
    watch: &dyn Watch,
) -> Result<LogTable, LogError> {
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes).map_err(LogError::unreadable)?;
    let fault = |message: String| {
        LogError::format(
            None,
            message,
            "save it anew: save('log.mat', 't', 'x_cmd', 'x_act', '-v7')",
        )
    };
    if is_hdf5(&bytes) {
        return Err(fault("MATLAB files of version 7.3 are not read".to_owned()));
    }
    let order = match bytes.get(126..HEADER_BYTES) {
        Some(b"IM") => ByteOrder::Little,
        Some(b"MI") => ByteOrder::Big,
        _ => {
            return Err(fault(
                "the header of the MATLAB file is not whole".to_owned(),
            ));
        }
    };
    let mut variables: Vec<Variable> = Vec::new();
    let most_bytes = FREE_BYTES + BYTES_PER_BYTE * bytes.len();
    let mut left_bytes = most_bytes;
    let mut rest = &bytes[HEADER_BYTES..];
    while !rest.is_empty() {
        watch.check()?;
        let at = bytes.len() - rest.len();
        let element = Element::take(&mut rest, order).ok_or_else(|| {
            fault(format!(
                "the MATLAB file is cut off: its variable at byte {at} is not whole"
            ))
        })?;
        if let Some(variable) = variable(element, order, left_bytes).map_err(|why| match why {
            VariableFault::Broken(why) => fault(format!("variable at byte {at}: {why}")),
            VariableFault::TooLarge => {
                let message = format!(
                    "variable at byte {at}: the numbers take more than {most_bytes} bytes, though the file has only {}",
                    bytes.len()
                );
                LogError::format(
                    None,
                    message,
                    "save the columns of the log alone, or uncompressed: save(..., '-v6')",
                )
            }
        })? {
            left_bytes = left_bytes.saturating_sub(variable.bytes());
            variables.push(variable);
        }
        steps.reach(1.0 - rest.len() as f64 / bytes.len() as f64);
    }
    table(variables).ok_or_else(|| fault("no two vectors of numbers of the same length".to_owned()))
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ByteOrder {
    Little,
    Big,
}

/// Type and data of an element.
#[derive(Debug, Clone, Copy)]
struct Element<'a> {
    kind: u32,
    data: &'a [u8],
}

impl<'a> Element<'a> {
    /// Takes the next element off the front.
    fn take(bytes: &mut &'a [u8], order: ByteOrder) -> Option<Self> {
        let first = u32_of(bytes.get(..4)?, order)?;
        if first >> 16 != 0 {
            let (kind, size) = (first & 0xffff, (first >> 16) as usize);
            let data = bytes.get(4..8)?.get(..size)?;
            *bytes = &bytes[8..];
            return Some(Self { kind, data });
        }
        let size = u32_of(bytes.get(4..8)?, order)? as usize;
        let data = bytes.get(8..)?.get(..size)?;
        let padded = if first == COMPRESSED {
            size
        } else {
            size.next_multiple_of(8)
        };
        // The zeros behind the last element may be missing.
        *bytes = bytes.get(8 + padded..).unwrap_or_default();
        Some(Self { kind: first, data })
    }
}

fn u32_of(bytes: &[u8], order: ByteOrder) -> Option<u32> {
    let bytes: [u8; 4] = bytes.try_into().ok()?;
    Some(match order {
        ByteOrder::Little => u32::from_le_bytes(bytes),
        ByteOrder::Big => u32::from_be_bytes(bytes),
    })
}

/// A variable: name and columns.
struct Variable {
    name: String,
    columns: Vec<Vec<f64>>,
}

impl Variable {
    /// Bytes of its numbers.
    fn bytes(&self) -> usize {
        self.columns
            .iter()
            .map(|column| NUMBER_BYTES * column.len())
            .sum()
    }
}

/// Why a variable is not read.
enum VariableFault {
    Broken(String),
    /// Its numbers take more memory than is left for them.
    TooLarge,
}

impl From<&str> for VariableFault {
    fn from(why: &str) -> Self {
        Self::Broken(why.to_owned())
    }
}

/// Returns the numbers of an element, which may take `most_bytes` bytes; `None` where it holds
/// anything else.
fn variable(
    element: Element<'_>,
    order: ByteOrder,
    most_bytes: usize,
) -> Result<Option<Variable>, VariableFault> {
    match element.kind {
        COMPRESSED => {
            let inflated =
                decompress_to_vec_zlib_with_limit(element.data, most_bytes).map_err(|error| {
                    match error.status {
                        TINFLStatus::HasMoreOutput => VariableFault::TooLarge,
                        _ => VariableFault::Broken(format!("cannot be inflated ({error})")),
                    }
                })?;
            let inner = Element::take(&mut inflated.as_slice(), order).ok_or("is not whole")?;
            if inner.kind == MATRIX {
                matrix(inner.data, order, most_bytes)
            } else {
                Ok(None)
            }
        }
        MATRIX => matrix(element.data, order, most_bytes),
        _ => Ok(None),
    }
}

fn matrix(
    mut data: &[u8],
    order: ByteOrder,
    most_bytes: usize,
) -> Result<Option<Variable>, VariableFault> {
    const CUT_OFF: &str = "is not whole";
    let mut next = || Element::take(&mut data, order).ok_or(CUT_OFF);
    let flags = u32_of(next()?.data.get(..4).ok_or(CUT_OFF)?, order).ok_or(CUT_OFF)?;
    let (class, is_complex) = (flags & 0xff, flags & 0x800 != 0);
    let is_numeric = (6..=15).contains(&class) && !is_complex;
    if !is_numeric {
        return Ok(None);
    }
    let dimensions: Vec<usize> = next()?
        .data
        .chunks_exact(4)
        .filter_map(|d| Some(u32_of(d, order)? as usize))
        .collect();
    let name = String::from_utf8_lossy(next()?.data).into_owned();
    let [rows, columns] = dimensions[..] else {
        return Ok(None);
    };
    if rows.saturating_mul(columns).saturating_mul(NUMBER_BYTES) > most_bytes {
        return Err(VariableFault::TooLarge);
    }
    let element = next()?;
    let of =
        |data| numbers(Element { data, ..element }, order).ok_or("has numbers of an unknown type");
    let number_bytes = NUMBER_BYTES / of(&[0; NUMBER_BYTES])?.len();
    let count = element.data.len() / number_bytes;
    if Some(count) != rows.checked_mul(columns) {
        return Err(VariableFault::Broken(format!(
            "'{}' has {count} numbers, not {rows} x {columns}",
            name.escape_debug()
        )));
    }
    let is_vector = rows == 1 || columns == 1;
    let is_read = count > 0 && (is_vector || rows > columns && columns <= MAX_COLUMNS);
    // Column by column: all numbers at once would be in memory twice.
    let column_bytes = number_bytes * if is_vector { count } else { rows };
    let columns = if is_read {
        element
            .data
            .chunks_exact(column_bytes)
            .map(of)
            .collect::<Result<_, _>>()?
    } else {
        Vec::new()
    };
    Ok(Some(Variable { name, columns }))
}

/// The numbers of an element, whatever their type.
fn numbers(element: Element<'_>, order: ByteOrder) -> Option<Vec<f64>> {
    macro_rules! of {
        ($type:ty) => {{
            const SIZE: usize = size_of::<$type>();
            let (chunks, _) = element.data.as_chunks::<SIZE>();
            let read = match order {
                ByteOrder::Little => <$type>::from_le_bytes,
                ByteOrder::Big => <$type>::from_be_bytes,
            };
            chunks.iter().map(|&bytes| read(bytes) as f64).collect()
        }};
    }
    Some(match element.kind {
        1 => of!(i8),
        2 => of!(u8),
        3 => of!(i16),
        4 => of!(u16),
        5 => of!(i32),
        6 => of!(u32),
        7 => of!(f32),
        9 => of!(f64),
        12 => of!(i64),
        13 => of!(u64),
        _ => return None,
    })
}

/// The vectors of the most frequent length; none where no two have the same.
fn table(variables: Vec<Variable>) -> Option<LogTable> {
    let is_time = |name: &str| SAMPLE_TIMES.contains(&name.to_lowercase().as_str());
    let sample_time_s =
        variables
            .iter()
            .find(|v| is_time(&v.name))
            .and_then(|v| match &v.columns[..] {
                [column] if column.len() == 1 => {
                    Some(column[0]).filter(|&s| s.is_finite() && s > 0.0)
                }
                _ => None,
            });
    let mut times = std::collections::BTreeMap::new();
    for column in variables
        .iter()
        .flat_map(|variable| &variable.columns)
        .filter(|column| column.len() > 1)
    {
        *times.entry(column.len()).or_insert(0_usize) += 1;
    }
    let (&length, _) = times
        .iter()
        .max_by_key(|&(&length, &count)| (count, length))
        .filter(|&(_, &count)| count > 1)?;
    let mut columns = Vec::new();
    for Variable {
        name,
        columns: found,
    } in variables
    {
        let several = found.len() > 1;
        for (number, values) in found
            .into_iter()
            .enumerate()
            .filter(|(_, values)| values.len() == length)
        {
            let name = if several {
                format!("{name}({})", number + 1)
            } else {
                name.clone()
            };
            let nan = values.iter().position(|value| value.is_nan());
            let not_a_number = nan.map(|row| (row, "NaN".to_owned()));
            columns.push(LogColumn {
                name,
                values,
                not_a_number,
                ..LogColumn::default()
            });
        }
    }
    let (breaks, lines) = (Vec::new(), LineNumbers::default());
    Some(LogTable {
        format: LogFormat::Matlab,
        columns,
        breaks,
        lines,
        sample_time_s,
        position_unit: None,
        cut_off_line: None,
        announced_rows: None,
    })
}
