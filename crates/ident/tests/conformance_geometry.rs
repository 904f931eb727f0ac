//! Geometry from measurements: what was put in is found within its standard deviations, every
//! format is recognized, and what is no measurement is refused with a message.

use std::fmt::Write;

use feedwright_ident::{
    BallBarProgram, FoundGeometry, GeometryInput, SimulatedBallBar, comp_file, fit_geometry,
    geometry_of_tables, sampled_table,
};
use feedwright_sim::{Axis, AxisGeometry, GeometryFile, Machine, MeasuredSet, MeasuredSquareness};

/// Three axes with rigid screws.
fn rigid() -> [Axis; 3] {
    let axis = Axis {
        lead_mm_per_rev: 10.0,
        ..Axis::default()
    };
    [axis; 3]
}

fn truth() -> GeometryFile {
    let axis = |scale_um_m: f64, pitch_error_um: f64, backlash_um: f64| AxisGeometry {
        scale_um_m,
        pitch_error_um,
        pitch_phase_deg: 30.0,
        lead_mm_per_rev: 10.0,
        backlash_um,
        ..AxisGeometry::default()
    };
    GeometryFile {
        axes: [
            axis(20.0, 2.0, 3.0),
            axis(-15.0, 1.0, 5.0),
            axis(10.0, 1.5, 4.0),
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

/// Numbers of variance 1: sums of twelve that are evenly distributed.
fn normal(state: &mut u64) -> f64 {
    let mut even = || {
        *state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    (0..12).map(|_| even()).sum()
}

/// The text of a ball bar: what the truth predicts, a center that is off, servo mismatch, noise.
fn bar_text(plane: &str, calibrated: bool, noise_um: f64, seed: u64) -> String {
    let flag = if calibrated { "yes" } else { "no" };
    let mut text = format!(
        "# plane: {plane}\n# radius_mm: 50\n# center_mm: 0 0 0\n# calibrated: {flag}\nangle_deg;direction;deviation_um\n"
    );
    let mut state = seed;
    for way in [1.0, -1.0] {
        let mut set = MeasuredSet {
            kind: "bar".to_owned(),
            axes: plane.to_owned(),
            radius_mm: 50.0,
            ..MeasuredSet::default()
        };
        set.rows = (0..500)
            .map(|i| vec![0.36 + 0.72 * f64::from(i), way, 0.0])
            .collect();
        for (row, seen) in set.rows.iter().zip(set.observations()) {
            let [cos, sin, mismatch, _] = seen.nuisance;
            let nuisances_um =
                7.0 * cos - 4.0 * sin + 1.5 * mismatch + if calibrated { 0.0 } else { 12.0 };
            let deviation_um =
                seen.predicted_um(&truth()) + nuisances_um + noise_um * normal(&mut state);
            let word = if way > 0.0 { "ccw" } else { "cw" };
            writeln!(text, "{:.2};{word};{deviation_um:.4}", row[0]).unwrap();
        }
    }
    text
}

fn sets(text: &str, axis: Option<usize>) -> Vec<MeasuredSet> {
    match GeometryInput::parse("measured.csv", text, axis).unwrap() {
        GeometryInput::Sets(sets) => sets,
        GeometryInput::Table(..) => panic!("a table"),
    }
}

fn value(found: &FoundGeometry, name: &str) -> (f64, f64) {
    let of = found
        .values
        .iter()
        .find(|of| of.name == name)
        .unwrap_or_else(|| panic!("no {name}: {:?}", found.lines()));
    (of.value, of.std)
}

const OF_XY: [(&str, f64); 9] = [
    ("scale x", 20.0),
    ("scale y", -15.0),
    ("squareness xy", 20.0),
    ("backlash x", 3.0),
    ("backlash y", 5.0),
    ("pitch error x", 2.0),
    ("pitch error y", 1.0),
    ("pitch phase x", 30.0),
    ("pitch phase y", 30.0),
];

/// Standard deviations cover the truth as those of a normal number: of 360 values 68 % within one,
/// 95 % within two, each less three standard deviations of such a count.
#[test]
fn a_calibrated_ball_bar_determines_everything_in_its_plane_within_its_standard_deviations() {
    let mut within = [0; 2];
    for seed in 1..=40 {
        let found = fit_geometry(
            sets(&bar_text("xy", true, 0.3, seed), None),
            &rigid(),
            "bar",
        )
        .unwrap();
        for (name, true_value) in OF_XY {
            let (value, std) = value(&found, name);
            assert!(
                (value - true_value).abs() < 5.0 * std && std > 0.0,
                "seed {seed}, {name}: {value} +- {std}"
            );
            within[0] += usize::from((value - true_value).abs() < std);
            within[1] += usize::from((value - true_value).abs() < 2.0 * std);
        }
        let set = &found.sets[0];
        assert!(
            (set.left_um / 0.3 - 1.0).abs() < 0.15 && set.before_um > 1.0,
            "{set:?}"
        );
        assert!(
            (set.nuisances[0].1 - 7.0).abs() < 0.2 && (set.nuisances[2].1 - 1.5).abs() < 0.2,
            "{set:?}"
        );
    }
    println!("within one and two standard deviations: {within:?} of 360");
    assert!(
        within[0] >= 360 * 61 / 100 && within[1] >= 360 * 92 / 100,
        "{within:?}"
    );
}

#[test]
fn a_bar_of_unknown_length_determines_the_difference_of_scales_and_says_so() {
    let found = fit_geometry(sets(&bar_text("xy", false, 0.3, 3), None), &rigid(), "bar").unwrap();
    let ((x, std), (y, _)) = (value(&found, "scale x"), value(&found, "scale y"));
    assert!(
        (x - y - 35.0).abs() < 5.0 * std && (x + y).abs() < 1e-6,
        "{x} {y}"
    );
    assert!(
        found
            .notes
            .iter()
            .any(|note| note.starts_with("mean scale: not determined")),
        "{:?}",
        found.notes
    );
    assert!(
        (found.sets[0].nuisances[3].1 - 12.0).abs() < 0.3,
        "{:?}",
        found.sets
    );
}

#[test]
fn three_planes_and_a_laser_determine_the_whole_geometry() {
    let mut all: Vec<MeasuredSet> = ["xy", "xz", "yz"]
        .iter()
        .flat_map(|plane| sets(&bar_text(plane, false, 0.1, 5), None))
        .collect();
    let mut laser =
        "position_mm,run1_forward_um,run1_backward_um,run2_forward_um,run2_backward_um\n"
            .to_owned();
    for i in 0..40 {
        let at_mm = 7.5 * f64::from(i);
        let um = [1.0, -1.0, 1.0, -1.0]
            .map(|way| truth().error_um([at_mm, 0.0, 0.0], [way, 0.0, 0.0])[0] + 2.0);
        writeln!(
            laser,
            "{at_mm},{},{},{},{}",
            um[0] + 0.05,
            um[1] - 0.05,
            um[2] - 0.05,
            um[3] + 0.05
        )
        .unwrap();
    }
    all.extend(sets(&laser, Some(0)));
    let found = fit_geometry(all, &rigid(), "all").unwrap();
    let of_z = [
        ("scale z", 10.0),
        ("squareness xz", -15.0),
        ("squareness yz", 12.0),
        ("backlash z", 4.0),
        ("pitch error z", 1.5),
    ];
    for (name, true_value) in OF_XY.into_iter().chain(of_z) {
        let (value, std) = value(&found, name);
        assert!(
            (value - true_value).abs() < 5.0 * std,
            "{name}: {value} +- {std}"
        );
    }
    let read = GeometryFile::parse("g.toml", &found.file.text()).unwrap();
    assert_eq!(read, found.file);
    assert!(read.check().unwrap().is_some());
    for axis in 0..3 {
        let mut wrong = read.clone();
        wrong.axes[axis].scale_um_m *= -1.0;
        assert!(
            wrong.check().is_err(),
            "the sign of the scale of axis {axis}"
        );
    }
}

/// ISO 230-2 tables of an axis whose error no scale, backlash or turn of the screw explains.
#[test]
fn a_positioning_table_keeps_what_repeats() {
    let bump_um = |at_mm: f64| 4.0 * libm::sin(at_mm / 60.0);
    let mut text = "# axis: y\nposition_mm,direction,deviation_um\n".to_owned();
    let mut state = 9;
    for way in [1.0, -1.0, 1.0, -1.0, 1.0, -1.0] {
        for i in 0..21 {
            let at_mm = 20.0 * f64::from(i);
            writeln!(
                text,
                "{at_mm},{way},{:.3}",
                bump_um(at_mm) - way + 0.2 * normal(&mut state)
            )
            .unwrap();
        }
    }
    let found = fit_geometry(sets(&text, None), &rigid(), "laser").unwrap();
    assert!((value(&found, "backlash y").0 - 2.0).abs() < 0.3);
    assert!(
        (found.sets[0].repeatability_um.unwrap() - 0.2).abs() < 0.04,
        "{:?}",
        found.sets
    );
    let error_um = |at_mm: f64| found.file.error_um([0.0, at_mm, 0.0], [0.0, 1.0, 0.0])[1];
    let offset = error_um(0.0) - bump_um(0.0);
    for i in 0..41 {
        let at_mm = 10.0 * f64::from(i);
        assert!(
            (error_um(at_mm) - bump_um(at_mm) - offset).abs() < 0.6,
            "{at_mm} mm"
        );
    }
    assert_eq!(found.file.axes[1].table.len(), 21);
}

#[test]
fn a_test_part_determines_scale_and_squareness_and_the_size_of_the_tool() {
    let mut text = "# center_mm: 100 50\nname,nominal_mm,measured_mm\n".to_owned();
    let part = [
        ("circle_0", 50.0, 0.0, 1.0),
        ("circle_45", 50.0, 45.0, 1.0),
        ("circle_90", 50.0, 90.0, 1.0),
        ("circle_135", 50.0, 135.0, 1.0),
        ("square_0", 80.0, 0.0, 1.0),
        ("square_90", 80.0, 90.0, 1.0),
        ("diagonal_45", 113.137, 45.0, 2.0_f64.sqrt()),
        ("diagonal_135", 113.137, 135.0, 2.0_f64.sqrt()),
    ];
    let [scale_x, scale_y, square, size_um] = [300.0, -200.0, 400.0, 15.0];
    for (i, (name, mm, angle, size)) in part.into_iter().chain(part).enumerate() {
        let (sin, cos) = libm::sincos(f64::to_radians(angle));
        let um = 1e-3 * mm * (scale_x * cos * cos + scale_y * sin * sin + square * sin * cos)
            + size * size_um;
        let misread_um = if i % 2 == 0 { 1.0 } else { -1.0 };
        writeln!(text, "{name},{mm},{:.4}", mm + 1e-3 * (um + misread_um)).unwrap();
    }
    let found = fit_geometry(sets(&text, None), &rigid(), "part").unwrap();
    for (name, true_value) in [
        ("scale x", scale_x),
        ("scale y", scale_y),
        ("squareness xy", square),
    ] {
        let (value, std) = value(&found, name);
        assert!(
            (value - true_value).abs() < 3.0 * std && std < 40.0,
            "{name}: {value} +- {std}"
        );
    }
    assert!(
        (found.sets[0].nuisances[0].1 - size_um).abs() < 4.0,
        "{:?}",
        found.sets
    );
    assert!(
        found
            .notes
            .iter()
            .any(|note| note.starts_with("backlash x: not determined")),
        "{:?}",
        found.notes
    );
}

#[test]
fn a_grid_encoder_determines_scale_squareness_and_backlash() {
    let mut text = "x_mm,y_mm,x_measured_mm,y_measured_mm\n".to_owned();
    let (mut before, mut ways, mut state) = ([0.0; 2], [0.0; 2], 4);
    for row in 0..9 {
        for point in (0..9).chain((0..9).rev()) {
            let at = if row % 2 == 0 {
                [point, row]
            } else {
                [row, point]
            }
            .map(|i| 12.0 * f64::from(i));
            for i in 0..2 {
                if at[i] != before[i] {
                    ways[i] = f64::signum(at[i] - before[i]);
                }
            }
            before = at;
            let error_um = truth().error_um([at[0], at[1], 0.0], [ways[0], ways[1], 0.0]);
            let turned_um = [-0.04 * at[1] + 3.0, 0.04 * at[0] - 2.0];
            let [x, y] = [0, 1]
                .map(|i| at[i] + 1e-3 * (error_um[i] + turned_um[i] + 0.05 * normal(&mut state)));
            writeln!(text, "{},{},{x:.6},{y:.6}", at[0], at[1]).unwrap();
        }
    }
    let found = fit_geometry(sets(&text, None), &rigid(), "grid").unwrap();
    for (name, true_value) in [
        ("scale x", 20.0),
        ("scale y", -15.0),
        ("squareness xy", 20.0),
        ("backlash x", 3.0),
        ("backlash y", 5.0),
    ] {
        let (value, std) = value(&found, name);
        // The points are 12 mm apart: the pitch error of 10 mm turns is noise to them.
        assert!(
            (value - true_value).abs() < 4.0 * std,
            "{name}: {value} +- {std}"
        );
    }
    assert!(
        (found.sets[0].nuisances[2].1 - 40.0).abs() < 15.0,
        "{:?}",
        found.sets
    );
    assert!(
        found
            .notes
            .iter()
            .any(|note| note.contains("too far apart")),
        "{:?}",
        found.notes
    );
}

#[test]
fn compensation_files_of_both_types_come_back_to_their_digits() {
    let first =
        "0 0.0012 -0.0031\n25.4 25.39981 25.4042\n50.8 50.8 50.7999\n76.2 76.2000003 76.1\n";
    let second = "-10 0.0012 -0.0031\n0 -0.00019 0.0042\n50.8 0 -0.0001\n76.2 0.0000003 -0.1\n";
    for (text, kind) in [(first, 0), (second, 1)] {
        let GeometryInput::Table(axis, table, found) =
            GeometryInput::parse("x.comp", text, Some(0)).unwrap()
        else {
            panic!("{text}")
        };
        assert_eq!(
            (axis, found, comp_file(&table, kind)),
            (0, kind, text.to_owned())
        );
        // The same table by the other type and back.
        let GeometryInput::Table(_, again, _) =
            GeometryInput::parse("x.comp", &comp_file(&table, 1 - kind), Some(0)).unwrap()
        else {
            panic!()
        };
        assert_eq!(comp_file(&again, kind), text);
        let geometry = geometry_of_tables(vec![(0, table.clone())], "x.comp")
            .unwrap()
            .file;
        let read = GeometryFile::parse("g.toml", &geometry.text()).unwrap();
        assert_eq!(comp_file(&sampled_table(&read, 0).unwrap(), kind), text);
        let mut wrong = read.clone();
        wrong.axes[0]
            .table
            .iter_mut()
            .for_each(|row| (row[1], row[2]) = (-row[1], -row[2]));
        assert!(wrong.check().is_err());
        wrong = read;
        wrong.axes.swap(0, 1);
        assert!(wrong.check().is_err());
    }
    // Type 0 has where the tool is: it is 0.19 um short at 25.4 mm in forward travel.
    let GeometryInput::Table(_, table, _) = GeometryInput::parse("x.comp", first, Some(0)).unwrap()
    else {
        panic!()
    };
    assert_eq!(table[1], [25.4, -0.19, 4.2]);
}

#[test]
fn what_is_no_measurement_is_refused_with_a_remedy() {
    for (text, said) in [
        ("", "m:1: this is no measurement that is known"),
        (
            "t,x.cmd,x.act\n0,1,1\n",
            "m:2: this is a log of commanded and actual positions",
        ),
        (
            "a,b,c\n1,2,3\n",
            "m:2: this is no measurement that is known; its columns are: a, b, c",
        ),
        ("G1 X1\n", "m:1: this is no measurement that is known"),
        ("0 0 0\n1 1 1\n", "m:1: which axis this is of is not said"),
        ("# axis: x\n1 1 1\n0 0 0\n", "m:3: position 0 follows 1"),
        (
            "angle_deg,direction,deviation_um\n0,ccw,1\n",
            "m:2: the nominal radius is not said",
        ),
        (
            "# radius_mm: 50\n# plane: xw\nangle_deg,direction,deviation_um\n0,ccw,1\n",
            "m:4: the plane is 'xw'",
        ),
        (
            "# radius_mm: 50\nangle_deg,direction,deviation_um\n0,left,1\n",
            "m:3: the direction is 'left'",
        ),
        (
            "# radius_mm: 50\nangle_deg,direction,deviation_um\n0,ccw,1\n1,ccw,?\n",
            "m:4: deviation_um is '?', not a number",
        ),
        (
            "# radius_mm: 50\nangle_deg,direction,deviation_mm\n0,ccw,100\n",
            "m:3: a deviation of 100000 um is no reading",
        ),
        (
            "name,nominal_mm,measured_mm\nring,50,50\n",
            "m:2: no distance is called 'ring'",
        ),
        (
            "# axis: x\nposition_mm,value\n0,1\n",
            "m:3: there is no column of deviations",
        ),
    ] {
        let error = GeometryInput::parse("m", text, None).unwrap_err();
        assert!(
            error.to_string().starts_with(said) && !error.hint.is_empty(),
            "{error} / {}, not {said}",
            error.hint
        );
    }
    let few = fit_geometry(
        sets(
            "# axis: x\nposition_mm,direction,deviation_um\n0,1,1\n10,1,2\n",
            None,
        ),
        &rigid(),
        "few",
    )
    .unwrap_err();
    assert!(few.to_string().contains("2 values for 2 unknowns"), "{few}");
    let missing = fit_geometry(
        sets(&bar_text("xz", true, 0.3, 1), None),
        &rigid()[..2],
        "bar",
    )
    .unwrap_err();
    assert!(
        missing
            .to_string()
            .contains("is of z, and the machine has no such axis"),
        "{missing}"
    );
}

/// Measures a machine with a bar of 0.3 um noise by its plant, and reads it against the encoders.
#[test]
fn a_ball_bar_on_a_simulated_machine_finds_its_geometry() {
    let machine = Machine::load("stiff".as_ref()).unwrap();
    let program = BallBarProgram {
        radius_mm: 50.0,
        feed_mm_min: 1500.0,
        plane: [0, 1],
    };
    let bar = SimulatedBallBar {
        program,
        center_mm: [0.0; 3],
        noise_um: 0.3,
        samples: 3600,
        calibrated: true,
        has_encoders: true,
        seed: 1,
    };
    let text = bar.text(&machine).unwrap();
    let found = fit_geometry(sets(&text, None), &machine.axes, "bar").unwrap();
    for (name, true_value, least) in [
        ("scale x", 10.0, 1.0),
        ("scale y", -10.0, 1.0),
        ("squareness xy", 10.0, 1.0),
        ("pitch error x", 1.0, 0.1),
        ("pitch error y", 1.0, 0.1),
        ("backlash x", 0.0, 0.2),
        ("backlash y", 0.0, 0.2),
    ] {
        let (value, std) = value(&found, name);
        assert!(
            (value - true_value).abs() < (4.0 * std).min(least),
            "{name}: {value} +- {std}"
        );
    }
}
