//! Limits of LinuxCNC, of step generators and of drives that the correction needs.
//!
//! ```text
//! T = (1 - FF1) / P                       lag of a drive whose position loop gives a speed, s
//! E = a T (T + D)                         still behind where the command has just stopped: it braked at a for T, and is seen D later
//! FERROR     = the given one, or 2 v T, or v T + 1.1 E, whichever is largest
//! MIN_FERROR = 1.1 E / (1 - v T / FERROR)
//! ```
//!
//! LinuxCNC allows `FERROR u / v` at a speed u, and MIN_FERROR at least. A drive that brakes at u
//! is `u T + E` behind. The two are equal at `u = v MIN_FERROR / FERROR`, which gives MIN_FERROR. D
//! is the longest delay of the component; 1.1 is the margin. On the simulated tnv40, whose needs
//! docs/linuxcnc.md states under *Following errors*, this is 2.6 mm where 2.0 are needed. When
//! LinuxCNC starts with a model, the component computes the need by that model and says so where
//! MIN_FERROR is less.

use std::collections::BTreeMap;

use feedwright_control::position_gains_1_s;
use feedwright_sim::{Machine, to_four_digits};

use super::drives::DriveKind;
use super::joints::{SetupJoint, SetupJoints};

/// Longest delay of the component, s.
const DELAY_S: f64 = 0.015;
/// Margin of following errors.
const MARGIN: f64 = 1.1;
/// Shortest lag that is reckoned with, s: delays that FF1 does not take out.
const LEAST_LAG_S: f64 = 0.002;
/// FF1 from which on a drive counts as one with feedforward.
const FEEDFORWARD: f64 = 0.9;
/// Acceleration of the corrected command as a multiple of LinuxCNC's acceleration: with
/// feedforward, and without.
const ACCELERATIONS: [f64; 2] = [4.0, 40.0];
/// Room between HOME and a limit of travel for a position that is measured, mm: a pid leaves less
/// when it is at rest.
const HOME_ROOM_MM: f64 = 0.1;
/// Highest speed of the corrected command as a multiple of MAX_VELOCITY.
const SPEEDS: f64 = 1.4;

/// Following errors that a joint needs, in the unit of the configuration.
#[derive(Debug, Clone, PartialEq)]
struct NeededFerror {
    joint: usize,
    ferror: f64,
    min_ferror: f64,
    /// FERROR and MIN_FERROR as they are.
    given: [Option<f64>; 2],
    unit: &'static str,
}

/// Returns the following errors that the joints need where their lag is known: from their `pid`, or
/// from the machine that stands in for them. `raised` is the following error that the copy allows.
fn needed(
    joints: &SetupJoints,
    simulated: Option<&Machine>,
    raised: Option<f64>,
) -> Vec<NeededFerror> {
    let of = |(joint, axis): (&SetupJoint, Option<&feedwright_sim::Axis>)| {
        let lag_s = lag_s(joints, joint, axis)?;
        let [(_, speed), (_, acceleration)] = [
            joints.planned(joint, "MAX_VELOCITY")?,
            joints.planned(joint, "MAX_ACCELERATION")?,
        ];
        let raised = raised.filter(|_| !joint.is_rotary);
        let given = ["FERROR", "MIN_FERROR"].map(|key| {
            let given = joints.value(joint, key).map(|found| found.value);
            raised
                .map(|raised| given.map_or(raised, |given| given.max(raised)))
                .or(given)
        });
        // Rounded up to a hundredth of a millimeter, and a thousandth of an inch.
        let digit = if joints.unit_mm == 1.0 { 100.0 } else { 1000.0 };
        let up = |value: f64| (digit * value).ceil() / digit;
        let (lag, behind) = (
            speed * lag_s,
            MARGIN * acceleration * lag_s * (lag_s + DELAY_S),
        );
        let ferror = up((2.0 * lag).max(lag + behind)).max(given[0].unwrap_or(0.0));
        let min_ferror = up(behind / (1.0 - lag / ferror)).max(given[1].unwrap_or(0.0));
        let unit = if joint.is_rotary {
            "degrees"
        } else {
            joints.unit_name()
        };
        Some(NeededFerror {
            joint: joint.number,
            ferror,
            min_ferror,
            given,
            unit,
        })
    };
    let axis = |axis: usize| simulated.and_then(|machine| machine.axes.get(axis));
    let corrected = joints
        .wired()
        .enumerate()
        .map(|(number, joint)| (joint, axis(number)));
    // What passes through is delayed as well. Nothing stands in for its drives.
    let passing = joints
        .passing()
        .filter(|_| simulated.is_none())
        .map(|(joint, _)| (joint, None));
    corrected
        .chain(passing)
        .filter_map(of)
        .filter(NeededFerror::is_more)
        .collect()
}

impl NeededFerror {
    /// Returns true if the configuration allows less than the joint needs.
    fn is_more(&self) -> bool {
        let [ferror, min_ferror] = self.given;
        ferror.is_none_or(|given| given < self.ferror)
            || min_ferror.is_none_or(|given| given < self.min_ferror)
    }
}

/// A value of the copy.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct IniValue {
    pub(crate) section: String,
    pub(crate) key: &'static str,
    pub(crate) value: f64,
}

/// Returns the values that replace those of the original in the copy. `raised` is the following
/// error that the user names.
pub(crate) fn written(joints: &SetupJoints, simulates: bool, raised: Option<f64>) -> Vec<IniValue> {
    let mut values: Vec<IniValue> = raised
        .map(|value| ferrors(joints, value))
        .unwrap_or_default();
    if simulates {
        values.extend(travels(joints));
    }
    values
}

/// FERROR and MIN_FERROR of linear joints that go through the component, where they are below a
/// value.
fn ferrors(joints: &SetupJoints, value: f64) -> Vec<IniValue> {
    let through = joints
        .wired()
        .chain(joints.passing().map(|(joint, _)| joint))
        .filter(|joint| !joint.is_rotary);
    let of = |joint: &SetupJoint| {
        let [section, _] = joints.sections(joint);
        ["FERROR", "MIN_FERROR"].map(|key| IniValue {
            section: section.clone(),
            key,
            value,
        })
    };
    let is_lower = |new: &IniValue| {
        joints
            .number(new.section.clone(), new.key)
            .is_none_or(|given| given.value < value)
    };
    through.flat_map(of).filter(is_lower).collect()
}

/// Limits of travel that the copy moves, of corrected joints and of second motors.
fn travels(joints: &SetupJoints) -> impl Iterator<Item = IniValue> {
    joints
        .with_correction()
        .flat_map(|joint| travel(joints, joint))
}

/// Describes the changed limits of travel, one line for each value.
fn travel_words(joints: &SetupJoints) -> Vec<String> {
    let mut sections: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for IniValue {
        section,
        key,
        value,
    } in travels(joints)
    {
        let named = sections
            .entry(format!(
                "{key} = {} {}",
                to_four_digits(value),
                joints.unit_name()
            ))
            .or_default();
        if !named.contains(&format!("[{section}]")) {
            named.push(format!("[{section}]"));
        }
    }
    let line = |(value, sections): (String, Vec<String>)| {
        let sections = sections.join(", ");
        format!(
            "the copy has {value} in {sections}: HOME lies on that limit, and a measured position is beyond it now and then"
        )
    };
    sections.into_iter().map(line).collect()
}

/// Limits of travel on which HOME lies. A position that is its own command is exactly there; one
/// that is measured is beyond now and then, and LinuxCNC stops.
fn travel(joints: &SetupJoints, joint: &SetupJoint) -> Vec<IniValue> {
    let home = joints.value(joint, "HOME").map_or(0.0, |home| home.value);
    let room = HOME_ROOM_MM / joints.unit_mm;
    let of = |section: String| {
        [("MIN_LIMIT", -1.0), ("MAX_LIMIT", 1.0)]
            .into_iter()
            .filter_map(move |(key, sign)| {
                let limit = joints.number(section.clone(), key)?.value;
                (sign * (limit - home) < room).then(|| IniValue {
                    section: section.clone(),
                    key,
                    value: home + sign * room,
                })
            })
    };
    joints.sections(joint).into_iter().flat_map(of).collect()
}

/// The lag of a drive, s, if it is known: by the machine that stands in for it, or by a `pid` whose
/// output is a speed.
fn lag_s(
    joints: &SetupJoints,
    joint: &SetupJoint,
    simulated: Option<&feedwright_sim::Axis>,
) -> Option<f64> {
    let [p, ff1] = match (simulated, &joint.gains) {
        (Some(axis), _) => [axis.kp_1_s, axis.velocity_feedforward],
        (None, Some(gains)) if joint.commands_speed() => {
            [gains.p?, gains.feedforward[1].unwrap_or(0.0)]
        }
        _ => return None,
    };
    let [least, most] = position_gains_1_s(joints.servo_s);
    (least..=most)
        .contains(&p)
        .then(|| ((1.0 - ff1) / p).max(LEAST_LAG_S))
}

/// Describes the values that must change. `raised` is the following error that the copy already
/// allows.
pub(crate) fn changes(
    joints: &SetupJoints,
    simulated: Option<&Machine>,
    raised: Option<f64>,
) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for NeededFerror {
        joint,
        ferror,
        min_ferror,
        given,
        unit,
    } in needed(joints, simulated, raised)
    {
        let now = given.map(|given| given.map_or("LinuxCNC's default".to_owned(), to_four_digits));
        lines.push(format!(
            "[JOINT_{joint}] set FERROR = {ferror} and MIN_FERROR = {min_ferror} {unit} (now {} and {}): the delayed drive is farther behind",
            now[0], now[1]
        ));
    }
    match raised {
        Some(value) => lines.extend(raised_words(joints, value)),
        None if !lines.is_empty() => lines.push(
            "--raise-ferror VALUE writes a value of yours for both into the copy. A drive that fails moves so far before LinuxCNC stops it"
                .to_owned(),
        ),
        None => {}
    }
    if simulated.is_some() {
        lines.extend(travel_words(joints));
    }
    if joints
        .wired()
        .any(|joint| lag_s(joints, joint, None).is_none())
        && simulated.is_none()
    {
        lines.push(
            "FERROR and MIN_FERROR: how far these drives are behind is not known before they are identified. When LinuxCNC starts with the model, \
             the component names the MIN_FERROR that is needed"
                .to_owned(),
        );
    }
    lines.extend(
        joints
            .with_correction()
            .filter_map(|joint| of_stepgen(joints, joint)),
    );
    let has_drives = |joint: &SetupJoint| {
        matches!(
            joint.drive,
            DriveKind::EtherCat { .. } | DriveKind::Stepgen { .. }
        )
    };
    if simulated.is_none() && joints.wired().any(has_drives) {
        lines.push(
            "in the drives: raise the following error window by a quarter, and switch off ramps and smoothing of the position command, because the \
             correction moves it"
                .to_owned(),
        );
    }
    lines
}

/// Lists the sections of the copy that allow the following error `value`, which the user names.
fn raised_words(joints: &SetupJoints, value: f64) -> Option<String> {
    let mut sections: Vec<String> = ferrors(joints, value)
        .into_iter()
        .map(|IniValue { section, .. }| format!("[{section}]"))
        .collect();
    sections.dedup();
    let unit = joints.unit_name();
    (!sections.is_empty()).then(|| {
        format!(
            "the copy allows a following error of {value} {unit} in {}: --raise-ferror raises FERROR and MIN_FERROR to it",
            sections.join(", ")
        )
    })
}

fn of_stepgen(joints: &SetupJoints, joint: &SetupJoint) -> Option<String> {
    let (DriveKind::Stepgen { stepgen } | DriveKind::PidStepgen { stepgen, .. }) = &joint.drive
    else {
        return None;
    };
    let speed = SPEEDS * joints.planned(joint, "MAX_VELOCITY")?.1;
    let has_feedforward = joint
        .gains
        .as_ref()
        .is_some_and(|gains| gains.feedforward[1] >= Some(FEEDFORWARD));
    let times = ACCELERATIONS[usize::from(!has_feedforward)];
    let acceleration = times * joints.planned(joint, "MAX_ACCELERATION")?.1;
    let [maxvel, maxaccel] = joint.stepgen_limits;
    // Zero is without limit.
    let low = |given: Option<f64>, need: f64| given.filter(|given| *given > 0.0 && *given < need);
    let mut words = Vec::new();
    if let Some(given) = low(maxvel, speed) {
        words.push(format!(
            "maxvel {} or more (now {})",
            to_four_digits(speed),
            to_four_digits(given)
        ));
    }
    if let Some(given) = low(maxaccel, acceleration) {
        words.push(format!(
            "maxaccel {} or more, or 0 for no limit (now {})",
            to_four_digits(acceleration),
            to_four_digits(given)
        ));
    }
    (!words.is_empty()).then(|| {
        format!(
            "{stepgen} needs {}: the correction moves its command faster than LinuxCNC does",
            words.join(" and ")
        )
    })
}
