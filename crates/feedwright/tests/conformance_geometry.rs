//! The geometry that is compensated: what it leaves at the tool, and what is refused.

use serde_json::Value;

use crate::command::Folder;

const STAR: &str = include_str!("../../../parts/star.ngc");
/// The errors of workshop as they are measured, with standard deviations.
const MEASURED: &str = "format = 1\nsource = \"a grid encoder\"\n\n[axis.x]\nscale_um_m = 20\nscale_std_um_m = 2\npitch_error_um = 2\n\
     pitch_error_std_um = 0.1\nlead_mm_per_rev = 10\nfrom_mm = -100\nto_mm = 100\n\n[axis.y]\nscale_um_m = -15\nscale_std_um_m = 2\n\
     pitch_error_um = 2\nlead_mm_per_rev = 10\n\n[geometry]\nsquareness_xy_urad = 20\n";

/// RMS error of the second run, um: at the tool and by the encoders; and what is compensated.
fn rms_um(folder: &Folder, more: &[&str]) -> ([f64; 2], Value) {
    let run = ["run", "star.ngc", "--exact-settings", "--json", "r.json"];
    folder.run(&[&run[..], more].concat()).succeeded();
    let result: Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
    let of = |key: &str| result["runs"][1][key].as_f64().unwrap();
    (
        [of("rms_um"), of("joint_rms_um")],
        result["geometry"].clone(),
    )
}

/// The remaining error at the tool equals the error of the loops by the encoders.
#[test]
fn the_geometry_of_the_machine_file_is_compensated_unless_that_is_turned_off() {
    let folder = Folder::new();
    folder.file("star.ngc", STAR);
    let ([tool_um, encoders_um], geometry) = rms_um(&folder, &[]);
    assert_eq!(
        geometry["terms"],
        serde_json::json!(["scale", "pitch", "squareness"])
    );
    assert!(
        (tool_um - encoders_um).abs() < 1e-6,
        "{tool_um} {encoders_um}"
    );
    let ([off_um, by_encoders_um], geometry) = rms_um(&folder, &["--no-geometry"]);
    assert!(geometry.is_null());
    assert!(
        tool_um < 0.3 * off_um && by_encoders_um < 1.5 * tool_um,
        "{tool_um} {off_um} {by_encoders_um}"
    );
}

/// Needs 9 s of processor time: identifies a machine and cuts the star twice.
///
/// Windup and backlash of the thin screws of `router`.
#[test]
fn the_lost_motion_of_a_machine_with_backlash_is_compensated() {
    let folder = Folder::new();
    folder.file("star.ngc", STAR);
    // Its own acceleration leaves no room for what makes up for its friction, and most of the error
    // is then that.
    let axes =
        ["x", "y", "z"].map(|axis| format!("[axis.{axis}]\ncorrection_accel_mm_s2 = 200000\n"));
    folder.file(
        "quick.toml",
        format!("base = \"router\"\nname = \"quick\"\n{}", axes.concat()),
    );
    let ([with_um, _], geometry) = rms_um(&folder, &["--machine", "quick.toml"]);
    assert_eq!(geometry["terms"], serde_json::json!(["backlash"]));
    let ([without_um, _], _) = rms_um(&folder, &["--machine", "quick.toml", "--no-geometry"]);
    assert!(with_um < 0.7 * without_um, "{with_um} {without_um}");
}

/// Needs 8 s of processor time: cuts the star twice.
#[test]
fn a_geometry_file_takes_the_place_of_the_machine_file_and_is_as_good_as_it_says() {
    let folder = Folder::new();
    folder.file("star.ngc", STAR);
    folder.file("geometry.toml", MEASURED);
    let ([tool_um, encoders_um], geometry) = rms_um(&folder, &["--geometry", "geometry.toml"]);
    assert!(
        (tool_um - encoders_um).abs() < 1e-6,
        "{tool_um} {encoders_um}"
    );
    assert_eq!(geometry["from"], "geometry.toml");
    // At most 2 um/m over the 100 mm of both axes, and 0.1 um of pitch.
    let [spread_um, most_um] =
        ["spread_rms_um", "spread_max_um"].map(|key| geometry[key].as_f64().unwrap());
    assert!(
        0.01 < spread_um && spread_um < most_um && most_um < 0.3,
        "{spread_um} {most_um}"
    );
    // The file is the truth of the simulation, too: with other signs the cut is as good.
    let other = MEASURED.replace("scale_um_m = -15", "scale_um_m = 15");
    folder.file(
        "other.toml",
        other.replace(
            "pitch_error_um = 2\n",
            "pitch_error_um = 2\npitch_phase_deg = 180\n",
        ),
    );
    let ([other_um, by_encoders_um], _) = rms_um(&folder, &["--geometry", "other.toml"]);
    assert!(
        (other_um - by_encoders_um).abs() < 1e-6,
        "{other_um} {by_encoders_um}"
    );
}

/// Errors of a square and a circle, um: RMS and largest, before and behind a correction.
fn corrected_um(folder: &Folder, more: &[&str]) -> [[f64; 2]; 2] {
    let correct = [
        "correct",
        "part.ngc",
        "--for",
        "grbl",
        "--file-error",
        "0",
        "--json",
        "c.json",
        "--out",
        "c.ngc",
    ];
    folder.run(&[&correct[..], more].concat()).succeeded();
    let result: Value = serde_json::from_slice(&folder.read("c.json")).unwrap();
    ["uncorrected", "as_exported"]
        .map(|of| ["rms_um", "max_um"].map(|key| result[of][key].as_f64().unwrap()))
}

/// Needs 6 s of processor time: corrects a program six times.
///
/// The same values in the machine file and in a geometry file give the same figures.
#[test]
fn a_geometry_file_is_the_truth_of_the_simulation() {
    let folder = Folder::new();
    folder.file(
        "part.ngc",
        "G21 G90 G64\nG0 X0 Y0\nG1 X20 F1500\nY20\nX0\nY0\nG0 X40 Y10\nG2 X40 Y10 I-6 J0\nM2\n",
    );
    let head = "base = \"tnv40\"\nname = \"tnv40\"\ndescription = \"tnv40 with a geometry\"\nsource = \"a test\"\n";
    for errors in [
        "[geometry]\nsquareness_xy_urad = 800\n",
        "[axis.x]\nscale_um_m = 600\n[axis.y]\nscale_um_m = -600\n",
        "[axis.y]\npitch_error_um = 6\nlead_mm_per_rev = 10\n",
    ] {
        folder.file("machine.toml", format!("{head}{errors}"));
        folder.file(
            "geometry.toml",
            format!("format = 1\nsource = \"a grid\"\n{errors}"),
        );
        let by_file = corrected_um(
            &folder,
            &["--machine", "tnv40", "--geometry", "geometry.toml"],
        );
        let by_machine = corrected_um(&folder, &["--machine", "machine.toml"]);
        assert!(by_file[1][0] < 0.5 * by_file[0][0], "{errors}{by_file:?}");
        for (by_file, by_machine) in by_file.as_flattened().iter().zip(by_machine.as_flattened()) {
            assert!(
                (by_file - by_machine).abs() < 1e-6,
                "{errors}{by_file} {by_machine}"
            );
        }
        // The program compensates the geometry by itself, and `run` shows what `correct` did.
        let run = [
            "run",
            "c.ngc",
            "--reference",
            "part.ngc",
            "--controller",
            "uncorrected",
            "--exact-settings",
        ];
        folder
            .run(
                &[
                    &run[..],
                    &["--machine", "machine.toml", "--json", "own.json"],
                ]
                .concat(),
            )
            .succeeded();
        let more = [
            "--machine",
            "tnv40",
            "--geometry",
            "geometry.toml",
            "--json",
            "file.json",
        ];
        folder.run(&[&run[..], &more].concat()).succeeded();
        let rms_um = |file: &str| {
            let result: Value = serde_json::from_slice(&folder.read(file)).unwrap();
            result["runs"][0]["rms_um"].as_f64().unwrap()
        };
        assert!(
            (rms_um("file.json") - rms_um("own.json")).abs() < 1e-6,
            "{errors}"
        );
    }
}

/// Needs 23 s of processor time: two searches for the best feedrate cut the circle many times.
///
/// `advise` and `plan` find the same feedrates by the machine file and by a geometry file.
#[test]
fn advice_and_plans_take_a_geometry_file_for_the_truth() {
    let folder = Folder::new();
    folder.file(
        "part.ngc",
        "G21 G90 G64\nG0 X0 Y0\nG2 X0 Y0 I2 J0 F1500\nM2\n",
    );
    let head = "base = \"tnv40\"\nname = \"tnv40\"\ndescription = \"tnv40 with a geometry\"\nsource = \"a test\"\n";
    let errors = "[geometry]\nsquareness_xy_urad = 800\n";
    folder.file("machine.toml", format!("{head}{errors}"));
    folder.file(
        "geometry.toml",
        format!("format = 1\nsource = \"a grid\"\n{errors}"),
    );
    let found = |command: &[&str], machine: &[&str]| {
        let json = ["part.ngc", "--tolerance", "20", "--json", "r.json"];
        folder.run(&[command, &json, machine].concat());
        let mut result: Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
        result.as_object_mut().unwrap().remove("geometry");
        result
    };
    let (own, file) = (
        ["--machine", "machine.toml"],
        ["--machine", "tnv40", "--geometry", "geometry.toml"],
    );
    let advise = ["advise", "--controller", "feedforward", "--file-error", "0"];
    let [by_machine, by_file] =
        [&own[..], &file].map(|machine| found(&advise, machine)["ways"].clone());
    assert_eq!(by_file, by_machine);
    let [by_machine, by_file] =
        [&own[..], &file].map(|machine| found(&["plan"], machine)["time_s"].clone());
    assert_eq!(by_file, by_machine);
}

/// Backlash of an axis without a screw is in the simulated machine, too, and a corrected program
/// takes it back.
#[test]
fn the_backlash_of_a_geometry_file_is_in_the_simulated_machine() {
    let folder = Folder::new();
    folder.file(
        "part.ngc",
        "G21 G90 G64\nG0 X0 Y0\nG2 X0 Y0 I12 J0 F600\nM2\n",
    );
    folder.file(
        "geometry.toml",
        "format = 1\nsource = \"a bar\"\n[axis.x]\nbacklash_um = 20\n[axis.y]\nbacklash_um = 20\n",
    );
    let without = corrected_um(&folder, &["--machine", "tnv40"]);
    let with = corrected_um(
        &folder,
        &["--machine", "tnv40", "--geometry", "geometry.toml"],
    );
    assert!(
        with[0][1] > without[0][1] + 5.0 && with[1][0] < 0.7 * with[0][0],
        "{with:?} {without:?}"
    );
}

#[test]
fn a_geometry_of_another_machine_or_travel_is_refused() {
    let folder = Folder::new();
    folder.file("star.ngc", STAR);
    folder.file(
        "lead.toml",
        MEASURED.replacen("lead_mm_per_rev = 10", "lead_mm_per_rev = 5", 1),
    );
    let refused = |file: &str, words: &[&str]| {
        folder
            .run(&["run", "star.ngc", "--exact-settings", "--geometry", file])
            .refused(words);
        folder
            .run(&["correct", "star.ngc", "--geometry", file])
            .refused(words);
    };
    refused(
        "lead.toml",
        &["axis x", "every 5 mm", "lead_mm_per_rev", "10 mm"],
    );
    folder.file(
        "travel.toml",
        MEASURED.replacen("to_mm = 100", "to_mm = -50", 1),
    );
    refused(
        "travel.toml",
        &["axis x", "the part reaches", "from -100 to -50 mm"],
    );
    let both = [
        "run",
        "star.ngc",
        "--geometry",
        "lead.toml",
        "--no-geometry",
    ];
    folder.run(&both).refused(&["--geometry", "--no-geometry"]);
}

/// A control without feedback cuts the corrected program; the ends of stretches stay where they
/// are.
#[test]
fn a_corrected_program_compensates_the_geometry_too() {
    let folder = Folder::new();
    folder.file("star.ngc", STAR);
    let rms_um = |more: &[&str]| {
        let correct = ["correct", "star.ngc", "--json", "c.json", "--out", "c.ngc"];
        folder.run(&[&correct[..], more].concat()).succeeded();
        let result: Value = serde_json::from_slice(&folder.read("c.json")).unwrap();
        result["as_exported"]["rms_um"].as_f64().unwrap()
    };
    let [with_um, without_um] = [rms_um(&[]), rms_um(&["--no-geometry"])];
    assert!(with_um < 0.8 * without_um, "{with_um} {without_um}");
}
