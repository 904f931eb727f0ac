//! `-` in place of a file: the standard input, or the standard output.
use std::io::{self, IsTerminal, Write};
use std::path::Path;

use feedwright_gcode::input::{self, is_standard_input};
use feedwright_sim::is_machine_path;
use miette::{Result, miette};

use crate::command::console::Console;
use crate::command::terminal::is_inch;
use crate::inches::in_inches;
use crate::output::{OutputFiles, is_standard_output};
use crate::request::JobRequest;

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

/// Calls [`check_inputs`] for the files of a request.
pub(crate) fn check_request(console: &Console, request: &JobRequest) -> Result<()> {
    let files = [
        ("the program", &request.program),
        ("--machine", &request.machine),
    ];
    let files = files.into_iter().chain(request.files());
    check_inputs(console, files.map(|(name, file)| (name, Some(&**file))))
}

/// Returns output files that must differ from the files of a request.
pub(crate) fn outputs_of(request: &JobRequest) -> OutputFiles {
    let machine = Some(&request.machine).filter(|path| is_machine_path(path));
    let files = std::iter::once(&request.program).chain(machine);
    let others = request.files().map(|(_, file)| file);
    OutputFiles::new(files.chain(others).map(|file| &**file))
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
pub fn report_written<'a>(
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
