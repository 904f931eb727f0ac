//! Characters that look like G-code and are not: what word processors, web pages and other
//! encodings leave in a program.

use crate::text::diagnostic::LineFault;

/// A character, its name, and what helps.
const LOOKALIKES: &[(char, &str, &str)] = &[
    ('\u{2212}', "a minus sign of typesetting", MINUS),
    ('\u{2013}', "an en dash", MINUS),
    ('\u{2014}', "an em dash", MINUS),
    ('\u{2010}', "a typeset hyphen", MINUS),
    ('\u{2011}', "a typeset hyphen", MINUS),
    ('\u{ff0d}', "a full-width minus", MINUS),
    ('\u{a0}', "a no-break space", BLANK),
    ('\u{202f}', "a narrow no-break space", BLANK),
    ('\u{2007}', "a figure space", BLANK),
    ('\u{2009}', "a thin space", BLANK),
    ('\u{3000}', "a full-width space", BLANK),
    (
        '\u{feff}',
        "a byte order mark",
        "delete it: it belongs to the beginning of a file at most",
    ),
    (
        '\u{200b}',
        "a space of no width",
        "delete it: it cannot be seen",
    ),
    (
        '\u{201c}',
        "a typeset quotation mark",
        "G-code has no quotation marks; comments stand in ( )",
    ),
    (
        '\u{201d}',
        "a typeset quotation mark",
        "G-code has no quotation marks; comments stand in ( )",
    ),
    (
        '\u{ff08}',
        "a full-width bracket",
        "comments stand in the brackets ( ) of ASCII",
    ),
    (
        '\u{ff09}',
        "a full-width bracket",
        "comments stand in the brackets ( ) of ASCII",
    ),
    (
        '\u{b0}',
        "a degree sign",
        "angles are plain numbers in degrees",
    ),
    ('\u{d8}', "a diameter sign", "write the number alone"),
];

const MINUS: &str = "write the hyphen `-` of the keyboard; the text was perhaps copied from a page or a word processor";
const BLANK: &str =
    "write the blank of the keyboard; the text was perhaps copied from a page or a word processor";

/// Returns the fault for the byte at `start`, which is not ASCII.
#[cold]
pub(super) fn not_ascii(bytes: &[u8], start: usize) -> Box<LineFault> {
    // Up to four bytes make one character; what follows may be the beginning of another.
    let longest = &bytes[start..bytes.len().min(start + 4)];
    let valid = longest
        .utf8_chunks()
        .next()
        .map_or("", |chunk| chunk.valid());
    let Some(character) = valid.chars().next() else {
        let message = format!("byte {:#04x} is not UTF-8 text", bytes[start]);
        return LineFault::new("gcode::utf8", start..start + 1, message)
            .hint("save the file as UTF-8 or plain ASCII");
    };
    let at = start..start + character.len_utf8();
    match LOOKALIKES.iter().find(|row| row.0 == character) {
        Some((_, name, hint)) => {
            let message = format!(
                "{name} (U+{:04X}) has no meaning outside a comment",
                u32::from(character)
            );
            LineFault::new("gcode::character", at, message).hint(*hint)
        }
        None => LineFault::new(
            "gcode::character",
            at,
            format!("`{character}` has no meaning outside a comment"),
        ),
    }
}

/// Returns true if the beginning of a file is UTF-16: it has a byte order mark, or a NUL in every
/// other byte.
pub(crate) fn is_utf16(head: &[u8]) -> bool {
    let pairs = head.as_chunks::<2>().0;
    let most = pairs.len().min(64);
    let nul_in = |byte: usize| pairs[..most].iter().filter(|pair| pair[byte] == 0).count();
    head.starts_with(b"\xff\xfe")
        || head.starts_with(b"\xfe\xff")
        || (most >= 4 && (nul_in(0) == most || nul_in(1) == most))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lookalikes_are_named() {
        let fault = not_ascii("X\u{2212}5".as_bytes(), 1);
        assert_eq!(
            fault.message,
            "a minus sign of typesetting (U+2212) has no meaning outside a comment"
        );
        assert_eq!((fault.at, fault.hint.as_deref()), (1..4, Some(MINUS)));
        assert_eq!(not_ascii(b"\xe9X", 0).code, "gcode::utf8");
        assert!(
            not_ascii("G1\u{a0}X1".as_bytes(), 2)
                .message
                .starts_with("a no-break space")
        );
    }

    #[test]
    fn utf16_is_recognised_with_and_without_its_mark() {
        assert!(is_utf16(b"\xff\xfeG\x000\x00"));
        assert!(is_utf16(b"G\x000\x00 \x00X\x001\x00"));
        assert!(is_utf16(b"\x00G\x000\x00 \x00X\x001"));
        assert!(!is_utf16(b"G0 X1\nG0 X2\n"));
        assert!(!is_utf16(b"\x7fELF\x02\x01\x01\x00\x00\x00"));
    }
}
