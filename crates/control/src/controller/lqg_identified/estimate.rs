//! Estimate of an axis: the model of the axis, stepped with all known inputs and corrected by a
//! Kalman filter.
//!
//! ```text
//! x <- f(x, what was sent)      between two measurements, every mechanics period, with friction, limits and cogging as they are
//! x <- x + K (y - h(x))         h with the interpolation error of the encoder at the estimated angle
//! ```
//!
//! Time is the time of the measurement, which is late. [`Estimate::ahead`] advances from there to
//! the time at which a reference that is sent now acts, with the references on their way.
//!
//! Source: Gelb (1974), Applied Optimal Estimation, section 6.1, the extended filter; its gain is
//! the constant gain of the linear part.

use crate::axis::drive::{DriveModel, DriveReference, DriveState};
use crate::axis::mechanics::{MechanicsModel, MechanicsState};
use crate::axis::{self, AxisModel, Parameters};
use crate::sine::sin;
use crate::supervisor::one_step::{OneStep, RUN_S, run_periods};
use crate::supervisor::outliers::{self, Outliers};
use crate::supervisor::whiteness::{LEVELS, Whiteness};

use super::control_weight::LqgSettings;
use super::gain_table::GainTable;
use super::linear::{LinearAxis, LinearCourse, STATES, measured_rad2};
use super::riccati::{StateMatrix, applied, filter};

/// Number of references that are kept, servo periods: 20 ms each way at 1 ms, the longest of a
/// machine file, and a margin.
pub(super) const KEPT_PERIODS: usize = 48;

/// Innovations that are smaller than this part of the measurement's noise are not used for
/// learning.
const LEAST_SHARE: f64 = 0.01;

/// Smallest part of an innovation that counts as noise of the measurement.
const LEAST_SHARE_LEFT: f64 = 1e-6;

/// Constant part of an axis.
#[derive(Debug, Clone)]
pub(super) struct FilterModel {
    pub(super) axis_model: AxisModel,
    pub(super) drive: DriveModel,
    pub(super) mechanics: MechanicsModel,
    pub(super) linear: LinearAxis,
    gains: GainTable,
    /// Mean square error of a free run by white innovations of unit variance, for each level of the
    /// gains.
    amplified: [f64; LEVELS],
    /// Variance of the measurement that the filter assumes, rad^2.
    measured_rad2: f64,
    /// Innovation below which nothing is learned, and innovation above which only a part is used,
    /// rad.
    least_rad: f64,
    bound_rad: f64,
    /// Servo periods from a command until the position loop has it.
    pub(super) command_periods: usize,
    /// Mechanics periods from a measurement until it is available, and from a reference until it
    /// acts.
    late: [u32; 2],
}

/// State of an axis, and its loads.
#[derive(Debug, Clone, Copy)]
pub(super) struct Estimate {
    pub(super) masses: MechanicsState,
    pub(super) drive: DriveState,
    /// Broadband torque, the disturbance and its quadrature, and the remaining drift, N m.
    pub(super) acting_nm: [f64; 4],
}

impl Estimate {
    /// Returns the load on the axis, N m.
    pub(super) fn load_nm(&self) -> f64 {
        let [broadband, disturbance, _, drift] = self.acting_nm;
        broadband + disturbance + drift
    }

    /// Adds the corrections of the filter to the states.
    pub(super) fn correct(&mut self, corrections: [f64; STATES]) {
        let [x, w, i, y, n, p, q, d, xt, wt] = corrections;
        let MechanicsState { motor, table, .. } = &mut self.masses;
        motor.angle_rad += x;
        motor.speed_rad_s += w;
        table.angle_rad += xt;
        table.speed_rad_s += wt;
        self.drive.correct(i, y);
        self.acting_nm
            .iter_mut()
            .zip([n, p, q, d])
            .for_each(|(nm, more)| *nm += more);
    }
}

/// State that is learned from innovations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Learnt {
    whiteness: Whiteness,
    outliers: Outliers,
    /// The last measurement, rad.
    measured_rad: Option<f64>,
}

impl Learnt {
    /// Start: nothing is learned.
    pub(super) const NOTHING: Self = Self {
        whiteness: Whiteness::GIVEN,
        outliers: Outliers::NONE,
        measured_rad: None,
    };

    /// Takes in a measurement. Returns true if it repeats the last one to the bit.
    fn repeats(&mut self, measured_rad: f64) -> bool {
        self.measured_rad
            .replace(measured_rad)
            .is_some_and(|last_rad| last_rad.to_bits() == measured_rad.to_bits())
    }
}

/// Result of a measurement.
#[derive(Debug, Clone, Copy)]
pub(super) struct Innovation {
    /// Difference between the measurement and its prediction, rad.
    pub(super) missed_rad: f64,
    /// Measurement as it is used after the bound of the innovation, rad.
    pub(super) measured_rad: f64,
    /// Mean square of the innovation by the statistics, rad^2.
    pub(super) expected_rad2: f64,
    /// Travel that the torque added to the travel by the speed of the axis, rad.
    pub(super) pushed_rad: f64,
    /// Correction of each state for a rad of innovation.
    pub(super) gains: [f64; STATES],
}

impl Innovation {
    /// Returns the values of the servo period, with `mm` mm to a rad.
    pub(super) fn step(&self, mm: f64) -> OneStep {
        OneStep {
            missed_mm2: self.missed_rad * self.missed_rad * mm * mm,
            expected_mm2: self.expected_rad2 * mm * mm,
            pushed_mm2: self.pushed_rad * self.pushed_rad * mm * mm,
        }
    }
}

/// References sent to the drive, the newest first.
pub(super) type Sent = [DriveReference; KEPT_PERIODS];

/// Returns the mechanics periods by which a measurement and a drive are late.
fn late(
    AxisModel {
        parameters,
        periods,
        ..
    }: &AxisModel,
) -> [u32; 2] {
    let longest = (KEPT_PERIODS as u32 - 2) / 2 * periods.mechanics_per_servo;
    // The cast saturates to zero where the float is NaN.
    [parameters.measurement_delay_s, parameters.drive_delay_s]
        .map(|s| (libm::round(s / periods.mechanics_s) as u32).min(longest))
}

/// Returns the mean square error of the angle in a free run by white innovations of unit variance
/// through these gains.
///
/// The error of a free run at its end is the sum of the innovations since its start, each carried
/// on from the period in which the filter took it in.
fn amplified(states: &StateMatrix<STATES>, gains: [f64; STATES], servo_s: f64) -> f64 {
    let (mut carried, mut sum) = (gains, 1.0);
    for _ in 1..run_periods(servo_s) {
        carried = applied(states, &carried);
        let [angle, ..] = carried;
        sum += angle * angle;
    }
    sum
}

impl FilterModel {
    /// Creates the model of an axis. If the controller learns, it also has gains for other statistics.
    pub(super) fn new(axis_model: AxisModel, settings: &LqgSettings) -> Self {
        let AxisModel {
            parameters,
            periods,
            ..
        } = &axis_model;
        let linear = LinearAxis::new(&axis_model);
        let (states, _, noise) = linear.sampled();
        let mut measured = [0.0; STATES];
        measured[0] = 1.0;
        let gains = |variance_rad2: f64| filter(&states, &noise, &measured, variance_rad2);
        let filtered_rad2 = settings.assumed_noise() * measured_rad2(parameters);
        let gains = if settings.learns {
            GainTable::new(filtered_rad2, gains)
        } else {
            GainTable::constant(gains(filtered_rad2))
        };
        Self {
            drive: DriveModel::new(&axis_model),
            mechanics: MechanicsModel::new(&axis_model),
            linear,
            amplified: gains
                .levels()
                .map(|gains| amplified(&states, gains, periods.servo_s)),
            gains,
            measured_rad2: filtered_rad2,
            least_rad: LEAST_SHARE * libm::sqrt(measured_rad2(parameters)),
            bound_rad: outliers::bound_rad(&axis_model, measured_rad2(parameters)),
            command_periods: parameters.command_periods(periods.servo_s),
            late: late(&axis_model),
            axis_model,
        }
    }

    /// Returns the gains of the filter by the statistics.
    pub(super) fn gains_as_given(&self) -> [f64; STATES] {
        self.gains.at(Whiteness::GIVEN.power())
    }

    /// Returns the correction of each state by an innovation, the variance of the innovations,
    /// rad^2, and the servo periods from a measurement until a reference that follows from it acts,
    /// with the statistics as given.
    pub(super) fn innovations(&self) -> ([f64; STATES], f64, u32) {
        let gains = self.gains_as_given();
        let [of_angle, ..] = gains;
        let stated_rad2 = measured_rad2(&self.axis_model.parameters);
        let (periods, _) = self.acting();
        (
            gains,
            stated_rad2 / (1.0 - of_angle).max(LEAST_SHARE_LEFT),
            periods as u32,
        )
    }

    /// Returns the estimate of an axis at an angle, after a long motion at a constant speed without
    /// known loads, and the references that were sent to the drive for it.
    pub(super) fn moving(&self, angle_rad: f64, speed_rad_s: f64) -> (Estimate, Sent) {
        let [sign] = axis::friction_signs(&[self.axis_model], [speed_rad_s]);
        let (drive, sent) = self.drive.moving(
            &self.axis_model,
            speed_rad_s,
            self.axis_model.friction_nm(speed_rad_s, sign),
        );
        let masses = MechanicsState::moving(angle_rad, speed_rad_s);
        (
            Estimate {
                masses,
                drive,
                acting_nm: [0.0; 4],
            },
            [sent; KEPT_PERIODS],
        )
    }

    /// Returns the course of the linear axis between two measurements.
    pub(super) fn linear_course(&self) -> LinearCourse {
        let [measured_late, drive_late] = self.late;
        LinearCourse::new(&self.linear, &self.axis_model, measured_late + drive_late)
    }

    /// Returns the cogging torque of the motor at an angle, N m.
    pub(super) fn cogging_nm(&self, angle_rad: f64) -> f64 {
        let Parameters {
            cogging_nm,
            cogging_per_rev,
            cogging_phase_rad,
            ..
        } = self.axis_model.parameters;
        cogging_nm * sin(cogging_per_rev * angle_rad + cogging_phase_rad)
    }

    /// Predicts one servo period.
    pub(super) fn predict(&self, estimate: &mut Estimate, sent: &Sent) {
        let [measured_late, _] = self.late;
        let periods = self.axis_model.periods.mechanics_per_servo;
        self.go_on(estimate, sent, measured_late + periods, periods);
    }

    /// Returns the mean square error of a free run of `periods` servo periods by noise, unforeseen
    /// loads and the encoder, rad^2.
    pub(super) fn unforeseen_rad2(&self, periods: u32) -> f64 {
        let parameters = &self.axis_model.parameters;
        self.linear.spread_rad2(parameters, periods) + measured_rad2(parameters)
    }

    /// Returns the mean square error of a free run by these innovations, if they are white, rad^2.
    pub(super) fn by_noise_rad2(&self, innovation: &Innovation, learnt: &Learnt) -> f64 {
        let amplified = self
            .amplified
            .get(learnt.whiteness.level())
            .copied()
            .unwrap_or(1.0);
        innovation.missed_rad * innovation.missed_rad * amplified
    }

    /// Returns the angle that the encoder shows, rad.
    pub(super) fn shown_rad(&self, estimate: &Estimate) -> f64 {
        let Parameters {
            interpolation_rad,
            interpolation_phase_rad,
            signal_per_rad,
            ..
        } = self.axis_model.parameters;
        let angle_rad = estimate.masses.motor.angle_rad;
        angle_rad + interpolation_rad * sin(signal_per_rad * angle_rad + interpolation_phase_rad)
    }

    /// Predicts one servo period and corrects the estimate by the measurement at its end. Returns
    /// the innovation and the measurement as it was used.
    pub(super) fn correct(
        &self,
        estimate: &mut Estimate,
        sent: &Sent,
        measured_rad: f64,
        learnt: &mut Learnt,
    ) -> Innovation {
        let before_rad_s = estimate.masses.motor.speed_rad_s;
        self.predict(estimate, sent);
        let pushed_rad =
            (estimate.masses.motor.speed_rad_s - before_rad_s) * self.axis_model.periods.servo_s;
        let shown_rad = self.shown_rad(estimate);
        let missed_rad = measured_rad - shown_rad;
        let (bound_rad, servo_s) = (self.bound_rad, self.axis_model.periods.servo_s);
        let repeats = learnt.repeats(measured_rad);
        let taken_rad = learnt
            .outliers
            .bounded_rad(repeats, missed_rad, bound_rad, servo_s);
        learnt.whiteness.take_in(repeats, taken_rad, self.least_rad);
        let gains = self.gains.at(learnt.whiteness.power());
        estimate.correct(gains.map(|gain| gain * taken_rad));
        let [of_angle, ..] = gains;
        let expected_rad2 = learnt.whiteness.variance() * self.measured_rad2
            / (1.0 - of_angle).max(LEAST_SHARE_LEFT);
        // The supervisor detects a frozen encoder: its measurement is no evidence on the
        // predictions.
        let missed_rad = if taken_rad == 0.0 { 0.0 } else { missed_rad };
        let used = if missed_rad == 0.0 {
            1.0
        } else {
            taken_rad / missed_rad
        };
        let gains = gains.map(|gain| used * gain);
        Innovation {
            missed_rad,
            measured_rad: shown_rad + taken_rad,
            expected_rad2,
            pushed_rad,
            gains,
        }
    }

    /// Returns the friction of the table by the model, N m.
    pub(super) fn friction_nm(&self, estimate: &Estimate) -> f64 {
        let MechanicsState {
            table,
            presliding_nm,
            ..
        } = estimate.masses;
        if presliding_nm != 0.0 {
            return self.axis_model.friction_nm(table.speed_rad_s, 0.0) + presliding_nm;
        }
        let [sign] = axis::friction_signs(&[self.axis_model], [table.speed_rad_s]);
        self.axis_model.friction_nm(table.speed_rad_s, sign)
    }

    /// Returns the age of the newest reference that acts before a measurement, servo periods, and
    /// the part of the time in which the one before it acts.
    pub(super) fn acting(&self) -> (usize, f64) {
        let [measured_late, drive_late] = self.late;
        let (late, per_servo) = (
            measured_late + drive_late,
            self.axis_model.periods.mechanics_per_servo,
        );
        let age = late.checked_div(per_servo).unwrap_or(0);
        (
            age as usize,
            f64::from(late - age * per_servo) / f64::from(per_servo),
        )
    }

    /// Changes to this model of the axis. Its filter stays.
    pub(super) fn follow(&mut self, axis_model: AxisModel) {
        self.drive = DriveModel::new(&axis_model);
        self.mechanics = MechanicsModel::new(&axis_model);
        self.late = late(&axis_model);
        self.axis_model = axis_model;
    }

    /// Returns the estimate at the time at which a reference that is sent now begins to act.
    pub(super) fn ahead(&self, estimate: &Estimate, sent: &Sent) -> Estimate {
        let [measured_late, drive_late] = self.late;
        let mut ahead = *estimate;
        self.go_on(&mut ahead, sent, measured_late, measured_late + drive_late);
        ahead
    }

    /// Advances by `periods` mechanics periods, from an estimate that is `before` the start of this
    /// servo period. `sent` holds the references up to the last one.
    fn go_on(&self, estimate: &mut Estimate, sent: &Sent, before: u32, periods: u32) {
        let [_, drive_late] = self.late;
        let per_servo = self.axis_model.periods.mechanics_per_servo;
        for n in 0..periods {
            // Age of the reference that acts: up to one servo period ago it is the newest, up to
            // two the one before.
            let ago = (before + drive_late).saturating_sub(n).max(1);
            let age = (ago - 1).checked_div(per_servo).unwrap_or(0);
            let reference = sent.get(age as usize).copied().unwrap_or_default();
            self.substep(estimate, reference);
        }
    }

    fn substep(&self, estimate: &mut Estimate, reference: DriveReference) {
        let Estimate {
            masses,
            drive,
            acting_nm,
        } = estimate;
        let drive_nm =
            self.drive
                .torque_nm(&self.axis_model, reference, masses.motor.speed_rad_s, drive);
        let motor_nm = drive_nm + self.cogging_nm(masses.motor.angle_rad);
        let [broadband, disturbance, _, drift] = *acting_nm;
        self.mechanics
            .advance(masses, motor_nm, broadband + disturbance + drift);
        *acting_nm = self.linear.acting_after(acting_nm);
    }
}

/// A free run of an axis in parallel with the filter.
#[derive(Debug, Clone, Copy)]
pub(super) struct ModelTrial {
    free: Estimate,
    for_s: f64,
    missed_rad: f64,
}

impl ModelTrial {
    /// Begins a free run from an estimate.
    pub(super) fn from(estimate: &Estimate) -> Self {
        Self {
            free: *estimate,
            for_s: 0.0,
            missed_rad: 0.0,
        }
    }

    /// Returns m, rad.
    pub(super) fn missed_rad(&self) -> f64 {
        self.missed_rad
    }

    /// Advances by one servo period. `estimate` belongs to the filter, which has taken in the
    /// measurement.
    pub(super) fn go_on(
        &mut self,
        model: &FilterModel,
        sent: &Sent,
        measured_rad: f64,
        estimate: &Estimate,
    ) {
        model.predict(&mut self.free, sent);
        self.missed_rad = measured_rad - model.shown_rad(&self.free);
        self.for_s += model.axis_model.periods.servo_s;
        if self.for_s >= RUN_S {
            (self.free, self.for_s) = (*estimate, 0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_measurement_repeats_only_the_one_before_it() {
        let mut learnt = Learnt::NOTHING;
        assert_eq!(
            [1.0, 1.0, 0.0, -0.0, 1.0].map(|rad| learnt.repeats(rad)),
            [false, true, false, false, false]
        );
    }
}
