//! The machine file of an identified machine: each value with its interval, or that it is assumed.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use super::{LogIdentified, digits, places};
use crate::identify::grey_box::found_axis::{FoundAxis, NumberSource};
use crate::identify::grey_box::terms::LawTerm;
use crate::identify::grey_box::{SERVO_MECHANICS, servo_period_s};
use crate::toml_file::quoted;

/// Most that a machine file has of an asymmetry, part of the Coulomb friction.
const MOST_ASYMMETRY: f64 = 0.99;
/// Torque limit where the log never came to one, times what its motions took.
const SPARE: f64 = 10.0;
/// Least friction and smoothing that a machine file has.
const LEAST_SMOOTHING_RAD_S: f64 = 1e-6;

/// The text of a machine file.
pub fn machine_text(identified: &LogIdentified, name: &str) -> String {
    let machine = &identified.machine;
    let servo_s = servo_period_s(machine.sample_s);
    let places = places(&machine.axes);
    let mut text = head(identified, name, servo_s);
    for (key, place) in ["x", "y", "z"].into_iter().zip(places) {
        match place {
            Some(i) => {
                let _ = writeln!(text, "\n[axis.{key}] # axis {} of the log", machine.axes[i].name);
                axis(&mut text, &machine.axes[i], servo_s);
            }
            // A machine has x and y: what the log does not have is as what it has.
            None if key != "z" && !machine.axes.is_empty() => {
                let as_this = places.iter().flatten().next().copied().unwrap_or(0);
                let _ = writeln!(text, "\n[axis.{key}] # assumed: as axis {} of the log", machine.axes[as_this].name);
                axis(&mut text, &machine.axes[as_this], servo_s);
            }
            None => {}
        }
    }
    text
}

/// What stands before the axes.
fn head(identified: &LogIdentified, name: &str, servo_s: f64) -> String {
    let machine = &identified.machine;
    let most = |i: usize| machine.axes.iter().map(|axis| axis.most[i]).fold(0.0, f64::max);
    let (speed_mm_s, accel_mm_s2) = (most(0).clamp(0.01, 1e4), most(1).clamp(0.1, 1e6));
    let mut text = String::new();
    // A name that breaks the line would not stay in its comment.
    let log = &identified.job.name.replace(char::is_control, " ");
    let _ = writeln!(
        text,
        "# Identified by feedwright from {log}. Values in comments are intervals of 90 %, the inertia taken as it stands."
    );
    for line in identified.advice() {
        let _ = writeln!(text, "# {line}.");
    }
    let _ = writeln!(text, "\nname = {}", quoted(name));
    let _ = writeln!(text, "description = {}", quoted(&format!("axes identified from {log}")));
    let _ = writeln!(
        text,
        "source = {}",
        quoted(&format!("{log}, {}, {} samples", identified.log.format, identified.log.time_s.len()))
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
    let _ = writeln!(text, "mechanics_s = {:?} # assumed", servo_s / f64::from(SERVO_MECHANICS));
    let _ = writeln!(
        text,
        "\n[limits]\nrapid_mm_s = {speed_mm_s:?} # the highest speed of the log\nmax_feed_mm_s = {speed_mm_s:?} # as above"
    );
    let _ = writeln!(
        text,
        "tangential_accel_mm_s2 = {accel_mm_s2:?} # the highest acceleration of the log\nnormal_accel_mm_s2 = {accel_mm_s2:?} # as above"
    );
    let _ = writeln!(text, "corner_jump_mm_s = 0 # assumed\nmax_deviation_mm = 0.5 # assumed");
    text
}

/// The keys of an axis.
fn axis(text: &mut String, found: &FoundAxis, servo_s: f64) {
    let mechanics_s = servo_s / f64::from(SERVO_MECHANICS);
    mechanics(text, found, mechanics_s);
    loops(text, found);
    extras(text, found, mechanics_s);
    if found.step_um > 0.0 {
        key(text, "encoder_step_um", found.step_um.min(1e3), "as the log shows them");
    }
    if found.noise_um > 0.0 {
        key(text, "encoder_noise_um", found.noise_um.min(1e3), "by third differences of the actual position");
    }
    if let Some(resolved) = &found.resolved {
        let window = digits(resolved.values.get(LawTerm::SpeedWindow));
        let _ = writeln!(
            text,
            "# by the torque column the drive takes the speed over {window} s; the gains here have that in them, as no key does"
        );
    }
    let late = digits(found.values.get(LawTerm::RecordDelay));
    let _ = writeln!(
        text,
        "# the log has actual positions {late} s later than the commands; no machine shows that of itself"
    );
}

fn key(text: &mut String, name: &str, value: f64, comment: &str) {
    let before = if comment.is_empty() { "" } else { " # " };
    let _ = writeln!(text, "{name} = {value:?}{before}{comment}");
}

/// Torque at the shaft for an acceleration of the table of 1 mm/s2, N m.
fn nm_per_mm_s2(found: &FoundAxis) -> f64 {
    found.inertia().0 * TAU / found.lead().0
}

/// Inertia and friction.
fn mechanics(text: &mut String, found: &FoundAxis, mechanics_s: f64) {
    let ((lead, of_lead), (inertia, _, of_inertia)) = (found.lead(), found.inertia());
    let (get, nm) = (|term| found.values.get(term), nm_per_mm_s2(found));
    key(text, "lead_mm_per_rev", lead, of_lead.word());
    key(text, "inertia_kg_m2", inertia.clamp(1e-9, 1e3), of_inertia.word());
    let viscous = get(LawTerm::Viscous);
    let of_viscous = if viscous > 0.0 { found.gains_source() } else { NumberSource::Assumed };
    key(text, "viscous_friction_nm_s", inertia * viscous, of_viscous.word());
    key(text, "coulomb_friction_nm", nm * get(LawTerm::Coulomb), &interval(found, LawTerm::Coulomb, nm));
    let smoothing = found.values.smoothing_at_mm_s(mechanics_s) * TAU / lead;
    key(text, "coulomb_smoothing_rad_s", smoothing.max(LEAST_SMOOTHING_RAD_S), "assumed");
    let (offset, most) = (get(LawTerm::Offset), MOST_ASYMMETRY * get(LawTerm::Coulomb));
    let held = if offset.abs() > most { "; held within the Coulomb friction" } else { "" };
    let comment = format!("{}{held}", interval(found, LawTerm::Offset, nm));
    key(text, "coulomb_asymmetry_nm", nm * offset.clamp(-most, most), &comment);
    key(text, "disturbance_nm", 0.0, "");
    key(text, "disturbance_hz", 0.0, "");
}

/// Gains and limits of the loops.
fn loops(text: &mut String, found: &FoundAxis) {
    let (get, nm) = (|term| found.values.get(term), nm_per_mm_s2(found));
    let apart = match found.gains_source() {
        NumberSource::Assumed => "from Kp Kv / J and (Kv + B) / J, B being assumed",
        _ => "from Kp Kv / J and (Kv + B) / J",
    };
    key(text, "kp_1_s", found.values.kp_1_s(), apart);
    key(text, "kd", 0.0, "assumed");
    key(text, "kv_nm_s_per_rad", found.inertia().0 * found.values.speed_gain_1_s(), apart);
    let limit = get(LawTerm::AccelerationLimit);
    if limit > 0.0 {
        key(text, "torque_limit_nm", nm * limit, &interval(found, LawTerm::AccelerationLimit, nm));
    } else {
        let needed = nm * (found.most[1] + get(LawTerm::Coulomb) + get(LawTerm::Viscous) * found.most[0]);
        key(text, "torque_limit_nm", (SPARE * needed).clamp(1e-6, 1e6), "assumed: the log never came to one");
    }
}

/// What an axis may have beside.
fn extras(text: &mut String, found: &FoundAxis, mechanics_s: f64) {
    let get = |term| found.values.get(term);
    let whole = (get(LawTerm::LoopDelay) / mechanics_s).round() * mechanics_s;
    optional(text, found, "drive_delay_s", LawTerm::LoopDelay, whole, 1.0);
    let integral = get(LawTerm::Integral);
    if integral > 0.0 {
        let half = found.half_interval(LawTerm::Integral).unwrap_or(f64::INFINITY);
        let end = |rate: f64| if rate > 0.0 { digits(1.0 / rate) } else { "any".to_owned() };
        let comment = format!("{} to {}", end(integral + half), end(integral - half));
        key(text, "speed_integral_s", (1.0 / integral).min(10.0), &comment);
    }
    for (name, term) in [
        ("velocity_feedforward", LawTerm::VelocityFeedforward),
        ("acceleration_feedforward", LawTerm::AccelerationFeedforward),
        ("speed_limit_mm_s", LawTerm::SpeedLimit),
    ] {
        optional(text, found, name, term, get(term), 1.0);
    }
    let filter = get(LawTerm::FilterTime);
    if filter > 0.0 {
        let comment = format!("a time constant of {} s", interval(found, LawTerm::FilterTime, 1.0));
        key(text, "torque_filter_hz", (1.0 / (TAU * filter)).min(1e5), &comment);
    }
    optional(text, found, "presliding_um", LawTerm::Presliding, 1e3 * get(LawTerm::Presliding), 1e3);
    let stribeck = get(LawTerm::Stribeck);
    if stribeck > 0.0 {
        let nm = nm_per_mm_s2(found) * stribeck * get(LawTerm::Coulomb);
        let comment = format!("a part of {} of the Coulomb friction", interval(found, LawTerm::Stribeck, 1.0));
        key(text, "stribeck_nm", nm, &comment);
        optional(text, found, "stribeck_mm_s", LawTerm::StribeckSpeed, get(LawTerm::StribeckSpeed), 1.0);
    }
}

/// The interval of a term in the unit of its key.
fn interval(found: &FoundAxis, term: LawTerm, scale: f64) -> String {
    found.half_interval(term).map_or_else(String::new, |half| {
        let value = scale * found.values.get(term);
        format!("{} to {}", digits(value - scale * half), digits(value + scale * half))
    })
}

/// A key of a term that the axis may not have.
fn optional(text: &mut String, found: &FoundAxis, name: &str, term: LawTerm, value: f64, scale: f64) {
    if value > 0.0 {
        let _ = writeln!(text, "{name} = {value:?} # {}", interval(found, term, scale));
    }
}
