//! Options for the geometry that is compensated.

use std::path::PathBuf;

use clap::Args;
use miette::Result;

use super::headings::CUT;
use crate::compensation::GeometryChoice;
use crate::request::JobRequest;

/// The geometry that the control compensates.
#[derive(Debug, Args)]
pub(crate) struct GeometryArgs {
    /// Leave the geometry uncompensated. Without this option, the command leads the axes so that
    /// scale, pitch and squareness of the machine file do not move the tool off the path.
    #[arg(long, help_heading = CUT, hide_short_help = true)]
    pub(crate) no_geometry: bool,
    /// Compensate the geometry in this file instead of the geometry in the machine file, and give
    /// it to the simulated machine; `feedwright identify --geometry` writes one.
    #[arg(long, value_name = "GEOMETRY.toml", conflicts_with = "no_geometry", help_heading = CUT)]
    pub(crate) geometry: Option<PathBuf>,
}

impl GeometryArgs {
    /// Returns the geometry that is compensated.
    pub(crate) fn choice(&self) -> Result<GeometryChoice> {
        let request = JobRequest {
            no_geometry: self.no_geometry,
            geometry: self.geometry.clone(),
            ..JobRequest::default()
        };
        request.compensation()
    }
}
