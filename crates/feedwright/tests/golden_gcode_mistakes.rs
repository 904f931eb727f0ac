//! docs/gcode-mistakes.md shows what `feedwright check` prints today; `just mistakes` writes it
//! anew.
//!
//! Golden: it holds the document to the program, not the program to the truth.

use crate::command::Folder;

/// Set to write the messages into the document instead of comparing them.
const UPDATE: &str = "FEEDWRIGHT_UPDATE_DOCUMENTS";
const DOCUMENT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/gcode-mistakes.md");
/// Fewer would mean that the programs in the document were not found.
const MIN_PROGRAMS: usize = 15;
const PROGRAM: &str = "```gcode\n";
const MESSAGE: &str = "```text\n";
const END: &str = "```\n";

/// Returns the output of `check` for a program, messages first.
fn reported(program: &str) -> String {
    let folder = Folder::new();
    folder.file("part.ngc", program);
    let ran = folder.run(&["check", "part.ngc"]);
    let text = format!("{}{}", ran.stderr, ran.stdout);
    text.lines()
        .map(|line| line.trim_end().to_owned() + "\n")
        .collect()
}

/// The document with what the program prints today, and how many programs it has.
fn written_anew(document: &str) -> (String, usize) {
    let mut parts = document.split(PROGRAM);
    let (mut text, mut count) = (parts.next().unwrap().to_owned(), 0);
    for part in parts {
        let (program, rest) = part.split_once(END).unwrap();
        let (between, rest) = rest.split_once(MESSAGE).unwrap();
        assert!(
            between.trim().is_empty(),
            "the message stands behind its program: {program}"
        );
        let after = rest
            .strip_prefix(END)
            .unwrap_or_else(|| rest.split_once("\n```\n").unwrap().1);
        text += &[
            PROGRAM,
            program,
            END,
            between,
            MESSAGE,
            &reported(program),
            END,
            after,
        ]
        .concat();
        count += 1;
    }
    (text, count)
}

#[test]
fn the_messages_in_the_document_are_those_of_the_program() {
    let document = std::fs::read_to_string(DOCUMENT).unwrap();
    let (anew, count) = written_anew(&document);
    assert!(count >= MIN_PROGRAMS, "{count}");
    if std::env::var_os(UPDATE).is_some() {
        return std::fs::write(DOCUMENT, anew).unwrap();
    }
    let difference = document
        .lines()
        .zip(anew.lines())
        .find(|(was, is)| was != is);
    assert!(
        document == anew,
        "the document is out of date; hint: `just mistakes`\nfirst difference: {difference:?}"
    );
}

#[test]
fn every_mistake_has_a_place_and_all_but_few_a_hint() {
    let document = std::fs::read_to_string(DOCUMENT).unwrap();
    let messages: Vec<&str> = document
        .split(MESSAGE)
        .skip(1)
        .filter_map(|rest| Some(rest.split_once("\n```\n")?.0))
        .collect();
    assert!(messages.len() >= MIN_PROGRAMS);
    let mistakes = messages.iter().filter(|message| message.contains('×'));
    let without_hint: Vec<_> = mistakes
        .filter(|message| !message.contains("hint: "))
        .collect();
    assert!(
        messages
            .iter()
            .filter(|message| message.contains('×'))
            .all(|message| message.contains("─[part.ngc:"))
    );
    assert!(without_hint.len() <= 3, "{without_hint:?}");
}
