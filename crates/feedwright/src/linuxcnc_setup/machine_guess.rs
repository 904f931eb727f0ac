//! The machine file that the configuration gives: limits and gains, each with its place, and what
//! is still unknown. It suffices to write the program of `feedwright excite`; the numbers of the
//! axes come from `feedwright identify`.

use std::fmt::Write as _;

use feedwright_control::position_gains_1_s;
use feedwright_sim::toml_file::quoted;
use feedwright_sim::{MACHINE_FORMAT, to_four_digits};

use super::ini::IniFile;
use super::joints::{JointValue, SetupJoint, SetupJoints};
use super::names::SetupNames;

/// Largest encoder step that a machine file has, um.
const MOST_STEP_UM: f64 = 1000.0;
/// Speeds and accelerations that a machine file can have, mm and s.
const SPEEDS_MM_S: [f64; 2] = [0.01, 1e4];
const ACCELERATIONS_MM_S2: [f64; 2] = [0.1, 1e6];

/// The text of the machine file.
pub(crate) fn machine_file(joints: &SetupJoints, ini: &IniFile, names: &SetupNames) -> String {
    let mut text = format!(
        "# What {} says of the machine: written by feedwright linuxcnc setup.\n\
         # Lengths are in mm{}. It is enough for feedwright excite. What no line of the INI file states comes from the machine\n\
         # 'workshop', and is unknown: lead, inertia, friction, gains of the speed loop, delays. feedwright identify finds what positions determine.\n\n\
         format = {MACHINE_FORMAT}\n\
         base = \"workshop\"\n\
         name = {}\n\
         description = {}\n\
         source = {}\n",
        names.original,
        if joints.unit_mm == 1.0 {
            ""
        } else {
            ", converted from inches"
        },
        quoted(&names.stem),
        quoted(&format!(
            "limits of {}, the rest is unknown",
            names.original
        )),
        quoted(&names.original),
    );
    let place = ini.entry("EMCMOT", "SERVO_PERIOD").map_or_else(
        || "LinuxCNC's default".to_owned(),
        |entry| entry.place.clone(),
    );
    let servo_s = joints.servo_s;
    let _ = writeln!(
        text,
        "\n[period]\nservo_s = {servo_s:?} # SERVO_PERIOD, {place}\nmechanics_s = {:?} # a tenth of it",
        servo_s / 10.0
    );
    limits(&mut text, joints);
    for (joint, name) in joints.wired().zip(["x", "y", "z"]) {
        axis(&mut text, joints, joint, name);
    }
    text
}

/// The limits of all axes: the smallest of each, so that a program keeps those of every joint.
fn limits(text: &mut String, joints: &SetupJoints) {
    let _ = writeln!(text, "\n[limits]");
    let mut line = |key: &str, from: &str, found: Option<&JointValue>| {
        let _ = match found {
            Some(JointValue { value, place }) => {
                writeln!(
                    text,
                    "{key} = {} # the smallest {from}, {place}",
                    to_four_digits(*value)
                )
            }
            None => writeln!(text, "# {key} is unknown: no joint has {from}"),
        };
    };
    let speed = joints.least_mm("MAX_VELOCITY", SPEEDS_MM_S);
    line("rapid_mm_s", "MAX_VELOCITY", speed.as_ref());
    line("max_feed_mm_s", "MAX_VELOCITY", speed.as_ref());
    let acceleration = joints.least_mm("MAX_ACCELERATION", ACCELERATIONS_MM_S2);
    line(
        "tangential_accel_mm_s2",
        "MAX_ACCELERATION",
        acceleration.as_ref(),
    );
    line(
        "normal_accel_mm_s2",
        "MAX_ACCELERATION",
        acceleration.as_ref(),
    );
    let _ = writeln!(
        text,
        "corner_jump_mm_s = 0 # LinuxCNC stops in exact stop mode\nmax_deviation_mm = 0.5 # assumed"
    );
}

/// Writes the known values of an axis; the base supplies the rest.
fn axis(text: &mut String, joints: &SetupJoints, joint: &SetupJoint, name: &str) {
    let _ = writeln!(text, "\n[axis.{name}] # joint {}", joint.number);
    if let Some(speed) = joints.program_mm(joint, "MAX_VELOCITY") {
        let value = speed.value.clamp(SPEEDS_MM_S[0], SPEEDS_MM_S[1]);
        let _ = writeln!(
            text,
            "max_velocity_mm_s = {} # MAX_VELOCITY, {}",
            to_four_digits(value),
            speed.place
        );
    }
    if let Some(acceleration) = joints.program_mm(joint, "MAX_ACCELERATION") {
        let value = acceleration
            .value
            .clamp(ACCELERATIONS_MM_S2[0], ACCELERATIONS_MM_S2[1]);
        let _ = writeln!(
            text,
            "max_accel_mm_s2 = {} # MAX_ACCELERATION, {}",
            to_four_digits(value),
            acceleration.place
        );
    }
    if joint.is_simulated() {
        let _ = writeln!(
            text,
            "# unknown: everything else, because there is no drive"
        );
        return;
    }
    gains(text, joints, joint);
    let scale = ["INPUT_SCALE", "ENCODER_SCALE", "SCALE"]
        .into_iter()
        .find_map(|key| Some((key, joints.value(joint, key)?)));
    if let Some((key, JointValue { value, place })) = scale.filter(|(_, scale)| scale.value != 0.0)
    {
        let step_um = 1e3 * joints.unit_mm / value.abs();
        if step_um <= MOST_STEP_UM && step_um > 0.0 {
            let counts = if key == "SCALE" {
                "if it counts the encoder"
            } else {
                "steps of the encoder"
            };
            let _ = writeln!(
                text,
                "encoder_step_um = {} # 1 / {key}, {place}: {counts}",
                to_four_digits(step_um)
            );
        }
    }
    if let Some(backlash) = joints
        .length_mm(joint, "BACKLASH")
        .filter(|backlash| backlash.value != 0.0)
    {
        let um = to_four_digits(1e3 * backlash.value);
        let _ = writeln!(
            text,
            "# BACKLASH, {}: LinuxCNC compensates {um} um in its command, so the model has none",
            backlash.place
        );
    }
    let _ = writeln!(
        text,
        "# unknown: lead, inertia, friction, gains of the speed loop, delays"
    );
}

/// P and feedforward of the `pid`, if they can be what a machine file means.
fn gains(text: &mut String, joints: &SetupJoints, joint: &SetupJoint) {
    let Some(gains) = &joint.gains else {
        let _ = writeln!(
            text,
            "# unknown: kp_1_s, velocity_feedforward; the position loop is in the drive"
        );
        return;
    };
    let place = |key: &str| {
        joints
            .value(joint, key)
            .map_or_else(|| "the HAL file".to_owned(), |found| found.place)
    };
    if !joint.commands_speed() {
        let _ = writeln!(
            text,
            "# unknown: kp_1_s, velocity_feedforward; the output of the pid may be in volts, so P and FF1 are no gain in 1/s and no part of 1"
        );
        return;
    }
    let [low, high] = position_gains_1_s(joints.servo_s);
    match gains.p {
        Some(p) if (low..=high).contains(&p) => {
            let _ = writeln!(text, "kp_1_s = {p:?} # P, {}", place("P"));
        }
        Some(p) => {
            let _ = writeln!(
                text,
                "# P = {p:?}, {}, is no position gain in 1/s: kp_1_s is unknown",
                place("P")
            );
        }
        None => {
            let _ = writeln!(text, "# unknown: kp_1_s; no P is set");
        }
    }
    if let Some(ff1) = gains.feedforward[1].filter(|ff1| (0.0..=2.0).contains(ff1)) {
        let _ = writeln!(
            text,
            "velocity_feedforward = {ff1:?} # FF1, {}",
            place("FF1")
        );
    }
    if let Some(ff2) = gains.feedforward[2].filter(|ff2| *ff2 != 0.0) {
        let _ = writeln!(
            text,
            "# FF2 = {ff2:?}, {}: output for a unit of acceleration; acceleration_feedforward is a part of J a",
            place("FF2")
        );
    }
}
