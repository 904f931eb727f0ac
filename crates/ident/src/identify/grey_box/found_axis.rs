//! Result of the identification of an axis: its model, numbers with intervals, scores, and
//! assumptions.

use rand::{RngExt, SeedableRng};

use super::axis_facts::AxisFacts;
use super::axis_record::AxisRecord;
use super::free_run_scores::AxisScores;
use super::gain_changes::GainChange;
use super::place_waves::{PlaceWaves, WaveModel};
use super::residual_noise::ResidualNoise;
use super::search_bound::SearchBound;
use super::standard_errors::HALF_INTERVAL;
use super::terms::{ModelTerm, TermValues};
use super::torque_column::{DriveColumn, TorqueColumn};
use super::unseen_motion::UnseenMotion;
use crate::identify::Rng;
use crate::identify::axis_statistics::KnownWaves;

/// Source of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberSource {
    /// The record determines it.
    Identified,
    /// The record has it, with the torque column.
    TorqueColumn,
    /// It was given.
    Given,
    /// An earlier record determined it; this one does not.
    Kept,
    /// The record cannot determine it and nobody stated it: it is a default.
    Assumed,
}

impl NumberSource {
    /// Returns the word for it in files and reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Identified => "identified",
            Self::TorqueColumn => "identified with the torque column",
            Self::Given => "given",
            Self::Kept => "kept",
            Self::Assumed => "assumed",
        }
    }
}

/// A number of an axis, as it is reported.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundNumber {
    /// Key in files.
    pub key: &'static str,
    /// Name in words.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Value.
    pub value: f64,
    /// Interval of 90 %, where the record gives one.
    pub interval: Option<[f64; 2]>,
    /// Source of the value.
    pub source: NumberSource,
}

/// An identified axis.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundAxis {
    /// Its name in the log.
    pub name: String,
    /// Values of its model, from positions alone.
    pub values: TermValues,
    /// Terms that were fitted.
    pub terms: Vec<ModelTerm>,
    /// Values that end where their search ends. The model does not hold if there is one.
    pub at_bounds: Vec<SearchBound>,
    /// Half of the interval of 90 % of each term, in the order of [`Self::terms`].
    pub half_intervals: Vec<f64>,
    /// Lower triangle of a root of their covariance, in their units, row by row; `None` where the
    /// fit leaves a term open.
    pub(crate) uncertain: Option<Vec<Vec<f64>>>,
    /// Model with the speed measurement of the drive, where a torque column or a fact determines
    /// it.
    pub resolved: Option<ResolvedModel>,
    /// Facts that were given.
    pub facts: AxisFacts,
    /// RMS that the free run leaves of the fitted samples, um.
    pub fit_um: f64,
    /// Prediction errors.
    pub scores: AxisScores,
    /// Uncertainty of predictions of motion that the record does not have.
    pub unseen: UnseenMotion,
    /// Residual of its free run, as a load; `None` where it is no more than the encoder noise.
    pub residual: Option<ResidualNoise>,
    /// Deviations that repeat with place.
    pub waves: PlaceWaves,
    /// Effects of other settings of its drive.
    pub gain_changes: Vec<GainChange>,
    /// RMS of noise of the encoder beside its steps, um.
    pub noise_um: f64,
    /// Step of the encoder, um.
    pub step_um: f64,
    /// Highest commanded speed, mm/s, and acceleration, mm/s2, in the record.
    pub most: [f64; 2],
}

/// Model with the window over which the drive takes the speed. The window determines the scale of
/// all values, which positions alone leave open.
#[derive(Debug, Clone, PartialEq)]
pub struct ResolvedModel {
    /// Values of it.
    pub values: TermValues,
    /// Half of the interval of 90 % of those that have one.
    pub(crate) half_intervals: Vec<(ModelTerm, f64)>,
    /// Mechanics from a torque column; `None` where the window was given.
    pub torque: Option<TorqueColumn>,
    /// Drive from the torque column.
    pub(crate) drive: Option<DriveColumn>,
    /// RMS that its free run leaves of the fitted samples, um.
    pub(crate) fit_um: f64,
}

impl ResolvedModel {
    /// Returns the source of a term of the model.
    fn source(&self, term: ModelTerm) -> NumberSource {
        let is_fitted = self.half_intervals.iter().any(|(of, _)| *of == term);
        match &self.torque {
            Some(_) => NumberSource::TorqueColumn,
            None if is_fitted => NumberSource::Identified,
            None => NumberSource::Given,
        }
    }
}

/// Values of terms, drawn from a normal distribution about `values`; `uncertain` is the lower
/// triangle of a root of its covariance. The delay of the loop goes to the next multiple of
/// `step_s`, and the others by their regression on it.
fn draw(
    values: &TermValues,
    terms: &[ModelTerm],
    uncertain: &[Vec<f64>],
    step_s: f64,
    mut normal: impl FnMut() -> f64,
) -> TermValues {
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let normals: Vec<f64> = terms.iter().map(|_| normal()).collect();
    let mut changes: Vec<f64> = uncertain.iter().map(|row| product(row, &normals)).collect();
    if let Some(delay) = terms.iter().position(|term| *term == ModelTerm::LoopDelay) {
        let delay_s = values.get(ModelTerm::LoopDelay) + changes[delay];
        let moved_s = (delay_s / step_s).round() * step_s - delay_s;
        let (of_delay, variance_s2) = (
            &uncertain[delay],
            product(&uncertain[delay], &uncertain[delay]),
        );
        for (change, row) in changes.iter_mut().zip(uncertain) {
            *change += product(row, of_delay) / variance_s2 * moved_s;
        }
    }
    terms
        .iter()
        .zip(changes)
        .fold(*values, |drawn, (term, change)| {
            drawn.with(*term, values.get(*term) + change)
        })
}

/// A standard normal number, by the polar method (Marsaglia and Bray 1964).
fn standard_normal(rng: &mut Rng) -> f64 {
    loop {
        let [x, y]: [f64; 2] = [rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0)];
        let square = x * x + y * y;
        if square > 0.0 && square < 1.0 {
            return x * libm::sqrt(-2.0 * libm::log(square) / square);
        }
    }
}

/// Lead that is taken where nobody says one, mm/rev.
pub(crate) const ASSUMED_LEAD_MM_PER_REV: f64 = 10.0;
/// Inertia that is assumed where nothing determines it, kg m2 at the shaft: of the size of tnv40's.
pub(crate) const ASSUMED_INERTIA_KG_M2: f64 = 0.01;

impl FoundAxis {
    /// Lead of the machine file, mm/rev, and whether somebody said it.
    pub fn lead(&self) -> (f64, NumberSource) {
        match self.facts.lead_mm_per_rev {
            Some(lead) => (lead, NumberSource::Given),
            None => (ASSUMED_LEAD_MM_PER_REV, NumberSource::Assumed),
        }
    }

    /// Turn of the motor for a travel, rad/mm.
    fn rad_per_mm(&self) -> f64 {
        std::f64::consts::TAU / self.lead().0
    }

    /// A mass, kg, or what of a linear axis has its unit in m, at the motor shaft of the machine
    /// file.
    fn at_shaft(&self, linear: f64) -> f64 {
        let m_per_rad = 1e-3 / self.rad_per_mm();
        linear * m_per_rad * m_per_rad
    }

    /// Inertia at the shaft, kg m2, its standard error, and where it comes from.
    pub fn inertia(&self) -> (f64, Option<f64>, NumberSource) {
        let to_shaft = |inertia: f64| {
            if self.facts.lead_mm_per_rev.is_some() {
                inertia
            } else {
                self.at_shaft(inertia)
            }
        };
        if let Some(inertia) = self.facts.inertia {
            return (to_shaft(inertia), None, NumberSource::Given);
        }
        let torque = self
            .resolved
            .as_ref()
            .and_then(|resolved| resolved.torque.as_ref());
        if let (Some(torque), Some(gain)) = (torque, self.facts.torque_gain) {
            // u = J a / g: N m for rad/s2 at the shaft, N for m/s2 of a linear axis.
            let per = if self.facts.lead_mm_per_rev.is_some() {
                self.rad_per_mm()
            } else {
                1e-3
            };
            let of = |units: f64| to_shaft((units * gain / per).abs());
            return (
                of(torque.units_per_mm_s2),
                Some(of(torque.units_error)),
                NumberSource::TorqueColumn,
            );
        }
        (ASSUMED_INERTIA_KG_M2, None, NumberSource::Assumed)
    }

    /// Returns the values of its model: with the window of the speed, where that is known.
    pub fn axis_model(&self) -> &TermValues {
        self.resolved
            .as_ref()
            .map_or(&self.values, |resolved| &resolved.values)
    }

    /// Returns half of the interval of a term of [`Self::axis_model`].
    pub fn half_interval(&self, term: ModelTerm) -> Option<f64> {
        let half = match &self.resolved {
            Some(resolved) => resolved
                .half_intervals
                .iter()
                .find(|(of, _)| *of == term)
                .map(|(_, half)| *half),
            None => self
                .terms
                .iter()
                .position(|fitted| *fitted == term)
                .map(|at| self.half_intervals[at]),
        };
        half.filter(|half| half.is_finite())
    }

    /// Returns the axis with a model that fits the record about as well. Its terms are drawn from
    /// what the fit leaves open of them, and held within their ranges. The delay of the loop is a
    /// whole multiple of `step_s`, as a machine file has it, and the other terms fit with it. The
    /// same seed draws the same axis. The terms of a model by a torque column or a given window are
    /// drawn one by one, since their correlations are not known.
    #[must_use]
    pub fn drawn(&self, seed: u64, step_s: f64) -> Self {
        let mut rng = Rng::seed_from_u64(seed);
        let mut normal = || standard_normal(&mut rng);
        let mut drawn = self.clone();
        if let Some(resolved) = &mut drawn.resolved {
            for (term, half) in resolved
                .half_intervals
                .iter()
                .filter(|(_, half)| half.is_finite())
            {
                let value = resolved.values.get(*term) + half / HALF_INTERVAL * normal();
                resolved.values = resolved.values.with(*term, value);
            }
            return drawn;
        }
        if let Some(uncertain) = &self.uncertain {
            drawn.values = draw(&self.values, &self.terms, uncertain, step_s, normal);
        }
        drawn
    }

    /// All numbers, those that positions determine first.
    pub fn numbers(&self) -> Vec<FoundNumber> {
        let stated = self.axis_model();
        let mut numbers: Vec<FoundNumber> = ModelTerm::ALL
            .into_iter()
            .filter(|term| {
                let always = matches!(
                    term,
                    ModelTerm::LoopGain
                        | ModelTerm::Damping
                        | ModelTerm::Coulomb
                        | ModelTerm::Offset
                );
                let needs = match term {
                    ModelTerm::StribeckSpeed => stated.get(ModelTerm::Stribeck) > 0.0,
                    ModelTerm::TableShare => stated.get(ModelTerm::Resonance) > 0.0,
                    _ => true,
                };
                (always || stated.get(*term) != 0.0) && needs
            })
            .map(|term| self.number(term, stated.get(term)))
            .collect();
        let (inertia, error, source) = self.inertia();
        let interval = error.map(|error| {
            [
                inertia - HALF_INTERVAL * error,
                inertia + HALF_INTERVAL * error,
            ]
        });
        let number = |key, name, unit, value, interval, source| FoundNumber {
            key,
            name,
            unit,
            value,
            interval,
            source,
        };
        numbers.push(number(
            "inertia_kg_m2",
            "inertia J at the shaft",
            "kg m2",
            inertia,
            interval,
            source,
        ));
        let apart = self.gains_source();
        numbers.push(number("kp_1_s", "Kp", "1/s", stated.kp_1_s(), None, apart));
        let kv = stated.speed_gain_1_s() * inertia;
        let of_kv = if source == NumberSource::Assumed {
            NumberSource::Assumed
        } else {
            apart
        };
        numbers.push(number(
            "kv_nm_s_per_rad",
            "Kv at the shaft",
            "N m s/rad",
            kv,
            None,
            of_kv,
        ));
        numbers.extend(self.of_waves());
        numbers
    }

    /// Numbers of what repeats with place.
    fn of_waves(&self) -> Vec<FoundNumber> {
        let identified = |key, name, unit, value| FoundNumber {
            key,
            name,
            unit,
            value,
            interval: None,
            source: NumberSource::Identified,
        };
        let given = |number: FoundNumber, is_given: bool| FoundNumber {
            source: if is_given {
                NumberSource::Given
            } else {
                number.source
            },
            ..number
        };
        let interpolation = self.waves.interpolation.map(|wave| {
            let period = identified(
                "signal_period_um",
                "signal period",
                "um",
                1e3 * wave.period_mm,
            );
            [
                identified(
                    "interpolation_error_um",
                    "interpolation error",
                    "um",
                    wave.amplitude,
                ),
                given(period, self.facts.signal_period_mm.is_some()),
                identified(
                    "interpolation_phase_rad",
                    "its phase at zero",
                    "rad",
                    wave.phase_rad,
                ),
            ]
        });
        let cogging = self.waves.cogging.map(|wave| {
            let period = identified("cogging_period_mm", "its period", "mm", wave.period_mm);
            [
                identified(
                    "cogging_over_j_mm_s2",
                    "cogging / J",
                    "mm/s2",
                    wave.amplitude,
                ),
                given(period, self.facts.cogging_per_rev.is_some()),
                identified(
                    "cogging_phase_rad",
                    "its phase at zero",
                    "rad",
                    wave.phase_rad,
                ),
            ]
        });
        [interpolation, cogging]
            .into_iter()
            .flatten()
            .flatten()
            .collect()
    }

    fn number(&self, term: ModelTerm, value: f64) -> FoundNumber {
        let row = term.row();
        let source = match &self.resolved {
            _ if term == ModelTerm::CommandDelay && self.facts.command_delay_s.is_some() => {
                NumberSource::Given
            }
            _ if term == ModelTerm::CommandDelay => NumberSource::Identified,
            Some(resolved) => resolved.source(term),
            None if self.terms.contains(&term) => NumberSource::Identified,
            None if self.facts.before.is_some() => NumberSource::Kept,
            None if term == ModelTerm::Viscous || term == ModelTerm::RecordDelay => {
                NumberSource::Given
            }
            None => NumberSource::Assumed,
        };
        let [least, most] = row.range;
        let interval = self
            .half_interval(term)
            .map(|half| [(value - half).max(least), (value + half).min(most)]);
        FoundNumber {
            key: term.key(),
            name: row.name,
            unit: row.unit,
            value,
            interval,
            source,
        }
    }

    /// Returns the source of Kp, Kv and B as separate values.
    pub fn gains_source(&self) -> NumberSource {
        if self
            .resolved
            .as_ref()
            .is_some_and(|resolved| resolved.torque.is_some())
        {
            NumberSource::TorqueColumn
        } else if self.facts.viscous.is_some() && self.facts.inertia.is_some() {
            NumberSource::Given
        } else if self.terms.contains(&ModelTerm::Viscous) {
            NumberSource::Identified
        } else {
            NumberSource::Assumed
        }
    }

    /// Finds what repeats with place in the record of the axis.
    pub(super) fn waves_in(&self, record: &AxisRecord<'_>) -> PlaceWaves {
        let rad_per_mm = self.rad_per_mm();
        let per_rad = |period_mm: f64| std::f64::consts::TAU / (period_mm * rad_per_mm);
        let model = WaveModel {
            values: &self.values,
            most: self.most,
            rad_per_mm,
            known: KnownWaves {
                signal_per_rad: self.facts.signal_period_mm.map(per_rad),
                cogging_per_rev: self.facts.cogging_per_rev,
            },
        };
        model.waves(record)
    }
}

#[cfg(test)]
mod tests {
    use super::super::terms::TERMS;
    use super::*;

    const TERMS_OF_TEST: [ModelTerm; 3] = [
        ModelTerm::LoopGain,
        ModelTerm::Coulomb,
        ModelTerm::LoopDelay,
    ];
    const DRAWS: usize = 20_000;

    fn values() -> TermValues {
        let values = TermValues([0.0; TERMS])
            .with(ModelTerm::LoopGain, 1e4)
            .with(ModelTerm::Coulomb, 30.0);
        values.with(ModelTerm::LoopDelay, 1.14e-3)
    }

    /// Changes of the terms in many draws, with delays in steps of `step_s`.
    fn changes(step_s: f64) -> Vec<[f64; 3]> {
        let root = [vec![200.0], vec![-3.0, 4.0], vec![2e-5, 0.0, 1e-5]];
        let mut rng = Rng::seed_from_u64(1);
        let change = |_| {
            let drawn = draw(&values(), &TERMS_OF_TEST, &root, step_s, || {
                standard_normal(&mut rng)
            });
            TERMS_OF_TEST.map(|term| drawn.get(term) - values().get(term))
        };
        (0..DRAWS).map(change).collect()
    }

    #[test]
    fn draws_have_the_covariance_of_the_fit() {
        let changes = changes(1e-12);
        let mean =
            |of: &dyn Fn(&[f64; 3]) -> f64| changes.iter().map(of).sum::<f64>() / DRAWS as f64;
        let near = |found: f64, wanted: f64, size: f64| {
            // Four standard errors of a mean of products.
            assert!(
                (found - wanted).abs() < 4.0 * 1.5 * size / (DRAWS as f64).sqrt(),
                "{found} {wanted}"
            );
        };
        near(mean(&|change| change[0]), 0.0, 200.0);
        near(mean(&|change| change[0] * change[0]), 4e4, 4e4);
        near(mean(&|change| change[0] * change[1]), -600.0, 200.0 * 5.0);
        near(mean(&|change| change[1] * change[1]), 25.0, 25.0);
        near(mean(&|change| change[0] * change[2]), 4e-3, 200.0 * 2.24e-5);
    }

    #[test]
    fn a_delay_is_whole_and_what_goes_with_it_goes_along() {
        let step_s = 1e-4;
        for change in changes(step_s) {
            let steps = (1.14e-3 + change[2]) / step_s;
            assert!((steps - steps.round()).abs() < 1e-9, "{steps}");
        }
        // Of the variance of the gain the delay explains four fifths, and takes them along: what is
        // left is 200^2 / 5.
        let steps = |change: &[f64; 3]| ((1.14e-3 + change[2]) / step_s).round() as i64;
        let same: Vec<f64> = changes(step_s)
            .iter()
            .filter(|change| steps(change) == 11)
            .map(|change| change[0])
            .collect();
        let mean = same.iter().sum::<f64>() / same.len() as f64;
        let variance =
            same.iter().map(|gain| (gain - mean).powi(2)).sum::<f64>() / same.len() as f64;
        assert!(
            same.len() > DRAWS / 2 && (variance / 8e3 - 1.0).abs() < 0.1,
            "{} {variance}",
            same.len()
        );
    }
}
