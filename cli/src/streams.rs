//! `-` in place of a file: the standard input, or the standard output.

use std::io::{self, IsTerminal, Write};
use std::path::Path;

use feedwright::gcode::input::is_standard_input;
use feedwright::output::is_standard_output;
use miette::{Result, miette};

use crate::console::Console;

/// Refuses the standard input for two things at once, and says so where a person has to type it. `inputs` are options and files.
pub(crate) fn check_inputs<'a>(
    console: &Console,
    inputs: impl IntoIterator<Item = (&'a str, Option<&'a Path>)>,
) -> Result<()> {
    let standard =
        |(name, path): (&'a str, Option<&'a Path>)| path.filter(|path| is_standard_input(path)).map(|_| name);
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

/// Makes a folder for results, where it is not there.
pub(crate) fn make_folder(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|error| {
        let help = match error.kind() {
            io::ErrorKind::AlreadyExists | io::ErrorKind::NotADirectory => {
                "a file stands in its place: name another folder"
            }
            _ => "name a folder in a place that can be written to",
        };
        miette!(help = help, "cannot make the folder {}: {error}", folder.display())
    })
}

/// Where tables and remarks go: to stdout, or to stderr where data go to stdout.
pub(crate) fn tables<'a>(outputs: impl IntoIterator<Item = Option<&'a Path>>) -> Box<dyn Write> {
    if outputs.into_iter().flatten().any(is_standard_output) {
        Box::new(io::stderr().lock())
    } else {
        Box::new(io::stdout().lock())
    }
}

/// Tells which files there are now; what went to the standard output is no file.
pub(crate) fn tell_written<'a>(
    out: &mut dyn Write,
    outputs: impl IntoIterator<Item = Option<&'a Path>>,
) -> io::Result<()> {
    let files = outputs.into_iter().flatten().filter(|path| !is_standard_output(path));
    files.into_iter().try_for_each(|path| writeln!(out, "wrote {}", path.display()))
}
