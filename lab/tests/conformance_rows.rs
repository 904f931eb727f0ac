//! What the rows of a run say about foot and contour error, on every contour of the comparison and
//! in space.

use feedwright_gcode::{Reader, Settings};
use feedwright_lab::Workpiece;
use feedwright_plan::{Step, signed_distance_mm};
use feedwright_sim::{BoxedController, Machine, Row, Run, path_steps};

/// Rounding of coordinates of some ten millimetres, mm.
const ROUNDING_MM: f64 = 1e-12;
/// Tolerance of the error along the tangent, mm: the accuracy of a nearest point times the turn of
/// the path on the way.
const ALONG_MM: f64 = 1e-7;

fn rows(axes: usize, machine: &Machine, steps: &[Step]) -> Vec<Row> {
    let mut rows = Vec::<Row>::new();
    Run::on(machine)
        .cut_boxed_steps(
            steps,
            &mut BoxedController::uncorrected(axes),
            &mut [&mut rows],
        )
        .unwrap();
    rows
}

fn tnv40() -> Machine {
    Machine::load("tnv40".as_ref()).unwrap()
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

/// The contour error of a row follows from its foot, its tangent and the tool.
fn agrees(row: &Row, axes: usize) {
    let away_mm = [0, 1, 2].map(|k| row.act_mm[k] - row.foot_mm[k]);
    let signed_mm = signed_distance_mm(row.tangent, away_mm);
    let wanted = if axes == 2 {
        signed_mm
    } else {
        signed_mm.abs()
    };
    assert_eq!(row.contour_error_mm.to_bits(), wanted.to_bits(), "{row:?}");
    assert!(
        (dot(row.tangent, row.tangent) - 1.0).abs() < ROUNDING_MM,
        "{row:?}"
    );
}

#[test]
fn on_every_contour_the_error_is_from_the_foot_to_the_tool() {
    let machine = tnv40();
    for workpiece in Workpiece::contours() {
        let rows = rows(2, &machine, &workpiece.steps);
        assert!(rows.len() > 100, "{}: {} rows", workpiece.name, rows.len());
        rows.iter().for_each(|row| agrees(row, 2));
    }
}

#[test]
fn on_the_circle_foot_and_tangent_are_those_of_the_circle() {
    let machine = tnv40();
    let circle = Workpiece::contours()
        .into_iter()
        .find(|workpiece| workpiece.name == "circle")
        .unwrap();
    let rows = rows(2, &machine, &circle.steps);
    let mut largest_mm: f64 = 0.0;
    // The ends of the path are feet of a tool before and beyond them.
    for row in rows
        .iter()
        .filter(|row| row.cutting && row.s_mm > 1.0 && row.s_mm < 60.0)
    {
        let (x, y) = (row.foot_mm[0] - 10.0, row.foot_mm[1]);
        assert!((x.hypot(y) - 10.0).abs() < 1e-9, "{row:?}");
        assert!(
            (row.tangent[0] * x + row.tangent[1] * y).abs() < 1e-9,
            "{row:?}"
        );
        let away_mm = [0, 1, 2].map(|k| row.act_mm[k] - row.foot_mm[k]);
        assert!(dot(away_mm, row.tangent).abs() < ALONG_MM, "{row:?}");
        largest_mm = largest_mm.max(row.contour_error_mm.abs());
    }
    assert!(
        largest_mm > 0.01,
        "{largest_mm}: the uncorrected cut cuts this circle some 20 um too small"
    );
}

#[test]
fn in_space_the_error_is_the_distance_of_the_foot() {
    let machine = tnv40();
    let program = "G21 G90 F1500\nG1 X10 Y5 Z-3\nG2 X20 Y5 I5 J0 Z-6\nG1 X0 Y0 Z0\nM2\n";
    let canon = Reader::from_text("lines and a helix", program, Settings::default())
        .unwrap()
        .map(|step| step.unwrap());
    let steps: Vec<Step> = path_steps(canon).map(|step| step.unwrap()).collect();
    let rows = rows(3, &machine, &steps);
    assert!(
        rows.iter()
            .any(|row| row.foot_mm[2] < -5.0 && row.contour_error_mm > 1e-4)
    );
    rows.iter().for_each(|row| agrees(row, 3));
}
