//! What a geometry file holds, and what is refused.

use std::f64::consts::TAU;

use super::check::GeometryRefused;
use super::observation::MeasuredSet;
use super::*;

const NOISE_UM: f64 = 0.3;

/// A geometry with everything that a ball bar and three lasers show.
fn truth() -> GeometryFile {
    let axis = |scale_um_m: f64, pitch_error_um: f64, backlash_um: f64, pitch_phase_deg: f64| {
        AxisGeometry {
            scale_um_m,
            pitch_error_um,
            pitch_phase_deg,
            lead_mm_per_rev: 10.0,
            backlash_um,
            ..AxisGeometry::default()
        }
    };
    GeometryFile {
        origin: GeometryOrigin {
            source: "a test".to_owned(),
            ..GeometryOrigin::default()
        },
        axes: [
            axis(20.0, 2.0, 3.0, 40.0),
            axis(-15.0, 1.0, 5.0, 70.0),
            axis(10.0, 1.5, 4.0, -60.0),
        ],
        squareness: MeasuredSquareness {
            squareness_xy_urad: 20.0,
            squareness_xz_urad: -15.0,
            squareness_yz_urad: 12.0,
            ..MeasuredSquareness::default()
        },
        ..GeometryFile::default()
    }
}

/// Numbers between -sqrt(3) and sqrt(3), of variance 1.
fn noise(state: &mut u64) -> f64 {
    *state = state
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    ((*state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5) * 12.0_f64.sqrt()
}

/// The truth with measurements of it: bars in three planes and a scale on each axis. What the noise
/// left is stated as such.
fn measured(noise_um: f64) -> GeometryFile {
    let mut file = truth();
    let mut state = 7;
    let mut put = |mut set: MeasuredSet| {
        let seen = set.observations();
        let (mut squares, last) = (0.0, set.rows[0].len() - 1);
        for (row, seen) in set.rows.iter_mut().zip(&seen) {
            let error_um = noise_um * noise(&mut state);
            row[last] = seen.predicted_um(&truth()) + error_um;
            squares += error_um * error_um;
        }
        set.left_um = (squares / seen.len() as f64).sqrt();
        file.measured.push(set);
    };
    for plane in ["xy", "xz", "yz"] {
        let row = |i: usize| {
            vec![
                1.0 + (i % 180) as f64 * 2.0,
                if i < 180 { 1.0 } else { -1.0 },
                0.0,
            ]
        };
        put(MeasuredSet {
            name: format!("bar {plane}"),
            kind: "bar".to_owned(),
            axes: plane.to_owned(),
            radius_mm: 50.0,
            noise_um: NOISE_UM,
            rows: (0..360).map(row).collect(),
            ..MeasuredSet::default()
        });
    }
    for axis in AXIS_NAMES {
        let row = |i: usize| vec![3.0 * (i % 50) as f64, if i < 50 { 1.0 } else { -1.0 }, 0.0];
        put(MeasuredSet {
            name: format!("scale {axis}"),
            kind: "axis".to_owned(),
            axes: axis.to_owned(),
            noise_um: NOISE_UM,
            rows: (0..100).map(row).collect(),
            ..MeasuredSet::default()
        });
    }
    file.unknowns = 18 + 12 + 3;
    file
}

#[test]
fn what_is_written_reads_back() {
    let mut file = measured(NOISE_UM);
    file.axes[1].table = vec![[0.0, 0.1, -0.2], [50.0, 1.0 / 3.0, 0.5]];
    file.axes[0].straightness[1] = vec![[0.0, 0.5], [100.0, -0.5]];
    let read = GeometryFile::parse("g.toml", &file.text()).unwrap();
    assert_eq!(read, file);
    assert_eq!(
        GeometryFile::parse(
            "g.toml",
            &GeometryFile::parse("g", &file.text()).unwrap().text()
        )
        .unwrap(),
        file
    );
}

#[test]
fn the_errors_are_those_of_the_simulated_machine() {
    let mut geometry = truth();
    geometry
        .axes
        .iter_mut()
        .for_each(|axis| (axis.pitch_phase_deg, axis.backlash_um) = (0.0, 0.0));
    let axes = [0, 1, 2].map(|i| feedwright_control::AxisErrors {
        scale: 1e-6 * geometry.axes[i].scale_um_m,
        pitch_mm: 1e-3 * geometry.axes[i].pitch_error_um,
        pitch_rad_per_mm: TAU / 10.0,
        ..feedwright_control::AxisErrors::default()
    });
    let square = geometry.squareness;
    let angles = [
        square.squareness_xy_urad,
        square.squareness_xz_urad,
        square.squareness_yz_urad,
    ];
    let machine = feedwright_control::KnownGeometry::new(axes, angles.map(|urad| 1e-6 * urad));
    for at_mm in [[12.0, -7.0, 33.0], [-100.0, 3.3, 0.0]] {
        let error_um = geometry.error_um(at_mm, [1.0; 3]);
        let tool_mm = machine.tool_mm(at_mm);
        for i in 0..3 {
            assert!(
                (1e3 * (tool_mm[i] - at_mm[i]) - error_um[i]).abs() < 1e-9,
                "{error_um:?}"
            );
        }
    }
}

#[test]
fn tables_are_linear_between_their_points_and_have_a_direction() {
    let mut geometry = GeometryFile::default();
    geometry.axes[0].table = vec![[0.0, 1.0, 3.0], [10.0, 2.0, 4.0]];
    geometry.axes[0].straightness[1] = vec![[0.0, 0.0], [10.0, 5.0]];
    let at = |x: f64, way: f64| geometry.error_um([x, 0.0, 0.0], [way, 0.0, 0.0]);
    assert_eq!(
        (at(5.0, 1.0), at(5.0, -1.0), at(5.0, 0.0)),
        ([1.5, 2.5, 0.0], [3.5, 2.5, 0.0], [2.5, 2.5, 0.0])
    );
    assert_eq!(
        (at(-5.0, 1.0), at(50.0, -1.0)),
        ([1.0, 0.0, 0.0], [4.0, 5.0, 0.0])
    );
}

fn refused(change: impl Fn(&mut GeometryFile)) -> String {
    use miette::Diagnostic;
    let mut file = measured(NOISE_UM);
    change(&mut file);
    let error = file.check().unwrap_err();
    assert!(
        matches!(error, GeometryRefused::DoesNotFit { .. }),
        "{error}"
    );
    format!(
        "{error} / {}",
        error
            .help()
            .map(|help| help.to_string())
            .unwrap_or_default()
    )
}

#[test]
fn the_geometry_that_was_found_passes() {
    let found = measured(NOISE_UM).check().unwrap().unwrap();
    assert!(
        found.before_um > 1.5 && (found.after_um / NOISE_UM - 1.0).abs() < 0.1,
        "{found:?}"
    );
    assert_eq!(
        GeometryFile {
            measured: Vec::new(),
            ..truth()
        }
        .check(),
        Ok(None)
    );
}

#[test]
fn every_wrong_sign_is_caught_and_named() {
    for axis in 0..3 {
        let name = AXIS_NAMES[axis];
        let reported = [
            (
                refused(|file| file.axes[axis].scale_um_m *= -1.0),
                "scale_um_m",
            ),
            (
                refused(|file| file.axes[axis].pitch_error_um *= -1.0),
                "pitch_error_um",
            ),
            (
                refused(|file| file.axes[axis].pitch_phase_deg *= -1.0),
                "pitch_phase_deg",
            ),
            (
                refused(|file| file.axes[axis].backlash_um *= -1.0),
                "backlash_um",
            ),
        ];
        for (reported, key) in reported {
            assert!(
                reported.contains(&format!(
                    "with the other sign of {key} of axis.{name} it fits"
                )),
                "{reported}"
            );
        }
    }
    for (reported, key) in [
        (
            refused(|file| file.squareness.squareness_xy_urad *= -1.0),
            "xy",
        ),
        (
            refused(|file| file.squareness.squareness_xz_urad *= -1.0),
            "xz",
        ),
        (
            refused(|file| file.squareness.squareness_yz_urad *= -1.0),
            "yz",
        ),
    ] {
        assert!(
            reported.contains(&format!(
                "with the other sign of squareness_{key}_urad it fits"
            )),
            "{reported}"
        );
    }
}

#[test]
fn exchanged_axes_and_another_lead_are_caught() {
    for [a, b] in [[0, 1], [0, 2], [1, 2]] {
        let reported = refused(|file| file.axes.swap(a, b));
        let said = format!(
            "with axis.{} and axis.{} exchanged it fits",
            AXIS_NAMES[a], AXIS_NAMES[b]
        );
        assert!(reported.contains(&said), "{reported}");
    }
    for lead_mm in [5.0, 9.5, 12.0, 20.0] {
        let reported = refused(|file| file.axes[1].lead_mm_per_rev = lead_mm);
        assert!(
            reported.contains("the lead or the measurement was changed"),
            "{reported}"
        );
    }
    refused(|file| file.axes[0].table = vec![[0.0, 3.0, 3.0], [100.0, -3.0, 3.0]]);
    refused(|file| {
        file.measured[3]
            .rows
            .iter_mut()
            .for_each(|row| row[2] *= -1.0);
    });
}

#[test]
fn a_geometry_of_noise_is_refused() {
    let mut file = measured(NOISE_UM);
    let tiny = AxisGeometry {
        scale_um_m: 0.01,
        ..AxisGeometry::default()
    };
    for set in &mut file.measured {
        let seen = set.observations();
        let of_truth: Vec<f64> = seen
            .iter()
            .map(|seen| seen.predicted_um(&truth()))
            .collect();
        for (row, of_truth) in set.rows.iter_mut().zip(of_truth) {
            row[2] -= of_truth;
        }
    }
    file = GeometryFile {
        axes: [tiny, AxisGeometry::default(), AxisGeometry::default()],
        ..file
    };
    file.squareness = MeasuredSquareness::default();
    let error = file.check().unwrap_err();
    assert!(
        matches!(error, GeometryRefused::DoesNotReduce { .. }),
        "{error}"
    );
    file.unknowns = 10_000;
    assert!(matches!(
        file.check().unwrap_err(),
        GeometryRefused::TooFew { .. }
    ));
}

#[test]
fn faults_are_reported_at_their_places() {
    let text = "format = 1\nsource = \"hand\"\n[axis.x]\nscale_um_m = 1e6\npitch_error_um = 2\ntable = [[5, 1, 1], [0, 1, 1]]\n\
                straightness_x = [[0, 1]]\n[axis.w]\n[measured]\nunknowns = 1\n[measured.set.a]\nkind = \"bars\"\naxes = \"xy\"\n\
                noise_um = 1\nleft_um = 1\nrows = [[1, 2]]\n";
    let Err(FileError::Invalid { problems, .. }) = GeometryFile::parse("g.toml", text) else {
        panic!("no faults")
    };
    let reported: Vec<String> = problems
        .iter()
        .map(|problem| format!("{}: {problem}", problem.line))
        .collect();
    for said in [
        "4: scale_um_m is 1e6 um/m; it must lie between -10000 and 10000 um/m",
        "5: pitch_error_um is 2 um, and lead_mm_per_rev is missing",
        "6: positions of table have to rise; 5 mm is followed by 0 mm",
        "7: straightness_x is the error of axis.x in its own direction",
        "unknown table 'w' in [axis]",
        "no measurement is of kind 'bars'",
        "rows, row 1 has to be 3 numbers in brackets",
    ] {
        assert!(
            reported.iter().any(|reported| reported.contains(said)),
            "no '{said}' in {reported:#?}"
        );
    }
}
