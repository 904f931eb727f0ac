//! Controllers, their parameters, and controls by name.

use feedwright_gcode::suggestion::nearest;
use miette::{Result, miette};

use crate::controllers::{Controllers, Entry, Setting};
use crate::correct::{TARGETS, TargetControl};

/// The controller of a name.
pub fn find(name: &str, table: Controllers) -> Result<&'static Entry> {
    table.find(name).ok_or_else(|| {
        let names: Vec<&str> = table.iter().map(|entry| entry.name).collect();
        let meant = table.meant_by(name).map_or(String::new(), |meant| format!("did you mean '{meant}'? "));
        miette!(
            help = format!("{meant}'feedwright controllers' says what each does, and 'feedwright lab controllers' those of the laboratory"),
            "no controller is called '{name}'; there are {}",
            names.join(", ")
        )
    })
}

/// Parses the values of `--set` for the controllers that take part. A name without a controller
/// belongs to `of`.
pub fn settings(
    texts: &[String],
    table: Controllers,
    of: Option<&'static Entry>,
    take_part: &[&'static Entry],
) -> Result<Vec<Setting>> {
    let mut settings: Vec<Setting> = Vec::new();
    for text in texts {
        let setting = Setting::parse(text, of, table)?;
        if !take_part
            .iter()
            .any(|entry| entry.name == setting.controller)
        {
            let names: Vec<&str> = take_part.iter().map(|entry| entry.name).collect();
            return Err(miette!(
                help = format!("controllers that do: {}", names.join(", ")),
                "--set {text}: {} does not take part",
                setting.controller
            ));
        }
        if settings
            .iter()
            .any(|other| (other.controller, other.name) == (setting.controller, setting.name))
        {
            return Err(miette!(
                help = "leave one of them out",
                "--set {text}: {} of {} is set twice",
                setting.name,
                setting.controller
            ));
        }
        settings.push(setting);
    }
    Ok(settings)
}

/// The control of that name.
pub fn find_control(name: &str) -> Result<&'static TargetControl> {
    TargetControl::find(name).ok_or_else(|| {
        let names: Vec<&str> = TARGETS.iter().map(|target| target.name).collect();
        let near = nearest(name, &names)
            .map_or_else(String::new, |near| format!("did you mean '{near}'? "));
        miette!(
            help = format!("{near}'{}' suits a control that is not listed", names[0]),
            "--for: no control is called '{name}'; there are {}",
            names.join(", ")
        )
    })
}
