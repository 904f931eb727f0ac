//! `check` for other programs: formats and exit codes; and what `canon` writes of a faulty program.

use crate::command::Folder;
use serde_json::Value;

/// A folder with a program without mistakes, one with two of them and one with a warning.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("bad.ngc", "G21 F100\nG1 X1 Y1\nG999\nG1 X2 Q5\nM2\n");
    folder.file("warned.ngc", "G21 F100\nG1 X1\n");
    folder
}

#[test]
fn exit_codes_are_those_of_the_worst_file() {
    let folder = folder();
    for (files, code) in [
        (&["circle.ngc"][..], 0),
        (&["warned.ngc"], 0),
        (&["circle.ngc", "bad.ngc"], 1),
        (&["missing.ngc"], 2),
        (&["bad.ngc", "missing.ngc", "circle.ngc"], 2),
    ] {
        for format in ["text", "json", "sarif", "github"] {
            let ran = folder.run(&[&["check", "--format", format], files].concat());
            assert_eq!(ran.code, Some(code), "{format} {files:?}: {ran:?}");
        }
    }
}

#[test]
fn json_has_every_file_with_its_findings() {
    let ran = folder().run(&[
        "check",
        "--format",
        "json",
        "circle.ngc",
        "bad.ngc",
        "warned.ngc",
        "missing.ngc",
    ]);
    let document: Value = serde_json::from_str(&ran.stdout).unwrap();
    let outcomes: Vec<_> = document["files"]
        .as_array()
        .unwrap()
        .iter()
        .map(|file| file["outcome"].clone())
        .collect();
    assert_eq!(outcomes, ["fine", "mistakes", "fine", "unreadable"]);
    let bad = document["files"][1]["findings"].as_array().unwrap();
    let places: Vec<_> = bad
        .iter()
        .map(|finding| [finding["line"].clone(), finding["column"].clone()])
        .collect();
    assert_eq!(places, [[3, 1], [4, 7]]);
    assert_eq!(bad[0]["code"], "gcode::unknown_g");
    assert_eq!(document["files"][2]["findings"][0]["severity"], "warning");
}

#[test]
fn sarif_has_the_structure_of_2_1_0() {
    let ran = folder().run(&["check", "--format", "sarif", "bad.ngc", "warned.ngc"]);
    let log: Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!(
        (&log["version"], &log["runs"][0]["tool"]["driver"]["name"]),
        (&"2.1.0".into(), &"feedwright".into())
    );
    let results = log["runs"][0]["results"].as_array().unwrap();
    let rules = log["runs"][0]["tool"]["driver"]["rules"]
        .as_array()
        .unwrap();
    for result in results {
        assert!(
            rules.iter().any(|rule| rule["id"] == result["ruleId"]),
            "{result}"
        );
        assert!(
            result["message"]["text"]
                .as_str()
                .is_some_and(|text| !text.is_empty()),
            "{result}"
        );
        let place = &result["locations"][0]["physicalLocation"];
        assert!(
            place["artifactLocation"]["uri"]
                .as_str()
                .unwrap()
                .ends_with(".ngc"),
            "{result}"
        );
        assert!(
            place["region"].is_null() || place["region"]["startLine"].as_u64().unwrap() >= 1,
            "{result}"
        );
    }
    let levels: Vec<_> = results
        .iter()
        .map(|result| result["level"].clone())
        .collect();
    assert_eq!(levels, ["error", "error", "warning"]);
}

#[test]
fn github_annotations_are_a_line_each() {
    let ran = folder().run(&["check", "--format", "github", "bad.ngc"]);
    let lines: Vec<_> = ran.stdout.lines().collect();
    assert_eq!(lines.len(), 2, "{ran:?}");
    assert!(lines[0].starts_with(
        "::error file=bad.ngc,line=3,col=1,endColumn=4,title=gcode%3A%3Aunknown_g::G999"
    ));
}

#[test]
fn canon_writes_nothing_behind_a_faulty_line() {
    let ran = folder().run(&["canon", "bad.ngc"]);
    assert_eq!(ran.code, Some(2));
    assert_eq!(ran.stdout.lines().count(), 1, "{ran:?}");
    assert!(
        ran.stderr.contains("bad.ngc:3:1") && ran.stderr.contains("bad.ngc:4:7"),
        "{ran:?}"
    );
}

#[test]
fn subroutines_are_found_in_the_folders_that_are_named() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("library")).unwrap();
    folder.file(
        "library/slot.ngc",
        "o<slot> sub\nG1 X#1\no<slot> endsub\nM2\n",
    );
    folder.file("part.ngc", "G21 F100\no<slot> call [5]\nM2\n");
    folder
        .run(&["check", "part.ngc"])
        .faulty(&["defined nowhere"]);
    folder
        .run(&["check", "part.ngc", "--subroutines", "library"])
        .succeeded();
    folder
        .run(&["check", "part.ngc", "--subroutines", "none"])
        .refused(&["--subroutines none", "no folder"]);
}

/// A tool table is no program, but its mistakes are reported in the requested format, too.
#[test]
fn a_faulty_tool_table_is_reported_in_every_format() {
    let folder = folder();
    folder.file("bad.tbl", "T1 P1 D6\nT2 P2 Dx\n");
    for (table, line, code) in [("bad.tbl", 2, "gcode::tool_table"), ("none.tbl", 0, "file")] {
        let check = |format: &str| {
            let ran = folder.run(&[
                "check",
                "--format",
                format,
                "--tool-table",
                table,
                "circle.ngc",
            ]);
            assert_eq!(ran.code, Some(2), "{ran:?}");
            ran.stdout
        };
        let document: Value = serde_json::from_str(&check("json")).unwrap();
        let [file] = &document["files"].as_array().unwrap()[..] else {
            panic!("{document}")
        };
        assert_eq!(
            (&file["file"], &file["outcome"]),
            (&table.into(), &"unreadable".into())
        );
        assert_eq!(
            (&file["findings"][0]["line"], &file["findings"][0]["code"]),
            (&line.into(), &code.into())
        );
        let log: Value = serde_json::from_str(&check("sarif")).unwrap();
        assert_eq!(log["runs"][0]["results"][0]["ruleId"], code);
        assert!(check("github").starts_with(&format!("::error file={table}")));
        assert_eq!(check("text"), "");
    }
}
