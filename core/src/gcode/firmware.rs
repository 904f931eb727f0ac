//! Lines that are commands to a firmware and no G-code: macros of Klipper, texts for a display, settings of grbl.

use super::diagnostic::Fault;
use super::settings::Dialect;

/// What such a line is.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Command {
    /// The machine acts by itself: a macro, a probing of the bed. What it moves is not known here.
    Acts,
    /// A text, a setting.
    Speaks,
}

/// G-codes of printers that set the machine to work by itself: nozzle cleaning, parking, bed probing and alignment.
const PRINTER_ACTS: [&[u8]; 12] =
    [b"g11", b"g12", b"g26", b"g27", b"g29", b"g30", b"g32", b"g33", b"g34", b"g35", b"g60", b"g425"];
/// M-codes of printers that are followed by text.
const PRINTER_TEXT: [&[u8]; 8] = [b"m16", b"m23", b"m28", b"m32", b"m117", b"m118", b"m862", b"m928"];

/// Whether a line is a command to the firmware of this dialect.
pub(super) fn command(line: &[u8], dialect: Dialect) -> Option<Command> {
    let line = line.trim_ascii();
    match dialect {
        Dialect::Grbl if line.first() == Some(&b'$') && !line.to_ascii_lowercase().starts_with(b"$j") => {
            Some(Command::Speaks)
        }
        Dialect::Printer => printer_command(line),
        _ => None,
    }
}

fn printer_command(line: &[u8]) -> Option<Command> {
    if !line.first()?.is_ascii_alphabetic() {
        return None;
    }
    let end =
        line.iter().position(|byte| byte.is_ascii_whitespace() || matches!(byte, b';' | b'.')).unwrap_or(line.len());
    let word = line[..end].to_ascii_lowercase();
    if PRINTER_ACTS.contains(&word.as_slice()) {
        return Some(Command::Acts);
    }
    if PRINTER_TEXT.contains(&word.as_slice()) {
        return Some(Command::Speaks);
    }
    // A macro has a name of letters: `START_PRINT BED=60`; words of G-code have a digit or a sign behind the first letter.
    let named = word.len() > 2 && word.iter().take(3).all(|byte| byte.is_ascii_alphabetic() || *byte == b'_');
    named.then_some(Command::Acts)
}

/// The warning for a command whose motions are not known.
pub(super) fn warning(line: &[u8]) -> Box<Fault> {
    let shown = String::from_utf8_lossy(line.trim_ascii()).chars().take(40).collect::<String>();
    Fault::new(
        "gcode::firmware",
        0..line.len(),
        format!("`{shown}` is carried out by the firmware: what it moves is not known here"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn macros_and_texts_are_told_from_gcode() {
        let printer = |line: &str| command(line.as_bytes(), Dialect::Printer);
        assert_eq!(printer("START_PRINT BED=60"), Some(Command::Acts));
        assert_eq!(printer("G29 ; level"), Some(Command::Acts));
        assert_eq!(printer("M117 Printing..."), Some(Command::Speaks));
        assert_eq!(printer("G1 X1 E.2"), None);
        assert_eq!(printer("X1Y2"), None);
        assert_eq!(printer("; note"), None);
        assert_eq!(command(b"$H", Dialect::Grbl), Some(Command::Speaks));
        assert_eq!(command(b"$J=G91 X1", Dialect::Grbl), None);
        assert_eq!(command(b"START_PRINT", Dialect::LinuxCnc), None);
    }
}
