//! The machine that a machine file most probably describes, and other machines that it may describe
//! as well.
//!
//! Values of a machine file are typed in or estimated. Their error `s` counts as normal, in natural
//! logarithms, each value of each axis by itself. Builders match the axes that interpolate: the
//! same following error at the same speed, thus the same position gain and the same feedforward.
//! Manuals of controls ask for it (Heidenhain, TNC 430 Technical Manual, 2001, "The Control Loop":
//! kv factors must be equal; Siemens, SINUMERIK 840Di sl Manual, 2007, section 11.5.4: the same
//! following error). So the ratio between two axes is known far better than each value.
//!
//! For a matched value, let the file have `v_i` for axis `i` of `n`. The most probable machine has
//!
//! ```text
//! ln v = mean(ln v_i)    where    max(ln v_i) - min(ln v_i) < z s sqrt(2),    with    sd(ln v) = s / sqrt(n).
//! ```
//!
//! Beyond `z` = [`BY_CHANCE`] the axes count as different and keep their values. A mistake in the
//! file is possible as well, so the [plausible machines](FileModel::plausible) then include one
//! whose axes are matched. Velocity feedforward above 1 makes an axis run ahead of its command, and
//! below 1 it leaves the axis behind. Where it is used, it lies between 0.9 and 1 (Heidenhain,
//! MANUALplus 620 Technical Manual, 2012, section 6.16: 1 by default, and equal in axes that
//! interpolate). A mean outside of that by no more than `z s / sqrt(n)` counts as the nearer end.
//!
//! Plausible machines are one standard deviation off in each uncertain value, with the signs of an
//! orthogonal array of 8 runs. Then the mean square over the machines is the variance of every
//! quantity that is linear in the values (Plackett and Burman 1946).

use feedwright_sim::{AXIS_NAMES, Axis, Machine};
use serde::Serialize;

/// Standard deviation of a value of a machine file, as a fraction of it, where the user states
/// none.
pub(crate) const FILE_ERROR: f64 = 0.1;
/// Two axes whose values differ by more standard deviations are different: 1 of 1000 pairs that
/// are equal differ by as much.
const BY_CHANCE: f64 = 3.29;
/// Plausible machines.
const RUNS: usize = 8;
/// Column of the orthogonal array for friction, and for the speed loop of each axis; the first
/// three are for [`MATCHED`].
const FRICTION_COLUMN: usize = 4;
const SPEED_LOOP_COLUMNS: [usize; 3] = [5, 6, 7];

/// A value that counts as equal in all axes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct AssumedValue {
    /// Name of the value.
    pub(crate) value: &'static str,
    /// Values in the machine file, axis by axis.
    pub(crate) file: Vec<f64>,
    /// Assumed values, axis by axis.
    pub(crate) assumed: Vec<f64>,
}

/// Assumptions of a correction about the machine, beside its file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FileAssumption {
    /// Standard deviation of each value of the machine file, as a fraction of it.
    pub(crate) file_error: f64,
    /// Values that are not the values of the file.
    pub(crate) values: Vec<AssumedValue>,
    /// Values in which the axes differ by more than chance.
    pub(crate) different: Vec<&'static str>,
}

/// A machine file with what is uncertain in it.
pub(super) struct FileModel {
    /// The most probable machine.
    pub(super) machine: Machine,
    /// Machines one standard deviation off.
    pub(super) plausible: Vec<Machine>,
    /// The machine with matched axes, where the file has axes that differ.
    pub(super) mistaken: Option<Machine>,
    pub(super) assumption: FileAssumption,
}

/// A value that builders match.
struct MatchedValue {
    name: &'static str,
    of: fn(&mut Axis) -> &mut f64,
    /// Usual range of the value.
    usual: [f64; 2],
    column: usize,
}

/// Every value is usual.
const ANY: [f64; 2] = [0.0, f64::INFINITY];

/// Values that builders match.
const MATCHED: [MatchedValue; 3] = [
    MatchedValue {
        name: "kp_1_s",
        of: |axis| &mut axis.kp_1_s,
        usual: ANY,
        column: 1,
    },
    MatchedValue {
        name: "velocity_feedforward",
        of: |axis| &mut axis.velocity_feedforward,
        usual: [0.9, 1.0],
        column: 2,
    },
    MatchedValue {
        name: "acceleration_feedforward",
        of: |axis| &mut axis.acceleration_feedforward,
        usual: ANY,
        column: 3,
    },
];

/// Sign of a column of the orthogonal array in a run.
const fn sign(run: usize, column: usize) -> f64 {
    if (run & column).count_ones().is_multiple_of(2) {
        1.0
    } else {
        -1.0
    }
}

impl MatchedValue {
    /// Gives all axes the most probable value: the geometric mean of their values, or the nearer
    /// end of the usual range.
    fn match_axes(&self, axes: &mut [Axis], file_error: f64) {
        let logs: f64 = axes
            .iter_mut()
            .map(|axis| libm::log(*(self.of)(axis)))
            .sum();
        let mean = libm::exp(logs / axes.len() as f64);
        let usual = mean.clamp(self.usual[0], self.usual[1]);
        let by_chance = BY_CHANCE * file_error / (axes.len() as f64).sqrt();
        let value = if libm::log(usual / mean).abs() < by_chance {
            usual
        } else {
            mean
        };
        axes.iter_mut().for_each(|axis| *(self.of)(axis) = value);
    }

    /// Returns the value moved by one standard deviation, up or down. `sd` is the standard
    /// deviation of the file, as a fraction.
    fn moved(&self, value: f64, sd: f64, sign: f64) -> f64 {
        let [least, most] = self.usual;
        if most.is_finite() && (least..=most).contains(&value) {
            // A uniform distribution has a standard deviation of its width over the square root
            // of 12.
            let sd = (sd * value).min((most - least) / 12.0_f64.sqrt());
            return (value + sign * sd).clamp(least, most);
        }
        value * libm::exp(sign * sd)
    }
}

impl FileModel {
    /// The machine of a file that has an error; none of an exact one.
    pub(super) fn uncertain(file: &Machine, axes: usize, file_error: f64) -> Option<Self> {
        (file_error > 0.0).then(|| Self::new(file, axes, file_error))
    }

    /// The machine of a file whose values have this standard deviation, as a fraction; `axes` of
    /// them move.
    pub(super) fn new(file: &Machine, axes: usize, file_error: f64) -> Self {
        let mut machine = file.clone();
        let mut mistaken = file.clone();
        let mut assumption = FileAssumption {
            file_error,
            values: Vec::new(),
            different: Vec::new(),
        };
        let axes = axes.min(machine.axes.len());
        for value in &MATCHED {
            let typed: Vec<f64> = machine.axes[..axes]
                .iter_mut()
                .map(|axis| *(value.of)(axis))
                .collect();
            let (least, most) = typed
                .iter()
                .fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(*v), b.max(*v)));
            if most == 0.0 {
                continue;
            }
            let differ = least <= 0.0
                || libm::log(most / least) > BY_CHANCE * file_error * std::f64::consts::SQRT_2;
            if differ {
                assumption.different.push(value.name);
                if least > 0.0 {
                    value.match_axes(&mut mistaken.axes[..axes], file_error);
                }
                continue;
            }
            if most > least || !(value.usual[0]..=value.usual[1]).contains(&most) {
                for machine in [&mut machine, &mut mistaken] {
                    value.match_axes(&mut machine.axes[..axes], file_error);
                }
                let assumed = machine.axes[..axes]
                    .iter_mut()
                    .map(|axis| *(value.of)(axis))
                    .collect();
                assumption.values.push(AssumedValue {
                    value: value.name,
                    file: typed,
                    assumed,
                });
            }
        }
        let plausible = (0..RUNS)
            .map(|run| plausible(&machine, axes, file_error, run))
            .collect();
        let mistaken = (!assumption.different.is_empty()).then_some(mistaken);
        Self {
            machine,
            plausible,
            mistaken,
            assumption,
        }
    }
}

/// The machine of a run of the orthogonal array.
fn plausible(machine: &Machine, axes: usize, file_error: f64, run: usize) -> Machine {
    let mut machine = machine.clone();
    let common = file_error / (axes as f64).sqrt();
    let times = |sd: f64, column: usize| libm::exp(sd * sign(run, column));
    for (i, axis) in machine.axes.iter_mut().enumerate() {
        for value in &MATCHED {
            let now = (value.of)(axis);
            *now = value.moved(*now, common, sign(run, value.column));
        }
        // Only the ratio of inertia to speed loop gain counts.
        axis.inertia_kg_m2 *= times(
            std::f64::consts::SQRT_2 * file_error,
            SPEED_LOOP_COLUMNS[i % 3],
        );
        let friction = times(file_error, FRICTION_COLUMN);
        axis.coulomb_friction_nm *= friction;
        axis.viscous_friction_nm_s *= friction;
        axis.stribeck_nm *= friction;
        axis.coulomb_asymmetry_nm *= friction;
    }
    machine
}

impl FileAssumption {
    /// Describes the assumptions in one sentence.
    pub(crate) fn sentence(&self) -> String {
        let list = |value: &AssumedValue| {
            let typed: Vec<String> = AXIS_NAMES
                .iter()
                .zip(&value.file)
                .map(|(axis, file)| format!("{axis} {file:.4}"))
                .collect();
            format!(
                "{} is taken as {:.4} ({} in the file)",
                value.value,
                value.assumed[0],
                typed.join(", ")
            )
        };
        let mut parts = vec![format!(
            "assumed: values of the machine file have a standard deviation of {:.0} % (--file-error), and the loops of its axes are matched",
            100.0 * self.file_error
        )];
        parts.extend(self.values.iter().map(list));
        parts.extend(
            self.different
                .iter()
                .map(|value| format!("{value} differs between the axes by more than chance")),
        );
        parts.join("; ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use feedwright_control::Part;

    fn file(change: impl Fn(&mut Machine)) -> FileModel {
        let mut machine = Machine::load("workshop".as_ref()).expect("built in");
        change(&mut machine);
        FileModel::new(&machine, 2, 0.1)
    }

    #[test]
    fn a_file_with_matched_axes_is_taken_as_it_is() {
        let built_in = Machine::load("workshop".as_ref()).expect("built in");
        let file = file(|_| {});
        for (was, is) in built_in.axes.iter().zip(&file.machine.axes) {
            assert_eq!(
                was.parameters().without(&[Part::Noise]),
                is.parameters().without(&[Part::Noise])
            );
        }
        assert!(
            file.assumption.values.is_empty() && file.mistaken.is_none(),
            "{:?}",
            file.assumption
        );
    }

    #[test]
    fn gains_that_differ_by_chance_are_matched_and_others_are_not() {
        let near = file(|machine| machine.axes[0].kp_1_s = 72.0);
        assert_eq!(near.assumption.values[0].file, [72.0, 50.0]);
        for axis in &near.machine.axes[..2] {
            assert!((axis.kp_1_s - 60.0).abs() < 1e-9, "{}", axis.kp_1_s);
        }
        let far = file(|machine| machine.axes[0].kp_1_s = 100.0);
        assert_eq!(far.assumption.different, ["kp_1_s"]);
        assert_eq!(
            [far.machine.axes[0].kp_1_s, far.machine.axes[1].kp_1_s],
            [100.0, 50.0]
        );
        let mistaken = far.mistaken.expect("another machine");
        assert!((mistaken.axes[0].kp_1_s - mistaken.axes[1].kp_1_s).abs() < 1e-9);
    }

    #[test]
    fn feedforward_that_is_unusual_by_chance_counts_as_usual() {
        for (typed, assumed) in [(1.1, 1.0), (0.8, 0.9), (0.95, 0.95), (0.5, 0.5)] {
            let file = file(|machine| {
                machine
                    .axes
                    .iter_mut()
                    .for_each(|axis| axis.velocity_feedforward = typed);
            });
            let is = [0, 1].map(|i| file.machine.axes[i].velocity_feedforward);
            assert!(
                is.iter().all(|is| (is - assumed).abs() < 1e-12),
                "{typed}: {is:?}"
            );
        }
    }

    #[test]
    fn plausible_machines_are_one_standard_deviation_off_in_every_direction_by_itself() {
        let file = file(|_| {});
        let logs = |of: fn(&Axis) -> f64, i: usize| -> Vec<f64> {
            file.plausible
                .iter()
                .map(|machine| libm::log(of(&machine.axes[i]) / of(&file.machine.axes[i])))
                .collect()
        };
        let gains = logs(|axis| axis.kp_1_s, 0);
        let loops = [0, 1].map(|i| logs(|axis| axis.inertia_kg_m2, i));
        let product = |a: &[f64], b: &[f64]| {
            a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / a.len() as f64
        };
        assert!((product(&gains, &gains) - 0.005).abs() < 1e-12, "{gains:?}");
        assert!(
            (product(&loops[0], &loops[0]) - 0.02).abs() < 1e-12,
            "{loops:?}"
        );
        for (a, b) in [
            (&gains, &loops[0]),
            (&gains, &loops[1]),
            (&loops[0], &loops[1]),
        ] {
            assert!(product(a, b).abs() < 1e-12);
        }
    }
}
