//! A log of a simulated machine: moves between random places, at random speeds, with reversals,
//! creeping and standstill.

use feedwright_ident::{Fitness, Log, LogAxis, LogFormat, TorqueUnit};
use feedwright_sim::Machine;

/// Random numbers from 0 to 1: a generator of Lehmer's kind suffices to draw moves.
pub(crate) fn drawn(state: &mut u64) -> f64 {
    *state = state
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

/// Commands of moves of trapezoidal speed, mm, one a servo period.
pub(crate) fn commands_mm(servo_s: f64, time_s: f64, seed: u64) -> Vec<f64> {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(12345);
    let samples = (time_s / servo_s) as usize;
    let (mut at_mm, mut way) = (0.0_f64, vec![]);
    while way.len() < samples {
        // From creeping to 60 mm/s, evenly in the logarithm; turned back towards zero.
        let speed = 60.0 * 0.02_f64.powf(drawn(&mut state));
        let time = 0.1 + 0.5 * drawn(&mut state);
        let direction = if drawn(&mut state) < 0.5 + 0.02 * at_mm {
            -1.0
        } else {
            1.0
        };
        let accelerate = (speed / 600.0_f64).min(0.5 * time);
        let steps = (time / servo_s) as usize;
        for k in 0..steps {
            let t = k as f64 * servo_s;
            let part = (t / accelerate)
                .min((time - t) / accelerate)
                .clamp(0.0, 1.0);
            at_mm += direction * speed * part * servo_s;
            way.push(at_mm);
        }
        if drawn(&mut state) < 0.2 {
            way.extend(std::iter::repeat_n(at_mm, (0.1 / servo_s) as usize));
        }
    }
    way.truncate(samples);
    way
}

/// The log of a machine's first two axes under moves that are drawn, actual positions in steps, um,
/// as they are when a command is given.
pub(crate) fn log_of(machine: &Machine, time_s: f64, step_um: f64, seed: u64) -> Log {
    let servo_s = machine.period.servo_s;
    logged(
        machine,
        [
            commands_mm(servo_s, time_s, 2 * seed),
            commands_mm(servo_s, time_s, 2 * seed + 1),
        ],
        step_um,
        seed,
    )
}

/// Servo periods that are let go by, for each seed, before a log begins: a disturbance then has
/// another phase.
const PERIODS_LATER: u64 = 17;

/// The same under given commands, mm.
pub(crate) fn logged(machine: &Machine, commands: [Vec<f64>; 2], step_um: f64, seed: u64) -> Log {
    let servo_s = machine.period.servo_s;
    let mut plant = feedwright_sim::Plant::<2>::with_seed(machine, [0.0; 2], seed);
    plant.skip(PERIODS_LATER * seed);
    let mut actual = [vec![], vec![]];
    let mut now_mm = [0.0; 2];
    let step_mm = 1e-3 * step_um;
    for k in 0..commands[0].len() {
        for axis in 0..2 {
            let shown = if step_mm > 0.0 {
                (now_mm[axis] / step_mm).round() * step_mm
            } else {
                now_mm[axis]
            };
            actual[axis].push(shown);
        }
        now_mm = plant.step([commands[0][k], commands[1][k]]).measured_mm;
    }
    let samples = commands[0].len();
    let axes =
        ["x", "y"]
            .into_iter()
            .zip(commands)
            .zip(actual)
            .map(|((name, command_mm), actual_mm)| LogAxis {
                name: name.to_owned(),
                command_mm,
                actual_mm,
                torque: None,
                torque_unit: TorqueUnit::Unknown,
                step_mm,
                verdict: Fitness::ForControl,
            });
    Log {
        format: LogFormat::TextTable,
        sample_time_s: servo_s,
        stretches: std::iter::once(0..samples).collect(),
        time_s: (0..samples).map(|k| k as f64 * servo_s).collect(),
        axes: axes.collect(),
        still: vec![],
        findings: vec![],
    }
}
