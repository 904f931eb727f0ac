//! Innovations of a filter that knows the axis model, and their response to a load and to the
//! encoder.
//!
//! ```text
//! x <- f(x, reference sent) - load d       every mechanics period, friction and limits as they are
//! e = y - x_angle,   x <- x + K e          once a servo period; states angle, speed, integral, filtered torque, load
//! e = H_t (load) + H_n (encoder)           linear while friction slides: the linear part of f and K alone are in it
//! ```
//!
//! The innovations hold all that the recording shows, whatever K is: K decides how long a deviation
//! is remembered, not what is found. Where friction changes its sign, f has no linear part, and the
//! error of the model is large for a moment. The innovations there are limited to the size of the
//! others.
//!
//! Source: Kailath (1968), An innovations approach to least-squares estimation; Gelb (1974),
//! Applied Optimal Estimation, section 6.1.

use feedwright_control::{
    AxisModel, AxisState, DriveModel, DriveReference, DriveState, MechanicsModel, MechanicsState,
    Parameters, Periods, TableState,
};

use crate::spectrum::{Phasor, transformed};

/// Angle, speed, integral, filtered torque, angle and speed of the table, load.
const STATES: usize = 7;
type FilterVector = [f64; STATES];
type Matrix = [FilterVector; STATES];

/// The load that the filter expects, as a part of the Coulomb friction, and how long it lasts, s:
/// any that is of use to know.
const LOAD_SHARE: f64 = 0.3;
/// See above.
const LOAD_S: f64 = 0.005;
/// Least noise of an encoder, rad: the value of the controller's filter, 0.001 um on a lead of 10
/// mm.
pub(super) const LEAST_NOISE_RAD: f64 = 6e-7;
/// Steps of the Riccati equation: a second at 1 ms, in which all but the load's slowest part has
/// converged.
const RICCATI_STEPS: u32 = 1000;
/// Friction has changed its sign beyond this many of the speeds and deflections over which it
/// changes.
const TURNED: f64 = 4.0;
/// Longest time for which a deviation is remembered, s: after friction has changed its sign, and at
/// the start of a stretch.
const REMEMBERED_S: f64 = 0.02;
/// See above.
const START_S: f64 = 0.1;
/// Limit of the innovations where friction changes its sign, in medians of their sizes: 2.7
/// standard deviations.
const MOST_MEDIANS: f64 = 4.0;

/// An axis as the filter has it.
#[derive(Debug, Clone)]
pub(super) struct AxisFilter {
    axis_model: AxisModel,
    drive: DriveModel,
    mechanics: MechanicsModel,
    /// Mechanics periods from a measurement until it is there plus those from a reference until it
    /// acts.
    late: u32,
    gains: FilterVector,
    linear: Matrix,
    /// Below this speed, rad/s, and within this way of a reversal, rad, friction turns.
    turning: [f64; 2],
}

/// Estimated state of an axis.
#[derive(Debug, Clone, Copy, Default)]
struct FilterState {
    masses: MechanicsState,
    drive: DriveState,
    load_nm: f64,
}

/// Innovations of the filter along a recording, one per servo period.
#[derive(Debug, Clone, Default)]
pub(super) struct Innovations {
    /// Measured less expected, rad.
    pub(super) error_rad: Vec<f64>,
    /// Expected angle of the motor at the measurement, rad.
    pub(super) angle_rad: Vec<f64>,
    /// True where the innovation counts: not at the start of a stretch.
    pub(super) counts: Vec<bool>,
    /// True where friction changes its sign.
    turns: Vec<bool>,
}

impl Innovations {
    /// Holds those at which friction turns to the size of the others.
    fn limit(&mut self) {
        let others = self.error_rad.iter().zip(&self.turns).zip(&self.counts);
        let mut sizes: Vec<f64> = others
            .filter(|((_, turns), counts)| !**turns && **counts)
            .map(|((error, _), _)| error.abs())
            .collect();
        if sizes.is_empty() {
            return;
        }
        let middle = sizes.len() / 2;
        let most = MOST_MEDIANS * *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
        for (error, _) in self
            .error_rad
            .iter_mut()
            .zip(&self.turns)
            .filter(|(_, turns)| **turns)
        {
            *error = error.max(-most).min(most);
        }
    }
}

impl AxisFilter {
    /// Creates the filter of an axis whose encoder has at least this noise, rad.
    pub(super) fn new(nominal: Parameters, periods: Periods, noise_rad: f64) -> Self {
        let axis_model = AxisModel::new(nominal, periods);
        let substeps = |s: f64| (s / periods.mechanics_s).round().max(0.0) as u32;
        let parameters = &axis_model.parameters;
        let mut filter = Self {
            drive: DriveModel::new(&axis_model),
            mechanics: MechanicsModel::new(&axis_model),
            late: substeps(parameters.measurement_delay_s) + substeps(parameters.drive_delay_s),
            gains: [0.0; STATES],
            linear: [[0.0; STATES]; STATES],
            turning: [
                TURNED
                    * parameters
                        .coulomb_smoothing_rad_s
                        .max(0.5 * parameters.stribeck_rad_s),
                TURNED * parameters.presliding_rad,
            ],
            axis_model,
        };
        filter.linear = filter.linear_part();
        let coulomb_nm = axis_model
            .parameters
            .coulomb_friction_nm
            .max(1e-3 * axis_model.parameters.torque_limit_nm);
        filter.gains = filter.kalman(LOAD_SHARE * coulomb_nm, noise_rad.max(LEAST_NOISE_RAD));
        filter
    }

    /// Goes along stretches of commands and measured positions, rad, and puts together what it
    /// finds.
    pub(super) fn innovations<'a>(
        &self,
        stretches: impl Iterator<Item = Vec<[f64; 2]>> + 'a,
    ) -> Innovations {
        let mut found = Innovations::default();
        for stretch in stretches {
            self.stretch(&stretch, &mut found);
        }
        found.limit();
        found
    }

    fn stretch(&self, stretch: &[[f64; 2]], found: &mut Innovations) {
        let servo_s = self.axis_model.periods.servo_s;
        let periods = |s: f64| (s / servo_s).ceil() as usize;
        let Some(&[_, first_rad]) = stretch.first() else {
            return;
        };
        let mut state = FilterState {
            masses: MechanicsState::at_rest(first_rad),
            ..FilterState::default()
        };
        let mut position_loop = (state.masses.motor, DriveState::default());
        let mut sent: Vec<DriveReference> = Vec::with_capacity(stretch.len());
        let (mut turns_for, mut turned_rad, mut forward) = (0, first_rad, true);
        for (n, &[command_rad, measured_rad]) in stretch.iter().enumerate() {
            let error_rad = measured_rad - state.masses.motor.angle_rad;
            let speed_rad_s = state.masses.motor.speed_rad_s;
            if (speed_rad_s > 0.0) != forward {
                (forward, turned_rad) = (speed_rad_s > 0.0, state.masses.motor.angle_rad);
            }
            let [turning_rad_s, turning_rad] = self.turning;
            let turns = speed_rad_s.abs() < turning_rad_s
                || (state.masses.motor.angle_rad - turned_rad).abs() < turning_rad;
            turns_for = if turns {
                periods(REMEMBERED_S)
            } else {
                turns_for.saturating_sub(1)
            };
            found.error_rad.push(error_rad);
            found.angle_rad.push(state.masses.motor.angle_rad);
            found.counts.push(n >= periods(START_S));
            found.turns.push(turns_for > 0);
            self.correct(&mut state, error_rad);
            let (axis, drive) = &mut position_loop;
            axis.angle_rad = measured_rad;
            sent.push(self.drive.position_loop(
                &self.axis_model,
                command_rad,
                measured_rad,
                axis,
                drive,
            ));
            self.servo_period(&mut state, &sent);
        }
    }

    fn correct(&self, state: &mut FilterState, error_rad: f64) {
        let [x, w, i, y, xt, wt, d] = self.gains.map(|gain| gain * error_rad);
        let MechanicsState { motor, table, .. } = &mut state.masses;
        motor.angle_rad += x;
        motor.speed_rad_s += w;
        table.angle_rad += xt;
        table.speed_rad_s += wt;
        state.drive.correct(i, y);
        state.load_nm += d;
    }

    /// Predicts from one measurement to the next. The reference that was sent last acts only after
    /// the whole delay, in mechanics periods.
    fn servo_period(&self, state: &mut FilterState, sent: &[DriveReference]) {
        let per_servo = self.axis_model.periods.mechanics_per_servo;
        for n in 0..per_servo {
            // Time is the time of the measurement.
            let age = (self.late + per_servo - 1 - n) / per_servo;
            let reference = sent
                .len()
                .checked_sub(1 + age as usize)
                .and_then(|at| sent.get(at));
            self.substep(state, reference.copied().unwrap_or_default());
        }
    }

    fn substep(&self, state: &mut FilterState, reference: DriveReference) {
        let speed_rad_s = state.masses.motor.speed_rad_s;
        let drive_nm =
            self.drive
                .torque_nm(&self.axis_model, reference, speed_rad_s, &mut state.drive);
        self.mechanics
            .advance(&mut state.masses, drive_nm, state.load_nm);
    }

    /// The linear part of a servo period while friction slides, by differences.
    fn linear_part(&self) -> Matrix {
        // Far beyond all speeds over which friction turns, and a way that presliding needs.
        let sliding_rad_s =
            100.0 * self.turning[0] + self.turning[1] / self.axis_model.periods.servo_s;
        let reference = DriveReference {
            speed_rad_s: sliding_rad_s,
            torque_nm: 0.0,
        };
        let friction_nm = self.axis_model.friction_nm(sliding_rad_s, 1.0);
        let behind_rad = self
            .mechanics
            .transmission()
            .map_or(0.0, |screw| screw.twist_rad(friction_nm));
        let after = |by: FilterVector| -> FilterVector {
            let [x, w, i, y, xt, wt, d] = by;
            let motor = AxisState {
                angle_rad: x,
                speed_rad_s: sliding_rad_s + w,
                error_rad: 0.0,
            };
            let table = TableState {
                angle_rad: xt - behind_rad,
                speed_rad_s: sliding_rad_s + wt,
            };
            let mut drive = DriveState::default();
            drive.correct(i, y);
            let presliding_nm = self.axis_model.parameters.coulomb_friction_nm;
            let masses = MechanicsState {
                motor,
                table,
                presliding_nm,
            };
            let mut state = FilterState {
                masses,
                drive,
                load_nm: d,
            };
            (0..self.axis_model.periods.mechanics_per_servo)
                .for_each(|_| self.substep(&mut state, reference));
            let (drive, MechanicsState { motor, table, .. }) = (state.drive, state.masses);
            let [integral_nm, filtered_nm] = [drive.integral_nm(), drive.filtered_nm()];
            let [xt, wt] = [table.angle_rad, table.speed_rad_s];
            [
                motor.angle_rad,
                motor.speed_rad_s,
                integral_nm,
                filtered_nm,
                xt,
                wt,
                state.load_nm,
            ]
        };
        // A torque is small beside the limit, a speed is what it makes in a servo period.
        let nm = 1e-3 * self.axis_model.parameters.torque_limit_nm;
        let rad_s = nm / self.axis_model.parameters.inertia_kg_m2 * self.axis_model.periods.servo_s;
        let rad = rad_s * self.axis_model.periods.servo_s;
        let sizes = [rad, rad_s, nm, nm, rad, rad_s, nm];
        let columns: Matrix = std::array::from_fn(|j| {
            let by =
                |sign: f64| std::array::from_fn(|i| if i == j { sign * sizes[j] } else { 0.0 });
            let (more, less) = (after(by(1.0)), after(by(-1.0)));
            std::array::from_fn(|i| (more[i] - less[i]) / (2.0 * sizes[j]))
        });
        std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]))
    }

    /// Returns the states at the end of a servo period after a load of 1 N m within it. No load
    /// remains after the period.
    fn push(&self) -> FilterVector {
        let mut push: FilterVector = std::array::from_fn(|i| self.linear[i][STATES - 1]);
        push[STATES - 1] = 0.0;
        push
    }

    /// Gains for a load that wanders by `load_nm` in [`LOAD_S`] and is new by that in each servo
    /// period, and a noise, rad: by iterating the Riccati equation, Anderson and Moore (1979),
    /// Optimal Filtering, section 4.4.
    fn kalman(&self, load_nm: f64, noise_rad: f64) -> FilterVector {
        let (push, variance) = (self.push(), noise_rad * noise_rad);
        let wander_nm2 = load_nm * load_nm * self.axis_model.periods.servo_s / LOAD_S;
        let mut covariance: Matrix = [[0.0; STATES]; STATES];
        let mut gains = [0.0; STATES];
        for _ in 0..RICCATI_STEPS {
            let seen: FilterVector = std::array::from_fn(|i| covariance[i][0]);
            gains = seen.map(|p| p / (seen[0] + variance));
            let updated: Matrix = std::array::from_fn(|i| {
                std::array::from_fn(|j| covariance[i][j] - gains[i] * seen[j])
            });
            let half: Matrix = std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    (0..STATES).map(|k| self.linear[i][k] * updated[k][j]).sum()
                })
            });
            let inner = |a: &FilterVector, b: &FilterVector| {
                a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>()
            };
            let next = |i: usize, j: usize| {
                let both =
                    0.5 * (inner(&half[i], &self.linear[j]) + inner(&half[j], &self.linear[i]));
                both + load_nm * load_nm * push[i] * push[j]
            };
            covariance = std::array::from_fn(|i| std::array::from_fn(|j| next(i, j)));
            covariance[STATES - 1][STATES - 1] += wander_nm2;
        }
        gains
    }

    /// Returns the response of the innovations to a load of 1 N m in one servo period, and to 1 rad
    /// of the encoder at one measurement: as transforms over `length` samples.
    pub(super) fn responses(&self, length: usize) -> [Vec<Phasor>; 2] {
        let run = |mut off: FilterVector, first: f64| {
            let mut response = vec![first];
            while response.len() < length / 2 {
                response.push(off[0]);
                off = self.off_after(off, off[0]);
            }
            transformed(&response, length)
        };
        // A reading that is too high pulls the states up by the gains.
        let of_noise = self.off_after([0.0; STATES], 1.0);
        [run(self.push(), 0.0), run(of_noise, 1.0)]
    }

    /// Returns the difference between true and estimated states one servo period after such an
    /// innovation.
    fn off_after(&self, off: FilterVector, innovation_rad: f64) -> FilterVector {
        let corrected: FilterVector =
            std::array::from_fn(|i| off[i] - self.gains[i] * innovation_rad);
        std::array::from_fn(|i| {
            self.linear[i]
                .iter()
                .zip(&corrected)
                .map(|(a, x)| a * x)
                .sum()
        })
    }
}
