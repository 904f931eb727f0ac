//! Every format of logs is recognised by its content, and gives the same log.

use crate::logs::{SAMPLE_S, SAMPLES, axis, file, read, reported, rows, time_s};
use feedwright_ident::{Columns, Fitness, Log, LogAxis, LogFormat, TorqueUnit};
use miniz_oxide::deflate::compress_to_vec_zlib;

/// Rounding of numbers that were written as text, m and inches among them, mm.
const ROUNDING_MM: f64 = 1e-9;

fn assert_near(what: &str, found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let worst = found
        .iter()
        .zip(expected)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    assert!(worst < ROUNDING_MM, "{what} is off by {worst}");
}

/// Asserts that the log has this format and holds the one axis that was written.
fn assert_is(log: &Log, format: LogFormat, (command, actual): &(Vec<f64>, Vec<f64>)) {
    assert_eq!(log.format, format, "{}", reported(log));
    assert!(
        (log.sample_time_s - SAMPLE_S).abs() < 1e-12,
        "{} s",
        log.sample_time_s
    );
    assert_eq!((log.stretches.len(), &log.stretches[0]), (1, &(0..SAMPLES)));
    let [
        LogAxis {
            command_mm,
            actual_mm,
            verdict,
            ..
        },
    ] = &log.axes[..]
    else {
        panic!("{} axes", log.axes.len())
    };
    assert_near("command", command_mm, command);
    assert_near("actual position", actual_mm, actual);
    assert_eq!(*verdict, Fitness::ForControl, "{}", reported(log));
}

#[test]
fn tables_of_any_delimiter_are_read() {
    let data = axis(20.0, 1.0);
    let (command, actual) = &data;
    for (delimiter, header) in [
        ("\t", ""),
        (",", "t,x_cmd,x_act\n"),
        (";", "Zeit [s];Sollwert X;Istwert X\n"),
        (" ", "# t x.cmd x.act\n"),
        ("|", ""),
    ] {
        let text = header.to_owned() + &rows(&[&time_s(), command, actual], delimiter);
        for content in [
            text.clone(),
            format!("\u{feff}{text}"),
            text.replace('\n', "\r\n"),
            text.trim_end().to_owned(),
        ] {
            assert_is(
                &read(content.as_bytes(), "").unwrap(),
                LogFormat::TextTable,
                &data,
            );
        }
    }
}

#[test]
fn a_decimal_comma_is_read() {
    let data = axis(20.0, 1.0);
    let text = "t;x cmd;x act\ns;mm;mm\n".to_owned()
        + &rows(&[&time_s(), &data.0, &data.1], ";").replace('.', ",");
    let log = read(text.as_bytes(), "").unwrap();
    assert_is(&log, LogFormat::TextTable, &data);
    assert!(
        reported(&log).contains("positions are in mm: the column says so"),
        "{}",
        reported(&log)
    );
    assert!(
        reported(&log).contains("time is in s: the column says so"),
        "{}",
        reported(&log)
    );
}

#[test]
fn columns_without_names_are_found_by_what_they_hold() {
    let (command, actual) = axis(20.0, 1.0);
    let current: Vec<f64> = (0..SAMPLES).map(|k| f64::from(k as u32 % 7)).collect();
    let text = rows(&[&current, &actual, &time_s(), &command], "\t");
    let log = read(text.as_bytes(), "").unwrap();
    assert_is(&log, LogFormat::TextTable, &(command, actual));
    assert!(
        reported(&log).contains("command in column 3, actual position in column 1; guessed"),
        "{}",
        reported(&log)
    );
    assert!(
        reported(&log).contains("not used: column 0"),
        "{}",
        reported(&log)
    );
}

#[test]
fn columns_are_what_is_said_of_them() {
    let (command, actual) = axis(20.0, 1.0);
    let (other, later) = axis(5.0, 1.7);
    let torque = time_s();
    let text = "a,b,c,d,e,f\n".to_owned()
        + &rows(
            &[&command, &actual, &other, &later, &torque, &time_s()],
            ",",
        );
    let log = read(
        text.as_bytes(),
        "t=f, x.cmd=0,x.act=b,x.torque=e, y.cmd=c,y.act=3",
    )
    .unwrap();
    assert_eq!(
        log.axes
            .iter()
            .map(|axis| axis.name.as_str())
            .collect::<Vec<_>>(),
        ["x", "y"]
    );
    assert_near("torque", log.axes[0].torque.as_ref().unwrap(), &torque);
    assert_near("y", &log.axes[1].command_mm, &other);
    let log = read(text.as_bytes(), "x.cmd=0,x.act=1,period_s=0.002,unit=um").unwrap();
    assert!((log.sample_time_s - 0.002).abs() < 1e-15);
    let in_um: Vec<f64> = command.iter().map(|value| value * 1e-3).collect();
    assert_near("um", &log.axes[0].command_mm, &in_um);
}

#[test]
fn what_columns_cannot_be_is_said() {
    for (text, part) in [
        ("x", "no '='"),
        ("x.cmd=", "nothing behind"),
        ("x.cmd=1", "no act of this axis"),
        ("x.cmt=1", "did you mean 'x.cmd'?"),
        ("tt=1", "did you mean 't'?"),
        ("unit=furlong", "mm, um, m or inch"),
        ("time=h", "s, ms, us, ns or samples"),
        ("period_s=0", "a time above zero"),
        ("t=1,t=2", "said twice"),
    ] {
        let error = text.parse::<Columns>().unwrap_err();
        assert!(
            format!("{error} {}", error.hint).contains(part),
            "{text}: {error} {}",
            error.hint
        );
    }
    let (command, actual) = axis(20.0, 1.0);
    let text = "t,command,position\n".to_owned() + &rows(&[&time_s(), &command, &actual], ",");
    for (columns, part) in [
        ("x.cmd=comand,x.act=2", "did you mean 'command'?"),
        (
            "x.cmd=1,x.act=7",
            "there is no column 7: the last of 3 is 2",
        ),
    ] {
        let error = read(text.as_bytes(), columns).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn units_are_guessed_and_reported() {
    let data = axis(20.0, 1.0);
    let scaled =
        |values: &[f64], by: f64| values.iter().map(|value| value * by).collect::<Vec<f64>>();
    for (by, unit) in [(1e-3, "m"), (1.0, "mm"), (1e3, "um")] {
        for (time_by, time_unit) in [(1.0, "s"), (1e3, "ms"), (1e6, "us"), (1e9, "ns")] {
            let columns = [
                scaled(&time_s(), time_by),
                scaled(&data.0, by),
                scaled(&data.1, by),
            ];
            let log = read(
                rows(&columns.each_ref().map(Vec::as_slice), ",").as_bytes(),
                "",
            )
            .unwrap();
            assert_is(&log, LogFormat::TextTable, &data);
            assert!(
                reported(&log).contains(&format!("positions are in {unit}: guessed")),
                "{}",
                reported(&log)
            );
            assert!(
                reported(&log).contains(&format!("time is in {time_unit}: guessed")),
                "{}",
                reported(&log)
            );
        }
    }
    let inches = scaled(&data.0, 1.0 / 25.4);
    let text = "t,x.cmd [inch],x.act [inch]\n".to_owned()
        + &rows(&[&time_s(), &inches, &scaled(&data.1, 1.0 / 25.4)], ",");
    assert_is(
        &read(text.as_bytes(), "").unwrap(),
        LogFormat::TextTable,
        &data,
    );
}

#[test]
fn halsampler_is_read_with_its_overruns() {
    let data = axis(20.0, 1.0);
    let counts: Vec<f64> = (0..SAMPLES).map(|k| k as f64 + 17.0).collect();
    let lines = rows(&[&counts, &data.0, &data.1], " ");
    for header in [
        "",
        "# n x.cmd x.act\n",
        "# sample_time_s = 0.001\n# n x.cmd x.act\n",
    ] {
        let log = read((header.to_owned() + &lines).as_bytes(), "").unwrap();
        assert_is(&log, LogFormat::Halsampler, &data);
        let guesses = !header.contains("sample_time_s");
        assert_eq!(
            reported(&log).contains("1 ms between samples: guessed"),
            guesses,
            "{}",
            reported(&log)
        );
        assert_eq!(log.time_s[0], 0.0);
    }
    // Samples 1017 to 1021 were lost.
    let mut with_gap: Vec<&str> = lines.lines().collect();
    with_gap.splice(1000..1005, ["overrun"]);
    let log = read(with_gap.join("\n").as_bytes(), "").unwrap();
    assert_eq!(
        (log.format, &log.stretches[..]),
        (LogFormat::Halsampler, [0..1000, 1000..2995].as_slice())
    );
    assert!(
        reported(&log).contains("a gap of 6 ms from 0.9990 s to 1.0050 s"),
        "{}",
        reported(&log)
    );
    // Without sample numbers only the word `overrun` shows that some are missing.
    let without: Vec<String> = with_gap
        .iter()
        .map(|line| {
            line.split_once(' ')
                .map_or("overrun", |(_, rest)| rest)
                .to_owned()
        })
        .collect();
    let log = read(
        without.join("\n").as_bytes(),
        "x.cmd=0,x.act=1,period_s=0.001",
    )
    .unwrap();
    assert_eq!(
        (log.format, &log.stretches[..]),
        (LogFormat::Halsampler, [0..1000, 1000..2995].as_slice())
    );
}

#[test]
fn both_forms_of_halscope_are_read() {
    let data = axis(20.0, 1.0);
    let (command, actual) = &data;
    let mut csv =
        "# Sampling period is 1000000 ns\njoint.0.motor-pos-cmd;joint.0.motor-pos-fb\n".to_owned();
    let mut log = "Sampling period is 1000000 nSec \n".to_owned();
    for (command, actual) in command.iter().zip(actual) {
        csv.push_str(&format!("{command:.14};{actual:.14}\n"));
        log.push_str(&format!(
            "\njoint.0.motor-pos-cmd {command:+.14} joint.0.motor-pos-fb {actual:+.14} "
        ));
    }
    for text in [csv, log] {
        let log = read(text.as_bytes(), "").unwrap();
        assert_is(&log, LogFormat::Halscope, &data);
        assert_eq!(log.axes[0].name, "joint0");
        // By number: the names in the rows are not counted as columns.
        assert_is(
            &read(text.as_bytes(), "x.cmd=0,x.act=1").unwrap(),
            LogFormat::Halscope,
            &data,
        );
    }
}

/// An element of a MAT-file, of either byte order.
fn element(kind: u32, data: &[u8], is_little: bool) -> Vec<u8> {
    let word = |value: u32| {
        if is_little {
            value.to_le_bytes()
        } else {
            value.to_be_bytes()
        }
    };
    let mut bytes = [word(kind), word(data.len() as u32)].concat();
    bytes.extend_from_slice(data);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

/// A MAT-file with column vectors.
fn mat_file(variables: &[(&str, &[f64])], is_little: bool, is_compressed: bool) -> Vec<u8> {
    let mut bytes = b"MATLAB 5.0 MAT-file, written by a test".to_vec();
    bytes.resize(124, b' ');
    bytes.extend_from_slice(if is_little {
        b"\x00\x01IM"
    } else {
        b"\x01\x00MI"
    });
    let words = |values: &[u32]| -> Vec<u8> {
        values
            .iter()
            .flat_map(|value| {
                if is_little {
                    value.to_le_bytes()
                } else {
                    value.to_be_bytes()
                }
            })
            .collect()
    };
    for (name, values) in variables {
        let numbers: Vec<u8> = values
            .iter()
            .flat_map(|value| {
                if is_little {
                    value.to_le_bytes()
                } else {
                    value.to_be_bytes()
                }
            })
            .collect();
        let parts = [
            element(6, &words(&[6, 0]), is_little),
            element(5, &words(&[values.len() as u32, 1]), is_little),
            element(1, name.as_bytes(), is_little),
            element(9, &numbers, is_little),
        ];
        let matrix = element(14, &parts.concat(), is_little);
        if is_compressed {
            let deflated = compress_to_vec_zlib(&matrix, 6);
            bytes.extend(words(&[15, deflated.len() as u32]));
            bytes.extend(deflated);
        } else {
            bytes.extend(matrix);
        }
    }
    bytes
}

#[test]
fn matlab_files_are_read_compressed_or_not_in_either_byte_order() {
    let data = axis(20.0, 1.0);
    let time = time_s();
    let torque: Vec<f64> = time.iter().map(|t| t.sin()).collect();
    let variables: [(&str, &[f64]); 5] = [
        ("gain", &[3.0]),
        ("qm", &data.1),
        ("qg", &data.0),
        ("t", &time),
        ("vir", &torque),
    ];
    for (is_little, is_compressed) in [(true, true), (true, false), (false, true), (false, false)] {
        let log = read(&mat_file(&variables, is_little, is_compressed), "").unwrap();
        assert_is(&log, LogFormat::Matlab, &data);
        assert_eq!(log.axes[0].torque_unit, TorqueUnit::Volt);
    }
    let bytes = mat_file(&variables, true, true);
    let log = read(&bytes, "t=t,x.cmd=qg,x.act=qm,x.torque=vir").unwrap();
    assert_is(&log, LogFormat::Matlab, &data);
    let error = read(&bytes[..bytes.len() - 100], "").unwrap_err();
    assert!(error.to_string().contains("is cut off"), "{error}");
    let error = read(b"\x89HDF\r\n\x1a\n and so on", "").unwrap_err();
    assert!(error.to_string().contains("7.3"), "{error}");
}

#[test]
fn sinumerik_edge_is_read_with_its_axes() {
    let data = axis(20.0, 1.0);
    let signals: String = [
        "CYCLE,Cycle",
        "DES_POS|1,X1",
        "ENC_POS|1,X1",
        "TORQUE|1,X1",
        "DES_POS|4,C1",
        "ENC_POS|4,C1",
    ]
    .iter()
    .map(|signal| signal.split_once(',').unwrap())
    .map(|(name, axis)| format!("{{\"Name\":\"{name}\",\"Type\":\"DOUBLE\",\"Axis\":\"{axis}\"}},"))
    .collect();
    let row = |k: usize| format!("[{},{},{},1.5e-1,{k},{k}]", k + 500, data.0[k], data.1[k]);
    let block = |k: usize| {
        let rows: Vec<String> = (k..k + 100).map(row).collect();
        format!(
            "{{\"HFData\":[{}]}},{{\"HFBlockEvent\":{{\"GCode\":null}}}},",
            rows.join(",")
        )
    };
    let payload: String = (0..SAMPLES).step_by(100).map(block).collect();
    let text = format!(
        "{{\"Header\":{{\"CycleTimeMs\":1,\"SignalListHFData\":[{}]}},\"Payload\":[{}],\"Footer\":{{}}}}",
        signals.trim_end_matches(','),
        payload.trim_end_matches(',')
    );
    let log = read(text.as_bytes(), "").unwrap();
    assert_is(&log, LogFormat::SinumerikEdge, &data);
    assert_eq!(
        (log.axes[0].name.as_str(), log.axes[0].torque_unit),
        ("x", TorqueUnit::NewtonMetre)
    );
    assert!(
        reported(&log).contains("axis c is rotary"),
        "{}",
        reported(&log)
    );
    for (bad, part) in [
        (
            text.replace("[501,", "[501,7,"),
            "row 1 has 7 values, where the header announces 6",
        ),
        (text[..text.len() / 2].to_owned(), "EOF"),
        ("{\"a\": 1}".to_owned(), "there is no Header"),
    ] {
        let error = read(bad.as_bytes(), "").unwrap_err();
        assert!(error.to_string().contains(part), "{error}");
    }
}

#[test]
fn a_gap_begins_a_new_stretch_and_a_last_line_that_is_cut_off_is_left_out() {
    let (command, actual) = axis(20.0, 1.0);
    let time: Vec<f64> = time_s()
        .iter()
        .map(|&t| if t < 1.2 { t } else { t + 0.5 })
        .collect();
    let text = rows(&[&time, &command, &actual], ",") + "3.5,0.0";
    let log = read(text.as_bytes(), "").unwrap();
    assert_eq!(log.stretches, [0..1200, 1200..SAMPLES]);
    assert!((log.sample_time_s - SAMPLE_S).abs() < 1e-12);
    assert!(
        reported(&log).contains("line 3001, the last, is cut off"),
        "{}",
        reported(&log)
    );
    let error = read(
        (rows(&[&time, &command, &actual], ",") + "3.5,0.0\n4,1,2\n").as_bytes(),
        "",
    )
    .unwrap_err();
    assert!(
        error
            .to_string()
            .contains("line 3001: 2 columns, where the lines before have 3"),
        "{error}"
    );
}

#[test]
fn steps_limits_and_lines_are_reported() {
    let time = time_s();
    let (command, mut actual) = axis(20.0, 1.0);
    for (k, position) in actual.iter_mut().enumerate() {
        let swing = 0.02 * (std::f64::consts::TAU * 62.0 * time[k]).sin();
        *position = ((*position + swing) * 500.0).round() / 500.0;
    }
    let torque: Vec<f64> = time
        .iter()
        .map(|t| (8.0 * (7.0 * t).sin()).clamp(-5.0, 5.0))
        .collect();
    let text = "t,x.cmd,x.act,x.torque [Nm]\n".to_owned()
        + &rows(&[&time, &command, &actual, &torque], ",");
    let log = read(text.as_bytes(), "").unwrap();
    let reported = reported(&log);
    assert_eq!(log.axes[0].step_mm, 0.002);
    assert!(reported.contains("in steps of 2 um"), "{reported}");
    assert!(
        reported.contains("the torque of x is at its limit of 5 N m"),
        "{reported}"
    );
    assert!(reported.contains("swings at 62"), "{reported}");
    // A speed limit of 80 mm/s under a command of 126 mm/s.
    let mut limited = vec![0.0_f64];
    for k in 1..SAMPLES {
        let before = limited[k - 1];
        limited.push(before + ((command[k - 1] - before) / 8.0).clamp(-0.08, 0.08));
    }
    let log = read(rows(&[&time, &command, &limited], ",").as_bytes(), "").unwrap();
    assert!(
        crate::logs::reported(&log).contains("stays below 80 mm/s, where the command reaches 125"),
        "{}",
        crate::logs::reported(&log)
    );
}

#[test]
fn axes_that_stand_still_are_left_out_and_different_zeros_are_taken_out() {
    let data = axis(20.0, 1.0);
    let still = vec![5.0; SAMPLES];
    let shifted: Vec<f64> = data.1.iter().map(|position| position + 150.0).collect();
    let text = "t,x.cmd,x.act,z.cmd,z.act\n".to_owned()
        + &rows(&[&time_s(), &data.0, &shifted, &still, &still], ",");
    let log = read(text.as_bytes(), "").unwrap();
    assert_eq!(log.axes.len(), 1);
    assert!(
        reported(&log).contains("axis z stands still"),
        "{}",
        reported(&log)
    );
    assert!(
        reported(&log).contains("differ by -1"),
        "{}",
        reported(&log)
    );
    let mean = log.axes[0]
        .command_mm
        .iter()
        .zip(&log.axes[0].actual_mm)
        .map(|(c, a)| c - a)
        .sum::<f64>()
        / SAMPLES as f64;
    assert!(mean.abs() < 0.1, "{mean} mm are left");
}

#[test]
fn a_file_that_is_not_a_log_is_reported_as_such() {
    for (content, part) in [
        (b"".as_slice(), "the file is empty"),
        (b"\xff\xfet\x00", "UTF-16"),
        (b"\x00\x01\x02\x03", "neither text nor"),
        (
            b"G0 X0 Y0\nG1 X10 F100\n",
            "no rows of at least two numbers",
        ),
        (
            b"t,x\n0,1\n1,2\n2,3\n",
            "no two columns are the command and the actual position",
        ),
    ] {
        let error = read(content, "").unwrap_err();
        assert!(error.to_string().contains(part), "{error}");
    }
    let (folder, path) = file(b"0 1 2\n");
    for place in [
        folder.path().to_owned(),
        path.join("not_there"),
        folder.path().join("not_there"),
    ] {
        assert!(
            Log::read(&place, &Columns::default())
                .unwrap_err()
                .to_string()
                .contains("cannot read log")
        );
    }
}
