//! Wires the HAL component `feedwright` into a LinuxCNC configuration: reads the INI file and its
//! HAL files, says of every joint what can be corrected, and writes a changed copy beside the
//! original.
//!
//! ```text
//! INI -> HAL lines -> netlist -> joints -> verdict -> copies with feedwright between planner and drives, machine file, record script
//! ```
//!
//! The original files are only read. The copies are named after the INI file, and a manifest lists
//! them with checksums, so that they can be taken away again. Lengths of a configuration are in its
//! own unit until a name ends in `_mm`.

pub(crate) mod error;
pub(crate) mod ini;
pub(crate) mod hal;
pub(crate) mod netlist;
mod components;
mod drives;
mod disconnect;
mod joints;
mod limits;
mod names;
mod steps;
mod line_edit;
mod wiring;
mod ini_copy;
mod machine_guess;
mod manifest;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use feedwright_ident::exact_block;
use feedwright_sim::{Machine, Watch};

pub use error::LinuxcncSetupError;
use hal::HalScript;
use ini::IniFile;
use joints::SetupJoints;
use manifest::SetupFile;
use names::SetupNames;
use netlist::Netlist;

/// Debian's folder of the HAL files that several configurations share.
pub const HALLIB: &str = "/usr/share/linuxcnc/hallib";

/// Range of the pin `acceleration-limit`, mm/s2.
const LIVE_ACCELERATIONS_MM_S2: [f64; 2] = [1.0, 1e6];

/// Options of a setup.
#[derive(Debug, Clone)]
pub struct LinuxcncSetup {
    /// The INI file of the configuration.
    pub ini: PathBuf,
    /// Folder of the shared HAL files: see [`HALLIB`].
    pub hallib: PathBuf,
    /// Built-in machine or machine file that stands in for drives that are simulated.
    pub simulate: Option<String>,
    /// Following error that the copy allows, in the unit of the configuration: FERROR and
    /// MIN_FERROR of linear joints that are below it are raised to it. Without it, the copy keeps
    /// the values of the original.
    pub raise_ferror: Option<f64>,
    /// Replaces copies of an earlier setup that were changed by hand.
    pub replace: bool,
}

/// Result of a setup.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LinuxcncWiring {
    /// Findings in plain words; each line stands alone.
    pub(crate) findings: Vec<String>,
    /// Reasons why the configuration is not wired, each with its remedy; empty if it is wired.
    pub refusals: Vec<String>,
    /// Pins of hardware that the copy disconnects, because a simulated machine stands in for it.
    pub(crate) disconnected: Vec<String>,
    /// Changes that the configuration needs before the correction is enabled.
    pub(crate) changes: Vec<String>,
    /// Next steps, with the exact commands.
    pub(crate) steps: Vec<String>,
    /// The files that were written.
    pub written: Vec<PathBuf>,
}

impl LinuxcncWiring {
    /// Returns true if the copies are written.
    pub fn is_wired(&self) -> bool {
        self.refusals.is_empty()
    }

    /// All of it, as a terminal shows it.
    pub(crate) fn text(&self, wrapped: impl Fn(&str) -> String) -> String {
        let mut text = String::new();
        let mut part = |title: &str, lines: &[String]| {
            if !lines.is_empty() {
                let _ = writeln!(text, "{title}");
                for line in lines {
                    // Commands stand alone in their line, so that they can be copied.
                    let shown = if line.starts_with(' ') {
                        line.clone()
                    } else {
                        wrapped(&format!("  {line}"))
                    };
                    let _ = writeln!(text, "{shown}");
                }
            }
        };
        part("Found:", &self.findings);
        part("Not wired, because:", &self.refusals);
        part(
            "Disconnected in the copy, as setup does not know what moves there:",
            &self.disconnected,
        );
        part("Change before the correction is enabled:", &self.changes);
        part("Next:", &self.steps);
        text
    }
}

/// A configuration that was read.
struct Configuration {
    ini: IniFile,
    script: HalScript,
    netlist: Netlist,
    joints: SetupJoints,
}

impl LinuxcncSetup {
    /// Reads the configuration and says what can be corrected. Writes nothing.
    ///
    /// # Errors
    /// An INI file or HAL file that cannot be read.
    pub fn survey(&self) -> Result<LinuxcncWiring, LinuxcncSetupError> {
        let read = self.read()?;
        Ok(self.outcome(&read, self.stand_in()?.as_ref()))
    }

    /// Wires the configuration: writes the copies, the machine file and the record script. If the
    /// configuration cannot be wired, nothing is written, and the result says why.
    ///
    /// # Errors
    /// As [`LinuxcncSetup::survey`]; copies of an earlier setup that were changed by hand; files
    /// that cannot be written.
    pub fn wire(&self, watch: &dyn Watch) -> Result<LinuxcncWiring, LinuxcncSetupError> {
        let read = self.read()?;
        let simulated = self.stand_in()?;
        let mut outcome = self.outcome(&read, simulated.as_ref());
        if outcome.is_wired() {
            let names = SetupNames::of(&self.ini);
            let files = self.files(&read, &names, simulated.as_ref())?;
            outcome.written = manifest::write(&names, files, self.replace, watch)?;
        }
        Ok(outcome)
    }

    /// Removes what [`LinuxcncSetup::wire`] wrote: the removed files, and those that stay because
    /// they were changed by hand.
    ///
    /// # Errors
    /// There is no manifest beside the INI file, or a file cannot be removed.
    pub fn undo(&self) -> Result<[Vec<PathBuf>; 2], LinuxcncSetupError> {
        manifest::undo(&SetupNames::of(&self.ini))
    }

    fn read(&self) -> Result<Configuration, LinuxcncSetupError> {
        let ini = IniFile::read(&self.ini)?;
        let script = HalScript::read(&ini, folder_of(&self.ini), &self.hallib)?;
        let netlist = Netlist::of(&script);
        let joints = SetupJoints::of(&ini, &netlist);
        Ok(Configuration {
            ini,
            script,
            netlist,
            joints,
        })
    }

    /// The machine that stands in for simulated drives.
    fn stand_in(&self) -> Result<Option<Machine>, LinuxcncSetupError> {
        Ok(self
            .simulate
            .as_deref()
            .map(|machine| Machine::load(machine.as_ref()))
            .transpose()?)
    }

    fn outcome(&self, read: &Configuration, simulated: Option<&Machine>) -> LinuxcncWiring {
        let Configuration {
            ini,
            script,
            netlist,
            joints,
        } = read;
        let mut findings = script.notes.clone();
        findings.extend(joints.findings());
        findings.extend(netlist.findings());
        findings.extend(joints.compensated());
        let mut refusals = script.refusals.clone();
        refusals.extend(joints.refusals(simulated.is_some()));
        refusals.extend(wiring::refusals(ini, netlist));
        let cut = if simulated.is_some() {
            disconnect::cut_pins(netlist)
        } else {
            Vec::new()
        };
        if simulated.is_some() {
            refusals.extend(disconnect::refusals(ini, script, &cut));
        }
        let wired = refusals.is_empty();
        let names = SetupNames::of(&self.ini);
        let changes = if wired {
            limits::changes(joints, simulated, self.raise_ferror)
        } else {
            Vec::new()
        };
        let steps = if wired {
            steps::steps(&names, joints.wired().count(), simulated.is_some())
        } else {
            Vec::new()
        };
        let disconnected = if wired {
            disconnect::cut_words(&cut)
        } else {
            Vec::new()
        };
        LinuxcncWiring {
            findings,
            refusals,
            disconnected,
            changes,
            steps,
            written: Vec::new(),
        }
    }

    fn files(
        &self,
        read: &Configuration,
        names: &SetupNames,
        simulated: Option<&Machine>,
    ) -> Result<Vec<SetupFile>, LinuxcncSetupError> {
        let Configuration {
            ini,
            script,
            netlist,
            joints,
        } = read;
        let wired = wiring::wire(ini, script, netlist, joints, names, simulated.is_some())?;
        let text = |name: &str, text: String| SetupFile {
            path: names.path(name),
            bytes: text.into_bytes(),
        };
        let mut files: Vec<SetupFile> = wired
            .copies
            .iter()
            .map(|(name, copy)| text(name, copy.clone()))
            .collect();
        files.push(text(&names.hal, wired.hal));
        files.push(text(
            &names.machine,
            machine_guess::machine_file(joints, ini, names),
        ));
        files.push(text(&names.record, steps::record_script(joints, names)));
        if let Some(machine) = simulated {
            let axes = joints.wired().count().min(machine.axis_count());
            let bytes = exact_block(machine, axes, machine.errors_of_geometry().as_ref());
            files.push(SetupFile {
                path: names.path(&names.plant),
                bytes,
            });
        }
        // The INI file comes last: whoever finds it finds the others.
        let values = limits::written(joints, simulated.is_some(), self.raise_ferror);
        let accel_mm_s2 = joints
            .least_mm("MAX_ACCELERATION", LIVE_ACCELERATIONS_MM_S2)
            .map(|least| least.value);
        let copy = ini_copy::ini_copy(
            ini,
            &wired.renamed,
            names,
            simulated.is_some(),
            &values,
            accel_mm_s2,
        );
        files.push(text(&names.ini, copy));
        Ok(files)
    }
}

/// The folder of a file.
fn folder_of(path: &Path) -> &Path {
    path.parent()
        .filter(|folder| !folder.as_os_str().is_empty())
        .unwrap_or(Path::new("."))
}
