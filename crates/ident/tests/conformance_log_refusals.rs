//! Records of which no servo model can be made are refused, each with its reason, place, value and
//! limit.

use crate::logs::{SAMPLES, axis, read, rows, time_s};
use feedwright_ident::{LogError, Refusal, RefusalReason};

/// The only reason for which this table is refused.
fn refusal(header: &str, columns: &[&[f64]]) -> Refusal {
    let text = format!("{header}\n{}", rows(columns, ","));
    match read(text.as_bytes(), "") {
        Err(LogError::Refused { refusals, .. }) => match &refusals[..] {
            [only] => only.clone(),
            several => panic!("{several:?}"),
        },
        other => panic!("{other:?}"),
    }
}

fn assert_refused(refusal: &Refusal, reason: RefusalReason, part: &str) {
    assert_eq!(refusal.reason, reason, "{refusal}");
    assert!(refusal.message.contains(part), "{refusal}");
    assert!(refusal.hint.len() > 10, "{refusal:?}");
}

#[test]
fn ten_hertz_are_too_slow() {
    let (command, actual) = axis(20.0, 0.01);
    let time: Vec<f64> = (0..SAMPLES).map(|k| k as f64 / 10.0).collect();
    let found = refusal("t,x.cmd,x.act", &[&time, &command, &actual]);
    assert_refused(
        &found,
        RefusalReason::TooSlow,
        "every 100 ms (10 Hz); a servo model needs a sample every 50 ms",
    );
}

#[test]
fn three_digits_are_too_coarse() {
    let (command, actual) = axis(150.0, 0.7);
    let digits = |values: &[f64]| {
        values
            .iter()
            .map(|v| format!("{v:.2e}").parse().unwrap())
            .collect::<Vec<f64>>()
    };
    let found = refusal(
        "t,x.cmd,x.act",
        &[&time_s(), &digits(&command), &digits(&actual)],
    );
    assert_refused(
        &found,
        RefusalReason::TooCoarse,
        "at 150 mm they come in steps of 1 mm",
    );
    // An encoder with steps of 10 um over 10 mm also gives three digits. Its log is accepted.
    let (command, actual) = axis(5.0, 1.0);
    let steps: Vec<f64> = actual.iter().map(|v| (v * 100.0).round() / 100.0).collect();
    read(rows(&[&time_s(), &command, &steps], ",").as_bytes(), "").unwrap();
}

#[test]
fn feedback_that_is_not_connected_is_found() {
    let (command, _) = axis(20.0, 1.0);
    let still = vec![0.0; SAMPLES];
    let header = "t,x.cmd,x.act";
    let found = refusal(header, &[&time_s(), &command, &still]);
    assert_refused(
        &found,
        RefusalReason::FeedbackNotConnected,
        "of x is not connected: its actual position stays at 0 mm",
    );
    let found = refusal(header, &[&time_s(), &command, &command]);
    assert_refused(
        &found,
        RefusalReason::FeedbackNotConnected,
        "is the command itself",
    );
    for late in 1..3 {
        let copied: Vec<f64> = (0..SAMPLES)
            .map(|k| command[k.saturating_sub(late)])
            .collect();
        let found = refusal(header, &[&time_s(), &command, &copied]);
        assert_refused(
            &found,
            RefusalReason::FeedbackNotConnected,
            &format!("the command itself, {late} samples late"),
        );
    }
    // As LinuxCNC gives it without an encoder: commands that move, zeros beside them.
    let counts: Vec<f64> = (0..SAMPLES).map(|k| k as f64).collect();
    let found = refusal("n,x,xfb,vel", &[&counts, &command, &still, &command]);
    assert_refused(&found, RefusalReason::FeedbackNotConnected, "of x");
}

#[test]
fn swapped_and_mixed_columns_are_found() {
    let (command, actual) = axis(20.0, 1.0);
    let found = refusal("t,x.cmd,x.act", &[&time_s(), &actual, &command]);
    assert_refused(&found, RefusalReason::Swapped, "leads its command by");
    let (other, later) = axis(13.0, 1.7);
    let text = "t,x.cmd,x.act,y.cmd,y.act\n".to_owned()
        + &rows(&[&time_s(), &command, &later, &other, &actual], ",");
    let error = read(text.as_bytes(), "").unwrap_err();
    assert_eq!(error.reasons(), [RefusalReason::Mixed; 2], "{error}");
    let LogError::Refused { refusals, .. } = error else {
        panic!("{error}")
    };
    assert!(
        refusals[0]
            .message
            .contains("the actual position of x follows the command of y"),
        "{}",
        refusals[0]
    );
    let found = refusal("t,x.cmd,x.act", &[&time_s(), &command, &later]);
    assert_refused(&found, RefusalReason::Mixed, "does not follow its command");
}

#[test]
fn nothing_that_moves_is_refused() {
    let still = vec![5.0; SAMPLES];
    let found = refusal("t,x.cmd,x.act", &[&time_s(), &still, &still]);
    assert_refused(&found, RefusalReason::Constant, "no axis moves");
}

#[test]
fn values_that_are_no_numbers_are_refused_with_their_line() {
    let (command, actual) = axis(20.0, 1.0);
    let lines = rows(&[&time_s(), &command, &actual], ",");
    for (bad, shown) in [("nan", "nan"), ("", "nothing"), ("n/a", "n/a")] {
        let mut lines: Vec<String> = lines.lines().map(str::to_owned).collect();
        let (kept, _) = lines[700].rsplit_once(',').unwrap();
        lines[700] = format!("{kept},{bad}");
        let text = format!("t,x.cmd,x.act\n{}\n", lines.join("\n"));
        let error = read(text.as_bytes(), "").unwrap_err();
        assert_eq!(error.reasons(), [RefusalReason::NotANumber]);
        let part = format!("the actual position of x is no number at line 702: {shown}");
        assert!(error.to_string().contains(&part), "{error}");
    }
}

#[test]
fn a_clock_that_runs_backward_or_stands_still_is_refused() {
    let (command, actual) = axis(20.0, 1.0);
    let mut time = time_s();
    time[1500] = 0.3;
    let found = refusal("t,x.cmd,x.act", &[&time, &command, &actual]);
    assert_refused(
        &found,
        RefusalReason::Backward,
        "the time runs backward at line 1502: 0.3 behind 1.499",
    );
    time[1500] = time[1499];
    let found = refusal("t,x.cmd,x.act", &[&time, &command, &actual]);
    assert_refused(&found, RefusalReason::Backward, "stands still at line 1502");
    let last = time.len() - 1;
    (time[0], time[1500], time[last]) = (-1e308, 1.5, 1e308);
    let found = refusal("t,x.cmd,x.act", &[&time, &command, &actual]);
    assert_refused(
        &found,
        RefusalReason::NotANumber,
        &format!("the time is beyond every clock at line {}: 1e308", last + 2),
    );
}

#[test]
fn records_that_are_too_short_are_refused() {
    let (command, actual) = axis(20.0, 1.0);
    let found = refusal(
        "t,x.cmd,x.act",
        &[&time_s()[..300], &command[..300], &actual[..300]],
    );
    assert_refused(
        &found,
        RefusalReason::TooShort,
        "300 samples, 0.3 s; at least 200 samples and 1 s",
    );
}

#[test]
fn a_clock_that_varies_is_not_for_control() {
    let (command, actual) = axis(20.0, 0.2);
    let time: Vec<f64> = (0..SAMPLES)
        .map(|k| 0.005 * k as f64 + 0.001 * f64::from(k as u32 % 3))
        .collect();
    let log = read(rows(&[&time, &command, &actual], ",").as_bytes(), "").unwrap();
    let feedwright_ident::Fitness::NotForControl { reason } = &log.axes[0].verdict else {
        panic!("{:?}", log.axes[0].verdict)
    };
    assert!(
        reason.contains("the time between samples varies from 3 to 6 ms"),
        "{reason}"
    );
}

#[test]
fn a_column_that_is_the_time_belongs_to_no_axis() {
    let (command, actual) = axis(20.0, 1.0);
    let text = rows(&[&time_s(), &command, &actual], ",");
    for (columns, role) in [
        ("t=0,x.cmd=0,x.act=1", "command"),
        ("t=0,x.cmd=1,x.act=0", "actual position"),
        ("t=0,x.cmd=1,x.act=2,x.torque=0", "torque"),
    ] {
        let refused = read(text.as_bytes(), columns).unwrap_err();
        let LogError::Columns { message, hint, .. } = &refused else {
            panic!("{refused:?}")
        };
        assert_eq!(
            *message,
            format!("column 0 is both the time and the {role} of x")
        );
        assert!(hint.contains("t=COLUMN"), "{hint}");
    }
    // The time by its name, where only the axis is said.
    let refused = read(format!("t,a,b\n{text}").as_bytes(), "x.cmd=t,x.act=a").unwrap_err();
    assert!(
        refused
            .to_string()
            .contains("column 't' is both the time and the command of x"),
        "{refused}"
    );
}

#[test]
fn a_column_may_be_the_torque_and_a_position() {
    let (command, actual) = axis(20.0, 1.0);
    let log = read(
        rows(&[&time_s(), &command, &actual], ",").as_bytes(),
        "t=0,x.cmd=1,x.act=2,x.torque=2",
    )
    .unwrap();
    assert_eq!(
        log.axes[0].torque.as_deref(),
        Some(&log.axes[0].actual_mm[..])
    );
}

/// A MATLAB file with one matrix of zeros, deflated: `count` numbers of a type of `bytes` bytes.
fn zeros(kind: u32, class: u32, count: usize, bytes: usize) -> Vec<u8> {
    let element = |kind: u32, data: &[u8]| {
        let size = u32::try_from(data.len()).unwrap();
        [&kind.to_le_bytes()[..], &size.to_le_bytes(), data].concat()
    };
    let flags = [class.to_le_bytes(), [0; 4]].concat();
    let dimensions = [
        u32::try_from(count).unwrap().to_le_bytes(),
        1_u32.to_le_bytes(),
    ]
    .concat();
    let parts = [
        element(6, &flags),
        element(5, &dimensions),
        element(1, b"zeroes__"),
        element(kind, &vec![0; count * bytes]),
    ];
    let deflated = miniz_oxide::deflate::compress_to_vec_zlib(&element(14, &parts.concat()), 1);
    let mut file = b"MATLAB 5.0 MAT-file".to_vec();
    file.resize(124, b' ');
    file.extend_from_slice(b"\0\x01IM");
    file.extend(element(15, &deflated));
    file
}

/// 12 million numbers are 96 MB, whatever the file has for them.
#[test]
fn a_small_file_does_not_fill_the_memory() {
    for (kind, class, bytes) in [(9, 6, 8), (1, 8, 1)] {
        let file = zeros(kind, class, 12_000_000, bytes);
        assert!(file.len() < 1_000_000, "{}", file.len());
        let refused = read(&file, "").unwrap_err().to_string();
        assert!(
            refused.contains("the numbers take more than")
                && refused.contains(&file.len().to_string()),
            "{refused}"
        );
        let few = read(&zeros(kind, class, 7_000, bytes), "")
            .unwrap_err()
            .to_string();
        assert!(
            few.contains("no two vectors of numbers of the same length"),
            "{few}"
        );
    }
}
