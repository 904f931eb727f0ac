//! What `--simulate` disconnects in the copy: every pin of hardware that setup does not know, from
//! every signal that LinuxCNC or a component that computes writes. The pin then keeps the value
//! that it has when its driver is loaded. Where the signal is not zero while the machine is off, as
//! behind a `not`, the copy sets the pin to that value.

use std::collections::BTreeMap;

use super::components::{PinSide, at_rest, side, writer};
use super::hal::HalScript;
use super::ini::{IniEntry, IniFile};
use super::netlist::{Netlist, instance_of, last_part};

/// A pin that the copy disconnects.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CutPin {
    pub(crate) pin: String,
    /// The pin that writes its signal.
    pub(crate) writer: String,
    /// Value of the signal while the machine is off; `None` if it is unknown.
    pub(crate) at_rest: Option<f64>,
}

/// All pins to disconnect.
pub(crate) fn cut_pins(netlist: &Netlist) -> Vec<CutPin> {
    let mut cut = Vec::new();
    for signal in netlist.signals() {
        let Some(writer) = writer(netlist, signal) else {
            continue;
        };
        let at_rest = at_rest(netlist, writer, 0);
        let hardware = netlist
            .pins(signal)
            .filter(|pin| side(netlist, pin) == PinSide::Hardware);
        cut.extend(hardware.map(|pin| CutPin {
            pin: pin.to_owned(),
            writer: writer.to_owned(),
            at_rest,
        }));
    }
    cut.sort_by(|a, b| a.pin.cmp(&b.pin));
    cut
}

/// Describes the disconnected pins, one line for each part of the hardware.
pub(crate) fn cut_words(cut: &[CutPin]) -> Vec<String> {
    let mut lines: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for CutPin {
        pin,
        writer,
        at_rest,
    } in cut
    {
        let set = at_rest
            .filter(|value| *value != 0.0)
            .map_or(String::new(), |value| format!(", set to {value}"));
        lines
            .entry(instance_of(pin))
            .or_default()
            .push(format!("{} (from {writer}{set})", last_part(pin)));
    }
    lines
        .into_iter()
        .map(|(instance, pins)| format!("{instance}: {}", pins.join(", ")))
        .collect()
}

/// Returns the reasons why the hardware cannot be disconnected.
pub(crate) fn refusals(ini: &IniFile, script: &HalScript, cut: &[CutPin]) -> Vec<String> {
    let unclear = cut.iter().filter(|cut| cut.at_rest.is_none()).map(|CutPin { pin, writer, .. }| {
        format!(
            "--simulate cannot disconnect {pin}: setup does not know which value {writer} has while the machine is off, and the device may be on \
             at zero. Take {pin} out of its net in a copy of the configuration, and set it there to the value that switches the device off"
        )
    });
    let unread = |what: &str, place: &str| {
        format!(
            "--simulate cannot disconnect the hardware: {place}: setup does not read {what}. Put its commands into a HAL file"
        )
    };
    let in_ini = ini
        .entries
        .iter()
        .filter(|entry| entry.section == "HAL")
        .filter_map(
            |IniEntry {
                 key, value, place, ..
             }| {
                let first = value.split_whitespace().next().unwrap_or("");
                let what = match key.as_str() {
                    "HALCMD" | "POSTGUI_HALCMD" if !["setp", "sets"].contains(&first) => key,
                    "POSTGUI_HALFILE" if first.to_lowercase().ends_with(".tcl") => value,
                    _ => return None,
                };
                Some(unread(what, place))
            },
        );
    let halcmd = script
        .lines()
        .filter(|(_, line)| line.word(0) == "loadusr")
        .filter_map(|(place, line)| {
            let mut programs = line
                .words
                .iter()
                .map(|word| word.text.rsplit('/').next().unwrap_or(""));
            let program = programs.find(|name| ["halcmd", "haltcl", "halrun"].contains(name))?;
            Some(unread(
                &format!("what {program} does"),
                &script.place(place),
            ))
        });
    unclear.chain(in_ini).chain(halcmd).collect()
}
