//! Options for the geometry that is compensated.

use std::path::PathBuf;

use clap::Args;

/// The geometry that the control compensates.
#[derive(Debug, Args)]
pub(crate) struct GeometryArgs {
    /// Leave the geometry uncompensated. Without this option, the command leads the axes so that scale, pitch and squareness of the machine
    /// file do not move the tool off the path.
    #[arg(long)]
    pub(crate) no_geometry: bool,
    /// Compensate the geometry of this file in place of that of the machine file; `feedwright identify --geometry` writes one.
    #[arg(long, value_name = "GEOMETRY.toml", conflicts_with = "no_geometry")]
    pub(crate) geometry: Option<PathBuf>,
}
