//! Report: the results of a run, as numbers ([`RunSummary`]), as one HTML page ([`write_html`]) and
//! as figures ([`figure`]).
//!
//! A run hands its rows to two sinks of bounded memory: [`Statistics`] sees every row and keeps
//! exact sums, [`Series`] keeps a thinned record to draw. The page is one file without references
//! to anything outside it, and equal reports give equal bytes.
//!
//! Only rows that cut count for the contour error; rapids and dwells are recorded and drawn, but
//! not judged.

pub(crate) mod text;
mod page_units;
mod page_frame;
pub(crate) mod plain_page;
pub(crate) mod figure;
mod outline;
mod series;
mod embedded_data;
mod limit_band;
pub(crate) mod harm;
pub(crate) mod headline;
mod html;
mod worst;
mod histogram;
mod error_spectrum;
mod circles;
mod summary;
mod statistics;
mod assumptions;
mod band;
mod compensated;

pub use assumptions::Assumptions;
pub(crate) use assumptions::ModelKnowledge;
pub(crate) use band::{Band, BandErrors};
pub use circles::{FullCircle, Roundness};
pub(crate) use circles::{RadialDeviations, full_circles};
pub(crate) use compensated::CompensatedGeometry;
pub use error_spectrum::ErrorSpectrum;
pub(crate) use error_spectrum::SpectrumBand;
pub(crate) use histogram::Histogram;
pub use html::{write_html, write_html_data, write_html_in};
pub use limit_band::LimitBand;
pub use page_units::PageUnits;
pub use series::Series;
pub use statistics::Statistics;
pub(crate) use summary::{AS_EXPORTED, CommandShare, CommandShares, DriveLimits};
pub use summary::{Role, RunFacts, RunSummary};
pub(crate) use worst::WorstPlace;

#[cfg(feature = "command")]
pub(crate) use feedwright_sim::CorrectionChange;
pub(crate) use feedwright_sim::{FadedOut, Outcome, Transition};

/// Everything that the page shows.
#[derive(Debug, Clone)]
pub struct Report {
    /// Heading of the page.
    pub title: String,
    /// Name of the part, as the program calls it.
    pub part: String,
    /// Description of the machine: name and value, in the order in which they are shown.
    pub machine: Vec<(String, String)>,
    /// Settings of the run: name and value, in the order in which they are shown.
    pub settings: Vec<(String, String)>,
    /// Assumptions behind the figures.
    pub assumed: Assumptions,
    /// The geometry that is compensated; none if no geometry is compensated.
    pub geometry: Option<CompensatedGeometry>,
    /// Lines of the program, in order; only some of a long program.
    pub program: Vec<ProgramLine>,
    /// The full circles of the program.
    pub circles: Vec<FullCircle>,
    /// Largest contour error that the part allows, µm, if one was given.
    pub tolerance_um: Option<f64>,
    /// Limits that bind along the path, if the path is planned axis by axis.
    pub limits: Option<LimitBand>,
    /// Limits of each axis of the machine, drawn beside the loads of the runs.
    pub axis_limits: Vec<DrawnLimits>,
    /// Errors of other machines that fit the recording, if these were cut.
    pub band: Option<Band>,
    /// The runs, in the order in which they are shown.
    pub runs: Vec<ReportedRun>,
}

/// Limits of an axis.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DrawnLimits {
    /// Torque at which the drive saturates, N m.
    pub torque_nm: f64,
    /// Acceleration limit of the plan, mm/s2; none if the plan has no axis limits.
    pub accel_mm_s2: Option<f64>,
}

/// One controller's run.
#[derive(Debug, Clone)]
pub struct ReportedRun {
    /// Its numbers.
    pub summary: RunSummary,
    /// Its record.
    pub series: Series,
    /// Spectrum of its contour error; empty if too little was cut.
    pub spectrum: Vec<SpectrumBand>,
    /// Roundness of each of the circles in this run; none where it cannot be measured.
    pub roundness: Vec<Option<Roundness>>,
    /// Events of the program in the time of this run; may be empty.
    pub events: Vec<TimelineEvent>,
}

impl ReportedRun {
    /// Returns the roundness of a circle of the program in this run.
    fn roundness_of(&self, circle: usize) -> Option<&Roundness> {
        self.roundness.get(circle)?.as_ref()
    }
}

/// A line of the program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProgramLine {
    /// Its number, from 1.
    pub line: u32,
    /// Its text.
    pub text: String,
}

/// Tool change, dwell or other event of the program, at the time at which the run reached it.
#[derive(Debug, Clone, PartialEq)]
pub struct TimelineEvent {
    /// Start of the event, s.
    pub t_s: f64,
    /// Duration of the event, s; 0 for an event without duration.
    pub duration_s: f64,
    /// Line of the program, from 1.
    pub line: u32,
    /// Row of the timeline for the event, as in "spindle" or "lamp".
    pub row: String,
    /// Name of the event, as in "tool 3" or "dwell".
    pub label: String,
}

/// A row of the tests: at rest.
#[cfg(test)]
const fn row(t_s: f64) -> feedwright_sim::Row {
    feedwright_sim::Row {
        t_s,
        ..feedwright_sim::Row::AT_REST
    }
}
