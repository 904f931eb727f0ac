//! Commands of a program as the member `linuxcnc` plans it, one row for each servo period:
//!
//!     linuxcnc_planner PART.ngc [VELOCITY,ACCEL VELOCITY,ACCEL VELOCITY,ACCEL]
//!
//! Positions in mm on standard output, the time of all motion on standard error. Limits of X, Y, Z
//! in mm/s and mm/s2; without them 200 and 2000, those of the configuration that
//! `linuxcnc/tests/planner.py` runs the real LinuxCNC with.

use std::io::Write;

use feedwright_gcode::{Reader, Settings};
use feedwright_plan::{
    AxisLimits, AxisMotion, Constraints, PathLimits, Plan, Planned, Plc, feed_planner,
};
use feedwright_sim::path_steps;

const PERIOD_S: f64 = 1e-3;

/// Earlier than a servo period by this is within it.
const ROUNDING_S: f64 = 1e-9;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let part = args.next().ok_or("which program?")?;
    let mut axes = Vec::new();
    for text in args {
        let (velocity, accel) = text.split_once(',').ok_or("limits are VELOCITY,ACCEL")?;
        let (velocity_mm_s, accel_mm_s2) = (velocity.parse()?, accel.parse()?);
        axes.push(AxisLimits {
            velocity_mm_s,
            accel_mm_s2,
            jerk_mm_s3: 1e9,
        });
    }
    if axes.is_empty() {
        axes = vec![
            AxisLimits {
                velocity_mm_s: 200.0,
                accel_mm_s2: 2000.0,
                jerk_mm_s3: 1e9
            };
            3
        ];
    }
    let path = PathLimits {
        rapid_mm_s: 200.0,
        max_feed_mm_s: 200.0,
        tangential_accel_mm_s2: 2000.0,
        normal_accel_mm_s2: 2000.0,
        corner_jump_mm_s: 0.0,
    };
    let constraints = Constraints {
        axes,
        path_tolerance_mm: Some(0.01),
        ..Constraints::from(&path)
    };
    let reader = Reader::open(part.as_ref(), Settings::default())?;
    let steps = path_steps(reader.map_while(Result::ok));
    let member = feed_planner("linuxcnc").ok_or("no such planner")?;
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    let (mut rows, mut end_s, mut last) = (0_u32, 0.0, AxisMotion::REST);
    let mut row = |motion: AxisMotion| {
        let [x, y, z] = motion.position_mm;
        writeln!(out, "{x:.7},{y:.7},{z:.7}")
    };
    for planned in Plan::new(steps, &constraints, member, Plc::default())? {
        let Planned::Phase(phase) = planned else {
            continue;
        };
        let motion = phase.motion.unwrap_or(last);
        end_s = phase.tau_s + phase.duration_s;
        while f64::from(rows) * PERIOD_S < end_s - ROUNDING_S {
            row(motion.after((f64::from(rows) * PERIOD_S - phase.tau_s).max(0.0)))?;
            rows += 1;
        }
        last = AxisMotion {
            position_mm: motion.after(phase.duration_s).position_mm,
            ..AxisMotion::REST
        };
    }
    row(last)?;
    eprintln!("{end_s:.4}");
    Ok(())
}
