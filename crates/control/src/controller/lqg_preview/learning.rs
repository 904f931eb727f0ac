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
//! Free runs decide which of the two models is followed. Both begin at the states of their filters,
//! and miss the measurement by m:
//!
//! ```text
//! l <- l + ln (<m^2> + e^2) / (<m_learned^2> + e^2)        over a free run
//! e^2 = (0.1 um)^2 + 16 variances of the measurement + the mean square error of a free run by unforeseen loads
//! ```
//!
//! The learned model is followed from l = 6.9 on, and no longer below 0: of correct nominal models,
//! one in a thousand is replaced (Wald). Where another axis of the machine follows its learned
//! model, one in a hundred, l = 4.6: with a correct model in one axis and a wrong one in the other,
//! the axes lag by different times. With 2.3 in place of 6.9, 36 cuts with wrong models leave 0.069
//! of the error in the median in place of 0.087, and with 0 one of them is worse. A run counts once,
//! however long: its error at its end stems from its beginning. Every 4 ms the run is checked: a
//! run that alone is sufficient evidence for the learned model counts at once. l counts up to 13.8
//! (Page), so that a change is noticed. A learned model that is certainly worse is begun anew. A
//! nominal model whose errors are within the noise stays as it is to the bit.
//!
//! Differences 2, 3 and 6 are learned only within [`EVEN_S`] of an acceleration of the path. At
//! constant speed there is no evidence on them, and effects outside the model, such as cogging, are
//! mistaken for them: on a plate in inches a correct inertia is then halved.
//!
//! Rejected alternatives: innovations in place of free runs rejected correct models, because steps
//! of an encoder are not white noise. A single filter with the nominal model, whose innovations are
//! computed, cannot decide: its own first order states that they are large. Least squares on the
//! innovations of the nominal filter diverge where those are bounded as outliers. Where both models
//! miss alike, by a load that neither has, l is a random walk, which reaches 6.9 sooner or later:
//! along 20 programs recorded in LinuxCNC, a model identified on `tnv40` left 0.063 and 0.059 of
//! the error in two, and 0.023 and 0.010 where it was kept. With d^2 / 2 subtracted in each run,
//! where d is the logarithm, l hardly reaches it (de la Pena, 1999). But then one of the cuts with
//! models of other machines is worse (linuxcnc/servo/tests/property_wrong_model.rs).
//!
//! Source: Friedland (1969), Treatment of bias in recursive filtering, IEEE Trans. Automatic
//! Control 14(4), for the two filters; Kulhavy (1987), Restricted exponential forgetting in
//! real-time identification, Automatica 23(5); Wald (1947), Sequential Analysis, and Page (1954),
//! Continuous inspection schemes, Biometrika 41, for the test.

use crate::axis::AxisModel;
use crate::axis::drive::DriveReference;
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
const BELIEVED: f64 = 3.0;
/// Speed below which an axis shows its friction at rest, mm/s.
const SLOWEST_MM_S: f64 = 1.0;
/// l above which the learned model is followed: of correct nominal models, one in a thousand is
/// replaced.
const CERTAIN: f64 = 6.9;
/// The same where another axis follows its learned model: one in a hundred.
const LIKELY: f64 = 4.6;
/// Largest l, and its largest change at once.
const MOST_CERTAIN: f64 = 2.0 * CERTAIN;
const MOST_OF_RUN: f64 = 7.0;
/// Standard deviations of the measurement that the encoder explains.
const DEVIATIONS: f64 = 4.0;
/// Time between two checks of the free runs, s.
const COMPARED_S: f64 = 0.004;

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
    compared_periods: u32,
}

/// Errors of free runs of the two models.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Runs {
    /// Sums of squares of the followed model and of the other one, rad^2, and the length of these
    /// runs, servo periods.
    missed_rad2: [f64; 2],
    periods: u32,
    /// l before these runs, and l with their evidence.
    before: f64,
    learned: f64,
}

impl Runs {
    const NONE: Self = Self {
        missed_rad2: [0.0; 2],
        periods: 0,
        before: 0.0,
        learned: 0.0,
    };

    /// Evaluates the errors of the runs, in which the learned model was followed or not;
    /// `noise_rad2` is the part of a servo period that noise explains. Unfinished runs count only
    /// if they alone are sufficient evidence for the learned model.
    fn look(&mut self, is_followed: bool, noise_rad2: f64, is_over: bool) {
        let explained_rad2 = f64::from(self.periods) * noise_rad2;
        let [followed, other] = self.missed_rad2.map(|rad2| rad2 + explained_rad2);
        let likelier = libm::log(if is_followed {
            other / followed
        } else {
            followed / other
        });
        let likelier = if likelier.is_nan() {
            -MOST_OF_RUN
        } else {
            bounded(likelier, -MOST_OF_RUN, MOST_OF_RUN)
        };
        if is_over || likelier >= CERTAIN {
            self.learned = bounded(self.before + likelier, -CERTAIN, MOST_CERTAIN);
        }
        if is_over {
            (self.missed_rad2, self.periods, self.before) = ([0.0; 2], 0, self.learned);
        }
    }
}

/// Result of a comparison of the two models.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct ModelChoice {
    /// True if the other model is followed from now on.
    pub(super) turns: bool,
    /// True if the learned model is the nominal one again.
    pub(super) begins_anew: bool,
}

/// State of the learning of an axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct Learning {
    sensitivities: [[f64; STATES]; DIFFERENCES],
    found: Differences,
    covariance: [[f64; DIFFERENCES]; DIFFERENCES],
    applied: Differences,
    is_followed: bool,
    moves: bool,
    /// Mean square of the residual, rad^2.
    left_rad2: f64,
    runs: Runs,
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
        // The cast saturates where the float is too large or NaN.
        let compared_periods = (libm::round(COMPARED_S / nominal.periods.servo_s) as u32).max(1);
        Self {
            nominal,
            states,
            inputs: linear.inputs(),
            priors,
            bounds,
            noise_rad2,
            compared_periods,
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
            is_followed: false,
            moves: false,
            left_rad2: 0.0,
            runs: Runs::NONE,
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
    pub(super) fn doubt(&self, learning: &mut Learning) {
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
        told: &Innovation,
    ) {
        let speed_rad_s = self.predict(learning, model, run, told);
        let slowest_rad_s = SLOWEST_MM_S * self.nominal.parameters.rad_per_mm;
        learning.moves = speed_rad_s.abs() > slowest_rad_s;
        if learning.moves && told.missed_rad.is_finite() {
            self.learn(learning, told);
        }
        for sensitivity in &mut learning.sensitivities {
            let [angle, ..] = *sensitivity;
            sensitivity
                .iter_mut()
                .zip(told.gains)
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
        told: &Innovation,
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
                parameters.inertia_kg_m2 * told.pushed_rad
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
    fn learn(&self, learning: &mut Learning, told: &Innovation) {
        let servo_s = self.nominal.periods.servo_s;
        let mut shows: Differences = learning.sensitivities.map(|[angle, ..]| angle);
        if learning.even_s > EVEN_S {
            OF_ACCELERATION.into_iter().for_each(|i| shows[i] = 0.0);
        }
        let of_nominal_rad = told.missed_rad + dot(&shows, &learning.applied);
        let left_rad = of_nominal_rad - dot(&shows, &learning.found);
        let spreads: Differences = learning.covariance.map(|row| dot(&row, &shows));
        let second_rad = FIRST_ORDER * of_nominal_rad;
        let noise_rad2 =
            COLOURED * told.expected_rad2.max(learning.left_rad2) + second_rad * second_rad;
        let variance_rad2 = noise_rad2 + dot(&shows, &spreads);
        let believed_rad = BELIEVED * libm::sqrt(variance_rad2);
        let left_rad = bounded(left_rad, -believed_rad, believed_rad);
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
    ) -> ModelChoice {
        let was_followed = learning.is_followed;
        let runs = &mut learning.runs;
        let [followed_rad, other_rad] = missed_rad;
        if !(if was_followed {
            followed_rad
        } else {
            other_rad
        })
        .is_finite()
        {
            runs.learned = -CERTAIN;
        } else if learning.moves {
            runs.missed_rad2
                .iter_mut()
                .zip(missed_rad)
                .for_each(|(sum, rad)| *sum += rad * rad);
            runs.periods += 1;
            let is_over = runs.periods >= run_periods(self.nominal.periods.servo_s);
            if is_over || runs.periods.is_multiple_of(self.compared_periods) {
                runs.look(was_followed, self.noise_rad2, is_over);
            }
        }
        learning.is_followed = runs.learned
            > if was_followed {
                0.0
            } else if is_likely {
                LIKELY
            } else {
                CERTAIN
            };
        let turns = was_followed != learning.is_followed;
        let begins_anew = was_followed && turns || learning.runs.learned <= -CERTAIN;
        if begins_anew {
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
        ModelChoice { turns, begins_anew }
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
        self.is_followed
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

    /// Returns l after a number of comparisons. The nominal model misses by the first angle, the
    /// learned one by the second, rad; noise is 1 rad.
    fn after(times: u32, [nominal_rad, learned_rad]: [f64; 2]) -> f64 {
        let mut runs = Runs::NONE;
        for _ in 0..times {
            (runs.missed_rad2, runs.periods) =
                ([nominal_rad * nominal_rad, learned_rad * learned_rad], 1);
            runs.look(false, 1.0, true);
        }
        runs.learned
    }

    #[test]
    fn two_models_that_differ_by_what_noise_explains_are_not_told_apart_soon() {
        assert!(after(10, [0.5, 0.1]) < CERTAIN);
        assert_eq!(after(100, [1.0, 1.0]), 0.0);
        assert!(
            after(1, [100.0, 0.0]) > CERTAIN,
            "one run is enough where it is beyond doubt"
        );
        assert!(
            after(1, [20.0, 0.0]) < CERTAIN && after(2, [20.0, 0.0]) > CERTAIN,
            "and two are soon"
        );
        assert_eq!(after(100, [1.0, 100.0]), -CERTAIN);
        assert_eq!(after(2, [1.0, f64::NAN]), -CERTAIN);
        assert_eq!(after(100, [100.0, 1.0]), MOST_CERTAIN);
    }

    #[test]
    fn a_learned_model_that_is_followed_is_judged_the_other_way_round() {
        let mut runs = Runs {
            missed_rad2: [1e4, 0.0],
            periods: 1,
            ..Runs::NONE
        };
        runs.look(true, 1.0, true);
        assert_eq!(runs.learned, -CERTAIN);
    }

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
