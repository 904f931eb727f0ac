//! The layout of a machine file: its tables, and what holds between their values.
use std::f64::consts::TAU;
use std::ops::Range;

use feedwright_control::{MAX_COMMAND_PERIODS, MAX_MECHANICS_PER_SERVO, position_gains_1_s};
use feedwright_plan::{Durations, PlcEvent};

use super::{
    AXIS_NAMES, Axis, MACHINE_FORMAT, Machine, Noise, Period, Squareness, Transmission, keys,
};
use crate::number::to_four_digits;
use crate::toml_file::key::{in_range, read, read_all};
use crate::toml_file::{Document, Fault, Table};

/// Relative distance from a whole number below which `servo_s / mechanics_s` counts as whole: a
/// hundred times the rounding of two decimal numbers and their quotient, far below any ratio that
/// is off by a digit.
const WHOLE_RATIO_TOLERANCE: f64 = 1e-12;

/// Refuses a file of another format, whatever else stands in it.
pub(super) fn of_this_format(document: &Document<'_>) -> Result<(), Vec<Fault>> {
    let Some(format) = document.get_ref().get("format") else {
        return Ok(());
    };
    let mut faults = Vec::new();
    let found = Table::root(document, None).whole("format", "", 1.0..=1e9, &mut faults);
    match found {
        Some(MACHINE_FORMAT) => return Ok(()),
        Some(found) => faults.push(Fault {
            at: format.span(),
            label: "of another version",
            message: format!(
                "the machine file is of format {found}; feedwright {} reads format {MACHINE_FORMAT}",
                env!("CARGO_PKG_VERSION")
            ),
            hint: Some("read it with the version of feedwright that wrote it, or a later one".to_owned()),
        }),
        None => {}
    }
    Err(faults)
}

/// The name of the machine that a file builds upon, where it does.
pub(super) fn base(document: &Document<'_>) -> Result<Option<String>, Vec<Fault>> {
    let mut faults = Vec::new();
    let name = document
        .get_ref()
        .contains_key("base")
        .then(|| Table::root(document, None).text("base", &mut faults));
    if faults.is_empty() {
        Ok(name)
    } else {
        Err(faults)
    }
}

/// The base builds upon this file.
pub(super) fn circular(document: &Document<'_>, base: &str) -> Fault {
    Fault {
        at: document
            .get_ref()
            .get("base")
            .map_or(0..0, toml::Spanned::span),
        label: "leads back to this file",
        message: format!("base: '{base}' builds upon this machine in turn"),
        hint: Some("name a machine that does not build upon this one".to_owned()),
    }
}

/// The machine that a file describes, upon a base without faults where it has one, or every fault
/// in it.
pub(super) fn machine(
    document: &Document<'_>,
    base: Option<&Document<'_>>,
) -> Result<Machine, Vec<Fault>> {
    let mut faults = Vec::new();
    let mut root = Table::root(document, base);
    if base.is_some() {
        root.text("base", &mut faults);
    }
    root.has("format");
    let period = period(root.table("period", &mut faults), &mut faults);
    let mut plc_events = Vec::new();
    let [name, description, source] =
        ["name", "description", "source"].map(|key| root.text(key, &mut faults));
    let limits = root.table("limits", &mut faults);
    let in_limits = limits.header();
    let machine = Machine {
        name,
        description,
        source,
        period,
        limits: read_all(keys::LIMITS, limits, &mut faults),
        plc: root
            .optional_table("plc", &mut faults)
            .map(|table| plc(table, &mut plc_events, &mut faults))
            .unwrap_or_default(),
        plc_events,
        axes: axes(root.table("axis", &mut faults), period, &mut faults),
        geometry: root
            .optional_table("geometry", &mut faults)
            .map_or(Squareness::default(), |table| {
                read_all(keys::GEOMETRY, table, &mut faults)
            }),
        noise: root
            .optional_table("noise", &mut faults)
            .map_or(Noise::default(), |table| {
                read_all(keys::NOISE, table, &mut faults)
            }),
        compensated: None,
        tool: None,
    };
    tolerance_with_axes(&machine, in_limits, &mut faults);
    root.finish(&mut faults);
    if faults.is_empty() {
        Ok(machine)
    } else {
        Err(faults)
    }
}

/// A tolerance of the path asks for a planner that needs the limits of each axis; these alone stand
/// there for what else uses them.
fn tolerance_with_axes(machine: &Machine, at: Range<usize>, faults: &mut Vec<Fault>) {
    let limited = machine
        .axes
        .iter()
        .all(|axis| axis.max_velocity_mm_s.is_some());
    if let (false, Some(tolerance_um)) = (limited, machine.limits.path_tolerance_um) {
        faults.push(Fault {
            at,
            label: "not without limits of the axes",
            message: format!(
                "path_tolerance_um is {tolerance_um} um, and the axes have no limits of their own"
            ),
            hint: Some(format!(
                "give each axis {}, or leave path_tolerance_um out",
                AXIS_LIMITS.join(", ")
            )),
        });
    }
}

/// The limits of an axis: all or none.
pub(super) const AXIS_LIMITS: [&str; 3] =
    ["max_velocity_mm_s", "max_accel_mm_s2", "max_jerk_mm_s3"];

fn period(mut table: Table<'_, '_>, faults: &mut Vec<Fault>) -> Period {
    let Period {
        servo_s,
        mechanics_s,
        ..
    } = read(keys::PERIOD, &mut table, faults);
    let ratio = servo_s / mechanics_s;
    // A value that has a fault of its own is NaN here and gets no second one.
    let is_whole = (ratio - ratio.round()).abs() <= WHOLE_RATIO_TOLERANCE * ratio;
    if ratio.is_finite() && (!is_whole || !(1.0..=MAX_MECHANICS_PER_SERVO).contains(&ratio.round()))
    {
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
    Period {
        servo_s,
        mechanics_s,
        mechanics_per_servo: ratio.round() as u32,
    }
}

fn plc(mut table: Table<'_, '_>, events: &mut Vec<PlcEvent>, faults: &mut Vec<Fault>) -> Durations {
    let durations = read(keys::PLC, &mut table, faults);
    if let Some(named) = table.optional_table("event", faults) {
        for (key, table) in named.tables(faults) {
            events.extend(plc_event(&key, table, events, faults));
        }
    }
    table.finish(faults);
    durations
}

fn plc_event(
    key: &str,
    mut table: Table<'_, '_>,
    before: &[PlcEvent],
    faults: &mut Vec<Fault>,
) -> Option<PlcEvent> {
    let event = m_code(key).map(|(code, p)| PlcEvent {
        code,
        p,
        row: table.text("row", faults),
        label: table.text("label", faults),
        takes_s: table.number("takes_s", "s", 0.0..=1e4, faults),
    });
    let at = table.header();
    let fault = |label, message, hint: &str| {
        faults.push(Fault {
            at,
            label,
            message,
            hint: Some(hint.to_owned()),
        });
    };
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
        Some(event)
            if before
                .iter()
                .any(|other| (other.code, other.p) == (event.code, event.p)) =>
        {
            fault(
                "named twice",
                format!("'{key}' is another spelling of an M-code that is named already"),
                "keep one",
            );
        }
        Some(_) => {}
    }
    table.finish(faults);
    event
}

/// M-codes whose meaning no machine builder changes: stops, spindle, tool change, coolant,
/// overrides, pallets, modes.
const CODES_OF_THEIR_OWN: [u16; 23] = [
    0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 30, 48, 49, 50, 51, 52, 53, 60, 70, 71, 72, 73, 99,
];

/// `M64 P3`: the code and its P word, blanks and case free.
fn m_code(key: &str) -> Option<(u16, Option<u32>)> {
    let key: String = key
        .chars()
        .filter(|c| !c.is_whitespace())
        .map(|c| c.to_ascii_uppercase())
        .collect();
    let words = key.strip_prefix('M')?;
    // `parse` alone would take a sign.
    let number = |digits: &str| {
        digits
            .bytes()
            .all(|byte| byte.is_ascii_digit())
            .then(|| digits.parse().ok())
            .flatten()
    };
    let (code, p) = match words.split_once('P') {
        Some((code, p)) => (number(code)?, Some(number(p)?)),
        None => (number(words)?, None),
    };
    u16::try_from(code)
        .ok()
        .filter(|&code| code <= LAST_M_CODE)
        .map(|code| (code, p))
}

/// Largest M-code; the reader of programs has the same limit.
const LAST_M_CODE: u16 = 9999;

fn axes(mut table: Table<'_, '_>, period: Period, faults: &mut Vec<Fault>) -> Vec<Axis> {
    let [x, y, z] = AXIS_NAMES;
    let mut axes: Vec<Axis> = [x, y]
        .into_iter()
        .map(|name| axis(table.table(name, faults), period, faults))
        .collect();
    if let Some(present) = table.optional_table(z, faults) {
        axes.push(axis(present, period, faults));
    }
    let limited = axes
        .iter()
        .position(|axis| axis.max_velocity_mm_s.is_some());
    let unlimited = axes
        .iter()
        .position(|axis| axis.max_velocity_mm_s.is_none());
    if let (Some(limited), Some(unlimited)) = (limited, unlimited)
        && axes
            .iter()
            .all(|axis| axis.max_velocity_mm_s.is_some() == axis.max_jerk_mm_s3.is_some())
    {
        let [has, lacks] = [limited, unlimited].map(|i| AXIS_NAMES[i]);
        faults.push(Fault {
            at: table.header(),
            label: "some axes with limits, some without",
            message: format!(
                "axis.{has} has limits of its own, and axis.{lacks} lacks {}",
                AXIS_LIMITS.join(", ")
            ),
            hint: Some("a planner that plans axis by axis needs those of every axis".to_owned()),
        });
    }
    table.finish(faults);
    axes
}

fn axis(mut table: Table<'_, '_>, period: Period, faults: &mut Vec<Fault>) -> Axis {
    let transmission = table.optional_table("transmission", faults);
    let mut axis: Axis = read(keys::AXIS, &mut table, faults);
    axis.transmission =
        transmission.map(|table| self::transmission(table, period.mechanics_s, faults));
    between_values(&axis, &period, &|key| table.place(key), faults);
    table.finish(faults);
    axis
}

/// Place of a key in the text of a file.
type Places<'p> = &'p dyn Fn(&str) -> Range<usize>;

/// Checks what holds between the values of an axis beside the range of each.
fn between_values(axis: &Axis, period: &Period, at: Places<'_>, faults: &mut Vec<Fault>) {
    friction_within_step(axis, period.mechanics_s, at, faults);
    position_gain(axis.kp_1_s, period.servo_s, at, faults);
    between_keys(axis, period, at, faults);
}

/// Returns the faults of the axes of a machine that was made of values. The periods and the limits
/// of all axes together are not checked.
pub(super) fn faults_of_axes(machine: &Machine) -> Vec<Fault> {
    let mut faults = Vec::new();
    let period = &machine.period;
    for axis in &machine.axes {
        in_range(keys::AXIS, axis, &mut faults);
        if let Some(screw) = &axis.transmission {
            in_range(keys::TRANSMISSION, screw, &mut faults);
            screw_within_step(screw, period.mechanics_s, &|_| 0..0, &mut faults);
        }
        between_values(axis, period, &|_| 0..0, &mut faults);
    }
    faults
}

/// Largest part of its speed that viscous friction may take from a mass in a mechanics period.
/// Beyond, the explicit step of the integration turns the speed around, and from 2 on it grows
/// without bound.
const MAX_FRICTION_STEP: f64 = 1.0;

/// Refuses viscous friction B of a mass J that a step dt of the mechanics cannot follow: B dt / J.
fn friction_within_step(axis: &Axis, mechanics_s: f64, at: Places<'_>, faults: &mut Vec<Fault>) {
    // Friction acts on the table, where the screw gives.
    let mass_kg_m2 = axis.inertia_kg_m2 * axis.transmission.map_or(1.0, |screw| screw.table_share);
    let friction_nm_s = axis.viscous_friction_nm_s;
    let fades_s = mass_kg_m2 / friction_nm_s;
    if mechanics_s > MAX_FRICTION_STEP * fades_s {
        let most_nm_s = MAX_FRICTION_STEP * mass_kg_m2 / mechanics_s;
        faults.push(Fault {
            at: at("viscous_friction_nm_s"),
            label: "too stiff for mechanics_s",
            message: format!(
                "mechanics_s of {mechanics_s} s is too long for viscous_friction_nm_s of {friction_nm_s} N m s/rad and an inertia \
                 of {mass_kg_m2} kg m2: the speed fades within {} s",
                to_four_digits(fades_s)
            ),
            hint: Some(format!(
                "mechanics_s has to be {} s or less, or the friction {} N m s/rad or less",
                to_four_digits(MAX_FRICTION_STEP * fades_s),
                to_four_digits(most_nm_s)
            )),
        });
    }
}

/// Refuses a position gain that no position loop with this servo period has. A value with a fault
/// of its own is NaN here.
fn position_gain(kp_1_s: f64, servo_s: f64, at: Places<'_>, faults: &mut Vec<Fault>) {
    let [least, most] = position_gains_1_s(servo_s);
    if kp_1_s < least || kp_1_s > most {
        faults.push(Fault {
            at: at("kp_1_s"),
            label: "no gain of a position loop",
            message: format!(
                "kp_1_s is {kp_1_s} 1/s; with servo_s of {servo_s} s a position loop has {least} to {} 1/s",
                to_four_digits(most)
            ),
            hint: Some(
                "a gain in 1/ms times 1000 is in 1/s; the P of a controller whose output is in volts is no position gain; if it was identified, \
                 check columns and units of the log"
                    .to_owned(),
            ),
        });
    }
}

/// Longest delay, in servo periods: what is under way is kept.
const MAX_DELAY_PERIODS: f64 = 60.0;

/// An axis has all of its limits or none.
fn all_limits(axis: &Axis, at: Places<'_>, faults: &mut Vec<Fault>) {
    let limits = [
        axis.max_velocity_mm_s,
        axis.max_accel_mm_s2,
        axis.max_jerk_mm_s3,
    ];
    let those = |there: bool| {
        let named = AXIS_LIMITS
            .iter()
            .zip(limits)
            .filter(move |(_, limit)| limit.is_some() == there);
        named.map(|(name, _)| *name).collect::<Vec<_>>()
    };
    if let ([first, ..], [_, ..]) = (&those(true)[..], &those(false)[..]) {
        faults.push(Fault {
            at: at(first),
            label: "not without the others",
            message: format!(
                "{} given, {} missing: an axis has all three or none",
                those(true).join(", "),
                those(false).join(", ")
            ),
            hint: Some("a limit that no planner could keep is not dropped silently".to_owned()),
        });
    }
}

/// Checks the conditions between the values of an axis.
fn between_keys(axis: &Axis, period: &Period, at: Places<'_>, faults: &mut Vec<Fault>) {
    for [(key, amount), (needed, over)] in axis.needs() {
        if amount > 0.0 && over == 0.0 {
            faults.push(Fault {
                at: at(key),
                label: "says how much, but not over what",
                message: format!("{key} is {amount}, and {needed} is 0 or not there"),
                hint: Some(format!("give {needed} above 0, or leave {key} out")),
            });
        }
    }
    all_limits(axis, at, faults);
    let (asymmetry_nm, coulomb_nm) = (axis.coulomb_asymmetry_nm, axis.coulomb_friction_nm);
    if asymmetry_nm.abs() > coulomb_nm {
        faults.push(Fault {
            at: at("coulomb_asymmetry_nm"),
            label: "friction would drive",
            message: format!(
                "coulomb_asymmetry_nm is {asymmetry_nm} N m; it must lie within the Coulomb friction, {coulomb_nm} N m each way"
            ),
            hint: Some("it is half the difference of the friction torques of both directions".to_owned()),
        });
    }
    for (delay_s, key, most_periods) in [
        (
            axis.command_delay_s,
            "command_delay_s",
            MAX_COMMAND_PERIODS as f64,
        ),
        (axis.drive_delay_s, "drive_delay_s", MAX_DELAY_PERIODS),
        (
            axis.measurement_delay_s,
            "measurement_delay_s",
            MAX_DELAY_PERIODS,
        ),
    ] {
        let most_s = most_periods * period.servo_s;
        // Rounding of decimal numbers is let pass.
        if delay_s > (1.0 + WHOLE_RATIO_TOLERANCE) * most_s {
            faults.push(Fault {
                at: at(key),
                label: "too many servo periods",
                message: format!(
                    "{key} is {delay_s} s; with servo_s of {} s it must be {most_s} s or less",
                    period.servo_s
                ),
                hint: None,
            });
        }
    }
    if axis.jitter_s > period.servo_s {
        faults.push(Fault {
            at: at("jitter_s"),
            label: "longer than servo_s",
            message: format!(
                "jitter_s is {} s; it must lie within a servo period, {} s",
                axis.jitter_s, period.servo_s
            ),
            hint: Some("what all references are late by is drive_delay_s".to_owned()),
        });
    }
}

/// The two masses may turn by this angle against each other within a mechanics period, rad: beyond,
/// the integration loses the frequency by more than a percent.
const MAX_PHASE_RAD: f64 = 0.5;

fn transmission(
    mut table: Table<'_, '_>,
    mechanics_s: f64,
    faults: &mut Vec<Fault>,
) -> Transmission {
    let transmission: Transmission = read(keys::TRANSMISSION, &mut table, faults);
    screw_within_step(&transmission, mechanics_s, &|key| table.place(key), faults);
    table.finish(faults);
    transmission
}

/// Refuses a screw whose masses swing faster than a step of the mechanics can follow.
fn screw_within_step(
    transmission: &Transmission,
    mechanics_s: f64,
    at: Places<'_>,
    faults: &mut Vec<Fault>,
) {
    let free_rad_s = TAU * transmission.resonance_hz / (1.0 - transmission.table_share).sqrt();
    if free_rad_s * mechanics_s > MAX_PHASE_RAD {
        let finest = MAX_PHASE_RAD / free_rad_s;
        faults.push(Fault {
            at: at("resonance_hz"),
            label: "too fast for mechanics_s",
            message: format!(
                "resonance_hz is {} Hz, with which motor and table swing against each other at {:.0} Hz; mechanics_s of {mechanics_s} s cannot follow that",
                transmission.resonance_hz,
                free_rad_s / TAU
            ),
            hint: Some(format!("mechanics_s has to be {finest:.1e} s or less")),
        });
    }
}
