//! `-` in place of a file: the standard input, or the standard output.
use std::ffi::OsStr;
use std::io::{self, IsTerminal, Write};
use std::path::Path;

use feedwright_gcode::input::{self, is_standard_input};
use feedwright_sim::is_machine_path;
use miette::{Result, miette};

use crate::command::args::reader::ReaderArgs;
use crate::command::console::Console;
use crate::command::terminal::is_inch;
use crate::inches::in_inches;
use crate::output::{OutputFiles, is_standard_output};

/// Refuses the standard input for two things at once, and says so where a person has to type it.
/// `inputs` are options and files.
pub(crate) fn check_inputs<'a>(
    console: &Console,
    inputs: impl IntoIterator<Item = (&'a str, Option<&'a Path>)>,
) -> Result<()> {
    let standard = |(name, path): (&'a str, Option<&'a Path>)| {
        path.filter(|path| is_standard_input(path)).map(|_| name)
    };
    let names: Vec<&str> = inputs.into_iter().filter_map(standard).collect();
    if let [first, second, ..] = names[..] {
        return Err(miette!(
            help = "give one of them the name of a file",
            "the standard input is {first} and {second} at once: `-` can stand for one of them"
        ));
    }
    if let ([name], true, false) = (&names[..], io::stdin().is_terminal(), console.is_quiet()) {
        eprintln!("{name} is read from the terminal: Ctrl-D ends it");
    }
    Ok(())
}

/// The files that a command reads beside its options: program, machine and tool table.
pub(crate) struct ProgramInputs<'a> {
    part: &'a Path,
    machine: &'a Path,
    tools: Option<&'a Path>,
    geometry: Option<&'a Path>,
}

impl<'a> ProgramInputs<'a> {
    /// Collects the files that these arguments name.
    pub(crate) fn of(
        part: &'a Path,
        machine: &'a (impl AsRef<OsStr> + ?Sized),
        reader: &'a ReaderArgs,
    ) -> Self {
        Self {
            part,
            machine: Path::new(machine),
            tools: reader.tool_table.as_deref(),
            geometry: None,
        }
    }

    /// The same with a geometry file, where there is one.
    pub(crate) const fn with_geometry(self, geometry: Option<&'a Path>) -> Self {
        Self { geometry, ..self }
    }

    /// Calls [`check_inputs`] for these files.
    pub(crate) fn check(&self, console: &Console) -> Result<()> {
        let named = [
            ("the program", Some(self.part)),
            ("--machine", Some(self.machine)),
        ];
        check_inputs(
            console,
            named
                .into_iter()
                .chain([("--tool-table", self.tools), ("--geometry", self.geometry)]),
        )
    }

    /// Returns output files that must differ from these files.
    pub(crate) fn outputs(&self) -> OutputFiles {
        let machine = Some(self.machine).filter(|path| is_machine_path(path));
        OutputFiles::new(
            [Some(self.part), machine, self.tools, self.geometry]
                .into_iter()
                .flatten(),
        )
    }
}

/// Makes a folder for results, where it is not there.
pub fn make_folder(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|error| {
        let help = match error.kind() {
            io::ErrorKind::AlreadyExists | io::ErrorKind::NotADirectory => {
                "a file stands in its place: name another folder"
            }
            _ => "name a folder in a place that can be written to",
        };
        miette!(
            help = help,
            "cannot make the folder {}: {error}",
            folder.display()
        )
    })
}

/// Returns the output for tables and remarks: stdout, or stderr where data go to stdout.
pub fn tables<'a>(outputs: impl IntoIterator<Item = Option<&'a Path>>) -> Box<dyn Write> {
    let out: Box<dyn Write> = if outputs.into_iter().flatten().any(is_standard_output) {
        Box::new(io::stderr().lock())
    } else {
        Box::new(io::stdout().lock())
    };
    if is_inch() {
        Box::new(InchLines {
            out,
            line: Vec::new(),
        })
    } else {
        out
    }
}

/// Writes lines with their lengths in inches.
struct InchLines {
    out: Box<dyn Write>,
    line: Vec<u8>,
}

impl Write for InchLines {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        for byte in bytes {
            self.line.push(*byte);
            if *byte == b'\n' {
                self.flush()?;
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        let line = std::mem::take(&mut self.line);
        self.out
            .write_all(in_inches(&String::from_utf8_lossy(&line)).as_bytes())?;
        self.out.flush()
    }
}

/// Reports the files that were written. The standard output is not listed, because it is not a
/// file.
pub fn tell_written<'a>(
    out: &mut dyn Write,
    outputs: impl IntoIterator<Item = Option<&'a Path>>,
) -> io::Result<()> {
    let files = outputs
        .into_iter()
        .flatten()
        .filter(|path| !is_standard_output(path));
    files
        .into_iter()
        .try_for_each(|path| writeln!(out, "wrote {}", input::name(path)))
}
