//! Every row of the list of intended differences (`examples/gcode_compare/listed.rs`) names the
//! difference of a program that has it, and no other: the same program with the difference
//! elsewhere is not listed.
use std::path::PathBuf;

use crate::linuxcnc::{Totals, theirs};
use crate::listed::{Verdict, judge};

const START: &str = "G21 G17 G90 G40 G49 G80 G94 F600 S500 M3\n";
const PROFILE: &str =
    "G18 G8\no1 sub\nG0 X10\nG1 Z-5\nX14 Z-9\nZ-14\nX20 Z-18\nX32\no1 endsub\nG0 X40 Z5\n";

/// A program for each row, without its first and its last line.
#[expect(clippy::too_many_lines, reason = "a table")]
fn examples() -> Vec<(&'static str, String)> {
    let plain = [
        (
            "M-codes on one line that LinuxCNC counts to one group",
            "M7 M8\nG0 X1\n",
        ),
        (
            "M-codes on one line that LinuxCNC counts to one group",
            "M70 M4\nG0 X1\n",
        ),
        (
            "M-codes on one line that LinuxCNC counts to one group",
            "M48 M51 P0\nG0 X1\n",
        ),
        (
            "M-codes on one line that LinuxCNC counts to one group",
            "M5 M19 R90\nG0 X1\n",
        ),
        ("L with G74", "M4\nG99 G74 X1 Y1 Z-2 R2 P0 L2\n"),
        (
            "an inner corner where LinuxCNC cuts into the contour",
            "G0 X40 Y0\nG41.1 D10 G1 X79 Y-12.3\nG1 X85.7998 Y-32.2143\nG1 X96.0144 Y-62.0598\nG1 X99.5793 Y-59.3447\n\
             G3 X103.4502 Y-42.2548 I-8.2682 J10.8561\nG40 G1 X101.5 Y5.2\n",
        ),
        (
            "an entry into compensation that meets the contour beyond its first motion",
            "G0 X-40 Y-24.5617\nG42.1 D20 G1 X0 Y0\nG1 X3.5585 Y-7.7160\nG1 X9.7281 Y-21.0935\nG40 G1 X9 Y-60\n",
        ),
        (
            "a flat corner of compensation that LinuxCNC refuses by rounding",
            "G0 X-40 Y2.6581\nG41.1 D20 G1 X0 Y0\nG1 X14.1655 Y1.8756\nG3 X28.3631 Y16.2315 I-1.5901 J15.7710\n\
             G40 G1 X-3.2320 Y40.7620\n",
        ),
        (
            "an arc with R to the place where it is, but for rounding",
            "G0 X.3 Y1\nG3 X[.1+.2] Y1 R5\n",
        ),
        (
            "MOD of a multiple, by rounding",
            "#20 = [asin[0.5] mod 0.1]\nG1 X[#20 + 1]\n",
        ),
        (
            "G76 outside G18",
            "G0 X20 Z5\nG76 P1.5 Z-20 I-2 J0.4 K1.2\n",
        ),
        (
            "a curve begun by G5.2 and left without G5.3",
            "G5.2 X1 Y2 P1 L3\nX3 Y-4 P1\nX5 Y6 P1\nX7 Y8 P2\n",
        ),
        (
            "G5.2 and G5.3 outside G17",
            "G18\nG5.2 X1 Y2 P1 L3\nX3 Y-4 P1\nX5 Y6 P1\nX7 Y8 P2\nG5.3\n",
        ),
        (
            "G5.2 without P",
            "G5.2 X1 Y2 L3\nX3 Y-4 P1\nX5 Y6 P1\nX7 Y8 P2\nG5.3\n",
        ),
        (
            "G28, G30, G43.1, G49 and G53 under G43.1 in another unit",
            "G43.1 X-7.9\nG1 X2\nG20\nG28\nG0 X1\n",
        ),
        (
            "G28, G30, G43.1, G49 and G53 under G43.1 in another unit",
            "G43.1 X-7\nG1 X2\nG20\nG53 G0 X-3\nG0 Y1\n",
        ),
        (
            "G28, G30, G43.1, G49 and G53 under G43.1 in another unit",
            "G43.1 Y7.3\nG1 X2\nG20\nG43.1 Y2.986\nG1 X-3\n",
        ),
        ("G94 where it is active already", "G94\nG1 X1\n"),
        ("P twice on a line of G5", "G5 X1 Y2 I1 J1 P-1 Q2 P-1\n"),
        (
            "the value of a subroutine that is only defined",
            "G0 X1\no1 sub\nG0 X1\no1 endsub [5]\nG1 X#<_value>\n",
        ),
        (
            "rotation of the active system under G92",
            "G0 X5\nG92 X1\nG10 L2 P1 R30\nG0 X3\nG0 X4 Y1\n",
        ),
        (
            "axis words alone behind G5 and G5.1",
            "G1 Z0.5\nG5.1 X6 Y-4 I3 J4\nZ-1\n",
        ),
        (
            "L with G41.1 and G42.1",
            "G0 X-40\nG41.1 D2 L3 G1 X0 Y0\nG1 X20\nG40 G1 X30\n",
        ),
        ("I and J with G10 L2", "G10 L2 P1 X1 I2 J1\nG0 X1\n"),
        (
            "a comment that is open in a line that is not carried out",
            "o1 if [0]\nG1 X1 (open\no1 endif\nG0 X1\n",
        ),
        ("M67 and M68 without Q", "M67 E1\nG0 X1\n"),
        (
            "words behind an elseif that is not carried out",
            "o1 if [1]\nG1 X1\no1 elseif [#1 gt 0] G1\nG1 X2\no1 endif\n",
        ),
        (
            "G84 and G74 outside G17",
            "G18\nM3\nG99 G84 X1 Z1 Y-2 R2 P0\n",
        ),
        (
            "points of splines where LinuxCNC's preview has not noticed Z of an arc",
            "G2 X2 Y0 I1 J0 Z3\nG5 X9 Y12 I1 J1 P-1 Q2\n",
        ),
        (
            "break and continue in a repeat",
            "o1 repeat [2]\nG0 X1\no1 break\no1 endrepeat\n",
        ),
        (
            "a do behind a while that was left by break",
            "#2 = 0\no1 while [1]\no1 break\no1 endwhile\no3 do\n#2 = [#2 + 1]\nG1 Y#2\no3 while [#2 lt 3]\nG1 Z1\n",
        ),
        (
            "a do behind a while that was left by break",
            "#1 = 0\no1 while [#1 lt 2]\n#1 = [#1 + 1]\no2 if [#1 gt 5]\no1 break\no2 endif\no1 endwhile\n#2 = 0\no3 do\n\
             #2 = [#2 + 1]\nG1 Y#2\no3 while [#2 lt 3]\nG1 Z1\n",
        ),
        (
            "a later round of a do behind a break",
            "#2 = 0\no3 do\n#2 = [#2 + 1]\nG3 X18 Y-18 R30\no1 while [1]\no1 break\no1 endwhile\no3 while [#2 lt 2]\nG1 Z1\n",
        ),
        (
            "a repeat or a break behind a do that was continued",
            "#7 = 0\no1 do\n#7 = [#7 + 1]\no2 if [#7 lt 2]\no1 continue\no2 endif\no1 while [#7 lt 3]\nG91\n\
             o3 repeat [2]\nG1 X1\no3 endrepeat\nG1 Y1\n",
        ),
        (
            "a repeat or a break behind a do that was continued",
            "#7 = 0\no1 do\n#7 = [#7 + 1]\no1 continue\no1 while [#7 lt 3]\n#2 = 0\no3 while [#2 lt 4]\n#2 = [#2 + 1]\nG1 Y#2\n\
             o3 break\no3 endwhile\n",
        ),
        ("G50 without words", "G50\nG0 X1\n"),
        (
            "an O-word without its keyword in a subroutine",
            "o1 sub\nG0 X1\no1\no1 endsub\no1 call\n",
        ),
    ];
    let mut examples: Vec<(&str, String)> = plain
        .iter()
        .map(|(what, program)| (*what, format!("{START}{program}M2\n")))
        .collect();
    let profiles = [
        (
            "codes in the profile of a lathe cycle",
            "G1 Z-5",
            "G1 Z-5\nG42.1 D1",
        ),
        (
            "codes in the profile of a lathe cycle",
            "G1 Z-5",
            "G1 Z-5\nG91",
        ),
        (
            "an empty profile of a lathe cycle",
            "G0 X10\nG1 Z-5\nX14 Z-9\nZ-14\nX20 Z-18\nX32\n",
            "",
        ),
        (
            "the side of D where a profile begins as deep as its cycle starts",
            "G0 X10\n",
            "",
        ),
        (
            "lines of a profile that go straight on",
            "Z-14\n",
            "Z-10\nZ-14\n",
        ),
    ];
    for (what, from, to) in profiles {
        examples.push((
            what,
            format!(
                "{START}{}G71 Q1 X32 Z2 D0.3 I1 R0.5\nM2\n",
                PROFILE.replace(from, to)
            ),
        ));
    }
    let without_end = format!("{START}M98 P9000 L1\nG0 X1\nM2\nO9000\nG1 X1 Y2\n");
    examples.push((
        "words behind M98 on its line",
        without_end.replace(" L1", " G0 X3") + "M99\n",
    ));
    examples.push(("a subroutine without its M99", without_end));
    examples
}

#[test]
fn every_row_has_a_program() {
    if !crate::rs274::is_installed() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let examples = examples();
    let mut paths: Vec<PathBuf> = Vec::new();
    for (number, (_, text)) in examples.iter().enumerate() {
        paths.push(folder.path().join(format!("program_{number}.ngc")));
        std::fs::write(&paths[number], text).unwrap();
    }
    let mut failures = Vec::new();
    let mut totals = Totals::default();
    for (((what, text), path), theirs) in examples.iter().zip(&paths).zip(theirs(&paths)) {
        match judge(path, text, &theirs, &mut totals) {
            Verdict::Differ(difference) => {
                let found = crate::listed::find(text, &theirs, &difference);
                if found != Some(what) {
                    failures.push(format!("{what}: {found:?} for {difference}\n{text}"));
                }
            }
            Verdict::Unknown => failures.push(format!("{what}: LinuxCNC crashed\n{text}")),
            Verdict::BothRefuse => {
                failures.push(format!("{what}: both refuse: {:?}\n{text}", theirs.refused));
            }
            Verdict::Same => failures.push(format!("{what}: no difference\n{text}")),
        }
    }
    let missing: Vec<&str> = crate::listed::names()
        .filter(|name| !examples.iter().any(|(what, _)| what == name))
        .collect();
    assert!(
        failures.is_empty() && missing.is_empty(),
        "rows without a program: {missing:?}\n{}",
        failures.join("\n")
    );
}
