//! Programs: arbitrary text, and text of a grammar that the reader does not reject in its first
//! line.

use std::fmt::Write;

use feedwright_gcode::canon::{Canon, Motion, Shape};
use feedwright_gcode::{DIALECTS, Dialect, Reader, Settings};

use crate::draw::Draw;

/// Largest numbers of lines without a motion, of motions and of nested calls: a program ends within
/// milliseconds.
const IDLE_LINES: u64 = 2_000;
const MOTIONS: u64 = 2_000;
const DEPTH: usize = 20;
/// Largest number of motions and events that are read from a program.
const TAKEN: usize = 4_000;
/// Largest gap between two motions that meet, mm: rounding at the largest coordinate.
const MEET_MM: f64 = 1e-6;
/// Largest number of levels of an expression.
const LEVELS: u8 = 4;

const WORDS: &str = "XYZABCUVWIJKRPQLDEFHST";
const CODES: &[&str] = &[
    "G0", "G1", "G2", "G3", "G4", "G5", "G5.1", "G5.2", "G5.3", "G7", "G8", "G10", "G12", "G16",
    "G15", "G17", "G18", "G19", "G20", "G21", "G28", "G28.1", "G30", "G33", "G33.1", "G38.2",
    "G40", "G41", "G42", "G41.1", "G42.1", "G43", "G43.1", "G43.2", "G49", "G50", "G51", "G52",
    "G53", "G54", "G55", "G59.3", "G54.1", "G61", "G61.1", "G64", "G65", "G66", "G67", "G68",
    "G69", "G70", "G71", "G71.1", "G72", "G73", "G74", "G75", "G76", "G80", "G81", "G82", "G83",
    "G84", "G85", "G86", "G87", "G88", "G89", "G90", "G91", "G90.1", "G91.1", "G92", "G92.1",
    "G92.2", "G92.3", "G93", "G94", "G95", "G96", "G97", "G98", "G99", "G150", "G184", "M0", "M1",
    "M2", "M3", "M5", "M6", "M19", "M30", "M48", "M52", "M61", "M62", "M66", "M67", "M70", "M72",
    "M82", "M83", "M97", "M98", "M99", "M101", "M117", "M198", "M600",
];
const LITERALS: &[&str] = &[
    "%",
    "(",
    ")",
    ";",
    "/",
    "/2",
    "(MSG, x)",
    "(debug,#1)",
    "N10",
    "N20",
    "O100",
    "O9000",
    ":7",
    "$H",
    "!",
    "~",
    "?",
    "@3",
    "^45",
    ",R1",
    ",C2",
    "#1=5",
    "#<a>=2",
    "#<_a>=3",
    "#[1+1]=2",
    "GOTO10",
    "IF[#1LT3]GOTO20",
    "IF[1]THEN#2=1",
    "WHILE[#1LT3]DO1",
    "END1",
    "#1=[#1+1]",
    "SIN",
    "START_PRINT",
    "*71",
    "T0101",
    "G28U0W0",
    "\u{1b}[31m",
    "\u{202e}",
    "0x",
    "1e5",
    "--1",
    "+.5",
    "1.2.3",
    ".",
    "\t",
    "\r",
];

/// Returns a program with lines as a control has them, some of them spoilt.
pub(crate) fn program(draw: &mut Draw) -> String {
    let mut text = String::from(draw.pick(&[
        "G21 G90 F600\n",
        "G20 G91 F10\n",
        "%\nO1 (A)\nG21\n",
        "",
        "%\n",
        "$H\n",
        "M82\n",
    ]));
    let mut labels = Vec::new();
    while !draw.is_empty() && text.len() < 4_000 {
        line(draw, &mut text, &mut labels);
        text.push('\n');
    }
    while let Some((number, keyword)) = labels.pop() {
        let _ = writeln!(text, "o{number} {keyword}");
    }
    text.push_str(draw.pick(&["M2\n", "M30\n%\n", "%\n", ""]));
    text
}

/// Appends a line; `labels` holds the O-word blocks that are open.
fn line(draw: &mut Draw, text: &mut String, labels: &mut Vec<(usize, &'static str)>) {
    match draw.below(10) {
        0 => o_word(draw, text, labels),
        1 => {
            let _ = write!(text, "#{}=", draw.below(12));
            expression(draw, text, LEVELS);
        }
        2 => text.push_str(draw.pick(LITERALS)),
        kind => {
            if kind < 8 {
                text.push_str(draw.pick(CODES));
            }
            for _ in 0..draw.below(5) {
                word(draw, text);
            }
            if draw.below(16) == 0 {
                text.push_str(draw.pick(LITERALS));
            }
        }
    }
}

fn word(draw: &mut Draw, text: &mut String) {
    // The letters that most motions have are the most frequent.
    let letter = if draw.below(2) == 0 {
        draw.pick(b"XYZ")
    } else {
        draw.pick(WORDS.as_bytes())
    };
    text.push(' ');
    text.push(char::from(letter));
    if draw.below(8) == 0 {
        expression(draw, text, 2);
    } else {
        let _ = write!(text, "{}", draw.number(20.0));
    }
}

fn o_word(draw: &mut Draw, text: &mut String, labels: &mut Vec<(usize, &'static str)>) {
    let number = 100 + labels.len();
    let opened = match draw.below(9) {
        0 => Some(("while [#1 lt 3]", "endwhile")),
        1 => Some(("repeat [2]", "endrepeat")),
        2 => Some(("do", "while [#2 lt 2]")),
        3 => Some(("if [#1 gt 1]", "endif")),
        4 => Some(("sub", "endsub")),
        5 => {
            let _ = write!(text, "o{number} call [{}]", draw.number(3.0));
            return;
        }
        _ => None,
    };
    match (opened, labels.last()) {
        (Some((keyword, end)), _) => {
            let _ = write!(text, "o{number} {keyword}\n#1=[#1+1]\n#2=[#2+1]");
            labels.push((number, end));
        }
        (None, Some((inner, _))) if draw.below(2) == 0 => {
            let _ = write!(
                text,
                "o{inner} {}",
                draw.pick(&["break", "continue", "else", "elseif [1]", "return"])
            );
        }
        (None, _) => {
            if let Some((inner, end)) = labels.pop() {
                let _ = write!(text, "o{inner} {end}");
            }
        }
    }
}

/// Appends an expression with at most `levels` levels.
pub(crate) fn expression(draw: &mut Draw, text: &mut String, levels: u8) {
    const OPERATORS: &[&str] = &[
        "+", "-", "*", "/", "**", " MOD ", " AND ", " OR ", " XOR ", " EQ ", " NE ", " GT ",
        " GE ", " LT ", " LE ",
    ];
    const FUNCTIONS: &[&str] = &[
        "ABS", "ACOS", "ASIN", "COS", "EXP", "FIX", "FUP", "LN", "ROUND", "SIN", "SQRT", "TAN",
        "-", "+", "ATAN",
    ];
    match if levels == 0 { 0 } else { draw.below(8) } {
        0 | 1 => {
            let _ = write!(text, "{}", draw.number(50.0));
        }
        2 => {
            let _ = write!(text, "#{}", draw.below(12));
        }
        3 => text.push_str(draw.pick(&[
            "#<a>",
            "#5220",
            "EXISTS[#<b>]",
            "EXISTS[#99999]",
            "#[2]",
            "##1",
            "#5399",
        ])),
        4 => {
            let function = draw.pick(FUNCTIONS);
            text.push_str(function);
            bracketed(draw, text, levels);
            if function == "ATAN" {
                text.push('/');
                bracketed(draw, text, levels);
            }
        }
        _ => {
            text.push('[');
            expression(draw, text, levels - 1);
            for _ in 0..=draw.below(2) {
                text.push_str(draw.pick(OPERATORS));
                expression(draw, text, levels - 1);
            }
            text.push(']');
        }
    }
}

fn bracketed(draw: &mut Draw, text: &mut String, levels: u8) {
    text.push('[');
    expression(draw, text, levels - 1);
    text.push(']');
}

/// Returns settings with which every program ends soon.
pub(crate) fn settings(dialect: Option<Dialect>) -> Settings {
    Settings {
        dialect,
        max_idle_lines: IDLE_LINES,
        max_motions: MOTIONS,
        max_depth: DEPTH,
        block_delete: true,
        ..Settings::default()
    }
}

/// Reads a program and checks the result: finite numbers within the reach of the machine, motions
/// that meet, messages without control characters.
pub(crate) fn read(text: &[u8], dialect: Option<Dialect>) -> Vec<Canon> {
    let settings = settings(dialect);
    let limit_mm = settings.coordinate_limit_mm;
    let Ok(mut reader) = Reader::from_text("part.ngc", text, settings) else {
        return Vec::new();
    };
    let (mut steps, mut faulty) = (Vec::new(), false);
    let mut last_mm: Option<[f64; 3]> = None;
    for step in reader.by_ref().take(TAKEN) {
        let step = match step {
            Ok(step) => step,
            Err(fault) => {
                assert!(
                    !fault.to_string().contains(feedwright_gcode::is_hidden),
                    "{fault:?}"
                );
                faulty = true;
                continue;
            }
        };
        if let Canon::Motion(motion) = &step {
            check(motion, limit_mm);
            // After a fault the reader continues from an assumed position.
            if let (Some(last), false) = (last_mm, faulty) {
                let gap = (0..3)
                    .map(|k| (last[k] - motion.start_mm[k]).abs())
                    .fold(0.0, f64::max);
                assert!(gap <= MEET_MM, "a gap of {gap} mm before {motion:?}");
            }
            last_mm = Some(motion.end_mm);
        }
        steps.push(step);
    }
    if faulty { Vec::new() } else { steps }
}

fn check(motion: &Motion, limit_mm: f64) {
    let reach = |points: &[[f64; 3]]| points.iter().flatten().all(|mm| mm.abs() <= 4.0 * limit_mm);
    assert!(reach(&[motion.start_mm, motion.end_mm]), "{motion:?}");
    assert!(
        motion.feed_mm_s.is_finite() && motion.feed_mm_s >= 0.0,
        "{motion:?}"
    );
    match &motion.shape {
        Shape::Line => {}
        Shape::Arc {
            center_mm, turns, ..
        } => {
            assert!(
                center_mm.iter().all(|mm| mm.is_finite()) && *turns != 0,
                "{motion:?}"
            );
        }
        Shape::Spline(spline) => {
            assert!(
                spline
                    .knots
                    .iter()
                    .chain(&spline.weights)
                    .all(|number| number.is_finite()),
                "{motion:?}"
            );
            assert!(
                spline.control_mm.iter().flatten().all(|mm| mm.is_finite()),
                "{motion:?}"
            );
        }
    }
}

/// Draws a dialect; `None` leaves the choice to the reader.
pub(crate) fn dialect(draw: &mut Draw) -> Option<Dialect> {
    let at = usize::from(draw.byte());
    DIALECTS
        .get(at % (DIALECTS.len() + 1))
        .map(|(_, dialect)| *dialect)
}
