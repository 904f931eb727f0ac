//! Tests a geometry against the measurement in its own file.
//!
//! Q(g) is the sum of the squares of (deviation - prediction by g) / noise over all rows, after the
//! nuisances of each set are fitted. The file states the residual of the fit, Q_min. With p values
//! of the geometry and m = rows - unknowns:
//!
//! ```text
//! fits     ((Q(g) - Q_min) / p) / (Q_min / m)   exceeds F(p, m) with probability 1e-3 only: else the values are not those found
//! reduces  ((Q(0) - Q(g)) / p) / (Q_min / m)    exceeds it: else the geometry explains no error
//! ```
//!
//! The first test catches wrong signs, exchanged axes, and another lead, as long as the value is
//! above the noise. Source: Draper and Smith (1998), Applied regression analysis, chapter 6 (extra
//! sum of squares).

use miette::Diagnostic;
use thiserror::Error;

use super::GeometryFile;
use super::least_squares::{RankedLeastSquares, f_exceeded};
use crate::number::to_four_digits;

/// Rate of false alarms of each test, for independent normal errors. At 1e-3 a correct file is
/// refused once in a thousand, and a sign is caught where the value is at least about four standard
/// deviations.
pub const CHECK_ERROR_RATE: f64 = 1e-3;

/// Result of the test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GeometryCheck {
    /// Root mean square of the measured deviations, um, without nuisances.
    pub before_um: f64,
    /// The same with the geometry taken off.
    pub after_um: f64,
    /// Deviations.
    pub rows: usize,
}

/// Why a geometry is refused.
#[derive(Debug, Clone, PartialEq, Error, Diagnostic)]
pub enum GeometryRefused {
    /// The values are not those of the measurement in the file.
    #[error(
        "the geometry does not fit the measurement in its own file: it leaves {} um RMS of {} um, where the fit left {} um (F = {}, \
         probability {probability:.0e})",
        to_four_digits(*after_um), to_four_digits(*before_um), to_four_digits(*left_um), to_four_digits(*quotient)
    )]
    #[diagnostic(code(geometry::fit))]
    DoesNotFit {
        /// Deviation that remains with the geometry, um.
        after_um: f64,
        /// Deviation without the geometry, um.
        before_um: f64,
        /// Deviation that the fit left, um.
        left_um: f64,
        /// Quotient of the test.
        quotient: f64,
        /// Its probability by chance.
        probability: f64,
        /// Remedy.
        #[help]
        hint: String,
    },
    /// The error is not smaller with it.
    #[error(
        "the geometry does not reduce the error in its own measurement: {} um RMS with it, {} um without (F = {}, probability \
         {probability:.0e}; at most {CHECK_ERROR_RATE} is allowed)",
        to_four_digits(*after_um), to_four_digits(*before_um), to_four_digits(*quotient)
    )]
    #[diagnostic(
        code(geometry::reduces),
        help(
            "the measurement shows no error above its noise: use no geometry file, or measure with less noise"
        )
    )]
    DoesNotReduce {
        /// Deviation that remains with the geometry, um.
        after_um: f64,
        /// Deviation without the geometry, um.
        before_um: f64,
        /// Quotient of the test.
        quotient: f64,
        /// Its probability by chance.
        probability: f64,
    },
    /// The measurement has no more rows than unknowns.
    #[error(
        "the measurement has {rows} values for {unknowns} unknowns: there is nothing to test the geometry by"
    )]
    #[diagnostic(
        code(geometry::rows),
        help("measure more positions, or each position several times")
    )]
    TooFew {
        /// Deviations.
        rows: usize,
        /// Unknowns.
        unknowns: u64,
    },
}

/// Sum of squares in units of the noise and in um2, and the number of rows.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Misfit {
    weighted: f64,
    um2: f64,
    rows: usize,
}

impl GeometryFile {
    /// Tests the geometry against its own measurement; `Ok(None)` where the file has none.
    ///
    /// # Errors
    /// The geometry does not fit the measurement, or does not reduce its error.
    pub fn check(&self) -> Result<Option<GeometryCheck>, GeometryRefused> {
        if self.measured.is_empty() {
            return Ok(None);
        }
        let (with, without) = (self.misfit(self), self.misfit(&Self::default()));
        let free = with.rows as f64 - self.unknowns as f64;
        if free < 1.0 {
            return Err(GeometryRefused::TooFew {
                rows: with.rows,
                unknowns: self.unknowns,
            });
        }
        let [after_um, before_um] =
            [with, without].map(|misfit| (misfit.um2 / misfit.rows as f64).sqrt());
        if let Some(quotient) = self.misfit_quotient(&with) {
            let left: f64 = self
                .measured
                .iter()
                .map(|set| set.observations().len() as f64 * set.left_um * set.left_um)
                .sum();
            return Err(GeometryRefused::DoesNotFit {
                after_um,
                before_um,
                left_um: (left / with.rows as f64).sqrt(),
                quotient,
                probability: self.by_chance(quotient),
                hint: self.likely_fault(),
            });
        }
        let quotient =
            (without.weighted - with.weighted) / self.values() / (self.least_misfit() / free);
        let probability = self.by_chance(quotient);
        if probability > CHECK_ERROR_RATE {
            return Err(GeometryRefused::DoesNotReduce {
                after_um,
                before_um,
                quotient,
                probability,
            });
        }
        Ok(Some(GeometryCheck {
            before_um,
            after_um,
            rows: with.rows,
        }))
    }

    /// Values of the geometry, at least one.
    fn values(&self) -> f64 {
        let of_axis = |axis: &super::AxisGeometry| {
            let single = [
                axis.scale_um_m,
                axis.pitch_error_um,
                axis.pitch_error_um,
                axis.backlash_um,
            ];
            let straight: usize = axis.straightness.iter().map(Vec::len).sum();
            single.iter().filter(|value| **value != 0.0).count() + 2 * axis.table.len() + straight
        };
        let square = self.squareness;
        let angles = [
            square.squareness_xy_urad,
            square.squareness_xz_urad,
            square.squareness_yz_urad,
        ];
        let angles = angles.iter().filter(|value| **value != 0.0).count();
        (self.axes.iter().map(of_axis).sum::<usize>() + angles).max(1) as f64
    }

    fn free(&self) -> f64 {
        let rows: usize = self
            .measured
            .iter()
            .map(|set| set.observations().len())
            .sum();
        (rows as f64 - self.unknowns as f64).max(1.0)
    }

    /// The least misfit, as the file states it.
    fn least_misfit(&self) -> f64 {
        let of_set = |set: &super::observation::MeasuredSet| {
            let noises = set.left_um / set.noise_um;
            set.observations().len() as f64 * noises * noises
        };
        self.measured
            .iter()
            .map(of_set)
            .sum::<f64>()
            .max(f64::MIN_POSITIVE)
    }

    fn by_chance(&self, quotient: f64) -> f64 {
        f_exceeded(quotient, self.values(), self.free())
    }

    /// The quotient of the test, where the geometry does not fit.
    fn misfit_quotient(&self, with: &Misfit) -> Option<f64> {
        let quotient = (with.weighted - self.least_misfit())
            / self.values()
            / (self.least_misfit() / self.free());
        // A fit to the last digit leaves nothing, and rounding of the file counts as misfit.
        let rounding = with.um2 < ROUNDING_UM * ROUNDING_UM * with.rows as f64;
        (self.by_chance(quotient) < CHECK_ERROR_RATE && !rounding).then_some(quotient)
    }

    /// Returns the residual of this file's measurement with a geometry, after the nuisances of each
    /// set are fitted.
    fn misfit(&self, geometry: &Self) -> Misfit {
        let mut misfit = Misfit::default();
        for set in &self.measured {
            let observations = set.observations();
            let left: Vec<f64> = observations
                .iter()
                .map(|seen| seen.deviation_um - seen.predicted_um(geometry))
                .collect();
            let columns: Vec<Vec<f64>> = (0..super::observation::NUISANCES)
                .map(|i| observations.iter().map(|seen| seen.nuisance[i]).collect())
                .collect();
            let um2 = RankedLeastSquares::new(&columns, &left).left;
            misfit.um2 += um2;
            misfit.weighted += um2 / (set.noise_um * set.noise_um);
            misfit.rows += observations.len();
        }
        misfit
    }

    /// The one change that would make the geometry fit, in words.
    fn likely_fault(&self) -> String {
        let fits = |change: &dyn Fn(&mut Self)| {
            let mut changed = self.clone();
            change(&mut changed);
            changed.misfit_quotient(&self.misfit(&changed)).is_none()
        };
        for (i, axis) in crate::machine::AXIS_NAMES.iter().enumerate() {
            for (key, flip) in FLIPS {
                if fits(&|file| flip(&mut file.axes[i])) {
                    return format!(
                        "with the other sign of {key} of axis.{axis} it fits: correct the sign, or measure again"
                    );
                }
            }
        }
        type Angle = fn(&mut super::MeasuredSquareness) -> &mut f64;
        let angles: [(&str, Angle); 3] = [
            ("squareness_xy_urad", |square| {
                &mut square.squareness_xy_urad
            }),
            ("squareness_xz_urad", |square| {
                &mut square.squareness_xz_urad
            }),
            ("squareness_yz_urad", |square| {
                &mut square.squareness_yz_urad
            }),
        ];
        for (key, angle) in angles {
            if fits(&|file| *angle(&mut file.squareness) *= -1.0) {
                return format!(
                    "with the other sign of {key} it fits: correct the sign, or measure again"
                );
            }
        }
        for [a, b] in [[0, 1], [0, 2], [1, 2]] {
            if fits(&|file| file.axes.swap(a, b)) {
                let [a, b] = [a, b].map(|axis| crate::machine::AXIS_NAMES[axis]);
                return format!(
                    "with axis.{a} and axis.{b} exchanged it fits: exchange them, or measure again"
                );
            }
        }
        "a value, the lead or the measurement was changed: identify the measurement again"
            .to_owned()
    }
}

/// Misfit that is rounding of a file, um.
const ROUNDING_UM: f64 = 2e-3;

type Flip = fn(&mut super::AxisGeometry);

/// Changes of a sign of an axis.
const FLIPS: [(&str, Flip); 5] = [
    ("scale_um_m", |axis| axis.scale_um_m *= -1.0),
    ("pitch_error_um", |axis| axis.pitch_error_um *= -1.0),
    ("pitch_phase_deg", |axis| axis.pitch_phase_deg *= -1.0),
    ("backlash_um", |axis| axis.backlash_um *= -1.0),
    ("table", |axis| {
        for [_, forward_um, backward_um] in &mut axis.table {
            (*forward_um, *backward_um) = (-*forward_um, -*backward_um);
        }
    }),
];
