//! The cycles of Fanuc lathes against an expansion by hand: `oracle_scripts/lathe_cycles.py` made
//! the numbers from the published rules.

use feedwright_gcode::canon::{Canon, MotionKind};
use feedwright_gcode::{Dialect, Reader, Settings};
use serde::Deserialize;

/// Both compute in f64; sums over a few dozen passes differ in the last bits.
const SAME_MM: f64 = 1e-9;

#[derive(Deserialize)]
struct Case {
    name: String,
    program: String,
    motions: Vec<(String, f64, f64)>,
}

fn cases() -> Vec<Case> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/oracle_data/lathe_cycles.json"
    );
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

#[test]
fn every_motion_of_a_cycle_follows_the_published_rule() {
    let cases = cases();
    assert!(cases.len() >= 18);
    for case in cases {
        let settings = Settings {
            dialect: Some(Dialect::FanucLathe),
            ..Settings::default()
        };
        let motions: Vec<(&str, [f64; 3])> =
            Reader::from_text("lathe.nc", case.program.clone(), settings)
                .unwrap()
                .filter_map(|step| {
                    match step.unwrap_or_else(|fault| panic!("{}: {fault:?}", case.name)) {
                        Canon::Motion(motion) => Some((
                            if motion.kind == MotionKind::Rapid {
                                "rapid"
                            } else {
                                "feed"
                            },
                            motion.end_mm,
                        )),
                        Canon::Event(_) => None,
                    }
                })
                .collect();
        for (n, (read, made)) in motions.iter().zip(&case.motions).enumerate() {
            let apart = (read.1[0] - made.1).hypot(read.1[2] - made.2);
            assert!(
                read.0 == made.0 && apart < SAME_MM,
                "{}: motion {n} is {read:?}, should be {made:?}\n{}",
                case.name,
                case.program
            );
        }
        assert_eq!(motions.len(), case.motions.len(), "{}", case.name);
    }
}
