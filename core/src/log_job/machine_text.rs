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
    let all = || places.iter().flatten().map(|i| &machine.axes[*i]);
    let most = |i: usize| all().map(|axis| axis.most[i]).fold(0.0, f64::max);
    let (speed_mm_s, accel_mm_s2) = (most(0).clamp(0.01, 1e4), most(1).clamp(0.1, 1e6));
    let mut text = String::new();
    let log = &identified.job.name;
    let _ = writeln!(text, "# Identified by feedwright from {log}. Values in comments are intervals of 90 %, the inertia taken as it stands.");
    for line in identified.advice() {
        let _ = writeln!(text, "# {line}.");
    }
    let _ = writeln!(text, "\nname = {}", quoted(name));
    let _ = writeln!(text, "description = {}", quoted(&format!("axes identified from {log}")));
    let _ = writeln!(text, "source = {}", quoted(&format!("{log}, {}, {} samples", identified.log.format, identified.log.time_s.len())));
    let _ = writeln!(text, "\n[period]\nservo_s = {servo_s:?} # assumed: {}", if servo_s < 0.999 * machine.sample_s { "a part of the time between samples" } else { "the time between samples" });
    let _ = writeln!(text, "mechanics_s = {:?} # assumed", servo_s / f64::from(SERVO_MECHANICS));
    let _ = writeln!(text, "\n[limits]\nrapid_mm_s = {speed_mm_s:?} # the highest speed of the log\nmax_feed_mm_s = {speed_mm_s:?} # as above");
    let _ = writeln!(text, "tangential_accel_mm_s2 = {accel_mm_s2:?} # the highest acceleration of the log\nnormal_accel_mm_s2 = {accel_mm_s2:?} # as above");
    let _ = writeln!(text, "corner_jump_mm_s = 0 # assumed\nmax_deviation_mm = 0.5 # assumed");
    for (key, place) in ["x", "y", "z"].into_iter().zip(places) {
        match place {
            Some(i) => {
                let _ = writeln!(text, "\n[axis.{key}] # axis {} of the log", machine.axes[i].name);
                axis(&mut text, &machine.axes[i], servo_s);
            }
            // A machine has x and y: what the log does not have is as what it has.
            None if key == "y" && !machine.axes.is_empty() => {
                let _ = writeln!(text, "\n[axis.y] # assumed: as x, the log has one axis");
                axis(&mut text, &machine.axes[places[0].unwrap_or(0)], servo_s);
            }
            None => {}
        }
    }
    text
}

/// The keys of an axis.
fn axis(text: &mut String, found: &FoundAxis, servo_s: f64) {
    let mechanics_s = servo_s / f64::from(SERVO_MECHANICS);
    let ((lead, of_lead), (inertia, _, of_inertia)) = (found.lead(), found.inertia());
    let per_mm = TAU / lead;
    let get = |term| found.values.get(term);
    // An acceleration of the table, mm/s2, as a torque at the shaft.
    let nm = |mm_s2: f64| inertia * mm_s2 * per_mm;
    let mut key = |name: &str, value: f64, comment: &str| {
        let before = if comment.is_empty() { "" } else { " # " };
        let _ = writeln!(text, "{name} = {value:?}{before}{comment}");
    };
    let apart = match found.gains_source() {
        NumberSource::Assumed => "from Kp Kv / J and (Kv + B) / J, B being assumed",
        _ => "from Kp Kv / J and (Kv + B) / J",
    };
    key("lead_mm_per_rev", lead, of_lead.word());
    key("inertia_kg_m2", inertia.clamp(1e-9, 1e3), of_inertia.word());
    let of_viscous = if get(LawTerm::Viscous) > 0.0 { found.gains_source().word() } else { NumberSource::Assumed.word() };
    key("viscous_friction_nm_s", inertia * get(LawTerm::Viscous), of_viscous);
    key("coulomb_friction_nm", nm(get(LawTerm::Coulomb)), &interval(found, LawTerm::Coulomb, nm(1.0)));
    let smoothing = (found.values.smoothing_at_mm_s(mechanics_s) * per_mm).max(LEAST_SMOOTHING_RAD_S);
    key("coulomb_smoothing_rad_s", smoothing, "assumed");
    key("disturbance_nm", 0.0, "");
    key("disturbance_hz", 0.0, "");
    key("kp_1_s", found.values.kp_1_s(), apart);
    key("kd", 0.0, "assumed");
    key("kv_nm_s_per_rad", inertia * found.values.speed_gain_1_s(), apart);
    if get(LawTerm::AccelerationLimit) > 0.0 {
        key("torque_limit_nm", nm(get(LawTerm::AccelerationLimit)), &interval(found, LawTerm::AccelerationLimit, nm(1.0)));
    } else {
        let needed = nm(found.most[1] + get(LawTerm::Coulomb) + get(LawTerm::Viscous) * found.most[0]);
        key("torque_limit_nm", (SPARE * needed).clamp(1e-6, 1e6), "assumed: the log never came to one");
    }
    let offset = get(LawTerm::Offset);
    let most = MOST_ASYMMETRY * get(LawTerm::Coulomb);
    let held = if offset.abs() > most { "; held within the Coulomb friction" } else { "" };
    key("coulomb_asymmetry_nm", nm(offset.clamp(-most, most)), &format!("{}{held}", interval(found, LawTerm::Offset, nm(1.0))));
    let whole = (get(LawTerm::LoopDelay) / mechanics_s).round() * mechanics_s;
    optional(text, found, "drive_delay_s", LawTerm::LoopDelay, whole, 1.0);
    let integral = get(LawTerm::Integral);
    if integral > 0.0 {
        let half = found.half_interval(LawTerm::Integral).unwrap_or(f64::INFINITY);
        let ends = [integral + half, integral - half].map(|rate| if rate > 0.0 { digits(1.0 / rate) } else { "any".to_owned() });
        let _ = writeln!(text, "speed_integral_s = {:?} # {} to {}", (1.0 / integral).min(10.0), ends[0], ends[1]);
    }
    optional(text, found, "velocity_feedforward", LawTerm::VelocityFeedforward, get(LawTerm::VelocityFeedforward), 1.0);
    optional(text, found, "acceleration_feedforward", LawTerm::AccelerationFeedforward, get(LawTerm::AccelerationFeedforward), 1.0);
    let filter = get(LawTerm::FilterTime);
    if filter > 0.0 {
        let hz = 1.0 / (TAU * filter);
        let _ = writeln!(text, "torque_filter_hz = {:?} # a time constant of {} s", hz, interval(found, LawTerm::FilterTime, 1.0));
    }
    optional(text, found, "speed_limit_mm_s", LawTerm::SpeedLimit, get(LawTerm::SpeedLimit), 1.0);
    optional(text, found, "presliding_um", LawTerm::Presliding, 1e3 * get(LawTerm::Presliding), 1e3);
    let stribeck = get(LawTerm::Stribeck);
    if stribeck > 0.0 {
        let nm = nm(stribeck * get(LawTerm::Coulomb));
        let _ = writeln!(text, "stribeck_nm = {nm:?} # a part of {} of the Coulomb friction", interval(found, LawTerm::Stribeck, 1.0));
        let _ = writeln!(text, "stribeck_mm_s = {:?} # {}", get(LawTerm::StribeckSpeed), interval(found, LawTerm::StribeckSpeed, 1.0));
    }
    if found.step_um > 0.0 {
        let _ = writeln!(text, "encoder_step_um = {:?} # as the log shows them", found.step_um.min(1e3));
    }
    if found.noise_um > 0.0 {
        let _ = writeln!(text, "encoder_noise_um = {:?} # by third differences of the actual position", found.noise_um.min(1e3));
    }
    let _ = writeln!(text, "# the log has actual positions {} s later than the commands; no machine shows that of itself", digits(get(LawTerm::RecordDelay)));
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
