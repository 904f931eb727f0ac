//! Headings of the options in the help, in the order in which the commands declare them.

/// The machine and the cut.
pub(crate) const CUT: &str = "Machine and cut";
/// The controller and its model.
pub(crate) const CONTROLLER: &str = "Controller";
/// Comparison of a cut, and its recording.
pub(crate) const MEASURED: &str = "Comparison and measurement";
/// Files that are written.
pub(crate) const RESULTS: &str = "Results";
/// A machine that is simulated, where there is no log.
pub(crate) const SIMULATED: &str = "Without a LOG";
