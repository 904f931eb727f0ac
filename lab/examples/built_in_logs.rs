//! Writes the models that the logs of the built-in machines identify, which the program is shipped
//! with: `just built-in-logs`. Takes 20 minutes of processor time. `just built-in-logs stiff router`
//! writes those of these machines anew and keeps the other lines.

use std::error::Error;
use std::path::Path;

use feedwright::command::today;
use feedwright::{BEST, CONTROLLERS, built_in_lines};
use feedwright_sim::{BUILT_IN_MACHINES, Machine};
use rayon::prelude::*;

/// File from which the program reads the models.
const FILE: &str = "../crates/feedwright/src/recorded_model/built_in.jsonl";

fn main() -> Result<(), Box<dyn Error>> {
    let named: Vec<String> = std::env::args().skip(1).collect();
    let machines: Result<Vec<_>, _> = BUILT_IN_MACHINES
        .iter()
        .filter(|(name, _)| named.is_empty() || named.iter().any(|of| of == name))
        .map(|(name, _)| Machine::load(name.as_ref()))
        .collect();
    let cases: Vec<(Machine, usize)> = machines?
        .into_iter()
        .flat_map(|machine| [2, 3].map(|axes| (machine.clone(), axes)))
        .collect();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(FILE);
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
    let mut new: Vec<String> = found.into_iter().filter_map(Result::ok).flatten().collect();
    let mut lines: Vec<String> = vec![];
    if !named.is_empty() {
        // A line begins with the hash of its content.
        let content = |line: &str| line.split('"').nth(3).map(str::to_owned);
        for old in std::fs::read_to_string(&file)?.lines() {
            let of_old = |line: &String| content(line) == content(old);
            let line = new.iter().position(of_old).map(|at| new.remove(at));
            lines.push(line.unwrap_or_else(|| old.to_owned()));
        }
    }
    lines.append(&mut new);
    std::fs::write(file, lines.join("\n") + "\n")?;
    Ok(())
}
