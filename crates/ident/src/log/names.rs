//! What the name of a column says: which quantity of which axis, in which unit.

use super::TorqueUnit;
use super::units::{PositionUnit, TimeUnit};

/// Content of a column, by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    Time,
    /// Samples, counted.
    Counter,
    Command,
    Actual,
    /// A position, whichever.
    Position,
    /// Command minus actual position.
    Lag,
    Torque,
    /// Actual speed.
    Velocity,
    /// Anything else, or nothing that is known.
    Other,
}

/// A name, understood.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Meaning {
    pub(super) quantity: Quantity,
    /// Name of the axis; empty if the column name states no axis.
    pub(super) axis: String,
    /// Unit in the name; empty if the name states no unit.
    pub(super) unit: String,
    /// Quality of the match of the word: of two columns of a kind the one with the higher value is
    /// used.
    pub(super) fit: u8,
}

const COMMANDS: [&str; 18] = [
    "cmd",
    "command",
    "commanded",
    "des",
    "desired",
    "demand",
    "demanded",
    "ref",
    "reference",
    "setpoint",
    "set",
    "sp",
    "soll",
    "sollwert",
    "nominal",
    "qg",
    "comm",
    "rpos",
];
/// Words for the final position of a command, which may be reached only later.
const TARGETS: [&str; 3] = ["target", "goal", "ziel"];
const ACTUALS: [&str; 16] = [
    "act", "actual", "fb", "fbk", "feedback", "meas", "measured", "measure", "enc", "encoder",
    "ist", "istwert", "qm", "real", "mpos", "apos",
];
const TORQUES: [&str; 11] = [
    "torque", "trq", "tq", "tau", "moment", "force", "current", "iq", "curr", "vir", "amps",
];
const POSITIONS: [&str; 4] = ["pos", "position", "posn", "lage"];
const TIMES: [&str; 8] = [
    "t",
    "time",
    "timestamp",
    "zeit",
    "clock",
    "seconds",
    "millis",
    "ms",
];
const COUNTERS: [&str; 9] = [
    "n", "sample", "samples", "cycle", "index", "idx", "counter", "count", "k",
];
const SPEEDS: [&str; 6] = ["velocity", "vel", "velo", "speed", "geschwindigkeit", "v"];
/// Words of other quantities.
const OTHERS: [&str; 37] = [
    "modulo",
    "acceleration",
    "accel",
    "acc",
    "jerk",
    "error",
    "err",
    "ferror",
    "dev",
    "deviation",
    "diff",
    "lag",
    "ffw",
    "feedforward",
    "power",
    "voltage",
    "volt",
    "load",
    "temp",
    "temperature",
    "bus",
    "limit",
    "max",
    "min",
    "offset",
    "status",
    "state",
    "dtg",
    "line",
    "inpos",
    "clk",
    "feedrate",
    "spindle",
    "inertia",
    "output",
    "integral",
    "overrun",
];
/// Signals of Servo Guide: what stands before the axis in the name of a channel.
pub(super) const SERVO_GUIDE_SIGNALS: [(&str, Quantity); 6] = [
    ("POSF", Quantity::Actual),
    ("ERR", Quantity::Lag),
    ("TCMD", Quantity::Torque),
    ("SPEED", Quantity::Velocity),
    ("VCMD", Quantity::Other),
    ("MCMD", Quantity::Other),
];
/// Letters of axes.
const LETTERS: &str = "xyzabcuvw";
/// Words before the letter or the number of an axis.
const AXIS_WORDS: [&str; 6] = ["joint", "axis", "motor", "drive", "pid", "ax"];

/// Interprets the name of a column.
pub(super) fn understand(name: &str) -> Meaning {
    if let Some(meaning) = of_component(name).or_else(|| of_scope(name)) {
        return meaning;
    }
    let (bare, unit) = split_unit(name);
    let words = words(&bare);
    let meaning = of_words(&words, &unit);
    let is_unit = |word: &String| UNIT_WORDS.split(' ').any(|unit| unit == word);
    match words.split_last() {
        // A word that makes the quantity, as in `index_count`, is no unit; and a counter, as
        // `sample_count`, has none.
        Some((last, rest))
            if unit.is_empty()
                && !rest.is_empty()
                && is_unit(last)
                && meaning.quantity != Quantity::Counter =>
        {
            Some(of_words(rest, last))
                .filter(|found| found.quantity == meaning.quantity)
                .unwrap_or(meaning)
        }
        _ => meaning,
    }
}

/// Interprets the words of a name.
fn of_words(words: &[String], unit: &str) -> Meaning {
    let axis = Some(axis(words))
        .filter(|axis| !axis.is_empty())
        .unwrap_or_else(|| remainder(words));
    let has = |list: &[&str]| {
        words
            .iter()
            .any(|word| list.contains(&word.as_str()) || without_axis(word, list))
    };
    let (quantity, fit) = if is_spindle(&axis) {
        (Quantity::Other, 0)
    } else if words.iter().any(|word| word == "diff") && has(&POSITIONS) && !has(&SPEEDS) {
        (Quantity::Lag, 1)
    } else if has(&SPEEDS) && !has(&OTHERS) {
        (
            if has(&COMMANDS) {
                Quantity::Other
            } else {
                Quantity::Velocity
            },
            1,
        )
    } else if has(&SPEEDS) || has(&OTHERS) {
        (Quantity::Other, 0)
    } else if has(&TORQUES) && !has(&POSITIONS) {
        // Where there are both, torque says more than current.
        (
            Quantity::Torque,
            if has(&["torque", "force", "vir", "tau"]) {
                3
            } else {
                2 - u8::from(has(&COMMANDS))
            },
        )
    } else if has(&COMMANDS) {
        (Quantity::Command, 2)
    } else if has(&ACTUALS) {
        (Quantity::Actual, 2)
    } else if has(&TARGETS) {
        (Quantity::Command, 1)
    } else if has(&POSITIONS) {
        (Quantity::Position, 1)
    } else if has(&TIMES) {
        (Quantity::Time, if words.len() == 1 { 2 } else { 1 })
    } else if has(&COUNTERS) {
        (Quantity::Counter, 2)
    } else if words.len() <= 2
        && words
            .first()
            .is_some_and(|word| word.len() == 1 && LETTERS.contains(word.as_str()))
    {
        (Quantity::Position, 0)
    } else {
        (Quantity::Other, 0)
    };
    Meaning {
        quantity,
        axis,
        unit: unit.to_owned(),
        fit,
    }
}

/// Interprets a pin of the HAL component `feedwright`, whose number is the joint number. LinuxCNC's
/// own command fits better than the command of the drive.
fn of_component(name: &str) -> Option<Meaning> {
    let (kind, number) = name.strip_prefix("feedwright.")?.rsplit_once('-')?;
    number.parse::<u8>().ok()?;
    let (quantity, fit) = match kind {
        "command" => (Quantity::Command, 2),
        "drive" => (Quantity::Command, 1),
        "actual" => (Quantity::Actual, 3),
        "feedback" => (Quantity::Actual, 1),
        _ => (Quantity::Other, 0),
    };
    Some(Meaning {
        quantity,
        axis: format!("joint{number}"),
        unit: String::new(),
        fit,
    })
}

/// A channel of Servo Guide, such as `POSF X`, or of TNCscope, such as `s actual X`: s is a
/// position, v a speed, i a current.
fn of_scope(name: &str) -> Option<Meaning> {
    let (bare, unit) = split_unit(name);
    let words: Vec<&str> = bare.split_whitespace().collect();
    let (quantity, axis) = match words[..] {
        [signal, ref axis @ ..] if SERVO_GUIDE_SIGNALS.iter().any(|(name, _)| *name == signal) => (
            SERVO_GUIDE_SIGNALS
                .iter()
                .find(|(name, _)| *name == signal)?
                .1,
            axis,
        ),
        [letter @ ("s" | "v" | "a" | "j" | "i"), kind, ref axis @ ..] if !axis.is_empty() => {
            let quantity = match (letter, kind.trim_end_matches('.')) {
                ("s", "nominal" | "nom" | "soll") => Quantity::Command,
                ("s", "actual" | "act" | "ist") => Quantity::Actual,
                ("s", "dif" | "diff") => Quantity::Lag,
                ("v", "actual" | "act" | "ist") => Quantity::Velocity,
                ("i", "actual" | "act" | "ist") => Quantity::Torque,
                (_, "nominal" | "nom" | "soll" | "actual" | "act" | "ist" | "dif" | "diff") => {
                    Quantity::Other
                }
                _ => return None,
            };
            (quantity, axis)
        }
        _ => return None,
    };
    let axis = axis.concat().to_lowercase();
    let quantity = if is_spindle(&axis) {
        Quantity::Other
    } else {
        quantity
    };
    Some(Meaning {
        quantity,
        axis,
        unit,
        fit: 2,
    })
}

/// Returns true if the name of an axis says that it is a spindle.
pub(super) fn is_spindle(axis: &str) -> bool {
    ["s", "sp", "spindle"].contains(&axis.trim_end_matches(|c: char| c.is_ascii_digit()))
}

/// Returns a name without its known words: the part that columns of the same axis share.
fn remainder(words: &[String]) -> String {
    let lists: [&[&str]; 8] = [
        &COMMANDS, &TARGETS, &ACTUALS, &TORQUES, &POSITIONS, &SPEEDS, &TIMES, &COUNTERS,
    ];
    let unknown = words
        .iter()
        .filter(|word| !lists.iter().any(|list| list.contains(&word.as_str())));
    unknown.map(String::as_str).collect::<Vec<_>>().concat()
}

/// Units that end a name, as in `x act mm`: those that are converted, and those that are refused.
const UNIT_WORDS: &str = "mm um micron microns inch inches ms us ns nm deg degrees rad cm dm km ft feet mil mils thou furlong furlongs \
                         cnt cnts count counts incs increments pulses steps ticks turns revs mrad urad arcmin arcsec px lsb";
/// Units that are too short to end a name behind any other sign than `_`.
const ENDINGS: [&str; 4] = ["m", "in", "s", "%"];

/// A name without its unit, and the unit: in brackets, or behind `_`. What else stands in brackets,
/// such as an axis or a number, belongs to the name.
fn split_unit(name: &str) -> (String, String) {
    let mut at = name.len();
    while let Some(open) = name[..at].rfind(['[', '(']) {
        let close = if name[open..].starts_with('[') {
            ']'
        } else {
            ')'
        };
        if let Some((unit, behind)) = name[open + 1..].split_once(close)
            && (is_known_unit(unit.trim()) || !is_part_of_name(unit))
        {
            return (format!("{}{behind}", &name[..open]), unit.trim().to_owned());
        }
        at = open;
    }
    match name.rsplit_once('_') {
        Some((bare, unit))
            if ENDINGS.contains(&unit.to_lowercase().as_str()) && !bare.is_empty() =>
        {
            (bare.to_owned(), unit.to_owned())
        }
        _ => (name.to_owned(), String::new()),
    }
}

/// Returns true if a text is a unit of length, time or torque.
pub(super) fn is_known_unit(text: &str) -> bool {
    PositionUnit::from_name(text).is_some()
        || TimeUnit::from_name(text).is_some()
        || TorqueUnit::from_name(text).is_some()
}

/// Returns true if a text in brackets is an axis, a number or a quantity.
fn is_part_of_name(text: &str) -> bool {
    let lists: [&[&str]; 7] = [
        &COMMANDS, &TARGETS, &ACTUALS, &TORQUES, &POSITIONS, &SPEEDS, &OTHERS,
    ];
    let is_number = |word: &str| word.chars().all(|c| c.is_ascii_digit());
    let is_axis = |word: &str| {
        word.len() == 1 && LETTERS.contains(word) || AXIS_WORDS.contains(&word) || is_spindle(word)
    };
    let words = words(text);
    let is_part = |word: &String| {
        is_number(word) || is_axis(word) || lists.iter().any(|list| list.contains(&word.as_str()))
    };
    !words.is_empty() && words.iter().all(is_part)
}

/// The words of a name: separated by signs, by changes from letters to digits, and by capitals.
fn words(name: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut before = ' ';
    for c in name.chars() {
        if !c.is_alphanumeric() {
            before = ' ';
            continue;
        }
        let starts = before == ' '
            || (c.is_numeric() != before.is_numeric())
            || (c.is_uppercase() && before.is_lowercase());
        if starts {
            words.push(String::new());
        }
        if let Some(word) = words.last_mut() {
            word.extend(c.to_lowercase());
        }
        before = c;
    }
    words
}

/// Returns true if a word is one of a list with the letter of an axis before or behind it, as in
/// `xfb`.
fn without_axis(word: &str, list: &[&str]) -> bool {
    let is_letter = |c: Option<char>| c.is_some_and(|c| LETTERS.contains(c));
    list.iter().filter(|known| known.len() > 1).any(|known| {
        let before = word
            .strip_suffix(known)
            .is_some_and(|rest| rest.len() == 1 && is_letter(rest.chars().next()));
        let behind = word
            .strip_prefix(known)
            .is_some_and(|rest| rest.len() == 1 && is_letter(rest.chars().next()));
        before || behind
    })
}

/// The axis of a name: a letter, a joint's number, or a letter joined to a word that is known.
fn axis(words: &[String]) -> String {
    let letter = |word: &str| word.len() == 1 && LETTERS.contains(word);
    if let Some(at) = words
        .iter()
        .position(|word| AXIS_WORDS.contains(&word.as_str()))
    {
        match words.get(at + 1) {
            Some(name) if letter(name) => return name.clone(),
            Some(number) if number.chars().all(|c| c.is_ascii_digit()) => {
                return format!("{}{number}", words[at]);
            }
            _ => {}
        }
    }
    if let Some(word) = words.iter().find(|word| letter(word)) {
        return word.clone();
    }
    let lists: [&[&str]; 6] = [&COMMANDS, &ACTUALS, &TARGETS, &TORQUES, &POSITIONS, &SPEEDS];
    words
        .iter()
        .filter(|word| {
            lists
                .iter()
                .any(|list| !list.contains(&word.as_str()) && without_axis(word, list))
        })
        .find_map(|word| {
            let ends = [word.chars().next(), word.chars().next_back()];
            let known = |rest: &str| lists.iter().any(|list| list.contains(&rest));
            match ends {
                [Some(first), _] if LETTERS.contains(first) && known(&word[first.len_utf8()..]) => {
                    Some(first.to_string())
                }
                [_, Some(last)] => Some(last.to_string()),
                _ => None,
            }
        })
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_machines_give_are_understood() {
        use Quantity::{Actual, Command, Counter, Other, Position, Time, Torque, Velocity};
        for (name, quantity, axis) in [
            ("t", Time, ""),
            ("Time [s]", Time, ""),
            ("time_ms", Time, ""),
            ("n", Counter, ""),
            ("CYCLE", Counter, ""),
            ("qg", Command, ""),
            ("qm", Actual, ""),
            ("vir", Torque, ""),
            ("x", Position, "x"),
            ("xfb", Actual, "x"),
            ("x.cmd", Command, "x"),
            ("y_act_mm", Actual, "y"),
            ("X1_ActualPosition", Actual, "x"),
            ("X1_CommandPosition", Command, "x"),
            ("X1_ActualVelocity", Velocity, "x"),
            ("X1_CommandVelocity", Other, "x"),
            ("X1_CurrentFeedback", Torque, "x"),
            ("X1_ActualAcceleration", Other, "x"),
            ("X1_DCBusVoltage", Other, "x"),
            ("S1_ActualPosition", Other, "s1"),
            ("DES_POS|1", Command, "1"),
            ("ENC_POS|1", Actual, "1"),
            ("TORQUE|1", Torque, "1"),
            ("TORQUE_FFW|1", Other, "ffw1"),
            ("q2_ref", Command, "q2"),
            ("table desired", Command, "table"),
            ("joint.0.motor-pos-cmd", Command, "joint0"),
            ("joint.0.motor-pos-fb", Actual, "joint0"),
            ("joint.1.f-error", Other, "joint1"),
            ("feedwright.drive-0", Command, "joint0"),
            ("feedwright.actual-2", Actual, "joint2"),
            ("feedwright.correction-1", Other, "joint1"),
            ("x.planned", Position, "x"),
            ("x.driven", Position, "x"),
            ("axis.x.pos-cmd", Command, "x"),
            ("x-pos-fb", Actual, "x"),
            ("pid.x.output", Other, "x"),
            ("Sollwert Z", Command, "z"),
            ("current_position_x", Position, "x"),
            ("posy", Position, "y"),
            ("dtg", Other, "dtg"),
            ("period_clk", Other, "periodclk"),
        ] {
            let found = understand(name);
            assert_eq!(
                (found.quantity, found.axis.as_str()),
                (quantity, axis),
                "{name}: {found:?}"
            );
        }
        assert_eq!(understand("Time [s]").unit, "s");
        assert_eq!(understand("time_ms").unit, "ms");
        assert_eq!(understand("torque (N m)").unit, "N m");
    }

    #[test]
    fn units_are_distinguished_from_what_else_names_have_in_brackets_or_at_their_end() {
        for (name, unit) in [
            ("x(1)", ""),
            ("Position (X)", ""),
            ("pos[joint 1]", ""),
            ("POSF(X)", ""),
            ("x_act (encoder)", ""),
            ("x.cmd [inch]", "inch"),
            ("p1 [mm] (X)", "mm"),
            ("p1(X) [mil]", "mil"),
            ("x.act (cnt)", "cnt"),
            ("x_act_mm", "mm"),
            ("x act um", "um"),
            ("p1_counts", "counts"),
            ("encoder.0.count", "count"),
            ("ActPosCnt", "cnt"),
            ("sample_count", ""),
            ("x_in", "in"),
            ("x_torque [N m]", "N m"),
            ("x_act [\u{b5}m]", "\u{b5}m"),
        ] {
            assert_eq!(understand(name).unit, unit, "{name}");
        }
        let count = understand("sample_count");
        assert_eq!(count.quantity, Quantity::Counter);
        assert_eq!(
            (
                understand("Position (X)").axis.as_str(),
                understand("p1 [mm] (X)").axis.as_str()
            ),
            ("x", "x")
        );
    }

    #[test]
    fn names_that_scopes_give_are_understood() {
        use Quantity::{Actual, Command, Lag, Other, Torque, Velocity};
        for (name, quantity, axis) in [
            ("s nominal X", Command, "x"),
            ("s actual Y [mm]", Actual, "y"),
            ("s dif Z", Lag, "z"),
            ("v act. X", Velocity, "x"),
            ("a actual X", Other, "x"),
            ("i actual X", Torque, "x"),
            ("s actual S1", Other, "s1"),
            ("v act", Velocity, "v"),
            ("POSF X", Actual, "x"),
            ("ERR X", Lag, "x"),
            ("TCMD X", Torque, "x"),
            ("VCMD X", Other, "x"),
            ("MAIN.axisX.NcToPlc.ActPos", Actual, "x"),
            ("Axes.Axis 1.SetPos", Command, "axis1"),
            ("Axes.Axis 1.PosDiff", Lag, "axis1"),
            ("Axes.Axis 1.SetVelo", Other, "axis1"),
            ("Axes.Axis 1.ModuloActPos", Other, "axis1"),
        ] {
            let found = understand(name);
            assert_eq!(
                (found.quantity, found.axis.as_str()),
                (quantity, axis),
                "{name}: {found:?}"
            );
        }
    }
}
