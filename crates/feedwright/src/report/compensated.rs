//! Description of the compensated geometry in a report.

use serde::Serialize;

use super::text::number;

/// The geometry that the control compensates.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CompensatedGeometry {
    /// The geometry file; none if the machine file states the values.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) from: Option<String>,
    /// Names of the compensated errors.
    pub(crate) terms: Vec<&'static str>,
    /// Standard deviation of the tool across the path that follows from the standard deviations of
    /// the file: root mean square over the cut, um.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) spread_rms_um: Option<f64>,
    /// Largest value of that standard deviation over the cut, um.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) spread_max_um: Option<f64>,
}

impl CompensatedGeometry {
    /// Describes the geometry in one sentence, without its full stop.
    pub(crate) fn sentence(&self) -> String {
        let from = self.from.as_ref().map_or_else(
            || {
                "exactly as the machine file states it; of a real machine it has to be measured"
                    .to_owned()
            },
            |name| format!("as {name} states it"),
        );
        let known = match (self.spread_rms_um, self.spread_max_um) {
            (Some(rms_um), Some(max_um)) => format!(
                "; its standard deviations leave the tool {} um RMS and {} um at most on this part",
                number(rms_um),
                number(max_um)
            ),
            _ if self.from.is_some() => "; it states no standard deviations".to_owned(),
            _ => String::new(),
        };
        format!(
            "compensated geometry: {}, {from}{known}",
            self.terms.join(", ")
        )
    }
}
