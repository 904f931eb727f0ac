//! `correct --log`: programs that learn from the parts that were cut, and logs without information.

use std::fmt::Write as _;

use crate::command::{Folder, Ran};
use serde_json::Value;

/// The machine that cuts is tnv40. Its file has a position gain of y, an inertia and a speed-loop
/// gain that are not so.
const FILE: &str = "base = \"tnv40\"\nname = \"misjudged\"\ndescription = \"tnv40 with wrong values\"\nsource = \"a test\"\n\
                    [axis.x]\ninertia_kg_m2 = 0.0124\n[axis.y]\nkp_1_s = 44\nkv_nm_s_per_rad = 1.7\n";

/// Two turns.
const PART: &str = "G21 G17 G90 G94 G64\nG0 X0 Y0\nG2 X0 Y0 I5 J0 F1800\nG2 X0 Y0 I5 J0\nM2\n";

/// Samples of a log: time, s, and command and position of x and y, mm.
type Samples = Vec<[f64; 5]>;

/// The cut of a program by tnv40, beside `circle.ngc`: RMS at the encoders, um, and its samples.
fn cut(folder: &Folder, program: &str) -> (f64, Samples) {
    let arguments = [
        program,
        "--machine",
        "tnv40",
        "--reference",
        "circle.ngc",
        "--trace",
        "t.csv",
        "--json",
        "r.json",
    ];
    folder.run_uncorrected(&arguments).succeeded();
    let results: Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
    let text = folder.text("t.csv");
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let at = |name: &str| head.iter().position(|column| *column == name).unwrap();
    let columns = ["t_s", "cmd_x_mm", "act_x_mm", "cmd_y_mm", "act_y_mm"].map(at);
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        columns.map(|column| cells[column].parse().unwrap())
    };
    (
        results["runs"][0]["rms_um"].as_f64().unwrap(),
        lines.map(row).collect(),
    )
}

fn write(folder: &Folder, name: &str, samples: &[[f64; 5]]) {
    let mut text = "t_s,x.cmd,x.act,y.cmd,y.act\n".to_owned();
    for [t_s, x, x_act, y, y_act] in samples {
        writeln!(text, "{t_s:.6},{x:.6},{x_act:.6},{y:.6},{y_act:.6}").unwrap();
    }
    folder.file(name, text);
}

fn correct(folder: &Folder, logs: &[&str], out: &str) -> (Ran, Option<Value>) {
    let logs = logs.iter().flat_map(|log| ["--log", log]);
    let all = [
        "correct",
        "circle.ngc",
        "--machine",
        "file.toml",
        "--out",
        out,
        "--json",
        "p.json",
    ]
    .into_iter()
    .chain(logs);
    let ran = folder.run(&all.collect::<Vec<_>>());
    let results = folder
        .path()
        .join("p.json")
        .exists()
        .then(|| serde_json::from_slice(&folder.read("p.json")).unwrap());
    (ran, results)
}

#[test]
fn a_program_learns_from_the_log_of_the_original_and_a_good_one_is_kept() {
    let folder = Folder::new();
    folder.file("file.toml", FILE);
    folder.file("circle.ngc", PART);
    let (original_um, mut samples) = cut(&folder, "circle.ngc");
    // A recorder starts before the program, and loses a sample.
    let wait = (0..80).map(|k| [f64::from(k) * 1e-3 - 0.08, 0.0, 0.0, 0.0, 0.0]);
    samples.splice(..0, wait);
    samples.remove(500);
    // The control delays the command by 9 ms.
    let late = samples.clone();
    samples
        .iter_mut()
        .skip(9)
        .zip(&late)
        .for_each(|(sample, late)| (sample[2], sample[4]) = (late[2], late[4]));
    write(&folder, "cut.csv", &samples);
    folder.run(&[
        "correct",
        "circle.ngc",
        "--machine",
        "file.toml",
        "--file-error",
        "0",
        "--out",
        "p0.ngc",
    ]);
    let unlearned_um = if folder.path().join("p0.ngc").exists() {
        cut(&folder, "p0.ngc").0
    } else {
        original_um
    };
    let (ran, results) = correct(&folder, &["cut.csv"], "p1.ngc");
    let (ran, results) = (ran.succeeded(), results.unwrap());
    assert!(
        !ran.reported().contains(" took "),
        "the control was as fast as planned: {}",
        ran.stdout
    );
    let reported = ran.reported();
    assert!(
        reported.contains("cut.csv original 1") && reported.contains("in the next cut"),
        "{reported}"
    );
    crate::json_keys::hold("correct", &results);
    let (learned_um, samples) = cut(&folder, "p1.ngc");
    assert!(
        unlearned_um > 0.3 * original_um,
        "the file is wrong enough: {unlearned_um} {original_um}"
    );
    assert!(
        learned_um < 0.05 * original_um,
        "{learned_um} {original_um}"
    );
    let band = [0, 1].map(|end| {
        results["learned"]["predicted"]["band_um"][end]
            .as_f64()
            .unwrap()
    });
    assert!(
        (band[0]..band[1]).contains(&learned_um),
        "{learned_um} {band:?}"
    );
    write(&folder, "cut2.csv", &samples);
    let (ran, results) = correct(&folder, &["cut.csv", "cut2.csv"], "p2.ngc");
    let results = results.unwrap();
    let programs = [0, 1].map(|log| results["learned"]["logs"][log]["program"].as_str());
    assert_eq!(programs, [Some("original"), Some("corrected")], "{results}");
    if folder.path().join("p2.ngc").exists() {
        assert!(cut(&folder, "p2.ngc").0 <= learned_um, "{}", ran.stdout);
    } else {
        assert!(
            ran.reported()
                .contains("the corrected program that was cut is as good"),
            "{}",
            ran.stdout
        );
    }
}

#[test]
fn a_log_that_shows_nothing_is_refused_with_place_value_limit_and_remedy() {
    let folder = Folder::new();
    folder.file("file.toml", FILE);
    folder.file("circle.ngc", PART);
    let (_, samples) = cut(&folder, "circle.ngc");
    let refused = |samples: &[[f64; 5]], says: &[&str]| {
        write(&folder, "cut.csv", samples);
        let (ran, _) = correct(&folder, &["cut.csv"], "p.ngc");
        ran.refused(&[&["cut.csv"], says].concat());
        assert!(!folder.path().join("p.ngc").exists());
    };
    let changed = |change: &dyn Fn(usize, [f64; 5]) -> [f64; 5]| -> Samples {
        samples
            .iter()
            .enumerate()
            .map(|(k, sample)| change(k, *sample))
            .collect()
    };
    refused(
        &changed(&|_, [t, x, a, y, b]| [t, 1.5 * x, 1.5 * a, y, b]),
        &["away from the program", "another program"],
    );
    refused(
        &changed(&|_, [t, x, a, y, b]| [t, x / 25.4, a / 25.4, y / 25.4, b / 25.4]),
        &["inch", "--columns unit=inch"],
    );
    refused(
        &samples[..samples.len() * 6 / 10],
        &[
            "ends at line 4, at 62 %",
            "record until the program has ended",
        ],
    );
    let slow: Samples = samples.iter().copied().step_by(10).collect();
    refused(
        &slow,
        &["10 ms", "at most 5.682 ms", "record each servo period"],
    );
    let noisy = changed(&|k, [t, x, a, y, b]| {
        let noise =
            |k: usize| 0.1 * (libm::sin(k as f64 * k as f64) + libm::sin(0.3 * (k * k) as f64));
        [t, x, a + noise(k), y, b + noise(k + 7)]
    });
    refused(&noisy, &["um RMS", "at most 0.7", "record the encoders"]);
    folder.file("file.toml", FILE.replace("kp_1_s = 44", "kp_1_s = 25"));
    refused(
        &samples,
        &[
            "axis y",
            "position gain of the machine file",
            "0.6 to 1.667",
            "--update",
        ],
    );
}
