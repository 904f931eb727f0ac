//! How comments, names and messages are written: a doc comment begins with a verb or a noun, and the
//! words of the field stand in place of others.

use std::path::{Path, PathBuf};

use crate::source::parts;

/// Folders whose Rust sources are read.
const FOLDERS: [&str; 7] = [
    "crates",
    "lab",
    "linuxcnc/servo",
    "linuxcnc/hal",
    "fuzz/targets",
    "python",
    "web/engine",
];

/// No doc comment begins with one of these.
const BEGINNINGS: &str = "of by with without as in on at to from for where what when whether which who \
    how that those behind beside before after within under over between if so than out into per about \
    until since while because but or and not here there";

/// Words and phrases that are not used: a model, a report, a cost, evidence or a test says what is
/// meant.
const WORDS: &str = "law,laws,told,tell,tells,telling,untold,hear,hears,price,prices,priced,doubt,doubts,\
    trust,trusts,trusted,believe,believes,believed,proof,proofs,so many,by how much,that of,is none,are none,what there is,of no use,\
    there is left";

/// Names and parts of messages that have such a word, and why.
const EXCEPTIONS: [(&str, &str); 5] = [
    ("is_none", "a name of the standard library"),
    ("is_none_or", "a name of the standard library"),
    (
        "held-out: RMS above that of",
        "a claim that the results of examples/03_realism have as a key",
    ),
    (
        "held-out: max above that of",
        "a claim that the results of examples/03_realism have as a key",
    ),
    (
        "the factor 1/4 is that of tanh(x/2)",
        "a reason that the table of examples/01_paper_circle has",
    ),
];

/// One comment line of a file, without its marker and without code in backticks.
struct Comment<'a> {
    line: usize,
    text: String,
    /// True for the first line of a doc comment on an item.
    begins: bool,
    source: &'a str,
}

fn comments(text: &str) -> Vec<Comment<'_>> {
    let mut found = Vec::new();
    let mut was_doc = false;
    for (n, source) in text.lines().enumerate() {
        let line = source.trim_start();
        let is_doc = line.starts_with("///");
        let marker = ["///", "//!", "//"]
            .into_iter()
            .find(|marker| line.starts_with(marker));
        if let Some(marker) = marker {
            // Every second part stands between backticks.
            let words = line[marker.len()..].split('`').step_by(2);
            found.push(Comment {
                line: n + 1,
                text: words.collect::<Vec<_>>().join(" ").to_lowercase(),
                begins: is_doc && !was_doc,
                source,
            });
        }
        was_doc = is_doc;
    }
    found
}

fn words(text: &str) -> Vec<&str> {
    let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == '\'';
    text.split(|c| !is_word(c))
        .filter(|word| !word.is_empty())
        .collect()
}

/// Returns the first fault of a comment.
fn fault(comment: &Comment<'_>) -> Option<String> {
    let said = words(&comment.text);
    // Code at the beginning is a name.
    let doc = comment
        .source
        .trim_start()
        .trim_start_matches('/')
        .trim_start();
    let starts_with_code = doc.starts_with(['`', '[']);
    let first = said.first().filter(|_| comment.begins && !starts_with_code);
    if let Some(first) =
        first.filter(|first| BEGINNINGS.split_whitespace().any(|word| word == **first))
    {
        return Some(format!("begins with '{first}'"));
    }
    forbidden(&said)
}

/// Returns the first forbidden word among these.
fn forbidden(said: &[&str]) -> Option<String> {
    let spaced = format!(" {} ", said.join(" "));
    let word = WORDS
        .split(',')
        .map(str::trim)
        .find(|word| spaced.contains(&format!(" {word} ")))?;
    Some(format!("has '{word}'"))
}

/// Returns the words of a name in lower case: `wrongModel_s` has wrong, model and s.
fn words_of_name(name: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for part in name.split('_') {
        let mut was_lower = true;
        for c in part.chars() {
            match found
                .last_mut()
                .filter(|_| !(c.is_uppercase() && was_lower))
            {
                Some(word) if !word.is_empty() => word.extend(c.to_lowercase()),
                _ => found.push(c.to_lowercase().collect()),
            }
            was_lower = !c.is_uppercase();
        }
        found.push(String::new());
    }
    found.retain(|word| !word.is_empty());
    found
}

/// Returns the faults of the names and the messages of a source text, each with its line. A message
/// is a string that has a space.
fn faults_of_code(text: &str) -> Vec<(usize, String)> {
    let is_excepted = |said: &str| EXCEPTIONS.iter().any(|(name, _)| said.contains(name));
    let (code, strings) = parts(text);
    let mut faults = Vec::new();
    for (n, line) in code.lines().enumerate() {
        for name in words(line) {
            let named = words_of_name(name);
            let said: Vec<&str> = named.iter().map(String::as_str).collect();
            let is_exact = EXCEPTIONS.iter().any(|(exception, _)| *exception == name);
            if let Some(fault) = forbidden(&said).filter(|_| !is_exact) {
                faults.push((n + 1, format!("{name} {fault}")));
            }
        }
    }
    for (line, string) in strings {
        let lower = string.to_lowercase();
        let is_message = string.contains(' ') && !is_excepted(string);
        if let Some(fault) = forbidden(&words(&lower)).filter(|_| is_message) {
            faults.push((line, format!("{string} {fault}")));
        }
    }
    faults
}

/// Collects the Rust files below a folder, without its build folder.
fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && !path.ends_with("target") {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
}

/// Returns the Rust files with their names and texts.
fn sources() -> Vec<(String, String)> {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let mut files = Vec::new();
    FOLDERS
        .iter()
        .for_each(|folder| rust_files(&root.join(folder), &mut files));
    files.sort();
    let named = files.iter().map(|file| {
        let name = file.strip_prefix(root).unwrap().display().to_string();
        (name, std::fs::read_to_string(file).unwrap())
    });
    named.collect()
}

#[test]
fn comments_use_the_words_of_the_field() {
    let (mut seen, mut faults) = (0, Vec::new());
    for (name, text) in sources() {
        for comment in comments(&text) {
            seen += 1;
            if let Some(fault) = fault(&comment) {
                faults.push(format!(
                    "{name}:{}: {fault}: {}",
                    comment.line,
                    comment.source.trim()
                ));
            }
        }
    }
    assert!(seen > 10_000, "{seen} comment lines: was anything read?");
    assert!(
        faults.is_empty(),
        "rewrite these comments:\n{}",
        faults.join("\n")
    );
}

#[test]
fn names_and_messages_use_the_words_of_the_field() {
    let sources = sources();
    // This file lists the words.
    let others = sources
        .iter()
        .filter(|(name, _)| !name.ends_with("conformance_comments.rs"));
    let faults: Vec<String> = others
        .clone()
        .flat_map(|(name, text)| {
            faults_of_code(text)
                .into_iter()
                .map(move |(line, fault)| format!("{name}:{line}: {fault}"))
        })
        .collect();
    assert!(
        faults.is_empty(),
        "rename these names and rewrite these messages:\n{}",
        faults.join("\n")
    );
    for (exception, why) in EXCEPTIONS {
        let is_used = others.clone().any(|(_, text)| text.contains(exception));
        assert!(is_used, "{exception} needs no exception: {why}");
    }
}

#[test]
fn faults_of_comments_are_found_and_code_is_not_read() {
    let faults = |text: &str| comments(text).iter().filter_map(fault).collect::<Vec<_>>();
    assert_eq!(
        faults("/// Of the axis.\n/// Of it.\nfn a() {}\n"),
        ["begins with 'of'"]
    );
    assert_eq!(faults("    // The gain is that of x.\n"), ["has 'that of'"]);
    assert_eq!(
        faults("/// `law` of `Told`.\n//! Outlawed; a teller, an `is none`.\nlet told = 1;\n"),
        [""; 0]
    );
}

#[test]
fn faults_of_names_and_messages_are_found() {
    let faults = |text: &str| {
        faults_of_code(text)
            .into_iter()
            .map(|(line, fault)| format!("{line} {fault}"))
            .collect::<Vec<_>>()
    };
    assert_eq!(
        faults("// told\nlet told_mm = TO_TRUST;\nstruct NotTold;\nfn it_is_that_of_x() {}\n"),
        [
            "2 told_mm has 'told'",
            "2 TO_TRUST has 'trust'",
            "3 NotTold has 'told'",
            "4 it_is_that_of_x has 'that of'"
        ]
    );
    assert_eq!(
        faults("x.is_none();\nf(\"doubt\", \"no doubt\");\nlet outlaws = teller;\n"),
        ["2 \"no doubt\" has 'doubt'"]
    );
}
