//! The changed copies of HAL files, and the file that connects the component.
//!
//! ```text
//! joint.N.motor-pos-cmd      -> feedwright.drive-I     the old signal now has the command of the drive: delayed and corrected
//! joint.N.motor-pos-fb       -> feedwright.actual-I
//! pid.*.command-deriv        -> not connected          the pid differentiates its own, corrected command
//! joint.N.vel-cmd, else      -> ddt of the drive's command
//! spindle.0.at-speed         -> feedwright.at-speed    and the component goes on to spindle.0.at-speed
//! motion.feed-inhibit        -> an or2 with feedwright.feed-inhibit
//! ```
//!
//! Every other line stays as it is.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use super::disconnect::{self, CutPin};
use super::error::LinuxcncSetupError;
use super::hal::{HalLine, HalPlace, HalScript, HalWord, NamedBy};
use super::ini::IniFile;
use super::joints::{SetupJoint, SetupJoints};
use super::line_edit::{HalLineEdit, edited};
use super::names::SetupNames;
use super::netlist::{HalFunction, Netlist, last_part};
use super::steps::SAMPLED;

/// The HAL files that setup writes.
#[derive(Debug, Clone, Default)]
pub(crate) struct WiredHal {
    /// Name and text of each changed copy.
    pub(crate) copies: Vec<(String, String)>,
    /// The file that connects the component.
    pub(crate) hal: String,
    /// Entries of the INI file, by their number, that name a copy now.
    pub(crate) renamed: Vec<(usize, String)>,
}

/// The function behind which the component runs.
const CONTROLLER: &str = "motion-controller";
/// Commands whose pins are replaced.
const WITH_PINS: [&str; 6] = ["net", "linksp", "linkps", "linkpp", "setp", "unlinkp"];

/// Returns the reasons why the HAL files have no place for the component.
pub(crate) fn refusals(ini: &IniFile, netlist: &Netlist) -> Vec<String> {
    let mut refusals = Vec::new();
    if ini
        .entries
        .iter()
        .any(|entry| entry.section == "FEEDWRIGHT")
        || netlist.load("feedwright").is_some()
    {
        refusals.push(
            "feedwright is in this configuration already: give setup the original INI file, not the copy".to_owned(),
        );
    }
    if motion(ini, netlist).is_none() {
        refusals.push(
            "no HAL file loads the motion controller (loadrt [EMCMOT]EMCMOT): name the HAL file that does as a HALFILE"
                .to_owned(),
        );
    }
    if netlist.function(CONTROLLER).is_none() {
        refusals.push("no HAL file adds the function motion-controller to a thread (addf): name the HAL file that does as a HALFILE".to_owned());
    }
    if netlist.load("sampler").is_some() {
        refusals.push(
            "the component sampler is loaded already, and setup needs it for the record: take it out of the HAL files"
                .to_owned(),
        );
    }
    refusals
}

/// The line that loads the motion controller.
fn motion(ini: &IniFile, netlist: &Netlist) -> Option<HalPlace> {
    let name = ini
        .value("EMCMOT", "EMCMOT")
        .and_then(|value| value.split_whitespace().next())
        .unwrap_or("motmod");
    let name = name.rsplit('/').next().unwrap_or(name);
    netlist
        .load(name)
        .or_else(|| netlist.load("motmod"))
        .map(|load| load.place)
}

/// Wires the component into a configuration that nothing refuses.
pub(crate) fn wire(
    ini: &IniFile,
    script: &HalScript,
    netlist: &Netlist,
    joints: &SetupJoints,
    names: &SetupNames,
    simulates: bool,
) -> Result<WiredHal, LinuxcncSetupError> {
    let (Some(load), Some(function)) = (motion(ini, netlist), netlist.function(CONTROLLER)) else {
        let message = "there is no place for the component".to_owned();
        let hint = "load the motion controller in a HAL file".to_owned();
        return Err(LinuxcncSetupError::Line {
            place: names.original.clone(),
            message,
            hint,
        });
    };
    let mut edits = HalEdits {
        script,
        netlist,
        load,
        lines: BTreeMap::new(),
        new: BTreeMap::new(),
        added: String::new(),
    };
    let passages = passages(joints);
    if simulates {
        disconnect::cut_pins(netlist)
            .iter()
            .for_each(|cut| edits.disconnect(cut));
    }
    for passage in &passages {
        edits.joint(passage, simulates);
    }
    edits.after(load, &loads(joints, simulates));
    let mut functions = vec!["feedwright".to_owned(), "sampler.0".to_owned()];
    functions.extend(simulates.then(|| "feedwright-plant".to_owned()));
    for passage in &passages {
        functions.extend(edits.velocity(passage, function));
    }
    edits.functions(function, &functions);
    let hal = edits.connections(&passages, names, function, simulates);
    let (copies, renamed) = edits.finish(names);
    Ok(WiredHal {
        copies,
        hal,
        renamed,
    })
}

/// Connections of one joint through the component.
struct Passage<'a> {
    joint: &'a SetupJoint,
    /// Its position among all nets of the component.
    net: usize,
    /// Beginning of its pins' names, and its number behind them.
    prefix: &'static str,
    channel: usize,
}

impl Passage<'_> {
    /// Returns true if the component corrects the joint.
    fn is_corrected(&self) -> bool {
        self.prefix.is_empty()
    }

    /// Returns true if the joint keeps its feedback where the drives are simulated. A simulated
    /// machine stands in for the drives of corrected joints. The command itself stands in for
    /// unknown drives of joints that pass through.
    fn keeps_feedback(&self) -> bool {
        !self.is_corrected() && self.joint.is_simulated()
    }

    /// A pin of the component: `command`, `drive`, `actual` or `feedback`.
    fn pin(&self, what: &str) -> String {
        format!("feedwright.{}{what}-{}", self.prefix, self.channel)
    }

    /// A pin of LinuxCNC.
    fn joint_pin(&self, what: &str) -> String {
        format!("joint.{}.{what}", self.joint.number)
    }
}

/// The corrected joints, and behind them those that pass through.
fn passages(joints: &SetupJoints) -> Vec<Passage<'_>> {
    let corrected = joints
        .wired()
        .enumerate()
        .map(|(channel, joint)| (joint, "", channel));
    let passing = joints
        .passing()
        .enumerate()
        .map(|(channel, (joint, _))| (joint, "through-", channel));
    let all = corrected.chain(passing).enumerate();
    all.map(|(net, (joint, prefix, channel))| Passage {
        joint,
        net,
        prefix,
        channel,
    })
    .collect()
}

/// Lines that load the component, the sampler and the simulated machine.
fn loads(joints: &SetupJoints, simulates: bool) -> Vec<String> {
    let count = joints.wired().count();
    let list = |key: &str| {
        let of = |joint: &SetupJoint| {
            joints
                .planned(joint, key)
                .map(|(section, _)| format!("[{section}]{key}"))
        };
        joints
            .wired()
            .map(of)
            .collect::<Option<Vec<_>>>()
            .map(|all| all.join(","))
    };
    let limits = ["MAX_VELOCITY", "MAX_ACCELERATION", "FERROR", "MIN_FERROR"].map(list);
    let mut line = format!("loadrt feedwright model=[FEEDWRIGHT]MODEL joints={count}");
    let unit = if joints.unit_mm == 1.0 {
        String::new()
    } else {
        format!(" mm_per_unit={}", joints.unit_mm)
    };
    line.push_str(&unit);
    let tandem: Vec<String> = joints
        .passing()
        .map(|(_, axis)| axis.map_or_else(|| "-1".to_owned(), |axis| axis.to_string()))
        .collect();
    if !tandem.is_empty() {
        let _ = write!(
            line,
            " through={} tandem={}",
            tandem.len(),
            tandem.join(",")
        );
    }
    // The component compares following errors where all four are stated.
    if let [
        Some(velocity),
        Some(acceleration),
        Some(ferror),
        Some(min_ferror),
    ] = limits
    {
        let _ = write!(
            line,
            " max_velocity={velocity} max_acceleration={acceleration} max_ferror={ferror} min_ferror={min_ferror}"
        );
    }
    let mut lines = vec![
        line,
        format!(
            "loadrt sampler depth=20000 cfg={}",
            "f".repeat(SAMPLED.len() * count)
        ),
    ];
    if simulates {
        lines.push(format!(
            "loadrt feedwright_plant model=[FEEDWRIGHT]MACHINE joints={count}{unit}"
        ));
    }
    lines
}

/// All changes of the HAL files.
struct HalEdits<'a> {
    script: &'a HalScript,
    netlist: &'a Netlist,
    /// The line that loads the motion controller.
    load: HalPlace,
    lines: BTreeMap<HalPlace, HalLineEdit>,
    /// Instances of components that the configuration does not load.
    new: BTreeMap<String, Vec<String>>,
    /// Lines for the file of connections.
    added: String,
}

impl HalEdits<'_> {
    /// Replaces a pin wherever it is connected or set; nothing takes it out.
    fn replace(&mut self, pin: &str, by: Option<&str>) {
        for (place, line) in self.script.lines() {
            if !WITH_PINS.contains(&line.word(0)) {
                continue;
            }
            let first = if line.word(0) == "net" { 2 } else { 1 };
            let words = line.words.iter().enumerate().skip(first);
            for (number, _) in words.filter(|(_, word)| self.netlist.pin(&word.text) == pin) {
                let edit = self.lines.entry(place).or_default();
                edit.words
                    .entry(number)
                    .or_insert_with(|| by.map(str::to_owned));
            }
        }
    }

    fn after(&mut self, place: HalPlace, lines: &[String]) {
        self.lines
            .entry(place)
            .or_default()
            .after
            .extend_from_slice(lines);
    }

    /// Takes a pin of hardware off its signal, and sets it to the value that it has while the
    /// machine is off.
    fn disconnect(&mut self, CutPin { pin, at_rest, .. }: &CutPin) {
        let connects = |(place, line): (HalPlace, &HalLine)| {
            let is_pin = |word: &HalWord| self.netlist.pin(&word.text) == *pin;
            (line.word(0) != "setp" && line.words.iter().skip(1).any(is_pin)).then_some(place)
        };
        let place = self.script.lines().filter_map(connects).last();
        self.replace(pin, None);
        if let (Some(place), Some(value)) = (place, at_rest.filter(|value| *value != 0.0)) {
            self.after(place, &[format!("setp {pin} {value}")]);
        }
    }

    fn joint(&mut self, passage: &Passage<'_>, simulates: bool) {
        self.replace(
            &passage.joint_pin("motor-pos-cmd"),
            Some(&passage.pin("drive")),
        );
        let actual = passage.pin("actual");
        let by = Some(actual.as_str()).filter(|_| !simulates || passage.keeps_feedback());
        self.replace(&passage.joint_pin("motor-pos-fb"), by);
    }

    /// Puts functions behind the motion controller. The sampler sees what the component saw, and
    /// the drives get what it gave. Functions that are put behind it by number move on.
    fn functions(&mut self, function: &HalFunction, names: &[String]) {
        let first = function.position.filter(|position| *position > 0);
        let line = |(number, name): (usize, &String)| {
            let position = first.map_or_else(String::new, |first| {
                format!(" {}", first + 1 + number as i32)
            });
            format!("addf {name} {}{position}", function.thread)
        };
        let lines: Vec<String> = names.iter().enumerate().map(line).collect();
        self.after(function.place, &lines);
        let Some(first) = first else { return };
        let later = self
            .netlist
            .functions
            .iter()
            .skip_while(|other| other.place != function.place)
            .skip(1);
        for other in later.filter(|other| other.thread == function.thread) {
            let Some(position) = other.position.filter(|position| *position > first) else {
                continue;
            };
            let moved = (position + names.len() as i32).to_string();
            self.lines
                .entry(other.place)
                .or_default()
                .words
                .insert(3, Some(moved));
        }
    }

    /// Connects the pins that take the speed of LinuxCNC's command to the speed of the drive's
    /// command. Returns the function that has to run behind the component.
    fn velocity(&mut self, passage: &Passage<'_>, function: &HalFunction) -> Option<String> {
        let pin = passage.joint_pin("vel-cmd");
        let sinks: Vec<String> = self.netlist.beside(&pin).map(str::to_owned).collect();
        for derivative in sinks
            .iter()
            .filter(|sink| last_part(sink) == "command-deriv")
        {
            self.replace(derivative, None);
        }
        let takes_speed = |sink: &&String| {
            let last = last_part(sink);
            last.contains("vel") && last.contains("cmd")
                || last.contains("ff")
                || last.contains("feedforward")
        };
        if !sinks.iter().any(|sink| takes_speed(&sink)) {
            return None;
        }
        let instance = self.instance("ddt", &format!("feedwright-speed-{}", passage.net));
        self.replace(&pin, Some(&format!("{instance}.out")));
        let command = self.drive_signal(passage);
        let _ = writeln!(self.added, "net {command} => {instance}.in");
        // Where ddt is loaded behind the motion controller, its function is added there.
        let place = |place: HalPlace| self.script.order.iter().position(|other| *other == place);
        let late = self
            .netlist
            .load("ddt")
            .map(|load| load.place)
            .filter(|load| place(*load) > place(function.place));
        let Some(late) = late else {
            return Some(instance);
        };
        self.after(late, &[format!("addf {instance} {}", function.thread)]);
        None
    }

    /// Another instance of a component of HAL: LinuxCNC loads a component once, so that its line
    /// takes one more.
    fn instance(&mut self, module: &str, name: &str) -> String {
        let Some(found) = self.netlist.load(module) else {
            self.new
                .entry(module.to_owned())
                .or_default()
                .push(name.to_owned());
            return name.to_owned();
        };
        let line = self.script.line(found.place);
        let argument = |key: &str| {
            line.words
                .iter()
                .position(|word| word.text.starts_with(key))
        };
        let edit = self.lines.entry(found.place).or_default();
        let mut taken = |number: usize| {
            edit.words
                .remove(&number)
                .flatten()
                .unwrap_or_else(|| line.word(number).to_owned())
        };
        if let Some(number) = argument("names=") {
            let names = format!("{},{name}", taken(number));
            edit.words.insert(number, Some(names));
            return name.to_owned();
        }
        // A component without arguments is loaded once: its count goes behind its name.
        let number = argument("count=").unwrap_or(1);
        let text = taken(number);
        let (before, count) = text.rsplit_once("count=").unwrap_or((&text, ""));
        let count = count.parse::<usize>().unwrap_or(1);
        let before = before.trim_end();
        let space = if before.is_empty() { "" } else { " " };
        edit.words
            .insert(number, Some(format!("{before}{space}count={}", count + 1)));
        format!("{module}.{count}")
    }

    /// The signal of the drive's command.
    fn drive_signal(&self, passage: &Passage<'_>) -> String {
        let signal = self.netlist.signal_of(&passage.joint_pin("motor-pos-cmd"));
        signal.map_or_else(
            || format!("feedwright-drive-{}", passage.net),
            str::to_owned,
        )
    }

    /// Connects a pin of LinuxCNC with pins of the component, on the signal that it has or on a new
    /// one.
    fn connect(&mut self, name: &str, pin: &str, to: &str) {
        let _ = match self.netlist.signal_of(pin) {
            Some(signal) => writeln!(self.added, "net {signal} => {to}"),
            None => writeln!(self.added, "net feedwright-{name} {pin} => {to}"),
        };
    }

    /// The file of connections.
    fn connections(
        &mut self,
        passages: &[Passage<'_>],
        names: &SetupNames,
        function: &HalFunction,
        simulates: bool,
    ) -> String {
        let mut text = format!(
            "# The correction between LinuxCNC and the drives: written by feedwright linuxcnc setup {}.\n\
             # The copies of the other HAL files load the component and connect the drives with feedwright.drive-N and feedwright.actual-N.\n",
            names.original
        );
        for passage in passages {
            self.passage(passage, simulates);
        }
        let first = passages.first().map_or(0, |passage| passage.joint.number);
        let _ = writeln!(self.added, "\n# Amplifiers, and what LinuxCNC does.");
        let powered = if simulates {
            "feedwright.powered feedwright-plant.powered"
        } else {
            "feedwright.powered"
        };
        self.connect("powered", &format!("joint.{first}.amp-enable-out"), powered);
        self.connect("coordinated", "motion.coord-mode", "feedwright.coordinated");
        self.connect(
            "motion-type",
            "motion.motion-type",
            "feedwright.motion-type",
        );
        self.connect(
            "spindle-index",
            "spindle.0.index-enable",
            "feedwright.spindle-index",
        );
        self.feed(function);
        let _ = writeln!(
            self.added,
            "\n# Threading and tapping wait until they are without delay."
        );
        self.replace("spindle.0.at-speed", Some("feedwright.at-speed"));
        let _ = writeln!(
            self.added,
            "net feedwright-at-speed feedwright.spindle-at-speed => spindle.0.at-speed"
        );
        let _ = writeln!(
            self.added,
            "\n# Settings.\n\
             setp feedwright.delay [FEEDWRIGHT]DELAY\n\
             setp feedwright.correction-acceleration [FEEDWRIGHT]CORRECTION_ACCELERATION\n\
             setp feedwright.acceleration-limit [FEEDWRIGHT]ACCELERATION_LIMIT\n\
             setp feedwright.deviation-limit [FEEDWRIGHT]DEVIATION_LIMIT\n\
             setp feedwright.enable [FEEDWRIGHT]ENABLE\n\
             setp sampler.0.enable 0"
        );
        text.push_str(&self.added);
        text
    }

    /// The nets of a joint.
    fn passage(&mut self, passage: &Passage<'_>, simulates: bool) {
        let (net, joint, command) = (passage.net, passage.joint, self.drive_signal(passage));
        let [planned, feedback] =
            ["motor-pos-cmd", "motor-pos-fb"].map(|what| passage.joint_pin(what));
        let is_corrected = passage.is_corrected();
        let _ = writeln!(self.added, "\n# {}, joint {}.", joint.letter, joint.number);
        let sample = |what: usize| match is_corrected {
            true => format!("sampler.0.pin.{}", SAMPLED.len() * passage.channel + what),
            false => String::new(),
        };
        let line = format!(
            "net feedwright-command-{net} {planned} => {} {}",
            passage.pin("command"),
            sample(0)
        );
        let _ = writeln!(self.added, "{}", line.trim_end());
        if is_corrected {
            let _ = writeln!(self.added, "net {command} => {}", sample(1));
            let actual = if simulates {
                let pin = |what: &str| format!("feedwright-plant.{what}-{}", passage.channel);
                let signal = format!("feedwright-actual-{net}");
                let _ = writeln!(self.added, "net {command} => {}", pin("command"));
                let _ = writeln!(
                    self.added,
                    "net {signal} {} => {}",
                    pin("actual"),
                    passage.pin("actual")
                );
                signal
            } else {
                self.netlist.signal_of(&feedback).unwrap_or("").to_owned()
            };
            let _ = writeln!(self.added, "net {actual} => {}", sample(2));
        } else if simulates && !passage.keeps_feedback() {
            let _ = writeln!(self.added, "net {command} => {}", passage.pin("actual"));
        }
        let _ = writeln!(
            self.added,
            "net feedwright-feedback-{net} {} => {feedback}",
            passage.pin("feedback")
        );
        for (name, pin) in [("offset", "motor-offset"), ("homed", "homed")]
            .into_iter()
            .filter(|_| is_corrected)
        {
            let to = format!("feedwright.{name}-{}", passage.channel);
            self.connect(&format!("{name}-{net}"), &passage.joint_pin(pin), &to);
        }
    }

    /// The pins that hold or change the feed.
    fn feed(&mut self, function: &HalFunction) {
        let _ = writeln!(
            self.added,
            "\n# A probing motion waits until it is without delay."
        );
        if self.netlist.signal_of("motion.feed-inhibit").is_some() {
            let instance = self.instance("or2", "feedwright-inhibit");
            self.replace("motion.feed-inhibit", Some(&format!("{instance}.in0")));
            let _ = writeln!(
                self.added,
                "addf {instance} {}\n\
                 net feedwright-holds-feed feedwright.feed-inhibit => {instance}.in1\n\
                 net feedwright-inhibit {instance}.out => motion.feed-inhibit",
                function.thread
            );
        } else {
            let _ = writeln!(
                self.added,
                "net feedwright-inhibit feedwright.feed-inhibit => motion.feed-inhibit"
            );
        }
        let _ = match self.netlist.signal_of("motion.adaptive-feed") {
            Some(signal) => writeln!(
                self.added,
                "# motion.adaptive-feed is on {signal}, and stays there: the controllers of Lee, Cho and Jeon do not change the feedrate."
            ),
            None => writeln!(
                self.added,
                "net feedwright-adaptive feedwright.adaptive-feed => motion.adaptive-feed"
            ),
        };
    }

    /// The copies, and who names them.
    #[expect(
        clippy::type_complexity,
        reason = "two lists that are taken apart at once"
    )]
    fn finish(mut self, names: &SetupNames) -> (Vec<(String, String)>, Vec<(usize, String)>) {
        let new: Vec<String> = self
            .new
            .iter()
            .map(|(module, instances)| format!("loadrt {module} names={}", instances.join(",")))
            .collect();
        self.after(self.load, &new);
        let mut changed: BTreeSet<usize> = self.lines.keys().map(|place| place.0).collect();
        // A file that sources a copy is a copy, too.
        while let Some((by, _)) = self.script.named.iter().find(|(by, file)| {
            changed.contains(file)
                && matches!(by, NamedBy::Source(place) if !changed.contains(&place.0))
        }) {
            if let NamedBy::Source(place) = by {
                changed.insert(place.0);
            }
        }
        let mut copy_names: BTreeMap<usize, String> = BTreeMap::new();
        for &file in &changed {
            let name = names.copy_of(&self.script.files[file].path);
            let is_taken = copy_names.values().any(|other| *other == name);
            copy_names.insert(
                file,
                if is_taken {
                    format!("{file}-{name}")
                } else {
                    name
                },
            );
        }
        let mut renamed = Vec::new();
        for (by, file) in &self.script.named {
            let Some(name) = copy_names.get(file) else {
                continue;
            };
            match by {
                NamedBy::Entry(number) => renamed.push((*number, name.clone())),
                NamedBy::Source(place) => {
                    self.lines
                        .entry(*place)
                        .or_default()
                        .words
                        .insert(1, Some(name.clone()));
                }
            }
        }
        let copies = copy_names
            .iter()
            .map(|(&file, name)| (name.clone(), self.copy(file)))
            .collect();
        (copies, renamed)
    }

    /// The text of a file with its changes.
    fn copy(&self, file: usize) -> String {
        let mut text = String::new();
        for (number, line) in self.script.files[file].lines.iter().enumerate() {
            let edit = self.lines.get(&(file, number));
            text.push_str(
                &edit.map_or_else(|| line.text.clone(), |edit| edited(line, &edit.words)),
            );
            text.push('\n');
            for line in edit.into_iter().flat_map(|edit| &edit.after) {
                text.push_str(line);
                text.push('\n');
            }
        }
        text
    }
}
