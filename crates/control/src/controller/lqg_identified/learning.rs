//! Model errors, learned while the axis moves.
//!
//! In parallel with the filter of the nominal model runs another one, of a model that is learned.
//! The differences theta between the two are constant, or nearly so. To first order they add to the
//! error of the filter:
//!
//! ```text
//! s_i <- A s_i + b phi_i        before a measurement: what a unit of difference i has made of the state since the last one
//! s_i <- s_i - K h s_i          after it; K is what the filter added of the innovation, h s_i is the angle of the motor in s_i
//! nu   = sum_i h s_i (theta_i - applied_i) + w
//! ```
//!
//! nu is the innovation of the filter that is learned, w its part by noise. Recursive least squares
//! find theta, whether the correction is engaged or not. They forget only in the direction of the
//! measurement (Kulhavy): a long straight line, which is evidence on few differences, leaves the
//! others as they are. A difference beyond its bounds is set to them, and the others to their most
//! likely values then. The result is applied at once, and the estimate moves by s_i with it: filter
//! and least squares together are the filter that has theta among its states.
//!
//! | i | Difference | phi |
//! |---|---|---|
//! | 0 | position gain, part of it | reference speed that the gain requests |
//! | 1 | velocity feedforward | commanded speed, as reference speed |
//! | 2 | delay of the drive, servo periods | change of the reference over a servo period, reversed |
//! | 3 | inertia, part of it | J a, as a load |
//! | 4 | friction, part of it | friction by the model, as a load |
//! | 5 | constant load, N m | 1; the filter compensates it, and it is only kept apart from the others |
//! | 6 | acceleration feedforward | torque for the commanded acceleration |
//!
//! Free runs decide which of the two models is followed (`supervisor/model_choice.rs`).
//!
//! Differences 2, 3 and 6 are learned only within [`EVEN_S`] of an acceleration of the path. At
//! constant speed there is no evidence on them, and effects outside the model, such as cogging, are
//! mistaken for them: on a plate in inches a correct inertia is then halved.
//!
//! Rejected alternative: least squares on the innovations of the nominal filter diverge where those
//! are bounded as outliers.
//!
//! Source: Friedland (1969), Treatment of bias in recursive filtering, IEEE Trans. Automatic
//! Control 14(4), for the two filters; Kulhavy (1987), Restricted exponential forgetting in
//! real-time identification, Automatica 23(5).

use crate::axis::AxisModel;
use crate::axis::drive::DriveReference;
use crate::supervisor::DEVIATIONS;
use crate::supervisor::model_choice::{ModelChange, ModelChoice};
use crate::supervisor::one_step::{LEAST_MM2, run_periods};
use crate::vector::bounded;

use super::estimate::{Estimate, FilterModel, Innovation, KEPT_PERIODS, Sent};
use super::linear::{LinearAxis, PeriodInputs, STATES, measured_rad2};
use super::riccati::{StateMatrix, applied as carried};

/// Number of differences.
pub(super) const DIFFERENCES: usize = 7;
/// Standard deviations of the differences before any measurement, and their bounds.
const PRIORS: [f64; DIFFERENCES] = [0.1, 0.1, 0.5, 0.3, 0.6, 0.1, 0.3];
const BOUNDS: [[f64; 2]; DIFFERENCES] = [
    [-0.5, 1.0],
    [-0.3, 0.3],
    [-2.0, 3.0],
    [-0.7, 2.0],
    [-0.9, 3.0],
    [-1e3, 1e3],
    [-1.0, 1.0],
];
/// Index of the constant load.
const LOAD: usize = 5;
/// Differences that show while the path accelerates, the smallest such acceleration, mm/s^2, and
/// the time after it for which they still show, s.
const OF_ACCELERATION: [usize; 3] = [2, 3, 6];
const ACCELERATED_MM_S2: f64 = 100.0;
const EVEN_S: f64 = 0.1;
/// Time over which measurements are forgotten, s.
const DRIFT_S: f64 = 100.0;
/// Factor on the variance of the residual, which is not white.
const COLOURED: f64 = 4.0;
/// Time over which the residual is averaged, s.
const LEFT_S: f64 = 0.25;
/// Error of the first order, as a part of the effect of the differences.
const FIRST_ORDER: f64 = 0.3;
/// Standard deviations up to which a residual counts.
const PLAUSIBLE: f64 = 3.0;
/// Speed below which an axis shows its friction at rest, mm/s.
const SLOWEST_MM_S: f64 = 1.0;

/// Differences between a machine and its model.
pub(super) type Differences = [f64; DIFFERENCES];

/// Returns the axis with these differences.
pub(super) fn with(nominal: &AxisModel, differences: &Differences) -> AxisModel {
    let [
        position_gain,
        velocity,
        delay,
        inertia,
        friction,
        _,
        acceleration,
    ] = *differences;
    let servo_s = nominal.periods.servo_s;
    nominal.with(|axis| {
        axis.kp_1_s *= 1.0 + position_gain;
        axis.velocity_feedforward = (axis.velocity_feedforward + velocity).max(0.0);
        axis.drive_delay_s = (axis.drive_delay_s + delay * servo_s).max(0.0);
        axis.inertia_kg_m2 *= 1.0 + inertia;
        // The torque that the drive adds does not follow another inertia.
        let of_nominal = (axis.acceleration_feedforward + acceleration).max(0.0);
        axis.acceleration_feedforward = of_nominal / (1.0 + inertia);
        for friction_nm in [
            &mut axis.viscous_friction_nm_s,
            &mut axis.coulomb_friction_nm,
            &mut axis.coulomb_asymmetry_nm,
            &mut axis.stribeck_nm,
        ] {
            *friction_nm *= 1.0 + friction;
        }
    })
}

/// Constant part of the learning of an axis.
#[derive(Debug, Clone)]
pub(super) struct Learner {
    nominal: AxisModel,
    states: StateMatrix<STATES>,
    inputs: PeriodInputs,
    priors: Differences,
    bounds: [[f64; 2]; DIFFERENCES],
    /// Mean square error of a servo period by the encoder and unforeseen loads, rad^2.
    noise_rad2: f64,
}

/// State of the learning of an axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Learning {
    sensitivities: [[f64; STATES]; DIFFERENCES],
    found: Differences,
    covariance: [[f64; DIFFERENCES]; DIFFERENCES],
    applied: Differences,
    moves: bool,
    /// Mean square of the residual, rad^2.
    left_rad2: f64,
    choice: ModelChoice,
    /// Commanded speeds and errors of the position, rad/s and rad, the newest first.
    commanded_rad_s: [f64; KEPT_PERIODS],
    error_rad: [f64; KEPT_PERIODS],
    command_rad: Option<f64>,
    /// The last two angles of the path, rad, the newest first, and the time since it last
    /// accelerated, s.
    path_rad: Option<[f64; 2]>,
    even_s: f64,
}

impl Learner {
    /// Creates the learner of an axis from its model.
    /// `least_inertia` is the least difference of the inertia that may be learned.
    pub(super) fn new(nominal: AxisModel, linear: &LinearAxis, least_inertia: f64) -> Self {
        let (states, ..) = linear.sampled();
        let mut priors = PRIORS;
        if nominal.parameters.acceleration_feedforward == 0.0 {
            priors[6] = 0.0;
        }
        priors[LOAD] = nominal
            .parameters
            .coulomb_friction_nm
            .max(1e-3 * nominal.parameters.torque_limit_nm);
        let mut bounds = BOUNDS;
        let [_, velocity, delay, inertia, .., acceleration] = &mut bounds;
        inertia[0] = inertia[0].max(least_inertia);
        // Neither a feedforward nor a delay can be negative.
        velocity[0] = -nominal.parameters.velocity_feedforward;
        delay[0] = -nominal.parameters.drive_delay_s / nominal.periods.servo_s;
        acceleration[0] = -nominal.parameters.acceleration_feedforward;
        let rad_per_mm = nominal.parameters.rad_per_mm;
        let least_rad2 = LEAST_MM2 * rad_per_mm * rad_per_mm;
        let loads_rad2 =
            linear.spread_rad2(&nominal.parameters, run_periods(nominal.periods.servo_s));
        let noise_rad2 =
            least_rad2 + loads_rad2 + DEVIATIONS * DEVIATIONS * measured_rad2(&nominal.parameters);
        Self {
            nominal,
            states,
            inputs: linear.inputs(),
            priors,
            bounds,
            noise_rad2,
        }
    }

    /// Returns the state before any measurement.
    pub(super) fn begin(&self) -> Learning {
        let mut covariance = [[0.0; DIFFERENCES]; DIFFERENCES];
        covariance
            .iter_mut()
            .enumerate()
            .for_each(|(i, row)| row[i] = self.priors[i] * self.priors[i]);
        Learning {
            sensitivities: [[0.0; STATES]; DIFFERENCES],
            found: [0.0; DIFFERENCES],
            covariance,
            applied: [0.0; DIFFERENCES],
            moves: false,
            left_rad2: 0.0,
            choice: ModelChoice::nominal(self.noise_rad2, self.nominal.periods.servo_s),
            commanded_rad_s: [0.0; KEPT_PERIODS],
            error_rad: [0.0; KEPT_PERIODS],
            command_rad: None,
            path_rad: None,
            even_s: f64::INFINITY,
        }
    }

    /// Takes in the angle of the path at which a command was sent, rad.
    pub(super) fn along(&self, learning: &mut Learning, path_rad: f64) {
        let servo_s = self.nominal.periods.servo_s;
        let [last_rad, earlier_rad] = learning.path_rad.unwrap_or([path_rad; 2]);
        learning.path_rad = Some([path_rad, last_rad]);
        let acceleration_rad_s2 = (path_rad - 2.0 * last_rad + earlier_rad) / (servo_s * servo_s);
        let is_even =
            acceleration_rad_s2.abs() <= ACCELERATED_MM_S2 * self.nominal.parameters.rad_per_mm;
        learning.even_s = if is_even {
            learning.even_s + servo_s
        } else {
            0.0
        };
    }

    /// Restores the initial uncertainty of the differences after a change of the machine.
    pub(super) fn restore_uncertainty(&self, learning: &mut Learning) {
        learning.covariance = self.begin().covariance;
    }

    /// Takes in a sent command and the position measured with it, rad.
    pub(super) fn sent(&self, learning: &mut Learning, command_rad: f64, measured_rad: f64) {
        let servo_s = self.nominal.periods.servo_s;
        let before_rad = learning
            .command_rad
            .replace(command_rad)
            .unwrap_or(command_rad);
        for (kept, newest) in [
            (
                &mut learning.commanded_rad_s,
                (command_rad - before_rad) / servo_s,
            ),
            (&mut learning.error_rad, command_rad - measured_rad),
        ] {
            kept.copy_within(..KEPT_PERIODS - 1, 1);
            kept[0] = newest;
        }
    }

    /// Takes in the measurement after that command.
    pub(super) fn take_in(
        &self,
        learning: &mut Learning,
        model: &FilterModel,
        run: (&Estimate, &Sent),
        innovation: &Innovation,
    ) {
        let speed_rad_s = self.predict(learning, model, run, innovation);
        let slowest_rad_s = SLOWEST_MM_S * self.nominal.parameters.rad_per_mm;
        learning.moves = speed_rad_s.abs() > slowest_rad_s;
        if learning.moves && innovation.missed_rad.is_finite() {
            self.learn(learning, innovation);
        }
        for sensitivity in &mut learning.sensitivities {
            let [angle, ..] = *sensitivity;
            sensitivity
                .iter_mut()
                .zip(innovation.gains)
                .for_each(|(state, gain)| *state -= gain * angle);
        }
    }

    /// Advances the sensitivities by a servo period. Returns the commanded speed that acted in it,
    /// rad/s.
    fn predict(
        &self,
        learning: &mut Learning,
        model: &FilterModel,
        (estimate, sent): (&Estimate, &Sent),
        innovation: &Innovation,
    ) -> f64 {
        let (age, older) = model.acting();
        let mean = |of: &dyn Fn(usize) -> f64| of(age) + older * (of(age + 1) - of(age));
        let reference = |age: usize| sent.get(age).copied().unwrap_or_default();
        let kept = |kept: &[f64; KEPT_PERIODS], age: usize| kept.get(age).copied().unwrap_or(0.0);
        let (speeds, errors) = (learning.commanded_rad_s, learning.error_rad);
        let parameters = &self.nominal.parameters;
        let speed_rad_s = mean(&|age| kept(&speeds, age));
        let asked_rad_s = parameters.kp_1_s * mean(&|age| kept(&errors, age));
        let later = |of: &dyn Fn(DriveReference) -> f64| {
            -mean(&|age| of(reference(age)) - of(reference(age + 1)))
        };
        let per_s = parameters.inertia_kg_m2 / self.nominal.periods.servo_s;
        let added_nm = per_s * mean(&|age| kept(&speeds, age) - kept(&speeds, age + 1));
        let inputs = [
            [asked_rad_s, 0.0, 0.0],
            [speed_rad_s, 0.0, 0.0],
            [
                later(&|sent| sent.speed_rad_s),
                later(&|sent| sent.torque_nm),
                0.0,
            ],
            [
                0.0,
                0.0,
                parameters.inertia_kg_m2 * innovation.pushed_rad
                    / (self.nominal.periods.servo_s * self.nominal.periods.servo_s),
            ],
            [0.0, 0.0, model.friction_nm(estimate)],
            [0.0, 0.0, 1.0],
            [0.0, added_nm, 0.0],
        ];
        let PeriodInputs {
            reference,
            torque,
            load,
        } = &self.inputs;
        for (sensitivity, [by_reference, by_torque, by_load]) in
            learning.sensitivities.iter_mut().zip(inputs)
        {
            let after = carried(&self.states, sensitivity);
            *sensitivity = core::array::from_fn(|state| {
                after[state]
                    + by_reference * reference[state]
                    + by_torque * torque[state]
                    + by_load * load[state]
            });
        }
        speed_rad_s
    }

    /// Does a step of recursive least squares.
    fn learn(&self, learning: &mut Learning, innovation: &Innovation) {
        let servo_s = self.nominal.periods.servo_s;
        let mut shows: Differences = learning.sensitivities.map(|[angle, ..]| angle);
        if learning.even_s > EVEN_S {
            OF_ACCELERATION.into_iter().for_each(|i| shows[i] = 0.0);
        }
        let of_nominal_rad = innovation.missed_rad + dot(&shows, &learning.applied);
        let left_rad = of_nominal_rad - dot(&shows, &learning.found);
        let spreads: Differences = learning.covariance.map(|row| dot(&row, &shows));
        let second_rad = FIRST_ORDER * of_nominal_rad;
        let noise_rad2 =
            COLOURED * innovation.expected_rad2.max(learning.left_rad2) + second_rad * second_rad;
        let variance_rad2 = noise_rad2 + dot(&shows, &spreads);
        let bound_rad = PLAUSIBLE * libm::sqrt(variance_rad2);
        let left_rad = bounded(left_rad, -bound_rad, bound_rad);
        if !(variance_rad2 > noise_rad2 && left_rad.is_finite()) {
            return;
        }
        let shown = dot(&shows, &spreads) / noise_rad2;
        // Only the knowledge in the direction of the measurement is forgotten, over `DRIFT_S`.
        let forgets = (servo_s / DRIFT_S).min(1.0);
        let kept = (1.0 - forgets) * shown - forgets;
        let narrows = kept / (noise_rad2 * shown * (1.0 + kept));
        for (i, spread) in spreads.iter().enumerate() {
            learning.found[i] += spread / variance_rad2 * left_rad;
            for (j, other) in spreads.iter().enumerate() {
                learning.covariance[i][j] -= narrows * spread * other;
            }
        }
        self.bound(learning);
        learning.left_rad2 +=
            (servo_s / LEFT_S).min(1.0) * (left_rad * left_rad - learning.left_rad2);
    }

    /// Sets the most likely differences within the bounds, one bound after the other.
    fn bound(&self, learning: &mut Learning) {
        for i in 0..DIFFERENCES {
            let [lowest, highest] = self.bounds[i];
            let beyond = learning.found[i] - bounded(learning.found[i], lowest, highest);
            let variance = learning.covariance[i][i];
            if beyond != 0.0 && variance > 0.0 {
                for j in 0..DIFFERENCES {
                    learning.found[j] -= beyond * learning.covariance[j][i] / variance;
                }
            }
        }
    }

    /// Returns the part of the differences that can be applied.
    fn wanted(&self, found: &Differences) -> Differences {
        core::array::from_fn(|i| {
            let [lowest, highest] = self.bounds[i];
            if i == LOAD {
                0.0
            } else {
                bounded(found[i], lowest, highest)
            }
        })
    }

    /// Applies the differences to the learned model. Returns the change of its estimate, if
    /// anything changed.
    pub(super) fn apply(&self, learning: &mut Learning) -> Option<[f64; STATES]> {
        let wanted = self.wanted(&learning.found);
        if wanted == learning.applied {
            return None;
        }
        let moved = moved(learning, &wanted);
        learning.applied = wanted;
        Some(moved)
    }

    /// Takes in the errors of the free runs of the followed model and of the other one in a servo
    /// period, rad. `is_likely` is true where another axis of the machine follows its learned
    /// model.
    pub(super) fn compare(
        &self,
        learning: &mut Learning,
        missed_rad: [f64; 2],
        is_likely: bool,
    ) -> ModelChange {
        let change = learning
            .choice
            .take_in(missed_rad, learning.moves, is_likely);
        if change.begins_anew {
            let Learning {
                commanded_rad_s,
                error_rad,
                command_rad,
                path_rad,
                even_s,
                ..
            } = *learning;
            *learning = Learning {
                commanded_rad_s,
                error_rad,
                command_rad,
                path_rad,
                even_s,
                ..self.begin()
            };
        }
        change
    }

    /// Returns the axis without any difference.
    pub(super) fn nominal(&self) -> AxisModel {
        self.nominal
    }

    /// Returns the axis with the applied differences.
    pub(super) fn known(&self, learning: &Learning) -> AxisModel {
        with(&self.nominal, &learning.applied)
    }
}

impl Learning {
    /// Returns true if the learned model is followed.
    pub(super) fn is_followed(&self) -> bool {
        self.choice.is_learned()
    }
}

/// Returns the change of the estimate from the applied differences to these.
fn moved(learning: &Learning, differences: &Differences) -> [f64; STATES] {
    let mut moved = [0.0; STATES];
    for ((sensitivity, wanted), applied) in learning
        .sensitivities
        .iter()
        .zip(differences)
        .zip(learning.applied)
    {
        moved
            .iter_mut()
            .zip(sensitivity)
            .for_each(|(state, of)| *state += (wanted - applied) * of);
    }
    moved
}

fn dot(a: &Differences, b: &Differences) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::{Parameters, Periods};

    #[test]
    fn differences_make_an_axis_that_a_machine_can_have() {
        let parameters = Parameters {
            inertia_kg_m2: 0.01,
            kp_1_s: 50.0,
            coulomb_friction_nm: 0.2,
            coulomb_smoothing_rad_s: 0.5,
            acceleration_feedforward: 0.8,
            ..Parameters::NOTHING
        };
        let periods = Periods {
            servo_s: 0.001,
            mechanics_s: 0.001,
            mechanics_per_servo: 1,
        };
        let nominal = AxisModel::new(parameters, periods);
        let axis = with(&nominal, &[0.1, -0.2, -1.0, 0.6, 0.5, 0.3, 0.0]);
        assert!((axis.parameters.kp_1_s - 55.0).abs() < 1e-12);
        assert_eq!(
            (
                axis.parameters.velocity_feedforward,
                axis.parameters.drive_delay_s
            ),
            (0.0, 0.0)
        );
        assert!((axis.parameters.coulomb_friction_nm - 0.3).abs() < 1e-12);
        let added = |axis: &AxisModel| {
            axis.parameters.acceleration_feedforward * axis.parameters.inertia_kg_m2
        };
        assert!(
            (added(&axis) - added(&nominal)).abs() < 1e-12,
            "the drive adds what it was set to"
        );
        assert_eq!(with(&nominal, &[0.0; DIFFERENCES]), nominal);
    }
}
