//! Keys declared in tables: name, unit, range, and the field that each fills.
//!
//! Reading, writing, the bounds in messages and the tables of the documents all use such tables. A
//! new key needs one field and one row.

use super::{Fault, Table, out_of_range, quoted};

/// A key of a file.
pub struct Key<T> {
    /// Name; its end is the unit.
    pub name: &'static str,
    /// Unit as messages show it; empty if they show no unit.
    pub unit: &'static str,
    /// Least and most of its number or numbers; of a text they say nothing.
    pub range: [f64; 2],
    /// True if the key may be left out.
    pub optional: bool,
    /// Kind of value, with access to its field.
    pub value: Value<T>,
}

/// Kind of value that a key holds, with the functions that read and write its field of a `T`. A key
/// that was left out has no value in its field.
pub enum Value<T> {
    /// A number.
    Number {
        /// Reads the field.
        get: fn(&T) -> Option<f64>,
        /// Writes the field.
        set: fn(&mut T, f64),
    },
    /// A whole number.
    Whole {
        /// Reads the field.
        get: fn(&T) -> Option<u64>,
        /// Writes the field.
        set: fn(&mut T, u64),
    },
    /// Numbers in a row.
    Numbers {
        /// Reads the field; empty if it was left out.
        get: fn(&T) -> &[f64],
        /// Writes the field.
        set: fn(&mut T, Vec<f64>),
    },
    /// A text that is not blank.
    Text {
        /// Reads the field.
        get: fn(&T) -> &str,
        /// Writes the field.
        set: fn(&mut T, String),
    },
}

/// `field, unit, least, most`; `optional field` is an `Option`, `field or zero` has that where it
/// is left out; `whole field`, `numbers field`, `text field` and `optional text field` are of those
/// kinds; `flag field` is 0 or 1, and 0 where it is left out.
#[doc(hidden)]
#[macro_export]
macro_rules! key {
    (@ $field:ident, $unit:literal, [$least:expr, $most:expr], $optional:literal, $kind:ident, $get:expr, $set:expr) => {
        $crate::toml_file::Key {
            name: stringify!($field),
            unit: $unit,
            range: [$least, $most],
            optional: $optional,
            value: $crate::toml_file::key::Value::$kind { get: $get, set: $set },
        }
    };
    (optional $field:ident, $unit:literal, $least:expr, $most:expr) => {
        key!(@ $field, $unit, [$least, $most], true, Number, |part| part.$field, |part, value| part.$field = Some(value))
    };
    ($field:ident or zero, $unit:literal, $least:expr, $most:expr) => {
        key!(@ $field, $unit, [$least, $most], true, Number,
            |part| Some(part.$field).filter(|value| *value != 0.0), |part, value| part.$field = value)
    };
    (flag $field:ident) => {
        key!(@ $field, "(0 or 1)", [0.0, 1.0], true, Number,
            |part| part.$field.then_some(1.0), |part, value| part.$field = value > 0.5)
    };
    (whole $field:ident, $unit:literal, $least:expr, $most:expr) => {
        key!(@ $field, $unit, [$least, $most], false, Whole, |part| Some(part.$field), |part, value| part.$field = value)
    };
    (numbers $field:ident, $unit:literal, $least:expr, $most:expr) => {
        key!(@ $field, $unit, [$least, $most], false, Numbers, |part| &part.$field, |part, value| part.$field = value)
    };
    (optional text $field:ident) => {
        key!(@ $field, "", [0.0, 0.0], true, Text, |part| &part.$field, |part, value| part.$field = value)
    };
    (text $field:ident) => {
        key!(@ $field, "", [0.0, 0.0], false, Text, |part| &part.$field, |part, value| part.$field = value)
    };
    ($field:ident, $unit:literal, $least:expr, $most:expr) => {
        key!(@ $field, $unit, [$least, $most], false, Number, |part| Some(part.$field), |part, value| part.$field = value)
    };
}
pub use key;

/// Reads all keys of a table; a number that has a fault is not a number, everything else stays
/// empty.
pub fn read<T: Default>(keys: &[Key<T>], table: &mut Table<'_, '_>, faults: &mut Vec<Fault>) -> T {
    let mut part = T::default();
    for key in keys {
        if !key.optional || table.has(key.name) {
            read_one(key, table, &mut part, faults);
        }
    }
    part
}

/// Checks the ranges of the numbers of a part that was made of values, as [`read`] does.
pub(crate) fn in_range<T>(keys: &[Key<T>], part: &T, faults: &mut Vec<Fault>) {
    for key in keys {
        let [least, most] = key.range;
        if let Value::Number { get, .. } = key.value
            && let Some(number) = get(part)
            && !(least..=most).contains(&number)
        {
            faults.push(out_of_range(
                0..0,
                key.name,
                number,
                key.unit,
                &(least..=most),
            ));
        }
    }
}

/// A table that has these keys and no other.
pub fn read_all<T: Default>(
    keys: &[Key<T>],
    mut table: Table<'_, '_>,
    faults: &mut Vec<Fault>,
) -> T {
    let part = read(keys, &mut table, faults);
    table.finish(faults);
    part
}

fn read_one<T>(key: &Key<T>, table: &mut Table<'_, '_>, part: &mut T, faults: &mut Vec<Fault>) {
    let [least, most] = key.range;
    match key.value {
        Value::Number { set, .. } => {
            set(part, table.number(key.name, key.unit, least..=most, faults));
        }
        Value::Whole { set, .. } => {
            if let Some(whole) = table.whole(key.name, key.unit, least..=most, faults) {
                set(part, whole);
            }
        }
        Value::Numbers { set, .. } => set(
            part,
            table.numbers(key.name, key.unit, least..=most, faults),
        ),
        Value::Text { set, .. } => set(part, table.text(key.name, faults)),
    }
}

/// Numbers of an array in a line of a file.
const NUMBERS_IN_A_LINE: usize = 4;

/// The lines of a table; what was left out stays out.
pub fn write<T>(keys: &[Key<T>], part: &T) -> String {
    let line = |key: &Key<T>| {
        let value = match key.value {
            Value::Number { get, .. } => format!("{:?}", get(part)?),
            Value::Whole { get, .. } => get(part)?.to_string(),
            Value::Numbers { get, .. } => {
                array(Some(get(part)).filter(|numbers| !numbers.is_empty())?)
            }
            Value::Text { get, .. } => {
                quoted(Some(get(part)).filter(|text| !(key.optional && text.is_empty()))?)
            }
        };
        Some(format!("{} = {value}\n", key.name))
    };
    keys.iter().filter_map(line).collect()
}

/// Returns the rows of numbers of a key, one row per line; empty if there are no rows.
pub(crate) fn write_rows<'r>(name: &str, rows: impl IntoIterator<Item = &'r [f64]>) -> String {
    let row = |row: &[f64]| {
        row.iter()
            .map(|number| format!("{number:?}"))
            .collect::<Vec<_>>()
            .join(", ")
    };
    let lines: String = rows
        .into_iter()
        .map(|numbers| format!("    [{}],\n", row(numbers)))
        .collect();
    if lines.is_empty() {
        lines
    } else {
        format!("{name} = [\n{lines}]\n")
    }
}

fn array(numbers: &[f64]) -> String {
    let line = |numbers: &[f64]| {
        numbers
            .iter()
            .map(|number| format!(" {number:?},"))
            .collect::<String>()
    };
    let lines: String = numbers
        .chunks(NUMBERS_IN_A_LINE)
        .map(|numbers| format!("   {}\n", line(numbers)))
        .collect();
    format!("[\n{lines}]")
}
