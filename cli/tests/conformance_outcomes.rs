//! What a run leaves: exit codes, files, and nothing where it was interrupted.

#[path = "common/bench.rs"]
mod common;

use common::{Bench, Said, repository};

const SHORT: &str = "(three cuts)\nG21 G90 F1200\nG0 X2\nG1 X6\nG3 X6 Y4 I0 J2\nS800 M3\nG1 X2\nM2\n";

#[test]
fn within_tolerance_is_0_and_out_of_it_is_1() {
    let bench = Bench::new();
    bench.write("part.ngc", SHORT);
    let run = |tolerance: &str| bench.run(&["run", "part.ngc", "--controller", "open-loop", "--tolerance", tolerance]);
    let (wide, narrow) = (run("1000"), run("0.001"));
    assert_eq!((wide.code, narrow.code), (Some(0), Some(1)), "{}{}", wide.err, narrow.err);
    assert_eq!(wide.err, "", "no progress where stderr is no terminal");
    assert!(wide.out.contains("open-loop") && narrow.out.contains("out of tolerance"));
}

#[test]
fn all_outputs_appear_and_two_runs_are_the_same_to_the_last_bit() {
    let bench = Bench::new();
    bench.write("part.ngc", SHORT);
    let files = ["a.csv", "a.json", "b.csv", "b.ngc", "c.csv", "c.ngc"];
    let run = |trace: &str, out: &str| {
        let said = bench.run(&[
            "run",
            "part.ngc",
            "--controller",
            "open-loop",
            "--trace",
            trace,
            "--json",
            "a.json",
            "--out",
            out,
        ]);
        assert_eq!(said.code, Some(0), "{}", said.err);
    };
    run("a.csv", "b.ngc");
    run("b.csv", "c.ngc");
    run("b.csv", "c.csv");
    let mut expected: Vec<&str> = [&files[..], &["part.ngc", "part.report.html"]].concat();
    expected.sort_unstable();
    assert_eq!(bench.names(), expected);
    let read = |name: &str| std::fs::read_to_string(bench.path().join(name)).unwrap();
    assert_eq!(read("a.csv"), read("b.csv"));
    assert_eq!(read("b.ngc"), read("c.ngc"));
    assert!(read("a.csv").starts_with("t_s,s_mm,line,feed_plan_mm_s,path_x_mm,"));
    assert_eq!(read("c.csv").lines().count(), read("a.csv").lines().count(), "a setpoint for every row");
    let results: serde_json::Value = serde_json::from_str(&read("a.json")).unwrap();
    for key in ["controller", "machine", "part", "time_s", "rms_um", "max_um", "max_deviation_um", "tick_median_us"] {
        assert!(results["runs"][0].get(key).is_some(), "runs[0].{key}");
    }
    let corrected = read("b.ngc");
    assert!(corrected.contains("\nS800\nM3\n") && corrected.ends_with("\nM2\n"), "{corrected}");
    assert_eq!(bench.run(&["check", "b.ngc"]).code, Some(0), "the corrected program reads back");
}

#[test]
fn a_machine_that_diverges_is_a_result_and_no_error() {
    let bench = Bench::new();
    bench.write("part.ngc", SHORT);
    let tnv40 = std::fs::read_to_string(repository("machines/tnv40.toml")).unwrap();
    bench.write("wild.toml", tnv40.replace("kp_1_s = 50", "kp_1_s = 90000").replace("= 30 ", "= 1e6 "));
    let said =
        bench.run(&["run", "part.ngc", "--controller", "open-loop", "--machine", "wild.toml", "--json", "r.json"]);
    assert_eq!(said.code, Some(1), "{}", said.err);
    assert!(said.out.contains("diverged at") && !said.out.contains("NaN"), "{}", said.out);
    let text = std::fs::read_to_string(bench.path().join("r.json")).unwrap();
    serde_json::from_str::<serde_json::Value>(&text).unwrap();
}

#[test]
fn lists_name_what_run_accepts() {
    let bench = Bench::new();
    let (machines, controllers) = (bench.run(&["machines"]), bench.run(&["controllers"]));
    assert!(machines.out.starts_with("tnv40 ") && machines.code == Some(0));
    assert!(controllers.out.contains("open-loop") && controllers.code == Some(0));
    assert_eq!(bench.run(&["check", repository("machines/tnv40.toml").to_str().unwrap()]).code, Some(0));
}

#[cfg(unix)]
#[test]
fn file_names_need_not_be_utf_8() {
    use std::os::unix::ffi::OsStrExt;
    let bench = Bench::new();
    let name = std::ffi::OsStr::from_bytes(b"t\xe9.ngc");
    std::fs::write(bench.path().join(name), SHORT).unwrap();
    let said = Said::of(bench.command().args(["run", "--controller", "open-loop"]).arg(name).output().unwrap());
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(bench.path().join(std::ffi::OsStr::from_bytes(b"t\xe9.report.html")).exists());
}

#[cfg(unix)]
#[test]
fn a_reader_that_goes_away_is_no_error() {
    let bench = Bench::new();
    let pocket = repository("parts/pocket.ngc");
    let mut child = bench
        .command()
        .arg("canon")
        .arg(pocket)
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let said = Said::of(child.wait_with_output().unwrap());
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
}

/// A program that takes minutes to cut is interrupted once its temporary files stand there.
#[cfg(unix)]
#[test]
fn an_interrupt_leaves_no_file() {
    let bench = Bench::new();
    let laps = "G1 X400\nG1 Y400\nG1 X0\nG1 Y0\n".repeat(20_000);
    bench.write("long.ngc", format!("G21 G90 F600\n{laps}M2\n"));
    let mut child = bench
        .command()
        .args([
            "run",
            "long.ngc",
            "--controller",
            "open-loop",
            "--trace",
            "t.csv",
            "--out",
            "o.ngc",
            "--json",
            "r.json",
        ])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    // Four outputs and the program; polled, since a process has no other sign of it.
    while bench.names().len() < 5 {
        assert!(child.try_wait().unwrap().is_none(), "it ended before its files were begun");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let kill = std::process::Command::new("kill").arg("-INT").arg(child.id().to_string()).status().unwrap();
    assert!(kill.success());
    let said = Said::of(child.wait_with_output().unwrap());
    assert_eq!(said.code, Some(130), "{}", said.err);
    assert_eq!(bench.names(), ["long.ngc"]);
    assert_eq!(said.out, "");
}
