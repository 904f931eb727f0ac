//! Names of the files that setup writes, beside the INI file and after it.

use std::path::{Path, PathBuf};

/// Names of files, without folder.
#[derive(Debug, Clone)]
pub(crate) struct SetupNames {
    folder: PathBuf,
    /// The original INI file.
    pub(crate) original: String,
    /// Name of the original without its ending.
    pub(crate) stem: String,
    /// Copy of the INI file.
    pub(crate) ini: String,
    /// Connections of the component.
    pub(crate) hal: String,
    /// Machine file.
    pub(crate) machine: String,
    /// Script that records.
    pub(crate) record: String,
    /// Block of the simulated machine.
    pub(crate) plant: String,
    /// Block of the identified machine, which setup does not write.
    pub(crate) model: String,
    /// Names and checksums of all that setup wrote.
    pub(crate) manifest: String,
}

impl SetupNames {
    pub(crate) fn of(ini: &Path) -> Self {
        let stem = ini
            .file_stem()
            .map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        let named = |ending: &str| format!("{stem}-feedwright{ending}");
        Self {
            folder: super::folder_of(ini).to_owned(),
            original: super::ini::shown(ini),
            ini: named(".ini"),
            hal: named(".hal"),
            machine: named(".toml"),
            record: named("-record.sh"),
            plant: named("-plant.fwmodel"),
            model: named(".fwmodel"),
            manifest: named(".files"),
            stem,
        }
    }

    /// Name of the copy of a HAL file.
    pub(crate) fn copy_of(&self, file: &Path) -> String {
        format!("{}-feedwright-{}", self.stem, super::ini::shown(file))
    }

    /// A file of that name beside the INI file.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        if self.folder == Path::new(".") {
            PathBuf::from(name)
        } else {
            self.folder.join(name)
        }
    }
}
