//! What the command hands over: exit codes, files, tables, and that nothing but the arguments
//! decides on them.

use std::io::Read;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use crate::command::{Folder, Ran, skipped};
use feedwright::{BASELINE, BEST};
use serde_json::Value;

/// Servo period of the machine of the paper, s.
const SERVO_S: f64 = 0.001;

const ALL_OUTPUTS: [&str; 8] = [
    "--trace", "t.csv", "--out", "s.csv", "--json", "r.json", "--report", "r.html",
];

fn results(folder: &Folder) -> Value {
    serde_json::from_slice(&folder.read("r.json")).unwrap()
}

#[test]
fn the_exit_code_says_whether_the_part_is_within_tolerance() {
    let folder = Folder::new();
    let run = |tolerance: &str| {
        folder.run_uncorrected(&[
            "circle.ngc",
            "--machine",
            "tnv40",
            "--json",
            "r.json",
            "--tolerance",
            tolerance,
        ])
    };
    run("1e6").succeeded();
    let max_um = results(&folder)["runs"][0]["max_um"].as_f64().unwrap();
    assert!(max_um > 1.0, "{max_um}");
    let (above, below) = ((max_um * 1.01).to_string(), (max_um * 0.99).to_string());
    assert!(
        run(&above)
            .succeeded()
            .reported()
            .contains("within tolerance: max")
    );
    assert_eq!(results(&folder)["within_tolerance"], true);
    let out = run(&below);
    assert_eq!(out.code, Some(1), "{out:?}");
    assert!(
        out.reported().contains("out of tolerance: max") && out.stdout.contains("um"),
        "{out:?}"
    );
    assert_eq!(results(&folder)["within_tolerance"], false);
    assert!(
        folder.path().join("circle.report.html").is_file(),
        "a part out of tolerance needs its report most"
    );
}

#[test]
fn the_terminal_begins_with_the_headline_of_the_page() {
    let folder = Folder::new();
    let cut = [
        "run",
        "circle.ngc",
        "--machine",
        "tnv40",
        "--controller",
        "feedforward",
        "--tolerance",
        "10",
    ];
    let ran = folder.run(&[&cut[..], &["--report", "r.html"]].concat());
    let page = folder.text("r.html");
    let (_, verdict) = page.split_once("<p class=\"verdict\">").unwrap();
    let (verdict, _) = verdict.split_once("</p>").unwrap();
    let text: String = verdict
        .split('<')
        .map(|piece| piece.split_once('>').map_or(piece, |(_, text)| text))
        .collect();
    let signs = [
        ("µ", "u"),
        ("→", "->"),
        ("−", "-"),
        ("²", "2"),
        ("±", "+-"),
        ("×", "x"),
    ];
    let headline = signs
        .iter()
        .fold(text, |text, (sign, plain)| text.replace(sign, plain));
    assert!(
        headline.contains("peak torque of") && headline.contains(" tolerance: max"),
        "{headline}"
    );
    assert!(
        ran.reported().starts_with(&headline),
        "{headline}\n{}",
        ran.stdout
    );
}

#[test]
fn the_json_has_the_documented_numbers_of_every_run() {
    let folder = Folder::new();
    folder
        .run(&["run", "circle.ngc", "--json", "r.json", "--exact-settings"])
        .succeeded();
    let results = results(&folder);
    let runs = results["runs"].as_array().unwrap();
    let names: Vec<&str> = runs
        .iter()
        .map(|run| run["controller"].as_str().unwrap())
        .collect();
    assert_eq!(names, [BASELINE, BEST]);
    for run in runs {
        assert_eq!(
            (run["machine"].as_str(), run["part"].as_str()),
            (Some("workshop"), Some("circle.ngc"))
        );
        assert_eq!(run["outcome"]["kind"], "completed");
        for key in [
            "time_s",
            "rms_um",
            "max_um",
            "uncut_um",
            "max_deviation_um",
            "tick_median_us",
        ] {
            let value = run[key]
                .as_f64()
                .unwrap_or_else(|| panic!("{key} is {}", run[key]));
            assert!(value.is_finite() && value >= 0.0, "{key} is {value}");
        }
        assert!(run["rms_um"].as_f64() <= run["max_um"].as_f64());
        // 4 pi mm at 20 mm/s, and up to speed and down again at 100 mm/s2.
        let time_s = run["time_s"].as_f64().unwrap();
        assert!((0.5..1.2).contains(&time_s), "{time_s}");
    }
}

#[test]
fn the_trace_has_the_documented_columns_and_a_row_a_servo_period() {
    let folder = Folder::new();
    folder.file("space.ngc", "G21 G90 G64\nG1 X1 Y1 Z1 F600\nX2 Z0\nM2\n");
    for (part, axes) in [
        ("circle.ngc", &["x", "y"][..]),
        ("space.ngc", &["x", "y", "z"]),
    ] {
        folder
            .run_uncorrected(&[
                part, "--trace", "t.csv", "--out", "s.csv", "--json", "r.json",
            ])
            .succeeded();
        let mut columns = ["t_s", "s_mm", "line", "feed_plan_mm_s"]
            .map(str::to_owned)
            .to_vec();
        for axis in axes {
            columns.extend(["path", "cmd", "act"].map(|what| format!("{what}_{axis}_mm")));
            columns.push(format!("torque_{axis}_nm"));
        }
        columns.push("contour_error_mm".to_owned());
        columns.extend(axes.iter().map(|axis| format!("corrected_{axis}_mm")));
        columns.push("cutting".to_owned());

        let trace = folder.text("t.csv");
        let mut lines = trace.lines();
        assert_eq!(lines.next().unwrap(), columns.join(","));
        let rows: Vec<Vec<f64>> = lines.map(numbers).collect();
        let results = results(&folder);
        assert_eq!(
            rows.len() as u64,
            results["runs"][0]["rows"].as_u64().unwrap()
        );
        for (n, row) in rows.iter().enumerate() {
            assert_eq!(row.len(), columns.len());
            assert!(
                (row[0] - n as f64 * SERVO_S).abs() < 1e-9,
                "row {n} is at {} s",
                row[0]
            );
        }
        assert!(rows.len() as f64 * SERVO_S >= results["runs"][0]["time_s"].as_f64().unwrap());

        let setpoints = folder.text("s.csv");
        let mut lines = setpoints.lines();
        let header: Vec<String> = axes.iter().map(|axis| format!(",{axis}_mm")).collect();
        assert_eq!(lines.next().unwrap(), format!("t_s{}", header.concat()));
        // Drives get the command of the joints; the geometry of the machine is compensated in it.
        let column_of = |axis: &&str| {
            columns
                .iter()
                .position(|column| *column == format!("cmd_{axis}_mm"))
                .unwrap()
        };
        let commands: Vec<usize> = axes.iter().map(column_of).collect();
        for (row, line) in rows.iter().zip(lines) {
            assert_eq!(
                numbers(line)[1..],
                commands
                    .iter()
                    .map(|&column| row[column])
                    .collect::<Vec<_>>()
            );
        }
    }
}

fn numbers(line: &str) -> Vec<f64> {
    line.split(',')
        .map(|field| field.parse().unwrap())
        .collect()
}

#[test]
fn two_runs_leave_the_same_bytes_whatever_the_locale() {
    let (first, second) = (Folder::new(), Folder::new());
    let arguments = [&["run", "circle.ngc", "--exact-settings"], &ALL_OUTPUTS[..]].concat();
    first.run(&arguments).succeeded();
    let mut command = second.command();
    command
        .args(&arguments)
        .env("LC_ALL", "de_DE.UTF-8")
        .env("LANG", "tr_TR.UTF-8")
        .env("TZ", "Asia/Tokyo");
    Ran::from(command.output().unwrap()).succeeded();
    for file in ["t.csv", "s.csv", "r.html"] {
        assert!(first.read(file) == second.read(file), "{file} differs");
    }
    // Only how long the computer took may differ.
    let without_times = |folder: &Folder| {
        let mut results = results(folder);
        for run in results["runs"].as_array_mut().unwrap() {
            run.as_object_mut()
                .unwrap()
                .retain(|key, _| !key.starts_with("tick_"));
        }
        results
    };
    assert_eq!(without_times(&first), without_times(&second));
}

#[test]
fn the_report_needs_nothing_but_itself() {
    let folder = Folder::new();
    folder.run_uncorrected(&["circle.ngc"]).succeeded();
    let page = folder.text("circle.report.html");
    assert!(
        page.trim_start()
            .to_lowercase()
            .starts_with("<!doctype html>")
            && page.trim_end().ends_with("</html>")
    );
    for attribute in ["src", "href"] {
        for quote in ["\"", "'", ""] {
            for scheme in ["http:", "https:", "//"] {
                assert!(
                    !page.contains(&format!("{attribute}={quote}{scheme}")),
                    "{attribute} to {scheme}"
                );
            }
        }
    }
    assert!(!page.contains("@import") && !page.contains("url(http"));
}

#[test]
fn a_controller_compared_against_itself_is_cut_once() {
    let folder = Folder::new();
    let ran = folder
        .run_uncorrected(&["circle.ngc", "--against", "uncorrected", "--json", "r.json"])
        .succeeded();
    assert_eq!(results(&folder)["runs"].as_array().unwrap().len(), 1);
    assert_eq!(ran.stdout.matches("\nuncorrected ").count(), 1, "{ran:?}");
}

#[test]
fn a_higher_feed_takes_less_time() {
    let folder = Folder::new();
    let time_s = |feed: &[&str]| {
        folder
            .run_uncorrected(&[&["circle.ngc", "--json", "r.json"], feed].concat())
            .succeeded();
        results(&folder)["runs"][0]["time_s"].as_f64().unwrap()
    };
    let (slow, programmed, fast) = (
        time_s(&["--feed", "5mm/s"]),
        time_s(&[]),
        time_s(&["--feed", "40 mm/s"]),
    );
    assert!(
        slow > 2.0 * programmed && programmed > fast,
        "{slow} {programmed} {fast}"
    );
    // 4 pi mm at 5 mm/s. To come up to it takes 2 sqrt(5 / 50000) s with workshop's jerk, half of
    // which is lost; so does the way down.
    assert!(
        (slow - (0.8 * std::f64::consts::PI + 0.02)).abs() < 0.002,
        "{slow}"
    );
}

#[test]
fn output_that_goes_to_no_terminal_has_no_escape_codes() {
    let folder = Folder::new();
    folder.file("bad.ngc", "G1 X1 F100\nG555\nM2\n");
    for colors in [
        ("NO_COLOR", "1"),
        ("CLICOLOR", "0"),
        ("TERM", "xterm-256color"),
    ] {
        for part in ["circle.ngc", "bad.ngc"] {
            let mut command = folder.command();
            command
                .args(["run", part, "--controller", "uncorrected"])
                .env(colors.0, colors.1);
            let ran = Ran::from(command.output().unwrap());
            assert!(
                !ran.stdout.contains('\u{1b}') && !ran.stderr.contains('\u{1b}'),
                "{ran:?}"
            );
            assert!(part == "bad.ngc" || ran.stderr.is_empty(), "{ran:?}");
        }
    }
}

#[test]
fn lists_name_all_there_is() {
    let folder = Folder::new();
    crate::controller_list::lists(&folder, feedwright::CONTROLLERS);
    let machines = folder.run(&["machines"]).succeeded().stdout;
    assert!(machines.starts_with("tnv40"), "{machines}");
    for command in ["run", "plan", "check", "canon", "machines", "controllers"] {
        assert!(
            folder
                .run(&[command, "--help"])
                .succeeded()
                .stdout
                .contains("Usage")
        );
    }
}

/// A program of 40000 lines, too long to cut in the time of a test.
fn long_program() -> String {
    let mut text = "G21 G90 G64\nF600\n".to_owned();
    for pass in 0..20_000 {
        text += &format!("G1 X{} Y{}\nX0\n", 50, f64::from(pass) * 0.1);
    }
    text + "M2\n"
}

#[test]
#[cfg(unix)]
fn a_reader_that_goes_away_is_no_error() {
    let folder = Folder::new();
    folder.file("long.ngc", long_program());
    let mut child = folder
        .command()
        .args(["-q", "canon", "long.ngc"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut first = [0; 100];
    child.stdout.take().unwrap().read_exact(&mut first).unwrap();
    let ran = Ran::from(child.wait_with_output().unwrap());
    assert_eq!(ran.stderr, "", "{ran:?}");
    // Standard output closes before the first byte: the exit code still gives the verdict of the
    // run.
    let reader_gone = |arguments: &[&str]| {
        let mut child = folder
            .command()
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        Ran::from(child.wait_with_output().unwrap())
    };
    for arguments in [
        &["machines"][..],
        &["controllers"],
        &["check", "circle.ngc"],
        &["run", "circle.ngc", "--controller", "uncorrected"],
    ] {
        let ran = reader_gone(arguments);
        assert_eq!((ran.code, &ran.stderr[..]), (Some(0), ""), "{arguments:?}");
    }
    let ran = reader_gone(&[
        "run",
        "circle.ngc",
        "--controller",
        "uncorrected",
        "--tolerance",
        "0.1",
    ]);
    assert_eq!((ran.code, &ran.stderr[..]), (Some(1), ""));
}

#[test]
#[cfg(target_os = "linux")]
fn a_standard_output_that_takes_nothing_is_an_error() {
    let folder = Folder::new();
    for arguments in [
        &["machines"][..],
        &["-q", "canon", "circle.ngc"],
        &["check", "circle.ngc"],
    ] {
        let full = std::fs::File::options()
            .write(true)
            .open("/dev/full")
            .unwrap();
        let output = folder
            .command()
            .args(arguments)
            .stdout(full)
            .output()
            .unwrap();
        Ran::from(output).refused(&["standard output", "No space left on device"]);
    }
}

#[test]
#[cfg(unix)]
fn an_interrupted_run_leaves_nothing() {
    for signal in ["INT", "TERM"] {
        let folder = Folder::new();
        folder.file("long.ngc", long_program());
        folder.file("r.json", "of yesterday");
        let before = folder.content();
        let mut command = folder.command();
        command
            .args(["run", "long.ngc", "--controller", "uncorrected"])
            .args(ALL_OUTPUTS);
        let mut child = command
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let writes = wait_until_it_writes(&mut child, &folder);
        let id = child.id().to_string();
        let signalled = Command::new("kill")
            .args([&format!("-{signal}"), &id])
            .status()
            .is_ok_and(|status| status.success());
        if !signalled {
            child.kill().unwrap();
        }
        let ran = Ran::from(child.wait_with_output().unwrap());
        if !signalled {
            return skipped("there is no `kill` to interrupt a run with");
        }
        assert!(writes, "no row was written: {ran:?}");
        assert_eq!(ran.code, Some(130), "{signal}: {ran:?}");
        assert_eq!(ran.stdout, "");
        assert!(
            ran.stderr.contains("interrupted") && ran.stderr.contains("no file was written"),
            "{ran:?}"
        );
        assert_eq!(before, folder.content(), "{signal}");
    }
}

/// Waits until a file under way has content; false if the command ends before.
#[cfg(unix)]
fn wait_until_it_writes(child: &mut Child, folder: &Folder) -> bool {
    while child.try_wait().unwrap().is_none() {
        let under_way = std::fs::read_dir(folder.path())
            .unwrap()
            .filter_map(Result::ok);
        if under_way
            .filter(|e| e.file_name().to_string_lossy().starts_with('.'))
            .any(|e| e.metadata().is_ok_and(|m| m.len() > 0))
        {
            return true;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    false
}

/// Position gains three times those of the paper: whatever the table says of it, a correction that
/// spoils the part is called that.
#[test]
fn a_controller_that_makes_it_worse_is_named() {
    let folder = Folder::new();
    let text = include_str!("../../sim/machines/tnv40.toml").replace("kp_1_s = 50", "kp_1_s = 150");
    folder.file("stiff.toml", text);
    let ran = folder
        .run(&[
            "run",
            "circle.ngc",
            "--machine",
            "stiff.toml",
            "--json",
            "r.json",
            "--exact-settings",
        ])
        .succeeded();
    let results = results(&folder);
    let of = |run: usize, key: &str| results["runs"][run][key].as_f64().unwrap();
    let worse = of(1, "rms_um") > of(0, "rms_um") && of(1, "max_um") > of(0, "max_um");
    assert_eq!(
        ran.reported()
            .contains("two-dimensional is worse than uncorrected"),
        worse,
        "{ran:?}"
    );
}
