//! Random programs of what Fanuc and Haas have besides: no panic, no endless loop, and every motion
//! begins where the one before it ends.

use feedwright_gcode::canon::{Canon, Motion};
use feedwright_gcode::{Dialect, Increment, Reader, Settings};
use proptest::prelude::*;

/// Motions and lines without one after which a program is given up.
const LIMIT: u64 = 3000;

const LINES: [&str; 62] = [
    "G0 X50. Z2.",
    "G1 X#V Z-#V F0.2",
    "G1 U-#V W-#V",
    "G2 X20. Z-20. R5.",
    "G3 U10. W-5. R5.",
    "G1 X10.,R#V",
    "G1 Z-9.,C#V",
    "Y5.",
    "G90 X#V Z-30. R-#V F0.2",
    "X#V",
    "G94 X#V Z-#V K#V",
    "G92 X#V Z-20. F#V",
    "G32 Z-9. F1.",
    "G71 U#V R0.5",
    "G71 P1 Q2 U0.4 W0.1 F0.3",
    "G71 P1 Q2 D#V",
    "G72 W#V R0.1",
    "G72 P1 Q2",
    "G73 U#V W1. R#V",
    "G73 P1 Q2 U0.1",
    "G70 P1 Q2",
    "G74 R#V",
    "G74 X#V Z-#V P#V000 Q#V00",
    "G75 X#V Z-#V P100 Q1000 R.1",
    "G76 P02#V60 Q100 R0.05",
    "G76 X#V Z-30. P1300 Q#V00 F2.",
    "G76 X27. Z-30. K1.3 D.4 F#V A60",
    "N1 G0 X#V",
    "N1 G0 X#V W0",
    "N2 X50.",
    "N2 G1 W-#V",
    "G83 Z-#V R-1. Q#V",
    "G83 X1. Z-#V R1. I#V J1. K1.",
    "G84 Z-5. R1. F1.",
    "G80",
    "G96 S#V",
    "G97 S500 M3",
    "G50 S#V",
    "G50 X#V U#V",
    "G98",
    "G99",
    "G28 U0 W0",
    "G53 X#V",
    "T0#V0#V",
    "G40 G42 X5.",
    "G68 X#V Y1. R#V",
    "G69",
    "G16",
    "G15",
    "G54.1 P#V",
    "G10 L20 P#V X#V",
    "#1=#1+#V",
    "#[#1+#V]=#0",
    "WHILE [#1 LT #V] DO1",
    "END1",
    "IF [#1 EQ #0] GOTO #V",
    "IF [#1 GT #V] THEN #1=#0",
    "GOTO #V",
    "G65 P#V A1. B#1",
    "M98 P#V",
    "O#V",
    "M99 P#V",
];

fn program() -> impl Strategy<Value = String> {
    let line = (0..LINES.len(), 0..30_u32, prop::bool::ANY).prop_map(|(line, value, dot)| {
        let value = if dot {
            format!("{value}.{}", value % 7)
        } else {
            value.to_string()
        };
        LINES[line].replace("#V", &value)
    });
    prop::collection::vec(line, 1..40)
        .prop_map(|lines| format!("G97 S500 M3 F0.3\n{}\nM99\n", lines.join("\n")))
}

/// Found by the test below: pecks at constant surface speed that begin far out, some hundred
/// motions each.
#[test]
fn pecks_at_constant_surface_speed_are_bounded() {
    let text =
        "G97 S500 M3 F0.3\nG96 S100\nG0 X50. Z2.\nF0.1\nG75 R25.\nG75 X0. Z-25. P.1 Q.1 R.1\nM99\n";
    let settings = Settings {
        dialect: Some(Dialect::FanucLathe),
        ..Settings::default()
    };
    let steps: Vec<_> = Reader::from_text("part.nc", text, settings)
        .unwrap()
        .collect();
    assert!(steps.len() < 500_000, "{}", steps.len());
    assert!(steps.iter().any(|step| {
        step.as_ref()
            .is_err_and(|fault| fault.message.contains("400000 motions"))
    }));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1500))]

    #[test]
    fn every_program_ends_and_its_motions_hang_together(
        text in program(),
        dialect in prop::sample::select(&[Dialect::FanucMill, Dialect::FanucLathe, Dialect::HaasLathe][..]),
        counts in prop::bool::ANY,
    ) {
        let increment = counts.then(|| Increment::named("0.001mm")).transpose().ok().flatten();
        let settings = Settings {
            dialect: Some(dialect),
            increment,
            max_motions: LIMIT,
            max_idle_lines: LIMIT,
            ..Settings::default()
        };
        let Ok(reader) = Reader::from_text("part.nc", text.clone(), settings) else { return Ok(()) };
        let (mut motions, mut faults, mut steps) = (Vec::<Motion>::new(), 0, 0_u64);
        for step in reader {
            steps += 1;
            match step {
                Ok(Canon::Motion(motion)) => motions.push(motion),
                Ok(Canon::Event(_)) => {}
                Err(fault) => {
                    faults += 1;
                    prop_assert!(!fault.message.is_empty());
                }
            }
        }
        prop_assert!(steps < 1_000_000, "{steps} steps\n{text}");
        for motion in &motions {
            let numbers = [motion.feed_mm_s].into_iter().chain(motion.start_mm).chain(motion.end_mm);
            prop_assert!(numbers.into_iter().all(f64::is_finite), "{motion:?}\n{text}");
            if faults == 0 && motion.kind == feedwright_gcode::canon::MotionKind::Feed {
                prop_assert!(motion.feed_mm_s > 0.0, "{motion:?}\n{text}");
            }
        }
        if faults == 0 {
            for pair in motions.windows(2) {
                prop_assert_eq!(pair[0].end_mm, pair[1].start_mm, "{}", text);
            }
        }
    }
}
