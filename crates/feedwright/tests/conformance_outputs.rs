//! Machine files that are checked, and what an interrupt leaves: nothing.

use std::process::Stdio;
use std::time::Duration;

use crate::command::{Folder, Ran};

#[test]
fn check_reads_machine_files_too() {
    let folder = Folder::new();
    let tnv40 = include_str!("../../sim/machines/tnv40.toml");
    folder.file("fine.toml", tnv40);
    folder.file("bad.toml", tnv40.replace("kd = 0 ", "kd = nan "));
    assert!(
        folder
            .run(&["check", "fine.toml"])
            .succeeded()
            .stdout
            .contains("machine tnv40, 3 axes")
    );
    folder.run(&["check", "bad.toml"]).faulty(&[
        "3 faults",
        "bad.toml:32:6",
        "hint: write a finite number",
    ]);
}

/// The program takes minutes to cut; the interrupt comes once its hidden files stand there.
#[cfg(unix)]
#[test]
fn an_interrupt_leaves_no_file() {
    for signal in ["-INT", "-TERM"] {
        let folder = Folder::new();
        let laps = "G1 X400\nG1 Y400\nG1 X0\nG1 Y0\n".repeat(20_000);
        folder.file("long.ngc", format!("G21 G90 F600\n{laps}M2\n"));
        let before = folder.content();
        let outputs = [
            "--trace", "t.csv", "--out", "o.csv", "--json", "r.json", "--report", "r.html",
        ];
        let mut command = folder.command();
        command
            .args(["run", "long.ngc", "--controller", "uncorrected"])
            .args(outputs);
        let mut child = command
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let files = || std::fs::read_dir(folder.path()).unwrap().count();
        // A process gives no other sign of having begun its files than the files.
        while files() < before.len() + 4 {
            assert!(
                child.try_wait().unwrap().is_none(),
                "it ended before its files were begun"
            );
            std::thread::sleep(Duration::from_millis(5));
        }
        let sent = std::process::Command::new("kill")
            .arg(signal)
            .arg(child.id().to_string())
            .status();
        assert!(sent.unwrap().success());
        let ran = Ran::from(child.wait_with_output().unwrap());
        assert_eq!((ran.code, ran.stdout.as_str()), (Some(130), ""), "{ran:?}");
        assert_eq!(folder.content(), before, "something is left");
    }
}
