//! The command line as such: `-` in place of files, units, widths, colors, help, version,
//! completions, manual pages.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};

use crate::command::{Folder, Ran, skipped};

/// All commands.
const COMMANDS: [&str; 19] = [
    "run",
    "correct",
    "advise",
    "plan",
    "diff",
    "sweep",
    "merge",
    "check",
    "open",
    "identify",
    "excite",
    "linuxcnc",
    "machines",
    "controllers",
    "canon",
    "block",
    "cache",
    "completions",
    "man",
];

/// Runs a command that gets `input` on its standard input.
fn fed(folder: &Folder, arguments: &[&str], input: &[u8]) -> Ran {
    let mut command = folder.command();
    let mut child = command
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stdin = child.stdin.take().unwrap();
    // A command that does not read it is not the fault of this end.
    let _ = stdin.write_all(input);
    drop(stdin);
    Ran::from(child.wait_with_output().unwrap())
}

const TNV40: &str = include_str!("../../sim/machines/tnv40.toml");

#[test]
fn a_dash_is_the_standard_input_wherever_a_file_is_read() {
    let folder = Folder::new();
    let uncorrected = ["--controller", "uncorrected"];
    let ran = fed(
        &folder,
        &[&["run", "-"], &uncorrected[..]].concat(),
        crate::command::CIRCLE.as_bytes(),
    )
    .succeeded();
    assert!(
        ran.stdout.contains("wrote stdin.report.html"),
        "{}",
        ran.stdout
    );
    let named = folder
        .run_uncorrected(&["circle.ngc", "--json", "named.json"])
        .succeeded();
    assert!(named.stdout.contains("wrote named.json"));
    for (arguments, input) in [
        (&["plan", "-"][..], crate::command::CIRCLE),
        (&["check", "-"], crate::command::CIRCLE),
        (&["canon", "-"], crate::command::CIRCLE),
        (
            &[
                "run",
                "circle.ngc",
                "--machine",
                "-",
                "--controller",
                "uncorrected",
            ],
            TNV40,
        ),
        (&["plan", "circle.ngc", "--machine", "-"], TNV40),
        (&["excite", "--machine", "-", "--out", "excite.ngc"], TNV40),
        (
            &["check", "circle.ngc", "--tool-table", "-"],
            "T1 P1 Z25.4 D6\n",
        ),
    ] {
        fed(&folder, arguments, input.as_bytes()).succeeded();
    }
    fed(&folder, &["run", "-", "--machine", "-"], b"")
        .refused(&["the program and --machine at once", "hint:"]);
    fed(&folder, &["check", "-"], b"G1 X1 Q\n").faulty(&["standard input:1"]);
    fed(&folder, &["run", "-"], b"").refused(&["standard input", "empty"]);
}

#[test]
fn a_dash_is_the_standard_output_wherever_a_file_is_written() {
    let folder = Folder::new();
    let before = folder.content();
    let ran = folder
        .run_uncorrected(&["circle.ngc", "--json", "-", "--report", "/dev/null"])
        .succeeded();
    let json: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!(
        (
            json["simulated"].as_bool(),
            json["assumed"]["axis_model"].as_str()
        ),
        (Some(true), Some("none"))
    );
    // The table is on stderr then.
    assert!(
        ran.stderr.contains("RMS um") && !ran.stderr.contains("wrote r"),
        "{}",
        ran.stderr
    );
    let ran = folder
        .run_uncorrected(&["circle.ngc", "--trace", "-", "--report", "/dev/null"])
        .succeeded();
    assert!(ran.stdout.starts_with("t_s,") && ran.stdout.lines().count() > 500);
    let ran = folder
        .run(&["excite", "--machine", "tnv40", "--out", "-"])
        .succeeded();
    assert!(
        ran.stdout.contains("G21") && ran.stderr.contains("axes"),
        "{ran:?}"
    );
    let ran = folder
        .run(&["plan", "circle.ngc", "--json", "-"])
        .succeeded();
    assert!(serde_json::from_str::<serde_json::Value>(&ran.stdout).is_ok());
    folder
        .run_uncorrected(&["circle.ngc", "--json", "-", "--trace", "-"])
        .refused(&["another output of this run goes there"]);
    assert_eq!(folder.content(), before);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_behind_the_standard_output_is_reported() {
    let folder = Folder::new();
    let full = || {
        std::fs::File::options()
            .write(true)
            .open("/dev/full")
            .unwrap()
    };
    for arguments in [
        &["plan", "circle.ngc"][..],
        &["plan", "circle.ngc", "--json", "-"],
        &["machines"],
        &["completions", "bash"],
        &["canon", "circle.ngc"],
    ] {
        let ran = Ran::from(
            folder
                .command()
                .args(arguments)
                .stdout(full())
                .output()
                .unwrap(),
        );
        assert_eq!(ran.code, Some(2), "{arguments:?}: {ran:?}");
        assert!(
            ran.stderr.contains("No space left on device") && !ran.stderr.contains("panicked"),
            "{}",
            ran.stderr
        );
    }
}

#[test]
fn a_feedrate_has_a_unit() {
    let folder = Folder::new();
    let time_s = |feed: &str| {
        folder
            .run_uncorrected(&["circle.ngc", "--feed", feed, "--json", "r.json"])
            .succeeded();
        let json: serde_json::Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
        json["runs"][0]["time_s"].as_f64().unwrap().to_bits()
    };
    assert_eq!(time_s("600mm/min"), time_s("10 mm/s"));
    let ran = folder.run_uncorrected(&["circle.ngc", "--feed", "50"]);
    ran.refused(&[
        "'50'",
        "--feed",
        "50mm/min is 0.833 mm/s",
        "50mm/s is 3000 mm/min",
    ]);
}

#[test]
fn everything_fits_eighty_columns_where_there_is_no_terminal() {
    let folder = Folder::new();
    folder.file("bad.ngc", "G1 X10 G555 F100\n");
    let wide = |text: &str| {
        text.lines()
            .filter(|line| line.chars().count() > 80)
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let machine = ["--machine", "tnv40"];
    for arguments in [
        &[
            &["run", "circle.ngc", "--controller", "feedforward"],
            &machine[..],
        ]
        .concat()[..],
        &["plan", "circle.ngc"],
        &["machines"],
        &["controllers"],
        &["controllers", "two-dimensional"],
        &["run", "circle.ngc", "--controller", "no-such"],
        &["check", "bad.ngc"],
        &["--help"],
    ] {
        let ran = Ran::from(
            folder
                .command()
                .env_remove("COLUMNS")
                .args(arguments)
                .output()
                .unwrap(),
        );
        assert_eq!(
            (wide(&ran.stdout), wide(&ran.stderr)),
            (vec![], vec![]),
            "{arguments:?}"
        );
    }
    let ran = folder.run(
        &[
            &["run", "circle.ngc", "--controller", "feedforward"],
            &machine[..],
        ]
        .concat(),
    );
    for says in [
        "Simulated, feedforward against uncorrected: RMS contour error",
        "peak torque of",
        "beside the program",
        "uncut um",
        "assumed: the machine is tnv40 (built in",
    ] {
        assert!(ran.reported().contains(says), "{says}: {}", ran.stdout);
    }
    let narrow = Ran::from(
        folder
            .command()
            .env("COLUMNS", "44")
            .args(["run", "circle.ngc", "--controller", "uncorrected"])
            .output()
            .unwrap(),
    );
    assert!(
        narrow.stdout.contains("no room for the columns"),
        "{}",
        narrow.stdout
    );
}

#[test]
fn colours_come_where_they_are_asked_for_and_a_dumb_terminal_gets_ascii() {
    let folder = Folder::new();
    folder.file("bad.ngc", "G1 X10 G555 F100\n");
    let reported = |arguments: &[&str], variables: &[(&str, &str)]| {
        let output = folder
            .command()
            .args(arguments)
            .envs(variables.iter().copied())
            .output()
            .unwrap();
        Ran::from(output).stderr
    };
    assert!(!reported(&["check", "bad.ngc"], &[]).contains('\u{1b}'));
    assert!(
        reported(
            &["check", "bad.ngc", "--color", "always"],
            &[("NO_COLOR", "1")]
        )
        .contains('\u{1b}')
    );
    assert!(reported(&["--color=always", "run"], &[]).contains('\u{1b}'));
    assert!(!reported(&["check", "bad.ngc", "--color", "never"], &[]).contains('\u{1b}'));
    let dumb = reported(&["check", "bad.ngc"], &[("TERM", "dumb")]);
    assert!(dumb.is_ascii() && dumb.contains("G555"), "{dumb}");
}

#[test]
fn every_command_has_a_short_help_and_a_long_one_and_a_version() {
    let folder = Folder::new();
    let root = folder.run(&["-h"]).succeeded().stdout;
    for command in COMMANDS {
        assert!(
            root.contains(&format!("\n  {command} ")),
            "{command} is not listed"
        );
        let [short, long] =
            ["-h", "--help"].map(|option| folder.run(&[command, option]).succeeded().stdout);
        assert!(long.len() > short.len(), "{command}");
        let examples = command != "controllers";
        assert_eq!(long.contains("Example"), examples, "{command}:\n{long}");
        assert!(
            folder
                .run(&[command, "--version"])
                .succeeded()
                .stdout
                .contains(env!("CARGO_PKG_VERSION"))
        );
    }
    let listed = root
        .lines()
        .take_while(|line| *line != "Options:")
        .filter(|line| line.starts_with("  "));
    // The commands, `lab`, which another program answers, and help itself; each on one line.
    assert_eq!(listed.count(), COMMANDS.len() + 2, "{root}");
}

/// Names of the options that a help shows. What is said of an option is indented by more.
fn options(help: &str) -> Vec<String> {
    let is_option = |line: &&str| {
        line.trim_start().starts_with('-') && line.len() - line.trim_start().len() <= 6
    };
    let names = help
        .lines()
        .filter(is_option)
        .filter_map(|line| line.split("--").nth(1));
    names
        .map(|name| name.split([' ', '=', '\n']).next().unwrap().to_owned())
        .collect()
}

#[test]
fn the_help_is_short_and_all_options_are_one_option_away() {
    let folder = Folder::new();
    let root = folder.run(&["--help"]).succeeded().stdout;
    for heading in ["Program:", "Machine:", "LinuxCNC:", "feedwright itself:"] {
        assert!(
            root.lines().any(|line| line == heading),
            "{heading}\n{root}"
        );
    }
    for command in COMMANDS {
        let of = |option: &str| options(&folder.run(&[command, option]).succeeded().stdout);
        let [short, long, all] = ["-h", "--help", "--help-all"].map(of);
        assert_eq!(
            BTreeSet::from_iter(&short),
            BTreeSet::from_iter(&long),
            "{command}"
        );
        assert!(
            short.len() <= 15 && short.contains(&"help-all".to_owned()),
            "{command}: {short:?}"
        );
        assert!(
            short.iter().all(|name| all.contains(name)),
            "{command}: {short:?} {all:?}"
        );
    }
    let all = folder.run(&["run", "--help-all"]).succeeded().stdout;
    for reported in [
        "--exact-settings",
        "--max-idle-lines",
        "Machine and cut:",
        "Controller:",
        "Results:",
    ] {
        assert!(all.contains(reported), "{reported}\n{all}");
    }
    assert!(
        !folder
            .run(&["run", "--help"])
            .succeeded()
            .stdout
            .contains("--exact-settings")
    );
    // The page and the completions have what the short help leaves out.
    folder.run(&["man", "--out", "man"]).succeeded();
    assert!(
        folder
            .text("man/feedwright-run.1")
            .contains("exact\\-settings")
    );
    assert!(
        folder
            .run(&["completions", "bash"])
            .succeeded()
            .stdout
            .contains("--exact-settings")
    );
}

#[test]
fn lengths_have_units_and_inches_are_printed_where_they_are_asked_for() {
    let folder = Folder::new();
    let tolerance_um = |text: &str| {
        folder.run_uncorrected(&[
            "circle.ngc",
            "--machine",
            "tnv40",
            "--tolerance",
            text,
            "--json",
            "r.json",
        ]);
        let json: serde_json::Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
        json["tolerance_um"].as_f64().unwrap()
    };
    assert_eq!(
        ["100", "100um", "0.1mm", "4thou"].map(tolerance_um),
        [100.0, 100.0, 100.0, 101.6]
    );
    folder
        .run(&["plan", "circle.ngc", "--tolerance", "10nm"])
        .refused(&["--tolerance", "no unit of a length", "um, mm, in"]);
    folder
        .run(&[
            "excite",
            "--machine",
            "tnv40",
            "--travel",
            "1in",
            "--out",
            "inch.ngc",
        ])
        .succeeded();
    folder
        .run(&[
            "excite",
            "--machine",
            "tnv40",
            "--travel",
            "25.4",
            "--out",
            "mm.ngc",
        ])
        .succeeded();
    assert_eq!(folder.text("inch.ngc"), folder.text("mm.ngc"));
    let run = |units: &str| {
        let ran = folder.run_uncorrected(&[
            "circle.ngc",
            "--machine",
            "tnv40",
            "--json",
            "r.json",
            "--units",
            units,
        ]);
        let json: serde_json::Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
        (
            ran.succeeded().stdout,
            json["runs"][0]["rms_um"].as_f64().unwrap(),
        )
    };
    let ((metric, rms_um), (inch, same_um)) = (run("metric"), run("inch"));
    assert_eq!(rms_um, same_um);
    let row = |text: &str| {
        let row = text
            .lines()
            .find(|line| line.starts_with("uncorrected "))
            .unwrap();
        row.split_whitespace().nth(2).unwrap().to_owned()
    };
    assert_eq!(
        (row(&metric), row(&inch)),
        (
            format!("{rms_um:.2}"),
            format!("{:.3}", row(&metric).parse::<f64>().unwrap() / 25.4)
        )
    );
    assert!(inch.contains("RMS thou") && !inch.contains(" um"), "{inch}");
}

#[test]
fn the_torques_of_the_table_are_those_of_the_headline() {
    let folder = Folder::new();
    folder.file(
        "long.ngc",
        "G21 G90 G64\nG1 X40 Y2 F1200\nX0 Y4\nX1 Y30\nM2\n",
    );
    for part in ["long.ngc", "circle.ngc"] {
        let ran = folder.run(&[
            "run",
            part,
            "--controller",
            "feedforward",
            "--json",
            "r.json",
        ]);
        let json: serde_json::Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
        let (_, rest) = ran.stdout.split_once("peak torque of ").unwrap();
        let axis = "XYZ".find(&rest[..1]).unwrap();
        for (run, name) in ["uncorrected", "feedforward"].iter().enumerate() {
            let row = ran
                .stdout
                .lines()
                .find(|line| line.starts_with(&format!("{name} ")))
                .unwrap();
            let torque_nm = json["runs"][run]["peak_torque_nm"][axis].as_f64().unwrap();
            assert_eq!(
                row.split_whitespace().nth(5).unwrap(),
                format!("{torque_nm:.2}"),
                "{part}: {}",
                ran.stdout
            );
        }
    }
}

#[test]
fn two_results_and_two_programs_are_compared() {
    let folder = Folder::new();
    folder.file("line.ngc", "G21 G90 F600\nG1 X10\nM2\n");
    folder
        .run_uncorrected(&["circle.ngc", "--machine", "tnv40", "--json", "a.json"])
        .succeeded();
    let slow = [
        "circle.ngc",
        "--machine",
        "tnv40",
        "--feed",
        "10mm/s",
        "--json",
        "b.json",
    ];
    folder.run_uncorrected(&slow).succeeded();
    let ran = folder
        .run(&["diff", "a.json", "b.json", "--report", "d.html"])
        .succeeded();
    let figure = |file: &str| {
        let json: serde_json::Value = serde_json::from_slice(&folder.read(file)).unwrap();
        json["runs"][0]["rms_um"].as_f64().unwrap()
    };
    let [before, after] = ["a.json", "b.json"].map(figure);
    let row = ran
        .stdout
        .lines()
        .find(|line| line.starts_with("RMS um "))
        .unwrap();
    let cells: Vec<&str> = row.split_whitespace().skip(2).collect();
    assert_eq!(
        cells,
        [
            format!("{before:.3}"),
            format!("{after:.3}"),
            format!("{:.3}", after / before)
        ]
    );
    assert!(folder.text("d.html").contains("Contour error [\u{b5}m]"));
    assert!(
        folder
            .run(&["diff", "circle.ngc", "line.ngc"])
            .succeeded()
            .stdout
            .contains("feed mm")
    );
    folder
        .run(&["diff", "circle.ngc", "a.json"])
        .refused(&["nothing in common", "hint:"]);
    folder.file("c.json", "{}");
    folder
        .run(&["diff", "a.json", "c.json"])
        .refused(&["c.json", "no result of run, correct or plan"]);
}

#[test]
fn what_is_kept_is_shown_and_removed() {
    let folder = Folder::new();
    let cache = |arguments: &[&str], place: &str| {
        let output = folder
            .command()
            .arg("cache")
            .args(arguments)
            .env("FEEDWRIGHT_CACHE", place)
            .output()
            .unwrap();
        Ran::from(output).succeeded().stdout
    };
    assert!(cache(&[], "").contains("nothing is kept"));
    assert!(cache(&[], "kept").contains("0 identified models"));
    std::fs::create_dir_all(folder.path().join("kept/aa")).unwrap();
    let model = format!("kept/aa/{}.json", "a".repeat(64));
    folder.file(&model, [b'x'; 250_000]);
    folder.file("kept/mine.json", "{}");
    let reported = cache(&[], "kept");
    assert!(
        reported.starts_with("kept\n")
            && reported.contains("1 identified model, 250 kB of at most 67109 kB"),
        "{reported}"
    );
    assert!(cache(&["--clear"], "kept").contains("removed 1 identified model from kept"));
    assert!(!folder.path().join(&model).exists() && folder.path().join("kept/mine.json").exists());
}

#[test]
fn shells_get_completions_and_man_its_pages() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = folder.run(&["completions", shell]).succeeded().stdout;
        assert!(
            script.contains("advise") && script.contains("tolerance"),
            "{shell}"
        );
    }
    folder
        .run(&["completions", "bash", "--out", "fw.bash"])
        .succeeded();
    match Command::new("bash")
        .arg("-n")
        .arg(folder.path().join("fw.bash"))
        .status()
    {
        Ok(status) => assert!(status.success()),
        Err(_) => skipped("the script of bash is not read by bash, which is not installed"),
    }
    folder.run(&["man", "--out", "man"]).succeeded();
    let pages = std::fs::read_dir(folder.path().join("man"))
        .unwrap()
        .count();
    assert_eq!(pages, COMMANDS.len() + 2);
    let page = folder.text("man/feedwright-run.1");
    assert!(
        page.contains(".TH feedwright-run 1") && page.contains("tolerance") && page.contains("jq"),
        "{page}"
    );
}

#[test]
fn what_a_killed_run_left_is_cleaned_up() {
    let folder = Folder::new();
    folder.file(".feedwright-Ab12Cd.part", "half of a trace");
    folder.run_uncorrected(&["circle.ngc"]).succeeded();
    assert!(!folder.path().join(".feedwright-Ab12Cd.part").exists());
}

/// Trains the identifier of the paper, once for each cache.
#[test]
fn a_damaged_cache_is_found_and_an_empty_name_turns_it_off() {
    let folder = Folder::new();
    let cut = |cache: &str| {
        let arguments = [
            "run",
            "circle.ngc",
            "--machine",
            "tnv40",
            "--controller",
            "two-dimensional",
            "--json",
            "r.json",
        ];
        let ran = Ran::from(
            folder
                .command()
                .args(arguments)
                .env("FEEDWRIGHT_CACHE", cache)
                .output()
                .unwrap(),
        )
        .succeeded();
        let json: serde_json::Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
        (json["runs"][1]["rms_um"].as_f64().unwrap().to_bits(), ran)
    };
    let (first, _) = cut("cache");
    let entries = |folder: PathBuf| {
        let entries = std::fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().path())
    };
    let kept: Vec<_> = entries(folder.path().join("cache"))
        .flat_map(entries)
        .collect();
    let [file] = &kept[..] else {
        panic!("{kept:?}")
    };
    let text = std::fs::read_to_string(file).unwrap();
    // A digit of a weight: the file reads as before, and says something else.
    let at = text
        .rfind(|c: char| c.is_ascii_digit() && c != '9')
        .unwrap();
    let at = text[..at].find("0.").map_or(at, |from| from + 3);
    let mut damaged = text.clone().into_bytes();
    damaged[at] = if damaged[at] == b'9' { b'1' } else { b'9' };
    std::fs::write(file, &damaged).unwrap();
    assert_eq!(cut("cache").0, first);
    assert_eq!(
        std::fs::read_to_string(file).unwrap(),
        text,
        "it was made anew"
    );
    let before = folder.content().len();
    assert_eq!(cut("").0, first);
    assert_eq!(folder.content().len(), before, "an empty name is no folder");
}

/// Copies the command into a folder that has no laboratory beside it, and starts one that stands
/// for it once it is there.
#[cfg(unix)]
#[test]
fn the_laboratory_is_started_where_it_is_installed() {
    // A shell writes what is run: a file that this process had open for writing may be open still
    // in a child that another test is just starting, and such a file cannot be run.
    let folder = Folder::new();
    let shell = |script: &str| {
        let status = Command::new("sh")
            .args(["-c", script])
            .current_dir(folder.path())
            .status()
            .unwrap();
        assert!(status.success(), "{script}");
    };
    shell(concat!(
        "cp '",
        env!("CARGO_BIN_EXE_feedwright"),
        "' feedwright"
    ));
    let binary = folder.path().join("feedwright");
    let run = || {
        let arguments = ["lab", "compare", "--only", "circle", "--help"];
        Ran::from(
            Command::new(&binary)
                .args(arguments)
                .env("PATH", folder.path().join("none"))
                .output()
                .unwrap(),
        )
    };
    run().refused(&[
        "the laboratory is not installed",
        "cargo install --path lab",
    ]);
    shell(
        "printf '#!/bin/sh\\necho \"$@\"\\nexit 7\\n' > feedwright-lab && chmod +x feedwright-lab",
    );
    let ran = run();
    assert_eq!(
        (ran.code, ran.stdout.as_str()),
        (Some(7), "compare --only circle --help\n"),
        "{ran:?}"
    );
}

#[test]
fn a_built_in_machine_is_written_as_a_file_to_start_from() {
    let folder = Folder::new();
    let ran = folder
        .run(&["machines", "workshop", "--out", "mine.toml"])
        .succeeded();
    assert!(ran.reported().contains("wrote mine.toml"), "{ran:?}");
    folder.run(&["check", "mine.toml"]).succeeded();
    assert_eq!(
        folder.run(&["machines", "workshop"]).succeeded().stdout,
        folder.text("mine.toml")
    );
    let rows = |machine: &str| {
        let json = format!("{}.json", machine.len());
        folder
            .run_uncorrected(&["circle.ngc", "--machine", machine, "--json", &json])
            .succeeded();
        let results: serde_json::Value = serde_json::from_slice(&folder.read(json)).unwrap();
        results["runs"][0]["rms_um"].clone()
    };
    assert_eq!(rows("mine.toml"), rows("workshop"));
    folder
        .run(&["machines", "workshp", "--out", "other.toml"])
        .refused(&["workshp", "did you mean 'workshop'?"]);
    folder
        .run(&["machines", "mine.toml"])
        .refused(&["no built-in machine", "feedwright machines"]);
    assert!(!folder.path().join("other.toml").exists());
}

#[test]
fn a_controller_is_shown_with_its_source_its_gains_and_the_units_of_its_parameters() {
    let folder = Folder::new();
    for (name, parts) in [
        (
            "lqg-identified",
            [
                "source: Anderson and Moore",
                "gains: computed when it starts",
                "servo periods squared, allowed",
            ],
        ),
        (
            "two-dimensional",
            [
                "source: Lee, Cho and Jeon",
                "gains: none",
                "feed_period_s = 0.01 s, allowed",
            ],
        ),
        (
            "feedforward",
            [
                "source: Masory",
                "from the model",
                "velocity_gain = 1 times the feedforward of the exact model",
            ],
        ),
    ] {
        let reported = folder.run(&["controllers", name]).succeeded().reported();
        assert!(
            parts.iter().all(|part| reported.contains(part)),
            "{reported}"
        );
    }
}

#[test]
fn a_rate_of_planning_is_printed_of_programs_that_are_long_enough_for_one() {
    let folder = Folder::new();
    assert!(
        !folder
            .run(&["plan", "circle.ngc"])
            .succeeded()
            .reported()
            .contains("blocks/s")
    );
    let lines: String = (1..1200)
        .map(|k| format!("G1 X{}\n", f64::from(k % 7) * 0.1))
        .collect();
    folder.file("long.ngc", format!("G21 G90 G64 F1200\n{lines}M2\n"));
    assert!(
        folder
            .run(&["plan", "long.ngc"])
            .succeeded()
            .reported()
            .contains("blocks/s")
    );
}
