//! The HAL lines of a configuration, in the order in which LinuxCNC executes them.
//!
//! A line consists of words between blanks. Quotation marks hold blanks together, `#` at the
//! beginning of a word starts a comment, and a backslash at the end joins the next line.
//! `[SECTION]KEY`, `[SECTION](KEY)` and `$NAME` are replaced before a line is split into words.
//! Each word keeps its place in its line, so that a copy can replace it and leave the rest as it
//! is.

use std::ops::Range;
use std::path::{Path, PathBuf};

use super::error::LinuxcncSetupError;
use super::ini::{IniEntry, IniFile, expanded, read_text, shown};

/// Files that name one another with `source`, at most.
const MOST_SOURCED: usize = 8;
/// Prefix of the name of a file in the shared folder.
const LIB: &str = "LIB:";

/// A word of a line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct HalWord {
    /// Text with the values of the INI file in place.
    pub(crate) text: String,
    /// Range of the word in [`HalLine::text`].
    pub(crate) span: Range<usize>,
}

/// A line, with those that it continues on.
#[derive(Debug, Clone)]
pub(crate) struct HalLine {
    pub(crate) text: String,
    pub(crate) words: Vec<HalWord>,
    /// Its number in the file, from 1.
    pub(crate) number: usize,
}

impl HalLine {
    /// A word, or nothing.
    pub(crate) fn word(&self, number: usize) -> &str {
        self.words.get(number).map_or("", |word| word.text.as_str())
    }
}

/// A HAL file.
#[derive(Debug, Clone)]
pub(crate) struct HalFile {
    pub(crate) path: PathBuf,
    pub(crate) lines: Vec<HalLine>,
}

/// Place of a line: number of the file, number of the line in it, both from 0.
pub(crate) type HalPlace = (usize, usize);

/// Origin of a file name: the entry of the INI file, by its number, or a line with `source`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum NamedBy {
    Entry(usize),
    Source(HalPlace),
}

/// All HAL files of a configuration.
#[derive(Debug, Clone, Default)]
pub(crate) struct HalScript {
    pub(crate) files: Vec<HalFile>,
    /// Executed lines, in their order.
    pub(crate) order: Vec<HalPlace>,
    /// Files and the entries or lines that name them.
    pub(crate) named: Vec<(NamedBy, usize)>,
    /// Remarks on the files.
    pub(crate) notes: Vec<String>,
    /// Reasons why the configuration cannot be wired.
    pub(crate) refusals: Vec<String>,
}

impl HalScript {
    pub(crate) fn read(
        ini: &IniFile,
        folder: &Path,
        hallib: &Path,
    ) -> Result<Self, LinuxcncSetupError> {
        let mut reader = HalReader {
            ini,
            folder,
            hallib,
            script: Self::default(),
            missing: Vec::new(),
        };
        if let Some(entry) = ini.entry("HAL", "TWOPASS") {
            reader.script.refusals.push(format!(
                "{}: TWOPASS loads HAL files in another way, which setup does not read. Take TWOPASS out, and load each component once",
                entry.place
            ));
        }
        for key in ["HALFILE", "POSTGUI_HALFILE"] {
            let entries = ini
                .entries
                .iter()
                .enumerate()
                .filter(|(_, entry)| entry.section == "HAL" && entry.key == key);
            for (number, entry) in entries {
                reader.file_of(number, entry, key == "HALFILE")?;
            }
        }
        if ini.all("HAL", "HALFILE").next().is_none() {
            let refusal =
                "the INI file names no HALFILE in [HAL]: without HAL files no drive is connected";
            reader.script.refusals.push(refusal.to_owned());
        }
        let HalReader {
            mut script,
            missing,
            ..
        } = reader;
        script.notes.extend(missing);
        Ok(script)
    }

    pub(crate) fn line(&self, (file, line): HalPlace) -> &HalLine {
        &self.files[file].lines[line]
    }

    /// File and line, for messages.
    pub(crate) fn place(&self, place: HalPlace) -> String {
        format!(
            "{}:{}",
            shown(&self.files[place.0].path),
            self.line(place).number
        )
    }

    /// The lines in the order of their execution.
    pub(crate) fn lines(&self) -> impl Iterator<Item = (HalPlace, &HalLine)> {
        self.order.iter().map(|&place| (place, self.line(place)))
    }
}

struct HalReader<'a> {
    ini: &'a IniFile,
    folder: &'a Path,
    hallib: &'a Path,
    script: HalScript,
    missing: Vec<String>,
}

impl HalReader<'_> {
    /// The file of an entry `HALFILE`; arguments behind the name are for Tcl.
    fn file_of(
        &mut self,
        number: usize,
        entry: &IniEntry,
        is_needed: bool,
    ) -> Result<(), LinuxcncSetupError> {
        let Some(name) = entry.value.split_whitespace().next() else {
            return Ok(());
        };
        if name.to_lowercase().ends_with(".tcl") {
            if is_needed {
                self.script.refusals.push(format!(
                    "{}: {name} is a Tcl program, which setup does not read. Start LinuxCNC with this configuration, run 'halcmd save all \
                     saved.hal' in its folder, and name saved.hal as the only HALFILE of a copy of the INI file",
                    entry.place
                ));
            } else {
                self.script.notes.push(format!(
                    "{}: {name} is a Tcl program and is not read",
                    entry.place
                ));
            }
            return Ok(());
        }
        let path = self.found(name);
        let sourced = self.append(&path, Some(entry.place.clone()), NamedBy::Entry(number), 0);
        match sourced {
            Err(LinuxcncSetupError::Unreadable { .. }) if !is_needed => {
                self.script
                    .notes
                    .push(format!("{}: {name} is not there", entry.place));
                Ok(())
            }
            other => other,
        }
    }

    /// Returns the path where LinuxCNC finds a HAL file: beside the INI file, then in the shared
    /// folder.
    fn found(&self, name: &str) -> PathBuf {
        if let Some(name) = name.strip_prefix(LIB) {
            return self.hallib.join(name);
        }
        let near = self.folder.join(expanded(name));
        let far = self.hallib.join(name);
        if !near.exists() && far.exists() {
            far
        } else {
            near
        }
    }

    fn append(
        &mut self,
        path: &Path,
        named: Option<String>,
        by: NamedBy,
        depth: usize,
    ) -> Result<(), LinuxcncSetupError> {
        let file = match self.script.files.iter().position(|file| file.path == path) {
            Some(file) => file,
            None => {
                let text = read_text(path, named)?;
                let lines = self.lines(path, &text);
                self.script.files.push(HalFile {
                    path: path.to_owned(),
                    lines,
                });
                self.script.files.len() - 1
            }
        };
        self.script.named.push((by, file));
        for line in 0..self.script.files[file].lines.len() {
            let place = (file, line);
            self.script.order.push(place);
            let read = self.script.line(place);
            if read.word(0) == "source" {
                let (name, at) = (read.word(1).to_owned(), self.script.place(place));
                if depth == MOST_SOURCED {
                    let message = format!("more than {MOST_SOURCED} files source one another");
                    let hint = "take the circle out".to_owned();
                    return Err(LinuxcncSetupError::Line {
                        place: at,
                        message,
                        hint,
                    });
                }
                let path = self.found(&name);
                self.append(&path, Some(at), NamedBy::Source(place), depth + 1)?;
            }
        }
        Ok(())
    }

    fn lines(&mut self, path: &Path, text: &str) -> Vec<HalLine> {
        let mut lines: Vec<HalLine> = Vec::new();
        let (mut held, mut first) = (String::new(), 1);
        for (number, line) in text.lines().enumerate() {
            if held.is_empty() {
                first = number + 1;
            } else {
                held.push('\n');
            }
            held.push_str(line);
            if line.trim_end().ends_with('\\') {
                continue;
            }
            lines.push(self.line(path, std::mem::take(&mut held), first));
        }
        if !held.is_empty() {
            lines.push(self.line(path, held, first));
        }
        lines
    }

    fn line(&mut self, path: &Path, text: String, number: usize) -> HalLine {
        let mut words = Vec::new();
        for (span, is_quoted) in spans(&text) {
            let raw = if is_quoted {
                &text[span.start + 1..span.end - 1]
            } else {
                &text[span.clone()]
            };
            let (value, missing) = self.replaced(raw);
            for name in missing {
                let place = format!("{}:{number}", shown(path));
                self.missing.push(format!(
                    "{place}: {name} is not in the INI file: LinuxCNC stops here"
                ));
            }
            if is_quoted {
                words.push(HalWord { text: value, span });
            } else {
                words.extend(value.split_whitespace().map(|word| HalWord {
                    text: word.to_owned(),
                    span: span.clone(),
                }));
            }
        }
        HalLine {
            text,
            words,
            number,
        }
    }

    /// A word with the values of the INI file and of the environment, and which of them are
    /// missing.
    fn replaced(&self, raw: &str) -> (String, Vec<String>) {
        let (mut text, mut missing) = (String::new(), Vec::new());
        let mut rest = raw;
        while let Some(at) = rest.find(['[', '$']) {
            text.push_str(&rest[..at]);
            let found = &rest[at..];
            let Some((name, value, length)) = self.variable(found) else {
                text.push_str(&found[..1]);
                rest = &found[1..];
                continue;
            };
            match value {
                Some(value) => text.push_str(&value),
                None => {
                    text.push_str(name);
                    missing.push(name.to_owned());
                }
            }
            rest = &found[length..];
        }
        text.push_str(rest);
        (text, missing)
    }

    /// The variable that a text begins with: as it is written, its value, and how long it is.
    fn variable<'b>(&self, text: &'b str) -> Option<(&'b str, Option<String>, usize)> {
        if let Some(rest) = text.strip_prefix('$') {
            let (name, length) = name_in(rest)?;
            let value = std::env::var(name).ok();
            return Some((&text[..=length], value, length + 1));
        }
        let (section, rest) = text.strip_prefix('[')?.split_once(']')?;
        let (key, length) = name_in(rest)?;
        let length = length + section.len() + 2;
        let value = self
            .ini
            .entry(section, key)
            .map(|entry| entry.value.clone());
        Some((&text[..length], value, length))
    }
}

/// The name that a text begins with, perhaps in parentheses, and how long it is with them.
fn name_in(text: &str) -> Option<(&str, usize)> {
    if let Some(rest) = text.strip_prefix('(') {
        let (name, _) = rest.split_once(')')?;
        return Some((name, name.len() + 2));
    }
    let is_name = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let length = text.find(|c: char| !is_name(c)).unwrap_or(text.len());
    (length > 0).then(|| (&text[..length], length))
}

/// Returns the range of each word of a line, and whether the word is in quotation marks.
fn spans(text: &str) -> Vec<(Range<usize>, bool)> {
    let mut spans = Vec::new();
    let mut signs = text.char_indices().peekable();
    while let Some((start, sign)) = signs.next() {
        match sign {
            '#' => break,
            _ if sign.is_whitespace()
                || (sign == '\\'
                    && text[start + 1..].trim_start_matches(' ').starts_with('\n')) => {}
            '"' | '\'' => match text[start + 1..].find(sign) {
                Some(length) => {
                    let end = start + length + 2;
                    spans.push((start..end, true));
                    while signs.next_if(|&(at, _)| at < end).is_some() {}
                }
                None => {
                    spans.push((start..text.len(), false));
                    break;
                }
            },
            _ => {
                let mut quote = None;
                let mut end = text.len();
                while let Some(&(at, next)) = signs.peek() {
                    match quote {
                        None if next.is_whitespace() => {
                            end = at;
                            break;
                        }
                        None if next == '"' || next == '\'' => quote = Some(next),
                        Some(mark) if mark == next => quote = None,
                        _ => {}
                    }
                    signs.next();
                }
                spans.push((start..end, false));
            }
        }
    }
    spans
}

#[cfg(test)]
mod tests {
    use super::*;

    fn script(hal: &str) -> HalScript {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name);
        std::fs::write(file("my.hal"), hal).unwrap();
        std::fs::write(
            file("my.ini"),
            "[HAL]\nHALFILE = my.hal\n[KINS]\nKINEMATICS = trivkins coordinates=XZ\n[B]\nK=5i20\n",
        )
        .unwrap();
        let ini = IniFile::read(&file("my.ini")).unwrap();
        HalScript::read(&ini, folder.path(), Path::new("/nowhere")).unwrap()
    }

    fn words(script: &HalScript) -> Vec<Vec<&str>> {
        let lines = script.files[0].lines.iter();
        lines
            .map(|line| line.words.iter().map(|word| word.text.as_str()).collect())
            .collect()
    }

    #[test]
    fn words_are_separated_as_halcmd_does() {
        let script = script(
            "loadrt [KINS]KINEMATICS\nnet a hm2_[B](K).0.x => b #c\nsetp a.b \"one two\" # d\nnet a \\\n  b c\n#net x\nsetp f [B]MISSING\n",
        );
        let found = words(&script);
        assert_eq!(found[0], ["loadrt", "trivkins", "coordinates=XZ"]);
        assert_eq!(found[1], ["net", "a", "hm2_5i20.0.x", "=>", "b"]);
        assert_eq!(found[2], ["setp", "a.b", "one two"]);
        assert_eq!(found[3], ["net", "a", "b", "c"]);
        assert!(found[4].is_empty());
        assert_eq!(
            script.notes,
            ["my.hal:7: [B]MISSING is not in the INI file: LinuxCNC stops here"]
        );
        let line = &script.files[0].lines[1];
        assert_eq!(&line.text[line.words[2].span.clone()], "hm2_[B](K).0.x");
        assert_eq!(script.files[0].lines[5].number, 7);
    }
}
