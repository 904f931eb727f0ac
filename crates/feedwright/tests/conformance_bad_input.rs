//! Whatever is wrong with what the command gets: exit code 2, a message that names place, value,
//! limit, unit and remedy, nothing on stdout, no panic, and a folder in which nothing has changed.

use std::ffi::OsStr;
use std::process::Command;

use crate::command::{Folder, Ran, skipped};
use crate::conformance_identify_log::{HEAD, rows, text};

/// The machine of the paper.
const TNV40: &str = include_str!("../../sim/machines/tnv40.toml");

/// Writes `name`, the machine of the paper with some of its text replaced; each replacement is to
/// be found.
fn machine(folder: &Folder, name: &str, replacements: &[(&str, &str)]) {
    let mut text = TNV40.to_owned();
    for (from, to) in replacements {
        assert!(text.contains(from), "{from} is not in the machine file");
        text = text.replace(from, to);
    }
    folder.file(name, text);
}

/// Runs and checks that it is refused with all of `says`, and that the folder is as it was.
fn refuses<S: AsRef<OsStr> + std::fmt::Debug>(folder: &Folder, arguments: &[S], says: &[&str]) {
    let before = folder.content();
    folder.run_uncorrected(arguments).refused(says);
    assert_eq!(before, folder.content(), "{arguments:?} left something");
}

#[test]
fn a_file_that_is_not_a_program() {
    let folder = Folder::new();
    folder.file("binary.ngc", b"G21\n\0\x01\x02G1");
    folder.file("empty.ngc", "");
    folder.file("comments.ngc", "%\n(nothing)\n; to see here\n%\n");
    folder.file("still.ngc", "G21 G90\nM2\n");
    std::fs::create_dir(folder.path().join("folder.ngc")).unwrap();
    for (part, says) in [
        ("missing.ngc", &["missing.ngc", "No such file"][..]),
        ("binary.ngc", &["binary.ngc", "byte 4", "NUL", "plain text"]),
        ("empty.ngc", &["empty.ngc", "empty"]),
        (
            "comments.ngc",
            &["comments.ngc", "no motion", "comment around everything"],
        ),
        ("still.ngc", &["still.ngc", "no motion", "the right file"]),
        (
            "folder.ngc",
            &["folder.ngc", "folder, not a G-code program"],
        ),
    ] {
        refuses(&folder, &[part], says);
    }
}

#[test]
#[expect(clippy::too_many_lines, reason = "a table")]
fn a_program_with_a_mistake() {
    let folder = Folder::new();
    let far = format!("G1 X1{} F100", "0".repeat(300));
    for (name, line, says) in [
        (
            "unknown",
            "G1 X10 G555 F100",
            &["G555", "unknown.ngc:2:8", "────", "nearest known"][..],
        ),
        (
            "arc",
            "G2 X10 Y0 I3 J0 F100",
            &[
                "3.000000 mm",
                "7.000000 mm",
                "limit",
                "arc.ngc:2:1",
                "centre",
            ],
        ),
        (
            "radius",
            "G2 X10 Y0 R3 F100",
            &[
                "R = 3",
                "half the distance",
                "5.000000 mm",
                "radius.ngc:2:11",
            ],
        ),
        (
            "zero",
            "G1 X10 F0",
            &["F0", "F above 0", "zero.ngc:2:8", "per minute"],
        ),
        ("none", "G1 X10", &["no feed F", "none.ngc:2:1", "add F"]),
        (
            "nine",
            "G1 X999999999 F100",
            &["X = 999999999 mm", "limit of 1000000 mm", "nine.ngc:2:4"],
        ),
        (
            "ten",
            "G1 X1234567890 F100",
            &["X = 1234567890 mm", "limit of 1000000 mm", "ten.ngc:2:4"],
        ),
        (
            "exponent",
            "G1 X1e300 F100",
            &[
                "E has no meaning",
                "exponent.ngc:2:6",
                "no exponents",
                "1500 for 1.5e3",
            ],
        ),
        (
            "bracket",
            "G1 X[1e3] F100",
            &[
                "`]` or an operator is missing",
                "bracket.ngc:2:7",
                "no exponents",
            ],
        ),
        (
            "far",
            &far,
            &[
                "X = 1.000e300 mm",
                "limit of 1000000 mm",
                "far.ngc:2:4",
                "decimal point",
            ],
        ),
        (
            "turned",
            "G1 A1000001 F100",
            &[
                "A = 1000001 degrees",
                "limit of 1000000 degrees",
                "turned.ngc:2:4",
            ],
        ),
        (
            "comma",
            "G1 X1,5 F100",
            &["`,` has no meaning", "comma.ngc:2:6", "1.5, not 1,5"],
        ),
        (
            "letter",
            "GO X1",
            &["neither a number", "letter.ngc:2:2", "write 0"],
        ),
        (
            "letters",
            "G0 X1O",
            &["O-word", "letters.ngc:2:6", "write 0"],
        ),
    ] {
        let part = format!("{name}.ngc");
        folder.file(&part, format!("G21 G90 G17\n{line}\nM2\n"));
        refuses(&folder, &[&part], says);
    }
}

#[test]
fn all_mistakes_of_a_program_are_reported_in_one_go() {
    let folder = Folder::new();
    folder.file(
        "many.ngc",
        "G1 X1 F100\nG555\nG1 Y2\nX7000000\nG2 X0 Y0 I50\nM2\n",
    );
    refuses(
        &folder,
        &["many.ngc"],
        &[
            "2 mistakes, nothing was cut",
            "many.ngc:2:1",
            "many.ngc:4:1",
        ],
    );
}

#[test]
fn a_file_that_is_not_a_machine() {
    let folder = Folder::new();
    machine(
        &folder,
        "nan.toml",
        &[
            ("servo_s = 0.001", "servo_s = nan"),
            ("rapid_mm_s = 400", "rapid_mm_s = inf"),
        ],
    );
    machine(
        &folder,
        "negative.toml",
        &[("inertia_kg_m2 = 0.0103", "inertia_kg_m2 = -0.0103")],
    );
    machine(
        &folder,
        "key.toml",
        &[("inertia_kg_m2 = 0.0103", "inertia_kgm2 = 0.0103")],
    );
    machine(
        &folder,
        "stiff.toml",
        &[(
            "viscous_friction_nm_s = 0.0336",
            "viscous_friction_nm_s = 1000",
        )],
    );
    machine(&folder, "syntax.toml", &[("servo_s = 0.001", "servo_s = ")]);
    folder.file("latin.toml", b"name = \"Fr\xe4se\"\n");
    for (machine, says) in [
        (
            "nan.toml",
            &[
                "2 faults",
                "servo_s is NaN",
                "nan.toml:12:11",
                "rapid_mm_s is inf",
                "mm/s",
                "finite",
            ][..],
        ),
        (
            "negative.toml",
            &[
                "inertia_kg_m2 is -0.0103 kg m2",
                "1e-9 and 1000 kg m2",
                "negative.toml:25:17",
                "sign",
            ],
        ),
        (
            "key.toml",
            &[
                "unknown key 'inertia_kgm2' in [axis.x]",
                "did you mean 'inertia_kg_m2'?",
                "key.toml:25:1",
            ],
        ),
        (
            "stiff.toml",
            &[
                "mechanics_s of 0.0001 s is too long for viscous_friction_nm_s of 1000",
                "an inertia of 0.0103 kg m2: the speed fades within 1.03e-5 s",
                "mechanics_s has to be 1.03e-5 s or less, or the friction 103 N m",
                "stiff.toml:26:25",
            ],
        ),
        ("syntax.toml", &["not TOML", "syntax.toml:12"]),
        ("latin.toml", &["latin.toml", "e4"]),
        (
            "missing.toml",
            &["missing.toml", "No such file", "feedwright machines"],
        ),
        ("tnv41", &["tnv41", "did you mean 'tnv40'?"]),
        ("circle.ngc", &["circle.ngc", "./circle.ngc"]),
    ] {
        refuses(&folder, &["circle.ngc", "--machine", machine], says);
    }
}

#[test]
fn a_program_in_space_on_a_machine_of_two_axes() {
    let folder = Folder::new();
    let z = TNV40.find("# The paper simulates X and Y only").unwrap();
    folder.file("plane.toml", &TNV40[..z]);
    folder.file("space.ngc", "G21 G90\nG1 X1 Z1 F100\nM2\n");
    refuses(
        &folder,
        &["space.ngc", "--machine", "plane.toml"],
        &["space.ngc", "Z", "[axis.z]", "three axes"],
    );
}

#[test]
fn a_value_out_of_its_range() {
    let folder = Folder::new();
    for (option, values, says) in [
        (
            "--feed",
            &[
                "0mm/s",
                "-5mm/s",
                "1e300mm/s",
                "1e999mm/s",
                "1000mm/s",
                "99m/min",
            ][..],
            &["--feed", "mm/s", "200", "max_feed_mm_s", "F3000"][..],
        ),
        (
            "--feed",
            &["0", "-5", "50", "1e300"],
            &["--feed", "it has no unit", "mm/min is", "mm/s is"],
        ),
        (
            "--feed",
            &["nan", "inf", "mm/s", ""],
            &["--feed", "begins with no number", "50mm/s"],
        ),
        (
            "--tolerance",
            &["0", "-5", "nan", "inf", "1e300"],
            &["--tolerance", "um", "above 0"],
        ),
    ] {
        for value in values {
            refuses(&folder, &["circle.ngc", option, value], says);
        }
    }
    refuses(
        &folder,
        &["circle.ngc", "--feed", "1e300mm/s"],
        &["--feed is 1e300 mm/s"],
    );
    refuses(
        &folder,
        &["circle.ngc", "--feed", "5q"],
        &["'q' is no unit of a feedrate", "mm/min, mm/s"],
    );
    for option in ["--feed", "--tolerance", "--seed"] {
        refuses(&folder, &["circle.ngc", option, "fast"], &[option, "fast"]);
    }
    for option in ["--controller", "--against"] {
        let says = [
            "two-dimensionl",
            "did you mean 'two-dimensional'?",
            "feedwright controllers",
        ];
        let before = folder.content();
        folder
            .run(&["run", "circle.ngc", option, "two-dimensionl"])
            .refused(&says);
        assert_eq!(before, folder.content());
    }
}

#[test]
fn what_commands_beside_run_are_asked_for() {
    let folder = Folder::new();
    let refuses = |arguments: &[&str], says: &[&str]| {
        let before = folder.content();
        folder.run(arguments).refused(says);
        assert_eq!(before, folder.content(), "{arguments:?}");
    };
    refuses(
        &["plan", "circle.ngc", "--tolerance", "1e-9"],
        &[
            "--tolerance is",
            "0.01 to 10000 um",
            "0.01 mm is --tolerance 10",
        ],
    );
    refuses(
        &["plan", "circle.ngc", "--planner", "linuxnc"],
        &["no planner is called 'linuxnc'", "did you mean 'linuxcnc'?"],
    );
    refuses(
        &["man", "--out", "circle.ngc"],
        &[
            "cannot make the folder circle.ngc",
            "a file stands in its place",
        ],
    );
    refuses(
        &["identify", ".", "--out", "mine.toml"],
        &["cannot read log", "is a directory", "name a file in it"],
    );
    refuses(
        &["run", "circle.ngc", "--out", "circle.ngc/s.csv"],
        &["circle.ngc is a file, not a directory"],
    );
}

#[test]
fn a_parameter_that_cannot_be_set() {
    let folder = Folder::new();
    let refuses = |set: &str, says: &[&str]| {
        let before = folder.content();
        folder
            .run(&[
                "run",
                "circle.ngc",
                "--controller",
                "two-dimensional",
                "--set",
                set,
            ])
            .refused(&[&["--set", set][..], says].concat());
        assert_eq!(before, folder.content());
    };
    refuses("knots", &["the value is missing", "--set knots=VALUE"]);
    refuses("knots=30", &["1 to 20, whole", "its default is 1"]);
    refuses("knots=nan", &["1 to 20, whole"]);
    refuses(
        "control_weight=1",
        &[
            "two-dimensional has no parameter 'control_weight'",
            "feedwright controllers two-dimensional",
        ],
    );
    refuses(
        "magnitude-only.rho=0.01",
        &[
            "magnitude-only does not take part",
            "two-dimensional, uncorrected",
        ],
    );
    refuses(
        "two-dimensionl.rho=1",
        &[
            "no controller is called 'two-dimensionl'",
            "did you mean 'two-dimensional'?",
        ],
    );
    let twice = ["--set", "knots=10", "--set", "two-dimensional.knots=12"];
    folder
        .run(
            &[
                &["run", "circle.ngc", "--controller", "two-dimensional"],
                &twice[..],
            ]
            .concat(),
        )
        .refused(&["knots of two-dimensional is set twice"]);
}

#[test]
fn a_place_that_cannot_be_written() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path().join("folder")).unwrap();
    folder.file("machine.toml", TNV40);
    for (output, says) in [
        (
            &["--out", "setpoints.txt"][..],
            &["setpoints.txt", ".csv", ".ngc"][..],
        ),
        (&["--out", "setpoints"], &["setpoints", ".csv", ".ngc"]),
        (
            &["--json", "none/r.json"],
            &["none/r.json", "No such file", "mkdir -p none"],
        ),
        (
            &["--trace", "folder"],
            &["folder", "directory", "add a file name"],
        ),
        (
            &["--trace", "folder/"],
            &["folder", "directory", "add a file name"],
        ),
        (
            &["--trace", "circle.ngc/t.csv"],
            &["circle.ngc/t.csv", "not a directory"],
        ),
        (
            &["--json", "circle.ngc"],
            &["circle.ngc", "which this run reads", "another name"],
        ),
        (
            &["--json", "folder/../circle.ngc"],
            &["circle.ngc", "which this run reads"],
        ),
        (
            &["--json", "machine.toml", "--machine", "machine.toml"],
            &["machine.toml", "which this run reads"],
        ),
        (
            &["--json", "a", "--trace", "./a"],
            &["another output of this run", "./a"],
        ),
        (
            &["--report", "a.csv", "--out", "folder/../a.csv"],
            &["another output of this run", "folder/../a.csv"],
        ),
    ] {
        let arguments = [&["circle.ngc"], output].concat();
        refuses(&folder, &arguments, says);
    }
    // Not even root can make a file there.
    if cfg!(target_os = "linux") {
        refuses(
            &folder,
            &["circle.ngc", "--trace", "/proc/trace.csv"],
            &["/proc/trace.csv", "No such file"],
        );
    }
}

#[test]
#[cfg(unix)]
fn a_folder_that_is_read_only() {
    use std::os::unix::fs::PermissionsExt;

    let folder = Folder::new();
    let locked = folder.path().join("locked");
    std::fs::create_dir(&locked).unwrap();
    std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o555)).unwrap();
    if std::fs::write(locked.join("probe"), "").is_ok() {
        std::fs::remove_file(locked.join("probe")).unwrap();
        return skipped("permissions do not bind this user (root)");
    }
    refuses(
        &folder,
        &["circle.ngc", "--trace", "locked/t.csv"],
        &["locked/t.csv", "Permission denied", "writable"],
    );
}

/// Every output at once, one of them where there is no room.
const OUTPUTS: [&str; 6] = ["--json", "r.json", "--out", "s.csv", "--report", "r.html"];

#[test]
#[cfg(target_os = "linux")]
fn a_full_device() {
    let folder = Folder::new();
    for output in ["--trace", "--json", "--report"] {
        let mut arguments = vec!["circle.ngc", output, "/dev/full"];
        arguments.extend(OUTPUTS.chunks(2).filter(|pair| pair[0] != output).flatten());
        refuses(
            &folder,
            &arguments,
            &["/dev/full", "No space left on device"],
        );
    }
}

/// A limit on the size of files stands for a disk that fills up while the part is cut; it binds
/// root too.
#[test]
#[cfg(unix)]
fn a_file_that_grows_too_large() {
    let folder = Folder::new();
    let before = folder.content();
    let mut command = Command::new("sh");
    // Blocks of 512 bytes; the signal that comes with the limit is ignored, so that the write
    // fails.
    command.args([
        "-c",
        "trap '' XFSZ; ulimit -f 200; exec \"$0\" run circle.ngc --controller uncorrected --trace t.csv --out s.csv",
    ]);
    command
        .arg(env!("CARGO_BIN_EXE_feedwright"))
        .current_dir(folder.path());
    Ran::from(command.output().unwrap()).refused(&["t.csv", "File too large"]);
    assert_eq!(before, folder.content());
}

/// A disk of 64 KiB.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk() {
    let folder = Folder::new();
    let disk = folder.path().join("disk");
    std::fs::create_dir(&disk).unwrap();
    let mounted = Command::new("mount")
        .args(["-t", "tmpfs", "-o", "size=64k", "tmpfs"])
        .arg(&disk)
        .output();
    if !mounted.is_ok_and(|mounted| mounted.status.success()) {
        return skipped("this user may not mount a small disk");
    }
    let before = folder.content();
    let arguments = [&["circle.ngc", "--trace", "disk/t.csv"], &OUTPUTS[..]].concat();
    let ran = folder.run_uncorrected(&arguments);
    let after = folder.content();
    let unmounted = Command::new("umount").arg(&disk).status();
    assert!(unmounted.is_ok_and(|status| status.success()));
    ran.refused(&[
        "disk/t.csv",
        "No space left on device",
        "bytes are free",
        "make room",
    ]);
    assert_eq!(before, after);
}

#[test]
fn a_job_that_fails_at_the_end_leaves_the_files_that_were_there() {
    let folder = Folder::new();
    folder.file("r.json", "of yesterday");
    folder.file("circle.report.html", "of yesterday");
    if cfg!(target_os = "linux") {
        refuses(
            &folder,
            &["circle.ngc", "--json", "r.json", "--trace", "/dev/full"],
            &["/dev/full"],
        );
    }
    refuses(
        &folder,
        &["circle.ngc", "--json", "r.json", "--trace", "none/t.csv"],
        &["none/t.csv"],
    );
}

#[test]
fn arguments_that_do_not_exist() {
    let folder = Folder::new();
    for (arguments, says) in [
        (&[][..], &["Usage"][..]),
        (&["fly"], &["fly", "Usage"]),
        (&["run"], &["<PART>"]),
        (&["run", "circle.ngc", "--fast"], &["--fast"]),
        (
            &["run", "circle.ngc", "--controller", "cross-coupled"],
            &[
                "no controller is called 'cross-coupled'",
                "feedwright lab controllers",
            ],
        ),
        (
            &["run", "circle.ngc", "--controller", "model-predictive"],
            &[
                "no controller is called 'model-predictive'",
                "feedwright lab controllers",
            ],
        ),
        (&["check", "missing.ngc"], &["missing.ngc", "No such file"]),
        (&["canon", "missing.ngc"], &["missing.ngc", "No such file"]),
    ] {
        let before = folder.content();
        folder.run(arguments).refused(says);
        assert_eq!(before, folder.content(), "{arguments:?}");
    }
}

#[test]
fn names_with_spaces_work() {
    let folder = Folder::new();
    folder.file("my part.ngc", crate::command::CIRCLE);
    folder
        .run_uncorrected(&["my part.ngc", "--trace", "the trace.csv"])
        .succeeded();
    assert!(folder.text("the trace.csv").starts_with("t_s,"));
    assert!(folder.text("my part.report.html").contains("my part.ngc"));
}

#[test]
#[cfg(target_os = "linux")]
fn names_that_are_no_text_work() {
    use std::os::unix::ffi::OsStrExt;

    let folder = Folder::new();
    let name = |bytes: &'static [u8]| OsStr::from_bytes(bytes);
    folder.file(name(b"fr\xe4se.ngc"), crate::command::CIRCLE);
    folder.file(name(b"fr\xe4se.toml"), TNV40);
    let arguments = [
        name(b"fr\xe4se.ngc"),
        OsStr::new("--machine"),
        name(b"fr\xe4se.toml"),
        OsStr::new("--json"),
        name(b"fr\xe4se.json"),
    ];
    folder.run_uncorrected(&arguments).succeeded();
    for written in [&b"fr\xe4se.report.html"[..], b"fr\xe4se.json"] {
        assert!(folder.path().join(OsStr::from_bytes(written)).is_file());
    }
}

/// A gain ninety times too high and a drive that gives all it asks for: a result, not an error.
#[test]
fn a_machine_that_diverges_is_a_result() {
    let folder = Folder::new();
    machine(
        &folder,
        "wild.toml",
        &[
            ("kp_1_s = 50", "kp_1_s = 4500"),
            ("torque_limit_nm = 30", "torque_limit_nm = 1e6"),
        ],
    );
    for controller in ["uncorrected", "magnitude-only", "two-dimensional"] {
        let outputs = [
            "--json", "r.json", "--trace", "t.csv", "--out", "s.csv", "--report", "r.html",
        ];
        let ran = folder.run(
            &[
                &[
                    "run",
                    "circle.ngc",
                    "--machine",
                    "wild.toml",
                    "--controller",
                    controller,
                ],
                &outputs[..],
            ]
            .concat(),
        );
        assert_eq!(ran.code, Some(1), "{ran:?}");
        assert!(
            ran.stdout.contains("diverged at 0.") && ran.stdout.contains("unstable"),
            "{ran:?}"
        );
        assert!(
            !ran.stdout.contains("NaN") && !ran.stdout.contains("inf"),
            "{ran:?}"
        );
        assert!(!ran.stdout.contains("RMS contour error"), "{ran:?}");
        let results: serde_json::Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
        for run in results["runs"].as_array().unwrap() {
            assert_eq!(run["outcome"]["kind"], "diverged");
            assert_eq!(run["engaged_at_end"], false);
            let unknown = ["time_s", "arrival_s", "rms_um", "max_um", "uncut_um"];
            assert!(unknown.iter().all(|key| run[key].is_null()), "{run}");
            let text = run.to_string();
            assert!(
                text.matches("null").count() == unknown.len() && !text.contains("NaN"),
                "{text}"
            );
        }
        assert!(!folder.text("t.csv").contains("NaN") && !folder.text("t.csv").contains("inf"));
        assert!(
            ran.stdout.contains("s.csv was not written") && !folder.path().join("s.csv").exists(),
            "{ran:?}"
        );
        assert!(!folder.text("r.html").contains("NaN"));
    }
}

/// The figures of the beginning of a cut are not those of the cut.
#[test]
fn a_correction_of_a_machine_that_diverges_has_no_figures() {
    let folder = Folder::new();
    machine(
        &folder,
        "wild.toml",
        &[
            ("kp_1_s = 50", "kp_1_s = 4500"),
            ("torque_limit_nm = 30", "torque_limit_nm = 1e6"),
        ],
    );
    let arguments = [
        "correct",
        "circle.ngc",
        "--machine",
        "wild.toml",
        "--json",
        "c.json",
        "--tolerance",
        "1e6",
    ];
    let ran = folder.run(&arguments);
    assert_eq!(ran.code, Some(1), "{ran:?}");
    assert!(
        ran.stdout
            .contains("no corrected program: the servo loop is unstable"),
        "{ran:?}"
    );
    assert!(
        ran.stdout.contains("out of tolerance: max - um") && !ran.stdout.contains("NaN"),
        "{ran:?}"
    );
    let results: serde_json::Value = serde_json::from_slice(&folder.read("c.json")).unwrap();
    assert_eq!(results["within_tolerance"], false);
    for program in ["uncorrected", "as_exported"] {
        let figures = &results[program];
        assert_eq!(figures["completed"], false);
        assert!(
            ["time_s", "rms_um", "max_um", "uncut_um"]
                .iter()
                .all(|key| figures[key].is_null()),
            "{figures}"
        );
    }
}

/// Identification writes into the cache, so an empty one shows that a mistake was found before
/// anything was simulated.
#[test]
fn a_wrong_input_is_found_before_anything_is_identified() {
    let folder = Folder::new();
    // Of no built-in machine: the program is not shipped with its model.
    folder.file("own.toml", TNV40.replacen("tnv40", "own", 1));
    folder.file("table.csv", "1 2\n3 4\n");
    folder.file("text.csv", "no log\n");
    // A log of X alone.
    folder.file("other.csv", text(HEAD, rows(1)));
    folder.file("bad.ngc", "G1 X1 F100 Q\n");
    folder.file("page.ngc", "<!DOCTYPE html>\n<html></html>\n");
    folder.file("bad.toml", "kp = x\n");
    let cases: [(&[&str], &[&str]); 18] = [
        (&["run", "circle.ngc", "--log", "none.csv"], &["none.csv"]),
        (
            &["run", "circle.ngc", "--log", "text.csv"],
            &["text.csv", "hint:"],
        ),
        (
            &["run", "circle.ngc", "--log", "other.csv"],
            &["other.csv", "circle.ngc"],
        ),
        (
            &["run", "circle.ngc", "--reference", "none.ngc"],
            &["none.ngc"],
        ),
        (
            &["run", "circle.ngc", "--reference", "bad.ngc"],
            &["bad.ngc", "mistake"],
        ),
        (
            &["run", "page.ngc"],
            &["page.ngc", "a web page (HTML)", "hint:"],
        ),
        (
            &["run", "circle.ngc", "--geometry", "bad.toml"],
            &["bad.toml"],
        ),
        (&["run", "circle.ngc", "--model", "bad.toml"], &["bad.toml"]),
        (
            &["run", "circle.ngc", "--tool-table", "none.tbl"],
            &["none.tbl"],
        ),
        (
            &["run", "circle.ngc", "--subroutines", "none"],
            &["none", "no folder"],
        ),
        (
            &["run", "circle.ngc", "--tolerance", "0"],
            &["--tolerance is 0 um", "above 0"],
        ),
        (
            &["run", "circle.ngc", "--set", "knots=1"],
            &["--set knots=1"],
        ),
        (
            &["run", "circle.ngc", "--json", "none/r.json"],
            &["none/r.json", "mkdir -p none"],
        ),
        (
            &["correct", "circle.ngc", "--log", "text.csv"],
            &["text.csv", "hint:"],
        ),
        (
            &["correct", "circle.ngc", "--log", "other.csv"],
            &["other.csv", "circle.ngc"],
        ),
        (&["correct", "page.ngc"], &["a web page (HTML)"]),
        (
            &["advise", "page.ngc", "--tolerance", "10"],
            &["a web page (HTML)"],
        ),
        (
            &["plan", "page.ngc", "--tolerance", "10"],
            &["a web page (HTML)"],
        ),
    ];
    for (arguments, reported) in cases {
        let mut command = folder.command();
        command
            .env("FEEDWRIGHT_CACHE", "kept")
            .args(arguments)
            .args(["--machine", "own.toml"]);
        Ran::from(command.output().unwrap()).refused(reported);
        assert!(!folder.path().join("kept").exists(), "{arguments:?}");
    }
}
