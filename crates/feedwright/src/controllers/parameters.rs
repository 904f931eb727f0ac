//! What of a controller can be set, by name: `--set knots=10`.

use feedwright_gcode::suggestion::nearest;
use miette::Diagnostic;
use serde::Serialize;
use thiserror::Error;

use super::{Controllers, Entry};

/// Something of a controller that can be set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Name, with its unit at the end.
    pub name: &'static str,
    /// Value where none is given.
    pub default: f64,
    /// Least and largest value that it can be set to.
    pub allowed: [f64; 2],
    /// Range in which the comparison searches for the best value; by ratios where the range begins
    /// above zero.
    pub searched: Option<[f64; 2]>,
    /// Kind of the values that are allowed in this range.
    pub kind: ParameterKind,
    /// Description of the parameter, and of what goes wrong if it is too small or too large.
    pub reason: &'static str,
    /// Unit of a value that is no plain number.
    pub unit: Option<&'static str>,
}

/// Kind of the values that a parameter can have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterKind {
    /// All.
    Number,
    /// Whole numbers.
    Whole,
}

impl Parameter {
    /// A parameter of any value.
    pub const fn number(
        name: &'static str,
        default: f64,
        allowed: [f64; 2],
        searched: Option<[f64; 2]>,
        reason: &'static str,
    ) -> Self {
        Self {
            name,
            default,
            allowed,
            searched,
            kind: ParameterKind::Number,
            reason,
            unit: None,
        }
    }

    /// A parameter that is a whole number.
    pub const fn whole(
        name: &'static str,
        default: usize,
        allowed: [f64; 2],
        reason: &'static str,
    ) -> Self {
        Self {
            name,
            default: default as f64,
            allowed,
            searched: None,
            kind: ParameterKind::Whole,
            reason,
            unit: None,
        }
    }

    /// The parameter with a unit of its values.
    pub const fn of_unit(self, unit: &'static str) -> Self {
        Self {
            unit: Some(unit),
            ..self
        }
    }

    /// Describes the values that the parameter can be set to.
    pub fn range(&self) -> String {
        let [least, most] = self.allowed;
        match self.kind {
            ParameterKind::Number => format!("{least} to {most}"),
            ParameterKind::Whole => format!("{least} to {most}, whole"),
        }
    }

    fn allows(&self, value: f64) -> bool {
        let [least, most] = self.allowed;
        (least..=most).contains(&value)
            && (self.kind == ParameterKind::Number || value.fract() == 0.0)
    }
}

/// A parameter that was set.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Setting {
    /// Name of the controller.
    pub controller: &'static str,
    /// Name of its parameter.
    pub name: &'static str,
    /// The value, which is allowed.
    pub value: f64,
}

/// Reason why `--set` cannot be done.
#[derive(Debug, Clone, PartialEq, Error, Diagnostic)]
#[error("--set {text}: {message}")]
pub struct SettingError {
    text: String,
    message: String,
    #[help]
    hint: String,
}

impl Setting {
    /// Reads `name=value` of this controller, or `CONTROLLER.name=value` of any in a table.
    ///
    /// # Errors
    /// Fails if `text` has no value or no controller, if the controller or the parameter is
    /// unknown, or if the value is not a number or not allowed.
    pub fn parse(
        text: &str,
        of: Option<&'static Entry>,
        table: Controllers,
    ) -> Result<Self, SettingError> {
        let fail = |message: String, hint: String| {
            Err(SettingError {
                text: text.to_owned(),
                message,
                hint,
            })
        };
        let Some((place, value)) = text.split_once('=') else {
            return fail(
                "the value is missing".to_owned(),
                format!("write --set {text}=VALUE"),
            );
        };
        let (place, value) = (place.trim(), value.trim());
        let (entry, name) = match (place.split_once('.'), of) {
            (Some((controller, name)), _) => match table.find(controller) {
                Some(entry) => (entry, name),
                None => {
                    return fail(
                        format!("no controller is called '{controller}'"),
                        meant_controller(controller, table),
                    );
                }
            },
            (None, Some(entry)) => (entry, place),
            (None, None) => {
                return fail(
                    "whose parameter it is is missing".to_owned(),
                    format!("write --set CONTROLLER.{text}"),
                );
            }
        };
        let Some(parameter) = entry.parameter(name) else {
            return fail(
                format!("{} has no parameter '{name}'", entry.name),
                meant_parameter(entry, name),
            );
        };
        let Ok(number) = value.parse::<f64>() else {
            return fail(
                format!("'{value}' is no number"),
                format!("{name} is {}", parameter.range()),
            );
        };
        if !parameter.allows(number) {
            return fail(
                format!("{name} is {}", parameter.range()),
                format!("its default is {}", parameter.default),
            );
        }
        Ok(Self {
            controller: entry.name,
            name: parameter.name,
            value: number,
        })
    }
}

fn meant_controller(name: &str, table: Controllers) -> String {
    let all = "feedwright controllers lists them";
    table.meant_by(name).map_or_else(
        || all.to_owned(),
        |meant| format!("did you mean '{meant}'? {all}"),
    )
}

fn meant_parameter(entry: &Entry, name: &str) -> String {
    let names: Vec<&str> = entry
        .parameters
        .iter()
        .map(|parameter| parameter.name)
        .collect();
    if names.is_empty() {
        return "nothing of it can be set".to_owned();
    }
    let told = format!(
        "feedwright controllers {} tells of {}",
        entry.name,
        names.join(", ")
    );
    nearest(name, &names).map_or_else(
        || told.clone(),
        |meant| format!("did you mean '{meant}'? {told}"),
    )
}

/// The values of all parameters of a controller.
#[derive(Debug, Clone, PartialEq)]
pub struct Values(Vec<(&'static str, f64)>);

impl Values {
    /// The defaults, where nothing else is set.
    pub fn of(entry: &Entry, settings: &[Setting]) -> Self {
        let value = |parameter: &Parameter| {
            let set = settings
                .iter()
                .rev()
                .find(|set| set.controller == entry.name && set.name == parameter.name);
            (
                parameter.name,
                set.map_or(parameter.default, |set| set.value),
            )
        };
        Self(entry.parameters.iter().map(value).collect())
    }

    /// Returns a value by its name, which the row of the table must have.
    pub fn number(&self, name: &str) -> f64 {
        let found = self.0.iter().find(|(of, _)| *of == name);
        found
            .expect("what makes a controller asks for the parameters of its row")
            .1
    }

    /// A value that is a whole number.
    pub fn whole(&self, name: &str) -> usize {
        self.number(name) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::super::CONTROLLERS;
    use super::*;

    fn told(text: &str) -> String {
        let error =
            Setting::parse(text, CONTROLLERS.find("two-dimensional"), CONTROLLERS).unwrap_err();
        format!("{error}; {}", error.hint)
    }

    #[test]
    fn a_parameter_is_set_by_its_name_alone_or_with_its_controller() {
        let named = CONTROLLERS.find("two-dimensional");
        let set = Setting::parse("knots=10", named, CONTROLLERS).unwrap();
        assert_eq!(
            (set.controller, set.name, set.value),
            ("two-dimensional", "knots", 10.0)
        );
        let set = Setting::parse(" feedforward.friction_gain = 2.5 ", named, CONTROLLERS).unwrap();
        assert_eq!(
            (set.controller, set.name, set.value),
            ("feedforward", "friction_gain", 2.5)
        );
        let entry = CONTROLLERS.find("feedforward").unwrap();
        let values = Values::of(entry, &[set]);
        assert_eq!(values.number("friction_gain"), 2.5);
        assert_eq!(
            values.number("velocity_gain"),
            entry.parameter("velocity_gain").unwrap().default
        );
    }

    #[test]
    fn what_cannot_be_set_is_told_with_a_remedy() {
        assert_eq!(
            told("knots"),
            "--set knots: the value is missing; write --set knots=VALUE"
        );
        assert!(told("knot=3").contains("has no parameter 'knot'; did you mean 'knots'?"));
        assert!(told("uncorrected.kp=3").contains("nothing of it can be set"));
        assert!(told("feedforwrd.kp=3").contains("did you mean 'feedforward'?"));
        assert!(told("knots=ten").contains("'ten' is no number; knots is 1 to 20, whole"));
        for value in ["21", "0", "2.5", "nan", "-1", "1e400"] {
            assert!(
                told(&format!("knots={value}"))
                    .contains("knots is 1 to 20, whole; its default is 1"),
                "{value}"
            );
        }
        let error = Setting::parse("kp=3", None, CONTROLLERS).unwrap_err();
        assert!(error.hint.contains("--set CONTROLLER.kp=3"));
    }
}
