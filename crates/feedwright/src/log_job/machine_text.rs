//! The machine file of an identified machine: each value with its interval, or that it is assumed.

use std::fmt::Write as _;

use feedwright_gcode::visible;
use feedwright_ident::{FoundAxis, SERVO_MECHANICS, servo_period_s};
use feedwright_sim::MACHINE_FORMAT;
use feedwright_sim::toml_file::quoted;

use super::LogIdentified;
use super::axis_keys::{AxisKey, axis_keys, remark};

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
    let most = |i: usize| {
        machine
            .axes
            .iter()
            .map(|axis| axis.most[i])
            .fold(0.0, f64::max)
    };
    let (speed_mm_s, accel_mm_s2) = (most(0).clamp(0.01, 1e4), most(1).clamp(0.1, 1e6));
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
        "description = {}",
        quoted(&format!("axes identified from {log}"))
    );
    let _ = writeln!(
        text,
        "source = {}",
        quoted(&format!(
            "{log}, {}, {} samples",
            identified.log.format,
            identified.log.time_s.len()
        ))
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
        "corner_jump_mm_s = 0 # assumed\nmax_deviation_mm = 0.5 # assumed"
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
