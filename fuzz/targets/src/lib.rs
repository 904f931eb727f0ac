//! Code that the fuzz targets run and check. Each takes any bytes, and panics if a requirement is
//! not met.
//!
//! | Target | Requirement |
//! |---|---|
//! | [`reader`] | any text in any dialect: finite coordinates in reach, motions that meet, messages without control characters |
//! | [`expressions`] | the value of an expression is the same when it is written in brackets, and always finite |
//! | [`files`] | files of machines, geometries and models: an accepted file is written as a file that states the same |
//! | [`block`] | blocks of models: an accepted block is written as a block that states the same |
//! | [`logs`] | CSV and MAT: accepted data is finite and complete |
//! | [`corrected`] | a corrected program is read again without mistakes, ends where the original ends and stays near it |
//! | [`planner`] | phases join; velocity, acceleration and jerk of every axis and the tolerance of the path hold |
//! | [`tick`] | any accepted model, plant and pins: commands and feedback are finite, commands near the path |
//!
//! `just fuzz MINUTES` runs all of them. `tests/suite.rs` replays the seeds and the findings of the
//! fuzzer.

mod draw;
mod programs;
mod paths;
mod blocks;
mod files;
mod logs;
mod corrected;
mod planned;
mod tick;

use std::fmt::Write;

use feedwright_gcode::canon::Canon;

use draw::Draw;

/// Name and function of a target.
pub type FuzzTarget = (&'static str, fn(&[u8]));

/// All targets.
pub const TARGETS: [FuzzTarget; 8] = [
    ("reader", reader),
    ("expressions", expressions),
    ("files", files),
    ("block", block),
    ("logs", logs),
    ("corrected", corrected),
    ("planner", planner),
    ("tick", tick),
];

/// Reads programs in any dialect.
pub fn reader(data: &[u8]) {
    let mut draw = Draw::new(data);
    let dialect = programs::dialect(&mut draw);
    if draw.below(4) == 0 {
        programs::read(draw.rest(), dialect);
    } else {
        programs::read(programs::program(&mut draw).as_bytes(), dialect);
    }
}

/// Reads expressions.
pub fn expressions(data: &[u8]) {
    let mut draw = Draw::new(data);
    let dialect = programs::dialect(&mut draw);
    let mut expression = String::new();
    programs::expression(&mut draw, &mut expression, 6);
    let mut text = String::from("G21 G90 F600\n");
    for k in 1..6 {
        let _ = writeln!(text, "#{k}={}", draw.number(9.0));
    }
    let _ = writeln!(
        text,
        "#27=[{expression}]\n#28=[[{expression}]]\nG1 X[#27]\nG1 X[#28]\nM2"
    );
    let steps = programs::read(text.as_bytes(), dialect);
    let ends = steps.iter().filter_map(|step| {
        if let Canon::Motion(motion) = step {
            Some(motion.end_mm[0])
        } else {
            None
        }
    });
    let ends: Vec<f64> = ends.collect();
    assert!(ends.len() < 2 || ends[0] == ends[1], "{ends:?}\n{text}");
}

/// Reads files of machines, geometries and models.
pub fn files(data: &[u8]) {
    files::read(data);
}

/// Reads blocks of models.
pub fn block(data: &[u8]) {
    let mut draw = Draw::new(data);
    match draw.below(4) {
        0 => {
            blocks::read::<2>(draw.rest());
            blocks::read::<3>(draw.rest());
        }
        1 => blocks::read::<3>(&blocks::absurd::<3>(&mut draw)),
        2 => blocks::read::<2>(&blocks::absurd::<2>(&mut draw)),
        _ => {
            let bytes = blocks::with_checksum(&mut draw);
            blocks::read::<2>(&bytes);
            blocks::read::<3>(&bytes);
        }
    }
}

/// Reads logs of machines.
pub fn logs(data: &[u8]) {
    logs::read(data);
}

/// Corrects programs, and reads the corrected ones.
pub fn corrected(data: &[u8]) {
    corrected::run(data);
}

/// Plans programs.
pub fn planner(data: &[u8]) {
    planned::run(data);
}

/// Runs the servo thread.
pub fn tick(data: &[u8]) {
    let Some((first, rest)) = data.split_first() else {
        return;
    };
    let _ = if first % 2 == 1 {
        tick::run::<3>(rest)
    } else {
        tick::run::<2>(rest)
    };
}

/// Returns the first bytes of inputs of [`tick`] that together run every change of one byte, and
/// every end, of valid blocks. The bytes after them choose the plant and the pins.
pub fn damaged_blocks() -> impl Iterator<Item = [u8; 6]> {
    tick::damaged_blocks::<2>().chain(tick::damaged_blocks::<3>())
}
