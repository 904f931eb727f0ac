//! Which file uses which: the order of `mod` lines is the order in which data flows.

use std::collections::HashMap;
use std::path::Path;

use super::source::parts;

/// Types whose methods stand in many files, and how a value of them is called.
pub(crate) type Spread<'a> = &'a [(&'a str, &'a str)];

/// A module such as `motion/arc` and its text without comments and strings.
pub(crate) struct File {
    pub(crate) module: String,
    code: String,
}

impl File {
    pub(crate) fn new(module: &str, text: &str) -> Self {
        let (code, _) = parts(text);
        // Unit tests may use what is made of their subject.
        let code = code
            .split("#[cfg(test)]\nmod tests")
            .next()
            .unwrap_or_default()
            .to_owned();
        Self {
            module: module.to_owned(),
            code,
        }
    }
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn word(text: &str) -> &str {
    &text[..text.find(|c| !is_word(c)).unwrap_or(text.len())]
}

/// Modules that a text declares, in its order.
fn declared(code: &str) -> Vec<&str> {
    let names = code.lines().filter_map(|line| {
        let (visibility, rest) = line.split_once("mod ")?;
        let is_item =
            visibility.is_empty() || (visibility.starts_with("pub") && visibility.ends_with(' '));
        rest.strip_suffix(';').filter(|_| is_item)
    });
    names.collect()
}

/// All files of a crate in the order of their `mod` lines, a parent before its children.
pub(crate) fn files(src: &Path) -> Vec<File> {
    fn walk(src: &Path, module: &str, code: &str, found: &mut Vec<File>) {
        for name in declared(code) {
            let child = if module.is_empty() {
                name.to_owned()
            } else {
                format!("{module}/{name}")
            };
            let path = src.join(format!("{child}.rs"));
            let text = std::fs::read_to_string(&path)
                .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
            let file = File::new(&child, &text);
            let code = file.code.clone();
            found.push(file);
            walk(src, &child, &code, found);
        }
    }
    // A binary has its modules in main.rs.
    let root = ["lib.rs", "main.rs"]
        .map(|name| src.join(name))
        .into_iter()
        .find(|path| path.exists());
    let root = std::fs::read_to_string(root.expect("a crate has a root")).expect("it can be read");
    let mut found = Vec::new();
    walk(src, "", &parts(&root).0, &mut found);
    found
}

/// Every path that a text names from the crate's root on, or from a parent, with its line: `a::{b,
/// c::d}` is a/b and a/c/d.
fn paths(file: &File) -> Vec<(usize, String)> {
    let mut paths = Vec::new();
    for (at, _) in file.code.match_indices("::") {
        let before = &file.code[..at];
        let first = &before[before.rfind(|c| !is_word(c)).map_or(0, |space| space + 1)..];
        let ahead = &before[..before.len() - first.len()];
        let starts = !ahead.ends_with("::");
        let (mut base, mut rest) = match first {
            // A macro that other crates expand has no other way than through the root.
            "crate" if ahead.ends_with('$') => continue,
            "crate" => (String::new(), &file.code[at + 2..]),
            "super" if starts => (parent(&file.module).to_owned(), &file.code[at + 2..]),
            _ => continue,
        };
        while let Some(after) = rest.strip_prefix("super::") {
            (base, rest) = (parent(&base).to_owned(), after);
        }
        let line = before.matches('\n').count() + 1;
        expand(&base, rest, &mut |path| paths.push((line, path)));
    }
    paths
}

fn parent(module: &str) -> &str {
    module.rsplit_once('/').map_or("", |(parent, _)| parent)
}

/// Follows a path, and each branch of a group; returns what stands behind it.
fn expand<'a>(base: &str, text: &'a str, found: &mut impl FnMut(String)) -> &'a str {
    let text = text.trim_start();
    if let Some(mut rest) = text.strip_prefix('{') {
        loop {
            rest = expand(base, rest, found).trim_start();
            let Some(after) = rest.strip_prefix(',') else {
                return rest.strip_prefix('}').unwrap_or(rest);
            };
            rest = after;
        }
    }
    let name = word(text);
    let path = if base.is_empty() {
        name.to_owned()
    } else {
        format!("{base}/{name}")
    };
    let mut rest = &text[name.len()..];
    if let Some(after) = rest.strip_prefix("::") {
        return expand(&path, after, found);
    }
    if !name.is_empty() {
        found(path);
    }
    if let Some(after) = rest.strip_prefix(" as ") {
        rest = &after[word(after).len()..];
    }
    rest
}

/// Lines of a text with the type whose `impl` they stand in.
fn lines_by_type(code: &str) -> impl Iterator<Item = (usize, &str, &str)> {
    let mut of = "";
    code.lines().enumerate().map(move |(number, line)| {
        if line.starts_with("impl") {
            let head = line.trim_end_matches(" {");
            of = word(head.rsplit(' ').next().unwrap_or(""));
        } else if line.starts_with('}') {
            of = "";
        }
        (number + 1, line, of)
    })
}

/// Files of the methods of the types that are spread.
fn methods<'a>(files: &'a [File], spread: Spread<'_>) -> HashMap<(&'a str, &'a str), &'a str> {
    let mut methods = HashMap::new();
    for file in files {
        for (_, line, of) in lines_by_type(&file.code) {
            if let Some((_, name)) = line
                .split_once("fn ")
                .filter(|_| spread.iter().any(|spread| spread.0 == of))
            {
                methods.insert((of, word(name)), file.module.as_str());
            }
        }
    }
    methods
}

/// Methods that a text calls, with lines: the type, and the name.
fn calls<'a>(file: &'a File, spread: Spread<'a>) -> Vec<(usize, &'a str, &'a str)> {
    let mut calls = Vec::new();
    for (number, line, of) in lines_by_type(&file.code) {
        for (at, dot) in line.match_indices('.').chain(line.match_indices("::")) {
            let receiver = line[..at].rsplit(|c| !is_word(c)).next().unwrap_or("");
            let spread = spread.iter().find(|(name, value)| {
                receiver == *value
                    || receiver == *name
                    || (matches!(receiver, "self" | "Self") && of == *name)
            });
            let name = word(&line[at + dot.len()..]);
            if let Some((of, _)) =
                spread.filter(|_| line[at + dot.len() + name.len()..].starts_with('('))
            {
                calls.push((number, *of, name));
            }
        }
    }
    calls
}

/// Uses, by line and module used; a path that leads to no module is what `lib.rs` gives to
/// strangers.
fn uses(
    file: &File,
    files: &[File],
    methods: &HashMap<(&str, &str), &str>,
    spread: Spread<'_>,
) -> Vec<(usize, String)> {
    let known = |path: &str| files.iter().any(|file| file.module == path);
    let module = |path: String| {
        let mut path = path.as_str();
        while !path.is_empty() && !known(path) {
            path = parent(path);
        }
        path.to_owned()
    };
    let named = paths(file)
        .into_iter()
        .map(|(line, path)| (line, module(path)));
    let called = calls(file, spread)
        .into_iter()
        .filter_map(|(line, of, name)| Some((line, (*methods.get(&(of, name))?).to_owned())));
    named
        .chain(called)
        .filter(|(_, used)| *used != file.module)
        .collect()
}

/// Returns the violations (uses of a module that stands below its user, paths through the root) and
/// the number of all uses. `outside` lists names of other crates that the root re-exports.
pub(crate) fn check(files: &[File], spread: Spread<'_>, outside: &[&str]) -> (Vec<String>, usize) {
    let methods = methods(files, spread);
    let (mut violations, mut seen) = (Vec::new(), 0);
    for (place, file) in files.iter().enumerate() {
        for (line, used) in uses(file, files, &methods, spread) {
            seen += 1;
            let (user, within) = (&file.module, |a: &str, b: &str| {
                a.starts_with(&format!("{b}/"))
            });
            let is_above = files[..place].iter().any(|above| above.module == used);
            if used.is_empty() {
                let code = file.code.lines().nth(line - 1).unwrap_or_default();
                if !outside
                    .iter()
                    .any(|name| code.contains(&format!("crate::{name}")))
                {
                    violations.push(format!(
                        "{user}.rs:{line}: a path through the root; name the module itself"
                    ));
                }
            } else if !is_above && !within(user, &used) && !within(&used, user) {
                violations.push(format!(
                    "{user}.rs:{line}: uses {used}, which stands below it"
                ));
            }
        }
    }
    (violations, seen)
}
