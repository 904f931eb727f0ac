//! Lines that are commands to a firmware and no G-code: macros of Klipper, texts for a display,
//! settings of grbl, smoothing of Fanuc.

use crate::dialects::choice::GRBL_COMMANDS;
use crate::settings::Dialect;
use crate::text::diagnostic::LineFault;

/// Kind of a firmware command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FirmwareCommand {
    /// The machine acts by itself: a macro, a probing of the bed. What it moves is not known here.
    Acts,
    /// A text, a setting.
    Speaks,
    /// The control plans motions in another way from here on.
    Smooths,
}

/// G-codes of printers that set the machine to work by itself: nozzle cleaning, parking, bed
/// probing and alignment.
const PRINTER_ACTS: [&[u8]; 12] = [
    b"g11", b"g12", b"g26", b"g27", b"g29", b"g30", b"g32", b"g33", b"g34", b"g35", b"g60", b"g425",
];
/// M-codes of printers that are followed by text.
const PRINTER_TEXT: [&[u8]; 11] = [
    b"m16", b"m23", b"m28", b"m32", b"m110", b"m115", b"m117", b"m118", b"m486", b"m862", b"m928",
];

/// Returns the kind of firmware command on a line of this dialect, or `None` if the line is not
/// one.
pub(crate) fn command(line: &[u8], dialect: Dialect) -> Option<FirmwareCommand> {
    let line = line.trim_ascii();
    match dialect {
        Dialect::Grbl
            if line.first() == Some(&b'$') && !line.to_ascii_lowercase().starts_with(b"$j") =>
        {
            Some(FirmwareCommand::Speaks)
        }
        Dialect::Grbl
            if !line.is_empty() && line.iter().all(|byte| GRBL_COMMANDS.contains(byte)) =>
        {
            Some(FirmwareCommand::Speaks)
        }
        Dialect::Printer => printer_command(without_number(line)),
        dialect if dialect.is_fanuc() => smooths(line).then_some(FirmwareCommand::Smooths),
        _ => None,
    }
}

/// The line behind its number: `N3 M117 text*17`.
fn without_number(line: &[u8]) -> &[u8] {
    let [b'n' | b'N', rest @ ..] = line else {
        return line;
    };
    let digits = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
    if digits > 0 {
        rest[digits..].trim_ascii_start()
    } else {
        line
    }
}

fn printer_command(line: &[u8]) -> Option<FirmwareCommand> {
    // Nearly all lines of a print: G0 to G3.
    if matches!(line, [b'G' | b'g', b'0'..=b'3', b' ', ..]) {
        return None;
    }
    if !line.first()?.is_ascii_alphabetic() && line[0] != b'_' {
        return None;
    }
    let end = line
        .iter()
        .position(|byte| byte.is_ascii_whitespace() || matches!(byte, b';' | b'.' | b'=' | b'*'))
        .unwrap_or(line.len());
    let word = &line[..end];
    let is_one_of = |codes: &[&[u8]]| codes.iter().any(|code| word.eq_ignore_ascii_case(code));
    if word.eq_ignore_ascii_case(b"g10") {
        return firmware_retract(&line[end..]);
    }
    if is_one_of(&PRINTER_ACTS) {
        return Some(FirmwareCommand::Acts);
    }
    if is_one_of(&PRINTER_TEXT) {
        return Some(FirmwareCommand::Speaks);
    }
    // A macro has a name of letters: `START_PRINT BED=60`; words of G-code have a digit or a sign
    // behind the first letter.
    let of_letters = word.len() > 2 && word.iter().take(3).all(u8::is_ascii_alphabetic);
    (of_letters || word.contains(&b'_')).then_some(FirmwareCommand::Acts)
}

/// `G10` alone, or with the S of a long retraction, pulls filament back by a length that the
/// firmware knows; RepRap's `G10 P1 S200` sets up a tool; with L it is LinuxCNC's.
fn firmware_retract(words: &[u8]) -> Option<FirmwareCommand> {
    let code = words.split(|&byte| byte == b';').next().unwrap_or(words);
    let has = |letter: u8| code.iter().any(|byte| byte.eq_ignore_ascii_case(&letter));
    match (has(b'l'), has(b'p')) {
        (true, _) => None,
        (false, true) => Some(FirmwareCommand::Speaks),
        (false, false) => Some(FirmwareCommand::Acts),
    }
}

/// Look-ahead and smoothing of Fanuc and Haas: `G5.1 Q1`, `G5 P10000`, `G8 P1`, `G187 P3 E0.01`,
/// alone on the line.
fn smooths(line: &[u8]) -> bool {
    let mut code = line
        .split(|byte| matches!(byte, b'(' | b';'))
        .next()
        .unwrap_or(line);
    if let [b'n' | b'N', rest @ ..] = code {
        let number = rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
        code = rest[number..].trim_ascii_start();
    }
    let [b'g' | b'G', code @ ..] = code else {
        return false;
    };
    let end = code
        .iter()
        .position(|byte| !byte.is_ascii_digit() && *byte != b'.')
        .unwrap_or(code.len());
    let (number, rest) = code.split_at(end);
    let mut letters = rest
        .iter()
        .filter(|byte| byte.is_ascii_alphabetic())
        .map(u8::to_ascii_lowercase);
    match number {
        b"187" => letters.all(|letter| matches!(letter, b'p' | b'e')),
        b"5.1" | b"05.1" => letters.next() == Some(b'q') && letters.all(|letter| letter == b'r'),
        b"5" | b"05" | b"8" | b"08" => letters.next() == Some(b'p') && letters.next().is_none(),
        _ => false,
    }
}

/// The warning for a command whose motions are not known, or that is left out.
pub(crate) fn warning(line: &[u8], command: FirmwareCommand) -> Box<LineFault> {
    let shown = String::from_utf8_lossy(line.trim_ascii())
        .chars()
        .take(40)
        .collect::<String>();
    let what = if command == FirmwareCommand::Smooths {
        "sets how the control smooths motions: it is left out"
    } else {
        "is carried out by the firmware: what it moves is not known here"
    };
    LineFault::new(
        "gcode::firmware",
        0..line.len(),
        format!("`{shown}` {what}"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn macros_and_texts_are_distinguished_from_gcode() {
        let printer = |line: &str| command(line.as_bytes(), Dialect::Printer);
        assert_eq!(printer("START_PRINT BED=60"), Some(FirmwareCommand::Acts));
        assert_eq!(printer("G29 ; level"), Some(FirmwareCommand::Acts));
        assert_eq!(printer("_CLEAN_NOZZLE"), Some(FirmwareCommand::Acts));
        assert_eq!(printer("M_600 X=1"), Some(FirmwareCommand::Acts));
        assert_eq!(printer("M115 U6.3.0+10073"), Some(FirmwareCommand::Speaks));
        assert_eq!(printer("M486 S0 Acube.stl"), Some(FirmwareCommand::Speaks));
        assert_eq!(printer("N3 M117 layer 1*17"), Some(FirmwareCommand::Speaks));
        assert_eq!(printer("M110 N0*125"), Some(FirmwareCommand::Speaks));
        assert_eq!(printer("N4 G1 X1 E1*97"), None);
        assert_eq!(command(b"?", Dialect::Grbl), Some(FirmwareCommand::Speaks));
        assert_eq!(command(b"!~", Dialect::Grbl), Some(FirmwareCommand::Speaks));
        assert_eq!(
            printer("G10 ; retract by the firmware's length"),
            Some(FirmwareCommand::Acts)
        );
        assert_eq!(printer("G10 S1"), Some(FirmwareCommand::Acts));
        assert_eq!(printer("G10 P1 S200"), Some(FirmwareCommand::Speaks));
        assert_eq!(printer("G10 L2 P1 X5"), None);
        assert_eq!(printer("M117 Printing..."), Some(FirmwareCommand::Speaks));
        assert_eq!(printer("G1 X1 E.2"), None);
        assert_eq!(printer("X1Y2"), None);
        assert_eq!(printer("; note"), None);
        assert_eq!(command(b"$H", Dialect::Grbl), Some(FirmwareCommand::Speaks));
        assert_eq!(command(b"$J=G91 X1", Dialect::Grbl), None);
        assert_eq!(command(b"START_PRINT", Dialect::LinuxCnc), None);
        let fanuc = |line: &str| command(line.as_bytes(), Dialect::Fanuc);
        for line in [
            "G187 P3 E0.01",
            "N10 G05.1 Q1 (AICC)",
            "G5.1Q1R5",
            "G08 P1",
            "G05 P10000",
            "g187",
        ] {
            assert_eq!(fanuc(line), Some(FirmwareCommand::Smooths), "{line}");
        }
        for line in [
            "G5.1 X1 I1 J2",
            "G8",
            "G1 X5 P1",
            "G187 P1 G0 X5",
            "G08 P1 X5",
            "",
            "N10",
            "G",
        ] {
            assert_eq!(fanuc(line), None, "{line}");
        }
    }
}
