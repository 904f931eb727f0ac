//! Writes what the logs of the built-in machines tell, which the program is shipped with: `just built-in-logs`. Some minutes.

use std::error::Error;
use std::path::Path;

use feedwright::built_in_line;
use feedwright_sim::{BUILT_IN_MACHINES, Machine};
use rayon::prelude::*;

/// Where the program reads it from.
const FILE: &str = "../crates/feedwright/src/recorded_model/built_in.jsonl";

fn main() -> Result<(), Box<dyn Error>> {
    let machines: Result<Vec<_>, _> = BUILT_IN_MACHINES.iter().map(|(name, _)| Machine::load(name.as_ref())).collect();
    let cases: Vec<(Machine, usize)> =
        machines?.into_iter().flat_map(|machine| [2, 3].map(|axes| (machine.clone(), axes))).collect();
    let found: Vec<_> = cases
        .par_iter()
        .map(|(machine, axes)| {
            let line = built_in_line(machine, *axes, &());
            eprintln!("{}, {axes} axes: {}", machine.name, if line.is_ok() { "identified" } else { "not" });
            line
        })
        .collect();
    // A machine whose log tells no model is told so at each cut, too.
    let lines: Vec<String> = found.into_iter().filter_map(Result::ok).map(|line| line + "\n").collect();
    std::fs::write(Path::new(env!("CARGO_MANIFEST_DIR")).join(FILE), lines.concat())?;
    Ok(())
}
