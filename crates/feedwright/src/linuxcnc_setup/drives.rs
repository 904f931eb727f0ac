//! What drives a joint and what measures it, by the names of the pins that are connected.

use std::collections::BTreeSet;

use super::components::{PinSide, hardware_behind, inputs_beside, is_planner, side, writer};
use super::netlist::{Netlist, instance_of, last_part};

/// Components between a joint and its hardware that are followed, at most.
const MOST_BETWEEN: usize = 40;

/// Device that receives the position command of a joint.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum DriveKind {
    /// A `pid` whose output is a speed or torque for an analog or PWM amplifier.
    PidAnalog { pid: String, output: String },
    /// A `pid` whose output is the speed of a step generator.
    PidStepgen { pid: String, stepgen: String },
    /// A step generator that takes positions.
    Stepgen { stepgen: String },
    /// A drive on EtherCAT.
    EtherCat { pin: String },
    /// Hardware that setup does not know.
    Other { pin: String },
    /// Components that only compute.
    Computed,
    /// Nothing.
    Nothing,
}

/// Source of the position of a joint.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum FeedbackKind {
    /// An encoder or another sensor.
    Measured { pin: String },
    /// A drive on EtherCAT reports it.
    FromDrive { pin: String },
    /// A step generator reports the steps that it has made.
    OwnSteps { pin: String },
    /// The command comes back.
    Loopback,
    /// HAL components compute it from the command.
    Simulated { pin: String },
    /// Unknown.
    Unknown { pin: String },
    /// Nothing.
    Nothing,
}

/// Parts of names of sensors.
const SENSORS: [&str; 8] = [
    "encoder", "enc-", "enc.", "resolver", "biss", "ssi.", "fanuc", "fabs",
];
/// Drivers of cards whose positions are those of encoders.
const CARDS: [&str; 9] = [
    "stg.",
    "vti.",
    "pluto-servo",
    "motenc",
    "ppmc",
    "gm.",
    "mv.",
    "8i20",
    "opto",
];
/// Finds the device that receives the position command of a joint.
pub(crate) fn drive_of(netlist: &Netlist, command_pin: &str) -> DriveKind {
    let sinks: Vec<&str> = netlist
        .beside(command_pin)
        .filter(|pin| last_part(pin) != "motor-pos-fb")
        .collect();
    if let Some(pid) = sinks
        .iter()
        .find(|pin| last_part(pin) == "command" && is_pid(netlist, instance_of(pin)))
    {
        let pid = instance_of(pid).to_owned();
        let output_pin = format!("{pid}.output");
        let outputs: Vec<&str> = netlist.beside(&output_pin).collect();
        if let Some(stepgen) = outputs
            .iter()
            .find(|pin| pin.contains("stepgen") && last_part(pin) == "velocity-cmd")
        {
            return DriveKind::PidStepgen {
                pid,
                stepgen: instance_of(stepgen).to_owned(),
            };
        }
        let output = outputs
            .first()
            .map_or_else(|| output_pin.clone(), |pin| (*pin).to_owned());
        return DriveKind::PidAnalog { pid, output };
    }
    if let Some(pin) = sinks
        .iter()
        .find(|pin| pin.contains("stepgen") && last_part(pin) == "position-cmd")
    {
        return DriveKind::Stepgen {
            stepgen: instance_of(pin).to_owned(),
        };
    }
    if let Some(pin) = sinks.iter().find(|pin| is_ethercat(pin)) {
        return DriveKind::EtherCat {
            pin: (*pin).to_owned(),
        };
    }
    match hardware_behind(netlist, command_pin) {
        Some(pin) => DriveKind::Other { pin },
        None if sinks.is_empty() => DriveKind::Nothing,
        None => DriveKind::Computed,
    }
}

fn is_pid(netlist: &Netlist, instance: &str) -> bool {
    let named = |load: &super::netlist::HalLoad| {
        let names = load
            .arguments
            .iter()
            .filter_map(|argument| argument.strip_prefix("names="));
        names
            .flat_map(|names| names.split(','))
            .any(|name| name == instance)
    };
    instance.starts_with("pid")
        || netlist
            .loads
            .iter()
            .any(|load| load.module == "pid" && named(load))
}

fn is_ethercat(pin: &str) -> bool {
    pin.starts_with("lcec") || pin.starts_with("cia402")
}

/// Finds the source of the position of a joint.
pub(crate) fn feedback_of(
    netlist: &Netlist,
    command_pin: &str,
    feedback_pin: &str,
) -> FeedbackKind {
    let Some(command) = netlist.signal_of(command_pin) else {
        return FeedbackKind::Nothing;
    };
    let Some(feedback) = netlist.signal_of(feedback_pin) else {
        return FeedbackKind::Nothing;
    };
    if command == feedback {
        return FeedbackKind::Loopback;
    }
    let mut trace = FeedbackTrace {
        netlist,
        command,
        seen: BTreeSet::new(),
        sources: Vec::new(),
        is_simulated: false,
    };
    trace.follow(feedback);
    let rank = |kind: &&FeedbackKind| match kind {
        FeedbackKind::OwnSteps { .. } => 1,
        FeedbackKind::Unknown { .. } => 2,
        _ => 0,
    };
    if let Some(kind) = trace.sources.iter().min_by_key(rank) {
        return kind.clone();
    }
    let other = writer(netlist, feedback).or_else(|| netlist.beside(feedback_pin).next());
    let pin = other.unwrap_or(feedback).to_owned();
    if trace.is_simulated {
        FeedbackKind::Simulated { pin }
    } else {
        FeedbackKind::Unknown { pin }
    }
}

/// Follows the feedback of a joint back to what makes it, through components that compute.
struct FeedbackTrace<'a> {
    netlist: &'a Netlist,
    /// The signal of the command.
    command: &'a str,
    seen: BTreeSet<String>,
    sources: Vec<FeedbackKind>,
    /// The command was reached.
    is_simulated: bool,
}

impl FeedbackTrace<'_> {
    fn follow(&mut self, signal: &str) {
        if signal == self.command {
            self.is_simulated = true;
            return;
        }
        if self.seen.len() > MOST_BETWEEN || !self.seen.insert(signal.to_owned()) {
            return;
        }
        let netlist = self.netlist;
        let unknown = || {
            netlist
                .pins(signal)
                .filter(|pin| side(netlist, pin) == PinSide::Hardware)
        };
        let Some(output) = writer(netlist, signal) else {
            let unknown_source = || {
                Some(FeedbackKind::Unknown {
                    pin: unknown().next()?.to_owned(),
                })
            };
            self.sources
                .extend(unknown().find_map(source).or_else(unknown_source));
            return;
        };
        if let Some(kind) = source(output) {
            self.sources.push(kind);
        } else if !is_planner(output) {
            for signal in inputs_beside(netlist, output).filter_map(|pin| netlist.signal_of(pin)) {
                self.follow(signal);
            }
        }
    }
}

/// Classifies the source of a position by the name of a pin; `None` if the name does not show it.
fn source(pin: &str) -> Option<FeedbackKind> {
    let (lower, last) = (pin.to_lowercase(), last_part(pin));
    let owned = pin.to_owned();
    if lower.contains("stepgen") {
        return Some(FeedbackKind::OwnSteps { pin: owned });
    }
    if is_ethercat(&lower) {
        return Some(FeedbackKind::FromDrive { pin: owned });
    }
    let is_position = last.contains("pos") || last.contains("count") || last.contains("angle");
    let is_sensor = SENSORS.iter().any(|name| lower.contains(name))
        || CARDS.iter().any(|name| lower.starts_with(name));
    (is_position && is_sensor).then_some(FeedbackKind::Measured { pin: owned })
}
