//! The member `linuxcnc` against LinuxCNC 2.9 itself: machining time, and commands of the same
//! servo period.
//!
//! `linuxcnc/tests/planner.py --record` ran the programs of `oracle_data/linuxcnc_planner` in
//! Debian's LinuxCNC 2.9.0~pre1 (1 kHz, 200 mm/s and 2000 mm/s2 of every axis, `MAX_FEED_OVERRIDE`
//! 2) and wrote beside each the number of servo periods and every 20th command. Recordings have six
//! decimals.

use std::path::{Path, PathBuf};

use feedwright_gcode::{Reader, Settings};
use feedwright_plan::{
    AxisLimits, AxisMotion, Constraints, FeedMember, PathLimits, Plan, Planned, Plc, feed_planner,
};
use feedwright_sim::path_steps;

const PERIOD_S: f64 = 1e-3;
/// The recording keeps one command out of this number.
const KEPT: usize = 20;
/// Half a unit of the last decimal that is recorded, in each axis, and rounding of sums over some
/// thousand periods.
const SAME_MM: f64 = 2e-6;
/// The same where radii are rounded: the path has arcs in place of a spiral, and the spiral is
/// found again from those.
const SAME_SPIRAL_MM: f64 = 3e-4;

fn constraints() -> Constraints {
    let path = PathLimits {
        rapid_mm_s: 200.0,
        max_feed_mm_s: 200.0,
        tangential_accel_mm_s2: 2000.0,
        normal_accel_mm_s2: 2000.0,
        corner_jump_mm_s: 0.0,
    };
    let axis = AxisLimits {
        velocity_mm_s: 200.0,
        accel_mm_s2: 2000.0,
        jerk_mm_s3: 1e9,
    };
    Constraints {
        axes: vec![axis; 3],
        path_tolerance_mm: Some(0.01),
        ..Constraints::from(&path)
    }
}

/// Commands of all servo periods.
fn commands(program: &Path, member: &FeedMember) -> Vec<[f64; 3]> {
    let constraints = constraints();
    let reader = Reader::open(program, Settings::default()).unwrap();
    let steps = path_steps(reader.map(Result::unwrap));
    let (mut rows, mut last) = (Vec::new(), AxisMotion::REST);
    for planned in Plan::new(steps, &constraints, member, Plc::default()).unwrap() {
        let Planned::Phase(phase) = planned else {
            continue;
        };
        let motion = phase.motion.unwrap_or(last);
        while rows.len() as f64 * PERIOD_S < phase.tau_s + phase.duration_s - 1e-9 {
            rows.push(
                motion
                    .after((rows.len() as f64 * PERIOD_S - phase.tau_s).max(0.0))
                    .position_mm,
            );
        }
        last = AxisMotion {
            position_mm: motion.after(phase.duration_s).position_mm,
            ..AxisMotion::REST
        };
    }
    rows.push(last.position_mm);
    rows
}

/// Programs, the number of their servo periods, and commands of LinuxCNC.
fn recordings() -> Vec<(PathBuf, usize, Vec<[f64; 3]>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/oracle_data/linuxcnc_planner");
    let mut programs: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    programs.retain(|file| file.extension().is_some_and(|extension| extension == "ngc"));
    programs.sort();
    let read = |program: PathBuf| {
        let text = std::fs::read_to_string(program.with_extension("csv")).unwrap();
        let mut lines = text.lines();
        let periods = lines.next().unwrap().parse().unwrap();
        let point = |line: &str| {
            let values: Vec<f64> = line
                .split(',')
                .map(|value| value.parse().unwrap())
                .collect();
            [values[0], values[1], values[2]]
        };
        (program, periods, lines.map(point).collect())
    };
    programs.into_iter().map(read).collect()
}

#[test]
fn commands_are_those_of_linuxcnc() {
    let recordings = recordings();
    assert!(recordings.len() >= 10, "{}", recordings.len());
    for (program, periods, theirs) in recordings {
        let name = program.file_stem().unwrap().display();
        let ours = commands(&program, feed_planner("linuxcnc").unwrap());
        assert_eq!(ours.len() - 1, periods, "{name}");
        let same_mm = if name.to_string() == "arcs_rounded" {
            SAME_SPIRAL_MM
        } else {
            SAME_MM
        };
        for (i, theirs) in theirs.iter().enumerate() {
            let ours = ours[KEPT * i];
            let away_mm = (0..3)
                .map(|k| (ours[k] - theirs[k]).abs())
                .fold(0.0, f64::max);
            assert!(
                away_mm < same_mm,
                "{name}, period {}: {ours:?} {theirs:?}",
                KEPT * i
            );
        }
    }
}

/// Seconds of a program of one square, `20 mm` a side.
fn square_s(modes: &str) -> f64 {
    let program = format!("G21 G90 {modes} F12000\nG1 X20\nY20\nX0\nY0\nM2\n");
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("square.ngc");
    std::fs::write(&file, program).unwrap();
    (commands(&file, feed_planner("linuxcnc").unwrap()).len() - 1) as f64 * PERIOD_S
}

/// Checks the times of LinuxCNC's path modes: they are not what one would expect, and are its own.
#[test]
fn g61_is_slower_than_g61_1_and_g64_may_be_slower_than_both() {
    let [stop, path, tight, loose, none] =
        ["G61.1", "G61", "G64 P0.01", "G64 P1", "G64"].map(square_s);
    assert!(
        (stop - 0.802).abs() < 1e-9 && (path - 0.846).abs() < 1e-9,
        "{stop} {path}"
    );
    assert!(
        (tight - 0.880).abs() < 1e-9 && (none - 0.613).abs() < 1e-9,
        "{tight} {none}"
    );
    assert!(none < loose && loose < stop, "{none} {loose} {stop}");
}
