//! `excite`: its program passes `check`, is cut by `run`, and what is recorded meanwhile is read as a log without options.

use crate::command::Folder;
use feedwright_ident::{Columns, Fitness, Log, LogFormat};

#[test]
fn a_log_of_a_simulated_machine_is_recorded_while_it_cuts_the_program() {
    // The feedforward of stiff makes its position at the end of a servo period lead the command at its start.
    for (machine, sample_time_s) in [("tnv40", 1e-3), ("workshop", 1e-3), ("stiff", 5e-4)] {
        let folder = Folder::new();
        let told = folder.run(&["excite", "--machine", machine, "--out", "excite.ngc"]).succeeded().stdout;
        assert!(told.contains("3 axes, about") && told.contains("wrote excite.ngc"), "{told}");
        folder.run(&["check", "excite.ngc"]).succeeded();
        let open = ["--controller", "uncorrected", "--machine", machine, "--trace", "t.csv"];
        folder.run(&[&["run", "excite.ngc"], &open[..]].concat()).succeeded();
        let log = Log::read(&folder.path().join("t.csv"), &Columns::default()).unwrap();
        assert_eq!((log.format, log.sample_time_s), (LogFormat::TextTable, sample_time_s));
        assert_eq!(log.axes.iter().map(|axis| axis.name.as_str()).collect::<Vec<_>>(), ["x", "y", "z"]);
        let seconds = log.time_s.len() as f64 * log.sample_time_s;
        assert!((15.0..70.0).contains(&seconds), "{machine}: {seconds} s");
        for axis in &log.axes {
            assert_eq!(axis.verdict, Fitness::ForControl);
            assert!(axis.torque.is_some());
            let reach_mm = axis.command_mm.iter().fold(0.0_f64, |reach, command| reach.max(command.abs()));
            assert!((2.0..=10.0 + 1e-9).contains(&reach_mm), "{machine} {}: {reach_mm} mm", axis.name);
        }
    }
}

#[test]
fn what_cannot_be_is_refused_and_leaves_no_file() {
    let folder = Folder::new();
    for (arguments, part) in [
        (["--machine", "tnv40", "--travel", "0.5"], "2 to 1000 mm are possible"),
        (["--machine", "tnv41", "--travel", "20"], "no machine is called 'tnv41'"),
    ] {
        let ran = folder.run(&[&["excite", "--out", "e.ngc"], &arguments[..]].concat());
        assert!(ran.stderr.contains(part), "{}", ran.stderr);
        assert!(!folder.path().join("e.ngc").exists());
    }
}
