//! The copy of the INI file: other HAL files, a section of its own, and the values that change.

use std::fmt::Write as _;

use super::ini::{IniEntry, IniFile};
use super::limits::IniValue;
use super::names::SetupNames;

/// Acceleration with which a correction fades, mm/s2: the component's own.
const CORRECTION_MM_S2: f64 = 400.0;
/// Largest distance of the drive's command from the path at the start, mm.
const DEVIATION_MM: f64 = 0.05;

/// The text of the copy. `renamed` are entries, by their number, that name another HAL file;
/// `accel_mm_s2` is what every joint can.
pub(crate) fn ini_copy(
    ini: &IniFile,
    renamed: &[(usize, String)],
    names: &SetupNames,
    simulates: bool,
    values: &[IniValue],
    accel_mm_s2: Option<f64>,
) -> String {
    let mut lines: Vec<Option<String>> = ini.lines.iter().cloned().map(Some).collect();
    let mut set = |entry: &IniEntry, value: &str| {
        let [first, last] = entry.lines;
        lines[first..=last].iter_mut().for_each(|line| *line = None);
        lines[first] = Some(format!("{} = {value}", entry.key));
    };
    let halfiles = || {
        ini.entries
            .iter()
            .enumerate()
            .filter(|(_, entry)| entry.section == "HAL" && entry.key == "HALFILE")
    };
    for (number, name) in renamed {
        if let Some(entry) = ini.entries.get(*number) {
            set(entry, name);
        }
    }
    let mut missing: Vec<(String, String)> = Vec::new();
    for IniValue {
        section,
        key,
        value,
    } in values
    {
        match ini.entry(section, key) {
            Some(entry) => set(entry, &value.to_string()),
            None => missing.push((section.clone(), format!("{key} = {value}"))),
        }
    }
    if let Some((_, last)) = halfiles().next_back()
        && let Some(line) = &mut lines[last.lines[0]]
    {
        let _ = write!(line, "\nHALFILE = {}", names.hal);
    }
    for (section, text) in missing {
        if let Some(entry) = ini.entries.iter().find(|entry| entry.section == section)
            && let Some(line) = &mut lines[entry.lines[0]]
        {
            let _ = write!(line, "\n{text}");
        }
    }
    let mut text = format!(
        "# A copy of {} with the correction of feedwright: written by feedwright linuxcnc setup.\n",
        names.original
    );
    for line in lines.into_iter().flatten() {
        text.push_str(&line);
        text.push('\n');
    }
    text.push_str(&section(names, simulates, accel_mm_s2));
    text
}

fn section(names: &SetupNames, simulates: bool, accel_mm_s2: Option<f64>) -> String {
    let accel_mm_s2 = accel_mm_s2.unwrap_or(0.0);
    let machine = if simulates {
        format!(
            "# The simulated machine that stands in for the drives.\nMACHINE = {}\n",
            names.plant
        )
    } else {
        String::new()
    };
    format!(
        "\n[FEEDWRIGHT]\n\
         # The identified machine: written by feedwright block. Without it, commands are passed on unchanged.\n\
         MODEL = {}\n\
         {machine}\
         # Delay of the command, 0.008 to 0.015 s: how far the correction looks ahead.\n\
         DELAY = 0.010\n\
         # Acceleration with which the correction fades, mm/s2.\n\
         CORRECTION_ACCELERATION = {CORRECTION_MM_S2}\n\
         # Acceleration of the correction while it is in the loop, mm/s2; 0 is without limit. It comes on top of what LinuxCNC plans.\n\
         ACCELERATION_LIMIT = {accel_mm_s2}\n\
         # Largest distance of the drive's command from the path, mm. Raise it as far as the clearances allow.\n\
         DEVIATION_LIMIT = {DEVIATION_MM}\n\
         # 1 corrects from the start.\n\
         ENABLE = 0\n",
        names.model
    )
}
