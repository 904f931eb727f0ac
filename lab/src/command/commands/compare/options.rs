//! Options of a comparison, from the arguments.
use feedwright::{BASELINE, Entry};
use feedwright_gcode::suggestion::nearest;
use feedwright_sim::{BUILT_IN_MACHINES, Machine};
use miette::{Result, miette};

use crate::command::args::compare::{CompareArgs, TuningSource, Work};
use crate::command::sweep::loaded;
use crate::compare::held_out_work::HeldOutSeeds;
use crate::compare::{ComparisonOptions, Tuning, Workpiece, recorded};
use crate::peers::CONTROLLERS;

pub(super) fn options(args: &CompareArgs) -> Result<ComparisonOptions> {
    let mut workpieces = match args.work {
        Work::Contours => Workpiece::contours(),
        Work::Development => Workpiece::development(),
        Work::HeldOut => HeldOutSeeds::recorded().workpieces(),
    };
    let mut machines = loaded(BUILT_IN_MACHINES.iter().map(|(name, _)| name))?;
    let mut controllers: Vec<&'static Entry> = CONTROLLERS.iter().collect();
    let nominal = machines[0].clone();
    let added = loaded(&args.machine)?;
    let all_machines = [&machines[..], &added[..]].concat();
    check_only(&args.only, &workpieces, &all_machines, &controllers)?;
    let named = |name: &str| args.only.iter().any(|only| only == name);
    if workpieces.iter().any(|w| named(&w.name)) || !args.part.is_empty() && !args.only.is_empty() {
        workpieces.retain(|w| named(&w.name));
    }
    if all_machines.iter().any(|m| named(&m.name)) {
        machines.retain(|m| named(&m.name));
    }
    if controllers.iter().any(|c| named(c.name)) {
        controllers.retain(|c| named(c.name) || c.name == BASELINE);
    }
    let settings = args.reader.settings()?;
    for part in &args.part {
        let part = Workpiece::program(part, settings.clone())?;
        if workpieces.iter().any(|w| w.name == part.name) {
            return Err(ambiguous("--part", &part.name));
        }
        workpieces.push(part);
    }
    for machine in added {
        match machines.iter().find(|m| m.name == machine.name) {
            // All that are built in are there already.
            Some(there) if *there == machine => {}
            Some(_) => return Err(ambiguous("--machine", &machine.name)),
            None => machines.push(machine),
        }
    }
    let set = feedwright::command::settings(&args.set, CONTROLLERS, None, &controllers)?;
    let tuning = match args.tuning() {
        TuningSource::Recorded => {
            let all = [&machines[..], std::slice::from_ref(&nominal)].concat();
            Tuning::Known(recorded::known(&all, args.seed))
        }
        TuningSource::Search => Tuning::Search,
        TuningSource::Defaults => Tuning::Defaults,
    };
    let compensated = machines.iter().map(|machine| args.geometry.on(machine));
    Ok(ComparisonOptions {
        machines: compensated.collect::<Result<_>>()?,
        workpieces,
        nominal,
        controllers,
        knowledge: args.knowledge.iter().map(|&given| given.into()).collect(),
        seed: args.seed,
        noise_seeds: args.seeds,
        tuning,
        set,
        at_tolerance: args.at_tolerance,
    })
}

/// Fails if a name in `--only` is unknown.
fn check_only(
    only: &[String],
    workpieces: &[Workpiece],
    machines: &[Machine],
    controllers: &[&'static Entry],
) -> Result<()> {
    let known: Vec<String> = (workpieces.iter().map(|w| w.name.clone()))
        .chain(machines.iter().map(|m| m.name.clone()))
        .chain(controllers.iter().map(|c| c.name.to_owned()))
        .collect();
    for name in only {
        if !known.contains(name) {
            let names: Vec<&str> = known.iter().map(String::as_str).collect();
            let help = match nearest(name, &names) {
                Some(meant) => format!("did you mean '{meant}'?"),
                None => format!(
                    "there are {}; what --part and --machine add is always cut",
                    known.join(", ")
                ),
            };
            return Err(miette!(
                help = help,
                "--only: no contour, machine or controller is called '{name}'"
            ));
        }
    }
    Ok(())
}

/// Reports two inputs of the same name, because their rows in the table would look the same.
fn ambiguous(option: &str, name: &str) -> miette::Report {
    let help = match option {
        "--part" => "the file has this name: give this one another",
        _ => {
            "give it another `name` in its file, or choose from those that are built in with --only"
        }
    };
    miette!(
        help = help,
        "{option}: there is another '{name}' in the table"
    )
}
