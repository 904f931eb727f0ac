//! What is estimated of an axis: the law of the axis itself, stepped with everything that is known,
//! and corrected by a Kalman filter.
//!
//! ```text
//! x <- f(x, what was sent)      between two measurements, every mechanics period, with friction, limits and cogging as they are
//! x <- x + K (y - h(x))         h with the interpolation error of the encoder at the estimated angle
//! ```
//!
//! Time is that of the measurement, which is late; [`Estimate::ahead`] goes on from there to the
//! moment at which a reference acts that is sent now, with those that are under way.
//!
//! Source: Gelb (1974), Applied Optimal Estimation, section 6.1, the extended filter; its gain is
//! that of the linear part, constant.

use crate::axis::drive::{DriveLaw, DriveReference, DriveState};
use crate::axis::knowledge::AxisKnowledge;
use crate::axis::mechanics::{MechanicsLaw, MechanicsState};
use crate::axis::statistics::AxisStatistics;
use crate::axis::{self, AxisLaw};
use crate::sine::sin;
use crate::supervisor::one_step::{OneStep, RUN_S, run_periods};

use super::linear::{LinearAxis, STATES, measured_rad2};
use super::outliers::{self, Outliers};
use super::riccati::{StateMatrix, applied, filter};
use super::whiteness::{GainTable, LEVELS, Whiteness};

/// References that are kept, servo periods: 20 ms each way at 1 ms, the most of a machine file, and
/// some.
pub(super) const KEPT_PERIODS: usize = 48;

/// Innovations that are smaller than this part of the measurement's noise are not learnt from.
const LEAST_SHARE: f64 = 0.01;

/// Least part of an innovation that counts as noise of the measurement.
const LEAST_SHARE_LEFT: f64 = 1e-6;

/// Largest load that counts as one, a part of the torque limit: about what a drive that may reach
/// three times its rated torque for a moment can hold.
const LARGEST_LOAD: f64 = 1.0 / 3.0;

/// What does not change of an axis.
#[derive(Debug, Clone)]
pub(super) struct AxisModel {
    pub(super) law: AxisLaw,
    pub(super) drive: DriveLaw,
    pub(super) mechanics: MechanicsLaw,
    statistics: AxisStatistics,
    pub(super) linear: LinearAxis,
    gains: GainTable,
    /// Mean square of what a free run misses by white innovations of unit variance, for each level
    /// of the gains.
    amplified: [f64; LEVELS],
    /// Variance of the measurement as given, rad^2.
    measured_rad2: f64,
    /// Innovations that are smaller are not learnt from, and those that are larger are believed in
    /// part, rad.
    least_rad: f64,
    believed_rad: f64,
    /// Servo periods from a command until the position loop has it.
    pub(super) command_periods: usize,
    /// Mechanics periods from a measurement until it is there, and from a reference until it acts.
    late: [u32; 2],
}

/// State of an axis, and what acts on it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Estimate {
    pub(super) masses: MechanicsState,
    pub(super) drive: DriveState,
    /// Broadband torque, the disturbance and its quadrature, and what is left, N m.
    pub(super) acting_nm: [f64; 4],
}

impl Estimate {
    /// What acts on it, N m.
    pub(super) fn load_nm(&self) -> f64 {
        let [broadband, disturbance, _, drift] = self.acting_nm;
        broadband + disturbance + drift
    }

    /// What the filter finds them to be higher.
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

/// What is learnt from innovations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Learnt {
    pub(super) whiteness: Whiteness,
    pub(super) outliers: Outliers,
}

impl Learnt {
    /// Nothing yet.
    pub(super) const NOTHING: Self = Self {
        whiteness: Whiteness::GIVEN,
        outliers: Outliers::NONE,
    };
}

/// What a measurement told.
#[derive(Debug, Clone, Copy)]
pub(super) struct Innovation {
    /// By how much it was not expected, rad.
    pub(super) missed_rad: f64,
    /// As what it is taken, rad.
    pub(super) measured_rad: f64,
    /// Mean square of what is not expected by the statistics, rad^2.
    pub(super) expected_rad2: f64,
    /// By how much the torque has moved the axis, beside its speed, rad.
    pub(super) pushed_rad: f64,
    /// What each state was corrected by, for a rad of innovation.
    pub(super) gains: [f64; STATES],
}

impl Innovation {
    /// As that of a servo period, with so many mm to a rad.
    pub(super) fn step(&self, mm: f64) -> OneStep {
        OneStep {
            missed_mm2: self.missed_rad * self.missed_rad * mm * mm,
            expected_mm2: self.expected_rad2 * mm * mm,
            pushed_mm2: self.pushed_rad * self.pushed_rad * mm * mm,
        }
    }
}

/// What was sent to the drive, the newest first.
pub(super) type Sent = [DriveReference; KEPT_PERIODS];

/// Mechanics periods by which a measurement and a drive are late.
fn late(
    AxisKnowledge {
        delays, periods, ..
    }: &AxisKnowledge,
) -> [u32; 2] {
    let longest = (KEPT_PERIODS as u32 - 2) / 2 * periods.mechanics_per_servo;
    // A float that is not a number saturates to zero here.
    [delays.measurement_s, delays.drive_s]
        .map(|s| (libm::round(s / periods.mechanics_s) as u32).min(longest))
}

/// Mean square of the angle that white innovations of unit variance make of a free run through
/// gains.
///
/// What a free run misses at its end is the sum of the innovations since its start, each carried on
/// from where the filter took it in.
fn amplified(states: &StateMatrix<STATES>, gains: [f64; STATES], servo_s: f64) -> f64 {
    let (mut carried, mut sum) = (gains, 1.0);
    for _ in 1..run_periods(servo_s) {
        carried = applied(states, &carried);
        let [angle, ..] = carried;
        sum += angle * angle;
    }
    sum
}

impl AxisModel {
    /// Of an axis; where it `learns`, with gains for other statistics, too.
    pub(super) fn new(known: &AxisKnowledge, learns: bool) -> Self {
        let AxisKnowledge {
            drive,
            friction,
            transmission,
            statistics,
            ..
        } = *known;
        let law = known.law();
        let mechanics = MechanicsLaw::new(&law, friction, transmission);
        let linear = LinearAxis::new(&law, &drive, mechanics.transmission(), &statistics);
        let (states, _, noise) = linear.sampled();
        let mut measured = [0.0; STATES];
        measured[0] = 1.0;
        let gains = |variance_rad2: f64| filter(&states, &noise, &measured, variance_rad2);
        let measured_rad2 = measured_rad2(&statistics);
        let gains = if learns {
            GainTable::new(measured_rad2, gains)
        } else {
            GainTable::constant(gains(measured_rad2))
        };
        Self {
            law,
            drive: DriveLaw::new(&law, drive),
            mechanics,
            statistics,
            linear,
            amplified: gains
                .levels()
                .map(|gains| amplified(&states, gains, law.periods.servo_s)),
            gains,
            measured_rad2,
            least_rad: LEAST_SHARE * libm::sqrt(measured_rad2),
            believed_rad: outliers::believed_rad(&law, measured_rad2),
            command_periods: known.delays.command_periods(law.periods.servo_s),
            late: late(known),
        }
    }

    /// Gains of the filter by the statistics as given.
    pub(super) fn gains_as_given(&self) -> [f64; STATES] {
        Whiteness::GIVEN.gains(&self.gains)
    }

    /// At an angle, at a speed at which it has gone for long, with nothing that is known to act;
    /// and what was sent to the drive for it.
    pub(super) fn moving(&self, angle_rad: f64, speed_rad_s: f64) -> (Estimate, Sent) {
        let [sign] = axis::friction_signs(&[self.law], [speed_rad_s]);
        let (drive, sent) = self.drive.moving(
            &self.law,
            speed_rad_s,
            self.law.friction_nm(speed_rad_s, sign),
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

    /// Torque of the motor beside the drive's at an angle, N m.
    pub(super) fn cogging_nm(&self, angle_rad: f64) -> f64 {
        let AxisStatistics {
            cogging_nm,
            cogging_per_rev,
            cogging_phase_rad,
            ..
        } = self.statistics;
        cogging_nm * sin(cogging_per_rev * angle_rad + cogging_phase_rad)
    }

    /// One servo period on.
    pub(super) fn predict(&self, estimate: &mut Estimate, sent: &Sent) {
        let [measured_late, _] = self.late;
        let periods = self.law.periods.mechanics_per_servo;
        self.go_on(estimate, sent, measured_late + periods, periods);
    }

    /// Mean square of what noise and loads that nobody foresees move the axis by, and the encoder
    /// adds, in a free run of so many servo periods, rad^2.
    pub(super) fn unforeseen_rad2(&self, periods: u32) -> f64 {
        self.linear.spread_rad2(&self.statistics, periods) + measured_rad2(&self.statistics)
    }

    /// Mean square of what a free run misses by the innovations that were told, if they are white,
    /// rad^2.
    pub(super) fn by_noise_rad2(&self, told: &Innovation, learnt: &Learnt) -> f64 {
        let amplified = self
            .amplified
            .get(learnt.whiteness.level())
            .copied()
            .unwrap_or(1.0);
        told.missed_rad * told.missed_rad * amplified
    }

    /// What the encoder shows, rad.
    pub(super) fn shown_rad(&self, estimate: &Estimate) -> f64 {
        let AxisStatistics {
            interpolation_rad,
            interpolation_phase_rad,
            signal_per_rad,
            ..
        } = self.statistics;
        let angle_rad = estimate.masses.motor.angle_rad;
        angle_rad + interpolation_rad * sin(signal_per_rad * angle_rad + interpolation_phase_rad)
    }

    /// One servo period on, and what was measured at its end: by how much that was not expected,
    /// rad, and as what it is taken.
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
            (estimate.masses.motor.speed_rad_s - before_rad_s) * self.law.periods.servo_s;
        let shown_rad = self.shown_rad(estimate);
        let missed_rad = measured_rad - shown_rad;
        let (believed_rad, servo_s) = (self.believed_rad, self.law.periods.servo_s);
        let taken_rad =
            learnt
                .outliers
                .bounded_rad(measured_rad, missed_rad, believed_rad, servo_s);
        learnt
            .whiteness
            .take_in(measured_rad, taken_rad, self.least_rad);
        let gains = learnt.whiteness.gains(&self.gains);
        estimate.correct(gains.map(|gain| gain * taken_rad));
        let [of_angle, ..] = gains;
        let expected_rad2 = learnt.whiteness.variance() * self.measured_rad2
            / (1.0 - of_angle).max(LEAST_SHARE_LEFT);
        // A frozen encoder is for the supervisor to see: it tells nothing of the predictions.
        let missed_rad = if taken_rad == 0.0 { 0.0 } else { missed_rad };
        let believed = if missed_rad == 0.0 {
            1.0
        } else {
            taken_rad / missed_rad
        };
        let gains = gains.map(|gain| believed * gain);
        Innovation {
            missed_rad,
            measured_rad: shown_rad + taken_rad,
            expected_rad2,
            pushed_rad,
            gains,
        }
    }

    /// Friction of the table by the law, N m.
    pub(super) fn friction_nm(&self, estimate: &Estimate) -> f64 {
        let MechanicsState {
            table,
            presliding_nm,
            ..
        } = estimate.masses;
        if presliding_nm != 0.0 {
            return self.law.friction_nm(table.speed_rad_s, 0.0) + presliding_nm;
        }
        let [sign] = axis::friction_signs(&[self.law], [table.speed_rad_s]);
        self.law.friction_nm(table.speed_rad_s, sign)
    }

    /// The age of the newest reference that acts before a measurement, servo periods, and the part
    /// of the time in which the one before it does.
    pub(super) fn acting(&self) -> (usize, f64) {
        let [measured_late, drive_late] = self.late;
        let (late, per_servo) = (
            measured_late + drive_late,
            self.law.periods.mechanics_per_servo,
        );
        let age = late.checked_div(per_servo).unwrap_or(0);
        (
            age as usize,
            f64::from(late - age * per_servo) / f64::from(per_servo),
        )
    }

    /// Goes by this knowledge of the axis from now on. Its filter stays.
    pub(super) fn follow(&mut self, known: &AxisKnowledge) {
        self.law = known.law();
        self.drive = DriveLaw::new(&self.law, known.drive);
        self.mechanics = MechanicsLaw::new(&self.law, known.friction, known.transmission);
        self.late = late(known);
    }

    /// Whether there can be such a load. One that is larger is a law that is not that of the axis:
    /// other gains, another inertia.
    pub(super) fn is_possible(&self, estimate: &Estimate) -> bool {
        // What is not a number is none.
        estimate.load_nm().abs() <= LARGEST_LOAD * self.law.parameters.torque_limit_nm
    }

    /// As it will be when what is sent now begins to act.
    pub(super) fn ahead(&self, estimate: &Estimate, sent: &Sent) -> Estimate {
        let [measured_late, drive_late] = self.late;
        let mut ahead = *estimate;
        self.go_on(&mut ahead, sent, measured_late, measured_late + drive_late);
        ahead
    }

    /// So many mechanics periods on, from one that is `before` the start of this servo period.
    /// `sent` holds what was sent until the last one.
    fn go_on(&self, estimate: &mut Estimate, sent: &Sent, before: u32, periods: u32) {
        let [_, drive_late] = self.late;
        let per_servo = self.law.periods.mechanics_per_servo;
        for n in 0..periods {
            // So long ago was sent what acts: a servo period ago it was the newest, up to two the
            // one before.
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
        let drive_nm = self
            .drive
            .torque_nm(&self.law, reference, masses.motor.speed_rad_s, drive);
        let motor_nm = drive_nm + self.cogging_nm(masses.motor.angle_rad);
        let [broadband, disturbance, _, drift] = *acting_nm;
        self.mechanics
            .advance(masses, motor_nm, broadband + disturbance + drift);
        *acting_nm = self.linear.acting_after(acting_nm);
    }
}

/// A free run beside the filter, of an axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct LawTrial {
    free: Estimate,
    for_s: f64,
    missed_rad: f64,
}

impl LawTrial {
    /// From an estimate on.
    pub(super) fn from(estimate: &Estimate) -> Self {
        Self {
            free: *estimate,
            for_s: 0.0,
            missed_rad: 0.0,
        }
    }

    /// m, rad.
    pub(super) fn missed_rad(&self) -> f64 {
        self.missed_rad
    }

    /// One servo period on; `estimate` is that of the filter, which has taken in what was measured.
    pub(super) fn go_on(
        &mut self,
        model: &AxisModel,
        sent: &Sent,
        measured_rad: f64,
        estimate: &Estimate,
    ) {
        model.predict(&mut self.free, sent);
        self.missed_rad = measured_rad - model.shown_rad(&self.free);
        self.for_s += model.law.periods.servo_s;
        if self.for_s >= RUN_S {
            (self.free, self.for_s) = (*estimate, 0.0);
        }
    }
}
