//! Margins of the default controller's loop on the built-in machines: by the exact model of each
//! axis, and by the model of a log, which `run` has by default. Predicted by the controller, and
//! measured.
//!
//! ```text
//! cargo run --release -p feedwright-lab --example margins [MACHINE...]
//! ```

use feedwright::{BEST, Choices, Setup, recorded_machine};
use feedwright_control::{AxisModel, IDENTIFIED_WEIGHT, LqgIdentified, LqgSettings};
use feedwright_lab::CONTROLLERS;
use feedwright_lab::margins::margins;
use feedwright_sim::Machine;

const MACHINES: [&str; 9] = [
    "workshop", "stiff", "tnv40", "soft", "router", "emps", "heavy", "rough", "sticky",
];

fn main() -> miette::Result<()> {
    let named: Vec<String> = std::env::args().skip(1).collect();
    let all = || MACHINES.map(str::to_owned).to_vec();
    println!("                  predicted       measured");
    println!("machine axis of    gain   deg     gain   deg");
    for name in if named.is_empty() { all() } else { named } {
        let machine = Machine::load(name.as_ref())?;
        let exact: [AxisModel; 2] = machine.axis_model();
        let (log, _) = recorded_machine(&machine, 2, 1, &()).map_err(miette::Report::msg)?;
        let choices = Choices {
            seed: 1,
            ..Choices::default()
        };
        let mut setup = Setup::new(&log, &choices);
        let servo_s = machine.period.servo_s;
        let weight = IDENTIFIED_WEIGHT.default;
        let settings = LqgSettings::identified(weight, servo_s, setup.offset_bounds());
        let entry = CONTROLLERS.find(BEST);
        let of_log = entry.and_then(|entry| entry.in_plane(&mut setup).known());
        for (kind, models) in [("exact", Some(exact)), ("log", of_log)] {
            for (axis, model) in models.into_iter().flatten().enumerate() {
                let [gains] = LqgIdentified::<1>::new([model], settings).gains();
                let measured = margins(&machine, axis, model, settings);
                println!(
                    "{name:9} {} {kind:5} {:6.2} {:5.1}   {:6.2} {:5.1}",
                    ["x", "y"][axis],
                    gains.gain_margin,
                    gains.phase_margin_rad.to_degrees(),
                    measured.gain,
                    measured.phase_rad.to_degrees()
                );
            }
        }
    }
    Ok(())
}
