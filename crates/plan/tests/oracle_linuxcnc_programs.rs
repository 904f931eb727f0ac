//! LinuxCNC reads the same programs: the same are refused, and what moves ends at the same points
//! along the same arcs.
//!
//! The numbers come from LinuxCNC itself: `rs274` accepts or refuses, and
//! `oracle_scripts/linuxcnc_canon.py` runs its interpreter in full precision. What the path stage
//! makes of an arc is compared with LinuxCNC's motion, and the points of its chords with our
//! splines. Programs are those in `oracle_data`, of the corpus beside the repository and those that
//! the package installs. Differences that remain are listed in `docs/gcode-differences.md` and in
//! [`DIFFERENCES`].
use std::collections::BTreeMap;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};

use crate::linuxcnc::{Totals, compare, ours, theirs, tool_table};

/// Programs that are read differently on purpose: part of the path, and why.
const DIFFERENCES: &[(&str, &str)] = &[
    ("linuxcnc-nurbs/G6_", "G6.2 came with LinuxCNC 2.10"),
    (
        "camotics/compass.ngc",
        "a % that ends a program without a % at its beginning is a warning",
    ),
    (
        "iniparam-failassign",
        "parameters of an INI file cannot be assigned",
    ),
    ("ncfiles/cone.ngc", "rs274 alone has no axes U V W"),
    ("foam/foam.ngc", "rs274 alone has no axes U V W"),
    ("external_offsets/dyn_demo", "user M-codes need no file"),
    ("external_offsets/eoffsets", "user M-codes need no file"),
    ("external_offsets/jwp_z", "user M-codes need no file"),
    ("external_offsets/opa_demo", "user M-codes need no file"),
    ("geometry/xyzc", "user M-codes need no file"),
    ("macros/m106", "a subroutine without its end is refused"),
    (
        "ncfiles/smartprobe",
        "a dry run of a probe goes all the way",
    ),
    (
        "ncfiles/useful-subroutines",
        "an inner arc of the tool's own radius leaves no path",
    ),
    (
        "oracle_data/g5_2_outside_xy",
        "G5.2 is refused outside the XY plane, as G5 and G5.1 are by both",
    ),
    (
        "g72-missing-iteration",
        "the passes of G72 that LinuxCNC's own expectation has are missing in the packaged 2.9",
    ),
    (
        "ncfiles/lathe_g70_71_demo",
        "G70 with cutter compensation is not read",
    ),
    (
        "turning_incremental",
        "LinuxCNC 2.9 goes to the words of G71 as coordinates in G91, too, then to the start",
    ),
    (
        "turning_ends_below_start",
        "on which side the stock is where a profile ends on the other side than its cycle starts",
    ),
    (
        "turning_collinear",
        "LinuxCNC 2.9 has no distance to two lines that go straight on",
    ),
    (
        "turning_corner_straight_on",
        "LinuxCNC 2.9 has no corner between two lines that go straight on",
    ),
    (
        "turning_narrow_groove",
        "LinuxCNC 2.9 crashes at a groove narrower than D twice",
    ),
    (
        "turning_negative_distance",
        "a negative D would cut into the part",
    ),
    (
        "turning_compensation_inside",
        "codes in a profile that LinuxCNC passes over are refused",
    ),
    (
        "turning_unit_inside",
        "codes in a profile that LinuxCNC passes over are refused",
    ),
    ("turning_empty", "an empty profile is refused"),
    (
        "turning_one_motion",
        "LinuxCNC 2.9 goes on behind a profile of one motion as if it had made that motion",
    ),
    (
        "turning_upward_entry",
        "on which side the stock is where a profile ends on the other side than its cycle starts",
    ),
    (
        "machinist/repeat_behind_do_continue",
        "LinuxCNC 2.9 carries out a repeat twice as often behind a do that was continued",
    ),
    (
        "machinist/do_behind_break",
        "LinuxCNC 2.9 ends a do after one round behind a while that was left by break",
    ),
    (
        "machinist/break_in_repeat",
        "LinuxCNC 2.9 finds no label of a repeat to break",
    ),
    ("machinist/scaling_off", "G50 alone is left out"),
    (
        "machinist/rotation_under_g92",
        "LinuxCNC 2.9 forgets G92 when the rotation of the active system changes",
    ),
    (
        "machinist/cycle_across_units",
        "LinuxCNC 2.9 keeps the number and not the height at which cycles began when the unit changes",
    ),
    (
        "machinist/call_above_definition",
        "a definition below its call is stepped over",
    ),
    (
        "machinist/plane_of_uvw",
        "planes of U, V and W are not read",
    ),
    (
        "g84__g18__g99",
        "LinuxCNC 2.9 swaps the axes of G84 outside G17",
    ),
    (
        "g84__g19__g99",
        "LinuxCNC 2.9 swaps the axes of G84 outside G17",
    ),
];

fn programs_below(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    let mut entries: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .collect();
    entries.sort();
    for path in entries {
        if path.is_dir() && !path.is_symlink() {
            programs_below(&path, found);
        } else if let Some(extension) = path.extension() {
            let extension = extension.to_string_lossy().to_ascii_lowercase();
            if ["ngc", "nc", "gcode"].contains(&extension.as_str()) && path.is_file() {
                found.push(path);
            }
        }
    }
}

fn programs() -> Vec<PathBuf> {
    let mut found = Vec::new();
    programs_below(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/oracle_data"),
        &mut found,
    );
    programs_below(
        &Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/corpus/gcode"),
        &mut found,
    );
    let mut installed = vec!["/usr/share/linuxcnc/ncfiles", "/usr/share/axis"];
    // The samples of single configurations take most of the time; they run on request.
    if std::env::var("FEEDWRIGHT_ORACLE_ALL").is_ok() {
        installed.push("/usr/share/doc/linuxcnc/examples");
    }
    for folder in installed {
        programs_below(Path::new(folder), &mut found);
    }
    if let Ok(only) = std::env::var("FEEDWRIGHT_ORACLE_ONLY") {
        found.retain(|path| path.to_string_lossy().contains(&only));
    }
    found
}

/// Programs that LinuxCNC 2.9 never finishes: part of the path, and why. The test does not run
/// `rs274` on them; this reader must refuse them.
const ENDLESS: &[(&str, &str)] = &[(
    "g71-endless-loop_2",
    "LinuxCNC 2.9 repeats the pass of a pocket forever",
)];

/// Limits of `rs274` for a program, s, one attempt after the other: the longest program takes 2 s
/// on a busy machine.
const LIMITS_S: [u32; 3] = [10, 60, 300];
/// Exit codes of `timeout` where it has ended the program: by the first signal, and by one that
/// cannot be ignored.
const ENDED_BY_TIMEOUT: [i32; 2] = [124, 137];
/// Largest number of attempts at a program that crashes `rs274`.
const CRASHES: usize = 3;

/// Answer of `rs274` to a program.
#[derive(Debug, PartialEq)]
enum Answer {
    Accepts,
    /// Refusal, with its message. A crash counts as a refusal.
    Refuses(String),
    /// It did not come to its end within the last of [`LIMITS_S`]. That says nothing about the
    /// program.
    Silent,
}

/// Judges the outcome of an attempt; none if the program has to be tried again with more time.
fn answer(status: ExitStatus, stderr: &[u8]) -> Option<Answer> {
    if status.success() {
        return Some(Answer::Accepts);
    }
    if status
        .code()
        .is_some_and(|code| ENDED_BY_TIMEOUT.contains(&code))
    {
        return None;
    }
    let text = String::from_utf8_lossy(stderr).into_owned() + &format!(" [{status}]");
    // Our reader only warns about a missing end.
    let is_fine = text.contains("File ended with no percent sign");
    Some(if is_fine {
        Answer::Accepts
    } else {
        Answer::Refuses(text.replace('\n', " | "))
    })
}

/// Asks `rs274` about a program. One at a time: its processes share a tool table in memory.
fn ask(path: &Path, tools: &Path) -> Answer {
    let attempt = |limit_s: u32| {
        let mut command = Command::new("timeout");
        command
            .arg("--kill-after=5")
            .arg(limit_s.to_string())
            .args(["rs274", "-g", "-t"])
            .arg(tools)
            .arg(path);
        command
            .current_dir(path.parent().unwrap())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .output()
            .unwrap()
    };
    let mut crashes = 0;
    for limit_s in LIMITS_S {
        loop {
            let output = attempt(limit_s);
            crashes += usize::from(output.status.signal().is_some());
            if output.status.signal().is_some() && crashes < CRASHES {
                continue;
            }
            match answer(output.status, &output.stderr) {
                Some(answer) => return answer,
                None => break,
            }
        }
        eprintln!(
            "{}: rs274 gave no answer within {limit_s} s",
            path.display()
        );
    }
    Answer::Silent
}

#[test]
fn a_program_that_a_timeout_ended_has_no_answer() {
    let exited = |code: i32| ExitStatus::from_raw(code << 8);
    let executing = b"executing\n";
    assert_eq!(answer(exited(0), executing), Some(Answer::Accepts));
    for code in ENDED_BY_TIMEOUT {
        assert_eq!(answer(exited(code), executing), None);
    }
    let crashed = ExitStatus::from_raw(11);
    for status in [exited(1), crashed] {
        assert!(
            matches!(answer(status, b"Bad number\n"), Some(Answer::Refuses(text)) if text.starts_with("Bad number | "))
        );
    }
    assert_eq!(
        answer(exited(1), b"File ended with no percent sign"),
        Some(Answer::Accepts)
    );
}

#[test]
fn linuxcnc_reads_the_same() {
    if !crate::rs274::is_installed() {
        return;
    }
    let is_endless = |path: &PathBuf| {
        ENDLESS
            .iter()
            .any(|row| path.display().to_string().contains(row.0))
    };
    let (endless, paths): (Vec<_>, Vec<_>) = programs().into_iter().partition(is_endless);
    assert!(!paths.is_empty(), "no programs to compare");
    let tools = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(tools.path(), tool_table()).unwrap();
    let theirs = theirs(&paths);
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let accepted = endless.iter().filter(|path| ours(path).1.is_none());
    let mut failures: Vec<String> = accepted
        .map(|path| format!("{}: accepted, and LinuxCNC never ends", path.display()))
        .collect();
    let mut totals = Totals::default();
    for (path, theirs) in paths.iter().zip(&theirs) {
        let shown = path.display();
        let known = DIFFERENCES
            .iter()
            .find(|row| shown.to_string().contains(row.0));
        let refused = match ask(path, tools.path()) {
            Answer::Accepts => None,
            Answer::Refuses(text) => Some(text),
            Answer::Silent => {
                failures.push(format!(
                    "{shown}: rs274 gave no answer within {LIMITS_S:?} s; an endless program belongs in ENDLESS"
                ));
                continue;
            }
        };
        let (motions, fault) = ours(path);
        let failure = match (&refused, &fault) {
            (Some(_), Some(_)) => {
                *counts.entry("both refuse").or_default() += 1;
                None
            }
            (None, Some(fault)) => Some(format!("only we refuse: {fault}")),
            (Some(refused), None) => Some(format!("only they refuse: {refused}")),
            (None, None) if !theirs.complete || theirs.refused.is_some() => {
                *counts.entry("both accept, motions unknown").or_default() += 1;
                if std::env::var("FEEDWRIGHT_ORACLE_VERBOSE").is_ok() {
                    eprintln!("unknown: {shown}: {:?}", theirs.refused);
                }
                None
            }
            (None, None) => {
                *counts.entry("both accept, motions compared").or_default() += 1;
                compare(
                    &String::from_utf8_lossy(&std::fs::read(path).unwrap()),
                    &motions,
                    theirs,
                    &mut totals,
                )
            }
        };
        match (failure, known) {
            (Some(failure), None) => failures.push(format!("{shown}: {failure}")),
            (None, Some(_)) => failures.push(format!(
                "{shown}: listed as a difference, but nothing differs"
            )),
            (Some(_), Some(_)) => *counts.entry("known differences").or_default() += 1,
            (None, None) => {}
        }
    }
    eprintln!("{counts:?}; {totals:?}");
    assert!(
        failures.is_empty(),
        "{} differences:\n{}",
        failures.len(),
        failures.join("\n")
    );
}
