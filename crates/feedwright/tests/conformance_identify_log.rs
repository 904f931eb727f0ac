//! `identify LOG`: a log in, a machine file, numbers and a page out; several logs, a machine file
//! that is updated; and what is refused leaves nothing behind.

use std::fmt::Write as _;

use crate::command::Folder;
use crate::identification_log::log_of;
use feedwright_sim::Machine;

/// Time of a log, s.
const TIME_S: f64 = 4.0;

/// Rows of a log of tnv40: time, command and actual position of x.
pub(crate) fn rows(seed: u64) -> Vec<[f64; 3]> {
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    let log = log_of(&machine, TIME_S, 1.0, seed);
    let axis = &log.axes[0];
    (0..log.time_s.len())
        .map(|k| [log.time_s[k], axis.command_mm[k], axis.actual_mm[k]])
        .collect()
}

pub(crate) fn text(head: &str, rows: impl IntoIterator<Item = [f64; 3]>) -> String {
    rows.into_iter()
        .fold(format!("{head}\n"), |mut text, [t, command, actual]| {
            writeln!(text, "{t:.4},{command:.6},{actual:.6}").unwrap();
            text
        })
}

pub(crate) const HEAD: &str = "t,x.cmd,x.act";

#[test]
fn logs_become_a_machine_file_numbers_and_a_page() {
    let folder = Folder::new();
    folder.file("a.csv", text(HEAD, rows(1)));
    folder.file("b.csv", text(HEAD, rows(2)));
    let command = [
        "identify",
        "a.csv",
        "b.csv",
        "--out",
        "mine.toml",
        "--json",
        "i.json",
        "--report",
        "i.html",
    ];
    let ran = folder.run(&command).succeeded();
    assert!(
        ran.stdout.contains("axis x:")
            && ran
                .stdout
                .ends_with("wrote mine.toml\nwrote i.json\nwrote i.html\n"),
        "{}",
        ran.stdout
    );
    assert!(
        ran.stderr.contains("b.csv is joined at 4 s"),
        "{}",
        ran.stderr
    );
    let json: serde_json::Value = serde_json::from_slice(&folder.read("i.json")).unwrap();
    assert_eq!(
        (json["log"].as_str(), json["samples"].as_u64()),
        (Some("a.csv, b.csv"), Some(8000))
    );
    // 50 1/s, 2 N m s/rad, 0.0103 kg m2.
    let product = json["axes"]["x"]["parameters"]["kp_kv_over_j_1_s2"]["value"]
        .as_f64()
        .unwrap();
    assert!((product / 9708.7 - 1.0).abs() < 0.03, "{product}");
    assert!(folder.text("i.html").contains("</html>"));
    folder
        .run_uncorrected(&[
            "circle.ngc",
            "--machine",
            "mine.toml",
            "--tolerance",
            "1000",
        ])
        .succeeded();
}

#[test]
fn an_update_keeps_what_the_log_does_not_determine() {
    let folder = Folder::new();
    folder.file("a.csv", text(HEAD, rows(3)));
    let before = "base = \"tnv40\"\nname = \"mine\"\n\n[axis.x]\nkp_1_s = 80 # a guess\ntorque_limit_nm = 17 # as on its plate\n\n[axis.y]\nkp_1_s = 44\n";
    folder.file("mine.toml", before);
    folder
        .run(&["identify", "a.csv", "--update", "mine.toml"])
        .succeeded();
    let mine = Machine::load(folder.path().join("mine.toml").as_os_str()).unwrap();
    let x = mine.axes[0];
    assert!((x.kp_1_s / 50.0 - 1.0).abs() < 0.03, "{}", x.kp_1_s);
    assert!(
        (x.kv_nm_s_per_rad / 2.0 - 1.0).abs() < 0.03,
        "{}",
        x.kv_nm_s_per_rad
    );
    assert_eq!(
        (x.torque_limit_nm, x.inertia_kg_m2, mine.axes[1].kp_1_s),
        (17.0, 0.0103, 44.0)
    );
    let text = folder.text("mine.toml");
    assert!(
        text.contains("torque_limit_nm = 17 # as on its plate") && !text.contains("a guess"),
        "{text}"
    );
}

/// A row as it is not.
type Spoil = fn(usize, [f64; 3]) -> [f64; 3];

#[test]
fn what_is_no_log_of_a_servo_is_refused_and_leaves_nothing() {
    let three_digits = |value: f64| format!("{value:.2e}").parse().unwrap_or(value);
    let spoils: [(&str, Spoil, &[&str]); 6] = [
        (
            "slow.csv",
            |k, [_, c, a]| [0.1 * k as f64, c, a],
            &["every 100 ms (10 Hz)", "servo period"],
        ),
        (
            "still.csv",
            |_, [t, c, _]| [t, c, 12.5],
            &["is not connected", "stays at 12.5 mm"],
        ),
        ("copy.csv", |_, [t, c, _]| [t, c, c], &["is not connected"]),
        (
            "nan.csv",
            |k, [t, c, a]| [t, c, if k == 700 { f64::NAN } else { a }],
            &["line 702"],
        ),
        (
            "back.csv",
            |k, [t, c, a]| [if k == 900 { t - 0.5 } else { t }, c, a],
            &["backward"],
        ),
        ("swapped.csv", |_, [t, c, a]| [t, a, c], &["swapped"]),
    ];
    let folder = Folder::new();
    let rows = rows(4);
    for (name, spoil, _) in spoils {
        folder.file(
            name,
            text(HEAD, rows.iter().enumerate().map(|(k, row)| spoil(k, *row))),
        );
    }
    let coarse = rows
        .iter()
        .map(|[t, c, a]| [*t, three_digits(100.0 + c), three_digits(100.0 + a)]);
    folder.file("coarse.csv", text(HEAD, coarse));
    folder.file("good.csv", text(HEAD, rows.iter().copied()));
    folder.file("y.csv", text("t,y.cmd,y.act", rows.iter().copied()));
    let before = folder.content();
    let refused = |arguments: &[&str], says: &[&str]| {
        let outputs = [
            "--out",
            "mine.toml",
            "--json",
            "i.json",
            "--report",
            "i.html",
        ];
        folder
            .run(&[&["identify"], arguments, &outputs].concat())
            .refused(says);
        assert_eq!(folder.content(), before, "{arguments:?}");
    };
    for (name, _, says) in spoils {
        refused(&[name], says);
    }
    refused(&["coarse.csv"], &["digits"]);
    refused(&["good.csv", "--columns", "x.cmd=1,x.act=7"], &["column"]);
    refused(
        &["good.csv", "--fit", "100:200", "--score", "0:2"],
        &["--fit has 0 samples", "0.000 to 3.999 s"],
    );
    refused(
        &["good.csv", "y.csv"],
        &["the axes are y here, and x in good.csv"],
    );
    refused(&["good.csv", "--update", "none.toml"], &["none.toml"]);
    refused(&["gone.csv"], &["cannot read log gone.csv"]);
}
