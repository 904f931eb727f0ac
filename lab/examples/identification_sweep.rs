//! Round trip: simulated machines cut the program of `excite`, and are identified from a log of it
//! with encoder steps of 1 um.
//!
//! Prints, for each machine, the errors of the identified products, how often 90 % intervals
//! contain the true value, and the prediction error after 100 ms. The first argument is the number
//! of logs per machine, or a range of them. Each log has its own noise and its own phase of the
//! disturbance.
//!
//!     cargo run --release -p feedwright-lab --example identification_sweep -- 11-12 tnv40 workshop stiff router

#![expect(clippy::print_stdout, reason = "it is a command")]

use feedwright::LogJob;
use feedwright_control::Uncorrected;
use feedwright_gcode::canon::Canon;
use feedwright_gcode::{Reader, Settings};
use feedwright_ident::{
    AxisFacts, ExciteOptions, FoundAxis, ModelTerm, ModelVerdict, excitation_program,
};
use feedwright_sim::{Axis, Machine, Row, Run, Sink, path_steps};

#[path = "../../crates/ident/tests/common/identification_log.rs"]
#[expect(dead_code, reason = "tests use more of it")]
mod identification_log;

type Failure = Box<dyn std::error::Error>;

/// Steps of the encoder, um.
const STEP_UM: f64 = 1.0;
/// A machine that is not built in: tnv40 with presliding, cogging and ripple.
const SLIDING: &str = "base = \"tnv40\"\nname = \"sliding\"
[axis.x]\npresliding_um = 10\nripple = 0.01\nripple_per_rev = 8\ncogging_nm = 0.05\ncogging_per_rev = 24
[axis.y]\npresliding_um = 10\nripple = 0.01\nripple_per_rev = 8\ncogging_nm = 0.05\ncogging_per_rev = 24\n";

/// Keeps the commands of a cut, mm.
#[derive(Default)]
struct Commands([Vec<f64>; 2]);

impl Sink for Commands {
    fn row(&mut self, row: &Row) -> std::io::Result<()> {
        let each = self.0.iter_mut().zip(row.cmd_mm);
        each.for_each(|(commands, mm)| commands.push(mm));
        Ok(())
    }
}

/// Commands of two axes while the program of `excite` is cut.
fn excited(machine: &Machine) -> Result<[Vec<f64>; 2], Failure> {
    let mut machine = machine.clone();
    machine.axes.truncate(2);
    let text = excitation_program(&machine, ExciteOptions::default())?.text;
    let read = Reader::from_text("excite.ngc", text, Settings::default())?;
    let canon: Result<Vec<Canon>, _> = read.collect();
    let canon = canon.map_err(|error| format!("{error:?}"))?;
    let (mut commands, steps) = (Commands::default(), || Ok(path_steps(canon.clone())));
    Run::on(&machine).cut::<2>(steps, &mut Uncorrected, &mut [&mut commands])?;
    Ok(commands.0)
}

/// Products of an axis: key, and what it is.
fn products(axis: &Axis) -> [(&'static str, f64); 4] {
    let (j, kv) = (axis.inertia_kg_m2, axis.kv_nm_s_per_rad);
    let friction_mm_s2 = axis.coulomb_friction_nm / j / axis.rad_per_mm();
    [
        ("kp_kv_over_j_1_s2", axis.kp_1_s * kv / j),
        (
            "kv_plus_b_over_j_1_s",
            (kv + axis.viscous_friction_nm_s) / j,
        ),
        ("fc_over_j_mm_s2", friction_mm_s2),
        ("velocity_feedforward", axis.velocity_feedforward),
    ]
}

/// Statistics of a product over all logs.
#[derive(Debug, Clone, Copy, Default)]
struct Seen {
    largest: f64,
    mean: f64,
    square: f64,
    half: f64,
    held: f64,
    logs: f64,
}

impl Seen {
    fn add(&mut self, found: &FoundAxis, (key, is): (&str, f64)) {
        let mut numbers = found.numbers().into_iter();
        let Some(number) = numbers.find(|number| number.key == key && is != 0.0) else {
            return;
        };
        let off = number.value / is - 1.0;
        let [low, high] = number.interval.unwrap_or([f64::NAN; 2]);
        self.largest = self.largest.max(off.abs());
        self.mean += off;
        self.square += off * off;
        self.half += 0.5 * (high - low) / is;
        self.held += f64::from(u8::from((low..=high).contains(&is)));
        self.logs += 1.0;
    }
}

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let logs = arguments.next().unwrap_or_else(|| "5".to_owned());
    let [first, last] = match logs.split_once('-') {
        Some((first, last)) => [first.parse::<u64>()?, last.parse()?],
        None => [1, logs.parse()?],
    };
    println!(
        "in %: error, largest, RMS and mean; half of an interval; intervals that hold.  um: left after 100 ms, at most"
    );
    println!(
        "machine  product                largest    RMS   mean   half   hold | after 100 ms, terms beside the base"
    );
    for name in arguments {
        let machine = match name.as_str() {
            "sliding" => Machine::parse("sliding.toml", SLIDING)?,
            name => Machine::load(name.as_ref())?,
        };
        let commands = excited(&machine)?;
        let mut seen = [Seen::default(); 4];
        let (mut worst_um, mut beside) = (0.0_f64, std::collections::BTreeMap::new());
        let (mut opened, mut holds) = (0, 0);
        for seed in first..=last {
            let log = identification_log::logged(&machine, commands.clone(), STEP_UM, seed);
            // The log has commands and positions of the same moments.
            let facts = AxisFacts {
                record_delay_s: Some(0.0),
                ..AxisFacts::default()
            };
            let job = LogJob {
                facts,
                ..LogJob::default()
            };
            let found = job.run(log, &())?;
            for (axis, is) in found.machine.axes.iter().zip(&machine.axes) {
                worst_um = worst_um.max(axis.scores.grey_box.at_um[2]);
                opened += u32::from(axis.unseen.is_open());
                holds += u32::from(ModelVerdict::of(axis) == ModelVerdict::ModelHolds);
                for term in axis
                    .terms
                    .iter()
                    .filter(|term| **term > ModelTerm::RecordDelay)
                {
                    *beside.entry(term.key()).or_insert(0) += 1;
                }
                for (seen, product) in seen.iter_mut().zip(products(is)) {
                    seen.add(axis, product);
                }
            }
        }
        let products = products(&machine.axes[0]);
        let took_s = commands[0].len() as f64 * machine.period.servo_s;
        for ((key, _), it) in products
            .iter()
            .zip(seen)
            .filter(|(_, seen)| seen.logs > 0.0)
        {
            let rms = 100.0 * (it.square / it.logs).sqrt();
            let [mean, half, held] = [it.mean, it.half, it.held].map(|sum| 100.0 * sum / it.logs);
            println!(
                "{name:<8} {key:<22} {:7.3} {rms:6.3} {mean:6.3} {half:6.3} {held:6.0} | {worst_um:5.2} {beside:?} {took_s:.1} s, holds {holds}, open {opened}",
                100.0 * it.largest
            );
        }
    }
    Ok(())
}
