//! Whose G-code a file holds, by its beginning.

use std::sync::Arc;

use crate::dialects::fanuc::mill_or_lathe::{Evidence, MillOrLathe};
use crate::dialects::file_kind::FileKind;
use crate::settings::Dialect;
use crate::text::characters::is_utf16;
use crate::text::read_error::ReadError;

/// Bytes that are looked at: past the comments that slicers and CAM systems write first.
const LOOK_BYTES: usize = 1 << 16;

/// Bytes that grbl takes out of what is sent to it: feed hold, go on, report.
pub(super) const GRBL_COMMANDS: &[u8] = b"!~?";

/// The dialect of a program, why, and what deserves a look: line and message.
#[derive(Debug)]
pub(crate) struct Choice {
    pub(crate) dialect: Dialect,
    pub(crate) reason: &'static str,
    pub(crate) warning: Option<(u32, String)>,
}

/// Chooses a dialect where none is asked for, and a machine where Fanuc or Haas leave it open;
/// refuses what is no G-code.
pub(crate) fn choose(
    head: &[u8],
    name: &Arc<str>,
    asked: Option<Dialect>,
) -> Result<Choice, ReadError> {
    if head.iter().all(u8::is_ascii_whitespace) {
        return Err(ReadError::Empty { name: name.clone() });
    }
    let head = &head[..head.len().min(LOOK_BYTES)];
    if is_utf16(head) {
        return Err(ReadError::Utf16 { name: name.clone() });
    }
    if let Some(FileKind { kind, hint, .. }) = FileKind::of(head) {
        return Err(ReadError::OtherFile {
            name: name.clone(),
            kind,
            hint,
        });
    }
    if let Some(offset) = memchr::memchr(0, head) {
        return Err(ReadError::Binary {
            name: name.clone(),
            offset,
        });
    }
    let found = look(head, name)?;
    let (dialect, reason) = asked.map_or(found, |dialect| (dialect, "as was asked for"));
    let evidence = if matches!(dialect, Dialect::Fanuc | Dialect::Haas) || asked.is_none() {
        Evidence::find(head)
    } else {
        return Ok(Choice {
            dialect,
            reason,
            warning: None,
        });
    };
    if dialect == Dialect::LinuxCnc {
        // A program without its O-number, or a part of one.
        let is_plain = || !has_owords(head);
        if evidence.certain_lathe().is_some() && is_plain() {
            let reason = "it has words that only lathes of Fanuc and Haas have";
            return Ok(Choice {
                dialect: Dialect::FanucLathe,
                reason,
                warning: None,
            });
        }
        if let Some(sign) = evidence.likely_lathe().filter(|_| is_plain()) {
            let reason = "it has words of lathes of Fanuc and Haas, and none of a mill";
            let message = format!(
                "signs of a lathe of Fanuc or Haas (line {}: {}) and none of another machine: X is read as a diameter, F as a feed per revolution",
                sign.line, sign.what
            );
            return Ok(Choice {
                dialect: Dialect::FanucLathe,
                reason,
                warning: Some((sign.line, message)),
            });
        }
        return Ok(Choice {
            dialect,
            reason,
            warning: None,
        });
    }
    if !dialect.is_fanuc() {
        return Ok(Choice {
            dialect,
            reason,
            warning: None,
        });
    }
    machine(&evidence, dialect, reason, name)
}

/// Mill or lathe.
pub(super) fn machine(
    evidence: &Evidence,
    dialect: Dialect,
    reason: &'static str,
    name: &Arc<str>,
) -> Result<Choice, ReadError> {
    let of_lathe = if dialect == Dialect::Haas {
        Dialect::HaasLathe
    } else {
        Dialect::FanucLathe
    };
    // Few signs against many: read, but not in silence.
    let warning = evidence.conflict().map(|(lathe, mill)| {
        let message = format!(
            "signs of a lathe (line {}: {}) and of a mill (line {}: {}) stand in one program",
            lathe.line, lathe.what, mill.line, mill.what
        );
        (lathe.line.max(mill.line), message)
    });
    let mill = Choice {
        dialect: Dialect::FanucMill,
        reason,
        warning,
    };
    Ok(match evidence.mill_or_lathe() {
        MillOrLathe::Lathe(_) => Choice {
            dialect: of_lathe,
            ..mill
        },
        MillOrLathe::Mill(_) => mill,
        MillOrLathe::Unknown => Choice {
            warning: evidence.x_line.map(|line| (line, UNKNOWN.to_owned())),
            ..mill
        },
        MillOrLathe::Both(lathe, mill) => {
            let [(lathe_line, lathe), (mill_line, mill)] =
                [lathe, mill].map(|sign| (sign.line, sign.what));
            return Err(ReadError::MillOrLathe {
                name: name.clone(),
                lathe_line,
                lathe,
                mill_line,
                mill,
            });
        }
    })
}

const UNKNOWN: &str = "nothing in the program shows whether it is for a mill or for a lathe; it is read as one for a mill: \
                       on a lathe X is a diameter and F a feed per revolution";

fn look(head: &[u8], name: &Arc<str>) -> Result<(Dialect, &'static str), ReadError> {
    let mut choice = (Dialect::LinuxCnc, "nothing points to another control");
    let mut has_keyword = false;
    for (number, line) in (1..).zip(head.split(|&byte| byte == b'\n')) {
        let text = String::from_utf8_lossy(line);
        let text = text.trim();
        if let Some(language) = foreign(text) {
            let text = text.chars().take(80).collect();
            return Err(ReadError::Refused {
                name: name.clone(),
                language,
                line: number,
                text,
            });
        }
        if choice.0 == Dialect::LinuxCnc
            && let Some(found) = sign_of(text)
        {
            choice = found;
        }
        has_keyword |= is_oword(text.as_bytes());
    }
    // LinuxCNC reads program numbers, too.
    Ok(if has_keyword && choice.0 == Dialect::Fanuc {
        (Dialect::LinuxCnc, "it has O-words with keywords")
    } else {
        choice
    })
}

/// Returns true if there are named parameters or O-words, which only LinuxCNC has.
fn has_owords(head: &[u8]) -> bool {
    memchr::memmem::find(head, b"#<").is_some()
        || head
            .split(|&byte| byte == b'\n')
            .any(|line| is_oword(line.trim_ascii()))
}

/// Returns true if a line is an O-word with a keyword, which only LinuxCNC has.
fn is_oword(line: &[u8]) -> bool {
    let Some(label) = line.strip_prefix(b"o").or_else(|| line.strip_prefix(b"O")) else {
        return false;
    };
    let label = label.trim_ascii_start();
    let end = if label.first() == Some(&b'<') {
        label
            .iter()
            .position(|&byte| byte == b'>')
            .map_or(0, |at| at + 1)
    } else {
        label
            .iter()
            .take_while(|byte| byte.is_ascii_digit())
            .count()
    };
    // Every other keyword needs one of these.
    let keywords: [&[u8]; 7] = [
        b"sub", b"call", b"if", b"while", b"do", b"repeat", b"return",
    ];
    let keyword = label[end..].trim_ascii_start();
    let begins = |word: &&[u8]| {
        keyword
            .get(..word.len())
            .is_some_and(|start| start.eq_ignore_ascii_case(word))
    };
    end > 0 && keywords.iter().any(begins)
}

/// The control whose language a line shows, if it is no RS-274.
fn foreign(text: &str) -> Option<&'static str> {
    let upper = text.to_ascii_uppercase();
    let is_heidenhain = upper.starts_with("BEGIN PGM ")
        || upper.split_once(' ').is_some_and(|(number, rest)| {
            number.bytes().all(|byte| byte.is_ascii_digit())
                && (rest.starts_with("BEGIN PGM ")
                    || rest.starts_with("BLK FORM ")
                    || rest.starts_with("TOOL CALL "))
        });
    if is_heidenhain {
        return Some("Heidenhain Klartext");
    }
    let siemens = [
        "%_N_",
        ";$PATH=",
        "DEF REAL ",
        "DEF INT ",
        "MSG(\"",
        "WORKPIECE(",
        "TRANS X",
        "CYCLE8",
        "EXTCALL",
    ];
    if siemens.iter().any(|start| upper.starts_with(start)) || is_siemens(&upper) {
        return Some("Siemens Sinumerik");
    }
    is_okuma(&upper).then_some("Okuma OSP")
}

/// The line without comments.
fn code_of(line: &str) -> &str {
    line.split(['(', ';']).next().unwrap_or("")
}

/// The line behind its number N, in upper case.
fn behind_number(line: &str) -> &str {
    let digits = line.strip_prefix('N').map_or("", |rest| {
        rest.trim_start_matches(|c: char| c.is_ascii_digit())
    });
    if digits.is_empty() {
        line
    } else {
        digits.trim_start()
    }
}

/// Words that only a Sinumerik has: calls with brackets, assignments to axes and R parameters.
fn is_siemens(line: &str) -> bool {
    const WORDS: [&str; 9] = [
        "MCALL", "G500", "SUPA", "TRAFOOF", "WAITM", "FFWON", "ROT ", "AROT ", "ATRANS ",
    ];
    let line = behind_number(code_of(line));
    // A macro of Klipper has a name of letters: `SET_POSITION X=0`.
    if line.bytes().take(3).filter(u8::is_ascii_alphabetic).count() == 3
        && !WORDS.iter().any(|word| line.starts_with(word))
    {
        let cycle = line
            .strip_prefix("CYCLE")
            .or_else(|| line.strip_prefix("POCKET"));
        return cycle.is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()));
    }
    let assigns = [
        "X=", "Y=", "Z=", "I=", "J=", "K=", "CR=", "AP=", "RP=", "X1=", "DIAMON", "DIAMOF",
    ];
    let words = line.split_ascii_whitespace();
    WORDS.iter().any(|word| line.starts_with(word))
        || words
            .clone()
            .any(|word| assigns.iter().any(|assigned| word.starts_with(assigned)))
        || words.take(1).any(|word| {
            let digits = word.strip_prefix('R').and_then(|rest| rest.split_once('='));
            digits.is_some_and(|(digits, _)| {
                !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit())
            })
        })
}

/// Words that only an Okuma has: its variables, its call of subprograms, its work coordinates.
fn is_okuma(line: &str) -> bool {
    let line = behind_number(code_of(line));
    let starts = [
        "CALL O", "MODIN O", "MODOUT", "RTS", "NLAP", "VC1", "VZOF", "VTOF", "G15 H", "DEF WORK",
    ];
    starts.iter().any(|start| line.starts_with(start))
}

/// Returns true if digits stand alone or before a comment. In O-words of LinuxCNC a keyword follows
/// them.
fn is_program_number(text: &[u8]) -> bool {
    let digits = text.iter().take_while(|byte| byte.is_ascii_digit()).count();
    (1..=8).contains(&digits)
        && matches!(
            text[digits..].trim_ascii_start().first(),
            None | Some(b'(' | b';')
        )
}

/// Returns true if a line ends with `*` and a number.
fn has_checksum(code: &str) -> bool {
    let number = code
        .rsplit_once('*')
        .map_or("", |(_, number)| number.trim());
    !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit())
}

/// The dialect that a line shows.
fn sign_of(text: &str) -> Option<(Dialect, &'static str)> {
    let bytes = text.as_bytes();
    let first = bytes.first()?.to_ascii_uppercase();
    if first == b';' {
        let lower = text.to_ascii_lowercase();
        let slicers = [
            "slic3r",
            "prusaslicer",
            "orcaslicer",
            "superslicer",
            "simplify3d",
            "kisslicer",
            "cura",
            "flavor:",
            "bambustudio",
        ];
        return slicers
            .iter()
            .any(|name| lower.contains(name))
            .then_some((Dialect::Printer, "a slicer names itself in a comment"));
    }
    if matches!(first, b'O' | b':') && is_program_number(&bytes[1..]) {
        return Some((Dialect::Fanuc, "the program has an O-number"));
    }
    if first == b'$' {
        return Some((Dialect::Grbl, "a line begins with $"));
    }
    if first == b'(' && text.to_ascii_lowercase().contains("grbl") {
        return Some((Dialect::Grbl, "a comment names grbl"));
    }
    // The note of a corrected program.
    if text.starts_with("(corrected by feedwright")
        && text.trim_end_matches(')').ends_with("control fanuc")
    {
        return Some((Dialect::Fanuc, "a comment says that it is for fanuc"));
    }
    if text.bytes().all(|byte| GRBL_COMMANDS.contains(&byte)) {
        return Some((Dialect::Grbl, "a line of grbl's own commands"));
    }
    let code = code_of(text).to_ascii_uppercase();
    let behind = behind_number(code.trim());
    let is_numbered = behind.len() < code.trim().len();
    if is_numbered && has_checksum(behind) {
        return Some((Dialect::Printer, "numbered lines with a checksum"));
    }
    let mut words = behind.split_ascii_whitespace();
    match words.next()? {
        "M82" | "M83" | "M104" | "M106" | "M107" | "M109" | "M140" | "M190" | "M201" | "M203"
        | "M204" | "M205" | "M900"
            if !is_numbered =>
        {
            Some((Dialect::Printer, "M-codes of a 3D printer"))
        }
        "G0" | "G1" | "G00" | "G01" | "G92"
            if words.any(|word| {
                matches!(
                    word.as_bytes(),
                    [b'E' | b'e', b'0'..=b'9' | b'.' | b'-', ..]
                )
            }) =>
        {
            Some((Dialect::Printer, "motions with an E word"))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dialect(text: &str) -> Dialect {
        choose(text.as_bytes(), &"test".into(), None)
            .unwrap()
            .dialect
    }

    #[test]
    fn dialects_are_distinguished() {
        assert_eq!(dialect("G21\nG0 X1\nM2"), Dialect::LinuxCnc);
        assert_eq!(dialect("%\nO1234 (PART)\nG90 G0 X1"), Dialect::FanucMill);
        assert_eq!(
            dialect("%\nO7 (PART)\nG50 S2000\nG0 X1"),
            Dialect::FanucLathe
        );
        assert_eq!(dialect(":1000\nG0 X1 Y1"), Dialect::FanucMill);
        assert_eq!(dialect("G50 S2000\nG0 X1"), Dialect::FanucLathe);
        assert_eq!(dialect("#<a>=1\nG92 X1 F1"), Dialect::LinuxCnc);
        assert_eq!(
            dialect("G99 S500 M3\nG0 X52. Z5.\nG90 X48. Z-30. F0.2\nX46."),
            Dialect::FanucLathe
        );
        assert_eq!(
            dialect("G0 X52. Z5.\nG1 U-2. W-5. F0.25"),
            Dialect::FanucLathe
        );
        assert_eq!(
            dialect("G7 G95\nG0 X52 Z5\nG90 X48 Z-30 F0.2"),
            Dialect::LinuxCnc
        );
        assert_eq!(
            dialect("G90\nG0 X5 Z5\nG1 U-2 W-5 F0.25"),
            Dialect::LinuxCnc
        );
        assert_eq!(dialect("o100 sub\no100 endsub"), Dialect::LinuxCnc);
        assert_eq!(
            dialect("O1000 (PART)\nG21\nO<depth> CALL [2]\nM2"),
            Dialect::LinuxCnc
        );
        assert_eq!(
            dialect("M98 P9\no1 repeat [3]\nG0 X1\no1 endrepeat\nM2\nO9\nM99"),
            Dialect::LinuxCnc
        );
        assert_eq!(
            dialect("O1000 (CALL SUB)\nG0 X1 Y2\nM30"),
            Dialect::FanucMill
        );
        assert_eq!(dialect("G28\nG1 X1 Y1 E0.5"), Dialect::Printer);
        assert_eq!(dialect("; generated by PrusaSlicer 2.7"), Dialect::Printer);
        assert_eq!(dialect("N1 G28*18\nN2 G1 X5 F600*75"), Dialect::Printer);
        assert_eq!(dialect("N10 G21\nN20 G1 X1 E0.5 F600"), Dialect::Printer);
        assert_eq!(dialect("N10 M106\n#1=[2*3]\nG0 X1"), Dialect::LinuxCnc);
        assert_eq!(dialect("$H\nG0 X1"), Dialect::Grbl);
        assert_eq!(dialect("(Post Processor: grbl_post)\nG0 X1"), Dialect::Grbl);
        assert_eq!(dialect("?\nG0 X1\n~"), Dialect::Grbl);
        assert_eq!(
            dialect("(corrected by feedwright for the machine a, control fanuc)\nG4 P35"),
            Dialect::FanucMill
        );
        assert_eq!(
            dialect("(corrected by feedwright for the machine a, control generic)\nG4 P35"),
            Dialect::LinuxCnc
        );
    }

    #[test]
    fn an_unclear_machine_is_asked_for() {
        let conflict = choose(b"O1\nG50 S2500\nG43 H1", &"test".into(), None)
            .unwrap_err()
            .to_string();
        assert!(
            conflict.contains("line 2 (G50 S") && conflict.contains("line 3 (G43"),
            "{conflict}"
        );
        let known = choose(
            b"O1\nG50 S2500\nG43 H1",
            &"test".into(),
            Some(Dialect::HaasLathe),
        )
        .unwrap();
        assert_eq!(known.dialect, Dialect::HaasLathe);
        let unknown = choose(b"O1\nG1 X5. F100", &"test".into(), None).unwrap();
        assert_eq!(
            (unknown.dialect, unknown.warning.unwrap().0),
            (Dialect::FanucMill, 2)
        );
        let haas = choose(b"O1\nG50 S2500", &"test".into(), Some(Dialect::Haas)).unwrap();
        assert_eq!(haas.dialect, Dialect::HaasLathe);
    }

    #[test]
    fn other_languages_are_refused_by_name() {
        let refused = |text: &str| {
            choose(text.as_bytes(), &"test".into(), None)
                .unwrap_err()
                .to_string()
        };
        assert!(refused("0 BEGIN PGM PART MM\n1 BLK FORM 0.1 Z").contains("Heidenhain"));
        assert!(refused("%_N_PART_MPF\nG0").contains("Siemens"));
        assert!(refused("N10 G0 G90 X=R1+5").contains("Siemens"));
        assert!(refused("N20 R1=5").contains("Siemens"));
        assert!(refused("G54\nN30 CYCLE83(10,0,2,-20)").contains("Siemens"));
        assert_eq!(dialect("SET_POSITION X=0\nG0 X1"), Dialect::LinuxCnc);
        assert_eq!(
            dialect("( X=0 is the left edge )\nG0 X1"),
            Dialect::LinuxCnc
        );
        assert!(refused("G15 H1\nVC1=5").contains("Okuma"));
        assert!(refused("N5 CALL O1001 Q2").contains("Okuma"));
        assert!(refused("G\u{0}0\u{0} \u{0}X\u{0}1\u{0}").contains("UTF-16"));
        assert_eq!(dialect("N10 R1 X1 (R1=5)\nG0 X1"), Dialect::LinuxCnc);
        assert!(refused("\0\x01").contains("NUL"));
        assert!(refused(" \n\n").contains("empty"));
    }
}
