//! The numbers of an axis: the one table that machine files, model files, model blocks, plant and
//! controllers read.
//!
//! A row has the number as a machine file states it, and after `=>` the number that the equations
//! take: at the motor shaft, with its place in a model block. Where both differ, the row ends with
//! the second as a function of the first. A key that `needs` another says how much, the other over
//! what.
//!
//! ```text
//! key  kind  unit  [least, most]  words  (needs key)?
//!     => { place  part  number  unit?  rule [least, most]?  format  (words, function)? }
//! ```
//!
//! | Kind of a key | Left out |
//! |---|---|
//! | `required` | is a fault |
//! | `or_zero` | is zero, which is an axis without it |
//! | `flag` | is 0; the other value is 1 |
//! | `optional`, `bits` | has no value |
//!
//! | Rule of a number | In a model |
//! |---|---|
//! | `within` | within its range |
//! | `or_none` | within its range, or zero, which is an axis without it |
//! | `newer` | as `within`; a model file from before it leaves it out |
//!
//! A new number is one row here, its equation, and a line in each of the documents.

/// Passes the table to a macro: the keys of `[axis.x]` and those of `[axis.x.transmission]`.
#[doc(hidden)]
#[macro_export]
macro_rules! axis_numbers {
    ($of:ident) => {
        $of! {
            axis {
                lead_mm_per_rev required "mm/rev" [0.01, 1e3] "Travel for one motor turn"
                    => { 0 Loops rad_per_mm "rad/mm" within [1e-3, 1e3] 2
                        ("Turn of the motor for a travel of the table", Axis::rad_per_mm) };
                inertia_kg_m2 required "kg m2" [1e-9, 1e3] "Inertia at the motor shaft"
                    => { 13 Loops inertia_kg_m2 within 2 };
                viscous_friction_nm_s required "N m s/rad" [0.0, 1e4] "Viscous friction"
                    => { 14 Loops viscous_friction_nm_s within 2 };
                coulomb_friction_nm required "N m" [0.0, 1e5] "Coulomb friction torque"
                    => { 15 Loops coulomb_friction_nm within 2 };
                coulomb_smoothing_rad_s required "rad/s" [1e-6, 1e3]
                    "Speed over which the Coulomb torque turns its sign"
                    => { 16 Loops coulomb_smoothing_rad_s within 2 };
                disturbance_nm required "N m" [0.0, 1e5] "Amplitude of the disturbance torque"
                    => { 32 Noise disturbance_nm within 2 };
                disturbance_hz required "Hz" [0.0, 1e5] "Frequency of the disturbance torque"
                    => { 33 Noise disturbance_rad_s "rad/s" within [0.0, 1e6] 2
                        ("Frequency of the disturbance torque", |axis| TAU * axis.disturbance_hz) };
                kp_1_s required "1/s" [1e-3, 1e5] "Proportional gain of the position loop"
                    => { 1 Loops kp_1_s within 2 };
                kd required "(no unit)" [0.0, 1e3]
                    "Derivative gain of the position loop: rad/s of command for a rad/s of error \
rate"
                    => { 2 Loops kd "" within 2 };
                kv_nm_s_per_rad required "N m s/rad" [1e-9, 1e6] "Gain of the speed loop"
                    => { 3 Loops kv_nm_s_per_rad within 2 };
                torque_limit_nm required "N m" [1e-6, 1e6] "Torque at which the drive saturates"
                    => { 4 Loops torque_limit_nm within 2 };
                command_delay_s or_zero "s" [0.0, 0.02]
                    "Delay between the control and the position loop, rounded to whole servo \
periods"
                    => { 38 Delays command_delay_s newer 3 };
                drive_delay_s or_zero "s" [0.0, 0.02]
                    "Delay between the position loop and the drive"
                    => { 11 Delays drive_delay_s within 2 };
                torque_bits bits "bits" [4.0, 32.0]
                    "Width of the torque command over the range from minus to plus the torque \
limit; none is without steps";
                correction_accel_mm_s2 optional "mm/s2" [0.1, 1e6]
                    "Acceleration that a correction of the command may add to the plan's; none is \
no limit in the loop, and the machine's normal acceleration for a correction \
that fades";
                encoder_step_um or_zero "um" [0.0, 1e3]
                    "Step of the position encoder; zero is without steps"
                    => { 26 Noise encoder_step_rad "rad" within [0.0, 1e3] 2
                        ("Step of the encoder", |axis| axis.rad(axis.encoder_step_um)) };
                speed_integral_s or_zero "s" [0.0, 10.0]
                    "Integral time of the speed loop; here and below zero is without"
                    => { 5 Drive speed_integral_s or_none [1e-6, 10.0] 2 };
                velocity_feedforward or_zero "(no unit)" [0.0, 2.0]
                    "Share of the command's speed that goes to the speed loop"
                    => { 6 Drive velocity_feedforward "" within 2 };
                acceleration_feedforward or_zero "(no unit)" [0.0, 2.0]
                    "Share of the torque for the command's acceleration that goes to the torque"
                    => { 7 Drive acceleration_feedforward "" within [0.0, 1e3] 2 };
                torque_filter_hz or_zero "Hz" [0.0, 1e5] "Corner of the torque filter"
                    => { 8 Drive torque_filter_hz or_none [1e-3, 1e5] 2 };
                speed_limit_mm_s or_zero "mm/s" [0.0, 1e4] "Highest reference speed of the drive"
                    => { 9 Drive speed_limit_rad_s "rad/s" or_none [1e-5, 1e7] 2
                        ("Highest reference speed",
                        |axis| axis.speed_limit_mm_s * axis.rad_per_mm()) };
                speed_from_encoder flag "(0 or 1)" [0.0, 1.0]
                    "True if the speed loop computes the speed from differences of the encoder";
                speed_window_s or_zero "s" [0.0, 0.02]
                    "Time over which the drive takes the speed from positions; no more than a \
mechanics period is the speed itself"
                    => { 10 Drive speed_window_s newer [0.0, 0.2] 2 };
                speed_held flag "(0 or 1)" [0.0, 1.0]
                    "True if the drive samples the speed at the start of each servo period and \
holds it";
                encoder_noise_um or_zero "um" [0.0, 1e3] "RMS of white noise of the encoder"
                    => { 25 Noise encoder_noise_rad "rad" within [0.0, 1e3] 2
                        ("RMS of the encoder's white noise",
                        |axis| axis.rad(axis.encoder_noise_um)) };
                interpolation_error_um or_zero "um" [0.0, 1e3]
                    "Amplitude of the encoder's error within a signal period" needs signal_period_um
                    => { 27 Noise interpolation_rad "rad" within [0.0, 1e3] 2
                        ("Amplitude of the encoder's error within a signal period",
                        |axis| axis.rad(axis.interpolation_error_um)) };
                signal_period_um or_zero "um" [0.0, 1e5] "Signal period of the encoder"
                    => { 29 Noise signal_per_rad "1/rad" within [0.0, 1e9] 2
                        ("Signal periods in a radian, times 2 pi", Axis::signal_per_rad) };
                interpolation_phase_rad or_zero "rad" [-10.0, 10.0]
                    "Phase of this error where the axis and the angle of the motor are zero"
                    => { 28 Noise interpolation_phase_rad within 2 };
                measurement_delay_s or_zero "s" [0.0, 0.02] "Latency of the measured position"
                    => { 12 Delays measurement_delay_s within 2 };
                jitter_s or_zero "s" [0.0, 0.02]
                    "Largest extra delay of a reference on its way to the drive";
                coulomb_asymmetry_nm or_zero "N m" [-1e5, 1e5]
                    "Excess of the Coulomb friction in the positive direction; in the negative \
direction it is lower by the same amount"
                    => { 17 Friction coulomb_asymmetry_nm within 2 };
                stribeck_nm or_zero "N m" [0.0, 1e5]
                    "Excess of the friction at rest over the Coulomb friction" needs stribeck_mm_s
                    => { 18 Friction stribeck_nm within 2 };
                stribeck_mm_s or_zero "mm/s" [0.0, 1e4] "Speed over which this excess decays"
                    => { 19 Friction stribeck_rad_s "rad/s" or_none [1e-6, 1e7] 2
                        ("Speed over which the Stribeck part decays",
                        |axis| axis.stribeck_mm_s * axis.rad_per_mm()) };
                presliding_um or_zero "um" [0.0, 1e4] "Deflection before friction slides"
                    => { 20 Friction presliding_rad "rad" or_none [1e-12, 1e4] 2
                        ("Deflection before the axis slides",
                        |axis| axis.rad(axis.presliding_um)) };
                cogging_nm or_zero "N m" [0.0, 1e5]
                    "Amplitude of the cogging torque" needs cogging_per_rev
                    => { 35 Noise cogging_nm within 2 };
                cogging_per_rev or_zero "1/rev" [0.0, 1e4] "Periods of the cogging torque in a turn"
                    => { 37 Noise cogging_per_rev within 2 };
                cogging_phase_rad or_zero "rad" [-10.0, 10.0]
                    "Phase of the cogging torque where the axis and the angle of the motor are zero"
                    => { 36 Noise cogging_phase_rad within 2 };
                ripple or_zero "(no unit)" [0.0, 1.0]
                    "Amplitude of the torque ripple, part of the torque" needs ripple_per_rev;
                ripple_per_rev or_zero "1/rev" [0.0, 1e4] "Periods of the torque ripple in a turn";
                torque_noise_nm or_zero "N m" [0.0, 1e5] "RMS of the broadband torque"
                    => { 30 Noise torque_noise_nm within 2 };
                torque_noise_s or_zero "s" [0.0, 10.0] "Correlation time of the broadband torque"
                    => { 31 Noise torque_noise_s or_none [1e-9, 10.0] 2 };
                disturbance_wander or_zero "(no unit)" [0.0, 0.5]
                    "RMS variation of the disturbance's frequency, part of it"
                    => { 34 Noise disturbance_wander "" within 2 };
                scale_um_m or_zero "um/m" [-1e4, 1e4]
                    "Scale error: extra travel of the tool beyond the encoder reading";
                pitch_error_um or_zero "um" [0.0, 1e3]
                    "Amplitude of the error within a turn of the screw";
                max_velocity_mm_s optional "mm/s" [0.01, 1e4]
                    "Highest speed, for planners that plan axis by axis; none is what limits and \
drive allow";
                max_accel_mm_s2 optional "mm/s2" [0.1, 1e6]
                    "Highest acceleration, for the same planners";
                max_jerk_mm_s3 optional "mm/s3" [1.0, 1e9] "Highest jerk, for the same planners";
            }
            transmission {
                table_share required "(no unit)" [0.01, 0.99]
                    "Part of the axis's inertia on the table's side"
                    => { 21 Screw table_share "" or_none 2 };
                resonance_hz required "Hz" [0.1, 1e4]
                    "Resonance of the table on the screw while the motor is held"
                    => { 22 Screw resonance_rad_s "rad/s" or_none [1e-1, 1e6] 2
                        ("Resonance of the table on the screw while the motor is held",
                        |_, screw| TAU * screw.resonance_hz) };
                damping_ratio required "(no unit)" [0.0, 1.0] "Damping ratio of that resonance"
                    => { 23 Screw damping_ratio "" within 2 };
                backlash_um required "um" [0.0, 1e4] "Backlash"
                    => { 24 Screw backlash_rad "rad" within [0.0, 1e3] 2
                        ("Backlash",
                        |axis, screw| screw.backlash_um * 1e-3 * TAU / axis.lead_mm_per_rev) };
                scale_on_table flag "(0 or 1)" [0.0, 1.0]
                    "True if the position is measured at the table (a linear scale) instead of \
the motor";
            }
        }
    };
}

/// Part of an axis that a number belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// Loops and masses: what every axis has.
    Loops,
    /// Drive in addition to the gains of its loops.
    Drive,
    /// Delays of commands, references and positions.
    Delays,
    /// Friction in addition to Coulomb and viscous friction.
    Friction,
    /// Ball screw.
    Screw,
    /// Noise, and what depends on the angle of the motor.
    Noise,
}

/// A number of an axis.
#[derive(Debug, Clone, Copy)]
pub struct Number {
    /// Name, which ends in the unit.
    pub name: &'static str,
    /// Unit for messages; empty for a dimensionless number.
    pub unit: &'static str,
    /// Smallest and largest value.
    pub range: [f64; 2],
    /// True if zero is valid although it is below the range. Zero then means that the axis lacks
    /// this part. Other values below the range are rejected, so that nothing is divided by a tiny
    /// number.
    pub or_none: bool,
    /// True if a model file may omit it: files from before this number existed lack it. It is then
    /// zero.
    pub optional: bool,
    /// First format of a model block that has this number. An earlier block leaves it zero.
    pub(crate) format: u32,
    /// Field of the axis.
    pub of: fn(&mut Parameters) -> &mut f64,
}

impl Number {
    /// Returns true if the number may have this value. NaN is never valid.
    pub fn holds(&self, value: f64) -> bool {
        let [least, most] = self.range;
        (value >= least && value <= most) || (self.or_none && value == 0.0)
    }
}

/// The first of one or two.
macro_rules! first {
    ($first:tt $($second:tt)?) => {
        $first
    };
}

/// True for two equal words.
macro_rules! is {
    (newer newer) => {
        true
    };
    (or_none or_none) => {
        true
    };
    ($one:ident $other:ident) => {
        false
    };
}

/// Makes [`Parameters`] of the table.
macro_rules! parameters {
    (
        axis { $(
            $key:ident $kind:ident $unit:literal $range:tt $words:literal $(needs $needed:ident)?
            $(=> { $($number:tt)* })?;
        )* }
        transmission { $(
            $screw:ident $screw_kind:ident $screw_unit:literal $screw_range:tt $screw_words:literal
            $(=> { $($of_screw:tt)* })?;
        )* }
    ) => {
        parameters! { @
            $($({ $unit $range $words $($number)* })?)*
            $($({ $screw_unit $screw_range $screw_words $($of_screw)* })?)*
        }
    };
    (@ $({
        $key_unit:literal $key_range:tt $key_words:literal
        $place:literal $part:ident $name:ident $($unit:literal)?
        $rule:ident $([$least:expr, $most:expr])? $format:literal
        $(($words:literal, $of:expr))?
    })*) => {
        /// The numbers of an axis at the motor shaft. Zero omits a part.
        #[derive(Debug, Clone, Copy, Default, PartialEq)]
        pub struct Parameters {
            $(#[doc = concat!(first!($($words)? $key_words), ".")] pub $name: f64,)*
        }

        impl Parameters {
            /// Placeholder axis: every number is zero.
            pub const NOTHING: Self = Self { $($name: 0.0),* };

            /// Stored numbers of an axis, in the order of a model block. The ranges are the ranges
            /// of a machine file, and exclude values that computation cannot use.
            pub const NUMBERS: &[Number] = &{
                let none = Number {
                    name: "",
                    unit: "",
                    range: [0.0; 2],
                    or_none: false,
                    optional: false,
                    format: 0,
                    of: |axis| &mut axis.kd,
                };
                let mut numbers = [none; [$($place),*].len()];
                $(
                    assert!(numbers[$place].name.is_empty(), "two numbers in one place");
                    numbers[$place] = Number {
                        name: stringify!($name),
                        unit: first!($($unit)? $key_unit),
                        range: first!($([$least, $most])? $key_range),
                        or_none: is!($rule or_none),
                        optional: is!($rule newer),
                        format: $format,
                        of: |axis| &mut axis.$name,
                    };
                )*
                numbers
            };

            /// Returns true if the axis has any number of a part.
            pub fn has(&self, part: Part) -> bool {
                $((part == Part::$part && self.$name != 0.0))||*
            }

            /// Returns the axis with these parts of another.
            #[must_use]
            pub fn taking(mut self, parts: &[Part], other: &Self) -> Self {
                $(if parts.contains(&Part::$part) {
                    self.$name = other.$name;
                })*
                self
            }
        }
    };
}

axis_numbers!(parameters);

impl Parameters {
    /// Returns true if a command can follow the drive. With a damping below 0.3 the acceleration
    /// feedforward makes the offset ring and take all the torque: random machines with 0.7 of it
    /// and no velocity feedforward reached 2 mm, where 6 um remained uncorrected.
    pub fn is_followed(&self) -> bool {
        self.command_damping() >= LEAST_DAMPING
    }

    /// Returns the damping ratio of the command that asks the drive for a given speed:
    ///
    /// ```text
    /// w = kp (c - x) + F c' + (J A / Kv) c''      zeta = F / (2 (kp J A / Kv)^(1/2))
    /// ```
    ///
    /// with the position gain kp, the velocity feedforward F and the acceleration feedforward A.
    /// Infinite without A. Where it is low, the command rings.
    fn command_damping(&self) -> f64 {
        let added_s = self.inertia_kg_m2 * self.acceleration_feedforward / self.kv_nm_s_per_rad;
        if added_s > 0.0 {
            self.velocity_feedforward / (2.0 * libm::sqrt(self.kp_1_s * added_s))
        } else {
            f64::INFINITY
        }
    }

    /// Returns the axis without these parts.
    #[must_use]
    pub fn without(self, parts: &[Part]) -> Self {
        self.taking(parts, &Self::NOTHING)
    }

    /// Returns true if each of its numbers is within its range.
    pub fn is_possible(mut self) -> bool {
        Self::NUMBERS
            .iter()
            .all(|number| number.holds(*(number.of)(&mut self)))
    }
}

/// Smallest damping of a command that follows a drive.
const LEAST_DAMPING: f64 = 0.3;

/// Smallest gain of a position loop, 1/s. An axis with it takes 9 s to come within 1 % of a new
/// position, and lags by 33 mm at 1 m/min; the slowest machine tools have ten times this gain. A
/// gain in 1/ms, or a gain of a controller whose output is in volts, is usually smaller.
const LEAST_POSITION_GAIN_1_S: f64 = 0.5;

/// Product of position gain Kp and servo period T above which the loop diverges. With a drive that
/// follows at once, an error e becomes (1 - Kp T) e within a period, which diverges above 2. A
/// first-order drive keeps the loop stable up to 4.1, where its time constant is T / 3.7.
const DIVERGING_GAIN: f64 = 5.0;

/// Returns the range of the position gain in a loop with this servo period, 1/s. A gain outside it
/// has another unit or belongs to another loop.
pub fn position_gains_1_s(servo_s: f64) -> [f64; 2] {
    [LEAST_POSITION_GAIN_1_S, DIVERGING_GAIN / servo_s]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_is_damped_by_velocity_feedforward() {
        let mut axis = Parameters::NOTHING;
        (axis.kp_1_s, axis.kv_nm_s_per_rad) = (50.0, 2.0);
        axis.inertia_kg_m2 = 0.02;
        assert_eq!(axis.command_damping(), f64::INFINITY);
        assert!(axis.is_followed());
        axis.acceleration_feedforward = 0.5;
        assert_eq!(axis.command_damping(), 0.0);
        for (velocity_feedforward, followed) in [(0.29, false), (0.31, true), (1.0, true)] {
            axis.velocity_feedforward = velocity_feedforward;
            assert_eq!(axis.is_followed(), followed, "{velocity_feedforward}");
        }
        assert_eq!(axis.command_damping(), 1.0);
    }

    #[test]
    fn the_largest_position_gain_depends_on_the_servo_period() {
        assert_eq!(position_gains_1_s(1e-3), [0.5, 5000.0]);
        assert_eq!(position_gains_1_s(4e-3), [0.5, 1250.0]);
    }
}
