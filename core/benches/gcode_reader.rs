//! Megabytes a second from G-code text to canonical motions.

use divan::Bencher;
use divan::counter::BytesCount;
use feedwright::gcode::{Dialect, Reader, Settings};

fn main() {
    divan::main();
}

/// A print program as slicers write it: short feed motions with an extruder word.
fn print_program(lines: usize) -> String {
    let mut text = String::from("M82\nG28\nG1 Z0.2 F1200\n");
    for n in 0..lines {
        let angle = n as f64 * 0.05;
        let (x, y) = (100.0 + 40.0 * angle.cos(), 100.0 + 40.0 * angle.sin());
        text += &format!("G1 X{x:.3} Y{y:.3} E{:.5}\n", n as f64 * 0.0332);
    }
    text
}

/// A milling program with parameters and a loop.
fn loop_program(rounds: usize) -> String {
    format!("F600\n#1=0\no1 repeat [{rounds}]\n#1=[#1+0.1]\nG1 X[10*cos[#1]] Y[10*sin[#1]] Z-#1\no1 endrepeat\nM2\n")
}

fn read(text: &str, dialect: Dialect) -> usize {
    let settings = Settings { dialect: Some(dialect), ..Settings::default() };
    Reader::from_text("bench", text, settings).map_or(0, |reader| reader.filter(Result::is_ok).count())
}

#[divan::bench]
fn print_lines(bencher: Bencher<'_, '_>) {
    let text = print_program(100_000);
    bencher.counter(BytesCount::of_str(&text)).bench(|| read(divan::black_box(&text), Dialect::Printer));
}

#[divan::bench]
fn expressions_in_a_loop(bencher: Bencher<'_, '_>) {
    let text = loop_program(10_000);
    bencher.bench(|| read(divan::black_box(&text), Dialect::LinuxCnc));
}

#[divan::bench]
fn damaged_lines(bencher: Bencher<'_, '_>) {
    let text = "G1 X1 Y$ ; damaged\n".repeat(10_000);
    bencher.counter(BytesCount::of_str(&text)).bench(|| read(divan::black_box(&text), Dialect::LinuxCnc));
}
