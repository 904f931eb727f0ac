//! The joints of a configuration: which axis each is, what drives and measures it, its limits, and
//! whether it can be corrected.

use feedwright_gcode::INCH_MM;

use super::drives::{DriveKind, FeedbackKind, drive_of, feedback_of};
use super::ini::{IniEntry, IniFile, number};
use super::netlist::Netlist;

/// Servo period where the INI file states none, s: LinuxCNC's own.
const SERVO_S: f64 = 1e-3;
/// Most joints of LinuxCNC.
const MOST_JOINTS: usize = 16;
/// Letters of joints where the kinematics names none.
const LETTERS: &str = "XYZABCUVW";
/// The letter of a joint that belongs to no axis.
const NO_AXIS: char = '?';
/// Joints that pass through the component at the most.
const MOST_PASSING: usize = 6;

/// Parameters of a `pid`, as they are set.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct PidGains {
    pub(crate) p: Option<f64>,
    /// FF0 to FF3.
    pub(crate) feedforward: [Option<f64>; 4],
}

/// Role of a joint in the component.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum JointRole {
    /// Corrects it, as this axis.
    Corrected(usize),
    /// Delays it, and gives it the correction of this axis: the second motor of a gantry.
    Second(usize),
    /// Delays it: a rotary or parallel axis.
    Passes,
    /// Leaves it as it is: no axis of a program moves it.
    Stays,
}

/// A joint.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SetupJoint {
    pub(crate) number: usize,
    pub(crate) letter: char,
    pub(crate) is_rotary: bool,
    pub(crate) drive: DriveKind,
    pub(crate) feedback: FeedbackKind,
    pub(crate) gains: Option<PidGains>,
    /// `maxvel` and `maxaccel` of a step generator that takes positions.
    pub(crate) stepgen_limits: [Option<f64>; 2],
}

/// Value from the INI file, in mm where it contains a length.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct JointValue {
    pub(crate) value: f64,
    /// File and line.
    pub(crate) place: String,
}

/// All joints.
#[derive(Debug, Clone)]
pub(crate) struct SetupJoints {
    pub(crate) joints: Vec<SetupJoint>,
    /// Name of the kinematics.
    pub(crate) kinematics: String,
    /// mm in one unit of length of the configuration.
    pub(crate) unit_mm: f64,
    pub(crate) servo_s: f64,
    ini: IniFile,
}

impl SetupJoints {
    pub(crate) fn of(ini: &IniFile, netlist: &Netlist) -> Self {
        let kinematics = ini
            .value("KINS", "KINEMATICS")
            .unwrap_or("trivkins")
            .to_owned();
        let stated = ini
            .number("KINS", "JOINTS")
            .filter(|count| (1.0..=MOST_JOINTS as f64).contains(count));
        let mut words = kinematics.split_whitespace();
        let name = words.next().unwrap_or("").to_owned();
        let coordinates = words
            .find_map(|word| word.strip_prefix("coordinates="))
            .unwrap_or(LETTERS);
        let letters: Vec<char> = coordinates
            .chars()
            .filter(char::is_ascii_alphabetic)
            .collect();
        let count = stated.map_or(letters.len().min(3), |count| count as usize);
        let joint = |number: usize| {
            let letter = letters
                .get(number)
                .map_or(NO_AXIS, char::to_ascii_uppercase);
            SetupJoint::of(ini, netlist, number, letter)
        };
        let unit_mm = match ini
            .value("TRAJ", "LINEAR_UNITS")
            .unwrap_or("mm")
            .to_lowercase()
            .as_str()
        {
            "inch" | "in" | "imperial" => INCH_MM,
            _ => 1.0,
        };
        let servo_s = ini
            .number("EMCMOT", "SERVO_PERIOD")
            .filter(|ns| *ns > 0.0)
            .map_or(SERVO_S, |ns| ns / 1e9);
        Self {
            joints: (0..count).map(joint).collect(),
            kinematics: name,
            unit_mm,
            servo_s,
            ini: ini.clone(),
        }
    }

    /// The joints that the component corrects, in the order X, Y, Z.
    pub(crate) fn wired(&self) -> impl Iterator<Item = &SetupJoint> {
        let first = |letter: char| {
            self.joints
                .iter()
                .find(|joint| joint.letter == letter && !joint.is_rotary)
        };
        ['X', 'Y', 'Z'].into_iter().filter_map(first)
    }

    /// The joints that pass through the component, and the axis whose correction they get.
    pub(crate) fn passing(&self) -> impl Iterator<Item = (&SetupJoint, Option<usize>)> {
        self.joints
            .iter()
            .filter_map(|joint| match self.role(joint) {
                JointRole::Second(axis) => Some((joint, Some(axis))),
                JointRole::Passes => Some((joint, None)),
                JointRole::Corrected(_) | JointRole::Stays => None,
            })
    }

    /// The joints that get a correction: those that the component corrects, and the second motors
    /// of their axes.
    pub(crate) fn with_correction(&self) -> impl Iterator<Item = &SetupJoint> {
        self.wired().chain(
            self.passing()
                .filter_map(|(joint, axis)| axis.map(|_| joint)),
        )
    }

    /// Returns the role of the joint in the component.
    pub(crate) fn role(&self, joint: &SetupJoint) -> JointRole {
        let axis = self.wired().position(|wired| wired.letter == joint.letter);
        match axis.filter(|_| !joint.is_rotary) {
            Some(axis)
                if self
                    .wired()
                    .nth(axis)
                    .is_some_and(|wired| wired.number == joint.number) =>
            {
                JointRole::Corrected(axis)
            }
            Some(axis) => JointRole::Second(axis),
            None if joint.letter == NO_AXIS => JointRole::Stays,
            None => JointRole::Passes,
        }
    }

    /// A number of a joint's section, and where it stands.
    pub(crate) fn value(&self, joint: &SetupJoint, key: &str) -> Option<JointValue> {
        self.number(joint.section(), key)
    }

    /// Returns a limit of a joint in a program, and its section. LinuxCNC plans programs by the
    /// section of the axis, and jogs of a joint by the section of the joint. The larger limit
    /// counts.
    pub(crate) fn planned(&self, joint: &SetupJoint, key: &str) -> Option<(String, f64)> {
        let values = self
            .sections(joint)
            .into_iter()
            .filter_map(|section| Some((section.clone(), self.number(section, key)?.value)));
        values.reduce(|joint, axis| if axis.1 > joint.1 { axis } else { joint })
    }

    /// The sections of a joint and of its axis.
    pub(crate) fn sections(&self, joint: &SetupJoint) -> [String; 2] {
        [joint.section(), format!("AXIS_{}", joint.letter)]
    }

    /// A number of a section, and where it stands.
    pub(crate) fn number(&self, section: String, key: &str) -> Option<JointValue> {
        let IniEntry { value, place, .. } = self.ini.entry(&section, key)?;
        Some(JointValue {
            value: number(value)?,
            place: place.clone(),
        })
    }

    /// A limit of a joint in programs, in mm: of its axis, or of the joint where that states none.
    pub(crate) fn program_mm(&self, joint: &SetupJoint, key: &str) -> Option<JointValue> {
        let sections = self.sections(joint).into_iter().rev();
        let found = sections
            .filter_map(|section| self.number(section, key))
            .find(|found| found.value > 0.0);
        found.map(|JointValue { value, place }| JointValue {
            value: value * self.unit_mm,
            place,
        })
    }

    /// The smallest of all joints that a program moves, within a range, in mm.
    pub(crate) fn least_mm(&self, key: &str, [low, high]: [f64; 2]) -> Option<JointValue> {
        let values = self.wired().filter_map(|joint| self.program_mm(joint, key));
        let least = values.min_by(|a, b| a.value.total_cmp(&b.value))?;
        Some(JointValue {
            value: least.value.clamp(low, high),
            place: least.place,
        })
    }

    /// A number of a joint's section, a length, a speed or an acceleration, in mm.
    pub(crate) fn length_mm(&self, joint: &SetupJoint, key: &str) -> Option<JointValue> {
        let JointValue { value, place } = self.value(joint, key)?;
        Some(JointValue {
            value: value * self.unit_mm,
            place,
        })
    }

    /// Unit of length of the configuration.
    pub(crate) fn unit_name(&self) -> &'static str {
        if self.unit_mm == 1.0 { "mm" } else { "inch" }
    }

    /// Describes the configuration and each joint, one line for each.
    pub(crate) fn findings(&self) -> Vec<String> {
        let mut lines = vec![format!(
            "{} joints, kinematics {}, lengths in {}, a servo period of {} ms",
            self.joints.len(),
            self.kinematics,
            self.unit_name(),
            1e3 * self.servo_s
        )];
        lines.extend(self.joints.iter().map(|joint| {
            let kind = if joint.is_rotary { "rotary" } else { "linear" };
            let (number, letter) = (joint.number, joint.letter);
            format!(
                "joint {number} ({letter}, {kind}): {}, {}. {}",
                joint.drive_words(),
                joint.feedback_words(),
                joint.verdict(self.role(joint))
            )
        }));
        lines
    }

    /// Describes what LinuxCNC itself compensates for the wired joints: the geometry of a model
    /// must not contain it, too.
    pub(crate) fn compensated(&self) -> Vec<String> {
        let of = |joint: &SetupJoint| {
            let section = joint.section();
            let file = self
                .ini
                .entry(&section, "COMP_FILE")
                .filter(|entry| !entry.value.is_empty());
            let screw = file.map(|IniEntry { value, place, .. }| {
                format!(
                    "joint {} ({}): LinuxCNC compensates the screw by COMP_FILE = {value} ({place}). What is in a geometry as well is compensated \
                     twice. Make the model file with 'feedwright block --no-geometry', or take COMP_FILE out: 'feedwright identify --geometry' reads \
                     that file",
                    joint.number, joint.letter
                )
            });
            let gap = self.number(section, "BACKLASH").filter(|found| found.value != 0.0).map(|JointValue { value, place }| {
                format!(
                    "joint {} ({}): LinuxCNC compensates a BACKLASH of {value} {} ({place}). It stays in force: the component compensates none. \
                     Where the position is measured on the table, take it out",
                    joint.number,
                    joint.letter,
                    self.unit_name()
                )
            });
            [screw, gap].into_iter().flatten()
        };
        self.wired().flat_map(of).collect()
    }

    /// Returns the reasons why the joints cannot be wired.
    pub(crate) fn refusals(&self, simulates: bool) -> Vec<String> {
        let mut refusals = self.structure();
        if !refusals.is_empty() {
            return refusals;
        }
        if !simulates && self.wired().any(SetupJoint::is_simulated) {
            refusals.push(
                "no position is measured: it is the command itself, or computed from it, so there is nothing to correct. To try the correction, \
                 let a simulated machine stand in for the drives: --simulate tnv40"
                    .to_owned(),
            );
        }
        let passing = || self.passing().map(|(joint, _)| joint);
        if simulates && !self.wired().chain(passing()).all(SetupJoint::is_replaced) {
            refusals
                .push("--simulate is for a configuration without drives: leave it out, this one has drives".to_owned());
        }
        refusals.extend(self.wired().filter_map(|joint| joint.refusal(simulates)));
        refusals.extend(passing().filter_map(SetupJoint::unconnected));
        refusals
    }

    /// Returns the reasons why these joints do not fit the component.
    fn structure(&self) -> Vec<String> {
        let mut refusals = Vec::new();
        if self.kinematics != "trivkins" {
            refusals.push(format!(
                "the kinematics is {}: joints are not axes. The component corrects axes, so it needs trivkins",
                self.kinematics
            ));
            return refusals;
        }
        let passing = self.passing().count();
        if passing > MOST_PASSING {
            refusals.push(format!(
                "{passing} joints would have to pass through the component, delayed as X, Y and Z are. It has room for {MOST_PASSING}. Leave out \
                 of [KINS]KINEMATICS what no program moves"
            ));
        }
        let has = |letter: char| self.wired().any(|joint| joint.letter == letter);
        if refusals.is_empty() && !(has('X') && has('Y')) {
            refusals.push(
                "there is no X or no Y: a lathe or a single axis. feedwright's machine files have X and Y, so this machine cannot be identified \
                 and corrected"
                    .to_owned(),
            );
        }
        refusals
    }
}

impl SetupJoint {
    fn of(ini: &IniFile, netlist: &Netlist, number: usize, letter: char) -> Self {
        let section = format!("JOINT_{number}");
        let is_rotary = ini
            .value(&section, "TYPE")
            .map_or("ABC".contains(letter), |kind| {
                kind.to_uppercase() == "ANGULAR"
            });
        let (command, feedback) = (
            format!("joint.{number}.motor-pos-cmd"),
            format!("joint.{number}.motor-pos-fb"),
        );
        let drive = drive_of(netlist, &command);
        let feedback = feedback_of(netlist, &command, &feedback);
        let value = |name: String| netlist.number(&name);
        let gains = match &drive {
            DriveKind::PidAnalog { pid, .. } | DriveKind::PidStepgen { pid, .. } => {
                Some(PidGains {
                    p: value(format!("{pid}.Pgain")),
                    feedforward: std::array::from_fn(|i| value(format!("{pid}.FF{i}"))),
                })
            }
            _ => None,
        };
        let stepgen_limits = match &drive {
            DriveKind::Stepgen { stepgen } | DriveKind::PidStepgen { stepgen, .. } => {
                ["maxvel", "maxaccel"].map(|name| value(format!("{stepgen}.{name}")))
            }
            _ => [None; 2],
        };
        Self {
            number,
            letter,
            is_rotary,
            drive,
            feedback,
            gains,
            stepgen_limits,
        }
    }

    fn section(&self) -> String {
        format!("JOINT_{}", self.number)
    }

    /// Returns true if there are no drives behind the joint.
    pub(crate) fn is_simulated(&self) -> bool {
        matches!(
            self.feedback,
            FeedbackKind::Loopback | FeedbackKind::Simulated { .. }
        )
    }

    /// Returns true if the output of its `pid` is a speed in the unit of the configuration, so that
    /// P is in 1/s and FF1 is a fraction of 1. The input of a step generator is a speed by
    /// definition. No file states how an amplifier converts its input, such as volts.
    pub(crate) fn commands_speed(&self) -> bool {
        matches!(self.drive, DriveKind::PidStepgen { .. })
    }

    /// Returns true if a simulated machine can stand in for the hardware behind the joint.
    fn is_replaced(&self) -> bool {
        self.is_simulated()
            || matches!(
                self.feedback,
                FeedbackKind::Unknown { .. } | FeedbackKind::Nothing
            )
    }

    fn drive_words(&self) -> String {
        match &self.drive {
            DriveKind::PidAnalog { pid, output } => {
                format!("{pid}{} drives {output}", self.gain_words())
            }
            DriveKind::PidStepgen { pid, stepgen } => {
                format!(
                    "{pid}{} drives the step generator {stepgen} by speed",
                    self.gain_words()
                )
            }
            DriveKind::Stepgen { stepgen } => {
                format!("the step generator {stepgen} takes positions")
            }
            DriveKind::EtherCat { pin } => format!("an EtherCAT drive takes positions at {pin}"),
            DriveKind::Other { pin } => format!("{pin} takes the position"),
            DriveKind::Computed => "no drive".to_owned(),
            DriveKind::Nothing => "no drive is connected".to_owned(),
        }
    }

    /// P and feedforward, as far as they are set.
    fn gain_words(&self) -> String {
        let Some(gains) = &self.gains else {
            return String::new();
        };
        let named = [("P", gains.p)].into_iter().chain(
            ["FF0", "FF1", "FF2", "FF3"]
                .into_iter()
                .zip(gains.feedforward),
        );
        let words: Vec<String> = named
            .filter_map(|(name, value)| Some(format!("{name} {}", value.filter(|v| *v != 0.0)?)))
            .collect();
        if words.is_empty() {
            String::new()
        } else {
            format!(" ({})", words.join(", "))
        }
    }

    fn feedback_words(&self) -> String {
        match &self.feedback {
            FeedbackKind::Measured { pin } => format!("{pin} measures it"),
            FeedbackKind::FromDrive { pin } => format!("the drive reports its position at {pin}"),
            FeedbackKind::OwnSteps { pin } => format!("{pin} reports the steps that were sent"),
            FeedbackKind::Loopback => "the command is its own feedback".to_owned(),
            FeedbackKind::Simulated { pin } => {
                format!("{pin} computes its position from the command")
            }
            FeedbackKind::Unknown { pin } => format!("its position comes from {pin}"),
            FeedbackKind::Nothing => "no position comes back".to_owned(),
        }
    }

    /// Describes in a few words whether the joint can be corrected.
    fn verdict(&self, role: JointRole) -> &'static str {
        match role {
            JointRole::Corrected(_) => {}
            JointRole::Second(_) => {
                return "The second motor of its axis: it gets the delay and the correction of the first";
            }
            JointRole::Passes => return "It passes through: it gets the delay, and no correction",
            JointRole::Stays => return "No axis of a program: it stays as it is",
        }
        match &self.feedback {
            FeedbackKind::Measured { .. } | FeedbackKind::FromDrive { .. } => "It can be corrected",
            FeedbackKind::OwnSteps { .. } => "There is nothing real to correct",
            FeedbackKind::Loopback | FeedbackKind::Simulated { .. } => "It is simulated",
            FeedbackKind::Unknown { .. } => "Setup does not know what this is",
            FeedbackKind::Nothing => "It is not connected",
        }
    }

    /// Returns the reason why the joint cannot be corrected, and the remedy.
    fn refusal(&self, simulates: bool) -> Option<String> {
        let number = self.number;
        match &self.feedback {
            FeedbackKind::OwnSteps { pin } => Some(format!(
                "joint {number}: {pin} reports the steps that were sent, not where the machine is. A correction by it would correct nothing \
                 real. Connect an encoder of motor or table to joint.{number}.motor-pos-fb"
            )),
            FeedbackKind::Unknown { pin } if !simulates => Some(format!(
                "joint {number}: setup does not know whether {pin} is a measured position. If it is, wire by hand as docs/linuxcnc.md says. To \
                 try the correction without the drives, let a simulated machine stand in for them: --simulate tnv40"
            )),
            _ => self.unconnected(),
        }
    }

    /// Returns the message that the joint is not connected, with the remedy.
    fn unconnected(&self) -> Option<String> {
        let number = self.number;
        (self.feedback == FeedbackKind::Nothing).then(|| {
            format!(
                "joint {number}: joint.{number}.motor-pos-cmd or joint.{number}.motor-pos-fb is connected to nothing in the HAL files. \
                 Connect both, or name the HAL file that does"
            )
        })
    }
}
