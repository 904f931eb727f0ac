//! Macros of Fanuc and Haas: variables, branches, loops, calls, and what bounds them.

use feedwright_gcode::canon::{Canon, EventKind};
use feedwright_gcode::{CheckError, Dialect, Reader, Settings, summarize};

fn reader(lines: &str, settings: Settings) -> Reader {
    let settings = Settings {
        dialect: Some(Dialect::FanucMill),
        ..settings
    };
    Reader::from_text(
        "part.nc",
        format!("O0001\nG21 G90 G17 F100\n{lines}\n"),
        settings,
    )
    .expect("it is a program")
}

fn steps(lines: &str) -> Vec<Canon> {
    let unwrap = |step: Result<Canon, _>| step.unwrap_or_else(|fault| panic!("{lines}: {fault:?}"));
    reader(lines, Settings::default()).map(unwrap).collect()
}

/// X of the ends of all motions.
fn xs(lines: &str) -> Vec<f64> {
    let end = |step| {
        if let Canon::Motion(motion) = step {
            Some(motion.end_mm[0])
        } else {
            None
        }
    };
    steps(lines).into_iter().filter_map(end).collect()
}

fn faults(lines: &str, settings: Settings) -> Vec<String> {
    match summarize(reader(lines, settings)) {
        Err(CheckError::Faults(faults)) => faults
            .into_iter()
            .map(|fault| {
                format!(
                    "{}: {} hint: {}",
                    fault.line,
                    fault.message,
                    fault.hint.unwrap_or_default()
                )
            })
            .collect(),
        other => panic!("{lines:?} gave {other:?}"),
    }
}

#[test]
fn loops_and_branches() {
    assert_eq!(
        xs("#1=0\nWHILE [#1 LT 3] DO1\n#1=#1+1\nG1 X#1\nEND1\nM30"),
        [1.0, 2.0, 3.0]
    );
    assert_eq!(
        xs("#1=5\nWHILE[#1LT3]DO1\nG1 X#1\nEND1\nG1 X9.\nM30"),
        [9.0]
    );
    let nested = "#1=1\nWHILE [#1 LE 2] DO1\n#2=1\nWHILE [#2 LE 2] DO2\nG1 X[#1*10+#2]\n#2=#2+1\nEND2\n#1=#1+1\nEND1\nM30";
    assert_eq!(xs(nested), [11.0, 12.0, 21.0, 22.0]);
    assert_eq!(
        xs("#1=1\nN10 G1 X#1\n#1=#1+1\nIF [#1 LE 3] GOTO 10\nM30"),
        [1.0, 2.0, 3.0]
    );
    assert_eq!(xs("GOTO 20\nG1 X1.\nN20 G1 X2.\nM30"), [2.0]);
    assert_eq!(xs("#5=30\nGOTO#5\nG1 X1.\nN30 G1 X3.\nM30"), [3.0]);
    assert_eq!(
        xs("#1=7\nIF [#1 EQ 7] THEN #1=8\nIF [#1 EQ 7] THEN #1=9\nG1 X#1\nM30"),
        [8.0]
    );
    // A loop that is left by a jump begins anew.
    let left = "#2=0\nN5 #1=0\nWHILE [1 EQ 1] DO1\n#1=#1+1\nIF [#1 GT 2] GOTO 8\nEND1\nN8 G1 X[#1+#2*10]\n#2=#2+1\nIF [#2 LT 2] GOTO 5\nM30";
    assert_eq!(xs(left), [3.0, 13.0]);
    // The next block with the number counts, then the first of the program; those of other programs
    // do not.
    assert_eq!(
        xs(
            "#1=0\nN1 #1=#1+1\nG1 X#1\nIF [#1 LT 2] GOTO 1\nM98 P2\nM30\nO0002\nGOTO 1\nG1 X50.\nN1 G1 X60.\nM99"
        ),
        [1.0, 2.0, 60.0]
    );
}

#[test]
fn values_are_those_of_macros() {
    assert_eq!(xs("#1=2+3*4-[1+1]\nG1 X#1\nM30"), [12.0]);
    assert_eq!(xs("#1=ATAN[1]/[1]\n#2=ATAN[1]\nG1 X[#1+#2]\nM30"), [90.0]);
    assert_eq!(
        xs("#1=6 AND 3\n#2=6 OR 3\n#3=6 XOR 3\nG1 X[#1*100+#2*10+#3]\nM30"),
        [275.0]
    );
    assert_eq!(
        xs("#1=10\n#[#1+1]=5.5\nG1 X#11\nG1 X-#11\nM30"),
        [5.5, -5.5]
    );
    assert_eq!(
        xs("IF [[#1 EQ #0] AND [#2 EQ #0]] GOTO 5\nG1 X1.\nN5 G1 X2.\nM30"),
        [2.0]
    );
    // A vacant variable is not 0, but counts so; a word with it is left out.
    assert_eq!(
        xs("#1=0\nIF [#1 EQ #0] GOTO 5\nG1 X1.\nN5 G1 X[#9+2]\nG1 X#9 Y5.\nM30"),
        [1.0, 2.0, 2.0]
    );
    assert_eq!(
        xs("#1=0.00005\nIF [#1 EQ 0] GOTO 5\nG1 X1.\nN5 G1 X2.\nM30"),
        [1.0, 2.0]
    );
    assert_eq!(
        xs("G1 X5.\nG1 X[#5001+1]\nG91 G1 X[#4003]\nM30"),
        [5.0, 6.0, 96.0]
    );
}

#[test]
fn macros_have_variables_of_their_own() {
    let text = "#1=70\n#33=71\nG65 P9000 A1. B2. X3. L2\nG1 X#1\nG1 X#33\nG1 X#100\nM30\n\
                O9000\n#1=#1+#2*10+#24*100\n#33=5\nG1 X#1\n#100=#3\nIF [#3 NE #0] GOTO 9\n#100=42\nN9 M99";
    assert_eq!(xs(text), [321.0, 70.0, 71.0, 42.0]);
    assert_eq!(
        xs("G65 P9000 F5. S6. T7. D8.\nM30\nO9000\nG1 X[#9*1000+#19*100+#20*10+#7]\nM99"),
        [5678.0]
    );
    // M98 shares them.
    assert_eq!(xs("#1=3\nM98 P9000\nG1 X#1\nM30\nO9000\n#1=4\nM99"), [4.0]);
}

#[test]
fn what_a_macro_says_is_kept() {
    let reported = steps("DPRNT[X#1[53]]\nPOPEN\nG1 X1.\nM30")
        .into_iter()
        .filter(|step| matches!(step, Canon::Event(event) if matches!(event.kind, EventKind::Message { .. })));
    assert_eq!(reported.count(), 2);
    let alarm = faults(
        "G1 X1.\nIF [1 EQ 1] THEN #3000=5 (NO ARGUMENT)\nM30",
        Settings::default(),
    );
    assert!(
        alarm[0].starts_with("4: the program stops here with alarm 5"),
        "{alarm:?}"
    );
}

#[test]
fn a_macro_that_never_ends_is_bounded() {
    let few = || Settings {
        max_idle_lines: 1000,
        max_motions: 1000,
        ..Settings::default()
    };
    for lines in [
        "N10 GOTO 10\nM30",
        "WHILE [1 EQ 1] DO1\nEND1\nM30",
        "DO1\n#1=1\nEND1\nM30",
        "N1 #1=#1+1\nIF [1 EQ 1] GOTO 1\nM30",
    ] {
        let found = faults(&format!("G1 X1.\n{lines}"), few());
        assert!(
            found[0].contains("endless loop: 1000 lines"),
            "{lines}: {found:?}"
        );
    }
    let moving = faults("N1 G91 G1 X1.\nGOTO 1\nM30", few());
    assert!(moving[0].contains("more than 1000 motions"), "{moving:?}");
    let deep = faults("M98 P1\nM30\nO0002\nG65 P2\nM99", few());
    assert!(!deep.is_empty());
    let itself = faults("G1 X1.\nG65 P2\nM30\nO0002\nG65 P2\nM99", few());
    assert!(
        itself[0].contains("100 subroutine calls inside each other"),
        "{itself:?}"
    );
}

#[test]
fn mistakes_in_macros_have_a_place_and_a_hint() {
    for (lines, says) in [
        ("GOTO 77", "3: GOTO 77: there is no block N77"),
        ("GOTO #9", "a variable without a value"),
        ("WHILE [1 EQ 1]", "DO is missing behind WHILE"),
        ("IF [1 EQ 1] G1 X5.", "neither GOTO nor THEN"),
        ("WHILE [1 EQ 1] DO7\nEND7", "a loop DO7 does not exist"),
        ("WHILE [0 EQ 1] DO1\nG1 X5.", "DO1 has no END1"),
        ("END1", "no loop"),
        ("G65 A1.", "P with its number is missing"),
        ("G65 P9000 A1.", "O9000 is defined nowhere"),
        ("#1=#2001", "#2001 is one of the control"),
        ("G1 X#9000", "parameter #9000 does not exist"),
        ("GOTO 5 X5\nN5", "nothing but a comment"),
    ] {
        let found = faults(&format!("{lines}\nG1 X1.\nM30"), Settings::default());
        assert!(found[0].contains(says), "{lines}: {found:?}");
    }
}
