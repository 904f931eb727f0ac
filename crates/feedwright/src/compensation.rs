//! Which geometry of a machine its control compensates, and how well it is known.

use std::io;

use feedwright_sim::{GeometryFile, Machine, Row, Sink};
use serde::{Serialize, Serializer};

use crate::job_error::JobError;
use crate::report::CompensatedGeometry;

/// Choice of the errors to compensate that no encoder sees.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum GeometryChoice {
    /// Nothing is compensated.
    Off,
    /// Scale, pitch, squareness and lost motion as the machine file states them. Where an axis has
    /// backlash that its encoder does not see, lost motion alone: on `router` it leaves 0.61, 0.59,
    /// 0.73 and 0.89 of the error of star, circle, slot and pocket, and all together 0.53, 0.58,
    /// 0.69 and 1.35.
    #[default]
    Machine,
    /// The values in a geometry file, whatever the machine file says: the simulated machine has
    /// them.
    File(Box<NamedGeometry>),
    /// The simulated machine has what a geometry file states, and its control compensates nothing:
    /// the program does.
    InProgram(Box<NamedGeometry>),
}

/// A geometry file and its name.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NamedGeometry {
    /// Name in messages.
    pub(crate) name: String,
    /// Content of the file.
    #[serde(serialize_with = "as_text")]
    pub(crate) geometry: GeometryFile,
}

fn as_text<S: Serializer>(geometry: &GeometryFile, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&geometry.text())
}

impl GeometryChoice {
    /// The same for a program that compensates it itself. What the machine file states is off then.
    #[must_use]
    pub(crate) fn in_program(self) -> Self {
        match self {
            Self::File(file) | Self::InProgram(file) => Self::InProgram(file),
            Self::Off | Self::Machine => Self::Off,
        }
    }

    /// The machine with a control that compensates it, for a part with these least and greatest
    /// positions, mm. With a geometry file, it is where the tool of the machine is, too.
    ///
    /// # Errors
    /// Fails as `Self::on_any_part` does; also if the geometry was not measured where the part is.
    pub(crate) fn on(&self, machine: &Machine, box_mm: [[f64; 3]; 2]) -> Result<Machine, JobError> {
        let compensating = self.on_any_part(machine)?;
        if let Self::File(file) | Self::InProgram(file) = self {
            file.geometry.covers(machine.axis_count(), box_mm)?;
        }
        Ok(compensating)
    }

    /// The machine with a control that compensates it, wherever it cuts.
    ///
    /// # Errors
    /// A geometry that is out of its range, does not suit the machine, or does not pass its own
    /// check.
    pub(crate) fn on_any_part(&self, machine: &Machine) -> Result<Machine, JobError> {
        Ok(match self {
            Self::Off => Machine {
                compensated: None,
                ..machine.clone()
            },
            Self::Machine => machine.compensating_own()?,
            Self::File(file) | Self::InProgram(file) => {
                file.geometry.check()?;
                file.geometry.suits(machine)?;
                let known = file.geometry.known()?;
                let compensating = machine.compensating(known.clone())?.with_tool(known);
                if matches!(self, Self::File(_)) {
                    compensating
                } else {
                    Machine {
                        compensated: None,
                        ..compensating
                    }
                }
            }
        })
    }

    /// Returns the compensated geometry for the report; `None` if nothing is compensated.
    pub(crate) fn reported(
        &self,
        machine: &Machine,
        spread: &SpreadMeter<'_>,
    ) -> Option<CompensatedGeometry> {
        let compensated = machine.compensated.as_ref()?;
        let from = match self {
            Self::Off | Self::InProgram(_) => return None,
            Self::Machine => None,
            Self::File(file) => Some(file.name.clone()),
        };
        let mut terms = self.terms(Some(machine));
        terms.extend(
            compensated
                .backlash_mm()
                .iter()
                .any(|mm| *mm != 0.0)
                .then_some("backlash"),
        );
        let [spread_rms_um, spread_max_um] = spread
            .finish()
            .map_or([None; 2], |spread_um| spread_um.map(Some));
        Some(CompensatedGeometry {
            from,
            terms,
            spread_rms_um,
            spread_max_um,
        })
    }

    /// Names of the errors of position that it states, of a machine or of none.
    pub(crate) fn terms(&self, machine: Option<&Machine>) -> Vec<&'static str> {
        let there = |terms: &[(&'static str, bool)]| -> Vec<&'static str> {
            terms
                .iter()
                .filter(|(_, there)| *there)
                .map(|(term, _)| *term)
                .collect()
        };
        match (self, machine) {
            (Self::Off | Self::InProgram(_), _) | (Self::Machine, None) => Vec::new(),
            (Self::Machine, Some(machine)) if machine.has_hidden_backlash() => Vec::new(),
            (Self::Machine, Some(machine)) => {
                let square = machine.geometry != feedwright_sim::Squareness::default();
                let scale = machine.axes.iter().any(|axis| axis.scale_um_m != 0.0);
                let pitch = machine.axes.iter().any(|axis| axis.pitch_error_um != 0.0);
                there(&[("scale", scale), ("pitch", pitch), ("squareness", square)])
            }
            (Self::File(file), _) => {
                let axes = &file.geometry.axes;
                there(&[
                    ("scale", axes.iter().any(|axis| axis.scale_um_m != 0.0)),
                    ("pitch", axes.iter().any(|axis| axis.pitch_error_um != 0.0)),
                    ("positions", axes.iter().any(|axis| !axis.table.is_empty())),
                    (
                        "straightness",
                        axes.iter()
                            .flat_map(|axis| &axis.straightness)
                            .any(|table| !table.is_empty()),
                    ),
                    (
                        "squareness",
                        file.geometry.squareness != feedwright_sim::MeasuredSquareness::default(),
                    ),
                ])
            }
        }
    }

    /// Takes the rows of a cut.
    pub(crate) fn spread_meter(&self) -> SpreadMeter<'_> {
        let geometry = match self {
            Self::File(file) if file.geometry.states_spread() => Some(&file.geometry),
            _ => None,
        };
        SpreadMeter {
            geometry,
            square_sum_um2: 0.0,
            max_um: 0.0,
            rows: 0,
        }
    }
}

/// Standard deviation of the tool along a cut, by those of a geometry file.
pub(crate) struct SpreadMeter<'a> {
    geometry: Option<&'a GeometryFile>,
    square_sum_um2: f64,
    max_um: f64,
    rows: u64,
}

impl SpreadMeter<'_> {
    /// Its root mean square and its largest value, um; none where no standard deviations are stated
    /// or nothing cuts.
    fn finish(&self) -> Option<[f64; 2]> {
        (self.rows > 0).then(|| [(self.square_sum_um2 / self.rows as f64).sqrt(), self.max_um])
    }
}

impl Sink for SpreadMeter<'_> {
    fn row(&mut self, row: &Row) -> io::Result<()> {
        if let (Some(geometry), true) = (self.geometry, row.cutting) {
            let um = geometry.spread_um(row.foot_mm, row.tangent);
            self.square_sum_um2 += um * um;
            self.max_um = self.max_um.max(um);
            self.rows += 1;
        }
        Ok(())
    }
}
