//! `identify --geometry` and the programs of `excite` that measure geometry.

use std::fmt::Write;

use feedwright_sim::GeometryFile;

use crate::command::Folder;

/// A calibrated ball bar on a machine whose x axis goes 20 um/m too far, with 3 um of backlash,
/// read to 0.1 um.
pub(crate) fn bar() -> String {
    let mut text = "# ball bar\n# plane: xy\n# radius_mm: 100\n# calibrated: yes\n# date: 2026-05-17\nangle_deg,direction,deviation_um\n".to_owned();
    for way in [1, -1] {
        for i in 0..360 {
            let (sin, cos) = libm::sincos((f64::from(i) + 0.5).to_radians());
            let backlash_um = 0.5 * 3.0 * (f64::from(way) * sin).signum();
            let _ = writeln!(
                text,
                "{}.5,{way},{:.1}",
                i,
                2.0 * cos * cos + backlash_um * cos
            );
        }
    }
    text
}

#[test]
fn a_ball_bar_becomes_a_geometry_file_and_a_compensation_file() {
    let folder = Folder::new();
    folder.file("bar.csv", bar());
    let arguments = [
        "identify",
        "--geometry",
        "bar.csv",
        "--out",
        "g.toml",
        "--comp-file",
        "x=x.comp",
        "--comp-type",
        "1",
    ];
    let reported = folder.run(&arguments).succeeded().stdout;
    assert!(
        reported.contains("scale x")
            && reported.contains("backlash x")
            && reported.contains("wrote g.toml")
            && reported.contains("wrote x.comp"),
        "{reported}"
    );
    let found = GeometryFile::read(&folder.path().join("g.toml")).unwrap();
    assert!(
        (found.axes[0].scale_um_m - 20.0).abs() < 0.5
            && (found.axes[0].backlash_um - 3.0).abs() < 0.05,
        "{reported}"
    );
    assert_eq!(
        (found.origin.date.as_str(), found.origin.source.as_str()),
        ("2026-05-17", "bar.csv, on workshop")
    );
    assert!(found.check().unwrap().is_some());
    let comp = folder.text("x.comp");
    let first: Vec<f64> = comp
        .lines()
        .next()
        .unwrap()
        .split(' ')
        .map(|number| number.parse().unwrap())
        .collect();
    assert!(
        comp.lines().count() > 8 && (first[0] + 100.0).abs() < 0.5,
        "{comp}"
    );
    // At -100 mm the tool is 2 um ahead, and half of the backlash behind in forward travel: 0.5 um
    // to be taken off.
    assert!(
        (first[1] + 0.0005).abs() < 0.0003 || (first[1] - 0.0035).abs() < 0.0003,
        "{comp}"
    );
    folder
        .run(&["identify", "--geometry", "x=x.comp", "--out", "again.toml"])
        .succeeded();
    let again = GeometryFile::read(&folder.path().join("again.toml")).unwrap();
    assert!(
        (again.axes[0].table[0][1] + 1e3 * first[1]).abs() < 1e-9,
        "{again:?}"
    );
}

#[test]
fn what_is_no_measurement_or_goes_with_no_other_is_refused() {
    let folder = Folder::new();
    folder.file("bar.csv", bar());
    folder.file("x.comp", "0 0.001 0.002\n100 -0.001 0.003\n");
    folder.file("log.csv", "t,x.cmd\n0,1\n");
    let refused = |arguments: &[&str], said: &str| {
        let ran = folder.run(&[&["identify", "--out", "g.toml"], arguments].concat());
        assert!(ran.stderr.contains(said), "no '{said}' in {}", ran.stderr);
        assert!(!folder.path().join("g.toml").exists());
    };
    refused(
        &["--geometry", "log.csv"],
        "this is a log of commanded and actual positions",
    );
    refused(
        &["--geometry", "x.comp"],
        "which axis this is of is not said",
    );
    refused(
        &["--geometry", "x=x.comp", "--geometry", "bar.csv"],
        "says what a control adds already",
    );
    refused(
        &["--geometry", "bar.csv", "--comp-file", "z=z.comp"],
        "nothing was measured of z",
    );
    refused(&["--geometry", "none.csv"], "cannot read none.csv");
}

#[test]
fn programs_to_measure_with_can_be_cut() {
    let folder = Folder::new();
    for plane in ["xy", "xz", "yz"] {
        let arguments = [
            "excite",
            "--machine",
            "workshop",
            "--ballbar",
            "50",
            "--plane",
            plane,
            "--out",
            "bar.ngc",
        ];
        assert!(
            folder
                .run(&arguments)
                .succeeded()
                .stdout
                .contains("ball bar of 50 mm")
        );
        folder.run(&["check", "bar.ngc"]).succeeded();
    }
    folder
        .run(&[
            "excite",
            "--machine",
            "workshop",
            "--grid",
            "5",
            "--out",
            "grid.ngc",
        ])
        .succeeded();
    folder.run(&["check", "grid.ngc"]).succeeded();
    assert_eq!(folder.text("grid.ngc").matches("G4 P").count(), 2 * 5 * 10);
}
