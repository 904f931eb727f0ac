//! What the HAL lines build: signals with their pins, values of pins, loaded components, and the
//! order of functions.

use std::collections::BTreeMap;

use super::hal::{HalLine, HalPlace, HalScript};
use super::ini::number;

/// A `loadrt` line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct HalLoad {
    /// Name of the component, without folder.
    pub(crate) module: String,
    pub(crate) arguments: Vec<String>,
    pub(crate) place: HalPlace,
}

impl HalLoad {
    /// Names of its instances, where the line states them.
    fn names(&self) -> impl Iterator<Item = &str> {
        let lists = self
            .arguments
            .iter()
            .filter_map(|argument| argument.strip_prefix("names="));
        lists
            .flat_map(|names| names.split(','))
            .filter(|name| !name.is_empty())
    }

    /// Beginning of its pins' names where the line states no names.
    fn prefix(&self) -> String {
        if self.module == "mux_generic" {
            "mux-gen".to_owned()
        } else {
            self.module.replace('_', "-")
        }
    }
}

/// An `addf` line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct HalFunction {
    pub(crate) name: String,
    pub(crate) thread: String,
    /// Position in the thread; `None` is the end.
    pub(crate) position: Option<i32>,
    pub(crate) place: HalPlace,
}

/// The pins, signals, components and functions that the HAL lines create.
#[derive(Debug, Clone, Default)]
pub(crate) struct Netlist {
    /// Pins of each signal, in the order in which they are connected.
    signals: BTreeMap<String, Vec<String>>,
    /// The signal of each pin.
    of_pin: BTreeMap<String, String>,
    /// Last values that `setp` and `sets` set.
    values: BTreeMap<String, String>,
    pub(crate) loads: Vec<HalLoad>,
    pub(crate) functions: Vec<HalFunction>,
    /// Other names of pins.
    aliases: BTreeMap<String, String>,
    notes: Vec<String>,
}

/// Words between pins that state a direction only.
pub(crate) const ARROWS: [&str; 3] = ["=>", "<=", "<=>"];

impl Netlist {
    pub(crate) fn of(script: &HalScript) -> Self {
        let mut netlist = Self::default();
        for (place, line) in script.lines() {
            netlist.execute(place, line);
            let old = line.words.iter().find(|word| is_old_joint_pin(&word.text));
            if let Some(word) = old.filter(|_| line.word(0) != "loadusr") {
                netlist.notes.push(format!(
                    "{}: {} is a name of LinuxCNC before 2.8. Let LinuxCNC's update_ini convert the configuration first",
                    script.place(place),
                    word.text
                ));
            }
        }
        netlist
    }

    fn execute(&mut self, place: HalPlace, line: &HalLine) {
        let rest = || {
            line.words
                .iter()
                .skip(2)
                .map(|word| word.text.as_str())
                .filter(|word| !ARROWS.contains(word))
        };
        match line.word(0) {
            "net" => {
                self.signals.entry(line.word(1).to_owned()).or_default();
                rest().for_each(|pin| self.connect(pin, line.word(1)));
            }
            "linksp" => rest().for_each(|pin| self.connect(pin, line.word(1))),
            "linkps" => rest().for_each(|signal| self.connect(line.word(1), signal)),
            "linkpp" => {
                self.connect(line.word(1), line.word(1));
                rest().for_each(|pin| self.connect(pin, line.word(1)));
            }
            "unlinkp" => self.disconnect(line.word(1)),
            "delsig" => {
                for pin in self.signals.remove(line.word(1)).unwrap_or_default() {
                    self.of_pin.remove(&pin);
                }
            }
            "setp" | "sets" => {
                let name = self.pin(line.word(1));
                let value = if line.word(2) == "=" {
                    line.word(3)
                } else {
                    line.word(2)
                };
                self.values.insert(name, value.to_owned());
            }
            "alias" if line.word(1) == "pin" => {
                self.aliases
                    .insert(line.word(3).to_owned(), line.word(2).to_owned());
            }
            "loadrt" => {
                let module = line.word(1).rsplit('/').next().unwrap_or("").to_owned();
                self.loads.push(HalLoad {
                    module,
                    arguments: rest().map(str::to_owned).collect(),
                    place,
                });
            }
            "addf" => {
                let position = line.word(3).parse().ok();
                let (name, thread) = (line.word(1).to_owned(), line.word(2).to_owned());
                self.functions.push(HalFunction {
                    name,
                    thread,
                    position,
                    place,
                });
            }
            _ => {}
        }
    }

    /// The pin that a name means: its own, or the one that it is another name of.
    pub(crate) fn pin(&self, name: &str) -> String {
        self.aliases
            .get(name)
            .cloned()
            .unwrap_or_else(|| name.to_owned())
    }

    fn connect(&mut self, pin: &str, signal: &str) {
        let pin = self.pin(pin);
        if pin.is_empty() || signal.is_empty() || self.of_pin.contains_key(&pin) {
            return;
        }
        self.signals
            .entry(signal.to_owned())
            .or_default()
            .push(pin.clone());
        self.of_pin.insert(pin, signal.to_owned());
    }

    fn disconnect(&mut self, pin: &str) {
        let pin = self.pin(pin);
        if let Some(pins) = self
            .of_pin
            .remove(&pin)
            .and_then(|signal| self.signals.get_mut(&signal))
        {
            pins.retain(|other| *other != pin);
        }
    }

    /// The signal that a pin is connected to.
    pub(crate) fn signal_of(&self, pin: &str) -> Option<&str> {
        self.of_pin.get(pin).map(String::as_str)
    }

    /// All signals.
    pub(crate) fn signals(&self) -> impl Iterator<Item = &str> {
        self.signals.keys().map(String::as_str)
    }

    /// The pins of a signal.
    pub(crate) fn pins(&self, signal: &str) -> impl Iterator<Item = &str> {
        self.signals
            .get(signal)
            .into_iter()
            .flatten()
            .map(String::as_str)
    }

    /// The pins that are connected with a pin, without itself.
    pub(crate) fn beside<'a>(&'a self, pin: &'a str) -> impl Iterator<Item = &'a str> {
        let signal = self.signal_of(pin).unwrap_or("");
        self.pins(signal).filter(move |other| *other != pin)
    }

    /// All connected pins of an instance, such as `pid.0`.
    pub(crate) fn pins_of<'a>(&'a self, instance: &'a str) -> impl Iterator<Item = &'a str> {
        self.of_pin
            .keys()
            .map(String::as_str)
            .filter(move |pin| instance_of(pin) == instance)
    }

    /// Returns the value that a pin or signal was set to.
    pub(crate) fn value(&self, name: &str) -> Option<&str> {
        self.values.get(name).map(String::as_str)
    }

    /// Returns the value that a pin or signal was set to, as a number.
    pub(crate) fn number(&self, name: &str) -> Option<f64> {
        match self.value(name)? {
            "TRUE" | "True" | "true" => Some(1.0),
            "FALSE" | "False" | "false" => Some(0.0),
            value => number(value),
        }
    }

    /// The pins of an instance that were set.
    pub(crate) fn set_of<'a>(&'a self, instance: &'a str) -> impl Iterator<Item = &'a str> {
        self.values
            .keys()
            .map(String::as_str)
            .filter(move |pin| instance_of(pin) == instance)
    }

    /// The component that has a pin, by the names of its instances, or by its own name where it is
    /// loaded without names.
    pub(crate) fn module_of(&self, pin: &str) -> Option<&str> {
        let has = |name: &str| {
            pin.strip_prefix(name)
                .is_some_and(|rest| rest.starts_with('.'))
        };
        let is_named = |load: &&HalLoad| load.names().any(has);
        let is_counted = |load: &&HalLoad| load.names().next().is_none() && has(&load.prefix());
        let mut loads = self.loads.iter();
        let load = loads
            .find(is_named)
            .or_else(|| self.loads.iter().find(is_counted))?;
        Some(&load.module)
    }

    /// The line that loads a component.
    pub(crate) fn load(&self, module: &str) -> Option<&HalLoad> {
        self.loads.iter().find(|load| load.module == module)
    }

    /// The line that adds a function.
    pub(crate) fn function(&self, name: &str) -> Option<&HalFunction> {
        self.functions.iter().find(|function| function.name == name)
    }

    /// Returns the first remark on the HAL lines, if there is one.
    pub(crate) fn findings(&self) -> Vec<String> {
        self.notes.iter().take(1).cloned().collect()
    }
}

/// The instance of a pin: its name without the last part.
pub(crate) fn instance_of(pin: &str) -> &str {
    pin.rsplit_once('.').map_or(pin, |(instance, _)| instance)
}

/// The last part of a pin's name.
pub(crate) fn last_part(pin: &str) -> &str {
    pin.rsplit('.').next().unwrap_or(pin)
}

/// Returns true if a pin of a joint has its name from before LinuxCNC 2.8.
fn is_old_joint_pin(pin: &str) -> bool {
    let number = pin
        .strip_prefix("axis.")
        .and_then(|rest| rest.strip_suffix(".motor-pos-cmd"));
    number.is_some_and(|number| number.parse::<u8>().is_ok())
}
