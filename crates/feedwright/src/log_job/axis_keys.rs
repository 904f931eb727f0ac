//! The keys that a machine file has of an identified axis.

use std::f64::consts::TAU;

use feedwright_control::Part;
use feedwright_ident::{FoundAxis, ModelTerm, NumberSource, PlaceWave, SERVO_MECHANICS};
use feedwright_sim::rounded;

use super::digits;

/// Most that a machine file has of an asymmetry, part of the Coulomb friction.
const MOST_ASYMMETRY: f64 = 0.99;
/// Torque limit where the log never came to one, times what its motions took.
const SPARE: f64 = 10.0;
/// Most that a machine file has of the delay of a drive, s.
const MOST_DRIVE_DELAY_S: f64 = 0.02;
/// Least friction and smoothing that a machine file has.
const LEAST_SMOOTHING_RAD_S: f64 = 1e-6;

/// A key of a machine file.
pub(super) struct AxisKey {
    pub(super) name: &'static str,
    pub(super) value: f64,
    pub(super) comment: String,
    /// True if the value comes from the log. Other values are given, kept from before, or assumed.
    pub(super) is_identified: bool,
}

/// The keys of an identified axis, and those of its transmission, none where it is rigid; `servo_s`
/// is the servo period that follows from the log, s.
pub(super) fn axis_keys(found: &FoundAxis, servo_s: f64) -> [Vec<AxisKey>; 2] {
    let mechanics_s = servo_s / f64::from(SERVO_MECHANICS);
    let mut keys = vec![];
    mechanics(&mut keys, found, mechanics_s);
    loops(&mut keys, found);
    extras(&mut keys, found, mechanics_s);
    noise(&mut keys, found);
    place_waves(&mut keys, found);
    [keys, transmission(found, mechanics_s)]
}

fn identified_key(name: &'static str, value: f64, comment: impl Into<String>) -> AxisKey {
    AxisKey {
        name,
        // A log determines no more digits.
        value: rounded(value, 6),
        comment: comment.into(),
        is_identified: true,
    }
}

fn assumed(name: &'static str, value: f64, comment: impl Into<String>) -> AxisKey {
    AxisKey {
        is_identified: false,
        ..identified_key(name, value, comment)
    }
}

/// A key by where its number comes from.
fn by_source(name: &'static str, value: f64, source: NumberSource) -> AxisKey {
    let is_identified = matches!(
        source,
        NumberSource::Identified | NumberSource::TorqueColumn
    );
    AxisKey {
        is_identified,
        ..identified_key(name, value, source.word())
    }
}

/// Noise: of the encoder, and what the free run leaves, as a torque.
fn noise(keys: &mut Vec<AxisKey>, found: &FoundAxis) {
    if found.step_um > 0.0 {
        keys.push(identified_key(
            "encoder_step_um",
            found.step_um.min(1e3),
            "as the log shows them",
        ));
    }
    if found.noise_um > 0.0 {
        keys.push(identified_key(
            "encoder_noise_um",
            found.noise_um.min(1e3),
            "by third differences of the actual position",
        ));
    }
    if let Some(residual) = &found.residual {
        let nm = nm_per_mm_s2(found) * residual.load_mm_s2;
        let comment = format!(
            "moves the axis as what the free run leaves: {} um RMS",
            digits(residual.left_um)
        );
        keys.push(identified_key("torque_noise_nm", nm.min(1e3), comment));
        keys.push(identified_key(
            "torque_noise_s",
            residual.correlation_s,
            "as long as that is correlated",
        ));
    }
}

/// Adds the keys of what repeats with place, where the log shows it.
fn place_waves(keys: &mut Vec<AxisKey>, found: &FoundAxis) {
    if let Some(wave) = found.waves.interpolation {
        keys.push(identified_key(
            "interpolation_error_um",
            wave.amplitude.min(1e3),
            "as the log shows it, period after period of the encoder",
        ));
        let is_given = found.facts.signal_period_mm.is_some();
        keys.push(period_key(
            "signal_period_um",
            1e3 * wave.period_mm,
            is_given,
            String::new(),
        ));
        keys.push(phase_key("interpolation_phase_rad", &wave));
    }
    if let Some(wave) = found.waves.cogging {
        keys.push(identified_key(
            "cogging_nm",
            (nm_per_mm_s2(found) * wave.amplitude).min(1e5),
            "as the log shows it",
        ));
        let (lead, of_lead) = found.lead();
        let period = format!(
            ": a period of {} mm on a lead that is {}",
            digits(wave.period_mm),
            of_lead.word()
        );
        let is_given = found.facts.cogging_per_rev.is_some();
        keys.push(period_key(
            "cogging_per_rev",
            lead / wave.period_mm,
            is_given,
            period,
        ));
        keys.push(phase_key("cogging_phase_rad", &wave));
    }
}

/// Key of a period over the place. A travel has thousands of periods, so it has more digits than
/// other keys.
fn period_key(name: &'static str, value: f64, is_given: bool, more: String) -> AxisKey {
    let source = if is_given {
        NumberSource::Given
    } else {
        NumberSource::Identified
    };
    AxisKey {
        value: rounded(value, 9),
        comment: format!("{}{more}", source.word()),
        ..by_source(name, value, source)
    }
}

/// Key of a phase over the place.
fn phase_key(name: &'static str, wave: &PlaceWave) -> AxisKey {
    identified_key(name, wave.phase_rad, "at position zero of the log")
}

/// Says what of the log no key describes.
pub(super) fn remark(found: &FoundAxis) -> String {
    let late = digits(found.axis_model().get(ModelTerm::RecordDelay));
    format!(
        "the log has actual positions {late} s later than the commands; no machine shows that by itself"
    )
}

/// Torque at the shaft for an acceleration of the table of 1 mm/s2, N m.
fn nm_per_mm_s2(found: &FoundAxis) -> f64 {
    found.inertia().0 * TAU / found.lead().0
}

/// Inertia and friction.
fn mechanics(keys: &mut Vec<AxisKey>, found: &FoundAxis, mechanics_s: f64) {
    let ((lead, of_lead), (inertia, _, of_inertia)) = (found.lead(), found.inertia());
    let (get, nm) = (|term| found.axis_model().get(term), nm_per_mm_s2(found));
    keys.push(by_source("lead_mm_per_rev", lead, of_lead));
    keys.push(by_source(
        "inertia_kg_m2",
        inertia.clamp(1e-9, 1e3),
        of_inertia,
    ));
    let viscous = get(ModelTerm::Viscous);
    let of_viscous = if viscous > 0.0 {
        found.gains_source()
    } else {
        NumberSource::Assumed
    };
    keys.push(by_source(
        "viscous_friction_nm_s",
        inertia * viscous,
        of_viscous,
    ));
    keys.push(identified_key(
        "coulomb_friction_nm",
        nm * get(ModelTerm::Coulomb),
        interval(found, ModelTerm::Coulomb, nm),
    ));
    let smoothing = found.axis_model().smoothing_mm_s(mechanics_s) * TAU / lead;
    keys.push(assumed(
        "coulomb_smoothing_rad_s",
        smoothing.max(LEAST_SMOOTHING_RAD_S),
        "assumed",
    ));
    let (offset, most) = (
        get(ModelTerm::Offset),
        MOST_ASYMMETRY * get(ModelTerm::Coulomb),
    );
    let held = if offset.abs() > most {
        "; held within the Coulomb friction"
    } else {
        ""
    };
    let comment = format!("{}{held}", interval(found, ModelTerm::Offset, nm));
    keys.push(identified_key(
        "coulomb_asymmetry_nm",
        nm * offset.clamp(-most, most),
        comment,
    ));
    keys.push(assumed("disturbance_nm", 0.0, ""));
    keys.push(assumed("disturbance_hz", 0.0, ""));
}

/// Gains and limits of the loops.
fn loops(keys: &mut Vec<AxisKey>, found: &FoundAxis) {
    let (get, nm) = (|term| found.axis_model().get(term), nm_per_mm_s2(found));
    let apart = match found.gains_source() {
        NumberSource::Assumed => "from Kp Kv / J and (Kv + B) / J, B being assumed",
        _ => "from Kp Kv / J and (Kv + B) / J",
    };
    keys.push(identified_key("kp_1_s", found.axis_model().kp_1_s(), apart));
    keys.push(assumed("kd", 0.0, "assumed"));
    keys.push(identified_key(
        "kv_nm_s_per_rad",
        found.inertia().0 * found.axis_model().speed_gain_1_s(),
        apart,
    ));
    let limit = get(ModelTerm::AccelerationLimit);
    if limit > 0.0 {
        keys.push(identified_key(
            "torque_limit_nm",
            nm * limit,
            interval(found, ModelTerm::AccelerationLimit, nm),
        ));
    } else {
        let needed = nm
            * (found.most[1] + get(ModelTerm::Coulomb) + get(ModelTerm::Viscous) * found.most[0]);
        let limit = (SPARE * needed).clamp(1e-6, 1e6);
        keys.push(assumed(
            "torque_limit_nm",
            limit,
            "assumed: the log never came to one",
        ));
    }
}

/// Adds the keys of further properties of an axis.
fn extras(keys: &mut Vec<AxisKey>, found: &FoundAxis, mechanics_s: f64) {
    let get = |term| found.axis_model().get(term);
    let late_s = get(ModelTerm::CommandDelay);
    if late_s > 0.0 {
        keys.push(identified_key(
            "command_delay_s",
            late_s,
            "commands reach the position loop late, by whole servo periods",
        ));
    }
    let periods = (get(ModelTerm::LoopDelay) / mechanics_s)
        .round()
        .min((MOST_DRIVE_DELAY_S / mechanics_s).floor());
    let whole = periods * mechanics_s;
    optional(
        keys,
        found,
        "drive_delay_s",
        ModelTerm::LoopDelay,
        whole,
        1.0,
    );
    let integral = get(ModelTerm::Integral);
    if integral > 0.0 {
        let half = found
            .half_interval(ModelTerm::Integral)
            .unwrap_or(f64::INFINITY);
        let end = |rate: f64| {
            if rate > 0.0 {
                digits(1.0 / rate)
            } else {
                "any".to_owned()
            }
        };
        let comment = format!("{} to {}", end(integral + half), end(integral - half));
        keys.push(identified_key(
            "speed_integral_s",
            (1.0 / integral).min(10.0),
            comment,
        ));
    }
    of_part(keys, found, Part::Drive);
    if let Some(resolved) = &found.resolved {
        let fitted = interval(found, ModelTerm::SpeedWindow, 1.0);
        let of_window = if resolved.torque.is_some() {
            fitted
        } else {
            "given".to_owned()
        };
        keys.push(identified_key(
            "speed_window_s",
            get(ModelTerm::SpeedWindow),
            of_window,
        ));
        let is_held = if get(ModelTerm::SpeedHold) > 0.0 {
            1.0
        } else {
            0.0
        };
        optional(
            keys,
            found,
            "speed_held",
            ModelTerm::SpeedHold,
            is_held,
            1.0,
        );
    }
    let filter = get(ModelTerm::FilterTime);
    if filter > 0.0 {
        let comment = format!(
            "a time constant of {} s",
            interval(found, ModelTerm::FilterTime, 1.0)
        );
        keys.push(identified_key(
            "torque_filter_hz",
            (1.0 / (TAU * filter)).min(1e5),
            comment,
        ));
    } else {
        optional(
            keys,
            found,
            "torque_filter_hz",
            ModelTerm::FilterTime,
            0.0,
            1.0,
        );
    }
    friction_extras(keys, found);
}

/// Adds the keys of further properties of its friction.
fn friction_extras(keys: &mut Vec<AxisKey>, found: &FoundAxis) {
    let get = |term| found.axis_model().get(term);
    of_part(keys, found, Part::Friction);
    let stribeck = get(ModelTerm::Stribeck);
    if stribeck > 0.0 {
        let nm = nm_per_mm_s2(found) * stribeck * get(ModelTerm::Coulomb);
        let comment = format!(
            "a part of {} of the Coulomb friction",
            interval(found, ModelTerm::Stribeck, 1.0)
        );
        keys.push(identified_key("stribeck_nm", nm, comment));
        optional(
            keys,
            found,
            "stribeck_mm_s",
            ModelTerm::StribeckSpeed,
            get(ModelTerm::StribeckSpeed),
            1.0,
        );
    }
}

/// The interval of a term in the unit of its key.
fn interval(found: &FoundAxis, term: ModelTerm, scale: f64) -> String {
    found.half_interval(term).map_or_else(String::new, |half| {
        let value = scale * found.axis_model().get(term);
        format!(
            "{} to {}",
            digits(value - scale * half),
            digits(value + scale * half)
        )
    })
}

/// A key of a term that the axis may not have. A machine file that is updated may have had it
/// before.
fn optional(
    keys: &mut Vec<AxisKey>,
    found: &FoundAxis,
    name: &'static str,
    term: ModelTerm,
    value: f64,
    scale: f64,
) {
    let was = found.facts.before.map_or(0.0, |before| before.get(term));
    if value > 0.0 || was > 0.0 {
        keys.push(identified_key(name, value, interval(found, term, scale)));
    }
}

/// Adds the keys of a part of the axis that have the value of a term in another unit.
fn of_part(keys: &mut Vec<AxisKey>, found: &FoundAxis, part: Part) {
    for term in ModelTerm::ALL {
        if let Some((of, name, scale)) = term.in_file()
            && of == part
        {
            let value = scale * found.axis_model().get(term);
            optional(keys, found, name, term, value, scale);
        }
    }
}

/// Motor and table as two masses, where the log shows them.
fn transmission(found: &FoundAxis, mechanics_s: f64) -> Vec<AxisKey> {
    let Some(screw) = found.axis_model().transmission(mechanics_s) else {
        return vec![];
    };
    let seconds = interval(found, ModelTerm::Resonance, 1.0);
    vec![
        identified_key(
            "table_share",
            screw.table_share,
            interval(found, ModelTerm::TableShare, 1.0),
        ),
        identified_key(
            "resonance_hz",
            screw.resonance_hz,
            format!("a time constant of {seconds} s"),
        ),
        assumed("damping_ratio", screw.damping_ratio, "assumed"),
        identified_key(
            "backlash_um",
            screw.backlash_um,
            interval(found, ModelTerm::Backlash, 1e3),
        ),
    ]
}
