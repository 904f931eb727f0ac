//! Text of others as it may be shown: what programs, machine files, logs and the names of files say
//! is data, and must not command the terminal, the log or the page that shows it.
//!
//! Controls (C0, DEL, C1) move the cursor, set titles and colors, and end lines. Bidirectional
//! controls and characters without a width show a text other than the one that is read: Boucher and
//! Anderson, Trojan Source (2023). Every text of others goes through [`visible`] before it is
//! shown; JSON keeps the text and spells what [`is_hidden`] as `\uXXXX`.

use std::borrow::Cow;

/// Returns true if a character has no visible form: a control character, or a mark that only
/// changes how others are shown.
pub const fn is_hidden(c: char) -> bool {
    matches!(c,
        '\0'..='\x1f' | '\x7f'..='\u{9f}'
        // Soft hyphen, bidirectional controls, zero width, separators of lines.
        | '\u{ad}' | '\u{61c}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}'
        // Tags.
        | '\u{e0000}'..='\u{e007f}')
}

/// The text in one line, character for character: what is hidden becomes a blank where it is white
/// space, else U+FFFD.
pub fn visible(text: &str) -> Cow<'_, str> {
    if !text.contains(is_hidden) {
        return Cow::Borrowed(text);
    }
    let shown = |c: char| match c {
        c if !is_hidden(c) => c,
        c if c.is_whitespace() => ' ',
        _ => '\u{fffd}',
    };
    Cow::Owned(text.chars().map(shown).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_hidden_stays() {
        let hostile = "a\x1b]0;X\x07\u{9b}31m\u{202e}b\n\tc\u{200b}\u{feff}\u{e0041}";
        assert_eq!(
            visible(hostile),
            "a\u{fffd}]0;X\u{fffd}\u{fffd}31m\u{fffd}b  c\u{fffd}\u{fffd}\u{fffd}"
        );
        assert_eq!(visible(hostile).chars().count(), hostile.chars().count());
        assert!(matches!(
            visible("größer als 5 µm → „ja“ \u{a0}x"),
            Cow::Borrowed(_)
        ));
        assert!(
            (0..=0x0010_ffff)
                .filter_map(char::from_u32)
                .filter(|c| c.is_control())
                .all(is_hidden)
        );
    }
}
