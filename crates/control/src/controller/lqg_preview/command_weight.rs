//! The regulator whose command is quiet: it pays for the second difference of the command, beside
//! the position error and the speed.
//!
//! ```text
//! v - v_r = K0 o - K1 o1 + K2 o2 - kp (x - x_r) - kd (w - w_r)
//! F = fv + kd       A = fa J / (Kv Ts^2)       K0 = kp + F / Ts + A       K1 = F / Ts + 2 A       K2 = A
//! mean (x - x_r)^2 + p (v - v_r)^2 + q (K0 Ts)^2 (o - 2 o1 + o2)^2          cost of a servo period
//! ```
//!
//! o is by how much the command is off the ideal one, with which the position loop asks an axis on
//! the reference for v_r; o1 and o2 are those of the last two periods, and states. Here the
//! position loop sees x as it is when the command acts. A delay makes no difference to v: the
//! command is solved for it.
//!
//! x and w are angle and speed of the motor. Without q the regulator answers noise of the encoder
//! with a command that alternates. A price for the speed alone does the same to the error that it
//! does to the noise; a price for the second difference lets what is slow pass.
//!
//! A law that is lighter than the machine, under gains of the nominal law, has a pole that moves
//! towards -1: the command alternates. So no inertia is learned below which a real pole of the
//! regulator's loop is left of [`LEFTMOST_POLE`].
//!
//! Source: Anderson and Moore (1990), Optimal Control: Linear Quadratic Methods, section 9.2, for a
//! price on the rate of the input; the price on the difference from an ideal command is our own.

use crate::axis::AxisLaw;
use crate::axis::drive::DriveParameters;
use crate::axis::knowledge::AxisKnowledge;
use crate::axis::mechanics::MechanicsLaw;

use super::linear::{LinearAxis, STATES};
use super::riccati::{PeriodCost, StateMatrix, inner, regulator};

/// States of the regulator: those of the axis, and then o1 and o2, rad.
pub(super) const REGULATED: usize = STATES + 2;
/// Angle and speed of the motor among them.
const ANGLE: usize = 0;
const SPEED: usize = 1;
/// No real pole of the loop of a learned law is left of this.
const LEFTMOST_POLE: f64 = -0.25;
/// Commands that differ by less are the same, rad: by rounding.
const SAME_RAD: f64 = 1e-9;
/// Differences of the inertia that are looked at, a part of it.
const INERTIA_STEP: f64 = 0.02;
const INERTIA_STEPS: u32 = 35;

/// What the position loop makes of commands: K0, K1, K2, kp and kd.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CommandLaw {
    of_commands: [f64; 3],
    kp_1_s: f64,
    kd: f64,
    servo_s: f64,
}

impl CommandLaw {
    /// Of an axis with this drive.
    pub(super) fn new(law: &AxisLaw, drive: &DriveParameters) -> Self {
        let (parameters, servo_s) = (law.parameters, law.periods.servo_s);
        let by_speed = (drive.velocity_feedforward + parameters.kd) / servo_s;
        let by_change = drive.acceleration_feedforward * parameters.inertia_kg_m2
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

    /// v - v_r by each state, beside K0 o.
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

/// What commands were off the ideal ones, rad.
#[derive(Debug, Clone, Copy)]
pub(super) struct CommandHistory {
    /// o1 and o2.
    off_rad: [f64; 2],
    /// The command that was decided on, and its o.
    decided_rad: Option<[f64; 2]>,
}

impl CommandHistory {
    /// Ideal ones.
    pub(super) const IDEAL: Self = Self {
        off_rad: [0.0; 2],
        decided_rad: None,
    };

    /// o1 and o2.
    pub(super) fn off_rad(&self) -> [f64; 2] {
        self.off_rad
    }

    /// A command was decided on by which the reference speed is less by so much than v_r.
    pub(super) fn decide(
        &mut self,
        law: &CommandLaw,
        off: &[f64; REGULATED],
        asked_rad_s: f64,
        command_rad: f64,
    ) {
        let [k0, ..] = law.of_commands;
        self.decided_rad = Some([command_rad, (-asked_rad_s - inner(&law.row(), off)) / k0]);
    }

    /// A command was sent. One that was not decided on counts as ideal: what holds it back is not
    /// to be made up for smoothly.
    pub(super) fn sent(&mut self, command_rad: f64) {
        let off_rad = match self.decided_rad.take() {
            Some([decided_rad, off_rad]) if (command_rad - decided_rad).abs() <= SAME_RAD => {
                off_rad
            }
            _ => 0.0,
        };
        let [last_rad, _] = self.off_rad;
        self.off_rad = [off_rad, last_rad];
    }
}

/// Gains of the regulator by prices p, s^2, and q: the reference speed is less by so much for a
/// unit of each state.
pub(super) fn gains<'a>(
    axis: &'a LinearAxis,
    law: &'a CommandLaw,
) -> impl Fn([f64; 2]) -> [f64; REGULATED] + 'a {
    let (states, input, _) = axis.sampled();
    move |[p_s2, q]| priced(&states, &input, &axis.cost(p_s2), law, q)
}

/// The gains of an axis with these states, this input and this cost of a servo period, and with the
/// price q.
fn priced(
    states: &StateMatrix<STATES>,
    input: &[f64; STATES],
    cost: &PeriodCost<STATES>,
    law: &CommandLaw,
    q: f64,
) -> [f64; REGULATED] {
    if q == 0.0 {
        return widened(&regulator(states, input, cost));
    }
    let (states, input, k0, row) = commanded(states, input, law);
    let q = q * k0 * k0 * law.servo_s * law.servo_s;
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

/// The least difference of the inertia, a part of it, at which the loop of these gains has no real
/// pole left of [`LEFTMOST_POLE`].
pub(super) fn least_inertia(known: &AxisKnowledge, gains: &[f64; REGULATED]) -> f64 {
    let holds = |part: &f64| {
        let mut lighter = *known;
        lighter.parameters.inertia_kg_m2 *= 1.0 + part;
        lighter.drive.acceleration_feedforward /= 1.0 + part;
        let axis = regulated_axis(&lighter);
        let law = CommandLaw::new(&lighter.law(), &lighter.drive);
        let (states, input, _) = axis.sampled();
        let (states, input, k0, row) = commanded(&states, &input, &law);
        let by_offset: [f64; REGULATED] = core::array::from_fn(|i| (gains[i] + row[i]) / k0);
        // The characteristic polynomial has the sign that it has far to the left.
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

/// The axis that is regulated: without the integral of its speed loop and its torque filter.
pub(super) fn regulated_axis(known: &AxisKnowledge) -> LinearAxis {
    let AxisKnowledge {
        drive,
        friction,
        transmission,
        statistics,
        ..
    } = known;
    let law = known.law();
    let mechanics = MechanicsLaw::new(&law, *friction, *transmission);
    let without_integral = DriveParameters {
        speed_window_s: drive.speed_window_s,
        ..DriveParameters::default()
    };
    LinearAxis::new(
        &law,
        &without_integral,
        mechanics.transmission(),
        statistics,
    )
}

/// States and input of the axis with o for its input; K0, and v - v_r by each state.
fn commanded(
    states: &StateMatrix<STATES>,
    input: &[f64; STATES],
    law: &CommandLaw,
) -> (
    StateMatrix<REGULATED>,
    [f64; REGULATED],
    f64,
    [f64; REGULATED],
) {
    let ([k0, ..], row) = (law.of_commands, law.row());
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

/// States of the axis with o1 and o2 behind them.
pub(super) fn with_commands(states: &[f64; STATES], commands: [f64; 2]) -> [f64; REGULATED] {
    let mut all = widened(states);
    (all[STATES], all[STATES + 1]) = (commands[0], commands[1]);
    all
}

/// With nothing of o1 and o2.
fn widened(states: &[f64; STATES]) -> [f64; REGULATED] {
    core::array::from_fn(|i| states.get(i).copied().unwrap_or(0.0))
}

/// By elimination with the largest pivot of each column.
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
    use crate::axis::{Parameters, Periods};

    /// 1 kHz, 50 1/s, a speed loop of 2 ms.
    fn known(drive: DriveParameters) -> AxisKnowledge {
        AxisKnowledge {
            parameters: Parameters {
                rad_per_mm: 0.6,
                kp_1_s: 50.0,
                kd: 0.02,
                kv_nm_s_per_rad: 5.0,
                torque_limit_nm: 30.0,
                inertia_kg_m2: 0.01,
                viscous_friction_nm_s: 0.0,
                coulomb_friction_nm: 0.2,
                coulomb_smoothing_rad_s: 0.5,
            },
            periods: Periods {
                servo_s: 1e-3,
                mechanics_s: 1e-4,
                mechanics_per_servo: 10,
            },
            drive,
            ..AxisKnowledge::NOTHING
        }
    }

    fn with_feedforward() -> AxisKnowledge {
        known(DriveParameters {
            velocity_feedforward: 0.7,
            acceleration_feedforward: 0.4,
            ..DriveParameters::default()
        })
    }

    /// Sums of the squares of the second difference of o and of the angle, while noise is measured.
    fn answers(known: &AxisKnowledge, q: f64) -> [f64; 2] {
        let axis = regulated_axis(known);
        let law = CommandLaw::new(&known.law(), &known.drive);
        let gains = gains(&axis, &law)([1e-8, q]);
        let (states, input, _) = axis.sampled();
        let (states, input, k0, row) = commanded(&states, &input, &law);
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
        for known in [known(DriveParameters::default()), with_feedforward()] {
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
        let law = CommandLaw::new(&known.law(), &known.drive);
        let [none, tiny] = [0.0, 1e-14].map(|q| gains(&axis, &law)([1e-8, q]));
        for (none, tiny) in none.iter().zip(tiny) {
            assert!(
                (none - tiny).abs() <= 1e-4 * none.abs().max(1.0),
                "{none} {tiny}"
            );
        }
    }

    #[test]
    fn a_command_that_was_not_decided_on_counts_as_ideal() {
        let known = with_feedforward();
        let (law, mut history) = (
            CommandLaw::new(&known.law(), &known.drive),
            CommandHistory::IDEAL,
        );
        let mut send = |sent_rad: f64| {
            history.decide(&law, &[0.0; REGULATED], -law.of_commands[0] * 0.01, 3.0);
            history.sent(sent_rad);
            history.off_rad()
        };
        let [last_rad, before_rad] = send(3.0);
        assert!(
            (last_rad - 0.01).abs() < 1e-12 && before_rad == 0.0,
            "{last_rad} {before_rad}"
        );
        assert_eq!(send(2.999), [0.0, last_rad]);
    }

    #[test]
    fn no_law_is_learned_so_light_that_its_loop_alternates() {
        let known = with_feedforward();
        let axis = regulated_axis(&known);
        let law = CommandLaw::new(&known.law(), &known.drive);
        let gains = gains(&axis, &law)([1e-8, 0.0625]);
        let least = least_inertia(&known, &gains);
        assert!((-0.7..0.0).contains(&least), "{least}");
    }
}
