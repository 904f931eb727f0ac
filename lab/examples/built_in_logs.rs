//! Writes the models that the logs of the built-in machines identify, which the program is shipped
//! with: `just built-in-logs`. Takes some minutes.

use std::error::Error;
use std::path::Path;

use feedwright::command::today;
use feedwright::{BEST, CONTROLLERS, built_in_lines};
use feedwright_sim::{BUILT_IN_MACHINES, Machine};
use rayon::prelude::*;

/// File from which the program reads the models.
const FILE: &str = "../crates/feedwright/src/recorded_model/built_in.jsonl";

fn main() -> Result<(), Box<dyn Error>> {
    let machines: Result<Vec<_>, _> = BUILT_IN_MACHINES
        .iter()
        .map(|(name, _)| Machine::load(name.as_ref()))
        .collect();
    let cases: Vec<(Machine, usize)> = machines?
        .into_iter()
        .flat_map(|machine| [2, 3].map(|axes| (machine.clone(), axes)))
        .collect();
    let entry = CONTROLLERS.find(BEST).ok_or("no default controller")?;
    let date = today()?;
    let found: Vec<_> = cases
        .par_iter()
        .map(|(machine, axes)| {
            let lines = built_in_lines(machine, *axes, entry, date.clone(), &());
            eprintln!(
                "{}, {axes} axes: {} lines",
                machine.name,
                lines.as_ref().map_or(0, Vec::len)
            );
            lines
        })
        .collect();
    // A machine whose log identifies no model is skipped: the program reports this at each cut,
    // too.
    let lines: Vec<String> = found
        .into_iter()
        .filter_map(Result::ok)
        .flatten()
        .map(|line| line + "\n")
        .collect();
    std::fs::write(
        Path::new(env!("CARGO_MANIFEST_DIR")).join(FILE),
        lines.concat(),
    )?;
    Ok(())
}
