//! Source text, for tests that hold rules over it.

/// Returns the text without comments, strings and characters, line for line, and the strings with
/// their lines.
pub(crate) fn parts(text: &str) -> (String, Vec<(usize, &str)>) {
    let (mut code, mut strings, mut line) = (String::new(), Vec::new(), 1);
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let is_string = c == '"' || rest.starts_with("r#\"");
        let skipped = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if c == '"' {
            end_of_string(rest)
        } else if rest.starts_with("r#\"") {
            rest.find("\"#").map_or(rest.len(), |end| end + 2)
        } else if let Some(length) = character(rest) {
            length
        } else {
            code.push(c);
            line += usize::from(c == '\n');
            rest = &rest[c.len_utf8()..];
            continue;
        };
        if is_string {
            strings.push((line, &rest[..skipped]));
        }
        let breaks = rest[..skipped].matches('\n').count();
        code.extend(std::iter::repeat_n('\n', breaks));
        line += breaks;
        rest = &rest[skipped..];
    }
    (code, strings)
}

/// Returns the position behind the string that starts the text.
fn end_of_string(text: &str) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            '"' if !escaped => return at + 1,
            _ => escaped = c == '\\' && !escaped,
        }
    }
    text.len()
}

/// Length in bytes of the character literal at the start of the text, with its quotes. `None` if
/// the text starts with something else, for example a lifetime.
fn character(text: &str) -> Option<usize> {
    let inside = text.strip_prefix('\'')?;
    let escape = usize::from(inside.starts_with('\\'));
    let length = escape + inside[escape..].chars().next()?.len_utf8();
    inside[length..].starts_with('\'').then_some(length + 2)
}
