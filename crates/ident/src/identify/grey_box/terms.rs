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

use feedwright_control::Parameters;
use feedwright_sim::{Axis, Transmission};

use super::axis_record::LATEST_S;

/// A number of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ModelTerm {
    /// Kp Kv / J, 1/s2.
    LoopGain,
    /// (Kv + B) / J, 1/s.
    Damping,
    /// Fc / J, mm/s2.
    Coulomb,
    /// Amount by which friction is higher in the positive direction and lower in the negative, over
    /// J, mm/s2.
    Offset,
    /// Delay of the recorded actual position behind the command, s.
    RecordDelay,
    /// Delay within the loop, s.
    LoopDelay,
    /// Part of the command's speed that is fed forward.
    VelocityFeedforward,
    /// Part of the command's acceleration that is fed forward.
    AccelerationFeedforward,
    /// 1 / Ti of the speed loop, 1/s.
    Integral,
    /// Time constant of the torque filter, s.
    FilterTime,
    /// Time over which the drive takes the speed from positions, s.
    SpeedWindow,
    /// Highest reference speed, mm/s; zero means no limit.
    SpeedLimit,
    /// Highest torque over the inertia, mm/s2; zero means no limit.
    AccelerationLimit,
    /// Deflection before friction slides, mm.
    Presliding,
    /// Excess of friction at rest over Fc, as a part of Fc.
    Stribeck,
    /// Speed over which this excess decays, mm/s.
    StribeckSpeed,
    /// B / J, 1/s.
    Viscous,
    /// Time constant of the resonance of the table on the screw, motor held: 1 / (2 pi f), s.
    Resonance,
    /// Part of the inertia that is on the table's side of the screw.
    TableShare,
    /// Backlash, mm.
    Backlash,
    /// Servo period at which the drive takes the speed, s; zero is a drive that sees it all the
    /// time. Given, never fitted.
    SpeedHold,
    /// Delay from the control to a position loop in the drive, s: whole servo periods. Chosen,
    /// never fitted.
    CommandDelay,
}

/// Number of terms.
pub(crate) const TERMS: usize = 22;

/// Range of a number, and its change for a difference.
#[derive(Debug, Clone, Copy)]
pub(super) struct TermRow {
    /// Name in reports.
    pub(super) name: &'static str,
    /// Unit.
    pub(super) unit: &'static str,
    pub(super) range: [f64; 2],
    /// Change for a difference: a part of the value, and at least so much.
    pub(super) change: [f64; 2],
}

impl ModelTerm {
    /// All, in the order of `TermValues`.
    pub const ALL: [Self; TERMS] = [
        Self::LoopGain,
        Self::Damping,
        Self::Coulomb,
        Self::Offset,
        Self::RecordDelay,
        Self::LoopDelay,
        Self::VelocityFeedforward,
        Self::AccelerationFeedforward,
        Self::Integral,
        Self::FilterTime,
        Self::SpeedWindow,
        Self::SpeedLimit,
        Self::AccelerationLimit,
        Self::Presliding,
        Self::Stribeck,
        Self::StribeckSpeed,
        Self::Viscous,
        Self::Resonance,
        Self::TableShare,
        Self::Backlash,
        Self::SpeedHold,
        Self::CommandDelay,
    ];

    /// Key in files.
    pub fn key(self) -> &'static str {
        match self {
            Self::LoopGain => "kp_kv_over_j_1_s2",
            Self::Damping => "kv_plus_b_over_j_1_s",
            Self::Coulomb => "fc_over_j_mm_s2",
            Self::Offset => "offset_over_j_mm_s2",
            Self::RecordDelay => "record_delay_s",
            Self::LoopDelay => "loop_delay_s",
            Self::VelocityFeedforward => "velocity_feedforward",
            Self::AccelerationFeedforward => "acceleration_feedforward",
            Self::Integral => "inverse_integral_time_1_s",
            Self::FilterTime => "torque_filter_s",
            Self::SpeedWindow => "speed_window_s",
            Self::SpeedLimit => "speed_limit_mm_s",
            Self::AccelerationLimit => "torque_limit_over_j_mm_s2",
            Self::Presliding => "presliding_mm",
            Self::Stribeck => "stribeck_part",
            Self::StribeckSpeed => "stribeck_mm_s",
            Self::Viscous => "b_over_j_1_s",
            Self::Resonance => "resonance_time_s",
            Self::TableShare => "table_share",
            Self::Backlash => "backlash_mm",
            Self::SpeedHold => "speed_hold_s",
            Self::CommandDelay => "command_delay_s",
        }
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

    pub(super) fn row(self) -> TermRow {
        let row = |name, unit, range, change| TermRow {
            name,
            unit,
            range,
            change,
        };
        match self {
            Self::LoopGain => row("Kp Kv / J", "1/s2", [0.1, 1e9], [0.01, 0.0]),
            Self::Damping => row("(Kv + B) / J", "1/s", [0.1, 1e5], [0.01, 0.0]),
            Self::Coulomb => row("Fc / J", "mm/s2", [0.0, 1e6], [0.02, 1.0]),
            Self::Offset => row("offset / J", "mm/s2", [-1e6, 1e6], [0.0, 1.0]),
            Self::RecordDelay => row("delay of the record", "s", [-0.05, LATEST_S], [0.0, 5e-5]),
            Self::LoopDelay => row("delay within the loop", "s", [0.0, 0.02], [0.0, 1e-4]),
            Self::VelocityFeedforward => row("velocity feedforward", "", [0.0, 2.0], [0.0, 0.01]),
            Self::AccelerationFeedforward => {
                row("acceleration feedforward", "", [0.0, 2.0], [0.0, 0.02])
            }
            Self::Integral => row("1 / Ti", "1/s", [0.0, 2000.0], [0.02, 0.2]),
            Self::FilterTime => row("torque filter", "s", [0.0, 0.05], [0.0, 1e-4]),
            Self::SpeedWindow => row("window of the speed", "s", [0.0, 0.02], [0.0, 1e-4]),
            Self::SpeedLimit => row("speed limit", "mm/s", [0.0, 1e4], [0.005, 0.0]),
            Self::AccelerationLimit => row("torque limit / J", "mm/s2", [0.0, 1e7], [0.01, 0.0]),
            Self::Presliding => row("presliding", "mm", [0.0, 1.0], [0.05, 2e-4]),
            Self::Stribeck => row("Stribeck", "", [0.0, 2.0], [0.0, 0.05]),
            Self::StribeckSpeed => row("Stribeck speed", "mm/s", [0.2, 1e3], [0.1, 0.02]),
            Self::Viscous => row("B / J", "1/s", [0.0, 1e4], [0.02, 0.2]),
            Self::Resonance => row(
                "time constant of the resonance",
                "s",
                [0.0, 0.008],
                [0.03, 1e-5],
            ),
            Self::TableShare => row("part of J at the table", "", [0.05, 0.95], [0.0, 0.03]),
            Self::Backlash => row("backlash", "mm", [0.0, 0.2], [0.05, 2e-4]),
            Self::SpeedHold => row("the speed is taken every", "s", [0.0, 0.1], [0.0, 1e-4]),
            Self::CommandDelay => row(
                "delay before the position loop",
                "s",
                [0.0, 0.02],
                [0.0, 1e-4],
            ),
        }
    }
}

/// A value for each number of an axis; zero is without it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TermValues(pub [f64; TERMS]);

impl TermValues {
    /// Returns the values of an axis of a machine file with this servo period. The torque limit is
    /// left out: the log reaches it or does not.
    pub fn of_axis(axis: &Axis, servo_s: f64) -> Self {
        let j = axis.inertia_kg_m2;
        let per_mm = j * axis.rad_per_mm();
        let inverse = |value: f64| if value > 0.0 { 1.0 / value } else { 0.0 };
        let plain = Self([0.0; TERMS])
            .with(ModelTerm::LoopGain, axis.kp_1_s * axis.kv_nm_s_per_rad / j)
            .with(
                ModelTerm::Damping,
                (axis.kv_nm_s_per_rad + axis.viscous_friction_nm_s) / j,
            )
            .with(ModelTerm::Viscous, axis.viscous_friction_nm_s / j)
            .with(ModelTerm::Coulomb, axis.coulomb_friction_nm / per_mm)
            .with(ModelTerm::Offset, axis.coulomb_asymmetry_nm / per_mm)
            .with(
                ModelTerm::CommandDelay,
                axis.parameters().command_periods(servo_s) as f64 * servo_s,
            )
            .with(ModelTerm::LoopDelay, axis.drive_delay_s)
            .with(ModelTerm::VelocityFeedforward, axis.velocity_feedforward)
            .with(
                ModelTerm::AccelerationFeedforward,
                axis.acceleration_feedforward,
            )
            .with(ModelTerm::Integral, inverse(axis.speed_integral_s))
            .with(
                ModelTerm::FilterTime,
                inverse(axis.torque_filter_hz) / std::f64::consts::TAU,
            )
            .with(ModelTerm::SpeedLimit, axis.speed_limit_mm_s)
            .with(ModelTerm::SpeedWindow, axis.speed_window_s)
            .with(
                ModelTerm::SpeedHold,
                if axis.speed_held { servo_s } else { 0.0 },
            )
            .with(ModelTerm::Presliding, 1e-3 * axis.presliding_um)
            .with(
                ModelTerm::Stribeck,
                axis.stribeck_nm * inverse(axis.coulomb_friction_nm),
            )
            .with(ModelTerm::StribeckSpeed, axis.stribeck_mm_s);
        axis.transmission.map_or(plain, |screw| {
            plain
                .with(
                    ModelTerm::Resonance,
                    1.0 / (std::f64::consts::TAU * screw.resonance_hz),
                )
                .with(ModelTerm::TableShare, screw.table_share)
                .with(ModelTerm::Backlash, 1e-3 * screw.backlash_um)
        })
    }

    /// Returns the value of a term.
    pub fn get(&self, term: ModelTerm) -> f64 {
        self.0[term as usize]
    }

    /// Returns the values with another value of one term, held within its range.
    #[must_use]
    pub fn with(mut self, term: ModelTerm, value: f64) -> Self {
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
        let inverse = |value: f64| if value > 0.0 { 1.0 / value } else { 0.0 };
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
            torque_filter_hz: inverse(self.get(ModelTerm::FilterTime)) / std::f64::consts::TAU,
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
                resonance_rad_s: std::f64::consts::TAU * screw.resonance_hz,
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
            resonance_hz: 1.0 / (std::f64::consts::TAU * time_s),
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
