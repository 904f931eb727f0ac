//! `feedwright check` on many files: order, folders, files named twice, threads; and the options of
//! reading that three commands share.

use crate::command::{CIRCLE, Folder, Ran};
use feedwright_gcode::{AUTO, DIALECTS};

/// Programs of very different length, every third with mistakes.
fn many(folder: &Folder, count: usize) -> Vec<String> {
    (0..count)
        .map(|n| {
            let name = format!("{n:02}.ngc");
            let bad = if n % 3 == 2 { "G1 X1 F0\nG999\n" } else { "" };
            let long = "G1 X1\nX0\n".repeat(if n % 4 == 0 { 20_000 } else { 3 });
            folder.file(&name, format!("G21 F600\n{bad}{long}M2\n"));
            name
        })
        .collect()
}

fn with_threads(folder: &Folder, threads: &str, arguments: &[&str]) -> Ran {
    Ran::from(
        folder
            .command()
            .env("RAYON_NUM_THREADS", threads)
            .arg("check")
            .args(arguments)
            .output()
            .unwrap(),
    )
}

#[test]
fn verdicts_come_in_the_order_of_the_arguments_for_any_number_of_threads() {
    let folder = Folder::new();
    let mut names = many(&folder, 16);
    names.reverse();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let one = with_threads(&folder, "1", &names);
    assert_eq!(one.code, Some(1));
    let fine = |name: &&&str| name[..2].parse::<usize>().unwrap() % 3 != 2;
    let mut lines = one.stdout.lines();
    for name in names.iter().filter(fine) {
        assert!(
            lines.next().unwrap().starts_with(&format!("{name}: ")),
            "{}",
            one.stdout
        );
    }
    assert_eq!(
        lines.next(),
        Some("16 files: 11 without mistakes, 5 with mistakes")
    );
    let places: Vec<usize> = names
        .iter()
        .filter(|name| !fine(name))
        .map(|name| one.stderr.find(&format!("{name}:2:")).unwrap())
        .collect();
    assert!(places.len() == 5 && places.is_sorted(), "{places:?}");
    for threads in ["2", "3", "8"] {
        let other = with_threads(&folder, threads, &names);
        assert_eq!(
            (&other.stdout, &other.stderr, other.code),
            (&one.stdout, &one.stderr, one.code),
            "{threads}"
        );
    }
}

#[test]
fn a_folder_is_the_programs_in_it() {
    let folder = Folder::new();
    let at = |path: &str| std::fs::create_dir_all(folder.path().join(path)).unwrap();
    at("parts/inner");
    at("parts/none");
    for name in ["b.ngc", "a.NC", "inner/c.gcode", "inner/d.tap", "z.cnc"] {
        folder.file(format!("parts/{name}"), CIRCLE);
    }
    folder.file("parts/readme.txt", "no program");
    let ran = folder.run(&["check", "parts"]).succeeded();
    let names: Vec<&str> = ran
        .stdout
        .lines()
        .filter_map(|line| line.split_once(": "))
        .map(|pair| pair.0)
        .collect();
    let wanted = [
        "parts/a.NC",
        "parts/b.ngc",
        "parts/inner/c.gcode",
        "parts/inner/d.tap",
        "parts/z.cnc",
        "5 files",
    ];
    assert_eq!(
        names,
        wanted.map(|name| name.replace('/', std::path::MAIN_SEPARATOR_STR))
    );
    assert_eq!(
        ran.stderr.trim(),
        "parts: 5 programs; left out: other endings 1"
    );
    folder.run(&["check", "parts/none"]).refused(&[
        "parts/none",
        "holds no program",
        ".ngc .nc .gcode .tap .cnc",
    ]);
}

#[test]
#[cfg(unix)]
fn links_in_a_circle_end() {
    let folder = Folder::new();
    std::fs::create_dir(folder.path().join("parts")).unwrap();
    folder.file("parts/a.ngc", CIRCLE);
    std::os::unix::fs::symlink("..", folder.path().join("parts/up")).unwrap();
    std::os::unix::fs::symlink("a.ngc", folder.path().join("parts/b.ngc")).unwrap();
    let ran = folder.run(&["check", "parts"]).succeeded();
    assert_eq!(ran.stdout.lines().count(), 1, "{ran:?}");
    assert!(
        ran.stderr
            .contains("left out: linked folders 1, named before 1"),
        "{ran:?}"
    );
}

#[test]
fn a_file_named_twice_is_checked_once() {
    let folder = Folder::new();
    let ran = folder
        .run(&["check", "circle.ngc", "./circle.ngc", "circle.ngc"])
        .succeeded();
    assert_eq!(ran.stdout.lines().count(), 1, "{ran:?}");
    assert!(
        ran.stderr
            .contains("./circle.ngc: named before, checked once"),
        "{ran:?}"
    );
    assert_eq!(ran.stderr.lines().count(), 2);
}

#[test]
fn every_dialect_can_be_chosen_and_is_reported() {
    let folder = Folder::new();
    // M200 is the machine's own to Fanuc and a printer's to Marlin, and unknown to LinuxCNC.
    folder.file("own.ngc", "G21 F600 S100 M3\nM200\nG1 X1\nM30\n");
    folder.run(&["check", "own.ngc"]).faulty(&[
        "M200",
        "LinuxCNC",
        "own.ngc:2:1",
        "another --dialect",
    ]);
    for (name, dialect) in DIALECTS {
        for command in ["check", "canon"] {
            let ran = folder.run(&[command, "own.ngc", "--dialect", name]);
            if name == "linuxcnc" {
                assert_eq!(
                    ran.code,
                    Some(if command == "check" { 1 } else { 2 }),
                    "{command}: {ran:?}"
                );
                continue;
            }
            let ran = ran.succeeded();
            let reported = if command == "check" {
                &ran.stdout
            } else {
                &ran.stderr
            };
            // Fanuc and Haas go on to mill or lathe.
            let is_reported = reported.contains(&format!("read as {dialect}"))
                && reported.contains(": as was asked for");
            assert!(is_reported, "{command} {name}: {ran:?}");
        }
    }
    let ran = folder
        .run_uncorrected(&["own.ngc", "--dialect", "fanuc", "--json", "r.json"])
        .succeeded();
    assert!(
        folder
            .text("r.json")
            .contains("Fanuc/Haas mill: as was asked for"),
        "{ran:?}"
    );
    let ran = folder
        .run(&["canon", "circle.ngc", "--dialect", AUTO])
        .succeeded();
    assert_eq!(
        ran.stderr,
        "circle.ngc: read as LinuxCNC: nothing points to another control\n"
    );
    assert!(
        ran.stdout.lines().all(|line| line.starts_with("{\"")),
        "{ran:?}"
    );
    assert_eq!(
        folder
            .run(&["-q", "canon", "circle.ngc"])
            .succeeded()
            .stderr,
        ""
    );
}

#[test]
fn an_unknown_dialect_is_refused() {
    let folder = Folder::new();
    for command in ["check", "canon", "run"] {
        let says = [
            "'fanuk'",
            "auto, linuxcnc, fanuc, haas, fanuc-mill",
            "did you mean 'fanuc'?",
        ];
        folder
            .run(&[command, "circle.ngc", "--dialect", "fanuk"])
            .refused(&says);
        let help = folder.run(&[command, "--help-all"]).succeeded().stdout;
        assert!(
            DIALECTS.iter().all(|(name, _)| help.contains(name)) && help.contains("--tool-table"),
            "{help}"
        );
    }
}

#[test]
fn endless_programs_end_at_the_limits_given() {
    let folder = Folder::new();
    folder.file(
        "idle.ngc",
        "G21 F600\nG1 X1\n#1=0\no1 while [#1 LT 1]\n#2=[#2+1]\no1 endwhile\nM2\n",
    );
    folder.file(
        "moves.ngc",
        "G21 F600\no1 while [1]\nG1 X1\nX0\no1 endwhile\nM2\n",
    );
    folder.file(
        "long.ngc",
        format!("G21 F600\nG1 X1\n{}G1 X0\nM2\n", "#1=0\n".repeat(500)),
    );
    let says_idle = ["idle.ngc", "endless loop: 400 lines", "--max-idle-lines"];
    let says_moves = ["moves.ngc", "more than 300 motions", "--max-motions"];
    folder
        .run(&["check", "idle.ngc", "--max-idle-lines", "400"])
        .faulty(&says_idle);
    folder
        .run(&["check", "moves.ngc", "--max-motions", "300"])
        .faulty(&says_moves);
    folder
        .run_uncorrected(&["idle.ngc", "--max-idle-lines", "400"])
        .refused(&says_idle);
    folder
        .run_uncorrected(&["moves.ngc", "--max-motions", "300"])
        .refused(&says_moves);
    let canon = folder.run(&["canon", "moves.ngc", "--max-motions", "300"]);
    assert_eq!(canon.code, Some(2));
    assert!(
        canon.stderr.contains("more than 300 motions"),
        "{}",
        canon.stderr
    );
    assert!(
        (300..=305).contains(&canon.stdout.lines().count()),
        "{}",
        canon.stdout.lines().count()
    );
    folder
        .run(&["check", "long.ngc", "--max-idle-lines", "400"])
        .faulty(&["400 lines"]);
    folder
        .run(&["check", "long.ngc", "--max-idle-lines", "600"])
        .succeeded();
    for option in ["--max-motions", "--max-idle-lines"] {
        for value in ["0", "-1", "many"] {
            folder
                .run(&["check", "circle.ngc", option, value])
                .refused(&[option, value]);
        }
    }
}

#[test]
fn a_tool_table_gives_lengths_and_radii() {
    let folder = Folder::new();
    folder.file("tools.tbl", "T1 P1 Z+10 D4 ; end mill\nT2 P2 Z0.5 D0.25\n");
    folder.file(
        "cut.ngc",
        "G21 F600\nT1 M6\nG43\nG0 Z0\nG41 D1\nG1 X10\nX20\nG40\nM2\n",
    );
    folder
        .run(&["check", "cut.ngc"])
        .faulty(&["tool 1 is not in the tool table", "cut.ngc:5:"]);
    let last_y = |options: &[&str]| {
        let stdout = folder
            .run(&[&["canon", "cut.ngc"], options].concat())
            .succeeded()
            .stdout;
        let steps: Vec<serde_json::Value> = stdout
            .lines()
            .map(|line| serde_json::from_str(line).unwrap())
            .collect();
        let ends: Vec<_> = steps
            .iter()
            .filter_map(|step| step["motion"]["end_mm"].as_array())
            .collect();
        // The tool keeps left of X: its radius in Y, its length in Z.
        let offsets = [1, 2].map(|axis| {
            ends.iter()
                .map(|end| end[axis].as_f64().unwrap())
                .fold(0.0, f64::max)
        });
        offsets.map(|offset| (offset * 1e6).round() / 1e6)
    };
    assert_eq!(last_y(&["--tool-table", "tools.tbl"]), [2.0, 10.0]);
    assert_eq!(
        last_y(&["--tool-table", "tools.tbl", "--tool-unit", "mm"]),
        [2.0, 10.0]
    );
    folder.file(
        "cut.ngc",
        "G21 F600\nT2 M6\nG43\nG0 Z0\nG41 D2\nG1 X10\nX20\nG40\nM2\n",
    );
    assert_eq!(
        last_y(&["--tool-table", "tools.tbl", "--tool-unit", "inch"]),
        [3.175, 12.7]
    );
    for command in ["check", "run"] {
        folder
            .run(&[command, "cut.ngc", "--tool-table", "tools.tbl"])
            .succeeded();
    }
}

#[test]
fn faults_of_a_tool_table_have_their_places() {
    let folder = Folder::new();
    folder.file(
        "tools.tbl",
        "; my tools\nT1 P1 Z1,5 D6\nP3 D2\nT4 D6 L3\n\nT1.5\nT6 D1e9\nT7\nT7 D3\n",
    );
    for command in ["check", "canon", "run"] {
        folder
            .run(&[command, "circle.ngc", "--tool-table", "tools.tbl"])
            .refused(&[
                "tools.tbl: 6 faults in the tool table",
                "tools.tbl:2:7",
                "1.5, not 1,5",
                "tools.tbl:3:1",
                "the tool number T is missing",
                "tools.tbl:4:7",
                "`L3`: unknown word",
                "tools.tbl:6:1",
                "not a whole number",
                "tools.tbl:7:4",
                "limit of 1000000 mm",
                "tools.tbl:9:1",
                "tool 7 stands on an earlier line",
            ]);
        folder
            .run(&[command, "circle.ngc", "--tool-table", "none.tbl"])
            .refused(&["none.tbl", "No such file"]);
    }
    folder
        .run(&["check", "circle.ngc", "--tool-unit", "inch"])
        .refused(&["--tool-table"]);
    folder.file("fine.tbl", "T1 D3\n");
    let says = ["fine.tbl", "which this run reads"];
    folder
        .run_uncorrected(&[
            "circle.ngc",
            "--tool-table",
            "fine.tbl",
            "--json",
            "fine.tbl",
        ])
        .refused(&says);
}
