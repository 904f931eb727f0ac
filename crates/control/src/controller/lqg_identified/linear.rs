//! The linear part of an axis and of its loads, over a mechanics period and over a servo period.
//!
//! | State | Unit | |
//! |---|---|---|
//! | x, w | rad, rad/s | angle and speed of the motor |
//! | i, y | N m | integral of the speed loop, torque after the filter |
//! | n | N m | broadband torque, noise with a correlation time |
//! | p, q | N m | the disturbance and its quadrature: an oscillator that forgets its phase |
//! | d | N m | the remaining load, a random walk |
//! | xt, wt | rad, rad/s | angle and speed of the table; equal to the motor's where the ball screw is rigid |
//!
//! Backlash is not linear, and not included: the flanks are assumed to be in contact. A drive that
//! sees the speed late by L, w - L dw/dt, corresponds to first order to a motor whose inertia is
//! lower by Kv L, which is used here.
//!
//! A sine whose frequency wanders with a standard deviation s keeps its phase for about 1 / s: the
//! oscillator has this memory, and its noise maintains its amplitude.
//!
//! Source: Gelb (1974), Applied Optimal Estimation, section 3.6, for shaping filters of colored
//! noise; sampling as in Franklin, Powell and Workman (1998), section 4.3, here by the same steps
//! as in the plant.

use crate::axis::inverse::integral_gains;
use crate::axis::transmission::TransmissionModel;
use crate::axis::{AxisModel, Parameters};

use super::riccati::{PeriodCost, StateMatrix, applied, inner, product, sum, transposed};

/// Number of states.
pub(super) const STATES: usize = 10;
/// Index of the broadband torque, of the disturbance, and then of its quadrature.
const BROADBAND: usize = 4;
const DISTURBANCE: usize = 5;
/// Index of the remaining load.
const DRIFT: usize = 7;
/// Index of the table's angle: the table moves the cut.
const TABLE: usize = 8;
/// Longest time for which the oscillator remembers its phase, s: with a longer memory it takes
/// longer to find the phase at the start. On `tnv40` with 0.5 um of encoder noise 10 s leave 0.08
/// um RMS, 100 s 0.09.
const LONGEST_MEMORY_S: f64 = 10.0;
/// Random walk of the remaining load, N m in a second for a N m of Coulomb friction and
/// disturbance. The simulation has no such load, except for the parts outside the linear model. On
/// `tnv40` with 0.5 um of encoder noise 0.1 leaves 0.12 um RMS, 0.003 0.08; other machines do not
/// depend on it.
const DRIFT_SHARE: f64 = 0.003;
/// Smallest part of the motor's inertia that remains where the drive sees the speed late. A loop
/// with less would oscillate.
const LEAST_INERTIA: f64 = 0.5;
/// Smallest noise of an encoder, rad: 0.001 um on a lead of 10 mm. Without noise the equations have
/// no solution.
const LEAST_NOISE_RAD: f64 = 6e-7;

/// The linear model of an axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct LinearAxis {
    /// Transition over a mechanics period.
    substep: StateMatrix<STATES>,
    /// Change of the states in it by a reference speed of 1 rad/s, and by a torque of 1 N m added
    /// to the speed loop.
    substep_input: [f64; STATES],
    substep_torque: [f64; STATES],
    /// Covariance of the noise in it.
    substep_noise: StateMatrix<STATES>,
    substeps: u32,
}

/// Change of each state by a unit that is held over a servo period: of reference speed, rad/s, of
/// torque added to the speed loop, and of load, N m.
#[derive(Debug, Clone, Copy)]
pub(super) struct PeriodInputs {
    pub(super) reference: [f64; STATES],
    pub(super) torque: [f64; STATES],
    pub(super) load: [f64; STATES],
}

impl LinearAxis {
    /// Creates the linear model of an axis with its drive, its screw and its loads.
    pub(super) fn new(axis_model: &AxisModel) -> Self {
        let (parameters, dt_s) = (&axis_model.parameters, axis_model.periods.mechanics_s);
        let screw = TransmissionModel::new(axis_model);
        let kv = parameters.kv_nm_s_per_rad;
        let integral = if parameters.speed_integral_s > 0.0 {
            kv * dt_s / parameters.speed_integral_s
        } else {
            0.0
        };
        let filter = dt_s / (dt_s + parameters.filter_lag_s(dt_s));
        let late_nm_s2 = kv * parameters.speed_late_s(dt_s);
        let part_left =
            |inverse_inertia: f64| (1.0 - late_nm_s2 * inverse_inertia).max(LEAST_INERTIA);
        let inertia_kg_m2 = parameters.inertia_kg_m2 * part_left(1.0 / parameters.inertia_kg_m2);
        // Each column is the result of a unit of one state; the second argument is the input of the
        // drive.
        let after = |state: [f64; STATES], [reference_rad_s, torque_nm]: [f64; 2]| {
            let [x, w, i, y, n, p, q, d, xt, wt] = state;
            let error_rad_s = reference_rad_s - w;
            let i = i + integral * error_rad_s;
            let y = y + filter * (kv * error_rad_s + torque_nm + i - y);
            let viscous_nm_s = parameters.viscous_friction_nm_s;
            let [[x, w], [xt, wt]] = match screw {
                Some(screw) => {
                    let through_nm =
                        screw.stiffness_nm_rad * (x - xt) + screw.damping_nm_s * (w - wt);
                    let inverse_inertia =
                        screw.inverse_motor_inertia / part_left(screw.inverse_motor_inertia);
                    let w = w + dt_s * inverse_inertia * (y - through_nm);
                    let left_nm = through_nm - viscous_nm_s * wt - n - p - d;
                    let wt = wt + dt_s * screw.inverse_table_inertia * left_nm;
                    [[x + dt_s * w, w], [xt + dt_s * wt, wt]]
                }
                None => {
                    let left_nm = y - viscous_nm_s * w - n - p - d;
                    let w = w + dt_s / inertia_kg_m2 * left_nm;
                    [[x + dt_s * w, w]; 2]
                }
            };
            let (sin, cos) = libm::sincos(parameters.disturbance_rad_s * dt_s);
            let keep = libm::exp(-dt_s / memory_s(parameters));
            let forget = if parameters.torque_noise_s > 0.0 {
                libm::exp(-dt_s / parameters.torque_noise_s)
            } else {
                0.0
            };
            [
                x,
                w,
                i,
                y,
                forget * n,
                keep * (cos * p + sin * q),
                keep * (cos * q - sin * p),
                d,
                xt,
                wt,
            ]
        };
        let columns: StateMatrix<STATES> = core::array::from_fn(|j| after(unit(j), [0.0; 2]));
        Self {
            substep: transposed(&columns),
            substep_input: after([0.0; STATES], [1.0, 0.0]),
            substep_torque: after([0.0; STATES], [0.0, 1.0]),
            substep_noise: noise(axis_model),
            substeps: axis_model.periods.mechanics_per_servo,
        }
    }

    /// Returns the states, the input and the covariance of the noise over a servo period with a
    /// held reference speed.
    pub(super) fn sampled(&self) -> (StateMatrix<STATES>, [f64; STATES], StateMatrix<STATES>) {
        let mut states = core::array::from_fn(unit);
        let mut covariance = [[0.0; STATES]; STATES];
        for _ in 0..self.substeps {
            states = product(&self.substep, &states);
            let spread = product(
                &product(&self.substep, &covariance),
                &transposed(&self.substep),
            );
            covariance = sum(&spread, &self.substep_noise);
        }
        let input = self.held(&self.substep_input, self.substeps);
        (states, input, covariance)
    }

    /// Returns the change of the states over a number of mechanics periods by an input that adds
    /// this in each of them.
    fn held(&self, substep_input: &[f64; STATES], substeps: u32) -> [f64; STATES] {
        (0..substeps).fold([0.0; STATES], |input, _| {
            let carried = applied(&self.substep, &input);
            core::array::from_fn(|i| carried[i] + substep_input[i])
        })
    }

    /// Returns the change of the states by each input that is held over a servo period.
    pub(super) fn inputs(&self) -> PeriodInputs {
        let (states, reference, _) = self.sampled();
        let torque = self.held(&self.substep_torque, self.substeps);
        let load = core::array::from_fn(|i| if i == DRIFT { 0.0 } else { states[i][DRIFT] });
        PeriodInputs {
            reference,
            torque,
            load,
        }
    }

    /// Returns the variance of the motor's angle after `periods` servo periods, rad^2. Only the
    /// state at their start is known, not the loads and the noise.
    pub(super) fn spread_rad2(&self, axis: &Parameters, periods: u32) -> f64 {
        let (states, _, noise) = self.sampled();
        let swing_nm2 = 0.5 * axis.disturbance_nm * axis.disturbance_nm;
        let broadband_nm2 = axis.torque_noise_nm * axis.torque_noise_nm;
        let mut covariance = [[0.0; STATES]; STATES];
        for (state, nm2) in [
            (BROADBAND, broadband_nm2),
            (DISTURBANCE, swing_nm2),
            (DISTURBANCE + 1, swing_nm2),
        ] {
            covariance[state][state] = nm2;
        }
        for _ in 0..periods {
            covariance = sum(
                &product(&product(&states, &covariance), &transposed(&states)),
                &noise,
            );
        }
        covariance[0][0]
    }

    /// Returns the cost of a servo period: the mean square of the table's position, and a weight on
    /// the input.
    pub(super) fn cost(&self, control_weight_s2: f64) -> PeriodCost<STATES> {
        let mut cost = PeriodCost {
            states: [[0.0; STATES]; STATES],
            cross: [0.0; STATES],
            input: control_weight_s2,
        };
        let (mut states, mut input): (StateMatrix<STATES>, _) =
            (core::array::from_fn(unit), [0.0; STATES]);
        let share = 1.0 / f64::from(self.substeps);
        for _ in 0..self.substeps {
            states = product(&self.substep, &states);
            let carried = applied(&self.substep, &input);
            input = core::array::from_fn(|i| carried[i] + self.substep_input[i]);
            let position = states[TABLE];
            for (i, (row, cross)) in cost.states.iter_mut().zip(&mut cost.cross).enumerate() {
                row.iter_mut()
                    .zip(&position)
                    .for_each(|(sum, other)| *sum += share * position[i] * other);
                *cross += share * position[i] * input[TABLE];
            }
            cost.input += share * input[TABLE] * input[TABLE];
        }
        cost
    }

    /// Returns the loads a mechanics period later.
    pub(super) fn acting_after(&self, acting: &[f64; 4]) -> [f64; 4] {
        let [n, p, q, d] = *acting;
        let state = [0.0, 0.0, 0.0, 0.0, n, p, q, d, 0.0, 0.0];
        let [_, _, _, _, broadband, disturbance, quadrature, drift, ..] = &self.substep;
        [broadband, disturbance, quadrature, drift].map(|row| inner(row, &state))
    }
}

/// The linear axis between two measurements, with a drive that is late.
#[derive(Debug, Clone, Copy)]
pub(super) struct LinearCourse {
    /// Whole servo periods from a measurement until a reference that follows from it acts.
    late: usize,
    /// Transition over a servo period, and over the part of one that this time has beyond them.
    period: StateMatrix<STATES>,
    over_part: StateMatrix<STATES>,
    /// Change of the states by a reference in that part, in the rest of the servo period, and in a
    /// whole one.
    part: [f64; STATES],
    rest: [f64; STATES],
    whole: [f64; STATES],
    /// Change of the reference speed by the integral of the speed loop, for a N m of it.
    by_integral: f64,
}

impl LinearCourse {
    /// Creates the course of an axis whose references act `late` mechanics periods after the
    /// measurement from which they follow.
    pub(super) fn new(axis: &LinearAxis, axis_model: &AxisModel, late: u32) -> Self {
        let substeps = axis.substeps.max(1);
        let beyond = late % substeps;
        let over = |number: u32| {
            (0..number).fold(core::array::from_fn(unit), |states, _| {
                product(&axis.substep, &states)
            })
        };
        let held = |number: u32| axis.held(&axis.substep_input, number);
        let [within, _] = integral_gains(axis_model);
        Self {
            late: (late / substeps) as usize,
            period: over(substeps),
            over_part: over(beyond),
            part: held(beyond),
            rest: held(substeps - beyond),
            whole: held(substeps),
            by_integral: -1.0 / (axis_model.parameters.kv_nm_s_per_rad * (1.0 + within)),
        }
    }

    /// Returns the states a servo period after a measurement. `sent` holds the references, the
    /// newest first: the first follows from that measurement.
    pub(super) fn period_later(&self, states: &[f64; STATES], sent: &[f64]) -> [f64; STATES] {
        let age = |age: usize| sent.get(age).copied().unwrap_or(0.0);
        let (newer, older) = (age(self.late), age(self.late + 1));
        // The older one acts first, for the part.
        let carried = applied(&self.period, states);
        let by_older: [f64; STATES] = core::array::from_fn(|i| self.whole[i] - self.rest[i]);
        core::array::from_fn(|i| carried[i] + self.rest[i] * newer + by_older[i] * older)
    }

    /// Returns the states at the time at which the next reference acts. `sent` holds those before it,
    /// the newest first.
    pub(super) fn ahead(&self, states: &[f64; STATES], sent: &[f64]) -> [f64; STATES] {
        let later = |over, states: &[f64; STATES], input: &[f64; STATES], age: usize| {
            let (carried, reference) =
                (applied(over, states), sent.get(age).copied().unwrap_or(0.0));
            core::array::from_fn(|i| carried[i] + input[i] * reference)
        };
        let after_part = later(&self.over_part, states, &self.part, self.late);
        (0..self.late).rev().fold(after_part, |states, age| {
            later(&self.period, &states, &self.whole, age)
        })
    }

    /// Returns the ideal reference speed of an axis with these states: it makes up for the integral.
    pub(super) fn reference(&self, [_, _, integral_nm, ..]: &[f64; STATES]) -> f64 {
        self.by_integral * integral_nm
    }
}

/// Returns the variance of the measurement, rad^2.
pub(super) fn measured_rad2(axis: &Parameters) -> f64 {
    let step_rad2 = axis.encoder_step_rad * axis.encoder_step_rad / 12.0;
    (axis.encoder_noise_rad * axis.encoder_noise_rad + step_rad2)
        .max(LEAST_NOISE_RAD * LEAST_NOISE_RAD)
}

/// Splits states into the states of the axis and the loads.
pub(super) fn error_and_loads<const S: usize>(states: &[f64; S]) -> [[f64; S]; 2] {
    let of = |loads: bool| {
        core::array::from_fn(|i| {
            if (BROADBAND..=DRIFT).contains(&i) == loads {
                states[i]
            } else {
                0.0
            }
        })
    };
    [of(false), of(true)]
}

fn unit(j: usize) -> [f64; STATES] {
    core::array::from_fn(|i| if i == j { 1.0 } else { 0.0 })
}

/// Returns the time for which the disturbance keeps its phase, s.
fn memory_s(axis: &Parameters) -> f64 {
    let wander_rad_s = axis.disturbance_wander * axis.disturbance_rad_s;
    if wander_rad_s > 0.0 {
        (1.0 / wander_rad_s).min(LONGEST_MEMORY_S)
    } else {
        LONGEST_MEMORY_S
    }
}

/// Returns the covariance of the noise in a mechanics period.
fn noise(axis_model: &AxisModel) -> StateMatrix<STATES> {
    let (axis, dt_s) = (&axis_model.parameters, axis_model.periods.mechanics_s);
    let fresh = |time_s: f64| {
        if time_s > 0.0 {
            1.0 - libm::exp(-2.0 * dt_s / time_s)
        } else {
            1.0
        }
    };
    let broadband_nm2 = axis.torque_noise_nm * axis.torque_noise_nm * fresh(axis.torque_noise_s);
    let amplitude_nm = axis.disturbance_nm;
    let swing_nm2 = 0.5 * amplitude_nm * amplitude_nm * fresh(memory_s(axis));
    let drift_nm = DRIFT_SHARE * (axis.coulomb_friction_nm + amplitude_nm);
    let drift_nm2 = drift_nm * drift_nm * dt_s;
    let variances = [
        0.0,
        0.0,
        0.0,
        0.0,
        broadband_nm2,
        swing_nm2,
        swing_nm2,
        drift_nm2,
        0.0,
        0.0,
    ];
    core::array::from_fn(|i| core::array::from_fn(|j| if i == j { variances[i] } else { 0.0 }))
}
