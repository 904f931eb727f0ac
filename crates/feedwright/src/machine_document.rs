//! A built-in machine as a file to start from: every key, with its comment.
//!
//! Machines build upon one another ([`Machine`]'s key `base`). Here all of them are in one text:
//! each key with the value and the comment of the last file that states it. Keys that may be left
//! out stand as comments where no file states them.
//!
//! [`Machine`]: feedwright_sim::Machine

use std::fmt::Write as _;

use feedwright_sim::toml_file::Key;
use feedwright_sim::{AXIS_NAMES, BUILT_IN_MACHINES, MACHINE_FORMAT, machine_keys};
use toml_edit::{DocumentMut, Item, Table, TomlError};

/// The text of a built-in machine with all of its keys; none without such a machine.
///
/// # Errors
/// A built-in machine that is no TOML, which a test keeps out.
pub(crate) fn machine_document(name: &str) -> Result<Option<String>, TomlError> {
    let Some(document) = merged(name)? else {
        return Ok(None);
    };
    let value = |key: &str| {
        document
            .get(key)
            .and_then(Item::as_value)
            .map(|value| value.to_string().trim().to_owned())
    };
    let mut text = format!(
        "# The built-in machine {name}, with all of its keys. Change what your machine has otherwise, and give it a name of its own.\n\
         # docs/machine-file.md explains every key. A comment beside a value says where the value comes from.\n\n\
         format = {MACHINE_FORMAT}\n"
    );
    for key in ["name", "description", "source"] {
        let _ = writeln!(text, "{key} = {}", value(key).unwrap_or_default());
    }
    table(
        &mut text,
        &document,
        "period",
        &left_out(machine_keys::PERIOD),
    );
    table(
        &mut text,
        &document,
        "limits",
        &left_out(machine_keys::LIMITS),
    );
    for axis in AXIS_NAMES {
        table(
            &mut text,
            &document,
            &format!("axis.{axis}"),
            &left_out(machine_keys::AXIS),
        );
        table(
            &mut text,
            &document,
            &format!("axis.{axis}.transmission"),
            &left_out(machine_keys::TRANSMISSION),
        );
    }
    table(
        &mut text,
        &document,
        "geometry",
        &left_out(machine_keys::GEOMETRY),
    );
    table(
        &mut text,
        &document,
        "noise",
        &left_out(machine_keys::NOISE),
    );
    table(&mut text, &document, "plc", &left_out(machine_keys::PLC));
    Ok(Some(text))
}

/// The document of a built-in machine upon those that it builds upon.
fn merged(name: &str) -> Result<Option<Table>, TomlError> {
    let Some((_, text)) = BUILT_IN_MACHINES.iter().find(|(known, _)| *known == name) else {
        return Ok(None);
    };
    let document: DocumentMut = text.parse()?;
    let base = document
        .get("base")
        .and_then(Item::as_str)
        .map(merged)
        .transpose()?
        .flatten();
    let mut all = base.unwrap_or_default();
    overlay(&mut all, document.as_table());
    Ok(Some(all))
}

/// Puts the keys of a table over those of another one.
fn overlay(below: &mut Table, above: &Table) {
    for (key, item) in above {
        match (
            below.get_mut(key).and_then(Item::as_table_mut),
            item.as_table(),
        ) {
            (Some(below), Some(above)) => overlay(below, above),
            _ => {
                below.insert(key, item.clone());
            }
        }
    }
}

/// Returns the name of each key that no file states, and a comment on it.
fn left_out<T>(keys: &[Key<T>]) -> Vec<(&'static str, String)> {
    let line = |key: &Key<T>| {
        let [least, most] = key.range;
        let unit = if key.unit.starts_with('(') {
            ""
        } else {
            key.unit
        };
        let allowed = if key.unit == "(0 or 1)" {
            "0 or 1".to_owned()
        } else {
            format!("{least} to {most} {unit}")
        };
        (
            key.name,
            format!("# {} is left out: {}", key.name, allowed.trim_end()),
        )
    };
    keys.iter().map(line).collect()
}

/// A table of the text: the keys of the document, and as comments those that it leaves out.
fn table(text: &mut String, document: &Table, name: &str, keys: &[(&str, String)]) {
    let Some(table) = name
        .split('.')
        .try_fold(document, |table, key| table.get(key)?.as_table())
    else {
        if !name.starts_with("axis") {
            let _ = writeln!(text, "\n# The table [{name}] is left out.");
        }
        return;
    };
    let _ = writeln!(text, "\n[{name}]");
    for (key, item) in table {
        if let Some(value) = item.as_value() {
            let decor = value
                .decor()
                .suffix()
                .and_then(|suffix| suffix.as_str())
                .unwrap_or("")
                .trim();
            let bare = value.clone().decorated("", "");
            let _ = writeln!(text, "{}", format!("{key} = {bare} {decor}").trim_end());
        }
    }
    for (_, line) in keys.iter().filter(|(key, _)| !table.contains_key(key)) {
        let _ = writeln!(text, "{line}");
    }
}

#[cfg(test)]
mod tests {
    use feedwright_sim::Machine;

    use super::*;

    #[test]
    fn each_document_is_the_machine() {
        for (name, text) in BUILT_IN_MACHINES {
            let document = machine_document(name).unwrap().unwrap();
            let [written, built_in] = [document.as_str(), text]
                .map(|text| Machine::parse(&format!("{name}.toml"), text).unwrap());
            assert_eq!(written, built_in, "{name}");
            assert!(!document.contains("\nbase"), "{name}");
        }
        assert_eq!(machine_document("nobody").unwrap(), None);
    }

    #[test]
    fn every_key_stands_there_with_its_comment() {
        let document = machine_document("workshop").unwrap().unwrap();
        for key in machine_keys::AXIS {
            assert!(document.contains(key.name), "{}", key.name);
        }
        assert!(
            document.contains("inertia_kg_m2 = ")
                && document.contains("# jitter_s is left out: 0 to 0.02 s"),
            "{document}"
        );
        assert!(
            document.contains("encoder_step_um = 0.1 # choice: 100,000 steps a turn of the screw"),
            "{document}"
        );
    }
}
