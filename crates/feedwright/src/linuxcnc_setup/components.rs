//! Components of LinuxCNC that compute, and reach nothing outside the computer. Setup follows a
//! signal through these only. Every other component is hardware that setup does not know: a name
//! says nothing about what a pin moves.
//!
//! Names and directions of pins are those that `halcmd show pin` lists in LinuxCNC 2.9.

use super::netlist::{Netlist, instance_of, last_part};

/// Role of a pin on its signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PinSide {
    /// LinuxCNC or a component that computes writes it.
    Writes,
    /// LinuxCNC, a component that computes or a screen reads it.
    Reads,
    /// The pin of hardware; its direction is not known.
    Hardware,
}

/// Value of an output while LinuxCNC commands and enables nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum AtRest {
    /// Zero where the inputs are zero.
    Zero,
    And,
    Or,
    Not,
    /// It depends on more than the inputs.
    Unclear,
}

/// Components that compute, beginnings of their outputs' names (or ends, behind `*`), and the value
/// of these outputs at rest.
#[rustfmt::skip]
const COMPUTING: &[(&[&str], &[&str], AtRest)] = &[
    // Arithmetic, limits, filters, choices and conversions.
    (&["abs", "abs_s32", "biquad", "blend", "ddt", "deadzone", "hypot", "ilowpass", "integ", "limit1", "limit2", "limit3", "lowpass", "mult2",
       "mux2", "mux4", "mux8", "mux16", "mux_generic", "offset", "scale", "sum2", "conv_bit_float", "conv_bit_s32", "conv_bit_u32",
       "conv_float_s32", "conv_float_u32", "conv_s32_bit", "conv_s32_float", "conv_s32_u32", "conv_u32_bit", "conv_u32_float",
       "conv_u32_s32"], &["out", "fb-out", "is-", "sign"], AtRest::Zero),
    (&["minmax"], &["max", "min"], AtRest::Zero),
    (&["corexy_by_hal"], &["alpha-cmd", "beta-cmd", "j0-motor-pos-fb", "j1-motor-pos-fb"], AtRest::Zero),
    (&["constant", "div2", "feedcomp", "invert", "lincurve"], &["out"], AtRest::Unclear),
    // Control loops and profiles.
    (&["pid"], &["output", "error", "saturated"], AtRest::Zero),
    (&["gearchange"], &["speed-out", "dir-out"], AtRest::Zero),
    (&["simple_tp"], &["active", "current-"], AtRest::Zero),
    // Gates, comparisons and memories.
    (&["and2"], &["out"], AtRest::And),
    (&["or2"], &["out"], AtRest::Or),
    (&["not"], &["out"], AtRest::Not),
    (&["bitslice", "bitwise", "comp", "edge", "flipflop", "lut5", "maj3", "match8", "near", "oneshot", "select8", "toggle", "tristate_bit",
       "tristate_float", "wcomp", "xor2"], &["out", "equal", "over", "under", "time-left"], AtRest::Unclear),
    (&["logic"], &["and", "or", "xor", "nand", "nor"], AtRest::Unclear),
    (&["updown"], &["count"], AtRest::Unclear),
    (&["demux"], &["out-"], AtRest::Unclear),
    // Delays, and signs of life that stop with what they watch.
    (&["charge_pump", "dbounce", "debounce", "timedelay"], &["out", "elapsed"], AtRest::Zero),
    (&["tof", "ton", "tp"], &["q", "et"], AtRest::Zero),
    (&["estop_latch"], &["ok-out", "watchdog"], AtRest::Zero),
    (&["estop_latch"], &["fault-out"], AtRest::Unclear),
    (&["watchdog"], &["ok-out"], AtRest::Zero),
    // Pulses and counts in software: what they move stands behind pins of a driver.
    (&["stepgen"], &["step", "dir", "up", "down", "phase-", "position-fb", "counts"], AtRest::Zero),
    (&["pwmgen"], &["pwm", "dir", "up", "down", "curr-dc"], AtRest::Zero),
    (&["encoder"], &["position", "velocity", "counts", "rawcounts"], AtRest::Zero),
    (&["siggen"], &["sine", "cosine", "square", "sawtooth", "triangle", "clock"], AtRest::Unclear),
    // Simulated devices.
    (&["sim_encoder"], &["phase-"], AtRest::Zero),
    (&["sim_spindle"], &["position-fb"], AtRest::Zero),
    (&["sim_home_switch"], &["home-sw", "index-enable"], AtRest::Unclear),
    (&["sim_axis_hardware"], &["*out", "*-all"], AtRest::Unclear),
    // Components that show or record.
    (&["histobins", "message", "sampler"], &[], AtRest::Zero),
];

/// Programs that only show and ask.
const SCREENS: &[&str] = &[
    "axisui",
    "gladevcp",
    "gmoccapy",
    "gscreen",
    "hal_manualtoolchange",
    "pyvcp",
    "qtdragon",
    "qtvcp",
    "touchy",
];

/// Pins of joints, axes, spindles, motion and iocontrol that LinuxCNC reads.
const INPUTS: &[&str] = &[
    "adaptive-feed",
    "amp-fault-in",
    "at-speed",
    "emc-enable-in",
    "enable",
    "eoffset-clear",
    "eoffset-counts",
    "eoffset-enable",
    "eoffset-scale",
    "feed-hold",
    "feed-inhibit",
    "home-sw-in",
    "homing-inhibit",
    "inhibit",
    "is-oriented",
    "is-unlocked",
    "jog-accel-fraction",
    "jog-counts",
    "jog-enable",
    "jog-inhibit",
    "jog-scale",
    "jog-stop",
    "jog-stop-immediate",
    "jog-vel-mode",
    "lube_level",
    "motor-pos-fb",
    "neg-lim-sw-in",
    "orient-fault",
    "pos-lim-sw-in",
    "posthome-cmd",
    "probe-input",
    "revs",
    "speed-in",
    "tool-changed",
    "tool-prepared",
    "toolchanger-fault",
];
/// Beginnings of the last parts of `halui` pins that LinuxCNC writes.
const HALUI_OUTPUTS: [&str; 9] = [
    "is-",
    "has-",
    "on-hard-",
    "on-soft-",
    "override-limits",
    "runs-",
    "brake-is-on",
    "value",
    "pos-",
];
/// Last parts of pins of LinuxCNC that are true while it commands nothing.
const TRUE_AT_REST: [&str; 4] = ["brake", "brake-is-on", "is-activated", "is-off"];

/// Returns true if the pin belongs to LinuxCNC itself.
pub(crate) fn is_planner(pin: &str) -> bool {
    [
        "joint.",
        "axis.",
        "motion.",
        "spindle.",
        "halui.",
        "iocontrol.",
        "ini.",
    ]
    .iter()
    .any(|name| pin.starts_with(name))
}

/// Returns the role of a pin on its signal.
pub(crate) fn side(netlist: &Netlist, pin: &str) -> PinSide {
    let last = last_part(pin);
    let writes = if is_planner(pin) {
        match pin.split('.').next() {
            Some("halui") => HALUI_OUTPUTS.iter().any(|name| last.starts_with(name)),
            Some("ini") => false,
            _ => {
                !INPUTS.contains(&last)
                    && !last.starts_with("digital-in-")
                    && !last.starts_with("analog-in-")
            }
        }
    } else if let Some(module) = computing(netlist, pin) {
        output_at_rest(module, last).is_some()
    } else if SCREENS.iter().any(|name| {
        pin.strip_prefix(name)
            .is_some_and(|rest| rest.starts_with('.'))
    }) {
        false
    } else {
        return PinSide::Hardware;
    };
    if writes {
        PinSide::Writes
    } else {
        PinSide::Reads
    }
}

/// The component that computes a pin, if it is one.
fn computing<'a>(netlist: &'a Netlist, pin: &str) -> Option<&'a str> {
    let module = netlist.module_of(pin)?;
    COMPUTING
        .iter()
        .any(|(modules, ..)| modules.contains(&module))
        .then_some(module)
}

/// Value of an output at rest; `None` if the pin is not an output.
fn output_at_rest(module: &str, last: &str) -> Option<AtRest> {
    let is_named = |name: &&'static str| match name.strip_prefix('*') {
        Some(end) => last.ends_with(end),
        None => last.starts_with(*name),
    };
    let row = COMPUTING
        .iter()
        .find(|(modules, outputs, _)| modules.contains(&module) && outputs.iter().any(is_named));
    row.map(|&(.., at_rest)| at_rest)
}

/// The pin that writes a signal; none where it is the pin of hardware, or nothing writes it.
pub(crate) fn writer<'a>(netlist: &'a Netlist, signal: &'a str) -> Option<&'a str> {
    netlist
        .pins(signal)
        .find(|pin| side(netlist, pin) == PinSide::Writes)
}

/// The connected inputs of the component that has a pin.
pub(crate) fn inputs_beside<'a>(
    netlist: &'a Netlist,
    pin: &'a str,
) -> impl Iterator<Item = &'a str> {
    netlist
        .pins_of(instance_of(pin))
        .filter(|other| side(netlist, other) == PinSide::Reads)
}

/// The first hardware that the signal of a pin reaches.
pub(crate) fn hardware_behind(netlist: &Netlist, pin: &str) -> Option<String> {
    let mut signals = vec![netlist.signal_of(pin)?];
    let mut at = 0;
    while let Some(&signal) = signals.get(at) {
        at += 1;
        for reader in netlist.pins(signal).filter(|other| *other != pin) {
            match side(netlist, reader) {
                PinSide::Hardware => return Some(reader.to_owned()),
                PinSide::Reads if !is_planner(reader) => {
                    let outputs = netlist
                        .pins_of(instance_of(reader))
                        .filter(|other| side(netlist, other) == PinSide::Writes);
                    let behind = outputs.filter_map(|output| netlist.signal_of(output));
                    let new: Vec<&str> =
                        behind.filter(|signal| !signals.contains(signal)).collect();
                    signals.extend(new);
                }
                PinSide::Reads | PinSide::Writes => {}
            }
        }
    }
    None
}

/// Components in a row that a value at rest is followed through, at most.
const MOST_IN_A_ROW: usize = 12;

/// Returns the value of an output while LinuxCNC commands and enables nothing; `None` if it is
/// unknown.
pub(crate) fn at_rest(netlist: &Netlist, output: &str, depth: usize) -> Option<f64> {
    if is_planner(output) {
        return Some(f64::from(u8::from(
            TRUE_AT_REST.contains(&last_part(output)),
        )));
    }
    let module = computing(netlist, output).filter(|_| depth < MOST_IN_A_ROW)?;
    let instance = instance_of(output);
    let input = |name: &str| {
        let pin = format!("{instance}.{name}");
        match netlist.signal_of(&pin) {
            Some(signal) => match writer(netlist, signal) {
                Some(before) => at_rest(netlist, before, depth + 1),
                None if netlist
                    .pins(signal)
                    .any(|other| side(netlist, other) == PinSide::Hardware) =>
                {
                    None
                }
                None => Some(netlist.number(signal).unwrap_or(0.0)),
            },
            None => Some(netlist.number(&pin).unwrap_or(0.0)),
        }
    };
    let truth = |name: &str| input(name).map(|value| value != 0.0);
    let truth = match output_at_rest(module, last_part(output))? {
        AtRest::Not => truth("in").map(|value| !value),
        AtRest::And => match [truth("in0"), truth("in1")] {
            [Some(false), _] | [_, Some(false)] => Some(false),
            [first, second] => Some(first? && second?),
        },
        AtRest::Or => match [truth("in0"), truth("in1")] {
            [Some(true), _] | [_, Some(true)] => Some(true),
            [first, second] => Some(first? || second?),
        },
        AtRest::Zero => {
            let names = inputs_beside(netlist, output)
                .chain(netlist.set_of(instance))
                .map(last_part);
            let counts = |name: &&str| {
                name.starts_with("in") && *name != "index-enable"
                    || ["offset", "bias"].contains(name)
            };
            names
                .filter(counts)
                .all(|name| input(name) == Some(0.0))
                .then_some(false)
        }
        AtRest::Unclear => None,
    };
    truth.map(|truth| f64::from(u8::from(truth)))
}
