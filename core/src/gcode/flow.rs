//! Where the next line comes from.

use std::path::PathBuf;

use super::settings::Settings;
use super::source::Source;

/// The files of a program and the place in them.
#[derive(Debug)]
pub(super) struct Flow {
    sources: Vec<Source>,
    current: usize,
}

impl Flow {
    pub(super) fn new(source: Source, _folder: Option<PathBuf>, _settings: &Settings) -> Self {
        Self {
            sources: vec![source],
            current: 0,
        }
    }

    /// The file under way.
    pub(super) fn source(&mut self) -> &mut Source {
        &mut self.sources[self.current]
    }
}
