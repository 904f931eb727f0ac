//! Updates a machine file with the results of a new log. Everything else stays as it is, including
//! comments.

use feedwright_gcode::visible;
use feedwright_sim::AXIS_NAMES;
use miette::Diagnostic;
use thiserror::Error;
use toml_edit::{DocumentMut, Item, Table, TableLike, Value};

use super::LogIdentified;
use super::axis_keys::{AxisKey, axis_keys};

/// Reasons why a machine file cannot be updated.
#[derive(Debug, Error, Diagnostic)]
pub enum UpdateError {
    /// The text is not TOML.
    #[error("the machine file cannot be updated: {0}")]
    NotToml(#[from] toml_edit::TomlError),
    /// Something is a value where a table has to be.
    #[error("the machine file cannot be updated: {key} is no table")]
    NoTable {
        /// The key.
        key: String,
    },
}

/// Returns the text of a machine file in which the identified values of its axes are replaced.
///
/// Fails if the text is not a machine file.
pub fn updated_text(identified: &LogIdentified, before: &str) -> Result<String, UpdateError> {
    let mut document: DocumentMut = before.parse()?;
    let servo_s = feedwright_ident::servo_period_s(identified.machine.sample_s);
    for (name, place) in AXIS_NAMES.into_iter().zip(identified.places()) {
        let Some(found) = place.and_then(|i| identified.machine.axes.get(i)) else {
            continue;
        };
        let axes = within(document.as_table_mut(), "axis", true)?;
        let axis = within(axes, name, false)?;
        let [keys, of_screw] = axis_keys(found, servo_s);
        keys.iter()
            .filter(|key| key.is_identified)
            .for_each(|key| set(axis, key));
        if !of_screw.is_empty() {
            let transmission = within(axis, "transmission", false)?;
            let is_new = !transmission.contains_key("damping_ratio");
            of_screw
                .iter()
                .filter(|key| key.is_identified || is_new)
                .for_each(|key| set(transmission, key));
        }
    }
    let log = visible(&identified.job.name);
    let text = document.to_string();
    Ok(format!(
        "# Updated by feedwright from {log}; intervals of 90 % beside what it determined.\n{text}"
    ))
}

/// The table of a key, which is created if it is missing. Fails if the key holds something else.
fn within<'t>(
    table: &'t mut dyn TableLike,
    key: &str,
    is_implicit: bool,
) -> Result<&'t mut dyn TableLike, UpdateError> {
    let mut new = Table::new();
    new.set_implicit(is_implicit);
    let item = table.entry(key).or_insert(Item::Table(new));
    item.as_table_like_mut()
        .ok_or_else(|| UpdateError::NoTable {
            key: key.to_owned(),
        })
}

/// A value with its comment.
fn set(table: &mut dyn TableLike, key: &AxisKey) {
    let mut value = Value::from(key.value);
    if !key.comment.is_empty() {
        value.decor_mut().set_suffix(format!(" # {}", key.comment));
    }
    table.insert(key.name, Item::Value(value));
}
