//! The machine of an identified log, by its values or as a machine file, which has the interval of
//! each value beside it, or that it is assumed.

use std::fmt::Write as _;

use feedwright_gcode::visible;
use feedwright_ident::{FoundAxis, SERVO_MECHANICS, servo_period_s};
use feedwright_plan::Durations;
use feedwright_sim::toml_file::key::Value;
use feedwright_sim::toml_file::{Key, quoted};
use feedwright_sim::{
    Axis, Limits, MACHINE_FORMAT, Machine, MachineError, Noise, Period, Squareness, Transmission,
    machine_keys,
};

use super::LogIdentified;
use super::axis_keys::{AxisKey, axis_keys, remark};

/// Jump of the velocity at a corner that is assumed, mm/s.
const ASSUMED_CORNER_JUMP_MM_S: f64 = 0.0;
/// Deviation of a correction that is assumed, mm.
const ASSUMED_MAX_DEVIATION_MM: f64 = 0.5;

impl LogIdentified {
    /// Highest speed, mm/s, and acceleration, mm/s2, of the log.
    fn limits(&self) -> [f64; 2] {
        let most = |i: usize| {
            let axes = self.machine.axes.iter();
            axes.map(|axis| axis.most[i]).fold(0.0, f64::max)
        };
        [most(0).clamp(0.01, 1e4), most(1).clamp(0.1, 1e6)]
    }

    /// The axis of the log that each axis of the machine is as; a machine has x and y, so that the
    /// first of the log stands for a missing one.
    fn axes_of_machine(&self) -> impl Iterator<Item = &FoundAxis> {
        let places = self.places();
        let first = places.iter().flatten().next().copied().unwrap_or(0);
        let axis = move |(i, place): (usize, Option<usize>)| {
            let place = place.or((i < 2).then_some(first))?;
            self.machine.axes.get(place)
        };
        places.into_iter().enumerate().filter_map(axis)
    }

    /// Description of the machine.
    fn description(&self) -> String {
        format!("axes identified from {}", visible(&self.job.name))
    }

    /// Source of its values.
    fn source(&self) -> String {
        let (log, samples) = (visible(&self.job.name), self.log.time_s.len());
        format!("{log}, {}, {samples} samples", self.log.format)
    }
}

/// The machine, with the values that [`machine_text`] writes.
///
/// # Errors
/// Values that no machine file may have.
pub(crate) fn identified_machine(
    identified: &LogIdentified,
    name: &str,
) -> Result<Machine, MachineError> {
    let servo_s = servo_period_s(identified.machine.sample_s);
    let [speed_mm_s, accel_mm_s2] = identified.limits();
    let machine = Machine {
        name: name.to_owned(),
        description: identified.description(),
        source: identified.source(),
        period: Period {
            servo_s,
            mechanics_s: servo_s / f64::from(SERVO_MECHANICS),
            mechanics_per_servo: SERVO_MECHANICS,
        },
        limits: Limits {
            rapid_mm_s: speed_mm_s,
            max_feed_mm_s: speed_mm_s,
            tangential_accel_mm_s2: accel_mm_s2,
            normal_accel_mm_s2: accel_mm_s2,
            corner_jump_mm_s: ASSUMED_CORNER_JUMP_MM_S,
            max_deviation_mm: ASSUMED_MAX_DEVIATION_MM,
            ..Limits::default()
        },
        axes: identified
            .axes_of_machine()
            .map(|found| axis(found, servo_s))
            .collect(),
        plc: Durations::default(),
        plc_events: Vec::new(),
        geometry: Squareness::default(),
        noise: Noise::default(),
        compensated: None,
        tool: None,
    };
    machine.checked("the machine of the log")
}

/// An axis with the values of its keys.
fn axis(found: &FoundAxis, servo_s: f64) -> Axis {
    let [keys, of_screw] = axis_keys(found, servo_s);
    let screw = || of_values::<Transmission>(machine_keys::TRANSMISSION, &of_screw);
    Axis {
        transmission: (!of_screw.is_empty()).then(screw),
        ..of_values(machine_keys::AXIS, &keys)
    }
}

/// A part of a machine with the values of keys.
fn of_values<T: Default>(table: &[Key<T>], keys: &[AxisKey]) -> T {
    let mut part = T::default();
    for AxisKey { name, value, .. } in keys {
        if let Some(Key {
            value: Value::Number { set, .. },
            ..
        }) = table.iter().find(|key| key.name == *name)
        {
            set(&mut part, *value);
        }
    }
    part
}

/// The text of a machine file.
pub fn machine_text(identified: &LogIdentified, name: &str) -> String {
    let machine = &identified.machine;
    let servo_s = servo_period_s(machine.sample_s);
    let places = identified.places();
    let mut text = head(identified, name, servo_s);
    for (key, place) in ["x", "y", "z"].into_iter().zip(places) {
        match place {
            Some(i) => {
                let _ = writeln!(
                    text,
                    "\n[axis.{key}] # axis {} of the log",
                    machine.axes[i].name
                );
                write_axis(&mut text, key, &machine.axes[i], servo_s);
            }
            // A machine has x and y: what the log does not have is as what it has.
            None if key != "z" && !machine.axes.is_empty() => {
                let as_this = places.iter().flatten().next().copied().unwrap_or(0);
                let _ = writeln!(
                    text,
                    "\n[axis.{key}] # assumed: as axis {} of the log",
                    machine.axes[as_this].name
                );
                write_axis(&mut text, key, &machine.axes[as_this], servo_s);
            }
            None => {}
        }
    }
    text
}

/// Returns the text before the axes.
fn head(identified: &LogIdentified, name: &str, servo_s: f64) -> String {
    let machine = &identified.machine;
    let [speed_mm_s, accel_mm_s2] = identified.limits();
    let mut text = String::new();
    // A name that breaks the line would not stay in its comment.
    let log = visible(&identified.job.name);
    let _ = writeln!(
        text,
        "# Identified by feedwright from {log}. Values in comments are intervals of 90 %, the inertia taken as it stands."
    );
    for line in identified.advice() {
        let _ = writeln!(text, "# {}.", visible(&line));
    }
    let _ = writeln!(text, "\nformat = {MACHINE_FORMAT}\nname = {}", quoted(name));
    let _ = writeln!(
        text,
        "description = {}\nsource = {}",
        quoted(&identified.description()),
        quoted(&identified.source())
    );
    let _ = writeln!(
        text,
        "\n[period]\nservo_s = {servo_s:?} # assumed: {}",
        if servo_s < 0.999 * machine.sample_s {
            "a part of the time between samples"
        } else {
            "the time between samples"
        }
    );
    let _ = writeln!(
        text,
        "mechanics_s = {:?} # assumed",
        servo_s / f64::from(SERVO_MECHANICS)
    );
    let _ = writeln!(
        text,
        "\n[limits]\nrapid_mm_s = {speed_mm_s:?} # the highest speed of the log\nmax_feed_mm_s = {speed_mm_s:?} # as above"
    );
    let _ = writeln!(
        text,
        "tangential_accel_mm_s2 = {accel_mm_s2:?} # the highest acceleration of the log\nnormal_accel_mm_s2 = {accel_mm_s2:?} # as above"
    );
    let _ = writeln!(
        text,
        "corner_jump_mm_s = {ASSUMED_CORNER_JUMP_MM_S} # assumed\nmax_deviation_mm = {ASSUMED_MAX_DEVIATION_MM} # assumed"
    );
    text
}

/// The keys of an axis.
fn write_axis(text: &mut String, name: &str, found: &FoundAxis, servo_s: f64) {
    let [keys, transmission] = axis_keys(found, servo_s);
    write_keys(text, &keys);
    let _ = writeln!(text, "# {}", remark(found));
    if !transmission.is_empty() {
        let _ = writeln!(text, "\n[axis.{name}.transmission]");
        write_keys(text, &transmission);
    }
}

fn write_keys(text: &mut String, keys: &[AxisKey]) {
    for AxisKey {
        name,
        value,
        comment,
        ..
    } in keys
    {
        let before = if comment.is_empty() { "" } else { " # " };
        let _ = writeln!(text, "{name} = {value:?}{before}{comment}");
    }
}
