//! Fits the geometry to all measurements together.
//!
//! ```text
//! deviation / noise = (nuisances of its set + sum of unknowns times the prediction of one unit) / noise + residual
//! ```
//!
//! The noise of a set is the residual of the fit; fit and noise are found in turns. Residuals that
//! follow each other alike, such as the residuals of a servo that lags, contain less information
//! than independent ones: standard deviations are multiplied by sqrt(tau), tau = 1 + 2 times the
//! sum of the autocorrelations up to the first that is negative (Geyer 1992, Practical Markov chain
//! Monte Carlo). A pitch error that is not significant in an F-test at 0.1 % is left out. The
//! windup of a screw is taken off the deviations. It is known to a tenth, which adds to the
//! variance of the backlash.

use feedwright_sim::{
    AXIS_NAMES, Axis, CHECK_ERROR_RATE, GeometryCheck, GeometryFile, GeometryOrigin,
    GeometryRefused, MeasuredSet, NUISANCES, Observation, RankedLeastSquares, f_exceeded,
};
use miette::Diagnostic;
use thiserror::Error;

use super::circularity::Circularity;
use super::readings::{WINDUP_UNCERTAINTY, binned, repeatability_um, table_of, take_off_windup};
use super::unknowns::{PAIRS, Unknown, UnknownKind, angle, shows_turns, unknowns};
use crate::model::version;

/// Why a measurement gives no geometry.
#[derive(Debug, Clone, PartialEq, Error, Diagnostic)]
pub enum NoGeometry {
    /// The measurement has no more rows than unknowns.
    #[error("the measurement has {rows} values for {unknowns} unknowns")]
    #[diagnostic(
        code(geometry::rows),
        help("measure more positions or angles, or each several times")
    )]
    TooFew {
        /// Values.
        rows: usize,
        /// Unknowns.
        unknowns: usize,
    },
    /// The machine has no such axis.
    #[error("the measurement is of {axis}, and the machine has no such axis")]
    #[diagnostic(
        code(geometry::axis),
        help("is it the right machine file? '# plane' and '# axis' say what a measurement is of")
    )]
    NoSuchAxis {
        /// The axis.
        axis: &'static str,
    },
    /// The result would be refused by who reads it.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Refused(#[from] GeometryRefused),
}

/// A value that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundGeometryValue {
    /// Name of the value, such as `scale x`.
    pub name: String,
    /// Its unit.
    pub(crate) unit: &'static str,
    /// The value.
    pub value: f64,
    /// Its standard deviation.
    pub std: f64,
}

/// Quality of a set in the fit.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundSet {
    /// Name of the set.
    pub(crate) name: String,
    /// Values of it.
    pub(crate) rows: usize,
    /// Root mean square of its deviations without the geometry, um.
    pub before_um: f64,
    /// The same with the geometry, um.
    pub left_um: f64,
    /// Standard deviation of values that were measured at the same place in the same direction, um;
    /// none where each was measured once.
    pub repeatability_um: Option<f64>,
    /// Factor tau by which its residuals contain less information than independent ones.
    pub(crate) correlation: f64,
    /// Circular deviations of a ball bar, as it was read.
    pub(crate) circularity: Option<Circularity>,
    /// Nuisances: name, value, unit.
    pub nuisances: Vec<(&'static str, f64, &'static str)>,
}

/// A geometry with how well it is known.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundGeometry {
    /// The file.
    pub file: GeometryFile,
    /// Every value with its standard deviation.
    pub values: Vec<FoundGeometryValue>,
    /// Quality of each measurement.
    pub sets: Vec<FoundSet>,
    /// Quantities that could not be determined, in sentences.
    pub notes: Vec<String>,
    /// The test that a reader of the file makes.
    pub check: GeometryCheck,
}

/// Rounds in which fit and noise are found in turns; the noise changes by less than a percent after
/// the second.
const ROUNDS: usize = 3;
/// Least noise of a set, um: an exact measurement does not get infinite weight.
const LEAST_NOISE_UM: f64 = 1e-3;

/// The geometry of a machine with these axes. Of an axis, its lead is used, and its lost motion by
/// friction that winds the screw up: the model of the axis predicts it, and it is no geometry.
///
/// # Errors
/// See `NoGeometry`.
pub fn fit_geometry(
    sets: Vec<MeasuredSet>,
    axes: &[Axis],
    source: &str,
) -> Result<FoundGeometry, NoGeometry> {
    let mut fit = GeometryFit::new(sets, axes)?;
    fit.solve()?;
    fit.drop_pitch_of_noise()?;
    let mut found = fit.found(source)?;
    found.file.check().map(|check| {
        // There is a measurement, so there is a check.
        found.check = check.unwrap_or(found.check);
    })?;
    Ok(found)
}

struct GeometryFit {
    sets: Vec<MeasuredSet>,
    seen: Vec<Vec<Observation>>,
    unknowns: Vec<Unknown>,
    repeatability_um: Vec<Option<f64>>,
    circularity: Vec<Option<Circularity>>,
    solution: RankedLeastSquares,
    correlation: Vec<f64>,
    /// Standard deviation of the windup of each axis that was taken off, um.
    windup_std_um: [f64; 3],
    notes: Vec<String>,
}

impl GeometryFit {
    fn new(mut sets: Vec<MeasuredSet>, of_machine: &[Axis]) -> Result<Self, NoGeometry> {
        let windup = |axis: &Axis| 1e3 * axis.hidden_windup_mm();
        let windup_um = [0, 1, 2].map(|axis| of_machine.get(axis).map_or(0.0, windup));
        let circularity = sets.iter().map(Circularity::of).collect();
        let mut notes = Vec::new();
        for (axis, windup_um) in windup_um.into_iter().enumerate() {
            if windup_um > 0.0 {
                sets.iter_mut()
                    .for_each(|set| take_off_windup(set, axis, windup_um));
                let um = feedwright_sim::to_four_digits(windup_um);
                notes.push(format!(
                    "backlash {}: without {um} um by which friction winds the screw of the machine file up",
                    AXIS_NAMES[axis]
                ));
            }
        }
        let leads_mm = [0, 1, 2].map(|axis| of_machine.get(axis).map(|axis| axis.lead_mm_per_rev));
        let repeatability_um = sets.iter().map(repeatability_um).collect();
        let least_lead_mm = leads_mm
            .iter()
            .flatten()
            .copied()
            .fold(f64::INFINITY, f64::min);
        let sets: Vec<MeasuredSet> = sets
            .into_iter()
            .map(|set| binned(set, least_lead_mm))
            .collect();
        let of_sets: Vec<Vec<usize>> = sets
            .iter()
            .map(|set| set.axis_numbers().unwrap_or_default())
            .collect();
        let axes: Vec<usize> = (0..3)
            .filter(|axis| of_sets.iter().any(|axes| axes.contains(axis)))
            .collect();
        if let Some(&missing) = axes.iter().find(|&&axis| leads_mm[axis].is_none()) {
            return Err(NoGeometry::NoSuchAxis {
                axis: AXIS_NAMES[missing],
            });
        }
        let planes: Vec<[usize; 2]> = [[0, 1], [0, 2], [1, 2]]
            .into_iter()
            .filter(|plane| of_sets.iter().any(|axes| axes == plane))
            .collect();
        let seen: Vec<Vec<Observation>> = sets.iter().map(MeasuredSet::observations).collect();
        let turns = [0, 1, 2].map(|axis| {
            let lead_mm = leads_mm[axis]?;
            let shows = |(seen, axes): (&Vec<Observation>, &Vec<usize>)| {
                axes.contains(&axis) && shows_turns(seen, axis, lead_mm)
            };
            seen.iter().zip(&of_sets).any(shows).then_some(lead_mm)
        });
        notes.extend(
            axes.iter()
                .filter(|&&axis| turns[axis].is_none())
                .map(|&axis| {
                    format!(
                        "pitch error of {}: not determined, the positions are too far apart for its lead",
                        AXIS_NAMES[axis]
                    )
                }),
        );
        let unknowns = unknowns(&axes, &planes, turns);
        let solution = RankedLeastSquares::default();
        let correlation = vec![1.0; sets.len()];
        let windup_std_um = windup_um.map(|windup_um| WINDUP_UNCERTAINTY * windup_um);
        Ok(Self {
            sets,
            seen,
            unknowns,
            repeatability_um,
            circularity,
            solution,
            correlation,
            windup_std_um,
            notes,
        })
    }

    fn rows(&self) -> usize {
        self.seen.iter().map(Vec::len).sum()
    }

    /// Columns of all nuisances, then of all unknowns, and the deviations, divided by the noise.
    fn system(&self) -> (Vec<Vec<f64>>, Vec<f64>) {
        let weighted = |value: &dyn Fn(usize, &Observation) -> f64| -> Vec<f64> {
            let of_set = |(at, seen): (usize, &Vec<Observation>)| {
                let noise_um = self.sets[at].noise_um;
                seen.iter()
                    .map(|seen| value(at, seen) / noise_um)
                    .collect::<Vec<f64>>()
            };
            self.seen.iter().enumerate().flat_map(of_set).collect()
        };
        let mut columns = Vec::new();
        for set in 0..self.sets.len() {
            for i in 0..NUISANCES {
                columns.push(weighted(&|at, seen| {
                    if at == set { seen.nuisance[i] } else { 0.0 }
                }));
            }
        }
        columns.extend(
            self.unknowns
                .iter()
                .map(|unknown| weighted(&|_, seen| seen.predicted_um(&unknown.unit))),
        );
        (columns, weighted(&|_, seen| seen.deviation_um))
    }

    fn solve(&mut self) -> Result<(), NoGeometry> {
        for _ in 0..ROUNDS {
            let (columns, right) = self.system();
            self.solution = RankedLeastSquares::new(&columns, &right);
            let (rows, unknowns) = (self.rows(), self.solution.rank());
            if rows <= unknowns {
                return Err(NoGeometry::TooFew { rows, unknowns });
            }
            let free = (rows - unknowns) as f64 / rows as f64;
            let mut left = right;
            for (column, value) in columns.iter().zip(&self.solution.values) {
                left.iter_mut()
                    .zip(column)
                    .for_each(|(left, column)| *left -= value * column);
            }
            let mut begins = 0;
            for (at, seen) in self.seen.iter().enumerate() {
                let left = &left[begins..begins + seen.len()];
                begins += seen.len();
                let noises =
                    (left.iter().map(|left| left * left).sum::<f64>() / left.len() as f64 / free)
                        .sqrt();
                let set = &mut self.sets[at];
                set.noise_um = (noises * set.noise_um).max(LEAST_NOISE_UM);
                self.correlation[at] = correlation(left);
            }
        }
        let (columns, right) = self.system();
        self.solution = RankedLeastSquares::new(&columns, &right);
        Ok(())
    }

    fn place(&self, kind: UnknownKind) -> Option<usize> {
        self.unknowns
            .iter()
            .position(|unknown| unknown.kind == kind)
    }

    fn drop_pitch_of_noise(&mut self) -> Result<(), NoGeometry> {
        let free = (self.rows() - self.solution.rank()) as f64;
        let offset = NUISANCES * self.sets.len();
        let variance = self.solution.left / free * self.tau();
        let mut dropped = Vec::new();
        for axis in 0..3 {
            let (Some(s), Some(c)) = (
                self.place(UnknownKind::PitchSine(axis)),
                self.place(UnknownKind::PitchCosine(axis)),
            ) else {
                continue;
            };
            let [s, c] = [s + offset, c + offset];
            let (values, covariance) = (&self.solution.values, &self.solution.covariance);
            let [ss, sc, cc] = [covariance[s][s], covariance[s][c], covariance[c][c]];
            let squares = (values[s] * values[s] * cc - 2.0 * values[s] * values[c] * sc
                + values[c] * values[c] * ss)
                / (ss * cc - sc * sc);
            if !squares.is_finite()
                || f_exceeded(0.5 * squares / variance, 2.0, free) > CHECK_ERROR_RATE
            {
                dropped.push(axis);
            }
        }
        if dropped.is_empty() {
            return Ok(());
        }
        for &axis in &dropped {
            self.notes.push(format!(
                "pitch error of {}: not distinguishable from zero",
                AXIS_NAMES[axis]
            ));
        }
        let is_dropped = |kind| matches!(kind, UnknownKind::PitchSine(axis) | UnknownKind::PitchCosine(axis) if dropped.contains(&axis));
        self.unknowns.retain(|unknown| !is_dropped(unknown.kind));
        self.solve()
    }

    /// Factor of the variances by correlated residuals: of the set that it is largest in.
    fn tau(&self) -> f64 {
        self.correlation.iter().copied().fold(1.0, f64::max)
    }

    /// Covariance of two unknowns.
    fn covariance(&self, i: usize, j: usize) -> f64 {
        let offset = NUISANCES * self.sets.len();
        let free = (self.rows() - self.solution.rank()) as f64;
        self.solution.covariance[i + offset][j + offset] * self.solution.left / free * self.tau()
    }

    /// A sum of unknowns: value and standard deviation; none where one of them was not found.
    fn sum(&self, factor: impl Fn(&Unknown) -> f64) -> Option<(f64, f64)> {
        let offset = NUISANCES * self.sets.len();
        let (mut value, mut variance, mut any) = (0.0, 0.0, false);
        for (i, unknown) in self
            .unknowns
            .iter()
            .enumerate()
            .filter(|(i, _)| self.solution.found[i + offset])
        {
            any |= factor(unknown) != 0.0;
            value += factor(unknown) * self.solution.values[i + offset];
            for (j, other) in self.unknowns.iter().enumerate() {
                variance += factor(unknown) * factor(other) * self.covariance(i, j);
            }
        }
        any.then(|| (value, variance.max(0.0).sqrt()))
    }

    fn found(mut self, source: &str) -> Result<FoundGeometry, NoGeometry> {
        let mut values = Vec::new();
        let mut file = GeometryFile {
            origin: GeometryOrigin {
                written_by: version(),
                source: source.to_owned(),
                date: self.date(),
            },
            unknowns: self.solution.rank() as u64,
            ..GeometryFile::default()
        };
        let mut put = |name: String, unit: &'static str, (value, std): (f64, f64)| {
            let found = FoundGeometryValue {
                name,
                unit,
                value: rounded(value, std),
                std: rounded(std, std),
            };
            values.push(found.clone());
            found
        };
        for axis in 0..3 {
            let name = AXIS_NAMES[axis];
            if let Some(scale) = self.sum(|unknown| unknown.unit.axes[axis].scale_um_m) {
                let found = put(format!("scale {name}"), "um/m", scale);
                (file.axes[axis].scale_um_m, file.axes[axis].scale_std_um_m) =
                    (found.value, found.std);
            }
            if let Some((backlash, std)) = self.sum(|unknown| unknown.unit.axes[axis].backlash_um) {
                let std = libm::hypot(std, self.windup_std_um[axis]);
                let found = put(format!("backlash {name}"), "um", (backlash, std));
                (file.axes[axis].backlash_um, file.axes[axis].backlash_std_um) =
                    (found.value, found.std);
            }
            if let Some([amplitude, phase, lead_mm]) = self.pitch(axis) {
                let (amplitude, phase) = (
                    put(format!("pitch error {name}"), "um", amplitude.into()),
                    put(format!("pitch phase {name}"), "degrees", phase.into()),
                );
                let of = &mut file.axes[axis];
                (of.pitch_error_um, of.pitch_error_std_um) = (amplitude.value, amplitude.std);
                (
                    of.pitch_phase_deg,
                    of.pitch_phase_std_deg,
                    of.lead_mm_per_rev,
                ) = (phase.value, phase.std, lead_mm[0]);
            }
            [file.axes[axis].from_mm, file.axes[axis].to_mm] = self.travel_mm(axis);
        }
        for (pair, name) in PAIRS.into_iter().enumerate() {
            let is = |unknown: &Unknown| {
                if unknown.kind == UnknownKind::Squareness(pair) {
                    1.0
                } else {
                    0.0
                }
            };
            if let Some(squareness) = self.sum(is) {
                let found = put(format!("squareness {name}"), "urad", squareness);
                *angle(&mut file, pair) = found.value;
                let square = &mut file.squareness;
                *[
                    &mut square.squareness_xy_std_urad,
                    &mut square.squareness_xz_std_urad,
                    &mut square.squareness_yz_std_urad,
                ][pair] = found.std;
            }
        }
        self.report_undetermined();
        self.tables(&mut file);
        let sets = (0..self.sets.len())
            .map(|at| self.of_set(at, &file))
            .collect::<Vec<_>>();
        self.sets
            .iter_mut()
            .zip(&sets)
            .for_each(|(set, found)| set.left_um = found.left_um);
        file.measured = self.sets;
        let check = GeometryCheck {
            before_um: 0.0,
            after_um: 0.0,
            rows: 0,
        };
        Ok(FoundGeometry {
            file,
            values,
            sets,
            notes: self.notes,
            check,
        })
    }

    /// Amplitude and phase of a pitch error with their standard deviations, and the lead.
    fn pitch(&self, axis: usize) -> Option<[[f64; 2]; 3]> {
        let (s, c) = (
            self.place(UnknownKind::PitchSine(axis))?,
            self.place(UnknownKind::PitchCosine(axis))?,
        );
        let offset = NUISANCES * self.sets.len();
        let [sine, cosine] = [s, c].map(|i| self.solution.values[i + offset]);
        let amplitude = libm::hypot(sine, cosine);
        let [ss, sc, cc] = [
            self.covariance(s, s),
            self.covariance(s, c),
            self.covariance(c, c),
        ];
        let (u, v) = (sine / amplitude, cosine / amplitude);
        let along = (u * u * ss + 2.0 * u * v * sc + v * v * cc).max(0.0).sqrt();
        let across = (v * v * ss - 2.0 * u * v * sc + u * u * cc).max(0.0).sqrt() / amplitude;
        let phase_deg = libm::atan2(cosine, sine).to_degrees();
        let lead_mm = self.unknowns[s].unit.axes[axis].lead_mm_per_rev;
        Some([
            [amplitude, along],
            [phase_deg, across.to_degrees()],
            [lead_mm, 0.0],
        ])
    }

    fn date(&self) -> String {
        self.sets
            .iter()
            .map(|set| set.date.clone())
            .max()
            .unwrap_or_default()
    }

    /// Least and greatest position of an axis that was measured.
    fn travel_mm(&self, axis: usize) -> [f64; 2] {
        let of_axis = |place: &&feedwright_sim::MeasuredPlace| place.along != [0.0; 3];
        let sets = self
            .sets
            .iter()
            .zip(&self.seen)
            .filter(|(set, _)| set.axis_numbers().is_some_and(|axes| axes.contains(&axis)));
        let positions = sets.flat_map(|(_, seen)| {
            seen.iter()
                .flat_map(|seen| seen.places.iter().filter(of_axis))
                .map(|place| place.at_mm[axis])
        });
        let [least, most] = positions
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], at| {
                [least.min(at), most.max(at)]
            });
        if least < most {
            [least, most].map(|mm| (mm * 1e3).round() / 1e3 + 0.0)
        } else {
            [0.0; 2]
        }
    }

    fn report_undetermined(&mut self) {
        let offset = NUISANCES * self.sets.len();
        for (_, unknown) in self
            .unknowns
            .iter()
            .enumerate()
            .filter(|(i, _)| !self.solution.found[i + offset])
        {
            let why = match unknown.kind {
                UnknownKind::MeanScale => {
                    "it needs a calibrated length; the scales are differences, split evenly. Calibrate the bar, or measure an axis by laser"
                }
                UnknownKind::Backlash(_) => "measure in both directions",
                _ => "measure at more places",
            };
            self.notes
                .push(format!("{}: not determined, {why}", unknown.kind.name()));
        }
        if self
            .sets
            .iter()
            .any(|set| set.kind == "bar" && set.calibrated)
        {
            self.notes.push(
                "mean scale: a servo that lags makes circles smaller by the square of the feedrate; measure slowly, or at two feedrates".to_owned(),
            );
        }
    }

    /// Adds deviations that repeat at the targets of an axis in spite of scale and backlash, where
    /// an F-test separates them from noise.
    fn tables(&mut self, file: &mut GeometryFile) {
        for (at, set) in self
            .sets
            .iter()
            .enumerate()
            .filter(|(_, set)| set.kind == "axis")
        {
            let Some(&[axis]) = set
                .axis_numbers()
                .as_deref()
                .and_then(|axes| axes.first_chunk::<1>())
            else {
                continue;
            };
            let left: Vec<f64> = left_um(&self.seen[at], file).1;
            let Some((rows, quotient)) = table_of(set, &left) else {
                self.notes.push(format!(
                    "table of {}: none, it takes two runs in each direction",
                    AXIS_NAMES[axis]
                ));
                continue;
            };
            let (over, under) = (
                2.0 * rows.len() as f64 - 3.0,
                (left.len() - 2 * rows.len()) as f64,
            );
            if f_exceeded(quotient[0], over, under) > CHECK_ERROR_RATE {
                self.notes.push(format!(
                    "table of {}: none, scale and backlash leave no more than noise",
                    AXIS_NAMES[axis]
                ));
                continue;
            }
            file.axes[axis].table = rows;
            file.axes[axis].table_std_um = rounded(quotient[1], quotient[1]);
            file.unknowns += over as u64;
        }
    }

    fn of_set(&self, at: usize, file: &GeometryFile) -> FoundSet {
        let (set, seen) = (&self.sets[at], &self.seen[at]);
        let rms = |left: &[f64]| {
            (left.iter().map(|left| left * left).sum::<f64>() / left.len().max(1) as f64).sqrt()
        };
        let (values, left) = left_um(seen, file);
        let names: [(&'static str, &'static str); NUISANCES] = match set.kind.as_str() {
            "bar" => [
                ("center offset, first axis", "um"),
                ("center offset, second axis", "um"),
                ("servo mismatch", "um"),
                ("radius", "um"),
            ],
            "grid" => [
                ("offset, first axis", "um"),
                ("offset, second axis", "um"),
                ("rotation", "urad"),
                ("", ""),
            ],
            "axis" => [("offset", "um"), ("", ""), ("", ""), ("", "")],
            _ => [
                ("size of the tool, each feature", "um"),
                ("", ""),
                ("", ""),
                ("", ""),
            ],
        };
        let nuisances = names
            .into_iter()
            .zip(values)
            .filter(|((name, _), _)| !name.is_empty());
        FoundSet {
            name: set.name.clone(),
            rows: seen.len(),
            before_um: rms(&left_um(seen, &GeometryFile::default()).1),
            left_um: rms(&left),
            repeatability_um: self.repeatability_um[at],
            correlation: self.correlation[at],
            circularity: self.circularity[at],
            nuisances: nuisances
                .map(|((name, unit), value)| (name, value, unit))
                .collect(),
        }
    }
}

/// Nuisances, and what is left of a set by a geometry, um.
fn left_um(seen: &[Observation], file: &GeometryFile) -> (Vec<f64>, Vec<f64>) {
    let mut left: Vec<f64> = seen
        .iter()
        .map(|seen| seen.deviation_um - seen.predicted_um(file))
        .collect();
    let columns: Vec<Vec<f64>> = (0..NUISANCES)
        .map(|i| seen.iter().map(|seen| seen.nuisance[i]).collect())
        .collect();
    let fit = RankedLeastSquares::new(&columns, &left);
    for (column, value) in columns.iter().zip(&fit.values) {
        left.iter_mut()
            .zip(column)
            .for_each(|(left, column)| *left -= value * column);
    }
    (fit.values, left)
}

/// Rounds a value to a hundredth of its standard deviation.
fn rounded(value: f64, std: f64) -> f64 {
    if !(std.is_finite() && std > 0.0 && value.is_finite()) {
        return value;
    }
    let decimals = (2.0 - libm::floor(libm::log10(std))).clamp(0.0, 12.0);
    let factor = libm::pow(10.0, decimals);
    (value * factor).round() / factor + 0.0
}

/// Correlation factor of residuals in the order that they were measured in.
fn correlation(left: &[f64]) -> f64 {
    let power: f64 = left.iter().map(|left| left * left).sum();
    let mut tau = 1.0;
    for lag in 1..left.len() / 4 {
        let product: f64 = left.iter().zip(&left[lag..]).map(|(a, b)| a * b).sum();
        if product <= 0.0 || power == 0.0 {
            break;
        }
        tau += 2.0 * product / power;
    }
    tau
}
