//! `feedwright run --tolerance UM --fastest`: what it prints, what bounds it, and what it says
//! where there is no such plan.

use crate::command::{Folder, Ran};

const LIMITS: &str = "max_velocity_mm_s = 200\nmax_accel_mm_s2 = 2000\nmax_jerk_mm_s3 = 50000\n";

/// The paper's machine with limits of its axes, without a tolerance of the path; what else its axes
/// have.
fn folder(axes_have: &str) -> Folder {
    let folder = Folder::new();
    let axes = ["x", "y", "z"]
        .map(|axis| format!("[axis.{axis}]\n{LIMITS}{axes_have}"))
        .concat();
    let head = "base = \"tnv40\"\nname = \"m\"\ndescription = \"d\"\nsource = \"s\"\n";
    folder.file("m.toml", format!("{head}{axes}"));
    folder
}

fn fastest(folder: &Folder, arguments: &[&str]) -> Ran {
    let all: Vec<&str> = ["circle.ngc", "--machine", "m.toml", "--fastest"]
        .iter()
        .chain(arguments)
        .copied()
        .collect();
    folder.run_uncorrected(&all)
}

/// The number behind a word.
fn number(ran: &Ran, before: &str) -> f64 {
    let (_, rest) = ran
        .stdout
        .split_once(before)
        .unwrap_or_else(|| panic!("no {before} in {}", ran.stdout));
    rest.split_whitespace().next().unwrap().parse().unwrap()
}

#[test]
fn it_reports_time_bound_error_and_what_binds() {
    let folder = folder("");
    let ran = fastest(&folder, &["--tolerance", "50"]).succeeded();
    let (time_s, error_um) = (number(&ran, "least time: "), number(&ran, "largest error "));
    assert!(error_um <= 50.0 && time_s >= 12.56 / 20.0, "{}", ran.stdout);
    for reported in [
        "s for a tool without error, motion ",
        "um are the path's",
        "feedrate ",
        "% of the motion",
        "within tolerance",
    ] {
        assert!(
            ran.reported().contains(reported),
            "{reported} in {}",
            ran.stdout
        );
    }
    assert!(
        folder
            .text("circle.report.html")
            .contains("What binds along the path")
    );
}

#[test]
fn the_programmed_feedrate_is_the_ceiling_and_feed_raises_it() {
    let folder = folder("");
    let time_s =
        |arguments: &[&str]| number(&fastest(&folder, arguments).succeeded(), "least time: ");
    let programmed_s = time_s(&["--tolerance", "100"]);
    let raised_s = time_s(&["--tolerance", "100", "--feed", "40mm/s"]);
    assert!(raised_s < 0.8 * programmed_s, "{raised_s} {programmed_s}");
    // A smaller tolerance costs time where the feedrate does not bind.
    let tight_s = time_s(&["--tolerance", "20", "--feed", "40mm/s"]);
    assert!(tight_s > 1.05 * raised_s, "{tight_s} {raised_s}");
}

/// The tool is about 12 um off at any speed with 20 um of encoder noise. The search notices that
/// before it slows down.
#[test]
fn what_no_speed_brings_within_the_tolerance_is_reported_with_its_line_and_nothing_is_written() {
    let folder = folder("encoder_noise_um = 20\n");
    folder.file(
        "small.ngc",
        "G21 G90 G64\nG0 X0 Y0\nG2 X0 Y0 I1 J0 F3000\nM2\n",
    );
    let before = folder.content();
    let ran = folder.run_uncorrected(&[
        "small.ngc",
        "--machine",
        "m.toml",
        "--fastest",
        "--tolerance",
        "5",
    ]);
    ran.faulty(&[
        "small.ngc",
        "line 3",
        "5 um are allowed",
        "no matter of speed",
    ]);
    assert_eq!(folder.content(), before);
}

#[test]
fn it_needs_a_tolerance_and_reports_which_limits_of_the_axes_it_assumes() {
    let folder = folder("");
    let run = |arguments: &[&str]| {
        folder.run_uncorrected(&[&["circle.ngc", "--fastest"], arguments].concat())
    };
    let ran = run(&["--machine", "tnv40", "--tolerance", "400"]).succeeded();
    let remarked = ran.remarked();
    assert!(
        remarked.contains("tnv40 has no limits of its axes") && remarked.contains("max_jerk_mm_s3"),
        "{ran:?}"
    );
    run(&["--machine", "m.toml"]).refused(&["--tolerance"]);
}
