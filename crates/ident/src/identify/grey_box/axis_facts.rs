//! What is known of an axis beside its record.

use feedwright_sim::Axis;

use super::known_value::KnownValue;
use super::terms::{ModelTerm, TermValues};

/// Facts that are known of an axis besides the record.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AxisFacts {
    /// Inertia at the motor shaft, kg m2, or mass of a linear axis, kg.
    pub inertia: Option<f64>,
    /// Viscous friction, N m s/rad at the shaft, or N s/m of a linear axis.
    pub viscous: Option<f64>,
    /// Travel for a turn of the motor, mm; none is a linear axis.
    pub lead_mm_per_rev: Option<f64>,
    /// Torque, N m at the shaft, or force, N of a linear axis, for a unit of the torque column.
    pub torque_gain: Option<f64>,
    /// Time over which the drive takes the speed from positions, s, of a drive that closes its
    /// loops once a servo period and records itself.
    pub speed_window_s: Option<f64>,
    /// Delay of the recorded actual position behind the command, s: zero where both were sampled at
    /// the same moment. Any other delay is then in the drive.
    pub record_delay_s: Option<f64>,
    /// Delay from the control to a position loop in the drive, s. Without it, the delay is searched
    /// where [`Self::record_delay_s`] is given; the log alone does not separate the two.
    pub command_delay_s: Option<f64>,
    /// Position gain, 1/s.
    pub kp_1_s: Option<KnownValue>,
    /// 1 / Ti of the speed loop, 1/s; 0 is a loop without integral.
    pub inverse_integral_1_s: Option<KnownValue>,
    /// Part of the command's speed that is fed forward.
    pub velocity_feedforward: Option<KnownValue>,
    /// Part of the command's acceleration that is fed forward.
    pub acceleration_feedforward: Option<KnownValue>,
    /// Delay from the position loop to the drive, s.
    pub drive_delay_s: Option<KnownValue>,
    /// Signal period of the encoder, mm of travel. Without it, the record has to show it.
    pub signal_period_mm: Option<f64>,
    /// Periods of the cogging in a turn of the motor. Without it, the record has to show it.
    pub cogging_per_rev: Option<f64>,
    /// Model from an earlier log. Terms that this log does not determine keep its values.
    pub before: Option<TermValues>,
}

impl AxisFacts {
    /// B / J, 1/s, where both are given.
    pub(super) fn viscous_1_s(&self) -> Option<f64> {
        Some(self.viscous? / self.inertia?)
    }

    /// Returns the stated value of a term, or the position gain for the gain of both loops.
    pub(super) fn known(&self, term: ModelTerm) -> Option<KnownValue> {
        match term {
            ModelTerm::LoopGain => self.kp_1_s,
            ModelTerm::Integral => self.inverse_integral_1_s,
            ModelTerm::VelocityFeedforward => self.velocity_feedforward,
            ModelTerm::AccelerationFeedforward => self.acceleration_feedforward,
            ModelTerm::LoopDelay => self.drive_delay_s,
            _ => None,
        }
    }

    /// Values to begin a fit with: those that are known, and others.
    pub(super) fn start(&self, mut at: TermValues) -> TermValues {
        if self.before.is_none()
            && let Some(viscous_1_s) = self.viscous_1_s()
        {
            at = at.with(ModelTerm::Viscous, viscous_1_s);
        }
        for term in ModelTerm::ALL {
            at = self.known(term).map_or(at, |known| match term {
                ModelTerm::LoopGain => at.with(term, known.value * at.speed_gain_1_s()),
                _ => at.with(term, known.value),
            });
        }
        at = self
            .command_delay_s
            .map_or(at, |delay_s| at.with(ModelTerm::CommandDelay, delay_s));
        at.with(ModelTerm::RecordDelay, self.record_delay_s.unwrap_or(0.0))
    }

    /// Fills in unstated values from an axis of a machine file with this servo period.
    #[must_use]
    pub fn or_of(self, axis: &Axis, servo_s: f64) -> Self {
        let is_same_unit =
            self.lead_mm_per_rev.is_some() || (self.inertia.is_none() && self.viscous.is_none());
        let stated = |value: f64| Some(value).filter(|value| *value > 0.0);
        let kept = |given: Option<f64>, axis: f64| given.or_else(|| is_same_unit.then_some(axis));
        Self {
            inertia: kept(self.inertia, axis.inertia_kg_m2),
            viscous: kept(self.viscous, axis.viscous_friction_nm_s),
            lead_mm_per_rev: kept(self.lead_mm_per_rev, axis.lead_mm_per_rev),
            signal_period_mm: self
                .signal_period_mm
                .or_else(|| stated(1e-3 * axis.signal_period_um)),
            cogging_per_rev: self.cogging_per_rev.or_else(|| {
                let is_same_lead = self
                    .lead_mm_per_rev
                    .is_none_or(|lead| lead == axis.lead_mm_per_rev);
                stated(axis.cogging_per_rev).filter(|_| is_same_lead)
            }),
            before: Some(TermValues::of_axis(axis, servo_s)),
            ..self
        }
    }
}
