//! Machines, controllers and controls, to choose from.

use feedwright::sim::{BUILT_IN_MACHINES, DEFAULT_MACHINE, Machine};
use feedwright::{BEST, CONTROLLERS, TARGETS};
use serde_json::json;

use crate::request::{Outputs, json};

pub(crate) fn lists() -> miette::Result<Outputs> {
    let mut machines = Vec::new();
    for (name, text) in BUILT_IN_MACHINES {
        let machine = Machine::parse(&format!("{name}.toml"), text)?;
        machines.push(
            json!({ "name": name, "about": machine.description, "axes": machine.axis_count() }),
        );
    }
    let controllers = CONTROLLERS
        .iter()
        .map(|entry| json!({ "name": entry.name, "about": entry.summary }));
    let controls = TARGETS
        .iter()
        .map(|target| json!({ "name": target.name, "about": target.about }));
    Ok(vec![json(&json!({
        "version": env!("CARGO_PKG_VERSION"),
        "machines": machines,
        "machine": DEFAULT_MACHINE,
        "controllers": controllers.collect::<Vec<_>>(),
        "controller": BEST,
        "controls": controls.collect::<Vec<_>>(),
        "control": TARGETS[0].name,
    }))])
}
