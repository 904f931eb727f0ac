//! What LinuxCNC's `halsampler` records is read without options: commands and actual positions; a
//! feedback that is not connected, and one that is the command itself, are refused.
//!
//! The recording is made here, by LinuxCNC's HAL without its motion controller: a generator is the
//! command, a filter behind it the axis.

use std::os::unix::fs::{MetadataExt, PermissionsExt, chown};
use std::path::Path;
use std::process::{Command, Stdio};

use feedwright_ident::{Columns, Log, LogFormat, RefusalReason};

/// Samples, one a millisecond.
const SAMPLES: usize = 1500;
/// Samples that HAL keeps until `halsampler` fetches them: it may be late by a minute on a busy
/// machine.
const KEPT: usize = 60_000;
/// Longest time that another HAL may continue before this one starts, s.
const TURN_S: u32 = 200;
/// Number of attempts at a recording: without a real-time kernel HAL may fail to start on a busy
/// machine.
const TRIALS: usize = 3;
/// Part of the way to its input that the filter goes in a period: its output is behind by (1 - g) /
/// g periods.
const GAIN: f64 = 0.05;
/// Whom HAL runs as where it is started by root.
const NOBODY: u32 = 65534;

/// Sample number, command, position behind it, the command once more, and a pin without a signal.
fn hal() -> String {
    format!(
        "loadrt threads name1=servo-thread period1=1000000\nloadrt siggen num_chan=1\nloadrt lowpass count=1\n\
         loadrt sampler depth={KEPT} cfg=ffff\naddf siggen.0.update servo-thread\naddf lowpass.0 servo-thread\n\
         addf sampler.0 servo-thread\nsetp siggen.0.frequency 1.0\nsetp siggen.0.amplitude 5.0\nsetp lowpass.0.gain {GAIN}\n\
         net cmd siggen.0.sine => lowpass.0.in sampler.0.pin.0 sampler.0.pin.2\nnet act lowpass.0.out => sampler.0.pin.1\n\
         start\nloadusr -w halsampler -t -n {SAMPLES} log.txt\n"
    )
}

/// Records; none where there is no LinuxCNC, or another one is running.
fn record(folder: &Path) -> Option<String> {
    (0..TRIALS).find_map(|_| recorded(folder))
}

fn recorded(folder: &Path) -> Option<String> {
    let home = folder.join("home");
    std::fs::create_dir_all(&home).unwrap();
    std::fs::write(folder.join("log.hal"), hal()).unwrap();
    // One HAL at a time: its shared memory has fixed keys.
    let lock = std::env::temp_dir().join("lcnc_run.lock");
    let mut command = Command::new("flock");
    command
        .arg(format!("--timeout={TURN_S}"))
        .arg(lock)
        .args(["halrun", "-f", "log.hal"])
        .current_dir(folder)
        .env("HOME", &home);
    if std::fs::metadata(folder).unwrap().uid() == 0 {
        chown(&home, Some(NOBODY), Some(NOBODY)).unwrap();
        std::fs::set_permissions(folder, std::fs::Permissions::from_mode(0o755)).unwrap();
        command.env("RTAPI_UID", NOBODY.to_string());
    }
    let has_run = command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    has_run.ok().filter(|status| status.success())?;
    let text = std::fs::read_to_string(folder.join("log.txt")).ok()?;
    (text.lines().count() == SAMPLES).then_some(text)
}

/// Some columns of a recording.
fn columns(text: &str, wanted: [usize; 3]) -> String {
    let row = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        wanted.map(|i| words[i]).join(" ") + " \n"
    };
    text.lines().map(row).collect()
}

#[test]
fn a_recording_of_halsampler_is_read_without_options() {
    let folder = tempfile::tempdir().unwrap();
    let Some(text) = record(folder.path()) else {
        assert!(
            std::env::var_os("CI").is_none(),
            "halrun of LinuxCNC is missing, or does not run"
        );
        eprintln!("SKIPPED: no halrun of LinuxCNC, or it does not run");
        return;
    };
    let read = |head: &str, wanted: [usize; 3]| {
        let path = folder.path().join("part.txt");
        std::fs::write(&path, head.to_owned() + &columns(&text, wanted)).unwrap();
        Log::read(&path, &Columns::default())
    };
    let log = read("", [0, 1, 2]).unwrap();
    assert_eq!(
        (log.format, log.sample_time_s, log.axes.len()),
        (LogFormat::Halsampler, 1e-3, 1)
    );
    // By (1 - g) / g periods: 19 ms.
    let axis = &log.axes[0];
    let behind = (1.0 - GAIN) / GAIN;
    let speed = |k: usize| 0.5 * (axis.command_mm[k + 1] - axis.command_mm[k - 1]);
    let fast = (200..SAMPLES - 1)
        .max_by(|&a, &b| speed(a).abs().total_cmp(&speed(b).abs()))
        .unwrap();
    let lag = (axis.command_mm[fast] - axis.actual_mm[fast]) / speed(fast);
    assert!((lag - behind).abs() < 0.5, "{lag} periods");
    // A pin that never changes is no position by itself: the names say that it should be one.
    for (head, not_connected) in [("", [0, 1, 3]), ("# n x.cmd x.act\n", [0, 1, 4])] {
        let error = read(head, not_connected).unwrap_err();
        assert_eq!(
            error.reasons(),
            [RefusalReason::FeedbackNotConnected],
            "{error}"
        );
    }
}
