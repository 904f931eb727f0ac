//! Options of `feedwright block`.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::Args;

use crate::command::args::geometry::GeometryArgs;

/// Write a model as bytes, for a component in a servo thread
///
/// Of a model file, or of a machine with exactly the numbers of its file. Scale, pitch and
/// squareness of the machine go with it, and the component compensates them.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  feedwright block mine.toml --out mine.fwmodel
  feedwright block mine.toml --geometry geometry.toml --out mine.fwmodel
  feedwright block mine.model.toml --machine mine.toml --out mine.fwmodel")]
pub(crate) struct BlockArgs {
    /// Model file (.model.toml), built-in machine, or machine file (.toml).
    #[arg(value_name = "FILE.model.toml|NAME|FILE.toml")]
    pub(crate) file: OsString,
    /// Number of axes, 2 or 3 [default: all that there are].
    #[arg(long, value_parser = axes_of_a_block)]
    pub(crate) axes: Option<usize>,
    /// Machine of a model file: its geometry goes with the model.
    #[arg(long, value_name = "NAME|FILE.toml")]
    pub(crate) machine: Option<OsString>,
    #[command(flatten)]
    pub(crate) geometry: GeometryArgs,
    /// Place of the block.
    #[arg(long, value_name = "FILE.fwmodel")]
    pub(crate) out: PathBuf,
}

/// 2 or 3.
fn axes_of_a_block(text: &str) -> Result<usize, String> {
    match text {
        "2" => Ok(2),
        "3" => Ok(3),
        _ => Err("a block is of 2 or 3 axes".to_owned()),
    }
}
