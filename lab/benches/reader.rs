//! Speed from G-code text to canonical motions, and of reading the words alone, MB/s.
//!
//! `cargo bench -p feedwright-lab --bench reader`; the column MB/s counts bytes of program text.

use divan::Bencher;
use divan::counter::BytesCount;
use feedwright_gcode::{Dialect, Reader, Settings, count_words};

fn main() {
    divan::main();
}

/// Returns a print program as slicers write it: short feed motions with an extruder word.
fn print_program(lines: usize) -> String {
    let mut text = String::from("M82\nG28\nG1 Z0.2 F1200\n");
    for n in 0..lines {
        let angle = n as f64 * 0.05;
        let (x, y) = (100.0 + 40.0 * angle.cos(), 100.0 + 40.0 * angle.sin());
        text += &format!("G1 X{x:.3} Y{y:.3} E{:.5}\n", n as f64 * 0.0332);
    }
    text
}

/// Returns a milling program as CAM systems write it: numbered lines, three axes, an arc and a
/// comment now and then.
fn cam_program(lines: usize) -> String {
    let mut text = String::from(
        "%\n(T1 D6 END MILL)\nG21 G17 G90 G94 G40 G64 P0.01\nT1 M6\nS12000 M3\nG0 X100.000 Y0.000 Z5.000\n",
    );
    for n in 0..lines {
        let angle = n as f64 * 0.01;
        let (x, y, z) = (
            100.0 * angle.cos(),
            100.0 * angle.sin(),
            -0.5 - 0.4 * (7.0 * angle).sin(),
        );
        text += &match n % 50 {
            0 => format!("N{} (PASS {})\n", 10 * n, n / 50),
            1 => format!("N{} G1 X{x:.3} Y{y:.3} Z{z:.3} F1800.\n", 10 * n),
            // Half a circle around the point 1 mm ahead, and back to the start of the next line.
            25 => format!("N{} G91 G2 X2. Y0. I1. J0.\n", 10 * n),
            26 => format!("N{} G90 G1 X{x:.3} Y{y:.3}\n", 10 * n),
            _ => format!("N{} X{x:.3} Y{y:.3} Z{z:.3}\n", 10 * n),
        };
    }
    text + "M5\nM30\n%\n"
}

/// Returns a milling program with parameters and a loop.
fn loop_program(rounds: usize) -> String {
    format!(
        "F600\n#1=0\no1 repeat [{rounds}]\n#1=[#1+0.1]\nG1 X[10*cos[#1]] Y[10*sin[#1]] Z-#1\no1 endrepeat\nM2\n"
    )
}

fn read(text: &str, dialect: Dialect) -> usize {
    let settings = Settings {
        dialect: Some(dialect),
        ..Settings::default()
    };
    Reader::from_text("bench", text, settings)
        .map_or(0, |reader| reader.filter(Result::is_ok).count())
}

/// Counts the faults. A program with faults would measure the formatting of messages.
fn faults(text: &str, dialect: Dialect) -> usize {
    let settings = Settings {
        dialect: Some(dialect),
        ..Settings::default()
    };
    Reader::from_text("bench", text, settings)
        .map_or(1, |reader| reader.filter(Result::is_err).count())
}

/// Words of the milling program, not executed.
#[divan::bench]
fn cam_words_alone(bencher: Bencher<'_, '_>) {
    let text = cam_program(100_000);
    bencher
        .counter(BytesCount::of_str(&text))
        .bench(|| count_words(divan::black_box(text.as_bytes())));
}

/// Words of the print program, not executed.
#[divan::bench]
fn print_words_alone(bencher: Bencher<'_, '_>) {
    let text = print_program(100_000);
    bencher
        .counter(BytesCount::of_str(&text))
        .bench(|| count_words(divan::black_box(text.as_bytes())));
}

#[divan::bench]
fn cam_lines(bencher: Bencher<'_, '_>) {
    let text = cam_program(100_000);
    assert_eq!(faults(&text, Dialect::LinuxCnc), 0);
    bencher
        .counter(BytesCount::of_str(&text))
        .bench(|| read(divan::black_box(&text), Dialect::LinuxCnc));
}

#[divan::bench]
fn print_lines(bencher: Bencher<'_, '_>) {
    let text = print_program(100_000);
    assert_eq!(faults(&text, Dialect::Printer), 0);
    bencher
        .counter(BytesCount::of_str(&text))
        .bench(|| read(divan::black_box(&text), Dialect::Printer));
}

#[divan::bench]
fn expressions_in_a_loop(bencher: Bencher<'_, '_>) {
    let text = loop_program(10_000);
    bencher.bench(|| read(divan::black_box(&text), Dialect::LinuxCnc));
}

#[divan::bench]
fn damaged_lines(bencher: Bencher<'_, '_>) {
    let text = "G1 X1 Y$ ; damaged\n".repeat(10_000);
    bencher
        .counter(BytesCount::of_str(&text))
        .bench(|| read(divan::black_box(&text), Dialect::LinuxCnc));
}
