//! The layout of a machine file: its tables, keys, units and ranges.
//!
//! Ranges are wide: they keep out what no machine has (a negative inertia, a unit mistaken by a factor of a million), not
//! what is unusual. A machine that is tuned badly is a result of the simulation, not a fault of its file.

use std::f64::consts::TAU;

use toml::de::DeTable;

use super::error::Fault;
use super::reader::Table;
use super::{AXIS_NAMES, Axis, Durations, Limits, Machine, Period, PlcEvent, Transmission};

/// Relative distance from a whole number below which `servo_s / mechanics_s` counts as whole: a hundred times the
/// rounding of two decimal numbers and their quotient, far below any ratio that is off by a digit.
const WHOLE_RATIO_TOLERANCE: f64 = 1e-12;

/// More mechanics steps than this within a servo period are a mistaken unit, and nobody could wait for them.
const MAX_MECHANICS_PER_SERVO: f64 = 10_000.0;

/// The text of a machine file, taken apart; its values know their places in the text.
type Document<'t> = toml::Spanned<DeTable<'t>>;

/// Takes a text apart; the faults of its syntax where it has any.
pub(super) fn document(text: &str) -> Result<Document<'_>, Vec<Fault>> {
    let (document, syntax_errors) = DeTable::parse_recoverable(text);
    if syntax_errors.is_empty() {
        Ok(document)
    } else {
        Err(syntax_errors.iter().map(|error| syntax_fault(error, text)).collect())
    }
}

/// The name of the machine that a file builds upon, where it does.
pub(super) fn base(document: &Document<'_>) -> Result<Option<String>, Vec<Fault>> {
    let mut faults = Vec::new();
    let name = document.get_ref().contains_key("base").then(|| Table::root(document, None).text("base", &mut faults));
    if faults.is_empty() { Ok(name) } else { Err(faults) }
}

/// The base builds upon another machine.
pub(super) fn chained(document: &Document<'_>, base: &str) -> Fault {
    Fault {
        at: document.get_ref().get("base").map_or(0..0, toml::Spanned::span),
        label: "has a base itself",
        message: format!("base: '{base}' builds upon another machine itself"),
        hint: Some("name that machine, and repeat here what differs".to_owned()),
    }
}

/// The machine that a file describes, upon a base without faults where it has one, or every fault in it.
pub(super) fn machine(document: &Document<'_>, base: Option<&Document<'_>>) -> Result<Machine, Vec<Fault>> {
    let mut faults = Vec::new();
    let mut root = Table::root(document, base);
    if base.is_some() {
        root.text("base", &mut faults);
    }
    let period = period(root.table("period", &mut faults), &mut faults);
    let mechanics_s = period.mechanics_s;
    let mut plc_events = Vec::new();
    let machine = Machine {
        name: root.text("name", &mut faults),
        description: root.text("description", &mut faults),
        source: root.text("source", &mut faults),
        period,
        limits: limits(root.table("limits", &mut faults), &mut faults),
        plc: root
            .optional_table("plc", &mut faults)
            .map(|table| plc(table, &mut plc_events, &mut faults))
            .unwrap_or_default(),
        plc_events,
        axes: axes(root.table("axis", &mut faults), mechanics_s, &mut faults),
    };
    root.finish(&mut faults);
    if faults.is_empty() { Ok(machine) } else { Err(faults) }
}

fn period(mut table: Table<'_, '_>, faults: &mut Vec<Fault>) -> Period {
    let servo_s = table.number("servo_s", "s", 1e-5..=0.1, faults);
    let mechanics_s = table.number("mechanics_s", "s", 1e-7..=0.1, faults);
    let ratio = servo_s / mechanics_s;
    // A value that has a fault of its own is NaN here and gets no second one.
    let is_whole = (ratio - ratio.round()).abs() <= WHOLE_RATIO_TOLERANCE * ratio;
    if ratio.is_finite() && (!is_whole || !(1.0..=MAX_MECHANICS_PER_SERVO).contains(&ratio.round())) {
        let steps = ratio.round().clamp(1.0, MAX_MECHANICS_PER_SERVO);
        faults.push(Fault {
            at: table.place("mechanics_s"),
            label: "does not divide servo_s",
            message: format!(
                "servo_s is {ratio} times mechanics_s ({servo_s} s / {mechanics_s} s); it must be a whole multiple from 1 to {MAX_MECHANICS_PER_SERVO}"
            ),
            hint: Some(format!("mechanics_s = {} s gives {steps} steps", servo_s / steps)),
        });
    }
    table.finish(faults);
    Period { servo_s, mechanics_s, mechanics_per_servo: ratio.round() as u32 }
}

fn limits(mut table: Table<'_, '_>, faults: &mut Vec<Fault>) -> Limits {
    let limits = Limits {
        rapid_mm_s: table.number("rapid_mm_s", "mm/s", 0.01..=1e4, faults),
        max_feed_mm_s: table.number("max_feed_mm_s", "mm/s", 0.01..=1e4, faults),
        tangential_accel_mm_s2: table.number("tangential_accel_mm_s2", "mm/s2", 0.1..=1e6, faults),
        normal_accel_mm_s2: table.number("normal_accel_mm_s2", "mm/s2", 0.1..=1e6, faults),
        corner_jump_mm_s: table.number("corner_jump_mm_s", "mm/s", 0.0..=1e4, faults),
        max_deviation_mm: table.number("max_deviation_mm", "mm", 0.0..=100.0, faults),
    };
    table.finish(faults);
    limits
}

fn plc(mut table: Table<'_, '_>, events: &mut Vec<PlcEvent>, faults: &mut Vec<Fault>) -> Durations {
    let durations = Durations {
        tool_change_s: table.number("tool_change_s", "s", 0.0..=1e4, faults),
        coolant_s: table.number("coolant_s", "s", 0.0..=1e4, faults),
        pallet_change_s: table.number("pallet_change_s", "s", 0.0..=1e5, faults),
        spindle_rev_min_s: table.number("spindle_rev_min_s", "rev/min/s", 0.0..=1e7, faults),
        rotary_deg_s: table.optional_number("rotary_deg_s", "degrees/s", 0.0..=1e5, faults).unwrap_or(0.0),
    };
    if let Some(named) = table.optional_table("event", faults) {
        for (key, table) in named.tables(faults) {
            events.extend(plc_event(&key, table, events, faults));
        }
    }
    table.finish(faults);
    durations
}

fn plc_event(key: &str, mut table: Table<'_, '_>, before: &[PlcEvent], faults: &mut Vec<Fault>) -> Option<PlcEvent> {
    let event = m_code(key).map(|(code, p)| PlcEvent {
        code,
        p,
        row: table.text("row", faults),
        label: table.text("label", faults),
        takes_s: table.number("takes_s", "s", 0.0..=1e4, faults),
    });
    let at = table.header();
    let fault = |label, message, hint: &str| faults.push(Fault { at, label, message, hint: Some(hint.to_owned()) });
    match &event {
        None => {
            fault(
                "no M-code",
                format!("[plc.event] names '{key}', which is no M-code"),
                "write \"M64 P3\" or \"M100\"",
            );
            return None;
        }
        Some(event) if CODES_OF_THEIR_OWN.contains(&event.code) => {
            fault(
                "has a meaning of its own",
                format!("M{} cannot be given another meaning", event.code),
                "its duration is a key of [plc], where it has one",
            );
        }
        Some(event) if before.iter().any(|other| (other.code, other.p) == (event.code, event.p)) => {
            fault("named twice", format!("'{key}' is another spelling of an M-code that is named already"), "keep one");
        }
        Some(_) => {}
    }
    table.finish(faults);
    event
}

/// M-codes whose meaning no machine builder changes: stops, spindle, tool change, coolant, overrides, pallets, modes.
const CODES_OF_THEIR_OWN: [u16; 23] =
    [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 30, 48, 49, 50, 51, 52, 53, 60, 70, 71, 72, 73, 99];

/// `M64 P3`: the code and its P word, blanks and case free.
fn m_code(key: &str) -> Option<(u16, Option<u32>)> {
    let key: String = key.chars().filter(|c| !c.is_whitespace()).map(|c| c.to_ascii_uppercase()).collect();
    let words = key.strip_prefix('M')?;
    // `parse` alone would take a sign.
    let number = |digits: &str| digits.bytes().all(|byte| byte.is_ascii_digit()).then(|| digits.parse().ok()).flatten();
    let (code, p) = match words.split_once('P') {
        Some((code, p)) => (number(code)?, Some(number(p)?)),
        None => (number(words)?, None),
    };
    u16::try_from(code).ok().filter(|&code| code <= LAST_M_CODE).map(|code| (code, p))
}

/// As the reader has it.
const LAST_M_CODE: u16 = 9999;

fn axes(mut table: Table<'_, '_>, mechanics_s: f64, faults: &mut Vec<Fault>) -> Vec<Axis> {
    let [x, y, z] = AXIS_NAMES;
    let mut axes: Vec<Axis> =
        [x, y].into_iter().map(|name| axis(table.table(name, faults), mechanics_s, faults)).collect();
    if let Some(present) = table.optional_table(z, faults) {
        axes.push(axis(present, mechanics_s, faults));
    }
    table.finish(faults);
    axes
}

fn axis(mut table: Table<'_, '_>, mechanics_s: f64, faults: &mut Vec<Fault>) -> Axis {
    let transmission = table.optional_table("transmission", faults);
    let axis = Axis {
        lead_mm_per_rev: table.number("lead_mm_per_rev", "mm/rev", 0.01..=1e3, faults),
        inertia_kg_m2: table.number("inertia_kg_m2", "kg m2", 1e-9..=1e3, faults),
        viscous_friction_nm_s: table.number("viscous_friction_nm_s", "N m s/rad", 0.0..=1e4, faults),
        coulomb_friction_nm: table.number("coulomb_friction_nm", "N m", 0.0..=1e5, faults),
        coulomb_smoothing_rad_s: table.number("coulomb_smoothing_rad_s", "rad/s", 1e-6..=1e3, faults),
        disturbance_nm: table.number("disturbance_nm", "N m", 0.0..=1e5, faults),
        disturbance_hz: table.number("disturbance_hz", "Hz", 0.0..=1e5, faults),
        kp_1_s: table.number("kp_1_s", "1/s", 1e-3..=1e5, faults),
        kd: table.number("kd", "(no unit)", 0.0..=1e3, faults),
        kv_nm_s_per_rad: table.number("kv_nm_s_per_rad", "N m s/rad", 1e-9..=1e6, faults),
        torque_limit_nm: table.number("torque_limit_nm", "N m", 1e-6..=1e6, faults),
        drive_delay_s: table.optional_number("drive_delay_s", "s", 0.0..=0.02, faults).unwrap_or(0.0),
        torque_bits: table.optional_number("torque_bits", "bits", 4.0..=32.0, faults).map(|bits| bits.round() as u32),
        correction_accel_mm_s2: table.optional_number("correction_accel_mm_s2", "mm/s2", 0.1..=1e6, faults),
        encoder_step_um: table.optional_number("encoder_step_um", "um", 0.0..=1e3, faults).unwrap_or(0.0),
        transmission: transmission.map(|table| self::transmission(table, mechanics_s, faults)),
    };
    table.finish(faults);
    axis
}

/// The two masses may turn by this angle against each other within a mechanics period, rad: beyond, the integration loses
/// the frequency by more than a percent.
const MOST_PHASE_RAD: f64 = 0.5;

fn transmission(mut table: Table<'_, '_>, mechanics_s: f64, faults: &mut Vec<Fault>) -> Transmission {
    let transmission = Transmission {
        table_share: table.number("table_share", "(no unit)", 0.01..=0.99, faults),
        resonance_hz: table.number("resonance_hz", "Hz", 0.1..=1e4, faults),
        damping_ratio: table.number("damping_ratio", "(no unit)", 0.0..=1.0, faults),
        backlash_um: table.number("backlash_um", "um", 0.0..=1e4, faults),
        scale_on_table: table
            .optional_number("scale_on_table", "(0 or 1)", 0.0..=1.0, faults)
            .is_some_and(|on| on > 0.5),
    };
    let free_rad_s = TAU * transmission.resonance_hz / (1.0 - transmission.table_share).sqrt();
    if free_rad_s * mechanics_s > MOST_PHASE_RAD {
        let finest = MOST_PHASE_RAD / free_rad_s;
        faults.push(Fault {
            at: table.place("resonance_hz"),
            label: "too fast for mechanics_s",
            message: format!(
                "resonance_hz is {} Hz, with which motor and table swing against each other at {:.0} Hz; mechanics_s of {mechanics_s} s cannot follow that",
                transmission.resonance_hz,
                free_rad_s / TAU
            ),
            hint: Some(format!("mechanics_s has to be {finest:.1e} s or less")),
        });
    }
    table.finish(faults);
    transmission
}

fn syntax_fault(error: &toml::de::Error, text: &str) -> Fault {
    let at = error.span().unwrap_or(0..0);
    let at = at.start.min(text.len())..at.end.min(text.len());
    Fault { at, label: "here", message: format!("not TOML: {}", error.message()), hint: None }
}
