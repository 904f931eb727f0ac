//! The files of a program, the place in them, and the calls and loops under way.

use std::collections::HashMap;
use std::io;
use std::ops::Range;
use std::path::PathBuf;

use crate::flow::owords::Keyword;
use crate::settings::Settings;
use crate::state::parameters::MACRO_LOCALS;
use crate::text::diagnostic::{LineFault, Read};
use crate::text::source::{Mark, Source};

/// Syntax in which a subroutine is written and called.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum SubroutineKind {
    /// `O1 sub` ... `O1 endsub`, called by `O1 call`.
    Rs274,
    /// `O1` ... `M99`, called by `M98 P1`.
    Fanuc,
    /// The same, called by `G65 P1` with variables of its own.
    Macro,
}

/// A file with the places of its subroutines, once somebody has asked for one.
#[derive(Debug)]
pub(super) struct ProgramFile {
    pub(super) source: Source,
    pub(super) path: Option<PathBuf>,
    pub(super) subroutines: Option<HashMap<Vec<u8>, (SubroutineKind, Mark)>>,
}

/// A call under way.
#[derive(Debug)]
pub(super) struct Call {
    pub(super) kind: SubroutineKind,
    pub(super) label: Vec<u8>,
    /// File and line to return to.
    pub(super) file: usize,
    pub(super) back: Mark,
    /// First line of the subroutine and the calls that remain (L of M98).
    pub(super) body: Mark,
    pub(super) repeats: u32,
    /// `#1`-`#33` of the caller.
    pub(super) saved: [f64; MACRO_LOCALS],
    /// Arguments of G65, anew for each of its repeats.
    pub(super) arguments: Option<Box<[f64; MACRO_LOCALS]>>,
    /// Loops of the caller.
    pub(super) loops: usize,
}

/// A loop under way.
#[derive(Debug)]
pub(super) struct Loop {
    pub(super) label: Vec<u8>,
    pub(super) kind: Keyword,
    /// The line of its O-word.
    pub(super) begin: Mark,
    /// The line behind it.
    pub(super) body: Mark,
    pub(super) repeats: u64,
}

/// Lines that are passed over.
#[derive(Debug)]
pub(super) struct Skip {
    pub(super) label: Vec<u8>,
    pub(super) purpose: Purpose,
    /// The line that began it, for the message when its end is missing.
    pub(super) line: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// A false `if`: up to a true `elseif`, `else`, `endif`.
    Branch,
    /// Branches that follow the one taken: up to `endif`.
    EndOfBranches,
    Definition,
    /// A loop that ends or is not entered: up to its end.
    EndOfLoop,
    /// `continue`: to the end of the loop, which is then carried out.
    NextRound,
}

/// Blocks that were found, by file, offset of the line they were asked for from, and number.
#[derive(Debug, Default)]
pub(super) struct Places(pub(super) HashMap<(usize, u64, u64), Found>);

/// The first block of a number before and behind a line.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Found {
    pub(super) before: Option<Mark>,
    pub(super) behind: Option<Mark>,
}

/// The files of a program, the place in them, and the calls and loops under way.
#[derive(Debug)]
pub(super) struct Flow {
    pub(super) files: Vec<ProgramFile>,
    pub(super) current: usize,
    pub(super) folders: Vec<PathBuf>,
    pub(super) frames: Vec<Call>,
    pub(super) loops: Vec<Loop>,
    pub(super) skip: Option<Skip>,
    /// The line of the last `break`, obeyed or passed over: LinuxCNC 2.9 ends the next do at its
    /// `while`, whatever its condition says.
    pub(super) broke: Option<u32>,
    /// Warning about the current line.
    pub(super) warning: Option<Box<LineFault>>,
    pub(super) max_depth: usize,
    /// Lines of the branches and loops met so far, by file, subroutine and label; and room for such
    /// a key.
    pub(super) labels: HashMap<Vec<u8>, u32>,
    pub(super) key: Vec<u8>,
    /// Blocks that were looked for by their numbers.
    pub(super) places: Places,
}

impl Flow {
    pub(super) fn new(source: Source, folder: Option<PathBuf>, settings: &Settings) -> Self {
        let folders = folder
            .into_iter()
            .chain(settings.subroutine_paths.iter().cloned())
            .collect();
        let file = ProgramFile {
            source,
            path: None,
            subroutines: None,
        };
        Self {
            files: vec![file],
            current: 0,
            folders,
            frames: Vec::new(),
            loops: Vec::new(),
            skip: None,
            broke: None,
            warning: None,
            max_depth: settings.max_depth,
            labels: HashMap::new(),
            key: Vec::new(),
            places: Places::default(),
        }
    }

    /// The file under way.
    #[inline]
    pub(super) fn source(&mut self) -> &mut Source {
        &mut self.files[self.current].source
    }

    /// The file under way.
    pub(super) fn source_ref(&self) -> &Source {
        &self.files[self.current].source
    }

    /// Returns true if lines are being skipped.
    #[inline]
    pub(super) const fn is_skipping(&self) -> bool {
        self.skip.is_some()
    }

    /// Goes on at a line.
    pub(super) fn jump_to(&mut self, mark: Mark, at: &Range<usize>) -> Read<()> {
        self.source()
            .jump(mark)
            .map_err(|error| cannot_read(at.clone(), &error))
    }
}

#[cold]
pub(super) fn cannot_read(at: Range<usize>, error: &io::Error) -> Box<LineFault> {
    LineFault::new(
        "gcode::read",
        at,
        format!("the program cannot be read on: {error}"),
    )
}
