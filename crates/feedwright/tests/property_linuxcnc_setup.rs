//! `linuxcnc setup` of configurations that are damaged anywhere: it wires, says why not, or names a
//! file and a line. It never panics.

use std::path::Path;

use feedwright::LinuxcncSetup;
use proptest::prelude::*;

use crate::golden_linuxcnc_setup::copied;

const NAMES: [&str; 8] = [
    "mesa-servo-inch",
    "analog-servo",
    "ethercat",
    "stepper-with-encoders",
    "broken",
    "simulated",
    "gantry",
    "rotary",
];
/// Signs that mean something in a HAL file or an INI file, and some that do not.
const SIGNS: [&str; 14] = [
    "\"", "'", "[", "]", "$", "(", ")", "#", "\\", "=", "<=", "\n", " ", "\u{fc}",
];

/// Damage of a file.
#[derive(Debug, Clone)]
enum Damage {
    Insert { at: usize, sign: usize },
    Delete { at: usize, count: usize },
    Cut { at: usize },
}

fn damage() -> impl Strategy<Value = Damage> {
    let at = 0..10_000_usize;
    prop_oneof![
        (at.clone(), 0..SIGNS.len()).prop_map(|(at, sign)| Damage::Insert { at, sign }),
        (at.clone(), 1..40_usize).prop_map(|(at, count)| Damage::Delete { at, count }),
        at.prop_map(|at| Damage::Cut { at }),
    ]
}

fn damaged(text: &str, damage: &Damage) -> String {
    let signs: Vec<char> = text.chars().collect();
    let place = |at: usize| at % (signs.len() + 1);
    let part = |range: &[char]| range.iter().collect::<String>();
    match *damage {
        Damage::Insert { at, sign } => {
            part(&signs[..place(at)]) + SIGNS[sign] + &part(&signs[place(at)..])
        }
        Damage::Delete { at, count } => {
            part(&signs[..place(at)]) + &part(&signs[(place(at) + count).min(signs.len())..])
        }
        Damage::Cut { at } => part(&signs[..place(at)]),
    }
}

fn are_reported(name: &str, file: usize, damages: &[Damage]) -> Result<(), TestCaseError> {
    let folder = copied(name);
    let is_read = |name: &String| name.ends_with(".hal") || name.ends_with(".ini");
    let files: Vec<String> = crate::golden_linuxcnc_setup::files(folder.path())
        .into_keys()
        .filter(is_read)
        .collect();
    let file = &files[file % files.len()];
    let text = damages
        .iter()
        .fold(folder.text(file), |text, damage| damaged(&text, damage));
    folder.file(file, text);
    for simulate in [None, Some("tnv40".to_owned())] {
        let setup = LinuxcncSetup {
            ini: folder.path().join("my.ini"),
            hallib: Path::new("/nowhere").to_owned(),
            simulate,
            raise_ferror: Some(5.0),
            replace: true,
        };
        match setup.wire(&()) {
            Ok(wiring) => prop_assert!(wiring.is_wired() != wiring.written.is_empty()),
            Err(error) => prop_assert!(error.to_string().len() > 10),
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_configurations_are_reported(name in 0..NAMES.len(), file in 0..3_usize, damages in prop::collection::vec(damage(), 1..4)) {
        are_reported(NAMES[name], file, &damages)?;
    }
}

/// A quotation mark without another, in front of a pin that is moved.
#[test]
fn damage_that_was_found_is_reported() {
    are_reported("rotary", 2, &[Damage::Insert { at: 2670, sign: 0 }]).unwrap();
}
