//! Values of the model that a log shows to be wrong.
//!
//! With the command `c` of the log, the model's position `m(c, p)` at the values `p`, and the
//! recorded position `a`, the values are
//!
//! ```text
//! min over q, d:  sum_k |a(k) - m(c, p exp(q))(k ts + d)|^2 / (S^2 L)  +  sum q^2 / Q^2  +  sum d^2 / D^2
//! ```
//!
//! by Gauss and Newton. `S` is the RMS of the remainder of an axis, `L` the samples of a time
//! constant of the loop, within which errors of a model are not independent. `Q` = 0.2 is the error
//! of a machine file; values that the log does not show stay as they are. `d` is the time between
//! the samples of the log and the samples of the model. The curvature at the minimum gives the
//! standard deviations.
//!
//! Source: iterative learning with basis functions (van de Wijdeven and Bosgra 2010), which carries
//! the learned values over to another command. The functions are the changes of the simulated
//! position with each value.

use feedwright_plan::vector::{Vector, add_scaled, distance, sub};
use feedwright_sim::{AXIS_NAMES, Axis, Cancelled, Machine, Plant, Watch};
use serde::Serialize;

use super::error::LearnError;
use super::part_record::PartRecord;
use crate::correct::nominal::deterministic;

/// Standard deviation of a value of a machine file, natural logarithm.
const FILE_SD: f64 = 0.2;
/// Standard deviation of the time between the samples of log and model, s: recorders take positions
/// at either end of a period, and controls delay commands by some periods.
const LATE_SD_S: f64 = 0.005;
/// Range of a value relative to the file. A value outside of it belongs to another machine.
const BOUNDS: [f64; 2] = [0.6, 1.667];
/// Largest number of steps of Gauss and Newton, the change for the numerical derivatives, and the
/// length of a step that counts as small, natural logarithms.
const STEPS: u32 = 8;
const DIFFERENCE: f64 = 0.01;
const SMALL: f64 = 1e-3;
/// Longest step of a value, natural logarithm.
const LONGEST: f64 = 0.4;
/// Halvings of a step that does not lower the cost.
const HALVINGS: u32 = 4;
/// Least RMS of the remainder, mm: a model is no better than the digits of a log.
const LEAST_MM: f64 = 2e-5;
/// Longest part of a log that the fit uses, s.
const MOST_S: f64 = 120.0;
/// The machine moves already if the tool is further from the command than this in the first sample,
/// mm.
const RESTS_MM: f64 = 0.01;
/// Time constants of the position loop after which a model no longer depends on its start.
const FORGETS: f64 = 6.0;

/// A value of an axis that may be wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum ModelValue {
    /// Gain of the position loop.
    PositionGain,
    /// Gain of the speed loop.
    SpeedGain,
    /// Inertia.
    Inertia,
    /// All friction.
    Friction,
    /// Integral time of the speed loop.
    IntegralTime,
    /// Velocity feedforward.
    VelocityFeedforward,
    /// Acceleration feedforward.
    AccelerationFeedforward,
}

/// All values.
const VALUES: [ModelValue; 7] = [
    ModelValue::PositionGain,
    ModelValue::SpeedGain,
    ModelValue::Inertia,
    ModelValue::Friction,
    ModelValue::IntegralTime,
    ModelValue::VelocityFeedforward,
    ModelValue::AccelerationFeedforward,
];

impl ModelValue {
    /// Name of the value for messages.
    pub(crate) const fn words(self) -> &'static str {
        match self {
            Self::PositionGain => "position gain",
            Self::SpeedGain => "speed-loop gain",
            Self::Inertia => "inertia",
            Self::Friction => "friction",
            Self::IntegralTime => "integral time",
            Self::VelocityFeedforward => "velocity feedforward",
            Self::AccelerationFeedforward => "acceleration feedforward",
        }
    }

    /// Multiplies the value. Returns true if the value is not zero on the axis.
    fn scale(self, axis: &mut Axis, factor: f64) -> bool {
        let scaled = |values: &mut [&mut f64]| {
            values.iter_mut().for_each(|value| **value *= factor);
            values.iter().any(|value| **value != 0.0)
        };
        match self {
            Self::PositionGain => scaled(&mut [&mut axis.kp_1_s]),
            Self::SpeedGain => scaled(&mut [&mut axis.kv_nm_s_per_rad]),
            Self::Inertia => scaled(&mut [&mut axis.inertia_kg_m2]),
            Self::Friction => scaled(&mut [
                &mut axis.coulomb_friction_nm,
                &mut axis.viscous_friction_nm_s,
                &mut axis.stribeck_nm,
                &mut axis.coulomb_asymmetry_nm,
            ]),
            Self::IntegralTime => scaled(&mut [&mut axis.speed_integral_s]),
            Self::VelocityFeedforward => scaled(&mut [&mut axis.velocity_feedforward]),
            Self::AccelerationFeedforward => scaled(&mut [&mut axis.acceleration_feedforward]),
        }
    }
}

/// A value as the logs show it.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct LearnedValue {
    /// The axis.
    pub(crate) axis: &'static str,
    /// Name of the value.
    pub(crate) value: ModelValue,
    /// Factor on the value of the machine file.
    pub(crate) factor: f64,
    /// Standard deviation of the factor, as a fraction of it.
    pub(crate) standard_deviation: f64,
}

/// Model with the values that the logs show.
pub(super) struct ModelFit {
    /// Machine of the file with these values.
    pub(super) machine: Machine,
    pub(super) values: Vec<LearnedValue>,
    /// Time by which the samples of each log are later than the samples of the model, s.
    pub(super) late_s: Vec<f64>,
    /// Error of each log that the model does not explain, sample by sample, mm.
    pub(super) left_mm: Vec<Vec<Vector>>,
    /// Machines with values that are as likely, in pairs around the best.
    pub(super) likely: Vec<Machine>,
}

/// Interpolates between samples by the cubic through four of them; holds the ends.
pub(super) fn at(series: &[Vector], index: f64) -> Vector {
    let last = series.len() - 1;
    let index = index.clamp(0.0, last as f64);
    let n = (index as usize).min(last.saturating_sub(1));
    let t = index - n as f64;
    let [a, b, c, d] =
        [n.saturating_sub(1), n, (n + 1).min(last), (n + 2).min(last)].map(|k| series[k]);
    std::array::from_fn(|i| {
        let (first, second) = (0.5 * (c[i] - a[i]), 0.5 * (d[i] - b[i]));
        let rise = c[i] - b[i];
        b[i] + t
            * (first + t * (3.0 * rise - 2.0 * first - second + t * (first + second - 2.0 * rise)))
    })
}

/// Simulates a model that follows the command of a record. Returns its positions at the starts of
/// its servo periods, mm.
pub(super) fn followed(
    machine: &Machine,
    record: &PartRecord,
    samples: usize,
    seed: Option<u64>,
) -> Vec<Vector> {
    let (servo_s, sample_s) = (machine.period.servo_s, record.cut.sample_s);
    let ratio = servo_s / sample_s;
    let is_same = (ratio - 1.0).abs() < 1e-3;
    let command = &record.cut.command_mm[..samples];
    let periods = if is_same {
        samples
    } else {
        (samples as f64 / ratio).ceil() as usize
    };
    let start_mm = record.cut.actual_mm[0];
    let mut plant = Plant::<3>::with_seed(machine, start_mm, seed.unwrap_or(0));
    let mut positions = vec![start_mm];
    positions.extend((0..periods).map(|n| {
        let command_mm = if is_same {
            command[n]
        } else {
            at(command, n as f64 * ratio)
        };
        let measurement = plant.step(command_mm);
        if seed.is_some() {
            measurement.measured_mm
        } else {
            measurement.joint_mm
        }
    }));
    positions
}

/// A matrix, row by row.
type RowMatrix = Vec<Vec<f64>>;

/// State of the search for values.
struct ValueSearch<'a> {
    base: &'a Machine,
    records: &'a [PartRecord],
    axes: usize,
    values: Vec<ModelValue>,
    watch: &'a dyn Watch,
}

/// Point of the search: the model there, and the remainders.
struct SearchPoint {
    /// Logarithms of the factors, axis by axis, and times, in samples.
    at: Vec<f64>,
    followed_mm: Vec<Vec<Vector>>,
    left_mm: Vec<Vec<Vector>>,
}

impl ValueSearch<'_> {
    /// Returns the number of samples of a record that the fit uses.
    fn samples(&self, record: &PartRecord) -> usize {
        let most = (MOST_S / record.cut.sample_s) as usize;
        record.cut.command_mm.len().min(record.cut.first + most)
    }

    /// Returns the first sample that the model can predict.
    fn begin(&self, record: &PartRecord) -> usize {
        let rests = distance(record.cut.command_mm[0], record.cut.actual_mm[0]) < RESTS_MM;
        if rests {
            1
        } else {
            (FORGETS / self.base.slowest_kp_1_s() / record.cut.sample_s) as usize
        }
    }

    fn machine(&self, at: &[f64]) -> Machine {
        let mut machine = self.base.clone();
        for (i, axis) in machine.axes.iter_mut().enumerate().take(self.axes) {
            for (j, value) in self.values.iter().enumerate() {
                value.scale(axis, libm::exp(at[i * self.values.len() + j]));
            }
        }
        machine
    }

    /// Computes the difference between a record and the model, sample by sample, mm.
    fn left(&self, record: &PartRecord, followed_mm: &[Vector], late: f64) -> Vec<Vector> {
        let ratio = record.cut.sample_s / self.base.period.servo_s;
        let model = |k: usize| at(followed_mm, (k as f64 + late) * ratio);
        record
            .cut
            .actual_mm
            .iter()
            .enumerate()
            .map(|(k, actual_mm)| sub(*actual_mm, model(k)))
            .collect()
    }

    fn follow(&self, at: &[f64]) -> Result<Vec<Vec<Vector>>, Cancelled> {
        self.watch.check()?;
        let machine = deterministic(&self.machine(at));
        Ok(self
            .records
            .iter()
            .map(|record| followed(&machine, record, self.samples(record), None))
            .collect())
    }

    fn point(&self, at: Vec<f64>) -> Result<SearchPoint, Cancelled> {
        let followed_mm = self.follow(&at)?;
        let late = &at[self.axes * self.values.len()..];
        let left_mm = self.records.iter().zip(&followed_mm).zip(late);
        let left_mm = left_mm
            .map(|((record, followed_mm), late)| self.left(record, followed_mm, *late))
            .collect();
        Ok(SearchPoint {
            at,
            followed_mm,
            left_mm,
        })
    }

    /// Computes the mean square of the remainder of each axis, mm2.
    fn spread_mm2(&self, point: &SearchPoint) -> Vector {
        let (mut sum, mut count) = ([0.0; 3], 0.0);
        for (record, left_mm) in self.records.iter().zip(&point.left_mm) {
            for left_mm in &left_mm[self.begin(record)..self.samples(record)] {
                (0..3).for_each(|i| sum[i] += left_mm[i] * left_mm[i]);
                count += 1.0;
            }
        }
        sum.map(|sum| (sum / f64::max(count, 1.0)).max(LEAST_MM * LEAST_MM))
    }

    /// Computes the weight of a squared error of a record, by axis, 1/mm2.
    fn weights(&self, record: &PartRecord, spread_mm2: Vector) -> Vector {
        let alike = (1.0 / self.base.slowest_kp_1_s() / record.cut.sample_s).max(1.0);
        spread_mm2.map(|spread| 1.0 / (spread * alike))
    }

    fn prior(&self, k: usize) -> f64 {
        let record = k.checked_sub(self.axes * self.values.len());
        let sd = record.map_or(FILE_SD, |record| {
            LATE_SD_S / self.records[record].cut.sample_s
        });
        1.0 / (sd * sd)
    }

    fn cost(&self, point: &SearchPoint, spread_mm2: Vector) -> f64 {
        let mut cost: f64 = point
            .at
            .iter()
            .enumerate()
            .map(|(k, q)| self.prior(k) * q * q)
            .sum();
        for (record, left_mm) in self.records.iter().zip(&point.left_mm) {
            let weights = self.weights(record, spread_mm2);
            for left_mm in &left_mm[self.begin(record)..self.samples(record)] {
                cost += (0..self.axes)
                    .map(|i| weights[i] * left_mm[i] * left_mm[i])
                    .sum::<f64>();
            }
        }
        cost
    }

    /// Computes curvature and slope of the cost at a point.
    fn normal(
        &self,
        point: &SearchPoint,
        spread_mm2: Vector,
    ) -> Result<(RowMatrix, Vec<f64>), Cancelled> {
        let (size, own) = (point.at.len(), self.values.len());
        let mut curvature = vec![vec![0.0; size]; size];
        let mut slope: Vec<f64> = point
            .at
            .iter()
            .enumerate()
            .map(|(k, q)| -self.prior(k) * q)
            .collect();
        (0..size).for_each(|k| curvature[k][k] = self.prior(k));
        let changed = |j: usize| {
            let mut at = point.at.clone();
            (0..self.axes).for_each(|i| at[i * own + j] += DIFFERENCE);
            self.follow(&at)
        };
        let changed = (0..own).map(changed).collect::<Result<Vec<_>, _>>()?;
        for (n, record) in self.records.iter().enumerate() {
            let (weights, late) = (self.weights(record, spread_mm2), self.axes * own + n);
            let ratio = record.cut.sample_s / self.base.period.servo_s;
            for k in self.begin(record)..self.samples(record) {
                let index = (k as f64 + point.at[late]) * ratio;
                let here = at(&point.followed_mm[n], index);
                let speed = sub(
                    at(&point.followed_mm[n], index + 0.5),
                    at(&point.followed_mm[n], index - 0.5),
                );
                let changes: Vec<Vector> = changed
                    .iter()
                    .map(|all| sub(at(&all[n], index), here))
                    .collect();
                for i in 0..self.axes {
                    let place = |j: usize| if j < own { i * own + j } else { late };
                    let derivative = |j: usize| {
                        if j < own {
                            changes[j][i] / DIFFERENCE
                        } else {
                            speed[i] * ratio
                        }
                    };
                    for j in 0..=own {
                        let weighted = weights[i] * derivative(j);
                        slope[place(j)] += weighted * point.left_mm[n][k][i];
                        (0..=own).for_each(|l| {
                            curvature[place(j)][place(l)] += weighted * derivative(l);
                        });
                    }
                }
            }
        }
        Ok((curvature, slope))
    }

    /// Returns the values at a point. `factor` is the triangular factor of the curvature there.
    fn learned(
        &self,
        point: &SearchPoint,
        factor: &[Vec<f64>],
    ) -> Result<Vec<LearnedValue>, LearnError> {
        let own = self.values.len();
        let value = |k: usize| {
            let (axis, value) = (AXIS_NAMES[k / own], self.values[k % own]);
            let times = libm::exp(point.at[k]);
            if !(BOUNDS[0]..=BOUNDS[1]).contains(&times) {
                return Err(LearnError::OtherMachine {
                    axis,
                    value: value.words(),
                    factor: times,
                    bounds: BOUNDS,
                });
            }
            let mut unit = vec![0.0; point.at.len()];
            unit[k] = 1.0;
            let standard_deviation = solved(factor, &unit)[k].sqrt();
            Ok(LearnedValue {
                axis,
                value,
                factor: times,
                standard_deviation,
            })
        };
        (0..self.axes * own).map(value).collect()
    }

    /// Takes a step to a point with a lower cost. Returns that point, the factor of the curvature
    /// before the step, and the length of the step; no point if no step lowers the cost.
    fn step(&self, from: &SearchPoint) -> Result<(Option<SearchPoint>, RowMatrix, f64), Cancelled> {
        let spread_mm2 = self.spread_mm2(from);
        let (curvature, slope) = self.normal(from, spread_mm2)?;
        let factor = factor_of(&curvature);
        let step = solved(&factor, &slope);
        let values = &step[..self.axes * self.values.len()];
        let longest = values
            .iter()
            .fold(0.0_f64, |most, step| most.max(step.abs()));
        // A time counts as found when it changes by less than a fiftieth of a sample.
        let way = step[values.len()..]
            .iter()
            .fold(longest, |most, step| most.max(SMALL / 0.02 * step.abs()));
        let mut part = (LONGEST / longest.max(1e-12)).min(1.0);
        let cost = self.cost(from, spread_mm2);
        for _ in 0..HALVINGS {
            let at = from
                .at
                .iter()
                .zip(&step)
                .map(|(at, step)| at + part * step)
                .collect();
            let point = self.point(at)?;
            if self.cost(&point, spread_mm2) < cost {
                return Ok((Some(point), factor, part * way));
            }
            part *= 0.5;
        }
        Ok((None, factor, 0.0))
    }
}

/// Lower triangle L of the positive definite matrix L L'.
fn factor_of(matrix: &[Vec<f64>]) -> RowMatrix {
    let mut lower = vec![vec![0.0; matrix.len()]; matrix.len()];
    for i in 0..matrix.len() {
        for j in 0..=i {
            let rest = matrix[i][j] - (0..j).map(|k| lower[i][k] * lower[j][k]).sum::<f64>();
            lower[i][j] = if i == j {
                rest.max(f64::MIN_POSITIVE).sqrt()
            } else {
                rest / lower[j][j]
            };
        }
    }
    lower
}

/// Solves L' x = right.
fn backward(lower: &[Vec<f64>], right: &[f64]) -> Vec<f64> {
    let mut x = right.to_vec();
    for i in (0..x.len()).rev() {
        x[i] = (x[i] - (i + 1..x.len()).map(|k| lower[k][i] * x[k]).sum::<f64>()) / lower[i][i];
    }
    x
}

/// Solves L L' x = right.
fn solved(lower: &[Vec<f64>], right: &[f64]) -> Vec<f64> {
    let mut x = right.to_vec();
    for i in 0..x.len() {
        x[i] = (x[i] - (0..i).map(|k| lower[i][k] * x[k]).sum::<f64>()) / lower[i][i];
    }
    backward(lower, &x)
}

/// Returns a point of the standard normal distribution: the signs of its components alternate with
/// the period `rhythm`.
fn alternating(size: usize, rhythm: usize) -> Vec<f64> {
    (0..size)
        .map(|k| {
            if (k / rhythm).is_multiple_of(2) {
                1.0
            } else {
                -1.0
            }
        })
        .collect()
}

/// Finds the values of a machine that its logs show.
///
/// # Errors
/// Values that belong to another machine, or a run that was cancelled.
pub(super) fn fit(
    base: &Machine,
    records: &[PartRecord],
    axes: usize,
    watch: &dyn Watch,
) -> Result<ModelFit, LearnError> {
    let has = |value: &ModelValue| {
        base.axes
            .iter()
            .take(axes)
            .any(|axis| value.scale(&mut axis.clone(), 1.0))
    };
    let search = ValueSearch {
        base,
        records,
        axes,
        values: VALUES.into_iter().filter(has).collect(),
        watch,
    };
    let own = search.values.len();
    let mut point = search.point(vec![0.0; axes * own + records.len()])?;
    let mut factor = Vec::new();
    for _ in 0..STEPS {
        let (next, there, way) = search.step(&point)?;
        factor = there;
        let Some(next) = next else { break };
        point = next;
        if way < SMALL {
            break;
        }
    }
    let values = search.learned(&point, &factor)?;
    let likely = [1, 2].into_iter().flat_map(|rhythm| {
        let away = backward(&factor, &alternating(point.at.len(), rhythm));
        [1.0, -1.0].map(|sign| {
            let at: Vec<f64> = point
                .at
                .iter()
                .zip(&away)
                .map(|(at, away)| at + sign * away)
                .collect();
            search.machine(&at)
        })
    });
    let likely = likely.collect();
    let late = &point.at[axes * own..];
    let whole = deterministic(&search.machine(&point.at));
    let left = |(record, late): (&PartRecord, &f64)| {
        search.left(
            record,
            &followed(&whole, record, record.cut.command_mm.len(), None),
            *late,
        )
    };
    Ok(ModelFit {
        values,
        late_s: records
            .iter()
            .zip(late)
            .map(|(record, late)| late * record.cut.sample_s)
            .collect(),
        left_mm: records.iter().zip(late).map(left).collect(),
        likely,
        machine: search.machine(&point.at),
    })
}

/// Computes the error that all noise of a machine adds to the positions of a record, mm: a sample
/// of the error that does not repeat.
pub(super) fn noise_of(machine: &Machine, record: &PartRecord, seed: u64) -> Vec<Vector> {
    let samples = record.cut.command_mm.len();
    let [noisy, quiet] = [
        followed(machine, record, samples, Some(seed)),
        followed(&deterministic(machine), record, samples, None),
    ];
    let ratio = record.cut.sample_s / machine.period.servo_s;
    (0..samples)
        .map(|k| {
            add_scaled(
                at(&noisy, k as f64 * ratio),
                -1.0,
                at(&quiet, k as f64 * ratio),
            )
        })
        .collect()
}
