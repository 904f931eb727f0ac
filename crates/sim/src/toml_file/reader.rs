//! Reads tables of a TOML text key by key and collects every fault, instead of stopping at the
//! first.
//!
//! The known keys are the keys that the caller asks for; [`Table::finish`] reports all others.

use std::ops::{Range, RangeInclusive};

use feedwright_gcode::suggestion::nearest;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::Fault;
use crate::number::shown;

/// Most faults that are listed for one array; the last of them counts the others.
const FAULTS_OF_AN_ARRAY: usize = 3;

/// Largest number of a row, of whatever unit: a file of measurements has none above.
const ROW_LIMIT: f64 = 1e9;

/// A table under reading.
pub struct Table<'t, 'i> {
    /// Dotted name, empty for the file itself.
    name: String,
    /// Place of the table's header, where a missing key is reported.
    at: Range<usize>,
    /// Entries of the table; `None` if the table is in the base alone or missing. It then reports
    /// nothing.
    entries: Option<&'t DeTable<'i>>,
    /// Same table in the base file: it has no faults, and its places refer to another text.
    base: Option<&'t DeTable<'i>>,
    asked: Vec<&'static str>,
}

impl<'t, 'i> Table<'t, 'i> {
    /// The file itself.
    pub fn root(entries: &'t Spanned<DeTable<'i>>, base: Option<&'t Spanned<DeTable<'i>>>) -> Self {
        let (entries, base) = (Some(entries.get_ref()), base.map(Spanned::get_ref));
        Self {
            name: String::new(),
            at: 0..0,
            entries,
            base,
            asked: Vec::new(),
        }
    }

    /// Returns true if an optional key is present.
    pub(crate) fn has(&mut self, key: &'static str) -> bool {
        self.asked.push(key);
        self.value(key).is_some()
    }

    /// A number in `unit` within `range`; NaN and a fault where it is not.
    pub(crate) fn number(
        &mut self,
        key: &'static str,
        unit: &str,
        range: RangeInclusive<f64>,
        faults: &mut Vec<Fault>,
    ) -> f64 {
        let found = self
            .required(key, faults)
            .map(|value| number(value, key, key, unit, &range));
        match found {
            Some(Ok(number)) => return number,
            Some(Err(fault)) => faults.push(fault),
            None => {}
        }
        f64::NAN
    }

    /// A whole number within `range`; none and a fault where it is not.
    pub fn whole(
        &mut self,
        key: &'static str,
        unit: &str,
        range: RangeInclusive<f64>,
        faults: &mut Vec<Fault>,
    ) -> Option<u64> {
        let value = self.number(key, unit, range, faults);
        if value.is_finite() && value.fract() != 0.0 {
            faults.push(Fault {
                at: self.place(key),
                label: "not whole",
                message: format!("{key} is {}; it must be a whole number", shown(value)),
                hint: None,
            });
        }
        (value.is_finite() && value.fract() == 0.0).then_some(value as u64)
    }

    /// Returns the numbers of a key within `range`. If any number is outside, returns none and
    /// reports the first few as faults.
    pub(crate) fn numbers(
        &mut self,
        key: &'static str,
        unit: &str,
        range: RangeInclusive<f64>,
        faults: &mut Vec<Fault>,
    ) -> Vec<f64> {
        let Some(value) = self.required(key, faults) else {
            return Vec::new();
        };
        let DeValue::Array(array) = value.get_ref() else {
            faults.push(wrong_type(
                value.span(),
                key,
                "numbers in brackets",
                value.get_ref(),
            ));
            return Vec::new();
        };
        let named = |at: usize| format!("{key}, number {}", at + 1);
        let found = array
            .iter()
            .enumerate()
            .map(|(at, value)| number(value, key, &named(at), unit, &range));
        let (numbers, wrong): (Vec<_>, Vec<_>) = found.partition(Result::is_ok);
        let wrong: Vec<Fault> = wrong.into_iter().filter_map(Result::err).collect();
        if wrong.is_empty() {
            return numbers.into_iter().filter_map(Result::ok).collect();
        }
        let more = wrong.len().saturating_sub(FAULTS_OF_AN_ARRAY);
        let mut wrong: Vec<Fault> = wrong.into_iter().take(FAULTS_OF_AN_ARRAY).collect();
        if let Some(last) = wrong.last_mut().filter(|_| more > 0) {
            last.message += &format!("; {more} more of {key} are as wrong");
        }
        faults.extend(wrong);
        Vec::new()
    }

    /// Rows of `width` numbers within 1e9, `[[1, 2], [3, 4]]`; empty where the key is missing, and
    /// with faults where a row is no such row.
    pub(crate) fn rows(
        &mut self,
        key: &'static str,
        width: usize,
        faults: &mut Vec<Fault>,
    ) -> Vec<Vec<f64>> {
        self.asked.push(key);
        let Some(value) = self.value(key) else {
            return Vec::new();
        };
        let Some(array) = value.get_ref().as_array() else {
            faults.push(wrong_type(
                value.span(),
                key,
                "rows of numbers in brackets",
                value.get_ref(),
            ));
            return Vec::new();
        };
        let mut rows = Vec::new();
        for (at, row) in array.iter().enumerate() {
            let named = format!("{key}, row {}", at + 1);
            let numbers = row.get_ref().as_array().filter(|row| row.len() == width);
            let numbers: Option<Result<Vec<f64>, Fault>> = numbers.map(|row| {
                row.iter()
                    .map(|value| number(value, key, &named, "", &(-ROW_LIMIT..=ROW_LIMIT)))
                    .collect()
            });
            match numbers {
                Some(Ok(numbers)) => rows.push(numbers),
                Some(Err(fault)) => faults.push(fault),
                None => {
                    let message = format!("{named} has to be {width} numbers in brackets");
                    faults.push(Fault {
                        at: row.span(),
                        label: "no such row",
                        message,
                        hint: None,
                    });
                }
            }
            if faults.len() >= FAULTS_OF_AN_ARRAY {
                break;
            }
        }
        rows
    }

    /// A text that is not blank; empty and a fault where it is.
    pub(crate) fn text(&mut self, key: &'static str, faults: &mut Vec<Fault>) -> String {
        let Some(value) = self.required(key, faults) else {
            return String::new();
        };
        match value.get_ref() {
            DeValue::String(text) if !text.trim().is_empty() => text.trim().to_owned(),
            DeValue::String(_) => {
                faults.push(Fault {
                    at: value.span(),
                    label: "empty",
                    message: format!("{key} is empty"),
                    hint: None,
                });
                String::new()
            }
            other => {
                faults.push(wrong_type(value.span(), key, "a text in quotes", other));
                String::new()
            }
        }
    }

    /// A table that has to be there; a fault where it is not.
    pub fn table(&mut self, key: &'static str, faults: &mut Vec<Fault>) -> Self {
        let present = self.optional_table(key, faults);
        present.unwrap_or_else(|| {
            let name = self.dotted(key);
            if self.entries.is_some() {
                faults.push(Fault {
                    at: self.at.clone(),
                    label: "missing below here",
                    message: format!("table [{name}] is missing"),
                    hint: self
                        .near_unknown(key)
                        .map(|near| format!("is [{}] meant to be it?", self.dotted(near))),
                });
            }
            Self {
                name,
                at: self.at.clone(),
                entries: None,
                base: None,
                asked: Vec::new(),
            }
        })
    }

    /// A table that may be left out.
    pub(crate) fn optional_table(
        &mut self,
        key: &'static str,
        faults: &mut Vec<Fault>,
    ) -> Option<Self> {
        self.asked.push(key);
        let name = self.dotted(key);
        let base = self
            .base
            .and_then(|base| base.get(key))
            .and_then(|value| value.get_ref().as_table());
        let Some(value) = self.entries.and_then(|entries| entries.get(key)) else {
            return base.is_some().then(|| Self {
                name,
                at: self.at.clone(),
                entries: None,
                base,
                asked: Vec::new(),
            });
        };
        let entries = match value.get_ref() {
            DeValue::Table(entries) => Some(entries),
            other => {
                faults.push(wrong_type(
                    value.span(),
                    key,
                    &format!("a table [{name}]"),
                    other,
                ));
                None
            }
        };
        Some(Self {
            name,
            at: value.span(),
            entries,
            base,
            asked: Vec::new(),
        })
    }

    /// Returns every entry that is a table, with its key, in the order of the file. Every other
    /// entry is a fault.
    pub(crate) fn tables(self, faults: &mut Vec<Fault>) -> Vec<(String, Self)> {
        let mut found = Vec::new();
        for (key, value) in self.entries.or(self.base).into_iter().flatten() {
            let name = if self.name.is_empty() {
                key.get_ref().to_string()
            } else {
                format!("{}.\"{}\"", self.name, key.get_ref())
            };
            match value.get_ref() {
                DeValue::Table(entries) => {
                    let table = Self {
                        name,
                        at: key.span(),
                        entries: Some(entries),
                        base: None,
                        asked: Vec::new(),
                    };
                    found.push((key.span().start, key.get_ref().to_string(), table));
                }
                other => faults.push(wrong_type(
                    value.span(),
                    key.get_ref(),
                    &format!("a table [{name}]"),
                    other,
                )),
            }
        }
        found.sort_by_key(|(start, ..)| *start);
        found
            .into_iter()
            .map(|(_, key, table)| (key, table))
            .collect()
    }

    /// Place of the table itself.
    pub fn header(&self) -> Range<usize> {
        self.at.clone()
    }

    /// Place of a key's value, for faults between values; the table's where the key is missing.
    pub fn place(&self, key: &str) -> Range<usize> {
        self.entries
            .and_then(|entries| entries.get(key))
            .map_or_else(|| self.at.clone(), Spanned::span)
    }

    /// Reports every key that the caller did not ask for as a fault.
    pub fn finish(self, faults: &mut Vec<Fault>) {
        for (key, value) in self.entries.into_iter().flatten() {
            let word: &str = key.get_ref();
            if self.asked.contains(&word) {
                continue;
            }
            let kind = if value.get_ref().is_table() {
                "table"
            } else {
                "key"
            };
            let home = if self.name.is_empty() {
                "the file".to_owned()
            } else {
                format!("[{}]", self.name)
            };
            let hint = match nearest(word, &self.asked) {
                Some(near) => format!("did you mean '{near}'?"),
                None => format!("{home} holds {}", self.asked.join(", ")),
            };
            faults.push(Fault {
                at: key.span(),
                label: "unknown",
                message: format!("unknown {kind} '{word}' in {home}"),
                hint: Some(hint),
            });
        }
    }

    /// The value of a key that has to be there; a fault where it is not.
    fn required(
        &mut self,
        key: &'static str,
        faults: &mut Vec<Fault>,
    ) -> Option<&'t Spanned<DeValue<'i>>> {
        self.asked.push(key);
        let value = self.value(key);
        if value.is_none() && self.entries.is_some() {
            let home = if self.name.is_empty() {
                String::new()
            } else {
                format!(" from [{}]", self.name)
            };
            faults.push(Fault {
                at: self.at.clone(),
                label: "missing here",
                message: format!("{key} is missing{home}"),
                hint: self
                    .near_unknown(key)
                    .map(|near| format!("is '{near}' meant to be it?")),
            });
        }
        value
    }

    /// The value of a key, here or in the base.
    fn value(&self, key: &str) -> Option<&'t Spanned<DeValue<'i>>> {
        let here = self.entries.and_then(|entries| entries.get(key));
        here.or_else(|| self.base.and_then(|base| base.get(key)))
    }

    /// A key of the text that looks like `key` and that the caller has not asked for yet.
    fn near_unknown(&self, key: &str) -> Option<&'t str> {
        let entries = self.entries?;
        let unknown: Vec<&str> = entries
            .keys()
            .map(|key| key.get_ref().as_ref())
            .filter(|word| !self.asked.contains(word))
            .collect();
        // Stricter than `nearest` alone: a key that is asked for later is unknown only until then.
        nearest(key, &unknown).filter(|near| strsim::damerau_levenshtein(key, near) <= 2)
    }

    fn dotted(&self, key: &str) -> String {
        if self.name.is_empty() {
            key.to_owned()
        } else {
            format!("{}.{key}", self.name)
        }
    }
}

/// The number that a value is: of a key, or `named` within it.
fn number(
    value: &Spanned<DeValue<'_>>,
    key: &str,
    named: &str,
    unit: &str,
    range: &RangeInclusive<f64>,
) -> Result<f64, Fault> {
    let number: Option<f64> = match value.get_ref() {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix())
            .ok()
            .map(|whole| whole as f64),
        other if key == named => return Err(wrong_type(value.span(), key, "a number", other)),
        other => {
            let message = format!("{named} is {}, not a number", article(other.type_str()));
            return Err(Fault {
                at: value.span(),
                label: "wrong type",
                message,
                hint: None,
            });
        }
    };
    match number {
        Some(number) if range.contains(&number) => Ok(number),
        Some(number) => Err(out_of_range(value.span(), named, number, unit, range)),
        None => Err(Fault {
            at: value.span(),
            label: "too large",
            message: format!("{named} is no number that can be represented"),
            hint: Some(format!("it must lie between {}", with_unit(range, unit))),
        }),
    }
}

/// Both ends of a range, with their unit where there is one.
fn with_unit(range: &RangeInclusive<f64>, unit: &str) -> String {
    let ends = format!("{} and {}", shown(*range.start()), shown(*range.end()));
    if unit.is_empty() {
        ends
    } else {
        format!("{ends} {unit}")
    }
}

fn wrong_type(at: Range<usize>, key: &str, wanted: &str, got: &DeValue<'_>) -> Fault {
    let hint = match got {
        DeValue::String(text) if text.trim().parse::<f64>().is_ok() => {
            Some(format!("without the quotes: {key} = {}", text.trim()))
        }
        _ => None,
    };
    Fault {
        at,
        label: "wrong type",
        message: format!(
            "{key} has to be {wanted}, but is {}",
            article(got.type_str())
        ),
        hint,
    }
}

fn article(kind: &str) -> String {
    let article = if kind.starts_with(['a', 'e', 'i', 'o', 'u']) {
        "an"
    } else {
        "a"
    };
    format!("{article} {kind}")
}

/// Fault of a number outside its range.
pub(super) fn out_of_range(
    at: Range<usize>,
    key: &str,
    number: f64,
    unit: &str,
    range: &RangeInclusive<f64>,
) -> Fault {
    let blank_and_unit = if unit.is_empty() {
        String::new()
    } else {
        format!(" {unit}")
    };
    let hint = if !number.is_finite() {
        Some("write a finite number".to_owned())
    } else if range.contains(&-number) {
        Some(format!(
            "is the sign wrong? {}{blank_and_unit} is allowed",
            -number
        ))
    } else if number == 0.0 || unit.is_empty() {
        None
    } else {
        Some(format!("is the unit right? this key is in {unit}"))
    };
    Fault {
        at,
        label: if number.is_finite() {
            "out of range"
        } else {
            "not finite"
        },
        message: format!(
            "{key} is {}{blank_and_unit}; it must lie between {}",
            shown(number),
            with_unit(range, unit)
        ),
        hint,
    }
}
