//! A trace proves itself: a script that shares nothing with the program computes the act columns from the machine file and
//! the cmd columns, to 1 nm, whatever controller made the command.
//!
//! The script: `oracle_scripts/resimulate.py`, written from the servo law.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

use std::path::{Path, PathBuf};
use std::process::Command;

use feedwright::controllers::{CONTROLLERS, Choices, Entry};
use feedwright::machine::Machine;
use feedwright::pipeline::{self, Job, Outputs};

/// Lines of the pocket that are cut: tool change, dwell, rapids, the first helix and the first passes of a level.
const POCKET_LINES: usize = 30;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// A Python that reads TOML: 3.11 or newer.
fn python() -> Option<&'static str> {
    ["python3", "python"].into_iter().find(|python| {
        Command::new(python).args(["-c", "import tomllib"]).output().is_ok_and(|output| output.status.success())
    })
}

fn trace(part: &Path, entry: &'static Entry, trace: &Path) -> usize {
    let job = Job {
        part: part.to_owned(),
        machine: Machine::read(&root().join("machines/tnv40.toml")).unwrap(),
        controller: entry,
        against: entry,
        feed_mm_s: None,
        choices: Choices::default(),
        tolerance_um: None,
        reader: feedwright::gcode::Settings::default(),
        inputs: Vec::new(),
        outputs: Outputs { trace: Some(trace.to_owned()), ..Outputs::default() },
    };
    let outcome = pipeline::run(&job, &mut ()).unwrap();
    outcome.report.runs[0].summary.axes
}

#[test]
fn the_machine_file_and_the_command_give_the_tool_positions() {
    let Some(python) = python() else {
        eprintln!("SKIPPED: there is no Python 3.11 or newer to re-simulate with");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let pocket = std::fs::read_to_string(root().join("parts/pocket.ngc")).unwrap();
    let lines: Vec<&str> = pocket.lines().take(POCKET_LINES).chain(["M2\n"]).collect();
    let short = folder.path().join("pocket.ngc");
    std::fs::write(&short, lines.join("\n")).unwrap();
    let part = |name: &str| root().join("parts").join(name);
    for (part, axes) in [(part("circle.ngc"), 2), (part("star.ngc"), 2), (part("square.ngc"), 2), (short, 3)] {
        for entry in CONTROLLERS {
            let file = folder.path().join("trace.csv");
            assert_eq!(trace(&part, entry, &file), axes);
            let script = root().join("core/tests/oracle_scripts/resimulate.py");
            let output =
                Command::new(python).arg(script).arg(root().join("machines/tnv40.toml")).arg(&file).output().unwrap();
            let said = String::from_utf8_lossy(&output.stdout);
            let failed = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{}, {}: {said}{failed}", part.display(), entry.name);
            // The script may only pass where it has looked at every axis.
            assert_eq!(said.lines().filter(|line| line.contains(" nm over ")).count(), axes, "{said}");
        }
    }
}

/// The script does not accept everything.
#[test]
fn a_trace_with_a_wrong_position_is_found_out() {
    let Some(python) = python() else {
        eprintln!("SKIPPED: there is no Python 3.11 or newer to re-simulate with");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("trace.csv");
    trace(&root().join("parts/circle.ngc"), &CONTROLLERS[0], &file);
    let text = std::fs::read_to_string(&file).unwrap();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let column = lines[0].split(',').position(|name| name == "act_x_mm").unwrap();
    let mut fields: Vec<String> = lines[500].split(',').map(str::to_owned).collect();
    fields[column] = (fields[column].parse::<f64>().unwrap() + 2e-6).to_string();
    lines[500] = fields.join(",");
    std::fs::write(&file, lines.join("\n")).unwrap();
    let script = root().join("core/tests/oracle_scripts/resimulate.py");
    let output = Command::new(python).arg(script).arg(root().join("machines/tnv40.toml")).arg(&file).output().unwrap();
    assert_eq!(output.status.code(), Some(1), "2 nm off were not noticed");
}
