//! The INI file of a LinuxCNC configuration, with its includes in place.
//!
//! A line is `[SECTION]`, `KEY = VALUE`, `#INCLUDE FILE`, or a comment that begins with `#` or `;`.
//! A backslash at the end of a line joins the next one. A key may come several times; the first
//! counts, except in lists such as `HALFILE`.

use std::path::{Path, PathBuf};

use super::error::LinuxcncSetupError;

/// Includes inside includes, at most: more are a circle.
const MOST_INCLUDES: usize = 8;
/// Keyword in front of the name of an included file.
const INCLUDE: &str = "#INCLUDE";

/// An INI file, includes in place.
#[derive(Debug, Clone, Default)]
pub(crate) struct IniFile {
    /// All lines, without their ends.
    pub(crate) lines: Vec<String>,
    /// Every value, in the order of the file.
    pub(crate) entries: Vec<IniEntry>,
}

/// A value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct IniEntry {
    pub(crate) section: String,
    pub(crate) key: String,
    pub(crate) value: String,
    /// Its first and last line in [`IniFile::lines`].
    pub(crate) lines: [usize; 2],
    /// File and line, for messages.
    pub(crate) place: String,
}

impl IniFile {
    pub(crate) fn read(path: &Path) -> Result<Self, LinuxcncSetupError> {
        let mut places = Vec::new();
        let mut ini = Self::default();
        ini.append(path, None, 0, &mut places)?;
        ini.parse(&places);
        if ini.entries.is_empty() {
            let hint = "name the INI file of a LinuxCNC configuration".to_owned();
            let message = "no section and no value: this is no INI file".to_owned();
            return Err(LinuxcncSetupError::Line {
                place: shown(path),
                message,
                hint,
            });
        }
        Ok(ini)
    }

    /// The lines of a file and of what it includes.
    fn append(
        &mut self,
        path: &Path,
        named: Option<String>,
        depth: usize,
        places: &mut Vec<String>,
    ) -> Result<(), LinuxcncSetupError> {
        let text = read_text(path, named)?;
        for (number, line) in text.lines().enumerate() {
            let place = format!("{}:{}", shown(path), number + 1);
            match line
                .trim_start()
                .strip_prefix(INCLUDE)
                .filter(|rest| rest.starts_with(char::is_whitespace))
            {
                Some(_) if depth == MOST_INCLUDES => {
                    let message = format!("more than {MOST_INCLUDES} files include one another");
                    let hint = "take the circle out".to_owned();
                    return Err(LinuxcncSetupError::Line {
                        place,
                        message,
                        hint,
                    });
                }
                Some(name) => {
                    let file = path
                        .parent()
                        .unwrap_or(Path::new(""))
                        .join(expanded(name.trim()));
                    self.append(&file, Some(place), depth + 1, places)?;
                }
                None => {
                    self.lines.push(line.to_owned());
                    places.push(place);
                }
            }
        }
        Ok(())
    }

    fn parse(&mut self, places: &[String]) {
        let mut section = String::new();
        let mut at = 0;
        while at < self.lines.len() {
            let first = at;
            let mut line = self.lines[at].trim().to_owned();
            while line.ends_with('\\') && at + 1 < self.lines.len() && !is_comment(&line) {
                at += 1;
                line.pop();
                line.push_str(self.lines[at].trim());
            }
            if let Some(name) = line.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
                section = name.0.trim().to_owned();
            } else if let Some((key, value)) = line.split_once('=').filter(|_| !is_comment(&line)) {
                let (key, value) = (key.trim().to_owned(), value.trim().to_owned());
                let place = places.get(first).cloned().unwrap_or_default();
                self.entries.push(IniEntry {
                    section: section.clone(),
                    key,
                    value,
                    lines: [first, at],
                    place,
                });
            }
            at += 1;
        }
    }

    /// All entries of this name.
    pub(crate) fn all<'a>(
        &'a self,
        section: &'a str,
        key: &'a str,
    ) -> impl Iterator<Item = &'a IniEntry> {
        self.entries
            .iter()
            .filter(move |entry| entry.section == section && entry.key == key)
    }

    pub(crate) fn entry(&self, section: &str, key: &str) -> Option<&IniEntry> {
        self.entries
            .iter()
            .find(|entry| entry.section == section && entry.key == key)
    }

    /// The first value of this name that is not empty.
    pub(crate) fn value(&self, section: &str, key: &str) -> Option<&str> {
        self.entry(section, key)
            .map(|entry| entry.value.as_str())
            .filter(|value| !value.is_empty())
    }

    /// The number at the beginning of a value.
    pub(crate) fn number(&self, section: &str, key: &str) -> Option<f64> {
        number(self.value(section, key)?)
    }
}

/// The number at the beginning of a text.
pub(crate) fn number(text: &str) -> Option<f64> {
    text.split_whitespace()
        .next()?
        .parse::<f64>()
        .ok()
        .filter(|value| value.is_finite())
}

/// The text of a file. Signs that are no UTF-8 stand in comments and names of old files: they are
/// replaced.
pub(crate) fn read_text(path: &Path, named: Option<String>) -> Result<String, LinuxcncSetupError> {
    let bytes = std::fs::read(path)
        .map_err(|source| LinuxcncSetupError::unreadable(path, named, source))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// A path with `~` for the home folder.
pub(crate) fn expanded(name: &str) -> PathBuf {
    match (name.strip_prefix("~/"), std::env::var_os("HOME")) {
        (Some(rest), Some(home)) => Path::new(&home).join(rest),
        _ => PathBuf::from(name),
    }
}

/// The name of a file in messages, without its folder.
pub(crate) fn shown(path: &Path) -> String {
    path.file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy()
        .into_owned()
}

fn is_comment(line: &str) -> bool {
    line.starts_with('#') || line.starts_with(';')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_includes_and_continued_lines_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name);
        std::fs::write(file("joints.inc"), "[JOINT_0]\nP = 50 \n# P = 1\n").unwrap();
        let text = "[HAL]\nHALFILE = a.hal\n;x = 1\nHALFILE=b.hal\n#INCLUDE joints.inc\n[TRAJ]\nCOORDINATES = X \\\n  Y Z\r\n";
        std::fs::write(file("my.ini"), text).unwrap();
        let ini = IniFile::read(&file("my.ini")).unwrap();
        assert_eq!(
            ini.all("HAL", "HALFILE")
                .map(|entry| entry.value.as_str())
                .collect::<Vec<_>>(),
            ["a.hal", "b.hal"]
        );
        assert_eq!(ini.number("JOINT_0", "P"), Some(50.0));
        assert_eq!(ini.entry("JOINT_0", "P").unwrap().place, "joints.inc:2");
        assert_eq!(ini.value("TRAJ", "COORDINATES"), Some("X Y Z"));
        assert_eq!(ini.value("HAL", "x"), None);
    }

    #[test]
    fn includes_in_a_circle_are_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("my.ini");
        std::fs::write(&file, "[HAL]\n#INCLUDE my.ini\n").unwrap();
        assert!(
            IniFile::read(&file)
                .unwrap_err()
                .to_string()
                .contains("include one another")
        );
    }
}
