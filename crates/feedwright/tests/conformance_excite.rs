//! `excite`: its program passes `check`, is cut by `run`, and what is recorded meanwhile is read as
//! a log without options. So is the program of `identify --excite-next`, and with its log nothing
//! is open any more.

use crate::command::Folder;
use feedwright_ident::{Columns, Fitness, Log, LogFormat};

/// Needs 6 s of processor time: cuts the excitation on three machines.
#[test]
fn a_log_of_a_simulated_machine_is_recorded_while_it_cuts_the_program() {
    // The feedforward of stiff makes its position at the end of a servo period lead the command at
    // its start.
    for (machine, sample_time_s) in [("tnv40", 1e-3), ("workshop", 1e-3), ("stiff", 5e-4)] {
        let folder = Folder::new();
        let reported = folder
            .run(&["excite", "--machine", machine, "--out", "excite.ngc"])
            .succeeded()
            .stdout;
        assert!(
            reported.contains("3 axes, about") && reported.contains("wrote excite.ngc"),
            "{reported}"
        );
        folder.run(&["check", "excite.ngc"]).succeeded();
        // The log has the commands of the drives. If a geometry were compensated, they would differ
        // from the program.
        let open = [
            "--controller",
            "uncorrected",
            "--no-geometry",
            "--machine",
            machine,
            "--trace",
            "t.csv",
        ];
        folder
            .run(&[&["run", "excite.ngc"], &open[..]].concat())
            .succeeded();
        let log = Log::read(&folder.path().join("t.csv"), &Columns::default()).unwrap();
        assert_eq!(
            (log.format, log.sample_time_s),
            (LogFormat::TextTable, sample_time_s)
        );
        assert_eq!(
            log.axes
                .iter()
                .map(|axis| axis.name.as_str())
                .collect::<Vec<_>>(),
            ["x", "y", "z"]
        );
        let seconds = log.time_s.len() as f64 * log.sample_time_s;
        assert!((15.0..70.0).contains(&seconds), "{machine}: {seconds} s");
        for axis in &log.axes {
            assert_eq!(axis.verdict, Fitness::ForControl);
            assert!(axis.torque.is_some());
            let reach_mm = axis
                .command_mm
                .iter()
                .fold(0.0_f64, |reach, command| reach.max(command.abs()));
            assert!(
                (2.0..=10.0 + 1e-9).contains(&reach_mm),
                "{machine} {}: {reach_mm} mm",
                axis.name
            );
        }
    }
}

#[test]
fn what_cannot_be_is_refused_and_leaves_no_file() {
    let folder = Folder::new();
    for (arguments, part) in [
        (
            ["--machine", "tnv40", "--travel", "0.5"],
            "2 to 1000 mm are possible",
        ),
        (
            ["--machine", "tnv41", "--travel", "20"],
            "no machine is called 'tnv41'",
        ),
    ] {
        let ran = folder.run(&[&["excite", "--out", "e.ngc"], &arguments[..]].concat());
        assert!(ran.stderr.contains(part), "{}", ran.stderr);
        assert!(!folder.path().join("e.ngc").exists());
    }
}

/// Cuts a program uncorrected on tnv40, and writes what a log of its x axis has: the command, and
/// the position where it is given.
fn log_of_x(folder: &Folder, program: &str, log: &str) {
    let open = [
        "--controller",
        "uncorrected",
        "--machine",
        "tnv40",
        "--trace",
        "t.csv",
    ];
    folder
        .run(&[&["run", program], &open[..]].concat())
        .succeeded();
    let trace = std::fs::read_to_string(folder.path().join("t.csv")).unwrap();
    let rows: Vec<Vec<&str>> = trace
        .lines()
        .map(|line| line.split(',').collect())
        .collect();
    let column = |name: &str| rows[0].iter().position(|column| *column == name).unwrap();
    let (t, command, actual) = (column("t_s"), column("cmd_x_mm"), column("act_x_mm"));
    // A row has the position at the end of its servo period.
    let pairs = rows[1..]
        .windows(2)
        .map(|pair| format!("{} {} {}\n", pair[1][t], pair[1][command], pair[0][actual]));
    std::fs::write(
        folder.path().join(log),
        format!("t x.cmd x.act\n{}", pairs.collect::<String>()),
    )
    .unwrap();
}

/// Needs 11 s of processor time: identifies an axis twice.
#[test]
fn what_a_log_leaves_open_is_named_written_as_a_program_and_closed_by_its_log() {
    let folder = Folder::new();
    let forward = [
        (600, 3.0),
        (2400, 6.0),
        (60, 0.3),
        (1200, 4.0),
        (300, 1.0),
        (1800, 4.0),
        (3000, 0.5),
        (2400, 6.0),
    ];
    let moves: String = forward
        .iter()
        .map(|(feed, mm)| format!("G1 X{mm} F{feed}\nG4 P0.05\n"))
        .collect();
    std::fs::write(
        folder.path().join("forward.ngc"),
        format!("G21 G91 G61\n{moves}{moves}G90\nM2\n"),
    )
    .unwrap();
    log_of_x(&folder, "forward.ngc", "one.txt");
    let identify = [
        "--record-delay",
        "0",
        "--out",
        "mine.toml",
        "--json",
        "mine.json",
        "--excite-next",
    ];
    let reported = folder
        .run(&[&["identify", "one.txt"], &identify[..], &["next.ngc"]].concat())
        .succeeded()
        .stdout;
    let reported = reported.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        reported.contains("what is open would be settled by") && reported.contains("reversals"),
        "{reported}"
    );
    let text = std::fs::read_to_string(folder.path().join("next.ngc")).unwrap();
    assert!(
        text.contains("- the axes stand at x = 24.8 mm: the middle of what the log covers"),
        "{text}"
    );
    assert!(
        text.contains("; reversals at constant speeds, for ") && !text.contains("; y alone"),
        "{text}"
    );
    let json = std::fs::read_to_string(folder.path().join("mine.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    let next = &json["axes"]["x"]["next_motion"];
    assert!(
        next.as_array().unwrap().contains(&"reversals".into()),
        "{next}"
    );
    log_of_x(&folder, "next.ngc", "two.txt");
    let both = ["identify", "one.txt", "two.txt"];
    let reported = folder
        .run(&[&both, &identify[..], &["again.ngc"]].concat())
        .succeeded()
        .stdout;
    assert!(
        reported
            .contains("nothing is open that other motion would settle: again.ngc is not written"),
        "{reported}"
    );
    assert!(!folder.path().join("again.ngc").exists());
    let refused = folder.run(&[&both, &identify[..], &["two.txt"]].concat());
    assert!(refused.stderr.contains("two.txt"), "{}", refused.stderr);
    assert!(
        std::fs::read_to_string(folder.path().join("two.txt"))
            .unwrap()
            .starts_with("t x.cmd"),
        "the log stays"
    );
}
