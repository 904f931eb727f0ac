//! The regulator whose command is quiet: its cost includes the second difference of the command, in
//! addition to the position error and the speed.
//!
//! ```text
//! v - v_r = K0 o - K1 o1 + K2 o2 - kp (x - x_r) - kd (w - w_r)
//! F = fv + kd       A = fa J / (Kv Ts^2)       K0 = kp + F / Ts + A       K1 = F / Ts + 2 A       K2 = A
//! mean (x - x_r)^2 + p (v - v_r)^2 + q (K0 Ts)^2 (o - 2 o1 + o2)^2          cost of a servo period
//! ```
//!
//! o is the deviation of the command that was sent from the ideal one, with which the position loop requests v_r
//! for an axis on the reference; o1 and o2 are its values of the last two periods, and states. Here
//! the position loop sees x as it is when the command acts. A delay makes no difference to v: the
//! command is solved for it.
//!
//! x and w are angle and speed of the motor. Without q the regulator answers noise of the encoder
//! with a command that alternates. A weight on the speed alone attenuates the error as much as the
//! noise; a weight on the second difference lets slow changes pass.
//!
//! A model that is lighter than the machine, with the gains of the nominal model, has a pole that
//! moves toward -1: the command alternates. The smallest inertia that is learned therefore keeps
//! every real pole of the regulator's loop right of [`LEFTMOST_POLE`].
//!
//! Source: Anderson and Moore (1990), Optimal Control: Linear Quadratic Methods, section 9.2, for a
//! weight on the rate of the input; the weight on the difference from an ideal command is our own.

use crate::axis::numbers::Part;
use crate::axis::{AxisModel, Parameters};

use super::command_noise::second_difference;
use super::linear::{LinearAxis, STATES};
use super::riccati::{PeriodCost, StateMatrix, applied, inner, regulator};

/// Number of states of the regulator: the states of the axis, and then o1 and o2, rad.
pub(super) const REGULATED: usize = STATES + 2;
/// Index of the angle and of the speed of the motor among them.
const ANGLE: usize = 0;
const SPEED: usize = 1;
/// Leftmost permitted real pole of the loop of a learned model.
const LEFTMOST_POLE: f64 = -0.25;
/// Step of the inertia in the search, as a part of it, and the number of steps.
const INERTIA_STEP: f64 = 0.02;
const INERTIA_STEPS: u32 = 35;

/// Difference up to which commands are equal, rad: rounding.
const SAME_RAD: f64 = 1e-9;

/// Coefficients of the position loop for commands: K0, K1, K2, kp and kd.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CommandModel {
    of_commands: [f64; 3],
    kp_1_s: f64,
    kd: f64,
    servo_s: f64,
}

impl CommandModel {
    /// Creates the coefficients of an axis.
    pub(super) fn new(axis_model: &AxisModel) -> Self {
        let (parameters, servo_s) = (axis_model.parameters, axis_model.periods.servo_s);
        let by_speed = (parameters.velocity_feedforward + parameters.kd) / servo_s;
        let by_change = parameters.acceleration_feedforward * parameters.inertia_kg_m2
            / (parameters.kv_nm_s_per_rad * servo_s * servo_s);
        Self {
            of_commands: [
                parameters.kp_1_s + by_speed + by_change,
                by_speed + 2.0 * by_change,
                by_change,
            ],
            kp_1_s: parameters.kp_1_s,
            kd: parameters.kd,
            servo_s,
        }
    }

    /// Returns K2, 1/s.
    pub(super) fn by_change_1_s(&self) -> f64 {
        let [_, _, by_change] = self.of_commands;
        by_change
    }

    /// Returns o by K0 o - K1 o1 + K2 o2.
    pub(super) fn solved(&self, sum: f64, [o1, o2]: [f64; 2]) -> f64 {
        let [k0, k1, k2] = self.of_commands;
        (sum + k1 * o1 - k2 * o2) / k0
    }

    /// Returns the offset for a unit of reference speed, s.
    pub(super) fn by_speed_s(&self) -> f64 {
        let [k0, ..] = self.of_commands;
        1.0 / k0
    }

    /// Returns the reference speed that a command gives beside those of the last two periods.
    pub(super) fn by_commands(&self, command: f64, [last, before]: [f64; 2]) -> f64 {
        let [k0, k1, k2] = self.of_commands;
        k0 * command - k1 * last + k2 * before
    }

    /// Returns what a command has to add for a measured angle and the one before.
    pub(super) fn by_angle(&self, angle_rad: f64, before_rad: f64) -> f64 {
        self.kp_1_s * angle_rad + self.kd * (angle_rad - before_rad) / self.servo_s
    }

    /// Returns v - v_r by each state, without K0 o.
    fn row(&self) -> [f64; REGULATED] {
        let Self {
            of_commands: [_, k1, k2],
            kp_1_s,
            kd,
            ..
        } = *self;
        let mut row = [0.0; REGULATED];
        (row[ANGLE], row[SPEED], row[STATES], row[STATES + 1]) = (-kp_1_s, -kd, -k1, k2);
        row
    }
}

/// Deviations of the commands from the ideal ones, rad.
#[derive(Debug, Clone, Copy)]
pub(super) struct CommandHistory {
    /// o1 and o2.
    off_rad: [f64; 2],
    /// The decided command, and its o.
    decided_rad: Option<[f64; 2]>,
}

impl CommandHistory {
    /// State after ideal commands.
    pub(super) const IDEAL: Self = Self {
        off_rad: [0.0; 2],
        decided_rad: None,
    };

    /// Returns o1 and o2.
    pub(super) fn off_rad(&self) -> [f64; 2] {
        self.off_rad
    }

    /// Stores a decided command, whose reference speed is `asked_rad_s` below v_r.
    pub(super) fn decide(
        &mut self,
        axis_model: &CommandModel,
        off: &[f64; REGULATED],
        asked_rad_s: f64,
        command_rad: f64,
    ) {
        let [k0, ..] = axis_model.of_commands;
        self.decided_rad = Some([
            command_rad,
            (-asked_rad_s - inner(&axis_model.row(), off)) / k0,
        ]);
    }

    /// Forgets the decided command.
    pub(super) fn forget_decision(&mut self) {
        self.decided_rad = None;
    }

    /// Takes in a sent command. One that was not decided counts as ideal, unless `counts`: then as
    /// it was sent. The regulator must not make up smoothly for a part that is left out on purpose,
    /// but it has to know what the limits of its axis have cut off.
    pub(super) fn sent(&mut self, command_rad: f64, counts: bool) {
        let off_rad = match self.decided_rad.take() {
            Some([decided_rad, off_rad])
                if counts || (command_rad - decided_rad).abs() <= SAME_RAD =>
            {
                off_rad + (command_rad - decided_rad)
            }
            _ => 0.0,
        };
        let [last_rad, _] = self.off_rad;
        self.off_rad = [off_rad, last_rad];
    }
}

/// Returns the gains of the regulator by the weights p, s^2, and q: the reduction of the reference
/// speed for a unit of each state.
pub(super) fn gains<'a>(
    axis: &'a LinearAxis,
    axis_model: &'a CommandModel,
) -> impl Fn([f64; 2]) -> [f64; REGULATED] + 'a {
    let (states, input, _) = axis.sampled();
    move |[p_s2, q]| weighted(&states, &input, &axis.cost(p_s2), axis_model, q)
}

/// Returns the gains of an axis with these states, this input and this cost of a servo period, and
/// with the weight q.
fn weighted(
    states: &StateMatrix<STATES>,
    input: &[f64; STATES],
    cost: &PeriodCost<STATES>,
    axis_model: &CommandModel,
    q: f64,
) -> [f64; REGULATED] {
    if q == 0.0 {
        return widened(&regulator(states, input, cost));
    }
    let (states, input, k0, row) = commanded(states, input, axis_model);
    let q = q * k0 * k0 * axis_model.servo_s * axis_model.servo_s;
    let PeriodCost {
        states: of_states,
        cross,
        input: of_input,
    } = *cost;
    let cross = widened(&cross);
    let of_states: [[f64; REGULATED]; STATES] = of_states.map(|row| widened(&row));
    let mut difference = [0.0; REGULATED];
    (difference[STATES], difference[STATES + 1]) = (-2.0, 1.0);
    let state_cost = |i: usize, j: usize| {
        of_states.get(i).map_or(0.0, |row| row[j])
            + cross[i] * row[j]
            + row[i] * cross[j]
            + of_input * row[i] * row[j]
            + q * difference[i] * difference[j]
    };
    let cost = PeriodCost {
        states: core::array::from_fn(|i| core::array::from_fn(|j| state_cost(i, j))),
        cross: core::array::from_fn(|i| k0 * (cross[i] + of_input * row[i]) + q * difference[i]),
        input: k0 * k0 * of_input + q,
    };
    let of_offset = regulator(&states, &input, &cost);
    core::array::from_fn(|i| k0 * of_offset[i] - row[i])
}

/// Returns the RMS of the second difference of the command with these gains, rad. Innovations with
/// this variance, rad^2, enter the states of the axis by `filter`, and `late` servo periods pass
/// until the command acts.
pub(super) fn noise_rad(
    axis: &LinearAxis,
    axis_model: &CommandModel,
    gains: &[f64; REGULATED],
    (filter, variance_rad2, late): ([f64; STATES], f64, u32),
) -> f64 {
    let (states, input, _) = axis.sampled();
    let enters = (0..late).fold(filter, |enters, _| applied(&states, &enters));
    let (states, input, k0, row) = commanded(&states, &input, axis_model);
    let by_offset: [f64; REGULATED] = core::array::from_fn(|i| (gains[i] + row[i]) / k0);
    let closed =
        core::array::from_fn(|i| core::array::from_fn(|j| states[i][j] - input[i] * by_offset[j]));
    let mut difference = by_offset.map(|gain| -gain);
    difference[STATES] -= 2.0;
    difference[STATES + 1] += 1.0;
    second_difference(&closed, &widened(&enters), &difference, variance_rad2)
}

/// Returns the smallest difference of the inertia, as a part of it, at which the loop of these
/// gains has no real pole left of [`LEFTMOST_POLE`].
pub(super) fn least_inertia(known: &AxisModel, gains: &[f64; REGULATED]) -> f64 {
    let holds = |part: &f64| {
        let lighter = known.with(|axis| {
            axis.inertia_kg_m2 *= 1.0 + part;
            axis.acceleration_feedforward /= 1.0 + part;
        });
        let axis = regulated_axis(&lighter);
        let axis_model = CommandModel::new(&lighter);
        let (states, input, _) = axis.sampled();
        let (states, input, k0, row) = commanded(&states, &input, &axis_model);
        let by_offset: [f64; REGULATED] = core::array::from_fn(|i| (gains[i] + row[i]) / k0);
        // The characteristic polynomial has the same sign as far to the left.
        determinant(core::array::from_fn(|i| {
            core::array::from_fn(|j| {
                let pole = if i == j { LEFTMOST_POLE } else { 0.0 };
                pole - states[i][j] + input[i] * by_offset[j]
            })
        })) > 0.0
    };
    (1..=INERTIA_STEPS)
        .map(|n| -INERTIA_STEP * f64::from(n))
        .take_while(holds)
        .last()
        .unwrap_or(0.0)
}

/// Returns the axis that is regulated: without the integral of its speed loop and its torque
/// filter.
pub(super) fn regulated_axis(axis_model: &AxisModel) -> LinearAxis {
    LinearAxis::new(&axis_model.with(|axis| {
        let speed_window_s = axis.speed_window_s;
        *axis = Parameters {
            speed_window_s,
            ..axis.without(&[Part::Drive])
        };
    }))
}

/// Returns states and input of the axis with o as its input, K0, and v - v_r by each state.
fn commanded(
    states: &StateMatrix<STATES>,
    input: &[f64; STATES],
    axis_model: &CommandModel,
) -> (
    StateMatrix<REGULATED>,
    [f64; REGULATED],
    f64,
    [f64; REGULATED],
) {
    let ([k0, ..], row) = (axis_model.of_commands, axis_model.row());
    let mut commanded = [[0.0; REGULATED]; REGULATED];
    for ((to, of_axis), input) in commanded.iter_mut().zip(states).zip(input) {
        let of_axis = widened(of_axis);
        *to = core::array::from_fn(|j| of_axis[j] + input * row[j]);
    }
    commanded[STATES + 1][STATES] = 1.0;
    let mut of_offset = widened(input).map(|input| k0 * input);
    of_offset[STATES] = 1.0;
    (commanded, of_offset, k0, row)
}

/// Returns the states of the axis followed by o1 and o2.
pub(super) fn with_commands(states: &[f64; STATES], commands: [f64; 2]) -> [f64; REGULATED] {
    let mut all = widened(states);
    (all[STATES], all[STATES + 1]) = (commands[0], commands[1]);
    all
}

/// Returns the states of the axis with zero o1 and o2.
fn widened(states: &[f64; STATES]) -> [f64; REGULATED] {
    core::array::from_fn(|i| states.get(i).copied().unwrap_or(0.0))
}

/// Computes the determinant by elimination with the largest pivot of each column.
fn determinant(mut a: StateMatrix<REGULATED>) -> f64 {
    let mut determinant = 1.0;
    for i in 0..REGULATED {
        let pivot = (i..REGULATED).fold(i, |best, row| {
            if a[row][i].abs() > a[best][i].abs() {
                row
            } else {
                best
            }
        });
        if pivot != i {
            a.swap(i, pivot);
            determinant = -determinant;
        }
        let (above, below) = a.split_at_mut(i + 1);
        let pivot = &above[i];
        determinant *= pivot[i];
        for row in below {
            let factor = row[i] / pivot[i];
            row.iter_mut()
                .zip(pivot)
                .for_each(|(a, pivot)| *a -= factor * pivot);
        }
    }
    determinant
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::Periods;

    /// 1 kHz, 50 1/s, a speed loop of 2 ms.
    fn known(velocity_feedforward: f64, acceleration_feedforward: f64) -> AxisModel {
        let parameters = Parameters {
            rad_per_mm: 0.6,
            kp_1_s: 50.0,
            kd: 0.02,
            kv_nm_s_per_rad: 5.0,
            torque_limit_nm: 30.0,
            inertia_kg_m2: 0.01,
            viscous_friction_nm_s: 0.0,
            coulomb_friction_nm: 0.2,
            coulomb_smoothing_rad_s: 0.5,
            velocity_feedforward,
            acceleration_feedforward,
            ..Parameters::NOTHING
        };
        let periods = Periods {
            servo_s: 1e-3,
            mechanics_s: 1e-4,
            mechanics_per_servo: 10,
        };
        AxisModel::new(parameters, periods)
    }

    fn with_feedforward() -> AxisModel {
        known(0.7, 0.4)
    }

    /// Sums of the squares of the second difference of o and of the angle, while noise is measured.
    fn answers(known: &AxisModel, q: f64) -> [f64; 2] {
        let axis = regulated_axis(known);
        let axis_model = CommandModel::new(known);
        let gains = gains(&axis, &axis_model)([1e-8, q]);
        let (states, input, _) = axis.sampled();
        let (states, input, k0, row) = commanded(&states, &input, &axis_model);
        let (mut x, mut bend, mut error) = ([0.0; REGULATED], 0.0, 0.0);
        for n in 0..2000_u32 {
            let mut seen = x;
            // Noise that is white enough: the digits of a multiple.
            seen[ANGLE] += 1e-6 * (f64::from(n * 7919 % 1009) / 504.5 - 1.0);
            let offset = -(0..REGULATED)
                .map(|i| (gains[i] + row[i]) / k0 * seen[i])
                .sum::<f64>();
            let second = offset - 2.0 * x[STATES] + x[STATES + 1];
            x = core::array::from_fn(|i| {
                states[i].iter().zip(&x).map(|(a, x)| a * x).sum::<f64>() + input[i] * offset
            });
            (bend, error) = (bend + second * second, error + x[ANGLE] * x[ANGLE]);
        }
        [bend, error]
    }

    #[test]
    fn a_weight_makes_the_command_quiet_under_noise() {
        for known in [known(0.0, 0.0), with_feedforward()] {
            let [[loud, before], [quiet, after]] = [0.0, 0.0625].map(|q| answers(&known, q));
            assert!(
                quiet < 0.5 * loud && after < before,
                "{loud} {quiet}, {before} {after}"
            );
        }
    }

    #[test]
    fn without_a_weight_the_gains_are_those_of_the_axis_alone() {
        let known = with_feedforward();
        let axis = regulated_axis(&known);
        let axis_model = CommandModel::new(&known);
        let [none, tiny] = [0.0, 1e-14].map(|q| gains(&axis, &axis_model)([1e-8, q]));
        for (none, tiny) in none.iter().zip(tiny) {
            assert!(
                (none - tiny).abs() <= 1e-4 * none.abs().max(1.0),
                "{none} {tiny}"
            );
        }
    }

    #[test]
    fn a_command_that_a_bound_changed_counts_as_it_was_sent() {
        let known = with_feedforward();
        let (axis_model, mut history) = (CommandModel::new(&known), CommandHistory::IDEAL);
        let mut send = |sent_rad: f64, counts: bool| {
            history.decide(
                &axis_model,
                &[0.0; REGULATED],
                -axis_model.of_commands[0] * 0.01,
                3.0,
            );
            history.sent(sent_rad, counts);
            history.off_rad()
        };
        let [last_rad, before_rad] = send(3.0, false);
        assert!(
            (last_rad - 0.01).abs() < 1e-12 && before_rad == 0.0,
            "{last_rad} {before_rad}"
        );
        let [changed_rad, before_rad] = send(2.999, true);
        assert!(
            (changed_rad - 0.009).abs() < 1e-12 && before_rad == last_rad,
            "{changed_rad} {before_rad}"
        );
        assert_eq!(send(2.999, false), [0.0, changed_rad]);
    }

    #[test]
    fn no_model_is_learned_so_light_that_its_loop_alternates() {
        let known = with_feedforward();
        let axis = regulated_axis(&known);
        let axis_model = CommandModel::new(&known);
        let gains = gains(&axis, &axis_model)([1e-8, 0.0625]);
        let least = least_inertia(&known, &gains);
        assert!((-0.7..0.0).contains(&least), "{least}");
    }
}
