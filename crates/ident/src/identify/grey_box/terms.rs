//! The numbers of an axis that commanded and actual positions determine, and the model that they
//! form.
//!
//! Everything is divided by the inertia, so that a torque is an acceleration of the table, mm/s2.
//! Positions determine
//!
//! ```text
//! Kp Kv / J    (Kv + B) / J    Fc / J    offset / J
//! ```
//!
//! and not J, nor Kp, Kv and B apart, unless the speed loop has an integral part or a limit. The
//! rest comes from outside: B / J is a number of its own here, zero where nobody knows it. Then Kv
//! / J = (Kv + B) / J - B / J, and Kp is the first over that.
//!
//! | Number | In the model of `crates/control/src/axis.rs` |
//! |---|---|
//! | lead | c(t - d): the record's actual positions are this much later than its commands |
//! | command delay | c(t - d) as well, in whole servo periods: the position loop is in the drive and has commands late |
//! | loop delay | between position loop and drive |
//! | feedforward | parts of speed and acceleration |
//! | integral | 1 / Ti |
//! | filter | time constant of the torque filter |
//! | window | (y(t) - y(t - T)) / T takes the place of the speed |
//! | hold | the drive takes the speed once a servo period, and not all the time |
//! | limits | of the reference speed, of the torque over the inertia |
//! | resonance, table share, backlash | motor and table as two masses, see `crates/control/src/axis/transmission.rs` |
//! | presliding, Stribeck | see `crates/control/src/axis/friction.rs` |

use std::f64::consts::TAU;

use feedwright_control::{Parameters, Part};
use feedwright_sim::{Axis, Transmission};

use super::axis_record::LATEST_S;
use crate::excite::MotionPart;

/// Properties of a term.
pub(super) struct TermRow {
    /// Key in files.
    key: &'static str,
    /// Name in reports.
    pub(super) name: &'static str,
    /// Unit.
    pub(super) unit: &'static str,
    pub(super) range: [f64; 2],
    /// Change for a difference: a part of the value, and at least so much.
    pub(super) change: [f64; 2],
    /// Kinds of motion that show it.
    shown_by: &'static [MotionPart],
    /// Value of an axis of a machine file with this servo period; `None` of an axis without it, and
    /// of what a log reaches or does not.
    of_axis: fn(&Axis, f64) -> Option<f64>,
    /// Expectation where nobody states the value.
    pub(super) expected: Option<Expected>,
    /// Values that the term is tried with.
    pub(super) tried: fn(&Tried) -> Vec<f64>,
    /// Key of a machine file that has the value times this, and the part of the axis that it
    /// belongs to. A term without it has a key of its own form.
    in_file: Option<(Part, &'static str, f64)>,
}

/// Expected value of a function of the terms, and its standard deviation.
#[derive(Debug, Clone, Copy)]
pub(super) enum Expected {
    /// Expected value and standard deviation.
    About(fn(&TermValues) -> f64, [f64; 2]),
    /// Typical value of what the logarithm is expected of, and the factor of a standard deviation.
    Size(fn(&TermValues) -> f64, [f64; 2]),
}

/// Properties of a record by which a term is tried.
pub(super) struct Tried {
    pub(super) sample_s: f64,
    pub(super) damping_1_s: f64,
    pub(super) fastest_mm_s: f64,
    pub(super) acceleration_mm_s2: f64,
}

impl TermRow {
    const fn new(
        [key, name, unit]: [&'static str; 3],
        range: [f64; 2],
        change: [f64; 2],
        shown_by: &'static [MotionPart],
        of_axis: fn(&Axis, f64) -> Option<f64>,
    ) -> Self {
        Self {
            key,
            name,
            unit,
            range,
            change,
            shown_by,
            of_axis,
            expected: None,
            tried: |_| Vec::new(),
            in_file: None,
        }
    }

    const fn expected(self, expected: Expected) -> Self {
        Self {
            expected: Some(expected),
            ..self
        }
    }

    const fn tried(self, tried: fn(&Tried) -> Vec<f64>) -> Self {
        Self { tried, ..self }
    }

    const fn in_file(self, part: Part, key: &'static str, scale: f64) -> Self {
        Self {
            in_file: Some((part, key, scale)),
            ..self
        }
    }
}

/// Makes [`ModelTerm`] and its rows.
macro_rules! terms {
    ($($(#[$doc:meta])* $term:ident $row:expr;)*) => {
        /// A number of an axis.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
        pub enum ModelTerm {
            $($(#[$doc])* $term,)*
        }

        const ROWS: &[TermRow] = &[$($row),*];

        impl ModelTerm {
            /// All, in the order of `TermValues`.
            pub const ALL: [Self; ROWS.len()] = [$(Self::$term),*];
        }
    };
}

terms! {
    /// Kp Kv / J, 1/s2.
    LoopGain TermRow::new(
        ["kp_kv_over_j_1_s2", "Kp Kv / J", "1/s2"],
        [0.1, 1e9], [0.01, 0.0], &[MotionPart::Reversals, MotionPart::Strokes],
        |axis, _| Some(axis.kp_1_s * axis.kv_nm_s_per_rad / axis.inertia_kg_m2),
    )
    .expected(Expected::Size(TermValues::kp_1_s, [50.0, 4.0]));
    /// (Kv + B) / J, 1/s.
    Damping TermRow::new(
        ["kv_plus_b_over_j_1_s", "(Kv + B) / J", "1/s"],
        [0.1, 1e5], [0.01, 0.0], &[MotionPart::Reversals, MotionPart::Strokes],
        |axis, _| Some((axis.kv_nm_s_per_rad + axis.viscous_friction_nm_s) / axis.inertia_kg_m2),
    )
    .expected(Expected::Size(|v| v.get(ModelTerm::Damping), [150.0, 5.0]));
    /// Fc / J, mm/s2.
    Coulomb TermRow::new(
        ["fc_over_j_mm_s2", "Fc / J", "mm/s2"],
        [0.0, 1e6], [0.02, 1.0], &[MotionPart::Creeping, MotionPart::Reversals],
        |axis, _| Some(axis.coulomb_friction_nm / nm_per_mm_s2(axis)),
    )
    .expected(Expected::Size(|v| v.get(ModelTerm::Coulomb).max(LEAST_SIZE), [50.0, 30.0]));
    /// Amount by which friction is higher in the positive direction and lower in the negative, over
    /// J, mm/s2.
    Offset TermRow::new(
        ["offset_over_j_mm_s2", "offset / J", "mm/s2"],
        [-1e6, 1e6], [0.0, 1.0], &[MotionPart::Creeping, MotionPart::Reversals],
        |axis, _| Some(axis.coulomb_asymmetry_nm / nm_per_mm_s2(axis)),
    )
    .expected(Expected::About(
        |v| v.get(ModelTerm::Offset) / (1.0 + v.get(ModelTerm::Coulomb)),
        [0.0, 0.3],
    ));
    /// Delay of the recorded actual position behind the command, s.
    RecordDelay TermRow::new(
        ["record_delay_s", "delay of the record", "s"],
        [-0.05, LATEST_S], [0.0, 5e-5], &[MotionPart::Strokes],
        |_, _| None,
    );
    /// Delay within the loop, s.
    LoopDelay TermRow::new(
        ["loop_delay_s", "delay within the loop", "s"],
        [0.0, 0.02], [0.0, 1e-4], &[MotionPart::Strokes],
        |axis, _| Some(axis.drive_delay_s),
    )
    .expected(Expected::About(|v| v.get(ModelTerm::LoopDelay), [0.0, 0.002]))
    .tried(|log| vec![0.5 * log.sample_s, 2.0 * log.sample_s]);
    /// Part of the command's speed that is fed forward.
    VelocityFeedforward TermRow::new(
        ["velocity_feedforward", "velocity feedforward", ""],
        [0.0, 2.0], [0.0, 0.01], &[MotionPart::Reversals],
        |axis, _| Some(axis.velocity_feedforward),
    )
    .expected(Expected::About(|v| v.get(ModelTerm::VelocityFeedforward), [0.5, 1.0]))
    .tried(|_| vec![0.3, 0.95])
    .in_file(Part::Drive, "velocity_feedforward", 1.0);
    /// Part of the command's acceleration that is fed forward.
    AccelerationFeedforward TermRow::new(
        ["acceleration_feedforward", "acceleration feedforward", ""],
        [0.0, 2.0], [0.0, 0.02], &[MotionPart::Strokes],
        |axis, _| Some(axis.acceleration_feedforward),
    )
    .expected(Expected::About(|v| v.get(ModelTerm::AccelerationFeedforward), [0.0, 0.7]))
    .tried(|_| vec![0.5])
    .in_file(Part::Drive, "acceleration_feedforward", 1.0);
    /// 1 / Ti of the speed loop, 1/s.
    Integral TermRow::new(
        ["inverse_integral_time_1_s", "1 / Ti", "1/s"],
        [0.0, 2000.0], [0.02, 0.2], &[MotionPart::Strokes],
        |axis, _| Some(inverse(axis.speed_integral_s)),
    )
    .expected(Expected::About(|v| v.get(ModelTerm::Integral), [0.0, 150.0]))
    .tried(|_| vec![10.0, 60.0]);
    /// Time constant of the torque filter, s.
    FilterTime TermRow::new(
        ["torque_filter_s", "torque filter", "s"], [0.0, 0.05], [0.0, 1e-4], &[MotionPart::Strokes],
        |axis, _| Some(inverse(axis.torque_filter_hz) / TAU),
    )
    .expected(Expected::About(|v| v.get(ModelTerm::FilterTime), [0.0, 5e-4]))
    .tried(|log| vec![0.2 * log.sample_s, log.sample_s]);
    /// Time over which the drive takes the speed from positions, s.
    SpeedWindow TermRow::new(
        ["speed_window_s", "window of the speed", "s"],
        [0.0, 0.02], [0.0, 1e-4], &[MotionPart::Strokes],
        |axis, _| Some(axis.speed_window_s),
    );
    /// Highest reference speed, mm/s; zero means no limit.
    SpeedLimit TermRow::new(
        ["speed_limit_mm_s", "speed limit", "mm/s"],
        [0.0, 1e4], [0.005, 0.0], &[MotionPart::Reversals],
        |axis, _| Some(axis.speed_limit_mm_s),
    )
    .tried(|log| vec![AT_LIMIT * log.fastest_mm_s])
    .in_file(Part::Drive, "speed_limit_mm_s", 1.0);
    /// Highest torque over the inertia, mm/s2; zero means no limit.
    AccelerationLimit TermRow::new(
        ["torque_limit_over_j_mm_s2", "torque limit / J", "mm/s2"],
        [0.0, 1e7], [0.01, 0.0], &[MotionPart::Strokes],
        |_, _| None,
    )
    .tried(|log| vec![0.9 * log.acceleration_mm_s2]);
    /// Deflection before friction slides, mm.
    Presliding TermRow::new(
        ["presliding_mm", "presliding", "mm"], [0.0, 1.0], [0.05, 2e-4], &[MotionPart::Creeping],
        |axis, _| Some(1e-3 * axis.presliding_um),
    )
    .expected(Expected::About(|v| v.get(ModelTerm::Presliding), [0.0, 0.03]))
    .tried(|_| vec![0.003, 0.03])
    .in_file(Part::Friction, "presliding_um", 1e3);
    /// Excess of friction at rest over Fc, as a part of Fc.
    Stribeck TermRow::new(
        ["stribeck_part", "Stribeck", ""], [0.0, 2.0], [0.0, 0.05], &[MotionPart::Creeping],
        |axis, _| Some(axis.stribeck_nm * inverse(axis.coulomb_friction_nm)),
    )
    .expected(Expected::About(|v| v.get(ModelTerm::Stribeck), [0.0, 0.5]))
    .tried(|_| vec![0.3]);
    /// Speed over which this excess decays, mm/s.
    StribeckSpeed TermRow::new(
        ["stribeck_mm_s", "Stribeck speed", "mm/s"],
        [0.2, 1e3], [0.1, 0.02], &[MotionPart::Creeping],
        |axis, _| Some(axis.stribeck_mm_s),
    )
    .expected(Expected::Size(|v| v.get(ModelTerm::StribeckSpeed).max(LEAST_SIZE), [2.0, 2.5]));
    /// B / J, 1/s.
    Viscous TermRow::new(
        ["b_over_j_1_s", "B / J", "1/s"], [0.0, 1e4], [0.02, 0.2], &[MotionPart::Reversals],
        |axis, _| Some(axis.viscous_friction_nm_s / axis.inertia_kg_m2),
    )
    .expected(Expected::About(
        |v| v.get(ModelTerm::Viscous) / v.get(ModelTerm::Damping),
        [0.0, 0.05],
    ))
    .tried(|log| vec![0.03 * log.damping_1_s]);
    /// Time constant of the resonance of the table on the screw, motor held: 1 / (2 pi f), s.
    Resonance TermRow::new(
        ["resonance_time_s", "time constant of the resonance", "s"],
        [0.0, 0.008], [0.03, 1e-5], &[MotionPart::Strokes],
        |axis, _| axis.transmission.map(|screw| 1.0 / (TAU * screw.resonance_hz)),
    )
    .tried(|_| vec![1.0 / (TAU * 40.0), 1.0 / (TAU * 90.0)]);
    /// Part of the inertia that is on the table's side of the screw.
    TableShare TermRow::new(
        ["table_share", "part of J at the table", ""],
        [0.05, 0.95], [0.0, 0.03], &[MotionPart::Strokes],
        |axis, _| axis.transmission.map(|screw| screw.table_share),
    );
    /// Backlash, mm.
    Backlash TermRow::new(
        ["backlash_mm", "backlash", "mm"], [0.0, 0.2], [0.05, 2e-4], &[MotionPart::Creeping],
        |axis, _| axis.transmission.map(|screw| 1e-3 * screw.backlash_um),
    )
    .tried(|_| vec![0.003, 0.02]);
    /// Servo period at which the drive takes the speed, s; zero is a drive that sees it all the
    /// time. Given, never fitted.
    SpeedHold TermRow::new(
        ["speed_hold_s", "the speed is taken every", "s"],
        [0.0, 0.1], [0.0, 1e-4], &[MotionPart::Strokes],
        |axis, servo_s| Some(if axis.speed_held { servo_s } else { 0.0 }),
    );
    /// Delay from the control to a position loop in the drive, s: whole servo periods. Chosen,
    /// never fitted.
    CommandDelay TermRow::new(
        ["command_delay_s", "delay before the position loop", "s"],
        [0.0, 0.02], [0.0, 1e-4], &[MotionPart::Strokes],
        |axis, servo_s| Some(axis.parameters().command_periods(servo_s) as f64 * servo_s),
    );
}

/// Number of terms.
pub(crate) const TERMS: usize = ROWS.len();

/// Below this a size has no logarithm to speak of.
const LEAST_SIZE: f64 = 1e-3;
/// Start of the fit of a limit of the speed, as a part of the highest speed.
pub(super) const AT_LIMIT: f64 = 0.97;

fn inverse(value: f64) -> f64 {
    if value > 0.0 { 1.0 / value } else { 0.0 }
}

/// Torque for an acceleration of the table, N m s2/mm.
fn nm_per_mm_s2(axis: &Axis) -> f64 {
    axis.inertia_kg_m2 * axis.rad_per_mm()
}

impl ModelTerm {
    /// Key in files.
    pub fn key(self) -> &'static str {
        self.row().key
    }

    /// Kinds of motion that show it.
    pub fn shown_by(self) -> &'static [MotionPart] {
        self.row().shown_by
    }

    /// Key of a machine file that has its value times a scale, and the part of the axis that it
    /// belongs to; `None` where a machine file has the value in another form.
    pub fn in_file(self) -> Option<(Part, &'static str, f64)> {
        self.row().in_file
    }

    /// Ends of the search for its value. B is part of Kv + B.
    pub(super) fn range(self, values: &TermValues) -> [f64; 2] {
        let [least, most] = self.row().range;
        [
            least,
            if self == Self::Viscous {
                (1.0 - LEAST_SPEED_GAIN) * values.get(Self::Damping)
            } else {
                most
            },
        ]
    }

    /// Returns true for a delay that begins at zero.
    pub(super) fn is_delay(self) -> bool {
        matches!(self, Self::LoopDelay | Self::CommandDelay)
    }

    pub(super) fn row(self) -> &'static TermRow {
        &ROWS[self as usize]
    }
}

/// A value for each number of an axis; zero is without it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TermValues(pub [f64; TERMS]);

impl TermValues {
    /// Returns the values of an axis of a machine file with this servo period. The torque limit is
    /// left out: the log reaches it or does not.
    pub fn of_axis(axis: &Axis, servo_s: f64) -> Self {
        ModelTerm::ALL
            .into_iter()
            .fold(Self([0.0; TERMS]), |values, term| {
                (term.row().of_axis)(axis, servo_s).map_or(values, |value| values.with(term, value))
            })
    }

    /// Returns the value of a term.
    pub fn get(&self, term: ModelTerm) -> f64 {
        self.0[term as usize]
    }

    /// Returns the values with another value of one term, held within its range.
    #[must_use]
    pub(crate) fn with(mut self, term: ModelTerm, value: f64) -> Self {
        let [least, most] = term.row().range;
        self.0[term as usize] = value.clamp(least, most);
        self
    }

    /// Kv / J, 1/s.
    pub fn speed_gain_1_s(&self) -> f64 {
        let damping = self.get(ModelTerm::Damping);
        // Below, the speed loop would drive.
        (damping - self.get(ModelTerm::Viscous)).max(LEAST_SPEED_GAIN * damping)
    }

    /// Returns the delay of the commands of the record at the position loop, s.
    pub fn commands_late_s(&self) -> f64 {
        self.get(ModelTerm::RecordDelay) + self.get(ModelTerm::CommandDelay)
    }

    /// Kp, 1/s.
    pub fn kp_1_s(&self) -> f64 {
        self.get(ModelTerm::LoopGain) / self.speed_gain_1_s()
    }

    /// Returns the parameters of the axis model for an inertia of 1 kg m2 and 1 rad/mm: a torque of
    /// 1 N m is 1 mm/s2.
    pub(super) fn parameters(&self, mechanics_s: f64) -> Parameters {
        let limit = self.get(ModelTerm::AccelerationLimit);
        let plain = Parameters {
            rad_per_mm: 1.0,
            kp_1_s: self.kp_1_s(),
            kv_nm_s_per_rad: self.speed_gain_1_s(),
            torque_limit_nm: if limit > 0.0 { limit } else { f64::MAX },
            inertia_kg_m2: 1.0,
            viscous_friction_nm_s: self.get(ModelTerm::Viscous),
            coulomb_friction_nm: self.get(ModelTerm::Coulomb),
            coulomb_smoothing_rad_s: self.smoothing_mm_s(mechanics_s),
            speed_integral_s: inverse(self.get(ModelTerm::Integral)),
            velocity_feedforward: self.get(ModelTerm::VelocityFeedforward),
            acceleration_feedforward: self.get(ModelTerm::AccelerationFeedforward),
            torque_filter_hz: inverse(self.get(ModelTerm::FilterTime)) / TAU,
            speed_limit_rad_s: self.get(ModelTerm::SpeedLimit),
            // A free run has the positions of the window.
            speed_window_s: 0.0,
            coulomb_asymmetry_nm: self.get(ModelTerm::Offset),
            stribeck_nm: self.get(ModelTerm::Stribeck) * self.get(ModelTerm::Coulomb),
            stribeck_rad_s: self.get(ModelTerm::StribeckSpeed),
            presliding_rad: self.get(ModelTerm::Presliding),
            ..Parameters::NOTHING
        };
        self.transmission(mechanics_s)
            .map_or(plain, |screw| Parameters {
                table_share: screw.table_share,
                resonance_rad_s: TAU * screw.resonance_hz,
                damping_ratio: screw.damping_ratio,
                backlash_rad: 1e-3 * screw.backlash_um,
                ..plain
            })
    }

    /// Speed over which friction without presliding turns its sign, mm/s: as tnv40's, and so much
    /// that a step of the integration does not go past it.
    pub fn smoothing_mm_s(&self, mechanics_s: f64) -> f64 {
        let most = self.get(ModelTerm::Coulomb) * (1.0 + self.get(ModelTerm::Stribeck));
        (2.0 * most * mechanics_s).max(SMOOTHING_MM_S)
    }

    /// Motor and table as two masses; none where the screw is rigid. In um where a machine file has
    /// um.
    pub fn transmission(&self, mechanics_s: f64) -> Option<Transmission> {
        let time_s = self.get(ModelTerm::Resonance);
        (time_s > STIFFEST * mechanics_s).then(|| Transmission {
            table_share: self.get(ModelTerm::TableShare),
            resonance_hz: 1.0 / (TAU * time_s),
            damping_ratio: ASSUMED_DAMPING_RATIO,
            backlash_um: 1e3 * self.get(ModelTerm::Backlash),
            scale_on_table: false,
        })
    }
}

/// Least part of the damping that the gain of the speed loop is.
const LEAST_SPEED_GAIN: f64 = 1e-3;

/// Damping of a screw that nobody has measured: of the size that machine tools have.
pub(crate) const ASSUMED_DAMPING_RATIO: f64 = 0.02;
/// Mechanics periods that the time constant of a resonance has at least: a stiffer screw is rigid.
const STIFFEST: f64 = 2.0;

/// Speed over which Coulomb friction changes its sign, mm/s: tnv40's, a millisecond of a reversal.
const SMOOTHING_MM_S: f64 = 0.08;

#[cfg(test)]
mod tests {
    use feedwright_sim::machine_keys;

    use super::*;

    #[test]
    fn a_key_that_a_term_names_is_a_key_of_a_machine_file() {
        let named: Vec<&str> = ModelTerm::ALL
            .iter()
            .filter_map(|term| term.in_file())
            .map(|(_, key, _)| key)
            .collect();
        let is_there = |key: &&str| {
            machine_keys::AXIS
                .iter()
                .any(|of_file| of_file.name == *key)
        };
        assert!(!named.is_empty() && named.iter().all(is_there), "{named:?}");
    }
}
