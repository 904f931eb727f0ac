//! Files of machines, geometries and models: arbitrary text, and valid files with some changed
//! values.

use std::fmt::Write;

use feedwright_control::{ModelBlock, Trained};
use feedwright_ident::{Model, Origin, Recording, TrainedAxes};
use feedwright_sim::{BUILT_IN_MACHINES, GeometryFile, Machine};

use crate::blocks;
use crate::draw::Draw;

/// Largest number of changes to a file.
const SPOILT: u8 = 6;

const VALUES: &[&str] = &[
    "0",
    "-1",
    "1",
    "1e-12",
    "1e12",
    "1e308",
    "nan",
    "inf",
    "-inf",
    "true",
    "\"\"",
    "\"x\"",
    "[]",
    "[1]",
    "{}",
    "1979-05-27",
    "0x10",
    "9223372036854775807",
    "\"\\u001B[31m\"",
    "[[1, 2], [2, 3]]",
];

const GEOMETRY: &str = "format = 1\nname = \"x\"\nsource = \"ball bar\"\ndate = \"2026-01-01\"\n[axis.x]\nscale_um_per_m = 20\n\
                        backlash_um = 5\n[axis.y]\nscale_um_per_m = -30\n[squareness]\nxy_um_per_m = 10\n";

/// Returns a text in which some lines are left out, doubled, extended by control characters, or
/// given other values.
fn spoilt(draw: &mut Draw, text: &str) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    if lines.is_empty() {
        return String::new();
    }
    for _ in 0..=draw.below(SPOILT) {
        let at = usize::from(u16::from_le_bytes([draw.byte(), draw.byte()])) % lines.len();
        let key = lines[at]
            .split_once('=')
            .map(|(key, _)| key.trim().to_owned());
        match (draw.below(8), key) {
            (0, _) => lines[at].clear(),
            (1, _) => lines[at] = lines[at].repeat(2),
            (2, _) => lines[at].push_str("\u{1b}]0;x\u{7}\u{202e}"),
            (3 | 4, Some(key)) => lines[at] = format!("{key} = {}", draw.pick(VALUES)),
            (_, Some(key)) => lines[at] = format!("{key} = {:?}", draw.number(1e3)),
            (_, None) => {}
        }
    }
    lines.iter().fold(String::new(), |mut text, line| {
        let _ = writeln!(text, "{line}");
        text
    })
}

/// Checks that the message of a rejection has no character that commands a terminal.
fn assert_inert(message: &str) {
    assert!(
        !message.contains(|c| feedwright_gcode::is_hidden(c) && c != '\n'),
        "{}",
        message.escape_debug()
    );
}

/// Reads a file of any kind. An accepted file must be written as a file that is accepted and states
/// the same.
pub(crate) fn read(data: &[u8]) {
    let mut draw = Draw::new(data);
    let kind = draw.below(6);
    let made = match kind {
        0 | 1 => spoilt(&mut draw, &machine_text(draw_name(data))),
        2 => {
            let text = model_text(&mut draw);
            spoilt(&mut draw, &text)
        }
        5 => model_text(&mut draw),
        3 => spoilt(&mut draw, GEOMETRY),
        _ => String::from_utf8_lossy(draw.rest()).into_owned(),
    };
    match Machine::parse("m.toml", &made) {
        Ok(machine) => {
            let text = machine.text();
            let again = Machine::parse("again.toml", &text)
                .unwrap_or_else(|error| panic!("{error:?}\n{text}"));
            assert_eq!(again.fingerprint(), machine.fingerprint(), "{text}");
        }
        Err(error) => assert_inert(&error.to_string()),
    }
    match Model::parse("m.model.toml", &made) {
        Ok(model) => {
            let text = model.text();
            let again =
                Model::parse("again", &text).unwrap_or_else(|error| panic!("{error:?}\n{text}"));
            assert!(again.block(None) == model.block(None), "{text}");
        }
        Err(error) => assert_inert(&error.to_string()),
    }
    if let Err(error) = GeometryFile::parse("g.toml", &made) {
        assert_inert(&error.to_string());
    }
}

fn draw_name(data: &[u8]) -> &'static str {
    BUILT_IN_MACHINES[usize::from(data.get(1).copied().unwrap_or(0)) % BUILT_IN_MACHINES.len()].0
}

fn machine_text(name: &str) -> String {
    Machine::load(name.as_ref())
        .map(|machine| machine.text())
        .unwrap_or_default()
}

/// Returns the model file of the axes of a block; empty if the block is rejected.
fn model_text(draw: &mut Draw) -> String {
    let Ok(ModelBlock { model, .. }) = ModelBlock::<2>::from_bytes(&blocks::absurd::<2>(draw))
    else {
        return String::new();
    };
    let Trained::Axes(axes) = model.trained else {
        return String::new();
    };
    let recording = Recording {
        servo_s: model.servo_s,
        feed_period_s: model.feed_period_s,
        stretches: Vec::new(),
    };
    let trained = TrainedAxes {
        axes,
        estimates: Vec::new(),
        fit_um: 0.1,
        samples: 100,
    };
    let origin = Origin {
        source: "fuzz".to_owned(),
        date: "2026-01-01".to_owned(),
    };
    Model::of_axes(&recording, &trained, origin).text()
}
