//! What is estimated of an axis: the law of the axis itself, stepped with everything that is known, and corrected by a Kalman filter.
//!
//! ```text
//! x <- f(x, what was sent)      between two measurements, every mechanics period, with friction, limits and cogging as they are
//! x <- x + K (y - h(x))         h with the interpolation error of the encoder at the estimated angle
//! ```
//!
//! Time is that of the measurement, which is late; [`Estimate::ahead`] goes on from there to the moment at which a reference acts that is
//! sent now, with those that are under way.
//!
//! Source: Gelb (1974), Applied Optimal Estimation, section 6.1, the extended filter; its gain is that of the linear part, constant.

use crate::axis::drive::{DriveLaw, DriveReference, DriveState};
use crate::axis::friction::{FrictionLaw, FrictionParameters};
use crate::axis::knowledge::AxisKnowledge;
use crate::axis::statistics::AxisStatistics;
use crate::axis::{self, AxisLaw, AxisState};
use crate::sine::sin;

use super::linear::{LinearAxis, STATES, measured_rad2};
use super::riccati::filter;
use super::whiteness::{GainTable, Whiteness};

/// References that are kept, servo periods: 20 ms each way at 1 ms, the most of a machine file, and some.
pub(super) const KEPT_PERIODS: usize = 48;

/// Innovations that are smaller than this part of the measurement's noise are not learnt from.
const LEAST_SHARE: f64 = 0.01;

/// What does not change of an axis.
#[derive(Debug, Clone)]
pub(super) struct AxisModel {
    pub(super) law: AxisLaw,
    pub(super) drive: DriveLaw,
    friction: Option<FrictionLaw>,
    statistics: AxisStatistics,
    linear: LinearAxis,
    gains: GainTable,
    /// Innovations that are smaller are not learnt from, rad.
    least_rad: f64,
    /// Mechanics periods from a measurement until it is there, and from a reference until it acts.
    late: [u32; 2],
}

/// State of an axis, and what acts on it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Estimate {
    pub(super) axis: AxisState,
    pub(super) drive: DriveState,
    pub(super) presliding_nm: f64,
    /// Broadband torque, the disturbance and its quadrature, and what is left, N m.
    pub(super) acting_nm: [f64; 4],
}

/// What was sent to the drive, the newest first.
pub(super) type Sent = [DriveReference; KEPT_PERIODS];
/// Nothing was sent.
pub(super) const NOTHING_SENT: Sent = [DriveReference { speed_rad_s: 0.0, torque_nm: 0.0 }; KEPT_PERIODS];

impl AxisModel {
    /// Of an axis; where it `learns`, with gains for other statistics, too.
    pub(super) fn new(known: &AxisKnowledge, learns: bool) -> Self {
        let AxisKnowledge { drive, friction, delays, statistics, .. } = *known;
        let law = known.law();
        let linear = LinearAxis::new(&law, &drive, &statistics);
        let (states, _, noise) = linear.sampled();
        let mut measured = [0.0; STATES];
        measured[0] = 1.0;
        let gains = |variance_rad2: f64| filter(&states, &noise, &measured, variance_rad2);
        let measured_rad2 = measured_rad2(&statistics);
        let longest = (KEPT_PERIODS as u32 - 2) / 2 * law.periods.mechanics_per_servo;
        // A float that is not a number saturates to zero here.
        let late = |delay_s: f64| (libm::round(delay_s / law.periods.mechanics_s) as u32).min(longest);
        Self {
            law,
            drive: DriveLaw::new(&law, drive),
            friction: (friction != FrictionParameters::default()).then(|| FrictionLaw::new(&law, friction)),
            statistics,
            linear,
            gains: if learns {
                GainTable::new(measured_rad2, gains)
            } else {
                GainTable::constant(gains(measured_rad2))
            },
            least_rad: LEAST_SHARE * libm::sqrt(measured_rad2),
            late: [delays.measurement_s, delays.drive_s].map(late),
        }
    }

    /// Gains of the filter by the statistics as given.
    pub(super) fn gains_as_given(&self) -> [f64; STATES] {
        Whiteness::GIVEN.gains(&self.gains)
    }

    /// At rest at an angle.
    pub(super) fn at_rest(angle_rad: f64) -> Estimate {
        Estimate {
            axis: AxisState { angle_rad, ..AxisState::default() },
            drive: DriveState::default(),
            presliding_nm: 0.0,
            acting_nm: [0.0; 4],
        }
    }

    /// Torque of the motor beside the drive's at an angle, N m.
    pub(super) fn cogging_nm(&self, angle_rad: f64) -> f64 {
        let AxisStatistics { cogging_nm, cogging_per_rev, cogging_phase_rad, .. } = self.statistics;
        cogging_nm * sin(cogging_per_rev * angle_rad + cogging_phase_rad)
    }

    /// One servo period on.
    pub(super) fn predict(&self, estimate: &mut Estimate, sent: &Sent) {
        let [measured_late, _] = self.late;
        let periods = self.law.periods.mechanics_per_servo;
        self.go_on(estimate, sent, measured_late + periods, periods);
    }

    /// One servo period on, and what was measured at its end; by how much that was not expected, rad.
    pub(super) fn correct(
        &self,
        estimate: &mut Estimate,
        sent: &Sent,
        measured_rad: f64,
        whiteness: &mut Whiteness,
    ) -> f64 {
        self.predict(estimate, sent);
        let AxisStatistics { interpolation_rad, interpolation_phase_rad, signal_per_rad, .. } = self.statistics;
        let angle_rad = estimate.axis.angle_rad;
        let shown_rad = angle_rad + interpolation_rad * sin(signal_per_rad * angle_rad + interpolation_phase_rad);
        let missed_rad = measured_rad - shown_rad;
        whiteness.take_in(measured_rad, missed_rad, self.least_rad);
        let [x, w, i, y, acting @ ..] = whiteness.gains(&self.gains).map(|gain| gain * missed_rad);
        estimate.axis.angle_rad += x;
        estimate.axis.speed_rad_s += w;
        estimate.drive.correct(i, y);
        estimate.acting_nm.iter_mut().zip(acting).for_each(|(nm, more)| *nm += more);
        missed_rad
    }

    /// As it will be when what is sent now begins to act.
    pub(super) fn ahead(&self, estimate: &Estimate, sent: &Sent) -> Estimate {
        let [measured_late, drive_late] = self.late;
        let mut ahead = *estimate;
        self.go_on(&mut ahead, sent, measured_late, measured_late + drive_late);
        ahead
    }

    /// So many mechanics periods on, from one that is `before` the start of this servo period. `sent` holds what was sent until the last one.
    fn go_on(&self, estimate: &mut Estimate, sent: &Sent, before: u32, periods: u32) {
        let [_, drive_late] = self.late;
        let per_servo = self.law.periods.mechanics_per_servo;
        for n in 0..periods {
            // So long ago was sent what acts: a servo period ago it was the newest, up to two the one before.
            let ago = (before + drive_late).saturating_sub(n).max(1);
            let age = (ago - 1).checked_div(per_servo).unwrap_or(0);
            let reference = sent.get(age as usize).copied().unwrap_or_default();
            self.substep(estimate, reference);
        }
    }

    fn substep(&self, estimate: &mut Estimate, reference: DriveReference) {
        let (law, state) = (&self.law, &mut estimate.axis);
        let drive_nm = self.drive.torque_nm(law, reference, state.speed_rad_s, &mut estimate.drive);
        let [broadband, disturbance, _, drift] = estimate.acting_nm;
        let forces_nm = drive_nm + self.cogging_nm(state.angle_rad) - broadband - disturbance - drift;
        match &self.friction {
            Some(friction) => {
                let inverse_inertia = 1.0 / law.parameters.inertia_kg_m2;
                let w = state.speed_rad_s;
                state.speed_rad_s =
                    friction.speed_after_rad_s(forces_nm, inverse_inertia, w, &mut estimate.presliding_nm);
                state.angle_rad += law.periods.mechanics_s * state.speed_rad_s;
            }
            None => {
                let [sign] = axis::signs(&[*law], [state.speed_rad_s]);
                law.accelerate(forces_nm - law.friction_nm(state.speed_rad_s, sign), state);
            }
        }
        estimate.acting_nm = self.linear.acting_after(&estimate.acting_nm);
    }
}
