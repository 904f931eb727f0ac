//! Rules of style that a machine can hold: no function is longer than a screen.

use std::path::{Path, PathBuf};

use crate::source::code;

/// Folders of the crates.
const FOLDERS: [&str; 7] =
    ["crates/gcode", "crates/control", "crates/plan", "crates/sim", "crates/ident", "crates/feedwright", "lab"];

/// Lines that a function may have, from `fn` to its closing brace.
const MAX_LINES: usize = 60;

/// A function of a file.
#[derive(Debug, PartialEq)]
struct Function {
    name: String,
    /// Line of its `fn`, from 1.
    line: usize,
    lines: usize,
}

/// The functions of a source text that have a body, in order; those within others, too.
fn functions(text: &str) -> Vec<Function> {
    let code = code(text);
    let mut found = Vec::new();
    for (at, _) in code.match_indices("fn ") {
        let name: String = code[at + 3..].chars().take_while(|&c| c.is_alphanumeric() || c == '_').collect();
        if code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_') || name.is_empty() {
            continue;
        }
        if let Some(length) = body_ends(&code[at..]) {
            let line = code[..at].matches('\n').count() + 1;
            found.push(Function { name, line, lines: code[at..at + length].matches('\n').count() + 1 });
        }
    }
    found
}

/// Where the body of the function that starts the text ends; nowhere where a semicolon is in place of it.
fn body_ends(code: &str) -> Option<usize> {
    // A semicolon or a brace within these belongs to a type.
    let mut types = 0_u32;
    let mut depth = 0_u32;
    for (at, c) in code.char_indices() {
        match c {
            '(' | '[' if depth == 0 => types += 1,
            ')' | ']' if depth == 0 => types = types.saturating_sub(1),
            ';' if depth == 0 && types == 0 => return None,
            '{' if types == 0 => depth += 1,
            '}' if types == 0 => {
                depth = depth.checked_sub(1)?;
                if depth == 0 {
                    return Some(at + 1);
                }
            }
            _ => {}
        }
    }
    None
}

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn no_function_is_longer_than_a_screen() {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let mut seen = 0;
    let mut longer = Vec::new();
    for folder in FOLDERS {
        let mut sources = Vec::new();
        files(&root.join(folder).join("src"), &mut sources);
        sources.sort();
        for file in sources {
            let text = std::fs::read_to_string(&file).unwrap();
            let name = file.strip_prefix(root).unwrap().to_str().unwrap().to_owned();
            for Function { name: function, line, lines } in functions(&text) {
                seen += 1;
                if lines > MAX_LINES {
                    longer.push(format!("{name}:{line}: {function} has {lines} lines; {MAX_LINES} are the most"));
                }
            }
        }
    }
    assert!(seen > 1000, "{seen} functions: was anything read?");
    assert!(longer.is_empty(), "split what has a name of its own off these functions:\n{}", longer.join("\n"));
}

#[test]
fn the_lines_of_functions_are_counted() {
    let function = |name: &str, line, lines| Function { name: name.to_owned(), line, lines };
    let body = "    let x = '{'; // }\n    let y = \"}\";\n".repeat(30);
    let text = format!("/* fn a() {{}} */\npub const fn b<'a>(x: [f64; 3]) -> u8 {{\n{body}}}\n");
    assert_eq!(functions(&text), [function("b", 2, 62)]);
    let nested =
        "trait T {\n    fn c(&self);\n    fn d(&self) -> [u8; 2] {\n        fn e() {}\n        [1, 2]\n    }\n}\n";
    assert_eq!(functions(nested), [function("d", 3, 4), function("e", 4, 1)]);
    assert_eq!(functions("type F = fn (u8); struct S { often: fn(u8) }"), []);
}
