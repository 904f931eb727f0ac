//! Output files that are there whole or not at all.
//!
//! An [`OutputFile`] is written to a temporary file beside its target and renamed by
//! [`OutputFile::commit_all`]. Dropped before that (an error, a panic, a cancellation), it
//! leaves nothing; what a process leaves that was killed, the next one removes. What goes to the
//! standard output (`-`), to a pipe or to a device waits in a file without a name until all is
//! complete. The data is not forced to the disk: it survives the end of the process, not of the
//! power. [`OutputFile::sync`] forces it.

mod error;
mod part_files;

use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

pub(crate) use error::FileOperation;
pub use error::OutputError;
use feedwright_sim::Watch;
use part_files::PartFile;
pub(crate) use part_files::remove_abandoned;

/// Rows of a trace are 150-300 bytes: a few hundred rows for one call of the operating system.
const BUFFER_BYTES: usize = 64 << 10;

/// The output files of a run, as they are started: none takes the place of an input or of another.
#[derive(Debug, Default)]
pub struct OutputFiles {
    inputs: Vec<PathBuf>,
    targets: Vec<PathBuf>,
}

/// A file under way to its target.
pub struct OutputFile {
    /// Path as the user gave it, for messages.
    shown: PathBuf,
    /// Final path, with symbolic links resolved.
    target: PathBuf,
    out: BufWriter<Named>,
    place: OutputPlace,
}

/// Destination of a complete file.
enum OutputPlace {
    /// The target; the file is written beside it.
    Beside(PartFile),
    /// A pipe or a device.
    Device(File),
    StandardOutput,
}

/// A file whose errors name it.
struct Named {
    file: File,
    shown: PathBuf,
    folder: PathBuf,
}

impl OutputFiles {
    /// Creates an empty set; `inputs` are files of this run that no output may replace.
    pub fn new<'a>(inputs: impl IntoIterator<Item = &'a Path>) -> Self {
        Self {
            inputs: inputs.into_iter().map(Path::to_owned).collect(),
            targets: Vec::new(),
        }
    }

    /// Starts the file at `path`, if one is wanted: [`Self::start`].
    ///
    /// # Errors
    /// Fails as [`Self::start`] does.
    pub(crate) fn start_wanted(
        &mut self,
        path: Option<impl AsRef<Path>>,
    ) -> Result<Option<OutputFile>, OutputError> {
        path.map(|path| self.start(path.as_ref())).transpose()
    }

    /// Starts a file that shall stand at `path` when it is complete.
    ///
    /// # Errors
    /// A target that is a directory, that is one of the inputs or that another output of this run
    /// goes to; a directory that is missing or cannot be written to.
    pub fn start(&mut self, path: &Path) -> Result<OutputFile, OutputError> {
        let target = if is_standard_output(path) {
            path.to_owned()
        } else {
            resolve(path)?
        };
        if let Some(input) = self
            .inputs
            .iter()
            .find(|input| fs::canonicalize(input).is_ok_and(|input| input == target))
        {
            return Err(OutputError::IsInput {
                path: path.to_owned(),
                input: input.clone(),
            });
        }
        if self.targets.contains(&target) {
            return Err(OutputError::Twice {
                path: path.to_owned(),
            });
        }
        let file = OutputFile::create(path, target.clone())?;
        self.targets.push(target);
        Ok(file)
    }
}

impl OutputFile {
    fn create(path: &Path, target: PathBuf) -> Result<Self, OutputError> {
        let folder = target.parent().unwrap_or(Path::new("/")).to_owned();
        let failed = |error| OutputError::io(FileOperation::Create, path, &folder, error);
        let (file, place) = if is_standard_output(path) {
            (
                tempfile::tempfile().map_err(failed)?,
                OutputPlace::StandardOutput,
            )
        } else if fs::metadata(&target).is_ok_and(|found| !found.is_file()) {
            let device = File::options().write(true).open(&target).map_err(failed)?;
            (
                tempfile::tempfile().map_err(failed)?,
                OutputPlace::Device(device),
            )
        } else {
            let (file, beside) = PartFile::create(&target, &folder).map_err(failed)?;
            (file, OutputPlace::Beside(beside))
        };
        let named = Named {
            file,
            shown: path.to_owned(),
            folder,
        };
        Ok(Self {
            shown: path.to_owned(),
            target,
            out: BufWriter::with_capacity(BUFFER_BYTES, named),
            place,
        })
    }

    /// Writes a file, if it is wanted.
    ///
    /// # Errors
    /// Fails if `write` does; the error names the file.
    pub fn filled(
        file: Option<Self>,
        write: impl FnOnce(&mut Self) -> io::Result<()>,
    ) -> Result<Option<Self>, OutputError> {
        let Some(mut file) = file else {
            return Ok(None);
        };
        write(&mut file).map_err(|error| OutputError::from_io(error, &file.shown))?;
        Ok(Some(file))
    }

    /// Returns the final path of the file, as it was given.
    pub(crate) fn path(&self) -> &Path {
        &self.shown
    }

    /// Forces the data to the disk: after a power failure, too, the file is there whole or not at
    /// all.
    ///
    /// # Errors
    /// Fails if the operating system refuses it, for example because the disk is full.
    pub fn sync(&mut self) -> Result<(), OutputError> {
        self.write_rest()?;
        let Named {
            file,
            shown,
            folder,
        } = self.out.get_mut();
        file.sync_data()
            .map_err(|error| OutputError::io(FileOperation::Write, shown, folder, error))
    }

    /// All files of a run are complete: they take their places. The last bytes of all are written
    /// before the first moves, so that a disk that is full at the very end leaves no part of the
    /// results either; then nothing ends it any more.
    ///
    /// # Errors
    /// Where the last bytes or the renaming fail, for the first file that does, or an end from
    /// outside.
    pub fn commit_all(mut files: Vec<Self>, watch: &dyn Watch) -> Result<(), OutputError> {
        for file in &mut files {
            file.write_rest()?;
        }
        let _decided = part_files::held();
        watch.check()?;
        // What can still be refused goes first.
        let (beside, elsewhere): (Vec<_>, Vec<_>) = files
            .into_iter()
            .partition(|file| matches!(file.place, OutputPlace::Beside(_)));
        elsewhere
            .into_iter()
            .chain(beside)
            .try_for_each(Self::commit)
    }

    /// Writes what is still in memory.
    fn write_rest(&mut self) -> Result<(), OutputError> {
        self.out
            .flush()
            .map_err(|error| OutputError::from_io(error, &self.shown))
    }

    fn commit(mut self) -> Result<(), OutputError> {
        self.write_rest()?;
        let Named {
            file,
            shown,
            folder,
        } = self.out.get_mut();
        let failed = |step, error| OutputError::io(step, shown, folder, error);
        match self.place {
            OutputPlace::Beside(beside) => beside
                .persist(&self.target)
                .map_err(|error| failed(FileOperation::Rename, error)),
            OutputPlace::Device(mut device) => {
                hand_over(file, &mut device).map_err(|error| failed(FileOperation::Write, error))
            }
            OutputPlace::StandardOutput => match hand_over(file, &mut io::stdout().lock()) {
                // A reader that went away (`| head`) has seen enough.
                Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
                    Err(failed(FileOperation::Write, error))
                }
                _ => Ok(()),
            },
        }
    }
}

/// Ends the process with an exit code, without the files under way. Waits for files that take their
/// places already.
pub(crate) fn exit_without_files(code: u8) -> ! {
    for path in part_files::held().iter() {
        // One that took its place is no longer there.
        let _ = fs::remove_file(path);
    }
    std::process::exit(code.into())
}

/// Returns true if a target is the standard output; `./-` is a file of that name.
pub(crate) fn is_standard_output(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Copies what has been kept.
fn hand_over(kept: &mut File, to: &mut impl Write) -> io::Result<()> {
    kept.seek(SeekFrom::Start(0))?;
    io::copy(kept, to)?;
    to.flush()
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

impl Write for Named {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes).map_err(|error| {
            if error.kind() == io::ErrorKind::Interrupted {
                return error;
            }
            let kind = error.kind();
            io::Error::new(
                kind,
                OutputError::io(FileOperation::Write, &self.shown, &self.folder, error),
            )
        })
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Most symbolic links that lead to a target, as Linux has it.
const MOST_LINKS: usize = 40;

/// The real place of `path`, which need not exist yet. Symbolic links are followed, to files that
/// do not exist too.
fn resolve(path: &Path) -> Result<PathBuf, OutputError> {
    let mut place = path.to_owned();
    for _ in 0..MOST_LINKS {
        match (fs::canonicalize(&place), fs::read_link(&place)) {
            (Err(_), Ok(link)) => place = place.parent().unwrap_or(Path::new("")).join(link),
            _ => return resolve_once(path, &place),
        }
    }
    let hint = Some("name another file, or mend the links: they lead in a circle".to_owned());
    let source = io::Error::other("too many symbolic links");
    Err(OutputError::Io {
        step: FileOperation::Create,
        path: path.to_owned(),
        free_bytes: None,
        source,
        hint,
    })
}

/// The same of a path that is no link to a missing file; messages have `shown`.
fn resolve_once(shown: &Path, path: &Path) -> Result<PathBuf, OutputError> {
    if fs::metadata(path).is_ok_and(|found| found.is_dir()) {
        return Err(OutputError::IsDirectory {
            path: shown.to_owned(),
        });
    }
    if let Ok(target) = fs::canonicalize(path) {
        return Ok(target);
    }
    // A path such as "out/" or ".." names no file.
    let Some(name) = path
        .file_name()
        .filter(|_| !path.as_os_str().as_encoded_bytes().ends_with(b"/"))
    else {
        return Err(OutputError::IsDirectory {
            path: shown.to_owned(),
        });
    };
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    match fs::canonicalize(folder) {
        Ok(folder) => Ok(folder.join(name)),
        Err(error) => Err(OutputError::io(FileOperation::Create, shown, folder, error)),
    }
}

#[cfg(test)]
mod tests;
