//! Geometry of a machine from measurements: ball bar, laser or scale, compensation file, test part,
//! grid encoder.
//!
//! All of them are deviations that are linear in the errors of the geometry
//! ([`feedwright_sim::Observation`]). One weighted least squares fit takes all files together.
//!
//! | File | What |
//! |---|---|
//! | `geometry/text.rs` | keys, columns and rows of a text |
//! | `geometry/unknowns.rs` | the unknowns that a measurement can determine |
//! | `geometry/readings.rs` | readings before and behind the fit: bins, repeatability, tables |
//! | `geometry/circularity.rs` | circular deviations of a ball bar |
//! | `geometry/fit.rs` | the fit |
//! | `geometry/comp_file.rs` | compensation files of LinuxCNC, read and written |
//! | `geometry/formats.rs` | recognizes a file, and reads its rows |
//! | `geometry/found.rs` | what was found, as text and as JSON |
//! | `geometry/programs.rs` | programs to measure with |
//! | `geometry/simulated.rs` | a ball bar on a simulated machine |

pub(crate) mod text;
mod unknowns;
pub(crate) mod readings;
pub(crate) mod circularity;
pub(crate) mod fit;
pub(crate) mod comp_file;
pub(crate) mod formats;
pub(crate) mod found;
pub(crate) mod programs;
pub(crate) mod simulated;
