//! Exports of the scopes of controls are recognized by their headers, and give the samples of the
//! same table without one.
//!
//! The files are imitations, by what is public of the formats. docs/logs.md says which formats were
//! tried on real files.

use feedwright_ident::{Log, LogFormat, TorqueUnit};

use crate::logs::{SAMPLE_S, SAMPLES, axis, read, reported, rows, time_s};

/// Rounding of numbers that were written as text, and of sums of two of them, mm.
const ROUNDING_MM: f64 = 1e-9;

/// Command and actual position of an axis, mm.
type Motion = (Vec<f64>, Vec<f64>);

/// Rows that end with a delimiter, as some exports have them.
fn ended(rows: &str, delimiter: &str) -> String {
    rows.lines()
        .map(|row| format!("{row}{delimiter}\n"))
        .collect()
}

fn scaled(values: &[f64], by: f64) -> Vec<f64> {
    values.iter().map(|value| value * by).collect()
}

fn difference(command: &[f64], actual: &[f64]) -> Vec<f64> {
    command
        .iter()
        .zip(actual)
        .map(|(command, actual)| command - actual)
        .collect()
}

/// A curve of the header of TNCscope.
fn curve(
    number: usize,
    (kind, axis, unit): (&str, &str, &str),
    samples: usize,
    cycle_us: f64,
) -> String {
    format!(
        "%[CURVE {number}]\n%CHANNELTYPE={kind}\n%AXISTYPE={axis}\n%DIMENSION={unit}\n%COUNT={samples}\n%CYCLETIME={cycle_us}\n%\n"
    )
}

/// A record of TNCscope with these channels, every 1 ms.
fn tncscope(channels: &[(&str, &str, &str)], columns: &[&[f64]]) -> String {
    let curves: String = channels
        .iter()
        .enumerate()
        .map(|(k, channel)| curve(k, *channel, SAMPLES, 1000.0))
        .collect();
    let time_us: Vec<f64> = (0..SAMPLES).map(|k| 1000.0 * k as f64).collect();
    let columns: Vec<&[f64]> = [&time_us[..]]
        .into_iter()
        .chain(columns.iter().copied())
        .collect();
    format!(
        "%[GLOBAL]\n%VERSION=1\n%\n{curves}%[DATA]\n{}",
        ended(&rows(&columns, ";"), ";")
    )
}

/// A record of Servo Guide.
fn servo_guide(columns: &[&[f64]]) -> String {
    let head =
        "Sampling cycle,1,ms\nAxis,X,X,X,Y,Y\nKind,POSF,ERR,TCMD,POSF,ERR\nUnit,mm,um,%,mm,um\n";
    let number: Vec<f64> = (0..SAMPLES).map(|k| k as f64).collect();
    let columns: Vec<&[f64]> = [&number[..]]
        .into_iter()
        .chain(columns.iter().copied())
        .collect();
    head.to_owned() + &rows(&columns, ",")
}

/// Returns the lines that TwinCAT Scope writes above its rows.
fn project(delimiter: &str) -> String {
    [
        "Name|record|",
        "Starttime of export|132959733843760000|Montag, 2. Mai 2022|15:56:24.376",
        "",
        "",
    ]
    .map(|line| line.replace('|', delimiter))
    .join("\n")
        + "\n"
}

/// Lines about channels of TwinCAT Scope: names, symbols, sample times and units, with their keys
/// where the time stands.
fn about(groups: &[&[(&str, &str, &str, &str)]], delimiter: &str) -> String {
    let line = |key: &str, of: fn(&(&str, &str, &str, &str)) -> String| {
        let groups = groups.iter().map(|group| {
            let values: Vec<String> = group.iter().map(of).collect();
            format!("{key}{delimiter}{}", values.join(delimiter))
        });
        groups.collect::<Vec<_>>().join(delimiter) + "\n"
    };
    line("Name", |channel| channel.0.to_owned())
        + &line("SymbolName", |channel| channel.1.to_owned())
        + &line("SampleTime[ms]", |channel| channel.2.to_owned())
        + &line("Unit", |channel| channel.3.to_owned())
        + "\n"
}

fn time_ms() -> Vec<f64> {
    (0..SAMPLES).map(|k| k as f64).collect()
}

/// Asserts that two logs have the same samples of the axes that the second has.
fn assert_same(log: &Log, format: LogFormat, twin: &Log) {
    assert_eq!(log.format, format, "{}", reported(log));
    assert!(
        (log.sample_time_s - SAMPLE_S).abs() < 1e-12,
        "{} s",
        log.sample_time_s
    );
    assert_eq!(log.stretches, twin.stretches);
    assert_eq!(log.axes.len(), twin.axes.len(), "{}", reported(log));
    for (found, twin) in log.axes.iter().zip(&twin.axes) {
        assert_eq!(found.name, twin.name);
        for (found, twin) in [
            (&found.command_mm, &twin.command_mm),
            (&found.actual_mm, &twin.actual_mm),
        ] {
            assert_eq!(found.len(), twin.len());
            let worst = found
                .iter()
                .zip(twin)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max);
            assert!(worst < ROUNDING_MM, "off by {worst}");
        }
    }
}

/// The same axes as a table.
fn twin(axes: &[(&str, &Motion)]) -> Log {
    let names: String = axes
        .iter()
        .map(|(name, _)| format!(",{name}.cmd [mm],{name}.act [mm]"))
        .collect();
    let time_s = time_s();
    let columns = axes
        .iter()
        .flat_map(|(_, (command, actual))| [&command[..], &actual[..]]);
    let columns: Vec<&[f64]> = [&time_s[..]].into_iter().chain(columns).collect();
    read(
        format!("t [s]{names}\n{}", rows(&columns, ",")).as_bytes(),
        "",
    )
    .unwrap()
}

#[test]
fn tncscope_is_read_as_its_table() {
    let (x, y) = (axis(20.0, 1.0), axis(12.0, 1.3));
    let current: Vec<f64> = time_s().iter().map(|t| t.sin()).collect();
    let channels = [
        ("s nominal", "X", "mm"),
        ("s actual", "X", "mm"),
        ("i actual", "X", "A"),
        ("s nominal", "Y", "mm"),
        ("s actual", "Y", "mm"),
    ];
    let text = tncscope(&channels, &[&x.0, &x.1, &current, &y.0, &y.1]);
    let expected = twin(&[("x", &x), ("y", &y)]);
    for text in [
        text.clone(),
        text.replace('\n', "\r\n"),
        format!("\u{feff}{text}"),
    ] {
        let log = read(text.as_bytes(), "").unwrap();
        assert_same(&log, LogFormat::TncScope, &expected);
        assert_eq!(
            (
                log.axes[0].torque.as_ref().unwrap(),
                log.axes[0].torque_unit
            ),
            (&current, TorqueUnit::Ampere)
        );
    }
    // Decimal comma, the following error in place of the command, um in the code page of Windows.
    let error_um = scaled(&difference(&x.0, &x.1), 1e3);
    let text = tncscope(
        &[("s dif", "X", "?m"), ("s actual", "X", "mm")],
        &[&error_um, &x.1],
    )
    .replace('.', ",");
    let bytes: Vec<u8> = text
        .bytes()
        .map(|byte| if byte == b'?' { 0xB5 } else { byte })
        .collect();
    let log = read(&bytes, "").unwrap();
    assert_same(&log, LogFormat::TncScope, &twin(&[("x", &x)]));
    assert!(
        reported(&log).contains("command in column 's actual X' + 's dif X'"),
        "{}",
        reported(&log)
    );
}

#[test]
fn servo_guide_is_read_as_its_table() {
    let (x, y) = (axis(20.0, 1.0), axis(12.0, 1.3));
    let error = |axis: &Motion| scaled(&difference(&axis.0, &axis.1), 1e3);
    let torque = time_s();
    let text = servo_guide(&[&x.1, &error(&x), &torque, &y.1, &error(&y)]);
    let log = read(text.as_bytes(), "").unwrap();
    assert_same(&log, LogFormat::ServoGuide, &twin(&[("x", &x), ("y", &y)]));
    assert_eq!(log.axes[0].torque_unit, TorqueUnit::Percent);
    // Columns with their axes and units in one line, and the cycle in another form.
    let text = format!(
        "SERVO GUIDE\nSampling cycle: 1000 us\nTime[ms];POSF(X)[mm];ERR(X)[mm]\n{}",
        rows(&[&time_ms(), &x.1, &difference(&x.0, &x.1)], ";").replace('.', ",")
    );
    assert_same(
        &read(text.as_bytes(), "").unwrap(),
        LogFormat::ServoGuide,
        &twin(&[("x", &x)]),
    );
    // Others may be named.
    let log = read(text.as_bytes(), "z.act=POSF X,z.err=ERR X").unwrap();
    assert_same(&log, LogFormat::ServoGuide, &twin(&[("z", &x)]));
}

#[test]
fn twincat_scope_is_read_as_its_table() {
    let (x, y) = (axis(20.0, 1.0), axis(12.0, 1.3));
    let expected = twin(&[("x", &x), ("y", &y)]);
    let unit = "mm (Length)";
    let channels = [
        ("SetPos", "MAIN.axisX.SetPos", "1", unit),
        ("ActPos", "MAIN.axisX.ActPos", "1", unit),
        ("SetPos (1)", "MAIN.axisY.SetPos", "1", unit),
        ("ActPos (1)", "MAIN.axisY.ActPos", "1", unit),
    ];
    for (delimiter, comma) in [
        ("\t", true),
        ("\t", false),
        (";", true),
        (",", false),
        (":", false),
    ] {
        // One time for all, and one for each channel.
        let one = about(&[&channels], delimiter)
            + &rows(&[&time_ms(), &x.0, &x.1, &y.0, &y.1], delimiter);
        let (a, b, c, d) = (
            &channels[..1],
            &channels[1..2],
            &channels[2..3],
            &channels[3..],
        );
        let t = time_ms();
        let each = about(&[a, b, c, d], delimiter)
            + &rows(&[&t, &x.0, &t, &x.1, &t, &y.0, &t, &y.1], delimiter);
        for (text, end) in [(&one, ""), (&one, "EOF\n"), (&each, ""), (&each, "EOF")] {
            let text = if comma {
                text.replace("0.", "0,")
                    .replace('.', ",")
                    .replace("MAIN,axisX,", "MAIN.axisX.")
                    .replace("MAIN,axisY,", "MAIN.axisY.")
            } else {
                text.clone()
            };
            let text = project(delimiter) + &text + end;
            assert_same(
                &read(text.as_bytes(), "").unwrap(),
                LogFormat::TwinCatScope,
                &expected,
            );
        }
    }
}

#[test]
fn groups_of_other_sample_times_are_left_out_and_times_of_the_clock_are_taken_by_their_header() {
    let x = axis(20.0, 1.0);
    let expected = twin(&[("x", &x)]);
    let unit = "mm (Length)";
    let pair = [
        ("X_ActPos", "MAIN.x.ActPos", "1", unit),
        ("X_PosDiff", "MAIN.x.PosDiff", "1", unit),
    ];
    let fast = [("load", "MAIN.load", "0,5", "(None)")];
    let error = difference(&x.0, &x.1);
    let mut text = project(";") + &about(&[&fast, &pair], ";");
    for k in 0..2 * SAMPLES {
        // The slower group ends first.
        let of_pair = if k < SAMPLES {
            format!("{k};{};{}", x.1[k], error[k])
        } else {
            ";;".to_owned()
        };
        text += &format!("{};0;{of_pair}\n", 0.5 * k as f64);
    }
    assert_same(
        &read(text.as_bytes(), "").unwrap(),
        LogFormat::TwinCatScope,
        &expected,
    );
    let stamps: Vec<f64> = (0..SAMPLES)
        .map(|k| 132_959_733_843_760_000.0 + 10_000.0 * k as f64)
        .collect();
    let text = project(";") + &about(&[&pair], ";") + &rows(&[&stamps, &x.1, &error], ";");
    assert_same(
        &read(text.as_bytes(), "").unwrap(),
        LogFormat::TwinCatScope,
        &expected,
    );
    // Two positions of different sample times are no axis.
    let apart = [("X_SetPos", "", "1", unit), ("X_ActPos", "", "2", unit)];
    let text = project(";") + &about(&[&apart], ";") + &rows(&[&time_ms(), &x.0, &x.1], ";");
    let error = read(text.as_bytes(), "").unwrap_err();
    assert!(
        error
            .to_string()
            .contains("'X_SetPos' is sampled every 1 ms, and 'X_ActPos' every 2 ms"),
        "{error}"
    );
}

/// The message and the remedy of a file that is no log.
fn refused(text: &str) -> String {
    let error = read(text.as_bytes(), "")
        .map(|log| reported(&log))
        .unwrap_err();
    let help = miette::Diagnostic::help(&error).map_or_else(String::new, |help| help.to_string());
    format!("{error}; hint: {help}")
}

#[test]
fn what_is_cut_off_or_lacks_a_channel_is_said_with_its_place_and_a_remedy() {
    let x = axis(20.0, 1.0);
    let channels = [("s nominal", "X", "mm"), ("s actual", "X", "mm")];
    let whole = tncscope(&channels, &[&x.0, &x.1]);
    // Cut off in the middle of the rows: the present rows are read, and the missing ones are
    // reported.
    let part = &whole[..whole.len() / 2];
    let log = read(part.as_bytes(), "").unwrap();
    assert!(
        reported(&log).contains("the header announces 3000 samples, and 1"),
        "{}",
        reported(&log)
    );
    // In the header.
    let header = &whole[..whole.find("%[DATA]").unwrap()];
    assert!(
        refused(header).contains("line 18: the file ends within its header: no line %[DATA]"),
        "{}",
        refused(header)
    );
    let twincat =
        project(";") + &about(&[&[("SetPos", "", "1", ""), ("ActPos", "", "1", "")]], ";");
    assert!(
        refused(&twincat).contains("no rows follow the lines about the channels"),
        "{}",
        refused(&twincat)
    );
    assert!(
        refused(&project(";")).contains("no line 'Name' names the channels"),
        "{}",
        refused(&project(";"))
    );
    assert!(
        refused("Kind,POSF,ERR\nUnit,mm,um\n").contains("no rows follow the line of the signals")
    );
    // No channel of the command, or of the actual position.
    let text = tncscope(&channels[1..], &[&x.1]);
    assert!(
        refused(&text)
            .contains("TNCscope record has command and actual position: axis x has no command"),
        "{}",
        refused(&text)
    );
    assert!(
        refused(&text).contains("record 's nominal' and 's actual'"),
        "{}",
        refused(&text)
    );
    let text = format!(
        "Axis,X,X\nKind,POSF,VCMD\n{}",
        rows(&[&time_ms(), &x.1, &x.0], ",")
    );
    assert!(
        refused(&text).contains("record POSF and ERR of each axis"),
        "{}",
        refused(&text)
    );
    let text = twincat.replace("ActPos", "Load") + &rows(&[&time_ms(), &x.0, &x.1], ";");
    assert!(
        refused(&text).contains("axis x has no actual position"),
        "{}",
        refused(&text)
    );
    // No time, and no sample time in the header.
    let text = servo_guide(&[&x.1, &x.0, &x.0, &x.1, &x.0]).replace("Sampling cycle,1,ms\n", "");
    assert!(
        refused(&text).contains("no column is the time"),
        "{}",
        refused(&text)
    );
    // A value that is no number.
    for spoilt in ["nan", "", "1,5,2", "x"] {
        let mut lines: Vec<String> = whole.lines().map(str::to_owned).collect();
        lines[500] = format!("480000;{spoilt};1.0;");
        assert!(
            refused(&lines.join("\n")).contains("the command of x is no number at line 501"),
            "{spoilt}"
        );
    }
    // A line of two megabytes, behind a header and in one.
    let long = "1;".repeat(1 << 20);
    assert!(refused(&(header.to_owned() + "%[DATA]\n" + &long)).contains("longer than 1 MiB"));
    let text = project(";") + "Name;" + &long;
    assert!(
        refused(&text).contains("no rows follow the lines about the channels"),
        "{}",
        refused(&text)
    );
    let text = "Name;".to_owned() + &long;
    assert!(
        refused(&text).contains("longer than 1 MiB"),
        "{}",
        refused(&text)
    );
}

#[test]
fn a_scope_that_is_cut_anywhere_gives_a_log_or_a_message() {
    let x = axis(20.0, 1.0);
    let error = difference(&x.0, &x.1);
    let channels = [("s nominal", "X", "mm"), ("s actual", "X", "mm")];
    let pair = [
        ("SetPos", "MAIN.x.SetPos", "1", "mm"),
        ("ActPos", "MAIN.x.ActPos", "1", "mm"),
    ];
    for whole in [
        tncscope(&channels, &[&x.0, &x.1]),
        servo_guide(&[&x.1, &error, &x.0, &x.1, &error]),
        project("\t") + &about(&[&pair], "\t") + &rows(&[&time_ms(), &x.0, &x.1], "\t"),
    ] {
        let cuts = (0..600.min(whole.len())).chain((600..whole.len()).step_by(997));
        for end in cuts.filter(|&end| whole.is_char_boundary(end)) {
            match read(&whole.as_bytes()[..end], "") {
                Ok(log) => assert!(
                    !log.axes.is_empty() && log.axes[0].command_mm.iter().all(|mm| mm.is_finite())
                ),
                Err(error) => assert!(error.to_string().len() > 10, "{error}"),
            }
        }
    }
}
