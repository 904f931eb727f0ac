//! Round trip: machines of the table, simulated, logged and identified. How far the products come out, and how often intervals of 90 % hold.
//!
//!     cargo run --release -p feedwright --example identification_sweep -- 5 tnv40 heavy sticky soft coarse

#[path = "../tests/common/identification_log.rs"]
mod identification_log;

use feedwright::identify::grey_box::found_axis::FoundAxis;
use feedwright::log_job::LogJob;
use feedwright::machine::{Axis, Machine};

/// Time of a log, s, and steps of its encoder, um.
const TIME_S: f64 = 20.0;
const STEP_UM: f64 = 1.0;

/// Products of an axis: key, and what it is.
fn products(axis: &Axis) -> [(&'static str, f64); 3] {
    let j = axis.inertia_kg_m2;
    [
        ("kp_kv_over_j_1_s2", axis.kp_1_s * axis.kv_nm_s_per_rad / j),
        ("kv_plus_b_over_j_1_s", (axis.kv_nm_s_per_rad + axis.viscous_friction_nm_s) / j),
        ("fc_over_j_mm_s2", axis.coulomb_friction_nm / j / axis.rad_per_mm()),
    ]
}

/// How far a product is off, part of it, and whether its interval holds it.
fn judged(found: &FoundAxis, (key, is): (&str, f64)) -> Option<(f64, bool)> {
    let number = found.numbers().into_iter().find(|number| number.key == key)?;
    let holds = number.interval.is_some_and(|[low, high]| (low..=high).contains(&is));
    Some((number.value / is - 1.0, holds))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let repeats: u64 = arguments.next().map_or(Ok(5), |text| text.parse())?;
    println!("machine, product, largest error %, intervals that hold %, 100 ms um, terms beside the base");
    for name in arguments {
        let machine = Machine::load(name.as_ref())?;
        let mut seen = [(0.0_f64, 0_u32, 0_u32); 3];
        let (mut worst_um, mut beside) = (0.0_f64, 0);
        for seed in 1..=repeats {
            let log = identification_log::log_of(&machine, TIME_S, STEP_UM, seed);
            let found = LogJob::default().run(log, &())?;
            for (axis, is) in found.machine.axes.iter().zip(&machine.axes) {
                worst_um = worst_um.max(axis.scores.grey_box.at_um[2]);
                beside = beside.max(axis.terms.len() - 5);
                for (seen, product) in seen.iter_mut().zip(products(is)) {
                    if let Some((off, holds)) = judged(axis, product) {
                        *seen = (seen.0.max(off.abs()), seen.1 + u32::from(holds), seen.2 + 1);
                    }
                }
            }
        }
        for ((key, _), (off, held, all)) in products(&machine.axes[0]).iter().zip(seen) {
            let held = 100.0 * f64::from(held) / f64::from(all.max(1));
            println!("{name:<8} {key:<22} {:8.3} {held:8.0} {worst_um:8.2} {beside}", 100.0 * off);
        }
    }
    Ok(())
}
