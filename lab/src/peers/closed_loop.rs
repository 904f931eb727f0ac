//! The closed position loop of an axis from command to position, sampled once a servo period, and
//! the filter that inverts it.
//!
//! The model of an axis without Coulomb friction and limits is linear. Its states are the motor,
//! the integral of the speed loop and the torque filter. The position loop sends a reference speed
//! v and a torque u at the start of a servo period. They act for one period, after the drive delay:
//!
//! ```text
//! x = (Nv v + Nu u) / D                    D the characteristic polynomial, N = D h, h the positions after one period of v or u
//! v = K (c - xm) + fv (1 - z^-1) / Ts c,   u = fa J ((1 - z^-1) / Ts)^2 c,   K = kp + kd (1 - z^-1) / Ts
//! x / c = z^-n B / A                       B = Nv (K + fv (1 - z^-1) / Ts) + Nu fa J ((1 - z^-1) / Ts)^2,   A = D + Nm K
//! ```
//!
//! n is the number of servo periods by which the position loop has commands late. xm is the
//! position one measurement delay ago, and Nm is its N for v. The axis model itself is simulated to
//! find h. Zeros of B well inside the unit circle are canceled. So are zeros inside it with a
//! positive real part, whose inverse does not ring. For the other zeros only the phase is canceled.
//!
//! Source: Tomizuka (1987), "Zero phase error tracking algorithm for digital control"; D by Faddeev
//! and LeVerrier, Gantmacher (1959), The Theory of Matrices, chapter IV; zeros as eigenvalues of
//! the companion matrix by the QR algorithm, Golub and Van Loan (2013), Matrix Computations,
//! section 7.5.
//!
//! Departures: the delay of the drive and the delay of the measurement are each limited to half of
//! [`MAX_DELAY_PERIODS`]. The encoder delay of the response to u is taken from the response to v,
//! as Nu Nm / Nv. The two differ by the action of the integral within a servo period: less than
//! 1e-4 of the position.
//!
//! Symbols: as in [`feedwright_control::axis::drive`]. Polynomials are in ascending powers of z^-1.
use feedwright_control::{
    AxisModel, AxisState, DriveModel, DriveReference, DriveState, Parameters,
};
use feedwright_sim::{KnownAxis, Period};
use nalgebra::{ComplexField, DMatrix, SMatrix, Schur};

use crate::peers::zero_phase::Filter;

/// States: angle and speed of the motor, integral of the speed loop, torque behind the filter.
const STATES: usize = 4;
/// Longest delays, both ways together, servo periods: with them the filter has as many weights as
/// it may have.
const MAX_DELAY_PERIODS: u32 = 40;
/// A zero on the side that rings is cancelled within this circle: what it leaves is gone to a
/// thousandth in ten periods.
const SOON_GONE: f64 = 0.5;
/// Coefficients below this part of the largest are rounding.
const ROUNDING: f64 = 1e-12;
/// Rounds of the QR iteration for the zeros; those of a sampled drive are found in a few for each.
const ROUNDS: usize = 1000;

type Complex = nalgebra::Complex<f64>;

/// The filter that inverts the closed loop of an axis, with other nominal parameters; none where it
/// has no inverse.
pub(super) fn inverting(axis: &KnownAxis, nominal: &Parameters, period: &Period) -> Option<Filter> {
    let (numerator, denominator) = ClosedAxis::new(axis, nominal, period).transfer(nominal);
    let largest = numerator
        .iter()
        .fold(0.0_f64, |most, value| most.max(value.abs()));
    let is_there = |value: &f64| value.abs() > ROUNDING * largest;
    let late = numerator.iter().position(is_there)?;
    let last = numerator.iter().rposition(is_there)?;
    let zeros = zeros(&numerator[late..=last])?;
    let (cancelled, mirrored): (Vec<Complex>, Vec<Complex>) = zeros.into_iter().partition(|zero| {
        let size = zero.modulus();
        size <= SOON_GONE || (size < 1.0 && zero.re > 0.0)
    });
    // B-(z) has the coefficients of B-(1/z) in reverse order, one period ahead for each zero.
    let ahead = axis.nominal.command_periods(period.servo_s) + late + mirrored.len();
    let mut mirror = with_zeros(&mirrored);
    mirror.reverse();
    let of_reference = times(&denominator, &mirror);
    Filter::of_loop(
        &of_reference,
        u32::try_from(ahead).ok()?,
        &with_zeros(&cancelled),
    )
}

/// The linear part of an axis with its drive.
struct ClosedAxis {
    axis_model: AxisModel,
    drive: DriveModel,
    parameters: Parameters,
    /// Delays of the drive and of the measurement, mechanics periods.
    late: [u32; 2],
    /// Torque of the drive's acceleration feedforward for a change of the commanded speed, N m
    /// s/rad.
    torque_for_change: f64,
}

impl ClosedAxis {
    fn new(axis: &KnownAxis, nominal: &Parameters, period: &Period) -> Self {
        let linear = Parameters {
            torque_limit_nm: f64::INFINITY,
            speed_limit_rad_s: 0.0,
            coulomb_friction_nm: 0.0,
            ..*nominal
        };
        let axis_model = AxisModel::new(linear, period.periods());
        let parameters = axis_model.parameters;
        let longest = MAX_DELAY_PERIODS / 2 * period.mechanics_per_servo;
        // A float that is not a number saturates to zero here.
        let late = |delay_s: f64| ((delay_s / period.mechanics_s).round() as u32).min(longest);
        Self {
            axis_model,
            drive: DriveModel::new(&axis_model),
            parameters,
            late: [parameters.drive_delay_s, parameters.measurement_delay_s].map(late),
            // What the drive is set to, whatever the inertia is taken for.
            torque_for_change: parameters.acceleration_feedforward * axis.nominal.inertia_kg_m2
                / period.servo_s,
        }
    }

    /// One mechanics period.
    fn substep(&self, reference: DriveReference, axis: &mut AxisState, drive: &mut DriveState) {
        let (model, w) = (&self.axis_model, axis.speed_rad_s);
        let torque_nm = self.drive.torque_nm(model, reference, w, drive);
        model.accelerate(torque_nm - model.friction_nm(w, 0.0), axis);
    }

    /// Returns the response of each state over a servo period, as columns; a state that the drive
    /// does not have is zero.
    fn columns(&self) -> [[f64; STATES]; STATES] {
        let is_integral = self.parameters.speed_integral_s > 0.0;
        let is_filter = self.parameters.torque_filter_hz > 0.0;
        let is_there = [true, true, is_integral, is_filter];
        std::array::from_fn(|j| {
            if !is_there[j] {
                return [0.0; STATES];
            }
            let unit: [f64; STATES] = std::array::from_fn(|i| if i == j { 1.0 } else { 0.0 });
            let mut axis = AxisState {
                angle_rad: unit[0],
                speed_rad_s: unit[1],
                ..AxisState::default()
            };
            let mut drive = DriveState::AT_REST;
            drive.correct(unit[2], unit[3]);
            for _ in 0..self.axis_model.periods.mechanics_per_servo {
                self.substep(DriveReference::default(), &mut axis, &mut drive);
            }
            let [integral_nm, filtered_nm] = [drive.integral_nm(), drive.filtered_nm()];
            [axis.angle_rad, axis.speed_rad_s, integral_nm, filtered_nm]
        })
    }

    /// N of a reference that lasts a servo period, with positions that are `ago` mechanics periods
    /// old.
    fn numerator(&self, reference: DriveReference, characteristic: &[f64], ago: u32) -> Vec<f64> {
        let per_servo = self.axis_model.periods.mechanics_per_servo;
        let [drive_late, _] = self.late;
        let (mut axis, mut drive) = (AxisState::default(), DriveState::AT_REST);
        let periods = STATES as u32 + (drive_late + per_servo + ago).div_ceil(per_servo);
        let mut positions_rad = vec![0.0; ago.div_ceil(per_servo) as usize];
        for n in 0..periods * per_servo {
            if (n + ago).is_multiple_of(per_servo) {
                positions_rad.push(axis.angle_rad);
            }
            let acting = match (drive_late..drive_late + per_servo).contains(&n) {
                true => reference,
                false => DriveReference::default(),
            };
            self.substep(acting, &mut axis, &mut drive);
        }
        // The rest of the product is zero: D ends the response of the states.
        let mut product = times(characteristic, &positions_rad);
        product.truncate(periods as usize);
        product
    }

    /// Numerator and denominator from command to position.
    fn transfer(&self, nominal: &Parameters) -> (Vec<f64>, Vec<f64>) {
        let servo_s = self.axis_model.periods.servo_s;
        let characteristic = characteristic(&self.columns());
        let of = |speed_rad_s, torque_nm, ago: u32| {
            let reference = DriveReference {
                speed_rad_s,
                torque_nm,
            };
            self.numerator(reference, &characteristic, ago)
        };
        let [_, measured_late] = self.late;
        let loop_gain = [nominal.kp_1_s + nominal.kd / servo_s, -nominal.kd / servo_s];
        let fed_1_s = self.parameters.velocity_feedforward / servo_s;
        let asked = [loop_gain[0] + fed_1_s, loop_gain[1] - fed_1_s];
        let of_speed = times(&of(1.0, 0.0, 0), &asked);
        let of_torque = times(
            &of(0.0, self.torque_for_change / servo_s, 0),
            &[1.0, -2.0, 1.0],
        );
        let fed_back = times(&of(1.0, 0.0, measured_late), &loop_gain);
        (sum(&of_speed, &of_torque), sum(&characteristic, &fed_back))
    }
}

/// Characteristic polynomial of a matrix, by columns or by rows.
fn characteristic(columns: &[[f64; STATES]; STATES]) -> Vec<f64> {
    let matrix = SMatrix::<f64, STATES, STATES>::from(*columns);
    let mut polynomial = vec![1.0];
    let mut power = SMatrix::<f64, STATES, STATES>::zeros();
    for k in 1..=STATES {
        power = matrix * (power + SMatrix::identity() * polynomial[k - 1]);
        polynomial.push(-power.trace() / k as f64);
    }
    polynomial
}

fn times(a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut product = vec![0.0; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        let each = b.iter().zip(&mut product[i..]);
        each.for_each(|(y, to)| *to += x * y);
    }
    product
}

fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    let at = |values: &[f64], i: usize| values.get(i).copied().unwrap_or(0.0);
    (0..a.len().max(b.len()))
        .map(|i| at(a, i) + at(b, i))
        .collect()
}

/// The polynomial that begins with 1 and has these zeros in z, which come in conjugate pairs.
fn with_zeros(zeros: &[Complex]) -> Vec<f64> {
    let mut polynomial = vec![Complex::from(1.0)];
    for zero in zeros {
        polynomial.push(Complex::from(0.0));
        for i in (1..polynomial.len()).rev() {
            let before = polynomial[i - 1];
            polynomial[i] -= zero * before;
        }
    }
    polynomial
        .into_iter()
        .map(|coefficient| coefficient.re)
        .collect()
}

/// The zeros in z of a polynomial in z^-1 whose first and last coefficients are not zero: the
/// eigenvalues of its companion matrix.
fn zeros(polynomial: &[f64]) -> Option<Vec<Complex>> {
    let (first, order) = (polynomial[0], polynomial.len() - 1);
    if order == 0 {
        return Some(Vec::new());
    }
    let companion = DMatrix::from_fn(order, order, |i, j| match i {
        0 => -polynomial[j + 1] / first,
        _ => f64::from(u8::from(i == j + 1)),
    });
    let schur = Schur::try_new(companion, f64::EPSILON, ROUNDS)?;
    Some(schur.complex_eigenvalues().iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use feedwright_sim::{Axis, Known, Machine};

    /// Rounding of a few hundred products of positions of about 1 rad, and zeros of a polynomial
    /// that has two near 0.9.
    const TOLERANCE: f64 = 1e-9;
    /// Tolerance with acceleration feedforward, a speed-loop integral and a measurement delay. Only
    /// then the transfer function is approximate: see the departures.
    const SEEN_LATE: f64 = 1e-4;

    fn known(change: impl Fn(Axis) -> Axis) -> Known {
        let mut machine = Machine::load("tnv40".as_ref()).unwrap();
        machine
            .axes
            .iter_mut()
            .for_each(|axis| *axis = change(*axis));
        machine.known()
    }

    /// Returns the positions, rad, after commands of the linear model itself, stepped as the plant
    /// does.
    fn stepped_rad(known: &Known, commands_rad: &[f64]) -> Vec<f64> {
        let axis = known.axis(0);
        let linear = ClosedAxis::new(axis, &axis.nominal, &known.period);
        let (mut motor, mut drive) = (AxisState::default(), DriveState::AT_REST);
        let per_servo = known.period.mechanics_per_servo as usize;
        let [drive_late, measured_late] = linear.late.map(|late| late as usize);
        let (mut course_rad, mut sent, mut positions_rad) = (Vec::new(), Vec::new(), Vec::new());
        for command_rad in commands_rad {
            positions_rad.push(motor.angle_rad);
            course_rad.push(motor.angle_rad);
            let before = course_rad.len() - 1;
            let measured = before.checked_sub(measured_late);
            let measured_rad = measured.map_or(0.0, |at| course_rad[at]);
            course_rad.pop();
            sent.push(linear.drive.position_loop(
                &linear.axis_model,
                *command_rad,
                measured_rad,
                &mut motor,
                &mut drive,
            ));
            for _ in 0..per_servo {
                let acting = course_rad.len().checked_sub(drive_late);
                let acts = acting.map(|at| sent[at / per_servo]);
                course_rad.push(motor.angle_rad);
                linear.substep(acts.unwrap_or_default(), &mut motor, &mut drive);
            }
        }
        positions_rad
    }

    #[test]
    fn the_transfer_is_what_the_model_does() {
        let full = |axis: Axis| Axis {
            speed_integral_s: 0.02,
            velocity_feedforward: 0.95,
            torque_filter_hz: 300.0,
            drive_delay_s: 0.0013,
            ..axis
        };
        let machines = [
            known(|axis| axis),
            known(full),
            known(|axis| Axis {
                measurement_delay_s: 0.0006,
                acceleration_feedforward: 0.7,
                kd: 0.02,
                ..full(axis)
            }),
            known(|axis| Axis {
                acceleration_feedforward: 0.7,
                kd: 0.02,
                ..full(axis)
            }),
            known(|axis| Axis {
                measurement_delay_s: 0.0006,
                ..full(axis)
            }),
            known(|axis| Axis {
                measurement_delay_s: 0.0006,
                acceleration_feedforward: 0.7,
                speed_integral_s: 0.0,
                ..full(axis)
            }),
            known(|axis| Axis {
                speed_integral_s: 0.0,
                torque_filter_hz: 0.0,
                ..full(axis)
            }),
        ];
        for known in machines {
            let axis = known.axis(0);
            let (numerator, denominator) =
                ClosedAxis::new(axis, &axis.nominal, &known.period).transfer(&axis.nominal);
            // The first command is where the axis rests: before it nothing was commanded.
            let commands_rad: Vec<f64> = (0..200)
                .map(|n| {
                    if n == 0 {
                        0.0
                    } else {
                        libm::sin(0.37 * f64::from(n * n))
                    }
                })
                .collect();
            let positions_rad = stepped_rad(&known, &commands_rad);
            let back =
                |values: &[f64], k: usize, j: usize| k.checked_sub(j).map_or(0.0, |at| values[at]);
            for k in 0..commands_rad.len() {
                let left: f64 = denominator
                    .iter()
                    .enumerate()
                    .map(|(j, a)| a * back(&positions_rad, k, j))
                    .sum();
                let right: f64 = numerator
                    .iter()
                    .enumerate()
                    .map(|(j, b)| b * back(&commands_rad, k, j))
                    .sum();
                let Parameters {
                    acceleration_feedforward: fed,
                    speed_integral_s: integral_s,
                    measurement_delay_s,
                    ..
                } = axis.nominal;
                let is_exact = fed * integral_s * measurement_delay_s == 0.0;
                let tolerance = if is_exact { TOLERANCE } else { SEEN_LATE };
                assert!(
                    (left - right).abs() < tolerance,
                    "{:?}, {k}: {left} {right}",
                    axis.nominal
                );
            }
            assert!(
                positions_rad
                    .iter()
                    .any(|position_rad| position_rad.abs() > 0.01)
            );
        }
    }

    #[test]
    fn zeros_are_found_again() {
        let wanted = [
            [0.95, 0.0],
            [0.9, 0.1],
            [0.9, -0.1],
            [-0.97, 0.0],
            [-7.0, 0.0],
            [0.002, 0.0],
        ];
        let wanted = wanted.map(|[re, im]| Complex::new(re, im));
        let found = zeros(&with_zeros(&wanted)).unwrap();
        for zero in wanted {
            let nearest = found
                .iter()
                .map(|other| (zero - other).modulus())
                .fold(f64::MAX, f64::min);
            assert!(nearest < TOLERANCE, "{zero:?}: {found:?}");
        }
    }
}
