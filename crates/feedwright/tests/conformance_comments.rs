//! How comments are written: a doc comment begins with a verb or a noun, and the words of the field
//! stand in place of others.

use std::path::Path;

use crate::conformance_names::rust_files;

/// Folders whose Rust sources are read.
const FOLDERS: [&str; 4] = ["crates", "lab", "linuxcnc/servo", "linuxcnc/hal"];

/// No doc comment begins with one of these.
const BEGINNINGS: &str = "of by with without as in on at to from for where what when whether which who \
    how that those behind beside before after within under over between if so than out into per about \
    until since while because but or and not here there";

/// Words and phrases that are not used: a model, a report, a cost, evidence or a test says what is
/// meant.
const WORDS: &str = "law,laws,told,tell,tells,hear,hears,price,prices,doubt,doubts,trust,trusts,trusted,\
    believe,believed,proof,proofs,so many,by how much,that of,is none,are none,what there is,of no use,\
    there is left";

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
    let spaced = format!(" {} ", said.join(" "));
    let word = WORDS
        .split(',')
        .map(str::trim)
        .find(|word| spaced.contains(&format!(" {word} ")))?;
    Some(format!("has '{word}'"))
}

#[test]
fn comments_use_the_words_of_the_field() {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let mut files = Vec::new();
    FOLDERS
        .iter()
        .for_each(|folder| rust_files(&root.join(folder), &mut files));
    files.sort();
    let (mut seen, mut faults) = (0, Vec::new());
    for file in &files {
        let text = std::fs::read_to_string(file).unwrap();
        for comment in comments(&text) {
            seen += 1;
            if let Some(fault) = fault(&comment) {
                let name = file.strip_prefix(root).unwrap().display();
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
fn faults_of_comments_are_found_and_code_is_none() {
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
