//! Files that are no G-code, by their first bytes.

/// A kind of file that is given for a program now and then.
#[derive(Debug)]
pub(super) struct FileKind {
    /// Name of the kind, for the message.
    pub(super) kind: &'static str,
    /// Remedy, for the message.
    pub(super) hint: &'static str,
    /// Bytes with which such files begin; text in lower case.
    starts: &'static [&'static [u8]],
}

const EXPORT: &str =
    "export the toolpath as G-code from the CAM system, with the post-processor of the control";
const PAGE: &str = "the page was saved in place of the program: download the file itself";

const KINDS: [FileKind; 11] = [
    FileKind {
        kind: "a web page (HTML)",
        hint: PAGE,
        starts: &[b"<!doctype", b"<html", b"<head", b"<body", b"<!--"],
    },
    FileKind {
        kind: "XML or a drawing (SVG)",
        hint: EXPORT,
        starts: &[b"<?xml", b"<svg"],
    },
    FileKind {
        kind: "a PDF document",
        hint: EXPORT,
        starts: &[b"%pdf-"],
    },
    FileKind {
        kind: "a ZIP archive",
        hint: "unpack it, and name the program in it",
        starts: &[b"pk\x03\x04", b"pk\x05\x06"],
    },
    FileKind {
        kind: "a gzip archive",
        hint: "unpack it, and name the program in it",
        starts: &[b"\x1f\x8b"],
    },
    FileKind {
        kind: "an image",
        hint: EXPORT,
        starts: &[
            b"\x89png",
            b"\xff\xd8\xff",
            b"gif87a",
            b"gif89a",
            b"ii*\0",
            b"mm\0*",
        ],
    },
    FileKind {
        kind: "a program for a computer",
        hint: EXPORT,
        starts: &[b"\x7felf", b"mz\x90\0"],
    },
    FileKind {
        kind: "a model for 3D printing (STL)",
        hint: "slice it: the slicer writes the G-code",
        starts: &[b"solid "],
    },
    FileKind {
        kind: "a STEP model",
        hint: EXPORT,
        starts: &[b"iso-10303-21"],
    },
    FileKind {
        kind: "JSON",
        hint: "name the program; results of feedwright are JSON, too",
        starts: &[b"{\"", b"[{"],
    },
    FileKind {
        kind: "a script",
        hint: "run it, if it writes the program, and name what it writes",
        starts: &[b"#!"],
    },
];

const TOML: FileKind = FileKind {
    kind: "TOML, such as a machine file",
    hint: "a machine file belongs behind --machine; `feedwright check FILE.toml` checks it",
    starts: &[],
};

const TABLE: FileKind = FileKind {
    kind: "a table of values, such as a log",
    hint: "a log belongs behind --log, and `feedwright identify LOG` reads one; name the program here",
    starts: &[],
};

impl FileKind {
    /// The kind of file that begins with `head`; none where it may be G-code.
    pub(super) fn of(head: &[u8]) -> Option<&'static Self> {
        // A byte-order mark and blanks may stand in front.
        let text = head
            .strip_prefix(b"\xef\xbb\xbf")
            .unwrap_or(head)
            .trim_ascii_start();
        let begins = |start: &&[u8]| {
            text.get(..start.len())
                .is_some_and(|begin| begin.eq_ignore_ascii_case(start))
        };
        let blanks: &[u8] = b"{} \n\r\t";
        let json = text.first() == Some(&b'{')
            && text.iter().find(|byte| !blanks.contains(byte)) == Some(&b'"');
        let by_start = KINDS
            .iter()
            .find(|kind| kind.starts.iter().any(begins) || (json && kind.kind == "JSON"));
        by_start.or_else(|| Self::of_lines(text))
    }

    /// TOML by its tables and keys, and tables of values by a first line of names.
    fn of_lines(text: &[u8]) -> Option<&'static Self> {
        let mut lines = text.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
        let mut said = lines
            .by_ref()
            .filter(|line| !line.is_empty() && line[0] != b'#');
        let first = said.next()?;
        if is_toml(first) && said.next().is_none_or(is_toml) {
            return Some(&TOML);
        }
        let names = |line: &[u8]| {
            let mut cells = line
                .split(|byte| b",;\t".contains(byte))
                .map(<[u8]>::trim_ascii);
            let is_name = |cell: &[u8]| {
                cell.len() > 2
                    && cell[0].is_ascii_alphabetic()
                    && cell.contains(&b'_')
                    && cell
                        .iter()
                        .all(|byte| byte.is_ascii_alphanumeric() || b"_.".contains(byte))
            };
            line.iter().any(|byte| b",;\t".contains(byte)) && cells.all(is_name)
        };
        names(first).then_some(&TABLE)
    }
}

/// `[table]`, or `key = value` with a key of two letters or more: a word of G-code has one, and a
/// macro of Klipper has no blank before `=`.
fn is_toml(line: &[u8]) -> bool {
    let is_name = |name: &[u8]| {
        name.len() > 1
            && name[0].is_ascii_lowercase()
            && name.iter().all(|byte| {
                byte.is_ascii_lowercase() || byte.is_ascii_digit() || b"_.-".contains(byte)
            })
    };
    let table = line
        .strip_prefix(b"[")
        .and_then(|rest| rest.strip_suffix(b"]"));
    let key = memchr::memmem::find(line, b" = ").map(|at| line[..at].trim_ascii());
    table.or(key).is_some_and(is_name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_other_kinds_are_known_by_their_beginning() {
        let kind = |head: &[u8]| FileKind::of(head).map(|found| found.kind);
        for (head, word) in [
            (&b"\n<!DOCTYPE html>\n<html>"[..], "HTML"),
            (b"<?xml version=\"1.0\"?>", "XML"),
            (b"%PDF-1.4\n1 0 obj", "PDF"),
            (b"PK\x03\x04\0\0", "ZIP"),
            (b"\x1f\x8b\x08", "gzip"),
            (b"\x89PNG\r\n", "image"),
            (b"\xff\xd8\xff\xe0", "image"),
            (b"\x7fELF\x02", "computer"),
            (b"solid cube\nfacet normal 0 0 1", "STL"),
            (b"ISO-10303-21;", "STEP"),
            (b"{\n  \"format\": 1}", "JSON"),
            (b"#!/bin/sh\n", "script"),
            (b"# my machine\nname = \"mine\"\n[axis.x]\n", "TOML"),
            (b"[axis.x]\nkp = 30\n", "TOML"),
            (b"t_s,x_cmd_mm,x_act_mm\n0,0,0\n", "table"),
        ] {
            assert!(
                kind(head).is_some_and(|kind| kind.contains(word)),
                "{}",
                String::from_utf8_lossy(head)
            );
        }
        let programs: [&[u8]; 9] = [
            b"G21\nG0 X1",
            b"%\nO1 (A)",
            b"(solid)\nG0 X1",
            b"SET_POSITION X=0",
            b"#1=5\n#<a> = 3\nG0 X1",
            b"; name = x\nG1 X1",
            b"[gcode_macro]",
            b"g0 x1, y2",
            b"#100 = 1\nx1 y1",
        ];
        for program in programs.iter().filter(|program| !program.starts_with(b"[")) {
            assert_eq!(kind(program), None, "{}", String::from_utf8_lossy(program));
        }
    }
}
