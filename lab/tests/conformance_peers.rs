//! Every controller of the table does its job on the circle: it reduces the contour error, or
//! trades it for time.
//!
//! A controller that does nothing cuts as the uncorrected cut does, and fails here.

use feedwright::{BASELINE, Choices, Entry, Make, Setting, Setup, Statistics};
use feedwright_lab::{CONTROLLERS, Workpiece};
use feedwright_sim::{Axis, Machine, Run, Squareness};

/// Bounds on the result of a controller on a contour at 50 mm/s on tnv40, against uncorrected.
struct Held {
    name: &'static str,
    contour: &'static str,
    /// Values of its parameters; an empty list means the defaults.
    set: &'static [Setting],
    /// The largest RMS contour error.
    rms: f64,
    /// The machining time, from and to.
    time: [f64; 2],
}

/// Machining time at the planned feed: the command is the plan's.
const PLANNED: [f64; 2] = [1.0, 1.0];

const fn held(name: &'static str, rms: f64, time: [f64; 2]) -> Held {
    Held {
        name,
        contour: "circle",
        set: &[],
        rms,
        time,
    }
}

/// A contour error that cross-coupled control alone does not hold: it slows down throughout.
const STRICT: Setting = Setting {
    controller: "cross-coupled-feedrate",
    name: "allowed_mm",
    value: 1e-4,
};
const LARGEST_STEPS: Setting = Setting {
    controller: "magnitude-only",
    name: "eta",
    value: 10.0,
};

/// The RMS that was measured, with a half more, or twice that where little is left.
///
/// Feedforward with cross-coupled feedback and that with a Kalman filter are held to less than
/// feedforward alone has (0.019), and cross-coupled control that slows down to less than without
/// (0.024).
///
/// Two change the speed alone. The fuzzy rules pay for the error with time: 0.52 of it in 1.32 of
/// the time. The inversion of the speed saves time at the same error by default (0.963 at 1.013);
/// with steps as large as they may be it pays 1 % of time for 14 % of the error.
const HELD: &[Held] = &[
    held("cross-coupled", 0.05, PLANNED),
    held("contour-compensation", 0.16, PLANNED),
    held("fuzzy-feedrate", 0.7, [1.1, 1.5]),
    held("fuzzy-h-infinity", 0.023, [1.001, 1.02]),
    held("cross-coupled-feedrate", 0.05, [1.001, 1.02]),
    Held {
        name: "cross-coupled-feedrate",
        contour: "circle",
        set: &[STRICT],
        rms: 0.02,
        time: [2.0, 2.7],
    },
    Held {
        name: "corner-contour",
        contour: "square",
        set: &[],
        rms: 0.45,
        time: PLANNED,
    },
    held("constrained-feedrate", 0.6, [1.2, 1.7]),
    held("feedforward", 0.04, PLANNED),
    held("feedforward-as-delivered", 0.22, PLANNED),
    held("feedforward-cross-coupled", 0.018, PLANNED),
    held("input-shaping", 0.12, PLANNED),
    held("zero-phase", 0.22, PLANNED),
    held("zero-phase-friction", 0.04, PLANNED),
    held("disturbance-observer", 0.08, PLANNED),
    held("kalman-disturbance", 0.015, PLANNED),
    held("model-predictive", 0.005, PLANNED),
    held("lqg-preview", 0.0005, PLANNED),
    held("iterative-learning-1", 0.05, PLANNED),
    held("iterative-learning-3", 0.04, PLANNED),
    held("iterative-learning-10", 0.03, PLANNED),
    held("magnitude-only", 1.05, [0.9, 0.98]),
    Held {
        name: "magnitude-only",
        contour: "circle",
        set: &[LARGEST_STEPS],
        rms: 0.93,
        time: [1.001, 1.03],
    },
    held("two-dimensional", 0.15, [0.9, 0.98]),
    held("lqg-identified", 0.003, PLANNED),
];

/// RMS contour error, um, and machining time, s.
fn cut(machine: &Machine, entry: &Entry, set: &[Setting]) -> [f64; 2] {
    cut_contour(2, "circle", machine, entry, set)
}

fn cut_contour(
    axes: usize,
    contour: &str,
    machine: &Machine,
    entry: &Entry,
    set: &[Setting],
) -> [f64; 2] {
    let workpiece = Workpiece::contours()
        .into_iter()
        .find(|workpiece| workpiece.name == contour)
        .unwrap();
    let choices = Choices {
        set: set.to_vec(),
        ..Choices::default()
    };
    let mut setup = Setup::new(machine, &choices);
    let mut controller = entry.make(&mut setup, axes);
    let mut statistics = Statistics::new();
    let run = Run::on(machine)
        .laps(entry.laps)
        .cut_boxed_steps(&workpiece.steps, &mut controller, &mut [&mut statistics])
        .unwrap();
    assert!(run.faded_out.is_none(), "{}: {run:?}", entry.name);
    [statistics.rms_um(), run.time_s]
}

fn all_are_held(axes: usize) {
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    let mut failures = Vec::new();
    // Identifiers of two and of three axes are not the same: values that were chosen are so for the
    // plane.
    for Held {
        name,
        contour,
        set,
        rms,
        time,
    } in HELD.iter().filter(|held| axes == 2 || held.set.is_empty())
    {
        let [open_um, open_s] = cut_contour(
            axes,
            contour,
            &machine,
            CONTROLLERS.find(BASELINE).unwrap(),
            &[],
        );
        let [rms_um, time_s] = cut_contour(
            axes,
            contour,
            &machine,
            CONTROLLERS.find(name).unwrap(),
            set,
        );
        let (of_rms, of_time) = (rms_um / open_um, time_s / open_s);
        let what =
            format!("{name} {set:?}: RMS {of_rms:.4} of the uncorrected cut's, time {of_time:.4}");
        println!("{what}");
        let [shortest, longest] = *time;
        // Rounding of the instant at which the plan ends.
        if of_rms > *rms || !(shortest - 1e-9..=longest + 1e-9).contains(&of_time) {
            failures.push(format!("{what}; held to {rms} and {time:?}"));
        }
    }
    assert!(failures.is_empty(), "{axes} axes:\n{}", failures.join("\n"));
}

#[test]
fn every_controller_does_in_the_plane_what_it_is_there_for() {
    all_are_held(2);
}

#[test]
fn every_controller_does_in_space_what_it_is_there_for() {
    all_are_held(3);
}

#[test]
fn no_controller_is_left_out() {
    for entry in CONTROLLERS.iter().filter(|entry| entry.name != BASELINE) {
        assert!(
            HELD.iter().any(|held| held.name == entry.name),
            "{} is not held to anything",
            entry.name
        );
    }
}

/// Returns `workshop` with its drives, friction and delays, but without noise, disturbance and
/// geometry errors, which no controller can know. A peer then leaves only the part of the
/// uncorrected error that comes from what it does not know of the machine, or does not use.
fn drive_of_workshop() -> Machine {
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../crates/sim/machines/workshop.toml");
    let mut machine = Machine::read(&file).unwrap();
    machine.geometry = Squareness::default();
    for axis in &mut machine.axes {
        *axis = Axis {
            encoder_step_um: 0.0,
            encoder_noise_um: 0.0,
            interpolation_error_um: 0.0,
            cogging_nm: 0.0,
            ripple: 0.0,
            torque_noise_nm: 0.0,
            disturbance_nm: 0.0,
            disturbance_wander: 0.0,
            scale_um_m: 0.0,
            pitch_error_um: 0.0,
            ..*axis
        };
    }
    machine
}

/// Largest parts of the uncorrected RMS on that machine. Measured: feedforward 0.0006, the limit
/// 0.0004, model-predictive 0.0001; Kalman filter and observer 0.06 and 0.11, which know nothing of
/// the torque filter; the shaper rounds the circle by 1.2 um, 0.2. Zero phase leaves the friction:
/// 0.17; with that fed forward 0.01.
const HELD_ON_WORKSHOP: &[(&str, f64)] = &[
    ("feedforward", 0.01),
    ("zero-phase", 0.25),
    ("zero-phase-friction", 0.02),
    ("kalman-disturbance", 0.1),
    ("disturbance-observer", 0.2),
    ("input-shaping", 0.3),
];

#[test]
fn what_drives_do_by_themselves_is_not_done_twice_and_what_they_do_late_is_done_ahead() {
    let mut machine = drive_of_workshop();
    for (measurement_delay_s, acceleration_feedforward) in [(0.0, 0.0), (0.001, 0.0), (0.0004, 0.5)]
    {
        for axis in &mut machine.axes {
            *axis = Axis {
                measurement_delay_s,
                acceleration_feedforward,
                ..*axis
            };
        }
        let [open_um, _] = cut(&machine, CONTROLLERS.find(BASELINE).unwrap(), &[]);
        for (name, held) in HELD_ON_WORKSHOP {
            let [rms_um, _] = cut(&machine, CONTROLLERS.find(name).unwrap(), &[]);
            let what = format!(
                "{name}, {measurement_delay_s} s, {acceleration_feedforward}: {rms_um:.4} of {open_um:.4} um"
            );
            println!("{what}");
            assert!(rms_um < held * open_um, "{what}");
        }
    }
}

#[test]
fn where_drives_feed_forward_by_themselves_as_delivered_is_uncorrected() {
    let machine = drive_of_workshop();
    let cut = |name| cut(&machine, CONTROLLERS.find(name).unwrap(), &[]);
    assert_eq!(cut("feedforward-as-delivered"), cut(BASELINE));
}

fn combined() -> Machine {
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../examples/03_realism/machines/combined.toml");
    Machine::read(&file).unwrap()
}

/// Largest part of the RMS of feedforward with cross-coupled feedback under noise. Measured on the
/// circle: 0.21.
const LIMIT_OF_FEEDBACK: f64 = 0.3;

#[test]
fn the_limit_is_below_all_others_under_noise() {
    let machine = combined();
    let [limit_um, _] = cut(&machine, CONTROLLERS.find("lqg-preview").unwrap(), &[]);
    for name in [
        "feedforward",
        "feedforward-cross-coupled",
        "kalman-disturbance",
        "model-predictive",
    ] {
        let [rms_um, _] = cut(&machine, CONTROLLERS.find(name).unwrap(), &[]);
        println!("{name} {rms_um}, limit {limit_um}");
        assert!(
            limit_um < LIMIT_OF_FEEDBACK * rms_um,
            "{name}: {limit_um} of {rms_um} um"
        );
    }
}

#[test]
fn without_noise_the_limit_is_no_worse_than_feedforward() {
    let mut machine = Machine::load("tnv40".as_ref()).unwrap();
    machine
        .axes
        .iter_mut()
        .for_each(|axis| axis.disturbance_nm = 0.0);
    for machine in [machine, drive_of_workshop()] {
        let [limit_um, feedforward_um] = ["lqg-preview", "feedforward"]
            .map(|name| cut(&machine, CONTROLLERS.find(name).unwrap(), &[])[0]);
        println!("{}: {limit_um} {feedforward_um}", machine.name);
        assert!(
            limit_um <= feedforward_um,
            "{}: {limit_um}, feedforward {feedforward_um} um",
            machine.name
        );
    }
}
