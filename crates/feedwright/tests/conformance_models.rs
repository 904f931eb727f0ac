//! `identify` and `run --model`: what a training gives is the same from a file, and a file that
//! does not suit is refused.

use std::os::unix::fs::MetadataExt;
use std::path::PathBuf;

use crate::command::{Folder, Ran};
use crate::sweep::part_or_whole;

/// Trace and table of a run, without what is said of where its model comes from.
fn cut(folder: &Folder, more: &[&str]) -> (String, String) {
    let ran = folder
        .run(&[&["run", "circle.ngc", "--trace", "t.csv"], more].concat())
        .succeeded();
    let (table, _) = ran
        .stdout
        .split_once("assumed: ")
        .expect("a run says what was assumed");
    (folder.text("t.csv"), table.to_owned())
}

#[test]
fn a_run_with_the_model_that_identify_wrote_is_that_with_a_training_to_the_bit() {
    let cases = [
        ("lqg-identified", "7", "tnv40"),
        ("two-dimensional", "3", "tnv40"),
        ("lqg-identified", "1", "workshop"),
    ];
    for (controller, seed, machine) in cases.into_iter().skip(part_or_whole(1, 0)) {
        let folder = Folder::new();
        let same = [
            "--controller",
            controller,
            "--machine",
            machine,
            "--seed",
            seed,
        ];
        folder
            .run(&[&["identify", "--out", "m.model.toml"], &same[..]].concat())
            .succeeded();
        let exact = ["--exact-settings"];
        let trained = cut(&folder, &[&same[..], &exact[..]].concat());
        // Another seed: nothing may be trained.
        let other = [
            "--controller",
            controller,
            "--machine",
            machine,
            "--seed",
            "99",
        ];
        let read = cut(
            &folder,
            &[&other[..], &["--model", "m.model.toml"]].concat(),
        );
        assert!(trained == read, "{controller}");
        // Nor is it by chance that both are the same.
        if part_or_whole(controller == "two-dimensional", true) {
            assert!(
                trained != cut(&folder, &[&other[..], &exact[..]].concat()),
                "{controller}"
            );
        }
    }
}

/// Needs 50 s of processor time: identifies a machine from its log and with exact settings, and
/// cuts bands.
#[test]
#[expect(clippy::too_many_lines, reason = "one identification serves all")]
fn a_run_without_a_model_uses_what_a_log_of_the_machine_determines_and_keeps_it() {
    let folder = Folder::new();
    folder.file("mine.toml", "base = \"workshop\"\nname = \"mine\"\n");
    let cut = [
        "run",
        "circle.ngc",
        "--machine",
        "mine.toml",
        "--json",
        "r.json",
        "--report",
        "r.html",
    ];
    // A cache of its own: what another test keeps says nothing here.
    let run = || {
        let mut command = folder.command();
        command
            .env("FEEDWRIGHT_CACHE", folder.path().join("kept"))
            .args(cut);
        Ran::from(command.output().unwrap()).succeeded()
    };
    let kept = || {
        // A file that is read is dated anew, and one that is written is another file.
        let entries = |folder: PathBuf| std::fs::read_dir(folder).unwrap().map(Result::unwrap);
        let folders = entries(folder.path().join("kept"));
        let files = folders.flat_map(|folder| entries(folder.path()));
        let mut files: Vec<_> = files
            .map(|file| (file.path(), file.metadata().unwrap().ino()))
            .collect();
        files.sort();
        files
    };
    let first = run();
    let kept_first = kept();
    assert!(!kept_first.is_empty());
    let said = first
        .stdout
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ");
    assert!(
        said.contains("from the model: simulated excitation of mine by its log, seed 1"),
        "{said}"
    );
    let ratio = |folder: &Folder| {
        let result: serde_json::Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
        let joint_um = |run: usize| result["runs"][run]["joint_rms_um"].as_f64().unwrap();
        joint_um(1) / joint_um(0)
    };
    let band = |folder: &Folder| {
        let result: serde_json::Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
        result["band"].clone()
    };
    let of_log = ratio(&folder);
    let first_band = band(&folder);
    assert_eq!(first_band["machines"], 8, "{first_band}");
    assert!(
        said.contains("band of 8 machines that fit the recording as well: RMS"),
        "{said}"
    );
    assert!(
        folder
            .text("r.html")
            .contains("band of 8 machines that fit the recording as well")
    );
    run();
    assert_eq!(kept(), kept_first, "what is identified is written");
    assert_eq!(ratio(&folder).to_bits(), of_log.to_bits());
    assert_eq!(band(&folder), first_band);
    // The same machine under the built-in name: the result of its log is shipped with the program.
    folder
        .run(&[
            "run",
            "circle.ngc",
            "--machine",
            "workshop",
            "--json",
            "r.json",
        ])
        .succeeded();
    assert_eq!(
        ratio(&folder).to_bits(),
        of_log.to_bits(),
        "hint: just built-in-logs"
    );
    assert_eq!(band(&folder), first_band, "hint: just built-in-logs");
    folder
        .run(&[&cut[..], &["--band", "3"]].concat())
        .succeeded();
    assert_eq!(band(&folder)["machines"], 3);
    folder
        .run(&[&cut[..], &["--band", "0"]].concat())
        .succeeded();
    assert!(band(&folder).is_null());
    folder
        .run(&[&cut[..], &["--band", "33"]].concat())
        .refused(&["33 is not in 0..=32"]);
    folder
        .run(&[&cut[..], &["--band", "3", "--exact-settings"]].concat())
        .refused(&["--band", "--exact-settings"]);
    folder
        .run(&[&cut[..], &["--exact-settings"]].concat())
        .succeeded();
    let exact = ratio(&folder);
    assert!(band(&folder).is_null());
    assert!(
        of_log != exact && of_log < 1.5 * exact + 0.01,
        "{of_log} {exact}"
    );
    folder
        .run(&[&cut[..], &["--exact-settings", "--model", "m.toml"]].concat())
        .refused(&["--exact-settings", "--model"]);
}

/// The log of the z axis of router determines little, so that some draws have impossible gains.
#[test]
fn a_band_leaves_out_what_no_machine_file_can_hold() {
    let folder = Folder::new();
    let helix = "G21 G17 G90 G94\nG0 X0 Y0 Z0\nG2 X0 Y0 Z-1 I2 J0 F1200\nM2\n";
    folder.file("helix.ngc", helix);
    let ran = folder.run(&[
        "run",
        "helix.ngc",
        "--machine",
        "router",
        "--json",
        "r.json",
    ]);
    assert!(matches!(ran.code, Some(0 | 1)), "{ran:?}");
    let result: serde_json::Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
    assert!(
        result["band"]["machines"].as_u64().unwrap() > 0,
        "{}",
        result["band"]
    );
}

const STAR: &str = include_str!("../../../parts/star.ngc");
/// A machine with a position gain a tenth below workshop's.
const SLOW: &str = "base = \"workshop\"\nname = \"slow\"\n[axis.x]\nkp_1_s = 45\n[axis.y]\nkp_1_s = 45\n[axis.z]\nkp_1_s = 45\n";

#[test]
fn what_was_learned_of_a_machine_that_differs_from_its_model_is_written() {
    let folder = Folder::new();
    folder.file("slow.toml", SLOW);
    folder.file("star.ngc", STAR);
    folder
        .run(&[
            "identify",
            "--machine",
            "workshop",
            "--out",
            "given.model.toml",
        ])
        .succeeded();
    let cut = [
        "run",
        "star.ngc",
        "--machine",
        "slow.toml",
        "--json",
        "r.json",
        "--learned",
        "learned.model.toml",
    ];
    folder
        .run(&[&cut[..], &["--model", "given.model.toml"]].concat())
        .succeeded();
    let result: serde_json::Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
    let [uncorrected, corrected] =
        [0, 1].map(|run| result["runs"][run]["joint_rms_um"].as_f64().unwrap());
    assert!(
        corrected < 0.05 * uncorrected,
        "{corrected} of {uncorrected}"
    );
    let transitions = result["runs"][1]["transitions"].as_array().unwrap();
    let learned = |axis: &str| {
        transitions
            .iter()
            .find(|t| t["change"] == "learned" && t["axis"] == axis)
            .unwrap()
    };
    for axis in ["x", "y"] {
        let (at_s, line) = (
            learned(axis)["at_s"].as_f64().unwrap(),
            learned(axis)["line"].as_u64().unwrap(),
        );
        assert!(at_s < 0.5 && line > 0, "{transitions:?}");
    }
    let text = folder.text("learned.model.toml");
    let gains = text
        .lines()
        .skip_while(|line| !line.starts_with("kp_1_s"))
        .nth(1)
        .unwrap();
    for gain_1_s in gains
        .split(',')
        .filter_map(|number| number.trim().parse::<f64>().ok())
    {
        assert!((gain_1_s / 45.0 - 1.0).abs() < 0.05, "{gains}");
    }
    let reported = folder
        .run(&["check", "learned.model.toml"])
        .succeeded()
        .stdout;
    assert!(
        reported.contains("learned while slow cut star.ngc"),
        "{reported}"
    );
}

#[test]
fn a_correction_that_leaves_most_of_the_cut_to_itself_ends_with_exit_code_1_and_says_why() {
    let folder = Folder::new();
    folder.file("star.ngc", STAR);
    folder
        .run(&["identify", "--machine", "workshop", "--out", "w.model.toml"])
        .succeeded();
    let cut = [
        "run",
        "star.ngc",
        "--machine",
        "router",
        "--model",
        "w.model.toml",
        "--json",
        "r.json",
        "--report",
        "r.html",
    ];
    let ran = folder.run(&cut);
    assert_eq!(ran.code, Some(1), "{ran:?}");
    let said = ran.stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        said.contains("for good. At ") && said.contains("the model does not fit this machine"),
        "{said}"
    );
    let result: serde_json::Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
    let transitions = result["runs"][1]["transitions"].as_array().unwrap();
    assert!(
        transitions
            .iter()
            .any(|t| t["change"] == "left" && t["cause"].is_string()),
        "{transitions:?}"
    );
    assert!(folder.text("r.html").contains("out of the loop, because"));
}

#[test]
fn a_controller_that_learns_no_axes_writes_none() {
    let folder = Folder::new();
    folder
        .run(&[
            "identify",
            "--controller",
            "two-dimensional",
            "--machine",
            "tnv40",
            "--out",
            "m.model.toml",
        ])
        .succeeded();
    let cut = [
        "run",
        "circle.ngc",
        "--machine",
        "tnv40",
        "--controller",
        "two-dimensional",
        "--learned",
        "l.model.toml",
    ];
    let ran = folder.run(&[&cut[..], &["--model", "m.model.toml"]].concat());
    ran.refused(&[
        "two-dimensional learns no model of the axes",
        "--controller lqg-identified",
    ]);
    assert!(!folder.path().join("l.model.toml").exists());
}

/// Needs 8 s of processor time: identifies three axes twice.
#[test]
fn the_same_identification_writes_the_same_bytes() {
    let folder = Folder::new();
    for name in ["1", "2"] {
        let mut command = folder.command();
        // Without what is kept, both identify.
        command
            .env("SOURCE_DATE_EPOCH", "1700000000")
            .env("LC_ALL", "de_DE.UTF-8")
            .env("FEEDWRIGHT_CACHE", "");
        command.args([
            "identify",
            "--axes",
            "3",
            "--machine",
            "heavy",
            "--out",
            &format!("{name}.model.toml"),
        ]);
        assert!(command.output().unwrap().status.success());
    }
    let text = folder.text("1.model.toml");
    assert_eq!(text, folder.text("2.model.toml"));
    assert!(
        text.contains("date = \"2023-11-14\"") && text.contains("axes = 3"),
        "{text}"
    );
    assert!(
        text.contains("source = \"simulated excitation of heavy, seed 1\""),
        "{text}"
    );
    let reported = folder.run(&["check", "1.model.toml"]).succeeded().stdout;
    assert!(
        reported.contains("axes model, 3 axes, simulated excitation of heavy, seed 1"),
        "{reported}"
    );
}

#[test]
fn a_model_that_does_not_suit_is_refused_with_what_does() {
    let folder = Folder::new();
    folder.file(
        "helix.ngc",
        "G21 G17 G90\nG0 X0 Y0\nG2 X0 Y0 Z-1 I2 J0 F1200\nM2\n",
    );
    folder.file(
        "half.toml",
        include_str!("../../sim/machines/tnv40.toml")
            .replace("servo_s = 0.001", "servo_s = 0.0005"),
    );
    folder
        .run(&[
            "identify",
            "--controller",
            "two-dimensional",
            "--out",
            "m.model.toml",
        ])
        .succeeded();
    let before = folder.content();
    let refused = |arguments: &[&str], texts: &[&str]| {
        folder
            .run(&[&["run"], arguments, &["--model", "m.model.toml"]].concat())
            .refused(texts);
        assert_eq!(folder.content(), before, "{arguments:?}");
    };
    refused(
        &["circle.ngc", "--controller", "uncorrected"],
        &[
            "uncorrected uses no trained identifier",
            "leave --model out",
        ],
    );
    refused(
        &["circle.ngc", "--controller", "lqg-identified"],
        &["the model holds a contour identifier, and lqg-identified needs an axes identifier"],
    );
    refused(
        &["helix.ngc", "--controller", "two-dimensional"],
        &["the model is for 2 axes, and 3 are controlled", "--axes 3"],
    );
    refused(
        &[
            "circle.ngc",
            "--controller",
            "two-dimensional",
            "--machine",
            "half.toml",
        ],
        &["a servo period of 0.001 s, and the machine has 0.0005 s"],
    );
    refused(
        &[
            "circle.ngc",
            "--controller",
            "two-dimensional",
            "--set",
            "feed_period_s=0.005",
        ],
        &["a feed period of 0.01 s", "--set feed_period_s=0.01"],
    );
}

#[test]
fn a_model_file_with_faults_cuts_nothing() {
    let folder = Folder::new();
    folder
        .run(&["identify", "--out", "m.model.toml"])
        .succeeded();
    let text = folder.text("m.model.toml");
    folder.file("changed.model.toml", text.replacen("seed 1", "seed 2", 1));
    folder.file("cut.model.toml", &text[..text.len() / 2]);
    folder.file(
        "later.model.toml",
        text.replacen("format = 1", "format = 2", 1),
    );
    let before = folder.content();
    for (file, said) in [
        ("changed.model.toml", "the checksum does not fit"),
        ("cut.model.toml", "not TOML"),
        ("later.model.toml", "the model is of format 2"),
        ("none.model.toml", "cannot read model file"),
    ] {
        folder
            .run(&["run", "circle.ngc", "--model", file])
            .refused(&[said, "model file"]);
        assert_eq!(folder.content(), before, "{file}");
    }
}

#[test]
fn identify_writes_nothing_where_it_cannot_or_must_not() {
    let folder = Folder::new();
    folder.file("mine.toml", include_str!("../../sim/machines/tnv40.toml"));
    let flat = include_str!("../../sim/machines/tnv40.toml")
        .split("\n[axis.z]")
        .next()
        .unwrap();
    folder.file("flat.toml", flat);
    let before = folder.content();
    let refused = |arguments: &[&str], texts: &[&str]| {
        folder
            .run(&[&["identify"], arguments].concat())
            .refused(texts);
        assert_eq!(folder.content(), before, "{arguments:?}");
    };
    refused(
        &["--controller", "uncorrected", "--out", "m.model.toml"],
        &["uncorrected uses no trained identifier"],
    );
    refused(
        &["--machine", "mine.toml", "--out", "mine.toml"],
        &["mine.toml"],
    );
    refused(
        &[
            "--machine",
            "flat.toml",
            "--axes",
            "3",
            "--out",
            "m.model.toml",
        ],
        &["has 2 axes, and a model for 3"],
    );
    refused(&["--out", "none/m.model.toml"], &["none"]);
    let mut command = folder.command();
    command
        .env("SOURCE_DATE_EPOCH", "today")
        .args(["identify", "--out", "m.model.toml"]);
    let output = command.output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("SOURCE_DATE_EPOCH is 'today'"));
    assert_eq!(folder.content(), before);
}

#[test]
fn what_was_found_of_each_axis_is_shown_with_standard_errors() {
    let folder = Folder::new();
    let command = [
        "identify",
        "--controller",
        "lqg-identified",
        "--machine",
        "workshop",
        "--out",
        "m.model.toml",
    ];
    let reported = folder.run(&command).succeeded().stdout;
    let row = |label: &str| {
        let line = reported
            .lines()
            .find(|line| line.starts_with(label))
            .unwrap_or_else(|| panic!("no {label}: {reported}"));
        let numbers = line[label.len()..]
            .split_whitespace()
            .filter_map(|word| word.parse::<f64>().ok());
        numbers.collect::<Vec<f64>>()
    };
    for label in [
        "viscous, N m s/rad",
        "Coulomb, N m",
        "asymmetry, N m",
        "presliding, um",
    ] {
        assert_eq!(row(label).len(), 4, "{reported}");
    }
    assert_eq!(row("left, um RMS").len(), 2, "{reported}");
    let text = folder.text("m.model.toml");
    let (_, inertia) = text.split_once("inertia_kg_m2 = [").unwrap();
    let inertia = inertia
        .split_once(']')
        .unwrap()
        .0
        .split(',')
        .filter_map(|word| word.trim().parse::<f64>().ok());
    for (stored, shown) in inertia.zip(row("inertia, kg m2").chunks(2)) {
        assert!(
            (stored - shown[0]).abs() < 0.01 * stored && shown[1] < 0.05 * stored,
            "{reported}"
        );
    }
    let reported = folder.run(&["check", "m.model.toml"]).succeeded().stdout;
    assert!(
        reported.contains("axes model, 2 axes, simulated excitation of workshop, seed 1"),
        "{reported}"
    );
}

/// Needs 10 s of processor time: fails only after a whole identification.
#[test]
fn axes_that_do_not_show_are_reported() {
    let folder = Folder::new();
    // Loops that take longer to settle than the excitation lasts.
    let slow = include_str!("../../sim/machines/tnv40.toml").lines();
    let slow = slow.map(|line| {
        if line.starts_with("kp_1_s") {
            "kp_1_s = 0.5"
        } else {
            line
        }
    });
    folder.file("slow.toml", slow.collect::<Vec<_>>().join("\n"));
    let said = [
        "the axes of `",
        "cannot be identified",
        "hint: record for longer",
    ];
    let before = folder.content();
    let same = ["--controller", "lqg-identified", "--machine", "slow.toml"];
    folder
        .run(&[&["identify", "--out", "m.model.toml"], &same[..]].concat())
        .refused(&said);
    assert_eq!(folder.content(), before);
    let against = [
        "run",
        "circle.ngc",
        "--against",
        "lqg-identified",
        "--exact-settings",
    ];
    let ran = folder.run(&[&against, &same[..]].concat());
    assert!(
        ran.stderr
            .contains("lqg-identified cuts uncorrected: the axes of `"),
        "{}",
        ran.stderr
    );
}

#[test]
fn a_block_is_of_a_model_or_of_a_machine_and_nothing_is_written_where_neither_is_there() {
    let folder = Folder::new();
    folder
        .run(&["block", "workshop", "--out", "exact.fwmodel"])
        .succeeded();
    folder
        .run(&[
            "identify",
            "--controller",
            "lqg-identified",
            "--machine",
            "tnv40",
            "--out",
            "m.model.toml",
        ])
        .succeeded();
    let reported = folder
        .run(&["block", "m.model.toml", "--out", "found.fwmodel"])
        .succeeded()
        .stdout;
    assert!(
        reported.contains("the model of kind 'axes', 2 axes: 660 bytes"),
        "{reported}"
    );
    geometry_of_a_block(&folder);
    axes_that_no_command_follows(&folder);
    let before = folder.content();
    for (arguments, texts) in [
        (
            ["workshop", "--machine", "tnv40"],
            ["--machine goes with a model file", "leave --machine out"],
        ),
        (
            ["workshop", "--geometry", "missing.toml"],
            ["missing.toml", "cannot"],
        ),
        (
            ["m.model.toml", "--axes", "3"],
            [
                "the model m.model.toml has 2 axes",
                "identify the machine again with --axes",
            ],
        ),
        (["missing.toml", "--axes", "3"], ["missing.toml", "cannot"]),
        (
            ["tnv40", "--axes", "4"],
            ["a block is of 2 or 3 axes", "--axes"],
        ),
    ] {
        folder
            .run(&[&["block"], &arguments[..], &["--out", "more.fwmodel"]].concat())
            .refused(&texts);
        assert_eq!(folder.content(), before, "{arguments:?}");
    }
}

/// Acceleration that is fed forward without the speed is reported, axis by axis.
fn axes_that_no_command_follows(folder: &Folder) {
    for (parts, axes) in [
        ([0.0, 0.0], vec![]),
        ([0.0, 0.5], vec!["x"]),
        ([1.0, 0.5], vec![]),
    ] {
        let [speed, acceleration] = parts;
        let text = format!(
            "base = \"tnv40\"\nname = \"fed\"\n[axis.x]\nvelocity_feedforward = {speed}\nacceleration_feedforward = {acceleration}\n"
        );
        folder.file("fed.toml", text);
        let said = folder
            .run(&["block", "fed.toml", "--out", "fed.fwmodel"])
            .succeeded()
            .stdout;
        let reported: Vec<&str> = said
            .lines()
            .filter_map(|line| line.strip_prefix("axis ")?.get(..1))
            .collect();
        assert_eq!(reported, axes, "{parts:?}: {said}");
        assert_eq!(said.contains("with cause 11"), !axes.is_empty(), "{said}");
    }
}

/// Checks each way of naming a geometry: the reported text, and whether the block then has one.
fn geometry_of_a_block(folder: &Folder) {
    let of_a_screw = "format = 1\nsource = \"a test\"\n[axis.x]\nlead_mm_per_rev = 8\npitch_error_um = 3\nbacklash_um = 2\n";
    folder.file("screw.toml", of_a_screw);
    folder.file(
        "line.toml",
        "format = 1\nsource = \"a test\"\n[axis.x]\nstraightness_y = [\n  [-100, 0],\n  [100, 5],\n]\n",
    );
    let none = "geometry: none";
    for (arguments, reported, format) in [
        (&["workshop"][..], "geometry: scale, pitch, squareness\n", 4),
        (
            &["workshop", "--no-geometry"],
            "geometry: none, as --no-geometry says",
            2,
        ),
        (&["tnv40"], none, 2),
        (
            &["router"],
            "geometry: none. An axis has backlash that its encoder does not see",
            2,
        ),
        (
            &["router", "--geometry", "screw.toml"],
            "geometry: pitch. Backlash is left out",
            4,
        ),
        (
            &["tnv40", "--geometry", "line.toml"],
            "geometry: straightness\n",
            4,
        ),
        (
            &["m.model.toml"],
            "geometry: none. A model file states none",
            2,
        ),
        (
            &["m.model.toml", "--machine", "workshop"],
            "geometry: scale, pitch, squareness\n",
            4,
        ),
        (
            &["m.model.toml", "--geometry", "line.toml"],
            "geometry: straightness\n",
            4,
        ),
    ] {
        let said = folder
            .run(&[&["block"], arguments, &["--out", "some.fwmodel"]].concat())
            .succeeded()
            .stdout;
        assert!(
            said.replace("\n  ", " ").contains(reported),
            "{arguments:?}: {said}"
        );
        assert_eq!(folder.read("some.fwmodel")[8], format, "{arguments:?}");
    }
}
