//! Whatever a file holds, reading it gives a log or a message, and a log is what its description
//! says.

use crate::logs::{axis, read, rows, time_s};
use feedwright_ident::Log;
use proptest::prelude::*;

/// Checks the properties of every log.
fn check(log: &Log) {
    let rows = log.time_s.len();
    assert!(log.sample_time_s > 0.0 && log.sample_time_s.is_finite());
    assert!(!log.axes.is_empty() && log.axes.len() <= feedwright_ident::MAX_AXES);
    assert_eq!(
        log.stretches
            .iter()
            .map(ExactSizeIterator::len)
            .sum::<usize>(),
        rows
    );
    assert!(
        log.stretches
            .windows(2)
            .all(|pair| pair[0].end == pair[1].start && !pair[0].is_empty())
    );
    assert!(log.time_s.windows(2).all(|pair| pair[1] > pair[0]));
    for axis in &log.axes {
        assert_eq!([axis.command_mm.len(), axis.actual_mm.len()], [rows; 2]);
        assert!(
            axis.command_mm
                .iter()
                .chain(&axis.actual_mm)
                .all(|value| value.is_finite())
        );
        assert!(
            axis.torque
                .as_ref()
                .is_none_or(|torque| torque.len() == rows)
        );
    }
    assert!(
        log.findings
            .iter()
            .all(|finding| !finding.to_string().contains('\n'))
    );
}

/// Lines as logs have them, and as they should not have them.
fn line() -> impl Strategy<Value = String> {
    let number = (-9999..10_000_i32, 0..=6_usize, any::<u32>());
    let letters = prop::collection::vec(
        prop::sample::select(&b"abcdefghijklmnopqrstuvwxyz."[..]),
        0..6,
    );
    let field = prop_oneof![
        4 => number.prop_map(|(whole, digits, part)| {
            if digits == 0 { whole.to_string() } else { format!("{whole}.{:0digits$}", part % 10_u32.pow(digits as u32)) }
        }),
        1 => letters.prop_map(|letters| letters.into_iter().map(char::from).collect()),
        1 => Just("nan".to_owned()),
        1 => Just("1e400".to_owned()),
    ];
    let row = (
        prop::collection::vec(field, 0..6),
        prop_oneof![Just(","), Just(";"), Just("\t"), Just(" ")],
    );
    prop_oneof![
        6 => row.prop_map(|(fields, delimiter)| fields.join(delimiter)),
        1 => Just("overrun".to_owned()),
        1 => Just("# n x.cmd x.act".to_owned()),
        1 => Just("Sampling period is 1000 ns".to_owned()),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn any_bytes_give_a_log_or_a_message(bytes in prop::collection::vec(any::<u8>(), 0..600), head in 0..4_usize) {
        let heads: [&[u8]; 4] = [b"", b"{\"Header\":{\"SignalListHFData\":[]},\"Payload\":", b"t,x.cmd,x.act\n", b"\xef\xbb\xbf"];
        let content = [heads[head], &bytes].concat();
        if let Ok(log) = read(&content, "") {
            check(&log);
        }
    }

    #[test]
    fn any_matlab_file_gives_a_log_or_a_message(bytes in prop::collection::vec(any::<u8>(), 0..400), kind in 0..20_u32) {
        let mut content = b"MATLAB 5.0 MAT-file".to_vec();
        content.resize(124, b' ');
        content.extend_from_slice(b"\x00\x01IM");
        content.extend(kind.to_le_bytes());
        content.extend((bytes.len() as u32).to_le_bytes());
        content.extend(bytes);
        if let Ok(log) = read(&content, "") {
            check(&log);
        }
    }

    #[test]
    fn any_lines_give_a_log_or_a_message(lines in prop::collection::vec(line(), 0..40)) {
        if let Ok(log) = read(lines.join("\n").as_bytes(), "") {
            check(&log);
        }
    }

    #[test]
    fn a_log_with_one_spoilt_line_gives_a_log_or_a_message(row in 0..3000_usize, spoilt in line()) {
        let (command, actual) = axis(20.0, 1.0);
        let mut lines: Vec<String> = rows(&[&time_s(), &command, &actual], ",").lines().map(str::to_owned).collect();
        lines[row] = spoilt;
        if let Ok(log) = read(lines.join("\n").as_bytes(), "") {
            check(&log);
        }
    }

    #[test]
    fn columns_in_any_order_give_the_same_axis(order in Just([0, 1, 2, 3]).prop_shuffle(), has_names: bool) {
        let (command, actual) = axis(20.0, 1.0);
        let load: Vec<f64> = (0..command.len()).map(|k| f64::from(k as u32 % 11)).collect();
        let columns: [(&str, &[f64]); 4] = [("t", &time_s()), ("x.cmd", &command), ("x.act", &actual), ("load", &load)];
        let shuffled: Vec<&[f64]> = order.iter().map(|&i| columns[i].1).collect();
        let names: Vec<&str> = order.iter().map(|&i| columns[i].0).collect();
        let header = if has_names { names.join(",") + "\n" } else { String::new() };
        let log = read((header + &rows(&shuffled, ",")).as_bytes(), "").unwrap();
        check(&log);
        prop_assert_eq!(&log.axes[0].command_mm, &command);
        prop_assert_eq!(&log.axes[0].actual_mm, &actual);
    }
}
