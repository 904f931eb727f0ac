//! Machine files: describe the simulated or real machine in TOML; every value is checked.
//!
//! A machine is a file; `crates/sim/machines/tnv40.toml` explains every key beside its value.
//! [`Machine::load`] takes the name of a machine that is built in or the path of a file. A later
//! part of a machine (a compliant transmission, an encoder) is an optional table of the file: one
//! struct here, one `Option` field in [`Machine`] or [`Axis`], one table in [`keys`], one reader in
//! `layout`.

mod axis;
mod built_in;
mod data_sheet;
mod error;
pub mod keys;
mod layout;
mod plan_limits;

use std::ffi::OsStr;
use std::path::Path;
use std::sync::Arc;

use feedwright_control::{AxisModel, KnownGeometry, Periods};
use feedwright_gcode::input;
use feedwright_plan::{Durations, PlcEvent};
use serde::Serialize;

use crate::toml_file::key::write;
use crate::toml_file::{self, FileError, quoted, read_text};
pub use axis::{Axis, Transmission};
pub use built_in::{BUILT_IN_MACHINES, DEFAULT_MACHINE};
pub use data_sheet::{Known, KnownAxis};
use error::KIND;
pub use error::MachineError;

/// Names of the axes, in the order of every `[f64; 3]` of this library.
pub const AXIS_NAMES: [&str; 3] = ["x", "y", "z"];

/// A machine, every value checked.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Machine {
    /// Short name, as in tables and results.
    pub name: String,
    /// One line for people.
    pub description: String,
    /// Source of the values.
    pub source: String,
    /// Periods of the control and of its simulation.
    pub period: Period,
    /// Limits of speed, acceleration, jump and deviation.
    pub limits: Limits,
    /// PLC and spindle.
    pub plc: Durations,
    /// M-codes that the machine builder gave a meaning, such as a lamp.
    pub plc_events: Vec<PlcEvent>,
    /// Two or three axes: x, y and perhaps z.
    pub axes: Vec<Axis>,
    /// Squareness of the axes to each other.
    #[serde(skip_serializing_if = "is_default")]
    pub geometry: Squareness,
    /// Seed of the random numbers.
    #[serde(skip_serializing_if = "is_default")]
    pub noise: Noise,
    /// The geometry that its control compensates, by [`Machine::compensating`]; no key of the file.
    #[serde(skip)]
    pub compensated: Option<Arc<KnownGeometry<3>>>,
    /// Geometry that the tool has in place of what the axes and `geometry` state, by
    /// [`Machine::with_tool`]; no key of the file.
    #[serde(skip)]
    pub tool: Option<Arc<KnownGeometry<3>>>,
}

/// Squareness errors of the axes: table `[geometry]`, all zero without it. Positive where the angle
/// between the positive directions is less than 90 degrees.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Squareness {
    /// Squareness of y to x, urad.
    pub squareness_xy_urad: f64,
    /// Squareness of z to x, urad.
    pub squareness_xz_urad: f64,
    /// Squareness of z to y, urad.
    pub squareness_yz_urad: f64,
}

/// Random numbers of a machine: table `[noise]`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Noise {
    /// Seed; another one gives other numbers of the same statistics.
    pub seed: u64,
}

/// Periods of the control and of its simulation.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Period {
    /// Period of the position loop, s.
    pub servo_s: f64,
    /// Period of the speed loop and of the integration of the mechanics, s.
    pub mechanics_s: f64,
    /// Mechanics steps in a servo period: `servo_s / mechanics_s`, a whole number.
    pub mechanics_per_servo: u32,
}

/// Most servo periods in a feed period: twenty feed periods of preview must fit into the window.
const MAX_SERVO_PERIODS: f64 = 12.0;

impl Period {
    /// Returns the periods in the form that the axis model takes.
    pub fn periods(&self) -> Periods {
        let Self {
            servo_s,
            mechanics_s,
            mechanics_per_servo,
        } = *self;
        Periods {
            servo_s,
            mechanics_s,
            mechanics_per_servo,
        }
    }

    /// Servo periods in a feed period of about `feed_period_s`: at least one, and no more than a
    /// preview has room for.
    pub fn servo_periods(&self, feed_period_s: f64) -> u32 {
        (feed_period_s / self.servo_s)
            .round()
            .clamp(1.0, MAX_SERVO_PERIODS) as u32
    }
}

/// Limits that a plan and a correction keep on this machine.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Limits {
    /// Speed of a rapid motion, mm/s.
    pub rapid_mm_s: f64,
    /// Highest cutting feed, mm/s.
    pub max_feed_mm_s: f64,
    /// Acceleration along the path, mm/s2.
    pub tangential_accel_mm_s2: f64,
    /// Acceleration across the path in a curve, mm/s2.
    pub normal_accel_mm_s2: f64,
    /// Jump of the velocity vector allowed at a corner, mm/s; 0 stops there.
    pub corner_jump_mm_s: f64,
    /// Largest distance of the corrected command from the programmed path, mm.
    pub max_deviation_mm: f64,
    /// Largest rise of the feedrate above the planned one by a correction, %; `None` means 200.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_feed_rise_percent: Option<f64>,
    /// Largest distance of the planned path from the programmed one where the program says none
    /// (G64 without P), um; none is a planner that keeps to the programmed path.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path_tolerance_um: Option<f64>,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// The format of machine files that is read and written; a file that states none has it. It is
/// raised whenever a file of before would be read otherwise.
pub const MACHINE_FORMAT: u64 = 1;

impl Machine {
    /// A machine by the name of one that is built in, or by the path of a machine file.
    ///
    /// Whatever ends in `.toml` or contains a path separator is a path, and so is `-`, the standard
    /// input.
    ///
    /// # Errors
    /// No such name or file, a file that cannot be read or is not text, and every fault found in
    /// its text.
    pub fn load(name_or_path: &OsStr) -> Result<Self, MachineError> {
        let path = Path::new(name_or_path);
        if is_machine_path(path) {
            return Self::read(path);
        }
        let name = name_or_path.to_string_lossy();
        BUILT_IN_MACHINES
            .iter()
            .find(|(known, _)| *known == name)
            .map(|(known, text)| Self::parse(&format!("{known}.toml"), text))
            .unwrap_or_else(|| Err(MachineError::unknown_name(&name, path.is_file())))
    }

    /// A machine from a file.
    ///
    /// # Errors
    /// A file that cannot be read or is not text, and every fault found in its text.
    pub fn read(path: &Path) -> Result<Self, MachineError> {
        let text = read_text(&KIND, path)?;
        Self::parse(&input::name(path), &text)
    }

    /// A machine from the text of a machine file; `file` is its name in messages.
    ///
    /// # Errors
    /// Every fault found in the text, in one go.
    pub fn parse(file: &str, text: &str) -> Result<Self, MachineError> {
        Self::parse_upon(file, text, &[])
    }

    /// The same for the base of a base; `chain` has the files that build upon it.
    fn parse_upon(file: &str, text: &str, chain: &[&str]) -> Result<Self, MachineError> {
        let invalid = |faults| MachineError::File(FileError::invalid(&KIND, file, text, faults));
        let document = toml_file::document(text).map_err(invalid)?;
        layout::of_this_format(&document).map_err(invalid)?;
        let Some(base) = layout::base(&document).map_err(invalid)? else {
            return layout::machine(&document, None).map_err(invalid);
        };
        // The base is a machine of its own: its faults are reported in its own text.
        let (base_file, base_text) = Self::base_text(file, &base)?;
        let chain = [chain, &[file]].concat();
        if chain.len() > MAX_BASES || chain.contains(&base_file.as_str()) {
            return Err(invalid(vec![layout::circular(&document, &base)]));
        }
        let whole = Self::parse_upon(&base_file, &base_text, &chain)?.text();
        let base_document = toml_file::document(&whole).map_err(invalid)?;
        layout::machine(&document, Some(&base_document)).map_err(invalid)
    }

    /// Returns the machine, whose axes were made of values, if a machine file may have them.
    /// `file` is its name in messages.
    ///
    /// # Errors
    /// Every value of an axis that is out of its range, or does not suit the others.
    pub fn checked(self, file: &str) -> Result<Self, MachineError> {
        let faults = layout::faults_of_axes(&self);
        if faults.is_empty() {
            return Ok(self);
        }
        Err(FileError::invalid(&KIND, file, "", faults).into())
    }

    /// The text of a machine file that reads as this machine, without a base.
    pub fn text(&self) -> String {
        let texts = [
            ("name", &self.name),
            ("description", &self.description),
            ("source", &self.source),
        ];
        let mut text = format!("format = {MACHINE_FORMAT}\n");
        text.extend(
            texts
                .iter()
                .map(|(key, value)| format!("{key} = {}\n", quoted(value))),
        );
        let mut table = |name: &str, lines: String| text += &format!("\n[{name}]\n{lines}");
        table("period", write(keys::PERIOD, &self.period));
        table("limits", write(keys::LIMITS, &self.limits));
        for (axis, name) in self.axes.iter().zip(AXIS_NAMES) {
            table(&format!("axis.{name}"), write(keys::AXIS, axis));
            if let Some(transmission) = &axis.transmission {
                table(
                    &format!("axis.{name}.transmission"),
                    write(keys::TRANSMISSION, transmission),
                );
            }
        }
        for (name, lines) in [
            ("geometry", write(keys::GEOMETRY, &self.geometry)),
            ("noise", write(keys::NOISE, &self.noise)),
        ] {
            if !lines.is_empty() {
                table(name, lines);
            }
        }
        table("plc", write(keys::PLC, &self.plc));
        for event in &self.plc_events {
            let p = event.p.map_or(String::new(), |p| format!(" P{p}"));
            let [row, label] = [&event.row, &event.label].map(|value| quoted(value));
            let lines = format!(
                "row = {row}\nlabel = {label}\ntakes_s = {:?}\n",
                event.takes_s
            );
            table(&format!("plc.event.\"M{}{p}\"", event.code), lines);
        }
        text
    }

    /// Name and text of a base: a built-in machine, or a file beside the one that names it. The
    /// name that a built-in machine gets here is no file name, so a file `tnv40.toml` may build
    /// upon `tnv40`.
    fn base_text(file: &str, base: &str) -> Result<(String, String), MachineError> {
        if let Some((name, text)) = BUILT_IN_MACHINES.iter().find(|(name, _)| *name == base) {
            return Ok((format!("built-in {name}"), (*text).to_owned()));
        }
        if !is_machine_path(Path::new(base)) {
            return Err(MachineError::unknown_name(base, false));
        }
        let path = Path::new(file).parent().unwrap_or(Path::new("")).join(base);
        Ok((path.display().to_string(), read_text(&KIND, &path)?))
    }

    /// Returns true if any property of the machine is random. Two cuts then differ by the noise
    /// seed.
    pub fn is_noisy(&self) -> bool {
        self.axes.iter().any(Axis::is_noisy)
    }

    /// The same machine with other random numbers.
    #[must_use]
    pub fn with_noise_seed(&self, seed: u64) -> Self {
        Self {
            noise: Noise { seed },
            ..self.clone()
        }
    }

    /// Returns the models of the first N axes.
    pub fn axis_model<const N: usize>(&self) -> [AxisModel; N] {
        std::array::from_fn(|i| AxisModel::new(self.axis(i).parameters(), self.period.periods()))
    }

    /// Returns true if each axis has its own limits. Such a machine is planned axis by axis.
    pub fn has_axis_limits(&self) -> bool {
        let limited = |axis: &Axis| {
            axis.max_velocity_mm_s.is_some()
                && axis.max_accel_mm_s2.is_some()
                && axis.max_jerk_mm_s3.is_some()
        };
        self.axes.iter().all(limited)
    }

    /// The lowest gain of a position loop, 1/s.
    pub fn slowest_kp_1_s(&self) -> f64 {
        self.axes
            .iter()
            .map(|axis| axis.kp_1_s)
            .fold(f64::INFINITY, f64::min)
    }

    /// Two or three.
    pub fn axis_count(&self) -> usize {
        self.axes.len()
    }

    /// The i-th axis; one that the machine does not have is like its last.
    pub fn axis(&self, i: usize) -> &Axis {
        &self.axes[i.min(self.axes.len() - 1)]
    }

    /// Acceleration that a correction of the i-th axis may add to the plan's where it fades, mm/s2:
    /// as much as the plan itself has, where nothing else is said.
    pub fn correction_accel_mm_s2(&self, i: usize) -> f64 {
        let axis = self.axis(i);
        axis.correction_accel_mm_s2
            .or(axis.fade_accel_mm_s2)
            .unwrap_or_else(|| self.turning_accel_mm_s2(i))
    }

    /// Acceleration at which the plan turns the i-th axis round, mm/s2.
    pub(crate) fn turning_accel_mm_s2(&self, i: usize) -> f64 {
        self.axis(i)
            .max_accel_mm_s2
            .filter(|_| self.has_axis_limits())
            .unwrap_or(self.limits.normal_accel_mm_s2)
    }

    /// Acceleration of the i-th axis that its command may have, mm/s2: the one that is stated, or
    /// the largest that its plan takes.
    pub(crate) fn accel_limit_mm_s2(&self, i: usize) -> f64 {
        let limits = &self.limits;
        let corner_mm_s2 = limits.corner_jump_mm_s / self.period.servo_s;
        let curve_mm_s2 = libm::hypot(limits.tangential_accel_mm_s2, limits.normal_accel_mm_s2);
        let planned_mm_s2 = curve_mm_s2.max(corner_mm_s2);
        self.axis(i).max_accel_mm_s2.unwrap_or(planned_mm_s2)
    }

    /// Acceleration that the owner allows the offset of a correction in the loop, mm/s2; infinite
    /// where nothing is stated.
    pub(crate) fn owners_accel_mm_s2(&self) -> f64 {
        self.axes
            .iter()
            .filter_map(|axis| axis.correction_accel_mm_s2)
            .fold(f64::INFINITY, f64::min)
    }

    /// Acceleration that the command of the i-th axis may have with a correction in the loop, mm/s2:
    /// its limit, and what the owner allows the correction beyond it.
    pub fn axis_command_accel_mm_s2(&self, i: usize) -> f64 {
        self.accel_limit_mm_s2(i) + self.axis(i).correction_accel_mm_s2.unwrap_or(0.0)
    }

    /// The smallest of these accelerations of all axes, mm/s2.
    pub fn command_accel_mm_s2(&self) -> f64 {
        (0..self.axis_count())
            .map(|i| self.axis_command_accel_mm_s2(i))
            .fold(f64::INFINITY, f64::min)
    }

    /// Content of the machine as a hexadecimal key for caches: equal for machines whose axes move
    /// equally, whatever their names and however long their PLC takes.
    ///
    /// Hashed is the JSON of periods, limits and axes, and of geometry and noise where there is
    /// any; field order and the shortest round-trip form of numbers make it canonical.
    pub fn fingerprint(&self) -> String {
        let content = if is_default(&self.geometry) && is_default(&self.noise) {
            serde_json::json!([self.period, self.limits, self.axes])
        } else {
            serde_json::json!([
                self.period,
                self.limits,
                self.axes,
                self.geometry,
                self.noise
            ])
        };
        blake3::hash(content.to_string().as_bytes())
            .to_hex()
            .to_string()
    }
}

/// Bases of bases up to which a file is read; a longer chain leads around by other names of the
/// same files.
const MAX_BASES: usize = 16;

/// Returns true if the value of `--machine` is a file or the standard input, false if it is the
/// name of a built-in machine.
pub fn is_machine_path(name_or_path: &Path) -> bool {
    input::is_standard_input(name_or_path)
        || name_or_path
            .extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
        || name_or_path.components().count() != 1
}

#[cfg(test)]
mod tests;
