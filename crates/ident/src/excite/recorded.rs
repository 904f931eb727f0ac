//! The log that a recorder beside a simulated machine writes while it cuts a program uncorrected.

use std::fmt::Write;

use feedwright_gcode::{Program, Settings};
use feedwright_sim::{AXIS_NAMES, Machine, Plant, RunError, Stages, joints_of, path_steps};

/// Rest that is recorded after the end, s: oscillations are recorded until they have decayed.
const REST_S: f64 = 0.3;

/// Returns the lines that `halsampler -t` would write of the first N axes: the command and the
/// position that the encoders show, mm, both sampled at the same moment, once a servo period.
///
/// # Errors
/// Fails if a program cannot be read, or if the machine has no plan.
pub fn recorded_log<const N: usize>(
    machine: &Machine,
    program: &Program,
) -> Result<String, RunError> {
    let steps = program.reader(Settings::default())?.map_while(Result::ok);
    let mut reference = Stages::of(machine).reference(path_steps(steps), machine)?;
    let mut seen_mm: [f64; N] = joints_of(reference.at(0.0).position_mm);
    let mut plant = Plant::<N>::new(machine, seen_mm);
    let servo_s = machine.period.servo_s;
    let columns = AXIS_NAMES[..N]
        .iter()
        .map(|name| format!("{name}.cmd {name}.act"));
    let mut log = format!(
        "# sample_time_s = {servo_s}\n# n {}\n",
        columns.collect::<Vec<_>>().join(" ")
    );
    for n in 0_u32.. {
        let t_s = f64::from(n) * servo_s;
        let command_mm: [f64; N] = joints_of(reference.at(t_s).position_mm);
        if reference.end_s().is_some_and(|end_s| t_s > end_s + REST_S) {
            break;
        }
        reference.forget_before(t_s);
        // Writing to a string cannot fail.
        let _ = write!(log, "{n}");
        for (command_mm, seen_mm) in command_mm.iter().zip(seen_mm) {
            let _ = write!(log, " {command_mm:.6} {seen_mm:.6}");
        }
        log.push('\n');
        seen_mm = plant.step(command_mm).measured_mm;
    }
    Ok(log)
}
