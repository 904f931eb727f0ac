//! Values of the parameters of controllers that a user sets, by name: `--set knots=10`.

use feedwright_control::Parameter;
use feedwright_gcode::suggestion::nearest;
use miette::Diagnostic;
use serde::Serialize;
use thiserror::Error;

use super::{Choices, Controllers, Entry};

/// Describes the values that a parameter can be set to.
pub(crate) fn range(parameter: &Parameter) -> String {
    let [least, most] = parameter.allowed;
    let whole = if parameter.is_whole { ", whole" } else { "" };
    format!("{least} to {most}{whole}")
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
                format!("{name} is {}", range(parameter)),
            );
        };
        let [least, most] = parameter.allowed;
        let is_allowed =
            (least..=most).contains(&number) && !(parameter.is_whole && number.fract() != 0.0);
        if !is_allowed {
            return fail(
                format!("{name} is {}", range(parameter)),
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
    let reported = format!(
        "feedwright controllers {} describes {}",
        entry.name,
        names.join(", ")
    );
    nearest(name, &names).map_or_else(
        || reported.clone(),
        |meant| format!("did you mean '{meant}'? {reported}"),
    )
}

impl Choices {
    /// Returns the value of a parameter of a controller: the last that is set, or its default.
    pub fn value(&self, entry: &Entry, parameter: &Parameter) -> f64 {
        let set = self
            .set
            .iter()
            .rev()
            .find(|set| set.controller == entry.name && set.name == parameter.name);
        set.map_or(parameter.default, |set| set.value)
    }
}

#[cfg(test)]
mod tests {
    use super::super::CONTROLLERS;
    use super::*;

    fn reported(text: &str) -> String {
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
        let choices = Choices {
            set: vec![set],
            ..Choices::default()
        };
        let value = |name| choices.value(entry, entry.parameter(name).unwrap());
        assert_eq!([value("friction_gain"), value("velocity_gain")], [2.5, 1.0]);
    }

    #[test]
    fn what_cannot_be_set_is_reported_with_a_remedy() {
        assert_eq!(
            reported("knots"),
            "--set knots: the value is missing; write --set knots=VALUE"
        );
        assert!(reported("knot=3").contains("has no parameter 'knot'; did you mean 'knots'?"));
        assert!(reported("uncorrected.kp=3").contains("nothing of it can be set"));
        assert!(reported("feedforwrd.kp=3").contains("did you mean 'feedforward'?"));
        assert!(reported("knots=ten").contains("'ten' is no number; knots is 1 to 20, whole"));
        for value in ["21", "0", "2.5", "nan", "-1", "1e400"] {
            assert!(
                reported(&format!("knots={value}"))
                    .contains("knots is 1 to 20, whole; its default is 1"),
                "{value}"
            );
        }
        let error = Setting::parse("kp=3", None, CONTROLLERS).unwrap_err();
        assert!(error.hint.contains("--set CONTROLLER.kp=3"));
    }
}
