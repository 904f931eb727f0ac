//! Logs: arbitrary bytes, tables with odd cells, and MATLAB files with odd sizes.

use std::fmt::Write;
use std::path::Path;

use feedwright_ident::{Columns, Log};

use crate::draw::Draw;

const HEADS: &[&str] = &[
    "t,x.cmd,x.act",
    "time_s;x_cmd_mm;x_act_mm",
    "t\tx.cmd\tx.act\ty.cmd\ty.act",
    "# unit = um\nt,x.cmd,x.act",
    "t,x.cmd,x.act,x.torque",
    "",
    "sample,joint.0.motor-pos-cmd,joint.0.motor-pos-fb",
    "\u{feff}t,x.cmd,x.act",
    "t,t,t",
];
const CELLS: &[&str] = &[
    "",
    "nan",
    "inf",
    "-",
    "1e400",
    "x",
    "1,5",
    "\"1\"",
    "\u{1b}[31m",
    "0x1p3",
    "1_000",
];
const COLUMNS: &[&str] = &[
    "",
    "t=0,x.cmd=1,x.act=2",
    "t=0,x.cmd=0,x.act=1",
    "x.cmd=1,x.act=2,period_s=0.001",
    "t=t,x.cmd=x.cmd,x.act=9",
    "unit=um,time=ms",
    "t=2,x.cmd=1,x.act=1,x.torque=1",
];
/// Number of rows of a table that is long enough to be accepted.
const ROWS: u16 = 400;

/// Returns a table of a motion, with some cells spoilt.
fn table(draw: &mut Draw) -> Vec<u8> {
    let head = draw.pick(HEADS);
    let separator = draw.pick(&[',', ';', '\t', ' ']);
    let columns = 2 + usize::from(draw.below(5));
    let mut text = format!("{head}\n");
    let step_s: f64 = draw.pick(&[0.001, 0.002, 1.0, 0.0, -0.001]);
    let rows = draw.pick(&[ROWS, 0, 3, 50]);
    for row in 0..rows {
        let at_s = f64::from(row) * step_s;
        let mut cells = vec![format!("{at_s}")];
        cells.extend(
            (1..columns).map(|k| format!("{:.5}", 20.0 * (20.0 * at_s - 0.01 * k as f64).sin())),
        );
        if !draw.is_empty() && draw.below(32) == 0 {
            let at = usize::from(draw.byte()) % cells.len();
            match draw.below(4) {
                0 => drop(cells.remove(at)),
                1 => cells.push("7".to_owned()),
                2 => cells[at] = format!("{:e}", draw.double()),
                _ => draw.pick(CELLS).clone_into(&mut cells[at]),
            }
        }
        let _ = writeln!(text, "{}", cells.join(&separator.to_string()));
    }
    text.into_bytes()
}

/// Returns a MATLAB 5 file: a header, and elements with random types and sizes.
fn matlab(draw: &mut Draw) -> Vec<u8> {
    let mut file = b"MATLAB 5.0 MAT-file, Platform: FUZZ".to_vec();
    file.resize(124, b' ');
    file.extend_from_slice(&[0x00, 0x01, b'I', b'M']);
    for _ in 0..=draw.below(4) {
        let values = u32::from(draw.byte()) * 4;
        let mut body = Vec::new();
        element(
            &mut body,
            6,
            &[u8::from(draw.below(8) != 0) * 6, 0, 0, 0, 0, 0, 0, 0],
        );
        let rows = if draw.below(8) == 0 {
            u32::MAX >> draw.below(32)
        } else {
            values
        };
        element(
            &mut body,
            5,
            &[rows.to_le_bytes(), 1_u32.to_le_bytes()].concat(),
        );
        element(
            &mut body,
            1,
            draw.pick(&["t", "qg", "qm", "vir", "x_cmd", "\u{1b}"])
                .as_bytes(),
        );
        let slope = draw.number(1e-3);
        let content: Vec<u8> = (0..values)
            .flat_map(|k| (f64::from(k) * slope).to_le_bytes())
            .collect();
        element(&mut body, draw.pick(&[9, 7, 5, 200]), &content);
        if draw.below(8) == 0 {
            body.truncate(body.len() / 2);
        }
        if draw.below(3) == 0 {
            let squeezed = miniz_oxide::deflate::compress_to_vec_zlib(&wrapped(14, &body), 1);
            file.extend_from_slice(&wrapped(15, &squeezed));
        } else {
            element(&mut file, 14, &body);
        }
    }
    file
}

fn wrapped(kind: u32, content: &[u8]) -> Vec<u8> {
    [
        &kind.to_le_bytes()[..],
        &(content.len() as u32).to_le_bytes(),
        content,
    ]
    .concat()
}

/// Appends an element, padded to eight bytes.
fn element(file: &mut Vec<u8>, kind: u32, content: &[u8]) {
    file.extend_from_slice(&wrapped(kind, content));
    file.resize(file.len().next_multiple_of(8), 0);
}

/// Reads a log. Accepted data must be finite and of one length, and no message may command a
/// terminal.
pub(crate) fn read(data: &[u8]) {
    let mut draw = Draw::new(data);
    let kind = draw.below(4);
    let columns: Columns = draw.pick(COLUMNS).parse().unwrap_or_default();
    let bytes = match kind {
        0 | 1 => table(&mut draw),
        2 => matlab(&mut draw),
        _ => draw.rest().to_vec(),
    };
    match Log::from_reader(
        Path::new("f.log"),
        &bytes[..],
        bytes.len() as u64,
        &columns,
        &(),
    ) {
        Ok(log) => {
            assert!(
                log.sample_time_s > 0.0 && log.sample_time_s.is_finite(),
                "{}",
                log.sample_time_s
            );
            for axis in &log.axes {
                assert_eq!(axis.command_mm.len(), axis.actual_mm.len());
                assert!(
                    log.stretches
                        .iter()
                        .all(|stretch| stretch.end <= axis.command_mm.len())
                );
                let within = log
                    .stretches
                    .iter()
                    .flat_map(|stretch| &axis.command_mm[stretch.clone()]);
                assert!(within.copied().all(f64::is_finite), "{}", axis.name);
            }
        }
        Err(error) => {
            let message = error.to_string();
            assert!(
                !message.contains(|c| feedwright_gcode::is_hidden(c) && c != '\n'),
                "{}",
                message.escape_debug()
            );
        }
    }
}
