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
    ([of("rms_um"), of("joint_rms_um")], result["geometry"].clone())
}

/// What is left at the tool is what the loops leave by the encoders.
#[test]
fn the_geometry_of_the_machine_file_is_compensated_unless_that_is_turned_off() {
    let folder = Folder::new();
    folder.file("star.ngc", STAR);
    let ([tool_um, encoders_um], geometry) = rms_um(&folder, &[]);
    assert_eq!(geometry["terms"], serde_json::json!(["scale", "pitch", "squareness"]));
    assert!((tool_um - encoders_um).abs() < 1e-6, "{tool_um} {encoders_um}");
    let ([off_um, by_encoders_um], geometry) = rms_um(&folder, &["--no-geometry"]);
    assert!(geometry.is_null());
    assert!(tool_um < 0.3 * off_um && by_encoders_um < 1.5 * tool_um, "{tool_um} {off_um} {by_encoders_um}");
}

/// Windup and backlash of its thin screws are most of what is left of the error of `router`.
#[test]
fn the_lost_motion_of_a_machine_with_backlash_is_compensated() {
    let folder = Folder::new();
    folder.file("star.ngc", STAR);
    let ([with_um, _], geometry) = rms_um(&folder, &["--machine", "router"]);
    assert_eq!(geometry["terms"], serde_json::json!(["backlash"]));
    let ([without_um, _], _) = rms_um(&folder, &["--machine", "router", "--no-geometry"]);
    assert!(with_um < 0.7 * without_um, "{with_um} {without_um}");
}

#[test]
fn a_geometry_file_takes_the_place_of_the_machine_file_and_is_as_good_as_it_says() {
    let folder = Folder::new();
    folder.file("star.ngc", STAR);
    folder.file("geometry.toml", MEASURED);
    let ([tool_um, encoders_um], geometry) = rms_um(&folder, &["--geometry", "geometry.toml"]);
    assert!((tool_um - encoders_um).abs() < 1e-6, "{tool_um} {encoders_um}");
    assert_eq!(geometry["from"], "geometry.toml");
    // At most 2 um/m over the 100 mm of both axes, and 0.1 um of pitch.
    let [spread_um, most_um] = ["spread_rms_um", "spread_max_um"].map(|key| geometry[key].as_f64().unwrap());
    assert!(0.01 < spread_um && spread_um < most_um && most_um < 0.3, "{spread_um} {most_um}");
    // With wrong signs the error of the geometry is there twice.
    let wrong = MEASURED.replace("scale_um_m = -15", "scale_um_m = 15");
    folder.file("wrong.toml", wrong.replace("pitch_error_um = 2\n", "pitch_error_um = 2\npitch_phase_deg = 180\n"));
    let ([wrong_um, by_encoders_um], _) = rms_um(&folder, &["--geometry", "wrong.toml"]);
    assert!(wrong_um > 5.0 * tool_um && by_encoders_um < 2.0 * tool_um, "{wrong_um} {by_encoders_um} {tool_um}");
}

#[test]
fn a_geometry_of_another_machine_or_travel_is_refused() {
    let folder = Folder::new();
    folder.file("star.ngc", STAR);
    folder.file("lead.toml", MEASURED.replacen("lead_mm_per_rev = 10", "lead_mm_per_rev = 5", 1));
    let refused = |file: &str, words: &[&str]| {
        folder.run(&["run", "star.ngc", "--exact-settings", "--geometry", file]).refused(words);
        folder.run(&["correct", "star.ngc", "--geometry", file]).refused(words);
    };
    refused("lead.toml", &["axis x", "every 5 mm", "lead_mm_per_rev", "10 mm"]);
    folder.file("travel.toml", MEASURED.replacen("to_mm = 100", "to_mm = -50", 1));
    refused("travel.toml", &["axis x", "the part reaches", "from -100 to -50 mm"]);
    let both = ["run", "star.ngc", "--geometry", "lead.toml", "--no-geometry"];
    folder.run(&both).refused(&["--geometry", "--no-geometry"]);
}

/// A control without feedback cuts the corrected program; the ends of stretches stay where they are.
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
