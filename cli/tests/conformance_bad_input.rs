//! Bad input: exit code 2, a message that names the place, nothing on stdout, and no new file.

#[path = "common/bench.rs"]
mod common;

use common::{Bench, repository};

/// A short program without a fault.
const GOOD: &str = "G21 G90 F600\nG1 X1\nM2\n";

/// Runs, and checks what all refusals have in common; the message has to contain all of `says`.
fn refused(bench: &Bench, arguments: &[&str], says: &[&str]) {
    let before = bench.names();
    let said = bench.run(arguments);
    assert_eq!(said.code, Some(2), "{arguments:?}: {}", said.err);
    assert_eq!(said.out, "", "{arguments:?}");
    assert_eq!(bench.names(), before, "{arguments:?} left something");
    for part in says {
        assert!(said.err.contains(part), "{arguments:?} does not say '{part}':\n{}", said.err);
    }
    assert!(
        !said.err.contains("panicked") && !said.err.contains("help:") && !said.err.contains('\u{1b}'),
        "{}",
        said.err
    );
}

#[test]
fn programs_that_are_none() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path().join("folder")).unwrap();
    bench.write("binary.ngc", [0x7f, b'E', b'L', b'F', 0, 1, 2, 3]);
    bench.write("empty.ngc", "");
    bench.write("still.ngc", "G21 G90\nM2\n");
    for command in ["run", "canon", "check"] {
        refused(&bench, &[command, "none.ngc"], &["none.ngc", "No such file"]);
        refused(&bench, &[command, "folder"], &["folder"]);
        refused(&bench, &[command, "binary.ngc"], &["binary.ngc"]);
        refused(&bench, &[command, "empty.ngc"], &["empty.ngc", "empty"]);
    }
    refused(&bench, &["run", "still.ngc"], &["still.ngc", "no motion"]);
}

#[test]
fn faults_of_a_program_come_in_one_go_with_their_places() {
    let bench = Bench::new();
    bench.write("bad.ngc", "G21 G90\nG1 X1\nG777\nG1 F100 X2\nG2 X5 Y5 I1 J7\nM2\n");
    let places = ["bad.ngc:2:", "bad.ngc:3:", "bad.ngc:5:", "G777"];
    refused(&bench, &["run", "bad.ngc"], &places);
    refused(&bench, &["check", "bad.ngc"], &places);
}

#[test]
fn numbers_that_no_machine_has() {
    let bench = Bench::new();
    bench.write("far.ngc", format!("G21 G90 F100\nG1 X1{}\nM2\n", "0".repeat(300)));
    bench.write("still.ngc", "G21 G90 F0\nG1 X1\nM2\n");
    refused(&bench, &["run", "far.ngc"], &["far.ngc:2:"]);
    refused(&bench, &["run", "still.ngc"], &["still.ngc:"]);
}

#[test]
fn machines_that_are_none() {
    let bench = Bench::new();
    bench.write("part.ngc", GOOD);
    let tnv40 = std::fs::read_to_string(repository("machines/tnv40.toml")).unwrap();
    bench.write("nan.toml", tnv40.replace("kd = 0 ", "kd = nan "));
    bench.write("typo.toml", tnv40.replacen("kd = 0 ", "kd = 0\ninertia = 1 ", 1));
    bench.write("negative.toml", tnv40.replacen("0.0103", "-0.0103", 1));
    bench.write("binary.toml", [0xff, 0xfe, 0]);
    bench.write("broken.toml", "name = \n");
    let run = |machine: &str, says: &[&str]| refused(&bench, &["run", "part.ngc", "--machine", machine], says);
    run("tnv4", &["no machine is called 'tnv4'", "hint: did you mean 'tnv40'?"]);
    run("none.toml", &["none.toml", "No such file", "hint: "]);
    run("nan.toml", &["3 faults", "kd is NaN", "nan.toml:32:", "nan.toml:45:", "hint: write a finite number"]);
    run("typo.toml", &["unknown key 'inertia'", "hint: did you mean 'inertia_kg_m2'?"]);
    run("negative.toml", &["-0.0103 kg m2", "between", "hint: is the sign wrong?"]);
    run("binary.toml", &["binary.toml is not text"]);
    run("broken.toml", &["broken.toml:1:"]);
    run(".", &["hint: "]);
    refused(&bench, &["check", "nan.toml"], &["3 faults"]);
}

#[test]
fn options_that_make_no_sense() {
    let bench = Bench::new();
    bench.write("part.ngc", GOOD);
    let run = |option: &str, says: &[&str]| refused(&bench, &["run", "part.ngc", option], says);
    run("--feed=nan", &["--feed", "NaN"]);
    run("--feed=0", &["--feed", "0"]);
    run("--feed=-5", &["--feed", "-5"]);
    run("--feed=fast", &["--feed", "fast"]);
    run("--tolerance=-1", &["--tolerance"]);
    run("--rho=7", &["--rho", "0.1"]);
    run("--controller=open-lop", &["open-lop", "open-loop"]);
    run("--against=nothing", &["nothing", "open-loop"]);
    run("--frobnicate", &["--frobnicate"]);
    refused(&bench, &["frobnicate"], &["frobnicate"]);
}

#[test]
fn outputs_that_cannot_be() {
    let bench = Bench::new();
    bench.write("part.ngc", GOOD);
    std::fs::copy(repository("machines/tnv40.toml"), bench.path().join("mine.toml")).unwrap();
    std::fs::create_dir(bench.path().join("folder")).unwrap();
    for option in ["--trace", "--json", "--report"] {
        let run = |place: &str, says: &[&str]| {
            refused(
                &bench,
                &["run", "part.ngc", "--machine", "mine.toml", "--controller", "open-loop", option, place],
                says,
            );
        };
        run("folder", &["cannot write folder", "directory"]);
        run("none/file", &["none/file", "hint: create the directory first: mkdir -p none"]);
        run("part.ngc", &["part.ngc", "this run reads"]);
        run("./folder/../part.ngc", &["this run reads"]);
        run("mine.toml", &["mine.toml", "this run reads"]);
        run("part.ngc/file", &["part.ngc/file"]);
    }
    refused(&bench, &["run", "part.ngc", "--out", "part.ngc"], &["this run reads"]);
    refused(&bench, &["run", "part.ngc", "--out", "file.doc"], &["file.doc", ".csv", ".ngc"]);
    refused(&bench, &["run", "part.ngc", "--json", "same", "--trace", "same"], &["another output of this run"]);
    refused(&bench, &["paper", "--out", "part.ngc"], &["part.ngc"]);
    assert_eq!(std::fs::read_to_string(bench.path().join("part.ngc")).unwrap(), GOOD);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_nothing_behind() {
    let bench = Bench::new();
    bench.write("part.ngc", GOOD);
    refused(
        &bench,
        &["run", "part.ngc", "--controller", "open-loop", "--trace", "/dev/full"],
        &["/dev/full", "No space left on device", "hint: make room"],
    );
}
