//! What was found of an axis: its law, numbers with intervals, scores, and what of it is assumed.

use super::axis_facts::AxisFacts;
use super::axis_record::AxisRecord;
use super::free_run_scores::AxisScores;
use super::gain_changes::GainChange;
use super::residual_noise::ResidualNoise;
use super::terms::{LawTerm, TermValues};
use super::torque_column::{DriveColumn, TorqueColumn};
use super::unseen_motion::UnseenMotion;

/// Where a number comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberSource {
    /// The record determines it.
    Identified,
    /// The record has it, with the torque column.
    TorqueColumn,
    /// It was given.
    Given,
    /// The record does not tell it, an earlier one did.
    Kept,
    /// The record cannot tell it: it stands for what nobody said.
    Assumed,
}

impl NumberSource {
    /// As files and reports tell it.
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

/// A number of an axis, as it is told.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundNumber {
    /// Key in files.
    pub key: &'static str,
    /// In words.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Value.
    pub value: f64,
    /// Interval of 90 %, where the record gives one.
    pub interval: Option<[f64; 2]>,
    /// Where it comes from.
    pub source: NumberSource,
}

/// An identified axis.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundAxis {
    /// Its name in the log.
    pub name: String,
    /// Values of its law, by positions alone.
    pub values: TermValues,
    /// Terms that were fitted.
    pub terms: Vec<LawTerm>,
    /// Half of the interval of 90 % of each, in the same order.
    pub half_intervals: Vec<f64>,
    /// The law with what the drive does to the speed, where a torque column or a fact tells it.
    pub resolved: Option<ResolvedLaw>,
    /// What was given.
    pub facts: AxisFacts,
    /// RMS that the free run leaves of the fitted samples, um.
    pub fit_um: f64,
    /// How well it predicts.
    pub scores: AxisScores,
    /// How certain predictions are of motion that the record does not have.
    pub unseen: UnseenMotion,
    /// What its free run leaves, as a load; none where that is no more than the encoder shows.
    pub residual: Option<ResidualNoise>,
    /// What other settings of its drive would bring.
    pub gain_changes: Vec<GainChange>,
    /// RMS of noise of the encoder beside its steps, um.
    pub noise_um: f64,
    /// Step of the encoder, um.
    pub step_um: f64,
    /// Highest commanded speed, mm/s, and acceleration, mm/s2, in the record.
    pub most: [f64; 2],
}

/// A law with the window over which the drive takes the speed: with that the scale of everything is told, which positions alone leave open.
#[derive(Debug, Clone, PartialEq)]
pub struct ResolvedLaw {
    /// Values of it.
    pub values: TermValues,
    /// Half of the interval of 90 % of those that have one.
    pub half_intervals: Vec<(LawTerm, f64)>,
    /// What a torque column told of the mechanics; none where the window was given.
    pub torque: Option<TorqueColumn>,
    /// What the column told of the drive.
    pub drive: Option<DriveColumn>,
    /// RMS that its free run leaves of the fitted samples, um.
    pub fit_um: f64,
}

impl ResolvedLaw {
    /// Where a term of it comes from.
    fn source(&self, term: LawTerm) -> NumberSource {
        let is_fitted = self.half_intervals.iter().any(|(of, _)| *of == term);
        match &self.torque {
            Some(_) => NumberSource::TorqueColumn,
            None if is_fitted => NumberSource::Identified,
            None => NumberSource::Given,
        }
    }
}

/// Lead that is taken where nobody says one, mm/rev.
pub(crate) const ASSUMED_LEAD_MM_PER_REV: f64 = 10.0;
/// Inertia that is taken where nothing tells it, kg m2 at the shaft: of the size of tnv40's.
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

    /// A mass, kg, or what of a linear axis has its unit in m, at the motor shaft of the machine file.
    fn at_shaft(&self, linear: f64) -> f64 {
        let m_per_rad = 1e-3 / self.rad_per_mm();
        linear * m_per_rad * m_per_rad
    }

    /// Inertia at the shaft, kg m2, its standard error, and where it comes from.
    pub fn inertia(&self) -> (f64, Option<f64>, NumberSource) {
        let to_shaft =
            |inertia: f64| if self.facts.lead_mm_per_rev.is_some() { inertia } else { self.at_shaft(inertia) };
        if let Some(inertia) = self.facts.inertia {
            return (to_shaft(inertia), None, NumberSource::Given);
        }
        let torque = self.resolved.as_ref().and_then(|resolved| resolved.torque.as_ref());
        if let (Some(torque), Some(gain)) = (torque, self.facts.torque_gain) {
            // u = J a / g: N m for rad/s2 at the shaft, N for m/s2 of a linear axis.
            let per = if self.facts.lead_mm_per_rev.is_some() { self.rad_per_mm() } else { 1e-3 };
            let of = |units: f64| to_shaft((units * gain / per).abs());
            return (of(torque.units_per_mm_s2), Some(of(torque.units_error)), NumberSource::TorqueColumn);
        }
        (ASSUMED_INERTIA_KG_M2, None, NumberSource::Assumed)
    }

    /// Values of its law as far as it is told: with the window of the speed, where that is.
    pub fn law(&self) -> &TermValues {
        self.resolved.as_ref().map_or(&self.values, |resolved| &resolved.values)
    }

    /// Half of the interval of a term of this law.
    pub fn half_interval(&self, term: LawTerm) -> Option<f64> {
        let half = match &self.resolved {
            Some(resolved) => resolved.half_intervals.iter().find(|(of, _)| *of == term).map(|(_, half)| *half),
            None => self.terms.iter().position(|fitted| *fitted == term).map(|at| self.half_intervals[at]),
        };
        half.filter(|half| half.is_finite())
    }

    /// All numbers, those that positions determine first.
    pub fn numbers(&self) -> Vec<FoundNumber> {
        let told = self.law();
        let mut numbers: Vec<FoundNumber> = LawTerm::ALL
            .into_iter()
            .filter(|term| {
                let always = matches!(term, LawTerm::LoopGain | LawTerm::Damping | LawTerm::Coulomb | LawTerm::Offset);
                let needs = match term {
                    LawTerm::StribeckSpeed => told.get(LawTerm::Stribeck) > 0.0,
                    LawTerm::TableShare => told.get(LawTerm::Resonance) > 0.0,
                    _ => true,
                };
                (always || told.get(*term) != 0.0) && needs
            })
            .map(|term| self.number(term, told.get(term)))
            .collect();
        let (inertia, error, source) = self.inertia();
        let interval = error.map(|error| [inertia - 1.645 * error, inertia + 1.645 * error]);
        let number =
            |key, name, unit, value, interval, source| FoundNumber { key, name, unit, value, interval, source };
        numbers.push(number("inertia_kg_m2", "inertia J at the shaft", "kg m2", inertia, interval, source));
        let apart = self.gains_source();
        numbers.push(number("kp_1_s", "Kp", "1/s", told.kp_1_s(), None, apart));
        let kv = told.speed_gain_1_s() * inertia;
        let of_kv = if source == NumberSource::Assumed { NumberSource::Assumed } else { apart };
        numbers.push(number("kv_nm_s_per_rad", "Kv at the shaft", "N m s/rad", kv, None, of_kv));
        numbers
    }

    fn number(&self, term: LawTerm, value: f64) -> FoundNumber {
        let row = term.row();
        let source = match &self.resolved {
            _ if term == LawTerm::CommandDelay && self.facts.command_delay_s.is_some() => NumberSource::Given,
            _ if term == LawTerm::CommandDelay => NumberSource::Identified,
            Some(resolved) => resolved.source(term),
            None if self.terms.contains(&term) => NumberSource::Identified,
            None if self.facts.before.is_some() => NumberSource::Kept,
            None if term == LawTerm::Viscous || term == LawTerm::RecordDelay => NumberSource::Given,
            None => NumberSource::Assumed,
        };
        let [least, most] = row.range;
        let interval = self.half_interval(term).map(|half| [(value - half).max(least), (value + half).min(most)]);
        FoundNumber { key: term.key(), name: row.name, unit: row.unit, value, interval, source }
    }

    /// Whether Kp, Kv and B are told apart.
    pub fn gains_source(&self) -> NumberSource {
        if self.resolved.as_ref().is_some_and(|resolved| resolved.torque.is_some()) {
            NumberSource::TorqueColumn
        } else if self.facts.viscous.is_some() && self.facts.inertia.is_some() {
            NumberSource::Given
        } else if self.terms.contains(&LawTerm::Viscous) {
            NumberSource::Identified
        } else {
            NumberSource::Assumed
        }
    }

    /// Highest speed and acceleration of the command.
    pub(super) fn most(record: &AxisRecord<'_>) -> [f64; 2] {
        [record.command_speed_mm_s(), record.command_acceleration_mm_s2()]
            .map(|values| values.iter().fold(0.0_f64, |most, value| most.max(value.abs())))
    }
}
